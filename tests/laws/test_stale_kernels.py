"""Compiled kernels outlive no change of any source beside them."""

import os

import pytest

from chromanoise.imaging.stale import drop_stale_kernels

KERNELS = ("fused.color_rows-1.py311.1.nbc", "fused.color_rows-1.py311.nbi", "other.f-2.py311.nbi")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "__pycache__").mkdir()
    for second, name in enumerate(("fused.py", "variates.py")):
        written_at(tmp_path / name, 100 + second)
    for name in (*KERNELS, "fused.cpython-311.pyc"):
        written_at(tmp_path / "__pycache__" / name, 200)
    return tmp_path


def written_at(path, seconds):
    path.write_bytes(b"")
    os.utime(path, (seconds, seconds))


def left_in(folder):
    return {path.name for path in (folder / "__pycache__").iterdir()}


def test_kernels_younger_than_all_sources_are_kept(folder):
    assert drop_stale_kernels(folder) == 0
    assert left_in(folder) == {*KERNELS, "fused.cpython-311.pyc"}


def test_a_change_in_a_file_that_kernels_call_drops_all_of_them_and_nothing_else(folder):
    written_at(folder / "variates.py", 300)
    assert drop_stale_kernels(folder) == len(KERNELS)
    assert left_in(folder) == {"fused.cpython-311.pyc"}


def test_without_a_cache_nothing_happens(tmp_path):
    assert drop_stale_kernels(tmp_path) == 0
