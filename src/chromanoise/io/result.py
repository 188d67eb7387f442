"""What all results share: plain data, a table, a pandas data frame, LaTeX, a figure, HTML."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from chromanoise.base import from_above, notebook, optional_package, plain, schema
from chromanoise.io.result_tables import Table, head, table_latex, written_rows
from chromanoise.io.source_files import has


class Result(ABC):
    """The result of a step: base class of its conversions to data, tables and figures."""

    __slots__ = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain data, as the JSON of the command; ``None`` where a value is not defined."""
        data: dict[str, Any] = plain(self)
        return data

    @classmethod
    def json_schema(cls) -> dict[str, Any]:
        """The JSON schema (2020-12) of `to_dict`; a later release may add keys."""
        return schema(cls)

    @abstractmethod
    def to_table(self) -> Table:
        """The main table, with units and full precision."""

    @abstractmethod
    def plot(self, ax: Any = None) -> Any:
        """Draw the main chart.

        Parameters
        ----------
        ax
            Axes of matplotlib; ``None`` for those of a new figure.

        Returns
        -------
        Axes
        """

    def to_dataframe(self) -> Any:
        """The main table as a pandas data frame; pandas must be installed.

        Columns are named ``name [unit]``; an undefined value is a missing value.

        Raises
        ------
        InputError
            If pandas is not installed.
        """
        pandas = optional_package("pandas", "a data frame", extra="pandas")
        table = self.to_table()
        heads = [head(column) for column in table.columns]
        return pandas.DataFrame(list(table.rows), columns=heads)

    def to_latex(self, label: str = "") -> str:
        r"""The main table in LaTeX (booktabs), rounded as the columns specify.

        Parameters
        ----------
        label
            Label for ``\ref``; empty for no label.

        Returns
        -------
        str
        """
        return table_latex(self.to_table(), label)

    @abstractmethod
    def _repr_html_(self) -> str:
        """What the result belongs to, and the main table, as HTML for a notebook."""

    def _html(self, caption: str, notes: Sequence[str] = ()) -> str:
        table = self.to_table()
        heads = [head(column) for column in table.columns]
        shown = notebook.table(heads, written_rows(table))
        return notebook.shown(caption, shown, notes=notes)


def figures() -> Any:
    """`chromanoise.charts`, a higher layer, imported only when a figure is drawn."""
    return from_above("figures")


def axes_of(ax: Any) -> Any:
    """The axes given, or those of a new figure."""
    if ax is not None:
        return ax
    return import_module("matplotlib.pyplot").subplots(layout="constrained")[1]


def panels_of(axes: Any, count: int, *, columns: int) -> Sequence[Any]:
    """The axes given, or as many of a new figure, in rows of ``columns``.

    Raises
    ------
    InputError
        If the number of axes given is another.
    """
    if axes is not None:
        given = list(getattr(axes, "flat", axes if isinstance(axes, Sequence) else [axes]))
        if len(given) != count:
            raise has("ax", f"must be {count} axes, one per panel", len(given), "is")
        return given
    rows, columns = -(-count // columns), min(count, columns)
    width_in = 10.0 if columns == 1 else 5.2
    figure, grid = import_module("matplotlib.pyplot").subplots(
        rows, columns, figsize=(width_in * columns, 4.4 * rows), layout="constrained", squeeze=False
    )
    for spare in grid.flat[count:]:
        figure.delaxes(spare)
    return list(grid.flat[:count])
