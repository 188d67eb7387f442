"""Sensors compared at equal color error: trade-offs, the winner, and where the order turns.

A color matrix trades color error for noise, so the noise of one matrix compares two things at once.
Each sensor therefore runs along its own `NoiseAwareFamily`, and the noise is compared where the
color errors are equal: at the least error that all sensors reach. The noise is that of a gray as
viewed (visual noise of ISO 15739).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar, Literal

import numpy as np

from chromanoise.base import Array, Float, JsonKey, JsonKeys, check, decibel, with_short_repr
from chromanoise.color import (
    LAB,
    ColorMatrix,
    NoiseAwareFamily,
    balanced_cielab,
    cie1976_difference,
)
from chromanoise.metrics import balanced_charts, balanced_truth, viewed_covariance
from chromanoise.noise import OperatingPoint, saturated, with_noise
from chromanoise.spectra import Grid, Spectra, chart_on, is_infrared
from chromanoise.study.analysis import electrons_at
from chromanoise.study.color_matrices import DEFAULT_PRIOR, training_named
from chromanoise.study.color_noise import PLANE, Viewing, noise_as_viewed

SECOND_PRIOR = "smooth-50-nir"
"""Training set with which the margin is computed once more; the difference bounds a tie."""
LEVELS_LUX = tuple(float(one) for one in np.geomspace(0.01, 1000.0, 11))
"""Light levels at which the order is checked. [lx]"""
LEAST_TIE_DB = 0.05
"""A margin below one decimal is a tie. [dB]"""
_COLORS = 3  # independent channels of a sensor that tells colors apart
_ERRORS = 17  # color errors at which the order is checked


@with_short_repr
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TradeOff:
    """Color error against color noise of one sensor, along its noise-aware matrices.

    Attributes
    ----------
    point
        Sensor, exposure and light.
    weight
        Weights of the noise: 0 is least squares, infinity the matrix of least noise. [1]
    matrix
        One per weight. [lx/e-]
    color_error
        Mean over the chart, without noise. [Delta E*ab]
    noise
        Visual noise of an 18 % gray as viewed. [CIELUV]
    snr_y_db
        SNR of Y of a perfect white. [dB]
    viewing
        Size and distance of the picture.
    """

    point: OperatingPoint
    weight: Float[Array, " q"]
    matrix: Float[Array, "q 3 p"]
    color_error: Float[Array, " q"]
    noise: Float[Array, " q"]
    snr_y_db: Float[Array, " q"]
    viewing: Viewing

    def __post_init__(self) -> None:
        check.freeze(self, "weight", "matrix", "color_error", "noise", "snr_y_db")

    @property
    def least_color_error(self) -> float:
        """The least color error of its matrices. [Delta E*ab]"""
        return float(self.color_error.min())

    def total_error(self) -> Float[Array, " q"]:
        """`total_error_as_viewed` of each matrix. [Delta E*ab]"""
        return total_error_as_viewed(self.point, self.matrix, self.viewing)

    @property
    def gray_error(self) -> float:
        """Color error of the matrix of least noise, whose picture is gray. [Delta E*ab]"""
        return float(self.color_error[-1])

    def at(self, color_error: float) -> "Standing | None":
        """The least noise with at most that color error; ``None`` where no matrix has it.

        Between two weights, errors are linear, and so are the logarithms of the noise.

        Parameters
        ----------
        color_error
            Mean over the chart. [Delta E*ab]
        """
        e, inside = self.color_error, self.color_error <= color_error
        if not inside.any():
            return None
        k = np.flatnonzero(inside[:-1] != inside[1:])
        edges = k + (color_error - e[k]) / (e[k + 1] - e[k])
        places = [float(np.flatnonzero(inside)[np.argmin(self.noise[inside])]), *edges.tolist()]
        return min((self._standing(place) for place in places), key=lambda one: one.noise)

    def _standing(self, place: float) -> "Standing":
        at = np.arange(self.weight.size)

        def value(of: Float[Array, " q"]) -> float:
            return float(np.interp(place, at, of))

        return Standing(
            sensor=self.point.sensor.label,
            noise=math.exp(value(np.log(self.noise))),
            color_error=value(self.color_error),
            least_color_error=self.least_color_error,
            snr_y_db=value(self.snr_y_db),
            weight=_weight(self.weight, place),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """A sensor at one color error.

    Attributes
    ----------
    sensor
        Its label.
    noise
        Visual noise of an 18 % gray as viewed. [CIELUV]
    color_error, least_color_error
        Of the matrix, and the least of all matrices. [Delta E*ab]
    snr_y_db
        SNR of Y of a perfect white. [dB]
    weight
        Weight of the noise in the matrix. [1]
    """

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("name", "sensor"),
        *("noise", "color_error", "least_color_error", "snr_y_db", "weight"),
    )

    sensor: str
    noise: float
    color_error: float
    least_color_error: float
    snr_y_db: float
    weight: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """A range in which another sensor has the least noise.

    Attributes
    ----------
    over
        What varies.
    first, last
        Ends of the range: illuminances [lx] or color errors [Delta E*ab].
    winner
        Label of the sensor.
    """

    KEYS: ClassVar[JsonKeys] = ("over", "first", "last", "winner")

    over: Literal["light", "color error"]
    first: float
    last: float
    winner: str


@with_short_repr
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EqualColor:
    """Which sensor has the least color noise at equal color error.

    Attributes
    ----------
    trade_offs
        One per sensor that tells colors apart.
    standings
        At ``at_color_error``, from least to most noise.
    at_color_error
        The least color error that all these sensors reach. [Delta E*ab]
    margin_db
        Noise of the second over that of the first. [dB]
    tie_db
        Margins of this size are a tie: the margins of two training sets differ by as much. [dB]
    turns
        Where another sensor than the winner has the least noise.
    levels_lux
        Lowest and highest light level that was compared; a saturated sensor ends the range. [lx]
    errors
        Least and largest color error that all sensors have. [Delta E*ab]
    left_out
        Sensors with fewer than three independent channels.
    least_total_errors
        Least `TradeOff.total_error` of each sensor, in the order of ``standings``. [Delta E*ab]
    lost
        Sensors whose color is lost in the noise: a gray picture is nearer to the true colors.
    """

    trade_offs: tuple[TradeOff, ...]
    standings: tuple[Standing, ...]
    at_color_error: float
    margin_db: float
    tie_db: float
    turns: tuple[Turn, ...]
    levels_lux: tuple[float, float]
    errors: tuple[float, float]
    left_out: tuple[str, ...]
    least_total_errors: tuple[float, ...]
    lost: tuple[str, ...]

    @property
    def winner(self) -> str:
        """Label of the sensor of least noise."""
        return self.standings[0].sensor

    @property
    def margins_db(self) -> tuple[float, ...]:
        """Noise of each sensor over that of the winner, in the order of ``standings``. [dB]"""
        return tuple(20 * math.log10(one.noise / self.standings[0].noise) for one in self.standings)

    @property
    def is_tie(self) -> bool:
        """Whether the margin is within what the training set decides."""
        return self.margin_db <= self.tie_db


Reader = Literal["eye", "machine"]


@with_short_repr
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Verdict:
    """Which of several sensors is best for a reader, and why.

    Attributes
    ----------
    winner
        Label of the best sensor; ``None`` where fewer than two can be compared, or for a tie.
    margin_db
        For an eye, color noise of the second over that of the best at equal color error; for a
        machine, median distance of the best over that of the second. [dB]
    at_color_error
        Color error at which the noise is compared; ``None`` for a machine. [Delta E*ab]
    reader
        Who judges.
    sentences
        The verdict in words, the answer first.
    equal
        The comparison at equal color error; ``None`` where fewer than two sensors tell colors
        apart.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("winner", "margin_db", "at_color_error", "reader", "sentences"),
        JsonKey("tie_db", "equal.tie_db"),
        JsonKey("sensors", "equal.standings"),
        JsonKey("least_total_errors", "equal.least_total_errors"),
        JsonKey("turns", "equal.turns"),
        JsonKey("lost", "equal.lost"),
    )

    winner: str | None
    margin_db: float | None
    at_color_error: float | None
    reader: Reader
    sentences: tuple[str, ...]
    equal: EqualColor | None


def trade_off(
    point: OperatingPoint, *, prior: str | Spectra = DEFAULT_PRIOR, viewing: Viewing | None = None
) -> TradeOff | None:
    """The trade-off of a sensor; ``None`` where a channel is saturated on the white or sees none.

    Parameters
    ----------
    point
        Sensor, exposure and light.
    prior
        The training set: a name from `PRIORS`, or reflectances on the grid.
    viewing
        Size and distance of the picture; ``None`` for those of `Viewing`.

    Raises
    ------
    InputError
        If there is no prior of that name.
    """
    return trade_offs_in_light(point, (point.level_lux,), prior=prior, viewing=viewing)[0]


def trade_offs_in_light(
    point: OperatingPoint,
    levels_lux: Sequence[float],
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
    viewing: Viewing | None = None,
) -> list[TradeOff | None]:
    """The trade-offs of a sensor at several light levels, with the exposure kept.

    Parameters
    ----------
    point
        Sensor and exposure; its level is ignored.
    levels_lux
        Illuminances. [lx]
    prior, viewing
        As `trade_off`.

    Raises
    ------
    InputError
        As `trade_off`.
    """
    sensor, exposure = point.sensor, point.exposure
    here_e = electrons_at(point)
    if not here_e.max() > 0:
        return [None] * len(levels_lux)
    prior = _on_grid(prior, sensor.grid)
    training = training_named(prior, point.illuminant, point.observer)
    family = NoiseAwareFamily(sensor, exposure, training, level_lux=point.level_lux)
    chart = chart_on(sensor.grid, point.chart).values.T
    patches = electrons_at(point, reflectance=chart) / np.where(here_e > 0, here_e, 1.0)
    truth = balanced_cielab(balanced_truth(point))
    found: list[TradeOff | None] = []
    viewing = viewing or Viewing()
    for level in levels_lux:
        factor = level / point.level_lux
        white_e = factor * here_e
        if saturated(white_e, sensor, exposure).any():
            found.append(None)
            continue
        there = family if factor == 1 else family.in_light(factor)
        weight = there.weights()
        matrix = there.matrices(weight)
        relative = matrix * here_e
        seen = patches @ np.swapaxes(relative / relative.sum(axis=-1, keepdims=True), -1, -2)
        errors = cie1976_difference(truth, balanced_cielab(seen))
        in_e2 = with_noise(white_e, sensor, exposure).covariance
        luminance = matrix[:, 1]
        variance = ((luminance @ in_e2) * luminance).sum(axis=-1)
        found.append(
            TradeOff(
                point=point if factor == 1 else replace(point, level_lux=level),
                weight=weight,
                matrix=matrix,
                color_error=errors.mean(axis=-1),
                noise=noise_as_viewed(white_e, sensor, exposure, matrix, viewing),
                snr_y_db=decibel(luminance @ white_e / np.sqrt(variance)),
                viewing=viewing,
            )
        )
    return found


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
    sensor, exposure = point.sensor, point.exposure
    truth, seen = balanced_charts(
        sensor, matrices, exposure, point.illuminant, point.observer, point.chart
    )
    errors = cie1976_difference(balanced_cielab(truth), balanced_cielab(seen))
    known = np.isfinite(errors).all(axis=-1)
    white = np.where(known[:, None], matrices @ electrons_at(point), 1.0)
    balanced = matrices / white[..., None]
    patches_e = electrons_at(point, reflectance=chart_on(sensor.grid, point.chart).values.T)
    in_e2 = with_noise(patches_e, sensor, exposure).covariance
    in_pixel = balanced[:, None] @ in_e2 @ np.swapaxes(balanced, -1, -2)[:, None]
    viewed = viewed_covariance(in_pixel, pixels_per_degree=viewing.pixels_per_degree, samples=PLANE)
    to_lab = LAB.jacobian(np.where(known[:, None, None], seen, 1.0), np.ones(3))
    spread = np.einsum("qkia,qkab,qkib->qk", to_lab, viewed, to_lab)
    return np.asarray(np.sqrt(errors**2 + spread).mean(axis=-1))


@dataclass(frozen=True, slots=True, kw_only=True)
class LostColors:
    """A matrix whose picture is farther from the true colors than a gray picture.

    Attributes
    ----------
    total_error, least_total_error
        Mean of the roots of squared color error plus noise as viewed: of the matrix, and the least
        of all noise-aware matrices. [Delta E*ab]
    weight
        Weight of the noise in the matrix of the least error. [1]
    """

    total_error: float
    least_total_error: float
    weight: float


def lost_colors(
    point: OperatingPoint, matrix: ColorMatrix, *, prior: str | Spectra = DEFAULT_PRIOR
) -> LostColors | None:
    """Whether a matrix loses the colors in the noise; ``None`` where it does not.

    Parameters
    ----------
    point
        Sensor, exposure and light.
    matrix
        The color matrix. [lx/e-]
    prior
        The training set of the noise-aware matrices.
    """
    trade = trade_off(point, prior=prior)
    if trade is None:
        return None
    own = float(total_error_as_viewed(point, matrix.matrix[None], trade.viewing)[0])
    if not own >= trade.gray_error:
        return None
    totals = trade.total_error()
    best = int(np.argmin(totals))
    return LostColors(
        total_error=own, least_total_error=float(totals[best]), weight=float(trade.weight[best])
    )


def equal_color(
    points: Sequence[OperatingPoint],
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
    viewing: Viewing | None = None,
    turns: bool = True,
) -> EqualColor | None:
    """Which sensor has the least color noise at equal color error.

    ``None`` where fewer than two sensors tell colors apart.

    Parameters
    ----------
    points
        Sensors with their exposures in one light.
    prior
        The training set: a name from `PRIORS`, or reflectances on the grid.
    viewing
        Size and distance of the picture; ``None`` for those of `Viewing`.
    turns
        Whether other light levels and color errors are compared, too.

    Raises
    ------
    InputError
        If there is no prior of that name.
    """
    found = [trade_off(point, prior=prior, viewing=viewing) for point in points]
    trades = tuple(one for one in found if one is not None and _tells_colors(one))
    if len(trades) < 2:
        return None
    least, standings = _standings(trades)
    able = [one.point for one in trades]
    other = [trade_off(one, prior=_second(prior), viewing=viewing) for one in able]
    margin_db = _margin_db(standings)
    tie_db = LEAST_TIE_DB
    if all(one is not None for one in other):
        again = {one.sensor: one.noise for one in _standings([o for o in other if o])[1]}
        first, second = (again[one.sensor] for one in standings[:2])
        tie_db = max(tie_db, abs(margin_db - 20 * math.log10(second / first)))
    most = min(float(one.color_error.max()) for one in trades)
    totals = {one.point.sensor.label: float(one.total_error().min()) for one in trades}
    lit = []
    found_turns: list[Turn] = []
    if turns:
        by_light = _by_light(able, prior, viewing)
        lit = [level for level, _ in by_light]
        found_turns = [
            *_turns("light", by_light, standings[0].sensor, logarithmic=True),
            *_turns("color error", _by_error(trades, least, most), standings[0].sensor),
        ]
    level = able[0].level_lux
    return EqualColor(
        trade_offs=trades,
        standings=standings,
        at_color_error=least,
        margin_db=margin_db,
        tie_db=tie_db,
        turns=tuple(found_turns),
        levels_lux=(min(lit, default=level), max(lit, default=level)),
        errors=(least, most),
        left_out=tuple(
            one.point.sensor.label for one in found if one is not None and not _tells_colors(one)
        ),
        least_total_errors=tuple(totals[one.sensor] for one in standings),
        lost=tuple(
            one.point.sensor.label
            for one in trades
            if totals[one.point.sensor.label] >= one.gray_error
        ),
    )


_Noises = dict[str, float]


def _standings(trades: Sequence[TradeOff]) -> tuple[float, tuple[Standing, ...]]:
    """The least color error that all reach, and the sensors there from least to most noise."""
    least = max(one.least_color_error for one in trades)
    found = [standing for one in trades if (standing := one.at(least)) is not None]
    return least, tuple(sorted(found, key=lambda one: one.noise))


def _margin_db(standings: Sequence[Standing]) -> float:
    return 20 * math.log10(standings[1].noise / standings[0].noise)


def _second(prior: str | Spectra) -> str:
    return DEFAULT_PRIOR if prior == SECOND_PRIOR else SECOND_PRIOR


def _on_grid(prior: str | Spectra, grid: Grid) -> str | Spectra:
    """The prior; without other infrared values where the grid has no infrared."""
    has_infrared = is_infrared(grid).sum() > 1
    if isinstance(prior, Spectra) or has_infrared:
        return prior
    return prior.removesuffix("-nir")


def _tells_colors(trade: TradeOff) -> bool:
    """Whether its matrices span three colors."""
    scale = np.linalg.norm(trade.matrix[0], axis=0)
    rank = np.linalg.matrix_rank(trade.matrix[0] / np.where(scale > 0, scale, 1.0))
    return bool(rank >= _COLORS)


def _by_light(
    points: Sequence[OperatingPoint], prior: str | Spectra, viewing: Viewing | None
) -> list[tuple[float, _Noises]]:
    """Noise of each sensor at equal color error, at each level at which none is saturated."""
    levels = sorted({*LEVELS_LUX, points[0].level_lux})
    along = [trade_offs_in_light(one, levels, prior=prior, viewing=viewing) for one in points]
    found = []
    for level, *trades in zip(levels, *along, strict=True):
        there = [one for one in trades if one is not None]
        if len(there) == len(points):
            _, standings = _standings(there)
            found.append((level, {one.sensor: one.noise for one in standings}))
    return found


def _by_error(trades: Sequence[TradeOff], least: float, most: float) -> list[tuple[float, _Noises]]:
    return [
        (error, {one.sensor: one.noise for trade in trades if (one := trade.at(error))})
        for error in np.linspace(least, most, _ERRORS).tolist()
    ]


def _turns(
    over: Literal["light", "color error"],
    along: Sequence[tuple[float, _Noises]],
    winner: str,
    *,
    logarithmic: bool = False,
) -> list[Turn]:
    """Ranges in which another sensor has less noise than the winner, by more than a tie."""
    scale: Callable[[float], float] = math.log if logarithmic else float
    back: Callable[[float], float] = math.exp if logarithmic else float
    turns: list[Turn] = []
    lead = [(at, min(noises, key=lambda name: noises[name]), noises) for at, noises in along]
    start = lead[0][0] if lead else 0.0
    for (at, name, noises), (then, following, others) in pairwise(lead):
        if following == name:
            continue
        before = math.log(noises[following] / noises[name])
        after = math.log(others[name] / others[following])
        share = before / (before + after) if before + after > 0 else 0.5
        edge = back(scale(at) + share * (scale(then) - scale(at)))
        turns.append(Turn(over=over, first=start, last=edge, winner=name))
        start = edge
    if lead:
        turns.append(Turn(over=over, first=start, last=lead[-1][0], winner=lead[-1][1]))
    return [one for one in turns if one.winner != winner]


def _weight(weights: Float[Array, " q"], place: float) -> float:
    """The weight at a place between two of a grid, whose ends are 0 and infinity."""
    low, high = float(weights[math.floor(place)]), float(weights[math.ceil(place)])
    if low == 0 or not math.isfinite(high):
        return low if place - math.floor(place) < 0.5 else high
    share = place - math.floor(place)
    return low ** (1 - share) * high**share
