"""Raw frames in TIFF files: one per page."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._inputs import json_of
from chromanoise._shapes import Integer
from chromanoise.errors import InputError
from chromanoise.io.cubes.bounds import refuse_impossible
from chromanoise.io.cubes.errors import reading
from chromanoise.io.cubes.tiff import is_plain, refuse_incomplete
from chromanoise.io.cubes.tiff_pages import decoded_pages
from chromanoise.io.frames.exif import CFA, exposure_of, mosaic_of
from chromanoise.io.frames.frame import RawFrame
from chromanoise.io.frames.stored import (
    MOST_FRAMES,
    StoredPlane,
    refuse_shape,
    refused_picture,
    whole_codes,
)

_BLACK_IS_0, _WHITE_IS_0 = 1, 0

logging.getLogger("tifffile").addHandler(logging.NullHandler())  # errors are raised here


def tiff_frames(path: Path) -> tuple[RawFrame, ...]:
    """The pages of a TIFF; reduced pages (thumbnails) are not used.

    Uncompressed pages are read in place. Exposure time, ISO and camera come from the Exif tags of
    the first page, the mosaic from the tags of TIFF/EP (ISO 12234-2).

    Raises
    ------
    InputError
        If a page has more than one channel, is incomplete, or is larger than its file allows.
    """
    with opened_tiff(path) as file:
        if len(file.pages) > MOST_FRAMES:
            raise InputError(
                str(path),
                f"must hold at most {MOST_FRAMES} pages",
                value=len(file.pages),
                found=f"holds {len(file.pages)}",
            )
        pages = [(i, page.aspage()) for i, page in enumerate(file.pages)]
        pages = [(i, page) for i, page in pages if not page.is_reduced]
        if not pages:
            raise InputError(str(path), "must hold pages", found="holds none")
        _refuse_truncated_stack(path, pages[0][1], len(pages))
        exposure = exposure_of(pages[0][1])
        many = len(pages) > 1
        return tuple(
            _frame(path, at, page, index=k if many else None, exposure=exposure)
            for k, (at, page) in enumerate(pages)
        )


@contextmanager
def opened_tiff(path: Path) -> Iterator[Any]:
    """A file of tifffile, whose errors become an `InputError`."""
    import tifffile

    with reading(path, "TIFF"), tifffile.TiffFile(path) as file:
        yield file


def _frame(
    path: Path, at: int, page: Any, *, index: int | None, exposure: dict[str, Any]
) -> RawFrame:
    where = "" if index is None else f"page {index} (from 0)"
    if page.dtype is None or len(page.shape) < 2:
        raise InputError(str(path), "must hold plain numbers", where=where, found="holds none")
    if len(page.shape) != 2 or page.photometric not in (_BLACK_IS_0, _WHITE_IS_0, CFA):
        kind = getattr(page.photometric, "name", page.photometric)
        sides = " x ".join(str(side) for side in page.shape)
        raise refused_picture(path, f"is a picture of {sides} ({kind})", where)
    if page.photometric == _WHITE_IS_0:
        raise InputError(str(path), "must store black as 0", where=where, found="stores white as 0")
    shape, dtype = (int(page.shape[0]), int(page.shape[1])), np.dtype(page.dtype)
    refuse_shape(path, where, shape)
    refuse_incomplete(path, index or 0, page)
    refuse_impossible(path, where or "page 0", shape, dtype)
    mosaic = mosaic_of(page)
    if page.photometric == CFA and mosaic is None:
        raise InputError(
            str(path),
            "must state its mosaic in the tag CFAPattern",
            where=where,
            remedy="save it as a gray TIFF, and write the mosaic into capture.toml",
        )
    read: Any = _CompressedPage(path=path, page=at, shape=shape, stored=str(dtype))
    if is_plain(page):
        size, first = path.stat().st_size, int(page.dataoffsets[0])
        stored = dtype.newbyteorder(page.parent.byteorder)
        read = StoredPlane(path=path, size=size, offset=first, stored=stored, shape=shape)
    bits = int(page.bitspersample)
    return RawFrame(
        path=path,
        shape=shape,
        read=read,
        index=index,
        mosaic=mosaic,
        bits=bits if dtype.kind == "u" and bits < 16 else None,
        **exposure,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _CompressedPage:
    """Unpacks one page."""

    path: Path
    page: int
    shape: tuple[int, int]
    stored: str

    def __call__(self) -> Integer[Array, "h w"]:
        with opened_tiff(self.path) as file:
            page = file.pages[self.page].aspage()
            if (tuple(page.shape), str(page.dtype)) != (self.shape, self.stored):
                raise InputError(str(self.path), "must not change while it is read")
            refuse_incomplete(self.path, self.page, page)
            codes = decoded_pages(self.path, [page])[0]
        return whole_codes(str(self.path), codes)


def _refuse_truncated_stack(path: Path, first: Any, pages: int) -> None:
    """Refuse a file whose description states more frames than it has pages (ImageJ, tifffile)."""
    declared = 1
    text = str(getattr(first, "description", ""))[:10_000]
    if first.is_imagej:
        words = dict(line.split("=", 1) for line in text.splitlines() if "=" in line)
        images = words.get("images", "1").strip()
        declared = int(images) if images.isdigit() and len(images) < 9 else 1
    elif first.is_shaped:
        try:
            shape = json_of(text, str(path), any_number=True).get("shape", [])
            declared = int(np.prod([int(side) for side in shape[:-2]])) if len(shape) > 2 else 1
        except (ValueError, TypeError, AttributeError, OverflowError):
            declared = 1
    if declared > pages and pages == 1 and len(first.shape) == 2:
        raise InputError(
            str(path),
            "must have one page per frame",
            value=pages,
            found=f"has {pages} page, and its description states {declared} frames",
            remedy="save each frame as a page",
        )
