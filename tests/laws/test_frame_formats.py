"""Raw frames of every format: the codes that were written, and what the header tells."""

import hashlib
import io
import pickle
import re

import numpy as np
import pytest
import tifffile
from PIL import Image

from chromanoise.base.errors import InputError
from chromanoise.io.frames import frames_in
from chromanoise.sensor import Mosaic, bayer
from frame_files import (
    WRITERS,
    drawn,
    write_cropped_dng,
    write_fits,
    write_npy,
    write_packed_npz,
    write_pgm,
    write_raw,
    write_tiff,
)
from outcomes import refused_input

pytest.importorskip("astropy", reason="FITS needs chromanoise[fits]")
pytest.importorskip("rawpy", reason="DNG needs chromanoise[raw]")

GRBG = Mosaic((("G", "R"), ("B", "G")))
PLANE_OF_STACK = drawn(5, 8, 4096)


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_gives_the_codes_that_another_library_wrote(tmp_path, name):
    file, write = WRITERS[name]
    write(tmp_path / file, drawn())
    before = hashlib.sha256((tmp_path / file).read_bytes()).digest()
    (frame,) = frames_in(tmp_path / file)
    codes = frame.codes()
    assert frame.shape == codes.shape == (24, 30)
    assert codes.dtype == np.uint16
    assert codes.dtype.isnative
    assert (codes == drawn()).all()
    assert (pickle.loads(pickle.dumps(frame)).codes() == codes).all()  # for worker processes
    assert hashlib.sha256((tmp_path / file).read_bytes()).digest() == before


STACKS = {
    "a.npy": (np.save, "a.npy[2]"),
    "a.npz": (write_packed_npz, "a.npz[flat][2]"),
    "a.tif": (write_tiff, "a.tif[2]"),
    "a.fits": (write_fits, "a.fits[2]"),
}


@pytest.mark.parametrize("name", STACKS)
def test_a_stack_gives_its_frames_in_order(tmp_path, name):
    stack = np.stack([drawn(24, 30, seed=i) for i in range(5)])
    write, third = STACKS[name]
    write(tmp_path / name, stack)
    frames = frames_in(tmp_path / name)
    assert len(frames) == 5
    assert frames[2].name == third
    for i in (3, 0, 4, 2, 1):
        assert (frames[i].codes() == stack[i]).all()


@pytest.mark.parametrize("kind", ["u1", "<u2", ">u2", "i2", "i4", "u4", "i8", "f4", "f8"])
def test_codes_of_every_type_of_number_are_integers_of_the_same_value(tmp_path, kind):
    codes = drawn(4, 7, 255).astype(kind)
    write_npy(tmp_path / "a.npy", np.asfortranarray(codes))
    (frame,) = frames_in(tmp_path / "a.npy")
    assert frame.codes().dtype.kind in "ui"
    assert (frame.codes() == codes).all()


def test_whole_floats_beyond_16_bits_are_32_bit_integers(tmp_path):
    write_npy(tmp_path / "a.npy", np.array([[-3.0, 70000.0]]))
    (frame,) = frames_in(tmp_path / "a.npy")
    assert frame.codes().dtype == np.int32
    assert frame.codes().tolist() == [[-3, 70000]]


@pytest.mark.parametrize("value", [12.5, np.nan, np.inf, 1e12])
def test_floats_that_are_not_whole_codes_are_refused_as_processed(tmp_path, value):
    codes = drawn().astype(float)
    codes[7, 9] = value
    write_npy(tmp_path / "a.npy", codes)
    (frame,) = frames_in(tmp_path / "a.npy")
    with refused_input(requirement="processed frames are not raw") as caught:
        frame.codes()
    assert "row 7, column 9" in caught.value.found


# what headers tell


def test_a_dng_tells_its_mosaic_levels_and_camera(tmp_path):
    write_raw(tmp_path / "a.dng", drawn(), GRBG)
    (frame,) = frames_in(tmp_path / "a.dng")
    assert frame.mosaic == GRBG
    assert (frame.black_level_dn, frame.white_level_dn) == (64.0, 4000.0)
    assert frame.camera == "chromanoise toy"


def test_libraw_tells_the_same_of_a_dng_as_its_tags(tmp_path):
    from chromanoise.io.frames.camera_raw import _Raw

    for mosaic, write in ((bayer(), write_raw), (GRBG, write_raw), (bayer(), write_cropped_dng)):
        write(tmp_path / "a.dng", drawn(), *((mosaic,) if write is write_raw else ()))
        (frame,) = frames_in(tmp_path / "a.dng")
        libraw = _Raw(path=frame.path, shape=frame.shape, pixels=24 * 30)
        result = libraw.header()
        assert result["mosaic"] == frame.mosaic == mosaic
        assert result["black_level_dn"] == frame.black_level_dn == 64.0
        assert result["white_level_dn"] == frame.white_level_dn == 4000.0
        assert (libraw() == frame.codes()).all()


def test_exif_time_iso_camera_and_mosaic_of_a_tiff_are_read(tmp_path):
    tags = [
        (271, 2, 0, "Canon", True),
        (272, 2, 0, "Canon EOS 5D", True),
        (33434, 5, 1, (1, 125), True),  # ExposureTime
        (34855, 3, 1, 800, True),  # PhotographicSensitivity
        (33421, 3, 2, (2, 2), True),
        (33422, 1, 4, bytes([1, 0, 2, 1]), True),
    ]
    codes = drawn()
    tifffile.imwrite(tmp_path / "a.tif", codes, photometric="cfa", extratags=tags, metadata=None)
    (frame,) = frames_in(tmp_path / "a.tif")
    assert frame.time_ms == pytest.approx(8.0)
    assert frame.iso == 800
    assert frame.camera == "Canon EOS 5D"
    assert frame.mosaic == GRBG


def test_exif_in_a_tiff_of_pillow_is_read(tmp_path):
    exif = Image.Exif()
    exif[271], exif[272] = "Raspberry", "HQ"
    exif.get_ifd(34665).update({33434: 0.25, 34855: 100})
    exif[34665] = 0  # so that Pillow writes it
    Image.fromarray(drawn()).save(tmp_path / "a.tif", exif=exif)
    (frame,) = frames_in(tmp_path / "a.tif")
    assert (frame.time_ms, frame.iso, frame.camera) == (250.0, 100.0, "Raspberry HQ")


def test_keys_of_fits_are_read(tmp_path):
    keys = {"EXPTIME": 0.5, "GAIN": 120, "INSTRUME": "ASI533", "BAYERPAT": "RGGB", "XBAYROFF": 1}
    write_fits(tmp_path / "a.fits", drawn(), **keys)
    (frame,) = frames_in(tmp_path / "a.fits")
    assert (frame.time_ms, frame.gain_setting, frame.camera) == (500.0, 120.0, "ASI533")
    assert frame.mosaic == GRBG


@pytest.mark.parametrize(("rows", "first"), [(24, ("G", "B")), (25, ("R", "G"))])
def test_the_mosaic_of_rows_from_the_bottom_ends_with_its_first_row(tmp_path, rows, first):
    keys = {"BAYERPAT": "RGGB", "ROWORDER": "BOTTOM-UP"}
    write_fits(tmp_path / "a.fits", drawn(rows), **keys)
    assert frames_in(tmp_path / "a.fits")[0].mosaic.pattern[0] == first


@pytest.mark.parametrize("kind", ["u1", "u2", "u4", "i2", "i4", "i8"])
def test_fits_of_every_integer_are_read(tmp_path, kind):
    limits = np.iinfo(kind)
    codes = np.array([[limits.min, limits.max], [0, 1]], kind)
    write_fits(tmp_path / "a.fits", codes)
    assert frames_in(tmp_path / "a.fits")[0].codes().tolist() == codes.tolist()


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_scaled_fits_are_bzero_plus_bscale_times_the_number(tmp_path, scale):
    from astropy.io import fits

    part = fits.PrimaryHDU((2 * drawn()).astype("i4"))
    part.header["BZERO"], part.header["BSCALE"] = 100.0, scale
    part.writeto(tmp_path / "a.fits")
    (frame,) = frames_in(tmp_path / "a.fits")
    assert (frame.codes() == 100 + np.int64(2 * scale) * drawn()).all()


def test_pixels_that_fits_marks_as_blank_are_refused(tmp_path):
    from astropy.io import fits

    part = fits.PrimaryHDU(drawn().astype("i2"))
    part.header["BLANK"] = 0
    part.writeto(tmp_path / "a.fits")
    with refused_input(value=0, requirement="a code in each pixel"):
        frames_in(tmp_path / "a.fits")[0].codes()


def test_the_largest_code_of_a_pgm_is_its_white_level_and_no_code_is_above(tmp_path):
    head = b"P5\n# made by hand\n2 1\n1023\n"
    (tmp_path / "a.pgm").write_bytes(head + b"\x03\xff\x00\x01")
    (frame,) = frames_in(tmp_path / "a.pgm")
    assert frame.codes().tolist() == [[1023, 1]]  # most significant byte first, pgm(5)
    assert (frame.bits, frame.white_level_dn) == (10, 1023.0)
    (tmp_path / "a.pgm").write_bytes(head + b"\x04\x00\x00\x01")
    with refused_input(value=1024):
        frames_in(tmp_path / "a.pgm")[0].codes()


def test_8_bit_frames_are_read(tmp_path):
    codes = drawn(24, 30, 256).astype(np.uint8)
    for name, write in (("a.pgm", write_pgm), ("a.png", write_pgm), ("a.tif", write_tiff)):
        write(tmp_path / name, codes)
        (frame,) = frames_in(tmp_path / name)
        assert frame.codes().dtype == np.uint8
        assert (frame.codes() == codes).all()


# refusals


def all_codes(path):
    return [(frame, frame.codes()) for frame in frames_in(path)]


def color_picture(form, **options):
    file = io.BytesIO()
    Image.fromarray(np.zeros((24, 30, 3), np.uint8)).save(file, form, **options)
    return file.getvalue()


def saved(array, save=np.save):
    file = io.BytesIO()
    save(file, array)
    return file.getvalue()


HEAD = b"\x93NUMPY\x01\x00"
REFUSED = {
    "a.jpg": (color_picture("JPEG"), "one channel"),
    "a.png": (color_picture("PNG"), "one channel"),
    "a.tif": (color_picture("TIFF"), "one channel"),
    "b.tif": (color_picture("TIFF", compression="jpeg"), "one channel"),
    "a.ppm": (color_picture("PPM"), "one channel"),
    "a.pgm": (color_picture("PPM"), "one channel"),
    "a.npy": (saved(np.zeros((24, 30, 3), np.uint8)), "one channel"),
    "b.npy": (saved(np.zeros(30, np.uint8)), "rows and columns"),
    "c.npy": (saved(np.zeros((2, 2, 2, 2), np.uint8)), "rows and columns"),
    "d.npy": (saved(np.zeros((0, 30), np.uint8)), "empty"),
    "e.npy": (saved(np.zeros((4, 4), complex)), "real numbers"),
    "a.npz": (saved(np.array([{}]), np.savez), "rows and columns"),
    "b.npz": (saved(np.array([[{}]]), np.savez), "real numbers|rows and columns"),
    "a.csv": (b"1,2", "must be a raw frame"),
    "noending": (b"1,2", "must be a raw frame"),
    "c.tif": (b"\x89PNG\r\n\x1a\n", "must be in TIFF format"),
    "a.dng": (b"", "not a readable camera raw"),
    "b.dng": (b"II*\0" + b"\0" * 100, "not a readable"),
    "a.fits": (b"SIMPLE  = ", "not a readable FITS"),
    "b.fits": (b"", "not a readable FITS"),
    "b.pgm": (b"P5 20000 20000 65535\n", "bytes after its header"),
    "c.pgm": (b"P2 2 2 255\n1 2 3 x ", "codes of at most"),
    "d.pgm": (b"P5 99999 99999 255\n", "400 million"),
    "e.pgm": (b"P2 2 2 255\n1 2 3  ", "4 codes"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_raw_frame_is_refused_in_one_sentence(tmp_path, name):
    content, requirement = REFUSED[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        all_codes(tmp_path / name)
    assert re.search(requirement, caught.value.requirement)
    assert caught.value.subject == str(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_a_stack_whose_description_tells_more_frames_than_pages_is_refused(tmp_path):
    stack = np.stack([drawn()] * 4)
    for options in ({"truncate": True}, {"imagej": True, "truncate": True}):
        tifffile.imwrite(tmp_path / "a.tif", stack, photometric="minisblack", **options)
        with refused_input(value=1, requirement="one page per frame"):
            frames_in(tmp_path / "a.tif")


def test_a_file_that_shrinks_after_its_header_was_read_is_refused(tmp_path):
    for name in ("a.npy", "a.tif", "a.fits", "a.pgm"):
        WRITERS[{"a.npy": "npy", "a.tif": "tiff", "a.fits": "fits", "a.pgm": "pgm"}[name]][1](
            tmp_path / name, drawn()
        )
        (frame,) = frames_in(tmp_path / name)
        content = (tmp_path / name).read_bytes()
        (tmp_path / name).write_bytes(content[:-100])
        with refused_input(value=len(content) - 100, requirement="as when its header was read"):
            frame.codes()


def test_the_sides_that_a_header_declares_do_not_allocate_memory(tmp_path):
    """A few hundred bytes that declare 10^8 pixels and more."""
    head = "{'descr': '<u2', 'fortran_order': False, 'shape': (20000, 20000), }"
    (tmp_path / "a.npy").write_bytes(HEAD + bytes([118, 0]) + head.ljust(117).encode() + b"\n")
    with refused_input(requirement="bytes that its header describes"):
        frames_in(tmp_path / "a.npy")
    write_raw(tmp_path / "a.dng", drawn())
    content = (tmp_path / "a.dng").read_bytes()
    with tifffile.TiffFile(tmp_path / "a.dng") as file:
        places = [file.pages[0].tags[tag].valueoffset for tag in (256, 257)]
    for at in places:
        content = content[:at] + (20000).to_bytes(2, "little") + content[at + 2 :]
    (tmp_path / "a.dng").write_bytes(content)
    with pytest.raises(InputError):
        frames_in(tmp_path / "a.dng")[0].codes()
