"""Files of instruments: each is read as its true curve, or refused in one sentence."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings, strategies as st

from chromanoise.io.spectra import Answers, qe_of, read_curves
from chromanoise.study.resolve_names import resolve_filter, resolve_illuminant
from outcomes import refused_input
from spectrum_samples import Written, asd_bytes, asdf_lines, jcamp_block, written_files

WRITTEN = written_files()


def saved(folder, content, name="a.jdx"):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def lines_of(*blocks):
    return "\n".join(line for block in blocks for line in block) + "\n"


def refused_text(path, **fields):
    with refused_input(subject=str(path), **fields):
        read_curves(path)


@pytest.mark.parametrize("file", WRITTEN, ids=lambda file: file.maker)
def test_a_file_of_an_instrument_is_read_as_its_true_curve(tmp_path, file: Written):
    for name, content in file.beside.items():
        saved(tmp_path, content, name)
    read = read_curves(saved(tmp_path, file.content, file.name), answers=Answers(**file.answers))
    assert len(read.curves.names) == 1
    assert read.curves.wavelength_nm == pytest.approx(file.wavelength_nm, rel=1e-12)
    assert read.curves.values[:, 0] == pytest.approx(file.values, rel=1e-12)
    assert read.merged == 0


def test_the_table_has_300_files_of_more_than_15_instruments():
    assert len(WRITTEN) >= 300
    assert len({file.maker for file in WRITTEN}) >= 25
    assert len({file.content for file in WRITTEN}) >= 300


# tables


ROWS = [(at, round(0.1 + at % 7 / 10, 3)) for at in range(400, 1060, 50)]
TABLE = [f"{at},{value}" for at, value in ROWS]


@pytest.mark.parametrize("after", [">>>>>End", "[EndOfFile]", "end of data,1", "PFD,1\nPPFD,2"])
def test_text_after_the_numbers_is_not_used_and_noted(tmp_path, after):
    text = "\n".join(["nm,T", *TABLE, after])
    read = read_curves(saved(tmp_path, text, "a.csv"))
    assert read.curves.values[:, 0].tolist() == [value for _, value in ROWS]
    assert any("text after the numbers" in note for note in read.notes)


@pytest.mark.parametrize("between", [">>>>>End", "[EndOfFile]", "end of data,1", "7oo,0.1"])
def test_text_between_numbers_is_refused_with_its_line(tmp_path, between):
    text = "\n".join(["nm,T", *TABLE[:5], between, *TABLE[5:]])
    refused_text(saved(tmp_path, text, "a.csv"), where="line 7, column 'nm'")


def test_a_faulty_last_row_is_no_text_after_the_numbers(tmp_path):
    text = "\n".join(["nm,T", *TABLE, "11oo,0.1"])
    refused_text(saved(tmp_path, text, "a.csv"), value="11oo")


@pytest.mark.parametrize(("heading", "row"), [
    ("angle,wavelength,T", "{k},{at},{value}"), ("R,wavelength,T", "0.{k},{at},{value}"),
])  # fmt: skip
def test_columns_before_the_wavelengths_that_may_be_curves_are_refused(tmp_path, heading, row):
    rows = [row.format(k=k, at=at, value=value) for k, (at, value) in enumerate(ROWS)]
    refused_text(saved(tmp_path, "\n".join([heading, *rows]), "a.csv"), value="wavelength")


def test_row_numbers_other_axes_and_words_are_no_curves_and_noted(tmp_path):
    rows = [f"{k},{at},{1e7 / at:.1f},{v},,a word" for k, (at, v) in enumerate(ROWS)]
    text = "\n".join(["Pixel,Wavelength (nm),Wavenumber,T,Absorbance,Remark", *rows])
    read = read_curves(saved(tmp_path, text, "a.csv"))
    assert read.curves.names == ("T",)
    assert read.curves.values[:, 0].tolist() == [value for _, value in ROWS]
    for name in ("Pixel", "Wavenumber", "Absorbance", "Remark"):
        assert any(repr(name) in note for note in read.notes)


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.permutations(ROWS))
def test_points_clicked_in_any_order_are_the_sorted_curve(tmp_path, points):
    steps = [b[0] - a[0] for a, b in pairwise(points)]
    falls, rises = (sum(sign * step > 0 for step in steps) for sign in (-1, 1))
    assume(min(falls, rises) not in (1, 2))  # two or three whole lists are several curves
    text = "\n".join(f"{at + 0.5}, {value}" for at, value in points)
    read = read_curves(saved(tmp_path, text, "a.csv"))
    assert read.wavelength_unit == "nm"
    assert read.curves.values[:, 0].tolist() == [value for _, value in ROWS]
    assert any("sorted" in note for note in read.notes) == (falls > 0 and rises > 0)


@pytest.mark.parametrize("falls", [False, True])
@pytest.mark.parametrize("shift", [0, 3])
def test_whole_lists_of_wavelengths_that_follow_each_other_are_curves_and_not_averaged(
    tmp_path, shift, falls
):
    rows = ROWS[::-1] if falls else ROWS
    first, second = ([f"{at + k * shift},{v + k}" for at, v in rows] for k in (0, 1))
    read = read_curves(saved(tmp_path, "\n".join(["nm,T", *first, *second]), "a.csv"))
    assert read.curves.names == ("T (1)", "T (2)")
    assert read.merged == 0
    at = read.curves.wavelength_nm == 700 if shift == 0 else read.curves.wavelength_nm == 703
    assert read.curves.values[at, 1] == pytest.approx([ROWS[6][1] + 1], rel=1e-12)
    assert any("listed 2 times" in note for note in read.notes)


def test_overlapping_spectrometers_of_one_curve_stay_one_curve(tmp_path):
    visible = [(at, at / 2000) for at in range(350, 1001, 10)]
    infrared = [(at, at / 2000) for at in range(955, 2500, 10)]
    text = "\n".join(["nm,R", *(f"{at},{value}" for at, value in visible + infrared)])
    read = read_curves(saved(tmp_path, text, "a.csv"))
    assert read.curves.names == ("R",)
    assert read.curves.values[:, 0] == pytest.approx(read.curves.wavelength_nm / 2000, rel=1e-12)


@pytest.mark.parametrize("heading", ["Absorbance", "A [absorbance]", "Optical density"])
def test_absorbances_are_never_taken_for_transmittances(tmp_path, heading):
    path = saved(tmp_path, "\n".join([f"nm,{heading}", *TABLE]), "a.csv")
    refused_text(path, value=heading)
    both = saved(tmp_path, "\n".join([f"nm,{heading},T", *(f"{r},0.5" for r in TABLE)]), "b.csv")
    assert len(read_curves(both).curves.names) == 2
    assert read_curves(both, answers=Answers(columns=("T",))).curves.names == ("T",)


def test_wavelengths_in_pairs_keep_the_unit_of_their_headings(tmp_path):
    rows = [f"{at / 1000},{value},{at / 1000},{1 - value}" for at, value in ROWS]
    text = "\n".join(["R,,G,", "Wavelength (um),T,Wavelength (um),T", *rows])
    read = read_curves(saved(tmp_path, text, "a.csv"))
    assert (read.wavelength_unit, read.curves.names) == ("um", ("R", "G"))
    assert read.curves.wavelength_nm.tolist() == [at for at, _ in ROWS]


@pytest.mark.parametrize(("heading", "printed"), [
    ("Wavelength (nm)", lambda nm: nm), ("Wavelength (µm)", lambda nm: nm / 1000),
    ("Wavelength (Å)", lambda nm: 10 * nm), ("Wavenumber (cm-1)", lambda nm: 1e7 / nm),
    ("wavenumber [1/cm]", lambda nm: 1e7 / nm),
])  # fmt: skip
def test_every_unit_of_wavelengths_gives_the_same_curve(tmp_path, heading, printed):
    rows = [f"{printed(at)!r}\t{value}" for at, value in ROWS]
    read = read_curves(saved(tmp_path, "\n".join([f"{heading}\tT", *rows]), "a.txt"))
    assert read.curves.wavelength_nm == pytest.approx([at for at, _ in ROWS], rel=1e-12)
    assert read.curves.values[:, 0].tolist() == [value for _, value in ROWS]


@pytest.mark.parametrize("unit", ["eV", "THz"])
def test_energies_and_frequencies_are_refused(tmp_path, unit):
    rows = [f"{1239.841984 / at:.6f}\t{value}" for at, value in ROWS]
    path = saved(tmp_path, "\n".join([f"Energy ({unit})\tT", *rows]), "a.txt")
    refused_text(path, value=unit)


# JCAMP-DX


@pytest.mark.parametrize("line", ["1 2 3 3 2 1 0 -1 -2 -3", "1+2+3+3+2+1+0-1-2-3", "1BCCBA@abc",
                                  "1JJ%jjjjjj", "1JT%jX"])  # fmt: skip
def test_the_printed_example_of_the_forms_of_jcamp_is_decoded(tmp_path, line):
    # McDonald & Wilks, Appl. Spectrosc. 42, 151 (1988): 1 2 3 3 2 1 0 -1 -2 -3 in five forms
    block = jcamp_block("a", [f"400 {line}"], 10, FIRSTX="400", LASTX="490", YUNITS="COUNTS")
    read = read_curves(saved(tmp_path, lines_of(block)))
    assert read.curves.wavelength_nm.tolist() == list(range(400, 500, 10))
    assert read.curves.values[:, 0].tolist() == [1, 2, 3, 3, 2, 1, 0, -1, -2, -3]


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.lists(st.integers(-99_999, 99_999), min_size=2, max_size=60),
    st.sampled_from(["AFFN", "PAC", "SQZ", "DIF", "DIFDUP"]),
    st.integers(1, 9),
    st.sampled_from([-7, 5]),
)
def test_every_form_of_jcamp_holds_the_same_numbers(tmp_path, numbers, form, per_line, step):
    lines = asdf_lines(numbers, 900, step, form, per_line)
    last = 900 + step * (len(numbers) - 1)
    facts = {"FIRSTX": "900", "LASTX": str(last), "YFACTOR": "0.5", "YUNITS": "COUNTS"}
    block = jcamp_block("a", lines, len(numbers), **facts)
    read = read_curves(saved(tmp_path, lines_of(block)))
    rising = numbers if step > 0 else numbers[::-1]
    assert read.curves.values[:, 0].tolist() == [number / 2 for number in rising]


def three_blocks(**changes):
    rows = [f"{at}, {value}" for at, value in ROWS]
    blocks = [
        jcamp_block(title, rows, len(rows), form="(XY..XY)", **{"YUNITS": "COUNTS", **changes})
        for title in ("SAMPLE", "DARK", "REFERENCE")
    ]
    return lines_of(["##TITLE= EXPORT", "##DATA TYPE= LINK", "##BLOCKS= 3"], *blocks, ["##END="])


def test_the_blocks_of_a_jcamp_file_are_curves_named_by_their_titles(tmp_path):
    path = saved(tmp_path, three_blocks())
    read = read_curves(path)
    assert read.curves.names == ("SAMPLE", "DARK", "REFERENCE")
    assert read.merged == 0
    titles = r"SAMPLE, DARK, REFERENCE"
    with refused_input(subject=str(path), setting="columns", requirement=titles):
        resolve_illuminant(str(path), answers=Answers(quantity="power", per="energy"))
    with refused_input(subject=str(path), setting="columns", requirement=titles):
        qe_of(read, Answers())
    with refused_input(subject=str(path), value=("SAMPLE", "DARK", "REFERENCE")):
        resolve_filter(str(path))
    chosen = Answers(quantity="power", per="energy", columns=("SAMPLE",), beyond="hold")
    lamp = resolve_illuminant(str(path), answers=chosen)
    ratio = lamp.irradiance[lamp.grid.wavelength_nm == 450] / lamp.irradiance[0]
    assert ratio == pytest.approx(ROWS[1][1] / ROWS[0][1], rel=1e-12)


def test_blocks_of_one_title_are_numbered(tmp_path):
    rows = [f"{at}, {value}" for at, value in ROWS]
    block = jcamp_block("a", rows, len(rows), form="(XY..XY)")
    assert read_curves(saved(tmp_path, lines_of(block, block))).curves.names == ("a (1)", "a (2)")


def test_the_pages_of_ntuples_are_curves(tmp_path):
    text = "\n".join([
        "##TITLE= cell", "##JCAMP-DX= 5.01", "##DATA TYPE= UV/VIS SPECTRUM", "##NTUPLES= UV/VIS",
        "##VAR_NAME= WAVELENGTH, TRANSMITTANCE, TIME", "##SYMBOL= X, Y, T",
        "##VAR_DIM= 4, 4, 2", "##UNITS= NANOMETERS, TRANSMITTANCE, SECONDS",
        "##FIRST= 400, 0.1, 1", "##LAST= 700, 0.4, 2", "##FACTOR= 1, 0.01, 1",
        "##PAGE= T=1", "##DATA TABLE= (X++(Y..Y)), XYDATA", "400 10 20 30 40",
        "##PAGE= T=2", "##DATA TABLE= (X++(Y..Y)), XYDATA", "400A1B1C1D1", "##END NTUPLES= UV/VIS",
        "##END=",
    ])  # fmt: skip
    read = read_curves(saved(tmp_path, text))
    assert read.curves.names == ("cell, T=1", "cell, T=2")
    assert read.curves.wavelength_nm.tolist() == [400, 500, 600, 700]
    assert (
        pytest.approx(np.array([[10, 20, 30, 40], [11, 21, 31, 41]]) / 100) == read.curves.values.T
    )


EQUAL = {"FIRSTX": "400", "LASTX": "440"}


@pytest.mark.parametrize(("lines", "changes", "fields"), [
    (["400 1 2 3 4"], {}, {"value": 4}), (["400 1 2 3 4 5 6"], {}, {"value": 6}),
    (["400 1 2 3", "450 4 5"], {}, {"where": "line 12", "value": 450.0}),
    (["400A%%", "420B%%"], {}, {"where": "line 12", "value": 2.0}),
    (["400 1 2 x 4 5"], {}, {"where": "line 11"}), (["400 T 2 3 4 5"], {}, {"where": "line 11"}),
    (["400 J 2 3 4 5"], {}, {"where": "line 11"}), (["word 1 2"], {}, {"where": "line 11"}),
    (["400 1 2 3 4 5"], {"LASTX": "high"}, {"value": "high"}),
    (["400 1 2 3 4 5"], {"YUNITS": "ABSORBANCE"}, {"value": "a [ABSORBANCE]"}),
    (["400 1 2 3 4 5"], {"XUNITS": "HZ"}, {"value": "HZ"}),
    (["400 1 2 3 4 5"], {"XUNITS": "ARBITRARY UNITS"}, {"value": "ARBITRARY UNITS"}),
    (["400 1 2 3 4 5"], {"form": "(XY..XY)"}, {}), (["400, 1"], {"form": "(XYA)"}, {}),
    (["400 AZZZZZZ"], {}, {}),
])  # fmt: skip
def test_a_jcamp_file_that_contradicts_itself_is_refused(tmp_path, lines, changes, fields):
    block = jcamp_block("a", lines, 5, **{**EQUAL, **changes})
    refused_text(saved(tmp_path, lines_of(block)), **fields)


def test_a_jcamp_file_of_a_structure_or_of_peaks_is_refused(tmp_path):
    text = "##TITLE= a\n##JCAMP-CS= 3.7\n##ATOMLIST= \n1 C\n##PEAK TABLE= (XY..XY)\n1,2\n##END=\n"
    refused_text(saved(tmp_path, text), requirement="XYDATA or XYPOINTS")


# ASD


VALUES = np.linspace(0.1, 0.9, 29)


def test_raw_counts_of_asd_are_two_curves_and_never_divided(tmp_path):
    content = asd_bytes(b"as7", 0, 2, VALUES * 1000, VALUES * 0 + 2000)
    read = read_curves(saved(tmp_path, content, "a.asd"))
    assert read.curves.names == ("spectrum", "white reference")
    assert read.curves.values[:, 1].tolist() == [2000.0] * 29
    assert read.quantity is None


@pytest.mark.parametrize("content", [
    *(asd_bytes(b"as7", kind, 2, VALUES) for kind in (2, 4, 8)),
    asd_bytes(b"as7", 77, 2, VALUES), asd_bytes(b"as7", 1, 2, VALUES)[:-1],
    asd_bytes(b"as7", 1, 2, VALUES)[:300], asd_bytes(b"as7", 1, 2, VALUES, VALUES)[:-1],
    asd_bytes(b"as7", 1, 2, VALUES, step_nm=float("nan")), asd_bytes(b"as7", 1, 2, VALUES[:1]),
], ids=range(9))  # fmt: skip
def test_asd_of_another_quantity_or_cut_short_is_refused(tmp_path, content):
    refused_text(saved(tmp_path, content, "a.asd"))


@pytest.mark.parametrize(("changes", "field"), [
    ({"S_a": [[400, 5, 9]]}, "value"), ({"S_a": [[400, 0, 4]]}, "where"),
    ({"T_b": [[1.0, 2.0]]}, "value"),
])  # fmt: skip
def test_psychtoolbox_arrays_that_do_not_fit_are_refused(tmp_path, changes, field):
    from scipy.io import savemat

    arrays = {"S_a": [[400, 5, 4]], "T_a": np.ones((2, 4))}
    for version in ("4", "5"):
        path = tmp_path / f"{version}.mat"
        savemat(path, {**arrays, **changes}, format=version)
        with refused_input(subject=str(path)) as refused:
            read_curves(path)
        assert getattr(refused.value, field)
