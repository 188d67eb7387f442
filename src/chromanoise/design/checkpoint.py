"""A file from which a stopped search continues with the same digits.

It holds plain arrays and one JSON text in the form of ``numpy.savez``, no pickled objects. The
comment of this ZIP archive is the SHA-256 of the archive without it; a changed file is refused.
"""

import hashlib
import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._files import write_kept
from chromanoise._inputs import json_of, regular_file
from chromanoise.design.front import Archive
from chromanoise.errors import InputError

_FORM = 2
_MOST_BYTES, _DIGEST_BYTES = 4 << 30, 64
_DAMAGED = (
    OSError, ValueError, KeyError, TypeError, EOFError, MemoryError, zipfile.BadZipFile,
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Checkpoint:
    """A search after a generation.

    Attributes
    ----------
    search
        What the search must have in common with one that continues it, as plain data.
    generation, evaluations
        Numbers of finished generations and of evaluated candidates.
    archive
        The front so far.
    algorithm
        State of the method.
    """

    search: Mapping[str, Any]
    generation: int
    evaluations: int
    archive: Archive
    algorithm: Mapping[str, Array]


def write_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write the file in one step.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    archive = {
        f"archive.{field.name}": getattr(checkpoint.archive, field.name)
        for field in fields(Archive)
    }
    algorithm = {f"algorithm.{name}": array for name, array in checkpoint.algorithm.items()}
    text = json.dumps(
        {
            "form": _FORM,
            "search": checkpoint.search,
            "generation": checkpoint.generation,
            "evaluations": checkpoint.evaluations,
        }
    )
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, checkpoint=np.array(text), **archive, **algorithm)
    write_kept(path, _sealed(content.getvalue()))


def read_checkpoint(path: Path, search: Mapping[str, Any], empty: Archive) -> Checkpoint:
    """The checkpoint of a search.

    Parameters
    ----------
    path
        A file of `write_checkpoint`.
    search
        As in `Checkpoint`; must equal that of the file.
    empty
        An archive without members, for the expected shapes.

    Raises
    ------
    InputError
        If there is no such file, it is damaged, or it belongs to another search.
    """
    if regular_file(path).st_size > _MOST_BYTES:
        raise _damaged(path, f"has more than {_MOST_BYTES >> 20} MiB")
    try:
        archive_bytes = _unsealed(path.read_bytes())
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})") from None
    if archive_bytes is None:
        raise _damaged(path, "was changed or truncated, as its content hash shows")
    try:
        with np.load(io.BytesIO(archive_bytes), allow_pickle=False) as stored:
            text = json_of(str(stored["checkpoint"]), str(path))
            arrays = {name: stored[name] for name in stored.files if name != "checkpoint"}
        if text["form"] != _FORM or min(text["generation"], text["evaluations"]) < 0:
            raise ValueError
        theirs, generation, evaluations = (
            dict(text["search"]), int(text["generation"]), int(text["evaluations"]),
        )  # fmt: skip
        archive = Archive(
            **{field.name: arrays[f"archive.{field.name}"] for field in fields(Archive)}
        )
    except _DAMAGED:
        raise _damaged(path, "cannot be read as one") from None
    for name, own in search.items():
        if theirs.get(name) != own:
            raise InputError(
                str(path),
                f"must be of a search with the same {name}",
                value=theirs.get(name),
                found=_difference(name, theirs.get(name), own),
                remedy="start the search anew without resume",
            )
    for field in fields(Archive):
        if getattr(archive, field.name).shape[1:] != getattr(empty, field.name).shape[1:]:
            raise _damaged(path, f"its {field.name} have another shape")
    return Checkpoint(
        search=theirs,
        generation=generation,
        evaluations=evaluations,
        archive=archive,
        algorithm={
            name.removeprefix("algorithm."): array
            for name, array in arrays.items()
            if name.startswith("algorithm.")
        },
    )


def _sealed(archive: bytes) -> bytes:
    """The ZIP archive with its SHA-256 as its comment, whose length is in its last two bytes."""
    digest = hashlib.sha256(archive).hexdigest().encode()
    return archive[:-2] + len(digest).to_bytes(2, "little") + digest


def _unsealed(content: bytes) -> bytes | None:
    """The archive of `_sealed`; ``None`` if one of its bytes was changed."""
    archive = content[: -_DIGEST_BYTES - 2] + bytes(2)
    return archive if _sealed(archive) == content else None


def _damaged(path: Path, found: str) -> InputError:
    return InputError(
        str(path),
        "must be a complete checkpoint of a search",
        found=found,
        remedy="start the search anew without resume",
    )


def _difference(name: str, theirs: Any, own: Any) -> str:
    if name in ("identity", "first generation") or not isinstance(own, int | str):
        return f"its {name} differ"
    return f"its {name} is {theirs}, not {own}"
