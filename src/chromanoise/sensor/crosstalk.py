"""Crosstalk: photons or charge of one pixel that end in its neighbors.

Before counting (light or charge that diffuses one by one) the channels stay independent: a random
part of a Poisson count is a Poisson count. After counting (interpixel capacitance) the readings of
neighbors are correlated. Agranov, Berezin & Tsai, "Crosstalk and microlens study in a color CMOS
image sensor", IEEE Trans. Electron Devices 50 (2003) 4.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import inv, svd
from chromanoise._shapes import Float, Int
from chromanoise.errors import InputError, Setting
from chromanoise.sensor.mosaic import Mosaic

Stage = Literal["light", "charge"]

_ROUNDING = 1e-9
_SAME_SHARE = 1e-12  # two shares that differ by less are one
_LEAST_SINGULAR = 1e-10  # of the largest: below, a mixing cannot be undone
_EQUAL = "name the mosaic if the channels have different numbers of pixels"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        _check.freeze(self, "tile", "shares", "squares")

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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        _check.one_of("stage of the crosstalk", self.stage, get_args(Stage))
        matrix = _check.non_negative("crosstalk matrix", "1", self.matrix)
        p = len(self.pixels)
        if matrix.shape != (p, p):
            raise InputError(
                "crosstalk matrix",
                f"must have {p} rows and {p} columns, one per channel",
                value=matrix.shape,
                found=f"has shape {matrix.shape}",
            )
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
        object.__setattr__(self, "matrix", _check.frozen(matrix))
        if self.kernel is not None:
            object.__setattr__(self, "kernel", _check.frozen(self.kernel))

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
    return None if crosstalk is None or crosstalk.stage == "light" else crosstalk.kernel


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
    share = _check.within("crosstalk", "1", share, 0.0, 1.0)
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
    kernel = _check.non_negative("crosstalk kernel", "1", kernel)
    if kernel.ndim != 2 or not all(size % 2 for size in kernel.shape):
        raise InputError(
            "crosstalk kernel",
            "must have an odd number of rows and columns, the pixel in the middle",
            value=kernel.shape,
            found=f"has shape {kernel.shape}",
        )
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
