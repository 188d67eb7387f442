"""Linear denoising: one symmetric filter per component, and its noise on a flat field.

The filters are the same everywhere. They follow from the model of
`chromanoise.imaging.PicturePrior`: neighbors of a picture are correlated, and its noise is white.
The noise of a flat field after a linear method has a closed form, for planes and, followed by
demosaicing, for a mosaic.
"""

from collections.abc import Callable, Mapping
from functools import lru_cache, partial

import numpy as np

from chromanoise.base import Array, Float, Float32, InputError, Num, check, dataclass, eigh
from chromanoise.imaging.demosaic import FilterBank, bank_of
from chromanoise.imaging.demosaic_methods import (
    PicturePrior,
    lmmse_filters,
    power_through,
    transfer_functions,
)
from chromanoise.imaging.denoising.electron_planes import DenoisingMethod, NoisyPlanes
from chromanoise.sensor import Mosaic

RADIUS_PX = 12
"""Radius of the filters. [pixels]"""
_TERMS = 4  # separable terms of a kernel: the expected squared error is within 1e-5 of the best
_LEAST_SNR = 1e-9  # below it a kernel is the mean of its window
_ROUNDING = 1e-12


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearFilter:
    """A linear method for ``p`` planes: a filter for each of ``p`` combinations of them.

    Attributes
    ----------
    to_components
        From planes to components, per pixel.
    kernels
        Weights of the k x k pixels around a pixel, for each component; symmetric. [1]
    from_components
        From filtered components to planes.

    Raises
    ------
    InputError
        If a number is not finite, the sizes differ, or a kernel is not symmetric or has an even
        size.
    """

    to_components: Float[Array, "p p"]
    kernels: Float[Array, "p k k"]
    from_components: Float[Array, "p p"]

    def __post_init__(self) -> None:
        for name in ("to_components", "kernels", "from_components"):
            check.finite(name, "1", getattr(self, name))
        check.same_length(
            "components",
            to_components=len(self.to_components),
            kernels=len(self.kernels),
            from_components=len(self.from_components),
        )
        turned = (self.kernels.swapaxes(-1, -2), self.kernels[:, ::-1], self.kernels[:, :, ::-1])
        apart = max(float(np.abs(self.kernels - other).max()) for other in turned)
        if self.kernels.shape[-1] % 2 == 0 or apart > _ROUNDING * np.abs(self.kernels).max():
            raise InputError(
                "kernels",
                "must have an odd size, and be equal when rows, or columns, are reversed or both "
                "exchanged",
                value=self.kernels.shape,
                found=f"have shape {self.kernels.shape} and differ by up to {apart:.3g}",
            )
        check.freeze(self, "to_components", "kernels", "from_components")

    @property
    def matrices(self) -> Float[Array, "p p k k"]:
        """Weights of the pixels of plane j (second axis) for plane i (first axis). [1]"""
        return np.einsum(
            "ac,ckl,cb->abkl", self.from_components, self.kernels, self.to_components, optimize=True
        )


def linear_filters(planes: NoisyPlanes, name: str) -> LinearFilter:
    """The filters of a linear method, for the noise of the planes at the mean of typical scenes.

    Parameters
    ----------
    planes
        Only their noise and their prior are used.
    name
        ``wiener``: one filter for all planes, for the SNR of the component with most signal. It
        commutes with a color matrix. ``lmmse``: a filter for each of `NoisyPlanes.components`, so
        where color is weaker than the noise only its coarse structure is kept.

    Raises
    ------
    InputError
        If the name is unknown, or a plane has no noise.

    Notes
    -----
    The signal of a component has the covariance rho^r at a distance of r pixels of a plane, with
    the rho of `PicturePrior`. Each kernel is the linear estimate of least squared error from the
    pixels of its window among those whose weights sum to 1 (ordinary kriging, as in
    `chromanoise.imaging.lmmse_filters`). The sum is 1, not the gain of the Wiener filter at
    frequency 0, because a flat field then keeps its mean whatever its color and brightness.
    In large windows the result is the Wiener filter S / (S + 1) of the spectrum S of the signal
    (Wiener, Extrapolation, Interpolation, and Smoothing of Stationary Time Series, 1949).

    Examples
    --------
    >>> from chromanoise.imaging.denoising import NoisyPlanes
    >>> from chromanoise.sensor import VarianceLaw
    >>> planes = NoisyPlanes(
    ...     values_e=np.zeros((1, 1, 1), np.float32), prior_e2=np.array([[500.0]]),
    ...     law=VarianceLaw(floor_e2=25.0, slope_e=1.0), prior_mean_e=np.array([25.0]),
    ...     names=("W",))
    >>> float(linear_filters(planes, "wiener").kernels.sum().round(12))
    1.0
    """
    check.one_of("linear method", name, tuple(_FILTERS))
    return _FILTERS[name](planes)


def filtered(values_e: Num[Array, "h w p"], linear_filter: LinearFilter) -> Float32[Array, "h w p"]:
    """Planes after a linear filter; beyond the borders the planes are mirrored. [e-]

    Parameters
    ----------
    values_e
        Values of the planes. [e-]
    linear_filter
        As many components as planes.

    Raises
    ------
    InputError
        If the number of planes and of components differs.

    Notes
    -----
    A kernel is a sum of products of a filter along rows and one along columns, its eigenvectors.

    Examples
    --------
    >>> mean = LinearFilter(
    ...     to_components=np.eye(1), kernels=np.full((1, 3, 3), 1 / 9), from_components=np.eye(1))
    >>> filtered(np.eye(3, dtype=np.float32)[..., None], mean)[1, 1].round(6)
    array([0.333333], dtype=float32)
    """
    from scipy.ndimage import correlate1d

    height, width, count = values_e.shape
    check.same_length("planes", values=count, filter=len(linear_filter.kernels))
    planes = np.ascontiguousarray(np.moveaxis(values_e, -1, 0))
    out = np.zeros((count, height, width))
    for kernel, mix, share in zip(
        linear_filter.kernels,
        linear_filter.to_components,
        linear_filter.from_components.T,
        strict=True,
    ):
        # products of whole arrays: a matrix product may round differently in a strip
        component = _weighted(planes, mix)
        smooth = np.zeros((height, width))
        for weight, taps in _separable(kernel):
            along = correlate1d(component, taps, axis=0, mode="reflect")
            smooth += weight * correlate1d(along, taps, axis=1, mode="reflect")
        for i in np.flatnonzero(share):
            out[i] += share[i] * smooth
    return np.ascontiguousarray(np.moveaxis(out, 0, -1), np.float32)


def _weighted(planes: Num[Array, "p h w"], weights: Float[Array, " p"]) -> Float[Array, "h w"]:
    """Sum of the planes with weights, in order of the planes."""
    total = np.zeros(planes.shape[1:])
    for i in np.flatnonzero(weights):
        total += weights[i] * planes[i]
    return total


def _separable(kernel: Float[Array, "k k"]) -> list[tuple[float, Float[Array, " k"]]]:
    """Weights and taps of the products of which a symmetric kernel is the sum."""
    weights, taps = eigh("kernels", kernel)
    least = _ROUNDING * np.abs(weights).max()
    # even, so that the filter is the same in both directions to the last bit
    return [
        (float(weight), 0.5 * (column + column[::-1]))
        for weight, column in zip(weights, taps.T, strict=True)
        if abs(weight) > least
    ]


@lru_cache(maxsize=256)
def _kernel(power_snr: float) -> Float[Array, "k k"]:
    """The kernel for the variance of a signal over that of white noise; the sum is 1."""
    prior = PicturePrior(
        names=("signal",),
        covariance_e2=np.array([[max(power_snr, _LEAST_SNR)]]),
        noise_e2=np.ones(1),
    )
    bank = lmmse_filters(Mosaic((("signal",),)), prior, side=2 * RADIUS_PX + 1)
    best = bank.kernels[0, 0, 0]
    best = (best + best.T) / 2
    weights, taps = eigh("kernels", (best + best[::-1] + best[:, ::-1] + best[::-1, ::-1]) / 4)
    largest = np.argsort(-np.abs(weights))[:_TERMS]
    even = 0.5 * (taps + taps[::-1])[:, largest]
    kernel = (even * weights[largest]) @ even.T
    return check.frozen((kernel + kernel.T) / (2 * kernel.sum()))


def _wiener(planes: NoisyPlanes) -> LinearFilter:
    _, power_snr = planes.components()
    alone = np.eye(len(power_snr))
    kernels = np.stack([_kernel(float(power_snr[0]))] * len(power_snr))
    return LinearFilter(to_components=alone, kernels=kernels, from_components=alone)


def _lmmse(planes: NoisyPlanes) -> LinearFilter:
    (directions, power_snr), unit = planes.components(), planes.noise_unit_e
    return LinearFilter(
        to_components=directions.T / unit,
        kernels=np.stack([_kernel(float(one)) for one in power_snr]),
        from_components=unit[:, None] * directions,
    )


_FILTERS: Mapping[str, Callable[[NoisyPlanes], LinearFilter]] = {
    "wiener": _wiener,
    "lmmse": _lmmse,
}


def _denoised(name: str, planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    return filtered(planes.values_e, linear_filters(planes, name))


WIENER = DenoisingMethod(
    name="wiener",
    what="One low-pass filter for all planes, designed for the SNR of typical scenes.",
    denoise=partial(_denoised, "wiener"),
    reach_px=RADIUS_PX,
    linear=True,
)
"""The Wiener filter, the same for all planes."""
LMMSE = DenoisingMethod(
    name="lmmse",
    what="A filter for each component: luminance keeps fine detail, color only coarse structure.",
    denoise=partial(_denoised, "lmmse"),
    reach_px=RADIUS_PX,
    linear=True,
)
"""Linear minimum mean squared error, one filter for each component of the planes."""


def denoised_covariance(
    linear_filter: LinearFilter, variance_e2: Float[Array, " p"]
) -> Float[Array, "p p"]:
    """Covariance of the planes of one pixel after a linear method. [e-^2]

    Parameters
    ----------
    variance_e2
        Variance of each plane before it, independent between pixels and planes, as
        `NoisyPlanes.variance_e2` at the mean of the flat field. [e-^2]

    Raises
    ------
    InputError
        If a variance is negative or not finite, or there is not one per plane.

    Notes
    -----
    The sum, over the window and the planes, of the product of two weights and the variance. After
    a color matrix C the covariance S is C S C^T (`chromanoise.noise.through`).

    Examples
    --------
    The mean of 3 x 3 pixels has a ninth of the variance.

    >>> mean = LinearFilter(
    ...     to_components=np.eye(2), kernels=np.full((2, 3, 3), 1 / 9), from_components=np.eye(2))
    >>> denoised_covariance(mean, np.array([90.0, 9.0])).round(12)
    array([[10.,  0.],
           [ 0.,  1.]])
    """
    variance = _per_plane(linear_filter, variance_e2)
    weights = linear_filter.matrices
    return np.asarray(np.einsum("abij,cbij,b->ac", weights, weights, variance, optimize=True))


def denoised_noise_spectrum(
    linear_filter: LinearFilter, variance_e2: Float[Array, " p"], shape: tuple[int, int]
) -> Float[Array, "h w p p"]:
    """Noise power and co-spectra of the planes after a linear method. [e-^2]

    Parameters
    ----------
    linear_filter, variance_e2
        As `denoised_covariance`.
    shape
        Rows and columns of the Fourier plane, each at least the side of a kernel.

    Raises
    ------
    InputError
        If a variance is negative or not finite, there is not one per plane, or the Fourier plane
        is smaller than a kernel.

    Notes
    -----
    Frequencies as `numpy.fft.fftfreq`. The mean over the Fourier plane is `denoised_covariance`, as
    in `chromanoise.imaging.noise_power_spectrum`.

    Examples
    --------
    >>> same = LinearFilter(
    ...     to_components=np.eye(1), kernels=np.ones((1, 1, 1)), from_components=np.eye(1))
    >>> denoised_noise_spectrum(same, np.array([9.0]), (1, 3)).ravel()
    array([9., 9., 9.])
    """
    variance = _per_plane(linear_filter, variance_e2)
    return power_through(transfer_functions(linear_filter.matrices.swapaxes(0, 1), shape), variance)


def denoised_bank(linear_filter: LinearFilter, bank: FilterBank) -> FilterBank:
    """A linear method on the planes of a mosaic, then demosaicing, as one demosaicing method.

    Its noise follows as for any demosaicing method: `chromanoise.imaging.demosaicked_covariance`,
    `noise_power_spectrum` and `flat_field_noise`.

    Parameters
    ----------
    linear_filter
        For the planes of `packed`: one per place of the tile, in the order of its rows.

    Raises
    ------
    InputError
        If there is not one component per place of the tile.

    Notes
    -----
    Exact except near the borders, where the planes and the mosaic are mirrored differently. A pixel
    k rows away in a plane is k tile heights away in the mosaic.

    Examples
    --------
    >>> from chromanoise.imaging import bilinear_filters
    >>> from chromanoise.sensor import Mosaic
    >>> mean = LinearFilter(
    ...     to_components=np.eye(2), kernels=np.full((2, 3, 3), 1 / 9), from_components=np.eye(2))
    >>> both = denoised_bank(mean, bilinear_filters(Mosaic((("R", "G"),))))
    >>> (both.kernels[0, 0, 0][both.radius] * 9).round(12)
    array([0., 1., 0., 1., 0., 1., 0.])
    """
    ty, tx, channels, side, _ = bank.kernels.shape
    check.same_length(
        "planes", **{"the tile": ty * tx, "the linear method": len(linear_filter.kernels)}
    )
    of_places = _on_mosaic(linear_filter.matrices, (ty, tx))
    wide = of_places.shape[-1]
    kernels = np.zeros((ty, tx, channels, side + wide - 1, side + wide - 1))
    for a, b, i, j in np.ndindex(ty, tx, side, side):
        there = (a + i - bank.radius) % ty, (b + j - bank.radius) % tx
        kernels[a, b, :, i : i + wide, j : j + wide] += (
            bank.kernels[a, b, :, i, j, None, None] * of_places[there]
        )
    return bank_of(f"linear denoising, {bank.made_by}", bank.mosaic, bank.names, kernels)


def _on_mosaic(
    weights: Float[Array, "p p k k"], tile: tuple[int, int]
) -> Float[Array, "ty tx side side"]:
    """Weights of the pixels of a mosaic around each place of its tile."""
    (ty, tx), reach = tile, weights.shape[-1] // 2
    radius = max((reach + 1) * t - 1 for t in tile)
    out = np.zeros((ty, tx, 2 * radius + 1, 2 * radius + 1))
    steps = np.arange(-reach, reach + 1)
    for a, b, c, d in np.ndindex(ty, tx, ty, tx):
        rows, columns = radius + ty * steps + c - a, radius + tx * steps + d - b
        out[a, b][np.ix_(rows, columns)] = weights[a * tx + b, c * tx + d]
    return out


def _per_plane(linear_filter: LinearFilter, variance_e2: Array) -> Float[Array, " p"]:
    """Variances >= 0, one per plane. [e-^2]"""
    variance = check.non_negative("variance_e2", "e-^2", variance_e2)
    check.same_length("planes", variance=variance.size, filter=len(linear_filter.kernels))
    return variance
