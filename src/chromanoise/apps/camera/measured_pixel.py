"""One pixel from all planes of a mosaic, as values and as a file for ``--pixel``.

A characterized camera as the noise model of a sampler of training data.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any

import numpy as np

from chromanoise.apps.camera.characterization import (
    SHARED,
    SPREADS,
    Characterization,
    PlaneNoise,
    by_iso,
)
from chromanoise.base import InputError, Setting
from chromanoise.io.pixels import pixel_source_toml
from chromanoise.sensor import CameraNoise, PixelSource, ReadNoiseTable

_NAMED_PERCENT = 2.0  # planes that differ by more are listed
_BITS = range(8, 17)  # of `chromanoise.sensor.Adc`

Take = Callable[[PlaneNoise], float | None]


def pixel_of(result: Characterization) -> PixelSource:
    """The pixel of a camera from all planes of its mosaic; the notes state how, with the spread.

    Parameters
    ----------
    result
        A characterization.

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
    planes, source = result.planes, _source_name(result)
    notes: list[str] = []
    gain = _mean(planes, "gain", "DN/e-", "gain_dn_per_e")
    read = _mean(
        planes,
        "read noise",
        "e-",
        "dark_noise_e",
        lambda p: read_noise_e(p, *(getattr(p, name) for name in SHARED)),
    )
    current = _mean(planes, "dark current", "e-/s", "dark_current_e_per_s")
    black = _mean(planes, "black level", "DN", "black_level_dn")
    spreads = {
        name: _root_mean_square(
            planes, one.label, "of the signal" if one.unit == "1" else one.unit, attrgetter(name)
        )
        for name, one in SPREADS.items()
    }
    well = _lowest(planes, "full well", "e-", lambda p: p.full_well_e)
    merged = [one.note for one in (gain, read, well, current, *spreads.values(), black) if one]
    notes.append(f"{source}: {'; '.join(merged)}")
    shared = [spreads[name] for name in SHARED]
    if any(one is not None and one.value > 0 for one in shared) and read is not None:
        notes.append(f"{source}: the read noise excludes row and column noise")
    values: dict[str, Any] = {name: _value(one) for name, one in spreads.items()}
    whole = _whole_black(black, source, notes)
    return PixelSource(
        source=source,
        full_well_e=_value(well),
        read_noise_e=_value(read),
        gain_e_per_dn=None if gain is None else 1 / gain.value,
        bits=_bits(result.bits, source, notes),
        black_level_dn=whole,
        dark_current_e_per_s=_current(current, source, notes),
        **values,
        qe=_qe(planes, source, notes),
        notes=(*notes, *_verdict(result, source)),
    )


def pixel_toml(result: Characterization) -> str:
    """The pixel of `pixel_of` as TOML, which ``--pixel FILE`` takes.

    Parameters
    ----------
    result
        A characterization.

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
    known = [one for one in values if one is not None and math.isfinite(one)]
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


@dataclass(frozen=True, slots=True)
class _Merged:
    value: float
    note: str


def _source_name(result: Characterization) -> str:
    iso = "" if result.iso is None else f", ISO {result.iso:g}"
    return f"{result.camera or result.source}{iso}"


def _value(merged: _Merged | None) -> float | None:
    return None if merged is None else merged.value


def _known(planes: Sequence[PlaneNoise], take: Take) -> list[tuple[PlaneNoise, float]]:
    found = [(plane, take(plane)) for plane in planes]
    return [(plane, float(v)) for plane, v in found if v is not None and math.isfinite(v)]


def _mean(
    planes: Sequence[PlaneNoise], name: str, unit: str, field: str, take: Take | None = None
) -> _Merged | None:
    """The mean of a field, or of what is taken from it, by the standard errors of the field."""
    known = _known(planes, take or attrgetter(field))
    if not known:
        return None
    errors = [getattr(plane, f"{field}_se") for plane, _ in known]
    found = [float(one) for one in errors if one is not None and one > 0]
    weighted = len(found) == len(known)
    weights = [1 / one**2 for one in found] if weighted else [1.0] * len(known)
    value = sum(w * v for w, (_, v) in zip(weights, known, strict=True)) / sum(weights)
    if len(known) == 1:
        value = known[0][1]
    how = "weighted mean" if weighted else "plain mean, as an error is not known"
    error_text = f" +- {1 / math.sqrt(sum(weights)):.2g}" if weighted else ""
    return _Merged(value, f"{name} {value:.5g}{error_text} {unit}{_spread(known, how)}")


def _root_mean_square(
    planes: Sequence[PlaneNoise], name: str, unit: str, take: Take
) -> _Merged | None:
    known = _known(planes, take)
    value = root_mean_square([one for _, one in known])
    if value is None:
        return None
    return _Merged(value, f"{name} {value:.4g} {unit}{_spread(known, 'root mean square')}")


def _lowest(planes: Sequence[PlaneNoise], name: str, unit: str, take: Take) -> _Merged | None:
    known = _known(planes, take)
    if not known:
        return None
    plane, value = min(known, key=lambda one: one[1])
    return _Merged(
        value, f"{name} {value:.5g} {unit}{_spread(known, f'that of {plane.name}, the lowest')}"
    )


def _spread(known: Sequence[tuple[PlaneNoise, float]], how: str) -> str:
    """How the planes were merged, and by how much they differ; nothing for one plane."""
    values = [value for _, value in known]
    size = abs(sum(values)) / len(values)
    if len(known) == 1 or not size or max(values) == min(values):
        return ""
    percent = 100 * (max(values) - min(values)) / size
    listed = ", ".join(f"{plane.name} {value:.4g}" for plane, value in known)
    named = f": {listed}" if percent > _NAMED_PERCENT else ""
    return f" ({how}, the planes differ by {percent:.2g} %{named})"


def _whole_black(black: _Merged | None, source: str, notes: list[str]) -> int | None:
    if black is None:
        return None
    if black.value < 0:
        notes.append(f"{source}: a black level below 0 is not used")
        return None
    whole = round(black.value)
    if whole != black.value:
        notes.append(f"{source}: black level of {black.value:.6g} DN rounded to {whole}")
    return whole


def _bits(bits: int | None, source: str, notes: list[str]) -> int | None:
    if bits is None or bits in _BITS:
        return bits
    notes.append(f"{source}: {bits} bits are outside 8 to 16 and not used")
    return None


def _current(current: _Merged | None, source: str, notes: list[str]) -> float | None:
    if current is None or current.value >= 0:
        return _value(current)
    notes.append(f"{source}: the dark current is negative, but not significantly: using 0")
    return 0.0


def _qe(planes: Sequence[PlaneNoise], source: str, notes: list[str]) -> float | None:
    known = _known(planes, lambda plane: plane.qe)
    if not known:
        return None
    if len(planes) > 1:
        listed = ", ".join(f"{plane.name} {qe:.4g}" for plane, qe in known)
        notes.append(
            f"{source}: QE differs between the planes ({listed}) and is left out of the pixel"
        )
        return None
    if not 0 <= known[0][1] <= 1:
        notes.append(f"{source}: a QE of {known[0][1]:.4g} is impossible and not used")
        return None
    return known[0][1]


def _verdict(result: Characterization, source: str) -> list[str]:
    if result.verdict.holds:
        return []
    return [f"{source}: the linear model does not hold: {s}" for s in result.verdict.sentences]


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
        As `by_iso` for several results, if there is none, if a plane has no dark noise or black
        level, or if the bits are not known.

    Notes
    -----
    EMVA 1288, release 4.0: the temporal dark noise includes the row noise.
    """
    every = [results] if isinstance(results, Characterization) else list(results)
    if len(every) == 1:
        return _camera(every[0])
    by_iso(every)
    cameras = [_camera(one) for one in every]
    cameras_by_gain = sorted(cameras, key=lambda one: float(one.gain_dn_per_e.mean()))
    gains = [float(one.gain_dn_per_e.mean()) for one in cameras_by_gain]
    noise_dn = [float((one.read_noise_e * one.gain_dn_per_e).mean()) for one in cameras_by_gain]

    def table(values_dn: Sequence[float]) -> ReadNoiseTable | None:
        if not any(values_dn):
            return None
        least = [_LEAST_SHARE * one for one in noise_dn]
        values = np.maximum(values_dn, least)
        return ReadNoiseTable(  # single planes at the ends have gains a little beyond the means
            gain_dn_per_e=np.array([gains[0] / _BEYOND, *gains, gains[-1] * _BEYOND]),
            read_noise_dn=np.array([values[0], *values, values[-1]]),
        )

    pairs = list(zip(cameras_by_gain, gains, strict=True))
    wells = [one.full_well_e for one in cameras if one.full_well_e is not None]
    laws: dict[str, Any] = {
        f"{name.removesuffix('_e')}_law": table([getattr(one, name) * gain for one, gain in pairs])
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
    return CameraNoise(
        names=tuple(plane.name for plane in planes),
        mosaic=result.mosaic,
        iso=result.iso,
        gain_dn_per_e=np.array([plane.gain_dn_per_e for plane in planes]),
        read_noise_e=np.array(
            [
                _known_value(plane, "dark_noise_e", read_noise_e(plane, *shared_e))
                for plane in planes
            ]
        ),
        black_level_dn=np.array(
            [_known_value(plane, "black_level_dn", plane.black_level_dn) for plane in planes]
        ),
        top_code_dn=float(2**result.bits - 1),
        full_well_e=min(wells) if wells else None,
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
