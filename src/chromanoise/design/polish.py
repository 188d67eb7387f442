"""Improvement of the members of a front by exact gradients; no member becomes worse."""

from contextlib import suppress
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.design.archive import Archive, misses_of
from chromanoise.design.front import extremes, thinned
from chromanoise.design.problem import Evaluated, Linearized, Problem, checked_evaluation

_ITERATIONS = 100
_PRECISION = 1e-12  # of the sum of scaled costs
_MARGIN = 1e-9  # kept from each constraint, because SLSQP meets it within rounding only
_BACK = np.array([0.0, *np.geomspace(1e-9, 1e-2, 15)])  # steps from the end of a run to its start


class _UndefinedError(Exception):
    """An objective or a derivative is not finite at an iterate."""


def polished(problem: Problem, front: Archive, *, most: int) -> tuple[Archive, int]:
    """The front joined with improved members, and the number of computed gradients.

    From a member, the sum of the scaled costs is minimized while no cost rises (Benson, 1978);
    from each extreme, also its own objective alone, which extends the front. Both use SLSQP of
    scipy under the constraints. A result counts only if an ordinary evaluation confirms that it is
    feasible and, for a member, that it dominates; all members that it does not dominate are kept.

    Parameters
    ----------
    problem
        With gradients. Integer parameters keep their values.
    front
        A front of feasible members.
    most
        Largest number of members that are improved, evenly thinned.
    """
    costs = problem.costs(front.objectives)
    chosen = thinned(costs, most)
    count = len(problem.objectives)
    every = np.ones(count, dtype=bool)
    tasks = [(index, every, count > 1) for index in chosen]
    if count > 1:
        alone = np.eye(count, dtype=bool)
        tasks += [(index, alone[i], False) for i, index in enumerate(extremes(costs))]
    scale = np.ptp(costs, axis=0)
    scale = np.where(scale > 0, scale, np.maximum(np.abs(costs).max(axis=0), 1e-12))
    gradients, ends = 0, []
    for index, minimized, bounded in tasks:
        run = _Descent(problem, front.values[index], costs[index], scale, minimized, bounded)
        ends.append(run.ends())
        gradients += run.gradients
    values = problem.allowed(np.concatenate(ends))
    found = checked_evaluation(problem, values, problem.evaluate)
    feasible = (misses_of(problem, found) == 0).reshape(len(tasks), -1)
    first = np.arange(len(tasks)) * feasible.shape[1] + feasible.argmax(axis=1)
    found = Evaluated(objectives=found.objectives[first], violation=found.violation[first])
    return front.joined(problem, values[first], found).thinned(problem), gradients


class _Descent:
    """One run of SLSQP in the unit cube of the parameters, with scaled costs."""

    def __init__(
        self,
        problem: Problem,
        values: Float[Array, " d"],
        costs: Float[Array, " q"],
        scale: Float[Array, " q"],
        minimized: Array,
        bounded: bool,
    ) -> None:
        self.gradients = 0
        self._problem, self._start, self._costs = problem, values, costs
        self._scale, self._minimized, self._bounded = scale, minimized, bounded
        self._free = ~problem.whole
        self._low = problem.low[self._free]
        self._range = (problem.high - problem.low)[self._free]
        self._best = (0.0, values)  # scaled sum relative to the start, and where
        self._last: tuple[bytes, tuple[Any, ...]] = (b"", ())

    def ends(self) -> Float[Array, "k d"]:
        """Points from the last iterate toward the feasible start, and the best feasible iterate."""
        from scipy.optimize import minimize

        if not self._free.any():
            return np.tile(self._start, (_BACK.size + 1, 1))
        start = last = (self._start[self._free] - self._low) / self._range
        slack = {
            "type": "ineq",
            "fun": lambda share: -self._at(share)[2] - _MARGIN,
            "jac": lambda share: -self._at(share)[3],
        }
        with suppress(_UndefinedError):
            last = minimize(
                lambda share: self._at(share)[0],
                start,
                jac=lambda share: self._at(share)[1],
                method="SLSQP",
                bounds=[(0.0, 1.0)] * start.size,
                constraints=[slack] if len(self._at(start)[2]) else [],
                options={"maxiter": _ITERATIONS, "ftol": _PRECISION},
            ).x
        path = np.tile(self._start, (_BACK.size, 1))
        path[:, self._free] = self._low + (last + _BACK[:, None] * (start - last)) * self._range
        return np.vstack([path, self._best[1]])

    def _at(self, share: Float[Array, " f"]) -> tuple[Any, ...]:
        """Scaled cost and limits with their derivatives; SLSQP reads each of them separately."""
        key = share.tobytes()
        if self._last[0] != key:
            self._last = key, self._linearized(np.clip(share, 0.0, 1.0))
        return self._last[1]

    def _linearized(self, share: Float[Array, " f"]) -> tuple[Any, ...]:
        values = self._start.copy()
        values[self._free] = self._low + share * self._range
        assert self._problem.gradient is not None
        self.gradients += 1
        found: Linearized = self._problem.gradient(values)
        sign = self._problem.costs(np.ones(len(self._scale)))
        above = (found.objectives * sign - self._costs) / self._scale
        slope = (sign / self._scale)[:, None] * found.objectives_jacobian[:, self._free]
        limit, limit_slope = found.violation, found.violation_jacobian[:, self._free]
        if self._bounded:
            limit = np.concatenate([limit, above])
            limit_slope = np.concatenate([limit_slope, slope])
        parts = (
            above[self._minimized].sum(),
            (slope * self._range)[self._minimized].sum(axis=0),
            limit,
            limit_slope * self._range,
        )
        if not all(np.isfinite(part).all() for part in parts):
            raise _UndefinedError
        if (limit <= 0).all() and parts[0] < self._best[0]:
            self._best = float(parts[0]), values
        return parts
