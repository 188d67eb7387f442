"""The values of a pixel file reach every result and picture, and options override them."""

import json

import numpy as np
import pytest
import tifffile
from PIL import Image

import chromanoise as cn
from chromanoise.base.errors import errors_in
from chromanoise.io.sensor_files import sensor_from_json, sensor_json
from chromanoise.sensor import EXTRA_NOISE, Converter
from chromanoise.study import read_study, sensor_with_pixel, study_from_data
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.page_studies import Studies, files_of, served_data
from chromanoise.web.previews import PictureReplies
from chromanoise.web.uploads import Uploads
from outcomes import refused
from processes import printed

SHEET = """\
pixel pitch = 5 um
saturation capacity = 4000 e-
sigma_d = 6 e-
K = 0.5 DN/e-
bits = 10
black level = 64 DN
PRNU = 5 %
DSNU = 12 e-
dark current = 2000 e-/s
"""
TOLD = dict.fromkeys(EXTRA_NOISE, 0.0)
TOLD |= {"dark_current_e_per_s": 2000.0, "dsnu_e": 12.0, "prnu": 0.05}
DARK_E2 = 40 + 6**2 + 12**2  # 2000 e-/s for 20 ms, read noise, DSNU
SIDE = 160


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with the sheet and a cube whose left half is black and right half gray."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sheet.txt").write_text(SHEET)
    reflectance = np.zeros((SIDE, 2 * SIDE, 14), dtype=np.float32)
    reflectance[:, SIDE:] = 0.5
    np.savez("cube.npz", wavelength_nm=np.linspace(400, 1050, 14), reflectance=reflectance)
    return tmp_path


ASKED = ("simulate", "cube.npz", "--sensor", "model-rgb", "--time-ms", 20, "--lux", 8)
GREEN = ("--mosaic", "G", "--raw-only")


@pytest.fixture
def take(done, here):
    """A simulation with the sheet: its codes, its summary and its messages."""

    def call(*options, pixel=("--pixel", "sheet.txt"), name="o"):
        _, err = done(*ASKED, *pixel, *options, "-o", name)
        (summary,) = json.loads((here / name / "summary.json").read_text())["pictures"]
        raw = here / name / "model-rgb.raw.tiff"
        return tifffile.imread(raw).astype(float) if raw.exists() else None, summary, err

    return call


def test_codes_of_a_flat_patch_have_the_mean_and_the_variance_that_the_sheet_gives(take):
    codes, result, _ = take(*GREEN)
    mu = 2 * result["mean_e"]["G"]
    assert 200 < mu < 1500  # codes end at (1023 - 64) / 0.5 = 1918 e-
    for patch, mean_e in ((codes[:, :SIDE], 0.0), (codes[:, SIDE:], mu)):
        # mu_i + mu_dark + s_r^2 + PRNU^2 mu_i^2 + DSNU^2 in electrons, rounding in codes
        variance = 0.25 * (mean_e + DARK_E2 + (0.05 * mean_e) ** 2) + 1 / 12
        z = (patch.mean() - 64 - 0.5 * mean_e) / np.sqrt(variance / patch.size)
        assert abs(z) < 5
        assert abs(patch.var(ddof=1) / variance - 1) < 5 * np.sqrt(2 / patch.size)


def test_the_summary_and_its_notes_list_the_values_used(take):
    _, result, _ = take(*GREEN)
    assert (result["bits"], result["gain_e_per_dn"], result["black_level_dn"]) == (10, 2.0, 64)
    assert result["imperfections"] == TOLD
    notes = " | ".join(result["notes"])
    for value in ("dark_current_e_per_s 2000", "dsnu_e 12", "prnu 0.05", "10 bits, 2 e-/DN"):
        assert value in notes


def test_every_option_overrides_the_sheet_also_with_0(take):
    zeros = {"dark_current_e_per_s": 0, "dsnu_e": 0, "prnu": 0}
    words = [word for k, v in zeros.items() for word in (f"--{k.replace('_', '-')}", v)]
    codes, result, _ = take(*GREEN, *words)
    assert result["imperfections"] == dict.fromkeys(TOLD, 0.0)
    dark = codes[:, :SIDE]
    assert abs(dark.var(ddof=1) / (0.25 * 36 + 1 / 12) - 1) < 5 * np.sqrt(2 / dark.size)
    (note,) = [note for note in result["notes"] if "as given" in note]
    assert all(name in note for name in (*zeros, "sheet.txt"))
    more = ("--prnu", 0.01, "--bits", 12, "--black-level", 0)
    _, other, _ = take(*GREEN, *more, name="p")
    assert other["imperfections"] == TOLD | {"prnu": 0.01}
    assert (other["bits"], other["gain_e_per_dn"], other["black_level_dn"]) == (12, 2.0, 0)


def test_a_gain_without_bits_makes_a_converter_whose_codes_reach_the_full_well(take, here):
    (here / "sheet.txt").write_text("K = 0.5 DN/e-\nmu_e.sat = 4095 e-\nblack level = 10 DN")
    _, result, _ = take(*GREEN)
    assert (result["bits"], result["gain_e_per_dn"], result["black_level_dn"]) == (12, 2.0, 10)
    _, result, _ = take(*GREEN, "--bits", 14, name="p")
    assert (result["bits"], result["gain_e_per_dn"], result["black_level_dn"]) == (14, 2.0, 10)


def test_a_sheet_without_a_black_level_is_not_named_as_its_source(take, here):
    (here / "sheet.txt").write_text("K = 0.5 DN/e-\nbits = 10")
    _, result, _ = take(*GREEN)
    (note,) = [note for note in result["notes"] if note.endswith("of sheet.txt")]
    assert note == "bits, gain_e_per_dn of sheet.txt"
    assert (result["gain_e_per_dn"], result["black_level_dn"]) == (2.0, 0)


def test_a_picture_without_a_mosaic_has_the_noise_of_the_sheet_and_no_converter(take, here):
    _, result, _ = take("--format", "xyz")
    assert result["imperfections"] == TOLD
    notes = " | ".join(result["notes"])
    assert "bits 10, gain_e_per_dn 2, black_level_dn 64" in notes
    _, typed, _ = take(
        *("--pitch-um", 5, "--full-well-e", 4000, "--read-noise-e", 6, "--prnu", 0.05),
        *("--dsnu-e", 12, "--dark-current-e-per-s", 2000, "--format", "xyz"),
        pixel=(),
        name="p",
    )
    ours, theirs = (tifffile.imread(here / name / "model-rgb.xyz.tiff") for name in "op")
    assert (ours == theirs).all()
    assert typed["imperfections"] == TOLD


def test_the_closed_form_has_all_noise_of_the_sheet(result_of, here):
    """EMVA 1288: mu + I t + s_r^2 + (1/12)/K^2 + PRNU^2 mu^2 + DSNU^2, the last two spatial."""
    result = analyzed(result_of, "--pixel", "sheet.txt")
    for channel in result["channels"]:
        mean_e = channel["mean_e"]
        temporal_e2 = mean_e + 2000 * 0.02 + 6**2 + 1 / 0.5**2 / 12
        total_e2 = temporal_e2 + (0.05 * mean_e) ** 2 + 12**2
        for name, variance_e2 in (("temporal_snr_db", temporal_e2), ("snr_db", total_e2)):
            assert channel[name] == pytest.approx(10 * np.log10(mean_e**2 / variance_e2), abs=1e-9)
    (note,) = [note for note in result["notes"] if note.endswith("of sheet.txt")]
    for name in ("dark_current_e_per_s", "dsnu_e", "prnu", "bits", "gain_e_per_dn"):
        assert name in note


def test_options_give_the_closed_form_of_the_same_sheet(result_of, here):
    words = ("--pitch-um", 5, "--full-well-e", 4000, "--read-noise-e", 6, "--gain-dn-per-e", 0.5)
    words += ("--bits", 10, "--prnu", 0.05, "--dsnu-e", 12, "--dark-current-e-per-s", 2000)
    sheet, typed = analyzed(result_of, "--pixel", "sheet.txt"), analyzed(result_of, *words)
    sheet.pop("notes"), typed.pop("notes")
    assert typed == sheet


def analyzed(result_of, *options):
    asked = ("analyze", "model-rgb", "--time-ms", 20, "--lux", 8)
    (sensor,) = result_of(*asked, *options)["sensors"]
    return sensor


def test_a_picture_has_the_black_level_error_in_every_code(take):
    plain, _, _ = take(*GREEN)
    codes, other, _ = take(*GREEN, "--black-error-e", 40, name="p")
    assert set((codes - plain)[plain > 0]) == {20.0}  # 0.5 DN/e-
    assert other["imperfections"]["black_error_e"] == 40


@pytest.mark.evidence
@pytest.mark.parametrize(
    ("options", "kinds"),
    [
        ((*GREEN, "--prnu", 0), ("toml", "python")),
        (("--mosaic", "bayer", "--black-level", 32, "--format", "raw,png"), ("toml",)),
        (("--clip", "--dsnu-e", 0.0, "--format", "xyz"), ("toml",)),
    ],
)
def test_simulate_its_study_and_its_script_give_the_same_picture(
    take, run, done, here, options, kinds
):
    take(*options)
    ours = sorted(p for p in (here / "o").iterdir() if p.suffix in (".tiff", ".png"))
    for kind in kinds:
        out, _ = done(*ASKED, "--pixel", "sheet.txt", *options, "--copy-as", kind)
        folder = here / kind
        if kind == "toml":
            (here / "s.toml").write_text(out)
            done("run", "s.toml", "-o", kind)
            (data,) = json.loads((folder / "pictures-1.json").read_text())["result"]["pictures"]
            own = json.loads((here / "o" / "summary.json").read_text())["pictures"][0]
            assert data["imperfections"] == own["imperfections"]
            assert data["notes"] == own["notes"]
        else:
            folder.mkdir()
            script = out.replace('"cube.npz"', '"../cube.npz"').replace(
                '"sheet.txt"', '"../sheet.txt"'
            )
            printed(script, cwd=folder)
        theirs = sorted(
            p
            for p in folder.iterdir()
            if p.suffix in (".tiff", ".png") and p.name.startswith("picture")
        )
        assert [p.read_bytes() for p in theirs] == [p.read_bytes() for p in ours]


def test_a_sensor_written_as_json_keeps_what_its_pictures_use(here):
    sensor = sensor_with_pixel("model-rgb", file="sheet.txt")
    again = sensor_from_json(sensor_json(sensor))
    assert (again.pixel, again.converter) == (sensor.pixel, sensor.converter)
    assert (again.pixel.dsnu_e, again.pixel.prnu) == (12.0, 0.05)
    assert again.converter == Converter(bits=10, gain_e_per_dn=2.0, black_level_dn=64)


def test_the_picture_of_the_page_is_that_of_the_run_with_its_sheet(run, here):
    text = (
        '[light]\nlevel_lux = 8.0\n[exposure]\ntime_ms = 20.0\n[[sensors]]\nname = "model-rgb"\n'
        'pixel.file = "sheet.txt"\n[[pictures]]\ncube = "cube.npz"\nprnu = 0.0\n'
        'formats = ["png"]\n[outputs]\nanalyses = false\n'
    )
    (here / "s.toml").write_text(text)
    assert run("run", "s.toml", "-o", "o")[0] == 0
    (record,) = json.loads((here / "o" / "pictures-1.json").read_text())["result"]["pictures"]
    assert record["imperfections"] == TOLD | {"prnu": 0.0}
    data = served_data(read_study("s.toml"))
    uploads = Uploads()
    try:
        files = files_of(study_from_data(data, source="the test", keep_idle=True))
        png, summary = PictureReplies(Studies(uploads, files=files)).picture({"study": data})
    finally:
        uploads.close()
    (here / "page.png").write_bytes(png)
    (file,) = (here / "o").glob("*.png")
    assert (np.asarray(Image.open("page.png")) == np.asarray(Image.open(file))).all()
    notes = " | ".join(json.loads(summary)["notes"])
    assert "dsnu_e 12" in notes
    assert "prnu" in notes


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("mean_dn;variance_dn2\n64,5;1\n64,5;2\n64,5;3\n", "3"),
        ("mean_dn,variance_dn2,light\n64,1,dark\n164,51,light\n264,-1,light\n", "-1"),
        ("sigma_d = 3 e-\nbits = 12\nblack level = 70000 DN", "70000"),
        ("sigma_d = 3 e-\nbits = 20", "20"),
    ],
)
def test_a_pixel_file_of_an_impossible_camera_is_refused_in_one_sentence(run, here, text, part):
    (here / "sheet.txt").write_text(text)
    refused(run(*ASKED, "--pixel", "sheet.txt", "-o", "o"), "sheet.txt", part)
    assert not (here / "o").exists()


SENTENCES = [
    ("prnu", 0.3, "must be 0 to 0.2", ("write 1 percent as 0.01",)),
    ("rtn_share", 5, "must be 0 to 1", ("write 1 percent as 0.01",)),
    ("read_noise_e", -2, "must be 0 to 1e+12 [e-]", ()),
    ("full_well_e", 0, "must be 0.001 to 1e+15 [e-]", ()),
    ("black_error_e", 1e16, "must be -1e+15 to 1e+15 [e-]", ()),
    ("temperature_c", -300, "must be -273.15 to 300 [C]", ()),
]


@pytest.mark.parametrize(("name", "value", "requirement", "remedy"), SENTENCES)
def test_a_value_out_of_bounds_has_one_sentence_in_every_interface(
    run, here, name, value, requirement, remedy
):
    (here / "p.toml").write_text(
        f'schema = "chromanoise pixel"\nschema_version = 1\n{name} = {value}\n'
    )
    (here / "s.toml").write_text(
        f'[[sensors]]\nname = "onyx-rgb"\n[sensors.pixel]\n{name} = {value}\n'
    )
    sensor = ("analyze", "onyx-rgb")
    errors = {
        "option": run(*sensor, f"--{name.replace('_', '-')}={value}").errors,
        "pixel file": run(*sensor, "--pixel", "p.toml").errors,
        "study": run("run", "s.toml", "-o", "o").errors,
    }
    with pytest.raises(cn.InputError) as caught:
        cn.analyze("onyx-rgb", **{name: value})
    errors["keyword"] = errors_in(caught.value)
    found = {
        where: [(one.requirement, one.value, one.remedy) for one in each]
        for where, each in errors.items()
    }
    assert found == {key: [(requirement, value, remedy)] for key in errors}
    with pytest.raises(QuestionError) as asked:
        Studies(Uploads()).study_as_given(
            {"sensors": [{"name": "onyx-rgb", "pixel": {name: value}}]}
        )
    (fault,) = asked.value.faults
    assert fault[1].removeprefix(f"{name.replace('_', ' ')} ") == "; ".join(
        [f"{requirement}, but is {value:g}", *remedy]
    )
