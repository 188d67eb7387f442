"""The cameras of the catalog: their curves, their saturation and their read noise."""

import csv
import json
import re
from importlib import resources
from itertools import pairwise
from pathlib import Path

import colour
import numpy as np
import pytest

from chromanoise.spectra import DEFAULT_GRID, Grid
from chromanoise.spectra.tables import camera_facts, camera_noise
from chromanoise.study import assumptions, camera_pixel, saturation_electrons, sensor_named
from outcomes import refused_input

SHARED = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "cameras"
measured = pytest.mark.skipif(not SHARED.is_dir(), reason="needs the files of shared/data/cameras")
TABLES = resources.files("chromanoise.spectra.tables")
FIVE = ("nikon-d3300", "canon-eos-r6", "sony-ilce-7rm4", "nikon-d850", "canon-eos-100d")
PLANCK_J_S, LIGHT_M_PER_S = 6.62607015e-34, 299_792_458.0


def rows(name):
    return list(csv.reader(TABLES.joinpath(f"{name}.csv").read_text().splitlines()))


def curves_of(name):
    """Wavelengths and relative curves per energy, from the table alone."""
    head, *body = rows("cameras")
    numbers = np.array(body, dtype=float)
    here = [head.index(f"{name}:{channel}") for channel in "RGB"]
    return numbers[:, 0], numbers[:, here]


def photons_per_um2(wavelength_nm, lux_s):
    """Photons of D55 per um^2 and nm at an exposure of the sensor."""
    lamp = colour.SDS_ILLUMINANTS["D55"]
    power = np.interp(wavelength_nm, lamp.wavelengths, lamp.values)
    eye = colour.SDS_LEFS["CIE 1924 Photopic Standard Observer"]
    seen = np.interp(wavelength_nm, eye.wavelengths, eye.values)
    joule_per_m2_nm = power * lux_s / (683.002 * np.trapezoid(power * seen, wavelength_nm))
    return joule_per_m2_nm * wavelength_nm * 1e-9 / (PLANCK_J_S * LIGHT_M_PER_S) * 1e-12


@measured
def test_every_curve_is_that_of_rawtoaces_to_five_digits():
    files = sorted((SHARED / "rawtoaces").glob("*_380_780_5.json"))
    assert len(files) == len(camera_facts()) == 52
    for path in files:
        told = json.loads(path.read_text())
        header, spectra = told["header"], told["spectral_data"]["data"]["main"]
        assert header["license"] == "Apache-2.0"
        full = f"{header['manufacturer']} {header['model']}".lower()
        wavelength_nm, curves = curves_of(re.sub("[^a-z0-9]+", "-", full).strip("-"))
        source = np.array([spectra[f"{nm:g}"] for nm in wavelength_nm])
        assert curves == pytest.approx(source, rel=5.1e-5, abs=0)


@measured
def test_every_share_of_the_noise_is_that_of_its_profile():
    profiles = {}
    with (SHARED / "noise.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            name = re.sub("[^a-z0-9]+", "-", f"{row['maker']} {row['model']}".lower())
            profiles.setdefault(name, {})[float(row["iso"])] = row
    for name, shares in camera_noise().items():
        for iso, share in shares.items():
            row = profiles[name][iso]
            assert share == pytest.approx(float(row["b_g"]) / float(row["a_g"]), rel=1e-3)
            assert iso >= camera_facts()[name].base_iso


def test_what_is_said_of_all_curves_is_so():
    """Each camera's highest value is 1; beyond 780 nm every curve is below 0.2 %."""
    for name, facts in camera_facts().items():
        wavelength_nm, curves = curves_of(name)
        assert (wavelength_nm[0], wavelength_nm[-1], len(wavelength_nm)) == (380, 780, 81)
        assert curves.max() == 1
        assert curves[-1].max() < 2e-3
        own_peaks = (curves.max(axis=0) == 1).all()
        assert own_peaks == facts.has_own_peaks, name


@pytest.mark.parametrize("name", FIVE)
def test_a_camera_is_full_at_78_over_iso_lux_seconds_of_daylight(name):
    """ISO 12232, by plain numpy from the table."""
    sensor = sensor_named(name, Grid.uniform(380, 780, 5))
    facts, iso = camera_facts()[name], camera_pixel(sensor).iso
    wavelength_nm, per_energy = curves_of(name)
    qe = per_energy / wavelength_nm[:, None]
    qe *= 0.5 / qe.max()
    light = photons_per_um2(wavelength_nm, 78 / iso)
    expected = 5 * (light @ qe).max() * facts.pitch_um**2
    assert sensor.pixel.full_well_e == pytest.approx(expected, rel=2e-3)
    assert saturation_electrons(sensor, 2.0 * iso) == pytest.approx(
        sensor.pixel.full_well_e / 2, rel=1e-12
    )


def test_a_simulated_profile_gives_back_the_read_noise_of_its_pixel():
    """Codes of a pixel with N electrons and r e- of read noise, their variance over their mean."""
    full_e, noise_e = 12_345.0, 6.0
    rng, shares = np.random.default_rng(2), np.linspace(0.02, 0.9, 12)
    drawn = rng.poisson(full_e * shares[:, None], (12, 40_000)) + rng.normal(
        0.0, noise_e, (12, 40_000)
    )
    downscaled = drawn.reshape(12, -1, 4).mean(axis=-1) / full_e
    variance = downscaled.var(axis=1)
    weights = 1 / variance
    a, b = np.polyfit(shares, variance, 1, w=weights)
    assert (b / a * full_e) ** 0.5 == pytest.approx(noise_e, rel=0.1)


def test_read_noise_is_between_its_neighbors_and_unknown_outside_of_the_profile():
    sensor = sensor_named("nikon-d850")
    speeds = [*camera_noise()["nikon-d850"]]
    for low, high in pairwise(speeds):
        shares = [
            camera_pixel(sensor, iso).read_noise_e ** 2 * iso
            for iso in (low, (low * high) ** 0.5, high)
        ]
        assert shares[1] ** 2 == pytest.approx(shares[0] * shares[2], rel=1e-9)
    assert camera_pixel(sensor, 64).read_noise_e is None
    assert camera_pixel(sensor, speeds[-1] * 1.01).read_noise_e is None


def test_profiles_of_negative_noise_and_jumps_are_left_out():
    for name, shares in camera_noise().items():
        assert len(shares) >= 4
        speeds, relative = np.array([*shares]), np.sqrt([x / iso for iso, x in shares.items()])
        jumps = abs(np.diff(np.log(relative))) > 1.5 * np.diff(np.log(speeds)) + 0.25
        # one is a second gain of the converter; two in a row are a wrong number
        assert not (jumps[1:] & jumps[:-1]).any(), name


def test_the_pixel_is_that_of_the_lowest_speed_with_a_known_read_noise():
    sensor = sensor_named("nikon-d850")
    assert camera_pixel(sensor).iso == 100.0
    assert sensor.pixel.read_noise_e == camera_pixel(sensor, 100).read_noise_e
    assert sensor.pixel.full_well_e == camera_pixel(sensor, 100).full_well_e
    assert camera_pixel(sensor_named("sony-ilce-7m4")).iso == 100.0
    assert camera_pixel(sensor_named("nikon-d70")).iso == 200.0


def test_read_noise_follows_a_full_well_that_the_user_gives():
    given = sensor_named("nikon-d850", pixel={"full_well_e": 50_000.0})
    plain = sensor_named("nikon-d850")
    ratio = 50_000.0 / plain.pixel.full_well_e
    assert given.pixel.read_noise_e == pytest.approx(plain.pixel.read_noise_e * ratio**0.5)


def test_a_camera_says_what_is_assumed_of_it():
    notes = " ".join(sensor_named("sony-ilce-7m4").notes)
    assert "scaled to a highest QE of 0.5" in notes
    assert "zero beyond 380-780 nm" in notes
    assert "read noise" in " ".join(assumptions(sensor_named("sony-ilce-7m4")))
    known = sensor_named("nikon-d3300")
    assert assumptions(known) == ()
    assert "full well at ISO 100 by 78/ISO lx s of D55 (ISO 12232)" in " ".join(known.notes)
    assert "its own peak" in " ".join(sensor_named("arri-d21").notes)


def test_what_a_user_says_of_a_camera_comes_before_what_is_assumed():
    from chromanoise.io.spectra import Answers

    bright = sensor_named("nikon-d850", answers=Answers(peak_qe=0.25))
    plain = sensor_named("nikon-d850", DEFAULT_GRID)
    assert bright.qe == pytest.approx(plain.qe / 2)
    assert bright.pixel.full_well_e == pytest.approx(plain.pixel.full_well_e / 2)
    own = sensor_named("nikon-d850", pixel={"full_well_e": 5e4, "read_noise_e": 2.0})
    assert (own.pixel.full_well_e, own.pixel.read_noise_e) == (5e4, 2.0)


def test_speeds_that_a_camera_does_not_have_are_refused():
    sensor = sensor_named("nikon-d850")
    for iso in (0.0, np.nan, 1e8, 63):
        with refused_input():
            camera_pixel(sensor, iso)
    with refused_input(subject="camera"):
        camera_pixel(sensor_named("onyx-rgb"), 100)
