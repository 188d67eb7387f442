"""Records: immutable documents whose fields declare type, bounds, default and description.

A class lists its fields as a dataclass does. Data from files, options and pages are checked against
them, all faults at once, each with its place:

- types: ``str``, ``bool``, ``int``, ``float``, ``Any``, ``Literal``, ``X | None``, ``tuple``,
  ``list``, ``dict[str, X]`` and other records. Types are not converted, but an integer is also a
  number and a list also a tuple;
- ``Annotated[X, ...]`` adds bounds (`Field`), a check before or after that of the type (`Before`,
  `After`), or any object with ``checked(value, place)``, such as `chromanoise.base.Property`.
"""

import inspect
import json
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, field, is_dataclass, replace
from functools import cache
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    ClassVar,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)
from weakref import WeakKeyDictionary

from chromanoise.base.check import strange_character
from chromanoise.base.errors import InputError, did_you_mean, errors_in, known_name
from chromanoise.base.immutable import dataclass

Key = tuple[str | int, ...]
"""Where a value is: ("sensors", 0, "name")."""
SomeRecord = TypeVar("SomeRecord", bound="Record")
_Check = Callable[[Any, "Place"], Any]
_LONGEST_WORD = 80


@dataclass(frozen=True)
class Place:
    """Where a value is checked.

    Attributes
    ----------
    key
        Its place in the document.
    context
        What the caller of the check says about it, e.g. that settings without effect are kept.
    faults
        The faults found so far.
    """

    key: Key
    context: Mapping[str, Any]
    faults: "list[Fault]"

    @property
    def name(self) -> str:
        """The innermost key that is a word, shortened."""
        return next((short(one) for one in reversed(self.key) if isinstance(one, str)), "")

    def inside(self, step: str | int) -> "Place":
        """The place of an entry of this value."""
        return replace(self, key=(*self.key, step))

    def refuse(self, requirement: str, value: Any = None, **more: Any) -> Any:
        """Add a fault of this place; its value is not part of what is checked further."""
        plain = isinstance(value, list | tuple) and all(isinstance(n, int | float) for n in value)
        shown = plain or not isinstance(value, dict | list | tuple | Record)
        error = InputError(
            self.name or "the study",
            requirement,
            value=value if shown else None,
            setting=dotted(self.key),
            **more,
        )
        self.faults.append(Fault(self.key, error))
        return _REFUSED


@dataclass(frozen=True)
class Fault:
    """What is wrong with a document.

    Attributes
    ----------
    of_part
        Whether ``error`` is of a check that sees several fields of a record, whose names are inside
        of ``key``.
    """

    key: Key
    error: InputError
    of_part: bool = False


class RecordError(ValueError):
    """All faults of a document."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        super().__init__("; ".join(f"{dotted(one.key)}: {one.error}" for one in faults))
        self.faults = tuple(faults)


_REFUSED: Any = object()


def _takes_place(check: Callable[..., Any]) -> bool:
    """Whether a check takes a `Place` after its value."""
    known = _TAKES_PLACE.get(check)
    if known is None:
        known = _TAKES_PLACE[check] = len(inspect.signature(check).parameters) > 1
    return known


_TAKES_PLACE: WeakKeyDictionary[Callable[..., Any], bool] = WeakKeyDictionary()
_REQUIRED: Any = ...


@dataclass(frozen=True, eq=False)
class DeclaredField:
    """A field of a record, or bounds of a type inside ``Annotated``: see `Field`.

    Attributes
    ----------
    default
        ``...`` if it must be given.
    alias
        Its key, where that is no name of Python.
    ge, gt, le, lt, finite
        Bounds of a number.
    min_length, max_length
        Of a text or a list.
    metadata
        Further facts, as those of ``Annotated``.
    annotation
        Its type without ``Annotated``.
    """

    default: Any = _REQUIRED
    description: str = ""
    alias: str | None = None
    ge: float | None = None
    gt: float | None = None
    le: float | None = None
    lt: float | None = None
    finite: bool = False
    min_length: int | None = None
    max_length: int | None = None
    metadata: tuple[Any, ...] = field(default=())
    annotation: Any = None

    @property
    def required(self) -> bool:
        """Whether it must be given."""
        return self.default is _REQUIRED

    def checked(self, value: Any, place: Place) -> Any:
        """The value, if it is within the bounds."""
        if isinstance(value, str | tuple | list):
            count = len(value)
            for most, word, wrong in (
                (self.max_length, "at most", count > (self.max_length or count)),
                (self.min_length, "at least", count < (self.min_length or 0)),
            ):
                if wrong and isinstance(value, str):
                    return place.refuse(f"must have {word} {most} characters", value)
                if wrong:
                    return place.refuse(
                        f"must have {word} {most} entries", count, found=f"has {count}"
                    )
            return value
        for wrong, what in (
            (self.finite and not math.isfinite(value), "a finite number"),
            (self.ge is not None and not value >= self.ge, f"greater than or equal to {self.ge}"),
            (self.gt is not None and not value > self.gt, f"greater than {self.gt}"),
            (self.le is not None and not value <= self.le, f"less than or equal to {self.le}"),
            (self.lt is not None and not value < self.lt, f"less than {self.lt}"),
        ):
            if wrong:
                return place.refuse(f"must be {what}", value)
        return value


def Field(default: Any = _REQUIRED, description: str = "", **facts: Any) -> Any:  # noqa: N802
    """The declaration of a field, for its class, or bounds inside ``Annotated``.

    Parameters
    ----------
    default, description, facts
        As `DeclaredField`.
    """
    return DeclaredField(default, description, **facts)


@dataclass(frozen=True)
class After:
    """A check of a value that has its type; it returns the value or raises an error.

    Attributes
    ----------
    check
        Called with the value, and with the `Place` if it takes two arguments.
    """

    check: Callable[..., Any]

    def checked(self, value: Any, place: Place) -> Any:
        """The value that the check returns."""
        try:
            return self.check(value, place) if _takes_place(self.check) else self.check(value)
        except InputError as error:
            place.faults.append(Fault(place.key, error.inside(dotted(place.key), str)))
            return _REFUSED
        except (ValueError, AssertionError) as error:
            return place.refuse(str(error), value)


class Before(After):
    """As `After`, but of what is given, before the check of its type."""


@dataclass(frozen=True)
class Written:
    """How a value is written as plain data, where that differs."""

    plain: Callable[[Any], Any]


def after(method: Any) -> Any:
    """A decorator: a method that checks a whole record, with its `Place` if it takes it."""
    method.checks_record = True
    return method


class _OfRecords(type):
    """The class of the classes of records, which have `model_fields`."""

    @property
    def model_fields(cls) -> dict[str, DeclaredField]:
        """The fields by name; of a base first."""
        if "_fields" not in cls.__dict__:
            cls._fields = _fields_of(cls)
        return cls._fields


class Record(metaclass=_OfRecords):
    """A document, or a part of one; see the module. Equal records have equal values."""

    unknown: ClassVar[Any] = "refused"
    """What becomes of other keys: they are refused, ignored, or kept if they are of this type."""
    model_fields: ClassVar[dict[str, DeclaredField]]
    model_fields_set: frozenset[str]
    """The names that were given."""
    further: dict[str, Any]
    """The values of other keys, where they are kept."""

    def __init_subclass__(cls, unknown: Any = None, **more: Any) -> None:
        super().__init_subclass__(**more)
        if unknown is not None:
            cls.unknown = unknown

    def __init__(self, **given: Any) -> None:
        _checked_into(self, given, {})

    @classmethod
    def known_keys(cls, given: Mapping[str, Any]) -> Collection[str]:
        """The keys of the record.

        Parameters
        ----------
        given
            Its values by key, not yet checked.
        """
        return [one.alias or name for name, one in cls.model_fields.items()]

    @classmethod
    def model_validate(
        cls: type[SomeRecord], data: Any, *, context: Mapping[str, Any] | None = None
    ) -> SomeRecord:
        """A record from plain data.

        Parameters
        ----------
        data
            Its values by key; ``_`` and ``-`` are equal.

        Raises
        ------
        RecordError
            All faults of the data.
        """
        if isinstance(data, cls):
            return data
        record = cls.__new__(cls)
        _checked_into(record, data, context or {})
        return record

    @classmethod
    def model_json_schema(cls) -> dict[str, Any]:
        """The JSON Schema of the record, with those inside it under ``$defs``."""
        definitions: dict[str, Any] = {}
        own = _of_record(cls, definitions)
        definitions.pop(cls.__name__, None)
        return {"$defs": dict(sorted(definitions.items())), **own} if definitions else own

    def model_copy(self: SomeRecord, *, update: Mapping[str, Any] | None = None) -> SomeRecord:
        """A copy with some fields replaced by values that are not checked."""
        changes = dict(update or {})
        record = type(self).__new__(type(self))
        record.__dict__.update(self.__dict__ | changes)
        record.__dict__["model_fields_set"] = self.model_fields_set | changes.keys()
        return record

    def model_dump(
        self,
        *,
        mode: Literal["python", "json"] = "python",
        by_alias: bool = False,
        exclude_defaults: bool = False,
        exclude_none: bool = False,
        include: Collection[str] | None = None,
        exclude: Collection[str] = (),
    ) -> dict[str, Any]:
        """The record as plain data.

        Parameters
        ----------
        mode
            ``json``: with lists in place of tuples.
        by_alias
            Whether keys are those of files.
        exclude_defaults, exclude_none
            Without values that are the default, without those that are ``None``.
        include, exclude
            Names of the fields.
        """
        options = {
            "mode": mode,
            "by_alias": by_alias,
            "exclude_defaults": exclude_defaults,
            "exclude_none": exclude_none,
        }
        found = {}
        for name, one, key, written in _writers(type(self), by_alias):
            value = getattr(self, name)
            left_out = (
                name in exclude
                or (include is not None and name not in include)
                or (exclude_none and value is None)
                or (exclude_defaults and not one.required and value == one.default)
            )
            if not left_out:
                found[key] = written.plain(value) if written else _plain(value, options)
        return found | {name: _plain(value, options) for name, value in self.further.items()}

    def model_dump_json(self, **options: Any) -> str:
        """As `model_dump`, as text."""
        data = self.model_dump(mode="json", **options)
        return json.dumps(data, separators=(",", ":"), ensure_ascii=False)

    def __iter__(self) -> Iterator[tuple[str, Any]]:
        return ((name, getattr(self, name)) for name in type(self).model_fields)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__} is immutable; use model_copy")

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        ours, theirs = dict(self.__dict__), dict(other.__dict__)
        ours.pop("model_fields_set"), theirs.pop("model_fields_set")
        return ours == theirs

    def __hash__(self) -> int:
        return hash((type(self), *(getattr(self, name) for name in type(self).model_fields)))

    def __repr__(self) -> str:
        given = self.model_dump(exclude_defaults=True)
        return f"{type(self).__name__}({', '.join(f'{k}={v!r}' for k, v in given.items())})"


def short(word: Any) -> str:
    """Enough of a word to know it."""
    text = str(word)
    return text if len(text) <= _LONGEST_WORD else f"{text[:_LONGEST_WORD]}..."


def dotted(key: Key) -> str:
    """A key as text: ``sensors.0.name``."""
    return ".".join(map(short, key))


def subclass(
    base: type[SomeRecord], name: str, fields: Mapping[str, tuple[Any, Any]], **more: Any
) -> type[SomeRecord]:
    """A class of records with further fields after those of its base.

    Parameters
    ----------
    base
        The class that it extends.
    fields
        Type and declaration of each further field.
    more
        Further attributes, as ``__doc__``.
    """
    made: type[SomeRecord] = type(base)(  # type: ignore[misc] # the class of a class
        name,
        (base,),
        {
            "__module__": base.__module__,
            "__annotations__": {key: kind for key, (kind, _) in fields.items()},
            **{key: one for key, (_, one) in fields.items()},
            **more,
        },
    )
    return made


# ---- fields and checks ----


def _fields_of(cls: type) -> dict[str, DeclaredField]:
    found: dict[str, DeclaredField] = {}
    for base in reversed(cls.__mro__):
        if base is Record or not isinstance(base, _OfRecords):
            continue
        hints = get_type_hints(base, include_extras=True)
        for name in inspect.get_annotations(base):
            if get_origin(hints[name]) is not ClassVar:
                found[name] = _declared(hints[name], base.__dict__.get(name, _REQUIRED))
    return found


def _declared(annotation: Any, given: Any) -> DeclaredField:
    one = given if isinstance(given, DeclaredField) else DeclaredField(given)
    metadata: tuple[Any, ...] = ()
    if get_origin(annotation) is Annotated:
        annotation, *inside = get_args(annotation)
        metadata = tuple(inside)
    described = [m.description for m in metadata if isinstance(m, DeclaredField) and m.description]
    return replace(
        one,
        annotation=annotation,
        metadata=(*metadata, one, *one.metadata),
        description=one.description or (described or [""])[-1],
    )


def _checked_into(record: Record, data: Any, context: Mapping[str, Any]) -> None:
    place = Place((), context, [])
    _fill(record, data, place)
    if place.faults:
        raise RecordError(place.faults)


def _fill(record: Record, data: Any, place: Place) -> Any:
    cls = type(record)
    if not isinstance(data, Mapping):
        return place.refuse("must be a table of keys", data)
    given = _by_known_key(cls, data)
    found: dict[str, Any] = {}
    names = frozenset(
        name for name, one in cls.model_fields.items() if (one.alias or name) in given
    )
    count = len(place.faults)
    for name, one in cls.model_fields.items():
        key = one.alias or name
        if key in given:
            found[name] = _check_of(cls, name)(given.pop(key), place.inside(key))
        elif one.required:
            place.inside(key).refuse("is missing")
        else:
            found[name] = one.default
    further: dict[str, Any] = {}
    for key, value in given.items():
        if cls.unknown == "refused":
            known = [one.alias or name for name, one in cls.model_fields.items()]
            listed = f"known are {', '.join(known)}"
            remedy = did_you_mean(str(key), known, listed, most=2, cutoff=0.5)
            place.inside(key).refuse("is an unknown key", remedy=remedy)
        elif cls.unknown != "ignored":
            further[key] = _checker(cls.unknown)(value, place.inside(key))
    record.__dict__.update(found, model_fields_set=names, further=further)
    return record if len(place.faults) == count and _fits(record, place) else _REFUSED


def _by_known_key(cls: type[Record], data: Mapping[Any, Any]) -> dict[Any, Any]:
    """The values by the names of their keys, in which ``_`` and ``-`` are equal."""
    if not all(isinstance(key, str) for key in data):
        return dict(data)
    known, found = cls.known_keys(data), dict[str, Any]()
    for key, value in data.items():
        meant = known_name(key, known)
        found[key if meant in found or meant in data else meant] = value
    return found


def _fits(record: Record, place: Place) -> bool:
    """Whether the record passes the checks of the whole of it; each may raise several errors."""
    count = len(place.faults)
    for check, two in _checks_of_record(type(record)):
        try:
            check(record, place) if two else check(record)
        except InputError as error:
            place.faults.extend(Fault(place.key, one, of_part=True) for one in errors_in(error))
            break
        except (ValueError, AssertionError) as error:
            place.refuse(str(error))
            break
    return len(place.faults) == count


def _checks_of_record(cls: type[Record]) -> list[tuple[Any, bool]]:
    if "_record_checks" not in cls.__dict__:
        found = {
            name: method
            for base in reversed(cls.__mro__)
            for name, method in vars(base).items()
            if getattr(method, "checks_record", False)
        }
        checks = [(one, _takes_place(one)) for one in found.values()]
        type.__setattr__(cls, "_record_checks", checks)
    checked: list[tuple[Any, bool]] = cls.__dict__["_record_checks"]
    return checked


def _check_of(cls: type[Record], name: str) -> _Check:
    """The check of a field, made when its first value is checked."""
    checks: dict[str, _Check] = cls.__dict__.get("_checks", {})
    if not checks:
        type.__setattr__(cls, "_checks", checks)
    if name not in checks:
        one = cls.model_fields[name]
        inside = one.metadata
        checks[name] = _checker(Annotated[one.annotation, *inside] if inside else one.annotation)
    return checks[name]


def _checker(kind: Any) -> _Check:
    """The function that checks a value of a type."""
    origin, inside = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return _annotated(_checker(inside[0]), inside[1:])
    if origin in (Union, UnionType):
        return _one_of_types([one for one in inside if one is not NoneType], NoneType in inside)
    if origin is Literal:
        return _one_of_words(inside)
    if origin in (tuple, list):
        return _list_of(origin, inside)
    if origin is dict:
        return _table_of(_checker(inside[1]))
    if isinstance(kind, type) and issubclass(kind, Record):
        return _record_of(kind)
    if kind is Any:
        return lambda value, place: value
    return _PLAIN[kind]


def _annotated(check: _Check, metadata: Iterable[Any]) -> _Check:
    known = [one for one in metadata if hasattr(one, "checked")]
    first = [one.checked for one in known if isinstance(one, Before)]
    then = [one.checked for one in known if not isinstance(one, Before)]
    steps = [*first, check, *then]

    def checked(value: Any, place: Place) -> Any:
        for step in steps:
            value = step(value, place)
            if value is _REFUSED:
                break
        return value

    return checked


def _of_plain_type(kind: Any, accepted: Any, words: str) -> _Check:
    """The check of a type without parts; a truth value is no number."""

    def checked(value: Any, place: Place) -> Any:
        if not isinstance(value, accepted) or (isinstance(value, bool) and kind is not bool):
            return place.refuse(f"must be a valid {words}", value)
        if kind is str and strange_character(value.replace("\n", "").replace("\t", "")):
            return place.refuse("must have no control characters", value)
        try:
            return kind(value)
        except OverflowError:  # of a whole number of over 308 digits
            return place.refuse("must be a finite number", math.inf if value > 0 else -math.inf)

    return checked


_PLAIN: dict[Any, _Check] = {
    float: _of_plain_type(float, int | float, "number"),
    int: _of_plain_type(int, int, "integer"),
    str: _of_plain_type(str, str, "string"),
    bool: _of_plain_type(bool, bool, "boolean"),
}


def _one_of_types(kinds: Sequence[Any], may_be_none: bool) -> _Check:
    checks = [_checker(one) for one in kinds]

    def checked(value: Any, place: Place) -> Any:
        if value is None and may_be_none:
            return None
        for check in checks[:-1]:
            trial = replace(place, faults=[])
            found = check(value, trial)
            if found is not _REFUSED:
                return found
        return checks[-1](value, place)

    return checked


def _one_of_words(words: Sequence[Any]) -> _Check:
    *some, last = map(repr, words)
    text = f"{', '.join(some)} or {last}" if some else last

    def checked(value: Any, place: Place) -> Any:
        known = isinstance(value, str) and value in words
        return value if known else place.refuse(f"must be {text}", value)

    return checked


def _list_of(origin: Any, inside: tuple[Any, ...]) -> _Check:
    endless = origin is list or ... in inside
    checks = [_checker(one) for one in inside if one is not ...]

    def checked(value: Any, place: Place) -> Any:
        if not isinstance(value, list | tuple):
            return place.refuse("must be a list", value)
        if not endless and len(value) != len(checks):
            count = len(value)
            return place.refuse(f"must have {len(checks)} entries", count, found=f"has {count}")
        each = checks * len(value) if endless else checks
        found = [
            check(one, place.inside(i))
            for i, (check, one) in enumerate(zip(each, value, strict=True))
        ]
        return _REFUSED if any(one is _REFUSED for one in found) else origin(found)

    return checked


def _table_of(check: _Check) -> _Check:
    def checked(value: Any, place: Place) -> Any:
        if not isinstance(value, Mapping):
            return place.refuse("must be a table of keys", value)
        if any(_PLAIN[str](key, place.inside(str(key))) is _REFUSED for key in value):
            return _REFUSED
        found = {key: check(one, place.inside(key)) for key, one in value.items()}
        return _REFUSED if any(one is _REFUSED for one in found.values()) else found

    return checked


def _record_of(kind: type[Record]) -> _Check:
    def checked(value: Any, place: Place) -> Any:
        return value if isinstance(value, kind) else _fill(kind.__new__(kind), value, place)

    return checked


@cache  # a page writes its study several times for each step of a slider
def _writers(
    kind: type[Record], by_alias: bool
) -> tuple[tuple[str, DeclaredField, str, Written | None], ...]:
    """Of each field of a record: its name, itself, its key, and how it is written."""
    return tuple(
        (
            name,
            one,
            one.alias if by_alias and one.alias else name,
            next((m for m in one.metadata if isinstance(m, Written)), None),
        )
        for name, one in kind.model_fields.items()
    )


def _plain(value: Any, options: Mapping[str, Any]) -> Any:
    if value is None or isinstance(value, str | int | float):
        return value
    if isinstance(value, Record):
        return value.model_dump(**options)
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, Mapping):
        return {key: _plain(one, options) for key, one in value.items()}
    if isinstance(value, list | tuple):
        found = [_plain(one, options) for one in value]
        return tuple(found) if isinstance(value, tuple) and options["mode"] == "python" else found
    return value


# ---- schema ----


def _of_record(cls: type[Record], definitions: dict[str, Any]) -> dict[str, Any]:
    properties, required = {}, []
    for name, one in cls.model_fields.items():
        key = one.alias or name
        about = _of_type(one.annotation, definitions) | _of_metadata(one.metadata)
        if not one.required:
            about["default"] = _plain(one.default, {"mode": "json", "by_alias": True})
        else:
            required.append(key)
        if one.description:
            about["description"] = one.description
        if not any("$ref" in part for part in (about, *about.get("anyOf", ()))):
            about["title"] = key.replace("_", " ").title()
        properties[key] = dict(sorted(about.items()))
    schema: dict[str, Any] = {"properties": properties, "title": cls.__name__, "type": "object"}
    if cls.unknown == "refused":
        schema["additionalProperties"] = False
    elif cls.unknown != "ignored":
        schema["additionalProperties"] = _of_type(cls.unknown, definitions)
    if cls.__doc__:
        schema["description"] = inspect.cleandoc(cls.__doc__)
    if required:
        schema["required"] = required
    return dict(sorted(schema.items()))


def _of_metadata(metadata: Iterable[Any]) -> dict[str, Any]:
    """What the bounds of a field add to its type."""
    found: dict[str, Any] = {}
    for one in metadata:
        if isinstance(one, DeclaredField):
            bounds = {
                "minimum": one.ge,
                "exclusiveMinimum": one.gt,
                "maximum": one.le,
                "exclusiveMaximum": one.lt,
                "minItems": one.min_length,
                "maxItems": one.max_length,
            }
            found |= {key: value for key, value in bounds.items() if value is not None}
        elif hasattr(one, "schema"):
            found |= one.schema()
    return found


_JSON_TYPES: dict[Any, str] = {
    float: "number",
    int: "integer",
    str: "string",
    bool: "boolean",
    NoneType: "null",
}


def _of_type(kind: Any, definitions: dict[str, Any]) -> dict[str, Any]:
    origin, inside = get_origin(kind), get_args(kind)
    if origin is Annotated:
        about = _of_type(inside[0], definitions) | _of_metadata(inside[1:])
        if about.get("type") == "string":
            names = {"minItems": "minLength", "maxItems": "maxLength"}
            about = {names.get(key, key): value for key, value in about.items()}
        return dict(sorted(about.items()))
    if origin in (Union, UnionType):
        return {"anyOf": [_of_type(one, definitions) for one in inside]}
    if origin is Literal:
        words = {"enum": list(inside)} if len(inside) > 1 else {"const": inside[0]}
        return {**words, "type": "string"}
    if origin is list or (origin is tuple and ... in inside):
        return {"items": _of_type(inside[0], definitions), "type": "array"}
    if origin is tuple:
        return {
            "maxItems": len(inside),
            "minItems": len(inside),
            "prefixItems": [_of_type(one, definitions) for one in inside],
            "type": "array",
        }
    if origin is dict:
        return {"additionalProperties": _of_type(inside[1], definitions), "type": "object"}
    if isinstance(kind, type) and issubclass(kind, Record):
        if kind.__name__ not in definitions:
            definitions[kind.__name__] = {}
            definitions[kind.__name__] = _of_record(kind, definitions)
        return {"$ref": f"#/$defs/{kind.__name__}"}
    return {"type": _JSON_TYPES[kind]} if kind in _JSON_TYPES else {}
