"""A setting costs one edit, in one file, and the line that uses it."""

import pytest

from chromanoise.study import hashes, study_from_data, study_hash
from edited_copies import answers_of_copy

BEFORE = "    magnification: Finite | None = setting("
SETTING = """    lens_transmission: Annotated[float, Field(gt=0, le=1)] = setting(
        1.0, "Transmission of the lens.", label="Lens transmission", slider=(0.1, 1.0, 0.01),
        later=True,
    )
"""
QUESTIONS = """
import contextlib, inspect, io, json
import chromanoise as cn
from chromanoise.cli.entry import run
from chromanoise.web.controls import described_fields
from chromanoise.study import (
    hashes, study_as_command, study_as_python, study_as_toml, study_from_data, study_hash, study_of,
    study_schema,
)

def printed(*words):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            run(list(words))
        except SystemExit as stopped:
            code = stopped.code
    return code, out.getvalue(), err.getvalue()

hashes.__version__ = "a version"
study = study_of("analyze", ["onyx-rgbw"], {"lens_transmission": 0.5})
try:
    cn.analyze("onyx-rgbw", lens_transmission=2)
    refused = ""
except cn.InputError as error:
    refused = error.subject
schema = study_schema()["$defs"]["ExposurePart"]["properties"]["lens_transmission"]
print(json.dumps({
    "value": study.exposure.lens_transmission,
    "schema": [schema["default"], schema["maximum"]],
    "signature": "lens_transmission" in inspect.signature(cn.compare).parameters,
    "docstring": "lens_transmission : float, default 1.0" in cn.render.__doc__,
    "help": [printed(name, "--help-all")[1].count("--lens-transmission") for name in
             ("analyze", "compare", "matrix", "sensitivity", "simulate", "denoise")],
    "command": study_as_command(study),
    "python": "lens_transmission=0.5" in study_as_python(study),
    "toml": "lens_transmission = 0.5" in study_as_toml(study),
    "control": [one for one in described_fields() if one["key"] == "exposure.lens_transmission"],
    "refused": refused,
    "refused by the command": printed("analyze", "onyx-rgbw", "--lens-transmission", "2")[::2],
    "hash": study_hash(study_from_data({"sensors": [{"name": "onyx-rgbw"}]})),
    "another hash": study_hash(study),
}))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What a copy of the package with the edit answers."""
    return answers_of_copy(
        tmp_path_factory.mktemp("copy"), {"study/schema.py": (BEFORE, SETTING)}, QUESTIONS
    )


def test_a_study_its_schema_and_its_copies_have_it(answers):
    assert answers["value"] == 0.5
    assert answers["schema"] == [1.0, 1]
    assert answers["command"] == "chromanoise analyze onyx-rgbw --lens-transmission 0.5"
    assert answers["python"]
    assert answers["toml"]


def test_python_and_six_commands_have_it(answers):
    assert answers["signature"]
    assert answers["docstring"]
    assert answers["help"] == [1] * 6


def test_the_page_has_a_control_with_its_words_and_its_range(answers):
    (control,) = answers["control"]
    assert (control["label"], control["section"]) == ("Lens transmission", "Exposure")
    assert (control["low"], control["high"], control["step"]) == (0.1, 1.0, 0.01)


def test_a_value_out_of_bounds_is_refused_by_its_name(answers):
    assert answers["refused"] == "lens_transmission"
    code, sentence = answers["refused by the command"]
    assert code == 2
    assert sentence.startswith("chromanoise: --lens-transmission must be")


def test_a_study_without_it_keeps_its_hash(answers, monkeypatch):
    monkeypatch.setattr(hashes, "__version__", "a version")
    assert answers["hash"] == study_hash(study_from_data({"sensors": [{"name": "onyx-rgbw"}]}))
    assert answers["another hash"] != answers["hash"]
