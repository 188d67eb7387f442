"""Read hyperspectral cubes from files; the suffix of the name selects the reader."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from chromanoise._check import reason
from chromanoise._inputs import regular_file
from chromanoise.errors import InputError
from chromanoise.io.cubes.arrays import NAMED, named_arrays
from chromanoise.io.cubes.errors import reading
from chromanoise.io.cubes.hdf5 import ENDINGS as HDF5_ENDINGS, hdf5_store, is_hdf5
from chromanoise.io.cubes.interpretation import rising, scale_and_notes, wavelengths_and_notes
from chromanoise.io.cubes.labeled import labeled_cube
from chromanoise.io.cubes.npz import npy_array
from chromanoise.io.cubes.picture import picture
from chromanoise.io.cubes.png_folder import is_png_folder, png_folder_cube
from chromanoise.io.cubes.raw_cube import Found, refuse_other_shape, unused_key
from chromanoise.io.cubes.tiff import ENDINGS as TIFF_ENDINGS, tiff_cube
from chromanoise.io.cubes.zarr_store import is_zarr, zarr_store
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
        file that lists all (`chromanoise.io.cubes.wavelength_file`). Overrides those of the cube.
        [nm]
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
    found = _found(path, key, shape)
    factor, scale_notes = scale_and_notes(path, found, scale)
    wavelength, wavelength_notes = wavelengths_and_notes(path, found, wavelengths)
    pixels, wavelength, order_notes = rising(path, found.pixels, wavelength)
    return Cube(
        wavelength_nm=wavelength,
        stored=pixels,
        scale=factor,
        source=str(path),
        notes=(*found.notes, *scale_notes, *wavelength_notes, *order_notes),
    )


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


def _found(path: Path, key: str | None, shape: tuple[int, int] | None) -> Found:
    """Read ``path`` by its suffix; a file with any other suffix needs an ENVI header."""
    ending = path.suffix.lower()
    if path.is_dir():
        return _folder(path, key, shape)
    if ending == ".mat" and is_hdf5(path):
        return labeled_cube(hdf5_store(path, matlab=True), key, shape)
    if ending in HDF5_ENDINGS:
        return _hdf5(path, key, shape)
    if ending in NAMED:
        return named_arrays(path, key, shape, NAMED[ending])
    if ending in TIFF_ENDINGS and _header_of(path) is None:
        return _only_one(tiff_cube(path, shape), key)
    if ending != ".npy":
        return _envi(path, key, shape)
    with reading(path, "NumPy"):
        array = npy_array(path)
    pixels, notes = picture(path, "the array", array, shape, by_columns=False)
    return _only_one(Found(pixels=pixels, notes=notes), key)


def _header_of(path: Path) -> Path | None:
    """The ENVI header with the name of the file, or None."""
    pair = envi_pair(path)
    return None if pair is None else pair[0]


def _only_one(found: Found, key: str | None) -> Found:
    return replace(found, notes=(*unused_key(key), *found.notes))


def _folder(path: Path, key: str | None, shape: tuple[int, int] | None) -> Found:
    if is_zarr(path):
        return labeled_cube(zarr_store(path), key, shape)
    if is_png_folder(path):
        return _only_one(png_folder_cube(path, shape), key)
    raise InputError(
        str(path),
        "must be a file, a Zarr store or a folder of one PNG per band",
        found="is another directory",
        remedy="name the file of the cube in it",
    )


def _hdf5(path: Path, key: str | None, shape: tuple[int, int] | None) -> Found:
    if not is_hdf5(path):
        raise InputError(
            str(path),
            "must be an HDF5 file, as NetCDF-4 is",
            found="is in another format",
            remedy=("convert it (nccopy -k nc4)", "save it again"),
        )
    return labeled_cube(hdf5_store(path), key, shape)


def _envi(path: Path, key: str | None, shape: tuple[int, int] | None) -> Found:
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
        notes=(*unused_key(key), *notes),
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
    return InputError(
        str(path),
        "must be a cube in a supported format: ENVI (.hdr and its data), .mat, .npz, .npy, .h5, "
        ".nc, .zarr, .tif or a folder of PNGs",
        value=path.suffix,
        found=f"ends in {path.suffix}",
    )
