"""Predicted against measured variance through a color matrix."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import pinv
from chromanoise._shapes import Float
from chromanoise.characterization.noise_models import color_of_plane
from chromanoise.characterization.results import SHARED, Characterization, PlaneNoise
from chromanoise.errors import InputError
from chromanoise.io.given_matrices import GivenMatrix


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MatrixCheck:
    """Temporal variance of linear combinations of the planes, at each level from dark to bright.

    Attributes
    ----------
    levels
        Names of the levels.
    measured
        Variance of each row of the matrix, from the covariance of the planes of a cell, without row
        and column noise. [square of (unit of the matrix times e-)]
    predicted
        The same from the linear model of each plane, with independent planes.
    fitted
        Whether all planes are below 70 % of saturation.
    names
        Of the rows of the matrix.
    """

    levels: tuple[str, ...]
    measured: Float[Array, "k q"]
    predicted: Float[Array, "k q"]
    fitted: tuple[bool, ...]
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        _check.freeze(self, "measured", "predicted")

    @property
    def mean_error(self) -> Float[Array, " q"]:
        """Mean of predicted over measured variance minus 1, over the levels that were fitted."""
        used = np.array(self.fitted)
        if not used.any():
            return np.full(self.measured.shape[1], np.nan)
        return np.asarray((self.predicted[used] / self.measured[used] - 1).mean(axis=0))


def variance_through(
    result: Characterization,
    matrix: Float[Array, "q c"],
    channels: tuple[str, ...],
    *,
    names: tuple[str, ...] = (),
) -> MatrixCheck:
    """The variance of each row of a matrix that is applied to electrons, measured and predicted.

    Parameters
    ----------
    result
        A characterization.
    matrix
        One column per channel; of several planes of one channel (``G1``, ``G2``) the mean is taken.
    channels
        Names of the columns, e.g. ``("R", "G", "B")``.
    names
        Names of the rows; numbers by default.

    Raises
    ------
    InputError
        If the channels are not those of the planes, or the matrix has another shape.

    Notes
    -----
    C K^-1 S K^-1 C^T with S the covariance of the codes of a cell and K the gains.
    """
    weights = _by_plane(result, _check.finite("matrix", "1", matrix), channels)
    gain = np.array([plane.gain_dn_per_e for plane in result.planes])
    rows = weights / gain
    shared = np.array([_shared_dn2(plane) for plane in result.planes])
    levels = range(len(result.planes[0].levels))
    model = np.array(
        [[plane.levels[k].predicted_variance_dn2 for plane in result.planes] for k in levels]
    )
    return MatrixCheck(
        levels=tuple(level.name for level in result.planes[0].levels),
        measured=np.einsum("qp,kpr,qr->kq", rows, result.covariance_dn2, rows),
        predicted=np.maximum(model - shared, 0.0) @ (rows**2).T,
        fitted=tuple(all(plane.levels[k].fitted for plane in result.planes) for k in levels),
        names=names or tuple(str(i + 1) for i in range(len(rows))),
    )


def variance_through_file(result: Characterization, given: GivenMatrix) -> MatrixCheck:
    """`variance_through` for the color matrix of a file.

    Parameters
    ----------
    result
        A characterization.
    given
        From `chromanoise.io.given_matrices.read_matrix`. A matrix for white-balanced raw is applied
        to electrons divided by those of the brightest fitted level, whose light counts as white.

    Raises
    ------
    InputError
        As `variance_through`, or if no level is below saturation in all planes.
    """
    own = tuple(dict.fromkeys(color_of_plane(plane.name) for plane in result.planes))
    channels = given.channels or own
    values = given.values
    if given.kind == "from-xyz":
        values = pinv(f"matrix of {given.source}", values)
    elif given.kind == "balanced":
        white = _white_e(result)
        values = values / np.array([white.get(name, 1.0) for name in channels])
    names = ("X", "Y", "Z") if given.target == "XYZ" else ("R", "G", "B")
    return variance_through(result, values, channels, names=names)


def _white_e(result: Characterization) -> dict[str, float]:
    """Electrons of each channel at the brightest level that was fitted in all planes."""
    fitted = [
        k
        for k in range(len(result.planes[0].levels))
        if all(plane.levels[k].fitted for plane in result.planes)
    ]
    if not fitted:
        raise InputError(
            result.source, "must have a level below 70 % of saturation in all planes for a matrix"
        )
    electrons: dict[str, list[float]] = {}
    for plane in result.planes:
        level = plane.levels[fitted[-1]]
        above = level.mean_dn - (level.dark_mean_dn or 0.0)
        electrons.setdefault(color_of_plane(plane.name), []).append(above / plane.gain_dn_per_e)
    return {name: float(np.mean(values)) for name, values in electrons.items()}


def _shared_dn2(plane: PlaneNoise) -> float:
    """Variance of row and column noise. [DN^2]"""
    parts = (getattr(plane, name) or 0.0 for name in SHARED)
    return plane.gain_dn_per_e**2 * sum(part**2 for part in parts)


def _by_plane(
    result: Characterization, matrix: Float[Array, "q c"], channels: tuple[str, ...]
) -> Float[Array, "q p"]:
    of_plane = [_channel_of(plane.name, channels) for plane in result.planes]
    if sorted(set(of_plane)) != sorted(channels):
        names = ", ".join(plane.name for plane in result.planes)
        raise InputError(
            "matrix",
            f"must have the channels of the planes {names}",
            value=channels,
            found=f"has {', '.join(channels)}",
        )
    if matrix.ndim != 2 or matrix.shape[1] != len(channels):
        raise InputError(
            "matrix",
            f"must have one column for each of {', '.join(channels)}",
            value=matrix.shape,
            found=f"has shape {matrix.shape}",
        )
    columns = [channels.index(name) for name in of_plane]
    counts = np.array([of_plane.count(name) for name in of_plane])
    return np.asarray(matrix[:, columns] / counts)


def _channel_of(plane: str, channels: tuple[str, ...]) -> str:
    """The channel of a plane: ``G`` for ``G1``, unless there is a channel ``G1``."""
    return plane if plane in channels else color_of_plane(plane)
