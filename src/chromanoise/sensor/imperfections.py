"""Noise of real pixels in addition to shot and read noise; zero by default, as in the paper.

EMVA 1288 names: DSNU and PRNU differ from pixel to pixel and are the same in every frame; row
noise differs in every row and frame; dark current adds electrons with their own shot noise. The
mean of the dark signal is subtracted, as sensors do with their shielded pixels.
"""

from dataclasses import dataclass

from chromanoise import _check
from chromanoise.errors import InputError

_MOST = 1e12  # above any real pixel, and above the resolution of float32


@dataclass(frozen=True, slots=True, kw_only=True)
class Imperfections:
    """Dark current, DSNU, PRNU and row noise of one pixel design.

    Attributes
    ----------
    dark_current_e_per_s
        Electrons generated without light. [e-/s]
    dsnu_e
        Standard deviation of the dark signal over the pixels. [e-]
    prnu
        Standard deviation of the sensitivity over the pixels, e.g. 0.01. [1]
    row_noise_e
        Standard deviation of the offset that all pixels of a row share. [e-]

    Raises
    ------
    InputError
        If a value is negative or not finite, or PRNU is 0.2 or more.
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
    """Mean number of dark electrons in ``time_s``. [e-]"""
    return imperfections.dark_current_e_per_s * time_s


NONE = Imperfections()
"""No imperfections: the pixel of the paper."""
