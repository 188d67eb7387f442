"""Sensors and spectra in JSON of our own, with a version: all that they hold, and back again."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, fields
from typing import Any, cast, get_args

import numpy as np

from chromanoise import __version__, _check
from chromanoise._check import Array, InputError
from chromanoise.sensor import Converter, Imperfections, Mosaic, Pixel, Sensor
from chromanoise.sensor.sensor import Origin
from chromanoise.spectra import Grid, Spectra
from chromanoise.study.files.own_json import SCHEMA_VERSION, as_json, held_json, named

_SENSOR_SCHEMA = "chromanoise sensor"
_SPECTRA_SCHEMA = "chromanoise spectra"
_FLAWS = tuple(field.name for field in fields(Imperfections))
_LARGEST_GRID = 1_000_000


def spectra_json(spectra: Spectra) -> str:
    """All of the spectra; `spectra_from_json` gives them back."""
    return as_json(
        {
            "schema": _SPECTRA_SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "version": __version__,
            "quantity": spectra.quantity,
            "unit": spectra.unit,
            "source": spectra.source,
            "notes": list(spectra.notes),
            "names": list(spectra.names),
            "wavelength_nm": spectra.wavelength_nm.tolist(),
            "values": spectra.values.tolist(),
        }
    )


def sensor_json(sensor: Sensor) -> str:
    """All of the sensor; `sensor_from_json` gives it back."""
    grid, pixel = sensor.grid, sensor.pixel
    return as_json(
        {
            "schema": _SENSOR_SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "version": __version__,
            "name": sensor.name,
            "origin": sensor.origin,
            "notes": list(sensor.notes),
            "stacked": sensor.stacked,
            "mosaic": [list(row) for row in sensor.mosaic.pattern] if sensor.mosaic else None,
            "pixel": {
                "pitch_um": pixel.pitch_um,
                "full_well_e": pixel.full_well_e,
                "read_noise_e": pixel.read_noise_e,
                **{name: value for name, value in asdict(sensor.imperfections).items() if value},
                **sensor.converter.known,
            },
            "grid_nm": {"start": grid.start_nm, "stop": grid.stop_nm, "step": grid.step_nm},
            "channels": list(sensor.names),
            "qe": sensor.qe.tolist(),
        }
    )


def spectra_from_json(text: str, *, source: str = "spectra") -> Spectra:
    """The spectra that `spectra_json` wrote.

    Raises
    ------
    InputError
        If the text is no JSON, is of another schema or version, or the spectra are wrong.
    """
    held = held_json(text, _SPECTRA_SCHEMA, source=source)
    try:
        return Spectra(
            wavelength_nm=_array(held["wavelength_nm"], 1),
            values=_array(held["values"], 2),
            names=_words(held["names"]),
            quantity=_word(held["quantity"]),
            unit=_word(held["unit"]),
            source=_word(held["source"]),
            notes=_words(held["notes"]),
        )
    except InputError as error:
        raise named(error, source) from None
    except (KeyError, TypeError, OverflowError) as error:
        raise _unfit(source, "spectra", error) from None


def sensor_from_json(text: str, *, source: str = "sensor") -> Sensor:
    """The sensor that `sensor_json` wrote.

    Raises
    ------
    InputError
        If the text is no JSON, is of another schema or version, or the sensor is wrong.
    """
    held = held_json(text, _SENSOR_SCHEMA, source=source)
    try:
        grid, pixel, mosaic = held["grid_nm"], held["pixel"], held["mosaic"]
        wells = {k: _number(pixel[k]) for k in ("pitch_um", "full_well_e", "read_noise_e")}
        own = Grid(*(_number(grid[key]) for key in ("start", "stop", "step")))
        if own.n > _LARGEST_GRID:
            raise InputError(f"{source}: a grid of {own.n} wavelengths is too large")
        return Sensor(
            name=_word(held["name"]),
            grid=own,
            qe=_array(held["qe"], 2),
            names=_words(held["channels"]),
            pixel=Pixel(**wells),
            imperfections=Imperfections(**_held(pixel, _FLAWS, _number)),
            converter=Converter(
                **_held(pixel, ("gain_e_per_dn",), _number),
                **_held(pixel, ("bits", "black_level_dn"), _whole),
            ),
            mosaic=Mosaic(tuple(_words(row) for row in mosaic)) if mosaic is not None else None,
            stacked=_flag(held["stacked"]),
            origin=_origin(held["origin"]),
            notes=_words(held["notes"]),
        )
    except InputError as error:
        raise named(error, source) from None
    except (KeyError, TypeError, OverflowError) as error:
        raise _unfit(source, "sensor", error) from None


def _unfit(source: str, what: str, error: Exception) -> InputError:
    told = f"{error.args[0]!r} is missing" if isinstance(error, KeyError) else str(error)
    told = " ".join(told.split())[:200]
    return InputError(f"{source}: not the JSON of a {what} as chromanoise writes it ({told})")


def _word(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{str(value)[:40]} is no text")
    return value


def _origin(value: Any) -> Origin:
    return cast(Origin, _check.one_of("origin of curves", _word(value), get_args(Origin)))


def _words(values: Any) -> tuple[str, ...]:
    if not isinstance(values, list):
        raise TypeError(f"{str(values)[:40]} is no list of text")
    return tuple(_word(value) for value in values)


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{str(value)[:40]} is no number")
    return float(value)


def _whole(value: Any) -> int:
    if not _number(value).is_integer():
        raise TypeError(f"{str(value)[:40]} is no whole number")
    return int(value)


def _held(told: dict[str, Any], names: Sequence[str], kind: Callable[[Any], Any]) -> dict[str, Any]:
    """The values of these names, where they are there."""
    return {name: kind(told[name]) for name in names if name in told}


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise TypeError(f"{str(value)[:40]} is neither true nor false")
    return value


def _array(values: Any, depth: int) -> Array:
    """Numbers in ``depth`` lists, the inner ones equally long."""
    rows = values if isinstance(values, list) else None
    if rows is None:
        raise TypeError(f"{str(values)[:40]} is no list of numbers")
    if depth == 1:
        return np.array([_number(value) for value in rows], dtype=np.float64)
    arrays = [_array(row, depth - 1) for row in rows]
    if not arrays or len({array.size for array in arrays}) > 1:
        raise TypeError("rows of numbers are not equally long")
    return np.stack(arrays)
