"""SNR over the light level, and where sensors change places."""

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from chromanoise._check import InputError
from chromanoise.exposure import Situation
from chromanoise.study.comparison import Curve, compared, crossover_as_json, crossovers
from chromanoise.study.drawings.shown import Look, Shown
from chromanoise.study.makers import MatrixMaker
from chromanoise.study.quantities import QUANTITIES, Quantity
from chromanoise.study.sweeps import SWEEPS, swept_values

LOWEST_LUX, HIGHEST_LUX, POINTS = 0.01, 1000.0, 61
"""The sweep of ``chromanoise compare``."""


def drawn_levels(shown: Shown, look: Look) -> dict[str, Any]:
    """Curves of SNR over lux, each sensor with each matrix, and their crossovers.

    The times are those of the study's own level, as in ``chromanoise compare``.
    """
    sweep = SWEEPS["lux"]
    quantity = _quantity(look)
    values = swept_values(sweep, LOWEST_LUX, HIGHEST_LUX, POINTS)
    makers = shown.makers
    curves = compared(shown.situations, makers, values, sweep=sweep, quantity=quantity)
    return {
        "lux": values.tolist(),
        "now_lux": shown.study.light.level_lux,
        "quantity": quantity.what,
        "unit": quantity.unit,
        "curves": [
            {
                "sensor": curve.sensor,
                "matrix": curve.matrix,
                "values": [v if np.isfinite(v) else None for v in curve.value.tolist()],
                "saturated_from_lux": _saturated_from(curve),
            }
            for curve in curves
        ],
        "crossovers": _crossed(shown.situations, makers, curves),
    }


def _quantity(look: Look) -> Quantity:
    """Of X, Y or Z where one of them is looked at, else of Y."""
    return QUANTITIES.get(f"snr-{look.coordinate.lower()}", QUANTITIES["snr-y"])


def _saturated_from(curve: Curve) -> float | None:
    full = np.flatnonzero(curve.saturated)
    return float(curve.at[full[0]]) if full.size else None


def _crossed(
    situations: tuple[Situation, ...],
    makers: Mapping[str, MatrixMaker],
    curves: tuple[Curve, ...],
) -> list[dict[str, Any]]:
    """Each pair by itself, so that one without a common level does not silence the others."""
    told = []
    for name, maker in makers.items():
        mine = [curve for curve in curves if curve.matrix == name]
        for (a, of_a), (b, of_b) in combinations(zip(situations, mine, strict=True), 2):
            try:
                (found,) = crossovers([a, b], {name: maker}, [of_a, of_b])
            except InputError as error:
                told.append(_entry(of_a, of_b, None, str(error)))
                continue
            sentence = crossover_as_json(found)["sentence"]
            told += [_entry(of_a, of_b, at, sentence) for at in found.at or (None,)]
    return told


def _entry(first: Curve, second: Curve, lux: float | None, sentence: str) -> dict[str, Any]:
    between = {"first": first.sensor, "second": second.sensor, "matrix": first.matrix}
    return {"lux": lux, "sentence": sentence, **between}
