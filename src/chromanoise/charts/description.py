"""A chart as one description: columns of numbers, and panels with axes and marks over them.

Every number is in one column. A mark names its columns by index and its rows by a range, so table,
CSV, drawing and the value read at a mark agree. ``draw/plane.js`` draws a chart in SVG,
`chromanoise.charts.figure_marks` with Matplotlib, `Chart.table` and `Chart.csv_rows` write it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, Literal

from chromanoise.base import check, dataclass

MOST_DASHED = 3
"""Up to this number of sensors, curves differ by their dashes; above it, each has a color."""

Value = float | str | None
"""A number, a name, or ``None`` where a value is undefined."""


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column of the numbers of a chart.

    Attributes
    ----------
    head
        Its heading in the CSV, with the unit; ``None`` for a column of the table alone.
    shown
        Its heading in the table; ``None`` for a column of the CSV alone.
    values
        A value per row.
    texts
        The values as the table shows them; empty where it does not.
    """

    head: str | None
    shown: str | None
    values: tuple[Value, ...]
    texts: tuple[str, ...]

    def __post_init__(self) -> None:
        texts = len(self.values if self.shown is None else self.texts)
        check.same_length("rows of a column", values=len(self.values), texts=texts)


def column(
    head: str | None,
    values: Sequence[Value],
    text: Callable[[Any], str] | Sequence[str] | None = str,
    *,
    shown: str | None = None,
) -> Column:
    """A column whose heading is the same in CSV and table.

    Parameters
    ----------
    head
        Heading of the CSV; ``None`` for a column of the table alone.
    values
        A value per row.
    text
        The text of a value in the table, or all texts; ``None`` for a column of the CSV alone.
    shown
        Another heading of the table.
    """
    title = shown or (head or "").replace("Delta E", "ΔE").replace("[e-", "[e⁻")
    return Column(
        head=head,
        shown=None if text is None else title,
        values=tuple(values),
        texts=tuple(map(text, values)) if callable(text) else tuple(text or ()),
    )


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One axis of a panel.

    Attributes
    ----------
    label
        What it shows, with the unit.
    low, high
        Ends that contain all marks. [unit of the label]
    logarithmic
        Whether its scale is.
    exact
        Whether it ends there, and not at the next round numbers.
    zero
        Whether 0 has a line of its own.
    """

    label: str
    low: float
    high: float
    logarithmic: bool = False
    exact: bool = False
    zero: bool = False


NO_AXIS = Axis(label="", low=0.0, high=1.0)
"""The axis of marks that need none."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """A curve.

    Attributes
    ----------
    x, y
        Indices of its columns.
    first, last
        Its rows, without ``last``.
    name
        Its name in the legend, or beside its end.
    sensor
        Index of its sensor, for color, dash and mark.
    matrix
        Index of its color matrix.
    channel
        The channel whose color and letter it has; empty for none.
    texts
        A text per row, written at the curve where there is room; empty for a curve without dots.
    """

    x: int
    y: int
    first: int
    last: int
    name: str
    sensor: int
    matrix: int = 0
    channel: str = ""
    texts: tuple[str, ...] = ()
    kind: Literal["line"] = "line"


@dataclass(frozen=True, kw_only=True)
class Point:
    """One point with the large mark of its sensor.

    Attributes
    ----------
    x, y
        Indices of its columns.
    sensor
        Index of its sensor.
    """

    x: int
    y: int
    row: int
    text: str
    sensor: int
    kind: Literal["point"] = "point"


@dataclass(frozen=True, kw_only=True)
class Cloud:
    """Points that belong to no sensor of the study, as a background.

    Attributes
    ----------
    x, y
        Indices of its columns.
    first, last
        Its rows, without the last.
    name
        What they are.
    """

    x: int
    y: int
    first: int
    last: int
    name: str
    kind: Literal["cloud"] = "cloud"


@dataclass(frozen=True, kw_only=True)
class Ellipses:
    """Ellipses around measured values, each with a cross at its true value.

    Attributes
    ----------
    truth, center
        Indices of the columns across and up.
    half_axes
        Indices of the columns across and up of two conjugate half axes.
    reach
        Index of the column of the longer half axis.
    first, last
        Its rows, without ``last``.
    colors
        A fill per row, as ``#rrggbb``.
    """

    truth: tuple[int, int]
    center: tuple[int, int]
    half_axes: tuple[int, int, int, int]
    reach: int
    first: int
    last: int
    colors: tuple[str, ...]
    kind: Literal["ellipses"] = "ellipses"


@dataclass(frozen=True, kw_only=True)
class Area:
    """A faint area from the bottom up, as high as the panel where its column is 1.

    Attributes
    ----------
    x, y
        Indices of its columns.
    first, last
        Its rows, without ``last``.
    name
        Its name in the legend.
    """

    x: int
    y: int
    first: int
    last: int
    name: str
    kind: Literal["area"] = "area"


@dataclass(frozen=True, kw_only=True)
class Band:
    """A shaded range across, from ``low`` to the end of the axis.

    Attributes
    ----------
    low
        Where it begins. [unit of the axis]
    name
        Its name in the legend.
    """

    low: float
    name: str
    kind: Literal["band"] = "band"


@dataclass(frozen=True, kw_only=True)
class Rule:
    """An upright line.

    Attributes
    ----------
    at
        Its place across. [unit of the axis]
    role
        ``now`` for the setting of the study, which a slider may move before the answer comes;
        ``crossing`` for one that has a number, whose sentence is in `Chart.numbered`.
    height
        Where curves meet on it; ``None`` for no such place. [unit of the axis up]
    """

    at: float
    role: Literal["now", "crossing"]
    text: str
    height: float | None = None
    kind: Literal["rule"] = "rule"


Role = Literal["total", "cost", "gain"]
"""What a bar of a waterfall is; a ``total`` begins at 0."""


@dataclass(frozen=True, kw_only=True)
class Bars:
    """A bar per row along the axis across, one under the other: a waterfall.

    Attributes
    ----------
    label, start, end
        Indices of the columns of its name and of both its ends.
    first, last
        Its rows, without ``last``.
    texts
        Written beside each bar.
    """

    label: int
    start: int
    end: int
    first: int
    last: int
    roles: tuple[Role, ...]
    texts: tuple[str, ...]
    kind: Literal["bars"] = "bars"


@dataclass(frozen=True, kw_only=True)
class Dots:
    """A line of marks per row along the axis across, one mark per sensor, with their numbers.

    Attributes
    ----------
    label
        Index of the column of names.
    values
        Index of the column of each sensor.
    first, last
        Its rows, without ``last``.
    """

    label: int
    values: tuple[int, ...]
    first: int
    last: int
    kind: Literal["dots"] = "dots"


@dataclass(frozen=True, kw_only=True)
class Swatches:
    """Cells of one size, six side by side, one per row: what one sensor makes of each patch.

    Attributes
    ----------
    colors
        A fill per row, as ``#rrggbb``; empty where the sensor shows none.
    sensor
        Index of the sensor; ``None`` for the true colors.
    texts
        Two short texts per row.
    name
        Its entry in the legend.
    """

    colors: tuple[str, ...]
    sensor: int | None = None
    texts: tuple[tuple[str, str], ...] = ()
    name: str = ""
    kind: Literal["swatches"] = "swatches"


@dataclass(frozen=True, kw_only=True)
class Cells:
    """A colored cell per row, on a grid over both axes; rows go across first.

    Attributes
    ----------
    x, y, value
        Indices of its columns; the value chooses the color.
    across
        Number of cells side by side.
    name
        What the colors show.
    low, high
        Values of the first and of the last color.
    colors
        Colors at equal distances of the value.
    names
        What each color stands for, empty for one that is nowhere; none of a scale of values.
    equal
        Lines along which two sensors are equal, as points across and up.
    """

    x: int
    y: int
    value: int
    across: int
    name: str
    low: float
    high: float
    colors: tuple[str, ...]
    names: tuple[str, ...] = ()
    equal: tuple[tuple[tuple[float, float], ...], ...] = ()
    kind: Literal["cells"] = "cells"


Mark = Line | Point | Cloud | Ellipses | Area | Band | Rule | Bars | Dots | Swatches | Cells
"""What a panel can show, drawn in the order of its list."""


@dataclass(frozen=True, kw_only=True)
class Panel:
    """Marks, and the axes that they need.

    Attributes
    ----------
    x, y
        Its axes; panels with both have the same.
    title, remark
        Said over it, and in its upper right corner or beside the title.
    explanation
        Key of `chromanoise.charts.explanations.EXPLANATIONS`, for its ``?``; empty for none.
    description
        The panel in words for screen readers, where it is a figure of its own.
    sensor
        Index of the sensor that it is of; ``None`` for one panel of all sensors.
    equal
        Whether a unit is as long across as up.
    better
        Sign of the corner where both axes are best; empty for none.
    absence
        Why it shows nothing.
    """

    marks: tuple[Mark, ...]
    x: Axis = NO_AXIS
    y: Axis = NO_AXIS
    title: str = ""
    remark: str = ""
    explanation: str = ""
    description: str = ""
    sensor: int | None = None
    equal: bool = False
    better: str = ""
    absence: str = ""


@dataclass(frozen=True, kw_only=True)
class Chart:
    """One chart.

    Attributes
    ----------
    title
        What it shows, and at which operating point.
    description
        The same in words for screen readers, with its main numbers.
    sensors
        Names of the sensors; marks have their indices.
    panels
        What is drawn; none where nothing can be, for the reasons in ``notes``.
    whole_rows
        Whether a value is read with its whole row, and not with the first column alone.
    named
        Where the curves have their names: at their ends where there is room, or in a legend.
    numbered
        Sentences for the rules that have a number, in the order of their places.
    without_numbers
        Rows of the table that are not in the CSV.
    """

    title: str
    description: str
    sensors: tuple[str, ...]
    columns: tuple[Column, ...]
    panels: tuple[Panel, ...]
    whole_rows: bool = False
    named: Literal["ends", "legend"] = "legend"
    numbered: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    without_numbers: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        check.same_length("columns", **{f"{i}": len(c.values) for i, c in enumerate(self.columns)})

    @property
    def table(self) -> dict[str, Any]:
        """``head`` and ``rows`` as text."""
        shown = [one for one in self.columns if one.shown is not None]
        rows = zip(*(one.texts for one in shown), strict=True)
        return {"head": [one.shown for one in shown], "rows": [list(row) for row in rows]}

    @property
    def csv_rows(self) -> list[list[Any]]:
        """A row of headings with units, then the rows to full precision."""
        return csv_rows(as_data(self))


def csv_rows(data: Mapping[str, Any]) -> list[list[Any]]:
    """`Chart.csv_rows` of a chart as plain data (`as_data`); empty of a chart without numbers."""
    named = [one for one in data["columns"] if one["head"] is not None]
    if not named:
        return []
    rows = zip(*(one["values"] for one in named), strict=True)
    left_out = data.get("without_numbers", ())
    kept = [list(row) for i, row in enumerate(rows) if i not in left_out]
    return [[one["head"] for one in named], *kept]


def numbers_of(rows: Sequence[Sequence[Value]]) -> dict[str, Any]:
    """Rows under a row of headings as the columns of a CSV, for a chart that is plain data."""
    head, *more = rows
    columns = zip(head, zip(*more, strict=True), strict=True)
    return {"columns": [as_data(column(str(name), one, None)) for name, one in columns]}


def as_data(noun: Any) -> Any:
    """A chart and its parts as plain data, for JSON; a chart has its ``table`` instead of texts."""
    if is_dataclass(noun):
        data = {name: as_data(getattr(noun, name)) for name in data_fields(type(noun))}
        return data | ({"table": noun.table} if isinstance(noun, Chart) else {})
    if isinstance(noun, tuple | list):
        return [as_data(one) for one in noun]
    return noun


def data_fields(noun: type) -> tuple[str, ...]:
    """The fields of a class of this module that `as_data` keeps."""
    names = [one.name for one in fields(noun)]
    return tuple(name for name in names if not (noun is Column and name == "texts"))
