"""The formats of raw frames by file ending: NPY, NPZ, PGM, PNG, raw dumps, FITS.

Pickled data are never loaded. A PNG file must have one channel. A raw dump has the codes of one
frame, row by row, without a header. astropy reads the headers of FITS files; their codes are read
in place.
"""

import math
import re
import struct
import warnings
import zipfile
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import (
    Array,
    InputError,
    Integer,
    optional_package,
    printable,
    regular_file,
    system_errors_of,
)
from chromanoise.io.cubes.cube_files import npy_array, npy_header, npz_arrays
from chromanoise.io.cubes.found_cube import reading, reading_rows, refuse_impossible
from chromanoise.io.frames.camera_raw import camera_name, number_of_tag, raw_frames, tiff_frames
from chromanoise.io.frames.frame import (
    RawFrame,
    StoredPlane,
    refuse_shape,
    refused_picture,
    whole_codes,
)
from chromanoise.io.source_files import has, refused
from chromanoise.sensor import Mosaic

_MOST_ARRAYS = 20_000


def npy_frames(path: Path) -> tuple[RawFrame, ...]:
    """The frame in a ``.npy``, or the stack of frames; each is read in place.

    Raises
    ------
    InputError
        If the file is damaged, or holds no array of 2 or 3 dimensions.
    """
    with reading(path, "NumPy"):
        array = npy_array(path)
    refuse_shape(path, "", array.shape)
    by_columns = not array.flags.c_contiguous
    if by_columns and array.ndim == 3:
        raise _of_columns(path)
    place, shape = int(array.offset), _sides(array.shape)  # type: ignore[attr-defined]
    frame_bytes = math.prod(shape) * array.dtype.itemsize

    def read(i: int | None) -> StoredPlane:
        return StoredPlane(path, place + (i or 0) * frame_bytes, array.dtype, shape, by_columns)

    return _stack(path, array.shape, read)


def _sides(shape: tuple[int, ...]) -> tuple[int, int]:
    return int(shape[-2]), int(shape[-1])


def _stack(
    path: Path,
    shape: tuple[int, ...],
    read: Callable[[int | None], Callable[[], Array]],
    **facts: Any,
) -> tuple[RawFrame, ...]:
    """The frame of an array of 2 dimensions, or all frames of one of 3, by the reader of each."""
    numbers = range(shape[0]) if len(shape) == 3 else (None,)
    sides = _sides(shape)
    return tuple(RawFrame(path=path, shape=sides, index=i, read=read(i), **facts) for i in numbers)


def _of_columns(path: Path, where: str = "") -> InputError:
    need = "must store a stack frame by frame"
    remedy = "save numpy.ascontiguousarray(stack)"
    return refused(path, need, found="is in Fortran order", where=where, remedy=remedy)


def npz_frames(path: Path) -> tuple[RawFrame, ...]:
    """The frames of all arrays in a ``.npz``; `RawFrame.part` is the name of the array.

    Raises
    ------
    InputError
        If the file is damaged, or an array has not 2 or 3 dimensions.
    """
    with reading(path, "NPZ"):
        arrays = npz_arrays(path)
    if not 0 < len(arrays) <= _MOST_ARRAYS:
        raise has(path, f"must hold 1 to {_MOST_ARRAYS} arrays", len(arrays), "holds")
    frames: tuple[RawFrame, ...] = ()
    for name, (shape, dtype) in arrays.items():
        refuse_shape(path, f"array {printable(name)!r}", shape)
        refuse_impossible(path, name, shape[-2:], dtype)
        read = partial(partial, _member, path, name, shape, dtype)
        frames += _stack(path, shape, read, part=name)
    return frames


def _member(
    path: Path, name: str, shape: tuple[int, ...], stored: np.dtype, index: int | None
) -> Integer[Array, "h w"]:
    """A frame of an array in a ``.npz``; a compressed stack is unpacked up to it."""
    where, sides = f"array {name!r}", _sides(shape)
    with (
        reading_rows(path, "NPZ"),
        zipfile.ZipFile(path) as archive,
        archive.open(f"{name}.npy") as stream,
    ):
        now, by_columns, dtype = npy_header(stream)
        if (now, dtype) != (shape, stored):
            raise refused(path, "must not change while it is read", where=where)
        if by_columns and len(shape) == 3:
            raise _of_columns(path, where)
        count = math.prod(sides) * dtype.itemsize
        stream.seek((index or 0) * count, 1)
        content = stream.read(count)
        if len(content) != count:
            raise refused(path, "is truncated", where=where)
        values = np.frombuffer(content, dtype)
        codes = values.reshape(sides[::-1]).T if by_columns else values.reshape(sides)
    return whole_codes(str(path), codes)


_PGM = re.compile(rb"P([25])(?:\s|#[^\n]*\n)+" + rb"(?:\s|#[^\n]*\n)+".join([rb"(\d{1,9})"] * 3))
_HEADER_BYTES = 65536
_PNG = b"\x89PNG\r\n\x1a\n"
_MOST_CODE = 65535


def pgm_frames(path: Path) -> tuple[RawFrame, ...]:
    """The frame in a PGM: plain (P2) or binary (P5), of 8 or 16 bits, most significant byte first.

    Raises
    ------
    InputError
        If the header is damaged, the size of the file does not match it, or the file is a PPM.

    Notes
    -----
    The Netpbm project, pgm(5). A comment is read in the header only.
    """
    with path.open("rb") as file:
        start = file.read(_HEADER_BYTES)
    if re.match(rb"P[36]\s", start):
        raise refused_picture(path, "is a color picture (PPM)")
    match = _PGM.match(start)
    after = start[match.end() : match.end() + 1] if match else b""
    if match is None or not after.isspace():
        with reading(path, "PGM"):
            raise ValueError("no header P5 or P2 with width, height and largest code")
    width, height, largest = (int(match[i]) for i in (2, 3, 4))
    shape, offset, size = (height, width), match.end() + 1, path.stat().st_size
    refuse_shape(path, "", shape)
    if not 0 < largest <= _MOST_CODE:
        raise refused(path, f"must have a largest code of 1 to {_MOST_CODE}", largest)
    plain = match[1] == b"2"
    stored = np.dtype("u1" if largest < 256 else ">u2")
    least = height * width * (1 if plain else stored.itemsize)
    if (plain and offset + 2 * least - 1 > size) or (not plain and offset + least != size):
        raise refused(
            path,
            f"must have {'at least ' if plain else ''}{least} "
            f"{'codes' if plain else 'bytes'} after its header",
            size - offset,
            f"has {size - offset} bytes",
            remedy="save it again, one frame per file, because it is truncated or damaged",
        )
    plane = StoredPlane(path, offset, stored, shape)
    bits = largest.bit_length() if largest < _MOST_CODE and (largest + 1).bit_count() == 1 else None
    return (
        RawFrame(
            path=path,
            shape=shape,
            read=partial(_pgm_codes, plane, plain, largest),
            bits=bits,
            white_level_dn=float(largest) if largest < _MOST_CODE else None,
        ),
    )


def _pgm_codes(plane: StoredPlane, plain: bool, largest: int) -> Integer[Array, "h w"]:
    """The codes, none above the largest one of the header."""
    codes = _plain_codes(plane) if plain else plane()
    if codes.max() > largest:
        need = f"must have codes up to {largest}, as stated in its header"
        raise has(plane.path, need, int(codes.max()))
    return codes


def _plain_codes(plane: StoredPlane) -> Integer[Array, "h w"]:
    """Decimal numbers between blanks."""
    path, count = plane.path, math.prod(plane.shape)
    need = f"must have {count} codes of at most {_MOST_CODE} after its header"
    with (
        reading_rows(path, "PGM"),
        path.open("rb") as file,
        warnings.catch_warnings(action="ignore"),  # NumPy before 2.3 warns of other words
    ):
        file.seek(plane.offset)
        try:
            codes = np.fromfile(file, np.int64, count, sep=" ")
        except ValueError:
            raise refused(path, need, found="has words that are no numbers") from None
        more = file.read(20).strip()
    if more or codes.min(initial=0) < 0 or codes.max(initial=0) > _MOST_CODE:
        raise refused(path, need, found="has more or larger ones")
    if codes.size != count:
        raise has(path, f"must have {count} codes", codes.size)
    return codes.astype(np.uint16).reshape(plane.shape)


def png_frames(path: Path) -> tuple[RawFrame, ...]:
    """The frame in a PNG of 8 or 16 bits of gray, without gamma.

    Raises
    ------
    InputError
        If the file is damaged or has colors, an alpha channel or a palette.
    """
    with path.open("rb") as file:
        start = file.read(33)
    if start[:8] != _PNG or start[12:16] != b"IHDR" or len(start) < 33:
        with reading(path, "PNG"):
            raise ValueError("no header IHDR")
    width, height, bits, kind = struct.unpack(">IIBB", start[16:26])
    if kind != 0 or bits not in (8, 16):
        raise refused_picture(path, f"is a PNG of color type {kind} and {bits} bits")
    refuse_shape(path, "", (height, width))
    refuse_impossible(path, "pixels", (height, width), np.dtype(f"u{bits // 8}"))
    read = partial(_png_codes, path, (height, width), bits)
    return (RawFrame(path=path, shape=(height, width), read=read, bits=8 if bits == 8 else None),)


def _png_codes(path: Path, shape: tuple[int, int], bits: int) -> Integer[Array, "h w"]:
    from PIL import PngImagePlugin

    with reading(path, "PNG"), PngImagePlugin.PngImageFile(path) as image:
        if image.size != shape[::-1]:
            raise refused(path, "must not change while it is read")
        codes: Any = np.asarray(image)
    if codes.shape != shape or codes.dtype.kind not in "ui":
        raise refused_picture(path, f"is a PNG of {codes.dtype}")
    return codes.astype(np.uint8 if bits == 8 else np.uint16)


DUMP_ENDINGS = (".raw", ".bin")
"""Endings of files whose size and type of codes must be given."""
DUMP_TYPES: Mapping[str, str] = {"uint8": "u1", "uint16": "<u2", "uint16-be": ">u2"}
"""Types of the codes by name: 8 bits, 16 bits little-endian, 16 bits big-endian."""


def dumped_frame(path: Path, shape: tuple[int, int], stored: str = "uint16") -> RawFrame:
    """The frame of a raw dump, which is read in place.

    Parameters
    ----------
    path
        A file that holds the codes and nothing else.
    shape
        Rows and columns. [px]
    stored
        A name of `DUMP_TYPES`.

    Raises
    ------
    InputError
        If the file has another number of bytes.
    """
    dtype = np.dtype(DUMP_TYPES[stored])
    size = regular_file(path).st_size
    refuse_shape(path, "", shape)
    wanted = shape[0] * shape[1] * dtype.itemsize
    if size != wanted:
        need = f"must have {wanted} bytes for {shape[0]} rows and {shape[1]} columns of {stored}"
        raise has(path, need, size, remedy="give its rows, columns and type")
    return RawFrame(path=path, shape=shape, read=StoredPlane(path, 0, dtype, shape))


_MOST_PARTS = 10_000
_TYPES = {8: ">u1", 16: ">i2", 32: ">i4", 64: ">i8", -32: ">f4", -64: ">f8"}
_LARGEST_OFFSET = 2.0**53


def fits_frames(path: Path) -> tuple[RawFrame, ...]:
    """The images of a FITS file; three axes are a stack. Tables are not used.

    ``EXPTIME`` or ``EXPOSURE`` is the exposure time in s, ``ISOSPEED`` the ISO, ``GAIN`` the gain
    setting, ``INSTRUME`` the camera, ``BAYERPAT`` the mosaic with its offsets ``XBAYROFF`` and
    ``YBAYROFF``. Codes are BZERO + BSCALE times the stored number.

    Raises
    ------
    InputError
        If astropy is not installed, the file is damaged, or an image is compressed.

    Notes
    -----
    FITS Standard 4.0 (IAU FITS Working Group, 2018), section 4.4. The rows of the mosaic are those
    of the file from its start, as ``ROWORDER = TOP-DOWN``; with ``BOTTOM-UP`` they are reversed.
    """
    fits = optional_package("astropy.io.fits", str(path), extra="fits")
    frames: list[RawFrame] = []
    with reading(path, "FITS"), path.open("rb") as file:
        if file.read(10) != b"SIMPLE  = ":
            raise ValueError("no SIMPLE at its start")
        file.seek(0)
        parts = fits.open(file, mode="readonly", memmap=False)
        first = parts[0].header
        for number, part in enumerate(parts):
            if number >= _MOST_PARTS:
                raise refused(path, f"must have at most {_MOST_PARTS} parts")
            if type(part).__name__ == "CompImageHDU" or part.header.get("ZIMAGE") is True:
                need = "must not be compressed"
                raise refused(path, need, where=f"part {number}", remedy="unpack it with funpack")
            if part.is_image and part.header.get("NAXIS", 0):
                frames += _of_part(path, number, part, first)
    if not frames:
        raise refused(path, "must hold an image", found="holds none")
    if len({frame.place for frame in frames}) < len(frames):
        raise refused(path, "must name each extension once")
    return tuple(frames)


def _of_part(path: Path, number: int, part: Any, first: Any) -> tuple[RawFrame, ...]:
    header, where = part.header, f"part {number}"
    axes = tuple(int(header[f"NAXIS{i}"]) for i in range(int(header["NAXIS"]), 0, -1))
    refuse_shape(path, where, axes)
    place, size = part.fileinfo()["datLoc"], path.stat().st_size
    stored = np.dtype(_TYPES[int(header["BITPIX"])])
    if place + math.prod(axes) * stored.itemsize > size:
        found = f"has {size} bytes, fewer than its header states"
        raise refused(path, "must be complete", size, found, where=where, remedy="copy it again")
    shape = _sides(axes)
    name = printable(str(header.get("EXTNAME", "")) or str(number)) if number else ""
    scaling = _scaling(path, where, header)

    def read(i: int | None) -> Callable[[], Array]:
        start = place + (i or 0) * math.prod(shape) * stored.itemsize
        return partial(_scaled, StoredPlane(path, start, stored, shape), **scaling)

    return _stack(path, axes, read, part=name, **_metadata(header, first))


def _scaled(
    plane: StoredPlane, *, zero: float, scale: float, blank: int | None
) -> Integer[Array, "h w"]:
    """The codes ``zero + scale * stored``; pixels that are marked as blank raise an error."""
    name, stored = str(plane.path), plane.values()
    if blank is not None and stored.dtype.kind in "ui" and (stored == blank).any():
        found = f"has pixels marked as blank by BLANK = {blank}"
        raise refused(name, "must have a code in each pixel", blank, found)
    if (zero, scale) == (0.0, 1.0):
        return whole_codes(name, stored)
    half = 2.0 ** (8 * stored.dtype.itemsize - 1)
    if (zero, scale, stored.dtype.kind) == (half, 1.0, "i"):  # unsigned integers
        unsigned = np.dtype(f"u{stored.dtype.itemsize}")
        codes = stored.astype(stored.dtype.newbyteorder("=")).view(unsigned)
        codes ^= unsigned.type(half)
        return codes
    if scale == 1.0 and zero.is_integer() and stored.dtype.kind in "ui":
        wide = stored.astype(np.int64)
        wide += int(zero)
        low, high = int(wide.min()), int(wide.max())
        return wide.astype(np.result_type(np.min_scalar_type(low), np.min_scalar_type(high)))
    return whole_codes(name, zero + scale * stored.astype(np.float64))


def _scaling(path: Path, where: str, header: Any) -> dict[str, Any]:
    zero, scale = number_of_tag(header.get("BZERO", 0)), number_of_tag(header.get("BSCALE", 1))
    if zero is None or scale is None or abs(zero) > _LARGEST_OFFSET or not scale:
        need = "must have finite numbers in BZERO and BSCALE"
        raise refused(path, need, (header.get("BZERO"), header.get("BSCALE")), where=where)
    blank = number_of_tag(header.get("BLANK")) if "BLANK" in header else None
    return {"zero": zero, "scale": scale, "blank": None if blank is None else int(blank)}


def _metadata(header: Any, first: Any) -> dict[str, Any]:
    """Exposure, gain, camera and mosaic of an image; an extension inherits from the first part."""

    def value(*keys: str) -> Any:
        found = (source.get(key) for source in (header, first) for key in keys)
        return next((one for one in found if one is not None), None)

    time_s, iso = (
        number_of_tag(value("EXPTIME", "EXPOSURE")),
        number_of_tag(value("ISOSPEED", "ISO")),
    )
    return {
        "time_ms": None if time_s is None or time_s < 0 else 1000 * time_s,
        "iso": None if iso is None or iso <= 0 else iso,
        "gain_setting": number_of_tag(value("GAIN")),
        "camera": camera_name("", str(value("INSTRUME") or "")),
        "mosaic": _mosaic(header if "BAYERPAT" in header else first, int(header["NAXIS2"])),
    }


def _mosaic(header: Any, rows: int) -> Mosaic | None:
    pattern = str(header.get("BAYERPAT", "")).strip().upper()
    if len(pattern) != 4 or not set(pattern) <= set("RGBCMYW"):
        return None
    x, y = (number_of_tag(header.get(key, 0)) for key in ("XBAYROFF", "YBAYROFF"))
    columns_off, rows_off = int(x or 0) % 2, int(y or 0) % 2
    if str(header.get("ROWORDER", "")).strip().upper() == "BOTTOM-UP":
        rows_off, step = rows - 1 - rows_off, -1
    else:
        step = 1
    return Mosaic(
        tuple(
            tuple(pattern[2 * ((rows_off + step * r) % 2) + (columns_off + c) % 2] for c in (0, 1))
            for r in (0, 1)
        )
    )


CAMERA_RAW = (
    *(".dng", ".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".sr2", ".srf", ".raf", ".orf"),
    *(".rw2", ".rwl", ".pef", ".srw", ".3fr", ".fff", ".iiq", ".mos", ".mrw", ".kdc", ".dcr"),
    *(".erf", ".mef", ".x3f"),
)
"""Endings of the files that LibRaw reads."""
PICTURES = (".jpg", ".jpeg", ".jpe", ".heic", ".heif", ".webp", ".gif", ".bmp", ".avif", ".ppm")
"""Endings of pictures that are never raw frames."""


def frames_in(path: Path | str) -> tuple[RawFrame, ...]:
    """The raw frames of a file: one, or those of a stack.

    The header is read now, the pixels with `RawFrame.codes`. The file is never changed.

    Parameters
    ----------
    path
        Camera raw or DNG (needs rawpy), TIFF with one frame per page, FITS (needs astropy), NPY and
        NPZ with frames of 2 or stacks of 3 dimensions, PGM, or gray PNG; by the ending of its
        name.

    Raises
    ------
    InputError
        If the format is unknown, the file is damaged, or it is a processed picture.

    Examples
    --------
    >>> import tempfile, numpy as np
    >>> folder = tempfile.TemporaryDirectory()
    >>> np.save(folder.name + "/flats.npy", np.full((2, 4, 6), 64, np.uint16))
    >>> [(frame.name, frame.shape) for frame in frames_in(folder.name + "/flats.npy")]
    [('flats.npy[0]', (4, 6)), ('flats.npy[1]', (4, 6))]
    >>> folder.cleanup()
    """
    path = Path(path)
    regular_file(path)
    ending = path.suffix.lower()
    if ending in PICTURES:
        raise refused_picture(path, f"is a picture of the format {ending[1:].upper()}")
    reader = READERS.get(ending)
    if reader is None:
        need = "must be a raw frame (DNG or camera raw, TIFF, FITS, NPY, NPZ, PGM, PNG)"
        found = f"ends in {ending}" if ending else "has no ending"
        raise refused(path, need, ending, found, remedy="save it as TIFF or NPY")
    with system_errors_of(path):
        return reader(path)


def is_frame_name(path: Path) -> bool:
    """Whether a file has the ending of a format of raw frames.

    Examples
    --------
    >>> is_frame_name(Path("a.NEF")), is_frame_name(Path("a.jpg"))
    (True, False)
    """
    return path.suffix.lower() in READERS


READERS: dict[str, Callable[[Path], tuple[RawFrame, ...]]] = {
    **dict.fromkeys(CAMERA_RAW, raw_frames),
    **dict.fromkeys((".tif", ".tiff"), tiff_frames),
    **dict.fromkeys((".fits", ".fit", ".fts"), fits_frames),
    ".npy": npy_frames,
    ".npz": npz_frames,
    ".pgm": pgm_frames,
    ".png": png_frames,
}
"""The reader of each ending."""
