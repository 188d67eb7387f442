"""A characterized camera as one pixel, as a file for ``--pixel``, and as the noise of a sampler.

The pixel is derived from all planes of a mosaic; the sampler adds noise to training data.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import Any

import numpy as np

from chromanoise.apps.camera.characterization import (
    SHARED,
    SPREADS,
    Characterization,
    PlaneNoise,
    by_iso,
    several,
)
from chromanoise.base import InputError, Setting, defined
from chromanoise.io.pixels import pixel_source_toml
from chromanoise.sensor import CameraNoise, PixelSource, ReadNoiseTable

_NAMED_PERCENT = 2.0  # planes that differ by more are listed
_BITS = range(8, 17)  # of `chromanoise.sensor.Adc`

Known = list[tuple[PlaneNoise, float]]
"""The planes of which a value is known, and the values."""


def pixel_of(result: Characterization) -> PixelSource:
    """The pixel of a camera from all planes of its mosaic; the notes state how, with the spread.

    Returns
    -------
    PixelSource
        Gain, read noise, dark current and black level are means over the planes, weighted by the
        inverse squares of their standard errors, or plain means where an error is not known; DSNU,
        PRNU, row noise and column noise are root mean squares; the full well is the lowest. QE is
        that of a monochrome sensor only, because the planes of a mosaic differ. The pitch is not
        known.

    Raises
    ------
    InputError
        If there are no planes.

    Notes
    -----
    The temporal dark noise of EMVA 1288 includes the noise that a row or a column shares; a `Pixel`
    has row and column noise besides its read noise: read noise^2 = sigma_d^2 - row^2 - column^2.
    """
    if not result.planes:
        raise InputError(result.source, "must have at least one plane", value=0)
    planes = result.planes
    iso = "" if result.iso is None else f", ISO {result.iso:g}"
    source = f"{result.camera or result.source}{iso}"
    known = {name: _known(planes, name) for name in _MERGED}
    found = {name: _merged(known[name], name, *how) for name, how in _MERGED.items() if known[name]}
    values: dict[str, Any] = {name: value for name, (value, _) in found.items()}
    notes = ["; ".join(note for _, note in found.values())]
    if any(values.get(name, 0.0) > 0 for name in SHARED) and "dark_noise_e" in values:
        notes.append("the read noise excludes row and column noise")
    black, current = values.pop("black_level_dn", None), values.pop("dark_current_e_per_s", None)
    gain, read = values.pop("gain_dn_per_e", None), values.pop("dark_noise_e", None)
    whole = None if black is None or black < 0 else round(black)
    if black is not None and whole is None:
        notes.append("a black level below 0 is not used")
    elif black is not None and whole != black:
        notes.append(f"black level of {black:.6g} DN rounded to {whole}")
    bits = result.bits if result.bits in _BITS else None
    if result.bits is not None and bits is None:
        notes.append(f"{result.bits} bits are outside 8 to 16 and not used")
    if current is not None and current < 0:
        notes.append("the dark current is negative, but not significantly: using 0")
        current = 0.0
    qe = _qe(planes, notes)
    if not result.verdict.holds:
        notes += [f"the linear model does not hold: {one}" for one in result.verdict.sentences]
    return PixelSource(
        source=source,
        read_noise_e=read,
        gain_e_per_dn=None if gain is None else 1 / gain,
        bits=bits,
        black_level_dn=whole,
        dark_current_e_per_s=current,
        **values,
        qe=qe,
        notes=tuple(f"{source}: {note}" for note in notes),
    )


def pixel_toml(result: Characterization) -> str:
    """The pixel of `pixel_of` as TOML, which ``--pixel FILE`` takes.

    Raises
    ------
    InputError
        As `pixel_of`.
    """
    return pixel_source_toml(pixel_of(result))


def root_mean_square(values: Sequence[float | None]) -> float | None:
    """Root of the mean square of the known values: the noise of all planes together.

    Values that are ``None`` or not finite are left out; ``None`` if none is known.

    Examples
    --------
    >>> root_mean_square([1.0, 7.0, None]), root_mean_square([None])
    (5.0, None)
    """
    known = [one for one in map(defined, values) if one is not None]
    if len(known) < 2:
        return known[0] if known else None
    return math.sqrt(sum(one**2 for one in known) / len(known))


def read_noise_e(plane: PlaneNoise, *shared_e: float | None) -> float | None:
    """Temporal dark noise without row and column noise; ``None`` if it is not known. [e-]

    Parameters
    ----------
    plane
        Its dark noise includes that of rows and columns (EMVA 1288, release 4.0).
    shared_e
        The noise of rows and of columns that a model has besides; ``None`` for none. [e-]
    """
    if plane.dark_noise_e is None:
        return None
    shared_e2 = sum((one or 0.0) ** 2 for one in shared_e)
    return math.sqrt(max(plane.dark_noise_e**2 - shared_e2, 0.0))


def _mean(known: Known, field: str) -> tuple[float, str, str]:
    """The mean of what is known, by the standard errors of a field, with its error as text."""
    errors = [getattr(plane, f"{field}_se") for plane, _ in known]
    weighted = all(one is not None and one > 0 for one in errors)
    weights = [1 / one**2 if weighted else 1.0 for one in errors]
    value = sum(w * v for w, (_, v) in zip(weights, known, strict=True)) / sum(weights)
    error = f" +- {1 / math.sqrt(sum(weights)):.2g}" if weighted else ""
    how = "weighted mean" if weighted else "plain mean, as an error is not known"
    return known[0][1] if len(known) == 1 else value, how, error


def _root_mean_square(known: Known, _: str) -> tuple[float, str, str]:
    return root_mean_square([one for _, one in known]) or 0.0, "root mean square", ""


def _lowest(known: Known, _: str) -> tuple[float, str, str]:
    plane, value = min(known, key=itemgetter(1))
    return value, f"that of {plane.name}, the lowest", ""


_MERGED: Mapping[str, tuple[str, str, int, Callable[[Known, str], tuple[float, str, str]]]] = {
    "gain_dn_per_e": ("gain", "DN/e-", 5, _mean),
    "dark_noise_e": ("read noise", "e-", 5, _mean),
    "full_well_e": ("full well", "e-", 5, _lowest),
    "dark_current_e_per_s": ("dark current", "e-/s", 5, _mean),
    **{
        name: (one.label, "of the signal" if one.unit == "1" else one.unit, 4, _root_mean_square)
        for name, one in SPREADS.items()
    },
    "black_level_dn": ("black level", "DN", 5, _mean),
}
"""Of each merged field: name, unit and digits in the note, and how the planes are merged."""


def _merged(
    known: Known,
    field: str,
    name: str,
    unit: str,
    digits: int,
    merge: Callable[[Known, str], tuple[float, str, str]],
) -> tuple[float, str]:
    """One value of all planes, and a note on how they were merged."""
    value, how, error = merge(known, field)
    return value, f"{name} {value:.{digits}g}{error} {unit}{_spread(known, how)}"


def _known(planes: Sequence[PlaneNoise], field: str) -> Known:
    """The planes of which a value is known; of the dark noise, the read noise."""

    def value_of(plane: PlaneNoise) -> float | None:
        if field == "dark_noise_e":
            return read_noise_e(plane, *(getattr(plane, name) for name in SHARED))
        value: float | None = getattr(plane, field)
        return value

    return [(plane, value) for plane in planes if (value := defined(value_of(plane))) is not None]


def _spread(known: Known, how: str) -> str:
    """How the planes were merged, and by how much they differ; nothing for one plane."""
    values = [value for _, value in known]
    size = abs(sum(values)) / len(values)
    if len(known) == 1 or not size or max(values) == min(values):
        return ""
    percent = 100 * (max(values) - min(values)) / size
    listed = ", ".join(f"{plane.name} {value:.4g}" for plane, value in known)
    named = f": {listed}" if percent > _NAMED_PERCENT else ""
    return f" ({how}, the planes differ by {percent:.2g} %{named})"


def _qe(planes: Sequence[PlaneNoise], notes: list[str]) -> float | None:
    known = _known(planes, "qe")
    if not known:
        return None
    value = known[0][1]
    if len(planes) > 1:
        listed = ", ".join(f"{plane.name} {qe:.4g}" for plane, qe in known)
        notes.append(f"QE differs between the planes ({listed}) and is left out of the pixel")
    elif not 0 <= value <= 1:
        notes.append(f"a QE of {value:.4g} is impossible and not used")
    return value if len(planes) == 1 and 0 <= value <= 1 else None


_BEYOND = 1.25  # factor of the gain by which the table goes beyond the settings measured
_LEAST_SHARE = 1e-3  # of the read noise: what a noise of 0 counts as in a table of logarithms


def camera_noise(results: Characterization | Sequence[Characterization]) -> CameraNoise:
    """The noise model of a camera from its frames at one ISO setting, or at several.

    Parameters
    ----------
    results
        One characterization, or one per ISO setting. The first one gives gain, black levels, dark
        current and PRNU; with several, read, row and column noise and DSNU at other settings are
        interpolated between the means over the planes, and the largest full well is used, because
        at a high ISO the largest code is reached before the full well.

    Returns
    -------
    CameraNoise
        Its channels are the planes. The read noise is the dark noise without that of rows
        and columns.
        The dark current is the mean over the planes; DSNU, PRNU, row and column noise are root mean
        squares, as in `pixel_of`; 0 where not measured.

    Raises
    ------
    InputError
        As ``by_iso`` for several results, if there is none, if a plane has no dark noise or black
        level, or if the bits are not known.

    Notes
    -----
    EMVA 1288, release 4.0: the temporal dark noise includes the row noise.
    """
    every = several(results)
    if len(every) == 1:
        return _camera(every[0])
    by_iso(every)
    cameras = [_camera(one) for one in every]
    pairs = sorted([(float(one.gain_dn_per_e.mean()), one) for one in cameras], key=itemgetter(0))
    gains = [gain for gain, _ in pairs]
    noise_dn = [float((one.read_noise_e * one.gain_dn_per_e).mean()) for _, one in pairs]

    def table(values_dn: Sequence[float]) -> ReadNoiseTable | None:
        if not any(values_dn):
            return None
        least = [_LEAST_SHARE * one for one in noise_dn]
        values = np.maximum(values_dn, least)
        return ReadNoiseTable(  # single planes at the ends have gains a little beyond the means
            gain_dn_per_e=np.array([gains[0] / _BEYOND, *gains, gains[-1] * _BEYOND]),
            read_noise_dn=np.array([values[0], *values, values[-1]]),
        )

    wells = [one.full_well_e for one in cameras if one.full_well_e is not None]
    laws: dict[str, Any] = {
        f"{name.removesuffix('_e')}_law": table([getattr(one, name) * gain for gain, one in pairs])
        for name in SPREADS
        if SPREADS[name].unit == "e-"
    }
    return replace(
        cameras[0],
        full_well_e=max(wells, default=None),
        read_noise_law=table(noise_dn),
        **laws,
    )


def _camera(result: Characterization) -> CameraNoise:
    if result.bits is None:
        raise InputError(
            f"characterization of {result.source}",
            "must state the bits of the codes",
            found="does not",
            remedy=Setting("bits"),
        )
    planes = result.planes
    spreads: dict[str, Any] = {
        name: root_mean_square([getattr(plane, name) for plane in planes]) or 0.0
        for name in SPREADS
    }
    shared_e = [spreads[name] for name in SHARED]
    currents = [one.dark_current_e_per_s for one in planes if one.dark_current_e_per_s is not None]
    wells = [plane.full_well_e for plane in planes if plane.full_well_e is not None]
    reads = [_known_value(one, "dark_noise_e", read_noise_e(one, *shared_e)) for one in planes]
    blacks = [_known_value(one, "black_level_dn", one.black_level_dn) for one in planes]
    return CameraNoise(
        names=tuple(plane.name for plane in planes),
        mosaic=result.mosaic,
        iso=result.iso,
        gain_dn_per_e=np.array([plane.gain_dn_per_e for plane in planes]),
        read_noise_e=np.array(reads),
        black_level_dn=np.array(blacks),
        top_code_dn=float(2**result.bits - 1),
        full_well_e=min(wells, default=None),
        dark_current_e_per_s=max(0.0, float(np.mean(currents))) if currents else 0.0,
        **spreads,
    )


def _known_value(plane: PlaneNoise, name: str, value: float | None) -> float:
    if value is None:
        raise InputError(
            name,
            "must be known for a noise model",
            where=f"plane {plane.name}",
            found="is not",
            remedy="characterize the camera with dark frames",
        )
    return value
