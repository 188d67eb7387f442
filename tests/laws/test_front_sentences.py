"""The sentences on a front: shortfalls, gains, active limits and beaten references."""

import numpy as np
import pytest

from chromanoise.apps.design.design_result import front_sentences
from chromanoise.apps.design.objectives import OBJECTIVES
from chromanoise.apps.design.parameters import Parameter
from chromanoise.apps.design.pareto_front import Front, Member

PARAMETER = Parameter(name="R.width_nm", unit="nm", low=20.0, high=80.0)


def member(name, objectives, *, width_nm=40.0, active=(), **marks):
    return Member(
        name=name,
        values=np.array([width_nm]),
        sensor=None,
        objectives=objectives,
        extreme_of=marks.get("extreme_of", ()),
        knee=marks.get("knee", False),
        active=active,
    )


def sentences(middle, **marks):
    """Of a front between 26 dB with a color error of 8 and 20 dB with one of 1."""
    ends = [{"snr_y_db": 26.0, "delta_e": 8.0}, {"snr_y_db": 20.0, "delta_e": 1.0}]
    front = Front(
        objectives=("snr_y_db", "delta_e"),
        better=("higher", "lower"),
        members=(
            member("best-snr_y_db", ends[0], extreme_of=("snr_y_db",)),
            member("knee", dict(zip(("snr_y_db", "delta_e"), middle, strict=True)), **marks),
            member("best-delta_e", ends[1], extreme_of=("delta_e",)),
        ),
    )
    return front_sentences(front, [PARAMETER], {"old": {"snr_y_db": 25.0, "delta_e": 4.0}})


def test_the_knee_is_compared_with_the_best_of_each_objective():
    _, knee, _, _ = sentences((25.3, 4.0), knee=True)
    assert knee == (
        "knee: 0.7 dB short of the best SNR of Y for half the color error; "
        "4 times the lowest color error for 5.3 dB more SNR of Y."
    )


def test_an_extreme_has_its_value_and_its_shortfall():
    first, _, last, _ = sentences((25.3, 4.0), knee=True)
    assert first == "best-snr_y_db: the best SNR of Y (26 dB); 8 times the lowest color error."
    assert last == (
        "best-delta_e: the lowest color error (1 Delta E*ab); 6.0 dB short of the best SNR of Y."
    )


@pytest.mark.parametrize(
    ("error", "shortfall", "gain"),
    [
        (1.2, "20 % above the lowest color error", "15 % of the color error"),
        (1.0, "within 0.5 % of the lowest color error", "12 % of the color error"),
        (6.0, "6 times the lowest color error", "75 % of the color error"),
    ],
)
def test_small_ratios_are_percentages_and_large_ones_multiples(error, shortfall, gain):
    _, knee, _, _ = sentences((25.3, error), knee=True)
    assert f"; {shortfall} for " in knee
    assert f" for {gain};" in knee


def test_active_constraints_and_bounds_end_the_sentence():
    _, knee, _, _ = sentences((25.3, 4.0), knee=True, width_nm=80.0, active=("delta_e <= 4",))
    assert knee.endswith(". Held by delta_e <= 4, R.width_nm <= 80.")


@pytest.mark.parametrize(("middle", "count"), [((25.3, 4.0), 1), ((24.9, 3.0), 0)])
def test_a_reference_is_beaten_by_a_sensor_that_is_worse_in_no_objective(middle, count):
    assert sentences(middle)[-1].startswith(f"{count} of 3 sensors ")


def test_each_objective_has_a_short_name_of_its_own():
    short = [one.short for one in OBJECTIVES.values()]
    assert len(set(short)) == len(short)
    assert max(map(len, short)) < 20
