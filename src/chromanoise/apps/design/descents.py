"""Gradient descents along the whole front of a problem.

`improved` traces the whole front by exact gradients, in rounds of descents that advance together:
their gradients are one batch, and so are the points that they try. An evaluation costs much less
than a gradient, so that each descent tries several lengths of its step. A constraint on the least
of several distances is a constraint on each distance within reach, because the least one has
kinks.
"""

from collections.abc import Callable

import numpy as np

from chromanoise.apps.design.algorithms import latin_hypercube, share_of_ranges
from chromanoise.apps.design.pareto_front import (
    LARGEST,
    Assessed,
    Problem,
    Rows,
    assessed,
    non_dominated,
    scaled,
)
from chromanoise.base import Array, Bool, Float, Int64, dataclass, inv, solve

_RADIUS, _LARGEST_RADIUS, _LEAST_RADIUS = 0.2, 0.3, 1e-5  # of the box, as shares of the ranges
_ITERATIONS = 60  # of a descent
_GAIN = 1e-5  # of the scale of the costs; a descent ends when several steps gain less
_SMALL_GAINS = 3
_KEPT_PACE, _REACH = 0.85, 5.0  # share of the gains that counts after a step; how far they reach
_PREDICTED = 1e-9  # gain of the model below which a descent ends
_MARGIN = 1e-7  # kept from each constraint, which the model meets within rounding only
_STEPS = np.array([1.0, 1.0, 0.6, 0.3, 0.1, 0.03])  # the first one is corrected
_OTHERS = 1e-5  # weight of the sum of all costs, so that no end is only weakly efficient
_PENALTY, _LARGEST_PENALTY = 10.0, 1e4  # per violation
_OF_COSTS, _OF_BOX = 1e3, 1e4  # penalties that exceed every multiplier
_ROWS = 3  # rows of constraints per parameter in a model
_CURVATURE = 0.1  # of the first model
_DAMPING = 0.2  # least share of the curvature that a step keeps (Powell, 1978)
_ACTIVE = 1e-5  # multiplier of an active row
_INTERIOR = 40  # iterations of a model's solution
_INTERIOR_GAP, _INTERIOR_ERROR = 1e-9, 1e-5  # where it ends
_TINY = 1e-13

_SCREENED, _NEAR = 4096, 0.1  # random candidates, and the share that is nearest to the constraints
_FIRST = 96  # descents of the first round, from candidates far apart
_ALONG, _ALONE = 48, 8  # descents of a round along the front, and of each objective alone
_AT_LAST, _LAST_ROUNDS = 250, 4  # descents of each last round, per dimension of the front
_USUAL_STEPS = 14  # of these descents
_EDGES = 0.25  # share of the references without one of three or more objectives
_DRAWN = 2000  # points between members, of which the references of a round are chosen
_DEPTH = 0.5  # of the geometric distribution of the rank of a start
_APART = 0.3  # distance of members of different ranks, as a share of the ranges
_FROM_PARENT, _RENEWED = 0.6, 0.2  # shares of the parameters in a crossed and a changed start
_UNCHANGED, _CROSSED_STARTS = 0.2, 0.6  # quantiles of the kinds of a start
_EXCHANGED = 0.25  # share of the starts with two exchanged parts
_CELL = 2  # decimals of the parameters within which two members are one
_ROUNDS = 40  # at most, before the last ones
_SETTLED, _SETTLED_ROUNDS = 1e-3, 3  # mean gain of the references; rounds that must gain less


@dataclass(frozen=True, kw_only=True, eq=False)
class Improved:
    """The ends of the descents, with their evaluation without gradients.

    Attributes
    ----------
    found
        One row per descent, feasible or not.
    gradients
        Number of gradients that were computed.
    """

    found: Assessed
    gradients: int


def improved(
    problem: Problem,
    found: Assessed,
    *,
    most: int,
    rng: np.random.Generator,
    goes_on: Callable[[int], bool] = lambda gradients: True,
) -> Improved:
    """Candidates along the whole front, by descents in rounds.

    The first round minimizes each objective alone, from candidates that are far apart; it is
    repeated from the nearest ones until one meets the constraints or none comes nearer. Each later
    round takes references evenly spaced along the front so far, and minimizes the largest excess
    of the costs over the reference (Pascoletti & Serafini, 1984), or one objective alone. Some
    references leave one of three or more objectives out, because the edges of a front are fronts
    of fewer objectives. A descent starts at one of the best members for its reference that are far
    apart, at a cross of that member and another one, or at that member with some parameters drawn
    anew. When the front has settled, last rounds with more references start at the best member
    for each.

    Parameters
    ----------
    problem
        A problem with gradients. A descent keeps integer parameters.
    found
        Evaluated candidates, at least one.
    most
        Number of gradients after which only the last rounds begin.
    goes_on
        Whether another round shall begin after a number of gradients.
    """
    screened = latin_hypercube(problem, min(_SCREENED, max(2 * most, _FIRST)), rng)
    rounds = _Rounds(problem, most, goes_on)
    pool = _meeting_the_constraints(found.joined(assessed(problem, screened)), rounds)
    if len(pool.values):
        _trace(pool, rounds, rng)
    first, *others = rounds.ends
    return Improved(found=first.joined(*others), gradients=rounds.gradients)


class _Rounds:
    """The rounds so far: where descents ended, gradients, rounds in a row that gained little."""

    def __init__(self, problem: Problem, most: int, goes_on: Callable[[int], bool]) -> None:
        self.problem, self._most, self._goes_on = problem, most, goes_on
        self.ends, self.gradients, self.settled = list[Assessed](), 0, 0

    def may_go_on(self) -> bool:
        """Report the number of gradients so far, and return whether another round may begin."""
        return self._goes_on(self.gradients)

    @property
    def are_enough(self) -> bool:
        """Whether the gradients are used up, or the last rounds gained little."""
        spent = self.gradients >= self._most or len(self.ends) > _ROUNDS
        return spent or self.settled >= _SETTLED_ROUNDS

    def descend(self, starts: Array, reference: Array, scale: Array, target: Array) -> Assessed:
        descents = _Descents(self.problem, starts, reference, scale, target)
        self.ends.append(assessed(self.problem, descents.ends()))
        self.gradients += descents.gradients
        return self.ends[-1]

    def judge(self, gain: float) -> None:
        self.settled = self.settled + 1 if gain <= _SETTLED else 0


def _meeting_the_constraints(every: Assessed, rounds: _Rounds) -> Assessed:
    """Candidates that meet the constraints, after descents of each objective alone."""
    problem, near = rounds.problem, max(_FIRST, int(_NEAR * len(every.values)))
    while rounds.may_go_on():
        starts, pool = _nearest(problem, every, near), every.some(every.feasible)
        reference = np.resize(_alone(problem), (len(starts), len(problem.objectives)))
        scale, least = _scale(pool.costs), every.misses.min()
        target = _excesses(pool.costs, reference, scale).min(axis=1, initial=np.inf)
        ends = rounds.descend(starts, reference, scale, target)
        every = every.joined(ends)
        if every.feasible.any():
            rounds.judge(_mean_gain(ends, reference, scale, target))
            break
        rounds.judge(1.0 - ends.misses.min() / least)
        if rounds.are_enough:
            break
        near = 2 * _FIRST
    return every.some(every.feasible)


def _trace(pool: Assessed, rounds: _Rounds, rng: np.random.Generator) -> None:
    """Descents along the front of members, in rounds."""
    problem, last = rounds.problem, 0
    count = len(problem.objectives)
    while rounds.may_go_on() and last < _LAST_ROUNDS and not (last and rounds.settled):
        if last or rounds.are_enough:
            last, rounds.settled = last + 1, 0
        pool = pool.some(_distinct(share_of_ranges(problem, pool.values), pool.costs))
        front = pool.costs[non_dominated(pool.costs)]
        if last and len(front) > LARGEST:
            break
        scale = _scale(front)
        most_along = _AT_LAST * (count - 1) if last else _ALONG
        along = _references(front / scale, most_along, rng) * scale
        each = np.repeat(_alone(problem), 1 if last else _ALONE, axis=0)
        reference = np.concatenate([each, along])
        excesses = _excesses(pool.costs, reference, scale)
        target = excesses.min(axis=1)
        starts = (
            pool.values[excesses.argmin(axis=1)]
            if last
            else _starts(problem, pool.values, excesses, rng)
        )
        ends = rounds.descend(starts, reference, scale, target)
        rounds.judge(_mean_gain(ends, reference, scale, target))
        pool = pool.joined(ends.some(ends.feasible))


def _alone(problem: Problem) -> Float[Array, "q q"]:
    """References that count one objective each."""
    return np.where(np.eye(len(problem.objectives), dtype=bool), 0.0, np.inf)


def _mean_gain(ends: Assessed, reference: Array, scale: Array, target: Array) -> float:
    """Of the references over what was known; infinite if no end meets the constraints."""
    new = ends.costs[ends.feasible]
    if not len(new):
        return np.inf
    after = _excesses(new, reference, scale).min(axis=1)
    return float(np.maximum(target - after, 0.0).mean())


def gradients_at_most(problem: Problem, most: int) -> int:
    """About how many gradients `improved` computes at most."""
    count = len(problem.objectives)
    at_last = _LAST_ROUNDS * (_AT_LAST * (count - 1) + count)
    return most + _USUAL_STEPS * at_last


def _nearest(problem: Problem, every: Assessed, most: int) -> Float[Array, "k d"]:
    """Candidates far apart among the ``most`` that are nearest to the constraints."""
    nearest = every.values[np.argsort(every.misses, kind="stable")[:most]]
    return nearest[_far_apart(share_of_ranges(problem, nearest), _FIRST)]


def _scale(costs: Float[Array, "m q"]) -> Float[Array, " q"]:
    if not len(costs):
        return np.ones(costs.shape[1])
    size = np.maximum(np.abs(costs).max(axis=0), 1e-6)
    return np.maximum(np.ptp(costs, axis=0), 1e-3 * size)


def _far_apart(share: Float[Array, "m d"], count: int) -> Int64[Array, " k"]:
    """Indices of ``count`` points: the first, then each time the farthest from those before it."""
    chosen = [0]
    distance = np.linalg.norm(share - share[0], axis=1)
    while len(chosen) < count and distance.max() > 0:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(share - share[chosen[-1]], axis=1))
    return np.array(chosen, dtype=np.int64)


def _excesses(
    costs: Float[Array, "m q"], reference: Float[Array, "k q"], scale: Float[Array, " q"]
) -> Float[Array, "k m"]:
    """What descents to each reference minimize; infinite references do not count."""
    own, wanted = costs / scale, reference / scale
    every = [one - other[:, None] for one, other in zip(own.T, wanted.T, strict=True)]
    return np.maximum.reduce(every) + _OTHERS * own.sum(axis=1)


def _distinct(share: Float[Array, "m d"], costs: Float[Array, "m q"]) -> Int64[Array, " k"]:
    """Indices of the best of each cell of the parameters, and of the lowest of each cost."""
    order = np.lexsort((scaled(costs).sum(axis=1), ~non_dominated(costs)))
    _, first = np.unique(np.round(share[order], _CELL), axis=0, return_index=True)
    return np.unique(np.concatenate([order[first], costs.argmin(axis=0)]))


def _references(
    costs: Float[Array, "m q"], most: int, rng: np.random.Generator
) -> Float[Array, "k q"]:
    """Points far apart between members of a front, in the plane across the diagonal.

    An infinite value leaves an objective out.
    """
    count = costs.shape[1]
    corners = costs[rng.integers(0, len(costs), (_DRAWN, count))]
    between = np.einsum("mk,mkq->mq", rng.dirichlet(np.ones(count), _DRAWN), corners)
    points = np.concatenate([costs, between])
    points = points - points.mean(axis=1, keepdims=True)
    references = points[_far_apart(points, most)] if count > 1 else points[:0]
    if count > 2:
        edges = np.flatnonzero(rng.random(len(references)) < _EDGES)
        references[edges, rng.integers(0, count, edges.size)] = np.inf
    return references


def _starts(
    problem: Problem,
    pool: Float[Array, "m d"],
    excesses: Float[Array, "k m"],
    rng: np.random.Generator,
) -> Float[Array, "k d"]:
    """A start for each reference: a good member, a cross of it, or it with changed parameters.

    In some starts two parts of the design have exchanged their parameters, because the search
    does not know which of two channels shall have which filter.
    """
    count, d = len(excesses), pool.shape[1]
    parents = pool[_parents(share_of_ranges(problem, pool), excesses, rng)]
    mates = pool[rng.integers(0, len(pool), count)]
    fresh = latin_hypercube(problem, count, rng)
    drawn = rng.random((count, d))
    crossed = np.where(drawn < _FROM_PARENT, parents, mates)
    changed = np.where(drawn < max(_RENEWED, 1.5 / d), fresh, parents)
    kind = rng.random((count, 1))
    others = np.where(kind < _CROSSED_STARTS, crossed, changed)
    starts = np.where(kind < _UNCHANGED, parents, others)
    if len(orders := problem.exchanges):
        chosen = np.flatnonzero(rng.random(count) < _EXCHANGED)
        order = orders[rng.integers(0, len(orders), chosen.size)]
        starts[chosen] = np.take_along_axis(starts[chosen], order, axis=1)
    return problem.allowed(starts)


def _parents(
    share: Float[Array, "m d"], excesses: Float[Array, "k m"], rng: np.random.Generator
) -> Int64[Array, " k"]:
    """Indices of a good member for each reference.

    The best one, or the best of those that are far from all better ones: neighbors would lead to
    the same minimum.
    """
    best, left = excesses.argmin(axis=1), excesses.copy()
    passed = rng.geometric(_DEPTH, len(best)) - 1
    while (live := np.flatnonzero(passed)).size:
        near = np.abs(share - share[best[live], None]).max(axis=2) < _APART
        left[live] = np.where(near, np.inf, left[live])
        found = np.isfinite(left[live].min(axis=1))
        best[live] = np.where(found, left[live].argmin(axis=1), best[live])
        passed[live] = np.where(found, passed[live] - 1, 0)
    return best


@dataclass(frozen=True, kw_only=True, eq=False)
class _Linear(Rows):
    """Scaled costs and constraints at points of the unit cube, with derivatives."""

    costs: Float[Array, "n q"]
    slopes: Float[Array, "n q f"]
    rows: Float[Array, "n r"]
    jacobian: Float[Array, "n r f"]

    @property
    def defined(self) -> Bool[Array, " n"]:
        parts = self.arrays().values()
        return np.logical_and.reduce(
            [np.isfinite(part).reshape(len(part), -1).all(axis=1) for part in parts]
        )

    def put(self, places: Array, new: "_Linear") -> None:
        for name, array in new.arrays().items():
            getattr(self, name)[places] = array

    def lagrangian_slope(self, of_costs: Array, of_rows: Array) -> Float[Array, "n f"]:
        """Slope of the costs and rows with multipliers, and of the sum of all costs."""
        weights = of_costs + _OTHERS
        return _combined(weights, self.slopes) + _combined(of_rows, self.jacobian)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Merit:
    """Merit of points: the objective of a descent, and the sum of their scaled violations."""

    value: Float[Array, " n"]
    misses: Float[Array, " n"]
    feasible: Bool[Array, " n"]
    costs: Float[Array, "n q"]
    violation: Float[Array, "n r"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Step:
    """The minimum of a quadratic model within the box, and its multipliers."""

    step: Float[Array, "n f"]
    gain: Float[Array, " n"]
    misses: Float[Array, " n"]
    of_costs: Float[Array, "n q"]
    of_rows: Float[Array, "n r"]
    corrected: Callable[[_Merit], Float[Array, "n f"]]


class _Descents:
    """Descents in the unit cube of the free parameters, all in step.

    Each minimizes the largest excess of its costs over its reference under the constraints, whose
    violation has a penalty. A step is the minimum of a quadratic model within a box (sequential
    quadratic programming with damped BFGS updates; Nocedal & Wright, 2006, chapter 18), corrected
    by the curvature of the active rows, or a part of this step. A descent ends early if its recent
    gains are too small to reach its target, the lowest value that is already known.
    """

    def __init__(
        self,
        problem: Problem,
        values: Float[Array, "n d"],
        reference: Float[Array, "n q"],
        scale: Float[Array, " q"],
        target: Float[Array, " n"],
    ) -> None:
        self.gradients, self._target = 0, target
        self._problem, self._start = problem, values
        self._free = ~problem.whole
        self._low, self._span = problem.low[self._free], (problem.high - problem.low)[self._free]
        self._sign = problem.costs(np.ones(len(scale))) / scale
        self._sizes = np.array(problem.constraint_sizes)
        self._counts = np.isfinite(reference)
        self._reference = np.where(self._counts, reference / scale, 0.0)
        self._share = (values[:, self._free] - self._low) / self._span
        n, f = self._share.shape
        self._radius, self._penalty = np.full(n, _RADIUS), np.full(n, _PENALTY)
        self._curvature = np.tile(_CURVATURE * np.eye(f), (n, 1, 1))
        self._small = np.zeros(n, dtype=int)
        self._of = np.empty(0, dtype=np.int64)

    def ends(self) -> Float[Array, "n d"]:
        """The best feasible point of each descent; the last one where none is feasible."""
        every = np.arange(len(self._start))
        if not self._free.any():
            return self._start
        first = self._merit(self._share, every)
        self._value, self._misses = first.value, first.misses
        self._best = np.where(first.feasible, first.value, np.inf)
        with np.errstate(invalid="ignore"):  # an undefined start does not go on
            distance = first.value + self._penalty * first.misses - self._target
        self._pace = np.maximum(distance, 0.0)
        self._best_share = self._share.copy()
        at = self._linearized(every)
        live = np.flatnonzero(at.defined)
        at = at.some(live)
        for _ in range(_ITERATIONS):
            if not live.size:
                break
            live, at = self._advanced(live, at)
        found = np.isfinite(self._best)[:, None]
        return self._values(np.where(found, self._best_share, self._share), every)

    def _advanced(self, live: Array, at: _Linear) -> tuple[Array, _Linear]:
        """One step of the live descents: those that go on, with their linearization."""
        model = self._model(live, at)
        here, n = self._share[live], live.size
        full = self._merit(here + model.step, live)
        points = here[:, None] + _STEPS[:, None] * model.step[:, None]
        points[:, 0] += model.corrected(full)
        points = np.clip(points, 0.0, 1.0)
        found = self._merit(points.reshape(n * _STEPS.size, -1), np.repeat(live, _STEPS.size))
        value, misses = found.value.reshape(n, -1), found.misses.reshape(n, -1)
        merit = value + self._penalty[live, None] * misses
        first, each = merit.argmin(axis=1), np.arange(n)
        before = self._value[live] + self._penalty[live] * self._misses[live]
        with np.errstate(invalid="ignore"):  # both may be undefined
            gain = before - merit[each, first]
        better = (gain > 0) & np.isfinite(merit[each, first])
        self._remember(live, points, np.where(found.feasible.reshape(n, -1), value, np.inf))
        self._resize(live, model, _STEPS[first], np.where(better, gain, 0.0))
        moved, goes_on = points[each, first] - here, self._goes_on(live, model, better, gain)
        won = live[better]
        self._share[won] = points[each, first][better]
        self._value[won], self._misses[won] = (
            value[each, first][better],
            misses[each, first][better],
        )
        fresh = np.flatnonzero(better & goes_on)
        if fresh.size:
            new = self._linearized(live[fresh])
            self._bend(live[fresh], model, fresh, moved[fresh], at, new)
            goes_on[fresh] = new.defined
            at.put(fresh, new)
        return live[goes_on], at.some(goes_on)

    def _remember(self, live: Array, points: Array, value: Float[Array, "n k"]) -> None:
        each, first = np.arange(live.size), value.argmin(axis=1)
        lower = value[each, first] < self._best[live]
        self._best[live[lower]] = value[each, first][lower]
        self._best_share[live[lower]] = points[each, first][lower]

    def _resize(self, live: Array, model: _Step, step: Array, gain: Float[Array, " n"]) -> None:
        """Radius of the box, and penalty, after a step; no gain if it was refused."""
        length, radius = np.abs(model.step).max(axis=1), self._radius[live]
        good = (step == 1) & (gain > 0.7 * model.gain) & (length >= 0.5 * radius)
        factor = np.select([good, step == 1, step > 0.5, step > 0.2], [2.0, 1.0, 0.7, 0.5], 0.25)
        grown = np.minimum(radius * factor, _LARGEST_RADIUS)
        self._radius[live] = np.where(gain > 0, grown, np.minimum(radius / 4, length / 2))
        stuck = (model.misses > _MARGIN) & (
            np.isfinite(self._best[live]) | ((gain == 0) & (self._misses[live] > 10 * _MARGIN))
        )
        raised = np.minimum(4 * self._penalty[live], _LARGEST_PENALTY)
        self._penalty[live] = np.where(stuck, raised, self._penalty[live])

    def _goes_on(self, live: Array, model: _Step, better: Array, gain: Array) -> Bool[Array, " n"]:
        """Which descents have not ended; an end that violates a constraint has a higher penalty."""
        small = better & (gain < _GAIN)
        self._pace[live] = _KEPT_PACE * self._pace[live] + np.where(better, gain, 0.0)
        merit = self._value[live] + self._penalty[live] * self._misses[live]
        count = np.where(better & ~small, 0, self._small[live] + small)
        ended = (self._radius[live] < _LEAST_RADIUS) | (count >= _SMALL_GAINS)
        ended |= model.gain < _PREDICTED
        again = ended & np.isinf(self._best[live]) & (self._penalty[live] < _LARGEST_PENALTY)
        self._small[live] = np.where(again, 0, count)
        self._penalty[live[again]] *= 10
        self._radius[live[again]] = _RADIUS / 10
        return (~ended | again) & (merit - self._target[live] <= _REACH * self._pace[live])

    def _bend(
        self, live: Array, model: _Step, of: Array, step: Array, old: _Linear, new: _Linear
    ) -> None:
        """Damped BFGS update of the curvature of the Lagrangian."""
        multipliers = model.of_costs[of], model.of_rows[of]
        with np.errstate(invalid="ignore", over="ignore"):
            before, after = (one.lagrangian_slope(*multipliers) for one in (old.some(of), new))
            change = after - before
        own = self._curvature[live]
        along = _times(own, step)
        length, product = (step * along).sum(axis=1), (step * change).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            weight = (1 - _DAMPING) * length / (length - product)
            weight = np.where(product < _DAMPING * length, weight, 1.0)[:, None]
            damped = weight * change + (1 - weight) * along
            size = (step * damped).sum(axis=1)
            bent = (
                own
                - along[:, :, None] * along[:, None] / length[:, None, None]
                + damped[:, :, None] * damped[:, None] / size[:, None, None]
            )
        kept = (size > 1e-8 * length) & np.isfinite(bent).all(axis=(1, 2))
        self._curvature[live[kept]] = bent[kept]

    def _model(self, live: Array, at: _Linear) -> _Step:
        """The minimum of the quadratic model, in units of the radius."""
        (n, q), f, radius = at.costs.shape, self._share.shape[1], self._radius[live]
        rows, jacobian, places = self._nearest(at, radius)
        k, counts = rows.shape[1], self._counts[live]
        excess = np.where(counts, at.costs - self._reference[live], -np.inf)
        worst = excess.max(axis=1, keepdims=True)
        high = np.minimum(radius[:, None], 1 - self._share[live])
        low = np.minimum(radius[:, None], self._share[live])
        table = np.zeros((n, q + k + 2 * f, f + 1))
        table[:, :q, :f] = np.where(counts[..., None], at.slopes, 0.0) * radius[:, None, None]
        table[:, :q, f] = np.where(counts, -1.0, 0.0)
        table[:, q : q + k, :f] = jacobian * radius[:, None, None]
        table[:, q + k : q + k + f, :f], table[:, q + k + f :, :f] = np.eye(f), -np.eye(f)
        limits = np.concatenate(
            [
                np.where(counts, worst - excess, 1.0),
                -(rows + _MARGIN),
                high / radius[:, None],
                low / radius[:, None],
            ],
            axis=1,
        )
        penalty = np.concatenate(
            [
                np.full((n, q), _OF_COSTS),
                np.repeat(self._penalty[live, None], k, axis=1),
                np.full((n, 2 * f), _OF_BOX),
            ],
            axis=1,
        )
        hessian, slope = np.zeros((n, f + 1, f + 1)), np.ones((n, f + 1))
        hessian[:, :f, :f] = self._curvature[live] * radius[:, None, None] ** 2
        hessian[:, f, f] = 1e-10
        slope[:, :f] = _OTHERS * at.slopes.sum(axis=1) * radius[:, None]
        minimum, multipliers = _minima(hessian, slope, table, limits, penalty)
        step = np.clip(minimum[:, :f] * radius[:, None], -low, high)
        costs, linear = at.costs + _times(at.slopes, step), rows + _times(jacobian, step)
        value = np.where(counts, costs - self._reference[live], -np.inf).max(axis=1)
        bend = 0.5 * (step * _times(self._curvature[live], step)).sum(axis=1)
        value += _OTHERS * costs.sum(axis=1) + bend
        before, after = (np.maximum(one + _MARGIN, 0.0).sum(axis=1) for one in (rows, linear))
        lost = self._penalty[live] * (before - after)
        of_rows = np.zeros_like(at.rows)
        np.put_along_axis(of_rows, places, multipliers[:, q : q + k], axis=1)
        inside = (step < high - _TINY) & (step > -low + _TINY)

        def corrected(full: _Merit) -> Float[Array, "n f"]:
            """The least step by which the active rows are met again where they curve."""
            of = self._of[places]
            error = np.zeros_like(linear)
            for one, violation in enumerate(full.violation.T):
                top = np.where(of == one, linear, -_OF_BOX).max(axis=1)
                error += np.where(of == one, (violation - top)[:, None], 0.0)
            error = np.concatenate([full.costs - costs, error], axis=1)
            active = multipliers[:, : q + k] > _ACTIVE
            active[:, :q] &= counts
            active &= np.isfinite(error)
            normals = table[:, : q + k].copy()
            normals[..., :f] *= inside[:, None] / radius[:, None, None]
            normals = np.where(active[..., None], normals, 0.0)
            product = normals @ normals.swapaxes(1, 2)
            diagonal = np.arange(q + k)
            size = np.maximum(product[:, diagonal, diagonal].max(axis=1, keepdims=True), 1.0)
            product[:, diagonal, diagonal] += np.where(active, 1e-9 * size, 1.0)
            wanted = np.where(active, error, 0.0)[..., None]
            shift = -_times(normals.swapaxes(1, 2), solve("active rows", product, wanted)[..., 0])
            length = np.abs(shift[:, :f]).max(axis=1, keepdims=True)
            near = length <= np.abs(step).max(axis=1, keepdims=True)
            return np.where(near, shift[:, :f], 0.0)

        return _Step(
            step=step,
            gain=worst[:, 0] + _OTHERS * at.costs.sum(axis=1) - value + lost,
            misses=np.maximum(linear + _MARGIN, 0.0).sum(axis=1),
            of_costs=np.where(counts, multipliers[:, :q], 0.0),
            of_rows=of_rows,
            corrected=corrected,
        )

    def _nearest(self, at: _Linear, radius: Array) -> tuple[Array, Array, Array]:
        """The rows that a step can reach first, their Jacobian and their places."""
        count = at.rows.shape[1]
        most = min(count, _ROWS * self._share.shape[1] + self._sizes.size)
        reach = at.rows + radius[:, None] * np.abs(at.jacobian).sum(axis=2)
        places = np.argsort(-reach, axis=1, kind="stable")[:, :most]
        rows = np.take_along_axis(at.rows, places, axis=1)
        return rows, np.take_along_axis(at.jacobian, places[..., None], axis=1), places

    def _linearized(self, live: Array) -> _Linear:
        problem, free = self._problem, self._free
        assert problem.gradient is not None
        self.gradients += live.size
        found = problem.gradient(self._values(self._share[live], live))
        self._of = found.constraint
        sizes = self._sizes[found.constraint]
        return _Linear(
            costs=found.objectives * self._sign,
            slopes=found.objectives_jacobian[..., free] * self._span * self._sign[:, None],
            rows=found.violation / sizes,
            jacobian=found.violation_jacobian[..., free] * self._span / sizes[:, None],
        )

    def _merit(self, share: Float[Array, "n f"], which: Array) -> _Merit:
        values = self._values(share, which)
        found = assessed(self._problem, values)
        costs = found.objectives * self._sign
        with np.errstate(invalid="ignore"):
            excess = np.where(self._counts[which], costs - self._reference[which], -np.inf)
            value = excess.max(axis=1) + _OTHERS * costs.sum(axis=1)
        violation = found.violation / self._sizes
        return _Merit(
            value=np.where(np.isfinite(value), value, np.inf),
            misses=np.maximum(violation + _MARGIN, 0.0).sum(axis=1),
            feasible=found.feasible,
            costs=costs,
            violation=violation,
        )

    def _values(self, share: Float[Array, "n f"], which: Array) -> Float[Array, "n d"]:
        values = self._start[which]
        values[:, self._free] = self._low + np.clip(share, 0.0, 1.0) * self._span
        return self._problem.allowed(values)


def _times(matrices: Float[Array, "n r f"], vectors: Float[Array, "n f"]) -> Float[Array, "n r"]:
    return (matrices @ vectors[..., None])[..., 0]


def _combined(weights: Float[Array, "n r"], rows: Float[Array, "n r f"]) -> Float[Array, "n f"]:
    return (weights[:, None] @ rows)[:, 0]


def _minima(
    hessian: Float[Array, "n f f"],
    slope: Float[Array, "n f"],
    rows: Float[Array, "n r f"],
    limits: Float[Array, "n r"],
    penalty: Float[Array, "n r"],
) -> tuple[Float[Array, "n f"], Float[Array, "n r"]]:
    """Minima y of y'Hy/2 + g'y + sum of penalties times max(Ay - b, 0), and their multipliers.

    A primal-dual interior-point method (Mehrotra, 1992) for all problems at once.
    """
    n, f = slope.shape
    y, over = np.zeros((n, f)), np.maximum(-limits, 0.0) + 0.1
    slack, dual = over + limits, np.minimum(penalty / 2, 1.0)
    ends, multipliers, live = y.copy(), dual.copy(), np.arange(n)
    diagonal = np.arange(f)
    for _ in range(_INTERIOR):
        miss = _times(rows, y) + slack - over - limits
        tilt = _times(hessian, y) + slope + _combined(dual, rows)
        rest = penalty - dual
        gap = ((dual * slack).sum(axis=1) + (rest * over).sum(axis=1)) / (2 * rows.shape[1])
        error = np.maximum(np.abs(miss).max(axis=1), np.abs(tilt).max(axis=1))
        ends[live], multipliers[live] = y, dual
        left = (gap >= _INTERIOR_GAP) | (error >= _INTERIOR_ERROR)
        if not left.any():
            break
        live, hessian, slope, rows, limits, penalty, y, over, slack, dual, miss, tilt, rest, gap = (
            one[left]
            for one in (
                live, hessian, slope, rows, limits, penalty, y, over, slack, dual, miss, tilt,
                rest, gap,
            )
        )  # fmt: skip
        weight = 1 / (slack / dual + over / rest)
        system = hessian + (rows * weight[..., None]).swapaxes(1, 2) @ rows
        system[:, diagonal, diagonal] = system[:, diagonal, diagonal] * (1 + 1e-11) + 1e-11
        inverse = inv("the model of a descent", system)

        def direction(of_slack: Array, of_over: Array) -> tuple[Array, Array, Array, Array]:
            shift = miss - of_slack / dual + of_over / rest  # noqa: B023
            dy = _times(inverse, -tilt - _combined(weight * shift, rows))  # noqa: B023
            dual_step = weight * (_times(rows, dy) + shift)  # noqa: B023
            return (
                dy,
                dual_step,
                -(of_slack + slack * dual_step) / dual,  # noqa: B023
                (over * dual_step - of_over) / rest,  # noqa: B023
            )

        _, dual_step, slack_step, over_step = direction(dual * slack, rest * over)
        length = _longest(
            (dual, dual_step), (rest, -dual_step), (slack, slack_step), (over, over_step)
        )
        reached = (
            ((dual + length * dual_step) * (slack + length * slack_step)).sum(axis=1)
            + ((rest - length * dual_step) * (over + length * over_step)).sum(axis=1)
        ) / (2 * rows.shape[1])
        target = (reached**3 / gap**2)[:, None]
        dy, dual_step, slack_step, over_step = direction(
            dual * slack + dual_step * slack_step - target,
            rest * over - dual_step * over_step - target,
        )
        length = 0.995 * _longest(
            (dual, dual_step), (rest, -dual_step), (slack, slack_step), (over, over_step)
        )
        y = y + length * dy
        dual = np.clip(dual + length * dual_step, _TINY, penalty * (1 - 10 * _TINY))
        slack = np.maximum(slack + length * slack_step, _TINY)
        over = np.maximum(over + length * over_step, _TINY)
    return ends, multipliers


def _longest(*pairs: tuple[Array, Array]) -> Float[Array, "n 1"]:
    """Largest share of the steps, at most 1, with which all values stay positive."""
    with np.errstate(over="ignore"):
        shares = [
            np.where(step < 0, value / np.maximum(-step, 1e-300), np.inf).min(axis=1)
            for value, step in pairs
        ]
    return np.minimum(np.minimum.reduce(shares), 1.0)[:, None]
