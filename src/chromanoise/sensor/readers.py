"""A sensor from a table of its quantum efficiencies."""

from pathlib import Path

import numpy as np

from chromanoise import _check
from chromanoise.sensor.pixel import Pixel
from chromanoise.sensor.sensor import Sensor
from chromanoise.spectra import Beyond, Grid, on_grid, read_spectra_csv


def read_sensor_csv(
    path: Path | str, grid: Grid, pixel: Pixel, *, beyond: Beyond = "refuse"
) -> Sensor:
    """The sensor whose absolute QE per channel stands in ``wavelength_nm,R,G,...``.

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
    _refuse_impossible_qe(path, curves.wavelength_nm, curves.values, curves.names)
    resampled = on_grid(curves, grid, beyond=beyond)
    return Sensor(
        name=path.stem,
        grid=grid,
        qe=resampled.values,
        names=resampled.names,
        pixel=pixel,
        notes=(f"QE read from {path.name}", *resampled.notes),
    )


def _refuse_impossible_qe(
    path: Path, wavelength_nm: np.ndarray, qe: np.ndarray, names: tuple[str, ...]
) -> None:
    bad = (qe < 0) | (qe > 1)
    if not bad.any():
        return
    row, column = (int(i) for i in np.argwhere(bad)[0])
    cure = "; divide percent by 100" if qe.max() > 1 else "; set noise below the floor to 0"
    raise _check.InputError(
        f"{path}: QE must be 0 .. 1 [e-/photon], but {int(bad.sum())} of {qe.size} values are not; "
        f"the first is {qe[row, column]:g} in column {names[column]} at "
        f"{wavelength_nm[row]:g} nm{cure}"
    )
