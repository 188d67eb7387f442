"""Illuminants by name, alone or with an added infrared diode."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from chromanoise import _check
from chromanoise.errors import InputError
from chromanoise.spectra.curves import Beyond
from chromanoise.spectra.grid import DEFAULT_GRID, Grid
from chromanoise.spectra.illuminants import (
    Illuminant,
    Power,
    black_body,
    cie_a,
    cie_illuminant,
    diode_power,
    equal_energy,
    halogen,
    illuminant_from,
    led,
    led_white,
    narrow_diode,
)
from chromanoise.spectra.observers import observer_table
from chromanoise.spectra.tables import catalog_curves, catalog_tables, formulas
from chromanoise.units import LUMEN_PER_WATT

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
    the catalog, any CIE illuminant of colour-science (D65, FL2, LED-B3), ``<T>K`` for a black body,
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
        kelvin = _check.positive(f"temperature of illuminant {name}", "K", _number(match[1], name))
        return black_body(grid, kelvin)
    if match := re.fullmatch(_LED, name):
        peak_nm, width_nm = (_number(text, name) for text in (match[1], match[2] or "20"))
        ends = (grid.start_nm, grid.stop_nm)
        _check.within(f"peak of illuminant {name}", "nm", peak_nm, *ends)
        _check.positive(f"width of illuminant {name}", "nm", width_nm)
        return led(grid, peak_nm, width_nm)
    measured = catalog_tables("illuminant")
    if name in measured:
        return illuminant_from(catalog_curves(measured[name]), grid, name=name, beyond=beyond)
    known = _check.one_of("illuminant", name, _known_lights())
    return cie_illuminant(known, grid, beyond=beyond)


def with_infrared(
    illuminant: Illuminant, *, peak_nm: float, width_nm: float = 20.0, ratio: float
) -> Illuminant:
    """The light plus an infrared diode; the sum is normalized to one lux.

    Parameters
    ----------
    illuminant
        Any light.
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
    share = _check.within("ratio of infrared", "W/W", ratio, 0.0, 1e6)
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
    peak, width = (
        _check.positive("peak_nm", "nm", peak_nm),
        _check.positive("width_nm", "nm", width_nm),
    )
    at = grid.wavelength_nm
    if width < 2 * grid.step_nm:
        raise narrow_diode(width, grid)
    if peak - 2 * width < at[0] or peak + 2 * width > at[-1]:
        raise InputError(
            "peak_nm",
            f"must be {at[0] + 2 * width:g} to {at[-1] - 2 * width:g} [nm]",
            value=peak,
            found=f"an LED of {peak:g} nm, {width:g} nm wide, reaches outside of the grid {grid}",
        )
    return partial(diode_power, peak_nm=peak, width_nm=width)


def _number(text: str, name: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(
            f"illuminant {name!r}", "must have a number", value=text, found=f"{text!r} is not one"
        ) from None
