"""Resolve a name or a path, from a study or a command, to a sensor, light or filter."""

import os
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np

from chromanoise.catalog.entries import (
    catalog_entry,
    catalog_file_of,
    catalog_folder,
    catalog_names,
    own_power,
    own_table,
    own_tables,
)
from chromanoise.catalog.names import unknown_name
from chromanoise.catalog.sensor_tables import assumed_pixel, sensor_from_table
from chromanoise.catalog.sensors import KNOWN_SENSORS, sensor_named
from chromanoise.errors import InputError, known_name
from chromanoise.io import read_sensor
from chromanoise.io.spectra import ASK, Answers, library_files, power_of, read_curves
from chromanoise.io.spectra.parsed import Found
from chromanoise.sensor import (
    PAPER_PIXEL,
    Sensor,
    behind_filter,
    filter_named,
    is_filter_name,
    of_pixel,
    with_pixel,
)
from chromanoise.spectra import (
    DEFAULT_GRID,
    OBSERVERS,
    SMALL_NEGATIVES,
    Illuminant,
    OwnObserver,
    Spectra,
    illuminant_from,
    illuminant_named,
    infrared_parts,
    is_light_name,
    known_observer,
    means_on_grid,
    mixed,
    refuse_outside,
    shifted,
    used_on_grid,
)
from chromanoise.spectra.tables.folder import SOURCES, user_curves

_ENDING = re.compile(r"\.[A-Za-z]\w*$")  # no name in the catalog matches: FL3.1, 5500.5K
_LARGEST_END = 0.02  # of the peak of a color-matching function, where its table ends
WordKind = Literal["sensor", "light", "filter", "observer"]
"""What a word refers to; the word is a name of the catalog or a path."""
Curves = str | Found
"""A word, or the curves of an object of Python in place of a file."""


def resolve_sensor(
    word: Curves, *, answers: Answers = ASK, varied: Collection[str] = (), **changes: Any
) -> Sensor:
    """A sensor of the catalog or from a file of curves, with the given pixel values.

    Parameters
    ----------
    word
        A name in the catalog or the user's folder, a file (`is_file_word`), or curves in memory.
    answers
        Metadata that the file or the catalog's table lacks.
    varied
        As for `chromanoise.sensor.with_pixel`.
    changes
        Fields of `Pixel` and `Converter`, which override the sensor's values; ``None`` does not.
        A file of curves has none: its default is the paper's pixel.

    Raises
    ------
    InputError
        If the name is unknown, the file cannot be read, or a pixel value is invalid.
    """
    given = {key: value for key, value in changes.items() if value is not None}
    if isinstance(word, str) and not is_file_word(word, "sensor"):
        return with_pixel(_catalog_sensor(word, answers, of_pixel(given)), given, varied=varied)
    sensor = read_sensor(file_there(word, "sensor"), DEFAULT_GRID, PAPER_PIXEL, answers=answers)
    note = assumed_pixel(sensor.name, sensor.pixel, given)
    return with_pixel(replace(sensor, notes=(*sensor.notes, *note)), given, varied=varied)


def resolve_illuminant(word: Curves, *, answers: Answers = ASK) -> Illuminant:
    """An illuminant by name, from the user's folder, from a file of one curve or one in memory.

    Each may have an added infrared diode, as in ``A+0.5xLED850`` or ``lamp.csv+1xLED940/50``.

    Raises
    ------
    InputError
        If the name is unknown, or the file cannot be read.
    """
    if isinstance(word, Found):
        return _light(word, answers)
    return mixed(word, lambda base: _light(base, answers))


def resolve_observer(word: Curves) -> str:
    """An observer by name, or an `OwnObserver` from a file or curves in memory.

    Three curves x, y, z, from which nothing is scaled. Beyond its ends an observer is zero, as the
    CIE defines it; a table that ends within 400-1050 nm must have fallen to 2 % of its peak there.

    Raises
    ------
    InputError
        If the name is unknown, the file cannot be read, or holds no such functions.
    """
    if isinstance(word, str) and not is_file_word(word, "observer"):
        return known_observer(word)
    read = read_curves(file_there(word, "observer"), answers=Answers(quantity="response"))
    curves = replace(read.curves, quantity="color-matching functions", notes=read.notes)
    made = OwnObserver(_called(word, ending=True), curves)
    for row, inside in (
        (0, curves.wavelength_nm[0] > DEFAULT_GRID.wavelength_nm[0]),
        (-1, curves.wavelength_nm[-1] < DEFAULT_GRID.wavelength_nm[-1]),
    ):
        shares = np.abs(curves.values[row]) / curves.values.max(axis=0)
        if inside and shares.max() > _LARGEST_END:
            share, name = float(shares.max()), curves.names[int(shares.argmax())]
            raise InputError(
                curves.source,
                f"must fall to {100 * _LARGEST_END:g} % of its peak where it ends",
                value=share,
                found=f"is {100 * share:.3g} %",
                where=f"curve {name!r} at {curves.wavelength_nm[row]:g} nm",
                remedy="use a table that covers the visible range",
            )
    return made


def sensor_files(word: str) -> tuple[Path, ...]:
    """The files on which a sensor depends; none if it is built in.

    For a table of the user's folder they include its SOURCES.toml, which gives pixel and level.

    Raises
    ------
    InputError
        If the user's folder is invalid.
    """
    return _files(word, "sensor")


def illuminant_files(word: str) -> tuple[Path, ...]:
    """The files on which a light depends; none if it is built in.

    An added infrared diode depends on no file.

    Raises
    ------
    InputError
        If the user's folder is invalid.
    """
    parts = infrared_parts(word)
    if parts is not None:
        return illuminant_files(parts[0])
    return _files(word, "light")


def observer_files(word: str) -> tuple[Path, ...]:
    """The files on which an observer depends; none if it is built in."""
    return library_files(file_of(word)) if is_file_word(word, "observer") else ()


def filter_files(word: str) -> tuple[Path, ...]:
    """The files on which a filter depends; none if it is built in.

    Raises
    ------
    InputError
        If the user's folder is invalid.
    """
    return _files(word, "filter")


def resolve_filter(word: Curves, *, answers: Answers = ASK, shift_nm: float = 0.0) -> Spectra:
    """The transmittance of a filter by name, from the user's folder or from a file of one curve.

    Parameters
    ----------
    word
        A name in the catalog or the user's folder, a file (`is_file_word`), or curves in memory.
    answers
        The user's answers about the file; ``beyond`` also applies to filters by name.
    shift_nm
        Added to the wavelengths of the filter, positive towards red. [nm]

    Raises
    ------
    InputError
        If there is no such filter, the file cannot be read or holds several curves, the shifted
        curve does not cover 400-1050 nm and ``answers.beyond`` is ``refuse``, or a transmittance is
        outside 0-1.
    """
    if isinstance(word, Found) or is_file_word(word, "filter"):
        answers = replace(answers, quantity="transmittance")
        read = read_curves(file_there(word, "filter"), answers=answers)
        curve = replace(read.curves, notes=(*read.curves.notes, *read.notes, *read.defects))
    elif (own := own_table(word := catalog_word(word, "filter"), "filter")) is not None:
        curve = replace(user_curves(own), source=word, notes=(own.provenance.source,))
    else:
        _refuse_unknown(word, "filter")
        return filter_named(word, DEFAULT_GRID, beyond=answers.beyond, shift_nm=shift_nm)
    if len(curve.names) != 1:
        need, split = "must hold one curve to be a filter", "save one of them in its own file"
        found = f"holds {len(curve.names)} ({', '.join(curve.names[:8])})"
        raise InputError(curve.source, need, value=curve.names, found=found, remedy=split)
    remedy = "divide percent by 100" if curve.values.max() > 1 else SMALL_NEGATIVES
    used = used_on_grid(curve.wavelength_nm + shift_nm, DEFAULT_GRID)
    refuse_outside(curve, high=1.0, remedy=remedy, used=used)
    return means_on_grid(shifted(curve, shift_nm), DEFAULT_GRID, beyond=answers.beyond)


def behind_resolved_filter(
    sensor: Sensor,
    word: Curves,
    *,
    answers: Answers = ASK,
    channel: str | None = None,
    shift_nm: float = 0.0,
) -> Sensor:
    """The same sensor behind one more filter: ``onyx-rgb`` becomes ``onyx-rgb+ircut-650``.

    Parameters
    ----------
    sensor
        A sensor on the default grid, 400-1050 nm.
    word
        As for `resolve_filter`.
    answers
        The user's answers about the filter's file; ``beyond`` also applies to filters by name.
    channel
        The channel that has the filter; ``None`` for all.
    shift_nm
        As for `resolve_filter`. [nm]

    Raises
    ------
    InputError
        As for `resolve_filter`, or if the sensor has no such channel.

    Examples
    --------
    >>> bare = resolve_sensor("onyx-rgb")
    >>> cut = behind_resolved_filter(bare, "ircut-650")
    >>> half = cut.grid.wavelength_nm == 650             # the model transmits 0.5 at its edge
    >>> cut.name, (cut.qe[half] / bare.qe[half]).round(6)
    ('onyx-rgb+ircut-650', array([[0.5, 0.5, 0.5]]))
    """
    curve = resolve_filter(word, answers=answers, shift_nm=shift_nm)
    named = is_file_word(word, "filter")
    name = _called(word) if named else catalog_word(str(word), "filter")
    behind = "" if channel is None else f"{channel} "
    moved = f", shifted by {shift_nm:+g} nm" if shift_nm else ""
    note = "; ".join((f"{behind}behind the filter {name}{moved}", *curve.notes))
    own = name if channel is None else f"{channel}:{name}"
    return behind_filter(
        sensor, curve.values[:, 0], name=f"{sensor.name}+{own}", note=note, channel=channel
    )


def asked_of_name(word: str) -> tuple[str, ...]:
    """The fields of `Answers` that a sensor of the catalog requires.

    Raises
    ------
    InputError
        If the user's folder is invalid.
    """
    word = catalog_word(word, "sensor")
    own = own_table(word, "sensor")
    if word not in KNOWN_SENSORS and own is None:
        # reading the word later raises the error
        return ("scale", "level", "per", "wavelength_unit", "peak_qe")
    known = catalog_entry(word, folder=catalog_folder()).provenance
    unsaid = known.quantity == "response" and known.per is None
    return (*(["per"] if unsaid else []), *(["peak_qe"] if known.level == "relative" else []))


def is_file_word(word: Curves, kind: WordKind, folder: Path = Path()) -> bool:
    """Whether a word for a sensor, light, filter or observer names a file; curves count as one.

    A word names a file if it looks like a path or ends in a dot and letters, or if such a file
    exists and the catalog has no such name. A file never overrides a name in the catalog.

    Parameters
    ----------
    word
        The word; for a light, without the added infrared diodes.
    kind
        What the word refers to.
    folder
        The folder to which a file name is relative.

    Raises
    ------
    InputError
        If the user's folder is invalid.

    Examples
    --------
    >>> [is_file_word(word, "light") for word in ("lamp.dat", "lamps/a", "LED850/20", "FL3.1")]
    [True, True, False, False]
    """
    if isinstance(word, Found) or word.startswith((".", "/", "~")) or _ENDING.search(word):
        return True
    path = folder / word  # os.path also accepts names that are too long
    there = os.path.exists(path) and not os.path.isdir(path)  # noqa: PTH110, PTH112
    return ("/" in word or os.sep in word or there) and not (
        _BUILT_IN[kind](word) or word in own_tables(catalog_folder())
    )


_BUILT_IN: Mapping[WordKind, Callable[[str], bool]] = {
    "sensor": KNOWN_SENSORS.__contains__,
    "light": is_light_name,
    "filter": is_filter_name,
    "observer": OBSERVERS.__contains__,
}


def catalog_word(word: str, kind: WordKind) -> str:
    """The name of the catalog that a word is, as `known_name`; a word that is none itself.

    Parameters
    ----------
    word
        A word that is no file.
    kind
        What the word refers to.

    Raises
    ------
    InputError
        If the user's folder is invalid.

    Examples
    --------
    >>> catalog_word("onyx_rgbw", "sensor"), catalog_word("ircut_650", "filter")
    ('onyx-rgbw', 'ircut-650')
    """
    if _BUILT_IN[kind](word):
        return word
    known = known_name(word, catalog_names(_CATALOG_KIND[kind], folder=catalog_folder()))
    family = word.replace("_", "-")
    return family if known == word and _BUILT_IN[kind](family) else known


def word_beside(word: str, kind: WordKind, folder: Path) -> str:
    """A word of a study in ``folder``, with a relative file name resolved against that folder.

    Raises
    ------
    InputError
        If the user's folder is invalid.

    Examples
    --------
    >>> [word_beside(word, "sensor", Path("project")) for word in ("cam.csv", "onyx-rgbw")]
    ['project/cam.csv', 'onyx-rgbw']
    >>> word_beside("lamp.dat+0.5xLED850", "light", Path("project"))
    'project/lamp.dat+0.5xLED850'
    """
    base = word
    while kind == "light" and (parts := infrared_parts(base)) is not None:
        base = parts[0]
    named = not is_file_word(base, kind, folder) or file_of(base).is_absolute()
    return word if named else str(folder / word)


@overload
def file_there(word: str, kind: WordKind) -> Path: ...
@overload
def file_there(word: Curves, kind: WordKind) -> Path | Found: ...
def file_there(word: Curves, kind: WordKind) -> Path | Found:
    """The file that a word names; curves in memory are returned as they are.

    Raises
    ------
    InputError
        If the file is missing; the message adds that the catalog has no such name either.
    """
    if isinstance(word, Found):
        return word
    file = file_of(word)
    if not os.path.lexists(file):
        raise InputError(
            word,
            "cannot be read (No such file or directory), and the catalog has no "
            f"{_CATALOG_KIND[kind]} of that name",
        )
    return file


_CATALOG_KIND: Mapping[WordKind, str] = {
    "sensor": "sensor",
    "light": "illuminant",
    "filter": "filter",
    "observer": "observer",
}


def _called(word: Curves, *, ending: bool = False) -> str:
    """The name of the curves of a file or of an object, with or without the ending of the file."""
    if isinstance(word, Found):
        return word.source
    return Path(word).name if ending else Path(word).stem


def _refuse_unknown(word: str, kind: WordKind) -> None:
    """Raise an error for a word that is neither a built-in name nor a file."""
    if _BUILT_IN[kind](word):
        return
    subject = _CATALOG_KIND[kind]
    known = catalog_names(subject, folder=catalog_folder())
    rule = "must be a name of the catalog or a file"
    raise unknown_name(subject, word, known, requirement=rule)


def _files(word: str, kind: WordKind) -> tuple[Path, ...]:
    if is_file_word(word, kind):
        return library_files(file_of(word))
    table = catalog_file_of(catalog_word(word, kind))
    return () if table is None else (table, table.with_name(SOURCES))


def file_of(word: str) -> Path:
    """The path that a word names; ``~`` is expanded to the home directory."""
    try:
        return Path(word).expanduser()
    except RuntimeError:  # no home is known
        return Path(word)


def _light(word: Curves, answers: Answers) -> Illuminant:
    if isinstance(word, Found) or is_file_word(word, "light"):
        curve = power_of(read_curves(file_there(word, "light"), answers=answers))
        return illuminant_from(curve, DEFAULT_GRID, name=_called(word), beyond=answers.beyond)
    word = catalog_word(word, "light")
    own = own_table(word, "illuminant")
    if own is not None:
        return illuminant_from(own_power(own), DEFAULT_GRID, name=word, beyond=answers.beyond)
    _refuse_unknown(word, "light")
    return illuminant_named(word, DEFAULT_GRID, beyond=answers.beyond)


def _catalog_sensor(word: str, answers: Answers, pixel: dict[str, float]) -> Sensor:
    word = catalog_word(word, "sensor")
    own = own_table(word, "sensor")
    if own is not None:
        curves = user_curves(own)
        return sensor_from_table(own.provenance, curves, DEFAULT_GRID, answers=answers, pixel=pixel)
    _refuse_unknown(word, "sensor")
    return sensor_named(word, DEFAULT_GRID, answers=answers, pixel=pixel)
