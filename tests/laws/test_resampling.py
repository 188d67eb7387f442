"""Curves come onto the grid by straight lines, and never go on in silence."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.io import read_sensor_csv
from chromanoise.spectra import (
    DEFAULT_GRID,
    Grid,
    Spectra,
    cie_1931,
    color_axes,
    flat_field,
    illuminant_from,
    illuminant_named,
    interpolation_matrix,
    light,
    means_on_grid,
    on_grid,
    read_spectra_csv,
)
from outcomes import refused_input
from strategies import PIXEL

GRID = Grid.uniform(400, 700, 10)


def curve(wavelength_nm, values):
    return Spectra(
        wavelength_nm=np.asarray(wavelength_nm, dtype=float),
        values=np.asarray(values, dtype=float)[:, None],
        names=("G",),
        quantity="QE",
        unit="e-/photon",
        source="a datasheet",
    )


wavelengths = st.lists(st.floats(1.0, 60.0), min_size=12, max_size=30).map(
    lambda gaps: 399.0 + np.cumsum([0.0, *gaps]) * 400.0 / np.sum(gaps)
)


@given(wavelengths, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_a_straight_line_comes_onto_the_grid_without_error(at, offset, slope):
    line = on_grid(curve(at, offset + slope * at / 100), GRID)
    assert line.values[:, 0] == pytest.approx(offset + slope * GRID.wavelength_nm / 100, abs=1e-9)
    assert line.wavelength_nm == pytest.approx(GRID.wavelength_nm)
    assert line.notes == ()


@given(wavelengths, st.data())
def test_a_resampled_curve_stays_between_its_lowest_and_highest_value(at, data):
    values = data.draw(st.lists(st.floats(0.0, 1.0), min_size=at.size, max_size=at.size))
    seen = on_grid(curve(at, values), GRID).values
    assert min(values) - 1e-12 <= seen.min()
    assert seen.max() <= max(values) + 1e-12


@given(wavelengths)
def test_interpolation_weights_are_never_negative_and_add_up_to_1(at):
    matrix, _ = interpolation_matrix(at, GRID, beyond="refuse", what="a curve")
    assert matrix.min() >= 0
    assert matrix.sum(axis=1) == pytest.approx(np.ones(GRID.n), rel=1e-12)


@given(st.lists(st.floats(-5.0, 5.0), min_size=GRID.n, max_size=GRID.n))
def test_a_curve_on_the_grid_stays_as_it_is(values):
    assert on_grid(curve(GRID.wavelength_nm, values), GRID).values[:, 0] == pytest.approx(
        values, abs=1e-12
    )


@pytest.mark.parametrize(("beyond", "outside"), [("zero", [0.0, 0.0]), ("hold", [0.2, 0.8])])
def test_the_continuation_is_the_one_asked_for_and_is_told(beyond, outside):
    short = curve([450.0, 650.0], [0.2, 0.8])
    seen = on_grid(short, GRID, beyond=beyond)
    assert [seen.values[0, 0], seen.values[-1, 0]] == outside
    assert seen.values[GRID.wavelength_nm == 550, 0] == pytest.approx([0.5], rel=1e-12)
    assert len(seen.notes) == 1
    for part in (beyond, "450", "650", "a datasheet"):
        assert part in seen.notes[0]


def test_a_continuation_that_is_not_needed_is_not_told():
    assert on_grid(curve([300.0, 800.0], [0.0, 1.0]), GRID, beyond="hold").notes == ()


@pytest.mark.parametrize(
    ("at", "missing"),
    [
        ([450.0, 700.0], "400-440 nm"),
        ([400.0, 650.0], "660-700 nm"),
        ([450.0, 650.0], "400-440 and 660-700 nm"),
    ],
)
def test_a_short_curve_is_refused_with_the_wavelengths_that_are_missing(at, missing):
    subject = "QE of a datasheet"
    with refused_input(subject=subject, value=tuple(at), setting="beyond") as refused:
        on_grid(curve(at, [0.1, 0.2]), GRID)
    assert refused.value.found.partition("; ")[2] == f"{missing} are missing"


@pytest.mark.parametrize("beyond", ["refuse", "zero", "hold"])
def test_a_curve_in_micrometers_is_refused_whatever_its_continuation(beyond):
    with refused_input(subject="QE of a datasheet", value=(0.4, 0.7)):
        on_grid(curve([0.4, 0.55, 0.7], [0.1, 0.2, 0.3]), GRID, beyond=beyond)


def test_wavelengths_that_miss_the_end_by_rounding_are_not_short():
    seen = on_grid(curve([400.0 + 1e-9, 700.0 - 1e-9], [1.0, 1.0]), GRID)
    assert seen.values == pytest.approx(np.ones((GRID.n, 1)), rel=1e-12)


def test_the_observer_is_zero_where_the_cie_defines_it_so():
    seen = cie_1931(DEFAULT_GRID)
    assert (seen.values[DEFAULT_GRID.wavelength_nm > 830] == 0).all()
    assert seen.values[DEFAULT_GRID.wavelength_nm == 700, 1] == pytest.approx([0.004102], rel=1e-6)


def test_a_tabulated_lamp_is_not_carried_into_the_infrared_in_silence():
    with refused_input(value=(380.0, 780.0), setting="beyond"):
        illuminant_named("FL2", DEFAULT_GRID)
    dark, held = (illuminant_named("FL2", DEFAULT_GRID, beyond=b) for b in ("zero", "hold"))
    infrared = DEFAULT_GRID.wavelength_nm > 780
    assert (dark.irradiance[infrared] == 0).all()
    assert (held.irradiance[infrared] > 0).all()
    assert any("zero" in note for note in dark.notes)
    assert any("hold" in note for note in held.notes)


def test_a_held_lamp_still_gives_its_illuminance():
    # flat from 500 to 600 nm and held on both sides: equal energy
    lamp = illuminant_from(curve([500.0, 600.0], [1.0, 1.0]), DEFAULT_GRID, name="L", beyond="hold")
    white = light(flat_field(lamp, level_lux=100.0), "energy")
    assert (white @ color_axes(DEFAULT_GRID, "energy"))[1] == pytest.approx(100.0, rel=2e-3)


def test_a_sensor_file_comes_back_as_it_was_written(tmp_path):
    path = tmp_path / "toy.csv"
    path.write_text(
        "# measured on a bench\n\nwavelength_nm, R ,G\n400,0.1,0.2\n\n550,0.4,0.8\n700,0.3,0\n"
    )
    sensor = read_sensor_csv(path, Grid.uniform(400, 700, 150), PIXEL)
    assert sensor.name == "toy"
    assert sensor.names == ("R", "G")
    assert sensor.qe == pytest.approx(np.array([[0.1, 0.2], [0.4, 0.8], [0.3, 0.0]]), rel=1e-12)
    assert sensor.pixel == PIXEL


@pytest.mark.parametrize("beyond", ["zero", "hold"])
def test_a_sensor_says_how_its_curves_were_continued(tmp_path, beyond):
    path = tmp_path / "toy.csv"
    path.write_text("wavelength_nm,R\n400,0.1\n700,0.3\n")
    sensor = read_sensor_csv(path, DEFAULT_GRID, PIXEL, beyond=beyond)
    assert any(beyond in note and "400-700 nm" in note for note in sensor.notes)
    assert sensor.qe[-1, 0] == {"zero": 0.0, "hold": 0.3}[beyond]


@given(wavelengths.map(np.unique), st.data())
def test_a_table_survives_the_way_through_a_file(tmp_path_factory, at, data):
    values = data.draw(st.lists(st.floats(-1e3, 1e3), min_size=at.size, max_size=at.size))
    path = tmp_path_factory.mktemp("csv") / "curve.csv"
    rows = (f"{float(w)!r},{v!r}" for w, v in zip(at, values, strict=True))
    path.write_text("\n".join(["wavelength_nm,G", *rows]), encoding="utf-8-sig")
    back = read_spectra_csv(path, quantity="QE", unit="e-/photon")
    assert (back.wavelength_nm == at).all()
    assert list(back.values[:, 0]) == values


AT_NM = np.arange(350.0, 1101.0)
lines = st.lists(
    st.tuples(st.integers(85, 205).map(lambda k: 5 * k), st.floats(10.0, 1000.0)),
    min_size=1, max_size=6, unique_by=lambda line: line[0],
)  # fmt: skip


@given(lines)
def test_the_share_of_power_in_narrow_lines_is_that_of_lines_on_a_level(drawn):
    # triangles of 1 nm on a level of 1, 5 nm or more apart: areas by hand
    at_nm, heights = (np.array(each) for each in zip(*drawn, strict=True))
    power = 1 + (heights * (AT_NM[:, None] == at_nm)).sum(axis=1)
    lamp = illuminant_from(curve(AT_NM, power), DEFAULT_GRID, name="L")
    share = heights.sum() / (heights.sum() + 650)
    noted = [note for note in lamp.notes if "narrower" in note]
    if share > 0.035:
        assert float(noted[0].partition(" %")[0].rpartition(" ")[2]) == pytest.approx(
            100 * share, rel=0.06
        )
    elif share < 0.025:
        assert noted == []


@given(lines)
def test_averaging_over_the_cells_of_the_grid_keeps_the_power_of_each_line(drawn):
    at_nm, heights = (np.array(each) for each in zip(*drawn, strict=True))
    power = 1 + (heights * (AT_NM[:, None] == at_nm)).sum(axis=1)
    seen = means_on_grid(curve(AT_NM, power), DEFAULT_GRID).values[:, 0]
    # the cells cover 397.5 to 1052.5 nm; a triangle of 2 nm at its foot has its height as area
    assert 5 * seen.sum() == pytest.approx(655 + heights.sum(), rel=1e-12)


@pytest.mark.parametrize("step_nm", [1.0, 5.0])
def test_a_smooth_lamp_has_no_note_on_lines(step_nm):
    at = np.arange(350.0, 1101.0, step_nm)
    lamp = illuminant_from(curve(at, np.exp(-(((at - 560) / 25) ** 2))), DEFAULT_GRID, name="L")
    assert lamp.notes == ()
