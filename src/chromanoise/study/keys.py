"""The keys of a study with their types, defaults, descriptions and interfaces."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from types import MappingProxyType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from chromanoise.properties import Interface
from chromanoise.study.document import Known, Study


@dataclass(frozen=True, slots=True, kw_only=True)
class KeyOfStudy:
    """A key of a study that holds a value.

    Attributes
    ----------
    key
        With ``*`` for a sensor and ``0`` for an entry of another list: ``sensors.*.pixel.dsnu_e``.
    field
        Its type, default and description.
    interface
        How interfaces offer it; ``None`` for a key of study files alone.
    """

    key: str
    field: FieldInfo
    interface: Interface | None

    @property
    def keyword(self) -> str | None:
        """Its flat name as a setting; ``None`` if it is none."""
        if self.interface is None or self.interface.keyword is None:
            return None
        return self.interface.keyword or self.key.rpartition(".")[2]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of which its word is one; other words may be possible too."""
        found = [one for one in _inside(self) if isinstance(one, Known)]
        return found[0].names if found else ()

    @property
    def others(self) -> bool:
        """Whether it takes other words than `names`."""
        return any(one.others for one in _inside(self) if isinstance(one, Known))

    @property
    def type(self) -> Any:
        """Type of its value in Python, without ``None``."""
        if self.interface is not None and self.interface.each:
            return Sequence[str]
        return _of_python(self.field.annotation, self.interface or Interface())


def _inside(one: KeyOfStudy) -> list[Any]:
    """The metadata and the types of a field, also those inside a union."""
    return [*one.field.metadata, *_parts_of(one.field.annotation)]


def _parts_of(annotation: Any) -> list[Any]:
    """A type with all types and metadata inside it."""
    return [annotation, *(part for one in get_args(annotation) for part in _parts_of(one))]


_MAPPING: Any = Mapping  # types of values, which type checkers do not follow
_SEQUENCE: Any = Sequence
_TUPLE: Any = tuple


def _of_python(annotation: Any, interface: Interface) -> Any:
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _of_python(inside[0], interface)
    if origin in (Union, UnionType):
        kinds = [_of_python(one, interface) for one in inside if one is not type(None)]
        return reduce(lambda a, b: a | b, kinds)
    if origin is dict:
        return _MAPPING[str, _of_python(inside[1], interface)]
    if origin is tuple:
        ends = [_of_python(one, Interface()) for one in inside if one is not ...]
        return _SEQUENCE[ends[0]] if ... in inside else _TUPLE[*ends]
    if annotation is str and interface.curves:
        return str | Path | object
    return str | Path if annotation is str and interface.paths else annotation


def _walked(model: type[BaseModel], prefix: str) -> Iterator[KeyOfStudy]:
    for name, field in model.model_fields.items():
        key = f"{prefix}{field.alias or name}"
        inside = _parts_of(field.annotation)
        part = next((p for p in inside if isinstance(p, type) and issubclass(p, BaseModel)), None)
        if part is not None:
            many = any(get_origin(p) is tuple for p in inside)
            index = ("*." if name == "sensors" else "0.") if many else ""
            yield from _walked(part, f"{key}.{index}")
            continue
        interface = next((one for one in field.metadata if isinstance(one, Interface)), None)
        yield KeyOfStudy(key=key, field=field, interface=interface)


KEYS: Mapping[str, KeyOfStudy] = MappingProxyType({one.key: one for one in _walked(Study, "")})
"""The keys of a study that hold values, in the order of its classes."""
