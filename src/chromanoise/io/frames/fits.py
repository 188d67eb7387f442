"""Raw frames in FITS files; astropy reads the headers, the codes are read in place."""

import importlib
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array, printable
from chromanoise._shapes import Integer
from chromanoise.errors import InputError
from chromanoise.io.cubes.errors import library, reading
from chromanoise.io.frames.exif import camera_name, number_of_tag
from chromanoise.io.frames.frame import RawFrame
from chromanoise.io.frames.stored import StoredPlane, refuse_shape, whole_codes
from chromanoise.sensor import Mosaic

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
    library("astropy", str(path), extra="fits")
    fits = importlib.import_module("astropy.io.fits")
    frames: list[RawFrame] = []
    with reading(path, "FITS"), path.open("rb") as file:
        if file.read(10) != b"SIMPLE  = ":
            raise ValueError("no SIMPLE at its start")
        file.seek(0)
        parts = fits.open(file, mode="readonly", memmap=False)
        first = parts[0].header
        for number, part in enumerate(parts):
            if number >= _MOST_PARTS:
                raise InputError(str(path), f"must have at most {_MOST_PARTS} parts")
            if type(part).__name__ == "CompImageHDU" or part.header.get("ZIMAGE") is True:
                raise InputError(
                    str(path),
                    "must not be compressed",
                    where=f"part {number}",
                    remedy="unpack it with funpack",
                )
            if part.is_image and part.header.get("NAXIS", 0):
                frames += _of_part(path, number, part, first)
    if not frames:
        raise InputError(str(path), "must hold an image", found="holds none")
    if len({(frame.part, frame.index) for frame in frames}) < len(frames):
        raise InputError(str(path), "must name each extension once")
    return tuple(frames)


def _of_part(path: Path, number: int, part: Any, first: Any) -> list[RawFrame]:
    header, where = part.header, f"part {number}"
    axes = tuple(int(header[f"NAXIS{i}"]) for i in range(int(header["NAXIS"]), 0, -1))
    refuse_shape(path, where, axes)
    place, size = part.fileinfo()["datLoc"], path.stat().st_size
    stored = np.dtype(_TYPES[int(header["BITPIX"])])
    if place + math.prod(axes) * stored.itemsize > size:
        raise InputError(
            str(path),
            "must be complete",
            where=where,
            value=size,
            found=f"has {size} bytes, fewer than its header states",
            remedy="copy it again",
        )
    shape = (axes[-2], axes[-1])
    name = printable(str(header.get("EXTNAME", "")) or str(number)) if number else ""
    metadata = _metadata(header, first)
    frames = []
    for i in range(axes[0]) if len(axes) == 3 else (None,):
        plane = StoredPlane(
            path=path,
            size=size,
            offset=place + (i or 0) * math.prod(shape) * stored.itemsize,
            stored=stored,
            shape=shape,
        )
        read = _Scaled(plane=plane, **_scaling(path, where, header))
        frames.append(RawFrame(path=path, shape=shape, read=read, index=i, part=name, **metadata))
    return frames


@dataclass(frozen=True, slots=True, kw_only=True)
class _Scaled:
    """Reads the codes ``zero + scale * stored``; refuses pixels that are marked as blank."""

    plane: StoredPlane
    zero: float
    scale: float
    blank: int | None

    def __call__(self) -> Integer[Array, "h w"]:
        name, stored = str(self.plane.path), self.plane.values()
        if self.blank is not None and stored.dtype.kind in "ui" and (stored == self.blank).any():
            raise InputError(
                name,
                "must have a code in each pixel",
                value=self.blank,
                found=f"has pixels marked as blank by BLANK = {self.blank}",
            )
        if (self.zero, self.scale) == (0.0, 1.0):
            return whole_codes(name, stored)
        half = 2.0 ** (8 * stored.dtype.itemsize - 1)
        if (self.zero, self.scale, stored.dtype.kind) == (half, 1.0, "i"):  # unsigned integers
            unsigned = np.dtype(f"u{stored.dtype.itemsize}")
            codes = stored.astype(stored.dtype.newbyteorder("=")).view(unsigned)
            codes ^= unsigned.type(half)
            return codes
        if self.scale == 1.0 and self.zero.is_integer() and stored.dtype.kind in "ui":
            wide = stored.astype(np.int64)
            wide += int(self.zero)
            low, high = int(wide.min()), int(wide.max())
            return wide.astype(np.result_type(np.min_scalar_type(low), np.min_scalar_type(high)))
        return whole_codes(name, self.zero + self.scale * stored.astype(np.float64))


def _scaling(path: Path, where: str, header: Any) -> dict[str, Any]:
    zero, scale = number_of_tag(header.get("BZERO", 0)), number_of_tag(header.get("BSCALE", 1))
    if zero is None or scale is None or abs(zero) > _LARGEST_OFFSET or not scale:
        raise InputError(
            str(path),
            "must have finite numbers in BZERO and BSCALE",
            where=where,
            value=(header.get("BZERO"), header.get("BSCALE")),
        )
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
