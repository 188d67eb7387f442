"""The numbers of docs/reader_findings.md and docs/readers.md on machine readers, from plain numpy.

Electrons are those of the library; distances, medians and shares are computed here.
"""

import re
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

import chromanoise as cn
from chromanoise.spectra import colorchecker
from chromanoise.study import electrons_at

DOCS = Path(__file__).parents[2] / "docs"
FINDINGS = (DOCS / "reader_findings.md").read_text(encoding="utf-8")
READERS = " ".join((DOCS / "readers.md").read_text(encoding="utf-8").split())
SENTENCES = " ".join(FINDINGS.split())
PLAIN = ("onyx-rgbw", "onyx-rgb", "model-rgb", "model-rgbw", "model-rgbwir", "model-rgbir")
PLAIN += ("model-cmy", "model-ryb", "model-rccb", "mt9v024-rgbw")
SENSORS = {
    **{name: {} for name in PLAIN},
    "mt9m131": {"beyond": "zero"},
    "ar0132at-rgbw": {"beyond": "zero", "peak_qe": 0.6},
}
LIGHTS = ("E", "A")
LEVELS = np.geomspace(0.01, 10.0, 41)
PAIRS = np.array(list(combinations(range(24), 2)))
WITHOUT, WITH, OWN_TIME = range(3)


@cache
def points(name, light):
    """Without IR-cut; with it at the same time; with it at its longer time. Full at 10 lx."""
    own = {"illuminant": light, "lux": 10.0, **SENSORS[name]}
    (bare,) = cn.analyze(name, **own).points
    time_ms = 1e3 * bare.exposure.time_s
    (cut,) = cn.analyze(name, time_ms=time_ms, filter="ircut-650", **own).points
    (alone,) = cn.analyze(name, filter="ircut-650", **own).points
    return bare, cut, alone


def distances(point, lux, *, brightness=True):
    """D_M of the 276 pairs, shot and read noise alone: d / sd, summed over the channels."""
    patches = colorchecker(point.sensor.grid).values.T
    mean = electrons_at(point, reflectance=patches) * (lux / point.level_lux)
    variance = mean + point.sensor.pixel.read_noise_e**2
    first, second = mean[PAIRS[:, 0]], mean[PAIRS[:, 1]]
    weight = 2 / (variance[PAIRS[:, 0]] + variance[PAIRS[:, 1]])
    d, m = first - second, first + second
    if not brightness:
        c = (weight * m * d).sum(axis=1) / (weight * m * m).sum(axis=1)
        d = d - c[:, None] * m
    return np.sqrt((weight * d * d).sum(axis=1))


@cache
def found(light, lux, brightness=True):
    """By sensor: distances without IR-cut, with it at the same time, with it at the longer one."""
    return {
        name: [distances(point, lux, brightness=brightness) for point in points(name, light)]
        for name in SENSORS
    }


def percents(light, lux, which, of_pairs, brightness=True):
    """How often a reader is right about the pair, over the sensors, from Phi(D / 2). [%]"""
    held = found(light, lux, brightness).values()
    return [100 * norm.cdf(of_pairs(every[which]) / 2) for every in held]


def cells(first):
    (line,) = [one for one in FINDINGS.splitlines() if one.startswith(first)]
    return [cell.strip() for cell in line.strip("|").split("|")]


def levels_of(cell):
    """Levels at which the sensor without IR-cut is better, as a cell of the first table says."""
    return LEVELS if cell == "every level" else LEVELS[float(cell.split()[1]) > LEVELS]


@pytest.mark.parametrize("name", SENSORS)
def test_the_table_has_the_levels_at_which_the_median_pair_is_better(name):
    row = next(one for one in FINDINGS.splitlines() if one.startswith(f"| {name} | below"))
    cell = [one.strip() for one in row.strip("|").split("|")]
    for light, with_it, without in (("E", 2, 3), ("A", 5, 6)):
        bare, cut, _ = points(name, light)
        for column, brightness in ((with_it, True), (without, False)):
            better = [
                lux
                for lux in LEVELS
                if np.median(distances(bare, lux, brightness=brightness))
                >= np.median(distances(cut, lux, brightness=brightness))
            ]
            assert better == levels_of(cell[column]).tolist()


@pytest.mark.parametrize("pair", ["median", "worst"])
@pytest.mark.parametrize("name", SENSORS)
def test_the_table_has_the_distances_of_median_and_worst_pair(name, pair):
    cell = cells(f"| {name} | {pair} |")
    statistic = np.median if pair == "median" else np.min
    at_10 = found("E", 10.0)[name]
    printed = [float(one) for one in cell[2:5]]
    assert printed == pytest.approx([statistic(one) for one in at_10], rel=5.1e-3)
    if pair == "median":
        shares = [100 * np.mean(other > at_10[WITHOUT]) for other in at_10[1:]]
        assert [float(one.split()[0]) for one in cell[5:7]] == pytest.approx(shares, abs=0.51)
    for text, lux in zip(cell[7:], (1.0, 0.1, 0.01), strict=True):
        right = [norm.cdf(statistic(one) / 2) for one in found("E", lux)[name][:2]]
        assert [float(one) for one in text.split(",")] == pytest.approx(right, abs=0.016)


def spread(values):
    return f"{min(values):.0f}", f"{max(values):.0f}"


def test_in_very_little_light_the_median_pair_is_nearly_chance():
    for lux, pattern in (
        (0.01, r"in (\d+) to (\d+) % of the readings without the IR-cut and in (\d+) to (\d+) %"),
        (0.1, r"At 0.1 lx it is (\d+) to (\d+) % without the IR-cut against (\d+) to (\d+) %"),
    ):
        right = [
            [one for light in LIGHTS for one in percents(light, lux, which, np.median)]
            for which in (WITHOUT, WITH)
        ]
        printed = [float(one) for one in re.search(pattern, SENTENCES).groups()]
        expected = [end(each) for each in right for end in (min, max)]
        assert printed == pytest.approx(expected, abs=1.6)


def test_the_share_of_pairs_that_are_better_with_the_ir_cut_is_the_printed_one():
    shares = {
        light: [100 * np.mean(one[WITH] > one[WITHOUT]) for one in found(light, 10.0).values()]
        for light in LIGHTS
    }
    low, high = spread([one for each in shares.values() for one in each])
    e, a = (spread(shares[light]) for light in LIGHTS)
    text = f"{low} to {high} % of the pairs are better with the IR-cut"
    assert f"{text} ({e[0]} to {e[1]} % with illuminant E, {a[0]} to {a[1]} % with A)" in SENTENCES


@pytest.mark.parametrize("which", [WITH, OWN_TIME])
@pytest.mark.parametrize("light", LIGHTS)
def test_the_worst_pair_of_every_sensor_is_better_with_the_ir_cut_at_10_lx(light, which):
    for one in found(light, 10.0).values():
        assert one[which].min() > one[WITHOUT].min()


def test_the_median_pair_is_better_with_the_ir_cut_for_the_printed_number_of_sensors():
    better = [
        sum(np.median(one[OWN_TIME]) > np.median(one[WITHOUT]) for one in found(x, 10.0).values())
        for x in LIGHTS
    ]
    text = f"in the median pair for {better[0]} of 12 (illuminant E) or {better[1]} of 12 (A)"
    assert text in SENTENCES


def test_from_a_tenth_of_a_lux_down_every_worst_pair_is_nearly_chance():
    for light in LIGHTS:
        for which in (WITHOUT, WITH):
            assert max(percents(light, 0.1, which, np.min)) < 60


def test_without_brightness_the_worst_pair_is_nearly_chance_and_the_median_at_a_tenth_of_a_lux():
    worst = [
        max(one for light in LIGHTS for one in percents(light, 10.0, which, np.min, False))
        for which in (WITHOUT, WITH)
    ]
    worst_said = f"{worst[0]:.0f} % classified correctly at 10 lx without the IR-cut"
    assert f"at most {worst_said}, {worst[1]:.0f} % with it" in SENTENCES
    median = [one for x in LIGHTS for one in percents(x, 0.1, WITHOUT, np.median, False)]
    low, high = spread(median)
    assert f"{low} to {high} % classified correctly without the IR-cut" in SENTENCES


def test_the_page_on_readers_has_median_and_worst_pair_at_one_time_and_at_its_own():
    points = [
        cn.analyze(name, lux=10.0, **time).points[0]
        for name, time in (
            ("onyx-rgbw", {"time_ms": 12.0}),
            ("onyx-rgb-ircut", {"time_ms": 12.0}),
            ("onyx-rgb-ircut", {}),
        )
    ]
    four, three, alone = (distances(point, 10.0) for point in points)
    for text in (
        f"is {np.median(four):.1f} for RGBW without IR-cut and {np.median(three):.1f} for RGB",
        f"D_M is {four.min():.2f} for RGBW and {three.min():.2f} for RGB",
        f"a median D_M of {np.median(alone):.1f} and a D_M of {alone.min():.1f} in the worst pair",
    ):
        assert text in READERS
    right = [100 * norm.cdf(np.median(distances(point, 0.01)) / 2) for point in points[:2]]
    printed = re.search(r"in (\d+) % of the readings without IR-cut and in (\d+) %", READERS)
    assert [float(one) for one in printed.groups()] == pytest.approx(right, abs=0.6)
    no_brightness = [
        100 * norm.cdf(np.median(distances(point, 0.1, brightness=False)) / 2)
        for point in points[:2]
    ]
    correct = r"\((\d+) % classified correctly without IR-cut, (\d+) % with it\)"
    printed = re.search(correct, READERS)
    assert [float(one) for one in printed.groups()] == pytest.approx(no_brightness, abs=0.6)
