"""Read cubes from, and write pictures to, labeled arrays of xarray."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.io.cubes.errors import library
from chromanoise.io.cubes.interpretation import interpreted
from chromanoise.io.cubes.labeled import attribute_scale
from chromanoise.io.cubes.raw_cube import Found, Notes, by
from chromanoise.io.spectra.wavelength_lists import BAND_NAMES, NM_PER, SPECTRAL_NAMES, nanometers
from chromanoise.scene.cube import Cube
from chromanoise.scene.rows import ArrayRows, RowSource

if TYPE_CHECKING:
    from chromanoise.imaging.render import Picture


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
        raise InputError(
            source,
            "must be an xarray.DataArray",
            value=type(array).__name__,
            found=f"is a {type(array).__name__}",
            remedy="take one variable of a Dataset",
        )
    if array.ndim != 3 or not array.size or array.dtype.kind not in "fiu":
        raise InputError(
            source,
            "must hold real numbers, have three axes and not be empty",
            value=(*array.shape, str(array.dtype)),
            found=f"is {by(array.shape)} {array.dtype}",
        )
    attributes = {str(k).lower(): v for k, v in array.attrs.items()}
    axis, notes = _band_axis(source, array)
    rows, columns = (name for name in array.dims if name != axis)
    data = array.transpose(rows, columns, axis).data
    pixels: Array | RowSource = data if isinstance(data, np.ndarray) else ArrayRows(array=data)
    texts = (attributes.get(n, "") for n in ("long_name", "standard_name", "description"))
    return Found(
        pixels=pixels,
        wavelengths=partial(_coordinate, source, array, axis)
        if _is_spectral(array, axis)
        else None,
        scale=lambda: attribute_scale(source, attributes),
        description=" ".join(str(text) for text in texts),
        units=str(attributes.get("units", "")),
        notes=notes,
    )


def _band_axis(source: str, array: Any) -> tuple[Any, Notes]:
    named = [axis for axis in array.dims if str(axis).lower() in BAND_NAMES]
    spectral = [axis for axis in array.dims if _is_spectral(array, axis)]
    for found in (spectral, named):
        if len(found) == 1:
            rows, columns = (axis for axis in array.dims if axis != found[0])
            return found[0], (f"axes {rows!r}, {columns!r} taken as rows and columns",)
    raise InputError(
        source,
        "one of its axes must have the wavelengths",
        value=tuple(array.dims),
        found=f"it has {', '.join(map(repr, array.dims))}",
        remedy="name that axis 'wavelength'",
    )


def _is_spectral(array: Any, axis: Any) -> bool:
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
    xarray = library("xarray", "a picture as an xarray.Dataset")
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
