"""Read a design from TOML; all errors are reported at once, each with file, line and key."""

from pathlib import Path
from typing import Any, TypeVar

from chromanoise.catalog.resolve import word_beside
from chromanoise.design.document import ChannelPart, DesignStudy, FilterPart
from chromanoise.design.optimizing import impossible
from chromanoise.errors import InputError
from chromanoise.study import (
    beside_file,
    document_from_text,
    document_text,
    is_relative_to_working_folder,
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
