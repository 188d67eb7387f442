"""The pixel: pitch, full well and read noise."""

from dataclasses import dataclass

from chromanoise import _check


@dataclass(frozen=True, slots=True, kw_only=True)
class Pixel:
    """One pixel design, the same for all channels.

    Attributes
    ----------
    pitch_um
        Side of the square pixel: a_pix in the paper. [um]
    full_well_e
        Electrons at saturation. [e-]
    read_noise_e
        Standard deviation of the readout, >= 0. [e-]

    Raises
    ------
    InputError
        If a number is not finite, negative or out of the range of real pixels, or if pitch or full
        well is 0.
    """

    pitch_um: float
    full_well_e: float
    read_noise_e: float

    def __post_init__(self) -> None:
        _check.positive("pitch_um", "um", self.pitch_um)
        _check.within("pitch_um", "um", self.pitch_um, 1e-3, 1e6)
        _check.positive("full_well_e", "e-", self.full_well_e)
        _check.within("full_well_e", "e-", self.full_well_e, 1e-3, 1e15)
        _check.not_negative("read_noise_e", "e-", self.read_noise_e)
        _check.within("read_noise_e", "e-", self.read_noise_e, 0.0, 1e12)


PAPER_PIXEL = Pixel(pitch_um=10.0, full_well_e=10_000.0, read_noise_e=10.0)
"""Table 1 of Clouet, Vaillant & Alleysson (CIC27, 2019)."""
