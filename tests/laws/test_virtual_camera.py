"""The virtual camera: its codes follow laws computed with scipy; folders are whole or absent."""

import io
import math
import tomllib
from dataclasses import asdict, replace

import numpy as np
import pytest
import tifffile
from PIL import Image
from scipy import stats

from chromanoise.apps.camera import VirtualCamera, photon_transfer_frames
from chromanoise.apps.camera.virtual_camera import FRAME_FORMATS
from chromanoise.sensor.noise_sources import SOURCES
from goodness import chi_square_score, correlation_z
from outcomes import refused_input

QUIET = {"shape": (200, 300), "black_level_dn": 500.0, "gain_dn_per_e": 1.0, "qe": 1.0}


def quiet(**settings):
    """A camera without any noise but that of the light."""
    return VirtualCamera(**QUIET | settings)


def chi_square(codes, share):
    """Score of codes against the chance of each code; rare codes are joined."""
    found = np.bincount(codes.ravel(), minlength=share.size).astype(float)
    order = np.argsort(share)
    joined = np.searchsorted(np.cumsum(share[order]), 20 / codes.size, side="right") + 1
    rare, kept = order[:joined], order[joined:]
    return chi_square_score(
        np.append(found[kept], found[rare].sum()), np.append(share[kept], share[rare].sum())
    )


def share_of_codes(*, mean_e, well_e, read_e, gain, black_dn, bits):
    """Chance of each code: a sum over the electrons of chances of the Gaussian readout."""
    most = int(mean_e + 12 * math.sqrt(mean_e) + 30)
    electrons = np.arange(most)
    chance = stats.poisson.pmf(electrons, mean_e)
    edges = np.arange(1, 2**bits) - 0.5
    centers = black_dn + gain * np.minimum(electrons, well_e)
    below = stats.norm.cdf(edges[:, None], centers, gain * read_e) @ chance
    return np.diff(below, prepend=0.0, append=1.0)


@pytest.mark.parametrize(
    ("mean_e", "gain", "black_dn"),
    [(20.0, 2.0, 20.3), (55.0, 2.0, 20.3), (58.0, 4.0, 15.0), (3.0, 2.5, 1.0)],
    ids=["light", "at full well", "at the largest code", "at code 0"],
)
def test_codes_follow_the_law_of_poisson_electrons_gaussian_readout_and_rounding(
    mean_e, gain, black_dn
):
    values = {"read_noise_e": 1.5, "full_well_e": 60.0, "bits": 8, "black_level_dn": black_dn}
    camera = VirtualCamera(shape=(400, 400), gain_dn_per_e=gain, qe=0.4, seed=3, **values)
    codes = camera.frame(photons_per_pixel=mean_e / 0.4, time_ms=1.0)
    law = share_of_codes(
        mean_e=mean_e, well_e=60.0, read_e=1.5, gain=gain, black_dn=black_dn, bits=8
    )
    assert codes.dtype == np.uint16
    assert abs(chi_square(codes, law)) < 5


def test_dark_electrons_follow_poisson_and_their_mean_stays_in_the_codes():
    camera = quiet(dark_current_e_per_s=400.0, black_level_dn=0.0)
    dark = camera.frame(time_ms=30.0, dark=True)
    assert abs(chi_square(dark, stats.poisson.pmf(np.arange(4096), 12.0))) < 5
    lit = camera.frame(electrons=5.0, time_ms=30.0)
    assert abs(chi_square(lit, stats.poisson.pmf(np.arange(4096), 17.0))) < 5


def test_a_camera_without_noise_shows_the_black_level_in_the_dark():
    assert (quiet(shading=0.5, prnu=0.1, bend=0.3).frame(time_ms=50.0, dark=True) == 500).all()


def test_dsnu_is_a_gaussian_offset_that_is_the_same_in_every_frame():
    camera = quiet(dsnu_e=30.0)
    first, second = (camera.frame(time_ms=t, dark=True, number=n) for t, n in ((1, 0), (9, 4)))
    assert (first == second).all()
    jitter = np.random.default_rng(0).uniform(-0.5, 0.5, first.shape)  # undoes the rounding
    found = stats.kstest((first + jitter).ravel() - 500.0, stats.norm(0.0, 30.0).cdf)
    assert found.pvalue > 1e-6


def test_prnu_is_a_gaussian_factor_of_the_light_that_is_the_same_in_every_frame():
    camera = quiet(prnu=0.02, bits=16, gain_dn_per_e=4e-4, full_well_e=1e9)
    frames = [camera.frame(electrons=1e8, time_ms=1.0, number=n) / 4e4 for n in range(2)]
    response = np.mean(frames, axis=0) - 500 / 4e4
    found = stats.kstest(response.ravel(), stats.norm(1.0, math.hypot(0.02, 1e-4)).cdf)
    assert found.pvalue > 1e-6
    # shot noise and rounding: 1e4 electrons are 4 codes
    assert 3.9 < np.std(4e4 * (frames[0] - frames[1])) / math.sqrt(2) < 4.1


@pytest.mark.parametrize("axis", [0, 1], ids=["columns", "rows"])
def test_row_and_column_noise_is_one_gaussian_offset_per_line_and_frame(axis):
    setting = ("column_noise_e", "row_noise_e")[axis]
    camera = quiet(shape=(400, 400), **{setting: 20.0})
    lines = []
    for number in range(2):
        codes = camera.frame(time_ms=1.0, dark=True, number=number).astype(float) - 500
        assert (np.ptp(codes, axis=axis) == 0).all()
        lines.append(codes.mean(axis=axis))
    both = np.concatenate(lines)
    chi2 = (both**2).sum() / (20.0**2 + 1 / 12)
    assert abs(stats.norm.isf(stats.chi2(both.size).sf(chi2))) < 5
    assert abs(correlation_z(*lines)) < 5


LIGHT_E, TIME_MS = 400.0, 30.0
TEMPORAL_E2 = {
    "shot noise": ({}, LIGHT_E),
    "read noise": ({"read_noise_e": 12.0}, LIGHT_E + 144.0),
    "dark current": ({"dark_current_e_per_s": 5000.0}, LIGHT_E + 150.0),
    "quantization": ({"gain_dn_per_e": 0.25}, LIGHT_E + 16 / 12),
    "row noise": ({"row_noise_e": 11.0}, LIGHT_E + 121.0),
    "column noise": ({"column_noise_e": 11.0}, LIGHT_E + 121.0),
    "reset noise": ({"reset_capacitance_ff": 19.2, "temperature_c": 20.0}, LIGHT_E + 55.021**2),
    "telegraph noise": ({"rtn_share": 0.3, "rtn_amplitude_e": 40.0}, LIGHT_E + 0.3 * 400.0),
    "DSNU": ({"dsnu_e": 20.0}, LIGHT_E),
    "PRNU": ({"prnu": 0.1}, LIGHT_E),
}
"""Settings of a camera with one source besides shot noise, and its temporal variance. [e-^2]

Reset noise of 19.2 fF at 20 C: 55.021 e-, k T C by the constants of the SI.
"""


def test_every_source_but_that_of_the_places_of_a_mosaic_has_its_case():
    assert {one.cause for one in SOURCES if one.drawn != "place"} == set(TEMPORAL_E2)


@pytest.mark.parametrize("cause", TEMPORAL_E2)
def test_the_frames_of_a_camera_differ_by_the_temporal_variance_of_each_source(cause):
    settings, variance_e2 = TEMPORAL_E2[cause]
    camera = quiet(**{"shape": (100, 100), "gain_dn_per_e": 4.0, "bits": 16, "seed": 1} | settings)
    frames = [
        camera.frame(electrons=LIGHT_E, time_ms=TIME_MS, number=n) / camera.gain_dn_per_e
        for n in range(80)
    ]
    halves = [np.square(a - b).mean() / 2 for a, b in zip(frames[::2], frames[1::2], strict=True)]
    expected = variance_e2 + (1 / 12 / 4.0**2 if cause != "quantization" else 0.0)
    error = np.std(halves, ddof=1) / math.sqrt(len(halves))
    assert abs(np.mean(halves) - expected) < 5 * error
    assert error < 0.02 * expected


def test_the_same_pixels_switch_between_two_levels_in_every_frame():
    camera = quiet(rtn_share=0.1, rtn_amplitude_e=40.0)
    codes = [camera.frame(time_ms=1.0, dark=True, number=n).astype(int) - 500 for n in range(20)]
    assert {*np.unique(codes)} == {-20, 0, 20}
    switching = np.abs(codes).max(axis=0) > 0
    assert (np.abs(codes)[:, switching] == 20).all()
    count, chance = switching.size, 0.1
    assert abs(switching.sum() - count * chance) < 5 * math.sqrt(count * chance * (1 - chance))
    up = (np.array(codes)[:, switching] > 0).mean()
    assert abs(up - 0.5) < 5 * 0.5 / math.sqrt(20 * switching.sum())


def test_the_dark_current_of_a_warm_camera_is_that_at_its_temperature():
    warm = {"temperature_c": 39.0, "dark_reference_c": 25.0, "dark_doubling_k": 7.0}  # 2 doublings
    camera = quiet(dark_current_e_per_s=1000.0, **warm)
    codes = camera.frame(time_ms=30.0, dark=True) - 500.0
    assert abs(codes.mean() - 120.0) < 5 * math.sqrt(120.0 / codes.size)
    assert camera.planes()[0].dark_current_e_per_s == 4000.0


def test_an_error_of_the_black_level_shifts_every_code():
    assert (quiet(black_error_e=-7.0).frame(time_ms=1.0, dark=True) == 493).all()
    assert quiet(black_error_e=-7.0).planes()[0].black_level_dn == 493.0


def test_hot_pixels_have_their_excess_current_and_stay_at_their_places():
    camera = quiet(hot_pixels=40, hot_pixel_e_per_s=5000.0)
    frames = np.array([camera.frame(time_ms=100.0, dark=True, number=n) for n in range(20)]) - 500
    hot = (frames > 0).any(axis=0)
    assert hot.sum() == 40
    excess = frames[:, hot]
    assert abs(excess.mean() - 500) < 5 * math.sqrt(500 / excess.size)
    assert abs(excess.var() / 500 - 1) < 5 * math.sqrt(2 / excess.size)
    assert sum(plane.hot_pixels for plane in camera.planes()) == 40
    every = VirtualCamera(shape=(6, 6), mosaic="RG/GB", hot_pixels=36)
    assert [plane.hot_pixels for plane in every.planes()] == [9, 9, 9, 9]


def test_the_gain_falls_by_the_bend_from_zero_to_full_well():
    camera = quiet(bend=0.3, full_well_e=1e8, gain_dn_per_e=6e-4, bits=16, black_level_dn=0.0)
    means = [
        camera.frame(electrons=e, time_ms=1.0).mean() / 6e-4 for e in (0.0, 2e6, 96e6, 98e6, 3e8)
    ]
    assert math.isclose((means[1] - means[0]) / 2e6, 1 - 0.3 * 0.01, rel_tol=1e-4)
    assert math.isclose((means[3] - means[2]) / 2e6, 1 - 0.3 * 0.97, rel_tol=1e-3)
    assert round(means[4] * 6e-4) == round(camera.planes()[0].saturation_dn) == 51_000  # 85 %


def test_the_mean_and_variance_of_a_bent_response_are_those_of_poisson_moments():
    mean_e, well_e, bend = 400.0, 1000.0, 0.4
    camera = quiet(shape=(500, 500), gain_dn_per_e=40.0, bend=bend, full_well_e=well_e, bits=16)
    codes = camera.frame(electrons=mean_e, time_ms=1.0) - 500.0
    law = stats.poisson(mean_e)
    bent = [law.expect(lambda n, k=k: (40 * (n - bend * n * n / 2 / well_e)) ** k) for k in (1, 2)]
    variance = bent[1] - bent[0] ** 2 + 1 / 12
    assert abs(codes.mean() - bent[0]) < 5 * math.sqrt(variance / codes.size)
    assert abs(codes.var() / variance - 1) < 5 * math.sqrt(2 / codes.size)


def test_the_light_drifts_by_the_same_factor_from_frame_to_frame():
    camera = quiet(drift=-0.02, bits=16, gain_dn_per_e=6e-4, full_well_e=1e9, black_level_dn=0.0)
    means = [camera.frame(electrons=1e8, time_ms=1.0, number=n).mean() for n in (0, 1, 35)]
    assert math.isclose(means[1] / means[0], 0.98, rel_tol=1e-5)
    assert math.isclose(means[2] / means[0], 0.4931, rel_tol=1e-4)  # 0.98^35, printed by bc
    dark = quiet(drift=-0.02, dark_current_e_per_s=1e4, seed=8)
    assert abs(dark.frame(time_ms=100.0, dark=True, number=35).mean() - 1500) < 1


def test_shading_darkens_the_corners_and_keeps_the_mean():
    camera = quiet(shading=0.4, bits=16, gain_dn_per_e=4e-4, full_well_e=1e9, black_level_dn=0.0)
    codes = camera.frame(electrons=1e8, time_ms=1.0)
    corners = codes[[0, 0, -1, -1], [0, -1, 0, -1]].mean()
    center = codes[99:101, 149:151].mean()
    assert math.isclose(corners / center, 0.6, rel_tol=1e-3)
    assert math.isclose(codes.mean(), 4e4, rel_tol=1e-4)


def test_the_denoiser_correlates_neighbors_of_one_plane_only_and_lowers_the_variance():
    camera = VirtualCamera(
        shape=(800, 800), mosaic="RG/GB", neighbor_correlation=0.3, read_noise_e=40.0,
        gain_dn_per_e=1.0, black_level_dn=1000.0,
    )  # fmt: skip
    noise = camera.frame(electrons=500.0, time_ms=1.0).astype(float)
    planes = [noise[y::2, x::2] - noise[y::2, x::2].mean() for y in (0, 1) for x in (0, 1)]
    for plane in planes:
        for one, other in ((plane[:, 1:], plane[:, :-1]), (plane[1:], plane[:-1])):
            assert abs((one * other).mean() / plane.var() - 0.3) < 5 * 1.5 / 400
    assert abs(np.corrcoef(planes[0].ravel(), planes[1].ravel())[0, 1]) < 5 * 1.5 / 400
    # a blur whose weights add up to 1 keeps the sum of all covariances
    every = np.fft.ifft2(np.abs(np.fft.fft2(planes[0])) ** 2).real / planes[0].size
    near = sum(every[y, x] for y in range(-2, 3) for x in range(-2, 3))
    assert abs(near / (500 + 40.0**2) - 1) < 0.1
    assert planes[0].var() < 0.5 * near
    dark = camera.frame(time_ms=1.0, dark=True, number=9)[::2, ::2]
    assert abs(dark.std() / math.hypot(camera.planes()[0].dark_noise_e, 12**-0.5) - 1) < 0.02


def test_each_channel_has_its_sensitivity_and_gain():
    camera = VirtualCamera(
        shape=(300, 300), mosaic="R G/IR B", gain_dn_per_e=(1.0, 2.0, 3.0, 0.5), qe=0.8,
        sensitivity=(0.5, 1.0, 0.25, 0.75), bits=14,
    )  # fmt: skip
    codes = camera.frame(photons_per_pixel=1000.0, time_ms=1.0)
    truth = camera.planes()
    assert [plane.name for plane in truth] == ["R", "G", "IR", "B"]
    for place, plane, mean_e, gain in zip(
        np.ndindex(2, 2), truth, (400, 800, 200, 600), (1.0, 2.0, 3.0, 0.5), strict=True
    ):
        one = codes[place[0] :: 2, place[1] :: 2] / gain
        assert abs(one.mean() - mean_e) < 5 * math.sqrt(mean_e / one.size)
        assert (plane.gain_dn_per_e, plane.qe) == (gain, pytest.approx(mean_e / 1000))


@pytest.mark.parametrize("bits", [12, 14])
def test_the_true_full_well_is_the_lower_of_pixel_and_converter(bits):
    camera = quiet(bits=bits, gain_dn_per_e=0.5, full_well_e=10_000.0, shape=(50, 50), bend=0.2)
    (truth,) = camera.planes()
    assert (camera.frame(electrons=5e4, time_ms=1.0) == round(truth.saturation_dn)).all()
    straight = VirtualCamera(bits=16, gain_dn_per_e=1.0, full_well_e=10_000.0, bend=0.2)
    at_well = straight.frame(electrons=truth.full_well_e, time_ms=1.0).mean()
    if bits == 14:
        assert truth.full_well_e == 10_000.0
    else:  # 3,595 codes of 0.5 DN/e- are 7,190 electrons of a straight response
        assert truth.saturation_dn == 4095.0
        assert abs(at_well - 7190.0) < 2
        assert 7190 < truth.full_well_e < 8000


def test_the_true_values_of_the_pixels_are_those_that_the_frames_show():
    camera = VirtualCamera(
        shape=(40, 60), mosaic="RG/GB", dsnu_e=50.0, prnu=0.05, gain_dn_per_e=1.0,
        black_level_dn=500.0, qe=1.0, full_well_e=1e6, bits=16,
    )  # fmt: skip
    dark = camera.frame(time_ms=0.0, dark=True).astype(float)
    lit = np.mean([camera.frame(electrons=4e4, time_ms=0.0, number=n) for n in range(8)], axis=0)
    for (y, x), truth in zip(np.ndindex(2, 2), camera.planes(), strict=True):
        offset, light = dark[y::2, x::2], (lit - dark)[y::2, x::2]
        assert truth.black_level_dn == pytest.approx(offset.mean(), abs=0.1)
        assert truth.dsnu_of_pixels_e == pytest.approx(offset.std(), rel=1e-3)
        assert truth.qe == pytest.approx(light.mean() / 4e4, rel=5 * 5e-3 / math.sqrt(8 * 600))
        assert truth.prnu_of_pixels == pytest.approx(light.std() / 4e4, rel=5e-3)


# ---- streams ----

NOISY = VirtualCamera(
    shape=(30, 40), mosaic="RG/GB", read_noise_e=3.0, prnu=0.01, dsnu_e=2.0, row_noise_e=1.0,
    column_noise_e=1.0, dark_current_e_per_s=100.0, hot_pixels=3, black_level_dn=64.0, seed=5,
)  # fmt: skip


def test_a_frame_depends_on_camera_and_number_but_not_on_what_was_drawn_before():
    exposure = {"electrons": 2000.0, "time_ms": 10.0}
    forward = [NOISY.frame(**exposure, number=n) for n in range(4)]
    backward = [NOISY.frame(**exposure, number=n) for n in reversed(range(4))]
    assert all((a == b).all() for a, b in zip(forward, backward[::-1], strict=True))
    assert (forward[0] != forward[1]).mean() > 0.9
    other = replace(NOISY, seed=6)
    assert (other.frame(**exposure) != forward[0]).mean() > 0.9


# ---- bad input ----


@pytest.mark.parametrize(
    ("settings", "subject"),
    [
        ({"gain_dn_per_e": 0.0}, "gain_dn_per_e"),
        ({"gain_dn_per_e": float("nan")}, "gain_dn_per_e"),
        ({"mosaic": "RG/GB", "gain_dn_per_e": (1.0, 2.0)}, "gain_dn_per_e"),
        ({"mosaic": "RG/GB", "sensitivity": (1.0, 2.0, 1.0)}, "sensitivity"),
        ({"read_noise_e": -1.0}, "read_noise_e"),
        ({"full_well_e": float("inf")}, "full_well_e"),
        ({"bits": 7}, "bits"),
        ({"black_level_dn": 4095.0}, "black_level_dn"),
        ({"qe": 1.1}, "qe"),
        ({"prnu": 1.0}, "prnu"),
        ({"pitch_um": 3.0}, "pitch_um"),
        ({"black_error_e": 20_000.0}, "black_error_e"),
        ({"rtn_share": 1.5}, "rtn_share"),
        ({"neighbor_correlation": 0.7}, "neighbor_correlation"),
        ({"shape": (1, 5)}, "shape"),
        ({"shape": (3, 9), "mosaic": "RG/GB"}, "shape"),
        ({"shape": (60_000, 60_000)}, "shape"),
        ({"hot_pixels": 101, "shape": (10, 10)}, "hot_pixels"),
        ({"seed": -1}, "seed"),
        ({"dark_current_e_per_s": 0.0, "rtn_amplitude_e": 5.0}, "rtn_amplitude_e"),
        ({"dark_current_e_per_s": 0.0, "temperature_c": 60.0}, "temperature_c"),
        ({"dark_current_e_per_s": 0.0, "dark_doubling_k": 5.0}, "dark_doubling_k"),
    ],
    ids=str,
)
def test_a_camera_that_cannot_be_is_refused(settings, subject):
    with refused_input(subject=subject):
        quiet(**{"black_level_dn": 0.0} | settings)


@pytest.mark.parametrize(
    ("exposure", "subject"),
    [
        ({"time_ms": 1.0}, "the light"),
        ({"time_ms": 1.0, "electrons": 1.0, "photons_per_pixel": 1.0}, "the light"),
        ({"time_ms": 1.0, "electrons": 1.0, "dark": True}, "the light"),
        ({"time_ms": -1.0, "dark": True}, "time_ms"),
        ({"time_ms": 1.0, "electrons": -1.0}, "electrons"),
        ({"time_ms": 1.0, "photons_per_pixel": float("nan")}, "photons_per_pixel"),
        ({"time_ms": 1.0, "dark": True, "number": -1}, "number"),
        ({"time_ms": 1.0, "electrons": 1.0, "number": 10**6}, "photons_per_pixel with drift"),
    ],
    ids=str,
)
def test_an_exposure_that_cannot_be_is_refused(exposure, subject):
    with refused_input(subject=subject):
        quiet(shape=(4, 4), drift=0.1).frame(**exposure)


# ---- folders ----


def codes_of(path):
    """The codes of a file, by other codes than ours."""
    match path.suffix:
        case ".npy":
            return np.load(path)
        case ".tiff":
            return tifffile.imread(path)
        case ".pgm":
            return np.array(Image.open(io.BytesIO(path.read_bytes()))).astype(np.uint16)
    from astropy.io import fits

    return fits.getdata(path)


@pytest.mark.parametrize("file_format", FRAME_FORMATS)
@pytest.mark.parametrize("bits", [8, 16])
def test_the_frames_of_a_folder_hold_the_codes_of_the_camera(tmp_path, file_format, bits):
    camera = quiet(shape=(12, 17), bits=bits, black_level_dn=20.0, read_noise_e=2.0)
    values = {"levels": 2, "frames": 2, "darks": 1, "longest_time_ms": 40.0}
    paths = photon_transfer_frames(camera, folder=tmp_path / "f", file_format=file_format, **values)
    capture = tomllib.loads((tmp_path / "f" / "capture.toml").read_text())
    assert "mosaic" not in capture
    assert capture["bits"] == bits
    number = 0
    for level in capture["levels"]:
        for name in level["flats"] + level["darks"]:
            dark = name in level["darks"]
            light = {} if dark else {"photons_per_pixel": level["photons_per_pixel"]}
            codes = camera.frame(time_ms=level["time_ms"], dark=dark, number=number, **light)
            assert paths[number] == tmp_path / "f" / name
            assert (codes_of(paths[number]) == codes).all()
            number += 1
    assert number == len(paths) == 6


def test_the_levels_reach_from_dark_to_saturation_of_every_plane(tmp_path):
    camera = VirtualCamera(
        shape=(40, 40), mosaic="RG/GB", sensitivity=(0.5, 1.0, 0.7), black_level_dn=64.0
    )
    photon_transfer_frames(camera, folder=tmp_path / "f", levels=10)
    capture = tomllib.loads((tmp_path / "f" / "capture.toml").read_text())
    assert capture["mosaic"] == "RG/GB"
    levels = capture["levels"]
    ratio = [level["photons_per_pixel"] / level["time_ms"] for level in levels]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    assert np.diff([level["time_ms"] for level in levels]) == pytest.approx(10.0)
    first, last = (np.load(tmp_path / "f" / levels[i]["flats"][0]) for i in (0, -1))
    for (y, x), plane in zip(np.ndindex(2, 2), camera.planes(), strict=True):
        share = (first[y::2, x::2].mean() - 64) / (plane.saturation_dn - 64)
        assert 0.1 < share < 0.25
        assert last[y::2, x::2].mean() == pytest.approx(plane.saturation_dn, abs=0.5)


def test_the_time_stays_where_the_light_varies(tmp_path):
    photon_transfer_frames(quiet(shape=(4, 4)), folder=tmp_path / "f", levels=3, varied="light")
    levels = tomllib.loads((tmp_path / "f" / "capture.toml").read_text())["levels"]
    assert [level["time_ms"] for level in levels] == [100.0] * 3
    light = [level["photons_per_pixel"] for level in levels]
    np.testing.assert_allclose(light, np.array([1, 2, 3]) * light[0], rtol=1e-12)


def test_the_truth_gives_the_camera_back(tmp_path):
    photon_transfer_frames(NOISY, folder=tmp_path / "f", levels=2)
    truth = tomllib.loads((tmp_path / "f" / "truth.toml").read_text())
    values = {k: tuple(v) if isinstance(v, list) else v for k, v in truth["camera"].items()}
    assert VirtualCamera(**values) == NOISY
    for plane, written in zip(NOISY.planes(), truth["planes"], strict=True):
        assert {name: one for name, one in asdict(plane).items() if one is not None} == written


@pytest.mark.parametrize(
    "result",
    [
        {"levels": 1},
        {"levels": 10**9},
        {"frames": 1},
        {"darks": 101},
        {"file_format": "jpg"},
        {"varied": "gain"},
        {"longest_time_ms": 0.0},
        {"brightest": float("nan")},
    ],
    ids=str,
)
def test_a_photon_transfer_that_cannot_be_is_refused(tmp_path, result):
    with refused_input(subject=next(iter(result))):
        photon_transfer_frames(quiet(shape=(4, 4)), folder=tmp_path / "f", **result)
    assert list(tmp_path.iterdir()) == []
