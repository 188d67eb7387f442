"""All roads round a reading to the same values: those of the raw codes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import stats

from chromanoise.base.rng import stream
from chromanoise.imaging import Work, acquired
from chromanoise.noise import (
    Exposure,
    Readout,
    clipped_measurement,
    clipping_readout,
    noise_sources,
    poisson_gaussian_ppf,
    read_values,
    reading_distribution,
    sample_electrons,
    sensor_moments,
)
from chromanoise.noise.distribution import counted_readout
from chromanoise.sensor import Adc, Converter, Mosaic
from chromanoise.spectra import Grid
from goodness import moments_z
from noise_samples import noise_of
from strategies import flat_cube, pixel_with, point_of, white_channel

STEP, TIME_S, SIDE = 4.0, 0.02, 400
GRID = Grid.uniform(500, 600, 10)
STEPS = st.floats(0.5, 20.0)


def camera(dark_e, *, black_level_dn, black_error_e=0.0, full_well_e=4000.0, read_noise_e=0.9):
    pixel = replace(
        pixel_with(read_noise_e, full_well_e=full_well_e),
        dark_current_e_per_s=dark_e / TIME_S,
        black_error_e=black_error_e,
    )
    converter = Converter(bits=12, gain_e_per_dn=STEP, black_level_dn=black_level_dn)
    return replace(white_channel(pixel=pixel, grid=GRID), converter=converter)


def raw_values_e(sensor, rho, black_level_dn, level_lux=1.0):
    """Values of the library's own raw codes, and the expected electrons."""
    point = point_of(sensor, level_lux, exposure=Exposure(time_s=TIME_S, f_number=8.0))
    picture = acquired(
        flat_cube(GRID.wavelength_nm, rho, height=SIDE, width=SIDE),
        point,
        mosaic=Mosaic(((sensor.names[0],),)),
        adc=Adc(bits=12, gain_e_per_dn=STEP, black_level_dn=black_level_dn),
        seed=4,
        work=Work(threads=1),
    )
    return STEP * (picture.codes.astype(float) - black_level_dn).ravel(), picture.mean_e[0]


def numpy_values_e(mean, noise, rng, count):
    read = rng.poisson(mean + noise.dark_e, count) + noise.pixel.read_noise_e * rng.normal(
        size=count
    )
    return STEP * np.floor((read - noise.dark_e + noise.black_error_e) / STEP + 0.5)


def summed(mean, noise, step, low=-np.inf, high=np.inf):
    """Mean and variance by a plain sum over counts and codes."""
    counted = mean + noise.dark_e
    n = np.arange(int(counted + 12 * np.sqrt(counted) + 40))
    k = np.arange(-int(40 / step) - 40, int((n[-1] + 40) / step) + 40)
    value = np.clip(k * step, low, high)
    at = n[:, None] - noise.dark_e + noise.black_error_e
    sd = noise.pixel.read_noise_e
    share = stats.norm.cdf(((k + 0.5) * step - at) / sd) - stats.norm.cdf(
        ((k - 0.5) * step - at) / sd
    )
    share = stats.poisson.pmf(n, counted) @ share
    center = share @ value
    return center, share @ (value - center) ** 2


@pytest.mark.parametrize("black_error_e", [0.0, 1.3])
@pytest.mark.parametrize("dark_e", [0.0, 0.7, 2.0, 3.1])
def test_raw_codes_scatter_as_the_closed_form_and_as_plain_draws(dark_e, black_error_e):
    sensor = camera(dark_e, black_level_dn=64, black_error_e=black_error_e)
    noise = noise_sources(sensor, Exposure(time_s=TIME_S))
    codes, mean = raw_values_e(sensor, 0.1, 64)
    assert 1 < mean < 2
    found = sensor_moments(np.array([mean]), noise, Readout())
    drawn = numpy_values_e(mean, noise, np.random.default_rng(3), codes.size)
    for values in (codes, drawn):
        assert moments_z(values, found.mean[0], found.variance[0]) < 5


@pytest.mark.parametrize("dark_e", [0.0, 3.1])
@pytest.mark.parametrize("rho", [0.01, 1.0])
def test_clipped_values_are_those_of_clipped_codes_at_black_and_at_full_well(dark_e, rho):
    # 201.5 e- is no multiple of the step of 4 e-
    full_well_e = 4000.0 if rho < 1 else 201.5
    sensor = camera(
        dark_e, black_level_dn=0, black_error_e=1.3, full_well_e=full_well_e, read_noise_e=3.0
    )
    codes, mean = raw_values_e(sensor, rho, 0, level_lux=12.0)
    exposure = Exposure(time_s=TIME_S)
    found = clipped_measurement(
        np.array([mean]), sensor, clipping_readout(sensor, exposure), exposure
    )
    assert moments_z(codes, found.mean[0], found.variance[0]) < 5


@given(
    step=STEPS,
    fraction=st.floats(0.0, 3.0),
    error=st.floats(-1.0, 1.0),
    mean=st.floats(0.0, 60.0),
    sd=st.floats(0.1, 5.0),
    clip=st.booleans(),
)
def test_all_closed_forms_have_one_lattice_whatever_share_of_a_step_is_dark(
    step, fraction, error, mean, sd, clip
):
    noise = noise_of(
        read_noise_e=sd, dark_e=fraction * step, step_e=step, black_error_e=error * step
    )
    most = 8 * step if clip else np.inf  # of the values
    offset = noise.black_error_e - noise.dark_e
    readout = Readout(black_e=0.0, full_well_e=most - offset) if clip else Readout()
    means = np.array([mean])
    moments = sensor_moments(means, noise, readout)
    readings = reading_distribution(means, noise, readout)
    center = float(readings.probability[0] @ readings.values_e)
    variance = float(readings.probability[0] @ (readings.values_e - center) ** 2)
    low, high = (0.0, most) if clip else (-np.inf, np.inf)
    known = summed(mean, noise, step, low, high)
    for found in ((moments.mean[0], moments.variance[0]), (center, variance)):
        assert found[0] == pytest.approx(known[0], rel=1e-12, abs=1e-11)
        assert found[1] == pytest.approx(known[1], rel=1e-11, abs=1e-11)


@given(step=STEPS, dark=st.floats(0.0, 30.0), error=st.floats(-9.0, 9.0), seed=st.integers(0, 99))
def test_draws_and_quantiles_are_whole_steps_of_the_signal(step, dark, error, seed):
    noise = noise_of(read_noise_e=2.0, dark_e=dark, step_e=step, black_error_e=error)
    drawn = sample_electrons(np.full(50, 20.0), pixel_with(2.0), stream(seed), noise=noise)
    counted, bounds = counted_readout(np.array([20.0]), noise, Readout())
    z = np.linspace(-3, 3, 50)
    quantiles = read_values(poisson_gaussian_ppf(z, counted[0], read_noise_e=2.0), bounds)
    for values in (drawn, quantiles):
        assert values / step == pytest.approx(np.round(values / step), abs=1e-9)
