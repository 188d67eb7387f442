"""Compiled kernels that are older than their sources are thrown away.

numba asks only whether the file of a kernel has changed, not the files of what it calls: after an
update the old arithmetic would go on without a word.
"""

import os
from contextlib import suppress
from pathlib import Path


def drop_stale_kernels(folder: Path) -> int:
    """How many compiled files of ``folder`` were dropped; all or none, as they call each other."""
    with suppress(OSError):  # no cache yet, or a folder that is not ours to write
        kept = [f for f in os.scandir(folder / "__pycache__") if f.name.endswith((".nbi", ".nbc"))]
        sources = [f for f in os.scandir(folder) if f.name.endswith(".py")]
        changed = max(f.stat().st_mtime_ns for f in sources)
        if any(f.stat().st_mtime_ns < changed for f in kept):
            for file in kept:
                Path(file).unlink(missing_ok=True)
            return len(kept)
    return 0
