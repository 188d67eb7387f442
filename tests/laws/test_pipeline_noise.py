"""The camera's own pipeline: linear steps compose, each by another road, gain and white balance."""

from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.base import plain
from chromanoise.base.rng import stream
from chromanoise.color import (
    LAB,
    SRGB,
    TONES,
    checked_gains,
    encoded,
    encoded_space,
    exact,
    first_order,
    gains_covariance,
    gray_gains,
    linear_srgb,
    luma_chroma,
    luma_chroma_matrix,
    matrix_for_balanced,
    rendered_lab_space,
    rendering_matrix,
    saturation_matrix,
    tone_curve,
    white_balanced,
    with_exposure_gain,
    with_saturation,
)
from chromanoise.noise import (
    Exposure,
    expected_electrons,
    noise_sources,
    sample_electrons,
    through,
)
from chromanoise.sensor import (
    Adc,
    Crosstalk,
    noise_profile,
    white_level_e,
    with_analog_gain,
    with_binning,
    with_crosstalk,
    with_pixel,
)
from chromanoise.spectra import (
    DEFAULT_GRID,
    Scene,
    black_body,
    colorchecker,
    equal_energy,
    flat_field,
)
from chromanoise.study import PipelineSettings, analyzed, chart_noise, pipeline_noise, sensor_named
from dear import dear
from outcomes import refused_input
from strategies import raw_of

LAMP = equal_energy(DEFAULT_GRID)
NAMES = [
    *("raw", "white-balanced", "XYZ", "linear sRGB", "exposure", "saturation", "sRGB"),
    *("Y'CbCr", "Lab"),
]


@cache
def seen(name="model-rgb-ircut", level_lux=10.0, pixel=(), lamp=LAMP, time_s=0.011):
    sensor = with_pixel(sensor_named(name, DEFAULT_GRID), dict(pixel))
    return analyzed(flat_field(lamp, level_lux=level_lux), sensor, Exposure(time_s=time_s))


@cache
def found(analysis=None, method=None, **settings):
    return pipeline_noise(analysis or seen(), PipelineSettings(**settings), method=method)


quick = partial(found, method=first_order)  # for what does not depend on the method


def random_raw(rng, p=3):
    root = rng.normal(size=(p, p))
    return raw_of(rng.uniform(1, 9, p), root @ root.T, tuple("RGBW"[:p]))


# linear steps


@given(st.integers(0, 10_000), st.integers(2, 4))
def test_the_linear_steps_compose_to_one_matrix(seed, p):
    rng = np.random.default_rng(seed)
    raw, matrix, gains = random_raw(rng, p), rng.normal(size=(3, p)), rng.uniform(0.5, 3, p)
    rgb = ("R", "G", "B")
    balanced = white_balanced(raw, gains)
    linear = through(balanced, matrix, names=rgb, kind="linear", unit="1")
    last = luma_chroma(with_saturation(with_exposure_gain(linear, 1.7), 1.4), "bt601")
    whole = luma_chroma_matrix("bt601") @ saturation_matrix(1.4) * 1.7 @ matrix @ np.diag(gains)
    size = np.abs(whole) @ np.abs(raw.mean)
    assert np.abs(last.mean - whole @ raw.mean).max() < 1e-12 * size.max()
    one = whole @ raw.covariance @ whole.T
    assert np.abs(last.covariance - one).max() < 1e-12 * np.abs(one).max() * 10


def test_the_steps_of_a_chart_compose_to_one_matrix():
    analysis = seen()
    result = quick(analysis, saturation=1.2, exposure_gain=0.8)
    white = analysis.matrix.matrix @ analysis.expected_e
    steps = rendering_matrix(white / white[1], exposure_gain=0.8, saturation=1.2)
    one = steps @ analysis.matrix.matrix / white[1]
    raw, last = result.step("raw"), result.step("saturation")
    assert last.mean == pytest.approx(raw.mean @ one.T, rel=1e-12, abs=1e-12)
    assert last.covariance == pytest.approx(one @ raw.covariance @ one.T, rel=1e-9, abs=1e-12)


def test_a_matrix_for_balanced_raw_gives_the_color_of_the_matrix_for_raw():
    rng = np.random.default_rng(1)
    raw, matrix, gains = random_raw(rng), rng.normal(size=(3, 3)), np.array([2.0, 1.0, 1.6])
    composed = matrix_for_balanced(matrix, gains) @ white_balanced(raw, gains).mean
    assert composed == pytest.approx(matrix @ raw.mean, rel=1e-14)


def test_saturation_keeps_luminance_and_neutrals_and_composes():
    one = saturation_matrix(0.5) @ saturation_matrix(0.4)
    assert one == pytest.approx(saturation_matrix(0.2), abs=1e-15)  # s I + (1 - s) P, P^2 = P
    rgb, luma = np.array([0.3, 0.5, 0.1]), np.array([0.2126, 0.7152, 0.0722])
    assert luma @ saturation_matrix(1.8) @ rgb == pytest.approx(luma @ rgb, rel=1e-15)
    assert saturation_matrix(1.8) @ np.full(3, 0.4) == pytest.approx(0.4)
    assert saturation_matrix(1.0).tolist() == np.eye(3).tolist()


def test_without_saturation_all_chroma_noise_is_gone():
    result = found(saturation=0.0)
    assert np.abs(result.step("Y'CbCr").covariance[:, 1:, 1:]).max() < 1e-18
    assert np.sqrt(result.step("Lab").variance[:, 1:]).max() < 0.02  # the printed matrix is rounded


def test_luma_and_chroma_of_the_primaries_are_those_of_the_recommendations():
    # ITU-R BT.601: blue has Cb = 1/2, red Cr = 1/2, white neither; 8 bit weights 0.169, 0.331
    table = luma_chroma_matrix("bt601")
    assert table[1] == pytest.approx([-0.168736, -0.331264, 0.5], abs=1e-6)
    assert table[2] == pytest.approx([0.5, -0.418688, -0.081312], abs=1e-6)
    for standard in ("bt601", "bt709"):
        assert luma_chroma_matrix(standard) @ np.ones(3) == pytest.approx([1, 0, 0], abs=1e-15)


# tone curves


@pytest.mark.parametrize("tone", [*TONES, 0.45, 1.0, 1.8, 2.4])
def test_the_slope_of_a_tone_curve_is_its_difference_quotient(tone):
    curve, h = tone_curve(tone), 1e-7
    x = np.array([-0.3, -0.01, 0.001, 0.01, 0.1, 0.5, 0.99, 1.3])
    quotient = (curve.of(x + h) - curve.of(x - h)) / (2 * h)
    assert curve.slope(x) == pytest.approx(quotient, rel=1e-5)
    assert curve.of(np.array([0.0, 1.0])) == pytest.approx([0.0, 1.0], abs=1e-12)


def test_srgb_without_further_steps_is_the_space_srgb():
    xyz, white = np.array([[0.2, 0.3, 0.1], [0.01, 0.0, -0.02]]), np.array([1.1, 1.0, 0.4])
    own = encoded_space(tone_curve("srgb"), exposure_gain=1.0, saturation=1.0)
    assert own.from_xyz(xyz, white) == pytest.approx(SRGB.from_xyz(xyz, white), abs=1e-14)
    assert own.jacobian(xyz, white) == pytest.approx(SRGB.jacobian(xyz, white), abs=1e-12)


@pytest.mark.parametrize("made", ["encoded", "lab"])
def test_the_jacobian_of_a_rendered_space_is_its_difference_quotient(made):
    steps = {"exposure_gain": 0.7, "saturation": 1.4}
    space = {"encoded": partial(encoded_space, tone_curve("rec709")), "lab": rendered_lab_space}
    own = space[made](**steps)
    xyz, white, h = np.array([0.2, 0.3, 0.15]), np.array([1.1, 1.0, 0.4]), 1e-6
    quotient = [
        (own.from_xyz(xyz + h * axis, white) - own.from_xyz(xyz - h * axis, white)) / (2 * h)
        for axis in np.eye(3)
    ]
    assert own.jacobian(xyz, white) == pytest.approx(np.array(quotient).T, rel=1e-5)


def test_the_steps_one_by_one_are_the_space_to_first_order():
    analysis = seen(level_lux=10.0)
    settings = PipelineSettings(tone="rec709", saturation=1.1)
    result = pipeline_noise(analysis, settings, method=first_order)
    step = encoded(result.step("saturation"), tone_curve("rec709"))
    assert result.step("Rec. 709").mean == pytest.approx(step.mean, abs=1e-12)
    assert result.step("Rec. 709").covariance == pytest.approx(step.covariance, rel=1e-8, abs=1e-15)


def test_the_cubature_agrees_with_the_exact_distribution_of_the_electrons():
    analysis = seen(level_lux=3.0)
    fine = pipeline_noise(analysis, method=partial(exact, points=2**11))
    for rough, good in zip(pipeline_noise(analysis).steps, fine.steps, strict=True):
        sd, trusted = (np.sqrt(one.measurement.variance) for one in (rough, good))
        assert sd == pytest.approx(trusted, rel=0.02), rough.name


def drawn_steps(analysis, gain, patch, draws=400_000):
    """sRGB, Y'CbCr and Lab of plain draws of one patch."""
    sensor, time_s = analysis.sensor, analysis.exposure.time_s / gain
    pixel, converter = sensor.pixel, sensor.converter
    chart = expected_electrons(
        Scene(
            illuminant=analysis.scene.illuminant,
            level_lux=analysis.scene.level_lux,
            reflectance=colorchecker(sensor.grid).values.T,
        ),
        sensor,
        replace(analysis.exposure, time_s=time_s),
    )
    rng, dark_e = np.random.default_rng(17), pixel.dark_current_e_per_s * time_s
    read = rng.poisson(chart[patch] + dark_e, (draws, 3)) - dark_e
    read = read + pixel.read_noise_e * rng.standard_normal(read.shape)
    if converter.gain_e_per_dn:
        step = converter.gain_e_per_dn / gain
        read = step * np.floor(read / step + 0.5)
    white = analysis.matrix.matrix @ analysis.expected_e
    xyz = gain * read @ analysis.matrix.matrix.T / white[1]
    rgb = xyz @ linear_srgb(np.eye(3), white / white[1])
    toe = rgb <= 0.0031308  # IEC 61966-2-1, its linear part also below 0
    code = np.where(toe, 12.92 * rgb, 1.055 * np.where(toe, 1.0, rgb) ** (1 / 2.4) - 0.055)
    lab = rendered_lab_space(exposure_gain=1.0, saturation=1.0)
    return {
        "sRGB": code,
        "Y'CbCr": code @ luma_chroma_matrix("bt709").T,
        "Lab": lab.from_xyz(xyz, white / white[1]),
    }


FEW = {"read_noise_e": 0.7, "dark_current_e_per_s": 90.0, "full_well_e": 3000.0}


@pytest.mark.parametrize("converter", [*dear({}), {"bits": 12, "gain_e_per_dn": 12.0}])
def test_every_step_of_few_electrons_has_the_moments_of_plain_draws(converter):
    analysis = seen(level_lux=3.0, time_s=0.008, pixel=tuple((FEW | converter).items()))
    result = found(analysis, iso=(800.0,)).iso[0]
    steps = {one.name: one.measurement for one in result.steps}
    for patch in (18, 23):
        for name, values in drawn_steps(analysis, 8.0, patch).items():
            root, sd = len(values) ** 0.5, values.std(axis=0)
            mean, variance = steps[name].mean[patch], steps[name].variance[patch]
            squares = (values - values.mean(axis=0)) ** 2
            own = 1e-3 * sd  # of the quasi-Monte Carlo nets
            z = np.abs(values.mean(axis=0) - mean) / np.hypot(sd / root, own)
            z_variance = np.abs(squares.mean(axis=0) - variance) / np.hypot(
                squares.std(axis=0) / root, 2 * own * sd
            )
            assert max(z.max(), z_variance.max()) < 5, (patch, name)


def test_a_note_says_where_correlated_readings_of_few_electrons_are_taken_as_normal():
    sensor = seen(pixel=tuple(FEW.items())).sensor
    sensor = with_crosstalk(
        sensor, Crosstalk(matrix=0.85 * np.eye(3) + 0.05, stage="charge", pixels=(1, 1, 1))
    )
    analysis = analyzed(flat_field(LAMP, level_lux=3.0), sensor, Exposure(time_s=0.008))
    (note,) = [one for one in found(analysis, iso=(100.0, 800.0)).notes if "few electrons" in one]
    assert "at ISO 800" in note
    assert not [one for one in found(seen()).notes if "few electrons" in one]


def test_a_white_is_1_before_the_tone_curve_and_lab_100_0_0():
    analysis = seen()
    white = analysis.matrix.matrix @ analysis.expected_e
    white /= white[1]
    lab = rendered_lab_space(exposure_gain=1.0, saturation=1.0)
    assert lab.from_xyz(white, white) == pytest.approx([100, 0, 0], abs=1e-9)
    assert linear_srgb(white, white) == pytest.approx([1, 1, 1], abs=2e-4)  # printed to 4 digits
    chart = chart_noise(analysis).noise.measurement
    own = found(analysis).step("Lab")
    assert own.mean[:, 0] == pytest.approx(chart.mean[:, 0], abs=1.5)  # adapted by Bradford
    assert LAB.coordinates == own.names


# white balance


def test_balanced_by_gray_a_gray_has_the_same_raw_in_all_channels():
    gray = np.array([123.0, 456.0, 78.9, 1000.0])
    for names in (("R", "G", "B", "W"), ("C", "M", "Y", "W")):
        balanced = gray_gains(gray, names) * gray
        assert balanced == pytest.approx(balanced[0], rel=1e-15)
    assert gray_gains(gray, ("R", "G", "B", "W"))[1] == 1
    assert gray_gains(gray, ("C", "M", "Y", "W"))[3] == 1  # no green: the one with most electrons


def test_correct_gains_do_not_change_the_color_and_others_tint_it():
    balanced = quick().step("linear sRGB")
    analysis = seen()
    gains = gray_gains(analysis.expected_e, analysis.sensor.names)
    given = quick(white_balance=tuple(gains.tolist())).step("linear sRGB")
    assert given.mean == pytest.approx(balanced.mean, rel=1e-12)
    warm = black_body(DEFAULT_GRID, 2856.0)
    tinted = quick(white_balance=warm).step("Lab").mean[18:]
    assert (tinted[:, 2] < quick().step("Lab").mean[18:, 2] - 10).all()  # gains for A: E is blue


def test_a_black_level_error_moves_the_gains_by_gray_but_not_those_of_the_illuminant():
    lifted = seen(pixel=(("black_error_e", 50.0),))
    assert quick(lifted).gains != pytest.approx(quick().gains, rel=1e-3)
    assert quick(lifted, white_balance=LAMP).gains == pytest.approx(quick().gains, rel=1e-12)
    raw = quick(lifted).step("raw").mean - quick().step("raw").mean
    assert raw == pytest.approx(50.0)


@pytest.mark.parametrize("name", ["model-rgb-ircut", *dear("onyx-rgbw")])
def test_gains_from_gray_pixels_scatter_by_the_delta_method(name):
    repeats, pixels = 4000, 256
    analysis = seen(name, level_lux=1.0)
    result = quick(analysis, white_balance_pixels=pixels)
    gray = 0.18 * analysis.expected_e
    noise = noise_sources(analysis.sensor, analysis.exposure)
    means = sample_electrons(
        np.broadcast_to(gray, (repeats, pixels, gray.size)),
        analysis.sensor.pixel,
        stream(7),
        noise=noise,
    ).mean(axis=1)
    green = analysis.sensor.names.index("G")
    gains = means[:, green : green + 1] / means
    away = gains - gains.mean(axis=0)
    products = away[:, :, None] * away[:, None, :]
    covariance = result.white_balance_noise.gains_covariance
    se = products.std(axis=0) / np.sqrt(repeats)
    z = (products.mean(axis=0) - covariance) / np.where(se > 0, se, 1.0)
    assert np.abs(z).max() < 5
    assert (covariance[green] == 0).all()
    # through the picture: every patch with the drawn gains, to Lab
    space = rendered_lab_space(exposure_gain=1.0, saturation=1.0)
    white = analysis.matrix.matrix @ analysis.expected_e
    relative = gains / (analysis.expected_e[green] / analysis.expected_e)
    patches = result.step("raw").mean
    for i in (18, 20, 12):
        xyz = (relative * patches[i]) @ analysis.matrix.matrix.T / white[1]
        lab = space.from_xyz(xyz, white / white[1])
        spread = np.sqrt(np.diagonal(result.white_balance_noise.lab_covariance[i]))
        assert lab.std(axis=0) == pytest.approx(spread, rel=0.07)


def test_more_gray_pixels_give_better_gains_as_one_over_n():
    few, many = (quick(white_balance_pixels=n).white_balance_noise for n in (4, 400))
    assert few.gains_covariance == pytest.approx(100 * many.gains_covariance, rel=1e-12)
    assert few.delta_e == pytest.approx(10 * many.delta_e, rel=1e-12)


def test_noise_common_to_all_channels_does_not_move_the_gains():
    mean = np.array([50.0, 100.0, 25.0])
    common = raw_of(mean, np.outer(mean, mean), ("R", "G", "B"))
    assert np.abs(gains_covariance(common, 1)).max() < 1e-12


# gain


@pytest.mark.parametrize("gain", [1.0, 4.0, 16.0])
def test_s_and_o_are_those_of_the_noise_profile_of_the_converter(gain):
    pixel = (("bits", 12), ("gain_e_per_dn", 2.0), ("black_level_dn", 64), ("read_noise_e", 5.0))
    pixel += (("dark_current_e_per_s", 40.0), ("dsnu_e", 1.5), ("row_noise_e", 1.0), ("prnu", 0.01))
    analysis = seen(pixel=pixel, time_s=0.008)
    result = quick(analysis, iso=(100.0 * gain,)).iso[0]
    adc = Adc(bits=12, gain_e_per_dn=2.0 / gain, black_level_dn=64)
    noise_e = np.sqrt(5.0**2 + 40.0 * 0.008 / gain + 1.5**2 + 1.0**2)
    for profile in result.noise_profile:
        assert profile == pytest.approx(noise_profile(adc, read_noise_e=noise_e), rel=1e-12)
    assert result.gain_dn_per_e == pytest.approx(gain / 2.0)


def test_the_gain_of_digital_binning_is_that_of_one_reading():
    """Codes of the sum over its electrons: both are sums, so their ratio stays."""
    binned = with_binning(with_pixel(seen().sensor, {"gain_e_per_dn": 2.0}), 4, "digital")
    analysis = seen()
    analysis = analyzed(analysis.scene, binned, Exposure(time_s=0.002))
    gains = [one.gain_dn_per_e for one in quick(analysis, iso=(100.0, 800.0)).iso]
    assert gains == pytest.approx([0.5, 4.0])


def test_the_read_noise_of_an_iso_is_that_of_one_of_the_binned_pixels():
    sensor = with_binning(with_pixel(seen().sensor, {"read_noise_e": 5.0}), 4, "digital")
    analysis = analyzed(seen().scene, sensor, Exposure(time_s=0.002))
    same = quick(analysis, iso=(100.0, 400.0))
    given = quick(analysis, iso=(100.0, 400.0), iso_read_noise_e=(5.0, 5.0))
    assert [one.read_noise_e for one in given.iso] == [one.read_noise_e for one in same.iso]
    assert given.iso[0].steps is given.steps


def test_a_black_level_error_changes_no_noise_profile():
    iso = (100.0, 800.0)
    plain = quick(iso=iso, white_balance=LAMP)
    shifted = quick(seen(pixel=(("black_error_e", 400.0),)), iso=iso, white_balance=LAMP)
    for one, other in zip(plain.iso, shifted.iso, strict=True):
        assert other.noise_profile == pytest.approx(one.noise_profile, rel=1e-12)


def test_the_profile_predicts_the_variance_of_a_patch():
    result = quick(seen(pixel=(("bits", 12),)), iso=(800.0,)).iso[0]
    raw = result.steps[0].measurement
    x = raw.mean / result.white_level_e
    shot, dark = result.noise_profile.T
    assert (shot * x + dark) * result.white_level_e**2 == pytest.approx(raw.variance, rel=1e-12)


@pytest.mark.parametrize("gain", [1.0, 2.0, 32.0])
def test_dynamic_range_is_that_of_emva_1288(gain):
    # Release 4.0: mu_e.sat over sigma_d of the dark frame; the threshold adds 1/2 e-
    sensor = with_pixel(
        sensor_named("model-mono", DEFAULT_GRID),
        {"full_well_e": 9000.0, "read_noise_e": 3.0, "bits": 10},
    )
    analysis = analyzed(flat_field(LAMP, level_lux=1.0), sensor, Exposure(time_s=0.005))
    result = quick(analysis, iso=(100.0 * gain,)).iso[0]
    step = 9000.0 / 1023.0 / gain
    dark = (3.0**2 + step**2 / 12) ** 0.5
    assert result.dynamic_range_db[0] == pytest.approx(20 * np.log10(9000.0 / gain / dark))
    assert result.emva_dynamic_range_db[0] == pytest.approx(
        20 * np.log10(9000.0 / gain / (dark + 0.5))
    )
    assert 2 ** result.dynamic_range_stops[0] == pytest.approx(9000.0 / gain / dark)


def test_a_known_converter_limits_the_signal_until_the_well_does():
    sensor = with_pixel(
        sensor_named("model-rgb", DEFAULT_GRID),
        {"bits": 12, "gain_e_per_dn": 4.0, "full_well_e": 8000.0},
    )
    limits = [white_level_e(with_analog_gain(sensor, gain)) for gain in (1.0, 2.0, 4.0)]
    assert limits == pytest.approx([8000.0, 8000.0, 4095.0])  # codes reach 16380, 8190, 4095 e-


def test_at_the_base_iso_the_steps_are_those_of_the_operating_point():
    result = quick(iso=(100.0, 400.0), iso_read_noise_e=(10.0, 10.0))
    assert result.iso[0].steps is result.steps
    assert [step.name for step in result.iso[1].steps] == NAMES


def test_a_quarter_of_the_light_is_iso_400():
    """Another road to a gain: the analysis of a quarter of the light, with the same matrix."""
    bright, dim = seen(), seen(level_lux=2.5)
    result = found(bright, iso=(400.0,), iso_read_noise_e=(2.0,)).iso[0]
    other = analyzed(
        dim.scene, with_pixel(dim.sensor, {"read_noise_e": 2.0}), dim.exposure, matrix=bright.matrix
    )
    for own, step in zip(result.steps, found(other).steps, strict=True):
        assert own.measurement.mean == pytest.approx(step.measurement.mean, rel=1e-9, abs=1e-9)
        expected = step.measurement.covariance
        assert own.measurement.covariance == pytest.approx(expected, rel=1e-6, abs=1e-12)


def test_crosstalk_after_counting_reaches_the_steps_and_the_noise_in_the_dark():
    sensor = sensor_named("model-rgb-ircut", DEFAULT_GRID)
    mixing = np.array([[0.9, 0.05, 0.0], [0.1, 0.9, 0.1], [0.0, 0.05, 0.9]])
    coupled = with_crosstalk(
        with_pixel(sensor, {"dsnu_e": 6.0, "dark_current_e_per_s": 3000.0}),
        Crosstalk(matrix=mixing, pixels=(1, 1, 1), stage="charge"),
    )
    analysis = analyzed(flat_field(LAMP, level_lux=10.0), coupled, Exposure(time_s=0.009))
    result = quick(analysis)
    raw = result.step("raw").covariance
    assert (raw[:, 0, 1] > 0).all()
    dark_e = 3000.0 * 0.009
    spread = 100.0 + dark_e * (mixing**2).sum(axis=1)
    white = coupled.pixel.full_well_e - dark_e
    expected = 10 * np.log10(white**2 / spread)
    assert result.iso[0].dynamic_range_db == pytest.approx(expected, rel=1e-12)
    for method in (exact, partial(exact, points=256)):
        with refused_input(subject="crosstalk_stage", value="charge"):
            pipeline_noise(analysis, method=method)


# results and refusals


def test_the_result_names_its_steps_and_is_plain_data():
    result = quick(white_balance_pixels=10)
    assert [step.name for step in result.steps] == NAMES
    data = plain(result)
    assert data["white_balance"] == "gray"
    assert data["gains"]["G"] == 1
    assert [step["name"] for step in data["steps"]] == NAMES
    assert {len(step["patches"]) for step in data["steps"]} == {24}
    assert data["steps"][0]["unit"] == "e-"
    assert data["steps"][0]["coordinates"] == ["R", "G", "B"]
    white = data["steps"][0]["patches"][18]
    assert white["patch"] == "white"
    assert white["covariance"][0][0] == pytest.approx(white["mean"][0] + 100.0)
    (iso,) = data["iso"]
    assert set(iso["noise_profile"]) == {"S", "O"}


def test_a_saturated_sensor_has_no_pipeline():
    assert pipeline_noise(seen(level_lux=1e4)) is None


def test_readings_above_1_are_noted_with_their_share():
    analysis = seen(level_lux=40.0)
    assert not any("exceed" in note for note in quick(analysis).notes)
    result = quick(analysis, exposure_gain=1.12)
    (note,) = [one for one in result.notes if "exceed" in one]
    assert "white (" in note
    own = result.step("saturation")
    z = (1 - own.mean[18, 0]) / np.sqrt(own.variance[18, 0])
    share = np.mean(stream(3).standard_normal(200_000) > z)
    assert float(note.split(" %")[0].split("(")[-1]) == pytest.approx(100 * share, abs=0.4)


def test_what_cannot_be_balanced_or_clips_is_refused():
    with refused_input(subject="white_balance", value=0.0):
        gray_gains(np.array([1.0, 0.0]), ("G", "R"))
    with refused_input(subject="white_balance", value=(2.0, 1.0)):
        quick(white_balance=(2.0, 1.0))
    with refused_input(subject="white_balance", value=0.0):
        checked_gains((0.0, 1.0), ("R", "G"))
    with refused_input(subject="exposure_gain", value=2.0):
        quick(exposure_gain=2.0)
    with refused_input(subject="white_balance", value=(4.0, 2.0, 3.0)):
        quick(white_balance=(4.0, 2.0, 3.0))
    with refused_input(subject="iso", where="full_well_e"):
        quick(seen("model-mono", level_lux=0.001, pixel=(("full_well_e", 5.0),)), iso=(1e7,))
    with refused_input(subject="white_balance"):
        quick(seen(pixel=(("black_error_e", -5000.0),)))


@pytest.mark.parametrize(
    ("settings", "subject"),
    [
        ({"saturation": -0.1}, "saturation"),
        ({"tone": "rec2020"}, "tone"),
        ({"tone": 50.0}, "tone"),
        ({"iso": (50.0,)}, "iso"),
        ({"iso": (float("nan"),)}, "iso"),
        ({"base_iso": 0.0}, "base_iso"),
        ({"exposure_gain": 0.0}, "exposure_gain"),
        ({"white_balance": "grey"}, "white_balance"),
        ({"white_balance": (1.0, 1.0, 1.0), "white_balance_pixels": 3}, "white_balance_pixels"),
        ({"iso": (100.0,), "iso_read_noise_e": (1.0, 2.0)}, "iso_read_noise_e"),
        ({"iso_read_noise_e": (1e13,)}, "iso_read_noise_e"),
        ({"iso": (1e9,)}, "iso"),
    ],
)
def test_settings_out_of_range_are_refused(settings, subject):
    with refused_input(subject=subject):
        PipelineSettings(**settings)


def test_a_step_that_does_not_exist_is_refused():
    with refused_input(subject="step", value="jpeg"):
        quick().step("jpeg")


def test_an_analysis_in_other_coordinates_is_refused():
    analysis = seen()
    other = replace(analysis.matrix, coordinates=("R", "G", "B"))
    with refused_input(subject="matrix"):
        pipeline_noise(replace(analysis, matrix=other))
