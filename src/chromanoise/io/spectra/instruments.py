"""Spectra in files of instruments and tools: ASD, FITS tables, MATLAB, IES TM-27.

ASD files are binary files of ASD field spectrometers (``.asd``, or numbers such as ``.000``). FITS
tables are read with astropy. MATLAB files are those of ISETCam (``wavelength``, ``data``), of
Psychtoolbox and of camera databases. IES TM-27 is one spectrum of a lamp in XML (``.spdx``).
"""

import io
import math
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import Array, InputError, optional_package
from chromanoise.io.matlab import mat_array, mat_arrays, mat_texts
from chromanoise.io.source_files import has, refused, xml_root
from chromanoise.io.spectra.cell_tables import finite_number
from chromanoise.io.spectra.declared import known_unit
from chromanoise.io.spectra.parsed import (
    LARGEST,
    Column,
    Found,
    Level,
    Per,
    Quantity,
    known_columns,
    missing_notes,
)

_MARK = re.compile(rb"ASD|as[2-8]")
_HEADER_BYTES = 484
_EXPORT = "export it as text with ViewSpec Pro"
_STORED = ("<f4", "<i4", "<f8")
_KINDS: tuple[tuple[str, Quantity | None], ...] = (
    ("raw counts", None), ("reflectance", "reflectance"), ("radiance", None), ("no unit", None),
    ("irradiance", None), ("quality index", None), ("transmittance", "transmittance"),
    ("unknown", None), ("absorbance", None),
)  # fmt: skip
_MOST_CHANNELS = 100_000


def is_asd(content: bytes) -> bool:
    """Whether these are the first bytes of an ASD file, versions 1 to 8."""
    return _MARK.match(content) is not None and b"\0" in content[:_HEADER_BYTES]


def read_asd(path: Path, content: bytes) -> Found:
    """The spectrum and the white reference of a file, or their ratio if the file declares it.

    Raises
    ------
    InputError
        If the file is cut short, or holds radiance, irradiance or absorbance, whose calibration is
        not applied.

    Notes
    -----
    ASD Inc., "ASD File Format, version 8", document 600979: a header of 484 bytes; the channels of
    the spectrum; from version 2 on a flag, two times, a text and the channels of the reference.
    A reflectance or transmittance is the spectrum divided by that reference.
    """
    if len(content) < _HEADER_BYTES:
        raise _damage(path, len(content), _HEADER_BYTES)
    kind, form = content[186], content[199]
    start_nm, step_nm = struct.unpack_from("<2f", content, 191)
    channels = struct.unpack_from("<H", content, 204)[0]
    if kind >= len(_KINDS) or form >= len(_STORED) or not (start_nm > 0 and step_nm > 0):
        need = "must declare its data type, its numbers and its wavelengths in its header"
        values = (kind, form, start_nm, step_nm)
        raise refused(path, need, values, remedy=_EXPORT)
    name, quantity = _KINDS[kind]
    if kind and quantity is None:
        need = "must hold reflectance, transmittance or raw counts"
        found = f"holds {name}, whose calibration is not applied"
        raise refused(path, need, name, found, remedy=_EXPORT)
    stored = np.dtype(_STORED[form])
    spectrum = _numbers(path, content, _HEADER_BYTES, channels, stored)
    reference = _reference(path, content, _HEADER_BYTES + channels * stored.itemsize, channels)
    at = start_nm + step_nm * np.arange(channels)
    curves = {name: spectrum}
    notes: tuple[str, ...] = ()
    if reference is not None and quantity is None:
        curves = {"spectrum": spectrum, "white reference": reference}
    elif reference is not None:
        lost = reference == 0
        curves = {name: np.divide(spectrum, reference, where=~lost, out=np.full(channels, np.nan))}
        notes = (f"{name} is the spectrum divided by its white reference, as the file declares",)
    return Found(
        source=str(path),
        format=f"ASD binary, version {content[:3].decode('ascii')}",
        columns=known_columns(at, curves.items()),
        wavelength_unit="nm",
        quantity=quantity,
        scale="fraction" if quantity and reference is not None else None,
        notes=notes,
    )


def _reference(path: Path, content: bytes, at: int, channels: int) -> Array | None:
    if content[:3] == b"ASD" or len(content) < at + 20:
        return None
    if not struct.unpack_from("<H", content, at)[0]:
        return None
    length = struct.unpack_from("<H", content, at + 18)[0]
    return _numbers(path, content, at + 20 + length, channels, np.dtype("<f8"))


def _numbers(path: Path, content: bytes, at: int, count: int, stored: np.dtype) -> Array:
    end = at + count * stored.itemsize
    if not 1 < count <= _MOST_CHANNELS or end > len(content):
        raise _damage(path, len(content), end)
    return np.frombuffer(content[at:end], dtype=stored).astype(np.float64)


def _damage(path: Path, size: int, needed: int) -> InputError:
    need = f"must have at least {needed} bytes, as its header declares"
    return refused(path, need, size, f"has {size}: it is damaged or cut short")


_WAVELENGTH = re.compile(r"(?i)(wavelengths?|waves?|wl|lambda|lam|loglam)(?![a-z])")
_MOST_CURVES = 1000


def read_fits(path: Path, content: bytes) -> Found:
    """The curves of the first table with a column of wavelengths, their units from ``TUNITn``.

    Raises
    ------
    InputError
        If astropy is not installed, or no table has such a column.

    Notes
    -----
    FITS Standard 4.0 (IAU FITS Working Group, 2018), sections 4.3 and 7.
    """
    fits = optional_package("astropy.io.fits", str(path), extra="fits")
    with fits.open(io.BytesIO(content), memmap=False) as parts:
        for place, part in enumerate(parts):
            names = list(getattr(getattr(part, "columns", None), "names", None) or ())
            at_names = [name for name in names if _WAVELENGTH.match(name)]
            if at_names:
                return _table(path, part, place, at_names[0])
    need = "must have a table with a column named wavelength, wave, lambda or wl"
    raise refused(path, need, remedy=("write the spectrum as such a table", "save it as CSV"))


def _table(path: Path, part: Any, place: int, at_name: str) -> Found:
    if at_name.lower().startswith("loglam"):
        raise refused(
            path, "must hold wavelengths, not their logarithms", where=f"column {at_name!r}"
        )
    units = {column.name: (column.unit or "").strip() for column in part.columns}
    at = _numbers_of_column(path, part, at_name)
    if part.data[at_name].dtype.itemsize == 4:  # 0.4 um in 4 bytes is 0.4, not 0.4000000060
        at = np.array([float(str(np.float32(value))) for value in at])
    if not np.isfinite(at).all():
        raise refused(path, "has rows without a wavelength", where=f"column {at_name!r}")
    others = [name for name in part.columns.names if name != at_name]
    curves = {
        name: values for name in others if (values := _curve(path, part, name, at)) is not None
    }
    if not 0 < len(curves) <= _MOST_CURVES:
        need = f"must have 1 to {_MOST_CURVES} columns with the length of {at_name!r}"
        raise has(str(path), need, len(curves))
    unit = known_unit(units[at_name], str(path)) if units[at_name] else ""
    return Found(
        source=str(path),
        format=f"FITS, table in part {place}",
        columns=known_columns(at, curves.items(), units),
        heading=f"{at_name} [{unit}]" if unit else at_name,
        words=" ".join(str(part.header.get(key, "")) for key in ("EXTNAME", "OBJECT", "TITLE")),
        defects=missing_notes(at, curves.items(), "values that are no number (NaN or TNULL)"),
    )


def _curve(path: Path, part: Any, name: str, at: Array) -> Array | None:
    """The numbers of a column; None if it contains text or has another length."""
    if part.data[name].dtype.kind not in "fiu":
        return None
    values = _numbers_of_column(path, part, name)
    return values if values.size == at.size else None


def _numbers_of_column(path: Path, part: Any, name: str) -> Array:
    """One number per row, or the one row of a table whose cells are lists; NaN for ``TNULLn``."""
    column = np.asarray(part.data[name])
    if column.dtype.kind not in "fiu" or (column.ndim > 1 and len(column) != 1):
        raise refused(path, "is not a list of numbers", where=f"column {name!r}")
    values = column.astype(np.float64).ravel()
    stored, null = np.asarray(part.data)[name], part.columns[name].null
    if stored.dtype.kind in "iu" and null is not None:  # TNULLn is the number before TSCALn, TZEROn
        values[stored.ravel() == null] = np.nan
    if (np.abs(values) > LARGEST).any():
        raise refused(
            path, "must be at most 1e30", float(np.nanmax(np.abs(values))), where=f"column {name!r}"
        )
    return values


_LARGEST_BYTES = 32 * 2**20
_WAVELENGTHS = ("wavelength", "wavelength_nm", "wave")
_WORDS = ("comment", "units", "type", "name")
_MOST_CURVES_OF_MATLAB = 2000
_OF_PSYCHTOOLBOX: dict[str, Quantity | None] = {
    "T": None, "spd": "power", "sur": "reflectance", "srf": "reflectance"
}  # fmt: skip
_JIANG_NM = np.arange(400.0, 721.0, 10.0)


def read_isetcam(path: Path) -> Found:
    """Read the curves of a MATLAB file, with their names and other texts.

    Raises
    ------
    InputError
        If it lacks ``wavelength`` or ``data``, or these do not fit each other, and it is not a
        file of Psychtoolbox or a camera of the database of Jiang et al. either.
    """
    arrays = mat_arrays(path)
    if all(name in arrays for name in "rgb") and not any(w in arrays for w in _WAVELENGTHS):
        return _camera_of_jiang(path, arrays)
    at_name = next((name for name in _WAVELENGTHS if name in arrays), None)
    sampled = [name for name in arrays if name.partition("_")[0] in _OF_PSYCHTOOLBOX]
    if at_name is None and sampled and f"S_{sampled[0].partition('_')[2]}" in arrays:
        return _of_psychtoolbox(path, arrays, sampled)
    if at_name is None or "data" not in arrays:
        held = ", ".join(list(arrays)[:20]) or "no arrays"
        raise refused(
            path,
            "must have the arrays wavelength and data, as ISETCam writes them, or S_name and "
            "T_name, spd_name or sur_name, as Psychtoolbox writes them",
            tuple(arrays),
            f"has {held}",
        )
    wavelength = _real(path, at_name, arrays[at_name]).ravel()
    if np.isnan(wavelength).any():
        raise _of_nan(path, "has NaN", f"array {at_name!r}", ("correct it", "remove it"))
    data = _upright(path, _real(path, "data", arrays["data"]), wavelength.size)
    n = wavelength.size
    square = f"data is {n} by {n}: its rows are taken for wavelengths, its columns for curves"
    words = {w: mat_texts(path, w) for w in _WORDS if w in arrays}
    names, notes = _names(path, arrays, data.shape[1], words.get("name", ()))
    text = " ".join(" ".join(texts) for texts in words.values())
    curves = list(zip(names, data.T, strict=True))
    comment = " ".join(" ".join(words.get("comment", ())).split())
    return Found(
        source=str(path),
        format="ISETCam MAT",
        columns=known_columns(wavelength, curves),
        words=text,
        # comment and name are free text
        keys={
            key: " ".join(words[field])
            for key, field in (("quantity", "type"), ("unit", "units"))
            if field in words
        },
        per="photon" if words.get("units") == ("photons",) else None,
        defects=missing_notes(wavelength, curves, "values that are no number (NaN)"),
        notes=(
            *notes,
            *([square] if data.shape[1] == n else ()),
            *((f"the file says: {comment}",) if comment else ()),
        ),
    )


def _of_psychtoolbox(path: Path, arrays: dict, sampled: list[str]) -> Found:
    """The curves of one array, whose wavelengths are ``S_name = [start, step, count]`` in nm.

    Notes
    -----
    Psychtoolbox, PsychColorimetricData: arrays ``T_`` have one curve per row, and ``spd_``,
    ``sur_`` and ``srf_`` (powers and reflectances) one per column.
    """
    if len(sampled) > 1:
        need = "must have one array of curves"
        remedy = "save one of them with its S_ array"
        raise refused(path, need, tuple(sampled), f"has {', '.join(sampled[:8])}", remedy=remedy)
    kind, _, rest = sampled[0].partition("_")
    sampling = _real(path, f"S_{rest}", arrays[f"S_{rest}"]).ravel()
    if sampling.size != 3 or sampling[0] <= 0 or sampling[1] <= 0 or sampling[2] < 2:
        need = "must be the first wavelength, the step and the number of wavelengths"
        raise refused(path, need, tuple(sampling.tolist()[:5]), where=f"array 'S_{rest}'")
    data = _real(path, sampled[0], arrays[sampled[0]])
    if kind == "T":
        data = data.T
    if data.shape[0] != sampling[2] or data.shape[1] > _MOST_CURVES_OF_MATLAB:
        need = f"must have {sampling[2]:g} wavelengths, as S_{rest} declares"
        raise refused(path, need, data.shape[0], where=f"array {sampled[0]!r}")
    quantity = _OF_PSYCHTOOLBOX[kind]
    at = sampling[0] + sampling[1] * np.arange(data.shape[0])
    names = [rest] if data.shape[1] == 1 else map(str, range(1, data.shape[1] + 1))
    return Found(
        source=str(path),
        format="Psychtoolbox MAT",
        columns=known_columns(at, zip(names, data.T, strict=True)),
        wavelength_unit="nm",
        quantity=quantity,
        per="energy" if quantity == "power" else None,
    )


def _camera_of_jiang(path: Path, arrays: dict) -> Found:
    """The sensitivities ``r``, ``g``, ``b``, whose wavelengths are given only in the paper.

    Notes
    -----
    Jiang, Liu, Gu & Suesstrunk, "What is the space of spectral sensitivity functions for digital
    color cameras?" (WACV 2013): 400-720 nm in steps of 10 nm, the raw value divided by the radiance
    and the exposure time, so light is counted as energy; each camera's highest value is 1.
    """
    curves = {name: _real(path, name, arrays[name]).ravel() for name in "rgb"}
    if any(curve.size != _JIANG_NM.size for curve in curves.values()):
        sizes = tuple(curve.size for curve in curves.values())
        raise refused(
            path,
            "must have an array of wavelengths",
            sizes,
            f"has only r, g and b of {', '.join(map(str, sizes))} values",
            remedy=(
                "add an array 'wavelength'",
                "save it as CSV",
                f"give r, g and b {_JIANG_NM.size} values for 400-720 nm in steps of 10 nm, as "
                "in the database of Jiang et al.",
            ),
        )
    if not all(np.isfinite(curve).all() for curve in curves.values()):
        raise _of_nan(path, "have NaN", "arrays r, g, b", ("correct them",))
    return Found(
        source=str(path),
        format="MATLAB, a camera of Jiang et al. (2013)",
        columns=known_columns(_JIANG_NM, zip("RGB", curves.values(), strict=True)),
        wavelength_unit="nm",
        quantity="response",
        per="energy",
        level="relative",
        notes=(
            "the file has no wavelengths: r, g, b of 33 values each are taken as from the camera "
            "database of Jiang et al. (WACV 2013), 400-720 nm in steps of 10 nm, per energy",
        ),
    )


def _of_nan(path: Path, found: str, where: str, remedy: tuple[str, ...]) -> InputError:
    return refused(path, "must be finite numbers", math.nan, found, where=where, remedy=remedy)


def _real(path: Path, name: str, declared: tuple[tuple[int, ...], np.dtype]) -> Array:
    (shape, dtype), where = declared, f"array {name!r}"
    if dtype.kind not in "fiu" or len(shape) != 2 or min(shape) < 1:
        need = "must be a table of real numbers"
        found = f"has the shape {shape} and the type {dtype}"
        raise refused(path, need, (shape, str(dtype)), found, where=where)
    if math.prod(shape) * 8 > _LARGEST_BYTES:
        need = f"must be at most {_LARGEST_BYTES // 2**20} MiB for a table of spectra"
        raise refused(path, need, shape, f"has the shape {shape}", where=where)
    array = mat_array(path, name).astype(np.float64)
    beyond = np.abs(array) > LARGEST
    if beyond.any():
        value = float(array[beyond][0])
        need, remedy = "must be at most 1e30", "correct it"
        raise refused(path, need, value, where=where, remedy=remedy)
    return array


def _upright(path: Path, data: Array, n: int) -> Array:
    """One row per wavelength."""
    if data.shape[0] != n and data.shape[1] == n:
        data = data.T
    if data.shape[0] != n or data.shape[1] > _MOST_CURVES_OF_MATLAB:
        need = f"must have {n} rows, as many as wavelengths"
        found = f"is {data.shape[0]} by {data.shape[1]}"
        raise refused(path, need, data.shape, found, where="array 'data'")
    return data


def _names(
    path: Path, arrays: dict, curves: int, own: tuple[str, ...]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    if "filterNames" in arrays:
        names = mat_texts(path, "filterNames")
        if len(names) == curves and all(names):
            return names, ()
        numbered = tuple(str(k + 1) for k in range(curves))
        return numbered, (f"{len(names)} names for {curves} curves: the curves are numbered",)
    if curves == 1:
        return (own[0] if own and own[0] else path.stem,), ()
    return tuple(str(k + 1) for k in range(curves)), ()


_QUANTITIES: dict[str, Quantity] = {
    "reflectance": "reflectance", "r-factor": "reflectance",
    "transmittance": "transmittance", "t-factor": "transmittance",
    "exitance": "power", "flux": "power", "intensity": "power", "irradiance": "power",
    "radiance": "power", "relative": "power",
}  # fmt: skip
_QUANTITY = r"(QE|response|reflectance|transmittance|power) \["
_PER = r".*?\blight counted per (photon|energy)\b"
_LEVEL = r".*?\blevel: (absolute|relative)\b"
_SCALE = r".*?\bscale: (fraction|as written)\b"
_NAMES = ("Manufacturer", "CatalogNumber", "Description")


def read_tm27(text: str, source: str) -> Found:
    """Read a TM-27 file; a document type raises an error, so that no entities are expanded.

    Raises
    ------
    InputError
        If it is not TM-27, or a value is not a number; the message names the line of an XML error.

    Notes
    -----
    ANSI/IES TM-27-20, "Standard Format for the Electronic Transfer of Spectral Data"; a
    ``relative`` spectrum is one of power.
    """
    root = xml_root(text, source)
    if not root.tag.rpartition("}")[2].upper().startswith("IESTM27"):
        raise refused(source, "is XML, but not IES TM-27", root.tag, f"its root is {root.tag[:60]}")
    parts = {e.tag.rpartition("}")[2]: (e.text or "").strip() for e in root.iter()}
    points = [e for e in root.iter() if e.tag.rpartition("}")[2] == "SpectralData"]
    if len(points) < 2:
        raise has(source, "must have at least 2 SpectralData", len(points))
    rows = [
        [finite_number(text, source, f"SpectralData {k}") for text in texts]
        for k, texts in enumerate(((e.get("wavelength", ""), e.text or "") for e in points), 1)
    ]
    table = np.array(rows, dtype=np.float64)
    quantity_word = parts.get("SpectralQuantity", "").lower()
    comments = parts.get("Comments", "")
    quantity = _QUANTITIES.get(quantity_word) or _ours(_QUANTITY, comments)
    ratio = quantity == "QE"  # electrons per photon
    per: Per | None = "photon" if ratio else _ours(_PER, comments)
    level: Level | None = _ours(_LEVEL, comments)
    if quantity == "power" and quantity_word != "other":
        per, level = per or "energy", "relative" if quantity_word == "relative" else "absolute"
    name = " - ".join(parts[n] for n in _NAMES if parts.get(n)) or "spectrum"
    kept = ("SpectralQuantity", "BandwidthFWHM", "BandwidthCorrected", "Comments")
    return Found(
        source=source,
        format="IES TM-27",
        columns=(Column(name=name, wavelength=table[:, 0], values=table[:, 1]),),
        words=quantity_word,
        wavelength_unit="nm",
        quantity=quantity,
        per=per,
        level=level,
        scale=_ours(_SCALE, comments),
        notes=tuple(f"the file says: {k} {parts[k][:200]}" for k in kept if parts.get(k)),
    )


def _ours(pattern: str, comments: str) -> Any:
    """The metadata in the comments of a file of this library that TM-27 has no field for."""
    match = re.match(pattern, comments)
    return match[1] if match else None
