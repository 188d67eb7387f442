"""A format of cubes costs its module and one entry of the list of formats."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import tifffile

import chromanoise

MODULE = '''
"""Cubes as text: rows, columns and bands, the wavelengths, and the numbers."""

import numpy as np

from chromanoise.io.cubes.raw_cube import Found, refuse_other_shape


def text_cube(path, shape):
    """The cube in a text file."""
    sizes, wavelengths, numbers = (
        np.array(line.split(), dtype=float) for line in path.read_text().splitlines()
    )
    pixels = numbers.reshape([int(n) for n in sizes])
    refuse_other_shape(path, pixels, shape)
    return Found(pixels=pixels, wavelengths=lambda: (wavelengths, ()))
'''
BEFORE = "FORMATS = (\n"
ENTRY = """from chromanoise.io.cubes.text_cube import text_cube

FORMATS = (
    CubeFormat(shown=".textcube", matches=_ends(".textcube"), cube=text_cube),
"""
WAVELENGTHS = np.linspace(400, 1050, 14)
NUMBERS = np.random.default_rng(7).uniform(0.1, 0.9, (4, 6, WAVELENGTHS.size))


@pytest.fixture(scope="module")
def changed(tmp_path_factory):
    """A function that runs the command line of a copy of the package with the two edits."""
    folder = tmp_path_factory.mktemp("copy")
    copy = folder / "chromanoise"
    ignored = shutil.ignore_patterns("__pycache__", "*.pyi")
    shutil.copytree(Path(chromanoise.__file__).parent, copy, ignore=ignored)
    (copy / "io" / "cubes" / "text_cube.py").write_text(MODULE, encoding="utf-8")
    path = copy / "io" / "cubes" / "dispatch.py"
    old = path.read_text(encoding="utf-8")
    assert old.count(BEFORE) == 1
    path.write_text(old.replace(BEFORE, ENTRY), encoding="utf-8")

    def run(*words):
        return subprocess.run(
            [sys.executable, "-c", "from chromanoise.cli import main; main()", *map(str, words)],
            env=os.environ | {"PYTHONPATH": str(folder)},
            cwd=folder, capture_output=True, text=True, timeout=300, check=False,
        )  # fmt: skip

    return run


def test_simulate_renders_a_file_of_it_as_the_same_numbers_in_another_format(changed, tmp_path):
    lines = [NUMBERS.shape, WAVELENGTHS, NUMBERS.ravel()]
    text = "\n".join(" ".join(repr(float(n)) for n in line) for line in lines)
    (tmp_path / "cube.textcube").write_text(text, encoding="utf-8")
    np.save(tmp_path / "cube.npy", NUMBERS)
    pictures = []
    for name, options in (("cube.textcube", ()), ("cube.npy", ("--wavelengths", "400:1050"))):
        out = tmp_path / name.replace(".", "-")
        sensor = ("--sensor", "onyx-rgbw", "--format", "xyz", "--out", out)
        found = changed("simulate", tmp_path / name, *sensor, *options)
        assert found.returncode == 0, found.stderr
        (file,) = out.glob("*.tiff")
        pictures.append(tifffile.imread(file))
    assert pictures[0].shape == (4, 6, 3)
    np.testing.assert_array_equal(*pictures)


def test_it_is_among_the_formats_that_a_refusal_lists(changed, tmp_path):
    (tmp_path / "cube.unknown").write_bytes(b"1 2 3")
    found = changed("simulate", tmp_path / "cube.unknown", "--sensor", "onyx-rgbw")
    assert found.returncode == 2
    assert ".textcube" in found.stderr
