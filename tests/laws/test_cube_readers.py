"""Cubes from files: what was written is what is read, and what is wrong is said in one sentence."""

import io
import struct
import time
import warnings
import zipfile
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from chromanoise.base.errors import InputError
from chromanoise.io.cubes import read_cube
from chromanoise.spectra import Cube
from chromanoise.spectra.scene_rows import row_source
from outcomes import refused_input

REAL = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "cubes"
NM = (400.0, 450.0, 500.0, 600.0, 700.0)
STRUCT_LETTER = {1: "B", 2: "h", 3: "i", 4: "f", 5: "d", 12: "H", 13: "I", 14: "q", 15: "Q"}
LAYOUTS = list(product(("bsq", "bil", "bip"), STRUCT_LETTER, (0, 1), (0, 7)))


def numbers(rows=3, columns=4, bands=5):
    """Whole numbers 1 .. 127, which every data type can hold."""
    return np.random.default_rng(5).integers(1, 128, size=(rows, columns, bands))


def in_file_order(cube, interleave):
    """The values one by one, as the ENVI manual tells: the last letter's axis runs fastest."""
    rows, columns, bands = (range(n) for n in cube.shape)
    if interleave == "bsq":
        return [cube[r, c, b] for b in bands for r in rows for c in columns]
    if interleave == "bil":
        return [cube[r, c, b] for r in rows for b in bands for c in columns]
    return [cube[r, c, b] for r in rows for c in columns for b in bands]


def write_envi(folder, cube=None, *, name="cube", drop=(), extra=b"", newline="\n", **changed):
    """An ENVI pair written by hand; keys with _ for a blank replace or join the usual ones."""
    cube = numbers() if cube is None else cube
    keys = {
        "samples": cube.shape[1],
        "lines": cube.shape[0],
        "bands": cube.shape[2],
        "header offset": 0,
        "data type": 4,
        "interleave": "bsq",
        "byte order": 0,
        "wavelength units": "Nanometers",
        "wavelength": "{" + ", ".join(str(w) for w in NM) + "}",
    }
    keys |= {key.replace("_", " "): value for key, value in changed.items()}
    letter = STRUCT_LETTER.get(keys["data type"], "f")
    order = "<>"[keys["byte order"] == 1]
    values = in_file_order(cube, str(keys["interleave"]).lower())
    data = b"\xaa" * keys["header offset"] + struct.pack(f"{order}{len(values)}{letter}", *values)
    text = newline.join(["ENVI", *(f"{k} = {v}" for k, v in keys.items() if k not in drop), ""])
    (folder / f"{name}.img").write_bytes(data)
    (folder / f"{name}.hdr").write_bytes(text.encode("latin-1") + extra)
    return folder / f"{name}.hdr"


def assert_holds(cube, expected):
    assert isinstance(cube, Cube)
    np.testing.assert_array_equal(np.asarray(cube.stored), expected)


# ENVI: what was written is what is read


@pytest.mark.parametrize(("interleave", "data_type", "byte_order", "offset"), LAYOUTS)
def test_every_envi_layout_gives_back_what_was_written(
    tmp_path, interleave, data_type, byte_order, offset
):
    path = write_envi(
        tmp_path,
        interleave=interleave,
        data_type=data_type,
        byte_order=byte_order,
        header_offset=offset,
    )
    cube = read_cube(path, scale=0.01)
    assert_holds(cube, numbers())
    assert cube.wavelength_nm.tolist() == list(NM)
    assert cube.scale == 0.01


@pytest.mark.parametrize("interleave", ["BSQ", "Bil", "bip"])
def test_an_envi_cube_stays_on_disk_whatever_its_interleave(tmp_path, interleave):
    cube = read_cube(write_envi(tmp_path, interleave=interleave))
    assert isinstance(cube.stored, np.memmap)
    assert not cube.stored.flags.owndata
    assert not cube.stored.flags.writeable
    assert_holds(cube, numbers())


def test_header_and_data_name_the_same_cube(tmp_path):
    header = write_envi(tmp_path)
    from_data = read_cube(header.with_suffix(".img"))
    assert_holds(from_data, read_cube(header).stored)
    assert from_data.source.endswith("cube.img")


@pytest.mark.parametrize(
    ("header", "data"),
    [
        ("a.hdr", "a"),
        ("a.img.hdr", "a.img"),
        ("a.HDR", "a.RAW"),
        *[("a.b.hdr", f"a.b.{e}") for e in ("img", "raw", "dat", "bin", "bsq", "bil", "bip")],
    ],
)
def test_header_and_data_are_paired_by_name(tmp_path, header, data):
    written = write_envi(tmp_path, name="temporary")
    written.with_suffix(".img").rename(tmp_path / data)
    written.rename(tmp_path / header)
    for name in (header, data):
        assert_holds(read_cube(tmp_path / name), numbers())


def test_the_header_that_bears_the_whole_name_of_the_data_goes_first(tmp_path):
    right = write_envi(tmp_path)
    right.rename(tmp_path / "cube.img.hdr")
    right.write_text("ENVI\nbands = 1\n")
    assert_holds(read_cube(tmp_path / "cube.img"), numbers())


LISTED = {"wavelength": "{.4,.45,.5,.6,.7}"}
COMMENTS = (
    b"; bands = {a comment\r\n"
    b"sensor = { spread\r\n over \xb5 lines,\r\n; with a comment }\r\n and more }\r\n"
    b"no equals sign here\r\n= no key\r\nmap info = {UTM, 1}\r\n"
)
IN_COMMENTS = "{400,\r\n; 425, left out }\r\n450, 500, 600, 700}"
IN_LINES = "{\n 400,\n450,500 ,\n\n600,700,\n}"
NO_UNIT = ("wavelength units",)


def in_names(unit, per_nm=1.0):
    names = ",\n".join(f"Band {i}: {w * per_nm:.3f} {unit}" for i, w in enumerate(NM))
    return {"drop": ("wavelength",), "band_names": f"{{{names}}}"}


HEADERS = [
    ({"newline": "\r\n", "extra": COMMENTS, "wavelength": IN_COMMENTS}, ""),
    *[({"newline": newline}, "") for newline in ("\r\n", "\r")],
    ({"drop": ("samples", "data type"), "extra": b"SAMPLES=4\nData  Type =4\n"}, ""),
    ({"wavelength": IN_LINES}, ""),
    *[({**LISTED, "wavelength_units": unit}, "") for unit in ("um", "microns", "\u00b5m")],
    ({**LISTED, "drop": NO_UNIT}, "taken as micrometers"),
    *[({"wavelength_units": unit}, "taken as nm") for unit in ("Unknown", "Index")],
    ({"drop": NO_UNIT}, "taken as nm"),
    *[(in_names(unit), "band names") for unit in ("Nanometers", "nm")],
    (in_names("Micrometers", 0.001), "band names"),
    *[({"drop": (key,)}, f"lacks {key!r}") for key in ("byte order", "header offset")],
    ({"bbl": "{1,1,1,1,0}", "data_ignore_value": "-9999"}, "applied: bbl, data ignore value"),
]


@pytest.mark.parametrize(("changed", "note"), HEADERS)
def test_what_a_header_writes_otherwise_or_lacks_is_understood_and_noted(tmp_path, changed, note):
    cube = read_cube(write_envi(tmp_path, **changed))
    assert_holds(cube, numbers())
    np.testing.assert_allclose(cube.wavelength_nm, NM, rtol=1e-15)
    assert any(note in one for one in cube.notes) if note else cube.notes == ()


def test_falling_wavelengths_turn_the_bands_about_without_a_copy_and_it_is_noted(tmp_path):
    path = write_envi(tmp_path, wavelength="{700,600,500,450,400}")
    cube = read_cube(path)
    assert_holds(cube, numbers()[:, :, ::-1])
    assert cube.wavelength_nm.tolist() == list(NM)
    assert isinstance(cube.stored, np.memmap)
    assert any("band order reversed" in note for note in cube.notes)


# scale


@pytest.mark.parametrize("data_type", [2, 4])
def test_the_reflectance_scale_factor_divides(tmp_path, data_type):
    path = write_envi(tmp_path, data_type=data_type, reflectance_scale_factor="10000")
    assert read_cube(path).scale == 1e-4


def test_the_callers_scale_wins_over_the_header(tmp_path):
    for factor in ("10000", "zero"):
        path = write_envi(tmp_path, data_type=2, reflectance_scale_factor=factor)
        cube = read_cube(path, scale=0.5)
        assert cube.scale == 0.5
        assert any("x 0.5" in note for note in cube.notes)


def test_real_numbers_without_a_scale_are_reflectance(tmp_path):
    assert read_cube(write_envi(tmp_path)).scale == 1.0


@pytest.mark.parametrize("data_type", [1, 2, 3, 12, 13, 14, 15])
def test_integers_without_a_scale_are_refused(tmp_path, data_type):
    path = write_envi(tmp_path, data_type=data_type)
    with refused_input(subject=str(path), setting="scale") as caught:
        read_cube(path)
    assert np.dtype(caught.value.value).kind in "iu"


RADIANCE = [
    {"name": "ang2016_2rdn_img"},
    {"name": "Radiance_of_a_field"},
    {"description": "{flight/ang2016_rdn_v1n2/x}"},
    {"description": "{spectral radiance}"},
    {"units": "uW cm-2 nm-1 sr-1"},
    {"data_units": "W/m^2/um/sr"},
    {"data_units": "Watts"},
    {"data_units": "Wm-2"},
    {"data_units": "radiance"},
]


@pytest.mark.parametrize("words", RADIANCE)
def test_radiance_is_refused_unless_the_caller_says_a_scale(tmp_path, words):
    path = write_envi(tmp_path, **words)
    with refused_input(subject=str(path), setting="scale", requirement="reflectance"):
        read_cube(path)
    cube = read_cube(path, scale=0.01)
    assert cube.scale == 0.01
    assert any("radiance" in note and "scale to reflectance" in note for note in cube.notes)


@pytest.mark.parametrize(
    "words",
    [
        {"name": "garden"},
        {"name": "hardness"},
        {"description": "{radiance turned into reflectance}"},
        {"data_units": "percent of White"},
    ],
)
def test_reflectance_is_not_taken_for_radiance(tmp_path, words):
    assert_holds(read_cube(write_envi(tmp_path, **words)), numbers())


@pytest.mark.parametrize("scale", [0.0, -1.0, float("nan"), float("inf")])
def test_an_impossible_scale_is_refused(tmp_path, scale):
    with refused_input(subject="scale") as caught:
        read_cube(write_envi(tmp_path), scale=scale)
    np.testing.assert_equal(caught.value.value, scale)


# wavelengths


def test_the_callers_wavelengths_are_evenly_spaced_and_win_over_the_file(tmp_path):
    cube = read_cube(write_envi(tmp_path), wavelengths=(400, 800))
    assert cube.wavelength_nm.tolist() == [400, 500, 600, 700, 800]
    assert any("those in the file are not used" in note for note in cube.notes)


def test_the_callers_wavelengths_cure_a_bad_list(tmp_path):
    path = write_envi(tmp_path, wavelength="{a, b}")
    assert read_cube(path, wavelengths=(400, 800)).wavelength_nm[1] == 500


def test_the_callers_wavelengths_may_fall(tmp_path):
    cube = read_cube(write_envi(tmp_path), wavelengths=(800, 400))
    assert cube.wavelength_nm[0] == 400
    assert_holds(cube, numbers()[:, :, ::-1])


@pytest.mark.parametrize("ends", [(500, 500), (0.4, 0.8), (400, float("nan")), (400, 1e300)])
def test_impossible_wavelengths_of_the_caller_are_refused(tmp_path, ends):
    with refused_input(subject="wavelengths") as caught:
        read_cube(write_envi(tmp_path), wavelengths=ends)
    np.testing.assert_equal(caught.value.value, ends)


# ENVI: what is wrong is said

ENVI_FAULTS = [
    *[({"drop": (k,)}, (k,)) for k in ("samples", "lines", "bands", "data type", "interleave")],
    ({"data_type": 6}, ("data type",)),
    ({"data_type": 9}, ("data type",)),
    ({"data_type": 7}, ("data type", "7")),
    ({"interleave": "bis"}, ("interleave", "'bis'")),
    ({"byte_order": 2}, ("byte order",)),
    ({"drop": ("header offset",), "extra": b"header offset = -4"}, ("header offset", "-4")),
    ({"samples": 0}, ("samples",)),
    ({"lines": -3}, ("lines", "-3")),
    ({"bands": "9" * 5000}, ("bands", "9" * 40)),
    ({"bands": "5.5"}, ("bands", "5.5")),
    ({"lines": 4}, ("240 bytes", "320")),
    ({"samples": 10**17, "lines": 10**17}, ("240 bytes",)),
    ({"lines": 2}, ("240 bytes", "160")),
    ({"drop": ("header offset",), "header_offset": 8}, ("240 bytes",)),
    ({"file_compression": 1}, ("compress",)),
    ({"extra": b"bands = 6"}, ("bands", "'5'", "'6'")),
    ({"extra": b"fwhm = {1, 2\n"}, ("line 11",)),
    ({"wavelength": "{ , }"}, ("wavelength",)),
    ({"wavelength": "{400, 450, x, 600, 700}"}, ("entry 2", "wavelength", "'x'")),
    ({"wavelength": "{400, nan, 500, 600, 700}"}, ("entry 1", "wavelength", "nan")),
    ({"wavelength": "{1, 2, 3, 4, 5}", "wavelength_units": "Index"}, ("wavelength",)),
    ({"wavelength_units": "Wavenumber"}, ("wavelength units", "wavenumber")),
    ({"wavelength": "{1, 2, 3, 4, 500}", "wavelength_units": "Unknown"}, ("wavelength",)),
    ({"reflectance_scale_factor": "0"}, ("reflectance scale factor",)),
    ({"reflectance_scale_factor": "ten"}, ("reflectance scale factor", "'ten'")),
    ({"extra": b"; " + b"x" * 17 * 2**20}, ("17 MiB",)),
]  # fmt: skip


@pytest.mark.parametrize(("changed", "parts"), ENVI_FAULTS)
def test_a_fault_of_an_envi_header_is_said_in_one_sentence(tmp_path, changed, parts):
    path = write_envi(tmp_path, **changed)
    with refused_input() as caught:
        read_cube(path)
    for part in (str(tmp_path), *parts):
        assert part in str(caught.value)


ENVI_WAVELENGTHS = [
    ({"drop": ("wavelength",)}, {}),
    ({"wavelength": "{}"}, {}),
    ({"drop": ("wavelength",), "band_names": "{400 nm, red, 500 nm, 600 nm, 700 nm}"}, {}),
    ({"wavelength": "{400, 450, 500}"}, {"value": 3}),
    ({"wavelength": "{400, 450, 450, 600, 700}"}, {"where": "band 2 (from 0)", "value": 450}),
    ({"wavelength": "{400, 500, 450, 600, 700}"}, {"where": "band 2 (from 0)", "value": 450}),
    ({"wavelength": "{700, 600, 650, 450, 400}"}, {"where": "band 2 (from 0)", "value": 650}),
    ({"wavelength": "{.4, .45, .5, .6, .7}"}, {"where": "band 0 (from 0)", "value": 0.4}),
    ({"wavelength": "{1e308, 2, 3, 4, 5}", "wavelength_units": "um"}, {"value": np.inf}),
]


@pytest.mark.parametrize(("changed", "fields"), ENVI_WAVELENGTHS)
def test_wavelengths_that_a_header_lacks_or_confuses_are_resolved_by_the_caller(
    tmp_path, changed, fields
):
    path = write_envi(tmp_path, **changed)
    with refused_input(subject=str(path), setting="wavelengths", **fields):
        read_cube(path)
    assert read_cube(path, wavelengths=(400, 800)).wavelength_nm[1] == 500


def test_a_cube_of_one_band_is_refused(tmp_path):
    with refused_input(subject="mine", value=1):
        Cube(wavelength_nm=np.array([550.0]), stored=np.ones((3, 4, 1)), source="mine")
    path = write_envi(tmp_path, numbers(bands=1), wavelength="{500}")
    with refused_input(subject=str(path), value=1):
        read_cube(path)


def test_a_hostile_band_name_does_not_stop_the_reader(tmp_path):
    path = write_envi(tmp_path, drop=("wavelength",), band_names="{" + "9" * 100_000 + "}")
    start = time.perf_counter()
    with refused_input(subject=str(path), setting="wavelengths"):
        read_cube(path)
    assert time.perf_counter() - start < 5  # seconds; a careless pattern takes minutes


def test_an_array_name_that_is_no_text_is_told_on_one_line(tmp_path):
    path = write_npz(tmp_path / "a.npz", **{"a\nb": np.ones((2, 2, 2))})
    with refused_input(setting="key", found="holds a?b 2x2x2 float64"):
        read_cube(path)


def test_a_header_without_data_or_of_other_text_is_refused(tmp_path):
    path = write_envi(tmp_path)
    path.with_suffix(".img").unlink()
    with refused_input(subject=str(path)):
        read_cube(path)
    path.write_text("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n")
    path.with_suffix(".img").write_bytes(b"a")
    with refused_input(subject=str(path), value="#?RADIANCE"):
        read_cube(path)


def test_a_header_beside_two_data_files_is_refused_and_naming_the_data_is_the_cure(tmp_path):
    path = write_envi(tmp_path)
    (tmp_path / "cube.raw").write_bytes(b"other")
    with refused_input() as caught:
        read_cube(path)
    assert "cube.img, cube.raw" in str(caught.value)
    assert_holds(read_cube(tmp_path / "cube.img"), numbers())


def test_an_option_that_does_not_fit_an_envi_file_is_not_passed_over(tmp_path):
    path = write_envi(tmp_path)
    with refused_input(subject="shape", value=(4, 3), remedy=("omit it",)):
        read_cube(path, shape=(4, 3))
    cube = read_cube(path, shape=(3, 4), key="V")
    assert any("key 'V' not used" in note for note in cube.notes)


# files that are no cube


def test_what_is_no_file_is_refused(tmp_path):
    with refused_input(subject=str(tmp_path / "nowhere.hdr"), requirement="No such file"):
        read_cube(tmp_path / "nowhere.hdr")
    with refused_input(subject=str(tmp_path)):
        read_cube(tmp_path)
    with refused_input(subject="a\0b.mat"):
        read_cube("a\0b.mat")
    with refused_input(subject="/dev/null", value="a device"):
        read_cube("/dev/null")


@pytest.mark.parametrize("name", ["cube.hdr", "cube.mat", "cube.npz", "cube.npy"])
def test_a_file_that_may_not_be_opened_is_refused(tmp_path, monkeypatch, name):
    def locked(*_args, **_options):
        raise PermissionError(13, "Permission denied")

    (tmp_path / name).write_bytes(b"x")
    monkeypatch.setattr(Path, "open", locked)
    with refused_input(subject=str(tmp_path / name), requirement="Permission denied"):
        read_cube(tmp_path / name)


@pytest.mark.parametrize("name", ["a.hdr", "a.mat", "a.npz", "a.npy", "a.img", "a.xyz"])
def test_an_empty_file_is_refused(tmp_path, name):
    (tmp_path / name).write_bytes(b"")
    with refused_input(subject=str(tmp_path / name), value=0):
        read_cube(tmp_path / name)


def test_an_ending_that_is_not_read_is_refused_and_the_others_are_named(tmp_path):
    (tmp_path / "a.gif").write_bytes(b"GIF89a")
    with refused_input(value=".gif", requirement=r"ENVI .* \.mat, \.npz"):
        read_cube(tmp_path / "a.gif")


@pytest.mark.parametrize("name", ["a.img", "a"])
def test_envi_data_without_a_header_is_refused(tmp_path, name):
    (tmp_path / name).write_bytes(b"\0" * 8)
    with refused_input(subject=str(tmp_path / name), requirement=r"a\.hdr"):
        read_cube(tmp_path / name)


# MATLAB and NumPy


def write_mat(path, compressed=True, **arrays):
    scipy.io.savemat(path, arrays, do_compression=compressed)
    return path


def write_npz(path, compressed=True, **arrays):
    (np.savez_compressed if compressed else np.savez)(path, **arrays)
    return path


WRITERS = [(write_mat, "cube.mat"), (write_npz, "cube.npz")]
both = pytest.mark.parametrize(("write", "name"), WRITERS)


@both
@pytest.mark.parametrize("compressed", [True, False])
@pytest.mark.parametrize("dtype", ["f8", "f4"])
def test_named_arrays_give_back_what_was_written(tmp_path, write, name, compressed, dtype):
    reflectance = (numbers() / 128).astype(dtype)
    path = write(tmp_path / name, compressed, wavelength_nm=np.array(NM), reflectance=reflectance)
    cube = read_cube(path)
    assert_holds(cube, reflectance)
    assert cube.stored.dtype == dtype
    assert cube.wavelength_nm.tolist() == list(NM)
    assert (cube.scale, cube.notes) == (1.0, ())


@both
def test_key_names_another_array(tmp_path, write, name):
    path = write(tmp_path / name, V=numbers() / 128, wavelength_nm=np.array([NM]).T)
    assert_holds(read_cube(path, key="V"), numbers() / 128)


@both
def test_falling_wavelengths_turn_named_arrays_about(tmp_path, write, name):
    path = write(tmp_path / name, wavelength_nm=np.array(NM)[::-1], reflectance=numbers() / 128)
    assert_holds(read_cube(path), numbers()[:, :, ::-1] / 128)


@both
def test_named_integers_need_a_scale(tmp_path, write, name):
    path = write(tmp_path / name, wavelength_nm=np.array(NM), reflectance=numbers().astype("u2"))
    with refused_input(subject=str(path), value="uint16", setting="scale"):
        read_cube(path)
    assert read_cube(path, scale=1e-4).scale == 1e-4


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(("code", "packed"), [(2, "u1"), (3, "i2"), (9, "f8")])
def test_whole_numbers_that_matlab_packs_small_are_still_real_numbers(
    tmp_path, order, code, packed
):
    body = numbers().transpose(2, 1, 0).astype(order + packed).tobytes()  # rows run fastest
    name = struct.pack(order + "II", 1, 11) + b"reflectance" + bytes(5)
    dims = struct.pack(order + "II3i4x", 5, 12, *numbers().shape)
    flags = struct.pack(order + "IIII", 6, 8, 6, 0)  # class double
    data = struct.pack(order + "II", code, len(body)) + body + bytes(-len(body) % 8)
    matrix = flags + dims + name + data
    version = struct.pack(order + "HH", 0x100, 0x4D49)  # the letters MI, in this byte order
    matrix = struct.pack(order + "II", 14, len(matrix)) + matrix
    (tmp_path / "a.mat").write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + version + matrix)
    cube = read_cube(tmp_path / "a.mat", wavelengths=(400, 800))
    assert_holds(cube, numbers())
    assert cube.stored.dtype == np.float64


@pytest.mark.parametrize("dtype", ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"])
@pytest.mark.parametrize("compressed", [True, False])
@pytest.mark.parametrize("shape", [(1, 2, 2), (3, 4, 5)])
def test_matlab_arrays_are_what_scipy_wrote(tmp_path, dtype, compressed, shape):
    expected = np.arange(np.prod(shape), dtype=dtype).reshape(shape)
    cell = np.array([1, "c"], dtype=object)
    path = write_mat(tmp_path / "a.mat", compressed, before={"a": 1}, V=expected, after=cell)
    cube = read_cube(path, key="V", wavelengths=(400, 800), scale=1)
    assert_holds(cube, expected)
    assert cube.stored.dtype == dtype


DATA_TYPE_AT = 128 + 8 + 16 + 24 + 8  # after the file's start, and tag, flags, dimensions, name


@pytest.mark.parametrize("code", [0, 8, 10, 14, 19, 20, 255, 65535])
def test_a_data_type_that_matlab_has_not_does_not_end_the_process(tmp_path, code):
    path = write_mat(tmp_path / "a.mat", compressed=False, V=np.ones((2, 2, 3)))
    content = bytearray(path.read_bytes())
    assert struct.unpack_from("<II", content, DATA_TYPE_AT) == (9, 96)
    struct.pack_into("<I", content, DATA_TYPE_AT, code)
    path.write_bytes(content)
    with pytest.raises(InputError, match="array 'V' cannot be read"):
        read_cube(path, key="V", wavelengths=(400, 800))


def test_a_matlab_shape_that_does_not_fit_the_numbers_is_refused(tmp_path):
    path = write_mat(tmp_path / "a.mat", compressed=False, V=np.ones((2, 2, 3)))
    for rows in (1, 3, -2, 2**31 - 1):
        content = bytearray(path.read_bytes())
        struct.pack_into("<i", content, 128 + 8 + 16 + 8, rows)
        path.write_bytes(content)
        with refused_input() as caught:
            read_cube(path, key="V", wavelengths=(400, 800))
        assert "'V'" in str(caught.value)


def test_a_compressed_matlab_array_without_its_checksum_is_refused(tmp_path):
    path = write_mat(tmp_path / "a.mat", V=np.ones((2, 2, 3)))
    content = bytearray(path.read_bytes()[:-4])
    struct.pack_into("<I", content, 128 + 4, len(content) - 128 - 8)
    path.write_bytes(content)
    with pytest.raises(InputError, match="does not end where it should"):
        read_cube(path, key="V", wavelengths=(400, 800))


def test_a_matlab_array_that_stands_twice_is_refused(tmp_path):
    path = write_mat(tmp_path / "a.mat", V=np.ones((2, 2, 3)))
    path.write_bytes(path.read_bytes() + path.read_bytes()[128:])
    with pytest.raises(InputError, match="'V' appears twice"):
        read_cube(path, key="V", wavelengths=(400, 800))


def test_a_matlab_array_that_reaches_beyond_the_file_is_refused(tmp_path):
    path = write_mat(tmp_path / "a.mat", compressed=False, V=np.ones((2, 2, 3)), x=1.0)
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(InputError, match="byte 288 begins no array within the file's 344 bytes"):
        read_cube(path, key="V", wavelengths=(400, 800))


def test_a_flipped_bit_in_a_compressed_matlab_array_never_changes_the_picture(tmp_path):
    path = write_mat(tmp_path / "a.mat", V=numbers() / 128)
    content = path.read_bytes()
    noticed = 0
    for byte in range(len(content) - 200, len(content)):
        flipped = bytearray(content)
        flipped[byte] ^= 4
        path.write_bytes(flipped)
        try:
            cube = read_cube(path, key="V", wavelengths=(400, 800))
        except InputError:
            noticed += 1
        else:
            assert_holds(cube, numbers() / 128)  # some bits only fill up the last byte
    assert noticed > 190


@pytest.mark.parametrize("bands_first", [True, False])
def test_pixels_run_down_the_columns_in_matlab_and_along_the_rows_in_numpy(tmp_path, bands_first):
    expected = numbers() / 128
    for write, name, pixels, order in (
        (write_mat, "a.mat", expected.swapaxes(0, 1), "column by column"),
        (write_npz, "a.npz", expected, "row by row"),
    ):
        spectra = pixels.reshape(12, -1)
        path = write(tmp_path / name, V=spectra.T if bands_first else spectra)
        cube = read_cube(path, key="V", shape=(3, 4), wavelengths=(400, 800))
        assert_holds(cube, expected)
        assert any(order in note for note in cube.notes)


@pytest.mark.parametrize("order", ["C", "F"])
def test_npy_stays_on_disk(tmp_path, order):
    np.save(tmp_path / "a.npy", np.array(numbers() / 128, order=order))
    cube = read_cube(tmp_path / "a.npy", wavelengths=(400, 800), key="x")
    assert isinstance(cube.stored, np.memmap)
    assert_holds(cube, numbers() / 128)
    assert any("key 'x' not used" in note for note in cube.notes)


V = "array 'V'"
NAMED_FAULTS = [
    ({"V": np.ones((2, 2, 3))}, {}, {"setting": "key", "found": "holds V 2x2x3 float64"}),
    ({"V": np.ones((2, 2, 3))}, {"key": "W"}, {"setting": "key", "value": ("V",)}),
    ({"V": np.ones((2, 2, 3))}, {"key": "V"}, {"setting": "wavelengths"}),
    ({"V": np.ones((6, 3))}, {"key": "V"}, {"setting": "shape", "value": (6, 3), "where": V}),
    ({"V": np.ones((6, 3))}, {"key": "V", "shape": (2, 4)}, {"subject": "shape", "value": (2, 4)}),
    ({"V": np.ones((6, 3))}, {"key": "V", "shape": (-2, -3)},
     {"subject": "shape", "value": (-2, -3)}),
    ({"V": np.ones((6, 6))}, {"key": "V", "shape": (2, 3)}, {"where": V, "value": (6, 6)}),
    ({"V": np.ones((2, 2, 3))}, {"key": "V", "shape": (1, 4)},
     {"subject": "shape", "value": (1, 4)}),
    ({"V": np.ones((2, 2, 2, 3))}, {"key": "V"}, {"where": V, "value": (2, 2, 2, 3)}),
    ({"V": np.ones((2, 2, 3)) * 1j}, {"key": "V"}, {"where": V, "value": "complex128"}),
    ({"V": np.ones((2, 2, 3)) > 0}, {"key": "V"}, {"where": V, "value": "bool"}),
    ({"V": np.ones((2, 2, 0))}, {"key": "V"}, {"where": V, "value": (2, 2, 0)}),
    ({"reflectance": np.ones((2, 2, 3)), "wavelength_nm": np.arange(400.0, 404)}, {},
     {"setting": "wavelengths", "value": 4}),
    ({"reflectance": np.ones((2, 2, 2)), "wavelength_nm": np.array([0.4, 0.5])}, {},
     {"setting": "wavelengths", "value": 0.4}),
    ({"reflectance": np.ones((2, 2, 2)), "wavelength_nm": np.array([400, np.nan])}, {},
     {"setting": "wavelengths", "where": "band 1 (from 0)"}),
    ({"reflectance": np.ones((2, 2, 2)), "wavelength_nm": np.array([400, 400])}, {},
     {"setting": "wavelengths", "where": "band 1 (from 0)", "value": 400}),
    ({"reflectance": np.ones((2, 2, 2)), "wavelength_nm": np.array([400, 500j])}, {},
     {"where": "array 'wavelength_nm'", "value": "complex128"}),
    ({"reflectance": np.ones((2, 2, 2)), "wavelength_nm": np.array(["a", "b"])}, {},
     {"where": "array 'wavelength_nm'"}),
]  # fmt: skip


@both
@pytest.mark.parametrize(("arrays", "options", "fields"), NAMED_FAULTS)
def test_a_fault_of_named_arrays_is_said_in_one_sentence(
    tmp_path, write, name, arrays, options, fields
):
    path = write(tmp_path / name, **arrays)
    with refused_input(**fields) as caught:
        read_cube(path, **options)
    assert name in str(caught.value)


@both
def test_radiance_is_known_by_the_file_name_too(tmp_path, write, name):
    path = write(tmp_path / f"radiance_{name}", V=np.ones((2, 2, 3)))
    with refused_input(subject=str(path), setting="scale", requirement="reflectance"):
        read_cube(path, key="V")


class Bomb:
    """Unpickling this is seen."""

    def __reduce__(self):
        return (pytest.fail, ("something was unpickled",))


def test_objects_are_never_unpickled(tmp_path):
    bombs = np.array([Bomb()] * 8, dtype=object).reshape(2, 2, 2)
    np.savez(tmp_path / "a.npz", reflectance=bombs, wavelength_nm=np.array([400, 500]))
    np.save(tmp_path / "a.npy", bombs)
    for name in ("a.npz", "a.npy"):
        with refused_input(subject=str(tmp_path / name), value="object"):
            read_cube(tmp_path / name)


@pytest.mark.parametrize(
    "thing", [{"field": 1.0}, np.array([1.0, "a"], dtype=object), scipy.sparse.eye_array(3), "word"]
)
def test_matlab_cells_structs_words_and_sparse_arrays_are_refused(tmp_path, thing):
    path = write_mat(tmp_path / "a.mat", V=thing)
    with refused_input(subject=str(path), where=V, setting="key"):
        read_cube(path, key="V")


def test_structured_numpy_arrays_are_refused(tmp_path):
    for names in ("ab", "a\u03bb"):
        with warnings.catch_warnings(action="ignore"):  # of NumPy's format 3.0
            np.savez(tmp_path / "a.npz", V=np.zeros((2, 2, 2), dtype=[(n, "f4") for n in names]))
        with refused_input(subject=str(tmp_path / "a.npz"), where=V, setting="key"):
            read_cube(tmp_path / "a.npz", key="V")


def test_a_matlab_4_array_is_the_same_cube_as_that_of_matlab_5(tmp_path):
    pixels = np.arange(12.0).reshape(4, 3) / 12
    cubes = []
    for version in ("4", "5"):
        scipy.io.savemat(tmp_path / f"{version}.mat", {"V": pixels}, format=version)
        path = tmp_path / f"{version}.mat"
        cubes.append(read_cube(path, key="V", shape=(2, 2), wavelengths=(400, 800)))
    first, second = (row_source(cube.stored).rows(0, 2) for cube in cubes)
    assert first.tolist() == second.tolist()
    assert sorted(first.ravel()) == sorted(pixels.ravel())


@pytest.mark.parametrize("cut", [1, 60])
def test_a_npy_that_is_cut_or_lengthened_is_refused(tmp_path, cut):
    whole = io.BytesIO()
    np.save(whole, np.ones((2, 2, 3)))
    for content in (whole.getvalue()[:-cut], whole.getvalue() + bytes(cut)):
        (tmp_path / "a.npy").write_bytes(content)
        with refused_input(value=len(content), requirement=r"\b224 bytes"):
            read_cube(tmp_path / "a.npy", wavelengths=(400, 800))


def test_a_small_npz_that_claims_a_huge_array_is_refused_before_it_is_read(tmp_path):
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (100000, 100000, 1000)}"
    content = b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) + header.ljust(117) + b"\n"
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("reflectance.npy", content)
    with refused_input(where="array 'reflectance'", value=128):
        read_cube(tmp_path / "a.npz")


def test_an_array_larger_than_the_memory_is_refused_before_it_is_read(tmp_path, monkeypatch):
    paths = [write(tmp_path / name, reflectance=np.ones((8, 8, 8))) for write, name in WRITERS]
    monkeypatch.setattr("os.sysconf", lambda _: 10)  # pages, and bytes per page
    for path in paths:
        with refused_input(where="array 'reflectance'", value=4096, requirement="100 bytes"):
            read_cube(path)


def test_memory_that_runs_out_is_said(tmp_path, monkeypatch):
    def starved(*_args, **_options):
        raise MemoryError

    path = write_npz(tmp_path / "a.npz", reflectance=np.ones((2, 2, 2)))
    monkeypatch.setattr(np.lib.format, "read_array", starved)
    with refused_input(subject=str(path), requirement="memory"):
        read_cube(path)


# files from the field


def real(name):
    if not (REAL / name).is_file():
        pytest.skip(f"{REAL / name} is absent (not shipped: local checks only)")
    return REAL / name


def test_samson_is_a_matlab_matrix_of_95_by_95_pixels():
    path = real("samson_dataset.mat")
    with refused_input(setting="key") as caught:
        read_cube(path)
    assert {"A", "Y"} <= set(caught.value.value)
    cube = read_cube(path, key="Y", shape=(95, 95), wavelengths=(401, 889))
    assert cube.stored.shape == (95, 95, 156)
    matrix = scipy.io.loadmat(path)["Y"]
    np.testing.assert_array_equal(cube.stored[7, 20], matrix[:, 20 * 95 + 7])


@pytest.mark.parametrize(
    ("name", "shape", "ends"),
    [
        ("ang20160910t185702_2rdn_img", (25, 30, 425), [376.44, 2500.12]),
        ("ang20170323t202244_rdn_7000-7010", (10, 10, 425), [376.86, 2500.54]),
    ],
)
def test_aviris_radiance_is_refused_and_read_with_a_scale(name, shape, ends):
    for path in (real(name), real(f"{name}.hdr")):
        with refused_input(subject=str(path), setting="scale"):
            read_cube(path)
        cube = read_cube(path, scale=0.05)
        assert cube.stored.shape == shape
        assert cube.wavelength_nm[[0, -1]].tolist() == ends


def test_the_wheat_needs_wavelengths():
    for path in (real("wheat_grain.hdr"), real("wheat_grain.img")):
        with refused_input(setting="wavelengths"):
            read_cube(path)
        cube = read_cube(path, wavelengths=(400, 902.2))
        assert (cube.stored.shape, cube.stored.dtype) == ((200, 200, 10), np.float64)
        assert 0 <= cube.stored.min() < cube.stored.max() <= 1


def test_the_corn_needs_a_scale_and_says_what_its_header_lacks():
    for path in (real("corn-kernel-hyperspectral.hdr"), real("corn-kernel-hyperspectral.raw")):
        with refused_input(value="uint16", setting="scale"):
            read_cube(path)
        cube = read_cube(path, scale=1e-4)
        assert (cube.stored.shape, cube.stored.dtype) == ((31, 43, 580), np.uint16)
        assert sum("lacks" in note for note in cube.notes) == 2
