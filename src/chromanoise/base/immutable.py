"""Dataclasses with shared methods (the standard ones generate theirs, 60 ms at each start)."""

from collections.abc import Callable, Sequence
from dataclasses import MISSING, FrozenInstanceError, dataclass, fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

_Given = ParamSpec("_Given")
_Result = TypeVar("_Result")
_Object = TypeVar("_Object")

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
            if one.init and vars(cls).get(one.name, cls) is one.default:
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
        cls._arguments = _LazyArguments()
        return cls


class _Arguments(NamedTuple):
    """Of the constructor of a class, by name."""

    names: set[str]
    defaults: dict[str, Any]
    factories: dict[str, Callable[[], Any]]
    positional: list[str]


class _LazyArguments:
    """The arguments of a class, found when its first instance is made."""

    def __get__(self, one: Any, cls: Any) -> _Arguments:
        known = [one for one in fields(cls) if one.init]
        cls._arguments = found = _Arguments(
            names={one.name for one in known},
            defaults={one.name: one.default for one in known if one.default is not MISSING},
            factories={
                one.name: made for one in known if (made := one.default_factory) is not MISSING
            },
            positional=[one.name for one in known if not one.kw_only],
        )
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
    expected = type(self)._arguments
    if args:
        given = _with_positional(type(self), args, given)
    if given.keys() != expected.names:
        given = expected.defaults | given
        if given.keys() != expected.names:
            given = _with_made(type(self), given)
    self.__dict__.update(given)
    if check := getattr(self, "__post_init__", None):
        check()


def _with_positional(cls: Any, args: tuple[Any, ...], given: dict[str, Any]) -> dict[str, Any]:
    positional = cls._arguments.positional
    if len(args) > len(positional):
        raise _wrong_arguments(cls, f"takes at most {len(positional)} positional arguments")
    found = dict(zip(positional, args, strict=False))
    if twice := found.keys() & given.keys():
        raise _wrong_arguments(cls, f"got multiple values for argument {min(twice)!r}")
    return found | given


def _with_made(cls: Any, given: dict[str, Any]) -> dict[str, Any]:
    """With the defaults that functions make; all others are there."""
    names, factories = cls._arguments.names, cls._arguments.factories
    if unknown := given.keys() - names:
        raise _wrong_arguments(cls, f"got an unexpected keyword argument {min(unknown)!r}")
    if missing := names - factories.keys() - given.keys():
        raise _wrong_arguments(cls, f"lacks arguments: {', '.join(sorted(missing))}")
    return {name: made() for name, made in factories.items()} | given


def _wrong_arguments(cls: Any, what: str) -> TypeError:
    return TypeError(f"{cls.__qualname__}.__init__() {what}")


def _repr(self: Any) -> str:
    shown = (f"{one.name}={getattr(self, one.name)!r}" for one in fields(self) if one.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _compared(one: Any) -> tuple[Any, ...]:
    values: dict[str, Any] = one.__dict__
    known = vars(type(one)).get("_compared")
    if known is None:  # also of a subclass that another decorator has made
        known = type(one)._compared = [field.name for field in fields(one) if field.compare]
    return tuple([values[name] for name in known])


def _equal(self: Any, other: object) -> Any:
    if self is other:
        return True
    return _compared(self) == _compared(other) if type(self) is type(other) else NotImplemented


def _hash(self: Any) -> int:
    return hash(_compared(self))


def _refuse(self: Any, name: str, *value: Any) -> NoReturn:
    raise FrozenInstanceError(f"cannot {'assign to' if value else 'delete'} field {name!r}")


def kept(function: Callable[_Given, _Result]) -> Callable[_Given, _Result]:
    """A decorator: what a function finds of an object is kept as long as the object lives.

    Results must not be changed, and must not hold the object, which would stay in memory with them.

    Parameters
    ----------
    function
        Of positional arguments that never change. The first is compared by identity, the others by
        hash; neither of these may hold the first. After 64 results for one object, all of them are
        dropped. If an argument cannot be hashed, nothing is kept.
    """
    known: WeakKeyDictionary[Any, dict[tuple[Any, ...], Any]] = WeakKeyDictionary()

    @wraps(function)
    def found(of: Any, /, *others: Any) -> _Result:
        try:
            own = known.get(of)
            result = MISSING if own is None else own.get(others, MISSING)
        except TypeError:
            return function(of, *others)  # type: ignore[call-arg]
        if result is MISSING:  # `get`, because another thread may drop the results at any time
            result = function(of, *others)  # type: ignore[call-arg]
            own = known.setdefault(of, {})
            if len(own) >= _MOST_KEPT:
                own.clear()
            own[others] = result
        return result

    return found  # type: ignore[return-value]


_MOST_KEPT = 64


def kept_of_each(
    function: Callable[[Sequence[_Object]], Sequence[_Result]],
) -> Callable[[Sequence[_Object]], list[_Result]]:
    """A decorator as `kept`, of a function that finds the results of many objects at once.

    Parameters
    ----------
    function
        Takes objects, which are compared by identity, and returns one result for each. It is
        called with those whose result is not kept.
    """
    known: WeakKeyDictionary[_Object, _Result] = WeakKeyDictionary()

    @wraps(function)
    def found(objects: Sequence[_Object]) -> list[_Result]:
        if new := [one for one in objects if one not in known]:
            known.update(zip(new, function(new), strict=True))
        return [known[one] for one in objects]

    return found
