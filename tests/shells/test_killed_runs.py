"""A run killed at any moment leaves results complete or unchanged, and the next run works."""

import hashlib
import json
import random
import shutil
import signal
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from chromanoise.base.files import OWN_FILES
from processes import command, wait_for

pytestmark = pytest.mark.evidence

MOMENTS = 14  # of each kind of run, half of them into a folder with older results
WAVELENGTH = np.linspace(400, 1050, 14)
OF_CUBE = ("simulate", "cube.npz", "--sensor", "model-rgb", "--time-ms", 12, "--mosaic", "bayer")
KINDS = {
    "one picture": ("simulate", "builtin:checker", "--sensor", "onyx-rgbw", "--time-ms", 12),
    "a burst of 200": (*OF_CUBE, "--raw-only", "--format", "raw", "--frames", 200),
    "a local cluster": (*OF_CUBE, "--tile", 4, "--scheduler", "local", "--threads", 1),
    "a study": ("run", "study.toml"),
}
STUDY = """\
[[sensors]]
name = "model-rgb"
[[sweeps]]
vary = "lux"
first = 1
last = 100
points = 3
[[pictures]]
cube = "cube.npz"
frames = 20
[[pictures]]
cube = "cube.npz"
mosaic = "bayer"
"""


def made_of(folder):
    """Digests of the files of a folder; of a summary, only what is equal in all runs."""
    values = {}
    for path in folder.rglob("*") if folder.exists() else ():
        content = path.read_bytes()
        if path.name == "summary.json":
            summary = json.loads(content)
            for picture in summary.get("pictures", ()):
                picture.pop("seconds")
                picture.pop("timings_s", None)
            content = json.dumps(summary).encode()
        if path.name == OWN_FILES:
            continue
        values[path.name] = hashlib.sha256(content).hexdigest()
    return values


def ran(arguments):
    with command(*arguments) as process:
        out, err = process.communicate(timeout=300)
    assert process.returncode == 0, err
    return out


@pytest.fixture(params=KINDS)
def kind(request, tmp_path, monkeypatch):
    """A command, what it makes, and how long its folder is being made. [s]"""
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(1)
    np.savez("cube.npz", reflectance=rng.random((60, 60, 14), np.float32), wavelength_nm=WAVELENGTH)
    Path("study.toml").write_text(STUDY)
    arguments = KINDS[request.param]
    ran((*arguments, "-o", "warm/o"))  # compiles
    with command(*arguments, "-o", "whole/o") as process:
        wait_for(lambda: list(Path("whole").glob(".o.*")), process)
        start = time.monotonic()
        process.communicate(timeout=300)
    return request.param, arguments, made_of(Path("whole/o")), time.monotonic() - start


def test_a_kill_at_a_random_moment_leaves_a_folder_whole_or_as_it_was(kind, capsys):
    name, arguments, whole, duration_s = kind
    draw, counts = random.Random(name), Counter()
    for moment in range(MOMENTS):
        place = Path(f"{moment:02d}")
        folder, sent = place / "o", (signal.SIGKILL, signal.SIGTERM)[moment // 2 % 2]
        place.mkdir()
        (place / "notes.txt").write_text("notes")
        if moment % 2 and name != "a study":  # a study refuses other results
            folder.mkdir()
            (folder / "mine.txt").write_text("mine")
        old = made_of(folder)
        with command(*arguments, "-o", folder) as process:
            wait_for(lambda place=place: list(place.glob(".o.*")), process)
            time.sleep(draw.uniform(0.0, 0.8 * duration_s))
            ended = process.poll() is not None
            process.send_signal(sent)
            process.wait(timeout=60)
        left = made_of(folder)
        if name == "a study":
            assert left.items() <= whole.items()
        else:
            assert left in (old, old | whole)
        state = "whole" if left == old | whole else "as before" if left == old else "some steps"
        counts["ended before" if ended else f"{sent.name}: {state}"] += 1
        assert {path.name for path in place.glob("[!.]*")} <= {"o", "notes.txt"}
        ran((*arguments, "-o", folder))
        assert made_of(folder) == old | whole
        assert sorted(path.name for path in place.iterdir()) == ["notes.txt", "o"]
        assert (place / "notes.txt").read_text() == "notes"
        shutil.rmtree(place)
    with capsys.disabled():
        print(f"\n{name}: {MOMENTS} kills over {duration_s:.1f} s: {dict(counts)}")
