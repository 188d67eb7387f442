"""The charts of a study by name, as sections of the page and of reports.

A section has its place, heading and caption; a chart can also be written as rows or CSV.
"""

from collections.abc import Callable, Mapping
from typing import Any

from chromanoise.base import check, csv_text, dataclass
from chromanoise.charts.budget_chart import drawn_budget
from chromanoise.charts.charted_study import Look, Shown
from chromanoise.charts.color_checker import drawn_chart
from chromanoise.charts.description import Chart, as_data, csv_rows
from chromanoise.charts.ellipses import drawn_ellipses
from chromanoise.charts.heat_map import drawn_map
from chromanoise.charts.league import drawn_league
from chromanoise.charts.levels import drawn_levels
from chromanoise.charts.pareto_curves import drawn_pareto
from chromanoise.charts.sensitivities import drawn_sensitivities
from chromanoise.charts.sensor_table import drawn_numbers
from chromanoise.charts.stages import drawn_stages
from chromanoise.charts.vectors import drawn_vectors
from chromanoise.charts.verdicts import drawn_head


@dataclass(frozen=True, kw_only=True)
class Section:
    """One chart as a section of the page and of the report.

    Attributes
    ----------
    part
        A name from `chromanoise.charts.DRAWINGS`, or ``picture``.
    shows
        What it shows, in one to three sentences.
    explanations
        Keys of `chromanoise.charts.explanations.EXPLANATIONS`, for its ``?``.
    is_broad
        Whether it needs two columns of the page, such as a chart with a panel for each sensor.
    """

    part: str
    heading: str
    shows: str
    explanations: tuple[str, ...]
    is_broad: bool = False


SECTIONS: tuple[Section, ...] = (
    Section(
        part="picture",
        heading="The picture",
        shows="The same scene, light and time through each sensor.",
        explanations=("picture", "color"),
        is_broad=True,
    ),
    Section(
        part="head",
        heading="Sensors",
        shows="Ranked by the SNR of Y with the chosen matrix; the verdict compares at equal color "
        "error. The electrons are those of a perfect white.",
        explanations=("electrons", "color", "price"),
        is_broad=True,
    ),
    Section(
        part="budget",
        heading="SNR budget",
        shows="From every photon that hits the pixels down to one color coordinate: what each "
        "cause costs.",
        explanations=("budget", "bound", "price"),
        is_broad=True,
    ),
    Section(
        part="vectors",
        heading="Channels as vectors",
        shows="The smaller the angle between two channels, the noisier their unmixing, and the "
        "larger the ellipsoid of uncertainty around the light.",
        explanations=("vectors",),
        is_broad=True,
    ),
    Section(
        part="stages",
        heading="SNR from raw to color",
        shows="The SNR of the same light at each stage: channels as read, unmixed, and as color.",
        explanations=("raw", "contravariant", "spectral", "color", "lab", "bound", "price"),
        is_broad=True,
    ),
    Section(
        part="levels",
        heading="Over the light level",
        shows="With the same exposure time; circles mark where two sensors are equally good.",
        explanations=("levels", "color"),
    ),
    Section(
        part="map",
        heading="Two parameters",
        shows="One quantity for every combination of two parameters.",
        explanations=("map", "color"),
    ),
    Section(
        part="ellipses",
        heading="Noise ellipses of the chart",
        shows="For every patch of the chart: the cross is its true color, the ellipse shows how "
        "far noise moves it.",
        explanations=("ellipses",),
        is_broad=True,
    ),
    Section(
        part="chart",
        heading="Color error and noise",
        shows="For every patch: how far its mean color is off, and how far noise moves it.",
        explanations=("chart",),
    ),
    Section(
        part="pareto",
        heading="Color error against visual noise",
        shows="What the sensor can achieve: each point is a color matrix. The weight of the noise "
        "changes along the curve, and channels that do not help are left out. Sensors are compared "
        "where their color errors are equal.",
        explanations=("pareto",),
    ),
    Section(
        part="league",
        heading="Among measured cameras",
        shows="Each point is a measured camera: color SNR loss (SNR of the best linear readout "
        "minus SNR of Y) against mean color error, in D50. Pixel and read noise have no effect.",
        explanations=("price", "color"),
    ),
    Section(
        part="sensitivities",
        heading="Sensitivities",
        shows="The quantum efficiency of each channel, and the light; the near infrared is shaded.",
        explanations=("electrons",),
        is_broad=True,
    ),
)
"""In the order of the page and of the report."""


PARTS: Mapping[str, Callable[[Shown, Look], Chart | dict[str, Any]]] = {
    "head": drawn_head,
    "sensitivities": drawn_sensitivities,
    "stages": drawn_stages,
    "budget": drawn_budget,
    "vectors": drawn_vectors,
    "ellipses": drawn_ellipses,
    "levels": drawn_levels,
    "chart": drawn_chart,
    "pareto": drawn_pareto,
    "league": drawn_league,
}
"""Names of the charts of every study."""
DRAWINGS: Mapping[str, Callable[[Shown, Look], Chart | dict[str, Any]]] = {
    **PARTS,
    "numbers": drawn_numbers,
    "map": drawn_map,
}
"""`PARTS`, the head without its verdict, and the heat map of a sweep of two parameters."""


def drawing(part: str, of: Shown, look: Look | None = None) -> Any:
    """One chart: a `Chart`, or plain data where its drawing is special; `as_data` of both.

    Parameters
    ----------
    part
        A name from `DRAWINGS`.
    of
        A study as `shown` gives it.
    look
        Options of the charts.

    Raises
    ------
    InputError
        If there is no such chart, or an option does not fit the study.
    """
    return DRAWINGS[check.one_of("part", part, tuple(DRAWINGS))](of, look or Look())


def chart_rows(part: str, record: Chart | Mapping[str, Any]) -> list[list[Any]]:
    """The numbers behind a chart: first a row of headings with units, then the rows.

    Parameters
    ----------
    part
        A name from `DRAWINGS`.
    record
        Of that chart, from `drawing`, or as plain data.

    Returns
    -------
    list
        Rows of text and numbers, ``None`` where a value is undefined; empty if the chart is.

    Raises
    ------
    InputError
        If there is no such chart.
    """
    check.one_of("part", part, tuple(DRAWINGS))
    return csv_rows(as_data(record))


def chart_csv(part: str, record: Chart | Mapping[str, Any]) -> str:
    """`chart_rows` as CSV (RFC 4180, lines end in LF); an undefined value is an empty cell.

    Text that a spreadsheet would interpret as a formula is prefixed with an apostrophe.

    Parameters
    ----------
    part, record
        As `chart_rows`.

    Raises
    ------
    InputError
        If there is no such chart.
    """
    return csv_text(chart_rows(part, record))
