"""Compiled kernels that a process loads without numba, whose import and start take 0.3 s.

The first process compiles a kernel with numba for the types of its arguments, and keeps the object
code in the folder of `kernel_cache`, by the name of the kernel, these types and the processor.
Later ones load it with llvmlite alone. Object code is kept on Linux only; elsewhere numba's own
cache is used.
"""

import ctypes
import hashlib
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from chromanoise._files import write_whole
from chromanoise.imaging.kernel_cache import cached_compilation, kernel_folder

_PACKAGE = Path(__file__).parent
_LOCK = Lock()
_NO_RESULT = (ctypes.byref(ctypes.c_void_p()), ctypes.byref(ctypes.c_void_p()))  # nor an error
_KINDS = {"u": "uint", "i": "int", "f": "float"}


def stored_kernel(module: str, name: str) -> Callable[..., None]:
    """A compiled function that is called with contiguous arrays and integers, without the GIL.

    Parameters
    ----------
    module, name
        Where the Python function is. It takes a pointer for each array and an int64 for each
        integer, allocates no memory and returns nothing.
    """
    loaded: dict[str, Any] = {}

    def call(*arguments: Any) -> None:
        types = ", ".join(map(_type_of, arguments))
        if types not in loaded:
            with _LOCK:  # the engine takes a symbol once
                if types not in loaded:
                    loaded[types] = _function(module, name, f"void({types})")
        status = loaded[types](*_NO_RESULT, *map(_as_c, arguments))
        assert status == 0, f"{name} returned {status}"

    return call


def _type_of(argument: Any) -> str:
    if not isinstance(argument, np.ndarray):
        return "int64"
    return f"CPointer({_KINDS[argument.dtype.kind]}{8 * argument.dtype.itemsize})"


def _as_c(argument: Any) -> Any:
    if not isinstance(argument, np.ndarray):
        return ctypes.c_int64(argument)
    if not argument.flags.c_contiguous:
        raise ValueError("arrays of stored kernels must be contiguous")
    return ctypes.c_void_p(argument.__array_interface__["data"][0])


def _function(module: str, name: str, signature: str) -> Any:
    folder = kernel_folder(_PACKAGE) if sys.platform == "linux" else None
    path = folder and folder / _file_name(module, name, signature)
    kept = path and _kept(path)
    address = _address(*kept) if kept else _compiled(module, name, signature, path)
    return ctypes.CFUNCTYPE(ctypes.c_int)(address)


_COMPILED: list[Any] = []  # their code must stay in memory


def _compiled(module: str, name: str, signature: str, path: Path | None) -> int:
    """The address of a new kernel, whose object code is written to ``path``."""
    from numba import njit

    plain = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False}
    with cached_compilation(_PACKAGE) as cached:
        function = njit(cache=cached and path is None, error_model="numpy", **plain)(
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
