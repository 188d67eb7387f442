"""`init`, `run`, `rerun`, `study`: a file that anyone can run again to the same digits."""

import json

import pytest

from chromanoise.base.files import OWN_FILES
from chromanoise.noise import OperatingPoint, saturating_exposure
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import (
    Analyses,
    Outcome,
    OutputsPart,
    analyzed,
    matrix_makers,
    sensor_named,
)
from outcomes import refused

FEW = ("--set", "sweeps.0.points=3")


@pytest.fixture
def starter(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("init") == (0, "study.toml: change it, then `chromanoise run study.toml`\n", "")
    return tmp_path / "study.toml"


def files_of(folder):
    return {p.name: p.read_bytes() for p in sorted(folder.iterdir()) if p.name != OWN_FILES}


def test_the_starter_runs_as_it_is_and_again_to_the_same_bytes(run, starter, tmp_path):
    code, out, err = run("run", "study.toml", *FEW)
    assert code == 0, err
    names = ["analysis-kernel", "analysis-lmmse", "sweep-1-lux-snr-y"]
    assert out.split() == [f"out/study/{name}.json" for name in names]
    first = files_of(tmp_path / "out" / "study")
    for result in map(json.loads, first.values()):
        assert {"version", "study", "seed", "files", "hash"} <= set(result)
    assert run("run", "study.toml", *FEW)[2].count("(already done)") == 3
    for output in ("out/study", "out/study/analysis-lmmse.json"):
        code, out, err = run("rerun", output, "-o", "again")
        assert code == 0, err
        assert files_of(tmp_path / "again") == first


def test_init_never_takes_the_place_of_a_file(run, starter):
    starter.write_text("mine")
    refused(run("init"), subject="study.toml")
    assert starter.read_text() == "mine"


def test_what_study_prints_is_the_starter_and_a_schema(run, starter):
    assert run("study")[1] == starter.read_text()
    schema = json.loads(run("study", "--schema")[1])
    assert schema["$schema"].endswith("2020-12/schema")


def test_all_faults_of_a_file_are_told_at_once(run, starter):
    starter.write_text("[light]\nlevel_lux = 0\nilluminent = 'A'\n[[sensors]]\nnam = 'x'\n")
    outcome = run("run", "study.toml")
    lines = [line.removeprefix("chromanoise: study.toml:") for line in outcome[2].splitlines()]
    assert [line.partition(" ")[0] for line in lines] == ["2:", "3:", "4:", "5:"]
    keys = ["light.level_lux", "light.illuminent", "sensors.0.name", "sensors.0.nam"]
    assert [error.setting for error in outcome.errors] == keys
    refused(outcome, "illuminant", "name", setting=keys[0], value=0)


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


def numbers(result, path=""):
    """Every value of nested data by its place."""
    if isinstance(result, dict):
        for key, value in result.items():
            yield from numbers(value, f"{path}/{key}")
    elif isinstance(result, list):
        for i, value in enumerate(result):
            yield from numbers(value, f"{path}/{i}")
    else:
        yield path, result


def of_library(names, lux):
    """The same by the nouns of the library, one after the other."""
    lamp = equal_energy(DEFAULT_GRID)
    white = flat_field(lamp, level_lux=lux)
    (maker,) = matrix_makers(["lmmse"], "quanta").values()
    sensors = [sensor_named(name, DEFAULT_GRID) for name in names]
    solved = [saturating_exposure(white, one, f_number=1.8, share=0.99) for one in sensors]
    exposure = min(solved, key=lambda one: one.time_s)  # one time for all, at which none saturates
    analyses = []
    for sensor in sensors:
        used = OperatingPoint(sensor=sensor, exposure=exposure, illuminant=lamp, level_lux=lux)
        analyses.append(analyzed(white, sensor, exposure, matrix=maker(used)))
    result = Analyses(
        matrix="lmmse",
        points=tuple(one.point for one in analyses),
        outcomes=tuple(Outcome(analysis=one, asked=("budget",)) for one in analyses),
        outputs=OutputsPart(),
    )
    return json.loads(json.dumps(result.to_dict()))


def test_the_sensors_of_a_command_share_one_time_unless_they_are_saturated_alike(run):
    names = ("onyx-rgbw", "model-rgb")
    times = []
    for more in ((), ("--equal", "saturation")):
        code, out, err = run("analyze", *names, *more, "--json", "-")
        assert code == 0, err
        times.append([sensor["time_ms"] for sensor in json.loads(out)["sensors"]])
    (shared, same), own = times
    assert shared == same == min(own)
    assert len(set(own)) == 2


def test_command_line_library_and_run_give_the_same_digits(run, tmp_path):
    names = ("onyx-rgbw", "model-rgb")
    code, out, err = run(
        "analyze", *names, "--lux", 3, "--matrix", "lmmse", "--budget", "--json", "-"
    )
    assert code == 0, err
    command = dict(numbers(json.loads(out)))
    study = tmp_path / "s.toml"
    study.write_text(
        'matrices = ["lmmse"]\n[light]\nlevel_lux = 3\n'
        + "".join(f'[[sensors]]\nname = "{name}"\n' for name in names)
    )
    code, out, err = run("run", study, "-o", tmp_path / "o")
    assert code == 0, err
    data = json.loads((tmp_path / "o" / "analysis-lmmse.json").read_text())["result"]
    ran, library = dict(numbers(data)), dict(numbers(of_library(names, 3.0)))
    assert set(command) == set(ran) == set(library)
    for place, value in command.items():
        assert value == ran[place] == library[place], place
    assert sum(isinstance(value, float) for value in command.values()) > 100
