"""Files of spectra: all formats give the same curves, what is unclear is asked, nothing breaks."""

import re
import time
import zipfile
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.io import savemat

import chromanoise as cn
from chromanoise.base.errors import Setting
from chromanoise.io import read_sensor
from chromanoise.io.spectra import Answers, power_of, qe_of, read_curves
from chromanoise.io.spectra.writing import spectra_csv, spectra_spdx
from chromanoise.sensor import PAPER_PIXEL
from chromanoise.spectra import DEFAULT_GRID, Grid, Spectra
from outcomes import refusal_of, refused_input
from spectrum_samples import AT_NM, GREEN, RED, SAMPLES, rawtoaces_text, tm27_text

SHARED = next(
    (
        p
        for p in (
            Path(__file__).parents[2] / "shared/data",
            Path(__file__).parents[3] / "shared/data",
        )
        if p.is_dir()
    ),
    None,
)
real_files = pytest.mark.skipif(SHARED is None, reason="needs the real files of shared/data")
GRID = Grid.uniform(400, 700, 100)


refusal = partial(refusal_of, read_curves)


def abouts(result):
    return {question.about for question in result.questions}


@pytest.mark.parametrize("name", SAMPLES)
def test_the_same_curves_come_out_of_every_format_to_the_last_digit(file, name):
    result = read_curves(file(SAMPLES[name], name))
    expected = np.stack([RED, GREEN], axis=1)[:, : len(result.curves.names)]
    assert (result.curves.wavelength_nm == AT_NM).all()
    # percent and SPECTRAL_NORM cost one rounding
    np.testing.assert_allclose(result.curves.values, expected, rtol=3e-16)
    assert result.curves.names == ("R", "G")[: expected.shape[1]]
    assert result.step_nm == 100


def test_each_format_says_what_it_knows(file):
    known = {name: read_curves(file(SAMPLES[name], name)) for name in SAMPLES}
    assert known["bench.csv"].delimiter == "comma"
    german = known["german.csv"]
    assert (german.delimiter, german.decimal, german.wavelength_unit) == ("semicolon", ",", "um")
    assert (german.scale, german.factor) == ("percent", 0.01)
    assert known["digitized.csv"].merged == 1
    assert known["packed.mat"].per == "photon"
    assert known["camera.json"].level == "relative"
    assert known["camera.json"].per == "energy"
    assert known["argyll.sp"].quantity == "transmittance"
    assert known["lamp.spdx"].quantity == "transmittance"
    assert known["book.xlsx"].quantity is None  # its title is free text


@pytest.mark.parametrize(
    ("text", "delimiter"),
    [
        ("nm;A\n400;0,1\n410;0,2", "semicolon"),
        ("nm\tA\n400\t0.1\n410\t0.2", "tab"),
        ("nm A\n400   0,1\n410   0,2", "blanks"),
        ("400, .1\r\n410, .2", "comma"),
        ("// from a bench\n% nm, QE\n400 1E-1\n410 2e-1", "blanks"),
        ('"nm","A"\n"400","0.1"\n"410","0.2"', "comma"),
        ("a title,,\nnm,A,\n400,0.1,\n410,0.2,\n,,", "comma"),
        ("nm,A\n410,20 %\n400,10 %", "comma"),
        ("um;A\n0,40;0,1\n0,41;0,2", "semicolon"),
        ("nm,A\r400,0.1\r410,0.2\r", "comma"),
    ],
)
def test_text_is_read_however_its_cells_are_parted(file, text, delimiter):
    message = read_curves(file(text))
    assert message.delimiter == delimiter
    assert message.curves.wavelength_nm.tolist() == [400.0, 410.0]
    np.testing.assert_allclose(message.curves.values[:, 0], [0.1, 0.2], rtol=1e-15)


def test_a_file_of_two_byte_characters_is_read_by_its_mark(file):
    result = read_curves(file("nm\tA\n400\t0.1\n410\t0.2".encode("utf-16")))
    assert result.curves.values.ravel().tolist() == [0.1, 0.2]


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("", {"value": 0}),
        ("nm,A\n400,0.1\n410,high\n", {"where": "line 3, column 'A'", "value": "high"}),
        ("nm,A\n400,0.1\n410,inf\n", {"where": "line 3, column 'A'", "value": "inf"}),
        ("nm,A\n400,0.1\n410,1e999\n", {"where": "line 3, column 'A'", "value": "1e999"}),
        ("nm,A\n400,0.1\nthe end\n410,0.2\n", {"where": "line 3, column 'nm'", "value": "the end"}),
        ("nm,A\n400,0.1\n,0.2\n", {"where": "line 3"}),
        ("nm;A\n400;0,1\n410;0.2\n", {"value": (2, 3)}),
        ("nm,A,A\n400,1,2\n410,1,2\n", {"value": "A"}),
        ('nm,A\n400,"0.1\n410,0.2\n', {"where": "line 2"}),
        ("nm,A\n400,0,1,0\n410,0,2,0\n", {"where": "line 2", "value": 4}),
        ("x,A\n30,0.1\n40,0.2\n", {"value": "30-40", "setting": "wavelength_unit"}),
        ("wavelength_nm,A\n0.4,0.1\n0.5,0.2\n", {"value": "nm", "setting": "wavelength_unit"}),
        ("x,A\n-400,0.1\n410,0.2\n", {"where": "line 2", "value": -400.0}),
        ("nm,A\n400,0.1\n400,0.2\n", {"where": "curve 'A'", "value": 1}),
        ("{", {"where": "line 1, column 2"}),
        ('{"a": 1}', {"requirement": "'spectral_data'"}),
        ("<a>\n</b>", {"where": "line 2, column 3"}),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", {"requirement": "document type"}),
        ("<a/>", {"value": "a"}),
        ("nm,A\n400,\0\n", {"where": "line 2"}),
        ("[" * 100_000, {"where": "line 1", "value": 100_000}),
        ('{"a":' * 100_000, {"requirement": "nested"}),
    ],
)
def test_what_cannot_be_understood_is_refused_with_its_line(file, text, fields):
    path = file(text)
    with refused_input(subject=str(path), **fields):
        read_curves(path)


def test_the_unit_that_fits_the_numbers_is_the_first_remedy(file):
    (remedy,) = refusal(file("wavelength_nm,A\n0.4,0.1\n0.5,0.2\n")).remedy
    assert remedy == Setting("wavelength_unit", ("um", "nm"))


def test_decimal_commas_between_commas_are_said_to_be_ragged_or_refused(file):
    error = refusal(file("nm,A\n400,0,1\n410,0,2,5\n420,0,3\n"))
    assert (error.where, error.value) == ("line 2", 3)
    assert "semicolons" in error.remedy[0]


def test_a_missing_file_a_folder_and_a_large_file_are_refused(tmp_path, file):
    refusal(tmp_path / "none.csv")
    refusal(tmp_path)
    assert refusal(file(b"1" * (4 * 2**20 + 1))).value == 4 * 2**20 + 1
    assert "-v7" in refusal(file(b"\x89HDF\r\n\x1a\n" + bytes(200))).remedy[0]
    assert "UTF-8" in refusal(file(bytes(range(256)))).requirement


def test_a_workbook_that_unpacks_to_too_much_or_declares_entities_is_refused(tmp_path):
    bomb = tmp_path / "bomb.xlsx"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("xl/workbook.xml", b" " * (17 * 2**20))
    assert refusal(bomb).value == 17 * 2**20
    laughs = tmp_path / "laughs.xlsx"
    with zipfile.ZipFile(laughs, "w") as archive:
        archive.writestr("xl/workbook.xml", '<!DOCTYPE a [<!ENTITY b "ha">]><a>&b;</a>')
    assert refusal(laughs).where == "part 'xl/workbook.xml'"


def test_percent_is_understood_and_said_and_between_one_and_one_and_a_half_asked(file):
    percent = read_curves(file("nm,QE\n400,10\n410,45\n"))
    assert percent.curves.values.ravel().tolist() == [0.1, 0.45]
    assert any("percent" in note for note in percent.notes)
    low = read_curves(file("nm,QE\n400,0.5\n410,1.6\n"))  # an infrared end
    assert low.curves.values.ravel() == pytest.approx([0.005, 0.016])
    unclear = read_curves(file("nm,QE\n400,0.1\n410,1.2\n"))
    assert "scale" in abouts(unclear)
    assert unclear.curves.values.max() == 1.2
    result = read_curves(file("nm,QE\n400,0.1\n410,1.2\n"), answers=Answers(scale="percent"))
    assert result.curves.values.ravel() == pytest.approx([0.001, 0.012])
    assert "scale" not in abouts(result)


def test_power_is_never_taken_for_percent(file):
    result = read_curves(file("nm,power\n400,10\n410,45\n"))
    assert result.curves.values.ravel().tolist() == [10.0, 45.0]
    assert result.scale == "as written"


def test_ragged_rows_and_empty_cells_are_said_and_bridged(file):
    result = read_curves(file("nm,A,B\n400,1e-1,0.1\n410,0.2\n420,0.3,0.5\n430,,0.1\n"))
    assert any("ragged rows: line 3" in defect for defect in result.defects)
    # A ends at 420 and B has no value at 410: the mean of its neighbors
    assert result.curves.wavelength_nm.tolist() == [400, 410, 420]
    assert result.curves.values[1, 1] == pytest.approx(0.3)
    assert any("cut to what they share" in note for note in result.notes)


@pytest.mark.parametrize(("beyond", "end"), [("zero", 0.0), ("hold", 0.3)])
def test_a_curve_that_ends_before_the_others_goes_on_as_asked(file, beyond, end):
    path = file("A,,B,\nX,Y,X,Y\n400,0.1,400,0.2\n500,0.3,600,0.4\n")
    result = read_curves(path, answers=Answers(beyond=beyond))
    assert result.curves.wavelength_nm.tolist() == [400, 500, 600]
    assert result.curves.values[-1].tolist() == [end, 0.4]


def test_points_that_disagree_are_merged_and_said(file):
    result = read_curves(file("nm,A\n400,0.1\n420,0.5\n410,0.2\n410,0.4\n"))
    assert result.curves.values.ravel() == pytest.approx([0.1, 0.3, 0.5])
    assert result.merged == 1
    assert any("different values" in d and "410 nm" in d for d in result.defects)
    assert any("sorted" in note for note in result.notes)


def test_gaps_and_irregular_steps_are_told(file):
    result = read_curves(file("nm,A\n400,0.1\n410,0.2\n420,0.3\n430,0.3\n500,0.1\n"))
    assert result.gaps_nm == ((430.0, 500.0),)
    assert result.step_nm is None


def test_a_column_of_deviations_is_no_curve(file):
    result = read_curves(
        file("#Wavelength in nm, Reflectance, Standard Deviation\n400 .1 .01\n410 .2 .02")
    )
    assert result.curves.names == ("Reflectance",)
    assert result.deviations is not None
    assert result.deviations.values.ravel().tolist() == [0.01, 0.02]


def test_columns_without_names_are_curves_with_a_note(file):
    result = read_curves(file("400 0.1 0.01\n410 0.2 0.02"))
    assert result.curves.names == ("column 2", "column 3")
    assert any("no names" in note for note in result.notes)
    one = read_curves(file("400 0.1 0.01\n410 0.2 0.02"), answers=Answers(columns=("column 2",)))
    assert one.curves.names == ("column 2",)
    assert not any("no names" in note for note in one.notes)
    error = refusal(file("400 0.1 0.01\n410 0.2 0.02"), answers=Answers(columns=("G",)))
    assert error.value == ("column 2", "column 3")
    assert error.remedy == (Setting("columns"),)


def test_each_answer_removes_its_question(file):
    path = file("nm,A\n400,0.1\n410,1.0\n")
    assert abouts(read_curves(path)) == {"quantity", "peak_qe", "per", "beyond"}
    answers = Answers(
        quantity="response", level="relative", per="energy", beyond="zero", peak_qe=0.5
    )
    assert abouts(read_curves(path, answers=answers)) == set()


@given(
    st.lists(
        st.tuples(st.integers(2000, 40000), st.floats(0, 1)),
        min_size=2,
        max_size=40,
        unique_by=lambda point: point[0],
    ),
    st.sampled_from([",", ";", "\t", " "]),
    st.booleans(),
)
def test_a_curve_survives_the_way_through_any_text_in_any_order(tmp_path_factory, points, sign, um):
    scale = 1e4 if um else 10
    rows = [f"{w / scale!r}{sign}{v!r}" for w, v in points]
    path = tmp_path_factory.mktemp("text") / "curve.txt"
    path.write_text("\n".join([f"{'um' if um else 'nm'}{sign}QE", *rows]))
    result = read_curves(path, answers=Answers(scale="fraction"))
    points = sorted(points)
    np.testing.assert_allclose(result.curves.wavelength_nm, [w / 10 for w, _ in points], rtol=1e-12)
    assert result.curves.values.ravel().tolist() == [v for _, v in points]


def test_a_response_per_watt_becomes_quantum_efficiency(file):
    # a perfect photodiode: 0.6452 A/W at 800 nm, e lambda / (h c) (Sze, Physics of Semiconductor
    # Devices, 3rd ed., 13.2: R = lambda[um] / 1.24)
    path = file("nm,Responsivity (A/W)\n400,0.3226\n800,0.6452\n")
    answers = Answers(per="energy", level="absolute")
    curves = qe_of(read_curves(path, answers=answers), answers)
    np.testing.assert_allclose(curves.values.ravel(), [1.0, 1.0], rtol=2e-4)


def test_a_white_channel_is_not_taken_for_watts(file):
    path = file("nm,R,W\n400,0.1,0.2\n800,0.1,0.2\n")
    assert read_curves(path, answers=Answers(quantity="response")).per is None


def test_photons_of_a_lamp_become_power(file):
    # equal photons: twice the energy at half the wavelength
    path = file("nm,photon flux\n400,1\n800,1\n")
    power = power_of(read_curves(path, answers=Answers(quantity="power")))
    assert power.values[0, 0] / power.values[-1, 0] == pytest.approx(2.0, rel=1e-12)


def test_a_lamp_that_may_count_photons_or_energy_is_asked_about(file):
    path = file("nm,lamp\n400,1\n800,1\n")
    result = read_curves(path, answers=Answers(quantity="power"))
    with refused_input(subject=str(path), remedy=(Setting("per", ("energy", "photon")),)):
        power_of(result)
    with refused_input(subject=str(path), setting="columns"):
        power_of(read_curves(file("nm,A,B\n400,1,1\n800,1,1\n")))


def test_relative_curves_make_a_sensor_only_with_a_peak(file):
    path = file("wavelength_nm,R,G\n400,0.1,0.5\n700,0.2,1.0\n")
    either = (Setting("peak_qe"), Setting("level", ("absolute",)))
    with refused_input(subject=str(path), remedy=either):
        read_sensor(path, GRID, PAPER_PIXEL)
    absolute = read_sensor(path, GRID, PAPER_PIXEL, answers=Answers(level="absolute"))
    assert absolute.qe.max() == 1.0
    half = read_sensor(path, GRID, PAPER_PIXEL, answers=Answers(peak_qe=0.5))
    assert half.qe[-1] == pytest.approx([0.1, 0.5])
    assert any("highest QE of 0.5" in note for note in half.notes)


def test_a_sensor_is_made_once_for_each_content_of_its_file_and_has_the_given_pixel(tmp_path):
    path = tmp_path / "cam.csv"
    path.write_text("wavelength_nm,A\n400,0.4\n700,0.4\n")
    one = read_sensor(path, GRID, PAPER_PIXEL)
    assert read_sensor(path, GRID, PAPER_PIXEL) is one
    whole = replace(PAPER_PIXEL, pitch_um=int(PAPER_PIXEL.pitch_um))  # equal, but another object
    assert read_sensor(path, GRID, whole).pixel is whole
    path.write_text(path.read_text().replace("0.4", "0.5"))
    assert (read_sensor(path, GRID, PAPER_PIXEL).qe == 0.5).all()


def test_a_sensor_says_what_was_taken_for_granted_and_what_looks_wrong(file):
    path = file("wavelength_nm,G,W\n400,0.1,0.2\n550,0.5,0.4\n700,0.1,0.2\n")
    sensor = read_sensor(path, GRID, PAPER_PIXEL)
    assert any("taken as absolute QE per photon" in note for note in sensor.notes)
    assert any("green exceeds white by up to 25 %" in note for note in sensor.notes)
    with refused_input(subject=str(path), value="reflectance"):
        read_sensor(file("nm,reflectance\n400,.1\n700,.2"), GRID, PAPER_PIXEL)
    with refused_input(subject=str(path), setting="per"):
        read_sensor(file("nm,sensitivity\n400,.1\n700,.2"), GRID, PAPER_PIXEL)
    give_percent = Setting("scale", ("percent",))
    given = Answers(scale="percent")
    for text, answers, value, remedy in (
        ("12", Answers(), 12.0, give_percent),
        ("1.2", Answers(), 1.2, "correct it"),  # one outlier among fractions
        ("120", given, 1.2, "correct it"),
    ):
        path = file(f"wavelength_nm,A\n400,.1\n700,{text}")
        place = {"where": "column 'A' at 700 nm", "value": value, "remedy": (remedy,)}
        with refused_input(subject=str(path), **place):
            read_sensor(path, GRID, PAPER_PIXEL, answers=answers)


def test_a_peak_in_percent_is_refused():
    with refused_input(subject="peak_qe", value=60.0):
        Answers(peak_qe=60.0)


def test_json_with_a_key_twice_or_a_word_for_a_number_is_refused(file):
    text = rawtoaces_text()
    assert refusal(file(text.replace('"400"', '"500"'))).value == "500"
    entry = "entry '400' of spectral_data.data.main"
    assert refusal(file(text.replace("0.0125", '"low"'))).where == entry
    assert refusal(file(text.replace("0.0125", "1" + "0" * 400))).where == entry
    assert refusal(file(text.replace('"R",', ""))).where == "key 'spectral_data.index.main'"


def test_tm27_keeps_the_lines_of_its_faults(file):
    error = refusal(file(tm27_text().replace("</SpectralQuantity>", "</Quantity>")))
    assert error.where.startswith("line 4, ")
    error = refusal(file(tm27_text().replace("0.05<", "x<")))
    assert (error.where, error.value) == ("SpectralData 2", "x")


def test_a_relative_lamp_of_tm27_is_one_of_power(file):
    message = read_curves(file(tm27_text("relative")))
    assert (message.quantity, message.per, message.level) == ("power", "energy", "relative")


# What shared/data/README.md says of each file, and a part of the sentence that must be found,
# for files that do not declare it, with what their user knows of the curves.
REAL_DEFECTS = {
    "sensors/MT9V024_RGBW.mat": r"green exceeds white by up to 15 % at 530-560 nm",
    "sensors/ar0132atRGB.mat": r"exactly 1 .*look relative",
    "sensors/ar0132atRGBW.mat": r"exactly 1 .*look relative",
    "sensors/cfaRGBIR.mat": r"exactly 1 .*look relative",
    "reflectances/macbethChart.mat": r"reflects 0\.8\d .* [67] % below the white",
    "reflectances/esserChart.mat": r"exactly 1 .*look relative",
    "reflectances/AsianHyspex.mat": r"rounded to whole nm: steps of 3 and 4 for 3\.64",
}


@real_files
@pytest.mark.parametrize(("name", "defect"), REAL_DEFECTS.items())
def test_the_known_defects_of_real_files_are_found_and_said(name, defect):
    assert SHARED is not None
    answers = Answers(quantity="reflectance") if "reflectances/" in name else Answers()
    result = read_curves(SHARED / name, answers=answers)
    assert re.search(defect, "\n".join(result.defects))


REAL_ENDS = {
    "sensors/CMYG.mat": (400, 700),
    "sensors/AptinaMT9M131.mat": (400, 1000),
    "sensors/IMX249_BFLY-U3-23S6C.csv": (370, 750),
}


@real_files
@pytest.mark.parametrize(("name", "ends"), REAL_ENDS.items())
def test_a_range_that_ends_before_1050_nm_is_a_question_and_not_a_defect(name, ends):
    assert SHARED is not None
    result = read_curves(SHARED / name)
    assert tuple(result.curves.wavelength_nm[[0, -1]]) == ends
    assert result.defects == ()
    assert "beyond" in abouts(result)


@real_files
@pytest.mark.parametrize("name", ["sensors/GSENSE4040BSI.csv", "reflectances/Horse_Trial2.txt"])
def test_odd_values_outside_400_to_1050_nm_are_not_a_defect(name):
    # a guard value of 0 at 150 nm, values of hundreds at 1847-1879 nm
    assert SHARED is not None
    assert read_curves(SHARED / name).defects == ()


@real_files
def test_every_real_file_is_read_and_its_range_is_right():
    assert SHARED is not None
    folders = ("sensors", "irfilters", "reflectances", "illuminants")
    read = {p.name: read_curves(p) for f in folders for p in sorted((SHARED / f).iterdir())}
    assert len(read) >= 27
    ends = {name: result.curves.wavelength_nm[[0, -1]].tolist() for name, result in read.items()}
    # shared/data/README.md
    assert ends["MT9V024_RGBW.mat"] == [380, 1080]
    assert ends["ircf_public.mat"] == [350, 1200]
    assert ends["ASTMG173.csv"] == [280, 4000]
    assert ends["BeckmanLawn.txt"] == [350, 2500]
    assert read["ASTMG173.csv"].quantity == "power"
    assert read["ASTMG173.csv"].step_nm is None
    assert read["ill_A.mat"].per == "energy"
    assert "scale" in abouts(read["IMX249_BFLY-U3-23S6C.csv"])  # only a comment says percent
    assert read["IMX571_measured.csv"].scale == "percent"
    assert read["GSENSE4040BSI.csv"].scale == "fraction"
    assert read["BeckmanLawn.txt"].deviations is not None
    assert any("stimated" in note for note in read["esserChart.mat"].notes)
    quiet = ("MT9V024_Mono.mat", "MT9V024_RGB.mat", "irFilter_schott.mat", "IMX571_measured.csv")
    assert [read[name].defects for name in quiet] == [()] * len(quiet)


@real_files
def test_a_real_sensor_in_relative_units_asks_and_then_has_its_peak():
    assert SHARED is not None
    path = SHARED / "sensors/ar0132atRGBW.mat"
    with refused_input(subject=str(path), setting="peak_qe"):
        read_sensor(path, DEFAULT_GRID, PAPER_PIXEL, answers=Answers(beyond="zero"))
    answers = Answers(beyond="zero", peak_qe=0.6, per="photon")
    assert read_sensor(path, DEFAULT_GRID, PAPER_PIXEL, answers=answers).qe.max() == pytest.approx(
        0.6, rel=0.01
    )


@pytest.mark.parametrize("cell", ["abc", "nan"])
@pytest.mark.parametrize("head", ["wavelength_nm,R,G\n", ""])
def test_a_faulty_first_row_is_refused_as_any_later_row(file, head, cell):
    rows = ["400,0.1,0.2", "500,0.3,0.3", "600,0.3,0.4"]
    for i, row in enumerate(rows):
        faulty = [*rows[:i], row.replace(row[4:7], cell), *rows[i + 1 :]]
        path = file(head + "\n".join(faulty) + "\n")
        error = refusal(path)
        line, column = i + 1 + bool(head), "R" if head else "2"
        assert (error.value, error.where) == (cell, f"line {line}, column {column!r}")
    assert read_curves(file("31,samples\nnm,R\n400,0.1\n500,0.3\n")).curves.names == ("R",)


def test_only_small_negative_values_are_said_to_be_set_to_zero_on_demand(file):
    small, large = (
        f"wavelength_nm,R\n400,0.5\n700,{value}\n1050,0.5\n" for value in (-0.004, -0.2)
    )
    with refused_input(value=-0.004, setting="negatives"):
        cn.analyze(file(small))
    for negatives in ("refuse", "zero"):
        with refused_input(value=-0.2) as caught:
            cn.analyze(file(large), negatives=negatives)
        assert not any(isinstance(one, cn.Setting) for one in caught.value.remedy)
    assert cn.analyze(file(small), negatives="zero", budget=False).analyses


# what a file lacks


EACH_NM = np.arange(400.0, 701.0, 10.0)


def matlab(path, data, at=EACH_NM):
    savemat(path, {"wavelength": at, "data": data})
    return path


def test_no_straight_line_bridges_lost_values_of_matlab_unsaid(tmp_path):
    data = np.full((EACH_NM.size, 2), 0.25)
    data[5:26, 1] = np.nan  # 450-650 nm
    record = read_curves(matlab(tmp_path / "lost.mat", data))
    assert record.gaps_nm == ((440.0, 660.0),)
    lost = "2: 21 values that are no number (NaN) at 450-650; straight lines join their neighbors"
    assert lost in record.defects
    assert any("a gap from 440 to 660 nm" in defect for defect in record.defects)


def test_a_wavelength_that_is_no_number_is_refused(tmp_path):
    at = EACH_NM.copy()
    at[3] = np.nan
    path = matlab(tmp_path / "lost.mat", np.ones((at.size, 1)), at)
    with refused_input(subject=str(path), where="array 'wavelength'"):
        read_curves(path)


def test_square_data_say_which_axis_was_taken(tmp_path):
    path = matlab(tmp_path / "square.mat", np.eye(3) / 2, np.array([400.0, 500.0, 600.0]))
    assert any("3 by 3: its rows are taken for wavelengths" in n for n in read_curves(path).notes)


def test_empty_cells_are_said_with_their_curve_and_range(file):
    rows = [f"{w:g},{'' if 450 <= w <= 650 else 0.2},0.3" for w in EACH_NM]
    result = read_curves(file("\n".join(["nm,R,G", *rows])))
    assert "R: 21 empty cells at 450-650; straight lines join their neighbors" in result.defects
    assert result.gaps_nm == ((440.0, 660.0),)


@pytest.mark.parametrize(
    ("text", "where", "value"),
    [
        ("nm,R,G\n400,.1,.2\n500,.2\n600,.3,.4,.5\n", "line 4", 4),
        ("nm,R\n400,.1\n-400,.2\n500,.1\n", "line 3", -400.0),
        ("X,Y\n400,.1\n500,.2\n0,.2\n", "line 4", 0.0),
        (f"nm,R\n400,.1\n500,{10**35}\n", "line 3, column 'R'", str(10**35)),
    ],
)
def test_a_row_that_does_not_fit_is_named_by_its_line(file, text, where, value):
    path = file(text)
    with refused_input(subject=str(path), where=where, value=value):
        read_curves(path)


def test_one_ragged_row_has_and_two_have(file):
    one = read_curves(file("nm,R,G\n400,.1,.2\n500,.2\n600,.3,.4\n700,.1,.1\n"))
    assert "ragged rows: line 3 has fewer than 3 cells" in one.defects
    two = read_curves(file("nm,R,G\n400,.1,.2\n500,.2\n550,.2\n600,.3,.4\n700,.1,.1\n"))
    assert "ragged rows: lines 3, 4 have fewer than 3 cells" in two.defects


def test_values_of_unknown_scale_stay_as_they_are_and_are_asked_about(file):
    # CIE FL2 begins so: power relative to no whole, with a peak of 35
    result = read_curves(file("wavelength,FL2\n380,1.18\n545,34.98\n780,2.0\n"))
    assert result.curves.values.max() == 34.98
    assert "scale" in abouts(result)
    percent = read_curves(file("nm,FL2\n380,1.18\n780,35\n"), answers=Answers(scale="percent"))
    assert percent.curves.values.max() == pytest.approx(0.35)


def test_a_heading_in_percent_is_an_answer(file):
    result = read_curves(file("nm,R [%]\n400,10\n700,40\n"))
    assert result.curves.values.ravel() == pytest.approx([0.1, 0.4])
    assert "scale" not in abouts(result)


@pytest.mark.parametrize("beyond", ["zero", "hold"])
def test_an_answered_question_is_neither_a_defect_nor_asked_again(file, beyond):
    path = file("nm,R\n450,.1\n700,1\n")
    asked = read_curves(path)
    assert any("look relative" in defect for defect in asked.defects)
    assert "beyond" in abouts(asked)
    result = read_curves(path, answers=Answers(beyond=beyond, level="absolute"))
    assert result.defects == ()
    assert abouts(result) == {"quantity", "per"}


def lamp(**changes):
    facts = {"notes": ("level: relative", "light counted per photon"), "source": "a bench"}
    return Spectra(
        wavelength_nm=np.array([400.0, 700.0]), values=np.array([[1.0], [3.0]]), names=("lamp",),
        quantity="power", unit="1", **(facts | changes),
    )  # fmt: skip


def test_tm_27_keeps_name_level_and_how_light_is_counted(file):
    text = spectra_spdx(lamp(source="/home/someone/lamp.csv"), "lamp", created="2026-01-31")
    assert "someone" not in text
    message = read_curves(file(text, "lamp.spdx"))
    assert message.curves.names == ("lamp",)
    assert (message.quantity, message.level, message.per) == ("power", "relative", "photon")


def test_csv_of_ours_keeps_source_notes_and_how_light_is_counted(file):
    result = read_curves(file(spectra_csv(lamp())))
    assert (result.said_source, result.said_notes) == (lamp().source, lamp().notes)
    assert (result.quantity, result.level, result.per) == ("power", "relative", "photon")


def test_a_sensor_that_says_nothing_is_asked_all_in_one_sentence(file):
    path = file("nm,R,G\n400,.1,.2\n700,.3,.1\n")
    with refused_input(subject=str(path)) as caught:
        qe_of(read_curves(path), Answers())
    per, level = caught.value.remedy
    assert per == Setting("per", ("energy", "photon"))
    assert level == Setting("level", ("absolute", "relative"))
    # both must be answered: joined by "and", in whatever words a shell has for them
    assert str(caught.value).endswith(f"; {per}, and {level}")
    assert caught.value.sentence(render=lambda one: one.name).endswith("; per, and level")
    said = Answers(per="photon", level="absolute")
    notes = qe_of(read_curves(path, answers=said), said).notes
    assert not any("say" in note or "taken as absolute" in note for note in notes)


@pytest.mark.parametrize("head", ["wavelength_nm,R,G", "nm,QE R,QE G", "nm,R [e-/photon],G"])
def test_a_sensor_whose_heading_says_qe_is_absolute_per_photon(file, head):
    result = read_curves(file(f"{head}\n400,.1,.2\n700,.3,.1\n"))
    assert qe_of(result, Answers()).values.tolist() == [[0.1, 0.2], [0.3, 0.1]]


def cgats_of(sets):
    head = 'CTI3\nSPECTRAL_START_NM "400"\nSPECTRAL_END_NM "1050"\nBEGIN_DATA_FORMAT\n'
    fields = "SPEC_400 SPEC_725 SPEC_1050\nEND_DATA_FORMAT\nBEGIN_DATA\n"
    return head + fields + "1 2 3\n" * sets + "END_DATA\n"


@pytest.mark.evidence
def test_a_file_of_very_many_curves_is_refused_at_once(file):
    path = file(cgats_of(3000), "a.sp")
    start = time.process_time()
    assert len(read_curves(path).curves.names) == 3000
    accepted_s = time.process_time() - start
    path.write_text(cgats_of(100_000))
    start = time.process_time()
    with refused_input(subject=str(path), value=100_000):
        read_curves(path)
    # 33 times the names; by pairs of names it would be 1,100 times
    assert time.process_time() - start < 150 * accepted_s


@pytest.mark.parametrize(("above", "advice"), [(1, "correct it"), (130, "percent")])
def test_few_values_above_1_are_errors_and_many_are_percent(tmp_path, above, advice):
    values = np.full(198, 0.4)
    values[:above] = 45.0
    rows = [f"{400 + 10 * i},{a},{b},{c}" for i, (a, b, c) in enumerate(values.reshape(66, 3))]
    file = tmp_path / "mixed.csv"
    file.write_text("\n".join(["wavelength_nm,R,G,B", *rows]), encoding="utf-8")
    with pytest.raises(cn.InputError) as refused:
        cn.analyze(str(file))
    assert advice in str(refused.value)
