"""A word or a file name to a sensor or a light: what a person writes, in a study or a command."""

from dataclasses import replace
from pathlib import Path

from chromanoise._check import InputError
from chromanoise.sensor import PAPER_PIXEL, SENSOR_NAMES, Sensor, read_sensor, sensor_named
from chromanoise.spectra import DEFAULT_GRID, Illuminant, illuminant_from, illuminant_named
from chromanoise.spectra.files import ASK, Answers, power_of, read_curves

_ENDINGS = (".csv", ".tsv", ".txt", ".mat", ".json", ".sp", ".spdx", ".xml", ".xlsx")


def sensor_of_word(
    word: str,
    *,
    answers: Answers = ASK,
    pitch_um: float | None = None,
    full_well_e: float | None = None,
    read_noise_e: float | None = None,
) -> Sensor:
    """A catalogue sensor or a file of curves, with what is asked of its pixel.

    Parameters
    ----------
    word
        A name of the catalogue, or a file: its ending or a folder in it tells it from a name.
    answers
        To what the file cannot tell.
    pitch_um, full_well_e, read_noise_e
        Instead of the sensor's own; the paper's pixel stands in where a file has none.

    Raises
    ------
    InputError
        If nothing is called that, the file cannot be read, or the pixel cannot be.
    """
    changes = {"pitch_um": pitch_um, "full_well_e": full_well_e, "read_noise_e": read_noise_e}
    given = {key: value for key, value in changes.items() if value is not None}
    if is_file_name(word) or (word not in SENSOR_NAMES and Path(word).is_file()):
        sensor = read_sensor(Path(word), DEFAULT_GRID, PAPER_PIXEL, answers=answers)
        missing = [key for key in changes if key not in given]
        if missing:
            note = f"the paper's pixel stands in for {', '.join(missing)} of {sensor.name}"
            sensor = replace(sensor, notes=(*sensor.notes, note))
    else:
        sensor = _catalogue_sensor(word)
    return replace(sensor, pixel=replace(sensor.pixel, **given))


def illuminant_of_word(word: str, *, answers: Answers = ASK) -> Illuminant:
    """An illuminant by name or from a file of one curve.

    Raises
    ------
    InputError
        If nothing is called that, or the file cannot be read.
    """
    if not is_file_name(word):
        return illuminant_named(word, DEFAULT_GRID, beyond=answers.beyond)
    curve = power_of(read_curves(word, answers=answers))
    return illuminant_from(curve, DEFAULT_GRID, name=Path(word).stem, beyond=answers.beyond)


def is_file_name(word: str) -> bool:
    """A file is named by its ending or its folder, so that no file hides a name of ours."""
    return word.lower().endswith(_ENDINGS) or word.startswith((".", "/", "~"))


def _catalogue_sensor(word: str) -> Sensor:
    try:
        return sensor_named(word, DEFAULT_GRID)
    except InputError as error:
        raise InputError(f"{error}; or name a file of curves (wavelength_nm,R,G,...)") from None
