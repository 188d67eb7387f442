"""A color with its noise: the input of every propagation method."""

from dataclasses import dataclass

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.color.matrices import XYZ
from chromanoise.errors import InputError
from chromanoise.noise import (
    Measurement,
    NoiseSources,
    Readout,
    raw_measurement,
    sensor_moments,
    through,
)

UNBOUNDED = Readout()
"""A readout without clipping and rounding, as in the paper."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ElectronSource:
    """Channels with the exact Poisson-Gaussian distribution, and their matrix to X, Y, Z.

    Attributes
    ----------
    mean_e
        Expected electrons per channel, >= 0. [e-]
    matrix
        From electrons to X, Y, Z, e.g. `ColorMatrix.matrix`. [lx/e-]
    noise
        The noise sources of the pixel.
    readout
        Bounds and step; by default nothing is clipped or rounded.

    Raises
    ------
    InputError
        If a mean is negative or not finite, or the number of columns of the matrix differs from the
        number of channels.
    """

    mean_e: Float[Array, "*px p"]
    matrix: Float[Array, "3 p"]
    noise: NoiseSources
    readout: Readout = UNBOUNDED

    def __post_init__(self) -> None:
        mean = _check.non_negative("mean_e", "e-", self.mean_e)
        _check.same_length("channels", mean_e=mean.shape[-1], matrix=self.matrix.shape[1])
        object.__setattr__(self, "mean_e", mean)
        _check.freeze(self, "mean_e", "matrix")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NoisyColor:
    """X, Y, Z of one point or of each pixel, with their noise and their white.

    Attributes
    ----------
    xyz
        Mean and covariance of X, Y, Z after readout.
    white
        XYZ of a perfect white under the same light, in the unit of ``xyz``.
    source
        The electrons from which ``xyz`` is computed; ``None`` where only mean and covariance are
        known.

    Raises
    ------
    InputError
        If the coordinates of ``xyz`` are not X, Y, Z.
    """

    xyz: Measurement
    white: Float[Array, " 3"]
    source: ElectronSource | None = None

    def __post_init__(self) -> None:
        if self.xyz.names != XYZ:
            raise InputError(
                f"coordinates of the {self.xyz.kind} measurement",
                "must be X, Y, Z",
                value=self.xyz.names,
                found=f"are {', '.join(self.xyz.names)}",
                remedy="pass it through a color matrix first",
            )
        _check.freeze(self, "white")

    @property
    def noiseless_xyz(self) -> Float[Array, "*px 3"]:
        """The color of the expected electrons, unclipped; the mean where electrons are unknown."""
        if self.source is None:
            return self.xyz.mean
        mean = self.source.mean_e
        rows = mean.reshape(-1, mean.shape[-1])  # same rounding for one point as for many
        return (rows @ self.source.matrix.T).reshape(*mean.shape[:-1], 3)


def noisy_color(source: ElectronSource, white: Float[Array, " 3"]) -> NoisyColor:
    """The color of these electrons, with the exact mean and covariance of X, Y, Z. [lx]

    Parameters
    ----------
    source
        Channels and their matrix.
    white
        XYZ of a perfect white under the same light. [lx]

    Raises
    ------
    InputError
        As `chromanoise.noise.sensor_moments`.

    Examples
    --------
    100 electrons with 10 e- of read noise, 0.01 lx each: mean 1 lx, variance 200 / 100^2.

    >>> import numpy as np
    >>> from chromanoise.color import ElectronSource, noisy_color
    >>> from chromanoise.noise import NoiseSources
    >>> from chromanoise.sensor import PAPER_PIXEL
    >>> source = ElectronSource(mean_e=np.array([100.0]), matrix=np.full((3, 1), 0.01),
    ...                         noise=NoiseSources(pixel=PAPER_PIXEL))
    >>> noisy_color(source, np.ones(3)).xyz.variance
    array([0.02, 0.02, 0.02])
    """
    read = sensor_moments(source.mean_e, source.noise, source.readout)
    channels = range(source.mean_e.shape[-1])
    raw = raw_measurement(read, tuple(f"channel {i}" for i in channels))
    xyz = through(raw, source.matrix, names=XYZ, kind="XYZ", unit="lx")
    return NoisyColor(xyz=xyz, white=white, source=source)
