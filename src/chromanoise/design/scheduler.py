"""Evaluation of a generation on a dask cluster, with the results of one process."""

import re
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from chromanoise._check import Array
from chromanoise.design.problem import Evaluated, Problem
from chromanoise.errors import InputError, Setting
from chromanoise.imaging.distributed import client_of


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scheduler:
    """A cluster on which candidates are evaluated, in as many chunks as it has threads.

    Attributes
    ----------
    executor
        Of dask, which evaluates the chunks of a killed worker again.
    threads
        Number of chunks.
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
        parts = [task.result() for task in tasks]
        return Evaluated(
            objectives=np.concatenate([part.objectives for part in parts]),
            violation=np.concatenate([part.violation for part in parts]),
        )


@contextmanager
def scheduler_at(address: str, *, workers: int | None = None) -> Iterator[Scheduler]:
    """A dask cluster for `chromanoise.design.search.searched_front`.

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
        As `chromanoise.imaging.distributed.client_of`, or if the address has no port.
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
