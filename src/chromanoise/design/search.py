"""Search for the front of a design problem: generations, checkpoint, progress and polish."""

import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.design.algorithms import (
    METHODS,
    Algorithm,
    algorithm_of,
    generation_rng,
    latin_hypercube,
)
from chromanoise.design.archive import empty_archive, misses_of
from chromanoise.design.checkpoint import Checkpoint, read_checkpoint, write_checkpoint
from chromanoise.design.polish import polished
from chromanoise.design.problem import Problem, checked_evaluation
from chromanoise.design.scheduler import Scheduler
from chromanoise.errors import InputError, Setting

LEAST_POPULATION = 4
"""Fewest candidates per generation: differential evolution combines three besides the parent."""
MOST_POPULATION = 100_000
"""Most candidates per generation."""
_WRITTEN_EVERY_S = 2.0
_SAME = 1e-9  # relative difference of a candidate evaluated on another machine


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """Method, effort and seed of a search.

    Attributes
    ----------
    method
        A name in `chromanoise.design.algorithms.METHODS`.
    budget
        Largest number of evaluated candidates. Only whole generations are evaluated.
    population
        Candidates per generation.
    seed
        Of the random numbers.
    polish
        Whether members of the front are improved by exact gradients after the search. These
        evaluations are counted apart from the budget.

    Raises
    ------
    InputError
        If the method is unknown, the population is not 4 to 100,000, the budget is less than one
        population, or the seed is not an integer >= 0.
    """

    method: str = "nsga2"
    budget: int = 20_000
    population: int = 100
    seed: int = 0
    polish: bool = False

    def __post_init__(self) -> None:
        _check.one_of("method", self.method, tuple(METHODS))
        if not LEAST_POPULATION <= self.population <= MOST_POPULATION:
            raise InputError(
                "population",
                f"must be {LEAST_POPULATION} to {MOST_POPULATION}",
                value=self.population,
            )
        if self.budget < self.population:
            raise InputError(
                "budget",
                f"must be at least one population of {self.population} candidates",
                value=self.budget,
                remedy=(Setting("budget", (self.population,)), Setting("population")),
            )
        generation_rng(self.seed, 0)


DEFAULT_SEARCH = SearchSettings()
"""Method and effort of a search that names none."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Progress:
    """A search after a generation.

    Attributes
    ----------
    generation, evaluations
        Finished generations and evaluated candidates.
    budget
        Largest number of evaluations.
    values, objectives
        The front so far, in the units of parameters and objectives; empty until a candidate meets
        all constraints.
    """

    generation: int
    evaluations: int
    budget: int
    values: Float[Array, "k d"]
    objectives: Float[Array, "k q"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SearchResult:
    """The front: feasible candidates of which none dominates another.

    Attributes
    ----------
    values
        Of the parameters, each in its unit. At most 1,000 members.
    objectives
        Each in its own unit.
    violation
        Of the constraints, <= 0: the negative slack.
    generations, evaluations
        Generations and candidates that were evaluated in the search.
    gradient_evaluations
        Gradients that the polish computed.
    """

    values: Float[Array, "k d"]
    objectives: Float[Array, "k q"]
    violation: Float[Array, "k r"]
    generations: int
    evaluations: int
    gradient_evaluations: int


def searched_front(
    problem: Problem,
    settings: SearchSettings,
    *,
    start: Float[Array, "m d"] | None = None,
    checkpoint: Path | None = None,
    resume: bool = False,
    evaluate_on: Scheduler | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> SearchResult:
    """The front of all candidates that a search evaluates.

    The first generation is ``start`` and a Latin hypercube. Candidates with an infinite objective
    are never members. The result depends on problem, settings and start only, not on interruptions
    or workers.

    Parameters
    ----------
    problem, settings
        What is searched, and how.
    start
        Values that join the first generation, within the bounds, at most one population.
    checkpoint
        File that is replaced every two seconds, at the end, and on Ctrl-C.
    resume
        Whether to continue from that file; the budget may be larger than before.
    evaluate_on
        A cluster on which candidates are evaluated; this process if ``None``.
    progress
        Called after each generation.

    Raises
    ------
    InputError
        If the method does not fit the problem, ``start`` is outside the bounds, the checkpoint
        belongs to another search, an evaluation is NaN, or no candidate meets the constraints.
    KeyboardInterrupt
        After Ctrl-C, when the checkpoint of the last finished generation has been written.
    """
    algorithm = algorithm_of(problem, settings.method, settings.population, settings.seed)
    if settings.polish and problem.gradient is None:
        raise InputError(
            "polish",
            "needs objectives with exact gradients",
            value=True,
            found="this design has none",
            remedy=Setting("polish", (False,)),
        )
    evaluate = evaluate_on.evaluation_of(problem) if evaluate_on else problem.evaluate
    first = _first_generation(problem, settings, start)
    same = _common(problem, settings, first)
    now = Checkpoint(
        search=same, generation=0, evaluations=0, archive=empty_archive(problem), algorithm={}
    )
    if resume:
        now = _resumed(problem, settings, checkpoint, now, algorithm)
    written = time.monotonic()
    try:
        while now.evaluations + settings.population <= settings.budget:
            rng = generation_rng(settings.seed, now.generation)
            values = algorithm.ask(rng) if now.generation else first
            if not len(values):  # every combination of integer parameters was tried
                break
            found = checked_evaluation(problem, values, evaluate)
            misses = misses_of(problem, found)
            defined = np.isfinite(found.objectives).all(axis=1, keepdims=True)
            costs = np.where(defined, problem.costs(found.objectives), 0.0)
            algorithm.tell(values, costs, misses, rng)
            now = Checkpoint(
                search=same,
                generation=now.generation + 1,
                evaluations=now.evaluations + len(values),
                archive=now.archive.joined(problem, values, found),
                algorithm=algorithm.state(),
            )
            if progress:
                progress(_progress(now, settings))
            if checkpoint and time.monotonic() > written + _WRITTEN_EVERY_S:
                write_checkpoint(checkpoint, now)
                written = time.monotonic()
    finally:
        if checkpoint and now.generation:
            write_checkpoint(checkpoint, now)
    _refuse_infeasible(problem, now)
    front, gradients = now.archive.thinned(problem), 0
    if settings.polish:
        front, gradients = polished(problem, front, most=settings.population)
    return SearchResult(
        values=front.values,
        objectives=front.objectives,
        violation=front.violation,
        generations=now.generation,
        evaluations=now.evaluations,
        gradient_evaluations=gradients,
    )


def _first_generation(
    problem: Problem, settings: SearchSettings, start: Float[Array, "m d"] | None
) -> Float[Array, "n d"]:
    given = np.empty((0, len(problem.names))) if start is None else np.asarray(start, dtype=float)
    if given.ndim != 2 or given.shape[1] != len(problem.names):
        raise InputError(
            "start",
            f"must have the shape (m, {len(problem.names)})",
            found=f"has the shape {given.shape}",
        )
    if len(given) > settings.population:
        raise InputError(
            "start",
            f"must hold at most one population of {settings.population} candidates",
            value=len(given),
            found=f"holds {len(given)}",
            remedy=Setting("population", (len(given),)),
        )
    outside = np.argwhere(~((given >= problem.low) & (given <= problem.high)))
    if outside.size:
        row, column = (int(i) for i in outside[0])
        raise InputError(
            "start",
            f"must keep {problem.names[column]} within {problem.low[column]:g} to "
            f"{problem.high[column]:g}",
            value=float(given[row, column]),
            where=f"candidate {row + 1}",
            remedy="widen the bounds",
        )
    rng = generation_rng(settings.seed, 0)
    rest = latin_hypercube(problem, settings.population - len(given), rng)
    return np.concatenate([problem.allowed(given), rest])


def _common(problem: Problem, settings: SearchSettings, first: Array) -> dict[str, Any]:
    """What a resumed search must share with the stopped one, by its name in messages."""
    return {
        "method": settings.method,
        "seed": settings.seed,
        "population": settings.population,
        "parameters": list(problem.names),
        "bounds": [problem.low.tolist(), problem.high.tolist()],
        "integer parameters": list(problem.integer),
        "objectives": [
            f"{side} {o}" for o, side in zip(problem.objectives, problem.better, strict=True)
        ],
        "constraints": list(problem.constraints),
        "identity": problem.identity,
        "first generation": hashlib.sha256(first.tobytes()).hexdigest(),
    }


def _resumed(
    problem: Problem,
    settings: SearchSettings,
    path: Path | None,
    empty: Checkpoint,
    algorithm: Algorithm,
) -> Checkpoint:
    if path is None:
        raise InputError("checkpoint", "must be given to resume a search")
    now = read_checkpoint(path, empty.search, empty.archive)
    if now.evaluations > settings.budget:
        raise InputError(
            "budget",
            "must not be smaller than that of the search that is resumed",
            value=settings.budget,
            found=f"is {settings.budget}, and {path} has {now.evaluations} evaluations",
            remedy=Setting("budget", (now.evaluations,)),
        )
    if not _agrees(problem, now):
        raise InputError(
            str(path),
            "must be of the same design",
            found="the first member of its front has other objectives here",
            remedy="start the search anew without resume",
        )
    algorithm.restore(dict(now.algorithm))
    return now


def _agrees(problem: Problem, now: Checkpoint) -> bool:
    """Whether the first member of the front has the same objectives here."""
    values, objectives = now.archive.values[:1], now.archive.objectives[:1]
    if not len(values):
        return True
    again = checked_evaluation(problem, values, problem.evaluate)
    return np.allclose(again.objectives, objectives, rtol=_SAME, atol=_SAME)


def _progress(now: Checkpoint, settings: SearchSettings) -> Progress:
    return Progress(
        generation=now.generation,
        evaluations=now.evaluations,
        budget=settings.budget,
        values=now.archive.values,
        objectives=now.archive.objectives,
    )


def _refuse_infeasible(problem: Problem, now: Checkpoint) -> None:
    """Raise an error that names the violated constraints, if no candidate was feasible."""
    archive = now.archive
    if len(archive.values):
        return
    count = f"of {now.evaluations} candidates"
    never = archive.least > 0
    missed = never if never.any() else archive.nearest > 0
    if not missed.any():
        raise InputError(
            "the objectives",
            "must be defined for a candidate that meets the constraints",
            found=f"are undefined or saturated for all {count}",
            remedy="allow a shorter exposure or less light",
        )
    amounts = archive.least if never.any() else archive.nearest
    by = " and ".join(
        f"{name} by {amount:.3g}"
        for name, amount, on in zip(problem.constraints, amounts, missed, strict=True)
        if on
    )
    found = (
        f"none {count} meets {by.split(' by ')[0]}; the nearest misses {by}"
        if never.sum() == 1
        else f"none {count} meets all; the nearest {'ones miss' if never.any() else 'misses'} {by}"
    )
    raise InputError(
        "the constraints",
        "must be met together by a candidate within the bounds",
        value=tuple(name for name, on in zip(problem.constraints, missed, strict=True) if on),
        found=found,
        remedy=("relax a constraint", "widen the bounds", Setting("budget")),
    )
