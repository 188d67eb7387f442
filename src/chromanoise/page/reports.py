"""The report of a study, as ``chromanoise report`` writes it beside the uploaded files."""

import shutil
from collections.abc import Iterator, Mapping
from contextlib import chdir, contextmanager
from pathlib import Path
from typing import Any

from chromanoise.charts import shown
from chromanoise.errors import InputError
from chromanoise.imaging import Work
from chromanoise.page.requests import QuestionError, field, page_sentence
from chromanoise.page.studies import Studies, labeled, spoken
from chromanoise.page.uploads import Upload
from chromanoise.report import sights_of, study_report
from chromanoise.study import Study, study_as_toml
from chromanoise.study.assembly import unresolved
from chromanoise.study.hashes import file_words, files_of_word
from chromanoise.study.reading import document_from_text


def report_reply(studies: Studies, question: Mapping[str, Any], folder: Path) -> str:
    """The HTML of ``/api/report``: that of the copied study in a folder with its files.

    Parameters
    ----------
    studies
        Of the page.
    question
        With the key ``study``.
    folder
        Empty, for the files; whoever made it removes it, because this process may be stopped.

    Raises
    ------
    QuestionError
        With all faults of the study.
    """
    study, used = studies.read(field(question, "study", dict, {}))
    studies.operating_points(study, used)  # its faults have the keys of the page's controls
    try:
        with _beside_files(study, used, folder):
            text = study_as_toml(labeled(study, used))
            of = shown(document_from_text(Study, text, source="the study", unfit=unresolved))
            return study_report(of, sights_of(of, work=Work(threads=1)))
    except InputError as error:
        sentence = spoken(page_sentence(error), used)
        raise QuestionError((error.setting or "", sentence)) from None


@contextmanager
def _beside_files(study: Study, used: list[Upload], folder: Path) -> Iterator[None]:
    """Work in a folder with the files of a study, each under the name that the study gives."""
    files = [file for one in file_words(study) for file in files_of_word(one)]
    uploads = {one.path: Path(one.label) for one in used}
    names = {file: uploads.get(file, file) for file in files}
    # so deep that a name that begins with .. stays within
    depth = max((name.parts.count("..") for name in names.values()), default=0)
    there = folder.joinpath(*"d" * depth)
    there.mkdir(parents=True, exist_ok=True)
    for file, name in names.items():
        if not name.is_absolute():
            _link(there / name, file.absolute())
    with chdir(there):
        yield


def _link(link: Path, file: Path) -> None:
    link.parent.mkdir(parents=True, exist_ok=True)
    if link.exists():
        if link.samefile(file):  # two words name one file
            return
        remedy = "rename one of them"
        raise InputError(link.name, "must name one file", found="names two", remedy=remedy)
    try:
        link.symlink_to(file)
    except (OSError, NotImplementedError):
        shutil.copyfile(file, link)  # Windows allows links to some users only
