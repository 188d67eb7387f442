"""Visual noise of ISO 15739: noise as perceived from a viewing distance, in CIELUV.

X, Y, Z are divided by those of white (the standard's XYZ of illuminant E), so C1 and C2 of a
neutral are 0; the caller supplies the transform from there to L*, u*, v*.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    InputError,
    check,
    congruence_of_many,
    dataclass,
    inv,
    matrix_rank,
    variances_along,
)


@dataclass(frozen=True, kw_only=True)
class VisualNoiseModel:
    """An edition of the standard: weights and contrast sensitivity functions (CSF).

    Attributes
    ----------
    edition
        Name of the edition, given in results.
    weights
        Weights of the standard deviations of L*, u*, v*.
    luminance
        a, b, c, K of a f^c exp(-b f) / K, with f in cycles per degree.
    red_green, blue_yellow
        a1, b1, c1, a2, b2, c2, K of (a1 exp(-b1 f^c1) + a2 exp(-b2 f^c2)) / K.
    opponent_from_xyz
        Rows A, C1, C2 of the space in which the CSF are applied, from X, Y, Z over those of white.
    """

    edition: str
    weights: tuple[float, float, float]
    luminance: tuple[float, float, float, float]
    red_green: tuple[float, float, float, float, float, float, float]
    blue_yellow: tuple[float, float, float, float, float, float, float]
    opponent_from_xyz: tuple[tuple[float, float, float], ...]

    def __post_init__(self) -> None:
        for name in ("weights", "luminance", "red_green", "blue_yellow"):
            check.non_negative(f"{name} of {self.edition}", "1", getattr(self, name))
        for name in ("luminance", "red_green", "blue_yellow"):
            check.positive(f"K of {name} of {self.edition}", "1", getattr(self, name)[-1])
        matrix = check.finite("opponent_from_xyz", "1", self.opponent_from_xyz)
        if matrix.shape != (3, 3) or matrix_rank("opponent_from_xyz", matrix) < 3:
            rank = matrix_rank("opponent_from_xyz", matrix)
            raise InputError(
                f"opponent_from_xyz of {self.edition}",
                "must be an invertible 3 x 3 matrix",
                value=matrix.shape,
                found=f"has shape {matrix.shape} and rank {rank}",
            )


ISO_15739_2017 = VisualNoiseModel(
    edition="ISO 15739:2017",
    weights=(1.0, 0.852, 0.323),
    luminance=(75.0, 0.2, 0.8, 34.05),
    red_green=(91.228, 0.0003, 2.803, 74.907, 0.0038, 2.601, 55.34),
    blue_yellow=(5.623, 0.00001, 3.4066, 41.9363, 0.083, 1.3684, 15.85),
    opponent_from_xyz=((0.0, 1.0, 0.0), (1.0, -1.0, 0.0), (0.0, 0.4, -0.4)),
)
"""Weights 1, 0.852, 0.323; CSF of the form of Johnson & Fairchild, Color Res. Appl. 28, 425 (2003),
each with a peak of 3.00. Constants as given in the literature, not checked against the text of the
standard; for another edition create your own model."""


@dataclass(frozen=True, kw_only=True, eq=False)
class VisualNoise:
    """Perceived standard deviations and their weighted sum.

    Attributes
    ----------
    sigma_luv
        Standard deviations of L*, u*, v* after filtering by the CSF. [CIELUV]
    total
        Their weighted sum. [CIELUV]
    edition
        Edition of the standard that defines the weights.
    """

    sigma_luv: Float[Array, "3"]
    total: float
    edition: str

    def __post_init__(self) -> None:
        check.non_negative("sigma_luv", "CIELUV", self.sigma_luv)
        check.not_negative("total", "CIELUV", self.total)
        check.freeze(self, "sigma_luv")


def contrast_sensitivity(
    frequency_cpd: Float[Array, "*px"], model: VisualNoiseModel = ISO_15739_2017
) -> Float[Array, "*px 3"]:
    """Contrast sensitivity for luminance, red-green and blue-yellow at a spatial frequency. [1]

    Parameters
    ----------
    frequency_cpd
        Cycles per degree of visual angle. [cpd]
    model
        Model with the parameters of the three curves.

    Raises
    ------
    InputError
        If a frequency is negative or not finite.

    Examples
    --------
    The luminance curve peaks at c / b = 4 cycles per degree.

    >>> contrast_sensitivity(np.array([3.9, 4.0, 4.1]))[:, 0].round(4)
    array([2.9995, 3.0002, 2.9995])
    """
    f = check.non_negative("frequency_cpd", "cpd", frequency_cpd)
    a, b, c, k = model.luminance
    curves = [a * f**c * np.exp(-b * f) / k]
    for a1, b1, c1, a2, b2, c2, k2 in (model.red_green, model.blue_yellow):
        curves.append((a1 * np.exp(-b1 * f**c1) + a2 * np.exp(-b2 * f**c2)) / k2)
    return np.stack(curves, axis=-1)


def pixels_per_degree(*, distance_mm: float, pixel_pitch_mm: float) -> float:
    """Pixels of a display or print in one degree of visual angle. [1/deg]

    Parameters
    ----------
    distance_mm
        Viewing distance. [mm]
    pixel_pitch_mm
        Pixel pitch of the display. [mm]

    Raises
    ------
    InputError
        If a length is not above 0.

    Examples
    --------
    >>> round(pixels_per_degree(distance_mm=600.0, pixel_pitch_mm=0.25), 3)
    41.889
    """
    distance = check.positive("distance_mm", "mm", distance_mm)
    pitch = check.positive("pixel_pitch_mm", "mm", pixel_pitch_mm)
    return float(2.0 * distance * np.tan(np.radians(0.5)) / pitch)


def frequencies_cpd(shape: tuple[int, int], *, pixels_per_degree: float) -> Float[Array, "h w"]:
    """Spatial frequency of each cell of a picture's Fourier plane, ordered as `numpy.fft`. [cpd]

    Raises
    ------
    InputError
        If ``pixels_per_degree`` is not above 0.

    Examples
    --------
    >>> frequencies_cpd((1, 4), pixels_per_degree=40.0)
    array([[ 0., 10., 20., 10.]])
    """
    scale = check.positive("pixels_per_degree", "1/deg", pixels_per_degree)
    rows, columns = (np.fft.fftfreq(count) * scale for count in shape)
    return np.hypot(rows[:, None], columns[None, :])


def visual_noise_from_spectrum(
    spectrum: Float[Array, "h w 3 3"],
    luv_from_xyz: Float[Array, "3 3"],
    *,
    pixels_per_degree: float,
    model: VisualNoiseModel = ISO_15739_2017,
) -> VisualNoise:
    """Visual noise of a noise power spectrum, in closed form.

    Parameters
    ----------
    spectrum
        Covariance of X, Y, Z (over those of white) per cell of the Fourier plane, in the order of
        `numpy.fft`, scaled so that its mean over the plane is the covariance of one pixel.
    luv_from_xyz
        Jacobian of L*, u*, v* at the mean color, for first-order propagation.
    pixels_per_degree
        Resolution at the viewing distance. [1/deg]
    model
        Edition and weights of the standard.

    Raises
    ------
    InputError
        If an entry is not finite.

    Notes
    -----
    ISO 15739:2017, annex B, with the picture replaced by the second moments of its noise: the
    filters act in the opponent space A, C1, C2, and the mean passes unchanged.
    """
    power = check.finite("spectrum", "1", spectrum)
    at = frequencies_cpd(power.shape[:2], pixels_per_degree=pixels_per_degree)
    passed = _passed(at, model)
    opponent = np.asarray(model.opponent_from_xyz)
    factors = (opponent, power, opponent, passed, passed)
    seen = np.einsum("ac,hwcd,bd,hwa,hwb->ab", *factors, optimize=True) / at.size
    jacobian = check.finite("luv_from_xyz", "1", luv_from_xyz)
    into = jacobian @ inv("opponent_from_xyz", opponent)
    variance = np.einsum("ia,ab,ib->i", into, seen, into)
    return _weighted(np.sqrt(np.maximum(variance, 0.0)), model)


def visual_noise_of_white(
    covariance: Float[Array, "3 3"],
    luv_from_xyz: Float[Array, "3 3"],
    *,
    pixels_per_degree: float,
    model: VisualNoiseModel = ISO_15739_2017,
    samples: int = 256,
) -> VisualNoise:
    """Visual noise of pixels with mutually independent noise.

    Parameters
    ----------
    covariance
        Covariance of X, Y, Z (over those of white) in one pixel.
    luv_from_xyz, pixels_per_degree, model
        As `visual_noise_from_spectrum`.
    samples
        Side of the Fourier plane on which the CSF are averaged.

    Raises
    ------
    InputError
        If an entry is not finite.
    """
    viewed = viewed_covariance(
        covariance, pixels_per_degree=pixels_per_degree, model=model, samples=samples
    )
    jacobian = check.finite("luv_from_xyz", "1", luv_from_xyz)
    variance = variances_along(jacobian, viewed)
    return _weighted(np.sqrt(np.maximum(variance, 0.0)), model)


def viewed_covariance(
    covariance: Float[Array, "*px 3 3"],
    *,
    pixels_per_degree: float,
    model: VisualNoiseModel = ISO_15739_2017,
    samples: int = 256,
) -> Float[Array, "*px 3 3"]:
    """Covariance of X, Y, Z that the CSF leave of pixels with mutually independent noise. [1]

    Parameters
    ----------
    covariance
        Covariance of X, Y, Z (over those of white) in one pixel.
    pixels_per_degree, model, samples
        As `visual_noise_of_white`.

    Raises
    ------
    InputError
        If an entry is not finite.
    """
    to_opponent, from_opponent = _opponent(model)
    in_pixel = congruence_of_many(to_opponent, check.finite("covariance", "1", covariance))
    shares = _shares_of_white(pixels_per_degree, model, samples)
    return congruence_of_many(from_opponent, in_pixel * shares)


@lru_cache(maxsize=32)
def _opponent(model: VisualNoiseModel) -> tuple[Float[Array, "3 3"], Float[Array, "3 3"]]:
    to_opponent = np.asarray(model.opponent_from_xyz)
    return to_opponent, inv("opponent_from_xyz", to_opponent)


@lru_cache(maxsize=32)
def _shares_of_white(
    pixels_per_degree: float, model: VisualNoiseModel, samples: int
) -> Float[Array, "3 3"]:
    """Of a covariance of A, C1, C2 in one pixel, the shares that pass the CSF."""
    at = frequencies_cpd((samples, samples), pixels_per_degree=pixels_per_degree)
    passed = _passed(at, model).reshape(-1, 3)
    return passed.T @ passed / at.size


def visual_noise_of_picture(
    xyz: Float[Array, "h w 3"],
    luv: Callable[[Array], Array],
    *,
    pixels_per_degree: float,
    model: VisualNoiseModel = ISO_15739_2017,
) -> VisualNoise:
    """Visual noise of a picture of a flat patch, through its Fourier transform.

    Parameters
    ----------
    xyz
        The patch, X, Y, Z over those of white.
    luv
        L*, u*, v* of such X, Y, Z, over the last axis.
    pixels_per_degree, model
        As `visual_noise_from_spectrum`.

    Raises
    ------
    InputError
        If an entry is not finite.

    Notes
    -----
    ISO 15739:2017, annex B. Negative X, Y, Z after filtering are passed to ``luv``; the reference
    implementation of the standard sets them to 0.
    """
    patch = check.finite("xyz", "1", xyz)
    at = frequencies_cpd(patch.shape[:2], pixels_per_degree=pixels_per_degree)
    opponent = np.asarray(model.opponent_from_xyz)
    mean = patch.mean(axis=(0, 1))
    ripples = np.fft.fft2((patch - mean) @ opponent.T, axes=(0, 1)) * _passed(at, model)
    filtered = np.fft.ifft2(ripples, axes=(0, 1)).real @ inv("opponent_from_xyz", opponent).T
    return _weighted(np.std(luv(mean + filtered), axis=(0, 1)), model)


def _passed(frequency_cpd: Array, model: VisualNoiseModel) -> Array:
    """The CSF with 0 at frequency 0, because the mean is not noise."""
    curves = contrast_sensitivity(frequency_cpd, model)
    return np.where(frequency_cpd[..., None] > 0, curves, 0.0)


def _weighted(sigma_luv: Array, model: VisualNoiseModel) -> VisualNoise:
    return VisualNoise(
        sigma_luv=sigma_luv,
        total=float(np.dot(model.weights, sigma_luv)),
        edition=model.edition,
    )
