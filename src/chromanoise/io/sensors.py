"""A sensor from a table of its quantum efficiencies."""

from pathlib import Path

import numpy as np

from chromanoise.errors import Remedy, Setting
from chromanoise.io.spectra import ASK, Answers, qe_of, read_curves
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


def read_sensor(path: Path | str, grid: Grid, pixel: Pixel, *, answers: Answers = ASK) -> Sensor:
    """Read a sensor from a file of curves in any format of `read_curves`.

    Parameters
    ----------
    path
        The file; its name without the suffix becomes the name of the sensor.
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
    path = Path(path)
    parsed = read_curves(path, answers=answers)
    curves = qe_of(parsed, answers)
    percent = Setting("scale", ("percent",))
    remedy = percent if curves.values.max() > 1 else SMALL_NEGATIVES
    return _sensor(path, curves, grid, pixel, answers.beyond, remedy=remedy)


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
    return _sensor(path, curves, grid, pixel, beyond, remedy=remedy)


def _sensor(
    path: Path,
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
        name=path.stem,
        grid=grid,
        qe=resampled.values,
        names=resampled.names,
        pixel=pixel,
        notes=(f"QE read from {path.name}", *resampled.notes, *_gaps(curves)),
    )


def _gaps(curves: Spectra) -> tuple[str, ...]:
    """A note if neighboring samples are so far apart that linear interpolation is uncertain."""
    widest = float(np.diff(curves.wavelength_nm).max())
    if widest <= _WIDE_GAP_NM:
        return ()
    return (f"QE of {curves.source}: straight lines over gaps of up to {widest:g} nm",)
