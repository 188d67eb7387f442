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
    told = json.loads(done.stdout)
    for name, own in told["outcomes"].items():
        print(f"{name}: {own}")
    print(f"largest {told['largest_kib'] // 1024} MiB, {told['seconds']} s")
    assert done.stderr == ""
    assert told["faults"] == []
    assert sum(sum(own.values()) for own in told["outcomes"].values()) == COUNT
    assert told["largest_kib"] < 2**20
