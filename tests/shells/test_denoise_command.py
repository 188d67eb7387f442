"""`denoise` and `cn.denoise`: raw pictures of other cameras, with the noise of their files."""

import json

import numpy as np
import pytest
import tifffile

import chromanoise as cn
from chromanoise.imaging import chart_electrons
from chromanoise.imaging.denoising import (
    at_brightness,
    code_noise_of_profile,
    measured_noise_ratio,
    neutral_planes,
)
from chromanoise.io.frames import frames_in
from chromanoise.sensor import MOSAIC_NAMES, mosaic_named
from chromanoise.study import operating_points_of, prepared_denoising
from noisy_planes import planes_with
from outcomes import refused, refused_input

SENSOR = "onyx-rgb-ircut"  # 10,000 e- at the top code 4095, 10 e- read noise
K = 0.4095
AT = ["--lux", "10", "--time-ms", "12"]
KNOWN = ["--mosaic", "RG/GB", "--black-level", "100", "--gain-dn-per-e", "0.5"]
KNOWN += ["--read-noise-e", "5", "--bits", "12"]
METHOD = ["--denoise", "lmmse"]
CAMERA = {"mosaic": "RG/GB", "gain_dn_per_e": 0.5, "read_noise_e": 5.0, "black_level": 100}


@pytest.fixture(scope="module")
def cube(tmp_path_factory):
    path = tmp_path_factory.mktemp("cube") / "cube.npz"
    rng = np.random.default_rng(3)
    patches = np.kron(rng.random((4, 6, 27)), np.ones((8, 8, 1))).astype(np.float32)
    np.savez(path, wavelength_nm=np.linspace(400, 1050, 27), reflectance=patches)
    return path


@pytest.fixture
def simulated(done, cube, tmp_path):
    """The folder of a simulated picture with a DNG, and its color after denoising."""
    folder = tmp_path / "sim"
    words = ["--sensor", SENSOR, "--mosaic", "bayer", "--black-level", "64", *AT]
    done("simulate", cube, *words, "--denoise", "lmmse", "-o", folder)
    return folder


def flat(mean_e, *, seed=0, shape=(64, 96)):
    """Codes of a flat field: K = 0.5 DN/e-, black 100, read noise 5 e-."""
    rng = np.random.default_rng(seed)
    noisy = rng.poisson(mean_e, shape) + 5 * rng.standard_normal(shape)
    return np.clip(np.rint(100 + 0.5 * noisy), 0, 4095).astype(np.uint16)


def denoised(codes, **more):
    """The codes of `flat` after denoising with its noise."""
    return cn.denoise(codes, **{"unit": "DN", "denoise": "lmmse"} | CAMERA | more)


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text())


def test_a_dng_of_simulate_gives_the_color_of_simulate_with_denoising(done, simulated, tmp_path):
    file, folder = simulated / f"{SENSOR}.dng", tmp_path / "out"
    done("denoise", file, "--sensor", SENSOR, *METHOD, *AT, "-o", folder)
    there, here = (tifffile.imread(one / f"{SENSOR}.xyz.tiff") for one in (simulated, folder))
    assert np.abs(there).max() > 0.5
    np.testing.assert_allclose(here, there, atol=2e-6)


def test_the_noise_profile_of_a_dng_is_the_noise_of_its_pixel(simulated):
    frames = frames_in(simulated / f"{SENSOR}.dng")
    plan = prepared_denoising(frames, None, {}, denoise="lmmse")
    assert plan.noise.gain_e_per_dn == pytest.approx((10_000 / 4095) * 4095 / (4095 - 64))
    own = {"gain_dn_per_e": 1 / plan.noise.gain_e_per_dn, "time_ms": 12.0}
    pixel = prepared_denoising(frames, SENSOR, own, denoise="lmmse")
    assert "NoiseProfile" in plan.noise.source
    assert "NoiseProfile" not in pixel.noise.source
    one, other = (found.noise.law.coefficients for found in (pixel, plan))
    np.testing.assert_allclose(one, other, rtol=1e-12)
    assert pixel.noise.black_level_dn == plan.noise.black_level_dn == 64


def test_the_codes_are_written_as_tiff_and_as_dng_with_the_same_tags(done, simulated, tmp_path):
    file, folder = simulated / f"{SENSOR}.dng", tmp_path / "out"
    done("denoise", file, *METHOD, "-o", folder)
    result = cn.denoise(file, denoise="lmmse")
    tags = []
    for path in (file, folder / f"{SENSOR}.denoised.dng"):
        with tifffile.TiffFile(path) as opened:
            tags.append({tag.code: str(tag.value) for tag in opened.pages[0].tags})
    assert tags[0] == tags[1]
    codes = tifffile.imread(folder / f"{SENSOR}.denoised.dng")
    assert (codes == tifffile.imread(folder / f"{SENSOR}.denoised.tiff")).all()
    assert (codes == result.codes).all()
    expected = 64 + result.values_e / result.noise.gain_e_per_dn
    assert np.abs(codes - expected).max() <= 0.501
    assert summary_of(folder)["files"] == [path.name for path in sorted(folder.glob("*.d*"))][::-1]


def test_s_and_o_of_two_channels_give_the_variance_of_their_codes():
    profile = {"G": (0.0025, 0.01), "R": (0.005, 0.01)}
    levels = {"black_level_dn": 55, "white_level_dn": 255}
    noise = code_noise_of_profile(profile, ("R", "G"), source="a file", **levels)
    # at 100 codes above black: S 200 100 + O 200^2
    mean_e = 100 * noise.gain_e_per_dn
    variance_dn2 = (noise.law.floor_e2 + noise.law.slope_e * mean_e) / noise.gain_e_per_dn**2
    np.testing.assert_allclose(variance_dn2, [100 + 400, 50 + 400])


def test_without_an_illuminance_the_chart_has_the_mean_of_the_picture():
    (point,) = operating_points_of(cn.study_from_data({"sensors": [{"name": SENSOR}]}))
    raw_e = np.random.default_rng(1).random((8, 12), np.float32) * 300
    profile = dict.fromkeys("RGB", (1e-4, 1e-6))
    levels = {"black_level_dn": 0, "white_level_dn": 1000}
    noise = code_noise_of_profile(profile, tuple("RGB"), source="a file", **levels)
    scaled = at_brightness(point, mosaic_named("bayer"), raw_e, noise)
    red, green, blue = chart_electrons(scaled).mean(axis=0)
    assert (red + 2 * green + blue) / 4 == pytest.approx(raw_e.mean(), rel=1e-6)


@pytest.mark.parametrize("name", MOSAIC_NAMES)
def test_the_prior_without_a_sensor_is_a_covariance_of_correlated_planes(name):
    mosaic = mosaic_named(name)
    profile = dict.fromkeys(mosaic.names, (1e-4, 1e-6))
    levels = {"black_level_dn": 0, "white_level_dn": 1000}
    noise = code_noise_of_profile(profile, mosaic.names, source="a file", **levels)
    raw_e = np.random.default_rng(2).random((8, 8), np.float32) * 500 + 10
    prior = neutral_planes(raw_e, mosaic, noise).prior_e2
    spread = np.sqrt(np.diag(prior))
    assert np.linalg.eigvalsh(prior).min() > 0
    assert (prior / np.outer(spread, spread)).min() > 0.5


@pytest.mark.parametrize(("assumed_e", "ratio"), [(4.0, 1.0), (2.0, 2.0), (8.0, 0.5)])
def test_noise_is_measured_where_the_picture_is_smoothest(assumed_e, ratio):
    rng = np.random.default_rng(4)
    values = 4 * rng.standard_normal((96, 200, 1)) + 50 * np.indices((96, 200, 1))[0]
    values[:, 100:] += 40 * rng.standard_normal((96, 100, 1))  # detail in one half
    planes = planes_with(values, floor_e2=assumed_e**2)
    found = measured_noise_ratio(planes, np.zeros(values.shape, bool))
    assert found[0] == pytest.approx(ratio, rel=0.1)


def test_a_picture_without_usable_values_has_no_residual():
    result = denoised(np.full((24, 24), 4095, np.uint16), bits=12)
    assert result.summary["saturated_share"] == 1
    assert set(result.summary["residual"].values()) == {None}


def test_a_wrong_gain_is_reported(done, tmp_path):
    np.save(tmp_path / "flat.npy", flat(400, shape=(200, 240)))
    right, wrong = (
        summary_of(tmp_path / name)
        for name, gain in (("right", "0.5"), ("wrong", "1.5"))
        if done("denoise", tmp_path / "flat.npy", *METHOD, *KNOWN[:4], *KNOWN[6:],
                "--gain-dn-per-e", gain, "-o", tmp_path / name)
    )  # fmt: skip
    assert not any("smoothest" in note for note in right["notes"])
    assert any("smoothest" in note for note in wrong["notes"])
    assert all(0.9 < value < 1.1 for value in right["measured_noise"].values())
    assert all(value < 0.75 for value in wrong["measured_noise"].values())


@pytest.mark.parametrize("method", ["lmmse", "guided"])
@pytest.mark.parametrize("sensor", [None, SENSOR])
@pytest.mark.parametrize("seed", range(4))
def test_a_dark_picture_is_denoised_to_about_black(seed, sensor, method):
    result = denoised(flat(0, seed=seed), denoise=method, sensor=sensor, time_ms=12.0)
    assert np.isfinite(result.values_e).all()
    assert np.abs(result.values_e).max() < 2.5


def test_a_picture_below_black_is_refused():
    with refused_input(setting="black_level"):
        denoised(flat(0) - 2)


def test_saturated_pixels_keep_their_code_and_are_counted(tmp_path):
    codes = flat(400)
    codes[10, 10:14] = 4095
    codes[20, 20] = 0
    result = denoised(codes, bits=12)
    assert (result.codes[10, 10:14] == 4095).all()
    assert result.codes[20, 20] > 0
    assert result.summary["saturated_share"] == 4 / codes.size
    assert result.summary["code_0_share"] == 1 / codes.size
    assert repr(result).count("\n") == 0
    assert len(repr(result)) < 160


def test_a_dump_an_array_and_a_file_of_the_same_codes_give_the_same(tmp_path):
    codes = flat(300)
    np.save(tmp_path / "a.npy", codes)
    codes.astype("<u2").tofile(tmp_path / "a.raw")
    codes.astype(">u2").tofile(tmp_path / "b.raw")
    array = denoised(codes).values_e
    for file, more in (
        ("a.npy", {}),
        ("a.raw", {"shape": codes.shape}),
        ("b.raw", {"shape": codes.shape, "stored": "uint16-be"}),
    ):
        assert (denoised(tmp_path / file, unit=None, **more).values_e == array).all()


def test_electrons_need_neither_gain_nor_black_level():
    values_e = (flat(300).astype(np.float64) - 100) * 2
    result = cn.denoise(
        values_e, unit="e-", mosaic="RG/GB", read_noise_e=5.0, denoise="lmmse", prnu=0.01
    )
    assert result.codes is None
    np.testing.assert_array_equal(result.noise.law.floor_e2, [25.0] * 3)
    assert result.values_e.std() < 0.7 * values_e.std()


def test_a_burst_is_merged_before_it_is_denoised(tmp_path):
    for seed in range(4):
        np.save(tmp_path / f"{seed}.npy", flat(300, seed=seed))
    files = [tmp_path / f"{seed}.npy" for seed in range(4)]
    one, four = (denoised(files[:n], unit=None) for n in (1, 4))
    assert (one.summary["frames"], four.summary["frames"]) == (1, 4)
    assert four.values_e.std() < 0.75 * one.values_e.std()
    mean = np.mean([np.load(file) for file in files], axis=0)
    assert four.values_e.mean() == pytest.approx(2 * (mean.mean() - 100), rel=1e-3)


def without(option):
    i = KNOWN.index(option)
    return [*KNOWN[:i], *KNOWN[i + 2 :]]


@pytest.mark.parametrize(
    ("words", "fields"),
    [
        (without("--mosaic"), {"subject": "mosaic"}),
        (without("--black-level"), {"subject": "black_level"}),
        (without("--gain-dn-per-e"), {"subject": "gain_dn_per_e", "remedy_setting": "pixel"}),
        (without("--read-noise-e"), {"subject": "read_noise_e", "remedy_setting": "pixel"}),
        ([*KNOWN, "--white-level", "nan"], {"subject": "white_level"}),
        (["flat.npy", *KNOWN], {"subject": "flat.npy", "found": "is named twice"}),
        ([*without("--mosaic"), "--mosaic", "GRBG"], {"remedy": ("did you mean GR/BG?",)}),
        ([*without("--black-level"), "--black-level", "250"], {"subject": "black_level"}),
        ([*KNOWN, "--lux", "3"], {"subject": "lux", "value": 3.0}),
        ([*KNOWN, "--matrix", "lmmse"], {"subject": "matrix"}),
        ([*KNOWN, "--shape", "64x96"], {"subject": "shape"}),
        ([*KNOWN, "--white-level", "90"], {"subject": "white_level"}),
        ([*KNOWN, "--white-level", "inf"], {"subject": "white_level"}),
        ([*KNOWN, "--dark-current-e-per-s", "5"], {"subject": "time_ms"}),
        ([*without("--mosaic"), "--mosaic", "RGB"], {"subject": "mosaic"}),
        ([*KNOWN, "--sensor", "onyx-rgbw"], {"setting": "pictures.0.mosaic"}),
        ([*KNOWN, "--sensor", SENSOR, "--lux", "-1"], {"value": -1.0}),
        ([*KNOWN, "--pixel", "nothing.txt"], {"subject": "nothing.txt"}),
    ],
)
def test_what_is_not_known_or_wrong_is_refused_and_nothing_is_written(run, here, words, fields):
    np.save("flat.npy", flat(200))
    refused(run("denoise", "flat.npy", *METHOD, *words, "-o", "out"), **fields)
    assert sorted(path.name for path in here.iterdir()) == ["flat.npy"]


def test_codes_above_those_of_the_bits_are_refused_with_the_bits_that_they_need(run, here):
    codes = flat(200)
    codes[3, 4] = 16383
    np.save("flat.npy", codes)
    found = run("denoise", "flat.npy", *KNOWN, "-o", "out")
    refused(found, "16383", "4095", subject="bits", value=12)
    assert found.errors[0].remedy[0].values == (14,)


def test_all_that_is_missing_is_named_at_once(run, here):
    np.save("flat.npy", flat(200))
    found = run("denoise", "flat.npy", "-o", "out")
    refused(found)
    names = ["mosaic", "black_level", "gain_dn_per_e", "read_noise_e"]
    assert [error.subject for error in found.errors] == names


@pytest.mark.parametrize(
    ("given", "missing"), [("gain_dn_per_e", "read_noise_e"), ("read_noise_e", "gain_dn_per_e")]
)
def test_half_of_a_noise_does_not_give_way_to_the_noise_profile(simulated, given, missing):
    with refused_input(subject=missing):
        cn.denoise(simulated / f"{SENSOR}.dng", **{given: 3.0})


def test_the_summary_records_only_settings_that_take_part(simulated):
    file = simulated / f"{SENSOR}.dng"
    alone = cn.denoise(file, denoise="lmmse").summary["settings"]
    assert not {"lux", "f_number", "sensor", "illuminant"} & {*alone}
    known = cn.denoise(file, sensor=SENSOR, denoise="lmmse", time_ms=12.0).summary["settings"]
    assert (known["sensor"], known["lux"], known["time_ms"]) == (SENSOR, None, 12.0)


def test_results_of_denoise_cannot_be_rerun(run, done, here):
    np.save("flat.npy", flat(200))
    done("denoise", "flat.npy", *METHOD, *KNOWN, "-o", "out")
    refused(run("rerun", "out", "-o", "again"), subject="out")


def test_a_high_difference_of_neighbors_does_not_say_that_the_noise_is_wrong(tmp_path):
    texture = 200 + 100 * np.random.default_rng(5).random((200, 240))
    notes = denoised(flat(texture * 4, shape=texture.shape)).summary["notes"]
    (note,) = (one for one in notes if "smoothest" in one)
    assert "detail" in note
    assert "byte order" in note


@pytest.mark.parametrize(
    ("words", "part"),
    [(["a.raw"], "a.raw"), (["a.raw", "--shape", "64x95"], "12160"), (["a.jpg"], "a.jpg")],
)
def test_a_file_that_cannot_be_read_is_refused(run, here, words, part):
    flat(200).tofile("a.raw")
    (here / "a.jpg").write_bytes(b"\xff\xd8")
    refused(run("denoise", *words, *METHOD, *KNOWN, "-o", "out"), part)
    assert not (here / "out").exists()


def test_results_of_another_picture_are_not_replaced(run, done, here):
    for seed in (0, 1):
        np.save(f"{seed}.npy", flat(200, seed=seed))
    for _ in range(2):
        done("denoise", "0.npy", *METHOD, *KNOWN, "-o", "out")
    kept = (here / "out/summary.json").read_bytes()
    for words in (["1.npy"], ["0.npy", "1.npy"], ["0.npy", "--prnu", "0.01"]):
        refused(run("denoise", *words, *METHOD, *KNOWN, "-o", "out"), "out")
    assert (here / "out/summary.json").read_bytes() == kept


def test_an_array_needs_its_unit_and_a_file_none():
    with refused_input(subject="unit", value=None):
        cn.denoise(flat(100))
    with refused_input(subject="unit", value="DN"):
        cn.denoise("a.npy", unit="DN")
    with refused_input(subject="picture", requirement="integer"):
        cn.denoise(flat(100) / 2, unit="DN", denoise="lmmse")
    with refused_input(subject="picture", requirement="masked"):
        cn.denoise(np.ma.masked_greater(flat(100), 150), unit="DN", denoise="lmmse")
    below = flat(100).astype(np.int32)
    below[3, 5] = -7
    with refused_input(subject="picture", value=-7):
        denoised(below, bits=12)


def test_a_folder_is_no_argument():
    for sensor in (None, "onyx-rgb-ircut"):
        with refused_input(subject="folder", value=None):
            cn.denoise(flat(100), unit="DN", sensor=sensor, folder="out")


def test_the_name_of_a_sensor_says_nothing_of_its_read_noise(tmp_path):
    file = tmp_path / "read noise.csv"
    curves = [f"{nm},{0.5 * (nm < 600)},0.4,{0.3 * (nm > 500)}" for nm in range(400, 1060, 10)]
    file.write_text("\n".join(["wavelength_nm,R,G,B", *curves]))
    known = {"bits": 12, "time_ms": 10.0, "sensor": file}
    assert denoised(flat(300), **known).noise.law.floor_e2[0] > 25
    with refused_input(setting="read_noise_e"):
        denoised(flat(300), read_noise_e=None, **known)
