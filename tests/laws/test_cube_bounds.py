"""Cubes too large for memory, files of other kinds, and compressions of TIFF."""

import io
import json
import logging
import os
import pickle
import struct
import subprocess
import sys
import zipfile
import zlib

import numpy as np
import pytest

from chromanoise.base.check import reason
from chromanoise.base.errors import InputError
from chromanoise.io.cubes import found_cube as bounds, read_cube
from chromanoise.spectra.scene_rows import row_source
from outcomes import refused_input

h5py = pytest.importorskip("h5py", reason="comes with chromanoise[cubes]")
zarr = pytest.importorskip("zarr", reason="comes with chromanoise[cubes]")
numcodecs = pytest.importorskip("numcodecs", reason="comes with zarr")
Image = pytest.importorskip("PIL.Image")
tifffile = pytest.importorskip("tifffile")
tiff_plugin = pytest.importorskip("PIL.TiffImagePlugin")

EVEN = {"wavelengths": (400, 800)}
CUBE = np.random.default_rng(5).integers(1, 128, size=(3, 4, 5)) / 128
PNG = b"\x89PNG\r\n\x1a\n"


def rows_of(path, **options):
    source = row_source(read_cube(path, **options).stored)
    return source.rows(0, source.shape[0])


def refusal(path, **options):
    """The message with which a cube is refused."""
    with pytest.raises(InputError) as caught:
        rows_of(path, **options)
    text = str(caught.value)
    assert "\n" not in text
    assert path.name in text
    return text


# compressions of TIFF


def by_pillow(path, planes, compression, **tags):
    info = tiff_plugin.ImageFileDirectory_v2()
    for name, value in tags.items():
        info[{"predictor": 317, "orientation": 274, "photometric": 262}[name]] = value
    first, *more = (Image.fromarray(plane) for plane in planes)
    first.save(path, save_all=True, append_images=more, compression=compression, tiffinfo=info)
    return path


@pytest.mark.parametrize("compression", ["tiff_lzw", "packbits", "tiff_adobe_deflate", "zstd"])
@pytest.mark.parametrize("dtype", ["u1", "u2", "f4"])
@pytest.mark.parametrize("predicted", [False, True])
def test_compressed_pages_are_what_was_written(tmp_path, compression, dtype, predicted):
    if predicted and compression == "packbits":
        pytest.skip("PackBits has no predictor")
    planes = (CUBE.transpose(2, 0, 1) * 128).astype(dtype)
    predictor = (3 if dtype == "f4" else 2) if predicted else 1
    path = by_pillow(tmp_path / "a.tif", planes, compression, predictor=predictor)
    rows = rows_of(path, scale=1.0, **EVEN)
    np.testing.assert_array_equal(rows, planes.transpose(1, 2, 0))


def test_jpeg_pages_are_what_pillow_decodes(tmp_path):
    planes = np.full((5, 16, 16), 100, np.uint8)  # JPEG keeps a constant value exactly
    path = by_pillow(tmp_path / "a.tif", planes, "jpeg")
    assert (rows_of(path, scale=1.0, **EVEN) == 100).all()


@pytest.mark.parametrize("tags", [{"orientation": 6}, {"photometric": 0}])
def test_pages_that_pillow_would_change_need_the_package_imagecodecs(tmp_path, monkeypatch, tags):
    monkeypatch.setitem(sys.modules, "imagecodecs", None)
    planes = (CUBE.transpose(2, 0, 1) * 128).astype("u1")
    path = by_pillow(tmp_path / "a.tif", planes, "tiff_lzw", **tags)
    text = refusal(path, scale=1.0, **EVEN)
    assert "LZW" in text
    assert "imagecodecs" in text
    assert "chromanoise[tiff]" in text


def test_a_damaged_page_is_refused_and_nothing_else_is_printed(tmp_path, capfd):
    planes = np.random.default_rng(1).random((2, 64, 64)).astype("f4")
    path = by_pillow(tmp_path / "a.tif", planes, "tiff_lzw")
    content = bytearray(path.read_bytes())
    with tifffile.TiffFile(path) as file:
        at = file.pages[0].dataoffsets[0]
    content[at + 50 : at + 150] = bytes(b ^ 0x5A for b in content[at + 50 : at + 150])
    path.write_bytes(content)
    refusal(path, **EVEN)
    empty = tmp_path / "b.tif"
    empty.write_bytes(content[:4] + struct.pack("<I", len(content) * 2))
    refusal(empty, **EVEN)
    assert capfd.readouterr() == ("", "")
    assert logging.getLogger("tifffile").handlers


def test_places_of_strips_that_are_no_whole_numbers_are_refused(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for plane in CUBE.transpose(2, 0, 1).astype("f4"):
            file.write(plane, photometric="minisblack", metadata=None)
    content = bytearray((tmp_path / "a.tif").read_bytes())
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        tag = file.pages[0].tags["StripOffsets"]
        place = tag.value[0]
    struct.pack_into("<H", content, tag.offset + 2, 11)  # single precision
    struct.pack_into("<f", content, tag.valueoffset, place)
    (tmp_path / "a.tif").write_bytes(content)
    assert "page 0" in refusal(tmp_path / "a.tif", **EVEN)


# files of other kinds


@pytest.mark.parametrize("name", ["a.npz", "a.npy", "a.tif"])
@pytest.mark.parametrize(
    ("content", "kind"),
    [(PNG, "PNG"), (b"\xff\xd8\xff\xe0", "JPEG"), (pickle.dumps([1]), "pickle"),
     (b"%PDF-1.7", "PDF"), (b"\x1f\x8b\x08", "gzip"), (b"7z\xbc\xaf\x27\x1c", "7-Zip")],
)  # fmt: skip
def test_a_file_of_another_kind_is_refused_with_its_kind(tmp_path, name, content, kind):
    (tmp_path / name).write_bytes(content + bytes(200))
    assert kind in refusal(tmp_path / name)


def test_an_array_named_npz_and_an_archive_named_npy_are_refused_with_their_kind(tmp_path):
    np.save(tmp_path / "b.npy", CUBE)
    np.savez(tmp_path / "b.npz", CUBE)
    (tmp_path / "b.npy").rename(tmp_path / "a.npz")
    (tmp_path / "b.npz").rename(tmp_path / "a.npy")
    assert ".npy" in refusal(tmp_path / "a.npz")
    assert "zip" in refusal(tmp_path / "a.npy")


class Bomb:
    def __reduce__(self):
        return (print, ("unpickled",))


def test_pickles_in_an_npz_are_never_loaded(tmp_path, capfd):
    with zipfile.ZipFile(tmp_path / "b.npz", "w") as archive:
        archive.writestr("reflectance.pkl", pickle.dumps(Bomb()))
    assert "no arrays" in refusal(tmp_path / "b.npz")
    assert capfd.readouterr().out == ""


def npy(header):
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) + header.ljust(117) + b"\n"


@pytest.mark.parametrize(
    "shape", [b"(a, 2)", b"(2-x, 2)", b"(print(1), 2)", b"[1, 2]", b"(2.5, 2)"]
)
@pytest.mark.parametrize("name", ["a.npy", "a.npz"])
def test_no_message_contains_words_about_the_parser(file, shape, name):
    content = npy(b"{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + b"}")
    path = file(content, name)
    if name == "a.npz":
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("reflectance.npy", content)
    text = refusal(path)
    assert not any(word in text for word in ("<", "ast", "object", "0x"))


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ValueError("bad\nmagic"), "bad magic"),
        (OSError(13, "Permission denied"), "Permission denied"),
        (ValueError("expected <class 'int'>, got 'str'"), ""),
        (ValueError("malformed node: <ast.BinOp object at 0x7f>"), ""),
        (TypeError("unsupported operand"), ""),
        (KeyError("shape"), ""),
        (struct.error("unpack requires a buffer of 8 bytes"), ""),
        (AttributeError("'NoneType' object has no attribute 'x'"), ""),
    ],
)
def test_messages_about_the_parser_itself_are_omitted(error, said):
    assert reason(error) == said


# declared sizes are checked before memory is allocated


def declares(path, value, names=("ImageWidth", "ImageLength", "RowsPerStrip")):
    """Tags of every page, edited in place."""
    content = bytearray(path.read_bytes())
    with tifffile.TiffFile(path) as file:
        for page in file.pages:
            for name in names:
                tag = page.tags[name]
                form = "<I" if tag.dtype == 4 else "<H"
                struct.pack_into(form, content, tag.valueoffset, value)
    path.write_bytes(content)
    return path


def large_tiff(folder):
    """2 MB of random numbers whose tags declare 3.8 GB."""
    noise = np.random.default_rng(1).random((2, 500, 500)).astype("f4")
    with tifffile.TiffWriter(folder / "a.tif") as file:
        for plane in noise:
            file.write(plane, photometric="minisblack", compression="zlib", metadata=None)
    return declares(folder / "a.tif", 22_000)


def overfull_tiff(folder):
    """A strip of 64 KiB that unpacks to 256 MiB."""
    with tifffile.TiffWriter(folder / "a.tif") as file:
        for _ in range(2):
            file.write(
                iter([zlib.compress(bytes(2**28))]), shape=(256, 256), dtype="u1", rowsperstrip=256,
                photometric="minisblack", compression="zlib", metadata=None,
            )  # fmt: skip
    return folder / "a.tif"


def overfull_npz(folder):
    """bzip2 unpacks 400 bytes to 256 MiB at once."""
    start = io.BytesIO()
    about = {"descr": "|u1", "fortran_order": False, "shape": (1024, 1024, 256)}
    np.lib.format.write_array_header_1_0(start, about)
    with zipfile.ZipFile(folder / "a.npz", "w", zipfile.ZIP_BZIP2) as archive:
        archive.writestr("reflectance.npy", start.getvalue() + bytes(2**28))
    return folder / "a.npz"


def large_zarr(folder):
    """One chunk of 10 kB, and a header that declares 4 GB."""
    made = zarr.create_array(
        folder / "a.zarr", shape=(20, 20_000, 10_000), chunks=(10, 100, 100), dtype="u1",
        zarr_format=2,
    )  # fmt: skip
    made[:10, :100, :100] = 1
    header = folder / "a.zarr" / ".zarray"
    about = json.loads(header.read_text())
    header.write_text(json.dumps(about | {"chunks": [20, 10_000, 10_000]}))
    return folder / "a.zarr"


def test_an_array_of_which_hardly_a_chunk_is_there_is_refused(tmp_path):
    zarr.create_array(tmp_path / "a.zarr", data=CUBE, chunks=(1, 4, 5), zarr_format=2)
    header = tmp_path / "a.zarr" / ".zarray"
    about = json.loads(header.read_text())
    header.write_text(json.dumps(about | {"shape": [3, 65535, 5]}))
    text = refusal(tmp_path / "a.zarr", **EVEN)
    assert "49152" in text  # 3 rows of 16384 chunks of 4 columns
    assert "only 3" in text


def overfull_zarr(folder):
    """A chunk of 160 bytes whose file holds 2 MB."""
    zarr.create_array(folder / "a.zarr", data=np.ones((2, 2, 5)), chunks=(2, 2, 5), zarr_format=2)
    (folder / "a.zarr" / "0.0.0").write_bytes(bytes(2**21))
    return folder / "a.zarr"


def bomb_of_zstd(folder, sized=True):
    """A chunk of 160 bytes whose file of 32 kB unpacks to 1 GiB."""
    zarr.create_array(
        folder / "a.zarr", data=np.ones((2, 2, 5)), chunks=(2, 2, 5), zarr_format=2,
        compressors=numcodecs.Zstd(),
    )  # fmt: skip
    frame = bytes(numcodecs.Zstd().encode(np.zeros(2**30, np.uint8)))
    if not sized:  # a frame may omit its size
        assert frame[4] == 0x80  # 4 bytes of size
        frame = frame[:4] + b"\0" + frame[5:6] + frame[10:]
    (folder / "a.zarr" / "0.0.0").write_bytes(frame)
    return folder / "a.zarr"


def bomb_of_zstd_without_a_size(folder):
    return bomb_of_zstd(folder, sized=False)


def overfull_hdf5(folder):
    """A chunk of 64 bytes that unpacks to 256 MiB, behind a checksum that only libhdf5 knows."""
    with h5py.File(folder / "a.h5", "w") as file:
        options = {"chunks": (2, 4, 2), "compression": "gzip", "fletcher32": True}
        made = file.create_dataset("a", data=np.ones((4, 4, 2), "f4"), **options)
        made.id.write_direct_chunk((2, 0, 0), zlib.compress(bytes(2**28)))
    return folder / "a.h5"


def large_pngs(folder):
    """Two pictures of 100 bytes that declare 900 million pixels."""

    def chunk(kind, content):
        tail = struct.pack(">I", zlib.crc32(kind + content))
        return struct.pack(">I", len(content)) + kind + content + tail

    (folder / "a.png").mkdir()
    start = chunk(b"IHDR", struct.pack(">IIBBBBB", 30_000, 30_000, 8, 0, 0, 0, 0))
    for k in (1, 2):
        content = PNG + start + chunk(b"IDAT", zlib.compress(bytes(99))) + chunk(b"IEND", b"")
        (folder / "a.png" / f"{k}.png").write_bytes(content)
    return folder / "a.png"


BOMBS = [
    large_tiff,
    overfull_tiff,
    overfull_npz,
    large_zarr,
    bomb_of_zstd,
    bomb_of_zstd_without_a_size,
    overfull_zarr,
    overfull_hdf5,
    large_pngs,
]
READS = """
import resource, sys
from chromanoise.base.errors import InputError
from chromanoise.io.cubes import read_cube
from chromanoise.spectra import row_source
import h5py, zarr, tifffile, PIL.Image
import numpy as np
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
for path in sys.argv[1:]:
    try:
        source = row_source(read_cube(path, wavelengths=(400, 800), scale=0.5).stored)
        source.rows(0, source.shape[0])
        print("read")
    except InputError as error:
        print(error)
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def test_more_than_a_file_can_hold_is_refused_before_memory_is_allocated(tmp_path):
    """One process reads all files, so the limit is of all together."""
    paths = []
    for bomb in BOMBS:
        (tmp_path / bomb.__name__).mkdir()
        paths.append(bomb(tmp_path / bomb.__name__))
    command = [sys.executable, "-c", READS, *map(str, paths)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    for path, sentence, kib in zip(paths, lines[::2], lines[1::2], strict=True):
        assert path.name in sentence, path
        assert int(kib) < 100 * 1024, path
    assert done.stderr == ""


def test_the_memory_limit_is_at_most_the_free_memory_of_the_machine():
    whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    assert 2**26 < bounds.memory_bytes() <= whole


def test_a_valid_cube_with_a_high_compression_ratio_is_read(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", reflectance=np.zeros((64, 64, 500), "f4"))
    cube = read_cube(tmp_path / "a.npz", **EVEN)
    assert (tmp_path / "a.npz").stat().st_size * 500 < 64 * 64 * 500 * 4
    assert (np.asarray(cube.stored) == 0).all()


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("length", [2**26, 2**31 - 1])
def test_a_blosc_chunk_shorter_than_declared_does_not_crash_the_process(tmp_path, version, length):
    blosc = zarr.codecs.BloscCodec() if version == 3 else numcodecs.Blosc()
    zarr.create_array(
        tmp_path / "a.zarr", data=CUBE, chunks=CUBE.shape, zarr_format=version, compressors=blosc
    )
    chunk = tmp_path / "a.zarr" / ("c/0/0/0" if version == 3 else "0.0.0")
    content = bytearray(chunk.read_bytes())
    assert struct.unpack_from("<I", content, 12)[0] == len(content)
    struct.pack_into("<I", content, 12, length)
    chunk.write_bytes(content)
    done = subprocess.run(
        [sys.executable, "-c", READS, str(tmp_path / "a.zarr")], capture_output=True, text=True
    )
    assert done.returncode == 0
    assert str(length) in done.stdout
    assert done.stderr == ""


@pytest.mark.parametrize("depth", [60, 3000])
def test_deeply_nested_groups_are_read_or_refused_at_once(tmp_path, depth):
    """The library looks up each name from the root: 3000 groups took a quarter of a minute."""
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        inner = file.create_group("/".join("g" * depth))
        inner["reflectance"] = np.full((4, 5, 27), 0.5, "f4")
        file["wavelength_nm"] = np.linspace(400, 1050, 27)
    if depth == 60:
        assert read_cube(path).wavelength_nm.size == 27
        return
    start = os.times().elapsed
    with refused_input(subject=str(path)):
        read_cube(path)
    assert os.times().elapsed - start < 20
