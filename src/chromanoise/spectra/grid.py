"""The common wavelength grid of illuminants, sensors, filters and observers."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError


@dataclass(frozen=True, slots=True)
class Grid:
    """``n`` equidistant wavelengths, both ends included.

    Attributes
    ----------
    start_nm, stop_nm
        First and last wavelength. [nm]
    step_nm
        Distance between neighboring wavelengths: the paper's delta-lambda. [nm]

    Raises
    ------
    InputError
        If a number is not positive, or the step does not divide the range.

    Examples
    --------
    >>> grid = Grid.uniform(400, 1050, 5)
    >>> grid.n, grid.wavelength_nm[:3]
    (131, array([400., 405., 410.]))
    """

    start_nm: float
    stop_nm: float
    step_nm: float

    def __post_init__(self) -> None:
        for name in ("start_nm", "stop_nm", "step_nm"):
            object.__setattr__(
                self, name, _check.positive(f"Grid.{name}", "nm", getattr(self, name))
            )
        steps = (self.stop_nm - self.start_nm) / self.step_nm
        if steps < 1 or abs(steps - round(steps)) > 1e-9:
            raise InputError(
                "Grid",
                f"must go up from {self.start_nm:g} to {self.stop_nm:g} nm in whole steps",
                value=(self.start_nm, self.stop_nm, self.step_nm),
                found=f"a step of {self.step_nm:g} nm fits {steps:g} times",
            )

    @classmethod
    def uniform(cls, start_nm: float, stop_nm: float, step_nm: float) -> "Grid":
        """Make the grid from ``start_nm`` to ``stop_nm``.

        Parameters
        ----------
        start_nm, stop_nm, step_nm
            First wavelength, last wavelength and step. [nm]

        Returns
        -------
        Grid
            Both ends included.

        Raises
        ------
        InputError
            If the step does not divide the range.
        """
        return cls(float(start_nm), float(stop_nm), float(step_nm))

    @property
    def n(self) -> int:
        """Number of wavelengths."""
        return round((self.stop_nm - self.start_nm) / self.step_nm) + 1

    @property
    def wavelength_nm(self) -> Float[Array, " n"]:
        """The wavelengths. [nm]"""
        return self.start_nm + self.step_nm * np.arange(self.n)

    def __str__(self) -> str:
        return f"{self.start_nm:g}-{self.stop_nm:g} nm @{self.step_nm:g}"


DEFAULT_GRID = Grid.uniform(400, 1050, 5)
"""The paper's range, where silicon is sensitive. Eq. 2 sums over these 131 wavelengths."""
