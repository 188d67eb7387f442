"""Compressed pages of a TIFF file, decoded into memory."""

import lzma
import math
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Shaped

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.io.cubes.bounds import MOST_INFLATED, refuse_impossible
from chromanoise.io.cubes.faults import library, without_chatter
from chromanoise.io.cubes.found import by

_HARMLESS_BYTES = 64 * 2**20
_DEFLATE, _LZMA = (8, 32946), 34925
_MOST_BY_LZMA = 8192  # largest compression ratio of LZMA
_BLACK_IS_0, _UPRIGHT, _ORIENTATION = 1, 1, 274


def decoded_pages(path: Path, pages: list[Any]) -> Shaped[Array, "pages ..."]:
    """The numbers of pages of equal shape and type.

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
    numbers = np.empty(declared, dtype=dtype)
    for i, (plane, page) in enumerate(zip(numbers, pages, strict=True)):
        _refuse_overfull(path, page)
        decoded = _decoded(path, page)
        if decoded.shape != plane.shape:
            raise InputError(
                str(path),
                f"must be {by(plane.shape)}, as it declares",
                where=f"page {i} (from 0)",
                value=decoded.shape,
                found=f"is {by(decoded.shape)}",
                remedy="save it again",
            )
        plane[...] = decoded
    return numbers


def _refuse_overfull(path: Path, page: Any) -> None:
    """Refuse strips that unpack to more than declared: tifffile unpacks them completely."""
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


def _decoded(path: Path, page: Any) -> Shaped[Array, "..."]:
    try:
        return np.asarray(page.asarray())
    except (ImportError, KeyError, ValueError) as error:
        if not isinstance(error, ImportError) and "imagecodecs" not in str(error):
            raise
    decoded = _by_pillow(page, path)
    if decoded is None:
        compression = getattr(page.compression, "name", page.compression)
        where = f"pages ({compression}, {page.dtype})"
        library("imagecodecs", str(path), extra="tiff", where=where)
        raise InputError(
            str(path),
            "cannot be decoded",
            where=where,
            remedy="save it uncompressed or with deflate",
        )
    return decoded


def _by_pillow(page: Any, path: Path) -> Shaped[Array, "h w"] | None:
    """The numbers of a grayscale page; None if Pillow would change or cannot decode them."""
    from PIL.TiffImagePlugin import TiffImageFile

    turned = page.tags.get(_ORIENTATION)
    upright = turned is None or turned.value == _UPRIGHT
    if len(page.shape) != 2 or page.photometric != _BLACK_IS_0 or not upright:
        return None
    with without_chatter():
        try:
            image = TiffImageFile(path)
            image.seek(page.index)
        except (SyntaxError, KeyError, ValueError):  # a kind that Pillow does not support
            return None
        with image:
            numbers = np.asarray(image)
    same = numbers.dtype.newbyteorder("=") == np.dtype(page.dtype).newbyteorder("=")
    return numbers if same else None
