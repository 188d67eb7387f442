"""The basis of sensor space, its dual, and contravariant coordinates with their noise (eq. 3)."""

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Float,
    InputError,
    check,
    dataclass,
    svd,
    unit_columns,
    with_short_repr,
)
from chromanoise.noise import Measurement, through
from chromanoise.spectra import Metric


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class DualBasis:
    """``p`` measurement vectors, their dual basis and their conditioning.

    Attributes
    ----------
    basis
        F of eq. 3: one column f_i per channel. [e- per unit of light]
    dual
        F G^-1, with f^i . f_j = delta_ij: columns that reconstruct light from electrons (eq. 4).
        [unit of light per e-]
    inverse_gram
        G^-1 = (F^T F)^-1; the pseudo-inverse where F is rank-deficient.
        [(unit of light)^2 per e-^2]
    names
        Name of each channel, in the order of ``basis``.
    metric
        Metric of the space of spectra.
    rank
        Number of independent channels; less than p means the sensor is singular.
    condition
        Largest over smallest singular value of the channels scaled to length 1, so that it does
        not depend on gain; inf where F is rank-deficient.
    """

    basis: Float[Array, "n p"]
    dual: Float[Array, "n p"]
    inverse_gram: Float[Array, "p p"]
    names: tuple[str, ...]
    metric: Metric
    rank: int
    condition: float

    def __post_init__(self) -> None:
        check.same_length("channels", names=len(self.names), basis=self.basis.shape[1])
        check.freeze(self, "basis", "dual", "inverse_gram")


def dual_frame(basis: Float[Array, "n p"], *, names: tuple[str, ...], metric: Metric) -> DualBasis:
    """The dual basis by singular values of the unit-length channels.

    Linearly dependent channels are not an error: ``rank`` is less than p, and the pseudo-inverse
    replaces G^-1.

    Parameters
    ----------
    basis
        F, the matrix with one column per channel.
    names, metric
        Names of the channels, and the metric of their light.

    Raises
    ------
    InputError
        If a channel is zero at every wavelength.

    Examples
    --------
    >>> f = np.array([[1.0, 1.0], [0.0, 1.0]])
    >>> frame = dual_frame(f, names=("a", "b"), metric="quanta")
    >>> (frame.dual.T @ f).round(12) + 0.0
    array([[1., 0.],
           [0., 1.]])
    """
    directions, lengths = unit_columns(basis)
    for name, length in zip(names, lengths, strict=True):
        if not length > 0:
            raise InputError(
                f"channel {name}",
                "must be above 0 at some wavelength",
                value=0.0,
                found="is zero at all of them and spans nothing",
                remedy="omit it",
            )
    u, singular, vt, inverse = _inverted(f"channels {', '.join(names)}", directions)
    whitened = vt.T * inverse / lengths[:, None]
    rank = int((inverse > 0).sum())
    full = rank == basis.shape[1]
    return DualBasis(
        basis=basis,
        dual=(u * inverse) @ vt / lengths,
        inverse_gram=whitened @ whitened.T,
        names=names,
        metric=metric,
        rank=rank,
        condition=float(singular[0] / singular[-1]) if full else float("inf"),
    )


def dual_and_orthonormal_bases(
    basis: Float[Array, "m n p"],
) -> tuple[Float[Array, "m n p"], Float[Array, "m n p"]]:
    """The dual bases of many sensors as `dual_frame`, and orthonormal bases of their spans.

    Columns beyond the rank of an orthonormal basis are 0.

    Parameters
    ----------
    basis
        F of each sensor; no column is zero at every wavelength.
    """
    directions, lengths = unit_columns(basis)
    u, _, vt, inverse = _inverted("channels of many sensors", directions)
    dual = (u * inverse[:, None, :]) @ vt / lengths[:, None, :]
    return dual, u * (inverse > 0)[:, None, :]


def _inverted(
    what: str, directions: Float[Array, "*m n p"]
) -> tuple[Array, Array, Array, Float[Array, "*m r"]]:
    """Singular values and vectors, and inverse singular values, 0 where they count as zero."""
    u, singular, vt = svd(what, directions, full_matrices=False)
    kept = singular > RANK_TOLERANCE * singular[..., :1]
    return u, singular, vt, np.where(kept, 1.0 / np.where(kept, singular, 1.0), 0.0)


def reconstructed_light(frame: DualBasis, mean_e: Float[Array, "*px p"]) -> Float[Array, "*px n"]:
    """The spectrum reconstructed from the electrons, L^ = F G^-1 M (eq. 4).

    Parameters
    ----------
    frame
        The channels and their dual basis.
    mean_e
        Expected electrons of each channel. [e-]
    """
    return mean_e @ frame.dual.T


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
    check.same_names("contravariant coordinates", raw=raw.names, frame=frame.names)
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
    check.same_names("spectral SNR", raw=raw.names, frame=frame.names)
    g = frame.inverse_gram
    signal = np.einsum("...i,ij,...j->...", raw.mean, g, raw.mean)
    noise = np.einsum("ij,...ji->...", g, raw.covariance)
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(np.where(signal > 0, signal / np.where(signal > 0, noise, 1), 0)))
