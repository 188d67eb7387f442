"""An optimization problem: bounds, objectives, constraints and the function that computes them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Int64
from chromanoise.errors import InputError


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evaluated:
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Linearized:
    """Objectives and constraints of one candidate with their exact derivatives.

    Attributes
    ----------
    objectives
        As in `Evaluated`, of one candidate.
    violation
        As in `Evaluated`; a constraint that is the largest of several smooth functions may have a
        row for each of these, always in the same order.
    objectives_jacobian, violation_jacobian
        Derivatives with respect to the ``d`` parameters, per unit of the parameter.
    constraint
        Index of the constraint of each row of ``violation``.
    """

    objectives: Float[Array, " q"]
    violation: Float[Array, " rows"]
    objectives_jacobian: Float[Array, "q d"]
    violation_jacobian: Float[Array, "rows d"]
    constraint: Int64[Array, " rows"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """An optimization problem: ``d`` parameters, ``q`` objectives, ``r`` constraints.

    Attributes
    ----------
    names
        Of the parameters.
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
        From values (d,) to `Linearized`; ``None`` if there are no exact derivatives.
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
            _check.distinct(f"names of {what}s", names)
        for better in self.better:
            _check.one_of("better", better, ("higher", "lower"))
        for name in self.integer:
            _check.among("integer parameters", name, self.names)
        object.__setattr__(self, "low", _check.finite("Problem.low", "1", self.low))
        object.__setattr__(self, "high", _check.finite("Problem.high", "1", self.high))
        _check.same_length(
            "parameters", names=len(self.names), low=self.low.size, high=self.high.size
        )
        _check.same_length("objectives", objectives=len(self.objectives), better=len(self.better))
        sizes = self.constraint_sizes or (1.0,) * len(self.constraints)
        for size in sizes:
            _check.positive("size of a constraint", "1", size)
        _check.same_length("constraints", constraints=len(self.constraints), sizes=len(sizes))
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
        _check.freeze(self, "low", "high")

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


def checked_evaluation(
    problem: Problem, values: Float[Array, "m d"], evaluate: Callable[[Array], Evaluated]
) -> Evaluated:
    """The evaluation of candidates, after a check for NaN and for its shape.

    Raises
    ------
    InputError
        If a value is NaN, or the shape does not fit the problem.
    """
    found = evaluate(values)
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
    return Evaluated(objectives=sides[0][2], violation=sides[1][2])
