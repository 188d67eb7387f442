"""A run on disk: one file per step, existing results of the same study, and comparison of runs.

The outputs of two runs of one study agree in all bytes, or up to the largest relative difference of
their numbers.
"""

import filecmp
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import chdir, nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import (
    Array,
    InputError,
    RecordError,
    __version__,
    claimed_folder,
    content_hash,
    dataclass,
    digest_of,
    json_file,
    json_text,
    refuse_unwritable,
    true_path,
)
from chromanoise.imaging import Work
from chromanoise.io.spectra import named
from chromanoise.study.hashes import (
    changes_since,
    file_stamps,
    in_catalog,
    numerics,
    provenance,
    study_as_json,
    study_hash,
)
from chromanoise.study.running import Progress, Step, no_progress, run_plan
from chromanoise.study.schema import KEEP_IDLE, Study

STUDY_FILE, SUMMARY_FILE = "study.json", "summary.json"
_LARGEST_BYTES = 256 << 20

Report = Callable[[str, bool], None]
"""Called for each step with its description and whether its result already exists."""


@dataclass(frozen=True, kw_only=True)
class RecordedRun:
    """The run that made an output.

    Attributes
    ----------
    study
        With file names relative to ``place``.
    place
        Folder of its files now: the working folder of the run, or where that was moved to.
    folder
        Folder of the results.
    """

    study: Study
    place: Path
    folder: Path


def answer_of(result: Mapping[str, Any]) -> list[str]:
    """The first sentence of a result of `run_study` as plain data; empty if it has no sentences."""
    sentences: list[str] = (result.get("verdict") or result).get("sentences", [])
    return sentences[:1]


def run_study(
    study: Study,
    folder: Path,
    *,
    work: Work | None = None,
    planned: Callable[[Sequence[Step]], object] = len,
    report: Report | None = None,
    progress: Progress = no_progress,
    collect: Callable[[dict[str, Any]], object] | None = None,
    place: Path | None = None,
) -> list[Path]:
    """Run all steps of a study; a stopped run continues with the missing results.

    After an error the folder is as it was before; see ``claimed_folder``.

    Parameters
    ----------
    folder
        Output folder: ``study.json`` and one JSON file per step, and the pictures.
    work
        Threads and tiles for rendering pictures.
    planned
        Called with all steps before any is computed; it may refuse them.
    report
        Called for each step.
    progress
        Called for each step, to report its finished parts.
    collect
        Called with the result of each step as plain data, also of steps that were done before.
    place
        The folder to which the file names are relative; it is the working folder of this process
        while the study runs. The current working folder if ``None``.

    Returns
    -------
    files
        One per step.

    Raises
    ------
    InputError
        If something cannot be computed, the folder cannot be written or holds another study, a file
        changes while it is read, or a result in the folder was changed.
    """
    refuse_unwritable(folder)
    results = folder.absolute()
    with (
        claimed_folder(folder, "run") as claimed,
        nullcontext() if place is None else chdir(place),
    ):
        stamps = file_stamps(study)
        who = provenance(study) | {"numerics": numerics()}
        _refuse_other_study(results, study, who, folder)
        steps = run_plan(study, work=work).steps
        planned(steps)
        made = {step.name: _made_by(results / f"{step.name}.json", who["hash"]) for step in steps}
        for step in steps:
            if not made[step.name]:
                file = f"{step.name}.json"
                claimed.refuse_taken([file, *_pictures_of(results / file)])
        if not (results / STUDY_FILE).exists():
            with claimed.scratch() as scratch:
                names = {"steps": [step.name for step in steps]}
                _write(scratch / STUDY_FILE, who | _place_record(who["files"], results) | names)
        for step in steps:
            if report:
                report(step.what, made[step.name])
            if not made[step.name]:
                with claimed.scratch() as scratch, progress(step) as advance:
                    result = step.run(scratch, advance)
                    _refuse_change_in_work(study, stamps, who["files"])
                    document: dict[str, Any] = {
                        "step": step.name,
                        "written": _written(scratch),
                        "result": result.to_dict(),
                    }
                    _write(scratch / f"{step.name}.json", who | document)
            elif collect:
                document = read_record(results / f"{step.name}.json")
            if collect:
                collect(document["result"])
    return [folder / f"{step.name}.json" for step in steps]


def study_of_output(path: Path) -> Study:
    """The study recorded in an output or in its folder.

    Parameters
    ----------
    path
        An output, or its folder.

    Raises
    ------
    InputError
        As `recorded_run`.
    """
    return recorded_run(path).study


def recorded_run(path: Path) -> RecordedRun:
    """The run that made an output, or the folder of one.

    Parameters
    ----------
    path
        A file that `run_study` wrote, or its folder. The files of the study are searched in the
        recorded folder, in the parent folders of the output, and in the working folder, and
        identified by their content.

    Raises
    ------
    InputError
        If it is not an output of a run, was changed, or is of another version of chromanoise, or
        if files of its study have changed or are not found.
    """
    file = path / STUDY_FILE if path.is_dir() else path
    if (path / SUMMARY_FILE).exists() and not file.exists():
        raise InputError(
            str(path),
            "must hold results of `chromanoise run`",
            value=str(path),
            found="holds those of another command, which cannot be rerun",
            remedy="give that command again",
        )
    if file.suffix.lower() == ".toml":
        raise InputError(
            str(file),
            "must be an output of a run",
            found="is a study",
            remedy=f"use `chromanoise run {file}`",
        )
    record = read_record(file)
    if "study" not in record or "hash" not in record:
        raise InputError(
            str(file),
            "must be an output of `chromanoise run`",
            found="holds no study and hash",
            remedy="name an output, or its folder",
        )
    try:
        study = Study.model_validate(record["study"], context=KEEP_IDLE)
    except RecordError:
        raise InputError(
            str(file),
            "must be a study of this version of chromanoise",
            where="key 'study'",
            value=record.get("version"),
            found="is not",
            remedy="run the study again",
        ) from None
    place = _place_of(file, record, study)
    try:
        with chdir(place):
            now = study_hash(study)
    except InputError as error:
        raise named(error, str(file)) from None
    if now != record["hash"]:
        raise InputError(
            str(file),
            "must come from this version of chromanoise and be unchanged",
            value=record.get("version"),
            found=f"comes from version {record.get('version')!r}, or was changed",
            remedy="run its study again",
        )
    _refuse_altered(file, record)
    return RecordedRun(study=study, place=place, folder=file.parent)


def output_files(folder: Path) -> tuple[str, ...]:
    """Names of all files of a complete run: its record, and each result with its pictures.

    Raises
    ------
    InputError
        If one of them cannot be read, or is not of a run.
    """
    names = [STUDY_FILE]
    try:
        for step in read_record(folder / STUDY_FILE)["steps"]:
            names += [f"{step}.json", *read_record(folder / f"{step}.json")["written"]]
    except (KeyError, TypeError):
        raise InputError(str(folder), "must hold the files of a run", found="does not") from None
    return tuple(names)


def _place_record(files: Iterable[str], folder: Path) -> dict[str, str]:
    """Path from the results folder to the folder to which file names are relative, if any are.

    If the two folders have only the root in common, this path would contain all folder names from
    the root to the project, so no path is recorded.
    """
    here, results = true_path(Path()), true_path(folder)
    try:
        apart = os.path.commonpath([here, results]) == here.anchor != str(here)
    except ValueError:  # on two drives
        apart = True
    if apart or not _relative(files):
        return {}
    return {"place": Path(os.path.relpath(here, results)).as_posix()}


def place_of_files(folder: Path, record: Mapping[str, Any]) -> Path | None:
    """The folder to which the file names of a run are relative; ``None`` if it is not recorded.

    Parameters
    ----------
    folder
        Folder of the results.
    record
        The content of its ``study.json``. Version 0.2 wrote an absolute path.
    """
    if "place" not in record:
        return None
    return Path(os.path.normpath(true_path(folder) / str(record["place"])))


def _relative(files: Iterable[str]) -> bool:
    return any(not Path(name).is_absolute() and not in_catalog(name) for name in files)


def _place_of(file: Path, record: dict[str, Any], study: Study) -> Path:
    """The folder relative to which the study's files have the recorded content."""
    here, before = Path.cwd(), record.get("files")
    if not isinstance(before, dict):
        return here
    if not _relative(before):
        places = [here]
    else:
        own = file.parent / STUDY_FILE
        beside = record if file.name == STUDY_FILE else record_if_readable(own)
        recorded = place_of_files(true_path(file).parent, beside)
        places = [recorded or here, *true_path(file).parents, here]
    faults = []
    for place in dict.fromkeys(places):
        try:
            with chdir(place):
                changed = changes_since(study, before)
        except InputError as error:
            raise named(error, str(file)) from None
        except (OSError, ValueError):  # the folder does not exist
            continue
        if not changed:
            return place
        faults.append(changed)
    raise _changed(file, min(faults, key=len))


def _refuse_other_study(folder: Path, study: Study, who: dict[str, Any], called: Path) -> None:
    file = folder / STUDY_FILE
    if not file.exists():
        return
    record = read_record(file)
    before = record.get("files")
    same = all(record.get(key) == who[key] for key in ("version", "study"))
    if same and isinstance(before, dict) and before != who["files"]:
        changed = changes_since(study, before)
        if changed:
            raise _changed(called, changed)
    if record.get("hash") != who["hash"]:
        raise _other_results(called)
    _refuse_altered(called / STUDY_FILE, record)


def refuse_other_pictures(study: Study, folder: Path) -> None:
    """Raise an error if a folder holds pictures of another study.

    Parameters
    ----------
    study
        Of the pictures to be written.
    folder
        Their folder, with the ``summary.json`` of earlier ones if there are any.

    Raises
    ------
    InputError
        If the record of the earlier pictures has another study or version, or none.
    """
    refuse_other_record(folder, {"version": __version__, "study": study_as_json(study)})


def refuse_other_record(folder: Path, wanted: Mapping[str, Any]) -> None:
    """Raise an error if the ``summary.json`` of a folder does not have these entries.

    Parameters
    ----------
    folder
        With or without earlier results.
    wanted
        Entries of their summary.

    Raises
    ------
    InputError
        If an entry is missing or another one.
    """
    file = folder / SUMMARY_FILE
    if not file.exists():
        return
    record = read_record(file)
    if any(record.get(key) != wanted[key] for key in wanted):
        raise _other_results(folder)


def _other_results(folder: Path) -> InputError:
    return InputError(
        str(folder),
        "must not hold other results",
        value=str(folder),
        found="holds results of another study",
        remedy=("choose another folder", "remove it"),
    )


def _changed(place: Path, changed: Sequence[str]) -> InputError:
    """The error that names the changed files, which a hash of the study could not."""
    return InputError(
        str(place),
        "must match the current input files",
        value=tuple(changed),
        found="; ".join(changed[:8]),
        remedy=("restore the files", "run the study again into another folder"),
    )


def _refuse_altered(file: Path, record: dict[str, Any]) -> None:
    if record.get("content") != content_hash(record):
        raise InputError(
            str(file),
            "must be as the run wrote it",
            value=record.get("content"),
            found="was changed since, as its content hash shows",
            remedy=("restore it", "run the study again into another folder"),
        )


def _refuse_change_in_work(study: Study, stamps: Any, before: Mapping[str, str]) -> None:
    """Refuse a result if a file changed while it was read: it may mix two states of the file."""
    if file_stamps(study) == stamps:
        return
    changed = [sentence.removesuffix(" since") for sentence in changes_since(study, before)]
    if changed:
        raise InputError(
            "the files of the study",
            "must not change while it runs",
            value=tuple(changed),
            found=f"{'; '.join(changed[:8])}, so the result was discarded",
            remedy="run the study again when no program writes to its files",
        )


def _made_by(file: Path, hash_: str) -> bool:
    """Whether a file is a result of the study of this hash, with all its pictures as written."""
    record = record_if_readable(file)
    if record.get("hash") != hash_ or record.get("content") != content_hash(record):
        return False
    written = record.get("written")
    if not isinstance(record.get("result"), dict) or not isinstance(written, dict):
        return False
    return all(
        digest_of(file.parent / name, linked=True) == digest for name, digest in written.items()
    )


def _pictures_of(file: Path) -> list[str]:
    """The other output files of the step of a result file; none if the file does not exist."""
    record = read_record(file) if file.exists() else {}
    written = record.get("written")
    return list(written) if isinstance(written, dict) else []


def _written(folder: Path) -> dict[str, str | None]:
    """The files that a step wrote, each with the SHA-256 by which a later run knows it again."""
    return {file.name: digest_of(file) for file in sorted(folder.iterdir())}


def read_record(file: Path) -> dict[str, Any]:
    """The object in a JSON file that a run wrote; empty if it holds another kind of data.

    Parameters
    ----------
    file
        Of a step, or ``study.json``.

    Raises
    ------
    InputError
        If it cannot be read, is too large, or holds no JSON.
    """
    data = json_file(file, most_bytes=_LARGEST_BYTES)
    return data if isinstance(data, dict) else {}


def record_if_readable(file: Path) -> dict[str, Any]:
    """The same; empty if the file cannot be read."""
    try:
        return read_record(file)
    except InputError:
        return {}


def _write(file: Path, record: dict[str, Any]) -> None:
    record = record | {"content": content_hash(record)}
    file.write_text(json_text(record, indent=1, ensure_ascii=True), encoding="utf-8")


ROUNDING = 1e-9
"""Largest relative difference of an analysis expected from other BLAS kernels."""


@dataclass(frozen=True, kw_only=True)
class Agreement:
    """Agreement of a second run with the first.

    Attributes
    ----------
    files
        Number of files that the second run wrote.
    other_bytes
        Names of files whose results differ in the first run, or that it lacks. JSON files that
        differ only in place, machine and their own hash are not among them.
    place
        The folder in which the first run looked for its files, if it is another; else empty.
    relocated
        Whether the two records have different relative paths to that folder.
    numerics
        Names of the entries on machine and libraries that differ.
    largest
        Largest relative difference of two numbers, ``|a - b| / max(|a|, |b|)``. [1]
    where
        File and place of that number; empty if no number differs.
    incomparable
        Files and places where something other than a number differs.
    """

    files: int
    other_bytes: tuple[str, ...]
    place: str
    relocated: bool
    numerics: tuple[str, ...]
    largest: float
    where: str
    incomparable: tuple[str, ...]

    @property
    def agrees(self) -> bool:
        """Whether all numbers agree to the rounding of other processors and libraries."""
        return not self.incomparable and self.largest <= ROUNDING


def agreement_of(first: Path, second: Path) -> Agreement:
    """Agreement of the files of a complete second run with those of the same names in the first.

    Parameters
    ----------
    first, second
        The folders of the runs. The record of a run is compared by its bytes, a result by its
        numbers, a picture by its pixel values.

    Raises
    ------
    InputError
        If the second run is incomplete.
    """
    names = output_files(second)
    other, place, relocated, numerics = [], "", False, set[str]()
    for name in names:
        if _same_bytes(first / name, second / name):
            continue
        one, its = (
            record_if_readable(folder / name) if name.endswith(".json") else {}
            for folder in (first, second)
        )
        if not one or _results(one) != _results(its):
            other.append(name)
        if one.get("place") != its.get("place"):
            relocated = True
            earlier = place_of_files(first, one)
            place = "" if earlier == place_of_files(second, its) else str(earlier or "")
        before, now = map(_numerics, (one, its))
        if before:  # an unreadable record has none
            numerics |= {key for key in before | now if before.get(key) != now.get(key)}
    largest, where, incomparable = 0.0, "", []
    for name in other:
        if name == STUDY_FILE:
            continue
        try:
            found = list(_differences(first / name, second / name))
        except (OSError, ValueError, KeyError):  # missing, or not a file that a run wrote
            found = [(np.inf, "")]
        for difference, at in found:
            if not np.isfinite(difference):
                incomparable.append(f"{name} {at}".strip())
            elif difference > largest:
                largest, where = difference, f"{name} {at}".strip()
    return Agreement(
        files=len(names),
        other_bytes=tuple(other),
        place=place,
        relocated=relocated,
        numerics=tuple(sorted(numerics)),
        largest=largest,
        where=where,
        incomparable=tuple(incomparable),
    )


def agreement_text(found: Agreement) -> str:
    """The agreement in one sentence."""
    parts = []
    if found.place:
        parts.append(f"the original was made with files in {found.place}")
    if found.numerics:
        parts.append(f"machine or libraries of the original differ: {', '.join(found.numerics)}")
    if not found.other_bytes:
        what = "the same results" if parts or found.relocated else "the same bytes"
        return "; ".join([f"all {found.files} files have {what} as the original", *parts])
    parts.insert(0, f"{len(found.other_bytes)} of {found.files} files differ from the original")
    if found.incomparable:
        more = f" and {len(found.incomparable) - 3} more" if len(found.incomparable) > 3 else ""
        parts.append(f"not comparable: {', '.join(found.incomparable[:3])}{more}")
    if found.where:
        size = "within" if found.largest <= ROUNDING else "above"
        parts.append(
            f"the largest relative difference of a number is {found.largest:.1e}, at {found.where}"
            f" ({size} the {ROUNDING:g} expected from other processors and libraries)"
        )
    elif not found.incomparable:
        parts.append("all numbers are equal")
    return "; ".join(parts)


def _same_bytes(first: Path, second: Path) -> bool:
    try:
        return filecmp.cmp(first, second, shallow=False)
    except OSError:
        return False


def _numerics(record: dict[str, Any]) -> dict[str, Any]:
    found = record.get("numerics")
    return found if isinstance(found, dict) else {}


def _results(record: dict[str, Any]) -> dict[str, Any]:
    """All but what depends on place and machine, and the hash of all."""
    return {key: record[key] for key in record.keys() - {"place", "numerics", "content"}}


def _differences(first: Path, second: Path) -> Iterator[tuple[float, str]]:
    if second.suffix == ".json":
        one, other = (record_if_readable(path)["result"] for path in (first, second))
        yield from _of_data(one, other, "")
    elif second.suffix in (".tiff", ".dng", ".png"):
        yield _of_pixels(_pixels(first), _pixels(second)), ""
    else:
        yield np.inf, ""


def _of_data(one: Any, other: Any, place: str) -> Iterator[tuple[float, str]]:
    if isinstance(one, dict) and isinstance(other, dict) and one.keys() == other.keys():
        for key in one:
            yield from _of_data(one[key], other[key], f"{place}/{key}")
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for i, (each, its) in enumerate(zip(one, other, strict=True)):
            yield from _of_data(each, its, f"{place}/{i}")
    elif one != other:
        numbers = all(type(value) in (int, float) for value in (one, other))
        yield (abs(one - other) / max(abs(one), abs(other)) if numbers else np.inf), place


def _pixels(path: Path) -> Array:
    if path.suffix == ".png":
        from PIL import Image

        with Image.open(path) as image:
            return np.asarray(image, dtype=np.float64)
    import tifffile

    return np.asarray(tifffile.imread(path), dtype=np.float64)


def _of_pixels(one: Array, other: Array) -> float:
    if one.shape != other.shape:
        return float(np.inf)
    most = np.maximum(np.abs(one), np.abs(other))
    return float(np.max(np.abs(one - other) / np.where(most > 0, most, 1.0), initial=0.0))
