"""What all readers share: errors about a file, small texts, numbers, XML without entities."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from chromanoise.base import InputError, Remedy


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


def by(shape: tuple[int, ...]) -> str:
    """A shape as text: 156x9025."""
    return "x".join(str(n) for n in shape) or "scalar"


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
