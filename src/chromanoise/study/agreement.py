"""Agreement of the outputs of two runs of one study: identical bytes, or the largest difference."""

import filecmp
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise.study.records import STUDY_FILE, output_files, place_of_files, record_if_readable

_ROUNDING = 1e-9
"""Largest relative difference of an analysis expected from other BLAS kernels."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """Agreement of a second run with the first.

    Attributes
    ----------
    files
        Number of files that the second run wrote.
    other_bytes
        Names of files whose results differ in the first run, or that it lacks. JSON files that
        differ only in place, machine and their own hash are not among them.
    place
        The folder in which the first run looked for its files, if it is another; else empty.
    relocated
        Whether the two records have different relative paths to that folder.
    numerics
        Names of the entries on machine and libraries that differ.
    largest
        Largest relative difference of two numbers, ``|a - b| / max(|a|, |b|)``. [1]
    where
        File and place of that number; empty if no number differs.
    incomparable
        Files and places where something other than a number differs.
    """

    files: int
    other_bytes: tuple[str, ...]
    place: str
    relocated: bool
    numerics: tuple[str, ...]
    largest: float
    where: str
    incomparable: tuple[str, ...]

    @property
    def agrees(self) -> bool:
        """Whether all numbers agree to the rounding of other processors and libraries."""
        return not self.incomparable and self.largest <= _ROUNDING


def agreement_of(first: Path, second: Path) -> Agreement:
    """Agreement of the files of a complete second run with those of the same names in the first.

    Parameters
    ----------
    first, second
        The folders of the runs. The record of a run is compared by its bytes, a result by its
        numbers, a picture by its pixel values.

    Raises
    ------
    InputError
        If the second run is incomplete.
    """
    names = output_files(second)
    other, place, relocated, numerics = [], "", False, set[str]()
    for name in names:
        if _same_bytes(first / name, second / name):
            continue
        one, its = (
            record_if_readable(folder / name) if name.endswith(".json") else {}
            for folder in (first, second)
        )
        if not one or _results(one) != _results(its):
            other.append(name)
        if one.get("place") != its.get("place"):
            relocated = True
            earlier = place_of_files(first, one)
            place = "" if earlier == place_of_files(second, its) else str(earlier or "")
        before, now = map(_numerics, (one, its))
        if before:  # an unreadable record has none
            numerics |= {key for key in before | now if before.get(key) != now.get(key)}
    largest, where, incomparable = 0.0, "", []
    for name in other:
        if name == STUDY_FILE:
            continue
        try:
            found = list(_differences(first / name, second / name))
        except (OSError, ValueError, KeyError):  # missing, or not a file that a run wrote
            found = [(np.inf, "")]
        for difference, at in found:
            if not np.isfinite(difference):
                incomparable.append(f"{name} {at}".strip())
            elif difference > largest:
                largest, where = difference, f"{name} {at}".strip()
    return Agreement(
        files=len(names),
        other_bytes=tuple(other),
        place=place,
        relocated=relocated,
        numerics=tuple(sorted(numerics)),
        largest=largest,
        where=where,
        incomparable=tuple(incomparable),
    )


def agreement_text(found: Agreement) -> str:
    """The agreement in one sentence.

    Parameters
    ----------
    found
        The compared results.
    """
    parts = []
    if found.place:
        parts.append(f"the original was made with files in {found.place}")
    if found.numerics:
        parts.append(f"machine or libraries of the original differ: {', '.join(found.numerics)}")
    if not found.other_bytes:
        what = "the same results" if parts or found.relocated else "the same bytes"
        return "; ".join([f"all {found.files} files have {what} as the original", *parts])
    parts.insert(0, f"{len(found.other_bytes)} of {found.files} files differ from the original")
    if found.incomparable:
        more = f" and {len(found.incomparable) - 3} more" if len(found.incomparable) > 3 else ""
        parts.append(f"not comparable: {', '.join(found.incomparable[:3])}{more}")
    if found.where:
        size = "within" if found.largest <= _ROUNDING else "above"
        parts.append(
            f"the largest relative difference of a number is {found.largest:.1e}, at {found.where}"
            f" ({size} the {_ROUNDING:g} expected from other processors and libraries)"
        )
    elif not found.incomparable:
        parts.append("all numbers are equal")
    return "; ".join(parts)


def _same_bytes(first: Path, second: Path) -> bool:
    try:
        return filecmp.cmp(first, second, shallow=False)
    except OSError:
        return False


def _numerics(record: dict[str, Any]) -> dict[str, Any]:
    found = record.get("numerics")
    return found if isinstance(found, dict) else {}


def _results(record: dict[str, Any]) -> dict[str, Any]:
    """All but what depends on place and machine, and the hash of all."""
    return {key: record[key] for key in record.keys() - {"place", "numerics", "content"}}


def _differences(first: Path, second: Path) -> Iterator[tuple[float, str]]:
    if second.suffix == ".json":
        one, other = (record_if_readable(path)["result"] for path in (first, second))
        yield from _of_data(one, other, "")
    elif second.suffix in (".tiff", ".dng", ".png"):
        yield _of_pixels(_pixels(first), _pixels(second)), ""
    else:
        yield np.inf, ""


def _of_data(one: Any, other: Any, place: str) -> Iterator[tuple[float, str]]:
    if isinstance(one, dict) and isinstance(other, dict) and one.keys() == other.keys():
        for key in one:
            yield from _of_data(one[key], other[key], f"{place}/{key}")
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for i, (each, its) in enumerate(zip(one, other, strict=True)):
            yield from _of_data(each, its, f"{place}/{i}")
    elif one != other:
        numbers = all(type(value) in (int, float) for value in (one, other))
        yield (abs(one - other) / max(abs(one), abs(other)) if numbers else np.inf), place


def _pixels(path: Path) -> Array:
    if path.suffix == ".png":
        from PIL import Image

        with Image.open(path) as image:
            return np.asarray(image, dtype=np.float64)
    import tifffile

    return np.asarray(tifffile.imread(path), dtype=np.float64)


def _of_pixels(one: Array, other: Array) -> float:
    if one.shape != other.shape:
        return float(np.inf)
    most = np.maximum(np.abs(one), np.abs(other))
    return float(np.max(np.abs(one - other) / np.where(most > 0, most, 1.0), initial=0.0))
