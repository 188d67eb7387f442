"""Report and card of the page's study, as files to be saved."""

import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import chdir, contextmanager
from pathlib import Path
from typing import Any, TypeVar

from chromanoise.base import InputError, from_above
from chromanoise.charts import Shown, shown
from chromanoise.imaging import Work
from chromanoise.study import Study, file_words, files_of_word
from chromanoise.web.page_questions import field
from chromanoise.web.page_studies import Studies, labeled, made_at
from chromanoise.web.report_of_study import sights_of, study_report
from chromanoise.web.uploads import Upload

T = TypeVar("T")


def report_reply(studies: Studies, question: Mapping[str, Any], folder: Path) -> tuple[str, str]:
    """The HTML of ``/api/report``: that of the copied study in a folder with its files.

    Parameters
    ----------
    question
        With the key ``study``.
    folder
        Empty folder for the files. The caller removes it, because this process may be stopped.

    Raises
    ------
    QuestionError
        With all faults of the study.
    """

    def report(of: Shown) -> str:
        work = Work(threads=1)
        return study_report(of, sights_of(of, work=work), work=work)

    return _made_in(studies, question, folder, report)


def card_reply(studies: Studies, question: Mapping[str, Any], folder: Path) -> tuple[bytes, str]:
    """The PDF of ``/api/card``, and the hash of the study.

    Parameters
    ----------
    question, folder
        As `report_reply`.

    Raises
    ------
    QuestionError
        With all faults of the study, or if it has more sensors than a card.
    """

    def card(of: Shown) -> bytes:
        return from_above("figures").card_of(of, work=Work(threads=1)).content("pdf")

    return _made_in(studies, question, folder, card)


def _made_in(
    studies: Studies, question: Mapping[str, Any], folder: Path, make: Callable[[Shown], T]
) -> tuple[T, str]:
    """A file of the copied study in a folder with its files, and the hash of the study."""
    study, used = studies.read(field(question, "study", dict, {}))
    points = studies.operating_points(study, used)  # faults have the keys of the page's controls

    def made() -> T:
        with _beside_files(study, used, folder):
            return make(shown(labeled(study, used), operating_points=points))

    return made_at("", used, made), studies.hash_of(study, used)


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
