"""MATLAB files of ISETCam (``wavelength``, ``data``), of Psychtoolbox and of camera databases."""

import math
from pathlib import Path

import numpy as np

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.io.matlab import mat_array, mat_arrays, mat_texts
from chromanoise.io.spectra.parsed import LARGEST, Found, Quantity, known_columns, missing_notes

_LARGEST_BYTES = 32 * 2**20
_WAVELENGTHS = ("wavelength", "wavelength_nm", "wave")
_WORDS = ("comment", "units", "type", "name")
_MOST_CURVES = 2000
_OF_PSYCHTOOLBOX: dict[str, Quantity | None] = {
    "T": None, "spd": "power", "sur": "reflectance", "srf": "reflectance"
}  # fmt: skip
_JIANG_NM = np.arange(400.0, 721.0, 10.0)


def read_isetcam(path: Path) -> Found:
    """Read the curves of a MATLAB file, with their names and other texts.

    Raises
    ------
    InputError
        If it lacks ``wavelength`` or ``data``, or these do not fit each other, and it is not a
        file of Psychtoolbox or a camera of the database of Jiang et al. either.
    """
    arrays = mat_arrays(path)
    if all(name in arrays for name in "rgb") and not any(w in arrays for w in _WAVELENGTHS):
        return _camera_of_jiang(path, arrays)
    at_name = next((name for name in _WAVELENGTHS if name in arrays), None)
    sampled = [name for name in arrays if name.partition("_")[0] in _OF_PSYCHTOOLBOX]
    if at_name is None and sampled and f"S_{sampled[0].partition('_')[2]}" in arrays:
        return _of_psychtoolbox(path, arrays, sampled)
    if at_name is None or "data" not in arrays:
        held = ", ".join(list(arrays)[:20]) or "no arrays"
        raise InputError(
            str(path),
            "must have the arrays wavelength and data, as ISETCam writes them, or S_name and "
            "T_name, spd_name or sur_name, as Psychtoolbox writes them",
            value=tuple(arrays),
            found=f"has {held}",
        )
    wavelength = _real(path, at_name, arrays[at_name]).ravel()
    if np.isnan(wavelength).any():
        remedy = ("correct it", "remove it")
        raise _of_nan(path, "has NaN", f"array {at_name!r}", remedy)
    data = _upright(path, _real(path, "data", arrays["data"]), wavelength.size)
    n = wavelength.size
    square = f"data is {n} by {n}: its rows are taken for wavelengths, its columns for curves"
    words = {w: mat_texts(path, w, largest_bytes=_LARGEST_BYTES) for w in _WORDS if w in arrays}
    names, notes = _names(path, arrays, data.shape[1], words.get("name", ()))
    text = " ".join(" ".join(texts) for texts in words.values())
    curves = list(zip(names, data.T, strict=True))
    comment = " ".join(" ".join(words.get("comment", ())).split())
    return Found(
        source=str(path),
        format="ISETCam MAT",
        columns=known_columns(wavelength, curves),
        words=text,
        # comment and name are free text
        keys={
            key: " ".join(words[field])
            for key, field in (("quantity", "type"), ("unit", "units"))
            if field in words
        },
        per="photon" if words.get("units") == ("photons",) else None,
        defects=missing_notes(wavelength, curves, "values that are no number (NaN)"),
        notes=(
            *notes,
            *([square] if data.shape[1] == n else ()),
            *((f"the file says: {comment}",) if comment else ()),
        ),
    )


def _of_psychtoolbox(path: Path, arrays: dict, sampled: list[str]) -> Found:
    """The curves of one array, whose wavelengths are ``S_name = [start, step, count]`` in nm.

    Notes
    -----
    Psychtoolbox, PsychColorimetricData: arrays ``T_`` have one curve per row, and ``spd_``,
    ``sur_`` and ``srf_`` (powers and reflectances) one per column.
    """
    if len(sampled) > 1:
        raise InputError(
            str(path),
            "must have one array of curves",
            value=tuple(sampled),
            found=f"has {', '.join(sampled[:8])}",
            remedy="save one of them with its S_ array",
        )
    kind, _, rest = sampled[0].partition("_")
    sampling = _real(path, f"S_{rest}", arrays[f"S_{rest}"]).ravel()
    if sampling.size != 3 or sampling[0] <= 0 or sampling[1] <= 0 or sampling[2] < 2:
        raise InputError(
            str(path),
            "must be the first wavelength, the step and the number of wavelengths",
            value=tuple(sampling.tolist()[:5]),
            where=f"array 'S_{rest}'",
        )
    data = _real(path, sampled[0], arrays[sampled[0]])
    if kind == "T":
        data = data.T
    if data.shape[0] != sampling[2] or data.shape[1] > _MOST_CURVES:
        raise InputError(
            str(path),
            f"must have {sampling[2]:g} wavelengths, as S_{rest} declares",
            value=data.shape[0],
            where=f"array {sampled[0]!r}",
        )
    quantity = _OF_PSYCHTOOLBOX[kind]
    at = sampling[0] + sampling[1] * np.arange(data.shape[0])
    names = [rest] if data.shape[1] == 1 else map(str, range(1, data.shape[1] + 1))
    return Found(
        source=str(path),
        format="Psychtoolbox MAT",
        columns=known_columns(at, zip(names, data.T, strict=True)),
        wavelength_unit="nm",
        quantity=quantity,
        per="energy" if quantity == "power" else None,
    )


def _camera_of_jiang(path: Path, arrays: dict) -> Found:
    """The sensitivities ``r``, ``g``, ``b``, whose wavelengths are given only in the paper.

    Notes
    -----
    Jiang, Liu, Gu & Suesstrunk, "What is the space of spectral sensitivity functions for digital
    color cameras?" (WACV 2013): 400-720 nm in steps of 10 nm, the raw value divided by the radiance
    and the exposure time, so light is counted as energy; each camera's highest value is 1.
    """
    curves = {name: _real(path, name, arrays[name]).ravel() for name in "rgb"}
    if any(curve.size != _JIANG_NM.size for curve in curves.values()):
        sizes = tuple(curve.size for curve in curves.values())
        raise InputError(
            str(path),
            "must have an array of wavelengths",
            value=sizes,
            found=f"has only r, g and b of {', '.join(map(str, sizes))} values",
            remedy=(
                "add an array 'wavelength'",
                "save it as CSV",
                f"give r, g and b {_JIANG_NM.size} values for 400-720 nm in steps of 10 nm, as "
                "in the database of Jiang et al.",
            ),
        )
    if not all(np.isfinite(curve).all() for curve in curves.values()):
        raise _of_nan(path, "have NaN", "arrays r, g, b", ("correct them",))
    return Found(
        source=str(path),
        format="MATLAB, a camera of Jiang et al. (2013)",
        columns=known_columns(_JIANG_NM, zip("RGB", curves.values(), strict=True)),
        wavelength_unit="nm",
        quantity="response",
        per="energy",
        level="relative",
        notes=(
            "the file has no wavelengths: r, g, b of 33 values each are taken as from the camera "
            "database of Jiang et al. (WACV 2013), 400-720 nm in steps of 10 nm, per energy",
        ),
    )


def _of_nan(path: Path, found: str, where: str, remedy: tuple[str, ...]) -> InputError:
    need = "must be finite numbers"
    return InputError(str(path), need, value=math.nan, found=found, where=where, remedy=remedy)


def _real(path: Path, name: str, declared: tuple[tuple[int, ...], np.dtype]) -> Array:
    (shape, dtype), where = declared, f"array {name!r}"
    if dtype.kind not in "fiu" or len(shape) != 2 or min(shape) < 1:
        need = "must be a table of real numbers"
        found = f"has the shape {shape} and the type {dtype}"
        raise InputError(str(path), need, value=(shape, str(dtype)), found=found, where=where)
    if math.prod(shape) * 8 > _LARGEST_BYTES:
        need = f"must be at most {_LARGEST_BYTES // 2**20} MiB for a table of spectra"
        found = f"has the shape {shape}"
        raise InputError(str(path), need, value=shape, found=found, where=where)
    array = mat_array(path, name, largest_bytes=_LARGEST_BYTES).astype(np.float64)
    beyond = np.abs(array) > LARGEST
    if beyond.any():
        value = float(array[beyond][0])
        need, remedy = "must be at most 1e30", "correct it"
        raise InputError(str(path), need, value=value, where=where, remedy=remedy)
    return array


def _upright(path: Path, data: Array, n: int) -> Array:
    """One row per wavelength."""
    if data.shape[0] != n and data.shape[1] == n:
        data = data.T
    if data.shape[0] != n or data.shape[1] > _MOST_CURVES:
        raise InputError(
            str(path),
            f"must have {n} rows, as many as wavelengths",
            value=data.shape,
            found=f"is {data.shape[0]} by {data.shape[1]}",
            where="array 'data'",
        )
    return data


def _names(
    path: Path, arrays: dict, curves: int, own: tuple[str, ...]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    if "filterNames" in arrays:
        names = mat_texts(path, "filterNames", largest_bytes=_LARGEST_BYTES)
        if len(names) == curves and all(names):
            return names, ()
        numbered = tuple(str(k + 1) for k in range(curves))
        return numbered, (f"{len(names)} names for {curves} curves: the curves are numbered",)
    if curves == 1:
        return (own[0] if own and own[0] else path.stem,), ()
    return tuple(str(k + 1) for k in range(curves)), ()
