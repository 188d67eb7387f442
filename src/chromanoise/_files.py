"""Atomic output: a file or folder appears complete or not at all.

A run writes into a scratch folder ``.NAME-xxxxxxxx`` next to the output folder ``NAME`` and holds a
lock on ``.NAME.chromanoise-lock``, which the system releases when the process ends. The first line
of the lock file names the process and the scratch folder. Before the scratch folder is exchanged
for an existing folder, a second line lists the files that are replaced. The cleanup removes the
scratch folder and keeps files that other programs have added. It is done by this run or, if this
run was killed, by the next one.
"""

import ctypes
import errno
import json
import os
import re
import secrets
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from chromanoise._inputs import json_of
from chromanoise.errors import InputError, StudyError, errors_in

if sys.platform != "win32":
    import fcntl

_SUMMARIES = (".json", ".html")  # files that describe the other files
_LOCK_ATTEMPTS, _LOCK_PAUSE_S = 5, 0.02
_OPEN_ATTEMPTS = 100
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2  # of linux/fcntl.h and linux/fs.h


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """A scratch folder whose files move to ``folder`` once all are written; on failure none does.

    Files of the same name are replaced; other files in ``folder`` stay.

    Raises
    ------
    InputError
        As `claimed_folder`, or if ``folder`` contains a folder with the name of an output file.
    """
    with claimed_folder(folder) as scratch_folder, scratch_folder() as scratch:
        yield scratch


@contextmanager
def claimed_folder(folder: Path) -> Iterator[Callable[[], AbstractContextManager[Path]]]:
    """Keep other runs out of ``folder``, and yield a function that makes a `whole_folder` of it.

    If ``folder`` is missing or empty, one rename makes it appear. If the run replaces all files in
    it and owner and group stay the same, it is exchanged in one step, where the system supports it.
    Otherwise the files are moved in one by one: old JSON and HTML files of the same names are
    removed first and the new ones moved last, so that no summary describes an incomplete set.

    Raises
    ------
    InputError
        If ``folder`` is a file, cannot be written, or another process is writing into it.
    """
    refuse_unwritable(folder)
    goal = Path(os.path.realpath(folder))
    place = _place(goal)
    missing = [parent for parent in (place, *place.parents) if not parent.exists()]
    scratch = place / f".{goal.name}-{secrets.token_hex(4)}"

    @contextmanager
    def scratch_folder() -> Iterator[Path]:
        with _write_errors(folder):
            scratch.mkdir()
        try:
            with _named_as(folder, scratch):
                yield scratch
            with _write_errors(folder):
                _appear(scratch, goal, journal)
        finally:
            _clear(goal, journal)

    try:
        with _locked(place, goal, folder, scratch) as journal:
            yield scratch_folder
    finally:
        with suppress(OSError):  # not empty: another program may have added files
            for parent in missing:
                parent.rmdir()


def refuse_unwritable(folder: Path) -> None:
    """Raise an error before a long computation if its results could not be written.

    Raises
    ------
    InputError
        If ``folder`` is a file, it or its parent folder may not be written, or another process is
        writing into it.
    """
    if os.path.lexists(folder) and not folder.is_dir():
        raise InputError(
            str(folder),
            "must be a folder",
            found="is an existing file",
            remedy="name another folder",
        )
    there = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not there.is_dir():
        raise InputError(
            str(folder),
            "must lie in a folder",
            value=str(there),
            found=f"{there} is a file",
            remedy="name another folder",
        )
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(
            str(folder),
            f"cannot be written (no permission in {there})",
            remedy="name another folder",
        )
    goal = Path(os.path.realpath(folder))
    for place in (goal, goal.parent):
        _refuse_held(_lock_file(place, goal), folder)


def write_whole(path: Path, content: bytes) -> None:
    """Write a temporary file in the same folder and rename it, so that no partial file is visible.

    A link is followed. A pipe or a device is written to directly.

    Raises
    ------
    InputError
        If ``path`` is a folder or cannot be written.
    """
    write_all_whole({path: content})


def write_all_whole(contents: Mapping[Path, bytes]) -> None:
    """Write several files as `write_whole`; none is replaced before all temporary files are made.

    Raises
    ------
    InputError
        If one of the paths is a folder or cannot be written.
    """
    with ExitStack() as stack:
        steps = {path: stack.enter_context(_prepared(path, contents[path])) for path in contents}
        for path, step in steps.items():
            with _write_errors(path):
                step()


@contextmanager
def _prepared(path: Path, content: bytes) -> Iterator[Callable[[], object]]:
    """The function that puts the content in place, after it was written beside the file."""
    if path.is_dir():
        raise InputError(str(path), "must be a file", found="is a folder", remedy="name a file")
    if path.exists() and not path.is_file():
        yield lambda: path.write_bytes(content)
        return
    scratch = None
    try:
        with _write_errors(path):
            goal = Path(os.path.realpath(path))
            if goal.is_symlink():  # links in a loop have no target
                raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
            goal.parent.mkdir(parents=True, exist_ok=True)
            handle, name = tempfile.mkstemp(prefix=f".{goal.name}-", dir=goal.parent)
            scratch = Path(name)
            with os.fdopen(handle, "wb") as part:
                part.write(content)
            scratch.chmod(0o644)  # temporary files are readable by their owner only
        yield lambda: scratch.replace(goal)
    finally:
        if scratch is not None:
            scratch.unlink(missing_ok=True)


def renamed(error: InputError, old: str, new: str) -> InputError:
    """The same error with ``old`` replaced by ``new`` in the names of files.

    Parameters
    ----------
    error
        A single error, or a `StudyError` of several.
    old, new
        Beginning of a path, e.g. the scratch folder and the output folder.

    Examples
    --------
    >>> str(renamed(InputError("/tmp/.out-1/a.png", "cannot be written"), "/tmp/.out-1", "out"))
    'out/a.png: cannot be written'
    """
    parts = [_renamed(part, old, new) for part in errors_in(error)]
    return StudyError(parts, error.places) if isinstance(error, StudyError) else parts[0]


def _renamed(error: InputError, old: str, new: str) -> InputError:
    value, remedy = error.value, error.remedy
    return InputError(
        error.subject.replace(old, new),
        error.requirement.replace(old, new),
        value=value.replace(old, new) if isinstance(value, str) else value,
        found=error.found and error.found.replace(old, new),
        where=error.where.replace(old, new),
        remedy=[one.replace(old, new) if isinstance(one, str) else one for one in remedy],
        setting=error.setting,
    )


@contextmanager
def _named_as(folder: Path, scratch: Path) -> Iterator[None]:
    """Make errors name the output folder instead of the scratch folder or an empty file name."""
    try:
        yield
    except InputError as error:
        raise renamed(error, str(scratch), str(folder)) from None
    except OSError as error:
        name = str(error.filename or folder)
        if error.filename is not None and not name.startswith(str(scratch)):
            raise
        name = name.replace(str(scratch), str(folder))
        raise InputError(name, f"cannot be written ({error.strerror or error})") from None


@contextmanager
def _write_errors(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(str(path), f"cannot be written ({error.strerror or error})") from None


def _place(goal: Path) -> Path:
    """The folder for lock and scratch: the parent, or the folder itself if it cannot be renamed."""
    if not goal.is_dir():
        return goal.parent
    with suppress(FileNotFoundError):  # the working folder was removed
        if Path.cwd().is_relative_to(goal):
            return goal
    renamed = os.access(goal.parent, os.W_OK | os.X_OK) and not _is_mount(goal)
    return goal.parent if renamed else goal


def _is_mount(folder: Path) -> bool:
    if os.path.ismount(folder):
        return True
    try:  # bind mounts within one file system are listed here only
        mounts = Path("/proc/self/mountinfo").read_text(errors="surrogateescape").splitlines()
    except OSError:
        return False
    return str(folder).replace(" ", "\\040") in (line.split()[4] for line in mounts)


def _lock_file(place: Path, goal: Path) -> Path:
    return place / f".{goal.name}.chromanoise-lock"


@contextmanager
def _locked(place: Path, goal: Path, folder: Path, scratch: Path) -> Iterator[IO[str]]:
    """The lock file, locked, after what a killed run left has been removed."""
    path = _lock_file(place, goal)
    with _write_errors(folder):
        journal = held = _held_file(path, folder)
        if journal is None:  # without locks, each run has a lock file of its own
            path = path.with_name(f"{path.name}-{secrets.token_hex(4)}")
            journal = path.open("a+")
    with journal:
        try:
            _clear_elsewhere(place, goal, folder)
            _clear(goal, journal)
            with _write_errors(folder):
                journal.truncate(0)
                _note(journal, {"process": os.getpid(), "scratch": scratch.name})
            yield journal
        finally:
            _clear(goal, journal)  # if this is interrupted, the next run completes it
            if held is None:  # Windows cannot remove an open file; a held lock is removed first
                journal.close()
            path.unlink(missing_ok=True)


def _held_file(path: Path, folder: Path) -> IO[str] | None:
    """The lock file, locked for this process; ``None`` where the file system has no locks."""
    missed = 0
    while True:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            journal = path.open("a+")
        except FileNotFoundError:  # a run that ended has removed the parent
            missed += 1
            if missed > _OPEN_ATTEMPTS:  # a file system without new files, such as /proc
                raise
            continue
        try:
            locked = _lock(journal, folder)
            if locked and _is_at(path, journal):
                return journal
        except BaseException:
            journal.close()
            raise
        journal.close()
        if not locked:
            path.unlink(missing_ok=True)
            return None


def _is_at(path: Path, opened: IO[str]) -> bool:
    """Whether an open file is still at its path; a run that ends removes its lock file."""
    with suppress(FileNotFoundError):
        return os.path.samestat(path.stat(), os.fstat(opened.fileno()))
    return False


def _lock(journal: IO[str], folder: Path) -> bool:
    """Whether this process has locked the file; ``False`` if the file system has no locks."""
    if sys.platform == "win32":
        return False
    try:
        _flock(journal, fcntl.LOCK_EX)
    except BlockingIOError:
        lines = _notes(journal)
        who = f"process {lines[0].get('process')}" if lines else "another process"
        raise InputError(
            str(folder),
            "must not be written by two processes",
            value=lines[0].get("process") if lines else None,
            found=f"{who} is writing into it",
            remedy=("wait until that ends", "name another folder"),
        ) from None
    except OSError:
        return False
    return True


def _flock(journal: IO[str], kind: int) -> None:
    """Lock the file, with retries: a starting run holds the lock briefly to test it."""
    for _ in range(_LOCK_ATTEMPTS):
        with suppress(BlockingIOError):
            fcntl.flock(journal, kind | fcntl.LOCK_NB)
            return
        time.sleep(_LOCK_PAUSE_S)
    fcntl.flock(journal, kind | fcntl.LOCK_NB)


def _clear_elsewhere(place: Path, goal: Path, folder: Path) -> None:
    """Clean up after a run whose lock and scratch folder are in the other possible place."""
    path = _lock_file(goal if place != goal else goal.parent, goal)
    with suppress(OSError):
        journal = _held_file(path, folder) if path.exists() else None
        if journal is not None:
            with journal:
                _clear(goal, journal)
                path.unlink()


def _refuse_held(path: Path, folder: Path) -> None:
    if not path.is_file():  # opening a pipe would wait
        return
    with suppress(OSError), path.open() as journal:
        _lock(journal, folder)


def _note(journal: IO[str], entry: dict[str, Any]) -> None:
    journal.write(json.dumps(entry) + "\n")
    journal.flush()


def _notes(journal: IO[str]) -> list[dict[str, Any]]:
    """The complete lines of a lock file; none if chromanoise did not write it."""
    journal.seek(0)
    try:
        lines = [json_of(line, journal.name) for line in journal.readlines() if line.endswith("\n")]
    except ValueError:  # among them an InputError
        return []
    return lines if all(isinstance(line, dict) for line in lines) else []


def _appear(scratch: Path, goal: Path, journal: IO[str]) -> None:
    """Move the files of the scratch folder to the goal."""
    made = [path.relative_to(scratch) for path in scratch.rglob("*") if not path.is_dir()]
    files = sorted(made, key=lambda name: (name.suffix in _SUMMARIES, name))
    for name in files:
        if (goal / name).is_dir():
            raise InputError(
                str(goal / name), "must be a file", found="is a folder", remedy="move it away"
            )
    one_step = scratch.parent != goal and not (goal.exists() and len(files) == 1)
    if one_step and _swapped_in(scratch, goal, journal):
        return
    for name in files:
        (goal / name).parent.mkdir(parents=True, exist_ok=True)
    for name in files if len(files) > 1 else ():
        if name.suffix in _SUMMARIES:
            (goal / name).unlink(missing_ok=True)
    for name in files:
        (scratch / name).replace(goal / name)


def _swapped_in(scratch: Path, goal: Path, journal: IO[str]) -> bool:
    """Whether the scratch folder has replaced a goal that holds no files of other programs."""
    try:
        if goal.exists():
            ours, old = scratch.stat(), goal.stat()
            if (ours.st_uid, ours.st_gid) != (old.st_uid, old.st_gid):
                return False
            there, made = list(goal.iterdir()), sorted(path.name for path in scratch.iterdir())
            replaced = all(path.name in made for path in there)
            if there and (not replaced or any(path.is_dir() for path in scratch.iterdir())):
                return False
            shutil.copystat(goal, scratch)
            os.utime(scratch)
            if there:
                _note(journal, {"replaced": made})
                return _exchanged(scratch, goal)
        scratch.rename(goal)
    except OSError:
        return False
    return True


def _exchanged(one: Path, other: Path) -> bool:
    """Exchange the names of two folders atomically; ``False`` if not supported (Linux only)."""
    exchange = getattr(ctypes.CDLL(None), "renameat2", None) if os.name == "posix" else None
    if exchange is None:
        return False
    names = os.fsencode(one), os.fsencode(other)
    return exchange(_AT_FDCWD, names[0], _AT_FDCWD, names[1], _RENAME_EXCHANGE) == 0


def _clear(goal: Path, journal: IO[str]) -> None:
    """Remove the scratch folder of a lock file; files that other programs added are kept."""
    notes = _notes(journal)
    name = str(notes[0].get("scratch")) if notes else ""
    scratch = Path(journal.name).parent / name
    ours = re.fullmatch(rf"\.{re.escape(goal.name)}-[0-9a-f]{{8}}", name)
    if not ours or scratch.is_symlink():
        return
    if len(notes) == 1:
        shutil.rmtree(scratch, ignore_errors=True)
        return
    with suppress(OSError):
        for path in scratch.iterdir():
            if path.name in notes[1]["replaced"]:
                path.unlink()
            elif not os.path.lexists(goal / path.name):
                path.rename(goal / path.name)
        scratch.rmdir()
    journal.truncate(len(json.dumps(notes[0])) + 1)
