"""What comes in from outside and cannot be used is refused with thing, unit, place and value."""

import re
from dataclasses import replace
from functools import partial
from unittest.mock import ANY

import jaxtyping
import numpy as np
import pytest

from chromanoise.base.errors import InputError, Setting
from chromanoise.geometry import dual_frame
from chromanoise.imaging import Work, rendered
from chromanoise.io import read_sensor_csv
from chromanoise.noise import (
    Exposure,
    expected_electrons,
    monte_carlo,
    raw_covariance,
    time_to_saturation,
)
from chromanoise.sensor import Mosaic, behind_filter, with_channels
from chromanoise.spectra import (
    DEFAULT_GRID,
    Cube,
    Grid,
    Illuminant,
    Scene,
    Spectra,
    black_body,
    builtin_cube,
    equal_energy,
    flat_cube,
    flat_field,
    illuminant_from,
    illuminant_named,
    led,
    read_spectra_csv,
)
from chromanoise.study import analyzed, sensor_named
from outcomes import refused_input
from strategies import EXPOSURE, GRID, PIXEL, point_of, raw_of, sensor_of, white_channel

NAN, INF = float("nan"), float("inf")
LAMP = equal_energy(GRID)
WHITE = flat_field(LAMP, level_lux=10.0)
used = partial(point_of, white_channel())


def with_entry(shape, index, value, fill=0.5):
    array = np.full(shape, fill)
    array[index] = value
    return array


def qe_with(value):
    return with_entry((GRID.n, 2), (4, 1), value)


def sensor_with(value):
    return sensor_of(qe_with(value), name="bad")


def spectra(wavelength=(400.0, 500.0, 600.0), values=((0.1,), (0.2,), (0.3,)), names=("G",)):
    return Spectra(
        wavelength_nm=np.array(wavelength),
        values=np.array(values),
        names=names,
        quantity="QE",
        unit="e-/photon",
        source="a datasheet",
    )


def cube_with(value):
    return Cube(
        wavelength_nm=GRID.wavelength_nm,
        stored=with_entry((3, 4, GRID.n), (2, 1, 5), value),
        source="a cube",
    )


def picture_of(cube, **more):
    return rendered(cube, used(), **more)


def measurement(mean=(1.0, 2.0), covariance=((1.0, 0.0), (0.0, 1.0)), names=("a", "b")):
    return raw_of(mean, covariance, names)


def power(*values):
    return Spectra(
        wavelength_nm=np.array([400.0, 550.0, 700.0]),
        values=np.array(values)[:, None],
        names=("lamp",),
        quantity="power",
        unit="W/nm",
        source="a meter",
    )


def says(parts, made):
    """The sentence of a refusal has all parts, separated by semicolons here."""
    with pytest.raises(InputError) as refusal:
        made()
    for part in parts.split("; "):
        assert part in str(refusal.value)


def lamp(irradiance):
    return Illuminant(name="L", grid=GRID, irradiance=irradiance)


def lit(reflectance):
    return Scene(illuminant=LAMP, level_lux=1.0, reflectance=reflectance)


def strip(first_nm, last_nm):
    return flat_cube(np.array([first_nm, last_nm]), 0.5, height=1, width=1)


QE = "QE of a datasheet"
SPECTRA = (
    ("Grid.start_nm", ANY, lambda: Grid.uniform(NAN, 700, 5)),
    ("Grid.stop_nm", INF, lambda: Grid.uniform(400, INF, 5)),
    ("Grid.start_nm", -5, lambda: Grid.uniform(-5, 700, 5)),
    ("Grid.step_nm", 0, lambda: Grid.uniform(400, 700, 0)),
    ("Grid", (700, 400, 5), lambda: Grid.uniform(700, 400, 5)),
    ("Grid", (400, 400, 5), lambda: Grid.uniform(400, 400, 5)),
    ("Grid", (400, 702, 5), lambda: Grid.uniform(400, 702, 5)),
    (QE, ANY, lambda: spectra(values=((0.1,), (NAN,), (0.3,))), {"requirement": r"\[e-/photon\]"}),
    (f"wavelength_nm of {QE}", 500.0, lambda: spectra(wavelength=(400.0, 600.0, 500.0))),
    (f"wavelength_nm of {QE}", 500.0, lambda: spectra(wavelength=(400.0, 500.0, 500.0))),
    (
        f"wavelength_nm of {QE}",
        ANY,
        lambda: spectra(wavelength=(400.0, NAN, 600.0)),
        {"requirement": r"\[nm\]"},
    ),
    (ANY, {"names": 1, "values": 2}, lambda: spectra(values=((0.1, 0.1), (0.2, 0.2), (0.3, 0.3)))),
    (f"names of {QE}", "G", lambda: spectra(values=((0.1, 0.1),) * 3, names=("G", "G"))),
    (f"names of {QE}", "", lambda: spectra(names=("",))),
    (
        "a meter",
        -2.0,
        lambda: illuminant_from(power(1.0, -2.0, 1.0), GRID, name="L"),
        {"where": "column 'lamp' at 550 nm"},
    ),
    (
        "a datasheet",
        ("a", "b"),
        lambda: illuminant_from(
            spectra(values=((0.1, 0.1),) * 3, names=("a", "b")), GRID, name="L", beyond="hold"
        ),
        {"setting": "columns"},
    ),
    (
        "illuminant nothing",
        0.0,
        lambda: illuminant_from(power(0.0, 0.0, 0.0), GRID, name="nothing"),
    ),
    (ANY, ANY, lambda: illuminant_named("NaNK", GRID), {"requirement": "must be"}),
    ("width of illuminant LED500/0", 0.0, lambda: illuminant_named("LED500/0", GRID)),
)


REFUSED = (
    ("irradiance of illuminant L; W m-2 nm-1; -1; (3,)", lambda: lamp(with_entry(GRID.n, 3, -1.0))),
    ("irradiance of illuminant L; nan; (3,)", lambda: lamp(with_entry(GRID.n, 3, NAN))),
    ("wavelengths; grid has 31; irradiance has 5", lambda: lamp(np.ones(5))),
    ("900", lambda: led(Grid.uniform(400, 1050, 5), 900.0)),
    ("[K]; 0", lambda: black_body(GRID, 0.0)),
    ("D66; D65", lambda: illuminant_named("D66", GRID)),
    ("illuminant", lambda: illuminant_named("", GRID)),
    ("D50; 780 nm; beyond", lambda: illuminant_named("D50", DEFAULT_GRID)),
    ("NaNK", lambda: illuminant_named("NaNK", GRID)),
    ("-500", lambda: illuminant_named("-500K", GRID)),
    ("LEDred", lambda: illuminant_named("LEDred", GRID)),
    ("reflectance; -0.25; (1, 7)", lambda: lit(with_entry((2, GRID.n), (1, 7), -0.25))),
    ("reflectance; nan; (7,)", lambda: lit(with_entry(GRID.n, 7, NAN))),
    ("level_lux; [lx]; 0", lambda: flat_field(LAMP, level_lux=0.0)),
    ("level_lux; [lx]; nan", lambda: flat_field(LAMP, level_lux=NAN)),
    ("wavelengths; illuminant has 31; reflectance has 7", lambda: lit(np.ones(7))),
    (
        "mean_e; [e-]; 2 of 3; -3; (1,)",
        lambda: raw_covariance(np.array([5.0, -3.0, -8.0]), read_noise_e=1.0),
    ),
    ("mean_e; [e-]; nan; (0,)", lambda: raw_covariance(np.array([NAN]), read_noise_e=1.0)),
    ("read_noise_e; [e-]; -1", lambda: raw_covariance(np.array([5.0]), read_noise_e=-1.0)),
    ("raw mean; [e-]; nan; (1,)", lambda: measurement(mean=(1.0, NAN))),
    (
        "raw covariance; [e-^2]; inf; (1, 1)",
        lambda: measurement(covariance=((1.0, 0.0), (0.0, INF))),
    ),
    ("coordinates; names has 1; mean has 2", lambda: measurement(names=("a",))),
    ("draws; 2; 1", lambda: monte_carlo(np.array([5.0]), PIXEL, np.eye(1), draws=1, seed=0)),
    ("a cube; reflectance; -0.5; row 2; column 1; 450 nm", lambda: picture_of(cube_with(-0.5))),
    ("a cube; nan; row 2; 450 nm", lambda: picture_of(cube_with(NAN))),
    ("a cube; 4095; row 2; column 1; 450 nm; scale", lambda: picture_of(cube_with(4095.0))),
    (
        "a flat cube; empty; (0, 3, 31)",
        lambda: flat_cube(GRID.wavelength_nm, 0.5, height=0, width=3),
    ),
    (
        "a cube; [nm]; 400 follows 500",
        lambda: Cube(
            wavelength_nm=np.array([500.0, 400.0]), stored=np.ones((1, 1, 2)), source="a cube"
        ),
    ),
    ("scale of a cube; -1", lambda: replace(cube_with(0.5), scale=-1.0)),
    ("a flat cube; 400-650 nm; 660-700 nm; beyond", lambda: picture_of(strip(400.0, 650.0))),
    ("a flat cube; 0.4-0.7; nm", lambda: picture_of(strip(0.4, 0.7), beyond="hold")),
    ("seed; -1", lambda: picture_of(cube_with(0.5), seed=-1)),
    ("level_lux; [lx]; -4", lambda: rendered(cube_with(0.5), used(level_lux=-4.0))),
    (
        "grid; 450-750 nm @10; 400-700 nm @10",
        lambda: rendered(cube_with(0.5), used(illuminant=equal_energy(Grid.uniform(450, 750, 10)))),
    ),
    ("cheker", lambda: builtin_cube("builtin:cheker")),
    ("one point; (2, 31)", lambda: analyzed(lit(np.ones((2, GRID.n))), white_channel(), EXPOSURE)),
)


@pytest.mark.parametrize(("parts", "made"), REFUSED)
def test_nouns_refuse_what_cannot_be_and_say_where(parts, made):
    says(parts, made)


def test_a_bad_pixel_is_told_by_its_row_in_the_whole_cube():
    with refused_input(where="row 2, column 1 (from 0), 450 nm", value=-0.5):
        picture_of(cube_with(-0.5), work=Work(tile_rows=1))


SENSORS = (
    ("time_s", 0.0, lambda: Exposure(time_s=0.0), {"requirement": r"\[s\]"}),
    ("time_s", ANY, lambda: Exposure(time_s=NAN)),
    ("f_number", -2.0, lambda: Exposure(time_s=1.0, f_number=-2.0)),
    ("magnification", ANY, lambda: Exposure(time_s=1.0, magnification=NAN)),
    ("QE of sensor bad", 1.5, lambda: sensor_with(1.5), {"requirement": r"\[e-/photon\]"}),
    ("QE of sensor bad", 45.0, lambda: sensor_of(np.full((GRID.n, 1), 45.0), name="bad")),
    ("QE of sensor bad", -0.1, lambda: sensor_with(-0.1)),
    ("QE of sensor bad", ANY, lambda: sensor_with(NAN)),
    ("QE of sensor bad", (31, 0), lambda: sensor_of(np.ones((GRID.n, 0)), name="bad")),
    (ANY, {"grid": 31, "qe": 5}, lambda: sensor_of(np.ones((5, 1)), name="bad")),
    ("channel names of bad", "R", lambda: sensor_of(qe_with(0.5), name="bad", names=("R", "R"))),
    (
        "mosaic channel of bad",
        "z",
        lambda: sensor_of(qe_with(0.5), name="bad", mosaic=Mosaic((("a", "z"),))),
    ),
    (
        "QE of sensor bad",
        1.5,
        lambda: replace(sensor_of(np.full((GRID.n, 2), 0.75), name="bad"), stacked=True),
    ),
    (
        "transmittance before toy",
        1.1,
        lambda: behind_filter(white_channel(), with_entry(GRID.n, 2, 1.1), name="f"),
    ),
    (
        ANY,
        {"sensor": 31, "transmittance": 3},
        lambda: behind_filter(white_channel(), np.ones(3), name="f"),
    ),
    ("channel of toy", "IR", lambda: with_channels(white_channel(), ["IR"], name="few")),
    (
        "channel names of bad",
        "R\x1b[31m",
        lambda: sensor_of(qe_with(0.5), name="bad", names=("R\x1b[31m", "G")),
    ),
    ("name of a sensor", "a\nb", lambda: sensor_of(qe_with(0.5), name="a\nb")),
    ("channel names of few", "W", lambda: with_channels(white_channel(), ["W", "W"], name="few")),
    ("sensor", "onyx-rbg", lambda: sensor_named("onyx-rbg", DEFAULT_GRID)),
    ("mosaic", (), lambda: Mosaic(())),
    ("mosaic", (2, 1), lambda: Mosaic((("R", "G"), ("B",)))),
    (
        "grid",
        (DEFAULT_GRID, GRID),
        lambda: expected_electrons(
            flat_field(equal_energy(DEFAULT_GRID), level_lux=1.0), white_channel(), EXPOSURE
        ),
    ),
    (
        "sensor blind",
        ANY,
        lambda: time_to_saturation(WHITE, sensor_of(np.zeros((GRID.n, 1)), name="blind")),
    ),
    ("share", -0.5, lambda: time_to_saturation(WHITE, white_channel(), share=-0.5)),
    ("share", 99.0, lambda: time_to_saturation(WHITE, white_channel(), share=99.0)),
    (
        "channel b",
        0.0,
        lambda: dual_frame(np.array([[1.0, 0.0]] * 3), names=("a", "b"), metric="quanta"),
    ),
)


@pytest.mark.parametrize("row", SPECTRA + SENSORS)
def test_nouns_refuse_what_cannot_be_by_fields(row):
    subject, value, made, *fields = row
    with refused_input(subject=subject, value=value, **dict(*fields)):
        made()


# Here the checked shapes of the test run would complain first; a user's run has only ours.
MISSHAPEN = (
    ("raw covariance; (2, 2); (1, 1)", lambda: measurement(covariance=((1.0,),))),
    (
        "a cube; 3 bands; 2 wavelengths",
        lambda: Cube(
            wavelength_nm=np.array([400.0, 500.0]), stored=np.ones((1, 1, 3)), source="a cube"
        ),
    ),
)


@pytest.fixture
def unchecked_shapes():
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.mark.usefixtures("unchecked_shapes")
@pytest.mark.parametrize(("parts", "made"), MISSHAPEN)
def test_nouns_refuse_shapes_that_do_not_belong_together(parts, made):
    says(parts, made)


# monte_carlo is public, and these reach numpy's own complaint instead of ours
UNREFUSED = (
    lambda: monte_carlo(np.array([-1.0]), PIXEL, np.eye(1), draws=5, seed=0),
    lambda: monte_carlo(np.array([NAN]), PIXEL, np.eye(1), draws=5, seed=0),
    lambda: monte_carlo(np.array([1.0]), PIXEL, np.eye(1), draws=5, seed=-1),
)


@pytest.mark.parametrize("made", UNREFUSED)
def test_a_monte_carlo_refuses_what_cannot_be(made):
    with pytest.raises(InputError):
        made()


# text of a file -> fields of the refusal, whose subject is the path
FILES = (
    ("", {"value": 0}),
    ("# one\n# two\n", {"value": 0}),
    ("wavelength_nm,R\n", {"value": 1}),
    ("wavelength_nm,R\n400,0.1\n", {"value": 2}),
    ("lambda,R\n400,0.1\n410,0.2\n", {"where": "line 1", "value": "lambda"}),
    ("400,0.1\n410,0.2\n420,0.3\n", {"where": "line 1", "value": "400"}),
    ("wavelength_nm\n400\n410\n", {"where": "line 1", "value": "wavelength_nm"}),
    ("wavelength_nm,R,G\n400,.1,.2\n410,.1\n", {"where": "line 3", "value": 2, "requirement": "3"}),
    ("wavelength_nm,R\n400,.1\n410,.1,.2\n", {"where": "line 3", "value": 3, "requirement": "2"}),
    ("wavelength_nm,R\n400,.1\n\n410,high\n", {"where": "line 4, column 'R'", "value": "high"}),
    ("wavelength_nm,R\n400,\n410,.1\n", {"where": "line 2, column 'R'", "value": ""}),
    ("wavelength_nm,R\n400,.1\n410,nan\n", {"where": "line 3, column 'R'", "value": "nan"}),
    ("wavelength_nm,R\n400,.1\n410,inf\n", {"where": "line 3, column 'R'", "value": "inf"}),
    ("# bench\nwavelength_nm,R\n400,.1\n420,.1\n410,.1\n", {"where": "line 5", "value": 410.0}),
    ("wavelength_nm,R\n400,.1\n400,.2\n410,.1\n", {"where": "line 3", "value": 400.0}),
    ("wavelength_nm;R\n400;.1\n410;.2\n", {"where": "line 1", "value": "wavelength_nm;R"}),
)


def readers(path):
    """Both readers of the documented table."""
    return (
        lambda: read_spectra_csv(path, quantity="QE", unit="e-/photon"),
        lambda: read_sensor_csv(path, GRID, PIXEL),
    )


@pytest.mark.parametrize(("text", "fields"), FILES)
def test_a_file_that_is_no_table_is_refused_with_line_and_column(tmp_path, text, fields):
    path = tmp_path / "curves.csv"
    path.write_text(text, encoding="utf-8")
    for read in readers(path):
        with refused_input(subject=str(path), **fields):
            read()


def test_a_file_with_a_name_for_two_curves_is_refused(tmp_path):
    path = tmp_path / "curves.csv"
    path.write_text("wavelength_nm,R,R\n400,.1,.2\n410,.1,.2\n")
    for read in readers(path):
        with refused_input(subject=f"names of QE of {path}", value="R"):
            read()


@pytest.mark.parametrize(
    ("content", "where"),
    [(b"\x89PNG\r\n\x1a\n\x00\xff\xfe", "byte 0"), (b"wavelength_nm,R\n400,\xe9\n", "byte 20")],
    ids=["png", "latin-1"],
)
def test_a_binary_file_is_refused_by_name(tmp_path, content, where):
    path = tmp_path / "picture.csv"
    path.write_bytes(content)
    with refused_input(subject=str(path), where=where):
        read_spectra_csv(path, quantity="QE", unit="e-/photon")


@pytest.mark.parametrize("content", [b"\x00" * 4000, b"wavelength_nm,R\n400,0.1\n410,\x000.2\n"])
def test_a_file_of_null_bytes_is_refused(tmp_path, content):
    path = tmp_path / "nothing.csv"
    path.write_bytes(content)
    with refused_input(subject=str(path)):
        read_spectra_csv(path, quantity="QE", unit="e-/photon")


def test_a_file_with_an_endless_cell_is_refused(tmp_path):
    path = tmp_path / "endless.csv"
    path.write_text("wavelength_nm,R\n400," + "1" * 200_000 + "\n410,1\n")
    with refused_input(subject=str(path)):
        read_spectra_csv(path, quantity="QE", unit="1")


def test_a_file_that_is_not_there_is_refused_by_name(tmp_path):
    for path in (tmp_path / "missing.csv", tmp_path):
        with pytest.raises(InputError, match=re.escape(str(path))):
            read_spectra_csv(path, quantity="QE", unit="1")


@pytest.mark.parametrize(
    ("cell", "remedy"),
    [
        ("1.01", "divide percent by 100"),
        ("-0.002", Setting("negatives", ("zero",))),
        ("45", "divide percent by 100"),
    ],
)
def test_an_impossible_qe_in_a_file_is_refused_with_channel_and_wavelength(tmp_path, cell, remedy):
    path = tmp_path / "toy.csv"
    path.write_text(f"wavelength_nm,R,G\n400,.1,.2\n550,.3,{cell}\n700,.1,.1\n")
    place = "column 'G' at 550 nm"
    with refused_input(subject=str(path), where=place, value=float(cell), remedy=(remedy,)):
        read_sensor_csv(path, GRID, PIXEL)


@pytest.mark.parametrize(
    ("rows", "fields"),
    [
        ("400,.1\n650,.2\n", {"value": (400.0, 650.0), "setting": "beyond"}),
        ("0.4,.1\n0.7,.2\n", {"value": (0.4, 0.7)}),
        ("900,.1\n1000,.2\n", {"value": (900.0, 1000.0)}),
    ],
    ids=["short", "micrometers", "disjoint"],
)
def test_a_sensor_file_that_does_not_cover_the_grid_is_refused(tmp_path, rows, fields):
    path = tmp_path / "toy.csv"
    path.write_text("wavelength_nm,R\n" + rows)
    with refused_input(subject=f"QE of {path}", **fields):
        read_sensor_csv(path, GRID, PIXEL)


def test_refusals_are_value_errors():
    assert issubclass(InputError, ValueError)


def test_a_noun_does_not_change_with_the_array_it_was_made_from():
    qe = np.full((GRID.n, 1), 0.5)
    sensor = sensor_of(qe)
    qe[0, 0] = NAN
    assert sensor.qe[0, 0] == 0.5
