"""Linear algebra of small matrices: products that broadcast over pixels, ranks, angles.

All linear solvers are called here, after a check for numbers that are not finite: LAPACK may loop
forever over such a number while it holds the interpreter lock.
"""

import ctypes
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.linalg import _umath_linalg

from chromanoise.base.check import Array
from chromanoise.base.errors import InputError
from chromanoise.base.shapes import Float

RANK_TOLERANCE = 1e-10
"""Singular values of unit-norm columns below this share of the largest count as zero."""
_ROUNDING = 1e-14  # of an eigenvalue of correlations, whose largest is 1 or more


def _of_finite(solver: Callable[..., Any], what: str, *arrays: Array, **options: Any) -> Any:
    """The result of a numpy solver for ``arrays``; ``what`` names them in the message.

    Raises
    ------
    InputError
        If a number is not finite, or the solver finds no solution.
    """
    for array in arrays:
        if not np.isfinite(array).all():
            bad = ~np.isfinite(array)
            first = np.asarray(array)[bad][0]
            raise InputError(
                what,
                "must be finite",
                value=first,
                found=f"{int(bad.sum())} of {bad.size} numbers overflow double precision; the "
                f"first is {first:g}",
                remedy="choose less extreme values of the light, the exposure, the pixel or the "
                "matrix",
            )
    try:
        return solver(*arrays, **options)
    except np.linalg.LinAlgError as error:
        raise InputError(what, f"has no solution in double precision ({error})") from None


cholesky = partial(_of_finite, np.linalg.cholesky)
det = partial(_of_finite, np.linalg.det)
eigvalsh = partial(_of_finite, np.linalg.eigvalsh)
inv = partial(_of_finite, np.linalg.inv)
lstsq = partial(_of_finite, np.linalg.lstsq)
matrix_rank = partial(_of_finite, np.linalg.matrix_rank)
pinv = partial(_of_finite, np.linalg.pinv)
qr = partial(_of_finite, np.linalg.qr)
solve = partial(_of_finite, np.linalg.solve)


def eigh(what: str, s: Array) -> tuple[Array, Array]:
    """Eigenvalues and eigenvectors of symmetric matrices; signs of real ones depend on no library.

    Parameters
    ----------
    s
        Symmetric or Hermitian, over the last two axes.
    """
    values, vectors = _of_finite(np.linalg.eigh, what, s)
    return values, vectors if np.iscomplexobj(vectors) else vectors * _signs(vectors)


def svd(what: str, a: Array, **options: Any) -> Any:
    """The singular value decomposition of numpy; signs of real vectors depend on no library."""
    found = _of_finite(np.linalg.svd, what, a, **options)
    if isinstance(found, np.ndarray) or np.iscomplexobj(a):
        return found
    u, singular, rows = found
    signs, shared = _signs(np.swapaxes(rows, -1, -2)), singular.shape[-1]
    of_u = _signs(u)
    of_u[..., :shared] = signs[..., :shared]
    return u * of_u, singular, rows * np.swapaxes(signs, -1, -2)


def _signs(columns: Array) -> Array:
    """1 or -1 for each column, which make its largest entry positive; the first of equal ones."""
    if not columns.size:
        return np.ones((*columns.shape[:-2], 1, columns.shape[-1]))
    sizes = np.abs(columns)
    largest = np.argmax(sizes >= 0.999 * sizes.max(axis=-2, keepdims=True), axis=-2)
    if columns.ndim == 2:  # most often, and several times as fast
        entries = columns[largest, np.arange(largest.size)][None]
    else:
        entries = np.take_along_axis(columns, largest[..., None, :], axis=-2)
    return np.where(entries < 0, -1.0, 1.0)


def orthogonal_complement(direction: Float[Array, "*k p"]) -> Float[Array, "*k p q"]:
    """Orthonormal basis of the orthogonal complement of a direction (Householder reflection)."""
    length = np.linalg.norm(direction, axis=-1, keepdims=True)
    mirror = direction / np.where(length > 0, length, 1.0)
    mirror[..., 0] += np.where(mirror[..., 0] >= 0, 1.0, -1.0)
    twice = 2.0 / (mirror**2).sum(axis=-1, keepdims=True)
    return np.asarray((np.eye(direction.shape[-1]) - _outer_of(mirror, twice * mirror))[..., 1:])


def congruence(a: Float[Array, "q p"], s: Float[Array, "*px p p"]) -> Float[Array, "*px q q"]:
    """A S A^T, exactly symmetric."""
    product = a @ s @ a.T
    return 0.5 * (product + np.swapaxes(product, -1, -2))


def congruence_of_many(
    a: Float[Array, "q p"], s: Float[Array, "*px p p"]
) -> Float[Array, "*px q q"]:
    """As `congruence`, by one product for all pixels: faster for many small matrices."""
    (q, p), each = a.shape, (a[:, None, :, None] * a[:, None]).reshape(len(a) ** 2, -1)
    product = (s.reshape(-1, p * p) @ each.T).reshape(*s.shape[:-2], q, q)
    return np.asarray(0.5 * (product + np.swapaxes(product, -1, -2)))


def variances_along(a: Float[Array, "q p"], s: Float[Array, "*px p p"]) -> Float[Array, "*px q"]:
    """The diagonal of A S A^T, by one product for all pixels."""
    q, p = a.shape
    squares = (a[:, :, None] * a[:, None]).reshape(q, p * p)
    return np.asarray(s.reshape(*s.shape[:-2], p * p) @ squares.T)


def diagonal(variance: Float[Array, "*px p"]) -> Float[Array, "*px p p"]:
    """The diagonal matrix of these entries: the covariance of independent channels."""
    return variance[..., None] * np.eye(variance.shape[-1])


def covariance_root(what: str, s: Float[Array, "*k p p"]) -> Float[Array, "*k p p"]:
    """R with R^T R = S, for a covariance S; diagonal, as the root of each entry, where S is."""
    sd = np.sqrt(np.diagonal(s, axis1=-2, axis2=-1))
    return np.asarray(_correlation_power(what, s, sd, 0.5) * sd[..., None, :])


def whitening(what: str, s: Float[Array, "*k p p"]) -> Float[Array, "*k p p"]:
    """W with W^T S W = 1, for a covariance S; 0 for a direction without noise."""
    sd = np.sqrt(np.diagonal(s, axis1=-2, axis2=-1))
    inverse = np.where(sd > 0, 1.0 / np.where(sd > 0, sd, 1.0), 0.0)
    return np.asarray(inverse[..., None] * _correlation_power(what, s, sd, -0.5))


def _correlation_power(
    what: str, s: Float[Array, "*k p p"], sd: Float[Array, "*k p"], power: float
) -> Float[Array, "*k p p"]:
    """A power of the correlations of a covariance; eigenvalues of rounding size count as 0."""
    identity = np.broadcast_to(np.eye(s.shape[-1]), s.shape)
    scale = np.where(sd > 0, sd, 1.0)
    correlation = np.where(identity > 0, 1.0, s / _outer_of(scale, scale))
    if (correlation == identity).all():
        return identity
    value, vector = eigh(what, correlation)
    kept = value > _ROUNDING
    powers = np.where(kept, np.where(kept, value, 1.0) ** power, 0.0)
    return np.asarray((vector * powers[..., None, :]) @ np.swapaxes(vector, -1, -2))


def _outer_of(one: Float[Array, "*k p"], other: Float[Array, "*k p"]) -> Float[Array, "*k p p"]:
    return np.asarray(one[..., :, None] * other[..., None, :])


def unit_columns(
    f: Float[Array, "*m n p"],
) -> tuple[Float[Array, "*m n p"], Float[Array, "*m p"]]:
    """Columns of length 1, and the lengths; a zero column stays zero."""
    norms = np.linalg.norm(f, axis=-2)
    return f / np.where(norms > 0, norms, 1.0)[..., None, :], norms


def angles_deg(a: Float[Array, "n p"], b: Float[Array, "n q"]) -> Float[Array, "p q"]:
    """Angles of the columns of ``a`` with those of ``b``, accurate near 0 and 180 (Kahan). [deg]"""
    u, v = (columns / np.linalg.norm(columns, axis=0) for columns in (a, b))
    apart = np.linalg.norm(u[:, :, None] - v[:, None, :], axis=0)
    together = np.linalg.norm(u[:, :, None] + v[:, None, :], axis=0)
    return np.asarray(np.degrees(2 * np.arctan2(apart, together)))


def blas_kernel() -> str | None:
    """The kernel that OpenBLAS chose for this processor, or that OPENBLAS_CORETYPE names.

    ``None`` if numpy uses another BLAS, and on Windows, where a library shows only its own names.
    """
    loaded = ctypes.CDLL(_umath_linalg.__file__)  # names of all libraries that it is linked to
    for name in _KERNEL_NAMES:
        if hasattr(loaded, name):
            named = getattr(loaded, name)
            named.restype = ctypes.c_char_p
            return str(named().decode())
    return None


_KERNEL_NAMES = [
    f"{library}_get_corename{integers}"
    for library in ("scipy_openblas", "openblas")
    for integers in ("64_", "")
]
