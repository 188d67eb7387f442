"""What real pixels add to shot and read noise; all of it is zero unless asked for, as in the paper.

EMVA 1288 names: DSNU and PRNU differ from pixel to pixel and stay from frame to frame; row noise is
new in every row and frame; dark current adds electrons with their own shot noise. Their mean is
taken off, as shielded pixels tell it to a sensor.
"""

from dataclasses import dataclass

from chromanoise import _check
from chromanoise.errors import InputError

_MOST = 1e12  # beyond any pixel, and beyond what float32 tells apart


@dataclass(frozen=True, slots=True, kw_only=True)
class Imperfections:
    """Of one pixel design.

    Attributes
    ----------
    dark_current_e_per_s
        Electrons that come without light. [e-/s]
    dsnu_e
        Standard deviation of the dark signal over the pixels. [e-]
    prnu
        Standard deviation of the sensitivity over the pixels, e.g. 0.01. [1]
    row_noise_e
        Standard deviation of what a whole row shares. [e-]

    Raises
    ------
    InputError
        If one is negative or not finite, or PRNU is 0.2 or more.
    """

    dark_current_e_per_s: float = 0.0
    dsnu_e: float = 0.0
    prnu: float = 0.0
    row_noise_e: float = 0.0

    def __post_init__(self) -> None:
        _check.within("dark_current_e_per_s", "e-/s", self.dark_current_e_per_s, 0.0, _MOST)
        _check.within("dsnu_e", "e-", self.dsnu_e, 0.0, _MOST)
        _check.within("row_noise_e", "e-", self.row_noise_e, 0.0, _MOST)
        if not 0.0 <= self.prnu <= 0.2:
            raise InputError(
                "prnu", "must be 0 to 0.2 [1]", value=self.prnu, remedy="write 1 percent as 0.01"
            )


def dark_electrons_e(imperfections: Imperfections, *, time_s: float) -> float:
    """Mean electrons that come without light in ``time_s``. [e-]"""
    return imperfections.dark_current_e_per_s * time_s


NONE = Imperfections()
"""The pixel of the paper."""
