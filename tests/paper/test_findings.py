"""The sentences tell the numbers of the tables, and nothing else."""

import re
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.apps.design.objectives import OBJECTIVES, Candidate
from chromanoise.apps.paper import (
    RGB_12,
    RGBW_12,
    paper_study,
    paper_tables,
    reproduced,
    set_aside_reasons,
    table_5_finding,
    verdict,
)
from chromanoise.apps.paper.reproduction import nir_share
from chromanoise.metrics.budget import INFRARED
from chromanoise.spectra import cie_1931
from chromanoise.study import analyzed, coordinate_budget, matrix_makers


@pytest.fixture(scope="module")
def study():
    return paper_study()


@pytest.fixture(scope="module")
def cells(study):
    return {(c.table, c.row, c.column): c for c in reproduced(study, draws=100).cells}


def numbers(sentence):
    return [float(n) for n in re.findall(r"-?\d+\.\d+|\d+", sentence)]


def test_the_verdict_tells_the_differences_of_tables_2_and_3(study, cells):
    raw = sum(cells[2, c, RGBW_12].closed_form - cells[2, c, RGB_12].closed_form for c in "RGB")
    loss = cells[3, "SNR_Y", RGB_12].closed_form - cells[3, "SNR_Y", RGBW_12].closed_form
    sentence = verdict(study)
    assert f"{raw / 3:.1f} dB better in raw" in sentence
    assert f"{loss:.1f} dB worse in luminance" in sentence
    below = study.columns[RGBW_12].color_snr_loss_db
    assert f"is {below:.1f} dB below the best linear readout" in sentence


def paper_light(study, column):
    """Electrons by plain sums, all and of the visible alone; unit light is equal power.

    The scale is the paper's rule: 12 ms bring the white of RGBW to 99 % of 10,000 e-.
    """
    at, qe = (getattr(study.columns[column].sensor, what) for what in ("grid", "qe"))
    at = at.wavelength_nm
    white = study.columns[RGBW_12].sensor.qe
    per_step = at[:, None] * qe * 9_900 / (at @ white).max()
    return per_step.sum(axis=0), per_step[at <= 700].sum(axis=0)


def shares_by_orders(study, column):
    """What correlation and infrared cost in Y: the mean over all orders, the weights before.

    From the three rows of the docs of `chromanoise.metrics.budget`: D^-1 mu, h.f/|f|^2 and
    h.F G^-1, infrared as signal or as noise alone, with 10 e- of readout or none.
    """
    sensor = study.columns[column].sensor
    at, y = sensor.grid.wavelength_nm, cie_1931(sensor.grid).values[:, 1]
    every, visible = paper_light(study, column)
    one_by_one = (y / at) @ sensor.qe / (sensor.qe**2).sum(axis=0)
    unmixed = np.linalg.lstsq(sensor.qe, y / at, rcond=None)[0]

    def snr_db(on):
        variance = every + (100.0 if "read noise" in on else 0.0)
        row = unmixed if "correlation" in on else one_by_one
        row = row if "weights" in on else every / variance
        signal = row @ (visible if "infrared" in on else every)
        return 20 * np.log10(abs(signal)) - 10 * np.log10(row**2 @ variance)

    causes = ("read noise", "weights", "correlation", "infrared")
    orders = [o for o in permutations(causes) if o.index("weights") < o.index("correlation")]
    return {
        cause: np.mean(
            [snr_db(o[: o.index(cause)]) - snr_db(o[: o.index(cause) + 1]) for o in orders]
        )
        for cause in ("correlation", "infrared")
    }


def test_the_verdict_tells_the_share_of_infrared_electrons(study):
    every, visible = paper_light(study, RGBW_12)
    share = 100 * (1 - visible.sum() / every.sum())
    assert 20 < share < 80
    assert f"the {share:.0f} % of its electrons that come from beyond 700 nm" in verdict(study)
    assert nir_share(study.columns[RGBW_12]) == pytest.approx(share / 100, abs=1e-12)


def test_a_sensor_has_one_share_of_infrared_electrons_in_verdict_budget_and_search(study):
    """Of one channel, where the worst channel is all channels; 700 nm itself is visible."""
    at = study.columns[RGBW_12].sensor.grid.wavelength_nm
    qe = study.columns[RGBW_12].sensor.qe[:, 0]
    share = 1 - at[at <= 700] @ qe[at <= 700] / (at @ qe)
    (analysis,) = cn.analyze("onyx-rgbw", lux=10, time_ms=12).analyses
    red = replace(analysis.sensor, qe=qe[:, None], names=("R",), mosaic=None)
    alone = analyzed(analysis.scene, red, analysis.exposure)
    budget = coordinate_budget(alone, "Y")
    (reading,) = [cost.reading for cost in budget.costs if cost.cause == INFRARED]
    maker = matrix_makers(["kernel"], "quanta")["kernel"]
    candidate = Candidate(point=alone.point, matrix=alone.matrix, maker=maker)
    found = OBJECTIVES["infrared_share"].of(candidate)
    assert nir_share(alone) == pytest.approx(share, abs=1e-12)
    assert found == pytest.approx(share, abs=1e-12)
    assert reading.startswith(f"{100 * share:.0f} % ")


def test_the_verdict_tells_what_correlation_and_infrared_cost_over_all_orders(study):
    bare, cut = (shares_by_orders(study, c) for c in (RGBW_12, RGB_12))
    sentence = verdict(study)
    correlation = f"{bare['correlation']:.1f} dB ({cut['correlation']:.1f} dB behind the IR-cut)"
    assert f"unmixing its correlated channels costs {correlation}" in sentence
    assert f"carry no color cost {bare['infrared']:.1f} dB ({cut['infrared']:.1f} dB)" in sentence


def test_the_verdict_tells_what_each_sensor_keeps_of_its_raw_channels(study):
    """The sum of the squared raw SNRs over the SNR of Y, from Tables 2 and 3 as printed."""
    result = re.search(
        r"([\d.]+) dB below the best linear readout, that of the RGB sensor ([\d.]+) dB",
        verdict(study),
    )
    printed = (([38.1, 36.8, 36.4, 39.9], 26.1), ([32.6, 32.8, 32.6], 32.4))
    for number, (raw, y) in zip(result.groups(), printed, strict=True):
        bound = 10 * np.log10(sum(10 ** (db / 10) for db in raw))
        assert float(number) == pytest.approx(bound - y, abs=0.3)


def test_the_finding_on_table_5_tells_the_share_within_reach(study):
    # cos^2 of the printed angles 50.7 and 18.1 degrees
    assert {40.1, 90.3} <= set(numbers(table_5_finding(study)))


def test_the_finding_on_table_5_tells_the_error_bar_of_5000_draws(study):
    """0.087 dB (docs/numbers.md), and that is how runs of draws scatter, as 1 / sqrt(draws)."""
    result = re.search(r"Monte Carlo error of ([\d.]+) dB", table_5_finding(study))
    assert result.group(1) == "0.09"
    draws = np.random.default_rng(5).normal(100.0, 1.0, (2000, 500))
    runs = 20 * np.log10(draws.mean(axis=1) / draws.std(axis=1, ddof=1))
    spread = runs.std(ddof=1) * np.sqrt(500 / 5000)  # runs of 500 draws
    z = (spread - 0.087) / (0.087 / np.sqrt(2 * 2000))
    assert abs(z) < 5


def test_the_sensor_without_ir_cut_is_set_aside_for_color_and_the_other_for_noise(study):
    color, noise = set_aside_reasons(study)
    assert color.startswith("onyx-rgb:")
    assert "false color" in color
    assert noise.startswith("onyx-rgbw-ircut: W is")
    assert "singular" in noise


def test_the_layout_keeps_every_cell_and_leaves_what_the_paper_does_not_print_empty(study):
    result = reproduced(study, draws=100)
    tables = paper_tables(result)
    laid_out = [c for t in tables for _, row in t.rows for c in row if c is not None]
    assert len(laid_out) == len(result.cells)
    assert set(map(id, laid_out)) == set(map(id, result.cells))
    white = dict(tables[0].rows)["W"]
    assert [cell is None for cell in white] == [False, True, True]
