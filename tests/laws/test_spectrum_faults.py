"""What a file of spectra lacks is said with curve and range; what only a person knows is asked."""

import time

import numpy as np
import pytest
from scipy.io import savemat

from chromanoise.base.errors import Setting
from chromanoise.io.spectra import Answers, qe_of, read_curves
from chromanoise.io.spectra.writing import spectra_csv, spectra_spdx
from chromanoise.spectra import Spectra
from outcomes import refused_input

AT_NM = np.arange(400.0, 701.0, 10.0)


def abouts(result):
    return {question.about for question in result.questions}


def matlab(path, data, at=AT_NM):
    savemat(path, {"wavelength": at, "data": data})
    return path


def test_no_straight_line_bridges_lost_values_of_matlab_unsaid(tmp_path):
    data = np.full((AT_NM.size, 2), 0.25)
    data[5:26, 1] = np.nan  # 450-650 nm
    record = read_curves(matlab(tmp_path / "lost.mat", data))
    assert record.gaps_nm == ((440.0, 660.0),)
    lost = "2: 21 values that are no number (NaN) at 450-650; straight lines join their neighbors"
    assert lost in record.defects
    assert any("a gap from 440 to 660 nm" in defect for defect in record.defects)


def test_a_wavelength_that_is_no_number_is_refused(tmp_path):
    at = AT_NM.copy()
    at[3] = np.nan
    path = matlab(tmp_path / "lost.mat", np.ones((at.size, 1)), at)
    with refused_input(subject=str(path), where="array 'wavelength'"):
        read_curves(path)


def test_square_data_say_which_axis_was_taken(tmp_path):
    path = matlab(tmp_path / "square.mat", np.eye(3) / 2, np.array([400.0, 500.0, 600.0]))
    assert any("3 by 3: its rows are taken for wavelengths" in n for n in read_curves(path).notes)


def test_empty_cells_are_said_with_their_curve_and_range(file):
    rows = [f"{w:g},{'' if 450 <= w <= 650 else 0.2},0.3" for w in AT_NM]
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
