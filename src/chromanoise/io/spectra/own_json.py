"""JSON in versioned schemas of this library; files of other versions raise an error."""

import json
from collections.abc import Mapping
from typing import Any, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._inputs import json_of
from chromanoise.errors import InputError
from chromanoise.io.spectra.parsed import LARGEST, Column, Found, Level, Per, Quantity, Scaled

SCHEMA_VERSION = 1
"""The version of every schema; a file of another version is not read."""

SPECTRA_SCHEMA = "chromanoise spectra"
UNIT_OF_COLUMN = {"1": "", "e-/photon": ""}
"""Units that the quantity implies; in a heading, e-/photon would also declare absolute values."""


def as_json(data: Mapping[str, Any]) -> str:
    """JSON text with all digits; numbers that are not finite raise an error."""
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def named(error: InputError, source: str) -> InputError:
    """The error about a value, with the file that contains the value as its subject."""
    return error if source in error.subject else error.within(source)


def held_json(text: str, schema: str, *, source: str) -> dict[str, Any]:
    """The data in a text of one of our own schemas.

    Parameters
    ----------
    text
        The whole file.
    schema
        The schema, e.g. ``chromanoise sensor``.
    source
        The origin of the text; used in errors.

    Raises
    ------
    InputError
        As `json_of`, or if it has another schema or version.
    """
    held = json_of(text, source)
    found = held.get("schema") if isinstance(held, dict) else None
    if found != schema or not isinstance(held, dict):
        raise InputError(source, f"must be {schema!r}", value=found, where="key 'schema'")
    _refuse_other_version(held, source)
    return held


def own_spectra(held: Mapping[str, Any], source: str) -> Found:
    """The curves in JSON of the schema ``chromanoise spectra``, as `convert` writes it.

    Raises
    ------
    InputError
        If the version differs, or a value is missing or invalid.
    """
    _refuse_other_version(held, source)
    try:
        wavelength = _check.finite("wavelength_nm", "nm", array_of(held["wavelength_nm"], 1))
        values = array_of(held["values"], 2)
        names = words_of(held["names"])
        quantity, unit = word_of(held["quantity"]), word_of(held["unit"])
        said_source, said_notes = word_of(held["source"]), words_of(held["notes"])
    except (KeyError, TypeError, OverflowError) as error:
        raise unfit(source, "spectra", error) from None
    except InputError as error:
        raise named(error, source) from None
    if values.shape != (wavelength.size, len(names)):
        raise InputError(
            source,
            f"must be {wavelength.size} rows (wavelengths) of {len(names)} numbers (names)",
            value=values.shape,
            found=f"is {values.shape[0]} of {values.shape[1]}",
            where="key 'values'",
        )
    if not (np.abs(values) <= LARGEST).all():
        raise InputError(
            source,
            "must be finite and at most 1e30",
            value=float(np.abs(values).max()),
            where="key 'values'",
            remedy="correct them",
        )
    ratio = quantity in ("QE", "reflectance", "transmittance")
    texts = {key: value for key, value in held.items() if isinstance(value, str)}
    facts = {"scale": "fraction" if ratio else "as written", **texts}
    return Found(
        source=source,
        format="chromanoise's own JSON, spectra",
        columns=tuple(
            Column(
                name=name,
                unit=UNIT_OF_COLUMN.get(unit, unit),
                wavelength=wavelength,
                values=values[:, k],
            )
            for k, name in enumerate(names)
        ),
        heading="wavelength_nm",  # the heading of the CSV of the same curves
        wavelength_unit="nm",
        said_source=said_source,
        said_notes=said_notes,
        **declared(facts, said_notes),
    )


def declared(facts: Mapping[str, str], notes: tuple[str, ...] = ()) -> dict[str, Any]:
    """Quantity, level, per and scale of a file of this library, as fields of `Found`.

    Unknown words are ignored. Files of earlier versions have level and per in their notes.

    Examples
    --------
    >>> declared({"quantity": "QE", "level": "absolute", "scale": "fraction"})
    {'quantity': 'QE', 'level': 'absolute', 'scale': 'fraction'}
    >>> declared({"quantity": "spectra"}, ("light counted per photon",))
    {'per': 'photon'}
    """
    noted = {
        key: note.removeprefix(before)
        for note in notes
        for key, before in (("level", "level: "), ("per", "light counted per "))
        if note.startswith(before)
    }
    kinds = {"quantity": Quantity, "level": Level, "per": Per, "scale": Scaled}
    found = {**noted, **facts}
    return {key: found[key] for key, kind in kinds.items() if found.get(key) in get_args(kind)}


def unfit(source: str, what: str, error: Exception) -> InputError:
    """The error for JSON of a known schema in which a value is missing or invalid."""
    fault = f"{error.args[0]!r} is missing" if isinstance(error, KeyError) else str(error)
    fault = " ".join(fault.split())[:200]
    return InputError(source, f"is not the JSON of a {what} as chromanoise writes it ({fault})")


def word_of(value: Any) -> str:
    """A text in JSON; a TypeError for anything else."""
    if not isinstance(value, str):
        raise TypeError(f"{str(value)[:40]} is not text")
    return value


def words_of(values: Any) -> tuple[str, ...]:
    """A list of texts in JSON; a TypeError for anything else."""
    if not isinstance(values, list):
        raise TypeError(f"{str(values)[:40]} is not a list of text")
    return tuple(word_of(value) for value in values)


def number_of(value: Any) -> float:
    """A number in JSON; a TypeError for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{str(value)[:40]} is not a number")
    return float(value)


def array_of(values: Any, depth: int) -> Array:
    """Numbers in ``depth`` lists, the inner ones equally long; a TypeError for anything else."""
    if not isinstance(values, list):
        raise TypeError(f"{str(values)[:40]} is not a list of numbers")
    if depth == 1:
        return np.array([number_of(value) for value in values], dtype=np.float64)
    arrays = [array_of(row, depth - 1) for row in values]
    if not arrays or len({array.size for array in arrays}) > 1:
        raise TypeError("rows of numbers are not equally long")
    return np.stack(arrays)


def _refuse_other_version(held: Mapping[str, Any], source: str) -> None:
    if held.get("schema_version") != SCHEMA_VERSION:
        raise InputError(
            source,
            f"must be {SCHEMA_VERSION}",
            value=held.get("schema_version"),
            where="key 'schema_version'",
            remedy="read it with the version that wrote it",
        )
