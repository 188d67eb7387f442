"""Ranks of sensors, crossovers where two are equally good, and where each is best.

A crossover over spectral priors shows how the sensor that wins depends on what a trained matrix
expects. Over a sweep, the best sensor of each range and the best value of each sensor are listed.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, pairwise, starmap
from typing import Any, ClassVar, Literal, TypeVar

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    InputError,
    Int,
    JsonKey,
    JsonKeys,
    dataclass,
    with_short_repr,
)
from chromanoise.io import number_text
from chromanoise.noise import OperatingPoint
from chromanoise.spectra import Metric
from chromanoise.study.color_matrices import PRIORS, MatrixFunction, matrix_makers, trained_names
from chromanoise.study.sweeps import (
    SNR_Y,
    SWEEPS,
    Curve,
    OfSensor,
    Quantity,
    Sweep,
    by_matrix,
    color_error,
    compared,
)

TIE = 1e-9
"""Values that differ by at most this are equal. [unit of the quantity]"""
_CROSSING_TOLERANCE = 1e-9  # of the logarithm of the value, or of the span of a linear sweep
_OPTIMUM_TOLERANCE = 1e-6  # likewise
_MOST_NAMED = 3  # sensors that a sentence on the best values names


@with_short_repr
@dataclass(frozen=True, kw_only=True)
class Crossover:
    """Where two sensors with the same matrix are equally good.

    Attributes
    ----------
    first, second, matrix
        Names of the two sensors and of the matrix.
    labels
        Names of first and second in sentences.
    sweep, quantity
        The parameter that varies, and the quantity.
    at
        Where the sign of their difference changes; empty if it never does. [unit of the sweep]
    color_error
        Of first and second at each of these, to report beside an SNR; NaN where it is not
        defined. [Delta E*ab]
    better_first
        The better sensor at the lowest common value of the sweep; ``None`` if they are equal
        throughout.
    first_at, last_at
        The range in which both have a value. [unit of the sweep]
    """

    KEYS: ClassVar[JsonKeys] = (
        *("first", "second", "matrix", "better_first", "first_at", "last_at", "at", "color_error"),
        JsonKey("sentence", lambda one: crossover_sentence(one), text="The same in words."),
    )

    first: str
    second: str
    matrix: str
    labels: tuple[str, str]
    sweep: Sweep
    quantity: Quantity
    at: tuple[float, ...]
    color_error: tuple[tuple[float, float], ...]
    better_first: str | None
    first_at: float
    last_at: float


@dataclass(frozen=True, kw_only=True)
class Incomparable:
    """Two sensors that have no common value of the sweep at which the quantity is defined.

    Attributes
    ----------
    labels
        Names of first and second in sentences.
    """

    first: str
    second: str
    matrix: str
    labels: tuple[str, str]
    why: str


def crossovers(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    curves: Sequence[Curve],
) -> tuple[Crossover, ...]:
    """For each matrix and each pair of sensors, where their order changes.

    Of more than ``MOST_CROSSED_SENSORS`` sensors, only pairs of which one follows the other as the
    best. Signs are read off the curves; each change is then refined on the closed form.

    Parameters
    ----------
    contestants, makers
        As they were compared.

    Raises
    ------
    InputError
        If a pair has no value of the sweep at which both have the quantity.
    """
    return tuple(starmap(_crossover, _pairs(contestants, makers, curves)))


def _places(curves: Sequence[Curve]) -> list[tuple[int, int]]:
    """Pairs of sensors that are compared, by place; all curves have one matrix."""
    if len(curves) <= MOST_CROSSED_SENSORS:
        return list(combinations(range(len(curves)), 2))
    pairs = {tuple(sorted(pair)) for pair in pairwise(_best(curves)) if min(pair) >= 0}
    return sorted((one, other) for one, other in pairs if one != other)


def crossovers_or_reasons(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    curves: Sequence[Curve],
) -> tuple[Crossover | Incomparable, ...]:
    """As `crossovers`, with an `Incomparable` for each pair that cannot be compared.

    Parameters
    ----------
    contestants, makers, curves
        As for `crossovers`.
    """
    found: list[Crossover | Incomparable] = []
    for maker, one, other in _pairs(contestants, makers, curves):
        try:
            found.append(_crossover(maker, one, other))
        except InputError as error:
            first, second = one[1], other[1]
            pair = Incomparable(
                first=first.sensor,
                second=second.sensor,
                matrix=first.matrix,
                labels=(first.label, second.label),
                why=str(error),
            )
            found.append(pair)
    return tuple(found)


_Side = tuple[OperatingPoint, Curve]


def _pairs(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    curves: Sequence[Curve],
    places: Mapping[str, Sequence[tuple[int, int]]] | None = None,
) -> Iterator[tuple[MatrixFunction, _Side, _Side]]:
    for name, mine in by_matrix(curves).items():
        maker, sides = makers[name], list(zip(contestants, mine, strict=True))
        for one, other in _places(mine) if places is None else places[name]:
            yield maker, sides[one], sides[other]


def _best(curves: Sequence[Curve]) -> list[int]:
    """Place of the best sensor at each value of the sweep; -1 where none has one."""
    values = np.array([curve.value for curve in curves])
    best: list[int] = leaders_of(values, curves[0].quantity.more_is_better).tolist()
    return best


def _value_at(
    contestant: OperatingPoint,
    maker: MatrixFunction,
    sweep: Sweep,
    of: Callable[[OperatingPoint, Any], float],
    value: float,
) -> float:
    operating_point = sweep.at(contestant, value)
    return of(operating_point, maker(operating_point))


def _crossover(maker: MatrixFunction, one: _Side, other: _Side) -> Crossover:
    (a, first), (b, second) = one, other
    sweep, quantity = first.sweep, first.quantity
    lead = quantity.sign * (first.value - second.value)
    known = np.flatnonzero(np.isfinite(lead))
    if not known.size:
        _refuse_nothing_common(first, second)

    def lead_at(value: float) -> float:
        ours, theirs = (_value_at(c, maker, sweep, quantity.of, value) for c in (a, b))
        return quantity.sign * (ours - theirs)

    changes = [
        (float(first.at[i]), float(first.at[k]))
        for i, k in pairwise(known[np.abs(lead[known]) > TIE])  # a tie has no side
        if lead[i] * lead[k] < 0 and np.isfinite(lead[i : k + 1]).all()
    ]
    at = tuple(_solved(lead_at, ends, sweep, _CROSSING_TOLERANCE) for ends in changes)
    errors = (tuple(_value_at(c, maker, sweep, color_error, value) for c in (a, b)) for value in at)
    return Crossover(
        first=first.sensor,
        second=second.sensor,
        matrix=first.matrix,
        labels=(first.label, second.label),
        sweep=sweep,
        quantity=quantity,
        at=at,
        color_error=tuple((ours, theirs) for ours, theirs in errors),
        better_first=_first_leader(lead[known], first.sensor, second.sensor),
        first_at=float(first.at[known[0]]),
        last_at=float(first.at[known[-1]]),
    )


def _first_leader(lead: Float[Array, " k"], first: str, second: str) -> str | None:
    ahead = lead[np.abs(lead) > TIE]
    if not ahead.size:
        return None
    return first if ahead[0] > 0 else second


def _refuse_nothing_common(first: Curve, second: Curve) -> None:
    raise InputError(
        f"{first.label} and {second.label}",
        f"must both have a {first.quantity.what} with the {first.matrix} matrix at some "
        f"{first.sweep.what} of the sweep",
        value=(float(first.at[0]), float(first.at[-1])),
        found="have none: they are saturated, or the matrix cannot make that color of this light",
        remedy=("shorten the time", "sweep less light", "take another matrix"),
    )


def _solved(
    function: Callable[[float], float], ends: tuple[float, ...], sweep: Sweep, tolerance: float
) -> float:
    """Where a function of a sweep changes its sign between two values, or is least among three."""
    from scipy.optimize.elementwise import find_minimum, find_root  # most comparisons need neither

    there, back = (np.log, np.exp) if sweep.logarithmic else (float, float)
    scaled: Any = tuple(float(there(end)) for end in ends)
    step = tolerance * (1.0 if sweep.logarithmic else scaled[-1] - scaled[0])
    values = np.vectorize(lambda x: function(float(back(x))), otypes=[float])
    solver = find_root if len(ends) == 2 else find_minimum
    found = solver(values, scaled, tolerances={"xatol": step, "xrtol": 0, "fatol": 0, "frtol": 0})
    return float(back(float(found.x)))


def crossover_sentence(crossover: Crossover) -> str:
    """Which sensor is better over which values, and the color errors at the crossovers.

    Parameters
    ----------
    crossover
        Crossovers of two sensors.
    """
    (first, second), sweep = crossover.labels, crossover.sweep
    last = sweep.with_unit(value_in_words(crossover.last_at, 4))
    span = f"{value_in_words(crossover.first_at, 4)} to {last}"
    leader, other = (first, second)
    if crossover.better_first == crossover.second:
        leader, other = second, first
    if crossover.better_first is None:
        return (
            f"With the {crossover.matrix} matrix, {first} and {second} have the same "
            f"{crossover.quantity.what} at every {crossover.sweep.what} from {span}."
        )
    better = "higher" if crossover.quantity.more_is_better else "lower"
    of_raw = crossover.quantity.of_raw
    leads = f"{leader} has a {better} {crossover.quantity.what}"
    if not of_raw:
        leads = f"With the {crossover.matrix} matrix, {leads}"
    if not crossover.at:
        return f"{leads} than {other} at every {crossover.sweep.what} from {span}."
    values = [value_in_words(value, 3 if value < 100 else 4) for value in crossover.at]
    between = [f"from {low} to {high}" for low, high in pairwise(values)]
    leaders = (other, leader) * len(values)
    rest = (f"{who} {where}" for who, where in zip(leaders, (*between, "above"), strict=False))
    crossed = f"{leads} below {sweep.with_unit(values[0])} of {sweep.what}, {', '.join(rest)}"
    if of_raw:
        return f"{crossed} (within {span})."
    colors = "; ".join(f"{a:.1f} and {b:.1f}" for a, b in crossover.color_error)
    where = "at the crossover" if len(values) == 1 else "at the crossovers"
    return (
        f"{crossed} (within {span}); {where} the mean color errors of {first} and {second} are "
        f"{colors} Delta E*ab."
    )


def value_in_words(value: float, digits: int = 3) -> str:
    """A value of a sweep for a sentence, rounded; 10000, not 1e+04."""
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and value < 1e6 else text


@with_short_repr
@dataclass(frozen=True, kw_only=True)
class CrossoverBand:
    """Where two sensors are equally good, over all priors of one trained matrix.

    Attributes
    ----------
    first, second, matrix
        Names of the two sensors and of the matrix.
    by_prior
        The crossover under each prior.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("first", "second", "matrix", "span", "by_prior"),
        JsonKey("sentence", lambda one: band_sentence(one), text="The same in words."),
    )

    first: str
    second: str
    matrix: str
    by_prior: Mapping[str, Crossover]

    @property
    def span(self) -> tuple[float, float] | None:
        """From the lowest to the highest crossing under any prior; ``None`` where there is none."""
        at = [value for crossover in self.by_prior.values() for value in crossover.at]
        return (min(at), max(at)) if at else None


def crossover_bands(
    contestants: Sequence[OperatingPoint],
    names: Sequence[str],
    at: Float[Array, " k"],
    *,
    metric: Metric = "quanta",
    sweep: Sweep = SWEEPS["lux"],
    quantity: Quantity = SNR_Y,
    priors: Sequence[str] = tuple(PRIORS),
) -> tuple[CrossoverBand, ...]:
    """For each pair of sensors and each trained matrix, the crossovers under every prior.

    Parameters
    ----------
    contestants, at, sweep, quantity
        As `chromanoise.study.compared`.
    names, metric
        As `chromanoise.study.matrix_makers`; untrained ones have no prior and are passed over.

    Raises
    ------
    InputError
        As `crossovers` and `matrix_makers`.
    """
    trained = trained_names(names)
    given = []
    for prior in priors if trained else ():
        makers = matrix_makers(trained, metric, prior=prior)
        curves = compared(contestants, makers, at, sweep=sweep, quantity=quantity)
        given.append((prior, makers, curves))
    places = {  # those of any prior
        name: sorted({pair for *_, curves in given for pair in _places(by_matrix(curves)[name])})
        for name in trained
    }
    found: dict[tuple[str, str, str], dict[str, Crossover]] = {}
    for prior, makers, curves in given:
        for crossover in starmap(_crossover, _pairs(contestants, makers, curves, places)):
            pair = (crossover.first, crossover.second, crossover.matrix)
            found.setdefault(pair, {})[prior] = crossover
    return tuple(
        CrossoverBand(first=first, second=second, matrix=matrix, by_prior=by_prior)
        for (first, second, matrix), by_prior in found.items()
    )


def band_sentence(band: CrossoverBand) -> str:
    """The band in words.

    Parameters
    ----------
    band
        Crossovers over all training sets.
    """
    one = next(iter(band.by_prior.values()))
    start = (
        f"Over {len(band.by_prior)} priors ({', '.join(band.by_prior)}) of the {band.matrix} "
        f"matrix, {' and '.join(one.labels)}"
    )
    if band.span is None:
        called = dict(zip((band.first, band.second), one.labels, strict=True))
        better = {c.better_first for c in band.by_prior.values()}
        leaders = sorted(called[name] for name in better if name is not None)
        who = f"{leaders[0]} is always better" if leaders else "they are equal"
        if len(leaders) > 1:
            who = f"{' or '.join(leaders)} is better, depending on the prior"
        return f"{start} have no crossover in {one.quantity.what}: {who}."
    low, high = band.span
    never = [prior for prior, crossover in band.by_prior.items() if not crossover.at]
    exceptions = f", and none with {', '.join(never)}" if never else ""
    return (
        f"{start} have a crossover in {one.quantity.what} between {low:.3g} and "
        f"{one.sweep.with_unit(f'{high:.3g}')} of {one.sweep.what}{exceptions}."
    )


MOST_PAIRS_SENSORS = 3
"""Up to this number of sensors each pair has a sentence; more have a ranking and leaders."""

MOST_CROSSED_SENSORS = 60
"""Up to this number of sensors the crossovers of all pairs are computed."""


@dataclass(frozen=True, kw_only=True)
class Rank:
    """The place of one sensor among all, with one matrix.

    Attributes
    ----------
    rank
        1 for the best; equal values share a rank, and the next ranks are skipped. ``None`` without
        a value.
    tied
        Whether another sensor has the same rank.
    sensor, label, matrix
        Name of the sensor, what tables call it, and name of the matrix.
    value
        Of the quantity at the operating point; ``None`` where it is not defined.
    """

    rank: int | None
    tied: bool
    sensor: str
    label: str
    matrix: str
    value: float | None


@with_short_repr
@dataclass(frozen=True, kw_only=True)
class Lead(OfSensor):
    """A range of the sweep in which one sensor is the best of all, with one matrix.

    Attributes
    ----------
    first, last
        The ends of the range. [unit of the sweep]
    """

    KEYS: ClassVar[JsonKeys] = ("sensor", "label", "matrix", "first", "last")

    first: float
    last: float


Named = tuple[str, str, float]
"""Name, label and value of a sensor; NaN where the value is not defined."""


def ranked(found: Sequence[Named], *, matrix: str, more_is_better: bool) -> tuple[Rank, ...]:
    """The sensors from best to worst; equal values share a rank.

    Parameters
    ----------
    found
        Name, label and value of each sensor.
    matrix
        Name of the color matrix.
    more_is_better
        Whether the highest value is the best.

    Notes
    -----
    Values that differ by at most 1e-9 of their unit are equal. Ranks are those of sports: 1, 2, 2,
    4.

    Examples
    --------
    >>> found = [("a", "a", 20.0), ("b", "b", 30.0), ("c", "c", 20.0), ("d", "d", float("nan"))]
    >>> [(r.sensor, r.rank, r.tied) for r in ranked(found, matrix="kernel", more_is_better=True)]
    [('b', 1, False), ('a', 2, True), ('c', 2, True), ('d', None, False)]
    """
    sign = -1.0 if more_is_better else 1.0
    known = sorted((one for one in found if np.isfinite(one[2])), key=lambda one: sign * one[2])
    places = [0] * len(known)
    for i in range(1, len(known)):
        equal = abs(known[i][2] - known[places[i - 1]][2]) <= TIE
        places[i] = places[i - 1] if equal else i
    ranks: list[tuple[Named, int | None]] = [
        (one, place + 1) for one, place in zip(known, places, strict=True)
    ]
    ranks += [(one, None) for one in found if not np.isfinite(one[2])]
    return tuple(
        Rank(
            sensor=name,
            label=label,
            matrix=matrix,
            value=None if rank is None else value,
            rank=rank,
            tied=rank is not None and places.count(rank - 1) > 1,
        )
        for (name, label, value), rank in ranks
    )


def ranking(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    quantity: Quantity,
) -> tuple[Rank, ...]:
    """The sensors ranked by a quantity at their operating points, for each matrix.

    Parameters
    ----------
    contestants, makers
        As `chromanoise.study.compared`.
    quantity
        One of `QUANTITIES`, or your own.
    """
    return tuple(
        rank
        for name, maker in makers.items()
        for rank in ranked(
            [(p.sensor.name, p.sensor.label, quantity.of(p, maker(p))) for p in contestants],
            matrix=name,
            more_is_better=quantity.more_is_better,
        )
    )


def matrix_sentences(ranks: Sequence[Rank], quantity: Quantity) -> list[str]:
    """For each sensor with several matrices, a sentence that ranks them at the operating point.

    Parameters
    ----------
    quantity
        That of the ranks.
    """
    sentences = []
    for name in dict.fromkeys(one.sensor for one in ranks):
        own = [one for one in ranks if one.sensor == name]
        known = [one for one in own if one.value is not None]
        known.sort(key=lambda one: -quantity.sign * (one.value or 0.0))
        if len(own) > 1 and known:
            text = ", ".join(f"{one.matrix} {number_text(one.value)}" for one in known)
            sentences.append(
                f"{known[0].label}: {quantity.what} [{quantity.unit}] at the fixed settings, best "
                f"matrix first: {text}."
            )
    return sentences


def leads(curves: Sequence[Curve], crossed: Sequence[Crossover]) -> tuple[Lead, ...]:
    """For each matrix, the ranges of the sweep in which one sensor is the best of all.

    Parameters
    ----------
    crossed
        Of `chromanoise.study.crossovers`: the ends of the ranges.

    Notes
    -----
    The leader is read off the curves at each value of the sweep, so a lead shorter than one step is
    not seen. A range begins and ends at a crossover; where a leader has no value any longer, as it
    is saturated, at the last value of the sweep at which it has one.
    """
    return tuple(lead for mine in by_matrix(curves).values() for lead in _leads(mine, crossed))


def _leads(curves: Sequence[Curve], crossed: Sequence[Crossover]) -> list[Lead]:
    best = _best(curves)
    at = curves[0].at.tolist()
    ends: list[tuple[int, float, float]] = []  # leader, first, last
    for i, leader in enumerate(best):
        if leader < 0:
            continue
        if i and best[i - 1] == leader:
            ends[-1] = (leader, ends[-1][1], at[i])
            continue
        first = at[i]
        if i and best[i - 1] >= 0:
            change = _change(curves[best[i - 1]], curves[leader], crossed, at[i - 1], at[i])
            if change is not None:
                ends[-1] = (*ends[-1][:2], change)
                first = change
        ends.append((leader, first, at[i]))
    return [Lead(**curves[i].subject, first=first, last=last) for i, first, last in ends]


def leaders_of(values: Any, more_is_better: bool) -> Any:
    """Index of the best along the first axis, -1 where none has a value.

    A tie goes to the first of the equals.

    Parameters
    ----------
    values
        One entry per sensor along the first axis; NaN where it is not defined.
    more_is_better
        Whether the highest value is the best.

    Examples
    --------
    >>> leaders_of(np.array([[1.0, 2.0, np.nan], [1.0, 3.0, np.nan]]), True).tolist()
    [0, 1, -1]
    """
    points = np.where(np.isnan(values), -np.inf, values if more_is_better else -values)
    near = points >= points.max(axis=0) - TIE
    return np.where(np.isinf(points.max(axis=0)), -1, near.argmax(axis=0))


def _change(
    one: Curve, other: Curve, crossed: Sequence[Crossover], low: float, high: float
) -> float | None:
    """Where two curves of one matrix cross between two values of the sweep."""
    pair, matrix = {one.sensor, other.sensor}, one.matrix
    found = [
        value
        for crossover in crossed
        if crossover.matrix == matrix and {crossover.first, crossover.second} == pair
        for value in crossover.at
        if low <= value <= high
    ]
    return found[0] if found else None


def leading_crossovers(
    leading: Sequence[Lead], crossed: Sequence[Crossover]
) -> tuple[Crossover, ...]:
    """The crossovers at which the leader changes; of all pairs, those that matter."""
    changes = {
        (one.matrix, frozenset((one.sensor, other.sensor)))
        for one, other in pairwise(leading)
        if one.matrix == other.matrix and one.last == other.first
    }
    return tuple(
        one for one in crossed if (one.matrix, frozenset((one.first, one.second))) in changes
    )


def lead_changes(leading: Sequence[Lead], crossed: Sequence[Crossover]) -> tuple[Crossover, ...]:
    """`leading_crossovers` with only those of their values at which the leader changes.

    Parameters
    ----------
    leading, crossed
        As `leading_crossovers`.
    """
    ends = {(one.matrix, one.last) for one in leading}
    changes = []
    for one in leading_crossovers(leading, crossed):
        kept = [k for k, value in enumerate(one.at) if (one.matrix, value) in ends]
        at = tuple(one.at[k] for k in kept)
        errors = tuple(one.color_error[k] for k in kept)
        changes.append(replace(one, at=at, color_error=errors))
    return tuple(changes)


def lead_sentences(leading: Sequence[Lead]) -> list[str]:
    """Per matrix, the best sensor over each range of the sweep."""
    sentences = []
    for name, mine in by_matrix(leading).items():
        sweep, quantity = mine[0].sweep, mine[0].quantity
        better = "highest" if quantity.more_is_better else "lowest"
        ranges = [f"{one.label} {sweep.with_unit(_range_in_words(one))}" for one in mine]
        sentences.append(
            f"With the {name} matrix the {better} {quantity.what} of all sensors over "
            f"{sweep.what}: {', '.join(ranges)}."
        )
    return sentences


def _range_in_words(lead: Lead) -> str:
    first, last = value_in_words(lead.first), value_in_words(lead.last)
    return f"at {first}" if first == last else f"from {first} to {last}"


Place = Literal["inside", "first", "last", "saturation", "everywhere"]


@dataclass(frozen=True, kw_only=True)
class BestValue(OfSensor):
    """The best value of one sensor with one matrix.

    Attributes
    ----------
    value
        The quantity there. [unit of the quantity]
    """

    value: float


AnyBest = TypeVar("AnyBest", bound=BestValue)


@with_short_repr
@dataclass(frozen=True, kw_only=True)
class Optimum(BestValue):
    """The value of a sweep at which one sensor is best, with one matrix.

    Attributes
    ----------
    at
        The best value of the parameter; between two values of the sweep it is refined on the closed
        form. [unit of the sweep]
    low, high
        The neighbors of the best value of the sweep: the optimum lies between them; at an end of
        the range, that end. [unit of the sweep]
    place
        ``inside`` the range, its ``first`` or ``last`` value with a result, the last one before
        ``saturation``, or ``everywhere`` where the quantity does not vary.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("sensor", "label", "matrix", "at", "value", "low", "high", "place"),
        JsonKey("sentence", lambda one: optima_sentences([one])[0], text="The same in words."),
    )

    at: float
    low: float
    high: float
    place: Place


def optima(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    curves: Sequence[Curve],
) -> tuple[Optimum, ...]:
    """For each sensor and matrix, the best value of the sweep; none without any result.

    Parameters
    ----------
    contestants, makers
        As they were compared.
    curves
        One per matrix and sensor.
    """
    return tuple(
        _optimum(contestant, makers[name], curve)
        for name, mine in by_matrix(curves).items()
        for contestant, curve in zip(contestants, mine, strict=True)
        if np.isfinite(curve.value).any()
    )


def _optimum(contestant: OperatingPoint, maker: MatrixFunction, curve: Curve) -> Optimum:
    sweep, quantity, points = curve.sweep, curve.quantity, curve.points
    i, known = int(np.argmax(points)), np.flatnonzero(np.isfinite(points))
    low, high = int(max(i - 1, known[0])), int(min(i + 1, known[-1]))
    at, value, place = float(curve.at[i]), float(curve.value[i]), _place(curve, i, known)

    def value_at(moved: float) -> float:
        return _value_at(contestant, maker, sweep, quantity.of, moved)

    if place == "inside" and not sweep.whole and np.isfinite(points[[low, high]]).all():
        ends = (float(curve.at[low]), at, float(curve.at[high]))
        at = _solved(lambda x: -quantity.sign * value_at(x), ends, sweep, _OPTIMUM_TOLERANCE)
        value = value if at == curve.at[i] else value_at(at)
    first, last = (low, high) if place == "inside" else (i, i)
    return Optimum(
        **curve.subject,
        at=at,
        value=value,
        low=float(curve.at[first]),
        high=float(curve.at[last]),
        place=place,
    )


def _place(curve: Curve, i: int, known: Int[Array, " n"]) -> Place:
    if known.size > 1 and np.ptp(curve.value[known]) <= TIE:
        return "everywhere"
    if i == known[-1]:
        is_last = i + 1 < curve.at.size and bool(curve.saturated[i + 1])
        return "saturation" if is_last else "last"
    return "first" if i == known[0] else "inside"


def optima_sentences(found: Sequence[Optimum]) -> list[str]:
    """Per matrix, at which value of the sweep each sensor is best, the best sensor first."""
    return best_sentences(found, _optimum_in_words)


def _optimum_in_words(one: Optimum, is_first: bool) -> tuple[str, str]:
    low, high = value_in_words(one.low, 4), value_in_words(one.high, 4)
    where = {
        "inside": f", between {low} and {high}",
        "first": ", the lower end of the range",
        "last": ", the upper end of the range",
        "saturation": ", the last value before saturation",
        "everywhere": "",
    }[one.place]
    at = one.sweep.with_unit(value_in_words(one.at))
    at = f"{at} of {one.sweep.what}" if is_first else at
    return f"every {one.sweep.what}" if one.place == "everywhere" else at, where


def best_sentences(
    found: Sequence[AnyBest], in_words: Callable[[AnyBest, bool], tuple[str, str]]
) -> list[str]:
    """Per matrix, where each sensor is best, the best sensor first.

    Parameters
    ----------
    found
        Best values of sensors, each with its place.
    in_words
        Gives the place of one of them and a remark on it; also takes whether it is the first.
    """
    sentences = []
    for name, mine in by_matrix(found).items():
        quantity = mine[0].quantity
        ordered = sorted(mine, key=lambda one: -one.quantity.sign * one.value)
        unit = "" if quantity.unit == "1" else f" {quantity.unit}"
        texts = []
        for one in ordered[:_MOST_NAMED]:
            place, remark = in_words(one, one is ordered[0])
            texts.append(f"at {place} for {one.label} ({number_text(one.value)}{unit}{remark})")
        start = quantity.what if quantity.of_raw else f"with the {name} matrix, {quantity.what}"
        best, more = "highest" if quantity.more_is_better else "lowest", len(mine) - _MOST_NAMED
        rest = f"; the JSON has the other {more}" if more > 0 else ""
        sentences.append(f"{start[0].upper()}{start[1:]} is {best} {', '.join(texts)}{rest}.")
    return sentences
