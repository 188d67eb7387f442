"""Damaged cubes of every format give a cube or an error of one sentence."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

for package in ("h5py", "zarr"):
    pytest.importorskip(package, reason="comes with chromanoise[cubes]")

SERVER = Path(__file__).resolve().parents[1] / "damaged_cubes.py"
COUNT = int(os.environ.get("CHROMANOISE_DAMAGED_CUBES", "600"))


@pytest.mark.evidence
@pytest.mark.skipif(not hasattr(os, "fork"), reason="each file is read in a fork")
def test_a_damaged_cube_of_any_format_is_a_cube_or_one_sentence_in_bounded_time_and_memory():
    """CHROMANOISE_DAMAGED_CUBES says how many files; the server limits time and memory of each."""
    done = subprocess.run(
        [sys.executable, "-P", str(SERVER), str(COUNT)],
        capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )  # fmt: skip
    data = json.loads(done.stdout)
    for name, own in data["outcomes"].items():
        print(f"{name}: {own}")
    print(f"largest {data['largest_kib'] // 1024} MiB, {data['seconds']} s")
    assert done.stderr == ""
    assert data["faults"] == []
    assert sum(sum(own.values()) for own in data["outcomes"].values()) == COUNT
    assert data["largest_kib"] < 2**20
