"""The figures of a study, with the charts of its report, for papers and slides."""

from collections.abc import Mapping, Sequence
from textwrap import fill

from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from chromanoise.analysis import Crossover, coordinate_budget
from chromanoise.analysis.comparison.ranking import lead_changes, leads
from chromanoise.charts import Shown, drawing
from chromanoise.charts.charted_study import unclipped_remark
from chromanoise.charts.maps import sweep_maps
from chromanoise.charts.snr_over_light import level_curves
from chromanoise.exposure import conditions, light_and_exposure
from chromanoise.figures.budget import draw_budget
from chromanoise.figures.comparison import draw_color_errors, draw_comparison
from chromanoise.figures.ellipses import draw_ellipses
from chromanoise.figures.maps import draw_maps
from chromanoise.figures.pareto import draw_pareto
from chromanoise.figures.sensitivities import draw_sensitivities
from chromanoise.figures.style import are_many, chromanoise_style, sensor_dashes

_WIDE_IN = 6.4
_LETTERS_PER_IN = 13  # of a title
_PANELS = 3  # ellipses side by side


def study_figures(of: Shown) -> Mapping[str, Figure]:
    """Sensitivities, comparison over the light level, budget, ellipses and Pareto curve, by name.

    Each sweep of two parameters is a heat map besides: ``map-1`` and so on.

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
            "sensitivities": _sensitivities(of),
            "comparison": _comparison(of),
            "budget": _budget(of),
            "ellipses": _ellipses(of),
            "pareto": _pareto(of),
            **map_figures(of),
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
            figures[f"map-{i}"] = figure = _framed(4.2)
            title = f"{one.maps[0].quantity.what}, from {conditions(of.operating_points)}"
            draw_maps(one.maps, figure.add_subplot(), title=title)
    return figures


def _framed(height_in: float, width_in: float = _WIDE_IN) -> Figure:
    engine = ConstrainedLayoutEngine(w_pad=0.075, h_pad=0.075)
    return Figure(figsize=(width_in, height_in), layout=engine)


def _entitle(figure: Figure, title: str) -> None:
    """Draw a title over all panels, wrapped to the width of the figure."""
    letters = int(_LETTERS_PER_IN * figure.get_figwidth())
    lines = fill(title, letters, break_on_hyphens=False)
    figure.suptitle(lines, x=0.02, ha="left", fontsize=9)


def _sensitivities(of: Shown) -> Figure:
    sensors = [one.sensor for one in of.operating_points]
    figure = _framed(2.8 * len(sensors))
    highest = 1.15 * max(float(sensor.qe.max()) for sensor in sensors)
    panels = figure.subplots(len(sensors), 1, sharex=True, squeeze=False)[:, 0]
    names = [sensor.label for sensor in sensors]
    patterns = dict.fromkeys(names, "solid") if are_many(names) else sensor_dashes(names)
    for sensor, ax in zip(sensors, panels, strict=True):
        draw_sensitivities(sensor, ax, top=highest, dashes=patterns[sensor.label])
    for ax in panels[:-1]:
        ax.set_xlabel("")
    return figure


def _comparison(of: Shown) -> Figure:
    curves, pairs = level_curves(of)
    figure = _framed(5.6)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    crossed: Sequence[Crossover] = [pair for pair in pairs if isinstance(pair, Crossover)]
    if are_many(curve.label for curve in curves):
        crossed = lead_changes(leads(curves, crossed), crossed)
    title = (
        f"{curves[0].quantity.what} against illuminance ({light_and_exposure(of.operating_points)})"
        f"{unclipped_remark(of)}"
    )
    draw_comparison(curves, above, crossovers=crossed, title=title).set_xlabel("")
    draw_color_errors(curves, below)
    return figure


def _budget(of: Shown) -> Figure | None:
    found = [(one, coordinate_budget(one, "Y")) for one in of.analyses]
    budgets = [(one.sensor, budget) for one, budget in found if budget is not None]
    if not budgets:
        return None
    figure = _framed(2.6 * len(budgets))
    highest = max(budget.photons_db for _, budget in budgets)
    panels = figure.subplots(len(budgets), 1, sharex=True, squeeze=False)[:, 0]
    for (sensor, budget), ax in zip(budgets, panels, strict=True):
        draw_budget(budget, sensor, ax, top_db=highest)
    for ax in panels[:-1]:
        ax.set_xlabel("")
    _entitle(figure, f"Budget of the SNR of Y at {conditions(of.operating_points)}")
    return figure


def _ellipses(of: Shown) -> Figure | None:
    data = drawing("ellipses", of)
    shown = [i for i, sensor in enumerate(data["sensors"]) if sensor["patches"]]
    if not shown:
        return None
    rows, columns = -(-len(shown) // _PANELS), min(_PANELS, len(shown))
    figure = _framed(4.6 * rows, 3.6 * columns)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for i, ax in zip(shown, panels.flat, strict=False):
        draw_ellipses(data, i, ax)
    for ax in panels.flat[len(shown) :]:
        ax.set_axis_off()
    for ax in panels[:, 1:].flat:
        ax.set_ylabel("")
    _entitle(figure, data["title"])
    return figure


def _pareto(of: Shown) -> Figure:
    figure = _framed(4.0)
    draw_pareto(drawing("pareto", of), figure.add_subplot())
    return figure
