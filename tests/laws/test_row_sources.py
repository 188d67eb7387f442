"""Rows of a cube, wherever it lies: only what is asked for is read, and it is what was written."""

import pickle
from concurrent.futures import ThreadPoolExecutor
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.spectra import Cube, Grid, RowSource, bands_within, row_source
from chromanoise.spectra.scene import reflectance_rows
from chromanoise.spectra.scene_rows import ArrayRows, FileRows, PaletteRows, PlaneRows
from outcomes import refused_input
from processes import printed

slices = st.builds(
    slice,
    st.none() | st.integers(-4, 4),
    st.none() | st.integers(-4, 4),
    st.sampled_from([None, 1, 2, -1, -2]),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("rows")


def mapped(path, numbers, order, dtype, offset=3):
    """A memory map whose axes lie in the file in this order, after some bytes of something else."""
    written = np.ascontiguousarray(numbers.transpose(order)).astype(dtype)
    path.write_bytes(b"\xaa" * offset + written.tobytes())
    pixels = np.memmap(path, dtype=dtype, mode="r", offset=offset, shape=written.shape)
    return pixels.transpose(np.argsort(order))


@given(
    shape=st.tuples(st.integers(1, 6), st.integers(1, 5), st.integers(1, 4)),
    order=st.sampled_from(list(permutations(range(3)))),
    dtype=st.sampled_from(["<f4", ">f4", "<u2", ">i8", "u1", "<f8"]),
    keep=slices,
    rows=st.tuples(st.integers(0, 5), st.integers(1, 6)),
    reused=st.booleans(),
)
def test_any_rows_of_any_order_of_axes_are_those_that_were_written(
    folder, shape, order, dtype, keep, rows, reused
):
    numbers = np.random.default_rng(7).integers(1, 100, shape)
    expected = numbers[:, :, keep]
    start, stop = min(rows[0], shape[0] - 1), min(max(rows), shape[0])
    if start >= stop or not expected.size:
        return
    pixels = mapped(folder / "a", numbers, order, dtype)
    for source in (row_source(pixels).with_bands(keep), row_source(pixels[:, :, keep])):
        assert isinstance(source, FileRows)
        assert source.shape == expected.shape
        into = np.full(source.scratch_bytes(stop - start) + 3, 7, np.uint8) if reused else None
        got = source.rows(start, stop, into=into)
        np.testing.assert_array_equal(got, expected[start:stop])
        assert got.dtype == source.dtype == np.dtype(dtype).newbyteorder("=")


def test_rows_and_columns_may_be_turned_about_too(tmp_path):
    numbers = np.arange(60).reshape(3, 4, 5)
    for order in permutations(range(3)):
        pixels = mapped(tmp_path / "a", numbers, order, ">i2")[::-1, ::-1]
        got = row_source(pixels).rows(1, 3)
        np.testing.assert_array_equal(got, numbers[::-1, ::-1][1:3])


@pytest.mark.parametrize(
    ("order", "strides"),
    [
        ((0, 1, 2), (5 * 6 * 4, 6 * 4, 4)),  # BIP: bands of a pixel lie together
        ((0, 2, 1), (5 * 6 * 4, 4, 5 * 4)),  # BIL: a row has its bands one after the other
        ((2, 0, 1), (5 * 4, 4, 2 * 5 * 4)),  # BSQ: as in the file, with planes of 2 rows
    ],
)
def test_a_block_keeps_the_strides_of_its_interleave(tmp_path, order, strides):
    pixels = mapped(tmp_path / "a", np.ones((9, 5, 6)), order, "<f4")
    assert row_source(pixels).rows(2, 4).strides == strides


def test_no_more_bytes_are_held_than_a_block_has(tmp_path):
    numbers = np.ones((64, 5, 6))
    for order in ((0, 1, 2), (0, 2, 1), (2, 0, 1)):
        source = row_source(mapped(tmp_path / "a", numbers, order, "<f4"))
        assert source.scratch_bytes(8) == 8 * 5 * 6 * 4
    by_columns = row_source(mapped(tmp_path / "a", numbers, (2, 1, 0), "<f4"))
    assert by_columns.scratch_bytes(8) == 0  # a copy is made, plane by plane
    few = row_source(mapped(tmp_path / "a", numbers, (2, 0, 1), "<f4")).with_bands(slice(1, 3))
    assert few.scratch_bytes(8) == 8 * 5 * 2 * 4


def test_memory_given_for_reuse_is_where_the_rows_are(tmp_path):
    for order in ((0, 1, 2), (2, 0, 1)):
        source = row_source(mapped(tmp_path / "a", np.ones((4, 5, 6)), order, "<f4"))
        into = np.zeros(source.scratch_bytes(2), np.uint8)
        assert np.shares_memory(source.rows(0, 2, into=into), into)
        assert not np.shares_memory(source.rows(0, 2), into)


def test_a_source_travels_and_reads_on_in_another_process(tmp_path):
    numbers = np.arange(24.0).reshape(2, 3, 4)
    source = row_source(mapped(tmp_path / "a", numbers, (2, 0, 1), "<f8"))
    (tmp_path / "pickled").write_bytes(pickle.dumps(source))
    result = (
        "import pickle, sys; source = pickle.load(open(sys.argv[1], 'rb')); "
        "print(source.rows(1, 2).sum())"
    )
    assert float(printed(result, tmp_path / "pickled")) == sum(range(12, 24))


def test_many_threads_read_the_same_source(tmp_path):
    numbers = np.arange(64 * 3 * 5).reshape(64, 3, 5)
    source = row_source(mapped(tmp_path / "a", numbers, (2, 0, 1), "<i4"))
    with ThreadPoolExecutor(8) as pool:
        got = list(pool.map(lambda row: source.rows(row, row + 1), list(range(64)) * 4))
    np.testing.assert_array_equal(np.concatenate(got), np.concatenate([numbers] * 4))


def test_a_file_cut_while_it_is_read_is_said(tmp_path):
    source = row_source(mapped(tmp_path / "a", np.ones((4, 3, 2)), (2, 0, 1), "<f4"))
    (tmp_path / "a").write_bytes(bytes(50))
    with refused_input(subject=str(tmp_path / "a"), remedy=("copy it again",)):
        source.rows(3, 4)
    (tmp_path / "a").unlink()
    with refused_input(subject=str(tmp_path / "a")):
        source.rows(0, 1)


@pytest.mark.parametrize(("start", "stop"), [(-1, 1), (2, 2), (1, 5), (3, 1)])
def test_rows_beyond_the_picture_are_refused(tmp_path, start, stop):
    pixels = mapped(tmp_path / "a", np.ones((4, 3, 2)), (0, 1, 2), "<f4")
    for stored in (pixels, np.ones((4, 3, 2))):
        with refused_input(value=(start, stop)):
            row_source(stored).rows(start, stop)


def test_a_changed_or_private_map_is_no_file():
    """What is not in the file cannot be read from it."""
    assert isinstance(row_source(np.ones((2, 2, 2))), ArrayRows)
    assert isinstance(row_source(np.broadcast_to(1.0, (2, 2, 2))), ArrayRows)


def test_a_private_map_keeps_its_changes(tmp_path):
    (tmp_path / "a").write_bytes(bytes(8))
    private = np.memmap(tmp_path / "a", np.uint8, "c", shape=(2, 2, 2))
    private[0, 0, 0] = 9
    assert row_source(private).rows(0, 1)[0, 0, 0] == 9
    computed = np.memmap(tmp_path / "a", np.uint8, "r", shape=(2, 2, 2)) + np.uint8(5)
    assert row_source(computed).rows(0, 1)[0, 0, 0] == 5


def test_a_palette_gives_the_spectrum_of_each_pixel():
    spectra, index = np.arange(20.0).reshape(4, 5), np.array([[0, 3], [1, 1], [2, 0]], np.uint8)
    source = PaletteRows(palette=spectra, index=index)
    assert (source.shape, source.dtype) == ((3, 2, 5), np.float64)
    np.testing.assert_array_equal(source.rows(1, 3), spectra[index[1:3]])
    few = source.with_bands(slice(1, 3))
    np.testing.assert_array_equal(few.rows(0, 3), spectra[index][:, :, 1:3])
    with refused_input(value=(2, 4)):
        source.rows(2, 4)


def test_planes_of_several_files_are_one_cube(tmp_path):
    numbers = np.arange(30).reshape(5, 3, 2)
    planes = []
    for k in range(2):
        numbers[:, :, k].astype(">u2").tofile(tmp_path / f"{k}")
        planes.append(
            FileRows(
                path=tmp_path / f"{k}",
                offset=0,
                stored=np.dtype(">u2"),
                shape=(5, 3, 1),
                strides=(6, 2, 2),
            )
        )
    source = PlaneRows(planes=tuple(planes))
    np.testing.assert_array_equal(source.rows(1, 4), numbers[1:4])
    np.testing.assert_array_equal(
        source.with_bands(slice(None, None, -1)).rows(0, 5), numbers[:, :, ::-1]
    )


def test_a_cube_of_a_source_gives_the_reflectances_of_the_array(tmp_path):
    numbers = np.random.default_rng(3).integers(0, 100, (6, 4, 5))
    wavelength = np.linspace(400, 800, 5)
    grid = Grid.uniform(500, 600, 5)
    pixels = mapped(tmp_path / "a", numbers, (2, 0, 1), ">u2")
    for stored in (pixels, row_source(pixels), row_source(numbers)):
        cube = Cube(wavelength_nm=wavelength, stored=stored, source="test", scale=0.01)
        few = bands_within(cube, grid)
        assert few.wavelength_nm.tolist() == [500, 600]
        np.testing.assert_allclose(reflectance_rows(few, 2, 5), numbers[2:5, :, 1:3] / 100)
        assert isinstance(few.stored, RowSource) == (stored is not pixels)


def test_a_bad_value_is_told_with_its_place_whatever_the_source(tmp_path):
    numbers = np.full((4, 3, 2), 0.5)
    numbers[2, 1, 1] = np.nan
    source = row_source(mapped(tmp_path / "a", numbers, (2, 0, 1), "<f4"))
    cube = Cube(wavelength_nm=np.array([400.0, 500.0]), stored=source, source="test")
    with refused_input(subject="test", where="row 2, column 1 (from 0), 500 nm"):
        reflectance_rows(cube, 1, 4)


def test_streaming_holds_little_memory(tmp_path):
    """64 MB are read by a process that may grow by 16: a map's pages would count."""
    resource = pytest.importorskip("resource", reason="only Unix tells the largest memory held")
    del resource
    with (tmp_path / "a.npy").open("wb") as file:
        header = {"descr": "<f4", "fortran_order": False, "shape": (1024, 128, 128)}
        np.lib.format.write_array_header_1_0(file, header)
        for _ in range(64):
            file.write(bytes(2**20))
    result = (
        "import resource, sys\n"
        "from chromanoise.io.cubes import read_cube\nfrom chromanoise.spectra import row_source\n"
        "source = row_source(read_cube(sys.argv[1], wavelengths=(400, 800)).stored)\n"
        "source.rows(0, 1)\n"
        "most = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "before = most()\n"
        "for row in range(0, 1024, 16): source.rows(row, row + 16)\n"
        "print((most() - before) // (1024 if sys.platform != 'darwin' else 2**20))\n"
    )
    assert int(printed(result, tmp_path / "a.npy")) < 16
