"""The cells of a reproduction: in the layout of the paper, as tables for files, as plain data."""

from dataclasses import asdict, dataclass
from typing import Any

from chromanoise import __version__
from chromanoise.catalog.sensors import RECONSTRUCTION
from chromanoise.io.table import Column, Entry, Table
from chromanoise.paper.findings import set_aside_reasons, table_5_finding, verdict
from chromanoise.paper.reproduction import Cell, Reproduction
from chromanoise.paper.study import PRINTED_TIMES_MS


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperTable:
    """One of the paper's tables, laid out.

    Attributes
    ----------
    title
        Number and content of the table.
    columns
        Heads of the columns.
    rows
        Head of each row, and a cell per column; ``None`` where the paper has none.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[Cell | None, ...]], ...]


def as_printed(value: float | None) -> str:
    """A number of the paper with the digits that the paper gives it.

    Parameters
    ----------
    value
        The number; ``None`` where the paper gives none.

    Examples
    --------
    >>> as_printed(25.0), as_printed(39.95), as_printed(None)
    ('25.0', '39.95', '-')
    """
    return "-" if value is None else f"{value:.2f}".removesuffix("0")


_TITLES = {
    2: "Table 2: raw SNR",
    3: "Table 3: SNR of luminance Y",
    4: "Table 4: SNR of contravariant coordinates",
    5: "Table 5: one green channel",
}


def paper_tables(result: Reproduction) -> tuple[PaperTable, ...]:
    """The cells of a reproduction in the layout of the paper.

    Parameters
    ----------
    result
        The reproduction.
    """
    return tuple(_laid_out(number, title, result.cells) for number, title in _TITLES.items())


def _laid_out(number: int, title: str, cells: tuple[Cell, ...]) -> PaperTable:
    by_place = {(cell.row, cell.column): cell for cell in cells if cell.table == number}
    columns = tuple(dict.fromkeys(column for _, column in by_place))
    rows = dict.fromkeys(row for row, _ in by_place)
    return PaperTable(
        title=title,
        columns=columns,
        rows=tuple((row, tuple(by_place.get((row, c)) for c in columns)) for row in rows),
    )


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


def reproduction_as_json(result: Reproduction) -> dict[str, Any]:
    """The paper's tables with ours beside them, and what they say.

    Parameters
    ----------
    result
        The reproduction.
    """
    times_s = result.study.times_s
    return {
        "version": __version__,
        "seed": result.seed,
        "draws": result.draws,
        "clipped": result.clipped,
        "metric": result.study.metric,
        "tables": [asdict(cell) for cell in result.cells],
        "times_ms": {name: 1e3 * times_s[name] for name in PRINTED_TIMES_MS},
        "verdict": verdict(result.study),
        "table_5": table_5_finding(result.study),
        "set_aside": list(set_aside_reasons(result.study)),
        "note": RECONSTRUCTION,
    }
