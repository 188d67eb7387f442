"""A study's faults at once, each at its line; results that no longer fit say which file and why."""

import json
import re

import pytest

from chromanoise.io.spectra import read_curves
from chromanoise.study.pixel_files import read_pixel_source
from outcomes import refused

CAMERA = "wavelength_nm,R\n400,0.1\n1050,{end}\n"
pytestmark = pytest.mark.usefixtures("here")


def shed_in(folder, more=""):
    """A folder of one's own with the sensor ``shed``."""
    (folder / "shed.csv").write_text(CAMERA.format(end=0.3))
    (folder / "SOURCES.toml").write_text(
        '[shed]\nkind = "sensor"\nwhat = "a camera"\nquantity = "QE"\nunit = "e-/photon"\n'
        'level = "absolute"\nsource = "a bench"\nlicense = "CC0"\ndefects = "none known"\n' + more
    )


@pytest.fixture
def made(run, here):
    (here / "cam.csv").write_text(CAMERA.format(end=0.3))
    (here / "s.toml").write_text('[[sensors]]\nname = "cam.csv"\n[outputs]\nbudget = false\n')
    assert run("run", "s.toml", "--out", "out")[0] == 0
    return here


WRONG = """\
[[sensors]]
name = "onix-rgbw"
[[sensors]]
name = "onyx-rgbw"
[[sensors]]
name = "onyx-rgbw"
[light]
illuminant = "D65"
level_lux = 1e300
[[pictures]]
mosaic = "RGGX"
[[pictures]]
mosaic = "bayer"
prnu = "x"
[[pictures]]
cube = "nowhere.hdr"
[[sweeps]]
vary = "lux"
first = 5
last = 1
"""


def test_all_faults_of_a_study_are_told_at_once_each_at_its_line(run, here):
    (here / "s.toml").write_text(WRONG)
    outcome = run("run", "s.toml", "--out", "out")
    for line, key in [
        (2, "sensors.0.name"),
        (6, "sensors.2.name"),
        (8, "light.illuminant"),
        (9, "light.level_lux"),
        (11, "pictures.0.mosaic"),
        (13, "pictures.1.mosaic"),
        (14, "pictures.1.prnu"),
        (16, "pictures.2.cube"),
        (18, "sweeps.0.vary"),
    ]:
        refused(outcome, f"chromanoise: s.toml:{line}: {key}: ", setting=key)
    refused(outcome, "'onix-rgbw'", "onyx-rgbw", "300-780 nm", "1e+300", "channel W")
    assert not (here / "out").exists()


def test_a_channel_that_sees_nothing_is_told_at_the_line_of_its_file(run, here):
    (here / "cam.csv").write_text("wavelength_nm,R,Z\n400,0.1,0\n1050,0.3,0\n")
    (here / "s.toml").write_text('[[sensors]]\nname = "onyx-rgb"\n[[sensors]]\nname = "cam.csv"\n')
    outcome = run("run", "s.toml", "--out", "out")
    refused(outcome, "s.toml:4: sensors.1.name: ", "channel Z", setting="sensors.1.name")
    refused(run("analyze", "onyx-rgb", "cam.csv"), "channel Z", setting="sensors.1.name")


def test_a_study_is_no_output_and_says_which_command_takes_it(run, made):
    refused(run("rerun", "s.toml", "--out", "again"), "chromanoise run s.toml")


def test_an_input_that_changed_is_named(run, made):
    (made / "cam.csv").write_text(CAMERA.format(end=0.4))
    for command in (("rerun", "out", "--out", "again"), ("run", "s.toml", "--out", "out")):
        refused(run(*command), "cam.csv")


def test_an_input_that_is_gone_is_named(run, made):
    (made / "cam.csv").unlink()
    refused(run("rerun", "out", "--out", "again"), "cam.csv")


def test_two_matrices_that_would_write_the_same_file_are_refused(run, done, here):
    (here / "a").mkdir()
    for name in ("a-m.csv", "a/m.csv"):
        done("matrix", "onyx-rgb", "--export", name)
    (here / "s.toml").write_text(
        'matrices = ["a/m.csv", "a-m.csv"]\n[[sensors]]\nname = "onyx-rgb"\n'
    )
    refused(run("run", "s.toml", "--out", "out"), subject="file names of matrices", value="a-m.csv")
    assert not (here / "out").exists()


def test_a_catalog_folder_that_is_missing_is_asked_for(run, done, made, monkeypatch):
    folder = made / "mine"
    folder.mkdir()
    shed_in(folder)
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(folder))
    (made / "s.toml").write_text('[[sensors]]\nname = "shed"\n')
    done("run", "s.toml", "--out", "shed")
    monkeypatch.delenv("CHROMANOISE_CATALOG")
    refused(run("rerun", "shed", "--out", "again"), "shed", "CHROMANOISE_CATALOG")


def test_a_result_that_was_changed_stays_until_it_is_moved_away(run, made):
    file = made / "out/analysis-kernel.json"
    right = file.read_bytes()
    data = json.loads(right)
    data["result"]["sensors"][0]["sensor"] = "another"
    for changed in (json.dumps(data, indent=1).encode(), right[:100]):
        file.write_bytes(changed)
        refused(run("run", "s.toml", "--out", "out"), "analysis-kernel.json", "changed")
        assert file.read_bytes() == changed
        file.rename(made / "mine.json")
        assert run("run", "s.toml", "--out", "out")[0] == 0
        assert file.read_bytes() == right


def test_csv_json_and_csv_again_keeps_source_and_notes(run, here):
    head = "# source: a bench\n# quantity: QE [e-/photon]\n# notes: one; two\n"
    (here / "a.csv").write_text(head + CAMERA.format(end=0.3))
    assert run("convert", "a.csv", "b.json")[0] == 0
    assert run("convert", "b.json", "c.csv")[0] == 0
    result = read_curves(here / "c.csv")
    assert result.said_source == "a bench"
    assert result.said_notes[:2] == ("one", "two")
    kept = json.loads((here / "b.json").read_text())
    assert (kept["source"], kept["notes"][:2]) == ("a bench", ["one", "two"])


@pytest.mark.parametrize(
    ("text", "read_noise_e"),
    [
        ("NoiseProfile: 0.0002 0.000001\n", 5.0),
        ("Mean [DN],Variance [DN^2],light\n0,4.0833333333,dark\n100,54.08333,light\n"
         "300,154.08333,light\n500,254.08333,light\n", 4.0),
    ],
)  # fmt: skip
def test_a_pixel_comes_from_every_form_of_file(done, here, text, read_noise_e):
    (here / "pixel.txt").write_text(text)
    assert read_pixel_source("pixel.txt").read_noise_e == pytest.approx(read_noise_e, rel=1e-6)
    out, _ = done("analyze", "onyx-rgbw", "--pixel", "pixel.txt", "--json", "-")
    notes = " ".join(json.loads(out)["sensors"][0]["notes"])
    assert re.search(r"read_noise_e[^|]* of pixel.txt", notes)


def test_a_file_of_no_pixel_is_told_all_forms(run, here):
    (here / "pixel.txt").write_text("price: 3 EUR\n")
    refused(
        run("analyze", "onyx-rgbw", "--pixel", "pixel.txt"),
        "sigma_d = 2.4 e-",
        "mean_dn,variance_dn2",
        "NoiseProfile: 0.0002",
    )


def test_no_name_of_the_catalog_is_broken(run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    _, out, _ = run("catalog", "sensors")
    data = json.loads(run("catalog", "sensors", "--json", "-")[1])
    names = [entry["name"] for entry in data["entries"]]
    assert "model-rgbw-ircut" in names
    for name in names:
        assert re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", out), name


def test_a_pixel_of_the_catalog_is_one_that_could_be(run, here, monkeypatch):
    shed_in(here, 'pixel = { pitch_um = -3, source = "a guess" }\n')
    monkeypatch.setenv("CHROMANOISE_CATALOG", str(here))
    refused(run("catalog", "shed"), "SOURCES.toml", "shed", "pitch_um", value=-3.0)


def test_a_missing_envi_header_is_named_once(run, here):
    (here / "passwd").write_text("no picture")
    outcome = run("simulate", "passwd", "--sensor", "onyx-rgb", "--out", "o")
    refused(outcome, setting="pictures.0.cube")
    assert outcome[2].count("passwd.hdr") == 1
