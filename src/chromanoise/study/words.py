"""A word or a file name to a sensor or a light: what a person writes, in a study or a command."""

from dataclasses import replace
from pathlib import Path

from chromanoise._check import InputError, one_of
from chromanoise.sensor import (
    KNOWN_SENSORS,
    PAPER_PIXEL,
    Sensor,
    behind_filter,
    filter_named,
    read_sensor,
    sensor_from_table,
    sensor_named,
)
from chromanoise.spectra import (
    DEFAULT_GRID,
    SMALL_NEGATIVES,
    Illuminant,
    Spectra,
    illuminant_from,
    illuminant_named,
    infrared_parts,
    means_on_grid,
    mixed,
    refuse_outside,
    used_on_grid,
)
from chromanoise.spectra.files import ASK, Answers, power_of, read_curves
from chromanoise.spectra.tables.folder import SOURCES, user_curves
from chromanoise.study.catalog import (
    catalog_entry,
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
        A name of the catalogue, the user's own folder included, or a file (`is_sensor_file`).
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
    if not is_sensor_file(word):
        return _catalogue_sensor(word, answers, given)
    sensor = read_sensor(file_of(word), DEFAULT_GRID, PAPER_PIXEL, answers=answers)
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
    return (file_of(word),) if is_sensor_file(word) else _own_files(word)


def illuminant_files(word: str) -> tuple[Path, ...]:
    """The files whose content decides what a light's word means; none if it is built in.

    An infrared diode beside the light adds none.

    Raises
    ------
    InputError
        If the user's folder cannot be understood.
    """
    parts = infrared_parts(word)
    if parts is not None:
        return illuminant_files(parts[0])
    return (file_of(word),) if is_file_name(word) else _own_files(word)


def filter_files(word: str) -> tuple[Path, ...]:
    """The files whose content decides what a filter's word means; none if it is built in.

    Raises
    ------
    InputError
        If the user's folder cannot be understood.
    """
    return (file_of(word),) if is_file_name(word) else _own_files(word)


def filter_of_word(word: str, *, answers: Answers = ASK) -> Spectra:
    """The transmittance of a filter by name, of the user's own folder or from a file of one curve.

    Raises
    ------
    InputError
        If nothing is called that, the file cannot be read or holds several curves, it ends short
        of 400-1050 nm and ``answers.beyond`` refuses, or a transmittance lies outside 0 .. 1.
    """
    own = None if is_file_name(word) else own_table(word, "filter")
    if own is not None:
        told = own.provenance
        curve = replace(user_curves(own), source=word, notes=(told.source,))
    elif is_file_name(word):
        read = read_curves(file_of(word), answers=replace(answers, quantity="transmittance"))
        curve = replace(read.curves, notes=(*read.curves.notes, *read.notes, *read.defects))
    else:
        tables = own_tables(catalog_folder())
        own_names = [name for name, table in tables.items() if table.provenance.kind == "filter"]
        return filter_named(word, DEFAULT_GRID, beyond=answers.beyond, others=own_names)
    if len(curve.names) != 1:
        raise InputError(
            f"{curve.source}: holds {len(curve.names)} curves ({', '.join(curve.names[:8])}), but "
            "a filter is one; leave the others out of the file"
        )
    cure = "; divide percent by 100" if curve.values.max() > 1 else SMALL_NEGATIVES
    used = used_on_grid(curve.wavelength_nm, DEFAULT_GRID)
    refuse_outside(curve, high=1.0, cure=cure, used=used)
    return means_on_grid(curve, DEFAULT_GRID, beyond=answers.beyond)


def behind_filter_of_word(sensor: Sensor, word: str, *, answers: Answers = ASK) -> Sensor:
    """The same sensor behind one more filter: ``onyx-rgb`` becomes ``onyx-rgb+ircut-650``.

    Parameters
    ----------
    sensor
        On the grid of 400-1050 nm that all words share.
    word
        As `filter_of_word`.
    answers
        What the user knows of the filter's file; ``beyond`` holds for a name too.

    Raises
    ------
    InputError
        As `filter_of_word`.

    Examples
    --------
    >>> bare = sensor_of_word("onyx-rgb")
    >>> cut = behind_filter_of_word(bare, "ircut-650")
    >>> half = cut.grid.wavelength_nm == 650             # the model lets half through at its edge
    >>> cut.name, (cut.qe[half] / bare.qe[half]).round(6)
    ('onyx-rgb+ircut-650', array([[0.5, 0.5, 0.5]]))
    """
    curve = filter_of_word(word, answers=answers)
    name = Path(word).stem if is_file_name(word) else word
    note = "; ".join((f"behind the filter {name}", *curve.notes))
    return behind_filter(sensor, curve.values[:, 0], name=f"{sensor.name}+{name}", note=note)


def asked_of_name(word: str) -> tuple[str, ...]:
    """The fields of `Answers` that a sensor of the catalogue asks for; none of what it lacks.

    Raises
    ------
    InputError
        If the user's folder cannot be understood.
    """
    own = own_table(word, "sensor")
    if word not in KNOWN_SENSORS and own is None:
        return ("scale", "level", "per", "wavelength_unit", "peak_qe")  # its reader complains
    told = catalog_entry(word, folder=catalog_folder()).provenance
    unsaid = told.quantity == "response" and told.per is None
    return (*(["per"] if unsaid else []), *(["peak_qe"] if told.level == "relative" else []))


def is_file_name(word: str) -> bool:
    """Whether a word names a file, by its ending or folder: no file hides a name of ours."""
    return word.lower().endswith(_ENDINGS) or word.startswith((".", "/", "~"))


def is_sensor_file(word: str) -> bool:
    """Whether a sensor's word names a file.

    By ending or folder, or by being there where nothing of the catalogue has that name.

    Raises
    ------
    InputError
        If the user's folder cannot be understood.
    """
    return is_file_name(word) or (not _is_known(word) and _is_there(word))


def _is_known(word: str) -> bool:
    return word in KNOWN_SENSORS or word in own_tables(catalog_folder())


def _is_there(word: str) -> bool:
    try:
        return Path(word).is_file()
    except (OSError, ValueError):  # too long for a name, or a null byte in it
        return False


def word_beside(word: str, folder: Path) -> str:
    """A light or filter of a study that lies in ``folder``: a file's name is told from there.

    Examples
    --------
    >>> word_beside("cam.csv", Path("project")), word_beside("onyx-rgbw", Path("project"))
    ('project/cam.csv', 'onyx-rgbw')
    >>> word_beside("lamp.csv+0.5xLED850", Path("project"))
    'project/lamp.csv+0.5xLED850'
    """
    base = word
    while (parts := infrared_parts(base)) is not None:
        base = parts[0]
    told = not is_file_name(base) or file_of(base).is_absolute()
    return word if told else str(folder / word)


def sensor_word_beside(word: str, folder: Path) -> str:
    """A sensor of a study that lies in ``folder``: a file's name is told from there.

    The file of a sensor needs no ending (`is_sensor_file`).

    Raises
    ------
    InputError
        If the user's folder cannot be understood.
    """
    there = str(folder / word)
    named = is_file_name(word) or _is_known(word)
    return word_beside(word, folder) if named or not _is_there(there) else there


def file_of(word: str) -> Path:
    """The file that a word names, ``~`` being the home of its user."""
    try:
        return Path(word).expanduser()
    except RuntimeError:  # no home is known
        return Path(word)


def _own_files(name: str) -> tuple[Path, ...]:
    table = catalog_file_of(name)
    return () if table is None else (table, table.with_name(SOURCES))


def _light(word: str, answers: Answers) -> Illuminant:
    if is_file_name(word):
        curve = power_of(read_curves(file_of(word), answers=answers))
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
