"""Training error against noise, over the weight of the noise in the matrix."""

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import Array, Float
from chromanoise.charts.charted_study import Look, Shown, saturation_sentence, unclipped_remark
from chromanoise.charts.description import (
    MOST_DASHED,
    Axis,
    Chart,
    Column,
    Line,
    Mark,
    Panel,
    Point,
    Value,
    column,
)
from chromanoise.charts.numbers import brief, decimal
from chromanoise.color import ParetoCurve, training_color_error
from chromanoise.noise import OperatingPoint, conditions
from chromanoise.study import (
    SNR_Y,
    Analysis,
    defined,
    noise_weights,
    pareto_of,
    training_named,
)

LIGHTEST, HEAVIEST, POINTS = 1e-3, 1e3, 13
_MOST_LINEAR = 25.0  # from the least to the largest color error
_LEAST, _BELOW, _BEYOND = 1e-3, 0.8, 1.25  # of a logarithmic axis, and its room
_WHOLE = 1e-6  # of a power of ten
_KEY = "Numbers: the weight of the noise in the matrix."


def drawn_pareto(shown: Shown, look: Look) -> Chart:
    """The Pareto curve of each sensor, and the point of its current matrix.

    The training error is the color error without noise, averaged over the spectra of the prior; not
    over the chart. As in ``chromanoise matrix``,
    nothing is clipped.
    """
    weights = noise_weights(LIGHTEST, HEAVIEST, points=POINTS)
    prior, matrix = shown.study.prior, shown.study.matrices[0]
    rows = [
        row
        for point, analysis in zip(shown.operating_points, shown.analyses, strict=True)
        for row in _rows(point, analysis, pareto_of(point, weights, prior=prior), prior)
    ]
    names = [one.sensor.label for one in shown.operating_points]
    why = [
        saturation_sentence(one) or f"{one.sensor.label}: SNR is undefined."
        for one in shown.analyses
    ]
    return trades_chart(
        names,
        rows,
        title=(
            f"Training error (mean over {Path(prior).name}) against SNR of Y at "
            f"{conditions(shown.operating_points)}"
            f"{unclipped_remark(shown)}"
        ),
        note=f"{_KEY} Large mark: current matrix ({matrix}).",
        why_not=tuple(dict.fromkeys(why)),
    )


def trades_chart(
    names: Sequence[str],
    rows: Sequence[tuple[Value, ...]],
    *,
    title: str = "",
    note: str = "",
    why_not: tuple[str, ...] = (),
) -> Chart:
    """Color error against SNR, a curve per sensor over the weights.

    Parameters
    ----------
    names
        Names of the sensors.
    rows
        Sensor, weight, training error and SNR: of each sensor all weights, then ``now``, if
        there is one. [1], [Delta E*ab], [dB]
    title, note, why_not
        Of the chart; its note, and the notes where nothing can be drawn.
    """
    marks: list[Mark] = []
    for i, name in enumerate(names):
        mine = [k for k, row in enumerate(rows) if row[0] == name and row[1] != "now"]
        texts = _labels([float(rows[k][1] or 0.0) for k in mine])
        first, last = mine[0], mine[-1] + 1
        marks.append(Line(x=3, y=2, first=first, last=last, name=name, sensor=i, texts=texts))
    for k, row in enumerate(rows):
        if row[1] == "now":
            marks.append(Point(x=3, y=2, row=k, text="now", sensor=names.index(str(row[0]))))
    drawn = np.array([row[2:] for row in rows if None not in row], dtype=float)
    axes = _axes(drawn) if drawn.size else None
    return Chart(
        title=title,
        description=_description(names, rows),
        sensors=tuple(names),
        columns=_columns(rows),
        panels=(Panel(x=axes[0], y=axes[1], marks=tuple(marks), better="\u2198"),) if axes else (),
        whole_rows=True,
        named="ends" if len(names) > MOST_DASHED else "legend",
        notes=(note,) if axes else why_not,
    )


def _rows(
    point: OperatingPoint, analysis: Analysis, curve: ParetoCurve, prior: str
) -> list[tuple[Value, ...]]:
    """Sensor, weight, training error and SNR of every weight, then of the current matrix."""
    name, full = point.sensor.label, saturation_sentence(analysis)
    snr_db = [defined(value) if full is None else None for value in curve.snr_y_db.tolist()]
    weights = curve.weight.tolist()
    rows = [(name, *each) for each in zip(weights, curve.delta_e, snr_db, strict=True)]
    error = training_color_error(
        point.sensor,
        point.exposure,
        training_named(prior, point.illuminant),
        analysis.matrix,
        level_lux=point.level_lux,
    )
    return [*rows, (name, "now", error, defined(SNR_Y.of(point, analysis.matrix)))]


def _columns(rows: Sequence[Sequence[Value]]) -> tuple[Column, ...]:
    names, weights, errors, snr_db = zip(*rows, strict=True)
    number = partial(decimal, digits=2)
    return (
        column("sensor", names),
        column("weight of the noise", weights, _weight),
        column("training error, mean Delta E*ab", errors, number),
        column("SNR of Y [dB]", snr_db, number),
    )


def _labels(weights: Sequence[float]) -> tuple[str, ...]:
    """The weights at both ends, and between them the powers of ten where there are two such."""
    tens = [weight > 0 and abs(math.log10(weight) % 1) < _WHOLE for weight in weights]
    every, ends = sum(tens) < 2, (0, len(weights) - 1)
    return tuple(
        brief(weight) if every or tens[k] or k in ends else "" for k, weight in enumerate(weights)
    )


def _axes(drawn: Float[Array, "k 2"]) -> tuple[Axis, Axis]:
    """Both axes; that of errors that differ a lot is logarithmic."""
    errors, snr_db = drawn.T.tolist()
    least, most = min(errors), max(errors)
    far = most > _MOST_LINEAR * least > 0
    low, high = (_BELOW * max(_LEAST, least), _BEYOND * most) if far else (least, most)
    label = "training error, mean [ΔE*ab]"
    return (
        Axis(label="SNR of Y [dB]", low=min(snr_db), high=max(snr_db), zero=True),
        Axis(label=label, low=low, high=high, logarithmic=far, exact=far),
    )


def _description(names: Sequence[str], rows: Sequence[Sequence[Value]]) -> str:
    parts = ["More weight on the noise raises the SNR and the training error."]
    for name in names:
        known = [row for row in rows if row[0] == name and None not in row]
        points = [_in_words(row) for row in known if row[1] != "now"]
        if not points:
            parts.append(f"{name}: no curve.")
            continue
        now = "".join(f"; now {_in_words(row)}" for row in known if row[1] == "now")
        parts.append(f"{name}: from {points[0]} to {points[-1]}{now}.")
    return " ".join(parts)


def _in_words(row: Sequence[Any]) -> str:
    return f"{decimal(row[3])} dB at a training error of {decimal(row[2])}"


def _weight(value: float | str) -> str:
    return value if isinstance(value, str) else brief(value)
