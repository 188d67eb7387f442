"""Binning from the command line, a study and in pictures."""

import json

import numpy as np
import pytest
import tifffile

from chromanoise.study import study_from_text
from outcomes import refused, refused_input


@pytest.mark.parametrize(
    "options",
    [
        ("--binning", "2.5"),
        ("--binning-mode", "charge"),
        ("--binning", "1", "--binning-mode", "digital"),
        ("--binning", "4", "--binning-mode", "average"),
    ],
)
def test_a_binning_that_is_none_is_refused_in_one_sentence(run, options):
    refused(run("analyze", "model-rgb", *options), options[0])


def test_a_mode_without_binning_is_refused_with_its_key():
    text = '[[sensors]]\nname = "model-rgb"\n[sensors.pixel]\nbinning_mode = "digital"\n'
    with refused_input(subject="binning_mode", setting="sensors.0.pixel.binning"):
        study_from_text(text, source="")


def test_raw_codes_of_digital_binning_are_refused(run, tmp_path):
    asked = ("simulate", "builtin:checker", "--sensor", "model-rgb", "--mosaic", "bayer")
    outcome = run(*asked, "--binning", 4, "--binning-mode", "digital", "-o", tmp_path / "o")
    refused(outcome, "--binning-mode", value="digital")


def test_a_pixel_of_a_picture_is_one_binned_pixel(done, result_of, tmp_path):
    reflectance = np.full((128, 128, 14), 0.5, dtype=np.float32)
    cube = tmp_path / "cube.npz"
    np.savez(cube, wavelength_nm=np.linspace(400, 1050, 14), reflectance=reflectance)
    asked = ("simulate", cube, "--sensor", "model-rgb", "--time-ms", 5, "--lux", 5)
    asked = (*asked, "--mosaic", "G", "--raw-only", "--bits", 16)
    done(*asked, "--binning", 4, "--prnu", 0.02, "-o", tmp_path / "o")
    (data,) = json.loads((tmp_path / "o" / "summary.json").read_text())["pictures"]
    codes = tifffile.imread(tmp_path / "o" / "model-rgb.raw.tiff").astype(float)
    gain, mean_e = data["gain_e_per_dn"], 4 * expected_green(result_of)
    assert gain == pytest.approx(40_000 / 65535)
    variance = mean_e + 10.0**2 + (0.01 * mean_e) ** 2 + gain**2 / 12  # a PRNU of 2 % by sqrt(4)
    assert abs(gain * codes.mean() - mean_e) < 5 * np.sqrt(variance / codes.size)
    assert abs(gain**2 * codes.var() / variance - 1) < 5 * np.sqrt(2 / codes.size)


def expected_green(result_of):
    """Electrons of a gray of 0.5 in green of one pixel."""
    (sensor,) = result_of("analyze", "model-rgb", "--time-ms", 5, "--lux", 5)["sensors"]
    return 0.5 * next(c["mean_e"] for c in sensor["channels"] if c["name"] == "G")


def test_a_study_copied_from_a_binned_analysis_is_the_same(done):
    asked = ("analyze", "model-rgb", "--binning", "4", "--binning-mode", "digital")
    toml, _ = done(*asked, "--copy-as", "toml")
    pixel = study_from_text(toml, source="").sensors[0].pixel
    assert (pixel.binning, pixel.binning_mode) == (4, "digital")
