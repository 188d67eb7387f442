"""Scenes: reflectances under an illuminant (L of eq. 2), and hyperspectral images of them.

An image is in memory or on disk.
"""

from dataclasses import replace

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    InputError,
    Remedy,
    Setting,
    Shaped,
    check,
    dataclass,
    with_short_repr,
)
from chromanoise.spectra.curves import Grid, Metric, photons_per_unit
from chromanoise.spectra.illuminants import Illuminant, photon_irradiance
from chromanoise.spectra.scene_rows import RowSource, row_source, with_bands


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """Points of known reflectance under one illuminant.

    Attributes
    ----------
    illuminant
        The illuminant, at one lux.
    level_lux
        Illuminance on the scene: N_lux in the paper. [lx]
    reflectance
        Reflectances on the illuminant's grid (last axis), for any number of points; 0 .. 1 for
        matte surfaces, above 1 for fluorescence or gloss.

    Raises
    ------
    InputError
        If the level is not positive, a reflectance is negative, or the grids differ.
    """

    illuminant: Illuminant
    level_lux: float
    reflectance: Float[Array, "*px n"]

    def __post_init__(self) -> None:
        check.positive("level_lux", "lx", self.level_lux)
        check.within("level_lux", "lx", self.level_lux, 1e-15, 1e15)
        rho = check.non_negative("reflectance of the scene", "1", self.reflectance)
        check.same_length(
            "wavelengths", illuminant=self.illuminant.grid.n, reflectance=rho.shape[-1]
        )
        check.keep(self, reflectance=rho)


def flat_field(illuminant: Illuminant, *, level_lux: float, reflectance: float = 1.0) -> Scene:
    """One point with the same reflectance at every wavelength: the test scene of the paper.

    Parameters
    ----------
    level_lux
        Illuminance on the scene. [lx]
    reflectance
        Reflectance at every wavelength. [1]
    """
    flat = np.full(illuminant.grid.n, float(reflectance))
    return Scene(illuminant=illuminant, level_lux=level_lux, reflectance=flat)


def light(scene: Scene, metric: Metric) -> Float[Array, "*px n"]:
    """The vector L of eq. 2, N_lux i(lambda) rho(lambda), in the unit of the metric.

    Parameters
    ----------
    scene
        Light from the scene.
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    """
    photons = scene.level_lux * photon_irradiance(scene.illuminant) * scene.reflectance
    if metric == "quanta":
        return photons
    return photons / photons_per_unit(scene.illuminant.grid, metric)


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Cube:
    """``h`` x ``w`` pixels with ``m`` bands.

    Attributes
    ----------
    wavelength_nm
        Centers of the bands, increasing. [nm]
    stored
        The numbers as stored, of any real type: an array, which may be a memory map, or a
        `RowSource`.
    scale
        Reflectance = stored * scale.
    source
        File or generator; used in messages and results.
    notes
        Assumptions made when the cube was read.

    Raises
    ------
    InputError
        If there are not at least two bands at increasing wavelengths, or the shapes differ.
    """

    wavelength_nm: Float[Array, " m"]
    stored: Shaped[Array, "h w m"] | RowSource
    source: str
    scale: float = 1.0
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if np.size(self.wavelength_nm) == 1:
            raise InputError(self.source, "must have at least 2 bands", value=1, found="has 1 band")
        wavelength = check.increasing(f"wavelength_nm of {self.source}", "nm", self.wavelength_nm)
        if len(self.stored.shape) != 3 or 0 in self.stored.shape:
            raise InputError(
                self.source,
                "must have axes (rows, columns, bands) and must not be empty",
                value=tuple(self.stored.shape),
                found=f"has shape {tuple(self.stored.shape)}",
            )
        if self.stored.shape[2] != wavelength.size:
            raise InputError(
                self.source,
                "must have one wavelength per band",
                value=wavelength.size,
                found=f"has {self.stored.shape[2]} bands and {wavelength.size} wavelengths",
            )
        check.positive(f"scale of {self.source}", "reflectance per stored unit", self.scale)
        check.keep(self, wavelength_nm=wavelength)


BRIGHTEST = 2.0
"""Largest accepted reflectance; larger values are probably radiance, counts or percent."""


def reflectance_rows(
    cube: Cube, start: int, stop: int, *, first_row: int = 0
) -> Float[Array, "rows w m"]:
    """Reflectances of the rows ``start`` to ``stop``, as float64.

    Error messages count rows from ``first_row``, the first row of this cube in the whole picture.

    Raises
    ------
    InputError
        If a value is NaN, negative, or above `BRIGHTEST`; the message gives the first one.
    """
    with np.errstate(invalid="ignore", over="ignore"):  # overflow is refused below
        stored = row_source(cube.stored).rows(start, stop)
        rho = np.asarray(stored, dtype=np.float64) * cube.scale
    bad = ~((rho >= 0) & (rho <= BRIGHTEST))
    if bad.any():
        row, column, band = (int(i) for i in np.argwhere(bad)[0])
        first, last = first_row + start, first_row + stop - 1
        value = float(rho[row, column, band])
        raise InputError(
            cube.source,
            f"reflectance must be 0 .. {BRIGHTEST:g}",
            where=f"row {first + row}, column {column} (from 0), {cube.wavelength_nm[band]:g} nm",
            value=value,
            found=f"is {value:g} ({int(bad.sum())} of {bad.size} values in rows "
            f"{first}-{last} are out of range)",
            remedy=_remedy(value, cube),
        )
    return rho


def _remedy(value: float, cube: Cube) -> tuple[Remedy, ...]:
    if np.isnan(value) or value < 0:
        ignored = any("data ignore value" in note for note in cube.notes)
        note = " (its header names a data ignore value, which is not applied)" if ignored else ""
        return (
            Setting("bad_pixels", ("zero",)),
            f"set pixels without a value and noise below 0 to 0, or cut them off{note}",
        )
    return ("divide radiance or counts by a white reference", Setting("scale"))


def bands_within(cube: Cube, grid: Grid) -> Cube:
    """The cube with only the bands that the grid needs, and one neighbor on each side.

    Parameters
    ----------
    cube
        The cube of reflectances or radiances.
    grid
        Wavelengths of the result.
    """
    first = int(np.searchsorted(cube.wavelength_nm, grid.start_nm, side="right")) - 1
    last = int(np.searchsorted(cube.wavelength_nm, grid.stop_nm, side="left"))
    keep, bands = slice(max(first, 0), last + 1), cube.wavelength_nm.size
    kept = len(range(*keep.indices(bands)))
    if kept == bands or kept < 2:  # without overlap, the resampling raises the error
        return cube
    return replace(
        cube, wavelength_nm=cube.wavelength_nm[keep], stored=with_bands(cube.stored, keep)
    )


def flat_cube(
    wavelength_nm: Float[Array, " m"], reflectance: float, *, height: int, width: int
) -> Cube:
    """A cube with equal pixels, for tests and noise measurements.

    Parameters
    ----------
    wavelength_nm
        Wavelengths of the bands. [nm]
    reflectance
        Reflectance at every wavelength. [1]
    height
        Rows of pixels. [px]
    width
        Columns of pixels. [px]
    """
    wavelength = np.asarray(wavelength_nm, dtype=np.float64)
    stored = np.broadcast_to(np.float64(reflectance), (height, width, wavelength.size))
    return Cube(wavelength_nm=wavelength, stored=stored, source="a flat cube")
