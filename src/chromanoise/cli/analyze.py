"""``chromanoise analyze``."""

from typing import Any

import click

from chromanoise.analysis.comparison.ranking import MOST_PAIRS_SENSORS
from chromanoise.charts import verdict_sentences
from chromanoise.charts.result_tables import outcome_tables
from chromanoise.cli import tables
from chromanoise.cli.copying import print_copy
from chromanoise.cli.options import (
    copy_option,
    matrix_option,
    table_option,
    with_settings,
)
from chromanoise.cli.output import (
    json_option,
    json_text,
    print_lines,
    refuse_taken_inputs,
    table_text,
    write_outputs,
)
from chromanoise.cli.parsing import command
from chromanoise.cli.reader_tables import print_machine_readings
from chromanoise.cli.running import progress_of_step
from chromanoise.exposure import conditions
from chromanoise.io.table import Table
from chromanoise.study import Analyses, run, study_of


@command()
@with_settings("analyze")
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@matrix_option
@table_option
@json_option
@copy_option
def analyze(
    sensors: tuple[str, ...],
    matrix: str,
    table: str | None,
    json_target: str | None,
    copy_as: str | None,
    **settings: Any,
) -> None:
    """Noise of each SENSOR in raw, spectral and color coordinates, for a perfect white.

    SENSOR is a name of the catalog (onyx-rgbw, onyx-rgb-ircut, onyx-rgb, onyx-rgbw-ircut, and
    models of other filter sets: model-rgb-ircut, model-cmy-ircut, model-rgbir ...; all of them:
    `chromanoise catalog sensors`) or a file of QE curves in any format of `chromanoise inspect`.
    """
    study = study_of("analyze", sensors, settings, matrices=[matrix])
    if copy_as is not None:
        print_copy(copy_as, study)
        return
    refuse_taken_inputs({"--json": json_target, "--table": table}, sensors, settings)
    (result,) = run(study, progress=progress_of_step).analyses.values()
    printed = json_target != "-"
    sentences = _sentences(result, study.exposure.equal) if printed else []
    write_outputs(
        (table, lambda: table_text(_table(result), str(table))),
        (json_target, lambda: json_text(result.to_dict())),
    )
    if printed:
        _print(result, sentences)


def _sentences(result: Analyses, equal: str) -> list[str]:
    """The verdict; computed before anything is written, because it may raise an error."""
    return list(verdict_sentences(result.analyses, equal=equal, reader=result.outputs.reader))


def _table(result: Analyses) -> Table:
    """Of the sensors; with a pipeline of each patch at each ISO."""
    return result.pipeline_table() if result.outputs.pipeline.run else result.to_table()


def _print(result: Analyses, sentences: list[str]) -> None:
    analyses = result.analyses
    tables.print_conditions(conditions(result.points))
    tables.print_analyses(analyses)
    print_lines(sentences)
    if len(analyses) > MOST_PAIRS_SENSORS:
        tables.print_ranking(result.ranking, "Ranking by SNR of Y [dB]")
    for table in outcome_tables(result):
        tables.print_table(table)
    readings = [one.machine for one in result.outcomes if one.machine is not None]
    if readings:
        print_machine_readings(readings)
