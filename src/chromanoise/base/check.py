"""Checks of the arguments of public functions."""

import re
import struct
from collections.abc import Callable, Sequence
from typing import Any
from unicodedata import category

import numpy as np

from chromanoise.base.errors import InputError, did_you_mean, known_name

Array = np.ndarray
"""The array type in annotations with a shape: Float[Array, "n p"]."""


_LONGEST_REASON = 120
_OF_THE_PARSER = (
    ArithmeticError, AssertionError, AttributeError, ImportError, IndexError, NameError,
    NotImplementedError, RecursionError, StopIteration, TypeError, struct.error,
)  # fmt: skip
_INTERNALS = re.compile(r"[<>]|0x[0-9a-f]|__|NoneType|' object\b|\bargument\b|\battribute '", re.I)


def reason(error: Exception) -> str:
    r"""The reason that a third-party parser gives for rejecting a file, on one line.

    Empty if the message is about the parser itself (class names, addresses, arguments).

    Examples
    --------
    >>> reason(ValueError("Bad magic\n number")), reason(ValueError("not <ast.Name object>"))
    ('Bad magic number', '')
    """
    text = str(getattr(error, "strerror", None) or error)
    if error.args and isinstance(error.args[0], bytes):  # as the errors of LibRaw have it
        text = error.args[0].decode(errors="replace")
    text = " ".join(text.split())
    bare_key = isinstance(error, KeyError) and " " not in text
    if bare_key or isinstance(error, _OF_THE_PARSER) or _INTERNALS.search(text):
        return ""
    return text[:_LONGEST_REASON]


def in_brackets(unit: str) -> str:
    """The unit in brackets; nothing for a number without a unit."""
    return "" if unit == "1" else f" [{unit}]"


def finite(name: str, unit: str, values: Any) -> Array:
    """``values`` as float64; raises `InputError` if an entry is NaN or infinite."""
    return _demand(name, unit, values, "finite", np.isfinite)


def non_negative(name: str, unit: str, values: Any) -> Array:
    """``values`` as float64; raises `InputError` if an entry is NaN, infinite or negative."""
    return _demand(name, unit, values, "finite and >= 0", lambda v: np.isfinite(v) & (v >= 0))


def fraction(name: str, unit: str, values: Any) -> Array:
    """``values`` as float64; raises `InputError` if an entry is not between 0 and 1."""
    demand = "between 0 and 1 (percent? divide by 100)"
    return _demand(name, unit, values, demand, lambda v: (v >= 0) & (v <= 1))


def number(text: str, subject: str, requirement: str, **said: Any) -> float:
    """The number that a text is; else raises `InputError`, with what is ``said`` of the text."""
    try:
        return float(text)
    except ValueError:
        raise InputError(subject, requirement, **{"value": text, **said}) from None


def positive(name: str, unit: str, value: float) -> float:
    """A finite number > 0."""
    number = float(value)
    if not (np.isfinite(number) and number > 0):
        raise InputError(name, f"must be finite and > 0{in_brackets(unit)}", value=number)
    return number


def not_negative(name: str, unit: str, value: float) -> float:
    """A finite number >= 0."""
    number = float(value)
    if not (np.isfinite(number) and number >= 0):
        raise InputError(name, f"must be finite and >= 0{in_brackets(unit)}", value=number)
    return number


def within(name: str, unit: str, value: float, low: float, high: float) -> float:
    """A finite number from ``low`` to ``high``, the range in which double precision suffices."""
    number = float(value)
    if not low <= number <= high:
        raise InputError(name, f"must be {low:g} to {high:g}{in_brackets(unit)}", value=number)
    return number


def at_least_one(name: str, count: float | None) -> None:
    """Raise `InputError` if a count is given and less than 1."""
    if count is not None and count < 1:
        raise InputError(name, "must be at least 1", value=count)


def whole(name: str, value: Any, least: int, most: int, *, most_as: str = "") -> int:
    """A whole number from ``least`` to ``most``, which an error may write in another way.

    Examples
    --------
    >>> whole("frames", 12.0, 2, 1000)
    12
    """
    if isinstance(value, bool) or not least <= value <= most or int(value) != value:
        demand = f"must be a whole number from {least} to {most_as or most}"
        raise InputError(name, demand, value=value)
    return int(value)


def whole_of_bits(name: str, value: Any, bits: int) -> int:
    """A whole number >= 0 of so many bits."""
    return whole(name, value, 0, (1 << bits) - 1, most_as=f"2^{bits} - 1")


def increasing(name: str, unit: str, values: Any) -> Array:
    """At least two finite values, each larger than the one before."""
    array = finite(name, unit, values)
    if array.ndim != 1 or array.size < 2:
        raise InputError(
            name,
            f"must hold at least 2 values in a row{in_brackets(unit)}",
            found=f"has shape {array.shape}",
        )
    falls = np.flatnonzero(np.diff(array) <= 0)
    if falls.size:
        i = int(falls[0])
        raise InputError(
            name,
            f"must increase{in_brackets(unit)}",
            value=float(array[i + 1]),
            found=f"{array[i + 1]:g} follows {array[i]:g} at index {i + 1}",
            remedy="sort the rows and drop repeated ones",
        )
    return array


def same_length(what: str, **lengths: int) -> None:
    """Raise `InputError` if the numbers of ``what`` differ."""
    if len(set(lengths.values())) > 1:
        found = ", ".join(f"{name} has {count}" for name, count in lengths.items())
        raise InputError(f"the number of {what}", "must be the same", value=lengths, found=found)


def distinct(name: str, values: Sequence[str]) -> tuple[str, ...]:
    """``values`` as a tuple; raises `InputError` if a name is empty or repeated."""
    names, before = tuple(values), set[str]()
    for i, value in enumerate(names):
        if not value:
            raise InputError(name, "must not be empty", value="", found=f"entry {i} is")
        if value in before:
            raise InputError(
                name, "must differ", value=value, found=f"{value!r} is repeated (entry {i})"
            )
        before.add(value)
    return names


def shown_names(name: str, values: Sequence[str]) -> tuple[str, ...]:
    """`distinct` names that can be shown; one with a `strange_character` raises `InputError`."""
    for value in values:
        if not isinstance(value, str):
            raise InputError(name, "must be text", value=value)
        if strange_character(value):
            need, found = "must have no control characters", f"{value!a} has one"
            raise InputError(name, need, value=value, found=found, remedy="rename it")
    return distinct(name, values)


def strange_character(text: str) -> str | None:
    """The first character that is no text: control, surrogate, line separator, noncharacter."""
    if text.isprintable():  # most texts
        return None
    return next((c for c in text if category(c) in _NO_TEXT or c in "\ufffe\uffff"), None)


_NO_TEXT = ("Cc", "Cs", "Zl", "Zp")


def one_of(name: str, value: str, choices: Sequence[str]) -> str:
    """The choice that ``value`` is, as `known_name`; an error suggests the nearest choices."""
    return among(name, known_name(str(value), choices), choices)


def among(name: str, value: str, choices: Sequence[str]) -> str:
    """``value`` if it is one of ``choices``, letter by letter, as names of channels are."""
    if value in choices:
        return value
    hint = did_you_mean(str(value), choices, f"known: {', '.join(choices)}")
    raise InputError(name, "must be a known name", value=value, remedy=hint)


def shape(subject: str, array: Any, holds: bool, requirement: str) -> None:
    """Raise `InputError` with the shape of an array unless the requirement ``holds``."""
    if not holds:
        found = f"has shape {array.shape}"
        raise InputError(subject, requirement, value=array.shape, found=found)


def same_names(what: str, **names: tuple[str, ...]) -> None:
    """Raise `InputError` if the names of channels differ in content or order."""
    if len(set(names.values())) > 1:
        found = ", ".join(f"{whose} has {', '.join(own)}" for whose, own in names.items())
        raise InputError(
            what, "channels must be the same in the same order", value=names, found=found
        )


def frozen(array: Array) -> Array:
    """A read-only copy, so that the caller cannot change an immutable object."""
    kept = np.array(array)
    kept.flags.writeable = False
    return kept


def freeze(noun: object, *fields: str) -> None:
    """Replace array fields of a frozen dataclass by read-only copies; ``None`` stays."""
    values = {field: getattr(noun, field) for field in fields}
    keep(noun, **{field: value for field, value in values.items() if value is not None})


def keep(noun: object, **arrays: Array) -> None:
    """Set array fields of a frozen dataclass, as it is created, to read-only copies."""
    for field, array in arrays.items():
        object.__setattr__(noun, field, frozen(array))


def _demand(
    name: str, unit: str, values: Any, demand: str, holds: Callable[[Array], Array]
) -> Array:
    array = np.asarray(values, dtype=np.float64)
    held = holds(array)
    if np.count_nonzero(held) < held.size:
        bad = ~held
        index = tuple(int(i) for i in np.argwhere(bad)[0])
        first = float(array[index])
        count = f"{int(bad.sum())} of {array.size} entries are not"
        raise InputError(
            name,
            f"must be {demand}{in_brackets(unit)}",
            value=first,
            found=f"{count}; the first is {first:g} at index {index} (from 0)",
        )
    return array


def printable(name: str, most: int | None = 40) -> str:
    r"""A name from a file, shortened, with unprintable characters replaced.

    Examples
    --------
    >>> printable("wave\x00length")
    'wave?length'
    """
    return "".join(c if c.isprintable() else "?" for c in name[:most])
