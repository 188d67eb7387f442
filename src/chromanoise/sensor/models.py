"""Model sensors: the industry's filter sets on the same silicon, from `sensor.filters`.

All have the same silicon, resins and pixel, so that a comparison shows only the filter set.
"""

from collections.abc import Callable, Mapping

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.sensor.filters import ir_cut, layered_silicon_qe, resin_filter, silicon_qe
from chromanoise.sensor.mosaic import Mosaic, bayer, mosaic_named, rgb_ir, rgbw_sparse_4x4
from chromanoise.sensor.pixel import PAPER_PIXEL
from chromanoise.sensor.sensor import Sensor
from chromanoise.spectra import Grid

_DEPTH_UM = 4.0
_NOTE = "curves are a model of silicon, resins and an IR-cut, not a device"

_RESINS: dict[str, dict[str, float]] = {
    "R": {"low_nm": 590, "high_nm": 1000, "leak_nm": 1000, "peak": 0.92},
    "G": {"low_nm": 490, "high_nm": 590, "leak_nm": 790},
    "B": {"low_nm": 380, "high_nm": 505, "leak_nm": 800},
    "C": {"low_nm": 380, "high_nm": 595, "leak_nm": 790},
    "Y": {"low_nm": 500, "high_nm": 1000, "leak_nm": 1000, "peak": 0.94},
    "IR": {"low_nm": 820, "high_nm": 1050, "leak_nm": 1050, "peak": 0.9},
}


def _transmittance(name: str, grid: Grid) -> Float[Array, " n"]:
    """Transmittance of the resin over channel ``name``; W has no filter, M transmits B and R."""
    if name == "W":
        return np.ones(grid.n)
    if name == "M":
        blue = resin_filter(grid, **_RESINS["B"])
        red = resin_filter(grid, **_RESINS["R"])
        return np.maximum(blue, red)
    return resin_filter(grid, **_RESINS[name])


def _resin_sensor(
    name: str, channels: str | tuple[str, ...], *, cut: bool, mosaic: Mosaic | None
) -> Callable[[Grid], Sensor]:
    def made(grid: Grid) -> Sensor:
        silicon = silicon_qe(grid, depth_um=_DEPTH_UM)
        passed = silicon * ir_cut(grid) if cut else silicon
        qe = np.stack([passed * _transmittance(c, grid) for c in channels], axis=1)
        return Sensor(
            name=name,
            grid=grid,
            qe=qe,
            names=tuple(channels),
            pixel=PAPER_PIXEL,
            mosaic=mosaic,
            origin="model",
            notes=(_NOTE,),
        )

    return made


def three_layer(grid: Grid) -> Sensor:
    """Three stacked photodiodes behind an IR-cut: color by the depth at which silicon absorbs.

    The layers end at 0.4, 1.2 and 4 um; each absorbs the light that the layers above transmit.
    """
    layers = layered_silicon_qe(grid, (0.4, 1.2, 4.0))
    return Sensor(
        name="model-three-layer",
        grid=grid,
        qe=layers * ir_cut(grid)[:, None],
        names=("B", "G", "R"),
        pixel=PAPER_PIXEL,
        stacked=True,
        origin="model",
        notes=("curves are a model of stacked silicon and an IR-cut, not a device",),
    )


_CMY, _RYB, _RCCB = mosaic_named("CY/YM"), mosaic_named("RY/YB"), mosaic_named("RW/WB")

MODELS: Mapping[str, Callable[[Grid], Sensor]] = {
    "model-mono": _resin_sensor("model-mono", "W", cut=False, mosaic=None),
    "model-rgb-ircut": _resin_sensor("model-rgb-ircut", "RGB", cut=True, mosaic=bayer()),
    "model-rgb": _resin_sensor("model-rgb", "RGB", cut=False, mosaic=bayer()),
    "model-rgbw-ircut": _resin_sensor(
        "model-rgbw-ircut", "RGBW", cut=True, mosaic=rgbw_sparse_4x4()
    ),
    "model-rgbw": _resin_sensor("model-rgbw", "RGBW", cut=False, mosaic=rgbw_sparse_4x4()),
    "model-rgbwir": _resin_sensor(
        "model-rgbwir",
        ("R", "G", "B", "W", "IR"),
        cut=False,
        mosaic=mosaic_named("R W G W/W IR W IR/G W B W/W IR W IR"),
    ),
    "model-rgbir": _resin_sensor("model-rgbir", ("R", "G", "B", "IR"), cut=False, mosaic=rgb_ir()),
    "model-cmy-ircut": _resin_sensor("model-cmy-ircut", "CMY", cut=True, mosaic=_CMY),
    "model-cmy": _resin_sensor("model-cmy", "CMY", cut=False, mosaic=_CMY),
    "model-ryb-ircut": _resin_sensor("model-ryb-ircut", "RYB", cut=True, mosaic=_RYB),
    "model-ryb": _resin_sensor("model-ryb", "RYB", cut=False, mosaic=_RYB),
    "model-rccb-ircut": _resin_sensor("model-rccb-ircut", "RWB", cut=True, mosaic=_RCCB),
    "model-rccb": _resin_sensor("model-rccb", "RWB", cut=False, mosaic=_RCCB),
    "model-three-layer": three_layer,
}
"""Filter sets by name. RGBC is RGBW behind the IR-cut, with white called clear."""
