"""The noise model of a camera: ISO, laws of the read noise, sensors, and ELD's calibrations."""

import copy
from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate, stats

import chromanoise as cn
from chromanoise.apps.training import sampler
from chromanoise.sensor import (
    CameraNoise,
    LogLinearNoise,
    Mosaic,
    ReadNoiseSum,
    ReadNoiseTable,
    bayer,
    read_noise_sum,
    tukey_lambda_variance,
    with_pixel,
)
from chromanoise.spectra import DEFAULT_GRID
from outcomes import refused_input

ELD = {
    "Kmin": 0.5,
    "Kmax": 12.0,
    "G_shape": np.array([0.12, -0.05, -0.2]),
    "color_bias": np.array([[0.4, -0.3, 0.2, 0.1], [-0.6, 0.5, 0.3, -0.2]]),
    "Profile-1": {
        "g_scale": {"slope": 0.85, "bias": 0.6, "sigma": 0.03},
        "G_scale": {"slope": 0.9, "bias": 0.2, "sigma": 0.04},
        "R_scale": {"slope": 0.8, "bias": -1.0, "sigma": 0.1},
    },
}


def eld(**changes):
    params = copy.deepcopy(ELD) | changes
    return CameraNoise.from_eld(params, black_level_dn=512, top_code_dn=16383)


def camera(**others):
    given = {
        "names": ("R", "G", "B"),
        "mosaic": bayer(),
        "gain_dn_per_e": np.array([0.5, 0.6, 0.7]),
        "read_noise_e": np.array([3.0, 2.0, 1.0]),
        "black_level_dn": np.full(3, 64.0),
        "top_code_dn": 1023.0,
    }
    return CameraNoise(**(given | others))


# ---- laws over the gain ----


@pytest.mark.parametrize("shape", [-0.3, -0.1, -1e-7, 0.0, 1e-4, 0.14, 0.7])
def test_the_variance_of_tukey_lambda_is_the_integral_of_the_squared_quantiles(shape):
    def squared(u):
        return float(stats.tukeylambda.ppf(u, shape)) ** 2

    edges = [2.0**-33, 1e-8, 1e-6, 1e-4, 1e-2, 0.5]
    parts = [integrate.quad(squared, *ends)[0] for ends in pairwise(edges)]
    assert tukey_lambda_variance(shape) == pytest.approx(2 * sum(parts), rel=1e-5)


def test_a_fitted_sum_returns_the_noise_before_and_after_the_gain():
    gain = np.array([0.3, 1.0, 5.0, 20.0])
    fit = read_noise_sum(gain, np.sqrt(2.5**2 + (1.7 * gain) ** 2))
    assert fit.after_gain_dn == pytest.approx(2.5)
    assert fit.before_gain_e == pytest.approx(1.7)


@pytest.mark.parametrize(
    ("noise", "law"),
    [([2.0, 2.0, 1.9], "before_gain_e"), ([1.0, 2.1, 4.3], "after_gain_dn")],
)
def test_a_fitted_sum_has_no_negative_part(noise, law):
    assert getattr(read_noise_sum(np.array([1.0, 2.0, 4.0]), np.array(noise)), law) == 0


def test_a_table_is_interpolated_and_not_extrapolated():
    table = ReadNoiseTable(gain_dn_per_e=np.array([1.0, 4.0]), read_noise_dn=np.array([2.0, 4.0]))
    own = camera(iso=100, gain_dn_per_e=np.ones(3), read_noise_law=table)
    np.testing.assert_allclose(own.at_iso(200).read_noise_e, 2 * 2**0.5 / 2)
    with refused_input(subject="gain_dn_per_e", value=8.0):
        own.at_iso(800)


def test_the_gain_of_each_channel_is_proportional_to_the_iso():
    own = camera(iso=200, read_noise_law=ReadNoiseSum(after_gain_dn=1.0, before_gain_e=2.0))
    high = own.at_iso(1000)
    np.testing.assert_allclose(high.gain_dn_per_e, 5 * own.gain_dn_per_e)
    np.testing.assert_allclose(high.read_noise_e, np.hypot(1 / high.gain_dn_per_e, 2.0))
    assert high.iso == 1000
    assert own.at_gain(3 * own.gain_dn_per_e).iso == pytest.approx(600)
    np.testing.assert_array_equal(own.at_iso(200).read_noise_e, own.read_noise_e)


# ---- from a sensor ----


def test_the_camera_of_a_sensor_has_the_values_of_pixel_and_converter():
    sensor = with_pixel(
        cn.sensor_named("model-rgb", DEFAULT_GRID),
        {
            "full_well_e": 9000.0,
            "read_noise_e": 2.5,
            "bits": 12,
            "gain_e_per_dn": 2.0,
            "black_level_dn": 64,
            "dark_current_e_per_s": 8.0,
            "temperature_c": 32.0,
            "dsnu_e": 1.5,
            "prnu": 0.01,
            "row_noise_e": 0.7,
            "black_error_e": 4.0,
        },
    )
    own = CameraNoise.from_sensor(sensor)
    assert set(own.names) == set(sensor.names)
    assert (own.gain_dn_per_e == 0.5).all()
    assert (own.read_noise_e == 2.5).all()
    assert (own.black_level_dn == 64).all()
    assert own.top_code_dn == 4095
    assert own.full_well_e == 9000
    assert own.dark_current_e_per_s == pytest.approx(16.0)
    assert (own.dsnu_e, own.prnu, own.row_noise_e) == (1.5, 0.01, 0.7)
    np.testing.assert_allclose(own.black_offsets_dn, 2.0)
    frame = sampler(own)(np.zeros((300, 400, 3)), unit="electron", time_s=0.1)
    assert frame.noisy.mean() == pytest.approx(4.0, abs=0.1)


# ---- ELD ----


def eld_draws(count, seed):
    """Dark read noise and row noise in DN, by the equations of the paper, in plain numpy.

    Wei et al. (2020): ln K uniform; ln sigma = a ln K + b + N(0, s); Tukey lambda noise of scale
    sigma_TL; one normal offset for each row.
    """
    rng = np.random.default_rng(seed)
    own = ELD["Profile-1"]
    noise, gains = [], []
    for _ in range(count):
        log_k = rng.uniform(np.log(ELD["Kmin"]), np.log(ELD["Kmax"]))
        scale = {
            name: np.exp(law["slope"] * log_k + law["bias"] + law["sigma"] * rng.normal())
            for name, law in own.items()
        }
        shape = rng.choice(ELD["G_shape"])
        light = rng.poisson(20.0, (24, 24)) - 20.0
        bias = ELD["color_bias"][rng.integers(2)][[[0, 1], [3, 2]]]
        frame = (
            np.exp(log_k) * light
            + stats.tukeylambda.rvs(shape, scale=scale["G_scale"], size=(24, 24), random_state=rng)
            + scale["R_scale"] * rng.normal(size=(24, 1))
            + np.tile(bias, (12, 12))
        )
        noise.append(frame)
        gains.append(np.exp(log_k))
    return np.array(noise), np.array(gains)


def test_elds_parameters_reproduce_its_model():
    count = 300
    add_noise = sampler(eld(), seed=7, quantize=False, clamp=False, threads=1)
    clean = np.full((24, 24), 20.0)
    samples = [add_noise(clean, unit="electron", item=i) for i in range(count)]
    gains = np.array([one.camera.gain_dn_per_e[0] for one in samples])
    ours = np.array([one.noisy - 20.0 for one in samples]) * gains[:, None, None]
    theirs, their_gains = eld_draws(count, seed=3)
    assert stats.ks_2samp(gains, their_gains).pvalue > 1e-3
    picks = (slice(None), slice(None, None, 5), slice(None, None, 5))
    within = (ours - ours.mean(axis=2, keepdims=True))[picks].ravel()
    assert stats.ks_2samp(within[::3], theirs_within(theirs)[picks].ravel()[::3]).pvalue > 1e-3
    rows, their_rows = ours.mean(axis=2)[:, ::2], theirs.mean(axis=2)[:, ::2]
    assert stats.ks_2samp(rows[:, 0], their_rows[:, 0]).pvalue > 1e-3
    for own, other in ((ours[:, 0, 0], theirs[:, 0, 0]), (ours[:, 1, 0], theirs[:, 1, 0])):
        assert stats.ks_2samp(own, other).pvalue > 1e-3


def theirs_within(frames):
    return frames - frames.mean(axis=2, keepdims=True)


def test_elds_read_noise_at_a_gain_is_its_log_linear_law():
    own = eld().at_gain(np.full(4, 3.0), tail_lambda=-0.05)
    scale = 3.0**0.9 * np.exp(0.2)
    sd = scale * np.sqrt(stats.tukeylambda.var(-0.05))
    np.testing.assert_allclose(own.read_noise_e, sd / 3.0, rtol=1e-6)
    assert own.row_noise_e == pytest.approx(3.0**0.8 * np.exp(-1.0) / 3.0)


def test_rounding_adds_the_variance_of_elds_uniform_noise():
    rounded, plain = (sampler(eld(), seed=7, quantize=on) for on in (True, False))
    clean = np.full((600, 600), 30.0)
    one, other = (f(clean, unit="electron", item=4) for f in (rounded, plain))
    gain = one.camera.gain_dn_per_e[0]
    added = (one.noisy - other.noisy).var() * gain**2
    assert added == pytest.approx(1 / 12, rel=0.02)
    assert (one.variance - other.variance)[0, 0] * gain**2 == pytest.approx(1 / 12, rel=1e-3)


def test_the_color_bias_of_eld_is_in_the_order_red_green_blue_green():
    own = eld(color_bias=np.array([[1.0, 2.0, 3.0, 4.0]]))
    off = dict.fromkeys(("shot", "read", "row", "quantize", "clamp"), False)
    frame = sampler(own, **off)(np.full((2, 2), 512.0), unit="dn").noisy
    np.testing.assert_allclose(frame, 512 + np.array([[1.0, 2.0], [4.0, 3.0]]))


def test_elds_parameters_without_tails_have_normal_noise():
    own = CameraNoise.from_eld(
        {key: ELD[key] for key in ("Kmin", "Kmax")}
        | {"Profile-1": {"g_scale": ELD["Profile-1"]["g_scale"]}},
        black_level_dn=512,
        top_code_dn=16383,
        read="gaussian",
    )
    assert own.tail_lambda == ()
    at = own.at_gain(np.full(4, 2.0))
    np.testing.assert_allclose(at.read_noise_e, 2**0.85 * np.exp(0.6) / 2)
    assert at.row_noise_e == 0


# ---- refusals ----


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"Kmin": -1.7}, "Kmin <= Kmax"),
        ({"Kmax": "high"}, "finite number"),
        ({"Kmax": 0.1}, "Kmin <= Kmax"),
        ({"G_shape": []}, "one or more"),
        ({"Profile-1": None}, "Profile-1"),
        ({"Profile-1": {"G_scale": {"slope": 1.0, "bias": 0.0}}}, "sigma"),
        ({"Profile-1": {"g_scale": {}}}, "G_scale"),
    ],
)
def test_damaged_eld_parameters_are_refused_in_a_sentence(changes, words):
    with refused_input(subject="ELD parameters") as caught:
        eld(**changes)
    assert words in str(caught.value)


def test_eld_parameters_of_another_shape_are_refused():
    with refused_input(subject="ELD parameters"):
        CameraNoise.from_eld({}, black_level_dn=0, top_code_dn=1023)
    with refused_input(subject="color_bias"):
        eld(color_bias=np.zeros((2, 3)))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("gain_dn_per_e", np.array([0.5, 0.0, 1.0])),
        ("read_noise_e", np.array([1.0, -1.0, 1.0])),
        ("read_noise_e", np.array([1.0, np.nan, 1.0])),
        ("black_level_dn", np.full(3, 1023.0)),
        ("top_code_dn", 1023.5),
        ("iso", 0.0),
        ("full_well_e", -1.0),
        ("prnu", 2.0),
        ("dsnu_e", -1.0),
        ("row_noise_e", float("inf")),
        ("rtn_share", 1.5),
        ("rtn_amplitude_e", -1.0),
        ("tail_lambda", (-0.5,)),
        ("mosaic", Mosaic((("R", "G"),))),
        ("black_offsets_dn", np.full((2, 3), np.nan)),
    ],
)
def test_a_bad_value_of_a_camera_is_refused_by_name(name, value):
    with refused_input(subject=name):
        camera(**{name: value})


def test_a_range_of_gains_needs_a_law_of_the_read_noise():
    with refused_input(subject="read_noise_law", setting="read_noise_law"):
        camera(gain_range_dn_per_e=(1.0, 2.0))
    with refused_input(subject="tail_lambda"):
        camera(read_noise_law=LogLinearNoise(slope=1.0, bias=0.0, tukey_scale=True))
    with refused_input(subject="gain_dn_per_e"):
        read_noise_sum(np.array([1.0, 1.0]), np.array([1.0, 2.0]))
