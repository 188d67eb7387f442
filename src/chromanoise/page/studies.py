"""The study in a question: its words checked, its files found, its sensors made once."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from chromanoise._check import InputError
from chromanoise.exposure import Situation
from chromanoise.page.asked import QuestionError
from chromanoise.page.remembered import Remembered
from chromanoise.page.uploads import Upload, Uploads, in_path, in_words
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant, infrared_parts
from chromanoise.study.runs import Study, study_from_data
from chromanoise.study.runs.document import SensorPart
from chromanoise.study.runs.named import illuminant_of, sensor_of, situations_in
from chromanoise.study.words import is_file_name, sensor_files

T = TypeVar("T")

MOST_SENSORS = 8
MOST_MATRICES = 4
_SOURCE = "study"
_LONGEST_WORD = 500


class Studies:
    """Studies from questions, and what of them is asked for again and again.

    Parameters
    ----------
    uploads
        Files that a study may name by their id.
    files
        Names of files that it may name besides: those of the study that was served.
    """

    def __init__(self, uploads: Uploads, *, files: frozenset[str] = frozenset()) -> None:
        self._uploads, self._files = uploads, files
        self._lights: Remembered[Illuminant] = Remembered(32)
        self._sensors: Remembered[Sensor] = Remembered(128)

    def read(self, told: Mapping[str, Any]) -> tuple[Study, list[Upload]]:
        """The study, with paths in place of the ids of uploads, and those uploads.

        Raises
        ------
        QuestionError
            All faults of what it says, each with its key.
        """
        study = self.as_told(told)
        used: list[Upload] = []
        light = study.light.model_copy(
            update={
                "illuminant": self._word(
                    "light.illuminant", study.light.illuminant, used, light=True
                )
            }
        )
        sensors = []
        for i, part in enumerate(study.sensors):
            word = self._word(f"sensors.{i}.name", part.name, used)
            file = part.pixel.file
            if file is not None:
                file = self._file(f"sensors.{i}.pixel.file", file, used)
            pixel = part.pixel.model_copy(update={"file": file})
            sensors.append(part.model_copy(update={"name": word, "pixel": pixel}))
        return study.model_copy(update={"light": light, "sensors": tuple(sensors)}), used

    def as_told(self, told: Mapping[str, Any]) -> Study:
        """The study in the words of the question, bounded in what it asks.

        Raises
        ------
        QuestionError
            All faults of what it says, each with its key.
        """
        try:
            study = study_from_data(told, source=_SOURCE)
        except InputError as error:
            raise QuestionError(*map(_placed, str(error).splitlines())) from None
        if len(study.sensors) > MOST_SENSORS:
            raise QuestionError(
                ("sensors", f"the page shows {MOST_SENSORS} sensors at most; leave some away")
            )
        if len(study.matrices) > MOST_MATRICES:
            raise QuestionError(
                ("matrices", f"the page shows {MOST_MATRICES} matrices at most; leave some away")
            )
        return study

    def situations(self, study: Study, used: list[Upload]) -> list[Situation]:
        """Each sensor in its light with its exposure.

        Raises
        ------
        QuestionError
            If one of them cannot be made, each with its key.
        """
        lamp = study.light
        key = (lamp.model_dump_json(exclude={"level_lux"}), _stamp(lamp.illuminant))
        illuminant = _at(
            "light.illuminant",
            used,
            lambda: self._lights.of(key, lambda: _light_named(study, used)),
        )
        sensors = [
            _at(f"sensors.{i}.name", used, partial(self._sensor, part, used))
            for i, part in enumerate(study.sensors)
        ]
        return _at("exposure", used, lambda: situations_in(study, illuminant, sensors))

    def _sensor(self, part: SensorPart, used: list[Upload]) -> Sensor:
        key = (part.model_dump_json(), _stamp(part.name), _stamp(part.pixel.file or ""))
        return self._sensors.of(key, lambda: _sensor_named(part, used))

    def _word(self, where: str, word: str, used: list[Upload], *, light: bool = False) -> str:
        if len(word) > _LONGEST_WORD:
            raise QuestionError((where, f"no name has {len(word)} letters"))
        try:
            found = self._uploads.named(word)
        except QuestionError as error:
            raise QuestionError((where, str(error))) from None
        if found is not None:
            used.append(found)
            return in_path(word, found)
        if word not in self._files and _names_a_file(word, light=light):
            raise QuestionError((where, f"{word[:80]!r}: drop the file onto the page to use it"))
        return word

    def _file(self, where: str, word: str, used: list[Upload]) -> str:
        found = self._uploads.named(word)
        if found is None and word not in self._files:
            raise QuestionError((where, f"{word[:80]!r}: drop the file onto the page to use it"))
        return word if found is None else self._word(where, word, used)


def files_of(study: Study) -> frozenset[str]:
    """The words of a study that name files."""
    words = [(study.light.illuminant, True), *((part.name, False) for part in study.sensors)]
    named = [word for word, light in words if _names_a_file(word, light=light)]
    pixels = [part.pixel.file for part in study.sensors if part.pixel.file]
    return frozenset([*named, *pixels])


def _names_a_file(word: str, *, light: bool) -> bool:
    if not light:
        return sensor_files(word) == (Path(word),)
    parts = infrared_parts(word)
    return is_file_name(word if parts is None else parts[0])


def _light_named(study: Study, used: list[Upload]) -> Illuminant:
    lamp = illuminant_of(study)
    return replace(lamp, name=spoken(lamp.name, used))


def _sensor_named(part: SensorPart, used: list[Upload]) -> Sensor:
    sensor = sensor_of(part)
    notes = tuple(spoken(note, used) for note in sensor.notes)
    return replace(sensor, name=spoken(sensor.name, used), notes=notes)


def spoken(text: str, used: list[Upload]) -> str:
    """A text that speaks of uploads as their person calls them."""
    for upload in used:
        text = in_words(text, upload)
    return text


def _at(where: str, used: list[Upload], make: Callable[[], T]) -> T:
    try:
        return make()
    except InputError as error:
        raise QuestionError((where, spoken(str(error), used))) from None


def _placed(line: str) -> tuple[str, str]:
    """``study: sensors.0.name: is missing`` to where and sentence."""
    where, _, sentence = line.removeprefix(f"{_SOURCE}: ").partition(": ")
    return where, sentence


def _stamp(word: str) -> tuple[int, int] | None:
    """What tells that a file was written anew."""
    try:
        told = Path(word).stat()
    except (OSError, ValueError):
        return None
    return told.st_mtime_ns, told.st_size
