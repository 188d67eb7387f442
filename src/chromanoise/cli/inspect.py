"""``chromanoise inspect``."""

from pathlib import Path
from typing import Any

import click
import numpy as np

from chromanoise.cli.answers import answering, answers_of
from chromanoise.cli.output import write_json
from chromanoise.spectra import Spectra
from chromanoise.spectra.files import Understood, read_curves

_MOST_NAMES = 12


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@answering
@click.option(
    "--quantity",
    type=click.Choice(["QE", "response", "reflectance", "transmittance", "power"]),
    help="What it holds.",
)
@click.option("--column", "columns", multiple=True, help="Only this curve; may be repeated.")
@click.option(
    "--beyond",
    type=click.Choice(["refuse", "zero", "hold"]),
    default="refuse",
    show_default=True,
    help="What a curve is where others of the file go on.",
)
@click.option("--json", "json_target", metavar="FILE", help="The same as JSON, - for the screen.")
def inspect(file: Path, json_target: str | None, **options: Any) -> None:
    """What was understood of a FILE of spectra, what looks wrong in it, and what it cannot tell.

    CSV and other delimited text, digitized curves, ISETCam .mat, rawtoaces .json, CGATS and
    Argyll .sp, IES TM-27 .spdx, .xlsx.
    """
    told = read_curves(file, answers=answers_of(options))
    if json_target is not None:
        write_json(told_as_json(file, told), json_target)
    if json_target != "-":
        click.echo("\n".join(told_as_text(file, told)))


def told_as_text(file: Path, told: Understood) -> list[str]:
    """The preview, line by line."""
    curves = told.curves
    names = ", ".join(curves.names[:_MOST_NAMES])
    more = ", ..." if len(curves.names) > _MOST_NAMES else ""
    cells = f", cells parted by {told.delimiter}, decimal {told.decimal}" if told.delimiter else ""
    facts = {
        "format": told.format + cells,
        "curves": f"{len(curves.names)}: {names}{more}",
        "range": f"{_ends(curves)}, {_step(told)}, in the file in {told.wavelength_unit}",
        "quantity": told.quantity or "unknown",
        "scale": f"{told.scale}, times {told.factor:g}",
        "values": f"{curves.values.min():.6g} to {curves.values.max():.6g}",
        "level": told.level or "unknown",
        "light counted": {"photon": "in photons", "energy": "as energy"}.get(
            told.per or "", "unknown"
        ),
        "gaps": ", ".join(f"{a:g}-{b:g} nm" for a, b in told.gaps_nm) or "none",
        "repeated": f"{told.merged} wavelengths",
    }
    if told.deviations is not None:
        facts["deviations"] = ", ".join(told.deviations.names[:_MOST_NAMES])
    lines = [str(file), *(f"  {name:<14} {text}" for name, text in facts.items())]
    lines += [f"  done           {note}" for note in told.notes]
    lines += [f"  DEFECT         {defect}" for defect in told.defects]
    lines += [f"  ASK            {q.asks} ({q.options})" for q in told.questions]
    return lines


def told_as_json(file: Path, told: Understood) -> dict[str, Any]:
    """The preview as data, the curves included."""
    curves = told.curves
    questions = [{"about": q.about, "asks": q.asks, "options": q.options} for q in told.questions]
    return {
        "file": str(file),
        "format": told.format,
        "delimiter": told.delimiter,
        "decimal": told.decimal,
        "names": list(curves.names),
        "wavelength_unit": told.wavelength_unit,
        "start_nm": float(curves.wavelength_nm[0]),
        "stop_nm": float(curves.wavelength_nm[-1]),
        "step_nm": told.step_nm,
        "gaps_nm": [list(gap) for gap in told.gaps_nm],
        "merged": told.merged,
        "quantity": told.quantity,
        "scale": told.scale,
        "factor": told.factor,
        "level": told.level,
        "per": told.per,
        "notes": list(told.notes),
        "defects": list(told.defects),
        "questions": questions,
        "wavelength_nm": curves.wavelength_nm.tolist(),
        "values": {name: curves.values[:, k].tolist() for k, name in enumerate(curves.names)},
    }


def _ends(curves: Spectra) -> str:
    return f"{curves.wavelength_nm[0]:g}-{curves.wavelength_nm[-1]:g} nm"


def _step(told: Understood) -> str:
    if told.step_nm is not None:
        return f"step {told.step_nm:g} nm"
    steps = np.diff(told.curves.wavelength_nm)
    return f"steps of {steps.min():g} to {steps.max():g} nm"
