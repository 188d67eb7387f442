"""Sensors compared at equal color error: trade-offs, the winner, and where the order turns.

A color matrix trades color error for noise, so the noise of one matrix compares two things at once.
Each sensor therefore runs along its own `NoiseAwareFamily`, and the visual noise is compared where
the color errors are equal: at the least error that all sensors reach.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cached_property, lru_cache
from itertools import combinations, groupby
from typing import Any, ClassVar, Literal, NamedTuple

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
    dataclass,
    decibel,
    kept,
    matrix_rank,
    with_short_repr,
)
from chromanoise.color import (
    LAB_FROM_CUBE_ROOTS,
    ColorMatrix,
    NoiseAwareFamily,
    balanced_cielab,
    cie1976_difference,
    cube_root_slope,
)
from chromanoise.metrics import optimal_linear_snr_db, truth_lab, viewed_covariance
from chromanoise.noise import OperatingPoint, coarsely_converted, saturated, with_noise
from chromanoise.spectra import Grid, Spectra, chart_on, is_infrared
from chromanoise.study.analysis import electrons_at
from chromanoise.study.color_matrices import DEFAULT_PRIOR, training_named
from chromanoise.study.color_noise import (
    GRAY,
    PLANE,
    USUAL_VIEWING,
    NoiseByTwoMeasures,
    Viewing,
    noise_as_viewed,
    noise_beyond_first_order,
)
from chromanoise.study.sweeps import fullest_level_lux

MOST_CHECKED = 20
"""Sensors, of least noise, whose order is checked by other conventions, lights and color errors."""
LEAST_TIE_DB = 0.05
"""A margin that one decimal does not show is a tie. [dB]"""
HARDLY_SEEN_DELTA_E = 0.5
"""Color errors that differ by less count as equal. [Delta E*ab]"""
_SECOND_PRIOR = "smooth-50-nir"  # its margin must agree with that of the prior of the study
_LEVELS_LUX = tuple(float(one) for one in np.geomspace(0.01, 1000.0, 6))
_ANY_LUX = 1.0  # of what is scaled to each of the levels
_COLORS = 3  # fewest independent channels from which X, Y and Z can be made
_MOST_SUBSETS = 5  # channels of which all subsets are tried
_ROUNDING = 1e-9  # of a color error, relative
_STRIDE = 4  # of the matrices whose total error is computed first
_PALE = 1.0  # mean chroma of a chart without colors
_ERRORS = 17  # color errors at which the order is checked
_PER_DECADE, _COARSE = 12, 4  # weights of the noise, at the own light level and at others

NO_LIGHT, SATURATED = "no channel sees the light", "a channel is saturated on the white"
COARSE = (
    "the step of its converter hides the noise of an 18 % gray; take more bits or a higher gain"
)
FEW_CHANNELS = "it has fewer than three independent channels"
NO_COLOR = "X, Y or Z of the light is 0"
NO_CHART = "the chart has no colors"


@dataclass(frozen=True, kw_only=True, eq=False)
class _Chart:
    """A chart and its white under the light of an operating point.

    Attributes
    ----------
    truth_lab
        L*, a*, b* of the patches for the observer.
    white_e
        Electrons of the white. [e-]
    patches
        Electrons of the patches over those of the white. [1]
    patches_e2
        Covariance of the electrons of each patch. [e-^2]
    """

    truth_lab: Float[Array, "k 3"]
    white_e: Float[Array, " p"]
    patches: Float[Array, "k p"]
    patches_e2: Float[Array, "k p p"]

    @cached_property
    def flat_patches_e2(self) -> Float[Array, "p2 k"]:
        """``patches_e2`` as columns. [e-^2]"""
        columns = self.patches_e2.reshape(len(self.patches_e2), -1).T
        return check.frozen(np.ascontiguousarray(columns))

    @cached_property
    def colorless_error(self) -> float:
        """Color error of a gray picture of the right lightness, without noise. [Delta E*ab]"""
        a, b = self.truth_lab[:, 1], self.truth_lab[:, 2]
        return float(np.sqrt(a * a + b * b).mean())

    def seen(self, matrices: Float[Array, "q 3 p"]) -> Float[Array, "q k 3"]:
        """X, Y, Z over those of the white; NaN where those are not above 0. [1]"""
        relative = matrices * self.white_e
        white = relative.sum(axis=-1, keepdims=True)
        known = (white > 0).all(axis=-2, keepdims=True)
        return self.patches @ np.swapaxes(relative / np.where(known, white, np.nan), -1, -2)

    def errors(self, seen: Float[Array, "q k 3"]) -> Float[Array, "q k"]:
        """Color error of each patch. [Delta E*ab]"""
        return cie1976_difference(self.truth_lab, balanced_cielab(seen))


@kept
def _chart_of(point: OperatingPoint) -> _Chart:
    white_e = electrons_at(point)
    reflectance = chart_on(point.sensor.grid, point.chart).values.T
    patches_e = electrons_at(point, reflectance=reflectance)
    return _Chart(
        truth_lab=truth_lab(point.illuminant, point.observer, point.chart),
        white_e=white_e,
        patches=patches_e / np.where(white_e > 0, white_e, 1.0),
        patches_e2=with_noise(patches_e, point.sensor, point.exposure).covariance,
    )


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class TradeOff:
    """Color error against color noise of one sensor, along its noise-aware matrices.

    Attributes
    ----------
    point
        Sensor, exposure and light.
    viewing
        Size and distance of the picture.
    weights
        Weights of the noise: 0 is least squares, infinity the matrix of least noise. Of up to five
        channels, one such family for every three or more that are used. [1]
    family
        Number of the family of each weight.
    matrices
        One per weight. [lx/e-]
    color_error
        Mean over the chart, without noise. [Delta E*ab]
    visual_noise
        Of an 18 % gray as viewed. [CIELUV]
    snr_y_db
        SNR of Y of a perfect white. [dB]
    """

    point: OperatingPoint
    viewing: Viewing
    weights: Float[Array, " q"]
    family: Int[Array, " q"]
    matrices: Float[Array, "q 3 p"]
    color_error: Float[Array, " q"]
    visual_noise: Float[Array, " q"]
    snr_y_db: Float[Array, " q"]

    def __post_init__(self) -> None:
        check.freeze(self, "weights", "family", "matrices", "color_error", "visual_noise")
        check.freeze(self, "snr_y_db")

    @property
    def least_color_error(self) -> float:
        """The least color error of its matrices. [Delta E*ab]"""
        return float(self.color_error.min())

    def front(self) -> Int[Array, " f"]:
        """Numbers of the matrices that none beats in both color error and visual noise.

        From the least to the most color error.
        """
        order = np.lexsort((self.visual_noise, self.color_error))
        noise = self.visual_noise[order]
        before = np.minimum.accumulate(np.concatenate([[math.inf], noise[:-1]]))
        return order[noise < before]

    def least_total_error(self) -> tuple[float, int]:
        """The least `total_error_as_viewed` of its matrices, and which has it. [Delta E*ab]"""
        at = np.arange(0, self.weights.size, _STRIDE)
        for _ in range(2):  # a part of the matrices first, then the neighbors of the best
            totals = total_error_as_viewed(self.point, self.matrices[at], self.viewing)
            best = int(at[np.argmin(totals)])
            at = np.arange(max(0, best - _STRIDE), min(self.weights.size, best + _STRIDE + 1))
        return float(totals.min()), best

    def place(self, color_error: float) -> float | None:
        """Where the least noise with at most that color error is; ``None`` where no matrix has it.

        A number between two weights is a place on the line between them: color errors, logarithms
        of the noise and SNRs are linear there.

        Parameters
        ----------
        color_error
            Mean over the chart. [Delta E*ab]
        """
        e = self.color_error
        inside = e <= color_error * (1 + _ROUNDING)
        if not inside.any():
            return None
        together = self.family[:-1] == self.family[1:]
        k = np.flatnonzero((inside[:-1] != inside[1:]) & together)
        edges = k + np.clip((color_error - e[k]) / (e[k + 1] - e[k]), 0.0, 1.0)
        places = [float(np.flatnonzero(inside)[np.argmin(self.visual_noise[inside])]), *edges]
        return float(min(places, key=self.noise_at))

    def noise_at(self, place: float) -> float:
        """Visual noise between two matrices. [CIELUV]

        Parameters
        ----------
        place
            Number of a matrix, or between two, as `place` gives it.
        """
        return math.exp(self.value_at(place, np.log(self.visual_noise)))

    def value_at(self, place: float, values: Float[Array, " q"]) -> float:
        """A value between two matrices, in the unit of ``values``.

        Parameters
        ----------
        place
            As `noise_at`.
        values
            One value of each matrix, in any unit.
        """
        return float(np.interp(place, np.arange(values.size), values))

    def noise_beyond_first_order_at(self, place: float) -> NoiseByTwoMeasures:
        """Noise of the gray at a place, beyond first order.

        Parameters
        ----------
        place
            As `noise_at`.
        """
        low, high, share = math.floor(place), math.ceil(place), place % 1
        matrix = (1 - share) * self.matrices[low] + share * self.matrices[high]
        sensor, exposure = self.point.sensor, self.point.exposure
        white_e = electrons_at(self.point)
        return noise_beyond_first_order(white_e, sensor, exposure, matrix, self.viewing)

    def channels_at(self, place: float) -> tuple[str, ...]:
        """Names of the channels that the matrix at a place uses.

        Parameters
        ----------
        place
            As `noise_at`.
        """
        used = self.matrices[math.floor(place)].any(axis=0)
        return tuple(name for name, one in zip(self.point.sensor.names, used, strict=True) if one)

    def weight_at(self, place: float) -> float:
        """The weight of the noise at a place. [1]

        Parameters
        ----------
        place
            As `noise_at`.
        """
        low, high = (float(self.weights[one]) for one in (math.floor(place), math.ceil(place)))
        share = place - math.floor(place)
        if low == 0 or math.isinf(high):
            return low if share < 0.5 else high
        return low ** (1 - share) * high**share


@dataclass(frozen=True, kw_only=True)
class Standing:
    """A sensor in a comparison at equal color error.

    Attributes
    ----------
    name, sensor
        Its name, and its label in sentences.
    visual_noise
        Of an 18 % gray as viewed. [CIELUV]
    behind_db
        That noise over the noise of the first sensor. [dB]
    gray_snr_db
        SNR of the best linear readout of that gray in the channels that the matrix uses. [dB]
    lost_in_matrix_db
        What its color matrix loses of that SNR more than the one of the first sensor does:
        ``behind_db`` plus its ``gray_snr_db`` minus that of the first. [dB]
    color_error, least_color_error
        Of the matrix, and the least of all noise-aware matrices. [Delta E*ab]
    least_total_error
        The least total color error as viewed of all noise-aware matrices. [Delta E*ab]
    is_lost
        Whether a gray picture without noise has less error than that.
    snr_y_db
        SNR of Y of a perfect white. [dB]
    weight
        Weight of the noise in the matrix. [1]
    channels
        Names of the channels that the matrix uses.
    """

    KEYS: ClassVar[JsonKeys] = (
        "name",
        JsonKey("label", "sensor"),
        *("visual_noise", "behind_db", "gray_snr_db", "lost_in_matrix_db"),
        *("color_error", "least_color_error", "least_total_error", "is_lost", "weight", "channels"),
    )

    name: str
    sensor: str
    visual_noise: float
    behind_db: float
    gray_snr_db: float
    lost_in_matrix_db: float
    color_error: float
    least_color_error: float
    least_total_error: float
    is_lost: bool
    snr_y_db: float
    weight: float
    channels: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """A sensor that cannot be compared at equal color error.

    Attributes
    ----------
    name, sensor
        Its name, and its label in sentences.
    why
        The reason, as the end of a sentence.
    """

    KEYS: ClassVar[JsonKeys] = ("name", JsonKey("label", "sensor"), "why")

    name: str
    sensor: str
    why: str


@dataclass(frozen=True, kw_only=True)
class Turn:
    """A range in which another sensor has less visual noise than the winner, beyond a tie.

    Attributes
    ----------
    over
        What varies: the light, with the exposure kept, or the color error.
    first, last
        Ends of the range. [lx, or Delta E*ab]
    winner, sensor
        Name of the other sensor, and its label in sentences.
    """

    KEYS: ClassVar[JsonKeys] = ("over", "first", "last", "winner", JsonKey("label", "sensor"))

    over: Literal["light [lx]", "color error [Delta E*ab]"]
    first: float
    last: float
    winner: str
    sensor: str


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class EqualColor:
    """Which sensor has the least visual noise at equal color error.

    Attributes
    ----------
    trade_offs
        One per compared sensor, in the order of the sensors.
    standings
        At ``at_color_error``, from least to most noise; empty where fewer than two sensors can be
        compared.
    at_color_error
        The least color error that all compared sensors reach. [Delta E*ab]
    margin_db
        Noise of the second sensor over that of the first. [dB]
    tie_db
        A margin of at most this is a tie. It is one where another sensor comes first with another
        training set, with 0.5 Delta E*ab more color error, with the visual noise beyond first
        order, or by S-CIELAB: the margin shrinks by as much. [dB]
    turns
        Where another sensor than the first has less noise; this and ties are sought among the 20
        sensors of least noise.
    levels_lux
        Lowest and highest light level that was compared; saturation ends the range. [lx]
    errors
        Least and largest color error that was compared. [Delta E*ab]
    colorless_error
        Mean color error of a gray picture without noise. [Delta E*ab]
    left_out
        The sensors that cannot be compared, with the reason.
    """

    trade_offs: tuple[TradeOff, ...]
    standings: tuple[Standing, ...] = ()
    at_color_error: float | None = None
    margin_db: float | None = None
    tie_db: float | None = None
    turns: tuple[Turn, ...] = ()
    levels_lux: tuple[float, float]
    errors: tuple[float, float] | None = None
    colorless_error: float
    left_out: tuple[LeftOut, ...]

    @property
    def is_tie(self) -> bool:
        """Whether the margin is within ``tie_db``."""
        return self.margin_db is not None and self.margin_db <= (self.tie_db or 0.0)

    @property
    def tied(self) -> tuple[Standing, ...]:
        """The first sensor, and those that tie with it."""
        return tuple(one for one in self.standings if one.behind_db <= (self.tie_db or 0.0))

    @property
    def limiting(self) -> Standing:
        """The sensor of the largest least color error: the others are compared at that."""
        return max(self.standings, key=lambda one: one.least_color_error)

    @property
    def winner(self) -> str | None:
        """Name of the first sensor; ``None`` for a tie, and where every color is lost in noise."""
        if not self.standings or self.is_tie or all(one.is_lost for one in self.standings):
            return None
        return self.standings[0].name


Reader = Literal["eye", "machine"]
_ANSWERS: Mapping[Reader, frozenset[str]] = {  # what the sentences for this reader are about
    "eye": frozenset(
        {"winner", "excluded", "why", "total", "lost", "turns", "matrix", "matrix order", "alone"}
    ),
    "machine": frozenset({"machine", "excluded", "alone"}),
}


class Told(NamedTuple):
    """A sentence of a verdict, and what it is about."""

    about: Literal[
        "winner",
        "excluded",
        "why",
        "total",
        "lost",
        "turns",
        "matrix",
        "matrix order",
        "matrix why",
        "matrix colors",
        "alone",
        "machine",
    ]
    text: str


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Verdict:
    """Which of several sensors is best for a reader, and why.

    Attributes
    ----------
    winner
        Name of the best sensor; ``None`` for a tie, where fewer than two can be compared, and
        where the colors of all are lost in the noise.
    margin_db
        For an eye, visual noise of the second over that of the first at equal color error; for a
        machine, median distance of the first over that of the second. [dB]
    at_color_error
        Color error at which the noise is compared; ``None`` for a machine. [Delta E*ab]
    reader
        Whether an eye or a machine judges the sensors.
    told
        The verdict in words, the answer first.
    prior
        Name of the training set of the compared matrices.
    at_equal_color
        The comparison at equal color error.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("winner", "margin_db", "at_color_error", "reader", "sentences", "prior"),
        JsonKey("tie_db", "at_equal_color.tie_db"),
        JsonKey("sensors", "at_equal_color.standings"),
        JsonKey("left_out", "at_equal_color.left_out"),
        JsonKey("turns", "at_equal_color.turns"),
        JsonKey("levels_lux", "at_equal_color.levels_lux"),
        JsonKey("color_errors", "at_equal_color.errors"),
        JsonKey("colorless_error", "at_equal_color.colorless_error"),
    )

    winner: str | None
    margin_db: float | None
    at_color_error: float | None
    reader: Reader
    told: tuple[Told, ...]
    prior: str
    at_equal_color: EqualColor

    @property
    def sentences(self) -> tuple[str, ...]:
        """The texts of ``told``."""
        return tuple(one.text for one in self.told)

    @property
    def answer(self) -> tuple[Told, ...]:
        """The sentences for this reader."""
        return tuple(one for one in self.told if self._answers(one))

    @property
    def details(self) -> tuple[Told, ...]:
        """The others: for the other reader, and what the matrix of the analyses costs and why."""
        return tuple(one for one in self.told if not self._answers(one))

    def _answers(self, one: Told) -> bool:
        first = self.told[0]  # for an eye, too, where a machine can read nothing
        reader = self.reader if first.about == "machine" else "eye"
        return one is first or one.about in _ANSWERS[reader]


def trade_off(
    point: OperatingPoint, *, prior: str | Spectra = DEFAULT_PRIOR, viewing: Viewing | None = None
) -> TradeOff | LeftOut:
    """The trade-off of a sensor, or why it has none.

    Parameters
    ----------
    point
        Sensor, exposure and light.
    prior
        The training set: a name from `PRIORS`, or reflectances on the grid. On a grid without
        infrared, the part of its name that varies the infrared is without effect.
    viewing
        Size and distance of the picture; ``None`` for those of `Viewing`.

    Raises
    ------
    InputError
        If there is no prior of that name.
    """
    return _trade_off(point, prior, viewing or USUAL_VIEWING)


@lru_cache(maxsize=256)  # by identity: verdict and chart of one answer ask for the same ones
def _trade_off(point: OperatingPoint, prior: str | Spectra, viewing: Viewing) -> TradeOff | LeftOut:
    (found,) = _along_light(point, (point.level_lux,), prior, viewing, _PER_DECADE)
    if isinstance(found, TradeOff) and _tells_colors(found):
        return found
    return _left_out(point, found if isinstance(found, str) else FEW_CHANNELS)


def _left_out(point: OperatingPoint, why: str) -> LeftOut:
    return LeftOut(name=point.sensor.name, sensor=point.sensor.label, why=why)


def _along_light(
    point: OperatingPoint,
    levels_lux: Sequence[float],
    prior: str | Spectra,
    viewing: Viewing,
    per_decade: int,
) -> list[TradeOff | str]:
    """The trade-off at each light level with the exposure kept, or why there is none."""
    sensor, exposure = point.sensor, point.exposure
    chart = _chart_of(point)
    why = NO_LIGHT if not chart.white_e.max() > 0 else ""
    if not np.isfinite(chart.truth_lab).all():
        why = NO_COLOR
    elif not chart.colorless_error >= _PALE:
        why = NO_CHART
    if why:
        return [why] * len(levels_lux)
    training = training_named(_on_grid(prior, sensor.grid), point.illuminant, point.observer)
    family = NoiseAwareFamily(sensor, exposure, training, level_lux=point.level_lux)
    factors = np.array(levels_lux) / point.level_lux
    white_e = factors[:, None] * chart.white_e
    hidden = np.any(coarsely_converted(GRAY * white_e, sensor, exposure), axis=-1)
    able = np.flatnonzero(~(hidden | saturated(white_e, sensor, exposure).any(axis=-1)))
    found: list[TradeOff | str] = [COARSE if one else SATURATED for one in hidden]
    if not able.size:
        return found
    lit = family.in_lights(factors[able])
    each = [lit, *(family.with_channels(lit, one) for one in _subsets(family.used))]
    by_level = list(zip(*each, strict=True))
    weights = [[one.weights(per_decade) for one in there] for there in by_level]
    matrices = np.concatenate(
        [
            one.matrices(own)
            for there, mine in zip(by_level, weights, strict=True)
            for one, own in zip(there, mine, strict=True)
        ]
    )
    counts = np.array([sum(one.size for one in mine) for mine in weights])
    place = np.repeat(np.arange(able.size), counts)
    at = place if able.size > 1 else 0
    color_error = chart.errors(chart.seen(matrices)).mean(axis=-1)
    given = (white_e[able], sensor, exposure)
    visual = noise_as_viewed(*given, matrices, viewing, place=at)
    row, in_e2 = matrices[:, None, 1], with_noise(*given).covariance[at]
    noise_lux = np.sqrt(((row @ in_e2) * row).sum(axis=(-1, -2)))
    white_lux = np.maximum((row[:, 0] * white_e[able][at]).sum(axis=-1), 0.0)  # below, no signal
    snr_y_db = decibel(white_lux / noise_lux)
    for k, mine in enumerate(weights):
        own, level_lux = place == k, levels_lux[able[k]]
        same = level_lux == point.level_lux
        found[able[k]] = TradeOff(
            point=point if same else replace(point, level_lux=level_lux),
            viewing=viewing,
            weights=np.concatenate(mine),
            family=np.repeat(np.arange(len(mine)), [one.size for one in mine]),
            matrices=matrices[own],
            color_error=color_error[own],
            visual_noise=visual[own],
            snr_y_db=snr_y_db[own],
        )
    return found


def _subsets(used: Bool[Array, " p"]) -> list[Bool[Array, " p"]]:
    """Every three or more of up to five channels: a sensor may leave a channel out."""
    at = np.flatnonzero(used)
    if at.size > _MOST_SUBSETS:
        return []
    chosen = [one for count in range(_COLORS, at.size) for one in combinations(at, count)]
    return [np.isin(np.arange(used.size), one) for one in chosen]


def total_error_as_viewed(
    point: OperatingPoint, matrices: Float[Array, "q 3 p"], viewing: Viewing
) -> Float[Array, " q"]:
    """Mean over the chart of the root of squared color error plus noise as viewed. [Delta E*ab]

    The noise counts L*, a* and b*, to first order, after the contrast sensitivity of the eye. NaN
    where X, Y or Z of the white is not above 0.

    Parameters
    ----------
    point
        Sensor, exposure and light.
    matrices
        Color matrices for that sensor and exposure. [lx/e-]
    viewing
        Size and distance of the picture.
    """
    chart = _chart_of(point)
    seen = chart.seen(matrices)
    known = np.isfinite(seen).all(axis=(-1, -2))
    white = np.where(known[:, None], matrices @ chart.white_e, 1.0)
    balanced = matrices / white[..., None]
    pairs = balanced[:, :, None, :, None] * balanced[:, None, :, None]
    weights = _lab_variance_weights(viewing.pixels_per_degree)
    of_slopes = weights @ pairs.reshape(len(matrices), _COLORS**2, -1) @ chart.flat_patches_e2
    slope = np.swapaxes(cube_root_slope(np.where(known[:, None, None], seen, 1.0)), -1, -2)
    slopes = (slope[:, :, None] * slope[:, None]).reshape(of_slopes.shape)
    return np.asarray(
        np.sqrt(chart.errors(seen) ** 2 + (of_slopes * slopes).sum(axis=1)).mean(axis=-1)
    )


@lru_cache(maxsize=32)
def _lab_variance_weights(pixels_per_degree: float) -> Float[Array, "9 9"]:
    """W of Var L* + Var a* + Var b* as viewed = sum f'_i f'_j w[ij, kl] C[k, l].

    C is the covariance of X, Y, Z in one pixel, f' the slopes of their cube roots.
    """
    each = np.eye(_COLORS**2).reshape(-1, _COLORS, _COLORS)
    viewed = viewed_covariance(each, pixels_per_degree=pixels_per_degree, samples=PLANE)
    of_lab = LAB_FROM_CUBE_ROOTS.T @ LAB_FROM_CUBE_ROOTS
    return check.frozen((viewed * of_lab).reshape(_COLORS**2, -1).T)


@dataclass(frozen=True, kw_only=True)
class LostColors:
    """A matrix whose colors are lost in the noise: a gray picture without noise has less error.

    Attributes
    ----------
    total_error, least_total_error
        Total color error as viewed: of the matrix, and the least of all noise-aware matrices.
        [Delta E*ab]
    colorless_error
        Mean color error of a gray picture without noise. [Delta E*ab]
    weight
        Weight of the noise in the matrix of the least error. [1]
    """

    total_error: float
    least_total_error: float
    colorless_error: float
    weight: float


def lost_colors(
    point: OperatingPoint, matrix: ColorMatrix, *, prior: str | Spectra = DEFAULT_PRIOR
) -> LostColors | None:
    """Whether a matrix loses the colors in the noise.

    ``None`` where it does not, or the sensor has no trade-off or fewer than three independent
    channels.

    Parameters
    ----------
    point
        Sensor, exposure and light.
    matrix
        The color matrix. [lx/e-]
    prior
        The training set of the noise-aware matrices.
    """
    colorless = _chart_of(point).colorless_error
    own = float(total_error_as_viewed(point, matrix.matrix[None], USUAL_VIEWING)[0])
    if not own >= colorless:
        return None
    trade = trade_off(point, prior=prior)
    if isinstance(trade, LeftOut):
        return None
    least, best = trade.least_total_error()
    return LostColors(
        total_error=own,
        least_total_error=least,
        colorless_error=colorless,
        weight=float(trade.weights[best]),
    )


def equal_color(
    points: Sequence[OperatingPoint],
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
    viewing: Viewing | None = None,
    turns: bool = True,
) -> EqualColor:
    """Which sensor has the least visual noise at equal color error.

    Parameters
    ----------
    points
        Sensors with their exposures, in one light and for one observer and chart.
    prior
        The training set: a name from `PRIORS`, or reflectances on the grid.
    viewing
        Size and distance of the picture; ``None`` for those of `Viewing`.
    turns
        Whether other light levels and color errors are compared, too.

    Raises
    ------
    InputError
        If there is no prior of that name, or the points differ in light, observer or chart.
    """
    _refuse_other_light(points)
    found = [trade_off(point, prior=prior, viewing=viewing) for point in points]
    trades, beyond = _of_a_common_error([one for one in found if isinstance(one, TradeOff)])
    left_out = tuple(one for one in found if isinstance(one, LeftOut)) + beyond
    colorless, level = _chart_of(points[0]).colorless_error, points[0].level_lux
    if len(trades) < 2:
        return EqualColor(
            trade_offs=trades,
            levels_lux=(level, level),
            colorless_error=colorless,
            left_out=left_out,
        )
    least = _common_error(trades)
    most = min(float(one.color_error.max()) for one in trades)
    places = [_reached(one, least) for one in trades]
    noise = np.array([one.noise_at(at) for one, at in zip(trades, places, strict=True)])
    order = np.argsort(noise, kind="stable")
    behind_db = decibel(noise / noise[order[0]])
    margin_db = float(behind_db[order[1]])
    near = np.sort(order[:MOST_CHECKED])
    nearest, first = [trades[k] for k in near], int(np.searchsorted(near, order[0]))
    again_db = _again_db(nearest, first, prior, least, most)
    near_db = behind_db[near]
    shrinks_db = np.maximum(LEAST_TIE_DB, (near_db - again_db).max(axis=0))
    others = np.argsort(near_db, kind="stable")[1:]
    tied_db = shrinks_db[others][near_db[others] <= shrinks_db[others]]
    tie_db = float(tied_db.max() if tied_db.size else shrinks_db[others[0]])
    changes_db = np.maximum(LEAST_TIE_DB, np.abs(near_db - again_db).max(axis=0))
    lit, errors = [level], np.linspace(least, most, _ERRORS)
    found_turns: list[Turn] = []
    if turns:
        by_light = _by_light(nearest, prior)
        lit = sorted(by_light)
        levels, same = [by_light[one] for one in lit], [nearest] * _ERRORS
        common = [_common_error(one) for one in levels]
        found_turns = [
            *_turns("light [lx]", lit, levels, common, first, changes_db, colorless),
            *_turns("color error [Delta E*ab]", errors, same, errors, first, changes_db, colorless),
        ]
    snr_db = np.array([_gray_snr_db(*one) for one in zip(trades, places, strict=True)])
    lost_db = behind_db + (snr_db - snr_db[order[0]])
    numbers = np.stack([behind_db, snr_db, lost_db], axis=-1).tolist()
    every = [
        _standing(trade, at, colorless, *own)
        for trade, at, own in zip(trades, places, numbers, strict=True)
    ]
    return EqualColor(
        trade_offs=trades,
        standings=tuple(every[k] for k in order),
        at_color_error=least,
        margin_db=margin_db,
        tie_db=tie_db,
        turns=tuple(found_turns),
        levels_lux=(min(lit), max(lit)),
        errors=(least, most),
        colorless_error=colorless,
        left_out=left_out,
    )


def _of_a_common_error(
    trades: Sequence[TradeOff],
) -> tuple[tuple[TradeOff, ...], tuple[LeftOut, ...]]:
    """Those that reach a common color error, and those with more than another one can have."""
    kept, beyond = list(trades), list[LeftOut]()
    while len(kept) > 1:
        worst = max(kept, key=lambda one: one.least_color_error)
        if worst.least_color_error <= min(float(one.color_error.max()) for one in kept):
            break
        kept.remove(worst)
        why = f"its least color error, {worst.least_color_error:.1f} ΔE*ab, is above all of another"
        beyond.append(_left_out(worst.point, why))
    return tuple(kept), tuple(beyond)


def _refuse_other_light(points: Sequence[OperatingPoint]) -> None:
    first = points[0]
    for one in points[1:]:
        same = (
            one.level_lux == first.level_lux
            and one.observer == first.observer
            and np.array_equal(one.illuminant.irradiance, first.illuminant.irradiance)
            and one.chart is first.chart
        )
        if not same:
            raise InputError(
                "sensors that are compared at equal color error",
                "must have one light, observer and chart",
                value=one.sensor.label,
                found=f"differ in these: {first.sensor.label} and {one.sensor.label}",
            )


def _standing(
    trade: TradeOff,
    place: float,
    colorless: float,
    behind_db: float,
    gray_snr_db: float,
    lost_in_matrix_db: float,
) -> Standing:
    total, _ = trade.least_total_error()
    return Standing(
        name=trade.point.sensor.name,
        sensor=trade.point.sensor.label,
        visual_noise=trade.noise_at(place),
        behind_db=behind_db,
        gray_snr_db=gray_snr_db,
        lost_in_matrix_db=lost_in_matrix_db,
        color_error=trade.value_at(place, trade.color_error),
        least_color_error=trade.least_color_error,
        least_total_error=total,
        is_lost=total >= colorless,
        snr_y_db=trade.value_at(place, trade.snr_y_db),
        weight=trade.weight_at(place),
        channels=trade.channels_at(place),
    )


def _gray_snr_db(trade: TradeOff, place: float) -> float:
    point, channels = trade.point, trade.channels_at(place)
    gray = with_noise(GRAY * electrons_at(point), point.sensor, point.exposure)
    used = np.flatnonzero(np.isin(gray.names, channels))
    of_used = replace(
        gray,
        mean=gray.mean[used],
        covariance=gray.covariance[np.ix_(used, used)],
        names=channels,
        reading_variance=None,
    )
    return float(optimal_linear_snr_db(of_used))


def _noises(trades: Sequence[TradeOff], color_error: float) -> Float[Array, " s"]:
    """Visual noise of each sensor at a color error that all reach. [CIELUV]"""
    return np.array([one.noise_at(_reached(one, color_error)) for one in trades])


def _reached(trade: TradeOff, color_error: float) -> float:
    place = trade.place(color_error)
    assert place is not None  # an error that it reaches
    return place


def _common_error(trades: Sequence[TradeOff]) -> float:
    """The least color error that all reach. [Delta E*ab]"""
    return max(one.least_color_error for one in trades)


def _again_db(
    trades: Sequence[TradeOff], first: int, prior: str | Spectra, least: float, most: float
) -> Float[Array, "4 s"]:
    """Noise over that of the first sensor by other conventions. [dB]

    With another training set, with a little more color error, beyond first order, and by S-CIELAB.
    """
    own = _on_grid(prior, trades[0].point.sensor.grid)
    other = _on_grid(_SECOND_PRIOR, trades[0].point.sensor.grid)
    second = "chart" if own == other else other
    again = [trade_off(one.point, prior=second, viewing=one.viewing) for one in trades]
    able = [  # one that has no trade-off with it keeps its own
        two if isinstance(two, TradeOff) else one for one, two in zip(trades, again, strict=True)
    ]
    more = _noises(trades, min(least + HARDLY_SEEN_DELTA_E, most))
    again_noise = _noises(able, _common_error(able))
    noise = np.stack([again_noise, more, *_noises_beyond(trades, least)])
    return decibel(noise / noise[:, [first]])


def _noises_beyond(trades: Sequence[TradeOff], color_error: float) -> Float[Array, "2 s"]:
    """Beyond first order, at a color error that all reach. [CIELUV, Delta E*ab]"""
    return np.transpose(
        [one.noise_beyond_first_order_at(_reached(one, color_error)) for one in trades]
    )


def _on_grid(prior: str | Spectra, grid: Grid) -> str | Spectra:
    """The prior; without other infrared values where the grid has no infrared."""
    if isinstance(prior, Spectra) or is_infrared(grid).sum() > 1:
        return prior
    return prior.removesuffix("-nir")


def _tells_colors(trade: TradeOff) -> bool:
    """Whether its matrices span three colors."""
    scale = np.linalg.norm(trade.matrices[0], axis=0)
    relative = trade.matrices[0] / np.where(scale > 0, scale, 1.0)
    return bool(matrix_rank(f"matrix of {trade.point.sensor.name}", relative) >= _COLORS)


def _by_light(trades: Sequence[TradeOff], prior: str | Spectra) -> dict[float, Sequence[TradeOff]]:
    """The trade-offs at each level at which no sensor is saturated."""
    points = [replace(one.point, level_lux=_ANY_LUX, pairs=None) for one in trades]
    full_at = (fullest_level_lux(one) for one in points)
    fullest = min(_LEVELS_LUX[-1], *(one for one in full_at if one is not None))
    levels = tuple(sorted({*(one for one in _LEVELS_LUX if one <= fullest), fullest}))
    along = [
        _lit(tuple(getattr(one, each.name) for each in fields(one)), levels, prior, trade.viewing)
        for one, trade in zip(points, trades, strict=True)
    ]
    found: dict[float, Sequence[TradeOff]] = {}
    for level, *there in zip(levels, *along, strict=True):
        able = [one for one in there if isinstance(one, TradeOff)]
        if len(able) == len(trades):
            found[level] = able
    return found | {trades[0].point.level_lux: trades}


@lru_cache(maxsize=MOST_CHECKED)  # sensors by identity: the same while only the level moves
def _lit(
    point: tuple[Any, ...], levels_lux: tuple[float, ...], prior: str | Spectra, viewing: Viewing
) -> list[TradeOff | str]:
    names = (one.name for one in fields(OperatingPoint))
    dark = OperatingPoint(**dict(zip(names, point, strict=True)))
    return _along_light(dark, levels_lux, prior, viewing, _COARSE)


def _turns(
    over: Literal["light [lx]", "color error [Delta E*ab]"],
    at: Sequence[float] | Float[Array, " l"],
    trades: Sequence[Sequence[TradeOff]],
    errors: Sequence[float] | Float[Array, " l"],
    first: int,
    tie_db: Float[Array, " s"],
    colorless: float,
) -> list[Turn]:
    """Ranges in which another sensor has less noise than the first one, by more than its tie.

    It has less beyond first order and by S-CIELAB, too, and color is not lost in the noise of all.
    Sensors are compared at these color errors.
    """
    noise = np.stack([_noises(there, one) for there, one in zip(trades, errors, strict=True)])
    scale, back = (np.log, math.exp) if over == "light [lx]" else (np.asarray, float)
    where, level_db = scale(np.asarray(at)), decibel(noise)
    best = level_db.argmin(axis=1)

    def sure(k: int) -> int | None:
        leader = int(best[k])
        if leader == first:
            return first
        beyond = _noises_beyond([trades[k][first], trades[k][leader]], errors[k])
        if all(one.least_total_error()[0] >= colorless for one in trades[k]):
            return None
        return leader if (beyond[:, 1] < beyond[:, 0]).all() else None

    def edge(k: int) -> float:
        """Between k and k + 1, where the leaders of both are level."""
        lead = level_db[k : k + 2, best[k + 1]] - level_db[k : k + 2, best[k]]
        return back(float(where[k] + (where[k + 1] - where[k]) * lead[0] / (lead[0] - lead[1])))

    def end(k: int, beside: int) -> float:
        """The end of a range at ``k``: where the next sensor is level, or at ``k`` itself."""
        inside = 0 <= beside < len(best) and best[beside] != best[k]
        return edge(min(k, beside)) if inside else float(at[k])

    turns = []
    for leader, group in groupby(range(len(best)), key=sure):
        k = list(group)
        if leader in (None, first):
            continue
        if (level_db[k, first] - level_db[k, leader]).max() > tie_db[leader]:
            sensor = trades[0][leader].point.sensor
            turns.append(
                Turn(
                    over=over,
                    first=end(k[0], k[0] - 1),
                    last=end(k[-1], k[-1] + 1),
                    winner=sensor.name,
                    sensor=sensor.label,
                )
            )
    return turns
