"""Pixel data of one source: known values, missing values, and questions for the user.

A data sheet, a noise profile and a photon-transfer table each give only some of the values. Missing
values are never guessed.
"""

from dataclasses import dataclass
from typing import Unpack

from chromanoise import _check
from chromanoise.errors import InputError, Setting
from chromanoise.sensor.adc import Adc
from chromanoise.sensor.partial_pixel import PartialPixel, PixelSettings
from chromanoise.sensor.pixel import PIXEL, PIXEL_REQUIRED, Pixel


@dataclass(frozen=True, slots=True, kw_only=True)
class PixelSource(PartialPixel):
    """Values that a source gives for a pixel; ``None`` for values that it does not give.

    The properties of `Pixel`, and:

    Attributes
    ----------
    source
        Where the numbers come from.
    gain_e_per_dn
        Electrons per code. [e-/DN]
    bits, black_level_dn
        Number of bits and black level of the converter. [1], [DN]
    adc
        The converter, where both gain and bits are known.
    qe, qe_at_nm
        Quantum efficiency at one wavelength, to check QE curves against. [e-/photon], [nm]
    notes
        Remarks for readers of a result.

    Raises
    ------
    InputError
        If a number is out of the range of real pixels.
    """

    source: str
    gain_e_per_dn: float | None = None
    bits: int | None = None
    black_level_dn: int | None = None
    adc: Adc | None = None
    qe: float | None = None
    qe_at_nm: float | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"of {self.source}"
        for name, unit in (("gain_e_per_dn", "e-/DN"), ("qe_at_nm", "nm")):
            if getattr(self, name) is not None:
                _check.positive(f"{name} {where}", unit, getattr(self, name))
        for name in PIXEL_REQUIRED:
            if getattr(self, name) is not None:
                PIXEL[name].demand(f"{name} {where}", getattr(self, name))
        if self.qe is not None and not 0.0 <= self.qe <= 1.0:
            raise InputError(
                f"qe {where}",
                "must be 0 to 1 [e-/photon]",
                value=self.qe,
                remedy="divide percent by 100",
            )


PIXEL_FILES = (
    "a data sheet (lines as 'sigma_d = 2.4 e-'), a photon transfer (CSV headed "
    "mean_dn,variance_dn2), a noise profile ('NoiseProfile: 0.0002 0.000001', or JSON as "
    '{"S": 0.0002, "O": 1e-6, "black_level_dn": 64, "white_level_dn": 1023}), or TOML with '
    "schema = 'chromanoise pixel'"
)
"""The files that can describe a pixel, each with an example, for messages."""


def open_questions(source: PixelSource) -> tuple[str, ...]:
    """One question for each value that the source lacks for a `Pixel`.

    Parameters
    ----------
    source
        The values of a file of a pixel.

    Examples
    --------
    >>> open_questions(PixelSource(source="a sheet", pitch_um=3.0, full_well_e=9000.0))
    ('read_noise_e: what is the read noise? [e-]',)
    """
    return tuple(
        f"{name}: what is the {PIXEL[name].label}?{_check.in_brackets(PIXEL[name].unit)}"
        for name in PIXEL_REQUIRED
        if getattr(source, name) is None
    )


def pixel_from(source: PixelSource, **answers: Unpack[PixelSettings]) -> Pixel:
    """The pixel of a source, with answers to its open questions.

    Parameters
    ----------
    source
        The known values.
    answers
        Properties of `Pixel`, each only if the source does not give it.

    Raises
    ------
    InputError
        If a value is still missing, or an answer is given for a value that the source gives.

    Examples
    --------
    >>> sheet = PixelSource(source="a sheet", pitch_um=3.0, full_well_e=9000.0)
    >>> pixel_from(sheet, read_noise_e=2) == Pixel(pitch_um=3, full_well_e=9000, read_noise_e=2)
    True
    """
    own = {name: getattr(source, name) for name in PIXEL if getattr(source, name) is not None}
    for name, answer in answers.items():
        if name in own and answer is not None:
            raise InputError(
                name,
                f"must be omitted where {source.source} gives it",
                value=answer,
                found=f"{answer:g} is given besides {own[name]:g}",
                remedy=("omit it", "correct the source"),
            )
    known = own | {name: one for name, one in answers.items() if one is not None}
    missing = [name for name in PIXEL_REQUIRED if name not in known]
    if missing:
        raise InputError(
            source.source,
            f"must give {', '.join(PIXEL_REQUIRED[:-1])} and {PIXEL_REQUIRED[-1]} for a pixel",
            found=f"gives no {' and no '.join(missing)}",
            remedy=Setting(missing[0]) if len(missing) == 1 else "set each of them",
        )
    return Pixel(**known)
