"""The law of the variance of a reading: floor + slope m + square m^2 at m expected electrons."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Int

_UNITS = {"floor_e2": "e-^2", "slope_e": "e-", "square": "1"}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VarianceLaw:
    """Variance of one reading, or of the readings of several planes, as a law of the light.

    Attributes
    ----------
    floor_e2
        Variance without light: readout, dark electrons, rounding. [e-^2]
    slope_e
        Variance per electron of light; 1 for shot noise of electrons. [e-]
    square
        Variance per squared electron of light: PRNU^2. [1]

    Raises
    ------
    InputError
        If a coefficient is negative or not finite, or the numbers of planes differ.

    Notes
    -----
    EMVA 1288, release 4.0: the linear camera model with the non-uniformity of the response.

    Examples
    --------
    >>> law = VarianceLaw(floor_e2=16.0, slope_e=1.0) + VarianceLaw(square=0.01**2)
    >>> law.variance_e2(np.array([0.0, 1000.0]))
    array([  16., 1116.])
    """

    floor_e2: float | Float[Array, " p"] = 0.0
    slope_e: float | Float[Array, " p"] = 0.0
    square: float | Float[Array, " p"] = 0.0

    def __post_init__(self) -> None:
        for name, unit in _UNITS.items():
            _check.non_negative(name, unit, getattr(self, name))
        arrays = [name for name in _UNITS if np.ndim(getattr(self, name))]
        _check.same_length("planes", **{name: np.size(getattr(self, name)) for name in arrays})
        _check.freeze(self, *arrays)

    def variance_e2(self, mean_e: float | Float[Array, "*px"]) -> Float[Array, "*px"]:
        """Variance at these means, one law for all or one per entry of the last axis. [e-^2]

        Parameters
        ----------
        mean_e
            Expected electrons of the light. [e-]
        """
        mean = np.asarray(mean_e, dtype=np.float64)
        return np.asarray(self.floor_e2 + (self.slope_e + self.square * mean) * mean)

    @property
    def coefficients(self) -> Float[Array, "3 *p"]:
        """Floor, slope and square, a row each; a column per plane."""
        rows = np.broadcast_arrays(self.floor_e2, self.slope_e, self.square)
        return np.stack(rows).astype(np.float64)

    @property
    def has_noise(self) -> Bool[Array, "*p"]:
        """Whether the readings have noise at some mean."""
        return np.asarray((self.coefficients > 0).any(axis=0))

    def of_planes(self, count: int) -> "VarianceLaw":
        """The law with arrays: one law for all planes becomes one for each.

        Parameters
        ----------
        count
            Number of planes.

        Raises
        ------
        InputError
            If the law is that of another number of planes.
        """
        rows = self.coefficients
        if rows.ndim == 1:
            return _law(np.tile(rows[:, None], count))
        _check.same_length("planes", **{"given": count, "variance law": rows.shape[1]})
        return _law(rows)

    def take(
        self, planes: int | Sequence[int] | Int[Array, " n"] | Bool[Array, " p"]
    ) -> "VarianceLaw":
        """The law of one or some of the planes.

        Parameters
        ----------
        planes
            Index, indices, which may repeat, or a flag for each plane.
        """
        return _law(self.coefficients[:, np.asarray(planes)])

    def scaled(self, share: float | Float[Array, " p"]) -> "VarianceLaw":
        """The law of a variance that is this one times ``share``, at the same mean.

        Parameters
        ----------
        share
            Such as 1/4 for the mean of four readings, or the square of a weight. [1]
        """
        return _law(self.coefficients * share)

    def in_units_of(self, unit_e: float | Float[Array, " p"]) -> "VarianceLaw":
        """The law of the readings divided by ``unit_e``, of their mean divided by it.

        Parameters
        ----------
        unit_e
            Such as the electrons from black to white: the floor is then O and the slope S of the
            noise profile of DNG. [e-]

        Examples
        --------
        >>> law = VarianceLaw(floor_e2=16.0, slope_e=1.0, square=0.25).in_units_of(4.0)
        >>> law.coefficients
        array([1.  , 0.25, 0.25])
        """
        floor, slope, square = self.coefficients
        return _law(np.stack(np.broadcast_arrays(floor / unit_e**2, slope / unit_e, square)))

    def __add__(self, other: "VarianceLaw") -> "VarianceLaw":
        """The law of two independent sources together."""
        return VarianceLaw(**{name: getattr(self, name) + getattr(other, name) for name in _UNITS})

    def __sub__(self, part: "VarianceLaw") -> "VarianceLaw":
        """The law without one of its independent sources; refused if that one is larger."""
        rest = {name: getattr(self, name) - getattr(part, name) for name in _UNITS}
        for name, unit in _UNITS.items():
            _check.non_negative(f"{name} without that of a part", unit, rest[name])
        return VarianceLaw(**rest)


def _law(coefficients: Float[Array, "3 *p"]) -> VarianceLaw:
    floor, slope, square = coefficients
    return VarianceLaw(floor_e2=floor, slope_e=slope, square=square)
