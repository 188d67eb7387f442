"""The paper's tables, printed and computed, as tables for files."""

from chromanoise.io.table import Column, Entry, Table
from chromanoise.paper.layout import PaperTable


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
