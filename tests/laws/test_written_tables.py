"""Sensors, spectra and tables as text: other readers find in it what was written."""

import csv
import io
import json
import re
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import colour
import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.apps.paper import paper_study
from chromanoise.base.errors import InputError
from chromanoise.base.files import csv_comment, text_of_cell, text_of_comment
from chromanoise.color import kernel_matrix
from chromanoise.io import read_sensor_csv
from chromanoise.io.matrix_files import MadeMatrix, matrix_csv, read_matrix
from chromanoise.io.result_tables import (
    Column,
    Table,
    table_csv,
    table_from_json,
    table_json,
    table_latex,
    table_markdown,
    written,
)
from chromanoise.io.sensor_files import sensor_from_json, sensor_json, spectra_json
from chromanoise.io.spectra import read_curves
from chromanoise.io.spectra.writing import (
    sensor_csv,
    sensor_rawtoaces_json,
    sensor_spectra,
    spectra_csv,
    spectra_spdx,
)
from chromanoise.noise import Exposure
from chromanoise.sensor import Mosaic, Pixel, Sensor
from chromanoise.spectra import DEFAULT_GRID, Grid, Spectra, read_spectra_csv
from chromanoise.study import compared, sensor_named
from chromanoise.study.results import analyses_as_table, curves_as_table
from outcomes import refused_input
from strategies import point_of, white_channel

SMALL = Grid.uniform(400, 420, 10)
PIXEL = Pixel(pitch_um=2.2, full_well_e=6000.1, read_noise_e=0.1 + 0.2)
WORDS = st.text(
    st.characters(exclude_categories=["Cs", "Cc", "Zs", "Zl", "Zp"]), min_size=1, max_size=8
)
ANY_TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
NUMBERS = st.floats(-1e30, 1e30, allow_nan=False)


@st.composite
def any_sensor(draw):
    names = draw(st.lists(WORDS, min_size=1, max_size=4, unique=True))
    values = st.lists(st.floats(0.0, 1.0), min_size=3 * len(names), max_size=3 * len(names))
    notes = draw(st.lists(ANY_TEXT, max_size=2))
    return Sensor(
        name=draw(WORDS),
        grid=SMALL,
        qe=np.array(draw(values)).reshape(3, len(names)),
        names=tuple(names),
        pixel=PIXEL,
        mosaic=draw(st.sampled_from([None, Mosaic(((names[0], names[-1]),))])),
        origin=draw(st.sampled_from(["given", "measured", "model", "reconstruction"])),
        notes=tuple(notes),
    )


@st.composite
def any_spectra(draw):
    names = draw(st.lists(WORDS, min_size=1, max_size=3, unique=True))
    steps = draw(st.lists(st.floats(1e-3, 100.0), min_size=2, max_size=5))
    at = 380.0 + np.cumsum(steps)
    count = at.size * len(names)
    values = draw(st.lists(NUMBERS, min_size=count, max_size=count))
    return Spectra(
        wavelength_nm=at,
        values=np.array(values).reshape(at.size, len(names)),
        names=tuple(names),
        quantity=draw(WORDS),
        unit=draw(WORDS),
        source=draw(WORDS),
        notes=tuple(draw(st.lists(ANY_TEXT, max_size=2))),
    )


def rgb(qe, grid=SMALL, names=("R", "G", "B"), notes=()):
    return Sensor(
        name="a camera", grid=grid, qe=np.asarray(qe), names=names, pixel=PIXEL, notes=notes
    )


def a_matrix(channels, notes):
    return MadeMatrix(
        sensor="=a camera", illuminant="E", level_lux=10.0, time_s=0.01, f_number=1.8,
        pitch_um=2.2, white_e=np.ones(3), white_lux=10.0, notes=notes,
        matrix=replace(
            kernel_matrix(sensor_named("onyx-rgb", DEFAULT_GRID), Exposure(time_s=0.01)),
            channels=channels,
        ),
    )  # fmt: skip


# sensors and spectra


@given(sensor=any_sensor())
def test_a_sensor_written_as_csv_is_read_back_to_the_last_digit(tmp_path_factory, sensor):
    path = tmp_path_factory.mktemp("sensor") / "s.csv"
    path.write_text(sensor_csv(sensor), encoding="utf-8")
    read = read_sensor_csv(path, SMALL, PIXEL)
    assert read.names == sensor.names
    assert np.array_equal(read.qe, sensor.qe)


@given(spectra=any_spectra())
def test_spectra_written_as_csv_are_read_back_to_the_last_digit(tmp_path_factory, spectra):
    path = tmp_path_factory.mktemp("spectra") / "s.csv"
    path.write_text(spectra_csv(spectra), encoding="utf-8")
    read = read_spectra_csv(path, quantity=spectra.quantity, unit=spectra.unit)
    assert read.names == spectra.names
    assert np.array_equal(read.wavelength_nm, spectra.wavelength_nm)
    assert np.array_equal(read.values, spectra.values)


@given(sensor=any_sensor())
def test_a_sensor_written_as_json_is_read_back_whole(sensor):
    read = sensor_from_json(sensor_json(sensor))
    for field in ("name", "grid", "names", "pixel", "mosaic", "stacked", "origin", "notes"):
        assert getattr(read, field) == getattr(sensor, field), field
    assert np.array_equal(read.qe, sensor.qe)


@given(spectra=any_spectra())
def test_spectra_written_as_json_are_read_back_whole(tmp_path_factory, spectra):
    path = tmp_path_factory.mktemp("spectra") / "s.json"
    path.write_text(spectra_json(spectra), encoding="utf-8")
    read = read_curves(path)
    assert (read.curves.names, read.said_source) == (spectra.names, spectra.source)
    assert read.said_notes == spectra.notes
    assert np.array_equal(read.curves.wavelength_nm, spectra.wavelength_nm)
    assert np.array_equal(read.curves.values, spectra.values)


def test_a_name_that_readers_by_lines_would_change_is_refused():
    with refused_input(subject="a camera", value=" R"):
        sensor_csv(rgb(np.full((3, 1), 0.5), names=(" R",)))


def test_a_plain_csv_reader_finds_head_and_rows_below_the_comments():
    text = sensor_csv(rgb([[0.1, 0.2, 0.3]] * 3))
    rows = [row for row in csv.reader(io.StringIO(text)) if not row[0].startswith("#")]
    assert rows[0] == ["wavelength_nm", "R", "G", "B"]
    assert rows[1] == ["400.0", "0.1", "0.2", "0.3"]
    assert len(rows) == 4


@pytest.mark.parametrize(
    ("change", "fields"),
    [
        ({"schema": "another"}, {"where": "key 'schema'", "value": "another"}),
        ({"schema_version": 2}, {"where": "key 'schema_version'", "value": 2}),
        ({"qe": [[0.1], [0.2, 0.3], [0.1]]}, {}),
        ({"qe": "much"}, {}),
        ({"qe": [[True, 0.1, 0.1]] * 3}, {"requirement": "True"}),
        ({"qe": [[10**400, 0.1, 0.1]] * 3}, {}),
        ({"qe": [[2.0, 0.1, 0.1]] * 3}, {"value": 2.0}),
        ({"channels": ["R", "G", 3]}, {"requirement": "3"}),
        ({"pixel": {"pitch_um": 1.0}}, {"requirement": "'full_well_e'"}),
        ({"stacked": 1}, {"requirement": "1"}),
        ({"origin": "heard"}, {"where": "origin of curves", "value": "heard"}),
        (
            {"grid_nm": {"start": 1, "stop": 1e12, "step": 1e-3}},
            {"where": "key 'grid_nm'", "value": 999_999_999_999_001},
        ),
        ({"mosaic": [["X"]]}, {}),
    ],
)
def test_json_that_is_no_sensor_is_refused_in_one_sentence(change, fields):
    held = json.loads(sensor_json(rgb(np.full((3, 3), 0.5)))) | change
    with refused_input(**fields) as refused:
        sensor_from_json(json.dumps(held), source="cam.json")
    assert "cam.json" in str(refused.value)


def test_text_that_is_no_json_is_refused():
    for text in ("", "{", "[" * 100_000, "[]"):
        with refused_input(subject="sensor"):
            sensor_from_json(text)
        with refused_input(subject="table"):
            table_from_json(text)


# rawtoaces


def test_a_rawtoaces_camera_answers_to_power_as_the_sensor_to_photons():
    # a joule of 800 nm has twice the photons of one of 400 nm: QE .4 at 400 is worth .2 at 800
    grid = Grid.uniform(400, 800, 200)
    sensor = rgb([[0.4, 0.1, 0.0], [0.0, 0.4, 0.0], [0.2, 0.0, 0.4]], grid)
    record = json.loads(sensor_rawtoaces_json(sensor, created="2026-01-31T12:00:00Z"))
    data = record["spectral_data"]["data"]["main"]
    assert list(data) == ["400", "600", "800"]
    assert data["400"][0] == data["800"][0] == pytest.approx(0.5, rel=1e-15)
    assert data["800"][2] == 1.0
    assert data["600"][1] == pytest.approx(0.75, rel=1e-15)
    assert record["spectral_data"]["index"]["main"] == ["R", "G", "B"]
    assert record["spectral_data"]["units"] == "relative"
    # rawtoaces-data, schema 1.0.0: required keys of the header
    needed = ("description", "document_creation_date", "document_creator", "license")
    assert all(isinstance(record["header"][key], str) for key in needed)


def test_a_camera_without_red_green_or_blue_is_no_rawtoaces_camera():
    with refused_input(subject="a camera", value=("R", "G", "W")):
        sensor_rawtoaces_json(rgb(np.full((3, 3), 0.5), names=("R", "G", "W")), created="")
    with refused_input(subject="a camera", value=0.0):
        sensor_rawtoaces_json(rgb(np.zeros((3, 3))), created="")
    half = Grid.uniform(400, 401, 0.5)
    with refused_input(subject="a camera", value=400.5):
        sensor_rawtoaces_json(rgb(np.full((3, 3), 0.5), half), created="")


# IES TM-27


@pytest.mark.parametrize("quantity", ["reflectance", "Irradiance", "QE"])
def test_colour_science_reads_our_tm_27_to_the_last_digit(file, quantity):
    at = np.array([400.0, 405.5, 412.25])
    spectra = Spectra(
        wavelength_nm=at,
        values=np.array([[0.1], [1 / 3], [1e-9]]),
        names=('leaf <&> "wet"',),
        quantity=quantity,
        unit="1",
        source="a field",
        notes=("held beyond 412 nm",),
    )
    path = file(spectra_spdx(spectra, spectra.names[0], created="2026-01-31"), "leaf.spdx")
    read = colour.SpectralDistribution_IESTM2714(str(path)).read()
    assert read.wavelengths.tolist() == at.tolist()
    assert read.values.tolist() == spectra.values[:, 0].tolist()
    assert read.spectral_quantity == {"QE": "other"}.get(quantity, quantity.lower())
    assert read.header.description == 'leaf <&> "wet"'
    assert read.header.document_creation_date == "2026-01-31"
    assert read.header.comments == f"{quantity} [1]; source: a field; held beyond 412 nm"


@given(spectra=any_spectra())
def test_tm_27_is_xml_whatever_the_names(spectra):
    try:
        text = spectra_spdx(spectra, spectra.names[0], created="2026-01-31")
    except InputError as error:
        assert error.value in error.subject or len(error.subject) >= 40  # noqa: PT017
        return
    data = ElementTree.fromstring(text).findall(".//{http://www.ies.org/iestm2714}SpectralData")
    assert [float(d.attrib["wavelength"]) for d in data] == spectra.wavelength_nm.tolist()
    assert [float(d.text) for d in data] == spectra.values[:, 0].tolist()


def test_a_curve_that_is_not_there_is_refused():
    with refused_input(subject="a camera", value=("R", "G", "B"), requirement="'W'"):
        spectra_spdx(sensor_spectra(rgb(np.full((3, 3), 0.5))), "W", created="")


# tables

TABLE = Table(
    title="SNR & 100 % of_it",
    columns=(
        Column(name="sensor"),
        Column(name="SNR", unit="dB", digits=".1f"),
        Column(name="gain|loss", digits=".3g"),
    ),
    rows=(
        ("RGB_1", 26.1234, -0.5),
        ("=HYPERLINK(1)", None, 12345.0),
        ('a|b, "c"\\d', -0.04, 3),
    ),
    notes=("x < y & z_1",),
)


def test_numbers_have_the_digits_of_their_column_and_zero_no_sign():
    cells = [(26.1234, ".1f"), (-0.04, ".1f"), (12345.0, ".3g"), (None, ".1f"), (True, ""), (3, "")]
    assert [written(*cell) for cell in cells] == ["26.1", "0.0", "1.23e+04", "", "True", "3"]


def test_a_spreadsheet_finds_words_where_a_formula_was():
    rows = list(csv.reader(io.StringIO(table_csv(TABLE))))
    assert rows == [
        ["sensor", "SNR [dB]", "gain|loss"],
        ["RGB_1", "26.1234", "-0.5"],
        ["'=HYPERLINK(1)", "", "12345.0"],
        ['a|b, "c"\\d', "-0.04", "3"],
    ]


@given(value=NUMBERS, digits=st.sampled_from(["", ".1f", ".3g"]))
def test_a_csv_and_json_give_numbers_back_exactly(value, digits):
    column = Column(name="x", unit="nm", digits=digits)
    table = Table(title="t", columns=(column,), rows=((value,), (np.float64(value),)))
    head, *rows = csv.reader(io.StringIO(table_csv(table)))
    assert head == ["x [nm]"]
    assert [float(cell) for (cell,) in rows] == [value, value]
    assert table_from_json(table_json(table)) == table


FORMULAS = ["=1+1", "+A", "-3.2", "@SUM(A1)", "'=x", "''-1", "=1 [%]", "'tis", "＝1", "- a"]


@pytest.mark.parametrize("name", FORMULAS)
def test_a_name_like_a_formula_is_guarded_in_every_csv_and_read_back(file, tmp_path, name):
    notes = (f"a,{name}", name, f"b;  {name}; 'c, 5 %")
    sensor = rgb([[0.1, 0.2, 0.3]] * 3, names=(name, "G", f"{name} b"), notes=notes)
    sensors = file(sensor_csv(sensor), "s.csv")
    matrices = tmp_path / "m.csv"
    made = a_matrix((name, "G", f"{name} b"), notes=notes)
    matrices.write_text(matrix_csv(made), encoding="utf-8")
    for path, first in ((sensors, "wavelength_nm"), (matrices, "lx/e-")):
        for separator in ",;\t":
            for line in path.read_text("utf-8").splitlines():
                for cell in next(csv.reader([line], delimiter=separator)):
                    number = re.fullmatch(r"-?[0-9.]+(e-?[0-9]+)?", cell)
                    assert number or cell.lstrip()[:1] not in (*"=+-@＝", "\t"), line
        assert f"{first}," in path.read_text("utf-8")
    assert read_sensor_csv(sensors, SMALL, PIXEL).names == sensor.names
    curves = read_curves(sensors).curves
    assert curves.names == sensor.names
    assert read_matrix(matrices).channels == made.matrix.channels


@given(text=ANY_TEXT)
def test_every_comment_of_a_csv_is_read_back(text):
    value = csv_comment("notes", text).removeprefix("# notes: ").removesuffix("\n")
    assert text_of_comment(value) == " ".join(text.split())


@given(text=ANY_TEXT)
def test_no_word_of_a_csv_starts_as_a_formula(text):
    table = Table(title="t", columns=(Column(name="word"), Column(name="x")), rows=((text, 1),))
    cell = list(csv.reader(io.StringIO(table_csv(table), newline="")))[1][0]
    assert not cell.lstrip().startswith(("=", "+", "-", "@"))
    assert not cell.startswith(("\t", "\r"))
    plain = re.sub("\r\n?", "\n", text)
    assert cell in (plain, "'" + plain)
    assert text_of_cell(cell) == plain


@st.composite
def any_table(draw):
    names = draw(st.lists(WORDS, min_size=1, max_size=3, unique=True))
    cell = st.one_of(NUMBERS, st.integers(), ANY_TEXT, st.booleans(), st.none())
    row = st.tuples(*[cell for _ in names])
    return Table(
        title=draw(ANY_TEXT),
        columns=tuple(
            Column(name=n, unit=draw(ANY_TEXT), digits=draw(st.sampled_from(["", ".3g", ".2f"])))
            for n in names
        ),
        rows=tuple(draw(st.lists(row, max_size=4))),
        notes=tuple(draw(st.lists(ANY_TEXT, max_size=2))),
    )


@given(table=any_table())
def test_a_table_written_as_json_is_read_back_whole(table):
    assert table_from_json(table_json(table)) == table


def markdown_cells(line):
    """Cells of a row of GitHub-flavored Markdown: split at bars without a backslash before."""
    inner = line.removeprefix("| ").removesuffix(" |")
    cells = re.split(r" (?<!\\)\| ", inner)
    return [re.sub(r"\\([^a-zA-Z0-9\s])", r"\1", cell) for cell in cells]


@given(table=any_table())
def test_a_table_in_markdown_has_its_cells_and_no_more(table):
    lines = table_markdown(table).splitlines()
    rows = [line for line in lines if line.startswith("| ") and line.endswith(" |")]
    assert len(rows) == len(table.rows) + 2
    for line, row in zip(rows[2:], table.rows, strict=True):
        cells = markdown_cells(line)
        own = [
            " ".join(written(cell, c.digits).split())
            for cell, c in zip(row, table.columns, strict=True)
        ]
        assert cells == own


def test_markdown_escapes_what_it_would_read_as_its_own():
    lines = table_markdown(TABLE).splitlines()
    assert lines[0] == r"**SNR \& 100 % of\_it**"
    assert lines[2] == r"| sensor | SNR \[dB\] | gain\|loss |"
    assert lines[3] == "| --- | ---: | ---: |"
    assert lines[6] == r'| a\|b, "c"\\d | 0.0 | 3 |'
    assert lines[-1] == r"* x \< y \& z\_1"


def test_latex_escapes_its_specials_and_sets_numbers_to_the_right():
    text = table_latex(TABLE)
    assert r"\caption{SNR \& 100 \% of\_it}" in text
    assert text.split(r"\caption")[1].splitlines()[1:5] == [
        r"\begin{tabular}{lrr}",
        r"\toprule",
        r"sensor & SNR {[}dB{]} & gain\textbar{}loss \\",
        r"\midrule",
    ]
    assert r"RGB\_1 & 26.1 & $-0.5$ \\" in text
    assert "\\textbackslash{}d & 0.0 & 3 \\\\\n\\bottomrule\n" in text
    assert r"\label" not in text


def test_latex_has_the_label_that_is_given_and_no_other_command_by_it():
    assert "}\n\\label{tab:snr_1}\n\\begin{tabular}" in table_latex(TABLE, label="tab:snr_1")
    for label in ("a}b", "a b", "\\input", "50%"):
        with refused_input(subject="label", value=label):
            table_latex(TABLE, label=label)


@given(text=ANY_TEXT)
def test_no_word_reaches_latex_as_a_command(text):
    table = Table(title=text, columns=(Column(name="word"),), rows=((text,),))
    body = table_latex(table).split("\\midrule\n")[1].split(" \\\\\n\\bottomrule")[0]
    known = r"\\text[a-z]+\{\}|\\[{}$&#%_]|\{[\[\]*-]\}|\$[^$]*\$"
    plain = re.sub(known, "", body)
    assert not re.search(r"[\\{}$&#%_^~\[\]*]", plain)


def test_latex_itself_sets_the_table(tmp_path):
    program = shutil.which("pdflatex") or shutil.which("latex")
    if program is None:
        pytest.skip("needs pdflatex")
    page = "\\documentclass{article}\\usepackage{booktabs}\\begin{document}"
    (tmp_path / "t.tex").write_text(f"{page}\n{table_latex(TABLE)}\\end{{document}}\n", "utf-8")
    done = subprocess.run(
        [program, "-interaction=nonstopmode", "-halt-on-error", "t.tex"],
        cwd=tmp_path,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:]


def test_a_table_that_contradicts_itself_is_refused():
    columns = (Column(name="a"), Column(name="b"))
    with refused_input(subject="table 't'", where="row 1 (from 0)", value=1):
        Table(title="t", columns=columns, rows=((1, 2), (1,)))
    with refused_input(subject="table 't'", where="column 'b' in row 0 (from 0)"):
        Table(title="t", columns=columns, rows=((1, float("nan")),))
    with refused_input(subject="columns of table 't'", value="a"):
        Table(title="t", columns=(*columns, Column(name="a")), rows=())
    with refused_input(subject="Column.name", value=" "):
        Column(name=" ")
    with refused_input(subject="Column.digits", value="two"):
        Column(name="a", digits="two")


@pytest.mark.parametrize(
    "change",
    [{"rows": [[{}]]}, {"columns": 3}, {"title": 3}, {"schema_version": 9}, {"notes": None}],
)
def test_json_that_is_no_table_is_refused(change):
    held = json.loads(table_json(TABLE)) | change
    with pytest.raises(InputError):
        table_from_json(json.dumps(held))


# results as tables


def test_our_own_readers_find_in_rawtoaces_and_tm_27_the_curves_of_the_sensor(file):
    sensor = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    path = file(spectra_spdx(sensor_spectra(sensor), "G", created="2026-01-31"), "green.spdx")
    assert np.array_equal(read_curves(path).curves.values[:, 0], sensor.qe[:, 1])
    path = file(sensor_rawtoaces_json(sensor, created="2026-01-31T12:00:00Z"), "camera.json")
    read = read_curves(path).curves
    assert read.names == ("R", "G", "B")
    assert read.values.max() == 1.0
    per_photon = read.values / read.wavelength_nm[:, None]
    scale = per_photon[:, 1].max() / sensor.qe[:, 1].max()
    assert per_photon == pytest.approx(scale * sensor.qe, rel=1e-12)


@pytest.fixture(scope="module")
def study():
    return paper_study()


def test_analyses_are_rows_with_the_snr_of_the_paper_and_their_warning(study):
    table = analyses_as_table(list(study.columns.values()))
    heads = [column.name for column in table.columns]
    snr = [row[heads.index("SNR Y")] for row in table.rows]
    assert snr == pytest.approx([26.1, 32.4, 39.4], abs=0.26)
    loss = [row[heads.index("color SNR loss")] for row in table.rows]
    # its Tables 2 and 3: 10 log10 of the sum of 10^(SNR/10), less SNR_Y
    assert loss == pytest.approx([17.9, 5.0, 5.2], abs=0.3)
    assert any("reconstruction" in note for note in table.notes)


def test_a_comparison_has_a_row_per_light_and_nothing_where_nothing_is_defined():
    # one channel of 0.5 QE: 10 e- of readout, and saturated at the brightest light
    used = point_of(white_channel(grid=DEFAULT_GRID), 1.0)
    makers = {"kernel": lambda s: kernel_matrix(s.sensor, s.exposure, "quanta")}
    curves = compared([used], makers, np.array([1.0, 2.0, 1e4]))
    rows = list(csv.reader(io.StringIO(table_csv(curves_as_table(curves)))))
    assert rows[0][0].endswith("[lx]")
    assert [row[0] for row in rows[1:]] == ["1.0", "2.0", "10000.0"]
    assert rows[3][1] == ""
    # docs/numbers.md: 32,555 photons per lx, s, um2; M = 32,555 x 0.5 x 100 x 0.01 / (4 x 1.8^2)
    mean = 32_555 * 0.5 * 100 * 0.01 / (4 * 1.8**2)
    snr_db = 20 * np.log10(mean / np.sqrt(mean + 100))
    assert float(rows[1][1]) == pytest.approx(snr_db, abs=0.05)  # the grid of 5 nm has 0.6 % more
