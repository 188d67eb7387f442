"""Signal-to-noise ratios, the best SNR of any linear readout, and the SNR loss of color."""

import numpy as np

from chromanoise._check import Array
from chromanoise._linalg import solve
from chromanoise._shapes import Float
from chromanoise.noise import Measurement
from chromanoise.units import decibel


def snr_db(measurement: Measurement) -> dict[str, Float[Array, "*px"]]:
    """20 log10(|mean| / standard deviation), one per coordinate (eq. 7). [dB]

    -inf where the mean is zero, inf where there is signal without noise.

    Parameters
    ----------
    measurement
        Mean and covariance.

    Examples
    --------
    >>> raw = Measurement(mean=np.array([10_000.0]), covariance=np.array([[10_100.0]]),
    ...                   names=("W",), kind="raw", unit="e-")
    >>> round(float(snr_db(raw)["W"]), 4)
    39.9568
    """
    signal, noise = np.abs(measurement.mean), np.sqrt(measurement.variance)
    with np.errstate(divide="ignore"):
        ratio = np.where(signal > 0, signal / np.where(signal > 0, noise, 1.0), 0.0)
    decibels = np.asarray(decibel(ratio))
    return {name: np.asarray(decibels[..., i]) for i, name in enumerate(measurement.names)}


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
        below `LEAST_COLOR` times the truth, is not a signal, however small its noise is.
    """
    decibels = np.stack([snr_db(color)[name] for name in color.names], axis=-1)
    return np.where(color.mean > LEAST_COLOR * np.abs(truth), decibels, np.nan)


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
