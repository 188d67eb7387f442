"""Compiled kernels match their sources, in any cache; the first small picture needs none."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.imaging import kernel_cache, noise_draws, noisy_electrons, plain, sampling
from chromanoise.imaging.blocks import Converter, Draw, Layout, RowsInMemory, Well
from chromanoise.imaging.plans import srgb_table

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


@pytest.mark.evidence
def test_a_change_in_a_file_that_a_kernel_calls_is_seen_though_its_date_is_older(installed):
    answer, hits, folder = asked(installed)
    assert (answer, hits) == (2, 0)
    assert folder.is_relative_to(installed / "__pycache__")
    assert asked(installed) == (2, 1, folder)
    (installed / "inner.py").write_text(INNER.format(added=5))
    os.utime(installed / "inner.py", (100, 100))
    assert asked(installed)[:2] == (6, 0)
    assert folder.exists()  # another process may work with it


@pytest.mark.evidence
def test_a_change_in_a_file_that_a_kernel_of_another_package_calls_is_seen(installed):
    other = installed.parent / "other"
    other.mkdir()
    (other / "outer.py").write_text(OUTER)
    question = ASK.replace("mini.outer", "other.outer")
    (first, *_), (second, hits, _) = asked(installed, question), asked(installed, question)
    assert (first, second, hits) == (2, 2, 1)
    (installed / "inner.py").write_text(INNER.format(added=2))
    assert asked(installed, question)[:2] == (3, 0)


@pytest.mark.evidence
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


@pytest.mark.evidence
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


@pytest.mark.parametrize("layout", ["BIP", "BSQ"])
@pytest.mark.parametrize(
    "draw", [(2.0, 0.01, 0.5, 0.3, 0.2, 0.1, 1.0), (0.5, *[0.0] * 6), (0.0, *[0.0] * 6)]
)
def test_plain_pictures_have_the_bits_of_the_kernels(layout, draw):
    from chromanoise.imaging import fused_kernels

    f, pitch = np.float32, {"BIP": (31, 1), "BSQ": (1, 600)}[layout]
    weights = np.zeros((4, 32), f)
    weights[:, :31] = stream(1).random((4, 31)) * 0.01
    noise = Draw(*map(f, draw), 2, f(3), f(0.5), True, np.uint64(12345678912345), np.uint64(3))
    matrices = (stream(2).random((6, 4)) * 1e-3).astype(f)
    made = []
    for code in (fused_kernels, plain):
        seen = np.repeat(np.array([3e38, -3e38], f), 8)
        numbers = stream(3).integers(0, 4000, 5 * 600 * 31).astype(f)
        numbers.flags.writeable = False
        rows = RowsInMemory(numbers, Layout(31, 600 * 31, *pitch), weights, seen)
        codes, counts = np.zeros((5, 600), np.uint16), np.zeros((2, 5, 3, 4))
        adc = Converter(f(3000), f(1.3), f(64), f(4095))
        code.raw_rows(rows, np.array([[0, 1], [2, 3]]), 5, noise, adc, codes, counts[0])
        xyz, srgb = np.zeros((5, 600, 3), f), np.zeros((5, 600, 3), np.uint8)
        well = Well(f(3000), True)
        code.color_rows(rows, 5, noise, well, matrices, srgb_table(), xyz, srgb, counts[1])
        made.append((codes, xyz.view(np.uint32), srgb, counts, seen[:8].min(), seen[8:].max()))
    for ours, theirs in zip(*made, strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("read_noise_e", [0.0, 0.3, 2.0])
def test_plain_noise_has_the_bits_of_the_kernel(read_noise_e, monkeypatch):
    mean = np.exp(stream(5).uniform(-3, 9, (33, 40, 5)))
    tile = {"first_row": 7, "first_column": 3, "width": 50, "frame": 2, "seed": 2**40 + 1}
    found = []
    for module in (plain, noise_draws):
        monkeypatch.setattr(sampling, "kernel_of", lambda *_, of=module: of.fill_noise)
        found.append(noisy_electrons(mean, read_noise_e=read_noise_e, **tile))
    np.testing.assert_array_equal(*found)


def test_the_first_small_picture_needs_no_compiler(tmp_path):
    arguments = ["simulate", "builtin:checker", "--sensor", "onyx-rgbw", "--mosaic", "sensor"]
    arguments += ["--out", str(tmp_path / "out")]
    question = (
        "import atexit, os, sys; from chromanoise.cli import main;"
        "atexit.register(lambda: 'numba' in sys.modules and os._exit(3));"
        f"main({arguments})"
    )
    variables = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", question], env=variables, capture_output=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    (spent,) = tmp_path.glob("chromanoise/*/milliseconds-of-plain-raw_rows-*")
    assert spent.stat().st_size > 0


def test_a_kernel_of_another_data_type_is_compiled_when_its_plain_pictures_cost_as_much(
    tmp_path, monkeypatch
):
    from chromanoise.imaging import fused_kernels

    called = []
    monkeypatch.setattr(fused_kernels, "color_rows", lambda: called.append("compiled"))
    monkeypatch.setattr(plain, "color_rows", lambda: called.append("plain"))
    monkeypatch.setattr(kernel_cache, "kernel_folder", lambda _: tmp_path)
    monkeypatch.setattr(kernel_cache, "_ready", set())

    def call(values, kind):
        kernel_cache.kernel_of("fused_kernels", "color_rows", values, 31, kind)()

    call(100, "float32")
    call(10_000_000, "float32")
    call(100, "float32")
    kernel_cache._ready.clear()  # another process
    call(100, "float32")
    call(100, "float64")
    (tmp_path / "milliseconds-of-plain-color_rows-float64").write_bytes(b"." * 10_000)
    call(100, "float64")
    assert called == ["plain", "compiled", "compiled", "compiled", "plain", "compiled"]
