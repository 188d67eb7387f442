"""A sensor from a table of its quantum efficiencies."""

from pathlib import Path

import numpy as np

from chromanoise.errors import Remedy, Setting
from chromanoise.io.spectra import ASK, Answers, qe_of, read_curves
from chromanoise.io.spectra.parsed import Found
from chromanoise.sensor.pixel import Pixel
from chromanoise.sensor.sensor import Sensor
from chromanoise.spectra import (
    SMALL_NEGATIVES,
    Beyond,
    Grid,
    Spectra,
    means_on_grid,
    read_spectra_csv,
    refuse_outside,
    used_on_grid,
)

_WIDE_GAP_NM = 30.0


def read_sensor(
    path: Path | str | Found, grid: Grid, pixel: Pixel, *, answers: Answers = ASK
) -> Sensor:
    """Read a sensor from a file of curves in any format of `read_curves`, or from curves in memory.

    Parameters
    ----------
    path
        The file; its name without the suffix becomes the name of the sensor. Curves in memory give
        their source as the name.
    grid
        The target grid.
    pixel
        The pixel of the sensor, which the file does not contain.
    answers
        Metadata that the file lacks; ``beyond`` also applies to the grid.

    Raises
    ------
    InputError
        If the file cannot be parsed, required metadata is missing, a QE lies outside 0 .. 1, or
        the curves do not cover the grid.
    """
    parsed = read_curves(path, answers=answers)
    curves = qe_of(parsed, answers)
    percent = Setting("scale", ("percent",))
    remedy = percent if curves.values.max() > 1 else SMALL_NEGATIVES
    named = (path.source, path.source) if isinstance(path, Found) else _names(Path(path))
    return _sensor(named, curves, grid, pixel, answers.beyond, remedy=remedy)


def read_sensor_csv(
    path: Path | str, grid: Grid, pixel: Pixel, *, beyond: Beyond = "refuse"
) -> Sensor:
    """Read a sensor from absolute QE per channel in a CSV ``wavelength_nm,R,G,...``.

    No other form is accepted, so nothing is inferred.

    Parameters
    ----------
    path
        The CSV file; its name without the suffix becomes the name of the sensor.
    grid
        The target grid.
    pixel
        The pixel of the sensor, which the file does not contain.
    beyond
        How to extrapolate curves that do not cover the grid.

    Raises
    ------
    InputError
        If the file cannot be read, a QE lies outside 0 .. 1, or the curves do not cover the grid.
    """
    path = Path(path)
    curves = read_spectra_csv(path, quantity="QE", unit="e-/photon")
    remedy = "divide percent by 100" if curves.values.max() > 1 else SMALL_NEGATIVES
    return _sensor(_names(path), curves, grid, pixel, beyond, remedy=remedy)


def _names(path: Path) -> tuple[str, str]:
    """Names of the sensor and of its file."""
    return path.stem, path.name


def _sensor(
    named: tuple[str, str],
    curves: Spectra,
    grid: Grid,
    pixel: Pixel,
    beyond: Beyond,
    *,
    remedy: Remedy,
) -> Sensor:
    used = used_on_grid(curves.wavelength_nm, grid)
    refuse_outside(curves, high=1.0, remedy=remedy, used=used)
    resampled = means_on_grid(curves, grid, beyond=beyond)
    return Sensor(
        name=named[0],
        grid=grid,
        qe=resampled.values,
        names=resampled.names,
        pixel=pixel,
        notes=(f"QE read from {named[1]}", *resampled.notes, *_gaps(curves)),
    )


def _gaps(curves: Spectra) -> tuple[str, ...]:
    """A note if neighboring samples are so far apart that linear interpolation is uncertain."""
    widest = float(np.diff(curves.wavelength_nm).max())
    if widest <= _WIDE_GAP_NM:
        return ()
    return (f"QE of {curves.source}: straight lines over gaps of up to {widest:g} nm",)
