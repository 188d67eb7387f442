"""`guided`: fast denoising, guided by the structure that all planes share locally.

In a square window, the covariance of the planes minus that of the noise is that of the signal. In
units of the noise its eigenvectors are the guides: a component within the noise is replaced by the
mean of the window, any other one is scaled by its Wiener gain. So a plane guides another one only
as far as the two are correlated in this window, and an edge in the infrared alone is a component
without color. Each pixel is the weighted mean of the estimates of all windows that contain it.

The windows have three sizes, weighted by the noise that they leave: without structure the larger
window has more weight, with structure the smaller one. Low-frequency noise remains after all
windows, so the same is done at three coarser levels, each of means of 2 x 2 pixels. The low
frequencies of a level are replaced by those of the coarser one, where their difference is within
the noise.

Sources: He, Sun & Tang, Guided image filtering, IEEE TPAMI 35 (2013) 1397 (windows and their mean);
Lebrun, Buades & Morel, A nonlocal Bayesian image denoising algorithm, SIAM J. Imaging Sci. 6 (2013)
1665 (covariance less noise, weights); Baik & Silverstein, J. Multivar. Anal. 97 (2006) 1382 (the
power of a component from its estimate).
"""

from typing import Any

import numpy as np

from chromanoise.base import Array, Float, Float32, dataclass
from chromanoise.imaging.denoising.electron_planes import DenoisingMethod, NoisyPlanes
from chromanoise.imaging.denoising.guided_plain import LEAST_E2, LEAST_VARIANCE, variance_of
from chromanoise.imaging.kernel_cache import either_module

_NARROW, _WIDE = 1.0, 8.0  # difference of two levels that is halved, with and without structure
_ROWS = 16  # of a coarser level at a time: what a pass makes stays in the cache of the processor


@dataclass(frozen=True, kw_only=True)
class Windows:
    """Windows and levels of `guided_estimate`.

    Attributes
    ----------
    radii
        Half widths of the windows. [pixels]
    levels
        Levels of the pyramid.
    edge
        A component is included gradually from 1 to this multiple of the largest power of noise. [1]
    """

    radii: tuple[int, ...]
    levels: int
    edge: float

    @property
    def reach_px(self) -> int:
        """Most rows between a value and the values on which it depends. [pixels]

        Two windows at the coarsest level; each finer level doubles it and adds a coarse pixel.
        """
        reach = 2 * max(self.radii)
        for _ in range(self.levels - 1):
            reach = 2 * reach + 2
        return reach


# Chosen for least mean CIEDE2000 and S-CIELAB over two scenes, two sensors, and 0.1 to 10 lx: 3 x 3
# for the finest detail in much light, 11 x 11 for little light; a fifth level changes the mean by
# less than 1 %, and doubles the reach.
USUAL = Windows(radii=(1, 2, 5), levels=4, edge=1.5)
WIDE = Windows(radii=(2, 4, 8), levels=5, edge=2.0)
"""For low light, where small windows mistake noise for structure."""


def denoise(planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    """The planes after local linear estimation in windows, on all levels of a pyramid. [e-]

    Planes without noise are returned unchanged, and guide the others.

    Parameters
    ----------
    planes
        Noisy values and their noise; the prior is not used.

    Examples
    --------
    >>> from chromanoise.sensor import VarianceLaw
    >>> rng = np.random.default_rng(1)
    >>> planes = NoisyPlanes(
    ...     values_e=rng.normal(100.0, 10.0, (64, 64, 3)).astype(np.float32),
    ...     law=VarianceLaw(floor_e2=100.0), prior_e2=np.eye(3), prior_mean_e=np.ones(3),
    ...     names=("R", "G", "B"))
    >>> bool(denoise(planes).std() < 1.0)
    True
    """
    return guided_estimate(planes, USUAL)


def guided_estimate(planes: NoisyPlanes, windows: Windows) -> Float32[Array, "h w p"]:
    """As `denoise`, with windows of other sizes. [e-]"""
    noise = planes.law.coefficients
    values = [np.ascontiguousarray(np.moveaxis(planes.values_e, 2, 0))]
    shares = [(np.ones(values[0].shape[1]), np.ones(values[0].shape[2]))]
    for _ in range(windows.levels - 1):
        values.append(_halved(values[-1]))
        shares.append((_share_of_halved(shares[-1][0]), _share_of_halved(shares[-1][1])))
    coarse, _ = _estimate(values.pop(), noise, shares[-1], windows)
    while values:
        fine, active = _estimate(values.pop(), noise, shares[len(values)], windows)
        change = _believed(coarse, fine, active, noise, shares[len(values) + 1])
        _add_enlarged(fine, change)
        coarse = fine
    out = np.ascontiguousarray(np.moveaxis(coarse, 0, 2))
    noiseless = ~planes.law.has_noise
    out[..., noiseless] = planes.values_e[..., noiseless]
    return out


def _halved(values: Float32[Array, "p h w"]) -> Float32[Array, "p h2 w2"]:
    """Means of 2 x 2 pixels; fewer at the last row and column of an odd size."""
    p, h, w = values.shape
    out = np.empty((p, -(-h // 2), -(-w // 2)), np.float32)
    low, right = (np.minimum(np.arange(0, size, 2) + 1, size - 1) for size in (h, w))
    beside = right if w % 2 else slice(1, None, 2)
    for y in range(0, out.shape[1], _ROWS):
        rows = slice(y, y + _ROWS)
        upper, lower = values[:, 2 * y : 2 * (y + _ROWS) : 2], values[:, low[rows]]
        total = upper[..., ::2] + upper[..., beside]
        total += lower[..., ::2]
        total += lower[..., beside]
        np.divide(total, 4, out=out[:, rows])
    return out


def _believed(
    coarse: Float32[Array, "p h w"],
    fine: Float32[Array, "p h2 w2"],
    active: Float32[Array, "h2 w2"],
    noise: Float[Array, "3 p"],
    shares: tuple[Float[Array, " h"], Float[Array, " w"]],
) -> Float32[Array, "p h w"]:
    """What the coarse estimate changes of the halved fine one, as far as noise explains it. [e-]

    One factor for all planes, so that the change keeps its color. ``active`` is the activity in the
    fine estimate; the shares are those of the coarse level.
    """
    own, (own_active,) = _halved(fine), _halved(active[None])
    out = np.empty_like(coarse)
    for y in range(0, coarse.shape[1], _ROWS):
        rows = slice(y, y + _ROWS)
        light = np.maximum(coarse[:, rows], 0, dtype=np.float64)
        variance = variance_of(noise, light) * (shares[0][rows, None] * shares[1])
        variance = np.maximum(variance, LEAST_VARIANCE * light * light) + LEAST_E2
        change = coarse[:, rows] - own[:, rows].astype(np.float64)
        apart = (change * change / variance).mean(axis=0)
        gate = _NARROW + (_WIDE - _NARROW) * (1.0 - own_active[rows].astype(np.float64))
        out[:, rows] = np.float32(1 / (1 + apart / gate**2)) * np.float32(change)
    return out


def _add_enlarged(fine: Float32[Array, "p h w"], change: Float32[Array, "p h2 w2"]) -> None:
    """Add the change of the coarse level, bilinear between its pixels."""
    padded = np.pad(change, ((0, 0), (1, 1), (1, 1)), mode="edge")
    # rounded to float32 as a processor with fused multiplication and addition does, on any
    near, beside, far = 9 / 16, np.float32(3 / 16), 1 / 16
    for y in range(0, change.shape[1], _ROWS):
        for lower in (0, 1):
            rows = fine[:, 2 * y + lower : 2 * (y + _ROWS) : 2]
            here, there = (padded[:, y + k :][:, : rows.shape[1]] for k in (1, 2 * lower))
            for right in (0, 1):
                out = rows[..., right::2]
                width = out.shape[2]
                own, other = slice(1, 1 + width), slice(2 * right, 2 * right + width)
                change_beside = beside * (there[..., own] + here[..., other])
                nearer = np.multiply(near, here[..., own], dtype=np.float64) + change_beside
                farther = np.multiply(far, there[..., other], dtype=np.float64)
                out += np.float32(farther + np.float32(nearer))


def _share_of_halved(share: Float[Array, " n"]) -> Float[Array, " n2"]:
    """Variance of means of two, from that of each; the last one of an odd number stays alone."""
    pairs = len(share) // 2 * 2
    return np.append(share[:pairs].reshape(-1, 2).sum(axis=1) / 4, share[pairs:])


def _kernels() -> Any:
    """The compiled estimates in windows, or without numba those of numpy."""
    return either_module(f"{__package__}.guided_kernels", f"{__package__}.guided_plain")


def _estimate(
    values: Float32[Array, "p h w"],
    noise: Float[Array, "3 p"],
    shares: tuple[Float[Array, " h"], Float[Array, " w"]],
    windows: Windows,
) -> tuple[Float32[Array, "p h w"], Float32[Array, "h w"]]:
    """The estimate of one level, and the activity in its largest windows."""
    estimate, (weight, active) = np.zeros_like(values), np.zeros((2, *values.shape[1:]), np.float32)
    edge = np.float32(windows.edge)
    add_estimates = _kernels().add_estimates
    for radius in windows.radii:
        add_estimates(values, noise, *shares, radius, edge, estimate, weight, active)
    estimate /= weight
    return estimate, active


GUIDED = DenoisingMethod(
    name="guided",
    what="Local linear estimates in windows, guided by the structure that the planes share.",
    denoise=denoise,
    reach_px=USUAL.reach_px,
    grid_px=2**USUAL.levels,
)
