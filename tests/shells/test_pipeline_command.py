"""What ``analyze --pipeline`` prints, writes and refuses is what the library says."""

import csv
import json

import pytest

import chromanoise as cn
from chromanoise.base import plain
from chromanoise.spectra import DEFAULT_GRID, black_body
from chromanoise.study import PipelineSettings, pipeline_noise
from outcomes import refused, refused_input

OPTIONS = (
    "--saturation",
    1.2,
    "--tone",
    "rec709",
    "--iso",
    "100,800",
    "--white-balance",
    "2,1,1.2",
)
SETTINGS = {
    "pipeline": True,
    "saturation": 1.2,
    "tone": "rec709",
    "iso": (100.0, 800.0),
    "white_balance": (2.0, 1.0, 1.2),
    "exposure_gain": 0.7,
}
WORDS = ("analyze", "model-rgb-ircut", "--pipeline", "--exposure-gain", 0.7, *OPTIONS)


def pipeline_of(out):
    (sensor,) = json.loads(out)["sensors"]
    return sensor["pipeline"]


@pytest.mark.evidence
def test_json_has_the_digits_of_the_library(done):
    out, _ = done(*WORDS, "--json", "-")
    (outcome,) = cn.analyze("model-rgb-ircut").outcomes
    settings = {name: value for name, value in SETTINGS.items() if name != "pipeline"}
    own = plain(pipeline_noise(outcome.analysis, PipelineSettings(**settings)))
    assert pipeline_of(out) == json.loads(json.dumps(own))


def test_without_the_option_no_result_has_the_key(done):
    out, _ = done("analyze", "model-rgb-ircut", "--json", "-")
    assert "pipeline" not in json.loads(out)["sensors"][0]


@pytest.mark.evidence
def test_the_tables_show_patches_and_isos(done):
    words = WORDS[: WORDS.index("--white-balance")]
    out, _ = done(*words, "--white-balance", "gray", "--white-balance-pixels", 100)
    for part in ("neutral 6.5", "Y'", "Cb", "L*", "Rec. 709", "800", "dynamic", "100 gray pixels"):
        assert part in out


@pytest.mark.evidence
def test_balance_by_illuminant_is_that_of_the_light_or_of_another(done, here):
    base = ("analyze", "model-rgb-ircut", "--pipeline", "--json", "-", "--white-balance")
    own, _ = done(*base, "illuminant")
    assert pipeline_of(own)["gains"] == pytest.approx(pipeline_of(done(*base, "E")[0])["gains"])
    other = pipeline_of(done(*base, "2856K")[0])
    (outcome,) = cn.analyze("model-rgb-ircut").outcomes
    settings = PipelineSettings(white_balance=black_body(DEFAULT_GRID, 2856.0))
    gains = pipeline_noise(outcome.analysis, settings).gains
    assert list(other["gains"].values()) == pytest.approx(gains.tolist(), rel=1e-3)
    (here / "lamp.csv").write_text(
        "wavelength_nm,power\n" + "".join(f"{w},{w / 500}\n" for w in range(400, 1051, 10))
    )
    filed = pipeline_of(
        done(*base, "lamp.csv", "--illuminant", "lamp.csv", "--illuminant-energy")[0]
    )
    again = pipeline_of(done(*base, "gray", "--illuminant", "lamp.csv", "--illuminant-energy")[0])
    assert filed["gains"] == pytest.approx(again["gains"])


def test_a_saturated_sensor_has_null(done):
    words = ("analyze", "model-rgb-ircut", "--pipeline", "--time-ms", 1e5)
    assert pipeline_of(done(*words, "--json", "-")[0]) is None
    assert "no pipeline" in done(*words)[0]


@pytest.mark.parametrize(
    ("options", "part", "setting"),
    [
        (("--white-balance", "1,2"), "--white-balance", "white_balance"),
        (("--white-balance", "1,0,1"), "--white-balance", "white_balance"),
        (("--white-balance", "gry"), "gry", "white_balance"),
        (("--black-error-e", -3000), "--white-balance", "white_balance"),
        (("--tone", "rec2020"), "--tone", "tone"),
        (("--exposure-gain", 2), "--exposure-gain", "exposure_gain"),
        (("--iso", 0), "--iso", "iso"),
        (("--iso", 50), "--iso", "iso"),
    ],
)
def test_bad_input_is_one_sentence(run, options, part, setting):
    outcome = run("analyze", "model-rgb-ircut", "--pipeline", *options)
    refused(outcome, part)
    assert len(outcome[2].splitlines()) == 1
    (error,) = outcome.errors
    assert error.setting.split(".")[2] == setting


def test_settings_without_the_pipeline_are_refused(run):
    refused(
        run("analyze", "model-rgb-ircut", "--tone", "linear"),
        *("--tone", "--pipeline"),
        remedy_setting="run",
        value="linear",
    )


@pytest.mark.evidence
def test_the_table_has_a_row_per_sensor_iso_and_patch_with_the_digits_of_the_json(done, here):
    out, _ = done(*WORDS, "--table", "noise.csv", "--json", "-")
    head, *rows = csv.reader((here / "noise.csv").read_text().splitlines())
    found = pipeline_of(out)
    assert len(rows) == 24 * len(found["iso"]) == 48
    assert head[:3] == ["sensor", "ISO", "patch"]
    assert head[3] == "raw R [e-]"
    lab = found["iso"][1]["steps"][-1]
    orange = next(one for one in lab["patches"] if one["patch"] == "orange")
    (row,) = [one for one in rows if float(one[1]) == 800 and one[2] == "orange"]
    sd = [orange["covariance"][k][k] ** 0.5 for k in range(3)]
    assert [float(one) for one in row[-3:]] == pytest.approx(sd, rel=1e-12)


def test_without_a_pipeline_there_is_no_table_of_it():
    with refused_input(subject="analyses"):
        cn.analyze("model-rgb-ircut").pipeline_table()
