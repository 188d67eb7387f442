"""Pictures to files."""

import io
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8

from chromanoise._check import Array
from chromanoise.imaging.render import Picture


def png_bytes(srgb: UInt8[Array, "h w 3"]) -> bytes:
    """The picture as a PNG file in memory."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(srgb).save(buffer, format="PNG")
    return buffer.getvalue()


def write_png(path: Path, srgb: UInt8[Array, "h w 3"]) -> None:
    """8-bit sRGB as PNG."""
    path.write_bytes(png_bytes(srgb))


def write_xyz_tiff(path: Path, xyz: Float[Array, "h w 3"]) -> None:
    """Linear XYZ as a float32 TIFF, h x w x 3, Y = 1 for a perfect white."""
    import tifffile

    tifffile.imwrite(
        path,
        xyz.astype(np.float32),
        photometric="rgb",
        description="linear CIE XYZ, Y = 1 for a perfect white",
        software="chromanoise",
        metadata=None,
    )


def picture_summary(picture: Picture) -> dict[str, Any]:
    """How a picture was made, as plain data."""
    names = picture.sensor.names

    def named(values: Float[Array, " p"]) -> dict[str, float]:
        return dict(zip(names, (float(v) for v in values), strict=True))

    return {
        "sensor": picture.sensor.name,
        "height_px": picture.xyz.shape[0],
        "width_px": picture.xyz.shape[1],
        "time_ms": 1e3 * picture.exposure.time_s,
        "f_number": picture.exposure.f_number,
        "illuminant": picture.illuminant.name,
        "level_lux": picture.level_lux,
        "metric": picture.metric,
        "seed": picture.seed,
        "mean_e": named(picture.mean_e),
        "above_full_well_share": named(picture.above_full_well),
        "clipped": picture.clipped,
        "white_xyz": [float(v) for v in picture.white],
        "notes": list(picture.notes),
    }
