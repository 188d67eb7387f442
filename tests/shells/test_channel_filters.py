"""A filter or IR-cut on single channels."""

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import study_from_data, study_from_text
from chromanoise.study.assembly import sensor_of
from chromanoise.study.function_settings import study_as_command
from chromanoise.study.hashes import study_hash
from chromanoise.study.resolve_names import resolve_filter, resolve_sensor
from outcomes import refused, refused_input


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with a filter that transmits one half."""
    monkeypatch.chdir(tmp_path)
    rows = "".join(f"{nm:g},0.5\n" for nm in DEFAULT_GRID.wavelength_nm)
    (tmp_path / "half.csv").write_text("wavelength_nm,half\n" + rows)
    return tmp_path


def study_with(**part):
    return study_from_data({"sensors": [{"name": "onyx-rgbw"} | part]}, source="")


def test_only_the_channels_named_are_behind_their_filters(here):
    bare = resolve_sensor("onyx-rgbw")
    filters = {"R": "ircut-650", "W": "half.csv"}
    sensor = sensor_of(study_with(channel_filters=filters).sensors[0])
    cut = resolve_filter("ircut-650").values[:, 0]
    wanted = bare.qe * np.stack([cut, np.ones_like(cut), np.ones_like(cut), 0.5 + 0 * cut], axis=1)
    np.testing.assert_allclose(sensor.qe, wanted, rtol=1e-12)
    assert any("R behind the filter ircut-650" in note for note in sensor.notes)


def test_a_filter_on_every_channel_is_the_filter_of_the_sensor(here):
    one = sensor_of(study_with(filter="ircut-650").sensors[0])
    each = sensor_of(study_with(channel_filters=dict.fromkeys("RGBW", "ircut-650")).sensors[0])
    np.testing.assert_array_equal(one.qe, each.qe)


def test_python_and_the_command_line_take_the_same_filters(run, here):
    code, toml, err = run(
        "analyze", "model-rgb", "--channel-filter", "R=ircut-650", "--channel-filter",
        "G=half.csv", "--copy-as", "toml",
    )  # fmt: skip
    assert code == 0, err
    wanted = {"R": "ircut-650", "G": "half.csv"}
    assert study_from_text(toml, source="").sensors[0].channel_filters == wanted
    result = cn.analyze("model-rgb", time_ms=1.0, channel_filters=wanted | {"G": here / "half.csv"})
    plain = cn.analyze("model-rgb", time_ms=1.0)
    ours, theirs = (one.to_dict()["sensors"][0]["channels"] for one in (result, plain))
    assert ours[1]["mean_e"] == pytest.approx(0.5 * theirs[1]["mean_e"])
    assert ours[2]["mean_e"] == theirs[2]["mean_e"]


def test_a_study_with_channel_filters_is_copied_as_a_command():
    study = study_from_data(
        {"sensors": [{"name": "model-rgb", "channel_filters": {"R": "ircut-650"}}]}, source=""
    )
    assert "--channel-filter R=ircut-650" in study_as_command(study)


@pytest.mark.parametrize("part", [{"filter": "red.csv"}, {"channel_filters": {"B": "red.csv"}}])
def test_a_filter_that_makes_a_channel_blind_is_refused_by_its_own_key(here, part):
    rows = [(nm, qe) for nm, qe in zip((400, 500, 600, 700, 1050), (0.4, 0, 0, 0, 0), strict=True)]
    (here / "blue.csv").write_text(
        "wavelength_nm,B,W\n" + "".join(f"{nm},{qe},0.5\n" for nm, qe in rows)
    )
    (here / "red.csv").write_text("wavelength_nm,T\n400,0\n599,0\n600,1\n1050,1\n")
    (key,) = part
    found = "leaves channel B of blue a QE of 0 at every wavelength"
    with refused_input(subject="filter", value="red", found=found) as caught:
        sensor_of(study_with(name="blue.csv", **part).sensors[0])
    assert caught.value.setting == f"sensors.0.{key}"


def test_the_hash_depends_on_the_content_of_the_file_of_a_channel(here):
    study = study_with(channel_filters={"W": "half.csv"})
    before = study_hash(study)
    (here / "half.csv").write_text((here / "half.csv").read_text() + "\n")
    assert study_hash(study) != before


@pytest.mark.parametrize(
    "given", ["Q=ircut-650", "R=no-such-filter", "R=missing.csv", "R", "=ircut-650", "R="]
)
def test_a_filter_of_a_channel_that_is_none_is_refused(run, here, given):
    parts = ["--channel-filter"] if "Q" in given else []
    refused(run("analyze", "model-rgb", "--channel-filter", given), *parts)


def test_a_channel_has_one_filter(run):
    asked = ("--channel-filter", "R=ircut-650", "--channel-filter", "R=ircut-700")
    refused(run("analyze", "model-rgb", *asked), "--channel-filter", "R")


def test_an_unknown_channel_is_refused_with_its_key():
    with refused_input(subject="channel_filters", value="Q"):
        cn.analyze("model-rgb", channel_filters={"Q": "ircut-650"})
