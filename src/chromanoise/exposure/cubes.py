"""Eq. 2 for a cube: resampling, illuminant, exposure and QE folded into one weight per band."""

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.exposure.electrons import Exposure, measurement_vectors, refuse_other_grid
from chromanoise.scene import Cube, Scene, light
from chromanoise.sensor import Sensor
from chromanoise.spectra import Beyond, interpolation_matrix


def band_weights(
    cube: Cube, white: Scene, sensor: Sensor, exposure: Exposure, *, beyond: Beyond = "refuse"
) -> tuple[Float[Array, "m p"], tuple[str, ...]]:
    """Electrons per unit of reflectance in each band: ``rho @ weights`` are the electrons. [e-]

    Interpolating a cube onto the grid is linear, so it is done once for the weights and never
    for the pixels.

    Parameters
    ----------
    cube
        Only its wavelengths are asked.
    white
        A perfect white (`flat_field`) in the light that falls on the cube.
    sensor, exposure
        What looks at it, and how.
    beyond
        What the reflectances are where the cube ends short of the grid.

    Returns
    -------
    weights
        One column per channel.
    notes
        How the cube was continued where it ends short of the grid.

    Raises
    ------
    InputError
        If the cube ends short of the grid and ``beyond`` is ``refuse``, or scene and sensor are
        on different grids.
    """
    refuse_other_grid(white, sensor)
    onto_grid, notes = interpolation_matrix(
        cube.wavelength_nm, sensor.grid, beyond=beyond, what=f"reflectance of {cube.source}"
    )
    per_wavelength = light(white, "quanta")[:, None] * measurement_vectors(
        sensor, exposure, "quanta"
    )
    return onto_grid.T @ per_wavelength, notes
