"""Studies as TOML: reading, writing, and sensor and matrix names in file names.

All errors in a file are reported at once, each with file, line and key.
"""

import copy
import json
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from chromanoise.base import (
    Fault,
    InputError,
    Key,
    RecordError,
    Setting,
    distinct,
    dotted,
    first_bytes,
    known_name,
    refusal,
    short,
)
from chromanoise.noise import OperatingPoint
from chromanoise.study.assembly import unresolved
from chromanoise.study.hashes import FileWord, with_file_words
from chromanoise.study.resolve_names import file_of, is_object_word, shown_word, word_beside
from chromanoise.study.schema import KEEP_IDLE, Study, StudyKind


def study_as_toml(study: Study) -> str:
    """What differs from the defaults, and the sensors; `study_from_text` gives the study back.

    Raises
    ------
    InputError
        If a word of the study refers to an object of Python.

    Examples
    --------
    >>> from chromanoise.study.schema import SensorPart
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
    for name, value in data.items():
        key = prefix + (name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _value(name))
        lines += (
            _pairs(value, f"{key}.") if isinstance(value, dict) else [f"{key} = {_value(value)}"]
        )
    return lines


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, str):
        # a JSON string is a basic string of TOML, but for the letter DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return str(value).lower() if isinstance(value, bool) else repr(value)


_LARGEST_BYTES = 1 << 20
_MOST_DOTS = 64
_MOST_DIGITS = 10


def read_study(
    path: Path | str, changes: Sequence[str] = (), *, change_label: str = "change"
) -> Study:
    """The study in a TOML file.

    Parameters
    ----------
    path
        The file; file names in it are relative to its folder.
    changes
        ``key=value`` each, as ``light.level_lux=3`` or ``sensors.0.name="onyx-rgb"``; they win.
    change_label
        Precedes a change in error messages.

    Returns
    -------
    Study
        With file names relative to the working folder.

    Raises
    ------
    InputError
        If the file cannot be read; all faults of what it says, one line each.
    """
    path = Path(path)

    def unresolved_in(study: Study) -> list[InputError]:
        return unresolved(beside_file(study, path))

    text = document_text(path, "study")
    study = _document(Study, text, str(path), changes, change_label, unresolved_in)
    return beside_file(study, path)


def document_text(path: Path, kind: str) -> str:
    """The text of a study file or another document.

    Parameters
    ----------
    kind
        What it holds, for messages: ``study``.

    Raises
    ------
    InputError
        If the file cannot be read, is too large, or is no text.
    """
    content = first_bytes(path, _LARGEST_BYTES + 1, pipe=True)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(
            str(path), "is not a UTF-8 text file", remedy=f"save the {kind} as UTF-8"
        ) from None
    if len(content) > _LARGEST_BYTES:
        raise InputError(
            str(path), f"must have at most {_LARGEST_BYTES} bytes, as a {kind}", found="has more"
        )
    return text


def is_relative_to_working_folder(path: Path) -> bool:
    """Whether file names in a document are relative to the working folder, as in piped text."""
    return path.parent == Path() or Path("/dev") in path.absolute().parents


def beside_file(study: StudyKind, path: Path) -> StudyKind:
    """The study of a file, with file names relative to the working folder.

    Parameters
    ----------
    study
        With file names relative to the folder of ``path``.
    path
        The file that it was read from.
    """
    if is_relative_to_working_folder(path):
        return study
    return with_file_words(study, lambda one: _beside(one, path.parent))


def _beside(one: FileWord, folder: Path) -> str:
    if one.kind in ("sensor", "light", "filter", "observer"):
        return word_beside(one.word, one.kind, folder)
    name = one.word
    complete = name.startswith("builtin:") or file_of(name).is_absolute()
    return name if complete else str(folder / name)


def study_from_text(
    text: str,
    *,
    source: str,
    changes: Sequence[str] = (),
    change_label: str = "change",
    keep_idle: bool = False,
) -> Study:
    r"""The study in TOML text; ``source`` names it in messages.

    ``keep_idle`` is that of `study_from_data`, the other parameters are those of `read_study`.

    Parameters
    ----------
    source
        Name of the text in messages.
    change_label
        Name of the changes in messages.
    keep_idle
        Whether settings without effect are kept.

    Raises
    ------
    InputError
        As `read_study`.

    Examples
    --------
    >>> study_from_text('[[sensors]]\nname = "onyx-rgbw"', source="a text").light.level_lux
    10.0
    """
    return _document(Study, text, source, changes, change_label, lambda study: [], keep_idle)


def document_from_text(
    kind: type[StudyKind],
    text: str,
    *,
    source: str,
    unfit: Callable[[StudyKind], list[InputError]],
    changes: Sequence[str] = (),
    change_label: str = "change",
) -> StudyKind:
    """A document with the tables of a study and others, from TOML text.

    Parameters
    ----------
    unfit
        What is wrong with a document whose classes accept it, each error with its key.
    source, changes, change_label
        As `study_from_text`.

    Raises
    ------
    InputError
        As `read_study`.
    """
    return _document(kind, text, source, changes, change_label, unfit)


def _document(
    kind: type[StudyKind],
    text: str,
    source: str,
    changes: Sequence[str],
    change_label: str,
    unfit: Callable[[StudyKind], list[InputError]],
    keep_idle: bool = False,
) -> StudyKind:
    data = _toml(text, source)
    lines = _lines_of_keys(text)
    changed: dict[Key, str] = {}
    for change in changes:
        place = f"{change_label} {short(change)}"
        changed |= dict.fromkeys(_spellings(_changed(data, change, place)), place)
    return _validated(kind, data, source, lines, changed, unfit, keep_idle)


def _toml(text: str, source: str) -> dict[str, Any]:
    """What TOML text holds; the parser takes hours over a key of a million parts, so it is asked
    only for keys that a person could write.
    """
    plain = re.sub(r"\"[^\"\n]*\"|'[^'\n]*'", "s", text)
    if not re.search(r"\"\"\"|'''", text):  # in a text over lines, # begins no comment
        plain = re.sub(r"#.*", "", plain)
    for number, line in enumerate(plain.splitlines(), 1):
        dots = line.count(".")
        if dots > _MOST_DOTS:
            raise InputError(
                source,
                f"must have at most {_MOST_DOTS} dots outside of quotes, because no key of a "
                "study has more",
                where=f"line {number}",
                value=dots,
                found=f"has {dots}",
            )
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError(source, "is not TOML (it is nested too deeply)") from None
    except tomllib.TOMLDecodeError as error:
        said, _, where = str(error).removesuffix(")").rpartition(" (at ")
        raise InputError(source, f"is not TOML ({said[:200]})", where=where) from None
    except ValueError:  # that the parser lets through
        raise InputError(source, "is not TOML (an integer has too many digits)") from None


def study_from_data(data: Any, *, source: str = "", keep_idle: bool = False) -> Study:
    """The study in plain data, as TOML would give it.

    Parameters
    ----------
    source
        Names it in messages; empty where the data are arguments of a call.
    keep_idle
        Whether settings without effect are accepted, as ``document.KEEP_IDLE``.

    Returns
    -------
    Study
        Checked; its names are resolved when it is run.

    Raises
    ------
    InputError
        All faults of what it says, each with its key as ``setting``; several as a `StudyError`.
    """
    if not isinstance(data, Mapping):
        raise InputError("study", "must be a mapping of keys", value=type(data).__name__)
    return _validated(Study, data, source, {}, {}, lambda study: [], keep_idle)


def _validated(
    kind: type[StudyKind],
    data: Mapping[str, Any],
    source: str,
    lines: Mapping[Key, int],
    changed: Mapping[Key, str],
    unfit: Callable[[StudyKind], list[InputError]],
    keep_idle: bool,
) -> StudyKind:
    faults: list[InputError] = []
    study: StudyKind | None = None
    try:
        study = kind.model_validate(data, context=KEEP_IDLE if keep_idle else None)
    except RecordError as error:
        faults = [_of_part(one) if one.of_part else one.error for one in error.faults]
        study = _without(kind, data, [one.key for one in error.faults])
    if study is not None and study.sensors[0].name:
        left_out = {one.setting for one in faults}  # settings that need one of these are no fault
        faults += [one for one in unfit(study) if not left_out & _named_in_remedies(one)]
    if faults or study is None:
        ordered = sorted(faults, key=lambda error: _line_of(_key_of(error), lines))
        places = [_place(_key_of(error), lines, changed, source) for error in ordered]
        raise refusal(ordered, places if source else ())
    return study


def _named_in_remedies(error: InputError) -> set[str]:
    return {one.name for one in error.remedy if isinstance(one, Setting)}


def _key_of(error: InputError) -> Key:
    return tuple(int(s) if _is_place(s) else s for s in error.setting.split("."))


def _line_of(key: Key, lines: Mapping[Key, int]) -> int:
    """The line of the key, or of the nearest table around it; 0 if none is known."""
    return next((lines[key[:n]] for n in range(len(key), 0, -1) if key[:n] in lines), 0)


def _without(
    kind: type[StudyKind], data: Mapping[str, Any], wrong: Sequence[Key]
) -> StudyKind | None:
    """What remains of a study without its faulty values, so that its names can be looked at too."""
    rest: Any = copy.deepcopy(data)
    for key in wrong:
        while key and isinstance(key[-1], int):
            key = key[:-1]  # without one entry the others would have other places
        at: Any = rest
        for step in key[:-1]:
            if isinstance(at, list) and isinstance(step, int):
                at = at[step]
            else:
                at = at.get(step) if isinstance(at, dict) else None
        if key and isinstance(at, dict):
            at.pop(key[-1], None)
    for _ in range(2):
        try:
            return kind.model_validate(rest, context=KEEP_IDLE)
        except RecordError as error:
            for one in error.faults:
                rest.pop(one.key[0] if one.key else "", None)
            rest.setdefault("sensors", [{"name": ""}])  # a study has some; this one is looked over
    return None


def _changed(data: dict[str, Any], change: str, place: str) -> Key:
    """Put ``a.b.0.c=value`` in its place; the value is TOML, or else a plain word.

    Errors name the change by ``place``.
    """
    name, equals, value = change.partition("=")
    steps: Key = tuple(int(s) if _is_place(s) else s for s in name.strip().split("."))
    if not equals or not all(str(step) for step in steps):
        raise InputError(
            place, "needs the form key=value, e.g. light.level_lux=3", value=change, found=None
        )
    at: Any = data
    for i, step in enumerate(steps[:-1]):
        following: Any = [] if isinstance(steps[i + 1], int) else {}
        at = _step(at, step, following, place)
    last = _known_step(at, steps[-1])
    parsed = _parsed(value, place)
    in_list = isinstance(at, list) and isinstance(last, int) and last < len(at)
    if in_list or (isinstance(at, dict) and isinstance(last, str)):
        at[last] = parsed
    else:
        raise _absent(place, name)
    return steps


def _is_place(step: str) -> bool:
    """The place of an entry in a list; other letters than 0 to 9 are digits to `str.isdigit`."""
    return step.isascii() and step.isdigit() and len(step) < _MOST_DIGITS


def _absent(place: str, name: str) -> InputError:
    return InputError(
        place,
        "key must lead to an entry of the study",
        value=name,
        found=f"the study has nothing at {short(name)}",
    )


def _parsed(value: str, place: str) -> Any:
    """A value of TOML, or else a plain word."""
    dots = value.count(".")
    if dots > _MOST_DOTS:
        raise InputError(
            place,
            f"value must have at most {_MOST_DOTS} dots",
            value=dots,
            found=f"has {dots}",
        )
    try:
        return tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return value
    except (ValueError, RecursionError):  # thousands of digits, thousands of brackets
        raise InputError(
            place,
            "value must be readable as TOML",
            value=value,
            found="has too many digits or is nested too deeply",
        ) from None


def _step(at: Any, step: str | int, following: Any, place: str) -> Any:
    step = _known_step(at, step)
    if isinstance(at, dict) and isinstance(step, str):
        return at.setdefault(step, following)
    if isinstance(at, list) and isinstance(step, int) and step < len(at):
        return at[step]
    raise _absent(place, str(step))


def _known_step(at: Any, step: str | int) -> str | int:
    """The key that is there already, as `known_name`."""
    return known_name(step, at) if isinstance(at, dict) and isinstance(step, str) else step


def _of_part(fault: Fault) -> InputError:
    """The error of a check that sees one part of a study, with the whole key."""
    error, part = fault.error, dotted(fault.key)
    own = f"{part}.{error.subject}".lstrip(".")
    return error.inside(error.setting or own, lambda name: f"{part}.{name}".lstrip("."))


def _place(key: Key, lines: Mapping[Key, int], changed: Mapping[Key, str], source: str) -> str:
    """``file:line``, or the change that holds the value."""
    for length in range(len(key), 0, -1):
        if key[:length] in changed:
            return changed[key[:length]]
    line = _line_of(key, lines)
    return f"{source}:{line}" if line else source


def _lines_of_keys(text: str) -> dict[Key, int]:
    """The line on which each key and table begins. TOML's parser does not tell."""
    lines: dict[Key, int] = {}
    table: Key = ()
    counts: dict[Key, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if match := re.match(r"\s*(\[\[?)\s*([^\]]+?)\s*\]", line):
            name = _numbered(_keys(match[2]), counts)
            if match[1] == "[[":
                place = counts.get(name, -1) + 1
                counts[name] = place
                _put_line(lines, name, number)
                name = (*name, place)
            table = name
            _put_line(lines, table, number)
        elif match := re.match(r"\s*([A-Za-z0-9_.\-\"' ]+?)\s*=", line):
            _put_line(lines, (*table, *_keys(match[1])), number)
    return lines


def _put_line(lines: dict[Key, int], key: Key, number: int) -> None:
    for one in _spellings(key):
        lines.setdefault(one, number)


def _spellings(key: Key) -> tuple[Key, Key]:
    """A key as it is written, and with the names of our keys."""
    return key, tuple(s.replace("-", "_") if isinstance(s, str) else s for s in key)


def _keys(dotted: str) -> tuple[str, ...]:
    return tuple(part.strip().strip("\"'") for part in dotted.split("."))


def _numbered(name: tuple[str, ...], counts: Mapping[Key, int]) -> Key:
    """``sensors.pixel`` is the pixel of the last sensor."""
    place: Key = ()
    for step in name[:-1]:
        place = (*place, step)
        if place in counts:
            place = (*place, counts[place])
    return (*place, name[-1])


def refuse_shared_file_names(
    operating_points: Sequence[OperatingPoint], matrices: Iterable[str]
) -> None:
    """Refuse sensors or matrices whose names differ, but not as parts of names of files."""
    distinct("file names of sensors", [file_word(each.sensor.name) for each in operating_points])
    distinct("file names of matrices", [file_word(name) for name in matrices])


def file_word(name: str) -> str:
    """A name as a file's name or a part of one: it leads into no other folder and hides nothing.

    Examples
    --------
    >>> file_word("../../a b")
    '-.-..-a-b'
    """
    word = "".join(c if c.isalnum() or c in "+-_." else "-" for c in name)
    return f"-{word[1:]}" if word.startswith(".") else word
