"""The objectives of a batch of sensors equal those of the library, candidate by candidate."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.design.candidates import Candidates
from chromanoise.design.evaluation import Evaluator
from chromanoise.design.objectives import FAST, OBJECTIVES, Candidate, value_of
from chromanoise.design.scenes import DesignScene, candidate_point
from chromanoise.exposure import Exposure, OperatingPoint
from chromanoise.sensor import Converter, Pixel, Sensor
from chromanoise.spectra import OBSERVERS, Grid, equal_energy

GRID = Grid.uniform(400, 1000, 20)
NM = GRID.wavelength_nm
E_LAMP = equal_energy(GRID)
QUIET = Pixel(pitch_um=5.0, full_well_e=1e5, read_noise_e=3.0)
MATRICES = (
    "kernel",
    "least-squares",
    "lmmse",
    "ridge=0.01",
    "noise-regularized=3",
    "white-preserving",
)


def bells(rng, m, p):
    """Smooth curves with an infrared tail."""
    center, width = rng.uniform(420, 680, (m, 1, p)), rng.uniform(15, 60, (m, 1, p))
    bell = rng.uniform(0.3, 0.8, (m, 1, p)) * np.exp(-0.5 * ((NM[:, None] - center) / width) ** 2)
    tail = rng.uniform(0, 0.2, (m, 1, p)) / (1 + np.exp((750 - NM[:, None]) / 30))
    return bell + tail + 1e-4


def scene_of(rng, matrix="kernel", p=3, **changes):
    """Any light, observer, exposure and pixel, all noise sources included."""
    pixel = Pixel(
        pitch_um=rng.uniform(2, 10), full_well_e=1e6, read_noise_e=rng.uniform(0.5, 10),
        prnu=rng.uniform(0, 0.02), dsnu_e=rng.uniform(0, 5), dark_current_e_per_s=rng.uniform(0, 90),
        black_error_e=rng.choice([0.0, 1.5]),
    )  # fmt: skip
    sensor = Sensor(
        name="own", grid=GRID, qe=np.full((GRID.n, p), 0.5), pixel=pixel,
        names=tuple(f"c{i}" for i in range(p)), converter=Converter(bits=12),
    )  # fmt: skip
    lamp = illuminant_named(str(rng.choice(["E", "D65", "A"])), GRID, beyond="zero")
    point = OperatingPoint(
        sensor=sensor, exposure=Exposure(time_s=rng.uniform(0.002, 0.02)), illuminant=lamp,
        level_lux=rng.uniform(1, 100), observer=str(rng.choice(list(OBSERVERS))),
    )  # fmt: skip
    metric = str(rng.choice(["quanta", "energy"]))
    return DesignScene(point=replace(point, **changes), matrix=matrix, metric=metric)


def plain_scene(matrix="kernel", pixel=QUIET, time_s=0.01, level_lux=10.0, p=3, **changes):
    sensor = Sensor(
        name="own",
        grid=GRID,
        qe=np.full((GRID.n, p), 0.5),
        names=tuple("RGBWXYZV"[:p]),
        pixel=pixel,
    )
    point = OperatingPoint(
        sensor=sensor, exposure=Exposure(time_s=time_s), illuminant=E_LAMP, level_lux=level_lux
    )
    return DesignScene(point=replace(point, **changes), matrix=matrix)


def of_library(scene, qe, names):
    point = candidate_point(scene, qe)
    one = Candidate(point=point, matrix=scene.maker(point), maker=scene.maker)
    return np.array([value_of(OBJECTIVES[name], one) for name in names])


@pytest.mark.parametrize("matrix", MATRICES)
@pytest.mark.parametrize("p", [1, 2, 3, 4, 8])
def test_a_batch_gives_the_values_of_the_library(matrix, p):
    rng = np.random.default_rng([p, MATRICES.index(matrix)])
    scene, qe = scene_of(rng, matrix, p), bells(rng, 5, p)
    names = FAST if p < 8 else tuple(name for name in FAST if name != "snr10_lux")
    found = Evaluator(scenes=(scene,), objectives=names).values(Candidates(qe=qe))
    wanted = np.array([of_library(scene, one, names) for one in qe])
    assert np.isfinite(wanted).mean() > 0.6
    np.testing.assert_allclose(found, wanted, rtol=1e-9)
