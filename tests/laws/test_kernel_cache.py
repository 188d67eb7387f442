"""Compiled kernels match their sources: after a change no old code runs, in any cache."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from chromanoise.imaging import kernel_cache

OUTER = """
from mini.inner import INNER
from mini.kernel_cache import kernel

@kernel(error_model="numpy")
def outer(x):
    return INNER(x)
"""
INNER = """
from numba import njit

@njit(inline="always")
def INNER(x):
    return x + {added}
"""
ASK = """
from mini.outer import outer
print(outer(1), sum(outer.stats.cache_hits.values()), outer.stats.cache_path)
"""


@pytest.fixture
def installed(tmp_path):
    """A package of one kernel, which calls a function of another file."""
    package = tmp_path / "site" / "mini"
    package.mkdir(parents=True)
    shutil.copy(kernel_cache.__file__, package)
    (package / "__init__.py").touch()
    (package / "outer.py").write_text(OUTER)
    (package / "inner.py").write_text(INNER.format(added=1))
    return package


def asked(package, question=ASK, **variables):
    """Result of the kernel, how often it was loaded, and from which folder."""
    left = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    done = subprocess.run(
        [sys.executable, "-B", "-c", question],
        env={**left, "PYTHONPATH": str(package.parent), **variables},
        capture_output=True, text=True, check=True, timeout=60,
    )  # fmt: skip
    answer, hits, path = done.stdout.split()
    return int(answer), int(hits), None if path == "None" else Path(path)


def test_a_change_in_a_file_that_a_kernel_calls_is_seen_though_its_date_is_older(installed):
    answer, hits, folder = asked(installed)
    assert (answer, hits) == (2, 0)
    assert folder.is_relative_to(installed / "__pycache__")
    assert asked(installed) == (2, 1, folder)
    (installed / "inner.py").write_text(INNER.format(added=5))
    os.utime(installed / "inner.py", (100, 100))
    assert asked(installed)[:2] == (6, 0)
    assert folder.exists()  # another process may work with it


def test_old_kernels_are_removed_when_new_ones_are_compiled_and_not_before(installed):
    (kept,) = (one for one in asked(installed)[2].parents if one.name.startswith("kernels-"))
    (installed / "__pycache__" / "kernels-mine").mkdir()
    for added, days, is_kept in ((5, 29, True), (6, 31, False)):
        os.utime(kept, (time.time() - days * 86400,) * 2)
        (installed / "inner.py").write_text(INNER.format(added=added))
        asked(installed, question="import mini.outer\nprint(0, 0, None)")
        assert kept.exists()
        assert asked(installed)[:2] == (1 + added, 0)
        assert kept.exists() == is_kept
    assert (installed / "__pycache__" / "kernels-mine").is_dir()


def test_a_folder_for_kernels_that_the_user_names_is_used(installed, tmp_path):
    named = {"NUMBA_CACHE_DIR": str(tmp_path / "named")}
    assert asked(installed, **named)[2].is_relative_to(tmp_path / "named")


def test_without_a_folder_for_kernels_they_are_kept_for_the_user_or_in_memory(installed, tmp_path):
    (installed / "__pycache__").write_text("no folder")  # as if nothing could be written there
    caches = {"XDG_CACHE_HOME": str(tmp_path / "caches"), "TMPDIR": str(tmp_path)}
    if sys.platform == "linux":
        assert asked(installed, **caches)[2].is_relative_to(tmp_path / "caches")
    none = caches | {"XDG_CACHE_HOME": os.devnull, "HOME": os.devnull}
    private = tmp_path / f"chromanoise-{os.getuid()}"
    assert asked(installed, **none)[2].is_relative_to(private)
    assert private.stat().st_mode & 0o777 == 0o700
    assert asked(installed, **none)[:2] == (2, 1)
    private.chmod(0o777)  # another user could have put code there
    assert asked(installed, **none) == (2, 0, None)
