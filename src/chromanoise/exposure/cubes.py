"""Eq. 2 for a cube: resampling, illuminant, exposure and QE as one weight per band."""

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.exposure.electrons import Exposure, measurement_vectors, refuse_other_grid
from chromanoise.scene import Cube, Scene, light
from chromanoise.sensor import Sensor
from chromanoise.spectra import Beyond, interpolation_matrix


def band_weights(
    cube: Cube, white: Scene, sensor: Sensor, exposure: Exposure, *, beyond: Beyond = "refuse"
) -> tuple[Float[Array, "m p"], tuple[str, ...]]:
    """Electrons per unit of reflectance in each band; ``rho @ weights`` gives electrons. [e-]

    Interpolation of a cube onto the grid is linear, so it is applied once to the weights instead
    of to each pixel.

    Parameters
    ----------
    cube
        Only its wavelengths are used.
    white
        A perfect white (`flat_field`) under the illuminant of the cube.
    sensor, exposure
        The sensor and its exposure.
    beyond
        How to extrapolate reflectances where the cube does not cover the grid.

    Returns
    -------
    weights
        One column per channel.
    notes
        How the cube was extrapolated where it does not cover the grid.

    Raises
    ------
    InputError
        If the cube does not cover the grid and ``beyond`` is ``refuse``, or scene and sensor are
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
