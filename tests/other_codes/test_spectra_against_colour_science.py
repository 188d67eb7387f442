"""Our readers against colour-science's, SciPy's and the files that these write."""

from pathlib import Path

import colour
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.io import loadmat, savemat

from chromanoise.io.spectra import Answers, read_curves

REPOSITORY = Path(__file__).parents[2]
SHARED = next(
    (p for p in (REPOSITORY / "shared/data", REPOSITORY.parent / "shared/data") if p.is_dir()), None
)
real_files = pytest.mark.skipif(SHARED is None, reason="needs the real files of shared/data")


def test_a_table_that_colour_science_writes_is_read_as_it_reads_it(tmp_path):
    path = tmp_path / "observer.csv"
    table = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    colour.write_sds_to_csv_file(_by_name(table), str(path))
    theirs = colour.read_sds_from_csv_file(str(path))
    ours = read_curves(path, answers=Answers(quantity="response")).curves
    assert tuple(theirs) == ours.names
    for k, sd in enumerate(theirs.values()):
        assert (sd.wavelengths == ours.wavelength_nm).all()
        assert (sd.values == ours.values[:, k]).all()


def _by_name(table):
    return dict(zip(table.labels, table.to_sds(), strict=True))


@pytest.mark.parametrize("quantity", ["relative", "irradiance", "reflectance"])
def test_a_tm27_that_colour_science_writes_is_read_as_it_reads_it(tmp_path, quantity):
    path = tmp_path / "lamp.spdx"
    lamp = colour.SDS_ILLUMINANTS["FL2"]
    share = 1.0 if quantity != "reflectance" else 0.01
    header = colour.io.Header_IESTM2714(description="FL2", comments="of the CIE")
    written = colour.SpectralDistribution_IESTM2714(
        path=str(path),
        header=header,
        spectral_quantity=quantity,
        data=dict(zip(lamp.wavelengths, share * lamp.values, strict=True)),
    )
    assert written.write()
    theirs = colour.SpectralDistribution_IESTM2714(str(path))
    ours = read_curves(path)
    assert (theirs.wavelengths == ours.curves.wavelength_nm).all()
    assert (theirs.values == ours.curves.values[:, 0]).all()
    assert ours.quantity == {"reflectance": "reflectance"}.get(quantity, "power")


def test_the_tm27_files_that_come_with_colour_science_are_read_alike():
    folder = Path(colour.__file__).parent
    files = [p for p in folder.rglob("*.spdx") if p.stem != "Invalid"]
    if not files:
        pytest.skip("this installation of colour-science has no .spdx")
    for path in files:
        theirs = colour.SpectralDistribution_IESTM2714(str(path))
        ours = read_curves(path).curves
        assert (theirs.wavelengths == ours.wavelength_nm).all()
        assert (theirs.values == ours.values[:, 0]).all()


@real_files
def test_every_real_matlab_file_holds_what_scipy_reads():
    assert SHARED is not None
    files = [p for f in ("sensors", "irfilters", "reflectances", "illuminants")
             for p in sorted((SHARED / f).glob("*.mat"))]  # fmt: skip
    assert len(files) >= 18
    for path in files:
        theirs = loadmat(path, squeeze_me=True)
        ours = read_curves(path).curves
        assert (np.ravel(theirs["wavelength"]) == ours.wavelength_nm).all()
        assert (np.reshape(theirs["data"], ours.values.shape) == ours.values).all()
        if "filterNames" in theirs:
            assert tuple(np.atleast_1d(theirs["filterNames"])) == ours.names


@given(
    st.integers(2, 8),
    st.lists(st.text("RGBWcyan_é 1", min_size=1).map(str.strip).filter(bool), min_size=1,
             max_size=5, unique=True),
    st.booleans(),
    st.data(),
)  # fmt: skip
@settings(max_examples=60)
def test_what_scipy_saves_comes_back_with_its_names(tmp_path_factory, n, names, packed, data):
    values = data.draw(
        st.lists(st.floats(0, 1, width=64), min_size=n * len(names), max_size=n * len(names))
    )
    table = np.reshape(values, (n, len(names)))
    cells = np.empty((1, len(names)), dtype=object)
    cells[0, :] = names
    path = tmp_path_factory.mktemp("mat") / "sensor.mat"
    arrays = {"wavelength": np.arange(n) * 10.0 + 400, "data": table, "filterNames": cells}
    savemat(path, arrays, do_compression=packed)
    ours = read_curves(path, answers=Answers(scale="fraction"))
    assert (ours.curves.values == table).all()
    spread = [name for name in names if name in ours.curves.names]
    assert spread == list(ours.curves.names) == names


@pytest.mark.parametrize("decimals", [3, 6])
def test_a_table_that_numpy_writes_is_read_as_numpy_reads_it(tmp_path, decimals):
    rng = np.random.default_rng(5)
    table = np.column_stack([np.arange(400.0, 700.0, 2.5), rng.random((120, 4))])
    path = tmp_path / "curves.txt"
    np.savetxt(path, table, fmt=f"%.{decimals}e", delimiter="\t", header="nm\tA\tB\tC\tD")
    theirs = np.loadtxt(path)
    ours = read_curves(path).curves
    assert ours.names == ("A", "B", "C", "D")
    assert (np.column_stack([ours.wavelength_nm, ours.values]) == theirs).all()
