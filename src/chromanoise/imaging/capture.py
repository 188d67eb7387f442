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
from chromanoise.imaging.blocks import parts_of_rows
from chromanoise.imaging.demosaic import FilterBank
from chromanoise.imaging.demosaic_methods import DEMOSAICING
from chromanoise.imaging.develop import developed
from chromanoise.imaging.dng import RawProfile, raw_profile, refuse_dng_size, write_dng
from chromanoise.imaging.formats import FORMATS
from chromanoise.imaging.plans import BadPixels, color_matrices, demand_well, draw_of
from chromanoise.imaging.render import Picture, RawPicture, acquired, mosaic_of, rendered
from chromanoise.imaging.row_files import openexr, write_linear_exr
from chromanoise.imaging.shared_rows import Work
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


def captured(cube: Cube, camera: Camera, *, frame: int, work: Work, noisy: bool = True) -> Capture:
    """Capture one image.

    Parameters
    ----------
    frame
        Number of the image in a burst.
    work
        Threads or executor for the computation.
    noisy
        As `rendered`; raw codes always have noise.

    Raises
    ------
    InputError
        As `rendered` and `acquired`.
    """
    settings, common = camera.settings, frame_settings(camera, frame=frame, work=work)
    if not settings.raw:
        picture = rendered(
            cube,
            camera.operating_point,
            matrix=camera.matrix,
            clip=settings.clip,
            noisy=noisy,
            **common,
        )
        return Capture(camera=camera, raw=None, picture=picture)
    raw = acquired(cube, camera.operating_point, mosaic=camera.mosaic, adc=camera.adc, **common)
    color = None
    if camera.bank is not None:
        here = Work(threads=work.threads, folder=work.folder)  # the codes are in this memory
        color = developed(raw, camera.bank, matrix=camera.matrix, work=here)
    return Capture(camera=camera, raw=raw, picture=color)


def frame_settings(camera: Camera, *, frame: int, work: Work) -> dict[str, Any]:
    """What `rendered`, `rendered_electrons` and `acquired` take for one frame of a camera."""
    settings = camera.settings
    return {
        "seed": settings.seed,
        "frame": frame,
        "beyond": settings.beyond,
        "bad_pixels": settings.bad_pixels,
        "work": work,
    }


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
    try:
        return _WRITERS[name](stem, taken)
    except InputError as error:
        raise renamed(error, f"{stem.parent}{os.sep}", "") from None


def _named(stem: Path, ending: str) -> Path:
    return stem.parent / f"{stem.name}{ending}"


def _png(stem: Path, taken: Capture) -> str:
    assert taken.picture is not None
    write_png(path := _named(stem, ".png"), taken.picture.srgb)
    return path.name


def _xyz(stem: Path, taken: Capture) -> str:
    assert taken.picture is not None
    path, observer = _named(stem, ".xyz.tiff"), taken.picture.matrix.observer
    write_xyz_tiff(path, taken.picture.xyz, observer=observer)
    return path.name


def _srgb16(stem: Path, taken: Capture) -> str:
    assert taken.picture is not None
    xyz, path = taken.picture.xyz, _named(stem, ".srgb16.tiff")
    with srgb_tiff_rows(path, height=xyz.shape[0], width=xyz.shape[1]) as put:
        for start, rows in parts_of_rows(xyz):
            put(start, sixteen_bit_srgb(rows, taken.picture.white))
    return path.name


def _exr(stem: Path, taken: Capture) -> str:
    assert taken.picture is not None
    write_linear_exr(path := _named(stem, ".exr"), taken.picture.xyz, taken.picture.white)
    return path.name


def _raw(stem: Path, taken: Capture) -> str:
    assert taken.raw is not None
    raw = taken.raw
    write_mosaic_tiff(
        path := _named(stem, ".raw.tiff"),
        raw.codes,
        sensor_name=raw.operating_point.sensor.name,
        mosaic=raw.mosaic,
        adc=raw.adc,
    )
    return path.name


def _dng(stem: Path, taken: Capture) -> str:
    assert taken.raw is not None
    if taken.camera.profile is None:
        assert taken.camera.no_profile is not None
        raise taken.camera.no_profile
    write_dng(path := _named(stem, ".dng"), taken.raw.codes, taken.camera.profile)
    return path.name


_WRITERS: Mapping[str, Callable[[Path, Capture], str]] = {
    "png": _png,
    "xyz": _xyz,
    "srgb16": _srgb16,
    "exr": _exr,
    "raw": _raw,
    "dng": _dng,
}
_RAW = ("raw", "dng")
