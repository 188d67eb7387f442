"""Raw frames in PGM files, and in PNG files of one channel."""

import math
import re
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Integer
from chromanoise.errors import InputError
from chromanoise.io.cubes.bounds import refuse_impossible
from chromanoise.io.cubes.errors import reading, reading_rows
from chromanoise.io.frames.frame import RawFrame
from chromanoise.io.frames.stored import StoredPlane, refuse_shape, refused_picture

_PGM = re.compile(rb"P([25])(?:\s|#[^\n]*\n)+" + rb"(?:\s|#[^\n]*\n)+".join([rb"(\d{1,9})"] * 3))
_HEADER_BYTES = 65536
_BLOCK_BYTES = 2**20
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
        raise InputError(str(path), f"must have a largest code of 1 to {_MOST_CODE}", value=largest)
    plain = match[1] == b"2"
    stored = np.dtype("u1" if largest < 256 else ">u2")
    least = height * width * (1 if plain else stored.itemsize)
    if (plain and offset + 2 * least - 1 > size) or (not plain and offset + least != size):
        raise InputError(
            str(path),
            f"must have {'at least ' if plain else ''}{least} "
            f"{'codes' if plain else 'bytes'} after its header",
            value=size - offset,
            found=f"has {size - offset} bytes",
            remedy="save it again, one frame per file, because it is truncated or damaged",
        )
    plane = StoredPlane(path=path, size=size, offset=offset, stored=stored, shape=shape)
    bits = largest.bit_length() if largest < _MOST_CODE and (largest + 1).bit_count() == 1 else None
    return (
        RawFrame(
            path=path,
            shape=shape,
            read=_Pgm(plane=plane, plain=plain, largest=largest),
            bits=bits,
            white_level_dn=float(largest) if largest < _MOST_CODE else None,
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Pgm:
    """Reads the codes and compares them with the largest one of the header."""

    plane: StoredPlane
    plain: bool
    largest: int

    def __call__(self) -> Integer[Array, "h w"]:
        codes = _plain_codes(self.plane) if self.plain else self.plane()
        if codes.max() > self.largest:
            raise InputError(
                str(self.plane.path),
                f"must have codes up to {self.largest}, as stated in its header",
                value=int(codes.max()),
                found=f"has {int(codes.max())}",
            )
        return codes


def _plain_codes(plane: StoredPlane) -> Integer[Array, "h w"]:
    """Decimal numbers between blanks."""
    path, count = plane.path, math.prod(plane.shape)
    codes = np.empty(count, np.uint16)
    done, rest = 0, b""
    with reading_rows(path, "PGM"), path.open("rb") as file:
        file.seek(plane.offset)
        while block := file.read(_BLOCK_BYTES):
            words = (rest + block).split()
            rest = b"" if block[-1:].isspace() or not words else words.pop()
            done = _put(path, codes, done, words)
        done = _put(path, codes, done, rest.split())
    if done != count:
        raise InputError(str(path), f"must have {count} codes", value=done, found=f"has {done}")
    return codes.reshape(plane.shape)


def _put(path: Path, codes: Array, done: int, words: list[bytes]) -> int:
    """Store the numbers after those that are done; return how many are done now."""
    bad = next((word for word in words if not word.isdigit() or len(word) > 5), None)
    numbers = [] if bad is not None else [int(word) for word in words]
    if bad is not None or done + len(numbers) > codes.size or max(numbers, default=0) > _MOST_CODE:
        shown = "" if bad is None else bad[:20].decode("ascii", "replace")
        raise InputError(
            str(path),
            f"must have {codes.size} codes of at most {_MOST_CODE} after its header",
            found=f"has {shown!r}" if shown else "has more or larger ones",
        )
    codes[done : done + len(numbers)] = numbers
    return done + len(numbers)


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
    read = _Png(path=path, shape=(height, width), bits=bits)
    return (RawFrame(path=path, shape=(height, width), read=read, bits=8 if bits == 8 else None),)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Png:
    """Unpacks the codes with Pillow."""

    path: Path
    shape: tuple[int, int]
    bits: int

    def __call__(self) -> Integer[Array, "h w"]:
        from PIL import PngImagePlugin

        with reading(self.path, "PNG"), PngImagePlugin.PngImageFile(self.path) as image:
            if image.size != self.shape[::-1]:
                raise InputError(str(self.path), "must not change while it is read")
            codes: Any = np.asarray(image)
        if codes.shape != self.shape or codes.dtype.kind not in "ui":
            raise refused_picture(self.path, f"is a PNG of {codes.dtype}")
        return codes.astype(np.uint8 if self.bits == 8 else np.uint16)
