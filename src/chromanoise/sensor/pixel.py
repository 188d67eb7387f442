"""The pixel: pitch, full well, and every number that determines its noise.

Names as in EMVA 1288, release 4.0: DSNU and PRNU differ from pixel to pixel and are the same in
every frame; row noise differs in every row and frame; dark current adds electrons with their own
shot noise, and its mean is subtracted. All are 0 by default, as in the paper.
"""

from dataclasses import dataclass, replace

from chromanoise import _check
from chromanoise.errors import InputError

_MOST = 1e12  # above any real pixel, and above the resolution of float32
_COLDEST_C, _HOTTEST_C = -273.15, 300.0
_MOST_PRNU = 0.2


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
        Standard deviation of the readout, rounding to codes not included, >= 0. [e-]
    dark_current_e_per_s
        Electrons generated without light, at ``dark_reference_c``. [e-/s]
    dsnu_e
        Standard deviation of the dark signal over the pixels. [e-]
    prnu
        Standard deviation of the sensitivity over the pixels, e.g. 0.01. [1]
    row_noise_e
        Standard deviation of the offset that all pixels of a row share. [e-]
    black_error_e
        Error of the subtracted black level: a bias of every reading, of either sign. [e-]
    temperature_c
        Temperature of the sensor; ``None`` for ``dark_reference_c``. [C]
    dark_reference_c
        Temperature at which the dark current is given. [C]
    dark_doubling_k
        Increase of the temperature that doubles the dark current; usually 6 to 8. [K]

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

    pitch_um: float
    full_well_e: float
    read_noise_e: float
    dark_current_e_per_s: float = 0.0
    dsnu_e: float = 0.0
    prnu: float = 0.0
    row_noise_e: float = 0.0
    black_error_e: float = 0.0
    temperature_c: float | None = None
    dark_reference_c: float = 25.0
    dark_doubling_k: float = 7.0

    def __post_init__(self) -> None:
        _check.positive("pitch_um", "um", self.pitch_um)
        _check.within("pitch_um", "um", self.pitch_um, 1e-3, 1e6)
        _check.positive("full_well_e", "e-", self.full_well_e)
        _check.within("full_well_e", "e-", self.full_well_e, 1e-3, 1e15)
        _check.not_negative("read_noise_e", "e-", self.read_noise_e)
        _check.within("read_noise_e", "e-", self.read_noise_e, 0.0, _MOST)
        _check.within("dark_current_e_per_s", "e-/s", self.dark_current_e_per_s, 0.0, _MOST)
        _check.within("dsnu_e", "e-", self.dsnu_e, 0.0, _MOST)
        _check.within("row_noise_e", "e-", self.row_noise_e, 0.0, _MOST)
        if not 0.0 <= self.prnu <= _MOST_PRNU:
            raise InputError(
                "prnu",
                f"must be 0 to {_MOST_PRNU:g} [1]",
                value=self.prnu,
                remedy="write 1 percent as 0.01",
            )
        _check.within("black_error_e", "e-", self.black_error_e, -_MOST, _MOST)
        for name in ("temperature_c", "dark_reference_c"):
            if getattr(self, name) is not None:
                _check.within(name, "C", getattr(self, name), _COLDEST_C, _HOTTEST_C)
        _check.within("dark_doubling_k", "K", self.dark_doubling_k, 3.0, 30.0)

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


PAPER_PIXEL = Pixel(pitch_um=10.0, full_well_e=10_000.0, read_noise_e=10.0)
"""Table 1 of Clouet, Vaillant & Alleysson (CIC27, 2019)."""

EXTRA_NOISE = ("dark_current_e_per_s", "dsnu_e", "prnu", "row_noise_e", "black_error_e")
"""Fields of `Pixel` that add noise or bias beyond shot and read noise; 0 by default."""


def shot_and_read_only(pixel: Pixel) -> Pixel:
    """The pixel without dark current, DSNU, PRNU, row noise and black-level error."""
    return replace(pixel, **dict.fromkeys(EXTRA_NOISE, 0.0), temperature_c=None)


def extra_noise(pixel: Pixel) -> dict[str, float]:
    """The values of `EXTRA_NOISE` that are not 0, by name."""
    return {name: value for name in EXTRA_NOISE if (value := getattr(pixel, name))}
