"""`simulate`: every option does what it says, and files appear whole or not at all."""

import json
import signal
import sys
from contextlib import contextmanager
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
import tifffile
from PIL import Image

from chromanoise.base.errors import InputError
from chromanoise.base.files import OWN_FILES
from chromanoise.imaging import DEMOSAICING, acquired, developed, rendered
from chromanoise.imaging.capture import write_capture
from chromanoise.io.cubes import read_cube
from chromanoise.io.sensor_files import sensor_json
from chromanoise.noise import saturating_exposure
from chromanoise.sensor import (
    EXTRA_NOISE,
    Mosaic,
    bayer,
    rgb_ir,
    rgbw_2x2,
    rgbw_sparse_4x4,
    with_pixel,
)
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import sensor_named
from outcomes import refused
from processes import IGNORING, command, wait_for
from strategies import point_of

ROWS, COLUMNS = 27, 23  # no whole number of tiles; DNG needs 22
IMPERFECT = {
    "dark_current_e_per_s": 3000.0,
    "dsnu_e": 40.0,
    "prnu": 0.05,
    "row_noise_e": 60.0,
}


def written_cube(path, rows=ROWS, columns=COLUMNS):
    wavelength = np.linspace(400, 1050, 27)
    rng = np.random.default_rng(1)
    ends = 0.05 + 0.8 * rng.random((rows, columns, 2))
    ramp = np.linspace(0, 1, wavelength.size)
    reflectance = ends[..., :1] * (1 - ramp) + ends[..., 1:] * ramp
    np.savez(path, wavelength_nm=wavelength, reflectance=reflectance.astype(np.float32))
    return path


@pytest.fixture(scope="module")
def cube(tmp_path_factory):
    return written_cube(tmp_path_factory.mktemp("cube") / "cube.npz")


@pytest.fixture
def take(done, cube, tmp_path):
    """Simulate into a folder of that name; its summary, standard output and error beside it."""

    def call(name, sensor, *arguments, source=cube):
        folder = tmp_path / name
        out, err = done("simulate", source, "--sensor", sensor, *arguments, "-o", folder)
        summary = json.loads((folder / "summary.json").read_text())
        return folder, summary["pictures"], out, err

    return call


@pytest.fixture
def without_work(monkeypatch):
    """The test fails if a picture is taken."""
    for name in ("acquired", "rendered"):
        monkeypatch.setattr(
            f"chromanoise.imaging.denoising.denoised_pictures.{name}",
            lambda *_, **__: pytest.fail("worked"),
        )


def used(name, lux=10.0, **pixel):
    lamp = equal_energy(DEFAULT_GRID)
    sensor = with_pixel(sensor_named(name, DEFAULT_GRID), pixel)
    white = flat_field(lamp, level_lux=lux)
    exposure = saturating_exposure(white, sensor, f_number=1.8, share=0.99)
    return point_of(sensor, lux, exposure=exposure)


def codes_in(folder, stem):
    return tifffile.imread(folder / f"{stem}.raw.tiff")


def names_in(folder):
    return sorted(path.name for path in folder.iterdir() if path.name != OWN_FILES)


def pixels_in(folder):
    """All files but the summary, byte by byte."""
    other = {"summary.json", OWN_FILES}
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.name not in other}


def nothing_left(folder):
    return list(folder.iterdir()) == []


@pytest.mark.parametrize(
    ("sensor", "asked", "mosaic"),
    [
        ("model-rgb", "bayer", bayer()),
        ("model-rgb", "RG/GB", bayer()),
        ("model-rgb", "sensor", bayer()),
        ("model-rgb", "GB/RG", Mosaic((("G", "B"), ("R", "G")))),
        ("model-rgbir", "rgb-ir", rgb_ir()),
        ("model-rgbir", "R G/IR B", rgb_ir()),
        ("model-rgbw", "rgbw-2x2", rgbw_2x2()),
        ("onyx-rgbw", "sensor", rgbw_sparse_4x4()),
        ("model-rgbw", "W", Mosaic((("W",),))),
    ],
)
def test_the_codes_are_those_of_the_library_for_the_mosaic_that_was_asked_for(
    take, cube, sensor, asked, mosaic
):
    folder, (result,), _, _ = take("o", sensor, "--mosaic", asked, "--raw-only")
    ours = acquired(read_cube(cube), used(sensor), mosaic=mosaic)
    assert (codes_in(folder, sensor) == ours.codes).all()
    assert result["mosaic"] == [list(row) for row in mosaic.pattern]


def test_each_pixel_of_a_mosaic_sees_its_own_channel(take, tmp_path):
    """A scene of one color, without noise to speak of: as many levels as channels, in place."""
    source = tmp_path / "flat.npz"
    wavelength = np.linspace(400, 1050, 14)
    np.savez(source, wavelength_nm=wavelength, reflectance=np.full((8, 8, 14), 0.5))
    folder, (result,), _, _ = take(
        "o", "model-rgb", "--mosaic", "RG/GB", "--raw-only", "--bits", 16,
        "--full-well-e", 1e13, "--read-noise-e", 0, source=source,
    )  # fmt: skip
    codes = codes_in(folder, "model-rgb") * result["gain_e_per_dn"]
    for name, own in {
        "R": codes[0::2, 0::2],
        "G": np.stack([codes[0::2, 1::2], codes[1::2, 0::2]]),
        "B": codes[1::2, 1::2],
    }.items():
        assert own == pytest.approx(result["mean_e"][name], rel=2e-4)


def test_raw_only_writes_codes_and_no_color(take):
    folder, (result,), _, _ = take("o", "model-rgb", "--mosaic", "bayer", "--raw-only")
    assert names_in(folder) == ["model-rgb.dng", "model-rgb.raw.tiff", "summary.json"]
    assert result["files"] == ["model-rgb.raw.tiff", "model-rgb.dng"]
    assert "white_xyz" not in result


@pytest.mark.parametrize("method", ["bilinear", "malvar", "gradient", "lmmse"])
def test_the_color_of_a_mosaic_is_that_of_the_library(take, cube, method):
    folder, (result,), _, _ = take("o", "model-rgb", "--mosaic", "sensor", "--demosaic", method)
    operating_point = used("model-rgb")
    raw = acquired(read_cube(cube), operating_point)
    ours = developed(raw, DEMOSAICING[method](bayer(), operating_point))
    assert (tifffile.imread(folder / "model-rgb.xyz.tiff") == ours.xyz).all()
    with Image.open(folder / "model-rgb.png") as picture:
        assert (np.asarray(picture) == ours.srgb).all()
    assert any(note.startswith("demosaicked: ") for note in result["notes"])


def test_demosaicing_is_bilinear_unless_asked_and_methods_differ(take):
    said = {
        name: pixels_in(take(str(name), "model-rgb", "--mosaic", "bayer", *more)[0])
        for name, more in {
            None: (),
            "bilinear": ("--demosaic", "bilinear"),
            "malvar": ("--demosaic", "malvar"),
            "gradient": ("--demosaic", "gradient"),
            "lmmse": ("--demosaic", "lmmse"),
        }.items()
    }
    assert said[None] == said["bilinear"]
    assert len({files["model-rgb.xyz.tiff"] for files in said.values()}) == 4
    assert len({files["model-rgb.raw.tiff"] for files in said.values()}) == 1


@pytest.mark.parametrize(("bits", "top"), [(8, 255), (12, 4095), (16, 65535)])
def test_the_dark_is_at_the_black_level_and_too_much_light_at_the_top_code(take, bits, top):
    asked = ("--mosaic", "bayer", "--raw-only", "--time-ms", 1, "--read-noise-e", 0)
    asked = (*asked, "--bits", bits, "--black-level", 60)
    dark, (result,), _, _ = take("dark", "model-rgb", *asked, "--lux", 1e-9)
    bright, _, _, _ = take("bright", "model-rgb", *asked, "--lux", 1e9)
    assert (codes_in(dark, "model-rgb") == 60).all()
    assert (codes_in(bright, "model-rgb") == top).all()
    assert result["gain_e_per_dn"] * (top - 60) == pytest.approx(10_000.0)
    assert (result["bits"], result["black_level_dn"]) == (bits, 60)


def test_without_words_a_converter_has_12_bits_and_black_at_zero(take):
    _, (result,), _, _ = take("o", "model-rgb", "--mosaic", "bayer", "--raw-only")
    assert (result["bits"], result["black_level_dn"]) == (12, 0)
    assert result["gain_e_per_dn"] == pytest.approx(10_000.0 / 4095)


@pytest.mark.parametrize("more", [(), ("--mosaic", "bayer")])
def test_a_burst_begins_with_the_picture_of_one_frame_and_goes_on_with_others(take, more):
    one, (alone,), _, _ = take("one", "model-rgb", *more, "--seed", 5)
    burst, result, _, err = take("burst", "model-rgb", *more, "--seed", 5, "--frames", 3)
    alone_files = pixels_in(one)
    frames = [
        {name.replace(f"-{k:04d}", ""): data for name, data in pixels_in(burst).items()
         if f"-{k:04d}." in name}
        for k in range(3)
    ]  # fmt: skip
    assert frames[0] == alone_files
    for name in alone_files:
        assert len({frame[name] for frame in frames}) == 3
    assert [picture["frame"] for picture in result] == [0, 1, 2]
    assert all(picture["mean_e"] == alone["mean_e"] for picture in result)
    assert err.count("model of silicon") == 1  # a note once for the burst


def test_every_format_holds_the_same_picture(take):
    rawpy = pytest.importorskip("rawpy", reason="reads the DNG back")
    exr = pytest.importorskip("OpenEXR", reason="reads the EXR back")
    folder, (result,), _, _ = take(
        "o", "model-rgb", "--mosaic", "bayer", "--format", "dng,raw,exr,srgb16,xyz,png"
    )
    assert names_in(folder) == sorted([*result["files"], "summary.json"])
    codes = codes_in(folder, "model-rgb")
    assert codes.shape == (ROWS, COLUMNS)
    with rawpy.imread(str(folder / "model-rgb.dng")) as negative:
        assert (negative.raw_image == codes).all()
    xyz = tifffile.imread(folder / "model-rgb.xyz.tiff")
    fine = tifffile.imread(folder / "model-rgb.srgb16.tiff")
    with Image.open(folder / "model-rgb.png") as picture:
        coarse = np.asarray(picture)
    assert xyz.shape == fine.shape == coarse.shape == (ROWS, COLUMNS, 3)
    assert (xyz.dtype, fine.dtype, coarse.dtype) == (np.float32, np.uint16, np.uint8)
    assert np.abs(fine / 257 - coarse).max() < 1.01
    with exr.File(str(folder / "model-rgb.exr")) as linear:
        light = linear.channels()["RGB"].pixels
    # IEC 61966-2-1: the straight part ends at 0.0031308
    light = np.clip(light.astype(float), 0, 1)
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    assert np.abs(65535 * encoded - fine).max() < 40


def test_formats_that_were_not_asked_for_are_not_written(take):
    folder, _, _, _ = take("o", "model-rgb", "--mosaic", "bayer", "--format", "png,raw")
    assert names_in(folder) == ["model-rgb.png", "model-rgb.raw.tiff", "summary.json"]


@pytest.mark.parametrize("field", IMPERFECT)
def test_each_imperfection_goes_where_the_library_puts_it(take, cube, field):
    value = IMPERFECT[field]
    option = f"--{field.replace('_', '-')}"
    folder, (result,), _, _ = take(
        "o", "model-rgb", "--mosaic", "bayer", "--raw-only", option, value
    )
    plain = acquired(read_cube(cube), used("model-rgb"))
    ours = acquired(read_cube(cube), used("model-rgb", **{field: value}))
    codes = codes_in(folder, "model-rgb")
    assert (codes == ours.codes).all()
    assert not (codes == plain.codes).all()
    assert result["imperfections"] == dict.fromkeys(EXTRA_NOISE, 0.0) | {field: value}


def test_imperfections_reach_the_picture_without_a_mosaic_too(take, cube):
    options = [word for k, v in IMPERFECT.items() for word in (f"--{k.replace('_', '-')}", v)]
    folder, _, _, _ = take("o", "model-rgb", *options)
    ours = rendered(read_cube(cube), used("model-rgb", **IMPERFECT))
    assert (tifffile.imread(folder / "model-rgb.xyz.tiff") == ours.xyz).all()


@pytest.mark.parametrize("more", [(), ("--mosaic", "sensor")])
@pytest.mark.parametrize(("threads", "tile"), [(1, 1), (2, 5), (3, 1000)])
def test_neither_threads_nor_tiles_change_a_byte(take, more, threads, tile):
    plain, _, _, _ = take("plain", "onyx-rgbw", *more)
    tiled, _, _, _ = take("tiled", "onyx-rgbw", *more, "--threads", threads, "--tile", tile)
    assert pixels_in(plain) == pixels_in(tiled)


def test_a_rerun_changes_nothing_but_the_seconds_and_another_seed_every_picture(take):
    asked = ("model-rgb", "--mosaic", "bayer", "--frames", 2, "--dsnu-e", 3, "--seed")
    first, _, out, err = take("o", *asked, 7)
    before = pixels_in(first), json.loads((first / "summary.json").read_text())
    again, _, out_again, err_again = take("o", *asked, 7)
    after = pixels_in(again), json.loads((again / "summary.json").read_text())
    assert (out, err) == (out_again, err_again)
    assert before[0] == after[0]
    for summary in (before[1], after[1]):
        assert all(picture.pop("seconds") > 0 for picture in summary["pictures"])
    assert before[1] == after[1]
    other = pixels_in(take("other", *asked, 8)[0])
    assert other.keys() == before[0].keys()
    assert all(other[name] != content for name, content in before[0].items())


def test_the_summary_says_how_each_picture_was_taken(take, cube):
    _, (result,), _, _ = take("o", "model-rgb", "--mosaic", "bayer", "--seed", 9, "--saturate", 0.5)
    assert result["sensor"] == "model-rgb"
    assert (result["height_px"], result["width_px"]) == (ROWS, COLUMNS)
    assert (result["seed"], result["frame"], result["illuminant"]) == (9, 0, "E")
    assert (result["level_lux"], result["f_number"], result["metric"]) == (10.0, 1.8, "quanta")
    assert result["mosaic"] == [["R", "G"], ["G", "B"]]
    assert result["time_ms"] == pytest.approx(1e3 * used("model-rgb").exposure.time_s * 50 / 99)
    assert set(result["mean_e"]) == set(result["above_full_well_share"]) == {"R", "G", "B"}
    assert all(0 < mean < 5000 for mean in result["mean_e"].values())
    assert set(result["above_full_well_share"].values()) == {0.0}
    assert result["white_xyz"][1] == pytest.approx(1.0)
    assert result["not_written"] == []


def test_the_share_above_full_well_is_told_and_what_was_done_with_it(take):
    bright = ("model-mono", "--lux", 1000, "--time-ms", 12, "--illuminant", "E")
    for name, more, words in (
        ("free", (), "--clip"),
        ("held", ("--clip",), "clipped"),
        ("codes", ("--mosaic", "W", "--raw-only"), "clipped"),
    ):
        _, (result,), _, err = take(name, *bright, *more)
        assert result["above_full_well_share"]["W"] > 0.99
        (note,) = [line for line in err.splitlines() if "of W" in line]
        assert words in note
        assert ("--clip" in note) == (name == "free")


def test_a_dng_of_warm_pixels_tells_more_noise_and_an_earlier_white(take):
    asked = ("model-rgb", "--mosaic", "bayer", "--raw-only", "--format", "dng", "--time-ms", 12)
    values = []
    for name, warm in (("cold", ()), ("warm", ("--dark-current-e-per-s", 1e5))):
        folder, _, _, _ = take(name, *asked, *warm)
        with tifffile.TiffFile(folder / "model-rgb.dng") as file:
            tags = file.pages[0].tags
            values.append((tags["NoiseProfile"].value[1], tags["WhiteLevel"].value))
    (cold_noise, cold_white), (warm_noise, warm_white) = values
    assert warm_noise > 2 * cold_noise
    assert 0 < warm_white < cold_white


def test_a_mosaic_that_dng_cannot_hold_is_written_as_tiff_with_a_word(take):
    folder, (result,), _, err = take("o", "onyx-rgbw", "--mosaic", "sensor", "--raw-only")
    assert names_in(folder) == ["onyx-rgbw.raw.tiff", "summary.json"]
    assert "DNG" in err
    (note,) = result["not_written"]
    assert "4 rows and 4 columns" in note


def test_a_complaint_about_a_file_leaves_out_the_scratch_folder(take, tmp_path):
    small = written_cube(tmp_path / "small.npz", rows=8, columns=8)  # readers of DNG want 22
    _, (result,), _, err = take("o", "model-rgb", "--mosaic", "bayer", "--raw-only", source=small)
    (note,) = result["not_written"]
    assert "model-rgb.dng" in note
    assert ".o-" not in note + err


def test_several_sensors_share_one_folder_and_one_summary(take):
    folder, result, out, _ = take(
        "o", "model-rgb", "--sensor", "model-rgbir", "--mosaic", "sensor", "--raw-only",
        "--format", "raw",
    )  # fmt: skip
    assert [picture["sensor"] for picture in result] == ["model-rgb", "model-rgbir"]
    assert names_in(folder) == ["model-rgb.raw.tiff", "model-rgbir.raw.tiff", "summary.json"]
    assert out.count("\n") == 3  # a sentence, then a line per picture


def test_one_pixel_has_a_code_but_not_the_colors_of_a_mosaic(take, run, tmp_path):
    source = written_cube(tmp_path / "one.npz", rows=1, columns=1)
    folder, (result,), _, _ = take(
        "o", "onyx-rgbw", "--mosaic", "sensor", "--raw-only", source=source
    )
    assert codes_in(folder, "onyx-rgbw").shape == (1, 1)
    assert result["mean_e"]["R"] > 0
    assert result["mean_e"]["W"] == 0  # W lies over no pixel of this picture
    outcome = run(
        "simulate", source, "--sensor", "onyx-rgbw", "--mosaic", "sensor", "-o", tmp_path / "c"
    )
    refused(outcome, "1 x 1", "4 x 4")


@contextmanager
def stopped_after(rows):
    seen = 0

    def advance(count):
        nonlocal seen
        seen += count
        if seen > rows:
            raise KeyboardInterrupt

    yield advance


@pytest.mark.parametrize("rows", [0, ROWS + 3])
def test_a_stop_in_the_work_leaves_nothing_not_even_the_frame_that_was_whole(
    run, cube, tmp_path, monkeypatch, rows
):
    monkeypatch.setattr(
        import_module("chromanoise.cli.simulate"), "progress_of", lambda *_: stopped_after(rows)
    )
    code, out, err = run(
        "simulate", cube, "--sensor", "model-rgb", "--mosaic", "bayer", "--frames", 3,
        "--tile", 2, "-o", tmp_path / "deep" / "o",
    )  # fmt: skip
    assert (code, out, err.strip()) == (130, "", "chromanoise: stopped")
    assert nothing_left(tmp_path)


BURST = ("--sensor", "model-rgb", "--mosaic", "bayer", "--raw-only", "--frames", "1000000")


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_a_long_burst_ends_it_and_keeps_what_was_there_before(cube, tmp_path, sent):
    folder = tmp_path / "o"
    folder.mkdir()
    (folder / "other.json").write_text("mine")
    with command("simulate", cube, *BURST, "-o", folder) as process:
        wait_for(lambda: list(tmp_path.glob(".o-*/*-0001.raw.tiff")), process)
        process.send_signal(sent)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, "")
    *estimate, last = filter(None, err.splitlines())
    assert last == "chromanoise: stopped"
    assert all(line.startswith("the pictures: takes about") for line in estimate)
    assert [path.name for path in tmp_path.iterdir()] == ["o"]
    assert names_in(folder) == ["other.json"]
    assert (folder / "other.json").read_text() == "mine"


def test_pictures_of_other_settings_or_without_a_record_are_kept(run, cube, tmp_path):
    folder = tmp_path / "o"
    asked = ("simulate", cube, "--sensor", "model-mono", "--time-ms", 12, "-o", folder)
    assert run(*asked)[0] == 0
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    for more in (("--lux", 1), ("--frames", 2), ("--sensor", "model-rgb")):
        refused(run(*asked, *more), subject=str(folder), value=str(folder))
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert run(*asked)[0] == 0
    (folder / "summary.json").write_text("{}")
    refused(run(*asked), subject=str(folder))


def test_an_ignored_sigint_stays_ignored_and_sigterm_ends_cleanly(cube, tmp_path):
    with command("simulate", cube, *BURST, "-o", tmp_path / "o", script=IGNORING) as process:
        wait_for(lambda: list(tmp_path.glob(".o-*/*-0001.raw.tiff")), process)
        process.send_signal(signal.SIGINT)
        (scratch,) = tmp_path.glob(".o-*/")
        ahead = len(list(scratch.iterdir())) + 20
        wait_for(lambda: len(list(scratch.iterdir())) > ahead, process)
        process.terminate()
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, "")
    assert err.splitlines()[-1] == "chromanoise: stopped"
    assert nothing_left(tmp_path)


def test_on_a_screen_a_bar_tells_rows_and_goes_away(done, cube, tmp_path, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # as if standard error were a screen
    out, err = done(
        "simulate", cube, "--sensor", "model-rgb", "--frames", 2, "--tile", 1, "-o", tmp_path / "o"
    )
    assert out.count("\n") == 3
    assert f"{2 * ROWS}/{2 * ROWS} rows" in err
    assert "\x1b[2K" in err  # the line is cleared


@pytest.mark.parametrize(
    ("options", "parts", "setting"),
    [
        (("--raw-only",), ("--raw-only", "--mosaic"), "raw_only"),
        (("--bits", 10), ("--bits", "--mosaic"), "bits"),
        (("--black-level", 0), ("--black-level", "--mosaic"), "black_level"),
        (("--demosaic", "lmmse", "--bits", 8), ("--demosaic", "--bits", "--mosaic"), "bits"),
        (("--format", "raw"), ("raw", "mosaic"), None),
        (("--mosaic", "bayer", "--raw-only", "--demosaic", "malvar"), ("--demosaic",), "demosaic"),
        (("--mosaic", "bayer", "--raw-only", "--format", "raw,png"), ("png", "raw"), None),
        (("--format", "png,xyz,png"), ("'png'",), "formats"),
        (("--format", "jpeg"), ("--format", "'jpeg'", "png"), "formats.0"),
        (("--format", ""), ("--format",), None),
        (("--mosaic", "bayer", "--demosaic", "amaze"), ("--demosaic", "'amaze'"), None),
        (("--frames", "two"), ("--frames", "two"), None),
        (("--mosaic", "bayer", "--black-level", 4095), ("4095",), "black_level"),
        (("--threads", 0), ("threads", "0"), None),
        (("--tile", 0), ("tile", "0"), None),
        (("--mosaic", "bayr"), ("'bayr'", "bayer"), "mosaic"),
        (("--mosaic", "RG/B"), ("row 1", "row 0"), "mosaic"),
        (("--mosaic", "RG//GB"), ("RG//GB",), "mosaic"),
        (("--mosaic", "RG/GX"), ("X", "model-rgb", "R, G, B"), ""),
        (("--mosaic", "RG/RG"), ("B", "R, G"), ""),
        (("--mosaic", "RGG/BRG", "--demosaic", "malvar"), ("Malvar", "Bayer"), "mosaic"),
        (("--scheduler", "local", "--threads", 0), ("threads", "0"), None),
        (("--sensor", "model-rgb"), ("chromanoise: --sensor ", "model-rgb"), "sensors.1.name"),
    ],
)
def test_what_cannot_be_is_one_sentence_and_leaves_nothing(
    run, cube, tmp_path, options, parts, setting
):
    """``setting`` is a key of the picture or the study; None where no setting is wrong."""
    outcome = run(
        "simulate", cube, "--sensor", "model-rgb", *options, "-o", tmp_path / "deep" / "o"
    )
    key = setting or ("" if setting is None else "pictures.0")
    if setting and not setting.startswith("sensors"):
        key = f"pictures.0.{setting}"
    refused(outcome, *parts, **({"setting": key} if key else {}))
    assert nothing_left(tmp_path)


def test_a_sensor_without_a_mosaic_cannot_lend_its_own(run, cube, tmp_path):
    asked = ("simulate", cube, "--sensor", "model-mono", "-o", tmp_path / "o", "--mosaic")
    refused(run(*asked, "sensor"), "model-mono", "W", setting="pictures.0.mosaic")
    refused(run(*asked, "bayer"), "model-mono", "R", "W", setting="pictures.0")
    assert nothing_left(tmp_path)


def test_channels_that_the_mosaic_leaves_out_are_missed_only_by_color(take):
    _, (result,), _, _ = take("o", "model-rgbw", "--mosaic", "bayer", "--raw-only")
    assert result["mean_e"]["W"] == 0


@pytest.mark.usefixtures("without_work")
def test_what_color_lacks_is_told_before_the_long_work(run, cube, tmp_path):
    outcome = run(
        "simulate", cube, "--sensor", "model-rgbw", "--mosaic", "bayer", "-o", tmp_path / "o"
    )
    refused(outcome, "W", "R, G, B", setting="pictures.0")


@pytest.mark.parametrize(
    ("sensor", "options", "parts"),
    [
        (
            "onyx-rgbw",
            ("--mosaic", "sensor", "--format", "raw,dng"),
            ("4 rows", "4 columns", "TIFF"),
        ),
        ("model-mono", ("--mosaic", "W", "--format", "dng"), ("3",)),
        ("model-rgb", ("--mosaic", "bayer", "--format", "dng"), ("8 x 8",)),
    ],
)
@pytest.mark.usefixtures("without_work")
def test_a_dng_that_nobody_could_open_is_refused_before_the_work(
    run, tmp_path, sensor, options, parts
):
    small = written_cube(tmp_path / "cube.npz", rows=8, columns=8)
    outcome = run("simulate", small, "--sensor", sensor, *options, "-o", tmp_path / "deep" / "o")
    refused(outcome, "DNG", *parts)
    assert names_in(tmp_path) == ["cube.npz"]


@pytest.mark.usefixtures("without_work")
def test_an_exr_without_its_package_is_refused_before_the_work(run, cube, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OpenEXR", None)
    outcome = run(
        "simulate", cube, "--sensor", "model-rgb", "--format", "png,exr", "-o", tmp_path / "o"
    )
    refused(outcome, "OpenEXR", "chromanoise[exr]")
    assert nothing_left(tmp_path)


def test_the_filters_of_a_burst_are_made_once_for_each_sensor(take, monkeypatch):
    made = []
    original = DEMOSAICING["bilinear"]
    monkeypatch.setitem(
        DEMOSAICING,
        "bilinear",
        lambda *a: made.append(a) or original(*a),  # type: ignore
    )
    take("o", "model-rgb", "--sensor", "onyx-rgb", "--mosaic", "bayer", "--frames", 3)
    assert len(made) == 2


@pytest.mark.parametrize("name", ["../../pwned", "..", "/tmp/pwned", "a\\b", ".hidden"])
def test_pictures_stay_in_their_folder_whatever_a_sensor_calls_itself(done, tmp_path, name):
    path = tmp_path / "mine.json"
    path.write_text(sensor_json(replace(sensor_named("model-rgb", DEFAULT_GRID), name=name)))
    out = tmp_path / "a" / "b" / "out"
    done(*("simulate", "builtin:checker", "--sensor", path, "-o", out), "--format", "png")
    (picture,) = out.glob("*.png")
    assert picture.is_file()
    assert not picture.name.startswith(".")
    assert sorted(p for p in tmp_path.rglob("*") if p.is_file()) == sorted(
        [path, picture, out / "summary.json", out / OWN_FILES]
    )


def test_a_stem_that_leads_elsewhere_is_refused_before_anything_is_written(
    run, tmp_path, monkeypatch
):
    shots = []

    def kept(folder, stem, taken):
        shots.append(taken)
        return [], []

    monkeypatch.setattr("chromanoise.study.running.write_capture", kept)
    out = tmp_path / "out"
    assert run("simulate", "builtin:checker", "--sensor", "model-rgb", "-o", out)[0] == 0
    (taken,) = shots
    before = sorted(tmp_path.rglob("*"))
    for stem in ("../x", "a/b", "a\\b", "a\0b", ".x", ".."):
        with pytest.raises(InputError):
            write_capture(out, stem, taken)
    assert sorted(tmp_path.rglob("*")) == before
    assert write_capture(out, "x", taken)[0] == ["x.png", "x.xyz.tiff"]


def test_two_sensors_whose_files_would_have_one_name_are_refused(run, tmp_path):
    paths = []
    for i, name in enumerate(("a/b", "a-b")):
        paths.append(tmp_path / f"{i}.json")
        sensor = replace(sensor_named("model-rgb", DEFAULT_GRID), name=name)
        paths[-1].write_text(sensor_json(sensor))
    sensors = ("--sensor", paths[0], "--sensor", paths[1])
    refused(run("simulate", "builtin:checker", *sensors, "-o", tmp_path / "o"), value="a-b")
    assert not (tmp_path / "o").exists()
