"""Sensors in files: this library's JSON, written and read, and tables of quantum efficiencies.

Spectra are also written in this JSON.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, cast, get_args

import numpy as np

from chromanoise.base import Remedy, Setting, __version__, check, json_text, kept
from chromanoise.io.curve_files import read_curves
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.interpretation import FRACTION_AT_MOST
from chromanoise.io.spectra.parsed import (
    ASK,
    SCHEMA_VERSION,
    SPECTRA_SCHEMA,
    Answers,
    Found,
    ParsedSpectra,
    array_of,
    held_json,
    number_of,
    own_json,
    word_of,
    words_of,
)
from chromanoise.io.spectra.questions import qe_of
from chromanoise.sensor import PIXEL, PIXEL_REQUIRED, Converter, Mosaic, Origin, Pixel, Sensor
from chromanoise.spectra import (
    SMALL_NEGATIVES,
    Beyond,
    Grid,
    Spectra,
    means_on_grid,
    read_spectra_csv,
    refuse_outside,
    used_on_grid,
)

_SENSOR_SCHEMA = "chromanoise sensor"
_COUNTS = tuple(field.name for field in fields(Pixel) if field.name not in PIXEL)
_LARGEST_GRID = 1_000_000


def spectra_json(spectra: Spectra, facts: Mapping[str, str] | None = None) -> str:
    """All data of the spectra, in the form that `read_curves` reads.

    Parameters
    ----------
    spectra
        The spectra to write.
    facts
        Other facts: level, per and scale, with the values of `Found`.
    """
    return json_text(
        {
            "schema": SPECTRA_SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "version": __version__,
            "quantity": spectra.quantity,
            "unit": spectra.unit,
            **(facts or {}),
            "source": spectra.source,
            "notes": list(spectra.notes),
            "names": list(spectra.names),
            "wavelength_nm": spectra.wavelength_nm.tolist(),
            "values": spectra.values.tolist(),
        },
        indent=1,
    )


def sensor_json(sensor: Sensor) -> str:
    """The JSON of `sensor_data`; `sensor_from_json` reads it."""
    return json_text(sensor_data(sensor), indent=1)


def sensor_data(sensor: Sensor) -> dict[str, Any]:
    """All data of the sensor, with all digits.

    Raises
    ------
    InputError
        If its pixel has noise sources of its own, which a file does not hold.
    """
    grid, pixel = sensor.grid, sensor.pixel
    if pixel.own_noise:
        need = "must have no noise sources of its own to be written"
        remedy = "write the sensor with a Pixel of chromanoise"
        raise refused(
            f"sensor {sensor.name}", need, [one.cause for one in pixel.own_noise], remedy=remedy
        )
    return {
        "schema": _SENSOR_SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "version": __version__,
        "name": sensor.name,
        "origin": sensor.origin,
        "notes": list(sensor.notes),
        "stacked": sensor.stacked,
        "mosaic": [list(row) for row in sensor.mosaic.pattern] if sensor.mosaic else None,
        "pixel": {
            **{
                field.name: value
                for field in fields(pixel)
                if (value := getattr(pixel, field.name)) != field.default
            },
            **sensor.converter.known,
        },
        "grid_nm": {"start": grid.start_nm, "stop": grid.stop_nm, "step": grid.step_nm},
        "channels": list(sensor.names),
        "qe": sensor.qe.tolist(),
    }


def sensor_from_json(text: str, *, source: str = "sensor") -> Sensor:
    """Read the sensor from text of `sensor_json`.

    Raises
    ------
    InputError
        If the text is not JSON, has another schema or version, or the sensor is invalid.
    """
    held = held_json(text, _SENSOR_SCHEMA, source=source)
    with own_json(source, "sensor"):
        grid, pixel, mosaic = held["grid_nm"], held["pixel"], held["mosaic"]
        required = {name: number_of(pixel[name]) for name in PIXEL_REQUIRED}
        own = Grid(*(number_of(grid[key]) for key in ("start", "stop", "step")))
        if own.n > _LARGEST_GRID:
            raise refused(
                source, f"must be at most {_LARGEST_GRID} wavelengths", own.n, where="key 'grid_nm'"
            )
        return Sensor(
            name=word_of(held["name"]),
            grid=own,
            qe=array_of(held["qe"], 2),
            names=words_of(held["channels"]),
            pixel=Pixel(
                **_held(pixel, PIXEL, number_of) | required,
                **_held(pixel, _COUNTS, _whole),
            ),
            converter=Converter(
                **_held(pixel, ("gain_e_per_dn",), number_of),
                **_held(pixel, ("bits", "black_level_dn"), _whole),
            ),
            mosaic=Mosaic(tuple(words_of(row) for row in mosaic)) if mosaic is not None else None,
            stacked=_flag(held["stacked"]),
            origin=_origin(held["origin"]),
            notes=words_of(held["notes"]),
        )


def _origin(value: Any) -> Origin:
    return cast(Origin, check.one_of("origin of curves", word_of(value), get_args(Origin)))


def _whole(value: Any) -> int:
    if not number_of(value).is_integer():
        raise TypeError(f"{str(value)[:40]} is not a whole number")
    return int(value)


def _held(data: dict[str, Any], names: Iterable[str], kind: Callable[[Any], Any]) -> dict[str, Any]:
    """The values of these names, if present."""
    return {name: kind(data[name]) for name in names if name in data}


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise TypeError(f"{str(value)[:40]} is neither true nor false")
    return value


_WIDE_GAP_NM = 30.0
_MOST_CHANNELS = 256
_MOST_OF_PERCENT = 0.1  # share of values above 1: with fewer, these are errors


def read_sensor(
    path: Path | str | Found, grid: Grid, pixel: Pixel, *, answers: Answers = ASK
) -> Sensor:
    """Read a sensor from a file of curves in any format of `read_curves`, or from curves in memory.

    Parameters
    ----------
    path
        The file; its name without the suffix becomes the name of the sensor. Curves in memory give
        their source as the name.
    pixel
        The pixel of the sensor, which the file does not contain.
    answers
        Metadata that the file lacks; ``beyond`` also applies to the grid.

    Raises
    ------
    InputError
        If the file cannot be parsed, required metadata is missing, a QE lies outside 0 .. 1, or
        the curves do not cover the grid.
    """
    parsed = read_curves(path, answers=answers)
    named = (path.source, path.source) if isinstance(path, Found) else _names(Path(path))
    sensor = _sensor_of(parsed, named, grid, pixel, answers)
    return sensor if sensor.pixel is pixel else replace(sensor, pixel=pixel)


@kept  # a study is checked first, then computed: both read its files
def _sensor_of(
    parsed: ParsedSpectra, named: tuple[str, str], grid: Grid, pixel: Pixel, answers: Answers
) -> Sensor:
    count = len(parsed.curves.names)
    if count > _MOST_CHANNELS:
        need = f"must have at most {_MOST_CHANNELS} curves for a sensor"
        raise has(parsed.curves.source, need, count, remedy="keep those of its channels")
    curves = qe_of(parsed, answers)
    return _sensor(named, curves, grid, pixel, answers.beyond, remedy=_remedy(curves, answers))


def _remedy(curves: Spectra, answers: Answers) -> Remedy:
    """What to do about a QE that is not between 0 and 1."""
    if curves.values.max() <= 1:
        return SMALL_NEGATIVES
    few = (curves.values > 1).mean() < _MOST_OF_PERCENT
    if few or curves.values.max() <= FRACTION_AT_MOST or answers.scale == "percent":
        return "correct it"
    if curves.values.max(axis=0).min() <= 1:
        return "give all curves one unit"
    return Setting("scale", ("percent",))


def read_sensor_csv(
    path: Path | str, grid: Grid, pixel: Pixel, *, beyond: Beyond = "refuse"
) -> Sensor:
    """Read a sensor from absolute QE per channel in a CSV ``wavelength_nm,R,G,...``.

    No other form is accepted, so nothing is inferred.

    Parameters
    ----------
    path
        The CSV file; its name without the suffix becomes the name of the sensor.
    pixel
        The pixel of the sensor, which the file does not contain.
    beyond
        How to extrapolate curves that do not cover the grid.

    Raises
    ------
    InputError
        If the file cannot be read, a QE lies outside 0 .. 1, or the curves do not cover the grid.
    """
    path = Path(path)
    curves = read_spectra_csv(path, quantity="QE", unit="e-/photon")
    remedy = "divide percent by 100" if curves.values.max() > 1 else SMALL_NEGATIVES
    return _sensor(_names(path), curves, grid, pixel, beyond, remedy=remedy)


def _names(path: Path) -> tuple[str, str]:
    """Names of the sensor and of its file."""
    return path.stem, path.name


def _sensor(
    named: tuple[str, str],
    curves: Spectra,
    grid: Grid,
    pixel: Pixel,
    beyond: Beyond,
    *,
    remedy: Remedy,
) -> Sensor:
    used = used_on_grid(curves.wavelength_nm, grid)
    refuse_outside(curves, high=1.0, remedy=remedy, used=used)
    resampled = means_on_grid(curves, grid, beyond=beyond)
    return Sensor(
        name=named[0],
        grid=grid,
        qe=resampled.values,
        names=resampled.names,
        pixel=pixel,
        notes=(f"QE read from {named[1]}", *resampled.notes, *_gaps(curves)),
    )


def _gaps(curves: Spectra) -> tuple[str, ...]:
    """A note if neighboring samples are so far apart that linear interpolation is uncertain."""
    widest = float(np.diff(curves.wavelength_nm).max())
    if widest <= _WIDE_GAP_NM:
        return ()
    return (f"QE of {curves.source}: straight lines over gaps of up to {widest:g} nm",)
