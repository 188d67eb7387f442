"""Compilation of kernels with numba, and the cache of their object code.

The folder of the cache is named by a hash. numba checks only whether the file of a kernel has
changed (some versions by its date), not the files of the functions that the kernel calls. The name
of the folder is a hash of all sources of the kernel's package and of numba's version, so that no
outdated kernel is used after a change of either.

A process can load a `stored_kernel` without numba, whose import and start take 0.3 s. The first
process compiles it with numba for the types of its arguments, and keeps the object code in the
folder of the cache, by the name of the kernel, these types and the processor. Later ones load it
with llvmlite alone. Object code is kept on Linux only; elsewhere numba's own cache is used.
"""

import ctypes
import hashlib
import os
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from chromanoise.base import optional_package, refuse_absent_package, write_whole

_UNUSED_S = 30 * 24 * 3600.0


def kernel(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit` for a function whose compiled code is kept for later processes.

    Parameters
    ----------
    options
        Options of ``njit`` other than ``cache``, ``nogil`` and ``no_cfunc_wrapper``.
    """
    njit = _njit()

    def compiled(function: Callable[..., Any]) -> Any:
        with cached_compilation(Path(function.__code__.co_filename).parent) as cached:
            return njit(cache=cached, nogil=True, no_cfunc_wrapper=True, **options)(function)

    return compiled


def inner(function: Callable[..., Any], **options: Any) -> Any:
    """A compiled function that only kernels call: it has no form that Python could call."""
    return _njit()(**_INNER, **options)(function)


def inlined(function: Callable[..., Any]) -> Any:
    """As `inner`, for functions of few lines: LLVM, not numba, copies them to where they are used.

    With ``inline="always"`` numba would infer the types of each copy anew.
    """
    return _njit()(**_INNER, forceinline=True)(function)


def _njit() -> Any:
    return optional_package("numba", "compiled code", extra="compiled").njit


def either_module(compiled: str, plain: str) -> Any:
    """A module of kernels, or where numba is not installed the one of numpy with the same names."""
    return import_module(plain if find_spec("numba") is None else compiled)


def kernel_of(
    module: str, name: str, values: int, bands: int = 0, kind: str = ""
) -> Callable[..., Any]:
    """The compiled kernel; its twin of `plain` without numba, and for a small picture at first.

    Compiling takes as long as a few pictures. So nothing is compiled until pictures of
    plain numpy have cost as much, in this process and those before it; and numba is not started
    until those of this process have cost as much as its start. On another processor with
    the same folder a kernel is compiled again, at once.

    Parameters
    ----------
    module, name
        Where the kernel is in this package.
    values
        Number of values of the picture: pixels, or pixels times channels.
    bands
        Number of bands that are summed for each value.
    kind
        The data type for which the kernel is compiled, where it takes several.
    """
    what = "-".join(filter(None, (name, kind)))
    if what in _ready:
        return _kernel_in(module, name)
    plain = getattr(import_module(f"{__package__}.plain"), name)
    seconds = values * (_VALUE_S + bands * _BAND_S)
    if find_spec("numba") is None:
        if seconds > _SMALL_S:
            _say_that_it_is_slow()
        return plain
    folder = kernel_folder(_PACKAGE)
    ready = folder and folder / f"compiled-{what}"
    spent = folder and folder / f"milliseconds-of-plain-{what}"
    is_ready = ready is not None and ready.exists()
    if is_ready:
        spent = None  # of this process alone
        is_worth_it = "numba" in sys.modules or _spent_s(None, what) + seconds > _STARTING_S
    else:
        is_worth_it = seconds > _SMALL_S or _spent_s(spent, what) + seconds > _COMPILING_S
    if is_worth_it:
        kernel = _kernel_in(module, name)

        def compiling(*arguments: Any) -> Any:
            returned = kernel(*arguments)
            _ready.add(what)
            with suppress(OSError):
                if ready:
                    ready.touch()
            return returned

        if is_ready:
            _ready.add(what)
        return kernel if is_ready else compiling

    def timed(*arguments: Any) -> Any:
        began = time.thread_time()
        returned = plain(*arguments)
        _add_spent(spent, what, time.thread_time() - began)
        return returned

    return timed


def _kernel_in(module: str, name: str) -> Callable[..., Any]:
    kernel: Callable[..., Any] = getattr(import_module(f"{__package__}.{module}"), name)
    return kernel


# processor time of most functions of `plain`, within a factor of 2, on an EPYC of 2.6 GHz
_VALUE_S, _BAND_S = 2e-7, 5e-9
_SMALL_S, _COMPILING_S, _STARTING_S = 2.5, 10.0, 0.4
_ready: set[str] = set()  # in this process
_spent: dict[str, float] = {}  # of this process, where no folder can be written


def _spent_s(file: Path | None, what: str) -> float:
    """Processor time of plain pictures so far: the file has a byte for each millisecond."""
    with suppress(OSError):
        return file.stat().st_size / 1e3 if file else _spent.get(what, 0.0)
    return 0.0


def _add_spent(file: Path | None, what: str, seconds: float) -> None:
    _spent[what] = _spent.get(what, 0.0) + seconds
    with suppress(OSError):
        if file:
            with file.open("ab") as end:
                end.write(b"." * round(1e3 * seconds))


_INNER = {
    "nogil": True,
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}


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
    if not any(package.glob("*.py")):
        return None
    digest = hashlib.sha256(_numba_version())
    # kernels of all packages use functions of this one, whose changes numba does not notice
    for source in sorted({*package.glob("*.py"), *_PACKAGE.glob("*.py")}):
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


_callbacks: list[Callable[[bool], None]] = []


@contextmanager
def watch_compiling(callback: Callable[[bool], None]) -> Iterator[None]:
    """A context: ``callback(True)`` is called before a compilation, ``callback(False)`` after it.

    Calls are nested: a kernel that another one calls is compiled during that compilation.
    """
    _callbacks.append(callback)
    try:
        yield
    finally:
        _callbacks.remove(callback)


@cache
def _remove_on_compilation(folder: Path, package: Path) -> None:
    from numba.core import event

    event.Listener.register(_RemovalOnCompilation)
    event.register("numba:compile", _RemovalOnCompilation(folder.parent, package))


@cache
def _say_that_it_is_slow() -> None:
    print(
        "Without numba, rendering takes some 20 times as long; to install it: "
        "pip install 'chromanoise[compiled]'",
        file=sys.stderr,
        flush=True,
    )


@cache
def _say_that_kernels_are_compiled() -> None:
    print(
        "Compiling numerical code for this processor, only once: up to a minute ...",
        file=sys.stderr,
        flush=True,
    )


class _RemovalOnCompilation:
    """Removes folders for other sources of a package when its first kernel is compiled.

    Only folders that were not used for 30 days: until then another process may use them.
    """

    def __init__(self, place: Path, package: Path) -> None:
        self._place, self._package = place, package
        self._is_done = False

    def notify(self, event: Any) -> None:
        """The removal, at the end of a compilation, if a kernel of this package was compiled."""
        source = event.data["dispatcher"].py_func.__code__.co_filename
        if Path(source).parent != self._package:
            return
        for callback in _callbacks:
            callback(not event.is_end)
        if not event.is_end:
            _say_that_kernels_are_compiled()
            return
        if self._is_done:
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


_PACKAGE = Path(__file__).parent
_LOCK = Lock()
_KINDS = {"u": "uint", "i": "int", "f": "float"}


def stored_kernel(module: str, name: str) -> Callable[..., None]:
    """A compiled function that is called with contiguous arrays and integers, without the GIL.

    Parameters
    ----------
    module, name
        Where the Python function is. It takes a pointer for each array and an int64 for each
        integer, allocates no memory and returns nothing.
    """
    loaded: dict[tuple[np.dtype | None, ...], Any] = {}

    def call(*arguments: Any) -> None:
        types = tuple([a.dtype if isinstance(a, np.ndarray) else None for a in arguments])
        if types not in loaded:
            with _LOCK:  # the engine takes a symbol once
                if types not in loaded:
                    signature = f"void({', '.join(map(_type_of, types))})"
                    loaded[types] = _function(module, name, signature)
        status = loaded[types](*_no_result(), *map(_as_c, arguments))
        assert status == 0, f"{name} returned {status}"

    return call


@cache
def _no_result() -> tuple[Any, Any]:
    """Where a kernel would put a result, and an error."""
    return ctypes.byref(ctypes.c_void_p()), ctypes.byref(ctypes.c_void_p())


def _type_of(items: np.dtype | None) -> str:
    """The type of an argument: an array of these items, or an integer."""
    return "int64" if items is None else f"CPointer({_KINDS[items.kind]}{8 * items.itemsize})"


def _as_c(argument: Any) -> Any:
    if not isinstance(argument, np.ndarray):
        return ctypes.c_int64(argument)
    if not argument.flags.c_contiguous:
        raise ValueError("arrays of stored kernels must be contiguous")
    if argument.flags.writeable and argument.size:  # three times faster
        return ctypes.byref(ctypes.c_char.from_buffer(argument))  # type: ignore[arg-type]
    return ctypes.c_void_p(argument.__array_interface__["data"][0])


def _function(module: str, name: str, signature: str) -> Any:
    refuse_absent_package("numba", "compiled code", extra="compiled")
    folder = kernel_folder(_PACKAGE) if sys.platform == "linux" else None
    path = folder and folder / _file_name(module, name, signature)
    kept = path and _kept(path)
    address = _address(*kept) if kept else _compiled(module, name, signature, path)
    return ctypes.CFUNCTYPE(ctypes.c_int)(address)


_COMPILED: list[Any] = []  # their code must stay in memory


def _compiled(module: str, name: str, signature: str, path: Path | None) -> int:
    """The address of a new kernel, whose object code is written to ``path``."""
    plain = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False}
    with cached_compilation(_PACKAGE) as cached:
        function = _njit()(cache=cached and path is None, error_model="numpy", **plain)(
            getattr(import_module(module), name)
        )
    function.compile(signature)
    _COMPILED.append(function)
    (result,) = function.overloads.values()
    symbol, code = result.fndesc.llvm_func_name, result.library._get_compiled_object()
    if path is not None:
        digest = hashlib.sha256(code).hexdigest()
        with suppress(OSError):
            write_whole(path, f"{symbol}\n{digest}\n".encode() + code)
    return int(result.library.get_pointer_to_function(symbol))


def _file_name(module: str, name: str, signature: str) -> str:
    import llvmlite.binding as llvm

    processor = f"{llvm.get_host_cpu_name()} {llvm.get_host_cpu_features().flatten()}"
    digest = hashlib.sha256(f"{signature} {processor}".encode()).hexdigest()[:16]
    return f"{module.rpartition('.')[2]}.{name}-{digest}.o"


def _kept(path: Path) -> tuple[str, bytes] | None:
    """The name and the object code of a kernel; ``None`` if there is none, or it is damaged."""
    with suppress(OSError, ValueError):
        symbol, digest, code = path.read_bytes().split(b"\n", 2)
        if hashlib.sha256(code).hexdigest() == digest.decode():
            return symbol.decode(), code
    return None


@cache
def _engine() -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine()
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)


def _address(symbol: str, code: bytes) -> int:
    import llvmlite.binding as llvm

    engine = _engine()
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return int(engine.get_function_address(symbol))
