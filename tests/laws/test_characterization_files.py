"""What is written about a characterized camera: our readers and others read the same numbers."""

import json
import math
from dataclasses import asdict, fields, replace
from functools import partial

import numpy as np
import pytest

from characterizations import BLACK_DN, DARK_E, color, exact_plane, monochrome, plane_of
from chromanoise.apps.camera import (
    ModelVerdict,
    PlaneNoise,
    characterization_as_json,
    characterization_from_json,
    darktable_json,
    emva_sheet,
    emva_sheet_xml,
    libcamera_json,
    noise_profile_json,
    noise_profile_line,
    noise_profiles_json,
    photon_transfer_csv,
    pixel_of,
    pixel_toml,
    plane_curves,
)
from chromanoise.io.pixels import (
    pixel_from_darktable,
    read_darktable_noise,
    read_emva_sheet,
    read_noise_profile,
    read_photon_transfer_csv,
)
from chromanoise.sensor import PIXEL, photon_transfer_fit
from chromanoise.study import read_pixel_source, sensor_with_pixel
from outcomes import refused_input

EXACT = 1e-13


@pytest.fixture
def file(tmp_path):
    def write(text, name="pixel.txt"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


# --- JSON


def test_the_json_has_every_field_with_all_digits():
    result = color()
    data = json.loads(json.dumps(characterization_as_json(result), allow_nan=False))
    assert (data["schema"], data["source"]) == ("chromanoise characterization", "frames")
    assert (data["camera"], data["iso"], data["bits"]) == ("Acme Model One", 100.0, 12)
    assert data["mosaic"] == [["R", "G1"], ["G2", "B"]]
    assert data["verdict"]["holds"] is True
    assert data["correlation"] == np.eye(4).tolist()
    for plane, own in zip(data["planes"], result.planes, strict=True):
        errors = {name.removesuffix("_se") for name in plane if name.endswith("_se")}
        unmeasured = set(PIXEL) - errors
        assert set(plane) == {field.name for field in fields(PlaneNoise)} - unmeasured
        assert {"prnu", "full_well_e", "row_noise_e", "dark_current_e_per_s"} <= errors
        assert (plane["name"], plane["gain_dn_per_e"]) == (own.name, own.gain_dn_per_e)
        assert plane["levels"] == [asdict(level) for level in own.levels]
        assert plane["fit"]["residual_z"] == own.fit.residual_z.tolist()


def test_a_number_that_is_not_defined_is_null():
    plane = exact_plane(qe=None, bend_z=math.nan)
    data = characterization_as_json(monochrome(planes=(plane,), iso=None))
    assert data["planes"][0]["qe"] is None
    assert data["planes"][0]["bend_z"] is None
    assert data["iso"] is None
    assert data["mosaic"] is None
    json.dumps(data, allow_nan=False)


# --- the pixel


def test_a_measured_prnu_beyond_that_of_any_pixel_is_written_and_refused_where_it_is_read(tmp_path):
    result = monochrome(planes=(exact_plane(prnu=0.3),))  # shading of a small plane
    assert pixel_of(result).prnu == 0.3
    path = tmp_path / "pixel.toml"
    path.write_text(pixel_toml(result), encoding="utf-8")
    with refused_input(subject=str(path), where="prnu", value=0.3, requirement="0 to 0.2"):
        read_pixel_source(path)


def test_the_pixel_of_a_monochrome_camera_has_the_values_of_its_plane():
    result = monochrome()
    plane, pixel = result.planes[0], pixel_of(result)
    assert 1 / pixel.gain_e_per_dn == pytest.approx(plane.gain_dn_per_e, rel=EXACT)
    spreads = ("dsnu_e", "prnu", "row_noise_e", "column_noise_e")
    for name in ("full_well_e", "dark_current_e_per_s", "qe", *spreads):
        assert getattr(pixel, name) == getattr(plane, name)
    shared_e = np.hypot(pixel.row_noise_e, pixel.column_noise_e)
    assert np.hypot(pixel.read_noise_e, shared_e) == pytest.approx(plane.dark_noise_e, rel=EXACT)
    assert (pixel.bits, pixel.black_level_dn, pixel.pitch_um) == (12, 64, None)


def test_noise_of_rows_and_columns_is_part_of_the_dark_noise_and_not_of_the_read_noise():
    plane = exact_plane(dark_noise_e=13.0, row_noise_e=4.0, column_noise_e=3.0)
    pixel = pixel_of(monochrome(planes=(plane,)))
    assert (pixel.read_noise_e, pixel.row_noise_e, pixel.column_noise_e) == (12.0, 4.0, 3.0)


def test_a_plane_with_half_the_error_has_four_times_the_weight():
    planes = (
        exact_plane("R", gain_dn_per_e=0.5, gain_dn_per_e_se=0.002, full_well_e=7000.0),
        exact_plane("B", gain_dn_per_e=0.6, gain_dn_per_e_se=0.001, full_well_e=6000.0),
    )
    pixel = pixel_of(color(planes=planes))
    assert 1 / pixel.gain_e_per_dn == pytest.approx((0.5 + 4 * 0.6) / 5, rel=EXACT)
    assert pixel.full_well_e == 6000.0
    assert any("the planes differ by 18 %: R 0.5, B 0.6)" in note for note in pixel.notes)
    assert any("of B, the lowest" in note for note in pixel.notes)


def test_the_pattern_noise_of_the_pixel_is_that_of_all_planes_together():
    planes = (exact_plane("R", dsnu_e=3.0), exact_plane("B", dsnu_e=4.0))
    assert pixel_of(color(planes=planes)).dsnu_e == pytest.approx(math.sqrt(12.5), rel=EXACT)


def test_what_is_impossible_is_left_out_of_the_pixel_with_a_note():
    plane = exact_plane(black_level_dn=-2.0, qe=1.2)
    pixel = pixel_of(monochrome(planes=(plane,), bits=20))
    assert (pixel.black_level_dn, pixel.qe, pixel.bits) == (None, None, None)
    assert sum("not used" in note for note in pixel.notes) == 3


def test_dark_currents_are_averaged_with_their_signs_and_then_not_below_0():
    planes = tuple(exact_plane(dark_current_e_per_s=value) for value in (-0.4, 0.2))
    assert pixel_of(monochrome(planes=planes)).dark_current_e_per_s == 0.0
    planes = tuple(exact_plane(dark_current_e_per_s=value) for value in (-0.2, 0.4))
    assert pixel_of(monochrome(planes=planes)).dark_current_e_per_s == pytest.approx(0.1)


def test_a_value_that_is_not_finite_counts_as_unknown(file):
    unknown = dict.fromkeys(("full_well_e", "saturation_capacity_e"), math.inf)
    plane = exact_plane(dark_noise_e=math.nan, dsnu_e=math.nan, **unknown)
    result = monochrome(planes=(plane,))
    pixel = read_pixel_source(file(pixel_toml(result), "pixel.toml"))
    sheet = read_emva_sheet(file(emva_sheet(result, plane)))
    for held in (pixel, sheet):
        assert (held.read_noise_e, held.full_well_e, held.dsnu_e) == (None, None, None)
    with refused_input(subject="dark noise of plane mono"):
        noise_profile_json(result)


def test_a_camera_that_breaks_the_model_says_so_in_the_notes_of_its_pixel():
    verdict = ModelVerdict(
        holds=False,
        chi2_per_level=9.0,
        worst_level="level 3",
        worst_z=11.0,
        sentences=("neighbors correlate by 0.2",),
    )
    assert any(
        "neighbors correlate by 0.2" in note for note in pixel_of(color(verdict=verdict)).notes
    )


@pytest.mark.parametrize("result", [monochrome(), color()], ids=["mono", "color"])
def test_the_pixel_file_is_read_to_the_last_digit(file, result):
    assert read_pixel_source(file(pixel_toml(result), "pixel.toml")) == pixel_of(result)


def test_a_sensor_takes_the_pixel_file(file):
    result = color()
    path, own = file(pixel_toml(result), "pixel.toml"), pixel_of(result)
    sensor = sensor_with_pixel("onyx-rgbw", file=str(path))
    assert sensor.pixel.row_noise_e == own.row_noise_e == 3.0
    assert sensor.pixel.read_noise_e == own.read_noise_e
    assert sensor.converter.gain_e_per_dn == own.gain_e_per_dn
    assert sensor.converter.bits == 12


# --- data sheets


def values_of_sheet(text):
    parts = (line.split(" = ") for line in text.splitlines() if " = " in line)
    return {name: float(value.split()[0]) for name, value in parts}


@pytest.mark.parametrize("plane", color().planes, ids=lambda plane: plane.name)
def test_the_data_sheet_is_read_to_the_last_digit(file, plane):
    read = read_emva_sheet(file(emva_sheet(color(), plane)))
    assert 1 / read.gain_e_per_dn == pytest.approx(plane.gain_dn_per_e, rel=EXACT)
    assert read.read_noise_e == plane.dark_noise_e
    for name in ("full_well_e", "qe", "dsnu_e", "prnu", "dark_current_e_per_s"):
        assert getattr(read, name) == getattr(plane, name), name
    assert (read.bits, read.black_level_dn) == (12, 64)
    assert not any("one is wrong" in note for note in read.notes)


def test_a_value_below_zero_does_not_spoil_the_data_sheet(file):
    plane = exact_plane(dark_current_e_per_s=-0.1)
    text = emva_sheet(monochrome(), plane)
    assert "-0.1 e-/s" in text
    assert read_emva_sheet(file(text)).dark_current_e_per_s is None


def test_the_threshold_of_a_data_sheet_is_that_of_the_standard(file):
    plane = exact_plane(gain_dn_per_e=0.1, dark_noise_e=2.0, qe=0.5)  # 4 + 100 / 12 = 12.3333
    text = emva_sheet(monochrome(), plane)
    held = values_of_sheet(text)
    assert held["mu_e.min"] == pytest.approx(math.sqrt(37 / 3) + 0.5, rel=EXACT)
    assert held["mu_p.min"] == pytest.approx(2 * math.sqrt(37 / 3) + 1, rel=EXACT)


def test_the_reference_code_of_the_standard_reads_the_xml(file):
    routines = pytest.importorskip("emva1288.process.routines")
    plane = exact_plane("G<1>", prnu=0.0061)
    path = file(emva_sheet_xml(monochrome(camera="A & B\x01"), plane), "sheet.xml")
    data = routines.xml_to_dict(str(path))
    assert data["sensitivity"]["k"]["value"] == 0.5
    assert data["sensitivity"]["sigma_d"]["value"] == 5.0
    assert data["sensitivity"]["u_e_sat"]["value"] == plane.saturation_capacity_e
    assert data["sensitivity"]["qe"]["value"] == pytest.approx(61.0, rel=EXACT)
    assert data["spatial"]["prnu1288"]["value"] == pytest.approx(0.61, rel=EXACT)
    assert data["spatial"]["dsnu1288"]["value"] == plane.dsnu_e
    assert data["spatial"]["prnu1288"]["unit"] == "%"


def test_the_photon_transfer_is_read_to_the_last_digit_and_gives_the_same_fit(file):
    plane = plane_of()
    table = read_photon_transfer_csv(file(photon_transfer_csv(plane)))
    assert table.mean_dn.tolist() == [level.mean_dn for level in plane.levels]
    assert table.variance_dn2.tolist() == [level.variance_dn2 for level in plane.levels]
    assert table.photons.tolist() == [level.photons_per_pixel for level in plane.levels]
    assert table.time_ms.tolist() == [level.time_ms for level in plane.levels]
    assert table.samples == pytest.approx(np.full(9, 200_000.0))
    again = photon_transfer_fit(table)
    assert again.gain_dn_per_e == pytest.approx(plane.gain_dn_per_e, rel=1e-9)
    assert again.gain_se == pytest.approx(plane.gain_dn_per_e_se, rel=1e-6)
    assert again.read_noise_e == pytest.approx(plane.dark_noise_e, rel=1e-9)


def test_a_column_that_not_all_levels_have_is_left_out(file):
    plane = plane_of()
    first, *rest = plane.levels
    partial = replace(first, dark_mean_dn=None, time_ms=None, variance_se_dn2=0.0)
    table = read_photon_transfer_csv(
        file(photon_transfer_csv(replace(plane, levels=(partial, *rest))))
    )
    assert (table.dark_mean_dn, table.dark_variance_dn2) == (None, None)
    assert (table.time_ms, table.samples) == (None, None)
    assert table.photons is not None


@pytest.mark.parametrize("result", [monochrome(), color()], ids=["mono", "color"])
def test_the_json_is_read_to_the_last_digit_and_gives_the_same_pixel(file, result):
    path = file(json.dumps(characterization_as_json(result)), "characterization.json")
    again = characterization_from_json(json.loads(path.read_text()), str(path))
    assert characterization_as_json(again) == characterization_as_json(result)
    assert read_pixel_source(path) == pixel_of(result)


def test_a_number_that_was_not_finite_is_not_known(file):
    result = monochrome(planes=(exact_plane(dsnu_e=math.nan),))
    path = file(json.dumps(characterization_as_json(result)), "characterization.json")
    assert read_pixel_source(path).dsnu_e is None


@pytest.mark.parametrize(
    ("change", "where"),
    [
        (lambda held: held["planes"][0].update(gain_dn_per_e=0), "planes[0].gain_dn_per_e"),
        (lambda held: held["planes"][0].update(dark_noise_e=-5), "planes[0].dark_noise_e"),
        (lambda held: held["planes"][0].update(qe="0.5"), "planes[0].qe"),
        (lambda held: held["planes"][0].update(prnu=1e200), "planes[0].prnu"),
        (lambda held: held["planes"][0]["fit"].update(notes=[1]), "planes[0].fit.notes[0]"),
        (lambda held: held["planes"][0]["levels"][2].update(name=2), "planes[0].levels[2].name"),
        (lambda held: held.update(verdict=None), "verdict"),
        (lambda held: held.update(planes={}), "planes"),
        (lambda held: held.update(mosaic=5), "mosaic"),
        (lambda held: held.update(bits=True), "bits"),
        (lambda held: held.update(correlation=[[1.0], [1.0, 2.0]]), "correlation"),
    ],
)
def test_a_json_with_a_wrong_field_is_refused_with_its_place(file, change, where):
    held = characterization_as_json(monochrome())
    change(held)
    path = file(json.dumps(held), "characterization.json")
    with refused_input(subject=str(path), where=where):
        read_pixel_source(path)


def test_a_json_of_another_version_is_refused(file):
    held = characterization_as_json(monochrome()) | {"schema_version": 2}
    path = file(json.dumps(held), "characterization.json")
    with refused_input(subject=str(path), value=("chromanoise characterization", 2)):
        read_pixel_source(path)


@pytest.mark.parametrize("plane", color().planes, ids=lambda plane: plane.name)
def test_xml_and_text_of_a_data_sheet_give_the_same_pixel(file, plane):
    plane = replace(plane, full_well_e=plane.full_well_e * 1.01)
    text = read_pixel_source(file(emva_sheet(color(), plane), "sheet"))
    xml = read_pixel_source(file(emva_sheet_xml(color(), plane), "sheet"))
    assert replace(xml, notes=()) == replace(text, notes=())
    assert (xml.prnu, xml.qe, xml.full_well_e) == (plane.prnu, plane.qe, plane.full_well_e)
    assert not any("one is wrong" in note for note in (*xml.notes, *text.notes))


def test_mu_e_sat_is_the_saturation_capacity(file):
    plane = exact_plane(saturation_capacity_e=8000.0, full_well_e=8100.0)
    text = emva_sheet(monochrome(), plane)
    held = values_of_sheet(text)
    assert (held["mu_e.sat"], held["full well"]) == (8000.0, 8100.0)
    assert held["SNR_max"] == pytest.approx(10 * math.log10(8000))
    least = math.hypot(plane.dark_noise_e, 1 / math.sqrt(12) / plane.gain_dn_per_e) + 0.5
    assert held["DR"] == pytest.approx(20 * math.log10(8000 / least))
    only = read_emva_sheet(file(text.replace("full well = 8100.0", "# ")))
    assert only.full_well_e == 8000.0


@pytest.mark.parametrize(
    "text",
    [
        "<results>",
        "<sheet/>",
        '<!DOCTYPE a [<!ENTITY b "c">]><results/>',
        "<results/>",
        "<results><a><K><unit>DN/e-</unit><value>x</value></K></a></results>",
        "<results><a><K><unit>DN/e-</unit><value>1e999</value></K></a></results>",
        "<results><a><K><unit>m</unit><value>1</value></K></a></results>",
    ],
)
def test_xml_that_is_no_data_sheet_is_refused(file, text):
    path = file(text, "sheet.xml")
    with refused_input(subject=str(path)):
        read_emva_sheet(path)


# --- noise models of other programs


def test_the_white_level_is_the_code_at_which_the_first_plane_saturates():
    # 55 + 0.5 * 7000 = 3555; the converter ends at 4095
    planes = [exact_plane(full_well_e=well) for well in (7000.0, 7500.0)]
    data = noise_profile_json(monochrome(planes=(planes[0],)))
    assert data["white_level_dn"] == data["dng"]["WhiteLevel"] == 3555
    assert data["S"] == [0.5 / 3500]
    beyond = noise_profile_json(monochrome(planes=(exact_plane(full_well_e=9000.0),)))
    assert beyond["white_level_dn"] == 4095
    unknown = noise_profile_json(monochrome(planes=(exact_plane(full_well_e=None),)))
    assert unknown["white_level_dn"] == 4095


def test_the_noise_profile_is_that_of_dng():
    # R = 255 - 55 = 200 DN; S = 0.5 / 200; O = (2.5^2 + 1/12) / 200^2
    data = noise_profile_json(monochrome(planes=(exact_plane(),)), white_level_dn=255)
    assert data["S"] == [0.0025]
    assert data["O"] == pytest.approx([6.3333333333333333 / 40000], rel=EXACT)
    assert (data["black_level_dn"], data["white_level_dn"]) == (55.0, 255.0)


def test_the_model_of_the_noise_profile_gives_the_variance_of_the_codes():
    plane = exact_plane()
    data = noise_profile_json(monochrome(planes=(plane,)))["dng"]
    scale, offset = data["NoiseProfile"]
    signal_e, span = 3000.0, data["WhiteLevel"] - 55
    variance_dn2 = (scale * (0.5 * signal_e / span) + offset) * span**2
    assert variance_dn2 == pytest.approx(0.25 * (signal_e + 25.0) + 1 / 12, rel=1e-12)


def test_the_pairs_of_dng_are_those_of_red_green_and_blue():
    gains = {"B": 0.6, "G1": 0.4, "G2": 0.5, "R": 0.3}
    planes = tuple(exact_plane(name, gain_dn_per_e=gain) for name, gain in gains.items())
    data = noise_profile_json(color(planes=planes), white_level_dn=1055)
    assert data["dng"]["colors"] == ["R", "G", "B"]
    assert data["dng"]["NoiseProfile"][::2] == pytest.approx([3e-4, 4.5e-4, 6e-4], rel=EXACT)
    assert data["channels"] == ["B", "G1", "G2", "R"]


@pytest.mark.parametrize("name", ["noise_profile.json", "noise_profile.txt"])
def test_the_noise_profile_is_read_to_the_last_digit(file, name):
    plane = exact_plane()
    result = monochrome(planes=(plane,))
    text = {
        "noise_profile.json": json.dumps(noise_profile_json(result)),
        "noise_profile.txt": noise_profile_line(result),
    }[name]
    for read in (read_noise_profile, read_pixel_source):
        pixel = read(file(text, name))
        assert pixel.gain_e_per_dn == pytest.approx(2.0, rel=EXACT)
        assert pixel.read_noise_e == pytest.approx(5.0, rel=EXACT)
        assert (pixel.adc.bits, pixel.adc.black_level_dn) == (12, 55)


def test_the_profile_of_darktable_is_read_and_gives_the_read_noise(file):
    planes = tuple(exact_plane(name) for name in ("R", "G1", "G2", "B"))
    data = darktable_json(color(planes=planes))
    path = file(json.dumps(data), "noiseprofiles.json")
    noise = read_darktable_noise(path, maker="Acme", model="Model One", iso=100)
    dng = noise_profile_json(color(planes=planes))["dng"]
    own = dng["NoiseProfile"]
    assert noise.a.tolist() == [own[0] / 4, own[2] / 4, own[4] / 4]
    assert noise.b.tolist() == [own[1] / 4, own[3] / 4, own[5] / 4]
    # rounding is part of the noise of the codes: sigma^2 + 1 / (12 K^2)
    pixel = pixel_from_darktable(noise, full_well_e=(dng["WhiteLevel"] - 55) / 0.5)
    assert pixel.read_noise_e == pytest.approx(math.sqrt(25 + 4 / 12), rel=1e-12)


def at_several_iso(*isos):
    """One camera, whose gain is in proportion to the ISO."""
    return [
        color(
            iso=float(iso),
            planes=tuple(
                plane_of(name, gain=0.5 * iso / 100, light=light)
                for name, light in (("R", 0.9), ("G1", 1.0), ("G2", 1.0), ("B", 0.85))
            ),
        )
        for iso in isos
    ]


def test_a_profile_of_several_iso_settings_has_each_of_them(file):
    results = at_several_iso(400, 100, 200)
    held = darktable_json(results)
    path = file(json.dumps(held), "noiseprofiles.json")
    for one in results:
        single = darktable_json(one)["noiseprofiles"][0]["models"][0]["profiles"]
        profile = read_darktable_noise(path, maker="Acme", model="Model One", iso=one.iso)
        assert profile.a.tolist() == single[0]["a"]
    dng = noise_profiles_json(results)["profiles"]
    assert [one["iso"] for one in dng] == [100.0, 200.0, 400.0]
    assert dng[1] == {"iso": 200.0, **noise_profile_json(results[2])}
    with refused_input(subject="results", where="other"):
        darktable_json([results[0], replace(results[1], camera="Beta Two", source="other")])
    with refused_input(subject="iso", value=[100.0, 100.0]):
        noise_profiles_json([results[1], results[1]])


def test_libcamera_has_one_slope_for_all_gains_of_shot_noise():
    """Shot noise alone: sd^2 = gain K 2^(16 - bits) mean, so that the slope at gain 1 is common."""
    results = at_several_iso(100, 400)
    one, both = (
        libcamera_json(some)["algorithms"][1]["rpi.noise"]["reference_slope"]
        for some in (results[0], results)
    )
    assert both == pytest.approx(one, rel=0.02)


def test_white_noise_has_a_quarter_of_its_variance_in_the_diagonal_band_of_darktable():
    # tools/noise/noiseprofile.c: mean and half difference, along rows, then along columns
    noise = np.random.default_rng(3).standard_normal((1000, 1000))
    along = (noise[:, 1::2] - noise[:, ::2]) / 2
    diagonal = (along[1::2] - along[::2]) / 2
    assert diagonal.var() == pytest.approx(0.25, rel=5 * math.sqrt(2 / diagonal.size))


@pytest.mark.parametrize(
    ("camera", "maker", "model"),
    [("Canon Canon EOS R5", "Canon", "EOS R5"), ("NIKON Z 6", "NIKON", "Z 6")],
)
def test_a_camera_is_split_into_maker_and_model(camera, maker, model):
    own = darktable_json(color(camera=camera))["noiseprofiles"][0]
    assert (own["maker"], own["models"][0]["model"]) == (maker, model)


def test_the_noise_of_libcamera_is_that_of_its_tuning_tool():
    # ctt_noise.py: numpy.polyfit of the standard deviation over the root of the mean, in 16 bits
    result = color()
    data = libcamera_json(result)["algorithms"]
    patches = [
        (16 * (level.mean_dn - BLACK_DN), 16 * math.sqrt(level.variance_dn2))
        for plane in result.planes
        for level in plane.levels
        if level.fitted
    ]
    means, sds = np.array(patches).T
    slope, constant = np.polyfit(np.sqrt(means), sds, 1)
    assert data[1]["rpi.noise"]["reference_slope"] == pytest.approx(slope, rel=1e-9)
    assert data[1]["rpi.noise"]["reference_constant"] == pytest.approx(constant, rel=1e-9)
    assert data[0] == {"rpi.black_level": {"black_level": round(16 * BLACK_DN)}}


@pytest.mark.parametrize("analog_gain", [1.0, 4.0])
def test_shot_noise_alone_has_the_slope_of_the_root_of_the_gain_on_16_bits(analog_gain):
    """noise.cpp multiplies the noise at gain 1 by the root of the analog gain."""
    plane = plane_of(gain=0.5)
    levels = tuple(
        replace(one, variance_dn2=0.5 * (one.mean_dn - BLACK_DN)) for one in plane.levels
    )
    result = monochrome(planes=(replace(plane, levels=levels),))
    noise = libcamera_json(result, analog_gain=analog_gain)["algorithms"][1]["rpi.noise"]
    expected = math.sqrt(16 * 0.5 / analog_gain)
    assert noise["reference_slope"] == pytest.approx(expected, rel=1e-9)
    assert noise["reference_constant"] == pytest.approx(0.0, abs=1e-9)


def test_black_levels_of_colors_that_differ_are_written_for_each():
    blacks = {"R": 63.0, "G1": 64.0, "G2": 64.0, "B": 65.0}
    planes = tuple(exact_plane(name, black_level_dn=black) for name, black in blacks.items())
    data = libcamera_json(color(planes=planes))["algorithms"][0]["rpi.black_level"]
    assert data == {
        "black_level": 1024,
        "black_level_r": 1008,
        "black_level_g": 1024,
        "black_level_b": 1040,
    }


NO_DARK_NOISE = {"planes": (exact_plane("R", dark_noise_e=None),)}
NO_BLACK_LEVEL = {"planes": (exact_plane("R", black_level_dn=None),)}
ONE_LEVEL = {"planes": (exact_plane(levels=plane_of().levels[:1]),)}


@pytest.mark.parametrize(
    ("write", "given", "subject"),
    [
        (noise_profile_json, {"bits": None}, "bits"),
        (libcamera_json, {"bits": None}, "bits"),
        (darktable_json, {"iso": None}, "iso"),
        (darktable_json, {"camera": ""}, "maker"),
        (darktable_json, {"camera": "Acme"}, "model"),
        (noise_profile_json, NO_DARK_NOISE, "dark noise of plane R"),
        (libcamera_json, NO_BLACK_LEVEL, "black level of plane R"),
        (darktable_json, {"planes": (plane_of("mono"),)}, "frames"),
        (libcamera_json, ONE_LEVEL, "frames"),
        (pixel_of, {"planes": ()}, "frames"),
        (noise_profile_json, {"planes": ()}, "frames"),
        (partial(noise_profile_json, white_level_dn=10), {}, "white minus black level of frames"),
    ],
)
def test_a_model_that_lacks_a_value_is_refused(write, given, subject):
    with refused_input(subject=subject):
        write(color(**given))


# --- curves


def test_the_snr_of_a_linear_camera_lies_on_its_model_and_below_shot_noise():
    curves = plane_curves(plane_of(dark_e=DARK_E))
    below = curves.fitted
    model = np.interp(curves.signal_dn[below], curves.model_signal_dn, curves.model_snr)
    assert curves.snr[below] == pytest.approx(model, rel=0.02)
    assert (curves.model_snr < curves.ideal_snr).all()
    assert np.abs(curves.residual_z[below]).max() < 5


def test_a_mean_in_proportion_to_the_light_does_not_deviate_from_its_line():
    curves = plane_curves(plane_of())
    assert curves.light_unit == "photons"
    deviation = curves.deviation_percent
    assert np.nanmax(np.abs(deviation[:7])) < 1e-9


def test_a_mean_that_bends_deviates_as_an_independent_fit_says():
    plane = plane_of()
    levels = tuple(
        replace(one, mean_dn=one.mean_dn - 1e-5 * (one.mean_dn - BLACK_DN) ** 2)
        for one in plane.levels
    )
    curves = plane_curves(replace(plane, levels=levels))
    used = np.isfinite(curves.deviation_percent)
    x, y = curves.light[used], curves.signal_dn[used]
    line = np.polyval(np.polyfit(x, y, 1, w=1 / y), x)
    assert curves.deviation_percent[used] == pytest.approx(100 * (y - line) / line, abs=1e-9)
    assert np.abs(curves.deviation_percent[used]).max() > 0.4


def test_levels_without_light_have_no_curves():
    plane = plane_of()
    dark = replace(plane.levels[0], mean_dn=BLACK_DN)
    assert plane_curves(replace(plane, levels=(dark,))) is None
