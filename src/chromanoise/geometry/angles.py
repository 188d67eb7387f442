"""Angles between channels, variance inflation, and near-linear dependence of channels."""

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Bool,
    Float,
    angles_deg,
    dataclass,
    lstsq,
    matrix_rank,
    unit_columns,
)
from chromanoise.geometry.dual_basis import DualBasis
from chromanoise.spectra import Metric

_LARGEST_EXACT_VIF = 1e8  # above, rounding in G^-1 makes the fit more accurate
_NEARLY = 0.99  # fits decide between channels whose VIF differ by less


def variance_inflation(frame: DualBasis) -> Float[Array, " p"]:
    """VIF_i = |f_i|^2 (G^-1)_ii = 1 / sin^2 phi_i; inf for a linearly dependent channel.

    phi_i is the angle between channel i and the span of the others. 1 for orthogonal channels.

    Parameters
    ----------
    frame
        The channels and their dual basis.

    Notes
    -----
    The weight of the channel's own reading in its contravariant coordinate is VIF_i / |f_i|^2, so
    the standard deviation of its own noise is multiplied by VIF_i there, and the noise of the
    other channels is added. The whole variance is multiplied by VIF_i only where the covariance
    of the noise is proportional to G, as in a regression; independent noise of the channels gives
    more: for two channels at an angle t (1 + cos^2 t) / sin^4 t.

    Examples
    --------
    >>> from chromanoise.geometry import dual_frame
    >>> at_30_deg = np.array([[1.0, np.cos(np.pi / 6)], [0.0, np.sin(np.pi / 6)]])
    >>> variance_inflation(dual_frame(at_30_deg, names=("a", "b"), metric="quanta")).round(9)
    array([4., 4.])
    """
    lengths_squared = (frame.basis**2).sum(axis=0)
    inflation = lengths_squared * np.diagonal(frame.inverse_gram)
    if frame.rank == frame.basis.shape[1]:
        return inflation
    return np.where(_in_span_of_others(frame), np.inf, inflation)


def angles_between_deg(frame: DualBasis) -> Float[Array, "p p"]:
    """Angle of every pair of channels. [deg]

    Parameters
    ----------
    frame
        The channels and their dual basis.
    """
    return angles_deg(frame.basis, frame.basis)


def angles_to_axes_deg(frame: DualBasis, axes: Float[Array, "n c"]) -> Float[Array, "p c"]:
    """Angle of every channel to every color axis, e.g. the columns of H: Table 5's theta. [deg]

    Parameters
    ----------
    frame
        The channels and their dual basis.
    axes
        Color axes, a column per coordinate.
    """
    return angles_deg(frame.basis, axes)


@dataclass(frozen=True, kw_only=True)
class NearestMix:
    """The channel that is closest to a linear combination of the others, and its weights.

    Attributes
    ----------
    channel
        Name of the channel.
    weights
        Weights of the other channels in the best approximation.
    angle_deg
        Angle between the channel and the span of the others; 0 for a linearly dependent channel.
    explained
        cos^2 of that angle: the share of the channel that the linear combination reproduces.
    metric
        The metric of the frame; weights and angle depend on it.
    """

    channel: str
    weights: dict[str, float]
    angle_deg: float
    explained: float
    metric: Metric


def nearest_mix(frame: DualBasis) -> NearestMix | None:
    """The channel closest to a linear combination of the others; ``None`` for a single one.

    Parameters
    ----------
    frame
        The channels and their dual basis.
    """
    if len(frame.names) < 2:
        return None
    vif = variance_inflation(frame)  # 1 over the squared sine of the angle
    largest = vif.max()
    near = np.flatnonzero(vif >= (_NEARLY * largest if largest < _LARGEST_EXACT_VIF else 0.0))
    return min((_mix(frame, int(i)) for i in near), key=lambda mix: mix.angle_deg)


def _mix(frame: DualBasis, i: int) -> NearestMix:
    target = frame.basis[:, i]
    others = np.delete(frame.basis, i, axis=1)
    names = [name for k, name in enumerate(frame.names) if k != i]
    directions, lengths = unit_columns(others)
    what = f"channel {frame.names[i]} as a mix of the others"
    weights = lstsq(what, directions, target, rcond=None)[0] / lengths
    # sine from the residual and cosine from the fit: accurate at both ends
    fit = others @ weights
    angle = float(np.degrees(np.arctan2(np.linalg.norm(target - fit), np.linalg.norm(fit))))
    return NearestMix(
        channel=frame.names[i],
        weights=dict(zip(names, (float(w) for w in weights), strict=True)),
        angle_deg=angle,
        explained=float(np.cos(np.radians(angle)) ** 2),
        metric=frame.metric,
    )


def _in_span_of_others(frame: DualBasis) -> Bool[Array, " p"]:
    """True where omitting the channel does not lower the rank."""
    directions, _ = unit_columns(frame.basis)
    p = directions.shape[1]
    smallest = RANK_TOLERANCE * np.linalg.norm(directions, 2)  # the tolerance of the frame
    ranks = [
        matrix_rank("channels without one", np.delete(directions, i, axis=1), tol=smallest)
        for i in range(p)
    ]
    return np.array(ranks) == frame.rank
