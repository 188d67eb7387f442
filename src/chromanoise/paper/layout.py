"""The cells of a reproduction in the layout of the paper's tables."""

from dataclasses import dataclass

from chromanoise.paper.reproduction import Cell, Reproduction


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
