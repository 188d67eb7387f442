"""Results as chart records: marks, axes, table rows and their text.

One module per chart; undefined values are ``None``, with the reason in ``why_not``.
"""

from chromanoise.charts.budget import cause_label
from chromanoise.charts.by_name import DRAWINGS, PARTS, drawing
from chromanoise.charts.charted_study import Look, Shown, shown, shown_at
from chromanoise.charts.machine import machine_tables
from chromanoise.charts.numbers import chart_csv, chart_rows
from chromanoise.charts.verdicts import verdict_sentences

__all__ = [
    "DRAWINGS",
    "PARTS",
    "Look",
    "Shown",
    "cause_label",
    "chart_csv",
    "chart_rows",
    "drawing",
    "machine_tables",
    "shown",
    "shown_at",
    "verdict_sentences",
]
