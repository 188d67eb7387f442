"""Raw images as DNG, the format that raw developers open.

The file is a plain TIFF with tags for the mosaic, the range of the codes, the matrix from XYZ to
the camera and the noise. Only files that LibRaw (through rawpy) reads correctly are written: it
supports mosaics that repeat in 2 columns and 1, 2 or 4 rows, or in 6 x 6 of red, green and blue. It
opens any other mosaic with wrong colors and without an error, so these are refused here.

Adobe, Digital Negative (DNG) Specification, 1.4.0.0 (2012); tag numbers are those of its chapter 4.
"""

import math
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, InputError, UInt16, check, dataclass, matrix_rank, pinv
from chromanoise.color import ColorMatrix
from chromanoise.imaging.row_files import PutRows, tiff_rows, write_in_parts
from chromanoise.noise import OperatingPoint, expected_electrons, noise_sources, white_scene
from chromanoise.sensor import Adc, Mosaic, shot_and_dark

_COLOR_CODES = {"R": 0, "G": 1, "B": 2, "C": 3, "M": 4, "Y": 5, "W": 6}  # tag 50710
_LIGHT_SOURCES = {"A": 17, "D55": 20, "D65": 21, "D75": 22, "D50": 23}  # Exif LightSource
_UNKNOWN_LIGHT = 0
_READABLE_REPEATS = ((2, 2), (4, 2), (6, 6))  # rows, columns
_SIDES = (22, 64_000)  # smallest and largest that LibRaw opens
_LARGEST_BYTES = 2**32 - 2**20  # offsets have 32 bits; the tags need some of the space
_TIFF = "write the mosaic as TIFF"
_PARTS = 1_000_000  # denominator of all fractions
_BYTE, _ASCII, _SHORT, _LONG, _RATIONAL, _SIGNED_RATIONAL, _DOUBLE = 1, 2, 3, 4, 5, 10, 12


@dataclass(frozen=True, kw_only=True, eq=False)
class RawProfile:
    """Metadata of a camera and its illuminant for raw developers.

    Attributes
    ----------
    sensor_name
        Name of the camera.
    channels
        3 or 4 of R, G, B, C, M, Y, W: all channels of the mosaic, in the order of the arrays.
    mosaic
        The channel of each pixel.
    adc
        Converter, with black level and top code.
    white_level_dn
        Code of a full pixel, or the top code if that is lower. [DN]
    color_matrix
        From XYZ (Y = 1 for a perfect white) to the channels, in any unit common to them.
    as_shot_neutral
        Channel values of a gray, scaled to a maximum of 1.
    noise_profile
        S and O of each channel, variance = S x + O, with x = 0 at black and 1 at the white level.
    illuminant
        The illuminant for which ``color_matrix`` was made.

    Raises
    ------
    InputError
        If a value cannot be stored in a DNG, or LibRaw would misread it.
    """

    sensor_name: str
    channels: tuple[str, ...]
    mosaic: Mosaic
    adc: Adc
    white_level_dn: int
    color_matrix: Float[Array, "p 3"]
    as_shot_neutral: Float[Array, " p"]
    noise_profile: Float[Array, "p 2"]
    illuminant: str

    def __post_init__(self) -> None:
        _refuse_unsupported_channels(self.sensor_name, self.channels, self.mosaic)
        p = len(self.channels)
        for name, wanted in (
            ("color_matrix", (p, 3)),
            ("as_shot_neutral", (p,)),
            ("noise_profile", (p, 2)),
        ):
            own = check.finite(f"{name} of {self.sensor_name}", "1", getattr(self, name))
            if own.shape != wanted:
                raise InputError(
                    f"{name} of {self.sensor_name}",
                    f"must have shape {wanted}",
                    value=own.shape,
                    found=f"has {own.shape}",
                )
        _refuse_unsupported_numbers(self)
        check.freeze(self, "color_matrix", "as_shot_neutral", "noise_profile")


def raw_profile(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    *,
    mosaic: Mosaic,
    adc: Adc,
) -> RawProfile:
    """DNG metadata of an operating point, for the same color as this package computes.

    Parameters
    ----------
    operating_point
        A sensor with channels R, G, B and optionally one more, under the illuminant of the image;
        an illuminant without an Exif number is written as unknown.
    matrix
        Matrix from electrons to XYZ for this illuminant.
    mosaic, adc
        Those of the codes. NoiseProfile includes the noise of the pixel in the dark; it has no term
        for PRNU.

    Raises
    ------
    InputError
        If a perfect white gives no electrons, or `RawProfile` refuses a value.
    """
    sensor, lamp = operating_point.sensor, operating_point.illuminant
    check.same_names("DNG", sensor=sensor.names, matrix=matrix.channels)
    white = expected_electrons(white_scene(operating_point), sensor, operating_point.exposure)
    if not white.max() > 0:
        raise InputError(
            sensor.name,
            f"must give electrons for a perfect white under {lamp.name}",
            value=float(white.max()),
            found="gives none",
        )
    white_level_dn = _white_level_dn(operating_point, adc)
    gain = adc.gain_e_per_dn
    noise = replace(noise_sources(sensor, operating_point.exposure), step_e=gain).law()
    of_range = noise.in_units_of(gain * (white_level_dn - adc.black_level_dn))
    return RawProfile(
        sensor_name=sensor.name,
        channels=sensor.names,
        mosaic=mosaic,
        adc=adc,
        white_level_dn=white_level_dn,
        color_matrix=camera_matrix(matrix.matrix, white),
        as_shot_neutral=white / white.max(),
        noise_profile=np.tile(shot_and_dark(of_range), (len(sensor.names), 1)),
        illuminant=lamp.name,
    )


def _white_level_dn(operating_point: OperatingPoint, adc: Adc) -> int:
    """Code of full well minus dark electrons, or the top code if that is lower.

    Raises
    ------
    InputError
        If a full pixel and a dark pixel have the same code.
    """
    sensor = operating_point.sensor
    dark_e = sensor.pixel.dark_electrons_e(time_s=operating_point.exposure.time_s)
    full_dn = adc.black_level_dn + (sensor.pixel.full_well_e - dark_e) / adc.gain_e_per_dn
    white_level_dn = math.floor(min(full_dn + 0.5, adc.top_code))
    if white_level_dn <= adc.black_level_dn:
        raise InputError(
            sensor.name,
            f"code of full well must be above the black level {adc.black_level_dn} [DN]",
            value=white_level_dn,
            remedy=f"lower the gain of {adc.gain_e_per_dn:g} e-/DN",
        )
    return white_level_dn


def camera_matrix(to_xyz: Float[Array, "3 p"], white: Float[Array, " p"]) -> Float[Array, "p 3"]:
    """The matrix from XYZ to the channels, which a reader inverts to obtain ``to_xyz``.

    Parameters
    ----------
    to_xyz
        Matrix from the channels to XYZ, of rank 3.
    white
        Channel values of a perfect white; the result is scaled to a maximum of 1 at Y = 1.

    Raises
    ------
    InputError
        If ``to_xyz`` has a rank below 3, or the white has no luminance.

    Notes
    -----
    DNG 1.4, chapter 6, takes the (pseudo-)inverse of ColorMatrix1, and the pseudo-inverse of a
    pseudo-inverse is the matrix itself. LibRaw first scales each row to the white, which for
    four channels gives another inverse: its grays are correct, but its colors differ from those of
    ``to_xyz``. No ColorMatrix1 can make both correct.

    Examples
    --------
    >>> camera_matrix(np.diag([0.5, 1.0, 0.25]), np.array([2.0, 1.0, 4.0])).round(3)
    array([[0.5 , 0.  , 0.  ],
           [0.  , 0.25, 0.  ],
           [0.  , 0.  , 1.  ]])
    """
    rank = matrix_rank("matrix of a DNG", to_xyz)
    if rank < 3:
        raise InputError(
            "matrix to XYZ",
            "must have rank 3 for a DNG, which needs its inverse",
            value=rank,
            found=f"has rank {rank}",
            remedy="take a sensor with three channels that differ",
        )
    luminance = to_xyz[1] @ white
    if not luminance > 0:
        raise InputError(
            "white of a DNG",
            "must have a luminance > 0 [lx]",
            value=float(luminance),
            found=f"has {luminance:g} lx",
        )
    return pinv("matrix of a DNG", to_xyz) * (luminance / white.max())


def dng_rows(
    path: Path, *, height: int, width: int, profile: RawProfile
) -> AbstractContextManager[PutRows]:
    """Write an uncompressed 16-bit DNG by rows of codes [rows width], uint16.

    Parameters
    ----------
    path
        A file that may be replaced.
    height, width
        [pixels] 22 to 64,000 each, the range that LibRaw opens.
    profile
        Metadata for raw developers.

    Raises
    ------
    InputError
        If the size is out of range, the file cannot be written, or rows have a wrong shape or are
        missing at the end.
    """
    refuse_dng_size(str(path), height=height, width=width)
    return tiff_rows(
        path,
        shape=(height, width),
        dtype="uint16",
        photometric="cfa",
        description=f"raw of {profile.sensor_name}",
        extratags=_tags(profile),
    )


def refuse_dng_size(name: str, *, height: int, width: int) -> None:
    """Check the size of a DNG before the image is computed.

    Raises
    ------
    InputError
        If a side is shorter than 22 or longer than 64,000 pixels, or the file would exceed 4 GiB.
    """
    if not all(_SIDES[0] <= side <= _SIDES[1] for side in (height, width)):
        raise InputError(
            name,
            f"must have {_SIDES[0]} to {_SIDES[1]} pixels a side, which readers of DNG open",
            value=(height, width),
            found=f"has {height} x {width}",
            remedy=_TIFF,
        )
    if 2 * height * width > _LARGEST_BYTES:
        raise InputError(
            name,
            "must be at most 4 GiB as a DNG",
            value=2 * height * width,
            found=f"{height} x {width} pixels take {2 * height * width / 2**30:.1f}",
            remedy=_TIFF,
        )


def write_dng(path: Path, codes: UInt16[Array, "h w"], profile: RawProfile) -> None:
    """Write codes of a mosaic as DNG; `dng_rows` writes an image in parts.

    Parameters
    ----------
    codes
        Codes of the converter. [DN]
    profile
        Color and noise of the camera for the tags.
    """
    height, width = codes.shape
    write_in_parts(dng_rows(path, height=height, width=width, profile=profile), codes)


def _tags(profile: RawProfile) -> tuple[tuple[Any, ...], ...]:
    """(number, type, count, value, written once) of each tag that a plain TIFF lacks."""
    order = sorted(range(len(profile.channels)), key=lambda i: _COLOR_CODES[profile.channels[i]])
    planes = bytes(_COLOR_CODES[profile.channels[i]] for i in order)
    pattern = _readable_pattern(profile.sensor_name, profile.mosaic)
    name = profile.sensor_name.encode("ascii", "replace").decode()
    light = _LIGHT_SOURCES.get(profile.illuminant, _UNKNOWN_LIGHT)
    matrix = _fractions(profile.color_matrix[order])
    neutral = _fractions(profile.as_shot_neutral[order])
    noise = tuple(float(v) for v in profile.noise_profile[order].ravel())
    return tuple(
        (number, kind, count, value, True)
        for number, kind, count, value in (
            (271, _ASCII, 0, "chromanoise"),  # Make
            (272, _ASCII, 0, name),  # Model
            (274, _SHORT, 1, 1),  # Orientation: as stored
            (33421, _SHORT, 2, pattern.shape),  # CFARepeatPatternDim
            (33422, _BYTE, pattern.size, pattern.tobytes()),  # CFAPattern
            (50706, _BYTE, 4, bytes([1, 4, 0, 0])),  # DNGVersion
            (50707, _BYTE, 4, bytes([1, 1, 0, 0])),  # DNGBackwardVersion: the oldest that suffices
            (50708, _ASCII, 0, f"chromanoise {name}"),  # UniqueCameraModel
            (50710, _BYTE, len(planes), planes),  # CFAPlaneColor
            (50711, _SHORT, 1, 1),  # CFALayout: rectangular
            (50713, _SHORT, 2, (1, 1)),  # BlackLevelRepeatDim
            (50714, _LONG, 1, profile.adc.black_level_dn),  # BlackLevel
            (50717, _LONG, 1, profile.white_level_dn),  # WhiteLevel
            (50721, _SIGNED_RATIONAL, len(matrix) // 2, matrix),  # ColorMatrix1
            (50728, _RATIONAL, len(neutral) // 2, neutral),  # AsShotNeutral
            (50778, _SHORT, 1, light),  # CalibrationIlluminant1
            (51041, _DOUBLE, len(noise), noise),  # NoiseProfile
        )
    )


def _fractions(values: Array) -> tuple[int, ...]:
    """Numerator, denominator, numerator, .."""
    return tuple(part for v in values.ravel() for part in (round(float(v) * _PARTS), _PARTS))


def _readable_pattern(sensor_name: str, mosaic: Mosaic) -> Array:
    """Color codes in the first block size of LibRaw that is a multiple of the mosaic period."""
    own = np.array([[_COLOR_CODES[name] for name in row] for row in mosaic.pattern], np.uint8)
    for rows, columns in _READABLE_REPEATS:
        if rows == 6 and set(mosaic.names) != {"R", "G", "B"}:
            continue
        again = (rows * own.shape[0], columns * own.shape[1])  # a common multiple of both
        tiled = np.tile(own, (rows, columns))
        block = tiled[:rows, :columns]
        if (tiled == np.tile(block, (again[0] // rows, again[1] // columns))).all():
            return block.copy()
    raise InputError(
        sensor_name,
        "must have a mosaic that repeats in 2 columns and 1, 2 or 4 rows, or in 6 x 6 of R, G, "
        "B, which readers of DNG support",
        value=own.shape,
        found=f"has one that repeats in {own.shape[0]} rows and {own.shape[1]} columns",
        remedy=_TIFF,
    )


def _refuse_unsupported_channels(
    sensor_name: str, channels: tuple[str, ...], mosaic: Mosaic
) -> None:
    check.distinct(f"channels of {sensor_name}", channels)
    unknown = [name for name in channels if name not in _COLOR_CODES]
    if unknown:
        raise InputError(
            sensor_name,
            f"must have channels that a DNG supports ({', '.join(_COLOR_CODES)})",
            value=tuple(unknown),
            found=f"has {', '.join(unknown)}",
            remedy=_TIFF,
        )
    if set(channels) != set(mosaic.names) or not 3 <= len(channels) <= 4:
        raise InputError(
            sensor_name,
            "must have 3 or 4 channels for a DNG, all of them in the mosaic",
            value=channels,
            found=f"has {', '.join(channels)}, and the mosaic {', '.join(mosaic.names)}",
            remedy=_TIFF,
        )
    _readable_pattern(sensor_name, mosaic)


def _refuse_unsupported_numbers(profile: RawProfile) -> None:
    """Refuse values that 32-bit fractions cannot represent, or an invalid noise profile."""
    name = profile.sensor_name
    largest = float(np.abs(profile.color_matrix).max())
    if not largest < 2**31 / _PARTS:
        raise InputError(
            name,
            f"matrix entries must be below {2**31 // _PARTS} in a DNG",
            value=largest,
            found=f"the largest is {largest:g}",
            remedy=("take channels that differ more", "scale them to a white of 1"),
        )
    neutral = profile.as_shot_neutral
    if not ((neutral >= 1 / _PARTS) & (neutral <= 1)).all():
        raise InputError(
            name,
            f"as_shot_neutral must be {1 / _PARTS:g} .. 1",
            value=neutral.tolist(),
            remedy="divide the values of a gray by the largest",
        )
    if not (profile.noise_profile > 0).all():
        raise InputError(
            name,
            "S and O of the noise profile must be > 0, as rounding alone is",
            value=float(profile.noise_profile.min()),
            found=f"the least is {profile.noise_profile.min():g}",
        )
