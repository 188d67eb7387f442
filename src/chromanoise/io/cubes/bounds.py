"""Reject arrays that are not numeric or are implausibly large, before allocating memory."""

import math
import os
import re
from contextlib import suppress
from pathlib import Path

import numpy as np

from chromanoise.errors import InputError, Setting
from chromanoise.io.cubes.errors import IN_PLACE
from chromanoise.io.cubes.raw_cube import by

MOST_INFLATED = 1032
"""Largest compression ratio of deflate; files that declare a larger one are refused."""

_MEMORY_BYTES = 8 * 2**30  # where the system does not report it
_GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def refuse_impossible(
    path: Path,
    name: str,
    shape: tuple[int, ...],
    dtype: np.dtype,
    *,
    size: int | None = None,
    stored_item_bytes: int | None = None,
) -> None:
    """Raise an error for an array that is not numeric or exceeds its file or the memory.

    Parameters
    ----------
    path, name
        The file, and the array in it that will be loaded into memory.
    shape, dtype
        Shape and type as the file declares them.
    size
        Size of all stored data, if it differs from the size of ``path``. [bytes]
    stored_item_bytes
        Size of one number before compression, where the file may store it in fewer bytes than
        ``dtype`` has. [bytes]
    """
    refuse_empty(path, name, shape, dtype)
    count = math.prod(shape)
    size = path.stat().st_size if size is None else size
    if count * (stored_item_bytes or dtype.itemsize) > size * MOST_INFLATED:
        raise InputError(
            str(path),
            f"must fit into the {size} bytes of the file",
            where=f"array {name!r}",
            value=shape,
            found=f"is declared as {by(shape)}",
            remedy="save it again, because the file is damaged",
        )
    size = count * dtype.itemsize
    if size > memory_bytes():
        raise InputError(
            str(path),
            f"must fit into the available memory of {_bytes(memory_bytes())}",
            where=f"array {name!r}",
            value=size,
            found=f"needs {_bytes(size)}",
            remedy=IN_PLACE,
        )


def refuse_empty(path: Path, name: str, shape: tuple[int, ...], dtype: np.dtype) -> None:
    """Raise an error for an array without numbers, or of anything but real numbers."""
    refuse_not_numbers(path, name, dtype)
    if min(shape, default=1) < 1:
        raise InputError(
            str(path),
            "must not be empty",
            where=f"array {name!r}",
            value=shape,
            found=f"is {by(shape)}",
            remedy="save it again",
        )


def refuse_other_size(
    path: Path, where: str, read: tuple[int, ...], declared: tuple[int, ...]
) -> None:
    """Raise an error for numbers of another shape than declared."""
    if read != declared:
        raise InputError(
            str(path),
            f"must be {by(declared)}, as it declares",
            where=where,
            value=read,
            found=f"is {by(read)}",
            remedy="save it again, because it is damaged",
        )


def refuse_not_numbers(path: Path, name: str, dtype: np.dtype) -> None:
    """Raise an error for text, objects, complex numbers and booleans."""
    if dtype.kind not in "fiu":
        raise InputError(
            str(path),
            "must hold real numbers",
            where=f"array {name!r}",
            value=kind_of(dtype),
            found=f"is of type {kind_of(dtype)}",
            remedy=("save it as a plain array of real numbers", Setting("key")),
        )


def kind_of(dtype: np.dtype) -> str:
    """The name of a type of numbers, for messages."""
    return "object" if dtype.hasobject else dtype.name


def _bytes(count: int) -> str:
    for power, unit in ((3, "GiB"), (2, "MiB"), (1, "KiB")):
        if count >= 1024**power:
            return f"{count / 1024**power:.1f} {unit}"
    return f"{count} bytes"


def memory_bytes() -> int:
    """Memory available to this process: free memory, within the limit of its cgroup. [bytes]"""
    limits = [_installed_bytes()]
    with suppress(OSError):
        available = re.search(r"MemAvailable:\s*(\d+) kB", Path("/proc/meminfo").read_text())
        limits += [int(available[1]) * 1024] if available else []
    for file in _GROUP_LIMITS:
        with suppress(OSError, ValueError):  # "max": no limit
            limits.append(int(Path(file).read_text()))
    return min(limits)


def _installed_bytes() -> int:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return _MEMORY_BYTES
