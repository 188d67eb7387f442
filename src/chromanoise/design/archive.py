"""All non-dominated feasible candidates of a search, in bounded memory."""

from dataclasses import dataclass

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.design.front import merged, thinned
from chromanoise.design.problem import Evaluated, Problem

LARGEST = 1000
"""Most members of a final front."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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

    def joined(self, problem: Problem, values: Float[Array, "m d"], found: Evaluated) -> "Archive":
        """The archive after a generation."""
        feasible = misses_of(problem, found) == 0
        costs = problem.costs(found.objectives)
        old = problem.costs(self.objectives)
        kept, fresh = merged(old, costs[feasible])
        costs = np.concatenate([old[kept], costs[feasible][fresh]])
        chosen = thinned(costs, LARGEST) if len(costs) > 2 * LARGEST else np.arange(len(costs))

        def together(own: Array, new: Array) -> Array:
            return np.concatenate([own[kept], new[feasible][fresh]])[chosen]

        sums = problem.misses(found.violation)
        best = found.violation[np.argmin(sums)]
        nearer = sums.min() < problem.misses(self.nearest[None])[0]
        return Archive(
            values=together(self.values, values),
            objectives=together(self.objectives, found.objectives),
            violation=together(self.violation, found.violation),
            nearest=best if nearer else self.nearest,
            least=np.minimum(self.least, found.violation.min(axis=0)),
        )

    def thinned(self, problem: Problem) -> "Archive":
        """The archive with at most `LARGEST` members."""
        chosen = thinned(problem.costs(self.objectives), LARGEST)
        return Archive(
            values=self.values[chosen],
            objectives=self.objectives[chosen],
            violation=self.violation[chosen],
            nearest=self.nearest,
            least=self.least,
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
