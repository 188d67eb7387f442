"""Color matrices in files: what is written others and we read, and a strange file is refused."""

import csv
import json
import struct
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
import tifffile

import chromanoise as cn
from chromanoise.color import kernel_matrix
from chromanoise.io.matrix_files import (
    MadeMatrix,
    balanced,
    is_matrix_file,
    matrix_clf,
    read_matrix,
)
from chromanoise.noise import Exposure, expected_electrons
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import color_snr_db, sensor_named
from outcomes import refused_input

SENSOR = "onyx-rgb-ircut"
EXPOSURE, TIME = Exposure(time_s=0.0119), ("--time-ms", "11.9")


@pytest.fixture
def exported(tmp_path, run):
    def written(ending, *options, sensor=SENSOR):
        path = tmp_path / f"m.{ending}"
        code, _, err = run("matrix", sensor, "--lux", "10", *options, "--export", str(path))
        assert code == 0, err
        return path

    return written


def first(matrix, **settings):
    return cn.analyze(SENSOR, lux=10, matrix=matrix, **settings).to_dict()["sensors"][0]


@pytest.mark.parametrize("ending", ["csv", "json"])
def test_a_matrix_in_lux_per_electron_comes_back_to_the_last_digit(exported, ending):
    path = exported(ending, "--matrix", "lmmse")
    again, made = first(str(path)), first("lmmse")
    assert again["matrix"] == made["matrix"]
    assert again["color"]["snr_db"] == made["color"]["snr_db"]


@pytest.mark.parametrize("ending", ["csv", "json", "clf", "dcp.json"])
def test_a_result_exports_the_file_of_the_command(exported, tmp_path, ending):
    own = tmp_path / f"own.{ending}"
    assert cn.matrix(SENSOR, lux=10).export(own) == own
    assert own.read_bytes() == exported(ending).read_bytes()


def test_a_matrix_is_not_exported_to_a_file_of_an_unknown_ending(tmp_path):
    with refused_input(value="own.txt", subject="path"):
        cn.matrix(SENSOR, lux=10).export(tmp_path / "own.txt")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("ending", ["clf", "dcp.json"])
def test_a_balanced_matrix_comes_back_to_the_last_digit(exported, ending):
    own = json.loads(exported("json").read_text())["balanced"]
    read = read_matrix(exported(ending))
    assert read.values.tolist() == own
    assert first(str(exported(ending)))["color"]["snr_db"]["Y"] == pytest.approx(
        first("kernel")["color"]["snr_db"]["Y"], abs=1e-9
    )


def test_a_matrix_made_for_another_time_gives_the_same_colors(exported):
    path = exported("csv", "--time-ms", "20")
    short = first(str(path), time_ms=10.0)
    assert short["color"]["mean_lux"] == pytest.approx(
        first("kernel", time_ms=10.0)["color"]["mean_lux"], rel=1e-12
    )


def test_a_row_normalized_matrix_to_srgb_keeps_white(file):
    # identity on white-balanced raw: the white is the white of sRGB, so X, Y, Z of the light
    path = file("to linear sRGB,R,G,B\nR,1,0,0\nG,0,1,0\nB,0,0,1\n", "isp.csv")
    lux = first(str(path))["color"]["mean_lux"]
    white = cn.color.scene_xyz(cn.noise.white_scene(cn.analyze(SENSOR, lux=10).points[0]))
    assert list(lux.values()) == pytest.approx(white.tolist(), rel=2e-4)  # sRGB's published digits


def test_columns_in_another_order_are_put_in_that_of_the_sensor(exported, file):
    rows = [line.split(",") for line in exported("csv").read_text().splitlines() if line[0] != "#"]
    swapped = file("\n".join(",".join([r[0], r[3], r[1], r[2]]) for r in rows), "swapped.csv")
    own = first(str(exported("csv")))["matrix"]
    assert first(str(swapped))["matrix"] == own


def tiff_profile(matrix, kelvin_code=21, order="<"):
    """The smallest DCP: ColorMatrix1 as signed rationals, and its illuminant."""
    numbers = [round(v * 10_000) for v in np.ravel(matrix)]
    data = b"".join(struct.pack(order + "ii", n, 10_000) for n in numbers)
    entries = struct.pack(order + "HHII", 50721, 10, len(numbers), 38)
    entries += struct.pack(order + "HHIHH", 50778, 3, 1, kelvin_code, 0)
    magic = b"IIRC" if order == "<" else b"MMCR"
    head = magic + struct.pack(order + "I", 8) + struct.pack(order + "H", 2) + entries
    return head + struct.pack(order + "I", 0) + data


def two_lights(codes, order="<"):
    """A DCP of the identity and of twice the identity, with the codes of their lights."""
    entries, data, place = b"", b"", 8 + 2 + 12 * 4 + 4
    for tag, scale in ((50721, 1), (50722, 2)):
        entries += struct.pack(order + "HHII", tag, 10, 9, place + len(data))
        data += b"".join(struct.pack(order + "ii", int(scale * v), 1) for v in np.eye(3).ravel())
    for tag, code in zip((50778, 50779), codes, strict=True):
        entries += struct.pack(order + "HHIHH", tag, 3, 1, code, 0)
    head = b"IIRC" + struct.pack(order + "I", 8) + struct.pack(order + "H", 4) + entries
    return head + struct.pack(order + "I", 0) + data


@pytest.mark.parametrize(
    ("codes", "used", "other", "scale"),
    [
        ((17, 21), "ColorMatrix2 (D65, 6504 K)", "ColorMatrix1 (A, 2856 K)", 2),
        ((21, 17), "ColorMatrix1 (D65, 6504 K)", "ColorMatrix2 (A, 2856 K)", 1),
        ((17, 255), "ColorMatrix1 (A, 2856 K)", "ColorMatrix2 (unknown light)", 1),
    ],
)
def test_of_two_matrices_of_a_profile_a_note_names_the_used_and_the_unused(
    file, codes, used, other, scale
):
    path = file(two_lights(codes), "two.dcp")
    read = read_matrix(path)
    assert read.values.tolist() == (scale * np.eye(3)).tolist()
    (note,) = read.notes
    assert f"{used} is used; {other} is not used" in note
    # the result repeats the note, for any light
    for illuminant in ("A", "E"):
        (one,) = cn.analyze(SENSOR, matrix=str(path), illuminant=illuminant).analyses
        assert note in one.matrix.notes


def test_of_two_matrices_of_a_profile_in_json_a_note_names_the_unused(tmp_path):
    path = tmp_path / "two.json"
    held = {"ColorMatrix1": np.eye(3).tolist(), "ColorMatrix2": (2 * np.eye(3)).tolist()}
    path.write_text(json.dumps(held | {"CalibrationIlluminant1": "StdA"}))
    (note,) = read_matrix(path).notes
    assert "ColorMatrix1 (StdA) is used; ColorMatrix2 (unknown light) is not used" in note


def test_a_profile_of_one_matrix_has_no_such_note(file):
    path = file(tiff_profile(np.eye(3)), "one.dcp")
    assert read_matrix(path).notes == ()


@pytest.mark.parametrize("order", "<>")
def test_the_matrix_of_a_dcp_is_inverted_and_scaled_to_the_luminance_of_the_white(file, order):
    matrix = [[0.9, -0.3, -0.05], [-0.4, 1.2, 0.2], [-0.05, 0.15, 0.6]]
    path = file(tiff_profile(matrix, order=order), "a.dcp")
    read = read_matrix(path)
    assert read.values.tolist() == matrix
    assert read.kelvin == 6504
    message = first(str(path))
    assert message["color"]["mean_lux"]["Y"] == pytest.approx(10.0, rel=1e-3)
    product = np.array(matrix) @ message["matrix"]
    assert product / product[0, 0] == pytest.approx(np.eye(3), abs=1e-12)


def test_the_color_matrix_of_our_dng_is_that_which_tifffile_reads(tmp_path, done):
    out = tmp_path / "out"
    words = ("simulate", "builtin:checker", "--sensor", SENSOR, "--mosaic", "bayer", "--raw-only")
    done(*words, "-o", str(out))
    with tifffile.TiffFile(out / f"{SENSOR}.dng") as file:
        numbers = np.array(file.pages[0].tags[50721].value).reshape(-1, 2)
    theirs = (numbers[:, 0] / numbers[:, 1]).reshape(3, 3)
    own = read_matrix(out / f"{SENSOR}.dng")
    assert own.values.tolist() == theirs.tolist()
    made = first("kernel")
    through_dng = first(str(out / f"{SENSOR}.dng"))
    assert through_dng["color"]["snr_db"]["Y"] == pytest.approx(
        made["color"]["snr_db"]["Y"], abs=1e-3
    )


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("lx/e-,R,G\nX,1,2\nY,1,2\nZ,1,2\n", {"value": (3, 2)}),
        ("lx/e-,R,G,W\nX,1,2,3\nY,1,2,3\nZ,1,2,3\n", {"value": ("R", "G", "W")}),
        ("lx/e-,R,G,B\nL,1,2,3\nM,1,2,3\nS,1,2,3\n", {"value": ["L", "M", "S"]}),
        ("lx/e-,R,G,B\nX,1,nan,3\nY,1,2,3\nZ,1,2,3\n", {}),
        ("lx/e-,R,G,B\nX,1,x,3\nY,1,2,3\nZ,1,2,3\n", {}),
        ("hello", {"value": 1}),
        ("{}", {"value": []}),
        ("<a/>", {"value": 0}),
        ('<!DOCTYPE a [<!ENTITY b "c">]><a/>', {}),
        ('<a><b inBitDepth="8i"><Array/></b></a>', {"value": ["8i", "None"]}),
        ('{"matrix_lux_per_e": [[1, 0]], "channels": 5}', {"value": 5}),
        ("lx/e-,R,G,B\nX," + 200_000 * "1" + "\nY\nZ\n", {}),
    ],
)
def test_a_file_without_a_matrix_for_the_sensor_is_refused(file, text, fields):
    path = file(text, "m.csv")
    with refused_input(**fields):
        first(str(path))


def test_a_damaged_profile_and_a_missing_file_are_refused(tmp_path):
    path = tmp_path / "a.dcp"
    for cut in (4, 9, 20, 40, 60):
        path.write_bytes(tiff_profile(np.eye(3))[:cut])
        with refused_input():
            first(str(path))
    path.write_bytes(tiff_profile(np.ones(7)))
    with refused_input():
        first(str(path))
    with refused_input(value="none.csv"):
        first("none.csv")


@pytest.mark.parametrize("count", [0, 4, 10])
def test_a_profile_without_three_numbers_per_channel_is_refused(tmp_path, count):
    path = tmp_path / "a.dcp"
    entry = struct.pack("<HHIII", 50721, 10, count, 26, 0)
    path.write_bytes(b"II*\0" + struct.pack("<IH", 8, 1) + entry + struct.pack("<ii", 1, 2) * 12)
    with refused_input(subject=str(path), value=count):
        read_matrix(path)


@pytest.mark.parametrize(
    ("data", "fields"),
    [
        ({"channels": 5, "balanced": [[1, 2, 3]] * 3}, {"value": 5}),
        ({"channels": None, "balanced": [[1, 2, 3]] * 3}, {"value": None}),
        ({"balanced": [[[1, 2], [3, 4]]] * 3}, {"value": (3, 2, 2)}),
        ({"balanced": [[], [], []]}, {"value": (3, 0)}),
        (
            {"matrix_lux_per_e": [[1, 2, 3]] * 3, "time_ms": 0, "f_number": 2, "pitch_um": 3},
            {"value": 0.0},
        ),
    ],
)
def test_json_that_is_no_matrix_of_channels_is_refused(file, data, fields):
    path = file(json.dumps(data), "a.json")
    with refused_input(**fields):
        read_matrix(path)


def test_the_ending_tells_a_file_from_a_method():
    assert not any(map(is_matrix_file, cn.study.METHODS))
    assert not is_matrix_file("ridge=0.01")


def test_a_study_names_its_matrix_beside_itself(tmp_path, exported, done):
    path = exported("csv")
    study = tmp_path / "sub" / "s.toml"
    study.parent.mkdir()
    path.rename(study.parent / "m.csv")
    study.write_text(
        f'matrices = ["m.csv"]\n[light]\nlevel_lux = 10.0\n[[sensors]]\nname = "{SENSOR}"\n'
    )
    done("run", str(study), "-o", str(tmp_path / "out"))


def test_a_matrix_of_another_observer_is_refused(exported):
    path = exported("json", "--observer", "cie-1964-10")
    with refused_input(value="cie-1964-10"):
        first(str(path))
    again = first(str(path), observer="cie-1964-10")
    assert again["matrix"] == first("kernel", observer="cie-1964-10")["matrix"]


def notes_of(sensor, matrix, **settings):
    (one,) = cn.analyze(sensor, matrix=str(matrix), **settings).analyses
    return one.matrix.notes


def test_a_matrix_made_for_another_sensor_light_or_level_says_so(exported):
    path = exported("csv")
    assert notes_of(SENSOR, path, lux=10) == ()
    for sensor, settings in (
        ("onyx-rgb", {"lux": 10}),
        (SENSOR, {"lux": 10, "illuminant": "A"}),
        (SENSOR, {"lux": 11}),
    ):
        note, *_ = notes_of(sensor, path, **settings)
        assert str(path) in note
        assert SENSOR in note
        assert "10 lx" in note


def test_a_matrix_of_rank_one_says_so(file):
    path = file("1,0,0\n1,0,0\n1,0,0\n", "gray.csv")
    (note,) = notes_of(SENSOR, path, lux=10)
    assert "rank 1" in note


@pytest.mark.parametrize(("gain", "noted"), [(1.0, False), (1.9, False), (3.0, True), (0.3, True)])
def test_a_matrix_of_another_scale_says_so_and_changes_no_snr(file, gain, noted):
    path = file(f"{gain},0,0\n0,{gain},0\n0,0,{gain}\n", "scaled.csv")
    (one,) = cn.analyze(SENSOR, matrix=str(path), lux=10).analyses
    assert any("perfect white of 10 lx" in note for note in one.matrix.notes) == noted
    path.write_text("1,0,0\n0,1,0\n0,0,1\n", encoding="utf-8")
    (plain,) = cn.analyze(SENSOR, matrix=str(path), lux=10).analyses
    assert color_snr_db(one) == pytest.approx(color_snr_db(plain))


def test_an_option_that_is_given_twice_is_refused(run):
    code, out, err = run("analyze", SENSOR, "--matrix", "lmmse", "--matrix", "kernel")
    assert (code, out) == (2, "")
    assert "--matrix" in err


# other programs read what the library says


def made(name):
    white = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
    sensor = sensor_named(name, DEFAULT_GRID)
    white_e = expected_electrons(white, sensor, EXPOSURE)
    matrix = kernel_matrix(sensor, EXPOSURE)
    return MadeMatrix(
        sensor=name,
        illuminant="E",
        level_lux=10.0,
        time_s=EXPOSURE.time_s,
        f_number=EXPOSURE.f_number,
        pitch_um=sensor.pixel.pitch_um,
        matrix=matrix,
        white_e=white_e,
        white_lux=float(matrix.matrix[1] @ white_e),
        notes=sensor.notes,
    )


def test_the_balanced_matrix_sends_the_balanced_white_to_a_luminance_of_one():
    assert balanced(made("onyx-rgbw"))[1].sum() == pytest.approx(1.0, abs=1e-12)


def test_csv_and_json_hold_every_digit(exported):
    data = json.loads(exported("json", *TIME, sensor="onyx-rgbw").read_text())
    lines = exported("csv", *TIME, sensor="onyx-rgbw").read_text().splitlines()
    facts = dict(line[2:].split(": ", 1) for line in lines if line.startswith("#"))
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    ours = made("onyx-rgbw").matrix.matrix
    assert data["matrix_lux_per_e"] == ours.tolist()
    assert rows[0] == ["lx/e-", "R", "G", "B", "W"]
    assert [[float(cell) for cell in row[1:]] for row in rows[1:]] == ours.tolist()
    assert "reconstruction" in data["notes"]
    for name, value in (("f_number", 1.8), ("pitch_um", 10.0)):
        assert data[name] == float(facts[name]) == value


def test_clf_is_well_formed_and_holds_the_balanced_matrix(exported):
    root = ElementTree.fromstring(exported("clf", *TIME).read_text())
    space = {"clf": "urn:AMPAS:CLF:v3.0"}
    array = root.find("clf:Matrix/clf:Array", space)
    assert array.attrib["dim"] == "3 3"
    values = np.array(array.text.split(), dtype=float).reshape(3, 3)
    np.testing.assert_allclose(values, balanced(made(SENSOR)), rtol=1e-9)


def test_opencolorio_applies_the_clf_as_the_library_multiplies(exported):
    ocio = pytest.importorskip("PyOpenColorIO", reason="OpenColorIO is not installed")
    path = exported("clf", *TIME)
    processor = ocio.Config.CreateRaw().getProcessor(ocio.FileTransform(str(path)))
    raw = [0.2, 0.5, 0.9]
    seen = processor.getDefaultCPUProcessor().applyRGB(raw)
    np.testing.assert_allclose(seen, balanced(made(SENSOR)) @ raw, rtol=2e-6)


def test_the_camera_profile_goes_from_xyz_to_camera_and_its_neutral_is_the_white(exported):
    data = json.loads(exported("dcp.json", *TIME).read_text())
    source = made(SENSOR)
    white_xyz = source.matrix.matrix @ source.white_e / source.white_lux
    camera = np.array(data["ColorMatrix1"]) @ white_xyz
    np.testing.assert_allclose(camera, data["AsShotNeutral"], rtol=1e-9)
    np.testing.assert_allclose(camera, source.white_e / source.white_e.max(), rtol=1e-9)


def test_four_channels_do_not_fit_a_three_by_three_format():
    with refused_input(value=("R", "G", "B", "W")):
        matrix_clf(made("onyx-rgbw"))
