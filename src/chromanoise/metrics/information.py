"""Information of raw channels about a Gaussian signal, in bits per pixel."""

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import congruence, eigh, eigvalsh, svd
from chromanoise._shapes import Bool, Float
from chromanoise.errors import InputError

_ROUNDING = 1e-13  # share of a variance, or of a unit row, below which a number is rounding
_SIGNAL = 1e-9  # share of the variance of independent channels that is signal, not rounding


def information_bits(
    signal_covariance: Float[Array, "*#px p p"],
    noise_covariance: Float[Array, "*#px p p"],
    matrix: Float[Array, "q p"] | None = None,
) -> Float[Array, "*px"]:
    """Mutual information of one pixel and a Gaussian signal, 1/2 log2 det(I + N^-1 S). [bit]

    Parameters
    ----------
    signal_covariance
        S, covariance of the expected electrons. [e-^2]
    noise_covariance
        N, covariance of the noise; broadcast with the signal. [e-^2]
    matrix
        A linear map A of the channels to ``q`` coordinates, which gives the information of A S A^T
        and A N A^T. Only its row space matters: an invertible map loses nothing, and linearly
        dependent rows are no error. ``None`` for the channels themselves.

    Raises
    ------
    InputError
        If a number is not finite, the shapes do not match, or a covariance has a negative
        eigenvalue.

    Notes
    -----
    Cover & Thomas, *Elements of Information Theory* (2006), section 9.4; Shannon, Bell Syst.
    Tech. J. 27, 623 (1948). Of all signals with this covariance the Gaussian one carries the most
    information. The result is inf where a mix of the channels has signal and no noise. With the
    covariance K of the spectra and the measurement vectors F, S is F^T K F.

    Examples
    --------
    One channel with an SNR of 3: 1/2 log2(1 + 3^2). The difference of two equal channels has no
    signal, their sum has all the information.

    >>> one = np.eye(1)
    >>> round(float(information_bits(9 * one, one)), 4)
    1.661
    >>> equal = np.ones((2, 2))
    >>> information_bits(equal, np.eye(2), np.array([[1.0, 1.0]])).round(12)
    np.float64(0.792481250361)
    >>> information_bits(equal, np.eye(2), np.array([[1.0, -1.0]])).round(12)
    np.float64(0.0)
    """
    signal = _covariance("signal_covariance", signal_covariance)
    noise = _covariance("noise_covariance", noise_covariance)
    _check.same_length("channels", signal=signal.shape[-1], noise=noise.shape[-1])
    if matrix is not None:
        rows = _row_space(_check.finite("matrix", "1", matrix))
        _check.same_length("channels", signal=signal.shape[-1], matrix=rows.shape[1])
        signal, noise = congruence(rows, signal), congruence(rows, noise)
    spread, own = (np.diagonal(s, axis1=-2, axis2=-1) for s in (signal, noise))
    silent = (own == 0) & (spread == 0)
    scale = np.sqrt(np.where(silent, 1.0, np.where(own > 0, own, spread)))
    signal, noise = (s / (scale[..., :, None] * scale[..., None, :]) for s in (signal, noise))
    noise = noise + silent[..., None] * np.eye(noise.shape[-1])  # any noise: there is no signal
    variance, axes = eigh("noise_covariance", noise)
    _refuse_negative("noise_covariance", variance)
    noisy = variance > _ROUNDING * variance.max(axis=-1, keepdims=True, initial=0.0)
    along = np.swapaxes(axes, -1, -2) @ signal @ axes
    gain = np.where(noisy, 1.0, 0.0) / np.sqrt(np.where(noisy, variance, 1.0))
    whitened = eigvalsh("signal_covariance", gain[..., :, None] * along * gain[..., None, :])
    _refuse_negative("signal_covariance", whitened)
    bits = 0.5 * np.log1p(np.maximum(whitened, 0.0)).sum(axis=-1) / np.log(2.0)
    return np.asarray(np.where(_endless(signal, axes, noisy), np.inf, bits))


def _endless(signal: Array, axes: Array, noisy: Array) -> Bool[Array, "*px"]:
    """Whether a direction without noise has signal that is more than rounding."""
    own = np.diagonal(signal, axis1=-2, axis2=-1)
    seen = np.einsum("...ik,...ij,...jk->...k", axes, signal, axes)
    if_independent = np.einsum("...ik,...i->...k", axes**2, own)
    return np.asarray((~noisy & (seen > _SIGNAL * if_independent)).any(axis=-1))


def _row_space(matrix: Float[Array, "q p"]) -> Float[Array, "r p"]:
    """Orthonormal rows that span those of a matrix; the axes themselves if it is invertible."""
    length = np.linalg.norm(matrix, axis=1)
    unit = matrix[length > 0] / length[length > 0, None]
    _, singular, rows = svd("matrix", unit, full_matrices=False)
    kept = singular > _ROUNDING * singular.max(initial=0.0)
    return np.eye(matrix.shape[1]) if kept.sum() == matrix.shape[1] else np.asarray(rows[kept])


def _covariance(name: str, values: Array) -> Float[Array, "*px p p"]:
    """A finite, symmetric matrix."""
    checked = _check.finite(name, "e-^2", values)
    diagonal = np.diagonal(checked, axis1=-2, axis2=-1)
    _check.non_negative(f"diagonal of {name}", "e-^2", diagonal)
    return np.asarray(0.5 * (checked + np.swapaxes(checked, -1, -2)))


def _refuse_negative(name: str, eigenvalues: Array) -> None:
    largest = np.abs(eigenvalues).max(initial=0.0)
    if (eigenvalues < -_SIGNAL * largest).any():
        least = float(eigenvalues.min())
        raise InputError(
            name,
            "must have no negative eigenvalue, as a covariance",
            value=least,
            found=f"one is {least:.3g}, with the noise of each channel scaled to 1",
        )
