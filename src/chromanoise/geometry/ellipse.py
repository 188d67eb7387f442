"""The true plane of two channels, and ellipses of uncertainty in it: Figures 3, 4, 6, 9 and 10."""

import numpy as np

from chromanoise.base import Array, Float, check, cholesky, dataclass


@dataclass(frozen=True, kw_only=True, eq=False)
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
        check.freeze(self, "axes", "vectors")

    def seen(self, light: Float[Array, "*px n"]) -> Float[Array, "*px 2"]:
        """Orthogonal projection of any spectra into the plane.

        Parameters
        ----------
        light
            Spectra, the wavelengths last.
        """
        return light @ self.axes


def plane_view(first: Float[Array, " n"], second: Float[Array, " n"]) -> PlaneView:
    """The plane of two independent channels, the first drawn to the right, the second upward.

    Parameters
    ----------
    first
        Vector of the first channel.
    second
        Vector of the second channel.
    """
    right = first / np.linalg.norm(first)
    rest = second - (second @ right) * right
    rest -= (rest @ right) * right  # repeated, so that the axes are orthogonal to rounding
    axes = np.stack([right, rest / np.linalg.norm(rest)], axis=1)
    return PlaneView(axes=axes, vectors=axes.T @ np.stack([first, second], axis=1))


def ellipse_half_axes(
    covariance: Float[Array, "*px 2 2"], *, sigmas: float
) -> Float[Array, "*px 2 2"]:
    """Two conjugate half axes of the ellipse at ``sigmas`` standard deviations, one per row.

    Its points are the center plus cos(t) times the first plus sin(t) times the second.

    Parameters
    ----------
    covariance
        Covariance of two coordinates.
    sigmas
        Standard deviations from the center. [1]

    Examples
    --------
    >>> ellipse_half_axes(np.array([[4.0, 2.0], [2.0, 2.0]]), sigmas=2.0)
    array([[4., 2.],
           [0., 2.]])
    """
    return sigmas * np.swapaxes(cholesky("covariance of an ellipse", covariance), -1, -2)


def unit_circle(points: int) -> Float[Array, "points 2"]:
    """Cosine and sine of evenly spaced angles from 0 to 360 deg, both included.

    Parameters
    ----------
    points
        Number of points on the outline.

    Examples
    --------
    >>> unit_circle(3).round(6) + 0.0
    array([[ 1.,  0.],
           [-1.,  0.],
           [ 1.,  0.]])
    """
    turn = np.linspace(0, 2 * np.pi, points)
    return np.stack([np.cos(turn), np.sin(turn)], axis=1)


def ellipse_outline(
    center: Float[Array, "*px 2"],
    covariance: Float[Array, "*px 2 2"],
    *,
    sigmas: float,
    points: int = 181,
) -> Float[Array, "*px points 2"]:
    """The closed curve at ``sigmas`` standard deviations (Mahalanobis) around ``center``.

    Parameters
    ----------
    center
        Means of the two coordinates.
    covariance
        Covariance of two coordinates.
    sigmas
        Standard deviations from the center. [1]
    points
        Number of points on the outline.

    Examples
    --------
    >>> ellipse_outline(np.zeros(2), np.diag([4.0, 1.0]), sigmas=1.0, points=5).round(6) + 0.0
    array([[ 2.,  0.],
           [ 0.,  1.],
           [-2.,  0.],
           [ 0., -1.],
           [ 2.,  0.]])
    """
    half_axes = ellipse_half_axes(covariance, sigmas=sigmas)
    return center[..., None, :] + unit_circle(points) @ half_axes
