"""Every input gives a result, or one sentence and exit code 2."""

import errno
import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from importlib import import_module
from pathlib import Path

import click
import numpy as np
import pytest

import command_lines
from chromanoise.base.errors import InputError
from chromanoise.base.files import whole_folder
from chromanoise.cli import output as progress
from outcomes import refused

main = import_module("chromanoise.cli.entry")
TESTS = Path(__file__).parents[1]
LINES = int(os.environ.get("CHROMANOISE_COMMAND_LINES", "300"))


pytestmark = pytest.mark.usefixtures("here")


def broken_among(count, seed):
    done = subprocess.run(
        [sys.executable, TESTS / "command_lines.py", str(seed), str(count)],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.evidence
def test_a_few_random_command_lines_give_results_or_sentences():
    result = broken_among(16, seed=0)
    assert result["broken"] == []
    assert set(result["codes"]) == {"0", "2"}


@pytest.mark.evidence
def test_many_random_command_lines_give_results_or_sentences():
    result = broken_among(LINES, seed=1)
    print({key: value for key, value in result.items() if key != "broken"})
    assert result["broken"] == []


def test_random_command_lines_know_a_valid_value_of_every_option():
    for name in main.COMMANDS:
        for param in command_lines.options_of(name):
            if isinstance(param, click.Argument) or not param.is_flag:
                assert command_lines.valid_values(name, param), f"{name} {param.name}"


def test_without_arguments_the_help_is_printed(run):
    assert run() == run("--help")
    assert run()[0] == 0


def test_characters_that_the_output_encoding_lacks_are_escaped(here):
    """In a separate process, which also ignores unsuitable settings of libraries."""
    (here / "é.csv").write_text("wavelength_nm,R,G\n400,0.1,0.3\n1050,0.4,0.2\n")
    settings = {"MPLBACKEND": "nope", "NUMBA_NUM_THREADS": "0", "PYTHONIOENCODING": "ascii"}
    words = ["analyze", "é.csv", "--json", "j.json"]
    done = subprocess.run(
        [sys.executable, "-c", "from chromanoise.cli import main; main()", *words],
        capture_output=True,
        check=False,
        env=os.environ | settings,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert "\\u00e9" in done.stdout.decode("ascii")
    assert json.loads((here / "j.json").read_text("utf-8"))["sensors"][0]["name"] == "é"


@pytest.mark.parametrize("name", ["ridge=1e308", "noise-regularized=1e16", "ridge=-1", "ridge=nan"])
def test_a_parameter_of_a_matrix_beyond_its_bounds_is_refused_by_all_shells(run, here, name):
    method, _, value = name.partition("=")
    parts = (method, f"{float(value):g}")
    refused(run("analyze", "onyx-rgb", "--matrix", name), *parts, setting="matrices.0")
    (here / "s.toml").write_text(f'matrices = ["{name}"]\n[[sensors]]\nname = "onyx-rgb"\n')
    refused(run("run", "s.toml"), "s.toml:1", *parts, setting="matrices.0")


def test_pictures_without_compiled_kernels_are_refused(run, monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    refused(run("simulate", "builtin:checker", "--sensor", "onyx-rgb"), "NUMBA_DISABLE_JIT")


def test_the_message_for_a_full_disk_names_the_file(run, here):
    refused(run("analyze", "onyx-rgb", "--json", "/dev/full"), "/dev/full")
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))  # as a write raises it, without a name
    goal = Path("pictures")
    with pytest.raises(InputError, match=r"^pictures.*No space left"), whole_folder(goal, "a"):
        raise full
    assert list(here.iterdir()) == []


def test_a_whole_number_may_be_written_with_an_exponent(run):
    data = [run("reproduce", "--draws", draws, "--json", "-") for draws in ("1000", "1e3")]
    assert data[0][0] == 0
    assert data[0] == data[1]


def test_more_sensors_than_a_run_takes_are_refused_by_all_shells(run, here):
    (here / "s.toml").write_text('[[sensors]]\nname = "onyx-rgb"\n' * 1001)
    refused(run("run", "s.toml"), "s.toml:1: sensors", "1000", setting="sensors", value=1001)
    many = ["onyx-rgb"] * 1001
    refused(run("analyze", *many), "SENSOR", "1000", setting="sensors", value=1001)


def test_an_overflow_during_a_computation_is_refused(run, monkeypatch):
    monkeypatch.setattr(main.commands, "main", lambda **_: np.array([1e308]) * 10)
    refused(run("catalog"), "overflow")


def test_a_stop_that_a_library_turns_into_another_exception_is_a_stop(run, monkeypatch):
    def interrupted(**_):
        try:
            os.kill(os.getpid(), signal.SIGTERM)
        except KeyboardInterrupt:
            raise ImportError("initialization failed") from None

    monkeypatch.setattr(main.commands, "main", interrupted)
    code, out, err = run("catalog")
    assert (code, out, err) == (130, "", "chromanoise: stopped\n")


def test_a_stop_while_an_object_is_deleted_is_a_stop(run, monkeypatch):
    class Deleted:
        def __del__(self):
            os.kill(os.getpid(), signal.SIGTERM)

    def interrupted(**_):
        Deleted()
        time.sleep(30)  # ended by the stop
        pytest.fail("went on")

    monkeypatch.setattr(main.commands, "main", interrupted)
    code, out, err = run("catalog")
    assert (code, out, err) == (130, "", "chromanoise: stopped\n")


@pytest.mark.evidence
def test_a_stop_that_a_library_swallows_is_a_stop_and_no_cleanup_is_interrupted(run, monkeypatch):
    cleaned = []

    def swallowing(**_):
        try:
            os.kill(os.getpid(), signal.SIGTERM)
        except BaseException:  # as some libraries do
            cleaned.append("swallowed")
        try:
            time.sleep(30)  # ended by the repeated stop
            pytest.fail("went on")
        finally:
            first, second = OSError(), ValueError()
            first.__cause__, second.__cause__ = second, first  # a circle
            with suppress(OSError):
                try:
                    raise first
                finally:
                    time.sleep(2.5)  # longer than the stop is repeated
                    cleaned.append("whole")

    monkeypatch.setattr(main.commands, "main", swallowing)
    code, out, err = run("catalog")
    assert (code, out, err) == (130, "", "chromanoise: stopped\n")
    assert cleaned == ["swallowed", "whole"]


def test_a_local_cluster_whose_workers_end_at_once_is_refused(run, monkeypatch):
    distributed = pytest.importorskip("dask.distributed")

    def fails(**_):
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr(distributed, "LocalCluster", fails)
    words = ("simulate", "builtin:checker", "--sensor", "onyx-rgb", "--scheduler", "local")
    refused(run(*words))


@pytest.mark.parametrize(
    ("parts", "each_s", "result"),
    [
        (100, [2.0] * 50, ["3.3 min"]),
        (10, [2.0] * 10, []),
        # 4 parts in 10 s after the first: the other 95 take 237.5 s
        (100, [2.0] * 3 + [3.0] * 2, ["3.3 min", "4.2 min, 4 min of it left"]),
        # 3 parts in 10 s, so 20 s for 6, after 12 s: first above half a minute
        (10, [2.0] * 3 + [6.0] * 2, ["32 s"]),
        (4, [2.0, 100.0, 100.0, 2.0], ["5 min"]),  # none after the last
    ],
)
def test_a_long_computation_prints_how_long_it_takes_and_corrects_it(
    capsys, monkeypatch, parts, each_s, result
):
    clock = iter(np.cumsum([0.0, *each_s]))
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    with progress.progress_of("the work", parts, "parts") as advance:
        for _ in each_s:
            advance(1)
    assert capsys.readouterr() == ("", "".join(f"the work: takes about {one}\n" for one in result))
