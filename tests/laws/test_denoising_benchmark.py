"""Cells of the benchmark of denoising: fields, references, processes, verdict, table."""

import json
import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from math import inf
from multiprocessing import get_context

import numpy as np
import pytest

from chromanoise.apps.denoising_benchmark.benchmark import (
    benchmark_camera,
    benchmark_cells,
    benchmark_scene,
    denoising_benchmark,
    markdown_table,
    verdict,
)
from chromanoise.imaging import Work
from chromanoise.sensor import Crosstalk, with_crosstalk, with_pixel
from chromanoise.spectra import flat_cube
from dear import dear
from outcomes import refused_input

FIELDS = {
    "scene": str,
    "sensor": str,
    "lux": float,
    "method": str,
    "psnr": float,
    "ssim": float,
    "ciede2000_mean": float,
    "ciede2000_p95": float,
    "scielab_mean": float,
    "seconds": float,
    "seed": int,
    "settings": dict,
}
EDGES = "builtin:slanted-edges"


@pytest.fixture(scope="module")
def cells():
    return denoising_benchmark(
        [EDGES],
        ["onyx-rgbw", "onyx-rgb-ircut:bayer"],
        [10.0, 1.0],
        ["none", "wavelets"],
        crop_px=128,
        work=Work(threads=1),
    )


def test_a_cell_for_each_scene_camera_level_and_method_with_the_fields_of_scripts(cells):
    assert len({(*cell.place, cell.method) for cell in cells}) == len(cells) == 8
    for cell in cells:
        record = json.loads(json.dumps(cell.record, allow_nan=False))
        assert {name: type(record[name]) for name in FIELDS} == FIELDS
        assert (record["to_demosaicked"] is None) == (":" not in cell.sensor)


def test_flats_and_edges_are_measured_where_the_scene_has_them(cells):
    noisy, smooth = cells[:2]
    assert smooth.flats.snr_y_db > noisy.flats.snr_y_db + 3
    assert smooth.flats.b_sd < 0.5 * noisy.flats.b_sd
    edge = smooth.edges["luminance vertical"]
    assert edge.reference_rise_px == pytest.approx(0.86, abs=0.02)  # 0.8 px of a box of 1 px
    assert edge.rise_px == pytest.approx(0.86, abs=0.3)


def test_a_method_without_error_does_not_beat_a_baseline_without_error(cells):
    none = {"ciede2000_mean": 0.0, "scielab_mean": 0.0}
    exact = [replace(cell, quality=replace(cell.quality, **none)) for cell in cells[:1]]
    both = [replace(exact[0], method=name) for name in ("guided", "nlm")]
    found = verdict(both, "guided")
    assert (found.won, found.worst_ratio) == (0, 1.0)


def test_a_number_that_is_not_finite_is_null(cells):
    quality = replace(cells[0].quality, psnr_db=inf)
    assert replace(cells[0], quality=quality).record["psnr"] is None


class PickledThreads(ThreadPoolExecutor):
    """Threads that receive and return pickled data, as processes do."""

    def map(self, function, *tasks):
        run = partial(_pickled, pickle.dumps(function))
        return map(pickle.loads, super().map(run, map(pickle.dumps, zip(*tasks, strict=True))))


def _pickled(function, task):
    return pickle.dumps(pickle.loads(function)(*pickle.loads(task)))


def spawned(count):
    return ProcessPoolExecutor(count, mp_context=get_context("spawn"))


@pytest.mark.parametrize("pool_of", [PickledThreads, *dear(spawned)])
def test_the_cells_are_the_same_for_one_and_two_workers(pool_of):
    asked = {
        "scenes": ["builtin:dead-leaves"],
        "cameras": ["onyx-rgb-ircut:bayer"],
        "levels_lux": [1.0, 0.1],
        "methods": ["wavelets", "opencv"],
        "crop_px": 32,
    }
    here = denoising_benchmark(**asked, work=Work(threads=1))
    with pool_of(2) as pool:
        elsewhere = denoising_benchmark(**asked, work=Work(executor=pool))
    assert [{**cell.record, "seconds": 0} for cell in elsewhere] == [
        {**cell.record, "seconds": 0} for cell in here
    ]


def test_without_detail_demosaicking_makes_no_error():
    """Both references of a uniform scene are the same picture, so that errors agree."""
    cube = flat_cube(np.array([400.0, 1050.0]), 0.3, height=32, width=32)
    scene = benchmark_scene(cube, name="flat")
    camera = benchmark_camera("onyx-rgbw:rgbw-4x4", level_lux=10.0)
    (cell,) = benchmark_cells(scene, camera, ["none"])
    assert cell.quality.ciede2000_mean > 1
    assert cell.demosaicked_quality.ciede2000_mean == pytest.approx(
        cell.quality.ciede2000_mean, rel=1e-6
    )
    assert cell.flats is None
    assert cell.quality.false_color is None


@pytest.mark.parametrize("mosaic", ["", ":bayer"])
@pytest.mark.parametrize(
    "source",
    [
        {"row_noise_e": 300.0},
        {"column_noise_e": 300.0},
        {"rtn_share": 0.1, "rtn_amplitude_e": 3000.0},
    ],
    ids=lambda source: next(iter(source)),
)
def test_rows_columns_and_telegraph_pixels_have_their_own_offsets(source, mosaic):
    cube = flat_cube(np.array([400.0, 1050.0]), 0.3, height=64, width=64)
    camera = benchmark_camera(f"onyx-rgb-ircut{mosaic}", level_lux=10.0)
    sensor = with_pixel(camera.point.sensor, {**source, "full_well_e": 1e6})
    camera = replace(camera, point=replace(camera.point, sensor=sensor))
    (cell,) = benchmark_cells(benchmark_scene(cube, name="flat"), camera, ["none"])
    green = cell.srgb[..., 1].astype(float)
    if "rtn_share" in source:
        away = (np.abs(green - np.median(green)) > 25).mean()
        assert 0.05 < away < (0.6 if mosaic else 0.35)  # demosaicking spreads a level
        return
    own, other = (
        green.mean(axis=axis).var() for axis in ((1, 0) if "row" in str(source) else (0, 1))
    )
    assert own > 0.7 * green.var() > 10 * other


def test_grays_have_their_true_colors(cells):
    """The kernel matrix renders every gray as the white times its reflectance."""
    for cell in cells:
        if ":" not in cell.sensor:
            assert cell.true_ciede2000_mean == pytest.approx(cell.quality.ciede2000_mean, rel=1e-3)


def test_the_paper_exposes_11_94_ms_and_no_brighter_light_saturates():
    times_ms = [
        1e3 * benchmark_camera(name, level_lux=lux).point.exposure.time_s
        for name in ("onyx-rgbw", "onyx-rgb-ircut")
        for lux in (0.1, 10.0, 100.0)
    ]
    assert times_ms == pytest.approx([11.94, 11.94, 1.194] * 2, rel=1e-3)


def with_errors(cell, method, ciede2000, scielab, lux=10.0):
    quality = replace(cell.quality, ciede2000_mean=ciede2000, scielab_mean=scielab)
    return replace(cell, method=method, lux=lux, quality=quality)


def test_a_place_is_won_by_both_errors_below_those_of_every_baseline(cells):
    one = cells[0]
    shown = [
        with_errors(one, "wavelets", 1.0, 3.0),
        with_errors(one, "nlm", 2.0, 2.0),
        with_errors(one, "bm3d", 4.0, 4.0),
        with_errors(one, "wavelets", 3.0, 3.0, lux=1.0),
        with_errors(one, "nlm", 4.0, 4.0, lux=1.0),
    ]
    found = verdict(shown, "wavelets")
    assert (found.places, found.won, found.share) == (2, 1, 0.5)
    assert (found.worst_ratio, found.worst[2]) == (1.5, 10.0)  # S-CIELAB 3 against 2
    with refused_input(subject="cells", value="opencv"):
        verdict(shown, "opencv")


def test_the_table_holds_every_cell_and_marks_the_lowest(cells):
    rows = [line.split("|")[1:-1] for line in markdown_table(cells).splitlines()]
    assert [name.strip() for name in rows[0]] == ["scene", "sensor", "lux", "none", "wavelets"]
    for cell in cells:
        row = next(
            r for r in rows if (r[1].strip(), r[2].strip()) == (cell.sensor, f"{cell.lux:g}")
        )
        text = row[3 + (cell.method == "wavelets")].replace("*", "").split("/")
        assert float(text[0]) == pytest.approx(cell.quality.ciede2000_mean, abs=0.006)
        assert row[3].count("**") + row[4].count("**") == 4


@pytest.mark.parametrize("crop_px", [23, 257])
def test_a_part_that_a_scene_does_not_have_is_refused(crop_px):
    with refused_input(subject="crop_px", value=crop_px):
        benchmark_scene("builtin:slanted-edges", crop_px=crop_px)


@pytest.mark.parametrize("crop_px", [30, 182])
def test_a_part_that_cuts_patches_to_single_pixels_is_measured(crop_px):
    (cell,) = denoising_benchmark(
        ["builtin:checker"], ["onyx-rgbw"], [10.0], ["none"], crop_px=crop_px
    )
    assert (cell.flats is None) == (crop_px == 30)  # of 30 px the corners of four patches


def test_scenes_have_noise_of_their_own_for_any_seed():
    scene = benchmark_scene("builtin:checker", crop_px=64)
    noise = []
    for name in ("one", "two"):
        camera = replace(benchmark_camera("onyx-rgbw", level_lux=10.0), name=name)
        (cell,) = benchmark_cells(scene, camera, ["none"], seed=2**64 - 1)
        noise.append(cell.srgb.astype(float) - cell.reference_srgb)
    assert abs(np.corrcoef(*map(np.ravel, noise))[0, 1]) < 0.1
    for seed in (-1, 2**64):
        with refused_input(subject="seed", value=seed):
            benchmark_cells(scene, camera, ["none"], seed=seed)


def test_crosstalk_after_counting_is_refused():
    camera = benchmark_camera("onyx-rgbw", level_lux=10.0)
    mixing = Crosstalk(
        matrix=np.full((4, 4), 0.02) + 0.92 * np.eye(4), stage="charge", pixels=(1,) * 4
    )
    coupled = with_crosstalk(camera.point.sensor, mixing)
    camera = replace(camera, point=replace(camera.point, sensor=coupled))
    with refused_input(requirement="crosstalk after counting"):
        benchmark_cells(benchmark_scene("builtin:checker", crop_px=64), camera, ["none"])


def test_an_unknown_method_is_refused_before_the_computation():
    with refused_input(subject="denoise", value="magic"):
        denoising_benchmark(methods=["magic"])
