"""The commands: what they write is what the library says, and bad input is one sentence."""

import json
import re
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from click import Context
from matplotlib.figure import Figure

from chromanoise.base.files import OWN_FILES
from chromanoise.charts import write_figures
from chromanoise.cli.entry import commands
from chromanoise.noise import Exposure, expected_electrons
from chromanoise.sensor import behind_ir_cut, with_shifted_curves
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import (
    FUNCTIONS,
    Study,
    analyzed,
    default_of,
    described_settings,
    interface_of,
    sensor_named,
)
from outcomes import refused

demo = import_module("chromanoise.cli.demo")


@pytest.fixture
def curve_file(tmp_path):
    """Write a two-channel QE table up to a wavelength."""

    def write(stop=1050):
        rows = ["wavelength_nm,R,G"]
        for wavelength in range(400, stop + 1, 10):
            red = 0.5 if wavelength > 580 else 0.05
            green = 0.4 if 490 < wavelength < 590 else 0.1
            rows.append(f"{wavelength},{red},{green}")
        path = tmp_path / "mine.csv"
        path.write_text("\n".join(rows))
        return path

    return write


@pytest.fixture
def analysis(result_of):
    """Analyze a sensor; give back its part of the JSON."""
    return lambda *arguments: result_of("analyze", *arguments)["sensors"][0]


def test_json_of_analyze_has_the_digits_of_the_library(analysis):
    data = analysis("onyx-rgbw", "--time-ms", 12)
    scene = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
    sensor = sensor_named("onyx-rgbw", DEFAULT_GRID)
    ours = analyzed(scene, sensor, Exposure(time_s=0.012))
    assert [c["mean_e"] for c in data["channels"]] == ours.raw.mean.tolist()
    assert data["matrix"] == ours.matrix.matrix.tolist()
    assert data["bound_db"] == ours.optimal_linear_snr_db
    assert data["price_db"] == pytest.approx(
        ours.optimal_linear_snr_db - data["color"]["snr_db"]["Y"]
    )


def test_json_of_analyze_holds_what_it_promises(result_of):
    for sensor in result_of("analyze", "onyx-rgbw", "onyx-rgb-ircut")["sensors"]:
        assert {"name", "channels", "color", "bound_db", "price_db", "condition", "matrix"} <= set(
            sensor
        )
        assert set(sensor["color"]["snr_db"]) == {"X", "Y", "Z"}
        for channel in sensor["channels"]:
            assert {
                "name",
                "mean_e",
                "snr_db",
                "contravariant_snr_db",
                "vif",
                "saturated",
            } <= set(channel)


def test_default_time_brings_the_most_sensitive_channel_to_99_percent_of_full_well(
    analysis,
):
    means = [c["mean_e"] for c in analysis("onyx-rgb-ircut")["channels"]]
    assert max(means) == pytest.approx(9900, rel=1e-12)


def test_a_saturated_channel_says_so_and_has_no_snr(analysis, done):
    asked = ("onyx-rgbw", "--lux", 1000, "--time-ms", 12)
    sensor = analysis(*asked)
    for channel in sensor["channels"]:
        assert channel["saturated"] is True
        assert channel["snr_db"] is None
    assert sensor["color"]["snr_db"]["Y"] is None
    assert any("saturated" in note for note in sensor["notes"])
    assert "saturated" in done("analyze", *asked)[0]


def test_a_sensor_file_gives_its_own_channels_and_the_pixel_that_is_asked_for(analysis, curve_file):
    path = curve_file()
    small, large = (analysis(path, "--time-ms", 1, "--pitch-um", pitch_um) for pitch_um in (5, 10))
    electrons = [np.array([c["mean_e"] for c in one["channels"]]) for one in (small, large)]
    np.testing.assert_allclose(electrons[1] / electrons[0], 4.0, rtol=1e-12)
    (note,) = [n for n in small["notes"] if "full well" in n]
    assert "10000 e-, 10 e-" in note
    assert "pitch" not in note


def test_a_channel_that_repeats_another_is_an_answer_with_a_diagnosis(analysis, tmp_path):
    rows = [
        f"{w},{0.3 if w < 600 else 0.1},{0.3 if w < 600 else 0.1}" for w in range(400, 1051, 50)
    ]
    path = tmp_path / "twins.csv"
    path.write_text("wavelength_nm,A,B\n" + "\n".join(rows))
    sensor = analysis(path)
    assert sensor["rank"] == 1
    assert sensor["condition"] is None
    assert [c["vif"] for c in sensor["channels"]] == [None, None]
    assert [c["contravariant_snr_db"] for c in sensor["channels"]] == [None, None]
    assert any("singular" in note for note in sensor["notes"])


def test_reproduce_writes_the_same_json_for_the_same_seed(run, tmp_path):
    files = [tmp_path / "a.json", tmp_path / "b.json"]
    for path in files:
        assert run("reproduce", "--draws", 500, "--seed", 3, "--json", path)[0] == 0
    assert files[0].read_bytes() == files[1].read_bytes()
    data = json.loads(files[0].read_text())
    assert {"version", "seed", "metric", "tables", "times_ms"} <= set(data)
    assert {cell["table"] for cell in data["tables"]} == {2, 3, 4, 5}


def test_a_curve_that_ends_short_is_zero_beyond_if_told_so(analysis, curve_file):
    sensor = analysis(curve_file(stop=700), "--beyond", "zero")
    assert any("zero beyond 400-700 nm" in note for note in sensor["notes"])


def test_demo_writes_one_page_that_needs_nothing_from_elsewhere(run, tmp_path, monkeypatch):
    # PNG, PDF and the report take their time, and have tests of their own
    monkeypatch.setattr(demo, "write_figures", partial(write_figures, endings=("svg",)))
    monkeypatch.setattr(demo, "study_report", lambda of, *_: of.study.title)
    code, out, _ = run("demo", "--out", tmp_path / "demo")
    assert code == 0
    assert "IR-cut" in (tmp_path / "demo" / "report.html").read_text(encoding="utf-8")
    assert "dB worse in luminance" in out
    page = (tmp_path / "demo" / "index.html").read_text(encoding="utf-8")
    assert "dB worse in luminance" in page
    assert "reconstruction" in page
    outside = [part for part in ('src="http', 'href="http', "url(http", "@import") if part in page]
    assert outside == []
    offered = set(re.findall(r'href="([^"#]+)" download', page))
    assert offered == {path.name for path in (tmp_path / "demo").iterdir()} - {
        "index.html",
        OWN_FILES,
    }
    anchors = set(re.findall(r'href="#([^"]+)"', page))
    assert anchors <= set(re.findall(r'id="([^"]+)"', page))
    words = re.sub(r"<style>.*?</style>|<math.*?</math>|<[^>]*>", " ", page, flags=re.DOTALL)
    assert not re.search(r"\w\^|\w_\w|\bsqrt\b|\btheta\b", words)  # mathematics is MathML
    names = {path.stem for path in Path(tmp_path / "demo").glob("figure-*.svg")}
    assert len(names) == 10


def test_a_sensor_that_sees_only_infrared_is_an_answer_with_a_diagnosis(analysis, done, tmp_path):
    path = tmp_path / "nir.csv"
    rows = [f"{w},{0.3 if w > 850 else 0}" for w in range(400, 1051, 10)]
    path.write_text("wavelength_nm,IR\n" + "\n".join(rows))
    sensor = analysis(path)
    assert sensor["color_error_mean"] is None
    assert sensor["color"]["snr_db"]["Y"] is None
    assert sensor["price_db"] is None
    assert any("no valid Y" in note for note in sensor["notes"])
    done("analyze", path)


def test_a_negative_luminance_has_no_snr_and_says_so(analysis):
    sensor = analysis("onyx-rgbw", "--illuminant", "LED660", "--time-ms", 2)
    assert sensor["color"]["mean_lux"]["Y"] < 0
    assert sensor["color"]["snr_db"]["Y"] is None
    luminance = f"{sensor['color']['mean_lux']['Y']:.2g}"
    assert any("Y" in note and luminance in note for note in sensor["notes"])


@pytest.mark.parametrize("offset_nm", [0.0, 1.0, 2.5])
def test_a_narrow_band_counts_by_its_area_wherever_it_stands(analysis, tmp_path, offset_nm):
    at = np.arange(400, 1050.05, 0.1)
    band = 0.5 * np.exp(-(((at - 550 - offset_nm) / 0.7) ** 2))
    path = tmp_path / "line.csv"
    path.write_text(
        "wavelength_nm,L\n" + "\n".join(f"{w:.1f},{v:.6f}" for w, v in zip(at, band, strict=True))
    )
    electrons = analysis(path, "--time-ms", 12)["channels"][0]["mean_e"]
    # area 0.5 * 0.7 * sqrt(pi) nm of photons at 10 lx, 12 ms, f/1.8, 10 um
    photons = 1.37017e-5 * (550 + offset_nm) * 1e-9 / 1.98644586e-25 * 1e-12
    expected = 10 * 0.012 * 100 / (4 * 1.8**2) * photons * 0.5 * 0.7 * np.sqrt(np.pi)
    assert electrons == pytest.approx(expected, rel=5e-3)


def test_json_on_standard_output_stays_json_when_figures_are_written_too(
    run, tmp_path, monkeypatch
):
    monkeypatch.setattr("chromanoise.cli.demo.paper_figures", lambda *_: {"one": Figure()})
    code, out, err = run("reproduce", "--draws", 10, "--json", "-", "--out", tmp_path / "figures")
    assert code == 0
    assert json.loads(out)["draws"] == 10
    assert "figures 1-10" in err
    assert (tmp_path / "figures" / "one.svg").exists()


def test_json_follows_a_link_and_leaves_it_a_link(run, tmp_path):
    target, link = tmp_path / "target.json", tmp_path / "link.json"
    target.write_text("old")
    link.symlink_to(target)
    assert run("analyze", "model-mono", "--json", link)[0] == 0
    assert link.is_symlink()
    assert json.loads(target.read_text())["sensors"]


def test_json_to_a_device_goes_into_the_device(run):
    if not Path("/dev/full").is_char_device():
        pytest.skip("this system has no /dev/full")
    refused(run("analyze", "model-mono", "--json", "/dev/full"), "/dev/full")
    assert Path("/dev/full").is_char_device()


@pytest.mark.parametrize("lux", [1e-6, 1e-3, 1e6, 1e9])
def test_extreme_light_is_an_answer(result_of, lux):
    assert result_of("analyze", "onyx-rgbw", "--lux", lux, "--time-ms", 12)["level_lux"] == lux


def test_a_file_named_like_an_illuminant_does_not_hide_it(run, tmp_path, monkeypatch):
    (tmp_path / "E").write_text("nonsense")
    monkeypatch.chdir(tmp_path)
    assert run("analyze", "model-mono")[0] == 0


def test_a_diode_with_its_width_can_be_named(run):
    assert run("analyze", "model-mono", "--illuminant", "LED550/30")[0] == 0


def test_an_illuminant_that_ends_short_has_its_own_answer(analysis):
    light = ("--illuminant", "D65", "--illuminant-beyond", "zero")
    notes = analysis("model-mono", *light)["notes"]
    assert any("zero beyond 300-780 nm" in note for note in notes)


def test_the_camera_equation_is_a_third_of_a_decibel_darker(analysis):
    electrons = [
        analysis("model-mono", "--time-ms", 5, *more)["channels"][0]["mean_e"]
        for more in ((), ("--magnification", 0))
    ]
    assert electrons[1] / electrons[0] == pytest.approx(12.96 / 13.96, rel=1e-12)


def test_the_budget_of_each_color_adds_up_to_its_snr(analysis, done):
    sensor = analysis("onyx-rgbw", "--budget")
    for budget in sensor["budget"]:
        lost = sum(cost["cost_db"] for cost in budget["costs"])
        assert budget["photons_db"] - lost == pytest.approx(budget["snr_db"], abs=1e-9)
        assert budget["snr_db"] == pytest.approx(
            sensor["color"]["snr_db"][budget["coordinate"]], abs=1e-9
        )
    assert "correlation" in done("analyze", "onyx-rgbw", "--budget")[0]


def test_a_saturated_sensor_has_no_budget_and_says_so(analysis, done):
    arguments = ("onyx-rgbw", "--budget", "--lux", 1e5, "--time-ms", 12)
    assert analysis(*arguments)["budget"] == [None, None, None]
    assert "saturated" in done("analyze", *arguments)[0]


def test_compare_tells_curves_and_crossovers_with_the_digits_of_analyze(result_of, analysis, done):
    arguments = ("compare", "onyx-rgbw", "onyx-rgb-ircut", "--time-ms", 5, "--points", 3)
    data = result_of(*arguments, "--sweep", "lux=0.1:10")
    assert data["sweep"]["values"] == pytest.approx([0.1, 1.0, 10.0])
    direct = analysis("onyx-rgbw", "--time-ms", 5, "--lux", 10)
    assert data["curves"][0]["value"][-1] == pytest.approx(direct["color"]["snr_db"]["Y"], abs=1e-9)
    assert data["curves"][0]["color_error"][0] == pytest.approx(direct["color_error_mean"])
    assert data["crossovers"][0]["at"] == []
    assert "SNR of Y" in done(*arguments)[0]


def test_gray_noise_in_lab_is_told_with_first_order_beside_it(analysis, done):
    grey = analysis("onyx-rgb-ircut", "--space", "lab")["gray_noise"]
    assert grey["space"] == "CIELAB"
    assert grey["mean"]["L*"] == pytest.approx(49.5, abs=0.2)  # 18 % gray: 116 * .18^(1/3) - 16
    assert grey["sd"]["L*"] == pytest.approx(grey["sd_first_order"]["L*"], rel=0.05)
    assert grey["first_order_holds"] is True
    both = done("analyze", "onyx-rgb-ircut", "onyx-rgbw", "--space", "lab")
    assert "18 % gray" in both[0]


def test_where_the_first_order_fails_it_says_so(run):
    _, out, _ = run("analyze", "onyx-rgbw", "--space", "lab", "--lux", 0.3, "--time-ms", 12)
    assert "5 %" in out


def test_a_saturated_sensor_has_no_gray_noise(analysis, done):
    arguments = ("onyx-rgbw", "--space", "luv", "--lux", 1e5, "--time-ms", 12)
    assert analysis(*arguments)["gray_noise"] is None
    done("analyze", *arguments)


def test_clipping_flatters_white_and_luminance_and_says_so(analysis):
    """At 99 % of full well 15.9 % of W is held: Monte Carlo gives +1.25 dB on W, +0.43 on Y."""
    values = [analysis("onyx-rgbw", *more) for more in ((), ("--clip",))]
    white = [next(c for c in t["channels"] if c["name"] == "W") for t in values]
    assert white[1]["full_share"] == pytest.approx(0.1587, abs=2e-4)
    assert white[1]["snr_db"] - white[0]["snr_db"] == pytest.approx(1.25, abs=0.02)
    luminance = [t["color"]["snr_db"]["Y"] for t in values]
    assert luminance[1] - luminance[0] == pytest.approx(0.43, abs=0.02)
    assert any("SNR are too high" in note for note in values[1]["notes"])


def test_a_readout_held_whole_at_full_well_is_saturated_and_nothing_more(analysis, done):
    arguments = ("onyx-rgbw", "--clip", "--time-ms", 100)
    sensor = analysis(*arguments)
    assert sensor["bound_db"] is None
    assert all(c["saturated"] and c["full_share"] == 1 for c in sensor["channels"])
    done("analyze", *arguments)


@pytest.mark.evidence
def test_analyze_takes_another_matrix_and_tells_every_patch_of_the_chart(analysis, done):
    arguments, lmmse = ("onyx-rgbw", "--lux", 1, "--time-ms", 12), ("--matrix", "lmmse")
    values = [
        analysis(*arguments, *more) for more in (("--chart",), lmmse, (*lmmse, "--prior", "chart"))
    ]
    assert ["LMMSE" in sensor["matrix_made_by"] for sensor in values] == [False, True, True]
    assert len({sensor["color"]["snr_db"]["Y"] for sensor in values}) == 3
    assert len(values[0]["chart"]) == 24
    errors = [patch["color_error"] for patch in values[0]["chart"]]
    assert sum(errors) / 24 == pytest.approx(values[0]["color_error_mean"])
    assert "neutral 6.5" in done("analyze", *arguments, "--chart")[0]


@pytest.mark.evidence
def test_compare_tells_the_band_over_priors(result_of, done):
    arguments = ("compare", "onyx-rgbw", "onyx-rgb-ircut", "--matrix", "lmmse", "--points", 9)
    arguments = (*arguments, "--sweep", "lux=0.05:5", "--prior", "all")
    data = result_of(*arguments)
    (band,) = data["bands"]
    assert len(band["by_prior"]) == 5
    assert band["span"][0] <= data["crossovers"][0]["at"][0] <= band["span"][1]
    assert "5 priors" in done(*arguments)[0]


def test_compare_on_equal_terms_gives_each_its_time(result_of):
    sensors = ("model-rgb-ircut", "model-rgbw-ircut", "model-three-layer")
    times = {}
    for equal in ("exposure", "saturation", "light"):
        data = result_of("compare", *sensors, "--equal", equal, "--points", 2)
        times[equal] = [curve["time_ms"] for curve in data["curves"]]
    assert len(set(times["exposure"])) == 1
    assert min(times["saturation"]) == pytest.approx(times["exposure"][0])
    assert times["light"][2] == pytest.approx(3 * times["light"][0])


@pytest.mark.parametrize(
    ("command", "function"),
    [("analyze", "analyze"), ("compare", "compare"), ("matrix", "matrix"), ("simulate", "render")],
)
def test_the_help_shows_the_defaults_of_the_study(run, command, function):
    shown = " ".join(run(command, "--help-all")[1].split())
    study = Study.model_validate({"sensors": [{"name": "x"}]})
    assert f"Illuminance [lx]. [default: {study.light.level_lux:g}]" in shown
    assert f"f-number of the lens. [default: {study.exposure.f_number:g}]" in shown
    assert f"[default: {study.exposure.equal}]" in shown
    assert default_of(function, "saturate") == study.exposure.saturate


@pytest.mark.parametrize(
    ("command", "function"),
    [
        *(("analyze", "analyze"), ("compare", "compare"), ("denoise", "denoise")),
        *(("matrix", "matrix"), ("simulate", "render")),
    ],
)
def test_every_setting_is_an_option_or_a_part_of_one(command, function):
    options = {one.name: one for one in commands.get_command(Context(commands), command).params}
    assert all(name in options or interface_of(name).part for name in FUNCTIONS[function])
    for name in ("ircut_nm", "shift_nm"):
        assert options[name].opts == [f"--{name.replace('_', '-')}"]
        described = next(one for one in described_settings(function) if one.name == name)
        assert options[name].help.startswith(described.of.field.description)


def test_an_added_ir_cut_and_a_shift_change_the_sensor(analysis):
    cut = ("--ircut-nm", 680, "--shift-nm", -5)
    one = analysis("onyx-rgb", *cut, "--time-ms", 5)
    sensor = behind_ir_cut(with_shifted_curves(sensor_named("onyx-rgb"), -5.0), 680.0)
    exposure = Exposure(time_s=5e-3, f_number=1.8)
    white = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
    assert [channel["mean_e"] for channel in one["channels"]] == pytest.approx(
        expected_electrons(white, sensor, exposure).tolist(), rel=1e-12
    )
