"""A format of spectra costs its module and one entry of the list of formats."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import chromanoise

BEFORE = "    (is_cgats, read_cgats),\n"
ENTRY = "    (toy.is_toy, toy.read_toy),\n"
IMPORT = "from chromanoise.io.spectra.delimited import"
MODULE = '''"""A format of pairs after the word TOY."""

import numpy as np

from chromanoise.io.spectra.parsed import Found, known_columns


def is_toy(text):
    return text.startswith("TOY")


def read_toy(text, source):
    table = np.array(text.split()[1:], dtype=float).reshape(-1, 2)
    return Found(
        source=source, format="toy", columns=known_columns(table[:, 0], [("T", table[:, 1])]),
        wavelength_unit="nm", quantity="QE", level="absolute", per="photon", scale="fraction",
    )
'''
QUESTIONS = """
import contextlib, io, json
import numpy as np
import chromanoise as cn
from chromanoise.study.resolve import resolve_sensor
from chromanoise.cli.entry import run
from chromanoise.io.spectra import read_curves

def printed(*words):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            run(list(words))
        except SystemExit as stopped:
            code = stopped.code
    return code, out.getvalue()

open("own.toy", "w").write("TOY 400 0.25 1050 0.5")
open("old.csv", "w").write("wavelength_nm,T\\n400,0.25\\n1050,0.5\\n")
open("bad.toy", "w").write("TOY 400 0.25 1050")
try:
    read_curves("bad.toy")
    refused = ""
except cn.InputError as error:
    refused = error.subject
print(json.dumps({
    "inspected": printed("inspect", "own.toy"),
    "sensor": [resolve_sensor(name).qe.ravel().tolist() for name in ("own.toy", "old.csv")],
    "refused": refused,
}))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What a copy of the package with the format answers."""
    folder = tmp_path_factory.mktemp("copy")
    copy = folder / "chromanoise"
    ignored = shutil.ignore_patterns("__pycache__", "*.pyi")
    shutil.copytree(Path(chromanoise.__file__).parent, copy, ignore=ignored)
    (copy / "io" / "spectra" / "toy.py").write_text(MODULE, encoding="utf-8")
    path = copy / "io" / "spectra" / "dispatch.py"
    old = path.read_text(encoding="utf-8")
    assert old.count(BEFORE) == old.count(IMPORT) == 1
    imported = old.replace(IMPORT, f"from chromanoise.io.spectra import toy\n{IMPORT}")
    path.write_text(imported.replace(BEFORE, BEFORE + ENTRY), encoding="utf-8")
    found = subprocess.run(
        [sys.executable, "-c", QUESTIONS],
        env=os.environ | {"PYTHONPATH": str(folder), "CHROMANOISE_CACHE": str(folder / "cache")},
        cwd=folder, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    return json.loads(found.stdout.splitlines()[-1])


def test_inspect_reads_it_and_names_it(answers):
    code, text = answers["inspected"]
    assert code in (0, None)
    assert "  format         toy\n" in text
    assert "  curves         1: T\n" in text


def test_it_gives_a_sensor_the_curve_of_the_same_numbers_in_csv(answers):
    toy, table = answers["sensor"]
    assert toy == table
    assert (toy[0], toy[-1]) == (0.25, 0.5)


def test_a_damaged_file_of_it_is_refused_by_its_name(answers):
    assert answers["refused"] == "bad.toy"
