"""Differences of two outputs, also of two versions of chromanoise: inputs, settings, numbers.

An output is a folder of ``chromanoise run``, or a file of JSON. All values are compared by their
keys, so keys that this version does not know are compared too. Entries of lists are found again by
their names, in any order.
"""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar

from chromanoise.base import InputError, JsonKeys, dataclass, plain
from chromanoise.io import Table, table_of
from chromanoise.study.fail_conditions import names_of_entries
from chromanoise.study.run_files import ROUNDING, STUDY_FILE, output_files, read_record

_MOST_SHOWN = 5


@dataclass(frozen=True, kw_only=True)
class ChangedValue:
    """A value that differs.

    Attributes
    ----------
    key
        Its place: the step, and the keys and names to it, with dots between.
    first, second
        The values in the two outputs.
    """

    key: str
    first: Any
    second: Any

    KEYS: ClassVar[JsonKeys] = ("key", "first", "second", "difference", "relative")

    @property
    def difference(self) -> float | None:
        """Second minus first; ``None`` where one is no number."""
        return self.second - self.first if _are_numbers(self.first, self.second) else None

    @property
    def relative(self) -> float | None:
        """The difference over the larger of both, without sign; ``None`` as ``difference``. [1]

        That of the ratios of two numbers in dB.
        """
        if not _are_numbers(self.first, self.second):
            return None
        if self.key.endswith("_db"):
            return 1 - 10 ** (-abs(self.second - self.first) / 20)
        return abs(self.second - self.first) / max(abs(self.first), abs(self.second))


@dataclass(frozen=True, kw_only=True)
class Differences:
    """What differs between two outputs.

    Attributes
    ----------
    versions
        Version of chromanoise of each; ``None`` where none is recorded.
    numerics
        Entries on machine and libraries that differ.
    inputs
        Input files that differ, by the SHA-256 of their content; ``None`` in an output without it.
    settings
        Keys of the study that differ.
    numbers
        Numbers that differ by more than rounding, the largest relative difference first.
    others
        Texts, undefined numbers and pictures that differ.
    only_first, only_second
        Keys that one of the outputs has, those of its study after ``study``; in place of keys with
        the same beginning, that beginning.
    rounding
        Largest relative difference of the numbers that differ by rounding only. [1]
    compared
        How many values both outputs have.
    """

    versions: tuple[str | None, str | None]
    numerics: tuple[ChangedValue, ...]
    inputs: tuple[ChangedValue, ...]
    settings: tuple[ChangedValue, ...]
    numbers: tuple[ChangedValue, ...]
    others: tuple[ChangedValue, ...]
    only_first: tuple[str, ...]
    only_second: tuple[str, ...]
    rounding: float
    compared: int

    KEYS: ClassVar[JsonKeys] = (
        *("equal", "versions", "numerics", "inputs", "settings", "numbers", "others"),
        *("only_first", "only_second", "rounding", "compared"),
    )

    @property
    def equal(self) -> bool:
        """Whether inputs, settings and results are equal; version and machine may differ."""
        parts = (self.inputs, self.settings, self.numbers, self.others)
        return not any((*parts, self.only_first, self.only_second))

    def to_dict(self) -> dict[str, Any]:
        """Plain data, as ``chromanoise diff --json``."""
        data: dict[str, Any] = plain(self)
        return data

    def to_table(self) -> Table:
        """The numbers that differ, the largest relative difference first."""
        return table_of(
            "Numbers that differ",
            self.numbers,
            ("key", "", "", lambda one: one.key),
            ("first", "", ".6g", lambda one: one.first),
            ("second", "", ".6g", lambda one: one.second),
            ("difference", "", "+.3g", lambda one: one.difference),
            ("relative", "", ".2%", lambda one: one.relative),
        )

    def causes(self) -> list[str]:
        """What differs besides the results: one sentence per version, input and setting."""
        lines = []
        if self.versions[0] != self.versions[1]:
            lines.append(f"Versions: {self.versions[0]} and {self.versions[1]}.")
        if self.numerics:
            names = ", ".join(one.key for one in self.numerics)
            lines.append(f"Machine or libraries differ: {names}.")
        lines += [f"Input {one.key} {_what_of_file(one)}." for one in self.inputs]
        return [*lines, *(f"Setting {one.key} is {_text(one)}." for one in self.settings)]

    def effects(self) -> list[str]:
        """Texts that differ, keys of one output only, and the conclusion."""
        lines = _first_of([f"{one.key} is {_text(one)}." for one in self.others])
        for place, keys in (("first", self.only_first), ("second", self.only_second)):
            if keys:
                lines.append(f"Only the {place} output has {', '.join(_first_of([*keys]))}.")
        return [*lines, self._conclusion()]

    def _conclusion(self) -> str:
        small = f"up to rounding, {self.rounding:.1e} relative" if self.rounding else ""
        if self.numbers:
            top = self.numbers[0]
            return (
                f"{len(self.numbers)} numbers differ, of {self.compared} values that both outputs "
                f"have; the largest relative difference is {top.relative:.2%}, of {top.key}."
            )
        if self.others or self.only_first or self.only_second:
            return f"All numbers that both have are equal{f' ({small})' if small else ''}."
        return f"The results are equal{f' {small}' if small else ''}."


def differences_of(first: Path, second: Path) -> Differences:
    """Differences of two outputs.

    Parameters
    ----------
    first, second
        Folders of `run_study`, or files of JSON that a command wrote.

    Raises
    ------
    InputError
        If one is neither, or cannot be read.
    """
    one, other = (_content(path) for path in (first, second))
    changed, only_first, only_second = {}, [], []
    for part in ("numerics", "files", "study", "result"):
        mine, its = one[part], other[part]
        changed[part] = [
            ChangedValue(key=key, first=mine[key], second=its[key])
            for key in mine
            if key in its and mine[key] != its[key]
        ]
        if part in ("files", "numerics"):  # a file of one output has no counterpart
            changed[part] += [
                ChangedValue(key=key, first=mine.get(key), second=its.get(key))
                for key in dict.fromkeys([*mine, *its])
                if (key in mine) != (key in its)
            ]
        else:
            label = "study." if part == "study" else ""
            only_first += [label + key for key in _missing(mine, its)]
            only_second += [label + key for key in _missing(its, mine)]
    numbers = [value for value in changed["result"] if value.relative is not None]
    numbers.sort(key=lambda value: -(value.relative or 0.0))
    small = [value for value in numbers if (value.relative or 0.0) <= ROUNDING]
    return Differences(
        versions=(one["version"], other["version"]),
        numerics=tuple(changed["numerics"]),
        inputs=tuple(changed["files"]),
        settings=tuple(changed["study"]),
        numbers=tuple(numbers[: len(numbers) - len(small)]),
        others=tuple(value for value in changed["result"] if value.relative is None),
        only_first=tuple(only_first),
        only_second=tuple(only_second),
        rounding=max((value.relative or 0.0 for value in small), default=0.0),
        compared=len(one["result"].keys() & other["result"].keys()),
    )


def _content(path: Path) -> dict[str, Any]:
    """Version, and per part of an output its values by their keys."""
    if path.is_dir():
        if not (path / STUDY_FILE).exists():
            raise InputError(
                str(path),
                "must be a folder of `chromanoise run`",
                value=str(path),
                found=f"has no {STUDY_FILE}",
                remedy="name such a folder, or two files of --json",
            )
        record = read_record(path / STUDY_FILE)
        files = [path / name for name in output_files(path) if name.endswith(".json")]
        steps = {file.stem: read_record(file) for file in files if file.name != STUDY_FILE}
    else:
        record = read_record(path)
        steps = {str(record.get("step", "")): record} if "result" in record else {}
    found: dict[str, Any] = {
        name: dict(_leaves(record.get(name) or {}, "")) for name in ("numerics", "files", "study")
    }
    results: dict[str, Any] = {}
    for name, step in steps.items():
        results |= dict(_leaves(step.get("result"), name))
        results |= dict(_leaves(step.get("written") or {}, f"{name}.file"))
    if not steps:
        results = dict(_leaves({k: v for k, v in record.items() if k != "version"}, ""))
    if not results:
        raise InputError(
            str(path),
            "must be an output of chromanoise",
            value=str(path),
            found="holds no results",
            remedy="name a folder of `chromanoise run`, or a file of --json",
        )
    version = record.get("version")
    return found | {"result": results, "version": None if version is None else str(version)}


def _leaves(data: Any, key: str) -> Iterator[tuple[str, Any]]:
    """Each value that is no list and no object, by its place."""
    if isinstance(data, Mapping):
        named = list(data.items())
    elif isinstance(data, list):
        named = list(zip(names_of_entries(data), data, strict=True))
    else:
        yield key, data
        return
    for name, one in named:
        yield from _leaves(one, f"{key}.{name}" if key else str(name))


def _missing(mine: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    """The shortest beginnings of keys that no key of the other begins with."""

    def beginnings(key: str) -> list[str]:
        steps = key.split(".")
        return [".".join(steps[: i + 1]) for i in range(len(steps))]

    known = {begin for key in other for begin in beginnings(key)}
    found = (next((one for one in beginnings(key) if one not in known), key) for key in mine)
    return list(dict.fromkeys(one for one in found if one not in other and one not in known))


def _are_numbers(*values: Any) -> bool:
    return all(type(one) in (int, float) and math.isfinite(one) for one in values)


def _what_of_file(one: ChangedValue) -> str:
    if one.first is None or one.second is None:
        return f"is of the {'first' if one.second is None else 'second'} output only"
    return "has other content"


def _text(one: ChangedValue) -> str:
    first, second = ("undefined" if value is None else value for value in (one.first, one.second))
    return f"{first} in the first output and {second} in the second"


def _first_of(texts: list[str]) -> list[str]:
    """The first texts, and how many more there are."""
    rest = len(texts) - _MOST_SHOWN
    return [*texts[:_MOST_SHOWN], f"... and {rest} more"] if rest > 0 else texts
