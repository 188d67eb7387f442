"""SNR of raw, contravariant and color coordinates, and noise in CIELAB."""

from typing import Any

import numpy as np

from chromanoise.analysis.defined import defined
from chromanoise.analysis.perceived import GREY
from chromanoise.analysis.stages import (
    Analysis,
    color_price_db,
    color_snr_db,
    contravariant_snr_db,
    raw_snr_db,
)
from chromanoise.charts.shown import Look, Shown, saturation_sentence
from chromanoise.color import LAB, colored, gaussian_cubature, through_space_sampled
from chromanoise.exposure import expected_electrons
from chromanoise.noise import with_noise
from chromanoise.scene import flat_field


def drawn_stages(shown: Shown, look: Look) -> dict[str, Any]:
    """Each kind of SNR of a perfect white, and standard deviations of an 18 % gray's L*, a*, b*."""
    return {
        "gray": GREY,
        "sensors": [
            {
                "name": analysis.sensor.name,
                "raw": raw_snr_db(analysis),
                "contravariant": contravariant_snr_db(analysis),
                "spectral_db": _where_usable(analysis, analysis.spectral_snr_db),
                "color": color_snr_db(analysis),
                "lab_sd": _gray_sd(analysis),
                "bound_db": _where_usable(analysis, analysis.bound_db),
                "price_db": color_price_db(analysis),
                "why_not": saturation_sentence(analysis),
            }
            for analysis in shown.analyses
        ],
    }


def _where_usable(analysis: Analysis, value: float) -> float | None:
    return None if analysis.saturated.any() else defined(value)


def _gray_sd(analysis: Analysis) -> dict[str, float | None]:
    if None in color_snr_db(analysis).values():
        return dict.fromkeys(LAB.coordinates)
    light, sensor, exposure = analysis.scene, analysis.sensor, analysis.exposure
    gray = flat_field(light.illuminant, level_lux=light.level_lux, reflectance=GREY)
    raw = with_noise(expected_electrons(gray, sensor, exposure), sensor)
    white = analysis.matrix.matrix @ analysis.expected_e
    rule = gaussian_cubature(radii=6, latitudes=4, longitudes=8)  # errs by .3 %, and is quick
    lab = through_space_sampled(colored(raw, analysis.matrix), LAB, white, rule=rule)
    return dict(zip(lab.names, np.sqrt(lab.variance).tolist(), strict=True))
