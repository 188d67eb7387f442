"""Convert a study to a Python call, a script or a command line."""

import hashlib
import json
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from chromanoise.analysis import DEFAULT_METHOD
from chromanoise.errors import InputError
from chromanoise.study.document import Study
from chromanoise.study.settings import FUNCTIONS, default_of, flags_of, interface_of, study_of
from chromanoise.study.toml_text import refuse_objects, study_as_toml

_WIDEST = 80
_DIGITS = 8  # of the digest in the name of a folder


@dataclass(frozen=True, slots=True, kw_only=True)
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
        cube, sensors = ("", self.names) if self.function != "render" else _cut(self.names)
        return study_of(self.function, sensors, self.settings, matrices=self.matrix, cube=cube)


def _cut(names: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    return names[0], names[1:]


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

    Parameters
    ----------
    study
        The study.

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

    Parameters
    ----------
    study
        The study.
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
        value = _value(study, keys[0].replace("*", "0"))
        default = _value(base, keys[0].replace("*", "0"))
        if value is not None and value != default:
            found[name] = value
    for start in ("", "second_"):
        ends = [f"{start}{name}" for name in ("vary", "first", "last")]
        if set(ends) & set(found):
            found |= {name: _value(study, names[name][0]) for name in ends}
    return found


def _value(study: Study, key: str) -> Any:
    at: Any = study
    for step in key.split("."):
        if isinstance(at, tuple):
            at = at[int(step)] if int(step) < len(at) else None
        else:
            at = getattr(at, step, None)
    return at


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
