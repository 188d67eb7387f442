"""A study as TOML."""

import json
from typing import Any

from chromanoise.study.document import Study


def study_as_toml(study: Study) -> str:
    """What differs from the defaults, and the sensors; `study_from_text` gives the study back.

    Parameters
    ----------
    study
        The study.

    Examples
    --------
    >>> from chromanoise.study.document import SensorPart
    >>> print(study_as_toml(Study(sensors=(SensorPart(name="onyx-rgbw"),))), end="")
    schema = 1
    <BLANKLINE>
    [[sensors]]
    name = "onyx-rgbw"
    """
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
