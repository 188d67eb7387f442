"""A word or a file name to a sensor or a light: what a person writes, in a study or a command."""

from dataclasses import replace
from pathlib import Path

from chromanoise._check import InputError, one_of
from chromanoise.sensor import (
    KNOWN_SENSORS,
    PAPER_PIXEL,
    Sensor,
    read_sensor,
    sensor_from_table,
    sensor_named,
)
from chromanoise.spectra import (
    DEFAULT_GRID,
    Illuminant,
    illuminant_from,
    illuminant_named,
    infrared_parts,
    mixed,
)
from chromanoise.spectra.files import ASK, Answers, power_of, read_curves
from chromanoise.spectra.tables.folder import SOURCES, user_curves
from chromanoise.study.catalog import (
    catalog_file_of,
    catalog_folder,
    own_power,
    own_table,
    own_tables,
)

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
        A name of the catalogue, the user's own folder included, or a file: its ending or a
        folder in it tells it from a name.
    answers
        To what the file or the catalogue's table cannot tell.
    pitch_um, full_well_e, read_noise_e
        Instead of the sensor's own; the paper's pixel stands in where a file has none.

    Raises
    ------
    InputError
        If nothing is called that, the file cannot be read, or the pixel cannot be.
    """
    changes = {"pitch_um": pitch_um, "full_well_e": full_well_e, "read_noise_e": read_noise_e}
    given = {key: value for key, value in changes.items() if value is not None}
    if not _is_file(word):
        return _catalogue_sensor(word, answers, given)
    sensor = read_sensor(Path(word), DEFAULT_GRID, PAPER_PIXEL, answers=answers)
    missing = [key for key in changes if key not in given]
    if missing:
        note = f"the paper's pixel stands in for {', '.join(missing)} of {sensor.name}"
        sensor = replace(sensor, notes=(*sensor.notes, note))
    return replace(sensor, pixel=replace(sensor.pixel, **given))


def illuminant_of_word(word: str, *, answers: Answers = ASK) -> Illuminant:
    """An illuminant by name, of the user's own folder or from a file of one curve.

    Each may have an infrared diode beside it, as ``A+0.5xLED850`` or ``lamp.csv+1xLED940/50``.

    Raises
    ------
    InputError
        If nothing is called that, or the file cannot be read.
    """
    return mixed(word, lambda base: _light(base, answers))


def sensor_files(word: str) -> tuple[Path, ...]:
    """The files whose content decides what a sensor's word means; none if it is built in.

    Of a table of the user's folder also its SOURCES.toml, which tells pixel and level.

    Raises
    ------
    InputError
        If the user's folder cannot be understood.
    """
    return (Path(word),) if _is_file(word) else _own_files(word)


def illuminant_files(word: str) -> tuple[Path, ...]:
    """The same for the word of a light, with or without an infrared diode beside it.

    Raises
    ------
    InputError
        If the user's folder cannot be understood.
    """
    parts = infrared_parts(word)
    if parts is not None:
        return illuminant_files(parts[0])
    return (Path(word),) if is_file_name(word) else _own_files(word)


def is_file_name(word: str) -> bool:
    """A file is named by its ending or its folder, so that no file hides a name of ours."""
    return word.lower().endswith(_ENDINGS) or word.startswith((".", "/", "~"))


def _own_files(name: str) -> tuple[Path, ...]:
    table = catalog_file_of(name)
    return () if table is None else (table, table.with_name(SOURCES))


def _is_file(word: str) -> bool:
    """Or, of a sensor, by being there, where nothing of the catalogue has that name."""
    if is_file_name(word):
        return True
    known = word in KNOWN_SENSORS or word in own_tables(catalog_folder())
    return not known and Path(word).is_file()


def _light(word: str, answers: Answers) -> Illuminant:
    if is_file_name(word):
        curve = power_of(read_curves(word, answers=answers))
        return illuminant_from(curve, DEFAULT_GRID, name=Path(word).stem, beyond=answers.beyond)
    own = own_table(word, "illuminant")
    if own is not None:
        return illuminant_from(own_power(own), DEFAULT_GRID, name=word, beyond=answers.beyond)
    return illuminant_named(word, DEFAULT_GRID, beyond=answers.beyond)


def _catalogue_sensor(word: str, answers: Answers, pixel: dict[str, float]) -> Sensor:
    own = own_table(word, "sensor")
    if own is not None:
        curves = user_curves(own)
        return sensor_from_table(own.provenance, curves, DEFAULT_GRID, answers=answers, pixel=pixel)
    tables = own_tables(catalog_folder())
    known = [name for name, table in tables.items() if table.provenance.kind == "sensor"]
    try:
        one_of("sensor", word, (*KNOWN_SENSORS, *known))
    except InputError as error:
        raise InputError(f"{error}; or name a file of curves (wavelength_nm,R,G,...)") from None
    return sensor_named(word, DEFAULT_GRID, answers=answers, pixel=pixel)
