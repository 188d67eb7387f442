"""Read a characterization back from the JSON of ``chromanoise characterize``."""

from collections.abc import Mapping
from types import UnionType
from typing import Annotated, Any, get_args, get_origin

import numpy as np

from chromanoise import _check
from chromanoise.characterization.results import (
    SCHEMA,
    SCHEMA_VERSION,
    SPREADS,
    Characterization,
    LevelNoise,
    ModelVerdict,
    PlaneNoise,
    written_fields,
)
from chromanoise.errors import InputError
from chromanoise.io.pixels.source_text import finite_number
from chromanoise.sensor import Mosaic, TransferFit

_MOST = 1e15
_NOUNS = (PlaneNoise, LevelNoise, TransferFit, ModelVerdict)
_POSITIVE = (".gain_dn_per_e",)
_NOT_NEGATIVE = ("_noise_e", "_se", *(f".{name}" for name in SPREADS))
_REMEDY = "give the file as chromanoise characterize wrote it"


def is_characterization(data: Any) -> bool:
    """Whether data of JSON name the schema of a characterization.

    Parameters
    ----------
    data
        Data of JSON.
    """
    return isinstance(data, dict) and data.get("schema") == SCHEMA


def characterization_from_json(data: Mapping[str, Any], source: str) -> Characterization:
    """The characterization that `characterization_as_json` made into plain data, with all digits.

    Parameters
    ----------
    data
        The object of the JSON.
    source
        Name of the file, for messages.

    Raises
    ------
    InputError
        If a field is missing or not of its kind, or the version of the schema is another.
    """
    if data.get("schema") != SCHEMA or data.get("schema_version") != SCHEMA_VERSION:
        raise InputError(
            source,
            f"must have the schema {SCHEMA!r} and schema_version {SCHEMA_VERSION}",
            value=(data.get("schema"), data.get("schema_version")),
            remedy=_REMEDY,
        )
    pattern = data.get("mosaic")
    try:
        mosaic = None if pattern is None else Mosaic(tuple(tuple(row) for row in pattern))
        planes = _wrong_unless(list, data.get("planes"), source, "planes")
        return Characterization(
            source=_value(str, data.get("source"), source, "source"),
            camera=_value(str, data.get("camera"), source, "camera"),
            iso=_value(float | None, data.get("iso"), source, "iso"),
            bits=_value(int | None, data.get("bits"), source, "bits"),
            mosaic=mosaic,
            planes=tuple(
                _value(PlaneNoise, plane, source, f"planes[{i}]") for i, plane in enumerate(planes)
            ),
            correlation=_array(data.get("correlation"), 2, source, "correlation"),
            covariance_dn2=_array(data.get("covariance_dn2"), 3, source, "covariance_dn2"),
            verdict=_value(ModelVerdict, data.get("verdict"), source, "verdict"),
            notes=_value(tuple[str, ...], data.get("notes"), source, "notes"),
        )
    except (TypeError, AttributeError):
        raise _wrong(source, "mosaic", pattern) from None


def _wrong(source: str, where: str, value: Any) -> InputError:
    return InputError(
        source, "must be as in a characterization", value=value, where=where, remedy=_REMEDY
    )


def _wrong_unless(kind: type, value: Any, source: str, where: str) -> Any:
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        raise _wrong(source, where, value)
    return value


def _value(kind: Any, value: Any, source: str, where: str) -> Any:
    """A value of the type of a field of the nouns."""
    if get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    if isinstance(kind, UnionType):
        first = next(one for one in get_args(kind) if one is not type(None))
        return None if value is None else _value(first, value, source, where)
    if kind in _NOUNS:
        return _noun(kind, value, source, where)
    if get_origin(kind) is tuple:
        of = get_args(kind)[0]
        entries = _wrong_unless(list, value, source, where)
        return tuple(_value(of, one, source, f"{where}[{i}]") for i, one in enumerate(entries))
    if kind is float:
        return _number(value, source, where)
    if kind in (str, int, bool):
        return _wrong_unless(kind, value, source, where)
    return _array(value, 1, source, where)


def _noun(kind: type, value: Any, source: str, where: str) -> Any:
    held = _wrong_unless(dict, value, source, where)
    return kind(
        **{
            name: _value(one, held.get(name), source, f"{where}.{name}")
            for name, one in written_fields(kind).items()
        }
    )


def _number(value: Any, source: str, where: str) -> float:
    """A number; NaN for null, as which a number that is not finite is written."""
    if value is None and not where.endswith(_POSITIVE):
        return float("nan")
    number = finite_number(value)
    if number is None or abs(number) > _MOST:
        raise _wrong(source, where, value)
    if (number < 0 and where.endswith(_NOT_NEGATIVE)) or (
        number <= 0 and where.endswith(_POSITIVE)
    ):
        raise _wrong(source, where, value)
    return number


def _array(value: Any, axes: int, source: str, where: str) -> Any:
    try:
        array = np.array(_wrong_unless(list, value, source, where))
    except ValueError:
        raise _wrong(source, where, value) from None
    flags = array.dtype == bool
    if array.ndim != axes or not (flags or array.dtype.kind in "if"):
        raise _wrong(source, where, value)
    return array if flags else _check.finite(f"{where} of {source}", "1", array)
