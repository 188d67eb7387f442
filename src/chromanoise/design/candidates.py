"""The arrays of many sensors that a batched evaluation reads."""

from dataclasses import dataclass

from chromanoise._check import Array
from chromanoise._shapes import Inexact


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidates:
    """``m`` sensors with ``p`` channels on one grid, with their exposure, pixel and matrix.

    All arrays may be complex, for derivatives by the complex step.

    Attributes
    ----------
    qe
        Electrons per photon, filters and crosstalk before counting included. [e-/photon]
    time_s
        Exposure time of each; ``None`` where all have that of the scene. [s]
    pixel_share
        Share of the pixels of the mosaic that each channel has; each row has the sum 1. The
        variance of channel i is divided by ``p * pixel_share[i]``. ``None``: equal shares, as in
        the paper. [1]
    noise_weight
        Weight of the noise in the color matrix: 0 least squares, 1 LMMSE; ``None`` where the matrix
        of the scene decides. [1]
    read_noise_e
        Read noise of each; ``None`` for that of the pixel. [e-]
    prnu
        PRNU of each; ``None`` for that of the pixel. [1]
    """

    qe: Inexact[Array, "m n p"]
    time_s: Inexact[Array, " m"] | None = None
    pixel_share: Inexact[Array, "m p"] | None = None
    noise_weight: Inexact[Array, " m"] | None = None
    read_noise_e: Inexact[Array, " m"] | None = None
    prnu: Inexact[Array, " m"] | None = None

    def __len__(self) -> int:
        return len(self.qe)
