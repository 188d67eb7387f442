"""Files that were dropped on the page, kept for a time under names of ours."""

import hashlib
import re
import shutil
import tempfile
import threading
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from chromanoise.base import dataclass
from chromanoise.web.page_questions import QuestionError

MOST_FILES = 256
MOST_BYTES = 128_000_000

_ID = re.compile(r"upload:[0-9a-f]{16}(\.[a-z0-9]+)?")
_ENDINGS = {
    "table": (".csv", ".tsv", ".txt", ".json", ".sp", ".spdx", ".xml", ".xlsx"),
    "cube": (".npz", ".npy", ".tif", ".tiff", ".h5", ".hdf5", ".nc"),
    "either": (".mat",),
    "matrix": (".clf", ".dng", ".dcp"),
    "toml": (".toml",),
}


@dataclass(frozen=True, kw_only=True)
class Upload:
    """A file that was dropped.

    Attributes
    ----------
    id
        By which questions name it: ``upload:``, a digest of its content, and its ending.
    label
        What it was called, as far as it can be shown; never a path.
    path
        Where it lies, under a name of ours.
    kind
        ``table``, ``cube``, ``either``, ``matrix`` or ``toml``, by its ending.
    """

    id: str
    label: str
    path: Path
    kind: str
    size_bytes: int


class Kept:
    """The files that a question may name."""

    def __init__(self) -> None:
        self._kept: OrderedDict[str, Upload] = OrderedDict()
        self._lock = threading.Lock()

    def hold(self, files: tuple[Upload, ...]) -> None:
        """Keep these files, and no others."""
        with self._lock:
            self._kept = OrderedDict((one.id, one) for one in files)

    def held(self) -> tuple[Upload, ...]:
        """All files."""
        with self._lock:
            return tuple(self._kept.values())

    def named(self, word: str) -> Upload | None:
        """The file that a word of a study names; ``None`` if it names none of ours.

        Raises
        ------
        QuestionError
            If it names one that is not here any more.
        """
        match = _ID.match(word)
        if match is None:
            return None
        with self._lock:
            found = self._kept.get(match[0])
        if found is None:
            raise QuestionError(
                (
                    "",
                    "this file was dropped earlier and is not available any more; drop it again",
                )
            )
        return found


class Uploads(Kept):
    """A temporary folder; when it is full the oldest files go."""

    def __init__(self) -> None:
        super().__init__()
        self._folder = Path(tempfile.mkdtemp(prefix="chromanoise-"))

    def keep(self, name: str, content: bytes) -> Upload:
        """The file, written.

        Raises
        ------
        QuestionError
            If its ending says that nothing here reads it, or it is empty.
        """
        label, ending = label_of(name), _ending(name)
        kind = next((kind for kind, known in _ENDINGS.items() if ending in known), None)
        if kind is None:
            every = ", ".join(one for known in _ENDINGS.values() for one in known)
            raise QuestionError(("file", f"{label}: the page reads files that end in {every}"))
        if not content:
            raise QuestionError(("file", f"{label}: the file is empty"))
        digest = hashlib.sha256(ending.encode() + content).hexdigest()[:16]
        path = self._folder / f"{digest}{ending}"
        one = Upload(
            id=f"upload:{digest}{ending}",
            label=label,
            path=path,
            kind=kind,
            size_bytes=len(content),
        )
        with self._lock:
            self._kept.pop(one.id, None)
            self._make_room(one.size_bytes)
            path.write_bytes(content)
            self._kept[one.id] = one
        return one

    def make_folder(self) -> None:
        """Make the folder again, if it is gone."""
        self._folder.mkdir(parents=True, exist_ok=True)

    @contextmanager
    def empty_folder(self) -> Iterator[Path]:
        """A folder for one job, removed with all that is in it, however the job ends."""
        made = tempfile.TemporaryDirectory(dir=self._folder, ignore_cleanup_errors=True)
        with made as name:
            yield Path(name)

    def close(self) -> None:
        """Remove all of it."""
        shutil.rmtree(self._folder, ignore_errors=True)

    def _make_room(self, size_bytes: int) -> None:
        def total() -> int:
            return sum(one.size_bytes for one in self._kept.values())

        while self._kept and (len(self._kept) >= MOST_FILES or total() + size_bytes > MOST_BYTES):
            _, oldest = self._kept.popitem(last=False)
            oldest.path.unlink(missing_ok=True)


def upload_at(path: Path) -> Upload:
    """A file of the server's user, to be read as an uploaded table; it is not kept."""
    size_bytes = path.stat().st_size if path.exists() else 0
    label = label_of(path.name)
    return Upload(id="", label=label, path=path.absolute(), kind="table", size_bytes=size_bytes)


def label_of(name: str) -> str:
    r"""The last step of a name, as far as it can be shown.

    Examples
    --------
    >>> label_of("../../etc/pass\x00wd.csv"), label_of("C:\\curves\\night.csv")
    ('passwd.csv', 'night.csv')
    """
    last = re.split(r"[/\\]", name)[-1]
    return "".join(c for c in last if c.isprintable()).strip()[:60] or "a file"


def in_path(word: str, upload: Upload) -> str:
    """A word of a study with the file's path in place of its id: a light may have more behind."""
    return word.replace(upload.id, str(upload.path), 1)


def in_words(text: str, upload: Upload) -> str:
    """A sentence or a name that speaks of the file as its person calls it."""
    stem = Path(upload.label).stem or upload.label
    return text.replace(str(upload.path), upload.label).replace(upload.path.stem, stem)


def _ending(name: str) -> str:
    return Path(label_of(name)).suffix.lower()
