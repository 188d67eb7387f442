"""Compressed pages of a TIFF file, decoded into memory."""

import lzma
import math
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise import _sandbox
from chromanoise._check import Array
from chromanoise._shapes import Shaped
from chromanoise.errors import InputError
from chromanoise.io.cubes.bounds import MOST_INFLATED, refuse_impossible, refuse_other_size
from chromanoise.io.cubes.errors import library

_LIMIT_S = 60.0
_SLOWEST_BYTES_PER_S = 1e7
_HARMLESS_BYTES = 64 * 2**20
_DEFLATE, _LZMA = (8, 32946), 34925
_MOST_BY_LZMA = 8192  # largest compression ratio of LZMA
_BLACK_IS_0, _UPRIGHT, _ORIENTATION = 1, 1, 274


def decoded_pages(path: Path, pages: list[Any]) -> Shaped[Array, "pages ..."]:
    """The numbers of pages with the same shape and type.

    Raises
    ------
    InputError
        If they need more memory than is available or than the file can hold, a page is damaged, or
        its compression needs the package imagecodecs, which is not installed.
    """
    first = pages[0]
    dtype = np.dtype(first.dtype)
    declared = (len(pages), *(int(n) for n in first.shape))
    packed = sum(sum(page.databytecounts) for page in pages)
    size = min(packed, path.stat().st_size)  # pages may share their bytes
    refuse_impossible(path, "all pages", declared, dtype, size=size)
    for page in pages:
        _refuse_overfull(path, page)
    numbers = np.empty(declared, dtype=dtype)
    for k, page in enumerate(pages):
        decoded = _by_tifffile(page)
        if decoded is None:
            numbers[k:] = _by_pillow(path, pages[k:])
            break
        refuse_other_size(path, f"page {k} (from 0)", decoded.shape, declared[1:])
        numbers[k] = decoded
    return numbers


def _refuse_overfull(path: Path, page: Any) -> None:
    """Raise an error for strips that inflate to more than declared; tifffile has no limit."""
    most: int
    unpacker: Any
    if page.compression in _DEFLATE:
        most, unpacker = MOST_INFLATED, zlib.decompressobj
    elif page.compression == _LZMA:
        most, unpacker = _MOST_BY_LZMA, lzma.LZMADecompressor
    else:
        return
    whole = math.prod(page.chunks) * np.dtype(page.dtype).itemsize
    with path.open("rb") as file:
        for at, count in zip(page.dataoffsets, page.databytecounts, strict=True):
            if count * most <= whole + _HARMLESS_BYTES:
                continue
            file.seek(at)
            if len(unpacker().decompress(file.read(count), whole + 1)) > whole:
                raise InputError(
                    str(path),
                    f"must unpack to at most {whole} bytes",
                    where=f"strip at byte {at}",
                    found="unpacks to more",
                    remedy="save it again, because the file is damaged",
                )


def _by_tifffile(page: Any) -> Shaped[Array, "..."] | None:
    """The numbers of a page; None if its compression needs the package imagecodecs."""
    try:
        return np.asarray(page.asarray())
    except (ImportError, KeyError, ValueError) as error:
        if not isinstance(error, ImportError) and "imagecodecs" not in str(error):
            raise
        return None


def _by_pillow(path: Path, pages: list[Any]) -> Shaped[Array, "pages h w"]:
    """The numbers of grayscale pages; an error if Pillow would change or cannot decode them."""
    first, dtype = pages[0], np.dtype(pages[0].dtype).newbyteorder("=")
    size = len(pages) * math.prod(first.shape) * dtype.itemsize
    numbers = None
    if all(_is_as_pillow_has_it(page) for page in pages):
        numbers = _sandbox.sandboxed(
            _read_by_pillow,
            path,
            [page.index for page in pages],
            first.shape,
            dtype,
            path=path,
            limit_s=_LIMIT_S + size / _SLOWEST_BYTES_PER_S,
            memory_bytes=_sandbox.MEMORY_BYTES + 3 * size,
        )
    if numbers is None:
        compression = getattr(first.compression, "name", first.compression)
        where = f"pages ({compression}, {first.dtype})"
        library("imagecodecs", str(path), extra="tiff", where=where)
        raise InputError(
            str(path),
            "cannot be decoded",
            where=where,
            remedy="save it uncompressed or with deflate",
        )
    return numbers


def _is_as_pillow_has_it(page: Any) -> bool:
    turned = page.tags.get(_ORIENTATION)
    upright = turned is None or turned.value == _UPRIGHT
    return bool(len(page.shape) == 2 and page.photometric == _BLACK_IS_0 and upright)


def _read_by_pillow(
    path: Path, indices: list[int], shape: tuple[int, int], dtype: np.dtype
) -> Shaped[Array, "pages h w"] | None:
    """Run in the child process, because libtiff parses the file and writes to stderr."""
    from PIL.TiffImagePlugin import TiffImageFile

    numbers = np.empty((len(indices), *shape), dtype=dtype)
    try:
        image = TiffImageFile(path)
    except (SyntaxError, KeyError, ValueError):  # a kind that Pillow does not support
        return None
    with image:
        for plane, index in zip(numbers, indices, strict=True):
            try:
                image.seek(index)
            except (SyntaxError, KeyError, ValueError):
                return None
            decoded = np.asarray(image)
            if decoded.shape != plane.shape:
                raise ValueError("a page does not have its declared size")
            if decoded.dtype != plane.dtype:
                return None
            plane[...] = decoded
    return numbers
