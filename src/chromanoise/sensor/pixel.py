"""The pixel: pitch, full well, every number that determines its noise, and its converter.

Names as in EMVA 1288, release 4.0: DSNU and PRNU differ from pixel to pixel and are the same in
every frame; row noise differs in every row and frame; dark current adds electrons with their own
shot noise, and its mean is subtracted. All are 0 by default, as in the paper.

The converter turns electrons into codes: gain, black level, number of bits.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, fields, replace
from typing import Annotated, Any, ClassVar, Literal, get_args

from chromanoise.base import (
    Growth,
    InputError,
    Property,
    Setting,
    check,
    dataclass,
    demand_properties,
    properties_of,
    required_of,
)

_MOST = 1e12  # above any real pixel, and above the resolution of float32
_COLDEST_C, _HOTTEST_C = -273.15, 300.0

BinningMode = Literal["charge", "digital"]
"""Whether binning sums charges before the readout, or codes after it."""
MOST_BINNING = 10_000
"""Most pixels that are summed."""


@dataclass(frozen=True, kw_only=True)
class Pixel:
    """One pixel design, the same for all channels.

    A subclass may add noise sources: ``own_noise``, with a ``Property`` on a field of each.

    Attributes
    ----------
    pitch_um
        Side of the square pixel: a_pix in the paper. [um]
    full_well_e
        Electrons at saturation. [e-]
    read_noise_e
        Standard deviation of the readout, rounding to codes not included, >= 0. [e-]
    dark_current_e_per_s
        Electrons generated without light, at ``dark_reference_c``. [e-/s]
    dsnu_e
        Standard deviation of the dark signal over the pixels. [e-]
    prnu
        Standard deviation of the sensitivity over the pixels, e.g. 0.01. [1]
    row_noise_e
        Standard deviation of the offset that all pixels of a row share. [e-]
    column_noise_e
        Standard deviation of the offset that all pixels of a column share, new in each frame. [e-]
    reset_capacitance_ff
        Sense-node capacitance. Its kTC noise is in every reading; 0 if correlated double sampling
        cancels it. [fF]
    rtn_share, rtn_amplitude_e
        Share of the pixels with random telegraph noise, and the difference between their two
        levels, with a duty cycle of 50 %. [1], [e-]
    black_error_e
        Error of the subtracted black level: a bias of every reading, of either sign. [e-]
    temperature_c
        Temperature of the sensor; ``None`` for ``dark_reference_c``. [C]
    dark_reference_c
        Temperature at which the dark current is given. [C]
    dark_doubling_k
        Increase of the temperature that doubles the dark current; usually 6 to 8. [K]
    summed_pixels, summed_readings
        Pixels that were binned, and readings of them that were summed: see `binned`. All other
        values are those of the sum. [1]

    Raises
    ------
    InputError
        If a number is not finite, negative or out of the range of real pixels, or if pitch or full
        well is 0.

    Examples
    --------
    >>> warm = Pixel(pitch_um=3, full_well_e=9000, read_noise_e=2, dark_current_e_per_s=5,
    ...              temperature_c=39.0)
    >>> warm.dark_electrons_e(time_s=2.0)      # 14 K above the reference: two doublings
    40.0
    """

    own_noise: ClassVar[tuple[Any, ...]] = ()
    """The noise sources of a subclass, each a `chromanoise.sensor.noise_sources.NoiseSource`."""

    pitch_um: Annotated[
        float,
        Property(
            label="pixel pitch", unit="um", least=1e-3, most=1e6, slider=(0.5, 50.0, 0.01),
            logarithmic=True, sets_time=True,
            help="Pixel pitch [um].",
            growth=Growth(pixels=0.5),
        ),
    ]  # fmt: skip
    full_well_e: Annotated[
        float,
        Property(
            label="full well", unit="e-", least=1e-3, most=1e15, slider=(100.0, 1e6, 0.02),
            logarithmic=True, sets_time=True,
            help="Full-well capacity [e-].",
            growth=Growth(pixels=1),
        ),
    ]  # fmt: skip
    read_noise_e: Annotated[
        float,
        Property(
            label="read noise", unit="e-", least=0.0, most=_MOST, slider=(0.1, 100.0, 0.01),
            logarithmic=True, common=True,
            help="Standard deviation of the read noise [e-].",
            growth=Growth(readings=0.5),
        ),
    ]  # fmt: skip
    dark_current_e_per_s: Annotated[
        float,
        Property(
            label="dark current", unit="e-/s", least=0.0, most=_MOST, slider=(0.0, 1000.0, 10.0),
            logarithmic=True, sets_time=True,
            help="Dark current at the reference temperature [e-/s]; its mean is subtracted.",
            growth=Growth(pixels=1),
        ),
    ] = 0.0  # fmt: skip
    dsnu_e: Annotated[
        float,
        Property(
            label="DSNU", unit="e-", least=0.0, most=_MOST, slider=(0.0, 50.0, 0.5),
            help="Dark signal non-uniformity [e-].",
            growth=Growth(pixels=0.5),
        ),
    ] = 0.0  # fmt: skip
    prnu: Annotated[
        float,
        Property(
            label="PRNU", unit="1", least=0.0, most=0.2, slider=(0.0, 0.05, 0.001),
            help="Photo response non-uniformity, e.g. 0.01 for 1 % [1].",
            remedy="write 1 percent as 0.01",
            growth=Growth(pixels=-0.5),
        ),
    ] = 0.0  # fmt: skip
    row_noise_e: Annotated[
        float,
        Property(
            label="row noise", unit="e-", least=0.0, most=_MOST, slider=(0.0, 20.0, 0.2),
            help="Row noise, rms, new in each frame [e-].",
            growth=Growth(readings=0.5, columns=0.5),
        ),
    ] = 0.0  # fmt: skip
    column_noise_e: Annotated[
        float,
        Property(
            label="column noise", unit="e-", least=0.0, most=_MOST, slider=(0.0, 20.0, 0.2),
            later=True,
            help="Column noise, rms, new in each frame [e-].",
            growth=Growth(readings=0.5, rows=0.5),
        ),
    ] = 0.0  # fmt: skip
    reset_capacitance_ff: Annotated[
        float,
        Property(
            label="reset capacitance", unit="fF", least=0.0, most=1e6,
            slider=(0.0, 20.0, 0.1), later=True,
            help="Sense-node capacitance, for reset noise (kTC) [fF]; 0 if correlated double "
            "sampling cancels it.",
            growth=Growth(readings=1),
        ),
    ] = 0.0  # fmt: skip
    rtn_share: Annotated[
        float,
        Property(
            label="share of RTN pixels", unit="1", least=0.0, most=1.0,
            slider=(0.0, 0.2, 0.001),
            later=True,
            help="Share of the pixels with random telegraph noise (RTN), e.g. 0.01 for 1 % [1].",
            remedy="write 1 percent as 0.01",
        ),
    ] = 0.0  # fmt: skip
    rtn_amplitude_e: Annotated[
        float,
        Property(
            label="RTN amplitude", unit="e-", least=0.0, most=_MOST,
            slider=(0.0, 100.0, 1.0),
            later=True,
            help="RTN amplitude: difference between the two levels [e-].",
            growth=Growth(readings=0.5), needs=("rtn_share",),
        ),
    ] = 0.0  # fmt: skip
    black_error_e: Annotated[
        float,
        Property(
            label="black-level error", unit="e-", least=-1e15, most=1e15,
            slider=(-50.0, 50.0, 1.0),
            help="Error of the subtracted black level [e-], a bias of every reading.",
            growth=Growth(readings=1),
        ),
    ] = 0.0  # fmt: skip
    temperature_c: Annotated[
        float | None,
        Property(
            label="temperature of the sensor", unit="C", least=_COLDEST_C, most=_HOTTEST_C,
            slider=(-40.0, 100.0, 1.0),
            needs=("dark_current_e_per_s", "reset_capacitance_ff"), sets_time=True,
            help="Temperature of the sensor, for dark current and reset noise [C]; default: the "
            "reference temperature.",
        ),
    ] = None  # fmt: skip
    dark_reference_c: Annotated[
        float,
        Property(
            label="reference temperature", unit="C", least=_COLDEST_C, most=_HOTTEST_C,
            slider=(-40.0, 100.0, 1.0),
            needs=("dark_current_e_per_s", "reset_capacitance_ff"), sets_time=True,
            help="Reference temperature of the dark current [C]; default: {default:g}.",
        ),
    ] = 25.0  # fmt: skip
    dark_doubling_k: Annotated[
        float,
        Property(
            label="dark-current doubling temperature", unit="K", least=3.0, most=30.0,
            slider=(3.0, 30.0, 0.5),
            needs=("dark_current_e_per_s",), sets_time=True,
            help="Temperature increase that doubles the dark current [K]; default: {default:g}.",
        ),
    ] = 7.0  # fmt: skip
    summed_pixels: float = 1
    summed_readings: float = 1

    def __post_init__(self) -> None:
        demand_properties(self)
        well_e = self.full_well_e
        check.within("black_error_e", "e-", self.black_error_e, -well_e, well_e)
        summed = check.whole("summed_pixels", self.summed_pixels, 1, MOST_BINNING)
        object.__setattr__(self, "summed_pixels", summed)
        if self.summed_readings not in (1, self.summed_pixels):
            raise InputError(
                "summed_readings",
                f"must be 1 or the {self.summed_pixels} pixels that are summed",
                value=self.summed_readings,
            )
        object.__setattr__(self, "summed_readings", int(self.summed_readings))

    @property
    def temperature_k(self) -> float:
        """Temperature of the sensor. [K]"""
        celsius = self.dark_reference_c if self.temperature_c is None else self.temperature_c
        return celsius - _COLDEST_C

    @property
    def temperature_factor(self) -> float:
        """Dark current at ``temperature_c`` over that at ``dark_reference_c``. [1]"""
        if self.temperature_c is None:
            return 1.0
        return float(2.0 ** ((self.temperature_c - self.dark_reference_c) / self.dark_doubling_k))

    def dark_electrons_e(self, *, time_s: float) -> float:
        """Mean number of dark electrons. [e-]

        Parameters
        ----------
        time_s
            Exposure time. [s]

        Returns
        -------
        float
            I(T0) 2^((T - T0) / T_d) t. [e-]

        Notes
        -----
        EMVA 1288, release 4.0: the temperature dependence of the dark current.
        """
        return self.dark_current_e_per_s * self.temperature_factor * time_s


PIXEL = properties_of(Pixel)
"""The properties of a pixel by name."""
PIXEL_REQUIRED = required_of(Pixel)
"""Names of the properties that a pixel must have."""
PAPER_PIXEL = Pixel(pitch_um=10.0, full_well_e=10_000.0, read_noise_e=10.0)
"""Table 1 of Clouet, Vaillant & Alleysson (CIC27, 2019)."""


def _properties(pixel: Pixel) -> Mapping[str, Property]:
    return properties_of(type(pixel))  # type: ignore[arg-type] # Hashable


def _extra_noise_of(owner: type[Pixel]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(owner) if field.default == 0.0)


EXTRA_NOISE = _extra_noise_of(Pixel)
"""Fields of `Pixel` that add noise or bias beyond shot and read noise; 0 by default."""
PIXEL_NOISE = tuple(name for name in EXTRA_NOISE if PIXEL[name].least == 0)
"""Those that add noise."""


def shot_and_read_only(pixel: Pixel) -> Pixel:
    """The pixel with shot noise and read noise only."""
    return replace(pixel, **dict.fromkeys(_extra_noise_of(type(pixel)), 0.0), temperature_c=None)


def extra_noise(pixel: Pixel) -> dict[str, float]:
    """The values of `EXTRA_NOISE`, and of own noise, that are not 0, by name."""
    names = _extra_noise_of(type(pixel))
    return {name: value for name in names if (value := getattr(pixel, name))}


def binned(pixel: Pixel, pixels: int, mode: BinningMode = "charge") -> Pixel:
    """The pixel whose reading is the sum of ``pixels`` equal pixels.

    Parameters
    ----------
    pixel
        One of them, not binned itself.
    pixels
        How many are summed, e.g. 4 for 2 x 2; from 1 to 10,000. 1 returns the pixel itself.
    mode
        ``charge``: their charges are summed before one reading. ``digital``: each is read, and the
        readings are summed.

    Raises
    ------
    InputError
        If the number is not whole or out of range, the mode is unknown, or the pixel is binned.

    Notes
    -----
    The light, the dark electrons and the full well are n times those of one pixel. PRNU and DSNU
    are independent from pixel to pixel: DSNU grows with the root of n, PRNU falls with it. Charge
    is read once: read noise, row noise and black-level error stay. With n readings the variance of
    the read noise is n times that of one, and the black-level error n times. Of a block of r rows
    and c columns, as square as n allows, the row noise has r c^2 times the variance of one.

    The full well is bounded by the photodiodes only, n times that of one: a summing node that holds
    less must be given as a smaller full well. Clipping applies to the sum.

    Examples
    --------
    >>> four = binned(PAPER_PIXEL, 4, "digital")
    >>> four.pitch_um, four.full_well_e, four.read_noise_e
    (20.0, 40000.0, 20.0)
    >>> binned(PAPER_PIXEL, 4, "charge").read_noise_e
    10.0
    """
    pixels = check.whole("binning", pixels, 1, MOST_BINNING)
    check.one_of("binning_mode", mode, get_args(BinningMode))
    if pixel.summed_pixels != 1:
        raise InputError(
            "binning",
            "must be given once",
            value=pixels,
            found=f"is of a pixel that is the sum of {pixel.summed_pixels} already",
        )
    if pixels == 1:
        return pixel
    shell = replace(pixel, summed_pixels=pixels, summed_readings=1 if mode == "charge" else pixels)
    grown = (name for name, one in _properties(pixel).items() if any(one.growth))
    return replace(shell, **of_the_sum(shell, {name: getattr(pixel, name) for name in grown}))


def of_the_sum(pixel: Pixel, values: Mapping[str, Any]) -> dict[str, Any]:
    """Values of one pixel as those of the sum that ``pixel`` is; unchanged if it is not binned.

    Parameters
    ----------
    pixel
        Of which the numbers of summed pixels and readings are used.
    values
        By the names of the fields of `Pixel`.

    Examples
    --------
    >>> of_the_sum(binned(PAPER_PIXEL, 16, "digital"), {"read_noise_e": 2.0, "prnu": 0.04})
    {'read_noise_e': 8.0, 'prnu': 0.01}
    """
    if pixel.summed_pixels == 1:
        return dict(values)
    n, read = int(pixel.summed_pixels), int(pixel.summed_readings)
    rows = max(rows for rows in range(1, math.isqrt(read) + 1) if read % rows == 0)
    counts = Growth(pixels=n, readings=read, rows=rows, columns=read // rows)
    known = _properties(pixel)

    def grown(name: str, value: Any) -> Any:
        growth = known[name].growth if name in known else Growth()
        if not any(growth):
            return value
        return value * math.prod(count**power for count, power in zip(counts, growth, strict=True))

    return {name: grown(name, value) for name, value in values.items()}


def of_one_reading(pixel: Pixel, readings: int) -> Pixel:
    """The pixel of each of independent readings, of whose sum ``pixel`` has the variances.

    Parameters
    ----------
    pixel
        The pixel whose readings are summed.
    readings
        How many are summed.
    """
    changes = {}
    for name, one in _properties(pixel).items():
        power, value = one.growth.pixels + one.growth.readings, getattr(pixel, name)
        if power and value:
            changes[name] = min(value / readings**power, one.most)  # a bound is one after rounding
    return replace(pixel, **changes, summed_pixels=1, summed_readings=1)


_BITS = range(8, 17)


@dataclass(frozen=True, kw_only=True)
class Adc:
    """A linear converter: code = black level + electrons / gain, rounded and clipped to its range.

    Attributes
    ----------
    bits
        Bits of a code, 8 to 16.
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
        check.within("gain_e_per_dn", "e-/DN", self.gain_e_per_dn, 1e-12, 1e15)
        check.within("black_level_dn", "DN", self.black_level_dn, 0, self.top_code - 1)

    @property
    def top_code(self) -> int:
        """The largest code, 2^bits - 1; brighter pixels are clipped to it."""
        return 2**self.bits - 1


@dataclass(frozen=True, kw_only=True)
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
