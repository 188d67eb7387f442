"""The law of the variance of a reading: floor + slope m + square m^2 at m expected electrons."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float


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
        If a coefficient is negative or not finite.

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
        units = {"floor_e2": "e-^2", "slope_e": "e-", "square": "1"}
        for name, unit in units.items():
            _check.non_negative(name, unit, getattr(self, name))
        if any(isinstance(getattr(self, name), np.ndarray) for name in units):
            _check.freeze(self, *(n for n in units if isinstance(getattr(self, n), np.ndarray)))

    def variance_e2(self, mean_e: float | Float[Array, "*px"]) -> Float[Array, "*px"]:
        """Variance at these means, one law for all or one per entry of the last axis. [e-^2]

        Parameters
        ----------
        mean_e
            Expected electrons of the light. [e-]
        """
        mean = np.asarray(mean_e)
        return np.asarray(self.floor_e2 + (self.slope_e + self.square * mean) * mean)

    def __add__(self, other: "VarianceLaw") -> "VarianceLaw":
        """The law of two independent sources together."""
        return VarianceLaw(
            floor_e2=self.floor_e2 + other.floor_e2,
            slope_e=self.slope_e + other.slope_e,
            square=self.square + other.square,
        )
