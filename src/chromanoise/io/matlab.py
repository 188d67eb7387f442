"""Arrays of real numbers and text in MATLAB files of versions 4 and 5 (``save -v7`` and before).

The formats are documented in MathWorks, "MAT-File Format". SciPy's reader (1.17) is not
used because it crashes the process on some damaged files instead of raising an error
(scipy/scipy, pull request 25349).
"""

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from chromanoise.base import Array, InputError, Shaped

_START_BYTES = 128
_OPENING_BYTES = 8192  # enough for every part before the numbers
_MATRIX, _COMPRESSED = 14, 15
_FLAGS, _DIMENSIONS, _NAMES = 6, (5, 6), (1, 16)  # 6 and 16: written by other programs
_CELL, _CHARS, _OPAQUE = 1, 4, 17
_OF_LEVEL_4 = ("f8", "f4", "i4", "i2", "u2", "u1")
_TEXT_OF_LEVEL_4 = 1
_MOST_AXES = 64
_MOST_WORDS = 10_000
_MOST_PADDING = 2**16
_COMPLEX_BIT, _LOGICAL_BIT = 0x800, 0x200
_CLASSES = {
    4: "U", 6: "f8", 7: "f4", 8: "i1", 9: "u1", 10: "i2", 11: "u2", 12: "i4", 13: "u4",
    14: "i8", 15: "u8",
}  # fmt: skip
_PACKED_AS = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8",
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class _Variable:
    """One variable, without its numbers.

    Attributes
    ----------
    name, shape, dtype
        Name, shape and type; the type of text is ``U``, also if it is stored as numbers.
    start, size, compressed, order
        Its bytes in the file, without the tag of version 5 or the header of version 4.
    length
        Bytes of its header after the tag, in version 5.
    stored
        Type in the file, in version 4; None in version 5, which declares it after the header.
    """

    name: str
    shape: tuple[int, ...]
    dtype: np.dtype
    start: int = 0
    size: int = 0
    compressed: bool = False
    order: str = ""
    length: int = 0
    stored: np.dtype | None = None


def is_matlab(content: bytes) -> bool:
    """Whether these are the first bytes of a MATLAB file of version 4 or 5."""
    return (
        content.startswith(b"MATLAB 5.0")
        or content[124:128] in (b"\x00\x01IM", b"\x01\x00MI")
        or _header_4(content) is not None
    )


def mat_arrays(path: Path) -> dict[str, tuple[tuple[int, ...], np.dtype]]:
    """Shape and type of every variable, without reading numbers; cells and structs are objects.

    Raises
    ------
    InputError
        If the file has another MATLAB version, or is damaged.
    """
    arrays: dict[str, tuple[tuple[int, ...], np.dtype]] = {}
    for one in _variables(path):
        if one.name in arrays:
            raise _damage(path, f"the array {one.name!r} appears twice")
        if one.name:  # MATLAB's own workspaces have none
            arrays[one.name] = one.shape, one.dtype
    return arrays


def mat_array(path: Path, name: str, *, largest_bytes: int | None = None) -> Shaped[Array, "..."]:
    """The numbers of one variable, in the type in which MATLAB stored them.

    Parameters
    ----------
    path, name
        The file, and the variable in it.
    largest_bytes
        The largest size of the variable in memory; None for no limit.

    Raises
    ------
    InputError
        If the numbers do not fit the declared shape, or need more than ``largest_bytes``.
    """
    found = next(one for one in _variables(path) if one.name == name)
    if found.stored is not None:
        return _array_4(path, found, found.stored)
    with path.open("rb") as file:
        first = _first_bytes(path, file, found)
    kind, start, count = _part(first, found.length, found.order)
    dtype = np.dtype(found.order + _PACKED_AS[kind]) if kind in _PACKED_AS else np.dtype("O")
    expected = math.prod(found.shape) * dtype.itemsize
    if dtype.hasobject or count != expected:  # checked before all of it is inflated
        raise _damage(path, f"the numbers of array {name!r} do not fit its shape")
    body = _body(path, found, largest_bytes, needed_bytes=start + count)
    if not 0 <= len(body) - start - count < 8:
        raise _damage(path, f"the numbers of array {name!r} do not fit its shape")
    numbers = np.frombuffer(body, dtype=dtype, count=math.prod(found.shape), offset=start)
    return numbers.reshape(found.shape, order="F")


def mat_texts(path: Path, name: str, *, largest_bytes: int | None = None) -> tuple[str, ...]:
    """The texts of one variable: rows of characters, or a cell array of them; else empty.

    Raises
    ------
    InputError
        If the variable is damaged, or needs more than ``largest_bytes``.
    """
    found = next(one for one in _variables(path) if one.name == name)
    if found.stored is not None:
        is_text = found.dtype.kind == "U"
        rows = _array_4(path, found, found.stored)[:_MOST_WORDS] if is_text else ()
        return tuple("".join(map(chr, row.astype(np.uint8))).rstrip() for row in rows)
    body, order = _body(path, found, largest_bytes), found.order
    if _class(body, order) != _CELL:
        return _rows_of_text(path, body, order)
    texts: list[str] = []
    at = found.length
    for _ in range(min(math.prod(found.shape), _MOST_WORDS)):
        kind, count = struct.unpack_from(order + "II", body, at)
        if kind != _MATRIX or at + 8 + count > len(body):
            raise _damage(path, f"a cell of {name!r} is no array")
        inner = body[at + 8 : at + 8 + count]  # MATLAB may write only the tag of an empty cell
        texts += (_rows_of_text(path, inner, order)[:1] if inner else ()) or ("",)
        at += 8 + count
    return tuple(texts)


def _header_4(content: bytes) -> tuple[int, int, int, int, str] | None:
    """Type, rows, columns, length of the name and byte order of a header of version 4, if it is.

    The type has four decimal digits: byte order, 0, form of the numbers, and full, text or sparse.
    """
    if len(content) < 20:
        return None
    for order, machine in (("<", 0), (">", 1)):
        kind, rows, columns, imaginary, length = struct.unpack_from(f"{order}5i", content)
        digits = divmod(kind, 10)[0] % 10, kind % 10
        plain = kind // 100 == 10 * machine and digits[0] < len(_OF_LEVEL_4) and digits[1] < 3
        name = content[20 : 20 + max(length, 0)]
        named = 1 < length < 65 and name.endswith(b"\0") and name[:-1].replace(b"_", b"a").isalnum()
        if plain and named and rows >= 0 and columns >= 0 and imaginary in (0, 1):
            return kind, rows, columns, length, order
    return None


def _variables(path: Path) -> Iterator[_Variable]:
    with path.open("rb") as file:
        is_of_level_4 = _header_4(file.read(20 + 64)) is not None
    return (_variables_4 if is_of_level_4 else _variables_5)(path)


def _variables_4(path: Path) -> Iterator[_Variable]:
    size = path.stat().st_size
    with path.open("rb") as file:
        at = 0
        while at < size:
            file.seek(at)
            content = file.read(20 + 64)
            header = _header_4(content)
            if header is None:
                raise _damage(path, f"byte {at} begins no array within the file's {size} bytes")
            kind, rows, columns, length, order = header
            stored = np.dtype(order + _OF_LEVEL_4[kind // 10 % 10])
            imaginary = struct.unpack_from(f"{order}i", content, 12)[0]
            name = content[20 : 20 + length - 1].decode("ascii")
            count = rows * columns * stored.itemsize * (1 + imaginary)
            if at + 20 + length + count > size:
                raise _damage(path, f"the array {name!r} is longer than the file")
            if imaginary or kind % 10 > _TEXT_OF_LEVEL_4:  # complex or sparse
                stored = np.dtype("O")
            yield _Variable(
                name=name,
                shape=(rows, columns),
                dtype=np.dtype("U") if kind % 10 == _TEXT_OF_LEVEL_4 else stored,
                stored=stored,
                start=at + 20 + length,
            )
            at += 20 + length + count


def _array_4(path: Path, found: _Variable, stored: np.dtype) -> Shaped[Array, "..."]:
    if stored.hasobject:
        raise _damage(path, f"the array {found.name!r} is complex or sparse, which is not read")
    count = math.prod(found.shape)
    numbers = np.fromfile(path, dtype=stored, count=count, offset=found.start)
    return numbers.reshape(found.shape, order="F")


def _class(body: bytes, order: str) -> int:
    return int(struct.unpack_from(order + "I", body, 8)[0]) & 0xFF


def _rows_of_text(path: Path, body: bytes, order: str) -> tuple[str, ...]:
    opening = _opening(path, body, order)
    if _class(body, order) != _CHARS or len(opening.shape) != 2 or 0 in opening.shape:
        return ()
    kind, start, count = _part(body, opening.length, order)
    coding = {4: "utf-16", 17: "utf-16", 18: "utf-32"}.get(kind, "utf-8")
    coding += {"<": "-le", ">": "-be"}[order] if coding != "utf-8" else ""
    letters = body[start : start + count].decode(coding, errors="replace")
    rows = opening.shape[0]  # characters go down the columns first
    return tuple(letters[row::rows].rstrip() for row in range(min(rows, _MOST_WORDS)))


def _damage(path: Path, what: str) -> InputError:
    return InputError(str(path), f"is damaged or cut short: {what}", remedy="save it again")


def _variables_5(path: Path) -> Iterator[_Variable]:
    size = path.stat().st_size
    with path.open("rb") as file:
        order = _byte_order(path, file.read(_START_BYTES))
        at = _START_BYTES
        while at < size:
            file.seek(at)
            kind, count = struct.unpack(order + "II", file.read(8).ljust(8, b"\0"))
            if not kind and not file.read(_MOST_PADDING).strip(b"\0"):
                return  # zero padding at the end of the file
            if kind not in (_MATRIX, _COMPRESSED) or at + 8 + count > size:
                raise _damage(path, f"byte {at} begins no array within the file's {size} bytes")
            place = {"start": at + 8, "size": count, "compressed": kind == _COMPRESSED}
            unread = _Variable(name="", shape=(), dtype=np.dtype("O"), order=order, **place)
            yield replace(_opening(path, _first_bytes(path, file, unread), order), **place)
            at += 8 + count


def _byte_order(path: Path, start: bytes) -> str:
    order = {b"IM": "<", b"MI": ">"}.get(start[126:128], "")
    version = struct.unpack(order + "H", start[124:126])[0] if order else 0
    if version != 0x100:
        raise InputError(
            str(path),
            "is not a MATLAB file of version 5",
            remedy=("save it with -v7", "convert it to .npz"),
        )
    return order


def _first_bytes(path: Path, file: BinaryIO, element: _Variable) -> bytes:
    file.seek(element.start)
    if not element.compressed:
        return file.read(min(element.size, _OPENING_BYTES))
    inflated = zlib.decompressobj().decompress(file.read(element.size), 8 + _OPENING_BYTES)
    return _without_tag(path, inflated, element.order)[0]


def _without_tag(path: Path, inflated: bytes, order: str) -> tuple[bytes, int]:
    """The bytes after the tag of an inflated array, and the length that the tag declares."""
    kind, count = struct.unpack(order + "II", inflated[:8].ljust(8, b"\0"))
    if kind != _MATRIX:
        raise _damage(path, "what is compressed is no array")
    return inflated[8:], count


def _opening(path: Path, body: bytes, order: str) -> _Variable:
    """Flags, dimensions and name; a variable without dimensions counts as an object."""
    kind, start, count = _part(body, 0, order)
    if kind != _FLAGS or count != 8:
        raise _damage(path, "an array lacks its flags")
    flags = struct.unpack_from(order + "I", body, start)[0]
    at, shape = 16, ()
    if flags & 0xFF != _OPAQUE:
        kind, start, count = _part(body, at, order)
        if kind not in _DIMENSIONS or count % 4 or count > 4 * _MOST_AXES:
            raise _damage(path, "an array lacks its dimensions")
        shape = struct.unpack_from(f"{order}{count // 4}i", body, start)
        at = _after(start, count)
    kind, start, count = _part(body, at, order)
    if kind not in _NAMES or start + count > len(body):
        raise _damage(path, "an array lacks its name")
    name = body[start : start + count].decode("latin-1")
    length = _after(start, count)
    return _Variable(name=name, shape=shape, dtype=_dtype(flags), order=order, length=length)


def _part(body: bytes, at: int, order: str) -> tuple[int, int, int]:
    """Kind, first byte and byte count of the part whose tag is at ``at``; short ones have 4."""
    first = struct.unpack_from(order + "I", body, at)[0]
    if first >> 16:
        return first & 0xFFFF, at + 4, first >> 16
    return first, at + 8, struct.unpack_from(order + "I", body, at + 4)[0]


def _after(start: int, count: int) -> int:
    """The position of the next tag: the next multiple of 8."""
    return -(-(start + count) // 8) * 8


def _dtype(flags: int) -> np.dtype:
    if flags & _LOGICAL_BIT:
        return np.dtype("?")
    if flags & _COMPLEX_BIT:
        return np.dtype("c16")
    return np.dtype(_CLASSES.get(flags & 0xFF, "O"))


def _body(
    path: Path, element: _Variable, largest_bytes: int | None, *, needed_bytes: int | None = None
) -> bytes:
    """All bytes of a variable, inflated only if their declared number is plausible."""
    with path.open("rb") as file:
        file.seek(element.start)
        raw = file.read(element.size)
    if not element.compressed:
        return raw
    inflater = zlib.decompressobj()
    _, size = _without_tag(path, inflater.decompress(raw, 8), element.order)
    if largest_bytes is not None and size > largest_bytes:
        raise InputError(
            str(path),
            f"arrays must be at most {largest_bytes / 2**20:.0f} MiB for a table of spectra",
            value=size,
            found=f"one is {size / 2**20:.0f} MiB",
        )
    if needed_bytes is not None and not 0 <= size - needed_bytes < 8:
        raise _damage(path, "a compressed array does not end where it should")
    body = inflater.decompress(inflater.unconsumed_tail, size + 1)
    if len(body) != size or not inflater.eof:
        raise _damage(path, "a compressed array does not end where it should")
    return body
