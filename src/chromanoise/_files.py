"""Files: outputs appear whole or not at all, and inputs are regular files."""

import errno
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from chromanoise._check import InputError

_KINDS = (
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISDIR, "a directory"),
)


def regular_file(path: Path, *, folder: bool = False, pipe: bool = False) -> os.stat_result:
    """The status of a file that can be read to its end without waiting for another process.

    Parameters
    ----------
    path
        The file. It is not opened, because opening a pipe may wait forever.
    folder
        Whether a folder is accepted too.
    pipe
        Whether a pipe that this process inherited (``/dev/stdin``, ``/dev/fd/63``) is accepted
        too; the caller bounds how much of it is read.

    Raises
    ------
    InputError
        If there is no such file, or it is a pipe, a device, a socket or a folder.
    """
    try:
        status = path.stat()
    except (OSError, ValueError) as error:  # a null byte in a name is a ValueError
        told = getattr(error, "strerror", None) or error
        raise InputError(f"{str(path)[:200]}: cannot be read ({told})") from None
    mode = status.st_mode
    inherited = path.absolute().parent in (Path("/dev"), Path("/dev/fd"))
    if (
        stat.S_ISREG(mode)
        or (folder and stat.S_ISDIR(mode))
        or (pipe and inherited and stat.S_ISFIFO(mode))
    ):
        return status
    kind = next((word for test, word in _KINDS if test(mode)), "no file")
    raise InputError(f"{path}: cannot be read (it is {kind}, which is not a regular file)")


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """A scratch folder whose files move to ``folder`` when all are written; else nothing does.

    Files of the same name are replaced; other files in ``folder`` stay.

    Raises
    ------
    InputError
        If ``folder`` is a file, cannot be written, or holds a folder where a file should go.
    """
    missing = _first_missing(folder)
    refuse_unwritable(folder)
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        scratch = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    except OSError as error:
        raise InputError(f"{folder}: cannot be written ({error.strerror})") from None
    try:
        yield scratch
        _move_all(scratch, folder)
        missing = None
    except OSError as error:
        if error.filename is not None:
            raise
        raise InputError(f"{folder}: cannot be written ({error.strerror or error})") from None
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
        if missing is not None:
            shutil.rmtree(missing, ignore_errors=True)


def refuse_unwritable(folder: Path) -> None:
    """Say before a long computation that its results could not be kept.

    Raises
    ------
    InputError
        If ``folder`` is a file, or it or the folder that would hold it may not be written.
    """
    if os.path.lexists(folder) and not folder.is_dir():
        raise InputError(f"{folder}: the output folder is an existing file; name another")
    there = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not there.is_dir():
        raise InputError(f"{folder}: cannot be made, for {there} is a file; name another folder")
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"{folder}: cannot be written (no permission in {there})")


def write_whole(path: Path, content: bytes) -> None:
    """Write beside the goal and move into place, so that nobody ever reads half a file.

    A link is followed; what is no regular file (a pipe, a device) is written into.

    Raises
    ------
    InputError
        If ``path`` is a folder or cannot be written.
    """
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file")
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(content)
            return
        goal = Path(os.path.realpath(path))
        if goal.is_symlink():  # a loop of links leads nowhere
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
        _replaced(goal, content)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None


def _replaced(path: Path, content: bytes) -> None:
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


def _move_all(scratch: Path, folder: Path) -> None:
    moves = [
        (p, folder / p.relative_to(scratch)) for p in sorted(scratch.rglob("*")) if p.is_file()
    ]
    for _, target in moves:
        if target.is_dir():
            raise InputError(f"{target}: is a folder where a file must go; move it away")
    for path, target in moves:
        target.parent.mkdir(parents=True, exist_ok=True)
        path.replace(target)


def _first_missing(folder: Path) -> Path | None:
    """The outermost folder that must be made on the way to ``folder``."""
    missing = [p for p in (folder, *folder.parents) if not p.exists()]
    return missing[-1] if missing else None
