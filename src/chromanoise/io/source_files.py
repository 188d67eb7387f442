"""What all readers share: errors about a file, small texts, numbers, XML without entities."""

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from chromanoise.base import InputError, Remedy, Setting, first_bytes


def refused(
    source: Path | str,
    requirement: str,
    value: Any = None,
    found: str | None = "",
    *,
    where: str = "",
    remedy: Remedy | Sequence[Remedy] = (),
) -> InputError:
    """The error about a file, or about something in it; the arguments are those of `InputError`."""
    return InputError(
        str(source), requirement, value=value, found=found, where=where, remedy=remedy
    )


def has(
    source: Path | str, requirement: str, value: Any, verb: str = "has", **more: Any
) -> InputError:
    """The error about a count, name or shape, which is both value and description: ``has 3``."""
    text = by(value) if isinstance(value, tuple) else value
    return refused(source, requirement, value, f"{verb} {text}", **more)


@contextmanager
def errors_within(source: Path | str, place: str | None = None) -> Iterator[None]:
    """Errors that are raised inside are about a part of a file, with `InputError.within`."""
    try:
        yield
    except InputError as error:
        raise error.within(str(source), place) from None


def by(shape: tuple[int, ...]) -> str:
    """A shape as text: 156x9025."""
    return "x".join(str(n) for n in shape) or "scalar"


def refuse_not_numbers(path: Path, name: str, dtype: np.dtype) -> None:
    """Raise an error for text, objects, complex numbers and booleans."""
    if dtype.kind not in "fiu":
        need = "must hold real numbers"
        found = f"is of type {kind_of(dtype)}"
        remedy = ("save it as a plain array of real numbers", Setting("key"))
        raise refused(path, need, kind_of(dtype), found, where=f"array {name!r}", remedy=remedy)


def kind_of(dtype: np.dtype) -> str:
    """The name of a type of numbers, for messages."""
    return "object" if dtype.hasobject else dtype.name


def real_of(text: str) -> float:
    """The number that a text is; NaN if it is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def small_text(path: Path, most_bytes: int, need: str, remedy: str = "") -> str:
    """The text of a UTF-8 file.

    Parameters
    ----------
    most_bytes, need
        Largest size [bytes], and the requirement that a larger file violates.
    remedy
        The remedy if it is not text; empty for none.

    Raises
    ------
    InputError
        If the file cannot be read, is too large, or is not text.
    """
    content = first_bytes(path, most_bytes + 1)
    if len(content) > most_bytes:
        raise refused(path, need, found="is larger")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        where, remedies = f"byte {error.start}", (remedy,) if remedy else ()
        raise refused(path, "is not UTF-8 text", where=where, remedy=remedies) from None


def xml_root(text: str, source: str) -> ElementTree.Element:
    """The root element of an XML text.

    Parameters
    ----------
    text
        Decoded; an encoding in its declaration is not used.
    source
        Name of the file, for messages.

    Raises
    ------
    InputError
        If the text is not XML, or declares a document type or entity, which could expand to any
        size.
    """
    if re.search(r"<!\s*(DOCTYPE|ENTITY)", text, re.IGNORECASE):
        raise refused(source, "must not declare a document type", remedy="remove it")
    plain = re.sub(r"\A\s*<\?xml[^>]*\?>", "", text)
    try:
        return ElementTree.fromstring(plain)
    except ElementTree.ParseError as error:
        line, column = error.position
        line += text[: text.find("?>") + 2].count("\n") if plain != text else 0
        raise refused(
            source, f"is not XML ({error})", where=f"line {line}, column {column + 1}"
        ) from None
