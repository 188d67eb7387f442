"""Curves -> the paper's printed figures, by chromanoise itself.

The leaner twin of `chromanoise.study.paper_study`: the same functions in the same order, without
what the paper does not print, because a fit asks some 20,000 times.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float

from chromanoise.apps.paper import printed_numbers as paper
from chromanoise.base.check import Array
from chromanoise.color import colored, kernel_matrix
from chromanoise.geometry import DualBasis, angles_to_axes_deg, contravariant
from chromanoise.metrics import snr_db
from chromanoise.noise import (
    Exposure,
    Measurement,
    expected_electrons,
    saturating_exposure,
    with_noise,
)
from chromanoise.sensor import PAPER_PIXEL, Sensor, behind_filter, with_channels
from chromanoise.spectra import Metric, Scene, color_axes, equal_energy, flat_field
from onyx_reconstruction.curves import GRID, RGB, Curves, ir_cut, rgbw_qe

METRIC: Metric = "quanta"


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedSnr:
    """One SNR of Tables 2-4: where it stands and what is printed. [dB]"""

    column: str
    kind: str
    coordinate: str
    db: float


def _printed_snrs() -> tuple[PrintedSnr, ...]:
    tables = {
        "raw": paper.PRINTED_RAW_SNR_DB,
        "XYZ": {"Y": paper.PRINTED_SNR_Y_DB},
        "contravariant": paper.PRINTED_CONTRAVARIANT_SNR_DB,
    }
    return tuple(
        PrintedSnr(column=column, kind=kind, coordinate=coordinate, db=db)
        for kind, table in tables.items()
        for coordinate, row in table.items()
        for column, db in row.items()
    )


PRINTED_SNRS = _printed_snrs()
PRINTED_ANGLES_DEG = paper.PRINTED_ANGLE_DEG
PRINTED_TIMES_MS = paper.PRINTED_TIMES_MS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prediction:
    """What the paper would have printed for some curves.

    Attributes
    ----------
    columns
        Column of Tables 2-4 -> kind of coordinates -> measurement.
    angles_deg
        Column of Table 5 -> angle between its green channel and y. [deg]
    times_ms
        Sensor -> the time that fills its most sensitive channel. [ms]
    """

    columns: dict[str, dict[str, Measurement]]
    angles_deg: dict[str, float]
    times_ms: dict[str, float]


def predicted(curves: Curves) -> Prediction:
    """Every published figure, in closed form."""
    rgbw, rgb = sensors(curves)
    bare, cut = (
        saturating_exposure(_scene(), sensor, f_number=paper.F_NUMBER, share=paper.WELL_SHARE)
        for sensor in (rgbw, rgb)
    )
    rgbw_12, rgbw_frame = _column(rgbw, bare)
    rgb_12, _ = _column(rgb, bare)
    rgb_59, rgb_frame = _column(rgb, cut)
    return Prediction(
        columns={paper.RGBW_12: rgbw_12, paper.RGB_12: rgb_12, paper.RGB_59: rgb_59},
        angles_deg={paper.G_N: _green_to_y_deg(rgbw_frame), paper.G: _green_to_y_deg(rgb_frame)},
        times_ms={s.name: 1e3 * e.time_s for s, e in ((rgbw, bare), (rgb, cut))},
    )


def sensors(curves: Curves) -> tuple[Sensor, Sensor]:
    """RGBW without IR-cut, and RGB behind it."""
    rgbw = Sensor(
        name="onyx-rgbw",
        grid=GRID,
        qe=rgbw_qe(curves),
        names=(*RGB, "W"),
        pixel=PAPER_PIXEL,
    )
    rgb = behind_filter(
        with_channels(rgbw, RGB, name="onyx-rgb"), ir_cut(curves), name="onyx-rgb-ircut"
    )
    return rgbw, rgb


def snrs_db(prediction: Prediction) -> Float[Array, " k"]:
    """Ours, in the order of `PRINTED_SNRS`. [dB]"""
    ours = {
        (column, kind): snr_db(measurement)
        for column, kinds in prediction.columns.items()
        for kind, measurement in kinds.items()
    }
    return np.array([float(ours[p.column, p.kind][p.coordinate]) for p in PRINTED_SNRS])


def signed_snr(prediction: Prediction, printed: PrintedSnr) -> float:
    """Mean over standard deviation of the coordinate of ``printed``, with its sign."""
    measurement = prediction.columns[printed.column][printed.kind]
    i = measurement.names.index(printed.coordinate)
    return float(measurement.mean[i] / np.sqrt(measurement.variance[i]))


def _column(sensor: Sensor, exposure: Exposure) -> tuple[dict[str, Measurement], DualBasis]:
    raw = with_noise(expected_electrons(_scene(), sensor, exposure), sensor)
    matrix = kernel_matrix(sensor, exposure, METRIC)
    stages = (raw, contravariant(raw, matrix.frame), colored(raw, matrix))
    return {measurement.kind: measurement for measurement in stages}, matrix.frame


def _green_to_y_deg(frame: DualBasis) -> float:
    return float(angles_to_axes_deg(frame, _y_axis())[frame.names.index("G"), 0])


@cache
def _scene() -> Scene:
    return flat_field(equal_energy(GRID), level_lux=paper.LEVEL_LUX)


@cache
def _y_axis() -> Float[Array, "n 1"]:
    return color_axes(GRID, METRIC)[:, 1:2]
