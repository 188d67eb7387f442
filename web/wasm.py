"""Modules of WebAssembly, read and changed: names, bodies of functions, globals, memory.

The binary format is that of the WebAssembly Core Specification 3.0, chapter 5.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

MAGIC = b"\0asm\1\0\0\0"
CUSTOM, IMPORTS, MEMORIES, GLOBALS, EXPORTS, CODE, DATA = 0, 2, 5, 6, 7, 10, 11
I32, I64 = 0x7F, 0x7E
_OF_GLOBAL = "saved-global-"
_PAGE_BYTES = 65536
_UNREACHABLE = b"\x03\x00\x00\x0b"  # three bytes: no locals, the instruction, its end
_MOST_SEGMENTS = 99_000  # browsers refuse a module of more than 100,000
_LEAST_GAP = 32  # zeros between two segments, below which one is shorter than two


@dataclass(slots=True)
class Bytes:
    """Bytes with a place, from which numbers and texts are read one after the other."""

    data: bytes
    at: int = 0

    def unsigned(self) -> int:
        """An unsigned number in LEB128."""
        value = shift = 0
        while True:
            byte = self.data[self.at]
            self.at += 1
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
            shift += 7

    def take(self, count: int) -> bytes:
        """The next bytes."""
        self.at += count
        return self.data[self.at - count : self.at]

    def name(self) -> bytes:
        """Bytes behind their number."""
        return self.take(self.unsigned())

    @property
    def ended(self) -> bool:
        """Whether nothing is left."""
        return self.at >= len(self.data)


def unsigned(value: int) -> bytes:
    """A number in LEB128."""
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])


def signed(value: int) -> bytes:
    """A number in signed LEB128."""
    out = bytearray()
    while not -0x40 <= value < 0x40:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value & 0x7F])


Sections = list[tuple[int, bytes]]


def sections_of(module: bytes) -> Sections:
    """The sections of a module: number and content.

    Raises
    ------
    ValueError
        If it is no module.
    """
    if not module.startswith(MAGIC):
        raise ValueError("this file must be a module of WebAssembly, but does not begin as one")
    rest, found = Bytes(module, len(MAGIC)), []
    while not rest.ended:
        number = rest.take(1)[0]
        found.append((number, rest.name()))
    return found


def module_of(sections: Sections) -> bytes:
    """The module of some sections, without the custom ones, which no engine needs."""
    parts = (bytes([n]) + unsigned(len(d)) + d for n, d in sections if n != CUSTOM)
    return MAGIC + b"".join(parts)


def function_names(sections: Sections) -> dict[int, str]:
    """Names of functions by their index, imported ones first."""
    found: dict[int, str] = {}
    for number, content in sections:
        custom = Bytes(content)
        if number != CUSTOM or custom.name() != b"name":
            continue
        while not custom.ended:
            kind = custom.take(1)[0]
            part = Bytes(custom.name())
            if kind == 1:
                for _ in range(part.unsigned()):
                    index = part.unsigned()
                    found[index] = part.name().decode("utf-8", "replace")
    return found


def hollowed(sections: Sections, is_dropped: Callable[[str], bool]) -> tuple[Sections, int]:
    """The module with traps in place of the bodies of some functions, and their number.

    Parameters
    ----------
    is_dropped
        Whether the function of a name is never called.
    """
    names, first = function_names(sections), _imported_functions(sections)
    count, out = 0, []
    for number, content in sections:
        if number == CODE:
            code = Bytes(content)
            bodies = [unsigned(total := code.unsigned())]
            for index in range(first, first + total):
                body = code.name()
                if len(body) > len(_UNREACHABLE) and is_dropped(names.get(index, "")):
                    bodies.append(_UNREACHABLE)
                    count += 1
                else:
                    bodies.append(unsigned(len(body)) + body)
            content = b"".join(bodies)
        out.append((number, content))
    return out, count


def _imported_functions(sections: Sections) -> int:
    imports, count = Bytes(dict(sections)[IMPORTS]), 0
    for _ in range(imports.unsigned()):
        imports.name(), imports.name()
        if imports.take(1)[0] != 0:
            raise ValueError("a module must import nothing but functions")
        imports.unsigned()
        count += 1
    return count


@dataclass(frozen=True, slots=True)
class Global:
    """A global variable: its type, whether it changes, and the bytes that set it."""

    kind: int
    mutable: bool
    start: bytes


_OPERANDS = {0x43: 4, 0x44: 8}  # f32.const, f64.const; all others have one number in LEB128


def _globals(content: bytes) -> Iterator[Global]:
    rest = Bytes(content)
    for _ in range(rest.unsigned()):
        kind, mutable = rest.take(2)
        begin = rest.at
        operation = rest.take(1)[0]
        if operation in _OPERANDS:
            rest.take(_OPERANDS[operation])
        else:
            rest.unsigned()
        if rest.take(1) != b"\x0b":
            raise ValueError("globals must begin as constants")
        yield Global(kind, bool(mutable), rest.data[begin : rest.at])


def with_globals_exported(sections: Sections) -> Sections:
    """The module with all variables exported, so that their values can be read."""
    variables = [*_globals(dict(sections)[GLOBALS])]
    added = [
        unsigned(len(name)) + name + b"\x03" + unsigned(i)
        for i, one in enumerate(variables)
        if one.mutable and (name := f"{_OF_GLOBAL}{i}".encode())
    ]

    def exported(content: bytes) -> bytes:
        rest = Bytes(content)
        count = rest.unsigned() + len(added)
        return unsigned(count) + content[rest.at :] + b"".join(added)

    return [(n, exported(d) if n == EXPORTS else d) for n, d in sections]


def frozen(
    sections: Sections, memory: bytes, values: Mapping[str, int], *, dropped: tuple[str, ...]
) -> Sections:
    """The module that begins where another instance was: with its memory and its variables.

    Parameters
    ----------
    sections
        As `with_globals_exported` gives them.
    memory
        All of its memory.
    values
        Values of the exported variables by name.
    dropped
        Exports that must not be called any more.
    """
    variables = [*_globals(dict(sections)[GLOBALS])]
    out = []
    for number, content in sections:
        if number == MEMORIES:
            rest = Bytes(content)
            flags = rest.take(2)[1:]
            rest.unsigned()
            pages = unsigned(len(memory) // _PAGE_BYTES)
            content = b"\x01" + flags + pages + content[rest.at :]
        elif number == GLOBALS:
            parts = [
                _frozen_global(one, values.get(f"{_OF_GLOBAL}{i}"))
                for i, one in enumerate(variables)
            ]
            content = unsigned(len(parts)) + b"".join(parts)
        elif number == EXPORTS:
            kept = [
                entry
                for name, entry in _exports(content)
                if not name.startswith(_OF_GLOBAL) and name not in dropped
            ]
            content = unsigned(len(kept)) + b"".join(kept)
        elif number == DATA:
            content = _segments(memory)
        out.append((number, content))
    return out


def _frozen_global(one: Global, value: int | None) -> bytes:
    start = one.start
    if one.mutable:
        if value is None or one.kind not in (I32, I64):
            raise ValueError("each variable must be a whole number with a value")
        bits = 32 if one.kind == I32 else 64
        wrapped = (value + (1 << bits - 1)) % (1 << bits) - (1 << bits - 1)
        start = (b"\x41" if one.kind == I32 else b"\x42") + signed(wrapped) + b"\x0b"
    return bytes([one.kind, one.mutable]) + start


def _exports(content: bytes) -> Iterator[tuple[str, bytes]]:
    rest = Bytes(content)
    for _ in range(rest.unsigned()):
        begin = rest.at
        name = rest.name().decode()
        rest.take(1)
        rest.unsigned()
        yield name, content[begin : rest.at]


def _segments(memory: bytes) -> bytes:
    """All of a memory but its zeros, as segments of data."""
    used = np.flatnonzero(np.frombuffer(memory, np.uint8))
    steps, gap = np.diff(used), _LEAST_GAP
    while np.count_nonzero(steps > gap) >= _MOST_SEGMENTS:
        gap *= 2
    cuts = np.flatnonzero(steps > gap)
    begins, ends = used[np.r_[0, cuts + 1]], used[np.r_[cuts, used.size - 1]] + 1
    out = bytearray(unsigned(len(begins)))
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        place = begin - (1 << 32) if begin >= 1 << 31 else begin
        out += b"\x00\x41" + signed(place) + b"\x0b" + unsigned(end - begin) + memory[begin:end]
    return bytes(out)
