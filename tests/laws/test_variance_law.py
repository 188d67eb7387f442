"""The law of the variance: sums, units, planes."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.base.rng import stream
from chromanoise.sensor import VarianceLaw
from outcomes import refused_input

NUMBERS = st.floats(0.0, 1e6)
LAWS = st.builds(VarianceLaw, floor_e2=NUMBERS, slope_e=NUMBERS, square=NUMBERS)


@given(LAWS, LAWS, NUMBERS)
def test_variances_of_independent_sources_add(one, other, mean_e):
    parts = one.variance_e2(mean_e) + other.variance_e2(mean_e)
    assert (one + other).variance_e2(mean_e) == pytest.approx(parts, rel=1e-12)
    assert (one + other - other).variance_e2(mean_e) == pytest.approx(
        one.variance_e2(mean_e), abs=1e-12 * parts
    )


@given(LAWS, NUMBERS, st.floats(1e-3, 1e3))
def test_readings_in_another_unit_have_the_variance_over_its_square(law, mean_e, unit_e):
    found = law.in_units_of(unit_e).variance_e2(mean_e / unit_e)
    assert found == pytest.approx(law.variance_e2(mean_e) / unit_e**2, rel=1e-12)


@given(LAWS, NUMBERS, st.floats(0.0, 1e3))
def test_a_share_of_the_variance_is_one_at_every_mean(law, mean_e, share):
    found = law.scaled(share).variance_e2(mean_e)
    assert found == pytest.approx(share * law.variance_e2(mean_e), rel=1e-12)


def test_the_variance_is_that_of_draws_of_a_pixel():
    """Poisson electrons of pixels with a gain and an offset of their own, and a readout."""
    rng, count, mean_e = stream(30), 400_000, 900.0
    light = mean_e * (1 + 0.02 * rng.standard_normal(count))
    values = rng.poisson(light) + rng.normal(0.0, 5.0, count)
    expected = VarianceLaw(floor_e2=25.0, slope_e=1.0, square=0.02**2).variance_e2(mean_e)
    assert abs(values.var() / expected - 1) < 5 * np.sqrt(2 / count)


def test_planes_are_taken_by_index_flag_or_all_alike():
    law = VarianceLaw(floor_e2=np.array([1.0, 2.0, 3.0]), slope_e=np.array([0.0, 0.0, 5.0]))
    assert law.take([2, 0, 2]).coefficients.tolist() == [[3, 1, 3], [5, 0, 5], [0, 0, 0]]
    assert law.take(np.array([False, True, True])).floor_e2.tolist() == [2, 3]
    assert law.take(1).variance_e2(np.array([7.0])).tolist() == [2]
    alike = VarianceLaw(slope_e=2.0).of_planes(2)
    assert alike.coefficients.tolist() == [[0, 0], [2, 2], [0, 0]]
    assert VarianceLaw(floor_e2=np.array([0.0, 1e-9])).has_noise.tolist() == [False, True]


def test_wrong_laws_are_refused():
    with refused_input(subject="floor_e2 without that of a part", value=-1.0):
        VarianceLaw(floor_e2=1.0) - VarianceLaw(floor_e2=2.0)
    with refused_input(subject="square", value=np.inf):
        VarianceLaw(square=np.inf)
    with refused_input(subject="the number of planes", value={"given": 3, "variance law": 2}):
        VarianceLaw(floor_e2=np.ones(2)).of_planes(3)
