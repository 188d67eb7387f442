"""Transmittances of dyes that exist, from sensors with and without them."""

import numpy as np

from chromanoise import _check
from chromanoise.errors import InputError
from chromanoise.sensor.sensor import Sensor
from chromanoise.spectra import Spectra


def dye_transmittances(sensor: Sensor, *, white: str = "W") -> Spectra:
    """Transmittances of the dyes of a sensor: the QE of each channel over that of its bare pixel.

    Where the two come from different plots of a data sheet, a ratio can exceed 1, which no filter
    can. All dyes are then divided by the highest ratio, and a note says so: their shapes and their
    ratios are kept, their level is a guess on the low side.

    Parameters
    ----------
    sensor
        A sensor of which one channel has no dye.
    white
        The name of this channel.

    Returns
    -------
    Spectra
        One curve per other channel, named ``sensor:channel``. [1]

    Raises
    ------
    InputError
        If the sensor has no such channel, no other one, or a QE of 0 in it.

    Examples
    --------
    >>> from chromanoise.catalog import sensor_named
    >>> from chromanoise.spectra import Grid
    >>> dyes = dye_transmittances(sensor_named("model-rgbw", Grid.uniform(450, 650, 100)))
    >>> dyes.names
    ('model-rgbw:R', 'model-rgbw:G', 'model-rgbw:B')
    >>> dyes.values[1].round(2)                                               # at 550 nm
    array([0.05, 0.86, 0.04])
    """
    _check.among(f"channel of {sensor.name}", white, sensor.names)
    bare = sensor.qe[:, sensor.names.index(white)]
    others = [name for name in sensor.names if name != white]
    if not others or not bare.all():
        raise InputError(
            f"dyes of {sensor.name}",
            "must be the ratio of other channels to one whose QE is above 0 everywhere",
            value=white,
            found=f"{white} is 0 at {sensor.grid.wavelength_nm[bare.argmin()]:g} nm"
            if others
            else f"{white} is the only channel",
        )
    ratio = sensor.qe[:, [sensor.names.index(name) for name in others]] / bare[:, None]
    highest = float(ratio.max())
    note = (
        f"dyes of {sensor.name}: divided by {highest:.4g}, their highest ratio to {white}, because "
        "no filter transmits more than all light"
    )
    return Spectra(
        wavelength_nm=sensor.grid.wavelength_nm,
        values=ratio / max(highest, 1.0),
        names=tuple(f"{sensor.name}:{name}" for name in others),
        quantity="transmittance",
        unit="1",
        source=sensor.name,
        notes=(*sensor.notes, *((note,) if np.round(highest, 12) > 1 else ())),
    )
