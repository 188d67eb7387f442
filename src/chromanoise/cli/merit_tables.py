"""Figures of merit and the Pareto curve as tables on a terminal."""

from collections.abc import Sequence

from rich.table import Table

from chromanoise.analysis import Merit, Merits, white_snr_db
from chromanoise.cli.output import terminal
from chromanoise.color import ParetoCurve
from chromanoise.exposure import OperatingPoint, conditions
from chromanoise.io.table import number_text
from chromanoise.metrics import MatrixReport
from chromanoise.spectra import DEFAULT_OBSERVER

_NAMED_WEIGHTS = {0.0: "least squares", 1.0: "LMMSE"}


def print_merits(sensors: Sequence[tuple[OperatingPoint, Merits]]) -> None:
    """Print one table per sensor with values and sources, then the reasons for missing values."""
    console = terminal()
    for point, merits in sensors:
        title = f"Merits of {merits.sensor} at {conditions([point])}, {merits.matrix}"
        table = Table(title=title, title_justify="left")
        for head, side in (("", "left"), ("value", "right"), ("unit", "left"), ("from", "left")):
            table.add_column(head, justify=side)  # type: ignore[arg-type]
        for entry in merits.entries:
            table.add_row(entry.what, _value(entry), _unit(entry), entry.source)
        console.print(table)
        for line in (*_reasons(merits), _remark(merits)):
            console.print(line, soft_wrap=True)


def print_pareto(curve: ParetoCurve, report: MatrixReport, sensor_name: str) -> None:
    """Print color error against noise, one line per weight."""
    console = terminal()
    table = Table(title=f"Color error against noise of {sensor_name}", title_justify="left")
    heads = (
        "weight",
        "color error rms [lx]",
        "Delta E*ab of training",
        "noise rms [lx]",
        "SNR Y [dB]",
    )
    for head in heads:
        table.add_column(head, justify="right")
    table.add_column("")
    snr = white_snr_db(curve, report)
    for i, weight in enumerate(curve.weight.tolist()):
        error, noise = curve.color_error_rms[i], curve.noise_rms[i]
        table.add_row(
            f"{weight:.4g}",
            f"{error:.4g}",
            number_text(curve.delta_e[i]),
            f"{noise:.4g}",
            "saturated" if report.snr_db is None else number_text(snr[i]),
            _NAMED_WEIGHTS.get(round(weight, 12), ""),
        )
    console.print(table)
    console.print(
        "Errors and noise are those of the training set, X, Y and Z together; the color error "
        "above is over the chart. SNR of a perfect white.",
        soft_wrap=True,
    )


def _reasons(merits: Merits) -> list[str]:
    """Why values are missing, one sentence per reason."""
    lacking: dict[str, list[str]] = {}
    for entry in merits.entries:
        if entry.missing:
            lacking.setdefault(entry.missing, []).append(entry.what)
    return [f"{'; '.join(whats)}: {reason}." for reason, whats in lacking.items()]


def _remark(merits: Merits) -> str:
    viewing = merits.viewing
    other = merits.observer != DEFAULT_OBSERVER
    eye = f" for the observer {merits.observer}, SMI for {DEFAULT_OBSERVER}" if other else ""
    return (
        f"{merits.sensor}: q, Vora value and angles in the metric {merits.metric}{eye}; visual "
        f"noise for pixels of {viewing.pixel_pitch_mm:g} mm seen from {viewing.distance_mm:g} mm; "
        "noise of eq. 7, unclipped."
    )


def _value(entry: Merit) -> str:
    return number_text(entry.value, ".4g")


def _unit(entry: Merit) -> str:
    return "" if entry.unit == "1" else entry.unit
