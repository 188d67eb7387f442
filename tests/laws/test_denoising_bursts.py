"""Bursts: variance, fixed patterns, weights, what moved, what is saturated."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.imaging.denoising import BurstFrame, merged_frames
from chromanoise.sensor import VarianceLaw
from noisy_planes import planes_of
from outcomes import refused_input

SIDE = 600


def camera(*, p=1, floor=100.0, prnu=0.0):
    """The first frame, still without values."""
    return replace(
        planes_of(np.zeros((1, 1, p))),
        law=VarianceLaw(floor_e2=floor, slope_e=1.0, square=prnu**2),
    )


def draw_frames(planes, means, rng, exposures, *, gains=1.0, offsets=0.0, fixed=0.0):
    """Frames of a scene of mean electrons, with Poisson and Gaussian noise and fixed patterns."""
    read = np.sqrt(planes.law.floor_e2 - fixed)
    return [
        (rng.poisson(gains * means * t) + offsets + rng.normal(size=means.shape) * read).astype(
            np.float32
        )
        for t in exposures
    ]


def merged(planes, values, exposures, **options):
    others = (BurstFrame(values_e=v, exposure=t) for v, t in zip(values[1:], exposures[1:]))  # noqa: B905
    return merged_frames(replace(planes, values_e=values[0]), others, **options)


@pytest.mark.parametrize(
    "exposures", [(1.0,), (1.0, 1.0, 1.0, 1.0), (1.0, 4.0, 0.25)], ids=["one", "equal", "bracketed"]
)
def test_noise_of_the_result_is_that_of_draws(exposures):
    rng, fixed = stream(1, len(exposures)), 36.0
    planes = camera(prnu=0.02)
    gains = 1 + 0.02 * rng.normal(size=(SIDE, SIDE, 1))
    offsets = 6.0 * rng.normal(size=(SIDE, SIDE, 1))
    for level in (20.0, 2000.0):
        values = draw_frames(
            planes, np.full((SIDE, SIDE, 1), level), rng, exposures,
            gains=gains, offsets=offsets, fixed=fixed,
        )  # fmt: skip
        found = merged(
            planes,
            values,
            exposures,
            fixed=VarianceLaw(floor_e2=fixed, square=0.02**2),
            false_alarm=1e-12,
        )
        assert (found.used == 1).all()
        assert found.frames == len(exposures)
        (variance,) = found.planes.variance_e2(np.array([level]))
        assert abs(found.planes.values_e.var() / variance - 1) < 5 * np.sqrt(2) / SIDE
        assert abs(found.planes.values_e.mean() - level) < 5 * np.sqrt(variance) / SIDE


def test_equal_frames_average_the_temporal_noise_and_no_fixed_pattern():
    planes = replace(camera(p=2, floor=136.0, prnu=0.01), values_e=np.ones((4, 5, 2), np.float32))
    frames = [BurstFrame(values_e=planes.values_e)] * 7
    found = merged_frames(planes, frames, fixed=VarianceLaw(floor_e2=36.0, square=1e-4)).planes
    assert found.law.floor_e2 == pytest.approx([100 / 8 + 36] * 2)
    assert found.law.slope_e == pytest.approx([1 / 8] * 2)
    assert found.law.square == pytest.approx([1e-4] * 2)
    assert found.values_e == pytest.approx(planes.values_e)


def test_weights_of_a_bracket_are_known():
    """Four times the light: at 100 e-, variances 200 and (100 + 400) / 16 = 31.25."""
    planes = replace(
        camera(), prior_mean_e=np.array([100.0]), values_e=np.full((1, 1, 1), 90, np.float32)
    )
    long = BurstFrame(values_e=np.full((1, 1, 1), 440, np.float32), exposure=4.0)
    found = merged_frames(planes, [long], window_px=1).planes
    share = (1 / 31.25) / (1 / 200 + 1 / 31.25)
    assert found.values_e[0, 0, 0] == pytest.approx(90 + 20 * share)
    assert found.variance_e2(np.array([100.0])) == pytest.approx(1 / (1 / 200 + 1 / 31.25))


@pytest.mark.parametrize(("p", "window"), [(1, 1), (4, 1), (1, 3), (4, 3)])
@pytest.mark.parametrize("false_alarm", [1e-2, 1e-3])
@pytest.mark.parametrize("exposure", [1.0, 3.0])
def test_still_pixels_are_rejected_at_the_stated_rate(p, window, false_alarm, exposure):
    rng = stream(2, p, window)
    planes = camera(p=p)
    values = draw_frames(planes, np.full((450, 450, p), 200.0), rng, (1.0, exposure))
    found = merged(planes, values, (1.0, exposure), false_alarm=false_alarm, window_px=window)
    rejected = found.used[::window, ::window, 0] < 1  # windows that share no pixel
    error = np.sqrt(false_alarm * (1 - false_alarm) / rejected.size)
    assert abs(rejected.mean() - false_alarm) < 5 * error + 0.1 * false_alarm


def test_the_rate_is_also_that_of_borders_and_of_fixed_patterns():
    rng, fixed, exposures = stream(5), 64.0, (1.0, 4.0)
    planes, shape = camera(p=2), (2, 150_000, 2)
    offsets = 8.0 * rng.normal(size=shape)
    values = draw_frames(planes, np.full(shape, 50.0), rng, exposures, offsets=offsets, fixed=fixed)
    found = merged(planes, values, exposures, fixed=VarianceLaw(floor_e2=fixed), false_alarm=1e-2)
    rejected = found.used[0, 1::3, 0] < 1  # of 2 x 3 pixels
    assert abs(rejected.mean() - 1e-2) < 5 * np.sqrt(1e-2 / rejected.size)


def test_what_moved_is_that_of_the_first_frame():
    rng = stream(3)
    planes, size = camera(p=2), 60
    scenes = []
    for at in (5, 20, 35):
        scene = np.full((size, size, 2), 100.0)
        scene[10:22, at : at + 12] = 600.0
        scenes.append(scene)
    values = [draw_frames(planes, scene, rng, (1.0,))[0] for scene in scenes]
    found = merged(planes, values, (1.0,) * 3)
    error = found.planes.values_e - scenes[0]
    assert np.abs(error.mean(axis=(0, 1))).max() < 1.0
    ghost = error[10:22, 22:47]  # the background over which the square moved
    assert np.abs(ghost.mean()) < 5 * np.sqrt(200 / ghost.size)
    assert (found.used[10:22, 5:17] < 0.5).all()  # only the first frame
    assert (found.used[30:, :] == 1).mean() > 0.99


def test_saturated_values_are_not_used():
    planes = camera()
    scene = np.full((3, 40, 1), 50.0)
    scene[:, 20:30], scene[:, 30:] = 500.0, 5000.0
    values = [np.minimum(scene * t, 1000.0).astype(np.float32) for t in (1.0, 4.0)]
    found = merged(planes, values, (1.0, 4.0), saturation_e=1000.0)
    assert found.planes.values_e[:, :30] == pytest.approx(scene[:, :30])
    assert (found.used[:, :20] == 1).all()
    assert ((found.used[:, 20:30] > 0) & (found.used[:, 20:30] < 1)).all()
    assert (found.used[:, 30:] == 0).all()
    assert (found.planes.values_e[:, 30:] == 1000).all()
    # a first frame that is saturated: the shorter one is used
    shorter = merged(planes, values[::-1], (1.0, 0.25), saturation_e=1000.0)
    assert shorter.planes.values_e[:, :30] == pytest.approx(4 * scene[:, :30])


def test_rows_that_are_tested_together_change_no_bit(monkeypatch):
    planes = camera(p=2)
    values = draw_frames(planes, np.full((150, 40, 2), 50.0), stream(4), (1.0, 2.0))
    whole = merged(planes, values, (1.0, 2.0), false_alarm=0.2, window_px=5)
    monkeypatch.setattr("chromanoise.imaging.denoising.raw_pictures._ROWS", 7)
    parts = merged(planes, values, (1.0, 2.0), false_alarm=0.2, window_px=5)
    assert (whole.planes.values_e == parts.planes.values_e).all()
    assert (whole.used == parts.used).all()


def test_frames_are_read_one_at_a_time():
    planes, alive = replace(camera(), values_e=np.ones((8, 8, 1), np.float32)), []

    def frames():
        for _ in range(5):
            alive.append(np.ones((8, 8, 1), np.float32))
            yield BurstFrame(values_e=alive.pop())
            assert not alive

    assert merged_frames(planes, frames()).frames == 6


def test_bad_bursts_are_refused():
    planes = replace(camera(), values_e=np.ones((8, 8, 1), np.float32))
    with refused_input(subject="frame 2 of the burst", value=(7, 8, 1)):
        merged_frames(planes, [BurstFrame(values_e=np.ones((7, 8, 1), np.float32))])
    with refused_input(subject="frame 2 of the burst", value=np.inf):
        merged_frames(planes, [BurstFrame(values_e=np.full((8, 8, 1), np.inf, np.float32))])
    with refused_input(subject="exposure of a frame", value=0.0):
        BurstFrame(values_e=planes.values_e, exposure=0.0)
    with refused_input(subject="floor_e2 without that of a part", value=-1.0):
        merged_frames(planes, [], fixed=VarianceLaw(floor_e2=101.0))
    with refused_input(subject="window_px", value=2):
        merged_frames(planes, [], window_px=2)
    with refused_input(subject="false_alarm", value=0.0):
        merged_frames(planes, [], false_alarm=0.0)
    law = VarianceLaw(floor_e2=100.0)
    with refused_input(subject="temporal noise of the planes"):
        merged_frames(replace(planes, law=law), [], fixed=law)
