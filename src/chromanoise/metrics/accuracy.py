"""Color error of a sensor relative to an observer: that of the color matrix."""

from functools import lru_cache

import numpy as np

from chromanoise._check import Array, frozen
from chromanoise._shapes import Float
from chromanoise.color import ColorMatrix, balanced_cielab, cie1976_difference, ciede2000_difference
from chromanoise.exposure import Exposure, expected_electrons
from chromanoise.scene import Scene, light
from chromanoise.sensor import Sensor
from chromanoise.spectra import DEFAULT_OBSERVER, Illuminant, Spectra, chart_on, color_axes


@lru_cache(maxsize=64)  # reused for all levels of a sweep
def chart_color_error(
    sensor: Sensor,
    matrix: ColorMatrix,
    exposure: Exposure,
    illuminant: Illuminant,
    chart: Spectra | None = None,
) -> Float[Array, " k"] | None:
    """CIE 1976 color difference of each patch of a chart, without noise. [Delta E*ab]

    ``None`` where X, Y or Z of the sensor's own white is not above 0.

    Sensor and observer are each white-balanced on their own perfect white: X, Y and Z are divided
    by those of a reflectance of 1, as the white balance of a camera does.

    Parameters
    ----------
    sensor, matrix, exposure, illuminant
        The sensor with its matrix and exposure, and the lamp.
    chart
        Reflectances on the sensor's grid; ``None`` for the ColorChecker.

    Raises
    ------
    InputError
        If the sensor's grid extends beyond 400-1050 nm, the range of the chart's data.

    Notes
    -----
    CIE 015:2018, eq. 8.3-8.6 and 8.21.
    """
    lab = chart_lab(sensor, matrix, exposure, illuminant, chart)
    return None if lab is None else frozen(cie1976_difference(*lab))


def chart_ciede2000(
    sensor: Sensor,
    matrix: ColorMatrix,
    exposure: Exposure,
    illuminant: Illuminant,
    chart: Spectra | None = None,
) -> Float[Array, " k"] | None:
    """CIEDE2000 color difference of each patch of a chart, without noise. [1]

    Parameters, errors and ``None`` as `chart_color_error`.

    Parameters
    ----------
    sensor
        The sensor.
    matrix
        The color matrix. [lx/e-]
    exposure
        Time and lens.
    illuminant
        The light.
    chart
        Reflectances of the patches; those of the ColorChecker if ``None``.

    Notes
    -----
    CIE 142-2001 (ISO/CIE 11664-6), by colour-science.
    """
    lab = chart_lab(sensor, matrix, exposure, illuminant, chart)
    return None if lab is None else ciede2000_difference(*lab)


def chart_lab(
    sensor: Sensor,
    matrix: ColorMatrix,
    exposure: Exposure,
    illuminant: Illuminant,
    chart: Spectra | None = None,
) -> tuple[Float[Array, "k 3"], Float[Array, "k 3"]] | None:
    """L*, a*, b* of each patch for the observer and for the sensor, without noise.

    Parameters, errors and ``None`` as `chart_color_error`.

    Parameters
    ----------
    sensor
        The sensor.
    matrix
        The color matrix. [lx/e-]
    exposure
        Time and lens.
    illuminant
        The light.
    chart
        Reflectances of the patches; those of the ColorChecker if ``None``.
    """
    scene = _white_and_chart(illuminant, chart)
    truth = light(scene, "energy") @ color_axes(sensor.grid, "energy", matrix.observer)
    seen = expected_electrons(scene, sensor, exposure) @ matrix.matrix.T
    if not (seen[0] > 0).all():
        return None
    return balanced_cielab(truth[1:] / truth[0]), balanced_cielab(seen[1:] / seen[0])


def mean_chart_errors(
    sensor: Sensor,
    matrices: Float[Array, "k 3 p"],
    exposure: Exposure,
    illuminant: Illuminant,
    observer: str = DEFAULT_OBSERVER,
    chart: Spectra | None = None,
) -> Float[Array, " k"]:
    """Mean of `chart_color_error` for many matrices at once; NaN where it is ``None``. [Delta E*ab]

    Parameters
    ----------
    matrices
        Color matrices for that sensor and exposure. [lx/e-]
    observer
        Their observer, from `chromanoise.spectra.OBSERVERS`.
    sensor, exposure, illuminant, chart
        As `chart_color_error`.

    Raises
    ------
    InputError
        As `chart_color_error`.
    """
    scene = _white_and_chart(illuminant, chart)
    truth = light(scene, "energy") @ color_axes(sensor.grid, "energy", observer)
    seen = expected_electrons(scene, sensor, exposure) @ np.swapaxes(matrices, -1, -2)
    known = (seen[:, 0] > 0).all(axis=-1)
    white = np.where(known[:, None], seen[:, 0], 1.0)
    lab = balanced_cielab(seen[:, 1:] / white[:, None])
    errors = cie1976_difference(balanced_cielab(truth[1:] / truth[0]), lab)
    return np.where(known, errors.mean(axis=-1), np.nan)


def _white_and_chart(illuminant: Illuminant, chart: Spectra | None) -> Scene:
    grid = illuminant.grid
    reflectance = np.vstack([np.ones(grid.n), chart_on(grid, chart).values.T])
    return Scene(illuminant=illuminant, level_lux=1.0, reflectance=reflectance)
