"""What the tags of a TIFF file state about the exposure, the camera and its mosaic."""

import math
from typing import Any

from chromanoise.sensor import Mosaic

CFA = 32803
"""PhotometricInterpretation of a mosaic (TIFF/EP, ISO 12234-2)."""
CFA_COLORS = ("R", "G", "B", "C", "M", "Y", "W")
"""Channels by their codes in CFAPattern and CFAPlaneColor."""
_EXIF, _TIME, _ISO = 34665, 33434, 34855
_ISO_NAMES = ("PhotographicSensitivity", "ISOSpeedRatings", "ISOSpeed")
_MAKE, _MODEL, _REPEAT, _PATTERN = 271, 272, 33421, 33422
_MOST_PERIOD = 32
_LONGEST_S = 1e6
_LARGEST_ISO = 1e8


def exposure_of(page: Any) -> dict[str, Any]:
    """``time_ms``, ``iso`` and ``camera`` of a page of tifffile, as far as its tags state them.

    Parameters
    ----------
    page
        The first page, which has the Exif tags.
    """
    exif = _value(page, _EXIF)
    exif = exif if isinstance(exif, dict) else {}
    time_s = number_of_tag(_first(exif.get("ExposureTime"), _value(page, _TIME)))
    iso = number_of_tag(_first(*(exif.get(name) for name in _ISO_NAMES), _value(page, _ISO)))
    return {
        "time_ms": None if time_s is None or not 0 < time_s <= _LONGEST_S else 1000 * time_s,
        "iso": None if iso is None or not 0 < iso <= _LARGEST_ISO else iso,
        "camera": camera_name(*(str(_value(page, tag) or "") for tag in (_MAKE, _MODEL))),
    }


def camera_name(make: str, model: str) -> str:
    """Maker and model without repetition, printable.

    Examples
    --------
    >>> camera_name("NIKON CORPORATION", "NIKON D850"), camera_name("Canon", "Canon EOS R5")
    ('NIKON D850', 'Canon EOS R5')
    """
    make, model = (
        " ".join("".join(c if c.isprintable() else " " for c in text[:200]).split())
        for text in (make, model)
    )
    repeated = make and model.lower().startswith(make.split()[0].lower())
    return (model if repeated else f"{make} {model}").strip()


def mosaic_of(page: Any) -> Mosaic | None:
    """The mosaic from the tags CFARepeatPatternDim and CFAPattern; ``None`` without them.

    Parameters
    ----------
    page
        A page of tifffile.
    """
    sides, codes = _value(page, _REPEAT), _value(page, _PATTERN)
    try:
        rows, columns = (int(side) for side in sides)
        numbers = [int(code) for code in codes]
    except (TypeError, ValueError):
        return None
    if not (0 < rows <= _MOST_PERIOD and 0 < columns <= _MOST_PERIOD):
        return None
    if len(numbers) != rows * columns or not all(0 <= code < len(CFA_COLORS) for code in numbers):
        return None
    letters = [CFA_COLORS[code] for code in numbers]
    return smallest_mosaic([letters[r * columns : (r + 1) * columns] for r in range(rows)])


def smallest_mosaic(rows: list[list[str]]) -> Mosaic:
    """The smallest block that repeats to these rows.

    Examples
    --------
    >>> smallest_mosaic([["R", "G", "R", "G"], ["G", "B", "G", "B"]]).pattern
    (('R', 'G'), ('G', 'B'))
    """
    height, width = len(rows), len(rows[0])
    high = _period([tuple(row) for row in rows], height)
    wide = _period([tuple(row[c] for row in rows) for c in range(width)], width)
    return Mosaic(tuple(tuple(row[:wide]) for row in rows[:high]))


def _period(lines: list[tuple[str, ...]], length: int) -> int:
    for n in range(1, length):
        if length % n == 0 and all(lines[i] == lines[i % n] for i in range(length)):
            return n
    return length


def _value(page: Any, tag: int) -> Any:
    found = page.tags.get(tag)
    return None if found is None else found.value


def _first(*values: Any) -> Any:
    return next((value for value in values if value is not None), None)


def number_of_tag(value: Any) -> float | None:
    """A finite number, a fraction of two numbers, or the first of several; ``None`` otherwise.

    Examples
    --------
    >>> number_of_tag((1, 4)), number_of_tag("12.5"), number_of_tag(True)
    (0.25, 12.5, None)
    """
    if isinstance(value, bool):
        return None
    try:
        if isinstance(value, (tuple, list)) and len(value) == 2 and value[1]:
            value = value[0] / value[1]
        elif isinstance(value, (tuple, list)):
            value = value[0]
        number = float(value)
    except (TypeError, ValueError, IndexError, OverflowError):
        return None
    return number if math.isfinite(number) else None
