"""Catalog entries with their provenance: built-in ones, and those of a user's folder."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from chromanoise import _check
from chromanoise.catalog.names import unknown_name
from chromanoise.catalog.sensors import SENSOR_NAMES, sensor_named
from chromanoise.errors import InputError, known_name
from chromanoise.io.spectra import power_of_photons
from chromanoise.io.spectra.defects import defects_of
from chromanoise.sensor import PIXEL_REQUIRED
from chromanoise.spectra import DEFAULT_GRID, Spectra, infrared_parts
from chromanoise.spectra.tables import catalog_curves, formulas, sources
from chromanoise.spectra.tables.folder import UserTable, user_curves, user_tables
from chromanoise.spectra.tables.provenance import Provenance

KINDS: Mapping[str, str] = {
    "sensors": "sensor",
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


@dataclass(frozen=True, slots=True, kw_only=True)
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
        One of `KINDS`; None for all.
    folder
        A user's folder, if any.

    Raises
    ------
    InputError
        If the kind is unknown, or a table in the folder has no provenance.
    """
    kinds = [*KINDS] if kind is None else [_check.one_of("kind", kind, [*KINDS])]
    own = own_tables(folder)
    entries = [*map(_built_in, _provenances()), *map(_own, own.values())]
    return tuple(e for word in kinds for e in entries if e.provenance.kind == KINDS[word])


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

    Raises
    ------
    InputError
        As for `own_tables`.
    """
    own = [table.provenance for table in own_tables(folder).values()]
    return tuple(
        provenance.name for provenance in (*_provenances(), *own) if provenance.kind == kind
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
        As for `own_tables`, or if the table is of another kind.
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
        As for `own_tables`.
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
    provenance = entry.provenance
    known = ", ".join(f"{key} {value:g}" for key, value in provenance.pixel.items())
    absent = [key for key in PIXEL_REQUIRED if key not in provenance.pixel]
    default = f"{', '.join(absent)} from the paper's pixel" if absent else ""
    phrases = (f"{known} ({provenance.pixel_source})" if known else "", default)
    return "; ".join(phrase for phrase in phrases if phrase)


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
    if provenance.kind == "sensor":
        data["mosaic"] = provenance.mosaic or None
        data["pixel"] = {**provenance.pixel, "told": pixel_summary(entry)}
    return data


def _provenances() -> tuple[Provenance, ...]:
    """The provenances of all built-in entries, tables first; those of kind ``part`` are omitted."""
    return tuple(p for p in (*sources().values(), *formulas().values()) if p.kind != "part")


def _built_in(provenance: Provenance) -> Entry:
    if provenance.table:
        return _of_table(provenance, catalog_curves(provenance))
    start, stop = provenance.range_nm or (None, None)
    channels = provenance.channels
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
    if (start_nm or first) > first or (stop_nm or last) < last:
        yield option
    if provenance.kind == "sensor" and provenance.level == "relative":
        yield "--peak-qe"
    if provenance.kind == "sensor" and provenance.quantity == "response" and provenance.per is None:
        yield "--energy or --photons"
