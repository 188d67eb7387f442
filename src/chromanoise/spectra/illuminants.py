"""Light sources, by formula or by name, normalized to one lux, so that a level in lux scales them.

A name can add an infrared diode to a light.
"""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from chromanoise.base import (
    BOLTZMANN_J_PER_K,
    LIGHT_M_PER_S,
    LUMEN_PER_WATT,
    PLANCK_J_S,
    UM2_PER_M2,
    Array,
    Float,
    InputError,
    Setting,
    check,
    dataclass,
    kept,
    photons_per_joule,
    with_short_repr,
)
from chromanoise.spectra.curves import (
    DEFAULT_GRID,
    SMALL_NEGATIVES,
    Beyond,
    Grid,
    Spectra,
    means_on_grid,
    refuse_outside,
    used_on_grid,
)
from chromanoise.spectra.observers import observer_table
from chromanoise.spectra.tables import catalog_curves, catalog_tables, formulas, packaged_table

_windows = np.lib.stride_tricks.sliding_window_view
Power = Callable[[Float[Array, " m"]], Float[Array, " m"]]

_HALOGEN_K = 3200.0
_HALOGEN_NOTE = "halogen: a black body of 3200 K, without the emissivity of tungsten"
_WHITE_NOTE = "led-white: a model of a blue diode and a phosphor, 4167 K, not a lamp"
_OBSERVER_START_NM = 360.0
_NOTED_IN_LINES = 0.03  # the absorption of the air alone gives sunlight 0.02
_DARKEST_LM_PER_W = 1e-3  # a source below this has practically no visible light


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Illuminant:
    """A light source at one lux.

    Attributes
    ----------
    name
        The name in results.
    grid
        Wavelengths of ``irradiance``; n of them. [nm]
    irradiance
        Spectral irradiance at 1 lx. [W m-2 nm-1 lx-1]
    notes
        Assumptions, e.g. how the measured curve was extrapolated.

    Raises
    ------
    InputError
        If a value is negative or not finite, or the number of wavelengths differs.
    """

    name: str
    grid: Grid
    irradiance: Float[Array, " n"]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        name = f"irradiance of illuminant {self.name}"
        checked = check.non_negative(name, "W m-2 nm-1 lx-1", self.irradiance)
        check.same_length("wavelengths", grid=self.grid.n, irradiance=checked.size)
        check.keep(self, irradiance=checked)


def photon_irradiance(illuminant: Illuminant) -> Float[Array, " n"]:
    """The i(lambda) of eq. 1: photon irradiance at one lux. [photons s-1 um-2 nm-1 lx-1]

    Examples
    --------
    >>> visible = photon_irradiance(equal_energy(Grid.uniform(400, 700, 1)))
    >>> round(float(visible.sum()))          # photons per lux, second and um2
    11419
    """
    return _photon_irradiance(illuminant).copy()


@kept
def _photon_irradiance(illuminant: Illuminant) -> Float[Array, " n"]:
    per_joule = photons_per_joule(illuminant.grid.wavelength_nm)
    return illuminant.irradiance * per_joule / UM2_PER_M2


def equal_energy(grid: Grid) -> Illuminant:
    """CIE illuminant E, the same power at every wavelength of the grid.

    The paper extends it to 1050 nm.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    """
    return _from_formula("E", np.ones_like, grid)


def cie_a(grid: Grid) -> Illuminant:
    """CIE standard illuminant A by its defining equation (CIE 015:2018, eq. 4.1).

    Parameters
    ----------
    grid
        Wavelengths of the result.
    """
    return _from_formula("A", partial(_planck, temperature_k=2848.0, c2_m_k=1.435e-2), grid)


def black_body(grid: Grid, temperature_k: float) -> Illuminant:
    """A Planckian radiator at ``temperature_k`` [K].

    Parameters
    ----------
    grid
        Wavelengths of the result.
    temperature_k
        Temperature. [K]
    """
    kelvin = check.positive("temperature_k", "K", temperature_k)
    c2_m_k = PLANCK_J_S * LIGHT_M_PER_S / BOLTZMANN_J_PER_K
    return _from_formula(
        f"{kelvin:g} K black body", partial(_planck, temperature_k=kelvin, c2_m_k=c2_m_k), grid
    )


def led(grid: Grid, peak_nm: float, width_nm: float = 20.0) -> Illuminant:
    """A light-emitting diode, by Ohno's two-term model around ``peak_nm``.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    peak_nm, width_nm
        Peak wavelength and the width parameter of Ohno's model. The full width at half maximum
        is 0.92 times the width parameter. [nm]

    Raises
    ------
    InputError
        If the diode is too narrow for the grid, or has practically no visible light (850 nm).

    Notes
    -----
    Ohno, "Spectral design considerations for white LED color rendering", Opt. Eng. 44 (2005),
    111302, eq. 1.
    """
    power = _diode(grid, peak_nm, width_nm)
    return _from_formula(f"{peak_nm:g} nm LED, {width_nm:g} nm wide", power, grid)


def halogen(grid: Grid) -> Illuminant:
    """A halogen lamp, modeled as a black body of 3200 K.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    """
    return replace(black_body(grid, _HALOGEN_K), name="halogen", notes=(_HALOGEN_NOTE,))


def led_white(grid: Grid) -> Illuminant:
    """A white LED of 4167 K, modeled as a blue diode and a phosphor of equal peak height.

    Parameters
    ----------
    grid
        Wavelengths of the result.

    Notes
    -----
    The diode follows Ohno (Opt. Eng. 44 (2005), 111302, eq. 1) at 450 nm, 24 nm wide; the phosphor
    is a Gaussian around 580 nm with a standard deviation of 60 nm. These parameters are our own
    choice and do not describe a real lamp.
    """

    def power(wavelength_nm: Float[Array, " m"]) -> Float[Array, " m"]:
        phosphor = np.exp(-0.5 * ((wavelength_nm - 580.0) / 60.0) ** 2)
        return diode_power(wavelength_nm, peak_nm=450.0, width_nm=24.0) + phosphor

    return replace(_from_formula("led-white", power, grid), notes=(_WHITE_NOTE,))


def _diode(grid: Grid, peak_nm: float, width_nm: float) -> Power:
    """The power of a diode; one that is too narrow for the grid raises an error."""
    peak = check.positive("peak_nm", "nm", peak_nm)
    width = check.positive("width_nm", "nm", width_nm)
    if width < 2 * grid.step_nm:
        need = f"must be at least {2 * grid.step_nm:g} [nm], two steps of the grid"
        raise InputError("width_nm", need, value=width, remedy="use a finer grid")
    return partial(diode_power, peak_nm=peak, width_nm=width)


def diode_power(
    wavelength_nm: Float[Array, " m"], *, peak_nm: float, width_nm: float
) -> Float[Array, " m"]:
    """Relative power of Ohno's diode model (`led`)."""
    bell = np.exp(-(((wavelength_nm - peak_nm) / width_nm) ** 2))
    return (bell + 2 * bell**5) / 3


def astm_g173(grid: Grid, *, beyond: Beyond = "refuse") -> Illuminant:
    """Daylight including the near infrared: ASTM G173-03 global tilt, averaged over 5 nm.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    beyond
        Values outside the range of the data: refuse, zero or hold.
    """
    return illuminant_from(packaged_table("astm_g173_global"), grid, name="G173", beyond=beyond)


_CIE_TABLES = (
    *("cie_daylight", "cie_lamps", "cie_d60", "cie_b"),
    *("iso_7589", "iso_7589_printer"),
)


def cie_illuminant(name: str, grid: Grid, *, beyond: Beyond = "refuse") -> Illuminant:
    """A tabulated CIE illuminant (D65, D50, FL2, LED-B3 ...).

    Most tables end at 780 nm. On a grid that extends further, ``beyond`` must be ``zero`` or
    ``hold``.

    Parameters
    ----------
    name
        Name such as ``D65``.
    grid
        Wavelengths of the result.
    beyond
        Values outside the range of the data: refuse, zero or hold.
    """
    if name in ("A", "E"):
        return _FORMULAS[name](grid)
    check.one_of("illuminant", name, _cie_names())
    table = next(one for one in map(packaged_table, _CIE_TABLES) if name in one.names)
    curve = replace(
        table,
        values=table.values[:, [table.names.index(name)]],
        names=(name,),
        source=f"CIE illuminant {name}",
    )
    return illuminant_from(curve, grid, name=name, beyond=beyond)


def illuminant_from(
    spectrum: Spectra, grid: Grid, *, name: str, beyond: Beyond = "refuse"
) -> Illuminant:
    """An illuminant from one curve of relative *power* (not photons) over wavelength.

    Parameters
    ----------
    spectrum
        One curve of relative power.
    grid
        Wavelengths of the result.
    name
        Name of the illuminant.
    beyond
        Values outside the range of the data: refuse, zero or hold.

    Raises
    ------
    InputError
        If there is not exactly one curve, or if the curve has a negative value, does not cover
        the grid, or has no visible light.
    """
    if len(spectrum.names) != 1:
        need = f"must hold one curve, for illuminant {name}"
        found = f"holds {len(spectrum.names)}: {', '.join(spectrum.names)}"
        columns = Setting("columns")
        raise InputError(spectrum.source, need, value=spectrum.names, found=found, remedy=columns)
    used = used_on_grid(spectrum.wavelength_nm, grid, from_nm=_OBSERVER_START_NM)
    refuse_outside(spectrum, remedy=SMALL_NEGATIVES, used=used)
    # values outside the grid and the observer's range are not used, so they are not checked
    spectrum = replace(spectrum, values=np.where(used[:, None], spectrum.values, 0.0))
    known, power = spectrum.wavelength_nm, spectrum.values[:, 0]
    resampled = means_on_grid(spectrum, grid, beyond=beyond)
    ends = {} if beyond == "hold" else {"left": 0.0, "right": 0.0}
    lux = _lux_of(lambda at: np.interp(at, known, power, **ends), name)
    narrow = share_in_narrow_lines(spectrum, grid)
    lines = (
        f"{spectrum.source}: {100 * narrow:.2g} % of its power is in lines narrower than the "
        f"wavelength step of {grid.step_nm:g} nm; each line is averaged over a step, which keeps "
        "its power"
    )
    return Illuminant(
        name=name,
        grid=grid,
        irradiance=resampled.values[:, 0] / lux,
        notes=(*resampled.notes, *([lines] if narrow > _NOTED_IN_LINES else [])),
    )


def share_in_narrow_lines(spectrum: Spectra, grid: Grid) -> float:
    """The share of a curve's power on a grid that is in lines narrower than the grid's step.

    The power in lines is the white top-hat of the curve: the curve minus its morphological opening
    by an interval of one step (Serra, Image Analysis and Mathematical Morphology, 1982). The share
    is 0 for a table with steps as wide as those of the grid.

    Parameters
    ----------
    spectrum
        One curve, not negative.
    grid
        The wavelengths to which it is resampled.

    Examples
    --------
    >>> at = np.arange(400.0, 1051.0)
    >>> lamp = Spectra(wavelength_nm=at, values=1.0 + 130.0 * (at[:, None] == 546), names=("lamp",),
    ...                quantity="power", unit="1", source="a lamp")
    >>> round(share_in_narrow_lines(lamp, Grid.uniform(400, 1050, 5)), 3)  # 130 of 650 + 130
    0.167
    """
    known, power = spectrum.wavelength_nm, spectrum.values[:, 0]
    usual = float(np.median(np.diff(known)))
    if usual >= grid.step_nm:
        return 0.0
    low, high = grid.wavelength_nm[[0, -1]]
    per_step = min(max(10, round(grid.step_nm / usual)), 100)
    count = round((high - low) / grid.step_nm) * per_step + 1
    fine = np.interp(np.linspace(low, high, count), known, power)
    lowest = _windows(np.pad(fine, per_step, mode="edge"), per_step + 1).min(axis=1)
    opened = _windows(lowest, per_step + 1).max(axis=1)
    total = float(fine.sum())
    return float((fine - opened).sum()) / total if total > 0 else 0.0


def _planck(
    wavelength_nm: Float[Array, " m"], *, temperature_k: float, c2_m_k: float
) -> Float[Array, " m"]:
    """Planck's law relative to its value at 560 nm."""

    def log_power(metre: Float[Array, " m"]) -> Float[Array, " m"]:
        x = c2_m_k / (metre * temperature_k)
        return np.asarray(-5 * np.log(metre) - x - np.log(-np.expm1(-x)))

    relative = log_power(wavelength_nm * 1e-9) - log_power(np.array([560e-9]))
    return np.exp(np.minimum(relative, 600.0))  # a cold body's NIR would overflow


def _from_formula(name: str, power: Power, grid: Grid) -> Illuminant:
    lux = _lux_of(power, name)
    return Illuminant(name=name, grid=grid, irradiance=power(grid.wavelength_nm) / lux)


def _lux_of(power: Power, name: str) -> float:
    """Lux of the curve ``power`` [W m-2 nm-1]: K_m sum y-bar power, 360-830 nm @1 (CIE 015)."""
    observer = observer_table()
    curve = power(observer.wavelength_nm)
    lux = LUMEN_PER_WATT * float(observer.values[:, 1] @ curve)
    if not lux > _DARKEST_LM_PER_W * max(float(curve.sum()), np.finfo(float).tiny):
        raise InputError(
            f"illuminant {name}",
            "must have visible light between 360 and 830 nm, for a level in lux",
            value=lux,
            found="has none",
        )
    return lux


_FORMULAS: dict[str, Callable[[Grid], Illuminant]] = {
    "E": equal_energy,
    "A": cie_a,
    "halogen": halogen,
    "led-white": led_white,
}
_BLACK_BODY, _LED = r"([\d.]+)\s*K", r"LED([\d.]+)(?:/([\d.]+))?"
_MIXTURE = re.compile(r"(.+)\+([\d.]+(?:[eE]-?\d+)?)xLED([\d.]+)(?:/([\d.]+))?")


def illuminant_named(
    name: str, grid: Grid = DEFAULT_GRID, *, beyond: Beyond = "refuse"
) -> Illuminant:
    """The illuminant with this name.

    Names are E, A, G173 (daylight to 1050 nm), ``halogen``, ``led-white``, the measured lamps of
    the catalog, the CIE illuminants (D65, FL2, LED-B3), ``<T>K`` for a black body,
    ``LED<peak>`` or ``LED<peak>/<width>`` for a diode, and ``<light>+<ratio>xLED<peak>`` for a
    light with an added infrared diode (`with_infrared`).

    Parameters
    ----------
    name
        One of these names.
    grid
        The target grid. [nm]
    beyond
        How to extrapolate a table that does not cover the grid: ``refuse``, ``zero`` or ``hold``.

    Returns
    -------
    Illuminant
        Normalized to one lux. [W m-2 nm-1 lx-1]

    Raises
    ------
    InputError
        If the name is unknown; the message suggests similar names.
    """
    return mixed(name, lambda bare: _light_named(bare, grid, beyond))


def is_light_name(name: str) -> bool:
    """Whether `illuminant_named` accepts this name of a light without an added diode.

    Parameters
    ----------
    name
        Name of a light.

    Examples
    --------
    >>> [is_light_name(name) for name in ("D65", "5500.5K", "LED850/20", "lamp.dat")]
    [True, True, True, False]
    """
    by_number = re.fullmatch(_BLACK_BODY, name) or re.fullmatch(_LED, name)
    return bool(by_number) or name in _known_lights()


def _known_lights() -> tuple[str, ...]:
    return (*_FORMULAS, *catalog_tables("illuminant"), *_cie_names())


def _cie_names() -> tuple[str, ...]:
    """The lights of `cie_illuminant`: catalog entries with a range but without a table."""
    listed = formulas().values()
    return tuple(sorted(t.name for t in listed if t.kind == "illuminant" and t.range_nm))


def mixed(name: str, light: Callable[[str], Illuminant]) -> Illuminant:
    """The illuminant ``name``, with ``light`` resolving names that have no added diode.

    Parameters
    ----------
    name
        A name as for `illuminant_named`. If it adds several diodes, the ratio of each is relative
        to everything before it in the name.
    light
        Returns the light for a name.

    Raises
    ------
    InputError
        If ``light`` raises it, or if a diode is invalid (`with_infrared`).
    """
    parts = infrared_parts(name)
    if parts is None:
        return light(name)
    base, diode = parts
    return replace(with_infrared(mixed(base, light), **diode), name=name)


def infrared_parts(name: str) -> tuple[str, dict[str, float]] | None:
    """The part of a name before its last diode, and that diode as arguments of `with_infrared`.

    Returns None if the name has no added diode.

    Parameters
    ----------
    name
        Name such as ``A+0.5xLED850``.

    Raises
    ------
    InputError
        If the ratio, peak or width is not a number.

    Examples
    --------
    >>> infrared_parts("A+0.5xLED940/50")
    ('A', {'ratio': 0.5, 'peak_nm': 940.0, 'width_nm': 50.0})
    >>> infrared_parts("LED940") is None
    True
    """
    match = _MIXTURE.fullmatch(name)
    if match is None:
        return None
    ratio, peak_nm, width_nm = (
        _number(text, name) for text in (*match.group(2, 3), match[4] or "20")
    )
    return match[1], {"ratio": ratio, "peak_nm": peak_nm, "width_nm": width_nm}


def _light_named(name: str, grid: Grid, beyond: Beyond) -> Illuminant:
    if name in _FORMULAS:
        return _FORMULAS[name](grid)
    if match := re.fullmatch(_BLACK_BODY, name):
        kelvin = check.positive(f"temperature of illuminant {name}", "K", _number(match[1], name))
        return black_body(grid, kelvin)
    if match := re.fullmatch(_LED, name):
        peak_nm, width_nm = (_number(text, name) for text in (match[1], match[2] or "20"))
        ends = (grid.start_nm, grid.stop_nm)
        check.within(f"peak of illuminant {name}", "nm", peak_nm, *ends)
        check.positive(f"width of illuminant {name}", "nm", width_nm)
        return led(grid, peak_nm, width_nm)
    measured = catalog_tables("illuminant")
    if name in measured:
        return illuminant_from(catalog_curves(measured[name]), grid, name=name, beyond=beyond)
    known = check.one_of("illuminant", name, _known_lights())
    return cie_illuminant(known, grid, beyond=beyond)


def with_infrared(
    illuminant: Illuminant, *, peak_nm: float, width_nm: float = 20.0, ratio: float
) -> Illuminant:
    """The light plus an infrared diode; the sum is normalized to one lux.

    Parameters
    ----------
    peak_nm, width_nm
        Peak and width of the diode, as in `led`. [nm]
    ratio
        Radiant power of the diode divided by that of the light, both on the light's grid, >= 0.
        With 0 the light is returned unchanged. [W/W]

    Raises
    ------
    InputError
        If the ratio is negative, or the diode is too narrow for the grid or extends beyond it.

    Notes
    -----
    An infrared diode alone has practically no illuminance, so its level cannot be set in lux.
    Here its ratio to a light sets its level. The normalization includes the small visible part of
    the diode.

    Examples
    --------
    >>> lamp = equal_energy(Grid.uniform(400, 1050, 5))
    >>> lit = with_infrared(lamp, peak_nm=850, ratio=0.5)
    >>> round(float(lit.irradiance.sum() / lamp.irradiance.sum()), 4)      # half as much again
    1.5
    """
    share = check.within("ratio of infrared", "W/W", ratio, 0.0, 1e6)
    power = _diode_within(illuminant.grid, peak_nm, width_nm)
    if share == 0:
        return illuminant
    grid = illuminant.grid
    scale = share * illuminant.irradiance.sum() / power(grid.wavelength_nm).sum()
    observer = observer_table()
    seen = LUMEN_PER_WATT * float(observer.values[:, 1] @ power(observer.wavelength_nm))
    added = scale * power(grid.wavelength_nm)
    return replace(
        illuminant,
        name=f"{illuminant.name} + {share:g} x {peak_nm:g} nm LED, {width_nm:g} nm wide",
        irradiance=(illuminant.irradiance + added) / (1.0 + scale * seen),
    )


def _diode_within(grid: Grid, peak_nm: float, width_nm: float) -> Power:
    """The power of a diode that lies within the grid; two widths contain all but 1e-4 of it."""
    power, (low, high) = _diode(grid, peak_nm, width_nm), grid.wavelength_nm[[0, -1]]
    if peak_nm - 2 * width_nm < low or peak_nm + 2 * width_nm > high:
        size = f"{peak_nm:g} nm, {width_nm:g} nm wide"
        raise InputError(
            "peak_nm",
            f"must be {low + 2 * width_nm:g} to {high - 2 * width_nm:g} [nm]",
            value=float(peak_nm),
            found=f"an LED of {size}, reaches outside of the grid {grid}",
        )
    return power


def _number(text: str, name: str) -> float:
    found = f"{text!r} is not one"
    return check.number(text, f"illuminant {name!r}", "must have a number", found=found)
