"""Kodak's noise gain Psi of a color matrix, and the best matrix with bounded Psi."""

from dataclasses import replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import RANK_TOLERANCE, svd
from chromanoise._shapes import Float
from chromanoise.color.fitted import least_squares
from chromanoise.color.matrices import ColorMatrix
from chromanoise.color.training import Training, TrainingResponse, training_response, white_scale
from chromanoise.errors import InputError
from chromanoise.exposure import Exposure
from chromanoise.sensor import Sensor
from chromanoise.spectra import Metric

_HALVINGS = 64  # of a bracket in logarithms, down to rounding


def bounded_psi(
    sensor: Sensor,
    exposure: Exposure,
    training: Training,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    limit: float,
) -> ColorMatrix:
    """Least squares among the matrices whose noise gain Psi on the white is at most ``limit``.

    Parameters
    ----------
    sensor
        The sensor.
    exposure
        Time and lens.
    training
        Spectra that the matrix is trained on, with the responses of sensor and observer.
    level_lux
        Illuminance on the scene. [lx]
    metric
        Whether spectra are expressed in photons (``quanta``) or in ``energy``.
    limit
        Upper limit of `noise_gain` of the `white_normalized` matrix. [1]

    Raises
    ------
    InputError
        As `least_squares`, if the limit is not positive or the white has an X, Y or Z of 0.

    Notes
    -----
    US 5,609,978 (Kodak), whose Psi and its limit of 6.5 are for rows in RGB; here rows are X, Y and
    Z over those of the white. The problem is convex: each row is a ridge solution whose strength
    times its norm is the common multiplier over the square of the white, found by bisection from
    the side within the limit.
    """
    _check.positive("limit of Psi", "1", limit)
    free = least_squares(sensor, exposure, training, level_lux=level_lux, metric=metric)
    seen = training_response(training, sensor, exposure, level_lux=level_lux)
    normalized = white_normalized(free.matrix, seen.white_e, seen.white_xyz)
    made_by = f"Psi at most {limit:g} ({training.source})"
    if noise_gain(normalized) <= limit:
        return replace(free, made_by=made_by)
    rows = _rows_within(seen, limit)
    matrix = rows * seen.white_xyz[:, None] / white_scale(seen)
    return replace(free, matrix=matrix, made_by=made_by)


def white_normalized(
    matrix: Float[Array, "c p"], white_e: Float[Array, " p"], white_xyz: Float[Array, " c"]
) -> Float[Array, "c p"]:
    """The matrix from raw relative to white to color relative to white.

    Its rows sum to 1 where the matrix preserves the white.

    Parameters
    ----------
    matrix
        The color matrix. [lx/e-]
    white_e
        Electrons of the white in each channel. [e-]
    white_xyz
        X, Y, Z of the white. [lx]

    Raises
    ------
    InputError
        If a coordinate of the white is not above 0.

    Examples
    --------
    >>> white_normalized(np.array([[0.5, 0.1]]), np.array([1.0, 10.0]), np.array([2.0]))
    array([[0.25, 0.5 ]])
    """
    if not (white_xyz > 0).all():
        found = white_xyz.tolist()
        raise InputError(
            "white_xyz",
            "must be > 0 in every coordinate to normalize a matrix",
            value=found,
            found=f"is {found}",
            remedy="take a lamp with light at all visible wavelengths",
        )
    return np.asarray(matrix * white_e / white_xyz[:, None])


def noise_gain(matrix: Float[Array, "c p"]) -> float:
    """Kodak's Psi: the sum of the norms of the rows, noise out for equal unit noise in. [1]

    Parameters
    ----------
    matrix
        White-normalized color matrix (`white_normalized`). [1]

    Notes
    -----
    US 5,609,978 (Kodak); docs/numbers.md lists the numbers of its three filter sets.

    Examples
    --------
    >>> noise_gain(np.array([[3.0, -4.0], [0.0, 1.0]]))
    6.0
    """
    return float(np.linalg.norm(matrix, axis=1).sum())


def _rows_within(seen: TrainingResponse, limit: float) -> Float[Array, "3 p"]:
    """The white-normalized rows of least E|C M - XYZ|^2 whose norms add up to ``limit``."""
    root = np.sqrt(seen.share)[:, None]
    relative = root * seen.electrons / white_scale(seen)
    u, s, vt = svd("training set relative to the white", relative, full_matrices=False)
    kept = np.where(
        s > RANK_TOLERANCE * s[0], s, 0.0
    )  # linearly dependent channels would amplify rounding
    answer = kept * ((root * seen.xyz / seen.white_xyz).T @ u)  # V^T E[x y]
    emptying = seen.white_xyz**2 * np.linalg.norm(answer, axis=1)  # multipliers

    def rows(log_share: float) -> Float[Array, "3 p"]:
        pull = np.exp(log_share) * emptying.max() / seen.white_xyz**2
        return _pulled(answer, s, pull) @ vt

    low, high = np.log(1e-18), 0.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if noise_gain(rows(middle)) > limit else (low, middle)
    return rows(high)


def _pulled(
    answer: Float[Array, "3 r"], s: Float[Array, " r"], pull: Float[Array, " 3"]
) -> Float[Array, "3 r"]:
    """Per row the minimum of (n - n0)^T S (n - n0) / 2 + pull |n|, S = diag(s^2), S n0 = answer.

    Stationary where n = answer / (s^2 + r) with r |n| = pull; r |n| rises with r.
    """
    left = pull < np.linalg.norm(answer, axis=1) * (1 - 1e-15)
    low, high = np.full(3, np.log(1e-30)), np.full(3, np.log(1e30))
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        strength = np.exp(middle)
        norm = np.linalg.norm(answer / (s**2 + strength[:, None]), axis=1)
        short = strength * norm < pull
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return np.asarray(left[:, None] * answer / (s**2 + np.exp(high)[:, None]))
