"""A camera from its own frames: what is drawn is found, and what is wrong is named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.apps.camera import (
    VirtualCamera,
    characterized,
    emva_sheet,
    light_sample,
    photon_transfer_frames,
    resumed,
    variance_through,
    variance_through_file,
)
from chromanoise.apps.camera.statistics import (
    fixed_patterns,
    hot_pixels,
    scaled_sample,
    spatial_variance,
)
from chromanoise.io.frames import FrameLevel, FrameSet, RawFrame, read_frame_set
from chromanoise.io.matrix_files import GivenMatrix
from outcomes import refused_input

CAMERA = VirtualCamera(
    shape=(120, 160),
    gain_dn_per_e=0.8,
    read_noise_e=4.0,
    full_well_e=4500.0,
    bits=12,
    black_level_dn=100,
    prnu=0.01,
    dsnu_e=2.0,
    row_noise_e=1.0,
    dark_current_e_per_s=50.0,
    qe=0.6,
    seed=5,
)


def frame(codes, name="f"):
    codes = np.asarray(codes)
    return RawFrame(path=Path(name), shape=codes.shape, read=lambda: codes)


def frames_of(folder, camera=CAMERA, **settings):
    photon_transfer_frames(camera, folder=folder, **({"levels": 14} | settings))
    return folder


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return cn.characterize(frames_of(tmp_path_factory.mktemp("camera") / "frames"))


@pytest.fixture(scope="module")
def of_mosaic(tmp_path_factory):
    """Four planes of 0.3, 0.6, 0.6 and 0.48 e-/photon."""
    camera = replace(CAMERA, mosaic="RG/GB", shape=(240, 320), sensitivity=(0.5, 1.0, 0.8))
    return cn.characterize(frames_of(tmp_path_factory.mktemp("mosaic") / "frames", camera))


def without_darks(frames):
    return replace(frames, levels=tuple(replace(one, darks=()) for one in frames.levels))


def assert_within_errors(plane, **true):
    for name, value in true.items():
        assert abs(getattr(plane, name) - value) < 4 * getattr(plane, f"{name}_se"), name


def noise(shape, *, pixel=0.0, row=0.0, column=0.0, seed=0, mean=1000.0):
    rng = np.random.default_rng(seed)
    values = mean + pixel * rng.standard_normal(shape)
    values += row * rng.standard_normal((shape[0], 1))
    values += column * rng.standard_normal((1, shape[1]))
    return values.round().astype(np.uint16)


# ---- statistics ----


def test_a_difference_of_known_numbers_has_the_variance_by_hand():
    # d = 2 (-1)^(i + j) + 7: the mean difference is light, half of the mean square is 2
    y, x = np.indices((8, 8))
    a = 100 + 2 * (-1) ** (y + x)
    (plane,) = light_sample([frame(a + 7), frame(np.full((8, 8), 100))], (1, 1)).planes
    rest = 2.0 * 64 / 49  # (rows - 1)(columns - 1) degrees of freedom
    assert plane.rest_dn2 == pytest.approx(rest)
    assert plane.row_dn2 == plane.column_dn2 == pytest.approx(-rest / 8)
    assert plane.frame_means_dn == (107.0, 100.0)
    # -1, and 1 / 7 for the mean of a row or column that was subtracted
    assert plane.correlation_right == plane.correlation_down == pytest.approx(-6 / 7)


def test_rows_columns_and_rest_are_told_apart():
    pair = [frame(noise((400, 500), pixel=9.0, row=3.0, column=2.0, seed=i)) for i in (1, 2)]
    (plane,) = light_sample(pair, (1, 1)).planes
    assert plane.rest_dn2 == pytest.approx(81 + 1 / 12, rel=5 * (2 / 200_000) ** 0.5)
    assert plane.row_dn2 == pytest.approx(9.0, abs=4 * plane.row_se_dn2)
    assert plane.column_dn2 == pytest.approx(4.0, abs=4 * plane.column_se_dn2)
    assert plane.row_se_dn2 == pytest.approx(9 * (2 / 400) ** 0.5, rel=0.3)


def test_the_error_of_the_variance_is_that_of_repetition():
    z = []
    for i in range(120):
        pair = [
            frame(noise((60, 80), pixel=20.0, row=4.0, seed=2 * i + k, mean=2000)) for k in (0, 1)
        ]
        (plane,) = light_sample(pair, (1, 1)).planes
        error = plane.variance_dn2 * (2 / (plane.samples - 1)) ** 0.5
        z.append((plane.variance_dn2 - 416 - 1 / 12) / error)
    assert abs(np.mean(z)) < 0.4
    assert np.std(z) == pytest.approx(1.0, abs=0.25)


def test_more_frames_have_the_information_of_overlapping_differences():
    frames = [frame(noise((40, 50), pixel=5.0, seed=i)) for i in range(4)]
    few, many = light_sample(frames[:2], (1, 1)), light_sample(frames, (1, 1))
    ratio = (many.planes[0].samples - 1) / (few.planes[0].samples - 1)
    assert ratio == pytest.approx(2 * 3**2 / (3 * 4 - 4), rel=0.02)  # 2.25 of at most 3


def test_each_plane_of_a_mosaic_has_its_own_variance():
    rng = np.random.default_rng(3)
    sd = np.tile([[2.0, 8.0], [8.0, 4.0]], (100, 150))
    pair = [
        frame((500 + sd * rng.standard_normal(sd.shape)).round().astype(np.int32)) for _ in "ab"
    ]
    variances = [one.variance_dn2 for one in light_sample(pair, (2, 2)).planes]
    assert variances == pytest.approx([4 + 1 / 12, 64 + 1 / 12, 64 + 1 / 12, 16 + 1 / 12], rel=0.06)


def test_a_fixed_pattern_is_found_without_the_temporal_noise():
    rng = np.random.default_rng(4)
    pattern = 6.0 * rng.standard_normal((200, 200))
    frames = [
        frame((1000 + pattern + 10 * rng.standard_normal((200, 200))).round().astype(np.uint16))
        for _ in range(2)
    ]
    (plane,) = light_sample(frames, (1, 1)).planes
    total = fixed_patterns(frames, (1, 1), [0])[0]
    for filtered in (False, True):
        one = spatial_variance(total, plane, high_pass=filtered)
        assert one.variance_dn2 == pytest.approx(pattern.var(), abs=4 * one.se_dn2)
        assert one.se_dn2 < 3.0


def test_the_high_pass_takes_shading_away_and_keeps_the_pattern():
    y, _ = np.indices((200, 200))
    pattern = np.random.default_rng(5).standard_normal((200, 200))
    shaded = 500_000 * (1 - 0.3 * (y / 199 - 0.5) ** 2) + 5000 * pattern
    total = fixed_patterns([frame(shaded.round().astype(int))], (1, 1), [0])[0]
    total = replace(total, frames=1000)
    (plane,) = light_sample([frame(np.zeros((200, 200), int))] * 2, (1, 1)).planes
    plain, filtered = (
        spatial_variance(total, plane, high_pass=one).variance_dn2 for one in (False, True)
    )
    assert plain > 100
    assert filtered == pytest.approx(25.0, rel=0.03)


@pytest.mark.parametrize("sigma", [0.3, 0.5, 3.0])
def test_hot_pixels_are_counted_and_normal_ones_are_not(sigma):
    rng = np.random.default_rng(6)
    dark = [(100 + sigma * rng.standard_normal((300, 300))).round().astype(int) for _ in range(2)]
    (plane,) = light_sample([frame(one) for one in dark], (1, 1)).planes
    for hot in (0, 2):
        for one in dark:
            one[[3, 200][:hot], [4, 7][:hot]] = 100 + 30 * max(sigma, 1)
        pattern = fixed_patterns([frame(one) for one in dark], (1, 1), [0])[0]
        assert hot_pixels(pattern, plane) == hot


@pytest.mark.parametrize("shape", [(40, 3000), (3000, 40)])
def test_white_noise_of_long_frames_has_no_correlation_of_neighbors(shape):
    pair = [frame(noise(shape, pixel=8.0, seed=i)) for i in (1, 2)]
    (plane,) = light_sample(pair, (1, 1)).planes
    assert abs(plane.correlation_right) < 5 / np.sqrt(shape[0] * shape[1])
    assert abs(plane.correlation_down) < 5 / np.sqrt(shape[0] * shape[1])


# ---- light that changes from frame to frame ----


def lit(signal, pattern, *, black=200.0, dark=0.0, seed=0):
    """Codes of a light with a fixed pattern and temporal noise in the dark. [DN]"""
    noise_dn = dark * np.random.default_rng(seed).standard_normal(pattern.shape)
    return frame((black + signal * pattern + noise_dn).round().astype(np.int32), f"f{seed}")


def test_a_pattern_that_grows_with_the_light_has_no_temporal_variance():
    y, x = np.indices((64, 80))
    pattern = 1 - 0.4 * (y / 63 - 0.5) ** 2 - 0.2 * (x / 79 - 0.5) ** 2
    frames, tile = [lit(20_000.0 * light, pattern) for light in (1.0, 1.1, 0.95)], (2, 2)
    plain = light_sample(frames, tile)
    scaled = scaled_sample(frames, tile, plain, [(200.0, 0.0)] * 4)
    for before, one in zip(plain.planes, scaled.planes, strict=True):
        assert before.variance_dn2 > 500
        assert one.variance_dn2 == pytest.approx(1 / 12, rel=0.1)
        assert one.frame_means_dn == before.frame_means_dn
        assert max(abs(one.correlation_right), abs(one.correlation_down)) < 0.15
    assert np.abs(scaled.covariance_dn2).max() < 0.1


@pytest.mark.parametrize("lights", [(1.0, 1.6), (1.6, 1.0, 1.3)], ids=str)
def test_scaled_frames_have_the_shot_noise_of_their_mean_and_the_noise_in_the_dark_once(lights):
    """By draws: the temporal variance is dark + K times the mean signal, for any two lights."""
    rng, gain, dark_dn = np.random.default_rng(8), 0.5, 30.0
    pattern = 1 + 0.05 * rng.standard_normal((500, 600))

    def drawn(light):
        electrons = rng.poisson(2000 * light * pattern) + dark_dn / gain * rng.standard_normal(
            pattern.shape
        )
        return frame((300 + gain * electrons).round().astype(np.int32))

    frames = [drawn(light) for light in lights]
    plain = light_sample(frames, (1, 1))
    (one,) = scaled_sample(frames, (1, 1), plain, [(300.0, dark_dn**2 + 1 / 12)]).planes
    signal = gain * 2000 * np.mean(lights)
    error = one.variance_dn2 * np.sqrt(2 / (one.samples - 1))
    assert abs(one.variance_dn2 - gain * signal - dark_dn**2 - 1 / 12) < 4 * error
    assert plain.planes[0].variance_dn2 > gain * signal + dark_dn**2 + 20 * error


def flickering(camera, change, *, seed, levels=6):
    """Frames of a lamp whose light scatters by the share ``change`` from flat to flat."""
    (truth,), rng, levels_ = camera.planes(), np.random.default_rng(seed), []
    for i in range(levels):
        photons = 1.1 * truth.full_well_e / truth.qe * (i + 1) / levels
        factors = 1 + change * rng.standard_normal(2)
        flats = [
            camera.frame(photons_per_pixel=photons * f, time_ms=1.0, number=4 * i + k)
            for k, f in enumerate(factors)
        ]
        darks = [camera.frame(dark=True, time_ms=1.0, number=4 * i + k) for k in (2, 3)]
        levels_.append(level(f"level {i}", *flats, darks=darks))
    return frame_set(*levels_)


def errors_of_shaded_cameras(cameras, change, shading):
    """(found - true) / stated error of K and PRNU."""
    z = {"gain_dn_per_e": [], "prnu": []}
    for seed in range(cameras):
        camera = VirtualCamera(
            shape=(96, 120), gain_dn_per_e=0.15, read_noise_e=4.0, full_well_e=1e5, bits=14,
            black_level_dn=200, prnu=0.01, dsnu_e=5.0, shading=shading, seed=seed,
        )  # fmt: skip
        (plane,) = characterized(flickering(camera, change, seed=seed)).planes
        for name, found in z.items():
            true = getattr(camera.planes()[0], name)
            found.append((getattr(plane, name) - true) / getattr(plane, f"{name}_se"))
    return z


@pytest.mark.parametrize(("change", "shading"), [(0.03, 0.3), (0.0, 0.6)])
def test_gain_and_prnu_are_right_under_shading_and_a_lamp_that_flickers(change, shading):
    for name, z in errors_of_shaded_cameras(8, change, shading).items():
        assert abs(np.mean(z)) * 8**0.5 < 4, name
        assert np.abs(z).max() < 4, name


@pytest.mark.evidence
@pytest.mark.parametrize(("change", "shading"), [(0.03, 0.3), (0.01, 0.6), (0.0, 0.2)])
def test_stated_errors_are_right_under_shading_and_a_lamp_that_flickers(change, shading):
    for name, z in errors_of_shaded_cameras(400, change, shading).items():
        print(name, np.mean(z), np.std(z))
        assert abs(np.mean(z)) * 400**0.5 < 5, name
        assert 0.9 < np.std(z) < 1.1, name


def test_without_a_dark_the_frames_are_not_scaled_and_the_verdict_says_so():
    frames = flickering(replace(CAMERA, shading=0.3), 0.03, seed=1, levels=14)
    both = frames, without_darks(frames)
    known, unknown = (characterized(one).verdict.sentences for one in both)
    assert any("scaled to one mean before" in one for one in known)
    assert any("is not known" in one for one in unknown)


def test_an_offset_that_wanders_is_no_change_of_the_light():
    rng, levels_ = np.random.default_rng(3), []
    for i, signal in enumerate((1e-4, 400.0, 800.0, 1200.0, 1600.0)):

        def codes(light, offset):
            mean = 100 + offset + 0.5 * rng.poisson(2 * light, (100, 120))
            return (mean + 3 * rng.standard_normal(mean.shape)).round().astype(np.int32)

        flats, darks = ([codes(one, off) for off in (-0.3, 0.3)] for one in (signal, 0.0))
        levels_.append(level(f"level {i}", *flats, darks=darks))
    found = characterized(frame_set(*levels_))
    assert found.planes[0].levels[0].drift_z > 5  # of the pixels alone
    assert not any("light changed" in one for one in found.verdict.sentences)


# ---- black level and stored codes ----

SUBTRACTED = VirtualCamera(  # clips at code 0, as cameras that subtract their black level
    shape=(160, 200), gain_dn_per_e=0.8, read_noise_e=5.0, full_well_e=4500.0, bits=12,
    black_level_dn=0, prnu=0.01, qe=0.6, seed=5,
)  # fmt: skip


def stated(folder, *lines):
    """The folder with further lines in its ``capture.toml``."""
    path = folder / "capture.toml"
    path.write_text("\n".join([*lines, path.read_text()]))
    return folder


def test_read_noise_behind_a_clipped_black_level_is_that_of_the_flats(tmp_path):
    folder = frames_of(tmp_path / "f", SUBTRACTED, levels=24)
    result = cn.characterize(folder)
    (plane,) = result.planes
    assert not result.verdict.holds
    assert plane.dark_noise_e is plane.black_level_dn is plane.dsnu_e is None
    (plane,) = cn.characterize(stated(folder, "black_level_dn = 0")).planes
    assert plane.black_level_dn == 0.0
    assert_within_errors(plane, dark_noise_e=5.0, gain_dn_per_e=0.8, qe=0.6, full_well_e=4500.0)
    assert plane.dark_noise_e_se < 2.0
    assert plane.linearity_error_percent < 0.5


def test_a_stated_black_level_that_the_darks_contradict_is_noted(tmp_path):
    folder = frames_of(tmp_path / "f", levels=6)
    path, found = folder / "capture.toml", []
    text = path.read_text()
    for line in ("", "black_level_dn = 100\n", "black_level_dn = 4000\n"):
        path.write_text(line + text)
        found.append(cn.characterize(folder))
    plain, right, wrong = found
    assert right.notes == plain.notes
    (note,) = set(wrong.notes) - set(plain.notes)
    assert "4000" in note
    assert wrong.planes[0].black_level_dn == plain.planes[0].black_level_dn


@pytest.mark.parametrize("by", ["list", "file"])
def test_flats_alone_give_the_read_noise_above_a_stated_black_level(tmp_path, by):
    folder = frames_of(tmp_path / "f", levels=24)
    if by == "list":
        stated(folder, "black_level_dn = 100")
    frames = without_darks(read_frame_set([folder]))
    if by == "file":
        levels = (
            replace(one, flats=tuple(replace(f, black_level_dn=100.0) for f in one.flats))
            for one in frames.levels
        )
        frames = replace(frames, levels=tuple(levels))
    (plane,) = characterized(frames).planes
    assert plane.black_level_dn == 100.0
    assert_within_errors(plane, dark_noise_e=17**0.5, qe=0.6, full_well_e=4500.0)


def test_the_list_overrides_the_black_level_of_a_file_with_a_note(tmp_path):
    folder = stated(frames_of(tmp_path / "f", levels=3), "black_level_dn = 0")
    assert read_frame_set([folder]).black_level_dn == 0.0
    with refused_input(where="black_level_dn", value=-1):
        read_frame_set([stated(frames_of(tmp_path / "g", levels=3), "black_level_dn = -1")])


@pytest.mark.parametrize(
    ("step", "offset", "bits"), [(16, 0, 16), (16, 0, 12), (16, 0, None), (4, 3, 14)], ids=str
)
def test_codes_stored_as_multiples_give_the_values_of_the_codes(tmp_path, step, offset, bits):
    """A converter of 12 bits in 16: its step is no noise of 14.8 e-, but one code."""
    folder = frames_of(tmp_path / "f", replace(CAMERA, mosaic="RG/GB"), levels=8)
    plain = cn.characterize(folder)
    for path in folder.glob("*.npy"):
        np.save(path, np.load(path) * np.uint16(step) + np.uint16(offset))
    text = (folder / "capture.toml").read_text()
    line = "" if bits is None else f"bits = {bits}\nblack_level_dn = {100 * step + offset}"
    (folder / "capture.toml").write_text(text.replace("bits = 12", line))
    shifted = cn.characterize(folder)
    assert shifted.bits == (None if bits is None else 12)
    assert len(shifted.notes) == len(plain.notes) + 1
    for one, other in zip(plain.planes, shifted.planes, strict=True):
        for name in ("gain_dn_per_e", "dark_noise_e", "black_level_dn", "dsnu_e", "prnu", "qe",
                     "full_well_e", "row_noise_e", "dark_noise_e_se"):  # fmt: skip
            assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-9), name
    assert shifted.covariance_dn2 == pytest.approx(plain.covariance_dn2, rel=1e-9, abs=1e-9)


# ---- a whole camera ----


TRUE = {
    "gain_dn_per_e": 0.8,
    "dark_noise_e": (16 + 1) ** 0.5,
    "qe": 0.6,
    "black_level_dn": 100.0,
    "full_well_e": 4500.0,
    "dark_current_e_per_s": 50.0,
    "dsnu_e": 2.0,
    "prnu": 0.01,
    "row_noise_e": 1.0,
}


def test_each_value_of_a_virtual_camera_is_found_within_its_error(found):
    (plane,) = found.planes
    assert_within_errors(plane, **TRUE)
    for name, true in TRUE.items():
        assert getattr(plane, f"{name}_se") < 0.08 * true, name


def test_an_ideal_camera_follows_the_linear_model(found):
    assert found.verdict.holds
    assert found.verdict.sentences == ()
    assert found.verdict.chi2_per_level < 3.0
    assert found.planes[0].linearity_error_percent < 0.5
    assert not any("multiples" in note for note in found.notes)


def test_the_table_and_the_data_sheet_have_one_dynamic_range(found):
    (plane,) = found.planes
    (row,) = [line for line in emva_sheet(found, plane).splitlines() if line.startswith("DR = ")]
    assert float(row.split()[2]) == plane.dynamic_range_db
    least = np.sqrt(plane.dark_noise_e**2 + 1 / (12 * plane.gain_dn_per_e**2)) + 0.5
    top = max(plane.levels, key=lambda one: one.variance_dn2)
    assert plane.saturation_capacity_e == pytest.approx(plane.qe * top.photons_per_pixel, rel=1e-12)
    assert 10 ** (plane.dynamic_range_db / 20) * least == pytest.approx(plane.saturation_capacity_e)


def test_frames_are_not_modified_and_the_result_is_the_same_again(tmp_path):
    folder = frames_of(tmp_path / "f", levels=6)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    first, again = cn.characterize(folder).to_dict(), cn.characterize(folder).to_dict()
    assert first == again
    assert before == {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize(
    ("fault", "word"),
    [
        ({"bend": 0.3}, "straight line"),
        ({"neighbor_correlation": 0.2}, "neighbors"),
        ({"drift": 0.02}, "light changed"),
    ],
)
def test_what_contradicts_the_model_is_named_with_its_frames(tmp_path, fault, word):
    camera = replace(CAMERA, shape=(200, 240), **fault)
    verdict = cn.characterize(frames_of(tmp_path / "f", camera)).verdict
    assert not verdict.holds
    (sentence, *_) = [one for one in verdict.sentences if word in one]
    if word != "straight line":
        assert ".npy" in sentence


@pytest.mark.parametrize(("sigma_dn", "well_e", "black_dn"), [(0.3, 6000, 8), (0.35, 15000, 11)])
def test_rounding_to_8_bits_is_no_bend(tmp_path, sigma_dn, well_e, black_dn):
    gain = 140 / well_e
    camera = VirtualCamera(
        shape=(240, 320), bits=8, gain_dn_per_e=gain, full_well_e=well_e, seed=3,
        black_level_dn=black_dn, read_noise_e=sigma_dn / gain, dsnu_e=0.1 / gain, prnu=0.008,
    )  # fmt: skip
    found = cn.characterize(frames_of(tmp_path / "f", camera, levels=12))
    assert abs(found.planes[0].bend_z) < 4
    assert found.verdict.holds


@pytest.mark.evidence
def test_a_bend_of_3_percent_is_found_at_12_bits(tmp_path):
    camera = replace(CAMERA, shape=(480, 640), bend=0.03, full_well_e=4500.0)
    plane = cn.characterize(frames_of(tmp_path / "f", camera, levels=12, frames=3)).planes[0]
    assert plane.bend_z < -5
    assert plane.fit.high_light_gain_dn_per_e < 0.98 * plane.fit.low_light_gain_dn_per_e


def test_prnu_of_each_plane_is_found_where_all_codes_end_at_the_top(tmp_path):
    camera = replace(
        CAMERA,
        mosaic="RG/GB",
        shape=(200, 240),
        sensitivity=(0.45, 1.0, 0.5),
        full_well_e=8000.0,  # codes end at 5000 e-
        prnu=0.02,
    )
    found = cn.characterize(frames_of(tmp_path / "f", camera, levels=24))
    for plane in found.planes:
        assert_within_errors(plane, prnu=0.02)
        assert plane.prnu_se < 0.004


def test_frames_of_one_npz_are_told_apart(tmp_path):
    folder = frames_of(tmp_path / "f", levels=6)
    plain = cn.characterize(folder)
    lines = ["bits = 12"]
    for i, level in enumerate(read_frame_set([folder]).levels):
        named = {f"f{k}": one.codes() for k, one in enumerate(level.flats)}
        named |= {f"d{k}": one.codes() for k, one in enumerate(level.darks)}
        np.savez(tmp_path / f"{i}.npz", **named)
        lines += ["[[levels]]", f'flats = ["{i}.npz[f0]", "{i}.npz[f1]"]']
        lines += [f'darks = ["{i}.npz[d0]", "{i}.npz[d1]"]', f"time_ms = {level.time_ms}"]
        lines += [f"photons_per_pixel = {level.photons_per_pixel}"]
    (tmp_path / "capture.toml").write_text("\n".join(lines))
    packed = cn.characterize(tmp_path / "capture.toml")
    for name in ("gain_dn_per_e", "dark_noise_e", "prnu", "qe"):
        assert getattr(packed.planes[0], name) == getattr(plain.planes[0], name)


def test_without_darks_gain_is_found_and_the_rest_is_unknown(tmp_path):
    folder = frames_of(tmp_path / "f")
    (plane,) = characterized(without_darks(read_frame_set([folder]))).planes
    assert_within_errors(plane, gain_dn_per_e=0.8)
    assert plane.dark_noise_e is plane.dsnu_e is plane.row_noise_e is None


def test_one_dark_of_a_level_is_refused_by_name(tmp_path):
    folder = frames_of(tmp_path / "f", levels=6, darks=1)
    with refused_input(value=1, where="level 'level 1'"):
        cn.characterize(folder)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"shape": (60, 60), "shading": 0.3}, "shading"),
        ({"black_level_dn": 1, "dark_current_e_per_s": 0.0}, "code 0"),
    ],
)
def test_small_planes_and_clipped_darks_are_named(tmp_path, changes, word):
    found = cn.characterize(frames_of(tmp_path / "f", replace(CAMERA, **changes)))
    assert any(word in one for one in (*found.notes, *found.verdict.sentences))


def test_planes_of_a_mosaic_are_told_apart(of_mosaic):
    assert [plane.name for plane in of_mosaic.planes] == ["R", "G1", "G2", "B"]
    qe = np.array([plane.qe for plane in of_mosaic.planes])
    assert qe / 0.6 == pytest.approx([0.5, 1.0, 1.0, 0.8], rel=0.03)
    assert np.abs(of_mosaic.correlation - np.eye(4)).max() < 5 / (120 * 160) ** 0.5


def test_predicted_variance_through_a_matrix_is_the_measured_one(of_mosaic):
    to_xyz = np.array([[0.7, 0.2, 0.1], [0.3, 0.9, -0.2], [0.0, -0.3, 1.2]])
    check = variance_through(of_mosaic, to_xyz, ("R", "G", "B"))
    assert check.measured.shape == (14, 3)
    assert np.abs(check.mean_error).max() < 0.01
    assert (check.names, sum(check.fitted) > 3) == (("1", "2", "3"), True)
    with refused_input(subject="matrix", value=("R", "G", "C")):
        variance_through(of_mosaic, to_xyz, ("R", "G", "C"))


def test_a_matrix_of_white_balanced_raw_weighs_each_channel_by_its_white(of_mosaic):
    given = GivenMatrix(source="m.csv", kind="balanced", target="sRGB", values=np.eye(3))
    check = variance_through_file(of_mosaic, given)
    assert check.names == ("R", "G", "B")
    k = max(i for i, fitted in enumerate(check.fitted) if fitted)
    electrons = [  # of the cell: two greens are averaged, so that their noise is that of the sum
        sum(
            (plane.levels[k].mean_dn - plane.levels[k].dark_mean_dn) / plane.gain_dn_per_e
            for plane in of_mosaic.planes
            if plane.name.startswith(name)
        )
        for name in "RGB"
    ]
    assert check.predicted[k] == pytest.approx(1 / np.array(electrons), rel=0.1)  # read noise


# ---- stopped runs ----


def test_a_stopped_run_goes_on_with_what_it_has_read(tmp_path):
    folder, kept = frames_of(tmp_path / "f", levels=6), tmp_path / "kept.json"
    frames, read = read_frame_set([folder]), []

    def counted(group, tile):
        read.append(len(group))
        if len(read) == 4:
            raise KeyboardInterrupt
        return resumed(kept)(group, tile)

    with pytest.raises(KeyboardInterrupt):
        characterized(frames, sampled=counted)
    again = cn.characterize(folder, resume=kept)
    assert again.to_dict() == cn.characterize(folder).to_dict()
    kept.write_text(kept.read_text().replace('"mean_variance_dn2"', '"other"'))
    with refused_input(subject=str(kept)):
        cn.characterize(folder, resume=kept)


# ---- refusals ----


def frame_set(*levels):
    return FrameSet(source="frames", levels=tuple(levels))


def level(name, *images, darks=()):
    named = [frame(one, f"{name}_{i}.npy") for i, one in enumerate(images)]
    dark = [frame(one, f"{name}_dark_{i}.npy") for i, one in enumerate(darks)]
    return FrameLevel(name=name, flats=tuple(named), darks=tuple(dark))


FLAT = noise((20, 20), pixel=3.0, mean=400.0)


@pytest.mark.parametrize(
    ("given", "fields"),
    [
        (level("b", FLAT), {"subject": "frames", "value": 1, "where": "level 'b'"}),
        (
            level("b", noise((20, 20)), noise((20, 24))),
            {"subject": "frames", "value": ((20, 20), (20, 24))},
        ),
        (level("b", FLAT, noise((20, 20), pixel=3.0, mean=900.0)), {"subject": "b_1.npy"}),
        (level("b", darks=(FLAT, FLAT)), {"subject": "frames"}),
    ],
    ids=["one flat", "two sizes", "two lights", "darks alone"],
)
def test_frames_that_give_no_photon_transfer_are_refused(given, fields):
    with refused_input(**fields):
        characterized(frame_set(given))
