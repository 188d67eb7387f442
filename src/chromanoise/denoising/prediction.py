"""Noise of a flat field after a linear method, in closed form.

For planes and, followed by demosaicing, for a mosaic.
"""

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.denoising.linear import LinearFilter
from chromanoise.imaging.demosaic import FilterBank, bank_of
from chromanoise.imaging.demosaic_noise import power_through, transfer_functions


def denoised_covariance(
    linear_filter: LinearFilter, variance_e2: Float[Array, " p"]
) -> Float[Array, "p p"]:
    """Covariance of the planes of one pixel after a linear method. [e-^2]

    Parameters
    ----------
    linear_filter
        Of `linear_filters`.
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
    Frequencies as `np.fft.fftfreq`. The mean over the Fourier plane is `denoised_covariance`, as in
    `chromanoise.imaging.noise_power_spectrum`.

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
    bank
        The demosaicing method.

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
    _check.same_length(
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
    variance = _check.non_negative("variance_e2", "e-^2", variance_e2)
    _check.same_length("planes", variance=variance.size, filter=len(linear_filter.kernels))
    return variance
