"""Quality of color filters: q, Vora value, principal angles, and a general figure of merit.

Light l with second moment K passes filters F, and the channels measure F^T l plus noise of
covariance D. The color of the observer is A^T l. With the best linear readout B,

    B = A^T K F (F^T K F + D)^-1,  FOM = 1 - tr W (A^T K A - B F^T K A) / tr W A^T K A.

Because K and D have square roots, this is a projection: stack X = [K^1/2 F; D^1/2] and
Y = [K^1/2 A; 0]; then B^T is the least-squares solution of X B^T ~ Y, and the error is the
residual of Y. So the figure of merit is computed without squaring a condition number, and it is
never negative.
"""

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Float,
    InputError,
    check,
    eigh,
    pinv,
    svd,
    unit_columns,
)

NEGATIVE_TOLERANCE = 1e-9
"""A covariance is rejected if an eigenvalue is below minus this share of the largest."""


def filter_quality(filters: Float[Array, "n p"], eye: Float[Array, "n c"]) -> Float[Array, " p"]:
    """Neugebauer's q of each filter: the share of |f|^2 in the span of the observer. [1]

    Parameters
    ----------
    filters
        One column per channel, in the same metric as ``eye``; the unit cancels.
    eye
        Color-matching functions, or any linear combinations of them.

    Raises
    ------
    InputError
        If an entry is not finite, the wavelengths differ, or a filter is zero everywhere.

    Notes
    -----
    Neugebauer, J. Opt. Soc. Am. 46, 821 (1956): q = |P_A f|^2 / |f|^2.

    Examples
    --------
    >>> eye = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    >>> filter_quality(np.array([[3.0], [0.0], [4.0]]), eye)    # 9 of 25
    array([0.36])
    """
    filters, eye = _spanning(filters, eye)
    return np.asarray(((_orthonormal(eye).T @ unit_columns(filters)[0]) ** 2).sum(axis=0))


def principal_angles_deg(
    filters: Float[Array, "n p"], eye: Float[Array, "n c"]
) -> Float[Array, " k"]:
    """Principal angles between the spans of sensor and observer, smallest first. [deg]

    Parameters
    ----------
    filters
        Spectral responses of the sensor, a column per channel.
    eye
        Curves of the observer, a column per coordinate.

    Raises
    ------
    InputError
        As `filter_quality`.

    Notes
    -----
    Bjorck & Golub, Math. Comp. 27, 579 (1973): cosines from Q_F^T Q_A; below 45 degrees, where a
    cosine is insensitive, sines from the residual of one basis after projection on the other.

    Examples
    --------
    >>> eye = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    >>> principal_angles_deg(np.array([[1.0], [0.0], [1.0]]), eye).round(9)
    array([45.])
    """
    filters, eye = _spanning(filters, eye)
    larger, smaller = _orthonormal(filters), _orthonormal(eye)
    if larger.shape[1] < smaller.shape[1]:
        larger, smaller = smaller, larger
    overlap = larger.T @ smaller
    cosine = np.clip(svd("sensor and eye", overlap, compute_uv=False), 0.0, 1.0)
    outside = svd("sensor and eye", smaller - larger @ overlap, compute_uv=False)
    sine = np.clip(outside[::-1], 0.0, 1.0)
    angle = np.where(cosine**2 > 0.5, np.arcsin(sine), np.arccos(cosine))
    return np.asarray(np.degrees(angle))


def vora_value(filters: Float[Array, "n p"], eye: Float[Array, "n c"]) -> float:
    """Mean squared cosine between the spans of sensor and observer: 1 for an exact colorimeter. [1]

    Parameters
    ----------
    filters
        Spectral responses of the sensor, a column per channel.
    eye
        Curves of the observer, a column per coordinate.

    Raises
    ------
    InputError
        As `filter_quality`.

    Notes
    -----
    Vora & Trussell, J. Opt. Soc. Am. A 10, 1499 (1993): tr(P_A P_F) / dim A. Where the sensor has
    fewer independent channels than the observer, the missing cosines count as 0.

    Examples
    --------
    >>> eye = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    >>> round(vora_value(np.array([[1.0], [0.0], [1.0]]), eye), 12)   # cos^2 45 deg, and 0
    0.25
    """
    filters, eye = _spanning(filters, eye)
    target = _orthonormal(eye)
    return float(((_orthonormal(filters).T @ target) ** 2).sum() / target.shape[1])


def best_readout(
    filters: Float[Array, "n p"],
    eye: Float[Array, "n c"],
    *,
    light_moment: Float[Array, "n n"],
    noise_covariance: Float[Array, "p p"],
) -> Float[Array, "c p"]:
    """B = A^T K F (F^T K F + D)^-1, the matrix with the least mean squared error.

    Where a channel is a linear combination of others and has no noise, the solution of least norm.

    Parameters
    ----------
    filters
        F, one column per channel. [e- per unit of light]
    eye
        A, one column per color coordinate. [color per unit of light]
    light_moment
        K = E[l l^T] of the expected spectra, about zero; about their mean only if the mean is
        subtracted from signals and colors as well. [(unit of light)^2]
    noise_covariance
        D, of the channels. [e-^2]

    Raises
    ------
    InputError
        As `filter_quality`, and if K or D is not square, symmetric and >= 0.

    Examples
    --------
    >>> one = np.eye(1)
    >>> best_readout(one, one, light_moment=9 * one, noise_covariance=3 * one)    # 9 / (9 + 3)
    array([[0.75]])
    """
    seen, wanted = _extended(filters, eye, light_moment, noise_covariance)
    directions, lengths = unit_columns(seen)
    solution = pinv("filters and their noise", directions, rcond=RANK_TOLERANCE) @ wanted
    return np.asarray((solution / np.where(lengths > 0, lengths, 1.0)[:, None]).T)


def readout_error(
    filters: Float[Array, "n p"],
    eye: Float[Array, "n c"],
    *,
    light_moment: Float[Array, "n n"],
    noise_covariance: Float[Array, "p p"],
) -> Float[Array, "c c"]:
    """A^T K A - B F^T K A: second moment of the remaining color error of the best readout.

    Parameters, Raises
        As `best_readout`.

    Parameters
    ----------
    filters
        Spectral responses of the sensor, a column per channel.
    eye
        Curves of the observer, a column per coordinate.
    light_moment
        Second moment K of the lights. [(unit of light)^2]
    noise_covariance
        Mean covariance D of the noise. [e-^2]

    Examples
    --------
    >>> one = np.eye(1)
    >>> readout_error(one, one, light_moment=9 * one, noise_covariance=3 * one).round(12)
    array([[2.25]])
    """
    seen, wanted = _extended(filters, eye, light_moment, noise_covariance)
    missed = _outside(seen, wanted)
    return np.asarray(missed.T @ missed)


def figure_of_merit(
    filters: Float[Array, "n p"],
    eye: Float[Array, "n c"],
    *,
    light_moment: Float[Array, "n n"],
    noise_covariance: Float[Array, "p p"],
    weight: Float[Array, "c c"],
) -> float:
    """1 - MMSE / tr(W A^T K A): the share of the color that the best readout recovers. [1]

    Parameters
    ----------
    filters, eye, light_moment, noise_covariance
        As `best_readout`.
    weight
        W; E[J^T J] with J the Jacobian into a perceptual space (`perceptual_weight`), or
        (A^T A)^-1 where only the span of the observer counts.

    Raises
    ------
    InputError
        As `best_readout`, and if W is not symmetric and >= 0, or the weighted color is 0.

    Notes
    -----
    Special cases: K = 1, D = 0, W = (A^T A)^-1 gives the Vora value; a single filter as target
    and the observer as filters gives Neugebauer's q; K and W from data give the measure of Sharma &
    Trussell, IEEE Trans. Image Process. 6, 990 (1997); shot noise in D gives the family of Quan,
    Ohta & Katoh's unified measure of goodness (UMG).

    Examples
    --------
    >>> one = np.eye(1)
    >>> round(figure_of_merit(one, one, light_moment=9 * one, noise_covariance=3 * one,
    ...                       weight=one), 12)
    0.75
    """
    seen, wanted = _extended(filters, eye, light_moment, noise_covariance)
    root = _root("weight", weight, eye.shape[1])
    total = float(((wanted @ root) ** 2).sum())
    if not total > 0:
        raise InputError(
            "tr(W A^T K A)",
            "must be > 0",
            value=total,
            found="is 0: the wanted color has no weight or sees none of the light",
            remedy="give a weight and a light moment that reach it",
        )
    return float(1.0 - ((_outside(seen, wanted) @ root) ** 2).sum() / total)


def perceptual_weight(jacobian: Float[Array, "m k c"]) -> Float[Array, "c c"]:
    """W = E[J^T J]: weight of color errors in a perceptual space, averaged over samples.

    Parameters
    ----------
    jacobian
        J of each sample, perceptual coordinates per color coordinate.

    Raises
    ------
    InputError
        If an entry is not finite.

    Examples
    --------
    >>> perceptual_weight(np.array([[[1.0, 0.0]], [[0.0, 3.0]]]))
    array([[0.5, 0. ],
           [0. , 4.5]])
    """
    checked = check.finite("jacobian", "1", jacobian)
    return np.asarray(np.einsum("mki,mkj->ij", checked, checked) / checked.shape[0])


def second_moment(lights: Float[Array, "m n"]) -> Float[Array, "n n"]:
    """K = E[l l^T], averaged over samples of light. [(unit of light)^2]

    Parameters
    ----------
    lights
        Samples of light, one per row.

    Raises
    ------
    InputError
        If an entry is not finite.

    Examples
    --------
    >>> second_moment(np.array([[1.0, 0.0], [1.0, 2.0]]))
    array([[1., 1.],
           [1., 2.]])
    """
    checked = check.finite("lights", "unit of light", lights)
    return np.asarray(checked.T @ checked / checked.shape[0])


def _spanning(filters: Array, eye: Array) -> tuple[Array, Array]:
    """Both as finite columns over the same wavelengths, none of them all zero."""
    checked = []
    for name, columns in (("filter", filters), ("eye axis", eye)):
        values = check.finite(f"{name} curves", "1", columns)
        silent = np.flatnonzero(~values.any(axis=0))
        if silent.size:
            raise InputError(
                f"{name} {int(silent[0])} (from 0)",
                "must not be 0 at every wavelength",
                value=0.0,
                found="is, so it spans nothing",
                remedy="omit it",
            )
        checked.append(values)
    check.same_length("wavelengths", filters=checked[0].shape[0], eye=checked[1].shape[0])
    return checked[0], checked[1]


def _orthonormal(columns: Array) -> Array:
    """An orthonormal basis of the span of the columns."""
    u, singular, _ = svd("filters", unit_columns(columns)[0], full_matrices=False)
    return u[:, singular > RANK_TOLERANCE * singular[0]]


def _extended(filters: Array, eye: Array, moment: Array, noise: Array) -> tuple[Array, Array]:
    """X = [K^1/2 F; D^1/2] and Y = [K^1/2 A; 0]."""
    filters, eye = _spanning(filters, eye)
    root = _root("light_moment", moment, filters.shape[0])
    noise_root = _root("noise_covariance", noise, filters.shape[1])
    seen = np.vstack([root @ filters, noise_root])
    return seen, np.vstack([root @ eye, np.zeros((filters.shape[1], eye.shape[1]))])


def _outside(seen: Array, wanted: Array) -> Array:
    """The residual of ``wanted`` after projection on the columns of ``seen``."""
    inside = _orthonormal(seen) if seen.any() else np.zeros((seen.shape[0], 0))
    return wanted - inside @ (inside.T @ wanted)


def _root(name: str, values: Array, size: int) -> Array:
    """The symmetric square root of a symmetric matrix >= 0."""
    matrix = check.finite(name, "1", values)
    shape = (size, size)
    check.shape(name, matrix, matrix.shape == shape, f"must have shape {shape}")
    scale = float(np.abs(matrix).max())
    off = float(np.abs(matrix - matrix.T).max())
    if off > NEGATIVE_TOLERANCE * scale:
        raise InputError(
            name,
            "must be symmetric",
            value=off,
            found=f"two mirrored entries differ by {off:g}",
            remedy="give (S + S^T) / 2",
        )
    eigenvalue, vector = eigh(name, 0.5 * (matrix + matrix.T))
    if eigenvalue[0] < -NEGATIVE_TOLERANCE * scale:
        raise InputError(
            name,
            "must have no negative eigenvalue, as a covariance",
            value=float(eigenvalue[0]),
            found=f"one is {eigenvalue[0]:g}",
        )
    return (vector * np.sqrt(np.maximum(eigenvalue, 0.0))) @ vector.T
