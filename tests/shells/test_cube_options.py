"""Cubes of the command line and of a study: files of wavelengths, and irregular files."""

import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from outcomes import refused

CUBE = np.random.default_rng(5).integers(1, 128, size=(3, 4, 5)) / 128


@pytest.fixture
def files(tmp_path):
    np.save(tmp_path / "a.npy", CUBE)
    (tmp_path / "wl.txt").write_text("um\n0.4\n0.45\n0.5\n0.8\n1.05\n")
    return tmp_path


STUDY = """
[[sensors]]
name = "model-rgb"
[outputs]
analyses = false
[[pictures]]
cube = "a.npy"
formats = ["xyz"]
wavelengths = "wl.txt"
"""


def test_a_study_finds_a_file_of_wavelengths_in_its_folder_and_hashes_it(
    files, run, done, monkeypatch
):
    (files / "study.toml").write_text(STUDY)
    done("run", str(files / "study.toml"), "--out", str(files / "out"))
    data = json.loads((files / "out" / "pictures-1.json").read_text())
    assert set(data["files"]) == {str(files / "a.npy"), str(files / "wl.txt")}
    monkeypatch.chdir(files)
    command = ("simulate", "a.npy", "--sensor", "model-rgb", "--wavelengths", "wl.txt")
    out, _ = done(*command, "--format", "xyz", "--copy-as", "toml")
    assert 'wavelengths = "wl.txt"' in out
    done(*command, "--format", "xyz", "-o", "direct")
    taken = [next((files / name).glob("*.tiff")).read_bytes() for name in ("out", "direct")]
    assert taken[0] == taken[1]
    (files / "wl.txt").write_text("um\n0.4\n0.46\n0.5\n0.8\n1.05\n")
    refused(run("rerun", str(files / "out"), "-o", str(files / "again")), "wl.txt")


@pytest.mark.parametrize("value", ["5", "[400]", "[400, 500, 600]", "true", '["a", "b"]'])
def test_a_study_refuses_other_wavelengths_in_one_sentence(files, run, value):
    (files / "study.toml").write_text(STUDY.replace('"wl.txt"', value))
    outcome = run("run", str(files / "study.toml"), "--out", str(files / "out"))
    refused(outcome, "study.toml:9", setting="pictures.0.wavelengths")


# pipes, devices and sockets


@pytest.fixture
def pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    return str(tmp_path / "pipe")


@pytest.fixture
def unix_socket(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the whole path may be too long for a socket
    with socket.socket(socket.AF_UNIX) as bound:
        bound.bind("socket")
        yield "socket"


DOORS = {
    "cube": ("simulate", "{}", "--sensor", "model-rgb", "-o", "out"),
    "wavelengths": ("simulate", "a.npy", "--sensor", "model-rgb", "--wavelengths", "{}"),
    "curves": ("inspect", "{}"),
    "sensor": ("analyze", "{}.csv"),
    "lamp": ("analyze", "model-rgb", "--illuminant", "{}.csv"),
    "pixel": ("analyze", "model-rgb", "--pixel", "{}"),
    "study": ("run", "{}"),
    "output": ("rerun", "{}", "-o", "out"),
    "own JSON": ("convert", "{}.json", "out.csv"),
}


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("kind", ["/dev/zero", "pipe", "socket"])
def test_an_irregular_file_is_refused_at_once(run, tmp_path, monkeypatch, request, door, kind):
    name = request.getfixturevalue({"pipe": "pipe", "socket": "unix_socket"}.get(kind, "tmp_path"))
    name = kind if kind == "/dev/zero" else name
    monkeypatch.chdir(tmp_path)
    np.save("a.npy", CUBE)
    words = [word.replace("{}", "link") for word in DOORS[door]]
    for word in {"link", "link.csv", "link.json"} & set(words):
        Path(word).symlink_to(name if kind == "/dev/zero" else tmp_path / name)
    refused(run(*words), "link", "device" if kind == "/dev/zero" else kind)


def test_a_study_whose_cube_is_a_device_is_refused_before_it_is_hashed(run, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY.replace("a.npy", "/dev/zero"))
    refused(run("run", str(tmp_path / "study.toml"), "--out", str(tmp_path / "out")), "/dev/zero")


def test_a_pipe_within_a_zarr_folder_is_refused(run, tmp_path):
    pytest.importorskip("zarr", reason="comes with chromanoise[cubes]")
    (tmp_path / "a.zarr").mkdir()
    os.mkfifo(tmp_path / "a.zarr" / "zarr.json")
    (tmp_path / "a.zarr" / ".zgroup").write_text("{}")
    command = ("simulate", str(tmp_path / "a.zarr"), "--sensor", "model-rgb", "-o", str(tmp_path))
    refused(run(*command), "zarr.json", "pipe", setting="pictures.0.cube")


COMMAND = [sys.executable, "-c", "from chromanoise.cli import main; main()", "run", "/dev/stdin"]


@pytest.mark.evidence
def test_a_study_may_be_piped_in_and_endless_input_is_refused(tmp_path):
    study = '[[sensors]]\nname = "model-mono"\n'
    done = subprocess.run(
        [*COMMAND, "--out", str(tmp_path / "out")],
        input=study.encode(), capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0
    assert (tmp_path / "out" / "study.json").exists()
    done = subprocess.run(COMMAND, input=b"#" * 2**21, capture_output=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count(b"\n") == 1
    with open("/dev/zero", "rb") as zeros:  # noqa: PTH123
        done = subprocess.run(COMMAND, stdin=zeros, capture_output=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count(b"\n") == 1
    assert b"/dev/stdin" in done.stderr
