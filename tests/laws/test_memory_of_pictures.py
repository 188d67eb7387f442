"""Memory of a process that renders and writes large pictures."""

import shutil
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from chromanoise.imaging.blocks import new_rows, parts_of_rows, release
from chromanoise.imaging.shared_rows import Work
from chromanoise.study import (
    makers_of,
    operating_points_of,
    prepared_cameras,
    study_of,
    taken_pictures,
)

HEIGHT, WIDTH = 2400, 2500
PIXELS = HEIGHT * WIDTH

linux = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")


def private_bytes() -> int:
    """Memory of this process alone, in files or not."""
    lines = Path("/proc/self/smaps_rollup").read_text().splitlines()
    return 1024 * sum(int(line.split()[1]) for line in lines if line.startswith("Private_"))


@contextmanager
def growth_of_memory() -> Iterator[list[int]]:
    """A list that holds the largest growth of private memory after the context. [bytes]"""
    before, most, ended = private_bytes(), [0], threading.Event()

    def watch() -> None:
        while not ended.wait(0.005):
            most[0] = max(most[0], private_bytes() - before)

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        yield most
    finally:
        ended.set()
        watcher.join()


def sparse_cube(folder: Path, height: int) -> str:
    """A cube of zeros, which are valid, without space on the disk."""
    (folder / "cube.hdr").write_text(
        f"ENVI\nsamples = {WIDTH}\nlines = {height}\nbands = 2\nheader offset = 0\n"
        "data type = 4\ninterleave = bip\nbyte order = 0\n"
        "wavelength units = Nanometers\nwavelength = {400, 1050}\n"
    )
    with (folder / "cube.img").open("wb") as file:
        file.truncate(height * WIDTH * 2 * 4)
    return str(folder / "cube.hdr")


def written(folder: Path, height: int) -> None:
    folder.mkdir()
    cube = sparse_cube(folder, height)
    study = study_of("render", ("onyx-rgbw",), {"formats": ("xyz", "srgb16")}, cube=cube)
    cube, cameras = prepared_cameras(study, 0, operating_points_of(study), makers_of(study))
    for one in taken_pictures(study, 0, cube, cameras, work=Work(threads=2), folder=folder):
        del one


@linux
def test_a_picture_takes_less_private_memory_than_its_xyz_has_bytes(tmp_path):
    written(tmp_path / "compiles", 64)
    with growth_of_memory() as most:
        written(tmp_path / "large", HEIGHT)
    assert most[0] < 12 * PIXELS  # XYZ in float32


@linux
def test_numbers_of_an_array_in_a_file_stay_when_its_memory_is_released(tmp_path):
    rows = new_rows((3000, 1000, 3), np.float32, folder=tmp_path)
    rows[:] = np.arange(9e6, dtype=np.float32).reshape(rows.shape)
    release(rows[5:7])
    assert list(tmp_path.iterdir()) == []  # the file has no name
    assert sum(part.sum(dtype=np.float64) for _, part in parts_of_rows(rows)) == 9e6 * (9e6 - 1) / 2


def test_memory_without_a_file_is_not_released():
    rows = new_rows((3000, 1000, 3), np.float32)
    rows[:] = 1
    release(rows)
    assert rows.min() == 1


def test_a_full_disk_leaves_the_picture_in_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=0))
    rows = new_rows((3000, 1000, 3), np.float32, folder=tmp_path)
    rows[:] = 1
    release(rows)
    assert rows.min() == 1
