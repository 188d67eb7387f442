"""Raw pictures of other cameras: frames from files or arrays, or electrons."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._inputs import true_path
from chromanoise._shapes import Float32
from chromanoise.catalog.resolve import file_of
from chromanoise.errors import InputError, Setting
from chromanoise.io.frames import RawFrame, frames_in
from chromanoise.io.frames.consistency import mosaic_of_all, refuse_mixed
from chromanoise.io.frames.dump import DUMP_ENDINGS, DUMP_TYPES, dumped_frame


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Electrons:
    """A raw picture in electrons above black.

    Attributes
    ----------
    values_e
        One value per pixel. [e-]
    name
        For messages.
    """

    values_e: Float32[Array, "h w"]
    name: str = "picture"


def frames_of_pictures(
    pictures: Sequence[str | Path],
    *,
    shape: tuple[int, int] | None = None,
    stored: str | None = None,
) -> tuple[RawFrame, ...]:
    """The frames of raw files; several are a burst of one scene.

    Parameters
    ----------
    pictures
        Files for `frames_in`, or raw dumps (.raw, .bin).
    shape
        Rows and columns of a raw dump. [px]
    stored
        Type of the codes of a raw dump, a name of `DUMP_TYPES`; uint16 if ``None``.

    Raises
    ------
    InputError
        If a file cannot be read, the size of a dump is not given, or the frames differ in size,
        camera, ISO or mosaic.
    """
    paths = [file_of(str(one)) for one in pictures]
    if not paths:
        raise InputError("pictures", "must name at least one file", value=0, found="none is given")
    seen: dict[Path, Path] = {}
    twice = next((one for one in paths if seen.setdefault(true_path(one), one) is not one), None)
    if twice is not None:
        raise InputError(
            str(twice),
            "must be named once, because the frames of a burst have independent noise",
            value=str(twice),
            found="is named twice",
        )
    dumps = [path for path in paths if path.suffix.lower() in DUMP_ENDINGS]
    if not dumps:
        for name, value in (("shape", shape), ("stored", stored)):
            if value is not None:
                raise InputError(
                    name, "must be given only for a raw dump", value=value, remedy="omit it"
                )
    frames: list[RawFrame] = []
    for path in paths:
        if path not in dumps:
            frames += frames_in(path)
            continue
        if shape is None:
            raise InputError(
                str(path),
                "must have its rows and columns given, because it has no header",
                remedy=Setting("shape"),
            )
        stored = _check.one_of("stored", stored or "uint16", tuple(DUMP_TYPES))
        frames.append(dumped_frame(path, shape, stored))
    refuse_mixed(frames[0].name, frames)
    mosaic_of_all(frames[0].name, frames)
    return tuple(frames)


def frame_of_array(codes: Array, *, name: str = "picture") -> RawFrame:
    """A frame of codes in memory. [DN]

    Parameters
    ----------
    codes
        Codes of each pixel. [DN]
    name
        Name for messages and results.

    Raises
    ------
    InputError
        If it does not have rows and columns of integers.
    """
    values = _rows_and_columns(codes, name)
    if values.dtype.kind not in "ui":
        raise InputError(
            name,
            "must hold integer codes",
            value=str(values.dtype),
            remedy=("round them", "give electrons above black, unit='e-'"),
        )
    return RawFrame(path=Path(name), shape=(values.shape[0], values.shape[1]), read=lambda: values)


def electrons_of_array(values_e: Array, *, name: str = "picture") -> Electrons:
    """A picture of electrons above black. [e-]

    Parameters
    ----------
    values_e
        Electrons of each pixel. [e-]
    name
        Name for messages and results.

    Raises
    ------
    InputError
        If it does not have rows and columns of finite numbers.
    """
    values = _check.finite(name, "e-", _rows_and_columns(values_e, name))
    return Electrons(values_e=values.astype(np.float32), name=name)


def _rows_and_columns(values: Array, name: str) -> Array:
    if np.ma.is_masked(values):
        raise InputError(
            name,
            "must not be masked",
            value=values.shape,
            found="has masked pixels",
            remedy="give its data, with the bad pixels replaced",
        )
    array = np.asarray(values)
    if array.ndim != 2 or not array.size or array.dtype.kind not in "uif":
        raise InputError(
            name,
            "must be an array of rows and columns with one number per pixel",
            value=array.shape,
            found=f"has shape {array.shape} of {array.dtype}",
        )
    return array
