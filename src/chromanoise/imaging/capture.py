"""Capture of an image: its settings, the camera prepared once for all frames, and the files."""

import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from chromanoise.base import (
    InputError,
    Setting,
    dataclass,
    distinct,
    one_of,
    renamed,
    with_short_repr,
)
from chromanoise.color import ColorMatrix
from chromanoise.imaging.demosaic import FilterBank
from chromanoise.imaging.demosaic_methods import DEMOSAICING
from chromanoise.imaging.dng import RawProfile, raw_profile, refuse_dng_size, write_dng
from chromanoise.imaging.formats import FORMATS
from chromanoise.imaging.plans import BadPixels, color_matrices, demand_well, draw_of
from chromanoise.imaging.render import Picture, RawPicture, mosaic_of
from chromanoise.imaging.row_files import openexr, write_in_parts, write_linear_exr
from chromanoise.imaging.writers import (
    picture_summary,
    raw_summary,
    sixteen_bit_srgb,
    srgb_tiff_rows,
    write_mosaic_tiff,
    write_png,
    write_xyz_tiff,
)
from chromanoise.noise import OperatingPoint
from chromanoise.sensor import EXTRA_NOISE, Adc, Mosaic, PixelOverrides, adc_of, overridden
from chromanoise.spectra import Beyond, Cube, row_source


@dataclass(frozen=True, kw_only=True)
class CaptureSettings:
    """Settings of a capture, in addition to cube, sensor and light.

    Attributes
    ----------
    mosaic
        The channel of each pixel; the sensor's own mosaic if ``None``.
    raw
        Whether the image has raw codes of a mosaic; otherwise every pixel has every channel.
    demosaic
        Method of `DEMOSAICING`; ``None`` for codes without color.
    pixel
        Values that override the sensor's own pixel and converter.
    seed
        Seed of the noise.
    clip
        Whether electrons are clipped to 0 and full well; a converter always clips.
    beyond, bad_pixels
        As `rendered`.
    formats
        Names from `FORMATS`; ``None`` for png and xyz of color, and raw and, if possible, dng of
        codes.

    Raises
    ------
    InputError
        If a format is unknown or repeated, or needs codes or color that are not made.
    """

    mosaic: Mosaic | None
    raw: bool
    demosaic: str | None
    pixel: PixelOverrides
    seed: int
    clip: bool
    beyond: Beyond
    bad_pixels: BadPixels
    formats: tuple[str, ...] | None

    def __post_init__(self) -> None:
        for name in distinct("names of formats", self.formats or ()):
            one_of("format", name, FORMATS)
            if name in _RAW and not self.raw:
                raise InputError(
                    "formats",
                    "must not be of a mosaic where none is given",
                    value=name,
                    found=f"{name} is of a mosaic",
                    remedy=Setting("mosaic"),
                )
            if name not in _RAW and self.raw and self.demosaic is None:
                raise InputError(
                    "formats",
                    "must be of raw codes where no color is requested",
                    value=name,
                    found=f"{name} is of color",
                    remedy="omit it",
                )


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """A camera prepared for capture: all data that its frames share.

    Attributes
    ----------
    operating_point, matrix
        Sensor (with the pixel and converter of its images), exposure and light; the
        matrix from electrons to XYZ.
    settings
        Settings of its images.
    mosaic, adc, bank
        Mosaic and converter of raw codes, and demosaicing filters; ``None`` if not used.
    profile
        Profile of the DNG, if one can be written; otherwise ``None``.
    no_profile
        Reason why no DNG is written although codes are written; ``None`` otherwise.
    """

    operating_point: OperatingPoint
    matrix: ColorMatrix
    settings: CaptureSettings
    mosaic: Mosaic | None = None
    adc: Adc | None = None
    bank: FilterBank | None = None
    profile: RawProfile | None = None
    no_profile: InputError | None = None


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Capture:
    """The result of a capture: codes, color, or both.

    Attributes
    ----------
    raw
        Codes as acquired, also where the color is denoised.
    denoised_by
        Name of the denoising method before color; ``None`` without denoising.
    """

    camera: Camera
    raw: RawPicture | None
    picture: Picture | None
    denoised_by: str | None = None


def camera_for(
    cube: Cube, operating_point: OperatingPoint, matrix: ColorMatrix, settings: CaptureSettings
) -> Camera:
    """A camera for capturing a cube; invalid settings are refused before any long computation.

    Parameters
    ----------
    cube
        The cube; only its size is used.
    operating_point
        Sensor, exposure and light.
    matrix
        Matrix from electrons to XYZ.
    settings
        Settings of its images.

    Raises
    ------
    InputError
        If the mosaic names a channel that the sensor lacks or does not suit the demosaicing, the
        matrix gives no luminance, or a requested format cannot be written.
    """
    requested = settings.formats or ()
    if "exr" in requested:
        openexr()
    operating_point = replace(
        operating_point, sensor=overridden(operating_point.sensor, settings.pixel, raw=settings.raw)
    )
    if settings.raw or settings.clip:
        demand_well(operating_point, draw_of(operating_point, seed=0))
    if not settings.raw:
        color_matrices(matrix, operating_point)
        return Camera(operating_point=operating_point, matrix=matrix, settings=settings)
    adc = adc_of(operating_point.sensor.converter, operating_point.sensor.pixel)
    mosaic = mosaic_of(operating_point, settings.mosaic)
    bank = None
    if settings.demosaic is not None:
        method = DEMOSAICING[one_of("demosaicing", settings.demosaic, tuple(DEMOSAICING))]
        bank = method(mosaic, operating_point)
        color_matrices(matrix, operating_point)
    profile, no_profile = _profile(operating_point, matrix, mosaic, adc, settings)
    if "dng" in requested:
        height, width, _ = row_source(cube.stored).shape
        refuse_dng_size(f"DNG of {operating_point.sensor.name}", height=height, width=width)
    return Camera(
        operating_point=operating_point,
        matrix=matrix,
        settings=settings,
        mosaic=mosaic,
        adc=adc,
        bank=bank,
        profile=profile,
        no_profile=no_profile,
    )


def _profile(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    mosaic: Mosaic,
    adc: Adc,
    settings: CaptureSettings,
) -> tuple[RawProfile | None, InputError | None]:
    """The DNG profile, or the reason why there is none; an error only if a DNG was requested."""
    if "dng" not in (settings.formats or _RAW):
        return None, None
    try:
        return raw_profile(operating_point, matrix, mosaic=mosaic, adc=adc), None
    except InputError as error:
        if settings.formats:
            raise
        return None, error


def any_picture(taken: Capture) -> Picture | RawPicture:
    """The color image if there is one, otherwise the codes."""
    found = taken.picture or taken.raw
    assert found is not None
    return found


def is_held(taken: Capture) -> bool:
    """Whether electrons were clipped at full well; a converter always clips."""
    return taken.raw is not None or (taken.picture is not None and taken.picture.clipped)


def capture_summary(taken: Capture, files: list[str]) -> dict[str, Any]:
    """Summary of the capture as plain data."""
    summary: dict[str, Any] = {"files": files}
    if taken.raw is not None:
        summary |= raw_summary(taken.raw)
    if taken.picture is not None:
        summary |= picture_summary(taken.picture)
    if taken.denoised_by is not None:
        summary["denoise"] = taken.denoised_by
    pixel = taken.camera.operating_point.sensor.pixel
    return summary | {"imperfections": {name: getattr(pixel, name) for name in EXTRA_NOISE}}


def write_capture(folder: Path, stem: str, taken: Capture) -> tuple[list[str], list[str]]:
    """Write the files; the result is their names, and notes on files that could not be written.

    Raises
    ------
    InputError
        If the stem leads into another folder or begins with a dot, or a file cannot be written.
    """
    if stem.startswith(".") or any(letter in stem for letter in "/\\\0"):
        raise InputError(
            "file name",
            "must not begin with a dot nor hold a slash, a backslash or a null byte",
            value=stem,
            remedy="use another name",
        )
    formats = taken.camera.settings.formats
    if formats is not None:
        return [_written(name, folder / stem, taken) for name in formats], []
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


def _written(name: str, stem: Path, taken: Capture) -> str:
    """The file's name; errors omit the scratch folder, whose name differs from run to run."""
    ending, write = _WRITERS[name]
    path = stem.parent / f"{stem.name}{ending}"
    try:
        write(path, taken, taken.raw if name in _RAW else taken.picture)
    except InputError as error:
        raise renamed(error, f"{stem.parent}{os.sep}", "") from None
    return path.name


def _png(path: Path, _: Capture, picture: Picture) -> None:
    write_png(path, picture.srgb)


def _xyz(path: Path, _: Capture, picture: Picture) -> None:
    write_xyz_tiff(path, picture.xyz, observer=picture.matrix.observer)


def _srgb16(path: Path, _: Capture, picture: Picture) -> None:
    height, width = picture.xyz.shape[:2]
    write_in_parts(
        srgb_tiff_rows(path, height=height, width=width),
        picture.xyz,
        encoded=lambda xyz: sixteen_bit_srgb(xyz, picture.white),
    )


def _exr(path: Path, _: Capture, picture: Picture) -> None:
    write_linear_exr(path, picture.xyz, picture.white)


def _raw(path: Path, _: Capture, raw: RawPicture) -> None:
    name = raw.operating_point.sensor.name
    write_mosaic_tiff(path, raw.codes, sensor_name=name, mosaic=raw.mosaic, adc=raw.adc)


def _dng(path: Path, taken: Capture, raw: RawPicture) -> None:
    if taken.camera.profile is None:
        assert taken.camera.no_profile is not None
        raise taken.camera.no_profile
    write_dng(path, raw.codes, taken.camera.profile)


_WRITERS: Mapping[str, tuple[str, Callable[[Path, Capture, Any], None]]] = {
    "png": (".png", _png),
    "xyz": (".xyz.tiff", _xyz),
    "srgb16": (".srgb16.tiff", _srgb16),
    "exr": (".exr", _exr),
    "raw": (".raw.tiff", _raw),
    "dng": (".dng", _dng),
}
"""Ending and writer of each format: of color, or of the codes for those of `_RAW`."""
_RAW = ("raw", "dng")
