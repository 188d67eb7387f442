"""Tables with other layouts give the same curves as plain ones, or are refused."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from chromanoise.io import read_sensor
from chromanoise.io.spectra import Answers, read_curves
from chromanoise.sensor import PAPER_PIXEL
from chromanoise.spectra import DEFAULT_GRID
from outcomes import refused_input

AT_NM = np.arange(380, 1071, 10)
CURVES = {
    name: np.round(0.05 + height * np.exp(-(((AT_NM - middle) / 90) ** 2)), 6).tolist()
    for name, height, middle in (("red", 0.5, 600), ("green", 0.6, 540), ("blue", 0.4, 450))
}


def _upright(names, heading="wavelength [nm]"):
    rows = zip(AT_NM.tolist(), *(CURVES[name] for name in names), strict=True)
    return "\n".join([",".join([heading, *names]), *(",".join(map(str, row)) for row in rows)])


def _in_rows(names, corner, at="{}", first="{name}"):
    lines = [",".join([corner, *(at.format(w) for w in AT_NM.tolist())])]
    for number, name in enumerate(names, 1):
        label = first.format(name=name, number=number)
        lines.append(",".join([label, *map(str, CURVES[name])]))
    return "\n".join(lines)


def _read(tmp_path, text, answers=None):
    path = tmp_path / "table.csv"
    path.write_text(text, encoding="utf-8")
    return read_curves(path, answers=answers or Answers(beyond="hold"))


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.permutations(sorted(CURVES)).flatmap(lambda p: st.integers(1, 3).map(lambda n: p[:n])),
    st.sampled_from(["", "name", "sample", "Wavelength (nm)", "timestamps"]),
    st.sampled_from(["{}", "{}nm", "{} nm", "{}.0"]),
)
def test_spectra_in_rows_are_the_curves_of_the_same_table_in_columns(tmp_path, names, corner, at):
    turned = _read(tmp_path, _in_rows(names, corner, at))
    plain = _read(tmp_path, _upright(names))
    assert turned.curves.names == plain.curves.names
    assert turned.curves.wavelength_nm.tolist() == plain.curves.wavelength_nm.tolist()
    assert turned.curves.values.tolist() == plain.curves.values.tolist()
    assert any("in rows" in note for note in turned.notes)


def test_the_name_of_a_spectrum_in_a_row_is_all_words_before_its_numbers(tmp_path):
    text = _in_rows(["red", "green"], "id,kind", first="{number},{name}")
    assert _read(tmp_path, text).curves.names == ("1 red", "2 green")


@pytest.mark.parametrize("heading", ["nm,1,2,3,4,5", "wavelength,450,500,550,600,650",
                                     "x,450,500,550,600,650", "nm,R,450,500,550,600"])  # fmt: skip
def test_curves_with_numbers_as_names_stay_in_columns(tmp_path, heading):
    rows = [f"{w},.1,.2,.3,.4,.5" for w in AT_NM]
    result = _read(tmp_path, "\n".join([heading, *rows]))
    assert result.curves.names == tuple(heading.split(",")[1:])
    assert result.curves.wavelength_nm.tolist() == AT_NM.tolist()


def test_one_bad_wavelength_does_not_transpose_a_table(tmp_path):
    rows = [f"{w},.1,.2,.3,.4,.5".replace("400", "4oo") for w in AT_NM]
    with refused_input(subject=str(tmp_path / "table.csv")):
        _read(tmp_path, "\n".join(["x,450,500,550,600,650", *rows]))


@pytest.mark.parametrize("cell", ["4x0", "400 410", "380%", "O380", "n/a", "NaN", "inf", "x"])
@pytest.mark.parametrize("heading", ["wavelength_nm,a,b", "wavelength,a,b\nnm,,"])
def test_a_first_row_with_a_faulty_wavelength_is_no_second_heading(tmp_path, heading, cell):
    rows = [f"{w},.1,.2" for w in AT_NM]
    text = "\n".join([heading, f"{cell},.1,.2", *rows[1:]])
    with refused_input(value=cell) as refused:
        _read(tmp_path, text)
    assert refused.value.where == f"line {heading.count(chr(10)) + 2}"


@pytest.mark.parametrize("cell", ["4x0", "380 nm", "370-380", "'380'"])
def test_a_first_row_with_a_faulty_wavelength_is_no_heading(tmp_path, cell):
    rows = [f"{w},.1,.2" for w in AT_NM]
    with refused_input(value=cell, requirement="must begin with a wavelength"):
        _read(tmp_path, "\n".join([f"{cell},.1,.2", *rows[1:]]))


@pytest.mark.parametrize("cell", ["O1070", "~1070", "'1070'", "1070 nm or so"])
def test_a_last_row_of_numbers_with_a_faulty_wavelength_is_no_text(tmp_path, cell):
    rows = [f"{w},.1,.2" for w in AT_NM]
    for last, is_refused in ((f"{cell},.1,.2", True), ("mean,.1,.2", False)):
        text = "\n".join(["wavelength_nm,a,b", *rows[:-1], last])
        if is_refused:
            with refused_input(value=cell):
                _read(tmp_path, text)
        else:
            assert any("text after the numbers" in note for note in _read(tmp_path, text).notes)


@pytest.mark.parametrize("row", [",,", "370,,"])
def test_an_empty_row_under_a_heading_leaves_the_heading(tmp_path, row):
    plain = _upright(["red", "green"]).splitlines()
    read = _read(tmp_path, "\n".join([plain[0], row, *plain[1:]]))
    assert read.curves.names == ("red", "green")
    assert read.curves.values[-1].tolist() == [CURVES["red"][-1], CURVES["green"][-1]]


def test_rows_that_begin_to_have_units_are_refused_at_their_line(tmp_path):
    rows = [f"{w},.1" for w in AT_NM[:40]] + [f"{w}nm,.1" for w in AT_NM[40:]]
    with refused_input(value=f"{AT_NM[40]}nm", where="line 42, column 'wavelength_nm'"):
        _read(tmp_path, "\n".join(["wavelength_nm,a", *rows]))


@pytest.mark.parametrize(("at", "cells", "value"), [
    (0, "2.0%,.2", "2.0%"), (20, ".1,2 %", "2 %"), (-1, "10%,20%", "10%"), (None, "10%,.2", "10%"),
])  # fmt: skip
def test_a_percent_sign_after_some_values_is_refused(tmp_path, at, cells, value):
    rows = [f"{w},.1,.2" if at is not None else f"{w},{cells}" for w in AT_NM]
    if at is not None:
        rows[at] = f"{AT_NM[at]},{cells}"
    with refused_input(value=value):
        _read(tmp_path, "\n".join(["wavelength_nm,a,b", *rows]))


def test_a_percent_sign_after_each_value_is_a_hundredth(tmp_path):
    rows = [f"{w},10%,20 %" for w in AT_NM]
    read = _read(tmp_path, "\n".join(["wavelength_nm,a,b", *rows]))
    assert read.curves.values[0].tolist() == [0.1, 0.2]


@pytest.mark.parametrize("unit", ["mA/W", "counts", "ADU", "DN", "V/(lx s)", "permille"])
def test_a_sensor_in_a_unit_of_no_response_is_refused(tmp_path, unit):
    rows = [f"{w},.1,.2" for w in AT_NM]
    text = "\n".join([f"wavelength_nm,a [{unit}],b [{unit}]", *rows])
    path = tmp_path / "table.csv"
    path.write_text(text, encoding="utf-8")
    answers = Answers(beyond="hold", per="photon", level="absolute")
    with refused_input(value=unit, remedy=("convert it",)):
        read_sensor(path, DEFAULT_GRID, PAPER_PIXEL, answers=answers)


def test_a_sensor_of_very_many_curves_is_refused(tmp_path):
    path = tmp_path / "table.csv"
    head = ",".join(["wavelength_nm", *(f"c{k}" for k in range(257))])
    rows = [",".join([str(w), *["0.1"] * 257]) for w in AT_NM]
    path.write_text("\n".join([head, *rows]), encoding="utf-8")
    with refused_input(value=257):
        read_sensor(path, DEFAULT_GRID, PAPER_PIXEL, answers=Answers(beyond="hold"))


@pytest.mark.parametrize(
    ("key", "word", "meant"), [("level", "relativ", "relative"), ("per", "photons", "photon")]
)
def test_a_misspelt_choice_of_a_key_is_refused_and_another_fact_is_none(tmp_path, key, word, meant):
    rows = "\n".join(["wavelength_nm,a", *(f"{w},.1" for w in AT_NM)])
    with refused_input(value=word, remedy=(f"did you mean {meant}?",)):
        _read(tmp_path, f"# {key}: {word}\n{rows}")
    assert getattr(_read(tmp_path, f"# {key}: {meant}\n{rows}"), key) == meant
    assert getattr(_read(tmp_path, f"# {key}: 3 of 7\n{rows}"), key) is None


def test_a_response_in_amperes_per_watt_of_some_curves_is_refused(tmp_path):
    rows = [f"{w},.1,.2" for w in AT_NM]
    with refused_input(value=("a", "b")):
        _read(tmp_path, "\n".join(["wavelength_nm,a [A/W],b", *rows]))


@pytest.mark.parametrize("first", ["nm", "D65", "CIE 1931", "sample 2024", "2024-01-05"])
def test_a_second_heading_with_numbers_as_names_gives_the_names(tmp_path, first):
    rows = [f"{w},.1,.2" for w in AT_NM]
    read = _read(tmp_path, "\n".join(["wavelength,sample,sample", f"{first},1,2", *rows]))
    assert read.curves.names == ("1", "2")


@pytest.mark.parametrize("row", ["4x0,nan,.2", "4x0,n/a,.2", "abc,.1,.2", "nan,.1,.2"])
@pytest.mark.parametrize("heading", ["wavelength_nm,a,b", "x,a,b", ",a,b", None])
def test_a_first_row_of_values_without_a_wavelength_is_refused(tmp_path, heading, row):
    rows = [*([heading] if heading else []), row, *(f"{w},.1,.2" for w in AT_NM[1:])]
    with refused_input(subject=str(tmp_path / "table.csv"), value=row.split(",")[0]):
        _read(tmp_path, "\n".join(rows))


@pytest.mark.parametrize(("heading", "factor"), [
    ("# Wavelength [nm] QE [%]", 0.01), ("# Wavelength[nm] QE[0..100]", 0.01),
    ("# Wavelength (nm) QE (0-100.0)", 0.01), ("# Wavelength [nm]  QE[0..1.0]", 1.0),
    ("Wavelength (nm)   QE (%)", 0.01), ('"Wavelength (nm)" "QE (%)"', 0.01),
])  # fmt: skip
def test_a_heading_between_blanks_keeps_its_units_and_the_range_of_its_values(
    tmp_path, heading, factor
):
    result = _read(tmp_path, "\n".join(["#", heading, "#", *(f"{w}  0.5" for w in AT_NM)]))
    assert (result.quantity, result.wavelength_unit, result.factor) == ("QE", "nm", factor)
    assert not any("taken as nm" in note for note in result.notes)


@pytest.mark.parametrize(("heading", "unit", "first", "step"), [
    ("wavelength [um]", "nm", 380, 10), ("wavelength [nm]", "um", 0.38, 0.01),
    ("wavelength [Angstrom]", "nm", 380, 5),
])  # fmt: skip
def test_a_heading_whose_unit_fits_no_wavelength_is_a_question(
    tmp_path, heading, unit, first, step
):
    rows = [f"{first + step * k:.6g},0.5" for k in range(70)]
    text = "\n".join([f"{heading},transmittance", *rows])
    with refused_input(subject=str(tmp_path / "table.csv"), setting="wavelength_unit") as refused:
        _read(tmp_path, text)
    assert refused.value.remedy[0].values[0] == unit
    message = _read(tmp_path, text, Answers(wavelength_unit=unit))
    assert message.curves.wavelength_nm[0] == 380


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.permutations(AT_NM.tolist()))
def test_no_unit_is_guessed_for_numbers_in_no_order_without_a_heading(tmp_path, order):
    steps = np.sign(np.diff(order))
    text = "\n".join(f"{w / 1000},0.5,0.4" for w in order)
    if abs(steps.sum()) < 0.5 * steps.size:
        with refused_input(setting="wavelength_unit"):
            _read(tmp_path, text)
    else:
        assert _read(tmp_path, text).wavelength_unit == "um"


def test_a_heading_of_several_lines_in_a_spreadsheet_is_one_line(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.append(["wavelength_nm", "red \nwide", "green"])
    for wavelength_nm in AT_NM.tolist():
        book.active.append([wavelength_nm, 0.5, 0.4])
    book.save(tmp_path / "table.xlsx")
    read = read_curves(tmp_path / "table.xlsx", answers=Answers(beyond="hold"))
    assert read.curves.names == ("red wide", "green")


def test_a_column_of_nan_is_a_curve_without_values_and_a_column_of_words_is_none(tmp_path):
    lines = _upright(["red", "green"]).splitlines()
    words = "\n".join([f"{lines[0]},remark", *(f"{line},ok" for line in lines[1:])])
    assert _read(tmp_path, words).curves.names == ("red", "green")
    missing = "\n".join([f"{lines[0]},blue", *(f"{line},nan" for line in lines[1:])])
    with refused_input(value="nan"):
        _read(tmp_path, missing)
