"""Cubes from HDF5, NetCDF, Zarr, TIFF, folders of PNGs and xarray."""

import contextlib
import json
import pickle
import shutil
import sys
import time
import zlib

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.base import sandbox as _sandbox
from chromanoise.base.errors import InputError
from chromanoise.io.cubes import cube_from_xarray, picture_to_xarray, read_cube
from chromanoise.io.cubes.hdf5 import Chunks
from chromanoise.spectra import row_source
from chromanoise.spectra.scene_rows import FileRows, PlaneRows
from outcomes import refused_input
from processes import printed

h5py = pytest.importorskip("h5py", reason="comes with chromanoise[cubes]")
xarray = pytest.importorskip("xarray", reason="comes with chromanoise[cubes]")
zarr = pytest.importorskip("zarr", reason="comes with chromanoise[cubes]")
Image = pytest.importorskip("PIL.Image")
tifffile = pytest.importorskip("tifffile")

NM = (400.0, 450.0, 500.0, 600.0, 700.0)


def numbers(rows=3, columns=4, bands=5, dtype=np.float64):
    """Whole numbers 1 .. 127, which every type can hold."""
    return np.random.default_rng(5).integers(1, 128, size=(rows, columns, bands)).astype(dtype)


def rows_of(cube):
    """All rows, two at a time, as an engine asks for them; by a source that has traveled."""
    source = pickle.loads(pickle.dumps(row_source(cube.stored)))
    height = source.shape[0]
    blocks = [source.rows(a, min(a + 2, height)) for a in range(0, height, 2)]
    return np.concatenate(blocks)


def assert_holds(cube, expected, wavelengths=NM):
    np.testing.assert_array_equal(rows_of(cube), expected)
    np.testing.assert_allclose(cube.wavelength_nm, wavelengths, rtol=1e-12)


def noted(cube, words):
    return any(words in note for note in cube.notes)


def refused(path, match, **options):
    with pytest.raises(InputError, match=match) as caught:
        rows_of(read_cube(path, **options))
    assert "\n" not in str(caught.value)


# MATLAB 7.3


def write_mat73(path, cube, name="reflectance", matlab_class="double", wavelengths=NM, **options):
    """As MATLAB does it: a block of 512 bytes before, axes reversed, the class as an attribute."""
    with h5py.File(path, "w", userblock_size=512) as file:
        file.create_dataset(name, data=cube.T, **options).attrs["MATLAB_class"] = np.bytes_(
            matlab_class
        )
        if wavelengths is not None:
            file["wavelength_nm"] = np.array(wavelengths)[:, None]
            file["wavelength_nm"].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return path


@pytest.mark.parametrize("options", [{}, {"chunks": (2, 3, 2), "compression": "gzip"}])
def test_matlab_7_3_has_its_axes_turned_about(tmp_path, options):
    cube = read_cube(write_mat73(tmp_path / "a.mat", numbers(), **options))
    assert_holds(cube, numbers())
    assert isinstance(cube.stored, FileRows) == (not options)


def test_matlab_7_3_pixels_run_along_the_columns(tmp_path):
    spectra = np.array([numbers()[r, c] for c in range(4) for r in range(3)])
    path = write_mat73(tmp_path / "a.mat", spectra, wavelengths=None)
    cube = read_cube(path, shape=(3, 4), wavelengths=(400, 800))
    assert_holds(cube, numbers(), np.linspace(400, 800, 5))
    assert noted(cube, "column by column")


@pytest.mark.parametrize("kind", ["logical", "cell", "char", "struct"])
def test_what_is_no_number_in_matlab_7_3_is_refused(tmp_path, kind):
    path = write_mat73(tmp_path / "a.mat", numbers(), matlab_class=kind)
    with refused_input(subject=str(path), where="array 'reflectance'", setting="key"):
        read_cube(path)


def test_empty_and_complex_arrays_of_matlab_7_3_are_refused(tmp_path):
    path = write_mat73(tmp_path / "a.mat", np.zeros((2, 1)))
    with h5py.File(path, "r+") as file:
        file["reflectance"].attrs["MATLAB_empty"] = np.uint8(1)
    with refused_input(subject=str(path), where="array 'reflectance'", value=(0,)):
        read_cube(path)
    both = np.ones((2, 2, 2), dtype=[("real", "f8"), ("imag", "f8")])
    with refused_input(where="array 'reflectance'", setting="key"):
        read_cube(write_mat73(tmp_path / "b.mat", both))


# HDF5 and NetCDF


def write_redfish(path, cube, wavelengths=NM, dtype=np.uint16, **options):
    with h5py.File(path, "w") as file:
        file.create_dataset("Hymage", data=cube.astype(dtype), **options)
        file["Wavelength"] = np.array(wavelengths)
    return path


def test_a_name_of_an_array_that_is_not_utf_8_is_refused(tmp_path):
    path = write_redfish(tmp_path / "a.h5", numbers())
    path.write_bytes(path.read_bytes().replace(b"Hymage", b"Hym\xffge"))
    with pytest.raises(InputError) as error:
        read_cube(path)
    assert error.value.value == r"Hym\xffge"


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("options", [{}, {"chunks": True, "compression": "gzip"}])
def test_redfish_finds_its_bands_by_the_wavelengths_and_counts_65536(tmp_path, axis, options):
    stored = np.moveaxis(numbers(), 2, axis)
    cube = read_cube(write_redfish(tmp_path / "a.h5", stored, **options))
    assert_holds(cube, numbers())
    assert cube.scale * 65536 == 1
    assert noted(cube, f"axis {axis} of 'Hymage' taken as bands")


@pytest.mark.parametrize("options", [{}, {"chunks": (2, 2, 2)}])
def test_falling_wavelengths_turn_the_bands_of_a_source_about(tmp_path, options):
    path = write_redfish(tmp_path / "a.h5", numbers()[:, :, ::-1], NM[::-1], **options)
    cube = read_cube(path)
    assert_holds(cube, numbers())
    assert noted(cube, "band order reversed")


def test_a_cube_whose_axes_cannot_be_told_apart_is_refused(tmp_path):
    with refused_input(where="array 'Hymage'", value=(5, 4, 5)):
        read_cube(write_redfish(tmp_path / "a.h5", numbers(5, 4, 5)))


def test_redfish_of_other_types_does_not_say_what_it_means(tmp_path):
    with refused_input(setting="scale", value="int32"):
        read_cube(write_redfish(tmp_path / "a.h5", numbers(), dtype=np.int32))


@pytest.mark.parametrize(
    ("stored", "unit", "note"),
    [
        (np.array(NM), "nm", None),
        (np.array(NM) / 1000, "um", None),
        (np.array(NM) / 1000, "Micrometers", None),
        (np.array(NM), None, "taken as nm"),
        (np.array(NM) / 1000, None, "taken as micrometers"),
    ],
)
def test_wavelengths_are_in_the_unit_told_or_a_noted_guess(tmp_path, stored, unit, note):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["deep/cube"] = numbers()
        file["deep/wavelengths"] = stored
        if unit:
            file["deep/wavelengths"].attrs["units"] = unit
    cube = read_cube(tmp_path / "a.h5")
    assert_holds(cube, numbers())
    assert noted(cube, "the only array with three axes")
    assert note is None or noted(cube, note)


def test_wavelengths_may_stand_in_an_attribute(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["reflectance"] = numbers()
        file["reflectance"].attrs["wavelength"] = NM
        file["reflectance"].attrs["wavelength_units"] = "nm"
    assert_holds(read_cube(tmp_path / "a.h5"), numbers())


def labeled(order=("wavelength", "y", "x"), dtype=np.float64, **attributes):
    axes = {"y": 0, "x": 1, "wavelength": 2}
    array = xarray.DataArray(
        numbers(dtype=dtype).transpose([axes[a] for a in order]), dims=order, attrs=attributes
    )
    return array.assign_coords(wavelength=("wavelength", list(NM), {"units": "nm"}))


@pytest.mark.parametrize("order", [("wavelength", "y", "x"), ("y", "wavelength", "x")])
@pytest.mark.parametrize("ending", ["nc", "zarr2", "zarr3"])
def test_netcdf_and_zarr_tell_their_axes_by_name(tmp_path, order, ending):
    pytest.importorskip("h5netcdf", reason="xarray writes the file by it")
    data = labeled(order).to_dataset(name="rho")
    path = tmp_path / "a.nc"
    if ending == "nc":
        data.to_netcdf(path, engine="h5netcdf")
    else:
        path = tmp_path / "a.zarr"
        data.to_zarr(path, zarr_format=int(ending[-1]), consolidated=False)
    assert_holds(read_cube(path, key="rho"), numbers())
    assert_holds(read_cube(path), numbers())


def test_scale_and_percent_are_those_of_the_file(tmp_path):
    pytest.importorskip("h5netcdf", reason="xarray writes the file by it")
    path = tmp_path / "a.nc"
    for attributes, scale in (
        ({"scale_factor": 0.25}, 0.25),
        ({"units": "%"}, 0.01),
        ({"units": "percent", "scale_factor": 0.5}, 0.005),
    ):
        data = labeled(dtype=np.int16).to_dataset(name="rho")
        data.to_netcdf(path, engine="h5netcdf")
        with h5py.File(path, "r+") as file:
            file["rho"].attrs.update(attributes)
        assert read_cube(path).scale == scale


@pytest.mark.parametrize(
    ("attributes", "fields"),
    [
        ({"units": "W m-2 sr-1 um-1"}, {}),
        ({"long_name": "at-sensor radiance"}, {}),
        ({"add_offset": 3.0}, {"where": "attribute 'add_offset'", "value": 3.0}),
        ({"scale_factor": -1.0}, {"where": "attribute 'scale_factor'", "value": -1.0}),
        ({"scale_factor": np.inf}, {"where": "attribute 'scale_factor'", "value": np.inf}),
        ({"scale_factor": np.nan}, {"where": "attribute 'scale_factor'"}),
        ({"scale_factor": "one"}, {"where": "attribute 'scale_factor'", "value": "one"}),
    ],
)
def test_attributes_that_forbid_the_cube_are_told(tmp_path, attributes, fields):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["reflectance"] = numbers()
        file["wavelength_nm"] = NM
        file["reflectance"].attrs.update(attributes)
    with refused_input(subject=str(tmp_path / "a.h5"), setting="scale", **fields):
        read_cube(tmp_path / "a.h5")


def test_a_fill_value_is_noted_and_its_nan_refused_with_that_note(tmp_path):
    from chromanoise.spectra.scene import reflectance_rows

    cube = numbers() / 128
    cube[1, 1, 1] = np.nan
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["reflectance"] = cube
        file["wavelength_nm"] = NM
        file["reflectance"].attrs["_FillValue"] = np.nan
    found = read_cube(tmp_path / "a.h5")
    with refused_input(setting="bad_pixels") as caught:
        reflectance_rows(found, 0, 3)
    assert caught.value.where.startswith("row 1, column 1 ")
    assert np.isnan(caught.value.value)
    assert any("data ignore value" in str(one) for one in caught.value.remedy)


def test_nothing_outside_an_hdf5_file_is_read(tmp_path):
    secret = write_redfish(tmp_path / "secret.h5", numbers())
    numbers().tofile(tmp_path / "raw")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["link"] = h5py.ExternalLink(str(secret), "/Hymage")
        file["round"] = h5py.SoftLink("/")
        file["wavelength_nm"] = NM
        file.create_dataset(
            "raw", (3, 4, 5), "f8", external=[(str(tmp_path / "raw"), 0, 3 * 4 * 5 * 8)]
        )
        layout = h5py.VirtualLayout((3, 4, 5), "u2")
        layout[...] = h5py.VirtualSource(str(secret), "Hymage", (3, 4, 5))
        file.create_virtual_dataset("virtual", layout)
    with refused_input(subject=str(tmp_path / "a.h5"), setting="key"):
        read_cube(tmp_path / "a.h5", key="link")
    for key in ("raw", "virtual"):
        with refused_input(subject=str(tmp_path / "a.h5"), where=f"array {key!r}"):
            rows_of(read_cube(tmp_path / "a.h5", key=key))


def test_numbers_that_were_never_written_are_not_taken_for_zeros(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        made = file.create_dataset("reflectance", (8, 8, 5), "f4", chunks=(4, 4, 5))
        made[:4] = 1
        file.create_dataset("nothing", (8, 8, 5), "f4")
        file["wavelength_nm"] = NM
    with refused_input(where="array 'reflectance'", value=2, requirement="complete"):
        rows_of(read_cube(tmp_path / "a.h5"))
    with refused_input(where="array 'nothing'", value=0, requirement="complete"):
        rows_of(read_cube(tmp_path / "a.h5", key="nothing"))


def test_old_netcdf_is_refused_with_its_cure(tmp_path):
    (tmp_path / "a.nc").write_bytes(b"CDF\x01" + bytes(100))
    with refused_input(subject=str(tmp_path / "a.nc")) as caught:
        read_cube(tmp_path / "a.nc")
    assert "nccopy" in caught.value.remedy[0]


@pytest.mark.parametrize("name", ["x", "reflectance"])
def test_objects_words_and_references_are_refused(tmp_path, name):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["words"] = ["a", "b"]
        file.create_dataset("ref", (2, 2, 2), h5py.ref_dtype)
        file.create_dataset("truth", data=np.ones((2, 2, 2), bool))
        file["complex"] = np.ones((2, 2, 2)) * 1j
        file["no/shape"] = h5py.Empty("f4")
        file["scalar"] = 3.0
    for key in ("words", "ref", "truth", "complex"):
        with refused_input(where=f"array {key!r}", setting="key"):
            read_cube(tmp_path / "a.h5", key=key)
    with refused_input(where="array 'scalar'", value=()):
        read_cube(tmp_path / "a.h5", key="scalar")
    with refused_input(subject=str(tmp_path / "a.h5"), setting="key"):
        read_cube(tmp_path / "a.h5", key=name)


# HDF5 chunks, which are read without libhdf5


def is_read_without_libhdf5(source):
    with source.opened() as array:
        return isinstance(array, Chunks)


spans = st.tuples(st.integers(1, 9), st.integers(1, 9), st.integers(2, 9))
ways = st.sampled_from([
    {}, {"compression": "gzip"}, {"shuffle": True}, {"compression": "gzip", "shuffle": True},
    {"compression": "lzf"}, {"fletcher32": True, "compression": "gzip"}, {"scaleoffset": 0},
])  # fmt: skip


@given(
    sizes=spans,
    chunk=spans,
    way=ways,
    dtype=st.sampled_from(["<i2", ">i4", "u1", "<u8"]),
    file=st.sampled_from([{}, {"libver": "latest"}, {"userblock_size": 1024}]),
    data=st.data(),
)
@settings(max_examples=6)
def test_chunks_are_read_as_h5py_reads_them(tmp_path_factory, sizes, chunk, way, dtype, file, data):
    cube = np.arange(np.prod(sizes)).reshape(sizes).astype(dtype)
    path = tmp_path_factory.mktemp("chunks") / "chunks.h5"
    with h5py.File(path, "w", **file) as written:
        options = {"chunks": chunk, "maxshape": (None, None, None)} | way
        written.create_dataset("a", data=cube, **options)
    source = row_source(read_cube(path, scale=1.0, wavelengths=(400, 700)).stored)
    plain = not {"fletcher32", "scaleoffset"} & way.keys() and way.get("compression") != "lzf"
    assert is_read_without_libhdf5(source) == plain
    start = data.draw(st.integers(0, sizes[0] - 1))
    stop = data.draw(st.integers(start + 1, sizes[0]))
    keep = data.draw(st.sampled_from([slice(None), slice(None, None, -1), slice(1, None, 2)]))
    rows = source.with_bands(keep).rows(start, stop)
    np.testing.assert_array_equal(rows, cube[start:stop, :, keep])
    assert rows.dtype.isnative


@pytest.mark.parametrize("axis", [0, 1])
def test_chunks_may_hold_the_bands_along_any_axis(tmp_path, axis):
    stored = np.moveaxis(numbers(), 2, axis)
    path = write_redfish(tmp_path / "a.h5", stored, chunks=(2, 2, 2), compression="gzip")
    source = row_source(read_cube(path).stored)
    assert is_read_without_libhdf5(source)
    np.testing.assert_array_equal(source.rows(1, 3), numbers()[1:3])


@pytest.mark.parametrize("content", [zlib.compress(bytes(3)), zlib.compress(bytes(99)), b"no zlib"])
def test_a_chunk_that_is_not_whole_is_refused_not_filled_with_what_lay_in_memory(tmp_path, content):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        made = file.create_dataset("a", (4, 4, 2), "f4", chunks=(2, 4, 2), compression="gzip")
        made[...] = 1
        made.id.write_direct_chunk((2, 0, 0), content)
    cube = read_cube(tmp_path / "a.h5", wavelengths=(400, 700))
    assert (row_source(cube.stored).rows(0, 2) == 1).all()
    refused(tmp_path / "a.h5", "not a readable HDF5 file", wavelengths=(400, 700))


def test_a_filter_that_was_left_out_of_a_chunk_is_not_undone(tmp_path):
    options = {"chunks": (2, 4, 2), "compression": "gzip", "shuffle": True}
    sevens = np.full((2, 4, 2), 7.5, "<f4")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        made = file.create_dataset("a", data=np.ones((4, 4, 2), "<f4"), **options)
        made.id.write_direct_chunk((2, 0, 0), zlib.compress(sevens.tobytes()), filter_mask=1)
    source = row_source(read_cube(tmp_path / "a.h5", wavelengths=(400, 700)).stored)
    assert is_read_without_libhdf5(source)
    np.testing.assert_array_equal(source.rows(2, 4), sevens)


def test_a_list_of_wavelengths_that_is_not_whole_is_refused(tmp_path):
    path = write_redfish(tmp_path / "a.h5", numbers())
    with h5py.File(path, "r+") as file:
        del file["Wavelength"]
        made = file.create_dataset("Wavelength", data=NM, chunks=(5,), compression="gzip")
        made.id.write_direct_chunk((0,), zlib.compress(np.array(NM[:2]).tobytes()))
    refused(path, "chunk 0 holds 16 bytes instead of 40")


# HDF5 files on which libhdf5 loops or crashes

LOOPS = "import itertools\nFile = lambda *_: sum(itertools.repeat(0))"  # holds Python's lock
CRASHES = "import faulthandler\nFile = lambda *_: faulthandler._sigsegv()"


@pytest.fixture
def impatient(monkeypatch):
    """Another child process before and after, and 2 s for a call."""
    monkeypatch.setattr("chromanoise.io.cubes.hdf5._LIMIT_S", 2.0)
    _sandbox.close_sandbox()
    yield
    _sandbox.close_sandbox()


@pytest.mark.parametrize(
    ("library", "result"), [(LOOPS, "does not return within 2 s"), (CRASHES, "crashes")]
)
def test_a_library_that_loops_or_crashes_costs_a_sentence(
    impatient, tmp_path, monkeypatch, library, result
):
    path = write_redfish(tmp_path / "a.h5", numbers())
    (tmp_path / "h5py.py").write_text(library)  # for the child process; here it is loaded already
    monkeypatch.syspath_prepend(tmp_path)
    refused(path, rf"not a readable HDF5 file \(its library {result}.*save it again")


def without_end(path):
    """A file whose heap of words has free space of 0 bytes, on which libhdf5 2.0.0 turns round."""
    with h5py.File(path, "w") as file:
        file["reflectance"] = numbers()
        file["wavelength_nm"] = NM
        file["wavelength_nm"].attrs["units"] = "nm"
    content = bytearray(path.read_bytes())
    at = content.index(b"GCOL") + 16  # objects: number (2 bytes), uses (2), 0 (4), length (8)
    while content[at : at + 2] != b"\0\0":  # number 0 is the free space
        length = int.from_bytes(content[at + 8 : at + 16], "little")
        at += 16 + -(-length // 8) * 8
    content[at + 8 : at + 16] = bytes(8)
    path.write_bytes(content)
    return path


def test_a_damaged_heap_does_not_hang_the_reader(impatient, tmp_path):
    begun = time.monotonic()
    with contextlib.suppress(InputError):
        read_cube(without_end(tmp_path / "a.h5"))
    assert time.monotonic() - begun < 60


# without the packages


@pytest.mark.parametrize("name", ["h5py", "zarr", "xarray"])
def test_an_absent_package_is_told_with_what_installs_it(tmp_path, name, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)
    match = rf"needs the package {name}.*chromanoise\[cubes\]"
    if name == "h5py":
        (tmp_path / "a.h5").write_bytes(b"\x89HDF\r\n\x1a\n")
        refused(tmp_path / "a.h5", match)
    elif name == "zarr":
        (tmp_path / "a.zarr").mkdir()
        (tmp_path / "a.zarr" / ".zgroup").write_text("{}")
        refused(tmp_path / "a.zarr", match)
    else:
        with pytest.raises(InputError, match=match):
            picture_to_xarray(Seen())


def test_importing_the_scene_imports_no_library_of_files():
    out = printed("import sys, chromanoise.spectra; print(sorted(sys.modules))")
    for name in ("h5py", "zarr", "xarray", "tifffile", "PIL", "scipy"):
        assert f"'{name}'" not in out


# Zarr


def write_zarr(path, cube=None, version=3, **options):
    cube = numbers() if cube is None else cube
    group = zarr.create_group(path, zarr_format=version, overwrite=True)
    group.create_array("reflectance", data=cube, **({"chunks": (2, 4, 5)} | options))
    group.create_array("wavelength_nm", data=np.array(NM), chunks=(5,))
    return path


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("dtype", ["<f4", ">u2", "u1"])
def test_zarr_gives_back_what_was_written(tmp_path, version, dtype):
    path = write_zarr(tmp_path / "a.zarr", numbers(dtype=dtype), version)
    cube = read_cube(path, scale=1.0)
    assert_holds(cube, numbers())
    assert row_source(cube.stored).chunk_rows == 2
    assert row_source(cube.stored).dtype.isnative


def test_shards_are_read_too(tmp_path):
    path = write_zarr(tmp_path / "a.zarr", chunks=(1, 2, 5), shards=(2, 4, 5))
    assert row_source(read_cube(path).stored).chunk_rows == 2
    assert_holds(read_cube(path), numbers())


def test_chunks_that_are_absent_are_told_and_none_at_all_is_refused(tmp_path):
    path = write_zarr(tmp_path / "a.zarr")
    shutil.rmtree(path / "reflectance" / "c" / "1")
    cube = read_cube(path)
    assert noted(cube, "1 of 2 chunks are absent and read as 0")
    np.testing.assert_array_equal(rows_of(cube)[:2], numbers()[:2])
    shutil.rmtree(path / "reflectance" / "c")
    with refused_input(subject=str(path), where="array 'reflectance'", value=0):
        rows_of(read_cube(path))


def test_a_zarr_folder_with_a_link_is_refused(tmp_path):
    path = write_zarr(tmp_path / "a.zarr")
    chunk = path / "reflectance" / "c" / "0" / "0" / "0"
    chunk.rename(tmp_path / "elsewhere")
    chunk.symlink_to(tmp_path / "elsewhere")
    with refused_input(subject=str(chunk)):
        read_cube(path)


@pytest.mark.parametrize("key", ["../secret.zarr/reflectance", "/../../etc", "a/../../b", ".", ""])
def test_no_key_leads_out_of_a_zarr_folder(tmp_path, key):
    write_zarr(tmp_path / "secret.zarr")
    with refused_input(subject=str(tmp_path / "a.zarr"), setting="key"):
        read_cube(write_zarr(tmp_path / "a.zarr"), key=key)


def test_nothing_in_a_zarr_folder_is_unpickled(tmp_path):
    path = write_zarr(tmp_path / "a.zarr", version=2)
    header = path / "reflectance" / ".zarray"
    data = json.loads(header.read_text())
    for change in ({"filters": [{"id": "pickle"}]}, {"compressor": {"id": "pickle"}}):
        header.write_text(json.dumps(data | change))
        with refused_input(where="array 'reflectance'", value="pickle"):
            read_cube(path)
    header.write_text(json.dumps(data | {"dtype": "|O", "filters": [{"id": "pickle"}]}))
    with refused_input(where="array 'reflectance'", value="pickle"):
        read_cube(path)
    path = write_zarr(tmp_path / "b.zarr")
    header = path / "reflectance" / "zarr.json"
    data = json.loads(header.read_text())
    data["codecs"] = [{"name": "numcodecs.pickle", "configuration": {}}]
    header.write_text(json.dumps(data))
    with refused_input(where="array 'reflectance'", value="pickle"):
        read_cube(path)


def test_a_zarr_array_without_a_group_is_a_cube(tmp_path):
    zarr.create_array(tmp_path / "a.zarr", data=numbers(), chunks=(2, 2, 2))
    cube = read_cube(tmp_path / "a.zarr", wavelengths=(400, 800))
    assert_holds(cube, numbers(), np.linspace(400, 800, 5))


# TIFF


@pytest.mark.parametrize("dtype", ["<f4", ">u2", "u1"])
@pytest.mark.parametrize("big", [False, True])
def test_pages_of_a_tiff_are_bands_and_stay_on_disk(tmp_path, dtype, big):
    stored = numbers(dtype=dtype).transpose(2, 0, 1)
    order = ">" if dtype[0] == ">" else "<"
    with tifffile.TiffWriter(tmp_path / "a.tif", byteorder=order, bigtiff=big) as file:
        for plane in stored:
            file.write(plane, photometric="minisblack", contiguous=False)
    cube = read_cube(tmp_path / "a.tif", wavelengths=(400, 800), scale=0.01)
    assert isinstance(cube.stored, PlaneRows)
    assert_holds(cube, numbers(), np.linspace(400, 800, 5))


@pytest.mark.parametrize("planar", ["contig", "separate"])
def test_samples_of_one_page_are_bands(tmp_path, planar):
    cube = numbers(dtype="f4")
    stored = cube if planar == "contig" else cube.transpose(2, 0, 1)
    tifffile.imwrite(
        tmp_path / "a.tif", stored, photometric="minisblack", planarconfig=planar, metadata=None
    )
    found = read_cube(tmp_path / "a.tif", wavelengths=(400, 800))
    assert isinstance(found.stored, FileRows)
    assert_holds(found, cube, np.linspace(400, 800, 5))


def test_a_stack_that_tifffile_writes_at_once_is_read(tmp_path):
    tifffile.imwrite(
        tmp_path / "a.tif",
        numbers(dtype="f4").transpose(2, 0, 1),
        photometric="minisblack",
        metadata={"wavelength": list(NM)},
    )
    assert_holds(read_cube(tmp_path / "a.tif"), numbers())


def test_compressed_pages_are_decoded(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for plane in numbers(dtype="f4").transpose(2, 0, 1):
            file.write(plane, photometric="minisblack", compression="zlib", contiguous=False)
    cube = read_cube(tmp_path / "a.tif", wavelengths=(400, 800))
    assert_holds(cube, numbers(), np.linspace(400, 800, 5))


@pytest.mark.parametrize(
    "text", ["wavelength = {400, 450, 500, 600, 700}", '{"wavelength_nm": [400,450,500,600,700]}']
)
def test_a_description_lists_the_wavelengths(tmp_path, text):
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for k, plane in enumerate(numbers(dtype="f4").transpose(2, 0, 1)):
            message = text if k == 0 else None
            file.write(plane, photometric="minisblack", description=message, metadata=None)
    assert_holds(read_cube(tmp_path / "a.tif"), numbers())


def test_each_page_may_tell_its_wavelength(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for nm, plane in zip(NM, numbers(dtype="f4").transpose(2, 0, 1), strict=True):
            text = f"band at {nm:g} nm"
            file.write(plane, photometric="minisblack", description=text, metadata=None)
    assert_holds(read_cube(tmp_path / "a.tif"), numbers())


def test_pages_of_other_sizes_are_refused(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        for rows in (3, 4):
            file.write(np.ones((rows, 4), "f4"), photometric="minisblack")
    with refused_input(subject=str(tmp_path / "a.tif"), where="page 1 (from 0)"):
        read_cube(tmp_path / "a.tif", wavelengths=(400, 800))


# folders of PNGs


def write_pngs(folder, cube, name="thing_ms_{:02d}.png", first=1, step=1):
    folder.mkdir(exist_ok=True)
    for k in range(cube.shape[2]):
        Image.fromarray(cube[:, :, k]).save(folder / name.format(first + k * step))
    return folder


def test_a_folder_named_as_cave_is_31_bands_from_400_to_700_nm(tmp_path):
    cube = numbers(3, 4, 31, np.uint16) * 300
    folder = write_pngs(tmp_path / "thing_ms", cube)
    (folder / "thing_RGB.bmp").write_bytes(b"BM")
    with refused_input(subject=str(folder), value="uint16", setting="scale"):
        read_cube(folder)
    found = read_cube(folder, scale=1 / 65535)
    assert_holds(found, cube, np.arange(400, 701, 10))
    assert noted(found, "CAVE")


def test_bands_are_sorted_by_number_not_by_letter(tmp_path):
    cube = numbers(3, 4, 12, np.uint8)
    folder = write_pngs(tmp_path / "a", cube, name="band{}.png")
    found = read_cube(folder, scale=1 / 255, wavelengths=(400, 700))
    assert_holds(found, cube, np.linspace(400, 700, 12))


def test_numbers_in_names_that_are_wavelengths_are_taken_and_noted(tmp_path):
    folder = write_pngs(tmp_path / "a", numbers(dtype=np.uint8), "x_{}nm.png", first=400, step=50)
    found = read_cube(folder, scale=1 / 255)
    assert_holds(found, numbers(), [400, 450, 500, 550, 600])
    assert noted(found, "taken as wavelengths")


def test_faults_of_a_folder_are_told(tmp_path):
    cube = numbers(dtype=np.uint8)
    ask = {"scale": 1 / 255, "wavelengths": (400, 700)}
    gap = write_pngs(tmp_path / "gap", cube)
    (gap / "thing_ms_03.png").unlink()
    with refused_input(subject=str(gap), value=4):
        read_cube(gap, **ask)
    twice = write_pngs(tmp_path / "twice", cube)
    shutil.copy(twice / "thing_ms_01.png", twice / "other_1.png")
    with refused_input(subject=str(twice), value=1):
        read_cube(twice, **ask)
    unnamed = write_pngs(tmp_path / "unnamed", cube)
    shutil.copy(unnamed / "thing_ms_01.png", unnamed / "preview.png")
    with refused_input(subject=str(unnamed / "preview.png"), value="preview"):
        read_cube(unnamed, **ask)
    color = write_pngs(tmp_path / "color", cube)
    Image.fromarray(np.zeros((3, 4, 3), np.uint8)).save(color / "thing_ms_02.png")
    with refused_input(subject=str(color / "thing_ms_02.png"), value="RGB"):
        read_cube(color, **ask)
    mixed = write_pngs(tmp_path / "mixed", cube)
    Image.fromarray(np.zeros((4, 4), np.uint8)).save(mixed / "thing_ms_02.png")
    with refused_input(subject=str(mixed / "thing_ms_02.png"), value=(4, 4, "uint8")):
        read_cube(mixed, **ask)
    cut = write_pngs(tmp_path / "cut", numbers(64, 64, 5, np.uint8))
    whole = (cut / "thing_ms_02.png").read_bytes()
    (cut / "thing_ms_02.png").write_bytes(whole[: len(whole) // 2])
    with refused_input(subject=str(cut / "thing_ms_02.png"), requirement="PNG"):
        read_cube(cut, **ask)
    (tmp_path / "empty").mkdir()
    with refused_input(subject=str(tmp_path / "empty")):
        read_cube(tmp_path / "empty", **ask)


# xarray


class Seen:
    """What is asked of a picture."""

    xyz = np.full((2, 3, 3), 0.5, np.float32)
    srgb = np.zeros((2, 3, 3), np.uint8)
    white = np.array([0.95, 1.0, 1.09])
    notes = ("one", "two")


@pytest.mark.parametrize("order", [("wavelength", "y", "x"), ("y", "x", "wavelength")])
@pytest.mark.parametrize("lazily", [False, True])
def test_a_labeled_array_is_a_cube(order, lazily):
    if lazily:
        pytest.importorskip("dask", reason="only a dask array is computed late")
    array = labeled(order)
    cube = cube_from_xarray(array.chunk({"y": 2}) if lazily else array)
    assert_holds(cube, numbers())
    assert isinstance(cube.stored, np.ndarray) != lazily


def test_the_unit_of_a_coordinate_makes_it_the_bands():
    array = labeled().rename(wavelength="band")
    assert_holds(cube_from_xarray(array), numbers())
    array = array.drop_vars("band")
    with refused_input(setting="wavelengths"):
        cube_from_xarray(array)
    assert_holds(
        cube_from_xarray(array, wavelengths=(400, 800)), numbers(), [400, 500, 600, 700, 800]
    )


@pytest.mark.parametrize(
    ("array", "fields"),
    [
        (xarray.DataArray(np.ones((2, 2, 2)), dims=("a", "b", "c")), {"value": ("a", "b", "c")}),
        (xarray.DataArray(np.ones((2, 2)), dims=("y", "wavelength")), {"value": (2, 2, "float64")}),
        (labeled().to_dataset(name="rho"), {"value": "Dataset"}),
        (np.ones((2, 2, 2)), {"value": "ndarray"}),
        (labeled(units="W/m2/sr/nm"), {"setting": "scale"}),
        (labeled(dtype=np.uint16), {"setting": "scale", "value": "uint16"}),
        (labeled() > 0, {"value": (5, 3, 4, "bool")}),
    ],
)
def test_a_labeled_array_that_is_no_cube_is_refused(array, fields):
    with refused_input(**fields):
        cube_from_xarray(array)


def test_a_picture_comes_out_labeled():
    data = picture_to_xarray(Seen())
    assert data["xyz"].dims == ("y", "x", "xyz_axis")
    assert float(data["xyz"].sel(xyz_axis="Y")[1, 2]) == 0.5
    assert float(data["white"].sel(xyz_axis="Y")) == 1
    assert data.attrs["notes"] == "one; two"


# wavelengths, units and scale in the tag of GDAL


VNIR_NM, SWIR_NM = np.linspace(418.25, 993.5, 8), np.linspace(902.125, 2445.5, 9)


def gdal_tag(bands, **texts):
    """The tag 42112 as GDAL writes it, one item per band and text; a text of one string for all."""
    roles = {"scale", "offset", "description"}
    items = "".join(
        f'<Item name="{name.upper() if name in roles else name}" sample="{band}"'
        + (f' role="{name}"' if name in roles else "")
        + f">{text if isinstance(text, str) else text[band]}</Item>"
        for band in range(bands)
        for name, text in texts.items()
    )
    return f"<GDALMetadata>{items}</GDALMetadata>"


def gdal_tiff(path, pixels, xml):
    tag = (42112, "s", 0, xml, True)
    tifffile.imwrite(
        path, pixels, planarconfig="separate", photometric="minisblack", extratags=[tag],
        metadata=None,
    )  # fmt: skip
    return path


def counted(bands):
    return np.arange(bands * 6, dtype="i2").reshape(bands, 2, 3)


@pytest.mark.parametrize("unit", ["nm", "Nanometers", "Micrometers", None])
def test_bands_of_two_spectrometers_are_sorted_by_the_wavelengths_of_gdal(tmp_path, unit):
    at = np.concatenate([VNIR_NM, SWIR_NM])
    listed = [f"{one / 1000 if unit == 'Micrometers' else one:.12g}" for one in at]
    if unit is None:
        texts = {"description": [f"band {k + 1} ({w} nm)" for k, w in enumerate(listed)]}
    else:
        texts = {"wavelength": listed, "wavelength_units": unit}
    xml = gdal_tag(at.size, **texts, scale="0.0001", offset="0")
    cube = read_cube(gdal_tiff(tmp_path / "a.tif", counted(at.size), xml))
    order = np.argsort(at)
    assert cube.wavelength_nm == pytest.approx(at[order], rel=1e-9)
    assert cube.scale == 1e-4
    rows = row_source(cube.stored)
    assert rows.rows(0, 2).tolist() == counted(at.size)[order].transpose(1, 2, 0).tolist()
    few = rows.with_bands(slice(6, 10))
    assert few.rows(1, 2).tolist() == rows.rows(1, 2)[:, :, 6:10].tolist()
    assert any("2 overlapping spectrometers" in note for note in cube.notes)


@pytest.mark.parametrize(("texts", "where"), [
    ({"scale": "1e-4", "offset": "0.1"}, "tag GDAL_METADATA"),
    ({"scale": ["1e-4"] * 7 + ["1e-3"], "offset": "0"}, "tag GDAL_METADATA"),
    ({"scale": "-1"}, "scale in tag GDAL_METADATA"),
    ({"scale": "high"}, "scale in tag GDAL_METADATA"),
])  # fmt: skip
def test_a_scale_of_gdal_that_is_not_one_number_is_refused(tmp_path, texts, where):
    listed = [f"{one:g}" for one in VNIR_NM]
    xml = gdal_tag(8, wavelength=listed, wavelength_units="nm", **texts)
    path = gdal_tiff(tmp_path / "a.tif", counted(8), xml)
    with refused_input(subject=str(path), where=where, setting="scale"):
        read_cube(path)


@pytest.mark.parametrize("order", [[3, 1, 0, 2, 7, 5, 6, 4], [0, 1, 2, 3, 4, 5, 6, 6]])
def test_bands_in_any_other_order_are_refused(tmp_path, order):
    listed = [f"{VNIR_NM[k]:g}" for k in order]
    xml = gdal_tag(8, wavelength=listed, wavelength_units="nm", scale="0.01")
    path = gdal_tiff(tmp_path / "a.tif", counted(8), xml)
    with refused_input(subject=str(path), setting="wavelengths"):
        read_cube(path)


def test_a_tag_of_gdal_that_declares_entities_is_refused(tmp_path):
    xml = "<!DOCTYPE a [<!ENTITY b 'c'>]>" + gdal_tag(8, wavelength="&b;")
    path = gdal_tiff(tmp_path / "a.tif", counted(8), xml)
    with refused_input(subject=str(path), requirement="document type"):
        read_cube(path)
