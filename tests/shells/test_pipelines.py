"""Exit codes and sentences of ``--fail-if``, ``diff`` and ``schema``."""

import json
from pathlib import Path

import pytest

import chromanoise as cn
from chromanoise.base import described_keys
from chromanoise.study import RESULT_KINDS, names_of_entries
from dear import dear

PAIR = ("analyze", "onyx-rgbw", "onyx-rgb")
LOW_DB, HIGH_DB = sorted(cn.analyze(*PAIR[1:]).color_snr_db()[name]["Y"] for name in PAIR[1:])
BETWEEN = f"{(LOW_DB + HIGH_DB) / 2:.6f}"
SWEPT = ("compare", "onyx-rgb", "--points", "3", "--sweep", "lux=1:10")
DARK_DB = float(cn.compare("onyx-rgb", points=3, first=1, last=10).curves[0].value.min())


@pytest.mark.parametrize(
    ("words", "condition", "parts"),
    [
        (PAIR, f"snr_y_db < {BETWEEN}", ("onyx-rgbw: snr_y_db is ", f"fail below {BETWEEN}")),
        (PAIR, f"color.snr_db.Y<={LOW_DB!r}", ("onyx-rgbw", "at or below")),
        (PAIR, f"sensors.color.snr_db.y > {BETWEEN}", ("onyx-rgb: ", "above")),
        (PAIR, "sensors.rank == 4", ("onyx-rgbw: sensors.rank is 4",)),
        (PAIR, "channels.snr-db > 39", ("channels.W.snr_db",)),
        *dear(((*PAIR, "--chart"), f"snr_y_db < {BETWEEN}", ("onyx-rgbw: snr_y_db is ",))),
        ((*PAIR, "--time-ms", "100"), "snr_y_db < 0", ("snr_y_db is not defined", "cannot be")),
        (("matrix", "onyx-rgb"), "snr_y_db < 99", ("onyx-rgb: snr_y_db is ",)),
        (SWEPT, f"snr_y_db < {DARK_DB + 1e-6}", ("onyx-rgb: snr_y_db at lux 1 is",)),
        ((*SWEPT, "--and", "prnu=0:0.1:2"), "snr-y < 99", ("at prnu 0.1, lux 1 is",)),
    ],
)
def test_a_condition_that_holds_exits_with_3_and_names_the_sensor(run, words, condition, parts):
    code, out, err = run(*words, "--fail-if", condition)
    assert (code, err.count("\n"), err.startswith("chromanoise: ")) == (3, 1, True), err
    assert out == run(*words)[1]
    assert all(part in err for part in parts), err


@pytest.mark.parametrize(
    ("words", "condition"),
    [
        (PAIR, f"snr_y_db < {LOW_DB!r}"),
        (PAIR, f"snr_y_db > {HIGH_DB!r}"),
        (PAIR, "channels.saturated == 1"),
        (SWEPT, f"snr_y_db < {DARK_DB!r}"),
    ],
)
def test_a_condition_that_holds_for_no_sensor_changes_nothing(run, words, condition):
    assert run(*words, "--fail-if", condition) == run(*words)


def test_json_is_written_before_a_condition_fails_and_one_sentence_is_printed_for_each(here, run):
    code, out, err = run(
        *PAIR, "--json", "a.json", "--fail-if", "condition > 1", "--fail-if", "sensors.rank > 1"
    )
    assert (code, err.count("\n")) == (3, 2)
    assert json.loads(Path("a.json").read_text())["sensors"]
    assert out


SNR_Y = "analysis-kernel.sensors.onyx-rgb.color.snr_db.Y"
STUDY = """matrices = ["kernel", "lmmse"]
exposure = {time_ms = 5}
[[sensors]]
name = "onyx-rgb"
[[sweeps]]
vary = "lux"
first = 0.01
last = 1
points = 2
"""


@pytest.fixture
def ran(here, run):
    """Folders of three runs, the last with another light."""
    Path("study.toml").write_text(STUDY)
    for out, *more in (("one",), ("same",), ("other", "--set", "light.level_lux=3")):
        assert run("run", "study.toml", "-o", out, *more)[0] == 0


def test_a_run_is_judged_in_every_step_whose_numbers_are_of_the_sensors(ran, run):
    code, _, err = run("run", "study.toml", "-o", "one", "--fail-if", "snr_y_db < 5")
    assert (code, "asks" in err) == (0, False)  # the sweep goes below, the sensors do not
    code, _, err = run("run", "study.toml", "-o", "one", "--fail-if", "snr_y_db < 99")
    assert code == 3
    assert all(f"onyx-rgb in analysis-{name}: snr_y_db" in err for name in ("kernel", "lmmse"))
    assert run("run", "study.toml", "-o", "one", "--fail-if", "curves.value < 5")[0] == 3


def test_equal_outputs_exit_with_0(ran, run):
    assert run("diff", "one", "same") == (0, "The results are equal.\n", "")


def altered(name, change):
    """Change the record of each file of a run."""
    for file in Path(name).glob("*.json"):
        record = json.loads(file.read_text())
        change(record)
        file.write_text(json.dumps(record))


def test_another_version_machine_or_rounding_is_named_and_equal(ran, run):
    def change(record):
        record["version"] = "9.9"
        record["numerics"]["numpy"] = "9.9"
        if record.get("step") == "analysis-kernel":
            record["result"]["sensors"][0]["condition"] *= 1 + 1e-12

    altered("same", change)
    code, out, _ = run("diff", "one", "same")
    assert code == 0
    assert "and 9.9." in out
    assert "numpy" in out
    assert "equal up to rounding, 1.0e-12" in out


def test_settings_inputs_numbers_and_keys_that_differ_are_listed_by_size(ran, run):
    def change(record):
        record["files"] = {"lamp.csv": "new"}
        if record.get("step") == "analysis-kernel":
            record["result"]["sensors"][0] |= {"later": {"key": 1.0, "more": 2}}

    altered("other", change)
    code, out, err = run("diff", "one", "other", "--json", "-")
    found = json.loads(out)
    assert (code, err, found["equal"]) == (1, "", False)
    assert found["settings"][0] | {"key": "light.level_lux"} == found["settings"][0]
    assert (found["settings"][0]["first"], found["settings"][0]["second"]) == (10.0, 3.0)
    assert found["inputs"][0]["key"] == "lamp.csv"
    assert found["only_second"] == ["analysis-kernel.sensors.onyx-rgb.later"]
    sizes = [one["relative"] for one in found["numbers"]]
    assert sizes == sorted(sizes, reverse=True)
    (snr,) = (one for one in found["numbers"] if one["key"] == SNR_Y)
    assert snr["difference"] == snr["second"] - snr["first"]
    code, out, _ = run("diff", "one", "other")
    assert code == 1
    assert "Setting light.level_lux is 10.0 in the first output and 3.0 in the second." in out
    assert "Input lamp.csv is of the second output only." in out


def test_files_of_json_are_compared_and_the_order_of_sensors_is_none(here, run):
    run(*PAIR, "--json", "a.json")
    run("analyze", *reversed(PAIR[1:]), "--json", "b.json")
    assert run("diff", "a.json", "b.json")[0] == 0
    run(*PAIR, "--prnu", "0.01", "--json", "b.json")
    assert run("diff", "a.json", "b.json")[0] == 1


@pytest.mark.parametrize("name", RESULT_KINDS)
def test_every_key_is_described_in_its_schema(run, name):
    code, out, _ = run("schema", name)
    keys = described_keys(json.loads(out))
    assert code == 0
    assert len(keys) > 20
    assert [one.name for one in keys if not one.text] == []


def test_entries_of_one_name_are_told_apart():
    assert names_of_entries([{"name": "a", "matrix": "k"}, {"name": "a", "matrix": "l"}]) == [
        "a (k)", "a (l)",
    ]  # fmt: skip
