"""What a study names, as nouns: lights, sensors, exposures, pictures."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from chromanoise._check import within
from chromanoise.analysis.color_matrices import METHODS, matrix_makers
from chromanoise.catalog.pixel_files import sensor_with_pixel
from chromanoise.catalog.resolve import behind_filter_of_word, file_of, illuminant_of_word
from chromanoise.errors import InputError
from chromanoise.exposure import EQUAL_TERMS, Exposure, Situation
from chromanoise.io.cubes import read_cube
from chromanoise.io.spectra import Answers
from chromanoise.scene import Cube, Scene, builtin_cube, flat_field
from chromanoise.sensor import Sensor, behind_ir_cut, mosaic_named, with_shifted_curves
from chromanoise.spectra import Illuminant
from chromanoise.study.document import PicturePart, SensorPart, Study

Key = tuple[str | int, ...]
"""Where a value of a study stands: ("sensors", 0, "name")."""


def situations_of(study: Study) -> list[Situation]:
    """Each sensor of the study in its light, with its exposure.

    Raises
    ------
    InputError
        If a name names nothing, a file cannot be read, or no light reaches a sensor.
    """
    sensors = [sensor_of(part) for part in study.sensors]
    return told_apart(situations_in(study, illuminant_of(study), sensors))


def told_apart(situations: Sequence[Situation]) -> list[Situation]:
    """Sensors of one name get a number: a sensor is often compared with a changed self.

    ``cam``, ``cam`` become ``cam`` and ``cam (2)``; a number that is a name already is passed over.
    """
    names = [one.sensor.name for one in situations]
    told: list[Situation] = []
    for i, (one, name) in enumerate(zip(situations, names, strict=True)):
        taken = {before.sensor.name for before in told}
        taken |= {later for later in names[i + 1 :] if later != name}
        count = 1
        while name in taken:
            count += 1
            name = f"{names[i]} ({count})"
        told.append(one if count == 1 else replace(one, sensor=replace(one.sensor, name=name)))
    return told


def twins(study: Study) -> list[tuple[Key, str]]:
    """The sensors that stand there a second time with nothing changed, each with its key and why.

    A page shows them, for one of them is about to be changed; a run would compute all of it twice.
    """
    return [
        (("sensors", i, "name"), f"{part.name!r} stands twice; change one or leave it away")
        for i, part in enumerate(study.sensors)
        if part in study.sensors[:i]
    ]


def situations_in(
    study: Study, illuminant: Illuminant, sensors: Sequence[Sensor]
) -> list[Situation]:
    """Sensors in a light, on the terms of the study.

    Parameters
    ----------
    study
        Of which the exposure and the light level are looked at.
    illuminant, sensors
        What it names.

    Raises
    ------
    InputError
        If no light reaches a sensor.
    """
    white = flat_field(illuminant, level_lux=study.light.level_lux)
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
    """The light of the study.

    Raises
    ------
    InputError
        If its name names nothing, or a file cannot be read.
    """
    return illuminant_of_word(study.light.illuminant, answers=light_answers_of(study))


def light_answers_of(study: Study) -> Answers:
    """What the study says of the file of its light, where the file cannot tell."""
    light = study.light
    return Answers(
        quantity="power",
        per=light.per,
        beyond=light.beyond,
        columns=() if light.column is None else (light.column,),
        wavelength_unit=light.wavelength_unit,
        negatives=light.negatives,
    )


def sensor_of(part: SensorPart) -> Sensor:
    """A sensor of the study: shifted first, then behind its filter and the added IR-cut.

    Raises
    ------
    InputError
        If its name names nothing, or a file cannot be read.
    """
    shared: dict[str, Any] = {"beyond": part.beyond, "negatives": part.negatives}
    answers = Answers(**shared, **part.answers.model_dump())
    sensor = sensor_with_pixel(part.name, answers=answers, **part.pixel.model_dump())
    sensor = with_shifted_curves(sensor, part.shift_nm)
    if part.filter is not None:
        answers = Answers(**shared, wavelength_unit=part.filter_wavelength_unit)
        sensor = behind_filter_of_word(sensor, part.filter, answers=answers)
    return sensor if part.ircut_nm is None else behind_ir_cut(sensor, part.ircut_nm)


_OPTIONS = {
    "(--beyond, for an illuminant --illuminant-beyond)": '(beyond = "zero" or "hold")',
    "--illuminant-energy or --illuminant-photons": 'per = "energy" or "photon"',
    "--illuminant-column": "column",
    "--illuminant-beyond": "beyond",
    "--energy or --photons": 'answers.per = "energy" or "photon"',
    "--absolute or --relative": 'answers.level = "absolute" or "relative"',
    "--absolute": 'answers.level = "absolute"',
    "--fraction or --percent": 'answers.scale = "fraction" or "percent"',
    "--percent": 'answers.scale = "percent"',
    " (for a filter --filter-wavelength-unit, for an illuminant --illuminant-wavelength-unit)": (
        " (filter_wavelength_unit for a filter, light.wavelength_unit for the illuminant)"
    ),
    "--wavelength-unit": "answers.wavelength_unit",
    "--negatives zero": 'negatives = "zero"',
    "--peak-qe": "answers.peak_qe",
    "--beyond": "beyond",
}
"""How a study answers what a command answers with an option; the longer ones first."""


def unmade(study: Study) -> list[tuple[Key, str]]:
    """What a study names and cannot be made, each with its key and why."""
    found: list[tuple[Key, str]] = []

    def tried(key: Key, make: Callable[[], Any]) -> Any:
        try:
            return make()
        except InputError as error:
            found.append((key, _in_words_of_a_study(str(error), str(key[0]))))
            return None

    tried(("light", "illuminant"), partial(illuminant_of, study))
    level = study.light.level_lux
    tried(("light", "level_lux"), lambda: within("level_lux", "lx", level, *_LUX))
    sensors = [
        tried(("sensors", i, "name"), partial(sensor_of, part))
        for i, part in enumerate(study.sensors)
    ]
    found += twins(study)
    for i, name in enumerate(study.matrices):
        if name.partition("=")[0].strip() in METHODS:  # others are refused elsewhere, as unknown
            tried(("matrices", i), partial(matrix_makers, [name], "quanta"))
    for i, picture in enumerate(study.pictures):
        if picture.mosaic not in (None, "sensor"):
            tried(("pictures", i, "mosaic"), partial(_fitting_mosaic, picture, sensors))
    return found


_LUX = (1e-15, 1e15)


def _fitting_mosaic(part: PicturePart, sensors: Sequence[Sensor | None]) -> None:
    own = {channel for row in mosaic_named(str(part.mosaic)).pattern for channel in row}
    for sensor in sensors:
        idle = [name for name in sensor.names if name not in own] if sensor else []
        strange = sorted(own - set(sensor.names)) if sensor else []
        if sensor and (strange or (idle and not part.raw_only)):
            what = f"{sensor.name} lacks its channel {', '.join(strange)}"
            if not strange:
                what = f"channel {', '.join(idle)} of {sensor.name} sits over no pixel of it"
            raise InputError(f"{what}; it has {', '.join(sorted(own))}")


def _in_words_of_a_study(told: str, part: str) -> str:
    for option, key in _OPTIONS.items():
        told = told.replace(
            option, f"light.{key}" if part == "light" and "light" not in key else key
        )
    return told.replace("light.(", "(light.")


_CURES = ("key", "shape", "wavelengths", "scale")


def cube_of(part: PicturePart) -> Cube:
    """The cube of which a part of a study takes pictures.

    Raises
    ------
    InputError
        If a built-in name names nothing or is told what it says itself, or a file cannot be read.
    """
    if part.cube.startswith("builtin:"):
        cures = [name for name in _CURES if getattr(part, name) is not None]
        if cures:
            raise InputError(f"{part.cube} says all of itself; leave {' and '.join(cures)} away")
        return builtin_cube(part.cube)
    how = {name: getattr(part, name) for name in _CURES}
    if isinstance(part.wavelengths, str):
        how["wavelengths"] = file_of(part.wavelengths)
    return read_cube(file_of(part.cube), **how)


def _exposures(study: Study, white: Scene, sensors: Sequence[Sensor]) -> list[Exposure]:
    asked = study.exposure
    lens: dict[str, Any] = {"f_number": asked.f_number, "magnification": asked.magnification}
    if asked.time_ms is not None:
        return [Exposure(time_s=1e-3 * asked.time_ms, **lens)] * len(sensors)
    return EQUAL_TERMS[asked.equal](white, sensors, share=asked.saturate, **lens)
