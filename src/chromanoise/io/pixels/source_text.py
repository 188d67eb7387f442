"""Text and JSON of files that describe a pixel: one sentence where they cannot be read."""

import json
from pathlib import Path
from typing import Any

from chromanoise._inputs import regular_file
from chromanoise.errors import InputError

_LARGEST_BYTES = 64 * 2**20


def source_text(path: Path) -> str:
    """The text of a small UTF-8 file.

    Raises
    ------
    InputError
        If it cannot be read, is too large, or is not text.
    """
    regular_file(path)
    try:
        with path.open("rb") as file:
            content = file.read(_LARGEST_BYTES + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    if len(content) > _LARGEST_BYTES:
        raise InputError(f"{path}: more than {_LARGEST_BYTES // 2**20} MiB are no table of a pixel")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: not a UTF-8 text file (byte {error.start} is not text); save it as UTF-8"
        ) from None


def source_json(text: str, where: str) -> Any:
    """What JSON text holds.

    Raises
    ------
    InputError
        If it is not JSON, names a key twice, or nests too deep.
    """
    try:
        return json.loads(text, object_pairs_hook=_once)
    except json.JSONDecodeError as error:
        raise InputError(f"{where}: line {error.lineno} is not JSON ({error.msg})") from None
    except _TwiceError as error:
        raise InputError(f"{where}: {str(error)[:60]!r} stands twice; keep one") from None
    except (RecursionError, ValueError):  # a number of thousands of digits is a ValueError
        raise InputError(f"{where}: JSON nests too deep or holds a number too long") from None


class _TwiceError(Exception):
    pass


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise _TwiceError(key)
        found[key] = value
    return found


def finite_number(value: Any) -> float | None:
    """``value`` as a float if it is a finite number of JSON, else ``None``."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if abs(number) < float("inf") else None
