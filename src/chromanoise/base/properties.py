"""Properties of physical things and keys of a study, each declared once on a field of its class.

A field of a physical thing is annotated with a ``Property``, which carries its bounds, its unit and
its words. A field of a study carries an `Interface`. Whatever reads, sweeps, searches, shows or
documents the field takes them from there.
"""

import math
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any, NamedTuple, get_type_hints

from chromanoise.base import check
from chromanoise.base.errors import InputError
from chromanoise.base.immutable import dataclass
from chromanoise.base.records import After


class Growth(NamedTuple):
    """Exponents with which a value of one pixel grows to that of a sum of pixels.

    A block of ``rows`` x ``columns`` readings is summed; charge binning reads once.
    """

    pixels: float = 0.0
    readings: float = 0.0
    rows: float = 0.0
    columns: float = 0.0


_NONE = Growth()


@dataclass(frozen=True, kw_only=True)
class Property:
    """What a field of a class means, and which values it takes.

    Pydantic checks it with the same sentence and writes its bounds to JSON schemas.

    Attributes
    ----------
    label
        Name in charts and sentences.
    unit
        Unit of the value; ``1`` for none.
    least, most
        Bounds, both allowed. [unit]
    help
        One line on the meaning, with the unit; ``{default:g}`` is the default of the field.
    slider
        Lowest value, highest value and step of the slider on the page; on a logarithmic scale the
        step is a share of a decade. ``None`` for a field without a slider.
    remedy
        What to do with a value out of bounds, where the sentence does not say it.
    later
        Whether it was added after studies were stored: it is hashed only where it is given.
    growth
        How the value grows where pixels are summed (`chromanoise.sensor.binned`).
    logarithmic
        Whether values differ by orders of magnitude: a sweep has equal ratios, and so has a slider
        whose lowest value is above 0.
    needs
        Names of fields. It has no effect if all of these are 0.
    sets_time
        Whether a solved exposure time depends on it.
    common
        As `Interface.common`.

    Examples
    --------
    >>> share = Property(label="duty", unit="1", least=0, most=0.2, help="Share of the time [1].")
    >>> share.demand("duty", 0.3)
    Traceback (most recent call last):
    chromanoise.base.errors.InputError: duty must be 0 to 0.2, but is 0.3
    """

    label: str
    unit: str
    least: float
    most: float
    help: str
    slider: tuple[float, float, float] | None = None
    remedy: str = ""
    later: bool = False
    growth: Growth = _NONE
    logarithmic: bool = False
    needs: tuple[str, ...] = ()
    sets_time: bool = False
    common: bool = False

    def demand(self, name: str, value: Any) -> float:
        """The value as a float.

        Parameters
        ----------
        name
            Of the field, for the sentence.

        Raises
        ------
        InputError
            If the value is not a number within the bounds.
        """
        number = math.nan if value is None else float(value)
        if not self.least <= number <= self.most:
            raise InputError(
                name,
                f"must be {self.least:g} to {self.most:g}{check.in_brackets(self.unit)}",
                value=number,
                remedy=self.remedy or (),
            )
        return number

    def checked(self, value: Any, place: Any) -> Any:
        """A value of a record within the bounds."""
        return After(lambda given: self.demand(place.name, given)).checked(value, place)

    def schema(self) -> dict[str, Any]:
        """What the bounds add to a JSON Schema."""
        return {"minimum": self.least, "maximum": self.most}


@dataclass(frozen=True, kw_only=True)
class Interface:
    """How interfaces offer a key of a study, beyond its type, its default and its description.

    Attributes
    ----------
    keyword
        Its name as an argument of Python and as an option; empty: that of its field; ``None``: it
        is set in a study file, or on the page, alone.
    option
        Name of its option, where it differs.
    part
        What it is in the value of ``option``, where one option sets several keys, e.g. ``FIRST``.
    flags
        Its two values, each with the option that gives it, in place of one option with a value.
    metavar
        Form of the value in the help of the option.
    paths, curves
        Whether Python also takes a path; whether it also takes a path or the curves themselves.
    each
        Whether it has one value per sensor, in their order.
    label
        Of the control on the page.
    slider
        As `Property.slider`.
    logarithmic
        Whether the slider is logarithmic.
    hint
        Text that an empty control shows.
    file
        What a file in place of the value holds: ``spectrum``, ``pixel`` or ``crosstalk``.
    suggestions
        Values of a text.
    needs
        Names of fields of the same part, without which it has no effect.
    later
        As `Property.later`.
    common
        Whether the short help of a command lists its option; the long help lists all.
    heading
        Over its option in the help of a command; empty: that of its part.
    """

    keyword: str | None = ""
    option: str = ""
    part: str = ""
    flags: tuple[tuple[str, str], ...] = ()
    metavar: str | None = None
    paths: bool = False
    curves: bool = False
    each: bool = False
    label: str = ""
    slider: tuple[float, float] | tuple[float, float, float] | None = None
    logarithmic: bool = False
    hint: str | None = None
    file: str = ""
    suggestions: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    later: bool = False
    common: bool = False
    heading: str = ""


@cache
def properties_of(owner: type) -> Mapping[str, Property]:
    """The properties of a class by the names of their fields, in order.

    Parameters
    ----------
    owner
        A class whose fields are annotated with ``Property``.
    """
    hints = get_type_hints(owner, include_extras=True)
    listed = fields(owner) if is_dataclass(owner) else ()
    defaults = {one.name: one.default for one in listed}
    found = {
        name: replace(one, help=one.help.format(default=defaults.get(name)))
        for name, hint in hints.items()
        for one in getattr(hint, "__metadata__", ())
        if isinstance(one, Property)
    }
    return MappingProxyType(found)


def required_of(owner: type) -> tuple[str, ...]:
    """Names of the properties of a dataclass that have no default.

    Parameters
    ----------
    owner
        A dataclass with properties.
    """
    required = {one.name for one in fields(owner) if one.default is MISSING}
    return tuple(name for name in properties_of(owner) if name in required)


def beside_their_needs(properties: Mapping[str, Property]) -> Mapping[str, Property]:
    """Properties in their order, but each directly after the one that it needs."""
    names = list(properties)

    def place(name: str) -> tuple[int, bool]:
        needed = properties[name].needs
        return names.index(needed[0] if needed else name), bool(needed)

    return {name: properties[name] for name in sorted(names, key=place)}


def partial_class(name: str, properties: Mapping[str, Property]) -> type:
    """A frozen dataclass of properties any of which may be given; ``None`` for the others.

    Type checkers need a stub for it: see ``tools/make_stubs.py``.

    Parameters
    ----------
    properties
        Its fields by name, in order.
    """
    given = {field: Annotated[float | None, one] for field, one in properties.items()}
    values = {"__annotations__": given, "__module__": __name__, **dict.fromkeys(properties)}
    found: type = dataclass(frozen=True, kw_only=True)(type(name, (), values))
    lines = "".join(f"\n{field}\n    {one.help}" for field, one in properties.items())
    summary = "Values any of which may be given; ``None`` for the others."
    found.__doc__ = f"{summary}\n\nAttributes\n----------{lines}\n"
    return found


def demand_properties(owner: Any) -> None:
    """Check every property of an object; ``None`` is not checked where it is the default.

    Parameters
    ----------
    owner
        An instance of a class with properties.

    Raises
    ------
    InputError
        As `Property.demand`.
    """
    may_be_none = {field.name for field in fields(owner) if field.default is None}
    for name, one in properties_of(type(owner)).items():  # type: ignore[arg-type] # Hashable
        value = getattr(owner, name)
        if value is not None or name not in may_be_none:
            one.demand(name, value)
