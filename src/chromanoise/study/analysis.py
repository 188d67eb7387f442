"""Closed-form analysis of a sensor: electrons, measurements, SNR and conditioning at each stage.

All computations of SNR use this module: the analysis of one patch, sweeps over the light level and
the patches of a chart.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from chromanoise.base import (
    Array,
    Bool,
    Float,
    InputError,
    check,
    dataclass,
    decibel,
    defined,
    kept,
    notebook,
    with_short_repr,
)
from chromanoise.color import (
    UNBOUNDED,
    ColorMatrix,
    ElectronSource,
    NoisyColor,
    colored,
    kernel_matrix,
    scene_xyz,
)
from chromanoise.geometry import (
    NearestMix,
    angles_between_deg,
    angles_to_axes_deg,
    contravariant,
    nearest_mix,
    spectral_snr,
    variance_inflation,
)
from chromanoise.io import number_text
from chromanoise.metrics import (
    LEAST_COLOR,
    chart_color_error,
    color_snr_loss_db,
    optimal_linear_snr_db,
    signal_snr_db,
    snr_db,
)
from chromanoise.noise import (
    Exposure,
    Measurement,
    Moments,
    OperatingPoint,
    Readout,
    after_counting,
    code_count,
    conditions,
    counted_electrons,
    demand_independent_channels,
    expected_electrons,
    noise_sources,
    one_code,
    raw_measurement,
    saturated,
    sensor_moments,
    white_scene,
    with_noise,
)
from chromanoise.sensor import Sensor, code_range_e, code_step_e, white_level_name
from chromanoise.spectra import (
    DEFAULT_OBSERVER,
    Metric,
    PatchPairs,
    Scene,
    Spectra,
    chart_title,
    color_axes,
    observer_notes,
)


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Stages:
    """Measurements at every stage; the leading axes are light levels, then patches.

    Attributes
    ----------
    point, matrix
        Sensor, exposure and light; the color matrix.
    scene
        The patches; the level of the scene is 1 lx where ``level_lux`` is given.
    level_lux
        Illuminances of the leading axis; ``None`` for the one level of ``point``. [lx]
    readout
        Clipping and rounding of the values; ``None`` for none.
    expected_e
        Expected electrons per channel, before clipping. [e-]
    raw
        The electrons after readout, with covariance.
    clipping
        Exact moments of the readout; ``None`` without one.
    lux_per_e
        One matrix per level, used in place of ``matrix``; ``None`` to use ``matrix``. [lx/e-]
    """

    point: OperatingPoint
    matrix: ColorMatrix
    scene: Scene
    level_lux: Float[Array, " k"] | None
    readout: Readout | None
    expected_e: Float[Array, "*px p"]
    raw: Measurement
    clipping: Moments | None
    lux_per_e: Float[Array, "k c p"] | None

    def __post_init__(self) -> None:
        check.freeze(self, "expected_e")

    @property
    def saturated(self) -> Bool[Array, "*px p"]:
        """True where the expected electrons of a channel exceed the white level."""
        return saturated(self.expected_e, self.point.sensor, self.point.exposure)

    @property
    def one_code(self) -> Bool[Array, "*px p"]:
        """True where practically every reading of a channel is the same code of the converter."""
        return one_code(self.expected_e, self.point.sensor, self.point.exposure)

    @cached_property
    def without_snr(self) -> Bool[Array, "*px"]:
        """True where no SNR of a color is defined: a channel is saturated, or gives one code."""
        return check.frozen((self.saturated | self.one_code).any(axis=-1))

    @cached_property
    def temporal_raw(self) -> Measurement:
        """The electrons after readout without fixed-pattern noise (DSNU, PRNU, crosstalk)."""
        sensor, exposure = self.point.sensor, self.point.exposure
        noise = noise_sources(sensor, exposure)
        if not noise.has_fixed_pattern:
            return self.raw
        if self.readout is None:
            return with_noise(self.expected_e, sensor, exposure, kind="temporal")
        moments = sensor_moments(self.expected_e, noise.temporal, self.readout)
        return raw_measurement(moments, sensor.names)

    @cached_property
    def truth_xyz(self) -> Float[Array, "*px 3"]:
        """X, Y, Z for the observer of the matrix. [lx]"""
        truth = scene_xyz(self.scene, self.matrix.metric, self.matrix.observer)
        return check.frozen(_at_levels(truth, self.level_lux))

    @cached_property
    def contravariant(self) -> Measurement:
        """Contravariant coordinates (eq. 3)."""
        return contravariant(self.raw, self.matrix.frame)

    @cached_property
    def color(self) -> Measurement:
        """Color coordinates with covariance (eq. 5). [lx]"""
        if self.lux_per_e is None:
            return colored(self.raw, self.matrix)
        check.same_names("color", raw=self.raw.names, matrix=self.matrix.channels)
        patches = (1,) * (self.scene.reflectance.ndim - 1)
        levels, *size = self.lux_per_e.shape
        each = self.lux_per_e.reshape(levels, *patches, *size)
        return Measurement(
            mean=(each @ self.raw.mean[..., None])[..., 0],
            covariance=each @ self.raw.covariance @ np.swapaxes(each, -1, -2),
            names=self.matrix.coordinates,
            kind="".join(self.matrix.coordinates),
            unit="lx",
            metric=self.matrix.metric,
        )

    @property
    def color_snr_db(self) -> Float[Array, "*px c"]:
        """SNR of each color coordinate; NaN where it is undefined or has no signal. [dB]"""
        full = self.without_snr[..., None]
        if full.all():
            return np.full((*full.shape[:-1], len(self.matrix.coordinates)), np.nan)
        return np.where(full, np.nan, signal_snr_db(self.color, self.truth_xyz))

    @property
    def optimal_linear_snr_db(self) -> Float[Array, "*px"]:
        """SNR of the best linear readout; NaN where it is undefined. [dB]"""
        full = self.without_snr
        if full.all():
            return np.full(full.shape, np.nan)
        return np.where(full, np.nan, optimal_linear_snr_db(self.raw))


def electrons_at(
    point: OperatingPoint,
    *,
    level_lux: Float[Array, " k"] | None = None,
    reflectance: float | Float[Array, "*patches n"] = 1.0,
) -> Float[Array, "*px p"]:
    """Expected electrons of patches at many light levels, with a fixed exposure (eq. 2). [e-]

    Parameters
    ----------
    point
        Sensor, exposure and light.
    level_lux
        Illuminances, >= 0: the first axis of the result. ``None`` for the level of ``point``,
        without that axis. [lx]
    reflectance
        One number for all wavelengths, or values on the grid of the light (last axis), preceded by
        any axes of patches.

    Raises
    ------
    InputError
        If a level or a reflectance is negative, or light and sensor are not on one grid.
    """
    if level_lux is None and isinstance(reflectance, float) and reflectance == 1.0:
        return _white_electrons(point).copy()
    scene = _scene(point, level_lux, reflectance)
    return _at_levels(expected_electrons(scene, point.sensor, point.exposure), level_lux)


@kept
def _white_electrons(point: OperatingPoint) -> Float[Array, " p"]:
    scene = white_scene(point)
    return expected_electrons(scene, point.sensor, point.exposure)


def stages_at(
    point: OperatingPoint,
    matrix: ColorMatrix,
    *,
    level_lux: Float[Array, " k"] | None = None,
    reflectance: float | Float[Array, "*patches n"] = 1.0,
    readout: Readout | None = None,
    lux_per_e: Float[Array, "k c p"] | None = None,
) -> Stages:
    """Compute every stage at an operating point: electrons, raw, contravariant, color coordinates.

    Parameters
    ----------
    point
        Sensor, exposure and light.
    level_lux, reflectance
        As `electrons_at`.
    readout
        Clipping and rounding, with exact moments; ``None`` for eq. 7, unclipped.
    lux_per_e
        One matrix per level, used in place of ``matrix``. [lx/e-]

    Raises
    ------
    InputError
        As `electrons_at`, if there is not one matrix per level, or if a readout is given and
        crosstalk after counting correlates the channels.
    """
    levels = None if level_lux is None else check.non_negative("level_lux", "lx", level_lux)
    if lux_per_e is not None:
        count = 0 if levels is None else levels.size
        check.same_length("levels", level_lux=count, lux_per_e=len(lux_per_e))
    scene = _scene(point, levels, reflectance)
    expected = _at_levels(expected_electrons(scene, point.sensor, point.exposure), levels)
    clipping = None
    if readout is not None:
        demand_independent_channels(point.sensor)
        noise = noise_sources(point.sensor, point.exposure)
        clipping = sensor_moments(expected, noise, readout)
    return Stages(
        point=point,
        matrix=matrix,
        scene=scene,
        level_lux=levels,
        readout=readout,
        expected_e=expected,
        raw=raw_measurement(clipping, point.sensor.names)
        if clipping
        else with_noise(expected, point.sensor, point.exposure),
        clipping=clipping,
        lux_per_e=lux_per_e,
    )


def noisy_color_at(stages: Stages, white: Float[Array, " 3"]) -> NoisyColor:
    """The colors of the patches with their electron counts, for `chromanoise.color.propagate`.

    Its exact method needs independent channels (`demand_independent_channels`).

    Parameters
    ----------
    stages
        Stages with one matrix for all levels.
    white
        XYZ of a perfect white, measured by the sensor. [lx]
    """
    source = ElectronSource(
        mean_e=stages.expected_e,
        matrix=stages.matrix.matrix,
        noise=noise_sources(stages.point.sensor, stages.point.exposure),
        readout=stages.readout or UNBOUNDED,
    )
    return NoisyColor(xyz=_with_black_error(stages), white=white, source=source)


def _with_black_error(stages: Stages) -> Measurement:
    """The color as it is read: an error of the black level adds to its mean, not to its signal."""
    black_e = stages.point.sensor.pixel.black_error_e
    if not black_e or stages.clipping is not None:  # the moments of the readout include it
        return stages.color
    shift = black_e * stages.matrix.matrix.sum(axis=1)
    return replace(stages.color, mean=stages.color.mean + shift)


def _scene(
    point: OperatingPoint,
    level_lux: Float[Array, " k"] | None,
    reflectance: float | Float[Array, "*patches n"],
) -> Scene:
    rho = np.asarray(reflectance, dtype=np.float64)
    flat = np.full(point.illuminant.grid.n, rho) if rho.ndim == 0 else rho
    return Scene(
        illuminant=point.illuminant,
        level_lux=point.level_lux if level_lux is None else 1.0,
        reflectance=flat,
    )


def _at_levels(
    of_one_lux: Float[Array, "*patches p"], level_lux: Float[Array, " k"] | None
) -> Float[Array, "*px p"]:
    """Electrons and colors are proportional to the light."""
    if level_lux is None:
        return of_one_lux
    return np.multiply.outer(level_lux, of_one_lux)


_WORTH_TELLING = 1e-3  # share of clipped readouts
_WORTH_NAMING = 0.005  # weight of a channel in a mix
_NEAR_MIX_DEG = 10.0  # a channel closer than this to the span of the others gets a note


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Analysis:
    """Results of one sensor at one exposure, at every stage.

    Attributes
    ----------
    scene, sensor, exposure
        The patch, the sensor that measures it, and its exposure settings.
    readout
        Clipping and rounding of the values; ``None`` for eq. 7, unclipped.
    raw, contravariant, color
        The measurement at each stage, with the covariance of the total noise, i.e. of single
        readings over a flat field.
    temporal_raw
        The raw measurement without fixed-pattern noise (DSNU, PRNU, the pattern of crosstalk), as
        from frame to frame.
    matrix
        The color matrix, by default the kernel matrix; it holds metric, frame and observer.
    saturated
        One per channel. Where it is true, every SNR that uses the channel is undefined.
    one_code
        One per channel. Where it is true, practically every reading of the channel is the same
        code, and every SNR that uses the channel is undefined.
    expected_e
        Expected electrons per channel, before clipping. [e-]
    truth_xyz
        X, Y, Z of the scene for the observer of the matrix. [lx]
    black_share, full_share
        Share of the readouts of each channel that are clipped at black and at full well; 0 without
        clipping.
    vif
        Variance inflation factor per channel; inf for a linear combination of other channels.
    between_deg, to_axes_deg
        Angles between channels, and to the color axes x, y, z. [deg]
    mix
        The channel that is closest to a linear combination of the others.
    spectral_snr_db
        SNR of the reconstructed spectrum (eq. 4); ``None`` where a channel is saturated. [dB]
    optimal_linear_snr_db
        Best SNR of any linear readout; ``None`` where a channel is saturated. [dB]
    color_snr_loss_db
        The best linear SNR minus that of Y; ``None`` where Y has no SNR. [dB]
    chart, patch, pairs
        Those of the operating point: reflectances for color errors, the analyzed one, and pairs to
        tell apart; ``None`` for the ColorChecker, for the reflectance of ``scene``, and for all
        pairs of the chart.
    """

    scene: Scene
    sensor: Sensor
    exposure: Exposure
    readout: Readout | None
    raw: Measurement
    contravariant: Measurement
    color: Measurement
    temporal_raw: Measurement
    matrix: ColorMatrix
    saturated: Bool[Array, " p"]
    one_code: Bool[Array, " p"]
    expected_e: Float[Array, " p"]
    truth_xyz: Float[Array, " 3"]
    black_share: Float[Array, " p"]
    full_share: Float[Array, " p"]
    vif: Float[Array, " p"]
    between_deg: Float[Array, "p p"]
    to_axes_deg: Float[Array, "p 3"]
    mix: NearestMix | None
    spectral_snr_db: float | None
    optimal_linear_snr_db: float | None
    color_snr_loss_db: float | None
    chart: Spectra | None = None
    patch: Spectra | None = None
    pairs: PatchPairs | None = None

    @cached_property
    def without_snr(self) -> Bool[Array, " p"]:
        """Channels whose SNR is undefined: saturated, or with one code."""
        return np.asarray(self.saturated | self.one_code)

    @cached_property
    def point(self) -> OperatingPoint:
        """Sensor, exposure, lamp and illuminance, without the patch."""
        return OperatingPoint(
            sensor=self.sensor,
            exposure=self.exposure,
            illuminant=self.scene.illuminant,
            level_lux=self.scene.level_lux,
            observer=self.matrix.observer,
            chart=self.chart,
            patch=self.patch,
            pairs=self.pairs,
        )

    def __post_init__(self) -> None:
        check.freeze(self, "one_code")
        check.freeze(self, "saturated", "expected_e", "truth_xyz", "black_share", "full_share")
        check.freeze(self, "vif", "between_deg", "to_axes_deg")

    def _repr_html_(self) -> str:
        raw, spectral, color = (
            ratio(self) for ratio in (raw_snr_db, contravariant_snr_db, color_snr_db)
        )
        rows = [[f"channel {n}", _db(raw[n]), _db(spectral[n]), ""] for n in raw]
        rows += [[n, "", "", _db(value)] for n, value in color.items()]
        return notebook.shown(
            f"{self.sensor.label} at {conditions([self.point])}",
            notebook.table(
                ["SNR [dB]", "raw", f"contravariant, metric {self.matrix.metric}", "color"], rows
            ),
            notes=diagnosis(self),
        )


def analyzed(
    scene: Scene,
    sensor: Sensor,
    exposure: Exposure,
    metric: Metric = "quanta",
    *,
    readout: Readout | None = None,
    matrix: ColorMatrix | None = None,
    observer: str = DEFAULT_OBSERVER,
) -> Analysis:
    """Compute every stage of the measurement of one flat patch: eq. 1 to 7.

    Parameters
    ----------
    scene
        A scene of one point (`flat_field`).
    sensor, exposure
        The sensor and its exposure settings.
    metric
        Metric of the space of spectra.
    readout
        Clipping and rounding, with exact moments; ``None`` for eq. 7, unclipped.
    matrix
        Color matrix; ``None`` for the kernel matrix (eq. 6) in ``metric`` and for ``observer``.
    observer
        A name from `chromanoise.spectra.OBSERVERS`; unused where a matrix is given, which has one.

    Raises
    ------
    InputError
        If the scene is more than one point or on another grid than the sensor, the matrix is for
        other channels, or there is no observer of that name.
    """
    if scene.reflectance.ndim != 1:
        raise InputError(
            "scene",
            "must be one point",
            value=scene.reflectance.shape,
            found=f"has reflectances of shape {scene.reflectance.shape}",
            remedy="analyze one at a time",
        )
    matrix = kernel_matrix(sensor, exposure, metric, observer) if matrix is None else matrix
    point = OperatingPoint(
        sensor=sensor,
        exposure=exposure,
        illuminant=scene.illuminant,
        level_lux=scene.level_lux,
        observer=matrix.observer,
    )
    axes = color_axes(sensor.grid, matrix.metric, matrix.observer)
    at = stages_at(point, matrix, reflectance=scene.reflectance, readout=readout)
    raw, color, frame, clipping = at.raw, at.color, matrix.frame, at.clipping
    none = np.zeros(at.expected_e.shape)
    return Analysis(
        scene=scene,
        sensor=sensor,
        exposure=exposure,
        readout=readout,
        raw=raw,
        contravariant=at.contravariant,
        color=color,
        temporal_raw=at.temporal_raw,
        matrix=matrix,
        saturated=at.saturated,
        one_code=at.one_code,
        expected_e=at.expected_e,
        truth_xyz=at.truth_xyz,
        black_share=clipping.black_share if clipping else none,
        full_share=clipping.full_share if clipping else none,
        vif=variance_inflation(frame),
        between_deg=angles_between_deg(frame),
        to_axes_deg=angles_to_axes_deg(frame, axes),
        mix=nearest_mix(frame),
        spectral_snr_db=_spectral_snr_db(at),
        optimal_linear_snr_db=defined(float(at.optimal_linear_snr_db)),
        color_snr_loss_db=_color_snr_loss_db(at, color),
    )


def of_white(analysis: Analysis) -> Analysis:
    """The analysis of a perfect white at the same point; the analysis itself without a patch."""
    return analysis if analysis.patch is None else _of_white(analysis)


@kept  # every output of the chart uses it
def _of_white(analysis: Analysis) -> Analysis:
    white = analyzed(
        white_scene(analysis.point),
        analysis.sensor,
        analysis.exposure,
        readout=analysis.readout,
        matrix=analysis.matrix,
    )
    return replace(white, chart=analysis.chart, pairs=analysis.pairs)


def _spectral_snr_db(at: Stages) -> float | None:
    if at.without_snr.any():
        return None
    return defined(float(decibel(spectral_snr(at.raw, at.matrix.frame))))


def _color_snr_loss_db(at: Stages, color: Measurement) -> float | None:
    luminance_db = at.color_snr_db[at.matrix.coordinates.index("Y")]
    return float(color_snr_loss_db(at.raw, color)) if np.isfinite(luminance_db) else None


def _db(value: float | None) -> str:
    return number_text(value, ".1f", "none")


@kept
def mean_color_error(analysis: Analysis) -> float | None:
    """Mean CIE 1976 difference over the chart, without noise. [Delta E*ab]

    ``None`` where X, Y or Z of the sensor's white is not above 0, so that CIELAB is undefined.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    error = chart_color_error(
        analysis.sensor,
        analysis.matrix,
        analysis.exposure,
        analysis.scene.illuminant,
        analysis.chart,
    )
    return None if error is None else float(error.mean())


def metric_of(analyses: Iterable[Analysis]) -> str:
    """The metric in which contravariant and spectral SNR, VIF and angles are given, in words."""
    found = dict.fromkeys(one.matrix.metric for one in analyses)
    return f"metric{'s' if len(found) > 1 else ''} {', '.join(found)}"


def mix_sentence(mix: NearestMix) -> str:
    """The linear combination that the channel is closest to, its angle to it, and the metric."""
    heavy = [item for item in mix.weights.items() if abs(item[1]) >= _WORTH_NAMING]
    parts = " ".join(f"{weight:+.2f} {name}" for name, weight in heavy or mix.weights.items())
    return (
        f"{mix.channel} is {mix.angle_deg:.2g} deg from {parts.removeprefix('+')} in the metric "
        f"{mix.metric}"
    )


def raw_snr_db(analysis: Analysis) -> dict[str, float | None]:
    """Raw SNR per channel; ``None`` where the channel is saturated or has no signal. [dB]

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return _raw_snr_db(analysis, analysis.raw)


def temporal_raw_snr_db(analysis: Analysis) -> dict[str, float | None]:
    """As `raw_snr_db`, without fixed-pattern noise (DSNU, PRNU, crosstalk). [dB]"""
    return _raw_snr_db(analysis, analysis.temporal_raw)


def _raw_snr_db(analysis: Analysis, raw: Measurement) -> dict[str, float | None]:
    hidden = dict(zip(analysis.sensor.names, analysis.without_snr.tolist(), strict=True))
    return _unless_hidden(snr_db(raw), hidden)


def temporal_color_snr_db(analysis: Analysis) -> dict[str, float | None]:
    """As `color_snr_db`, without fixed-pattern noise (DSNU, PRNU, crosstalk). [dB]"""
    if analysis.temporal_raw is analysis.raw:
        return color_snr_db(analysis)
    return _color_ratios(analysis, colored(analysis.temporal_raw, analysis.matrix))


def contravariant_snr_db(analysis: Analysis) -> dict[str, float | None]:
    """Contravariant SNR per channel; ``None`` where it is undefined. [dB]

    Every coordinate is computed from all channels, so one saturated channel makes all of them
    undefined. The coordinate of a channel that is a linear combination of others is undefined too.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    lost = bool(analysis.without_snr.any())
    hidden = {
        name: lost or not math.isfinite(vif)
        for name, vif in zip(analysis.sensor.names, analysis.vif, strict=True)
    }
    return _unless_hidden(snr_db(analysis.contravariant), hidden)


def color_snr_db(analysis: Analysis) -> dict[str, float | None]:
    """SNR of X, Y and Z; ``None`` where a channel is saturated or there is no signal. [dB]

    A coordinate that is negative, or far smaller than for the observer, is not a signal:
    it is an error of a color matrix that does not fit this light.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return dict(_color_snr_db(analysis))


@kept  # called for every check of a white
def _color_snr_db(analysis: Analysis) -> Mapping[str, float | None]:
    return _color_ratios(analysis, analysis.color)


def _color_ratios(analysis: Analysis, color: Measurement) -> dict[str, float | None]:
    decibels = signal_snr_db(color, analysis.truth_xyz)
    found = {name: np.asarray(decibels[i]) for i, name in enumerate(color.names)}
    return _unless_hidden(found, dict.fromkeys(found, bool(analysis.without_snr.any())))


def diagnosis(analysis: Analysis) -> tuple[str, ...]:
    """Warnings about these results: saturation, clipping, channels without signal.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return (
        *input_notes(analysis.point, analysis.matrix),
        *_channel_notes(analysis),
        *_crosstalk_notes(analysis),
        *_converter_notes(analysis),
        *_color_notes(analysis),
        *_frame_notes(analysis),
    )


def input_notes(
    operating_point: OperatingPoint, matrix: ColorMatrix | None = None
) -> tuple[str, ...]:
    """Notes on what a result is computed from: curves, light, observer, reflectances, matrix.

    Parameters
    ----------
    matrix
        The color matrix of the sensor; ``None`` where there are several.
    """
    of_matrix = () if matrix is None else matrix.notes
    observer = operating_point.observer if matrix is None else matrix.observer
    return (
        *operating_point.sensor.notes,
        *operating_point.illuminant.notes,
        *observer_notes(observer),
        *reflectance_notes(operating_point),
        *of_matrix,
    )


def reflectance_notes(operating_point: OperatingPoint) -> tuple[str, ...]:
    """What replaces the ColorChecker and the perfect white, with the notes on their curves."""
    notes: list[str] = []
    if operating_point.patch is not None:
        own = "; ".join(
            (
                f"{operating_point.patch_name} instead of a perfect white",
                *operating_point.patch.notes,
            )
        )
        notes.append(own)
    if operating_point.chart is not None:
        chart = operating_point.chart
        head = f"chart: {len(chart.names)} reflectances of {chart_title(chart)}"
        notes.append("; ".join((head, *chart.notes)))
    return tuple(notes)


def _channel_notes(analysis: Analysis) -> list[str]:
    sensor, notes = analysis.sensor, []
    dark_e = sensor.pixel.dark_electrons_e(time_s=analysis.exposure.time_s)
    limit = white_level_name(sensor, dark_e=dark_e)
    limit_e = code_range_e(sensor) if limit == "top code" else sensor.pixel.full_well_e
    dark = f" and {dark_e:.0f} e- of dark current" if dark_e else ""
    for i, name in enumerate(sensor.names):
        expected, full, black = (
            float(of[i]) for of in (analysis.expected_e, analysis.full_share, analysis.black_share)
        )
        if analysis.saturated[i]:
            notes.append(
                f"channel {name} is saturated: it reaches {expected:.0f} e-{dark}, {limit} is "
                f"{limit_e:.0f} e-; shorten the time or close the aperture"
            )
        elif full > _WORTH_TELLING:
            notes.append(
                f"{100 * full:.1f} % of {name} is clipped at {limit}; clipping reduces the "
                "noise, so raw and color SNR are too high"
            )
        if black > _WORTH_TELLING:
            bias_e = noise_sources(sensor, analysis.exposure).rounded(analysis.expected_e)[0]
            notes.append(
                f"{100 * black:.1f} % of {name} is clipped at black, which raises its mean from "
                f"{expected + bias_e[i]:.3g} to {analysis.raw.mean[i]:.3g} e-; the offset counts "
                "as signal, so raw SNR, bound and color SNR are too high"
            )
        if expected == 0:
            notes.append(f"channel {name} sees none of this light")
    return notes


def _crosstalk_notes(analysis: Analysis) -> list[str]:
    """Notes on the fixed pattern of crosstalk, and on the smaller noise of a pixel of a mosaic."""
    crosstalk, raw = analysis.sensor.crosstalk, analysis.raw
    if crosstalk is None or (crosstalk.deviations is None and raw.reading_variance is None):
        return []
    notes, noise = [], noise_sources(analysis.sensor, analysis.exposure)
    if crosstalk.deviations is not None and noise.pattern is None:
        notes.append(
            "crosstalk makes a fixed pattern, because pixels of one channel have different "
            "neighbors; the noise does not include the pattern, because the crosstalk matrix "
            "cannot be inverted"
        )
    counted = counted_electrons(analysis.expected_e, after_counting(crosstalk))
    pattern = np.sqrt(noise.pattern_e2(counted))
    for name, mean, sd in zip(raw.names, analysis.expected_e, pattern, strict=True):
        if sd > _WORTH_TELLING * mean:
            notes.append(
                f"pixels of {name} have different neighbors: crosstalk makes a fixed pattern of "
                f"{100 * sd / mean:.2g} % of the mean signal, which is part of the total noise, "
                "not of the temporal noise"
            )
    if raw.reading_variance is not None:
        every = np.diagonal(raw.covariance)
        less = 1 - raw.reading_variance / np.where(every > 0, every, 1.0)
        most = int(np.argmax(less))
        if less[most] > _WORTH_TELLING:
            notes.append(
                "raw SNR is that of one pixel of the mosaic, color SNR that of a pixel with all "
                "channels: crosstalk after counting averages the noise of neighbors, so one pixel "
                f"of {raw.names[most]} in the mosaic has {100 * less[most]:.2g} % less noise "
                "variance than a pixel with all channels"
            )
    return notes


def _converter_notes(analysis: Analysis) -> list[str]:
    """Notes on channels whose noise is below the step of the converter, and on their rounding."""
    sensor, mean = analysis.sensor, analysis.expected_e
    noise = noise_sources(sensor, analysis.exposure)
    step_e = code_step_e(sensor.converter, sensor.pixel)
    if not step_e:
        return []
    unrounded = replace(noise, step_e=0.0)
    sd_e = np.sqrt(unrounded.variance_e2(mean) / noise.readings)
    low = (sd_e < step_e) & (mean > 0) & ~analysis.saturated
    if not low.any():
        return []
    names = [name for name, one in zip(sensor.names, low, strict=True) if one]
    noisy = f"{_range(sd_e[low])} e- of {', '.join(names)}"
    head = f"the step of {step_e:.3g} e- exceeds the noise of {noisy}: "
    remedy = "take more bits or a higher gain"
    if after_counting(sensor.crosstalk) is not None:
        return [
            f"{head}rounding may bias the readings, but this bias is not computed, because "
            "crosstalk after counting correlates the readings; the variance of rounding is "
            f"taken as step^2 / 12; {remedy}"
        ]
    notes, stuck = (
        [],
        [name for name, one in zip(sensor.names, analysis.one_code & low, strict=True) if one],
    )
    if stuck:
        notes.append(
            f"{head}practically every reading of {', '.join(stuck)} is the same code, so the SNR "
            f"of {', '.join(stuck)} and of every color is undefined; {remedy}"
        )
    rest = low & ~analysis.one_code
    if rest.any():
        alone = replace(noise, pattern=None)
        codes = [code_count(float(m), alone) for m, one in zip(mean, rest, strict=True) if one]
        bias = (noise.rounded(mean)[0] / np.where(mean > 0, mean, 1.0))[rest]
        notes.append(
            f"{'' if stuck else head}99.9 % of the readings of "
            f"{', '.join(n for n, one in zip(sensor.names, rest, strict=True) if one)} have "
            f"{_range(np.array(codes))} different codes; mean and noise are computed with "
            f"rounding, which changes the mean by {_range(100 * bias)} %; {remedy}"
        )
    return notes


def _range(values: Array) -> str:
    """The least and the largest value as text, or one value if both have the same digits."""
    least, most = f"{values.min():.3g}", f"{values.max():.3g}"
    return least if least == most else f"{least} to {most}"


def _color_notes(analysis: Analysis) -> list[str]:
    if analysis.without_snr.any():
        return []
    white = bool((analysis.scene.reflectance == 1).all())
    patch = "a perfect white" if white else "this patch"
    found = color_snr_db(analysis)
    return [
        f"{name} of {patch} is {mean:.3g} lx instead of {truth:.3g}: the matrix gives no valid "
        f"{name} under this light, so its SNR is undefined"
        for name, mean, truth in zip(found, analysis.color.mean, analysis.truth_xyz, strict=True)
        if not mean > LEAST_COLOR * truth
    ]


def _frame_notes(analysis: Analysis) -> list[str]:
    sensor, frame, mix = analysis.sensor, analysis.matrix.frame, analysis.mix
    if frame.rank < len(sensor.names) and mix:
        return [
            f"singular: only {frame.rank} of {len(sensor.names)} channels are independent "
            f"({mix_sentence(mix)}), so the coordinates of that mix are not defined and the kernel "
            "matrix takes the pseudo-inverse"
        ]
    if mix and mix.angle_deg < _NEAR_MIX_DEG:
        worst = float(analysis.vif[sensor.names.index(mix.channel)])
        return [
            f"nearly singular (condition {frame.condition:.4g}): {mix_sentence(mix)}, so its VIF "
            f"is {worst:.4g}"
        ]
    return []


def _unless_hidden(
    ratios: dict[str, Float[Array, ""]], hidden: dict[str, bool]
) -> dict[str, float | None]:
    return {
        name: None if hidden[name] or not np.isfinite(value) else float(value)
        for name, value in ratios.items()
    }
