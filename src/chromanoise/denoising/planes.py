"""Input of every denoising method: planes of independent noise, and the noise itself.

A mosaic becomes one plane per place of its tile, so the methods have no code for mosaics.
"""

from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import eigh
from chromanoise._shapes import Float, Float32
from chromanoise.errors import InputError
from chromanoise.sensor import VarianceLaw


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NoisyPlanes:
    """Noisy values of every plane at every pixel, and the model of their noise.

    Attributes
    ----------
    values_e
        Noisy values; the noise of pixels and planes is independent. [e-]
    law
        Variance of the noise, per plane; a law without planes counts for all of them.
    prior_e2
        Covariance of the planes over typical scenes, e.g. the ColorChecker. [e-^2]
    prior_mean_e
        Mean of the planes over typical scenes. [e-]
    names
        Names of the planes.

    Raises
    ------
    InputError
        If a value is not finite, or the lengths differ.
    """

    values_e: Float32[Array, "h w p"]
    law: VarianceLaw
    prior_e2: Float[Array, "p p"]
    prior_mean_e: Float[Array, " p"]
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        if not np.isfinite(self.values_e).all():
            _check.finite("values_e", "e-", self.values_e)
        _check.non_negative("prior_mean_e", "e-", self.prior_mean_e)
        _check.finite("prior_e2", "e-^2", self.prior_e2)
        _check.same_length(
            "planes",
            names=len(self.names),
            values=self.values_e.shape[-1],
            prior=len(self.prior_e2),
            mean=len(self.prior_mean_e),
        )
        object.__setattr__(self, "law", self.law.of_planes(len(self.names)))
        _check.freeze(self, "prior_e2", "prior_mean_e")

    def variance_e2(self, mean_e: Float[Array, "*px p"]) -> Float[Array, "*px p"]:
        """Variance of the noise at a mean; a mean below 0, from noise, counts as 0. [e-^2]

        Parameters
        ----------
        mean_e
            Mean of each plane. [e-]

        Examples
        --------
        >>> planes = NoisyPlanes(
        ...     values_e=np.zeros((1, 1, 1), np.float32), prior_e2=np.eye(1),
        ...     law=VarianceLaw(floor_e2=25.0, slope_e=1.0, square=0.01**2),
        ...     prior_mean_e=np.ones(1), names=("W",))
        >>> planes.variance_e2(np.array([[-3.0], [1000.0]])).ravel()
        array([  25., 1125.])
        """
        return self.law.variance_e2(np.maximum(mean_e, 0.0))

    def rows(self, start: int, stop: int) -> "NoisyPlanes":
        """The planes of the rows ``start`` to ``stop``.

        Parameters
        ----------
        start
            First row.
        stop
            Row after the last.
        """
        return replace(self, values_e=self.values_e[start:stop])

    @property
    def noise_unit_e(self) -> Float[Array, " p"]:
        """Standard deviation of the noise of each plane at the mean of typical scenes. [e-]"""
        return np.sqrt(self.variance_e2(self.prior_mean_e))

    def components(self) -> tuple[Float[Array, "p k"], Float[Array, " k"]]:
        """Orthonormal directions in which signal and noise are both uncorrelated, and their SNR.

        The planes are divided by `noise_unit_e`, so the noise is white in every orthonormal basis;
        this basis diagonalizes the covariance of typical scenes. The first direction has most
        signal and is close to luminance; the last ones hold color below the noise.

        Returns
        -------
        directions, power_snr
            A direction in each column, and the variance of typical scenes along it over that of the
            noise, in descending order. [1]

        Raises
        ------
        InputError
            If a plane has no noise.
        """
        unit = self.noise_unit_e
        if not (unit > 0).all():
            raise InputError(
                "noise of the planes",
                "must be above 0 at the mean of typical scenes",
                value=float(unit.min()),
                remedy="give a read noise above 0",
            )
        power, directions = eigh("prior_e2", self.prior_e2 / np.outer(unit, unit))
        # the sign of a direction is free: the largest entry is positive on every machine
        signs = np.sign(directions[np.abs(directions).argmax(axis=0), np.arange(len(unit))])
        return (directions * signs)[:, ::-1], np.maximum(power[::-1], 0.0)


def packed(
    raw_e: Float32[Array, "h w"], tile: Array
) -> tuple[Float32[Array, "ht wt k"], tuple[int, ...]]:
    """A mosaic as one plane per place of its tile, and the channel of each plane.

    Parameters
    ----------
    raw_e
        One value per pixel, at least one tile of them. An incomplete tile at the border is filled
        with the last pixels of the same place. [e-]
    tile
        Index of the channel at each place (ty tx).

    Raises
    ------
    InputError
        If the mosaic is smaller than its tile.

    Examples
    --------
    >>> raw = np.arange(16, dtype=np.float32).reshape(4, 4)
    >>> planes, channels = packed(raw, np.array([[0, 1], [1, 2]]))
    >>> planes[1, 0], channels
    (array([ 8.,  9., 12., 13.], dtype=float32), (0, 1, 1, 2))
    """
    ty, tx = tile.shape
    if raw_e.shape[0] < ty or raw_e.shape[1] < tx:
        raise InputError(
            "picture",
            f"must have at least the {ty} x {tx} pixels of the mosaic's tile",
            value=raw_e.shape,
            found=f"has {raw_e.shape[0]} x {raw_e.shape[1]}",
        )
    height, width = (-(-n // t) * t for n, t in zip(raw_e.shape, (ty, tx), strict=True))
    rows, columns = (
        _completed(n, whole, t)
        for n, whole, t in zip(raw_e.shape, (height, width), (ty, tx), strict=True)
    )
    whole = raw_e[rows[:, None], columns] if (height, width) != raw_e.shape else raw_e
    planes = whole.reshape(height // ty, ty, width // tx, tx).swapaxes(1, 2)
    return (
        np.ascontiguousarray(planes.reshape(height // ty, width // tx, ty * tx)),
        tuple(int(channel) for channel in tile.ravel()),
    )


def unpacked(
    planes: Float32[Array, "ht wt k"], tile_shape: tuple[int, int], shape: tuple[int, int]
) -> Float32[Array, "h w"]:
    """The mosaic from its planes: the inverse of `packed`.

    Parameters
    ----------
    planes
        One plane per place of the tile. [e-]
    tile_shape
        Rows and columns of the tile.
    shape
        Rows and columns of the mosaic.

    Examples
    --------
    >>> raw = np.arange(15, dtype=np.float32).reshape(3, 5)
    >>> planes, _ = packed(raw, np.array([[0, 1], [1, 2]]))
    >>> bool((unpacked(planes, (2, 2), raw.shape) == raw).all())
    True
    """
    (ty, tx), (rows, columns, _) = tile_shape, planes.shape
    whole = planes.reshape(rows, columns, ty, tx).swapaxes(1, 2).reshape(rows * ty, columns * tx)
    return np.ascontiguousarray(whole[: shape[0], : shape[1]])


def _completed(count: int, whole: int, period: int) -> Array:
    """Indices 0 to ``whole`` - 1; those from ``count`` on are of the last pixel of their phase."""
    places = np.arange(whole)
    places[count:] -= period
    return places
