"""Compute the replies of ``/api/answer`` and ``/api/report``, and cache their parts."""

import json
import logging
import shutil
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import chdir, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from chromanoise.base import InputError, json_of
from chromanoise.charts import (
    DRAWINGS,
    PARTS,
    Look,
    Shown,
    as_data,
    card_of,
    chart_csv,
    drawing,
    shown,
)
from chromanoise.imaging import Work
from chromanoise.io import is_matrix_file
from chromanoise.noise import OperatingPoint
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant
from chromanoise.study import (
    Study,
    file_words,
    files_of_word,
    study_as_command,
    study_as_python,
    study_as_toml,
)
from chromanoise.web.page_studies import (
    Remembered,
    Stamps,
    Studies,
    labeled,
    made_at,
    spoken,
    stamps_of,
)
from chromanoise.web.report_of_study import sights_of, study_report
from chromanoise.web.requests import QuestionError, Upload, field, malformed, page_sentence

T = TypeVar("T")
_LOG = logging.getLogger("chromanoise.web")
_BESIDE = {"pictures", "title", "seed", "outputs"}  # no drawing depends on them
_OUTPUTS = {"clip", "reader"}  # but on these outputs
_LOOKS: Mapping[str, tuple[str, ...]] = {
    "budget": ("coordinate",),
    "ellipses": ("plane",),
    "levels": ("coordinate",),
    "vectors": ("magnification",),
}


def _words(study: Study, beside: set[str]) -> str:
    """What a drawing of a study depends on."""
    outputs = study.outputs.model_dump_json(include=_OUTPUTS)
    return study.model_dump_json(exclude=beside) + outputs


class ChartReplies:
    """Replies to requests, with caches of recent studies."""

    def __init__(self, studies: Studies) -> None:
        self._studies = studies
        self._shown: Remembered[Shown] = Remembered(16)
        self._parts: Remembered[str] = Remembered(512)

    def answer(self, question: Mapping[str, Any]) -> str:
        """The JSON of ``/api/answer``.

        Raises
        ------
        QuestionError
            With all faults of the question.
        """
        start = time.perf_counter()
        number, wanted = field(question, "number", int, 0), _wanted(question)
        look = look_of(field(question, "look", dict, {}))
        study, used = self._studies.read(field(question, "study", dict, {}))
        operating_points = self._studies.operating_points(study, used)
        hashed = self._studies.hash_of(study, used)
        asked = _Asked(
            study=study,
            operating_points=operating_points,
            look=look,
            nouns=tuple((one.sensor, one.illuminant) for one in operating_points),
            words=_words(study, _BESIDE | {"sweeps"}),
            stamps=stamps_of(study, "matrices."),
        )
        parts = ", ".join(f'"{part}": {self._part(part, asked, used)}' for part in wanted)
        head = {
            "number": number,
            "hash": hashed,
            "seconds": round(time.perf_counter() - start, 6),
            "files": {one.id: one.label for one in used},
        }
        return f'{json.dumps(head)[:-1]}, "parts": {{{parts}}}}}'

    def csv(self, question: Mapping[str, Any]) -> str:
        """The numbers behind one chart: the reply of ``/api/csv``.

        Raises
        ------
        QuestionError
            With all faults of the question, or why there is no such chart of this study.
        """
        part = field(question, "part", str, "")
        answer = self.answer({**question, "want": [part]})
        data = json_of(answer, "the answer")["parts"][part]
        text = "" if "fault" in data else chart_csv(part, data)
        if not text:
            raise QuestionError(("part", data.get("fault") or " ".join(data["notes"])))
        return text

    def texts(self, question: Mapping[str, Any]) -> dict[str, str]:
        """The JSON of ``/api/texts``: the study as TOML, Python and command line.

        Raises
        ------
        QuestionError
            With all faults of the study.
        """
        study = labeled(*self._studies.read(field(question, "study", dict, {})))
        makers = {"toml": study_as_toml, "python": study_as_python, "command": study_as_command}
        return {name: make(study) for name, make in makers.items()}

    def _part(self, part: str, asked: "_Asked", used: list[Upload]) -> str:
        study = asked.study
        looked = tuple(getattr(asked.look, name) for name in _LOOKS.get(part, ()))
        words = asked.words
        if part == "sensitivities":  # they do not depend on level and exposure
            words = ""
        elif part == "map":
            words = _words(study, _BESIDE)
        try:
            chart = self._parts.of(
                (part, looked, asked.nouns, words, asked.stamps), lambda: self._drawn(part, asked)
            )
            return spoken(chart, [replace(one, label=_as_json(one.label)) for one in used])
        except InputError as error:  # not remembered: sensitivities have the key of other studies
            sentence = spoken(page_sentence(error), used)
            if part in ("head", "numbers") and is_matrix_file(study.matrices[0]):
                raise QuestionError((error.setting or "matrices.0", sentence)) from None
            return json.dumps({"fault": sentence})
        except Exception:  # not cached: the next request may succeed
            _LOG.exception("the drawing %s failed", part)
            return json.dumps({"fault": f"{part} could not be computed for this study"})

    def _drawn(self, part: str, asked: "_Asked") -> str:
        study = asked.study
        seen = self._shown.of(
            (asked.words, asked.nouns, asked.stamps),
            lambda: shown(study, operating_points=asked.operating_points),
        )
        # of a study that differs in its sweeps, too
        chart = as_data(drawing(part, replace(seen, study=study), asked.look))
        return json.dumps(chart, allow_nan=False)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Asked:
    """The study of a request, and the keys of the caches, which all of its parts share."""

    study: Study
    operating_points: Sequence[OperatingPoint]
    look: Look
    nouns: tuple[tuple[Sensor, Illuminant], ...]
    words: str
    stamps: Stamps


def _as_json(text: str) -> str:
    """The text as it stands within a string of JSON."""
    return json.dumps(text)[1:-1]


def look_of(settings: Mapping[str, Any]) -> Look:
    """Parse the settings of the view; unknown keys are ignored.

    Raises
    ------
    QuestionError
        If a value is invalid.
    """
    magnification = settings.get("magnification")
    if magnification is not None and not _is_number(magnification):
        raise malformed("look.magnification", "magnification must be a JSON number or null")
    try:
        return Look(
            coordinate=field(settings, "coordinate", str, "Y"),
            plane=field(settings, "plane", str, "ab"),
            magnification=None if magnification is None else float(magnification),
        )
    except (InputError, OverflowError) as error:
        raise QuestionError(
            ("look", page_sentence(error) if isinstance(error, InputError) else str(error))
        ) from None


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _wanted(question: Mapping[str, Any]) -> list[str]:
    wanted = field(question, "want", list, list(PARTS))
    for part in wanted:
        if not isinstance(part, str) or part not in DRAWINGS:
            raise malformed(
                "want", f"unknown part {str(part)[:40]!r}; known are {', '.join(DRAWINGS)}"
            )
    return list(dict.fromkeys(wanted))


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
        return card_of(of, work=Work(threads=1)).content("pdf")

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
