"""The hash of a study, and a record of what determines the last digits of its results.

The hash covers the settings, the version, and the content of the files. Beyond them, processor,
libraries and kernels determine the last digits.
"""

import hashlib
import json
import platform
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import partial
from numbers import Number
from pathlib import Path
from types import (
    BuiltinFunctionType,
    CodeType,
    FunctionType,
    MappingProxyType,
    MethodType,
    NoneType,
)
from typing import Any, Literal

import numpy as np

from chromanoise.base import (
    InputError,
    __version__,
    blas_kernel,
    dataclass,
    regular_file,
    system_errors_of,
)
from chromanoise.io import DATA_SUFFIXES, envi_pair, is_matrix_file
from chromanoise.spectra import SOURCES
from chromanoise.study.catalog import FOLDER_VARIABLE, catalog_folder
from chromanoise.study.resolve_names import (
    file_of,
    is_file_word,
    is_object_word,
    is_reflectance_file,
    reflectance_files,
    word_files,
)
from chromanoise.study.schema import BALANCE_WORDS, KEYS, Study, StudyKind

Kind = Literal[
    "light",
    "sensor",
    "filter",
    "pixel",
    "crosstalk",
    "matrix",
    "reflectance",
    "observer",
    "cube",
    "wavelengths",
]
"""Of what a word of a study may name a file."""


_FILES_ONLY = ("reflectances.chart", "reflectances.pairs")  # words that are no names


@dataclass(frozen=True, kw_only=True)
class FileWord:
    """A word of a study that may name a file.

    Attributes
    ----------
    word
        As the study has it.
    """

    where: str
    kind: Kind
    word: str


def with_file_words(study: StudyKind, replaced: Callable[[FileWord], str]) -> StudyKind:
    """The study with other words in place of all that may name a file: the list of those keys.

    Examples
    --------
    >>> from chromanoise.study.schema import SensorPart
    >>> study = Study(sensors=(SensorPart(name="a.csv", filter="b.csv"),))
    >>> other = with_file_words(study, lambda one: f"{one.kind}-{one.word}").sensors[0]
    >>> other.name, other.filter, other.pixel.file
    ('sensor-a.csv', 'filter-b.csv', None)
    """
    changes = {}
    for path, one in _file_words(study):
        word = replaced(one)
        if word != one.word:
            changes[path] = word
    for path, word in changes.items():
        study = _with(study, path, word)
    return study


def file_words(study: Study) -> list[FileWord]:
    """All words of a study that may name a file, in the order of the study."""
    return [one for _, one in _file_words(study)]


_Path = tuple[str | int, ...]


def _file_words(study: Study) -> Iterator[tuple[_Path, FileWord]]:
    """Each word with its path in the study."""
    for path, kind, word in _words(study):
        if word is not None and not is_object_word(word):
            yield path, FileWord(where=".".join(map(str, path)), kind=kind, word=word)


def _words(study: Study) -> Iterator[tuple[_Path, Kind, str | None]]:
    yield ("light", "illuminant"), "light", study.light.illuminant
    for i, part in enumerate(study.sensors):
        own = ("sensors", i)
        yield (*own, "pixel", "file"), "pixel", part.pixel.file
        yield (*own, "name"), "sensor", part.name
        yield (*own, "filter"), "filter", part.filter
        for channel, word in (part.channel_filters or {}).items():
            yield (*own, "channel_filters", channel), "filter", word
        if isinstance(part.crosstalk, str):
            yield (*own, "crosstalk"), "crosstalk", part.crosstalk
    for i, picture in enumerate(study.pictures):
        yield ("pictures", i, "cube"), "cube", picture.cube
        if isinstance(picture.wavelengths, str):
            yield ("pictures", i, "wavelengths"), "wavelengths", picture.wavelengths
    for i, name in enumerate(study.matrices):
        if is_matrix_file(name):
            yield ("matrices", i), "matrix", name
    for key in ("chart", "patch", "pairs"):
        word = getattr(study.reflectances, key)
        if _names_reflectances(f"reflectances.{key}", word):
            yield ("reflectances", key), "reflectance", word
    if _names_reflectances("prior", study.prior):
        yield ("prior",), "reflectance", study.prior
    if is_file_word(study.observer, "observer"):
        yield ("observer",), "observer", study.observer
    balance = study.outputs.pipeline.white_balance
    if isinstance(balance, str) and balance not in BALANCE_WORDS:
        yield ("outputs", "pipeline", "white_balance"), "light", balance


def _names_reflectances(where: str, word: object) -> bool:
    return isinstance(word, str) and (where in _FILES_ONLY or is_reflectance_file(word))


def _with(node: Any, path: _Path, value: str) -> Any:
    """A part of a study with another value at a path within it."""
    if not path:
        return value
    key, rest = path[0], path[1:]
    if isinstance(key, int):
        return (*node[:key], _with(node[key], rest, value), *node[key + 1 :])
    if isinstance(node, Mapping):
        return {**node, key: _with(node[key], rest, value)}
    return node.model_copy(update={key: _with(getattr(node, key), rest, value)})


def files_of_word(one: FileWord) -> tuple[Path, ...]:
    """The files whose content decides what a word means; none if it is built in.

    Raises
    ------
    InputError
        If the word cannot be understood, or is too long for the name of a file.
    """
    try:
        if one.kind in ("pixel", "crosstalk", "matrix", "wavelengths"):
            return (file_of(one.word),)
        if one.kind == "reflectance":
            return reflectance_files(one.word) or (file_of(one.word),)
        if one.kind == "cube":
            built_in = one.word.startswith("builtin:")
            return () if built_in else tuple(cube_files(file_of(one.word)))
        return word_files(one.word, one.kind)  # type: ignore[arg-type] # the others are above
    except OSError as error:  # a name that is too long to ask for
        name = str(error.filename)[:60]
        raise InputError(name, f"cannot be read ({error.strerror})") from None


def study_hash(
    study: Study,
    digests: Mapping[str, str] | None = None,
    objects: Mapping[str, Any] = MappingProxyType({}),
) -> str:
    """SHA-256 of the version, the study, and the content of its files and objects.

    Parameters
    ----------
    study
        Study whose words are listed.
    digests
        Of its files, where they are known already; `file_digests` otherwise.
    objects
        Objects of Python that the study names, by their words.

    Raises
    ------
    InputError
        If one of the files cannot be read.
    """
    found = dict(file_digests(study) if digests is None else digests)
    return _hash_of(study, found | {word: object_digest(one) for word, one in objects.items()})


def object_digest(one: Any) -> str:
    """SHA-256 of the numbers, names and functions of an object of Python.

    Of a function its code and the values in it count, not the functions that it calls.

    Parameters
    ----------
    one
        Curves, a sensor, a cube, a matrix, a function ...

    Examples
    --------
    >>> object_digest([1, 2.0]) == object_digest((1.0, 2.0)), object_digest(1) == object_digest("1")
    (True, False)
    """
    digest = hashlib.sha256()
    for piece in _pieces(one):
        digest.update(f"{len(piece)} ".encode() + piece)
    return digest.hexdigest()


def _pieces(one: Any) -> Iterator[bytes]:
    """The numbers of an object as float64, everything else as text, in order."""
    if type(one) in (str, bytes, NoneType):
        yield repr(one).encode()
    elif is_dataclass(one):
        own = getattr(one, "own_noise", ())  # of a class of pixels
        yield from _pieces([own, {field.name: getattr(one, field.name) for field in fields(one)}])
    elif isinstance(one, np.ndarray | Number) and (array := np.asarray(one)).dtype.kind in "biuf":
        yield from (repr(array.shape).encode(), array.astype(np.float64).tobytes())
    elif isinstance(one, Mapping):
        yield from _pieces(list(one.items()))
    elif isinstance(one, frozenset):
        yield from _pieces(sorted(map(repr, one)))
    elif isinstance(one, Iterable) and not isinstance(one, str):
        for value in one:
            yield from _pieces(value)
        yield b"end"
    elif isinstance(one, FunctionType):
        captured = [cell.cell_contents for cell in one.__closure__ or ()]
        yield from _pieces([one.__code__, captured, one.__defaults__, one.__kwdefaults__])
    elif isinstance(one, MethodType):
        yield from _pieces([one.__self__, one.__func__])
    elif isinstance(one, partial):
        yield from _pieces([one.func, one.args, one.keywords])
    elif isinstance(one, BuiltinFunctionType):
        yield from _pieces([one.__module__, one.__qualname__])
    elif isinstance(one, CodeType):
        yield from _pieces([one.co_code, one.co_names, one.co_consts])
    else:
        yield from _pieces([type(one).__qualname__, getattr(one, "__dict__", repr(one))])


def file_digests(study: Study) -> dict[str, str]:
    """SHA-256 of every file that a study names; of a folder or a pair, of all that belongs to it.

    Raises
    ------
    InputError
        If one of the files cannot be read.
    """
    return digests_of(_files(study))


def digests_of(files: Iterable[Path]) -> dict[str, str]:
    """SHA-256 of files by the names under which results tell of them.

    Raises
    ------
    InputError
        If one of the files cannot be read.
    """
    return {_name_of(file): _digest(file) for file in dict.fromkeys(files)}


def changes_since(study: Study, before: Mapping[str, str]) -> tuple[str, ...]:
    """What became of the files that decided a result, one sentence each; none if all are the same.

    Parameters
    ----------
    study
        Of which the files are looked at now.
    before
        The `file_digests` that the result carries.
    """
    changes = []
    now = {_name_of(file): file for file in dict.fromkeys(_files(study))}
    for name in dict.fromkeys((*before, *now)):
        there = name in now and now[name].exists()
        if not there and in_catalog(name):
            file = name.removeprefix(_CATALOG)
            if file != SOURCES:  # which is beside the table
                what = f"unknown {Path(file).stem!r}"
                changes.append(f"{what}; set {FOLDER_VARIABLE} to the folder of {file}")
        elif not there:
            changes.append(f"{name} is there no longer")
        elif name not in before:
            changes.append(f"{name} is there now and was not")
        elif _digest(now[name]) != before[name]:
            changes.append(f"{name} has changed since")
    return tuple(changes)


def file_stamps(study: Study) -> dict[str, tuple[int, int, int] | None]:
    """Dates and size of every file that a study names; a file is unchanged if its own are equal."""
    return {str(file): _stamp(file) for file in _files(study)}


def _stamp(file: Path) -> tuple[int, int, int] | None:
    try:
        found = file.stat()
    except (OSError, ValueError):
        return None
    return found.st_mtime_ns, found.st_ctime_ns, found.st_size


_CATALOG = "catalog://"  # no path has this name, for paths are written with single slashes


def in_catalog(name: str) -> bool:
    """Whether the name of a file in a result is in the user's catalog."""
    return name.startswith(_CATALOG)


def _name_of(file: Path) -> str:
    """A table of the user's catalog by its name, for that folder may lie anywhere."""
    return f"{_CATALOG}{file.name}" if file.parent == catalog_folder() else str(file)


def _files(study: Study) -> list[Path]:
    return [file for one in file_words(study) for file in files_of_word(one)]


def cube_files(path: Path) -> list[Path]:
    """The file of a cube and what belongs to it: header and data, all that a folder holds."""
    if path.is_dir():
        return sorted(p for p in path.rglob("*") if p.is_file())
    pair = [path]
    if path.suffix.lower() in ("", ".hdr", *DATA_SUFFIXES) and path.exists():
        pair = list(envi_pair(path) or pair)
    return pair


def _hash_of(study: Study, digests: Mapping[str, str]) -> str:
    data = study_as_json(study)
    for one in KEYS.values():
        if one.interface is not None and one.interface.later:
            *path, name = one.key.split(".")
            for part in _parts_at(data, path):
                if json.dumps(part[name]) == json.dumps(one.field.default):  # tuples are lists
                    del part[name]
    content = [__version__, data, dict(digests)]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _parts_at(data: Any, path: Sequence[str]) -> list[dict[str, Any]]:
    """The parts of a study with a path, whose steps ``*`` and ``0`` are all entries of a list."""
    parts = [data]
    for step in path:
        inside = [part if step in ("*", "0") else [part[step]] for part in parts]
        parts = [one for found in inside for one in found if one is not None]
    return parts


def _digest(file: Path) -> str:
    regular_file(file)
    with system_errors_of(file), file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()


def study_as_json(study: Study) -> dict[str, Any]:
    """The study as plain data, with all defaults."""
    return study.model_dump(mode="json", by_alias=True)


def provenance(study: Study) -> dict[str, Any]:
    """The provenance that every output records.

    Raises
    ------
    InputError
        If one of the files cannot be read.
    """
    digests = file_digests(study)
    return {
        "version": __version__,
        "study": study_as_json(study),
        "seed": study.seed,
        "files": digests,
        "hash": _hash_of(study, digests),
    }


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
        "blas_kernel": blas_kernel(),
        "cpu_features": built.get("SIMD Extensions", {}).get("found", []),
    }
