"""Changes to a sensor's curves: an added IR-cut filter, or a shift in wavelength."""

from dataclasses import replace

import numpy as np

from chromanoise import _check
from chromanoise.sensor.filters import ir_cut
from chromanoise.sensor.sensor import Sensor

MOST_SHIFT_NM = 200.0
LOWEST_EDGE_NM, HIGHEST_EDGE_NM = 450.0, 2000.0


def behind_ir_cut(sensor: Sensor, edge_nm: float, *, noted: bool = True) -> Sensor:
    """The sensor behind a model IR-cut, in addition to any IR-cut that it already has.

    Parameters
    ----------
    sensor
        Any sensor.
    edge_nm
        Wavelength of half transmittance; from 450 to 2000. [nm]
    noted
        Whether a note on the added IR-cut is added.

    Raises
    ------
    InputError
        If the edge is outside this range.
    """
    low, high = LOWEST_EDGE_NM, HIGHEST_EDGE_NM
    edge = _check.within("edge_nm", "nm", edge_nm, low, high)
    note = (f"behind an added model IR-cut at {edge:g} nm",) if noted else ()
    qe = sensor.qe * ir_cut(sensor.grid, edge_nm=edge)[:, None]
    return replace(sensor, qe=qe, notes=(*sensor.notes, *note))


def with_shifted_curves(sensor: Sensor, shift_nm: float) -> Sensor:
    """The sensor with all of its curves shifted in wavelength.

    QE(λ) becomes QE(λ - shift), interpolated linearly on the grid. At the end from which the curves
    move away, the end value is repeated because no data exist there, and a note reports this. At
    the other end, values that move off the grid are dropped.

    Parameters
    ----------
    sensor
        Any sensor.
    shift_nm
        Positive toward longer wavelengths; 0 returns the sensor itself. [nm]

    Raises
    ------
    InputError
        If the shift is not finite, or is larger than 200 nm in either direction.

    Examples
    --------
    >>> from chromanoise.sensor.pixel import PAPER_PIXEL
    >>> from chromanoise.spectra import Grid
    >>> steps = np.array([[0.1], [0.5], [0.2]])
    >>> one = Sensor(name="one", grid=Grid.uniform(500, 520, 10), qe=steps, names=("G",),
    ...              pixel=PAPER_PIXEL)
    >>> with_shifted_curves(one, 5.0).qe[:, 0]
    array([0.1 , 0.3 , 0.35])
    """
    shift = _check.within("shift_nm", "nm", shift_nm, -MOST_SHIFT_NM, MOST_SHIFT_NM)
    if shift == 0:
        return sensor
    at, grid = sensor.grid.wavelength_nm, sensor.grid
    qe = np.stack([np.interp(at - shift, at, curve) for curve in sensor.qe.T], axis=1)
    unknown = (grid.start_nm, min(grid.start_nm + shift, grid.stop_nm))
    if shift < 0:
        unknown = (max(grid.stop_nm + shift, grid.start_nm), grid.stop_nm)
    note = (
        f"curves shifted by {shift:+g} nm; from {unknown[0]:g} to {unknown[1]:g} nm, where no data "
        "exist, the end value is repeated"
    )
    return replace(sensor, qe=qe, notes=(*sensor.notes, note))
