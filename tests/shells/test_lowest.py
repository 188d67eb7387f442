"""What failed with the lowest declared versions, and that they exist as declared.

`make lowest` runs it with these versions.
"""

import re
import tomllib
from pathlib import Path

import pytest

from chromanoise.study import study_from_data

PROJECT = Path(__file__).parents[2] / "pyproject.toml"


def test_a_study_takes_gains_of_white_balance_as_a_list():
    pipeline = {"run": True, "white_balance": [2.0, 1.0, 1.5]}
    study = study_from_data(
        {"sensors": [{"name": "onyx-rgb"}], "outputs": {"pipeline": pipeline}}, source=""
    )
    assert study.outputs.pipeline.white_balance == (2.0, 1.0, 1.5)


@pytest.mark.evidence
@pytest.mark.parametrize(
    "words",
    [
        ("analyze", "onyx-rgbw", "onyx-rgb-ircut", "--merit", "--chart", "--json", "-"),
        ("compare", "onyx-rgbw", "onyx-rgb-ircut", "--points", "3", "--json", "-"),
        ("simulate", "builtin:checker", "--sensor", "onyx-rgb", "--mosaic", "bayer", "-o", "out"),
    ],
    ids=lambda words: words[0],
)
def test_a_command_runs(done, here, words):
    done(*words)


def test_every_direct_dependency_has_a_lower_bound():
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    for requirement in project["dependencies"]:
        assert re.fullmatch(r"[a-z0-9-]+>=[0-9.]+", requirement), requirement
