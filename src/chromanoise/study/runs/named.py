"""What a study names, as nouns: lights, sensors, exposures, pictures."""

from typing import Any

from chromanoise._check import InputError
from chromanoise.exposure import (
    EQUAL_TERMS,
    Exposure,
    Situation,
)
from chromanoise.scene import Cube, Scene, builtin_cube, flat_field, read_cube
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant
from chromanoise.spectra.files import Answers
from chromanoise.study.runs.document import PicturePart, Study
from chromanoise.study.words import illuminant_of_word, sensor_of_word


def situations_of(study: Study) -> list[Situation]:
    """Each sensor of the study in its light, with its exposure.

    Raises
    ------
    InputError
        If a name names nothing, a file cannot be read, or no light reaches a sensor.
    """
    illuminant = illuminant_of(study)
    white = flat_field(illuminant, level_lux=study.light.level_lux)
    sensors = [
        sensor_of_word(part.name, answers=Answers(beyond=part.beyond), **part.pixel.model_dump())
        for part in study.sensors
    ]
    return [
        Situation(
            sensor=sensor,
            exposure=exposure,
            illuminant=illuminant,
            level_lux=study.light.level_lux,
        )
        for sensor, exposure in zip(sensors, _exposures(study, white, sensors), strict=True)
    ]


def illuminant_of(study: Study) -> Illuminant:
    """The light of the study."""
    return illuminant_of_word(
        study.light.illuminant, answers=Answers(quantity="power", beyond=study.light.beyond)
    )


def cube_of(part: PicturePart) -> Cube:
    """The cube of a picture."""
    if part.cube.startswith("builtin:"):
        if part.scale is not None:
            raise InputError(f"{part.cube} says all of itself; leave scale away")
        return builtin_cube(part.cube)
    return read_cube(part.cube, scale=part.scale)


def _exposures(study: Study, white: Scene, sensors: list[Sensor]) -> list[Exposure]:
    asked = study.exposure
    lens: dict[str, Any] = {"f_number": asked.f_number, "magnification": asked.magnification}
    if asked.time_ms is not None:
        return [Exposure(time_s=1e-3 * asked.time_ms, **lens)] * len(sensors)
    return EQUAL_TERMS[asked.equal](white, sensors, share=asked.saturate, **lens)
