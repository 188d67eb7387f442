"""JSON in schemas of our own, with a version: all digits, and no other version is read."""

import json
from collections.abc import Mapping
from typing import Any

from chromanoise._check import InputError

SCHEMA_VERSION = 1
"""Of every schema; a file of another version is not read."""


def as_json(told: Mapping[str, Any]) -> str:
    """Text with all digits; what is not finite is an error."""
    return json.dumps(told, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def named(error: InputError, source: str) -> InputError:
    """The complaint of a noun, with the file from which the noun was to be made."""
    told = str(error)
    return InputError(told if source in told else f"{source}: {told}")


def held_json(text: str, schema: str, *, source: str) -> dict[str, Any]:
    """What a text in one of our own schemas holds.

    Parameters
    ----------
    text
        The whole file.
    schema
        Which one: ``chromanoise sensor``, for example.
    source
        Where the text is from, for the complaint.

    Raises
    ------
    InputError
        If it is no JSON, or of another schema or version.
    """
    try:
        held = json.loads(text)
    except (ValueError, RecursionError):
        raise InputError(f"{source}: not JSON; give a file with the schema {schema!r}") from None
    if not isinstance(held, dict) or held.get("schema") != schema:
        raise InputError(f"{source}: its schema must be {schema!r}")
    if held.get("schema_version") != SCHEMA_VERSION:
        raise InputError(
            f"{source}: schema_version must be {SCHEMA_VERSION}, but is "
            f"{str(held.get('schema_version'))[:20]}; read it with the version that wrote it"
        )
    return held
