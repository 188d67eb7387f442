"""Another observer in the output of the commands: conditions, notes, JSON, files, refusals."""

import json

import numpy as np
import pytest
import tifffile

import chromanoise as cn
from chromanoise.spectra import OBSERVERS
from outcomes import refused

COMMANDS = [
    ("analyze", "model-rgb-ircut"),
    ("compare", "model-rgb-ircut", "onyx-rgbw", "--points", "3"),
    ("matrix", "model-rgb-ircut"),
]


@pytest.mark.parametrize("words", COMMANDS, ids=lambda words: words[0])
def test_every_result_says_its_observer_in_json(result_of, words):
    assert result_of(*words)["observer"] == "cie-1931-2"
    for observer in OBSERVERS:
        assert result_of(*words, "--observer", observer)["observer"] == observer


@pytest.mark.parametrize("words", COMMANDS, ids=lambda words: words[0])
def test_the_conditions_name_an_observer_other_than_cie_1931(done, words):
    assert "observer" not in done(*words)[0]
    assert "observer cie-2015-2)" in done(*words, "--observer", "cie-2015-2")[0]


@pytest.mark.parametrize("command", ["analyze", "matrix"])
def test_a_note_says_that_y_of_another_observer_is_not_an_illuminance(result_of, command):
    def notes(*more):
        data = result_of(command, "model-rgb-ircut", *more)
        return data["sensors"][0]["notes"] if command == "analyze" else data["notes"]

    (note,) = set(notes("--observer", "cie-1964-10")) - set(notes())
    assert "cie-1964-10" in note


def test_figures_of_merit_say_their_observer(done, result_of):
    words = ("analyze", "model-rgb-ircut", "--merit")
    usual, other = (result_of(*words, "--observer", name) for name in list(OBSERVERS)[:2])
    merits = [one["sensors"][0]["merits"] for one in (usual, other)]
    assert [one["observer"] for one in merits] == ["cie-1931-2", "cie-1964-10"]
    values = [one["values"] for one in merits]
    assert values[0]["vora_value"]["value"] != values[1]["vora_value"]["value"]
    assert values[0]["smi"] == values[1]["smi"]
    assert "observer" not in done(*words)[0]
    assert "cie-1964-10" in done(*words, "--observer", "cie-1964-10")[0]


def test_pictures_are_those_of_the_observer(done, here):
    words = ("simulate", "builtin:checker", "--sensor", "model-rgb-ircut", "--format", "xyz")
    done(*words, "-o", "usual")
    err = done(*words, "--observer", "cie-2015-10", "-o", "other")[1]
    assert "observer cie-2015-10" in err
    read = {}
    for folder, observer in (("usual", "cie-1931-2"), ("other", "cie-2015-10")):
        (picture,) = json.loads((here / folder / "summary.json").read_text())["pictures"]
        assert picture["observer"] == observer
        with tifffile.TiffFile(here / folder / "model-rgb-ircut.xyz.tiff") as file:
            result = file.pages[0].description
            assert (observer in result) == (folder == "other")
            read[folder] = file.asarray()
    # the draws are the same, and 3 channels to X, Y, Z have an inverse: one map for all pixels
    usual, other = (read[name].reshape(-1, 3).astype(float) for name in ("usual", "other"))
    between, *_ = np.linalg.lstsq(usual, other, rcond=None)
    assert np.abs(usual @ between - other).max() < 1e-5
    assert np.abs(between - np.eye(3)).max() > 0.01


@pytest.mark.parametrize("ending", ["csv", "json", "clf", "dcp.json"])
def test_an_exported_matrix_says_its_observer(done, here, ending):
    file = here / f"matrix.{ending}"
    done("matrix", "model-rgb-ircut", "--observer", "cie-1964-10", "--export", file)
    assert "cie-1964-10" in file.read_text()


@pytest.mark.parametrize(
    "words",
    [
        *COMMANDS,
        ("simulate", "builtin:checker", "--sensor", "model-rgb-ircut"),
    ],
    ids=lambda words: words[0],
)
def test_an_unknown_observer_is_refused_with_near_names(run, here, words):
    outcome = run(*words, "--observer", "cie-1964")
    refused(outcome, "--observer", "cie-1964-10", subject="observer", value="cie-1964")


@pytest.mark.evidence
def test_a_study_has_an_observer(done, here):
    study = 'observer = "cie-2015-10"\n[[sensors]]\nname = "model-rgb-ircut"\n'
    (here / "study.toml").write_text(study)
    done("run", "study.toml", "--out", "out")
    (data,) = (json.loads(path.read_bytes()) for path in (here / "out").glob("analysis-*.json"))
    assert data["result"]["observer"] == "cie-2015-10"
    done("report", "study.toml", "-o", "report.html")
    assert "observer cie-2015-10)" in (here / "report.html").read_text(encoding="utf-8")
    in_python = cn.analyze("model-rgb-ircut", observer="cie-2015-10", budget=True).to_dict()
    assert json.loads(json.dumps(in_python)) == data["result"]
