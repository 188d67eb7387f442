"""Checks of Zarr chunks before numcodecs unpacks them."""

from functools import cache
from typing import Any

from chromanoise.io.cubes.bounds import MOST_INFLATED
from chromanoise.io.cubes.errors import library

_HARMLESS_BYTES = 64 * 2**20
_BLOSC_HEADER_BYTES = 16  # the last four are the length of the chunk
_ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
_ZSTD_BLOCK_BYTES = 2**17


@cache
def guard_codecs() -> None:
    """Make numcodecs reject chunks that are shorter than declared or inflate to too many bytes.

    numcodecs (0.16) reads beyond the end of a Blosc chunk that declares a greater length, which
    crashes the process, and allocates as much memory as a Zstandard frame declares.
    """
    for codec, look in (("blosc.Blosc", _refuse_short_blosc), ("zstd.Zstd", _refuse_large_zstd)):
        module, _, name = codec.partition(".")
        kind = getattr(library(f"numcodecs.{module}", "chunks of Zarr folders"), name)
        kind.decode = _looked_at(kind.decode, look)


def _looked_at(unpack: Any, look: Any) -> Any:
    def decode(codec: Any, buf: Any, out: Any = None) -> Any:
        look(memoryview(buf).cast("B"))
        return unpack(codec, buf, out)

    return decode


def _refuse_short_blosc(given: memoryview) -> None:
    declared = int.from_bytes(given[_BLOSC_HEADER_BYTES - 4 : _BLOSC_HEADER_BYTES], "little")
    if given.nbytes < _BLOSC_HEADER_BYTES or declared > given.nbytes:
        raise ValueError(f"a chunk has {given.nbytes} bytes, but declares {declared}")


def _refuse_large_zstd(given: memoryview) -> None:
    size = _zstd_bytes(given)
    if size > max(_HARMLESS_BYTES, given.nbytes * MOST_INFLATED):
        raise ValueError(f"a chunk of {given.nbytes} bytes unpacks to {size / 2**20:.0f} MiB")


def _zstd_bytes(given: memoryview) -> int:
    """Unpacked size that a frame declares, or the most that its blocks allow (RFC 8878). [bytes]"""
    if bytes(given[:4]) != _ZSTD_MAGIC or given.nbytes < 5:
        return 0  # numcodecs rejects it
    descriptor = given[4]
    single = descriptor >> 5 & 1
    at = 6 - single + (0, 1, 2, 4)[descriptor & 3]
    length = (single, 2, 4, 8)[descriptor >> 6]
    if length:
        return int.from_bytes(given[at : at + length], "little")
    blocks = 0
    while at + 3 <= given.nbytes:
        header = int.from_bytes(given[at : at + 3], "little")
        repeats = header >> 1 & 3 == 1
        at += 3 + (1 if repeats else header >> 3)
        blocks += 1
        if header & 1:
            break
    return blocks * _ZSTD_BLOCK_BYTES
