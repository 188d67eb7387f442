"""A hyperspectral image of reflectances, in memory or on disk."""

from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import (
    Float,
    Shaped,
)
from chromanoise.errors import (
    InputError,
    Remedy,
    Setting,
)
from chromanoise.scene.rows import RowSource, row_source, with_bands
from chromanoise.spectra import Grid


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        wavelength = _check.increasing(f"wavelength_nm of {self.source}", "nm", self.wavelength_nm)
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
        _check.positive(f"scale of {self.source}", "reflectance per stored unit", self.scale)
        object.__setattr__(self, "wavelength_nm", _check.frozen(wavelength))


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
    keep = slice(max(first, 0), last + 1)
    if cube.wavelength_nm[keep].size < 2:
        return cube  # no overlap: the resampling raises the error
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
        Number of rows.
    width
        Number of columns.
    """
    wavelength = np.asarray(wavelength_nm, dtype=np.float64)
    stored = np.broadcast_to(np.float64(reflectance), (height, width, wavelength.size))
    return Cube(wavelength_nm=wavelength, stored=stored, source="a flat cube")
