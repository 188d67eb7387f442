"""The table of the sensors (rank, SNR, color error, time), and the raw SNR that compares them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from chromanoise.analysis.analysis import (
    Analysis,
    color_snr_db,
    diagnosis,
    mean_color_error,
    raw_snr_db,
)
from chromanoise.analysis.total_error import mean_total_error
from chromanoise.charts.charted_study import saturated_names
from chromanoise.charts.text import NONE, brief, decimal, electrons


@dataclass(frozen=True, slots=True)
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

    def raw_db(analysis: Analysis) -> float | None:
        found = (
            compared_raw_snr_db(analysis, able) if _luminance_db(analysis) is not None else math.inf
        )
        return found if math.isfinite(found) else None

    raw = f"raw SNR: {compared_raw_name(able)}" if able else "raw SNR"
    loss, error = "best linear SNR minus the SNR of Y", "mean CIE 1976 difference"
    return [
        _Column("rank", "rank", "rank by the SNR of Y", "lower", rank, brief),
        _Column("raw_db", "raw SNR [dB]", raw, "higher", raw_db),
        _Column("luminance_db", "SNR of Y [dB]", "SNR of luminance", "higher", _luminance_db),
        _Column("loss_db", "color SNR loss [dB]", loss, "lower", _loss_db),
        _Column(
            "color_error", "color error [ΔE]", f"{error}, without noise", "lower", mean_color_error
        ),
        _Column(
            "total_error",
            "total color error [ΔE]",
            f"{error}, with noise",
            "lower",
            mean_total_error,
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
    }


def _notes(analyses: Sequence[Analysis]) -> list[str]:
    """The remarks on the sensors, each once, with the sensors that it applies to."""
    named: dict[str, list[str]] = {}
    for analysis in analyses:
        for note in diagnosis(analysis):
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


def compared_raw_snr_db(analysis: Analysis, analyses: Sequence[Analysis]) -> float:
    """Mean raw SNR of the channels that all sensors have; without them the best linear SNR. [dB]

    Infinite for a signal without noise.

    Parameters
    ----------
    analysis
        That of one sensor, without saturated channels.
    analyses
        Those of all compared sensors.
    """
    shared, snr = _shared(tuple(analyses)), raw_snr_db(analysis)
    if shared:
        return float(np.mean([snr[name] for name in shared]))
    best = analysis.optimal_linear_snr_db
    return math.inf if best is None else best  # not saturated: it is signal without noise


def compared_raw_name(analyses: Sequence[Analysis]) -> str:
    """What `compared_raw_snr_db` is, in a few words.

    Parameters
    ----------
    analyses
        Those of all compared sensors.
    """
    shared = _shared(tuple(analyses))
    return f"mean of {', '.join(shared)}" if shared else "best linear readout of all channels"


@lru_cache(maxsize=16)  # verdict and ranking ask for each sensor
def _shared(analyses: tuple[Analysis, ...]) -> tuple[str, ...]:
    """Channels that all sensors have, with signal in all of them."""
    found = [raw_snr_db(analysis) for analysis in analyses]
    return tuple(
        name for name in analyses[0].sensor.names if all(one.get(name) is not None for one in found)
    )
