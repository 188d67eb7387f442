"""Interpret the numbers of a file: scale to reflectance, and wavelengths of the bands."""

import math
import re
from pathlib import Path

import numpy as np

from chromanoise.base import Array, Float, Setting, Shaped, check
from chromanoise.io.cubes.found_cube import Found, Notes
from chromanoise.io.source_files import errors_within, real_of, refused, small_text
from chromanoise.io.spectra.declared import (
    NM_PER,
    declared_keys,
    is_wavelength_heading,
    wavelength_unit_of,
)
from chromanoise.io.spectra.parsed import Unit
from chromanoise.spectra import Cube, ReorderedRows, RowSource, row_source, with_bands

_SHORTEST_NM, _LONGEST_NM = 100.0, 20000.0
_MOST_SPECTROMETERS, _FEWEST_BANDS = 4, 3
_RADIANCE = re.compile(r"radiance|(?<![a-z])rdn(?![a-z])", re.I)
_REFLECTANCE = re.compile(r"reflectance|(?<![a-z])rfl(?![a-z])", re.I)
_TWO_OR_ALL = "first and last in nm where they are evenly spaced, or a file that lists all"
_WATT = re.compile(r"(?i:radiance|watt)|(?<![A-Za-z])[mun\u00b5\u03bc]?W(?:c?m|[^A-Za-z]|$)")


def interpreted(
    source: Path | str,
    found: Found,
    *,
    wavelengths: tuple[float, float] | Path | str | None,
    scale: float | None,
) -> Cube:
    """The cube of ``found``, with what is given in place of what the file declares."""
    factor, scale_notes = _scale_and_notes(source, found, scale)
    wavelength, wavelength_notes = _wavelengths_and_notes(source, found, wavelengths)
    pixels, wavelength, order_notes = _rising(source, found.pixels, wavelength)
    return Cube(
        wavelength_nm=wavelength,
        stored=pixels,
        scale=factor,
        source=str(source),
        notes=(*found.notes, *scale_notes, *wavelength_notes, *order_notes),
    )


def _scale_and_notes(path: Path | str, found: Found, scale: float | None) -> tuple[float, Notes]:
    """Reflectance per stored unit: as given, else from the file, else 1 for real numbers."""
    radiance = _radiance_words(path, found)
    if scale is not None:
        check.positive("scale", "reflectance per stored unit", scale)
        said = (f"{radiance}, but a scale to reflectance is given",) if radiance else ()
        return float(scale), (*said, f"reflectance = stored x {scale:g}, as given")
    if radiance:
        need = "must hold reflectance, or numbers of known scale (reflectance per stored unit)"
        remedy = ("divide it by the illuminant or a white reference", Setting("scale"))
        raise refused(path, need, found=radiance, remedy=remedy)
    own = found.scale()
    if own is not None:
        return own, (f"reflectance = stored x {own:g}, as the header says",)
    if found.pixels.dtype.kind in "iu":
        raise refused(
            path,
            "must declare the scale of its integers (reflectance per stored unit, "
            "1e-4 for reflectance x 10000)",
            found.pixels.dtype.name,
            f"stores {found.pixels.dtype.name} and declares none",
            remedy=Setting("scale"),
        )
    return 1.0, ()


def _radiance_words(path: Path | str, found: Found) -> str:
    """The place where the file declares radiance, as a sentence; empty if there is none."""
    for where, text in (
        ("file name", Path(path).name),
        ("header's description", found.description),
    ):
        word = _RADIANCE.search(text)
        if word and not _REFLECTANCE.search(text):
            return f"the {where} says radiance ({word[0]!r})"
    if _WATT.search(found.units):
        return f"the header's data units say radiance ({found.units.strip()[:40]!r})"
    return ""


def _wavelengths_and_notes(
    path: Path | str, found: Found, said: tuple[float, float] | Path | str | None
) -> tuple[Float[Array, " m"], Notes]:
    """Centers of the bands [nm]: as given, else from the file."""
    bands = found.pixels.shape[2]
    if bands < 2:
        raise refused(path, "must have at least 2 bands", bands, f"has {bands} band")
    if said is not None:
        over = "; those in the file are not used" if found.wavelengths else ""
        if isinstance(said, str | Path):
            return read_wavelengths(Path(said), bands), (f"wavelengths listed in {said}{over}",)
        spread, note = _spread(said, bands)
        return spread, (note + over,)
    if found.wavelengths is None:
        need = f"must declare the wavelengths of its {bands} bands ({_TWO_OR_ALL})"
        raise refused(path, need, found="declares none", remedy=Setting("wavelengths"))
    wavelength, notes = found.wavelengths()
    if wavelength.size != bands:
        need = f"must have one wavelength per band ({_TWO_OR_ALL})"
        held = f"has {bands} bands and {wavelength.size} wavelengths"
        remedy = ("correct it", Setting("wavelengths"))
        raise refused(path, need, wavelength.size, held, remedy=remedy)
    return wavelength, notes


def _spread(ends: tuple[float, float], bands: int) -> tuple[Float[Array, " m"], str]:
    """``bands`` evenly spaced wavelengths from the first to the last. [nm]"""
    first, last = (float(end) for end in ends)
    if first == last or not all(_SHORTEST_NM <= end <= _LONGEST_NM for end in (first, last)):
        need = f"must be two different numbers within {_SHORTEST_NM:g} .. {_LONGEST_NM:g} [nm]"
        raise refused("wavelengths", need, (first, last), f"is {first:g}:{last:g}")
    note = f"{bands} wavelengths evenly from {first:g} to {last:g} nm, as given"
    return np.linspace(first, last, bands), note


def _rising(
    path: Path | str, pixels: Shaped[Array, "h w m"] | RowSource, wavelength: Float[Array, " m"]
) -> tuple[Shaped[Array, "h w m"] | RowSource, Float[Array, " m"], Notes]:
    """Bands in increasing order, with a note: decreasing or overlapping spectrometers are sorted.

    Any other order, or a repeated wavelength, raises an error.
    """
    _refuse_not_light(path, wavelength)
    order = np.argsort(wavelength, kind="stable")
    starts = np.flatnonzero(np.diff(wavelength) <= 0) + 1
    spans = np.diff([0, *starts, wavelength.size])
    distinct = bool((np.diff(wavelength[order]) > 0).all())
    if distinct and 2 <= spans.size <= _MOST_SPECTROMETERS and spans.min() >= _FEWEST_BANDS:
        joints = ", ".join(f"{wavelength[i - 1]:g} to {wavelength[i]:g} nm" for i in starts)
        sorted_bands = ReorderedRows(source=row_source(pixels), order=tuple(order.tolist()))
        note = f"bands of {spans.size} overlapping spectrometers sorted by wavelength (at {joints})"
        return sorted_bands, wavelength[order], (note,)
    if wavelength[-1] >= wavelength[0]:
        _refuse_disorder(path, wavelength, np.diff(wavelength) <= 0)
        return pixels, wavelength, ()
    _refuse_disorder(path, wavelength, np.diff(wavelength) >= 0)
    turned = with_bands(pixels, slice(None, None, -1))
    return turned, wavelength[::-1], ("wavelengths are descending: band order reversed",)


def _refuse_not_light(path: Path | str, wavelength: Float[Array, " m"]) -> None:
    bad = ~((wavelength >= _SHORTEST_NM) & (wavelength <= _LONGEST_NM))
    if bad.any():
        i = int(np.argmax(bad))
        need = f"wavelength must be {_SHORTEST_NM:g} .. {_LONGEST_NM:g} [nm]"
        found = f"is {wavelength[i]:g} nm ({int(bad.sum())} of {bad.size} are out of range)"
        where = f"band {i} (from 0)"
        remedy = ("correct the wavelengths or their unit", Setting("wavelengths"))
        raise refused(path, need, float(wavelength[i]), found, where=where, remedy=remedy)


def _refuse_disorder(
    path: Path | str, wavelength: Float[Array, " m"], wrong: Shaped[Array, " m-1"]
) -> None:
    if wrong.any():
        i = int(np.argmax(wrong))
        need = "wavelengths must rise or fall from band to band"
        found = f"{wavelength[i + 1]:g} nm follows {wavelength[i]:g} nm"
        where = f"band {i + 1} (from 0)"
        remedy = ("sort the bands and drop repeated ones", Setting("wavelengths"))
        raise refused(path, need, float(wavelength[i + 1]), found, where=where, remedy=remedy)


_LARGEST_BYTES = 2**20
_LIST = "name a text file that lists one wavelength per band"
_CELL = re.compile(r"[,;\t]|\s{2,}")
_BETWEEN = re.compile(r"\s*[,;]\s*|\s+")


def read_wavelengths(path: Path, bands: int) -> Float[Array, " bands"]:
    r"""The wavelengths in a text file. [nm]

    One per line, or in the first column of a table, or a list over any number of lines, separated
    by comma, semicolon, blank or tab. A heading and lines that begin with ``#`` may come first; the
    numbers are nm unless these name um or Angstrom.

    Parameters
    ----------
    bands
        The number of bands of the cube, which is also the number of wavelengths.

    Raises
    ------
    InputError
        If the file cannot be read, an entry is not a number, or the number of entries is not
        ``bands``.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder) / "bands.csv"
    ...     _ = file.write_text("center (um),width (um)\n0.45,0.01\n0.7,0.02\n")
    ...     read_wavelengths(file, 2)
    array([450., 700.])
    """
    need = f"must have at most {_LARGEST_BYTES // 2**20} MiB"
    text = small_text(path, _LARGEST_BYTES, need, _LIST)
    heading, rows = _parts(path, text)
    nm_per = _unit(path, heading)
    columns = [row[:1] for row in rows]
    counts = [sum(len(row) for row in part) for part in (columns, rows)]
    if bands not in counts:
        texts = " or ".join(str(count) for count in dict.fromkeys(counts))
        need = f"must list one wavelength for each of the {bands} bands of the cube"
        raise refused(path, need, tuple(dict.fromkeys(counts)), f"lists {texts}")
    cells = [cell for row in (columns if counts[0] == bands else rows) for cell in row]
    values = [real_of(cell) for cell in cells]
    if not all(math.isfinite(value) for value in values):
        wrong = next(i for i, value in enumerate(values) if not math.isfinite(value))
        raise refused(path, "must be a number", cells[wrong][:40], where=f"entry {wrong + 1}")
    return np.array(values) * nm_per


def _parts(path: Path, text: str) -> tuple[str, list[list[str]]]:
    """The lines before the first number, and the cells of each line from there on."""
    heading: list[str] = []
    rows: list[list[str]] = []
    for line in text.splitlines():
        cells = [cell for cell in _BETWEEN.split(line.strip()) if cell]
        if line.lstrip().startswith("#") or (not rows and cells and math.isnan(real_of(cells[0]))):
            heading.append(line)
        elif cells:
            rows.append(cells)
    if not rows:
        raise refused(path, "must list one wavelength per band", found="lists none")
    return "\n".join(heading), rows


def _unit(path: Path, heading: str) -> float:
    """Nanometers per unit that a heading above the numbers, or a declared key, names."""
    lines = [line.lstrip("# ").strip() for line in heading.splitlines()]
    first = [_CELL.split(line, maxsplit=1)[0] for line in lines]
    key = declared_keys(lines).get("wavelength_unit")
    texts = [*([f"[{key}]"] if key else []), *filter(is_wavelength_heading, first)]
    units = {_unit_of(path, text) for text in texts} - {None}
    if len(units) > 1:
        names = tuple(sorted(str(unit) for unit in units))
        raise refused(path, "headings must name one unit", names, f"name {' and '.join(names)}")
    return NM_PER[next(iter(units)) or "nm"] if units else 1.0


def _unit_of(path: Path, text: str) -> Unit | None:
    with errors_within(path):
        unit = wavelength_unit_of(text)
    if unit == "1/cm":
        need = "must list wavelengths"
        raise refused(path, need, unit, "lists wavenumbers", remedy="write wavelengths in nm")
    return unit
