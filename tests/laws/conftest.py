"""A cluster of two processes, for the tests of pictures and of searches."""

import logging
import os
import signal

import pytest


@pytest.fixture(scope="module")
def address():
    """Two processes of this machine, found by their address as a cluster elsewhere would be."""
    distributed = pytest.importorskip("distributed", reason="dask is an extra")
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        dashboard_address="127.0.0.1:0",
        silence_logs=logging.CRITICAL,
    ) as processes:
        yield processes.scheduler_address


@pytest.fixture
def kill_one(address):
    """A function that kills one of the two processes when it is called first."""
    from dask.distributed import Client

    with Client(address) as client:
        workers = list(client.run(os.getpid).values())
    assert len(workers) == 2

    def kill(_):
        if workers:
            os.kill(workers.pop(), signal.SIGKILL)
            workers.clear()

    yield kill
    assert workers == []  # it was called
