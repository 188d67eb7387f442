"""Noise-equivalent quanta of a mosaic with its demosaicing, and its information on pictures."""

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Complex,
    Float,
    InputError,
    check,
    eigh,
    eigvalsh,
    svd,
)
from chromanoise.imaging.demosaic import FilterBank
from chromanoise.imaging.demosaic_methods import PicturePrior, per_channel, raw_transfers


def noise_equivalent_quanta(
    bank: FilterBank,
    mean_e: Float[Array, " p"],
    variance_e2: Float[Array, " p"],
    shape: tuple[int, int],
    matrix: Float[Array, "c p"] | None = None,
) -> Complex[Array, "h w p p"]:
    """Matrix of noise-equivalent quanta of a demosaicked flat field. [quanta per pixel]

    A small relative change s_d(f) of the light of the channels, seen by an ideal linear reader, has
    the squared detectability d'^2 = sum over f of s(f)^H NEQ(f) s(f) / (number of pixels), where
    s(f) is the discrete Fourier transform.

    Parameters
    ----------
    mean_e
        Expected electrons M of each channel in the flat field, >= 0. [e-]
    variance_e2
        Variance v of a raw pixel of each channel, > 0 and independent of the others. [e-^2]
    shape
        Rows and columns of the Fourier plane, each at least the side of a filter, with frequencies
        as `numpy.fft.fftfreq`.
    matrix
        A color matrix C after demosaicing; ``None`` for the channels. An invertible one changes
        nothing.

    Raises
    ------
    InputError
        If a number is not finite, a mean is negative, a variance is not positive, a number per
        channel is missing, or the plane is too small.

    Notes
    -----
    diag(M) T^H W^+ T diag(M), with the signal transfer T = sum over positions q of the tile of
    H_q e_q^T / n and the noise spectrum W = sum of v_q H_q H_q^H / n, e_q the channel of q. T is
    the output at the frequency of the input; aliases at other frequencies are not read, and the
    correlation of the noise between those frequencies is averaged out. So d' is exact for a
    uniform change and for a wave, and approximate for a detail of few pixels.

    One channel: M^2 MTF^2 / NPS (R. Shaw, J. Photogr. Sci. 11, 199 (1963); ICRU Report 54 (1996),
    section 3). With W = A A^H and T = A B it is |P B diag(M)|^2, P the projector on the rows of A.
    So it never exceeds that of the raw mosaic, diag(share M^2 / v), and is equal to it at frequency
    0 where every pixel of a channel has the same total weight in the output.

    Examples
    --------
    Shot noise alone: every electron of a channel without a mosaic is a quantum. In a Bayer array
    a quarter of the pixels is red.

    >>> from chromanoise.imaging.demosaic import bilinear_filters
    >>> from chromanoise.sensor import Mosaic, bayer
    >>> alone, e = bilinear_filters(Mosaic((("W",),))), np.array([500.0])
    >>> noise_equivalent_quanta(alone, e, e, (1, 2)).real.ravel().round(9)
    array([500., 500.])
    >>> e = np.array([400.0, 800.0, 200.0])
    >>> neq = noise_equivalent_quanta(bilinear_filters(bayer(), ("R", "G", "B")), e, e, (8, 8))
    >>> neq[0, 0].real.round(9) + 0.0
    array([[100.,   0.,   0.],
           [  0., 400.,   0.],
           [  0.,   0.,  50.]])
    """
    mean = check.non_negative("mean_e", "e-", mean_e)
    variance = per_channel(bank, variance_e2)
    check.same_length("channels", mean=mean.size, variance=variance.size)
    for name, value in zip(bank.names, variance, strict=True):
        check.positive(f"variance of {name}", "e-^2", float(value))
    channels, transfers = raw_transfers(bank, shape)
    noise = transfers * np.sqrt(variance[channels] / channels.size)
    if matrix is not None:
        color = check.finite("matrix", "1", matrix)
        check.same_length("channels", matrix=color.shape[1], variance=variance.size)
        noise = color @ noise
    length = np.sqrt((np.abs(noise) ** 2).sum(axis=-1).max(axis=(0, 1), initial=0.0))
    unit = noise / np.where(length > 0, length, 1.0)[:, None]
    _, singular, rows = svd("transfer functions", unit, full_matrices=False)
    rows = rows * (singular > RANK_TOLERANCE)[..., None]
    member = channels[:, None] == np.arange(mean.size)
    signal = member * (mean / np.sqrt(variance * channels.size))
    seen = rows @ signal
    return np.asarray(np.swapaxes(seen.conj(), -1, -2) @ seen)


def picture_power_spectrum(
    prior: PicturePrior, mean_e: Float[Array, " p"], shape: tuple[int, int]
) -> Float[Array, "h w p p"]:
    """Power spectrum of the light of pictures relative to its mean, per channel and pixel. [1]

    Parameters
    ----------
    prior
        Covariance of the channels and correlation of neighboring pixels; its noise is not used.
    mean_e
        Expected electrons of each channel, > 0. [e-]
    shape
        Rows and columns of the Fourier plane.

    Raises
    ------
    InputError
        If a mean is not positive, or there is not one per channel.

    Notes
    -----
    The correlation rho^r of `PicturePrior` at a distance of r pixels has the spectrum
    2 pi a / (a^2 + (2 pi f)^2)^(3/2), a = -ln rho, summed here over 5 x 5 periods of the sampling
    and scaled so that its mean over the plane is the covariance. It falls as f^-3; that of
    photographs falls as f^-2 (Field, J. Opt. Soc. Am. A 4, 2379 (1987)).
    """
    mean = np.array([check.positive("mean_e", "e-", float(one)) for one in mean_e])
    check.same_length("channels", mean=mean.size, prior=len(prior.names))
    periods, decay = np.arange(-2, 3), -np.log(prior.correlation)
    along = [(np.fft.fftfreq(n)[:, None] + periods) ** 2 for n in shape]
    squared = along[0][:, None, :, None] + along[1][None, :, None, :]
    power = ((decay**2 + (2 * np.pi) ** 2 * squared) ** -1.5).sum(axis=(-2, -1))
    power /= power.mean()
    return np.asarray(power[..., None, None] * (prior.covariance_e2 / np.outer(mean, mean)))


def information_spectrum(
    quanta: Complex[Array, "h w p p"], power: Float[Array, "h w p p"]
) -> Float[Array, "h w"]:
    """Information on Gaussian pictures at each frequency, 1/2 log2 det(I + S NEQ). [bit/pixel]

    Its mean over the plane is the information per pixel.

    Parameters
    ----------
    quanta
        Of `noise_equivalent_quanta`. [quanta per pixel]
    power
        S, power spectrum of the light relative to its mean, e.g. `picture_power_spectrum`. [1]

    Raises
    ------
    InputError
        If a number is not finite, or a spectrum has a negative eigenvalue.

    Notes
    -----
    Cover & Thomas, *Elements of Information Theory* (2006), section 9.5. Frequencies count as
    independent, as in `noise_equivalent_quanta`.

    Examples
    --------
    Contrast of 10 % without correlation, 1500 quanta: 1/2 log2(1 + 15).

    >>> information_spectrum(np.full((1, 2, 1, 1), 1500.0 + 0j), np.full((1, 2, 1, 1), 0.01))
    array([[2., 2.]])
    """
    spectrum = check.finite("power", "1", power)
    variance, axes = eigh("power", spectrum)
    if (variance < -RANK_TOLERANCE * np.abs(variance).max(initial=0.0)).any():
        least = float(variance.min())
        raise InputError(
            "power", "must have no negative eigenvalue", value=least, found=f"one is {least:.3g}"
        )
    root = axes * np.sqrt(np.maximum(variance, 0.0))[..., None, :]
    gain = eigvalsh("noise-equivalent quanta", np.swapaxes(root, -1, -2) @ quanta @ root)
    return np.asarray(0.5 * np.log1p(np.maximum(gain, 0.0)).sum(axis=-1) / np.log(2.0))
