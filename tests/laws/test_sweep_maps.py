"""Two parameters: each row is a one-parameter sweep, and the laws that connect the two."""

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.study import SWEEPS, study_from_data, swept_values
from outcomes import refused_input

PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
LIGHT = {"first": 0.05, "last": 20.0, "points": 6, "time_ms": 12.0, "matrices": ["lmmse"]}


def mapped(*sensors, second, low, high, rows=3, **given):
    ends = {"second_first": low, "second_last": high, "second_points": rows}
    return cn.compare_map(*sensors, second_vary=second, **ends, **(LIGHT | given))


@pytest.mark.parametrize(
    ("second", "setting", "values", "more"),
    [
        ("f-number", "f_number", (2.0, 8.0), {}),
        ("read-noise-e", "read_noise_e", (1.0, 40.0), {}),
        ("prnu", "prnu", (0.0, 0.05), {}),
        ("dsnu-e", "dsnu_e", (0.0, 30.0), {}),
        ("dark-current-e-per-s", "dark_current_e_per_s", (1.0, 1e5), {}),
        ("temperature-c", "temperature_c", (0.0, 80.0), {"dark_current_e_per_s": 500.0}),
        ("ircut-nm", "ircut_nm", (600.0, 800.0), {}),
        ("crosstalk", "crosstalk", (0.0, 0.3), {}),
        ("bits", "bits", (8, 14), {}),
    ],
)
def test_a_row_is_the_sweep_with_the_second_value_as_a_setting(second, setting, values, more):
    sensors = ("model-rgb", "model-rgb-ircut")
    found = mapped(*sensors, second=second, low=values[0], high=values[1], rows=2, **more)
    for j, value in enumerate(values):
        curves = cn.compare(*sensors, **LIGHT, **more, **{setting: value}).curves
        for one, curve in zip(found.maps, curves, strict=True):
            assert one.value[j] == pytest.approx(curve.value, abs=1e-9, nan_ok=True)
            assert (one.saturated[j] == curve.saturated).all()


def test_electrons_depend_on_illuminance_over_the_square_of_the_f_number():
    """Eq. 1: M ~ N_lux / f#^2, and a matrix that looks at electrons alone sees nothing else."""
    octaves = {"first": 1.0, "last": 16.0, "points": 5}  # steps of 2
    found = mapped(*PAIR, second="f-number", low=2.0, high=4.0, **octaves)  # steps of sqrt(2)
    for one in found.maps:
        assert one.value[0, :-1] == pytest.approx(one.value[1, 1:], abs=1e-9)
        assert one.value[0, :-2] == pytest.approx(one.value[2, 2:], abs=1e-9)
        assert np.isfinite(one.value[2]).all()


@pytest.mark.parametrize("pair", [("lux", "prnu"), ("lux", "kelvin"), ("kelvin", "infrared")])
def test_the_order_of_the_parameters_only_transposes_the_values(pair):
    ends = {"lux": (0.1, 10.0), "prnu": (0.0, 0.1), "kelvin": (2500.0, 6500.0)}
    ends |= {"infrared": (0.0, 2.0)}
    given = {"time_ms": 1.0, "points": 3, "second_points": 3, "matrices": ["kernel"]}

    def over(one, other):
        keys = ("vary", "first", "last", "second_vary", "second_first", "second_last")
        values = (one, *ends[one], other, *ends[other])
        return cn.compare_map("onyx-rgbw", **dict(zip(keys, values, strict=True)), **given)

    forth, back = over(*pair).maps[0].value, over(*pair[::-1]).maps[0].value
    assert forth == pytest.approx(back.T, abs=1e-9)
    assert np.ptp(forth, axis=0).min() > 1e-3  # both have an effect
    assert np.ptp(forth, axis=1).min() > 1e-3


def test_the_line_where_two_sensors_are_equal_is_the_crossover_of_each_row():
    found = mapped(*PAIR, second="f-number", low=1.8, high=3.6)
    (line,) = found.lines
    for value, at in zip(found.maps[0].second_at.tolist(), line.at, strict=True):
        (crossed,) = cn.compare(*PAIR, **LIGHT, f_number=value).crossovers
        assert at == pytest.approx(crossed.at, rel=1e-7)
    assert len(line.at[0]) == 1
    assert line.at[2][0] == pytest.approx(4 * line.at[0][0], rel=1e-6)  # by eq. 1, as above


def test_the_best_sensor_at_each_pair_of_values_has_the_best_value():
    sensors = (*PAIR, "onyx-rgb", "onyx-rgbw-ircut")
    data = mapped(*sensors, second="read-noise-e", low=1.0, high=50.0).to_dict()
    values = {one["sensor"]: one["value"] for one in data["maps"]}
    assert data["crossovers"] == []
    for j, row in enumerate(data["best"]["lmmse"]):
        for k, name in enumerate(row):
            there = {one: value[j][k] for one, value in values.items() if value[j][k] is not None}
            assert name == max(there, key=there.get, default=None)
    assert len({name for row in data["best"]["lmmse"] for name in row}) > 2


def test_the_table_has_one_row_per_pair_of_values():
    found = mapped(*PAIR, second="f-number", low=2.0, high=4.0)
    table = found.to_table()
    assert len(table.rows) == 18
    first, last = table.rows[0], table.rows[-1]
    assert (first[0], first[1]) == pytest.approx((2.0, 0.05))
    assert (last[0], last[1]) == pytest.approx((4.0, 20.0))
    assert last[2] == found.maps[0].value[2, 5]


def test_crosstalk_costs_y_what_the_published_table_of_the_physics_says():
    """PHYSICS.md 5.2, Bayer, model-rgb-ircut at 10 lx and 11.25 ms: 10 %, 20 %, 30 %."""
    given = {"vary": "crosstalk", "first": 0.0, "last": 0.3, "points": 4, "time_ms": 11.25}
    (curve,) = cn.compare("model-rgb-ircut", **given).curves
    assert curve.value - curve.value[0] == pytest.approx([0.0, -0.63, -1.62, -3.39], abs=0.01)


def test_the_snr_of_a_bright_pixel_tends_to_one_over_prnu():
    given = {"vary": "prnu", "first": 0.05, "last": 0.2, "points": 2, "quantity": "bound"}
    (curve,) = cn.compare("model-mono", **given).curves
    assert curve.value == pytest.approx(-20 * np.log10([0.05, 0.2]), abs=0.3)


def test_bits_take_whole_numbers_only():
    assert swept_values(SWEEPS["bits"], 8.0, 14.0, 61).tolist() == [8, 9, 10, 11, 12, 13, 14]
    with refused_input(subject="sweep of bits", value=(8.0, 9.5)):
        swept_values(SWEEPS["bits"], 8.0, 9.5, 4)


def test_one_parameter_twice_is_refused():
    with refused_input(subject="vary", value="lux"):
        mapped(*PAIR, second="lux", low=1.0, high=2.0)


def test_a_grid_of_over_a_million_pairs_is_refused():
    with refused_input(subject="points", value=2_000_000):
        mapped(*PAIR, second="f-number", low=1.0, high=2.0, rows=2000, points=1000)


def test_a_setting_that_the_second_parameter_replaces_is_refused():
    with refused_input(subject="prnu", value=0.01):
        mapped(*PAIR, second="prnu", low=0.0, high=0.1, prnu=0.01)


def test_bands_over_all_priors_have_one_parameter():
    second = {"vary": "prnu", "first": 0.0, "last": 0.1}
    sweep = {"vary": "lux", "first": 0.1, "last": 1.0, "all_priors": True, "second": second}
    values = {"sensors": [{"name": "onyx-rgbw"}], "matrices": ["lmmse"], "sweeps": [sweep]}
    with refused_input(subject="all_priors", value=True):
        study_from_data(values)


def test_a_temperature_without_dark_current_is_refused():
    with refused_input(subject="temperature_c", value=0.0):
        mapped(*PAIR, second="temperature-c", low=0.0, high=40.0)


def test_crosstalk_without_a_mosaic_is_refused():
    with refused_input(subject="crosstalk", value=0.0):
        mapped("model-mono", second="crosstalk", low=0.0, high=0.3)


def test_a_mosaic_that_is_given_lets_crosstalk_vary():
    given = {"vary": "crosstalk", "first": 0.0, "last": 0.1, "points": 2, "time_ms": 5.0}
    swept = cn.compare("model-rgb-ircut", mosaic="RG/GB", **given).curves[0].value
    other = cn.analyze("model-rgb-ircut", crosstalk=0.1, mosaic="RG/GB", time_ms=5.0)
    assert swept[-1] == pytest.approx(other.color_snr_db()["model-rgb-ircut"]["Y"])
