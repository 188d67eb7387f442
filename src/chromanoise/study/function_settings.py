"""The settings of commands and functions: flat names of keys of a study, and their conversion.

`FUNCTIONS` lists them, made from the fields of `Study`. `study_of` builds the study from their
values, for the command line and for Python alike. `study_as_command` and `study_as_python` convert
a study to a command line, a Python call or a script.
"""

import hashlib
import json
import re
import shlex
from collections.abc import Mapping, Sequence
from copy import deepcopy
from types import MappingProxyType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from chromanoise.base import InputError, Interface, dataclass, did_you_mean, errors_in, refusal
from chromanoise.study.color_matrices import DEFAULT_METHOD
from chromanoise.study.reading import refuse_objects, study_as_toml, study_from_data
from chromanoise.study.resolve_names import shown_word
from chromanoise.study.schema import KEYS, KeyOfStudy, Study, value_at

Settings = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
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
            for key, keyword in _KEYWORDS.items():
                if _begins(key, beginning) and not any(_begins(key, no) for no in self.without):
                    found[keyword] = (*found.get(keyword, ()), key)
        order = {"pictures": 0, "sensors": 1, "light": 2}
        return MappingProxyType(
            {
                name: tuple(sorted(keys, key=lambda key: order.get(key.partition(".")[0], 0)))
                for name, keys in found.items()
            }
        )


def _begins(key: str, beginning: str) -> bool:
    return key == beginning or key.startswith(f"{beginning}.")


_KEYWORDS = {key: one.keyword for key, one in KEYS.items() if one.keyword is not None}


_OF_RAW = ("mosaic", "demosaic", "bits", "black_level")  # its file may give them, too
_POINT = ("light", "exposure", "metric", "observer", "prior", "sensors")
_OF_CURVES = (*_POINT, "reflectances")
_NO_ANALYSES = {"outputs": {"analyses": False}}
_SWEEP = {"vary": "lux", "first": 0.01, "last": 1000.0}
_OF_CHECKER = [{"cube": "builtin:checker"}]
_DECLARED = {
    "analyze": _Function(
        keys=(*_OF_CURVES, "outputs"),
        without=("outputs.pareto",),
        arguments=("matrix",),
        start={"outputs": {"budget": False}},
    ),
    "card": _Function(
        keys=(*_OF_CURVES, "outputs.reader", "seed"),
        arguments=("matrix", "paper"),
        start={"outputs": {"budget": False}, "pictures": _OF_CHECKER},
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
    "league": _Function(keys=("sensors",), arguments=("iso", "by"), start=_NO_ANALYSES),
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
        Its flat name; for another name an ``Interface`` without entries.

    Examples
    --------
    >>> interface_of("formats").option
    'format'
    """
    found = KEYS[_ANY[name][0]].interface if name in _ANY else None
    return found or Interface()


def flags_of(name: str) -> Mapping[str, str]:
    """The options of a setting by its values; empty where its option takes a value.

    Examples
    --------
    >>> flags_of("per")
    {'photon': '--photons', 'energy': '--energy'}
    """
    return dict(interface_of(name).flags)


@dataclass(frozen=True, kw_only=True)
class DescribedSetting:
    """A setting of a function, for its docstring and its option.

    Attributes
    ----------
    name
        Name of the argument.
    default
        What the function starts with, else the default of the key.
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
    own = value_at(_DECLARED[function].start, key)
    if own is not None:
        return own
    field = KEYS[key].field
    return None if field.required else field.default


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
    >>> from chromanoise.base.errors import Setting
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


_WIDEST = 80
_DIGITS = 8  # of the digest in the name of a folder


@dataclass(frozen=True, kw_only=True)
class Call:
    """A function of Python, or a command, with its arguments.

    Attributes
    ----------
    function
        ``analyze``, ``compare``, ``compare_map`` (the command ``compare``), ``matrix`` or
        ``render`` (the command ``simulate``).
    names
        Sensors, for ``render`` behind the cube.
    matrix
        Names of the color matrices.
    settings
        By flat name, without those at their default.
    """

    function: str
    names: tuple[str, ...]
    matrix: tuple[str, ...]
    settings: Mapping[str, Any]

    def study(self) -> Study:
        """The study of the call.

        Raises
        ------
        InputError
            If the call would be refused.
        """
        cube, *sensors = self.names if self.function == "render" else ("", *self.names)
        return study_of(self.function, sensors, self.settings, matrices=self.matrix, cube=cube)


def call_of(study: Study) -> Call | None:
    """The one call that computes a study; ``None`` if it takes more than one.

    Parameters
    ----------
    study
        Its title, and a seed that nothing draws from, are not considered.

    Examples
    --------
    >>> from chromanoise.study import study_from_data
    >>> study = study_from_data({"sensors": [{"name": "onyx-rgbw"}], "light": {"level_lux": 3.0}},
    ...                         source="")
    >>> call_of(study).settings
    {'lux': 3.0, 'budget': True}
    """
    seed = study.seed if study.pictures else 0
    wanted = study.model_copy(update={"title": "", "seed": seed})
    for function in ("analyze", "compare", "compare_map", "matrix", "render"):
        try:
            call = _candidate(function, wanted)
            if call is not None and call.study() == wanted:
                return call
        except InputError:
            continue
    return None


def study_as_command(study: Study) -> str:
    r"""A shell line that computes the same numbers.

    One of ``analyze``, ``compare``, ``matrix`` and ``simulate`` where one computes all of it;
    otherwise ``chromanoise run`` of the study itself, as a here-document. Results are written into
    a folder named after the study, so that the line runs again, and beside those of other studies.

    Examples
    --------
    >>> from chromanoise.study.reading import study_from_text
    >>> text = '[[sensors]]\nname = "onyx-rgbw"\n[light]\nlevel_lux = 3.0'
    >>> study_as_command(study_from_text(text, source="a text"))
    'chromanoise analyze onyx-rgbw --lux 3.0 --budget'
    """
    refuse_objects(study)
    call = call_of(study)
    if call is None:
        text = study_as_toml(study)
        folder = _folder("study", text)
        # no line of this TOML is the bare word that ends the document
        return f"chromanoise run /dev/stdin --out {folder} <<'STUDY'\n{text}STUDY"
    names = [f"./{name}" if name.startswith("-") else name for name in call.names]
    command = {"render": "simulate", "compare_map": "compare"}.get(call.function, call.function)
    if command == "simulate":
        names = [names[0], *(word for name in call.names[1:] for word in ("--sensor", name))]
    matrix = [] if call.matrix == (DEFAULT_METHOD,) else ["--matrix", ",".join(call.matrix)]
    line = ["chromanoise", command, *names, *_options(call.settings), *matrix]
    if command == "simulate":
        line += ["--out", _folder(command, study_as_toml(study))]
    return shlex.join(line)


def _folder(name: str, text: str) -> str:
    """The folder of the results of a study: another one for another study."""
    return f"out/{name}-{hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]}"


def study_as_python(study: Study) -> str:
    """A script that prints what a run of the study computes: a JSON list, one entry per step.

    Pictures are written into the folder in which it is run.
    """
    refuse_objects(study)
    title = "".join(c if c.isprintable() else " " for c in study.title).strip()
    head = [f"# {title or 'A study of chromanoise'}", "import json", "", "import chromanoise as cn"]
    call = None if study.pictures else call_of(study)
    if call is not None:
        matrix = [] if call.matrix == (DEFAULT_METHOD,) else [_matrix_argument(call)]
        arguments = [_literal(name) for name in call.names]
        arguments += [f"{name}={_literal(value)}" for name, value in call.settings.items()]
        lines = "".join(f"    {one},\n" for one in [*arguments, *matrix])
        made = f"result = cn.{call.function}(\n{lines})"
        printed = "print(json.dumps([result.to_dict()], indent=1))"
    else:
        data = study.model_dump(mode="json", by_alias=True, exclude_defaults=True)
        shown = _literal({"schema": 1} | data)
        folder = ', folder="."' if study.pictures else ""
        made = f"study = cn.study_from_data({shown})\nresults = cn.run(study{folder})"
        printed = "print(json.dumps(results.to_list(), indent=1))"
    return "\n".join([*head, "", made, printed]) + "\n"


def option_of(name: str, value: object = None) -> str:
    """The option of a setting, for flags that of its value.

    Parameters
    ----------
    name
        Name of the setting.
    value
        Value of the setting.

    Examples
    --------
    >>> option_of("time_ms"), option_of("per", "energy"), option_of("formats")
    ('--time-ms', '--energy', '--format')
    """
    flag = flags_of(name).get(str(value))
    option = _REPEATED.get(name) or interface_of(name).option or name
    return flag or f"--{option.replace('_', '-')}"


_REPEATED = {"columns": "column", "sensors": "sensor"}  # no settings of a study


def _candidate(function: str, study: Study) -> Call | None:
    sensors = tuple(sensor.name for sensor in study.sensors)
    if function == "render" and len(study.pictures) != 1:
        return None
    compares = function in ("compare", "compare_map")
    if compares and (
        len(study.sweeps) != 1 or (study.sweeps[0].second is None) != (function == "compare")
    ):
        return None
    if (function == "matrix" and len(sensors) != 1) or (not compares and len(study.matrices) != 1):
        return None
    names = (study.pictures[0].cube, *sensors) if function == "render" else sensors
    base = Call(function=function, names=names, matrix=study.matrices, settings={}).study()
    settings = _settings(study, base, FUNCTIONS[function])
    if settings.pop("all_priors", False):
        settings["prior"] = "all"
    return Call(function=function, names=names, matrix=study.matrices, settings=settings)


def _settings(study: Study, base: Study, names: Mapping[str, tuple[str, ...]]) -> dict[str, Any]:
    """The settings in which a study differs from that of the call without settings."""
    found: dict[str, Any] = {}
    for name, keys in names.items():
        if interface_of(name).each:
            own = [getattr(one, keys[0].rpartition(".")[2]) for one in study.sensors]
            pairs = zip(own, study.sensors, strict=True)
            found |= {name: [value or one.name for value, one in pairs]} if any(own) else {}
            continue
        value = value_at(study, keys[0])
        if value is not None and value != value_at(base, keys[0]):
            found[name] = value
    for start in ("", "second_"):
        ends = [f"{start}{name}" for name in ("vary", "first", "last")]
        if set(ends) & set(found):
            found |= {name: value_at(study, names[name][0]) for name in ends}
    return found


def _matrix_argument(call: Call) -> str:
    if call.function in ("compare", "compare_map"):
        return f"matrices={_literal(call.matrix)}"
    return f"matrix={_literal(call.matrix[0])}"


def _literal(value: Any, indent: str = "") -> str:
    """Plain data as Python, in double quotes; what is too long for a line is broken."""
    if isinstance(value, str):
        text = repr(value)
        if text[0] == '"':
            return text
        return '"' + text[1:-1].replace("\\'", "'").replace('"', '\\"') + '"'
    if not isinstance(value, Mapping | list | tuple):
        return repr(value)
    inner = f"{indent}    "
    if isinstance(value, Mapping):
        ends = "{}"
        parts = [f"{_literal(key)}: {_literal(one, inner)}" for key, one in value.items()]
    else:
        ends, parts = "[]", [_literal(one, inner) for one in value]
    line = f"{ends[0]}{', '.join(parts)}{ends[1]}"
    if len(indent) + len(line) <= _WIDEST and "\n" not in line:
        return line
    lines = "".join(f"{inner}{part},\n" for part in parts)
    return f"{ends[0]}\n{lines}{indent}{ends[1]}"


def _options(settings: Mapping[str, Any]) -> list[str]:
    given = dict(settings)
    words: list[str] = []
    if "vary" in given:
        span = f"{given.pop('vary')}={given.pop('first')!r}:{given.pop('last')!r}"
        words += ["--sweep", span]
    if "second_vary" in given or "second_points" in given:
        name, *ends = (
            given.pop(f"second_{key}", default_of("compare_map", f"second_{key}"))
            for key in ("vary", "first", "last")
        )
        points = given.pop("second_points", None)
        span = f"{name}={ends[0]!r}:{ends[1]!r}"
        words += ["--and", span if points is None else f"{span}:{points}"]
    if "pareto_first" in given:
        points = given.pop("pareto_points", None)
        span = f"{given.pop('pareto_first')!r}:{given.pop('pareto_last')!r}"
        words += ["--pareto", f"{span}:{points}" if points is not None else span]
    for name, value in given.items():
        option = option_of(name, value)
        if interface_of(name).each:
            words += [word for one in value for word in (option, one)]
        elif isinstance(value, Mapping):
            words += [part for key, own in value.items() for part in (option, f"{key}={own}")]
        elif value is True or option in flags_of(name).values():
            words.append(option)
        elif value is not False:
            words += [option, _word(name, value)]
    return words


def _word(name: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        separator = {"shape": "x", "wavelengths": ":"}.get(name, ",")
        return separator.join(str(one) if isinstance(one, str) else repr(one) for one in value)
    return json.dumps(value) if isinstance(value, bool) else repr(value)
