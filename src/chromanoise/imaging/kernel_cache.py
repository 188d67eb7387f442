"""Cache of compiled kernels, in a folder named by a hash of all sources.

numba checks only whether the file of a kernel has changed (some versions by its date), not the
files of the functions that the kernel calls. The name of the folder is a hash of all sources of
the kernel's package and of numba's version, so that no outdated kernel is used after a change of
either. A kernel therefore calls only kernels of its own package.
"""

import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba import config, njit
from numba.core import event
from numba.misc.appdirs import AppDirs

_UNUSED_S = 30 * 24 * 3600.0


def kernel(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit` for a function whose compiled code is kept for later processes.

    Parameters
    ----------
    options
        Options of ``njit`` other than ``cache`` and ``nogil``.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        sources = Path(function.__code__.co_filename).parent
        folder, before = kernel_folder(sources), config.CACHE_DIR
        config.CACHE_DIR = "" if folder is None else str(folder)
        try:
            return njit(cache=folder is not None, nogil=True, **options)(function)
        finally:
            config.CACHE_DIR = before

    return compiled


@cache
def kernel_folder(package: Path) -> Path | None:
    """The folder for kernels; ``None`` if none can be written, or the sources cannot be read.

    It is in the first of these places that can be written: ``NUMBA_CACHE_DIR``, ``__pycache__`` of
    the installation, the user's cache, or a temporary folder that only this user can write. No file
    is removed here; `_RemovalOnCompilation` does that.

    Parameters
    ----------
    package
        The folder of the sources of the kernels.
    """
    sources = sorted(package.glob("*.py"))
    if not sources:
        return None
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sources:
        content = source.read_bytes()
        digest.update(f"\n{source.name} {len(content)}\n".encode() + content)
    ours = f"kernels-{hashlib.sha256(os.fsencode(package)).hexdigest()[:8]}-"
    for place in _places(package):
        folder = place / f"{ours}{digest.hexdigest()[:16]}"
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            os.utime(folder)
            event.register("numba:compile", _RemovalOnCompilation(place, f"{ours}*", package))
            return folder
    return None


class _RemovalOnCompilation(event.Listener):  # type: ignore[misc]
    """Removes folders for other sources of this installation when the first kernel is compiled.

    Only folders that were not used for 30 days: until then another process may use them.
    """

    def __init__(self, place: Path, pattern: str, package: Path) -> None:
        self._place, self._pattern, self._package = place, pattern, package
        self._is_done = False

    def on_start(self, event: Any) -> None:
        """Nothing; numba asks for this method."""

    def on_end(self, event: Any) -> None:
        """The removal, if a kernel of this package was compiled."""
        source = event.data["dispatcher"].py_func.__code__.co_filename
        if self._is_done or Path(source).parent != self._package:
            return
        self._is_done = True
        for folder in self._place.glob(self._pattern):
            with suppress(OSError):
                if folder.stat().st_mtime < time.time() - _UNUSED_S:
                    shutil.rmtree(folder, ignore_errors=True)


def _places(package: Path) -> Iterator[Path]:
    if config.CACHE_DIR:
        yield Path(config.CACHE_DIR) / "chromanoise"
    yield package / "__pycache__"
    yield Path(AppDirs(appname="chromanoise", appauthor=False).user_cache_dir)
    if hasattr(os, "getuid"):
        shared = Path(tempfile.gettempdir()) / f"chromanoise-{os.getuid()}"
        if _is_private(shared):
            yield shared


def _is_private(folder: Path) -> bool:
    """Whether only this user can write the folder: code in it is executed."""
    with suppress(OSError):
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
        own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
        return own and not found.st_mode & 0o077
    return False
