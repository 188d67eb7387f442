"""Shot noise and read noise of the raw channels (eq. 7)."""

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.noise.measurement import Measurement
from chromanoise.sensor import Pixel, Sensor


def raw_covariance(
    mean_e: Float[Array, "*px p"], *, read_noise_e: float
) -> Float[Array, "*px p p"]:
    """Covariance of the raw channels: shot noise plus read noise, independent per channel. [e-^2]

    Parameters
    ----------
    mean_e
        Expected electrons per channel, >= 0. [e-]
    read_noise_e
        Standard deviation of the readout, >= 0. [e-]

    Raises
    ------
    InputError
        If an entry of ``mean_e`` is negative or not finite.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 7: var(S) = M + s_rn^2.

    Examples
    --------
    >>> raw_covariance(np.array([100.0, 25.0]), read_noise_e=10.0)
    array([[200.,   0.],
           [  0., 125.]])
    """
    mean = _check.non_negative("mean_e", "e-", mean_e)
    variance = mean + _check.not_negative("read_noise_e", "e-", read_noise_e) ** 2
    return variance[..., None] * np.eye(mean.shape[-1])


def with_noise(mean_e: Float[Array, "*px p"], sensor: Sensor) -> Measurement:
    """The raw measurement: expected electrons and covariance, without clipping as in the paper."""
    return Measurement(
        mean=mean_e,
        covariance=raw_covariance(mean_e, read_noise_e=sensor.pixel.read_noise_e),
        names=sensor.names,
        kind="raw",
        unit="e-",
    )


def saturated(mean_e: Float[Array, "*px p"], pixel: Pixel) -> Bool[Array, "*px p"]:
    """True where the expected electrons exceed full well, so that the SNR is undefined."""
    return np.asarray(mean_e) > pixel.full_well_e * (1 + 1e-12)
