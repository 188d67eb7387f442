"""Dataclasses with shared methods: the standard ones generate theirs, 60 ms at each start."""

from dataclasses import MISSING, FrozenInstanceError, dataclass, fields, is_dataclass
from inspect import Parameter, Signature
from typing import TYPE_CHECKING, Any, NoReturn

if not TYPE_CHECKING:
    _standard = dataclass

    def dataclass(cls=None, *, frozen=False, eq=True, repr=True, kw_only=False):
        """As `dataclasses.dataclass` of the same options, without ``__slots__``."""
        if cls is None:
            return lambda cls: dataclass(cls, frozen=frozen, eq=eq, repr=repr, kw_only=kw_only)
        cls.__doc__ = cls.__doc__ or f"{cls.__name__}."  # the standard one writes the signature
        frozen_base = frozen and any(map(is_dataclass, cls.__mro__[1:]))  # must be frozen as it is
        _standard(cls, init=False, repr=False, eq=False, frozen=frozen_base, kw_only=kw_only)
        cls.__dataclass_params__.frozen = frozen
        for one in fields(cls):
            if one.default is not MISSING and vars(cls).get(one.name, MISSING) is one.default:
                delattr(cls, one.name)
        shared = {"__init__": _init, "__signature__": _LazySignature()}
        if repr:
            shared["__repr__"] = _repr
        if eq:
            shared |= {"__eq__": _equal, "__hash__": _hash if frozen else None}
        if frozen:
            shared |= {"__setattr__": _refuse, "__delattr__": _refuse}
        for name, method in shared.items():
            if vars(cls).get(name) is None:
                setattr(cls, name, method)
        cls._declared = _Declared()
        return cls


class _Declared:
    """What `_init` needs of a class, found when its first instance is made."""

    def __get__(self, one: Any, cls: Any) -> tuple[Any, ...]:
        known = fields(cls)
        cls._declared = (
            [one.name for one in known if one.init and not one.kw_only],
            {one.name for one in known},
            {one.name for one in known if one.init},
            {one.name: one.default for one in known if one.default is not MISSING},
            {one.name: made for one in known if (made := one.default_factory) is not MISSING},
        )
        found: tuple[Any, ...] = cls._declared
        return found


class _LazySignature:
    """The signature of a class, for `help` and `inspect`."""

    def __get__(self, one: Any, cls: Any) -> Signature:
        if one is not None or cls.__init__ is not _init:
            raise AttributeError("__signature__")
        return Signature(
            [
                Parameter(
                    one.name,
                    Parameter.KEYWORD_ONLY if one.kw_only else Parameter.POSITIONAL_OR_KEYWORD,
                    default=_shown_default(one),
                    annotation=one.type,
                )
                for one in sorted(fields(cls), key=lambda one: bool(one.kw_only))
                if one.init
            ]
        )


def _shown_default(one: Any) -> Any:
    if one.default_factory is not MISSING:
        return one.default_factory()
    return Parameter.empty if one.default is MISSING else one.default


def _init(self: Any, *args: Any, **given: Any) -> None:
    positional, names, accepted, defaults, factories = type(self)._declared
    if args or given.keys() != names:
        where = f"{type(self).__qualname__}.__init__()"
        if len(args) > len(positional):
            raise TypeError(f"{where} takes at most {len(positional)} positional arguments")
        for name, value in zip(positional, args, strict=False):
            if name in given:
                raise TypeError(f"{where} got multiple values for argument {name!r}")
            given[name] = value
        if wrong := given.keys() - accepted:
            raise TypeError(f"{where} got an unexpected keyword argument {min(wrong)!r}")
        given |= {name: one for name, one in defaults.items() if name not in given}
        given |= {name: made() for name, made in factories.items() if name not in given}
        if missing := accepted - given.keys():
            raise TypeError(f"{where} missing required arguments: {', '.join(sorted(missing))}")
    self.__dict__.update(given)
    if check := getattr(self, "__post_init__", None):
        check()


def _repr(self: Any) -> str:
    shown = (f"{one.name}={getattr(self, one.name)!r}" for one in fields(self) if one.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _compared(one: Any) -> tuple[Any, ...]:
    return tuple(getattr(one, field.name) for field in fields(one) if field.compare)


def _equal(self: Any, other: object) -> Any:
    return _compared(self) == _compared(other) if type(self) is type(other) else NotImplemented


def _hash(self: Any) -> int:
    return hash(_compared(self))


def _refuse(self: Any, name: str, *value: Any) -> NoReturn:
    raise FrozenInstanceError(f"cannot {'assign to' if value else 'delete'} field {name!r}")
