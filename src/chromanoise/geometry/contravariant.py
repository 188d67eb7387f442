"""Contravariant coordinates from covariant ones, with their noise (eq. 3)."""

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.geometry.frame import DualBasis
from chromanoise.noise import Measurement, through


def contravariant(raw: Measurement, frame: DualBasis) -> Measurement:
    """Contravariant coordinates G^-1 M with covariance G^-1 D G^-1. [(units of light)^2 per e-]

    Parameters
    ----------
    raw
        Mean and covariance of the raw channels. [e-]
    frame
        The channels and their dual basis.

    Raises
    ------
    InputError
        If the channels of ``raw`` are not those of ``frame``, in the same order.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 3. Their SNR depends on the metric and falls
    to -inf where a mean coordinate crosses zero; it does not depend on gain.
    """
    _check.same_names("contravariant coordinates", raw=raw.names, frame=frame.names)
    return through(
        raw,
        frame.inverse_gram,
        names=raw.names,
        kind="contravariant",
        unit="(units of light)^2 per e-",
        metric=frame.metric,
    )


def spectral_snr(raw: Measurement, frame: DualBasis) -> Float[Array, "*px"]:
    """Amplitude SNR of the reconstructed spectrum: |L^| / sqrt(E |L^ - E L^|^2).

    With mu and D the mean and covariance of the raw channels, its square is
    mu^T G^-1 mu / tr(G^-1 D). 0 in the dark.

    Parameters
    ----------
    raw
        Mean and covariance of the raw channels. [e-]
    frame
        The channels and their dual basis.

    Raises
    ------
    InputError
        If the channels of ``raw`` are not those of ``frame``, in the same order.
    """
    _check.same_names("spectral SNR", raw=raw.names, frame=frame.names)
    g = frame.inverse_gram
    signal = np.einsum("...i,ij,...j->...", raw.mean, g, raw.mean)
    noise = np.einsum("ij,...ji->...", g, raw.covariance)
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(np.where(signal > 0, signal / np.where(signal > 0, noise, 1), 0)))
