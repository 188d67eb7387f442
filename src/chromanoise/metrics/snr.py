"""SNR, its linear optimum and the loss of color, and information: bits, levels and colors."""

import numpy as np

from chromanoise.base import (
    Array,
    Bool,
    Float,
    InputError,
    check,
    congruence,
    decibel,
    eigh,
    eigvalsh,
    solve,
    svd,
)
from chromanoise.noise import Measurement


def snr_db(measurement: Measurement) -> dict[str, Float[Array, "*px"]]:
    """20 log10(|mean| / standard deviation), one per coordinate (eq. 7). [dB]

    -inf where the mean is zero, inf where there is signal without noise.

    Parameters
    ----------
    measurement
        Mean and covariance of any coordinates.

    Examples
    --------
    >>> raw = Measurement(mean=np.array([10_000.0]), covariance=np.array([[10_100.0]]),
    ...                   names=("W",), kind="raw", unit="e-")
    >>> round(float(snr_db(raw)["W"]), 4)
    39.9568
    """
    decibels = _snr_db(measurement)
    return {name: np.asarray(decibels[..., i]) for i, name in enumerate(measurement.names)}


def _snr_db(measurement: Measurement) -> Float[Array, "*px p"]:
    signal, noise = np.abs(measurement.mean), np.sqrt(measurement.variance)
    with np.errstate(divide="ignore"):
        ratio = np.where(signal > 0, signal / np.where(signal > 0, noise, 1.0), 0.0)
    return np.asarray(decibel(ratio))


LEAST_COLOR = 1e-6
"""Least share of the true color: below it a measured color is an error, not a signal."""


def signal_snr_db(color: Measurement, truth: Float[Array, "*px c"]) -> Float[Array, "*px c"]:
    """`snr_db` of colors; NaN where a coordinate is not a signal because the matrix fails.

    Parameters
    ----------
    color
        Mean and covariance of color coordinates.
    truth
        The color of the observer, in the same unit. A coordinate that is negative, or
        below ``LEAST_COLOR`` times the truth, is not a signal, however small its noise is.
    """
    return np.where(color.mean > LEAST_COLOR * np.abs(truth), _snr_db(color), np.nan)


def optimal_linear_snr_db(raw: Measurement) -> Float[Array, "*px"]:
    """The best SNR of any linear readout, mu^T D^-1 mu = sum of SNR_i^2. [dB]

    inf where a channel has signal without noise, e.g. a channel that is always at full well.

    Reached by weights ~ D^-1 mu (Cauchy-Schwarz in noise-whitened space).

    Parameters
    ----------
    raw
        Mean and covariance of the raw channels. [e-]

    Examples
    --------
    >>> two = Measurement(mean=np.array([3.0, 4.0]), covariance=np.eye(2),
    ...                   names=("a", "b"), kind="raw", unit="e-")
    >>> round(float(optimal_linear_snr_db(two)), 4)       # 20 log10(5)
    13.9794
    """
    silent = raw.variance == 0  # no signal and no noise adds 0; signal without noise is inf
    covariance = raw.covariance + silent[..., None] * np.eye(len(raw.names))
    whitened = solve("covariance of the raw channels", covariance, raw.mean[..., None])[..., 0]
    endless = (silent & (raw.mean != 0)).any(axis=-1)
    bound = np.sqrt((raw.mean * whitened).sum(axis=-1))
    return decibel(np.asarray(np.where(endless, np.inf, bound)))


def color_snr_loss_db(raw: Measurement, color: Measurement) -> Float[Array, "*px"]:
    """SNR of the best linear readout of ``raw`` minus the luminance SNR of ``color``: >= 0. [dB]

    SNR_Y = bound * cos(psi), psi the angle between the matrix's luminance row and the best
    readout in noise-whitened space.

    Parameters
    ----------
    raw
        Mean and covariance of the raw channels. [e-]
    color
        Mean and covariance of X, Y, Z. [lx]
    """
    bound, own = optimal_linear_snr_db(raw), snr_db(color)["Y"]
    endless = np.isposinf(bound) & np.isposinf(own)  # without any noise the loss is 0
    return np.asarray(np.where(endless, 0.0, bound - np.where(endless, 0.0, own)))


_ROUNDING = 1e-13  # share of a variance, or of a unit row, below which a number is rounding
_SIGNAL = 1e-9  # share of the variance of independent channels that is signal, not rounding


def information_bits(
    signal_covariance: Float[Array, "*#px p p"],
    noise_covariance: Float[Array, "*#px p p"],
    matrix: Float[Array, "q p"] | None = None,
) -> Float[Array, "*px"]:
    """Mutual information of one pixel and a Gaussian signal, 1/2 log2 det(I + N^-1 S). [bit]

    Parameters
    ----------
    signal_covariance
        S, covariance of the expected electrons. [e-^2]
    noise_covariance
        N, covariance of the noise; broadcast with the signal. [e-^2]
    matrix
        A linear map A of the channels to ``q`` coordinates, which gives the information of A S A^T
        and A N A^T. Only its row space matters: an invertible map loses nothing, and linearly
        dependent rows are no error. ``None`` for the channels themselves.

    Raises
    ------
    InputError
        If a number is not finite, the shapes do not match, or a covariance has a negative
        eigenvalue.

    Notes
    -----
    Cover & Thomas, *Elements of Information Theory* (2006), section 9.4; Shannon, Bell Syst.
    Tech. J. 27, 623 (1948). Of all signals with this covariance the Gaussian one carries the most
    information. The result is inf where a mix of the channels has signal and no noise. With the
    covariance K of the spectra and the measurement vectors F, S is F^T K F.

    Examples
    --------
    One channel with an SNR of 3: 1/2 log2(1 + 3^2). The difference of two equal channels has no
    signal, their sum has all the information.

    >>> one = np.eye(1)
    >>> round(float(information_bits(9 * one, one)), 4)
    1.661
    >>> equal = np.ones((2, 2))
    >>> information_bits(equal, np.eye(2), np.array([[1.0, 1.0]])).round(12)
    np.float64(0.792481250361)
    >>> information_bits(equal, np.eye(2), np.array([[1.0, -1.0]])).round(12)
    np.float64(0.0)
    """
    signal = _covariance("signal_covariance", signal_covariance)
    noise = _covariance("noise_covariance", noise_covariance)
    check.same_length("channels", signal=signal.shape[-1], noise=noise.shape[-1])
    if matrix is not None:
        rows = _row_space(check.finite("matrix", "1", matrix))
        check.same_length("channels", signal=signal.shape[-1], matrix=rows.shape[1])
        signal, noise = congruence(rows, signal), congruence(rows, noise)
    spread, own = (np.diagonal(s, axis1=-2, axis2=-1) for s in (signal, noise))
    silent = (own == 0) & (spread == 0)
    scale = np.sqrt(np.where(silent, 1.0, np.where(own > 0, own, spread)))
    signal, noise = (s / (scale[..., :, None] * scale[..., None, :]) for s in (signal, noise))
    noise = noise + silent[..., None] * np.eye(noise.shape[-1])  # any noise: there is no signal
    variance, axes = eigh("noise_covariance", noise)
    _refuse_negative("noise_covariance", variance)
    noisy = variance > _ROUNDING * variance.max(axis=-1, keepdims=True, initial=0.0)
    along = np.swapaxes(axes, -1, -2) @ signal @ axes
    gain = np.where(noisy, 1.0, 0.0) / np.sqrt(np.where(noisy, variance, 1.0))
    whitened = eigvalsh("signal_covariance", gain[..., :, None] * along * gain[..., None, :])
    _refuse_negative("signal_covariance", whitened)
    bits = 0.5 * np.log1p(np.maximum(whitened, 0.0)).sum(axis=-1) / np.log(2.0)
    return np.asarray(np.where(_endless(signal, axes, noisy), np.inf, bits))


def _endless(signal: Array, axes: Array, noisy: Array) -> Bool[Array, "*px"]:
    """Whether a direction without noise has signal that is more than rounding."""
    own = np.diagonal(signal, axis1=-2, axis2=-1)
    seen = np.einsum("...ik,...ij,...jk->...k", axes, signal, axes)
    if_independent = np.einsum("...ik,...i->...k", axes**2, own)
    return np.asarray((~noisy & (seen > _SIGNAL * if_independent)).any(axis=-1))


def _row_space(matrix: Float[Array, "q p"]) -> Float[Array, "r p"]:
    """Orthonormal rows that span those of a matrix; the axes themselves if it is invertible."""
    length = np.linalg.norm(matrix, axis=1)
    unit = matrix[length > 0] / length[length > 0, None]
    _, singular, rows = svd("matrix", unit, full_matrices=False)
    kept = singular > _ROUNDING * singular.max(initial=0.0)
    return np.eye(matrix.shape[1]) if kept.sum() == matrix.shape[1] else np.asarray(rows[kept])


def _covariance(name: str, values: Array) -> Float[Array, "*px p p"]:
    """A finite, symmetric matrix."""
    checked = check.finite(name, "e-^2", values)
    diagonal = np.diagonal(checked, axis1=-2, axis2=-1)
    check.non_negative(f"diagonal of {name}", "e-^2", diagonal)
    return np.asarray(0.5 * (checked + np.swapaxes(checked, -1, -2)))


def _refuse_negative(name: str, eigenvalues: Array) -> None:
    largest = np.abs(eigenvalues).max(initial=0.0)
    if (eigenvalues < -_SIGNAL * largest).any():
        least = float(eigenvalues.min())
        raise InputError(
            name,
            "must have no negative eigenvalue, as a covariance",
            value=least,
            found=f"one is {least:.3g}, with the noise of each channel scaled to 1",
        )


def tonal_levels(
    top_e: Float[Array, "*px"], *, read_noise_e: float, step_e: float = 0.0
) -> Float[Array, "*px"]:
    """Number of distinguishable levels from black to ``top_e``: int dM / sigma(M). [1]

    Parameters
    ----------
    top_e
        The largest signal: full well or the signal of white. [e-]
    read_noise_e
        Standard deviation of the readout. [e-]
    step_e
        Size of one digital number, the least distance of two levels; 0 for none. [e-]

    Raises
    ------
    InputError
        If a number is negative or not finite.

    Notes
    -----
    DxOMark's tonal range: int dM / max(step, sigma(M)), sigma^2 = M + s^2 (eq. 7), which without
    a step is 2 (sqrt(N + s^2) - s). Per pixel; DxOMark's "print" values refer to a picture scaled
    to 8 megapixels.

    Examples
    --------
    >>> round(float(tonal_levels(np.array(10_000.0), read_noise_e=10.0)), 4)
    180.9975
    """
    top = check.non_negative("top_e", "e-", top_e)
    floor = check.not_negative("read_noise_e", "e-", read_noise_e) ** 2
    step = check.not_negative("step_e", "e-", step_e)
    bend = np.clip(step**2 - floor, 0.0, top)  # below it the step is wider than the noise
    sigmas = np.sqrt(top + floor) + np.sqrt(bend + floor)
    above = 2.0 * (top - bend) / np.where(sigmas > 0, sigmas, 1.0)
    return np.asarray(above + (bend / step if step > 0 else 0.0))


def tonal_range_bits(
    top_e: Float[Array, "*px"], *, read_noise_e: float, step_e: float = 0.0
) -> Float[Array, "*px"]:
    """The tonal range, log2 of `tonal_levels`. [bit]

    Parameters
    ----------
    top_e
        Brightest signal. [e-]
    read_noise_e
        Standard deviation of the readout. [e-]
    step_e
        Quantization step; 0 without one. [e-]

    Raises
    ------
    InputError
        As `tonal_levels`, and if ``top_e`` is 0.

    Examples
    --------
    >>> round(float(tonal_range_bits(np.array(10_000.0), read_noise_e=10.0)), 4)
    7.4998
    """
    levels = tonal_levels(top_e, read_noise_e=read_noise_e, step_e=step_e)
    if not (levels > 0).all():
        first = tuple(int(i) for i in np.argwhere(~(levels > 0))[0])
        raise InputError(
            "top_e",
            "must be > 0 [e-] for a tonal range",
            value=0.0,
            found=f"is 0 at index {first} (from 0)",
            remedy="omit that channel",
        )
    return np.asarray(np.log2(levels))


def color_sensitivity_bits(
    top_e: Float[Array, "*px p"], *, read_noise_e: float, step_e: float = 0.0
) -> Float[Array, "*px"]:
    """Number of distinguishable colors, log2 int dM / sqrt(det covariance). [bit]

    The integral covers the box of raw values, 0 .. ``top_e`` per channel. The raw channels are
    independent, so the result is the sum of their tonal ranges. An invertible color matrix scales
    box and covariance equally and does not change the result: this number does not measure how
    accurately a sensor reproduces colors.

    Parameters
    ----------
    top_e
        The largest signal of each channel. [e-]
    read_noise_e, step_e
        As `tonal_levels`.

    Raises
    ------
    InputError
        As `tonal_range_bits`.

    Notes
    -----
    DxOMark's color sensitivity (color depth), per pixel and with every channel in each pixel.

    Examples
    --------
    >>> float(color_sensitivity_bits(np.array([64.0, 64.0, 64.0]), read_noise_e=0.0))
    12.0
    """
    bits = tonal_range_bits(top_e, read_noise_e=read_noise_e, step_e=step_e)
    return np.asarray(bits.sum(axis=-1))
