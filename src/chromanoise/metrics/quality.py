"""All errors of a picture relative to its reference, as the denoising benchmark reports them."""

from dataclasses import dataclass

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.color import LUMA_WEIGHTS, cielab, encoded_srgb
from chromanoise.metrics.pictures import (
    FalseColor,
    false_color,
    near_edges,
    picture_color_difference,
    psnr_db,
    same_pictures,
    structural_similarity,
)
from chromanoise.metrics.scielab import scielab_difference


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureQuality:
    """Errors of a picture relative to its reference.

    Attributes
    ----------
    psnr_db
        `psnr_db` of encoded sRGB clipped to 0 .. 1, all channels together; infinite for equal
        pictures. [dB]
    ssim
        `structural_similarity` of the luma (ITU-R BT.709-6) of encoded sRGB clipped to 0 .. 1. [1]
    ciede2000_mean, ciede2000_p95
        Mean and 95th percentile of CIEDE2000 over the pixels. [1]
    scielab_mean, scielab_p95
        Mean and 95th percentile of the S-CIELAB difference (CIE 1976). [Delta E*ab]
    false_color
        Chromatic error near edges and elsewhere; ``None`` if the reference has no edge.
    """

    psnr_db: float
    ssim: float
    ciede2000_mean: float
    ciede2000_p95: float
    scielab_mean: float
    scielab_p95: float
    false_color: FalseColor | None


def picture_quality(
    xyz: Float[Array, "h w 3"],
    reference: Float[Array, "h w 3"],
    white: Float[Array, " 3"],
    *,
    pixels_per_degree: float,
) -> PictureQuality:
    """Errors of a picture relative to its noise-free reference.

    Parameters
    ----------
    xyz, reference
        XYZ of CIE 1931 in the unit of ``white``, at least 11 x 11 pixels; may be negative.
    white
        XYZ of a perfect white in the same light.
    pixels_per_degree
        Resolution at the viewing distance, for S-CIELAB. [1/deg]

    Raises
    ------
    InputError
        As `picture_color_difference`, `structural_similarity` and `scielab_difference`.

    Notes
    -----
    For PSNR and SSIM both pictures are adapted to D65 and encoded (IEC 61966-2-1), so values
    that a display clips count as no error; the color differences are of unclipped XYZ.
    """
    first, second = same_pictures(xyz, reference)
    shown, true = (np.clip(encoded_srgb(one, white), 0.0, 1.0) for one in (first, second))
    luma = LUMA_WEIGHTS["bt709"]
    pixel = picture_color_difference(first, second, white)
    seen = scielab_difference(first, second, white, pixels_per_degree=pixels_per_degree)
    has_edges = near_edges(cielab(second, white)).any()
    return PictureQuality(
        psnr_db=psnr_db(shown, true),
        ssim=structural_similarity(shown @ luma, true @ luma),
        ciede2000_mean=float(pixel.mean()),
        ciede2000_p95=float(np.percentile(pixel, 95)),
        scielab_mean=float(seen.mean()),
        scielab_p95=float(np.percentile(seen, 95)),
        false_color=false_color(first, second, white) if has_edges else None,
    )
