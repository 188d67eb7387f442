"""Demosaicing methods that have a name, made for one sensor in use."""

from collections.abc import Callable, Mapping

from chromanoise.exposure import Situation, expected_electrons
from chromanoise.imaging.demosaic import FilterBank, bilinear_filters, malvar_filters
from chromanoise.imaging.demosaic_priors import (
    PicturePrior,
    gradient_corrected_filters,
    lmmse_filters,
    picture_prior,
)
from chromanoise.scene import Scene
from chromanoise.sensor import Mosaic
from chromanoise.spectra import colorchecker


def chart_prior(situation: Situation) -> PicturePrior:
    """Pictures whose channels covary as those of the ColorChecker do in this light and exposure.

    Raises
    ------
    InputError
        If the sensor's grid leaves 400-1050 nm, where the chart is measured.
    """
    sensor = situation.sensor
    scene = Scene(
        illuminant=situation.illuminant,
        level_lux=situation.level_lux,
        reflectance=colorchecker(sensor.grid).values.T,
    )
    electrons = expected_electrons(scene, sensor, situation.exposure)
    noise_e2 = electrons.mean(axis=0) + sensor.pixel.read_noise_e**2
    return picture_prior(electrons, sensor.names, noise_e2=noise_e2)


def _bilinear(mosaic: Mosaic, situation: Situation) -> FilterBank:
    return bilinear_filters(mosaic, situation.sensor.names)


def _malvar(mosaic: Mosaic, situation: Situation) -> FilterBank:
    return malvar_filters(mosaic, situation.sensor.names)


def _gradient(mosaic: Mosaic, situation: Situation) -> FilterBank:
    return gradient_corrected_filters(mosaic, situation.sensor.names, chart_prior(situation))


def _lmmse(mosaic: Mosaic, situation: Situation) -> FilterBank:
    return lmmse_filters(mosaic, chart_prior(situation))


DEMOSAICING: Mapping[str, Callable[[Mosaic, Situation], FilterBank]] = {
    "bilinear": _bilinear,
    "malvar": _malvar,
    "gradient": _gradient,
    "lmmse": _lmmse,
}
"""All are linear, so their noise is predicted (`developed_color`). Malvar is for Bayer only."""
