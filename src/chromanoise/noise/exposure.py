"""Expected electrons of scenes and cubes (eq. 1-2), exposure rules, and the operating point.

For a cube, resampling, illuminant, exposure and QE are one weight per band. Exposure rules compare
sensors at equal time, equal saturation, or equal photons. The rule determines which sensor is best,
so each comparison names its rule. An operating point is a sensor with its exposure, light and
observer.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypedDict, Unpack

import numpy as np

from chromanoise.base import Array, Float, InputError, check, dataclass, with_short_repr
from chromanoise.sensor import Pixel, Sensor, code_range_e, pixels_of
from chromanoise.spectra import (
    DEFAULT_OBSERVER,
    Beyond,
    Cube,
    Illuminant,
    Metric,
    PatchPairs,
    Scene,
    Spectra,
    chart_title,
    flat_field,
    interpolation_matrix,
    known_observer,
    light,
    photons_per_unit,
)

DEFAULT_RULE = "exposure"
"""Of `EQUAL_TERMS`: all sensors have the same time."""
DEFAULT_F_NUMBER = 1.8
DEFAULT_SHARE = 0.99
"""Of full well, for the time to saturation: that of the paper. [1]"""
FASTEST_F_NUMBER = 0.5
"""The least f-number of a lens in air, by the sine condition."""


@dataclass(frozen=True, kw_only=True)
class Exposure:
    """Exposure time, f-number and magnification of an exposure.

    Attributes
    ----------
    time_s
        Exposure time t_i. [s]
    f_number
        f_# of the lens.
    magnification
        ``None`` for the paper's distant Lambertian scene, 1 / (4 f#^2) of the illuminance.
        A number m selects the camera equation 1 / (1 + 4 f#^2 (1 + |m|)^2) instead, which at
        f/1.8 and m = 0 is 0.32 dB darker.

    Raises
    ------
    InputError
        If a value is not positive, or out of the range of double precision.
    """

    time_s: float
    f_number: float = DEFAULT_F_NUMBER
    magnification: float | None = None

    def __post_init__(self) -> None:
        check.positive("time_s", "s", self.time_s)
        check.within("time_s", "s", self.time_s, 1e-15, 1e12)
        refuse_f_number(self.f_number)
        if self.magnification is not None:
            check.within("magnification", "1", self.magnification, -1e6, 1e6)


def refuse_f_number(f_number: float) -> None:
    """Raise an error if no lens in air has this f-number.

    Parameters
    ----------
    f_number
        Aperture of the lens. [1]

    Raises
    ------
    InputError
        If it is below 0.5, where the sine of the half angle of the light cone, 1/(2 f#), would
        exceed 1, or above 1e6.
    """
    if not FASTEST_F_NUMBER <= f_number <= 1e6:
        raise InputError(
            "f_number",
            f"must be {FASTEST_F_NUMBER:g} to 1e+06",
            value=float(f_number),
            remedy=f"no lens in air is faster than f/{FASTEST_F_NUMBER:g} (sine condition)",
        )


def exposure_factor(exposure: Exposure, pixel: Pixel, step_nm: float) -> float:
    """The factor k of eq. 2: t a^2 delta-lambda / (4 f#^2). [s um2 nm]

    Parameters
    ----------
    step_nm
        Step of the wavelengths. [nm]

    Examples
    --------
    >>> pixel = Pixel(pitch_um=10, full_well_e=10_000, read_noise_e=10)
    >>> round(exposure_factor(Exposure(time_s=0.0324, f_number=1.8), pixel, 1.0), 6)
    0.25
    """
    share = 1.0 / (4.0 * exposure.f_number**2)  # illuminance of the image over that of the white
    if exposure.magnification is not None:
        near = (1.0 + abs(exposure.magnification)) ** 2
        share = 1.0 / (1.0 + 4.0 * exposure.f_number**2 * near)
    return exposure.time_s * pixel.pitch_um**2 * step_nm * share


def measurement_vectors(sensor: Sensor, exposure: Exposure, metric: Metric) -> Float[Array, "n p"]:
    """The matrix F of eq. 3: one column f_i = k QE_i per channel, so that M = F^T L.

    Parameters
    ----------
    metric
        The unit in which L is a vector; in ``energy``, f carries lambda / (h c) as well.
        [e- per unit of L]
    """
    k = exposure_factor(exposure, sensor.pixel, sensor.grid.step_nm)
    if metric == "quanta":
        return k * sensor.qe
    return k * sensor.qe * photons_per_unit(sensor.grid, metric)[:, None]


def expected_electrons(scene: Scene, sensor: Sensor, exposure: Exposure) -> Float[Array, "*px p"]:
    """Expected electrons per channel, M = k QE^T L (eq. 2). [e-]

    Parameters
    ----------
    scene
        Light from the scene.

    Raises
    ------
    InputError
        If scene and sensor are not on the same grid.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 1-2. The integral is a plain sum, as there.
    """
    refuse_other_grid(scene, sensor)
    return light(scene, "quanta") @ measurement_vectors(sensor, exposure, "quanta")


def time_to_saturation(
    scene: Scene,
    sensor: Sensor,
    *,
    f_number: float = DEFAULT_F_NUMBER,
    share: float = DEFAULT_SHARE,
    magnification: float | None = None,
) -> float:
    """The time at which the most sensitive channel reaches ``share`` of its range. [s]

    Its range is the full well, which dark electrons fill too, or the top code of the converter,
    whichever is reached first (`chromanoise.sensor.white_level_e`).

    Parameters
    ----------
    scene
        Scene; its brightest point determines the time.
    f_number, magnification
        As `Exposure`.
    share
        Share of full well or top code; the paper uses 0.99.

    Raises
    ------
    InputError
        If no channel receives light.
    """
    share = check.positive("share", "1", share)
    if share > 1:
        raise InputError(
            "share",
            "must be at most 1 [share of full well]",
            value=share,
            remedy="divide percent by 100",
        )
    per_second = expected_electrons(
        scene, sensor, Exposure(time_s=1.0, f_number=f_number, magnification=magnification)
    )
    dark_per_second = sensor.pixel.dark_electrons_e(time_s=1.0)
    if not per_second.max() > 0:
        raise InputError(
            f"sensor {sensor.name}", "must see light of the scene", found="no channel sees any"
        )
    most = float(per_second.max())
    to_full_well = sensor.pixel.full_well_e / (most + dark_per_second)
    return share * min(to_full_well, code_range_e(sensor) / most)


class SaturationTerms(TypedDict, total=False):
    """Keyword arguments of `time_to_saturation`, with its defaults.

    Attributes
    ----------
    f_number, magnification
        As `Exposure`.
    share
        Share of full well or top code that the most sensitive channel reaches. [1]
    """

    f_number: float
    share: float
    magnification: float | None


def saturating_exposure(scene: Scene, sensor: Sensor, **terms: Unpack[SaturationTerms]) -> Exposure:
    """The exposure with the time of `time_to_saturation`.

    Parameters
    ----------
    scene, sensor
        As `time_to_saturation`.
    terms
        ``f_number``, ``share`` and ``magnification`` of `time_to_saturation`.
    """
    time_s = time_to_saturation(scene, sensor, **terms)
    lens: dict[str, Any] = {name: one for name, one in terms.items() if name != "share"}
    return Exposure(time_s=time_s, **lens)


def refuse_other_grid(scene: Scene, sensor: Sensor) -> None:
    """Check that scene and sensor have the same wavelength grid."""
    if scene.illuminant.grid != sensor.grid:
        lit, own = scene.illuminant.grid, sensor.grid
        raise InputError(
            "grid",
            "must be the same for scene and sensor",
            value=(lit, own),
            found=f"the illuminant {scene.illuminant.name} is on {lit} and {sensor.name} on {own}",
        )


def band_weights(
    cube: Cube, white: Scene, sensor: Sensor, exposure: Exposure, *, beyond: Beyond = "refuse"
) -> tuple[Float[Array, "m p"], tuple[str, ...]]:
    """Electrons per unit of reflectance in each band; ``rho @ weights`` gives electrons. [e-]

    Interpolation of a cube onto the grid is linear, so it is applied once to the weights instead
    of to each pixel.

    Parameters
    ----------
    cube
        Only its wavelengths are used.
    white
        A perfect white (`flat_field`) under the illuminant of the cube.
    sensor, exposure
        The sensor and its exposure.
    beyond
        How to extrapolate reflectances where the cube does not cover the grid.

    Returns
    -------
    weights
        One column per channel.
    notes
        How the cube was extrapolated where it does not cover the grid.

    Raises
    ------
    InputError
        If the cube does not cover the grid and ``beyond`` is ``refuse``, or scene and sensor are
        on different grids.
    """
    refuse_other_grid(white, sensor)
    onto_grid, notes = interpolation_matrix(
        cube.wavelength_nm, sensor.grid, beyond=beyond, what=f"reflectance of {cube.source}"
    )
    per_wavelength = light(white, "quanta")[:, None] * measurement_vectors(
        sensor, exposure, "quanta"
    )
    return onto_grid.T @ per_wavelength, notes


def equal_saturation(
    white: Scene, sensors: Sequence[Sensor], **terms: Unpack[SaturationTerms]
) -> list[Exposure]:
    """Each sensor has its own time: its most sensitive channel reaches ``share`` of full well.

    Parameters
    ----------
    white
        The brightest object that must not saturate.
    sensors
        Sensors that are to be compared.
    terms
        ``f_number``, ``share`` and ``magnification`` of `time_to_saturation`, the same for all.

    Raises
    ------
    InputError
        As `saturating_exposure`.
    """
    return [saturating_exposure(white, sensor, **terms) for sensor in sensors]


def equal_exposure(
    white: Scene, sensors: Sequence[Sensor], **terms: Unpack[SaturationTerms]
) -> list[Exposure]:
    """All sensors have the same time: the longest at which none exceeds ``share``.

    Errors as `equal_saturation`.

    Parameters
    ----------
    white, sensors, terms
        As `equal_saturation`.
    """
    own = equal_saturation(white, sensors, **terms)
    return [min(own, key=lambda exposure: exposure.time_s)] * len(own)


def equal_light(
    white: Scene, sensors: Sequence[Sensor], **terms: Unpack[SaturationTerms]
) -> list[Exposure]:
    """Each set of channels receives the same photons, for any number of pixels per set.

    The time is proportional to 1 / (pixels a^2): four channels on four pixels have 3/4 of the time
    of three channels on three pixels, and three stacked channels on one pixel have 3 times that
    time. It is the longest at which no sensor exceeds ``share`` of full well.

    Errors as `equal_saturation`.

    Parameters
    ----------
    white, sensors, terms
        As `equal_saturation`.
    """
    own = equal_saturation(white, sensors, **terms)
    area_um2 = [pixels_of(sensor) * sensor.pixel.pitch_um**2 for sensor in sensors]
    least = min(e.time_s * area for e, area in zip(own, area_um2, strict=True))
    return [
        replace(exposure, time_s=least / area) for exposure, area in zip(own, area_um2, strict=True)
    ]


EQUAL_TERMS: Mapping[str, Callable[..., list[Exposure]]] = {
    "exposure": equal_exposure,
    "saturation": equal_saturation,
    "light": equal_light,
}
"""The exposure rules by name; ``DEFAULT_RULE`` is one of them."""


_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MOST_TIMES = 3


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
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
        check.positive("level_lux", "lx", self.level_lux)
        object.__setattr__(self, "observer", known_observer(self.observer))
        patches = None if self.pairs is None else self.pairs.patches
        for spectra in (self.chart, self.patch, patches):
            if spectra is not None:
                size = len(spectra.wavelength_nm)
                check.same_length("wavelengths", reflectance=size, light=self.illuminant.grid.n)

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
    return replace(white_scene(operating_point), reflectance=operating_point.patch_reflectance)


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
        Significant digits, at least 1.

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
