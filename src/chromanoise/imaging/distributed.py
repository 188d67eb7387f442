"""A picture on the machines of a dask cluster; the bits are those of one machine."""

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

from chromanoise._check import InputError


@contextmanager
def cluster(scheduler: str, *, workers: int | None = None) -> Iterator[Executor]:
    """An executor for `chromanoise.imaging.Work` whose tasks run on a dask cluster.

    Parameters
    ----------
    scheduler
        Address as ``tcp://host:8786``, whose workers must have chromanoise and reach the cube's
        file; ``local`` for processes of this machine.
    workers
        Processes of ``local``; one per core if ``None``.

    Raises
    ------
    InputError
        If dask is not installed or the scheduler does not answer within 10 s.
    """
    try:
        from dask.distributed import Client, LocalCluster
    except ImportError:
        raise InputError(
            "a cluster needs dask; pip install 'chromanoise[distributed]', or leave --scheduler "
            "away for the threads of this machine"
        ) from None
    if scheduler == "local":
        with (
            LocalCluster(  # type: ignore[no-untyped-call]
                n_workers=workers, threads_per_worker=1, dashboard_address=None
            ) as processes,
            Client(processes) as client,  # type: ignore[no-untyped-call]
        ):
            yield _executor(client)
        return
    try:
        client = Client(scheduler, timeout=10)  # type: ignore[no-untyped-call]
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(
            f"the scheduler {scheduler!r} does not answer ({error}); give its address as "
            "tcp://host:port, or local"
        ) from None
    with client:
        yield _executor(client)


def _executor(client: Any) -> Executor:
    executor: Executor = client.get_executor(pure=False)
    return executor
