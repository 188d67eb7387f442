"""Wavelengths of a cube: under their usual names in its file, or in a separate text file."""

import numpy as np
import pytest
import scipy.io

from chromanoise.io.cubes import cube_from_xarray, read_cube
from chromanoise.io.cubes.cube_metadata import read_wavelengths
from chromanoise.spectra.scene_rows import row_source
from outcomes import refused_input

h5py = pytest.importorskip("h5py", reason="comes with chromanoise[cubes]")
zarr = pytest.importorskip("zarr", reason="comes with chromanoise[cubes]")

NM = [400.0, 450.0, 500.0, 600.0, 700.0]
CUBE = np.random.default_rng(5).integers(1, 128, size=(3, 4, 5)) / 128


def write_mat(path, **arrays):
    scipy.io.savemat(path, arrays)


def write_npz(path, **arrays):
    np.savez(path, **arrays)


def write_hdf5(path, **arrays):
    with h5py.File(path, "w") as file:
        for name, array in arrays.items():
            file[name] = array


def write_zarr(path, **arrays):
    group = zarr.create_group(path)
    for name, array in arrays.items():
        group.create_array(name, data=np.asarray(array))


FORMATS = [(write_mat, "a.mat"), (write_npz, "a.npz"), (write_hdf5, "a.h5"), (write_zarr, "a.zarr")]
every = pytest.mark.parametrize(("write", "name"), FORMATS)


AT = np.array(NM)
LISTS = {
    **{f"named {name}": {name: AT} for name in ("wl", "Wavelengths", "WAVELENGTH", "lambda")},
    **{f"bands in {unit}": {f"bands_{unit}": AT * by} for unit, by in (("nm", 1), ("um", 0.001))},
    "angstrom by the name": {"wavelength_angstrom": AT * 10},
    "um by the numbers": {"wave": AT * 0.001},
    "um by the name": {"wl_um": AT * 0.001},
    "falling": {"wl": AT[::-1]},
    "two that agree": {"wl": AT, "wavelength_um": AT / 1000},
    "one of another length": {"wl": AT, "wave": np.arange(400.0, 407)},
}


@every
@pytest.mark.parametrize("which", LISTS)
def test_lists_of_wavelengths_are_found_by_their_names_and_read_in_their_units(
    tmp_path, write, name, which
):
    write(tmp_path / name, reflectance=CUBE, **LISTS[which])
    cube = read_cube(tmp_path / name)
    np.testing.assert_allclose(cube.wavelength_nm, NM, rtol=1e-12)
    expected = CUBE[:, :, ::-1] if which == "falling" else CUBE
    np.testing.assert_array_equal(row_source(cube.stored).rows(0, 3), expected)
    assert any("band order reversed" in note for note in cube.notes) == (which == "falling")


DISORDER = {"where": "band 2 (from 0)", "value": 450.0}
WRONG = {
    "angstrom or nm": ({"wl": AT * 10}, {"where": "list 'wl'", "value": (4000.0, 7000.0)}),
    "two that differ": ({"wl": AT, "wavelengths": AT + 1}, {"requirement": "must agree"}),
    "of another length": ({"wl": np.arange(400.0, 407)}, {"value": 7}),
    "in disorder": ({"wl": np.array([400.0, 500, 450, 600, 700])}, DISORDER),
    "twice": ({"wl": np.array([400.0, 450, 450, 600, 700])}, DISORDER),
    "band numbers": ({"bands": np.arange(1.0, 6)}, {}),
}


@every
@pytest.mark.parametrize("which", WRONG)
def test_lists_that_are_unclear_or_wrong_are_refused(tmp_path, write, name, which):
    arrays, fields = WRONG[which]
    write(tmp_path / name, reflectance=CUBE, **arrays)
    path = str(tmp_path / name)
    with refused_input(subject=path, setting="wavelengths", **fields):
        read_cube(path)


def test_a_declared_angstrom_is_a_tenth_of_a_nm(tmp_path):
    write_hdf5(tmp_path / "a.h5", reflectance=CUBE, wl=np.array(NM) * 10)
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        file["wl"].attrs["units"] = "Angstrom"
    np.testing.assert_allclose(read_cube(tmp_path / "a.h5").wavelength_nm, NM, rtol=1e-12)


# a text file of wavelengths

TEXTS = [
    "400\n450\n500\n600\n700\n",
    "400\r\n450\r\n500\r\n600\r\n700",
    "400,450,500,600,700",
    "400, 450, 500,\n600, 700\n",
    "400;450 500\t600 , 700",
    "wavelength [nm]\n400\n450\n500\n600\n700\n",
    "wavelength_um\n.4\n.45\n.5\n.6\n.7\n",
    "# centers in Angstrom\n4000\n4500\n5000\n6000\n7000\n",
    "center,fwhm\n400,5\n450,5\n500,5\n600,5\n700,5\n",
    "\ufeffnm;a;b\n400;1;2\n450;1;2\n\n500;1;2\n600;1;2\n700;1;2\n",
    "700\n600\n500\n450\n400\n",
]


@pytest.mark.parametrize("text", TEXTS)
def test_a_text_file_lists_one_wavelength_per_band(tmp_path, text):
    (tmp_path / "wl.txt").write_text(text, encoding="utf-8", newline="")
    np.save(tmp_path / "a.npy", CUBE)
    for listed in (tmp_path / "wl.txt", str(tmp_path / "wl.txt")):
        cube = read_cube(tmp_path / "a.npy", wavelengths=listed)
        np.testing.assert_allclose(cube.wavelength_nm, NM, rtol=1e-12)
        falls = text.startswith("700")
        expected = CUBE[:, :, ::-1] if falls else CUBE
        np.testing.assert_array_equal(row_source(cube.stored).rows(0, 3), expected)
        assert any("wl.txt" in note for note in cube.notes)


def test_a_file_of_wavelengths_overrides_the_cube_and_works_for_labeled_arrays(tmp_path):
    xarray = pytest.importorskip("xarray", reason="comes with chromanoise[cubes]")
    (tmp_path / "wl.txt").write_text(TEXTS[0])
    write_npz(tmp_path / "a.npz", reflectance=CUBE, wl=np.array(NM) + 7)
    cube = read_cube(tmp_path / "a.npz", wavelengths=tmp_path / "wl.txt")
    assert cube.wavelength_nm.tolist() == NM
    array = xarray.DataArray(CUBE, dims=("y", "x", "band"))
    assert cube_from_xarray(array, wavelengths=tmp_path / "wl.txt").wavelength_nm.tolist() == NM


FAULTY = {
    "400\n450\n500\n": {"value": (3,)},
    "400,1\n450,1\n500,1\n600,1\n": {"value": (4, 8)},
    "": {"value": None},
    "name\nother\n": {"value": None},
    "400\n450\nx\n600\n700\n": {"where": "entry 3", "value": "x"},
    "400\n450\nnan\n600\n700\n": {"where": "entry 3", "value": "nan"},
    "400\n450\ninf\n600\n700\n": {"where": "entry 3", "value": "inf"},
    "# wavelength_unit: um\nwavelength_nm\n400\n450\n500\n600\n700\n": {"value": ("nm", "um")},
    "\xff\xfe": {"where": "byte 0", "requirement": "UTF-8"},
}


@pytest.mark.parametrize("text", FAULTY)
def test_a_faulty_file_of_wavelengths_is_refused_by_name(tmp_path, text):
    (tmp_path / "wl.txt").write_bytes(text.encode("latin-1"))
    np.save(tmp_path / "a.npy", CUBE)
    with refused_input(subject=str(tmp_path / "wl.txt"), **FAULTY[text]):
        read_cube(tmp_path / "a.npy", wavelengths=tmp_path / "wl.txt")


@pytest.mark.parametrize(
    "text", ["400\n500\n450\n600\n700", ".4\n.45\n.5\n.6\n.7", "1\n2\n3\n4\n5"]
)
def test_listed_numbers_that_are_not_wavelengths_of_light_are_refused(tmp_path, text):
    (tmp_path / "wl.txt").write_text(text)
    np.save(tmp_path / "a.npy", CUBE)
    with refused_input(subject=str(tmp_path / "a.npy"), setting="wavelengths"):
        read_cube(tmp_path / "a.npy", wavelengths=tmp_path / "wl.txt")


@pytest.mark.parametrize(
    "comment", ["# Headwall camera, 2 um slit", "# FWHM 5 angstrom", "# center in nm, width in um"]
)
def test_a_comment_is_no_unit_of_a_list_of_wavelengths(file, comment):
    path = file(f"{comment}\n450\n700\n", "bands.txt")
    assert read_wavelengths(path, 2).tolist() == [450.0, 700.0]
