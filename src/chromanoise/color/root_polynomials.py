"""Root-polynomial color correction, nonlinear but exposure-invariant, and its noise.

Noise is available to first order by the Jacobian, with a bias of second order from the curvature of
the root, and exactly through moments of single channels. The exact result is also valid in the dark
and shows where the first order is accurate.
"""

from dataclasses import replace
from itertools import combinations, combinations_with_replacement

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Float,
    InputError,
    Setting,
    check,
    dataclass,
    lstsq,
)
from chromanoise.color.matrices import XYZ
from chromanoise.color.training import Training, training_response
from chromanoise.noise import Exposure, Measurement, expectation, with_noise
from chromanoise.sensor import UNKNOWN_CONVERTER, Sensor, shot_and_read_only
from chromanoise.spectra import DEFAULT_OBSERVER, Metric

# where the quadrature is split, in units of the read noise: the root has infinite slope at 0
_ROOT_KINKS = (0.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


@dataclass(frozen=True, kw_only=True, eq=False)
class RootPolynomial:
    """A matrix from root-polynomial terms of the raw electrons to color.

    Attributes
    ----------
    matrix
        One row per color coordinate, one column per term. [lx/e-]
    channels
        Names of the raw channels.
    coordinates
        Names of the rows.
    degree
        1: the channels; 2: also the root of each product of two channels.
    made_by
        Method and training set.
    metric
        Metric of the space of spectra; the fit does not depend on it.
    observer
        The observer of the training set.
    """

    matrix: Float[Array, "c q"]
    channels: tuple[str, ...]
    coordinates: tuple[str, ...]
    degree: int
    made_by: str
    metric: Metric
    observer: str = DEFAULT_OBSERVER

    def __post_init__(self) -> None:
        matrix = check.finite(f"{self.made_by} matrix", "lx/e-", self.matrix)
        p, pairs = len(self.channels), len(_pairs(len(self.channels), self.degree))
        check.same_length("coordinates", names=len(self.coordinates), matrix=matrix.shape[0])
        check.same_length("terms", channels_and_roots=p + pairs, matrix=matrix.shape[1])
        check.keep(self, matrix=matrix)


def rooted(raw_mean: Float[Array, "*px p"], *, degree: int = 2) -> Float[Array, "*px q"]:
    """The channels and, at degree 2, the root of each product of two of them. [e-]

    Parameters
    ----------
    raw_mean
        Electrons, >= 0. [e-]

    Raises
    ------
    InputError
        If an entry is negative, or the degree is neither 1 nor 2.

    Notes
    -----
    Finlayson, Mackiewicz & Hurlbert, "Color correction using root-polynomial regression", IEEE
    Trans. Image Process. 24 (2015), 1460, https://doi.org/10.1109/TIP.2015.2405336, section III.

    Examples
    --------
    >>> rooted(np.array([1.0, 4.0, 9.0]))
    array([1., 4., 9., 2., 3., 6.])
    """
    mean = check.non_negative("raw_mean", "e-", raw_mean)
    pairs = _pairs(mean.shape[-1], degree)
    roots = [np.sqrt(mean[..., i]) * np.sqrt(mean[..., j]) for i, j in pairs]
    return np.concatenate([mean, *(root[..., None] for root in roots)], axis=-1)


def root_jacobian(raw_mean: Float[Array, "*px p"], *, degree: int = 2) -> Float[Array, "*px q p"]:
    """Derivative of each term of ``rooted`` with respect to each channel. [1]

    Parameters
    ----------
    raw_mean
        Electrons of each channel, the channels last. [e-]
    degree
        Degree of the roots.

    Raises
    ------
    InputError
        If a channel under a root is not above 0: the derivative is infinite there.

    Examples
    --------
    >>> root_jacobian(np.array([1.0, 4.0]))      # d sqrt(ab) = sqrt(b/a)/2 da + sqrt(a/b)/2 db
    array([[1.  , 0.  ],
           [0.  , 1.  ],
           [1.  , 0.25]])
    """
    mean = _above_zero(raw_mean, degree=degree)
    pairs, p = _pairs(mean.shape[-1], degree), mean.shape[-1]
    jacobian = np.zeros((*mean.shape[:-1], p + len(pairs), p))
    jacobian[..., :p, :] = np.eye(p)
    for row, (i, j) in enumerate(pairs, start=p):
        ratio = np.sqrt(mean[..., j]) / np.sqrt(mean[..., i])
        jacobian[..., row, i], jacobian[..., row, j] = 0.5 * ratio, 0.5 / ratio
    return jacobian


def root_polynomial(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    degree: int = 2,
) -> RootPolynomial:
    """The root-polynomial correction of least color error over a training set.

    Parameters
    ----------
    sensor, exposure
        The sensor and its exposure settings.
    training
        Training set with at least as many reflectances as terms, p + p (p - 1) / 2.
    level_lux
        Illuminance on the set; the fit does not depend on it. [lx]
    metric
        Recorded; the fit does not depend on it.
    degree
        1 (least squares) or 2.

    Raises
    ------
    InputError
        If set and sensor have different grids, or the set is smaller than the number of terms.

    Notes
    -----
    Finlayson, Mackiewicz & Hurlbert (2015), as ``rooted``. Every term is of first order in light,
    so scaling the exposure scales XYZ.
    """
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    terms, white = rooted(seen.electrons, degree=degree), rooted(seen.white_e, degree=degree)
    if len(terms) < terms.shape[1]:
        raise InputError(
            f"training set {training.source}",
            f"must have at least {terms.shape[1]} reflectances, one per term of the polynomial",
            value=len(terms),
            found=f"has {len(terms)}",
            remedy=("take a larger set", Setting("degree", (1,))),
        )
    scale, root = np.where(white > 0, white, 1.0), np.sqrt(seen.share)[:, None]
    what = f"root polynomial of {sensor.name}"
    solution, *_ = lstsq(what, root * terms / scale, root * seen.xyz, rcond=RANK_TOLERANCE)
    return RootPolynomial(
        matrix=solution.T / scale,
        channels=sensor.names,
        coordinates=XYZ,
        degree=degree,
        made_by=f"root polynomial of degree {degree} ({training.source})",
        metric=metric,
        observer=training.observer,
    )


def root_polynomial_color(raw: Measurement, model: RootPolynomial) -> Measurement:
    """Color and its first-order covariance, through the Jacobian of the roots. [lx]

    The mean is that of the noiseless raw values. `root_polynomial_bias` gives the bias by noise,
    and `root_first_order_error` the error of the first order.

    Parameters
    ----------
    raw
        Mean and covariance of the raw channels. [e-]
    model
        The fitted root polynomial.

    Raises
    ------
    InputError
        If the channels differ, a mean is negative, or a mean under a root is 0.
    """
    check.same_names("color", raw=raw.names, model=model.channels)
    slope = model.matrix @ root_jacobian(raw.mean, degree=model.degree)
    covariance = slope @ raw.covariance @ np.swapaxes(slope, -1, -2)
    return _color(rooted(raw.mean, degree=model.degree) @ model.matrix.T, covariance, model)


def root_polynomial_bias(raw: Measurement, model: RootPolynomial) -> Float[Array, "*px c"]:
    """Bias of the mean color by noise, to second order: 1/2 tr(H D) of each root. [lx]

    Parameters
    ----------
    raw
        Mean and covariance D of the channels. [e-]
    model
        The root polynomial; linear terms have no bias, roots a negative one because they are
        concave.

    Raises
    ------
    InputError
        As `root_polynomial_color`.

    Notes
    -----
    J. A. Rice, *Mathematical Statistics and Data Analysis* (3rd ed., 2007), section 4.6. With the
    Hessian H of sqrt(x y), 1/2 tr(H D) = -1/8 sqrt(x y) (D_xx/x^2 - 2 D_xy/(x y) + D_yy/y^2),
    minus an eighth of the root times the variance of log(x / y): noise that scales both channels
    equally causes no bias. Where read noise dominates, the true bias is positive; then use
    `root_polynomial_color_exact`.

    Examples
    --------
    Two channels of 100 e- with shot noise only: -1/8 x 100 x (1/100 + 1/100).

    >>> raw = Measurement(mean=np.full(2, 100.0), covariance=100.0 * np.eye(2),
    ...                   names=("a", "b"), kind="raw", unit="e-")
    >>> root = RootPolynomial(matrix=np.array([[0.0, 0.0, 1.0]]), channels=("a", "b"),
    ...                       coordinates=("Y",), degree=2, made_by="by hand", metric="quanta")
    >>> root_polynomial_bias(raw, root)
    array([-0.25])
    """
    check.same_names("color", raw=raw.names, model=model.channels)
    mean, spread = _above_zero(raw.mean, degree=model.degree), raw.covariance
    bias = np.zeros((*mean.shape[:-1], model.matrix.shape[1]))
    for term, (i, j) in enumerate(_pairs(mean.shape[-1], model.degree), start=mean.shape[-1]):
        ratio = np.sqrt(mean[..., j]) / np.sqrt(mean[..., i])
        own = ratio * spread[..., i, i] / mean[..., i] + spread[..., j, j] / mean[..., j] / ratio
        cross = spread[..., i, j] / np.sqrt(mean[..., i]) / np.sqrt(mean[..., j])
        bias[..., term] = 0.25 * cross - 0.125 * own
    return bias @ model.matrix.T


def root_polynomial_color_exact(
    mean_e: Float[Array, "*px p"], model: RootPolynomial, *, read_noise_e: float
) -> Measurement:
    """Exact mean color and covariance for Poisson electrons and read noise, also in the dark. [lx]

    The root of a negative value is set to 0; linear terms keep negative values.

    Parameters
    ----------
    mean_e
        Expected electrons of the channels, which are independent. [e-]
    model
        A root polynomial of any degree.
    read_noise_e
        Standard deviation of the readout. [e-]

    Raises
    ------
    InputError
        If the number of channels differs, a mean is negative, or a mean is above 1e10.

    Notes
    -----
    With r = sqrt(max(x, 0)), E r_i r_j = E r_i E r_j, and every covariance of two terms follows
    from E r, var r, cov(x, r) and var x = M + s^2 of single channels, each computed by
    `expectation`.

    Examples
    --------
    Without light and read noise the color is 0:

    >>> root = RootPolynomial(matrix=np.ones((1, 3)), channels=("a", "b"), coordinates=("Y",),
    ...                       degree=2, made_by="by hand", metric="quanta")
    >>> root_polynomial_color_exact(np.zeros(2), root, read_noise_e=0.0).mean
    array([0.])
    """
    mean = check.non_negative("mean_e", "e-", mean_e)
    noise = check.not_negative("read_noise_e", "e-", read_noise_e)
    check.same_length("channels", mean_e=mean.shape[-1], model=len(model.channels))
    terms, covariance = _exact_terms(mean, noise, model.degree)
    color = model.matrix @ covariance @ model.matrix.T
    return _color(terms @ model.matrix.T, color, model)


def root_first_order_error(
    mean_e: Float[Array, "*px p"], model: RootPolynomial, sensor: Sensor
) -> Float[Array, "*px c"]:
    """Standard deviation by `root_polynomial_color` over the exact one, minus 1. [1]

    The first order is valid within `chromanoise.color.FIRST_ORDER_TOLERANCE`, 5 %. The result is
    inf where a channel under a root is dark, so that the first order is undefined, and 0 without
    noise.

    Parameters
    ----------
    mean_e
        Expected electrons. [e-]
    model
        A root polynomial of the sensor's channels.
    sensor
        The sensor; only its read noise is used, without crosstalk after counting.

    Raises
    ------
    InputError
        As `root_polynomial_color_exact`, or if the channels differ.

    Notes
    -----
    For the root of two equal channels the error is -5 % at 5.1 e- per channel without read noise,
    at 10.4 e- with 2 e- of read noise, and at 37.4 e- with 10 e-. At lower levels the error changes
    sign and passes through 0 (at 2.3 e- with 2 e-), so use the brightest level out of tolerance.
    """
    mean = check.non_negative("mean_e", "e-", mean_e)
    s = sensor.pixel.read_noise_e
    exact = root_polynomial_color_exact(mean, model, read_noise_e=s).variance
    dark = (mean == 0).any(axis=-1, keepdims=True) & bool(_pairs(mean.shape[-1], model.degree))
    pixel = shot_and_read_only(sensor.pixel)
    plain = replace(sensor, pixel=pixel, converter=UNKNOWN_CONVERTER, crosstalk=None)
    first = root_polynomial_color(with_noise(np.where(dark, 1.0, mean), plain), model).variance
    noisy = exact > 0
    error = np.sqrt(np.where(noisy, first, 1.0) / np.where(noisy, exact, 1.0)) - 1.0
    return np.where(dark, np.inf, error)


def _color(
    mean: Float[Array, "*px c"], covariance: Float[Array, "*px c c"], model: RootPolynomial
) -> Measurement:
    return Measurement(
        mean=mean,
        covariance=0.5 * (covariance + np.swapaxes(covariance, -1, -2)),
        names=model.coordinates,
        kind="".join(model.coordinates),
        unit="lx",
        metric=model.metric,
    )


def _exact_terms(mean: Array, noise: float, degree: int) -> tuple[Array, Array]:
    """Mean and covariance of the terms of ``rooted``, from moments of single channels."""
    p = mean.shape[-1]
    pairs = _pairs(mean.shape[-1], degree)
    covariance = np.zeros((*mean.shape[:-1], p + len(pairs), p + len(pairs)))
    channels = np.arange(p)
    covariance[..., channels, channels] = mean + noise**2
    if not pairs:
        return mean, covariance
    root, variance, with_channel = _root_moments(mean, noise)
    for row, (i, j) in enumerate(pairs, start=p):
        covariance[..., row, i] = covariance[..., i, row] = with_channel[..., i] * root[..., j]
        covariance[..., row, j] = covariance[..., j, row] = with_channel[..., j] * root[..., i]
    for (a, one), (b, other) in combinations_with_replacement(enumerate(pairs, start=p), 2):
        covariance[..., a, b] = _covariance_of_roots(root, variance, one, other)
        covariance[..., b, a] = covariance[..., a, b]
    products = [root[..., i] * root[..., j] for i, j in pairs]
    return np.concatenate([mean, *(each[..., None] for each in products)], axis=-1), covariance


def _covariance_of_roots(
    root: Array, variance: Array, one: tuple[int, int], other: tuple[int, int]
) -> Array:
    """cov(r_i r_j, r_k r_l): 0 unless the two terms share a channel."""
    shared, alone = sorted({*one} & {*other}), sorted({*one} ^ {*other})
    if len(shared) == 2:
        (v, w), (m, n) = (np.moveaxis(each[..., shared], -1, 0) for each in (variance, root))
        return np.asarray(v * w + v * n**2 + w * m**2)
    if len(shared) == 1:
        return np.asarray(variance[..., shared[0]] * root[..., alone].prod(axis=-1))
    return np.zeros(root.shape[:-1])


def _root_moments(mean: Array, noise: float) -> tuple[Array, Array, Array]:
    """Mean and variance of r = sqrt(max(x, 0)), and its covariance with x, per channel."""
    kinks = tuple(noise * kink for kink in _ROOT_KINKS)

    def positive_root(x: Array) -> Array:
        return np.sqrt(np.maximum(x, 0.0))

    root = expectation(positive_root, mean, read_noise_e=noise, kinks_e=kinks)
    both = expectation(lambda x: x + positive_root(x), mean, read_noise_e=noise, kinks_e=kinks)
    with_channel = 0.5 * (both.variance - root.variance - mean - noise**2)  # from var(x + r)
    return root.mean, root.variance, with_channel


def _above_zero(raw_mean: Array, *, degree: int) -> Array:
    """The mean; an error where a root would have an infinite slope."""
    mean = check.non_negative("raw_mean", "e-", raw_mean)
    if _pairs(mean.shape[-1], degree) and not (mean > 0).all():
        first = tuple(int(i) for i in np.argwhere(mean <= 0)[0])
        found = f"is 0 at index {first} (from 0)"
        remedy = "take root_polynomial_color_exact, degree 1 or a linear matrix there"
        raise InputError("raw_mean", "must be > 0 [e-]", value=0.0, found=found, remedy=remedy)
    return mean


def _pairs(p: int, degree: int) -> list[tuple[int, int]]:
    """The pairs of channels under a root."""
    if degree not in (1, 2):
        raise InputError("degree", "must be 1 or 2 for a root polynomial", value=degree)
    return list(combinations(range(p), 2)) if degree == 2 else []
