"""Results as tables: a title, columns with units and digits, rows of numbers and text."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from chromanoise.base import InputError, check, defined
from chromanoise.color import ColorMatrix
from chromanoise.io import Column, Entry, Table, written
from chromanoise.metrics import MatrixReport
from chromanoise.study.analysis import (
    Analysis,
    color_snr_db,
    mean_color_error,
)
from chromanoise.study.camera_pipeline import GainStep, PipelineNoise
from chromanoise.study.pareto import mean_total_error
from chromanoise.study.ranking import (
    QuantityMap,
    Rank,
    best_of,
    by_matrix,
    ranked,
)
from chromanoise.study.sweeps import Curve


def ranking_of_analyses(analyses: Sequence[Analysis]) -> tuple[Rank, ...]:
    """The sensors from highest to lowest SNR of Y."""
    found = [(one.sensor.name, one.sensor.label, color_snr_db(one)["Y"]) for one in analyses]
    return ranked(
        [(name, label, math.nan if snr is None else snr) for name, label, snr in found],
        matrix=analyses[0].matrix.made_by,
        more_is_better=True,
    )


def analyses_as_table(analyses: Sequence[Analysis]) -> Table:
    """One row per sensor: exposure, SNR of color, best linear SNR, loss, condition, color error.

    Raises
    ------
    InputError
        If there are no analyses, or their color coordinates differ.
    """
    if not analyses:
        raise InputError("analyses", "must hold at least one for a table", value=())
    axes = analyses[0].color.names
    for analysis in analyses:
        check.same_names("a table of analyses", first=axes, other=analysis.color.names)
    columns = (
        Column(name="sensor"),
        Column(name="time", unit="ms", digits=".4g"),
        *(Column(name=f"SNR {axis}", unit="dB", digits=".1f") for axis in axes),
        Column(name="bound", unit="dB", digits=".1f"),
        Column(name="color SNR loss", unit="dB", digits=".1f"),
        Column(name="condition of channels", digits=".4g"),
        Column(name="color error", unit="Delta E*ab", digits=".2f"),
        Column(name="total color error", unit="Delta E*ab", digits=".2f"),
    )
    return Table(
        title="SNR of color",
        columns=columns,
        rows=tuple(_analysis_row(analysis) for analysis in analyses),
        notes=tuple(dict.fromkeys(note for a in analyses for note in a.sensor.notes)),
    )


def pipeline_as_table(found: Mapping[str, PipelineNoise | None]) -> Table:
    """Standard deviations of each patch at each ISO: one row per sensor, ISO and patch.

    Raw channels (e-) are columns where all sensors have the same; encoded sRGB and Y'CbCr are in
    1/255, CIELAB is that of the picture, relative to D65.

    Parameters
    ----------
    found
        Noise of the pipeline by sensor; ``None`` where it has no color.

    Raises
    ------
    InputError
        If no sensor has a pipeline.
    """
    able = {name: one for name, one in found.items() if one is not None}
    if not able:
        raise InputError(
            "analyses", "must hold at least one with a pipeline for its table", value=tuple(found)
        )
    any_of = next(iter(able.values()))
    raw = any_of.channels if len({one.channels for one in able.values()}) == 1 else ()
    encoded, video, lab = (step.measurement.names for step in any_of.steps[-3:])
    return Table(
        title="Pipeline, standard deviations",
        columns=(
            Column(name="sensor"),
            Column(name="ISO", digits=".4g"),
            Column(name="patch"),
            *(Column(name=f"raw {name}", unit="e-", digits=".2f") for name in raw),
            *(Column(name=name, unit="1/255", digits=".2f") for name in (*encoded, *video)),
            *(Column(name=name, digits=".2f") for name in lab),
        ),
        rows=tuple(
            (name, one.iso, patch, *values)
            for name, noise in able.items()
            for one in noise.iso
            for patch, values in zip(noise.patches, _sds(one, bool(raw)), strict=True)
        ),
    )


def _sds(one: GainStep, with_raw: bool) -> list[list[float]]:
    """The numbers of each patch, in the order of the columns."""
    first = [one.steps[0]] if with_raw else []
    steps = [(step, 1.0) for step in first]
    steps += [(step, 255.0) for step in one.steps[-3:-1]] + [(one.steps[-1], 1.0)]
    blocks = [factor * np.sqrt(step.measurement.variance) for step, factor in steps]
    rows: list[list[float]] = np.hstack(blocks).tolist()
    return rows


def matrix_as_table(matrix: ColorMatrix, report: MatrixReport, sensor_name: str) -> Table:
    """A color matrix, one row per coordinate; color error, condition and SNR are in the notes."""
    columns = [Column(name=name, unit="lx/e-", digits=".6g") for name in matrix.channels]
    rows = zip(matrix.coordinates, matrix.matrix.tolist(), strict=True)
    notes = [
        f"mean color error without noise {written(report.color_error_mean, '.4g') or 'not defined'}"
        f" Delta E*ab over {report.chart}",
        f"condition of the matrix {written(defined(report.condition), '.4g') or 'not defined'}",
    ]
    for name, snr in (report.snr_db or {}).items():
        notes.append(f"SNR {name} of {report.patch} {written(snr, '.2f') or 'not defined'} dB")
    return Table(
        title=f"Color matrix of {sensor_name}: {report.made_by}",
        columns=(Column(name="coordinate"), *columns),
        rows=tuple((name, *row) for name, row in rows),
        notes=tuple(notes),
    )


def matrices_as_table(
    matrices: Sequence[tuple[str, ColorMatrix, MatrixReport]],
) -> Table:
    """Color matrices: that of one sensor as `matrix_as_table`, of several with a column of names.

    Parameters
    ----------
    matrices
        Name of the sensor, its matrix and the report on it. A channel that only other sensors have
        is an empty cell.

    Raises
    ------
    InputError
        If there are no matrices.
    """
    if not matrices:
        raise InputError("matrices", "must hold at least one for a table", value=())
    tables = [matrix_as_table(matrix, report, name) for name, matrix, report in matrices]
    if len(tables) == 1:
        return tables[0]
    channels = list(dict.fromkeys(name for _, matrix, _ in matrices for name in matrix.channels))
    rows: list[tuple[Entry, ...]] = []
    notes: list[str] = []
    for (sensor, matrix, _), table in zip(matrices, tables, strict=True):
        for coordinate, *weights in table.rows:
            of = dict(zip(matrix.channels, weights, strict=True))
            rows.append((sensor, coordinate, *(of.get(name) for name in channels)))
        notes += [f"{sensor}: {note}" for note in table.notes]
    names = ", ".join(name for name, _, _ in matrices)
    return Table(
        title=f"Color matrix of {names}: {matrices[0][2].made_by}",
        columns=(
            Column(name="sensor"),
            Column(name="coordinate"),
            *(Column(name=name, unit="lx/e-", digits=".6g") for name in channels),
        ),
        rows=tuple(rows),
        notes=tuple(notes),
    )


def curves_as_table(curves: Sequence[Curve]) -> Table:
    """A comparison table: one row per value of the sweep, two columns per sensor and matrix.

    Raises
    ------
    InputError
        If there are no curves, or they belong to different sweeps.
    """
    if not curves:
        raise InputError("curves", "must hold at least one for a table", value=())
    first = curves[0]
    for curve in curves:
        if curve.at.tolist() != first.at.tolist() or curve.sweep.name != first.sweep.name:
            raise InputError(
                "curves",
                "must be of one sweep for a table",
                value=(first.sensor, curve.sensor),
                found=f"{curve.sensor} differs from {first.sensor}",
            )
    columns = [Column(name=first.sweep.what, unit=first.sweep.unit, digits=".4g")]
    for curve in curves:
        who = f"{curve.label}, {curve.matrix}"
        columns += [
            Column(name=f"{who}: {curve.quantity.what}", unit=curve.quantity.unit, digits=".4g"),
            Column(name=f"{who}: color error", unit="Delta E*ab", digits=".2f"),
        ]
    rows = []
    for i, at in enumerate(first.at.tolist()):
        row: list[Entry] = [at]
        for curve in curves:
            row += [defined(float(curve.value[i])), defined(float(curve.color_error[i]))]
        rows.append(tuple(row))
    return Table(
        title=f"{first.quantity.what} over {first.sweep.what}",
        columns=tuple(columns),
        rows=tuple(rows),
    )


def maps_as_table(maps: Sequence[QuantityMap]) -> Table:
    """A comparison over two parameters: one row per pair of values.

    Columns are the two parameters, the quantity of each sensor and matrix, and the best sensor with
    each matrix.
    """
    first, matrices = maps[0], by_matrix(maps)
    columns = [
        Column(name=first.second.what, unit=first.second.unit, digits=".4g"),
        Column(name=first.sweep.what, unit=first.sweep.unit, digits=".4g"),
        *(
            Column(
                name=f"{one.label}, {one.matrix}: {one.quantity.what}",
                unit=one.quantity.unit,
                digits=".4g",
            )
            for one in maps
        ),
        *(Column(name=f"best, {name}") for name in matrices),
    ]
    best = {name: best_of(mine).tolist() for name, mine in matrices.items()}
    rows: list[tuple[Entry, ...]] = []
    for j, row in enumerate(first.second_at.tolist()):
        for k, at in enumerate(first.at.tolist()):
            leaders = [
                None if best[name][j][k] < 0 else mine[best[name][j][k]].label
                for name, mine in matrices.items()
            ]
            values = (defined(float(one.value[j, k])) for one in maps)
            rows.append((row, at, *values, *leaders))
    return Table(
        title=f"{first.quantity.what} over {first.sweep.what} and {first.second.what}",
        columns=tuple(columns),
        rows=tuple(rows),
    )


def _analysis_row(analysis: Analysis) -> tuple[Entry, ...]:
    snr = color_snr_db(analysis)
    return (
        analysis.sensor.label,
        1e3 * analysis.exposure.time_s,
        *(snr[axis] for axis in analysis.color.names),
        analysis.optimal_linear_snr_db,
        analysis.color_snr_loss_db,
        defined(analysis.matrix.frame.condition),
        mean_color_error(analysis),
        mean_total_error(analysis),
    )
