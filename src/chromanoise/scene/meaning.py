"""What the numbers of a file are: reflectance or not, in which unit, at which wavelengths."""

import re
from pathlib import Path

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Shaped
from chromanoise.scene.found import Found, Notes
from chromanoise.scene.rows import RowSource, with_bands
from chromanoise.scene.wavelength_file import read_wavelengths

_SHORTEST_NM, _LONGEST_NM = 100.0, 20000.0
_RADIANCE = re.compile(r"radiance|(?<![a-z])rdn(?![a-z])", re.I)
_REFLECTANCE = re.compile(r"reflectance|(?<![a-z])rfl(?![a-z])", re.I)
_WATT = re.compile(r"(?i:radiance|watt)|(?<![A-Za-z])[mun\u00b5\u03bc]?W(?:c?m|[^A-Za-z]|$)")


def scale_and_notes(path: Path | str, found: Found, scale: float | None) -> tuple[float, Notes]:
    """Reflectance per stored unit: the caller's word, else the file's, else 1 for real numbers."""
    radiance = _radiance_words(path, found)
    if scale is not None:
        _check.positive(f"--scale for {path}", "reflectance per stored unit", scale)
        said = (f"{radiance}, but --scale says that it is reflectance",) if radiance else ()
        return float(scale), (*said, f"reflectance = stored x {scale:g}, as --scale says")
    if radiance:
        raise _check.InputError(
            f"{path}: {radiance}, not reflectance; divide it by the illuminant or a white "
            "reference first, or say --scale (reflectance per stored unit) if it is reflectance"
        )
    own = found.scale()
    if own is not None:
        return own, (f"reflectance = stored x {own:g}, as the header says",)
    if found.pixels.dtype.kind in "iu":
        raise _check.InputError(
            f"{path}: stores integers ({found.pixels.dtype.name}) and does not say what they "
            "mean; say --scale (reflectance per stored unit), e.g. 1e-4 for reflectance x 10000"
        )
    return 1.0, ()


def _radiance_words(path: Path | str, found: Found) -> str:
    """Where the file says that it is radiance; empty if nowhere."""
    for where, text in (
        ("file name", Path(path).name),
        ("header's description", found.description),
    ):
        word = _RADIANCE.search(text)
        if word and not _REFLECTANCE.search(text):
            return f"the {where} says radiance ({word[0]!r})"
    if _WATT.search(found.units):
        return f"the header's data units say radiance ({found.units.strip()[:40]!r})"
    return ""


def wavelengths_and_notes(
    path: Path | str, found: Found, said: tuple[float, float] | Path | str | None
) -> tuple[Float[Array, " m"], Notes]:
    """Centers of the bands [nm]: the caller's word, else the file's."""
    bands = found.pixels.shape[2]
    if bands < 2:
        raise _check.InputError(f"{path}: has {bands} band, but a cube needs at least 2")
    if said is not None:
        over = "; those in the file are not used" if found.wavelengths else ""
        if isinstance(said, str | Path):
            return read_wavelengths(Path(said), bands), (f"wavelengths listed in {said}{over}",)
        spread, note = _spread(said, bands)
        return spread, (note + over,)
    if found.wavelengths is None:
        raise _check.InputError(
            f"{path}: does not declare the wavelengths of its {bands} bands; give --wavelengths "
            "FIRST:LAST in nm if they are evenly spaced, or a file that lists them"
        )
    wavelength, notes = found.wavelengths()
    if wavelength.size != bands:
        raise _check.InputError(
            f"{path}: has {bands} bands but {wavelength.size} wavelengths; correct it, or give "
            "--wavelengths FIRST:LAST in nm if they are evenly spaced, or a file that lists them"
        )
    return wavelength, notes


def _spread(ends: tuple[float, float], bands: int) -> tuple[Float[Array, " m"], str]:
    """``bands`` wavelengths evenly from the first to the last. [nm]"""
    first, last = (float(end) for end in ends)
    if first == last or not all(_SHORTEST_NM <= end <= _LONGEST_NM for end in (first, last)):
        raise _check.InputError(
            f"--wavelengths FIRST:LAST must be two different numbers within {_SHORTEST_NM:g} .. "
            f"{_LONGEST_NM:g} nm, but is {first:g}:{last:g}"
        )
    note = f"{bands} wavelengths evenly from {first:g} to {last:g} nm, as --wavelengths says"
    return np.linspace(first, last, bands), note


def rising(
    path: Path | str, pixels: Shaped[Array, "h w m"] | RowSource, wavelength: Float[Array, " m"]
) -> tuple[Shaped[Array, "h w m"] | RowSource, Float[Array, " m"], Notes]:
    """Bands in the order of rising wavelength; a falling order is turned about, no other."""
    _refuse_not_light(path, wavelength)
    if wavelength[-1] >= wavelength[0]:
        _refuse_disorder(path, wavelength, np.diff(wavelength) <= 0)
        return pixels, wavelength, ()
    _refuse_disorder(path, wavelength, np.diff(wavelength) >= 0)
    turned = with_bands(pixels, slice(None, None, -1))
    return turned, wavelength[::-1], ("wavelengths fall: the bands are turned about",)


def _refuse_not_light(path: Path | str, wavelength: Float[Array, " m"]) -> None:
    bad = ~((wavelength >= _SHORTEST_NM) & (wavelength <= _LONGEST_NM))
    if bad.any():
        i = int(np.argmax(bad))
        raise _check.InputError(
            f"{path}: wavelengths must be {_SHORTEST_NM:g} .. {_LONGEST_NM:g} nm, but "
            f"{int(bad.sum())} of {bad.size} are not; the first is {wavelength[i]:g} nm at band "
            f"{i} (from 0); mend them or their unit, or give --wavelengths FIRST:LAST in nm"
        )


def _refuse_disorder(
    path: Path | str, wavelength: Float[Array, " m"], wrong: Shaped[Array, " m-1"]
) -> None:
    if wrong.any():
        i = int(np.argmax(wrong))
        raise _check.InputError(
            f"{path}: wavelengths must rise or fall from band to band, but "
            f"{wavelength[i + 1]:g} nm follows {wavelength[i]:g} nm at band {i + 1} (from 0); "
            "sort the bands and drop repeated ones, or give --wavelengths FIRST:LAST"
        )
