"""Raw frames of a camera: stored codes, sets of light levels with their darks, and checks.

Planes of codes are read in place. The frames of a set must have one camera, size, gain and mosaic.
"""

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import field, replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from chromanoise.base import Array, InputError, Integer, Shaped, dataclass, system_errors_of
from chromanoise.io.source_files import by, has, refused
from chromanoise.sensor import Mosaic

MOST_PIXELS = 400_000_000
"""Most pixels of one frame."""
MOST_FRAMES = 20_000
"""Most frames of one file."""
_BLOCK_PIXELS = 4_000_000
_LARGEST = 2**31 - 1


@dataclass(frozen=True)
class StoredPlane:
    """Reads an uncompressed frame from its place in a file.

    Attributes
    ----------
    offset
        Where the first code is. [bytes]
    stored
        Type of a code, with its byte order.
    shape
        Rows and columns. [px]
    by_columns
        Whether the columns are stored one after another.
    size
        Size of the file when its header was read. [bytes]
    """

    path: Path
    offset: int
    stored: np.dtype
    shape: tuple[int, int]
    by_columns: bool = False
    size: int = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", self.path.stat().st_size)

    def __call__(self) -> Integer[Array, "h w"]:
        """The codes. [DN]

        Raises
        ------
        InputError
            If the file cannot be read, has another size, or holds fractions.
        """
        return whole_codes(str(self.path), self.values())

    @property
    def has_rows(self) -> bool:
        """Whether the rows are stored one after another, as integers."""
        return not self.by_columns and self.stored.kind in "ui"

    def blocks(self, rows: int) -> Iterator[Integer[Array, "rows w"]]:
        """The codes of ``rows`` rows at a time, in memory that is used again for the next. [DN]

        Raises
        ------
        InputError
            As the call.
        """
        assert self.has_rows
        memory = np.empty((min(rows, self.shape[0]), self.shape[1]), self.stored)
        native = self.stored.newbyteorder("=")
        with self._opened() as file:
            for start in range(0, self.shape[0], rows):
                block = memory[: self.shape[0] - start]
                if file.readinto(block) != block.nbytes:  # type: ignore[attr-defined]
                    raise self._of_other_size(self.path.stat().st_size)
                yield block.astype(native, copy=False)

    def values(self) -> Shaped[Array, "h w"]:
        """The numbers in the file, before they are checked.

        Raises
        ------
        InputError
            If the file cannot be read or has another size.
        """
        with self._opened() as file:
            count = math.prod(self.shape)
            values: Any = np.fromfile(file, self.stored, count)
        if values.size != count:
            raise self._of_other_size(self.path.stat().st_size)
        return values.reshape(self.shape[::-1]).T if self.by_columns else values.reshape(self.shape)

    @contextmanager
    def _opened(self) -> Iterator[BinaryIO]:
        """The file at the first code."""
        with system_errors_of(self.path), self.path.open("rb", buffering=0) as file:
            size = os.fstat(file.fileno()).st_size
            if size != self.size:
                raise self._of_other_size(size)
            file.seek(self.offset)
            yield file

    def _of_other_size(self, size: int) -> InputError:
        return has(self.path, f"must have {self.size} bytes, as when its header was read", size)


def refuse_shape(path: Path, where: str, shape: tuple[int, ...]) -> None:
    """Refuse a frame or stack that is empty, too large, or not of one channel.

    Parameters
    ----------
    path, where
        The file and the array in it.
    shape
        Rows and columns, or frames, rows and columns.

    Raises
    ------
    InputError
        If there are other dimensions, a side is 0, or there are too many pixels or frames.
    """
    if len(shape) not in (2, 3):
        need = "must hold frames of rows and columns, or a stack of them"
        found = f"has {len(shape)} dimensions" if len(shape) != 1 else "is a list"
        raise refused(path, need, shape, found, where=where)
    if min(shape) < 1:
        raise has(path, "must not be empty", shape, "is", where=where)
    if math.prod(shape[-2:]) > MOST_PIXELS:
        need = f"must have at most {MOST_PIXELS // 10**6} million pixels a frame"
        raise refused(path, need, shape, f"is declared as {by(shape)}", where=where)
    if len(shape) == 3 and shape[0] > MOST_FRAMES:
        raise has(path, f"must hold at most {MOST_FRAMES} frames", shape[0], "holds", where=where)
    if len(shape) == 3 and shape[2] in (3, 4):
        raise refused_picture(path, f"is a color picture of {by(shape)}", where)


def refused_picture(path: Path, found: str, where: str = "") -> InputError:
    """The error for a picture of several channels, or of a lossy format."""
    need = "must be a raw frame of one channel"
    remedy = "use the frames before they are demosaicked or compressed, e.g. as DNG, TIFF or NPY"
    return refused(path, need, found=found, where=where, remedy=remedy)


def whole_codes(name: str, values: Shaped[Array, "h w"]) -> Integer[Array, "h w"]:
    """Integers of the byte order of this machine; floats without fractions become integers.

    Parameters
    ----------
    name
        The file, for the error.
    values
        Integers are returned as they are. Floats become uint16, or int32 if they do not fit.

    Raises
    ------
    InputError
        If a value is not a whole number of 32 bits, or the values are not numbers.

    Examples
    --------
    >>> whole_codes("a.npy", np.array([[64.0, 1023.0]]))
    array([[  64, 1023]], dtype=uint16)
    """
    if values.dtype.kind in "ui":
        return values.astype(values.dtype.newbyteorder("="), copy=False)
    if values.dtype.kind != "f":
        kind = "objects" if values.dtype.hasobject else values.dtype.name
        raise has(name, "must hold integer codes", kind, "holds")
    rows = max(1, _BLOCK_PIXELS // values.shape[1])
    low = high = 0.0
    for start in range(0, values.shape[0], rows):
        block = values[start : start + rows]
        with np.errstate(invalid="ignore"):
            bad = ~(np.isfinite(block) & (np.rint(block) == block) & (np.abs(block) <= _LARGEST))
        if bad.any():
            row, column = (int(i) for i in np.argwhere(bad)[0])
            first = float(block[row, column])
            need = "must hold whole codes, because processed frames are not raw"
            found = f"holds {first:g} in row {start + row}, column {column} (from 0)"
            remedy = "use the frames as the camera delivers them"
            raise refused(name, need, first, found, remedy=remedy)
        low, high = min(low, float(block.min())), max(high, float(block.max()))
    return values.astype(np.uint16 if low >= 0 and high <= 65535 else np.int32)


@dataclass(frozen=True, kw_only=True, eq=False)
class RawFrame:
    """One raw frame of a file; its codes are read when they are needed.

    Attributes
    ----------
    shape
        Rows and columns. [px]
    read
        Reads the codes: an array of integers, ``shape``. [DN]
    index
        Number of the frame in a stack, from 0; ``None`` for a file with one frame.
    part
        Name of the array or FITS extension that holds it, if the file has several.
    time_ms
        Exposure time, if the file states it. [ms]
    iso
        ISO setting, if the file states it.
    gain_setting
        Gain setting in the camera's own units (``GAIN`` of FITS), if the file states it.
    camera
        Maker and model, or empty.
    mosaic
        The channel of each pixel, if the file states it.
    bits
        Bits of the codes, if the file states them.
    black_level_dn, white_level_dn
        Code without light and largest code, if the file states them. [DN]
    noise_profile
        S and O of each channel, if the file states them: variance = S x + O, with x = 0 at black
        and 1 at the white level (``chromanoise.sensor``). [1]
    """

    path: Path
    shape: tuple[int, int]
    read: Callable[[], Integer[Array, "h w"]]
    index: int | None = None
    part: str = ""
    time_ms: float | None = None
    iso: float | None = None
    gain_setting: float | None = None
    camera: str = ""
    mosaic: Mosaic | None = None
    bits: int | None = None
    black_level_dn: float | None = None
    white_level_dn: float | None = None
    noise_profile: Mapping[str, tuple[float, float]] | None = None

    @property
    def place(self) -> tuple[Path, str, int | None]:
        """File, part and number of the frame, which are those of no other frame."""
        return self.path, self.part, self.index

    @property
    def name(self) -> str:
        """The file's name, with the part and number of the frame: ``flats.tif[2]``."""
        parts = ([self.part] if self.part else []) + ([] if self.index is None else [self.index])
        return self.path.name + "".join(f"[{part}]" for part in parts)

    def codes(self) -> Integer[Array, "h w"]:
        """The codes. [DN]

        Raises
        ------
        InputError
            If the file cannot be read, has changed in size, or holds no integers.
        """
        codes: Any = np.asarray(self.read())
        if codes.shape != self.shape:
            need = f"must have {self.shape[0]} rows and {self.shape[1]} columns"
            raise refused(self.name, need, codes.shape, f"has shape {codes.shape}")
        if codes.dtype.kind not in "ui":
            raise refused(self.name, "must hold integer codes", str(codes.dtype), f"{codes.dtype}")
        return np.asarray(codes)

    @property
    def has_rows(self) -> bool:
        """Whether `blocks` reads rows only as they are needed, from a file without compression."""
        return isinstance(self.read, StoredPlane) and self.read.has_rows

    def blocks(self, rows: int) -> Iterator[Integer[Array, "rows w"]]:
        """The codes of ``rows`` rows at a time; a block is valid until the next one. [DN]

        Parameters
        ----------
        rows
            Rows of a block; the last one may have fewer. [px]

        Raises
        ------
        InputError
            As `codes`.
        """
        if isinstance(self.read, StoredPlane) and self.read.has_rows:
            yield from self.read.blocks(rows)
            return
        codes = self.codes()
        yield from (codes[i : i + rows] for i in range(0, self.shape[0], rows))


@dataclass(frozen=True, kw_only=True)
class FrameLevel:
    """Frames of one scene, exposure and light.

    Attributes
    ----------
    name
        For messages: ``level 3``, or the common part of the file names.
    flats
        Frames of a uniform light; empty where only darks were taken.
    darks
        Frames without light, of the same exposure time; empty if there are none.
    time_ms
        Exposure time. [ms]
    photons_per_pixel
        Mean number of photons on a pixel during the exposure. [1]
    spatial
        Whether the frames are used for fixed patterns only: they are not a level of the photon
        transfer, and their light may have another calibration.
    """

    name: str
    flats: tuple[RawFrame, ...]
    darks: tuple[RawFrame, ...] = ()
    time_ms: float | None = None
    photons_per_pixel: float | None = None
    spatial: bool = False

    @property
    def frames(self) -> tuple[RawFrame, ...]:
        """Flats and darks."""
        return (*self.flats, *self.darks)

    def stating(self, **facts: Any) -> "FrameLevel":
        """The level whose frames have other values.

        Parameters
        ----------
        facts
            By the names of fields of `RawFrame`.
        """
        flats, darks = (
            tuple(replace(one, **facts) for one in group) for group in (self.flats, self.darks)
        )
        return replace(self, flats=flats, darks=darks)


@dataclass(frozen=True, kw_only=True)
class FrameSet:
    """All frames of a photon transfer measurement.

    Attributes
    ----------
    source
        Folder or file they come from.
    mosaic
        The channel of each pixel; ``None`` for a monochrome sensor.
    notes
        How the frames were grouped, and what was left out.
    """

    source: str
    levels: tuple[FrameLevel, ...]
    mosaic: Mosaic | None = None
    notes: tuple[str, ...] = ()

    @property
    def black_level_dn(self) -> float | None:
        """Code without light, if all frames with light state the same one. [DN]"""
        stated = {frame.black_level_dn for level in self.levels for frame in level.flats}
        return stated.pop() if len(stated) == 1 else None


MOST_LEVELS = 10_000
"""Most levels of one set."""
EXAMPLE = (
    "write capture.toml beside the frames, with these lines for each level: [[levels]] / "
    'flats = ["flat_01_*.tif"] / darks = ["dark_01_*.tif"] / time_ms = 10'
)
"""Remedy where the grouping of frames is unclear."""

_QUANTITIES: tuple[tuple[str, Callable[[RawFrame], Any], Callable[[Any], str]], ...] = (
    ("size", lambda frame: frame.shape, lambda shape: f"{by(shape)} pixels"),
    ("camera", lambda frame: frame.camera or None, str),
    ("ISO", lambda frame: frame.iso, lambda iso: f"ISO {iso:g}"),
    ("gain", lambda frame: frame.gain_setting, lambda gain: f"gain {gain:g}"),
    ("number of bits", lambda frame: frame.bits, lambda bits: f"{bits} bits"),
)


def refuse_mixed(source: str, frames: Sequence[RawFrame]) -> None:
    """Refuse frames of several sizes, cameras, ISO or gain settings, or numbers of bits.

    A frame whose file does not state the quantity agrees with all others.

    Raises
    ------
    InputError
        It names the first frame and the first that differs from it.
    """
    for name, quantity, shown in _QUANTITIES:
        known = [frame for frame in frames if quantity(frame) is not None]
        _refuse_unequal(source, known, name, quantity, shown)


def mosaic_of_all(source: str, frames: Sequence[RawFrame]) -> Mosaic | None:
    """The mosaic of frames that agree in it; ``None`` if no file states one.

    Raises
    ------
    InputError
        If two frames differ; a frame without a mosaic differs from one with it.
    """
    _refuse_unequal(source, frames, "mosaic", lambda frame: frame.mosaic, mosaic_text)
    return frames[0].mosaic if frames else None


def mosaic_text(mosaic: Mosaic | None) -> str:
    """``RG/GB``, or ``no mosaic``."""
    if mosaic is None:
        return "no mosaic"
    sign = "" if all(len(name) == 1 for name in mosaic.names) else " "
    return "/".join(sign.join(row) for row in mosaic.pattern)


def refuse_few(
    source: str, levels: Iterable[FrameLevel], kinds: Sequence[str] = ("flats",)
) -> None:
    """Refuse a level with one flat, or dark, which gives no temporal variance.

    Parameters
    ----------
    source
        Of the frames, for the message.

    Raises
    ------
    InputError
        It names the level and the frame.
    """
    for level in levels:
        for kind in kinds:
            group = getattr(level, kind)
            if len(group) == 1:
                need = f"must have at least 2 {kind}, because one gives no temporal variance"
                found = f"has 1, {group[0].name}"
                remedy = ("take another", "leave the level out", EXAMPLE)
                raise refused(source, need, 1, found, where=f"level {level.name!r}", remedy=remedy)


def _refuse_unequal(
    source: str,
    frames: Sequence[RawFrame],
    name: str,
    quantity: Callable[[RawFrame], Any],
    shown: Callable[[Any], str],
) -> None:
    for other in frames[1:]:
        values = quantity(frames[0]), quantity(other)
        if values[0] != values[1]:
            names = shown_name(frames[0]), shown_name(other)
            found = " and ".join(f"{n} has {shown(v)}" for n, v in zip(names, values, strict=True))
            remedy = "evaluate them separately"
            raise refused(source, f"must have one {name}", values, found, remedy=remedy)


def shown_name(frame: RawFrame) -> str:
    """Folder and name of a frame, for messages."""
    return f"{frame.path.parent.name}/{frame.name}"
