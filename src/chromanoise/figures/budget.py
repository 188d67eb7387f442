"""The dB budget of one coordinate as a waterfall chart."""

from matplotlib.axes import Axes

from chromanoise.charts import cause_label
from chromanoise.charts.text import decimal, signed
from chromanoise.figures.style import INK, QUIET, sensor_label
from chromanoise.metrics import Budget
from chromanoise.sensor import Sensor

_HIGH = 0.62  # of a bar, in rows
_ROOM = 0.14  # of the scale, for the numbers beside the bars


def draw_budget(budget: Budget, sensor: Sensor, ax: Axes, *, top_db: float | None = None) -> Axes:
    """Draw one bar per cause; each bar starts at the end of the bar above it.

    Parameters
    ----------
    budget
        The budget of one coordinate.
    sensor
        The sensor of the budget.
    ax
        Axes of matplotlib to draw on; a new figure if ``None``.
    top_db
        Upper end of the scale, where panels share one. [dB]
    """
    at = budget.photons_db
    _bar(ax, 0, 0.0, at, INK, decimal(at))
    for row, cost in enumerate(budget.costs, 1):
        below = at - cost.loss_db
        fill = QUIET if cost.loss_db >= 0 else "none"
        _bar(ax, row, min(at, below), max(at, below), fill, signed(-cost.loss_db))
        ax.plot([at, at], [row - 1 + _HIGH / 2, row - _HIGH / 2], color=QUIET, linewidth=0.8)
        at = below
    last = len(budget.costs) + 1
    _bar(ax, last, 0.0, budget.snr_db, INK, decimal(budget.snr_db))
    names = [
        "all photons",
        *(cause_label(one.cause, budget.coordinate) for one in budget.costs),
        f"SNR of {budget.coordinate}",
    ]
    ax.set_yticks(range(len(names)), names)
    ax.tick_params(axis="y", length=0)
    ax.set(
        xlim=(min(0.0, budget.snr_db, at), (top_db or budget.photons_db) * (1 + _ROOM)),
        ylim=(last + 0.6, -0.6),
        xlabel="SNR [dB]",
        title=sensor_label(sensor.label, sensor.origin),
    )
    ax.grid(visible=True, axis="x", alpha=0.25)
    return ax


def _bar(ax: Axes, row: int, low: float, high: float, fill: str, text: str) -> None:
    edge = INK if fill == "none" else fill
    ax.barh(row, high - low, left=low, height=_HIGH, facecolor=fill, edgecolor=edge, linewidth=1.2)
    ax.annotate(text, (high, row), xytext=(4, 0), textcoords="offset points", va="center_baseline")
