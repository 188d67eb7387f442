"""The head of a page: verdict, light, and settings and electrons of each sensor."""

from dataclasses import asdict
from typing import Any

from chromanoise.analysis.analysis import Analysis, diagnosis
from chromanoise.charts.charted_study import Look, Shown, saturated_names
from chromanoise.charts.ranking import ranking
from chromanoise.charts.text import NONE, brief, decimal, electrons, table
from chromanoise.charts.verdicts import verdict_sentences
from chromanoise.exposure import level_in_words
from chromanoise.sensor import Sensor


def drawn_head(shown: Shown, look: Look) -> dict[str, Any]:
    """The verdict in sentences, the light, and the settings of each sensor."""
    first = shown.analyses[0].scene
    sensors = [_sensor(analysis) for analysis in shown.analyses]
    level = {"level_lux": first.level_lux, "text": level_in_words(first.level_lux, 4)}
    return {
        "verdict": verdict_sentences(
            shown.analyses, equal=shown.study.exposure.equal, reader=shown.study.outputs.reader
        ),
        "light": {"name": first.illuminant.name, **level},
        "sensors": sensors,
        "table": _table(sensors),
        "ranking": ranking(shown.analyses),
    }


def sensor_values(sensor: Sensor) -> dict[str, Any]:
    """Channels, origin and pixel of a sensor as plain data.

    Parameters
    ----------
    sensor
        The sensor.
    """
    names = ("pitch_um", "full_well_e", "read_noise_e")
    pixel = asdict(sensor.pixel)
    values = {"channels": list(sensor.names), "origin": sensor.origin, "pixel": pixel}
    return values | {name: pixel[name] for name in names}


def _sensor(analysis: Analysis) -> dict[str, Any]:
    sensor, exposure = analysis.sensor, analysis.exposure
    mean = zip(sensor.names, analysis.raw.mean.tolist(), strict=True)
    return {
        "name": sensor.label,
        **sensor_values(sensor),
        "time_ms": 1e3 * exposure.time_s,
        "f_number": exposure.f_number,
        "saturated": saturated_names(analysis),
        "mean_e": dict(mean),
        "notes": list(diagnosis(analysis)),
    }


def _table(sensors: list[dict[str, Any]]) -> dict[str, Any]:
    """Every setting of each sensor, and its electrons from a perfect white."""
    channels = list(dict.fromkeys(name for one in sensors for name in one["channels"]))
    pixel = ("curves", "pixel [µm]", "full well [e⁻]", "read noise [e⁻]")
    units = [f"{name} [e⁻]" for name in channels]
    rows = []
    for one in sensors:
        mean = [electrons(one["mean_e"][c]) if c in one["mean_e"] else NONE for c in channels]
        full = ", ".join(one["saturated"]) or "none"
        rows.append(
            [
                *(one["name"], one["origin"], brief(one["pitch_um"])),
                *(decimal(one["full_well_e"], 0), brief(one["read_noise_e"])),
                *(brief(one["time_ms"], 4), brief(one["f_number"]), *mean, full),
            ]
        )
    return table(["sensor", *pixel, "time [ms]", "f-number", *units, "saturated"], rows)
