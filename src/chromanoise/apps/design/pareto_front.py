"""Optimization problems, their non-dominated fronts, and the schema of ``front.json``.

A problem has bounds, objectives, constraints and the function that computes them. No member of a
front dominates another one; a front can be thinned, and has extremes and a knee.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from itertools import combinations
from pathlib import Path
from typing import Annotated, Any, Final, Literal, TypeVar

import numpy as np

from chromanoise.base import (
    After,
    Array,
    Bool,
    Fault,
    Field,
    Float,
    InputError,
    Int64,
    Record,
    RecordError,
    Written,
    __version__,
    after,
    check,
    dataclass,
    dotted,
    first_bytes,
    json_text,
)
from chromanoise.io.spectra import QE_FACTS, SCHEMA_VERSION, held_json, spectra_csv
from chromanoise.sensor import Pixel
from chromanoise.spectra import Spectra
from chromanoise.study import ExposurePart, LightPart, PixelPart, matrix_makers

_SameRows = TypeVar("_SameRows", bound="Rows")


@dataclass(frozen=True, kw_only=True, eq=False)
class Rows:
    """Arrays with one row per candidate."""

    def some(self: _SameRows, which: Array) -> _SameRows:
        """Some of the rows.

        Parameters
        ----------
        which
            An index of numpy.
        """
        return replace(self, **{name: array[which] for name, array in self.arrays().items()})

    def joined(self: _SameRows, *others: _SameRows) -> _SameRows:
        """These rows and then those of others.

        Parameters
        ----------
        others
            Records of the same class.
        """
        parts = [one.arrays() for one in (self, *others)]
        return replace(
            self, **{name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        )

    def arrays(self) -> dict[str, Array]:
        """The arrays by name."""
        return {one.name: getattr(self, one.name) for one in fields(self)}


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluated(Rows):
    """Objectives and constraints of ``m`` candidates.

    Attributes
    ----------
    objectives
        Each in its own unit; infinite on the bad side where undefined or saturated, never NaN.
    violation
        By how much each constraint is violated, > 0; kept where <= 0.
    """

    objectives: Float[Array, "m q"]
    violation: Float[Array, "m r"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Linearized:
    """Objectives and constraints of ``m`` candidates with their exact derivatives.

    Attributes
    ----------
    objectives
        As in `Evaluated`.
    violation
        As in `Evaluated`; a constraint that is the largest of several smooth functions may have a
        row for each of these, always in the same order.
    objectives_jacobian, violation_jacobian
        Derivatives with respect to the ``d`` parameters, per unit of the parameter.
    constraint
        Index of the constraint of each row of ``violation``.
    """

    objectives: Float[Array, "m q"]
    violation: Float[Array, "m rows"]
    objectives_jacobian: Float[Array, "m q d"]
    violation_jacobian: Float[Array, "m rows d"]
    constraint: Int64[Array, " rows"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """An optimization problem: ``d`` parameters, ``q`` objectives, ``r`` constraints.

    Attributes
    ----------
    low, high
        Bounds of the parameters, each in its unit.
    objectives
        Names of the objectives.
    better
        ``higher`` or ``lower``, per objective.
    constraints
        Names of the constraints, as a sentence prints them.
    evaluate
        From values (m d) to `Evaluated`. A row of the result depends on the same row of the values
        only, to the last bit; then workers and chunks change no result.
    gradient
        From values (m d) to `Linearized`, a row for each; ``None`` if there are no exact
        derivatives.
    constraint_sizes
        Natural size of each violation, in its unit: violations are added as multiples of it. 1 for
        each if empty.
    integer
        Names of the parameters that take whole numbers only, e.g. the index of a choice.
    identity
        Text or hash of everything that determines ``evaluate``. A checkpoint of another identity
        is refused.

    Raises
    ------
    InputError
        If there is no parameter or no objective, a name is repeated, a bound is not finite, or the
        lower one is not below the upper one.
    """

    names: tuple[str, ...]
    low: Float[Array, " d"]
    high: Float[Array, " d"]
    objectives: tuple[str, ...]
    better: tuple[str, ...]
    evaluate: Callable[[Array], Evaluated]
    constraints: tuple[str, ...] = ()
    gradient: Callable[[Array], Linearized] | None = None
    constraint_sizes: tuple[float, ...] = ()
    integer: tuple[str, ...] = ()
    identity: str = ""

    def __post_init__(self) -> None:
        for what, names in (("parameter", self.names), ("objective", self.objectives)):
            if not names:
                raise InputError("the design", f"must have at least one {what}", found="has none")
            check.distinct(f"names of {what}s", names)
        for better in self.better:
            check.one_of("better", better, ("higher", "lower"))
        for name in self.integer:
            check.among("integer parameters", name, self.names)
        object.__setattr__(self, "low", check.finite("Problem.low", "1", self.low))
        object.__setattr__(self, "high", check.finite("Problem.high", "1", self.high))
        check.same_length(
            "parameters", names=len(self.names), low=self.low.size, high=self.high.size
        )
        check.same_length("objectives", objectives=len(self.objectives), better=len(self.better))
        sizes = self.constraint_sizes or (1.0,) * len(self.constraints)
        for size in sizes:
            check.positive("size of a constraint", "1", size)
        check.same_length("constraints", constraints=len(self.constraints), sizes=len(sizes))
        object.__setattr__(self, "constraint_sizes", sizes)
        for name, low, high in zip(self.names, self.low, self.high, strict=True):
            if not low < high:
                raise InputError(
                    name,
                    "must have a lower bound below its upper bound",
                    value=(float(low), float(high)),
                    found=f"goes from {low:g} to {high:g}",
                    remedy="swap the bounds, or give one number to hold the parameter",
                )
        check.freeze(self, "low", "high")

    def costs(self, objectives: Float[Array, "*m q"]) -> Float[Array, "*m q"]:
        """The objectives with their signs chosen so that lower is better.

        Parameters
        ----------
        objectives
            Values of the objectives, a row per candidate.
        """
        return objectives * np.array([1.0 if side == "lower" else -1.0 for side in self.better])

    def misses(self, violation: Float[Array, "m r"]) -> Float[Array, " m"]:
        """Sum of the broken constraints of each candidate, in their natural sizes; 0 if none is.

        Parameters
        ----------
        violation
            Violation of each constraint, a row per candidate; > 0 is broken.
        """
        return (np.maximum(violation, 0.0) / np.array(self.constraint_sizes)).sum(axis=1)

    @property
    def whole(self) -> Bool[Array, " d"]:
        """Which parameters take whole numbers only."""
        return np.array([name in self.integer for name in self.names])

    @property
    def exchanges(self) -> Int64[Array, "k d"]:
        """Orders of the parameters in which two parts with equal numbers have changed places.

        The part is the name before the first dot, as channel R in ``R.center_nm``.
        """
        parts: dict[str, dict[str, int]] = {}
        for place, name in enumerate(self.names):
            part, _, number = name.partition(".")
            parts.setdefault(part, {})[number or name] = place
        alike = [
            (list(one.values()), [other[number] for number in one])
            for one, other in combinations(parts.values(), 2)
            if one.keys() == other.keys()
        ]
        orders = np.tile(np.arange(len(self.names)), (len(alike), 1))
        for order, (one, other) in zip(orders, alike, strict=True):
            order[one + other] = other + one
        return orders

    def allowed(self, values: Float[Array, "m d"]) -> Float[Array, "m d"]:
        """The values with integer parameters rounded, within the bounds.

        Parameters
        ----------
        values
            Values of the parameters, a row per candidate.
        """
        rounded = np.where(self.whole, np.round(values), values)
        inner_low = np.where(self.whole, np.ceil(self.low), self.low)
        inner_high = np.where(self.whole, np.floor(self.high), self.high)
        return np.clip(rounded, inner_low, inner_high)


@dataclass(frozen=True, kw_only=True, eq=False)
class Assessed(Evaluated):
    """Evaluated candidates, with what a search compares.

    Attributes
    ----------
    values
        Of the parameters, each in its unit.
    costs
        As `Problem.costs`.
    misses
        As `misses_of`; 0 if a candidate is feasible.
    """

    values: Float[Array, "m d"]
    costs: Float[Array, "m q"]
    misses: Float[Array, " m"]

    @property
    def feasible(self) -> Bool[Array, " m"]:
        """Which candidates meet all constraints and have all objectives."""
        return self.misses == 0


def assessed(
    problem: Problem,
    values: Float[Array, "m d"],
    evaluate: Callable[[Array], Evaluated] | None = None,
) -> Assessed:
    """The evaluation of candidates, after a check for NaN and for its shape.

    Parameters
    ----------
    evaluate
        In place of ``problem.evaluate``, with the same results.

    Raises
    ------
    InputError
        If a value is NaN, or the shape does not fit the problem.
    """
    found = (evaluate or problem.evaluate)(values)
    sides = (
        ("objective", problem.objectives, np.asarray(found.objectives, dtype=float)),
        ("constraint", problem.constraints, np.asarray(found.violation, dtype=float)),
    )
    for what, names, array in sides:
        if array.shape != (len(values), len(names)):
            raise InputError(
                f"the {what}s",
                f"must have the shape {(len(values), len(names))}",
                found=f"have the shape {array.shape}",
            )
        bad = np.argwhere(np.isnan(array))
        if bad.size:
            row, column = (int(i) for i in bad[0])
            at = ", ".join(
                f"{name} = {value:g}"
                for name, value in zip(problem.names, values[row], strict=True)
            )
            raise InputError(
                f"the {what} {names[column]}",
                "must be a number for every candidate within the bounds",
                value=float("nan"),
                found=f"is NaN at {at}",
                remedy="narrow the bounds",
            )
    checked = Evaluated(objectives=sides[0][2], violation=sides[1][2])
    return Assessed(
        objectives=checked.objectives,
        violation=checked.violation,
        values=values,
        costs=problem.costs(checked.objectives),
        misses=misses_of(problem, checked),
    )


_ROUND = 0.1  # share of the surplus members that are dropped before crowding is computed anew
_HELD = 0.01  # a constraint holds a member if its slack is this share of the largest on the front


def non_dominated(costs: Float[Array, "m q"]) -> Bool[Array, " m"]:
    """Which candidates no other one dominates; of equal ones the first.

    Parameters
    ----------
    costs
        Lower is better.

    Examples
    --------
    >>> non_dominated(np.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]))
    array([ True,  True, False, False])
    """
    kept = np.zeros(len(costs), dtype=bool)
    left = np.lexsort((np.arange(len(costs)), *costs.T[::-1]))  # no candidate dominates an earlier
    while left.size:
        first = left[0]
        kept[first] = True
        left = left[(costs[left] < costs[first]).any(axis=1)]
    return kept


def merged(
    old: Float[Array, "k q"], new: Float[Array, "m q"]
) -> tuple[Bool[Array, " k"], Bool[Array, " m"]]:
    """Which of an old front and of new candidates form the front of both; of equal ones the old."""
    fresh = non_dominated(new)
    if not len(old) or not fresh.any():
        return np.ones(len(old), dtype=bool), fresh
    chosen = new[fresh]
    below = np.ones((len(old), len(chosen)), dtype=bool)  # old not above new in any cost
    above = np.ones_like(below)
    for column in range(new.shape[1]):
        one, other = old[:, column, None], chosen[None, :, column]
        below &= one <= other
        above &= one >= other
    fresh[np.flatnonzero(fresh)[below.any(axis=0)]] = False
    return np.all(below | ~above, axis=1), fresh


def crowding(costs: Float[Array, "m q"]) -> Float[Array, " m"]:
    """Crowding distance of each member of a front; infinite at the extremes.

    Notes
    -----
    Deb, Pratap, Agarwal & Meyarivan (2002).

    Examples
    --------
    >>> crowding(np.array([[0.0, 1.0], [0.1, 0.5], [0.2, 0.4], [1.0, 0.0]]))
    array([inf, 0.8, 1.4, inf])
    """
    distance = np.zeros(len(costs))
    for column in costs.T:
        order = np.argsort(column, kind="stable")
        span = column[order[-1]] - column[order[0]]
        distance[order[[0, -1]]] = np.inf
        if span > 0:
            distance[order[1:-1]] += (column[order[2:]] - column[order[:-2]]) / span
    return distance


def thinned(
    costs: Float[Array, "m q"], most: int, *, keep: Sequence[int] = ()
) -> Int64[Array, " k"]:
    """Indices of at most ``most`` members of a front, the most crowded ones dropped in rounds.

    Parameters
    ----------
    keep
        Indices of members that always stay, even where they are more than ``most``.
    """
    left = np.arange(len(costs))
    stays = np.isin(left, keep)
    most = max(most, int(stays.sum()))
    while left.size > most:
        surplus = left.size - most
        free = np.flatnonzero(~stays[left])
        order = free[np.argsort(crowding(costs[left])[free], kind="stable")]
        left = np.delete(left, order[: max(1, int(_ROUND * surplus))])
    return left


def scaled(costs: Float[Array, "m q"]) -> Float[Array, "m q"]:
    """Costs from 0, the lowest of the front, to 1, the highest; 0 where all are equal."""
    low, high = costs.min(axis=0), costs.max(axis=0)
    return (costs - low) / np.where(high > low, high - low, 1.0)


MOST_WITHOUT_PYMOO = 2
"""Most objectives whose `hypervolume` needs no optional package."""


def hypervolume(
    costs: Float[Array, "m q"], best: Float[Array, " q"], reference: Float[Array, " q"]
) -> float:
    """Share of the box between two points that the costs dominate. [1]

    Parameters
    ----------
    costs
        Lower is better; a point outside the box counts as its projection onto the box.
    best, reference
        The lowest and the highest corner of the box.

    Notes
    -----
    Zitzler & Thiele (1998); Fonseca, Paquete & Lopez-Ibanez (2006) in pymoo for three and more.

    Examples
    --------
    >>> round(hypervolume(np.array([[0.0, 0.5], [0.5, 0.0]]), np.zeros(2), np.ones(2)), 12)
    0.75
    >>> hypervolume(np.array([[0.5], [0.25]]), np.zeros(1), np.ones(1))
    0.75
    """
    span = np.where(reference > best, reference - best, 1.0)
    share = np.maximum((costs - best) / span, 0.0)
    share = share[(share < 1).all(axis=1)]
    if not len(share):
        return 0.0
    share = share[non_dominated(share)]
    if share.shape[1] == 1:
        return float(1.0 - share.min())
    if share.shape[1] <= MOST_WITHOUT_PYMOO:
        first, second = share[np.argsort(share[:, 0])].T
        return float(np.sum(np.diff(np.append(first, 1.0)) * (1.0 - second)))
    from pymoo.indicators.hv import Hypervolume

    return float(Hypervolume(ref_point=np.ones(share.shape[1]))(share))


def extremes(costs: Float[Array, "m q"]) -> Int64[Array, " q"]:
    """Index of the member with the lowest cost of each objective; of equal ones the best sum."""
    total = scaled(costs).sum(axis=1)
    return np.array([np.lexsort((total, column))[0] for column in costs.T])


def knee(costs: Float[Array, "m q"]) -> int:
    """Index of the member farthest below the plane through the extremes of the scaled front.

    Notes
    -----
    Das, "On characterizing the knee of the Pareto curve" (1999). With two objectives the extremes
    lie at (0, 1) and (1, 0), so the member of the lowest sum of scaled costs is the farthest.
    """
    return int(np.argmin(scaled(costs).sum(axis=1)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Member:
    """One design on the front.

    Attributes
    ----------
    name
        Such as ``best-snr_y_db``, ``knee`` or ``member-07``.
    values
        Of the parameters, each in its unit.
    sensor
        The sensor of these values, or ``None`` if the caller made none.
    objectives
        Value by name, in the objective's own unit.
    extreme_of
        The objectives of which no other member has a better value.
    knee
        Whether it is the knee of the front.
    active
        The constraints that hold it: their slack is at most 1 % of the largest on the front.
    """

    name: str
    values: Float[Array, " d"]
    sensor: Any
    objectives: Mapping[str, float]
    extreme_of: tuple[str, ...]
    knee: bool
    active: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Front:
    """The members of a front, ordered by the first objective, the best first.

    Attributes
    ----------
    objectives
        Names of the objectives.
    better
        ``higher`` or ``lower``, per objective.
    """

    objectives: tuple[str, ...]
    better: tuple[str, ...]
    members: tuple[Member, ...]

    @property
    def knee(self) -> Member:
        """The knee of the front."""
        return next(member for member in self.members if member.knee)

    @property
    def marked(self) -> tuple[Member, ...]:
        """The extremes and the knee."""
        return tuple(one for one in self.members if one.extreme_of or one.knee)

    def best(self, objective: str) -> Member:
        """The member with the best value of an objective.

        Parameters
        ----------
        objective
            Name of the objective.
        """
        return next(member for member in self.members if objective in member.extreme_of)


def front_of(
    problem: Problem,
    values: Float[Array, "k d"],
    objectives: Float[Array, "k q"],
    violation: Float[Array, "k r"],
    *,
    most: int = 100,
    sensor_of: Callable[[Array, str], Any] | None = None,
) -> Front:
    """The front of evaluated designs, thinned and named.

    Parameters
    ----------
    problem
        For the names and the better sides.
    values, objectives, violation
        As in `chromanoise.apps.design.FrontResult`.
    most
        Largest number of members; extremes and knee stay even if they are more.
    sensor_of
        The sensor of values (d,) and a name.
    """
    costs = problem.costs(objectives)
    best, middle = extremes(costs), knee(costs)
    chosen = thinned(costs, most, keep=[*best.tolist(), middle])
    order = chosen[np.lexsort((*costs[chosen].T[::-1],))]
    slack = -violation
    held = slack <= _HELD * np.maximum(slack.max(axis=0, initial=0.0), 0.0)
    digits = len(str(len(order)))
    members = []
    for number, index in enumerate(order, start=1):
        extreme_of = tuple(
            name for name, one in zip(problem.objectives, best, strict=True) if one == index
        )
        name = _name(extreme_of, bool(index == middle), f"member-{number:0{digits}}")
        members.append(
            Member(
                name=name,
                values=values[index],
                sensor=sensor_of(values[index], name) if sensor_of else None,
                objectives=dict(zip(problem.objectives, objectives[index].tolist(), strict=True)),
                extreme_of=extreme_of,
                knee=bool(index == middle),
                active=tuple(
                    one for one, on in zip(problem.constraints, held[index], strict=True) if on
                ),
            )
        )
    return Front(objectives=problem.objectives, better=problem.better, members=tuple(members))


def _name(extreme_of: Sequence[str], is_knee: bool, otherwise: str) -> str:
    if extreme_of:
        return f"best-{'-'.join(extreme_of)}"
    return "knee" if is_knee else otherwise


LARGEST = 1000
"""Most members of a final front."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Archive:
    """The front of all evaluated candidates, and the smallest violations of the constraints.

    Attributes
    ----------
    values, objectives, violation
        Of the members. Those with the lowest crowding distance are dropped when there are more
        than 2,000, down to 1,000.
    nearest
        Violations of the candidate that has met the constraints best so far.
    least
        Lowest violation of each constraint by any candidate.
    """

    values: Float[Array, "k d"]
    objectives: Float[Array, "k q"]
    violation: Float[Array, "k r"]
    nearest: Float[Array, " r"]
    least: Float[Array, " r"]

    def joined(self, problem: Problem, found: Assessed) -> "Archive":
        """The archive after a generation."""
        feasible = found.some(found.feasible)
        old = problem.costs(self.objectives)
        kept, fresh = merged(old, feasible.costs)
        new = feasible.some(fresh)
        costs = np.concatenate([old[kept], new.costs])
        chosen = thinned(costs, LARGEST) if len(costs) > 2 * LARGEST else np.arange(len(costs))
        sums = problem.misses(found.violation)
        best = found.violation[np.argmin(sums)]
        nearer = sums.min() < problem.misses(self.nearest[None])[0]
        return Archive(
            values=np.concatenate([self.values[kept], new.values])[chosen],
            objectives=np.concatenate([self.objectives[kept], new.objectives])[chosen],
            violation=np.concatenate([self.violation[kept], new.violation])[chosen],
            nearest=best if nearer else self.nearest,
            least=np.minimum(self.least, found.violation.min(axis=0)),
        )

    def thinned(self, problem: Problem) -> "Archive":
        """The archive with at most `LARGEST` members."""
        chosen = thinned(problem.costs(self.objectives), LARGEST)
        return replace(
            self,
            values=self.values[chosen],
            objectives=self.objectives[chosen],
            violation=self.violation[chosen],
        )


def empty_archive(problem: Problem) -> Archive:
    """The archive before the first generation."""
    d, q, r = len(problem.names), len(problem.objectives), len(problem.constraints)
    return Archive(
        values=np.empty((0, d)),
        objectives=np.empty((0, q)),
        violation=np.empty((0, r)),
        nearest=np.full(r, np.inf),
        least=np.full(r, np.inf),
    )


def misses_of(problem: Problem, found: Evaluated) -> Float[Array, " m"]:
    """`Problem.misses` of each candidate, and 1 for each infinite objective."""
    return problem.misses(found.violation) + (~np.isfinite(found.objectives)).sum(axis=1)


FRONT_SCHEMA: Final = "chromanoise front"
"""The value of the key ``schema``."""
_LARGEST_BYTES = 12_000_000


def _matrix(name: str) -> str:
    matrix_makers([name], "quanta")  # checks name and parameter
    return name


def _with_effect(pixel: PixelPart) -> PixelPart:
    """Without the values that a pixel has by default, some of which a study refuses as idle."""
    given = pixel.model_dump(exclude_none=True)
    usual = {one.name: one.default for one in fields(Pixel)}
    return PixelPart(**{key: value for key, value in given.items() if value != usual.get(key)})


ObjectiveValue = Annotated[float, Field(finite=True)] | None
"""The value of an objective; ``None`` where it is undefined or infinite."""
Share = Annotated[float, Field(ge=0, le=1)]
MatrixName = Annotated[str, After(_matrix)] | None
WithoutDefaults = Written(lambda part: part and part.model_dump(mode="json", exclude_defaults=True))
"""Writes only the keys of a table that differ from their defaults."""


class _Record(Record, unknown="ignored"):
    """Immutable; unknown keys are ignored, so that later versions can add some."""


class FrontObjective(_Record):
    """One objective of the search."""

    name: str = Field(description="Name, e.g. snr_y_db.")
    what: str = Field(description="What it is, in words.")
    unit: str = Field(description="Its unit; 1 if it has none.")
    better: Literal["higher", "lower"] = Field(description="Which values are better.")


class FrontScene(_Record):
    """An operating point of the search, with the tables of a study."""

    name: str = Field(description="Name.")
    light: Annotated[LightPart, WithoutDefaults] = Field(
        LightPart(), description="The table light of a study."
    )
    exposure: Annotated[ExposurePart, WithoutDefaults] = Field(
        ExposurePart(), description="The table exposure of a study."
    )
    matrix: MatrixName = Field(None, description="The color matrix, as a study names it.")


class FrontReference(_Record):
    """A sensor with which the members are compared."""

    name: str = Field(description="Name.")
    objectives: dict[str, ObjectiveValue] = Field(description="Value of each objective.")


class FrontCurves(_Record):
    """Quantum efficiency of a member, with filters, IR-cut and crosstalk."""

    wavelength_nm: list[float] = Field(description="Wavelengths [nm].")
    names: list[str] = Field(description="Names of the channels.")
    qe: list[list[Share]] = Field(description="One row per wavelength [e-/photon].")


class FrontMember(FrontReference):
    """A sensor of the front."""

    sensor: str = Field(description="Its file, relative to front.json.")
    extreme_of: list[str] = Field([], description="Objectives in which no member is better.")
    knee: bool = Field(False, description="Whether it is the knee of the front.")
    held_by: list[str] = Field([], description="Active constraints and bounds.")
    nominal: dict[str, ObjectiveValue] = Field(
        {}, description="Its objectives without tolerances, if the search took them over these."
    )
    robust: dict[str, ObjectiveValue] = Field(
        {}, description="Its worst objectives over the tolerances, if the search did not take them."
    )
    nominal_extreme_of: list[str] = Field(
        [], description="Objectives in which no member is better without tolerances."
    )
    robust_extreme_of: list[str] = Field(
        [], description="Objectives in which no member is better over the tolerances."
    )
    values: dict[str, float] = Field({}, description="Its free parameters.")
    curves: FrontCurves = Field(description="Its quantum efficiency.")
    pixel: Annotated[PixelPart, After(_with_effect), WithoutDefaults] = Field(
        PixelPart(), description="The table pixel of a study."
    )
    exposure: Annotated[ExposurePart | None, WithoutDefaults] = Field(
        None, description="Its own exposure, if the time is a free parameter."
    )
    matrix: MatrixName = Field(
        None, description="Its own color matrix, if the weight of the noise is a free parameter."
    )
    analyze: str = Field(
        "", description="Command for the folder of front.json that gives the same SNR of Y."
    )


class FrontMilestone(_Record):
    """The front after a number of evaluations."""

    evaluations: int = Field(description="Evaluated candidates.")
    hypervolume: Annotated[float, Field(ge=0, le=1)] | None = Field(
        description="Share that the front dominates of the box between the best values of the "
        "final front and the reference point; none for one objective."
    )
    best: dict[str, ObjectiveValue] = Field(description="Best value of each objective.")


class FrontSeed(_Record):
    """One of the independent populations of the search."""

    seed: int = Field(description="Its seed.")
    best: dict[str, ObjectiveValue] = Field(description="Its best value of each objective.")
    hypervolume: Annotated[float, Field(ge=0, le=1)] | None = Field(
        None, description="That of its front, in the box of the milestones."
    )


class FrontConvergence(_Record):
    """How far the search has converged."""

    converged: bool | None = Field(
        description="Whether the best values of the seeds agree within 0.05 dB or 1 %, and their "
        "hypervolumes within 1 %; none for one seed."
    )
    evaluations: int = Field(description="Evaluated candidates.")
    gradients: int = Field(description="Computed gradients.")
    undefined: int = Field(
        description="Evaluated candidates with an undefined objective, which count as infeasible."
    )
    seeds: list[FrontSeed] = Field(description="The populations.")
    spread: dict[str, ObjectiveValue] = Field(
        description="Difference of the best values of the seeds: in dB, otherwise relative to the "
        "best."
    )
    gain: dict[str, ObjectiveValue] = Field(
        description="Improvement of the best value of each objective by the final polish, in its "
        "unit."
    )
    reference: dict[str, ObjectiveValue] = Field(
        description="The reference point of the hypervolume."
    )
    milestones: list[FrontMilestone] = Field(description="The front over the evaluations.")


class FrontFile(_Record):
    """The content of ``front.json``."""

    schema_name: Literal["chromanoise front"] = Field(
        FRONT_SCHEMA, alias="schema", description="Kind of the file."
    )
    schema_version: int = Field(SCHEMA_VERSION, description="Version of this schema.")
    version: str = Field(__version__, description="Version of chromanoise that wrote the file.")
    objectives: list[FrontObjective] = Field(min_length=1, description="The objectives.")
    scenes: list[FrontScene] = Field([], description="The operating points of the search.")
    references: list[FrontReference] = Field(
        [], description="The sensors of the design file, for comparison."
    )
    members: list[FrontMember] = Field(min_length=1, description="The sensors of the front.")
    convergence: FrontConvergence | None = Field(
        None, description="How far the search has converged."
    )
    sentences: list[str] = Field([], description="One sentence per extreme and for the knee.")

    @after
    def _consistent(self) -> "FrontFile":
        names = [one.name for one in self.objectives]
        _refuse_repeated("objectives", names)
        _refuse_repeated("members", [one.name for one in (*self.references, *self.members)])
        for one in (*self.references, *self.members):
            if set(one.objectives) != set(names):
                raise InputError(
                    one.name,
                    f"must have a value for each of {', '.join(names)}",
                    value=tuple(one.objectives),
                    found=f"has {', '.join(one.objectives) or 'none'}",
                )
        return self

    def as_json(self) -> str:
        """The text of ``front.json``."""
        return json_text(self.model_dump(mode="json", by_alias=True), indent=1)


def read_front(path: Path | str) -> FrontFile:
    """The front in a file ``front.json``.

    Raises
    ------
    InputError
        If the file cannot be read, or is no front.
    """
    path = Path(path)
    content = first_bytes(path, _LARGEST_BYTES + 1)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(str(path), "is not a UTF-8 text file") from None
    if len(content) > _LARGEST_BYTES:
        limit = f"must have at most {_LARGEST_BYTES / 1e6:g} MB, as a front"
        raise InputError(str(path), limit, found="has more")
    return front_from_text(text, source=str(path))


def front_from_text(text: str, *, source: str) -> FrontFile:
    """The front in the text of ``front.json``.

    Parameters
    ----------
    source
        The name of the file, for errors.

    Raises
    ------
    InputError
        If it is not JSON, or has another schema or version; or the first wrong value, with its key.
    """
    data = held_json(text, FRONT_SCHEMA, source=source)
    try:
        return FrontFile.model_validate(data)
    except RecordError as error:
        raise _first_fault(error.faults[0], source) from None


def member_csv(member: FrontMember) -> str:
    """The curves of a member, as `read_sensor_csv` reads them.

    Parameters
    ----------
    member
        A member of the front.

    Raises
    ------
    InputError
        If the curves are invalid.
    """
    curves = member.curves
    shape = (len(curves.wavelength_nm), len(curves.names))
    if any(len(row) != shape[1] for row in curves.qe) or len(curves.qe) != shape[0]:
        raise InputError(
            f"curves of {member.name}",
            f"must be {shape[0]} rows (wavelengths) of {shape[1]} numbers (names)",
            found=f"has {len(curves.qe)} rows of {len(curves.qe[0]) if curves.qe else 0}",
        )
    spectra = Spectra(
        wavelength_nm=np.array(curves.wavelength_nm, dtype=float),
        values=np.array(curves.qe, dtype=float).reshape(shape),
        names=tuple(curves.names),
        quantity="QE",
        unit="e-/photon",
        source=member.name,
    )
    return spectra_csv(spectra, QE_FACTS)


def _refuse_repeated(subject: str, names: list[str]) -> None:
    repeated = [name for name, count in Counter(names).items() if count > 1]
    if repeated:
        raise InputError(subject, "must have different names", value=repeated[0])


def _first_fault(fault: Fault, source: str) -> InputError:
    place = dotted(fault.key)
    if fault.of_part:  # its subject is a table or the name of a sensor
        return fault.error.within(source, f"{place} {fault.error.subject}".strip())
    return fault.error.within(source, f"key {place!r}")
