"""Mosaics: the channel of each pixel."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from chromanoise import _check
from chromanoise.errors import InputError, known_name


@dataclass(frozen=True, slots=True)
class Mosaic:
    """The smallest block of channel names that tiles the sensor.

    Attributes
    ----------
    pattern
        Rows of channel names, all of the same length.

    Raises
    ------
    InputError
        If the pattern is empty, or the rows have different lengths.
    """

    pattern: tuple[tuple[str, ...], ...]

    def __post_init__(self) -> None:
        if not self.pattern or not self.pattern[0]:
            raise InputError(
                "mosaic", "must have at least one row with one channel", value=self.pattern
            )
        for i, row in enumerate(self.pattern):
            if len(row) != len(self.pattern[0]):
                raise InputError(
                    "mosaic",
                    "must have rows of equal length",
                    value=(len(self.pattern[0]), len(row)),
                    found=f"row 0 has {len(self.pattern[0])} channels and row {i} has {len(row)}",
                )

    @property
    def names(self) -> tuple[str, ...]:
        """The channels that occur, in order of first appearance."""
        return tuple(dict.fromkeys(name for row in self.pattern for name in row))

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the block."""
        return len(self.pattern), len(self.pattern[0])

    @property
    def place_names(self) -> tuple[str, ...]:
        """Names of the places of the block, row by row: repeated channels are numbered.

        Examples
        --------
        >>> bayer().place_names
        ('R', 'G1', 'G2', 'B')
        """
        channels = [name for row in self.pattern for name in row]
        return tuple(
            name if channels.count(name) == 1 else f"{name}{channels[: i + 1].count(name)}"
            for i, name in enumerate(channels)
        )


def bayer() -> Mosaic:
    """2 x 2, half of it green (Bayer, US 3,971,065)."""
    return _mosaic("RG", "GB")


def rgbw_2x2() -> Mosaic:
    """2 x 2, one pixel of each of R, G, B and W."""
    return _mosaic("RG", "WB")


def rgbw_sparse_4x4() -> Mosaic:
    """4 x 4, three quarters white: few colored pixels in a white sensor."""
    return _mosaic("RWGW", "WWWW", "GWBW", "WWWW")


def rgb_ir() -> Mosaic:
    """2 x 2, one pixel of each of R, G, B and IR."""
    return Mosaic((("R", "G"), ("IR", "B")))


_NAMED = {
    "bayer": bayer,
    "rgbw-2x2": rgbw_2x2,
    "rgbw-4x4": rgbw_sparse_4x4,
    "rgb-ir": rgb_ir,
}
MOSAIC_NAMES = tuple(_NAMED)
"""The names that `mosaic_named` accepts in addition to patterns."""


def mosaic_named(text: str) -> Mosaic:
    """A mosaic by name or pattern: slashes or semicolons separate rows, spaces separate channels.

    If no row contains a space, each letter is a channel.

    Parameters
    ----------
    text
        Name such as ``bayer``, or a pattern such as ``RG/GB``.

    Raises
    ------
    InputError
        If the text is neither a known name nor a pattern with rows of equal length.

    Examples
    --------
    >>> mosaic_named("RG/GB") == bayer()
    True
    >>> mosaic_named("R G/IR B").names
    ('R', 'G', 'IR', 'B')
    >>> mosaic_named("Red Yellow; Yellow Blue").names
    ('Red', 'Yellow', 'Blue')
    """
    text = known_name(text, _NAMED)
    if text in _NAMED:
        return _NAMED[text]()
    rows = [row.strip() for row in re.split("[/;]", text)]
    side = math.isqrt(len(text))
    if side > 1 and side**2 == len(text) and set(text) <= set("RGBW"):
        meant = "/".join(text[i : i + side] for i in range(0, len(text), side))
        raise InputError(
            "mosaic",
            "must have a slash between its rows, e.g. RG/GB",
            value=text,
            remedy=f"did you mean {meant}?",
        )
    if len(rows) == 1 and len(text) > 2 and " " not in text.strip():
        try:
            _check.one_of("mosaic", text, MOSAIC_NAMES)
        except InputError as error:
            raise InputError(
                "mosaic",
                "must be a known name, or rows, e.g. RG/GB",
                value=text,
                remedy=error.remedy,
            ) from None
    if not all(rows):
        raise InputError("mosaic", "must have a channel in each row, e.g. RG/GB", value=text)
    spaced = any(" " in row for row in rows)
    return Mosaic(tuple(tuple(row.split() if spaced else row) for row in rows))


def with_channel_names(mosaic: Mosaic, names: Sequence[str]) -> Mosaic:
    """A mosaic whose single letters are replaced by the channels whose names begin with them.

    A letter stays unchanged if it is itself a channel, or if several names or none begin with it.

    Parameters
    ----------
    mosaic
        A mosaic of channels or letters.
    names
        The channels of the sensor.

    Examples
    --------
    >>> with_channel_names(mosaic_named("RY/YB"), ("Red", "Yellow", "Blue")).pattern
    (('Red', 'Yellow'), ('Yellow', 'Blue'))
    """

    def channel(letter: str) -> str:
        begun = [one for one in names if one.lower().startswith(letter.lower())]
        meant = letter not in names and len(letter) == 1 and len(begun) == 1
        return begun[0] if meant else letter

    return Mosaic(tuple(tuple(map(channel, row)) for row in mosaic.pattern))


def _mosaic(*rows: str) -> Mosaic:
    return Mosaic(tuple(tuple(row) for row in rows))
