"""What a denoising method is."""

from collections.abc import Callable
from dataclasses import dataclass

from chromanoise._check import Array
from chromanoise._shapes import Float32
from chromanoise.denoising.planes import NoisyPlanes

Denoise = Callable[[NoisyPlanes], Float32[Array, "h w p"]]
"""From noisy planes to planes of the same shape. [e-]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DenoisingMethod:
    """A denoising method: its function and its properties.

    Attributes
    ----------
    name
        Name on the command line and in studies.
    what
        One or two sentences for users.
    denoise
        The function. It depends on rows and columns only through multiples of ``grid_px``.
    reach_px
        Largest number of rows between a value and the values on which it depends; ``None`` if it
        depends on the whole picture, which is then not cut into strips. [pixels]
    grid_px
        Period of the positions at which the method works, e.g. of its pyramid. [pixels]
    linear
        Whether the result is linear in the values, so that its noise has a closed form.
    baseline
        Whether the method is for comparison only: none, or one of another package.
    """

    name: str
    what: str
    denoise: Denoise
    reach_px: int | None
    grid_px: int = 1
    linear: bool = False
    baseline: bool = False
