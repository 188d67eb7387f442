"""Color error and noise of every patch of a chart, measured by one sensor."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.analysis.analysis import Analysis, color_snr_db, of_white
from chromanoise.analysis.operating_point import noisy_color_at, stages_at
from chromanoise.analysis.undefined import defined
from chromanoise.color import (
    FIRST_ORDER_TOLERANCE,
    LAB,
    UNBOUNDED,
    ColorNoise,
    exact,
    first_order,
    propagate,
    relative_sd_error,
)
from chromanoise.metrics import chart_ciede2000, chart_color_error, signal_snr_db
from chromanoise.noise import Readout, demand_independent_channels
from chromanoise.spectra import chart_on

_POINTS = 2**13  # per patch: standard deviations are accurate to 0.05 %


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChartNoise:
    """Color error and noise of each patch, with the light and exposure of an analysis.

    Attributes
    ----------
    names
        Names of the patches.
    color_error, ciede2000
        Color errors without noise, CIE 1976 and CIEDE2000. [Delta E]
    snr_y_db
        SNR of Y; NaN where Y has no signal. [dB]
    noise
        Noise in CIELAB, relative to the sensor's own white, from the exact Poisson-Gaussian
        distribution.
    first_order_holds
        Whether every first-order standard deviation is within 5 % of the exact one.
    """

    names: tuple[str, ...]
    color_error: Float[Array, " k"]
    ciede2000: Float[Array, " k"]
    snr_y_db: Float[Array, " k"]
    noise: ColorNoise
    first_order_holds: Bool[Array, " k"]

    def __post_init__(self) -> None:
        _check.freeze(self, "color_error", "ciede2000", "snr_y_db", "first_order_holds")


def chart_noise(analysis: Analysis, *, readout: Readout = UNBOUNDED) -> ChartNoise | None:
    """Color error and noise of the chart under the light of the analysis.

    ``None`` where a channel is saturated on the white, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    analysis
        The analysis, with its chart; ``None`` there is the ColorChecker.
    readout
        Clipping and rounding of the values; none by default.

    Raises
    ------
    InputError
        If the grid extends beyond 400-1050 nm, the range of the chart's data, or crosstalk after
        counting correlates the channels.
    """
    sensor, exposure, matrix = analysis.sensor, analysis.exposure, analysis.matrix
    lamp, white = analysis.scene.illuminant, of_white(analysis)
    errors = chart_color_error(sensor, matrix, exposure, lamp, analysis.chart)
    newer = chart_ciede2000(sensor, matrix, exposure, lamp, analysis.chart)
    no_color = None in color_snr_db(white).values()
    if no_color or errors is None or newer is None:
        return None
    demand_independent_channels(sensor)
    chart = chart_on(sensor.grid, analysis.chart)
    at = stages_at(analysis.point, matrix, reflectance=chart.values.T, readout=readout)
    color = noisy_color_at(at, matrix.matrix @ white.expected_e)
    noise = propagate(color, LAB, partial(exact, points=_POINTS))
    rough = propagate(color, LAB, first_order)
    error = np.abs(relative_sd_error(rough.measurement, noise.measurement))
    return ChartNoise(
        names=chart.names,
        color_error=errors,
        ciede2000=newer,
        snr_y_db=np.where(
            at.one_code.any(axis=-1), np.nan, signal_snr_db(at.color, at.truth_xyz)[:, 1]
        ),
        noise=noise,
        first_order_holds=(error <= FIRST_ORDER_TOLERANCE).all(axis=-1),
    )


def chart_as_json(chart: ChartNoise | None) -> list[dict[str, Any]] | None:
    """One entry per patch; undefined values are ``None``.

    Parameters
    ----------
    chart
        Color error and noise of each patch; ``None`` gives an empty list.
    """
    if chart is None:
        return None
    noise = chart.noise
    sd = noise.sd
    assert noise.chroma_sd is not None  # CIELAB defines both
    assert noise.delta_e is not None
    return [
        {
            "patch": name,
            "color_error": float(chart.color_error[i]),
            "ciede2000": float(chart.ciede2000[i]),
            "snr_y_db": defined(float(chart.snr_y_db[i])),
            "sd": dict(zip(noise.measurement.names, sd[i].tolist(), strict=True)),
            "chroma_sd": float(noise.chroma_sd[i]),
            "noise_delta_e": float(noise.delta_e[i]),
            "first_order_holds": bool(chart.first_order_holds[i]),
        }
        for i, name in enumerate(chart.names)
    ]
