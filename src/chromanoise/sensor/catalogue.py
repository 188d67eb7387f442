"""Sensors by name.

The four ``onyx-*`` sensors are a reconstruction consistent with the figures that the paper
prints: its Figure 7 shows the curves of the Teledyne e2v Onyx as a picture only. They are
neither a measurement nor an independent validation.
"""

from collections.abc import Callable

from jaxtyping import Float

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.sensor.models import MODELS
from chromanoise.sensor.mosaic import bayer, rgbw_sparse_4x4
from chromanoise.sensor.pixel import PAPER_PIXEL
from chromanoise.sensor.sensor import Sensor, behind_filter, with_channels
from chromanoise.spectra import Grid, on_grid
from chromanoise.spectra.tables import packaged_table

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


_MAKERS: dict[str, Callable[[Grid], Sensor]] = {
    "onyx-rgbw": onyx_rgbw,
    "onyx-rgb-ircut": onyx_rgb_ircut,
    "onyx-rgb": onyx_rgb,
    "onyx-rgbw-ircut": onyx_rgbw_ircut,
    **MODELS,
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
