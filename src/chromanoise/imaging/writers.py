"""Writing images to PNG and TIFF files.

The module ``dng`` writes raw files for other programs, ``row_files`` linear light. The functions
that end in ``_rows`` write images that are too large for memory. All functions overwrite an
existing file. With a path in the scratch folder of `whole_folder`, incomplete files are never
visible.
"""

import io
import json
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, UInt8, UInt16
from chromanoise.color import adapted_to_d65, srgb_from_xyz
from chromanoise.imaging.blocks import parts_of_rows
from chromanoise.imaging.render import Picture, RawPicture
from chromanoise.imaging.row_files import PutRows, tiff_rows, write_in_parts
from chromanoise.sensor import Adc, Mosaic
from chromanoise.spectra import DEFAULT_OBSERVER


def png_bytes(srgb: UInt8[Array, "h w 3"]) -> bytes:
    """The image as a PNG file in memory.

    Parameters
    ----------
    srgb
        Encoded R, G, B of each pixel, the channels last.
    """
    buffer = io.BytesIO()
    _write_png(buffer, srgb)
    return buffer.getvalue()


def write_png(path: Path, srgb: UInt8[Array, "h w 3"]) -> None:
    """8-bit sRGB as PNG.

    Parameters
    ----------
    srgb
        Encoded R, G, B of each pixel, the channels last.
    """
    with path.open("wb") as file:
        _write_png(file, srgb)


def _write_png(file: io.BytesIO | io.BufferedWriter, srgb: UInt8[Array, "h w 3"]) -> None:
    """Write a PNG; Pillow holds 4 bytes per pixel."""
    from PIL import Image

    image = Image.new("RGB", (srgb.shape[1], srgb.shape[0]))
    for start, rows in parts_of_rows(srgb):
        image.paste(Image.fromarray(rows), (0, start))
    image.save(file, format="PNG")


def sixteen_bit_srgb(
    xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]
) -> UInt16[Array, "*px 3"]:
    """Encoded sRGB, 0 .. 65535, white-balanced; colors out of gamut are clipped.

    Parameters
    ----------
    xyz
        Linear, Y = 1 for the white.
    white
        XYZ of a perfect white under the illuminant of the image.

    Raises
    ------
    InputError
        If the white is not valid for chromatic adaptation.

    Notes
    -----
    IEC 61966-2-1:1999, rounded to the nearest of 2^16 - 1 equal steps. The matrix in the
    standard has four digits, so the blue of a perfect white is 5 steps below the maximum.

    Examples
    --------
    >>> sixteen_bit_srgb(np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]), np.ones(3))
    array([[    0,     0,     0],
           [65535, 65535, 65530]], dtype=uint16)
    """
    encoded = srgb_from_xyz(adapted_to_d65(xyz.astype(np.float64), white))
    return np.round(65535 * encoded).astype(np.uint16)


def srgb_tiff_rows(path: Path, *, height: int, width: int) -> AbstractContextManager[PutRows]:
    """Write a 16-bit sRGB TIFF by rows [rows width 3] of `sixteen_bit_srgb`.

    Parameters
    ----------
    path
        An existing file is replaced.
    height, width
        [pixels]

    Raises
    ------
    InputError
        If the file cannot be written, or rows have a wrong shape or are missing at the end.
    """
    return tiff_rows(
        path,
        shape=(height, width, 3),
        dtype="uint16",
        photometric="rgb",
        description="sRGB (IEC 61966-2-1)",
    )


def write_srgb_tiff(path: Path, srgb: UInt16[Array, "h w 3"]) -> None:
    """Write a 16-bit sRGB TIFF; `srgb_tiff_rows` writes an image in parts.

    Parameters
    ----------
    srgb
        Encoded R, G, B of each pixel, the channels last.
    """
    height, width = srgb.shape[:2]
    write_in_parts(srgb_tiff_rows(path, height=height, width=width), srgb)


def xyz_tiff_rows(
    path: Path, *, height: int, width: int, observer: str = DEFAULT_OBSERVER
) -> AbstractContextManager[PutRows]:
    """Write a float32 TIFF of linear XYZ, Y = 1 for a perfect white, by rows.

    Parameters
    ----------
    path
        An existing file is replaced.
    height, width
        [pixels]
    observer
        Of the colors; recorded in the file where it is not CIE 1931.

    Raises
    ------
    InputError
        If the file cannot be written, or rows have a wrong shape or are missing at the end.
    """
    of = "" if observer == DEFAULT_OBSERVER else f" of the observer {observer}"
    return tiff_rows(
        path,
        shape=(height, width, 3),
        dtype="float32",
        photometric="rgb",
        description=f"linear CIE XYZ{of}, Y = 1 for a perfect white",
    )


def write_xyz_tiff(
    path: Path, xyz: Float[Array, "h w 3"], *, observer: str = DEFAULT_OBSERVER
) -> None:
    """Write linear XYZ as a float32 TIFF, h x w x 3; parameters as `xyz_tiff_rows`.

    Parameters
    ----------
    xyz
        X, Y, Z of each pixel, the coordinates last. [lx]
    observer
        The observer of the colors.
    """
    height, width = xyz.shape[:2]
    write_in_parts(
        xyz_tiff_rows(path, height=height, width=width, observer=observer),
        xyz,
        encoded=lambda rows: rows.astype(np.float32, copy=False),
    )


def mosaic_tiff_rows(
    path: Path, *, height: int, width: int, sensor_name: str, mosaic: Mosaic, adc: Adc
) -> AbstractContextManager[PutRows]:
    """Write a 16-bit gray TIFF of the codes of any mosaic by rows.

    Its description is JSON: sensor, bits, black level, gain and the pattern of the mosaic, which
    starts at the first pixel of the file.

    Parameters
    ----------
    path
        An existing file is replaced.
    height, width
        [pixels]
    sensor_name, mosaic, adc
        Content of the description; the codes are written unchanged.

    Raises
    ------
    InputError
        If the file cannot be written, or rows have a wrong shape or are missing at the end.
    """
    return tiff_rows(
        path,
        shape=(height, width),
        dtype="uint16",
        photometric="minisblack",
        description=mosaic_description(
            sensor_name=sensor_name,
            bits=adc.bits,
            black_level_dn=adc.black_level_dn,
            gain_e_per_dn=adc.gain_e_per_dn,
            mosaic=mosaic,
        ),
    )


def mosaic_description(
    *,
    sensor_name: str,
    bits: int | None,
    black_level_dn: float,
    gain_e_per_dn: float,
    mosaic: Mosaic,
) -> str:
    """The description of a TIFF of raw codes, as JSON.

    Parameters
    ----------
    sensor_name
        Name of the camera.
    bits
        Of the codes; ``None`` if not known.
    black_level_dn
        Code without light. [DN]
    gain_e_per_dn
        Electrons per code. [e-/DN]
    mosaic
        Its pattern starts at the first pixel.
    """
    description = {
        "sensor": sensor_name,
        "bits": bits,
        "black_level_dn": black_level_dn,
        "gain_e_per_dn": gain_e_per_dn,
        "pattern": mosaic.pattern,
    }
    return json.dumps(description, ensure_ascii=False)


def write_mosaic_tiff(
    path: Path, codes: UInt16[Array, "h w"], *, sensor_name: str, mosaic: Mosaic, adc: Adc
) -> None:
    """Write codes of a mosaic as a 16-bit gray TIFF; see `mosaic_tiff_rows` for its description.

    Parameters
    ----------
    codes
        Codes of the converter. [DN]
    sensor_name
        Name for the description of the file.
    mosaic
        Which channel each pixel has.
    adc
        Black level, gain and bits for the description.
    """
    height, width = codes.shape
    file = mosaic_tiff_rows(
        path, height=height, width=width, sensor_name=sensor_name, mosaic=mosaic, adc=adc
    )
    write_in_parts(file, codes)


def picture_summary(
    picture: Picture, *, seconds: Mapping[str, float] | None = None
) -> dict[str, Any]:
    """Summary of an image as plain data.

    Parameters
    ----------
    seconds
        Duration of each step, if measured; the only entry that differs between equal runs. [s]
    """
    first = {"metric": picture.metric, "observer": picture.matrix.observer}
    last = {"clipped": picture.clipped, "white_xyz": [float(v) for v in picture.white]}
    return _summary(picture, picture.xyz.shape, first, last, seconds)


def raw_summary(
    picture: RawPicture, *, seconds: Mapping[str, float] | None = None
) -> dict[str, Any]:
    """Summary of a raw image as plain data.

    Parameters
    ----------
    seconds
        Duration of each step, if measured; the only entry that differs between equal runs. [s]
    """
    first = {
        "mosaic": [list(row) for row in picture.mosaic.pattern],
        "bits": picture.adc.bits,
        "gain_e_per_dn": picture.adc.gain_e_per_dn,
        "black_level_dn": picture.adc.black_level_dn,
    }
    return _summary(picture, picture.codes.shape, first, {}, seconds)


def _summary(
    picture: Picture | RawPicture,
    shape: tuple[int, ...],
    first: Mapping[str, Any],
    last: Mapping[str, Any],
    seconds: Mapping[str, float] | None,
) -> dict[str, Any]:
    """What both kinds have, around the first and the last entries of their own."""
    point = picture.operating_point

    def by_channel(values: Float[Array, " p"]) -> dict[str, float]:
        return dict(zip(point.sensor.names, (float(v) for v in values), strict=True))

    return {
        "sensor": point.sensor.name,
        "label": point.sensor.label,
        "height_px": shape[0],
        "width_px": shape[1],
        "time_ms": 1e3 * point.exposure.time_s,
        "f_number": point.exposure.f_number,
        "illuminant": point.illuminant.name,
        "level_lux": point.level_lux,
        **first,
        "seed": picture.seed,
        "frame": picture.frame,
        "mean_e": by_channel(picture.mean_e),
        "above_full_well_share": by_channel(picture.above_full_well),
        **last,
        "notes": list(picture.notes),
        **({} if seconds is None else {"seconds": dict(seconds)}),
    }
