"""Modules of WebAssembly, read and changed: names, bodies of functions, globals, memory.

The binary format is that of the WebAssembly Core Specification 3.0, chapter 5.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

MAGIC = b"\0asm\1\0\0\0"
CUSTOM, IMPORTS, MEMORIES, GLOBALS, EXPORTS, CODE, DATA = 0, 2, 5, 6, 7, 10, 11
I32, I64 = 0x7F, 0x7E
_OF_GLOBAL = "saved-global-"
_PAGE_BYTES = 65536
_UNREACHABLE = b"\x03\x00\x00\x0b"  # three bytes: no locals, the instruction, its end
PAGES = b"pages"
IMAGE_PAGE_BYTES = 4096


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
    """The module of some sections; of the custom ones, which no engine needs, `PAGES` alone."""
    kept = ((n, d) for n, d in sections if n != CUSTOM or Bytes(d).name() == PAGES)
    parts = (bytes([n]) + unsigned(len(d)) + d for n, d in kept)
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


def hollowed(sections: Sections, dropped: Collection[int]) -> Sections:
    """The module with traps in place of the bodies of some functions.

    Parameters
    ----------
    dropped
        Indices of functions that are never called.
    """
    first, out = _imported_functions(sections), []
    for number, content in sections:
        if number == CODE:
            code = Bytes(content)
            bodies = [unsigned(total := code.unsigned())]
            for index in range(first, first + total):
                body = code.name()
                is_dropped = len(body) > len(_UNREACHABLE) and index in dropped
                bodies.append(_UNREACHABLE if is_dropped else unsigned(len(body)) + body)
            content = b"".join(bodies)
        out.append((number, content))
    return out


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
    """The module with the globals of another instance.

    Its memory has the size of the other one's, and a custom section `PAGES` says where each page
    of `image` belongs.

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
        if number != DATA:
            out.append((number, content))
    pages = np.array([*_used_pages(memory)], "<u4").tobytes()
    return [*out, (CUSTOM, unsigned(len(PAGES)) + PAGES + pages)]


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


def _used_pages(memory: bytes) -> Iterator[int]:
    """The pages of a memory that are not all 0."""
    pages = np.frombuffer(memory, "<u8").reshape(-1, IMAGE_PAGE_BYTES // 8)
    yield from np.flatnonzero(pages.any(axis=1)).tolist()


def image(memory: bytes) -> bytes:
    """The pages of a memory that are not all 0, one after the other."""
    return b"".join(
        memory[page * IMAGE_PAGE_BYTES : (page + 1) * IMAGE_PAGE_BYTES]
        for page in _used_pages(memory)
    )
