"""Arrays in MATLAB files of version 5 (``save -v7`` and before)."""

from pathlib import Path

import numpy as np
from jaxtyping import Shaped

from chromanoise import _check

Array = np.ndarray

_HDF5 = b"\x89HDF\r\n\x1a\n"
_DTYPES = {
    "double": "f8", "single": "f4", "logical": "?", "char": "U1",
    "int8": "i1", "int16": "i2", "int32": "i4", "int64": "i8",
    "uint8": "u1", "uint16": "u2", "uint32": "u4", "uint64": "u8",
}  # fmt: skip


def mat_arrays(path: Path) -> dict[str, tuple[tuple[int, ...], np.dtype]]:
    """Shape and type of every variable, numbers unread; cells and structs count as objects.

    Raises
    ------
    InputError
        If the file is of another MATLAB version.
    """
    from scipy.io import whosmat

    _refuse_other_versions(path)
    return {
        name: (tuple(int(n) for n in shape), np.dtype(_DTYPES.get(kind, "O")))
        for name, shape, kind in whosmat(str(path), appendmat=False)
    }


def mat_array(path: Path, name: str) -> Shaped[Array, "..."]:
    """The numbers of one variable, in MATLAB's type."""
    from scipy.io import loadmat

    read = loadmat(str(path), appendmat=False, variable_names=[name], mat_dtype=True)
    array = read.get(name)
    if not isinstance(array, np.ndarray):
        raise _check.InputError(f"{path}: the array {name!r} cannot be read; the file is damaged")
    return array


def _refuse_other_versions(path: Path) -> None:
    from scipy.io.matlab import matfile_version

    with path.open("rb") as file:
        start = file.read(520)
    hdf5 = start.startswith(_HDF5) or start[512:] == _HDF5
    major = 2 if hdf5 else matfile_version(str(path), appendmat=False)[0]
    if major == 2:
        raise _check.InputError(
            f"{path}: MATLAB 7.3 files (HDF5) are not read here; save it with -v7, or convert it "
            "to .npz or ENVI"
        )
    if major != 1:
        raise _check.InputError(
            f"{path}: not a MATLAB file of version 5; save it with -v7, or convert it to .npz"
        )
