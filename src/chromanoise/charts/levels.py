"""SNR over the light level, with the crossovers of sensors."""

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

from chromanoise.base import Array, Float
from chromanoise.charts.charted_study import Look, Shown, unclipped_remark
from chromanoise.charts.numbers import UNDEFINED, brief, decimal, listed, text_table
from chromanoise.noise import level_in_words, light_and_exposure
from chromanoise.study import (
    MOST_PAIRS_SENSORS,
    QUANTITIES,
    SWEEPS,
    Crossover,
    Curve,
    Incomparable,
    Quantity,
    compared,
    crossover_sentence,
    crossovers_or_reasons,
    defined,
    fullest_level_lux,
    lead_sentences,
    leading_crossovers,
    leads,
    swept_values,
)

LOWEST_LUX, HIGHEST_LUX = 0.01, 10_000.0
"""Range of the curves and of the page's slider: moonlight to a cloudy day. [lx]"""
_PER_DECADE = 12  # includes the points of ``chromanoise compare``


def drawn_levels(shown: Shown, look: Look) -> dict[str, Any]:
    """Curves of SNR over lux, each sensor with each matrix, and their crossovers.

    Of more than three sensors, only the crossovers at which the leader changes, and the leaders.

    Exposure times are those at the study's level, as in ``chromanoise compare``, which
    never clips.
    """
    quantity, makers, values = _quantity(shown, look), shown.makers, drawn_lux(shown)
    curves, pairs = level_curves(shown, quantity)
    fullest = [fullest_level_lux(one) for one in shown.operating_points for _ in makers]
    drawn = [
        {
            "name": f"{curve.label}, {curve.matrix}" if len(makers) > 1 else curve.label,
            "sensor": curve.label,
            "matrix": curve.matrix,
            "values": [defined(value) for value in curve.value.tolist()],
            "saturated_from_lux": full if full is not None and full < values[-1] else None,
        }
        for curve, full in zip(curves, fullest, strict=True)
    ]
    found = [one for one in pairs if isinstance(one, Crossover)]
    leading = leads(curves, found)
    many = len(shown.operating_points) > MOST_PAIRS_SENSORS
    crossovers = leading_crossovers(leading, found) if many else pairs
    crossed = [entry for pair in crossovers for entry in _crossed(pair)]
    leaders = lead_sentences(leading) if many else []
    lux = values.tolist()
    record: dict[str, Any] = {
        "title": (
            f"{quantity.what} against illuminance ({light_and_exposure(shown.operating_points)})"
            f"{unclipped_remark(shown)}"
        ),
        "description": _description(drawn, crossed, lux, quantity.unit),
        "lux": lux,
        "now_lux": shown.study.light.level_lux,
        "now": level_in_words(shown.study.light.level_lux),
        "quantity": quantity.what,
        "unit": quantity.unit,
        "curves": drawn,
        "crossovers": crossed,
        "notes": [*leaders, *_notes(drawn, quantity.what)],
    }
    cell = partial(decimal, digits=2, none=UNDEFINED)
    return record | {"table": text_table("levels", record, brief, cell)}


def level_curves(
    shown: Shown, quantity: Quantity = QUANTITIES["snr-y"]
) -> tuple[Sequence[Curve], Sequence[Crossover | Incomparable]]:
    """A quantity of each sensor with each matrix over the light level, with crossovers."""
    values, makers = drawn_lux(shown), shown.makers
    curves = compared(
        shown.operating_points, makers, values, sweep=SWEEPS["lux"], quantity=quantity
    )
    return curves, crossovers_or_reasons(shown.operating_points, makers, curves)


def drawn_lux(shown: Shown) -> Float[Array, " k"]:
    """The light levels of the curves, extended by whole decades to include the study's. [lx]"""
    sweep, level = SWEEPS["lux"], shown.study.light.level_lux
    first = min(LOWEST_LUX, 10.0 ** math.floor(math.log10(level)))
    last = max(HIGHEST_LUX, 10.0 ** math.ceil(math.log10(level)))
    points = 1 + _PER_DECADE * round(math.log10(last / first))
    return swept_values(sweep, max(first, sweep.lowest), min(last, sweep.highest), points)


def _quantity(shown: Shown, look: Look) -> Quantity:
    """For an eye the SNR of the selected X, Y or Z, else of Y; for a machine the separation."""
    if shown.study.outputs.reader == "machine":
        return QUANTITIES["separation"]
    return QUANTITIES.get(f"snr-{look.coordinate.lower()}", QUANTITIES["snr-y"])


def _crossed(pair: Crossover | Incomparable) -> list[dict[str, Any]]:
    """One entry per crossover; without crossovers, one entry with the reason."""
    first, second = pair.labels
    between = {"first": first, "second": second, "matrix": pair.matrix}
    if isinstance(pair, Incomparable):
        return [{"lux": None, "sentence": pair.why, **between}]
    sentence = crossover_sentence(pair)
    return [{"lux": at, "sentence": sentence, **between} for at in pair.at or (None,)]


def _notes(curves: list[dict[str, Any]], what: str) -> list[str]:
    """The level at which each sensor saturates, and the curves without any value."""
    full = [
        f"{one['sensor']} {level_in_words(one['saturated_from_lux'])}"
        for one in curves
        if one["saturated_from_lux"] is not None
    ]
    empty = [one["name"] for one in curves if all(value is None for value in one["values"])]
    return [
        *([f"Saturated from: {listed(list(dict.fromkeys(full)))}."] if full else []),
        *([f"{what} is undefined in this range: {listed(empty)}."] if empty else []),
    ]


def _description(
    curves: list[dict[str, Any]], crossed: list[dict[str, Any]], lux: list[float], unit: str
) -> str:
    parts = []
    for one in curves:
        there = [k for k, value in enumerate(one["values"]) if value is not None]
        if not there:
            parts.append(f"The curve of {one['name']} is undefined in this range.")
            continue
        first, last = (
            f"{decimal(one['values'][k])} {unit} at {level_in_words(lux[k])}"
            for k in (there[0], there[-1])
        )
        parts.append(f"{one['name']} goes from {first} to {last}.")
    return " ".join([*parts, *(one["sentence"] for one in crossed)])
