"""Input files: checks of paths, strict JSON, and content hashes.

Only regular files are read, because reading a pipe or a device may never end. All JSON is read
here, strictly: nothing that it returns breaks a later computation or output.
"""

import hashlib
import json
import os
import re
import stat
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from chromanoise.base.errors import InputError

MOST_DEPTH = 64
"""Deepest nesting of lists and objects in JSON that is read."""

_LARGEST, _MOST_DIGITS = sys.float_info.max, 400
_SURROGATE = re.compile("[\ud800-\udfff]")

_KINDS = (
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISDIR, "a directory"),
)


def regular_file(path: Path, *, folder: bool = False, pipe: bool = False) -> os.stat_result:
    """The status of a file that can be read to its end without waiting for another process.

    Parameters
    ----------
    path
        The file. It is not opened, because opening a pipe may wait forever.
    folder
        Whether a folder is accepted too.
    pipe
        Whether a pipe that this process inherited (``/dev/stdin``, ``/dev/fd/63``) is accepted
        too; the caller bounds how much of it is read.

    Raises
    ------
    InputError
        If there is no such file, or it is a pipe, a device, a socket or a folder.
    """
    try:
        status = path.stat()
    except (OSError, ValueError) as error:  # a null byte in a name is a ValueError
        why = getattr(error, "strerror", None) or error
        raise InputError(str(path)[:200], f"cannot be read ({why})") from None
    mode = status.st_mode
    if stat.S_ISREG(mode) or (folder and stat.S_ISDIR(mode)):
        return status
    if pipe and stat.S_ISFIFO(mode) and path.absolute().parent in (Path("/dev"), Path("/dev/fd")):
        return status
    kind = next((word for test, word in _KINDS if test(mode)), "of another kind")
    raise InputError(str(path), "must be a regular file", value=kind, found=f"is {kind}")


@contextmanager
def system_errors_of(path: Path | str) -> Iterator[None]:
    """An error of the system while a file is read becomes an `InputError` that names the file."""
    try:
        yield
    except OSError as error:
        why = error.strerror or str(error) or type(error).__name__
        raise InputError(str(path), f"cannot be read ({why})") from None


def first_bytes(path: Path, count: int, *, pipe: bool = False) -> bytes:
    """The first bytes of a file, or all if there are fewer.

    Parameters
    ----------
    path, pipe
        As `regular_file`.
    count
        How many.

    Raises
    ------
    InputError
        As `regular_file`, or if the file cannot be read.
    """
    regular_file(path, pipe=pipe)
    with system_errors_of(path), path.open("rb") as file:
        return file.read(count)


def true_path(path: Path) -> Path:
    """The absolute path with links followed; links in a loop stay as they are.

    `Path.resolve` raises RuntimeError for such a loop.
    """
    return Path(os.path.realpath(path))


def json_file(path: Path, *, most_bytes: int, any_number: bool = False) -> Any:
    """The data in a file of JSON.

    Parameters
    ----------
    most_bytes
        Largest size that is read.
    any_number
        As for `json_of`.

    Raises
    ------
    InputError
        If it is not a regular file, is too large, or as `json_of`.
    """
    content = first_bytes(path, most_bytes + 1)
    if len(content) > most_bytes:
        raise InputError(
            str(path),
            f"must have at most {most_bytes} bytes, as JSON of this kind",
            value=path.stat().st_size,
        )
    return json_of(content, str(path), any_number=any_number)


def json_of(content: str | bytes, source: str, *, any_number: bool = False) -> Any:
    """The data in a text of JSON.

    Parameters
    ----------
    content
        The text, or its UTF-8.
    source
        The subject of errors.
    any_number
        Whether NaN, infinity and numbers beyond double precision are accepted, because other
        programs write them into the headers of their files.

    Raises
    ------
    InputError
        If it is not JSON; has a key twice; is nested deeper than `MOST_DEPTH`; holds an unpaired
        surrogate, which is not a valid Unicode character; or holds a number that is not finite in
        double precision, unless ``any_number``.
    """

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        members = dict(pairs)
        if len(members) < len(pairs):
            key = Counter(key for key, _ in pairs).most_common(1)[0][0]
            raise InputError(
                source,
                "must have each key once",
                value=key,
                found="it is repeated",
                where=f"key {key[:40]!r}",
                remedy="remove one",
            )
        return members

    def not_finite(word: str) -> float:
        if any_number:
            return float(word)
        raise InputError(source, f"contains {word}, which is not a JSON number")

    def whole(digits: str) -> float:
        # beyond double precision; the parser would raise a ValueError without the place
        return int(digits) if len(digits) <= _MOST_DIGITS else float(digits)

    try:
        text = content if isinstance(content, str) else content.decode("utf-8-sig")
        data = json.loads(text, object_pairs_hook=once, parse_constant=not_finite, parse_int=whole)
    except InputError:
        raise
    except UnicodeDecodeError as error:
        raise InputError(source, "is not UTF-8 text", where=f"byte {error.start}") from None
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise InputError(source, f"is not JSON ({error.msg})", where=where) from None
    except RecursionError:
        raise _too_deep(source) from None
    _refuse_unusable(data, source, any_number)
    return data


def content_hash(record: Mapping[str, Any]) -> str:
    """SHA-256 of all entries of a file of JSON except ``content``, which holds it."""
    rest = {key: value for key, value in record.items() if key != "content"}
    return hashlib.sha256(json.dumps(rest, allow_nan=False).encode()).hexdigest()


def _refuse_unusable(data: Any, source: str, any_number: bool) -> None:
    """Refuse depth, numbers and texts that break a later step; level by level, no recursion."""
    level: list[tuple[tuple[str | int, ...], Any]] = [((), [data])]
    for _ in range(MOST_DEPTH + 1):
        below = []
        for place, held in level:
            if isinstance(held, dict):
                for key in held:
                    _refuse_surrogate(key, place, source)
            for key, value in held.items() if isinstance(held, dict) else enumerate(held):
                kind = type(value)
                if kind is float or kind is int:
                    if not (any_number or -_LARGEST <= value <= _LARGEST):
                        raise InputError(
                            source,
                            "must hold numbers within double precision, to 1.79e308",
                            where=_where((*place, key)),
                            remedy="correct the number",
                        )
                elif kind is str:
                    _refuse_surrogate(value, (*place, key), source)
                elif kind is dict or kind is list:
                    below.append(((*place, key), value))
        if not below:
            return
        level = below
    raise _too_deep(source)


def _refuse_surrogate(text: str, place: tuple[str | int, ...], source: str) -> None:
    if not text.isascii() and _SURROGATE.search(text):
        raise InputError(
            source,
            "must not hold an unpaired surrogate, which is not a character",
            value=text,
            found=f"holds {text[:40]!a}",
            where=_where(place),
            remedy="correct the text",
        )


def _where(place: tuple[str | int, ...]) -> str:
    key = ".".join(map(str, place[1:]))  # the first is that of the whole
    return f"key {key[:80]!a}" if key else ""


def _too_deep(source: str) -> InputError:
    return InputError(
        source, f"must be nested at most {MOST_DEPTH} deep", found="its brackets are nested deeper"
    )
