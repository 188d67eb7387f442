"""What comes in from outside and cannot be used is refused with thing, unit, place and value."""

import re
from dataclasses import replace

import jaxtyping
import numpy as np
import pytest

from chromanoise.base.errors import InputError, Setting
from chromanoise.geometry import dual_frame
from chromanoise.imaging import Work, rendered
from chromanoise.io import read_sensor_csv
from chromanoise.noise import (
    Exposure,
    Measurement,
    OperatingPoint,
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
from strategies import EXPOSURE, GRID, PIXEL, sensor_of, white_channel

NAN, INF = float("nan"), float("inf")
LAMP = equal_energy(GRID)
WHITE = flat_field(LAMP, level_lux=10.0)


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


def used(illuminant=None, level_lux=10.0):
    return OperatingPoint(
        sensor=white_channel(),
        exposure=EXPOSURE,
        illuminant=illuminant or LAMP,
        level_lux=level_lux,
    )


def measurement(mean=(1.0, 2.0), covariance=((1.0, 0.0), (0.0, 1.0)), names=("a", "b")):
    return Measurement(
        mean=np.array(mean), covariance=np.array(covariance), names=names, kind="raw", unit="e-"
    )


def power(*values):
    return Spectra(
        wavelength_nm=np.array([400.0, 550.0, 700.0]),
        values=np.array(values)[:, None],
        names=("lamp",),
        quantity="power",
        unit="W/nm",
        source="a meter",
    )


SPECTRA = {
    "grid of NaN": (lambda: Grid.uniform(NAN, 700, 5), {"subject": "Grid.start_nm"}),
    "grid of infinity": (
        lambda: Grid.uniform(400, INF, 5),
        {"subject": "Grid.stop_nm", "value": INF},
    ),
    "negative grid": (lambda: Grid.uniform(-5, 700, 5), {"subject": "Grid.start_nm", "value": -5}),
    "grid without step": (
        lambda: Grid.uniform(400, 700, 0),
        {"subject": "Grid.step_nm", "value": 0},
    ),
    "grid downward": (
        lambda: Grid.uniform(700, 400, 5),
        {"subject": "Grid", "value": (700, 400, 5)},
    ),
    "grid of one": (lambda: Grid.uniform(400, 400, 5), {"subject": "Grid", "value": (400, 400, 5)}),
    "grid of broken steps": (
        lambda: Grid.uniform(400, 702, 5),
        {"subject": "Grid", "value": (400, 702, 5)},
    ),
    "spectra of NaN": (
        lambda: spectra(values=((0.1,), (NAN,), (0.3,))),
        {"subject": "QE of a datasheet", "requirement": r"\[e-/photon\]"},
    ),
    "spectra out of order": (
        lambda: spectra(wavelength=(400.0, 600.0, 500.0)),
        {"subject": "wavelength_nm of QE of a datasheet", "value": 500.0},
    ),
    "spectra of repeated wavelengths": (
        lambda: spectra(wavelength=(400.0, 500.0, 500.0)),
        {"subject": "wavelength_nm of QE of a datasheet", "value": 500.0},
    ),
    "spectra of NaN wavelength": (
        lambda: spectra(wavelength=(400.0, NAN, 600.0)),
        {"subject": "wavelength_nm of QE of a datasheet", "requirement": r"\[nm\]"},
    ),
    "spectra of too few names": (
        lambda: spectra(values=((0.1, 0.1), (0.2, 0.2), (0.3, 0.3))),
        {"value": {"names": 1, "values": 2}},
    ),
    "spectra of repeated names": (
        lambda: spectra(values=((0.1, 0.1),) * 3, names=("G", "G")),
        {"subject": "names of QE of a datasheet", "value": "G"},
    ),
    "spectra without a name": (
        lambda: spectra(names=("",)),
        {"subject": "names of QE of a datasheet", "value": ""},
    ),
    "light that is negative": (
        lambda: illuminant_from(power(1.0, -2.0, 1.0), GRID, name="L"),
        {"subject": "a meter", "where": "column 'lamp' at 550 nm", "value": -2.0},
    ),
    "light of two curves": (
        lambda: illuminant_from(
            spectra(values=((0.1, 0.1),) * 3, names=("a", "b")), GRID, name="L", beyond="hold"
        ),
        {"subject": "a datasheet", "value": ("a", "b"), "setting": "columns"},
    ),
    "light that is dark": (
        lambda: illuminant_from(power(0.0, 0.0, 0.0), GRID, name="nothing"),
        {"subject": "illuminant nothing", "value": 0.0},
    ),
    "temperature that is not a number": (
        lambda: illuminant_named("NaNK", GRID),
        {"requirement": "must be"},
    ),
    "diode without width": (
        lambda: illuminant_named("LED500/0", GRID),
        {"subject": "width of illuminant LED500/0", "value": 0.0},
    ),
}


@pytest.mark.parametrize(("made", "fields"), SPECTRA.values(), ids=SPECTRA)
def test_spectra_grids_and_lights_refuse_what_cannot_be_by_fields(made, fields):
    with refused_input(**fields):
        made()


REFUSED = {
    # Illuminant
    "lamp of negative light": (
        lambda: Illuminant(name="L", grid=GRID, irradiance=with_entry(GRID.n, 3, -1.0)),
        ["irradiance of illuminant L", "W m-2 nm-1", "-1", "(3,)"],
    ),
    "lamp of NaN": (
        lambda: Illuminant(name="L", grid=GRID, irradiance=with_entry(GRID.n, 3, NAN)),
        ["irradiance of illuminant L", "nan", "(3,)"],
    ),
    "lamp on another grid": (
        lambda: Illuminant(name="L", grid=GRID, irradiance=np.ones(5)),
        ["wavelengths", "grid has 31", "irradiance has 5"],
    ),
    "infrared diode": (lambda: led(Grid.uniform(400, 1050, 5), 900.0), ["900"]),
    "black body of no heat": (lambda: black_body(GRID, 0.0), ["[K]", "0"]),
    "lamp of unknown name": (lambda: illuminant_named("D66", GRID), ["D66", "D65"]),
    "lamp of no name": (lambda: illuminant_named("", GRID), ["illuminant"]),
    "lamp of short table": (
        lambda: illuminant_named("D50", DEFAULT_GRID),
        ["D50", "780 nm", "beyond"],
    ),
    "lamp of broken temperature": (lambda: illuminant_named("NaNK", GRID), ["NaNK"]),
    "lamp of negative temperature": (lambda: illuminant_named("-500K", GRID), ["-500"]),
    "diode of words": (lambda: illuminant_named("LEDred", GRID), ["LEDred"]),
    # Scene
    "scene of negative reflectance": (
        lambda: Scene(
            illuminant=LAMP, level_lux=1.0, reflectance=with_entry((2, GRID.n), (1, 7), -0.25)
        ),
        ["reflectance", "-0.25", "(1, 7)"],
    ),
    "scene of NaN": (
        lambda: Scene(illuminant=LAMP, level_lux=1.0, reflectance=with_entry(GRID.n, 7, NAN)),
        ["reflectance", "nan", "(7,)"],
    ),
    "scene in the dark": (lambda: flat_field(LAMP, level_lux=0.0), ["level_lux", "[lx]", "0"]),
    "scene of NaN lux": (lambda: flat_field(LAMP, level_lux=NAN), ["level_lux", "[lx]", "nan"]),
    "scene on another grid": (
        lambda: Scene(illuminant=LAMP, level_lux=1.0, reflectance=np.ones(7)),
        ["wavelengths", "illuminant has 31", "reflectance has 7"],
    ),
    # Measurement and noise
    "negative electrons": (
        lambda: raw_covariance(np.array([5.0, -3.0, -8.0]), read_noise_e=1.0),
        ["mean_e", "[e-]", "2 of 3", "-3", "(1,)"],
    ),
    "electrons of NaN": (
        lambda: raw_covariance(np.array([NAN]), read_noise_e=1.0),
        ["mean_e", "[e-]", "nan", "(0,)"],
    ),
    "negative read noise": (
        lambda: raw_covariance(np.array([5.0]), read_noise_e=-1.0),
        ["read_noise_e", "[e-]", "-1"],
    ),
    "measurement of NaN": (
        lambda: measurement(mean=(1.0, NAN)),
        ["raw mean", "[e-]", "nan", "(1,)"],
    ),
    "measurement of endless noise": (
        lambda: measurement(covariance=((1.0, 0.0), (0.0, INF))),
        ["raw covariance", "[e-^2]", "inf", "(1, 1)"],
    ),
    "measurement of too few names": (
        lambda: measurement(names=("a",)),
        ["coordinates", "names has 1", "mean has 2"],
    ),
    "one draw": (
        lambda: monte_carlo(np.array([5.0]), PIXEL, np.eye(1), draws=1, seed=0),
        ["draws", "2", "1"],
    ),
    # cubes and pictures
    "cube of negative reflectance": (
        lambda: picture_of(cube_with(-0.5)),
        ["a cube", "reflectance", "-0.5", "row 2", "column 1", "450 nm"],
    ),
    "cube of NaN": (lambda: picture_of(cube_with(NAN)), ["a cube", "nan", "row 2", "450 nm"]),
    "cube of counts": (
        lambda: picture_of(cube_with(4095.0)),
        ["a cube", "4095", "row 2", "column 1", "450 nm", "scale"],
    ),
    "cube of no pixels": (
        lambda: flat_cube(GRID.wavelength_nm, 0.5, height=0, width=3),
        ["a flat cube", "empty", "(0, 3, 31)"],
    ),
    "cube out of order": (
        lambda: Cube(
            wavelength_nm=np.array([500.0, 400.0]), stored=np.ones((1, 1, 2)), source="a cube"
        ),
        ["a cube", "[nm]", "400 follows 500"],
    ),
    "cube of negative scale": (
        lambda: replace(cube_with(0.5), scale=-1.0),
        ["scale of a cube", "-1"],
    ),
    "cube that ends short": (
        lambda: picture_of(flat_cube(np.array([400.0, 650.0]), 0.5, height=1, width=1)),
        ["a flat cube", "400-650 nm", "660-700 nm", "beyond"],
    ),
    "cube in micrometers": (
        lambda: picture_of(flat_cube(np.array([0.4, 0.7]), 0.5, height=1, width=1), beyond="hold"),
        ["a flat cube", "0.4-0.7", "nm"],
    ),
    "picture of negative seed": (
        lambda: picture_of(cube_with(0.5), seed=-1),
        ["seed", "-1"],
    ),
    "picture in the dark": (
        lambda: rendered(cube_with(0.5), used(level_lux=-4.0)),
        ["level_lux", "[lx]", "-4"],
    ),
    "picture by another lamp": (
        lambda: rendered(
            cube_with(0.5),
            used(equal_energy(Grid.uniform(450, 750, 10))),  # as many wavelengths, but others
        ),
        ["grid", "450-750 nm @10", "400-700 nm @10"],
    ),
    "builtin that is not there": (lambda: builtin_cube("builtin:cheker"), ["cheker"]),
    "many points at once": (
        lambda: analyzed(
            Scene(illuminant=LAMP, level_lux=1.0, reflectance=np.ones((2, GRID.n))),
            white_channel(),
            EXPOSURE,
        ),
        ["one point", "(2, 31)"],
    ),
}


@pytest.mark.parametrize(("made", "result"), REFUSED.values(), ids=REFUSED)
def test_nouns_refuse_what_cannot_be_and_say_where(made, result):
    with pytest.raises(InputError) as refusal:
        made()
    for part in result:
        assert part in str(refusal.value)


def test_a_bad_pixel_is_told_by_its_row_in_the_whole_cube():
    with refused_input(where="row 2, column 1 (from 0), 450 nm", value=-0.5):
        picture_of(cube_with(-0.5), work=Work(tile_rows=1))


SENSORS = {
    # Exposure
    "exposure of no time": (
        lambda: Exposure(time_s=0.0),
        {"subject": "time_s", "value": 0.0, "requirement": r"\[s\]"},
    ),
    "exposure of NaN": (lambda: Exposure(time_s=NAN), {"subject": "time_s"}),
    "exposure of negative aperture": (
        lambda: Exposure(time_s=1.0, f_number=-2.0),
        {"subject": "f_number", "value": -2.0},
    ),
    "exposure of NaN magnification": (
        lambda: Exposure(time_s=1.0, magnification=NAN),
        {"subject": "magnification"},
    ),
    # Sensor
    "sensor beyond 100 %": (
        lambda: sensor_with(1.5),
        {"subject": "QE of sensor bad", "value": 1.5, "requirement": r"\[e-/photon\]"},
    ),
    "sensor in percent": (
        lambda: sensor_of(np.full((GRID.n, 1), 45.0), name="bad"),
        {"subject": "QE of sensor bad", "value": 45.0},
    ),
    "sensor of negative QE": (
        lambda: sensor_with(-0.1),
        {"subject": "QE of sensor bad", "value": -0.1},
    ),
    "sensor of NaN": (lambda: sensor_with(NAN), {"subject": "QE of sensor bad"}),
    "sensor without channels": (
        lambda: sensor_of(np.ones((GRID.n, 0)), name="bad"),
        {"subject": "QE of sensor bad", "value": (31, 0)},
    ),
    "sensor on another grid": (
        lambda: sensor_of(np.ones((5, 1)), name="bad"),
        {"value": {"grid": 31, "qe": 5}},
    ),
    "sensor of repeated channels": (
        lambda: sensor_of(qe_with(0.5), name="bad", names=("R", "R")),
        {"subject": "channel names of bad", "value": "R"},
    ),
    "sensor of a foreign mosaic": (
        lambda: sensor_of(qe_with(0.5), name="bad", mosaic=Mosaic((("a", "z"),))),
        {"subject": "mosaic channel of bad", "value": "z"},
    ),
    "stacked channels beyond 100 %": (
        lambda: replace(sensor_of(np.full((GRID.n, 2), 0.75), name="bad"), stacked=True),
        {"subject": "QE of sensor bad", "value": 1.5},
    ),
    "filter beyond 100 %": (
        lambda: behind_filter(white_channel(), with_entry(GRID.n, 2, 1.1), name="f"),
        {"subject": "transmittance before toy", "value": 1.1},
    ),
    "filter on another grid": (
        lambda: behind_filter(white_channel(), np.ones(3), name="f"),
        {"value": {"sensor": 31, "transmittance": 3}},
    ),
    "channel that is not there": (
        lambda: with_channels(white_channel(), ["IR"], name="few"),
        {"subject": "channel of toy", "value": "IR"},
    ),
    "channel chosen twice": (
        lambda: with_channels(white_channel(), ["W", "W"], name="few"),
        {"subject": "channel names of few", "value": "W"},
    ),
    "sensor of unknown name": (
        lambda: sensor_named("onyx-rbg", DEFAULT_GRID),
        {"subject": "sensor", "value": "onyx-rbg"},
    ),
    # Mosaic
    "mosaic of nothing": (lambda: Mosaic(()), {"subject": "mosaic", "value": ()}),
    "mosaic of ragged rows": (
        lambda: Mosaic((("R", "G"), ("B",))),
        {"subject": "mosaic", "value": (2, 1)},
    ),
    # exposure meets sensor
    "scene and sensor apart": (
        lambda: expected_electrons(
            flat_field(equal_energy(DEFAULT_GRID), level_lux=1.0), white_channel(), EXPOSURE
        ),
        {"subject": "grid", "value": (DEFAULT_GRID, GRID)},
    ),
    "sensor that sees nothing": (
        lambda: time_to_saturation(WHITE, sensor_of(np.zeros((GRID.n, 1)), name="blind")),
        {"subject": "sensor blind"},
    ),
    "share below 0": (
        lambda: time_to_saturation(WHITE, white_channel(), share=-0.5),
        {"subject": "share", "value": -0.5},
    ),
    "share beyond full well": (
        lambda: time_to_saturation(WHITE, white_channel(), share=99.0),
        {"subject": "share", "value": 99.0},
    ),
    "channel that spans nothing": (
        lambda: dual_frame(np.array([[1.0, 0.0]] * 3), names=("a", "b"), metric="quanta"),
        {"subject": "channel b", "value": 0.0},
    ),
}


@pytest.mark.parametrize(("made", "fields"), SENSORS.values(), ids=SENSORS)
def test_sensors_and_exposures_refuse_what_cannot_be_by_fields(made, fields):
    with refused_input(**fields):
        made()


# Here the checked shapes of the test run would complain first; a user's run has only ours.
MISSHAPEN = {
    "measurement of another shape": (
        lambda: measurement(covariance=((1.0,),)),
        ["raw covariance", "(2, 2)", "(1, 1)"],
    ),
    "cube of other bands": (
        lambda: Cube(
            wavelength_nm=np.array([400.0, 500.0]), stored=np.ones((1, 1, 3)), source="a cube"
        ),
        ["a cube", "3 bands", "2 wavelengths"],
    ),
}


@pytest.fixture
def unchecked_shapes():
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.mark.usefixtures("unchecked_shapes")
@pytest.mark.parametrize(("made", "result"), MISSHAPEN.values(), ids=MISSHAPEN)
def test_nouns_refuse_shapes_that_do_not_belong_together(made, result):
    with pytest.raises(InputError) as refusal:
        made()
    for part in result:
        assert part in str(refusal.value)


# monte_carlo is public, and these reach numpy's own complaint instead of ours
UNREFUSED = {
    "negative mean": lambda: monte_carlo(np.array([-1.0]), PIXEL, np.eye(1), draws=5, seed=0),
    "NaN mean": lambda: monte_carlo(np.array([NAN]), PIXEL, np.eye(1), draws=5, seed=0),
    "negative seed": lambda: monte_carlo(np.array([1.0]), PIXEL, np.eye(1), draws=5, seed=-1),
}


@pytest.mark.parametrize("made", UNREFUSED.values(), ids=UNREFUSED)
def test_a_monte_carlo_refuses_what_cannot_be(made):
    with pytest.raises(InputError):
        made()


# text of a file -> fields of the refusal, whose subject is the path
FILES = {
    "empty": ("", {"value": 0}),
    "comments only": ("# one\n# two\n", {"value": 0}),
    "header only": ("wavelength_nm,R\n", {"value": 1}),
    "one row": ("wavelength_nm,R\n400,0.1\n", {"value": 2}),
    "wrong header": ("lambda,R\n400,0.1\n410,0.2\n", {"where": "line 1", "value": "lambda"}),
    "no header": ("400,0.1\n410,0.2\n420,0.3\n", {"where": "line 1", "value": "400"}),
    "header without curves": (
        "wavelength_nm\n400\n410\n",
        {"where": "line 1", "value": "wavelength_nm"},
    ),
    "too few cells": (
        "wavelength_nm,R,G\n400,.1,.2\n410,.1\n",
        {"where": "line 3", "value": 2, "requirement": "3"},
    ),
    "too many cells": (
        "wavelength_nm,R\n400,.1\n410,.1,.2\n",
        {"where": "line 3", "value": 3, "requirement": "2"},
    ),
    "a word": (
        "wavelength_nm,R\n400,.1\n\n410,high\n",
        {"where": "line 4, column 'R'", "value": "high"},
    ),
    "an empty cell": (
        "wavelength_nm,R\n400,\n410,.1\n",
        {"where": "line 2, column 'R'", "value": ""},
    ),
    "NaN": (
        "wavelength_nm,R\n400,.1\n410,nan\n",
        {"where": "line 3, column 'R'", "value": "nan"},
    ),
    "infinity": (
        "wavelength_nm,R\n400,.1\n410,inf\n",
        {"where": "line 3, column 'R'", "value": "inf"},
    ),
    "unsorted": (
        "# bench\nwavelength_nm,R\n400,.1\n420,.1\n410,.1\n",
        {"where": "line 5", "value": 410.0},
    ),
    "repeated": (
        "wavelength_nm,R\n400,.1\n400,.2\n410,.1\n",
        {"where": "line 3", "value": 400.0},
    ),
    "semicolons": (
        "wavelength_nm;R\n400;.1\n410;.2\n",
        {"where": "line 1", "value": "wavelength_nm;R"},
    ),
}


def readers(path):
    """Both readers of the documented table."""
    return (
        lambda: read_spectra_csv(path, quantity="QE", unit="e-/photon"),
        lambda: read_sensor_csv(path, GRID, PIXEL),
    )


@pytest.mark.parametrize(("text", "fields"), FILES.values(), ids=FILES)
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
