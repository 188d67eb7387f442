"""Outputs appear whole or not at all."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from chromanoise._check import InputError


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """A scratch folder whose files move to ``folder`` when all are written; else nothing does.

    Files of the same name are replaced; other files in ``folder`` stay.

    Raises
    ------
    InputError
        If ``folder`` is a file.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: the output folder is an existing file; name another")
    made = _first_missing(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    scratch = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        yield scratch
        folder.mkdir(exist_ok=True)
        made = None
        for path in sorted(p for p in scratch.rglob("*") if p.is_file()):
            target = folder / path.relative_to(scratch)
            target.parent.mkdir(parents=True, exist_ok=True)
            path.replace(target)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
        if made is not None:
            shutil.rmtree(made, ignore_errors=True)


def write_whole(path: Path, content: bytes) -> None:
    """Write beside the goal and move into place, so that nobody ever reads half a file.

    Raises
    ------
    InputError
        If ``path`` is a folder.
    """
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file")
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    scratch = Path(name)
    try:
        with os.fdopen(handle, "wb") as part:
            part.write(content)
        scratch.chmod(0o644)  # a temporary file keeps others out; a result is for everyone
        scratch.replace(path)
    finally:
        scratch.unlink(missing_ok=True)


def _first_missing(folder: Path) -> Path | None:
    """The outermost folder that must be made on the way to ``folder``."""
    missing = [p for p in (folder, *folder.parents) if not p.exists()]
    return missing[-1] if missing else None
