"""The JSON formats of curves; the keys of a file decide which one it is."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from chromanoise.base import Array, json_of
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.cell_tables import number_in
from chromanoise.io.spectra.parsed import (
    LARGEST,
    SPECTRA_SCHEMA,
    Column,
    Found,
    Level,
    array_of,
    known_columns,
    number_of,
    own_spectra,
)

_WAVELENGTHS = re.compile(r"(?i)(wavelengths?|lambdas?|waves?|wls?|nm)([ _]?\(?\w{1,12}\)?)?")
_UNIT = re.compile(r"(?i)wavelengths?[ _]units?")
_SSF = {"R": "red_ssf", "G": "green_ssf", "B": "blue_ssf"}


def read_json(text: str, source: str) -> Found:
    """The curves in JSON of this library, of rawtoaces, of DCamProf, or in plain lists.

    Raises
    ------
    InputError
        As `json_of`, or if it holds curves in none of these formats.

    Notes
    -----
    rawtoaces-data has ``spectral_data``; DCamProf (and the collection ssf-data) has ``ssf_bands``
    with ``red_ssf``, ``green_ssf`` and ``blue_ssf`` for a camera, ``bands`` and ``spectrum`` for a
    light. Any other JSON needs one list of wavelengths, and lists of values of the same length.
    """
    whole = json_of(text, source, any_number=True)
    assert isinstance(whole, dict)  # it begins with a brace
    schema = whole.get("schema")
    if schema == SPECTRA_SCHEMA:
        return own_spectra(whole, source)
    if isinstance(schema, str) and schema.startswith("chromanoise "):
        need = f"must have the schema {SPECTRA_SCHEMA!r}"
        remedy = ("convert it to .csv", "name another file")
        raise refused(source, need, schema, f"has {schema[:40]!r}", remedy=remedy)
    try:
        if "ssf_bands" in whole:
            return _camera_of_dcamprof(whole, source)
        if "bands" in whole and "spectrum" in whole:
            return _spectrum_of_dcamprof(whole, source)
        if "spectral_data" not in whole and (found := _lists(whole, source)) is not None:
            return found
    except (TypeError, OverflowError) as error:
        raise refused(source, f"its lists are not curves ({error})") from None
    return read_rawtoaces(whole, source)


def _camera_of_dcamprof(whole: Mapping[str, Any], source: str) -> Found:
    """A camera. DCamProf multiplies the curves by spectral power, so the response is per energy."""
    missing = [key for key in _SSF.values() if key not in whole]
    if missing:
        need = f"must have {', '.join(missing)} beside ssf_bands, as a camera of DCamProf"
        raise refused(source, need, tuple(missing), f"{', '.join(missing)} is missing")
    at = _bands(whole["ssf_bands"], source)
    name = whole.get("camera_name")
    return Found(
        source=source,
        format="DCamProf JSON, a camera (as in ssf-data)",
        columns=_columns({channel: whole[key] for channel, key in _SSF.items()}, at, source),
        words="",
        wavelength_unit="nm",
        quantity="response",
        per="energy",
        level="relative",
        notes=(
            *((f"the file says: camera_name: {str(name)[:200]}",) if name else ()),
            "taken as relative response per energy, as in DCamProf",
        ),
    )


def _spectrum_of_dcamprof(whole: Mapping[str, Any], source: str) -> Found:
    at = _bands(whole["bands"], source)
    scale = number_of(whole.get("scale", 1))
    if not 0 < scale <= LARGEST:
        raise refused(source, "must be > 0", scale, where="key 'scale'")
    (column,) = _columns({str(whole.get("name") or "spectrum"): whole["spectrum"]}, at, source)
    return Found(
        source=source,
        format="DCamProf JSON, a spectrum",
        columns=(replace(column, values=column.values / scale),),
        words=" ".join(_words(whole)),
        wavelength_unit="nm",
        named=False,
        notes=(f"divided by its scale {scale:g}",) if scale != 1 else (),
    )


def _bands(given: Any, source: str) -> Array:
    """Wavelengths from a list of all, or from three numbers: first, last, step."""
    bands = array_of(given, 1)
    if bands.size != 3 or not 0 < bands[2] <= bands[1]:
        return bands
    if bands[2] > bands[1] - bands[0] or (bands[1] - bands[0]) / bands[2] > 10_000:
        need = "must be first, last and step, if they are three numbers"
        raise refused(source, need, bands.tolist(), where="key 'bands'")
    return np.arange(bands[0], bands[1] + bands[2] / 2, bands[2])


def _lists(whole: Mapping[str, Any], source: str) -> Found | None:
    """Curves from one list of wavelengths and lists at its level or one below; else None."""
    keys = [k for k, v in whole.items() if isinstance(v, list) and _WAVELENGTHS.fullmatch(k)]
    if len(keys) != 1:
        return None
    at = array_of(whole[keys[0]], 1)
    lists = {k: v for k, v in _lists_in(whole) if k != keys[0]}
    if not lists:
        return None
    said = next((str(v) for k, v in whole.items() if _UNIT.fullmatch(k)), "")
    return Found(
        source=source,
        format="JSON, lists of numbers",
        columns=_columns(lists, at, source),
        heading=" ".join([*keys[0].split("_"), f"[{said}]" if said else ""]).strip(),
        words=" ".join(_words(whole)),
    )


def _lists_in(whole: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in whole.items():
        if isinstance(value, list) and _of_numbers(value):
            yield key, value
        elif isinstance(value, dict):
            yield from ((k, v) for k, v in value.items() if isinstance(v, list) and _of_numbers(v))


def _of_numbers(values: list[Any]) -> bool:
    return bool(values) and not isinstance(values[0], str | list | dict)


def _words(whole: Mapping[str, Any]) -> list[str]:
    nested = [key for key, value in whole.items() if isinstance(value, dict)]
    return [*(str(value) for value in whole.values() if isinstance(value, str)), *nested]


def _columns(lists: Mapping[str, Any], at: Array, source: str) -> tuple[Column, ...]:
    columns = []
    for name, given in lists.items():
        values, where = array_of(given, 1), f"key {name[:40]!r}"
        if values.size != at.size:
            need = f"must have {at.size} values, as many as wavelengths"
            raise has(source, need, values.size, where=where)
        if not (np.abs(np.append(values, at)) <= LARGEST).all():
            raise refused(source, "must be finite numbers of at most 1e30", where=where)
        columns.append(Column(name=name, wavelength=at, values=values))
    return tuple(columns)


def read_rawtoaces(whole: Mapping[str, Any], source: str) -> Found:
    """Read the curves of a camera or an illuminant in the format of rawtoaces.

    Raises
    ------
    InputError
        If ``spectral_data`` is missing or has another form.

    Notes
    -----
    rawtoaces multiplies the camera's curves by radiant power, so they count light per energy.
    """
    spectral = _member(whole, "spectral_data", source)
    data = _member(_member(spectral, "data", source), "main", source)
    rows = [_row(at, values, source) for at, values in data.items()]
    sizes = sorted({str(len(row) - 1) for row in rows})
    if len(rows) < 2 or len(sizes) != 1:
        need = "must have 2 wavelengths with the same number of values"
        found = f"{len(rows)} have {', '.join(sizes) or 'none'}"
        raise refused(source, need, len(rows), found, where="key 'spectral_data.data.main'")
    table = np.array(rows, dtype=np.float64)
    names = _names(spectral, table.shape[1] - 1, source)
    header = whole.get("header")
    facts = {k: str(v) for k, v in header.items() if v} if isinstance(header, dict) else {}
    level: Level | None = "relative" if spectral.get("units") == "relative" else None
    return Found(
        source=source,
        format="rawtoaces JSON",
        columns=known_columns(table[:, 0], zip(names, table[:, 1:].T, strict=True)),
        words=" ".join(facts.values()),
        wavelength_unit="nm",
        quantity="response" if len(names) == 3 else "power",
        per="energy",
        level=level,
        notes=(
            *(f"the file says: {key}: {fact[:200]}" for key, fact in list(facts.items())[:20]),
            "light is counted as energy, as rawtoaces does",
        ),
    )


def _member(of: Mapping[str, Any], name: str, source: str) -> dict[str, Any]:
    member = of.get(name)
    if not isinstance(member, dict):
        need = f"must have the object {name!r}, as a rawtoaces file with spectral_data.data.main"
        raise refused(source, need, member)
    return member


def _row(at: str, values: Any, source: str) -> list[float]:
    cells = values if isinstance(values, list) else [values]
    real = [v for v in cells if isinstance(v, int | float) and not isinstance(v, bool)]
    wavelength = number_in(at)
    where = f"entry {at[:40]!r} of spectral_data.data.main"
    if wavelength != wavelength or len(real) != len(cells) or not cells:
        raise refused(source, "must be a wavelength with a list of numbers", values, where=where)
    if not all(abs(v) <= LARGEST for v in real):
        need = "must be finite and at most 1e30"
        raise refused(source, need, values, where=where, remedy="correct it")
    return [wavelength, *map(float, real)]


def _names(spectral: dict[str, Any], curves: int, source: str) -> tuple[str, ...]:
    index = spectral.get("index")
    names = index.get("main") if isinstance(index, dict) else None
    if names is None:
        return tuple(str(k + 1) for k in range(curves))
    if not isinstance(names, list) or len(names) != curves:
        need = f"must name the {curves} values of each wavelength"
        raise refused(source, need, names, where="key 'spectral_data.index.main'")
    return tuple(str(name) for name in names)
