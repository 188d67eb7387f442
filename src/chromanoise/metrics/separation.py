"""Separation of two patches by one noisy reading, and contrast detection probability.

A reader of raw values (a classifier, a threshold) decides from one noisy reading which of two
patches it sees. No invertible matrix changes what it can know. The distance is Mahalanobis', the
detectability index d' of ICRU Report 54 (1996) with the mean of both covariances. Near black,
probabilities come from the exact distributions of the readings.

The contrast detection probability is how often two noisy patches show the contrast of the scene. It
follows the published idea of the working group IEEE P2020 (Geese, Seger & Paolillo, "Detection
Probabilities: Performance Prediction for Sensors of Autonomous Vehicles", Electronic Imaging 2018,
AVM-148); no conformity is claimed.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, get_args

import numpy as np

from chromanoise.base import Array, Float, InputError, Integer, check, cholesky, eigh, solve, svd
from chromanoise.noise import Measurement, ReadingDistribution, through

_LEAST_SHARE = 1e-14  # of a variance in the mean of two
_ROUNDING = 1e-26  # share of a squared distance below which only rounding is left
_AT_ONCE = 20_000  # numbers of an intermediate result
_NODES = 512  # measured error: 2e-6 for two coordinates, 5e-7 for more
_FARTHEST = 24.0  # 1 / cosh(24) = 8e-11


def mahalanobis_distance(
    first: Measurement, second: Measurement, *, brightness: bool = True
) -> Float[Array, "*px"]:
    """Distance D_M of two patches in units of their noise. [1]

    D_M^2 = d^T S^-1 d, d the difference of the means and S the mean of the covariances.

    Parameters
    ----------
    first, second
        The patches in the same coordinates; leading axes are broadcast.
    brightness
        False for a reader that does not know the level of the light: a common factor of both
        patches is not evidence.

    Returns
    -------
    Array
        inf where the means differ in a coordinate without noise.

    Raises
    ------
    InputError
        If the coordinates differ, or a mean covariance that is not diagonal is singular.

    Notes
    -----
    Without brightness, S^-1 is replaced by S^-1 - S^-1 m m^T S^-1 / (m^T S^-1 m) with m the sum of
    the means: the component along m, which a change of brightness makes, is removed.

    Examples
    --------
    >>> def patch(*electrons):
    ...     mean = np.array(electrons)
    ...     return Measurement(mean=mean, covariance=np.diag(np.full(2, 25.0)),
    ...                        names=("a", "b"), kind="raw", unit="e-")
    >>> float(mahalanobis_distance(patch(100.0, 100.0), patch(103.0, 104.0)))
    1.0
    >>> float(mahalanobis_distance(patch(2.0, 2.0), patch(3.0, 3.0), brightness=False))
    0.0
    """
    _same_coordinates(first, second)
    difference = first.mean - second.mean
    covariance = (first.covariance + second.covariance) / 2
    direction = None if brightness else first.mean + second.mean
    return np.asarray(np.sqrt(_squared_distance(difference, covariance, direction)))


def pair_distances(
    patches: Measurement, pairs: Integer[Array, "m 2"], *, brightness: bool = True
) -> Float[Array, "*lv m"]:
    """`mahalanobis_distance` of many pairs of patches. [1]

    Parameters
    ----------
    patches
        The patches along the last axis before the coordinates, after any axes of light levels.
    pairs
        Indices of the two patches of each pair.
    brightness
        As `mahalanobis_distance`.

    Raises
    ------
    InputError
        If a mean covariance that is not diagonal is singular.
    """
    one, other = pairs.T
    difference = patches.mean[..., one, :] - patches.mean[..., other, :]
    direction = None
    if not brightness:
        direction = patches.mean[..., one, :] + patches.mean[..., other, :]
    if not _is_diagonal(patches.covariance):
        covariance = (patches.covariance[..., one, :, :] + patches.covariance[..., other, :, :]) / 2
        return np.sqrt(_squared_distance(difference, covariance, direction))
    variance = (patches.variance[..., one, :] + patches.variance[..., other, :]) / 2
    return np.sqrt(_squared_distance_of_variances(difference, variance, direction))


_erfc = np.frompyfunc(math.erfc, 1, 1)


def separation_probability(distance: Float[Array, "*m"]) -> Float[Array, "*m"]:
    """Probability Phi(D_M / 2) that an ideal reader names the right one of two patches.

    For equal covariances and patches that are equally frequent; 0.5 is chance.

    Parameters
    ----------
    distance
        D_M, >= 0; inf gives 1. [1]

    Raises
    ------
    InputError
        If a distance is negative or NaN.

    Examples
    --------
    >>> separation_probability(np.array([0.0, 2.0, 3.92])).round(3)
    array([0.5  , 0.841, 0.975])
    """
    values = np.asarray(distance, dtype=np.float64)
    check.non_negative("distance", "1", np.where(values == np.inf, 0.0, values))
    # without SciPy, whose import takes longer than all else in `analyze`
    return np.asarray(0.5 * _erfc(-values / math.sqrt(8.0)), dtype=np.float64)


def gaussian_separation_probability(first: Measurement, second: Measurement) -> Float[Array, "*px"]:
    """Probability that an ideal reader names the right one of two patches with Gaussian noise.

    The covariances may differ. The patches are equally frequent; 0.5 is chance.

    Parameters
    ----------
    first, second
        The patches in the same coordinates; leading axes are broadcast.

    Raises
    ------
    InputError
        If the coordinates differ or a mean covariance is singular.

    Notes
    -----
    The reader decides by the likelihood ratio. Let l be its logarithm, and G(t) the integral of
    p^(1/2 + it) q^(1/2 - it) over all readings, p and q the two densities. The density of l is
    e^(l/2) g(l) for p and e^(-l/2) g(l) for q, and G is the Fourier transform of g. The
    probability of error is half the integral of e^(-|l|/2) g(l); by Parseval's theorem it is

        1/pi * integral over u from 0 to infinity of Re G(sinh(u) / 2) / cosh(u).

    For equal covariances this is Craig's form of the normal distribution function (MILCOM 1991).
    G(0) is the coefficient of Bhattacharyya.

    Examples
    --------
    Equal means, standard deviations 1 and 3: the reader compares the squares with a threshold.

    >>> def wide(sd):
    ...     return Measurement(mean=np.zeros(2), covariance=sd**2 * np.eye(2), names=("a", "b"),
    ...                        kind="raw", unit="e-")
    >>> round(float(gaussian_separation_probability(wide(1.0), wide(3.0))), 4)
    0.8377
    """
    _same_coordinates(first, second)
    what = "mean covariance of two patches"
    root = cholesky(what, (first.covariance + second.covariance) / 2)
    half = solve(what, root, first.covariance)
    of_first = solve(what, root, np.swapaxes(half, -1, -2))
    share, turn = eigh(what, (of_first + np.swapaxes(of_first, -1, -2)) / 2)
    difference = solve(what, root, (first.mean - second.mean)[..., None])
    shift = (np.swapaxes(turn, -1, -2) @ difference)[..., 0]
    share = np.clip(share, _LEAST_SHARE, 2 - _LEAST_SHARE)  # the second patch has 2 - share
    return np.asarray(1.0 - _error_probability(share, shift))


def gaussian_pair_probabilities(
    patches: Measurement, pairs: Integer[Array, "m 2"]
) -> Float[Array, "*lv m"]:
    """`gaussian_separation_probability` of many pairs of patches.

    Parameters
    ----------
    patches, pairs
        As `pair_distances`.

    Raises
    ------
    InputError
        If a mean covariance is singular.
    """
    one, other = (
        replace(
            patches,
            mean=patches.mean[..., i, :],
            covariance=patches.covariance[..., i, :, :],
            reading_variance=None,
        )
        for i in pairs.T
    )
    return gaussian_separation_probability(one, other)


def independent_coordinates(raw: Measurement, matrix: Float[Array, "q p"]) -> Measurement:
    """What is left of a measurement after a matrix, in orthonormal coordinates.

    They span the rows of ``matrix``, so that every distance equals that after the matrix, also
    where its rows depend on each other.

    Parameters
    ----------
    raw
        The measurement in p coordinates.
    matrix
        The linear map to q coordinates, one row each.

    Raises
    ------
    InputError
        If the matrix is zero or does not have p columns.
    """
    check.same_length("coordinates", names=len(raw.names), matrix=matrix.shape[1])
    values = np.asarray(matrix, dtype=np.float64)
    _, size, rows = svd("the matrix", values, full_matrices=False)
    kept = rows[size > max(matrix.shape) * np.finfo(float).eps * size[0]] if size[0] else rows[:0]
    names = tuple(f"row {i + 1}" for i in range(len(kept)))
    return through(raw, kept, names=names, kind=raw.kind, unit=raw.unit)


def _same_coordinates(first: Measurement, second: Measurement) -> None:
    check.same_names("coordinates", first=first.names, second=second.names)


def _is_diagonal(covariance: Float[Array, "*px p p"]) -> bool:
    return not (covariance * (1.0 - np.eye(covariance.shape[-1]))).any()


def _squared_distance(
    difference: Float[Array, "*m p"],
    covariance: Float[Array, "*m p p"],
    direction: Float[Array, "*m p"] | None,
) -> Float[Array, "*m"]:
    if _is_diagonal(covariance):
        variance = np.diagonal(covariance, axis1=-2, axis2=-1)
        return _squared_distance_of_variances(difference, variance, direction)
    sd = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))  # variances of 1 keep the digits
    scale = np.where(sd > 0, sd, 1.0)
    correlation = covariance / scale[..., None] / scale[..., None, :]
    along = None if direction is None else direction / scale
    return _squared_length(difference / scale, along, partial(_solved, correlation))


def _solved(correlation: Float[Array, "*m p p"], vector: Float[Array, "*m p"]) -> Array:
    found = solve("mean covariance of two patches", correlation, vector[..., None])
    return np.asarray(found[..., 0])


def _squared_distance_of_variances(
    difference: Float[Array, "*m p"],
    variance: Float[Array, "*m p"],
    direction: Float[Array, "*m p"] | None,
) -> Float[Array, "*m"]:
    sure = variance == 0
    endless = (sure & (difference != 0)).any(axis=-1)
    divisor = np.where(sure, np.inf, variance)
    return np.where(
        endless, np.inf, _squared_length(difference, direction, lambda one: one / divisor)
    )


def _squared_length(
    difference: Float[Array, "*m p"],
    direction: Float[Array, "*m p"] | None,
    solved: Callable[[Array], Array],
) -> Float[Array, "*m"]:
    """d^T S^-1 d, where ``solved(v)`` is S^-1 v; a part of d along a direction is removed first."""
    if direction is None:
        return np.asarray(np.maximum(_dot(difference, solved(difference)), 0.0))
    toward = solved(direction)
    length, along = _dot(direction, toward), _dot(difference, toward)
    share = along / np.where(length > 0, length, 1.0)
    rest = difference - share[..., None] * direction
    squared = _dot(rest, solved(rest))
    return np.asarray(np.where(squared > _ROUNDING * (squared + share * along), squared, 0.0))


def _dot(one: Float[Array, "*m p"], other: Float[Array, "*m p"]) -> Float[Array, "*m"]:
    return np.asarray(np.einsum("...p,...p->...", one, other))


def _error_probability(
    share: Float[Array, "*m p"], shift: Float[Array, "*m p"]
) -> Float[Array, "*m"]:
    """For variances ``share`` and 2 - ``share`` of each coordinate, and differences of means."""
    if share.shape[-1] == 1:
        return _error_probability_of_one(share[..., 0], shift[..., 0])
    u = _FARTHEST * (np.arange(_NODES) + 0.5) / _NODES
    t, weights = np.sinh(u) / 2, _FARTHEST / _NODES / np.pi / np.cosh(u)
    other = 2.0 - share
    total = np.zeros(share.shape[:-1])
    for start in range(0, _NODES, together := max(1, _AT_ONCE // max(share.size, 1))):
        nodes = slice(start, start + together)
        at = t[nodes].reshape(-1, *(1 for _ in share.shape))
        skew = 1 + 1j * at * (other - share)
        logarithm = (
            0.5 * (0.5 - 1j * at) * np.log(share)
            + 0.5 * (0.5 + 1j * at) * np.log(other)
            - 0.5 * np.log(skew)
            - 0.5 * shift**2 * (0.25 + at**2) / skew
        ).sum(axis=-1)
        total += np.tensordot(weights[nodes], np.exp(logarithm).real, axes=1)
    return np.asarray(np.clip(total, 0.0, 0.5))


def _error_probability_of_one(
    share: Float[Array, "*m"], shift: Float[Array, "*m"]
) -> Float[Array, "*m"]:
    """In one coordinate the patch of smaller variance is named in an interval."""
    from scipy.special import ndtr

    narrow, wide = np.sqrt(np.minimum(share, 2 - share)), np.sqrt(np.maximum(share, 2 - share))
    excess = (wide - narrow) * (wide + narrow)
    with np.errstate(divide="ignore", invalid="ignore"):  # equal variances: the other branch
        ratio = np.log(wide / narrow)
        half = wide * narrow * np.sqrt(shift**2 + 2 * excess * ratio) / excess
        middle = -(narrow**2) * shift / excess  # the wide patch lies at ``shift``
        low, high = middle - half, middle + half
        missed = 1 - (ndtr(high / narrow) - ndtr(low / narrow))
        false = ndtr((high - shift) / wide) - ndtr((low - shift) / wide)
    equal = ndtr(-np.abs(shift) / 2)
    return np.asarray(np.where(excess > 1e-6, (missed + false) / 2, equal))


_BINS = 2**15
_LARGEST_RATIO = 60.0  # a log likelihood ratio beyond it has a weight below e^-30
_LEAST_RANGE = 1e-6  # of the table, where two patches are equal
_NO_MASS = 1e-16  # of a value, which does not widen the table


def exact_separation_probability(
    channels: Sequence[ReadingDistribution], pairs: Integer[Array, "m 2"]
) -> Float[Array, " m"]:
    """Probability that an ideal reader names the right one of two patches, with independent noise.

    The patches are equally frequent; 0.5 is chance. The error is below 1e-5.

    Parameters
    ----------
    channels
        One per channel, with one row per patch; their noise is independent.
    pairs
        Indices of the two patches of each pair.

    Raises
    ------
    InputError
        If there is no channel, or the channels have different numbers of patches.

    Notes
    -----
    As `gaussian_separation_probability`: half the sum of e^(-|l|/2) g(l). The density
    sqrt(p q) of the logarithm l of the likelihood ratio is tabulated per channel; the density of
    the sum over the channels is their convolution, by fast Fourier transform. The table is as wide
    as the ratios of the pair, so that nearly equal patches have the same digits.

    Examples
    --------
    Counts with means 0 and 1: the reader errs on half of the zeros of the second, 1/(2e).

    >>> from chromanoise.noise import NoiseSources, reading_distribution
    >>> from chromanoise.sensor import Pixel
    >>> pixel = Pixel(pitch_um=3, full_well_e=9000, read_noise_e=0.0)
    >>> counts = reading_distribution(np.array([0.0, 1.0]), NoiseSources(pixel=pixel))
    >>> exact_separation_probability([counts], np.array([[0, 1]])).round(4)
    array([0.8161])
    """
    if not channels:
        raise InputError("channels", "must hold at least one channel", value=0)
    patches = {f"channel {i}": len(each.probability) for i, each in enumerate(channels)}
    check.same_length("patches", **patches)
    error = [_exact_error(channels, int(i), int(j)) for i, j in pairs]
    return 1.0 - np.asarray(error, dtype=np.float64)


def _exact_error(channels: Sequence[ReadingDistribution], one: int, other: int) -> float:
    ratios = [_log_ratio(each.probability[one], each.probability[other]) for each in channels]
    widest = sum(np.abs(r[m > _NO_MASS]).max(initial=0.0) for r, m in ratios)
    farthest = float(np.clip(widest, _LEAST_RANGE, _LARGEST_RATIO))
    at = np.fft.fftfreq(_BINS, 1.0 / (2 * farthest))
    kernel = np.fft.rfft(np.exp(-0.5 * np.abs(at))).real
    spectrum = np.ones(kernel.size, dtype=complex)
    for ratio, mass in ratios:
        near = np.abs(ratio) <= farthest
        place = ratio[near] * (_BINS / (2 * farthest))
        below = np.floor(place).astype(np.int64)
        share = (place - below) * mass[near]
        table = np.bincount(below % _BINS, mass[near] - share, _BINS)
        table += np.bincount((below + 1) % _BINS, share, _BINS)
        spectrum *= np.fft.rfft(table)
    power = spectrum.real * kernel
    total = 2 * power.sum() - power[0] - power[-1]  # of both halves of the spectrum
    return float(np.clip(total / _BINS / 2, 0.0, 0.5))


def _log_ratio(
    p: Float[Array, " x"], q: Float[Array, " x"]
) -> tuple[Float[Array, " y"], Float[Array, " y"]]:
    """Logarithm of p / q where both are above 0, and the root of p q."""
    both = (p > 0) & (q > 0)
    return np.log(p[both]) - np.log(q[both]), np.sqrt(p[both]) * np.sqrt(q[both])


Contrast = Literal["weber", "michelson"]
"""(bright - dark) / dark, or (bright - dark) / (bright + dark)."""

_CONTRAST_NODES = 256
_FARTHEST_SD = 9.0
_ROUNDING = 1e-9


def contrast_detection_probability(
    bright: Float[Array, "*m"],
    dark: Float[Array, "*m"],
    *,
    bright_sd: Float[Array, "*m"],
    dark_sd: Float[Array, "*m"],
    tolerance: float = 0.5,
    contrast: Contrast = "weber",
) -> Float[Array, "*m"]:
    """Probability P(|C - C0| <= tolerance C0) for two patches with independent Gaussian noise.

    C is the contrast of two readings and C0 that of their means. A reading whose contrast is not
    defined (no dark signal) does not count as detected.

    Parameters
    ----------
    bright, dark
        Means of the two patches in one unit, > 0 and different; they are exchanged where the first
        is darker.
    bright_sd, dark_sd
        Standard deviations of one reading, > 0, in the same unit.
    tolerance
        Relative tolerance of the contrast, > 0.
    contrast
        Definition of contrast: ``weber`` or ``michelson``.

    Raises
    ------
    InputError
        If a value is out of range.

    Examples
    --------
    Grays of 100 and 50 units with noise of 5: Weber contrast 1, detected between 0.5 and 1.5.

    >>> of = contrast_detection_probability(np.array(100.0), np.array(50.0),
    ...     bright_sd=np.array(5.0), dark_sd=np.array(5.0))
    >>> round(float(of), 3)
    0.966
    """
    first, second, first_sd, second_sd = np.broadcast_arrays(
        *(
            check.non_negative(name, "1", values)
            for name, values in (
                ("bright", bright),
                ("dark", dark),
                ("bright_sd", bright_sd),
                ("dark_sd", dark_sd),
            )
        )
    )
    if not ((first_sd > 0).all() and (second_sd > 0).all()):
        smallest = float(min(first_sd.min(), second_sd.min()))
        raise InputError("bright_sd, dark_sd", "must be > 0", value=smallest)
    swapped = first < second
    high, low = np.where(swapped, second, first), np.where(swapped, first, second)
    high_sd, low_sd = np.where(swapped, second_sd, first_sd), np.where(swapped, first_sd, second_sd)
    least, most = _slopes(high, low, tolerance, contrast)
    from scipy.special import ndtr

    nodes, weights = np.polynomial.legendre.leggauss(_CONTRAST_NODES)
    start = np.maximum(low - _FARTHEST_SD * low_sd, 0.0)
    half = (low + _FARTHEST_SD * low_sd - start) / 2
    at = start[..., None] + half[..., None] * (nodes + 1)
    density = np.exp(-0.5 * ((at - low[..., None]) / low_sd[..., None]) ** 2)
    density /= np.sqrt(2 * np.pi) * low_sd[..., None]
    upper, lower = (
        ndtr((slope[..., None] * at - high[..., None]) / high_sd[..., None])
        for slope in (most, least)
    )
    return np.asarray(half * ((upper - lower) * density @ weights))


def exact_contrast_detection_probability(
    readings: ReadingDistribution,
    mean_e: Float[Array, " 2"],
    *,
    tolerance: float = 0.5,
    contrast: Contrast = "weber",
) -> float:
    """`contrast_detection_probability` from the exact distribution of few electrons.

    Parameters
    ----------
    readings
        Distribution of one reading of a brighter (first) and a darker (second) patch.
    mean_e
        Expected electrons of both. [e-]
    tolerance, contrast
        As `contrast_detection_probability`.

    Raises
    ------
    InputError
        If the distribution does not have two rows, or a value is out of range.

    Examples
    --------
    Counts with means 2 and 1 show a contrast from 0.5 to 1.5 only as 2:1, 3:2, 4:2, 5:2 ...

    >>> from chromanoise.noise import NoiseSources, reading_distribution
    >>> from chromanoise.sensor import Pixel
    >>> pixel = Pixel(pitch_um=3, full_well_e=9000, read_noise_e=0.0)
    >>> means = np.array([2.0, 1.0])
    >>> counts = reading_distribution(means, NoiseSources(pixel=pixel))
    >>> round(exact_contrast_detection_probability(counts, means), 3)
    0.159
    """
    check.same_length("patches", readings=len(readings.probability), mean_e=len(mean_e), pair=2)
    high, low = (np.asarray(one, dtype=np.float64) for one in mean_e)
    if high < low:
        raise InputError(
            "mean_e", "must be that of the brighter patch first", value=tuple(map(float, mean_e))
        )
    least, most = _slopes(high, low, tolerance, contrast)
    values = readings.values_e
    upto = np.concatenate([[0.0], np.cumsum(readings.probability[0])])
    width = readings.width_e
    share = np.clip((values + width / 2) / width, 0, 1) if width else (values > 0).astype(float)
    dark = readings.probability[1] * share  # of a cell around 0 the part above 0
    at = np.where(share < 1, (values + width / 2) / 2, values)
    lit = share > 0

    def below(limit: Float[Array, " x"], *, included: bool) -> Float[Array, " x"]:
        if width:
            edges = np.append(values - width / 2, values[-1] + width / 2)
            return np.interp(limit, edges, upto)
        room = _ROUNDING * np.abs(limit) * (1 if included else -1)
        return upto[np.searchsorted(values, limit + room, side="right" if included else "left")]

    between = below(most * at[lit], included=True) - below(least * at[lit], included=False)
    return float(np.clip(between @ dark[lit], 0.0, 1.0))


def _slopes(
    high: Float[Array, "*m"], low: Float[Array, "*m"], tolerance: float, contrast: Contrast
) -> tuple[Float[Array, "*m"], Float[Array, "*m"]]:
    """The bright reading must lie between these multiples of the dark one."""
    check.positive("tolerance", "1", tolerance)
    check.one_of("contrast", contrast, get_args(Contrast))
    if not (low > 0).all() or not (high > low).all():
        raise InputError(
            "the two patches",
            "must have signal and different means",
            value=(float(np.min(high)), float(np.min(low))),
        )
    if contrast == "weber":
        true = (high - low) / low
        return np.asarray(1 + (1 - tolerance) * true), np.asarray(1 + (1 + tolerance) * true)
    true = (high - low) / (high + low)
    least, most = (1 - tolerance) * true, (1 + tolerance) * true
    endless = most >= 1  # a negative dark reading has more; it is not detected
    upper = np.where(endless, np.inf, (1 + most) / np.where(endless, 1.0, 1 - most))
    return np.asarray((1 + least) / (1 - least)), np.asarray(upper)
