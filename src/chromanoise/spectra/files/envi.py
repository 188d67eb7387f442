"""ENVI cubes: a text header that says how the numbers lie in the file beside it."""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Shaped
from chromanoise.spectra.files.wavelength_lists import NAMED_WAVELENGTH, NM_PER, nanometers

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
_NOT_APPLIED = (
    "bbl",
    "data ignore value",
)
_GAINS = (
    "data gain values",
    "data offset values",
    "data reflectance gain values",
    "data reflectance offset values",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class EnviHeader:
    """The ``key = value`` pairs of one header.

    Attributes
    ----------
    source
        The file; used in messages.
    fields
        Keys in lower case; braces taken off the values.
    """

    source: str
    fields: Mapping[str, str]

    def whole(self, key: str, *, default: int | None = None) -> int:
        """The number >= 0 that stands under ``key``; refused if absent without ``default``."""
        if default is not None and key not in self.fields:
            return default
        text = self.word(key)
        if not re.fullmatch(r"\+?[0-9]{1,18}", text):
            raise _check.InputError(
                f"{self.source}: {key!r} must be a whole number from 0 to 10^18, "
                f"but is {text[:40]!r}"
            )
        return int(text)

    def word(self, key: str) -> str:
        """The text that stands under ``key``; refused if absent."""
        if key not in self.fields:
            raise _check.InputError(
                f"{self.source}: the header lacks the required key {key!r}; add it"
            )
        return self.fields[key]


def envi_pair(path: Path) -> tuple[Path, Path] | None:
    """Header and data of the cube of which ``path`` is one; None if no header is beside it.

    Raises
    ------
    InputError
        If the header's data is missing, or several files could be it.
    """
    if path.suffix.lower() == ".hdr":
        return path, _data_beside(path)
    names = [(path.name + ".hdr").lower(), (path.stem + ".hdr").lower()]
    headers = sorted(_beside(path, set(names)), key=lambda p: names.index(p.name.lower()))
    return (headers[0], path) if headers else None


def _data_beside(header: Path) -> Path:
    names = {(header.stem + ending).lower() for ending in ("", *DATA_SUFFIXES)}
    found = sorted(_beside(header, names))
    if not found:
        raise _check.InputError(
            f"{header}: the data of this ENVI header is missing; looked beside it for "
            f"{header.stem} with nothing or one of {' '.join(DATA_SUFFIXES)} after it"
        )
    if len(found) > 1:
        raise _check.InputError(
            f"{header}: {len(found)} files could be the data of this ENVI header "
            f"({', '.join(p.name for p in found)}); name the data file itself"
        )
    return found[0]


def _beside(path: Path, names: set[str]) -> list[Path]:
    """Other files in the folder of ``path`` that bear one of the lower-case names."""
    near = (p for p in path.parent.iterdir() if p.name.lower() in names and p.name != path.name)
    return [p for p in near if p.is_file()]


def read_envi_header(path: Path) -> EnviHeader:
    """The header in ``path``; comments and keys without a value are passed over.

    Raises
    ------
    InputError
        If it is no ENVI header, a brace stays open, or it says the layout twice.
    """
    if path.stat().st_size > _LARGEST_HEADER_BYTES:
        raise _check.InputError(
            f"{path}: {path.stat().st_size / 2**20:.0f} MiB is too large for an ENVI header"
        )
    return envi_header(_decoded(path.read_bytes()), source=str(path))


def _decoded(raw: bytes) -> str:
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def envi_header(text: str, *, source: str) -> EnviHeader:
    r"""The header that stands in ``text``.

    Examples
    --------
    >>> envi_header("ENVI\nsamples = 3\nwavelength = {1,\n 2}", source="a text").fields
    {'samples': '3', 'wavelength': '1, 2'}
    """
    lines = re.split(r"\r\n|\r|\n", text)
    if lines[0].strip() != "ENVI":
        raise _check.InputError(
            f"{source}: not an ENVI header, its first line must be ENVI, but is {lines[0][:40]!r}"
        )
    fields: dict[str, str] = {}
    for key, value in _pairs(lines[1:], source):
        if key in _LAYOUT and fields.get(key, value) != value:
            raise _check.InputError(
                f"{source}: {key!r} stands twice, as {fields[key][:40]!r} and {value[:40]!r}; "
                "keep the true one"
            )
        fields[key] = value
    return EnviHeader(source=source, fields=fields)


def _pairs(lines: list[str], source: str) -> Iterator[tuple[str, str]]:
    kept = iter([(i, s) for i, s in enumerate(lines, 2) if not s.lstrip().startswith(";")])
    for number, line in kept:
        key, equals, value = line.partition("=")
        value = value.strip()
        if value.startswith("{"):
            value = _braced(value[1:], (text for _, text in kept), f"{source}: line {number}")
        if equals:
            yield " ".join(key.lower().split()), value


def _braced(text: str, following: Iterator[str], where: str) -> str:
    """The text up to the closing brace, which may stand some lines below."""
    parts = [text]
    while "}" not in parts[-1]:
        more = next(following, None)
        if more is None:
            raise _check.InputError(
                f"{where}: the brace opened here is never closed; the header is cut short, or "
                "lacks a }"
            )
        parts.append(more)
    parts[-1] = parts[-1].partition("}")[0]
    return " ".join(part.strip() for part in parts).strip()


def envi_pixels(
    header: EnviHeader, data: Path
) -> tuple[Shaped[Array, "rows columns bands"], tuple[str, ...]]:
    """A view into ``data`` as the header lays it out, and what was assumed. Nothing is copied.

    Raises
    ------
    InputError
        If a key is missing or impossible, or the file is shorter or longer than it should be.
    """
    count = {axis: _positive(header, axis) for axis in ("lines", "samples", "bands")}
    dtype = _dtype(header)
    offset = header.whole("header offset", default=0)
    axes = _AXES[_interleave(header)]
    _refuse_compressed(header)
    _refuse_wrong_size(header, data, offset + math.prod(count.values()) * dtype.itemsize)
    shape = tuple(count[axis] for axis in axes)
    pixels = np.memmap(data, dtype=dtype, mode="r", offset=offset, shape=shape)
    view = pixels.transpose([axes.index(axis) for axis in ("lines", "samples", "bands")])
    return view, _layout_notes(header)


def _positive(header: EnviHeader, key: str) -> int:
    number = header.whole(key)
    if number < 1:
        raise _check.InputError(f"{header.source}: {key!r} must be at least 1, but is {number}")
    return number


def _dtype(header: EnviHeader) -> np.dtype:
    code = header.whole("data type")
    if code in _COMPLEX:
        raise _check.InputError(
            f"{header.source}: 'data type' {code} is complex numbers, but a reflectance is real; "
            "save real numbers, such as data type 4"
        )
    if code not in _DTYPES:
        raise _check.InputError(
            f"{header.source}: 'data type' {code} is not known; known: "
            f"{', '.join(str(known) for known in _DTYPES)}"
        )
    order = header.whole("byte order", default=0)
    if order not in (0, 1):
        raise _check.InputError(
            f"{header.source}: 'byte order' must be 0 (little-endian) or 1 (big-endian), "
            f"but is {order}"
        )
    return np.dtype("<>"[order] + _DTYPES[code])


def _interleave(header: EnviHeader) -> str:
    word = header.word("interleave").lower()
    if word not in _AXES:
        raise _check.InputError(
            f"{header.source}: 'interleave' must be bsq, bil or bip, but is {word[:40]!r}"
        )
    return word


def _refuse_compressed(header: EnviHeader) -> None:
    if header.whole("file compression", default=0) != 0:
        raise _check.InputError(
            f"{header.source}: 'file compression' says that the data is compressed, which is not "
            "read here; save it uncompressed"
        )


def _refuse_wrong_size(header: EnviHeader, data: Path, told: int) -> None:
    size = data.stat().st_size
    if size == told:
        return
    fault = "is truncated: it" if size < told else "is longer than its header says: it"
    raise _check.InputError(
        f"{data}: {fault} holds {size} bytes, but {header.source} describes {told} bytes (header "
        "offset included); copy the data again, or mend samples, lines, bands, data type or "
        "header offset"
    )


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
    """Reflectance per stored unit, from ``reflectance scale factor``; None if not told.

    Raises
    ------
    InputError
        If the header asks for a gain or offset per band instead, which is not applied.
    """
    gains = [key for key in _GAINS if key in header.fields]
    if gains:
        raise _check.InputError(
            f"{header.source}: {gains[0]!r} asks for a gain or offset per band, which is not "
            "applied here; apply it and save the cube again, or say --scale (reflectance per "
            "stored unit)"
        )
    if "reflectance scale factor" not in header.fields:
        return None
    factor = _number(header, "reflectance scale factor", header.word("reflectance scale factor"))
    if not (factor > 0 and math.isfinite(1 / factor)):
        raise _check.InputError(
            f"{header.source}: 'reflectance scale factor' must be > 0, but is {factor:g}; "
            "mend it or say --scale"
        )
    return 1 / factor


def has_envi_wavelengths(header: EnviHeader) -> bool:
    """Whether ``envi_wavelengths`` has something to read."""
    return bool(header.fields.get("wavelength")) or _named_wavelengths(header) is not None


def envi_wavelengths(header: EnviHeader) -> tuple[Float[Array, " m"], tuple[str, ...]]:
    """Centers of the bands as the header tells them [nm], and what was assumed.

    Raises
    ------
    InputError
        If an entry is no number, or the unit is not told and cannot be guessed.
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
        raise _check.InputError(
            f"{header.source}: the list 'wavelength' is empty; fill it, or give --wavelengths "
            "FIRST:LAST in nm if the bands are evenly spaced"
        )
    return [_number(header, f"entry {i} of 'wavelength'", cell) for i, cell in enumerate(cells)]


def _named_wavelengths(header: EnviHeader) -> Float[Array, " m"] | None:
    """Wavelengths out of names such as ``376.44 Nanometers``, if every name has one. [nm]"""
    names = [name for name in header.fields.get("band names", "").split(",") if name.strip()]
    found = [NAMED_WAVELENGTH.search(name) for name in names]
    if not found or None in found:
        return None
    return np.array([float(m[1]) * NM_PER[m[2].lower()] for m in found if m is not None])


def _number(header: EnviHeader, what: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _check.InputError(f"{header.source}: {what} is {text[:40]!r}, not a finite number")
    return value
