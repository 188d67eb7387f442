"""What is written is read back by other programs, number for number, or was never there."""

import errno
import io
import json
import os
import resource
import sys
import tracemalloc
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from itertools import pairwise

import colour
import numpy as np
import pytest
import tifffile
from hypothesis import given, settings, strategies as st
from PIL import Image

from chromanoise.base.files import whole_folder
from chromanoise.imaging import acquired, rendered
from chromanoise.imaging.row_files import write_linear_exr, write_xyz_exr
from chromanoise.imaging.writers import (
    mosaic_tiff_rows,
    picture_summary,
    png_bytes,
    raw_summary,
    sixteen_bit_srgb,
    srgb_tiff_rows,
    write_mosaic_tiff,
    write_srgb_tiff,
    write_xyz_tiff,
    xyz_tiff_rows,
)
from chromanoise.sensor import Adc, bayer, rgbw_sparse_4x4
from chromanoise.spectra import cie_a, flat_cube
from outcomes import refused_input
from strategies import GRID, bell_qe, point_of, sensor_of

ADC = Adc(bits=12, gain_e_per_dn=2.5, black_level_dn=64)
TOLD = {"sensor_name": "toy", "mosaic": bayer(), "adc": ADC}
D65 = np.array([0.95047, 1.0, 1.08883])


def drawn(*shape, dtype="uint16"):
    rng = np.random.default_rng(sum(shape))
    if dtype == "float32":
        return rng.normal(size=shape).astype("f4")
    return rng.integers(0, 65536, shape).astype(dtype)


def mosaic_rows(folder, height, width):
    """Rows of the file m.tiff."""
    return mosaic_tiff_rows(folder / "m.tiff", height=height, width=width, **TOLD)


@contextmanager
def files_no_larger_than(size):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@settings(max_examples=12)
@given(st.integers(1, 9), st.integers(1, 9))
def test_a_mosaic_comes_back_from_its_tiff(tmp_path_factory, height, width):
    path = tmp_path_factory.mktemp("tiff") / "m.tiff"
    codes = drawn(height, width)
    write_mosaic_tiff(path, codes, **TOLD)
    with Image.open(path) as seen:
        assert seen.mode == "I;16"
        assert (np.asarray(seen) == codes).all()
    assert (tifffile.imread(path).reshape(codes.shape) == codes).all()


def test_a_mosaic_tiff_tells_in_json_how_its_codes_were_made(tmp_path):
    path = tmp_path / "m.tiff"
    values = {"sensor_name": "Grün \u2014 4x4", "mosaic": rgbw_sparse_4x4(), "adc": ADC}
    write_mosaic_tiff(path, drawn(3, 4), **values)
    with tifffile.TiffFile(path) as file:
        description = file.pages[0].tags[270].value
    assert json.loads(description) == {
        "sensor": "Grün \u2014 4x4",
        "bits": 12,
        "black_level_dn": 64,
        "gain_e_per_dn": 2.5,
        "pattern": [list("RWGW"), list("WWWW"), list("GWBW"), list("WWWW")],
    }


@settings(max_examples=12)
@given(st.integers(1, 6), st.integers(1, 6))
def test_colors_come_back_from_their_tiff(tmp_path_factory, height, width):
    folder = tmp_path_factory.mktemp("tiff")
    srgb, xyz = drawn(height, width, 3), drawn(height, width, 3, dtype="float32")
    write_srgb_tiff(folder / "s.tiff", srgb)
    write_xyz_tiff(folder / "x.tiff", xyz)
    for name, pixels in (("s.tiff", srgb), ("x.tiff", xyz)):
        with tifffile.TiffFile(folder / name) as file:
            page = file.pages[0]
            assert (page.asarray() == pixels).all()
            assert (page.shape, page.dtype) == (pixels.shape, pixels.dtype)
            assert page.photometric == tifffile.PHOTOMETRIC.RGB


def test_middle_grey_is_encoded_as_30235_of_65535():
    # 1.055 * .18^(1/2.4) - .055 = 0.461356, times 65535; black 0, white the top (IEC 61966-2-1)
    grey = np.array([0.0, 0.18, 1.0])[:, None] * np.array([1.0985, 1.0, 0.3558])
    encoded = sixteen_bit_srgb(grey, np.array([1.0985, 1.0, 0.3558])).astype(int)
    assert encoded == pytest.approx(np.array([0, 30235, 65535])[:, None] * np.ones(3), abs=6)


def test_sixteen_bits_agree_with_the_srgb_of_colour_science():
    xyz = np.linspace(0.01, 1, 200)[:, None] * D65 * np.array([0.9, 0.95, 0.8])
    linear = colour.XYZ_to_RGB(xyz, "sRGB", apply_cctf_encoding=False)
    assert ((linear > 0) & (linear < 1)).all()  # none at the border of the gamut
    encoded = colour.cctf_encoding(linear, "sRGB")
    # their matrix is the printed one as well; D65 differs in the fifth digit
    assert sixteen_bit_srgb(xyz, D65) == pytest.approx(65535 * encoded, abs=4)


@settings(max_examples=20)
@given(st.data())
def test_rows_put_in_any_order_make_the_file_of_the_whole_picture(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("rows")
    height = data.draw(st.integers(1, 12))
    cuts = sorted(data.draw(st.sets(st.integers(1, height))) | {0, height})
    blocks = data.draw(st.permutations(list(pairwise(cuts))))
    pixels = drawn(height, 5, 3, dtype="float32")
    write_xyz_tiff(folder / "whole.tiff", pixels)
    with xyz_tiff_rows(folder / "rows.tiff", height=height, width=5) as put:
        for start, stop in blocks:
            put(start, pixels[start:stop])
    assert (folder / "rows.tiff").read_bytes() == (folder / "whole.tiff").read_bytes()


def test_threads_may_put_rows_at_the_same_time(tmp_path):
    codes = drawn(400, 300)
    with (
        mosaic_rows(tmp_path, 400, 300) as put,
        ThreadPoolExecutor(8) as pool,
    ):
        list(pool.map(lambda row: put(row, codes[row : row + 1]), range(400)))
    assert (tifffile.imread(tmp_path / "m.tiff") == codes).all()


@pytest.mark.parametrize("layout", ["big-endian", "transposed", "strided"])
def test_how_rows_lie_in_memory_does_not_change_the_file(tmp_path, layout):
    codes = drawn(6, 6)
    same = {
        "big-endian": codes.astype(">u2"),
        "transposed": np.asfortranarray(codes),
        "strided": np.repeat(codes, 2, axis=1)[:, ::2],
    }[layout]
    with mosaic_rows(tmp_path, 6, 6) as put:
        put(0, same)
    assert (tifffile.imread(tmp_path / "m.tiff") == codes).all()


def test_a_picture_in_rows_is_never_held_in_memory(tmp_path):
    with srgb_tiff_rows(tmp_path / "s.tiff", height=1, width=1) as put:  # imports are paid
        put(0, drawn(1, 1, 3))
    rows = drawn(10, 1000, 3)
    tracemalloc.start()
    with srgb_tiff_rows(tmp_path / "s.tiff", height=4000, width=1000) as put:
        for start in range(0, 4000, 10):
            put(start, rows)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert (tmp_path / "s.tiff").stat().st_size > 24_000_000
    assert peak < 1_000_000


def test_a_rerun_is_the_same_to_the_last_byte(tmp_path):
    for name in ("a", "b"):
        write_mosaic_tiff(tmp_path / f"{name}1", drawn(4, 5), **TOLD)
        write_srgb_tiff(tmp_path / f"{name}2", drawn(4, 5, 3))
        write_xyz_tiff(tmp_path / f"{name}3", drawn(4, 5, 3, dtype="float32"))
    for i in (1, 2, 3):
        assert (tmp_path / f"a{i}").read_bytes() == (tmp_path / f"b{i}").read_bytes()
        with tifffile.TiffFile(tmp_path / f"a{i}") as file:
            assert "DateTime" not in file.pages[0].tags  # two runs may share a second


def test_a_missing_row_is_told_and_never_zero(tmp_path):
    with (
        refused_input(where="row 3 (from 0)", value=2),
        mosaic_rows(tmp_path, 5, 2) as put,
    ):
        put(0, drawn(3, 2))


@pytest.mark.parametrize(
    ("start", "rows", "value"),
    [
        (0, drawn(2, 3).astype("i4"), "int32"),
        (0, drawn(2, 4), (4,)),
        (4, drawn(2, 3), (4, 5)),
        (-1, drawn(1, 3), (-1, -1)),
    ],
)
def test_rows_that_do_not_fit_are_refused(tmp_path, start, rows, value):
    with (
        refused_input(subject=str(tmp_path / "m.tiff"), value=value),
        mosaic_rows(tmp_path, 5, 3) as put,
    ):
        put(start, rows)


def test_an_empty_picture_is_refused(tmp_path):
    with refused_input(subject=str(tmp_path / "m.tiff"), value=(0, 4)):
        write_mosaic_tiff(tmp_path / "m.tiff", np.empty((0, 4), np.uint16), **TOLD)
    assert not list(tmp_path.iterdir())


def test_a_file_larger_than_allowed_is_told_before_the_first_row(tmp_path):
    with (
        files_no_larger_than(100_000),
        refused_input(subject=str(tmp_path / "m.tiff"), requirement="File too large"),
        mosaic_rows(tmp_path, 1000, 1000),
    ):
        pytest.fail("rows were computed for a disk without space")


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="no way to claim space")
def test_a_full_disk_is_told_before_the_first_row(tmp_path, monkeypatch):
    def full(_file, start, size):
        assert (start, size) == (0, (tmp_path / "m.tiff").stat().st_size)
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "posix_fallocate", full)
    with (
        refused_input(subject=str(tmp_path / "m.tiff"), requirement="No space left on device"),
        mosaic_rows(tmp_path, 10, 10),
    ):
        pytest.fail("rows were computed for a disk without space")


def test_a_disk_that_cannot_tell_its_space_is_written_to_nevertheless(tmp_path, monkeypatch):
    def unknown(*_):
        raise OSError(errno.EOPNOTSUPP, "")

    monkeypatch.setattr(os, "posix_fallocate", unknown, raising=False)
    write_mosaic_tiff(tmp_path / "m.tiff", drawn(10, 10), **TOLD)
    assert (tifffile.imread(tmp_path / "m.tiff") == drawn(10, 10)).all()


def test_a_disk_that_fills_while_rows_are_put_is_told(tmp_path, monkeypatch):
    monkeypatch.delattr("os.posix_fallocate", raising=False)
    with (
        refused_input(subject=str(tmp_path / "m.tiff")),
        mosaic_rows(tmp_path, 1000, 1000) as put,
        files_no_larger_than(100_000),
    ):
        put(0, drawn(1000, 1000))


def test_a_folder_that_is_not_there_is_told(tmp_path):
    with refused_input(subject=str(tmp_path / "none/s.tiff"), requirement="No such file"):
        write_srgb_tiff(tmp_path / "none" / "s.tiff", drawn(2, 2, 3))


def test_a_failure_of_the_computation_is_not_called_one_of_the_disk(tmp_path):
    with (
        pytest.raises(OSError, match="the cube ended"),
        mosaic_rows(tmp_path, 5, 3),
    ):
        raise OSError("the cube ended")


def interrupted():
    raise KeyboardInterrupt


def test_an_interrupted_run_leaves_no_file(tmp_path):
    with (
        pytest.raises(KeyboardInterrupt),
        whole_folder(tmp_path / "out", "a") as folder,
        mosaic_rows(folder, 5, 3) as put,
    ):
        put(0, interrupted())
    assert not list(tmp_path.iterdir())


def test_a_png_comes_back():
    srgb = drawn(4, 5, 3).astype("u1")
    assert (np.asarray(Image.open(io.BytesIO(png_bytes(srgb)))) == srgb).all()


@pytest.fixture
def openexr():
    return pytest.importorskip("OpenEXR")


def exr_of(openexr, path):
    with openexr.File(str(path)) as file:
        return file.channels()["RGB"].pixels, dict(file.header())


def test_xyz_comes_back_from_its_exr_with_the_axes_as_primaries(tmp_path, openexr):
    xyz = drawn(4, 7, 3, dtype="float32")
    write_xyz_exr(tmp_path / "x.exr", xyz, np.array([1.0985, 1.0, 0.3558]))
    pixels, header = exr_of(openexr, tmp_path / "x.exr")
    assert pixels.dtype == np.float32
    assert (pixels == xyz).all()
    assert header["chromaticities"] == pytest.approx((1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3))
    # x, y of illuminant A (CIE 15:2018, table T.3)
    assert header["adoptedNeutral"] == pytest.approx([0.44758, 0.40745], abs=1e-4)


def test_linear_light_in_exr_has_rec_709_primaries_white_at_1_and_no_clip(tmp_path, openexr):
    # columns: the XYZ of red, green, blue as IEC 61966-2-1 prints them; then twice white and below
    primaries = np.array(
        [[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]]
    )
    xyz = np.vstack([primaries, D65, 2 * D65, -0.1 * D65])[None]
    write_linear_exr(tmp_path / "l.exr", xyz, D65)
    pixels, header = exr_of(openexr, tmp_path / "l.exr")
    wanted = np.vstack([np.eye(3), np.ones(3), 2 * np.ones(3), -0.1 * np.ones(3)])
    assert pixels[0] == pytest.approx(wanted, abs=5e-4)
    # ITU-R BT.709: red .64 .33, green .30 .60, blue .15 .06, white .3127 .3290
    assert header["chromaticities"] == pytest.approx(
        (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
    )


def test_half_floats_miss_by_2_to_the_minus_11_at_most(tmp_path, openexr):
    xyz = drawn(16, 16, 3, dtype="float32")
    write_xyz_exr(tmp_path / "h.exr", xyz, D65, half=True)
    pixels, _ = exr_of(openexr, tmp_path / "h.exr")
    assert pixels.dtype == np.float16
    miss = np.abs(pixels.astype("f4") - xyz)
    assert (miss <= np.maximum(2.0**-11 * np.abs(xyz), 2.0**-25)).all()
    assert miss.any()


def test_an_exr_is_the_same_to_the_last_byte_on_a_rerun(tmp_path, openexr):
    for name in ("a", "b"):
        write_linear_exr(tmp_path / name, drawn(40, 50, 3, dtype="float32"), D65)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_what_an_exr_cannot_hold_is_refused(tmp_path, openexr):
    xyz = np.ones((2, 2, 3))
    with refused_input(value=70_000.0, setting="half"):
        write_xyz_exr(tmp_path / "h.exr", 70_000 * xyz, D65, half=True)
    xyz[1, 0, 2] = np.nan
    with refused_input(subject=f"color of {tmp_path / 'n.exr'}"):
        write_xyz_exr(tmp_path / "n.exr", xyz, D65)
    with refused_input(value=(0, 2, 3)):
        write_xyz_exr(tmp_path / "e.exr", xyz[:0], D65)
    with refused_input(subject=str(tmp_path / "w.exr"), value=[0.0, 0.0, 0.0]):
        write_xyz_exr(tmp_path / "w.exr", np.ones((2, 2, 3)), np.zeros(3))
    with refused_input(subject=str(tmp_path / "none/x.exr")):
        write_xyz_exr(tmp_path / "none" / "x.exr", np.ones((2, 2, 3)), D65)
    assert not list(tmp_path.iterdir())


def test_without_openexr_the_command_that_installs_it_is_told(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OpenEXR", None)
    with refused_input() as caught:
        write_xyz_exr(tmp_path / "x.exr", np.ones((2, 2, 3)), D65)
    assert "pip install 'chromanoise[exr]'" in caught.value.remedy[0]


RGB = sensor_of(bell_qe([450, 540, 610], [30, 45, 40], [0.6, 0.7, 0.6]), names=("B", "G", "R"))
SITUATION = point_of(RGB, illuminant=cie_a(GRID))
GREY = flat_cube(GRID.wavelength_nm, 0.5, height=4, width=6)


def test_a_summary_tells_electrons_share_above_full_well_seed_and_the_time_of_each_step():
    picture = rendered(GREY, SITUATION, seed=7)
    raw = acquired(GREY, SITUATION, mosaic=bayer(), adc=ADC, seed=3, frame=2)
    of_raw = {"bits": 12, "gain_e_per_dn": 2.5, "black_level_dn": 64, "seed": 3, "frame": 2}
    of_raw["mosaic"] = [["R", "G"], ["G", "B"]]  # what a code means
    for taken, summary, known in (
        (picture, picture_summary, {"seed": 7, "frame": 0}),
        (raw, raw_summary, of_raw),
    ):
        plain, timed = summary(taken), summary(taken, seconds={"render": 0.25})
        assert timed == {**plain, "seconds": {"render": 0.25}}
        known |= {"height_px": 4, "width_px": 6}
        assert {name: plain[name] for name in known} == known
        assert plain["mean_e"] == dict(zip("BGR", taken.mean_e.tolist(), strict=True))
        assert set(plain["above_full_well_share"]) == set("BGR")
        assert json.loads(json.dumps(timed, allow_nan=False)) == timed
