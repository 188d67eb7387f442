"""What decides the last digits beyond study and version: processor, libraries, their kernels."""

import ctypes
import platform
from typing import Any

import numpy as np
import scipy
from numpy.linalg import _umath_linalg

_CORE_NAMES = (
    "scipy_openblas_get_corename64_",
    "openblas_get_corename64_",
    "scipy_openblas_get_corename",
    "openblas_get_corename",
)


def numerics() -> dict[str, Any]:
    """Machine type, libraries and their kernels: where all agree, a study gives the same bytes.

    ``blas_kernel`` is ``None`` where the BLAS of numpy does not report it.
    """
    built = np.show_config(mode="dicts")
    blas = built.get("Build Dependencies", {}).get("blas", {})
    return {
        "machine": platform.machine(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "blas": f"{blas.get('name', 'unknown')} {blas.get('version', '')}".strip(),
        "blas_kernel": _blas_kernel(),
        "cpu_features": built.get("SIMD Extensions", {}).get("found", []),
    }


def _blas_kernel() -> str | None:
    """The kernel that OpenBLAS chose for this processor, or that OPENBLAS_CORETYPE names."""
    library = ctypes.CDLL(_umath_linalg.__file__)
    for name in _CORE_NAMES:
        try:
            asked = getattr(library, name)
        except AttributeError:
            continue
        asked.restype = ctypes.c_char_p
        told = asked()
        return told.decode("ascii", "replace") if isinstance(told, bytes) else None
    return None
