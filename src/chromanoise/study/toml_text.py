"""A study as TOML."""

import json
from typing import Any

from chromanoise.catalog.objects import is_object_word, shown_word
from chromanoise.errors import InputError
from chromanoise.study.document import Study


def study_as_toml(study: Study) -> str:
    """What differs from the defaults, and the sensors; `study_from_text` gives the study back.

    Parameters
    ----------
    study
        The study.

    Raises
    ------
    InputError
        If a word of the study refers to an object of Python.

    Examples
    --------
    >>> from chromanoise.study.document import SensorPart
    >>> print(study_as_toml(Study(sensors=(SensorPart(name="onyx-rgbw"),))), end="")
    schema = 1
    <BLANKLINE>
    [[sensors]]
    name = "onyx-rgbw"
    """
    refuse_objects(study)
    data = study.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    lines = ["schema = 1"]
    tables = []
    for key, value in data.items():
        if isinstance(value, dict):
            tables += ["", f"[{key}]", *_pairs(value)]
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for entry in value:
                tables += ["", f"[[{key}]]", *_pairs(entry)]
        else:
            lines.append(f"{key} = {_value(value)}")
    return "\n".join([*lines, *tables]) + "\n"


def refuse_objects(study: Study) -> None:
    """Refuse to write a study that refers to objects of Python, which no text contains.

    Parameters
    ----------
    study
        The study.

    Raises
    ------
    InputError
        If it does; the error names all of them.
    """
    found = _objects(study.model_dump(mode="json", exclude_defaults=True))
    if found:
        raise InputError(
            "the study",
            "must name files, or entries of the catalog, to be written as text",
            value=tuple(found),
            found=f"has the Python object {', '.join(found)}",
            remedy="save its numbers in a file, and give the file",
        )


def _objects(data: Any) -> list[str]:
    """The names of the objects to which plain data refers."""
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        return list(dict.fromkeys(name for one in data for name in _objects(one)))
    return [shown_word(data)] if is_object_word(data) else []


def _pairs(data: dict[str, Any], prefix: str = "") -> list[str]:
    """``key = value`` lines; tables inside become dotted keys."""
    lines = []
    for key, value in data.items():
        if isinstance(value, dict):
            lines += _pairs(value, f"{prefix}{key}.")
        else:
            lines.append(f"{prefix}{key} = {_value(value)}")
    return lines


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, str):
        # a JSON string is a basic string of TOML, but for the letter DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return str(value).lower() if isinstance(value, bool) else repr(value)
