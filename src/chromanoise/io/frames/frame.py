"""Raw frames of a camera, and how they belong together: levels of light, each with its darks."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Integer
from chromanoise.errors import InputError
from chromanoise.io.frames.stored import StoredPlane
from chromanoise.sensor import Mosaic


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawFrame:
    """One raw frame of a file; its codes are read when they are needed.

    Attributes
    ----------
    path
        The file.
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
        and 1 at the white level (`chromanoise.sensor.noise_profile`). [1]
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
            raise InputError(
                self.name,
                f"must have {self.shape[0]} rows and {self.shape[1]} columns",
                value=codes.shape,
                found=f"has shape {codes.shape}",
            )
        if codes.dtype.kind not in "ui":
            raise InputError(
                self.name, "must hold integer codes", value=str(codes.dtype), found=f"{codes.dtype}"
            )
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


@dataclass(frozen=True, slots=True, kw_only=True)
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


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameSet:
    """All frames of a photon transfer measurement.

    Attributes
    ----------
    source
        Folder or file they come from.
    levels
        In any order.
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
