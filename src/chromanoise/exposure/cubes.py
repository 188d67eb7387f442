"""Eq. 2 for a cube: resampling, illuminant, exposure and QE folded into one weight per band."""

import numpy as np
from jaxtyping import Float

from chromanoise.exposure.electrons import Exposure, measurement_vectors
from chromanoise.scene import Cube, Scene, light
from chromanoise.sensor import Sensor
from chromanoise.spectra import Beyond, Illuminant, interpolation_matrix

Array = np.ndarray


def band_weights(
    cube: Cube,
    illuminant: Illuminant,
    level_lux: float,
    sensor: Sensor,
    exposure: Exposure,
    *,
    beyond: Beyond = "refuse",
) -> tuple[Float[Array, "m p"], tuple[str, ...]]:
    """Electrons per unit of reflectance in each band: ``rho @ weights`` are the electrons. [e-]

    Interpolating a cube onto the grid is linear, so it is done once for the weights and never
    for the pixels.

    Returns
    -------
    weights
        One column per channel.
    notes
        How the cube was continued where it ends short of the grid.

    Raises
    ------
    InputError
        If the cube ends short of the grid and ``beyond`` is ``refuse``.
    """
    onto_grid, notes = interpolation_matrix(
        cube.wavelength_nm, sensor.grid, beyond=beyond, what=f"reflectance of {cube.source}"
    )
    white = Scene(illuminant=illuminant, level_lux=level_lux, reflectance=np.ones(sensor.grid.n))
    per_wavelength = light(white, "quanta")[:, None] * measurement_vectors(
        sensor, exposure, "quanta"
    )
    return onto_grid.T @ per_wavelength, notes
