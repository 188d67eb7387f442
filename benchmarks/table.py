"""Rows of results, on the screen and in docs/performance.md."""

from dataclasses import dataclass

from races import Ratio


@dataclass(frozen=True, slots=True)
class Row:
    """One measured path.

    ``asked`` and what was measured have one unit; ``at_most`` where less is better; ``asked`` is
    ``None`` for what is reported and not judged.
    """

    path: str
    asked: float | None
    measured: Ratio
    rate: str
    unit: str = "x"
    at_most: bool = False

    @property
    def reached(self) -> bool:
        """Whether the median is what was asked."""
        if self.asked is None:
            return True
        middle = self.measured.middle
        return middle <= self.asked if self.at_most else middle >= self.asked


@dataclass(frozen=True, slots=True)
class Skipped:
    """A path that could not be measured, and why."""

    path: str
    reason: str


HEADER = ("path", "target", "measured, median (range)", "rate")


def cells(row: Row | Skipped) -> tuple[str, str, str, str]:
    """The words of a row."""
    if isinstance(row, Skipped):
        return row.path, "-", f"skipped: {row.reason}", "-"
    write = _percent if row.unit == "%" else _times
    sign = "<=" if row.at_most else ">="
    asked = "-" if row.asked is None else f"{sign} {write(row.asked)}"
    ends = f"{write(row.measured.lowest)} .. {write(row.measured.highest)}"
    short = "" if row.reached else ", missed"
    return row.path, asked, f"{write(row.measured.middle)} ({ends}){short}", row.rate


def plain_table(rows: list[Row | Skipped]) -> str:
    """Columns for a screen."""
    lines = [HEADER, *map(cells, rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(HEADER))]
    return "\n".join(_joined(line, widths) for line in lines)


def markdown_table(rows: list[Row | Skipped]) -> str:
    """Columns for a document; missed targets are bold."""
    lines = ["| " + " | ".join(HEADER) + " |", "|" + "---|" * len(HEADER)]
    for row in rows:
        path, asked, measured, rate = cells(row)
        if isinstance(row, Row) and not row.reached:
            measured = f"**{measured}**"
        lines.append(f"| {path} | {asked} | {measured} | {rate} |")
    return "\n".join(lines)


def _joined(words: tuple[str, ...], widths: list[int]) -> str:
    return "  ".join(word.ljust(width) for word, width in zip(words, widths, strict=True)).rstrip()


def _percent(value: float) -> str:
    return f"{100 * value:.0f} %"


def _times(value: float) -> str:
    return f"{value:.2f} x" if value < 10 else f"{value:.0f} x"
