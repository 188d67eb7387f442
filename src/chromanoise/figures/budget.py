"""The dB budget of one coordinate as a waterfall chart."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from chromanoise.charts import cause_label
from chromanoise.charts.text import decimal, signed
from chromanoise.figures.style import INK, QUIET, mark_zero, sensor_label
from chromanoise.metrics import Budget
from chromanoise.sensor import Sensor

_HIGH = 0.62  # of a bar, in rows
_ROOM = 0.16  # of the scale, for the numbers beside the bars


def budget_limits_db(budgets: Sequence[Budget]) -> tuple[float, float]:
    """The scale that holds all bars of some budgets from 0 dB, and the numbers beside them."""
    ends = [0.0]
    for budget in budgets:
        losses = [cost.loss_db for cost in budget.costs]
        ends += [budget.snr_db, *(budget.photons_db - np.cumsum([0.0, *losses])).tolist()]
    low, high = min(ends), max(ends)
    return low - (0.03 * (high - low) if low < 0 else 0.0), high + _ROOM * (high - low)


def draw_budget(
    budget: Budget, sensor: Sensor, ax: Axes, *, limits_db: tuple[float, float] | None = None
) -> Axes:
    """Draw one bar per cause; each bar starts at the end of the bar above it.

    Parameters
    ----------
    budget
        The budget of one coordinate.
    sensor
        The sensor of the budget.
    ax
        Axes of matplotlib to draw on.
    limits_db
        Ends of the scale, where panels share one; ``None`` for those of this budget. [dB]
    """
    at = budget.photons_db
    _bar(ax, 0, min(0.0, at), max(0.0, at), INK, decimal(at))
    for row, cost in enumerate(budget.costs, 1):
        below = at - cost.loss_db
        fill = QUIET if cost.loss_db >= 0 else "none"
        _bar(ax, row, min(at, below), max(at, below), fill, signed(-cost.loss_db))
        ax.plot([at, at], [row - 1 + _HIGH / 2, row - _HIGH / 2], color=QUIET, linewidth=0.8)
        at = below
    last = len(budget.costs) + 1
    end = budget.snr_db
    _bar(ax, last, min(0.0, end), max(0.0, end), INK, decimal(end))
    names = [
        "all photons",
        *(cause_label(one.cause, budget.coordinate) for one in budget.costs),
        f"SNR of {budget.coordinate}",
    ]
    ax.set_yticks(range(len(names)), names)
    ax.tick_params(axis="y", length=0)
    ax.set(
        xlim=limits_db or budget_limits_db([budget]),
        ylim=(last + 0.6, -0.6),
        xlabel="SNR [dB]",
        title=sensor_label(sensor.label, sensor.origin),
    )
    ax.set_axisbelow(True)
    ax.grid(visible=True, axis="x", alpha=0.25)
    mark_zero(ax, axis="x")
    return ax


def _bar(ax: Axes, row: int, low: float, high: float, fill: str, text: str) -> None:
    edge = INK if fill == "none" else fill
    ax.barh(row, high - low, left=low, height=_HIGH, facecolor=fill, edgecolor=edge, linewidth=1.2)
    ax.annotate(text, (high, row), xytext=(4, 0), textcoords="offset points", va="center_baseline")
