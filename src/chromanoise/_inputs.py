"""Input files: only regular files are read, because reading a pipe or a device may never end."""

import os
import stat
from pathlib import Path

from chromanoise.errors import InputError

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
        reason = getattr(error, "strerror", None) or error
        raise InputError(str(path)[:200], f"cannot be read ({reason})") from None
    mode = status.st_mode
    inherited = path.absolute().parent in (Path("/dev"), Path("/dev/fd"))
    if (
        stat.S_ISREG(mode)
        or (folder and stat.S_ISDIR(mode))
        or (pipe and inherited and stat.S_ISFIFO(mode))
    ):
        return status
    kind = next((word for test, word in _KINDS if test(mode)), "of another kind")
    raise InputError(str(path), "must be a regular file", value=kind, found=f"is {kind}")
