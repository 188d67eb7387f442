"""Read text of files that describe a pixel, with one error for each fault."""

from collections.abc import Iterator
from contextlib import contextmanager
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
        If the file cannot be read, is too large, or is not text.
    """
    regular_file(path)
    try:
        with path.open("rb") as file:
            content = file.read(_LARGEST_BYTES + 1)
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})") from None
    if len(content) > _LARGEST_BYTES:
        raise InputError(
            str(path),
            f"must be at most {_LARGEST_BYTES // 2**20} MiB to describe a pixel",
            found="is larger",
        )
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            str(path),
            "is not UTF-8 text",
            where=f"byte {error.start}",
            remedy="save it as UTF-8",
        ) from None


def in_file(error: InputError, path: Path) -> InputError:
    """The error with the file as its subject; the former subject becomes a place in the file.

    Parameters
    ----------
    error
        An error about the file, about a part of it (``pitch_um of sheet.txt``), or about a value.
    path
        The file.

    Examples
    --------
    >>> error = InputError("pitch_um of a.txt", "must be finite and > 0 [um]", value=0.0)
    >>> str(in_file(error, Path("sheets/a.txt")))
    'sheets/a.txt, pitch_um: must be finite and > 0 [um], but is 0'
    """
    if error.subject == str(path):
        return error
    part = "" if error.subject == path.name else error.subject.removesuffix(f" of {path.name}")
    return error.within(str(path), part)


@contextmanager
def errors_in_file(path: Path) -> Iterator[None]:
    """Turn errors that are raised inside into errors about the file, with `in_file`."""
    try:
        yield
    except InputError as error:
        raise in_file(error, path) from None


def finite_number(value: Any) -> float | None:
    """``value`` as a float if it is a finite number of JSON, else ``None``."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if abs(number) < float("inf") else None
