"""Figures of merit, each with its source: of the filters, and of the sensor in its light."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import ClassVar

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    check,
    dataclass,
    defined,
    keys_of,
    with_short_repr,
)
from chromanoise.color import LAB, LINEAR_SRGB, LUV, scene_xyz
from chromanoise.imaging import FilterBank, bilinear_filters, flat_field_noise, noise_power_spectrum
from chromanoise.metrics import (
    ISO_12232_2019,
    ISO_15739_2017,
    LEAST_COLOR,
    MatrixReport,
    color_sensitivity_bits,
    figure_of_merit,
    filter_quality,
    illuminance_for_snr,
    illuminance_for_snr_adapted,
    information_bits,
    matrix_report,
    metamerism,
    noise_speed,
    perceptual_weight,
    principal_angles_deg,
    second_moment,
    sensor_metamerism,
    tonal_range_bits,
    visual_noise_from_spectrum,
    vora_value,
)
from chromanoise.noise import (
    OperatingPoint,
    after_counting,
    counted_electrons,
    expected_electrons,
    measurement_vectors,
    saturated,
    signal_limit_e,
    white_scene,
    with_noise,
)
from chromanoise.sensor import Sensor, code_step_e
from chromanoise.spectra import Scene, cie_1931, color_axes, colorchecker, light, photons_per_unit
from chromanoise.study.analysis import Analysis, electrons_at, stages_at
from chromanoise.study.color_matrices import MatrixFunction
from chromanoise.study.color_noise import GRAY, PLANE, USUAL_VIEWING, Viewing, noise_as_viewed


@dataclass(frozen=True, kw_only=True)
class Merit:
    """One figure of merit.

    Attributes
    ----------
    what
        In words, unit not included.
    unit
        Its unit; 1 for none.
    value
        ``None`` where it is not defined.
    source
        Standard with its edition, or paper.
    missing
        Reason why there is no value; empty where there is one.

    Raises
    ------
    InputError
        If the value is not finite, or a missing value has no reason.
    """

    name: str
    what: str
    unit: str
    value: float | None
    source: str
    missing: str = ""

    def __post_init__(self) -> None:
        if self.value is not None:
            check.finite(self.name, self.unit, self.value)
        if (self.value is None) != bool(self.missing):
            raise InputError(
                f"merit {self.name}",
                "must have either a value or the reason why it has none",
                value=(self.value, self.missing),
                found=f"has {self.value} and {self.missing!r}",
            )


def merit_or_reason(
    name: str,
    what: str,
    unit: str,
    source: str,
    *,
    of: Callable[[], float | None],
    never: str = "not defined here",
) -> Merit:
    """A figure of merit; the text of an `InputError` is the reason why it has no value.

    Parameters
    ----------
    name, what, unit, source
        As `Merit`.
    of
        Returns the number; ``None`` or infinite where it is not defined.
    never
        The reason in that case.
    """
    try:
        value, missing = defined(of()), never
    except InputError as refusal:
        value, missing = None, str(refusal)
    if value is not None:
        value, missing = float(value), ""
    return Merit(name=name, what=what, unit=unit, value=value, source=source, missing=missing)


def white_color(analysis: Analysis) -> Float[Array, " 3"]:
    """X, Y and Z that the matrix makes of a perfect white's electrons (eq. 6). [lx]

    Raises
    ------
    InputError
        If X, Y or Z is no signal: negative, or below `LEAST_COLOR` times the true color.
    """
    at = stages_at(analysis.point, analysis.matrix)
    white = analysis.matrix.matrix @ at.expected_e
    for name, seen, wanted in zip(analysis.matrix.coordinates, white, at.truth_xyz, strict=True):
        if not seen > LEAST_COLOR * wanted:
            raise InputError(
                f"{name} of a perfect white",
                f"must be a signal, as colors are relative to it; the eye sees {wanted:.3g} lx",
                value=float(seen),
                found=f"is {seen:.3g} lx",
                remedy="take another lamp or matrix",
            )
    return np.asarray(white)


def refuse_full(analysis: Analysis) -> None:
    """Refuse an exposure at which a perfect white saturates a channel: eq. 7 does not hold there.

    Raises
    ------
    InputError
        If it does, with the names of the channels.
    """
    full = saturated(electrons_at(analysis.point), analysis.sensor, analysis.exposure)
    held = [name for name, is_full in zip(analysis.sensor.names, full, strict=True) if is_full]
    if held:
        raise InputError(
            f"sensor {analysis.sensor.name}",
            "must not be saturated by a perfect white",
            value=tuple(held),
            found=f"is in {', '.join(held)}",
            remedy="shorten the time or close the aperture",
        )


_COLORED_PATCHES = 18  # of 24; the gray row has no metamerism


# filters against the observer


def filter_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """Neugebauer's q, Vora value and principal angles over the whole grid, for any illuminant."""
    sensor, metric = analysis.sensor, analysis.matrix.metric
    filters = measurement_vectors(sensor, analysis.exposure, metric)
    eye = color_axes(sensor.grid, metric, analysis.matrix.observer)
    q = filter_quality(filters, eye)
    angles = principal_angles_deg(filters, eye)
    qualities = (
        merit_or_reason(
            f"neugebauer_q_{channel}",
            f"Neugebauer's q of {channel}",
            "1",
            "Neugebauer 1956",
            of=partial(float, value),
        )
        for channel, value in zip(sensor.names, q, strict=True)
    )
    between = (
        merit_or_reason(
            f"principal_angle_{i}",
            f"principal angle {i} between sensor and eye",
            "deg",
            "Bjorck & Golub 1973",
            of=partial(float, angle),
        )
        for i, angle in enumerate(angles, start=1)
    )
    vora = merit_or_reason(
        "vora_value",
        "Vora value",
        "1",
        "Vora & Trussell 1993",
        of=partial(vora_value, filters, eye),
    )
    return (*qualities, vora, *between)


def metamerism_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """SMI in the standard's light, and in that of the analysis."""
    lamp = analysis.scene.illuminant.name
    return (
        merit_or_reason(
            "smi",
            "sensitivity metamerism index, D55, 380-780 nm",
            "1",
            "ISO 17321-1:2012, annex D",
            of=lambda: sensor_metamerism(analysis.sensor).index,
        ),
        merit_or_reason(
            "smi_lamp",
            f"the same in {lamp}, whole grid, measured ColorChecker",
            "1",
            "formula of ISO 17321-1:2012",
            of=lambda: _lamp_metamerism(analysis),
        ),
    )


def _lamp_metamerism(analysis: Analysis) -> float:
    """SMI in the lamp of the analysis: the near infrared, which the standard leaves out, counts."""
    sensor, lamp = analysis.sensor, analysis.scene.illuminant
    return metamerism(
        sensor.qe * photons_per_unit(sensor.grid, "energy")[:, None],
        cie_1931(sensor.grid).values,
        lamp.irradiance,
        colorchecker(sensor.grid).values.T[:_COLORED_PATCHES],
    ).index


# merits under a prior: the ColorChecker in this light and exposure


def chart_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """General figure of merit and information; each patch of a ColorChecker is equally likely."""
    return (
        merit_or_reason(
            "figure_of_merit",
            "share of the ColorChecker's color (CIELAB) that the best matrix keeps",
            "1",
            "Sharma & Trussell 1997, eq. 7 noise",
            of=lambda: _chart_figure(analysis),
        ),
        merit_or_reason(
            "information",
            "information of a pixel with all channels on the ColorChecker's light",
            "bit",
            "Shannon 1948",
            of=lambda: _chart_information(analysis),
            never="without noise it is not finite",
        ),
    )


def _chart_figure(analysis: Analysis) -> float:
    refuse_full(analysis)
    chart, metric = _chart(analysis), analysis.matrix.metric
    observer = analysis.matrix.observer
    white_xyz = scene_xyz(white_scene(analysis.point), metric, observer)
    return figure_of_merit(
        measurement_vectors(analysis.sensor, analysis.exposure, metric),
        color_axes(analysis.sensor.grid, metric, observer),
        light_moment=second_moment(light(chart, metric)),
        noise_covariance=_mean_noise(chart, analysis),
        weight=perceptual_weight(LAB.jacobian(scene_xyz(chart, metric, observer), white_xyz)),
    )


def _chart_information(analysis: Analysis) -> float:
    refuse_full(analysis)
    chart = _chart(analysis)
    electrons = expected_electrons(chart, analysis.sensor, analysis.exposure)
    signal = second_moment(electrons - electrons.mean(axis=0))
    return float(information_bits(signal, _mean_noise(chart, analysis)))


def _chart(analysis: Analysis) -> Scene:
    return Scene(
        illuminant=analysis.scene.illuminant,
        level_lux=analysis.scene.level_lux,
        reflectance=colorchecker(analysis.sensor.grid).values.T,
    )


def _mean_noise(scene: Scene, analysis: Analysis) -> Float[Array, "p p"]:
    """Covariance of the raw channels, mean of the patches. [e-^2]"""
    electrons = expected_electrons(scene, analysis.sensor, analysis.exposure)
    return with_noise(electrons, analysis.sensor, analysis.exposure).covariance.mean(axis=0)


_SAME_MATRIX = 1e-9  # two matrices that differ by less are one
_SPEEDS = ((10, "first acceptable"), (40, "first excellent"))


# speed: the least light for an SNR


def speed_merits(analysis: Analysis, maker: MatrixFunction | None) -> tuple[Merit, ...]:
    """SNR10 of the matrix in use, of one that adapts, and the noise-based speeds."""
    card = f"{100 * GRAY:.0f} % gray, this exposure"
    never = f"no light is enough: a channel saturates first, or Y of a gray ({card}) is no signal"
    adapts = maker is not None and _adapts(analysis.point, maker)
    fixed = merit_or_reason(
        "snr10",
        f"SNR10 of Y, {card}, matrix kept",
        "lx",
        "Alakarhu, IISW 2007",
        of=lambda: illuminance_for_snr(
            analysis.sensor,
            analysis.scene.illuminant,
            analysis.exposure,
            analysis.matrix,
            reflectance=GRAY,
        ),
        never=never,
    )
    adapted = merit_or_reason(
        "snr10_adapted",
        f"SNR10 of Y, {card}, matrix adapted",
        "lx",
        "Alakarhu, IISW 2007",
        of=lambda: _adapted_light(analysis.point, maker) if maker and adapts else None,
        never=never if adapts else "this matrix does not adapt to the light; see the one kept",
    )
    return (fixed, adapted, *_noise_speeds(analysis))


def _noise_speeds(analysis: Analysis) -> tuple[Merit, ...]:
    """Per lux second on the focal plane of the lamp of the analysis."""

    def speed(snr: int) -> float | None:
        white = white_color(analysis)
        matrix = analysis.matrix.matrix
        to_rgb = LINEAR_SRGB.jacobian(white, white) @ matrix
        return noise_speed(analysis.sensor, analysis.scene.illuminant, to_rgb, snr=snr)

    return tuple(
        merit_or_reason(
            f"noise_speed_{snr}",
            f"noise-based speed S{snr} ({quality}) in {analysis.scene.illuminant.name}",
            "1",
            ISO_12232_2019.edition,
            of=partial(speed, snr),
            never=f"no exposure is enough: a channel saturates before SNR {snr}",
        )
        for snr, quality in _SPEEDS
    )


def _adapted_light(operating_point: OperatingPoint, maker: MatrixFunction) -> float | None:
    return illuminance_for_snr_adapted(
        operating_point.sensor,
        operating_point.illuminant,
        operating_point.exposure,
        lambda lux: maker(replace(operating_point, level_lux=lux)),
        reflectance=GRAY,
    )


def _adapts(operating_point: OperatingPoint, maker: MatrixFunction) -> bool:
    brighter = replace(operating_point, level_lux=2.0 * operating_point.level_lux)
    here, there = maker(operating_point).matrix, maker(brighter).matrix
    return bool(np.abs(there - here).max() > _SAME_MATRIX * np.abs(here).max())


# levels that a pixel distinguishes


def level_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """From black to the white of this exposure, or to the white level if that is lower."""
    sensor, exposure, white_e = analysis.sensor, analysis.exposure, electrons_at(analysis.point)
    top_e = np.clip(white_e, 0.0, max(signal_limit_e(sensor, exposure), 0.0))
    dark = with_noise(np.zeros_like(white_e), sensor, exposure, kind="temporal", linear=True)
    dark_noise_e, shot = np.sqrt(dark.variance), _shot_noise_per_electron(sensor, white_e)
    step_e = code_step_e(sensor.converter, sensor.pixel)

    def of_channel(i: int) -> float:
        # the levels of a reading are those of the counts that have as much shot noise
        counted_e, noise_e = np.asarray(top_e[i] / shot[i]), float(dark_noise_e[i] / shot[i])
        step = float(step_e / shot[i])
        return float(tonal_range_bits(counted_e, read_noise_e=noise_e, step_e=step))

    ranges = (
        merit_or_reason(
            f"tonal_range_{channel}",
            f"tonal range of {channel}, black to white",
            "bit",
            "DxOMark, per pixel",
            of=partial(of_channel, i),
        )
        for i, channel in enumerate(analysis.sensor.names)
    )
    sensitivity = merit_or_reason(
        "color_sensitivity",
        "color sensitivity, black to white",
        "bit",
        "DxOMark, per pixel",
        of=lambda: _color_sensitivity(sensor, top_e, float(dark_noise_e[0])),
        never="crosstalk after counting correlates the channels",
    )
    return (*ranges, sensitivity)


def _shot_noise_per_electron(sensor: Sensor, white_e: Float[Array, " p"]) -> Float[Array, " p"]:
    """Variance of the light's shot noise over the mean reading; 1 for counts. [e-]"""
    coupling = after_counting(sensor.crosstalk)
    if coupling is None or sensor.crosstalk is None:
        return np.ones_like(white_e)
    shot = sensor.crosstalk.squares @ counted_electrons(white_e, coupling)
    return np.where(white_e > 0, shot / np.where(white_e > 0, white_e, 1.0), 1.0)


def _color_sensitivity(
    sensor: Sensor, top_e: Float[Array, " p"], dark_noise_e: float
) -> float | None:
    """The sum of tonal ranges, which holds for independent channels only."""
    if after_counting(sensor.crosstalk) is not None:
        return None
    step_e = code_step_e(sensor.converter, sensor.pixel)
    return float(color_sensitivity_bits(top_e, read_noise_e=dark_noise_e, step_e=step_e))


# visual noise of a gray, from the closed-form noise power spectrum


def visual_merits(analysis: Analysis, viewing: Viewing) -> tuple[Merit, ...]:
    """Visual noise with every channel in each pixel, and through bilinear demosaicing.

    Demosaicing needs pixels with independent noise, without crosstalk after counting.
    """
    card = f"visual noise of {100 * GRAY:.0f} % gray"
    return (
        merit_or_reason(
            "visual_noise",
            f"{card}, all channels in each pixel",
            "CIELUV",
            ISO_15739_2017.edition,
            of=lambda: _pixel_noise(analysis, viewing),
        ),
        merit_or_reason(
            "visual_noise_bilinear",
            f"{card}, bilinear demosaicing",
            "CIELUV",
            ISO_15739_2017.edition,
            of=lambda: _mosaic_noise(analysis, viewing),
            never=f"{analysis.sensor.name} has no mosaic to interpolate",
        ),
    )


def _pixel_noise(analysis: Analysis, viewing: Viewing) -> float:
    refuse_full(analysis)
    white_color(analysis)
    sensor, exposure, matrix = analysis.sensor, analysis.exposure, analysis.matrix.matrix
    return float(noise_as_viewed(electrons_at(analysis.point), sensor, exposure, matrix, viewing))


def _mosaic_noise(analysis: Analysis, viewing: Viewing) -> float | None:
    sensor = analysis.sensor
    if sensor.mosaic is None:
        return None
    refuse_full(analysis)
    to_xyz = analysis.matrix.matrix / white_color(analysis)[:, None]
    to_luv = LUV.jacobian(np.full(3, GRAY), np.ones(3))
    bank, spectrum = bilinear_filters(sensor.mosaic, sensor.names), _plane_spectrum
    gray_e = GRAY * electrons_at(analysis.point)
    raw = flat_field_noise(spectrum, bank, gray_e, sensor, analysis.exposure)
    return visual_noise_from_spectrum(
        to_xyz @ raw @ to_xyz.T,
        to_luv,
        pixels_per_degree=viewing.pixels_per_degree,
    ).total


def _plane_spectrum(bank: FilterBank, variance_e2: Array) -> Float[Array, "h w p p"]:
    return noise_power_spectrum(bank, variance_e2, (PLANE, PLANE))


# the matrix


def matrix_merits(analysis: Analysis) -> tuple[Merit, ...]:
    """Noise gain and condition of the white-balanced matrix."""

    def report() -> MatrixReport:
        return matrix_report(
            analysis.matrix,
            analysis.sensor,
            analysis.exposure,
            analysis.scene.illuminant,
            level_lux=analysis.scene.level_lux,
        )

    return (
        merit_or_reason(
            "psi", "noise gain Psi", "1", "Kodak, US 5,609,978", of=lambda: report().psi
        ),
        merit_or_reason(
            "condition",
            "condition of the white-balanced matrix",
            "1",
            "singular values",
            of=lambda: report().condition,
            never="the matrix does not have full rank: a coordinate is a mix of others",
        ),
    )


@with_short_repr
@dataclass(frozen=True, kw_only=True)
class Merits:
    """All figures of merit of a sensor in a light and with an exposure.

    Attributes
    ----------
    level_lux, time_s
        The exposure. [lx], [s]
    matrix
        Name of the color matrix.
    metric
        Metric of the space of spectra.
    observer
        Of the filters and of color; the SMI is that of CIE 1931 by its standard.
    viewing
        Of the visual noise.
    entries
        The figures, in the order of tables and JSON.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("matrix", "metric", "observer"),
        JsonKey(
            "viewing",
            keys=(*keys_of(Viewing), "pixels_per_degree"),
        ),
        JsonKey(
            "values",
            "by_name",
            keys=(
                "value",
                "unit",
                "what",
                "source",
                JsonKey("missing", lambda e: e.missing or None, text="Why there is no value."),
            ),
        ),
    )

    sensor: str
    illuminant: str
    matrix: str
    level_lux: float
    time_s: float
    metric: str
    observer: str
    viewing: Viewing
    entries: tuple[Merit, ...]

    @property
    def by_name(self) -> Mapping[str, Merit]:
        """The figures by their names."""
        return {entry.name: entry for entry in self.entries}

    def __post_init__(self) -> None:
        check.distinct(f"merits of {self.sensor}", [entry.name for entry in self.entries])


def merits_of(
    analysis: Analysis, *, maker: MatrixFunction | None = None, viewing: Viewing | None = None
) -> Merits:
    """Every figure of merit of an analysis: its sensor, exposure, lamp and matrix.

    A figure that is not defined (a channel is saturated on the white, a color of the lamp is zero,
    the mosaic is not known) has the reason in place of a value. Noise is unclipped.

    Parameters
    ----------
    analysis
        Its scene gives lamp and illuminance; its reflectance does not matter.
    maker
        Makes the matrix of ``analysis``; where that changes with the light, SNR10 is given for
        the adapting matrix as well. ``None`` for a matrix that stays.
    viewing
        Of the visual noise; ``None`` for pixels of 0.25 mm from 600 mm.

    Notes
    -----
    The source of each figure stands beside it. Those of the filters depend on the metric.

    Examples
    --------
    One channel whose white just fills 10,000 electrons, 10 e- of readout: 181 levels (DxOMark).

    >>> from chromanoise.noise import saturating_exposure
    >>> from chromanoise.spectra import flat_field
    >>> from chromanoise.study import sensor_named
    >>> from chromanoise.spectra import DEFAULT_GRID, equal_energy
    >>> from chromanoise.study import analyzed
    >>> white = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
    >>> mono = sensor_named("model-mono", DEFAULT_GRID)
    >>> filled = saturating_exposure(white, mono, share=1.0)
    >>> entries = merits_of(analyzed(white, mono, filled)).entries
    >>> bits = {entry.name: entry.value for entry in entries}["tonal_range_W"]
    >>> round(2**bits, 3)
    180.998
    """
    viewed = viewing or USUAL_VIEWING
    return Merits(
        sensor=analysis.sensor.label,
        illuminant=analysis.scene.illuminant.name,
        matrix=analysis.matrix.made_by,
        level_lux=analysis.scene.level_lux,
        time_s=analysis.exposure.time_s,
        metric=analysis.matrix.metric,
        observer=analysis.matrix.observer,
        viewing=viewed,
        entries=(
            *filter_merits(analysis),
            *metamerism_merits(analysis),
            *chart_merits(analysis),
            *speed_merits(analysis, maker),
            *level_merits(analysis),
            *visual_merits(analysis, viewed),
            *matrix_merits(analysis),
        ),
    )
