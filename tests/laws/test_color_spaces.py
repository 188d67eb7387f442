"""What holds for every color and every noise on its way to the eye."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.color import (
    LAB,
    LINEAR_SRGB,
    LUV,
    SPACES,
    SRGB,
    NoisyColor,
    Space,
    cubature,
    first_order,
    gaussian_cubature,
    gaussian_expectation,
    mean_ciede2000,
    propagate,
    relative_sd_error,
)
from outcomes import refused_input
from strategies import raw_of, xyz_of

D65 = np.array([0.95047, 1.0, 1.08883])
COARSE = gaussian_cubature(radii=6, latitudes=4, longitudes=8)
coarse = partial(cubature, rule=COARSE)
EVERY = [pytest.param(space, id=name) for name, space in SPACES.items()]

whites = st.tuples(st.floats(0.8, 1.2), st.just(1.0), st.floats(0.4, 1.3)).map(np.array)
colors = st.lists(st.floats(0.02, 1.2), min_size=3, max_size=3).map(np.array)
beyond = st.lists(st.floats(-1.0, 2.0), min_size=3, max_size=3).map(np.array)
squares = st.lists(st.floats(-1.0, 1.0), min_size=9, max_size=9).map(
    lambda values: np.reshape(values, (3, 3))
)


def noise_of(measurement, space, method, white=D65):
    return propagate(NoisyColor(xyz=measurement, white=white), space, method)


def in_space(measurement, space, method, white=D65):
    return noise_of(measurement, space, method, white).measurement


def distance_to_a_kink(space, xyz, white):
    """In relative XYZ: the toes of CIELAB and sRGB, and where CIELUV's pole is bent."""
    toe = np.abs(xyz / white - 216 / 24389).min()
    linear = np.abs(LINEAR_SRGB.from_xyz(xyz, white) - 0.0031308).min() / 5
    weights = np.array([1.0, 15.0, 3.0])
    d, a = abs(xyz @ weights), np.abs(xyz) @ weights
    bent = min(abs(d - a / 2) / 40, np.abs(xyz).min() if d < a / 2 else 1.0, a / 20)
    return {"CIELAB": toe, "sRGB": linear, "CIELUV": min(toe, bent), "linear sRGB": 1.0}[space.name]


@pytest.mark.parametrize("space", EVERY)
@settings(max_examples=150)
@given(xyz=beyond, white=whites)
def test_the_jacobian_is_the_slope_of_the_map(space, xyz, white):
    step = 1e-5
    if distance_to_a_kink(space, xyz, white) < 1e-3:
        return
    moves = step * np.eye(3)
    ends = [space.from_xyz(xyz + sign * moves, white) for sign in (1, -1)]
    slope = (ends[0] - ends[1]).T / (2 * step)
    ours = space.jacobian(xyz, white)
    assert ours == pytest.approx(slope, abs=2e-4 * np.abs(ours).max())


@pytest.mark.parametrize("space", EVERY)
@given(xyz=beyond, white=whites, unit=st.floats(0.01, 1e4))
def test_a_space_knows_only_the_ratio_of_a_color_to_its_white(space, xyz, white, unit):
    assert space.from_xyz(unit * xyz, unit * white) == pytest.approx(
        space.from_xyz(xyz, white), abs=1e-8
    )


@pytest.mark.parametrize(
    ("space", "coordinates"),
    [(LINEAR_SRGB, [1, 1, 1]), (SRGB, [1, 1, 1]), (LAB, [100, 0, 0]), (LUV, [100, 0, 0])],
)
@given(white=whites)
def test_white_is_white_in_every_space(space, coordinates, white):
    # the matrix of IEC 61966-2-1 is printed to 4 digits
    assert space.from_xyz(white, white) == pytest.approx(coordinates, abs=2e-4)


@pytest.mark.parametrize("space", EVERY)
@given(start=beyond, end=beyond, white=whites)
def test_no_color_is_torn_from_its_neighbors(space, start, end, white):
    along = np.linspace(0, 1, 4001)[:, None]
    path = start + along * (end - start)
    steps = np.linalg.norm(np.diff(space.from_xyz(path, white), axis=0), axis=1)
    steepest = {"CIELAB": 1e4, "CIELUV": 4e5, "sRGB": 80, "linear sRGB": 10}[space.name]
    assert steps.max() <= steepest * np.linalg.norm(end - start) / 4000 + 1e-6


@pytest.mark.parametrize("space", [LAB, LUV])
def test_black_is_black(space):
    assert space.from_xyz(np.zeros(3), D65) == pytest.approx([0, 0, 0], abs=1e-12)
    assert np.isfinite(space.jacobian(np.zeros(3), D65)).all()


@pytest.mark.parametrize("space", EVERY)
@given(xyz=colors, root=squares)
def test_in_the_limit_of_little_noise_first_order_and_cubature_agree(space, xyz, root):
    noisy = xyz_of(xyz, 1e-10 * root @ root.T)
    one, two = (in_space(noisy, space, method) for method in (first_order, cubature))
    scale = np.abs(one.covariance).max()
    assert two.mean == pytest.approx(one.mean, abs=1e-4)
    if distance_to_a_kink(space, xyz, D65) > 1e-3:
        assert two.covariance == pytest.approx(one.covariance, abs=1e-4 * scale + 1e-22)


@given(xyz=beyond, root=squares, white=whites)
def test_through_a_linear_space_both_methods_are_the_matrix(xyz, root, white):
    noisy = xyz_of(xyz, root @ root.T)
    matrix = LINEAR_SRGB.from_xyz(np.eye(3), white).T
    expected = matrix @ root @ root.T @ matrix.T
    for method in (first_order, cubature):
        rgb = in_space(noisy, LINEAR_SRGB, method, white)
        assert rgb.mean == pytest.approx(matrix @ xyz, abs=1e-9)
        assert rgb.covariance == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("snr_db", [30.0, 10.0, 5.0])
@pytest.mark.parametrize("name", ["lab", "luv", "srgb"])
def test_a_monte_carlo_finds_the_cubature(name, snr_db):
    space, draws = SPACES[name], 100_000
    mean = np.array([0.22, 0.18, 0.10])
    shape = np.array([[1.0, 0.6, 0.1], [0.6, 1.0, -0.3], [0.1, -0.3, 1.5]])
    noisy = xyz_of(mean, (0.18 / 10 ** (snr_db / 20)) ** 2 * shape)
    rng = np.random.default_rng([7, int(snr_db)])
    drawn = rng.multivariate_normal(mean, noisy.covariance, size=draws, method="cholesky")
    values = space.from_xyz(drawn, D65)
    noise = noise_of(noisy, space, cubature)
    found = noise.measurement
    assert_means(values, found.mean)
    away = values - found.mean
    products = (away[:, :, None] * away[:, None, :]).reshape(draws, 9)
    assert_means(products, found.covariance.ravel())
    if name == "srgb":
        return
    assert_means(np.linalg.norm(values - space.from_xyz(mean, D65), axis=1), noise.delta_e)
    chroma = np.hypot(values[:, 1], values[:, 2])
    still = np.hypot(*space.from_xyz(mean, D65)[1:])
    assert_means(chroma - still, noise.chroma_bias)
    assert_means((chroma - chroma.mean()) ** 2, noise.chroma_sd**2)


def assert_means(samples, expected):
    error = samples.std(axis=0) / np.sqrt(len(samples))
    assert np.abs((samples.mean(axis=0) - expected) / error).max() < 5


def test_a_monte_carlo_finds_the_mean_ciede2000():
    import colour

    mean = np.array([0.22, 0.18, 0.10])
    noisy = xyz_of(mean, 1e-4 * np.eye(3))
    drawn = np.random.default_rng(3).multivariate_normal(mean, 1e-4 * np.eye(3), size=20_000)
    still = np.broadcast_to(LAB.from_xyz(mean, D65), drawn.shape)
    samples = colour.difference.delta_E_CIE2000(still, LAB.from_xyz(drawn, D65))
    assert_means(samples, mean_ciede2000(NoisyColor(xyz=noisy, white=D65)))


@pytest.mark.parametrize("space", [LAB, LUV])
def test_a_picture_of_equal_pixels_gives_the_noise_of_the_point(space):
    shape = np.array([[1.0, 0.6, 0.1], [0.6, 1.0, -0.3], [0.1, -0.3, 1.5]]) * 1e-3
    point = xyz_of(np.array([0.22, 0.18, 0.10]), shape)
    tiles = (70, 20)  # 1400 pixels of 384 points: more than one chunk
    picture = xyz_of(np.tile(point.mean, (*tiles, 1)), np.tile(shape, (*tiles, 1, 1)))
    for method in (first_order, coarse):
        one, many = (noise_of(each, space, method) for each in (point, picture))
        assert many.delta_e.shape == tiles
        for name in ("bias", "chroma_sd", "chroma_bias", "delta_e"):
            alone, together = getattr(one, name), getattr(many, name)
            wide = np.broadcast_to(alone, together.shape)
            assert together == pytest.approx(wide, rel=1e-9, abs=1e-12)
        alone, together = one.measurement.covariance, many.measurement.covariance
        assert np.allclose(together, alone, rtol=1e-9, atol=1e-12)


def test_each_pixel_has_its_own_noise():
    means = np.array([[0.2, 0.2, 0.2], [0.5, 0.4, 0.1]])
    noises = np.array([1e-3, 1e-5])[:, None, None] * np.eye(3)
    both = in_space(xyz_of(means, noises), LAB, cubature)
    for i in (0, 1):
        alone = in_space(xyz_of(means[i], noises[i]), LAB, cubature)
        assert both.mean[i] == pytest.approx(alone.mean, rel=1e-12)
        assert both.covariance[i] == pytest.approx(alone.covariance, rel=1e-9)


@pytest.mark.parametrize("space", EVERY)
@given(xyz=colors, root=squares, rank=st.integers(0, 2))
def test_a_singular_covariance_is_no_obstacle(space, xyz, root, rank):
    spread = 0.1 * root[:, :rank]
    noisy = xyz_of(xyz, spread @ spread.T)
    found = in_space(noisy, space, coarse)
    assert np.isfinite(found.covariance).all()
    assert np.linalg.eigvalsh(found.covariance)[0] >= -1e-9 * np.trace(found.covariance)
    # the same singular noise, its few directions written out: no root of a matrix is taken
    along = np.pad(spread, ((0, 0), (0, 3 - rank)))
    mean = COARSE.weights @ space.from_xyz(xyz + COARSE.points @ along.T, D65)
    sd = np.sqrt(found.variance)
    assert found.mean == pytest.approx(mean, abs=0.2 * sd.max() + 1e-9)


@pytest.mark.parametrize("method", [first_order, cubature])
def test_without_noise_nothing_moves(method):
    noise = noise_of(xyz_of(np.array([0.3, 0.2, 0.1]), np.zeros((3, 3))), LAB, method)
    assert noise.bias == pytest.approx([0, 0, 0], abs=1e-12)
    assert noise.delta_e == pytest.approx(0, abs=1e-12)
    assert noise.chroma_sd == pytest.approx(0, abs=1e-12)
    assert list(relative_sd_error(noise.measurement, noise.measurement)) == [0, 0, 0]


@given(xyz=colors, root=squares, unit=st.floats(0.01, 1e4))
def test_noise_in_lux_is_the_noise_in_shares_of_white(xyz, root, unit):
    spread = 1e-3 * (root + 2 * np.eye(3))
    shares = xyz_of(xyz, spread @ spread.T)
    lux = xyz_of(unit * xyz, unit**2 * spread @ spread.T)
    one, two = (
        in_space(shares, LAB, first_order),
        in_space(lux, LAB, first_order, unit * D65),
    )
    assert two.covariance == pytest.approx(one.covariance, rel=1e-6, abs=1e-9)


@given(colors)
def test_the_first_order_is_low_in_the_dark_and_right_in_the_light(xyz):
    dark, light = (
        relative_sd_error(
            *(
                in_space(xyz_of(xyz, np.diag(xyz**2) / 10 ** (db / 10)), LAB, method)
                for method in (first_order, cubature)
            )
        )
        for db in (5.0, 40.0)
    )
    assert dark[0] < -0.05
    assert np.abs(light) == pytest.approx(np.zeros(3), abs=0.01)


@pytest.mark.parametrize("method", [first_order, cubature])
@pytest.mark.parametrize("space", [SRGB, LINEAR_SRGB])
def test_a_space_without_color_differences_has_neither_chroma_nor_delta_e(method, space):
    noise = noise_of(xyz_of(D65, 1e-4 * np.eye(3)), space, method)
    assert noise.chroma_sd is None
    assert noise.chroma_bias is None
    assert noise.delta_e is None


@given(xyz=colors, root=squares)
def test_the_first_order_color_difference_is_that_of_a_cubature_over_the_linear_map(xyz, root):
    noisy = xyz_of(xyz, 1e-6 * root @ root.T)
    slope = LAB.jacobian(xyz, D65)
    covariance = slope @ noisy.covariance @ slope.T
    mean_length = gaussian_expectation(
        lambda away: np.linalg.norm(away, axis=-1)[..., None], np.zeros(3), covariance
    )
    assert noise_of(noisy, LAB, first_order).delta_e == pytest.approx(
        mean_length[0], rel=5e-3, abs=1e-9
    )


def test_noise_of_other_coordinates_is_refused():
    raw = raw_of(D65, np.eye(3), ("R", "G", "B"))
    with refused_input(subject="coordinates of the raw measurement", value=("R", "G", "B")):
        NoisyColor(xyz=raw, white=D65)


@pytest.mark.parametrize("space", EVERY)
def test_a_white_that_is_no_light_is_refused(space):
    for ask in (space.from_xyz, space.jacobian):
        with refused_input(subject="white", value=[1.0, 1.0, 0.0]):
            ask(D65, np.array([1.0, 1.0, 0.0]))


def test_an_impossible_covariance_is_refused():
    impossible = np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    with refused_input(subject="covariance") as caught:
        gaussian_expectation(np.square, D65, impossible)
    assert caught.value.value == pytest.approx(-1.0)
    with refused_input(subject="covariance"):
        noise_of(xyz_of(D65, impossible), LAB, first_order)


def test_a_rule_of_one_point_and_a_space_without_names_are_refused():
    with refused_input(subject="latitudes", value=1):
        gaussian_cubature(latitudes=1)
    with refused_input(subject="coordinates of a color space", value="g"):
        Space(
            name="gray", coordinates=("g", "g", "h"), from_xyz=LAB.from_xyz, jacobian=LAB.jacobian
        )
