"""`guided_kernels` in plain numpy, for where nothing can be compiled, and what both need.

The results differ by rounding alone. Sums over windows are differences of sums from the edge.
"""

import numpy as np

from chromanoise.base import Array, Float, Float32, eigh

LEAST_VARIANCE = 1e-10
"""Least variance of the noise, as a share of the mean square: float32 holds no smaller one."""
LEAST_E2 = 1e-30


def add_estimates(
    values: Float32[Array, "p h w"],
    noise: Float[Array, "3 p"],
    row_share: Float[Array, " h"],
    column_share: Float[Array, " w"],
    radius: int,
    edge: np.float32,
    estimate: Float32[Array, "p h w"],
    weight: Float32[Array, "h w"],
    active: Float32[Array, "h w"],
) -> None:
    """As `guided_kernels.add_estimates`."""
    p, h, w = values.shape
    wide = values.astype(np.float64)
    ends = [_ends(size, radius) for size in (h, w)]
    number = np.multiply.outer(*(stop - start for start, stop in ends))
    share = np.multiply.outer(
        *(
            _sums(one[None, :, None], of, 1)[0, :, 0] / (of[1] - of[0])
            for one, of in zip((row_share, column_share), ends, strict=True)
        )
    )
    mean = _windows(wide, ends) / number
    products = np.stack([wide[a] * wide[b] for a in range(p) for b in range(p)])
    square = (_windows(products, ends) / number).reshape(p, p, *number.shape)
    light = np.maximum(mean, 0.0)
    variance = variance_of(noise, light) * share
    variance = np.maximum(variance, LEAST_VARIANCE * np.einsum("aayx->ayx", square)) + LEAST_E2
    unit = np.sqrt(variance)
    power = (square - mean[:, None] * mean) * (number / np.maximum(number - 1.0, 1.0))
    found, basis = eigh("planes", np.moveaxis(power / (unit[:, None] * unit), (0, 1), (-2, -1)))
    gain = _gain(found, p / number[..., None], edge)
    of_window = 1 / (p / number + (gain**2).sum(axis=-1)) ** 2
    kept = np.moveaxis((basis * gain[..., None, :]) @ np.swapaxes(basis, -1, -2), (-2, -1), (0, 1))
    kept *= unit[:, None] / unit * of_window
    constant = mean * of_window - np.einsum("abyx,byx->ayx", kept, mean)
    parts = np.concatenate(
        [kept.reshape(p * p, *number.shape), constant, [of_window, gain.max(axis=-1)]]
    )
    held = [_holding(size, radius) for size in (h, w)]
    spread = _windows(parts, held)
    matrix = spread[: p * p].reshape(p, p, h, w)
    estimate += np.einsum("abyx,byx->ayx", matrix, wide) + spread[p * p : p * p + p]
    weight += spread[-2]
    active[:] = spread[-1] / np.multiply.outer(*(stop - start for start, stop in held))


Ends = tuple[Array, Array]


def _ends(size: int, radius: int) -> Ends:
    """First and last pixels of the windows around even ones, the last not included."""
    center = np.arange(0, size, 2)
    return np.maximum(0, center - radius), np.minimum(size, center + radius + 1)


def _holding(size: int, radius: int) -> Ends:
    """First and last windows that hold each pixel, the last not included."""
    at = np.arange(size)
    windows = (size + 1) // 2
    return np.maximum(0, (at - radius + 1) // 2), np.minimum(windows, (at + radius) // 2 + 1)


def _windows(planes: Float[Array, "k h w"], ends: list[Ends]) -> Float[Array, "k h2 w2"]:
    """Sums over windows."""
    return _sums(_sums(planes, ends[0], 1), ends[1], 2)


def _sums(planes: Array, ends: Ends, axis: int) -> Array:
    edge = np.zeros_like(np.take(planes, [0], axis=axis))
    summed = np.concatenate([edge, np.cumsum(planes, axis=axis)], axis=axis)
    start, stop = ends
    return np.take(summed, stop, axis=axis) - np.take(summed, start, axis=axis)


def variance_of(noise: Float[Array, "3 p"], light: Float[Array, "p h w"]) -> Float[Array, "p h w"]:
    """Variance at a mean: floor, slope and square of `VarianceLaw` per plane. [e-^2]"""
    floor, slope, square = noise[:, :, None, None]
    return floor + light * (slope + light * square)


def _gain(found: Array, ratio: Array, edge: np.float32) -> Array:
    """The gain of each component, as `guided_kernels._shrunk`."""
    most = (1 + np.sqrt(ratio)) ** 2
    middle = found + 1 - ratio
    root = np.sqrt(np.maximum(middle * middle - 4 * found, 0.0))
    signal = np.maximum((middle + root) / 2 - 1, 0.0)
    kept = np.clip((found / most - 1) / (edge - 1), 0.0, 1.0)
    return kept * signal / (signal + 1)
