"""Demosaicing methods by name, built for one operating point."""

from collections.abc import Callable, Mapping

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.exposure import OperatingPoint, expected_electrons
from chromanoise.imaging.demosaic import FilterBank, bilinear_filters, malvar_filters
from chromanoise.imaging.demosaic_priors import (
    PicturePrior,
    gradient_corrected_filters,
    lmmse_filters,
    picture_prior,
)
from chromanoise.noise import mean_noise_covariance
from chromanoise.scene import Scene
from chromanoise.sensor import Mosaic
from chromanoise.spectra import colorchecker


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


def _bilinear(mosaic: Mosaic, operating_point: OperatingPoint) -> FilterBank:
    return bilinear_filters(mosaic, operating_point.sensor.names)


def _malvar(mosaic: Mosaic, operating_point: OperatingPoint) -> FilterBank:
    return malvar_filters(mosaic, operating_point.sensor.names)


def _gradient(mosaic: Mosaic, operating_point: OperatingPoint) -> FilterBank:
    return gradient_corrected_filters(
        mosaic, operating_point.sensor.names, chart_prior(operating_point)
    )


def _lmmse(mosaic: Mosaic, operating_point: OperatingPoint) -> FilterBank:
    return lmmse_filters(mosaic, chart_prior(operating_point))


DEMOSAICING: Mapping[str, Callable[[Mosaic, OperatingPoint], FilterBank]] = {
    "bilinear": _bilinear,
    "malvar": _malvar,
    "gradient": _gradient,
    "lmmse": _lmmse,
}
"""All are linear, so their noise is predicted (`developed_color`). Malvar is for Bayer only."""
