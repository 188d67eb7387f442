"""Wavelengths of a cube: under their usual names in its file, or in a separate text file."""

from pathlib import Path

import numpy as np
import pytest
import scipy.io

from chromanoise.base.errors import InputError
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


def refusal(path, **options):
    with pytest.raises(InputError) as caught:
        read_cube(path, **options)
    text = str(caught.value)
    assert "\n" not in text
    assert str(path) in text
    return text


@every
@pytest.mark.parametrize(
    "listed", ["wl", "Wavelengths", "WAVELENGTH", "wave", "lambda", "bands_nm"]
)
def test_wavelengths_are_found_under_their_usual_names(tmp_path, write, name, listed):
    write(tmp_path / name, reflectance=CUBE, **{listed: np.array(NM)})
    assert read_cube(tmp_path / name).wavelength_nm.tolist() == NM


@every
@pytest.mark.parametrize(
    ("listed", "per_nm"),
    [("wl", 0.001), ("wl_um", 0.001), ("bands_um", 0.001), ("wavelength_angstrom", 10), ("wl", 1)],
)
def test_the_unit_comes_from_the_name_or_from_unambiguous_numbers(
    tmp_path, write, name, listed, per_nm
):
    write(tmp_path / name, reflectance=CUBE, **{listed: np.array(NM) * per_nm})
    np.testing.assert_allclose(read_cube(tmp_path / name).wavelength_nm, NM, rtol=1e-12)


@every
def test_numbers_that_could_be_angstrom_or_nm_are_not_guessed(tmp_path, write, name):
    write(tmp_path / name, reflectance=CUBE, wl=np.array(NM) * 10)
    text = refusal(tmp_path / name)
    assert "'wl'" in text
    assert "4000" in text


def test_a_declared_angstrom_is_a_tenth_of_a_nm(tmp_path):
    write_hdf5(tmp_path / "a.h5", reflectance=CUBE, wl=np.array(NM) * 10)
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        file["wl"].attrs["units"] = "Angstrom"
    np.testing.assert_allclose(read_cube(tmp_path / "a.h5").wavelength_nm, NM, rtol=1e-12)


@every
def test_falling_wavelengths_reverse_the_bands_with_a_note(tmp_path, write, name):
    write(tmp_path / name, reflectance=CUBE, wl=np.array(NM)[::-1])
    cube = read_cube(tmp_path / name)
    assert cube.wavelength_nm.tolist() == NM
    np.testing.assert_array_equal(row_source(cube.stored).rows(0, 3), CUBE[:, :, ::-1])
    assert any("band order reversed" in note for note in cube.notes)


@every
def test_two_lists_that_differ_are_refused_and_both_named(tmp_path, write, name):
    write(tmp_path / name, reflectance=CUBE, wl=np.array(NM), wavelengths=np.array(NM) + 1)
    text = refusal(tmp_path / name)
    assert "'wl'" in text
    assert "'wavelengths'" in text


@every
def test_two_lists_that_agree_are_one(tmp_path, write, name):
    write(tmp_path / name, reflectance=CUBE, wl=np.array(NM), wavelength_um=np.array(NM) / 1000)
    np.testing.assert_allclose(read_cube(tmp_path / name).wavelength_nm, NM, rtol=1e-12)


@every
def test_a_list_of_another_length_is_not_used(tmp_path, write, name):
    write(tmp_path / name, reflectance=CUBE, wl=np.array(NM), wave=np.arange(400.0, 407))
    assert read_cube(tmp_path / name).wavelength_nm.tolist() == NM
    other = tmp_path / f"b{Path(name).suffix}"
    write(other, reflectance=CUBE, wl=np.arange(400.0, 407))
    with refused_input(subject=str(other), value=7, setting="wavelengths"):
        read_cube(other)


@every
@pytest.mark.parametrize("listed", [[400, 500, 450, 600, 700], [400, 450, 450, 600, 700]])
def test_a_list_in_disorder_is_refused(tmp_path, write, name, listed):
    write(tmp_path / name, reflectance=CUBE, wl=np.array(listed, dtype=np.float64))
    with refused_input(subject=str(tmp_path / name), where="band 2 (from 0)", value=450.0):
        read_cube(tmp_path / name)


@every
def test_band_numbers_are_not_wavelengths(tmp_path, write, name):
    write(tmp_path / name, reflectance=CUBE, bands=np.arange(1.0, 6))
    with refused_input(setting="wavelengths"):
        read_cube(tmp_path / name)


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
    "\xff\xfe": {"value": 0, "requirement": "UTF-8"},
}


@pytest.mark.parametrize("text", FAULTY)
def test_a_faulty_file_of_wavelengths_is_refused_by_name(tmp_path, text):
    (tmp_path / "wl.txt").write_bytes(text.encode("latin-1"))
    np.save(tmp_path / "a.npy", CUBE)
    with refused_input(subject=str(tmp_path / "wl.txt"), **FAULTY[text]) as caught:
        read_cube(tmp_path / "a.npy", wavelengths=tmp_path / "wl.txt")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text", ["400\n500\n450\n600\n700", ".4\n.45\n.5\n.6\n.7", "1\n2\n3\n4\n5"]
)
def test_listed_numbers_that_are_not_wavelengths_of_light_are_refused(tmp_path, text):
    (tmp_path / "wl.txt").write_text(text)
    np.save(tmp_path / "a.npy", CUBE)
    refusal(tmp_path / "a.npy", wavelengths=tmp_path / "wl.txt")


@pytest.mark.parametrize(
    "comment", ["# Headwall camera, 2 um slit", "# FWHM 5 angstrom", "# center in nm, width in um"]
)
def test_a_comment_is_no_unit_of_a_list_of_wavelengths(tmp_path, comment):
    path = tmp_path / "bands.txt"
    path.write_text(f"{comment}\n450\n700\n")
    assert read_wavelengths(path, 2).tolist() == [450.0, 700.0]
