"""Demosaicing filters from a prior: neighbors and channels of an image are correlated.

The model is the simplest that has both correlations: the covariance of channel c at a pixel and
channel d at a distance r is C_cd rho^r. It determines how much of another channel's detail to add
(`gradient_corrected_filters`) and the best weights of a whole window (`lmmse_filters`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import eigvalsh, pinv, solve
from chromanoise._shapes import Float
from chromanoise.errors import InputError
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
from chromanoise.sensor import Mosaic


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PicturePrior:
    """Second moments of images, and of the noise in them.

    Attributes
    ----------
    names
        The ``p`` channels.
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
        covariance = _check.finite("covariance_e2", "e-^2", self.covariance_e2)
        _check.same_length("channels", names=len(self.names), covariance=covariance.shape[0])
        _check.same_length("channels", names=len(self.names), noise=len(self.noise_e2))
        _check.non_negative("noise_e2", "e-^2", self.noise_e2)
        _check.within("correlation", "1", self.correlation, 1e-6, 1 - 1e-6)
        spread = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
        for name, value in zip(self.names, spread, strict=True):
            _check.positive(f"standard deviation of {name} over the pictures", "e-", value)
        unit = covariance / np.outer(spread, spread)
        least = eigvalsh("covariance_e2", unit).min()
        if np.abs(unit - unit.T).max() > 1e-9 or least < -1e-9:
            raise InputError(
                "covariance_e2",
                "must be symmetric and positive semidefinite [e-^2]",
                value=float(least),
                found=f"its least eigenvalue, with channels scaled to 1, is {least:.3g}",
            )
        _check.freeze(self, "covariance_e2", "noise_e2")


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
    names
        Channel names.
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
    colors = _check.finite("electrons", "e-", electrons)
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
    mosaic
        The periodic array.
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
    mosaic
        The periodic array.
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
        _check.among("channel of the prior", name, prior.names)
    _check.same_length("channels", mosaic=len(names), prior=len(prior.names))
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
