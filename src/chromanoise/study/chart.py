"""A ColorChecker seen by one sensor: color error and noise of every patch, never one alone."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.color import LAB, PerceivedNoise, colored, perceived_noise
from chromanoise.exposure import expected_electrons
from chromanoise.merit import chart_ciede2000, chart_color_error, snr_db
from chromanoise.noise import with_noise
from chromanoise.scene import Scene
from chromanoise.spectra import colorchecker
from chromanoise.study.analysis import Analysis


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChartNoise:
    """Each patch of the chart, in the light and with the exposure of an analysis.

    Attributes
    ----------
    names
        Of the 24 patches.
    color_error, ciede2000
        Without noise, CIE 1976 and CIEDE2000. [Delta E]
    snr_y_db
        SNR of Y; NaN where Y is no signal. [dB]
    noise
        In CIELAB, relative to the sensor's own white: standard deviations, bias, mean Delta E.
    """

    names: tuple[str, ...]
    color_error: Float[Array, "24"]
    ciede2000: Float[Array, "24"]
    snr_y_db: Float[Array, "24"]
    noise: PerceivedNoise

    def __post_init__(self) -> None:
        _check.freeze(self, "color_error", "ciede2000", "snr_y_db")


def chart_noise(analysis: Analysis) -> ChartNoise | None:
    """Color error and noise of the ColorChecker where the analysis has its white.

    ``None`` where a channel is saturated on the white or the white is no color.

    Raises
    ------
    InputError
        If the grid leaves 400-1050 nm, where the chart is measured.
    """
    sensor, exposure, matrix = analysis.sensor, analysis.exposure, analysis.matrix
    lamp = analysis.scene.illuminant
    white = analysis.color.mean
    errors = chart_color_error(sensor, matrix, exposure, lamp)
    newer = chart_ciede2000(sensor, matrix, exposure, lamp)
    if analysis.saturated.any() or not (white > 0).all() or errors is None or newer is None:
        return None
    chart = colorchecker(sensor.grid)
    scene = Scene(illuminant=lamp, level_lux=analysis.scene.level_lux, reflectance=chart.values.T)
    electrons = expected_electrons(scene, sensor, exposure)
    xyz = colored(with_noise(electrons, sensor), matrix)
    return ChartNoise(
        names=chart.names,
        color_error=errors,
        ciede2000=newer,
        snr_y_db=np.where(xyz.mean[:, 1] > 0, snr_db(xyz)["Y"], np.nan),
        noise=perceived_noise(xyz, white, space=LAB),
    )


def chart_as_json(chart: ChartNoise | None) -> list[dict[str, Any]] | None:
    """One entry per patch; what is not defined is ``None``."""
    if chart is None:
        return None
    sd, noise = np.sqrt(chart.noise.second_route.variance), chart.noise
    return [
        {
            "patch": name,
            "color_error": float(chart.color_error[i]),
            "ciede2000": float(chart.ciede2000[i]),
            "snr_y_db": float(snr) if np.isfinite(snr := chart.snr_y_db[i]) else None,
            "sd": dict(zip(noise.second_route.names, sd[i].tolist(), strict=True)),
            "chroma_sd": float(noise.chroma_sd[i]),
            "noise_delta_e": float(noise.delta_e[i]),
            "first_order_holds": bool(noise.first_order_holds[i]),
        }
        for i, name in enumerate(chart.names)
    ]
