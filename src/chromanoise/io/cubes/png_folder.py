"""A folder of one PNG per band, as in the CAVE database."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float, Shaped
from chromanoise.errors import InputError
from chromanoise.io.cubes.bounds import refuse_impossible
from chromanoise.io.cubes.errors import reading
from chromanoise.io.cubes.raw_cube import Found, Notes, refuse_other_shape

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
        raise InputError(
            str(path),
            f"must hold at most {_MOST_BANDS} PNGs",
            value=len(files),
            found=f"holds {len(files)}",
        )
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
            raise InputError(
                str(file),
                "must have a number in its name, which gives its place among the bands",
                value=file.stem,
                found="has none",
                remedy=("number the files", "move this one away"),
            )
        number = int(found[1])
        if number in by_number:
            raise InputError(
                str(path),
                "must have one PNG per number",
                value=number,
                found=f"{by_number[number].name} and {file.name} have the same number",
                remedy="move one away",
            )
        by_number[number] = file
    numbers = sorted(by_number)
    _refuse_gaps(path, numbers)
    return numbers, [by_number[number] for number in numbers]


def _refuse_gaps(path: Path, numbers: list[int]) -> None:
    steps = np.diff(numbers)
    if not (steps == steps[0]).all() or (steps[0] > 1 and not _are_wavelengths(numbers)):
        i = int(np.argmax(steps > steps.min()))
        raise InputError(
            str(path),
            "numbers in the names of the files must step evenly",
            value=numbers[i + 1],
            found=f"number {numbers[i + 1]} follows {numbers[i]}",
            remedy="add the band that is missing",
        )


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
            raise InputError(
                str(file),
                f"must be {opened[0][0][0]}x{opened[0][0][1]} {opened[0][1].name} as "
                f"{files[0].name}, because all bands must be alike",
                value=(*size, dtype.name),
                found=f"is {size[0]}x{size[1]} {dtype.name}",
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
        raise InputError(
            str(file),
            "must be gray with 8 or 16 bits",
            value=mode,
            found=f"has pixels of kind {mode}",
            remedy=("save it in that form", "move it away"),
        )
    return size, _GRAY[mode]


def _image(file: Path) -> Any:
    from PIL.PngImagePlugin import PngImageFile

    return PngImageFile(file)  # its size is bounded here, not by Pillow
