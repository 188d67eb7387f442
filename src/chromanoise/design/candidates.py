"""Sensors of a search, all at once: the arrays that a batched evaluation reads."""

from dataclasses import dataclass

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Inexact
from chromanoise.errors import InputError


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidates:
    """``m`` sensors with ``p`` channels on one grid, and what was chosen with each of them.

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

    Raises
    ------
    InputError
        If the shapes do not match.
    """

    qe: Inexact[Array, "m n p"]
    time_s: Inexact[Array, " m"] | None = None
    pixel_share: Inexact[Array, "m p"] | None = None
    noise_weight: Inexact[Array, " m"] | None = None
    read_noise_e: Inexact[Array, " m"] | None = None
    prnu: Inexact[Array, " m"] | None = None

    def __post_init__(self) -> None:
        if self.qe.ndim != 3:
            raise InputError(
                "QE of candidates",
                "must be (candidates, wavelengths, channels)",
                value=self.qe.shape,
                found=f"has shape {self.qe.shape}",
            )
        given = {
            name: len(values)
            for name in ("qe", "time_s", "pixel_share", "noise_weight", "read_noise_e", "prnu")
            if (values := getattr(self, name)) is not None
        }
        _check.same_length("candidates", **given)
        if self.pixel_share is not None:
            _check.same_length(
                "channels", qe=self.qe.shape[2], pixel_share=self.pixel_share.shape[1]
            )

    def __len__(self) -> int:
        return len(self.qe)
