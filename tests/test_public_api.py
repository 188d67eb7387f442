"""The names of ``import chromanoise as cn``, their documentation, and what results offer."""

import inspect
import json
import pydoc
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.cli.entry import commands
from chromanoise.study import described_settings, run_study
from documentation import faults_of_class, faults_of_function, sections
from outcomes import refused_input

NAMES = [
    "Analyses",
    "Characterization",
    "ColorMatrix",
    "Comparison",
    "ComparisonMap",
    "Cube",
    "DenoisedPicture",
    "Design",
    "Exposure",
    "Grid",
    "Illuminant",
    "InputError",
    "League",
    "Matrices",
    "MatrixResult",
    "Measurement",
    "Mosaic",
    "OperatingPoint",
    "Pictures",
    "Pixel",
    "Results",
    "Scene",
    "Sensitivity",
    "Sensor",
    "Setting",
    "Spectra",
    "Study",
    "__version__",
    "analyze",
    "apps",
    "card",
    "characterize",
    "charts",
    "color",
    "compare",
    "compare_map",
    "denoise",
    "geometry",
    "illuminant_named",
    "imaging",
    "io",
    "league",
    "matrix",
    "metrics",
    "noise",
    "optimize",
    "read_cube",
    "read_curves",
    "read_study",
    "render",
    "run",
    "sensitivity",
    "sensor",
    "sensor_named",
    "spectra",
    "study",
    "study_from_data",
]
OPERATING_POINT = "10 lx (illuminant E, 11.94 ms, f/1.8)"


def test_the_public_names_are_these():
    assert dir(cn) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_each_public_name_can_be_imported(name):
    space = {}
    exec(f"from chromanoise import {name}", space)
    assert space[name] is getattr(cn, name)


def test_the_import_loads_neither_numpy_nor_click():
    script = "import chromanoise, sys; print(sorted({'numpy', 'click'} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout == "[]\n"


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'chromanoise' has no attribute 'analyse'"):
        cn.analyse  # noqa: B018


# ---- documentation ----

COMPUTE_NOTHING = {  # they read, or make a noun of what is given
    *("illuminant_named", "read_cube", "read_curves", "read_study", "sensor_named"),
    "study_from_data",
}


PUBLIC = [name for name in NAMES if callable(getattr(cn, name))]


@pytest.mark.parametrize("name", PUBLIC)
def test_the_documentation_of_each_public_name_is_complete(name):
    public = getattr(cn, name)
    if inspect.isclass(public):
        assert faults_of_class(name, public) == []
    else:
        computes = name not in COMPUTE_NOTHING
        assert faults_of_function(name, public, computes=computes) == []
        assert "Raises" in sections(public.__doc__)


def incomplete(time_s, sensor):
    """The time of a sensor.

    Parameters
    ----------
    time_s
        How long.
    """
    if time_s < 0:
        raise ValueError
    return time_s, sensor


incomplete.__annotations__["return"] = tuple


def test_the_rule_of_documentation_finds_each_lack():
    assert faults_of_function("f", incomplete, computes=True) == [
        "f: sensor is no documented parameter",
        "f: no unit of time_s",
        "f: no Returns",
        "f: no Raises",
        "f: no source",
    ]
    assert faults_of_function("f", incomplete, computes=False, text="") == ["f: no docstring"]


@pytest.mark.parametrize(
    "name",
    ["analyze", "card", "compare", "compare_map", "denoise", "matrix", "render", "sensitivity"],
)
def test_help_lists_each_setting_with_the_description_of_the_study(name):
    shown = pydoc.render_doc(getattr(cn, name), renderer=pydoc.plaintext)
    for one in described_settings(name):
        assert one.of.field.description
        assert f"{one.name}: " in shown.splitlines()[2]
        assert all(line in shown for line in str(one).split("\n"))


def test_the_defaults_that_help_shows_are_those_of_the_function():
    shown = {one.name: one.default for one in described_settings("compare")}
    names = ["lux", "f_number", "saturate", "vary", "first", "last", "points", "quantity"]
    given = cn.compare("model-mono", **{name: shown[name] for name in names} | {"points": 3})
    assert given.to_dict() == cn.compare("model-mono", points=3).to_dict()


# ---- arguments ----


def test_a_sensor_and_an_illuminant_may_be_objects():
    named = cn.analyze("onyx-rgbw", "model-rgb", illuminant="A", read_noise_e=2.0, budget=True)
    sensors = [cn.sensor_named(name) for name in ("onyx-rgbw", "model-rgb")]
    lamp = cn.illuminant_named("A")
    given = cn.analyze(*sensors, illuminant=lamp, read_noise_e=2.0, budget=True)
    assert given.to_dict() == named.to_dict()
    assert cn.matrix(sensors[0]).to_dict() == cn.matrix("onyx-rgbw").to_dict()
    mixed = cn.compare(sensors[0], "model-rgb", points=3)
    assert mixed.to_dict() == cn.compare("onyx-rgbw", "model-rgb", points=3).to_dict()


def test_an_object_takes_the_pixel_of_a_file_and_a_filter_as_a_name_does(tmp_path):
    sheet = tmp_path / "pixel.txt"
    sheet.write_text("K = 0.5 DN/e-\nsigma_d [e-] = 2.4\nmu_e.sat: 9000 e-\npixel pitch = 3 um\n")
    settings = {"pixel": sheet, "filter": "ircut-650", "read_noise_e": 4}
    by_name = cn.analyze("onyx-rgbw", **settings)
    assert cn.analyze(cn.sensor_named("onyx-rgbw"), **settings).to_dict() == by_name.to_dict()
    pixel = by_name.points[0].sensor.pixel
    assert (pixel.pitch_um, pixel.full_well_e, pixel.read_noise_e) == (3.0, 9000.0, 4.0)


def test_what_only_a_file_is_asked_is_refused_of_an_object():
    own = replace(cn.sensor_named("onyx-rgbw"), name="mine.csv")
    with refused_input(subject="qe_scale", value="percent"):
        cn.analyze(own, qe_scale="percent")
    lamp = replace(cn.illuminant_named("A"), name="lamp.csv")
    with refused_input(subject="illuminant_per", value="photon"):
        cn.analyze(own, illuminant=lamp, illuminant_per="photon")


def test_numbers_of_numpy_and_paths_are_numbers_and_names():
    data = cn.analyze("model-mono", lux=np.int64(3), time_ms=np.float32(4)).to_dict()
    assert data == cn.analyze(Path("model-mono"), lux=3, time_ms=4.0).to_dict()


@pytest.mark.parametrize(
    ("function", "word", "remedy"),
    [
        ("analyze", "lx", "did you mean lux?"),
        ("analyze", "vary", "it is one of compare and compare_map"),
        ("analyze", "matrices", "did you mean metric or matrix?"),
        ("compare", "matrix", "did you mean matrices?"),
        ("matrix", "method", "did you mean matrix?"),
        ("compare_map", "method", "did you mean matrices?"),
        ("compare", "clip", "it is one of analyze and render"),
        ("matrix", "seed", "it is one of card and render and sensitivity"),
        ("render", "fnumber", "did you mean f_number?"),
    ],
)
def test_an_unknown_argument_is_refused_with_what_may_be_meant(function, word, remedy):
    names = ("builtin:checker", "onyx-rgbw") if function == "render" else ("onyx-rgbw",)
    with refused_input(subject=word, remedy=(remedy,)):
        getattr(cn, function)(*names, **{word: 1})


@pytest.mark.parametrize(
    ("settings", "subject"),
    [
        ({"lux": -1.0}, "lux"),
        ({"matrix": "lmse"}, "matrix"),
        ({"qe_scale": "percent"}, "qe_scale"),
        ({"f_number": 1e-9}, "f_number"),
        ({"lux": -10}, "lux"),
        ({"time_ms": 3.0, "saturate": 0.5}, "time_ms"),
    ],
)
def test_a_single_error_is_raised_itself_and_names_the_argument(settings, subject):
    with pytest.raises(cn.InputError) as caught:
        cn.analyze("onyx-rgbw", **settings)
    assert caught.value.subject == subject


def test_a_sensor_given_twice_is_refused_by_the_name_of_the_argument():
    with refused_input(subject="sensors", value="onyx-rgbw"):
        cn.analyze("onyx-rgbw", "onyx-rgbw")
    with refused_input(subject="sensors", value="onyx-rgbw"):
        cn.analyze("onyx-rgbw", cn.sensor_named("onyx-rgbw"))


# ---- results ----


@pytest.fixture(scope="module")
def results():
    study = cn.study_from_data(
        {
            "sensors": [{"name": "onyx-rgbw"}],
            "outputs": {"matrix": True},
            "sweeps": [{"vary": "lux", "first": 1.0, "last": 100.0, "points": 3}],
        }
    )
    ran = cn.run(study)
    return {
        "analyses": cn.analyze("onyx-rgbw"),
        "comparison": cn.compare("onyx-rgbw", vary="lux", first=1.0, last=100.0, points=3),
        "matrices": cn.matrix("onyx-rgbw"),
        "pictures": cn.render("builtin:checker", "onyx-rgbw"),
        "results": ran,
    }


STEPS = ["analyses", "comparison", "matrices", "pictures"]


@pytest.mark.parametrize("kind", [*STEPS, "results"])
def test_a_result_shows_its_operating_point_in_one_line_and_as_html(results, kind):
    text = repr(results[kind])
    assert OPERATING_POINT in text
    assert "\n" not in text
    assert len(text) < 160
    html = results[kind]._repr_html_()
    assert OPERATING_POINT in html
    assert html.count("<table") >= 1
    assert html.count("<div") == html.count("</div>")


@pytest.mark.parametrize("kind", STEPS)
def test_a_result_is_plain_data_table_and_latex(results, kind):
    result = results[kind]
    assert json.loads(json.dumps(result.to_dict(), allow_nan=False)) == result.to_dict()
    table = result.to_table()
    assert len(table.rows) >= 1
    latex = result.to_latex("tab:one")
    assert r"\label{tab:one}" in latex
    assert latex.count(r"\\") == 1 + len(table.rows)


@pytest.mark.parametrize("kind", STEPS)
def test_a_data_frame_holds_the_table_with_units_in_its_heads(results, kind):
    pytest.importorskip("pandas", reason="to_dataframe needs pandas")
    result = results[kind]
    frame, table = result.to_dataframe(), result.to_table()
    assert frame.shape == (len(table.rows), len(table.columns))
    for i, column in enumerate(table.columns):
        head = f"{column.name} [{column.unit}]" if column.unit else column.name
        assert frame.columns[i] == head
        assert frame.iloc[0, i] == table.rows[0][i]


def test_a_run_gives_what_each_function_gives(results):
    values = results["results"].to_list()
    analysis = cn.analyze("onyx-rgbw", budget=True).to_dict()
    matrix = results["matrices"].to_dict()
    assert values[1].pop("sentences")
    assert values == [analysis, {"sensors": [matrix]}, results["comparison"].to_dict()]


def test_a_run_of_a_file_is_by_the_names_of_its_steps_what_the_command_writes(tmp_path):
    file = tmp_path / "s.toml"
    file.write_text(
        '[[sensors]]\nname = "onyx-rgbw"\n[outputs]\nmatrix = true\n[[sweeps]]\nvary = "lux"\n'
        "first = 1\nlast = 9\npoints = 2\n"
        '[sweeps.second]\nvary = "f-number"\nfirst = 2\nlast = 4\npoints = 2\n'
        '[[sweeps]]\nvary = "lux"\nfirst = 1\nlast = 9\npoints = 2\n'
    )
    results = cn.run(file)
    written = run_study(cn.read_study(str(file)), tmp_path / "out")
    assert [path.stem for path in written] == list(results.steps)
    told = json.loads(json.dumps(results.to_dict()))
    assert told == {path.stem: json.loads(path.read_bytes())["result"] for path in written}
    assert results.to_list() == list(results.to_dict().values())


def test_a_run_of_a_missing_file_is_refused(tmp_path):
    with refused_input(subject=str(tmp_path / "none.toml")):
        cn.run(tmp_path / "none.toml")


def test_the_table_of_a_run_is_that_of_its_only_step_or_of_a_named_one(results):
    ran = results["results"]
    sweep, name = results["comparison"], "sweep-1-lux-snr-y"
    assert ran.to_table(name).rows == sweep.to_table().rows
    assert ran.to_latex("tab:one", name) == sweep.to_latex("tab:one")
    assert ran.plot(step=name).get_title() == sweep.plot().get_title()
    for made in (ran.to_table, ran.to_latex, ran.plot, ran.to_dataframe):
        with refused_input(subject="step", setting="step"):
            made()
    with refused_input(subject="step", value="sweep-2"):
        ran.to_table("sweep-2")
    alone = replace(ran, steps={name: ran.steps[name]})
    assert alone.to_table().rows == sweep.to_table().rows


def test_a_python_result_is_the_json_of_its_command(tmp_path):
    matrix = tmp_path / "m.json"
    words = ["--lux", "3", "--time-ms", "12"]
    commands.main(["matrix", "onyx-rgbw", *words, "--json", str(matrix)], standalone_mode=False)
    told = cn.matrix("onyx-rgbw", lux=3, time_ms=12).to_dict()
    assert told == json.loads(matrix.read_bytes())
    folder = tmp_path / "o"
    asked = ["simulate", "builtin:checker", "--sensor", "onyx-rgbw", *words, "-o", str(folder)]
    commands.main(asked, standalone_mode=False)
    told = json.loads((folder / "summary.json").read_bytes())
    own = cn.render("builtin:checker", "onyx-rgbw", lux=3, time_ms=12).to_dict()
    assert told.pop("study")["pictures"][0]["cube"] == "builtin:checker"
    for one in told["pictures"]:
        assert one.pop("seconds") > 0
        assert one["files"] == ["onyx-rgbw.png", "onyx-rgbw.xyz.tiff"]
        one["files"] = []  # in memory there is none
    assert own == told


def test_snr_by_name_is_that_of_the_plain_data(results):
    result = results["analyses"]
    (data,) = result.to_dict()["sensors"]
    channels = {one["name"]: one["snr_db"] for one in data["channels"]}
    assert result.raw_snr_db() == {"onyx-rgbw": channels}
    assert result.color_snr_db() == {"onyx-rgbw": data["color"]["snr_db"]}
    assert set(result.contravariant_snr_db()["onyx-rgbw"]) == set(channels)


def test_the_table_of_a_method_has_the_matrix_of_every_sensor():
    names = ("onyx-rgbw", "model-rgbir")
    study = cn.study_from_data(
        {
            "sensors": [{"name": name} for name in names],
            "outputs": {"analyses": False, "matrix": True},
            "matrices": ["lmmse"],
        }
    )
    (result,) = cn.run(study).matrices.values()
    table = result.to_table()
    heads = [column.name for column in table.columns]
    assert heads == ["sensor", "coordinate", "R", "G", "B", "W", "IR"]
    assert [row[:2] for row in table.rows] == [(name, axis) for name in names for axis in "XYZ"]
    made = [one.matrix for one in result.results]
    rgbw, rgbir = (dict(zip(one.channels, one.matrix.T, strict=True)) for one in made)
    for i, head in enumerate(heads[2:], 2):
        cells = [row[i] for row in table.rows]
        assert cells[:3] == (rgbw[head].tolist() if head in rgbw else [None] * 3)
        assert cells[3:] == (rgbir[head].tolist() if head in rgbir else [None] * 3)
    assert [note.partition(":")[0] for note in table.notes] == [n for n in names for _ in range(5)]
    latex = result.to_latex().replace("{-}", "-")
    assert latex.count(r"\\") == 1 + 6
    assert [latex.count(f"{name} & {axis} &") for name in names for axis in "XYZ"] == [1] * 6
    # of one sensor, without a column of names, as `chromanoise matrix --table` writes it
    (alone,) = cn.run(study.model_copy(update={"sensors": study.sensors[:1]})).matrices.values()
    single = alone.to_table()
    assert [column.name for column in single.columns] == ["coordinate", "R", "G", "B", "W"]
    assert [row[0] for row in single.rows] == ["X", "Y", "Z"]


def test_pictures_in_a_folder_are_not_drawn(tmp_path):
    pictures = cn.render("builtin:checker", "onyx-rgbw", folder=tmp_path)
    assert pictures.summaries
    with refused_input(subject="folder"):
        pictures.plot()


def test_a_white_preserving_matrix_gives_the_white_its_illuminance():
    one = cn.matrix("onyx-rgb-ircut", matrix="white-preserving", lux=7.0, time_ms=10.0)
    electrons = cn.noise.expected_electrons(
        cn.noise.white_scene(one.point), one.point.sensor, one.point.exposure
    )
    assert one.white_e.tolist() == electrons.tolist()
    assert one.white_lux == pytest.approx(7.0, rel=1e-4)  # the kernel matrix gives 7.095


def test_arguments_of_a_wrong_type_are_refused_in_a_sentence():
    script = """
import chromanoise as cn
for call in (
    lambda: cn.analyze(["onyx-rgbw", "onyx-rgb"]),
    lambda: cn.analyze(None),
    lambda: cn.analyze("onyx-rgbw", lux=[1, 2]),
    lambda: cn.run({}),
):
    try:
        call()
    except cn.InputError as error:
        print(error.subject, error.value)
"""
    done = subprocess.run(  # without the type checks of the tests
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    subjects = ["sensors ['onyx-rgbw', 'onyx-rgb']", "sensors None", "lux [1, 2]", "study dict"]
    assert done.stdout.splitlines() == subjects
