"""Readout of a known number of electrons: moments of a clipped, rounded Gaussian."""

import math
from collections.abc import Callable

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError

FARTHEST = 9.1
"""Number of standard deviations beyond which one tail of a Gaussian is below 1e-18."""

_ENTRIES = 2**18  # of the table counts x codes in memory
_MOST_CODES = 2**20


def held_moments(
    electrons: Float[Array, " m"],
    *,
    read_noise_e: float | Float[Array, " m"],
    black_e: float,
    full_well_e: float,
) -> Float[Array, "4 m"]:
    """Mean, variance, share below black and share above full well of n + s Z, clipped.

    Parameters
    ----------
    electrons
        n, the known number of electrons. [e-]
    read_noise_e
        s, >= 0; one number, or one above 0 per entry. [e-]
    black_e, full_well_e
        The bounds; they may be infinite. [e-]

    Notes
    -----
    The censored normal distribution (Tobin, *Econometrica* 26 (1958) 24), by partial moments about
    the point c of the range that is nearest to n, so that no large squares cancel.

    Examples
    --------
    Zero signal clipped at black: mean 1 / sqrt(2 pi) and variance (1 - 1 / pi) / 2.

    >>> held_moments(np.array([0.0]), read_noise_e=1.0, black_e=0.0, full_well_e=9e9).round(5)
    array([[0.39894],
           [0.34085],
           [0.5    ],
           [0.     ]])
    """
    center = np.clip(electrons, black_e, full_well_e)
    if np.ndim(read_noise_e) == 0 and read_noise_e == 0:
        sure = np.zeros_like(center)
        return np.stack([center, sure, electrons < black_e, electrons > full_well_e])
    from scipy.special import ndtr

    away = (center - electrons) / read_noise_e
    above, above_square = _capped_excess(away, (full_well_e - center) / read_noise_e)
    below, below_square = _capped_excess(-away, (center - black_e) / read_noise_e)
    shift = above - below
    variance = np.maximum(above_square + below_square - shift**2, 0.0)  # -1e-17 by rounding
    return np.stack(
        [
            center + read_noise_e * shift,
            read_noise_e**2 * variance,
            ndtr((black_e - electrons) / read_noise_e),
            ndtr((electrons - full_well_e) / read_noise_e),
        ]
    )


def _capped_excess(
    start: Float[Array, " m"], cap: Float[Array, " m"]
) -> tuple[Float[Array, " m"], Float[Array, " m"]]:
    """First and second moment of min(max(Z - start, 0), cap), where start >= 0 or cap = 0."""
    cap = np.minimum(cap, 40.0)  # above it the Gaussian is 0 in double precision
    once, twice = _excess(start)
    once_beyond, twice_beyond = _excess(start + cap)
    return once - once_beyond, twice - twice_beyond - 2 * cap * once_beyond


def _excess(start: Float[Array, " m"]) -> tuple[Float[Array, " m"], Float[Array, " m"]]:
    """First and second moment of max(Z - start, 0): phi - u Q, and (1 + u^2) Q - u phi."""
    from scipy.special import ndtr

    density = np.exp(-0.5 * start**2) / math.sqrt(2 * math.pi)
    tail = ndtr(-start)
    return density - start * tail, (1 + start**2) * tail - start * density


def coded_moments(
    electrons: Float[Array, " m"],
    *,
    read_noise_e: float,
    black_e: float,
    full_well_e: float,
    step_e: float,
) -> Float[Array, "4 m"]:
    """As `held_moments`, with n + s Z first rounded to the nearest multiple of a step.

    Parameters
    ----------
    electrons, read_noise_e, black_e, full_well_e
        As in `held_moments`. [e-]
    step_e
        Step, > 0; a value halfway between two multiples is rounded up. [e-]

    Raises
    ------
    InputError
        If the read noise spans more than a million steps.

    Notes
    -----
    Code k has the probability of (k - 1/2) step <= n + s Z < (k + 1/2) step.

    Examples
    --------
    Halfway between two codes, small noise gives either code: variance step^2 / 4.

    >>> coded_moments(np.array([1.0]), read_noise_e=1e-3, black_e=0.0, full_well_e=100.0,
    ...               step_e=2.0)[:2].round(9)
    array([[1.],
           [1.]])
    """
    reach = FARTHEST * read_noise_e / step_e
    if 2 * reach > _MOST_CODES:
        raise InputError(
            "step_e",
            f"must be at least {2 * FARTHEST / _MOST_CODES:.2g} of the read noise of "
            f"{read_noise_e:g} [e-]",
            value=step_e,
            remedy="take 0 for no rounding",
        )
    codes = 2 * math.ceil(reach) + 3
    rows = max(1, _ENTRIES // codes)
    held = _holding(black_e, full_well_e, step_e)
    parts = [
        _coded(electrons[i : i + rows], codes, read_noise_e, step_e, held)
        for i in range(0, electrons.size, rows)
    ]
    return np.concatenate(parts, axis=1)


def _holding(
    black_e: float, full_well_e: float, step_e: float
) -> Callable[[Float[Array, "m k"]], tuple[Array, Array, Array]]:
    """Multiples clipped to the bounds, and masks of those that were raised or lowered."""
    slack = 1e-9 * step_e  # so that 3 * 0.1 does not exceed 0.3

    def held(multiple: Float[Array, "m k"]) -> tuple[Array, Array, Array]:
        kept = np.clip(multiple, black_e, full_well_e)
        return kept, multiple < black_e - slack, multiple > full_well_e + slack

    return held


def _coded(
    electrons: Float[Array, " m"],
    codes: int,
    read_noise_e: float,
    step_e: float,
    held: Callable[[Float[Array, "m k"]], tuple[Array, Array, Array]],
) -> Float[Array, "4 m"]:
    nearest = np.floor(electrons / step_e + 0.5)
    code = nearest[:, None] + np.arange(codes) - codes // 2
    value, raised, lowered = held(code * step_e)
    share = _shares((code[:, 1:] - 0.5) * step_e - electrons[:, None], read_noise_e)
    middle = value[:, codes // 2]
    mean = middle + (share * (value - middle[:, None])).sum(axis=1)
    variance = (share * (value - mean[:, None]) ** 2).sum(axis=1)
    return np.stack([mean, variance, (share * raised).sum(axis=1), (share * lowered).sum(axis=1)])


def _shares(threshold_e: Float[Array, "m t"], read_noise_e: float) -> Float[Array, "m k"]:
    """Probability of each code between thresholds relative to n; the outer two are unbounded."""
    if read_noise_e == 0:
        below = (threshold_e > 0).astype(np.float64)  # n on a threshold takes the upper code
        above = 1.0 - below
    else:
        from scipy.special import ndtr

        below, above = ndtr(threshold_e / read_noise_e), ndtr(-threshold_e / read_noise_e)
    ends = np.ones_like(below[:, :1])
    from_below = np.diff(below, axis=1, prepend=0 * ends, append=ends)
    from_above = -np.diff(above, axis=1, prepend=ends, append=0 * ends)
    # the difference of the smaller tails, because 1 - 1e-20 rounds to 1
    upper = np.concatenate([0 * ends, threshold_e], axis=1) > 0
    return np.where(upper, from_above, from_below)
