"""The tables for a machine on a terminal."""

from collections.abc import Sequence

from rich.table import Table

from chromanoise.analysis.machine_reading import MachineReading
from chromanoise.charts import machine_tables
from chromanoise.cli.output import terminal

_TEXTS = 2  # columns of text before those of numbers


def print_machine_readings(readings: Sequence[MachineReading]) -> None:
    """Print distances of patches, contrast detection and information.

    Parameters
    ----------
    readings
        One per sensor.
    """
    console = terminal()
    for one in machine_tables(readings):
        table = Table(title=one["title"], title_justify="left")
        for i, head in enumerate(one["head"]):
            table.add_column(head, justify="left" if i < _TEXTS else "right")
        for row in one["rows"]:
            table.add_row(*row)
        console.print(table)
        console.print(one["note"], soft_wrap=True)
