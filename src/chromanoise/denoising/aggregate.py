"""`aggregate`: the mean of two estimates, chosen by the SNR of the exposure.

The errors of `guided` and `patches` differ, so their mean usually has a smaller error. In low light
noise hides which patches are similar, so `guided` is averaged with itself in wider windows.
"""

import math

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float32
from chromanoise.denoising.guided import USUAL, WIDE, guided_estimate
from chromanoise.denoising.method import DenoisingMethod
from chromanoise.denoising.patches import PATCHES, patches_estimate
from chromanoise.denoising.planes import NoisyPlanes

LEAST_SNR = 15.0
"""Lowest power SNR of the first component of a pixel at which `patches` is used. [1]"""
_HALF = np.float32(0.5)
"""Weight of each estimate: more for `patches` costs flat areas, more for `guided` texture."""


def aggregate_estimate(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    """The mean of two estimates, chosen by the SNR of typical scenes in this exposure. [e-]

    Parameters
    ----------
    planes
        Noisy values and their noise.

    Raises
    ------
    InputError
        As `patches_estimate`.
    """
    guided = guided_estimate(planes, USUAL)
    if not planes.law.has_noise.all():
        return guided
    if planes.components()[1][0] < LEAST_SNR:
        wide = guided_estimate(planes, WIDE)
        return _HALF * guided + _HALF * wide
    return _HALF * guided + _HALF * patches_estimate(planes)


AGGREGATE = DenoisingMethod(
    name="aggregate",
    what="Mean of guided and patches, whose errors differ; in low light, of guided with two sets "
    "of window sizes. Beats the baselines most often, and is the slowest.",
    denoise=aggregate_estimate,
    reach_px=max(USUAL.reach_px, WIDE.reach_px, PATCHES.reach_px or 0),
    grid_px=math.lcm(2**WIDE.levels, PATCHES.grid_px),
)
