"""Cubes from files of named arrays, and cubes and pictures as labeled arrays of xarray.

The files are HDF5, NetCDF-4, Zarr, MATLAB and NumPy archives. Those with labels identify their axes
by names, by a list of wavelengths, or not at all. Missing metadata is assumed and noted; ambiguous
metadata raises an error.
"""

import math
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chromanoise.base import (
    Array,
    InputError,
    Setting,
    Shaped,
    UInt8,
    dataclass,
    optional_package,
    printable,
)
from chromanoise.io.cubes.cube_metadata import interpreted
from chromanoise.io.cubes.found_cube import (
    MOST_INFLATED,
    Found,
    Notes,
    Wavelengths,
    memory_bytes,
    picture,
    reading,
    reading_rows,
    refuse_empty,
    refuse_impossible,
    refuse_other_shape,
    refuse_other_size,
)
from chromanoise.io.source_files import by, kind_of, refused
from chromanoise.io.spectra.declared import (
    BAND_NAMES,
    NM_PER,
    SPECTRAL_NAMES,
    Listed,
    fitting,
    is_list,
    listed_wavelengths,
    nanometers,
)
from chromanoise.spectra import ArrayRows, Cube, RowSource, block, refuse_other_rows

if TYPE_CHECKING:
    from chromanoise.imaging import Picture


_MOST_LISTED = 20
_HARMLESS_BYTES = 64 * 2**20
_REFLECTANCE_NAMES = ("reflectance", "hymage")
_PERCENT = ("%", "percent")
_CLAMPED = ("_fillvalue", "missing_value", "valid_range", "valid_min", "valid_max")

Axes = tuple[int, int, int]


@dataclass(frozen=True, kw_only=True, eq=False)
class Labeled:
    """One stored array, without its numbers.

    Attributes
    ----------
    shape, dtype
        Shape and type as stored.
    axes
        Name of each axis; empty if it has none.
    attributes
        Texts and numbers attached to the array, by names in lower case.
    """

    shape: tuple[int, ...]
    dtype: np.dtype
    axes: tuple[str, ...] = ()
    attributes: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True, eq=False)
class Store:
    """A file of labeled arrays.

    Attributes
    ----------
    path, kind
        The file, and the common name of its format.
    arrays
        The arrays by name, ``folder/name``.
    bytes
        Size of the file.
    numbers
        Reads a whole array; it may raise the exceptions of a library.
    source
        Returns the rows of an array, given the axes of rows, columns and bands; None if arrays are
        read as a whole.
    notes
        Returns notes on an array before it is read.
    attributes
        Attributes of the file as a whole.
    by_columns
        Whether pixels in one axis go down the columns first, as in MATLAB.
    bands_last
        Whether the axes are rows, columns and bands, in this order.
    stored_item_bytes
        As `refuse_impossible`.
    """

    path: Path
    kind: str
    bytes: int
    arrays: Mapping[str, Labeled]
    numbers: Callable[[str], Array]
    source: Callable[[str, Axes], RowSource] | None = None
    notes: Callable[[str], Notes] = lambda _: ()
    attributes: Mapping[str, Any] = field(default_factory=dict)
    by_columns: bool = False
    bands_last: bool = False
    stored_item_bytes: int | None = None


def array_store(
    path: Path,
    kind: str,
    listed: Callable[[Path], Mapping[str, tuple[tuple[int, ...], np.dtype]]],
    array: Callable[[Path, str], Array],
    **how: Any,
) -> Store:
    """A file of arrays without labels, in axes (rows, columns, bands)."""
    with reading(path, kind):
        arrays = {name: Labeled(shape=s, dtype=dtype) for name, (s, dtype) in listed(path).items()}
    return Store(
        path=path,
        kind=kind,
        bytes=path.stat().st_size,
        arrays=arrays,
        numbers=partial(array, path),
        bands_last=True,
        **how,
    )


def labeled_cube(store: Store, key: str | None, shape: tuple[int, int] | None) -> Found:
    """The cube in the array ``key``, or in the only array with three axes, with its metadata."""
    name, chosen = _chosen(store, key)
    array = store.arrays[name]
    refuse_empty(store.path, name, array.shape, array.dtype)
    wavelengths, count = _wavelengths(store, name)
    pixels: Array | RowSource
    if store.source is not None and len(array.shape) == 3:
        axes, notes = _cube_axes(store, name, count)
        pixels = store.source(name, axes)
        _refuse_large_rows(store, name, pixels)
        refuse_other_shape(store.path, pixels, shape)
    else:
        pixels, notes = picture(
            store.path, f"array {name!r}", _loaded(store, name), shape, by_columns=store.by_columns
        )
    return Found(
        pixels=pixels,
        wavelengths=wavelengths,
        scale=lambda: _scale(store.path, name, array),
        description=_texts(array, "long_name", "standard_name", "description"),
        units=_texts(array, "units"),
        notes=(*chosen, *notes, *store.notes(name), *_passed_over(array)),
    )


def _loaded(store: Store, name: str) -> Array:
    path, array = store.path, store.arrays[name]
    item = store.stored_item_bytes
    refuse_impossible(
        path, name, array.shape, array.dtype, size=store.bytes, stored_item_bytes=item
    )
    with reading(path, store.kind):
        numbers = store.numbers(name)
    refuse_other_size(path, f"array {name!r}", numbers.shape, array.shape)
    return numbers.astype(array.dtype, copy=False)


def _chosen(store: Store, key: str | None) -> tuple[str, Notes]:
    """The name of the cube, and how it was found."""
    if key is None and store.source is None:
        key = "reflectance"  # without labels nothing is guessed
    if key is not None:
        name = key.strip("/")
        if name in store.arrays:
            return name, ()
        raise _no_such(store, key)
    names = {_last(n).lower(): n for n in reversed(list(store.arrays))}
    for usual in _REFLECTANCE_NAMES:
        if usual in names:
            return names[usual], ()
    pictures = [n for n, a in store.arrays.items() if len(a.shape) == 3 and a.dtype.kind in "fiu"]
    if len(pictures) != 1:
        raise _no_such(store, "reflectance")
    return pictures[0], (f"the cube is {pictures[0]!r}, the only array with three axes",)


def _no_such(store: Store, key: str) -> InputError:
    listed = list(store.arrays.items())[:_MOST_LISTED]
    listing = ", ".join(f"{printable(n)} {by(a.shape)} {kind_of(a.dtype)}" for n, a in listed)
    need = f"must hold an array {key!r}"
    found = f"holds {listing or 'no arrays'}"
    remedy = Setting("key") if listed else ()
    return refused(store.path, need, tuple(store.arrays), found, remedy=remedy)


def _cube_axes(store: Store, name: str, count: int | None) -> tuple[Axes, Notes]:
    """The axes of rows, columns and bands, by their names, else by the wavelengths."""
    array = store.arrays[name]
    if store.bands_last:
        return (0, 1, 2), ()
    named = _named_band_axis(array)
    if named is not None:
        return _bands_last(named), ()
    fits = [i for i, n in enumerate(array.shape) if n == count]
    if len(fits) > 1:
        need = f"must have only one axis of {count}, the number of wavelengths"
        found = f"is {by(array.shape)}, so bands and pixels cannot be distinguished"
        remedy = "save it with axes (rows, columns, bands) as .npy"
        raise refused(store.path, need, array.shape, found, where=f"array {name!r}", remedy=remedy)
    if not fits:
        return (0, 1, 2), (f"axes of {name!r} taken as rows, columns, bands",)
    axes = _bands_last(fits[0])
    return axes, (f"axis {fits[0]} of {name!r} taken as bands, for it has {count} wavelengths",)


def _named_band_axis(array: Labeled) -> int | None:
    named = [i for i, axis in enumerate(array.axes) if _last(axis).lower() in BAND_NAMES]
    return named[0] if len(named) == 1 else None


def _bands_last(band: int) -> Axes:
    row, column = (axis for axis in range(3) if axis != band)
    return row, column, band


def _refuse_large_rows(store: Store, name: str, source: RowSource) -> None:
    """Raise an error if chunks need more memory than is available or than the file can contain.

    Absent chunks and chunks of one repeated number may declare any size; small sizes are accepted.
    """
    _, width, bands = source.shape
    needed = width * bands * source.chunk_rows * source.dtype.itemsize
    if needed > memory_bytes() // 2:
        raise refused(
            store.path,
            f"rows that are stored together must fit into half of the available "
            f"memory ({memory_bytes() / 2**30:.1f} GiB)",
            needed,
            f"need {needed / 2**30:.1f} GiB",
            where=f"array {name!r}",
            remedy=("store it with smaller chunks", "store it as ENVI"),
        )
    if needed > max(_HARMLESS_BYTES, store.bytes * MOST_INFLATED):
        need = f"rows that are stored together must fit into the {store.bytes} bytes of the file"
        found = f"need {needed / 2**20:.0f} MiB"
        remedy = "save it again, because the file is damaged"
        raise refused(store.path, need, needed, found, where=f"array {name!r}", remedy=remedy)


def _wavelengths(store: Store, name: str) -> tuple[Wavelengths | None, int | None]:
    """A function that reads the wavelengths, and their number; None if the file has none.

    The first of these that has wavelengths is used: the attributes of the array, the coordinates of
    its axes, the attributes of the file, lists in the folder of the array or at the top.
    """
    array = store.arrays[name]
    band = 2 if store.bands_last and len(array.shape) == 3 else _named_band_axis(array)
    lengths = array.shape if band is None else array.shape[band : band + 1]
    for lists in (
        _in_attributes(array.attributes),
        _of_axes(store, name),
        _in_attributes(store.attributes),
        _in_folder(store, name),
    ):
        if lists:
            fit = fitting(lists, lengths)
            return partial(listed_wavelengths, store.path, fit), fit[0].size
    return None, None


def _in_attributes(attributes: Mapping[str, Any]) -> list[Listed]:
    unit = _text(attributes.get("wavelength_units", ""))
    found = {key: np.atleast_1d(np.asarray(attributes[key])) for key in sorted(attributes)
             if key in SPECTRAL_NAMES}  # fmt: skip
    return [
        Listed(name=key, size=values.size, numbers=partial(np.asarray, values), unit=unit)
        for key, values in found.items()
        if values.ndim == 1 and values.dtype.kind in "fiu" and values.size > 1
    ]


def _of_axes(store: Store, name: str) -> list[Listed]:
    """The coordinates of an axis, if they are wavelengths."""
    folder = name.rpartition("/")[0]
    for axis in store.arrays[name].axes:
        for known in (f"{folder}/{axis}".strip("/"), axis):
            array = store.arrays.get(known)
            if array is None or known == name or not is_list(array.shape):
                continue
            if _last(known).lower() in BAND_NAMES and _is_spectral(known, array):
                return [_listed(store, known)]
    return []


def _in_folder(store: Store, name: str) -> list[Listed]:
    """Lists of numbers; without labels, one of text, which is refused when it is read."""
    folder = name.rpartition("/")[0]
    lists = [
        known
        for known, array in store.arrays.items()
        if known != name and is_list(array.shape)
        if known.rpartition("/")[0] in (folder, "") and _last(known).lower() in SPECTRAL_NAMES
    ]
    real = [known for known in lists if store.arrays[known].dtype.kind in "fiu"]
    return [_listed(store, known) for known in real or (lists if store.source is None else ())]


def _listed(store: Store, name: str) -> Listed:
    array = store.arrays[name]
    unit = _text(array.attributes.get("units", ""))
    read = partial(_loaded, store, name)
    return Listed(name=name, size=math.prod(array.shape), numbers=read, unit=unit)


def _is_spectral(name: str, array: Labeled) -> bool:
    """Whether an array has wavelengths; band numbers do not count."""
    unit = _text(array.attributes.get("units", "")).strip().lower()
    return _last(name).lower() in SPECTRAL_NAMES or unit in NM_PER


def _last(name: str) -> str:
    """The name without its folders."""
    return name.rsplit("/", 1)[-1]


def _scale(path: Path, name: str, array: Labeled) -> float | None:
    """Reflectance per stored unit; CEA-LETI's ReDFISh stores 65536 times the reflectance."""
    if name.lower() == "hymage" and array.dtype == np.uint16:
        return 1 / 65536
    return attribute_scale(path, array.attributes)


def attribute_scale(path: Path | str, attributes: Mapping[str, Any]) -> float | None:
    """``scale_factor`` of the CF conventions, times .01 for percent; None if neither is declared.

    Raises
    ------
    InputError
        If there is also an offset, or the factor is not a number > 0.
    """
    percent = 0.01 if _text(attributes.get("units", "")).strip().lower() in _PERCENT else None
    offset = _number(path, "add_offset", attributes.get("add_offset", 0.0))
    if offset != 0:
        need = "must be 0, because offsets are not applied"
        remedy = ("apply the offset and save the cube again", Setting("scale"))
        raise refused(path, need, offset, where="attribute 'add_offset'", remedy=remedy)
    if "scale_factor" not in attributes:
        return percent
    factor = _number(path, "scale_factor", attributes["scale_factor"])
    if not (factor > 0 and math.isfinite(factor)):
        need = "must be finite and > 0 [reflectance per stored unit]"
        where = "attribute 'scale_factor'"
        raise refused(path, need, factor, where=where, remedy=("correct it", Setting("scale")))
    return factor * (percent or 1.0)


def _number(path: Path | str, what: str, value: Any) -> float:
    array = np.asarray(value)
    if array.size != 1 or array.dtype.kind not in "fiu":
        need = "must be one number"
        remedy = ("correct it", Setting("scale"))
        raise refused(path, need, printable(str(value)), where=f"attribute {what!r}", remedy=remedy)
    return float(array.ravel()[0])


def _text(value: Any) -> str:
    return value if isinstance(value, str) else ""


def _texts(array: Labeled, *names: str) -> str:
    return " ".join(_text(array.attributes.get(name, "")) for name in names).strip()


def _passed_over(array: Labeled) -> Notes:
    """A note on attributes for missing values, worded so that the cube recognizes it."""
    named = [name for name in _CLAMPED if name in array.attributes]
    return (f"data ignore value in the file but not applied: {', '.join(named)}",) if named else ()


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredRows:
    """Rows of one array in a file or folder of arrays.

    Attributes
    ----------
    path, kind
        The file or folder, and the common name of its format.
    opened
        Opens the array for each block of rows. It can be pickled, so that another process can take
        the source.
    sizes
        Length of each axis of the array.
    axes
        The axes of the array that are rows, columns and bands.
    bands
        The selected stored bands, in order.
    stored
        Type of the numbers.
    chunk_rows
        The number of rows per stored chunk.
    """

    path: Path
    kind: str
    opened: Callable[[], AbstractContextManager[Any]]
    sizes: tuple[int, ...]
    axes: Axes
    bands: range
    stored: np.dtype
    chunk_rows: int

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of rows, columns and selected bands."""
        row, column, _ = self.axes
        return self.sizes[row], self.sizes[column], len(self.bands)

    @property
    def dtype(self) -> np.dtype:
        """Type of the numbers from ``rows``, in the byte order of this machine."""
        return self.stored.newbyteorder("=")

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored."""
        refuse_other_rows(str(self.path), self.shape, start, stop)
        with reading_rows(self.path, self.kind), self.opened() as array:
            read = block(array, self.axes, start, stop, self.bands)
        if read.shape != (stop - start, *self.shape[1:]):
            need = "must not change while it is being read"
            remedy = "read it again when no program writes to it"
            raise refused(self.path, need, read.shape, "was changed", remedy=remedy)
        return read.astype(self.dtype, copy=False)

    def scratch_bytes(self, rows: int) -> int:
        """The size that ``into`` needs for this number of rows; 0 if it is not used. [bytes]"""
        return 0

    def with_bands(self, keep: slice) -> "StoredRows":
        """The same rows with a selection of bands; nothing is read."""
        return replace(self, bands=self.bands[keep])


def cube_from_xarray(
    array: Any,
    *,
    wavelengths: tuple[float, float] | Path | str | None = None,
    scale: float | None = None,
) -> Cube:
    """The cube of reflectances in an ``xarray.DataArray``, without copying or computing data.

    Parameters
    ----------
    array
        An array with three axes. One is the wavelength, identified by its name (``wavelength``,
        ``band`` ...) or by the unit of its coordinate (nm, um); the others are rows and columns in
        this order. A dask array is computed when its rows are read.
    wavelengths
        Centers of the first and the last band, with the others evenly spaced between; or a text
        file that lists all. Overrides the coordinate. [nm]
    scale
        Reflectance per stored unit; overrides ``scale_factor``.

    Raises
    ------
    InputError
        If it is not such an array, contains radiance or unscaled integers, or has no wavelengths.

    Examples
    --------
    >>> import xarray
    >>> array = xarray.DataArray(np.full((3, 1, 2), 0.18), dims=("wavelength", "y", "x"),
    ...                          coords={"wavelength": [400.0, 500.0, 600.0]})
    >>> cube = cube_from_xarray(array)
    >>> cube.stored.shape, cube.wavelength_nm.tolist()
    ((1, 2, 3), [400.0, 500.0, 600.0])
    """
    source = f"xarray {getattr(array, 'name', None) or 'array'}"
    return interpreted(source, _found(source, array), wavelengths=wavelengths, scale=scale)


def _found(source: str, array: Any) -> Found:
    if not all(hasattr(array, name) for name in ("dims", "coords", "attrs", "data", "transpose")):
        need = "must be an xarray.DataArray"
        found = f"is a {type(array).__name__}"
        remedy = "take one variable of a Dataset"
        raise refused(source, need, type(array).__name__, found, remedy=remedy)
    if array.ndim != 3 or not array.size or array.dtype.kind not in "fiu":
        need = "must hold real numbers, have three axes and not be empty"
        found = f"is {by(array.shape)} {array.dtype}"
        raise refused(source, need, (*array.shape, str(array.dtype)), found)
    attributes = {str(k).lower(): v for k, v in array.attrs.items()}
    axis, notes = _band_axis(source, array)
    rows, columns = (name for name in array.dims if name != axis)
    data = array.transpose(rows, columns, axis).data
    pixels: Array | RowSource = data if isinstance(data, np.ndarray) else ArrayRows(array=data)
    texts = (attributes.get(n, "") for n in ("long_name", "standard_name", "description"))
    return Found(
        pixels=pixels,
        wavelengths=partial(_coordinate, source, array, axis)
        if _is_spectral_axis(array, axis)
        else None,
        scale=lambda: attribute_scale(source, attributes),
        description=" ".join(str(text) for text in texts),
        units=str(attributes.get("units", "")),
        notes=notes,
    )


def _band_axis(source: str, array: Any) -> tuple[Any, Notes]:
    named = [axis for axis in array.dims if str(axis).lower() in BAND_NAMES]
    spectral = [axis for axis in array.dims if _is_spectral_axis(array, axis)]
    for found in (spectral, named):
        if len(found) == 1:
            rows, columns = (axis for axis in array.dims if axis != found[0])
            return found[0], (f"axes {rows!r}, {columns!r} taken as rows and columns",)
    need = "one of its axes must have the wavelengths"
    held = f"it has {', '.join(map(repr, array.dims))}"
    raise refused(source, need, tuple(array.dims), held, remedy="name that axis 'wavelength'")


def _is_spectral_axis(array: Any, axis: Any) -> bool:
    """Whether the axis has a coordinate of wavelengths; band numbers do not count."""
    if axis not in array.coords or array.coords[axis].dtype.kind not in "fiu":
        return False
    unit = str(array.coords[axis].attrs.get("units", "")).strip().lower()
    return str(axis).lower() in SPECTRAL_NAMES or unit in NM_PER


def _coordinate(source: str, array: Any, axis: Any) -> tuple[Array, Notes]:
    coordinate = array.coords[axis]
    return nanometers(
        source, str(axis), np.asarray(coordinate.values), str(coordinate.attrs.get("units", ""))
    )


def picture_to_xarray(picture: "Picture") -> Any:
    """An ``xarray.Dataset`` of the picture: XYZ and sRGB by row and column, white, notes.

    Parameters
    ----------
    picture
        A result of `chromanoise.imaging.rendered`.

    Raises
    ------
    InputError
        If xarray is not installed.
    """
    xarray = optional_package("xarray", "a picture as an xarray.Dataset", extra="cubes")
    height, width = picture.xyz.shape[:2]
    xyz, rgb = ["X", "Y", "Z"], ["R", "G", "B"]
    return xarray.Dataset(
        {
            "xyz": (("y", "x", "xyz_axis"), picture.xyz, {"long_name": "XYZ, white has Y = 1"}),
            "srgb": (("y", "x", "rgb_axis"), picture.srgb, {"long_name": "sRGB, 8 bit"}),
            "white": (("xyz_axis",), picture.white, {"long_name": "XYZ of the perfect white"}),
        },
        coords={
            "y": np.arange(height),
            "x": np.arange(width),
            "xyz_axis": xyz,
            "rgb_axis": rgb,
        },
        attrs={"notes": "; ".join(picture.notes)},
    )
