"""Color noise and color error of a sensor: on a gray and a chart, as budgets and Pareto curves.

A matrix or a sensor that desaturates colors has less noise and a better SNR, but wrong colors. The
total error counts both, in CIELAB: E|x - x_true|^2 = |bias|^2 + trace of the covariance.
"""

import math
from collections.abc import Sequence
from functools import cache, cached_property, partial
from typing import ClassVar, NamedTuple

import numpy as np

from chromanoise.base import (
    Array,
    Bool,
    Float,
    InputError,
    Int,
    JsonKey,
    JsonKeys,
    check,
    congruence,
    covariance_root,
    dataclass,
    defined,
    inv,
    kept,
    kept_of_each,
    variances_along,
    with_short_repr,
)
from chromanoise.color import (
    D65_WHITE,
    FIRST_ORDER_TOLERANCE,
    LAB,
    LUV,
    UNBOUNDED,
    ColorMatrix,
    ColorNoise,
    Method as PropagationMethod,
    NoisyColor,
    ParetoCurve,
    Space,
    cubature,
    exact,
    first_order,
    gaussian_cubature,
    pareto,
    propagate,
    relative_sd_error,
)
from chromanoise.metrics import (
    CONTRAVARIANT,
    ISO_15739_2017,
    OPPONENT_FROM_XYZ,
    Budget,
    BudgetRequest,
    MatrixReport,
    budgets_of,
    chart_ciede2000,
    chart_color_error,
    chart_lab,
    pixels_per_degree,
    scielab_shares,
    signal_snr_db,
    viewed_covariance,
)
from chromanoise.noise import (
    Exposure,
    Measurement,
    OperatingPoint,
    Readout,
    demand_independent_channels,
    saturated,
    with_noise,
)
from chromanoise.sensor import Sensor
from chromanoise.spectra import Scene, Spectra, chart_on, flat_field
from chromanoise.study.analysis import (
    Analysis,
    color_snr_db,
    electrons_at,
    noisy_color_at,
    of_white,
    stages_at,
)
from chromanoise.study.color_matrices import DEFAULT_PRIOR, refuse_unknown_prior, training_named

GRAY = 0.18
"""Reflectance of the gray card."""
LOST_DELTA_E = 100.0
"""The distance of black and white: noise that hides the color of a pixel. [Delta E*ab]"""
PLANE = 128
"""Side of the Fourier plane on which visual noise is averaged."""
_AXES = ("exact.measurement.names",)


@dataclass(frozen=True, kw_only=True)
class Viewing:
    """Display and distance from which a picture is viewed, one picture pixel per display pixel.

    Attributes
    ----------
    pixel_pitch_mm
        Of the display or print. [mm]
    distance_mm
        Of the eye. [mm]
    """

    pixel_pitch_mm: float = 0.25
    distance_mm: float = 600.0

    def __post_init__(self) -> None:
        check.positive("pixel_pitch_mm", "mm", self.pixel_pitch_mm)
        check.positive("distance_mm", "mm", self.distance_mm)
        check.within(
            "pixels per degree, from pixel_pitch_mm and distance_mm,",
            "1/deg",
            self.pixels_per_degree,
            1.0,
            10_000.0,
        )

    @cached_property
    def pixels_per_degree(self) -> float:
        """Pixels in one degree of visual angle. [1/deg]"""
        return pixels_per_degree(distance_mm=self.distance_mm, pixel_pitch_mm=self.pixel_pitch_mm)


USUAL_VIEWING = Viewing()
"""Of a picture on a usual display."""

_ROUNDING = 1e-13  # of the terms of a variance


def noise_as_viewed(
    white_e: Float[Array, "*l p"],
    sensor: Sensor,
    exposure: Exposure,
    matrices: Float[Array, "*q 3 p"],
    viewing: Viewing,
    *,
    place: Int[Array, "*q"] | int | None = None,
) -> Float[Array, "*q"]:
    """Visual noise of an 18 % gray, with every channel in each pixel. [CIELUV]

    NaN where X, Y or Z of the sensor's white is not above 0.

    Parameters
    ----------
    white_e
        Expected electrons of a perfect white; with ``place``, of one at each light level. [e-]
    sensor, exposure
        The sensor and its exposure.
    matrices
        Color matrices. [lx/e-]
    viewing
        Size and distance of the picture.
    place
        Which of the light levels each matrix is for, or all are for.

    Notes
    -----
    ISO 15739:2017, annex B, to first order at the mean color.
    """
    in_pixel, known = _gray_in_pixel(white_e, sensor, exposure, matrices, place)
    viewed = viewed_covariance(
        np.where(known[..., None, None], in_pixel, 0.0),
        pixels_per_degree=viewing.pixels_per_degree,
        samples=PLANE,
    )
    to_luv = _of_gray(LUV)
    variance = variances_along(to_luv, viewed)
    terms = variances_along(np.abs(to_luv), np.abs(viewed))
    # a difference within rounding is none: its root would be a hundred million times as large
    variance = np.where(variance > _ROUNDING * terms, variance, 0.0)
    noise = np.sqrt(variance) @ ISO_15739_2017.weights
    return np.where(known, noise, np.nan)


def _gray_in_pixel(
    white_e: Array,
    sensor: Sensor,
    exposure: Exposure,
    matrices: Array,
    place: Array | int | None = None,
) -> tuple[Float[Array, "*q 3 3"], Bool[Array, "*q"]]:
    """Covariance of X, Y, Z over those of the white, of the gray in one pixel. [1]

    NaN where X, Y or Z of the white is not above 0, which is also returned.
    """
    in_e2 = with_noise(GRAY * white_e, sensor, exposure).covariance
    if place is not None:
        white_e, in_e2 = white_e[place], in_e2[place]
    white = matrices @ white_e[..., None]
    known = np.asarray((white > 0).all(axis=(-1, -2)))
    balanced = matrices / np.where(known[..., None, None], white, np.nan)
    return balanced @ in_e2 @ np.swapaxes(balanced, -1, -2), known


@cache
def _of_gray(space: Space) -> Float[Array, "3 3"]:
    """Slopes of a color space at the gray, from X, Y, Z over those of the white."""
    return space.jacobian(np.full(3, GRAY), np.ones(3))


class NoiseByTwoMeasures(NamedTuple):
    """Noise of an 18 % gray as viewed, by two measures.

    Attributes
    ----------
    visual
        Visual noise. [CIELUV]
    scielab
        Mean distance from its mean color after the filters of S-CIELAB. [Delta E*ab]
    """

    visual: float
    scielab: float


def noise_beyond_first_order(
    white_e: Float[Array, " p"],
    sensor: Sensor,
    exposure: Exposure,
    matrix: Float[Array, "3 p"],
    viewing: Viewing,
) -> NoiseByTwoMeasures:
    """Noise of an 18 % gray whose X, Y, Z as viewed are jointly normal, beyond first order.

    S-CIELAB sees the gray on a display whose white is D65.

    Parameters
    ----------
    white_e, sensor, exposure, viewing
        As `noise_as_viewed`.
    matrix
        The color matrix, with X, Y and Z of the white above 0. [lx/e-]
    """
    in_pixel, _ = _gray_in_pixel(white_e, sensor, exposure, matrix)
    by_iso = viewed_covariance(in_pixel, pixels_per_degree=viewing.pixels_per_degree, samples=PLANE)
    to_opponent = np.asarray(OPPONENT_FROM_XYZ) * D65_WHITE
    shares = scielab_shares(viewing.pixels_per_degree)
    by_scielab = congruence(
        inv("OPPONENT_FROM_XYZ", to_opponent), congruence(to_opponent, in_pixel) * shares
    )
    rule, gray = gaussian_cubature(), np.full(3, GRAY)
    luv, lab = (
        space.from_xyz(gray + rule.points @ covariance_root("the gray as viewed", seen), np.ones(3))
        for space, seen in ((LUV, by_iso), (LAB, by_scielab))
    )
    luv_variance = rule.weights @ np.square(luv - rule.weights @ luv)
    distance = np.linalg.norm(lab - rule.weights @ lab, axis=-1)
    return NoiseByTwoMeasures(
        visual=float(np.sqrt(luv_variance) @ ISO_15739_2017.weights),
        scielab=float(rule.weights @ distance),
    )


def visual_noise(
    operating_point: OperatingPoint, matrix: ColorMatrix, viewing: Viewing | None = None
) -> float:
    """The color noise of a sensor: `noise_as_viewed` of one matrix. [CIELUV]

    NaN where a channel is saturated, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    operating_point
        Sensor, exposure and light.
    matrix
        The color matrix. [lx/e-]
    viewing
        Size and distance of the picture; ``None`` for those of `Viewing`.
    """
    sensor, exposure = operating_point.sensor, operating_point.exposure
    white_e = electrons_at(operating_point)
    if saturated(white_e, sensor, exposure).any():
        return math.nan
    viewed = viewing or USUAL_VIEWING
    return float(noise_as_viewed(white_e, sensor, exposure, matrix.matrix, viewed))


VISUAL_NOISE = "visual noise of an 18 % gray as viewed"
"""What `visual_noise` is, in tables."""


@kept  # table, verdict and JSON use the same one
def visual_noise_of(analysis: Analysis) -> float | None:
    """`visual_noise` of an analysis with its matrix; ``None`` where it is undefined. [CIELUV]

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return defined(visual_noise(analysis.point, analysis.matrix))


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class GrayNoise:
    """Noise of a gray, computed by three methods.

    Attributes
    ----------
    reflectance
        Of the gray. [1]
    exact
        From the exact Poisson-Gaussian distribution: the reference.
    first_order, normal
        By J S J^T, and by cubature over X, Y and Z, assumed jointly normal.
    first_order_error, normal_error
        Standard deviation of each of these two over the exact one, minus 1.
    first_order_holds, normal_holds
        Whether that error is within 5 % for every coordinate.
    """

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("space", "exact.measurement.kind"),
        "reflectance",
        JsonKey("mean", "exact.measurement.mean", by=_AXES),
        JsonKey("sd", "exact.sd", by=_AXES),
        JsonKey("sd_own_error", "exact.sd_error", by=_AXES),
        JsonKey("sd_first_order", "first_order.sd", by=_AXES),
        JsonKey("sd_normal_law", "normal.sd", by=_AXES),
        JsonKey("bias", "exact.bias", by=_AXES),
        JsonKey("chroma_sd", "exact.chroma_sd"),
        JsonKey("delta_e_mean", "exact.delta_e"),
        "first_order_holds",
        JsonKey("normal_law_holds", "normal_holds"),
    )

    reflectance: float
    exact: ColorNoise
    first_order: ColorNoise
    normal: ColorNoise
    first_order_error: Float[Array, " 3"]
    normal_error: Float[Array, " 3"]
    first_order_holds: bool
    normal_holds: bool

    def __post_init__(self) -> None:
        check.freeze(self, "first_order_error", "normal_error")


def gray_noise(
    analysis: Analysis,
    space: Space,
    *,
    reflectance: float = GRAY,
    readout: Readout | None = None,
) -> GrayNoise | None:
    """Noise of a gray with the light and exposure of the analysis, relative to a perfect white.

    ``None`` where a channel is saturated on the white, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    analysis
        The analysis of a perfect white.
    reflectance
        Of the gray. [1]
    readout
        Clipping and rounding of the values; ``None`` for none. The white is never clipped.

    Raises
    ------
    InputError
        If crosstalk after counting correlates the channels.
    """
    white = of_white(analysis)
    if None in color_snr_db(white).values():
        return None
    demand_independent_channels(analysis.sensor)
    gray = stages_at(analysis.point, analysis.matrix, reflectance=reflectance, readout=readout)
    color = noisy_color_at(gray, analysis.matrix.matrix @ white.expected_e)
    trusted, rough, normal = (
        propagate(color, space, method) for method in (exact, first_order, cubature)
    )
    first_order_error, normal_error = (
        relative_sd_error(one.measurement, trusted.measurement) for one in (rough, normal)
    )
    return GrayNoise(
        reflectance=reflectance,
        exact=trusted,
        first_order=rough,
        normal=normal,
        first_order_error=first_order_error,
        normal_error=normal_error,
        first_order_holds=_holds(first_order_error),
        normal_holds=_holds(normal_error),
    )


def _holds(error: Float[Array, " 3"]) -> bool:
    return bool((np.abs(error) <= FIRST_ORDER_TOLERANCE).all())


_POINTS = 2**13  # per patch: standard deviations are accurate to 0.05 %


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class ChartNoise:
    """Color error and noise of each patch, with the light and exposure of an analysis.

    Attributes
    ----------
    names
        Names of the patches.
    color_error, ciede2000
        Color errors without noise, CIE 1976 and CIEDE2000. [Delta E]
    snr_y_db
        SNR of Y; NaN where Y has no signal. [dB]
    noise
        Noise in CIELAB, relative to the sensor's own white, from the exact Poisson-Gaussian
        distribution.
    first_order_holds
        Whether every first-order standard deviation is within 5 % of the exact one.
    """

    names: tuple[str, ...]
    color_error: Float[Array, " k"]
    ciede2000: Float[Array, " k"]
    snr_y_db: Float[Array, " k"]
    noise: ColorNoise
    first_order_holds: Bool[Array, " k"]

    def __post_init__(self) -> None:
        check.freeze(self, "color_error", "ciede2000", "snr_y_db", "first_order_holds")


def chart_noise(analysis: Analysis, *, readout: Readout = UNBOUNDED) -> ChartNoise | None:
    """Color error and noise of the chart under the light of the analysis.

    ``None`` where a channel is saturated on the white, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    analysis
        The analysis, with its chart; ``None`` there is the ColorChecker.
    readout
        Clipping and rounding of the values; none by default.

    Raises
    ------
    InputError
        If the grid extends beyond 400-1050 nm, the range of the chart's data, or crosstalk after
        counting correlates the channels.
    """
    sensor, exposure, matrix = analysis.sensor, analysis.exposure, analysis.matrix
    lamp, white = analysis.scene.illuminant, of_white(analysis)
    errors = chart_color_error(sensor, matrix, exposure, lamp, analysis.chart)
    newer = chart_ciede2000(sensor, matrix, exposure, lamp, analysis.chart)
    no_color = None in color_snr_db(white).values()
    if no_color or errors is None or newer is None:
        return None
    demand_independent_channels(sensor)
    chart = chart_on(sensor.grid, analysis.chart)
    at = stages_at(analysis.point, matrix, reflectance=chart.values.T, readout=readout)
    color = noisy_color_at(at, matrix.matrix @ white.expected_e)
    noise = propagate(color, LAB, partial(exact, points=_POINTS))
    rough = propagate(color, LAB, first_order)
    error = np.abs(relative_sd_error(rough.measurement, noise.measurement))
    return ChartNoise(
        names=chart.names,
        color_error=errors,
        ciede2000=newer,
        snr_y_db=np.where(
            at.one_code.any(axis=-1), np.nan, signal_snr_db(at.color, at.truth_xyz)[:, 1]
        ),
        noise=noise,
        first_order_holds=(error <= FIRST_ORDER_TOLERANCE).all(axis=-1),
    )


CHART_KEYS: JsonKeys = (
    JsonKey("patch", "names"),
    *("color_error", "ciede2000", "snr_y_db"),
    JsonKey("sd", "noise.sd", by=("noise.measurement.names",)),
    JsonKey("chroma_sd", "noise.chroma_sd"),
    JsonKey("noise_delta_e", "noise.delta_e"),
    "first_order_holds",
)
"""Of one patch; a chart is the list of its patches."""


def coordinate_budget(
    analysis: Analysis, coordinate: str, *, reflectance: float = GRAY
) -> Budget | None:
    """The budget of X, Y, Z, of a contravariant coordinate as M^R, or of L*, a*, b* of a gray.

    ``None`` where a channel is saturated, or the coordinate has no SNR or no budget, and for a
    clipped analysis, as a budget follows eq. 7.

    Parameters
    ----------
    analysis
        The analysis of a perfect white.
    coordinate
        Its name; ``None`` is returned for a coordinate that the sensor does not have.
    reflectance
        Of the gray, for L*, a* and b*. [1]
    """
    colors, channels = analysis.color.names, analysis.sensor.names
    if coordinate in colors:
        return color_budgets(analysis)[colors.index(coordinate)]
    if coordinate in LAB.coordinates:
        found = lab_budgets(analysis, reflectance=reflectance)
        return found[LAB.coordinates.index(coordinate)]
    channel = coordinate.removeprefix(CONTRAVARIANT)
    return contravariant_budgets(analysis)[channels.index(channel)] if channel in channels else None


def color_budgets(analysis: Analysis) -> tuple[Budget | None, ...]:
    """SNR budgets of X, Y and Z; ``None`` where a channel is saturated or there is no SNR.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return color_budgets_of([analysis])[0]


@kept_of_each  # verdict, chart and JSON use the same budgets
def color_budgets_of(analyses: Sequence[Analysis]) -> list[tuple[Budget | None, ...]]:
    """`color_budgets` of each analysis, computed at once."""
    known = [
        [name for name, snr in color_snr_db(one).items() if snr is not None] for one in analyses
    ]
    found = budgets_of(list(map(_budget_request, analyses, known)))
    return [
        tuple(own.get(name) for name in one.color.names)
        for one, own in zip(analyses, found, strict=True)
    ]


def contravariant_budgets(analysis: Analysis) -> tuple[Budget | None, ...]:
    """SNR budget of each contravariant coordinate; ``None`` where it has no SNR.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return contravariant_budgets_of([analysis])[0]


@kept_of_each
def contravariant_budgets_of(analyses: Sequence[Analysis]) -> list[tuple[Budget | None, ...]]:
    """`contravariant_budgets` of each analysis, computed at once."""
    names = [[f"{CONTRAVARIANT}{name}" for name in one.sensor.names] for one in analyses]
    found = budgets_of(list(map(_budget_request, analyses, names)))
    return [tuple(map(own.get, each)) for each, own in zip(names, found, strict=True)]


def lab_budgets(analysis: Analysis, *, reflectance: float = GRAY) -> tuple[Budget | None, ...]:
    """SNR budgets of one unit of L*, a* and b* of a gray, starting from all photons.

    ``None`` where a channel is saturated on the white, or a coordinate has no budget.

    Parameters
    ----------
    analysis
        The analysis of a perfect white; the gray is under the same light.
    reflectance
        Of the gray. [1]
    """
    of = lab_budgets_of if reflectance == GRAY else partial(_lab_budgets, reflectance=reflectance)
    return of([analysis])[0]


def _lab_budgets(
    analyses: Sequence[Analysis], reflectance: float = GRAY
) -> list[tuple[Budget | None, ...]]:
    """`lab_budgets` of each analysis, computed at once."""
    requests = []
    for one in analyses:
        light, is_known = one.scene, _may_have_budgets(one)
        has_color = is_known and None not in color_snr_db(of_white(one)).values()
        gray = flat_field(light.illuminant, level_lux=light.level_lux, reflectance=reflectance)
        requests.append(_budget_request(one, LAB.coordinates if has_color else (), gray))
    return [tuple(map(own.get, LAB.coordinates)) for own in budgets_of(requests)]


lab_budgets_of = kept_of_each(_lab_budgets)


def find_budgets(analyses: Sequence[Analysis]) -> None:
    """Compute all budgets of many analyses at once, which are then kept."""
    for of_each in (color_budgets_of, contravariant_budgets_of, lab_budgets_of):
        of_each(analyses)


def _budget_request(
    analysis: Analysis, coordinates: Sequence[str], scene: Scene | None = None
) -> BudgetRequest:
    return BudgetRequest(
        scene=analysis.scene if scene is None else scene,
        sensor=analysis.sensor,
        exposure=analysis.exposure,
        matrix=analysis.matrix,
        coordinates=tuple(coordinates) if _may_have_budgets(analysis) else (),
    )


def _may_have_budgets(analysis: Analysis) -> bool:
    return not analysis.without_snr.any() and analysis.readout is None


def missing_color_budgets(analysis: Analysis, budgets: Sequence[Budget | None]) -> str | None:
    """Why `color_budgets` lacks a coordinate that has an SNR; ``None`` where none is missing.

    Parameters
    ----------
    analysis
        Results of one sensor.
    budgets
        Budgets of X, Y and Z; ``None`` where a budget is undefined.
    """
    has_snr = color_snr_db(analysis)
    found = zip(analysis.color.names, budgets, strict=True)
    missing = [name for name, budget in found if budget is None and has_snr[name] is not None]
    if not missing or analysis.readout is not None:
        return None
    listed = " and ".join(missing)
    return (
        f"{analysis.sensor.label}: no budget of {listed}, because without infrared, or with "
        f"channels weighted one by one, it has no {listed} above 0; add an IR-cut, or use another "
        "matrix"
    )


def missing_lab_budgets(analysis: Analysis, budgets: Sequence[Budget | None]) -> str | None:
    """The reason why `lab_budgets` lacks a coordinate; ``None`` where none is missing.

    Parameters
    ----------
    analysis
        Results of one sensor.
    budgets
        Budgets of L*, a* and b*; ``None`` where a budget is undefined.
    """
    name = analysis.sensor.label
    if analysis.saturated.any():
        return f"{name}: a channel is saturated on the white, so L*, a* and b* have no budget"
    if analysis.one_code.any():
        return f"{name}: a channel gives one code on the white, so L*, a* and b* have no budget"
    found = zip(LAB.coordinates, budgets, strict=True)
    missing = [coordinate for coordinate, budget in found if budget is None]
    if not missing:
        return None
    return (
        f"{name}: no budget of {', '.join(missing)}, because sensor and matrix do not respond to a "
        "change of it; use another matrix, or more channels"
    )


_LIGHTEST, _HEAVIEST = 1e-15, 1e15  # limits of double precision


def noise_weights(first: float, last: float, *, points: int = 13) -> Float[Array, " q"]:
    """Weights of the noise from first to last, equally spaced in their logarithm. [1]

    Parameters
    ----------
    first
        Lowest weight, > 0. [1]
    last
        Highest weight. [1]

    Raises
    ------
    InputError
        If a weight is not above 0, they do not increase, or ``points`` is not 2 to 100,000.

    Examples
    --------
    >>> noise_weights(0.01, 100.0, points=3)
    array([1.e-02, 1.e+00, 1.e+02])
    """
    for value in (first, last):
        check.within("weight of the noise", "1", value, _LIGHTEST, _HEAVIEST)
    if not last > first:
        raise InputError(
            "weights of the noise",
            "must rise",
            value=(first, last),
            found=f"go from {first:g} to {last:g}",
            remedy="swap them",
        )
    if not 2 <= points <= 100_000:
        raise InputError("points", "must be 2 to 100000 for a curve", value=points)
    return np.geomspace(first, last, points)


def pareto_of(
    operating_point: OperatingPoint,
    weights: Float[Array, " q"],
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
) -> ParetoCurve:
    """The Pareto curve of color error against noise at an operating point.

    Parameters
    ----------
    operating_point
        A sensor in its light, with its exposure.
    weights
        Weights of the noise: 0 is least squares, 1 LMMSE. [1]
    prior
        The training set: a name from `PRIORS`, or reflectances on the grid.

    Raises
    ------
    InputError
        If there is no prior of that name, or as `chromanoise.color.pareto`.

    Notes
    -----
    Vora & Herley (ICIP 1998), with shot noise.
    """
    refuse_unknown_prior(prior)
    training = training_named(prior, operating_point.illuminant, operating_point.observer)
    return pareto(
        operating_point.sensor,
        operating_point.exposure,
        training,
        weights,
        level_lux=operating_point.level_lux,
    )


def white_snr_db(curve: ParetoCurve, report: MatrixReport) -> tuple[float | None, ...]:
    """SNR of Y along the curve; ``None`` where a channel is saturated on the white. [dB]

    Parameters
    ----------
    curve
        Color error against noise of a matrix.
    report
        Report of the matrix at the same operating point.
    """
    if report.snr_db is None:
        return (None,) * curve.weight.size
    return tuple(defined(float(value)) for value in curve.snr_y_db)


@dataclass(frozen=True, kw_only=True, eq=False)
class TotalError:
    """Bias, noise and total error of each patch of the chart, as root mean squares.

    Attributes
    ----------
    bias
        Distance of the mean color from the true one: errors of the matrix, of the black level and
        of clipping, and the shift of the mean by noise. [Delta E*ab]
    noise
        Root of the trace of the covariance. [Delta E*ab]
    total
        Root of the sum of both squares. [Delta E*ab]
    """

    bias: Float[Array, " k"]
    noise: Float[Array, " k"]
    total: Float[Array, " k"]

    def __post_init__(self) -> None:
        check.freeze(self, "bias", "noise", "total")


def total_errors(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    *,
    readout: Readout | None = None,
    method: PropagationMethod | None = None,
) -> TotalError | None:
    """Total color error of the chart at an operating point, by default the ColorChecker.

    ``None`` where a channel is saturated on the white, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    operating_point
        Sensor, exposure and light.
    readout
        Clipping and rounding of the values; ``None`` for none.
    method
        Of the noise in CIELAB, as `propagate`; by default from X, Y, Z as jointly normal, by
        cubature.

    Raises
    ------
    InputError
        If the grid extends beyond 400-1050 nm, the range of the chart's data.
    """
    chart = _chart_seen(operating_point, matrix, readout)
    if chart is None or method is None:
        return None if chart is None else _total_errors([chart])[0]
    return _total_error(propagate(chart.color, LAB, method).measurement, chart.truth_lab)


class _ChartSeen(NamedTuple):
    """The noisy colors of a chart, and their true CIELAB."""

    color: NoisyColor
    truth_lab: Float[Array, "k 3"]


def _chart_seen(
    point: OperatingPoint, matrix: ColorMatrix, readout: Readout | None
) -> _ChartSeen | None:
    sensor, exposure, chart = point.sensor, point.exposure, point.chart
    electrons = electrons_at(point)
    white = matrix.matrix @ electrons
    if saturated(electrons, sensor, exposure).any() or not (white > 0).all():
        return None
    lab = chart_lab(sensor, matrix, exposure, point.illuminant, chart)
    if lab is None:
        return None
    reflectance = chart_on(sensor.grid, chart).values.T
    stages = stages_at(point, matrix, reflectance=reflectance, readout=readout)
    return _ChartSeen(noisy_color_at(stages, white), lab[0])


def _total_errors(charts: Sequence[_ChartSeen]) -> list[TotalError]:
    """By cubature, of all charts at once."""
    xyz, white = [one.color.xyz for one in charts], [one.color.white for one in charts]
    relative = Measurement(
        mean=np.concatenate([one.mean / own for one, own in zip(xyz, white, strict=True)]),
        covariance=np.concatenate(
            [one.covariance / np.outer(own, own) for one, own in zip(xyz, white, strict=True)]
        ),
        names=xyz[0].names,
        kind=xyz[0].kind,
        unit="1",
    )
    color = NoisyColor(xyz=relative, white=np.ones(3))
    # error below 4e-3 of a standard deviation
    rule = gaussian_cubature(radii=5, latitudes=3, longitudes=6)
    method = partial(cubature, rule=rule, differences=False)
    noise = propagate(color, LAB, method).measurement
    every = _total_error(noise, np.concatenate([one.truth_lab for one in charts]))
    ends = np.cumsum([len(one.truth_lab) for one in charts])[:-1]
    parts = (np.split(own, ends) for own in (every.bias, every.noise, every.total))
    return [TotalError(bias=b, noise=n, total=t) for b, n, t in zip(*parts, strict=True)]


def _total_error(noise: Measurement, truth_lab: Float[Array, "k 3"]) -> TotalError:
    bias = np.linalg.norm(noise.mean - truth_lab, axis=-1)
    spread = noise.variance.sum(axis=-1)
    return TotalError(bias=bias, noise=np.sqrt(spread), total=np.sqrt(bias**2 + spread))


def total_error_of(analysis: Analysis) -> TotalError | None:
    """`total_errors` of an analysis, with its matrix and readout; ``None`` without a color.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return total_errors_of([analysis])[0]


@kept_of_each
def total_errors_of(analyses: Sequence[Analysis]) -> list[TotalError | None]:
    """`total_error_of` of each analysis, computed at once."""
    charts = [
        None
        if None in color_snr_db(of_white(one)).values()
        else _chart_seen(one.point, one.matrix, one.readout)
        for one in analyses
    ]
    seen = [one for one in charts if one is not None]
    found = iter(_total_errors(seen) if seen else ())
    return [None if one is None else next(found) for one in charts]


def mean_total_error(analysis: Analysis) -> float | None:
    """Mean of `TotalError.total` over the patches. [Delta E*ab]

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    error = total_error_of(analysis)
    return None if error is None else float(error.total.mean())
