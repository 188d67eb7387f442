"""Search for the front of a design problem: generations, checkpoints, convergence, dask cluster.

An evaluation on a cluster has the results of one process. A stopped search continues from its
checkpoint with the same digits. A checkpoint holds plain arrays and one JSON text in the form of
``numpy.savez``, no pickled objects. The comment of this ZIP archive is the SHA-256 of the archive
without it; a changed file is refused.
"""

import hashlib
import io
import json
import re
import threading
import time
import zipfile
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import fields, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.apps.design.algorithms import (
    METHODS,
    State,
    algorithm_of,
    generation_rng,
    latin_hypercube,
)
from chromanoise.apps.design.descents import Improved, gradients_at_most, improved
from chromanoise.apps.design.pareto_front import (
    LARGEST,
    Archive,
    Assessed,
    Evaluated,
    Problem,
    assessed,
    empty_archive,
    hypervolume,
    merged,
    thinned,
)
from chromanoise.base import (
    Array,
    Float,
    InputError,
    Setting,
    check,
    dataclass,
    json_of,
    regular_file,
    system_errors_of,
    write_kept,
)
from chromanoise.imaging import client_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Scheduler:
    """A cluster on which candidates are evaluated, in as many chunks as it has threads.

    Attributes
    ----------
    executor
        Of dask, which evaluates the chunks of a killed worker again.
    """

    executor: Executor
    threads: int

    def evaluation_of(self, problem: Problem) -> Callable[[Array], Evaluated]:
        """``problem.evaluate`` on the cluster; a worker decodes the problem once."""
        import cloudpickle

        return partial(self._evaluated, cloudpickle.dumps(problem.evaluate))

    def _evaluated(self, evaluate: bytes, values: Array) -> Evaluated:
        chunks = np.array_split(values, min(self.threads, len(values)))
        tasks = [self.executor.submit(_evaluated_there, evaluate, chunk) for chunk in chunks]
        first, *others = (task.result() for task in tasks)
        return first.joined(*others)


@contextmanager
def scheduler_at(address: str, *, workers: int | None = None) -> Iterator[Scheduler]:
    """A dask cluster for `chromanoise.apps.design.searched_front`.

    Parameters
    ----------
    address
        Such as ``tcp://host:8786``, whose workers need chromanoise; ``local`` for processes of this
        machine.
    workers
        Number of processes for ``local``; one per core if ``None``.

    Raises
    ------
    InputError
        As ``client_of``, or if the address has no port.
    """
    if address != "local" and not re.fullmatch(r"(\w+://)?[^/]+:\d+", address):
        raise InputError(
            "scheduler", "must be an address with a port, as tcp://host:8786, or local",
            value=address,
        )  # fmt: skip
    with client_of(address, workers=workers, smaller=Setting("population")) as client:
        threads = sum(client.nthreads().values())
        yield Scheduler(executor=client.get_executor(pure=False), threads=max(threads, 1))


def _evaluated_there(evaluate: bytes, values: Array) -> Evaluated:
    """Runs in another process."""
    return _decoded(evaluate)(values)


@lru_cache(maxsize=2)
def _decoded(evaluate: bytes) -> Callable[[Array], Evaluated]:
    import cloudpickle

    return cloudpickle.loads(evaluate)


_FORM = 3
_MOST_BYTES, _DIGEST_BYTES = 4 << 30, 64
_DAMAGED = (
    OSError, ValueError, KeyError, TypeError, EOFError, MemoryError, zipfile.BadZipFile,
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Checkpoint:
    """A search after a generation.

    Attributes
    ----------
    search
        What the search must have in common with one that continues it, as plain data.
    generation, evaluations
        Numbers of finished generations and of evaluated candidates.
    archive
        The front so far.
    algorithm
        State of the method.
    """

    search: Mapping[str, Any]
    generation: int
    evaluations: int
    archive: Archive
    algorithm: Mapping[str, Array]


def write_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write the file in one step.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    archive = {one.name: getattr(checkpoint.archive, one.name) for one in fields(Archive)}
    arrays = _prefixed("archive.", archive) | _prefixed("algorithm.", checkpoint.algorithm)
    text = json.dumps(
        {
            "form": _FORM,
            "search": checkpoint.search,
            "generation": checkpoint.generation,
            "evaluations": checkpoint.evaluations,
        }
    )
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, checkpoint=np.array(text), **arrays)
    write_kept(path, _sealed(content.getvalue()))


def read_checkpoint(path: Path, search: Mapping[str, Any], empty: Archive) -> Checkpoint:
    """The checkpoint of a search.

    Parameters
    ----------
    path
        A file of `write_checkpoint`.
    search
        As in `Checkpoint`; must equal that of the file.
    empty
        An archive without members, for the expected shapes.

    Raises
    ------
    InputError
        If there is no such file, it is damaged, or it belongs to another search.
    """
    if regular_file(path).st_size > _MOST_BYTES:
        raise _damaged(path, f"has more than {_MOST_BYTES >> 20} MiB")
    with system_errors_of(path):
        archive_bytes = _unsealed(path.read_bytes())
    if archive_bytes is None:
        raise _damaged(path, "was changed or truncated, as its content hash shows")
    try:
        with np.load(io.BytesIO(archive_bytes), allow_pickle=False) as stored:
            text = json_of(str(stored["checkpoint"]), str(path))
            arrays = {name: stored[name] for name in stored.files if name != "checkpoint"}
        if text["form"] != _FORM or min(text["generation"], text["evaluations"]) < 0:
            raise ValueError
        theirs, generation, evaluations = (
            dict(text["search"]), int(text["generation"]), int(text["evaluations"]),
        )  # fmt: skip
        archive = Archive(**_without_prefix("archive.", arrays))
    except _DAMAGED:
        raise _damaged(path, "cannot be read as one") from None
    for name, own in search.items():
        if theirs.get(name) != own:
            raise InputError(
                str(path),
                f"must be of a search with the same {name}",
                value=theirs.get(name),
                found=_difference(name, theirs.get(name), own),
                remedy="start the search anew without resume",
            )
    for field in fields(Archive):
        if getattr(archive, field.name).shape[1:] != getattr(empty, field.name).shape[1:]:
            raise _damaged(path, f"its {field.name} have another shape")
    return Checkpoint(
        search=theirs,
        generation=generation,
        evaluations=evaluations,
        archive=archive,
        algorithm=_without_prefix("algorithm.", arrays),
    )


def _prefixed(prefix: str, arrays: Mapping[str, Array]) -> State:
    return {f"{prefix}{name}": array for name, array in arrays.items()}


def _without_prefix(prefix: str, arrays: Mapping[str, Array]) -> State:
    """The arrays of `_prefixed` among others."""
    return {
        name.removeprefix(prefix): array
        for name, array in arrays.items()
        if name.startswith(prefix)
    }


def _sealed(archive: bytes) -> bytes:
    """The ZIP archive with its SHA-256 as its comment, whose length is in its last two bytes."""
    digest = hashlib.sha256(archive).hexdigest().encode()
    return archive[:-2] + len(digest).to_bytes(2, "little") + digest


def _unsealed(content: bytes) -> bytes | None:
    """The archive of `_sealed`; ``None`` if one of its bytes was changed."""
    archive = content[: -_DIGEST_BYTES - 2] + bytes(2)
    return archive if _sealed(archive) == content else None


def _damaged(path: Path, found: str) -> InputError:
    return InputError(
        str(path),
        "must be a complete checkpoint of a search",
        found=found,
        remedy="start the search anew without resume",
    )


def _difference(name: str, theirs: Any, own: Any) -> str:
    if name in ("identity", "first generation") or not isinstance(own, int | str):
        return f"its {name} differ"
    return f"its {name} is {theirs}, not {own}"


MOST_POPULATION = 100_000
_BOUNDS = {
    "budget": (1, 10**12),
    "population": (4, MOST_POPULATION),  # differential evolution combines three and the parent
    "seed": (0, 2**32 - 1),
    "seeds": (1, 16),
}
_WRITTEN_EVERY_S, _TOLD_EVERY_S = 2.0, 1.0
_SAME = 1e-9  # relative difference of a candidate evaluated on another machine
_EVALUATIONS_PER_GRADIENT = 2
_LEAST_GRADIENTS = 2000  # per objective
_OF_HISTORY = 64  # members of a front of which the hypervolume is kept
_BEYOND = 0.1  # of the range of the front: from its worst values to the reference point
_NUMERICAL = (InputError, ArithmeticError, ValueError, RuntimeWarning)  # also of linear solvers


@dataclass(frozen=True, kw_only=True)
class SearchOptions:
    """Method, effort and seed of a search.

    Attributes
    ----------
    method
        A name in ``METHODS``.
    budget
        Largest number of evaluated candidates. Only whole generations are evaluated.
    seed
        Seed of the random numbers of the first population; the other populations have the
        following integers.
    seeds
        Number of independent populations, which share the budget. Their agreement measures the
        convergence.
    polish
        Whether gradients improve the candidates along the front after the search. Gradients are
        not part of the budget. ``None`` improves them if the problem has gradients.

    Raises
    ------
    InputError
        If the method is unknown, the population is not 4 to 100,000, the budget is less than one
        population, the seed is not 0 to 2^32 - 1, or the seeds are not 1 to 16.
    """

    method: str = "nsga2"
    budget: int = 20_000
    population: int = 100
    seed: int = 0
    seeds: int = 3
    polish: bool | None = None

    def __post_init__(self) -> None:
        method = check.one_of("method", self.method, tuple(METHODS))
        object.__setattr__(self, "method", method)
        for name, (least, most) in _BOUNDS.items():
            value = getattr(self, name)
            if not (isinstance(value, int) and least <= value <= most):
                demand = f"must be a whole number, {least} to {most}"
                raise InputError(name, demand, value=value)
        if self.budget < self.population:
            raise InputError(
                "budget",
                f"must be at least one population of {self.population} candidates",
                value=self.budget,
                remedy=(Setting("budget", (self.population,)), "choose a smaller population"),
            )


DEFAULT_SEARCH = SearchOptions()
"""Method and effort of a search that names none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Progress:
    """A search after a generation, or during its polish.

    Attributes
    ----------
    generation, evaluations
        Finished generations and evaluated candidates.
    budget
        Largest number of evaluations.
    values, objectives
        The front so far, in the units of parameters and objectives; empty until a candidate meets
        all constraints.
    gradients, most_gradients
        Gradients that the polish has computed, and about how many it computes at most; 0 before it.
    """

    generation: int
    evaluations: int
    budget: int
    values: Float[Array, "k d"]
    objectives: Float[Array, "k q"]
    gradients: int = 0
    most_gradients: int = 0


@dataclass(frozen=True, kw_only=True, eq=False)
class Milestone:
    """The front after a number of evaluations.

    Attributes
    ----------
    hypervolume
        Share that the front (64 members of it, at the end 1,000) dominates of the box between the
        best values of the final front and the reference point, 0 to 1. ``None`` for one objective.
    best
        Best value of each objective.
    """

    evaluations: int
    hypervolume: float | None
    best: Float[Array, " q"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Convergence:
    """How far a search has converged.

    Attributes
    ----------
    milestones
        The front after 1, 2, 4 ... generations of all populations, and the final one last.
    reference
        The reference point of the hypervolume: beyond the worst values of the final front by 10 %
        of its range.
    seeds
        Seed of each population.
    best
        Best value of each objective in each population, polish included. If a population has no
        feasible candidate, the value is infinite with the sign of a bad value.
    hypervolumes
        Of the front of each population, polish included, in the same box; ``None`` for one
        objective.
    gain
        Improvement of the best value of each objective by the final polish, >= 0; NaN if there was
        no polish.
    failures
        Errors that ended a polish early, each as one sentence.
    """

    milestones: tuple[Milestone, ...]
    reference: Float[Array, " q"]
    seeds: tuple[int, ...]
    best: Float[Array, "k q"]
    hypervolumes: tuple[float | None, ...]
    gain: Float[Array, " q"]
    failures: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class FrontResult:
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
    undefined
        Evaluated candidates with an undefined objective, such as those without signal; they count
        as infeasible.
    """

    values: Float[Array, "k d"]
    objectives: Float[Array, "k q"]
    violation: Float[Array, "k r"]
    generations: int
    evaluations: int
    gradient_evaluations: int
    undefined: int
    convergence: Convergence


def searched_front(
    problem: Problem,
    settings: SearchOptions,
    *,
    start: Float[Array, "m d"] | None = None,
    checkpoint: Path | None = None,
    resume: bool = False,
    evaluate_on: Scheduler | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> FrontResult:
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
        Called after each generation, and every second of the polish.

    Raises
    ------
    InputError
        If the method does not fit the problem, ``start`` is outside the bounds, the checkpoint
        belongs to another search, an evaluation is NaN, or no candidate meets the constraints.
    KeyboardInterrupt
        After Ctrl-C, when the checkpoint of the last finished generation has been written.
    """
    if settings.polish and problem.gradient is None:
        raise InputError(
            "polish",
            "needs objectives with exact gradients",
            value=True,
            found="this design has none",
            remedy=Setting("polish", (False,)),
        )
    state = _Populations(problem, settings, start)
    evaluate = evaluate_on.evaluation_of(problem) if evaluate_on else problem.evaluate
    same = _common(problem, settings, state.each[0].first)
    now = Checkpoint(
        search=same, generation=0, evaluations=0, archive=empty_archive(problem), algorithm={}
    )
    if resume:
        now = _resumed(problem, settings, checkpoint, now, state)
    written = time.monotonic()
    try:
        while now.evaluations + settings.population <= settings.budget:
            own, turn = divmod(now.generation, settings.seeds)
            if turn == 0 and _is_power_of_two(own):
                state.remember(now.evaluations, now.archive)
            found = state.each[turn].generation(own, evaluate)
            if found is None:  # every combination of integer parameters was tried
                break
            now = Checkpoint(
                search=same,
                generation=now.generation + 1,
                evaluations=now.evaluations + len(found.values),
                archive=now.archive.joined(problem, found),
                algorithm=state.state(),
            )
            if progress:
                progress(_progress_of(now, settings))
            if checkpoint and time.monotonic() > written + _WRITTEN_EVERY_S:
                write_checkpoint(checkpoint, now)
                written = time.monotonic()
    finally:
        if checkpoint and now.generation:
            write_checkpoint(checkpoint, now)
    archive, gain = now.archive, np.full(len(problem.objectives), np.nan)
    if state.polishes:
        before = _best(problem, archive)
        archive = state.polish(now, progress)
        with np.errstate(invalid="ignore"):
            gain = np.nan_to_num(before - _best(problem, archive), nan=0.0, posinf=0.0)
    _refuse_infeasible(problem, archive, f"{now.evaluations} candidates ({state.effort(now)})")
    front = archive.thinned(problem)
    return FrontResult(
        values=front.values,
        objectives=front.objectives,
        violation=front.violation,
        generations=now.generation,
        evaluations=now.evaluations,
        gradient_evaluations=state.gradients,
        undefined=sum(one.undefined for one in state.each),
        convergence=state.convergence(now, archive, gain),
    )


class _Population:
    """One of the independent populations of a search: its method, and what it has found.

    ``best`` and ``front`` are costs; ``undefined`` counts candidates with an undefined objective.
    """

    def __init__(
        self,
        problem: Problem,
        settings: SearchOptions,
        start: Float[Array, "m d"] | None,
        seed: int,
    ) -> None:
        self.seed, self._problem = seed, problem
        self.algorithm = algorithm_of(problem, settings.method, settings.population, seed)
        self.first = _first_generation(problem, settings, start, seed)
        self.best = np.full(len(problem.objectives), np.inf)
        self.front = np.empty((0, len(problem.objectives)))
        self.undefined = self.gradients = 0

    def generation(self, number: int, evaluate: Callable[[Array], Evaluated]) -> Assessed | None:
        """Evaluate the candidates of a generation and select from them; ``None`` without any."""
        rng = generation_rng(self.seed, number)
        values = self.algorithm.ask(rng) if number else self.first
        if not len(values):
            return None
        found = assessed(self._problem, values, evaluate)
        defined = np.isfinite(found.objectives).all(axis=1)
        self.undefined += int(np.count_nonzero(~defined))
        self.record(found)
        costs = np.where(defined[:, None], found.costs, 0.0)
        self.algorithm.tell({"values": values, "costs": costs, "misses": found.misses}, rng)
        return found

    def record(self, found: Assessed) -> None:
        """Add evaluated candidates to the front."""
        costs = found.costs[found.feasible]
        self.best = np.minimum(self.best, costs.min(axis=0, initial=np.inf))
        kept, fresh = merged(self.front, costs)
        front = np.concatenate([self.front[kept], costs[fresh]])
        self.front = front[thinned(front, LARGEST)]

    def improved(
        self, generations: int, most: int, archive: Archive, is_stopped: Callable[[], bool]
    ) -> Improved | Exception | None:
        """The descents after a number of its generations; an error, or ``None`` without a start."""
        problem = self._problem
        values = self.algorithm.state().get("values", archive.values)
        if not len(values):
            return None

        def goes_on(gradients: int) -> bool:
            self.gradients = gradients
            return not is_stopped()

        try:
            return improved(
                problem,
                assessed(problem, values),
                most=most,
                rng=generation_rng(self.seed, generations),
                goes_on=goes_on,
            )
        except _NUMERICAL as error:
            return error


class _Populations:
    """The independent populations of a search, and the front over its evaluations.

    `state` holds all of them, so that a resumed search continues with the same digits.
    """

    def __init__(
        self, problem: Problem, settings: SearchOptions, start: Float[Array, "m d"] | None
    ) -> None:
        self._problem, self._settings = problem, settings
        self.each = [
            _Population(problem, settings, start, settings.seed + i) for i in range(settings.seeds)
        ]
        wanted = settings.polish is None or settings.polish
        self.polishes = wanted and problem.gradient is not None
        self._fronts: dict[int, Array] = {}
        self._failures: list[str] = []

    @property
    def gradients(self) -> int:
        """Number of gradients of all populations."""
        return sum(one.gradients for one in self.each)

    def remember(self, evaluations: int, archive: Archive) -> None:
        """Store at most 64 members of the front, for the hypervolume."""
        costs = self._problem.costs(archive.objectives)
        self._fronts[evaluations] = costs[thinned(costs, _OF_HISTORY)]

    def polish(self, now: Checkpoint, progress: Callable[[Progress], None] | None) -> Archive:
        """The archive with the front that descents from each population find.

        Parameters
        ----------
        now
            The search after its last generation.
        progress
            Called every second.
        """
        problem, archive, stopped = self._problem, now.archive, threading.Event()
        started = self.each[: now.generation]
        own = [(now.generation - turn - 1) // len(self.each) + 1 for turn in range(len(started))]
        least = _LEAST_GRADIENTS * len(problem.objectives)
        size = self._settings.population
        most = [max(count * size // _EVALUATIONS_PER_GRADIENT, least) for count in own]
        in_all = sum(gradients_at_most(problem, one) for one in most)
        with ThreadPoolExecutor(len(started)) as pool:
            tasks = [
                pool.submit(one.improved, count, limit, archive, stopped.is_set)
                for one, count, limit in zip(started, own, most, strict=True)
            ]
            try:
                while wait(tasks, _TOLD_EVERY_S if progress else None).not_done:
                    if progress:
                        before = _progress_of(now, self._settings)
                        gradients = min(self.gradients, in_all)
                        progress(replace(before, gradients=gradients, most_gradients=in_all))
                every = [task.result() for task in tasks]
            finally:
                stopped.set()
        for one, better in zip(started, every, strict=True):
            if isinstance(better, Exception):  # the front so far is a result without it
                self._failures.append(str(better))
            elif better is not None:
                one.gradients = better.gradients
                one.record(better.found)
                archive = archive.joined(self._problem, better.found)
        return archive

    def effort(self, now: Checkpoint) -> str:
        """Number of seeds and gradients of the search, in words."""
        count = min(len(self.each), now.generation)
        seeds = f"seed {self.each[0].seed}" if count == 1 else f"{count} seeds"
        polish = f"polished with {self.gradients} gradients" if self.gradients else "no polish"
        return f"{seeds}, {polish}"

    def convergence(
        self, now: Checkpoint, archive: Archive, gain: Float[Array, " q"]
    ) -> Convergence:
        """The convergence of the finished search."""
        problem, started = self._problem, self.each[: now.generation]
        final = problem.costs(archive.objectives)
        low, high = final.min(axis=0), final.max(axis=0)
        reference = high + _BEYOND * (high - low)
        fronts = self._fronts | {now.evaluations: final[thinned(final, LARGEST)]}

        def volume(costs: Float[Array, "k q"]) -> float | None:
            return hypervolume(costs, low, reference) if len(problem.objectives) > 1 else None

        return Convergence(
            milestones=tuple(
                Milestone(
                    evaluations=evaluations,
                    hypervolume=volume(costs),
                    best=problem.costs(costs.min(axis=0, initial=np.inf)),
                )
                for evaluations, costs in sorted(fronts.items())
            ),
            reference=problem.costs(reference),
            seeds=tuple(one.seed for one in started),
            best=problem.costs(np.array([one.best for one in started])),
            hypervolumes=tuple(volume(one.front) for one in started),
            gain=gain,
            failures=tuple(dict.fromkeys(self._failures)),
        )

    def state(self) -> State:
        """All that the next generation and the result depend on."""
        state = {
            "undefined": np.array([one.undefined for one in self.each]),
            "best": np.array([one.best for one in self.each]),
        }
        for turn, one in enumerate(self.each):
            state |= _prefixed(f"{turn}.", one.algorithm.state()) | {f"own.{turn}": one.front}
        return state | {f"front.{count}": costs for count, costs in self._fronts.items()}

    def restore(self, state: Mapping[str, Array]) -> None:
        """Continue from a state."""
        for turn, one in enumerate(self.each):
            one.undefined, one.best = int(state["undefined"][turn]), state["best"][turn]
            one.front = state.get(f"own.{turn}", one.front)
            if own := _without_prefix(f"{turn}.", state):
                one.algorithm.restore(own)
        fronts = _without_prefix("front.", state)
        self._fronts = {int(count): costs for count, costs in fronts.items()}


def _progress_of(now: Checkpoint, settings: SearchOptions) -> Progress:
    return Progress(
        generation=now.generation,
        evaluations=now.evaluations,
        budget=settings.budget,
        values=now.archive.values,
        objectives=now.archive.objectives,
    )


def _is_power_of_two(number: int) -> bool:
    return number > 0 and number & (number - 1) == 0


def _best(problem: Problem, archive: Archive) -> Float[Array, " q"]:
    return problem.costs(archive.objectives).min(axis=0, initial=np.inf)


def _first_generation(
    problem: Problem, settings: SearchOptions, start: Float[Array, "m d"] | None, seed: int
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
    rng = generation_rng(seed, 0)
    rest = latin_hypercube(problem, settings.population - len(given), rng)
    return np.concatenate([problem.allowed(given), rest])


def _common(problem: Problem, settings: SearchOptions, first: Array) -> dict[str, Any]:
    """What a resumed search must share with the stopped one, by its name in messages."""
    return {
        "method": settings.method,
        "seed": settings.seed,
        "seeds": settings.seeds,
        "polish": settings.polish,
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
    settings: SearchOptions,
    path: Path | None,
    empty: Checkpoint,
    state: _Populations,
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
    state.restore(now.algorithm)
    return now


def _agrees(problem: Problem, now: Checkpoint) -> bool:
    """Whether the first member of the front has the same objectives here."""
    values, objectives = now.archive.values[:1], now.archive.objectives[:1]
    if not len(values):
        return True
    return np.allclose(assessed(problem, values).objectives, objectives, rtol=_SAME, atol=_SAME)


def _refuse_infeasible(problem: Problem, archive: Archive, searched: str) -> None:
    """Raise an error that names the violated constraints, if no candidate was feasible."""
    if len(archive.values):
        return
    count = f"of {searched}"
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
