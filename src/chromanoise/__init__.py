"""From photons to color, with the noise.

The list follows the light, then the structure of the program. A package imports only packages
above it (``pyproject.toml`` lists them in reverse order).

====================  =======================================================================
``spectra``           one wavelength grid; curves, illuminants, observers, reflectances
``scene``             light from the scene: patches, charts, hyperspectral cubes
``sensor``            model of a camera: channels, filters, pixel, mosaic
``exposure``          expected electrons (eq. 1-2), exposure rules
``noise``             sources, covariance (eq. 7), propagation, Monte Carlo
``geometry``          dual basis, contravariant coordinates (eq. 3-4), angles, VIF, ellipses
``color``             matrices (eq. 6), XYZ with covariance (eq. 5), Lab, Luv, sRGB
``metrics``           SNR, its bound, loss and budget; color error, filters, speed, bits
``imaging``           a cube through the camera: kernels, mosaic, demosaicing, sampling
``denoising``         denoising with the known noise: methods, result's noise, bursts, baselines
``io``                readers and writers: spectra, cubes, pixels, matrices, tables
``characterization``  a camera's noise from its own raw frames
``catalog``           built-in sensors, filters, illuminants; the user's own folder
``analysis``          one operating point at every stage; budgets, sweeps, comparison
``study``             a study: document, errors, run, records
``design``            search over filters, exposure and matrix for the best sensors
``paper``             the paper's study, Tables 2-5 and figures, computed with the public API
``charts``            results as chart records: marks, axes, table rows
``figures``           chart records drawn on matplotlib Axes
``report``            a study as one self-contained HTML file
``page``              the local web page, which updates while a slider moves
``cli``               command line: options to a study, results to text
``api``               the functions of ``import chromanoise as cn``
====================  =======================================================================

Equation numbers are those of Clouet, Vaillant & Alleysson, "Physical noise propagation in
color image construction: a geometrical interpretation", CIC27 (2019).
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise import (
        analysis,
        catalog,
        characterization,
        charts,
        color,
        denoising,
        design,
        exposure,
        figures,
        geometry,
        imaging,
        io,
        metrics,
        noise,
        paper,
        scene,
        sensor,
        spectra,
        study,
    )
    from chromanoise.api import (
        analyze,
        compare,
        compare_map,
        denoise,
        matrix,
        optimize,
        render,
        run,
        sensitivity,
    )
    from chromanoise.catalog import sensor_named
    from chromanoise.characterization import Characterization, characterize
    from chromanoise.color import ColorMatrix
    from chromanoise.design import Design, Sensitivity
    from chromanoise.errors import InputError, Setting
    from chromanoise.exposure import Exposure, OperatingPoint
    from chromanoise.io.cubes import read_cube
    from chromanoise.io.spectra import read_curves
    from chromanoise.noise import Measurement
    from chromanoise.scene import Cube, Scene
    from chromanoise.sensor import Mosaic, Pixel, Sensor
    from chromanoise.spectra import Grid, Illuminant, Spectra, illuminant_named
    from chromanoise.study import (
        Analyses,
        Comparison,
        ComparisonMap,
        DenoisedPicture,
        Matrices,
        MatrixResult,
        Pictures,
        Results,
        Study,
        read_study,
        study_from_data,
    )

try:
    from chromanoise._version import version as _version
except ImportError:  # a source tree that was never installed
    _version = "0+unknown"
__version__: str = _version

__all__ = [
    "Analyses",
    "Characterization",
    "ColorMatrix",
    "Comparison",
    "ComparisonMap",
    "Cube",
    "DenoisedPicture",
    "Design",
    "Exposure",
    "Grid",
    "Illuminant",
    "InputError",
    "Matrices",
    "MatrixResult",
    "Measurement",
    "Mosaic",
    "OperatingPoint",
    "Pictures",
    "Pixel",
    "Results",
    "Scene",
    "Sensitivity",
    "Sensor",
    "Setting",
    "Spectra",
    "Study",
    "analysis",
    "analyze",
    "catalog",
    "characterization",
    "characterize",
    "charts",
    "color",
    "compare",
    "compare_map",
    "denoise",
    "denoising",
    "design",
    "exposure",
    "figures",
    "geometry",
    "illuminant_named",
    "imaging",
    "io",
    "matrix",
    "metrics",
    "noise",
    "optimize",
    "paper",
    "read_cube",
    "read_curves",
    "read_study",
    "render",
    "run",
    "scene",
    "sensitivity",
    "sensor",
    "sensor_named",
    "spectra",
    "study",
    "study_from_data",
]
__getattr__ = lazy_names(__name__)[0]


def __dir__() -> list[str]:
    """The public names and subpackages, without the names imported for internal use."""
    return sorted([*__all__, "__version__"])
