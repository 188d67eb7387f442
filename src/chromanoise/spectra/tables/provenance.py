"""Where numbers come from: the sections of SOURCES.toml, of the package's own or of a user's."""

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
_ABSOLUTE = ("A/W", "e-/photon")  # units of a response whose height means something
_PIXEL = ("pitch_um", "full_well_e", "read_noise_e")
_Place = tuple[str, str]  # file, section


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """What must be known of numbers before they may be used.

    Attributes
    ----------
    name
        In the catalogue.
    kind
        What it describes; a ``part`` is of something else and not in the catalogue.
    what
        In one phrase.
    quantity, unit
        Of its curves.
    level
        Whether their height means something: ``absolute`` or ``relative``.
    per
        Whether light is counted in photons or as energy; None where that is unknown or idle.
    source, license
        Where the facts come from, and the license of that source.
    done
        What was done to them on the way in.
    defects
        What is known to be wrong or odd.
    mosaic
        Of a sensor: as `chromanoise.sensor.mosaic_named` reads it; empty where unknown.
    pixel, pixel_source
        Of a sensor: what is known of its pixel, by the names of `chromanoise.sensor.Pixel`.
    table
        Its packaged table; empty for a formula.
    pattern
        Of a family of names: the regular expression of all.
    range_nm
        Where a formula or a library's table begins and ends; None where it does not. [nm]
    carried_as
        Its name in colour-science, where that is another.
    channels
        Of such a camera.
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
        _check.one_of(f"kind of {self.name}", self.kind, get_args(Kind))
        _check.one_of(f"level of {self.name}", self.level, _LEVELS)
        if self.per is not None:
            _check.one_of(f"per of {self.name}", self.per, _PERS)
        if self.pixel and not self.pixel_source:
            raise InputError(
                f"pixel of {self.name}", "must have a source, as every number of the catalog"
            )
        if self.kind == "sensor":
            _refuse_contradiction(self)


def _refuse_contradiction(told: Provenance) -> None:
    """What a sensor's section says of its curves must not be two things at once."""
    unit = told.unit.replace(" ", "")
    if told.quantity == "QE" and told.per == "energy":
        raise InputError(
            told.name,
            "QE is per photon",
            value=told.per,
            found=f"per is {told.per!r}",
            remedy=("omit per", 'write quantity = "response"'),
        )
    if told.quantity != "response":
        return
    if told.per == "photon" and "/W" in unit:
        raise InputError(
            told.name,
            f"{told.unit} is per energy",
            value=told.per,
            found=f"per is {told.per!r}",
            remedy='write per = "energy"',
        )
    if told.level == "absolute" and unit not in _ABSOLUTE:
        raise InputError(
            told.name,
            f"the unit of an absolute response must be {' or '.join(_ABSOLUTE)}",
            value=told.unit,
            found=f"is {told.unit}",
            remedy=("convert the values", 'write level = "relative"'),
        )
    if told.level == "absolute" and unit == "e-/photon" and told.per == "energy":
        raise InputError(
            told.name,
            "e-/photon is per photon",
            value=told.per,
            found=f"per is {told.per!r}",
            remedy='write per = "photon"',
        )


def table_provenances(text: str, source: str, *, house: bool = False) -> dict[str, Provenance]:
    """One provenance per table: the sections of a SOURCES.toml, by the names of their tables.

    Parameters
    ----------
    text
        The TOML.
    source
        Its file, as messages name it.
    house
        Whether it is the package's own, which may name an entry otherwise than its table.

    Raises
    ------
    InputError
        If it is not TOML, or a section lacks a key or has an unknown one.

    Examples
    --------
    >>> told = table_provenances('''[lamp]
    ... kind = "illuminant"
    ... what = "a desk lamp"
    ... quantity = "power"
    ... unit = "relative"
    ... level = "relative"
    ... source = "measured at home"
    ... license = "CC0-1.0"
    ... defects = "none known"
    ... ''', "SOURCES.toml")
    >>> told["lamp"].source
    'measured at home'
    """
    keys = (*_OF_TABLES, "name") if house else _OF_TABLES
    told = {}
    for table, section in sections_of(text, source).items():
        place = source, f"section [{table}]"
        _checked(section, place, keys)
        name = str(section.get("name", table))
        told[table] = _provenance(name, _text(section, "what", place), section, place, table=table)
    return told


def formula_provenances(text: str, source: str) -> dict[str, Provenance]:
    """One provenance per name of FORMULAS.toml: what is made by a formula or found in a library.

    Raises
    ------
    InputError
        As `table_provenances`.
    """
    told: dict[str, Provenance] = {}
    for key, section in sections_of(text, source).items():
        place = source, f"section [{key}]"
        _checked(section, place, (*_OF_TABLES, *_OF_THE_HOUSE))
        names = section["names"] if "names" in section else {key: section["what"]}
        for name, what in names.items():
            told[name] = _provenance(name, what, section, place)
    return told


def sections_of(text: str, source: str) -> dict[str, dict[str, Any]]:
    """The sections of a TOML file.

    Raises
    ------
    InputError
        If it is not TOML, or a key is outside of a section; names file and line.
    """
    try:
        told = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(source, f"is not TOML ({error})") from None
    for key, section in told.items():
        if not isinstance(section, dict):
            raise InputError(
                source,
                "must be inside a section",
                value=section,
                found="is outside of all",
                where=f"key {key!r}",
            )
    return told


def _checked(section: dict[str, Any], place: _Place, keys: tuple[str, ...]) -> None:
    for key in section:
        _check.one_of(f"key in {', '.join(place)}", key, keys)
    for key in _REQUIRED:
        _text(section, key, place)
    for key, known in (("kind", get_args(Kind)), ("level", _LEVELS), ("per", _PERS)):
        if key in section:
            _check.one_of(f"{key} in {', '.join(place)}", section[key], known)
    for key in ("done", "mosaic", "pattern", "carried_as"):
        if not isinstance(section.get(key, ""), str):
            raise InputError(
                place[0], "must be text", value=section[key], where=f"{place[1]}, key {key!r}"
            )


def _text(section: dict[str, Any], key: str, place: _Place) -> str:
    value = section.get(key)
    if not isinstance(value, str) or not value.strip():
        raise InputError(
            place[0],
            "must be text that is not empty, because every entry needs a provenance",
            value=value,
            where=f"{place[1]}, key {key!r}",
        )
    return value


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


def _range(told: Any, name: str) -> tuple[float, float] | None:
    if isinstance(told, dict):
        told = told[name]
    return None if told is None else (float(told[0]), float(told[1]))


def _pixel(section: dict[str, Any], place: _Place) -> Iterator[tuple[str, float]]:
    told = section.get("pixel", {})
    if not isinstance(told, dict):
        raise InputError(
            place[0],
            "must be a table, as { pitch_um = 6.0, source = ... }",
            value=told,
            where=f"{place[1]}, key 'pixel'",
        )
    for key, value in told.items():
        _check.one_of(f"key of the pixel in {', '.join(place)}", key, (*_PIXEL, "source"))
        if key == "source":
            continue
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(
                place[0],
                "must be a number",
                value=value,
                where=f"{place[1]}, key {key!r} of the pixel",
            )
        allowed = _check.not_negative if key == "read_noise_e" else _check.positive
        allowed(f"{', '.join(place)}: {key}", "um" if key == "pitch_um" else "e-", value)
        yield key, float(value)
