"""The numbers of docs/findings.md on the sources of a pixel, computed anew from the formulas."""

import re
from pathlib import Path

import numpy as np
import pytest

from chromanoise.color import kernel_matrix
from chromanoise.geometry import dual_frame
from chromanoise.noise import Exposure, expected_electrons
from chromanoise.sensor import behind_filter, ir_cut
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import sensor_named

TEXT = (Path(__file__).parents[2] / "docs" / "findings.md").read_text(encoding="utf-8")
SENSORS = ("onyx-rgbw", "onyx-rgb-ircut", "mt9v024-rgb")
SOURCES = ("PRNU 1 %", "crosstalk 10 %", "dark current 5,000 e⁻/s", "quantization, 8 bits")
EXPOSURE = Exposure(time_s=0.01194)
READ_E, FULL_WELL_E = 10.0, 10_000.0


def sensor_of(name):
    sensor = sensor_named(name, DEFAULT_GRID)
    if name != "mt9v024-rgb":
        return sensor
    return behind_filter(sensor, ir_cut(DEFAULT_GRID, edge_nm=650.0, width_nm=8.0), name=name)


def mixing_of(sensor, share):
    """Each pixel keeps 1 - c and gets c/4 of each of its four neighbors; means of the channels."""
    whose, shares = places_of(sensor, share)
    return np.array([shares[whose == i].mean(axis=0) for i in range(len(sensor.names))])


def places_of(sensor, share):
    tile = np.array(sensor.mosaic.pattern)
    height, width = tile.shape
    whose, shares = [], []
    for (y, x), own in np.ndenumerate(tile):
        around = [tile[(y + dy) % height, (x + dx) % width] for dy, dx in
                  ((0, 1), (0, -1), (1, 0), (-1, 0))]  # fmt: skip
        whose.append(sensor.names.index(own))
        shares.append(np.zeros(len(sensor.names)))
        shares[-1][whose[-1]] += 1 - share
        for other in around:
            shares[-1][sensor.names.index(other)] += share / 4
    return np.array(whose), np.array(shares)


def electrons(sensor, lux):
    return expected_electrons(
        flat_field(equal_energy(DEFAULT_GRID), level_lux=lux), sensor, EXPOSURE
    )


def added_e2(mean, source):
    return {
        "PRNU 1 %": (0.01 * mean) ** 2,
        "dark current 5,000 e⁻/s": 5000 * 0.01194 + 0 * mean,
        "quantization, 8 bits": (FULL_WELL_E / 255) ** 2 / 12 + 0 * mean,
    }[source]


def losses(name, lux, source):
    sensor = sensor_of(name)
    mean, rows = electrons(sensor, lux), kernel_matrix(sensor, EXPOSURE).matrix
    variance = mean + READ_E**2
    mixed, noisy_rows, noisy = mean, rows, variance
    if source == "crosstalk 10 %":
        mixing = mixing_of(sensor, 0.1)
        mixed, noisy_rows = mixing @ mean, rows @ np.linalg.inv(mixing)
        whose, shares = places_of(sensor, 0.1)
        pattern = [(shares[whose == i] @ mean).var() for i in range(len(mean))]
        noisy = mixed + READ_E**2 + pattern
    else:
        noisy = variance + added_e2(mean, source)
    raw = 20 * np.log10(mean / mixed) + 10 * np.log10(noisy / variance)
    color = 10 * np.log10((noisy_rows**2 @ noisy) / (rows**2 @ variance))
    return raw, color


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("name", SENSORS)
def test_the_table_has_the_losses_of_the_formulas(name, source):
    (line,) = [row for row in TEXT.splitlines() if row.startswith(f"| {name} | {source} |")]
    printed = np.array([float(n) for n in re.findall(r"-?\d+\.\d\d", line)])
    expected = []
    for lux in (10.0, 1.0):
        raw, color = losses(name, lux, source)
        expected += [raw.mean(), raw.min(), raw.max(), *color]
    assert printed == pytest.approx(np.array(expected), abs=0.0051)


@pytest.mark.parametrize("name", SENSORS)
def test_independent_noise_costs_color_no_more_than_the_most_affected_channel(name):
    for lux in (0.01, 1.0, 100.0):
        for source in SOURCES:
            if source != "crosstalk 10 %":
                raw, color = losses(name, lux, source)
                assert (color <= raw.max() + 1e-12).all()
                assert (color >= raw.min() - 1e-12).all()


def test_the_limits_of_prnu_are_those_of_the_matrix():
    limits = [
        float(n) for n in re.findall(r"to (\d\d\.\d) dB", TEXT[TEXT.index("PRNU limits the SNR") :])
    ]
    for name, printed in zip(SENSORS, limits[1:4], strict=True):
        sensor = sensor_of(name)
        mean, row = electrons(sensor, 10.0), kernel_matrix(sensor, EXPOSURE).matrix[1]
        assert printed == pytest.approx(
            20 * np.log10(row @ mean / np.sqrt((0.01 * row) ** 2 @ mean**2)), abs=0.051
        )
    assert limits[0] == 40.0


@pytest.mark.parametrize(
    ("name", "before", "after"), [("onyx-rgbw", 6.1, 7.5), ("onyx-rgb-ircut", 2.0, 2.5)]
)
def test_the_condition_numbers_are_those_of_the_mixed_curves(name, before, after):
    sensor = sensor_of(name)
    assert f"from {before} to {after}" in TEXT
    for curves, printed in (
        (sensor.qe, before),
        (sensor.qe @ mixing_of(sensor, 0.1).T, after),
    ):
        frame = dual_frame(curves, names=sensor.names, metric="quanta")
        assert frame.condition == pytest.approx(printed, abs=0.05)
