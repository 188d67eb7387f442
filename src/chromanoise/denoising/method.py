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
    """A denoising method: its function and what is known of it.

    Attributes
    ----------
    name
        What users type.
    what
        One sentence.
    denoise
        The function. It depends on rows and columns only through multiples of ``grid_px``.
    reach_px
        Most rows between a value and the values on which it depends; ``None`` if it depends on
        the whole picture, which is then not cut into strips. [pixels]
    grid_px
        Period of the places at which the method works. [pixels]
    linear
        Whether the result is linear in the values, so that its noise has a closed form.
    baseline
        Whether the method is another package's, to compare with.
    """

    name: str
    what: str
    denoise: Denoise
    reach_px: int | None
    grid_px: int = 1
    linear: bool = False
    baseline: bool = False
