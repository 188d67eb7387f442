"""A format of spectra or of cubes costs its reader and one entry of the list of formats."""

import json

import numpy as np
import pytest

from edited_copies import answers_of_copy

SPECTRA = '''"""A format of pairs after the word TOY."""

import numpy as np

from chromanoise.io.spectra import Found, known_columns


def is_toy(text):
    return text.startswith("TOY")


def read_toy(text, source):
    table = np.array(text.split()[1:], dtype=float).reshape(-1, 2)
    return Found(
        source=source, format="toy", columns=known_columns(table[:, 0], [("T", table[:, 1])]),
        wavelength_unit="nm", quantity="QE", level="absolute", per="photon", scale="fraction",
    )
'''
CUBES = '''"""Cubes as text: rows, columns and bands, the wavelengths, and the numbers."""

import numpy as np

from chromanoise.io.cubes.found_cube import Found, refuse_other_shape


def text_cube(path, shape):
    """The cube in a text file."""
    sizes, wavelengths, numbers = (
        np.array(line.split(), dtype=float) for line in path.read_text().splitlines()
    )
    pixels = numbers.reshape([int(n) for n in sizes])
    refuse_other_shape(path, pixels, shape)
    return Found(pixels=pixels, wavelengths=lambda: (wavelengths, ()))
'''
EDITS = {
    "io/curve_files.py": (
        "from chromanoise.io.envi import",
        "from chromanoise.io.toy import is_toy, read_toy\n",
        "    (is_cgats, read_cgats),\n", "    (is_toy, read_toy),\n",
    ),
    "io/cubes/cube_files.py": (
        "from chromanoise.io.cubes.found_cube import (",
        "from chromanoise.io.text_cube import text_cube\n",
        '    CubeFormat(shown=".npz"',
        '    CubeFormat(shown=".textcube", matches=_ends(".textcube"), cube=text_cube),\n',
    ),
}  # fmt: skip
NUMBERS = np.random.default_rng(7).uniform(0.1, 0.9, (2, 3, 14))
QUESTIONS = """
import contextlib, io, json
from pathlib import Path
import numpy as np
import chromanoise as cn
from chromanoise.cli.entry import run
from chromanoise.io.cubes import read_cube
from chromanoise.io.spectra import read_curves
from chromanoise.study.resolve_names import resolve_sensor

def printed(*words):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            run(list(words))
        except SystemExit as stopped:
            return stopped.code, out.getvalue()

def refused(read, name):
    try:
        read(name)
    except cn.InputError as error:
        return error.subject, error.requirement

Path("own.toy").write_text("TOY 400 0.25 1050 0.5")
Path("old.csv").write_text("wavelength_nm,T\\n400,0.25\\n1050,0.5\\n")
Path("bad.toy").write_text("TOY 400 0.25 1050")
numbers = np.array(NUMBERS)
lines = [numbers.shape, np.linspace(400, 1050, 14), numbers.ravel()]
text = "\\n".join(" ".join(repr(float(n)) for n in line) for line in lines)
Path("cube.textcube").write_text(text)
Path("cube.unknown").write_bytes(b"1 2 3")
cube = read_cube("cube.textcube")
print(json.dumps({
    "inspected": printed("inspect", "own.toy"),
    "sensor": [resolve_sensor(name).qe.ravel().tolist() for name in ("own.toy", "old.csv")],
    "refused": refused(read_curves, "bad.toy"),
    "cube": [cube.stored.tolist(), cube.wavelength_nm.tolist()],
    "unknown": refused(read_cube, "cube.unknown"),
    "simulated": printed("simulate", "cube.textcube", "--sensor", "onyx-rgbw", "-o", "out"),
    "pictures": sorted(one.suffix for one in Path("out").iterdir()),
}))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What a copy of the package with both formats answers."""
    script = QUESTIONS.replace("NUMBERS", json.dumps(NUMBERS.tolist()))
    folder = tmp_path_factory.mktemp("copy")
    return answers_of_copy(folder, EDITS, script, {"io/toy.py": SPECTRA, "io/text_cube.py": CUBES})


def test_inspect_reads_spectra_of_it_and_names_it(answers):
    code, text = answers["inspected"]
    assert code in (0, None)
    assert "  format         toy\n" in text
    assert "  curves         1: T\n" in text


def test_it_gives_a_sensor_the_curve_of_the_same_numbers_in_csv(answers):
    toy, table = answers["sensor"]
    assert toy == table
    assert (toy[0], toy[-1]) == (0.25, 0.5)


def test_a_damaged_file_of_it_is_refused_by_its_name(answers):
    assert answers["refused"][0] == "bad.toy"


def test_a_cube_of_it_has_its_numbers_and_is_rendered(answers):
    assert answers["cube"] == [NUMBERS.tolist(), np.linspace(400, 1050, 14).tolist()]
    assert answers["simulated"][0] in (0, None)
    assert ".png" in answers["pictures"]


def test_it_is_among_the_formats_that_a_refusal_lists(answers):
    assert ".textcube" in answers["unknown"][1]
