"""``chromanoise inspect``."""

from pathlib import Path
from typing import Any

import click
import numpy as np

from chromanoise.catalog import own_sensor_of
from chromanoise.catalog.entries import catalog_entry, catalog_folder
from chromanoise.cli.answers import answering, answers_of, of_one_file
from chromanoise.cli.output import refuse_inputs, write_json
from chromanoise.cli.parsing import command
from chromanoise.cli.rendering import options_text
from chromanoise.errors import InputError
from chromanoise.io.sensor_json import sensor_data
from chromanoise.io.spectra import ParsedSpectra, read_curves
from chromanoise.io.spectra.merging import gaps_nm, step_nm
from chromanoise.io.spectra.writing import mosaic_text, sensor_spectra
from chromanoise.sensor import Sensor
from chromanoise.spectra import Spectra

_MOST_NAMES = 12


@command()
@click.argument("file", type=click.Path(path_type=Path))
@answering
@of_one_file
@click.option(
    "--json", "json_target", metavar="FILE", help="Write the same as JSON; - for standard output."
)
def inspect(file: Path, json_target: str | None, **options: Any) -> None:
    """Show how a FILE of spectra is parsed, what looks wrong, and what it does not declare.

    Formats: CSV and other delimited text, such as exports of spectrometers, digitized curves,
    JCAMP-DX .jdx, ASD .asd, .mat of ISETCam, Psychtoolbox and the camera database, .json of
    rawtoaces, of DCamProf (ssf-data) and with plain lists, CGATS and Argyll .sp, IES TM-27 .spdx,
    ENVI libraries .sli with .hdr, tables of .fits, .xlsx, and .csv and .json of chromanoise
    convert.
    """
    refuse_inputs(json_target, "--json", str(file))
    if not file.exists():
        _refuse_name(str(file))
    own = own_sensor_of(file) if file.is_file() else None
    if own is None:
        parsed = read_curves(file, answers=answers_of(options))
        data, lines = summary_data(file, parsed), summary_lines(file, parsed)
    else:
        _refuse_answers(options)
        data, lines = own_data(file, own), own_lines(file, own)
    if json_target is not None:
        write_json(data, json_target)
    if json_target != "-":
        click.echo("\n".join(lines))


def _refuse_name(word: str) -> None:
    """Refuse a name of the catalog, which is no file."""
    try:
        kind = catalog_entry(word, folder=catalog_folder()).provenance.kind
    except InputError:
        return  # neither a name nor a file
    raise InputError(
        word,
        "must be a file",
        value=word,
        found=f"is the name of a {kind} of the catalog",
        remedy=f"use `chromanoise catalog {word}`",
    )


def _refuse_answers(options: dict[str, Any]) -> None:
    """Refuse options: the JSON of a sensor declares everything they could supply."""
    for name, value in options.items():
        if value not in (None, ()):
            raise InputError(
                name,
                "must not be given for the JSON of a sensor, which declares it",
                value=value,
                found=None,
                remedy="omit it",
                setting=name,
            )


def own_lines(file: Path, own: Sensor) -> list[str]:
    """The content of a sensor JSON file, as lines of text."""
    curves, pixel = sensor_spectra(own), own.pixel
    facts = {
        "format": "chromanoise's own JSON, a sensor",
        "curves": f"{len(curves.names)}: {_few(curves.names)}",
        "range": f"{_ends(curves)}, {_steps(curves)}",
        "quantity": f"{curves.quantity} [{curves.unit}]",
        "values": f"{curves.values.min():.6g} to {curves.values.max():.6g}",
        "gaps": _gaps(gaps_nm(curves.wavelength_nm)),
        "name": own.name,
        "origin": own.origin,
        "mosaic": mosaic_text(own.mosaic),
        "pixel": f"{pixel.pitch_um:g} um, {pixel.full_well_e:g} e- full, read noise "
        f"{pixel.read_noise_e:g} e-",
    }
    lines = [str(file), *(f"  {name:<14} {text}" for name, text in facts.items())]
    return lines + [f"  note           {note}" for note in own.notes]


def own_data(file: Path, own: Sensor) -> dict[str, Any]:
    """The content of a sensor JSON file as data, with the name of the file."""
    return {"file": str(file), "format": "chromanoise JSON", **sensor_data(own)}


def _few(names: tuple[str, ...]) -> str:
    return ", ".join(names[:_MOST_NAMES]) + (", ..." if len(names) > _MOST_NAMES else "")


def _gaps(gaps: tuple[tuple[float, float], ...]) -> str:
    return ", ".join(f"{a:g}-{b:g} nm" for a, b in gaps) or "none"


def summary_lines(file: Path, parsed: ParsedSpectra) -> list[str]:
    """The preview, line by line."""
    curves = parsed.curves
    cells = (
        f", cells separated by {parsed.delimiter}, decimal {parsed.decimal}"
        if parsed.delimiter
        else ""
    )
    facts = {
        "format": parsed.format + cells,
        "curves": f"{len(curves.names)}: {_few(curves.names)}",
        "range": f"{_ends(curves)}, {_steps(curves)}, in the file in {parsed.wavelength_unit}",
        "quantity": parsed.quantity or _undeclared(parsed),
        "scale": f"{parsed.scale}, times {parsed.factor:g}",
        "values": f"{curves.values.min():.6g} to {curves.values.max():.6g}",
        "level": parsed.level or "unknown",
        "light counted": {"photon": "in photons", "energy": "as energy"}.get(
            parsed.per or "", "unknown"
        ),
        "gaps": _gaps(parsed.gaps_nm),
        "repeated": f"{parsed.merged} wavelengths",
    }
    if parsed.deviations is not None:
        facts["deviations"] = ", ".join(parsed.deviations.names[:_MOST_NAMES])
    if parsed.said_source:
        facts["source"] = parsed.said_source
    lines = [str(file), *(f"  {name:<14} {text}" for name, text in facts.items())]
    lines += [f"  note           {note}" for note in parsed.said_notes]
    lines += [f"  done           {note}" for note in parsed.notes]
    lines += [f"  DEFECT         {defect}" for defect in parsed.defects]
    lines += [
        f"  ASK            {q.asks} ({' or '.join(map(options_text, q.settings))})"
        for q in parsed.questions
    ]
    return lines


def _undeclared(parsed: ParsedSpectra) -> str:
    assumed = "not declared; a sensor takes it as absolute QE per photon (headed wavelength_nm)"
    return assumed if parsed.own_form else "unknown"


def summary_data(file: Path, parsed: ParsedSpectra) -> dict[str, Any]:
    """The preview as data, the curves included."""
    curves = parsed.curves
    questions = [
        {"about": q.about, "asks": q.asks, "options": " or ".join(map(options_text, q.settings))}
        for q in parsed.questions
    ]
    return {
        "file": str(file),
        "format": parsed.format,
        "delimiter": parsed.delimiter,
        "decimal": parsed.decimal,
        "names": list(curves.names),
        "wavelength_unit": parsed.wavelength_unit,
        "start_nm": float(curves.wavelength_nm[0]),
        "stop_nm": float(curves.wavelength_nm[-1]),
        "step_nm": parsed.step_nm,
        "gaps_nm": [list(gap) for gap in parsed.gaps_nm],
        "merged": parsed.merged,
        "quantity": parsed.quantity,
        "scale": parsed.scale,
        "factor": parsed.factor,
        "level": parsed.level,
        "per": parsed.per,
        "source": parsed.said_source,
        "source_notes": list(parsed.said_notes),
        "notes": list(parsed.notes),
        "defects": list(parsed.defects),
        "questions": questions,
        "wavelength_nm": curves.wavelength_nm.tolist(),
        "values": {name: curves.values[:, k].tolist() for k, name in enumerate(curves.names)},
    }


def _ends(curves: Spectra) -> str:
    return f"{curves.wavelength_nm[0]:g}-{curves.wavelength_nm[-1]:g} nm"


def _steps(curves: Spectra) -> str:
    step = step_nm(curves.wavelength_nm)
    if step is not None:
        return f"step {step:g} nm"
    steps = np.diff(curves.wavelength_nm)
    return f"steps of {steps.min():g} to {steps.max():g} nm"
