"""Results as plain data for ``json.dumps``; undefined values are ``None``."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from chromanoise import __version__
from chromanoise.analysis.analysis import (
    Analysis,
    color_snr_db,
    contravariant_snr_db,
    diagnosis,
    mean_color_error,
    raw_snr_db,
    temporal_color_snr_db,
    temporal_raw_snr_db,
)
from chromanoise.analysis.budgets import color_budgets, contravariant_budgets, lab_budgets
from chromanoise.analysis.comparison.crossing import Crossover, crossover_as_json
from chromanoise.analysis.comparison.curves import Curve
from chromanoise.analysis.comparison.ranking import Rank, ranked, ranking_as_json
from chromanoise.analysis.total_error import mean_total_error
from chromanoise.analysis.undefined import defined, named, plain_fields
from chromanoise.metrics import Budget


def analyses_as_json(analyses: Sequence[Analysis]) -> dict[str, Any]:
    """Analyses of several sensors as plain data.

    Parameters
    ----------
    analyses
        Results of each sensor.
    """
    return {
        "version": __version__,
        "metric": analyses[0].matrix.metric,
        "illuminant": analyses[0].scene.illuminant.name,
        "level_lux": analyses[0].scene.level_lux,
        "observer": analyses[0].matrix.observer,
        "sensors": [_analysis(analysis) for analysis in analyses],
        "ranking": ranking_as_json(ranking_of_analyses(analyses)),
    }


def ranking_of_analyses(analyses: Sequence[Analysis]) -> tuple[Rank, ...]:
    """The sensors from highest to lowest SNR of Y."""
    found = [(one.sensor.name, one.sensor.label, color_snr_db(one)["Y"]) for one in analyses]
    return ranked(
        [(name, label, math.nan if snr is None else snr) for name, label, snr in found],
        matrix=analyses[0].matrix.made_by,
        more_is_better=True,
    )


def comparison_as_json(curves: Sequence[Curve], crossed: Sequence[Crossover]) -> dict[str, Any]:
    """Curves and crossovers as plain data; undefined values are ``None``.

    Parameters
    ----------
    curves
        One curve per sensor and matrix.
    crossed
        Crossovers of the curves.
    """
    sweep, quantity = curves[0].sweep, curves[0].quantity
    return {
        "version": __version__,
        "sweep": plain_fields(sweep, "name", "what", "unit") | {"values": curves[0].at.tolist()},
        "quantity": plain_fields(quantity, "name", "what", "unit"),
        "curves": [
            plain_fields(curve, "sensor", "label", "matrix")
            | {"time_ms": 1e3 * curve.time_s}
            | plain_fields(curve, "value", "saturated", "color_error")
            for curve in curves
        ],
        "crossovers": [crossover_as_json(c) for c in crossed],
    }


def budgets_as_json(analysis: Analysis) -> dict[str, Any]:
    """Budgets of X, Y, Z, contravariant coordinates and L*, a*, b* of a gray, or ``None``.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    budgets = {
        "budget": color_budgets(analysis),
        "contravariant_budget": contravariant_budgets(analysis),
        "lab_budget": lab_budgets(analysis),
    }
    return {name: [_budget(b) if b else None for b in own] for name, own in budgets.items()}


def _budget(budget: Budget) -> dict[str, Any]:
    return {
        "coordinate": budget.coordinate,
        "photons_db": budget.photons_db,
        "costs": tuple(asdict(cost) for cost in budget.costs),
        "bound_db": budget.optimal_linear_snr_db,
        "snr_db": budget.snr_db,
    }


def _analysis(analysis: Analysis) -> dict[str, Any]:
    sensor, axes = analysis.sensor, analysis.color.names
    return {
        "name": sensor.name,
        "label": sensor.label,
        "time_ms": 1e3 * analysis.exposure.time_s,
        "f_number": analysis.exposure.f_number,
        "channels": _channels(analysis),
        "spectral_snr_db": analysis.spectral_snr_db,
        "color": {
            "snr_db": color_snr_db(analysis),
            "temporal_snr_db": temporal_color_snr_db(analysis),
            "total_error_delta_e": mean_total_error(analysis),
            "mean_lux": named(axes, analysis.color.mean),
            "covariance_lux2": analysis.color.covariance.tolist(),
        },
        "bound_db": analysis.optimal_linear_snr_db,
        "price_db": analysis.color_snr_loss_db,
        "condition": defined(analysis.matrix.frame.condition),
        "rank": analysis.matrix.frame.rank,
        "nearest_mix": asdict(analysis.mix) if analysis.mix else None,
        "matrix": analysis.matrix.matrix.tolist(),
        "matrix_made_by": analysis.matrix.made_by,
        "matrix_unit": "lx/e-",
        "color_error_mean": mean_color_error(analysis),
        "notes": list(diagnosis(analysis)),
    }


def _channels(analysis: Analysis) -> list[dict[str, Any]]:
    names = analysis.sensor.names
    raw, contravariant = raw_snr_db(analysis), contravariant_snr_db(analysis)
    temporal = temporal_raw_snr_db(analysis)
    return [
        {
            "name": name,
            "mean_e": float(analysis.raw.mean[i]),
            "snr_db": raw[name],
            "temporal_snr_db": temporal[name],
            "contravariant_snr_db": contravariant[name],
            "vif": defined(float(analysis.vif[i])),
            "saturated": bool(analysis.saturated[i]),
            "full_share": float(analysis.full_share[i]),
            "angle_deg": named(names, analysis.between_deg[i]),
            "angle_to_axis_deg": named(("x", "y", "z"), analysis.to_axes_deg[i]),
        }
        for i, name in enumerate(names)
    ]
