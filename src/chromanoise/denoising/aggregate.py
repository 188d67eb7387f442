"""`aggregate`: the mean of estimates whose errors differ, weighted by the light of the exposure.

`guided` and `patches` err in different ways, so that their mean often errs less than either. In
little light no two patches can be found alike; there `guided` is averaged with itself in wider
windows.
"""

import math

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float32
from chromanoise.denoising import patches
from chromanoise.denoising.guided import USUAL, WIDE, guided_estimate
from chromanoise.denoising.method import DenoisingMethod
from chromanoise.denoising.planes import NoisyPlanes

LEAST_SNR = 15.0
"""Least power SNR of a pixel, of the component of most signal, for which patches are compared."""
_HALF = np.float32(0.5)
"""Weight of each estimate: more for `patches` costs flat areas, more for `guided` texture."""


def denoise(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    """The mean of two estimates, chosen by the SNR of usual scenes in this exposure. [e-]

    Parameters
    ----------
    planes
        Noisy values and their noise.

    Raises
    ------
    InputError
        As `patches.denoise`.
    """
    guided = guided_estimate(planes, USUAL)
    if not planes.has_noise.all():
        return guided
    if planes.components()[1][0] < LEAST_SNR:
        wide = guided_estimate(planes, WIDE)
        return _HALF * guided + _HALF * wide
    return _HALF * guided + _HALF * patches.denoise(planes)


AGGREGATE = DenoisingMethod(
    name="aggregate",
    what="Mean of guided and patches, whose errors differ; in little light, of guided in two sizes "
    "of windows. The best and the slowest.",
    denoise=denoise,
    reach_px=max(USUAL.reach_px, WIDE.reach_px, patches.PATCHES.reach_px or 0),
    grid_px=math.lcm(2**WIDE.levels, patches.PATCHES.grid_px),
)
