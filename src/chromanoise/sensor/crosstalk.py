"""Mosaics, and crosstalk: photons or charge of one pixel that end in its neighbors.

A mosaic gives the channel of each pixel. Before counting (light or charge that diffuses one by one)
the channels stay independent: a random part of a Poisson count is a Poisson count. After counting
(interpixel capacitance) the readings of neighbors are correlated. Agranov, Berezin & Tsai,
"Crosstalk and microlens study in a color CMOS image sensor", IEEE Trans. Electron Devices 50 (2003)
4.
"""

import math
import re
from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    InputError,
    Int,
    Setting,
    check,
    dataclass,
    inv,
    known_name,
    svd,
)


@dataclass(frozen=True)
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
            check.one_of("mosaic", text, MOSAIC_NAMES)
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


Stage = Literal["light", "charge"]

_ROUNDING = 1e-9
_SAME_SHARE = 1e-12  # two shares that differ by less are one
_LEAST_SINGULAR = 1e-10  # of the largest: below, a mixing cannot be undone
_EQUAL = "name the mosaic if the channels have different numbers of pixels"


@dataclass(frozen=True, kw_only=True, eq=False)
class Places:
    """Shares of the channels that each place of one period of a mosaic receives.

    Attributes
    ----------
    tile
        Channel of each place.
    shares
        Share of each channel that the place receives, from all its neighbors together. [1]
    squares
        Sum of the squares of the shares of the single neighbors. [1]
    """

    tile: Int[Array, "ty tx"]
    shares: Float[Array, "ty tx p"]
    squares: Float[Array, "ty tx p"]

    def __post_init__(self) -> None:
        check.freeze(self, "tile", "shares", "squares")

    def channel_means(self, values: Float[Array, "ty tx p"]) -> Float[Array, "p p"]:
        """Means of the values over the places of each channel (rows)."""
        total = np.zeros((values.shape[-1], values.shape[-1]))
        np.add.at(total, self.tile, values)
        return total / np.bincount(self.tile.ravel())[:, None]

    def deviations(self, mean_shares: Float[Array, "p p"]) -> Float[Array, "ty tx p"]:
        """Shares of each place minus those of its channel; 0 below rounding. [1]

        Parameters
        ----------
        mean_shares
            A row of shares per channel. [1]
        """
        away = self.shares - mean_shares[self.tile]
        return np.where(np.abs(away) > _SAME_SHARE, away, 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Crosstalk:
    """How the channels mix: M' = X M, with M the electrons without crosstalk.

    Attributes
    ----------
    matrix
        X: row i holds the shares of each channel that channel i receives. [1]
    pixels
        Pixels of each channel in one period of the mosaic; equal numbers for one pixel each. They
        weigh the balance: what a channel loses is what the others gain.
    stage
        ``light``: before counting. ``charge``: after counting, so that readings are correlated.
    kernel
        Shares of one pixel that end around it, from which the matrix was made; ``None`` where
        only the matrix is known. [1]
    places
        What each place of the mosaic receives by the kernel; the matrix is its mean over the
        places of each channel. ``None`` where only the matrix is known.

    Raises
    ------
    InputError
        If the matrix is not square, an entry is negative or not finite, or a channel gives more
        light than it has.
    """

    matrix: Float[Array, "p p"]
    pixels: tuple[int, ...]
    stage: Stage = "light"
    kernel: Float[Array, "ky kx"] | None = None
    places: Places | None = None

    def __post_init__(self) -> None:
        check.one_of("stage of the crosstalk", self.stage, get_args(Stage))
        matrix = check.non_negative("crosstalk matrix", "1", self.matrix)
        p = len(self.pixels)
        need = f"must have {p} rows and {p} columns, one per channel"
        check.shape("crosstalk matrix", matrix, matrix.shape == (p, p), need)
        count = np.asarray(self.pixels, dtype=np.float64)
        kept = count @ matrix / count
        if (kept > 1 + _ROUNDING).any():
            column = int(kept.argmax())
            raise InputError(
                "crosstalk matrix",
                "must distribute at most all light of each channel",
                value=float(kept[column]),
                found=f"column {column + 1} distributes {kept[column]:.4g} of it"
                + _weights(count, column),
                remedy=() if len(set(self.pixels)) > 1 else _EQUAL,
            )
        check.keep(self, matrix=matrix)
        check.freeze(self, "kernel")

    @property
    def is_after_counting(self) -> bool:
        """Whether it mixes what the pixels counted, so that their readings are correlated."""
        return self.stage != "light"

    @property
    def inverse(self) -> Float[Array, "p p"] | None:
        """X^-1; ``None`` where X is singular. [1]"""
        singular = svd("crosstalk", self.matrix, compute_uv=False)
        if singular[-1] < _LEAST_SINGULAR * singular[0]:
            return None
        return inv("crosstalk", self.matrix)

    @property
    def squares(self) -> Float[Array, "p p"]:
        """Squared shares: factors from the noise variance of each channel to that of a reading. [1]

        Sums of the squared shares of the single neighbors, averaged over the places of each channel
        (rows). If only the matrix is known, the squares of its entries.
        """
        if self.places is None:
            return self.matrix**2
        return self.places.channel_means(self.places.squares)

    @property
    def deviations(self) -> Float[Array, "ty tx p"] | None:
        """Shares of each place minus those of its channel; ``None`` where all are equal. [1]"""
        if self.places is None:
            return None
        away = self.places.deviations(self.matrix)
        return away if away.any() else None


def refuse_other_channels(mosaic: Mosaic, names: Sequence[str]) -> None:
    """Refuse a mosaic that has other channels than the sensor.

    Parameters
    ----------
    mosaic
        Which channel each pixel has.
    names
        Names of the channels.

    Raises
    ------
    InputError
        If it has.
    """
    if set(names) != set(mosaic.names):
        raise InputError(
            "mosaic",
            "must have the channels of the sensor",
            value=mosaic.names,
            found=f"it has {', '.join(mosaic.names)}, and the sensor {', '.join(names)}",
            remedy=(Setting("mosaic"), f"separate names by spaces, e.g. {' '.join(names)}"),
        )


def _weights(pixels: Float[Array, " p"], column: int) -> str:
    """How the rows count, where the channels have different numbers of pixels."""
    if len(set(pixels.tolist())) == 1:
        return ""
    weights = ", ".join(f"{weight:.3g}" for weight in pixels / pixels[column])
    return f", its rows multiplied by {weights} for the pixels of the mosaic"


def shares_after_counting(crosstalk: Crosstalk | None) -> Float[Array, "ky kx"] | None:
    """The kernel of crosstalk after counting; a matrix alone does not tell the neighbors. [1]

    Parameters
    ----------
    crosstalk
        Crosstalk of the sensor; ``None`` without any.
    """
    return crosstalk.kernel if crosstalk is not None and crosstalk.is_after_counting else None


def crosstalk_of_share(share: float, mosaic: Mosaic, names: Sequence[str]) -> Crosstalk:
    """The share of the light of each pixel that ends in its four neighbors.

    Parameters
    ----------
    share
        0 to 1; a quarter of it reaches each of the four neighbors. [1]
    mosaic
        The channel of each pixel.
    names
        The channels of the sensor.

    Raises
    ------
    InputError
        If the share is not 0 to 1, or mosaic and sensor have different channels.

    Examples
    --------
    Bayer: R' = (1-c) R + c G, G' = (1-c) G + c (R + B)/2, B' = (1-c) B + c G.

    >>> from chromanoise.sensor import bayer
    >>> crosstalk_of_share(0.1, bayer(), ("R", "G", "B")).matrix
    array([[0.9 , 0.1 , 0.  ],
           [0.05, 0.9 , 0.05],
           [0.  , 0.1 , 0.9 ]])
    """
    share = check.within("crosstalk", "1", share, 0.0, 1.0)
    quarter = share / 4
    kernel = np.array([[0, quarter, 0], [quarter, 1 - share, quarter], [0, quarter, 0]])
    return crosstalk_of_kernel(kernel, mosaic, names)


def crosstalk_of_kernel(
    kernel: Float[Array, "ky kx"], mosaic: Mosaic, names: Sequence[str]
) -> Crosstalk:
    """Crosstalk between neighbors of a mosaic, averaged over the pixels of each channel.

    Parameters
    ----------
    kernel
        Shares of the light of one pixel that end in the pixels around it; odd in both sizes, the
        pixel itself in the middle. The sum is at most 1; the rest is lost. [1]
    mosaic
        The channel of each pixel.
    names
        The channels of the sensor.

    Raises
    ------
    InputError
        If the kernel is not odd, negative, or has a sum above 1, or mosaic and sensor have
        different channels.
    """
    kernel = check.non_negative("crosstalk kernel", "1", kernel)
    odd = kernel.ndim == 2 and all(size % 2 for size in kernel.shape)
    need = "must have an odd number of rows and columns, the pixel in the middle"
    check.shape("crosstalk kernel", kernel, odd, need)
    if kernel.sum() > 1 + _ROUNDING:
        raise InputError(
            "crosstalk kernel",
            "must distribute at most all light of a pixel",
            value=float(kernel.sum()),
            found=f"distributes {kernel.sum():.4g} of it",
        )
    places = places_of_mosaic(kernel, mosaic, names)
    return Crosstalk(
        matrix=places.channel_means(places.shares),
        pixels=tuple(np.bincount(places.tile.ravel()).tolist()),
        kernel=kernel,
        places=places,
    )


def places_of_mosaic(kernel: Float[Array, "ky kx"], mosaic: Mosaic, names: Sequence[str]) -> Places:
    """What each place of a mosaic receives by a kernel.

    Parameters
    ----------
    kernel, mosaic, names
        As `crosstalk_of_kernel`.

    Raises
    ------
    InputError
        If mosaic and sensor have different channels.
    """
    refuse_other_channels(mosaic, names)
    tile = np.array([[names.index(name) for name in row] for row in mosaic.pattern])
    height, width = tile.shape
    shares, squares = np.zeros((2, *tile.shape, len(names)))
    middle_y, middle_x = (size // 2 for size in kernel.shape)
    for y, x in np.ndindex(tile.shape):
        for (dy, dx), share in np.ndenumerate(kernel):
            source = tile[(y - dy + middle_y) % height, (x - dx + middle_x) % width]
            shares[y, x, source] += share
            squares[y, x, source] += share**2
    return Places(tile=tile, shares=shares, squares=squares)
