"""The commands ``chromanoise convert`` and ``chromanoise inspect``."""

import datetime
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np

from chromanoise.base import InputError, Setting, among, write_whole
from chromanoise.cli.options import PATH, answering, answers_of, command, of_one_file
from chromanoise.cli.output import options_text, refuse_output, superfluous, write_json
from chromanoise.io import read_curves, sensor_data, sensor_json, spectra_json
from chromanoise.io.spectra import (
    ParsedSpectra,
    Question,
    gaps_nm,
    mosaic_text,
    photons_as_energy,
    rawtoaces_header,
    rawtoaces_json,
    sensor_csv,
    sensor_rawtoaces_json,
    sensor_spectra,
    spectra_csv,
    spectra_spdx,
    step_nm,
)
from chromanoise.sensor import Sensor
from chromanoise.spectra import Spectra
from chromanoise.study import (
    catalog_entry,
    catalog_folder,
    file_there,
    idle_answers,
    is_file_word,
    own_sensor_of,
    resolve_sensor,
)

Converted = tuple[str, list[str]]
"""The text of the file, and a list of what the format cannot keep."""

_ENDINGS = (".csv", ".json", ".spdx")


@command()
@click.argument("source", metavar="IN")
@click.argument("target", metavar="OUT", type=PATH)
@answering
@click.option(
    "--as",
    "form",
    type=click.Choice(["own", "rawtoaces"]),
    default="own",
    show_default=True,
    help="Form of JSON: own keeps everything, rawtoaces holds R, G, B of a camera.",
)
@of_one_file
@click.option(
    "--created",
    metavar="DATE",
    help="Date in TM-27 and rawtoaces files, e.g. 2026-01-31. [default: today]",
)
def convert(source: str, target: Path, form: str, created: str | None, **options: Any) -> None:
    """Write the curves of IN, a file of spectra or a sensor of the catalog, to OUT.

    OUT ends in .csv, .json (all data, or the form of rawtoaces) or .spdx (IES TM-27, one curve).
    chromanoise reads all of them. Numbers keep all their digits; a message lists what the format
    cannot keep.
    """
    ending = target.suffix.lower()
    demand = "" if ending in _ENDINGS else f"must end in {', '.join(_ENDINGS)}"
    if not demand and form == "rawtoaces" and ending != ".json":
        demand = "must end in .json for --as rawtoaces"
    if demand:
        found = f"ends in {ending!r}" if ending else "has no ending"
        raise InputError(str(target), demand, value=ending, found=found)
    refuse_output(target, "OUT", source)
    kind = form if form == "rawtoaces" else ending
    day = _day(created)
    read = _read(source, options)
    if isinstance(read, Sensor):
        text, lost = _of_sensor(read, kind, day, options["columns"])
    else:
        text, lost = _of_spectra(read, kind, day, options["columns"])
    write_whole(target, text.encode("utf-8"))
    click.echo(f"{target}: written")
    for what in lost:
        click.echo(f"not kept: {what}", err=True)


def _day(created: str | None) -> str:
    if created is None:
        return datetime.datetime.now(datetime.UTC).date().isoformat()
    try:
        return datetime.date.fromisoformat(created).isoformat()
    except ValueError:
        raise InputError("--created", "must be a date, e.g. 2026-01-31", value=created) from None


def _read(source: str, options: dict[str, Any]) -> Sensor | ParsedSpectra:
    """A sensor of the catalog or of a chromanoise JSON file, or the parsed curves of a file."""
    if not is_file_word(source, "sensor"):
        if options["quantity"] is not None:
            why = f"for {source}, a sensor of the catalog"
            raise superfluous("--quantity", why, options["quantity"])
        for name in idle_answers([source], answers_of(options)):
            why = f"for {source}, where it changes nothing"
            raise superfluous(name, why, options[name], setting=name)
        return resolve_sensor(source, answers=answers_of(options))
    path = file_there(source, "sensor")
    own = own_sensor_of(path)
    return own if own is not None else read_curves(path, answers=answers_of(options))


def _of_sensor(sensor: Sensor, kind: str, day: str, columns: tuple[str, ...]) -> Converted:
    if kind == ".json":
        _refuse_columns(columns, "a sensor")
        return sensor_json(sensor), []
    pixel = ["pixel and mosaic"] if sensor.mosaic is not None else ["pixel"]
    if kind == ".csv":
        _refuse_columns(columns, "a sensor")
        return sensor_csv(sensor), [f"{pixel[0]} (only in comments; use .json to keep it)"]
    if kind == "rawtoaces":
        _refuse_columns(columns, "a rawtoaces camera")
        text = sensor_rawtoaces_json(sensor, created=f"{day}T00:00:00Z")
        return text, [*pixel, *_lost_in_rawtoaces(sensor.names)]
    curves = sensor_spectra(sensor)
    name = _one(sensor.names, columns, sensor.name)
    return spectra_spdx(curves, name, created=day), [*pixel, *_lost_in_tm27(curves, name)]


def _of_spectra(parsed: ParsedSpectra, kind: str, day: str, columns: tuple[str, ...]) -> Converted:
    spectra, unsaid = _with_notes(parsed)
    facts = _facts(parsed)
    if kind == ".json":
        return spectra_json(spectra, facts), unsaid
    if kind == ".csv":
        notes = ["the notes, except as comments"] if spectra.notes else []
        return spectra_csv(spectra, facts), [*unsaid, *notes]
    if kind == "rawtoaces":
        text = rawtoaces_json(_per_energy(parsed), _header(spectra, day))
        return text, [*unsaid, *_lost_in_rawtoaces(spectra.names)]
    name = _one(spectra.names, columns, spectra.source)
    text = spectra_spdx(spectra, name, created=day, facts=facts)
    return text, [*unsaid, *_lost_in_tm27(spectra, name)]


def _facts(parsed: ParsedSpectra) -> dict[str, str]:
    """The facts that a format can declare; percent values are already converted to fractions."""
    scale = "as written" if parsed.scale == "as written" else "fraction"
    facts = {"level": parsed.level, "per": parsed.per, "scale": scale}
    return {key: fact for key, fact in facts.items() if fact is not None}


def _with_notes(parsed: ParsedSpectra) -> tuple[Spectra, list[str]]:
    """The curves, with all changes made to them as notes, and a list of unknown facts."""
    said = (*parsed.said_notes, *parsed.curves.notes, *parsed.notes, *parsed.defects)
    notes = tuple(dict.fromkeys(said))  # without repetition
    source = parsed.said_source or parsed.curves.source
    lost = [f"not declared: {one.asks} ({_options_of(one)})" for one in parsed.questions]
    if parsed.deviations is not None:
        lost.append("standard deviations")
    return replace(parsed.curves, source=source, notes=notes), lost


def _per_energy(parsed: ParsedSpectra) -> Spectra:
    curves = parsed.curves
    if parsed.quantity not in (None, "QE", "response"):
        raise InputError(
            curves.source,
            "must hold a response, as a rawtoaces camera",
            value=parsed.quantity,
            found=f"holds {parsed.quantity}",
        )
    if parsed.per is None:
        raise InputError(
            curves.source,
            "must declare whether it counts light as energy or in photons",
            found="declares neither",
            remedy=Setting("per", ("energy", "photon")),
        )
    return curves if parsed.per == "energy" else photons_as_energy(curves)


def _header(spectra: Spectra, day: str) -> dict[str, Any]:
    return rawtoaces_header(
        Path(spectra.source).stem, created=f"{day}T00:00:00Z", comments="; ".join(spectra.notes)
    )


def _one(names: tuple[str, ...], columns: tuple[str, ...], source: str) -> str:
    """The name of the curve for TM-27, which holds one curve."""
    if len(columns) == 1:
        return among(f"curve of {source}", columns[0], names)
    if len(names) == 1:
        return names[0]
    raise InputError(
        source,
        "must hold one curve for TM-27",
        value=names,
        found=f"holds {len(names)} curves ({', '.join(names[:12])})",
        remedy=Setting("columns"),
    )


def _refuse_columns(columns: tuple[str, ...], what: str) -> None:
    if columns:
        raise superfluous("--column", f"for {what}, which keeps all its curves", columns)


def _lost_in_rawtoaces(names: tuple[str, ...]) -> list[str]:
    lost = [f"channel {name}" for name in names if name not in "RGB"]
    return ["absolute scale (curves are normalized to a maximum of 1)", *lost]


def _lost_in_tm27(spectra: Spectra, kept: str) -> list[str]:
    notes = " and the notes" if spectra.notes else ""
    others = [name for name in spectra.names if name != kept]
    curves = [f"curve {', '.join(others)}"] if others else []
    return [f"unit {spectra.unit}{notes}, but for comments", *curves]


_MOST_NAMES = 12


@command()
@click.argument("file", type=PATH)
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
    refuse_output(json_target, "--json", str(file))
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
            why = "for the JSON of a sensor, which declares it"
            raise superfluous(name, why, value, setting=name)


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
    return lines + [f"  ASK            {q.asks} ({_options_of(q)})" for q in parsed.questions]


def _options_of(question: Question) -> str:
    """The options that answer a question."""
    return " or ".join(map(options_text, question.settings))


def _undeclared(parsed: ParsedSpectra) -> str:
    assumed = "not declared; a sensor takes it as absolute QE per photon (headed wavelength_nm)"
    return assumed if parsed.own_form else "unknown"


def summary_data(file: Path, parsed: ParsedSpectra) -> dict[str, Any]:
    """The preview as data, the curves included."""
    curves = parsed.curves
    questions = [
        {"about": q.about, "asks": q.asks, "options": _options_of(q)} for q in parsed.questions
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
