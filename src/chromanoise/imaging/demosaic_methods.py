"""Demosaicing filters from a statistical model of images, their noise, and all methods by name.

The model is the simplest in which both neighbors and channels are correlated: the covariance of
channel c at a pixel and channel d at a distance r is C_cd rho^r. It determines how much of another
channel's detail to add (`gradient_corrected_filters`) and the best weights of a whole window
(`lmmse_filters`).

A filter bank is linear, so it determines the covariance of the channels at each position in the
tile, and the noise power spectrum over the whole image, both in closed form. The methods by name
are built for one operating point.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from chromanoise.base import (
    Array,
    Complex,
    Float,
    InputError,
    Int,
    check,
    dataclass,
    eigvalsh,
    pinv,
    solve,
)
from chromanoise.imaging.demosaic import (
    FilterBank,
    bank_of,
    bilinear_filters,
    channel_period,
    channel_tile,
    channels_around,
    is_bayer,
    malvar_filters,
)
from chromanoise.noise import (
    Exposure,
    OperatingPoint,
    after_counting,
    counted_electrons,
    crosstalk_pattern,
    expected_electrons,
    mean_noise_covariance,
    noise_sources,
    with_noise,
)
from chromanoise.sensor import Mosaic, Sensor, shares_after_counting
from chromanoise.spectra import Scene, colorchecker


@dataclass(frozen=True, kw_only=True, eq=False)
class PicturePrior:
    """Second moments of images, and of the noise in them.

    Attributes
    ----------
    covariance_e2
        Covariance of the channels of one pixel over all images. [e-^2]
    noise_e2
        Variance of the noise of a raw pixel, per channel. [e-^2]
    correlation
        Correlation of neighboring pixels of one channel; at a distance of r pixels it is this value
        to the power r. [1]

    Raises
    ------
    InputError
        If the covariance is not symmetric and positive semidefinite, a channel does not vary, or
        the correlation is not between 0 and 1.
    """

    names: tuple[str, ...]
    covariance_e2: Float[Array, "p p"]
    noise_e2: Float[Array, " p"]
    correlation: float = 0.95

    def __post_init__(self) -> None:
        covariance = check.finite("covariance_e2", "e-^2", self.covariance_e2)
        check.same_length("channels", names=len(self.names), covariance=covariance.shape[0])
        check.same_length("channels", names=len(self.names), noise=len(self.noise_e2))
        check.non_negative("noise_e2", "e-^2", self.noise_e2)
        check.within("correlation", "1", self.correlation, 1e-6, 1 - 1e-6)
        spread = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
        for name, value in zip(self.names, spread, strict=True):
            check.positive(f"standard deviation of {name} over the pictures", "e-", value)
        unit = covariance / np.outer(spread, spread)
        least = eigvalsh("covariance_e2", unit).min()
        if np.abs(unit - unit.T).max() > 1e-9 or least < -1e-9:
            raise InputError(
                "covariance_e2",
                "must be symmetric and positive semidefinite [e-^2]",
                value=float(least),
                found=f"its least eigenvalue, with channels scaled to 1, is {least:.3g}",
            )
        check.freeze(self, "covariance_e2", "noise_e2")


def picture_prior(
    electrons: Float[Array, "k p"],
    names: Sequence[str],
    *,
    noise_e2: Float[Array, " p"],
    correlation: float = 0.95,
) -> PicturePrior:
    """The prior of images with the color statistics of a given set, such as a chart.

    Parameters
    ----------
    electrons
        Expected electrons of each color of the set. [e-]
    noise_e2
        Variance of the noise of a raw pixel, per channel: eq. 7 at the mean of the set. [e-^2]
    correlation
        Correlation of neighboring pixels; 0.95 is typical of photographs. [1]

    Raises
    ------
    InputError
        If an entry is not finite, a channel is constant, or there is only one color.

    Examples
    --------
    >>> seen = np.array([[100.0, 0.0], [300.0, 100.0]])
    >>> picture_prior(seen, ("W", "R"), noise_e2=np.array([200.0, 50.0])).covariance_e2
    array([[20000., 10000.],
           [10000.,  5000.]])
    """
    colors = check.finite("electrons", "e-", electrons)
    if len(colors) < 2:
        raise InputError(
            "electrons",
            "must hold at least 2 colors",
            value=len(colors),
            found=f"holds {len(colors)}",
        )
    away = colors - colors.mean(axis=0)
    return PicturePrior(
        names=tuple(names),
        covariance_e2=away.T @ away / (len(colors) - 1),
        noise_e2=noise_e2,
        correlation=correlation,
    )


def gradient_corrected_filters(
    mosaic: Mosaic, names: Sequence[str] | None = None, prior: PicturePrior | None = None
) -> FilterBank:
    """Bilinear interpolation plus a fraction of the detail of other channels.

    Parameters
    ----------
    names
        As `bilinear_filters`.
    prior
        Statistics of the images. Optional only for a Bayer array, which then gets the
        published filters of Malvar, with gains from photographs whose channels are equally strong.

    Raises
    ------
    InputError
        If ``names`` or those of the prior are not the channels of the mosaic, or there is no prior
        for an array other than Bayer.

    Notes
    -----
    Two details may be added to the bilinear estimate of c, and neither changes a constant or a
    ramp. One is the pixel's own sample minus the mean of the four nearest pixels at the same
    position in the channel's period, the Laplacian of Malvar, He & Cutler (2004). The other
    is the channel with the most pixels, interpolated at this pixel, minus its interpolation from
    the pixels of c: the color difference of Adams & Hamilton (US 5,506,619), made linear.
    Their gains are those of least squared error under the prior, Cov(e, z) Cov(z)^-1 with e the
    error of the bilinear estimate; Malvar's gains came from least squares over photographs in the
    same way.

    Examples
    --------
    With one channel, no value is missing.

    >>> alone = picture_prior(np.array([[1.0], [2.0]]), ("W",), noise_e2=np.zeros(1))
    >>> gradient_corrected_filters(Mosaic((("W",),)), prior=alone).kernels.ravel()
    array([1.])
    """
    if prior is None and is_bayer(mosaic):
        return malvar_filters(mosaic, names)
    if prior is None:
        raise InputError(
            "prior",
            f"must be given for a mosaic of {', '.join(mosaic.names)}, because gradient "
            "correction needs the strengths of the channels",
            remedy="make one with picture_prior",
        )
    plain = bilinear_filters(mosaic, names)
    ordered = _ordered(prior, plain.names)
    tile = channel_tile(mosaic, plain.names)
    radius = 2 * max(tile.shape)  # a mean of bilinear means, or four pixels one period away
    window, bilinear = channels_around(tile, radius), _widened(plain.kernels, radius)
    kernels = bilinear.copy()
    for a, b, c in np.ndindex(*kernels.shape[:3]):
        if tile[a, b] != c:
            details = _details(plain, tile, (a, b), c, radius)
            kernels[a, b, c] += _best_detail(ordered, window[a, b], c, bilinear[a, b, c], details)
    return bank_of("gradient-corrected", mosaic, plain.names, kernels)


def lmmse_filters(mosaic: Mosaic, prior: PicturePrior, *, side: int | None = None) -> FilterBank:
    """The best linear estimate of each channel from all pixels of a window, of any channel.

    Parameters
    ----------
    prior
        Statistics of the images and of the raw noise; its names give the order of the result.
    side
        Rows and columns of the window, odd. By default 7, or 2 t - 1 for a longer period t.
        [pixels]

    Raises
    ------
    InputError
        If the names differ, or the window is even or shorter than the tile.

    Notes
    -----
    These weights have the least squared error of all that reproduce uniform colors: those of
    channel d sum to 1 for d = c and to 0 otherwise, so the mean color need not be known (ordinary
    cokriging; Wackernagel, Multivariate Geostatistics, Springer (2003), chapter 24). A window
    as long as the tile contains every position in it, hence every channel. If there is noise, a
    measured channel is smoothed as well. For Bayer arrays: Trussell & Hartley, IEEE Trans. Image
    Process. 11, 485 (2002); Portilla, Otaduy & Dorronsoro, ICIP (2005).

    Examples
    --------
    With one channel and no noise, the measured value is the estimate.

    >>> alone = picture_prior(np.array([[1.0], [2.0]]), ("W",), noise_e2=np.zeros(1))
    >>> lmmse_filters(Mosaic((("W",),)), alone, side=3).kernels.round(12).ravel() + 0.0
    array([0., 0., 0., 0., 1., 0., 0., 0., 0.])
    """
    tile = channel_tile(mosaic, prior.names)
    longest = max(tile.shape)
    width = max(7, 2 * longest - 1) if side is None else side
    if width % 2 == 0 or width < longest:
        raise InputError(
            "side",
            f"must be odd and at least {longest} [pixels], the period of the mosaic, to hold "
            "every channel",
            value=width,
        )
    window = channels_around(tile, width // 2)
    kernels = np.empty((*tile.shape, len(prior.names), width, width))
    for a, b in np.ndindex(*tile.shape):
        kernels[a, b] = _unbiased(prior, window[a, b])
    return FilterBank(mosaic=mosaic, names=prior.names, kernels=kernels, made_by="LMMSE")


def _ordered(prior: PicturePrior, names: tuple[str, ...]) -> PicturePrior:
    """The prior with its channels in another order."""
    for name in names:
        check.among("channel of the prior", name, prior.names)
    check.same_length("channels", mosaic=len(names), prior=len(prior.names))
    order = [prior.names.index(name) for name in names]
    return PicturePrior(
        names=names,
        covariance_e2=prior.covariance_e2[np.ix_(order, order)],
        noise_e2=prior.noise_e2[order],
        correlation=prior.correlation,
    )


def _moments(prior: PicturePrior, window: Array) -> tuple[Array, Array]:
    """Covariance of the raw pixels of a window, and with the channels at its center."""
    at = np.argwhere(np.ones(window.shape)) - window.shape[0] // 2
    channel = window.ravel()
    rho = prior.correlation
    apart = np.hypot(*np.moveaxis(at[:, None] - at, -1, 0))
    pixels = prior.covariance_e2[np.ix_(channel, channel)] * rho**apart
    away = np.hypot(*at.T)
    return (
        pixels + np.diag(prior.noise_e2[channel]),
        prior.covariance_e2[:, channel] * rho**away,
    )


def _unbiased(prior: PicturePrior, window: Array) -> Float[Array, "p k k"]:
    """Cokriging weights; electrons are scaled to give all channels equal weight."""
    pixels, wanted = _moments(prior, window)
    p, scale = len(prior.names), np.sqrt(np.diagonal(prior.covariance_e2))
    pixel_scale = scale[window.ravel()]
    member = (window.ravel()[:, None] == np.arange(p)).astype(float)
    system = np.block(
        [[pixels / np.outer(pixel_scale, pixel_scale), member], [member.T, np.zeros((p, p))]]
    )
    sought = np.concatenate([(wanted / scale[:, None] / pixel_scale).T, np.eye(p)])
    weights = solve("demosaicing filters", system, sought)[: window.size].T
    return (weights * scale[:, None] / pixel_scale).reshape(p, *window.shape)


def _widened(kernels: Array, radius: int) -> Array:
    more = radius - kernels.shape[-1] // 2
    return np.pad(kernels, [(0, 0)] * (kernels.ndim - 2) + [(more, more)] * 2)


def _details(
    plain: FilterBank, tile: Array, place: tuple[int, int], channel: int, radius: int
) -> Float[Array, "2 k k"]:
    """Filters of the two details that may be added to a channel; the second is 0 for the densest.

    Their sums over the pixels of each channel are 0.
    """
    densest = int(np.bincount(tile.ravel()).argmax())
    details = np.zeros((2, 2 * radius + 1, 2 * radius + 1))
    details[0] = _laplacian(channel_period(tile, int(tile[place])), radius)
    if channel != densest:
        details[1] = _widened(plain.kernels[place][densest], radius)
        details[1] -= _interpolated_twice(plain, place, channel, densest, radius)
    return details


def _laplacian(period: tuple[int, int], radius: int) -> Float[Array, "k k"]:
    """A pixel minus the mean of four pixels at the same position in the period."""
    kernel = np.zeros((2 * radius + 1, 2 * radius + 1))
    kernel[radius, radius] = 1.0
    for row, column in ((period[0], 0), (-period[0], 0), (0, period[1]), (0, -period[1])):
        kernel[radius + row, radius + column] -= 0.25
    return kernel


def _interpolated_twice(
    plain: FilterBank, place: tuple[int, int], channel: int, densest: int, radius: int
) -> Float[Array, "k k"]:
    """The densest channel, interpolated where ``channel`` was sampled, interpolated as that is."""
    reach, (ty, tx) = plain.radius, plain.kernels.shape[:2]
    out = np.zeros((2 * radius + 1, 2 * radius + 1))
    weights = plain.kernels[place][channel]
    for i, j in np.argwhere(weights):
        top, left = radius + i - 2 * reach, radius + j - 2 * reach
        there = ((place[0] + i - reach) % ty, (place[1] + j - reach) % tx)
        out[top : top + 2 * reach + 1, left : left + 2 * reach + 1] += (
            weights[i, j] * plain.kernels[there][densest]
        )
    return out


def _best_detail(
    prior: PicturePrior, window: Array, channel: int, estimate: Array, details: Array
) -> Float[Array, "k k"]:
    """The mix of details with least squared error: Cov(e, z) Cov(z)^-1 z."""
    pixels, wanted = _moments(prior, window)
    filters = details.reshape(len(details), -1)
    error = wanted[channel] - estimate.ravel() @ pixels
    spread = filters @ pixels @ filters.T
    gains = pinv("demosaicing filters", spread, hermitian=True) @ (filters @ error)
    return np.tensordot(gains, details, axes=1)


def demosaicked_covariance(
    bank: FilterBank, variance_e2: Float[Array, " p"] | Float[Array, "ty tx"]
) -> Float[Array, "ty tx p p"]:
    """Covariance of the channels of one pixel, at each position in the tile. [e-^2]

    Parameters
    ----------
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
    frequencies as `numpy.fft.fftfreq`. Its mean over the plane is the mean covariance, the scaling
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
    shape
        Rows and columns of the Fourier plane, with frequencies as `numpy.fft.fftfreq`.

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
    return check.non_negative("variance_e2", "e-^2", variance_e2)


def per_channel(bank: FilterBank, variance_e2: Array) -> Float[Array, " p"]:
    """Variances of raw pixels, one per channel of the bank, >= 0. [e-^2]

    Raises
    ------
    InputError
        If a variance is negative or not finite, or there is not one per channel.
    """
    variance = check.non_negative("variance_e2", "e-^2", variance_e2)
    check.same_length("channels", variance=variance.size, names=len(bank.names))
    return variance


def chart_electrons(operating_point: OperatingPoint) -> Float[Array, "k p"]:
    """Expected electrons of the patches of the ColorChecker at this operating point. [e-]

    Parameters
    ----------
    operating_point
        A sensor in its light, with its exposure.

    Raises
    ------
    InputError
        If the sensor's grid is not within 400-1050 nm, the range of the chart data.
    """
    sensor = operating_point.sensor
    scene = Scene(
        illuminant=operating_point.illuminant,
        level_lux=operating_point.level_lux,
        reflectance=colorchecker(sensor.grid).values.T,
    )
    return expected_electrons(scene, sensor, operating_point.exposure)


def chart_prior(operating_point: OperatingPoint) -> PicturePrior:
    """Prior for images with the channel covariance of the ColorChecker at this operating point.

    Parameters
    ----------
    operating_point
        A sensor in its light, with its exposure.

    Raises
    ------
    InputError
        As `chart_electrons`.
    """
    sensor, electrons = operating_point.sensor, chart_electrons(operating_point)
    share = np.full(len(electrons), 1 / len(electrons))
    noise = mean_noise_covariance(electrons, share, sensor, operating_point.exposure)
    return picture_prior(electrons, sensor.names, noise_e2=np.diagonal(noise))


DEMOSAICING: Mapping[str, Callable[[Mosaic, OperatingPoint], FilterBank]] = {
    "bilinear": lambda mosaic, point: bilinear_filters(mosaic, point.sensor.names),
    "malvar": lambda mosaic, point: malvar_filters(mosaic, point.sensor.names),
    "gradient": lambda mosaic, point: gradient_corrected_filters(
        mosaic, point.sensor.names, chart_prior(point)
    ),
    "lmmse": lambda mosaic, point: lmmse_filters(mosaic, chart_prior(point)),
}
"""All are linear, so their noise is predicted (`developed_color`). Malvar is for Bayer only."""
