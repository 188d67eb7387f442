"""Optima of small designs that are known from theorems, from print, or from a full grid."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.apps.design.evaluation import DesignScene, Objectives
from chromanoise.apps.design.parameters import Candidates
from chromanoise.apps.design.pareto_front import Evaluated, Problem
from chromanoise.apps.design.search import SearchOptions, searched_front
from chromanoise.noise import Exposure
from chromanoise.sensor import ir_cut, resin_filter, silicon_qe, with_pixel
from chromanoise.spectra import DEFAULT_GRID, cie_1931
from chromanoise.study import sensor_named
from strategies import point_of

NM = DEFAULT_GRID.wavelength_nm
SILICON = silicon_qe(DEFAULT_GRID, depth_um=4.0)[:, None]
TIME_MS = 11.94  # the paper's, of docs/findings.md


def evaluator(objective, *, lux, matrix, **pixel):
    """One scene of illuminant E without a full well, so that light alone changes the optimum."""
    sensor = with_pixel(sensor_named("model-mono"), {"full_well_e": 1e12, **pixel})
    point = point_of(sensor, lux, exposure=Exposure(time_s=1e-3 * TIME_MS, f_number=1.8))
    return Objectives(scenes=(DesignScene(point=point, matrix=matrix),), objectives=(objective,))


def best(judge, candidates, low, high, *, budget):
    """Values and objective of the optimum by differential evolution."""
    problem = Problem(
        names=tuple(f"x{i}" for i in range(len(low))),
        low=np.array(low, dtype=float),
        high=np.array(high, dtype=float),
        objectives=judge.objectives,
        better=tuple(one.better for one in judge.entries),
        evaluate=lambda x: Evaluated(
            objectives=judge.values(candidates(x)), violation=np.zeros((len(x), 0))
        ),
    )
    found = searched_front(
        problem,
        SearchOptions(method="de", budget=budget, population=40, seed=1, seeds=1, polish=False),
    )
    return found.values[0], float(found.objectives[0, 0])


def bells(x, height=0.9):
    """Three Gaussians: their centers, then their standard deviations or one for all. [nm]"""
    center, width = x[:, None, :3], x[:, None, 3:]
    return height * np.exp(-0.5 * ((NM[None, :, None] - center) / width) ** 2)


def with_edges(sensor, edges_nm):
    """The sensor of a name behind a model IR-cut, one candidate per edge."""
    qe = sensor_named(sensor).qe
    cuts = [ir_cut(DEFAULT_GRID, edge_nm=float(edge))[:, None] for edge in edges_nm]
    return Candidates(qe=np.stack([qe * cut for cut in cuts]))


def best_edge_nm(sensor, judge):
    edges_nm = np.arange(600.0, 901.0, 2.0)
    values = judge.values(with_edges(sensor, edges_nm))[:, 0]
    better = judge.entries[0].better
    return edges_nm[values.argmax() if better == "higher" else values.argmin()]


def test_three_gaussians_without_noise_reach_an_smi_of_99():
    # J. Kasson and J. Hogan, dpreview.com/forums/threads/4633418: 99.3 by three free Gaussians
    judge = evaluator("total_delta_e", lux=1e5, matrix="least-squares", read_noise_e=0.0)
    ends = ([570, 500, 420, 15, 15, 15], [640, 570, 480, 80, 80, 80])
    values, _ = best(judge, lambda x: Candidates(qe=bells(x)), *ends, budget=4000)
    (smi,) = replace(judge, objectives=("smi",)).values(Candidates(qe=bells(values[None])))[0]
    assert 99.0 <= smi < 100.0


def test_the_vora_value_is_what_the_best_mix_of_the_filters_leaves_of_an_orthonormal_basis():
    # Zhu & Finlayson, J. Imaging Sci. Technol. 64 (2020): Vora-optimal is Luther-optimal
    judge = evaluator("vora", lux=1.0, matrix="kernel")
    draw = np.random.default_rng(3).uniform([560, 500, 420, 20], [660, 570, 480, 90], (20, 4))
    qe = bells(draw)
    cmf = cie_1931(DEFAULT_GRID).values / NM[:, None]  # per photon
    basis = np.linalg.qr(cmf)[0]
    residual = [
        np.linalg.norm(one @ np.linalg.lstsq(one, basis, rcond=None)[0] - basis) for one in qe
    ]
    vora = judge.values(Candidates(qe=qe))[:, 0]
    assert vora == pytest.approx(1 - np.square(residual) / 3, abs=1e-9)


def test_a_search_over_a_basis_of_filters_reaches_a_vora_value_of_1():
    cmf = cie_1931(DEFAULT_GRID).values / NM[:, None]
    red, green, blue = 0.5 * (cmf / cmf.max(axis=0)).T
    other = 0.5 * np.exp(-0.5 * ((NM - 850.0) / 60.0) ** 2)

    def mixes(x):
        a, b, c = x.T[:, :, None]
        filters = (red + a * other, green + b * other, blue + c * green)
        return Candidates(qe=np.stack(filters, axis=2))

    judge = evaluator("vora", lux=1.0, matrix="kernel")
    values, vora = best(judge, mixes, [-0.0, -0.0, 0.0], [0.9, 0.9, 0.9], budget=4000)
    assert vora == pytest.approx(1.0, abs=1e-6)
    assert values[:2] == pytest.approx(0.0, abs=1e-3)  # any share of green in blue is a mix of both


def test_the_best_shares_of_the_pixels_are_those_of_the_closed_form():
    # least variance of sum m_i x_i for n_i readings with sum n_i = n: n_i ~ |m_i| sd_i (Neyman)
    judge = evaluator("snr_y_db", lux=10.0, matrix="kernel")
    qe = sensor_named("onyx-rgb-ircut").qe

    def split(x):
        first = x[:, 0]
        second = (1 - first) * x[:, 1]
        share = np.stack([first, second, 1 - first - second], axis=1)
        return Candidates(qe=np.repeat(qe[None], len(x), axis=0), pixel_share=share)

    values, snr_db = best(judge, split, [0.02, 0.02], [0.98, 0.98], budget=3000)
    found = split(values[None]).pixel_share[0]
    scene = judge.scenes[0]
    point = replace(scene.point, sensor=replace(sensor_named("onyx-rgb-ircut")))
    row = scene.maker(point).matrix[1]
    # electrons of a white from the paper's number: 11,419 photons / (lux s um^2) at 400-700 nm
    photons = 11_419 * 10.0 * 1e-3 * TIME_MS * 100.0 / (4 * 1.8**2)
    visible = NM <= 700
    weight = NM[visible] / NM[visible].sum()  # equal energy: photons ~ wavelength
    mean_e = photons * (weight @ qe[visible])
    wanted = np.abs(row) * np.sqrt(mean_e + 100.0)
    assert found == pytest.approx(wanted / wanted.sum(), abs=0.002)
    (equal_db,) = judge.values(Candidates(qe=qe[None]))[0]
    assert snr_db - equal_db == pytest.approx(2.29, abs=0.02)


@pytest.mark.parametrize("sensor", ["onyx-rgbw", "onyx-rgb"])
def test_the_best_ir_cut_lies_at_617_nm_for_snr_and_at_628_nm_for_color(sensor):
    # docs/findings.md, by `chromanoise compare --sweep ircut-nm`: 10 lx, 11.94 ms, LMMSE
    for objective, edge_nm in (("snr_y_db", 617), ("delta_e", 628)):
        judge = evaluator(objective, lux=10.0, matrix="lmmse")
        values, _ = best(judge, lambda x: with_edges(sensor, x[:, 0]), [600], [700], budget=600)
        assert values[0] == pytest.approx(edge_nm, abs=2.0)


@pytest.mark.parametrize("matrix", ["kernel", "least-squares", "lmmse"])
@pytest.mark.parametrize("sensor", ["onyx-rgbw", "onyx-rgb"])
def test_the_ir_cut_of_least_total_error_moves_to_longer_wavelengths_as_light_falls(sensor, matrix):
    edges_nm = [
        best_edge_nm(sensor, evaluator("total_delta_e", lux=lux, matrix=matrix))
        for lux in (100.0, 10.0, 1.0, 0.1)
    ]
    assert np.all(np.diff(edges_nm) >= 0)
    assert edges_nm[-1] - edges_nm[0] > 100


@pytest.mark.parametrize("sensor", ["onyx-rgbw", "onyx-rgb"])
def test_the_ir_cut_of_best_snr_moves_with_lmmse_and_not_with_least_squares(sensor):
    adapted, fixed = (
        [best_edge_nm(sensor, evaluator("snr_y_db", lux=lux, matrix=matrix)) for lux in LIGHT]
        for matrix, LIGHT in (("lmmse", (100.0, 10.0, 1.0, 0.1)), ("least-squares", (100.0, 0.1)))
    )
    assert np.all(np.diff(adapted) > 0)
    assert abs(fixed[1] - fixed[0]) <= 6


def test_the_best_filters_widen_and_leave_the_luther_condition_as_light_falls():
    cut = SILICON * ir_cut(DEFAULT_GRID, edge_nm=650.0)[:, None]

    def sensors(x):
        return Candidates(qe=bells(x) * cut)

    ends = ([570, 500, 420, 10], [660, 570, 480, 150])
    widths_nm, vora = [], []
    judge = evaluator("vora", lux=1.0, matrix="kernel")
    for lux in (1e6, 100.0, 10.0, 1.0, 0.1):
        of_light = evaluator("total_delta_e", lux=lux, matrix="lmmse")
        values, _ = best(of_light, sensors, *ends, budget=1600)
        widths_nm.append(values[3])
        vora.append(judge.values(sensors(values[None]))[0, 0])
    _, most = best(judge, sensors, *ends, budget=3000)
    assert np.all(np.diff(widths_nm[2:]) > 5)  # from 10 lx on; above, they stay within 5 nm
    assert np.ptp(widths_nm[:3]) < 5
    assert np.all(np.diff(vora) < 1e-3)
    assert most - 0.02 < vora[0] < most


def test_color_correction_makes_rgb_the_quietest_and_rpb_the_noisiest_as_kodak_found():
    # Adams & Pillman in Lukac (ed.), Computational Photography (CRC, 2010), Table 1.2, sigma_L:
    # white-balanced 1.24, 0.84, 1.03; corrected 1.60, 2.51, 1.90 for RGB, RPB, CMY
    def band(low_nm, high_nm):
        return resin_filter(DEFAULT_GRID, low_nm=low_nm, high_nm=high_nm, leak_nm=2000.0)

    green = band(490.0, 580.0)
    clear = np.full(NM.size, 0.9)
    sets = {
        "RGB": (band(580.0, 2000.0), green, band(300.0, 490.0)),
        "RPB": (band(580.0, 2000.0), clear, band(300.0, 490.0)),
        "CMY": (band(300.0, 580.0), 0.92 - green, band(490.0, 2000.0)),
    }
    cut = SILICON * ir_cut(DEFAULT_GRID, edge_nm=650.0)[:, None]
    qe = np.stack([np.stack(one, axis=1) * cut for one in sets.values()])
    for matrix in ("kernel", "least-squares", "lmmse"):
        judge = evaluator("snr_y_db", lux=10.0, matrix=matrix)
        rgb, rpb, cmy = judge.values(Candidates(qe=qe))[:, 0]
        assert rgb > cmy > rpb
        noise = replace(judge, objectives=("noise_delta_e",))
        rgb, rpb, cmy = noise.values(Candidates(qe=qe))[:, 0]
        assert rgb < cmy < rpb


def test_the_optimum_of_two_numbers_is_that_of_a_grid_of_all_their_values():
    judge = evaluator("total_delta_e", lux=3.0, matrix="lmmse")
    base = bells(np.array([[600.0, 540.0, 455.0, 40.0]]))[0] * SILICON
    leak = SILICON * 0.3 * (NM[:, None] > 700)

    def sensors(x):
        cuts = ir_cut(DEFAULT_GRID, edge_nm=x[:, 0])[..., None]
        share = x[:, 1:, None]
        return Candidates(qe=(base * (1 - share) + share * SILICON * 0.8 + leak) * cuts)

    low, high = np.array([600.0, 0.0]), np.array([800.0, 1.0])
    values, found = best(judge, sensors, low, high, budget=3000)
    axes = [np.linspace(*ends, 101) for ends in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    all_values = judge.values(sensors(grid))[:, 0]
    at = grid[all_values.argmin()]
    assert found <= all_values.min()
    assert found == pytest.approx(all_values.min(), rel=1e-4)
    assert np.abs(values - at) / (high - low) == pytest.approx(0.0, abs=0.01)
