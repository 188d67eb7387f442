"""A run on disk: one file per step, written whole; what is there of the same study is kept."""

import hashlib
import json
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from chromanoise import __version__
from chromanoise._check import InputError
from chromanoise._files import refuse_unwritable, whole_folder
from chromanoise._inputs import regular_file
from chromanoise.imaging import Work
from chromanoise.spectra.files.own_json import named
from chromanoise.study.runs.document import Study
from chromanoise.study.runs.hashes import changes_since, provenance, study_as_json, study_hash
from chromanoise.study.runs.running import Advance, Step, study_steps

STUDY_FILE = "study.json"
_LARGEST_BYTES = 256 << 20

Told = Callable[[str, bool], None]
"""Is told of each step: what it is, and whether it stood there already."""


Progress = Callable[[Step], AbstractContextManager[Advance]]
"""While a step runs: a function to call with the number of its parts that are finished."""


def run_study(
    study: Study,
    folder: Path,
    *,
    work: Work | None = None,
    told: Told | None = None,
    progress: Progress = lambda _: nullcontext(lambda _: None),
) -> list[Path]:
    """Run all of a study; a run that was stopped goes on where it was.

    Parameters
    ----------
    study
        Of `read_study`.
    folder
        Of the results: ``study.json`` and one JSON file per step, and the pictures.
    work
        Who renders pictures.
    told
        Is told of each step.
    progress
        Is told how far each step is.

    Returns
    -------
    files
        One per step.

    Raises
    ------
    InputError
        If something cannot be computed, or the folder not written, or it holds another study.
    """
    refuse_unwritable(folder)
    _refuse_other_study(folder, study)
    steps = study_steps(study, work=work)
    who = provenance(study)
    if not (folder / STUDY_FILE).exists():
        with whole_folder(folder) as scratch:
            _write(scratch / STUDY_FILE, who | {"steps": [step.name for step in steps]})
    files = []
    for step in steps:
        file = folder / f"{step.name}.json"
        done = _made_by(file, who["hash"])
        if told:
            altered = file.exists() and not done
            told(step.what + ("; its file was changed or is cut short" if altered else ""), done)
        if not done:
            with whole_folder(folder) as scratch, progress(step) as advance:
                result = step.run(scratch, advance)
                told_of = {"step": step.name, "written": _written(scratch), "result": result}
                whole = who | told_of
                _write(scratch / file.name, whole | {"content": _content(whole)})
        files.append(file)
    return files


def study_of_output(path: Path) -> Study:
    """The study that an output carries, or the folder of one.

    Raises
    ------
    InputError
        If it is no output of a run, or of another version of chromanoise.
    """
    file = path / STUDY_FILE if path.is_dir() else path
    if file.suffix.lower() == ".toml":
        raise InputError(f"{file}: is a study; use `chromanoise run {file}`")
    told = _read(file)
    if not isinstance(told, dict) or "study" not in told or "hash" not in told:
        raise InputError(f"{file}: is no output of `chromanoise run`; name one, or its folder")
    try:
        study = Study.model_validate_json(json.dumps(told["study"]))
    except ValidationError:
        raise InputError(
            f"{file}: what it says of its study is no study of this version; run the study anew"
        ) from None
    _refuse_changed_files(file, told, study)
    try:
        now = study_hash(study)
    except InputError as error:
        raise named(error, str(file)) from None
    if now != told["hash"]:
        raise InputError(
            f"{file}: was made by version {told.get('version')!r} of chromanoise or was changed "
            "since, so the same digits cannot be promised; run its study anew"
        )
    return study


def _refuse_other_study(folder: Path, study: Study) -> None:
    file = folder / STUDY_FILE
    if not file.exists():
        return
    told = _read(file)
    same = isinstance(told, dict) and told.get("study") == study_as_json(study)
    if same and told.get("version") == __version__:
        _refuse_changed_files(folder, told, study)
    if not isinstance(told, dict) or told.get("hash") != study_hash(study):
        raise InputError(
            f"{folder}: holds the results of another study or version; name another folder with "
            "--out, or remove it"
        )


def _refuse_changed_files(place: Path, told: dict[str, Any], study: Study) -> None:
    """Say which of the files, before a hash says only that something is another."""
    before = told.get("files")
    if not isinstance(before, dict):
        return
    try:
        changed = changes_since(study, before)
    except InputError as error:
        raise named(error, str(place)) from None
    if changed:
        raise InputError(
            f"{place}: {'; '.join(changed[:8])}, so the same digits cannot be promised; bring it "
            "back, or run the study anew into another folder"
        )


def _content(told: dict[str, Any]) -> str:
    """SHA-256 of all that a file says but this."""
    rest = {key: value for key, value in told.items() if key != "content"}
    return hashlib.sha256(json.dumps(rest, allow_nan=False).encode()).hexdigest()


def _made_by(file: Path, hash_: str) -> bool:
    if not file.exists():
        return False
    try:
        told = _read(file)
        if not isinstance(told, dict) or told.get("hash") != hash_:
            return False
        if told.get("content") != _content(told):
            return False
    except (InputError, ValueError):  # no JSON any longer, or not a number in it
        return False
    written = told.get("written")
    if not isinstance(told.get("result"), dict) or not isinstance(written, dict):
        return False
    return all(_sha256(file.parent / name) == digest for name, digest in written.items())


def _written(folder: Path) -> dict[str, str | None]:
    """The files that a step wrote, each with the SHA-256 by which a later run knows it again."""
    return {file.name: _sha256(file) for file in sorted(folder.iterdir())}


def _sha256(file: Path) -> str | None:
    """``None`` of what cannot be read."""
    try:
        with file.open("rb") as opened:
            return hashlib.file_digest(opened, "sha256").hexdigest()
    except (OSError, ValueError):
        return None


def _read(file: Path) -> Any:
    if regular_file(file).st_size > _LARGEST_BYTES:
        raise InputError(f"{file}: is too large for an output of a study")
    try:
        return json.loads(file.read_bytes())
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{file}: no JSON ({error})") from None


def _write(file: Path, told: dict[str, Any]) -> None:
    file.write_text(json.dumps(told, indent=1, allow_nan=False) + "\n", encoding="utf-8")
