"""Own reflectances as chart, as prior of trained matrices, and as the patch that is analyzed."""

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.spectra import DEFAULT_GRID, colorchecker
from chromanoise.study import study_from_data, study_from_text
from chromanoise.study.hashes import study_hash
from outcomes import refused, refused_input

LIGHT = {"lux": 100.0, "time_ms": 1.2}


def table(curves, names, last_nm=1050):
    """Curves as CSV text, 5 nm."""
    nm = DEFAULT_GRID.wavelength_nm
    rows = [["wavelength_nm", *names]]
    rows += [[f"{at:g}", *map(repr, map(float, row))] for at, row in zip(nm, curves, strict=True)]
    kept = [row for row in rows[1:] if float(row[0]) <= last_nm]
    return "\n".join(",".join(row) for row in [rows[0], *kept]) + "\n"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with the ColorChecker, two of its patches, and curves that end at 700 nm."""
    monkeypatch.chdir(tmp_path)
    chart = colorchecker(DEFAULT_GRID)
    (tmp_path / "chart.csv").write_text(table(chart.values, chart.names))
    (tmp_path / "two.csv").write_text(table(chart.values[:, [3, 14]], ("leaf", "red")))
    (tmp_path / "short.csv").write_text(table(chart.values[:, [0]], ("skin",), last_nm=700))
    (tmp_path / "percent.csv").write_text(table(900 * chart.values[:, [0]], ("skin",)))
    (tmp_path / "negative.csv").write_text(table(chart.values[:, [0]] - 0.9, ("skin",)))
    lamp = table(chart.values[:, [0]], ("lamp",))
    (tmp_path / "lamp.csv").write_text("# quantity: power\n" + lamp)
    return tmp_path


def analyzed(**settings):
    (sensor,) = cn.analyze("model-rgb-ircut", **LIGHT, **settings).to_dict()["sensors"]
    return sensor


@pytest.mark.evidence
def test_the_colorchecker_in_a_file_gives_the_results_of_the_built_in_one(here):
    own, built_in = analyzed(chart=True, chart_file="chart.csv"), analyzed(chart=True)
    for mine, theirs in zip(own["chart"], built_in["chart"], strict=True):
        assert mine["patch"] == theirs["patch"]
        for name in ("color_error", "ciede2000", "snr_y_db", "noise_delta_e"):
            assert mine[name] == pytest.approx(theirs[name], abs=1e-9)
    errors = [one["color"]["total_error_delta_e"] for one in (own, built_in)]
    assert errors[0] == pytest.approx(errors[1], abs=1e-9)


@pytest.mark.evidence
def test_a_chart_of_two_curves_has_the_errors_of_these_two_patches(here):
    own = analyzed(chart=True, chart_file=here / "two.csv")
    both = [analyzed(chart=True)["chart"][i] for i in (3, 14)]
    assert [one["patch"] for one in own["chart"]] == ["leaf", "red"]
    errors = [one["color_error"] for one in both]
    assert [one["color_error"] for one in own["chart"]] == pytest.approx(errors, abs=1e-9)
    assert own["color_error_mean"] == pytest.approx(np.mean(errors), abs=1e-9)
    assert any("two.csv" in note for note in own["notes"])


def test_comparisons_and_matrices_have_the_errors_over_the_own_chart(here):
    own = analyzed(chart_file="two.csv")
    swept = cn.compare(
        "model-rgb-ircut", chart_file="two.csv", vary="lux", first=100.0, last=200.0, points=2,
        quantity="total-error", time_ms=1.2,
    ).to_dict()["curves"][0]  # fmt: skip
    assert swept["value"][0] == pytest.approx(own["color"]["total_error_delta_e"], abs=1e-9)
    assert swept["color_error"][0] == pytest.approx(own["color_error_mean"], abs=1e-9)
    one = cn.matrix("model-rgb-ircut", chart_file="two.csv", **LIGHT)
    assert one.report.color_error_mean == pytest.approx(own["color_error_mean"], abs=1e-9)


@pytest.mark.parametrize("matrix", ["least-squares", "lmmse", "ridge=0.01"])
def test_the_colorchecker_in_a_file_trains_the_matrix_of_the_prior_chart(here, matrix):
    own, built_in = (analyzed(matrix=matrix, prior=p)["matrix"] for p in ("chart.csv", "chart"))
    np.testing.assert_allclose(own, built_in, rtol=1e-9, atol=1e-12)
    assert not np.allclose(own, analyzed(matrix=matrix, prior="two.csv")["matrix"], rtol=1e-3)


def test_the_pareto_curve_of_a_prior_in_a_file_is_that_of_the_prior_chart(here):
    curves = []
    for prior in ("chart.csv", "chart"):
        asked = {"pareto_first": 0.1, "pareto_last": 10.0, "pareto_points": 3, "prior": prior}
        one = cn.matrix("model-rgb-ircut", "lmmse", **LIGHT, **asked)
        curves.append(one.pareto.noise_rms)
    np.testing.assert_allclose(*curves, rtol=1e-9)


def test_an_18_percent_gray_has_the_electrons_and_the_noise_of_eq_7():
    white, gray = analyzed(), analyzed(patch=0.18)
    for full, own in zip(white["channels"], gray["channels"], strict=True):
        mean = 0.18 * full["mean_e"]
        assert own["mean_e"] == pytest.approx(mean)
        assert own["snr_db"] == pytest.approx(20 * np.log10(mean / np.sqrt(mean + 100)))
    # color of the gray: the matrix of the white, applied to its electrons
    assert gray["matrix"] == white["matrix"]
    assert gray["color"]["mean_lux"]["Y"] == pytest.approx(0.18 * white["color"]["mean_lux"]["Y"])


@pytest.mark.evidence
def test_a_patch_leaves_the_chart_as_it_is():
    white, gray = analyzed(chart=True, space="lab"), analyzed(chart=True, space="lab", patch=0.18)
    for name in ("chart", "color_error_mean", "gray_noise"):
        assert gray[name] == white[name]
    assert gray["color"]["total_error_delta_e"] == white["color"]["total_error_delta_e"]
    assert gray["color"]["snr_db"]["Y"] < white["color"]["snr_db"]["Y"]


def test_the_patch_one_is_a_perfect_white():
    one, white = analyzed(patch=1, budget=True), analyzed(budget=True)
    for name in ("channels", "color", "budget", "matrix", "bound_db"):
        assert one[name] == white[name]


def test_a_patch_is_named_in_the_colorchecker_or_in_a_file(here):
    ours = [analyzed(patch=name) for name in ("red", "two.csv:red", here / "chart.csv:red")]
    for one in ours[1:]:
        assert one["channels"][0]["mean_e"] == pytest.approx(ours[0]["channels"][0]["mean_e"])
    assert analyzed(patch="lawn")["channels"][0]["mean_e"] > 0
    gray = analyzed(patch="gray-18")["channels"][0]["mean_e"]
    assert gray == pytest.approx(analyzed(patch=0.18)["channels"][0]["mean_e"])


def test_a_comparison_and_a_matrix_report_the_snr_of_the_patch(here):
    wanted = analyzed(patch="red")["color"]["snr_db"]["Y"]
    asked = {"vary": "lux", "first": 50.0, "last": 100.0, "points": 2, "time_ms": 1.2}
    swept = cn.compare("model-rgb-ircut", patch="red", **asked).to_dict()["curves"][0]
    assert swept["value"][-1] == pytest.approx(wanted, abs=1e-9)
    timed = {**asked, "vary": "time-ms", "first": 0.6, "last": 1.2, "lux": 100.0, "time_ms": None}
    swept = cn.compare("model-rgb-ircut", patch="red", **timed).to_dict()["curves"][0]
    assert swept["value"][-1] == pytest.approx(wanted, abs=1e-9)
    one = cn.matrix("model-rgb-ircut", patch="red", **LIGHT)
    assert one.report.snr_db["Y"] == pytest.approx(wanted, abs=1e-9)
    assert one.report.patch == "patch red"


def test_the_budget_of_a_patch_adds_up_to_its_snr():
    gray = analyzed(patch="red", budget=True)
    for one in filter(None, gray["budget"]):
        total = one["photons_db"] - sum(cost["cost_db"] for cost in one["costs"])
        assert one["snr_db"] == pytest.approx(total, abs=1e-9)
        assert one["snr_db"] == pytest.approx(gray["color"]["snr_db"][one["coordinate"]], abs=1e-9)


def test_reflectances_that_end_before_1050_nm_need_an_answer(here):
    for setting in ({"chart_file": "short.csv"}, {"patch": "short.csv"}):
        with refused_input(setting="beyond"):
            analyzed(**setting)
        held = analyzed(beyond="hold", **setting)
        assert any("short.csv" in note for note in held["notes"])
    with refused_input(setting="beyond"):
        analyzed(matrix="lmmse", prior="short.csv")
    assert analyzed(reflectance_beyond="zero", patch="short.csv")["channels"]


@pytest.mark.parametrize(
    "options",
    [
        ("--chart-file", "missing.csv"),
        ("--chart-file", "percent.csv"),
        ("--chart-file", "negative.csv"),
        ("--chart-file", "lamp.csv"),
        ("--patch", "two.csv"),
        ("--patch", "two.csv:blue"),
        ("--patch", "no such patch"),
        ("--patch", "missing.csv:red"),
        ("--prior", "missing.csv", "--matrix", "lmmse"),
        ("--prior", "chrat", "--matrix", "lmmse"),
        ("--prior", "chart.csv"),
        ("--reflectance-beyond", "hold"),
    ],
)
def test_reflectances_that_cannot_be_used_are_refused_in_one_sentence(run, here, options):
    outcome = run("analyze", "model-rgb", *options)
    refused(outcome)
    assert len(outcome[2].splitlines()) == 1


def test_the_hash_of_a_study_depends_on_the_content_of_its_reflectances(here):
    data = {"sensors": [{"name": "onyx-rgbw"}], "matrices": ["lmmse"]}
    for more in (
        {"reflectances": {"chart": "two.csv"}},
        {"reflectances": {"patch": "two.csv:red"}},
        {"prior": "two.csv"},
    ):
        study = study_from_data(data | more, source="")
        before = study_hash(study)
        text = (here / "two.csv").read_text()
        (here / "two.csv").write_text(text + "\n")
        assert study_hash(study) != before
        (here / "two.csv").write_text(text)
        assert study_hash(study) == before


def test_files_of_a_study_are_beside_it(here):
    folder = here / "inner"
    folder.mkdir()
    (folder / "own.csv").write_text((here / "two.csv").read_text())
    (folder / "s.toml").write_text(
        '[[sensors]]\nname = "model-rgb"\n'
        '[reflectances]\nchart = "own.csv"\npatch = "own.csv:red"\n'
    )
    study = cn.read_study("inner/s.toml")
    assert study.reflectances.chart == "inner/own.csv"
    assert cn.run(study).analyses["kernel"].to_dict()["sensors"]


def test_commands_copied_as_a_study_keep_the_reflectances(done, here):
    asked = ("analyze", "model-rgb", "--chart-file", "two.csv", "--patch", "0.5")
    toml, _ = done(*asked, "--copy-as", "toml")
    own = study_from_text(toml, source="").reflectances
    assert (own.chart, own.patch) == ("two.csv", 0.5)


@pytest.mark.evidence
def test_a_patch_changes_no_number_of_the_camera_pipeline():
    (white,) = cn.analyze("onyx-rgb-ircut", time_ms=12, pipeline=True).to_dict()["sensors"]
    settings = {"time_ms": 12, "pipeline": True, "patch": 0.18}
    (gray,) = cn.analyze("onyx-rgb-ircut", **settings).to_dict()["sensors"]
    assert gray["pipeline"] == white["pipeline"]
