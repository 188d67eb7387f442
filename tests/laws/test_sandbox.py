"""Calls in a child process: results, refusals, and whatever a library does to its process."""

import faulthandler
import math
import operator
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from chromanoise.base import check as _check, sandbox as _sandbox
from chromanoise.base.errors import InputError
from chromanoise.base.sandbox import sandboxed
from processes import is_running

PATH = Path("/cube.xyz")
LOOPS = (re.fullmatch, "(a+)+b", "a" * 60)  # for years, and holds the interpreter lock


@pytest.fixture(autouse=True)
def no_child_is_left():
    yield
    _sandbox.close_sandbox()


def call(*given, **options):
    return sandboxed(*given, path=PATH, **options)


def assert_ends(pid):
    end = time.monotonic() + 30
    while is_running(pid):
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_result_is_that_of_the_function_and_one_child_process_serves_all_calls():
    array = np.arange(6.0).reshape(2, 3)
    np.testing.assert_array_equal(call(operator.neg, array), -array)
    first = call(os.getpid)
    assert first not in (os.getpid(), os.getppid())
    assert call(os.getpid) == first


def test_a_refusal_stays_a_refusal_and_any_other_exception_becomes_its_reason():
    with pytest.raises(InputError, match="time"):
        call(_check.positive, "time", "s", -1.0)
    first = call(os.getpid)
    with pytest.raises(ValueError, match=r"math domain error|nonnegative"):
        call(math.sqrt, -1)
    assert call(os.getpid) != first  # the library may be in any state


def test_a_crash_is_an_error_and_the_next_call_is_served():
    with pytest.raises(ValueError, match=f"crashes, exit code -{signal.SIGSEGV.value}"):
        call(faulthandler._sigsegv)
    assert call(abs, -3) == 3


def test_a_call_that_never_returns_is_ended_at_its_limit():
    with pytest.raises(ValueError, match=r"does not return within 0\.5 s"):
        call(*LOOPS, limit_s=0.5)
    assert call(abs, -3) == 3


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux only")
def test_a_call_that_takes_more_memory_than_its_limit_is_refused_and_a_later_one_may_take_it():
    with pytest.raises(MemoryError):
        call(bytearray, 2**28, memory_bytes=2**26)
    assert len(call(bytearray, 2**25, memory_bytes=2**28)) == 2**25


def test_what_a_library_prints_is_not_taken_for_its_result(capfd):
    assert call(print, "noise") is None
    assert call(os.write, 1, b"noise") == 5
    assert capfd.readouterr() == ("", "")


def test_a_relative_path_is_that_of_the_caller(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.txt").write_text("here")
    assert sandboxed(Path.read_text, Path("a.txt"), path=Path("a.txt")) == "here"


@pytest.fixture
def interruptible():
    """Ctrl-C interrupts, even where the shell that started the tests ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_an_interrupted_call_does_not_leave_its_answer_to_the_next_one(interruptible):
    call(abs, 0)
    child = _sandbox._child(os.getpid())
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        call(time.sleep, 20)
    assert child._process is None
    assert call(abs, -3) == 3


def test_threads_take_turns():
    results = {}

    def ask(k):
        results[k] = call(abs, -k)

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == {k: k for k in range(8)}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs os.fork")
def test_a_fork_has_a_child_process_of_its_own():
    program = (
        "import os; from pathlib import Path; from chromanoise.base.sandbox import sandboxed\n"
        "def told(): return sandboxed(os.getpid, path=Path('/a'))\n"
        "first = told()\n"
        "pid = os.fork()\n"
        "other = told()\n"
        "if pid == 0: raise SystemExit(0 if other != first else 1)\n"
        "print(os.waitpid(pid, 0)[1], other == first, told() == first)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.stdout.split(), done.stderr) == (["0", "True", "True"], "")


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
@pytest.mark.parametrize("busy", [False, True])
def test_the_child_process_ends_when_its_parent_is_killed(busy):
    program = (
        "import os, re; from pathlib import Path; from chromanoise.base.sandbox import sandboxed\n"
        "print(sandboxed(os.getpid, path=Path('/a')), flush=True)\n"
        f"busy = {busy}\n"
        "sandboxed(re.fullmatch, '(a+)+b', 'a' * 60, path=Path('/a'), limit_s=1) if busy else "
        "input()"
    )
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", program], stdin=pipe, stdout=pipe) as parent:
        pid = int(parent.stdout.readline())
        assert is_running(pid)
        parent.kill()
    assert_ends(pid)


def test_a_program_that_cannot_start_another_python_says_what_to_do(monkeypatch):
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    with pytest.raises(InputError, match=r"cube\.xyz: .*second Python.*ENVI"):
        call(abs, 1)
