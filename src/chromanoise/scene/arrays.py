"""Cubes from files of named arrays: MATLAB and NumPy archives."""

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._mat5 import mat_array, mat_arrays
from chromanoise.scene.faults import IN_PLACE, reading
from chromanoise.scene.found import Found, Notes, by
from chromanoise.scene.npz import npz_array, npz_arrays
from chromanoise.scene.picture import picture

_MOST_INFLATED = 1032  # times: what deflate can make of one byte
_MOST_LISTED = 20
_MEMORY_BYTES = 8 * 2**30  # where the machine does not tell

_Arrays = Mapping[str, tuple[tuple[int, ...], np.dtype]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Format:
    """How files of named arrays are listed and read, and how they order pixels."""

    kind: str
    arrays: Callable[[Path], _Arrays]
    array: Callable[[Path, str], Array]
    by_columns: bool


NAMED = {
    ".mat": _Format(kind="MATLAB", arrays=mat_arrays, array=mat_array, by_columns=True),
    ".npz": _Format(kind="NumPy", arrays=npz_arrays, array=npz_array, by_columns=False),
}


def named_arrays(
    path: Path, key: str | None, shape: tuple[int, int] | None, form: _Format
) -> Found:
    """What stands under ``key`` in a file of format ``form``, and its wavelengths if it has any."""
    with reading(path, form.kind):
        arrays = form.arrays(path)
    name = _chosen(path, key, arrays)
    array = _loaded(path, name, arrays, form)
    pixels, notes = picture(path, f"array {name!r}", array, shape, by_columns=form.by_columns)

    def wavelengths() -> tuple[Array, Notes]:
        with np.errstate(all="ignore"):
            return _loaded(path, "wavelength_nm", arrays, form).astype(np.float64).ravel(), ()

    own = wavelengths if "wavelength_nm" in arrays else None
    return Found(pixels=pixels, wavelengths=own, notes=notes)


def _chosen(path: Path, key: str | None, arrays: _Arrays) -> str:
    name = "reflectance" if key is None else key
    if name in arrays:
        return name
    listed = list(arrays.items())[:_MOST_LISTED]
    told = ", ".join(f"{printable(n)} {by(s)} {_kind(t)}" for n, (s, t) in listed)
    raise _check.InputError(
        f"{path}: has no array {name!r}; it holds {told or 'no arrays'}"
        + ("; name the cube with --key" if arrays else "")
    )


def _loaded(path: Path, name: str, arrays: _Arrays, form: _Format) -> Array:
    shape, dtype = arrays[name]
    refuse_impossible(path, name, shape, dtype)
    with reading(path, form.kind):
        array = form.array(path, name)
    if array.shape != shape:
        raise _check.InputError(
            f"{path}: array {name!r} says that it is {by(shape)}, but is {by(array.shape)}; "
            "it is damaged, save it again"
        )
    return array.astype(dtype, copy=False)


def printable(name: str) -> str:
    """A name from a file, short and fit to be shown."""
    return "".join(c if c.isprintable() else "?" for c in name[:40])


def _kind(dtype: np.dtype) -> str:
    return "object" if dtype.hasobject else dtype.name


def refuse_impossible(
    path: Path, name: str, shape: tuple[int, ...], dtype: np.dtype, *, size: int | None = None
) -> None:
    """Refuse, before it is read, what is no number, or larger than its file or the memory."""
    refuse_not_numbers(path, name, dtype)
    count = math.prod(shape)
    size = path.stat().st_size if size is None else size
    if min(shape, default=1) < 1:
        raise _check.InputError(f"{path}: array {name!r} is empty ({by(shape)}); save it again")
    if count > size * _MOST_INFLATED:
        raise _check.InputError(
            f"{path}: array {name!r} says that it is {by(shape)}, which a file of "
            f"{size} bytes cannot hold; it is damaged, save it again"
        )
    refuse_large(path, name, count * dtype.itemsize)


def refuse_large(path: Path, name: str, size: int) -> None:
    """Refuse an array of more bytes than the machine has memory."""
    if size > memory_bytes():
        raise _check.InputError(
            f"{path}: array {name!r} needs {_bytes(size)} of memory, but this "
            f"machine has {_bytes(memory_bytes())}; {IN_PLACE}"
        )


def refuse_not_numbers(path: Path, name: str, dtype: np.dtype) -> None:
    """Refuse words, objects, complex numbers and truth values."""
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


def memory_bytes() -> int:
    """Memory of this machine. [bytes]"""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return _MEMORY_BYTES
