"""Results as records: JSON keys are declared once, and JSON and its schema follow from them.

A record is a frozen dataclass. Its keys are its fields in their order, or those that its class
lists as ``KEYS``: a name, or a `JsonKey` where the value has another name, unit or place. A list of
keys can also be given with the record, for a view of records of lower packages.

`plain` writes: it walks from a record to numbers, text, lists and objects. `schema` describes: it
walks from the class along the same keys, and reads types from annotations and descriptions from
docstrings. `described_keys` lists the keys of a schema. `with_short_repr` shows a record in an
interactive session.
"""

import inspect
import json
import math
import re
import reprlib
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, fields, is_dataclass
from functools import cache, cached_property, partial, reduce
from json.encoder import encode_basestring, encode_basestring_ascii
from operator import or_
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

import numpy as np

from chromanoise.base.immutable import dataclass
from chromanoise.base.version import __version__


@dataclass(frozen=True)
class JsonKey:
    """One key of a record in JSON.

    Attributes
    ----------
    name
        The key; empty to put the keys of the value beside the others.
    of
        Where the value is: the name of a field or property, with dots for those of its value
        (``sensor.name``) and numbers for entries (``points.0``), or ``.`` for the record itself. A
        name that the record does not have is that of the record around it. Or a function of the
        record. Empty for ``name``.
    by
        Names of the axes of the value, which turn arrays into objects: per axis the names, or where
        they are, as ``of``.
    keys
        JsonKeys of the value, in place of those of its class.
    rows
        Whether the values of ``keys`` have one entry per row: the result is a list of objects.
    factor
        What a number is multiplied by, as 1000 for ``time_ms`` of ``time_s``.
    when
        Where or how it is decided whether the record has the key, as ``of``; empty for always.
    text
        Description, where no docstring of the value has it.
    is_old
        Whether the key is an old name of another one.
    """

    name: str
    of: str | Callable[[Any], Any] = ""
    _: KW_ONLY
    by: tuple[str | tuple[str, ...], ...] = ()
    keys: "JsonKeys" = ()
    rows: bool = False
    factor: float | None = None
    when: str | Callable[[Any], Any] = ""
    text: str = ""
    is_old: bool = False


JsonKeys = tuple[JsonKey | str, ...]
"""The keys of a record in their order; a name is a `JsonKey` without further facts."""


def _version(_: Any) -> str:
    """Version of chromanoise."""
    return __version__


VERSION = JsonKey("version", _version)
"""The version of chromanoise, which each output of a command begins with."""


def defined(value: float | None) -> float | None:
    """The number, or ``None`` where it is missing or not finite.

    Examples
    --------
    >>> defined(26.1), defined(float("nan"))
    (26.1, None)
    """
    return value if value is not None and math.isfinite(value) else None


def plain(value: Any, *keys: JsonKey | str) -> Any:
    """A record as plain data for JSON: objects, lists, text, and ``None`` for numbers not finite.

    Parameters
    ----------
    value
        A record, or arrays, lists and mappings of records, numbers and text.
    keys
        Of the record; those of its class if none is given.

    Examples
    --------
    >>> plain({"snr": np.array([1.0, np.inf]), "names": ("R", "G")})
    {'snr': [1.0, None], 'names': ['R', 'G']}
    """
    return _written(value, keys, ())


def _written(value: Any, keys: JsonKeys, owners: tuple[Any, ...]) -> Any:
    kind = type(value)
    if kind is float:  # most values
        return defined(value)
    if kind in _AS_IT_IS and not keys:
        return value
    if isinstance(value, np.ndarray | np.generic):
        if value.dtype.kind in "biu" or (value.dtype.kind == "f" and np.isfinite(value).all()):
            return value.tolist()
        value = value.tolist()
    if isinstance(value, Mapping):
        return {
            name: defined(one) if type(one) is float else _written(one, keys, owners)
            for name, one in value.items()
        }
    if isinstance(value, list | tuple):
        return [_written(one, keys, owners) for one in value]
    if isinstance(value, float):
        return defined(value)
    if value is None or not (keys or is_dataclass(value)):
        return value
    return _object((*owners, value), keys)


def json_text(data: Any, *, indent: int = 2, ensure_ascii: bool = False) -> str:
    """JSON text as `json.dumps` writes it with that indentation, with a final newline.

    Lists of numbers are encoded by the compiled encoder of `json`, which cannot indent.

    Parameters
    ----------
    data
        Objects, whose keys become text, lists, text, finite numbers and ``None``, from `plain`.
    indent
        Spaces per level.

    Raises
    ------
    ValueError
        If a number is not finite.

    Examples
    --------
    >>> print(json_text({"snr": [1.0, None]}), end="")
    {
      "snr": [
        1.0,
        null
      ]
    }
    """
    encoder = partial(json.JSONEncoder, allow_nan=False, ensure_ascii=ensure_ascii)
    encode, of_list = encoder().encode, dict[str, Callable[[Any], str]]()
    quoted = encode_basestring_ascii if ensure_ascii else encode_basestring
    of_kind: dict[type, Callable[[Any], str]]
    of_kind = {str: quoted, int: repr, type(None): lambda _: "null"}
    of_kind[float] = lambda number: repr(number) if math.isfinite(number) else encode(number)

    def text(value: Any, pad: str) -> str:
        if own := of_kind.get(type(value)):  # most values, in less time than `encode`
            return own(value)
        if not isinstance(value, dict | list | tuple) or not value:
            return encode(value)
        inner = pad + " " * indent
        if isinstance(value, dict):
            parts = [f"{quoted(str(key))}: {text(one, inner)}" for key, one in value.items()]
            return f"{{{inner}{f',{inner}'.join(parts)}{pad}}}"
        if not _NESTED.isdisjoint(map(type, value)):
            return f"[{inner}{f',{inner}'.join(text(one, inner) for one in value)}{pad}]"
        if inner not in of_list:
            of_list[inner] = encoder(separators=(f",{inner}", ": ")).encode
        return f"[{inner}{of_list[inner](value)[1:-1]}{pad}]"

    return text(data, "\n") + "\n"


_NESTED = {dict, list, tuple}


def keys_of(kind: type) -> JsonKeys:
    """The keys of the records of a class: its ``KEYS``, or the names of its fields."""
    declared: JsonKeys | None = getattr(kind, "KEYS", None)
    return tuple(one.name for one in fields(kind)) if declared is None else declared


_AS_IT_IS = {str, int, bool, NoneType}


def _object(owners: tuple[Any, ...], keys: JsonKeys) -> dict[str, Any]:
    record = owners[-1]
    found: dict[str, Any] = {}
    written: Any
    every = [(_key(one), "") for one in keys] if keys else _keys_of_class(record.__class__)
    for key, field in every:
        if field:  # most keys
            found[key.name] = _written(getattr(record, field), (), owners)
            continue
        if key.when and not _at(key.when, owners):
            continue
        value = _value(key, owners)
        if key.rows and value is not None:
            written = _rows((*owners, value), key.keys)
        else:
            written = _written(_named(value, key.by, owners), key.keys, owners)
        if key.name:
            found[key.name] = written
        else:
            found |= written
    return found


@cache
def _keys_of_class(kind: Any) -> list[tuple[JsonKey, str]]:
    """The keys of a class, each with its field or property if that is written as it is."""
    found = []
    for key in map(_key, keys_of(kind)):
        path = key.of or key.name
        changed = key.by or key.keys or key.rows or key.factor is not None or key.when
        own = key.name and isinstance(path, str) and _has(kind, path) and not changed
        found.append((key, str(path) if own else ""))
    return found


def _rows(owners: tuple[Any, ...], keys: JsonKeys) -> list[dict[str, Any]]:
    """One object per entry of the leading axis, which the values of all keys have."""
    columns = {}
    for key in map(_key, keys):
        value = _value(key, owners)
        entries = value.values() if isinstance(value, Mapping) else value
        columns[key.name] = [
            _written(_named(one, key.by, owners), key.keys, owners) for one in entries
        ]
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _key(key: JsonKey | str) -> JsonKey:
    return _of_name(key) if isinstance(key, str) else key


_of_name = cache(JsonKey)


def _value(key: JsonKey, owners: tuple[Any, ...]) -> Any:
    value = _at(key.of or key.name, owners)
    return value if key.factor is None or value is None else key.factor * value


def _at(path: str | Callable[[Any], Any], owners: tuple[Any, ...]) -> Any:
    """The value at a path from a record, or from the nearest record around it that has the name."""
    if callable(path):
        return path(owners[-1])
    if path == ".":
        return owners[-1]
    steps = _steps(path)
    value = owners[-1]
    for one in reversed(owners):
        if _has(one.__class__, steps[0]):
            value = one
            break
    for step in steps:
        if value is None:
            return None
        value = value[int(step)] if step.isdecimal() else getattr(value, step)
    return value


@cache
def _steps(path: str) -> tuple[str, ...]:
    return tuple(path.split("."))


@cache
def _has(kind: Any, name: str) -> bool:
    """Whether instances of a class have a field, a property or a constant of this name."""
    return name in getattr(kind, "__dataclass_fields__", ()) or hasattr(kind, name)


def _named(value: Any, by: Sequence[str | tuple[str, ...]], owners: tuple[Any, ...]) -> Any:
    if not by or value is None:
        return value
    names = _at(by[0], owners) if isinstance(by[0], str) else by[0]
    return {name: _named(one, by[1:], owners) for name, one in zip(names, value, strict=True)}


_Class = TypeVar("_Class", bound=type)
_LONGEST_REPR = 400


class _Short(reprlib.Repr):
    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = 60

    def repr_ndarray(self, array: Any, level: int) -> str:
        return f"<{' x '.join(map(str, array.shape))} {array.dtype}>"

    def repr_instance(self, value: Any, level: int) -> str:
        if not is_dataclass(value):
            return super().repr_instance(value, level)
        name = getattr(value, "name", "...")
        return f"{type(value).__name__}({name})"


_SHORT = _Short()


def with_short_repr(kind: _Class) -> _Class:
    """A decorator of a class of records: ``repr`` has the sizes of arrays, not their numbers.

    Records inside are shown by their names; fields without a value are left out.
    """

    def shortly(self: Any) -> str:
        values = {one.name: getattr(self, one.name) for one in fields(self) if one.repr}
        given = {
            name: _SHORT.repr(one)
            for name, one in values.items()
            if isinstance(one, np.ndarray) or one not in (None, ())
        }
        text = ", ".join(f"{name}={one}" for name, one in given.items())
        shown = text if len(text) <= _LONGEST_REPR else f"{text[:_LONGEST_REPR]}..."
        return f"{type(self).__name__}({shown})"

    kind.__repr__ = shortly  # type: ignore[assignment, method-assign] # of a class
    return kind


_NUMBERS: dict[str, Any] = {"$ref": "#/$defs/numbers"}
_DEFINITIONS: dict[str, Any] = {
    "numbers": {
        "description": "A number, null where it is not defined, or lists of them.",
        "anyOf": [{"type": ["number", "boolean", "null"]}, {"type": "array", "items": _NUMBERS}],
    }
}
_NAMES = {str: "string", int: "integer", bool: "boolean", NoneType: "null"}


def schema(kind: Any, *keys: JsonKey | str) -> dict[str, Any]:
    """The JSON schema (2020-12) of what `plain` writes of a record.

    Parameters
    ----------
    kind
        The class of the record, or any type of its values.
    keys
        As for `plain`.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **_schema(kind, keys, ()),
        "$defs": _DEFINITIONS,
    }


def _schema(kind: Any, keys: JsonKeys, owners: tuple[Any, ...]) -> dict[str, Any]:
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return _schema(inner[0], keys, owners)
    if origin in (Union, UnionType):
        return {"anyOf": [_schema(one, keys, owners) for one in inner]}
    if origin is Literal:
        return {"enum": list(inner)}
    if kind is float:
        return {"type": ["number", "null"]}
    if kind in _NAMES:
        return {"type": _NAMES[kind]}
    if _is_array(kind):
        return _NUMBERS
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": _schema(inner[1], keys, owners)}
    if isinstance(origin, type) and issubclass(origin, Sequence):
        of = reduce(or_, (one for one in inner if one is not Ellipsis))
        return {"type": "array", "items": _schema(of, keys, owners)}
    if keys or is_dataclass(kind):
        return _object_schema((*owners, kind), keys or keys_of(kind))
    return {}


def _object_schema(owners: tuple[Any, ...], keys: JsonKeys, *, row: bool = False) -> dict[str, Any]:
    """An object with these keys, and any that a later release adds; of a row, its entries."""
    properties: dict[str, Any] = {}
    found: dict[str, Any]
    required: list[str] = []
    for key in map(_key, keys):
        kind = _kind_at(key.of or key.name, owners)
        kind = _entry(kind) if row else kind
        one = _unless_none(kind)
        if key.rows:
            found = {"type": "array", "items": _object_schema((*owners, one), key.keys, row=True)}
            found = found if one is kind else {"anyOf": [found, {"type": "null"}]}
        else:
            kind = kind if key.name else one
            for _ in key.by:
                kind = _entry(kind)
            found = _schema(kind, key.keys, owners)
            for _ in key.by:
                found = {"type": ["object", "null"], "additionalProperties": found}
        text = _text_of(key, owners)
        found = found | ({"description": text} if text else {})
        found |= {"deprecated": True} if key.is_old else {}
        properties |= {key.name: found} if key.name else found["properties"]
        names = [key.name] if key.name else found["required"]
        required += [] if key.when else names
    return {"type": "object", "properties": properties, "required": required}


def _is_array(kind: Any) -> bool:
    return hasattr(kind, "array_type") or get_origin(kind) is np.ndarray or kind is np.ndarray


def _entry(kind: Any) -> Any:
    """The type of an entry of a list, a mapping or an array; of an array, an array."""
    kind = _unless_none(kind)
    inner = get_args(kind)
    if _is_array(kind) or not inner:
        return kind
    return inner[1] if issubclass(get_origin(kind) or object, Mapping) else inner[0]


def _unless_none(kind: Any) -> Any:
    """The type without ``None``."""
    if get_origin(kind) not in (Union, UnionType):
        return kind
    others = tuple(one for one in get_args(kind) if one is not NoneType)
    return kind if len(others) == len(get_args(kind)) else reduce(or_, others)


def _kind_at(path: str | Callable[[Any], Any], owners: tuple[Any, ...]) -> Any:
    """The type of the value at a path; ``Any`` where it is not annotated."""
    if callable(path):
        return _kind_of(path)
    if path == ".":
        return owners[-1]
    steps = _steps(path)
    kind = next((one for one in reversed(owners) if _has(one, steps[0])), owners[-1])
    missing = False
    for step in steps:
        own = _unless_none(kind)
        missing = missing or own is not kind
        kind = _entry(own) if step.isdecimal() else _kind_of(getattr(own, step, None), own, step)
    return kind | None if missing else kind


def _kind_of(member: Any, owner: Any = None, name: str = "") -> Any:
    """The type of a field, of a property, or of the result of a function."""
    types = {one.name: one.type for one in fields(owner)} if is_dataclass(owner) else {}
    function = _getter(member) or member
    kind = types.get(name, getattr(function, "__annotations__", {}).get("return", Any))
    if isinstance(kind, str):  # a class that is defined below, or imported for type checkers only
        return vars(sys.modules[(owner or function).__module__]).get(kind, Any)
    return kind


def _getter(member: Any) -> Any:
    """The function of a property; ``None`` for other members."""
    if isinstance(member, cached_property):
        return member.func
    return member.fget if isinstance(member, property) else None


def _text_of(key: JsonKey, owners: tuple[Any, ...]) -> str:
    """The description of a key: its own, or that in the docstring of its value."""
    path = key.of or key.name
    if key.text or path == ".":
        return key.text
    if callable(path):
        text = _first_paragraph(path)
    else:
        before, _, last = path.rpartition(".")
        near = next((one for one in reversed(owners) if _has(one, last)), owners[-1])
        owner = _unless_none(_kind_at(before, owners)) if before else near
        member = getattr(owner, last, None)
        text = attribute_texts(owner).get(last, "") if isinstance(owner, type) else ""
        text = text or _first_paragraph(_getter(member))
    text = re.sub(r"``None``|\bNaN\b|\binf\b", "null", text)  # as JSON has them
    return text if key.factor is None else text.replace("[s]", "[ms]")


def _first_paragraph(documented: Any) -> str:
    return " ".join((inspect.getdoc(documented) or "").partition("\n\n")[0].split())


@cache
def attribute_texts(kind: type) -> dict[str, str]:
    """The texts on the attributes of a class, as its docstring and those of its bases have them.

    Parameters
    ----------
    kind
        A class whose docstring has a section "Attributes".

    Examples
    --------
    >>> attribute_texts(JsonKey)["factor"]
    'What a number is multiplied by, as 1000 for ``time_ms`` of ``time_s``.'
    """
    found: dict[str, str] = {}
    for one in reversed(kind.__mro__):
        doc = inspect.cleandoc(vars(one).get("__doc__") or "")
        section = doc.partition("Attributes\n----------\n")[2]
        names: list[str] = []
        for line in re.split(r"\n\w+\n---", section)[0].splitlines():
            if not line.startswith(" "):
                names = line.split(", ")
                found |= dict.fromkeys(names, "")
            found |= {name: f"{found[name]} {line}".strip() for name in names if line[:1] == " "}
    return {name: " ".join(text.split()) for name, text in found.items()}


LIST, ANY_NAME = "[]", "NAME"
"""Steps of the path of a key: to the entries of a list, and to the values of an object by name."""


@dataclass(frozen=True)
class DescribedKey:
    """A key of a JSON document, as its schema describes it.

    Attributes
    ----------
    path
        The keys from the document to it; `LIST` and `ANY_NAME` are steps too.
    kinds
        Types of its value: ``number``, ``string``, ``boolean``, ``null`` ...; of a list of numbers
        those of its entries. Empty if any value may stand there.
    text
        Description; empty if there is none.
    """

    path: tuple[str, ...]
    kinds: frozenset[str]
    text: str

    @property
    def name(self) -> str:
        """The path without lists, joined by dots: ``sensors.color.snr_db.NAME``."""
        return ".".join(step for step in self.path if step != LIST)

    @property
    def is_number(self) -> bool:
        """Whether the value is, or may be, a number, true or false, or a list of them."""
        return not self.kinds or not self.kinds.isdisjoint({"number", "integer", "boolean"})


def described_keys(whole: Mapping[str, Any]) -> tuple[DescribedKey, ...]:
    """All keys that hold no further keys, in their order, without old names.

    Parameters
    ----------
    whole
        What `schema` returns.
    """
    found: dict[tuple[str, ...], DescribedKey] = {}
    for one in _described(whole, (), ""):
        before = found.get(one.path, one)
        found[one.path] = DescribedKey(one.path, one.kinds | before.kinds, before.text)
    return tuple(one for one in found.values() if one.kinds != {"null"})


def _described(part: Any, path: tuple[str, ...], text: str) -> Iterator[DescribedKey]:
    if not isinstance(part, Mapping) or part.get("deprecated"):
        return
    text = part.get("description", text)
    kind = part.get("type", [])
    kinds = {kind} if isinstance(kind, str) else {*kind}
    inner = [*part.get("anyOf", ())]
    if "properties" in part:
        for key, one in part["properties"].items():
            yield from _described(one, (*path, key), "")
    elif isinstance(part.get("additionalProperties"), Mapping):
        yield from _described(part["additionalProperties"], (*path, ANY_NAME), text)
    elif "items" in part:
        yield from _described(part["items"], (*path, LIST), text)
    elif inner:
        for one in inner:
            yield from _described(one, path, text)
    else:
        kinds |= {"number"} if "$ref" in part else {"string"} if "enum" in part else set()
        yield DescribedKey(path, frozenset(kinds), text)
