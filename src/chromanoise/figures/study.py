"""The figures of a study, with the charts of its report, for papers and slides."""

from collections.abc import Mapping, Sequence
from textwrap import fill

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chromanoise.analysis import Crossover, coordinate_budget
from chromanoise.analysis.comparison.ranking import lead_changes, leads
from chromanoise.charts import Shown, drawing
from chromanoise.charts.charted_study import unclipped_remark
from chromanoise.charts.maps import sweep_maps
from chromanoise.charts.sections import SECTIONS
from chromanoise.charts.snr_over_light import level_curves
from chromanoise.exposure import conditions, light_and_exposure
from chromanoise.figures.budget import budget_limits_db, draw_budget
from chromanoise.figures.comparison import draw_color_errors, draw_comparison
from chromanoise.figures.ellipses import draw_ellipses
from chromanoise.figures.maps import draw_maps
from chromanoise.figures.pareto import draw_pareto
from chromanoise.figures.sensitivities import draw_sensitivities
from chromanoise.figures.style import (
    are_many,
    chromanoise_style,
    framed_figure,
    sensor_dashes,
    write_sensor,
)

_WIDE_IN = 6.4
_LETTERS_PER_IN = 13  # of a title
_SMALL = 6.5  # of the words of a panel of many
_WIDEST_IN = 7.2  # of many sensors: A4 and Letter without margins
_MARK_LETTERS = 6  # before a name, and of the ticks


def study_figures(of: Shown) -> Mapping[str, Figure]:
    """Budget, comparison over the light level, ellipses, Pareto curve and sensitivities, by name.

    In the order of the page and of the report, with their headings and marks. Each sweep of two
    parameters is a heat map besides: ``map-1`` and so on.

    A figure without data for any sensor, e.g. the budget of saturated sensors, is omitted.

    Parameters
    ----------
    of
        A study from `chromanoise.charts.charted_study`.

    Raises
    ------
    InputError
        If one of them cannot be computed.
    """
    with chromanoise_style():
        figures = {
            "budget": _budget(of),
            "comparison": _comparison(of),
            **map_figures(of),
            "ellipses": _ellipses(of),
            "pareto": _pareto(of),
            "sensitivities": _sensitivities(of),
        }
    return {name: figure for name, figure in figures.items() if figure is not None}


def map_figures(of: Shown) -> dict[str, Figure]:
    """A heat map per sweep of two parameters: ``map-1`` and so on.

    Parameters
    ----------
    of
        As `study_figures`.

    Raises
    ------
    InputError
        If one of them cannot be computed.
    """
    figures = {}
    with chromanoise_style():
        for i, one in enumerate(sweep_maps(of), 1):
            figures[f"map-{i}"] = figure = framed_figure(_WIDE_IN, 4.2)
            title = f"{one.maps[0].quantity.what}, from {conditions(of.operating_points)}"
            draw_maps(one.maps, figure.add_subplot(), title=title)
    return figures


def _entitle(figure: Figure, part: str, title: str = "") -> None:
    """Draw the heading of a chart and its title over all panels, in the width of the figure."""
    heading = next(one.heading for one in SECTIONS if one.part == part)
    letters = int(_LETTERS_PER_IN * figure.get_figwidth())
    lines = fill(title, letters, break_on_hyphens=False)
    figure.suptitle(f"{heading}\n{lines}".strip(), x=0.02, ha="left", fontsize=9)


def _panels(
    of: Shown, count: int, *, row_in: float, columns: int = 1
) -> tuple[Figure, list[Axes], int]:
    """A figure with panels in one column or, of more than three sensors, in two; letters of each.

    Ten sensors fit a page.
    """
    width_in = _WIDE_IN
    if are_many(one.sensor.label for one in of.operating_points):
        columns, width_in, row_in = max(2, columns), _WIDEST_IN, 0.7 * row_in
    rows = -(-count // columns)
    figure = framed_figure(width_in, 0.4 + row_in * rows)
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    for ax in axes[count:]:
        ax.set_axis_off()
    return figure, axes[:count], int(_LETTERS_PER_IN * width_in / columns) - _MARK_LETTERS


def _sensitivities(of: Shown) -> Figure:
    sensors = [one.sensor for one in of.operating_points]
    figure, panels, letters = _panels(of, len(sensors), row_in=2.8)
    highest = 1.15 * max(float(sensor.qe.max()) for sensor in sensors)
    names = [sensor.label for sensor in sensors]
    patterns = dict.fromkeys(names, "solid") if are_many(names) else sensor_dashes(names)
    for i, (sensor, ax) in enumerate(zip(sensors, panels, strict=True)):
        draw_sensitivities(sensor, ax, top=highest, dashes=patterns[sensor.label])
        write_sensor(ax, sensor.origin, i, names, letters=letters)
        if are_many(names):
            ax.set_ylabel("QE [e$^-$/photon]", fontsize=7)
            ax.set_xlabel("wavelength [nm]" if i >= len(names) - 2 else "")
    _entitle(figure, "sensitivities")
    return figure


def _comparison(of: Shown) -> Figure:
    curves, pairs = level_curves(of)
    many = are_many(curve.label for curve in curves)
    figure = framed_figure(_WIDEST_IN if many else _WIDE_IN, 5.8)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    crossed: Sequence[Crossover] = [pair for pair in pairs if isinstance(pair, Crossover)]
    if many:
        crossed = lead_changes(leads(curves, crossed), crossed)
    title = (
        f"{curves[0].quantity.what} against illuminance ({light_and_exposure(of.operating_points)})"
        f"{unclipped_remark(of)}"
    )
    draw_comparison(curves, above, crossovers=crossed).set_xlabel("")
    draw_color_errors(curves, below)
    _entitle(figure, "levels", title)
    return figure


def _budget(of: Shown) -> Figure | None:
    found = [(i, one, coordinate_budget(one, "Y")) for i, one in enumerate(of.analyses)]
    budgets = [(i, one.sensor, budget) for i, one, budget in found if budget is not None]
    if not budgets:
        return None
    figure, panels, letters = _panels(of, len(budgets), row_in=2.6)
    limits_db = budget_limits_db([budget for _, _, budget in budgets])
    names = [one.sensor.label for one in of.analyses]
    for (i, sensor, budget), ax in zip(budgets, panels, strict=True):
        draw_budget(budget, sensor, ax, limits_db=limits_db)
        write_sensor(ax, sensor.origin, i, names, letters=letters - 12)
        if are_many(names):
            ax.tick_params(axis="y", labelsize=_SMALL)
            for text in ax.texts:
                text.set_fontsize(_SMALL)
    if are_many(names):
        for ax in panels[:-2]:
            ax.set_xlabel("")
    _entitle(figure, "budget", f"Budget of the SNR of Y at {conditions(of.operating_points)}")
    return figure


def _ellipses(of: Shown) -> Figure | None:
    data = drawing("ellipses", of)
    shown = [i for i, sensor in enumerate(data["sensors"]) if sensor["patches"]]
    if not shown:
        return None
    names = [sensor["name"] for sensor in data["sensors"]]
    columns = min(4 if are_many(names) else 3, len(shown))
    figure, panels, letters = _panels(of, len(shown), row_in=4.2, columns=columns)
    if not are_many(names):
        figure.set_figwidth(3.6 * columns)
    for i, ax in zip(shown, panels, strict=True):
        draw_ellipses(data, i, ax)
        write_sensor(ax, "", i, names, letters=letters)
    for k, ax in enumerate(panels):
        if k % columns:
            ax.set_ylabel("")
    _entitle(figure, "ellipses", data["title"])
    return figure


def _pareto(of: Shown) -> Figure:
    data = drawing("pareto", of)
    many = are_many(sensor["name"] for sensor in data["sensors"])
    figure = framed_figure(*((_WIDEST_IN, 5.0) if many else (_WIDE_IN, 4.2)))
    draw_pareto(data, figure.add_subplot())
    _entitle(figure, "pareto")
    return figure
