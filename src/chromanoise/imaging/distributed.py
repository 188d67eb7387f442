"""Rendering on a dask cluster, with results bit-identical to those of one machine."""

import logging
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from contextlib import ExitStack, contextmanager
from multiprocessing import resource_tracker
from typing import Any

from chromanoise.base import InputError, Setting, optional_package

_QUIET = {
    "distributed.admin.large-graph-warning-threshold": "1 GiB",  # blocks are
    # all cores are busy: frequent monitoring would take time from them
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.scheduler.work-stealing-interval": "1s",
}
_ANSWERS_WITHIN_S = 10.0
_SENDS_EVERY_S = 0.001  # the default of dask delays all but the first task by 0.01 s


@contextmanager
def cluster(scheduler: str, *, workers: int | None = None) -> Iterator[Executor]:
    """An executor for `chromanoise.imaging.Work` whose tasks run on a dask cluster.

    Parameters and errors are those of `client_of`.
    """
    with client_of(scheduler, workers=workers, smaller=Setting("tile_rows")) as client:
        yield client.get_executor(pure=False)


@contextmanager
def client_of(scheduler: str, *, workers: int | None = None, smaller: Setting) -> Iterator[Any]:
    """A client of a dask cluster that reports lost workers in one sentence.

    Parameters
    ----------
    scheduler
        Address such as ``tcp://host:8786``, whose workers need chromanoise and access to the cube's
        file; ``local`` for processes of this machine.
    workers
        Number of processes for ``local``; one per core if ``None``.
    smaller
        The setting that makes a task smaller, for workers that were lost for lack of memory.

    Raises
    ------
    InputError
        If dask is not installed, the processes cannot be started, the scheduler does not answer
        within 10 s, or all of its workers are lost.
    """
    threads = ("omit the scheduler to use the threads of this machine",)
    for package in ("dask", "distributed", "dask.distributed"):
        optional_package(package, "scheduler", extra="distributed", otherwise=threads)
    import dask
    from dask.distributed import Client, LocalCluster

    with ExitStack() as stack:
        stack.enter_context(dask.config.set(_QUIET))
        if scheduler == "local":
            with _stop_waiting():
                try:
                    processes = LocalCluster(  # type: ignore[no-untyped-call]
                        n_workers=workers,
                        threads_per_worker=1,
                        dashboard_address="127.0.0.1:0",  # any free port, for this machine only
                        silence_logs=logging.CRITICAL,  # the caller reports an error once
                    )
                except (RuntimeError, OSError, TimeoutError):
                    raise InputError(
                        "the local cluster",
                        "cannot be started, because a worker process ended at its start, "
                        "usually for lack of memory",
                        remedy="use fewer workers",
                    ) from None
                scheduler = stack.enter_context(processes).scheduler_address
        stack.enter_context(_lost_workers_reported(scheduler, smaller))
        try:
            client = Client(  # type: ignore[no-untyped-call]
                scheduler,
                timeout=_ANSWERS_WITHIN_S,
                set_as_default=False,  # otherwise a failed one would stay the default of dask
            )
        except (OSError, TimeoutError, ValueError) as error:
            raise InputError(
                "scheduler",
                "must be the address of one that runs, as tcp://host:port, or local",
                value=scheduler,
                found=f"{scheduler!r} does not answer ({error})",
            ) from None
        stack.enter_context(client)
        if client.scheduler_comm is not None:
            client.scheduler_comm.interval = _SENDS_EVERY_S
        yield client


@contextmanager
def _stop_waiting() -> Iterator[None]:
    """Delay a stop until the workers have started, and block Ctrl-C in the workers.

    A terminal sends the signal to every process, but only the main process should end, and then
    end its workers. Workers that receive the signal print a traceback each, and a partly started
    cluster may not end at all. Processes that are started here inherit the blocked signal; a
    thread that was started earlier may still receive it, so the main thread records it and raises
    it afterwards.
    """
    if (
        not hasattr(signal, "pthread_sigmask")
        or threading.current_thread() is not threading.main_thread()
    ):
        yield
        return
    resource_tracker.ensure_running()  # otherwise its later start would unblock Ctrl-C
    came: list[int] = []
    handlers = {one: signal.getsignal(one) for one in (signal.SIGINT, signal.SIGTERM)}
    waiting = [one for one, handler in handlers.items() if callable(handler)]
    for one in waiting:
        signal.signal(one, lambda number, _: came.append(number))
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        for one in reversed(waiting):  # Ctrl-C last: it may raise at once
            signal.signal(one, handlers[one])
        if came:
            signal.raise_signal(came[0])


@contextmanager
def _lost_workers_reported(scheduler: str, smaller: Setting) -> Iterator[None]:
    """Report lost workers as InputError; dask first retries their blocks a few times."""
    from dask.distributed import KilledWorker

    try:
        yield
    except (KilledWorker, CancelledError) as error:
        raise InputError(
            f"the cluster {scheduler}",
            f"lost its workers ({type(error).__name__}), usually for lack of memory (smaller "
            "tasks need less)",
            remedy=("see their logs", smaller),
        ) from None
