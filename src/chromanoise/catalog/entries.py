"""What is built in, and what a user's own folder adds: nothing without its provenance."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from chromanoise import _check
from chromanoise.catalog.names import unknown_name
from chromanoise.catalog.sensors import SENSOR_NAMES, sensor_named
from chromanoise.errors import InputError
from chromanoise.io.spectra import power_of_photons
from chromanoise.io.spectra.defects import defects_of
from chromanoise.spectra import DEFAULT_GRID, Spectra, infrared_parts
from chromanoise.spectra.tables import catalogue_curves, formulas, sources
from chromanoise.spectra.tables.folder import UserTable, user_curves, user_tables
from chromanoise.spectra.tables.provenance import Provenance

KINDS: Mapping[str, str] = {
    "sensors": "sensor",
    "illuminants": "illuminant",
    "reflectances": "reflectance",
    "filters": "filter",
    "scenes": "scene",
}
"""The kinds of entries, as the command names them."""

FOLDER_VARIABLE = "CHROMANOISE_CATALOG"
"""The environment variable that names a user's own folder."""

_FOUND_IN = ("QE", "response", "reflectance", "transmittance")


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One entry of the catalogue.

    Attributes
    ----------
    provenance
        Name, kind, source, license, quantity, known defects.
    start_nm, stop_nm
        Where it begins and ends; None for a formula that does not. [nm]
    found
        What the library itself finds odd in its numbers.
    asks
        What it needs to be told before it answers on 400-1050 nm, as options.
    channels
        Of a sensor: its channels; of a table of several curves: their names.
    file
        The table of a user's own folder; None for what is built in.
    """

    provenance: Provenance
    start_nm: float | None
    stop_nm: float | None
    found: tuple[str, ...] = ()
    asks: tuple[str, ...] = ()
    channels: tuple[str, ...] = ()
    file: Path | None = None


def catalog_folder() -> Path | None:
    """The user's own folder, as the environment names it; None where it names none."""
    named = os.environ.get(FOLDER_VARIABLE, "")
    return Path(named) if named else None


def catalog_entries(kind: str | None = None, *, folder: Path | None = None) -> tuple[Entry, ...]:
    """The entries of one kind, or all of them; a user's own stand last.

    Parameters
    ----------
    kind
        One of `KINDS`; None for all.
    folder
        A user's own folder, if any.

    Raises
    ------
    InputError
        If there is no such kind, or something in the folder has no provenance.
    """
    kinds = [*KINDS] if kind is None else [_check.one_of("kind", kind, [*KINDS])]
    own = own_tables(folder)
    entries = [*map(_built_in, _provenances()), *map(_own, own.values())]
    return tuple(e for word in kinds for e in entries if e.provenance.kind == KINDS[word])


def catalog_entry(name: str, *, folder: Path | None = None) -> Entry:
    """The entry called ``name``, or that of the family to which it belongs.

    Raises
    ------
    InputError
        If nothing is called that; the nearest names are told.

    Examples
    --------
    >>> catalog_entry("3200K").provenance.name
    '<T>K'
    """
    entries = {entry.provenance.name: entry for entry in catalog_entries(folder=folder)}
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
    """The names of one kind (``illuminant``), a user's own last; families as ``<T>K``.

    Raises
    ------
    InputError
        As `own_tables`.
    """
    own = [table.provenance for table in own_tables(folder).values()]
    return tuple(told.name for told in (*_provenances(), *own) if told.kind == kind)


def own_tables(folder: Path | None) -> Mapping[str, UserTable]:
    """The tables of a user's folder by name; none without a folder.

    Raises
    ------
    InputError
        If one has no provenance, or the name of something that is built in.
    """
    tables = {} if folder is None else user_tables(folder)
    built_in = _provenances()
    names = {told.name for told in built_in}
    patterns = [told.pattern for told in built_in if told.pattern]
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
    """The table ``name`` of the folder that the environment names; None where there is none.

    Raises
    ------
    InputError
        As `own_tables`, and if it is of another kind.
    """
    table = own_tables(catalog_folder()).get(name)
    if table is not None and table.provenance.kind != kind:
        found = f"{name!r} is a table of kind {table.provenance.kind} in {table.path.parent}"
        raise InputError(kind, f"must be of kind {kind}", value=name, found=found)
    return table


def catalog_file_of(name: str) -> Path | None:
    """The table of the user's folder behind a name of a sensor or light; None for built-in names.

    A light with an infrared diode beside it has the table of that light.

    Raises
    ------
    InputError
        As `own_tables`.
    """
    parts = infrared_parts(name)
    if parts is not None:
        return catalog_file_of(parts[0])
    table = own_tables(catalog_folder()).get(name)
    return None if table is None else table.path


def own_power(table: UserTable) -> Spectra:
    """The curve of a user's light as power, whichever way its table counts light.

    Raises
    ------
    InputError
        If the table cannot be read.
    """
    curves = replace(user_curves(table), source=table.provenance.name)
    return power_of_photons(curves) if table.provenance.per == "photon" else curves


def entries_as_json(entries: Sequence[Entry]) -> dict[str, Any]:
    """The entries as plain data, all that is known of each."""
    return {"entries": [_as_json(entry) for entry in entries]}


def pixel_told(entry: Entry) -> str:
    """The pixel of a sensor in one phrase, and where each number of it comes from."""
    told = entry.provenance
    known = ", ".join(f"{key} {value:g}" for key, value in told.pixel.items())
    absent = [key for key in ("pitch_um", "full_well_e", "read_noise_e") if key not in told.pixel]
    stands_in = f"the paper's stands in for {', '.join(absent)}" if absent else ""
    phrases = (f"{known} ({told.pixel_source})" if known else "", stands_in)
    return "; ".join(phrase for phrase in phrases if phrase)


def _as_json(entry: Entry) -> dict[str, Any]:
    told = entry.provenance
    data: dict[str, Any] = {
        "name": told.name,
        "kind": told.kind,
        "what": told.what,
        "source": told.source,
        "license": told.license,
        "start_nm": entry.start_nm,
        "stop_nm": entry.stop_nm,
        "quantity": told.quantity,
        "unit": told.unit,
        "level": told.level,
        "per": told.per,
        "done": told.done,
        "defects": told.defects,
        "found": list(entry.found),
        "asks": list(entry.asks),
        "curves": list(entry.channels),
        "file": None if entry.file is None else str(entry.file),
    }
    if told.kind == "sensor":
        data["mosaic"] = told.mosaic or None
        data["pixel"] = {**told.pixel, "told": pixel_told(entry)}
    return data


def _provenances() -> tuple[Provenance, ...]:
    """All that is built in, tables first, parts of something else left out."""
    return tuple(p for p in (*sources().values(), *formulas().values()) if p.kind != "part")


def _built_in(told: Provenance) -> Entry:
    if told.table:
        return _of_table(told, catalogue_curves(told))
    start, stop = told.range_nm or (None, None)
    channels = told.channels
    if told.kind == "sensor" and told.name in SENSOR_NAMES:
        channels = sensor_named(told.name, DEFAULT_GRID).names
    asks = tuple(_asks(told, start, stop))
    return Entry(provenance=told, start_nm=start, stop_nm=stop, asks=asks, channels=channels)


def _own(table: UserTable) -> Entry:
    return replace(_of_table(table.provenance, user_curves(table)), file=table.path)


def _of_table(told: Provenance, curves: Spectra) -> Entry:
    start, stop = float(curves.wavelength_nm[0]), float(curves.wavelength_nm[-1])
    found: tuple[str, ...] = ()
    if told.quantity in _FOUND_IN:
        kind: Any = told.quantity
        found = defects_of(curves, kind, "fraction", (), level=None)
    asks = tuple(_asks(told, start, stop))
    return Entry(
        provenance=told,
        start_nm=start,
        stop_nm=stop,
        found=found,
        asks=asks,
        channels=curves.names,
    )


def _asks(told: Provenance, start_nm: float | None, stop_nm: float | None) -> Iterator[str]:
    first, last = DEFAULT_GRID.wavelength_nm[[0, -1]]
    option = "--illuminant-beyond" if told.kind == "illuminant" else "--beyond"
    if (start_nm or first) > first or (stop_nm or last) < last:
        yield option
    if told.kind == "sensor" and told.level == "relative":
        yield "--peak-qe"
    if told.kind == "sensor" and told.quantity == "response" and told.per is None:
        yield "--energy or --photons"
