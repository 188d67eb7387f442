"""Cubes from files of named arrays: MATLAB and NumPy archives."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from chromanoise._check import Array, printable
from chromanoise.errors import InputError, Setting
from chromanoise.io.cubes.bounds import kind_of, refuse_impossible
from chromanoise.io.cubes.errors import reading
from chromanoise.io.cubes.npz import npz_array, npz_arrays
from chromanoise.io.cubes.picture import picture
from chromanoise.io.cubes.raw_cube import Found, Notes, by
from chromanoise.io.matlab import mat_array, mat_arrays
from chromanoise.io.spectra.wavelength_lists import (
    SPECTRAL_NAMES,
    Listed,
    fitting,
    is_list,
    listed_wavelengths,
)

_MOST_LISTED = 20

_Arrays = Mapping[str, tuple[tuple[int, ...], np.dtype]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Format:
    """The functions that list and read a format of named arrays, and its storage order."""

    kind: str
    arrays: Callable[[Path], _Arrays]
    array: Callable[[Path, str], Array]
    by_columns: bool
    stored_item_bytes: int | None = None


NAMED = {
    ".mat": _Format(
        kind="MATLAB", arrays=mat_arrays, array=mat_array, by_columns=True, stored_item_bytes=1
    ),  # MATLAB stores whole numbers in as few bytes as possible
    ".npz": _Format(kind="NPZ", arrays=npz_arrays, array=npz_array, by_columns=False),
}


def named_arrays(
    path: Path, key: str | None, shape: tuple[int, int] | None, form: _Format
) -> Found:
    """The array ``key`` in a file of format ``form``, and its wavelengths if there are any."""
    with reading(path, form.kind):
        arrays = form.arrays(path)
    name = _chosen(path, key, arrays)
    array = _loaded(path, name, arrays, form)
    pixels, notes = picture(path, f"array {name!r}", array, shape, by_columns=form.by_columns)

    lists = [
        Listed(name=one, size=math.prod(shape), numbers=partial(_loaded, path, one, arrays, form))
        for one, (shape, _) in arrays.items()
        if one != name and one.lower() in SPECTRAL_NAMES and is_list(shape)
    ]
    real = [one for one in lists if arrays[one.name][1].kind in "fiu"]

    def wavelengths() -> tuple[Array, Notes]:
        return listed_wavelengths(path, fitting(real or lists, (pixels.shape[2],)))

    return Found(pixels=pixels, wavelengths=wavelengths if lists else None, notes=notes)


def _chosen(path: Path, key: str | None, arrays: _Arrays) -> str:
    name = "reflectance" if key is None else key
    if name in arrays:
        return name
    listed = list(arrays.items())[:_MOST_LISTED]
    listing = ", ".join(f"{printable(n)} {by(s)} {kind_of(t)}" for n, (s, t) in listed)
    raise InputError(
        str(path),
        f"must hold an array {name!r}",
        value=tuple(arrays),
        found=f"holds {listing or 'no arrays'}",
        remedy=Setting("key") if arrays else (),
    )


def _loaded(path: Path, name: str, arrays: _Arrays, form: _Format) -> Array:
    shape, dtype = arrays[name]
    refuse_impossible(path, name, shape, dtype, stored_item_bytes=form.stored_item_bytes)
    with reading(path, form.kind):
        array = form.array(path, name)
    if array.shape != shape:
        raise InputError(
            str(path),
            f"must be {by(shape)}, as it declares",
            where=f"array {name!r}",
            value=array.shape,
            found=f"is {by(array.shape)}",
            remedy="save it again, because it is damaged",
        )
    return array.astype(dtype, copy=False)
