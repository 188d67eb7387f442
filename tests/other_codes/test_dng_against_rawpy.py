"""LibRaw, which most raw developers are built on, reads what we write."""

from dataclasses import replace

import numpy as np
import pytest
import tifffile
from hypothesis import given, settings, strategies as st

from chromanoise.color import kernel_matrix, linear_srgb
from chromanoise.imaging import acquired
from chromanoise.imaging.dng import RawProfile, camera_matrix, dng_rows, raw_profile, write_dng
from chromanoise.noise import Exposure, expected_electrons
from chromanoise.sensor import Adc, Mosaic, bayer, rgbw_2x2, rgbw_sparse_4x4
from chromanoise.sensor.camera_noise import noise_profile
from chromanoise.spectra import Scene, cie_illuminant
from outcomes import refused_input
from strategies import GRID, bell_qe, flat_cube, pixel_with, point_of, sensor_of

rawpy = pytest.importorskip("rawpy")

LAMP = cie_illuminant("D65", GRID)
EXPOSURE = Exposure(time_s=0.02)
ADC = Adc(bits=12, gain_e_per_dn=2.5, black_level_dn=64)
BELLS = {"R": (600, 35, 0.6), "G": (540, 40, 0.7), "B": (450, 30, 0.6), "W": (550, 120, 0.8)}
CODES = {"R": 0, "G": 1, "B": 2, "C": 3, "M": 4, "Y": 5, "W": 6}


def of(*rows):
    return Mosaic(tuple(tuple(row) for row in rows))


READABLE = [
    bayer(),
    of("GR", "BG"),
    of("BG", "GR"),
    of("RGRG", "GBGB", "RGRG", "GBGB"),  # Bayer in 4 x 4
    rgbw_2x2(),
    of("CY", "MG"),
    of("RB", "GG", "WW", "GG"),
    of("R", "G", "B", "G"),  # rows of one color
    of("GBGGRG", "RGRBGB", "GBGGRG", "GRGGBG", "BGBRGR", "GRGGBG"),  # X-Trans
    of("RGB", "GBR", "BRG"),
]


def camera(names, **more):
    centers, widths, peaks = zip(*(BELLS[name] for name in names), strict=True)
    return sensor_of(bell_qe(centers, widths, peaks), names=tuple(names), **more)


def profile_of(mosaic, adc=ADC, **changed):
    names = mosaic.names
    p = len(names)
    matrix = np.vstack([np.eye(3), np.ones((1, 3))])[:p] + 0.1
    return RawProfile(
        **{
            "sensor_name": "toy",
            "channels": names,
            "mosaic": mosaic,
            "adc": adc,
            "white_level_dn": adc.top_code,
            "color_matrix": matrix,
            "as_shot_neutral": np.linspace(0.5, 1, p),
            "noise_profile": np.full((p, 2), 1e-4),
            "illuminant": "D65",
            **changed,
        }
    )


def seen_by(names, lamp=LAMP, **more):
    return point_of(camera(names, **more), 20.0, exposure=EXPOSURE, illuminant=lamp)


def electrons_of(operating_point, reflectance=None):
    rho = np.ones(GRID.n) if reflectance is None else reflectance
    patch = Scene(
        illuminant=operating_point.illuminant, level_lux=operating_point.level_lux, reflectance=rho
    )
    return expected_electrons(patch, operating_point.sensor, operating_point.exposure)


def matrix_of(operating_point):
    return kernel_matrix(operating_point.sensor, operating_point.exposure)


def profile_at(operating_point, mosaic=None, adc=ADC):
    """The profile that the library makes for the kernel matrix."""
    matrix = matrix_of(operating_point)
    return raw_profile(operating_point, matrix, mosaic=mosaic or bayer(), adc=adc)


def tags_of(path, profile):
    """The tags of a small picture with this profile."""
    write_dng(path, drawn(22, 22), profile)
    with tifffile.TiffFile(path) as file:
        return {tag.name: tag.value for tag in file.pages[0].tags}


def fractions(numbers):
    parts = np.array(numbers).reshape(-1, 2)
    return parts[:, 0] / parts[:, 1]


def fine_adc(white_e):
    """So many codes that their rounding does not matter."""
    return Adc(bits=16, gain_e_per_dn=float(white_e.max()) / 50_000, black_level_dn=512)


def drawn(height, width, top=4096):
    return np.random.default_rng(height * width).integers(0, top, (height, width)).astype("u2")


def letters_over_pixels(mosaic, height, width):
    rows, columns = len(mosaic.pattern), len(mosaic.pattern[0])
    return [[mosaic.pattern[i % rows][j % columns] for j in range(width)] for i in range(height)]


@settings(max_examples=30)
@given(st.sampled_from(READABLE), st.integers(22, 41), st.integers(22, 41), st.integers(8, 16))
def test_libraw_sees_the_same_integers(tmp_path_factory, mosaic, height, width, bits):
    path = tmp_path_factory.mktemp("dng") / "a.dng"
    adc = Adc(bits=bits, gain_e_per_dn=2.5, black_level_dn=17)
    codes = drawn(height, width, 2**bits)
    codes[0, :2] = 0, adc.top_code
    write_dng(path, codes, profile_of(mosaic, adc))
    with rawpy.imread(str(path)) as raw:
        assert raw.raw_image_visible.dtype == np.uint16
        assert raw.raw_image_visible.shape == codes.shape
        assert (raw.raw_image_visible == codes).all()
        assert raw.black_level_per_channel == [17] * 4
        assert raw.white_level == 2**bits - 1
    assert (tifffile.imread(path) == codes).all()


@pytest.mark.parametrize("mosaic", READABLE, ids=lambda m: "-".join("".join(r) for r in m.pattern))
def test_libraw_sees_the_same_color_over_each_pixel(tmp_path, mosaic):
    write_dng(tmp_path / "a.dng", drawn(25, 29), profile_of(mosaic))
    planes = sorted(mosaic.names, key=CODES.get)
    with rawpy.imread(str(tmp_path / "a.dng")) as raw:
        assert raw.num_colors == len(planes)
        seen = raw.raw_colors_visible.copy()
    if len(planes) == 3:
        seen[seen == 3] = 1  # LibRaw's name for the green of the other rows
    wanted = letters_over_pixels(mosaic, 25, 29)
    assert [[planes[i] for i in row] for row in seen] == wanted


def test_tifffile_reads_every_tag_back(tmp_path):
    # rows of the matrix and of the noise stand in the order of the planes, R G B W
    channels = ("W", "B", "R", "G")
    matrix = np.arange(12.0).reshape(4, 3) - 5.5
    noise = np.arange(1.0, 9.0).reshape(4, 2) / 3
    profile = profile_of(
        rgbw_2x2(),
        channels=channels,
        sensor_name="Grün",
        color_matrix=matrix,
        as_shot_neutral=np.array([1.0, 0.25, 0.5, 0.75]),
        noise_profile=noise,
    )
    tags = tags_of(tmp_path / "a.dng", profile)
    with tifffile.TiffFile(tmp_path / "a.dng") as file:
        page = file.pages[0]
        assert page.photometric == tifffile.PHOTOMETRIC.CFA
        assert (page.bitspersample, page.compression) == (16, 1)
        assert not file.is_bigtiff
    assert tags["CFARepeatPatternDim"] == (2, 2)
    assert tuple(tags["CFAPattern"]) == (0, 1, 6, 2)
    assert tuple(tags["CFAPlaneColor"]) == (0, 1, 2, 6)
    assert (tags["BlackLevel"], tags["WhiteLevel"]) == (64, 4095)
    assert tags["CalibrationIlluminant1"] == 21
    assert tuple(tags["DNGVersion"]) == (1, 4, 0, 0)
    assert tags["UniqueCameraModel"] == "chromanoise Gr?n"
    order = [2, 3, 1, 0]
    assert fractions(tags["ColorMatrix1"]).reshape(4, 3) == pytest.approx(matrix[order])
    assert fractions(tags["AsShotNeutral"]) == pytest.approx([0.5, 0.75, 0.25, 1.0])
    assert np.reshape(tags["NoiseProfile"], (4, 2)) == pytest.approx(noise[order], rel=1e-15)


@pytest.mark.parametrize(
    ("name", "number"), [("A", 17), ("D55", 20), ("D75", 22), ("D50", 23), ("E", 0), ("5000 K", 0)]
)
def test_the_light_has_its_number_in_exif(tmp_path, name, number):
    # Exif 2.3 (CIPA DC-008-2012), LightSource; 0 is unknown
    tags = tags_of(tmp_path / "a.dng", profile_of(bayer(), illuminant=name))
    assert tags["CalibrationIlluminant1"] == number


def developed(path):
    """Linear sRGB as LibRaw makes it, with the neutral of the file; 1 for the top code."""
    with rawpy.imread(str(path)) as raw:
        return raw.postprocess(
            demosaic_algorithm=rawpy.DemosaicAlgorithm.LINEAR,
            use_camera_wb=True,
            no_auto_bright=True,
            no_auto_scale=False,
            adjust_maximum_thr=0.0,
            gamma=(1, 1),
            output_bps=16,
            output_color=rawpy.ColorSpace.sRGB,
        )[8:-8, 8:-8].mean(axis=(0, 1))


def flat_codes(electrons, mosaic, names, adc, size=40):
    """Codes without noise, the mosaic filled pixel by pixel."""
    over = letters_over_pixels(mosaic, size, size)
    level = dict(zip(names, adc.black_level_dn + electrons / adc.gain_e_per_dn, strict=True))
    return np.array([[round(level[letter]) for letter in row] for row in over], dtype=np.uint16)


@pytest.mark.parametrize("lamp", ["D65", "A", "FL11"])
@pytest.mark.parametrize(("names", "mosaic"), [("RGB", bayer()), ("RGBW", rgbw_2x2())])
def test_libraw_develops_a_gray_as_gray(tmp_path, names, mosaic, lamp):
    operating_point = seen_by(names, cie_illuminant(lamp, GRID))
    white = electrons_of(operating_point)
    adc = fine_adc(white)
    profile = profile_at(operating_point, mosaic, adc)
    write_dng(tmp_path / "a.dng", flat_codes(0.3 * white, mosaic, names, adc), profile)
    color = developed(tmp_path / "a.dng")
    assert color == pytest.approx(color.mean() * np.ones(3), rel=5e-3)


def pale(center_nm):
    """0.3 + 0.2 bell, so that no color leaves the gamut."""
    return 0.3 + 0.2 * np.exp(-0.5 * ((GRID.wavelength_nm - center_nm) / 40) ** 2)


@pytest.mark.parametrize("center_nm", [450, 520, 600])
def test_libraw_develops_our_color(tmp_path, center_nm):
    operating_point = seen_by("RGB")
    matrix, white = matrix_of(operating_point), electrons_of(operating_point)
    adc = fine_adc(white)
    electrons = electrons_of(operating_point, pale(center_nm))
    profile = profile_at(operating_point, adc=adc)
    write_dng(tmp_path / "a.dng", flat_codes(electrons, bayer(), "RGB", adc), profile)
    theirs = developed(tmp_path / "a.dng")
    ours = linear_srgb(matrix.matrix @ electrons, matrix.matrix @ white)
    assert np.ptp(ours) > 0.05  # it has a color
    assert theirs / theirs.sum() == pytest.approx(ours / ours.sum(), rel=0.01)


@pytest.mark.parametrize(("names", "mosaic"), [("RGB", bayer()), ("RGBW", rgbw_2x2())])
def test_a_reader_who_does_what_the_specification_says_finds_our_color(tmp_path, names, mosaic):
    # DNG 1.4, chapter 6: XYZ is the pseudo-inverse of ColorMatrix1 times the channels in the order
    # of CFAPlaneColor, here R G B W
    operating_point = seen_by(names)
    matrix = matrix_of(operating_point)
    tags = tags_of(tmp_path / "a.dng", profile_at(operating_point, mosaic))
    inverse = np.linalg.pinv(fractions(tags["ColorMatrix1"]).reshape(-1, 3))
    for electrons in (electrons_of(operating_point), electrons_of(operating_point, pale(450))):
        theirs, ours = inverse @ electrons, matrix.matrix @ electrons
        assert theirs / theirs[1] == pytest.approx(ours / ours[1], rel=1e-4)


def test_the_noise_profile_is_the_variance_of_codes(tmp_path):
    adc = Adc(bits=14, gain_e_per_dn=1.7, black_level_dn=300)
    operating_point = seen_by("RGB")
    tags = tags_of(tmp_path / "a.dng", profile_at(operating_point, adc=adc))
    slope, offset = tags["NoiseProfile"][:2]
    black, top = tags["BlackLevel"], tags["WhiteLevel"]
    rng = np.random.default_rng(5)
    n = 200_000
    for mean_e in (0.0, 30.0, 2000.0, 20_000.0):
        electrons = rng.poisson(mean_e, n) + rng.normal(
            0, operating_point.sensor.pixel.read_noise_e, n
        )
        x = (np.round(black + electrons / adc.gain_e_per_dn) - black) / (top - black)
        result = slope * x.mean() + offset
        # kurtosis of a Poisson variate adds mean / n to the relative variance of a variance
        se = result * np.sqrt(2 / n + 1 / (n * max(mean_e, 1.0)))
        assert abs(x.var(ddof=1) - result) < 5 * se


def test_the_white_level_is_where_pixels_saturate_and_the_noise_profile_knows_the_dark(tmp_path):
    pixel = pixel_with(20.0, full_well_e=5000.0)
    pixel = replace(pixel, dark_current_e_per_s=100_000.0, row_noise_e=15.0)  # 2,000 e- in 20 ms
    operating_point = seen_by("RGB", pixel=pixel)
    adc = Adc(bits=14, gain_e_per_dn=2.0, black_level_dn=300)
    profile = profile_at(operating_point, adc=adc)

    def codes(rho, level_lux):
        cube = flat_cube(GRID.wavelength_nm, rho, height=400, width=400)
        lit = replace(operating_point, level_lux=level_lux)
        return acquired(cube, lit, mosaic=bayer(), adc=adc).codes

    full, dark = codes(1.0, 1e6), codes(0.0, 1.0).astype(float)
    write_dng(tmp_path / "a.dng", full, profile)
    with rawpy.imread(str(tmp_path / "a.dng")) as seen:
        assert (full == seen.white_level).all()
    assert profile.white_level_dn == 300 + (5000 - 2000) / 2
    offset = profile.noise_profile[0, 1]
    error = np.sqrt(2 / dark.size + 2 * (15.0**2 / 2625) ** 2 / 400)  # of pixels and of rows
    assert (dark / 1500).var() == pytest.approx(offset, rel=5 * error)


def test_a_gain_that_hides_the_full_well_is_refused():
    operating_point = seen_by("RGB", pixel=pixel_with(20.0, full_well_e=5000.0))
    adc = Adc(bits=8, gain_e_per_dn=20_000.0, black_level_dn=50)
    with refused_input(value=50, requirement="black level 50"):
        profile_at(operating_point, adc=adc)


def test_noise_of_a_code_by_hand():
    # 200 codes of 2 e- each: S = 1 / 400; 10 e- are 5 codes, O = (25 + 1 / 12) / 200^2
    adc = Adc(bits=8, gain_e_per_dn=2.0, black_level_dn=55)
    assert noise_profile(adc, read_noise_e=10.0) == pytest.approx([0.0025, 6.270833333e-4])


@given(st.data(), st.integers(3, 4))
def test_a_reader_who_inverts_the_camera_matrix_finds_ours(data, p):
    entries = st.floats(-1, 1)
    to_xyz = np.array([[data.draw(entries) for _ in range(p)] for _ in range(3)]) / 6
    to_xyz += np.eye(3, p)
    white = np.array([data.draw(st.floats(0.5, 2.0)) for _ in range(p)])
    found = np.linalg.pinv(camera_matrix(to_xyz, white))
    # up to the scale, with which the white has Y = 1 where its largest channel is 1
    assert found / found[1, 1] == pytest.approx(to_xyz / to_xyz[1, 1], rel=1e-9, abs=1e-9)
    assert found[1] @ white / white.max() == pytest.approx(1.0)


def test_the_camera_matrix_of_a_camera_of_srgb_primaries_is_the_printed_one():
    # channels that are linear sRGB: XYZ to channels is the matrix of IEC 61966-2-1 itself
    printed = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    assert camera_matrix(np.array(to_xyz), np.ones(3)) == pytest.approx(np.array(printed), abs=5e-4)


def test_rows_that_come_in_parts_make_the_same_dng(tmp_path):
    codes, profile = drawn(30, 24), profile_of(bayer())
    write_dng(tmp_path / "whole.dng", codes, profile)
    with dng_rows(tmp_path / "rows.dng", height=30, width=24, profile=profile) as put:
        for start in (20, 0, 10):
            put(start, codes[start : start + 10])
    assert (tmp_path / "rows.dng").read_bytes() == (tmp_path / "whole.dng").read_bytes()


UNREADABLE = {
    "4 rows and columns": ({"mosaic": rgbw_sparse_4x4()}, {"value": (4, 4)}),
    "8 rows": (
        {"mosaic": of("RG", "GB", "WG", "GB", "GR", "BG", "GW", "BG")},
        {"value": (8, 2)},
    ),
    "3 columns": ({"mosaic": of("RGB", "BRW")}, {"value": (2, 3)}),
    "a channel of no DNG": ({"mosaic": Mosaic((("R", "G"), ("B", "NIR")))}, {"value": ("NIR",)}),
    "one channel": ({"mosaic": of("W")}, {"requirement": "3 or 4 channels"}),
    "a channel without pixel": (
        {"channels": ("R", "G", "W")},
        {"value": ("R", "G", "W"), "requirement": "3 or 4 channels"},
    ),
    "a matrix of four rows": (
        {
            "color_matrix": np.ones((4, 3)),
            "as_shot_neutral": np.ones(4),
            "noise_profile": np.ones((4, 2)),
        },
        {"subject": "color_matrix of toy", "value": (4, 3)},
    ),
    "noise of NaN": (
        {"noise_profile": np.full((3, 2), np.nan)},
        {"subject": "noise_profile of toy", "requirement": "finite"},
    ),
    "large entries": ({"color_matrix": 3000 * np.eye(3)}, {"value": 3000.0}),
    "a neutral of 0": ({"as_shot_neutral": np.array([1, 0.0, 1])}, {"value": [1.0, 0.0, 1.0]}),
    "no noise": ({"noise_profile": np.zeros((3, 2))}, {"value": 0.0}),
}


@pytest.mark.parametrize(("changed", "fields"), UNREADABLE.values(), ids=UNREADABLE)
def test_what_a_dng_cannot_hold_is_refused_with_what_came(changed, fields):
    with refused_input(**fields):
        profile_of(**{"mosaic": bayer(), **changed})


@pytest.mark.parametrize(
    ("size", "value"),
    [
        ((21, 40), (21, 40)),
        ((40, 64_001), (40, 64_001)),
        ((60_000, 60_000), 2 * 60_000**2),
    ],
)
def test_sizes_that_readers_do_not_open_are_refused(tmp_path, size, value):
    with (
        refused_input(value=value),
        dng_rows(tmp_path / "a.dng", height=size[0], width=size[1], profile=profile_of(bayer())),
    ):
        pytest.fail("opened")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("height", "width"), [(22, 64_000), (22, 22)])
def test_libraw_opens_the_smallest_and_the_widest_that_we_write(tmp_path, height, width):
    codes = drawn(height, width)
    write_dng(tmp_path / "a.dng", codes, profile_of(bayer()))
    with rawpy.imread(str(tmp_path / "a.dng")) as raw:
        assert (raw.raw_image_visible == codes).all()


def test_a_light_that_the_sensor_does_not_see_and_a_matrix_without_inverse_make_no_raw_file():
    operating_point = seen_by("RGB")
    dark = replace(operating_point.sensor, qe=0 * operating_point.sensor.qe)
    with refused_input(subject=dark.name, value=0.0):
        raw_profile(
            replace(operating_point, sensor=dark),
            matrix_of(operating_point),
            mosaic=bayer(),
            adc=ADC,
        )
    with refused_input(requirement="channels"):
        raw_profile(operating_point, matrix_of(seen_by("RGBW")), mosaic=bayer(), adc=ADC)
    with refused_input(value=1, requirement="rank 3"):
        camera_matrix(np.ones((3, 3)), np.ones(3))
    with refused_input(value=-1.0, requirement="luminance"):
        camera_matrix(np.diag([1.0, -1.0, 1.0]), np.ones(3))


def test_what_the_engine_acquires_comes_back_from_its_dng(tmp_path):
    operating_point = seen_by("RGBW")
    cube = flat_cube(GRID.wavelength_nm, 0.5, height=23, width=26)
    raw = acquired(cube, operating_point, mosaic=rgbw_2x2(), seed=4)
    write_dng(tmp_path / "a.dng", raw.codes, profile_at(operating_point, raw.mosaic, raw.adc))
    with rawpy.imread(str(tmp_path / "a.dng")) as seen:
        assert (seen.raw_image_visible == raw.codes).all()


def test_every_letter_that_dng_knows_is_taken():
    for extra in "CMYW":
        assert profile_of(of("RG", "B" + extra)).channels == ("R", "G", "B", extra)
