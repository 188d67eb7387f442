"""Properties of physical things, each declared once: on the field of its class.

A field is annotated with a `Property`, which carries its bounds, its unit and its words. Whatever
reads, sweeps, searches or documents the field takes them from there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple, get_type_hints

from chromanoise import _check
from chromanoise.errors import InputError


class Growth(NamedTuple):
    """Exponents with which a value of one pixel grows to that of a sum of pixels.

    A block of ``rows`` x ``columns`` readings is summed; charge binning reads once.
    """

    pixels: float = 0.0
    readings: float = 0.0
    rows: float = 0.0
    columns: float = 0.0


_NONE = Growth()


@dataclass(frozen=True, slots=True, kw_only=True)
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
        One line on the meaning, with the unit.
    slider
        Lowest value, highest value and step of the slider on the page; on a logarithmic scale the
        step is a share of a decade. ``None`` for a field without a slider.
    remedy
        What to do with a value out of bounds, where the sentence does not say it.
    growth
        How the value grows where pixels are summed (`chromanoise.sensor.binned`).

    Examples
    --------
    >>> share = Property(label="PRNU", unit="1", least=0, most=0.2, help="Photo response [1].")
    >>> share.demand("prnu", 0.3)
    Traceback (most recent call last):
    chromanoise.errors.InputError: prnu must be 0 to 0.2, but is 0.3
    """

    label: str
    unit: str
    least: float
    most: float
    help: str
    slider: tuple[float, float, float] | None = None
    remedy: str = ""
    growth: Growth = _NONE

    def demand(self, name: str, value: Any) -> float:
        """The value as a float.

        Parameters
        ----------
        name
            Of the field, for the sentence.
        value
            To be checked.

        Raises
        ------
        InputError
            If the value is not a number within the bounds.
        """
        number = math.nan if value is None else float(value)
        if not self.least <= number <= self.most:
            raise InputError(
                name,
                f"must be {self.least:g} to {self.most:g}{_check.in_brackets(self.unit)}",
                value=number,
                remedy=self.remedy or (),
            )
        return number

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        from pydantic import AfterValidator  # only where a study or a file is read

        def checked(value: float | None, info: Any) -> float | None:
            return None if value is None else self.demand(str(info.field_name), value)

        return AfterValidator(checked).__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        return dict(handler(core)) | {"minimum": self.least, "maximum": self.most}


@cache
def properties_of(owner: type) -> Mapping[str, Property]:
    """The properties of a class by the names of their fields, in order.

    Parameters
    ----------
    owner
        A class whose fields are annotated with `Property`.
    """
    hints = get_type_hints(owner, include_extras=True)
    found = {
        name: one
        for name, hint in hints.items()
        for one in getattr(hint, "__metadata__", ())
        if isinstance(one, Property)
    }
    return MappingProxyType(found)


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
