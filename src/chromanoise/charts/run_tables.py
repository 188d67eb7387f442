"""All results of a run as tables, for terminals and reports.

A table without rows has the reason as its note.
"""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from chromanoise.base import Array, Float
from chromanoise.charts.budget_chart import cause_label
from chromanoise.color import ParetoCurve
from chromanoise.io import Column, Entry, Table, number_text, table_of
from chromanoise.metrics import Budget, MatrixReport
from chromanoise.noise import OperatingPoint, conditions
from chromanoise.spectra import DEFAULT_OBSERVER, chart_title
from chromanoise.study import (
    GRAY,
    LOST_DELTA_E,
    Analyses,
    Analysis,
    ChartNoise,
    GainStep,
    GrayNoise,
    Merits,
    PipelineNoise,
    PipelineStep,
    color_budgets,
    contravariant_budgets,
    contravariant_snr_db,
    lab_budgets,
    metric_of,
    missing_color_budgets,
    missing_lab_budgets,
    raw_snr_db,
    white_snr_db,
)

_NAMED_WEIGHTS = {0.0: "least squares", 1.0: "LMMSE"}
_CODES = 255
_MOST_CHANNELS = 4  # more are shown as a range
_NO_COLOR = "because a channel is saturated or gives one code, or XYZ of the white is not valid"
_DELTA_E = "Delta E*ab"


def outcome_tables(result: Analyses) -> Iterator[Table]:
    """The tables that a study asks for beside those of channels and color, one sensor each.

    Parameters
    ----------
    result
        Of one color matrix.
    """
    outputs = result.outputs
    for outcome in result.outcomes if outputs.budget else ():
        yield from budget_tables(outcome.analysis)
    for outcome in result.outcomes if outputs.chart else ():
        yield patches_table(outcome.analysis, outcome.chart)
    for outcome in result.outcomes if outputs.pipeline.run else ():
        yield from pipeline_tables(outcome.analysis.sensor.label, outcome.pipeline)
    for point, outcome in zip(result.points, result.outcomes, strict=True):
        if outcome.merits is not None:
            yield merits_table(point, outcome.merits)
    if outputs.space is not None:
        yield gray_table(result.analyses, [outcome.gray_noise for outcome in result.outcomes])


def color_table(results: Sequence[Analyses]) -> Table:
    """SNR and color error of every sensor with every matrix.

    Parameters
    ----------
    results
        One per color matrix.
    """
    tables = [one.to_table() for one in results]
    sensor, *others = tables[0].columns
    rows = [
        (row[0], result.matrix, *row[1:])
        for result, table in zip(results, tables, strict=True)
        for row in table.rows
    ]
    return Table(
        title="Every sensor with every matrix",
        columns=(sensor, Column(name="matrix"), *others),
        rows=tuple(rows),
        notes=tables[0].notes,
    )


def channels_table(analyses: Sequence[Analysis]) -> Table:
    """Every channel of every sensor: electrons, raw and contravariant SNR, VIF, angles."""
    rows: list[tuple[Entry, ...]] = []
    for analysis in analyses:
        raw, contravariant = raw_snr_db(analysis), contravariant_snr_db(analysis)
        for i, name in enumerate(analysis.sensor.names):
            rows.append(
                (
                    analysis.sensor.label,
                    name,
                    float(analysis.raw.mean[i]),
                    "saturated" if analysis.saturated[i] else raw[name],
                    contravariant[name],
                    number_text(float(analysis.vif[i]), ".4g"),
                    *map(float, analysis.to_axes_deg[i]),
                )
            )
    return Table(
        title=f"Channels (eq. 1-3, 7; {metric_of(analyses)})",
        columns=(
            Column(name="sensor"),
            Column(name="channel"),
            Column(name="electrons", unit="e-", digits=".1f"),
            Column(name="raw SNR", unit="dB", digits=".2f"),
            Column(name="contravariant SNR", unit="dB", digits=".2f"),
            Column(name="VIF", digits=".4g"),
            *(Column(name=f"angle to {axis}", unit="deg", digits=".1f") for axis in "xyz"),
        ),
        rows=tuple(rows),
    )


def budget_tables(analysis: Analysis) -> list[Table]:
    """Budgets of X, Y, Z, of the contravariant coordinates, and of L*, a*, b* of a gray."""
    name, metric = analysis.sensor.label, metric_of([analysis])
    color, contravariant = color_budgets(analysis), contravariant_budgets(analysis)
    lab = lab_budgets(analysis)
    tables = [
        _budget_table(
            color,
            f"Budget of the color of {name} ({metric})",
            missing_color_budgets(analysis, color),
        ),
        _budget_table(
            contravariant, f"Budget of the contravariant coordinates of {name} ({metric})"
        ),
    ]
    of = f"one unit of L*, a*, b* of a gray of {100 * GRAY:.0f} %"
    missing = missing_lab_budgets(analysis, lab)
    table = _budget_table(lab, f"Budget of {of}, {name} ({metric})", missing)
    return [*tables, table] if table.rows or missing else tables


def _budget_table(found: Sequence[Budget | None], title: str, missing: str | None = None) -> Table:
    """One row per cause: change and gain if removed per coordinate, and why for the second one."""
    budgets = [budget for budget in found if budget]
    if not budgets:
        note = missing or f"{title}: no coordinate has an SNR, so there is no budget"
        return Table(title=title, columns=(Column(name="cause"),), rows=(), notes=(note,))
    read, empty = min(1, len(budgets) - 1), [None for _ in (*budgets, "why")]
    rows: list[tuple[Entry, ...]] = [
        ("all photons", *(f"{budget.photons_db:.2f}" for budget in budgets), *empty)
    ]
    for i, cost in enumerate(budgets[0].costs):
        changes = [_signed(-budget.costs[i].cost_db) for budget in budgets]
        gains = [_signed(budget.costs[i].gain_if_removed_db) for budget in budgets]
        label = cause_label(cost.cause, *(budget.coordinate for budget in budgets))
        rows.append((label, *changes, *gains, budgets[read].costs[i].reading))
    rows.append(("SNR", *(f"{budget.snr_db:.2f}" for budget in budgets), *empty))
    return Table(
        title=title,
        columns=(
            Column(name="cause"),
            *(Column(name=one.coordinate, unit="dB", digits=".2f") for one in budgets),
            *(
                Column(name=f"{one.coordinate} gain if removed", unit="dB", digits=".2f")
                for one in budgets
            ),
            Column(name=f"why, for {budgets[read].coordinate}"),
        ),
        rows=tuple(rows),
        notes=(missing,) if missing else (),
    )


def _signed(change_db: float | None) -> str | None:
    return None if change_db is None else f"{round(change_db, 2) + 0.0:+.2f}"


def patches_table(analysis: Analysis, chart: ChartNoise | None) -> Table:
    """Color error and noise of every patch of the chart, and their means."""
    name = analysis.sensor.label
    seen = chart_title(analysis.chart).removeprefix("the ")
    columns = (
        Column(name="patch"),
        Column(name="color error", unit=_DELTA_E, digits=".1f"),
        Column(name="CIEDE2000", digits=".1f"),
        Column(name="SNR of Y", unit="dB", digits=".1f"),
        *(Column(name=f"sd {axis}", digits=".1f") for axis in ("L*", "a*", "b*")),
        Column(name="noise of one pixel", unit=_DELTA_E, digits=".1f"),
    )
    title = f"{seen} seen by {name}, matrix: {analysis.matrix.made_by}"
    if chart is None:
        note = f"{name}: no chart, {_NO_COLOR}."
        return Table(title=title, columns=columns, rows=(), notes=(note,))
    sd = chart.noise.sd
    assert chart.noise.delta_e is not None  # CIELAB has one
    noise = chart.noise.delta_e
    rows: list[tuple[Entry, ...]] = []
    for i, patch in enumerate(chart.names):
        before = map(float, (chart.color_error[i], chart.ciede2000[i]))
        snr = number_text(float(chart.snr_y_db[i]), ".1f")
        rows.append((patch, *before, snr, *_unless_lost(sd[i], noise[i])))
    means = (float(chart.color_error.mean()), float(chart.ciede2000.mean()), None)
    rows.append(("mean", *means, *_unless_lost(sd.mean(axis=0), noise.mean())))
    failing, lost = int((~chart.first_order_holds).sum()), int((noise >= LOST_DELTA_E).sum())
    gone = (
        f"{name}: no color information in one pixel at this level on {lost} of {len(noise)} "
        f"patches: its noise is above {LOST_DELTA_E:g} Delta E*ab, the distance of black and white."
    )
    note = (
        f"{name}: the first order is off by more than 5 % on {failing} of {len(noise)} patches; "
        "the numbers above come from the exact Poisson-Gaussian distribution."
    )
    notes = (*([gone] if lost else []), *([note] if failing else []))
    return Table(title=title, columns=columns, rows=tuple(rows), notes=notes)


def _unless_lost(sd: Float[Array, " 3"], noise: float) -> tuple[Entry, ...]:
    """Spreads and noise of one pixel, or that they hide its color."""
    if noise >= LOST_DELTA_E:
        return ("lost",) * 4
    return (*map(float, sd), float(noise))


def gray_table(analyses: Sequence[Analysis], noises: Sequence[GrayNoise | None]) -> Table:
    """The exact noise of an 18 % gray, and which approximations hold."""
    pairs = list(zip(analyses, noises, strict=True))
    notes = tuple(
        f"{one.sensor.label}: no noise of a gray, {_NO_COLOR}" for one, noise in pairs if not noise
    )
    known = [noise for noise in noises if noise]
    if not known:
        title = "Noise of an 18 % gray"
        return Table(title=title, columns=(Column(name="sensor"),), rows=(), notes=notes)
    space, names = known[0].exact.measurement.kind, known[0].exact.measurement.names
    rows: list[tuple[Entry, ...]] = []
    for analysis, noise in pairs:
        if noise is None:
            continue
        exact = noise.exact
        holds = (noise.first_order_holds, noise.normal_holds)
        rows.append(
            (
                analysis.sensor.label,
                *map(float, exact.sd),
                number_text(None if exact.chroma_sd is None else float(exact.chroma_sd)),
                number_text(None if exact.delta_e is None else float(exact.delta_e)),
                ", ".join(f"{value:+.2g}" for value in exact.bias),
                *("holds" if one else "off by more than 5 %" for one in holds),
            )
        )
    return Table(
        title=f"Noise of an 18 % gray in {space}",
        columns=(
            Column(name="sensor"),
            *(Column(name=f"sd {name}", digits=".3g") for name in names),
            Column(name="sd C*", digits=".2f"),
            Column(name="noise of one pixel", unit=_DELTA_E, digits=".2f"),
            Column(name="bias"),
            Column(name="first order"),
            Column(name="Gaussian approx."),
        ),
        rows=tuple(rows),
        notes=notes,
    )


def merits_table(point: OperatingPoint, merits: Merits) -> Table:
    """All figures of merit of one sensor with their sources, and why values are missing."""
    return table_of(
        f"Figures of merit of {merits.sensor} at {conditions([point])}, {merits.matrix}",
        merits.entries,
        ("figure of merit", "", "", lambda one: one.what),
        ("value", "", ".4g", lambda one: number_text(one.value, ".4g")),
        ("unit", "", "", lambda one: "" if one.unit == "1" else one.unit),
        ("from", "", "", lambda one: one.source),
        notes=(*_reasons(merits), _remark(merits)),
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


def pareto_table(curve: ParetoCurve, report: MatrixReport, sensor_name: str) -> Table:
    """Training error against noise, one row per weight of the noise."""
    snr = white_snr_db(curve, report)
    weights = curve.weight.tolist()
    is_full = report.snr_db is None
    return table_of(
        f"Training error against noise of {sensor_name}",
        range(len(weights)),
        ("weight", "", ".4g", lambda i: f"{weights[i]:.4g}"),
        ("training error rms", "lx", ".4g", lambda i: curve.color_error_rms[i]),
        ("training error", _DELTA_E, ".2f", lambda i: number_text(curve.delta_e[i])),
        ("noise rms", "lx", ".4g", lambda i: curve.noise_rms[i]),
        ("SNR Y", "dB", ".2f", lambda i: "saturated" if is_full else number_text(snr[i])),
        ("name", "", "", lambda i: _NAMED_WEIGHTS.get(round(weights[i], 12), "")),
        notes=(
            "Training errors and noise are means over the spectra of the prior, X, Y and Z "
            "together; the color error of a matrix is a mean over the patches of the chart. SNR "
            "of a perfect white.",
        ),
    )


def pipeline_tables(name: str, found: PipelineNoise | None) -> list[Table]:
    """The noise of each patch after each step, then one row per ISO.

    Parameters
    ----------
    found
        ``None`` where it has no color.
    """
    if found is None:
        title = f"Pipeline of {name}"
        note = f"{name}: no pipeline, {_NO_COLOR}."
        return [Table(title=title, columns=(Column(name="patch"),), rows=(), notes=(note,))]
    notes = tuple(f"{name}: {line}" for line in (*_balance(found), *found.notes))
    return [_patches_of_pipeline(name, found), _isos(name, found, notes)]


def _patches_of_pipeline(name: str, found: PipelineNoise) -> Table:
    encoded = found.steps[-3]
    few = len(found.channels) <= _MOST_CHANNELS
    raw_heads = [f"raw {one}" for one in found.channels] if few else ["raw"]
    heads = [name for step in found.steps[-3:] for name in step.measurement.names]
    raw = _sd(found.steps[0])
    others = np.hstack(
        [_CODES * _sd(found.steps[-3]), _CODES * _sd(found.steps[-2]), _sd(found.steps[-1])]
    )
    rows: list[tuple[Entry, ...]] = []
    for i, patch in enumerate(found.patches):
        ends = f"{raw[i].min():.1f} to {raw[i].max():.1f}"
        raws: Sequence[Entry] = [*map(float, raw[i])] if few else [ends]
        rows.append((patch, *raws, *map(float, others[i])))
    rows.append(("mean", *(None for _ in raw_heads), *map(float, others.mean(axis=0))))
    return Table(
        title=f"Pipeline of {name}, standard deviations: raw in e-, {encoded.name} and Y'CbCr in "
        f"1/{_CODES}, Lab of the picture relative to D65",
        columns=(
            Column(name="patch"),
            *(Column(name=head, digits=".1f") for head in raw_heads),
            *(Column(name=head, digits=".2f") for head in heads),
        ),
        rows=tuple(rows),
    )


def _isos(name: str, found: PipelineNoise, notes: tuple[str, ...]) -> Table:
    encoded, lab = (found.steps[i].measurement.names for i in (-2, -1))
    heads = ("gain", "K DN/e-", "read e-", "white e-", "dynamic range dB", "stops", "S", "O")
    return Table(
        title=f"{name} at each ISO (exposure of ISO {found.settings.base_iso:g} divided by the "
        "gain); Y'CbCr and Lab: mean standard deviation",
        columns=(
            Column(name="ISO", digits=".4g"),
            *(Column(name=head, digits=".4g") for head in heads),
            *(Column(name=head, digits=".2f") for head in (*encoded, *lab)),
        ),
        rows=tuple(_iso_row(one) for one in found.iso),
        notes=notes,
    )


def _iso_row(one: GainStep) -> tuple[Entry, ...]:
    return (
        f"{one.iso:g}",
        f"{one.gain:g}",
        "-" if one.gain_dn_per_e is None else f"{one.gain_dn_per_e:.4g}",
        f"{one.read_noise_e:.3g}",
        f"{one.white_level_e:.4g}",
        _each(one.dynamic_range_db, ".1f"),
        _each(one.dynamic_range_stops, ".2f"),
        _each(one.noise_profile[:, 0], ".3g"),
        _each(one.noise_profile[:, 1], ".3g"),
        *(float(_CODES * value) for value in _sd(one.steps[-2]).mean(axis=0)),
        *map(float, _sd(one.steps[-1]).mean(axis=0)),
    )


def _balance(found: PipelineNoise) -> Iterable[str]:
    gains = ", ".join(
        f"{name} {gain:.4g}" for name, gain in zip(found.channels, found.gains, strict=True)
    )
    yield f"white balance gains {gains}"
    noise = found.white_balance_noise
    if noise is None:
        return
    sd = np.sqrt(np.diagonal(noise.gains_covariance))
    errors = ", ".join(
        f"{name} {100 * error:.2g} %"
        for name, error in zip(found.channels, sd / found.gains, strict=True)
    )
    yield (
        f"from {noise.pixels} gray pixels per channel the gains have standard deviations of "
        f"{errors}: a shift common to the whole picture of {noise.delta_e.mean():.2g} {_DELTA_E} "
        "(rms, mean of the patches)"
    )


def _each(values: Array, digits: str) -> str:
    """One number where the channels agree to the printed digits, else the range."""
    shown = list(
        dict.fromkeys(format(float(value), digits) for value in (min(values), max(values)))
    )
    return " to ".join(shown)


def _sd(step: PipelineStep) -> Array:
    return np.asarray(np.sqrt(step.measurement.variance))
