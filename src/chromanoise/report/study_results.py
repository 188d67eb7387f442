"""All results of a study for its report: sweeps, maps, every matrix, every output, settings."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from pydantic import BaseModel

from chromanoise.charts import Shown
from chromanoise.charts.result_tables import (
    channels_table,
    color_table,
    outcome_tables,
    pareto_table,
)
from chromanoise.io.table import Table, written
from chromanoise.report.bundle import data_address
from chromanoise.study import Analyses, Comparison, ComparisonMap, Matrices, Study
from chromanoise.study.running import result_steps

_SIZE_IN = (7.2, 4.2)
_DOTS_PER_IN = 96  # of a screen


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StudyResults:
    """The results of all steps of a study but its pictures.

    Attributes
    ----------
    analyses, matrices
        One per color matrix, whether the study asks for them or not.
    sweeps, maps
        Of one and of two parameters.
    """

    analyses: tuple[Analyses, ...]
    matrices: tuple[Matrices, ...]
    sweeps: tuple[Comparison, ...]
    maps: tuple[ComparisonMap, ...]


def results_of(of: Shown) -> StudyResults:
    """Compute the results of a study that its charts do not have.

    Parameters
    ----------
    of
        The study.

    Raises
    ------
    InputError
        If a result cannot be computed.
    """
    outputs = of.study.outputs.model_copy(update={"analyses": True, "matrix": True})
    study = of.study.model_copy(update={"outputs": outputs})
    steps = result_steps(study, list(of.operating_points), of.makers)
    found = [step.run(None, lambda _: None) for step in steps]
    return StudyResults(
        analyses=tuple(one for one in found if isinstance(one, Analyses)),
        matrices=tuple(one for one in found if isinstance(one, Matrices)),
        sweeps=tuple(one for one in found if isinstance(one, Comparison)),
        maps=tuple(one for one in found if isinstance(one, ComparisonMap)),
    )


def table_record(table: Table) -> dict[str, Any]:
    """A table as text: ``title``, ``head``, ``rows``, ``notes``."""
    heads = [
        _typeset(f"{one.name} [{one.unit}]" if one.unit else one.name) for one in table.columns
    ]
    digits = [column.digits for column in table.columns]
    return {
        "title": table.title,
        "head": heads,
        "rows": [
            [_typeset(written(*pair)) for pair in zip(row, digits, strict=True)]
            for row in table.rows
        ],
        "notes": [_typeset(note) for note in table.notes],
    }


def _typeset(text: str) -> str:
    """A text of a terminal with the signs of print: ΔE, e⁻, a true minus before a number."""
    text = re.sub(r"(^|[ (\[/])e-(?=$|[ )\]/,;:])", r"\1e⁻", text.replace("Delta E", "ΔE"))
    return re.sub(r"(^|[ (\[])-(?=[\d.])", "\\1\N{MINUS SIGN}", text)


def sweep_records(results: StudyResults) -> list[dict[str, Any]]:
    """Each sweep of one parameter: title, picture, sentences, table."""
    return [_pictured(one, one.shown_sentences, "svg", "image/svg+xml") for one in results.sweeps]


def map_records(results: StudyResults) -> list[dict[str, Any]]:
    """Each sweep of two parameters: title, picture, table."""
    return [_pictured(one, [], "png", "image/png") for one in results.maps]


def _pictured(
    one: Comparison | ComparisonMap, sentences: list[str], ending: str, kind: str
) -> dict[str, Any]:
    from matplotlib.figure import Figure  # slow to import, and only a sweep needs it

    from chromanoise.figures.style import chromanoise_style
    from chromanoise.figures.writing import figure_bytes

    with chromanoise_style():
        figure = Figure(figsize=_SIZE_IN, layout="constrained")
        ax = one.plot(figure.add_subplot())
        caption = ax.get_title(loc="left")
        ax.set_title("", loc="left")
    table = one.to_table()
    return {
        "title": table.title,
        "caption": caption,
        "source": data_address(figure_bytes(figure, ending), kind),
        "width": round(_DOTS_PER_IN * _SIZE_IN[0]),
        "height": round(_DOTS_PER_IN * _SIZE_IN[1]),
        "sentences": [_typeset(sentence) for sentence in sentences],
        "table": table_record(table),
    }


def matrix_records(results: StudyResults) -> list[dict[str, Any]]:
    """SNR and error of every sensor with every matrix, then the coefficients of each matrix."""
    tables = [color_table(results.analyses), channels_table(results.analyses[0].analyses)]
    tables += [replace(one.to_table(), notes=()) for one in results.matrices]  # see the first
    return [table_record(table) for table in tables if table.rows]


def output_records(results: StudyResults) -> list[dict[str, Any]]:
    """The tables of the outputs that the study asks for: ``title`` and ``tables`` per matrix."""
    groups = [
        {"title": f"With the {one.matrix} matrix", "tables": list(map(table_record, tables))}
        for one in results.analyses
        if (tables := list(outcome_tables(one)))
    ]
    curves = [
        table_record(pareto_table(one.pareto, one.report, one.point.sensor.label))
        for one in results.matrices[0].results
        if one.pareto is not None
    ]
    return [
        *groups,
        *([{"title": "With any weight of the noise", "tables": curves}] if curves else []),
    ]


def setting_rows(study: Study) -> list[list[str]]:
    """Key, value and meaning of every setting that is not the default."""
    return list(_settings(study, ""))


def _settings(part: BaseModel, key: str) -> Iterator[list[str]]:
    for name, field in type(part).model_fields.items():
        value = getattr(part, name)
        inner = f"{key}{field.alias or name}"
        if isinstance(value, BaseModel):
            yield from _settings(value, f"{inner}.")
        elif isinstance(value, tuple) and any(isinstance(one, BaseModel) for one in value):
            for i, one in enumerate(value):
                yield from _settings(one, f"{inner}.{i}.")
        elif value != field.default:
            text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
            yield [inner, text, field.description or ""]
