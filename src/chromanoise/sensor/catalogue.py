"""Sensors by name.

The four ``onyx-*`` sensors are a reconstruction consistent with the figures that the paper
prints: its Figure 7 shows the curves of the Teledyne e2v Onyx as a picture only. They are
neither a measurement nor an independent validation.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.sensor.filters import ir_cut, resin_filter, silicon_qe
from chromanoise.sensor.mosaic import bayer, rgbw_sparse_4x4
from chromanoise.sensor.pixel import Pixel
from chromanoise.sensor.sensor import Sensor, behind_filter, with_channels
from chromanoise.spectra import Grid, on_grid
from chromanoise.spectra.tables import packaged_table

PAPER_PIXEL = Pixel(pitch_um=10.0, full_well_e=10_000.0, read_noise_e=10.0)
"""Table 1 of the paper."""

RECONSTRUCTION = (
    "curves are a reconstruction consistent with the paper's printed figures, not a measurement"
)


def onyx_rgbw(grid: Grid) -> Sensor:
    """The paper's RGBW_n: R, G, B and white on bare silicon, no IR-cut (reconstruction)."""
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
    """R, G and B without IR-cut: the first sensor that the paper sets aside (reconstruction)."""
    return with_channels(onyx_rgbw(grid), ("R", "G", "B"), name="onyx-rgb", mosaic=bayer())


def onyx_rgbw_ircut(grid: Grid) -> Sensor:
    """RGBW behind the IR-cut: the second sensor that the paper sets aside (reconstruction)."""
    return behind_filter(onyx_rgbw(grid), _onyx_ir_cut(grid), name="onyx-rgbw-ircut")


def onyx_rgb_ircut(grid: Grid) -> Sensor:
    """The paper's classical RGB sensor, behind the IR-cut (reconstruction)."""
    return behind_filter(onyx_rgb(grid), _onyx_ir_cut(grid), name="onyx-rgb-ircut")


def model_rgb_ircut(grid: Grid) -> Sensor:
    """A generic RGB sensor: silicon, three resins, IR-cut, all from `sensor.filters`."""
    silicon = silicon_qe(grid, depth_um=4.0)
    red = resin_filter(grid, low_nm=590, high_nm=1000, leak_nm=1000, peak=0.92)
    green = resin_filter(grid, low_nm=490, high_nm=590, leak_nm=790)
    blue = resin_filter(grid, low_nm=380, high_nm=505, leak_nm=800)
    cut = ir_cut(grid)
    return Sensor(
        name="model-rgb-ircut",
        grid=grid,
        qe=(silicon * cut)[:, None] * _columns(red, green, blue),
        names=("R", "G", "B"),
        pixel=PAPER_PIXEL,
        mosaic=bayer(),
        origin="model",
        notes=("curves are a model of silicon, resins and an IR-cut, not a device",),
    )


def model_mono(grid: Grid) -> Sensor:
    """A generic monochrome sensor: bare silicon."""
    return Sensor(
        name="model-mono",
        grid=grid,
        qe=_columns(silicon_qe(grid, depth_um=4.0)),
        names=("W",),
        pixel=PAPER_PIXEL,
        origin="model",
        notes=("the curve is a model of silicon, not a device",),
    )


_MAKERS: dict[str, Callable[[Grid], Sensor]] = {
    "onyx-rgbw": onyx_rgbw,
    "onyx-rgb-ircut": onyx_rgb_ircut,
    "onyx-rgb": onyx_rgb,
    "onyx-rgbw-ircut": onyx_rgbw_ircut,
    "model-rgb-ircut": model_rgb_ircut,
    "model-mono": model_mono,
}
SENSOR_NAMES = tuple(_MAKERS)
"""What `sensor_named` knows."""


def sensor_named(name: str, grid: Grid) -> Sensor:
    """The catalogue's sensor ``name`` on ``grid``.

    Raises
    ------
    InputError
        If nothing is called that; the nearest names are told.
    """
    _check.one_of("sensor", name, SENSOR_NAMES)
    return _MAKERS[name](grid)


def _onyx_ir_cut(grid: Grid) -> Float[Array, " n"]:
    return on_grid(packaged_table("onyx_ir_cut"), grid).values[:, 0]


def _columns(*curves: Float[Array, " n"]) -> Float[Array, "n p"]:
    return np.stack(curves, axis=1)
