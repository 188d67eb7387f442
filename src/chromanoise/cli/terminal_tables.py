"""Results as tables on a terminal: analyses, comparisons, matrices, machine readings."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from rich.table import Table

from chromanoise.apps.paper import (
    PRINTED_TIMES_MS,
    WELL_SHARE,
    Cell,
    PaperTable,
    Reproduction,
    as_printed,
    metric_remark,
    paper_tables,
    set_aside_reasons,
    table_5_finding,
    verdict,
)
from chromanoise.charts import matrices_in_words
from chromanoise.cli.output import print_lines, short_note, terminal
from chromanoise.color import ColorMatrix
from chromanoise.io import Table as Rows, head as heading, number_text, written_rows
from chromanoise.metrics import MatrixReport
from chromanoise.study import (
    MOST_CROSSED_SENSORS,
    MOST_PAIRS_SENSORS,
    RECONSTRUCTION,
    Analysis,
    CrossoverBand,
    Curve,
    QuantityMap,
    Rank,
    band_sentence,
    best_cells,
    best_of,
    by_matrix,
    color_snr_db,
    contravariant_snr_db,
    diagnosis,
    mean_color_error,
    metric_of,
    raw_snr_db,
    visual_noise_of,
)

_WIDE = 6  # most channels in one row
_SHOWN = 6  # number of printed values of a sweep


def print_reproduction(result: Reproduction) -> None:
    """Print Tables 2-5 with the printed numbers and ours, and the conclusions."""
    console = terminal()
    for table in paper_tables(result):
        console.print(_paper_table(table))
    times = ", ".join(
        f"{name} {1e3 * result.study.times_s[name]:.2f} ms (printed {printed:g})"
        for name, printed in PRINTED_TIMES_MS.items()
    )
    clipped = "clipped between 0 and full well" if result.clipped else "unclipped, as the paper's"
    for line in (
        f"Times solved for {100 * WELL_SHARE:g} % of full well: {times}.",
        metric_remark(result.study),
        f"{result.draws} draws, seed {result.seed}, {clipped}.",
        f"All sensors here: {RECONSTRUCTION}.",
        verdict(result.study),
        f"Table 5: {table_5_finding(result.study)}",
        *(f"Set aside, {reason}" for reason in set_aside_reasons(result.study)),
    ):
        console.print(line, soft_wrap=True)
        console.print()


def print_table(table: Rows, *, width: int | None = None) -> None:
    """Print a table with its title and its notes, at most ``width`` characters wide.

    Of a table without rows only the notes.
    """
    console = terminal()
    if not table.rows:
        print_lines(table.notes)
        return
    shown = Table(title=table.title, title_justify="left")
    for i, column in enumerate(table.columns):
        shown.add_column(
            heading(column),
            justify="right" if column.digits else "left",
            overflow="fold",
            no_wrap=i == 0,
        )
    for row in written_rows(table):
        shown.add_row(*row)
    console.print(shown, width=min(width or console.width, console.width))
    print_lines(table.notes)


def empty_table(title: str, texts: Sequence[str], numbers: Sequence[str], **look: Any) -> Table:
    """A table without rows: columns of texts, then columns of numbers.

    Parameters
    ----------
    look
        As of ``add_column`` of rich.
    """
    table = Table(title=title, title_justify="left")
    for heads, justify in ((texts, "left"), (numbers, "right")):
        for head in heads:
            table.add_column(head, justify=justify, **look)  # type: ignore[arg-type]
    return table


def print_conditions(text: str) -> None:
    """Print the operating point above its tables."""
    terminal().print(f"At {text}:", soft_wrap=True)


Note = tuple[str, str]
"""The name of a sensor and a note on it; an empty name for a note on all of them."""


def print_notes(notes: Sequence[Note], *, whole: bool, details: Sequence[Note] = ()) -> None:
    """Print each note on one line with the names of its sensors; how many are cut or omitted.

    Parameters
    ----------
    whole
        Whether to print all in full.
    details
        Notes that are printed only in full.
    """
    sensors: dict[str, list[str]] = {}
    for name, text in (*notes, *(details if whole else ())):
        sensors.setdefault(text, []).append(name)
    for text, names in sensors.items():
        said = ", ".join(dict.fromkeys(filter(None, names)))
        start = f"{said}: " if said else ""
        print_lines([f"{start}{text if whole else short_note(text)}"])
    cut = sum(short_note(text) != text for text in sensors)
    if not whole and (cut or details):
        counts = [(cut, "in full"), (len(details), "more")]
        said = " and ".join(f"{count} {what}" for count, what in counts if count)
        print_lines([f"Notes: {said} with --notes."])


def print_analyses(analyses: Iterable[Analysis], *, whole_notes: bool = False) -> None:
    """Print the sensors in two tables, channels and color, and notes.

    Parameters
    ----------
    whole_notes
        As ``whole`` of `print_notes`.
    """
    console = terminal()
    analyses = tuple(analyses)
    metric = metric_of(analyses)
    channels = empty_table(
        f"Channels (eq. 1-3, 7; {metric})",
        ("sensor", "channel"),
        ("electrons", "raw SNR dB", "contravariant SNR dB", "VIF"),
        overflow="fold",
    )
    for head in ("to x deg", "to y deg", "to z deg"):
        channels.add_column(head, justify="right")
    color = empty_table(
        f"Spectrum and color (eq. 4-6; {metric}); matrix: {matrices_in_words(analyses)}; "
        "color errors: mean Delta E*ab over the chart",
        ("sensor",),
        (
            *("time ms", "spectral SNR dB", "X dB", "Y dB", "Z dB", "bound dB"),
            *("color SNR loss dB", "condition of channels", "color error", "visual noise"),
        ),
        overflow="fold",
    )
    notes: list[Note] = []
    for analysis in analyses:
        _add_channels(channels, analysis)
        _add_color(color, analysis)
        notes += [(analysis.sensor.label, note) for note in diagnosis(analysis)]
    console.print(channels)
    console.print(color)
    angles = [(one.sensor.label, _angles(one)) for one in analyses]
    print_notes(notes, whole=whole_notes, details=[one for one in angles if one[1]])


def print_comparison(
    curves: Sequence[Curve],
    ranks: Sequence[Rank],
    bands: Sequence[CrossoverBand],
) -> None:
    """Print the quantity and the color error over the sweep, then bands of crossovers.

    With more than three sensors, a ranking is printed as well.
    """
    console = terminal()
    sweep, quantity, at = curves[0].sweep, curves[0].quantity, curves[0].at
    beside = (
        "" if quantity.of_raw else " | mean color error of the chart without noise [Delta E*ab]"
    )
    title = f"{quantity.what} [{quantity.unit}]{beside}, over {sweep.what} [{sweep.unit}]"
    table = Table(title=title, title_justify="left")
    for head in ("sensor", "matrix"):
        table.add_column(head, no_wrap=True)
    shown = _some(at.size)
    for head in ("time ms", *(f"{at[i]:.4g}" for i in shown)):
        table.add_column(head, justify="right")
    for curve in curves:
        varies = sweep.name == "time-ms"
        time = "varies" if varies else f"{1e3 * curve.time_s:.4g}"
        table.add_row(curve.label, curve.matrix, time, *(_curve_cell(curve, i) for i in shown))
    console.print(table)
    if any((np.isnan(curve.value) & ~curve.saturated).any() for curve in curves):
        console.print("-: the matrix gives no valid color under this light.")
    count = len({curve.sensor for curve in curves})
    if count > MOST_PAIRS_SENSORS:
        what = f"{quantity.what} [{quantity.unit}]"
        print_ranking(ranks, f"Ranking at the fixed settings by {what}")
    for sentence in map(band_sentence, bands):
        console.print(sentence, soft_wrap=True)
    if count > MOST_CROSSED_SENSORS:
        console.print("--json has the crossovers of sensors that follow each other as the best.")
    elif count > MOST_PAIRS_SENSORS:
        console.print("--json has the crossovers of all pairs.")


def print_maps(maps: Sequence[QuantityMap], ranks: Sequence[Rank]) -> None:
    """Print a grid of values per sensor and matrix, then the best sensor at each pair of values."""
    console = terminal()
    quantity = maps[0].quantity
    what = f"{quantity.what} [{quantity.unit}]"
    for one in maps:
        cells = [[_map_cell(one, j, k) for k in range(one.at.size)] for j in range(len(one.value))]
        console.print(_grid(one, cells, f"{one.label}, {one.matrix}: {what}"))
    for name, mine in by_matrix(maps).items():
        if len(mine) == 1:
            continue
        labels = [[mine[i].label if i >= 0 else "-" for i in row] for row in best_of(mine).tolist()]
        console.print(_grid(mine[0], labels, f"Best {quantity.what}, {name} matrix"))
    if len({one.sensor for one in maps}) > MOST_PAIRS_SENSORS:
        print_ranking(ranks, f"Ranking at the fixed settings by {what}")


def _map_cell(one: QuantityMap, j: int, k: int) -> str:
    if one.saturated[j, k] and np.isnan(one.value[j, k]):
        return "saturated"
    return number_text(one.value[j, k])


def _grid(one: QuantityMap, cells: Sequence[Sequence[str]], title: str) -> Table:
    """Some rows and columns of a map: the first parameter to the right, the second down."""
    sweep, second = one.sweep, one.second
    over = f"over {sweep.what} [{sweep.unit}] (right) and {second.what} [{second.unit}] (down)"
    table = Table(title=f"{title}, {over}", title_justify="left")
    table.add_column("", justify="right")
    columns, rows = (_some(at.size) for at in (one.at, one.second_at))
    for best in best_cells([one]):  # its values are shown
        columns = sorted({*columns, *np.flatnonzero(one.at == best.at).tolist()})
        rows = sorted({*rows, *np.flatnonzero(one.second_at == best.second_at).tolist()})
    for k in columns:
        table.add_column(f"{one.at[k]:.4g}", justify="right")
    for j in rows:
        table.add_row(f"{one.second_at[j]:.4g}", *(cells[j][k] for k in columns))
    return table


def _some(count: int) -> list[int]:
    """Indices of the printed values of a sweep: the ends and some between."""
    return [int(i) for i in np.unique(np.linspace(0, count - 1, _SHOWN).round())]


def print_ranking(ranks: Sequence[Rank], title: str) -> None:
    """Print the sensors from best to worst; equal ones share a rank."""
    matrices = {one.matrix for one in ranks}
    table = Table(title=title, title_justify="left")
    table.add_column("rank", justify="right")
    for head in ("sensor", *(("matrix",) if len(matrices) > 1 else ())):
        table.add_column(head, no_wrap=True)
    table.add_column("value", justify="right")
    for one in ranks:
        place = "-" if one.rank is None else f"{one.rank}{' (tie)' if one.tied else ''}"
        matrix = (one.matrix,) if len(matrices) > 1 else ()
        table.add_row(place, one.label, *matrix, number_text(one.value, none="undefined"))
    terminal().print(table)


def _curve_cell(curve: Curve, i: int) -> str:
    if curve.saturated[i] and np.isnan(curve.value[i]):
        return "saturated"
    if curve.quantity.of_raw:
        return number_text(curve.value[i])
    return f"{number_text(curve.value[i])} | {number_text(curve.color_error[i], '.1f')}"


def print_matrix(matrix: ColorMatrix, report: MatrixReport, sensor_name: str) -> None:
    """Print the matrix in lx/e-, then its color error and noise."""
    console = terminal()
    heads, rows, numbers = matrix.channels, matrix.coordinates, matrix.matrix
    if len(heads) > _WIDE:  # transposed, so that no column is cut
        heads, rows, numbers = rows, heads, numbers.T
    table = empty_table(f"{sensor_name}, {report.made_by} [lx/e-]", ("",), heads)
    for name, row in zip(rows, numbers, strict=True):
        table.add_row(name, *(f"{value:.6g}" for value in row))
    console.print(table)
    snr = report.snr_db or dict.fromkeys(matrix.coordinates, None)
    nir = report.nir_color or {}
    for line in (
        f"color error without noise: mean {number_text(report.color_error_mean)}, "
        f"max {number_text(report.color_error_max)} Delta E*ab over {report.chart}",
        f"SNR of {report.patch}: " + ("saturated" if report.snr_db is None else _decibels(snr)),
        f"condition {number_text(report.condition)}, Kodak's Psi {number_text(report.psi)}",
        "NIR / visible response to a white: "
        + ", ".join(f"{n} {100 * v + 0.0:+.1f} %" for n, v in nir.items()),
    ):
        console.print(line, soft_wrap=True)


def _decibels(snr: Mapping[str, float | None]) -> str:
    return ", ".join(
        f"{name} undefined" if value is None else f"{name} {value:.2f} dB"
        for name, value in snr.items()
    )


def _add_channels(table: Table, analysis: Analysis) -> None:
    raw, contravariant = raw_snr_db(analysis), contravariant_snr_db(analysis)
    for i, name in enumerate(analysis.sensor.names):
        full = bool(analysis.saturated[i])
        table.add_row(
            analysis.sensor.label if i == 0 else "",
            name,
            f"{analysis.raw.mean[i]:.1f}",
            "saturated" if full else number_text(raw[name]),
            number_text(contravariant[name]),
            _inflation(float(analysis.vif[i])),
            *(f"{angle:.1f}" for angle in analysis.to_axes_deg[i]),
        )


def _add_color(table: Table, analysis: Analysis) -> None:
    snr = color_snr_db(analysis)
    lost = bool(analysis.saturated.any())
    table.add_row(
        analysis.sensor.label,
        f"{1e3 * analysis.exposure.time_s:.4g}",
        "saturated" if lost else number_text(analysis.spectral_snr_db),
        *(number_text(snr[axis]) for axis in analysis.color.names),
        number_text(analysis.optimal_linear_snr_db),
        number_text(analysis.color_snr_loss_db),
        f"{analysis.matrix.frame.condition:.3g}",
        number_text(mean_color_error(analysis), ".1f"),
        number_text(visual_noise_of(analysis), ".3g"),
    )


def _inflation(vif: float) -> str:
    return f"{vif:.2f}" if vif < 1e5 else f"{vif:.3g}"


def _angles(analysis: Analysis) -> str:
    names = analysis.sensor.names
    if len(names) > _WIDE:
        return ""  # too many to read; --json has them
    pairs = [
        f"{a}-{b} {analysis.between_deg[i, k]:.1f}"
        for i, a in enumerate(names)
        for k, b in enumerate(names)
        if k > i
    ]
    return (
        f"angles between channels in the {metric_of([analysis])} [deg]: {', '.join(pairs)}"
        if pairs
        else ""
    )


def _paper_table(laid_out: PaperTable) -> Table:
    title = f"{laid_out.title}  (printed | closed form | Monte Carlo)"
    table = empty_table(title, ("",), laid_out.columns)
    for row, cells in laid_out.rows:
        table.add_row(row, *(_cell(cell) for cell in cells))
    return table


def _cell(cell: Cell | None) -> str:
    if cell is None:
        return ""
    text = f"{as_printed(cell.paper)} | {number_text(cell.closed_form)}"
    if cell.monte_carlo is not None:
        text += f" | {cell.monte_carlo:.2f} ± {cell.monte_carlo_se:.2f}"
    text += f" {cell.unit}"
    return f"{text}, {100 * cell.clipped_share:.1f} % clipped" if cell.clipped_share > 0 else text
