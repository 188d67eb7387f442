"""From electrons to codes: gain, black level, number of bits."""

import math
from dataclasses import asdict, dataclass, replace

from chromanoise import _check
from chromanoise.errors import InputError, Setting
from chromanoise.sensor.pixel import Pixel

_BITS = range(8, 17)


@dataclass(frozen=True, slots=True, kw_only=True)
class Adc:
    """A linear converter: code = black level + electrons / gain, rounded and clipped to its range.

    Attributes
    ----------
    bits
        8 to 16.
    gain_e_per_dn
        Electrons per code: the conversion gain K of a data sheet, inverted. [e-/DN]
    black_level_dn
        Code of a pixel without electrons; negative noise is kept down to code 0. [DN]

    Raises
    ------
    InputError
        If bits, gain or black level are out of range.
    """

    bits: int
    gain_e_per_dn: float
    black_level_dn: int = 0

    def __post_init__(self) -> None:
        if not isinstance(self.bits, int) or self.bits not in _BITS:
            raise InputError("bits", "must be a whole number from 8 to 16", value=self.bits)
        _check.within("gain_e_per_dn", "e-/DN", self.gain_e_per_dn, 1e-12, 1e15)
        _check.within("black_level_dn", "DN", self.black_level_dn, 0, self.top_code - 1)

    @property
    def top_code(self) -> int:
        """The largest code, 2^bits - 1; brighter pixels are clipped to it."""
        return 2**self.bits - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Converter:
    """Known values of a sensor's converter; ``None`` for those that are not known.

    Attributes
    ----------
    bits, gain_e_per_dn, black_level_dn
        As `Adc`.

    Raises
    ------
    InputError
        If a value is out of the range of `Adc`.
    """

    bits: int | None = None
    gain_e_per_dn: float | None = None
    black_level_dn: int | None = None

    def __post_init__(self) -> None:
        bits = 16 if self.bits is None else self.bits
        Adc(
            bits=bits,
            gain_e_per_dn=1.0 if self.gain_e_per_dn is None else self.gain_e_per_dn,
            black_level_dn=self.black_level_dn or 0,
        )

    @property
    def known(self) -> dict[str, float]:
        """The known values by name."""
        return {name: value for name, value in asdict(self).items() if value is not None}


UNKNOWN_CONVERTER = Converter()
"""The converter of a sensor without any declared value."""


def adc_of(converter: Converter, pixel: Pixel) -> Adc:
    """The converter of a pixel, with assumptions for what is not known.

    Black level 0. Without the gain, the top code is at the full well; with neither gain nor bits,
    12 bits. Without the bits, the fewest from 8 to 16 with which the codes reach the full well.

    Parameters
    ----------
    converter
        What is known of the converter.
    pixel
        The pixel.

    Raises
    ------
    InputError
        If the bits are not known and even 16 do not reach the full well.

    Examples
    --------
    >>> pixel = Pixel(pitch_um=10, full_well_e=4095, read_noise_e=0)
    >>> adc_of(Converter(), pixel).gain_e_per_dn
    1.0
    >>> adc_of(Converter(gain_e_per_dn=2.0, bits=12), pixel).gain_e_per_dn
    2.0
    >>> adc_of(Converter(gain_e_per_dn=2.0), pixel).bits
    11
    """
    black, gain = converter.black_level_dn or 0, converter.gain_e_per_dn
    if gain is None:
        bits = 12 if converter.bits is None else converter.bits
        return adc_to_full_well(pixel, bits=bits, black_level_dn=black)
    if converter.bits is not None:
        return Adc(bits=converter.bits, gain_e_per_dn=gain, black_level_dn=black)
    top_dn = black + pixel.full_well_e / gain
    enough = [bits for bits in _BITS if 2**bits - 1 >= top_dn - 0.5]
    if not enough:
        raise InputError(
            "bits",
            f"must be given for a full well of {top_dn:.6g} DN, above the top code of 16 bits",
            value=None,
            found="they are missing",
            remedy=Setting("bits"),
        )
    return Adc(bits=enough[0], gain_e_per_dn=gain, black_level_dn=black)


def refuse_coarse_codes(converter: Converter, pixel: Pixel) -> None:
    """Refuse a gain at which a full pixel is less than one code above black.

    Raises
    ------
    InputError
        If it is.
    """
    gain = converter.gain_e_per_dn
    well_e = pixel.full_well_e / pixel.summed_pixels
    if gain is not None and gain > well_e:
        raise InputError(
            "gain_e_per_dn",
            "must be such that the full well is at least 1 DN above black",
            value=gain,
            found=f"a full well of {well_e:g} e- is {well_e / gain:.3g} DN",
        )


def code_step_e(converter: Converter, pixel: Pixel) -> float:
    """Electrons per code, 0 if neither the gain nor the bits of the converter are known. [e-/DN]

    Where n readings are summed (`binned`), it is the step of one reading, and so of their sum.

    Parameters
    ----------
    converter
        What is known of the converter.
    pixel
        The pixel.

    Examples
    --------
    >>> pixel = Pixel(pitch_um=10, full_well_e=4095, read_noise_e=0)
    >>> code_step_e(Converter(gain_e_per_dn=2.5), pixel)
    2.5
    >>> code_step_e(Converter(bits=12), pixel), code_step_e(Converter(), pixel)
    (1.0, 0.0)
    """
    if converter.gain_e_per_dn is not None:
        return converter.gain_e_per_dn
    if converter.bits is None:
        return 0.0
    return adc_of(converter, pixel).gain_e_per_dn / pixel.summed_readings


def quantization_step_e(converter: Converter, pixel: Pixel) -> float:
    """Step whose rounding has the variance of the reading: q in q^2 / 12. [e-]

    It is `code_step_e` of one reading; where n readings are summed (`binned`), the root of n times
    that, because each of them is rounded.

    Parameters
    ----------
    converter
        What is known of the converter.
    pixel
        The pixel.

    Examples
    --------
    >>> from chromanoise.sensor import binned
    >>> pixel = Pixel(pitch_um=10, full_well_e=4095, read_noise_e=0)
    >>> quantization_step_e(Converter(gain_e_per_dn=2.5), binned(pixel, 4, "digital"))
    5.0
    """
    return code_step_e(converter, pixel) * math.sqrt(pixel.summed_readings)


def adc_to_full_well(pixel: Pixel, *, bits: int = 12, black_level_dn: int = 0) -> Adc:
    """The converter whose top code is the pixel's full well.

    Parameters
    ----------
    pixel
        The pixel.
    bits
        Bits of a code.
    black_level_dn
        Code of no electrons. [DN]

    Examples
    --------
    >>> adc_to_full_well(Pixel(pitch_um=10, full_well_e=4095, read_noise_e=0)).gain_e_per_dn
    1.0
    """
    unit = Adc(bits=bits, gain_e_per_dn=1.0, black_level_dn=black_level_dn)
    gain = pixel.full_well_e / (unit.top_code - black_level_dn)
    return replace(unit, gain_e_per_dn=gain)
