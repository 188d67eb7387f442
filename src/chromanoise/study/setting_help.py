"""Types, defaults and descriptions of settings, for docstrings and for the help of options."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from chromanoise.study.document import Study
from chromanoise.study.settings import (
    FUNCTIONS,
    STARTS,
    AnalysisSettings,
    ComparisonSettings,
    DenoiseSettings,
    MapSettings,
    MatrixSettings,
    RenderSettings,
    SensitivitySettings,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class DescribedSetting:
    """A setting of a function, for its docstring.

    Attributes
    ----------
    name
        Name of the argument.
    annotation, default
        Its type and its default value.
    description
        Description of its key in a study.
    """

    name: str
    annotation: Any
    default: Any
    description: str

    def __str__(self) -> str:
        """Two lines in numpydoc format."""
        default = "" if self.default is None else f", default {self.default!r}"
        return f"{self.name} : {_type_text(self.annotation)}{default}\n    {self.description}"


def described_settings(function: str) -> tuple[DescribedSetting, ...]:
    """The settings of a function with types, defaults and descriptions.

    Parameters
    ----------
    function
        A name of `FUNCTIONS`, e.g. ``analyze``.

    Examples
    --------
    >>> print(next(one for one in described_settings("analyze") if one.name == "lux"))
    lux : float, default 10.0
        Illuminance [lx].
    """
    hints = get_type_hints(_KINDS[function])
    described = []
    for name, keys in FUNCTIONS[function].items():
        described.append(
            DescribedSetting(
                name=name,
                annotation=hints[name],
                default=default_of(function, name),
                description=_field_of(keys[0]).description or "",
            )
        )
    return tuple(described)


def default_of(function: str, name: str) -> Any:
    """The default of a setting: what the function starts with, else that of the study.

    Parameters
    ----------
    function
        A name of `FUNCTIONS`, e.g. ``analyze``.
    name
        The flat name of the setting.

    Examples
    --------
    >>> default_of("analyze", "f_number"), default_of("compare", "last")
    (1.8, 1000.0)
    """
    key = FUNCTIONS[function][name][0]
    at: Any = STARTS[function]
    for step in key.split("."):
        at = at[int(step)] if isinstance(at, list) else at.get(step, {})
    return _field_of(key).get_default() if at in ({}, None) else at


_KINDS = {
    "analyze": AnalysisSettings,
    "compare": ComparisonSettings,
    "compare_map": MapSettings,
    "denoise": DenoiseSettings,
    "matrix": MatrixSettings,
    "render": RenderSettings,
    "sensitivity": SensitivitySettings,
}


def _field_of(key: str) -> FieldInfo:
    """The field of a study's document with this key."""
    *path, last = [step for step in key.split(".") if step not in ("*", "0")]
    model: type[BaseModel] = Study
    for step in path:
        inside = _parts_of(model.model_fields[step].annotation)
        model = next(p for p in inside if isinstance(p, type) and issubclass(p, BaseModel))
    return model.model_fields[last]


def _parts_of(annotation: Any) -> list[Any]:
    """A type with all types inside it."""
    return [annotation, *(part for one in get_args(annotation) for part in _parts_of(one))]


def _type_text(annotation: Any) -> str:
    """A type in the form used in docstrings."""
    if get_origin(annotation) is Literal:
        return " or ".join(repr(value) for value in get_args(annotation))
    if get_origin(annotation) in (Union, UnionType):
        return " or ".join(_type_text(one) for one in get_args(annotation))
    if get_origin(annotation) is tuple:
        return f"({', '.join(_type_text(one) for one in get_args(annotation))})"
    if get_origin(annotation) is Mapping:
        key, value = map(_type_text, get_args(annotation))
        return f"mapping of {key} to {value}"
    if get_args(annotation):
        return f"sequence of {_type_text(get_args(annotation)[0])}"
    return str(annotation.__name__)
