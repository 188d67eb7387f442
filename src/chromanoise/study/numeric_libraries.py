"""What determines the last digits besides study and version: processor, libraries, kernels."""

import platform
from typing import Any

import numpy as np


def numerics() -> dict[str, Any]:
    """Machine type, libraries and their kernels; if all are equal, a study gives the same bytes.

    ``blas_kernel`` is ``None`` if the BLAS of numpy does not report it.
    """
    import scipy

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
    from threadpoolctl import threadpool_info

    found = [lib.get("architecture") for lib in threadpool_info() if lib["user_api"] == "blas"]
    return next(filter(None, found), None)
