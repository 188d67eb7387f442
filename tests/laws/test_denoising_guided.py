"""The fast denoising method: flats, structure, infrared edges, strips, and odd pictures."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.ndimage import map_coordinates, uniform_filter

from chromanoise.base.rng import stream
from chromanoise.color import kernel_matrix
from chromanoise.imaging.denoising import denoised_planes, guided
from chromanoise.imaging.denoising.guided import GUIDED, denoise
from chromanoise.imaging.denoising.guided_kernels import add_estimates
from chromanoise.imaging.shared_rows import Work
from chromanoise.study import sensor_named
from noisy_planes import planes_with
from strategies import EXPOSURE

LARGEST_WINDOW = 11 * 11
EDGE = np.float32(1.5)


@cache
def to_xyz():
    """Electrons of onyx-rgbw to XYZ."""
    return kernel_matrix(sensor_named("onyx-rgbw"), EXPOSURE).matrix


def noisy(mean_e, *seed, **noise):
    """Planes of normal noise about a mean; the variance is that of the model."""
    spread = np.sqrt(planes_with(mean_e, **noise).variance_e2(mean_e))
    return planes_with(mean_e + spread * stream(19, *seed).normal(size=np.shape(mean_e)), **noise)


def flat(mean_e, height=96, width=128):
    return np.broadcast_to(np.float64(mean_e), (height, width, len(mean_e)))


def one_size(planes, radius):
    """The mean estimate of the windows of one size, without a pyramid."""
    values = np.ascontiguousarray(np.moveaxis(planes.values_e, 2, 0))
    _, height, width = values.shape
    sums, weight, active = np.zeros_like(values), *np.zeros((2, height, width), np.float32)
    noise = planes.law.coefficients
    shares = np.ones(height), np.ones(width)
    add_estimates(values, noise, *shares, radius, EDGE, sums, weight, active)
    return np.moveaxis(sums / weight, 0, 2)


@pytest.mark.parametrize("shape", [(2, 64, 70), (3, 33, 41), (1, 1, 5), (2, 6, 1)])
def test_a_level_is_halved_to_means_and_added_back_by_linear_interpolation(shape):
    fine = stream(23, *shape).normal(size=shape).astype(np.float32)
    padded = np.pad(fine, [(0, 0), *((0, size % 2) for size in shape[1:])], mode="edge")
    p, h, w = padded.shape
    half = padded.reshape(p, h // 2, 2, w // 2, 2).mean(axis=(2, 4), dtype=float)
    assert guided._halved(fine) == pytest.approx(half, abs=1e-6)
    at = np.meshgrid(*((np.arange(size) - 0.5) / 2 for size in shape[1:]), indexing="ij")
    between = [map_coordinates(plane, at, order=1, mode="nearest") for plane in half]
    added = fine.copy()
    guided._add_enlarged(added, half.astype(np.float32))
    assert added - fine == pytest.approx(np.array(between), abs=2e-6)


@pytest.mark.parametrize(("active", "deviations"), [(0.0, 8.0), (1.0, 1.0)])
def test_of_two_levels_that_far_apart_in_all_planes_half_the_difference_is_taken(
    active, deviations
):
    noise = np.array([[9.0, 100.0], [0.0, 0.0], [0.0, 0.0]])
    fine = np.full((2, 40, 36), 500.0, np.float32)
    apart = deviations * np.sqrt(noise[0] / 4).astype(np.float32)[:, None, None]
    coarse = np.float32(500.0) + np.broadcast_to(apart, (2, 20, 18))
    shares = np.full(20, 0.5), np.full(18, 0.5)  # of means of 2 x 2
    found = guided._believed(coarse, fine, np.full((40, 36), active, np.float32), noise, shares)
    assert found == pytest.approx(np.broadcast_to(apart / 2, found.shape), rel=1e-5)


def gain_db(before, after, mean):
    """In each plane, how far the mean square error falls."""
    errors = [np.square(np.float64(x) - mean).mean(axis=(0, 1)) for x in (before, after)]
    return 10 * np.log10(errors[0] / errors[1])


NOISES = {
    "read noise": {"floor_e2": 100.0},
    "shot noise": {"slope_e": 1.0},
    "all": {"floor_e2": 25.0, "slope_e": 1.0, "prnu": 0.01},
}


@pytest.mark.parametrize("noise", NOISES.values(), ids=NOISES)
@pytest.mark.parametrize("radius", [1, 2, 5])
def test_flats_gain_a_window_of_pixels_in_every_plane_and_in_xyz(noise, radius):
    mean = flat([310.0, 450.0, 220.0, 1400.0])
    planes = noisy(mean, radius, **noise)
    least = 10 * np.log10((2 * radius + 1) ** 2 / 2) - 1
    after = one_size(planes, radius)
    assert (gain_db(planes.values_e, after, mean) > least).all()
    before, after, mean = (x @ to_xyz().T for x in (planes.values_e, after, mean))
    assert (gain_db(before, after, mean) > least).all()


@pytest.mark.parametrize("noise", NOISES.values(), ids=NOISES)
@pytest.mark.parametrize("count", [1, 3, 4, 16])
def test_flats_gain_the_largest_window_on_all_levels(noise, count):
    mean = flat(np.linspace(20.0, 3000.0, count), 64, 96)
    planes = noisy(mean, 100 + count, **noise)
    least = 10 * np.log10(LARGEST_WINDOW / 2) - 1
    after = denoise(planes)
    assert (gain_db(planes.values_e, after, mean) > least).all()
    if count == 4:
        before, after, mean = (x @ to_xyz().T for x in (planes.values_e, after, mean))
        assert (gain_db(before, after, mean) > least).all()


@pytest.mark.parametrize("shape", [(1, 400), (400, 1), (7, 90), (2, 3)])
def test_flats_of_few_rows_or_columns_lose_noise_as_a_mean_of_all_that_is_near(shape):
    means = [flat([500.0, 50.0], *shape) for _ in range(40)]
    pairs = [(noisy(m, 7, i, slope_e=1.0, floor_e2=9.0), m) for i, m in enumerate(means)]
    errors = np.array(
        [
            [np.square(x - m).mean() for x in (planes.values_e, denoise(planes))]
            for planes, m in pairs
        ]
    ).mean(axis=0)
    near = min(shape[0], 88) * min(shape[1], 88)  # 11 pixels of the coarsest level
    assert 10 * np.log10(errors[0] / errors[1]) > 10 * np.log10(near / 2) - 1


def test_a_texture_is_kept_by_wieners_gain():
    """Independent pixels of 9 times the variance of the noise: 9 / 10 of each stays."""
    texture = 1000.0 + 30.0 * stream(19, 1).normal(size=(200, 200, 1))
    planes = noisy(texture, 2, floor_e2=100.0)
    found = one_size(planes, 5)
    inside = (slice(10, -10), slice(10, -10), 0)
    slope = np.polyfit(planes.values_e[inside].ravel(), found[inside].ravel(), 1)[0]
    assert slope == pytest.approx(0.9, abs=0.01)


def test_two_planes_of_one_texture_become_their_mean_times_wieners_gain():
    """Of equal noise 1 and power 4.5 each: the mean has gain 9 / 10, the difference none."""
    texture = np.sqrt(450.0) * stream(19, 3).normal(size=(200, 200, 1)) * [1.0, 1.0]
    planes = noisy(1000.0 + texture, 4, floor_e2=100.0)
    y, x = (
        (v - v.mean(axis=(0, 1)))[10:-10, 10:-10].reshape(-1, 2).astype(float)
        for v in (planes.values_e, one_size(planes, 5))
    )
    assert np.linalg.lstsq(y, x)[0] == pytest.approx(np.full((2, 2), 0.45), abs=0.015)


def scene(p=4, height=70, width=90):
    """Patches of ten materials."""
    materials = stream(19, 5).uniform(100.0, 4000.0, (10, p))
    rows, columns = np.ogrid[:height, :width]
    return materials[((rows // 9) * 3 + columns // 13 + (rows + columns > 80)) % 10]


@pytest.mark.parametrize("count", [1, 3, 4, 16])
@pytest.mark.parametrize("noise_e", [0.0, 1e-12, 1e-3, 0.1])
def test_values_without_noise_come_back(count, noise_e):
    values = scene(count)
    found = denoise(planes_with(values, floor_e2=noise_e**2))
    assert np.abs(found / values - 1).max() < 1e-3


def test_planes_without_noise_are_returned_and_the_others_are_not():
    planes = noisy(scene(), 6, floor_e2=[0.0, 900.0, 0.0, 900.0])
    found = denoise(planes)
    assert (found == planes.values_e).all(axis=(0, 1)).tolist() == [True, False, True, False]
    assert (gain_db(planes.values_e[..., 1::2], found[..., 1::2], scene()[..., 1::2]) > 3).all()


def test_the_low_frequencies_of_structure_are_not_replaced_by_coarse_ones():
    """Replaced without a gate, they cost 0.6 dB more."""
    mean = scene(4, 128, 160)
    planes = noisy(mean, 77, floor_e2=400.0, slope_e=1.0)
    assert gain_db(planes.values_e, denoise(planes), mean).mean() > 10.3


def crossed(edge):
    """A color edge between rows 23 and 24, and one without color between columns 23 and 24."""
    mean = np.empty((48, 48, 4))
    mean[:] = [310.0, 450.0, 220.0, 1400.0]
    mean[24:] *= 1.5
    mean[:, 24:] += edge
    return mean


def guided_by_last(planes, radius=5):
    """XYZ by the guided filter of He, Sun & Tang (2013), guided by the last plane."""
    size = (2 * radius + 1,) * 2
    values = np.float64(planes.values_e)
    xyz, guide = values @ to_xyz().T, values[..., -1]
    means = uniform_filter(guide, size)
    power = uniform_filter(guide**2, size) - means**2
    out = np.empty_like(xyz)
    for k in range(3):
        color = uniform_filter(xyz[..., k], size)
        slope = (uniform_filter(xyz[..., k] * guide, size) - color * means) / (power + means)
        rest = uniform_filter(color - slope * means, size)
        out[..., k] = uniform_filter(slope, size) * guide + rest
    return out


def test_an_edge_without_color_leaks_little_into_the_color():
    """At most 1 % of the color edge that crosses it; 10 % and more where the white plane guides."""
    colorless = np.linalg.svd(to_xyz())[2][-1]
    assert to_xyz() @ colorless == pytest.approx(0.0, abs=1e-9 * np.abs(to_xyz()).max())
    edge = 400.0 * colorless / np.abs(colorless).max()
    runs = [noisy(crossed(edge), 8, i, slope_e=1.0, floor_e2=4.0) for i in range(30)]
    mine = np.mean([denoise(run) @ to_xyz().T for run in runs], axis=0)
    white = np.mean([guided_by_last(run) for run in runs], axis=0)
    truth = crossed(edge) @ to_xyz().T
    step = truth[-1, 0, 1] - truth[0, 0, 1]
    leaks = [
        np.abs(x[18:30, 24:27, 1].mean(axis=1) - x[18:30, 21:24, 1].mean(axis=1)).mean() / step
        for x in (truth, mine, white)
    ]
    assert leaks[0] < 1e-9
    assert leaks[1] < 0.01 < 0.1 < leaks[2]


@pytest.mark.parametrize("width", [33, 64])
@pytest.mark.parametrize(("tile_rows", "threads"), [(1, 2), (50, 3), (128, 1), (None, 2)])
def test_strips_have_the_bits_of_the_whole_picture(width, tile_rows, threads):
    planes = noisy(scene(3, 451, width), 9, slope_e=1.0, floor_e2=400.0)
    found = denoised_planes(planes, GUIDED, work=Work(threads=threads, tile_rows=tile_rows))
    assert np.array_equal(found, denoise(planes))


def test_a_value_changes_only_what_is_within_reach():
    planes = noisy(scene(2, 400, 24), 10, floor_e2=400.0)
    other = planes.values_e.copy()
    other[200] += 500.0
    changed = (denoise(planes_with(other, floor_e2=400.0)) != denoise(planes)).any(axis=(1, 2))
    rows = np.flatnonzero(changed)
    assert GUIDED.reach_px - 20 < max(200 - rows[0], rows[-1] - 200) <= GUIDED.reach_px


@given(
    st.integers(1, 9),
    st.integers(1, 9),
    st.integers(1, 16),
    st.integers(0, 99),
    st.sampled_from([*NOISES.values(), {}]),
)
def test_small_pictures_have_finite_values_of_their_own_range(height, width, count, seed, noise):
    values = stream(19, seed).normal(0.0, 50.0, (height, width, count))
    values[values > 60.0] *= 1000.0
    found = denoise(planes_with(values, **noise))
    assert found.shape == values.shape
    assert np.isfinite(found).all()
    if not noise or height * width == 1:
        assert found == pytest.approx(np.float32(values), rel=1e-5)


@given(st.permutations(range(4)), st.floats(0.01, 100.0))
def test_the_order_and_the_unit_of_the_planes_do_not_matter(order, unit):
    order = list(order)
    noise = {"floor_e2": np.array([25.0, 100.0, 4.0, 400.0]), "slope_e": np.array([1, 2, 0, 1.0])}
    planes = noisy(scene(4, 20, 30), 11, **noise)
    other = planes_with(
        planes.values_e[..., order] * unit,
        floor_e2=noise["floor_e2"][order] * unit**2,
        slope_e=noise["slope_e"][order] * unit,
    )
    assert np.abs(denoise(other) / unit / denoise(planes)[..., order] - 1).max() < 2e-3


def test_a_transposed_picture_gives_the_transposed_result():
    planes = noisy(scene(3, 41, 66), 12, slope_e=1.0, floor_e2=100.0)
    other = planes_with(planes.values_e.swapaxes(0, 1), slope_e=1.0, floor_e2=100.0)
    assert np.abs(denoise(other).swapaxes(0, 1) / denoise(planes) - 1).max() < 1e-3
