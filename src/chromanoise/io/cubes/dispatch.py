"""Read hyperspectral cubes from files: a format is one entry of `FORMATS`."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from chromanoise._check import reason
from chromanoise._inputs import regular_file
from chromanoise.errors import InputError
from chromanoise.io.cubes.hdf5 import ENDINGS as HDF5_ENDINGS, hdf5_store, is_hdf5
from chromanoise.io.cubes.interpretation import interpreted
from chromanoise.io.cubes.labeled import Store, array_store, labeled_cube
from chromanoise.io.cubes.npz import npy_cube, npz_store
from chromanoise.io.cubes.png_folder import is_png_folder, png_folder_cube
from chromanoise.io.cubes.raw_cube import Found, refuse_other_shape
from chromanoise.io.cubes.tiff import ENDINGS as TIFF_ENDINGS, tiff_cube
from chromanoise.io.cubes.zarr_store import is_zarr, zarr_store
from chromanoise.io.matlab import mat_array, mat_arrays
from chromanoise.io.spectra.envi import (
    DATA_SUFFIXES,
    envi_pair,
    envi_pixels,
    envi_scale,
    envi_wavelengths,
    has_envi_wavelengths,
    read_envi_header,
)
from chromanoise.scene.cube import Cube


def read_cube(
    path: Path | str,
    *,
    key: str | None = None,
    shape: tuple[int, int] | None = None,
    wavelengths: tuple[float, float] | Path | str | None = None,
    scale: float | None = None,
) -> Cube:
    """Read a cube of reflectances from a file or folder.

    Supported are ENVI, MATLAB, .npz, .npy, HDF5, NetCDF-4, Zarr, TIFF of one page per band, and a
    folder of one PNG per band. ENVI, .npy, HDF5, Zarr and uncompressed TIFF stay on disk. Bands are
    in the order of increasing wavelength; the notes list assumptions.

    Parameters
    ----------
    path
        The file or folder; for an ENVI pair, either file.
    key
        Name of the array in a .mat, .npz, HDF5, NetCDF or Zarr file; default ``reflectance``.
    shape
        Rows and columns of an array that stores pixels in one axis. [pixels]
    wavelengths
        Centers of the first and the last band, with the others evenly spaced between; or a text
        file that lists all (`chromanoise.io.cubes.interpretation.read_wavelengths`). Overrides
        those of the cube. [nm]
    scale
        Reflectance per stored unit. Overrides the file, even if it declares radiance.

    Returns
    -------
    Cube
        The cube; its rows are read when they are needed.

    Raises
    ------
    InputError
        If the file cannot be read, contains radiance or unscaled integers, or does not declare its
        wavelengths.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(f"{folder}/cube.npy", np.full((1, 2, 3), 0.18))
    ...     cube = read_cube(f"{folder}/cube.npy", wavelengths=(400, 600))
    >>> cube.wavelength_nm, cube.stored[0, 1, 2]
    (array([400., 500., 600.]), np.float64(0.18))
    """
    path = Path(path)
    _refuse_no_file(path)
    return interpreted(path, _found(path, key, shape), wavelengths=wavelengths, scale=scale)


def _refuse_no_file(path: Path) -> None:
    status = regular_file(path, folder=True)
    if path.is_dir():
        return
    if status.st_size == 0:
        raise InputError(
            str(path),
            "must not be empty",
            value=0,
            found="has 0 bytes",
            remedy="copy or save it again",
        )
    try:
        path.open("rb").close()
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({reason(error)})") from None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CubeFormat:
    """A format of cubes; either ``store`` or ``cube`` reads it.

    Attributes
    ----------
    shown
        Its usual endings, for messages.
    matches
        Whether a file or folder has this format.
    store
        The named arrays of a file.
    cube
        The content of a file of one array, given the shape of the picture.
    """

    shown: str
    matches: Callable[[Path], bool]
    store: Callable[[Path], Store] | None = None
    cube: Callable[[Path, tuple[int, int] | None], Found] | None = None


def _ends(*endings: str) -> Callable[[Path], bool]:
    return lambda path: path.suffix.lower() in endings and not path.is_dir()


def _matlab_store(path: Path) -> Store:
    """MATLAB 5 files store whole numbers in as few bytes as possible."""
    if is_hdf5(path):
        return hdf5_store(path, matlab=True)
    return array_store(path, "MATLAB", mat_arrays, mat_array, by_columns=True, stored_item_bytes=1)


def _is_tiff(path: Path) -> bool:
    """Whether it is a TIFF, and not the data of an ENVI header."""
    return _ends(*TIFF_ENDINGS)(path) and envi_pair(path) is None


FORMATS = (
    CubeFormat(shown=".mat", matches=_ends(".mat"), store=_matlab_store),
    CubeFormat(shown=".npz", matches=_ends(".npz"), store=npz_store),
    CubeFormat(shown=".npy", matches=_ends(".npy"), cube=npy_cube),
    CubeFormat(shown=".h5, .nc", matches=_ends(*HDF5_ENDINGS), store=hdf5_store),
    CubeFormat(shown=".zarr", matches=is_zarr, store=zarr_store),
    CubeFormat(shown=".tif", matches=_is_tiff, cube=tiff_cube),
    CubeFormat(shown="a folder of PNGs", matches=is_png_folder, cube=png_folder_cube),
)
"""All formats but ENVI, which any other file with a header has."""


def _found(path: Path, key: str | None, shape: tuple[int, int] | None) -> Found:
    form = next((one for one in FORMATS if one.matches(path)), None)
    if form is not None and form.store is not None:
        return labeled_cube(form.store(path), key, shape)
    if form is None and path.is_dir():
        raise InputError(
            str(path),
            "must be a file, a Zarr store or a folder of one PNG per band",
            found="is another directory",
            remedy="name the file of the cube in it",
        )
    found = ((form and form.cube) or _envi)(path, shape)
    unused = () if key is None else (f"key {key!r} not used: the file holds one array",)
    return replace(found, notes=(*unused, *found.notes))


def _envi(path: Path, shape: tuple[int, int] | None) -> Found:
    try:
        pair = envi_pair(path)
        if pair is None:
            raise _unknown(path)
        header = read_envi_header(pair[0])
        pixels, notes = envi_pixels(header, pair[1])
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({reason(error)})") from None
    refuse_other_shape(path, pixels, shape)
    return Found(
        pixels=pixels,
        wavelengths=partial(envi_wavelengths, header) if has_envi_wavelengths(header) else None,
        scale=partial(envi_scale, header),
        description=header.fields.get("description", ""),
        units=" ".join(header.fields.get(name, "") for name in ("data units", "units")),
        notes=notes,
    )


def _unknown(path: Path) -> InputError:
    if path.suffix.lower() in ("", *DATA_SUFFIXES):
        # both names are equal if the file has no suffix
        names = dict.fromkeys((f"{path.name}.hdr", f"{path.stem}.hdr"))
        return InputError(
            str(path),
            f"needs an ENVI header beside it ({' or '.join(names)}) to read its numbers",
            found="has none",
        )
    *most, last = (form.shown for form in FORMATS)
    others = ", ".join(most)
    return InputError(
        str(path),
        f"must be a cube in a supported format: ENVI (.hdr and its data), {others} or {last}",
        value=path.suffix,
        found=f"ends in {path.suffix}",
    )
