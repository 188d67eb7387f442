"""The objectives of a batch of sensors equal those of the library, candidate by candidate."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from chromanoise.apps.design.evaluation import DesignScene, Objectives, candidate_point
from chromanoise.apps.design.objectives import FAST, OBJECTIVES, Candidate, value_of
from chromanoise.apps.design.parameters import (
    Candidates,
    Parameter,
    RobustPart,
    noise_properties,
    over_tolerances,
)
from chromanoise.metrics import chart_ciede2000
from chromanoise.noise import Exposure
from chromanoise.sensor import PIXEL, Converter, Crosstalk, Pixel, Sensor
from chromanoise.spectra import (
    OBSERVERS,
    Grid,
    PatchPairs,
    color_axes,
    colorchecker,
    equal_energy,
    illuminant_named,
)
from dear import dear
from outcomes import refused_input
from strategies import point_of, sensor_of

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
        pitch_um=rng.uniform(2, 10), full_well_e=1e6, read_noise_e=rng.uniform(18, 30),
        prnu=rng.uniform(0, 0.02), dsnu_e=rng.uniform(0, 5), row_noise_e=rng.uniform(0, 2),
        dark_current_e_per_s=rng.uniform(0, 90), black_error_e=rng.choice([0.0, 1.5]),
    )  # fmt: skip
    sensor = Sensor(
        name="own", grid=GRID, qe=np.full((GRID.n, p), 0.5), pixel=pixel,
        names=tuple(f"c{i}" for i in range(p)), converter=Converter(bits=16),  # 15 e- per code
    )  # fmt: skip
    lamp = illuminant_named(str(rng.choice(["E", "D65", "A"])), GRID, beyond="zero")
    exposure = Exposure(time_s=rng.uniform(0.002, 0.02))
    level_lux, observer = rng.uniform(1, 100), str(rng.choice(list(OBSERVERS)))
    point = point_of(sensor, level_lux, exposure=exposure, illuminant=lamp, observer=observer)
    metric = str(rng.choice(["quanta", "energy"]))
    return DesignScene(point=replace(point, **changes), matrix=matrix, metric=metric)


def plain_scene(matrix="kernel", pixel=QUIET, time_s=0.01, level_lux=10.0, p=3, **changes):
    names = tuple("RGBWXYZV"[:p])
    sensor = sensor_of(np.full((GRID.n, p), 0.5), grid=GRID, pixel=pixel, names=names, name="own")
    point = point_of(sensor, level_lux, exposure=Exposure(time_s=time_s))
    return DesignScene(point=replace(point, **changes), matrix=matrix)


def of_library(scene, qe, names):
    point = candidate_point(scene, qe)
    one = Candidate(point=point, matrix=scene.maker(point), maker=scene.maker)
    return np.array([value_of(OBJECTIVES[name], one) for name in names])


def of_batch(scenes, qe, names, **fields):
    """The objectives of curves in one scene or in several."""
    several = scenes if isinstance(scenes, tuple) else (scenes,)
    return Objectives(scenes=several, objectives=names, **fields).values(Candidates(qe=qe))


def slope_of(function, at, step):
    """Central difference of fourth order, one row per step."""
    below_2, below, above, above_2 = (function(at + k * step) for k in (-2, -1, 1, 2))
    return (8 * (above - below) - (above_2 - below_2)) / (12 * np.diag(step)[:, None])


@dataclass(frozen=True)
class Times:
    """Sensors with the same curves, of which only the exposure time is free."""

    parameters = (Parameter(name="time", unit="s", low=0.001, high=0.1),)

    def candidates(self, values):
        assert ((values.real >= 0.001) & (values.real <= 0.1)).all()
        qe = np.repeat(luther_curves()[None], len(values), axis=0)
        return Candidates(qe=qe, time_s=values[:, 0])


@pytest.mark.parametrize("matrix", MATRICES)
@pytest.mark.parametrize("p", [1, 2, 3, 4, 8])
def test_a_batch_gives_the_values_of_the_library(matrix, p):
    rng = np.random.default_rng([p, MATRICES.index(matrix)])
    scene, qe = scene_of(rng, matrix, p), bells(rng, 4, p)
    searched = matrix in ("lmmse", "noise-regularized=3") and p != 3  # slow
    hueless = p == 1  # colors of one channel are gray; their hue is rounding
    left_out = {"snr10_lux": searched, "ciede2000": hueless}
    names = tuple(name for name in FAST if not left_out.get(name))
    found = of_batch(scene, qe, names)
    wanted = np.array([of_library(scene, one, names) for one in qe])
    assert np.isfinite(wanted).mean() > 0.6
    np.testing.assert_allclose(found, wanted, rtol=1e-9)


def test_what_a_candidate_brings_replaces_what_the_scene_has():
    rng = np.random.default_rng(1)
    scene, qe = scene_of(rng, "lmmse"), bells(rng, 3, 3)
    time_s, read_noise_e, prnu = (
        np.array([0.001, 0.01, 0.02]),
        np.array([20.0, 25, 31]),
        rng.random(3),
    )
    weight = np.array([0.0, 1.0, 7.0])
    pixel = {"read_noise_e": read_noise_e, "prnu": prnu / 10}
    own = Candidates(qe=qe, time_s=time_s, pixel=pixel, noise_weight=weight)
    found = Objectives(scenes=(scene,), objectives=FAST).values(own)
    for i in range(3):
        point = candidate_point(
            scene, qe[i], time_s=time_s[i], read_noise_e=read_noise_e[i], prnu=prnu[i] / 10
        )
        sensor = point.sensor
        there = replace(scene, point=point, matrix=f"noise-regularized={weight[i]}")
        assert sensor.pixel.read_noise_e == read_noise_e[i]
        np.testing.assert_allclose(found[i], of_library(there, qe[i], FAST), rtol=1e-9)


PARTNER = {"rtn_share": {"rtn_amplitude_e": 9.0}, "rtn_amplitude_e": {"rtn_share": 0.1}}
"""What else a pixel needs so that a property of it makes noise."""


@pytest.mark.parametrize("name", noise_properties())
@pytest.mark.parametrize("matrix", ["kernel", "lmmse", *dear("bounded-psi=2")])
def test_any_noise_of_the_pixel_of_a_candidate_is_that_of_its_sensor(matrix, name):
    rng = np.random.default_rng([3, list(noise_properties()).index(name)])
    scene, qe = scene_of(rng, matrix), bells(rng, 4, 3)
    amount = rng.uniform(0.5, 1.0, 4) * min(PIXEL[name].most, 40.0)
    amount[0] = 20.0 if name == "read_noise_e" else 0.0  # below, rounding is not added noise
    left_out = {"share_of_full_well"} | ({"snr10_lux"} if matrix != "kernel" else set())
    names, time_s = tuple(n for n in FAST if n not in left_out), rng.uniform(0.05, 0.2, 4)
    more = PARTNER.get(name, {})
    pixel = {name: amount, **{other: np.full(4, value) for other, value in more.items()}}
    for time in (None, time_s):
        own = Candidates(qe=qe, time_s=time, pixel=pixel)
        found = Objectives(scenes=(scene,), objectives=names).values(own)
        for i in range(4):
            given = {} if time is None else {"time_s": time[i]}
            point = candidate_point(scene, qe[i], **given, **more, **{name: amount[i]})
            there = replace(scene, point=point)
            assert getattr(point.sensor.pixel, name) == amount[i]
            np.testing.assert_allclose(found[i], of_library(there, qe[i], names), rtol=1e-9)


@pytest.mark.parametrize("name", noise_properties())
def test_the_gradient_of_any_noise_of_the_pixel_is_the_central_difference(name):
    high = min(PIXEL[name].most, 20.0)

    class Noises:
        parameters = (
            Parameter(name="time", unit="s", low=0.001, high=0.2),
            Parameter(name=name, unit="1", low=0.0, high=high),
        )

        def candidates(self, values):
            qe = np.repeat(luther_curves()[None], len(values), axis=0)
            more = PARTNER.get(name, {})
            pixel = {other: np.full(len(values), value) for other, value in more.items()}
            return Candidates(qe=qe, time_s=values[:, 0], pixel=pixel | {name: values[:, 1]})

    scene = scene_of(np.random.default_rng(4), "kernel")
    evaluator = Objectives(scenes=(scene,), objectives=("snr_y_db", "least_separation"))
    at, step = np.array([0.05, 0.4 * high]), np.diag([1e-4, 1e-3 * high])
    _, jacobian = evaluator.gradient(Noises(), at)
    wanted = slope_of(lambda x: evaluator.values(Noises().candidates(x)), at, step).T
    assert (wanted[:, 1] < 0).all()
    np.testing.assert_allclose(jacobian, wanted, rtol=1e-5)
    separations = evaluator.linearization(Noises(), at).separations_jacobian
    least = evaluator.linearization(Noises(), at).separations.argmin()
    np.testing.assert_allclose(separations[least], wanted[1], rtol=1e-5)


@pytest.mark.parametrize("matrix", ["kernel", "least-squares", "lmmse"])
def test_dependent_and_nearly_dependent_channels_keep_the_digits_of_the_library(matrix):
    rng = np.random.default_rng(2)
    qe = bells(rng, 6, 4)
    for i, apart in enumerate([0.0, 1e-12, 1e-7, 1e-5, 1e-3, 1e-2]):
        qe[i, :, 3] = (qe[i, :, 0] + qe[i, :, 1]) / 2 + apart * qe[i, :, 2]
    names = ("snr_y_db", "noise_delta_e", "delta_e", "ciede2000", "vora", "mean_separation")
    scene = plain_scene(matrix, p=4)
    found = of_batch(scene, qe, names)
    for one, values in zip(qe, found, strict=True):
        condition = np.linalg.cond(one / np.linalg.norm(one, axis=0))
        tolerance = max(1e-9, 1e-14 * condition) if condition < 1e10 else 1e-9
        np.testing.assert_allclose(values, of_library(scene, one, names), rtol=tolerance)


def test_the_bits_of_a_candidate_depend_neither_on_the_batch_nor_on_the_threads():
    rng = np.random.default_rng(3)
    qe = bells(rng, 300, 3)
    qe[7, :, 2] = qe[7, :, 0]  # a singular one goes another way
    scene = plain_scene("kernel")
    whole, threaded = (of_batch(scene, qe, FAST, threads=count) for count in (1, 2))
    assert (whole == threaded).all()
    parts = [of_batch(scene, part, FAST) for part in np.split(qe, [1, 6, 40, 233])]
    assert (np.concatenate(parts) == whole).all()


def test_choices_from_a_library_are_the_sensors_with_these_curves():
    rng = np.random.default_rng(4)
    curves = bells(rng, 1, 40)[0]
    choices = rng.integers(0, 40, (50, 4))
    evaluator = Objectives(scenes=(plain_scene(p=4),), objectives=FAST)
    found = evaluator.values_of_choices(choices, curves)
    wanted = evaluator.values(Candidates(qe=np.moveaxis(curves[:, choices], 0, 1)))
    np.testing.assert_allclose(found, wanted, rtol=1e-9)


def luther_curves():
    """Any mixture of the observer's curves that a sensor can have."""
    axes = color_axes(GRID, "quanta")
    mixed = axes @ np.array([[1.0, 0.2, 0.0], [0.1, 1.0, 0.1], [0.0, 0.2, 1.0]])
    return 0.9 * mixed / mixed.max()


@pytest.mark.parametrize("matrix", ["kernel", "least-squares"])
def test_mixtures_of_the_observer_have_no_color_error_and_a_vora_value_of_1(matrix):
    names = ("delta_e", "ciede2000", "vora")
    found = of_batch(plain_scene(matrix), luther_curves()[None], names)
    np.testing.assert_allclose(found, [[0, 0, 1]], atol=1e-9)


def test_one_channel_has_the_snr_of_its_electrons_whatever_its_angle():
    scene, qe = plain_scene(p=1), bells(np.random.default_rng(5), 4, 1)
    evaluator = Objectives(scenes=(scene,), objectives=("snr_y_db",))
    found = evaluator.values(Candidates(qe=qe))
    electrons = evaluator.values_and_fullness(Candidates(qe=qe))[1] * QUIET.full_well_e
    np.testing.assert_allclose(found[:, 0], 20 * np.log10(electrons / np.sqrt(electrons + 9)))


def test_the_best_pixel_shares_are_proportional_to_the_weighted_noise():
    scene, qe = plain_scene(), bells(np.random.default_rng(6), 1, 3)
    evaluator = Objectives(scenes=(scene,), objectives=("snr_y_db",))
    point = candidate_point(scene, qe[0])
    weight, electrons = scene.maker(point).matrix[1], of_white(scene, qe[0])
    best = np.abs(weight) * np.sqrt(electrons + 9)
    best /= best.sum()
    others = best * np.random.default_rng(7).uniform(0.8, 1.2, (50, 3))
    shares = np.vstack([best, others / others.sum(axis=1, keepdims=True)])
    found = evaluator.values(Candidates(qe=np.repeat(qe, 51, axis=0), pixel_share=shares))[:, 0]
    assert found.argmax() == 0
    equal = evaluator.values(Candidates(qe=qe, pixel_share=np.full((1, 3), 1 / 3)))
    np.testing.assert_allclose(equal, evaluator.values(Candidates(qe=qe)), rtol=1e-13)


def of_white(scene, qe):
    one = Objectives(scenes=(scene,), objectives=("snr_y_db",))
    each = [
        one.values_and_fullness(Candidates(qe=qe[None, :, [i]]))[1][0] for i in range(qe.shape[1])
    ]
    return np.array(each) * QUIET.full_well_e


def test_ciede2000_equals_another_code_for_all_hues():
    rng, scene = np.random.default_rng(8), plain_scene()
    qe = rng.uniform(0.02, 0.9, (60, GRID.n, 3)) ** rng.uniform(1, 9, (60, 1, 3))
    found = of_batch(scene, qe, ("ciede2000",))[:, 0]
    for one, value in zip(qe, found, strict=True):
        point = candidate_point(scene, one)
        given = (point.sensor, scene.maker(point), point.exposure, point.illuminant)
        theirs = chart_ciede2000(*given)  # by colour-science
        if theirs is None:
            assert value == np.inf
        else:
            np.testing.assert_allclose(value, theirs.mean(), rtol=1e-10)


@dataclass(frozen=True)
class Bells:
    """Three bells; the parameters are their centers, then time and shares where wanted."""

    tolerance: float = 2.0
    more: bool = False

    @property
    def parameters(self):
        of = [("R", 600.0), ("G", 540.0), ("B", 460.0)] + ([("w", 30.0)] if self.more else [])
        return [
            Parameter(name=n, unit="nm", low=at - 20, high=at + 20, tolerance=self.tolerance)
            for n, at in of
        ]

    def candidates(self, values):
        values = np.asarray(values)
        away = (NM[:, None] - values[:, None, :3]) / 35.0
        qe = 0.6 * np.exp(-0.5 * away**2) + 1e-3
        if not self.more:
            return Candidates(qe=qe)
        w = values[:, 3]
        share = np.stack([w / 100, 0.5 - w / 200, 0.5 - w / 200], axis=1)
        return Candidates(qe=qe, time_s=w * 2e-4, pixel_share=share, pixel={"prnu": w * 1e-3})


AT = np.array([611.0, 533.0, 452.0])


@pytest.mark.parametrize("matrix", ["kernel", "lmmse", "ridge=0.01"])
@pytest.mark.parametrize("more", [False, True])
def test_gradients_equal_central_differences(matrix, more):
    names = tuple(name for name in FAST if name != "snr10_lux" or matrix != "lmmse")
    space, at = Bells(more=more), np.append(AT, 33.0) if more else AT
    scenes = (plain_scene(matrix), plain_scene(matrix, level_lux=3.0))
    evaluator = Objectives(scenes=scenes, objectives=names)
    values, jacobian = evaluator.gradient(space, at)
    step = 1e-3 * np.eye(at.size)
    wanted = slope_of(lambda x: evaluator.values(space.candidates(x)), at, step)
    np.testing.assert_allclose(values, evaluator.values(space.candidates(at[None]))[0], rtol=1e-12)
    size = np.abs(wanted).max(axis=0)[:, None]
    assert (np.abs(jacobian - wanted.T) <= 1e-6 * size + 1e-9).all()


@pytest.mark.parametrize("more", [False, True])
def test_the_separations_of_a_linearization_are_the_distances_of_the_library(more):
    space, at = Bells(more=more), np.append(AT, 33.0) if more else AT
    scenes = (plain_scene("kernel"), plain_scene("kernel", level_lux=3.0))
    evaluator = Objectives(scenes=scenes, objectives=("least_separation", "mean_separation"))
    found = evaluator.linearization(space, at)
    apart = found.separations.reshape(2, -1)
    least, mean = evaluator.values(space.candidates(at[None]))[0]
    assert apart.min() == pytest.approx(least, rel=1e-12)
    assert apart.mean(axis=1).min() == pytest.approx(mean, rel=1e-12)
    step = 1e-3
    for k in range(at.size):
        ends = [evaluator.linearization(space, at + s * np.eye(at.size)[k]) for s in (step, -step)]
        rise = (ends[0].separations - ends[1].separations) / (2 * step)
        size = np.abs(rise).max()
        np.testing.assert_allclose(found.separations_jacobian[:, k], rise, atol=1e-6 * size)


def test_without_a_least_separation_of_the_worst_scene_a_linearization_has_no_separations():
    scenes = (plain_scene("kernel"), plain_scene("kernel", level_lux=3.0))
    for fields in ({"objectives": ("snr_y_db",)}, {"over_scenes": "mean"}):
        given = {"objectives": ("least_separation",)} | fields
        found = Objectives(scenes=scenes, **given).linearization(Bells(), AT)
        assert found.separations.size == 0


@pytest.mark.parametrize("at", [0.001, 0.02, 0.1])
def test_differences_at_a_bound_do_not_step_beyond_it(at):
    noiseless = replace(QUIET, read_noise_e=0.0, full_well_e=1e9)
    scene = plain_scene("bounded-psi=2", pixel=noiseless)  # no kernel computes its matrix
    evaluator = Objectives(scenes=(scene,), objectives=("snr_y_db",))
    assert not evaluator.has_exact_gradients(False)
    _, jacobian = evaluator.gradient(Times(), np.array([at]))
    np.testing.assert_allclose(jacobian, [[10 / np.log(10) / at]], rtol=1e-2)


def test_the_gradient_of_a_shot_limited_snr_over_time_is_known():
    noiseless = replace(QUIET, read_noise_e=0.0, full_well_e=1e9)
    evaluator = Objectives(scenes=(plain_scene(pixel=noiseless),), objectives=("snr_y_db",))
    _, jacobian = evaluator.gradient(Times(), np.array([0.02]))
    np.testing.assert_allclose(jacobian, [[10 / np.log(10) / 0.02]], rtol=1e-12)


def test_the_worst_scene_counts_or_the_mean():
    qe, names = bells(np.random.default_rng(9), 5, 3), ("snr_y_db", "noise_delta_e")
    scenes = tuple(plain_scene(level_lux=lux) for lux in (1.0, 10.0))
    dim, bright = (of_batch(scene, qe, names) for scene in scenes)
    worst, mean = (of_batch(scenes, qe, names, over_scenes=each) for each in ("worst", "mean"))
    assert (worst == dim).all()
    np.testing.assert_allclose(mean, (dim + bright) / 2)


def test_a_saturated_candidate_has_the_worst_values_and_never_nan():
    scene, names = plain_scene(time_s=10.0), tuple(OBJECTIVES)
    evaluator = Objectives(scenes=(scene,), objectives=names)
    own = Candidates(qe=bells(np.random.default_rng(10), 1, 3))
    assert evaluator.values_and_fullness(own)[1][0] > 1
    found = dict(zip(names, evaluator.values(own)[0], strict=True))
    assert (found["snr_y_db"], found["delta_e"]) == (-np.inf, np.inf)
    assert (found["least_separation"], found["information_bits"]) == (-np.inf, -np.inf)
    assert np.isfinite([found[name] for name in ("vora", "smi", "infrared_share")]).all()


def test_a_channel_that_measures_nothing_has_the_worst_values():
    qe = bells(np.random.default_rng(11), 2, 3)
    qe[0, :, 1] = 0.0
    for matrix in ("kernel", "lmmse"):
        found = of_batch(plain_scene(matrix), qe, ("snr_y_db", "vora"))
        assert (found[0] == -np.inf).all()
        assert np.isfinite(found[1]).all()


def test_pairs_of_a_scene_are_separated_instead_of_those_of_the_chart():
    chart = colorchecker(GRID)
    pairs = PatchPairs(patches=chart, indices=np.array([[0, 1], [4, 9]]))
    scene, names = plain_scene(pairs=pairs), ("least_separation", "mean_separation", "delta_e")
    qe = bells(np.random.default_rng(12), 1, 3)
    found = of_batch(scene, qe, names)[0]
    np.testing.assert_allclose(found, of_library(scene, qe[0], names), rtol=1e-9)


def test_the_worst_of_a_small_tolerance_is_the_gradient_times_the_tolerance():
    space = Bells(tolerance=1e-4)
    evaluator = Objectives(scenes=(plain_scene(),), objectives=("snr_y_db",))
    values, jacobian = evaluator.gradient(space, AT)

    def loss(around):
        return values - evaluator.values(space.candidates(around))

    worst = over_tolerances(loss, AT[None], space.parameters, RobustPart(samples=4096))[0, 0]
    np.testing.assert_allclose(worst, 1e-4 * np.abs(jacobian).sum(), rtol=0.1)


HALF = np.full((1, GRID.n, 3), 0.5)


@pytest.mark.parametrize(
    ("made", "fields"),
    [
        (lambda: of_batch((), HALF, ("vora",)), {"subject": "scenes"}),
        (lambda: of_batch(plain_scene(), HALF, ()), {"subject": "objectives"}),
        (lambda: of_batch(plain_scene(), HALF, ("snr_y",)), {"value": "snr_y"}),
        (lambda: of_batch(plain_scene(), HALF[:, :5], ("vora",)), {"value": 5}),
        (lambda: of_batch(plain_scene(), HALF[:0], ("vora",)), {"subject": "candidates"}),
        (
            lambda: Objectives(scenes=(plain_scene(),), objectives=("visual_noise",)).values(
                Candidates(qe=HALF, pixel_share=np.full((1, 3), 1 / 3))
            ),
            {"subject": "objective visual_noise"},
        ),
        (
            lambda: Objectives(scenes=(plain_scene(),), objectives=("vora",)).values(
                Candidates(qe=HALF, noise_weight=np.ones(1))
            ),
            {"value": "kernel"},
        ),
        (
            lambda: Objectives(scenes=(plain_scene(),), objectives=("vora",)).values_of_choices(
                np.array([[0, 9]]), np.full((GRID.n, 9), 0.5)
            ),
            {"value": 9},
        ),
        (lambda: plain_scene("kernal"), {"value": "kernal"}),
    ],
)
def test_what_cannot_be_evaluated_is_refused(made, fields):
    with refused_input(**fields):
        made()


def test_crosstalk_after_counting_is_refused():
    coupling = Crosstalk(matrix=np.full((3, 3), 1 / 3), pixels=(1, 1, 1), stage="charge")
    scene = plain_scene()
    with refused_input(subject="crosstalk_stage"):
        replace(
            scene,
            point=replace(scene.point, sensor=replace(scene.point.sensor, crosstalk=coupling)),
        )
