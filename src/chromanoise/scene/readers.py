"""Hyperspectral cubes from files: ENVI, MATLAB and NumPy."""

import math
import os
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float, Shaped

from chromanoise import _check
from chromanoise.scene.cube import Cube
from chromanoise.scene.envi import (
    DATA_SUFFIXES,
    envi_pair,
    envi_pixels,
    envi_scale,
    envi_wavelengths,
    has_envi_wavelengths,
    read_envi_header,
)
from chromanoise.scene.mat import mat_array, mat_arrays
from chromanoise.scene.npz import npy_array, npz_array, npz_arrays

Array = np.ndarray
_Notes = tuple[str, ...]

_SHORTEST_NM, _LONGEST_NM = 100.0, 20000.0
_MOST_INFLATED = 1032  # times: what deflate can make of one byte
_MOST_LISTED = 20
_MEMORY_BYTES = 8 * 2**30  # where the machine does not tell
_IN_PLACE = "store it as ENVI or .npy, which are read in place"
_RADIANCE = re.compile(r"radiance|(?<![a-z])rdn(?![a-z])", re.I)
_REFLECTANCE = re.compile(r"reflectance|(?<![a-z])rfl(?![a-z])", re.I)
_WATT = re.compile(r"(?i:radiance|watt)|(?<![A-Za-z])[mun\u00b5\u03bc]?W(?:c?m|[^A-Za-z]|$)")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Found:
    """What a file holds; wavelengths and scale are read only where the caller does not say."""

    pixels: Shaped[Array, "h w m"]
    wavelengths: Callable[[], tuple[Array, _Notes]] | None = None
    scale: Callable[[], float | None] = lambda: None
    description: str = ""
    units: str = ""
    notes: _Notes = ()


def read_cube(
    path: Path | str,
    *,
    key: str | None = None,
    shape: tuple[int, int] | None = None,
    wavelengths: tuple[float, float] | None = None,
    scale: float | None = None,
) -> Cube:
    """The cube of reflectances in an ENVI, MATLAB (.mat, not 7.3), .npz or .npy file.

    ENVI and .npy files stay on disk, as memory maps. Bands come in the order of rising
    wavelength; whatever was assumed stands in the notes.

    Parameters
    ----------
    path
        The file; of an ENVI pair either one.
    key
        Name of the array in a .mat or .npz; ``reflectance`` if not given.
    shape
        Rows and columns of an array that stores pixels in one axis. [pixels]
    wavelengths
        Centers of the first and the last band, the others evenly between; wins over the
        file. [nm]
    scale
        Reflectance per stored unit; wins over the file, and over its saying that it is radiance.

    Raises
    ------
    InputError
        If the file cannot be read, holds radiance or unscaled integers, or does not tell its
        wavelengths; the cure is told.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(f"{folder}/cube.npy", np.full((1, 2, 3), 0.18))
    ...     cube = read_cube(f"{folder}/cube.npy", wavelengths=(400, 600))
    >>> cube.wavelength_nm, cube.stored[0, 1, 2]
    (array([400., 500., 600.]), np.float64(0.18))
    """
    path = Path(path)
    _refuse_no_file(path)
    found = _found(path, key, shape)
    factor, scale_notes = _scale(path, found, scale)
    wavelength, wavelength_notes = _wavelengths(path, found, wavelengths)
    pixels, wavelength, order_notes = _rising(path, found.pixels, wavelength)
    return Cube(
        wavelength_nm=wavelength,
        stored=pixels,
        scale=factor,
        source=str(path),
        notes=(*found.notes, *scale_notes, *wavelength_notes, *order_notes),
    )


# the file


def _refuse_no_file(path: Path) -> None:
    try:
        size = path.stat().st_size
    except (OSError, ValueError) as error:
        raise _check.InputError(f"{path}: cannot be read ({_reason(error)})") from None
    if path.is_dir():
        raise _check.InputError(f"{path}: is a directory; name the cube's file in it")
    if not path.is_file():
        raise _check.InputError(f"{path}: is not a regular file")
    if size == 0:
        raise _check.InputError(f"{path}: the file is empty; copy or save it again")
    try:
        path.open("rb").close()
    except OSError as error:
        raise _check.InputError(f"{path}: cannot be read ({_reason(error)})") from None


def _found(path: Path, key: str | None, shape: tuple[int, int] | None) -> _Found:
    """What stands in ``path``, by its ending; anything else must have an ENVI header beside it."""
    ending = path.suffix.lower()
    if ending in _NAMED:
        return _named(path, key, shape, _NAMED[ending])
    if ending != ".npy":
        return _envi(path, key, shape)
    with _door(path, "NumPy"):
        array = npy_array(path)
    pixels, notes = _picture(path, "the array", array, shape, by_columns=False)
    return _Found(pixels=pixels, notes=(*_unused_key(key), *notes))


@contextmanager
def _door(path: Path, kind: str) -> Iterator[None]:
    """Turns whatever a foreign reader throws at a bad file into one sentence."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except _check.InputError:
        raise
    except MemoryError:
        raise _check.InputError(
            f"{path}: too large for this machine's memory; {_IN_PLACE}"
        ) from None
    except Exception as error:  # parsers throw anything
        raise _check.InputError(
            f"{path}: not a readable {kind} file ({_reason(error)}); it is damaged or cut short, "
            "save it again"
        ) from None


def _reason(error: Exception) -> str:
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return " ".join(str(text).split())[:120]


# ENVI


def _envi(path: Path, key: str | None, shape: tuple[int, int] | None) -> _Found:
    try:
        pair = envi_pair(path)
        if pair is None:
            raise _check.InputError(_unknown(path))
        header = read_envi_header(pair[0])
        pixels, notes = envi_pixels(header, pair[1])
    except OSError as error:
        raise _check.InputError(f"{path}: cannot be read ({_reason(error)})") from None
    _refuse_other_shape(path, pixels, shape)
    return _Found(
        pixels=pixels,
        wavelengths=partial(envi_wavelengths, header) if has_envi_wavelengths(header) else None,
        scale=partial(envi_scale, header),
        description=header.fields.get("description", ""),
        units=" ".join(header.fields.get(name, "") for name in ("data units", "units")),
        notes=(*_unused_key(key), *notes),
    )


def _unknown(path: Path) -> str:
    if path.suffix.lower() in ("", *DATA_SUFFIXES):
        return (
            f"{path}: no ENVI header ({path.name}.hdr or {path.stem}.hdr) stands beside it; "
            "without one the numbers cannot be read"
        )
    return (
        f"{path}: cubes are not read from {path.suffix} files; read are ENVI (.hdr and its data), "
        ".mat, .npz and .npy"
    )


def _unused_key(key: str | None) -> _Notes:
    return () if key is None else (f"--key {key} not used: the file holds one array",)


# arrays with names

_Arrays = Mapping[str, tuple[tuple[int, ...], np.dtype]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Format:
    """How files of named arrays are listed and read, and how they order pixels."""

    kind: str
    arrays: Callable[[Path], _Arrays]
    array: Callable[[Path, str], Array]
    by_columns: bool


_NAMED = {
    ".mat": _Format(kind="MATLAB", arrays=mat_arrays, array=mat_array, by_columns=True),
    ".npz": _Format(kind="NumPy", arrays=npz_arrays, array=npz_array, by_columns=False),
}


def _named(path: Path, key: str | None, shape: tuple[int, int] | None, form: _Format) -> _Found:
    with _door(path, form.kind):
        arrays = form.arrays(path)
    name = _chosen(path, key, arrays)
    array = _loaded(path, name, arrays, form)
    pixels, notes = _picture(path, f"array {name!r}", array, shape, by_columns=form.by_columns)

    def wavelengths() -> tuple[Array, _Notes]:
        with np.errstate(all="ignore"):
            return _loaded(path, "wavelength_nm", arrays, form).astype(np.float64).ravel(), ()

    own = wavelengths if "wavelength_nm" in arrays else None
    return _Found(pixels=pixels, wavelengths=own, notes=notes)


def _chosen(path: Path, key: str | None, arrays: _Arrays) -> str:
    name = "reflectance" if key is None else key
    if name in arrays:
        return name
    listed = list(arrays.items())[:_MOST_LISTED]
    told = ", ".join(f"{_printable(n)} {_by(s)} {_kind(t)}" for n, (s, t) in listed)
    raise _check.InputError(
        f"{path}: has no array {name!r}; it holds {told or 'no arrays'}"
        + ("; name the cube with --key" if arrays else "")
    )


def _loaded(path: Path, name: str, arrays: _Arrays, form: _Format) -> Array:
    shape, dtype = arrays[name]
    _refuse_impossible(path, name, shape, dtype)
    with _door(path, form.kind):
        array = form.array(path, name)
    if array.shape != shape:
        raise _check.InputError(
            f"{path}: array {name!r} says that it is {_by(shape)}, but is {_by(array.shape)}; "
            "it is damaged, save it again"
        )
    return array.astype(dtype, copy=False)


def _printable(name: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in name[:40])


def _by(shape: tuple[int, ...]) -> str:
    return "x".join(str(n) for n in shape) or "scalar"


def _kind(dtype: np.dtype) -> str:
    return "object" if dtype.hasobject else dtype.name


def _refuse_impossible(path: Path, name: str, shape: tuple[int, ...], dtype: np.dtype) -> None:
    """Refuse, before it is read, what is no number, or larger than its file or the memory."""
    _refuse_not_numbers(path, name, dtype)
    count = math.prod(shape)
    if min(shape, default=1) < 1 or count > path.stat().st_size * _MOST_INFLATED:
        raise _check.InputError(
            f"{path}: array {name!r} says that it is {_by(shape)}, which a file of "
            f"{path.stat().st_size} bytes cannot hold; it is damaged, save it again"
        )
    if count * dtype.itemsize > _memory_bytes():
        raise _check.InputError(
            f"{path}: array {name!r} needs {_bytes(count * dtype.itemsize)} of memory, but this "
            f"machine has {_bytes(_memory_bytes())}; {_IN_PLACE}"
        )


def _refuse_not_numbers(path: Path, name: str, dtype: np.dtype) -> None:
    if dtype.kind not in "fiu":
        raise _check.InputError(
            f"{path}: array {name!r} is of type {_kind(dtype)}, not real numbers; save it as a "
            "plain array of real numbers, or name another with --key"
        )


def _bytes(count: int) -> str:
    for power, unit in ((3, "GiB"), (2, "MiB"), (1, "KiB")):
        if count >= 1024**power:
            return f"{count / 1024**power:.1f} {unit}"
    return f"{count} bytes"


def _memory_bytes() -> int:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return _MEMORY_BYTES


def _picture(
    path: Path, what: str, array: Array, shape: tuple[int, int] | None, *, by_columns: bool
) -> tuple[Shaped[Array, "rows columns bands"], _Notes]:
    """A view with axes (rows, columns, bands), and how the pixels were taken."""
    if array.ndim == 3 and array.size:
        _refuse_other_shape(path, array, shape)
        return array, ()
    if array.ndim != 2 or not array.size:
        raise _check.InputError(
            f"{path}: {what} must have axes (rows, columns, bands), or pixels in one axis and "
            f"bands in the other, and not be empty, but is {_by(array.shape)}"
        )
    rows, columns = _rows_and_columns(path, what, array, shape)
    spectra = array if array.shape[0] == rows * columns else array.T
    if by_columns:
        pixels = spectra.reshape(columns, rows, -1).transpose(1, 0, 2)
        return pixels, ("pixels taken column by column, as MATLAB does",)
    return spectra.reshape(rows, columns, -1), ("pixels taken row by row, as NumPy does",)


def _rows_and_columns(
    path: Path, what: str, array: Array, shape: tuple[int, int] | None
) -> tuple[int, int]:
    told = f"{path}: {what} is {_by(array.shape)}"
    if shape is None:
        raise _check.InputError(
            f"{told}, pixels in one axis; say its rows and columns with --shape ROWSxCOLUMNS"
        )
    fits = [min(shape) > 0 and n == math.prod(shape) for n in array.shape]
    if not any(fits):
        raise _check.InputError(
            f"{told}, but --shape {_by(shape)} is {math.prod(shape)} pixels, which is neither "
            "axis; mend --shape ROWSxCOLUMNS"
        )
    if all(fits):
        raise _check.InputError(
            f"{told}, and --shape {_by(shape)} fits both axes, so pixels and bands cannot be told "
            "apart; save it with axes (rows, columns, bands)"
        )
    return shape


def _refuse_other_shape(
    path: Path, pixels: Shaped[Array, "h w m"], shape: tuple[int, int] | None
) -> None:
    if shape is not None and tuple(shape) != pixels.shape[:2]:
        raise _check.InputError(
            f"{path}: the file holds {_by(pixels.shape[:2])} pixels, but --shape says "
            f"{_by(shape)}; leave --shape away"
        )


# what the numbers are


def _scale(path: Path, found: _Found, scale: float | None) -> tuple[float, _Notes]:
    """Reflectance per stored unit: the caller's word, else the file's, else 1 for real numbers."""
    radiance = _radiance_words(path, found)
    if scale is not None:
        _check.positive(f"--scale for {path}", "reflectance per stored unit", scale)
        said = (f"{radiance}, but --scale says that it is reflectance",) if radiance else ()
        return float(scale), (*said, f"reflectance = stored x {scale:g}, as --scale says")
    if radiance:
        raise _check.InputError(
            f"{path}: {radiance}, not reflectance; divide it by the illuminant or a white "
            "reference first, or say --scale (reflectance per stored unit) if it is reflectance"
        )
    own = found.scale()
    if own is not None:
        return own, (f"reflectance = stored x {own:g}, as the header says",)
    if found.pixels.dtype.kind in "iu":
        raise _check.InputError(
            f"{path}: stores integers ({found.pixels.dtype.name}) and does not say what they "
            "mean; say --scale (reflectance per stored unit), e.g. 1e-4 for reflectance x 10000"
        )
    return 1.0, ()


def _radiance_words(path: Path, found: _Found) -> str:
    """Where the file says that it is radiance; empty if nowhere."""
    for where, text in (("file name", path.name), ("header's description", found.description)):
        word = _RADIANCE.search(text)
        if word and not _REFLECTANCE.search(text):
            return f"the {where} says radiance ({word[0]!r})"
    if _WATT.search(found.units):
        return f"the header's data units say radiance ({found.units.strip()[:40]!r})"
    return ""


# wavelengths


def _wavelengths(
    path: Path, found: _Found, ends: tuple[float, float] | None
) -> tuple[Float[Array, " m"], _Notes]:
    """Centers of the bands [nm]: the caller's word, else the file's."""
    bands = found.pixels.shape[2]
    if bands < 2:
        raise _check.InputError(f"{path}: has {bands} band, but a cube needs at least 2")
    if ends is not None:
        over = "; those in the file are not used" if found.wavelengths else ""
        spread, note = _spread(ends, bands)
        return spread, (note + over,)
    if found.wavelengths is None:
        raise _check.InputError(
            f"{path}: does not tell the wavelengths of its {bands} bands; give --wavelengths "
            "FIRST:LAST in nm if they are evenly spaced"
        )
    wavelength, notes = found.wavelengths()
    if wavelength.size != bands:
        raise _check.InputError(
            f"{path}: has {bands} bands but {wavelength.size} wavelengths; mend the list, or give "
            "--wavelengths FIRST:LAST in nm if they are evenly spaced"
        )
    return wavelength, notes


def _spread(ends: tuple[float, float], bands: int) -> tuple[Float[Array, " m"], str]:
    """``bands`` wavelengths evenly from the first to the last. [nm]"""
    first, last = (float(end) for end in ends)
    if first == last or not all(_SHORTEST_NM <= end <= _LONGEST_NM for end in (first, last)):
        raise _check.InputError(
            f"--wavelengths FIRST:LAST must be two different numbers within {_SHORTEST_NM:g} .. "
            f"{_LONGEST_NM:g} nm, but is {first:g}:{last:g}"
        )
    note = f"{bands} wavelengths evenly from {first:g} to {last:g} nm, as --wavelengths says"
    return np.linspace(first, last, bands), note


def _rising(
    path: Path, pixels: Shaped[Array, "h w m"], wavelength: Float[Array, " m"]
) -> tuple[Shaped[Array, "h w m"], Float[Array, " m"], _Notes]:
    """Bands in the order of rising wavelength; a falling order is turned about, no other."""
    _refuse_not_light(path, wavelength)
    if wavelength[-1] >= wavelength[0]:
        _refuse_disorder(path, wavelength, np.diff(wavelength) <= 0)
        return pixels, wavelength, ()
    _refuse_disorder(path, wavelength, np.diff(wavelength) >= 0)
    return pixels[:, :, ::-1], wavelength[::-1], ("wavelengths fall: the bands are turned about",)


def _refuse_not_light(path: Path, wavelength: Float[Array, " m"]) -> None:
    bad = ~((wavelength >= _SHORTEST_NM) & (wavelength <= _LONGEST_NM))
    if bad.any():
        i = int(np.argmax(bad))
        raise _check.InputError(
            f"{path}: wavelengths must be {_SHORTEST_NM:g} .. {_LONGEST_NM:g} nm, but "
            f"{int(bad.sum())} of {bad.size} are not; the first is {wavelength[i]:g} nm at band "
            f"{i} (from 0); mend them or their unit, or give --wavelengths FIRST:LAST in nm"
        )


def _refuse_disorder(
    path: Path, wavelength: Float[Array, " m"], wrong: Shaped[Array, " m-1"]
) -> None:
    if wrong.any():
        i = int(np.argmax(wrong))
        raise _check.InputError(
            f"{path}: wavelengths must rise or fall from band to band, but "
            f"{wavelength[i + 1]:g} nm follows {wavelength[i]:g} nm at band {i + 1} (from 0); "
            "sort the bands and drop repeated ones, or give --wavelengths FIRST:LAST"
        )
