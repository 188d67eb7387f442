"""Color error against noise: trade-offs of the sensors, and curves over the weight of the noise."""

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from chromanoise.base import Array, Float
from chromanoise.charts.charted_study import Look, Shown, unclipped_remark
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
from chromanoise.noise import conditions
from chromanoise.study import (
    SNR_Y,
    Analysis,
    LeftOut,
    TradeOff,
    defined,
    mean_color_error,
    trade_off,
    visual_noise_of,
)

_POINTS = 25  # of a curve, at most
_MOST_LINEAR = 25.0  # from the least to the largest value of an axis
_LEAST, _BELOW, _BEYOND = 1e-3, 0.8, 1.25  # of a logarithmic axis, and its room
_WHOLE = 1e-6  # of a power of ten
_NOW, _INFINITE = "now", "infinite"


def drawn_pareto(shown: Shown, look: Look) -> Chart:
    """The trade-off of each sensor, and the point of its current matrix.

    As in the comparison at equal color error, nothing is clipped.
    """
    matrix, maker = next(iter(shown.makers.items()))
    rows: list[tuple[Value, ...]] = []
    why = []
    for analysis in shown.analyses:
        found = trade_off(analysis.point, prior=maker.prior)
        if isinstance(found, LeftOut):
            why.append(f"{found.sensor}: no curve, because {found.why}.")
        else:
            rows += _along(found)
        rows.append(_now(analysis))
    return _chart(
        [one.sensor.label for one in shown.analyses],
        rows,
        _columns(rows, "color error, mean Delta E*ab", "visual noise [CIELUV]", "SNR of Y [dB]"),
        ("visual noise [CIELUV]", "color error, mean [ΔE*ab]"),
        title=(
            "Color error against visual noise at "
            f"{conditions(shown.operating_points)}{unclipped_remark(shown)}"
        ),
        better="\u2199",
        notes=(
            f"Large mark: current matrix ({matrix}). Curves: matrices trained on the prior.",
            *why,
        ),
        why_not=tuple(why),
    )


def trades_chart(names: Sequence[str], rows: Sequence[tuple[Value, ...]]) -> Chart:
    """Training error against SNR, a curve per sensor over the weights.

    Parameters
    ----------
    names
        Names of the sensors.
    rows
        Sensor, weight, training error and SNR. [1], [Delta E*ab], [dB]
    """
    return _chart(
        names,
        rows,
        _columns(rows, "training error, mean Delta E*ab", "SNR of Y [dB]"),
        ("SNR of Y [dB]", "training error, mean [ΔE*ab]"),
        better="\u2198",
        with_weights=True,
    )


def _along(trade: TradeOff) -> list[tuple[Value, ...]]:
    """Sensor, weight, color error, noise and SNR along the curve."""
    front = trade.front()
    errors = trade.color_error[front]
    even = np.linspace(errors[0], errors[-1], _POINTS)
    chosen = front[np.unique(np.searchsorted(errors, even))]
    weights = [_INFINITE if math.isinf(one) else one for one in trade.weights[chosen].tolist()]
    along = (trade.color_error, trade.visual_noise, trade.snr_y_db)
    values = (one[chosen].tolist() for one in along)
    return [(trade.point.sensor.label, *each) for each in zip(weights, *values, strict=True)]


def _now(analysis: Analysis) -> tuple[Value, ...]:
    """The same of the current matrix."""
    values = mean_color_error(analysis), visual_noise_of(analysis)
    snr_db = defined(SNR_Y.of(analysis.point, analysis.matrix))
    return (analysis.sensor.label, _NOW, *values, snr_db)


def _chart(
    names: Sequence[str],
    rows: Sequence[tuple[Value, ...]],
    columns: tuple[Column, ...],
    labels: tuple[str, str],
    *,
    better: str,
    title: str = "",
    notes: tuple[str, ...] = (),
    why_not: tuple[str, ...] = (),
    with_weights: bool = False,
) -> Chart:
    """A curve per sensor: the error of column 2 against the noise or SNR of column 3.

    ``labels`` name the axes x and y; with ``with_weights`` each point is labeled with its weight.
    """
    marks: list[Mark] = []
    for i, name in enumerate(names):
        mine = [k for k, row in enumerate(rows) if row[0] == name and row[1] != _NOW]
        if not mine:
            continue
        texts = _labels([float(rows[k][1] or 0.0) for k in mine]) if with_weights else ()
        first, last = mine[0], mine[-1] + 1
        marks.append(Line(x=3, y=2, first=first, last=last, name=name, sensor=i, texts=texts))
    for k, row in enumerate(rows):
        if row[1] == _NOW and None not in row[2:4]:
            marks.append(Point(x=3, y=2, row=k, text=_NOW, sensor=names.index(str(row[0]))))
    drawn = np.array([row[2:4] for row in rows if None not in row[2:4]], dtype=float)
    axes = tuple(map(_axis, labels, drawn.T[::-1])) if drawn.size else None
    return Chart(
        title=title,
        description=_description(names, rows, labels),
        sensors=tuple(names),
        columns=columns,
        panels=(Panel(x=axes[0], y=axes[1], marks=tuple(marks), better=better),) if axes else (),
        whole_rows=True,
        named="ends" if len(names) > MOST_DASHED else "legend",
        notes=notes if axes else why_not,
    )


def _columns(rows: Sequence[Sequence[Value]], *numbers: str) -> tuple[Column, ...]:
    names, weights, *values = zip(*rows, strict=True)
    number = partial(decimal, digits=2)
    return (
        column("sensor", names),
        column("weight of the noise", weights, _weight),
        *(column(head, one, number) for head, one in zip(numbers, values, strict=True)),
    )


def _labels(weights: Sequence[float]) -> tuple[str, ...]:
    """The weights at both ends, and between them the powers of ten where there are two such."""
    tens = [weight > 0 and abs(math.log10(weight) % 1) < _WHOLE for weight in weights]
    every, ends = sum(tens) < 2, (0, len(weights) - 1)
    return tuple(
        brief(weight) if every or tens[k] or k in ends else "" for k, weight in enumerate(weights)
    )


def _axis(label: str, drawn: Float[Array, " k"]) -> Axis:
    """An axis of values; one of errors or noise that differ a lot is logarithmic."""
    least, most = float(drawn.min()), float(drawn.max())
    if label.endswith("[dB]"):
        return Axis(label=label, low=least, high=most, zero=True)
    far = most > _MOST_LINEAR * least > 0
    low, high = (_BELOW * max(_LEAST, least), _BEYOND * most) if far else (least, most)
    return Axis(label=label, low=low, high=high, logarithmic=far, exact=far)


def _description(
    names: Sequence[str], rows: Sequence[Sequence[Value]], labels: tuple[str, str]
) -> str:
    parts = ["More weight on the noise gives less noise and more color error."]
    for name in names:
        known = [row for row in rows if row[0] == name and None not in row[2:4]]
        points = [_in_words(row, labels) for row in known if row[1] != _NOW]
        if not points:
            parts.append(f"{name}: no curve.")
            continue
        now = "".join(f"; now {_in_words(row, labels)}" for row in known if row[1] == _NOW)
        parts.append(f"{name}: from {points[0]} to {points[-1]}{now}.")
    return " ".join(parts)


def _in_words(row: Sequence[Any], labels: tuple[str, str]) -> str:
    (what, unit), (error, its) = (label.rstrip("]").split(" [") for label in labels)
    error = error.removesuffix(", mean")
    return f"{what} {decimal(row[3])} {unit} at a mean {error} of {decimal(row[2])} {its}"


def _weight(value: float | str) -> str:
    return value if isinstance(value, str) else brief(value)
