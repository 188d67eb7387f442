"""The sensors of a study as a table: rank, SNR, color error, time, settings and electrons."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from chromanoise.base import dataclass
from chromanoise.charts.charted_study import Look, Shown, saturated_names
from chromanoise.charts.description import numbers_of
from chromanoise.charts.numbers import NONE, brief, decimal, electrons, listed, table, three_digits
from chromanoise.noise import level_in_words
from chromanoise.sensor import PIXEL, PIXEL_REQUIRED, Sensor
from chromanoise.study import (
    VISUAL_NOISE,
    Analysis,
    assumptions,
    color_snr_db,
    diagnosis,
    is_assumed,
    mean_color_error,
    visual_noise_of,
)


@dataclass(frozen=True)
class _Column:
    """A column: ``better`` is ``higher`` or ``lower``, ``None`` where neither is."""

    key: str
    head: str
    what: str
    better: str | None
    value: Callable[[Analysis], float | None]
    text: Callable[[float], str] = decimal


def ranking(analyses: Sequence[Analysis]) -> dict[str, Any]:
    """Columns and rows of the table, in the order of the sensors, with their notes.

    A rank is that of the SNR of Y as it is shown, so equal numbers share a rank. A sensor that is
    saturated or has no luminance has no rank and no SNR.

    Parameters
    ----------
    analyses
        Analyses under one light.
    """
    columns = _columns(analyses)
    return {
        "columns": [
            {"key": one.key, "head": one.head, "what": one.what, "better": one.better}
            for one in columns
        ],
        "rows": [_row(analysis, columns) for analysis in analyses],
        "notes": _notes(analyses),
    }


def _columns(analyses: Sequence[Analysis]) -> list[_Column]:
    able = [one for one in analyses if _luminance_db(one) is not None]
    shown = sorted((round(_luminance_db(one) or 0.0, 1) for one in able), reverse=True)

    def rank(analysis: Analysis) -> float | None:
        luminance_db = _luminance_db(analysis)
        return None if luminance_db is None else 1.0 + shown.index(round(luminance_db, 1))

    def known_raw_db(analysis: Analysis) -> float | None:
        found = math.inf if _luminance_db(analysis) is None else raw_db(analysis)
        return found if math.isfinite(found) else None

    raw = f"raw SNR: {RAW_SNR}"
    loss, error = "best linear SNR minus the SNR of Y", "mean CIE 1976 difference"
    return [
        _Column("rank", "rank by SNR of Y", "rank by the SNR of Y", "lower", rank, brief),
        _Column("raw_db", "raw SNR [dB]", raw, "higher", known_raw_db),
        _Column("luminance_db", "SNR of Y [dB]", "SNR of luminance", "higher", _luminance_db),
        _Column("loss_db", "color SNR loss [dB]", loss, "lower", _loss_db),
        _Column(
            "color_error", "color error [ΔE]", f"{error}, without noise", "lower", mean_color_error
        ),
        _Column(
            "visual_noise", "visual noise", VISUAL_NOISE, "lower", visual_noise_of, three_digits
        ),
        _Column("time_ms", "time [ms]", "exposure time", None, _time_ms, _four_digits),
        _Column("f_number", "f-number", "f-number", None, lambda one: one.exposure.f_number, brief),
        *map(_channel, dict.fromkeys(name for one in analyses for name in one.sensor.names)),
    ]


def _channel(name: str) -> _Column:
    def mean_e(analysis: Analysis) -> float | None:
        names = analysis.sensor.names
        return float(analysis.raw.mean[names.index(name)]) if name in names else None

    what = f"mean electrons of channel {name}, perfect white"
    return _Column(f"mean_e.{name}", f"{name} [e⁻]", what, None, mean_e, electrons)


def _row(analysis: Analysis, columns: Sequence[_Column]) -> dict[str, Any]:
    values = [one.value(analysis) for one in columns]
    texts = [
        NONE if value is None else one.text(value)
        for one, value in zip(columns, values, strict=True)
    ]
    return {
        "name": analysis.sensor.label,
        "values": values,
        "text": texts,
        "saturated": saturated_names(analysis),
        "assumed": _assumed(analysis.sensor),
    }


def _assumed(sensor: Sensor) -> str:
    """Which values of the pixel are assumed, in words and numbers; empty if none is."""
    names = [name for name in PIXEL_REQUIRED if is_assumed(sensor, name)]
    if not names:
        return ""
    values = [f"{getattr(sensor.pixel, one):,g} {_UNITS[PIXEL[one].unit]}" for one in names]
    verb = "is" if len(names) == 1 else "are"
    return f"{listed([PIXEL[one].label for one in names])} {verb} assumed: {', '.join(values)}"


_UNITS = {"um": "µm", "e-": "e⁻"}


def _notes(analyses: Sequence[Analysis]) -> list[str]:
    """The remarks on the sensors, each once, with the sensors that it applies to.

    What is assumed is in their rows.
    """
    named: dict[str, list[str]] = {}
    for analysis in analyses:
        beside = assumptions(analysis.sensor)
        for note in diagnosis(analysis):
            if note in beside:
                continue
            named.setdefault(note, []).append(analysis.sensor.label)
    return [f"{', '.join(names)}: {note}" for note, names in named.items()]


def _luminance_db(analysis: Analysis) -> float | None:
    return color_snr_db(analysis)["Y"]


def _loss_db(analysis: Analysis) -> float | None:
    return None if _luminance_db(analysis) is None else analysis.color_snr_loss_db


def _time_ms(analysis: Analysis) -> float:
    return 1e3 * analysis.exposure.time_s


def _four_digits(value: float) -> str:
    return brief(value, 4)


RAW_SNR = "best linear readout of all channels"
"""What the raw SNR of a sensor is; it depends on no other sensor."""


def raw_db(analysis: Analysis) -> float:
    """Raw SNR of a sensor without saturated channels; infinite for a signal without noise. [dB]"""
    best = analysis.optimal_linear_snr_db
    return math.inf if best is None else best


def drawn_numbers(shown: Shown, look: Look) -> dict[str, Any]:
    """The light, and settings and numbers of each sensor: of the head, what is quick."""
    first = shown.analyses[0].scene
    sensors = [_sensor(analysis) for analysis in shown.analyses]
    level = {"level_lux": first.level_lux, "text": level_in_words(first.level_lux, 4)}
    return {
        "light": {"name": first.illuminant.name, **level},
        "sensors": sensors,
        **numbers_of(_rows_of_head(sensors)),
        "table": _table(sensors),
        "ranking": ranking(shown.analyses),
    }


def _rows_of_head(sensors: Sequence[Mapping[str, Any]]) -> list[list[Any]]:
    """A row per channel of a sensor, under a row of headings."""
    head = ["sensor", "channel", "electrons of a white [e-]", "full well [e-]"]
    rows = [
        [one["name"], name, mean_e, one["full_well_e"], one["time_ms"], one["f_number"]]
        for one in sensors
        for name, mean_e in one["mean_e"].items()
    ]
    return [[*head, "exposure time [ms]", "f-number"], *rows]


def sensor_values(sensor: Sensor) -> dict[str, Any]:
    """Channels, origin and pixel of a sensor as plain data."""
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
