"""The reconstructed sensors return the paper's figures, and the tool returns the sensors."""

import os
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy import stats

from chromanoise.apps.paper import (
    PaperStudy,
    Reproduction,
    paper_study,
    printed_numbers as paper,
    reproduced,
)
from chromanoise.spectra.tables import packaged_table

REPOSITORY = Path(__file__).parents[2]
TOOLS = REPOSITORY / "tools"
DRAWS = 10**5
SAME_CURVES = 2e-4  # e-/photon: two runs of the fit on two machines


@pytest.fixture(scope="module")
def study() -> PaperStudy:
    return paper_study()


@pytest.fixture(scope="module")
def reproduction(study: PaperStudy) -> Reproduction:
    return reproduced(study, draws=DRAWS, seed=2019)


@pytest.fixture(scope="module")
def packaged_qe() -> np.ndarray:
    return packaged_table("onyx_reconstruction").values


@pytest.fixture(scope="module")
def packaged_cut() -> np.ndarray:
    return packaged_table("onyx_ir_cut").values[:, 0]


# the curves and the paper's figures


def test_every_printed_db_of_tables_2_to_4_is_met_within_0_3_db(reproduction):
    cells = [cell for cell in reproduction.cells if cell.table in (2, 3, 4)]
    assert len(cells) == 23
    for cell in cells:
        assert cell.closed_form == pytest.approx(cell.paper, abs=0.3), cell


def test_both_angles_of_table_5_are_met_within_0_1_degree(study):
    ours = {name: green.to_axes_deg[0, 1] for name, green in study.greens.items()}
    assert ours == pytest.approx({"G_n": 50.7, "G": 18.1}, abs=0.1)


def test_solved_times_are_12_and_59_ms(study):
    assert round(1e3 * study.times_s["onyx-rgbw"]) == 12
    assert round(1e3 * study.times_s["onyx-rgb-ircut"]) == 59


def test_white_is_the_most_sensitive_channel_without_ir_cut(study):
    rgbw = study.columns[paper.RGBW_12]
    assert rgbw.sensor.names[rgbw.raw.mean.argmax()] == "W"
    assert rgbw.raw.mean.max() == pytest.approx(9900, rel=1e-12)


def test_red_is_the_most_sensitive_channel_behind_the_ir_cut(study):
    rgb = study.columns[paper.RGB_59]
    assert rgb.sensor.names[rgb.raw.mean.argmax()] == "R"
    assert rgb.raw.mean.max() == pytest.approx(9900, rel=1e-12)


def test_no_filter_passes_more_than_the_bare_pixel(packaged_qe, packaged_cut):
    assert packaged_table("onyx_reconstruction").names == ("R", "G", "B", "W")
    assert np.all(packaged_qe > 0)
    assert np.all(packaged_qe[:, :3] < packaged_qe[:, 3:])
    assert np.all((packaged_cut >= 0) & (packaged_cut <= 1))


# sampling agrees with the closed form


def test_a_hundred_thousand_draws_agree_with_the_closed_form_in_every_cell(reproduction):
    sampled = [cell for cell in reproduction.cells if cell.monte_carlo is not None]
    assert len(sampled) == 23 + 4  # Tables 2-4, and SNR_raw and SNR_y of Table 5
    for cell in sampled:
        z = (cell.monte_carlo - cell.closed_form) / cell.monte_carlo_se
        assert abs(z) < 5, (z, cell)
        assert cell.monte_carlo_se < 0.05, cell  # so that 5 of them still mean something


def test_one_channel_has_the_same_snr_in_y_as_in_raw_at_any_angle(reproduction):
    rows = {(cell.row, cell.column): cell for cell in reproduction.cells if cell.table == 5}
    for column in (paper.G_N, paper.G):
        raw, luminance = rows["SNR_raw", column], rows["SNR_y", column]
        assert luminance.closed_form - raw.closed_form == pytest.approx(0, abs=1e-9)
        assert luminance.monte_carlo - raw.monte_carlo == pytest.approx(0, abs=1e-9)


def test_at_99_percent_of_full_well_15_9_percent_of_the_draws_of_white_clip(study):
    electrons = np.arange(9000, 11000)  # ten sigma about the mean of W
    expected = float(
        stats.poisson.pmf(electrons, 9900) @ stats.norm.sf(10_000, electrons, scale=10)
    )
    assert round(100 * expected, 1) == 15.9
    clipped = reproduced(study, draws=DRAWS, seed=2019, clip=True)
    (white,) = [c for c in clipped.cells if (c.quantity, c.row) == ("raw SNR", "W")]
    sigma = np.sqrt(expected * (1 - expected) / DRAWS)
    assert white.clipped_share == pytest.approx(expected, abs=5 * sigma)


# the tool and the curves


@pytest.fixture(scope="module")
def tool() -> Iterator[ModuleType]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(TOOLS))
        yield import_module("onyx_reconstruction.fit")


@pytest.fixture(scope="module")
def packaged_curves(tool, packaged_qe, packaged_cut):
    """The packaged tables as the tool's `Curves`."""
    white = packaged_qe[:, 3]
    transmittance = packaged_qe[:, :3] / white[:, None]
    return tool.Curves(
        filter_logit=np.log(transmittance / (1 - transmittance)),
        white_logit=np.log(white / (1 - white)),
        cut=_edge_and_width_nm(packaged_cut),
    )


def _edge_and_width_nm(transmittance: np.ndarray) -> np.ndarray:
    """Where a falling edge passes 50 %, and the way from 90 to 10 %, off its straight logit."""
    wavelength = packaged_table("onyx_ir_cut").wavelength_nm
    steep = (transmittance > 0.02) & (transmittance < 0.98)
    logits = np.log(transmittance[steep] / (1 - transmittance[steep]))
    slope, offset = np.polyfit(wavelength[steep], logits, 1)
    return np.array([-offset / slope, -2 * np.log(9) / slope])


@pytest.fixture(scope="module")
def refitted(tool, packaged_curves):
    return tool.fitted(tool.parameters_near(packaged_curves))


def test_the_tool_predicts_from_the_packaged_curves_what_the_study_says(
    tool, packaged_curves, study, reproduction
):
    prediction = tool.predicted(packaged_curves)
    closed_form = {
        (cell.quantity.removesuffix(" SNR"), cell.row.removeprefix("M^"), cell.column): cell
        for cell in reproduction.cells
    }
    for printed, misfit_db in zip(tool.PRINTED_SNRS, tool.misfits_db(prediction), strict=True):
        kind = {"XYZ": "Y"}.get(printed.kind, printed.kind)
        row = {"Y": "SNR_Y"}.get(printed.coordinate, printed.coordinate)
        cell = closed_form[kind, row, printed.column]
        assert misfit_db == pytest.approx(cell.closed_form - cell.paper, abs=1e-3)
    for sensor, time_ms in prediction.times_ms.items():
        assert time_ms == pytest.approx(1e3 * study.times_s[sensor], rel=1e-5)
    for column, angle_deg in prediction.angles_deg.items():
        assert angle_deg == pytest.approx(study.greens[column].to_axes_deg[0, 1], abs=1e-3)


def test_the_packaged_curves_are_where_the_tool_would_stay(
    tool, packaged_qe, packaged_cut, packaged_curves, refitted
):
    packaged_cost = 0.5 * np.sum(tool.residuals(tool.parameters_near(packaged_curves)) ** 2)
    assert packaged_cost == pytest.approx(refitted.cost, rel=1e-3)
    _assert_same_curves(tool, refitted, packaged_qe, packaged_cut)


@pytest.mark.evidence
def test_the_same_start_gives_the_same_bytes(tool):
    first, again = (tool.fitted(tool.start(1), most_evaluations=2) for _ in range(2))
    assert first.parameters.tobytes() == again.parameters.tobytes()
    assert first.parameters.tobytes() != tool.start(1).tobytes()


@pytest.mark.evidence
@pytest.mark.parametrize("number", [0, 1])
def test_the_priors_lead_to_the_packaged_curves(tool, packaged_qe, packaged_cut, number):
    _assert_same_curves(tool, tool.fitted(tool.start(number)), packaged_qe, packaged_cut)


@pytest.mark.evidence
def test_a_second_family_of_curves_meets_every_figure_as_well(tool, refitted, packaged_qe):
    second = tool.fitted(tool.start(3))
    curves = tool.curves_of(second.parameters)
    prediction = tool.predicted(curves)
    assert np.abs(tool.misfits_db(prediction)).max() < 0.3
    assert prediction.angles_deg == pytest.approx({"G_n": 50.7, "G": 18.1}, abs=0.1)
    assert {name: round(ms) for name, ms in prediction.times_ms.items()} == {
        "onyx-rgbw": 12,
        "onyx-rgb-ircut": 59,
    }
    assert np.abs(tool.rgbw_qe(curves) - packaged_qe).max() > 0.1
    assert second.cost > 1.2 * refitted.cost  # the priors tell them apart


@pytest.mark.evidence
def test_the_tool_writes_the_packaged_tables_and_the_same_bytes_each_time(tmp_path):
    folders = [tmp_path / "first", tmp_path / "again"]
    for folder in folders:
        command = [sys.executable, str(TOOLS / "reconstruct_onyx.py"), "--out", str(folder)]
        subprocess.run(command, check=True, capture_output=True, env=_with_this_chromanoise())
    for name in ("onyx_reconstruction", "onyx_ir_cut"):
        first, again = (folder / f"{name}.csv" for folder in folders)
        assert first.read_bytes() == again.read_bytes()
        written, packaged = np.loadtxt(first, delimiter=",", skiprows=1), packaged_table(name)
        assert written[:, 0] == pytest.approx(packaged.wavelength_nm)
        assert written[:, 1:] == pytest.approx(packaged.values, abs=SAME_CURVES)
        assert first.read_text().splitlines()[0].split(",")[1:] == list(packaged.names)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["again", "first"]  # no scratch


def _assert_same_curves(tool, fit, packaged_qe, packaged_cut) -> None:
    curves = tool.curves_of(fit.parameters)
    assert tool.rgbw_qe(curves) == pytest.approx(packaged_qe, abs=SAME_CURVES)
    assert tool.ir_cut(curves) == pytest.approx(packaged_cut, abs=SAME_CURVES)


def _with_this_chromanoise() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(REPOSITORY / "src"), "PYTHONDONTWRITEBYTECODE": "1"}
