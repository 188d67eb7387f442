"""The methods `patches`, by groups of similar patches at several scales, and `aggregate`.

`patches` is non-local Bayes with known noise. Similar patches of all planes are treated as samples
of one distribution. The covariance of the noise is known from the mean, so that of the signal
follows, and with it the best linear estimate of each patch. Step 1 takes the covariance of the
noisy patches: it keeps the eigenvalues above those of noise alone, less what noise adds to them.
Step 2 groups the patches again in the result of step 1, whose covariance gives the Wiener filter.

This is done for means of 1, 2 x 2, 4 x 4, and 8 x 8 pixels, from coarse to fine. Low frequencies of
the coarser estimate replace those of the finer one, in which weak large structures are hidden by
noise. Where the two differ by more than the noise, the coarser one has blurred an edge, and the
finer one is kept.

`aggregate` is the mean of two estimates, chosen by the SNR of the exposure. The errors of `guided`
and `patches` differ, so their mean usually has a smaller error. In low light noise hides which
patches are similar, so `guided` is averaged with itself in wider windows.

Notes
-----
Lebrun, Buades & Morel, SIAM J. Imaging Sci. 6 (2013) 1665 (groups and the two steps); Facciolo,
Pierazzo & Morel, SIAM J. Imaging Sci. 10 (2017) 1603 (scales); Gavish & Donoho, IEEE Trans. Inf.
Theory 63 (2017) 2137 (eigenvalues). Ours: the noise of every plane in the units of its group, a
rotation of the planes for each group, the number of patches, and the limit of the replacement.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from chromanoise.base import Array, Float, Float32
from chromanoise.imaging.denoising.electron_planes import (
    PLACES,
    SIDE,
    DenoisingMethod,
    NoisyPlanes,
    deviations_from_dark,
    with_raised_floor,
)
from chromanoise.imaging.denoising.guided import GUIDED, USUAL, WIDE, guided_estimate
from chromanoise.sensor import VarianceLaw

_RADII = (8, 7, 6, 4)
"""Search radius for similar patches per level; smaller at coarse levels, to bound the reach.
[pixels]"""
_STRIDE = SIDE - 1
"""Step between the groups: patches overlap, so that their borders are not visible. [pixels]"""
_FEWEST = (40, 50, 60, 80)
"""Fewest patches of a group: a covariance needs more than its 16 places. More at coarse levels,
whose few pixels hold the structure that noise hides at fine levels."""
_LEVELS = len(_RADII)

_FEATURES = 2
"""Number of components, of most signal, by which noisy patches are compared; the others are mostly
noise."""
_SIMILAR = 0.2
"""Mean squared difference of similar patches after step 1, over the variance of the noise."""
_NEAR, _FAR = 0.25, 3.0
"""Standard deviations of noise to which coarse and fine estimates may differ, where the fine one
has structure, and where it has none."""
_BESIDE = 3
"""Coarse pixels around structure that count as structure: the coarse estimate blurs so far."""
_CUBIC = (-0.0703125, 0.8671875, 0.2265625, -0.0234375)
"""Weights of a cubic convolution (Keys 1981, a = -1/2), a quarter of a pixel from the second."""


def patches_estimate(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    """Estimated means of noisy planes. [e-]

    Planes without noise are returned as they are, and not used for the others.

    Parameters
    ----------
    planes
        Noisy values and their noise.

    Raises
    ------
    InputError
        If the noise of a plane is 0 at the mean of typical scenes, but not at others.
    """
    noisy = planes.law.has_noise
    out = np.array(planes.values_e, np.float32)
    if noisy.any() and out.size:
        rows = slice(*(planes.needed or (0, len(out))))
        out[rows, :, noisy] = _estimate(planes if noisy.all() else _chosen(planes, noisy))
    return out


def _chosen(planes: NoisyPlanes, which: Array) -> NoisyPlanes:
    """Some of the planes."""
    return NoisyPlanes(
        values_e=planes.values_e[..., which],
        law=planes.law.take(which),
        prior_e2=planes.prior_e2[np.ix_(which, which)],
        prior_mean_e=planes.prior_mean_e[which],
        names=tuple(name for name, wanted in zip(planes.names, which, strict=True) if wanted),
        needed=planes.needed,
    )


def _estimate(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    """The estimate of planes that all have noise; small pictures are mirrored to fill a patch."""
    height, width, _ = planes.values_e.shape
    missing = [(0, max(0, SIDE - n)) for n in (height, width)]
    pyramid = [np.pad(planes.values_e, (*missing, (0, 0)), mode="symmetric")]
    while len(pyramid) < _LEVELS and min(pyramid[-1].shape[:2]) >= 2 * SIDE:
        pyramid.append(_halved(pyramid[-1]))
    axes = planes.components()[0]
    spans = [planes.needed or (0, height)]  # rows of a level that the finer one needs
    for finer, picture in pairwise(pyramid):
        start, stop = _with_beside(spans[-1], len(finer))
        spans.append((start // 2, min(stop // 2, len(picture))))
    coarse = None
    for level, (noisy, span) in reversed(list(enumerate(zip(pyramid, spans, strict=True)))):
        if coarse is None:
            coarse, _ = _of_level(planes, noisy, axes, level, span)
        else:
            start, stop = rows = _with_beside(span, len(noisy))
            fine, active = _of_level(planes, noisy, axes, level, rows)
            fine = _with_low_frequencies(planes, fine, active, coarse, axes, level)
            coarse = fine[span[0] - start : span[1] - start]
    assert coarse is not None
    return coarse[:, :width]


def _with_beside(rows: tuple[int, int], height: int) -> tuple[int, int]:
    """The rows, extended by those that affect their low frequencies."""
    beside = 2 * (_BESIDE + len(_CUBIC) // 2)
    start, stop = max(0, rows[0] // 2 * 2 - beside), -(-rows[1] // 2) * 2 + beside
    return start, min(height, stop)


def _of_level(
    planes: NoisyPlanes,
    picture: Float32[Array, "h w p"],
    axes: Float[Array, "p p"],
    level: int,
    rows: tuple[int, int],
) -> tuple[Float32[Array, "r w p"], Float32[Array, "r w"]]:
    """The estimate of step 2 for some rows, and how much of the patches is signal, 0 to 1."""
    reach = _group_reach_px(level)
    first, last, start, stop = (
        edge
        for px in (2 * reach, reach)
        for edge in (max(0, (rows[0] - px) // _STRIDE * _STRIDE), min(len(picture), rows[1] + px))
    )
    noisy = np.ascontiguousarray(picture[first:last], np.float32)
    pilot, _ = _groups(planes, noisy, noisy, axes, level, is_pilot=False)
    inner = slice(start - first, stop - first)
    fine, active = _groups(planes, noisy[inner], pilot[inner], axes, level, is_pilot=True)
    inside = slice(rows[0] - start, rows[1] - start)
    return fine[inside], active[inside]


def _group_reach_px(level: int) -> int:
    """Largest distance in rows between an output of one step and its inputs. [pixels]"""
    return 2 * _RADII[level] + SIDE - 1


def _groups(
    planes: NoisyPlanes,
    noisy: Float32[Array, "h w p"],
    pilot: Float32[Array, "h w p"],
    axes: Float[Array, "p p"],
    level: int,
    *,
    is_pilot: bool,
) -> tuple[Float32[Array, "h w p"], Float32[Array, "h w"]]:
    """The estimate of a step at a level, and how much of the patches is signal, 0 to 1."""
    from chromanoise.imaging.denoising.patches_kernels import LANES, add_groups  # numba is slow

    share = 0.25**level
    if is_pilot:
        limit = _SIMILAR * PLACES * len(axes)
    else:  # the difference of two noisy patches is chi-squared times 2: its mean and deviation
        axes = axes[:, :_FEATURES]
        freedom = PLACES * axes.shape[1]
        limit = 2.0 * (freedom + math.sqrt(2.0 * freedom))
    features = _rotated(_stabilized(planes, pilot, share), axes)
    height, width, count = noisy.shape
    out = np.zeros_like(_in_lines(noisy.reshape(height, -1), LANES))
    weight, active = np.zeros((2, height * width), np.float32)
    add_groups(
        _in_lines(noisy.reshape(height, -1), LANES),
        _in_lines(pilot.reshape(height, -1), LANES),
        _in_lines(np.moveaxis(features, -1, 0), LANES),
        noisy.shape,
        planes.law.scaled(share).coefficients,
        is_pilot,
        (_RADII[level], _STRIDE, _FEWEST[level]),
        np.float32(limit),
        out,
        weight,
        active,
    )
    out = out[:, : width * count].reshape(noisy.shape)
    weight, active = (of.reshape(noisy.shape[:2]) for of in (weight, active))
    weight, active = _of_pixels(weight), _of_pixels(active)
    return out / weight[..., None], active / weight


def _in_lines(rows: Float[Array, "*h n"], lanes: int) -> Float32[Array, "*h m"]:
    """Rows zero-padded by at least one vector to an odd number of vectors.

    Neighboring rows then do not map to the same set of the cache.
    """
    count = rows.shape[-1]
    vectors = (-(-count // lanes) + 1) | 1
    out = np.zeros((*rows.shape[:-1], vectors * lanes), np.float32)
    out[..., :count] = rows
    return out


def _of_pixels(patches: Float32[Array, "h w"]) -> Float32[Array, "h w"]:
    """For each pixel, the sum over the patches that cover it; each is stored at its first pixel."""
    for axis in (0, 1):
        padded = np.pad(patches, [(SIDE - 1, 0) if i == axis else (0, 0) for i in range(2)])
        patches = sliding_window_view(padded, SIDE, axis).sum(axis=-1)
    return patches


def _with_low_frequencies(
    planes: NoisyPlanes,
    fine: Float32[Array, "h w p"],
    active: Float32[Array, "h w"],
    coarse: Float32[Array, "hc wc p"],
    axes: Float[Array, "p p"],
    level: int,
) -> Float32[Array, "h w p"]:
    """The fine estimate with low frequencies of the coarse one, where their difference is small.

    In units of noise, a difference u becomes u / (1 + (u / g)^2) with a limit g: all of it is
    replaced far below the limit, nothing far above.
    """
    noise = np.sqrt(np.maximum(planes.variance_e2(coarse) * 0.25 ** (level + 1), _tiny(planes)))
    difference = _rotated((coarse - _halved(fine)) / noise, axes)
    near = _largest_around(_halved(active[..., None]))
    limit = _NEAR * near + _FAR * (1.0 - near)
    replaced = _rotated(difference / (1.0 + (difference / limit) ** 2), axes.T) * noise
    return fine + _doubled(replaced.astype(np.float32), fine.shape[:2])


def _tiny(planes: NoisyPlanes) -> Float[Array, " p"]:
    """A variance that is negligible, but above 0 where neither floor nor signal gives one."""
    return (1e-3 * planes.noise_unit_e) ** 2


def _stabilized(
    planes: NoisyPlanes, mean_e: Float32[Array, "h w p"], share: float
) -> Float[Array, "h w p"]:
    """Means as multiples of their noise, a share of that of the planes; linear below 0."""
    least = VarianceLaw(floor_e2=share * _tiny(planes))
    law = with_raised_floor(planes.law.scaled(share)) + least
    light = deviations_from_dark(np.maximum(mean_e, 0.0), law)
    return np.where(mean_e < 0, mean_e / np.sqrt(law.floor_e2), light)


def _rotated(values: Array, axes: Float[Array, "p k"]) -> Float[Array, "h w k"]:
    """Products with the axes, added in an order that does not depend on the number of rows."""
    return np.asarray(sum(values[..., i, None] * axis for i, axis in enumerate(axes)))


def _halved(picture: Float[Array, "h w p"]) -> Float[Array, "hc wc p"]:
    """Means of 2 x 2 pixels; an odd last row or column is left out."""
    rows, columns = (n // 2 * 2 for n in picture.shape[:2])
    even, odd = picture[:rows:2, :columns], picture[1:rows:2, :columns]
    pairs = even + odd
    return np.asarray((pairs[:, ::2] + pairs[:, 1::2]) * np.float32(0.25))


def _doubled(coarse: Float32[Array, "hc wc p"], shape: tuple[int, int]) -> Float32[Array, "h w p"]:
    """Cubic interpolation at the centers of a picture of twice the rows and columns."""
    out = coarse
    for size in shape:  # each turn doubles the first axis and exchanges the axes
        count = len(out)
        padded = np.pad(out, ((2, 3), (0, 0), (0, 0)), mode="edge")
        before, after = (
            sum(weight * padded[first + i : first + i + count] for i, weight in enumerate(weights))
            for first, weights in ((0, _CUBIC[::-1]), (1, _CUBIC))
        )
        both = np.stack([before, after], axis=1).reshape(2 * count, *out.shape[1:])
        both = np.concatenate([both, both[-1:]])[:size]
        out = both.swapaxes(0, 1)
    return np.asarray(out, np.float32)


def _largest_around(values: Float32[Array, "h w 1"]) -> Float32[Array, "h w 1"]:
    """The largest value within `_BESIDE` rows and columns."""
    for axis in (0, 1):
        widths = [(_BESIDE, _BESIDE) if i == axis else (0, 0) for i in range(3)]
        windows = sliding_window_view(np.pad(values, widths, mode="edge"), 2 * _BESIDE + 1, axis)
        values = windows.max(axis=-1)
    return values


def _reach_px() -> int:
    """Most rows between a value and the values on which it depends.

    Counted as the rows beside a cut through the picture that the cut can change.
    """
    rows = 0
    for level in reversed(range(_LEVELS)):
        groups = 2 * _group_reach_px(level)
        # 1 for a coarse row that the cut halves, 2 for the interpolation
        low_frequencies = 2 * (max(rows, groups // 2 + _BESIDE) + 1 + 2)
        rows = groups if level == _LEVELS - 1 else max(groups, low_frequencies)
    return rows


PATCHES = DenoisingMethod(
    name="patches",
    what="Non-local Bayes: groups of similar patches of all planes, at four scales.",
    denoise=patches_estimate,
    reach_px=_reach_px(),
    grid_px=_STRIDE << (_LEVELS - 1),
    compiled=True,
)


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
    if not planes.law.has_noise.all():
        return guided_estimate(planes, USUAL)
    if planes.components()[1][0] < LEAST_SNR:
        return _HALF * guided_estimate(planes, USUAL) + _HALF * guided_estimate(planes, WIDE)
    out = patches_estimate(planes)
    start, stop = rows = planes.needed or (0, len(out))
    part = planes.rows(*rows, reach_px=USUAL.reach_px, grid_px=GUIDED.grid_px)
    assert part.needed is not None
    guided = guided_estimate(part, USUAL)[slice(*part.needed)]
    out[start:stop] = _HALF * guided + _HALF * out[start:stop]
    return out


AGGREGATE = DenoisingMethod(
    name="aggregate",
    what="Mean of guided and patches, whose errors differ; in low light, of guided with two sets "
    "of window sizes. Beats the baselines most often, and is the slowest.",
    denoise=aggregate_estimate,
    reach_px=max(USUAL.reach_px, WIDE.reach_px, PATCHES.reach_px or 0),
    grid_px=math.lcm(2**WIDE.levels, PATCHES.grid_px),
    compiled=True,
)
