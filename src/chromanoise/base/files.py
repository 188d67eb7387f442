"""Output files and folders that appear complete or not at all, and CSV text that is safe to open.

No foreign file is replaced.

An output folder holds the list ``.chromanoise-files``: the name of each file that a run wrote, the
command, and the SHA-256 of its content. A run replaces or removes a file only if the list shows
that the same command wrote it and that it is unchanged; otherwise the run refuses the folder.
The list is a separate file, because some commands write no record that could hold it, and because
equal runs must write equal records. Its name has no suffix, so that no reader treats it as data.
While files are moved into the folder, the list holds the hashes of the old and the new content.

A run writes into a scratch folder ``.NAME-xxxxxxxx`` next to the output folder ``NAME`` and holds a
lock on ``.NAME.chromanoise-lock``, which the system releases when the process ends. The first line
of the lock file names the process and the scratch folder. Before the scratch folder is exchanged
for an existing folder, a second line lists the files that are replaced. The cleanup removes the
scratch folder and keeps files that other programs have added. It is done by this run or, if this
run was killed, by the next one.

CSV is written so that a spreadsheet reads no cell as a formula, and reading restores the text.
"""

import csv
import ctypes
import errno
import hashlib
import io
import json
import os
import re
import secrets
import shutil
import stat
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import field, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import IO, Any

from chromanoise.base.errors import InputError, StudyError, errors_in
from chromanoise.base.immutable import dataclass
from chromanoise.base.inputs import json_file, json_of, true_path

if sys.platform not in ("win32", "wasi"):
    import fcntl

_SUMMARIES = (".json", ".html")  # files that describe the other files
_LOCK_ATTEMPTS, _LOCK_PAUSE_S = 5, 0.02
_EMPTY = hashlib.sha256().hexdigest()
_ELSEWHERE = ("choose another folder", "move it away")
_LOCK_START = b'{"process": '
_OPEN_ATTEMPTS = 100
_NEW_FILE = os.O_CREAT | os.O_EXCL | os.O_WRONLY | getattr(os, "O_BINARY", 0)
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2  # of linux/fcntl.h and linux/fs.h
OWN_FILES = ".chromanoise-files"
"""The list of the files that runs wrote into a folder."""
_MOST_BYTES = 64 << 20  # of that list


@contextmanager
def whole_folder(folder: Path, command: str) -> Iterator[Path]:
    """A scratch folder whose files move to ``folder`` once all are written; on failure none does.

    Parameters
    ----------
    folder
        Output folder. Files that the same command wrote are replaced; other files stay.
    command
        Name of the command that writes.

    Raises
    ------
    InputError
        As `claimed_folder`, or as `ClaimedFolder.scratch`.
    """
    with claimed_folder(folder, command) as claimed, claimed.scratch() as scratch:
        yield scratch


@contextmanager
def claimed_folder(folder: Path, command: str) -> Iterator["ClaimedFolder"]:
    """Keep other runs out of a folder while one or more sets of files are written into it.

    After an error the folder is as it was before, except for the files of `ClaimedFolder.keep`.
    Complete sets of files stay if the user stops the run, or if the disk is full or the memory too
    small.

    Parameters
    ----------
    folder
        Output folder; created if it does not exist.
    command
        Name of the command that writes.

    Raises
    ------
    InputError
        If ``folder`` is a file, cannot be written, or another process is writing into it.
    """
    refuse_unwritable(folder)
    goal = true_path(folder)
    place = _place(goal)
    missing = [parent for parent in (goal, *goal.parents) if not parent.exists()]
    scratch = place / f".{goal.name}-{secrets.token_hex(4)}"
    try:
        with _locked(place, goal, folder, scratch) as journal:
            own = _own_files(goal, folder)
            claimed = ClaimedFolder(folder, command, goal, scratch, journal, own)
            try:
                yield claimed
            except Exception as error:
                machine = OSError | MemoryError
                if not isinstance(error, machine) and not isinstance(error.__cause__, machine):
                    claimed._take_back()
                raise
    finally:
        with suppress(OSError):  # not empty: another program may have added files
            for parent in missing:
                if parent.exists():
                    parent.rmdir()


@dataclass(frozen=True)
class _Own:
    """An entry of the list: the command, and the SHA-256 of each content that the file may have."""

    command: str
    sha256: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class ClaimedFolder:
    """A folder into which only this run writes; made by `claimed_folder`.

    Attributes
    ----------
    folder
        Path of the folder, as the caller gave it.
    command
        Name of the command that writes.
    """

    folder: Path
    command: str
    _goal: Path
    _scratch: Path
    _journal: IO[str]
    _before: Mapping[str, _Own]
    _added: set[str] = field(default_factory=set)
    _folders: set[Path] = field(default_factory=set)

    @contextmanager
    def scratch(self, *, outdated: str = "") -> Iterator[Path]:
        """A scratch folder whose files move to the folder once all are written.

        If the folder is missing or empty, one rename makes it appear. If the run replaces all files
        in it and owner and group stay the same, it is exchanged in one step, where the system
        supports it. Otherwise the files are moved in one by one: old JSON and HTML files of the
        same names are removed first and the new ones moved last, so that no summary describes an
        incomplete set.

        Parameters
        ----------
        outdated
            Pattern of file names. Matching files that an earlier run of the command wrote and that
            this run does not write again are removed, unless they were changed.

        Raises
        ------
        InputError
            As `refuse_taken`, for the files that were written.
        """
        with _write_errors(self.folder):
            mode = stat.S_IMODE(self._goal.stat().st_mode) | 0o700 if self._goal.exists() else 0o777
            self._scratch.mkdir(mode)
        try:
            with _named_as(self.folder, self._scratch):
                yield self._scratch
            with _write_errors(self.folder):
                self._appear(outdated)
        finally:
            _clear(self._goal, self._journal)

    def keep(self, name: str, *, adopted: bool = False) -> None:
        """List a file that `write_kept` will write and that stays if the run fails.

        Parameters
        ----------
        name
            Name of the file.
        adopted
            Whether the user asked to continue from an existing file of this name, even if no run
            wrote it here.

        Raises
        ------
        InputError
            As `refuse_taken`.
        """
        if not adopted:
            self.refuse_taken([name])
        now = digest_of(self._goal / name)
        own = _own_files(self._goal, self.folder)
        own[name] = _Own(self.command, () if now is None else (now,))
        with _write_errors(self.folder):
            _list_own(self._goal, own)

    def refuse_taken(self, names: Iterable[str], *, remedy: Sequence[str] = _ELSEWHERE) -> None:
        """Raise an error before a long computation if an output would replace a foreign file.

        Parameters
        ----------
        names
            Names of the files that may be written, relative to the folder.
        remedy
            Remedies for the message.

        Raises
        ------
        InputError
            If a file exists that this command did not write or that was changed since, or if a
            folder is in the place of a file, or a file in that of a folder.
        """
        self._refuse(names, self._before, remedy)

    def _refuse(
        self, names: Iterable[str], own: Mapping[str, _Own], remedy: Sequence[str] = _ELSEWHERE
    ) -> None:
        for name in names:
            path, shown = self._goal / name, str(self.folder / name)
            for parent in path.relative_to(self._goal).parents:
                there = self._goal / parent
                if os.path.lexists(there) and not there.is_dir():
                    raise InputError(
                        str(self.folder / parent),
                        "must be a folder",
                        found="is a file",
                        remedy=remedy,
                    )
            if path.is_dir() and not path.is_symlink():
                raise InputError(shown, "must be a file", found="is a folder", remedy=remedy)
            if os.path.lexists(path) and not self._is_own(name, own):
                entry = own.get(name)
                ours = entry is not None and entry.command == self.command
                raise InputError(
                    shown,
                    "must not be replaced",
                    found="was changed after it was written"
                    if ours
                    else "was not written by this command",
                    remedy=remedy,
                )

    def _is_own(self, name: str, own: Mapping[str, _Own]) -> bool:
        """Whether this command wrote the file and the file is unchanged."""
        entry = own.get(name)
        if entry is None or entry.command != self.command:
            return False
        known = (*entry.sha256, _EMPTY)  # empty after a power failure
        return digest_of(self._goal / name) in known

    def _appear(self, outdated: str) -> None:
        """Move the files of the scratch folder to the goal."""
        scratch, goal = self._scratch, self._goal
        made = [path.relative_to(scratch) for path in scratch.rglob("*") if not path.is_dir()]
        files = sorted(made, key=lambda file: (file.suffix in _SUMMARIES, file))
        if not files:
            return
        new = {
            file.as_posix(): _Own(self.command, (str(digest_of(scratch / file)),)) for file in files
        }
        own = _own_files(goal, self.folder)
        self._refuse(new, own)
        left = [name for name in own if fnmatch(name, outdated) and name not in new]
        old = [name for name in left if self._is_own(name, own)]
        then = {name: one for name, one in own.items() if name not in left} | new
        self._added.update(name for name in new if not os.path.lexists(goal / name))
        parents = {goal / parent for file in files for parent in file.parents}
        self._folders.update(parent for parent in parents if not parent.exists())
        for name in new:
            _keep_mode(goal / name, scratch / name)
        if scratch.parent != goal and not (goal.exists() and len(files) == 1) and not old:
            _list_own(scratch, then, like=goal)
            if _swapped_in(scratch, goal, self._journal):
                return
        for file in files:
            (goal / file).parent.mkdir(parents=True, exist_ok=True)
        either = {
            name: replace(new[name], sha256=(*new[name].sha256, *own[name].sha256))
            for name in new
            if name in own
        }
        _list_own(scratch, own | new | either, like=goal)
        (scratch / OWN_FILES).replace(goal / OWN_FILES)
        for file in files if len(files) > 1 else ():
            if file.suffix in _SUMMARIES:
                (goal / file).unlink(missing_ok=True)
        for file in files:
            (scratch / file).replace(goal / file)
        for name in old:
            (goal / name).unlink(missing_ok=True)
        _list_own(scratch, then, like=goal)
        (scratch / OWN_FILES).replace(goal / OWN_FILES)

    def _take_back(self) -> None:
        """Remove the files that this run added; those of `keep` stay."""
        with suppress(OSError, InputError):
            now = _own_files(self._goal, self.folder)
            for name in self._added:
                if self._is_own(name, now):
                    (self._goal / name).unlink()
            rest = {
                name: one
                for name, one in (dict(self._before) | now).items()
                if name in self._before or os.path.lexists(self._goal / name)
            }
            if rest and rest != now:
                _list_own(self._goal, rest)
            elif not rest:
                (self._goal / OWN_FILES).unlink(missing_ok=True)
        for folder in sorted(self._folders, reverse=True):  # a folder comes before its parent
            with suppress(OSError):  # another program may have added files
                folder.rmdir()


def refuse_unwritable(folder: Path) -> None:
    """Raise an error before a long computation if its results could not be written.

    Raises
    ------
    InputError
        If ``folder`` is a file, it or its parent folder may not be written, or another process is
        writing into it.
    """
    _refuse_folder(folder)
    goal = true_path(folder)
    for place in (goal, goal.parent):
        _refuse_held(_lock_file(place, goal), folder)


def refuse_unwritable_file(path: Path) -> None:
    """Raise an error before a long computation if `write_whole` could not write the file.

    Raises
    ------
    InputError
        If ``path`` is a folder, or it or its folder may not be written.
    """
    goal = _goal_of(path)
    if goal is not None:
        _refuse_folder(goal.parent if path.is_symlink() else path.parent)


def _refuse_folder(folder: Path) -> None:
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


def write_whole(path: Path, content: bytes) -> None:
    """Write a temporary file in the same folder and rename it, so that no partial file is visible.

    A link is followed. A pipe or a device is written to directly.

    Raises
    ------
    InputError
        If ``path`` is a folder or cannot be written.
    """
    write_all_whole({path: content})


def write_kept(path: Path, content: bytes) -> None:
    """As `write_whole`, for a file of `ClaimedFolder.keep`; updates its hash in the list of files.

    Raises
    ------
    InputError
        As `write_whole`.
    """
    goal = true_path(path.parent)
    own, new = _own_files(goal, path.parent), hashlib.sha256(content).hexdigest()
    entry = own.get(path.name)
    if entry is None:
        write_whole(path, content)
        return
    with _write_errors(path):
        _list_own(goal, own | {path.name: replace(entry, sha256=(*entry.sha256, new))})
        write_whole(path, content)
        _list_own(goal, own | {path.name: replace(entry, sha256=(new,))})


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
    goal = _goal_of(path)
    if goal is None:
        yield lambda: path.write_bytes(content)
        return
    scratch = None
    try:
        with _write_errors(path):
            goal.parent.mkdir(parents=True, exist_ok=True)
            scratch = goal.with_name(f".{goal.name[:40]}-{secrets.token_hex(4)}")
            mode = stat.S_IMODE(goal.stat().st_mode) if goal.exists() else 0o666  # but the umask
            with os.fdopen(os.open(scratch, _NEW_FILE, mode), "wb") as part:
                part.write(content)
            _keep_mode(goal, scratch)
        yield lambda: scratch.replace(goal)
    finally:
        if scratch is not None:
            scratch.unlink(missing_ok=True)


def _goal_of(path: Path) -> Path | None:
    """The file to write, with links followed; ``None`` for a pipe or a device."""
    if path.is_dir():
        raise InputError(str(path), "must be a file", found="is a folder", remedy="name a file")
    if path.exists() and not path.is_file():
        return None
    with _write_errors(path):
        goal = true_path(path)
        if goal.is_symlink():  # links in a loop have no target
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
        if goal.exists() and not os.access(goal, os.W_OK):
            raise OSError(errno.EACCES, os.strerror(errno.EACCES))
    return goal


def _keep_mode(old: Path, new: Path) -> None:
    """Give a new file the mode, owner and group of the old file that it replaces, if any."""
    if old.is_symlink() or not old.exists():
        return
    facts, made = old.stat(), new.stat()
    if hasattr(os, "chown") and (facts.st_uid, facts.st_gid) != (made.st_uid, made.st_gid):
        with suppress(OSError):  # only the superuser may give files away
            os.chown(new, facts.st_uid, facts.st_gid)
    new.chmod(stat.S_IMODE(facts.st_mode))


def _own_files(goal: Path, folder: Path) -> dict[str, _Own]:
    """The entries of the list of a folder, by file name; empty if the folder has no list."""
    path = goal / OWN_FILES
    if not os.path.lexists(path):
        return {}
    try:
        if path.is_symlink():
            raise ValueError
        files = json_file(path, most_bytes=_MOST_BYTES)["files"]
        if any(Path(name).is_absolute() or ".." in Path(name).parts for name in files):
            raise ValueError
        return {
            str(name): _Own(str(one["command"]), tuple(map(str, one["sha256"])))
            for name, one in files.items()
        }
    except (ValueError, KeyError, TypeError, AttributeError, OSError):  # among them an InputError
        raise InputError(
            str(folder / OWN_FILES),
            "must be the list of files that a run wrote",
            found="is another file, or was changed",
            remedy=_ELSEWHERE,
        ) from None


def _list_own(folder: Path, own: Mapping[str, _Own], *, like: Path | None = None) -> None:
    """Write the list into a folder, with the mode of the list that it replaces."""
    files = {name: {"command": one.command, "sha256": one.sha256} for name, one in own.items()}
    text = json.dumps({"files": files}, indent=1, sort_keys=True)
    write_whole(folder / OWN_FILES, f"{text}\n".encode())
    if like is not None:
        _keep_mode(like / OWN_FILES, folder / OWN_FILES)


def digest_of(file: Path, *, linked: bool = False) -> str | None:
    """SHA-256 of a regular file, or also of one that is ``linked``.

    ``None`` if it is another kind of file or cannot be read.
    """
    with suppress(OSError, ValueError):
        if stat.S_ISREG(file.stat(follow_symlinks=linked).st_mode):
            with file.open("rb") as opened:
                return hashlib.file_digest(opened, "sha256").hexdigest()
    return None


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
        raise InputError(name, f"cannot be written ({error.strerror or error})") from error


@contextmanager
def _write_errors(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(str(path), f"cannot be written ({error.strerror or error})") from error


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
    if os.path.lexists(path) and not _is_lock(path):
        raise InputError(
            str(path),
            "must be the lock file of a run",
            found="is another file",
            remedy=_ELSEWHERE,
        )
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


def _is_lock(path: Path) -> bool:
    """Whether a file is empty or has the first bytes of a lock file."""
    with suppress(OSError, ValueError):
        if stat.S_ISREG(path.lstat().st_mode):
            with path.open("rb") as file:
                return file.read(len(_LOCK_START)) in (b"", _LOCK_START)
    return not os.path.lexists(path)  # a run that ended has removed it


def _is_at(path: Path, opened: IO[str]) -> bool:
    """Whether an open file is still at its path; a run that ends removes its lock file."""
    with suppress(FileNotFoundError):
        return os.path.samestat(path.stat(), os.fstat(opened.fileno()))
    return False


def _lock(journal: IO[str], folder: Path) -> bool:
    """Whether this process has locked the file; ``False`` if the file system has no locks."""
    if sys.platform in ("win32", "wasi"):
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
        journal = _held_file(path, folder) if path.exists() and _is_lock(path) else None
        if journal is not None:
            with journal:
                _clear(goal, journal)
                path.unlink()


def _refuse_held(path: Path, folder: Path) -> None:
    if _is_lock(path):  # opening a pipe may wait forever
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


_FORMULA = r"'*\s*[=+\-@\t＝＋－＠]"
_GUARDED = re.compile(f"'(?={_FORMULA})")
_BEGIN = re.compile(f"(?={_FORMULA})")
_SEPARATED = re.compile(rf"([,;\t]\s*)(?={_FORMULA})")
_SEPARATED_GUARDED = re.compile(rf"([,;\t]\s*)'(?={_FORMULA})")


def csv_text(rows: Iterable[Iterable[Any]]) -> str:
    r"""Rows as CSV (RFC 4180, lines end in LF): numbers with all digits, ``None`` as an empty cell.

    Parameters
    ----------
    rows
        Rows of text and numbers. Text that a spreadsheet would interpret as a formula is prefixed
        with an apostrophe (OWASP, CSV injection).

    Examples
    --------
    >>> csv_text([["=1+1", "my sensor", -3.2, None]])
    "'=1+1,my sensor,-3.2,\n"
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([_cell(one) if isinstance(one, str) else one for one in row] for row in rows)
    return text.getvalue()


def csv_comment(key: str, value: str) -> str:
    """A comment line ``# key: value`` of a CSV, in which no cell looks like a formula.

    Parameters
    ----------
    key, value
        Spaces and line ends in the value become single spaces.
    """
    return f"# {key}: {_SEPARATED.sub(_guard_after, ' '.join(value.split()))}\n"


def text_of_cell(cell: str) -> str:
    """The original text of a cell that `csv_text` wrote.

    Examples
    --------
    >>> text_of_cell("'=1+1"), text_of_cell("'tis")
    ('=1+1', "'tis")
    """
    return _GUARDED.sub("", cell, count=1) if _GUARDED.match(cell) else cell


def text_of_comment(value: str) -> str:
    """The original value of a comment that `csv_comment` wrote.

    Examples
    --------
    >>> text_of_comment("a, '-b, c")
    'a, -b, c'
    """
    return _SEPARATED_GUARDED.sub(r"\1", value)


def _cell(text: str) -> str:
    plain = text.replace("\r\n", "\n").replace("\r", "\n")  # csv would leave a lone \r unquoted
    return f"'{plain}" if _BEGIN.match(plain) else plain


def _guard_after(match: re.Match[str]) -> str:
    return f"{match[1]}'"
