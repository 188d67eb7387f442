"""One picture of `simulate`: what was asked for, what was taken, and its files."""

import os
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from chromanoise._check import InputError, distinct, one_of
from chromanoise.color import ColorMatrix
from chromanoise.exposure import Situation
from chromanoise.imaging import (
    DEMOSAICING,
    Picture,
    RawPicture,
    Work,
    acquired,
    developed,
    picture_summary,
    raw_profile,
    raw_summary,
    rendered,
    sixteen_bit_srgb,
    write_dng,
    write_linear_exr,
    write_mosaic_tiff,
    write_png,
    write_srgb_tiff,
    write_xyz_tiff,
)
from chromanoise.imaging.light import BadPixels
from chromanoise.scene import Cube
from chromanoise.sensor import Imperfections, Mosaic, adc_to_full_well
from chromanoise.spectra import Beyond


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What `simulate` was asked for, beyond cube, sensors and light."""

    mosaic: Mosaic | None
    raw: bool
    demosaic: str | None
    bits: int
    black_level_dn: int
    imperfections: Imperfections
    seed: int
    clip: bool
    beyond: Beyond
    bad_pixels: BadPixels
    formats: tuple[str, ...] | None

    def __post_init__(self) -> None:
        for name in distinct("names of --format", self.formats or ()):
            one_of("--format", name, tuple(FORMATS))
            if name in _RAW and not self.raw:
                raise InputError(f"--format {name} is of a mosaic; name one with --mosaic")
            if name not in _RAW and self.raw and self.demosaic is None:
                raise InputError(f"--format {name} is of color, which --raw-only leaves out")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shot:
    """A picture as it was taken: codes, color, or both."""

    situation: Situation
    matrix: ColorMatrix
    raw: RawPicture | None
    picture: Picture | None

    @property
    def any_picture(self) -> Picture | RawPicture:
        """Color if there is some, otherwise the codes."""
        found = self.picture or self.raw
        assert found is not None
        return found

    @property
    def held(self) -> bool:
        """Whether electrons above full well were held there: a converter always does."""
        return self.raw is not None or (self.picture is not None and self.picture.clipped)


def shot(
    cube: Cube,
    situation: Situation,
    matrix: ColorMatrix,
    asked: Asked,
    *,
    frame: int,
    work: Work,
) -> Shot:
    """Take one picture."""
    common: dict[str, Any] = {
        "seed": asked.seed,
        "frame": frame,
        "imperfections": asked.imperfections,
        "beyond": asked.beyond,
        "bad_pixels": asked.bad_pixels,
        "work": work,
    }
    if not asked.raw:
        picture = rendered(cube, situation, matrix=matrix, clip=asked.clip, **common)
        return Shot(situation=situation, matrix=matrix, raw=None, picture=picture)
    pixel = situation.sensor.pixel
    adc = adc_to_full_well(pixel, bits=asked.bits, black_level_dn=asked.black_level_dn)
    mosaic, bank, color = asked.mosaic or situation.sensor.mosaic, None, None
    if asked.demosaic is not None and mosaic is not None:
        bank = DEMOSAICING[asked.demosaic](mosaic, situation)  # refuses before the long work
    raw = acquired(cube, situation, mosaic=mosaic, adc=adc, **common)
    if bank is not None:
        here = Work(threads=work.threads)  # the codes are in this memory
        color = developed(raw, bank, matrix=matrix, work=here)
    return Shot(situation=situation, matrix=matrix, raw=raw, picture=color)


def shot_summary(taken: Shot, asked: Asked, files: list[str], seconds: float) -> dict[str, Any]:
    """How it was taken, as plain data; the seconds are all that a rerun changes."""
    told: dict[str, Any] = {"files": files}
    if taken.raw is not None:
        told |= raw_summary(taken.raw)
    if taken.picture is not None:
        told |= picture_summary(taken.picture)
    return told | {"imperfections": asdict(asked.imperfections), "seconds": seconds}


def write_shot(folder: Path, stem: str, taken: Shot, asked: Asked) -> tuple[list[str], list[str]]:
    """Write the files: their names, and what could not be written although nobody insisted."""
    if asked.formats is not None:
        return [_written(name, folder / stem, taken) for name in asked.formats], []
    files, notes = [], []
    wanted = (*(_RAW if taken.raw else ()), *(("png", "xyz") if taken.picture else ()))
    for name in wanted:
        try:
            files.append(_written(name, folder / stem, taken))
        except InputError as error:
            if name != "dng":
                raise
            notes.append(f"no DNG was written: {error}")
    return files, notes


def _written(name: str, stem: Path, taken: Shot) -> str:
    """The file's name; complaints leave out the scratch folder, which each run calls otherwise."""
    try:
        return FORMATS[name](stem, taken)
    except InputError as error:
        raise InputError(str(error).replace(f"{stem.parent}{os.sep}", "")) from None


def _named(stem: Path, ending: str) -> Path:
    return stem.parent / f"{stem.name}{ending}"


def _png(stem: Path, taken: Shot) -> str:
    assert taken.picture is not None
    write_png(path := _named(stem, ".png"), taken.picture.srgb)
    return path.name


def _xyz(stem: Path, taken: Shot) -> str:
    assert taken.picture is not None
    write_xyz_tiff(path := _named(stem, ".xyz.tiff"), taken.picture.xyz)
    return path.name


def _srgb16(stem: Path, taken: Shot) -> str:
    assert taken.picture is not None
    codes = sixteen_bit_srgb(taken.picture.xyz, taken.picture.white)
    write_srgb_tiff(path := _named(stem, ".srgb16.tiff"), codes)
    return path.name


def _exr(stem: Path, taken: Shot) -> str:
    assert taken.picture is not None
    write_linear_exr(path := _named(stem, ".exr"), taken.picture.xyz, taken.picture.white)
    return path.name


def _raw(stem: Path, taken: Shot) -> str:
    assert taken.raw is not None
    raw = taken.raw
    write_mosaic_tiff(
        path := _named(stem, ".raw.tiff"),
        raw.codes,
        sensor_name=raw.situation.sensor.name,
        mosaic=raw.mosaic,
        adc=raw.adc,
    )
    return path.name


def _dng(stem: Path, taken: Shot) -> str:
    assert taken.raw is not None
    raw = taken.raw
    profile = raw_profile(raw.situation, taken.matrix, mosaic=raw.mosaic, adc=raw.adc)
    write_dng(path := _named(stem, ".dng"), raw.codes, profile)
    return path.name


FORMATS: Mapping[str, Callable[[Path, Shot], str]] = {
    "png": _png,
    "xyz": _xyz,
    "srgb16": _srgb16,
    "exr": _exr,
    "raw": _raw,
    "dng": _dng,
}
_RAW = ("raw", "dng")
