"""Names, paths and Python objects of a study, resolved to sensors, lights, filters, reflectances.

A file of pairs of patches is also resolved here. Python objects are curves of colour-science,
pandas, xarray, NumPy, and our own. An object becomes the ``Found`` of a file, so it is interpreted
and checked as a file is. The foreign packages are not imported.
"""

import csv
import io
import os
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, get_args, overload

import numpy as np

from chromanoise.base import Array, InputError, check, did_you_mean, first_bytes, known_name
from chromanoise.io import library_files, read_curves, read_sensor
from chromanoise.io.spectra import (
    ASK,
    LARGEST,
    Answers,
    Column,
    Found,
    ParsedSpectra,
    Quantity,
    in_nm,
    is_wavelength_heading,
    power_of,
    wavelength_unit_of,
)
from chromanoise.sensor import (
    PAPER_PIXEL,
    Sensor,
    behind_filter,
    blind_channels,
    filter_named,
    is_filter_name,
    of_pixel,
    with_pixel,
)
from chromanoise.spectra import (
    DEFAULT_GRID,
    OBSERVERS,
    SMALL_NEGATIVES,
    SOURCES,
    Illuminant,
    OwnObserver,
    PatchPairs,
    Spectra,
    all_pairs,
    colorchecker,
    illuminant_from,
    illuminant_named,
    infrared_parts,
    is_light_name,
    known_observer,
    means_on_grid,
    mixed,
    reflectance_named,
    refuse_outside,
    shifted,
    used_on_grid,
    user_curves,
)
from chromanoise.spectra.tables import catalog_tables
from chromanoise.study.catalog import (
    KNOWN_SENSORS,
    assumed_pixel,
    catalog_entry,
    catalog_file_of,
    catalog_folder,
    catalog_names,
    own_power,
    own_table,
    own_tables,
    sensor_from_table,
    sensor_named,
    unknown_name,
)

CURVES = (
    "a spectral distribution of colour-science, a DataFrame or Series of pandas, a DataArray of "
    "xarray, Spectra, {'wavelength_nm': [...], 'R': [...]}, or (wavelength_nm, values)"
)
"""What counts as curves, in words."""

_PREFIX = "object:"
_AXIS = "wavelength_nm"  # as the heading of a CSV file
_UNNAMED = re.compile(r"\w+ \(\d+\)")  # colour-science: SpectralDistribution (140012345)


def object_word(name: str) -> str:
    """The word of a study that refers to an object of Python.

    Parameters
    ----------
    name
        Name of the object in results.
    """
    return f"{_PREFIX}{name}"


def is_object_word(word: object) -> bool:
    """Whether a word of a study refers to an object of Python.

    Examples
    --------
    >>> is_object_word(object_word("cam")), is_object_word("cam.csv")
    (True, False)
    """
    return isinstance(word, str) and word.startswith(_PREFIX)


def shown_word(word: str) -> str:
    """A word of a study as results show it: an object by its name.

    Examples
    --------
    >>> shown_word(object_word("cam")), shown_word("cam.csv")
    ('cam', 'cam.csv')
    """
    return word.removeprefix(_PREFIX)


def curves_of_object(given: Any, name: str) -> Found | None:
    """The curves in an object of Python, before they are interpreted; ``None`` for other objects.

    Parameters
    ----------
    given
        One of `CURVES`. Wavelengths are in nm, unless the name of an index of pandas or the units
        of a coordinate of xarray declare another unit.
    name
        Name for messages and results, if the object has none.

    Raises
    ------
    InputError
        If the wavelengths do not increase, a value is not a finite number, or the shapes differ.

    Examples
    --------
    >>> found = curves_of_object({"wavelength_nm": [400, 700], "R": [0.1, 0.5]}, "own sensor")
    >>> found.columns[0].name, found.columns[0].values
    ('R', array([0.1, 0.5]))
    """
    if isinstance(given, Spectra):
        known = {"quantity": given.quantity} if given.quantity in get_args(Quantity) else {}
        named = [(one, given.values[:, k]) for k, one in enumerate(given.names)]
        return _found(given.source or name, given.wavelength_nm, named, **known)
    package = _package(given)
    if package == "colour" and hasattr(given, "wavelengths") and hasattr(given, "values"):
        own = "" if _UNNAMED.fullmatch(str(given.name)) else str(given.name)
        values = np.asarray(given.values)
        labels = [own or "value"] if values.ndim == 1 else [str(one) for one in given.labels]
        return _table(own or name, given.wavelengths, values, labels)
    if package == "pandas" and hasattr(given, "index") and hasattr(given, "to_numpy"):
        columns = [str(one) for one in given.columns] if hasattr(given, "columns") else None
        own = str(given.attrs.get("name") or (given.name if columns is None else "") or name)
        heading, columns = str(given.index.name or ""), [own] if columns is None else columns
        return _table(own, given.index, given.to_numpy(), columns, heading=heading)
    if package == "xarray" and hasattr(given, "dims") and hasattr(given, "dtype"):
        return _labeled(given, name)
    if isinstance(given, Mapping) and _AXIS in given:
        others = [(str(one), values) for one, values in given.items() if one != _AXIS]
        return _found(name, given[_AXIS], others)
    if isinstance(given, tuple) and len(given) == 2 and all(map(_is_listed, given)):
        values = _numbers(name, "values", given[1])
        count = values.shape[1] if values.ndim == 2 else 1
        labels = [f"channel {k + 1}" for k in range(count)] if values.ndim == 2 else ["value"]
        return _table(name, given[0], values, labels)
    return None


def is_of_colour_science(given: Any) -> bool:
    """Whether an object is of colour-science, whose lights are power."""
    return _package(given) == "colour"


def _package(given: Any) -> str:
    """The package of an object or of what its class is derived from, if it is a foreign one."""
    packages = [cls.__module__.partition(".")[0] for cls in type(given).__mro__]
    return next((one for one in packages if one in ("colour", "pandas", "xarray")), "")


def _is_listed(one: Any) -> bool:
    return isinstance(one, list | tuple | np.ndarray) and np.ndim(one) > 0


def _labeled(given: Any, name: str) -> Found:
    """The curves of a DataArray with a dimension of wavelengths and at most one of curves."""
    own = str(getattr(given, "name", None) or name)
    found = [
        dim
        for dim in given.dims
        if str(dim) != "band" and is_wavelength_heading(str(dim).replace("_", " "))
    ]
    if len(found) != 1 or len(given.dims) > 2:
        raise InputError(
            own,
            "must be a DataArray with one dimension wavelength, and at most one of curves",
            value=tuple(map(str, given.dims)),
            found=f"has the dimensions {', '.join(map(str, given.dims)) or 'none'}",
        )
    (axis,) = found
    if axis not in given.coords:
        raise InputError(own, "must have wavelengths as a coordinate", value=str(axis))
    coordinate, others = given.coords[axis], [dim for dim in given.dims if dim != axis]
    values = np.asarray(given.transpose(axis, *others).values)
    labels = [own]
    if others:
        known = others[0] in given.coords
        at = given.coords[others[0]].values if known else range(values.shape[1])
        labels = [str(one) for one in at]
    units = coordinate.attrs.get("units", "")
    heading = f"wavelength [{units}]" if units else str(axis)
    unit = str(given.attrs.get("units", ""))
    return _table(own, coordinate.values, values, labels, heading=heading, unit=unit)


def _table(
    source: str,
    wavelength: Any,
    values: Any,
    names: list[str],
    *,
    heading: str = "",
    unit: str = "",
) -> Found:
    """The columns of one array; rows are wavelengths."""
    array = _numbers(source, "values", values)
    array = array[:, None] if array.ndim == 1 else array
    if array.ndim != 2 or len(names) != array.shape[1] or not array.size:
        raise InputError(
            source, "must have axes (wavelengths, curves)", value=np.shape(values), found=None
        )
    columns = [(name, array[:, k]) for k, name in enumerate(names)]
    return _found(source, wavelength, columns, heading=heading, unit=unit)


def _found(
    source: str,
    wavelength: Any,
    columns: list[tuple[str, Any]],
    *,
    heading: str = "",
    unit: str = "",
    **known: Any,
) -> Found:
    """Curves at one list of wavelengths; ``unit`` is that of the values."""
    axis = None
    if heading and is_wavelength_heading(heading.replace("_", " ")):
        axis = wavelength_unit_of(heading)
    at = check.increasing(
        f"wavelengths of {source}",
        "nm",
        in_nm(_numbers(source, "wavelengths", wavelength), axis or "nm"),
    )
    if not columns:
        raise InputError(source, "must have at least one curve", value=0, found="has none")
    made = []
    for name, given in columns:
        where = f"curve {name!r}"
        values = _numbers(source, where, given)
        if values.shape != at.shape:
            need, found = f"must have {at.size} values, one per wavelength", values.shape
            raise InputError(source, need, value=found, found=f"has shape {found}", where=where)
        bad = ~(np.abs(values) <= LARGEST)
        if bad.any():
            first = int(np.argmax(bad))
            raise InputError(
                source,
                f"must be finite numbers of at most {LARGEST:g}",
                value=float(values[first]),
                found=f"is {values[first]:g} ({int(bad.sum())} of {bad.size} values)",
                where=f"{where} at {at[first]:g} nm",
                remedy="interpolate or remove them",
            )
        made.append(Column(name=name, unit=unit, wavelength=at, values=values))
    return Found(
        source=source,
        format="object of Python",
        columns=tuple(made),
        heading=_AXIS,
        wavelength_unit="nm",
        **known,
    )


def _numbers(source: str, what: str, given: Any) -> Array:
    """An array of real numbers; masked and missing values are NaN."""
    try:
        if isinstance(given, np.ma.MaskedArray):
            given = np.ma.filled(given.astype(np.float64), np.nan)
        if np.asarray(given).dtype.kind not in "fiuO":
            raise TypeError(f"numbers of type {np.asarray(given).dtype}")
        return np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        reason = " ".join(str(error).split())[:80]
        raise InputError(
            source, "must hold real numbers", found=f"does not ({reason})", where=what
        ) from None


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
    note = assumed_pixel(sensor.name, sensor.pixel, {*given, *varied})
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


def word_files(word: str, kind: WordKind) -> tuple[Path, ...]:
    """The files on which a sensor, light, filter or observer depends; none if it is built in.

    For a table of the user's folder they include its SOURCES.toml, which gives pixel and level. An
    added infrared diode depends on no file.

    Raises
    ------
    InputError
        If the user's folder is invalid.
    """
    while kind == "light" and (parts := infrared_parts(word)) is not None:
        word = parts[0]
    if is_file_word(word, kind):
        return library_files(file_of(word))
    table = None if kind == "observer" else catalog_file_of(catalog_word(word, kind))
    return () if table is None else (table, table.with_name(SOURCES))


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
        curve = _with_all_notes(read_curves(file_there(word, "filter"), answers=answers))
    elif (own := own_table(word := catalog_word(word, "filter"), "filter")) is not None:
        curve = replace(user_curves(own), source=word, notes=(own.provenance.source,))
    else:
        _refuse_unknown(word, "filter")
        return filter_named(word, DEFAULT_GRID, beyond=answers.beyond, shift_nm=shift_nm)
    if len(curve.names) != 1:
        raise InputError(
            curve.source,
            "must hold one curve to be a filter",
            value=curve.names,
            found=f"holds {len(curve.names)} ({', '.join(curve.names[:8])})",
            remedy="save one of them in its own file",
        )
    return _shares_on_grid(curve, 1.0, answers, shift_nm)


def _with_all_notes(read: ParsedSpectra) -> Spectra:
    return replace(read.curves, notes=(*read.curves.notes, *read.notes, *read.defects))


def _shares_on_grid(
    curves: Spectra, high: float, answers: Answers, shift_nm: float = 0.0
) -> Spectra:
    """Transmittances or reflectances on the default grid; each must be 0 .. ``high``."""
    remedy = "divide percent by 100" if curves.values.max() > high else SMALL_NEGATIVES
    used = used_on_grid(curves.wavelength_nm + shift_nm, DEFAULT_GRID)
    refuse_outside(curves, high=high, remedy=remedy, used=used)
    return means_on_grid(shifted(curves, shift_nm), DEFAULT_GRID, beyond=answers.beyond)


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
        As for `resolve_filter`, if the sensor has no such channel, or if a channel would measure
        nothing behind the filter.

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
    filtered = behind_filter(
        sensor, curve.values[:, 0], name=f"{sensor.name}+{own}", note=note, channel=channel
    )
    known = blind_channels(sensor)
    if blind := [one for one in blind_channels(filtered) if one not in known]:
        raise InputError(
            "filter",
            "must transmit light that every channel can see",
            value=name,
            found=f"leaves channel {blind[0]} of {sensor.name} a QE of 0 at every wavelength",
            remedy="choose another filter",
        )
    return filtered


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


MOST_REFLECTANCE = 2.0
"""Highest reflectance that is accepted; fluorescence and gloss exceed 1."""

_FILE_KINDS = ("reflectance", "transmittance", None)


def is_reflectance_file(word: str, folder: Path = Path()) -> bool:
    """Whether a word for reflectances names a file, also with ``:NAME`` of one of its curves.

    Parameters
    ----------
    folder
        The folder to which a file name is relative.

    Examples
    --------
    >>> [is_reflectance_file(word) for word in ("cards.csv", "cards.csv:red", "dark skin", "lawn")]
    [True, True, False, False]
    """
    if word in _known_patches():
        return False
    return any(
        name.startswith((".", "/", "~"))
        or "/" in name
        or _ENDING.search(name)
        or os.path.isfile(folder / name)  # noqa: PTH113 - also accepts names that are too long
        for name in (word, *_heads(word))
    )


def reflectance_files(word: str) -> tuple[Path, ...]:
    """The files on which a word for reflectances depends; none if it is a name.

    Raises
    ------
    InputError
        If the data file of a header is missing.
    """
    return library_files(_file_and_name(word)[0]) if is_reflectance_file(word) else ()


def resolve_reflectances(word: str | Found, *, answers: Answers = ASK) -> Spectra:
    """The reflectances in a file, on the default grid, 400-1050 nm.

    Parameters
    ----------
    word
        The file, in any format of `read_curves`, or curves in memory.
    answers
        The user's answers about it; ``beyond`` extrapolates curves that do not cover the grid.

    Raises
    ------
    InputError
        If there is no such file, it cannot be read, holds another quantity, does not cover
        400-1050 nm and ``answers.beyond`` is ``refuse``, or a value is not 0 .. 2.
    """
    file = word if isinstance(word, Found) else file_of(word)
    if not isinstance(file, Found) and not os.path.lexists(file):
        raise InputError(str(word), "cannot be read (No such file or directory)")
    read = read_curves(file, answers=replace(answers, quantity="reflectance"))
    declared = read_curves(file, answers=answers).quantity
    if declared not in _FILE_KINDS:
        raise InputError(
            read.curves.source, "must hold reflectances", value=declared, found=f"holds {declared}"
        )
    curves = replace(_with_all_notes(read), quantity="reflectance", unit="1")
    return _shares_on_grid(curves, MOST_REFLECTANCE, answers)


def resolve_patch(word: str | float | Found, *, answers: Answers = ASK) -> Spectra:
    """One reflectance, on the default grid, 400-1050 nm.

    Parameters
    ----------
    word
        A number, the name of a ColorChecker patch, a reflectance of the catalog (``lawn``,
        ``gray-18``), or ``FILE`` or ``FILE:NAME`` of a file for `resolve_reflectances`.
    answers
        As for `resolve_reflectances`.

    Raises
    ------
    InputError
        If there is no such patch, several curves leave open which, or as `resolve_reflectances`.

    Examples
    --------
    >>> resolve_patch(0.18).values[:2, 0]
    array([0.18, 0.18])
    >>> resolve_patch("dark skin").names
    ('dark skin',)
    """
    if isinstance(word, Found):
        names = tuple(one.name for one in word.columns)
        if len(names) != 1:
            raise InputError(
                "patch",
                "must be one curve",
                value=names,
                found=f"{word.source} has {len(names)} ({', '.join(names[:8])})",
                remedy="select one of them",
            )
        return resolve_reflectances(word, answers=answers)
    if not isinstance(word, str):
        share = check.within("patch", "1", word, 0.0, 1.0)
        flat = colorchecker(DEFAULT_GRID)
        values = np.full((DEFAULT_GRID.n, 1), share)
        return replace(flat, values=values, names=(f"{share:g}",), source=f"{share:g}", notes=())
    chart = colorchecker(DEFAULT_GRID)
    if word in chart.names:
        return _one(chart, word)
    if is_reflectance_file(word):
        file, name = _file_and_name(word)
        return _one(resolve_reflectances(str(file), answers=answers), name)
    if not re.fullmatch(r"gray-[\d.]+", word):
        _refuse_unknown_patch(word)
    return _one(reflectance_named(word, DEFAULT_GRID, beyond=answers.beyond), "")


def _refuse_unknown_patch(word: str) -> None:
    known = _known_patches()
    if word not in known:
        otherwise = "give a number, a file, or a patch of the ColorChecker, e.g. dark skin"
        remedy = did_you_mean(word, known, otherwise, most=2, cutoff=0.6)
        need = "must be a number, a file, or a known name"
        raise InputError("patch", need, value=word, remedy=remedy)


def _known_patches() -> tuple[str, ...]:
    return (*colorchecker(DEFAULT_GRID).names, *catalog_tables("reflectance"))


def _one(spectra: Spectra, name: str) -> Spectra:
    """One curve; the only one if the name is empty."""
    if not name and len(spectra.names) != 1:
        listed = ", ".join(spectra.names[:8])
        raise InputError(
            "patch",
            "must name one of several curves, as FILE:NAME",
            value=spectra.source,
            found=f"names none of the {len(spectra.names)} of {spectra.source} ({listed})",
        )
    wanted = name or spectra.names[0]
    if wanted not in spectra.names:
        otherwise = f"it has {', '.join(spectra.names[:8])}"
        remedy = did_you_mean(wanted, spectra.names, otherwise, most=2, cutoff=0.6)
        need = f"must be a curve of {spectra.source}"
        raise InputError("patch", need, value=wanted, remedy=remedy)
    column = spectra.names.index(wanted)
    return replace(spectra, values=spectra.values[:, [column]], names=(wanted,))


def _heads(word: str) -> list[str]:
    """What stands before each colon, the longest first."""
    return [word[:i] for i in range(len(word) - 1, 0, -1) if word[i] == ":"]


def _file_and_name(word: str) -> tuple[Path, str]:
    """The file, and the name of one of its curves; empty if none is given."""
    for head in (word, *_heads(word)):
        if file_of(head).exists():
            return file_of(head), word[len(head) + 1 :]
    head = next((one for one in _heads(word) if _ENDING.search(one)), word)
    return file_of(head), word[len(head) + 1 :]


PAIRS_HEADER = ("first", "second")
"""Of a list of pairs."""
_MOST_PAIRS = 2_000
_MOST_BYTES = 2**20


def resolve_pairs(word: str | Found, *, answers: Answers = ASK) -> PatchPairs:
    """The pairs of patches in a file, with reflectances on the default grid, 400-1050 nm.

    Parameters
    ----------
    word
        A list in CSV with the header ``first,second``, whose lines name two patches each: patches
        of the ColorChecker, reflectances of the catalog (``skin``), or numbers (``0.18``). Or a
        file of reflectances for `resolve_reflectances`, or curves in memory, all of whose pairs are
        taken.
    answers
        As for `resolve_reflectances`.

    Raises
    ------
    InputError
        If there is no such file, a line does not name two known patches, or as
        `resolve_reflectances`.
    """
    lines = None if isinstance(word, Found) else _listed(word)
    if isinstance(word, Found) or lines is None:
        curves = resolve_reflectances(word, answers=answers)
        if len(curves.names) * (len(curves.names) - 1) // 2 > _MOST_PAIRS:
            need, count = f"must have at most {_MOST_PAIRS} pairs of curves", len(curves.names)
            remedy = "name the pairs in a list with the header first,second"
            found = f"has {count} curves"
            raise InputError(curves.source, need, value=count, found=found, remedy=remedy)
        return all_pairs(curves)
    patches: dict[str, Spectra] = {}
    column: dict[str, int] = {}
    pairs = []
    for number, line in lines:
        where = f"{word}, line {number}"
        if len(line) != 2:
            raise InputError(
                "pairs", "must name two patches per line", value=",".join(line), where=where
            )
        for name in line:
            if name not in patches:
                column[name] = len(patches)
                patches[name] = _patch(name, where, answers)
        pairs.append([column[name] for name in line])
        if line[0] == line[1]:
            raise InputError("pairs", "must be of two patches", value=line[0], where=where)
    columns = [each.values[:, 0] for each in patches.values()]
    first = next(iter(patches.values()), None)
    if first is None:
        raise InputError(word, "must hold at least one pair of patches", found="has none")
    notes = tuple(dict.fromkeys(note for each in patches.values() for note in each.notes))
    table = replace(
        first, values=np.stack(columns, axis=1), names=tuple(patches), source=word, notes=notes
    )
    return PatchPairs(patches=table, indices=np.array(pairs))


def _patch(name: str, where: str, answers: Answers) -> Spectra:
    if is_reflectance_file(name):
        raise InputError(
            "pairs",
            "must name patches of the ColorChecker or of the catalog",
            value=name,
            where=where,
            remedy="put own curves into one file of reflectances: all its pairs are taken",
        )
    try:
        share: float | str = float(name)
    except ValueError:
        share = name
    try:
        return resolve_patch(share, answers=answers)
    except InputError as error:
        raise error.within(where) from None


def _listed(word: str) -> list[tuple[int, list[str]]] | None:
    """The lines of a list of pairs with their numbers; ``None`` for a file of reflectances."""
    start = first_bytes(file_of(word), _MOST_BYTES + 1)
    text = start.decode("utf-8-sig", errors="replace")
    reader = csv.reader(io.StringIO(text, newline=None))
    rows: list[tuple[int, list[str]]] = []
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if not any(cells) or cells[0].startswith("#"):
                continue
            if not rows and tuple(cell.casefold() for cell in cells) != PAIRS_HEADER:
                return None
            rows.append((reader.line_num, cells))
    except csv.Error as error:
        if not rows:
            return None
        where = f"line {reader.line_num}"
        raise InputError(word, "must be a list in CSV", found=str(error), where=where) from None
    if not rows:
        return None
    if len(start) > _MOST_BYTES or len(rows) - 1 > _MOST_PAIRS:
        raise InputError(word, f"must hold at most {_MOST_PAIRS} pairs", value=len(rows) - 1)
    return rows[1:]
