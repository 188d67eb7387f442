"""Matrices as files: other programs read what the library says."""

import csv
import json
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from chromanoise.base.errors import InputError
from chromanoise.cli import main
from chromanoise.color import kernel_matrix
from chromanoise.io.matrix_files import MadeMatrix, balanced, matrix_clf
from chromanoise.noise import Exposure, expected_electrons
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import sensor_named

EXPOSURE = Exposure(time_s=0.0119)


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


def exported(tmp_path, ending, sensor="onyx-rgb-ircut"):
    path = tmp_path / f"matrix{ending}"
    with pytest.raises(SystemExit) as stop:
        main(["matrix", sensor, "--time-ms", "11.9", "--export", str(path)])
    assert stop.value.code == 0
    return path


def test_the_balanced_matrix_sends_the_balanced_white_to_a_luminance_of_one():
    assert balanced(made("onyx-rgbw"))[1].sum() == pytest.approx(1.0, abs=1e-12)


def test_csv_and_json_hold_every_digit(tmp_path):
    data = json.loads(exported(tmp_path, ".json", "onyx-rgbw").read_text())
    lines = exported(tmp_path, ".csv", "onyx-rgbw").read_text().splitlines()
    facts = dict(line[2:].split(": ", 1) for line in lines if line.startswith("#"))
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    ours = made("onyx-rgbw").matrix.matrix
    assert data["matrix_lux_per_e"] == ours.tolist()
    assert rows[0] == ["lx/e-", "R", "G", "B", "W"]
    assert [[float(cell) for cell in row[1:]] for row in rows[1:]] == ours.tolist()
    assert "reconstruction" in data["notes"]
    for name, value in (("f_number", 1.8), ("pitch_um", 10.0)):
        assert data[name] == float(facts[name]) == value


def test_clf_is_well_formed_and_holds_the_balanced_matrix(tmp_path):
    root = ElementTree.fromstring(exported(tmp_path, ".clf").read_text())
    space = {"clf": "urn:AMPAS:CLF:v3.0"}
    array = root.find("clf:Matrix/clf:Array", space)
    assert array.attrib["dim"] == "3 3"
    values = np.array(array.text.split(), dtype=float).reshape(3, 3)
    np.testing.assert_allclose(values, balanced(made("onyx-rgb-ircut")), rtol=1e-9)


def test_opencolorio_applies_the_clf_as_the_library_multiplies(tmp_path):
    ocio = pytest.importorskip("PyOpenColorIO", reason="OpenColorIO is not installed")
    path = exported(tmp_path, ".clf")
    processor = ocio.Config.CreateRaw().getProcessor(ocio.FileTransform(str(path)))
    raw = [0.2, 0.5, 0.9]
    seen = processor.getDefaultCPUProcessor().applyRGB(raw)
    np.testing.assert_allclose(seen, balanced(made("onyx-rgb-ircut")) @ raw, rtol=2e-6)


def test_the_camera_profile_goes_from_xyz_to_camera_and_its_neutral_is_the_white(tmp_path):
    data = json.loads(exported(tmp_path, ".dcp.json").read_text())
    source = made("onyx-rgb-ircut")
    white_xyz = source.matrix.matrix @ source.white_e / source.white_lux
    camera = np.array(data["ColorMatrix1"]) @ white_xyz
    np.testing.assert_allclose(camera, data["AsShotNeutral"], rtol=1e-9)
    np.testing.assert_allclose(camera, source.white_e / source.white_e.max(), rtol=1e-9)


def test_four_channels_do_not_fit_a_three_by_three_format():
    with pytest.raises(InputError, match="4"):
        matrix_clf(made("onyx-rgbw"))
