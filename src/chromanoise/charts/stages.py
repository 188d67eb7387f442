"""SNR of raw, contravariant and color coordinates, and noise in CIELAB."""

from typing import Any

from chromanoise.analysis.defined import defined
from chromanoise.analysis.operating_point import noisy_color_at, stages_at
from chromanoise.analysis.perceived import GRAY
from chromanoise.analysis.stages import (
    Analysis,
    color_snr_db,
    color_snr_loss_db,
    contravariant_snr_db,
    raw_snr_db,
)
from chromanoise.charts.patches import quick_cubature
from chromanoise.charts.shown import Look, Shown, saturation_sentence
from chromanoise.color import LAB, propagate


def drawn_stages(shown: Shown, look: Look) -> dict[str, Any]:
    """Each kind of SNR of a perfect white, and standard deviations of an 18 % gray's L*, a*, b*."""
    return {
        "gray": GRAY,
        "sensors": [
            {
                "name": analysis.sensor.name,
                "raw": raw_snr_db(analysis),
                "contravariant": contravariant_snr_db(analysis),
                "spectral_db": _where_usable(analysis, analysis.spectral_snr_db),
                "color": color_snr_db(analysis),
                "lab_sd": _gray_sd(analysis),
                "bound_db": _where_usable(analysis, analysis.optimal_linear_snr_db),
                "price_db": color_snr_loss_db(analysis),
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
    gray = stages_at(analysis.point, analysis.matrix, reflectance=GRAY)
    white = analysis.matrix.matrix @ analysis.expected_e
    lab = propagate(noisy_color_at(gray, white), LAB, quick_cubature)
    return dict(zip(lab.measurement.names, lab.sd.tolist(), strict=True))
