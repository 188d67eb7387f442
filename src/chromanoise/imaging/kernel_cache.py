"""Cache of compiled kernels, in a folder named by a hash of all sources.

numba checks only whether the file of a kernel has changed (some versions by its date), not the
files of the functions that the kernel calls. The name of the folder is a hash of all sources of
the kernel's package and of numba's version, so that no outdated kernel is used after a change of
either.
"""

import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

_UNUSED_S = 30 * 24 * 3600.0


def kernel(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit` for a function whose compiled code is kept for later processes.

    Parameters
    ----------
    options
        Options of ``njit`` other than ``cache`` and ``nogil``.
    """
    from numba import njit

    def compiled(function: Callable[..., Any]) -> Any:
        with cached_compilation(Path(function.__code__.co_filename).parent) as cached:
            return njit(cache=cached, nogil=True, **options)(function)

    return compiled


@contextmanager
def cached_compilation(package: Path) -> Iterator[bool]:
    """Whether numba can keep what is declared inside, in `kernel_folder`.

    Parameters
    ----------
    package
        The folder of the sources of the kernels.
    """
    from numba import config

    folder, before = kernel_folder(package), config.CACHE_DIR
    config.CACHE_DIR = "" if folder is None else str(folder)
    if folder is not None:
        _remove_on_compilation(folder, package)
    try:
        yield folder is not None
    finally:
        config.CACHE_DIR = before


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
    digest = hashlib.sha256(_numba_version())
    for source in sources:
        content = source.read_bytes()
        digest.update(f"\n{source.name} {len(content)}\n".encode() + content)
    for place in _places(package):
        folder = place / f"{_prefix(package)}{digest.hexdigest()[:16]}"
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            os.utime(folder)
            return folder
    return None


def _prefix(package: Path) -> str:
    """How the names of all folders for this package begin."""
    return f"kernels-{hashlib.sha256(os.fsencode(package)).hexdigest()[:8]}-"


def _numba_version() -> bytes:
    """The file with numba's version; its import would take 0.1 s."""
    numba = find_spec("numba")
    origin = None if numba is None else numba.origin
    return b"" if origin is None else Path(origin).with_name("_version.py").read_bytes()


@cache
def _remove_on_compilation(folder: Path, package: Path) -> None:
    from numba.core import event

    event.Listener.register(_RemovalOnCompilation)
    event.register("numba:compile", _RemovalOnCompilation(folder.parent, package))


class _RemovalOnCompilation:
    """Removes folders for other sources of a package when its first kernel is compiled.

    Only folders that were not used for 30 days: until then another process may use them.
    """

    def __init__(self, place: Path, package: Path) -> None:
        self._place, self._package = place, package
        self._is_done = False

    def notify(self, event: Any) -> None:
        """The removal, at the end of a compilation, if a kernel of this package was compiled."""
        if not event.is_end:
            return
        source = event.data["dispatcher"].py_func.__code__.co_filename
        if self._is_done or Path(source).parent != self._package:
            return
        self._is_done = True
        for folder in self._place.glob(f"{_prefix(self._package)}*"):
            with suppress(OSError):
                if folder.stat().st_mtime < time.time() - _UNUSED_S:
                    shutil.rmtree(folder, ignore_errors=True)


def _places(package: Path) -> Iterator[Path]:
    if os.environ.get("NUMBA_CACHE_DIR"):
        yield Path(os.environ["NUMBA_CACHE_DIR"]) / "chromanoise"
    yield package / "__pycache__"
    from numba.misc.appdirs import AppDirs

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
