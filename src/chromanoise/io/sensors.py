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
    """The sensor whose curves stand in a file of any format of `read_curves`.

    Parameters
    ----------
    path
        The file; the sensor takes its name without ending.
    grid
        Where the curves are wanted.
    pixel
        The pixel under them: the file does not say.
    answers
        What the user knows and the file does not say; ``beyond`` holds for the grid as well.

    Raises
    ------
    InputError
        If the file cannot be understood, a question must be answered first, a QE lies outside
        0 .. 1, or the curves end short of the grid.
    """
    path = Path(path)
    told = read_curves(path, answers=answers)
    curves = qe_of(told, answers)
    percent = Setting("scale", ("percent",))
    remedy = percent if curves.values.max() > 1 else SMALL_NEGATIVES
    return _sensor(path, curves, grid, pixel, answers.beyond, remedy=remedy)


def read_sensor_csv(
    path: Path | str, grid: Grid, pixel: Pixel, *, beyond: Beyond = "refuse"
) -> Sensor:
    """The sensor whose absolute QE per channel stands in ``wavelength_nm,R,G,...``.

    No other form is read, so nothing has to be inferred.

    Parameters
    ----------
    path
        CSV file; the sensor takes its name without ending.
    grid
        Where the curves are wanted.
    pixel
        The pixel under them: the file does not say.
    beyond
        What the curves are where the file ends short of the grid.

    Raises
    ------
    InputError
        If the file cannot be read, a QE lies outside 0 .. 1, or the curves end short.
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
    """A note where neighbors stand so far apart that straight lines between them are a guess."""
    widest = float(np.diff(curves.wavelength_nm).max())
    if widest <= _WIDE_GAP_NM:
        return ()
    return (f"QE of {curves.source}: straight lines over gaps of up to {widest:g} nm",)
