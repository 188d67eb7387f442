"""The dB budget of one coordinate as a waterfall chart."""

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes

from chromanoise.charts.budget import budget_steps
from chromanoise.figures.style import INK, QUIET, mark_zero, sensor_label, write_beside
from chromanoise.metrics import Budget
from chromanoise.sensor import Sensor

_HIGH = 0.62  # of a bar, in rows
_ROOM = 0.16  # of the scale, for the numbers beside the bars


def budget_limits_db(budgets: Sequence[Budget]) -> tuple[float, float]:
    """The scale that holds all bars of some budgets from 0 dB, and the numbers beside them."""
    ends = [step["to_db"] for budget in budgets for step in budget_steps(budget)]
    low, high = min(0.0, *ends), max(0.0, *ends)
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
    steps = budget_steps(budget)
    for row, step in enumerate(steps):
        is_change = step["kind"] in ("cost", "gain")
        start, end = step["from_db"] if is_change else 0.0, step["to_db"]
        fill = {"cost": QUIET, "gain": "none"}.get(step["kind"], INK)
        edge = INK if fill == "none" else fill
        look: dict[str, Any] = {"facecolor": fill, "edgecolor": edge, "linewidth": 1.2}
        ax.barh(row, abs(end - start), left=min(start, end), height=_HIGH, **look)
        write_beside(ax, step["text"], (max(start, end), row), (4, 0), va="center_baseline")
        if is_change:
            ends = [row - 1 + _HIGH / 2, row - _HIGH / 2]
            ax.plot([start, start], ends, color=QUIET, linewidth=0.8)
    ax.set_yticks(range(len(steps)), [step["label"] for step in steps])
    ax.tick_params(axis="y", length=0)
    ax.set(
        xlim=limits_db or budget_limits_db([budget]),
        ylim=(len(steps) - 0.4, -0.6),
        xlabel="SNR [dB]",
        title=sensor_label(sensor.label, sensor.origin),
    )
    ax.set_axisbelow(True)
    ax.grid(visible=True, axis="x", alpha=0.25)
    mark_zero(ax, axis="x")
    return ax
