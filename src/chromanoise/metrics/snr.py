"""Signal-to-noise ratios, the best of any linear readout, and what color costs."""

import numpy as np

from chromanoise._check import Array
from chromanoise._linalg import solve
from chromanoise._shapes import Float
from chromanoise.noise import Measurement
from chromanoise.units import decibel


def snr_db(measurement: Measurement) -> dict[str, Float[Array, "*px"]]:
    """20 log10(|mean| / standard deviation), one per coordinate (eq. 7). [dB]

    -inf where the mean is zero, inf where something shows no noise at all.

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
"""Of the color that the eye sees: what a matrix makes below it is rounding or false, no signal."""


def signal_snr_db(color: Measurement, truth: Float[Array, "*px c"]) -> Float[Array, "*px c"]:
    """`snr_db` of colors that are signals; NaN where a matrix that does not know the light fails.

    Parameters
    ----------
    color
        Mean and covariance of color coordinates.
    truth
        What the eye sees, in the same unit. A coordinate below `LEAST_COLOR` of it, or negative,
        is no signal, however little noise it has.
    """
    decibels = np.stack([snr_db(color)[name] for name in color.names], axis=-1)
    return np.where(color.mean > LEAST_COLOR * np.abs(truth), decibels, np.nan)


def optimal_linear_snr_db(raw: Measurement) -> Float[Array, "*px"]:
    """The best SNR of any linear readout, mu^T D^-1 mu = sum of SNR_i^2. [dB]

    inf where a channel shows signal without any noise, as a channel held at full well does.

    Reached by weights ~ D^-1 mu (Cauchy-Schwarz in noise-whitened space).

    Examples
    --------
    >>> two = Measurement(mean=np.array([3.0, 4.0]), covariance=np.eye(2),
    ...                   names=("a", "b"), kind="raw", unit="e-")
    >>> round(float(optimal_linear_snr_db(two)), 4)       # 20 log10(5)
    13.9794
    """
    silent = raw.variance == 0  # neither signal nor noise adds nothing; signal alone is endless
    covariance = raw.covariance + silent[..., None] * np.eye(len(raw.names))
    whitened = solve("covariance of the raw channels", covariance, raw.mean[..., None])[..., 0]
    endless = (silent & (raw.mean != 0)).any(axis=-1)
    bound = np.sqrt((raw.mean * whitened).sum(axis=-1))
    return decibel(np.asarray(np.where(endless, np.inf, bound)))


def color_snr_loss_db(raw: Measurement, color: Measurement) -> Float[Array, "*px"]:
    """How far the luminance of ``color`` stays below the best linear readout of ``raw``: >= 0. [dB]

    SNR_Y = bound * cos(psi), psi the angle between the matrix's luminance row and the best
    readout in noise-whitened space.
    """
    bound, own = optimal_linear_snr_db(raw), snr_db(color)["Y"]
    endless = np.isposinf(bound) & np.isposinf(own)  # without any noise nothing is paid
    return np.asarray(np.where(endless, 0.0, bound - np.where(endless, 0.0, own)))
