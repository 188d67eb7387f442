"""What ``analyze --merit`` and ``matrix --pareto`` tell is what the library says."""

import json

import pytest

from chromanoise.base import plain
from chromanoise.noise import Exposure
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import (
    analyzed,
    matrix_makers,
    merits_of,
    noise_weights,
    pareto_of,
    sensor_named,
)
from outcomes import refused
from strategies import point_of

LAMP = equal_energy(DEFAULT_GRID)


def situation_of(name, lux, time_s):
    return point_of(sensor_named(name, DEFAULT_GRID), lux, exposure=Exposure(time_s=time_s))


def test_json_of_merit_has_the_digits_of_the_library(result_of):
    arguments = ("--matrix", "lmmse", "--prior", "chart", "--lux", 2, "--time-ms", 10)
    result = result_of("analyze", "model-rgb-ircut", *arguments, "--merit")
    data = result["sensors"][0]["merits"]
    operating_point = situation_of("model-rgb-ircut", 2.0, 0.010)
    maker = matrix_makers(["lmmse"], "quanta", prior="chart")["lmmse"]
    white = flat_field(LAMP, level_lux=2.0)
    analysis = analyzed(
        white, operating_point.sensor, operating_point.exposure, matrix=maker(operating_point)
    )
    assert data == json.loads(json.dumps(plain(merits_of(analysis, maker=maker))))
    assert data["values"]["snr10_adapted"]["value"] > 0
    assert data["viewing"]["pixels_per_degree"] == pytest.approx(41.888, abs=1e-3)


def test_merit_prints_each_number_with_its_source_and_each_gap_with_its_reason(run):
    code, out, _ = run("analyze", "model-mono", "--merit")
    assert code == 0
    sources = (
        *("Neugebauer 1956", "Vora & Trussell 1993", "ISO 17321-1:2012", "ISO 12232:2019"),
        *("ISO 15739:2017", "Alakarhu", "DxOMark", "Shannon", "US 5,609,978"),
    )
    for part in (*sources, "mosaic", "0.25 mm", "600 mm"):
        assert part in out


def test_without_merit_nothing_of_it_is_told(result_of, done):
    assert "merits" not in result_of("analyze", "model-mono")["sensors"][0]
    assert "Neugebauer" not in done("analyze", "model-mono")[0]


def test_merit_of_clipped_electrons_is_refused(run):
    outcome = run("analyze", "model-mono", "--clip", "--merit")
    refused(outcome, "--clip", setting="outputs.clip", value=True)


def test_json_of_pareto_has_the_digits_of_the_library(result_of):
    asked = ("matrix", "onyx-rgbw", "--lux", 1, "--time-ms", 12, "--prior", "smooth-100")
    data = result_of(*asked, "--pareto", "0.01:100:5")
    operating_point = situation_of("onyx-rgbw", 1.0, 0.012)
    curve = pareto_of(operating_point, noise_weights(0.01, 100.0, points=5), prior="smooth-100")
    assert [p["weight"] for p in data["pareto"]] == curve.weight.tolist()
    assert [p["color_error_rms_lux"] for p in data["pareto"]] == curve.color_error_rms.tolist()
    assert [p["delta_e"] for p in data["pareto"]] == list(curve.delta_e)
    assert [p["noise_rms_lux"] for p in data["pareto"]] == curve.noise_rms.tolist()
    assert [p["snr_y_db"] for p in data["pareto"]] == curve.snr_y_db.tolist()
    assert data["matrix"]["made_by"] == "kernel (eq. 6)"
    assert data["report"]["psi"] > 0


def test_pareto_prints_one_line_per_weight_and_names_the_lmmse_matrix(run):
    arguments = ("--lux", 1, "--time-ms", 5)
    code, out, _ = run("matrix", "model-rgb-ircut", *arguments, "--pareto", "0.001:1000")
    rows = [line for line in out.splitlines() if line.startswith("│ ") and line.count("│") == 7]
    assert code == 0
    assert len(rows) == 13
    assert [row.split("│")[1].strip() for row in rows if "LMMSE" in row] == ["1"]


def test_a_saturated_white_is_told_along_the_curve(done):
    out, _ = done("matrix", "model-rgb-ircut", "--time-ms", 1000, "--pareto", "0.1:10:3")
    assert out.count("saturated") == 4  # once for the matrix, once per weight


def test_json_of_a_matrix_alone_has_no_curve_and_goes_to_a_file_beside_the_table(done, tmp_path):
    target = tmp_path / "m.json"
    out, _ = done("matrix", "model-rgb-ircut", "--json", target)
    assert "Kodak's Psi" in out
    assert json.loads(target.read_text())["pareto"] is None


@pytest.mark.parametrize(
    ("asked", "fields"),
    [
        ("5", {"subject": "--pareto", "value": "5"}),
        ("1:2:3:4", {"subject": "--pareto", "value": "1:2:3:4"}),
        ("a:2", {"subject": "--pareto", "value": "a:2"}),
        ("1:2:2.5", {"subject": "--pareto", "value": "1:2:2.5"}),
        ("0:2", {"setting": "outputs.pareto.first", "value": 0.0}),
        ("2:1", {"setting": "outputs.pareto"}),
        ("1:2:1", {"setting": "outputs.pareto.points", "value": 1}),
        ("nan:2", {"setting": "outputs.pareto.first"}),
        ("", {}),
    ],
)
def test_weights_that_make_no_curve_are_refused_in_a_sentence(run, asked, fields):
    refused(run("matrix", "model-rgb-ircut", "--pareto", asked), **fields)
