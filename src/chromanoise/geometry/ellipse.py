"""The true plane of two channels, and ellipses of uncertainty in it: Figures 3, 4, 6, 9 and 10."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import cholesky
from chromanoise._shapes import Float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlaneView:
    """Orthonormal coordinates in the plane of two channels, which preserve lengths and angles.

    Attributes
    ----------
    axes
        Two orthonormal columns; the first is parallel to the first channel.
    vectors
        The two channels in the plane, one per column.
    """

    axes: Float[Array, "n 2"]
    vectors: Float[Array, "2 2"]

    def __post_init__(self) -> None:
        _check.freeze(self, "axes", "vectors")

    def seen(self, light: Float[Array, "*px n"]) -> Float[Array, "*px 2"]:
        """Orthogonal projection of any spectra into the plane."""
        return light @ self.axes


def plane_view(first: Float[Array, " n"], second: Float[Array, " n"]) -> PlaneView:
    """The plane of two independent channels, the first drawn to the right, the second upward."""
    right = first / np.linalg.norm(first)
    rest = second - (second @ right) * right
    rest -= (rest @ right) * right  # repeated, so that the axes are orthogonal to rounding
    axes = np.stack([right, rest / np.linalg.norm(rest)], axis=1)
    return PlaneView(axes=axes, vectors=axes.T @ np.stack([first, second], axis=1))


def ellipse_outline(
    center: Float[Array, "*px 2"],
    covariance: Float[Array, "*px 2 2"],
    *,
    sigmas: float,
    points: int = 181,
) -> Float[Array, "*px points 2"]:
    """The closed curve at ``sigmas`` standard deviations (Mahalanobis) around ``center``.

    Examples
    --------
    >>> ellipse_outline(np.zeros(2), np.diag([4.0, 1.0]), sigmas=1.0, points=5).round(6) + 0.0
    array([[ 2.,  0.],
           [ 0.,  1.],
           [-2.,  0.],
           [ 0., -1.],
           [ 2.,  0.]])
    """
    turn = np.linspace(0, 2 * np.pi, points)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    root = cholesky("covariance of an ellipse", covariance)
    return center[..., None, :] + sigmas * circle @ np.swapaxes(root, -1, -2)
