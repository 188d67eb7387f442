"""Training error against noise, over the weight of the noise in the matrix."""

from functools import partial
from pathlib import Path
from typing import Any

from chromanoise.charts.charted_study import Look, Shown, saturation_sentence, unclipped_remark
from chromanoise.charts.numbers import brief, decimal, text_table
from chromanoise.color import ParetoCurve, training_color_error
from chromanoise.noise import OperatingPoint, conditions
from chromanoise.study import (
    SNR_Y,
    Analysis,
    defined,
    noise_weights,
    pareto_of,
    trained_names,
    training_named,
)

LIGHTEST, HEAVIEST, POINTS = 1e-3, 1e3, 13
_MOST_LINEAR = 25.0  # from the least to the largest color error


def drawn_pareto(shown: Shown, look: Look) -> dict[str, Any]:
    """The Pareto curve of each sensor, and the point of its current matrix.

    The training error is the color error without noise, averaged over the spectra of the prior; not
    over the chart. As in ``chromanoise matrix``,
    nothing is clipped.
    """
    weights = noise_weights(LIGHTEST, HEAVIEST, points=POINTS)
    prior = shown.study.prior
    sensors = [
        _sensor(operating_point, analysis, pareto_of(operating_point, weights, prior=prior), prior)
        for operating_point, analysis in zip(shown.operating_points, shown.analyses, strict=True)
    ]
    record: dict[str, Any] = {
        "title": (
            f"Training error (mean over {Path(prior).name}) against SNR of Y at "
            f"{conditions(shown.operating_points)}"
            f"{unclipped_remark(shown)}"
        ),
        "description": _description(sensors),
        "prior": prior,
        "unit": "Delta E*ab",
        "matrix": shown.study.matrices[0],
        "trained": bool(trained_names(shown.study.matrices[:1])),
        "logarithmic": _spread_far(sensors),
        "sensors": sensors,
    }
    numbers = partial(decimal, digits=2)
    return record | {"table": text_table("pareto", record, str, _weight, numbers)}


def _spread_far(sensors: list[dict[str, Any]]) -> bool:
    """Whether color errors differ so much that their axis is logarithmic."""
    errors = [
        one["color_error"]
        for sensor in sensors
        for one in (*sensor["points"], sensor["now"])
        if _is_drawn(one)
    ]
    return bool(errors) and max(errors) > _MOST_LINEAR * min(errors) > 0


def _sensor(
    operating_point: OperatingPoint, analysis: Analysis, curve: ParetoCurve, prior: str
) -> dict[str, Any]:
    full = saturation_sentence(analysis)
    points = [
        {
            "weight": float(weight),
            "text": brief(float(weight)),
            "color_error": curve.delta_e[i],
            "snr_db": defined(float(curve.snr_y_db[i])) if full is None else None,
        }
        for i, weight in enumerate(curve.weight)
    ]
    error = training_color_error(
        operating_point.sensor,
        operating_point.exposure,
        training_named(prior, operating_point.illuminant),
        analysis.matrix,
        level_lux=operating_point.level_lux,
    )
    snr = defined(SNR_Y.of(operating_point, analysis.matrix))
    now = {"color_error": error, "snr_db": snr}
    return {"name": operating_point.sensor.label, "points": points, "now": now, "why_not": full}


def _description(sensors: list[dict[str, Any]]) -> str:
    parts = ["More weight on the noise raises the SNR and the training error."]
    for sensor in sensors:
        points = [_in_words(one) for one in sensor["points"] if _is_drawn(one)]
        if not points:
            parts.append(f"{sensor['name']}: no curve.")
            continue
        now = f"; now {_in_words(sensor['now'])}" if _is_drawn(sensor["now"]) else ""
        parts.append(f"{sensor['name']}: from {points[0]} to {points[-1]}{now}.")
    return " ".join(parts)


def _is_drawn(point: dict[str, Any]) -> bool:
    return point["snr_db"] is not None and point["color_error"] is not None


def _in_words(point: dict[str, Any]) -> str:
    return f"{decimal(point['snr_db'])} dB at a training error of {decimal(point['color_error'])}"


def _weight(value: float | str) -> str:
    return value if isinstance(value, str) else brief(value)
