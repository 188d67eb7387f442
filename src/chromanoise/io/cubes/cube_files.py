"""Read hyperspectral cubes: the formats of `FORMATS`, here NumPy's files, ENVI and folders of PNG.

Pickled data in NumPy's files are never loaded. A folder has one PNG per band, as in the CAVE
database.
"""

import io
import math
import re
import zipfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import IO, Any

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    InputError,
    Shaped,
    dataclass,
    regular_file,
    system_errors_of,
)
from chromanoise.io.cubes.cube_metadata import interpreted
from chromanoise.io.cubes.found_cube import (
    Found,
    Notes,
    picture,
    reading,
    refuse_impossible,
    refuse_other_shape,
)
from chromanoise.io.cubes.hdf5 import ENDINGS as HDF5_ENDINGS, hdf5_store, is_hdf5
from chromanoise.io.cubes.labeled import Store, array_store, labeled_cube
from chromanoise.io.cubes.tiff import ENDINGS as TIFF_ENDINGS, tiff_cube
from chromanoise.io.cubes.zarr_store import is_zarr, zarr_store
from chromanoise.io.envi import (
    DATA_SUFFIXES,
    envi_pair,
    envi_pixels,
    envi_scale,
    envi_wavelengths,
    has_envi_wavelengths,
    read_envi_header,
)
from chromanoise.io.matlab import mat_array, mat_arrays
from chromanoise.io.source_files import has, refused
from chromanoise.spectra import Cube

Declared = tuple[tuple[int, ...], np.dtype]

_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # the methods that NumPy writes

_HEADER_READERS = {  # version (3, 0) is only for structured types
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def npz_arrays(path: Path) -> dict[str, Declared]:
    """Shape and type of every array in a ``.npz``, without reading the numbers.

    Raises
    ------
    InputError
        If the header of an array does not match the number of bytes after it.
    """
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        for info in archive.infolist():
            if info.filename.endswith(".npy"):
                name = info.filename.removesuffix(".npy")
                if info.compress_type not in _METHODS:
                    need = "must be stored or deflated, as NumPy does"
                    found = f"has compression method {info.compress_type}"
                    where = f"array {name!r}"
                    remedy = "save it with numpy.savez"
                    raise refused(path, need, info.compress_type, found, where=where, remedy=remedy)
                with archive.open(info) as stream:
                    arrays[name] = _declared(stream, info.file_size, path, f"array {name!r}")
    return arrays


def npz_store(path: Path) -> Store:
    """The arrays of a ``.npz``, without their numbers."""
    return array_store(path, "NPZ", npz_arrays, npz_array)


def npz_array(path: Path, name: str) -> Shaped[Array, "..."]:
    """The numbers of one array of a ``.npz``."""
    with zipfile.ZipFile(path) as archive, archive.open(f"{name}.npy") as stream:
        return np.lib.format.read_array(stream, allow_pickle=False)


def npy_cube(path: Path, shape: tuple[int, int] | None) -> Found:
    """The cube in the only array of a ``.npy``."""
    with reading(path, "NumPy"):
        array = npy_array(path)
    pixels, notes = picture(path, "the array", array, shape, by_columns=False)
    return Found(pixels=pixels, notes=notes)


def npy_array(path: Path) -> Shaped[Array, "..."]:
    """The array of real numbers in a ``.npy``, as a memory map.

    Raises
    ------
    InputError
        If the array has another type, or its header does not match the number of bytes after it.
    """
    with path.open("rb") as stream:
        _, dtype = _declared(stream, path.stat().st_size, path, "")
    if dtype.kind not in "fiu":
        need = "must hold real numbers"
        found = f"is of type {dtype.name}"
        raise refused(path, need, dtype.name, found, remedy="save it as a plain array")
    return np.lib.format.open_memmap(path, mode="r")


def npy_header(stream: Any) -> tuple[tuple[int, ...], bool, np.dtype]:
    """Shape, whether the columns come first, and type; objects for a version of structured types.

    Parameters
    ----------
    stream
        A stream at the start of a ``.npy``; afterwards, it is at the numbers.
    """
    reader = _HEADER_READERS.get(np.lib.format.read_magic(stream))
    return reader(stream) if reader else ((), False, np.dtype("O"))


def _declared(stream: IO[bytes] | io.BufferedIOBase, size: int, path: Path, where: str) -> Declared:
    """Shape and type from the header at the start of ``stream``; objects have no shape."""
    shape, _, dtype = npy_header(stream)
    if dtype.hasobject:
        return (), np.dtype("O")
    expected = stream.tell() + math.prod(shape) * dtype.itemsize
    if size != expected:
        need = f"must hold the {expected} bytes that its header describes"
        remedy = "save it again, because it is truncated or damaged"
        raise has(path, need, size, "holds", where=where, remedy=remedy)
    return shape, dtype


def envi_cube(path: Path, shape: tuple[int, int] | None) -> Found | None:
    """A cube from its header or its data; ``None`` where no header is beside.

    Parameters
    ----------
    shape
        Height and width that it must have; ``None`` for any. [pixels]

    Raises
    ------
    InputError
        If the header or the numbers are damaged.
    """
    with system_errors_of(path):
        pair = envi_pair(path)
        if pair is None:
            return None
        header = read_envi_header(pair[0])
        pixels, notes = envi_pixels(header, pair[1])
    refuse_other_shape(path, pixels, shape)
    return Found(
        pixels=pixels,
        wavelengths=partial(envi_wavelengths, header) if has_envi_wavelengths(header) else None,
        scale=partial(envi_scale, header),
        description=header.fields.get("description", ""),
        units=" ".join(header.fields.get(name, "") for name in ("data units", "units")),
        notes=notes,
    )


_LAST_NUMBER = re.compile(r"(\d{1,6})(?=\D*$)")
_CAVE = re.compile(r".*_ms_\d\d$", re.I)
_CAVE_BANDS, _CAVE_NM = 31, (400.0, 700.0)
_GRAY: dict[str, np.dtype] = {"L": np.dtype("u1"), "I;16": np.dtype("u2"), "I;16B": np.dtype("u2")}
_NM_NAMES = (300, 20000)  # numbers in names that step evenly in this range are wavelengths
_MOST_BANDS = 10_000


def is_png_folder(path: Path) -> bool:
    """Whether the folder contains at least two PNGs."""
    return len(_pngs(path)) > 1


def png_folder_cube(path: Path, shape: tuple[int, int] | None) -> Found:
    """The bands of a folder, in the order of the last number in the names of its PNGs.

    Raises
    ------
    InputError
        If a number is missing or repeated, or the pictures differ in size or type.

    Notes
    -----
    Yasuma, Mitsunaga, Iso & Nayar, "Generalized Assorted Pixel Camera", IEEE Trans. Image
    Process. 19 (2010): the CAVE database has 31 bands, 400 to 700 nm in steps of 10 nm.
    """
    files = _pngs(path)
    if len(files) > _MOST_BANDS:
        raise has(path, f"must hold at most {_MOST_BANDS} PNGs", len(files), "holds")
    numbers, ordered = _ordered(path, files)
    pixels = _stacked(path, ordered)
    refuse_other_shape(path, pixels, shape)
    listed = _wavelengths(numbers, ordered)
    return Found(
        pixels=pixels,
        wavelengths=None if listed is None else lambda: listed,
        notes=(f"bands taken in the order of the numbers {numbers[0]} to {numbers[-1]} in the "
               "names of the files",),
    )  # fmt: skip


def _pngs(path: Path) -> list[Path]:
    try:
        return sorted(p for p in path.iterdir() if p.suffix.lower() == ".png" and p.is_file())
    except OSError:
        return []


def _ordered(path: Path, files: list[Path]) -> tuple[list[int], list[Path]]:
    by_number: dict[int, Path] = {}
    for file in files:
        found = _LAST_NUMBER.search(file.stem)
        if found is None:
            need = "must have a number in its name, which gives its place among the bands"
            remedy = ("number the files", "move this one away")
            raise refused(file, need, file.stem, "has none", remedy=remedy)
        number = int(found[1])
        if number in by_number:
            need = "must have one PNG per number"
            held = f"{by_number[number].name} and {file.name} have the same number"
            raise refused(path, need, number, held, remedy="move one away")
        by_number[number] = file
    numbers = sorted(by_number)
    _refuse_gaps(path, numbers)
    return numbers, [by_number[number] for number in numbers]


def _refuse_gaps(path: Path, numbers: list[int]) -> None:
    steps = np.diff(numbers)
    if not (steps == steps[0]).all() or (steps[0] > 1 and not _are_wavelengths(numbers)):
        i = int(np.argmax(steps > steps.min()))
        need = "numbers in the names of the files must step evenly"
        found = f"number {numbers[i + 1]} follows {numbers[i]}"
        raise refused(path, need, numbers[i + 1], found, remedy="add the band that is missing")


def _are_wavelengths(numbers: list[int]) -> bool:
    low, high = _NM_NAMES
    return numbers[1] - numbers[0] > 1 and low <= numbers[0] and numbers[-1] <= high


def _wavelengths(numbers: list[int], files: list[Path]) -> tuple[Float[Array, " m"], Notes] | None:
    if _are_wavelengths(numbers):
        return np.array(numbers, dtype=np.float64), (
            "numbers in the names of the files taken as wavelengths in nm",
        )
    if numbers == list(range(1, _CAVE_BANDS + 1)) and all(_CAVE.match(f.stem) for f in files):
        note = "names as in the CAVE database: wavelengths 400 to 700 nm in steps of 10 nm"
        return np.linspace(*_CAVE_NM, _CAVE_BANDS), (note,)
    return None


def _stacked(path: Path, files: list[Path]) -> Shaped[Array, "h w m"]:
    """All bands in memory, because PNG does not support reading single rows."""
    opened = [_size_and_kind(file) for file in files]
    for file, (size, dtype) in zip(files, opened, strict=True):
        if (size, dtype) != opened[0]:
            raise refused(
                file,
                f"must be {opened[0][0][0]}x{opened[0][0][1]} {opened[0][1].name} as "
                f"{files[0].name}, because all bands must be alike",
                (*size, dtype.name),
                f"is {size[0]}x{size[1]} {dtype.name}",
            )
    (width, height), dtype = opened[0]
    total = sum(file.stat().st_size for file in files)
    refuse_impossible(path, "all bands", (len(files), height, width), dtype, size=total)
    planes = np.empty((len(files), height, width), dtype=dtype)
    for plane, file in zip(planes, files, strict=True):
        with reading(file, "PNG"), _image(file) as image:
            plane[:] = np.asarray(image)
    return planes.transpose(1, 2, 0)


def _size_and_kind(file: Path) -> tuple[tuple[int, int], np.dtype]:
    with reading(file, "PNG"), _image(file) as image:
        size: tuple[int, int] = image.size
        mode = str(image.mode)
    if mode not in _GRAY:
        need = "must be gray with 8 or 16 bits"
        found = f"has pixels of kind {mode}"
        raise refused(file, need, mode, found, remedy=("save it in that form", "move it away"))
    return size, _GRAY[mode]


def _image(file: Path) -> Any:
    from PIL.PngImagePlugin import PngImageFile

    return PngImageFile(file)  # its size is bounded here, not by Pillow


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
        file that lists all (``read_wavelengths``). Overrides
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
        raise refused(path, "must not be empty", 0, "has 0 bytes", remedy="copy or save it again")
    with system_errors_of(path):
        path.open("rb").close()


@dataclass(frozen=True, kw_only=True, eq=False)
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
        need = "must be a file, a Zarr store or a folder of one PNG per band"
        held = "is another directory"
        raise refused(path, need, found=held, remedy="name the file of the cube in it")
    found = ((form and form.cube) or envi_cube)(path, shape)
    if found is None:
        raise _unknown(path)
    unused = () if key is None else (f"key {key!r} not used: the file holds one array",)
    return replace(found, notes=(*unused, *found.notes))


def _unknown(path: Path) -> InputError:
    if path.suffix.lower() in ("", *DATA_SUFFIXES):
        # both names are equal if the file has no suffix
        names = dict.fromkeys((f"{path.name}.hdr", f"{path.stem}.hdr"))
        need = f"needs an ENVI header beside it ({' or '.join(names)}) to read its numbers"
        return refused(path, need, found="has none")
    *most, last = (form.shown for form in FORMATS)
    others = ", ".join(most)
    need = f"must be a cube in a supported format: ENVI (.hdr and its data), {others} or {last}"
    return refused(path, need, path.suffix, f"ends in {path.suffix}")
