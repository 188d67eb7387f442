"""Provenance of tables: the sections of a SOURCES.toml, packaged or in a user's folder."""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from chromanoise import _check
from chromanoise.errors import InputError

Kind = Literal["sensor", "illuminant", "reflectance", "filter", "scene", "part"]
_LEVELS = ("absolute", "relative")
_PERS = ("photon", "energy")
_TEXTS = ("quantity", "unit", "source", "license", "defects")
_REQUIRED = ("kind", "level", *_TEXTS)
_OF_TABLES = (*_REQUIRED, "what", "per", "done", "mosaic", "pixel")
_OF_THE_HOUSE = ("name", "names", "pattern", "range_nm", "carried_as", "channels")
_ABSOLUTE = ("A/W", "e-/photon")  # units of an absolute response
_PIXEL = ("pitch_um", "full_well_e", "read_noise_e")
_Place = tuple[str, str]  # file, section


@dataclass(frozen=True, slots=True, kw_only=True)
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
    table
        The packaged table; empty for a formula.
    pattern
        For a family of names: the regular expression that matches them.
    range_nm
        First and last wavelength of a formula or a library's table; None if unlimited. [nm]
    carried_as
        The name in colour-science, if it differs.
    channels
        The channels of a camera of colour-science.
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
    table: str = ""
    pattern: str = ""
    range_nm: tuple[float, float] | None = None
    carried_as: str = ""
    channels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check.among(f"kind of {self.name}", self.kind, get_args(Kind))
        _check.among(f"level of {self.name}", self.level, _LEVELS)
        if self.per is not None:
            _check.among(f"per of {self.name}", self.per, _PERS)
        if self.pixel and not self.pixel_source:
            raise InputError(
                f"pixel of {self.name}", "must have a source, as every number of the catalog"
            )
        if self.kind == "sensor":
            _refuse_contradiction(self)


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
    text
        The TOML text.
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
        _check.among(f"key in {', '.join(place)}", key, keys)
    for key in _REQUIRED:
        _text(section, key, place)
    for key, known in (("kind", get_args(Kind)), ("level", _LEVELS), ("per", _PERS)):
        if key in section:
            _check.among(f"{key} in {', '.join(place)}", section[key], known)
    for key in ("done", "mosaic", "pattern", "carried_as"):
        if not isinstance(section.get(key, ""), str):
            raise _refused(place, f"key {key!r}", "must be text", section[key])


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
    texts = {key: section[key] for key in _REQUIRED}
    optional = {
        key: str(section[key])
        for key in ("per", "done", "mosaic", "pattern", "carried_as")
        if key in section
    }
    source = section.get("pixel", {}).get("source", "") if pixel else ""
    return Provenance(
        name=name,
        what=what,
        pixel=pixel,
        pixel_source=str(source),
        table=table,
        range_nm=_range(section.get("range_nm"), name),
        channels=tuple(section.get("channels", ())),
        **texts,
        **optional,  # type: ignore[arg-type]
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
        _check.among(f"key of the pixel in {', '.join(place)}", key, (*_PIXEL, "source"))
        if key == "source":
            continue
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise _refused(place, f"key {key!r} of the pixel", "must be a number", value)
        allowed = _check.not_negative if key == "read_noise_e" else _check.positive
        allowed(f"{', '.join(place)}: {key}", "um" if key == "pitch_um" else "e-", value)
        yield key, float(value)
