"""Compute the replies of ``/api/answer``, and cache their parts."""

import json
import logging
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from chromanoise.base import InputError, dataclass, json_of
from chromanoise.charts import DRAWINGS, PARTS, Look, Shown, as_data, chart_csv, drawing, shown
from chromanoise.io import is_matrix_file
from chromanoise.noise import OperatingPoint
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant
from chromanoise.study import Study, study_as_command, study_as_python, study_as_toml
from chromanoise.web.page_questions import QuestionError, field, malformed, page_sentence
from chromanoise.web.page_studies import Remembered, Stamps, Studies, labeled, spoken, stamps_of
from chromanoise.web.uploads import Upload

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
        if part in ("league", "sensitivities"):  # they do not depend on level and exposure
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


@dataclass(frozen=True, kw_only=True, eq=False)
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
