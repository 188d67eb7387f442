"""The settings of commands and functions: flat names of keys of a study.

`FUNCTIONS` lists them, made from the fields of `Study`. `study_of` builds the study from their
values, for the command line and for Python alike.
"""

import re
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from types import MappingProxyType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from chromanoise.analysis import DEFAULT_METHOD
from chromanoise.catalog.objects import shown_word
from chromanoise.errors import InputError, did_you_mean, errors_in, refusal
from chromanoise.properties import Interface
from chromanoise.study.document import Study
from chromanoise.study.keys import KEYS, KeyOfStudy
from chromanoise.study.reading import study_from_data

Settings = Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Function:
    """A function of Python: the beginnings of the keys that it sets, its other arguments.

    ``start`` is its study before settings are applied.
    """

    keys: tuple[str, ...]
    arguments: tuple[str, ...]
    start: Mapping[str, Any]
    without: tuple[str, ...] = ()

    def settings(self) -> Mapping[str, tuple[str, ...]]:
        """The keys by the names of its settings; pictures precede sensors, and these the light."""
        found: dict[str, tuple[str, ...]] = {}
        for beginning in self.keys:
            for key, one in KEYS.items():
                excluded = any(_begins(key, no) for no in self.without)
                if one.keyword is not None and _begins(key, beginning) and not excluded:
                    found[one.keyword] = (*found.get(one.keyword, ()), key)
        order = {"pictures": 0, "sensors": 1, "light": 2}
        return MappingProxyType(
            {
                name: tuple(sorted(keys, key=lambda key: order.get(key.partition(".")[0], 0)))
                for name, keys in found.items()
            }
        )


def _begins(key: str, beginning: str) -> bool:
    return f"{key}.".startswith(f"{beginning}.")


_OF_RAW = ("mosaic", "demosaic", "bits", "black_level")  # its file may give them, too
_POINT = ("light", "exposure", "metric", "observer", "prior", "sensors")
_OF_CURVES = (*_POINT, "reflectances")
_NO_ANALYSES = {"outputs": {"analyses": False}}
_SWEEP = {"vary": "lux", "first": 0.01, "last": 1000.0}
_DECLARED = {
    "analyze": _Function(
        keys=(*_OF_CURVES, "outputs"),
        without=("outputs.pareto",),
        arguments=("matrix",),
        start={"outputs": {"budget": False}},
    ),
    "compare": _Function(
        keys=(*_OF_CURVES, "sweeps"),
        without=("sweeps.0.second",),
        arguments=("matrices",),
        start={**_NO_ANALYSES, "sweeps": [_SWEEP]},
    ),
    "compare_map": _Function(
        keys=(*_OF_CURVES, "sweeps"),
        without=("sweeps.0.all_priors",),
        arguments=("matrices",),
        start={
            **_NO_ANALYSES,
            "sweeps": [_SWEEP | {"second": {"vary": "f-number", "first": 1.4, "last": 8.0}}],
        },
    ),
    "denoise": _Function(
        keys=(*_POINT, *(f"pictures.0.{name}" for name in _OF_RAW)),
        without=("sensors.*.mosaic",),
        arguments=(
            *("picture", "sensor", "denoise", "matrix", "unit", "shape", "stored"),
            *("white_level", "threads"),
        ),
        start={**_NO_ANALYSES, "pictures": [{"mosaic": "sensor"}]},
    ),
    "matrix": _Function(
        keys=(*_OF_CURVES, "outputs.pareto"),
        arguments=("sensor", "matrix"),
        start={"outputs": {"analyses": False, "matrix": True}},
    ),
    "render": _Function(
        keys=(*_POINT, "seed", "pictures"),
        without=("sensors.*.mosaic",),
        arguments=("cube", "matrix", "folder"),
        start=_NO_ANALYSES,
    ),
    "sensitivity": _Function(
        keys=_OF_CURVES,
        arguments=(
            *("sensor", "matrix", "objectives", "losses", "tolerance_nm", "tolerance_percent"),
            *("draws", "seed", "keep_matrix"),
        ),
        start=_NO_ANALYSES,
    ),
}
FUNCTIONS: Mapping[str, Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {name: one.settings() for name, one in _DECLARED.items()}
)
"""Keys of a study by the settings of each function of ``import chromanoise as cn``."""
_ANY = {name: keys for one in _DECLARED for name, keys in FUNCTIONS[one].items()}


def interface_of(name: str) -> Interface:
    """How interfaces offer a setting of any function.

    Parameters
    ----------
    name
        Its flat name; for another name an `Interface` without entries.

    Examples
    --------
    >>> interface_of("formats").option
    'format'
    """
    found = KEYS[_ANY[name][0]].interface if name in _ANY else None
    return found or Interface()


def flags_of(name: str) -> Mapping[str, str]:
    """The options of a setting by its values; empty where its option takes a value.

    Parameters
    ----------
    name
        Its flat name.

    Examples
    --------
    >>> flags_of("per")
    {'photon': '--photons', 'energy': '--energy'}
    """
    return dict(interface_of(name).flags)


@dataclass(frozen=True, slots=True, kw_only=True)
class DescribedSetting:
    """A setting of a function, for its docstring and its option.

    Attributes
    ----------
    name
        Name of the argument.
    default
        What the function starts with, else the default of the key.
    of
        Its key.
    """

    name: str
    default: Any
    of: KeyOfStudy

    def __str__(self) -> str:
        """Two lines in numpydoc format."""
        default = "" if self.default is None else f", default {self.default!r}"
        return f"{self.name} : {_type_text(self.of.type)}{default}\n    {self.of.field.description}"


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
    return tuple(
        DescribedSetting(name=name, default=default_of(function, name), of=KEYS[keys[0]])
        for name, keys in FUNCTIONS[function].items()
    )


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
    at: Any = _DECLARED[function].start
    for step in key.split("."):
        at = at[int(step)] if isinstance(at, list) else at.get(step, {})
    if at not in ({}, None):
        return at
    field = KEYS[key].field
    return None if field.is_required() else field.get_default()


def study_of(
    function: str,
    sensors: Sequence[str],
    settings: Settings,
    *,
    matrices: Sequence[str] = (DEFAULT_METHOD,),
    cube: str = "",
) -> Study:
    """The study that a function of Python, or its command, computes.

    Parameters
    ----------
    function
        A name of `FUNCTIONS`, e.g. ``analyze``.
    sensors
        Names of the catalog, or files; empty for ``denoise`` where only the pixel is known.
    settings
        By the names of ``FUNCTIONS[function]``; ``None`` for the default. In ``compare`` with
        ``prior`` equal to ``all``, the crossovers over all priors are computed too.
    matrices
        Methods of the color matrices, or files.
    cube
        Of ``render``: a built-in cube, or a file.

    Raises
    ------
    InputError
        If a setting is unknown, has no effect, or is a parameter that varies; or if a value cannot
        be used.

    Examples
    --------
    >>> study_of("analyze", ["onyx-rgbw"], {"lux": 3.0}).light.level_lux
    3.0
    """
    _refuse_unknown(settings, function)
    names = FUNCTIONS[function]
    data = deepcopy(dict(_DECLARED[function].start)) | {
        "sensors": [{"name": name} for name in sensors],
        "matrices": [name.strip() for name in matrices],
    }
    given = dict(settings)
    if "all_priors" in names and given.get("prior") == "all":
        given |= {"prior": None, "all_priors": True}
    if function == "render":
        data["pictures"] = [{"cube": cube}]
    for name, value in given.items():
        for key in names[name] if value is not None else ():
            places = _places(key, len(sensors))
            each = interface_of(name).each
            values = _one_each(name, value, sensors) if each else [value] * len(places)
            for place, one in zip(places, values, strict=True):
                _put(data, place, one)
    try:
        study = study_from_data(data)
    except InputError as error:
        raise refusal([_called_flat(one, names, {}) for one in errors_in(error)]) from None
    return _with_the_mosaic(study, given) if function == "render" else study


def _with_the_mosaic(study: Study, settings: Settings) -> Study:
    """The study, whose sensors have the mosaic of the picture where crosstalk needs one."""
    mosaic = settings.get("mosaic")
    if settings.get("crosstalk") is None or mosaic in (None, "sensor"):
        return study
    parts = [part.model_copy(update={"mosaic": mosaic}) for part in study.sensors]
    return study.model_copy(update={"sensors": tuple(parts)})


_GENERAL = {"sensors": "sensors.*", "pictures": "pictures.0"}


def argument_of(key: str, names: Mapping[str, tuple[str, ...]]) -> str | None:
    """The flat name of a key of a study; ``None`` if it has none.

    Parameters
    ----------
    key
        A key as in `InputError.setting`, e.g. ``sensors.0.answers.per``.
    names
        The settings to search.

    Examples
    --------
    >>> [argument_of(key, FUNCTIONS["analyze"]) for key in ("sensors.0.answers.per", "title")]
    ['per', None]
    """
    general = re.sub(r"^(sensors|pictures)\.\d+", lambda m: _GENERAL[m[1]], key)
    general = re.sub(r"\.\d+$", "", general)  # an entry of a list
    return next((name for name, keys in names.items() if general in keys), None)


def _one_each(name: str, values: Any, sensors: Sequence[str]) -> list[Any]:
    """The labels of the sensors, in their order; none where it is the sensor's own name."""
    listed = isinstance(values, list | tuple)
    if not listed or len(values) != len(sensors):
        count = len(values) if listed else 1
        raise InputError(
            name,
            f"must have one entry per sensor, {len(sensors)} in all, in their order",
            value=count,
            found=f"has {count}" if listed else f"is {values!r}",
            remedy="repeat the name of a sensor that keeps it",
            setting="sensors.*.label",
        )
    return [
        None if value == shown_word(own) else value
        for value, own in zip(values, sensors, strict=True)
    ]


def in_arguments(error: InputError, function: str) -> InputError:
    """Convert an error of a study to the arguments of the Python function that built the study.

    Parameters
    ----------
    error
        An error whose subject and settings are keys of the study.
    function
        A name of `FUNCTIONS`.

    Examples
    --------
    >>> from chromanoise.errors import Setting
    >>> ends = Setting("sensors.0.beyond", ("zero", "hold"))
    >>> str(in_arguments(InputError("cam.csv", "must reach 1050 nm", remedy=ends), "analyze"))
    "cam.csv must reach 1050 nm; set beyond='zero' or 'hold'"
    """
    positional = {
        "matrices": "matrices" if function in ("compare", "compare_map") else "matrix",
        "sensors": "sensor" if "sensor" in _DECLARED[function].arguments else "sensors",
        "pictures": "cube",
    }
    names = FUNCTIONS[function]

    def translated(one: InputError) -> InputError:
        inside = one.inside(one.setting, lambda key: argument_of(key, names) or key)
        return _called_flat(inside, names, positional)

    return refusal([translated(one) for one in errors_in(error)])


def _called_flat(
    error: InputError, names: Mapping[str, tuple[str, ...]], positional: Mapping[str, str]
) -> InputError:
    """The error with the flat name of the setting as subject, if the subject is the setting."""
    called = argument_of(error.setting, names)
    if re.fullmatch(r"matrices\.\d+|sensors\.\d+\.name|pictures\.\d+\.cube", error.setting):
        called = positional.get(error.setting.partition(".")[0])
    key = error.setting
    own = (key.partition(".")[0], key.rpartition(".")[2])
    return error if called is None or error.subject not in own else error.called(called)


def _refuse_unknown(settings: Settings, function: str) -> None:
    """Refuse names that are no settings of the function, and suggest similar ones."""
    known = [*FUNCTIONS[function], *_DECLARED[function].arguments]
    for name in settings:
        if name in FUNCTIONS[function]:
            continue
        if name == "method":  # as the option is called too
            (matrix,) = (one for one in _DECLARED[function].arguments if one.startswith("matri"))
            raise InputError(
                name, f"is not an argument of {function}", remedy=f"did you mean {matrix}?"
            )
        others = [
            other for other in FUNCTIONS if name in (*FUNCTIONS[other], *_DECLARED[other].arguments)
        ]
        otherwise = f"known: {', '.join(known)}"
        if others:
            otherwise = f"it is one of {' and '.join(others)}"
        remedy = did_you_mean(name, known, otherwise, most=2, cutoff=0.7 if others else 0.6)
        raise InputError(name, f"is not an argument of {function}", remedy=remedy)


def _places(key: str, sensors: int) -> list[list[str | int]]:
    steps: list[str | int] = [int(s) if s.isdigit() else s for s in key.split(".")]
    if "*" not in steps:
        return [steps]
    return [[i if step == "*" else step for step in steps] for i in range(sensors)]


def _put(data: dict[str, Any], place: Sequence[str | int], value: Any) -> None:
    at: Any = data
    for step in place[:-1]:
        at = at[step] if isinstance(step, int) else at.setdefault(step, {})
    at[place[-1]] = value


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
