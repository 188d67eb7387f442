"""Denoised pictures of other cameras: frames of files or arrays, denoising, and output files.

Nothing is assumed of a camera: black level, mosaic, gain and read noise come from the options, the
sensor, the pixel or the file, and what is missing is an error.
"""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    Float32,
    InputError,
    Setting,
    UInt16,
    __version__,
    check,
    dataclass,
    refusal,
    renamed_keywords,
    true_path,
)
from chromanoise.imaging import (
    ALL_CORES,
    DEMOSAICING,
    Picture,
    RawPicture,
    Work,
    channel_tile,
    developed,
    mosaic_description,
    mosaic_of,
    tiff_rows,
    write_png,
    write_xyz_tiff,
)
from chromanoise.imaging.denoising import (
    CodeNoise,
    DenoisedRaw,
    DenoisingMethod,
    at_brightness,
    code_noise,
    code_noise_of_profile,
    denoised_raw,
    denoising_named,
)
from chromanoise.io.frames import (
    DUMP_ENDINGS,
    DUMP_TYPES,
    RawFrame,
    StoredPlane,
    dumped_frame,
    frames_in,
    mosaic_of_all,
    refuse_mixed,
)
from chromanoise.noise import NoiseSources, OperatingPoint, noise_sources
from chromanoise.sensor import (
    PIXEL,
    PIXEL_NOISE,
    Adc,
    Converter,
    Mosaic,
    Pixel,
    mosaic_named,
    refuse_summed_readings,
)
from chromanoise.study.assembly import NOTHING_GIVEN, Given, keyed, makers_of, operating_points_of
from chromanoise.study.catalog import is_assumed
from chromanoise.study.color_matrices import DEFAULT_METHOD, MatrixMaker
from chromanoise.study.function_settings import FUNCTIONS, Settings, study_of
from chromanoise.study.hashes import digests_of, study_as_json
from chromanoise.study.pixel_files import converter_of, read_pixel_source
from chromanoise.study.resolve_names import file_of
from chromanoise.study.run_files import refuse_other_record
from chromanoise.study.schema import Study, value_at


@dataclass(frozen=True, kw_only=True, eq=False)
class Electrons:
    """A raw picture in electrons above black.

    Attributes
    ----------
    values_e
        One value per pixel. [e-]
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
        Type of the codes of a raw dump, a name of ``DUMP_TYPES``; uint16 if ``None``.

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
        stored = check.one_of("stored", stored or "uint16", tuple(DUMP_TYPES))
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
    values = check.finite(name, "e-", _rows_and_columns(values_e, name))
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


MONOCHROME = "none"
"""The mosaic of a sensor without color filters."""

_WITHOUT_SENSOR = (
    *("pixel", "read_noise_e", "gain_dn_per_e", *PIXEL_NOISE),
    *("time_ms", "bits", "black_level", "mosaic"),
)


@dataclass(frozen=True, kw_only=True, eq=False)
class DenoisingPlan:
    """A picture to be denoised, with all that is known of it; checked.

    Attributes
    ----------
    pictures
        Frames of files, or electrons; several are a burst.
    operating_point
        Sensor and light; ``None`` if only the pixel is known.
    maker
        Color matrix; ``None`` without a sensor.
    mosaic
        The channel of each pixel.
    noise
        Scale and noise of the codes.
    bits
        Bits of the codes, if they are known.
    is_bright
        Whether the illuminance is given. Otherwise it is that at which the mean of the ColorChecker
        is the mean of the picture.
    notes
        On what was used.
    """

    pictures: tuple[RawFrame, ...] | tuple[Electrons, ...]
    study: Study
    operating_point: OperatingPoint | None
    maker: MatrixMaker | None
    mosaic: Mosaic
    noise: CodeNoise
    bits: int | None
    is_bright: bool
    method: DenoisingMethod
    notes: tuple[str, ...]

    @property
    def stem(self) -> str:
        """Name of the output files without their endings."""
        first = self.pictures[0]
        return first.path.stem if isinstance(first, RawFrame) else first.name

    def _settings(self) -> dict[str, Any]:
        """The settings that take part; ``None`` where the file or the picture gives the value."""
        study = study_as_json(self.study)
        alone = self.operating_point is None
        used = {
            name: value_at(study, keys[0])
            for name, keys in FUNCTIONS["denoise"].items()
            if not alone or name in _WITHOUT_SENSOR
        }
        if used["mosaic"] == "sensor":
            used["mosaic"] = None
        if alone:
            return used
        if not self.is_bright:
            used["lux"] = None
        return {"sensor": self.study.sensors[0].name, "matrix": self.study.matrices[0]} | used

    def record(self) -> dict[str, Any]:
        """What decides the result, as plain data: version, settings and the bytes of the files."""
        files = [one.path for one in self.pictures if isinstance(one, RawFrame)]
        existing = [path for path in files if path.is_file()]
        return {
            "version": __version__,
            "settings": self._settings(),
            "bits": self.bits,
            "pictures": [
                one.name if isinstance(one, RawFrame) else self.stem for one in self.pictures
            ],
            "sha256": digests_of(existing),
            "method": self.method.name,
            "noise": self.noise.to_dict(),
        }


@renamed_keywords(method="denoise")
def prepared_denoising(
    pictures: tuple[RawFrame, ...] | tuple[Electrons, ...],
    sensor: str | None,
    settings: Settings,
    *,
    denoise: str,
    matrix: str = DEFAULT_METHOD,
    white_level: float | None = None,
    given: Given = NOTHING_GIVEN,
) -> DenoisingPlan:
    """What is known of a picture, checked before any computation.

    Parameters
    ----------
    sensor
        Name of the catalog, or file; ``None`` if only the pixel or a noise profile is known.
    settings
        By the names of `DenoiseSettings`.
    white_level
        Code from which on pixels are saturated; that of the file, or the largest code of its bits,
        if ``None``. [DN]
    given
        Sensors and illuminants as objects.

    Raises
    ------
    InputError
        If a setting is wrong or without effect, or mosaic, black level or noise are not known.

    Notes
    -----
    The noise is that of the pixel where its gain is known: dark electrons, readout, rounding,
    DSNU, row noise and PRNU, as `noise_sources`. Otherwise it is the noise profile of the file.
    Mosaic and black level are as given, else of the file, else of the sensor or pixel. An exposure
    time that is not given is that of the file.
    """
    chosen = denoising_named(denoise)
    first = pictures[0]
    facts = first if isinstance(first, RawFrame) else None
    settings = {name: value for name, value in settings.items() if value is not None}
    if sensor is None:
        _refuse_idle_without_sensor(settings, matrix)
    if (
        facts is not None
        and facts.time_ms is not None
        and not {"time_ms", "saturate"} & {*settings}
    ):
        settings["time_ms"] = facts.time_ms
    study = study_of("denoise", [sensor or ""], settings, matrices=[matrix])
    point, maker, mosaic = None, None, _mosaic(study, facts)
    if sensor is not None:
        (point,) = operating_points_of(study, given)
        ((_, maker),) = makers_of(study, given).items()
        with keyed("pictures.0.mosaic", str):
            mosaic = _mosaic_of_sensor(point, mosaic, monochrome=_part(study) == MONOCHROME)
        pixel = _pixel_of_sensor(point, timed="time_ms" in settings)
    else:
        pixel = _pixel_of_part(study)
    bits = pixel.converter.bits or (facts.bits if facts is not None else None)
    black, white = _levels(pixel, study, facts, bits, white_level)
    missing = _missing(pixel, study, first, mosaic, black, white)
    if mosaic is None or missing:
        raise refusal(missing)
    names = mosaic.names if point is None else point.sensor.names
    if isinstance(first, RawFrame):
        noise, notes = _noise_of_codes(pixel, names, study, first, black, white)
    else:
        noise, notes = _noise_of_electrons(pixel, names, study, white_level), []
    channel_tile(mosaic, noise.names)
    return DenoisingPlan(
        pictures=pictures,
        study=study,
        operating_point=point,
        maker=maker,
        mosaic=mosaic,
        noise=noise,
        bits=bits,
        is_bright="lux" in settings,
        method=chosen,
        notes=(*notes, *(() if point is None else point.sensor.notes)),
    )


@dataclass(frozen=True, kw_only=True)
class _Pixel:
    """What is known of the pixel.

    Attributes
    ----------
    sources
        Its noise, rounding not included; ``None`` if the read noise is not known.
    source
        Where both come from.
    """

    sources: NoiseSources | None
    converter: Converter
    source: str


def _part(study: Study) -> str:
    return study.pictures[0].mosaic or ""


def _mosaic(study: Study, facts: RawFrame | None) -> Mosaic | None:
    """The mosaic as given, or else as the file states it."""
    word = _part(study)
    if word == MONOCHROME:
        return Mosaic((("gray",),))
    if word != "sensor":
        with keyed("pictures.0.mosaic", str):
            return mosaic_named(word)
    return None if facts is None else facts.mosaic


def _mosaic_of_sensor(point: OperatingPoint, mosaic: Mosaic | None, *, monochrome: bool) -> Mosaic:
    names = point.sensor.names
    if monochrome and len(names) > 1:
        raise InputError(
            "mosaic",
            "must not be none for a sensor of several channels",
            value=MONOCHROME,
            found=f"{point.sensor.name} has {', '.join(names)}",
        )
    if monochrome or (mosaic is None and len(names) == 1):
        return Mosaic((names,))
    found = mosaic_of(point, mosaic)
    channel_tile(found, names)
    return found


def _refuse_idle_without_sensor(settings: Settings, matrix: str) -> None:
    known = FUNCTIONS["denoise"]  # other names are refused as unknown
    idle = {
        name: value
        for name, value in settings.items()
        if name in known and name not in _WITHOUT_SENSOR
    }
    idle |= {} if matrix == DEFAULT_METHOD else {"matrix": matrix}
    errors = [
        InputError(
            name,
            "must be given only with a sensor, which gives light and color",
            value=value,
            found="there is none",
            remedy=(Setting("sensor"), Setting(name, omit=True)),
            setting=known.get(name, ("matrices",))[0].replace("*", "0"),
        )
        for name, value in idle.items()
    ]
    if errors:
        raise refusal(errors)


def _pixel_of_sensor(point: OperatingPoint, *, timed: bool) -> _Pixel:
    sensor = point.sensor
    refuse_summed_readings(sensor)
    _demand_time(sensor.pixel.dark_current_e_per_s, timed=timed)
    known = not is_assumed(sensor, "read_noise_e")
    return _Pixel(
        sources=noise_sources(sensor, point.exposure) if known else None,
        converter=sensor.converter,
        source=f"pixel of {sensor.name}",
    )


def _pixel_of_part(study: Study) -> _Pixel:
    part, time_ms = study.sensors[0].pixel, study.exposure.time_ms
    source = None if part.file is None else read_pixel_source(file_of(part.file))
    converter = Converter() if source is None else converter_of(source)
    if part.gain_dn_per_e is not None:
        converter = replace(converter, gain_e_per_dn=1 / part.gain_dn_per_e)
    if part.bits is not None:
        converter = replace(converter, bits=part.bits)

    def value(name: str) -> float | None:
        own: float | None = getattr(part, name)
        return own if own is not None else getattr(source, name, None)

    where = "pixel as given" if source is None else f"pixel of {source.source}"
    read_noise_e, dark = value("read_noise_e"), value("dark_current_e_per_s") or 0.0
    if read_noise_e is None:
        return _Pixel(sources=None, converter=converter, source=where)
    _demand_time(dark, timed=time_ms is not None)
    given = {name: own for name in PIXEL if (own := value(name)) is not None}
    pixel = Pixel(**{"pitch_um": 1.0, "full_well_e": PIXEL["full_well_e"].most} | given)
    sources = NoiseSources(
        pixel=pixel, dark_e=pixel.dark_electrons_e(time_s=1e-3 * (time_ms or 0.0))
    )
    return _Pixel(sources=sources, converter=converter, source=where)


def _demand_time(dark_current_e_per_s: float, *, timed: bool) -> None:
    if dark_current_e_per_s and not timed:
        raise InputError(
            "time_ms",
            "must be given for a pixel with dark current, because the file does not state it",
            value=None,
            found=f"the pixel has {dark_current_e_per_s:g} e-/s",
            remedy=Setting("time_ms"),
        )


def _levels(
    pixel: _Pixel,
    study: Study,
    facts: RawFrame | None,
    bits: int | None,
    white_level: float | None,
) -> tuple[float | None, float | None]:
    """Black and white level; ``None`` where one is not known. [DN]"""
    if white_level is not None:
        check.positive("white_level", "DN", white_level)
    own = (None, None) if facts is None else (facts.black_level_dn, facts.white_level_dn)
    blacks = (study.pictures[0].black_level, own[0], pixel.converter.black_level_dn)
    whites = (white_level, own[1], None if bits is None else 2.0**bits - 1)
    black, white = (
        next((float(one) for one in levels if one is not None), None) for levels in (blacks, whites)
    )
    return black, white


def _missing(
    pixel: _Pixel,
    study: Study,
    first: RawFrame | Electrons,
    mosaic: Mosaic | None,
    black: float | None,
    white: float | None,
) -> list[InputError]:
    """An error for each quantity that must be given."""
    lacking: dict[str, str] = {}
    if mosaic is None:
        lacking["mosaic"] = (
            "the file does not state it: rows, e.g. RG/GB, or none for a monochrome sensor"
        )
    unknown = {
        "gain_dn_per_e": isinstance(first, RawFrame) and pixel.converter.gain_e_per_dn is None,
        "read_noise_e": pixel.sources is None,
    }
    profile, reason = None, "neither the picture nor a pixel states it"
    if isinstance(first, RawFrame):
        if black is None:
            lacking["black_level"] = f"neither {first.name} nor the pixel states it"
        profile, part = first.noise_profile, study.sensors[0].pixel
        if part.gain_dn_per_e is not None and unknown["read_noise_e"]:
            profile, reason = None, "the gain K is given, and the noise needs both"
        if part.read_noise_e is not None and unknown["gain_dn_per_e"]:
            profile, reason = None, "the read noise is given, and the noise needs both"
    if profile is None:
        lacking |= {name: reason for name, absent in unknown.items() if absent}
    elif white is None and any(unknown.values()):
        lacking["white_level"] = "the NoiseProfile of the file is relative to it"
    pixels = (Setting("pixel"),)
    return [
        InputError(
            name,
            f"must be given, because {text}",
            value=None,
            remedy=(Setting(name), *(pixels if name in unknown else ())),
        )
        for name, text in lacking.items()
    ]


def _noise_of_codes(
    pixel: _Pixel,
    names: Sequence[str],
    study: Study,
    first: RawFrame,
    black: float | None,
    white: float | None,
) -> tuple[CodeNoise, list[str]]:
    """The noise, and notes on what was not used; nothing that it needs is missing."""
    assert black is not None
    notes: list[str] = []
    own = pixel.converter.black_level_dn
    if own is not None and own != black:
        notes.append(f"black level {black:g} DN, not {own} DN of the {pixel.source}")
    if white is None:
        notes.append("the white level is not known, so no pixel counts as saturated")
    gain = pixel.converter.gain_e_per_dn
    if gain is not None and pixel.sources is not None:
        noise = code_noise(
            replace(pixel.sources, step_e=gain),
            names,
            black_level_dn=black,
            saturation_dn=white,
            source=f"{pixel.source}: gain {1 / gain:.4g} DN/e-, "
            f"read noise {pixel.sources.pixel.read_noise_e:.4g} e-",
        )
        return noise, notes
    assert first.noise_profile is not None
    assert white is not None
    for name in names:
        check.among("channel of the sensor", name, tuple(first.noise_profile))
    if study.sensors[0].pixel.file is not None:
        lacks = "gain K [DN/e-]" if gain is None else "read noise [e-]"
        notes.append(f"the {lacks} is not known, so the noise of the {pixel.source} is not used")
    noise = code_noise_of_profile(
        first.noise_profile,
        names,
        black_level_dn=black,
        white_level_dn=white,
        source=f"NoiseProfile of {first.name}",
    )
    return noise, notes


def _noise_of_electrons(
    pixel: _Pixel, names: Sequence[str], study: Study, white_level: float | None
) -> CodeNoise:
    """The noise of a picture in electrons: nothing is rounded."""
    assert pixel.sources is not None
    for name, value in (
        ("black_level", study.pictures[0].black_level),
        ("white_level", white_level),
    ):
        if value is not None:
            raise InputError(
                name, "must not be given for a picture in electrons", value=value, remedy="omit it"
            )
    noise = code_noise(
        replace(pixel.sources, step_e=1.0),
        names,
        black_level_dn=0.0,
        saturation_dn=None,
        source=f"{pixel.source}: read noise {pixel.sources.pixel.read_noise_e:.4g} e-",
    )
    return replace(noise, temporal=replace(pixel.sources, step_e=0.0).law("temporal"))


_FEWEST_SIGMAS = 5.0
_MOST_BELOW = 0.01
_FITTING = (0.8, 1.5)
_TOP_CODE = 2**16 - 1


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class DenoisedPicture:
    """A raw picture of another camera after denoising.

    Attributes
    ----------
    values_e
        Electrons of each pixel. [e-]
    codes
        The same as codes, rounded; ``None`` of a picture in electrons. [DN]
    picture
        Color; ``None`` without a sensor.
    noise
        Scale and noise of the picture before denoising.
    mosaic
        The channel of each pixel.
    summary
        Inputs, noise, method, clipped shares, residual and notes as plain data.
    """

    values_e: Float32[Array, "h w"]
    codes: UInt16[Array, "h w"] | None
    picture: Picture | None
    noise: CodeNoise
    mosaic: Mosaic
    summary: Mapping[str, Any]
    plan: DenoisingPlan

    def to_dict(self) -> dict[str, Any]:
        """The summary."""
        return dict(self.summary)

    def __repr__(self) -> str:
        height, width = self.values_e.shape
        return (
            f"<DenoisedPicture: {self.plan.stem} {height} x {width} by {self.plan.method.name}, "
            f"noise: {self.noise.source}>"
        )


def denoised_picture(plan: DenoisingPlan, *, work: Work = ALL_CORES) -> DenoisedPicture:
    """A picture of another camera after denoising, and its color if the sensor is known.

    Parameters
    ----------
    work
        Threads and rows per strip.

    Raises
    ------
    InputError
        If a file cannot be read, its codes contradict the black level, or as `denoised_raw`.

    Notes
    -----
    The result is rounded to codes and clipped at 0 and the top code; saturated pixels keep their
    code. Without an illuminance, that of the operating point is the one at which the mean of the
    ColorChecker is the mean of the picture.
    """
    first, noise, mosaic = plan.pictures[0], plan.noise, plan.mosaic
    codes, clipped = None, {}
    if isinstance(first, RawFrame):
        codes = _codes(first, plan.bits)
        raw_e, clipped = noise.electrons(codes), _clipped(codes, noise)
    else:
        raw_e = first.values_e
    point = plan.operating_point
    if point is not None and not plan.is_bright:
        point = at_brightness(point, mosaic, raw_e, noise)
    others = (
        (
            one.values_e if isinstance(one, Electrons) else noise.electrons(_codes(one, plan.bits)),
            _relative_exposure(first, one),
        )
        for one in plan.pictures[1:]
    )
    done = denoised_raw(
        raw_e, mosaic, noise, plan.method, operating_point=point, others=others, work=work
    )
    del raw_e
    made, outside = (None, 0.0) if codes is None else _rounded(done.values_e, plan)
    notes = [*plan.notes, *_misfit_notes(done, noise)]
    picture = None
    if point is not None and plan.maker is not None:
        try:
            picture = _developed(plan, plan.maker, point, done.values_e, work)
        except InputError as error:
            notes.append(f"no color: {error}")
    summary = plan.record() | {
        "height_px": done.values_e.shape[0],
        "width_px": done.values_e.shape[1],
        "mosaic": [list(row) for row in mosaic.pattern],
        "frames": done.frames,
        "exposures": [_relative_exposure(first, one) for one in plan.pictures],
        **clipped,
        "outside_codes_share": outside,
        "residual": _by_plane(done.names, done.residual),
        "measured_noise": _by_plane(done.names, done.measured),
        "level_lux": None if point is None else point.level_lux,
        "notes": notes,
    }
    return DenoisedPicture(
        values_e=done.values_e,
        codes=made,
        picture=picture,
        noise=noise,
        mosaic=mosaic,
        summary=summary,
        plan=plan,
    )


def _by_plane(names: tuple[str, ...], values: Float[Array, " k"]) -> dict[str, float | None]:
    """A value per plane as plain data; ``None`` where there is none."""
    return {
        name: None if np.isnan(value) else value
        for name, value in zip(names, values.tolist(), strict=True)
    }


def _codes(frame: RawFrame, bits: int | None) -> Array:
    codes = frame.codes()
    most = int(codes.max())
    for code in (int(codes.min()), most):
        if not 0 <= code <= _TOP_CODE:
            raise InputError(
                frame.name,
                f"must hold codes from 0 to {_TOP_CODE}",
                value=code,
                found=f"holds {code}",
            )
    if bits is not None and most >= 2**bits:
        raise InputError(
            "bits",
            f"must hold the codes of {frame.name}",
            value=bits,
            found=f"{bits} bits end at {2**bits - 1}, and the largest code is {most}",
            remedy=Setting("bits", (most.bit_length(),)),
        )
    return codes


def _relative_exposure(first: RawFrame | Electrons, one: RawFrame | Electrons) -> float:
    """Exposure time over that of the first; 1 where a file does not state it."""
    times = [each.time_ms if isinstance(each, RawFrame) else None for each in (first, one)]
    return 1.0 if times[0] is None or times[1] is None else times[1] / times[0]


def _clipped(codes: Array, noise: CodeNoise) -> dict[str, float]:
    """Shares of pixels at code 0, and at and above the white level.

    Raises
    ------
    InputError
        If the black level cannot be right: noise alone puts less than 1e-6 of the pixels further
        than 5 standard deviations below it.
    """
    lowest = noise.black_level_dn - _FEWEST_SIGMAS * float(
        np.sqrt(np.max(noise.law.floor_e2)) / noise.gain_e_per_dn
    )
    at_0 = np.count_nonzero(codes == 0)
    below = np.count_nonzero(codes < lowest) - (at_0 if lowest > 0 else 0)
    if below > _MOST_BELOW * codes.size:
        raise InputError(
            "black_level",
            f"must be such that noise explains the codes below it ({noise.source})",
            value=noise.black_level_dn,
            found=f"{100 * below / codes.size:.3g} % of the pixels lie more than "
            f"{_FEWEST_SIGMAS:g} standard deviations of the dark noise below "
            f"{noise.black_level_dn:g} DN",
            remedy=Setting("black_level"),
        )
    white = noise.saturation_dn
    return {
        "code_0_share": at_0 / codes.size,
        "saturated_share": 0.0 if white is None else np.count_nonzero(codes >= white) / codes.size,
    }


def _rounded(
    values_e: Float32[Array, "h w"], plan: DenoisingPlan
) -> tuple[UInt16[Array, "h w"], float]:
    """Codes of the result, and the share of the pixels that were outside their range."""
    top = _TOP_CODE if plan.bits is None else 2**plan.bits - 1
    exact = np.rint(plan.noise.codes(values_e))
    outside = np.count_nonzero((exact < 0) | (exact > top)) / exact.size
    return np.clip(exact, 0, top).astype(np.uint16), outside


def _misfit_notes(done: DenoisedRaw, noise: CodeNoise) -> list[str]:
    """Warnings where the picture has less or more noise than expected, or none is measured."""
    low, high = _FITTING
    notes = []
    unknown = [done.names[i] for i in np.flatnonzero(np.isnan(done.measured))]
    if unknown:
        notes.append(
            f"the noise of {', '.join(unknown)} was not measured: the picture is too small, or has "
            "too few areas without saturated pixels"
        )
    for flags, text in (
        (
            done.measured < low,
            "which detail cannot explain: check gain, read noise and black level",
        ),
        (
            done.measured > high,
            "which fine detail in all of the picture can explain, or a wrong gain, read noise, "
            "black level, shape, mosaic or byte order",
        ),
    ):
        odd = [f"{done.names[i]} {done.measured[i]:.2f}" for i in np.flatnonzero(flags)]
        if odd:
            notes.append(
                f"where the picture is smoothest, neighboring pixels differ by {', '.join(odd)} "
                f"times what the expected noise gives, {text} ({noise.source})"
            )
    return notes


def _developed(
    plan: DenoisingPlan,
    maker: MatrixMaker,
    point: OperatingPoint,
    values_e: Float32[Array, "h w"],
    work: Work,
) -> Picture:
    mosaic, names = plan.mosaic, point.sensor.names
    bank = DEMOSAICING[plan.study.pictures[0].demosaic or "bilinear"](mosaic, point)
    tile = channel_tile(mosaic, names)
    rows, columns = tile.shape
    places = [divmod(i, columns) for i in range(tile.size)]
    means = np.array([values_e[r::rows, c::columns].mean(dtype=np.float64) for r, c in places])
    raw = RawPicture(
        operating_point=point,
        seed=0,
        frame=0,
        mosaic=mosaic,
        adc=Adc(bits=16, gain_e_per_dn=plan.noise.gain_e_per_dn),
        codes=np.broadcast_to(np.uint16(0), values_e.shape),  # not read: the electrons are given
        mean_e=np.array([means[tile.ravel() == i].mean() for i in range(len(names))]),
        above_full_well=np.zeros(len(names)),
        notes=(f"denoised: {plan.method.name}",),
    )
    return developed(
        raw, bank, matrix=maker(point), electrons=values_e, work=replace(work, executor=None)
    )


_ENDINGS = (".denoised.tiff", ".denoised.dng", ".png", ".xyz.tiff")


def refuse_other_denoised(plan: DenoisingPlan, folder: Path) -> None:
    """Raise an error if a folder holds other results, or outputs would replace a picture.

    Parameters
    ----------
    plan
        Of the picture to be written.

    Raises
    ------
    InputError
        If it does.
    """
    inputs = {true_path(one.path) for one in plan.pictures if isinstance(one, RawFrame)}
    for ending in _ENDINGS:
        if true_path(folder / f"{plan.stem}{ending}") in inputs:
            raise InputError(
                "folder",
                "must not hold the picture under the name of a result",
                value=str(folder),
                remedy="name another folder",
            )
    refuse_other_record(folder, plan.record())


def write_denoised(result: DenoisedPicture, folder: Path) -> tuple[list[str], list[str]]:
    """Write the codes as TIFF and DNG, the color as PNG and XYZ.

    Returns
    -------
    files, not_written
        Names of the files, and notes on a DNG that cannot be written.

    Raises
    ------
    InputError
        If a file cannot be written.

    Notes
    -----
    The DNG is a copy of an uncompressed DNG with the codes replaced: all tags stay, also
    NoiseProfile, which is that of the picture before denoising.
    """
    files, notes, stem = [], [], result.plan.stem
    if result.codes is not None:
        path = folder / f"{stem}.denoised.tiff"
        _write_codes(path, result.codes, result.plan)
        files.append(path.name)
        copied = folder / f"{stem}.denoised.dng"
        first = result.plan.pictures[0]
        if isinstance(first, RawFrame) and first.path.suffix.lower() == ".dng":
            if _write_copy(copied, first, result.codes):
                files.append(copied.name)
            else:
                notes.append("no DNG: its codes are compressed or linearized")
    if result.picture is not None:
        write_png(folder / f"{stem}.png", result.picture.srgb)
        observer = result.picture.matrix.observer
        write_xyz_tiff(folder / f"{stem}.xyz.tiff", result.picture.xyz, observer=observer)
        files += [f"{stem}.png", f"{stem}.xyz.tiff"]
    return files, notes


def _write_codes(path: Path, codes: UInt16[Array, "h w"], plan: DenoisingPlan) -> None:
    point, noise = plan.operating_point, plan.noise
    description = mosaic_description(
        sensor_name=plan.stem if point is None else point.sensor.name,
        bits=plan.bits,
        black_level_dn=noise.black_level_dn,
        gain_e_per_dn=noise.gain_e_per_dn,
        mosaic=plan.mosaic,
    )
    with tiff_rows(
        path,
        shape=codes.shape,
        dtype="uint16",
        photometric="minisblack",
        description=description,
    ) as put:
        put(0, codes)


def _write_copy(path: Path, frame: RawFrame, codes: UInt16[Array, "h w"]) -> bool:
    """Copy an uncompressed DNG with other codes; ``False`` for other files."""
    plane = frame.read
    if not isinstance(plane, StoredPlane) or plane.stored.itemsize != codes.itemsize:
        return False
    shutil.copyfile(frame.path, path)
    with path.open("r+b") as file:
        file.seek(plane.offset)
        file.write(codes.astype(plane.stored).data)
    return True
