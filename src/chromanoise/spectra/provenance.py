"""Provenance of tables and formulas, and tables in a user's own folder with a SOURCES.toml."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, get_args

from chromanoise.base import InputError, check, dataclass, true_path
from chromanoise.spectra.curves import Beyond, Spectra
from chromanoise.spectra.readers import read_spectra_csv, small_text

Kind = Literal["sensor", "camera", "illuminant", "reflectance", "filter", "scene", "part"]
_LEVELS = ("absolute", "relative")
_PERS = ("photon", "energy")
_TEXTS = ("quantity", "unit", "source", "license", "defects")
_REQUIRED = ("kind", "level", *_TEXTS)
_OPTIONAL = ("done", "mosaic", "pattern", "beyond")
_OF_TABLES = (*_REQUIRED, "what", "per", "done", "mosaic", "pixel", "peak_qe", "beyond")
_OF_THE_HOUSE = ("name", "names", "pattern", "range_nm")
_ABSOLUTE = ("A/W", "e-/photon")  # units of an absolute response
_PIXEL = ("pitch_um", "full_well_e", "read_noise_e")
_Place = tuple[str, str]  # file, section


@dataclass(frozen=True, kw_only=True)
class Provenance:
    """Origin, license, meaning and known defects of a table or formula.

    Attributes
    ----------
    name
        The name in the catalog.
    kind
        What it describes. A ``part`` belongs to another entry and is not in the catalog.
    what
        A description in one phrase.
    quantity, unit
        Quantity and unit of its curves.
    level
        Whether the scale of the curves is ``absolute`` or only ``relative``.
    per
        Whether light is counted in photons or as energy; None if unknown or not applicable.
    source, license
        The source of the data, and its license.
    done
        How the data were processed before they were stored.
    defects
        Known defects of the data.
    mosaic
        For a sensor: its mosaic as `chromanoise.sensor.mosaic_named` reads it; empty if unknown.
    pixel, pixel_source
        For a sensor: the known values of its pixel, by the names of `chromanoise.sensor.Pixel`, and
        their source.
    peak_qe
        For relative curves of a sensor: the highest QE that is assumed; ``None`` if the user has
        to give it. [e-/photon]
    beyond
        How a table of a sensor is extrapolated unless the user says otherwise.
    table
        The packaged table; empty for a formula.
    pattern
        For a family of names: the regular expression that matches them.
    range_nm
        First and last wavelength of what has no table of its own; None if unlimited. [nm]
    """

    name: str
    kind: Kind
    what: str
    quantity: str
    unit: str
    level: Literal["absolute", "relative"]
    source: str
    license: str
    defects: str
    per: Literal["photon", "energy"] | None = None
    done: str = ""
    mosaic: str = ""
    pixel: Mapping[str, float]
    pixel_source: str = ""
    peak_qe: float | None = None
    beyond: Beyond = "refuse"
    table: str = ""
    pattern: str = ""
    range_nm: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.pixel and not self.pixel_source:
            raise InputError(
                f"pixel of {self.name}", "must have a source, as every number of the catalog"
            )
        if self.peak_qe is not None:
            check.within(f"peak_qe of {self.name}", "e-/photon", self.peak_qe, 1e-3, 1.0)
        check.among(f"beyond of {self.name}", self.beyond, get_args(Beyond))
        if self.peak_qe is not None and not (self.is_sensor and self.level == "relative"):
            need = "must be left out, except for relative curves of a sensor"
            raise InputError(f"peak_qe of {self.name}", need, value=self.peak_qe)
        if self.beyond != "refuse" and not self.is_sensor:
            need = "must be left out, except for a sensor"
            raise InputError(f"beyond of {self.name}", need, value=self.beyond)
        if self.is_sensor:
            _refuse_contradiction(self)

    @property
    def is_sensor(self) -> bool:
        """Whether its curves are those of a sensor, alone or in a camera."""
        return self.kind in ("sensor", "camera")


def _refuse_contradiction(provenance: Provenance) -> None:
    """Raise an error if quantity, unit, level and per of a sensor contradict each other."""
    unit = provenance.unit.replace(" ", "")
    per, response = provenance.per, provenance.quantity == "response"
    absolute = response and provenance.level == "absolute"
    for wrong, requirement, remedy in (
        (
            provenance.quantity == "QE" and per == "energy",
            "QE is per photon",
            ("omit per", 'write quantity = "response"'),
        ),
        (
            response and per == "photon" and "/W" in unit,
            f"{provenance.unit} is per energy",
            ('write per = "energy"',),
        ),
        (
            absolute and per == "energy" and unit == "e-/photon",
            "e-/photon is per photon",
            ('write per = "photon"',),
        ),
    ):
        if wrong:
            found = f"per is {per!r}"
            raise InputError(provenance.name, requirement, value=per, found=found, remedy=remedy)
    if absolute and unit not in _ABSOLUTE:
        raise InputError(
            provenance.name,
            f"the unit of an absolute response must be {' or '.join(_ABSOLUTE)}",
            value=provenance.unit,
            found=f"is {provenance.unit}",
            remedy=("convert the values", 'write level = "relative"'),
        )


def table_provenances(text: str, source: str, *, house: bool = False) -> dict[str, Provenance]:
    """The sections of a SOURCES.toml as provenances, by the names of their tables.

    Parameters
    ----------
    source
        The name of its file in messages.
    house
        Whether it is the package's own file, where an entry may have another name than its table.

    Raises
    ------
    InputError
        If the text is not TOML, or a section lacks a key or has an unknown one.

    Examples
    --------
    >>> provenances = table_provenances('''[lamp]
    ... kind = "illuminant"
    ... what = "a desk lamp"
    ... quantity = "power"
    ... unit = "relative"
    ... level = "relative"
    ... source = "measured at home"
    ... license = "CC0-1.0"
    ... defects = "none known"
    ... ''', "SOURCES.toml")
    >>> provenances["lamp"].source
    'measured at home'
    """
    keys = (*_OF_TABLES, "name") if house else _OF_TABLES
    provenances = {}
    for table, section in sections_of(text, source).items():
        place = source, f"section [{table}]"
        _checked(section, place, keys)
        name = str(section.get("name", table))
        provenances[table] = _provenance(
            name, _text(section, "what", place), section, place, table=table
        )
    return provenances


def formula_provenances(text: str, source: str) -> dict[str, Provenance]:
    """The provenance of each name in FORMULAS.toml: data from a formula or from a library.

    Raises
    ------
    InputError
        As for `table_provenances`.
    """
    provenances: dict[str, Provenance] = {}
    for key, section in sections_of(text, source).items():
        place = source, f"section [{key}]"
        _checked(section, place, (*_OF_TABLES, *_OF_THE_HOUSE))
        names = section["names"] if "names" in section else {key: section["what"]}
        for name, what in names.items():
            provenances[name] = _provenance(name, what, section, place)
    return provenances


def sections_of(text: str, source: str) -> dict[str, dict[str, Any]]:
    """The sections of a TOML file.

    Raises
    ------
    InputError
        If the text is not TOML, or a key is outside of a section; the message names the file.
    """
    try:
        sections = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(source, f"is not TOML ({error})") from None
    for key, section in sections.items():
        if not isinstance(section, dict):
            raise InputError(
                source,
                "must be inside a section",
                value=section,
                found="is outside of all",
                where=f"key {key!r}",
            )
    return sections


def _checked(section: dict[str, Any], place: _Place, keys: tuple[str, ...]) -> None:
    for key in section:
        check.among(f"key in {', '.join(place)}", key, keys)
    for key in _REQUIRED:
        _text(section, key, place)
    for key, known in (("kind", get_args(Kind)), ("level", _LEVELS), ("per", _PERS)):
        if key in section:
            check.among(f"{key} in {', '.join(place)}", section[key], known)
    for key in _OPTIONAL:
        if not isinstance(section.get(key, ""), str):
            raise _refused(place, f"key {key!r}", "must be text", section[key])
    peak = section.get("peak_qe", 1.0)
    if isinstance(peak, bool) or not isinstance(peak, int | float):
        raise _refused(place, "key 'peak_qe'", "must be a number", peak)


def _text(section: dict[str, Any], key: str, place: _Place) -> str:
    value = section.get(key)
    if not isinstance(value, str) or not value.strip():
        need = "must be text that is not empty, because every entry needs a provenance"
        raise _refused(place, f"key {key!r}", need, value)
    return value


def _refused(place: _Place, where: str, requirement: str, value: Any) -> InputError:
    source, section = place
    return InputError(source, requirement, value=value, where=f"{section}, {where}")


def _provenance(
    name: str, what: str, section: dict[str, Any], place: _Place, *, table: str = ""
) -> Provenance:
    pixel = dict(_pixel(section, place))
    taken = (*_REQUIRED, "per", *_OPTIONAL, "peak_qe")
    given = {key: section[key] for key in taken if key in section}
    source = section.get("pixel", {}).get("source", "") if pixel else ""
    return Provenance(
        name=name,
        what=what,
        pixel=pixel,
        pixel_source=str(source),
        table=table,
        range_nm=_range(section.get("range_nm"), name),
        **given,
    )


def _range(given: Any, name: str) -> tuple[float, float] | None:
    if isinstance(given, dict):
        given = given[name]
    return None if given is None else (float(given[0]), float(given[1]))


def _pixel(section: dict[str, Any], place: _Place) -> Iterator[tuple[str, float]]:
    data = section.get("pixel", {})
    if not isinstance(data, dict):
        need = "must be a table, as { pitch_um = 6.0, source = ... }"
        raise _refused(place, "key 'pixel'", need, data)
    for key, value in data.items():
        check.among(f"key of the pixel in {', '.join(place)}", key, (*_PIXEL, "source"))
        if key == "source":
            continue
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise _refused(place, f"key {key!r} of the pixel", "must be a number", value)
        allowed = check.not_negative if key == "read_noise_e" else check.positive
        allowed(f"{', '.join(place)}: {key}", "um" if key == "pitch_um" else "e-", value)
        yield key, float(value)


SOURCES = "SOURCES.toml"
_KINDS = ("sensor", "illuminant", "reflectance", "filter")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,79}")
_LARGEST_BYTES = 2**20


@dataclass(frozen=True, kw_only=True)
class UserTable:
    """A table of a user's folder.

    Attributes
    ----------
    provenance
        The section of SOURCES.toml for this table.
    """

    provenance: Provenance
    path: Path


def user_tables(folder: Path) -> Mapping[str, UserTable]:
    """The tables of a folder of CSV files and a SOURCES.toml, by name.

    Parameters
    ----------
    folder
        ``NAME.csv`` (``wavelength_nm,name,...``) for each section ``[NAME]`` of its SOURCES.toml.

    Raises
    ------
    InputError
        If there is no such folder, SOURCES.toml cannot be read, a table has no section, a section
        has no table, or a name is not allowed.
    """
    if not folder.is_dir():
        raise InputError(
            str(folder), "is not a catalog folder", remedy=f"name a folder that holds {SOURCES}"
        )
    source = folder / SOURCES
    provenances = table_provenances(small_text(source, _LARGEST_BYTES), str(source))
    tables = {name: _table(folder, name, provenance) for name, provenance in provenances.items()}
    for path in sorted(folder.glob("*.csv")):
        if path.stem not in tables:
            raise InputError(
                str(path), "has no provenance", remedy=f"add a section [{path.stem}] to {source}"
            )
    return tables


def user_curves(table: UserTable) -> Spectra:
    """The curves of a user's table.

    Raises
    ------
    InputError
        If the table cannot be read; the message names file, line and column.
    """
    known = table.provenance
    return read_spectra_csv(table.path, quantity=known.quantity, unit=known.unit)


def _table(folder: Path, name: str, provenance: Provenance) -> UserTable:
    source, where = str(folder / SOURCES), f"section [{name}]"
    if not _NAME.fullmatch(name):
        raise InputError(
            source,
            "the name must consist of letters, digits, - and _, because it is also a file name",
            value=name,
            where=where,
        )
    check.among(f"kind in {source}, {where}", provenance.kind, _KINDS)
    if provenance.kind == "illuminant" and provenance.per is None:
        raise InputError(
            source,
            "must declare how light is counted",
            where=where,
            remedy=('write per = "energy"', 'write per = "photon"'),
        )
    path = folder / f"{name}.csv"
    if not path.is_file():
        raise InputError(source, f"its table {path.name} is not in the same folder", where=where)
    if true_path(path).parent != true_path(folder):
        raise InputError(
            str(path), "leads out of its folder", remedy="copy the table into the folder"
        )
    return UserTable(provenance=provenance, path=path)
