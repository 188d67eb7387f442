"""Arrays of real numbers and text in MATLAB files of versions 4 and 5 (``save -v7`` and before).

SciPy reads them, in the child process of ``chromanoise.base.sandbox``, because it crashes on some
damaged files (scipy/scipy, pull request 25349). It accepts compressed arrays without their
checksum, so the parts of a file are checked before.
"""

import io
import math
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from chromanoise.base import Array, InputError, Shaped, check, sandbox
from chromanoise.io.source_files import refuse_not_numbers, refused

_Read = TypeVar("_Read")
_START_BYTES = 128
_ORDERS = {b"\x00\x01IM": "<", b"\x01\x00MI": ">"}
_MATRIX, _COMPRESSED = 14, 15
_NUMBERS = frozenset(
    {"double", "single"} | {f"{u}int{8 * n}" for u in ("", "u") for n in (1, 2, 4, 8)}
)
_OTHERS = {"logical": "?", "char": "U"}
_MOST_WORDS = 10_000
_LIMIT_S, _SLOWEST_BYTES_PER_S = 20.0, 1e7


def is_matlab(content: bytes) -> bool:
    """Whether these are the first bytes of a MATLAB file of version 4 or 5."""
    start = content.startswith(b"MATLAB 5.0") or content[124:128] in _ORDERS
    return start or _is_of_version_4(content)


def mat_arrays(path: Path) -> dict[str, tuple[tuple[int, ...], np.dtype]]:
    """Shape and type of every variable, without its numbers; cells and structs are objects.

    Raises
    ------
    InputError
        If the file has another MATLAB version, or is damaged.
    """
    arrays: dict[str, tuple[tuple[int, ...], np.dtype]] = {}
    for name, shape, kind in _in_child(_listed, path):
        if name in arrays:
            raise _damage(path, f"the array {name!r} appears twice")
        known = kind if kind in _NUMBERS else _OTHERS.get(kind, "O")
        arrays[name] = shape, np.dtype(known)
    return arrays


def mat_array(path: Path, name: str) -> Shaped[Array, "..."]:
    """The numbers of one variable, in the type in which MATLAB stored them.

    Raises
    ------
    InputError
        If the variable is damaged or has complex numbers.
    """
    shape, dtype = mat_arrays(path)[name]
    found = _in_child(_variable, path, name, size=math.prod(shape) * dtype.itemsize)
    if found.dtype.kind == "c":  # which SciPy does not tell before
        refuse_not_numbers(path, name, found.dtype)
    return found


def mat_texts(path: Path, name: str) -> tuple[str, ...]:
    """The texts of one variable: rows of characters, or a cell array of them; else empty.

    Raises
    ------
    InputError
        If the variable is damaged.
    """
    found = np.asarray(_in_child(_variable, path, name))
    if found.dtype.kind != "O":
        return _rows_of_text(found)
    cells = found.ravel(order="F")[:_MOST_WORDS]
    return tuple(next(iter(_rows_of_text(np.asarray(cell))), "") for cell in cells)


def _rows_of_text(found: Array) -> tuple[str, ...]:
    rows = found.ravel()[:_MOST_WORDS] if found.dtype.kind == "U" else ()
    return tuple(str(row).rstrip() for row in rows)


def _is_of_version_4(content: bytes) -> bool:
    """Whether the file begins with a header of version 4, which has no mark of its own.

    Its type has four decimal digits: byte order, 0, form of the numbers, and full, text or sparse.
    """
    for order, machine in (("<", 0), (">", 1)) if len(content) >= 20 else ():
        kind, rows, columns, imaginary, length = struct.unpack_from(f"{order}5i", content)
        plain = kind // 100 == 10 * machine and kind // 10 % 10 < 6 and kind % 10 < 3
        name = content[20 : 20 + max(length, 0)]
        named = 1 < length < 65 and name.endswith(b"\0") and name[:-1].replace(b"_", b"a").isalnum()
        if plain and named and rows >= 0 and columns >= 0 and imaginary in (0, 1):
            return True
    return False


def _in_child(function: Callable[..., _Read], path: Path, *given: Any, size: int = 0) -> _Read:
    """What a function of the child process returns; ``size`` is that of the numbers. [bytes]"""
    size += path.stat().st_size
    try:
        return sandbox.sandboxed(
            _refusing,
            function,
            path,
            *given,
            path=path,
            limit_s=_LIMIT_S + size / _SLOWEST_BYTES_PER_S,
            memory_bytes=sandbox.MEMORY_BYTES + 4 * size,
        )
    except InputError:
        raise
    except ValueError as error:  # SciPy crashed
        raise _unread(path, error, *given) from None


def _unread(path: Path, error: Exception, *given: Any) -> InputError:
    what = f"array {given[0]!r} cannot be read" if given else check.reason(error)
    return _damage(path, what or "it cannot be read")


def _damage(path: Path, what: str) -> InputError:
    return refused(path, f"is damaged or cut short: {what}", remedy="save it again")


# in the child process


def _refusing(function: Callable[..., _Read], path: Path, *given: Any) -> _Read:
    """The result; exceptions of SciPy become an error here, so that this process goes on."""
    try:
        return function(path, *given)
    except (InputError, MemoryError):
        raise
    except Exception as error:
        raise _unread(path, error, *given) from None


def _listed(path: Path) -> list[tuple[str, tuple[int, ...], str]]:
    from scipy.io import whosmat

    return [one for one in whosmat(_whole(path)) if one[0] != "__function_workspace__"]


def _variable(path: Path, name: str) -> Any:
    from scipy.io import loadmat

    found = loadmat(_whole(path), variable_names=[name])[name]
    if isinstance(found, str):
        raise ValueError(found)  # SciPy's message about the fault
    return found


def _whole(path: Path) -> io.BytesIO:
    """The content of a file whose parts are complete, without the zeros that may end it."""
    content = path.read_bytes()
    order, size = _ORDERS.get(content[124:128]), len(content)
    if _is_of_version_4(content):
        return io.BytesIO(content)
    if order is None:
        remedy = ("save it with -v7", "convert it to .npz")
        raise refused(path, "is not a MATLAB file of version 5", remedy=remedy)
    at = _START_BYTES
    while at < size:
        kind, count = struct.unpack(order + "II", content[at : at + 8].ljust(8, b"\0"))
        if not kind and not content[at:].strip(b"\0"):
            break
        if kind not in (_MATRIX, _COMPRESSED) or at + 8 + count > size:
            raise _damage(path, f"byte {at} begins no array within the file's {size} bytes")
        if kind == _COMPRESSED and not _is_complete(content[at + 8 : at + 8 + count], order):
            raise _damage(path, "a compressed array does not end where it should")
        at += 8 + count
    return io.BytesIO(content[:at])


def _is_complete(packed: bytes, order: str) -> bool:
    """Whether an array inflates to the length that its tag declares, and has its checksum."""
    inflater = zlib.decompressobj()
    try:
        tag = inflater.decompress(packed, 8)
        left = struct.unpack(order + "I", tag[4:8].ljust(4, b"\0"))[0]
        while left >= 0 and not inflater.eof:
            part = inflater.decompress(inflater.unconsumed_tail, 2**20)
            left -= len(part)
            if not part and not inflater.eof:
                return False
    except zlib.error:
        return False
    return bool(left == 0)
