"""``chromanoise inspect``, and files of spectra as sensors and lights of the other commands."""

import json

import pytest

from chromanoise.io.spectra import read_curves
from outcomes import refused
from spectrum_samples import AT_NM, GREEN, RED, SAMPLES


@pytest.fixture
def sample(tmp_path):
    def write(name, content=None):
        path = tmp_path / name
        path.write_bytes(SAMPLES[name] if content is None else content.encode())
        return path

    return write


@pytest.mark.parametrize("name", SAMPLES)
def test_the_preview_of_every_format_names_its_facts_and_asks(run, sample, name):
    path = sample(name)
    code, out, err = run("inspect", path)
    assert (code, err) == (0, "")
    for part in (str(path), "format", "400-700 nm, step 100 nm", "quantity", "scale", "gaps"):
        assert part in out
    assert "DEFECT" not in out
    assert "--beyond" in out
    assert "400-1050 nm" in out


def test_the_preview_names_delimiter_decimal_unit_and_what_was_done(run, sample):
    _, out, _ = run("inspect", sample("german.csv"))
    for part in ("semicolon", "decimal ,", " um", "percent", "0.01"):
        assert part in out
    _, out, _ = run("inspect", sample("digitized.csv"))
    assert "digitized" in out


def test_json_of_the_preview_has_the_curves_to_the_last_digit(result_of, sample):
    data = result_of("inspect", sample("bench.csv"))
    assert data["wavelength_nm"] == AT_NM.tolist()
    assert data["values"] == {"R": RED.tolist(), "G": GREEN.tolist()}
    assert data["delimiter"] == "comma"
    assert {q["about"] for q in data["questions"]} >= {"quantity", "level", "beyond"}


def test_answers_on_the_command_line_are_no_longer_asked(result_of, sample):
    answers = ("--quantity", "response", "--relative", "--energy", "--beyond", "zero", "--nm",
               "--peak-qe", 0.5)  # fmt: skip
    data = result_of("inspect", sample("bench.csv"), *answers, "--column", "G")
    assert data["questions"] == []
    assert (data["level"], data["per"], data["names"]) == ("relative", "energy", ["G"])


def test_questions_and_defects_are_no_failure_but_a_file_of_nothing_is(run, sample, tmp_path):
    assert run("inspect", sample("bench.csv"))[0] == 0
    refused(run("inspect", sample("words.txt", "no numbers here\n")), "words.txt")
    refused(run("inspect", tmp_path / "none.mat"), "none.mat")


WIDE = "wavelength_nm,R,G\n400,.05,.1\n550,.1,{green}\n650,.4,.1\n1050,.05,.05\n"


def test_any_format_is_a_sensor_of_the_other_commands(result_of, tmp_path):
    from scipy.io import savemat

    text = tmp_path / "toy.tsv"
    text.write_text(WIDE.format(green=".5").replace(",", "\t"))
    curves = read_curves(text).curves
    matlab = tmp_path / "toy.mat"
    savemat(matlab, {"wavelength": curves.wavelength_nm, "data": curves.values})
    snr = []
    for path in (text, matlab):
        said = () if path == text else ("--absolute", "--photons")
        (sensor,) = result_of("analyze", path, "--time-ms", 10, *said)["sensors"]
        snr.append([c["mean_e"] for c in sensor["channels"]])
    assert snr[0] == snr[1]


def test_a_relative_sensor_is_refused_until_its_peak_is_told(result_of, run, tmp_path):
    path = tmp_path / "relative.csv"
    path.write_text(WIDE.format(green="1.0"))
    refused(run("analyze", path), "relative.csv", "--peak-qe", setting="sensors.0.name")
    half = result_of("analyze", path, "--peak-qe", 0.5, "--time-ms", 10)["sensors"][0]
    assert any("highest QE of 0.5" in note for note in half["notes"])
    whole = result_of("analyze", path, "--absolute", "--time-ms", 10)["sensors"][0]
    for one, two in zip(half["channels"], whole["channels"], strict=True):
        assert two["mean_e"] == pytest.approx(2 * one["mean_e"], rel=1e-12)


def test_a_light_from_a_file_asks_how_it_counts_and_which_curve_it_is(run, tmp_path):
    path = tmp_path / "lamp.csv"
    path.write_text("nm;one;two\n360;1;2\n1050;1;2\n")
    light = ("analyze", "onyx-rgbw", "--time-ms", 10, "--json", "-", "--illuminant", path)
    refused(run(*light), "lamp.csv", "--illuminant-column", setting="light.illuminant")
    one = (*light, "--illuminant-column", "two")
    parts = ("lamp.csv", "--illuminant-energy", "--illuminant-photons")
    refused(run(*one), *parts, setting="light.illuminant")
    code, out, _ = run(*one, "--illuminant-energy")
    assert code == 0
    _, equal, _ = run(*light[:-2], "--illuminant", "E")
    data, known = (json.loads(text)["sensors"][0]["channels"] for text in (out, equal))
    assert [c["mean_e"] for c in data] == pytest.approx([c["mean_e"] for c in known], rel=1e-9)
    code, photons, _ = run(*one, "--illuminant-photons")
    assert code == 0
    assert photons != out


def test_a_preview_never_takes_the_place_of_its_file(run, sample):
    path = sample("bench.csv")
    before = path.read_bytes()
    refused(run("inspect", path, "--json", path), subject="--json", value=str(path))
    assert path.read_bytes() == before


def test_a_sensor_that_was_converted_is_told_by_what_it_holds(result_of, run, tmp_path):
    path = tmp_path / "mine.json"
    assert run("convert", "onyx-rgbw", path)[0] == 0
    code, out, err = run("inspect", path)
    assert (code, err) == (0, "")
    for part in ("own JSON, a sensor", "4: R, G, B, W", "400-1050 nm, step 5 nm", "10000 e- full"):
        assert part in out
    assert "reconstruction" in out
    data = result_of("inspect", path)
    assert data["pixel"]["full_well_e"] == 10_000
    refused(run("inspect", path, "--percent"), "--percent")


def test_spectra_that_were_converted_are_told_by_what_they_hold(run, sample, tmp_path):
    path = tmp_path / "curves.json"
    assert run("convert", sample("bench.csv"), path)[0] == 0
    code, out, _ = run("inspect", path)
    assert code == 0
    for part in ("own JSON, spectra", "2: R, G", "400-700 nm, step 100 nm"):
        assert part in out
