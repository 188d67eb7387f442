"""Pictures to files.

PNG and TIFF stand here; `chromanoise.imaging.dng` has raw files that other programs develop,
`chromanoise.imaging.exr` linear light. A file that is too large for memory is written through the
functions that end in ``_rows``. All go to a path that may be replaced: give one in the scratch
folder of `chromanoise._files.whole_folder`, and nothing half-written is ever seen.
"""

import io
import json
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float, UInt8, UInt16
from chromanoise.color import adapted_to_d65, srgb_from_xyz
from chromanoise.exposure import OperatingPoint
from chromanoise.imaging.render import Picture, RawPicture
from chromanoise.imaging.row_files import PutRows, tiff_rows
from chromanoise.sensor import Adc, Mosaic


def png_bytes(srgb: UInt8[Array, "h w 3"]) -> bytes:
    """The picture as a PNG file in memory."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(srgb).save(buffer, format="PNG")
    return buffer.getvalue()


def write_png(path: Path, srgb: UInt8[Array, "h w 3"]) -> None:
    """8-bit sRGB as PNG."""
    path.write_bytes(png_bytes(srgb))


def sixteen_bit_srgb(
    xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]
) -> UInt16[Array, "*px 3"]:
    """Encoded sRGB, 0 .. 65535, white-balanced; colors out of gamut held at its border.

    Parameters
    ----------
    xyz
        Linear, Y = 1 for the white.
    white
        XYZ of a perfect white in the picture's light.

    Raises
    ------
    InputError
        If the white is no color that an eye could adapt to.

    Notes
    -----
    IEC 61966-2-1:1999, rounded to the nearest of 2^16 - 1 equal steps. Its printed matrix has four
    digits: the blue of a perfect white stays 5 steps below the top.

    Examples
    --------
    >>> sixteen_bit_srgb(np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]), np.ones(3))
    array([[    0,     0,     0],
           [65535, 65535, 65530]], dtype=uint16)
    """
    encoded = srgb_from_xyz(adapted_to_d65(xyz.astype(np.float64), white))
    return np.round(65535 * encoded).astype(np.uint16)


def srgb_tiff_rows(path: Path, *, height: int, width: int) -> AbstractContextManager[PutRows]:
    """A 16-bit sRGB TIFF to be filled with rows [rows width 3] of `sixteen_bit_srgb`.

    Parameters
    ----------
    path
        A file that may be replaced.
    height, width
        [pixels]

    Raises
    ------
    InputError
        If the file cannot be written, or rows do not fit or are missing at the end.
    """
    return tiff_rows(
        path,
        shape=(height, width, 3),
        dtype="uint16",
        photometric="rgb",
        description="sRGB (IEC 61966-2-1)",
    )


def write_srgb_tiff(path: Path, srgb: UInt16[Array, "h w 3"]) -> None:
    """16-bit sRGB as TIFF; see `srgb_tiff_rows` for a picture that comes in parts."""
    with srgb_tiff_rows(path, height=srgb.shape[0], width=srgb.shape[1]) as put:
        put(0, srgb)


def xyz_tiff_rows(path: Path, *, height: int, width: int) -> AbstractContextManager[PutRows]:
    """A float32 TIFF of linear XYZ, Y = 1 for a perfect white, to be filled with rows.

    Parameters
    ----------
    path
        A file that may be replaced.
    height, width
        [pixels]

    Raises
    ------
    InputError
        If the file cannot be written, or rows do not fit or are missing at the end.
    """
    return tiff_rows(
        path,
        shape=(height, width, 3),
        dtype="float32",
        photometric="rgb",
        description="linear CIE XYZ, Y = 1 for a perfect white",
    )


def write_xyz_tiff(path: Path, xyz: Float[Array, "h w 3"]) -> None:
    """Linear XYZ as a float32 TIFF, h x w x 3, Y = 1 for a perfect white."""
    with xyz_tiff_rows(path, height=xyz.shape[0], width=xyz.shape[1]) as put:
        put(0, xyz.astype(np.float32))


def mosaic_tiff_rows(
    path: Path, *, height: int, width: int, sensor_name: str, mosaic: Mosaic, adc: Adc
) -> AbstractContextManager[PutRows]:
    """A 16-bit gray TIFF of codes under any mosaic, to be filled with rows.

    Its description is JSON: sensor, bits, black level, gain and the pattern of the mosaic, whose
    first pixel is that of the file.

    Parameters
    ----------
    path
        A file that may be replaced.
    height, width
        [pixels]
    sensor_name, mosaic, adc
        What the description tells; the codes are written as they are.

    Raises
    ------
    InputError
        If the file cannot be written, or rows do not fit or are missing at the end.
    """
    told = {
        "sensor": sensor_name,
        "bits": adc.bits,
        "black_level_dn": adc.black_level_dn,
        "gain_e_per_dn": adc.gain_e_per_dn,
        "pattern": mosaic.pattern,
    }
    return tiff_rows(
        path,
        shape=(height, width),
        dtype="uint16",
        photometric="minisblack",
        description=json.dumps(told, ensure_ascii=False),
    )


def write_mosaic_tiff(
    path: Path, codes: UInt16[Array, "h w"], *, sensor_name: str, mosaic: Mosaic, adc: Adc
) -> None:
    """Codes under a mosaic as 16-bit gray TIFF; see `mosaic_tiff_rows` for what it tells."""
    height, width = codes.shape
    with mosaic_tiff_rows(
        path, height=height, width=width, sensor_name=sensor_name, mosaic=mosaic, adc=adc
    ) as put:
        put(0, codes)


def picture_summary(
    picture: Picture, *, seconds: Mapping[str, float] | None = None
) -> dict[str, Any]:
    """How a picture was made, as plain data.

    Parameters
    ----------
    picture
        Any picture.
    seconds
        How long each step took, where that was measured: the only entry that a rerun changes. [s]
    """
    return {
        **_situation_summary(picture.operating_point, picture.xyz.shape[:2]),
        "metric": picture.metric,
        "seed": picture.seed,
        "frame": picture.frame,
        "mean_e": _by_channel(picture.operating_point, picture.mean_e),
        "above_full_well_share": _by_channel(picture.operating_point, picture.above_full_well),
        "clipped": picture.clipped,
        "white_xyz": [float(v) for v in picture.white],
        "notes": list(picture.notes),
        **({} if seconds is None else {"seconds": dict(seconds)}),
    }


def raw_summary(
    picture: RawPicture, *, seconds: Mapping[str, float] | None = None
) -> dict[str, Any]:
    """How a raw picture was made, as plain data.

    Parameters
    ----------
    picture
        Any raw picture.
    seconds
        How long each step took, where that was measured: the only entry that a rerun changes. [s]
    """
    return {
        **_situation_summary(picture.operating_point, picture.codes.shape),
        "mosaic": [list(row) for row in picture.mosaic.pattern],
        "bits": picture.adc.bits,
        "gain_e_per_dn": picture.adc.gain_e_per_dn,
        "black_level_dn": picture.adc.black_level_dn,
        "seed": picture.seed,
        "frame": picture.frame,
        "mean_e": _by_channel(picture.operating_point, picture.mean_e),
        "above_full_well_share": _by_channel(picture.operating_point, picture.above_full_well),
        "notes": list(picture.notes),
        **({} if seconds is None else {"seconds": dict(seconds)}),
    }


def _situation_summary(operating_point: OperatingPoint, size: tuple[int, ...]) -> dict[str, Any]:
    return {
        "sensor": operating_point.sensor.name,
        "height_px": size[0],
        "width_px": size[1],
        "time_ms": 1e3 * operating_point.exposure.time_s,
        "f_number": operating_point.exposure.f_number,
        "illuminant": operating_point.illuminant.name,
        "level_lux": operating_point.level_lux,
    }


def _by_channel(operating_point: OperatingPoint, values: Float[Array, " p"]) -> dict[str, float]:
    return dict(zip(operating_point.sensor.names, (float(v) for v in values), strict=True))
