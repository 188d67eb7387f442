"""`init`, `run`, `rerun`, `study`: a file that anyone can run again to the same digits."""

import json

import pytest

from chromanoise.base.files import OWN_FILES
from outcomes import refused

FEW = ("--set", "sweeps.0.points=3")


@pytest.fixture
def starter(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("init") == (0, "study.toml: change it, then `chromanoise run study.toml`\n", "")
    return tmp_path / "study.toml"


def files_of(folder):
    return {p.name: p.read_bytes() for p in sorted(folder.iterdir()) if p.name != OWN_FILES}


def test_the_starter_runs_as_it_is_and_again_to_the_same_bytes(run, done, starter, tmp_path):
    out, _ = done("run", "study.toml", *FEW)
    names = ["analysis-kernel", "analysis-lmmse", "sweep-1-lux-snr-y"]
    *answers, first, second, third = out.splitlines()
    assert [first, second, third] == [f"out/study/{name}.json" for name in names]
    assert answers
    first = files_of(tmp_path / "out" / "study")
    for result in map(json.loads, first.values()):
        assert {"version", "study", "seed", "files", "hash"} <= set(result)
    assert run("run", "study.toml", *FEW)[2].count("(already done)") == 3
    for output in ("out/study", "out/study/analysis-lmmse.json"):
        done("rerun", output, "-o", "again")
        assert files_of(tmp_path / "again") == first


def test_results_that_were_moved_and_linked_are_done(run, starter, tmp_path):
    starter.write_text('schema = 1\n[[sensors]]\nname = "onyx-rgb"\n[[pictures]]\n')
    assert run("run", "study.toml")[0] == 0
    (picture,) = (tmp_path / "out" / "study").glob("*.png")
    picture.rename(tmp_path / "elsewhere.png")
    picture.symlink_to(tmp_path / "elsewhere.png")
    assert run("run", "study.toml")[2].count("(already done)") == 2


def test_init_never_takes_the_place_of_a_file(run, starter):
    starter.write_text("mine")
    refused(run("init"), subject="study.toml")
    assert starter.read_text() == "mine"


def test_what_study_prints_is_the_starter_and_a_schema(run, starter):
    assert run("study")[1] == starter.read_text()
    schema = json.loads(run("study", "--schema")[1])
    assert schema["$schema"].endswith("2020-12/schema")


def test_a_run_into_results_of_another_study_and_a_rerun_onto_itself_are_refused(
    run, starter, tmp_path
):
    only = (*FEW, "--set", 'matrices=["kernel"]')
    assert run("run", "study.toml", *only)[0] == 0
    before = files_of(tmp_path / "out" / "study")
    refused(run("run", "study.toml", *only, "--set", "seed=1"), subject="out/study")
    refused(run("rerun", "out/study", "-o", "out/study"), subject="--out", value="out/study")
    refused(run("rerun", "study.toml", "-o", "o"), "study.toml", "chromanoise run")
    (tmp_path / "file").write_text("")
    refused(run("run", "study.toml", "-o", "file"), "file")
    assert files_of(tmp_path / "out" / "study") == before
