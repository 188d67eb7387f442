"""The report of a study, as ``chromanoise report`` writes it beside the uploaded files."""

import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import chdir, contextmanager, suppress
from pathlib import Path
from typing import Any

from chromanoise.charts import shown
from chromanoise.errors import InputError
from chromanoise.imaging import Work
from chromanoise.page.requests import QuestionError, field, page_sentence
from chromanoise.page.studies import Studies, labeled, spoken
from chromanoise.page.uploads import Upload
from chromanoise.report import sights_of, study_report
from chromanoise.study import Study
from chromanoise.study.hashes import file_words, files_of_word

_DEEP = 8  # folders above the working folder, for names that begin with ``..``


def report_reply(studies: Studies, question: Mapping[str, Any]) -> str:
    """The HTML of ``/api/report``: that of the copied study in a folder with its files.

    Parameters
    ----------
    studies
        Of the page.
    question
        With the key ``study``.

    Raises
    ------
    QuestionError
        With all faults of the study.
    """
    study, used = studies.read(field(question, "study", dict, {}))
    points = studies.operating_points(study, used)  # faults have the keys of the page's controls
    with _beside_files(study, used):
        try:
            of = shown(labeled(study, used), operating_points=points)
            return study_report(of, sights_of(of, work=Work(threads=1)))
        except InputError as error:
            sentence = spoken(page_sentence(error), used)
            raise QuestionError((error.setting or "", sentence)) from None


@contextmanager
def _beside_files(study: Study, used: list[Upload]) -> Iterator[None]:
    """Work in a folder with the files of a study, each under the name that the study gives."""
    files = [file for one in file_words(study) for file in files_of_word(one)]
    uploads = {one.path: Path(one.label) for one in used}
    with tempfile.TemporaryDirectory(prefix="chromanoise-") as top:
        folder = Path(top).joinpath(*"d" * _DEEP)
        folder.mkdir(parents=True)
        for file in files:
            name = uploads.get(file, file)
            if not name.is_absolute():
                _linked(folder / name, file.absolute())
        with chdir(folder):
            yield


def _linked(link: Path, file: Path) -> None:
    link.parent.mkdir(parents=True, exist_ok=True)
    with suppress(FileExistsError):  # of two words that name one file
        try:
            link.symlink_to(file)
        except (OSError, NotImplementedError) as error:
            if isinstance(error, FileExistsError):
                raise
            shutil.copyfile(file, link)  # Windows allows links to some users only
