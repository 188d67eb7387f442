"""What decides all digits of a study: its words, the version, and what stands in its files."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from chromanoise import __version__
from chromanoise._check import InputError
from chromanoise.scene.envi import DATA_SUFFIXES, envi_pair
from chromanoise.study.catalog import catalog_folder
from chromanoise.study.runs.document import Study
from chromanoise.study.words import file_of, filter_files, illuminant_files, sensor_files


def study_hash(study: Study) -> str:
    """SHA-256 of the version, the study, and what stands in the files that it names.

    Raises
    ------
    InputError
        If one of the files cannot be read.
    """
    return _hash_of(study, file_digests(study))


def file_digests(study: Study) -> dict[str, str]:
    """SHA-256 of every file that a study names; of a folder or a pair, of all that belongs to it.

    Raises
    ------
    InputError
        If one of the files cannot be read.
    """
    return {_told(file): _digest(file) for file in dict.fromkeys(_files(study))}


def changes_since(study: Study, before: Mapping[str, str]) -> tuple[str, ...]:
    """What became of the files that decided a result, one sentence each; none if all are the same.

    Parameters
    ----------
    study
        Of which the files are looked at now.
    before
        The `file_digests` that the result carries.
    """
    told = []
    now = {_told(file): file for file in dict.fromkeys(_files(study))}
    for name in dict.fromkeys((*before, *now)):
        there = name in now and now[name].exists()
        if not there and name.startswith("catalog/"):
            entry = Path(name).stem
            told.append(
                f"unknown {entry!r}; set CHROMANOISE_CATALOG to the folder of {name[8:]}"
                if entry != "SOURCES"
                else ""
            )
        elif not there:
            told.append(f"{name} is there no longer")
        elif name not in before:
            told.append(f"{name} is there now and was not")
        elif _digest(now[name]) != before[name]:
            told.append(f"{name} has changed since")
    return tuple(sentence for sentence in told if sentence)


def _told(file: Path) -> str:
    """A table of the user's catalogue by its name, for that folder may lie anywhere."""
    return f"catalog/{file.name}" if file.parent == catalog_folder() else str(file)


def _files(study: Study) -> list[Path]:
    try:
        files = list(illuminant_files(study.light.illuminant))
        for sensor in study.sensors:
            files += sensor_files(sensor.name)
            files += filter_files(sensor.filter) if sensor.filter else []
            files += [file_of(sensor.pixel.file)] if sensor.pixel.file else []
        for picture in study.pictures:
            if not picture.cube.startswith("builtin:"):
                files += cube_files(file_of(picture.cube))
    except OSError as error:  # a name that is too long to ask for
        told = str(error.filename)[:60]
        raise InputError(f"{told}: cannot be read ({error.strerror})") from None
    return files


def cube_files(path: Path) -> list[Path]:
    """The file of a cube and what belongs to it: header and data, all that a folder holds."""
    if path.is_dir():
        return sorted(p for p in path.rglob("*") if p.is_file())
    pair = [path]
    if path.suffix.lower() in ("", ".hdr", *DATA_SUFFIXES) and path.exists():
        pair = list(envi_pair(path) or pair)
    return pair


def _hash_of(study: Study, digests: dict[str, str]) -> str:
    told = [__version__, study_as_json(study), digests]
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def _digest(file: Path) -> str:
    try:
        with file.open("rb") as opened:
            return hashlib.file_digest(opened, "sha256").hexdigest()
    except (OSError, ValueError) as error:  # a name with a null byte is a ValueError
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{str(file)[:200]}: cannot be read ({reason})") from None


def study_as_json(study: Study) -> dict[str, Any]:
    """The study as plain data, all defaults said."""
    return study.model_dump(mode="json", by_alias=True)


def provenance(study: Study) -> dict[str, Any]:
    """What every output carries: who made it of what.

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
