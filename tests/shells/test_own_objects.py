"""Objects of Python in place of names and files: curves, observers, matrices, cubes, points."""

import json
import pickle
import tomllib
import warnings
from dataclasses import replace

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.apps.design import DESIGN_STARTER, DesignStudy, task_of
from chromanoise.base.errors import errors_in
from chromanoise.sensor import PAPER_PIXEL
from chromanoise.spectra import DEFAULT_GRID, Grid, OwnObserver, builtin_cube, observer_table
from chromanoise.study import (
    Given,
    matrix_makers,
    sensor_named,
    study_as_command,
    study_as_python,
    study_as_toml,
    study_from_data,
    study_hash,
)
from chromanoise.study.resolve_names import object_word
from chromanoise.web.answers import ChartReplies
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.page_studies import Studies
from outcomes import refused, refused_input

pd = pytest.importorskip("pandas")
NM = np.arange(400.0, 1051.0, 10.0)
MADE = 0.4 + 0.3 * np.sin(NM[:, None] / (40.0 + 25.0 * np.arange(3)))  # 0.1 to 0.7


def colour_science(nm, values, names, quantity):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        colour = pytest.importorskip("colour")
    if len(names) == 1:
        return colour.SpectralDistribution(values[:, 0], nm, name=names[0])
    return colour.MultiSpectralDistributions(values, nm, labels=names)


def series_or_frame(nm, values, names, quantity):
    frame = pd.DataFrame(values, index=nm, columns=names)
    return frame[names[0]] if len(names) == 1 else frame


def data_array(nm, values, names, quantity):
    xarray = pytest.importorskip("xarray")
    at = {"wavelength": nm, "channel": names}
    return xarray.DataArray(values.T, coords=at, dims=("channel", "wavelength"))


def in_um(nm, values, names, quantity):
    xarray = pytest.importorskip("xarray")
    axis = ("wavelength", nm / 1000, {"units": "um"})
    return xarray.DataArray(values, coords=[axis, ("band", names)])


OBJECTS = {
    "colour-science": colour_science,
    "pandas": series_or_frame,
    "pandas in um": lambda nm, values, names, quantity: pd.DataFrame(
        values, index=pd.Index(nm / 1000, name="wavelength_um"), columns=names
    ),
    "xarray": data_array,
    "xarray in um": in_um,
    "arrays": lambda nm, values, names, quantity: (nm, values),
    "lists": lambda nm, values, names, quantity: (nm.tolist(), values.tolist()),
    "mapping": lambda nm, values, names, quantity: (
        {"wavelength_nm": nm} | dict(zip(names, values.T, strict=True))
    ),
    "Spectra": lambda nm, values, names, quantity: cn.Spectra(
        wavelength_nm=nm, values=values, names=tuple(names), quantity=quantity, unit="1", source="s"
    ),
}
OWN_POWER = {"illuminant_per": "energy"}
ROLES = {  # columns, quantity, call
    "sensor": (3, "QE", lambda own: cn.analyze(own, lux=10)),
    "sensor in a comparison": (3, "QE", lambda own: cn.compare(own, points=3)),
    "sensor of a matrix": (3, "QE", lambda own: cn.matrix(own, lux=10)),
    "light": (
        1,
        "power",
        lambda own: cn.analyze("onyx-rgb-ircut", illuminant=own, lux=10, **OWN_POWER),
    ),
    "chart": (3, "reflectance", lambda own: cn.analyze("onyx-rgbw", chart_file=own, chart=True)),
    "patch": (1, "reflectance", lambda own: cn.analyze("onyx-rgbw", patch=own)),
    "pairs": (3, "reflectance", lambda own: cn.analyze("onyx-rgbw", pairs=own, reader="machine")),
    "prior": (3, "reflectance", lambda own: cn.analyze("onyx-rgbw", matrix="lmmse", prior=own)),
    "filter": (1, "transmittance", lambda own: cn.analyze("onyx-rgbw", filter=own)),
    "filter of a channel": (
        1,
        "transmittance",
        lambda own: cn.analyze("onyx-rgbw", channel_filters={"R": own}),
    ),
    "white balance": (
        1,
        "power",
        lambda own: cn.analyze("onyx-rgb-ircut", pipeline=True, white_balance=own),
    ),
}


def numbers(data):
    """All numbers of plain data, in order, without the texts."""
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list | tuple | np.ndarray):
        return [one for part in data for one in numbers(part)]
    return [] if isinstance(data, str) or data is None else [float(data)]


def csv_of(path, nm, values, names):
    rows = [",".join(map(repr, map(float, row))) for row in np.column_stack([nm, values])]
    path.write_text("\n".join([f"wavelength_nm,{','.join(names)}", *rows]) + "\n")
    return path


def of(count, quantity="QE"):
    return ["R", "G", "B"] if count == 3 else ["power" if quantity == "power" else "own"]


BY_FILE = {}  # the numbers of each role, once
WHOLE = ("sensor", "light")  # of three curves and of one; what reads an object knows no role


@pytest.mark.parametrize(
    ("kind", "role"),
    [(kind, role) for role in WHOLE for kind in OBJECTS]
    + [(kind, role) for role in ROLES if role not in WHOLE for kind in ("xarray in um", "mapping")],
)
def test_an_object_gives_the_digits_of_the_same_curves_in_a_file(here, kind, role):
    count, quantity, call = ROLES[role]
    names, values = of(count, quantity), MADE[:, :count]
    if role not in BY_FILE:
        BY_FILE[role] = numbers(call(csv_of(here / "own.csv", NM, values, names)).to_dict())
    by_object = numbers(call(OBJECTS[kind](NM, values, names, quantity)).to_dict())
    exact = "um" not in kind  # nm / 1000 * 1000 is rounded to 1e-9 nm
    assert len(by_object) > 5
    np.testing.assert_allclose(by_object, BY_FILE[role], rtol=0 if exact else 1e-9)


def test_the_digits_of_a_render_of_curves_are_those_of_their_file(here):
    file = csv_of(here / "own.csv", NM, MADE, of(3))
    curves = OBJECTS["Spectra"](NM, MADE, of(3), "QE")
    own = replace(curves, source="own")  # the noise of a picture depends on the name of its sensor
    first, second = (cn.render("builtin:checker", one, seed=3) for one in (file, own))
    np.testing.assert_array_equal(first.captures[0].picture.xyz, second.captures[0].picture.xyz)


PIXEL = {"read_noise_e": 3.0, "full_well_e": 8000.0, "pitch_um": 2.0}
FUNCTIONS = {
    "compare_map": lambda own: cn.compare_map(own, points=3, second_points=2).to_dict(),
    "sensitivity": lambda own: cn.sensitivity(own, objectives=["snr_y_db"]).to_dict(),
    "denoise": lambda own: {
        "values": cn.denoise(
            np.full((12, 12), 900.0), unit="e-", sensor=own, mosaic="RG/GB", time_ms=10, **PIXEL
        ).values_e.ravel()
    },
}


@pytest.mark.parametrize("function", FUNCTIONS)
def test_each_function_of_a_sensor_takes_a_dataframe_as_its_file(here, function):
    call = FUNCTIONS[function]
    by_file = numbers(call(csv_of(here / "own.csv", NM, MADE, of(3))))
    by_frame = numbers(call(pd.DataFrame(MADE, NM, of(3))))
    np.testing.assert_allclose(by_frame, by_file, rtol=1e-12)
    assert len(by_file) > 5


def test_an_unknown_pixel_has_the_note_and_the_keywords_of_a_file(here):
    file, frame = csv_of(here / "own.csv", NM, MADE, of(3)), pd.DataFrame(MADE, NM, of(3))

    def notes(one, name, **pixel):
        found = cn.analyze(one, lux=10, **pixel).to_dict()["sensors"][0]["notes"]
        return [note.replace(str(file), "X").replace(name, "X") for note in found]

    for pixel in (
        {},
        {"read_noise_e": 3.0},
        {"pitch_um": 2.0, "full_well_e": 5e3, "read_noise_e": 1.0},
    ):
        expected = [note.replace("X.csv", "X") for note in notes(file, "own", **pixel)]
        assert notes(frame, "own sensor", **pixel) == expected


@pytest.mark.parametrize("kind", ["colour-science", "pandas", "xarray", "arrays", "mapping"])
def test_percent_is_refused_as_in_a_file(here, kind):
    with pytest.raises(cn.InputError) as by_file:
        cn.analyze(csv_of(here / "own.csv", NM, 100 * MADE, of(3)))
    with pytest.raises(cn.InputError) as by_object:
        cn.analyze(OBJECTS[kind](NM, 100 * MADE, of(3), "QE"))
    one, other = by_file.value, by_object.value
    assert (one.requirement, one.value) == (other.requirement, other.value)
    assert [r.name for r in one.remedy] == [r.name for r in other.remedy] == ["qe_scale"]


HOLE = np.where(np.arange(NM.size)[:, None] == 10, np.nan, MADE)


def test_the_units_of_a_dataarray_declare_percent_as_in_a_file():
    xarray = pytest.importorskip("xarray")
    made = xarray.DataArray(MADE, coords=[("wavelength", NM), ("channel", of(3))])
    percent = (100 * made).assign_attrs(units="%")
    for own, other in zip(
        numbers(cn.analyze(percent).to_dict()), numbers(cn.analyze(made).to_dict()), strict=True
    ):
        assert own == pytest.approx(other, rel=1e-12)


BAD = {
    "not a number": (pd.DataFrame(HOLE, NM, of(3)), {"where": "curve 'R' at 500 nm"}),
    "infinite": ((NM, np.where(np.isnan(HOLE), np.inf, MADE)), {"value": np.inf}),
    "masked": ((NM, np.ma.masked_invalid(HOLE)), {"subject": "own sensor"}),
    "decreasing": (pd.DataFrame(MADE[::-1], NM[::-1], of(3)), {"value": 1040.0}),
    "repeated wavelength": ((np.r_[400.0, NM[:-1]], MADE), {"value": 400.0}),
    "one wavelength": ((NM[:1], MADE[:1]), {"subject": "wavelengths of own sensor"}),
    "in um without a unit": (pd.DataFrame(MADE, NM / 1000, of(3)), {"setting": "wavelength_unit"}),
    "another count of rows": ((NM[:5], MADE), {"value": (66,)}),
    "three axes": ((NM, MADE[None]), {"subject": "own sensor"}),
    "no curve": (pd.DataFrame(index=NM), {"subject": "own sensor"}),
    "text": (pd.DataFrame(MADE, NM, of(3)).astype(str) + "x", {"where": "values"}),
    "complex": ((NM, MADE * 1j), {"where": "values"}),
    "one name for two curves": (pd.DataFrame(MADE, NM, ["R", "R", "B"]), {"value": "R"}),
    "negative": ((NM, MADE - 0.5), {"where": "column 'channel 1' at 400 nm"}),
    "an array without wavelengths": (MADE, {"subject": "sensors"}),
    "another type": ({1, 2}, {"subject": "sensors"}),
    "a short table": ((NM[:30], MADE[:30]), {"setting": "beyond"}),
    "a light": (cn.illuminant_named("E", DEFAULT_GRID), {"subject": "sensors"}),
}


@pytest.mark.parametrize("case", BAD)
def test_curves_that_cannot_be_used_are_refused_in_one_sentence(case):
    given, fields = BAD[case]
    with refused_input(**fields) as caught:
        cn.analyze(given)
    (error,) = errors_in(caught.value)
    assert "\n" not in str(error)


def test_a_dataarray_needs_one_dimension_of_wavelengths():
    xarray = pytest.importorskip("xarray")
    for dims in (("x", "y"), ("wavelength",)):
        with refused_input(subject="own sensor"):
            cn.analyze(
                xarray.DataArray(MADE[:, : len(dims)].squeeze(), dims=dims, name="own sensor")
            )


@pytest.mark.parametrize("setting", ["illuminant", "chart_file", "observer", "filter", "patch"])
def test_a_setting_of_an_unknown_type_is_refused_by_its_name(setting):
    with refused_input(subject=setting):
        cn.analyze("onyx-rgbw", **{setting: MADE})


def test_two_objects_of_one_name_are_refused():
    own = cn.Spectra(
        wavelength_nm=NM, values=MADE, names=("R", "G", "B"), quantity="QE", unit="1", source="cam"
    )
    with refused_input(subject="sensors", value="cam"):
        cn.analyze(own, replace(own, values=0.9 * MADE))
    both = cn.analyze((NM, MADE), (NM, 0.9 * MADE), lux=10).raw_snr_db()
    assert list(both) == ["own sensor", "own sensor 2"]


def own_camera(*, qe=0.5, names=("R", "G", "B"), grid=DEFAULT_GRID, **pixel):
    centers_nm = np.array([600.0, 540.0, 460.0])
    bells = np.exp(-(((grid.wavelength_nm[:, None] - centers_nm) / 40) ** 2))
    return cn.Sensor(
        name="own", grid=grid, qe=qe * bells, names=names, pixel=replace(PAPER_PIXEL, **pixel)
    )


class GaussianCamera:
    """A sensor model of one's own."""

    def to_sensor(self):
        return own_camera()


def test_a_model_of_a_sensor_gives_its_sensor():
    model = GaussianCamera()
    by_model, by_sensor = (cn.analyze(one, lux=5) for one in (model, model.to_sensor()))
    assert by_model.to_dict() == by_sensor.to_dict()
    model.to_sensor = lambda: "onyx-rgbw"
    with refused_input(subject="to_sensor of GaussianCamera", value="str"):
        cn.analyze(model)


def table(observer="cie-1931-2"):
    held = observer_table(observer)
    return held.wavelength_nm, held.values


@pytest.mark.evidence
def test_an_observer_of_the_numbers_of_cie_1931_gives_its_digits(done, here):
    csv_of(here / "mycmf.csv", *table(), ["x", "y", "z"])
    usual = numbers(cn.analyze("onyx-rgbw", lux=10, merit=True).to_dict())
    frame = pd.DataFrame(table()[1], table()[0], ["x", "y", "z"])
    for observer in ("mycmf.csv", here / "mycmf.csv", table(), frame, observer_table()):
        own = cn.analyze("onyx-rgbw", lux=10, merit=True, observer=observer)
        assert numbers(own.to_dict()) == usual
    words = ("analyze", "onyx-rgbw", "--json", "-")
    by_name, by_file = (
        json.loads(done(*words, *more)[0]) for more in ((), ("--observer", "mycmf.csv"))
    )
    assert by_file["observer"] == "mycmf.csv"
    assert numbers(by_file) == numbers(by_name)
    other = cn.analyze("onyx-rgbw", lux=10, merit=True, observer=table("cie-1964-10"))
    named = cn.analyze("onyx-rgbw", lux=10, merit=True, observer="cie-1964-10")
    assert numbers(other.to_dict()) == numbers(named.to_dict()) != usual


def test_a_study_names_an_observer_beside_it(done, here):
    (here / "inside").mkdir()
    csv_of(here / "inside" / "mycmf.csv", *table("cie-2015-2"), ["x", "y", "z"])
    text = 'observer = "{}"\n[[sensors]]\nname = "onyx-rgbw"\n'
    (here / "inside" / "study.toml").write_text(text.format("mycmf.csv"))
    (here / "named.toml").write_text(text.format("cie-2015-2"))
    for study, out in (("inside/study.toml", "own"), ("named.toml", "named")):
        done("run", study, "--out", out)
    own, named = (
        json.loads((here / out / "analysis-kernel.json").read_text()) for out in ("own", "named")
    )
    assert numbers(own["result"]["sensors"]) == numbers(named["result"]["sensors"])
    assert set(own["files"]) == {"inside/mycmf.csv"}


def test_the_page_takes_an_observer_that_was_dropped_onto_it_and_no_other_file(here, uploads):
    file = csv_of(here / "mycmf.csv", *table("cie-2015-2"), ["x", "y", "z"])
    answers = ChartReplies(Studies(uploads))

    def stages(observer):
        study = {"sensors": [{"name": "onyx-rgbw"}], "observer": observer}
        return json.loads(answers.answer({"study": study, "want": ["stages"]}))["parts"]

    own = stages(uploads.keep("mycmf.csv", file.read_bytes()).id)
    assert numbers(own) == numbers(stages("cie-2015-2"))
    assert "observer mycmf.csv" in json.dumps(own)
    with pytest.raises(QuestionError):
        stages(str(file))


@pytest.mark.parametrize(
    ("values", "fields"),
    [
        (table()[1][:, :2], {"value": 2}),
        (100 * table()[1], {"where": "curve 'channel 2'", "value": 100.0}),
        (table()[1] * [1, 1, 0], {"where": "curve 'channel 3'", "value": 0.0}),
        (table()[1] * np.nan, {"subject": "own observer"}),
    ],
    ids=["two functions", "percent", "a function of zeros", "not a number"],
)
def test_functions_that_are_no_observer_are_refused(values, fields):
    with refused_input(**fields):
        cn.analyze("onyx-rgbw", observer=(table()[0], values))


def test_an_observer_that_ends_before_it_has_fallen_is_refused():
    nm, values = table()
    inside = (nm >= 380) & (nm <= 650)
    with refused_input(subject="own observer", where="curve 'channel 1' at 650 nm"):
        cn.analyze("onyx-rgbw", observer=(nm[inside], values[inside]))


def test_a_file_that_is_no_observer_is_refused_by_the_option(run, here):
    csv_of(here / "two.csv", NM, MADE[:, :2], ["x", "y"])
    refused(run("analyze", "onyx-rgbw", "--observer", "two.csv"), "two.csv", value=2)
    refused(run("analyze", "onyx-rgbw", "--observer", "none.csv"), subject="none.csv")


def test_an_observer_is_equal_to_a_copy_of_itself():
    held = observer_table()
    one = OwnObserver("mine", held)
    other = OwnObserver("mine", replace(held, values=held.values * 0.9))
    assert pickle.loads(pickle.dumps(one)) == one != other
    assert one == "mine"
    assert one != "cie-1931-2"
    with refused_input(subject="observer", value="cie-1931-2"):
        OwnObserver("cie-1931-2", held)


def test_a_matrix_of_numbers_or_of_a_function_gives_the_digits_of_its_method():
    usual = cn.analyze("onyx-rgb-ircut", lux=10)
    made = cn.matrix("onyx-rgb-ircut", lux=10).matrix
    rows = made.matrix
    for own in (rows, rows.tolist(), made, lambda point: rows, lambda point: made):
        found = cn.analyze("onyx-rgb-ircut", matrix=own, lux=10)
        for stage in ("raw_snr_db", "color_snr_db"):
            assert getattr(found, stage)() == getattr(usual, stage)()


def test_a_function_of_the_light_adapts_over_a_sweep_as_its_method():
    lmmse = matrix_makers(["lmmse"], "quanta")["lmmse"]

    def my_method(point):
        assert isinstance(point, cn.OperatingPoint)
        return lmmse(point).matrix

    found = cn.compare("onyx-rgbw", matrices=[my_method, "lmmse"], points=5)
    own, named = found.curves
    assert (own.matrix, named.matrix) == ("my_method", "lmmse")
    np.testing.assert_allclose(own.value, named.value, rtol=1e-9)


@pytest.mark.parametrize(
    ("matrix", "fields"),
    [
        (np.eye(3)[:2], {"value": (2, 3)}),
        (np.eye(3), {"value": (3, 3)}),
        (np.full((3, 4), np.nan), {}),
        (np.array(3.0), {"value": ()}),
        ([["a"] * 4] * 3, {"subject": "own matrix"}),
        (lambda point: None, {"subject": "own matrix"}),
    ],
    ids=["two rows", "three channels", "not a number", "a number", "text", "None"],
)
def test_a_matrix_that_does_not_fit_is_refused(matrix, fields):
    with refused_input(**fields):
        cn.analyze("onyx-rgbw", matrix=matrix)


@pytest.mark.parametrize("raised", [ZeroDivisionError("by zero"), KeyError("R"), RuntimeError()])
@pytest.mark.parametrize(
    "call",
    [
        lambda own: cn.analyze("onyx-rgbw", matrix=own),
        lambda own: cn.compare("onyx-rgbw", matrices=[own], points=2),
        lambda own: cn.matrix("onyx-rgbw", matrix=own),
        lambda own: cn.sensitivity("onyx-rgbw", matrix=own, objectives=["delta_e"]),
    ],
    ids=["analyze", "compare", "matrix", "sensitivity"],
)
def test_an_error_of_a_function_of_a_matrix_names_it_and_is_the_cause(raised, call):
    def my_matrix(point):
        raise raised

    with refused_input(subject="function my_matrix", value=str(raised)) as caught:
        call(my_matrix)
    assert caught.value.__cause__ is raised
    assert type(raised).__name__ in caught.value.found


def test_an_input_error_in_a_function_of_a_matrix_keeps_its_subject():
    def my_matrix(point):
        return cn.matrix("no-such-sensor")

    with refused_input(subject="matrix of my_matrix", value="no-such-sensor"):
        cn.analyze("onyx-rgbw", matrix=my_matrix)


def test_a_matrix_for_other_channels_is_refused():
    other = cn.matrix("onyx-rgb-ircut").matrix
    with refused_input(subject="matrix of own matrix"):
        cn.analyze("onyx-rgbw", matrix=other)


def test_a_cube_gives_the_pictures_of_its_name():
    cube = builtin_cube("builtin:checker")
    by_name, by_object = (cn.render(one, "onyx-rgbw", seed=7) for one in ("builtin:checker", cube))
    one, other = (made.captures[0].picture.xyz for made in (by_name, by_object))
    np.testing.assert_array_equal(one, other)
    with refused_input(subject="cube", value="ndarray"):
        cn.render(np.ones((4, 4, 3)), "onyx-rgbw")
    with refused_input(subject="key", value="k"):
        cn.render(cube, "onyx-rgbw", key="k")


POINT = {"lux": 3.0, "f_number": 2.2, "illuminant": "G173", "observer": "cie-1964-10"}


def test_an_operating_point_gives_its_own_analysis(here):
    csv_of(here / "chart.csv", NM, MADE, of(3))
    usual = cn.analyze("onyx-rgbw", **POINT, patch=0.2, chart_file="chart.csv")
    again = cn.analyze(usual.points[0])
    np.testing.assert_allclose(numbers(again.to_dict()), numbers(usual.to_dict()), rtol=1e-12)
    with refused_input(subject="lux", value=4.0):
        cn.analyze(usual.points[0], lux=4.0)
    with refused_input(subject="sensors", value=2):
        cn.analyze(usual.points[0], "onyx-rgb-ircut")


@pytest.mark.parametrize("written", [study_as_toml, study_as_command, study_as_python])
@pytest.mark.parametrize(
    "data",
    [
        {"sensors": [{"name": object_word("cam")}]},
        {"sensors": [{"name": "onyx-rgbw"}], "light": {"illuminant": object_word("cam")}},
        {"sensors": [{"name": "onyx-rgbw"}], "observer": object_word("cam")},
        {"sensors": [{"name": "onyx-rgbw"}], "matrices": [object_word("cam")]},
    ],
    ids=["sensor", "light", "observer", "matrix"],
)
def test_a_study_of_an_object_is_not_written_as_text(written, data):
    study = study_from_data(data)
    with refused_input(subject="the study", value=("cam",)):
        written(study)
    with refused_input(subject="cam"):
        cn.run(study)


def own_matrix(factor):
    return lambda point: factor * np.ones((3, 3))


OTHERS = {
    "values": (own_camera(), own_camera(qe=np.nextafter(0.5, 1))),
    "wavelengths": (own_camera(), own_camera(grid=Grid.uniform(400, 1050, 10))),
    "names": (own_camera(), own_camera(names=("R", "W", "B"))),
    "pixel": (own_camera(), own_camera(prnu=0.01)),
    "a matrix": (np.eye(3), np.eye(3) * 2),
    "the shape of a matrix": (np.zeros((3, 2)), np.zeros((2, 3))),
    "a function": (own_matrix(1.0), own_matrix(2.0)),
    "its code": (lambda point: point.level_lux * 2, lambda point: point.level_lux * 3),
    "an observer": tuple(
        OwnObserver("mine", replace(observer_table("cie-1931-2"), source="mine", values=values))
        for values in (
            observer_table("cie-1931-2").values,
            observer_table("cie-1931-2").values * [1.0, 1.0, 1.01],
        )
    ),
}


@pytest.mark.parametrize(("one", "other"), OTHERS.values(), ids=OTHERS)
def test_the_hash_of_a_study_depends_on_the_numbers_of_its_objects(one, other):
    study = study_from_data({"sensors": [{"name": object_word("own")}]}, source="a test")
    hashes = {study_hash(study, objects={object_word("own"): each}) for each in (one, other, one)}
    assert len(hashes) == 2
    assert study_hash(study) not in hashes


def test_a_search_of_another_sensor_object_has_another_identity():
    part = {"name": object_word("own")}
    document = DesignStudy.model_validate({**tomllib.loads(DESIGN_STARTER), "sensors": [part]})
    start, identities = sensor_named("onyx-rgbw", DEFAULT_GRID), []
    for factor in (0.5, 0.5, 0.6):
        own = replace(start, name="own", qe=start.qe * factor)
        task = task_of(document, Given(objects={object_word("own"): own}))
        identities.append(task.identity)
    assert identities[0] == identities[1] != identities[2]
