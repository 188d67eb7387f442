"""A quantity of a comparison costs one edit, and so does an objective of a design."""

import pytest

from edited_copies import answers_of_copy

QUANTITY = """@_quantity("fullness", "share of full well", "1", over_levels=False, of_raw=True)
def _fullness(point: OperatingPoint, matrix: ColorMatrix) -> float:
    return float(electrons_at(point).max() / point.sensor.pixel.full_well_e)


"""
OBJECTIVE = """@_objective("headroom", "rest of full well", "1", "higher", of_saturated=True)
def _headroom(candidate: Candidate) -> float:
    point = candidate.point
    return float(1 - electrons_at(point).max() / point.sensor.pixel.full_well_e)


"""
EDITS = {
    "study/sweeps.py": ("def is_saturated(", QUANTITY),
    "apps/design/objectives.py": ("FAST = tuple(", OBJECTIVE),
}
QUESTIONS = """
import contextlib, io, json
from pathlib import Path
import numpy as np
import chromanoise as cn
from chromanoise.cli.entry import run
from chromanoise.apps.design import Candidates, DesignScene, DesignStudy, Objectives
from chromanoise.web.controls import choices
from chromanoise.study import operating_points_of, study_from_data, study_schema

def printed(*words):
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.suppress(SystemExit):
        run(list(words))
    return text.getvalue()

NAME, OTHER = "onyx-rgb-ircut", "onyx-rgbw"
compared = cn.compare(NAME, vary="lux", first=1, last=10, points=2, quantity="fullness")
command = printed("compare", NAME, "--sweep", "lux=1:10", "--points", "2",
                  "--quantity", "fullness", "--json", "-")
Path("study.toml").write_text(
    f'schema = 1\\n[[sensors]]\\nname = "{NAME}"\\n[[sensors]]\\nname = "{OTHER}"\\n'
    '[[sweeps]]\\nvary = "lux"\\nfirst = 1\\nlast = 10\\npoints = 2\\nquantity = "fullness"\\n'
)
printed("report", "study.toml", "-o", "report.html")
data = {"sensors": [{"name": NAME}]}
(point,) = operating_points_of(study_from_data(data, source="a test"))
scene = DesignScene(point=point)
design = Objectives(scenes=(scene,), objectives=("headroom", "snr_y_db"))
sensitive = cn.sensitivity(NAME, objectives=["headroom"])
import reference_pages  # of the docs
print(json.dumps({
    "of Python": compared.to_dict()["curves"][0]["value"],
    "of the command": json.loads(command)["curves"][0]["value"],
    "sentence": json.loads(command)["quantity"],
    "help of compare": printed("compare", "--help"),
    "page": [one["name"] for one in choices()["quantities"]],
    "report": Path("report.html").read_text(encoding="utf-8").count("share of full well"),
    "schema": json.dumps(study_schema()),
    "docs": reference_pages.page_of_keys(),
    "help of sensitivity": printed("sensitivity", "--help"),
    "docs of commands": "".join(reference_pages.command_pages().values()),
    "objective": sensitive.value["headroom"],
    "slope": {one.parameter.name: one.slope["headroom"] for one in sensitive.effects},
    "table": sensitive.to_dict()["objectives"]["headroom"],
    "design": design.values(Candidates(qe=np.asarray(point.sensor.qe)[None])).tolist(),
    "schema of a design": json.dumps(DesignStudy.model_json_schema()),
}))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What a copy of the package with one edit for each answers."""
    pytest.importorskip("sphinx")
    return answers_of_copy(tmp_path_factory.mktemp("copy"), EDITS, QUESTIONS)


def test_python_and_the_command_give_the_share_for_which_the_time_was_solved(answers):
    assert answers["of Python"] == pytest.approx([0.099, 0.99], rel=1e-12)
    assert answers["of the command"] == answers["of Python"]
    assert answers["sentence"] == {"name": "fullness", "what": "share of full well", "unit": "1"}


@pytest.mark.parametrize("place", ["help of compare", "page", "schema", "docs", "docs of commands"])
def test_help_page_schema_and_docs_name_the_quantity(answers, place):
    assert "fullness" in answers[place]


def test_the_report_of_a_study_names_it(answers):
    assert answers["report"] > 0


def test_a_sensitivity_and_a_design_compute_the_objective(answers):
    assert answers["objective"] == pytest.approx(0.01, rel=1e-9)
    assert answers["slope"]["level_lux"] == pytest.approx(-0.0099, rel=1e-9)
    ((headroom, _),) = answers["design"]
    assert headroom == pytest.approx(0.01, rel=1e-9)
    assert answers["table"]["what"] == "rest of full well"


@pytest.mark.parametrize("place", ["help of sensitivity", "schema of a design", "docs of commands"])
def test_help_schema_and_docs_name_the_objective(answers, place):
    assert "headroom" in answers[place]
