"""A filter in front of sensors, by name, of a user's folder or of a file: commands and studies."""

import numpy as np
import pytest

from chromanoise.io.spectra import Answers
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.spectra.tables import catalog_curves, catalog_tables
from chromanoise.study import (
    provenance,
    sensor_named,
    study_as_command,
    study_as_python,
    study_from_data,
    study_from_text,
    study_hash,
)
from chromanoise.study.assembly import sensor_of
from chromanoise.study.resolve_names import behind_resolved_filter, resolve_filter, word_files
from chromanoise.study.schema import SensorPart
from outcomes import refused

SOURCES = """[gray-glass]
kind = "filter"
what = "a gray glass of a test"
quantity = "transmittance"
unit = "1"
level = "absolute"
source = "made up for this test"
license = "CC0-1.0"
defects = "none"
"""
GLASS = "wavelength_nm,T\n380,0.25\n1060,0.25\n"
STUDY = '[[sensors]]\nname = "onyx-rgb"\n[[sensors]]\nname = "onyx-rgb"\nfilter = "{}"\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "SOURCES.toml").write_text(SOURCES)
    (tmp_path / "mine" / "gray-glass.csv").write_text(GLASS)
    (tmp_path / "glass.csv").write_text(GLASS.replace("0.25", "25").replace("T", "T [%]"))
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(tmp_path / "mine"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("word", ["gray-glass", "glass.csv", "./glass.csv"])
def test_a_gray_glass_of_a_quarter_takes_three_quarters_of_every_curve(folder, word):
    bare = sensor_named("onyx-rgb", DEFAULT_GRID)
    behind = behind_resolved_filter(bare, word)
    np.testing.assert_allclose(behind.qe, bare.qe / 4, rtol=1e-12)
    assert behind.name == f"onyx-rgb+{'gray-glass' if word == 'gray-glass' else 'glass'}"
    assert behind.pixel == bare.pixel
    assert any("filter" in note for note in behind.notes)


@pytest.mark.parametrize("word", ["gray-glass", "glass.csv"])
def test_behind_a_gray_glass_the_time_of_saturation_is_four_times_as_long(result_of, folder, word):
    def times(*more):
        data = result_of("analyze", "onyx-rgb", "model-rgb", *more)["sensors"]
        return [one["name"] for one in data], [one["time_ms"] for one in data]

    names, bare = times()
    behind, long = times("--filter", word)
    assert behind == [f"{name}+{word.removesuffix('.csv')}" for name in names]
    assert long == pytest.approx([4 * time for time in bare], rel=1e-9)


def test_a_measured_filter_brings_its_source_and_a_model_says_that_it_is_one():
    assert "Schott" in " ".join(
        resolve_filter("ircut-schott", answers=Answers(beyond="hold")).notes
    )
    (note,) = resolve_filter("ircut-650/20").notes
    assert "model" in note


def test_a_filter_of_a_study_has_its_own_name_enters_the_hash_and_the_files(folder):
    one, other = (study_from_text(STUDY.format(w), source="t") for w in ("ircut-650", "ircut-651"))
    assert [sensor_of(part).name for part in one.sensors] == ["onyx-rgb", "onyx-rgb+ircut-650"]
    assert study_hash(one) != study_hash(other)
    assert word_files("ircut-650", "filter") == ()
    message = study_from_text(STUDY.format("glass.csv"), source="t")
    assert list(provenance(message)["files"]) == ["glass.csv"]
    before = study_hash(message)
    (folder / "glass.csv").write_text(GLASS)
    assert study_hash(message) != before


def test_a_filter_of_a_command_is_copied_as_a_study_and_comes_back_as_the_command(run, folder):
    line = ["analyze", "onyx-rgb", "--filter", "gray-glass"]
    code, out, err = run(*line, "--copy-as", "toml")
    assert (code, err) == (0, "")
    study = study_from_text(out, source="copied")
    assert study.sensors[0].filter == "gray-glass"
    assert study_as_command(study) == f"chromanoise {' '.join(line)}"
    made = {}
    exec(compile(study_as_python(study).replace("print(", "str("), "script", "exec"), made)
    (point,) = made["result"].points
    np.testing.assert_allclose(
        point.sensor.qe, sensor_named("onyx-rgb", DEFAULT_GRID).qe / 4, rtol=1e-12
    )


@pytest.mark.parametrize(
    ("word", "parts"),
    [
        ("ircut-schot", ("'ircut-schot'", "ircut-schott")),
        ("gray-glas", ("'gray-glas'", "gray-glass")),
        ("ircut-6.5.0", ("6.5.0",)),
        ("none.csv", ("none.csv",)),
        ("two.csv", ("two.csv", "2", "A, B")),
        ("short.csv", ("short.csv", "700 nm", "--beyond")),
        ("negative.csv", ("negative.csv", "-0.5", "380 nm")),
    ],
)
def test_a_filter_that_cannot_be_is_one_sentence(run, folder, word, parts):
    (folder / "two.csv").write_text("wavelength_nm,A,B\n380,0.5,0.5\n1060,0.5,0.5\n")
    (folder / "short.csv").write_text("wavelength_nm,T\n400,0.5\n700,0.5\n")
    (folder / "negative.csv").write_text("wavelength_nm,T\n380,-0.5\n1060,0.5\n")
    refused(run("analyze", "onyx-rgb", "--filter", word), *parts, setting="sensors.0.filter")


def test_no_result_takes_the_place_of_the_file_of_a_filter(run, folder):
    refused(
        run("analyze", "onyx-rgb", "--filter", "glass.csv", "--table", "glass.csv"),
        subject="--table",
    )


# ---- shifted ----

RISING = {step: np.arange(190.0, 1300.0, step) for step in (10.0, 0.7)}  # coarse and fine tables
MODEL = "ircut-650/20"


def write_table(path, at_nm, values):
    rows = "".join(f"{w!r},{v!r}\n" for w, v in zip(at_nm.tolist(), values.tolist(), strict=True))
    path.write_text(f"wavelength_nm,T\n{rows}")


def waves(at_nm):
    return 0.5 + 0.4 * np.sin(at_nm / 37.0)


def written(folder, word, shift_nm):
    """The word of a filter, and of one that is written at wavelengths longer by the shift."""
    if word == MODEL:
        return word, f"ircut-{650 + shift_nm}/20"
    if word == "ircut-schott":
        table = catalog_curves(catalog_tables("filter")[word])
        at_nm, values = table.wavelength_nm, table.values[:, 0]
    else:
        at_nm = RISING[10.0 if word == "coarse.csv" else 0.7]
        values = waves(at_nm)
        write_table(folder / "mine" / "gray-glass.csv", at_nm, values)
        write_table(folder / word, at_nm, values)
    write_table(folder / "moved.csv", at_nm + shift_nm, values)
    return word, "moved.csv"


@pytest.mark.parametrize("shift_nm", [7.5, -12.25, 200.0, -180.0])
@pytest.mark.parametrize("word", ["coarse.csv", "fine.csv", "gray-glass", "ircut-schott", MODEL])
def test_a_shifted_filter_is_the_filter_written_at_shifted_wavelengths(folder, word, shift_nm):
    word, moved = written(folder, word, shift_nm)
    part = {"name": "onyx-rgb", "beyond": "hold"}
    shifted = sensor_of(SensorPart(**part, filter=word, shift_ircut_nm=shift_nm))
    expected = sensor_of(SensorPart(**part, filter=moved))
    np.testing.assert_allclose(shifted.qe, expected.qe, rtol=1e-12, atol=1e-14)
    unshifted = sensor_of(SensorPart(**part, filter=word))
    assert abs(unshifted.qe - expected.qe).max() > 1e-3
    assert any(f"{shift_nm:+g} nm" in note for note in shifted.notes)


@pytest.mark.parametrize(("shift_nm", "end"), [(10.0, 0), (-10.0, -1)])
def test_a_filter_that_is_shifted_off_an_end_of_the_grid_is_extrapolated_as_declared(
    run, folder, shift_nm, end
):
    at_nm = np.arange(400.0, 1051.0, 5.0)
    write_table(folder / "exact.csv", at_nm, waves(at_nm))
    words = ("analyze", "onyx-rgb", "--filter", "exact.csv", "--shift-ircut-nm", shift_nm)
    outcome = run(*words)
    refused(outcome, remedy_setting="beyond", setting="sensors.0.filter")
    assert len(outcome[2].splitlines()) == 1
    bare = sensor_named("onyx-rgb", DEFAULT_GRID).qe
    for beyond, value in (("zero", 0.0), ("hold", waves(at_nm[end]))):
        assert run(*words, "--beyond", beyond)[0] == 0
        part = SensorPart(
            name="onyx-rgb", filter="exact.csv", shift_ircut_nm=shift_nm, beyond=beyond
        )
        found = sensor_of(part).qe[end] / bare[end]
        np.testing.assert_allclose(found, value, rtol=1e-12)


@pytest.mark.parametrize(
    ("at_nm", "shift_nm", "fits"),
    [(380.0, 0.0, True), (380.0, 40.0, False), (420.0, 0.0, False), (420.0, -40.0, True)],
)
def test_a_shifted_filter_is_checked_where_it_is_used(run, folder, at_nm, shift_nm, fits):
    table = RISING[10.0]
    write_table(folder / "bad.csv", table, np.where(table == at_nm, -0.5, 0.5))
    words = ("analyze", "onyx-rgb", "--filter", "bad.csv")
    outcome = run(*words, *(("--shift-ircut-nm", shift_nm) if shift_nm else ()))
    if fits:
        assert outcome[0] == 0, outcome[2]
    else:  # the wavelength of the file
        refused(outcome, f"{at_nm:g} nm", value=-0.5, setting="sensors.0.filter")


def test_a_shift_of_zero_changes_neither_the_curves_nor_the_hash(folder):
    plain, zero = (
        study_from_data({"sensors": [{"name": "onyx-rgb", "filter": MODEL} | more]}, source="")
        for more in ({}, {"shift_ircut_nm": 0.0})
    )
    assert study_hash(plain) == study_hash(zero)
    np.testing.assert_array_equal(sensor_of(plain.sensors[0]).qe, sensor_of(zero.sensors[0]).qe)
