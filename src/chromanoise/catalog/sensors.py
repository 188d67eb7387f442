"""Sensors by name.

The four ``onyx-*`` sensors are a reconstruction consistent with the printed figures of the paper,
whose Figure 7 shows the curves of the Teledyne e2v Onyx only as a picture. They are neither a
measurement nor an independent validation.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.catalog.names import unknown_name
from chromanoise.catalog.sensor_tables import (
    CAMERA_NAMES,
    DEVICE_NAMES,
    camera_curves,
    sensor_from_table,
)
from chromanoise.errors import known_name
from chromanoise.io.spectra import ASK, Answers
from chromanoise.sensor.models import MODELS
from chromanoise.sensor.mosaic import bayer, rgbw_sparse_4x4
from chromanoise.sensor.pixel import PAPER_PIXEL
from chromanoise.sensor.sensor import Sensor, behind_filter, with_channels
from chromanoise.spectra import DEFAULT_GRID, Grid, on_grid
from chromanoise.spectra.tables import catalog_curves, catalog_tables, formulas, packaged_table

RECONSTRUCTION = (
    "curves are a reconstruction consistent with the paper's printed figures, not a measurement"
)


def onyx_rgbw(grid: Grid) -> Sensor:
    """The paper's RGBW_n: R, G, B and white without an IR-cut filter (reconstruction)."""
    curves = on_grid(packaged_table("onyx_reconstruction"), grid)
    return Sensor(
        name="onyx-rgbw",
        grid=grid,
        qe=curves.values,
        names=curves.names,
        pixel=PAPER_PIXEL,
        mosaic=rgbw_sparse_4x4(),
        origin="reconstruction",
        notes=(RECONSTRUCTION,),
    )


def onyx_rgb(grid: Grid) -> Sensor:
    """R, G and B without IR-cut: the first sensor that the paper excludes (reconstruction)."""
    return with_channels(onyx_rgbw(grid), ("R", "G", "B"), name="onyx-rgb", mosaic=bayer())


def onyx_rgbw_ircut(grid: Grid) -> Sensor:
    """RGBW behind the IR-cut: the second sensor that the paper excludes (reconstruction)."""
    return behind_filter(onyx_rgbw(grid), _onyx_ir_cut(grid), name="onyx-rgbw-ircut")


def onyx_rgb_ircut(grid: Grid) -> Sensor:
    """The paper's classical RGB sensor, behind the IR-cut (reconstruction)."""
    return behind_filter(onyx_rgb(grid), _onyx_ir_cut(grid), name="onyx-rgb-ircut")


_MAKERS: dict[str, Callable[[Grid], Sensor]] = {
    "onyx-rgbw": onyx_rgbw,
    "onyx-rgb-ircut": onyx_rgb_ircut,
    "onyx-rgb": onyx_rgb,
    "onyx-rgbw-ircut": onyx_rgbw_ircut,
    **MODELS,
}
SENSOR_NAMES = tuple(_MAKERS)
"""The paper's sensors and the models; they need no answers on any grid within 400-1050 nm."""

KNOWN_SENSORS = (*SENSOR_NAMES, *DEVICE_NAMES, *CAMERA_NAMES)
"""The names for `sensor_named`: SENSOR_NAMES, real devices, and cameras of colour-science."""


def sensor_named(
    name: str,
    grid: Grid = DEFAULT_GRID,
    *,
    answers: Answers = ASK,
    pixel: Mapping[str, float] = MappingProxyType({}),
) -> Sensor:
    """The sensor ``name`` of the catalog on ``grid``.

    Parameters
    ----------
    name
        One of `KNOWN_SENSORS`.
    grid
        The target grid.
    answers
        Metadata that the table of a real device lacks: the extrapolation, the highest QE of
        relative curves, how light was counted.
    pixel
        Values that override the sensor's, by the names of `Pixel`. [um], [e-], [e-]

    Returns
    -------
    Sensor
        Its quantum efficiencies on the grid [e-/photon] and its pixel.

    Raises
    ------
    InputError
        If the name is unknown (the message suggests similar names), or an answer is missing.

    Examples
    --------
    >>> sensor = sensor_named("mt9v024-rgbw", Grid.uniform(400, 1050, 10))
    >>> sensor.names, sensor.qe[15].round(2)                            # at 550 nm, G above W
    (('R', 'G', 'B', 'W'), array([0.05, 0.61, 0.07, 0.54]))
    """
    name = known_name(name, KNOWN_SENSORS)
    if name not in KNOWN_SENSORS:
        raise unknown_name("sensor", name, KNOWN_SENSORS)
    if name in _MAKERS:
        sensor = _MAKERS[name](grid)
        return replace(sensor, pixel=replace(sensor.pixel, **pixel))
    is_device = name in DEVICE_NAMES
    known = catalog_tables("sensor")[name] if is_device else formulas()[name]
    curves = catalog_curves(known) if is_device else camera_curves(known)
    return sensor_from_table(known, curves, grid, answers=answers, pixel=pixel)


def _onyx_ir_cut(grid: Grid) -> Float[Array, " n"]:
    return on_grid(packaged_table("onyx_ir_cut"), grid).values[:, 0]
