"""Input of all denoising methods: planes of independent noise, and variance stabilization.

A mosaic becomes one plane per place of its tile, so the methods have no code for mosaics.
`DenoisingMethod` declares a method.

Methods that expect white Gaussian noise take stabilized planes of unit noise: the generalized
Anscombe transform with the sensitivity of the pixels folded in, and its exact unbiased inverse.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from chromanoise.base import Array, Float, Float32, InputError, check, dataclass, eigh, is_absent
from chromanoise.sensor import VarianceLaw

SIDE = 4
"""Rows and columns of a patch. [pixels]"""
PLACES = SIDE * SIDE


@dataclass(frozen=True, kw_only=True, eq=False)
class NoisyPlanes:
    """Noisy values of every plane at every pixel, and the model of their noise.

    Attributes
    ----------
    values_e
        Noisy values; the noise of pixels and planes is independent. [e-]
    law
        Variance of the noise, per plane; a law without planes counts for all of them.
    prior_e2
        Covariance of the planes over typical scenes, e.g. the ColorChecker. [e-^2]
    prior_mean_e
        Mean of the planes over typical scenes. [e-]
    names
        Names of the planes.
    needed
        First row whose estimate is needed, and the row after the last; all if ``None``. A method
        may leave out the work for the others.

    Raises
    ------
    InputError
        If a value is not finite, or the lengths differ.
    """

    values_e: Float32[Array, "h w p"]
    law: VarianceLaw
    prior_e2: Float[Array, "p p"]
    prior_mean_e: Float[Array, " p"]
    names: tuple[str, ...]
    needed: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        if not np.isfinite(self.values_e).all():
            check.finite("values_e", "e-", self.values_e)
        check.non_negative("prior_mean_e", "e-", self.prior_mean_e)
        check.finite("prior_e2", "e-^2", self.prior_e2)
        check.same_length(
            "planes",
            names=len(self.names),
            values=self.values_e.shape[-1],
            prior=len(self.prior_e2),
            mean=len(self.prior_mean_e),
        )
        object.__setattr__(self, "law", self.law.of_planes(len(self.names)))
        check.freeze(self, "prior_e2", "prior_mean_e")

    def variance_e2(self, mean_e: Float[Array, "*px p"]) -> Float[Array, "*px p"]:
        """Variance of the noise at a mean; a mean below 0, from noise, counts as 0. [e-^2]

        Parameters
        ----------
        mean_e
            Mean of each plane. [e-]

        Examples
        --------
        >>> planes = NoisyPlanes(
        ...     values_e=np.zeros((1, 1, 1), np.float32), prior_e2=np.eye(1),
        ...     law=VarianceLaw(floor_e2=25.0, slope_e=1.0, square=0.01**2),
        ...     prior_mean_e=np.ones(1), names=("W",))
        >>> planes.variance_e2(np.array([[-3.0], [1000.0]])).ravel()
        array([  25., 1125.])
        """
        return self.law.variance_e2(np.maximum(mean_e, 0.0))

    def rows(self, start: int, stop: int, *, reach_px: int, grid_px: int) -> "NoisyPlanes":
        """The planes of rows that are needed, and of those that a method reads for them.

        Parameters
        ----------
        start, stop
            First row, and the row after the last.
        reach_px, grid_px
            As `DenoisingMethod` has them.
        """
        first = max(0, (start - reach_px) // grid_px * grid_px)
        part = self.values_e[first : stop + reach_px]
        return replace(self, values_e=part, needed=(start - first, stop - first))

    @property
    def noise_unit_e(self) -> Float[Array, " p"]:
        """Standard deviation of the noise of each plane at the mean of typical scenes. [e-]"""
        return np.sqrt(self.variance_e2(self.prior_mean_e))

    def components(self) -> tuple[Float[Array, "p k"], Float[Array, " k"]]:
        """Orthonormal directions in which signal and noise are both uncorrelated, and their SNR.

        The planes are divided by `noise_unit_e`, so the noise is white in every orthonormal basis;
        this basis diagonalizes the covariance of typical scenes. The first direction has most
        signal and is close to luminance; the last ones hold color below the noise.

        Returns
        -------
        directions, power_snr
            A direction in each column, and the variance of typical scenes along it over that of the
            noise, in descending order. [1]

        Raises
        ------
        InputError
            If a plane has no noise.
        """
        unit = self.noise_unit_e
        if not (unit > 0).all():
            raise InputError(
                "noise of the planes",
                "must be above 0 at the mean of typical scenes",
                value=float(unit.min()),
                remedy="give a read noise above 0",
            )
        power, directions = eigh("prior_e2", self.prior_e2 / np.outer(unit, unit))
        # the sign of a direction is free: the largest entry is positive on every machine
        signs = np.sign(directions[np.abs(directions).argmax(axis=0), np.arange(len(unit))])
        return (directions * signs)[:, ::-1], np.maximum(power[::-1], 0.0)


def packed(
    raw_e: Float32[Array, "h w"], tile: Array
) -> tuple[Float32[Array, "ht wt k"], tuple[int, ...]]:
    """A mosaic as one plane per place of its tile, and the channel of each plane.

    Parameters
    ----------
    raw_e
        One value per pixel, at least one tile of them. An incomplete tile at the border is filled
        with the last pixels of the same place. [e-]
    tile
        Index of the channel at each place (ty tx).

    Raises
    ------
    InputError
        If the mosaic is smaller than its tile.

    Examples
    --------
    >>> raw = np.arange(16, dtype=np.float32).reshape(4, 4)
    >>> planes, channels = packed(raw, np.array([[0, 1], [1, 2]]))
    >>> planes[1, 0], channels
    (array([ 8.,  9., 12., 13.], dtype=float32), (0, 1, 1, 2))
    """
    ty, tx = tile.shape
    if raw_e.shape[0] < ty or raw_e.shape[1] < tx:
        raise InputError(
            "picture",
            f"must have at least the {ty} x {tx} pixels of the mosaic's tile",
            value=raw_e.shape,
            found=f"has {raw_e.shape[0]} x {raw_e.shape[1]}",
        )
    height, width = (-(-n // t) * t for n, t in zip(raw_e.shape, (ty, tx), strict=True))
    rows, columns = (
        _completed(n, whole, t)
        for n, whole, t in zip(raw_e.shape, (height, width), (ty, tx), strict=True)
    )
    whole = raw_e[rows[:, None], columns] if (height, width) != raw_e.shape else raw_e
    planes = whole.reshape(height // ty, ty, width // tx, tx).swapaxes(1, 2)
    return (
        np.ascontiguousarray(planes.reshape(height // ty, width // tx, ty * tx)),
        tuple(int(channel) for channel in tile.ravel()),
    )


def unpacked(
    planes: Float32[Array, "ht wt k"], tile_shape: tuple[int, int], shape: tuple[int, int]
) -> Float32[Array, "h w"]:
    """The mosaic from its planes: the inverse of `packed`.

    Parameters
    ----------
    planes
        One plane per place of the tile. [e-]
    tile_shape
        Rows and columns of the tile.
    shape
        Rows and columns of the mosaic.

    Examples
    --------
    >>> raw = np.arange(15, dtype=np.float32).reshape(3, 5)
    >>> planes, _ = packed(raw, np.array([[0, 1], [1, 2]]))
    >>> bool((unpacked(planes, (2, 2), raw.shape) == raw).all())
    True
    """
    (ty, tx), (rows, columns, _) = tile_shape, planes.shape
    whole = planes.reshape(rows, columns, ty, tx).swapaxes(1, 2).reshape(rows * ty, columns * tx)
    return np.ascontiguousarray(whole[: shape[0], : shape[1]])


def _completed(count: int, whole: int, period: int) -> Array:
    """Indices 0 to ``whole`` - 1; those from ``count`` on are of the last pixel of their phase."""
    places = np.arange(whole)
    places[count:] -= period
    return places


Denoise = Callable[[NoisyPlanes], Float32[Array, "h w p"]]
"""From noisy planes to planes of the same shape. [e-]"""


@dataclass(frozen=True, kw_only=True)
class DenoisingMethod:
    """A denoising method: its function and its properties.

    Attributes
    ----------
    name
        Name on the command line and in studies.
    what
        One or two sentences for users.
    denoise
        The function. It depends on rows and columns only through multiples of ``grid_px``. Rows of
        its result that are not needed are undefined.
    reach_px
        Largest number of rows between a value and the values on which it depends; ``None`` if it
        depends on the whole picture, which is then not cut into strips. [pixels]
    grid_px
        Period of the positions at which the method works, e.g. of its pyramid. [pixels]
    linear
        Whether the result is linear in the values, so that its noise has a closed form.
    baseline
        Whether the method is for comparison only: none, or one of another package.
    packages
        What it imports of the extra ``denoise``.
    compiled
        Whether it has compiled kernels only, and needs numba.
    """

    name: str
    what: str
    denoise: Denoise
    reach_px: int | None
    grid_px: int = 1
    linear: bool = False
    baseline: bool = False
    packages: tuple[str, ...] = ()
    compiled: bool = False

    @property
    def absent_packages(self) -> tuple[tuple[str, str], ...]:
        """What it needs and is not installed, each with the extra that installs it."""
        needed = [(package, "denoise") for package in self.packages]
        needed += [("numba", "compiled")] if self.compiled else []
        return tuple((package, extra) for package, extra in needed if is_absent(package))


_EXACT_COUNTS = 400.0  # mean counts up to which the expectation is summed
_MEANS = 48
_SDS, _STEPS = 6.0, 121  # of the Gaussian part: reach and number of nodes


def stabilized(planes: NoisyPlanes) -> Float[Array, "h w p"]:
    """Values with a variance of about 1 at every signal. [1]

    Parameters
    ----------
    planes
        Noisy values and their noise.

    Raises
    ------
    InputError
        If a plane has neither a noise floor nor shot noise.

    Notes
    -----
    The integral of 1 / (variance at the mean m)^(1/2), with 3/8 slope^2 added to the floor. Without
    PRNU this is the generalized Anscombe transform (Starck, Murtagh & Bijaoui, "Image processing
    and data analysis", 1998, eq. 1.61) up to a constant. The variance of PRNU, which differs from
    pixel to pixel independently, is folded in as its part that grows with m^2; this makes the
    transform grow logarithmically where PRNU dominates. Values at which the variance of the formula
    would be negative count as those at which it is 0, as in the reference.

    Measured with 400,000 draws each: the standard deviation is 0.97 to 1.05 at any signal for a
    read noise of 1 to 10 e-, 1.00 +- 0.01 from 10 e- of signal on, and falls to 0 with the signal
    where there is no read noise.

    Examples
    --------
    Without PRNU, twice the root of the electrons plus 3/8 and the variance of the readout.

    >>> planes = NoisyPlanes(
    ...     values_e=np.array([[[0.0], [96.0]]], np.float32), prior_e2=np.eye(1),
    ...     law=VarianceLaw(floor_e2=3.625, slope_e=1.0), prior_mean_e=np.ones(1), names=("W",))
    >>> stabilized(planes).ravel()                                          # 2 (10 - 2)
    array([ 0., 16.])
    """
    out = np.empty(planes.values_e.shape)
    for i, law in enumerate(_laws(planes)):
        out[..., i] = _forward(planes.values_e[..., i], law)
    return out


def unstabilized(stable: Float[Array, "h w p"], planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    """Exact unbiased inverse of `stabilized`: the mean of the values before it. [e-]

    Parameters
    ----------
    stable
        Denoised values of `stabilized`: estimates of the mean of the stabilized values. [1]
    planes
        The planes that were stabilized.

    Notes
    -----
    Makitalo & Foi, "Optimal inversion of the generalized Anscombe transformation for
    Poisson-Gaussian noise", IEEE Trans. Image Process. 22 (2013) 91. The expectation is summed up
    to 400 counts, not approximated; above, the asymptotic inverse agrees within 1e-3 e-. The
    algebraic inverse continues below the expectation of no signal, so that residual noise around
    0 is not clipped, which would brighten dark areas.
    """
    out = np.empty(stable.shape, np.float32)
    for i, law in enumerate(_laws(planes)):
        expected, bias_e = _biases(*law.coefficients.tolist())
        algebraic = _inverse(stable[..., i], law)
        out[..., i] = algebraic + np.interp(stable[..., i], expected, bias_e)
    return out


def _laws(planes: NoisyPlanes) -> list[VarianceLaw]:
    """The law of each plane, checked."""
    laws = [planes.law.take(i) for i in range(len(planes.names))]
    for name, law in zip(planes.names, laws, strict=True):
        if not law.floor_e2 + law.slope_e > 0:
            raise InputError(
                f"noise of plane {name}",
                "must be above 0 without signal, or be shot noise, to be stabilized",
                value=float(law.floor_e2),
                remedy="give a read noise above 0",
            )
    return laws


def with_raised_floor(law: VarianceLaw) -> VarianceLaw:
    """The law with 3/8 slope^2 added: the noise of few electrons is stable with it.

    Parameters
    ----------
    law
        Variance of a value.

    Notes
    -----
    Anscombe, Biometrika 35 (1948) 246.
    """
    return law + VarianceLaw(floor_e2=0.375 * law.slope_e**2)


def deviations_from_dark(mean_e: Float[Array, "*px p"], law: VarianceLaw) -> Float[Array, "*px p"]:
    """The integral of 1 / (standard deviation at a mean) from 0 to a mean. [1]

    Parameters
    ----------
    mean_e
        Means at which the variance is not below 0; negative ones are possible. [e-]
    law
        Variance; its floor is above 0.

    Notes
    -----
    2 artanh(k m / (sd(m) + sd(0))) / k with the square k^2, as log1p(k u) / k, in which nothing
    cancels where k m is the largest noise.
    """
    mean = np.asarray(mean_e, dtype=np.float64)
    k, dark = np.sqrt(law.square), np.sqrt(law.floor_e2)
    both = np.sqrt(np.maximum(law.variance_e2(mean), 0.0)) + dark
    if not k.any():
        return np.asarray(2.0 * mean / both)
    some = np.where(k > 0, k, 1.0)
    u = 2.0 * mean * (some + (law.slope_e + some**2 * mean) / both)
    bent = np.log1p(some * u / (2.0 * some * dark + law.slope_e)) / some
    return np.where(k > 0, bent, 2.0 * mean / both)


def _forward(y: Array, law: VarianceLaw) -> Array:
    raised = with_raised_floor(law)
    floor, slope, square = raised.coefficients
    discriminant = slope**2 - 4 * square * floor
    if slope > 0 and discriminant >= 0:
        y = np.maximum(y, -2 * floor / (slope + np.sqrt(discriminant)))
    return deviations_from_dark(y, raised)


def _inverse(z: Array, law: VarianceLaw) -> Array:
    """The value whose `_forward` is ``z``, continued to all z."""
    floor, slope, square = with_raised_floor(law).coefficients
    k, dark = np.sqrt(square), np.sqrt(floor)
    half = np.tanh(k * z / 2) / k if k else z / 2
    half = np.maximum(half, -dark / slope if slope else -np.inf)
    return np.asarray(half * (2 * dark + slope * half) / (1 - square * half**2))


@lru_cache(maxsize=64)
def _biases(floor_e2: float, slope_e: float, square: float) -> tuple[Array, Array]:
    """Expectations of stabilized values, rising, and mean minus algebraic inverse at each."""
    law = VarianceLaw(floor_e2=floor_e2, slope_e=slope_e, square=square)
    counts = np.concatenate([[0.0], np.geomspace(0.01, _EXACT_COUNTS, _MEANS)])
    scale = slope_e or np.sqrt(floor_e2)
    means = counts * scale
    expected = [_expected(m, law) for m in means]
    far = scale * np.geomspace(1.02 * _EXACT_COUNTS, 1e9, 2 * _MEANS)
    variance = law.variance_e2(far)
    curvature = (2 * square * far + slope_e) / (2 * with_raised_floor(law).variance_e2(far))
    far_bias = 0.5 * variance * curvature
    z = np.array([*expected, *_forward(far - far_bias, law)])
    bias = np.concatenate([means - _inverse(np.array(expected), law), far_bias])
    return z, bias


def _expected(mean: float, law: VarianceLaw) -> float:
    """Expectation of the stabilized values of a mean: Poisson counts, and a Gaussian for the rest.

    The Gaussian has the variance of the readout and of PRNU.
    """
    from scipy.special import gammaln, xlogy

    at = np.linspace(-_SDS, _SDS, _STEPS)
    weights = np.exp(-0.5 * at**2)
    weights /= weights.sum()
    slope = law.slope_e
    values = np.sqrt(replace(law, slope_e=0.0).variance_e2(mean)) * at
    if slope == 0:
        return float(weights @ _forward(mean + values, law))
    rate = mean / slope
    k = np.arange(int(rate + 10 * np.sqrt(rate) + 20))
    probability = np.exp(xlogy(k, rate) - rate - gammaln(k + 1))
    stable = _forward(slope * k[:, None] + values, law)
    return float(probability @ stable @ weights)
