"""The study in a request: its checks and files, and bounded caches of sensors and matrices."""

import os
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, Generic, TypeVar

from chromanoise.base import InputError, errors_in, regular_file
from chromanoise.noise import OperatingPoint
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant, infrared_parts
from chromanoise.study import (
    FileWord,
    Study,
    digests_of,
    file_of,
    file_words,
    files_of_word,
    idle_settings,
    illuminant_of,
    is_file_word,
    operating_points_in,
    sensor_of,
    study_as_json,
    study_from_data,
    study_hash,
    unresolved,
    with_file_words,
    without_idle_settings,
)
from chromanoise.web.page_questions import (
    MOST_ENTRIES,
    QuestionError,
    page_sentence,
    refuse_long_lists,
)
from chromanoise.web.uploads import Kept, Upload, in_path, in_words

T = TypeVar("T")


class Remembered(Generic[T]):
    """A cache that drops the least recently used values."""

    def __init__(self, most: int) -> None:
        self._entry = lru_cache(most)(lambda key: list[T]())

    def of(self, key: Hashable, make: Callable[[], T]) -> T:
        """The value of a key, computed if it is missing; two threads may both compute it."""
        entry = self._entry(key)
        if not entry:
            entry.append(make())
        return entry[0]


Stamps = tuple[tuple[str, tuple[int, int] | None], ...]

N = TypeVar("N", Sensor, Illuminant)

MOST_SENSORS = 10
MOST_MATRICES = 4
_MOST = {
    "sensors": MOST_SENSORS,
    "matrices": MOST_MATRICES,
    "sweeps": MOST_ENTRIES,
    "pictures": MOST_ENTRIES,
}
_LONGEST_WORD = 500


class Studies:
    """Parse studies from requests, with caches of their parts.

    Parameters
    ----------
    uploads
        Files that a study may name by their id.
    files
        Names of files that it may name besides: those of the study that was served.
    """

    def __init__(self, uploads: Kept, *, files: frozenset[str] = frozenset()) -> None:
        self._uploads, self._files = uploads, files
        self._lights: Remembered[Illuminant] = Remembered(32)
        self._sensors: Remembered[Sensor] = Remembered(128)
        self._idle: Remembered[list[InputError]] = Remembered(32)
        self._digests: Remembered[dict[str, str]] = Remembered(128)

    def read(self, data: Mapping[str, Any]) -> tuple[Study, list[Upload]]:
        """The study, with paths in place of the ids of uploads, and those uploads.

        Raises
        ------
        QuestionError
            All faults of what it says, each with its key.
        """
        used: list[Upload] = []
        faults: list[tuple[str, str]] = []

        def found(one: FileWord) -> str:
            try:
                return self.word(one, used)
            except QuestionError as error:
                faults.extend(error.faults)
                return one.word

        study = with_file_words(self.study_as_given(data), found)
        if faults:
            raise QuestionError(*faults)
        return study, used

    def study_as_given(self, data: Mapping[str, Any]) -> Study:
        """The study as given in the request, with its size checked.

        Raises
        ------
        QuestionError
            All faults of what it says, each with its key.
        """
        try:
            refuse_too_many(data)
            refuse_long_lists(data)
            return study_from_data(data, source="", keep_idle=True)
        except InputError as error:
            raise QuestionError(
                *((e.setting, page_sentence(e)) for e in errors_in(error))
            ) from None

    def operating_points(self, study: Study, used: list[Upload]) -> list[OperatingPoint]:
        """Each sensor in its light with its exposure.

        Raises
        ------
        QuestionError
            If one of them cannot be made, each with its key.
        """
        self._refuse_idle(study, used)
        illuminant = made_at("light.illuminant", used, lambda: self._light(study, used))
        sensors = [self._sensor(study, i, used) for i in range(len(study.sensors))]
        return made_at("exposure", used, lambda: operating_points_in(study, illuminant, sensors))

    def complaints(self, data: Mapping[str, Any]) -> list[str]:
        """All errors of a study on this page, each with its key; empty if there are none.

        Parameters
        ----------
        data
            A study as plain data.
        """
        try:
            study, used = self.read(data)
            found = [(e.setting, spoken(page_sentence(e), used)) for e in unresolved(study)]
            if not found:
                self.operating_points(study, used)
        except QuestionError as error:
            found = list(error.faults)
        return [f"{where}: {sentence}" for where, sentence in found]

    def hash_of(self, study: Study, used: list[Upload]) -> str:
        """The hash of a run of the study in a folder with the uploaded files.

        Raises
        ------
        QuestionError
            If one of its files cannot be read, with its key.
        """
        digests: dict[str, str] = {}
        for one in file_words(study):
            digests |= made_at(one.where, used, partial(self._digests_of, one))
        return study_hash(
            labeled(study, used), {spoken(name, used): digest for name, digest in digests.items()}
        )

    def word(self, one: FileWord, used: list[Upload]) -> str:
        """Replace the id of an upload in a word by its path, and add the upload to ``used``.

        Raises
        ------
        QuestionError
            If it names a file that is neither an upload nor of the study that was served.
        """
        if len(one.word) > _LONGEST_WORD:
            raise QuestionError((one.where, f"no name has {len(one.word)} letters"))
        base = made_at(one.where, used, partial(_without_diodes, one))
        try:
            found = self._uploads.named(base)
        except QuestionError as error:
            raise QuestionError((one.where, str(error))) from None
        if found is not None and found.id == base:
            return in_path(one.word, _noted(found, used))
        if base not in self._files and _names_a_file(one, base):
            message = f"{one.word[:80]!r}: drop the file onto the page to use it"
            raise QuestionError((one.where, message))
        made_at(one.where, used, partial(_refuse_irregular, one))
        return one.word

    def _digests_of(self, one: FileWord) -> dict[str, str]:
        files = files_of_word(one)
        return self._digests.of(_stamps(files), lambda: digests_of(files))

    def _refuse_idle(self, study: Study, used: list[Upload]) -> None:
        """Refuse settings without effect; files are looked into once for each state of them."""
        try:
            stamps = stamps_of(study, "sensors.")
            words = study.model_dump_json(include={"sensors", "sweeps"})
            light = study.light.model_dump_json(exclude={"level_lux"})
            idle = self._idle.of((words, light, stamps), lambda: idle_settings(study))
        except InputError:
            return  # what cannot be read is refused where it is made
        if idle:
            raise QuestionError(*((e.setting, spoken(page_sentence(e), used)) for e in idle))

    def _light(self, study: Study, used: list[Upload]) -> Illuminant:
        words = study.light.model_dump_json(exclude={"level_lux"})
        key = (words, stamps_of(study, "light."), _labels(used))
        return self._lights.of(key, lambda: _named(illuminant_of(study), used))

    def _sensor(self, study: Study, i: int, used: list[Upload]) -> Sensor:
        part = study.sensors[i]
        place = f"sensors.{i}."
        stamps = made_at(f"{place}name", used, partial(stamps_of, study, place))
        key = (part.model_dump_json(), stamps, _labels(used))
        try:
            return self._sensors.of(key, lambda: _named(sensor_of(part), used))
        except InputError as error:
            where = error.setting.replace("sensors.0.", place, 1) or f"{place}name"
            raise QuestionError((where, spoken(page_sentence(error), used))) from None


def refuse_too_many(data: Mapping[str, Any]) -> None:
    """Refuse a study with more parts than the page can show.

    Parameters
    ----------
    data
        A study as plain data.

    Raises
    ------
    InputError
        If it has too many entries of one kind.
    """
    for key, most in _MOST.items():
        count = len(data[key]) if isinstance(data.get(key), list | tuple) else 0
        if count > most:
            raise InputError(
                key,
                f"must have at most {most} entries on the page",
                value=count,
                found=f"has {count}",
                remedy="remove some",
                setting=key,
            )


def served_data(study: Study) -> dict[str, Any]:
    """The initial study of the page as plain data, including parts that the page does not show.

    Raises
    ------
    InputError
        If it is more than the page shows.
    """
    data = study_as_json(study)
    refuse_too_many(data)
    return data


def labeled(study: Study, used: list[Upload]) -> Study:
    """The study as it is run: with the names of dropped files, without settings without effect."""
    return without_idle_settings(with_file_words(study, lambda one: spoken(one.word, used)))


def files_of(study: Study) -> frozenset[str]:
    """The words of a study that name files, lights without the diodes beside them."""
    named = [(one, _without_diodes(one)) for one in file_words(study)]
    return frozenset(base for one, base in named if _names_a_file(one, base))


def stamps_of(study: Study, place: str) -> Stamps:
    """What tells that a file was written anew, of all that a part of the study names.

    Parameters
    ----------
    study
        With paths in place of ids.
    place
        With which the keys of that part begin.

    Raises
    ------
    InputError
        If a word cannot be understood.
    """
    words = [one for one in file_words(study) if one.where.startswith(place)]
    return _stamps([file for one in words for file in files_of_word(one)])


def _stamps(files: Iterable[Path]) -> Stamps:
    states = [(str(file), _state(file)) for file in files]
    return tuple((name, state and (state.st_mtime_ns, state.st_size)) for name, state in states)


def _state(file: Path) -> os.stat_result | None:
    try:
        return file.stat()
    except (OSError, ValueError):
        return None


def _without_diodes(one: FileWord) -> str:
    base = one.word
    while one.kind == "light" and (parts := infrared_parts(base)) is not None:
        base = parts[0]
    return base


def _names_a_file(one: FileWord, base: str) -> bool:
    if one.kind == "cube":
        return not base.startswith("builtin:")
    if one.kind in ("sensor", "light", "filter", "observer"):
        return is_file_word(base, one.kind)
    return True


def _refuse_irregular(one: FileWord) -> None:
    """Refuse pipes and devices; a folder is accepted only for a cube."""
    is_cube = one.kind == "cube"
    for file in [file_of(one.word)] if is_cube else files_of_word(one):
        if _state(file) is not None:
            regular_file(file, folder=is_cube)


def _noted(found: Upload, used: list[Upload]) -> Upload:
    """Put among the used; of two files with one label, the later gets a number."""
    for one in used:
        if one.id == found.id:
            return one
    label, count = Path(found.label), 1
    while found.label in _labels(used):
        count += 1
        found = replace(found, label=f"{label.stem} ({count}){label.suffix}")
    used.append(found)
    return found


def _labels(used: list[Upload]) -> tuple[str, ...]:
    return tuple(one.label for one in used)


def _named(noun: N, used: list[Upload]) -> N:
    notes = tuple(spoken(note, used) for note in noun.notes)
    return replace(noun, name=spoken(noun.name, used), notes=notes)


def spoken(text: str, used: list[Upload]) -> str:
    """Replace the paths of uploads in a text by their original names."""
    for upload in used:
        text = in_words(text, upload)
    return text


def made_at(where: str, used: list[Upload], make: Callable[[], T]) -> T:
    """What ``make`` makes; an error as that of a question, at its own key or else at ``where``.

    Raises
    ------
    QuestionError
        If it cannot be made.
    """
    try:
        return make()
    except InputError as error:
        raise QuestionError((error.setting or where, spoken(page_sentence(error), used))) from None
