"""The catalog of sensors and tables by name, with provenance: built-in, or in a user's folder.

Sensors come from data sheets, from measured cameras, and from the paper. The four
``onyx-*`` sensors are a reconstruction consistent with the printed figures of the paper, whose
Figure 7 shows the curves of the Teledyne e2v Onyx only as a picture. They are neither a measurement
nor an independent validation.
"""

import os
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, get_args

from chromanoise.base import (
    Array,
    Float,
    InputError,
    Setting,
    check,
    dataclass,
    did_you_mean,
    known_name,
)
from chromanoise.io.spectra import (
    ASK,
    Answers,
    ParsedSpectra,
    Quantity,
    defects_of,
    power_of_photons,
    qe_of,
)
from chromanoise.sensor import (
    MODELS,
    PAPER_PIXEL,
    PIXEL,
    PIXEL_REQUIRED,
    Pixel,
    Sensor,
    bayer,
    behind_filter,
    mosaic_named,
    rgbw_sparse_4x4,
    with_channels,
)
from chromanoise.spectra import (
    DEFAULT_GRID,
    Grid,
    Provenance,
    Spectra,
    UserTable,
    infrared_parts,
    means_on_grid,
    on_grid,
    refuse_outside,
    user_curves,
    user_tables,
)
from chromanoise.spectra.tables import (
    catalog_curves,
    catalog_tables,
    formulas,
    packaged_table,
    sources,
)
from chromanoise.study.cameras import camera_pixel


def unknown_name(
    subject: str, name: str, known: Sequence[str], *, requirement: str = "must be in the catalog"
) -> InputError:
    """The error for a name that is not in the catalog; its remedy gives the nearest names.

    Parameters
    ----------
    subject
        What the name stands for: ``sensor``, ``illuminant``, ``filter``.
    name
        The name that the user wrote.
    known
        The names in the catalog; families as ``LED<nm>/<width>``.
    requirement
        The requirement in the message.

    Examples
    --------
    >>> str(unknown_name("filter", "ircut-schot", ["ircut-schott", "wratten-12"]))
    "filter must be in the catalog, but is 'ircut-schot'; did you mean ircut-schott?"
    >>> str(unknown_name("filter", "x", ["ircut-schott"]))
    "filter must be in the catalog, but is 'x'; see the catalog"
    """
    remedy = did_you_mean(name, known, "see the catalog", plain=_without_parameters)
    if "<T>K" in known and re.fullmatch(r"\d+(\.\d+)?", name):
        remedy = f"did you mean {name}K, a black body?"
    return InputError(subject, requirement, value=name, remedy=remedy)


def _without_parameters(name: str) -> str:
    """A family such as ``LED<nm>/<width>`` without its parameters, in lower case."""
    return re.sub("<[^>]*>", "", name).lower()


DEVICE_NAMES = (*catalog_tables("sensor"), *catalog_tables("camera"))
"""Sensors with curves from data sheets, and measured cameras."""


def sensor_from_table(
    provenance: Provenance,
    curves: Spectra,
    grid: Grid,
    *,
    answers: Answers,
    pixel: Mapping[str, float],
) -> Sensor:
    """The sensor of a table with provenance; its notes list defects and assumptions.

    Parameters
    ----------
    provenance
        The provenance of the table.
    curves
        The curves of its channels.
    answers
        Metadata that the table lacks: extrapolation ``beyond`` its ends, ``peak_qe`` of relative
        curves, ``per``. They override what the provenance assumes.
    pixel
        Values that override those of the source, by the names of `Pixel`.

    Raises
    ------
    InputError
        If required metadata is missing, or a QE lies outside 0 .. 1.
    """
    named = replace(curves, source=provenance.name)
    if answers.peak_qe is None and provenance.peak_qe is not None:
        answers = replace(answers, peak_qe=provenance.peak_qe)
    if answers.beyond == "refuse":
        answers = replace(answers, beyond=provenance.beyond)
    qe = qe_of(_understood(provenance, named, answers), answers)
    refuse_outside(qe, high=1.0, remedy=Setting("peak_qe"))
    resampled = means_on_grid(qe, grid, beyond=answers.beyond)
    known = {**provenance.pixel, **pixel}
    sensor = Sensor(
        name=provenance.name,
        grid=grid,
        qe=resampled.values,
        names=resampled.names,
        pixel=replace(PAPER_PIXEL, **known),
        mosaic=mosaic_named(provenance.mosaic) if provenance.mosaic else None,
        origin="measured",
    )
    electrons: tuple[str, ...] = ()
    if provenance.kind == "camera":
        found = camera_pixel(sensor, full_well_e=known.get("full_well_e"))
        known = {**found.known, **known}
        sensor = replace(sensor, pixel=replace(sensor.pixel, **known))
        electrons = (found.source,)
    notes = (
        provenance.source,
        *([] if provenance.defects.strip(" .").lower() == "none" else [provenance.defects]),
        *electrons,
        *assumed_pixel(provenance.name, sensor.pixel, known),
        *resampled.notes,
    )
    return replace(sensor, notes=notes)


def _understood(provenance: Provenance, curves: Spectra, answers: Answers) -> ParsedSpectra:
    """The table as if it were parsed from a file with the metadata of its provenance."""
    quantity = provenance.quantity
    if quantity not in get_args(Quantity):
        need = "must hold QE or response to be a sensor"
        raise InputError(provenance.name, need, value=quantity, found=f"holds {quantity}")
    return ParsedSpectra(
        curves=curves,
        format="table",
        wavelength_unit="nm",
        scale="as written",
        quantity=quantity,  # type: ignore[arg-type]
        level=provenance.level,
        per=provenance.per or ("photon" if quantity == "QE" else answers.per),
    )


def assumed_pixel(name: str, pixel: Pixel, known: Collection[str]) -> tuple[str, ...]:
    """A note on the values of the paper's pixel that are assumed, in numbers, if there are any.

    Parameters
    ----------
    name
        Name of the sensor.
    known
        Names of the fields that are known.

    Examples
    --------
    >>> assumed_pixel("my.csv", PAPER_PIXEL, {"pitch_um"})
    ('full well and read noise of my.csv not given: using 10000 e-, 10 e-',)
    """
    missing = [field for field in PIXEL_REQUIRED if field not in known]
    if not missing:
        return ()
    values = ", ".join(f"{getattr(pixel, field):g} {PIXEL[field].unit}" for field in missing)
    words = [PIXEL[field].label for field in missing]
    listed = " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
    return (f"{listed} of {name} {_USING}{values}",)


def is_assumed(sensor: Sensor, name: str) -> bool:
    """Whether a value of the sensor's pixel is that of the paper's pixel for want of its own.

    Parameters
    ----------
    sensor
        Of the catalog or a file.
    """
    return any(PIXEL[name].label in note.partition(" of ")[0] for note in assumptions(sensor))


def assumptions(sensor: Sensor) -> tuple[str, ...]:
    """The notes of a sensor on values of the paper's pixel that it has for want of its own."""
    return tuple(note for note in sensor.notes if _USING in note)


_USING = "not given: using "


RECONSTRUCTION = (
    "curves are a reconstruction consistent with the paper's printed figures, not a measurement"
)


def onyx_rgbw(grid: Grid) -> Sensor:
    """The paper's RGBW_n: R, G, B and white without an IR-cut filter (reconstruction)."""
    curves = on_grid(packaged_table("onyx_reconstruction"), grid)
    return Sensor(
        name="onyx-rgbw",
        grid=grid,
        qe=curves.values,
        names=curves.names,
        pixel=PAPER_PIXEL,
        mosaic=rgbw_sparse_4x4(),
        origin="reconstruction",
        notes=(RECONSTRUCTION,),
    )


def onyx_rgb(grid: Grid) -> Sensor:
    """R, G and B without IR-cut: the first sensor that the paper excludes (reconstruction)."""
    return with_channels(onyx_rgbw(grid), ("R", "G", "B"), name="onyx-rgb", mosaic=bayer())


def onyx_rgbw_ircut(grid: Grid) -> Sensor:
    """RGBW behind the IR-cut: the second sensor that the paper excludes (reconstruction)."""
    return behind_filter(onyx_rgbw(grid), _onyx_ir_cut(grid), name="onyx-rgbw-ircut")


def onyx_rgb_ircut(grid: Grid) -> Sensor:
    """The paper's classical RGB sensor, behind the IR-cut (reconstruction)."""
    return behind_filter(onyx_rgb(grid), _onyx_ir_cut(grid), name="onyx-rgb-ircut")


_MAKERS: dict[str, Callable[[Grid], Sensor]] = {
    "onyx-rgbw": onyx_rgbw,
    "onyx-rgb-ircut": onyx_rgb_ircut,
    "onyx-rgb": onyx_rgb,
    "onyx-rgbw-ircut": onyx_rgbw_ircut,
    **MODELS,
}
SENSOR_NAMES = tuple(_MAKERS)
"""The paper's sensors and the models; they need no answers on any grid within 400-1050 nm."""

KNOWN_SENSORS = (*SENSOR_NAMES, *DEVICE_NAMES)
"""The names for `sensor_named`."""


def sensor_named(
    name: str,
    grid: Grid = DEFAULT_GRID,
    *,
    answers: Answers = ASK,
    pixel: Mapping[str, float] = MappingProxyType({}),
) -> Sensor:
    """The sensor ``name`` of the catalog on ``grid``.

    Parameters
    ----------
    answers
        Metadata that the table of a real device lacks: the extrapolation, the highest QE of
        relative curves, how light was counted.
    pixel
        Values that override the sensor's, by the names of `Pixel`. [um], [e-], [e-]

    Returns
    -------
    Sensor
        Its quantum efficiencies on the grid [e-/photon] and its pixel.

    Raises
    ------
    InputError
        If the name is unknown (the message suggests similar names), or an answer is missing.

    Examples
    --------
    >>> sensor = sensor_named("mt9v024-rgbw", Grid.uniform(400, 1050, 10))
    >>> sensor.names, sensor.qe[15].round(2)                            # at 550 nm, G above W
    (('R', 'G', 'B', 'W'), array([0.05, 0.61, 0.07, 0.54]))
    """
    name = known_name(name, KNOWN_SENSORS)
    if name not in KNOWN_SENSORS:
        raise unknown_name("sensor", name, KNOWN_SENSORS)
    if name in _MAKERS:
        sensor = _MAKERS[name](grid)
        return replace(sensor, pixel=replace(sensor.pixel, **pixel))
    known = next(one for one in sources().values() if one.name == name)
    return sensor_from_table(known, catalog_curves(known), grid, answers=answers, pixel=pixel)


def _onyx_ir_cut(grid: Grid) -> Float[Array, " n"]:
    return on_grid(packaged_table("onyx_ir_cut"), grid).values[:, 0]


KINDS: Mapping[str, str] = {
    "sensors": "sensor",
    "cameras": "camera",
    "illuminants": "illuminant",
    "reflectances": "reflectance",
    "filters": "filter",
    "scenes": "scene",
}
"""The kinds of entries: their names on the command line and in a provenance."""

FOLDER_VARIABLE = "CHROMANOISE_CATALOG"
"""The environment variable with the path of a user's folder."""

_OF_CURVES = ("quantity", "unit", "level", "per", "done", "defects")
_FOUND_IN = ("QE", "response", "reflectance", "transmittance")


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One entry of the catalog.

    Attributes
    ----------
    provenance
        Name, kind, source, license, quantity, known defects.
    start_nm, stop_nm
        First and last wavelength; None for a formula without limits. [nm]
    found
        Defects that the library itself detects in the data.
    asks
        The command-line options that are required to use it on 400-1050 nm.
    channels
        The channels of a sensor, or the names of the curves of a table.
    file
        The table in a user's folder; None for built-in entries.
    """

    provenance: Provenance
    start_nm: float | None
    stop_nm: float | None
    found: tuple[str, ...] = ()
    asks: tuple[str, ...] = ()
    channels: tuple[str, ...] = ()
    file: Path | None = None


def catalog_folder() -> Path | None:
    """The user's folder from the environment variable; None if the variable is not set."""
    named = os.environ.get(FOLDER_VARIABLE, "")
    return Path(named) if named else None


def catalog_entries(kind: str | None = None, *, folder: Path | None = None) -> tuple[Entry, ...]:
    """The entries of one kind, or all of them; those of a user's folder come last.

    Parameters
    ----------
    kind
        One of ``KINDS``; None for all.
    folder
        A user's folder, if any.

    Raises
    ------
    InputError
        If the kind is unknown, or a table in the folder has no provenance.
    """
    kinds = [*KINDS] if kind is None else [check.one_of("kind", kind, [*KINDS])]
    own = own_tables(folder).values()
    return tuple(
        entry
        for word in kinds
        for entry in (
            *(_built_in(one) for one in _provenances() if one.kind == KINDS[word]),
            *(_own(table) for table in own if table.provenance.kind == KINDS[word]),
        )
    )


def catalog_entry(name: str, *, folder: Path | None = None) -> Entry:
    """The entry ``name``, or the entry of the family to which the name belongs.

    Parameters
    ----------
    name
        Name of a sensor, light, filter or family.
    folder
        The user's own catalog; ``None`` without one.

    Raises
    ------
    InputError
        If the name is unknown; the message suggests similar names.

    Examples
    --------
    >>> catalog_entry("3200K").provenance.name
    '<T>K'
    """
    entries = {entry.provenance.name: entry for entry in catalog_entries(folder=folder)}
    name = known_name(name, entries)
    if name in entries:
        return entries[name]
    for entry in entries.values():
        pattern = entry.provenance.pattern
        if pattern and re.fullmatch(pattern, name):
            return entry
    if name in KINDS:
        raise InputError("entry", "must be one entry, not a kind", value=name)
    raise unknown_name("entry", name, [*KINDS, *entries])


def catalog_names(kind: str, *, folder: Path | None = None) -> tuple[str, ...]:
    """The names of one kind (``illuminant``), the user's last; families as ``<T>K``.

    Cameras are sensors, too.

    Raises
    ------
    InputError
        As for ``own_tables``.
    """
    own = [table.provenance for table in own_tables(folder).values()]
    return tuple(
        one.name
        for one in (*_provenances(), *own)
        if one.kind == kind or (kind == "sensor" and one.is_sensor)
    )


def own_tables(folder: Path | None) -> Mapping[str, UserTable]:
    """The tables of a user's folder by name; empty without a folder.

    Raises
    ------
    InputError
        If a table has no provenance, or has the name of a built-in entry.
    """
    tables = {} if folder is None else user_tables(folder)
    built_in = _provenances()
    names = {provenance.name for provenance in built_in}
    patterns = [provenance.pattern for provenance in built_in if provenance.pattern]
    for name, table in tables.items():
        if name in names or any(re.fullmatch(pattern, name) for pattern in patterns):
            raise InputError(
                str(table.path),
                "must not have the name of a built-in entry",
                value=name,
                found=f"{name!r} is one",
                remedy="give the table another name",
            )
    return tables


def own_table(name: str, kind: str) -> UserTable | None:
    """The table ``name`` of the user's folder; None if there is none.

    Raises
    ------
    InputError
        As for ``own_tables``, or if the table is of another kind.
    """
    table = own_tables(catalog_folder()).get(name)
    if table is not None and table.provenance.kind != kind:
        found = f"{name!r} is a table of kind {table.provenance.kind} in {table.path.parent}"
        raise InputError(kind, f"must be of kind {kind}", value=name, found=found)
    return table


def catalog_file_of(name: str) -> Path | None:
    """The user's table for the name of a sensor or light; None for built-in names.

    For a light with an added infrared diode, this is the table of the light.

    Parameters
    ----------
    name
        Name of a sensor or light.

    Raises
    ------
    InputError
        As for ``own_tables``.
    """
    parts = infrared_parts(name)
    if parts is not None:
        return catalog_file_of(parts[0])
    table = own_tables(catalog_folder()).get(name)
    return None if table is None else table.path


def own_power(table: UserTable) -> Spectra:
    """The curve of a user's light as power, converted if its table counts photons.

    Raises
    ------
    InputError
        If the table cannot be read.
    """
    curves = replace(user_curves(table), source=table.provenance.name)
    return power_of_photons(curves) if table.provenance.per == "photon" else curves


def entries_as_json(entries: Sequence[Entry]) -> dict[str, Any]:
    """The entries with all their fields, as data for JSON."""
    return {"entries": [_as_json(entry) for entry in entries]}


def pixel_summary(entry: Entry) -> str:
    """The pixel of a sensor in one phrase, with the source of each number."""
    values, source = _known_pixel(entry.provenance)
    known = ", ".join(f"{key} {value:.4g}" for key, value in values.items())
    absent = [key for key in PIXEL_REQUIRED if key not in values]
    default = f"{', '.join(absent)} from the paper's pixel" if absent else ""
    phrases = (f"{known} ({source})" if known else "", default)
    return "; ".join(phrase for phrase in phrases if phrase)


def _known_pixel(provenance: Provenance) -> tuple[dict[str, float], str]:
    """What is known of a pixel, and its source; of a camera, electrons of its curves too."""
    values, source = dict(provenance.pixel), provenance.pixel_source
    if provenance.kind == "camera":
        found = camera_pixel(sensor_named(provenance.name))
        values |= found.known
        source = "; ".join(filter(None, (source, found.source)))
    return values, source


def _as_json(entry: Entry) -> dict[str, Any]:
    provenance = entry.provenance
    data: dict[str, Any] = {
        **{key: getattr(provenance, key) for key in ("name", "kind", "what", "source", "license")},
        "start_nm": entry.start_nm,
        "stop_nm": entry.stop_nm,
        **{key: getattr(provenance, key) for key in _OF_CURVES},
        "found": list(entry.found),
        "asks": list(entry.asks),
        "curves": list(entry.channels),
        "file": None if entry.file is None else str(entry.file),
    }
    if provenance.is_sensor:
        data["mosaic"] = provenance.mosaic or None
        data["pixel"] = {**_known_pixel(provenance)[0], "told": pixel_summary(entry)}
    return data


@cache
def _provenances() -> tuple[Provenance, ...]:
    """The provenances of all built-in entries, tables first; those of kind ``part`` are omitted."""
    return tuple(p for p in (*sources().values(), *formulas().values()) if p.kind != "part")


def _built_in(provenance: Provenance) -> Entry:
    if provenance.table:
        return _of_table(provenance, catalog_curves(provenance))
    start, stop = provenance.range_nm or (None, None)
    channels: tuple[str, ...] = ()
    if provenance.kind == "sensor" and provenance.name in SENSOR_NAMES:
        channels = sensor_named(provenance.name, DEFAULT_GRID).names
    asks = tuple(_asks(provenance, start, stop))
    return Entry(provenance=provenance, start_nm=start, stop_nm=stop, asks=asks, channels=channels)


def _own(table: UserTable) -> Entry:
    return replace(_of_table(table.provenance, user_curves(table)), file=table.path)


def _of_table(provenance: Provenance, curves: Spectra) -> Entry:
    start, stop = float(curves.wavelength_nm[0]), float(curves.wavelength_nm[-1])
    found: tuple[str, ...] = ()
    if provenance.quantity in _FOUND_IN:
        kind: Any = provenance.quantity
        found = defects_of(curves, kind, "fraction", (), level=None)
    asks = tuple(_asks(provenance, start, stop))
    return Entry(
        provenance=provenance,
        start_nm=start,
        stop_nm=stop,
        found=found,
        asks=asks,
        channels=curves.names,
    )


def _asks(provenance: Provenance, start_nm: float | None, stop_nm: float | None) -> Iterator[str]:
    first, last = DEFAULT_GRID.wavelength_nm[[0, -1]]
    option = "--illuminant-beyond" if provenance.kind == "illuminant" else "--beyond"
    ends = (start_nm or first) > first or (stop_nm or last) < last
    if ends and provenance.beyond == "refuse":
        yield option
    if provenance.is_sensor and provenance.level == "relative" and provenance.peak_qe is None:
        yield "--peak-qe"
    if provenance.is_sensor and provenance.quantity == "response" and provenance.per is None:
        yield "--energy or --photons"
