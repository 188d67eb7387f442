"""From photons to color, with the noise.

Packages, lowest layer first: shared tools, the stages along the light path, the interfaces. A
package imports only packages listed before it, and only what their ``__init__`` names
(``pyproject.toml`` lists them in reverse order).

============  ===================================================================================
``base``      errors, records, files, bounds, linear solvers: shared tools, no physics
``spectra``   one wavelength grid; curves, illuminants, observers, reflectances; scenes and cubes
``sensor``    model of a camera: channels, filters, pixel, mosaic
``noise``     expected electrons (eq. 1-2), exposure; sources, covariance (eq. 7), Monte Carlo
``geometry``  dual basis, contravariant coordinates (eq. 3-4), angles, VIF, ellipses
``color``     matrices (eq. 6), XYZ with covariance (eq. 5), Lab, Luv, sRGB
``metrics``   SNR, its bound, loss and budget; color error, filters, speed, bits
``imaging``   a cube through the camera: kernels, mosaic, demosaicing, sampling, denoising
``io``        readers and writers: spectra, cubes, frames, pixels, matrices, tables
``study``     a study: document, built-in and own sensors, analysis, sweeps, run, records
``charts``    results as charts: marks, axes, rows of tables; drawn on matplotlib Axes
``apps``      users of the library, not yet stable: camera, design, training, paper
``web``       a study as a report in one HTML file; the local page
``cli``       command line: options to a study, results to text
``api``       the functions of ``import chromanoise as cn``
============  ===================================================================================

Equation numbers are those of Clouet, Vaillant & Alleysson, "Physical noise propagation in
color image construction: a geometrical interpretation", CIC27 (2019).
"""

import sys
from typing import TYPE_CHECKING

from chromanoise.base import MovedPackages, __version__, lazy_names, register_above

if TYPE_CHECKING:
    from chromanoise import (
        apps as apps,
        charts as charts,
        color as color,
        geometry as geometry,
        imaging as imaging,
        io as io,
        metrics as metrics,
        noise as noise,
        sensor as sensor,
        spectra as spectra,
        study as study,
    )
    from chromanoise.api import (
        analyze as analyze,
        card as card,
        compare as compare,
        compare_map as compare_map,
        denoise as denoise,
        league as league,
        matrix as matrix,
        optimize as optimize,
        render as render,
        run as run,
        sensitivity as sensitivity,
    )
    from chromanoise.apps.camera import (
        Characterization as Characterization,
        characterize as characterize,
    )
    from chromanoise.apps.design import Design as Design, Sensitivity as Sensitivity
    from chromanoise.base import InputError as InputError, Setting as Setting
    from chromanoise.color import ColorMatrix as ColorMatrix
    from chromanoise.io import read_curves as read_curves
    from chromanoise.io.cubes import read_cube as read_cube
    from chromanoise.noise import (
        Exposure as Exposure,
        Measurement as Measurement,
        OperatingPoint as OperatingPoint,
    )
    from chromanoise.sensor import Mosaic as Mosaic, Pixel as Pixel, Sensor as Sensor
    from chromanoise.spectra import (
        Cube as Cube,
        Grid as Grid,
        Illuminant as Illuminant,
        Scene as Scene,
        Spectra as Spectra,
        illuminant_named as illuminant_named,
    )
    from chromanoise.study import (
        Analyses as Analyses,
        Comparison as Comparison,
        ComparisonMap as ComparisonMap,
        DenoisedPicture as DenoisedPicture,
        League as League,
        Matrices as Matrices,
        MatrixResult as MatrixResult,
        Pictures as Pictures,
        Results as Results,
        Study as Study,
        read_study as read_study,
        sensor_named as sensor_named,
        study_from_data as study_from_data,
    )

sys.meta_path.insert(0, MovedPackages())
register_above(
    figures="chromanoise.charts",
    camera="chromanoise.apps.camera",
    design="chromanoise.apps.design",
    saved_files="chromanoise.web.saved_files",  # with Matplotlib, which no other answer needs
)

__getattr__, _, __all__ = lazy_names(__name__)


def __dir__() -> list[str]:
    """The public names and subpackages, without the names imported for internal use."""
    return sorted([*__all__, "__version__"])
