"""Headings and declared keys decide what curves are; free text has no effect."""

import io
import json
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from scipy.io import savemat

from chromanoise.base.errors import InputError
from chromanoise.io import read_sensor
from chromanoise.io.spectra import Answers, power_of, read_curves
from chromanoise.sensor import PAPER_PIXEL
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study.resolve_names import resolve_filter, resolve_illuminant
from outcomes import refused_input

AT_NM = np.arange(380.0, 1071.0, 10.0)
QE = 0.1 + 0.5 * np.exp(-(((AT_NM - 550) / 120) ** 2))

# Comments of real files. Each once changed the electrons or caused a refusal.
COMMENTS = [
    "bench reference diode: 0.21 A/W at 550 nm", "relative error 1e-3", "lamp power 100 W",
    "transmission of the lens not included", "reflectance standard used",
    "QE in percent is in the other file", "normalized to the monitor diode", "spectral response",
    "radiance of the sphere: 12 W m-2 sr-1", "photon counting head, 2e5 counts/s",
    "wavelength accuracy 0.3 nm", "wavelengths in Angstrom in the other file", "step 0.01 um",
    "units of the lamp file: uW/cm2/nm", "a.u. in the plot only", "100 % = full scale",
    "irradiance, not radiance", "S/N 1234, W. Smith", "arbitrary title", "emission line at 546 nm",
    "IR-cut filter removed", "standard deviation 0.002", "relative humidity 40 %", "per energy?",
    "absolute calibration of 2019", "illuminant A at 2856 K", "flux: 3 lm", "level 3, room 2",
    "quantity: see sheet 2, reflectance", "scale of the drawing 1:2", "unit 7 of the batch",
    "quantum efficiency of the reference 0.65", "watt meter: type 3", "energy 2.27 eV at 546 nm",
    "sensitivity class A", "transmittance of the window 0.92 (not divided out)", "µm, nm, Å",
    "wavenumber scan, 20000 1/cm at the start", "beam power 3.2 mW", "dark counts 12 e-",
    "date: 2024-01-31", "source: a bench", "notes: percent; relative", "see https://example.org/qe",
    "sd of three runs 0.001", "spd of the lamp was flat", "extraterrestrial curve not used",
    "percentages were rounded", "level: unknown", "per: request",
    "Units: see data sheet, error 2 percent", "Unit: camera 3 (gain error 2 percent)",
    "units: relative humidity 40 %", "Unit: bench 3, Thorlabs power meter", "scale: 1 % steps",
    "wavelength unit: see sheet, 1 um steps", "units = W. Smith, photon lab", "unit: percent error",
]  # fmt: skip


def _text(comments, sign, decimal=".", mark="#"):
    def cell(value):
        return repr(float(value)).replace(".", decimal)

    rows = [f"{cell(w)}{sign}{cell(q)}" for w, q in zip(AT_NM, QE, strict=True)]
    return "\n".join([*(f"{mark} {c}" for c in comments), f"wavelength_nm{sign}QE", *rows]).encode()


def _mat(comments):
    names = np.empty((1, 1), dtype=object)
    names[0, 0] = "QE"
    file = io.BytesIO()
    arrays = {"wavelength": AT_NM, "data": QE[:, None], "filterNames": names}
    savemat(file, arrays | {"comment": "; ".join(comments)})
    return file.getvalue()


def _json(comments):
    main = {f"{w:g}": [float(q)] * 3 for w, q in zip(AT_NM, QE, strict=True)}
    spectral = {"units": "relative", "index": {"main": ["R", "G", "B"]}, "data": {"main": main}}
    header = {f"comment{i}": comment for i, comment in enumerate(comments)}
    return json.dumps({"header": header, "spectral_data": spectral}).encode()


def _xlsx(comments):
    from openpyxl import Workbook

    book = Workbook()
    for comment in comments:
        book.active.append([comment])
    book.active.append(["wavelength_nm", "QE"])
    for row in zip(AT_NM.tolist(), QE.tolist(), strict=True):
        book.active.append(list(row))
    file = io.BytesIO()
    book.save(file)
    return file.getvalue()


FORMS = {
    "comma.csv": (lambda c: _text(c, ","), Answers()),
    "german.csv": (lambda c: _text(c, ";", decimal=","), Answers()),
    "blanks.dat": (lambda c: _text(c, " ", mark="%"), Answers()),
    "isetcam.mat": (_mat, Answers()),
    "camera.json": (_json, Answers(peak_qe=0.5)),
    "sheet.xlsx": (_xlsx, Answers()),
}


def _qe(path, answers):
    return read_sensor(path, DEFAULT_GRID, PAPER_PIXEL, answers=answers).qe


@pytest.mark.parametrize("form", FORMS)
@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.lists(st.sampled_from(COMMENTS), min_size=1, max_size=6, unique=True))
def test_free_text_leaves_quantum_efficiencies_as_they_are_to_the_last_digit(file, form, comments):
    written, answers = FORMS[form]
    path = file(written([]), form)
    bare = _qe(path, answers)
    path.write_bytes(written(comments))
    assert _qe(path, answers).tolist() == bare.tolist()


@pytest.mark.parametrize("comment", COMMENTS)
def test_no_comment_alone_answers_a_question(file, comment):
    path = file(f"# {comment}\nx,y\n400.5,0.2\n700.5,0.4\n", "bare.csv")
    result = read_curves(path)
    assert (result.quantity, result.level, result.per, result.scale) == (
        None,
        None,
        None,
        "fraction",
    )
    assert result.curves.values.ravel().tolist() == [0.2, 0.4]
    assert {q.about for q in result.questions} == {"quantity", "per", "level", "beyond"}


UNITS = {"nm": AT_NM, "um": AT_NM / 1000, "angstrom": 10 * AT_NM, "1/cm": 1e7 / AT_NM}
SPELLINGS = {
    "nm": ("nm", "nanometers", "NM"),
    "um": ("um", "µm", "micron", "micrometer"),
    "angstrom": ("Angstrom", "A", "AA", "Å", "angstroms", "ANGSTROM"),
    "1/cm": ("1/cm", "cm-1", "cm^-1"),
}
HEADS = {
    "bracket": "wavelength [{unit}],transmittance\n",
    "parenthesis": "Wavelength ({unit}),transmittance\n",
    "key": "# wavelength_unit: {unit}\nwavelength,transmittance\n",
    "words of a key": "# Wavelength units = {unit}\nwavelength,transmittance\n",
    "units below": "wavelength,transmittance\n{unit},-\n",
    "comment": "# wavelength [{unit}], transmittance\n",
    "ECSV, flow": "# %ECSV 1.0\n# ---\n# datatype:\n"
    "# - {{name: wavelength, unit: {unit}, datatype: float64}}\n"
    "# - {{name: transmittance, datatype: float64}}\nwavelength,transmittance\n",
    "ECSV, block": "# %ECSV 1.0\n# ---\n# datatype:\n# - name: wavelength\n#   unit: {unit}\n"
    "#   datatype: float64\n# - name: transmittance\n#   datatype: float64\n"
    "wavelength,transmittance\n",
}


@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize(
    ("unit", "spelling"), [(unit, s) for unit, all_ in SPELLINGS.items() for s in all_]
)
def test_every_declared_unit_of_wavelengths_gives_the_same_curve(file, unit, spelling, head):
    if spelling == "A" and head == "units below":
        pytest.skip("A alone in a row of units may be a name")
    rows = [f"{w!r},{q!r}" for w, q in zip(UNITS[unit].tolist(), QE.tolist(), strict=True)]
    path = file(HEADS[head].format(unit=spelling) + "\n".join(rows), "filter.ecsv")
    result = read_curves(path)
    assert result.wavelength_unit == unit
    assert result.quantity == "transmittance"
    np.testing.assert_allclose(result.curves.wavelength_nm, AT_NM, rtol=1e-12)
    np.testing.assert_allclose(result.curves.values.ravel(), QE, rtol=1e-12)


def test_a_table_of_spectral_flux_in_angstrom_is_a_light(file):
    # the form of synthetic photometry: names, and units below them, in comments
    path = file("# WAVELENGTH FLUX\n# ANGSTROMS FLAM\n3500. 1.\n5500. 2.\n11000. 1.\n", "star.dat")
    result = read_curves(path)
    assert (result.quantity, result.per, result.wavelength_unit) == ("power", "energy", "angstrom")
    assert power_of(result).wavelength_nm.tolist() == [350.0, 550.0, 1100.0]


@pytest.mark.parametrize(
    "at",
    [(3000, 11000), (300, 11000), (1, 2, 3), (30, 40), (1100, 2500), (9500, 26000), (1000, 3950)],
)
def test_no_unit_is_guessed_where_another_could_be_meant(file, at):
    path = file("\n".join(f"{w} 0.5" for w in at), "filter.dat")
    span = f"{at[0]}-{at[-1]}"
    with refused_input(subject=str(path), value=span, setting="wavelength_unit"):
        read_curves(path)
    if at == (3000, 11000):
        result = read_curves(path, answers=Answers(wavelength_unit="angstrom"))
        assert result.curves.wavelength_nm.tolist() == [300.0, 1100.0]


@pytest.mark.parametrize(
    "text",
    [
        "# wavelength_unit: um\nwavelength_nm,QE\n400,.1\n1050,.2\n",
        "wavelength [nm or um],QE\n400,.1\n1050,.2\n",
        "wavelength [eV],QE\n1.2,.1\n3.1,.2\n",
        "wavelength [m],QE\n4e-7,.1\n1.05e-6,.2\n",
        "wavelength_m,QE\n4e-7,.1\n1.05e-6,.2\n",
        "wavelength [0.1 nm],QE\n4000,.1\n10500,.2\n",
    ],
)
def test_two_units_or_an_unsupported_one_are_refused(file, text):
    path = file(text, "two.csv")
    with refused_input(subject=str(path)):
        read_curves(path)


def test_an_option_never_overrides_a_plausible_heading(file):
    path = file("wavelength_nm,QE\n400,.1\n1050,.2\n", "cam.csv")
    with refused_input(
        subject="wavelength_unit", value="angstrom", requirement=re.escape(str(path))
    ):
        read_curves(path, answers=Answers(wavelength_unit="angstrom"))
    path.write_text("wavelength_nm,QE\n0.4,.1\n1.05,.2\n")  # the heading does not fit
    with refused_input(subject="wavelength_unit", value="angstrom"):  # nor does this unit
        read_curves(path, answers=Answers(wavelength_unit="angstrom"))
    result = read_curves(path, answers=Answers(wavelength_unit="um"))
    assert result.curves.wavelength_nm.tolist() == [400.0, 1050.0]


def _curve(path, heading, values):
    rows = [f"{w:g},{v!r}" for w, v in zip(np.arange(300, 1101, 10), values, strict=True)]
    path.write_text("\n".join([heading, *rows]))
    return path


def _values(**at):
    values = np.full(81, 0.5)
    for wavelength, value in at.items():
        values[(int(wavelength[1:]) - 300) // 10] = value
    return values.tolist()


def test_negative_values_outside_the_grid_do_not_matter(tmp_path):
    clean = _curve(tmp_path / "clean.csv", "wavelength_nm,QE", _values())
    noisy = _curve(tmp_path / "noisy.csv", "wavelength_nm,QE", _values(w320=-0.7, w1090=-0.2))
    assert _qe(noisy, Answers()).tolist() == _qe(clean, Answers()).tolist()
    for path in (clean, noisy):
        path.write_text(path.read_text().replace("QE", "transmittance"))
    one, two = (resolve_filter(str(path)).values for path in (clean, noisy))
    assert one.tolist() == two.tolist()
    for path in (clean, noisy):
        path.write_text(path.read_text().replace("transmittance", "power"))
    one, two = (resolve_illuminant(str(path)).irradiance for path in (clean, noisy))
    assert one.tolist() == two.tolist()


@pytest.mark.parametrize("heading", ["wavelength_nm,QE", "wavelength_nm,transmittance",
                                     "wavelength_nm,power"])  # fmt: skip
def test_small_negative_values_are_refused_or_set_to_0_with_a_note(tmp_path, heading):
    path = _curve(tmp_path / "digitized.csv", heading, _values(w980=-0.0003))
    zero = _curve(tmp_path / "zero.csv", heading, _values(w980=0.0))

    def used(path, answers):
        if heading.endswith("QE"):
            sensor = read_sensor(path, DEFAULT_GRID, PAPER_PIXEL, answers=answers)
            return sensor.qe, sensor.notes
        if heading.endswith("transmittance"):
            curve = resolve_filter(str(path), answers=answers)
            return curve.values, curve.notes
        light = resolve_illuminant(str(path), answers=answers)
        return light.irradiance, light.notes

    with refused_input(subject=str(path), value=-0.0003, setting="negatives"):
        used(path, Answers())
    values, notes = used(path, Answers(negatives="zero"))
    assert values.tolist() == used(zero, Answers())[0].tolist()
    assert any("1 small negative value" in note and "-0.0003" in note for note in notes)


def test_a_large_negative_value_is_refused_whatever_is_answered(tmp_path):
    path = _curve(tmp_path / "wrong.csv", "wavelength_nm,QE", _values(w600=-0.01))
    with refused_input(subject=str(path), value=-0.01):
        _qe(path, Answers(negatives="zero"))


def test_many_gaps_are_one_defect_and_only_where_sensors_answer(tmp_path):
    path = tmp_path / "gaps.csv"
    at = [w for w in range(400, 1051, 2) if (w // 10) % 3]
    path.write_text("wavelength_nm,QE\n" + "".join(f"{w},0.5\n" for w in at))
    (defect,) = read_curves(path).defects
    assert defect.startswith("21 gaps, the widest from 418 to 430 nm")
    path.write_text(
        "wavelength_nm,QE\n200,0.1\n" + "".join(f"{w},0.5\n" for w in range(390, 1060, 10))
    )
    assert read_curves(path).defects == ()


QUESTIONS = [
    ("wavelength_nm,R,G", ()), ("wavelength_nm,QE", ()), ("Wavelength [nm],QE (%)", ()),
    ("nm,A", ("per", "level")), ("nm,sensitivity", ("per", "level")), ("nm,R [A/W]", ()),
    ("nm,relative QE", ("peak_qe",)),
]  # fmt: skip


@pytest.mark.parametrize(("heading", "abouts"), QUESTIONS)
@pytest.mark.parametrize("answers", [
    Answers(), Answers(per="photon"), Answers(level="absolute"), Answers(peak_qe=0.5),
    Answers(per="photon", level="absolute"), Answers(per="energy", peak_qe=0.3),
])  # fmt: skip
def test_a_preview_asks_exactly_where_a_sensor_is_refused(tmp_path, heading, abouts, answers):
    path = tmp_path / "curves.csv"
    columns = len(heading.split(",")) - 1
    factor = 100 if "%" in heading else 1
    path.write_text("\n".join([heading, *(
        ",".join([f"{w}", *[f"{factor * 0.3 * w / 1050}"] * columns]) for w in range(400, 1051, 10)
    )]))  # fmt: skip
    asked = {q.about for q in read_curves(path, answers=answers).questions}
    if answers == Answers():
        assert asked - {"quantity"} == set(abouts)
    try:
        read_sensor(path, DEFAULT_GRID, PAPER_PIXEL, answers=answers)
    except InputError:
        assert asked
    else:
        assert not asked


def test_light_per_wavenumber_is_refused_as_a_light(file):
    path = file("wavenumber [1/cm],power\n9000,1\n26000,1\n", "lamp.csv")
    with refused_input(subject=str(path), value="1/cm"):
        power_of(read_curves(path))


def test_a_description_in_an_ecsv_header_is_no_unit(file):
    path = file(
        "# %ECSV 1.0\n# ---\n# datatype:\n"
        "# - {name: wave, unit: nm, datatype: float64, description: 'original unit: um'}\n"
        "# - {name: QE, datatype: float64}\nwave QE\n400.0 0.1\n1050.0 0.2\n",
        "table.ecsv",
    )
    assert read_curves(path).curves.wavelength_nm.tolist() == [400.0, 1050.0]


@pytest.mark.parametrize("heading", ["wavelength,QE R,QE G", "wavelength,QE R [%],QE G [%]"])
def test_units_inside_the_cells_of_wavelengths_leave_the_heading(file, heading):
    factor = 100 if "%" in heading else 1
    path = file(
        f"{heading}\n400nm,{factor * 0.5},{factor * 0.25}\n1050nm,{factor * 0.25},0\n", "cells.csv"
    )
    result = read_curves(path)
    assert result.curves.names == ("QE R", "QE G")
    assert result.quantity == "QE"
    np.testing.assert_allclose(result.curves.values, [[0.5, 0.25], [0.25, 0.0]], rtol=1e-15)


def test_percent_of_one_column_is_not_that_of_another(file):
    path = file("wavelength_nm,QE G,error [%]\n400,0.5,2\n1050,0.5,2\n", "mixed.csv")
    result = read_curves(path)
    assert result.curves.values.ravel().tolist() == [0.5, 0.5]  # the error is a deviation
    path.write_text("wavelength_nm,QE G,T filter [%]\n400,0.5,90\n1050,0.5,90\n")
    with refused_input(subject=str(path), value=("T filter", "QE G"), setting="columns"):
        read_curves(path)
    path.write_text("wavelength_nm,QE R (0-100 lx)\n400,0.5\n1050,0.5\n")
    assert read_curves(path).curves.values.ravel().tolist() == [0.5, 0.5]
