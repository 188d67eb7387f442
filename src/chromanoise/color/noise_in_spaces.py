"""A color with its noise, and that noise in a color space, by one of three methods.

===============  =================================================  =============================
method           uses                                               accurate
===============  =================================================  =============================
`first_order`    the Jacobian of the space at the mean: J S J^T     for small noise
`cubature`       X, Y, Z as jointly normal, by cubature             for many electrons
`exact`          the exact Poisson-Gaussian distribution            always; reports its own error
===============  =================================================  =============================

A method is a function of a `NoisyColor` and a `Space`; set its accuracy by `functools.partial`:
``partial(exact, points=2**13)``.
"""

from collections.abc import Callable
from dataclasses import fields

import numpy as np

from chromanoise.base import Array, Float, InputError, check, dataclass
from chromanoise.color.matrices import XYZ
from chromanoise.color.spaces import Space
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


@dataclass(frozen=True, kw_only=True, eq=False)
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
        mean = check.non_negative("mean_e", "e-", self.mean_e)
        check.same_length("channels", mean_e=mean.shape[-1], matrix=self.matrix.shape[1])
        check.keep(self, mean_e=mean, matrix=self.matrix)


@dataclass(frozen=True, kw_only=True, eq=False)
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
        check.freeze(self, "white")

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


FIRST_ORDER_TOLERANCE = 0.05
"""Largest relative error of a standard deviation up to which the first order is valid."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SpaceMoments:
    """Result of a propagation method, from which `propagate` creates a `ColorNoise`.

    Attributes
    ----------
    bias
        Mean minus the coordinates of the color without noise.
    covariance
        Covariance of the coordinates.
    chroma_sd, chroma_bias, delta_e
        As in `ColorNoise`; ``None`` in a space without color differences.
    mean_error, sd_error
        Standard errors of this method; ``None`` if it reports none.
    """

    bias: Float[Array, "*px 3"]
    covariance: Float[Array, "*px 3 3"]
    chroma_sd: Float[Array, "*px"] | None = None
    chroma_bias: Float[Array, "*px"] | None = None
    delta_e: Float[Array, "*px"] | None = None
    mean_error: Float[Array, "*px 3"] | None = None
    sd_error: Float[Array, "*px 3"] | None = None


Method = Callable[[NoisyColor, Space], SpaceMoments]
"""`first_order`, `cubature`, `exact`, or a function of your own."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ColorNoise(SpaceMoments):
    """Noise of one color, or of each pixel of a picture, in a color space.

    Attributes
    ----------
    measurement
        Mean and covariance of the coordinates; its kind is the name of the space.
    noiseless
        Coordinates of the color without noise and without clipping.
    bias, covariance
        Mean minus ``noiseless``; covariance of the coordinates.
    chroma_sd
        Standard deviation of C*. At a neutral, where C* has a kink, the first order returns the
        largest one in any direction.
    chroma_bias
        Mean of C* minus that of ``noiseless``; positive for a gray, because noise adds chroma.
    delta_e
        Mean CIE 1976 color difference to ``noiseless``. All three are ``None`` in a space where a
        distance is not a color difference. [1]
    mean_error, sd_error
        Standard error of the mean and of the standard deviation per coordinate, estimated by the
        method; ``None`` for a method that reports none.
    """

    measurement: Measurement
    noiseless: Float[Array, "*px 3"]

    def __post_init__(self) -> None:
        check.freeze(self, "noiseless", *(one.name for one in fields(SpaceMoments)))

    @property
    def sd(self) -> Float[Array, "*px 3"]:
        """Standard deviation per coordinate."""
        return np.sqrt(self.measurement.variance)


def propagate(color: NoisyColor, space: Space, method: Method) -> ColorNoise:
    """Mean, covariance and bias of a noisy color in ``space``.

    Parameters
    ----------
    color
        X, Y, Z with their noise; `exact` also needs its source, as returned by `noisy_color`.
    space
        Coordinates of the result, e.g. `chromanoise.color.LAB`.
    method
        `first_order`, `cubature`, `exact`, or one of them with its accuracy set by
        `functools.partial`.

    Raises
    ------
    InputError
        If the white is not above 0, or as the method.

    Notes
    -----
    CIE 015:2018, eq. 8.11 (C*), 8.21 and 8.36 (color difference).

    Examples
    --------
    >>> from chromanoise.color import LAB, first_order
    >>> xyz = Measurement(mean=np.full(3, 0.125), covariance=np.diag([0.0, 1e-6, 0.0]),
    ...                   names=("X", "Y", "Z"), kind="XYZ", unit="1")
    >>> noise = propagate(NoisyColor(xyz=xyz, white=np.ones(3)), LAB, first_order)
    >>> noise.sd[0].round(6)                                      # (42 + 16) / 3 / 125
    np.float64(0.154667)
    """
    found = method(color, space)
    noiseless = space.from_xyz(color.noiseless_xyz, color.white)
    measurement = Measurement(
        mean=noiseless + found.bias,
        covariance=0.5 * (found.covariance + np.swapaxes(found.covariance, -1, -2)),
        names=space.coordinates,
        kind=space.name,
        unit="1",
    )
    moments = {one.name: getattr(found, one.name) for one in fields(SpaceMoments)}
    return ColorNoise(measurement=measurement, noiseless=noiseless, **moments)


def relative_sd_error(rough: Measurement, trusted: Measurement) -> Float[Array, "*px q"]:
    """Relative error of each standard deviation of one method against another: ratio minus 1.

    -0.1 means 10 % too low, 0 equal (or both without noise), inf that only the rough method finds
    noise. The first order is valid while the absolute value is within `FIRST_ORDER_TOLERANCE`.

    Parameters
    ----------
    rough, trusted
        Measurements of the same coordinates by two methods.

    Examples
    --------
    >>> rough, right = (Measurement(mean=np.zeros(1), covariance=np.array([[v]]), names=("L*",),
    ...                             kind="CIELAB", unit="1") for v in (4.0, 16.0))
    >>> relative_sd_error(rough, right)
    array([-0.5])
    """
    one, two = np.sqrt(rough.variance), np.sqrt(trusted.variance)
    size = 1 + np.abs(rough.mean).max(axis=-1, keepdims=True)
    largest = np.maximum(one, two).max(axis=-1, keepdims=True)
    nothing = np.maximum(1e-9 * largest, 1e-13 * size)  # below it, it is rounding
    one, two = np.where(one > nothing, one, 0.0), np.where(two > nothing, two, 0.0)
    ratio = np.where(two > 0, one / np.where(two > 0, two, 1.0), np.where(one > 0, np.inf, 1.0))
    return ratio - 1
