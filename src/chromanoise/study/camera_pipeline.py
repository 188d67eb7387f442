"""Noise after each step of the camera's own pipeline: settings and results.

The results are of every ColorChecker patch, at every gain.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    check,
    dataclass,
    decibel,
    with_short_repr,
)
from chromanoise.color import (
    FIRST_ORDER_TOLERANCE,
    RGB,
    UNBOUNDED,
    XYZ,
    ElectronSource,
    LumaStandard,
    Method,
    NoisyColor,
    Space,
    black_subtracted,
    checked_gains,
    cubature,
    encoded_space,
    exact,
    exact_where_needed,
    first_order,
    gains_covariance,
    gray_gains,
    linear_srgb,
    luma_chroma,
    matrix_for_balanced,
    normal_fails,
    propagate,
    relative_sd_error,
    rendered_lab_space,
    tone_curve,
    white_balanced,
    with_exposure_gain,
    with_saturation,
)
from chromanoise.noise import (
    Measurement,
    OperatingPoint,
    Readout,
    after_counting,
    demand_independent_channels,
    few_electrons,
    noise_sources,
    signal_limit_e,
    through,
    with_noise,
)
from chromanoise.sensor import code_step_e, with_analog_gain
from chromanoise.spectra import Illuminant, colorchecker
from chromanoise.study.analysis import (
    Analysis,
    Stages,
    color_snr_db,
    electrons_at,
    of_white,
    stages_at,
)
from chromanoise.study.color_noise import GRAY

BASE_ISO = 100.0
"""ISO of the operating point, at which the sensor has the analog gain 1."""

_MOST_GAIN = 1e6
_MOST_READ_NOISE_E = 1e12


@dataclass(frozen=True, kw_only=True, eq=False)
class PipelineSettings:
    """Settings of the pipeline.

    Attributes
    ----------
    white_balance
        ``gray``: equal raw of an 18 % gray as it is read; an illuminant: equal raw of a white under
        it; or one gain per channel.
    white_balance_pixels
        Number of gray pixels from which the gains are estimated; ``None`` for exact gains.
    exposure_gain, saturation
        Factor of linear RGB, and of its distance to luminance. [1]
    tone
        ``srgb``, ``rec709``, ``linear``, or a gamma.
    luma
        Standard of the weights of Y'.
    iso
        ISO settings; at each, the analog gain is the ISO over the base, and the exposure is divided
        by it, so that the codes stay the same.
    base_iso
        ISO of the operating point.
    iso_read_noise_e
        Read noise at each ISO; ``None`` for the same at all. [e-]

    Raises
    ------
    InputError
        If a value is out of range, an ISO is below the base, or there is not one read noise per
        ISO.
    """

    white_balance: str | Illuminant | tuple[float, ...] = "gray"
    white_balance_pixels: int | None = None
    exposure_gain: float = 1.0
    saturation: float = 1.0
    tone: str | float = "srgb"
    luma: LumaStandard = "bt709"
    iso: tuple[float, ...] = (BASE_ISO,)
    base_iso: float = BASE_ISO
    iso_read_noise_e: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.white_balance, str):
            check.one_of("white_balance", self.white_balance, ("gray",))
        if self.white_balance_pixels is not None and self.white_balance != "gray":
            raise InputError(
                "white_balance_pixels",
                "must be given only with gains estimated from gray pixels",
                value=self.white_balance_pixels,
                found="the gains are not",
                remedy="omit it, or balance by gray",
            )
        check.positive("exposure_gain", "1", self.exposure_gain)
        check.not_negative("saturation", "1", self.saturation)
        tone_curve(self.tone)
        check.positive("base_iso", "ISO", self.base_iso)
        for iso in self.iso:
            if not self.base_iso <= iso <= _MOST_GAIN * self.base_iso:
                raise InputError(
                    "iso",
                    f"must be 1 to {_MOST_GAIN:g} times the base ISO of {self.base_iso:g}",
                    value=iso,
                )
        if self.iso_read_noise_e is not None:
            for read in self.iso_read_noise_e:
                check.within("iso_read_noise_e", "e-", read, 0.0, _MOST_READ_NOISE_E)
            if len(self.iso_read_noise_e) != len(self.iso):
                raise InputError(
                    "iso_read_noise_e",
                    "must have one value per ISO [e-]",
                    value=self.iso_read_noise_e,
                    found=f"has {len(self.iso_read_noise_e)} for {len(self.iso)} ISO settings",
                )

    @property
    def balance(self) -> str | tuple[float, ...]:
        """``gray``, the name of the illuminant, or the gains."""
        balance = self.white_balance
        return balance.name if isinstance(balance, Illuminant) else balance


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class PipelineStep:
    """The patches after one step.

    Attributes
    ----------
    name
        E.g. ``raw``, ``white-balanced``, ``sRGB``, ``Y'CbCr``.
    measurement
        Mean and covariance of the 24 patches.
    """

    KEYS: ClassVar[JsonKeys] = (
        "name",
        JsonKey("unit", "measurement.unit"),
        JsonKey("coordinates", "measurement.names"),
        JsonKey(
            "patches",
            ".",
            rows=True,
            keys=(
                JsonKey("patch", "patches"),
                JsonKey("mean", "measurement.mean"),
                JsonKey("covariance", "measurement.covariance"),
            ),
        ),
    )

    name: str
    measurement: Measurement


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class GainStep:
    """The sensor at one ISO.

    Attributes
    ----------
    iso, gain
        ISO, and analog gain over that at the base ISO. [1]
    read_noise_e
        Read noise at this gain; that of the sum for binned pixels. [e-]
    white_level_e
        Largest signal: full well, or top code if that is lower. [e-]
    gain_dn_per_e
        Gain K of the converter; ``None`` where it is unknown. [DN/e-]
    dynamic_range_db
        White level over temporal noise in the dark, per channel; inf without noise. [dB]
    emva_dynamic_range_db
        White level over the absolute sensitivity threshold, temporal noise in the dark + 1/2 e-
        (EMVA 1288, release 4.0), per channel. [dB]
    noise_profile
        S and O of each channel: variance S x + O, x = 1 at the white level (DNG). PRNU is not
        included, because its variance is quadratic.
    steps
        The patches after each step at this gain.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("iso", "gain", "gain_dn_per_e", "read_noise_e", "white_level_e"),
        JsonKey("dynamic_range_db", by=("channels",)),
        JsonKey("dynamic_range_stops", by=("channels",)),
        JsonKey("emva_dynamic_range_db", by=("channels",)),
        JsonKey(
            "noise_profile",
            "noise_profile.T",
            by=(("S", "O"), "channels"),
            text="Variance S x + O of each channel; x = 1 at the white level (DNG).",
        ),
        "steps",
    )

    iso: float
    gain: float
    read_noise_e: float
    white_level_e: float
    gain_dn_per_e: float | None
    dynamic_range_db: Float[Array, " p"]
    emva_dynamic_range_db: Float[Array, " p"]
    noise_profile: Float[Array, "p 2"]
    steps: tuple[PipelineStep, ...]

    @property
    def dynamic_range_stops(self) -> Float[Array, " p"]:
        """The dynamic range as a power of two, per channel."""
        return self.dynamic_range_db / decibel(np.array(2.0))


@dataclass(frozen=True, kw_only=True, eq=False)
class WhiteBalanceNoise:
    """Error of gains that are estimated from gray pixels, common to all pixels of the picture.

    Attributes
    ----------
    pixels
        Number of gray pixels.
    gains_covariance
        Of the gains. [1]
    lab_covariance
        Of the shift of each patch in CIELAB.
    """

    KEYS: ClassVar[JsonKeys] = (
        "pixels",
        JsonKey("gains_sd", by=("channels",)),
        "gains_covariance",
        JsonKey(
            "patches",
            ".",
            rows=True,
            keys=(JsonKey("patch", "patches"), "lab_covariance", "delta_e"),
        ),
    )

    pixels: int
    gains_covariance: Float[Array, "p p"]
    lab_covariance: Float[Array, "24 3 3"]

    @property
    def gains_sd(self) -> Float[Array, " p"]:
        """Standard deviation of each gain. [1]"""
        return np.asarray(np.sqrt(np.diagonal(self.gains_covariance)))

    @property
    def delta_e(self) -> Float[Array, "24"]:
        """Root mean square shift of each patch. [Delta E*ab]"""
        return np.asarray(np.sqrt(np.trace(self.lab_covariance, axis1=-2, axis2=-1)))


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class PipelineNoise:
    """Noise of the chart through the pipeline of one sensor.

    Attributes
    ----------
    patches, channels
        Names of the 24 patches and of the channels.
    gains
        White balance gain of each channel. [1]
    steps
        The patches after each step, at the operating point.
    iso
        The sensor and the patches at each ISO.
    white_balance_noise
        ``None`` where the gains are exact.
    notes
        Remarks: readings that clip, and where the first order fails.
    """

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("white_balance", "settings.balance"),
        JsonKey("gains", by=("channels",)),
        JsonKey("", "settings", keys=("exposure_gain", "saturation", "tone", "luma")),
        *("steps", "iso", "white_balance_noise", "notes"),
    )

    settings: PipelineSettings
    patches: tuple[str, ...]
    channels: tuple[str, ...]
    gains: Float[Array, " p"]
    steps: tuple[PipelineStep, ...]
    iso: tuple[GainStep, ...]
    white_balance_noise: WhiteBalanceNoise | None
    notes: tuple[str, ...]

    def step(self, name: str) -> Measurement:
        """The patches after the step of this name.

        Parameters
        ----------
        name
            Name of the step, as in `steps`.

        Raises
        ------
        InputError
            If there is no such step.
        """
        known = {one.name: one.measurement for one in self.steps}
        return known[check.one_of("step", name, tuple(known))]


_LARGE_GAIN_ERROR = 0.1  # relative standard deviation
_NOTED_SHARE = 1e-3
"""Share of readings above 1 from which a note names the patch."""


def pipeline_noise(
    analysis: Analysis,
    settings: PipelineSettings | None = None,
    *,
    readout: Readout | None = None,
    method: Method | None = None,
) -> PipelineNoise | None:
    """Mean and covariance of each ColorChecker patch after each step of the pipeline.

    ``None`` where a channel is saturated on the white, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    analysis
        Of any patch; its color matrix is that of the pipeline. White balance and scale are those of
        a perfect white.
    settings
        Of the pipeline; ``None`` for the defaults.
    readout
        Clipping and rounding of the raw values; ``None`` for none.
    method
        Method for the tone curve and CIELAB: `cubature`, `first_order` or `exact`. ``None`` uses
        the exact distribution where a normal one is too inaccurate (`exact_where_needed`), unless
        crosstalk after counting correlates the readings.

    Raises
    ------
    InputError
        If a channel without signal cannot be balanced, there is not one gain per channel, the
        exposure gain or the gains push a patch above 1, or the method is `exact` and crosstalk
        after counting correlates the channels.

    Notes
    -----
    The color matrix C acts on raw that is balanced for the light of the scene, as C diag(1/g_0)
    with the gains g_0 of a white under this light: gains that differ show as a color cast. The
    first steps are linear and exact. CIELAB is that of the rendered picture relative to D65.
    """
    chosen, analysis = settings or PipelineSettings(), of_white(analysis)
    if None in color_snr_db(analysis).values():
        return None
    if analysis.matrix.coordinates != XYZ:
        raise InputError(
            "matrix", "must give X, Y, Z", value=analysis.matrix.coordinates, remedy="take another"
        )
    if getattr(method, "func", method) is exact:  # also where `partial` sets its points
        demand_independent_channels(analysis.sensor)
    correlated = after_counting(analysis.sensor.crosstalk) is not None
    method = method or (cubature if correlated else exact_where_needed)
    camera = _camera(analysis, chosen, readout)
    at = _chart_at(camera, analysis.point)
    steps = _steps(camera, at, method)
    _refuse_clipped_means(camera, steps)
    isos = tuple(_gain_step(camera, i, steps, method) for i in range(len(chosen.iso)))
    balance = _balance_noise(camera)
    return PipelineNoise(
        settings=chosen,
        patches=camera.patches,
        channels=analysis.sensor.names,
        gains=camera.gains,
        steps=steps,
        iso=isos,
        white_balance_noise=balance,
        notes=(
            *_clipping_notes(camera, steps),
            *_method_notes(camera, at, steps, method),
            *_balance_notes(camera, balance),
            *(_correlated_notes(camera, steps, isos) if correlated else ()),
            *_full_notes(isos),
        ),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Camera:
    """What all gains share: the pipeline of an analysis."""

    analysis: Analysis
    settings: PipelineSettings
    readout: Readout | None
    patches: tuple[str, ...]
    reflectance: Float[Array, "24 n"]
    gray: Measurement
    gains: Float[Array, " p"]
    for_balanced: Float[Array, "3 p"]  # from balanced electrons to XYZ, Y = 1 for the white
    white: Float[Array, " 3"]

    @property
    def spaces(self) -> tuple[Space, Space]:
        """XYZ to encoded RGB, and to CIELAB."""
        own = {
            "exposure_gain": self.settings.exposure_gain,
            "saturation": self.settings.saturation,
        }
        return encoded_space(tone_curve(self.settings.tone), **own), rendered_lab_space(**own)


def _camera(analysis: Analysis, settings: PipelineSettings, readout: Readout | None) -> _Camera:
    names, matrix, expected = analysis.sensor.names, analysis.matrix.matrix, analysis.expected_e
    chart = colorchecker(analysis.sensor.grid)
    gray = _raw(stages_at(analysis.point, analysis.matrix, reflectance=GRAY, readout=readout))
    calibration = gray_gains(expected, names)
    white = matrix @ expected
    return _Camera(
        analysis=analysis,
        settings=settings,
        readout=readout,
        patches=chart.names,
        reflectance=chart.values.T,
        gray=gray,
        gains=_gains(analysis, settings, gray),
        for_balanced=matrix_for_balanced(matrix, calibration) / white[1],
        white=white / white[1],
    )


def _gains(analysis: Analysis, settings: PipelineSettings, gray: Measurement) -> Float[Array, " p"]:
    balance, names = settings.white_balance, analysis.sensor.names
    if isinstance(balance, Illuminant):
        lit = replace(analysis.point, illuminant=balance)
        return gray_gains(electrons_at(lit), names)
    if isinstance(balance, str):
        return gray_gains(gray.mean, names)
    return checked_gains(balance, names)


def _raw(stages: Stages) -> Measurement:
    """The raw as it is read, black level subtracted."""
    if stages.clipping is not None:  # the moments of the readout include the error
        return stages.raw
    return black_subtracted(stages.raw, stages.point.sensor.pixel.black_error_e)


def _chart_at(camera: _Camera, point: OperatingPoint) -> Stages:
    """The patches of the chart, as they are read."""
    return stages_at(
        point, camera.analysis.matrix, reflectance=camera.reflectance, readout=camera.readout
    )


def _steps(
    camera: _Camera, at: Stages, method: Method, exposure: float = 1.0
) -> tuple[PipelineStep, ...]:
    """The patches after each step; ``exposure`` is that of the stages over the analysis."""
    settings = camera.settings
    raw = _raw(at)
    balanced = white_balanced(raw, camera.gains)
    to_xyz = camera.for_balanced / exposure
    xyz = through(balanced, to_xyz, names=XYZ, kind="XYZ", unit="1")
    to_linear = linear_srgb(np.eye(3), camera.white).T
    linear = through(xyz, to_linear, names=RGB, kind="linear sRGB", unit="1")
    exposed = with_exposure_gain(linear, settings.exposure_gain)
    saturated = with_saturation(exposed, settings.saturation)
    encoded, lab = (
        propagate(_noisy(camera, at, xyz, to_xyz), space, method).measurement
        for space in camera.spaces
    )
    found = {
        "raw": raw,
        "white-balanced": balanced,
        "XYZ": xyz,
        "linear sRGB": linear,
        "exposure": exposed,
        "saturation": saturated,
        encoded.kind: encoded,
        "Y'CbCr": luma_chroma(encoded, settings.luma),
        "Lab": lab,
    }
    return tuple(PipelineStep(name=name, measurement=one) for name, one in found.items())


def _noisy(
    camera: _Camera, at: Stages, xyz: Measurement, to_xyz: Float[Array, "3 p"]
) -> NoisyColor:
    source = ElectronSource(
        mean_e=at.expected_e,
        matrix=to_xyz * camera.gains,
        noise=noise_sources(at.point.sensor, at.point.exposure),
        readout=camera.readout or UNBOUNDED,
    )
    return NoisyColor(xyz=xyz, white=camera.white, source=source)


# ---- gain ----


def _gain_step(camera: _Camera, i: int, base: tuple[PipelineStep, ...], method: Method) -> GainStep:
    settings, point = camera.settings, camera.analysis.point
    iso = settings.iso[i]
    gain = iso / settings.base_iso
    read = None if settings.iso_read_noise_e is None else settings.iso_read_noise_e[i]
    try:
        sensor = with_analog_gain(point.sensor, gain, read_noise_e=read)
    except InputError as error:  # a full well or a step out of range
        raise error.within("iso") from None
    at = replace(
        point,
        sensor=sensor,
        exposure=replace(point.exposure, time_s=point.exposure.time_s / gain),
    )
    same = gain == 1 and at.sensor.pixel == point.sensor.pixel
    white_e = check.positive("white level", "e-", signal_limit_e(at.sensor, at.exposure))
    step_e = code_step_e(at.sensor.converter, at.sensor.pixel)
    dark = _dark_noise_e(at)
    return GainStep(
        iso=iso,
        gain=gain,
        read_noise_e=at.sensor.pixel.read_noise_e,
        white_level_e=white_e,
        gain_dn_per_e=1 / step_e if step_e else None,
        dynamic_range_db=np.asarray(decibel(np.array(white_e)) - decibel(dark)),
        emva_dynamic_range_db=np.asarray(decibel(white_e / (dark + 0.5))),
        noise_profile=_noise_profile(at, white_e),
        steps=base if same else _steps(camera, _chart_at(camera, at), method, 1 / gain),
    )


def _dark_noise_e(point: OperatingPoint) -> Float[Array, " p"]:
    """Temporal noise of each channel without light. [e-]"""
    dark = np.zeros(len(point.sensor.names))
    return np.sqrt(
        with_noise(dark, point.sensor, point.exposure, kind="temporal", linear=True).variance
    )


def _noise_profile(point: OperatingPoint, white_e: float) -> Float[Array, "p 2"]:
    """S and O of each channel on a gray: PRNU and pattern left out, the variance is linear."""
    gray = electrons_at(point, reflectance=GRAY)
    read = partial(with_noise, sensor=point.sensor, exposure=point.exposure, linear=True)
    dark = read(np.zeros_like(gray)).variance
    still, lit = (read(mean, kind="temporal").variance for mean in (np.zeros_like(gray), gray))
    slope = (lit - still) / np.where(gray > 0, gray, 1.0)
    return np.stack([slope / white_e, dark / white_e**2], axis=-1)


# ---- white balance ----


def _balance_noise(camera: _Camera) -> WhiteBalanceNoise | None:
    """The delta method: patch m moves by C_b diag(m) dg in XYZ, then by the slope of CIELAB."""
    pixels = camera.settings.white_balance_pixels
    if pixels is None:
        return None
    covariance = gains_covariance(camera.gray, pixels)
    raw = _raw(
        stages_at(camera.analysis.point, camera.analysis.matrix, reflectance=camera.reflectance)
    ).mean
    xyz = (raw * camera.gains) @ camera.for_balanced.T
    slope = camera.spaces[1].jacobian(xyz, camera.white)
    moved = slope @ (camera.for_balanced * raw[:, None, :])
    return WhiteBalanceNoise(
        pixels=pixels,
        gains_covariance=covariance,
        lab_covariance=moved @ covariance @ np.swapaxes(moved, -1, -2),
    )


# ---- what clips ----


def _named_step(steps: Sequence[PipelineStep], name: str) -> Measurement:
    return next(one.measurement for one in steps if one.name == name)


def _refuse_clipped_means(camera: _Camera, steps: Sequence[PipelineStep]) -> None:
    """Refuse an exposure gain, or given gains, that push the mean of a patch above 1."""
    mean = _named_step(steps, "exposure").mean
    gain, given = camera.settings.exposure_gain, camera.settings.white_balance
    before = mean / gain
    name = "exposure_gain"
    if isinstance(given, tuple) and (before > 1).any():
        expected = camera.analysis.expected_e
        balanced = gray_gains(expected, camera.analysis.sensor.names) / camera.gains
        raw = _named_step(steps, "white-balanced").mean * balanced
        to_linear = linear_srgb(np.eye(3), camera.white).T @ camera.for_balanced
        before, name = raw @ to_linear.T, "white_balance"
    pushed = (mean > 1) & (before <= 1)
    if not pushed.any():
        return
    patch, channel = (int(i) for i in np.unravel_index(np.argmax(mean * pushed), mean.shape))
    most = float(1 / before[pushed].max())
    value: Any = gain if name == "exposure_gain" else given
    raise InputError(
        name,
        "must keep the mean of every patch at most 1 before the tone curve",
        value=value,
        found=f"patch {camera.patches[patch]} reaches {mean[patch, channel]:.3g} in {RGB[channel]} "
        f"and clips",
        remedy=f"take at most {math.floor(1000 * most) / 1000:g}"
        if name == "exposure_gain"
        else "lower the gains by a common factor",
    )


def _clipping_notes(camera: _Camera, steps: Sequence[PipelineStep]) -> list[str]:
    """One note on the patches with at least this share of readings above 1."""
    from scipy.special import ndtr

    rgb = _named_step(steps, "saturation")
    sd = np.sqrt(rgb.variance)
    share = np.where(sd > 0, ndtr((rgb.mean - 1) / np.where(sd > 0, sd, 1.0)), rgb.mean > 1)
    exceeding = [
        f"{name} ({100 * most:.1f} % of the readings in {RGB[channel]})"
        for name, most, channel in zip(
            camera.patches, share.max(axis=-1), share.argmax(axis=-1), strict=True
        )
        if most > _NOTED_SHARE
    ]
    if not exceeding:
        return []
    return [
        f"values exceed 1 before the tone curve on {', '.join(exceeding)}; "
        "a picture clips them, the numbers do not"
    ]


def _method_notes(
    camera: _Camera, at: Stages, steps: Sequence[PipelineStep], method: Method
) -> list[str]:
    """Where the Jacobian of the tone curve or of CIELAB is off by more than 5 %."""
    color = _noisy(camera, at, _named_step(steps, "XYZ"), camera.for_balanced)
    assert color.source is not None
    by_electrons = normal_fails(color.source) if method is exact_where_needed else None
    notes = []
    for space, name in zip(camera.spaces, (steps[-3].name, "Lab"), strict=True):
        rough = propagate(color, space, first_order).measurement
        error = np.abs(relative_sd_error(rough, _named_step(steps, name)))
        failing = (error > FIRST_ORDER_TOLERANCE).any(axis=-1)
        used = "does not use it"
        if by_electrons is not None and by_electrons[failing].all():
            used = "is computed from the exact distribution of the electrons"
        if failing.any():
            notes.append(
                f"the first-order noise in {space.name} has an error of more than 5 % on "
                f"{failing.sum()} of {len(error)} patches; the noise given here {used}"
            )
    return notes


def _balance_notes(camera: _Camera, balance: WhiteBalanceNoise | None) -> list[str]:
    """Where the errors of the gains are too large for the delta method."""
    if balance is None:
        return []
    relative = np.sqrt(np.diagonal(balance.gains_covariance)) / camera.gains
    worst = int(relative.argmax())
    if not relative[worst] > _LARGE_GAIN_ERROR:
        return []
    return [
        f"{balance.pixels} gray pixels determine the white-balance gain of "
        f"{camera.analysis.sensor.names[worst]} with a standard deviation of "
        f"{100 * relative[worst]:.0f} %; the noise of the gains is computed to first order, which "
        "holds only for small errors"
    ]


def _correlated_notes(
    camera: _Camera, steps: Sequence[PipelineStep], isos: Sequence[GainStep]
) -> list[str]:
    """Notes on readings of few electrons that are treated as normal because of correlation."""
    point = camera.analysis.point
    noise = noise_sources(point.sensor, point.exposure)
    settings = [("", steps, noise.pixel.read_noise_e)]
    settings += [
        (f" at ISO {one.iso:g}", one.steps, one.read_noise_e)
        for one in isos
        if one.steps is not steps
    ]
    found = []
    for where, own, read in settings:
        light = np.maximum(_named_step(own, "raw").mean - noise.black_error_e, 0.0)
        own_pixel = replace(noise.pixel, read_noise_e=read)
        few = few_electrons(light, replace(noise, pixel=own_pixel)).any(axis=-1).sum()
        if few:
            found.append(f"{few} of {len(camera.patches)} patches{where}")
    if not found:
        return []
    return [
        f"{', '.join(found)} have few electrons, but crosstalk after counting correlates the "
        "channels, so the noise after the tone curve and in CIELAB is computed from normally "
        "distributed readings"
    ]


def _full_notes(isos: Sequence[GainStep]) -> list[str]:
    notes = []
    for one in isos:
        over = int((_named_step(one.steps, "raw").mean > one.white_level_e).any(axis=-1).sum())
        if over:
            notes.append(
                f"at ISO {one.iso:g}, {over} patches exceed the {one.white_level_e:.4g} e- of the "
                "white level; a converter clips them, the numbers do not"
            )
    return notes
