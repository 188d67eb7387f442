"""Linear light as OpenEXR, float32 or half, without clipping.

The files are written by the library `OpenEXR` of the Academy Software Foundation (extra ``exr``),
which needs the whole image in memory.
"""

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.color import linear_srgb
from chromanoise.errors import InputError, Setting

REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
"""x, y of red, green, blue and white of sRGB (ITU-R BT.709-6, table 1)."""
CIE_XYZ = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)
"""The axes X, Y, Z as primaries: channels R, G, B of such a file are X, Y, Z."""

_LARGEST_HALF = 65504.0  # IEEE 754 binary16


def write_linear_exr(
    path: Path, xyz: Float[Array, "h w 3"], white: Float[Array, " 3"], *, half: bool = False
) -> None:
    """Linear sRGB (Rec. 709 primaries), white-balanced, white 1; negative noise is kept.

    Parameters
    ----------
    path
        An existing file is replaced.
    xyz
        Linear, Y = 1 for the white.
    white
        XYZ of a perfect white under the illuminant of the image.
    half
        Use 16-bit floats: half the size, and a relative error of up to 2^-11.

    Raises
    ------
    InputError
        If OpenEXR is not installed, a value is not finite or too large for half, the white is
        not valid for chromatic adaptation, or the file cannot be written.
    """
    color = linear_srgb(xyz.astype(np.float64), white)
    _write_rgb(path, color, half, {"chromaticities": REC709})


def write_xyz_exr(
    path: Path, xyz: Float[Array, "h w 3"], white: Float[Array, " 3"], *, half: bool = False
) -> None:
    """XYZ unchanged, in the channels R, G, B of a file whose primaries are X, Y and Z.

    The chromaticity of ``white`` is stored as ``adoptedNeutral``, so readers can white-balance.

    Parameters
    ----------
    path, xyz, white, half
        As `write_linear_exr`; no chromatic adaptation is applied.

    Raises
    ------
    InputError
        As `write_linear_exr`.
    """
    sees = _check.finite("white XYZ", "that of the picture", white)
    if not sees.sum() > 0:
        raise InputError(str(path), "white must have X + Y + Z > 0", value=sees.tolist())
    neutral = tuple(float(v) for v in sees[:2] / sees.sum())
    _write_rgb(path, xyz, half, {"chromaticities": CIE_XYZ, "adoptedNeutral": neutral})


def _write_rgb(
    path: Path, color: Float[Array, "h w 3"], half: bool, attributes: dict[str, Any]
) -> None:
    library = openexr()
    if not color.size:
        raise InputError(
            str(path),
            "must have at least one pixel",
            value=color.shape,
            found=f"has shape {color.shape}",
        )
    if not np.isfinite(color).all():
        _check.finite(f"color of {path}", "1", color)
    if half and (largest := float(np.abs(color).max())) > _LARGEST_HALF:
        raise InputError(
            str(path),
            f"must have values up to {_LARGEST_HALF:g} in half floats",
            value=largest,
            found=f"has values up to {largest:g}",
            remedy=Setting("half", (False,)),
        )
    kept = np.ascontiguousarray(color, dtype=np.float16 if half else np.float32)
    header = {
        "compression": library.ZIP_COMPRESSION,
        "type": library.scanlineimage,
        "software": "chromanoise",
        **attributes,
    }
    try:
        with library.File(header, {"RGB": kept}) as file:
            file.write(str(path))
    except (RuntimeError, OSError) as error:
        raise InputError(str(path), f"cannot be written ({error})") from None


def openexr() -> Any:
    """The imported package OpenEXR.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        return import_module("OpenEXR")
    except ImportError:
        raise InputError(
            "EXR files",
            "need the package OpenEXR, which is not installed",
            remedy=("install it with pip install 'chromanoise[exr]'", "write TIFF"),
        ) from None
