"""Relative noise of RGB, RPB and CMY filters after color correction.

Adams & Pillman, "Digital camera image processing pipeline", in Lukac (ed.), Computational
Photography (CRC, 2010); decimal points restored as in docs/numbers.md. US 5,609,978
bounds the noise gain Psi by 6.5.
"""

from dataclasses import dataclass

import numpy as np
import pytest

from chromanoise.noise import through
from strategies import raw_of

REC_709 = np.array([[0.2126, 0.7152, 0.0722]])
BRIGHTEST = 1.0390


@dataclass(frozen=True)
class Set:
    response: tuple[float, ...]
    matrix: tuple[tuple[float, ...], ...]
    trace_before: float
    trace_after: float
    sigma_before: float
    sigma_after: float
    noise_gain: float


SETS = {
    "RGB": Set(
        response=(0.2616, 0.3972, 0.3159),
        matrix=((1.558, -0.531, -0.027), (-0.078, 1.477, -0.399), (0.039, -0.508, 1.469)),
        trace_before=9.88,
        trace_after=24.41,
        sigma_before=1.24,
        sigma_after=1.60,
        noise_gain=4.733,
    ),
    "RPB": Set(
        response=(0.2616, 1.0390, 0.3159),
        matrix=((2.000, -1.373, 0.373), (-1.062, 3.384, -1.322), (0.412, -1.248, 1.836)),
        trace_before=8.26,
        trace_after=53.22,
        sigma_before=0.84,
        sigma_after=2.51,
        noise_gain=8.497,
    ),
    "CMY": Set(
        response=(0.5134, 0.5486, 0.5929),
        matrix=((-2.554, 2.021, 1.533), (0.941, -1.512, 1.571), (1.201, 1.783, -1.984)),
        trace_before=5.67,
        trace_after=51.34,
        sigma_before=1.03,
        sigma_after=1.90,
        noise_gain=8.900,
    ),
}
each_set = pytest.mark.parametrize("filters", SETS.values(), ids=SETS)


def before(filters):
    """Shot noise relative to the brightest channel: variances 1.0390 / r at a mean of 1."""
    return raw_of(np.ones(3), np.diag(BRIGHTEST / np.array(filters.response)))


def after(filters):
    matrix = np.array(filters.matrix)
    return through(before(filters), matrix, names=("R", "G", "B"), kind="RGB", unit="1")


def luminance_sd(measurement):
    return float(
        np.sqrt(through(measurement, REC_709, names=("L",), kind="L", unit="1").variance[0])
    )


@each_set
def test_total_noise_before_and_after_the_matrix(filters):
    # RPB's printed 53.22 is 53.227 when recomputed: the 3-digit matrix decides the last digit
    assert before(filters).variance.sum() == pytest.approx(filters.trace_before, abs=0.005)
    assert after(filters).variance.sum() == pytest.approx(filters.trace_after, abs=0.008)


@each_set
def test_luminance_noise_before_and_after_the_matrix(filters):
    assert luminance_sd(before(filters)) == pytest.approx(filters.sigma_before, abs=0.005)
    assert luminance_sd(after(filters)) == pytest.approx(filters.sigma_after, abs=0.005)


@each_set
def test_noise_gain_is_what_equal_channels_of_unit_noise_add_up_to(filters):
    unit = raw_of(np.ones(3), np.eye(3))
    seen = through(unit, np.array(filters.matrix), names=("R", "G", "B"), kind="RGB", unit="1")
    assert np.sqrt(seen.variance).sum() == pytest.approx(filters.noise_gain, abs=6e-4)


def test_a_pan_channel_lowers_the_raw_noise_and_raises_that_of_the_picture():
    # the finding of the chapter: P wins 0.40 before the matrix and loses 0.91 behind it
    rgb, rpb = SETS["RGB"], SETS["RPB"]
    assert luminance_sd(before(rgb)) - luminance_sd(before(rpb)) == pytest.approx(0.40, abs=0.01)
    assert luminance_sd(after(rpb)) - luminance_sd(after(rgb)) == pytest.approx(0.91, abs=0.01)
