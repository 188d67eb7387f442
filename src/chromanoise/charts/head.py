"""What stands above all: the verdict, the light, and each sensor in use."""

from typing import Any

from chromanoise.analysis.stages import Analysis, diagnosis
from chromanoise.charts.shown import Look, Shown, saturated_names
from chromanoise.charts.verdicts import verdict_sentences


def drawn_head(shown: Shown, look: Look) -> dict[str, Any]:
    """The verdict in sentences, the light, and what each sensor is set to."""
    first = shown.analyses[0].scene
    return {
        "verdict": verdict_sentences(shown.analyses, equal=shown.study.exposure.equal),
        "light": {"name": first.illuminant.name, "level_lux": first.level_lux},
        "sensors": [_sensor(analysis) for analysis in shown.analyses],
    }


def _sensor(analysis: Analysis) -> dict[str, Any]:
    sensor, exposure = analysis.sensor, analysis.exposure
    mean = zip(sensor.names, analysis.expected_e.tolist(), strict=True)
    return {
        "name": sensor.name,
        "channels": list(sensor.names),
        "origin": sensor.origin,
        "time_ms": 1e3 * exposure.time_s,
        "f_number": exposure.f_number,
        "pitch_um": sensor.pixel.pitch_um,
        "full_well_e": sensor.pixel.full_well_e,
        "read_noise_e": sensor.pixel.read_noise_e,
        "saturated": saturated_names(analysis),
        "mean_e": dict(mean),
        "notes": list(diagnosis(analysis)),
    }
