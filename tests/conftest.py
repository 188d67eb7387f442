"""What all tests share: shapes in signatures are checked, and hypothesis draws reproducibly."""

import dataclasses
import functools
import gc
import inspect
import logging
import os
import re
import signal
import subprocess
import sys
import warnings
from collections.abc import Callable
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import RLock
from typing import get_args

import jaxtyping
import numpy as np
import pytest
from beartype import BeartypeConf, beartype
from hypothesis import settings

import chromanoise.base  # noqa: F401  its protocols cannot be checked

with warnings.catch_warnings(), np.printoptions():  # it warns, and changes the options of numpy
    warnings.simplefilter("ignore")
    import colour  # noqa: F401
TESTS = Path(__file__).parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "tools")]  # for `from strategies import ...`

# An int may stand for a float (PEP 484).
typed = beartype(conf=BeartypeConf(is_pep484_tower=True))


def has_shape(annotation):
    """Whether an annotation has a shape of jaxtyping in it, or is text that could have one."""
    return (
        isinstance(annotation, str)
        or (inspect.isclass(annotation) and issubclass(annotation, jaxtyping.AbstractArray))
        or any(map(has_shape, get_args(annotation)))
    )


def is_number(annotation):
    """Whether a result is a number, or may be one."""
    return annotation in (float, int, bool) or any(map(is_number, get_args(annotation)))


CALLS = 5
"""Calls of each function that are checked in each test: 20 would take a tenth longer."""
tests = count()
now = [next(tests)]  # the number of the test
making = RLock()


def checked(function):
    """A function of which `CALLS` calls in a test are checked, or a dataclass so checked.

    In place of `jaxtyping.jaxtyped`, which binds every call to the signature and checks it twice:
    with it the suite takes more than twice as long. The checker is built at the first call: most
    functions are not called in most processes.
    """
    if inspect.isclass(function):
        if dataclasses.is_dataclass(function) and "__init__" in vars(function):
            function.__init__ = checked(function.__init__)
        return function
    left, test, checking = CALLS, None, None

    @functools.wraps(function)
    def counted(*args, **kwargs):
        nonlocal left, test, checking
        if test != now[0]:
            left, test = CALLS, now[0]
        if left <= 0 or jaxtyping.config.jaxtyping_disable:
            return function(*args, **kwargs)
        left -= 1
        with making:
            checking = checking or checker_of(function)
        return checking(*args, **kwargs)

    return counted


def checker_of(function):
    """The function with its arguments and result checked.

    The sizes of named axes (``n`` in ``"n p"``) are those of one call here as in jaxtyping.

    A function without arrays and numbers stays as it is: mypy has checked its types, where numpy
    tells them, and a checker of each would take a fifth of the suite's time.
    """
    known = inspect.get_annotations(function)
    if not any(map(has_shape, known.values())) and not is_number(known.get("return")):
        return function
    hints = function.__annotations__
    unknown = {  # types that only type checkers import
        name
        for name, hint in hints.items()
        if isinstance(hint, str) and re.split(r"\W", hint)[0] not in function.__globals__
    }
    later = {name: hints.pop(name) for name in unknown}
    one = typed(function)
    hints.update(later)

    @functools.wraps(one)
    def scoped(*args, **kwargs):
        with sizes("context"):
            return one(*args, **kwargs)

    return scoped


sizes, jaxtyping.jaxtyped = jaxtyping.jaxtyped, lambda *, typechecker: checked
jaxtyping.install_import_hook("chromanoise", None)


def pytest_runtest_setup() -> None:
    """Check the first calls of each test."""
    now[0] = next(tests)


def pytest_configure(config: pytest.Config) -> None:
    """Beartype looks at a random entry of a tuple; what hypothesis draws does not depend on it."""
    config.addinivalue_line(
        "filterwarnings", "ignore:Do not use the `random` module inside strategies"
    )


PICTURE = """import sys
from chromanoise.cli import main
from chromanoise.imaging import kernel_cache
kernel_cache._SMALL_S = 0.0
main(["simulate", "builtin:checker", "--sensor", "onyx-rgbw", *sys.argv[1:]])"""
DESIGN = """import tomllib
from chromanoise.apps.design import DESIGN_STARTER, DesignStudy, task_of
problem = task_of(DesignStudy.model_validate(tomllib.loads(DESIGN_STARTER))).problem()
middle = (problem.low + problem.high) / 2
problem.evaluate(middle[None])
problem.gradient(middle[None])"""
compiling = []
gc.disable()  # until all tests are collected: what is made before stays to the end


@pytest.fixture
def file(tmp_path: Path) -> Callable[..., Path]:
    """Writes a file of text or bytes into the folder of the test, and returns its path."""

    def write(content: str | bytes, name: str = "file.txt") -> Path:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.fixture(scope="module")
def cluster_address():
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
def kill_one(cluster_address):
    """A function that kills one of the two processes when it is called first."""
    from dask.distributed import Client

    with Client(cluster_address) as client:
        workers = list(client.run(os.getpid).values())
    assert len(workers) == 2

    def kill(_):
        if workers:
            os.kill(workers.pop(), signal.SIGKILL)
            workers.clear()

    yield kill
    assert workers == []  # it was called


def pytest_collection_finish() -> None:
    """No later collection of garbage looks at what the collection of tests has made."""
    gc.freeze()
    gc.enable()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config: pytest.Config) -> None:
    """Begin to compile the dearest kernels: once, not in each of the processes at the same time."""
    gc.enable()  # this process collects no tests
    folder = TemporaryDirectory()
    config.add_cleanup(folder.cleanup)
    pictures = [(PICTURE, "-o", folder.name + "/color")]
    pictures.append((PICTURE, "-o", folder.name + "/raw", "--mosaic", "sensor"))
    is_whole = config.args_source is config.ArgsSource.TESTPATHS
    for script, *arguments in (*pictures, *[(DESIGN,)] * is_whole):
        command = [sys.executable, "-c", script, *arguments]
        compiling.append(subprocess.Popen(command, stdout=subprocess.DEVNULL))
        config.add_cleanup(compiling[-1].wait)  # before the folder goes, also after an error


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_node_collection_finished() -> None:
    """No test begins before the kernels are compiled; the processes collect in the meantime."""
    for process in compiling:
        process.wait()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """With ``-n``: each process gets a run of neighbors, so that few modules are prepared twice."""
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log) if config.getvalue("dist") == "load" else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Modules that are dear to prepare come first: work is stolen from the end of what is left."""
    dear = ("test_page_", "test_report")
    items.sort(key=lambda item: not item.path.name.startswith(dear))


for profile, examples in {"laws": 12, "thorough": 100}.items():  # the second by `make evidence`
    settings.register_profile(
        profile,
        max_examples=examples,
        deadline=None,
        derandomize=True,
        database=None,
        print_blob=False,
    )
settings.load_profile("laws")
