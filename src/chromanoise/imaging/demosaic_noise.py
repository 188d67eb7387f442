"""Noise of a demosaicked image in closed form.

A filter bank is linear, so it determines the covariance of the channels at each position in the
tile, and the noise power spectrum over the whole image.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Complex, Float, Int
from chromanoise.errors import InputError
from chromanoise.exposure import Exposure
from chromanoise.imaging.demosaic import FilterBank, channel_tile, channels_around
from chromanoise.noise import after_counting, counted_electrons, noise_sources, with_noise
from chromanoise.noise.sources import crosstalk_pattern
from chromanoise.sensor import Sensor, shares_after_counting


def demosaicked_covariance(
    bank: FilterBank, variance_e2: Float[Array, " p"] | Float[Array, "ty tx"]
) -> Float[Array, "ty tx p p"]:
    """Covariance of the channels of one pixel, at each position in the tile. [e-^2]

    Parameters
    ----------
    bank
        The demosaicing method.
    variance_e2
        Variance of a raw pixel of each channel, or of each place of the tile, independent of the
        others; eq. 7 for a flat field. [e-^2]

    Raises
    ------
    InputError
        If a variance is negative or not finite, or there is not one per channel or place.

    Notes
    -----
    Sum over the window of the product of two filters and the variance of the pixel. The mean over
    the positions is the covariance of a random pixel.

    Examples
    --------
    Green at a red pixel is a mean of four pixels; red is unchanged.

    >>> from chromanoise.imaging.demosaic import bilinear_filters
    >>> from chromanoise.sensor import bayer
    >>> bank = bilinear_filters(bayer(), ("R", "G", "B"))
    >>> demosaicked_covariance(bank, np.array([100.0, 200.0, 50.0]))[0, 0]
    array([[100. ,   0. ,   0. ],
           [  0. ,  50. ,   0. ],
           [  0. ,   0. ,  12.5]])
    """
    variance = around_places(bank, per_place(bank, variance_e2))
    return np.asarray(
        np.einsum("abcij,abdij,abij->abcd", bank.kernels, bank.kernels, variance, optimize=True)
    )


def noise_power_spectrum(
    bank: FilterBank,
    variance_e2: Float[Array, " p"] | Float[Array, "ty tx"],
    shape: tuple[int, int],
) -> Float[Array, "h w p p"]:
    """Noise power and co-spectra of the channels, averaged over the positions in the tile. [e-^2]

    Parameters
    ----------
    bank, variance_e2
        As `demosaicked_covariance`.
    shape
        Rows and columns of the Fourier plane, each at least the side of a filter.

    Raises
    ------
    InputError
        If a variance is negative or not finite, or the plane is too small to hold the spectrum.

    Notes
    -----
    A raw pixel at position q has the transfer functions H_qc(f) to channel c. The mean spectrum is
    exact: the sum over q of v_q Re(H_qc H_qd*) / (number of positions), with
    frequencies as `np.fft.fftfreq`. Its mean over the plane is the mean covariance, the scaling
    that `metrics.visual_noise_from_spectrum` takes; through a color matrix C it is C S C^T. The
    quadrature part is odd in frequency and has no effect through symmetric filters. The correlation
    between frequencies that the period of the tile causes is averaged out.

    Examples
    --------
    Without interpolation the noise remains white.

    >>> from chromanoise.imaging.demosaic import bilinear_filters
    >>> from chromanoise.sensor import Mosaic
    >>> alone = bilinear_filters(Mosaic((("W",),)))
    >>> noise_power_spectrum(alone, np.array([9.0]), (1, 3)).ravel()
    array([9., 9., 9.])
    """
    variance = per_place(bank, variance_e2).ravel()
    _, transfers = raw_transfers(bank, shape)
    return power_through(transfers, variance / variance.size)


def raw_transfers(
    bank: FilterBank, shape: tuple[int, int]
) -> tuple[Int[Array, " q"], Complex[Array, "h w p q"]]:
    """Transfer functions H_qc of a raw pixel at each position q of the tile to each channel c. [1]

    With the channel of each position.

    Parameters
    ----------
    bank
        The demosaicing method.
    shape
        Rows and columns of the Fourier plane, with frequencies as `np.fft.fftfreq`.

    Raises
    ------
    InputError
        If the plane is smaller than a filter.
    """
    tile = channel_tile(bank.mosaic, bank.names)
    answers = np.stack([_answers(bank, place) for place in np.ndindex(*tile.shape)])
    return tile.ravel(), transfer_functions(answers, shape)


def transfer_functions(
    answers: Float[Array, "q p k k"], shape: tuple[int, int]
) -> Complex[Array, "h w p q"]:
    """Transfer functions of filters that respond to an impulse at q in the channels p. [1]

    Parameters
    ----------
    answers
        Responses in the k x k pixels around the impulse. [1]
    shape
        As `raw_transfers`.

    Raises
    ------
    InputError
        If the plane is smaller than a filter.
    """
    side = answers.shape[-1]
    if min(shape) < side:
        raise InputError(
            "shape",
            f"must be at least {side} x {side}, as the filters are, or noise wraps onto itself",
            value=tuple(shape),
            found=f"is {shape[0]} x {shape[1]}",
        )
    offsets = np.arange(side) - side // 2
    rows, columns = (np.exp(-2j * np.pi * np.outer(np.fft.fftfreq(n), offsets)) for n in shape)
    return np.asarray(np.einsum("hi,qcij,wj->hwcq", rows, answers, columns, optimize=True))


def power_through(
    transfers: Complex[Array, "h w p q"], variance: Float[Array, " q"]
) -> Float[Array, "h w p p"]:
    """Power and co-spectra of white noise in q inputs after their transfer functions. [e-^2]

    Parameters
    ----------
    transfers
        From each input to each channel. [1]
    variance
        Of each input. [e-^2]
    """
    return np.asarray(((transfers * variance) @ np.swapaxes(transfers.conj(), -1, -2)).real)


def flat_field_means(
    bank: FilterBank, mean_e: Float[Array, " p"], sensor: Sensor
) -> Float[Array, "ty tx"]:
    """Expected electrons of a flat field at each place of the tile, with crosstalk. [e-]

    Parameters
    ----------
    bank
        The demosaicing method.
    mean_e
        Expected electrons per channel. [e-]
    sensor
        The sensor; with its crosstalk, different places of a channel may receive different light.
    """
    tile, crosstalk = channel_tile(bank.mosaic, bank.names), sensor.crosstalk
    pattern = crosstalk_pattern(crosstalk)
    if pattern is None or not np.array_equal(pattern.channel, tile.ravel()):
        return np.asarray(mean_e)[tile]
    seen = counted_electrons(mean_e, after_counting(crosstalk))
    return np.asarray(mean_e)[tile] + (pattern.shares @ seen).reshape(tile.shape)


def flat_field_noise(
    of: Callable[[FilterBank, Array], Array],
    bank: FilterBank,
    mean_e: Float[Array, " p"],
    sensor: Sensor,
    exposure: Exposure,
) -> Array:
    """`demosaicked_covariance` or `noise_power_spectrum` of a flat field. [e-^2]

    With crosstalk after counting between neighbors, the filters act on the counts through the
    kernel of the crosstalk, and on what the readout adds without it. The pattern of crosstalk is
    not part of it: it is in the means, `flat_field_means`.

    Parameters
    ----------
    of
        One of the two, or a function as linear in the variance.
    bank
        The demosaicing method.
    mean_e
        Expected electrons per channel. [e-]
    sensor, exposure
        As `chromanoise.noise.with_noise`.
    """
    own, shares = noise_sources(sensor, exposure), shares_after_counting(sensor.crosstalk)
    noise, coupling = replace(own, pattern=None), after_counting(sensor.crosstalk)
    if shares is None and own.pattern is None:
        return of(bank, with_noise(mean_e, sensor, exposure).variance)
    if shares is None:
        return of(bank, noise.rounded(flat_field_means(bank, mean_e, sensor))[1])
    readout = noise.read_out_e2
    counted = noise.variance_e2(counted_electrons(mean_e, coupling)) - readout
    return np.asarray(
        of(_on_counts(bank, shares), counted) + of(bank, np.full_like(counted, readout))
    )


def _on_counts(bank: FilterBank, shares: Float[Array, "ky kx"]) -> FilterBank:
    """The filters that act on the counts, of which each pixel gets ``shares`` of its neighbors."""
    (*tile, p, side, _), middle = bank.kernels.shape, [size // 2 for size in shares.shape]
    more = max(middle)
    kernels = np.zeros((*tile, p, side + 2 * more, side + 2 * more))
    for (dy, dx), share in np.ndenumerate(shares):
        top, left = more + middle[0] - dy, more + middle[1] - dx
        kernels[..., top : top + side, left : left + side] += share * bank.kernels
    return replace(bank, kernels=kernels)


def _answers(bank: FilterBank, place: tuple[int, int]) -> Float[Array, "p k k"]:
    """Response of the channels of the surrounding pixels to a raw value of 1 at each position."""
    (ty, tx), radius = bank.kernels.shape[:2], bank.radius
    out = np.empty(bank.kernels.shape[2:])
    for i, j in np.ndindex(*out.shape[1:]):
        there = (place[0] + i - radius) % ty, (place[1] + j - radius) % tx
        out[:, i, j] = bank.kernels[there][:, 2 * radius - i, 2 * radius - j]
    return out


def around_places(bank: FilterBank, values: Float[Array, "ty tx"]) -> Float[Array, "ty tx k k"]:
    """Values of the places of a tile, in the window of the filters around each place.

    Parameters
    ----------
    bank
        The demosaicing method.
    values
        Of each place.
    """
    places = np.arange(values.size).reshape(values.shape)
    return values.ravel()[channels_around(places, bank.radius)]


def per_place(bank: FilterBank, variance_e2: Array) -> Float[Array, "ty tx"]:
    """Variances of the raw pixels of a tile, >= 0, from one per channel or per place. [e-^2]

    Raises
    ------
    InputError
        As `per_channel`, or if the tile has another shape.
    """
    tile = channel_tile(bank.mosaic, bank.names)
    if np.ndim(variance_e2) < 2:
        return per_channel(bank, variance_e2)[tile]
    if np.shape(variance_e2) != tile.shape:
        raise InputError(
            "variance_e2",
            f"must have the shape of the tile, {tile.shape}",
            value=np.shape(variance_e2),
        )
    return _check.non_negative("variance_e2", "e-^2", variance_e2)


def per_channel(bank: FilterBank, variance_e2: Array) -> Float[Array, " p"]:
    """Variances of raw pixels, one per channel of the bank, >= 0. [e-^2]

    Raises
    ------
    InputError
        If a variance is negative or not finite, or there is not one per channel.
    """
    variance = _check.non_negative("variance_e2", "e-^2", variance_e2)
    _check.same_length("channels", variance=variance.size, names=len(bank.names))
    return variance
