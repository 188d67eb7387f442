"""ENVI cubes and spectral libraries: a text header that describes a separate data file."""

import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, InputError, Setting, Shaped, dataclass
from chromanoise.io.source_files import has, real_of, refused
from chromanoise.io.spectra.cell_tables import number_in
from chromanoise.io.spectra.declared import known_unit, named_wavelengths, nanometers
from chromanoise.io.spectra.parsed import LARGEST, Found, known_columns, missing_notes

DATA_SUFFIXES = (".sli", ".img", ".raw", ".dat", ".bin", ".bsq", ".bil", ".bip")
_LARGEST_HEADER_BYTES = 16 * 2**20
_DTYPES = {
    1: "u1", 2: "i2", 3: "i4", 4: "f4", 5: "f8", 12: "u2", 13: "u4", 14: "i8", 15: "u8",
}  # fmt: skip
_COMPLEX = (6, 9)
_AXES = {
    "bsq": ("bands", "lines", "samples"),
    "bil": ("lines", "bands", "samples"),
    "bip": ("lines", "samples", "bands"),
}
_LAYOUT = (
    "samples", "lines", "bands", "data type", "interleave", "byte order", "header offset",
)  # fmt: skip
_NOT_APPLIED = ("bbl", "data ignore value")
GAINS = (
    "data gain values",
    "data offset values",
    "data reflectance gain values",
    "data reflectance offset values",
)


@dataclass(frozen=True, kw_only=True)
class EnviHeader:
    """The ``key = value`` pairs of one header.

    Attributes
    ----------
    source
        The name of the file in messages.
    fields
        The values by keys in lower case, without braces.
    """

    source: str
    fields: Mapping[str, str]

    def whole(self, key: str, *, default: int | None = None) -> int:
        """The number >= 0 of ``key``; an error if it is absent and there is no ``default``."""
        if default is not None and key not in self.fields:
            return default
        text = self.word(key)
        if not re.fullmatch(r"\+?[0-9]{1,18}", text):
            raise self.refused(key, "must be a whole number from 0 to 10^18", text)
        return int(text)

    def word(self, key: str) -> str:
        """The text of ``key``; an error if it is absent."""
        if key not in self.fields:
            raise self.refused(key, "is missing in the header", remedy="add it")
        return self.fields[key]

    def refused(self, key: str, requirement: str, value: Any = None, **more: Any) -> InputError:
        """The error about the value of ``key``."""
        return InputError(self.source, requirement, value=value, where=f"key {key!r}", **more)


def envi_pair(path: Path) -> tuple[Path, Path] | None:
    """Header and data of the cube to which ``path`` belongs; None if there is no header.

    Raises
    ------
    InputError
        If the data file of the header is missing or ambiguous.
    """
    if path.suffix.lower() == ".hdr":
        return path, _data_beside(path)
    names = [(path.name + ".hdr").lower(), (path.stem + ".hdr").lower()]
    header = min(_beside(path, names), key=lambda p: names.index(p.name.lower()), default=None)
    return None if header is None else (header, path)


def _data_beside(header: Path) -> Path:
    names = [(header.stem + ending).lower() for ending in ("", *DATA_SUFFIXES)]
    found = sorted(_beside(header, names))
    if not found:
        held = f"there is no {header.stem}, alone or with {' '.join(DATA_SUFFIXES)} after it"
        raise refused(header, "must have its data in the same folder", found=held)
    if len(found) > 1:
        need = "must have one data file"
        held = f"{len(found)} could be it: {', '.join(p.name for p in found)}"
        remedy = "name the data file instead of the header"
        raise refused(header, need, tuple(p.name for p in found), held, remedy=remedy)
    return found[0]


def _beside(path: Path, names: Collection[str]) -> list[Path]:
    """Other files in the folder of ``path`` with one of the lower-case names."""
    near = (p for p in path.parent.iterdir() if p.name.lower() in names and p.name != path.name)
    return [p for p in near if p.is_file()]


def read_envi_header(path: Path) -> EnviHeader:
    """Read the header in ``path``; comments and keys without a value are ignored.

    Raises
    ------
    InputError
        If it is not an ENVI header, a brace is not closed, or a key of the layout is repeated.
    """
    if path.stat().st_size > _LARGEST_HEADER_BYTES:
        need = f"must be at most {_LARGEST_HEADER_BYTES // 2**20} MiB for an ENVI header"
        raise refused(path, need, path.stat().st_size, f"is {path.stat().st_size / 2**20:.0f} MiB")
    raw = path.read_bytes()
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return envi_header(text, source=str(path))


def envi_header(text: str, *, source: str) -> EnviHeader:
    r"""Parse the header in ``text``.

    Examples
    --------
    >>> envi_header("ENVI\nsamples = 3\nwavelength = {1,\n 2}", source="a text").fields
    {'samples': '3', 'wavelength': '1, 2'}
    """
    lines = re.split(r"\r\n|\r|\n", text)
    if lines[0].strip() != "ENVI":
        need = "is not an ENVI header, whose first line is ENVI"
        raise refused(source, need, lines[0], f"begins with {lines[0][:40]!r}")
    fields: dict[str, str] = {}
    for key, value in _pairs(lines[1:], source):
        if key in _LAYOUT and fields.get(key, value) != value:
            need = "must have one value"
            found = f"has {fields[key][:40]!r} and {value[:40]!r}"
            where = f"key {key!r}"
            remedy = "keep the true one"
            raise refused(source, need, (fields[key], value), found, where=where, remedy=remedy)
        fields[key] = value
    return EnviHeader(source=source, fields=fields)


def _pairs(lines: list[str], source: str) -> Iterator[tuple[str, str]]:
    kept = iter([(i, s) for i, s in enumerate(lines, 2) if not s.lstrip().startswith(";")])
    for number, line in kept:
        key, equals, value = line.partition("=")
        value = value.strip()
        if value.startswith("{"):
            value = _braced(value[1:], (text for _, text in kept), source, number)
        if equals:
            yield " ".join(key.lower().split()), value


def _braced(text: str, following: Iterator[str], source: str, number: int) -> str:
    """The text up to the closing brace, which may be on a later line."""
    parts = [text]
    while "}" not in parts[-1]:
        more = next(following, None)
        if more is None:
            need = "opens a brace that is not closed"
            remedy = ("complete the header", "add the missing }")
            raise refused(source, need, where=f"line {number}", remedy=remedy)
        parts.append(more)
    parts[-1] = parts[-1].partition("}")[0]
    return " ".join(part.strip() for part in parts).strip()


def envi_pixels(
    header: EnviHeader, data: Path
) -> tuple[Shaped[Array, "rows columns bands"], tuple[str, ...]]:
    """A view of ``data`` in the layout of the header, without copying, and notes on assumptions.

    Raises
    ------
    InputError
        If a key is missing or invalid, or the size of the file differs from the declared one.
    """
    count = {axis: _positive(header, axis) for axis in ("lines", "samples", "bands")}
    dtype = _dtype(header)
    offset = header.whole("header offset", default=0)
    axes = _axes(header)
    _refuse_compressed(header)
    _refuse_wrong_size(header, data, offset + math.prod(count.values()) * dtype.itemsize)
    shape = tuple(count[axis] for axis in axes)
    pixels = np.memmap(data, dtype=dtype, mode="r", offset=offset, shape=shape)
    view = pixels.transpose([axes.index(axis) for axis in ("lines", "samples", "bands")])
    return view, _layout_notes(header)


def _positive(header: EnviHeader, key: str) -> int:
    number = header.whole(key)
    if number < 1:
        raise header.refused(key, "must be at least 1", number)
    return number


def _dtype(header: EnviHeader) -> np.dtype:
    code = header.whole("data type")
    if code in _COMPLEX:
        raise header.refused(
            "data type",
            "must be a type of real numbers",
            code,
            found=f"{code} is complex",
            remedy="save real numbers, such as data type 4",
        )
    if code not in _DTYPES:
        raise header.refused("data type", f"must be one of {', '.join(map(str, _DTYPES))}", code)
    order = header.whole("byte order", default=0)
    if order not in (0, 1):
        raise header.refused("byte order", "must be 0 (little-endian) or 1 (big-endian)", order)
    return np.dtype("<>"[order] + _DTYPES[code])


def _axes(header: EnviHeader) -> tuple[str, ...]:
    word = header.word("interleave").lower()
    if word not in _AXES:
        raise header.refused("interleave", "must be bsq, bil or bip", word)
    return _AXES[word]


def _refuse_compressed(header: EnviHeader) -> None:
    if header.whole("file compression", default=0) != 0:
        key, need = "file compression", "must be 0, because compressed data is not read"
        raise header.refused(key, need, header.fields[key], remedy="save the data uncompressed")


def _refuse_wrong_size(header: EnviHeader, data: Path, expected: int) -> None:
    size = data.stat().st_size
    if size == expected:
        return
    fault = "truncated" if size < expected else "too long"
    need = f"must have {expected} bytes, header offset included, as {header.source} describes"
    remedy = ("copy the data again", "correct samples, lines, bands, data type or header offset")
    raise refused(data, need, size, f"has {size} bytes and is {fault}", remedy=remedy)


def _layout_notes(header: EnviHeader) -> tuple[str, ...]:
    notes = [
        f"the header lacks {key!r}: taken as 0{meaning}"
        for key, meaning in (("byte order", " (little-endian)"), ("header offset", ""))
        if key not in header.fields
    ]
    passed_over = [key for key in _NOT_APPLIED if key in header.fields]
    if passed_over:
        notes.append(f"in the header but not applied: {', '.join(passed_over)}")
    return tuple(notes)


def envi_scale(header: EnviHeader) -> float | None:
    """Reflectance per stored unit, from ``reflectance scale factor``; None if not declared.

    Raises
    ------
    InputError
        If the header has a gain or offset per band instead, which is not supported.
    """
    gain = next((key for key in GAINS if key in header.fields), None)
    if gain is not None:
        remedy = ("apply them and save the cube again", Setting("scale"))
        raise header.refused(gain, "gains and offsets per band are not applied", remedy=remedy)
    key = "reflectance scale factor"
    if key not in header.fields:
        return None
    factor = _number(header, f"key {key!r}", header.word(key))
    if not (factor > 0 and math.isfinite(1 / factor)):
        raise header.refused(key, "must be > 0", factor, remedy=("correct it", Setting("scale")))
    return 1 / factor


def has_envi_wavelengths(header: EnviHeader) -> bool:
    """Whether the header has wavelengths for `envi_wavelengths`."""
    return bool(header.fields.get("wavelength")) or _named_wavelengths(header) is not None


def envi_wavelengths(header: EnviHeader) -> tuple[Float[Array, " m"], tuple[str, ...]]:
    """Centers of the bands from the header [nm], and notes on assumptions.

    Raises
    ------
    InputError
        If an entry is not a number, or the unit is neither declared nor clear from the numbers.
    """
    named = _named_wavelengths(header)
    if not header.fields.get("wavelength") and named is not None:
        return named, ("wavelengths taken from the header's 'band names'",)
    values = np.array(_listed_wavelengths(header))
    unit = header.fields.get("wavelength units", "")
    return nanometers(header.source, "wavelength", values, unit, unit_key="'wavelength units'")


def _listed_wavelengths(header: EnviHeader) -> list[float]:
    cells = [cell for cell in re.split(r"[,\s]+", header.word("wavelength")) if cell]
    if not cells:
        remedy = ("fill the list", Setting("wavelengths"))
        raise header.refused("wavelength", "must not be empty", remedy=remedy)
    return [_number(header, f"entry {i} of 'wavelength'", cell) for i, cell in enumerate(cells)]


def _named_wavelengths(header: EnviHeader) -> Float[Array, " m"] | None:
    """Wavelengths in the names of the bands, if every name has one. [nm]"""
    names = header.fields.get("band names", "").split(",")
    return named_wavelengths([name for name in names if name.strip()])


def _number(header: EnviHeader, where: str, text: str) -> float:
    value = real_of(text)
    if not math.isfinite(value):
        raise refused(header.source, "must be a finite number", text, where=where)
    return value


_LIBRARY = "envi spectral library"
_UNSAID = ("", "unknown", "index")


def envi_library(path: Path, content: bytes) -> tuple[EnviHeader, Path] | None:
    """Header and data of the library if ``path`` is either of them; None for other files.

    Raises
    ------
    InputError
        If the header is not that of a library, or the other file is missing.
    """
    if content.lstrip()[:5].split() == [b"ENVI"]:
        return _library(*(envi_pair(path.with_suffix(".hdr")) or (path, path)))
    if path.suffix.lower() != ".sli" and b"\0" not in content:
        return None
    pair = envi_pair(path)
    if pair is None and path.suffix.lower() == ".sli":
        need = "must have its ENVI header in the same folder"
        raise refused(path, need, f"{path.stem}.hdr", f"there is no {path.stem}.hdr")
    return None if pair is None else _library(*pair)


def _library(header_file: Path, data: Path) -> tuple[EnviHeader, Path]:
    header = read_envi_header(header_file)
    kind = header.fields.get("file type", "")
    if kind.lower() != _LIBRARY and not _is_line_of_spectra(header):
        need = "must be ENVI Spectral Library, or have one sample or one line"
        raise header.refused("file type", need, kind, remedy="name a file of spectra, not a cube")
    return header, data


def _is_line_of_spectra(header: EnviHeader) -> bool:
    """Whether a cube is a list of spectra, as isofit stores its libraries."""
    sides = (header.whole("samples", default=0), header.whole("lines", default=0))
    return 1 in sides and header.whole("bands", default=0) > 1


def read_envi_library(header: EnviHeader, data: Path) -> Found:
    """The spectra of a library, divided by its reflectance scale factor.

    Raises
    ------
    InputError
        If the header lacks a key or contradicts the data.

    A cube of one sample or one line is a library as well, with its bands as wavelengths.

    Notes
    -----
    NV5 Geospatial, "ENVI Header Files": ``samples`` wavelengths, ``lines`` spectra, one band; the
    data divided by the ``reflectance scale factor`` are reflectances from 0 to 1.
    """
    gain = next((key for key in GAINS[:2] if key in header.fields), None)
    if gain is not None:
        remedy = "apply them and save the library again"
        raise header.refused(gain, "gains and offsets are not applied", remedy=remedy)
    pixels, notes = envi_pixels(header, data)
    if _is_line_of_spectra(header):
        pixels = pixels.reshape(-1, pixels.shape[2])[:, :, None]
    if pixels.shape[2] != 1:
        raise has(header.source, "must have 1 band, as a spectral library", pixels.shape[2])
    text = header.fields.get("reflectance scale factor", "1")
    factor = number_in(text)
    if not factor > 0:
        raise header.refused("reflectance scale factor", "must be > 0", text)
    table = pixels[:, :, 0].astype(np.float64)
    table[~(np.abs(table) <= LARGEST)] = np.nan
    wavelength, heading = _wavelengths(header, table.shape[1])
    curves = list(zip(_names(header, table.shape[0]), table, strict=True))
    deleted = "values that are not numbers or marked as deleted"
    said = [header.fields.get(key, "") for key in ("description", "z plot titles")]
    return Found(
        source=header.source,
        format="ENVI spectral library",
        columns=tuple(
            replace(one, values=one.values / factor) for one in known_columns(wavelength, curves)
        ),
        heading=heading,
        words=" ".join(said),
        quantity="reflectance" if "reflectance scale factor" in header.fields else None,
        scale="fraction" if "reflectance scale factor" in header.fields else None,
        notes=(
            *notes,
            *((f"divided by the reflectance scale factor {factor:g}",) if factor != 1 else ()),
        ),
        defects=missing_notes(wavelength, curves, deleted),
    )


def library_files(path: Path) -> tuple[Path, ...]:
    """All files that belong to a file of spectra: header and data of a library, or the file.

    Raises
    ------
    InputError
        If the data file of a header is missing.
    """
    pair = envi_pair(path) if path.suffix.lower() in (".sli", ".hdr") and path.exists() else None
    return pair or (path,)


def _wavelengths(header: EnviHeader, count: int) -> tuple[Array, str]:
    """The wavelengths that the header lists, and a heading with their unit."""
    cells = [cell.strip() for cell in header.word("wavelength").split(",")]
    numbers = np.array([number_in(cell) for cell in cells])
    if numbers.size != count:
        need = f"must list {count} numbers, one per wavelength of the data"
        raise header.refused("wavelength", need, numbers.size, found=f"lists {numbers.size}")
    if np.isnan(numbers).any():
        at = int(np.isnan(numbers).argmax())
        where = f"entry {at} of 'wavelength'"
        raise refused(header.source, "must be a number", cells[at], where=where)
    unit = header.fields.get("wavelength units", "")
    if unit.lower() in _UNSAID:
        return numbers, ""
    return numbers, f"wavelength [{known_unit(unit, header.source)}]"


def _names(header: EnviHeader, count: int) -> tuple[str, ...]:
    names = [name.strip() for name in header.fields.get("spectra names", "").split(",")]
    if len(names) == count and all(names):
        return tuple(
            name if names.count(name) == 1 else f"{name} ({k + 1})" for k, name in enumerate(names)
        )
    return tuple(str(k + 1) for k in range(count))
