"""Operating point: a sensor with its exposure, light and observer; its text."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.exposure.electrons import Exposure
from chromanoise.scene import Scene, flat_field
from chromanoise.sensor import Sensor
from chromanoise.spectra import (
    DEFAULT_OBSERVER,
    Illuminant,
    PatchPairs,
    Spectra,
    chart_title,
    known_observer,
)

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MOST_TIMES = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OperatingPoint:
    """A sensor, its exposure, the light on the scene, and the observer of the colors.

    Attributes
    ----------
    sensor, exposure
        The sensor and its exposure.
    illuminant, level_lux
        The illuminant, and its illuminance on the scene. [lx]
    observer
        The observer for which color matrices are made, from `chromanoise.spectra.OBSERVERS`. The
        illuminance is that of CIE 1931 for any observer.
    chart
        Reflectances for color error and total error, on the grid; ``None`` for the ColorChecker.
    patch
        The one reflectance that is analyzed, on the grid; ``None`` for a perfect white.
    pairs
        Patches that a machine must tell apart, on the grid; ``None`` for all pairs of the chart.

    Raises
    ------
    InputError
        If the level is not finite and positive, or there is no observer of that name.
    """

    sensor: Sensor
    exposure: Exposure
    illuminant: Illuminant
    level_lux: float
    observer: str = DEFAULT_OBSERVER
    chart: Spectra | None = None
    patch: Spectra | None = None
    pairs: PatchPairs | None = None

    def __post_init__(self) -> None:
        _check.positive("level_lux", "lx", self.level_lux)
        object.__setattr__(self, "observer", known_observer(self.observer))
        patches = None if self.pairs is None else self.pairs.patches
        for spectra in (self.chart, self.patch, patches):
            if spectra is not None:
                size = len(spectra.wavelength_nm)
                _check.same_length("wavelengths", reflectance=size, light=self.illuminant.grid.n)

    @property
    def patch_reflectance(self) -> Float[Array, " n"]:
        """The reflectance that is analyzed: 1 without a patch."""
        if self.patch is None:
            return np.ones(self.illuminant.grid.n)
        return self.patch.values[:, 0]

    @property
    def patch_name(self) -> str:
        """The patch in words."""
        return "a perfect white" if self.patch is None else f"patch {self.patch.names[0]}"


def white_scene(operating_point: OperatingPoint) -> Scene:
    """A perfect white under this illuminant.

    Parameters
    ----------
    operating_point
        A sensor in its light, with its exposure.
    """
    return flat_field(operating_point.illuminant, level_lux=operating_point.level_lux)


def patch_scene(operating_point: OperatingPoint) -> Scene:
    """The patch that is analyzed, under this illuminant; a perfect white without one.

    Parameters
    ----------
    operating_point
        A sensor in its light, with its exposure.
    """
    if operating_point.patch is None:
        return white_scene(operating_point)
    return Scene(
        illuminant=operating_point.illuminant,
        level_lux=operating_point.level_lux,
        reflectance=operating_point.patch_reflectance,
    )


def conditions(points: Sequence[OperatingPoint]) -> str:
    """The operating point as text: light level, illuminant, exposure time and f-number.

    The observer is named where it is not CIE 1931.

    Parameters
    ----------
    points
        Sensors under the same light, with the same observer.

    Examples
    --------
    >>> from chromanoise.study import operating_points_of, study_from_data
    >>> study = study_from_data({"sensors": [{"name": "onyx-rgbw"}]}, source="")
    >>> conditions(operating_points_of(study))
    '10 lx (illuminant E, 11.94 ms, f/1.8)'
    """
    return f"{level_in_words(points[0].level_lux, 4)} ({light_and_exposure(points)})"


def light_and_exposure(points: Sequence[OperatingPoint]) -> str:
    """Illuminant, exposure time, f-number and observer: the operating point without its level.

    Parameters
    ----------
    points
        Operating points of the sensors.

    Examples
    --------
    >>> from chromanoise.study import operating_points_of, study_from_data
    >>> study = study_from_data({"sensors": [{"name": "onyx-rgbw"}]}, source="")
    >>> light_and_exposure(operating_points_of(study))
    'illuminant E, 11.94 ms, f/1.8'
    """
    first = points[0]
    times_ms = [1e3 * one.exposure.time_s for one in points]
    if len(set(times_ms)) == 1:
        time = _duration(times_ms[0])
    elif len(points) <= _MOST_TIMES:
        pairs = zip(times_ms, points, strict=True)
        time = ", ".join(f"{_duration(ms)} ({one.sensor.label})" for ms, one in pairs)
    else:
        time = f"{_duration(min(times_ms))} to {_duration(max(times_ms))}"
    words = [f"illuminant {first.illuminant.name}, {time}, f/{first.exposure.f_number:g}"]
    if first.observer != DEFAULT_OBSERVER:
        words.append(f"observer {first.observer}")
    if first.patch is not None:
        words.append(first.patch_name)
    if first.chart is not None:
        words.append(f"chart {chart_title(first.chart)}")
    return ", ".join(words)


def _duration(ms: float) -> str:
    """A time in ms, or in s if it exceeds 10 s."""
    return f"{ms:.4g} ms" if ms < 9999.5 else f"{1e-3 * ms:.4g} s"


def level_in_words(level_lux: float, digits: int = 3) -> str:
    """A light level as text, with a power of ten for very small or large values.

    Parameters
    ----------
    level_lux
        > 0. [lx]
    digits
        That count.

    Examples
    --------
    >>> level_in_words(12.34), level_in_words(0.0000133), level_in_words(20000.0)
    ('12.3 lx', '1.33·10⁻⁵ lx', '20000 lx')
    """
    mantissa, _, power = f"{level_lux:.{digits - 1}e}".partition("e")
    rounded = float(f"{mantissa}e{power}")
    if 1e-3 <= rounded < 1e6:
        return f"{rounded:.15g} lx"
    factor = f"{float(mantissa):g}"
    ten = f"10{str(int(power)).translate(_SUPERSCRIPT)} lx"
    return ten if factor == "1" else f"{factor}·{ten}"
