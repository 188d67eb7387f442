"""``chromanoise catalog``, and a user's own folder of entries beside the built-in ones."""

import json
import re

import numpy as np
import pytest

from chromanoise.base.errors import InputError
from chromanoise.io.spectra import Answers
from chromanoise.spectra import DEFAULT_GRID, photon_irradiance
from chromanoise.study import provenance, study_from_text
from chromanoise.study.catalog import KINDS, catalog_entries, catalog_file_of
from chromanoise.study.resolve_names import resolve_illuminant, resolve_sensor, word_files
from outcomes import refused

SECTION = """[{name}]
kind = "{kind}"
what = "{name} of a test"
quantity = "{quantity}"
unit = "1"
level = "absolute"
source = "made up for this test"
license = "CC0-1.0"
defects = "none"
"""
SENSOR = SECTION.format(name="my-camera", kind="sensor", quantity="QE") + (
    'mosaic = "bayer"\npixel = { pitch_um = 2.5, source = "this test" }\n'
)
RESPONSE = SECTION.format(name="my-camera", kind="sensor", quantity="response").replace(
    'unit = "1"', 'unit = "V/(lx s)"'
)
LAMP = SECTION.format(name="my-lamp", kind="illuminant", quantity="power") + 'per = "photon"\n'
CAMERA_CSV = "wavelength_nm,R,G,B\n400,0.1,0.1,0.5\n700,0.6,0.2,0.1\n1050,0.1,0.1,0.1\n"
LAMP_CSV = "wavelength_nm,lamp\n380,1\n1060,1\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with one sensor and one lamp, named by the environment."""
    (tmp_path / "SOURCES.toml").write_text(SENSOR + LAMP)
    (tmp_path / "my-camera.csv").write_text(CAMERA_CSV)
    (tmp_path / "my-lamp.csv").write_text(LAMP_CSV)
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(tmp_path))
    return tmp_path


@pytest.fixture(autouse=True)
def _nothing_of_the_tester(request, monkeypatch):
    if "folder" not in request.fixturenames:
        monkeypatch.delenv("CHROMANOISE_CATALOG", raising=False)


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_is_printed_within_100_columns_and_as_json_with_every_entry(result_of, run, kind):
    code, out, err = run("catalog", kind)
    assert (code, err) == (0, "")
    assert max(len(line) for line in out.splitlines()) <= 100
    data = result_of("catalog", kind)["entries"]
    assert [entry["name"] for entry in data] == [
        entry.provenance.name for entry in catalog_entries(kind)
    ]
    for entry in data:
        assert all(entry[key] for key in ("source", "license", "what", "quantity", "defects"))


def test_all_of_one_entry_is_told_with_what_was_found_in_it(run):
    code, out, err = run("catalog", "mt9v024-rgbw")
    assert (code, err) == (0, "")
    for part in (
        "380-1080",
        "QE [e-/photon], absolute, light counted in photons",
        "MT9V024/D",
        "MIT",
        "pitch_um 6",
        "G exceeds W by 5-15 %",
        "green exceeds white by up to 15 % at 530-560 nm",
    ):
        assert part in out


def test_the_page_in_the_docs_is_what_the_command_writes(run, request):
    page = request.config.rootpath / "docs" / "catalog.md"
    code, out, err = run("catalog", "--markdown", "-")
    assert (code, err) == (0, "")
    assert out == page.read_text(encoding="utf-8")


def test_json_and_markdown_go_to_files_whole(run, tmp_path):
    goal, page = tmp_path / "out.json", tmp_path / "out.md"
    code, out, _ = run("catalog", "filters", "--json", goal, "--markdown", page)
    assert code == 0
    assert "ircut-schott" in out
    assert len(json.loads(goal.read_text())["entries"]) == 4
    assert page.read_text().startswith("# The catalog")


def test_devices_answer_through_every_command_and_ask_through_its_options(run):
    code, out, err = run("analyze", "mt9v024-rgbw", "--illuminant", "A+0.5xLED850")
    assert (code, err) == (0, "")
    assert "G exceeds W" in out
    (note,) = re.findall(r"full well and read noise of mt9v024-rgbw [^.;]*", " ".join(out.split()))
    assert re.findall(r"\d+(?= e-)", note) == ["10000", "10"]
    code, out, err = run(
        "analyze",
        "nikon-d5100-npl",
        "--energy",
        "--peak-qe",
        "0.5",
        "--beyond",
        "zero",
        "--json",
        "-",
    )
    assert (code, err) == (0, "")
    assert "NaN" not in out
    assert all(c["snr_db"] > 20 for c in json.loads(out)["sensors"][0]["channels"])


def test_a_users_sensor_and_lamp_stand_beside_the_built_in_ones(result_of, run, folder):
    entries = result_of("catalog", "sensors")["entries"]
    entry = next(one for one in entries if one["name"] == "my-camera")
    assert entry["file"] == str(folder / "my-camera.csv")
    assert (entry["start_nm"], entry["stop_nm"]) == (400.0, 1050.0)
    code, out, err = run("analyze", "my-camera", "--illuminant", "my-lamp+0.5xLED850")
    assert (code, err) == (0, "")
    (note,) = re.findall(
        r"\S* ?full well and read noise of my-camera [^.;]*", " ".join(out.split())
    )
    assert re.findall(r"\d+(?= e-)", note) == ["10000", "10"]  # the paper's pixel
    assert "pitch" not in note
    assert "my-camera: none" not in out  # no known defect is nothing to tell


def test_a_users_sensor_has_its_own_pixel_mosaic_and_curves(folder):
    sensor = resolve_sensor("my-camera", full_well_e=5000.0)
    assert (sensor.pixel.pitch_um, sensor.pixel.full_well_e) == (2.5, 5000.0)
    assert set(sensor.mosaic.names) == {"R", "G", "B"}
    # halfway from 0.1 to 0.6 at 550 nm
    assert sensor.qe[DEFAULT_GRID.wavelength_nm == 550, 0] == pytest.approx(0.35)
    (note,) = [note for note in sensor.notes if "read noise" in note]
    assert "10 e-" in note
    assert "full well" not in note


def test_a_users_lamp_that_counts_photons_is_flat_in_photons(folder):
    photons = photon_irradiance(resolve_illuminant("my-lamp"))
    # 2 points, 380 and 1060 nm: in the middle, straight lines of power would be 25 % too high
    assert photons == pytest.approx(photons[0], rel=1e-4)


def test_a_file_of_photons_rises_straight_between_its_two_points(tmp_path):
    (tmp_path / "rising.csv").write_text("wavelength_nm,photons\n380,380\n1060,1060\n")
    answers = Answers(quantity="power", per="photon")
    lamp = resolve_illuminant(str(tmp_path / "rising.csv"), answers=answers)
    # photons in proportion to the wavelength: the same power everywhere
    assert lamp.irradiance == pytest.approx(lamp.irradiance[0], rel=1e-4)
    assert any("photons" in note for note in lamp.notes)


def test_the_files_of_a_word_are_told_so_that_a_run_can_hold_them(folder, monkeypatch):
    table, sources = folder / "my-camera.csv", folder / "SOURCES.toml"
    assert catalog_file_of("my-camera") == table
    assert word_files("my-camera", "sensor") == (table, sources)
    lamp = folder / "my-lamp.csv"
    assert catalog_file_of("my-lamp+1xLED940") == lamp
    assert word_files("my-lamp+1xLED940", "light") == (lamp, sources)
    assert [str(p) for p in word_files("lamp.csv+1xLED940/50", "light")] == ["lamp.csv"]
    assert [str(p) for p in word_files("curves.csv", "sensor")] == ["curves.csv"]
    for word in ("onyx-rgbw", "mt9v024-rgbw"):
        assert word_files(word, "sensor") == ()
    for word in ("E", "A+0.5xLED850"):
        assert word_files(word, "light") == ()
    monkeypatch.chdir(folder)
    (folder / "E").write_text("not a lamp")
    assert word_files("E", "light") == ()


def test_a_lamp_of_a_file_can_have_a_diode_beside_it(folder):
    word = f"{folder / 'my-lamp.csv'}+1xLED850"
    answers = Answers(quantity="power", per="energy")
    lit = resolve_illuminant(word, answers=answers)
    bare = resolve_illuminant(str(folder / "my-lamp.csv"), answers=answers)
    at = DEFAULT_GRID.wavelength_nm < 700
    np.testing.assert_allclose(
        lit.irradiance[at] / bare.irradiance[at], (lit.irradiance / bare.irradiance)[0], rtol=1e-9
    )
    assert lit.irradiance.sum() == pytest.approx(2 * bare.irradiance.sum(), rel=1e-3)


def test_a_word_of_another_kind_is_refused(folder, run):
    lamp = run("analyze", "my-lamp")
    refused(lamp, "my-lamp", "illuminant", "sensor", setting="sensors.0.name")
    refused(run("analyze", "my-camra"), "my-camera", setting="sensors.0.name")


@pytest.mark.parametrize(
    ("sources", "files", "parts"),
    [
        (SENSOR, {}, ["SOURCES.toml", "my-camera", "my-camera.csv"]),
        ("", {"stray.csv": LAMP_CSV}, ["stray.csv", "[stray]"]),
        (SENSOR.replace('source = "made up for this test"\n', ""), {}, ["my-camera", "source"]),
        (SENSOR.replace('license = "CC0-1.0"', 'license = " "'), {}, ["my-camera", "license"]),
        (SENSOR.replace("license", "licence"), {}, ["'licence'", "license"]),
        (SENSOR.replace('"absolute"', '"abs"'), {}, ["level", "my-camera", "'abs'", "absolute"]),
        (SENSOR.replace("my-camera", "onyx-rgbw"), {"onyx-rgbw.csv": CAMERA_CSV}, ["onyx-rgbw"]),
        (LAMP.replace("my-lamp", "D65"), {"D65.csv": LAMP_CSV}, ["D65.csv"]),
        (LAMP.replace("my-lamp", "3200K"), {"3200K.csv": LAMP_CSV}, ["3200K.csv"]),
        (
            LAMP.replace('per = "photon"', ""),
            {"my-lamp.csv": LAMP_CSV},
            ["my-lamp", "per", "energy", "photon"],
        ),
        (SENSOR.replace("[my-camera]", '["../my-camera"]'), {}, ["../my-camera"]),
        (SENSOR.replace("[my-camera]", '["/etc/passwd"]'), {}, ["/etc/passwd"]),
        (SENSOR.replace("[my-camera]", '["a.b"]'), {}, ["a.b"]),
        (SENSOR.replace('kind = "sensor"', 'kind = "scene"'), {}, ["kind", "'scene'"]),
        ("[my-camera\nkind=1", {}, ["SOURCES.toml", "line 1"]),
        ("a = 1\n" + SENSOR, {}, ["SOURCES.toml", "a"]),
        (SENSOR.replace("2.5", '"2.5"'), {}, ["my-camera", "pitch_um", "'2.5'"]),
        (SENSOR.replace("2.5", "-2.5"), {"my-camera.csv": CAMERA_CSV}, ["pitch_um", "-2.5"]),
        (SENSOR.replace(', source = "this test"', ""), {}, ["my-camera", "pixel", "source"]),
        (SENSOR.replace("bayer", "RG/G"), {"my-camera.csv": CAMERA_CSV}, ["mosaic", "row 1"]),
        (SENSOR.replace('"bayer"', "3"), {}, ["my-camera", "mosaic", "3"]),
        (SENSOR + 'per = "energy"\n', {}, ["my-camera", "QE", "energy"]),
        (RESPONSE + 'per = "energy"\n', {}, ["my-camera", "A/W", "V/(lx s)"]),
        (RESPONSE.replace("V/(lx s)", "A/W") + 'per = "photon"\n', {}, ["my-camera", "A/W"]),
        (RESPONSE.replace("V/(lx s)", "e-/photon") + 'per = "energy"\n', {}, ["e-/photon"]),
        (SENSOR, {"my-camera.csv": CAMERA_CSV.replace("0.6", "x")}, ["line 3", "R", "'x'"]),
        (SENSOR, {"my-camera.csv": CAMERA_CSV.replace("0.6", "1.6")}, ["my-camera", "1.6", "R"]),
        (SENSOR, {"my-camera.csv": CAMERA_CSV.replace("R,G", "X,G")}, ["my-camera", "'R'", "X, G"]),
        ("x = " + "[" * 5000, {}, ["SOURCES.toml"]),
    ],
)
def test_a_fault_of_the_users_folder_is_one_sentence_with_its_file(
    run, tmp_path, monkeypatch, sources, files, parts
):
    (tmp_path / "SOURCES.toml").write_text(sources)
    for name, content in files.items():
        (tmp_path / name).write_text(content)
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(tmp_path))
    refused(run("analyze", "my-camera"), *parts)


def test_a_fault_of_the_folder_is_told_even_where_a_built_in_name_is_asked_for(
    run, tmp_path, monkeypatch
):
    (tmp_path / "stray.csv").write_text(LAMP_CSV)
    (tmp_path / "SOURCES.toml").write_text("")
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(tmp_path))
    refused(run("analyze", "onyx-rgbw"), "stray.csv")
    refused(run("catalog"), "stray.csv")


def test_a_table_that_leads_out_of_its_folder_is_refused(tmp_path, monkeypatch):
    inside, outside = tmp_path / "inside", tmp_path / "outside.csv"
    inside.mkdir()
    outside.write_text(CAMERA_CSV)
    (inside / "my-camera.csv").symlink_to(outside)
    (inside / "SOURCES.toml").write_text(SENSOR)
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(inside))
    with pytest.raises(InputError, match="my-camera"):
        resolve_sensor("my-camera")


def test_a_folder_without_sources_or_in_another_encoding_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(tmp_path))
    with pytest.raises(InputError, match=r"SOURCES\.toml"):
        resolve_sensor("onyx-rgbw")
    (tmp_path / "SOURCES.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"SOURCES\.toml"):
        resolve_sensor("onyx-rgbw")


def test_the_option_takes_the_place_of_the_environment(run, folder, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    (other / "SOURCES.toml").write_text(LAMP)
    (other / "my-lamp.csv").write_text(LAMP_CSV)
    code, out, err = run("catalog", "my-lamp", "--folder", other)
    assert (code, err) == (0, "")
    assert str(other / "my-lamp.csv") in out
    refused(run("catalog", "my-camera", "--folder", other), value="my-camera")


def test_a_response_in_amperes_per_watt_is_the_qe_that_it_stands_for(tmp_path, monkeypatch):
    section = RESPONSE.replace("V/(lx s)", "A/W") + 'per = "energy"\n'
    (tmp_path / "SOURCES.toml").write_text(section)
    # S = e lambda / (h c) is 0.8066 A/W at 1000 nm where every photon gives an electron
    (tmp_path / "my-camera.csv").write_text(
        "wavelength_nm,W\n400,0.161311\n500,0.201639\n1050,0.423442\n"
    )
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(tmp_path))
    assert resolve_sensor("my-camera").qe == pytest.approx(0.5, rel=1e-5)


def test_the_same_folder_elsewhere_gives_the_same_hash(folder, tmp_path_factory, monkeypatch):
    study = study_from_text(
        '[light]\nilluminant = "my-lamp"\n[[sensors]]\nname = "my-camera"', source="text"
    )
    here = provenance(study)
    assert set(here["files"]) == {f"catalog://{p.name}" for p in folder.iterdir()}
    other = tmp_path_factory.mktemp("elsewhere")
    for path in folder.iterdir():
        (other / path.name).write_bytes(path.read_bytes())
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(other))
    assert provenance(study) == here
    (other / "my-lamp.csv").write_text(LAMP_CSV.replace("380,1", "380,2"))
    assert provenance(study)["hash"] != here["hash"]


@pytest.mark.parametrize(
    ("command", "words"),
    [("analyze", ("halogen", "led-white", "A+0.5xLED850", "catalog illuminants"))],
)
def test_the_help_names_the_lights_of_the_catalog(run, command, words):
    result = " ".join(run(command, "--help")[1].split()).replace("- ", "-")  # at a line break
    for word in words:
        assert word in result


def test_the_home_of_the_user_is_found_in_names_of_files(folder, monkeypatch):
    monkeypatch.setenv("HOME", str(folder))
    assert word_files("~/my-camera.csv", "sensor") == (folder / "my-camera.csv",)
    sensor = resolve_sensor("~/my-camera.csv", answers=Answers(quantity="QE"))
    assert sensor.name == "my-camera"
    lit = resolve_illuminant("~/my-lamp.csv", answers=Answers(quantity="power", per="photon"))
    assert lit.name == "my-lamp"
