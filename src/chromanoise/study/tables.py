"""Results as tables: a title, columns with units and digits, rows of numbers and words."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from chromanoise import _check
from chromanoise._check import InputError
from chromanoise.color import ColorMatrix
from chromanoise.merit import MatrixReport
from chromanoise.sensor import left_out_of_closed_form
from chromanoise.study.analysis import Analysis, color_price_db, color_snr_db, mean_color_error
from chromanoise.study.comparing.curves import Curve
from chromanoise.study.defined import defined
from chromanoise.study.paper.layout import PaperTable

Entry = float | int | str | bool | None
"""One cell; ``None`` where a quantity is not defined."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column of a table.

    Attributes
    ----------
    name
        What it is.
    unit
        Of its numbers; empty for words and for numbers without a unit.
    digits
        How its numbers are written, in Python's format language: ``.2f`` two decimals, ``.4g`` four
        digits; empty for all that tell the number from its neighbors.

    Raises
    ------
    InputError
        If the name is empty or the digits are no format of a number.
    """

    name: str
    unit: str = ""
    digits: str = ""

    def __post_init__(self) -> None:
        if not self.name.strip():
            raise InputError("a column of a table needs a name")
        try:
            format(1.0, self.digits)
        except ValueError:
            raise InputError(
                f"digits of column {self.name} must be a format as .2f or .4g, not {self.digits!r}"
            ) from None


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows of cells under columns.

    Attributes
    ----------
    title
        What it shows.
    columns
        Name, unit and digits of each.
    rows
        One cell per column; ``None`` where a quantity is not defined.
    notes
        What a reader must know.

    Raises
    ------
    InputError
        If a row is not as long as the columns, or a number is not finite.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Entry, ...], ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check.distinct(f"columns of table {self.title!r}", [c.name for c in self.columns])
        for i, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                raise InputError(
                    f"table {self.title!r}: row {i} (from 0) has {len(row)} cells for "
                    f"{len(self.columns)} columns"
                )
            for column, cell in zip(self.columns, row, strict=True):
                if isinstance(cell, float) and not math.isfinite(cell):
                    raise InputError(
                        f"table {self.title!r}: {column.name} in row {i} (from 0) is {cell}; "
                        "what is not defined is None"
                    )


def written(cell: Entry, digits: str) -> str:
    """A cell as text, its number with the digits of its column; nothing for ``None``.

    Examples
    --------
    >>> written(26.1234, ".1f"), written("Y", ".1f"), written(None, ".1f"), written(0.1, "")
    ('26.1', 'Y', '', '0.1')
    """
    if cell is None:
        return ""
    if isinstance(cell, bool | str):
        return str(cell)
    text = format(cell, digits) if digits else repr(cell)
    # a small negative number rounds to "-0.0", which no reader wants to meet
    return text.removeprefix("-") if float(text.replace("%", "")) == 0 else text


def paper_as_table(table: PaperTable) -> Table:
    """One of the paper's tables: printed, closed form, Monte Carlo and its error per column."""
    columns = [Column(name="row"), Column(name="unit")]
    for name in table.columns:
        columns += [
            Column(name=f"{name} printed", digits=".2f"),
            Column(name=f"{name} closed form", digits=".2f"),
            Column(name=f"{name} Monte Carlo", digits=".2f"),
            Column(name=f"{name} error", digits=".2g"),
        ]
    rows = []
    for name, cells in table.rows:
        units = [cell.unit for cell in cells if cell is not None]
        row: list[Entry] = [name, units[0] if units else ""]
        for cell in cells:
            row += (
                [cell.paper, cell.closed_form, cell.monte_carlo, cell.monte_carlo_se]
                if cell is not None
                else [None] * 4
            )
        rows.append(tuple(row))
    return Table(title=table.title, columns=tuple(columns), rows=tuple(rows))


def analyses_as_table(analyses: Sequence[Analysis]) -> Table:
    """One row per sensor: exposure, SNR of color, bound, price, condition, color error.

    Raises
    ------
    InputError
        If there are none, or they have not the same color coordinates.
    """
    if not analyses:
        raise InputError("a table of analyses needs at least one")
    axes = analyses[0].color.names
    for analysis in analyses:
        _check.same_names("a table of analyses", first=axes, other=analysis.color.names)
    columns = (
        Column(name="sensor"),
        Column(name="time", unit="ms", digits=".4g"),
        *(Column(name=f"SNR {axis}", unit="dB", digits=".1f") for axis in axes),
        Column(name="bound", unit="dB", digits=".1f"),
        Column(name="price", unit="dB", digits=".1f"),
        Column(name="condition", digits=".4g"),
        Column(name="color error", unit="Delta E*ab", digits=".2f"),
    )
    return Table(
        title="SNR of color",
        columns=columns,
        rows=tuple(_analysis_row(analysis) for analysis in analyses),
        notes=tuple(
            dict.fromkeys(
                note
                for a in analyses
                for note in (*a.sensor.notes, *left_out_of_closed_form(a.sensor))
            )
        ),
    )


def matrix_as_table(matrix: ColorMatrix, report: MatrixReport, sensor_name: str) -> Table:
    """A color matrix, one row per coordinate; what it is worth stands in the notes."""
    columns = [Column(name=name, unit="lx/e-") for name in matrix.channels]
    rows = zip(matrix.coordinates, matrix.matrix.tolist(), strict=True)
    notes = [
        f"mean color error without noise {written(report.color_error_mean, '.4g') or 'not defined'}"
        " Delta E*ab over the ColorChecker",
        f"condition {written(defined(report.condition), '.4g') or 'not defined'}",
    ]
    for name, snr in (report.snr_db or {}).items():
        notes.append(f"SNR {name} of a perfect white {written(snr, '.2f') or 'not defined'} dB")
    return Table(
        title=f"{report.made_by} of {sensor_name}",
        columns=(Column(name="coordinate"), *columns),
        rows=tuple((name, *row) for name, row in rows),
        notes=tuple(notes),
    )


def curves_as_table(curves: Sequence[Curve]) -> Table:
    """A comparison: one row per value of the sweep, two columns per sensor and matrix.

    Raises
    ------
    InputError
        If there are none, or they are not of one sweep.
    """
    if not curves:
        raise InputError("a table of curves needs at least one")
    first = curves[0]
    for curve in curves:
        if curve.at.tolist() != first.at.tolist() or curve.sweep.name != first.sweep.name:
            raise InputError(
                f"a table of curves needs one sweep, but {curve.sensor} differs from {first.sensor}"
            )
    columns = [Column(name=first.sweep.what, unit=first.sweep.unit, digits=".4g")]
    for curve in curves:
        who = f"{curve.sensor}, {curve.matrix}"
        columns += [
            Column(name=f"{who}: {curve.quantity.what}", unit=curve.quantity.unit, digits=".4g"),
            Column(name=f"{who}: color error", unit="Delta E*ab", digits=".2f"),
        ]
    rows = []
    for i, at in enumerate(first.at.tolist()):
        row: list[Entry] = [at]
        for curve in curves:
            row += [defined(float(curve.value[i])), defined(float(curve.color_error[i]))]
        rows.append(tuple(row))
    return Table(
        title=f"{first.quantity.what} over {first.sweep.what}",
        columns=tuple(columns),
        rows=tuple(rows),
    )


def _analysis_row(analysis: Analysis) -> tuple[Entry, ...]:
    snr = color_snr_db(analysis)
    usable = not bool(analysis.saturated.any())
    return (
        analysis.sensor.name,
        1e3 * analysis.exposure.time_s,
        *(snr[axis] for axis in analysis.color.names),
        defined(analysis.bound_db) if usable else None,
        color_price_db(analysis),
        defined(analysis.matrix.frame.condition),
        mean_color_error(analysis),
    )
