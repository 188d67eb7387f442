"""ENVI spectral libraries: spectra in rows of a binary file, with a separate text header."""

from pathlib import Path

import numpy as np

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.io.spectra.declared import known_unit
from chromanoise.io.spectra.envi import GAINS, EnviHeader, envi_pair, envi_pixels, read_envi_header
from chromanoise.io.spectra.parsed import Found, has, known_columns, missing_notes
from chromanoise.io.spectra.tables import number_in

_LIBRARY = "envi spectral library"
_LARGEST = 1e30  # USGS libraries mark deleted points by -1.23e34
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
        raise InputError(
            str(path),
            "must have its ENVI header in the same folder",
            value=f"{path.stem}.hdr",
            found=f"there is no {path.stem}.hdr",
        )
    return None if pair is None else _library(*pair)


def _library(header_file: Path, data: Path) -> tuple[EnviHeader, Path]:
    header = read_envi_header(header_file)
    kind = header.fields.get("file type", "")
    if kind.lower() != _LIBRARY and not _is_line_of_spectra(header):
        raise InputError(
            str(header_file),
            "must be ENVI Spectral Library, or have one sample or one line",
            value=kind,
            where="key 'file type'",
            remedy="name a file of spectra, not a cube",
        )
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
        raise InputError(
            header.source,
            "gains and offsets are not applied",
            where=f"key {gain!r}",
            remedy="apply them and save the library again",
        )
    pixels, notes = envi_pixels(header, data)
    if _is_line_of_spectra(header):
        pixels = pixels.reshape(-1, pixels.shape[2])[:, :, None]
    if pixels.shape[2] != 1:
        raise has(header.source, "must have 1 band, as a spectral library", pixels.shape[2])
    text = header.fields.get("reflectance scale factor", "1")
    factor = number_in(text)
    if not factor > 0:
        where = "key 'reflectance scale factor'"
        raise InputError(header.source, "must be > 0", value=text, where=where)
    table = pixels[:, :, 0].astype(np.float64)
    table[~(np.abs(table) <= _LARGEST)] = np.nan
    wavelength, heading = _wavelengths(header, table.shape[1])
    curves = list(zip(_names(header, table.shape[0]), table / factor, strict=True))
    deleted = "values that are not numbers or marked as deleted"
    said = [header.fields.get(key, "") for key in ("description", "z plot titles")]
    return Found(
        source=header.source,
        format="ENVI spectral library",
        columns=known_columns(wavelength, curves),
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

    Parameters
    ----------
    path
        The file.

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
        raise InputError(
            header.source,
            f"must list {count} numbers, one per wavelength of the data",
            value=numbers.size,
            found=f"lists {numbers.size}",
            where="key 'wavelength'",
        )
    if np.isnan(numbers).any():
        at = int(np.isnan(numbers).argmax())
        where = f"entry {at} of 'wavelength'"
        raise InputError(header.source, "must be a number", value=cells[at], where=where)
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
