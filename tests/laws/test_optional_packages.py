"""What needs an optional package names the extra that installs it, in one sentence."""

import ast
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.apps.training import sampler
from chromanoise.base import optional_package, refuse_absent_package
from chromanoise.imaging.denoising import DENOISING
from chromanoise.io import Column, Result, Table
from chromanoise.sensor import CameraNoise
from chromanoise.study import running, sensor_named
from outcomes import refused_input

ROOT = Path(__file__).resolve().parents[2]
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
DISTRIBUTIONS = {"skimage": "scikit-image", "cv2": "opencv-python-headless", "pywt": "pywavelets"}
FUNCTIONS = ("optional_package", "refuse_absent_package", "library", "refuse_absent_library")


class _OfOneCell(Result):
    def to_table(self):
        return Table(title="one", columns=(Column(name="a"),), rows=((1.0,),))

    plot = _repr_html_ = None


def _calls():
    """Package and extra of each call whose package stands in the source."""
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in FUNCTIONS:
                given = {one.arg: one.value for one in node.keywords}
                # `library` of the readers has the extra of cubes by default
                own = "library" in node.func.id
                extra = given.get("extra", ast.Constant("cubes")) if own else given["extra"]
                if isinstance(node.args[0], ast.Constant):
                    yield node.args[0].value.partition(".")[0], extra.value


@pytest.mark.evidence
def test_each_optional_package_is_in_the_extra_that_its_error_names():
    found = set(_calls())
    assert len(found) > 8
    for package, extra in found:
        names = {re.split(r"[><=]", one)[0].strip().lower() for one in EXTRAS[extra]}
        assert DISTRIBUTIONS.get(package, package).lower() in names, (package, extra)


def test_the_packages_of_denoising_methods_are_in_their_extra():
    names = {re.split(r"[><=]", one)[0].strip().lower() for one in EXTRAS["denoise"]}
    needed = {package for method in DENOISING.values() for package in method.packages}
    assert {DISTRIBUTIONS.get(one, one) for one in needed} == names


def test_an_absent_package_of_a_denoising_method_is_named_before_the_cube_is_rendered(monkeypatch):
    monkeypatch.setitem(sys.modules, "bm3d", None)
    monkeypatch.setattr(running, "captured_with", None)
    with refused_input(subject="denoise", value="bm3d"):
        cn.render("builtin:checker", "onyx-rgbw", denoise="bm3d")


@pytest.mark.parametrize("function", [optional_package, refuse_absent_package])
def test_an_absent_package_is_named_with_its_extra_and_what_else_helps(function, monkeypatch):
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with refused_input(subject="a.xlsx", requirement="needs the package openpyxl") as caught:
        function("openpyxl", "a.xlsx", extra="xlsx", otherwise=("save it as CSV",))
    assert str(caught.value) == (
        "a.xlsx: needs the package openpyxl, which is not installed; install it with "
        "pip install 'chromanoise[xlsx]', or save it as CSV"
    )


def test_a_data_frame_without_pandas_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with refused_input(subject="a data frame", requirement="needs the package pandas") as caught:
        _OfOneCell().to_dataframe()
    assert "chromanoise[pandas]" in str(caught.value)


WITHOUT_NUMBA = """
import sys
sys.modules["numba"] = sys.modules["llvmlite"] = None
from chromanoise.cli import main
main(sys.argv[1:])
"""


def _without_numba(*arguments):
    command = [sys.executable, "-c", WITHOUT_NUMBA, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


def test_without_numba_the_benchmark_compares_the_methods_that_need_none():
    words = ("builtin:checker", "--crop", "32", "--sensor", "onyx-rgb", "--levels", "10")
    found = _without_numba("denoise-bench", *words, "--json", "-")
    compared = {cell["method"] for cell in json.loads(found.stdout)["cells"]}
    needing = {name for name, one in DENOISING.items() if one.compiled}
    assert {"guided", "lmmse"} <= compared <= {*DENOISING} - needing
    assert all(f"not compared: {name}, which needs numba" in found.stderr for name in needing)


def test_without_numba_training_noise_names_the_extra(monkeypatch):
    add_noise = sampler(CameraNoise.from_sensor(sensor_named("onyx-rgb")))
    monkeypatch.setitem(sys.modules, "numba", None)
    with refused_input(subject="training noise", requirement="needs the package numba"):
        add_noise(np.ones((2, 2, 3)), unit="electron")


def test_without_numba_a_search_names_the_extra_and_writes_nothing(tmp_path):
    """Pictures need no numba: `test_kernel_cache` compares their bits."""
    design = ROOT / "examples/designs/better_than_both.toml"
    found = _without_numba("optimize", design, "-o", tmp_path / "front")
    assert found.returncode == 2
    assert "numba" in found.stderr
    assert "pip install 'chromanoise[compiled]'" in found.stderr
    assert not (tmp_path / "front").exists()
