"""The files of a design: ``design.toml``, whose errors are reported together, each with file, line
and key; the folder with ``front.json``, ``front.csv``, ``front.svg`` and a file per sensor.
"""

import json
import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

from chromanoise import __version__
from chromanoise._files import claimed_folder, refuse_unwritable
from chromanoise._inputs import json_file
from chromanoise.catalog.resolve import word_beside
from chromanoise.design.document import ChannelPart, DesignStudy, FilterPart
from chromanoise.design.optimizing import impossible, searched, task_of
from chromanoise.design.result import SENSORS, Design
from chromanoise.design.scheduler import Scheduler
from chromanoise.design.search import Progress
from chromanoise.errors import InputError
from chromanoise.io.result import figures
from chromanoise.io.sensor_json import sensor_json
from chromanoise.io.table_formats import table_writer
from chromanoise.study import (
    NOTHING_GIVEN,
    Given,
    beside_file,
    document_from_text,
    document_text,
    is_relative_to_working_folder,
    study_as_json,
    unresolved,
)


def read_design(path: Path | str) -> DesignStudy:
    """The design in a TOML file.

    Parameters
    ----------
    path
        The file; file names in it are relative to its folder.

    Returns
    -------
    DesignStudy
        With file names relative to the working folder.

    Raises
    ------
    InputError
        If the file cannot be read; all errors in it, one line each, with file, line and key.
    """
    path = Path(path)

    def placed(document: DesignStudy) -> DesignStudy:
        return _with_files_beside(beside_file(document, path), path)

    def unfit(document: DesignStudy) -> list[InputError]:
        document = placed(document)
        return unresolved(document) or impossible(document)

    text = document_text(path, "design")
    return placed(document_from_text(DesignStudy, text, source=str(path), unfit=unfit))


def _with_files_beside(document: DesignStudy, path: Path) -> DesignStudy:
    """The document with files of lights and dyes relative to the working folder."""
    if is_relative_to_working_folder(path):
        return document
    folder = path.parent
    scenes = tuple(
        part.model_copy(update={"illuminant": word_beside(part.illuminant, "light", folder)})
        if part.illuminant is not None
        else part
        for part in document.design.scenes
    )
    channels = tuple(_with_curves_beside(part, folder) for part in document.design.channels)
    front = document.design.ir_cut
    ir_cut = None if front is None else _with_curves_beside(front, folder)
    changes = {"scenes": scenes, "channels": channels, "ir_cut": ir_cut}
    return document.model_copy(update={"design": document.design.model_copy(update=changes)})


FilteredPart = TypeVar("FilteredPart", FilterPart, ChannelPart)


def _with_curves_beside(part: FilteredPart, folder: Path) -> FilteredPart:
    changes: dict[str, Any] = {
        "curves": tuple(word_beside(word, "filter", folder) for word in part.curves)
    }
    if isinstance(part, ChannelPart) and part.ir_cut is not None:
        changes["ir_cut"] = _with_curves_beside(part.ir_cut, folder)
    return part.model_copy(update=changes)


RECORD, CHECKPOINT = "design.json", "search.npz"
_MOST_RECORD_BYTES = 64 << 20
FRONT_JSON, FRONT_CSV, FRONT_SVG = "front.json", "front.csv", "front.svg"
_MEMBER = re.compile(r"best-.+|knee|member-[0-9]+")


def optimized(
    document: DesignStudy,
    folder: Path | None,
    *,
    resume: bool = False,
    given: Given = NOTHING_GIVEN,
    evaluate_on: Scheduler | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Design:
    """Search the front of a design, and write it into a folder.

    Parameters
    ----------
    document
        The design.
    folder
        For the outputs and the checkpoint of the search; ``None`` writes nothing.
    resume
        Whether to continue the stopped search in the folder.
    given, evaluate_on, progress
        As `searched`.

    Raises
    ------
    InputError
        As `searched`, or if the folder cannot be written or holds another design.
    """
    if folder is None:
        if resume:
            raise InputError("resume", "must be given with the folder of the stopped search")
        found = searched(task_of(document, given), evaluate_on=evaluate_on, progress=progress)
        return Design(search=found)
    refuse_unwritable(folder)
    task = task_of(document, given)
    _refuse_other_design(folder, task.identity)
    if resume and not (folder / CHECKPOINT).exists():
        raise InputError(
            str(folder),
            "must hold a stopped search to resume",
            found=f"has no {CHECKPOINT}",
            remedy="omit resume",
        )
    with claimed_folder(folder, "optimize") as claimed:
        claimed.refuse_taken([FRONT_JSON, FRONT_CSV, FRONT_SVG, *_members_in(folder)])
        if not (folder / RECORD).exists():
            record = {
                "version": __version__,
                "identity": task.identity,
                "design": study_as_json(document),
            }
            with claimed.scratch() as scratch:
                text = f"{json.dumps(record, indent=1)}\n"
                (scratch / RECORD).write_text(text, encoding="utf-8")
        claimed.keep(CHECKPOINT, adopted=resume)
        found = searched(
            task,
            checkpoint=folder / CHECKPOINT,
            resume=resume,
            evaluate_on=evaluate_on,
            progress=progress,
        )
        design = Design(search=found)
        with claimed.scratch(outdated=f"{SENSORS}/*.json") as scratch:
            _write_design(design, scratch)
    return design


def _write_design(design: Design, folder: Path) -> None:
    (folder / SENSORS).mkdir()
    for one in design.members:
        text = sensor_json(one.sensor)
        (folder / SENSORS / f"{one.name}.json").write_text(text, encoding="utf-8")
    csv = table_writer(Path(FRONT_CSV))(design.to_table())
    (folder / FRONT_CSV).write_text(csv, encoding="utf-8")
    drawn = {Path(FRONT_SVG).stem: figures().front_figure(design.to_file())}
    figures().write_figures(drawn, folder, endings=("svg",))
    (folder / FRONT_JSON).write_text(design.to_file().as_json(), encoding="utf-8")


def _members_in(folder: Path) -> list[str]:
    """Files of the folder with names that a member of a front may have."""
    files = (folder / SENSORS).glob("*.json")
    return [f"{SENSORS}/{file.name}" for file in files if _MEMBER.fullmatch(file.stem)]


def _refuse_other_design(folder: Path, identity: str) -> None:
    file = folder / RECORD
    before = None
    if file.exists():
        with suppress(InputError):
            record = json_file(file, most_bytes=_MOST_RECORD_BYTES)
            before = record.get("identity") if isinstance(record, dict) else None
    elif not (folder / FRONT_JSON).exists():
        return
    if before != identity:
        raise InputError(
            str(folder),
            "must not hold another design",
            value=str(folder),
            found="holds results of another design, another version or other files",
            remedy=("choose another folder", "remove it"),
        )
