"""Sensors, lights and mixes for hypothesis, and the few nouns that many tests build."""

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from chromanoise.noise import Exposure, Measurement, OperatingPoint
from chromanoise.sensor import Pixel, Sensor, with_pixel
from chromanoise.spectra import Cube, Grid, equal_energy

GRID = Grid.uniform(400, 700, 10)
PIXEL = Pixel(pitch_um=10.0, full_well_e=10_000.0, read_noise_e=10.0)
EXPOSURE = Exposure(time_s=0.01, f_number=1.8)
CHANNELS = ("a", "b", "c", "d")


def bell_qe(centers_nm, widths_nm, peaks):
    """One bell-shaped column per center, on GRID."""
    at = GRID.wavelength_nm[:, None]
    return np.array(peaks) * np.exp(-0.5 * ((at - np.array(centers_nm)) / np.array(widths_nm)) ** 2)


def sensor_of(qe, *, grid=GRID, pixel=PIXEL, name="toy", names=None, **more):
    return Sensor(
        name=name, grid=grid, qe=qe, names=names or CHANNELS[: qe.shape[1]], pixel=pixel, **more
    )


RGB = bell_qe([600.0, 540.0, 460.0], [40.0, 40.0, 30.0], [0.5, 0.6, 0.5])


def rgb_sensor(read_noise_e=10.0, full_well_e=10_000.0, **more):
    """Red, green and blue bells."""
    return sensor_of(RGB, pixel=pixel_with(read_noise_e, full_well_e), **more)


def white_channel(qe=0.5, *, grid=GRID, names=("W",), **more):
    """One channel that answers alike everywhere."""
    return sensor_of(np.full((grid.n, 1), qe), grid=grid, names=names, **more)


def flat_cube(wavelength_nm, reflectance, *, height, width):
    """A cube of equal pixels with numbers of 32 bits, as those of all scenes that are built in.

    Kernels are compiled for each type of numbers; of 64 bits they would take 15 s more.
    """
    stored = np.broadcast_to(np.float32(reflectance), (height, width, len(wavelength_nm)))
    return Cube(wavelength_nm=wavelength_nm, stored=stored, source="a flat cube")


def raw_of(mean, covariance, names=None):
    mean = np.asarray(mean, dtype=float)
    names = names or tuple(f"c{i}" for i in range(mean.shape[-1]))
    noise = np.asarray(covariance, dtype=float)
    return Measurement(mean=mean, covariance=noise, names=names, kind="raw", unit="e-")


def xyz_of(mean, covariance, unit="1"):
    return Measurement(
        mean=mean, covariance=covariance, names=("X", "Y", "Z"), kind="XYZ", unit=unit
    )


def pixel_with(read_noise_e=10.0, full_well_e=10_000.0):
    return Pixel(pitch_um=10.0, full_well_e=full_well_e, read_noise_e=read_noise_e)


def point_of(sensor, level_lux=10.0, *, exposure=EXPOSURE, illuminant=None, **more):
    """A sensor in use, by default in light of equal energy."""
    lamp = equal_energy(sensor.grid) if illuminant is None else illuminant
    return OperatingPoint(
        sensor=sensor, exposure=exposure, illuminant=lamp, level_lux=level_lux, **more
    )


@st.composite
def sensors(draw, min_channels=1, max_channels=4):
    """Bells at least 40 nm apart: overlapping, never a mix of each other."""
    p = draw(st.integers(min_channels, max_channels))
    gaps = [draw(st.floats(40.0, 75.0)) for _ in range(p)]
    widths = [draw(st.floats(15.0, 45.0)) for _ in range(p)]
    peaks = [draw(st.floats(0.1, 0.95)) for _ in range(p)]
    read_noise = draw(st.floats(0.0, 50.0))
    return sensor_of(bell_qe(380.0 + np.cumsum(gaps), widths, peaks), pixel=pixel_with(read_noise))


def reflectances(n=GRID.n):
    """Any matte thing, black included."""
    return st.lists(st.floats(0.0, 1.0), min_size=n, max_size=n).map(np.array)


@st.composite
def mixes(draw, p):
    """An invertible p x p matrix, negative entries and exchanged rows included."""
    entries = st.floats(-1.0, 1.0)
    strong = np.array([[draw(entries) for _ in range(p)] for _ in range(p)]) / p
    order = draw(st.permutations(range(p)))
    scales = np.array([draw(st.floats(0.2, 5.0)) for _ in range(p)])
    return scales[:, None] * (strong + 2.0 * np.eye(p))[list(order)]


def with_pixel_of(operating_point, **values):
    """The operating point with other values of its pixel."""
    return replace(operating_point, sensor=with_pixel(operating_point.sensor, values))
