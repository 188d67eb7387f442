"""`convert` and ``--table``: what is written is read back to the digit; ``--pixel`` is used."""

import csv
import json
import re

import numpy as np
import pytest

from chromanoise.io.result_tables import table_from_json
from chromanoise.io.sensor_files import sensor_from_json
from chromanoise.io.spectra import read_curves
from chromanoise.sensor import PAPER_PIXEL
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import sensor_named
from outcomes import refused

pytestmark = pytest.mark.usefixtures("here")


# ---- convert ----


def test_a_sensor_comes_back_from_its_own_json_to_the_digit_and_can_be_used_as_a_file(done, here):
    assert done("convert", "onyx-rgbw", "mine.json") == ("mine.json: written\n", "")
    ours = sensor_named("onyx-rgbw", DEFAULT_GRID)
    again = sensor_from_json((here / "mine.json").read_text())
    assert (again.qe == ours.qe).all()
    assert (again.mosaic, again.pixel, again.notes) == (ours.mosaic, ours.pixel, ours.notes)
    assert done("analyze", "mine.json", "--json", "-") == done(
        "analyze", "onyx-rgbw", "--json", "-"
    )


def test_a_sensor_of_the_catalog_that_asks_is_converted_with_the_answers(done, here):
    answers = ("--beyond", "zero", "--peak-qe", 0.6)
    done("convert", "ar0132at-rgbw", "x.csv", *answers)
    values = read_curves(here / "x.csv").curves.values
    # 5 nm means of the highest curve lie a little below its highest point
    assert 0.59 < values.max() <= 0.6
    done("convert", "ar0132at-rgbw", "y.csv", *answers[:-1], 0.3)
    np.testing.assert_allclose(read_curves(here / "y.csv").curves.values, values / 2, rtol=1e-12)


def test_no_file_hides_a_name_of_the_catalog_but_a_file_needs_no_ending(done, here):
    text = "wavelength_nm,A\n400,0.25\n1050,0.25\n"
    for name in ("onyx-rgbw", "mine"):
        (here / name).write_text(text)
        done("convert", name, f"{name}.csv", *(("--quantity", "QE") if name == "mine" else ()))
    assert read_curves(here / "onyx-rgbw.csv").curves.names == ("R", "G", "B", "W")
    assert (read_curves(here / "mine.csv").curves.values == 0.25).all()


def test_one_curve_comes_back_from_tm_27_to_the_digit(done, here):
    _, err = done("convert", "onyx-rgbw", "w.spdx", "--column", "W", "--created", "2026-01-31")
    ours = sensor_named("onyx-rgbw", DEFAULT_GRID)
    assert (read_curves(here / "w.spdx").curves.values[:, 0] == ours.qe[:, 3]).all()
    assert "<DocumentCreationDate>2026-01-31<" in (here / "w.spdx").read_text()
    for lost in ("pixel", "mosaic", "e-/photon", "R, G, B"):
        assert lost in err


def test_a_rawtoaces_camera_is_qe_times_wavelength_up_to_one_factor(done, here):
    (here / "cam.csv").write_text(
        "# quantity: QE [e-/photon]\nwavelength_nm,R,G,B,W\n400,0.1,0.2,0.4,0.5\n"
        "500,0.1,0.4,0.2,0.5\n600,0.3,0.1,0.1,0.5\n"
    )
    _, err = done("convert", "cam.csv", "cam.json", "--as", "rawtoaces")
    data = json.loads((here / "cam.json").read_text())
    assert data["spectral_data"]["data"]["main"]["400"] == pytest.approx([0.2, 0.4, 0.8])
    assert data["spectral_data"]["data"]["main"]["600"] == pytest.approx([0.9, 0.3, 0.3])
    assert data["header"]["model"] == "cam"
    assert "W" in err
    again = read_curves(here / "cam.json").curves  # a response per energy stays as it is
    done("convert", "cam.json", "again.json", "--as", "rawtoaces")
    assert (read_curves(here / "again.json").curves.values == again.values).all()


def test_a_date_makes_the_bytes_the_same_on_every_day(done, here):
    for name in ("a.json", "b.json"):
        done("convert", "onyx-rgb", name, "--as", "rawtoaces", "--created", "2026-01-31")
    assert (here / "a.json").read_bytes() == (here / "b.json").read_bytes()


# ---- --table ----


def test_a_table_of_analyze_holds_the_numbers_of_its_json(done, here):
    out, _ = done("analyze", "onyx-rgbw", "model-rgb", "--table", "t.json", "--json", "-")
    table = table_from_json((here / "t.json").read_text())
    heads = [column.name for column in table.columns]
    for row, result in zip(table.rows, json.loads(out)["sensors"], strict=True):
        cells = dict(zip(heads, row, strict=True))
        assert cells["sensor"] == result["name"]
        assert cells["SNR Y"] == result["color"]["snr_db"]["Y"]
        assert cells["time"] == pytest.approx(result["time_ms"], rel=1e-15)


def test_a_table_of_compare_has_a_row_per_value_and_one_of_matrix_a_row_per_coordinate(done, here):
    done("compare", "onyx-rgbw", "onyx-rgb", "--points", 4, "--table", "c.csv")
    rows = list(csv.reader((here / "c.csv").read_text().splitlines()))
    assert [len(rows), len(rows[0])] == [5, 5]
    out, _ = done("matrix", "onyx-rgbw", "--table", "m.csv", "--json", "-")
    rows = list(csv.reader((here / "m.csv").read_text().splitlines()))
    assert rows[0] == ["coordinate", *(f"{name} [lx/e-]" for name in "RGBW")]
    assert [row[0] for row in rows[1:]] == ["X", "Y", "Z"]
    result = np.array([[float(cell) for cell in row[1:]] for row in rows[1:]])
    assert (result == np.array(json.loads(out)["matrix"]["lux_per_e"])).all()


@pytest.mark.parametrize("command", ["analyze", "compare", "matrix"])
def test_the_ending_decides_the_form(done, here, command):
    few = ("--points", 2) if command == "compare" else ()
    for ending, part in ((".md", "**"), (".tex", r"\begin{table}"), (".CSV", ",")):
        done(command, "onyx-rgb", *few, "--table", f"t{ending}")
        assert part in (here / f"t{ending}").read_text()


# ---- --pixel ----


def sensor_told(done, *arguments):
    (data,) = json.loads(done("analyze", "onyx-rgbw", *arguments, "--json", "-")[0])["sensors"]
    return data, " | ".join(data["notes"])


@pytest.mark.parametrize(
    ("name", "text", "pixel"),
    [
        ("sheet.txt", "sigma_d = 3 e-\nmu_e.sat = 8000 e-\npixel pitch = 4 um", (4, 8000, 3, None)),
        ("sheet.json", '{"sigma_d": {"value": 3, "unit": "e-"}}', (10, 10_000, 3, None)),
        # S = 1 / (K range), O = ((read / K)^2 + 1/12) / range^2 with K = 2, range 200, read 40
        (
            "profile.json",
            '{"S": 0.0025, "O": 0.010002083333333333, "black_level_dn": 55, "white_level_dn": 255}',
            (10, 10_000, 40, 0.5),
        ),
        # variance = 0.5 (mean - 100) + 4 + 1/12: K = 0.5 DN/e-, read noise 2 / 0.5 = 4 e-
        (
            "transfer.csv",
            "mean_dn,variance_dn2,light\n100,4.083333333333333,dark\n"
            + "\n".join(
                f"{100 + m},{0.5 * m + 4.083333333333333},light" for m in range(50, 2000, 150)
            ),
            (10, 10_000, 4, 0.5),
        ),
    ],
)
def test_the_pixel_of_a_file_is_used_where_the_file_tells_it(done, here, name, text, pixel):
    (here / name).write_text(text)
    with_file, notes = sensor_told(done, "--pixel", name)
    names = ("--pitch-um", "--full-well-e", "--read-noise-e", "--gain-dn-per-e")
    limited = (pixel[0], 400, *pixel[2:])  # codes of the profile end at 200 DN of 2 e-
    options = zip(names, limited if name == "profile.json" else pixel, strict=True)
    typed, _ = sensor_told(done, *(w for option in options if option[1] for w in option))
    for part in ("channels", "color"):
        assert rounded(with_file[part]) == rounded(typed[part])
    silent = [
        key
        for key, own, now in zip(
            ("pitch_um", "full_well_e", "read_noise_e"),
            (10.0, 10_000.0, 10.0),
            pixel[:3],
            strict=True,
        )
        if own == now
    ]
    if silent:
        assert ", ".join(silent) in notes


def rounded(result):
    """Nested data with its numbers to 9 digits."""
    text = json.dumps(result)
    return re.sub(r"-?\d+\.\d+(?:e-?\d+)?", lambda m: f"{float(m[0]):.9g}", text)


def test_a_number_that_is_given_wins_over_the_file_and_the_note_says_so(done, here):
    (here / "p.txt").write_text("sigma_d = 3 e-\nmu_e.sat = 8000 e-\nPRNU = 1 %")
    result, notes = sensor_told(done, "--pixel", "p.txt", "--read-noise-e", 5)
    typed, _ = sensor_told(done, "--full-well-e", 8000, "--read-noise-e", 5, "--prnu", 0.01)
    assert result["color"] == typed["color"]
    assert any("read_noise_e" in note and "p.txt" in note for note in notes.split(" | "))
    assert any("prnu" in note and "p.txt" in note for note in notes.split(" | "))
    other, _ = sensor_told(done, "--pixel", "p.txt", "--read-noise-e", 5, "--prnu", 0)
    typed, _ = sensor_told(done, "--full-well-e", 8000, "--read-noise-e", 5)
    assert other["color"] == typed["color"]


def test_every_command_that_takes_sensors_takes_the_pixel_of_a_file_and_never_overwrites_it(
    run, done, here
):
    (here / "p.json").write_text('{"sigma_d": {"value": 3, "unit": "e-"}}')
    for asked in (("matrix", "onyx-rgb"), ("compare", "onyx-rgb", "--points", 2)):
        done(*asked, "--pixel", "p.json")
        taken = run(*asked, "--pixel", "p.json", "--json", "p.json")
        refused(taken, subject="--json", value="p.json")
    done("simulate", "builtin:checker", "--sensor", "onyx-rgb", "--pixel", "p.json", "-o", "o")
    assert PAPER_PIXEL.read_noise_e == 10  # so that 3 is the file's
    data = json.loads((here / "o" / "summary.json").read_text())["pictures"][0]
    assert any("read_noise_e" in note and "p.json" in note for note in data["notes"])
