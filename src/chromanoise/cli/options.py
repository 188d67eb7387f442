"""Options of the settings of a study, made from its keys, and options that commands share."""

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from typing import Any, Literal, TypeVar, get_args, get_origin

import click

from chromanoise.analysis import DEFAULT_METHOD, known_matrices
from chromanoise.catalog.resolve import file_of
from chromanoise.cli.answers import older_units, pair_of, wavelength_unit
from chromanoise.cli.parsing import pair
from chromanoise.errors import InputError
from chromanoise.study import DescribedSetting, described_settings, option_of

Command = TypeVar("Command", bound=Callable[..., Any])


class _WholeNumber(click.ParamType):
    """A whole number, also in the form 1e6."""

    name = "integer"

    def convert(self, value: Any, param: Any, ctx: Any) -> int:
        for read in (int, float):
            with suppress(ValueError, OverflowError):  # not a number; infinite
                if int(read(value)) == read(value):
                    return int(read(value))
        raise InputError(max(param.opts, key=len), "must be a whole number", value=str(value))


WHOLE = _WholeNumber()


class _NumberOrFile(click.ParamType):
    """A number, or else the name of a file."""

    name = "number or file"

    def convert(self, value: Any, param: Any, ctx: Any) -> float | str:
        try:
            return float(value)
        except ValueError:
            return str(value)


class _Numbers(click.ParamType):
    """Numbers separated by commas; with ``or_word``, or else a word."""

    name = "numbers"

    def __init__(self, *, or_word: bool = False) -> None:
        self.or_word = or_word

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        if not isinstance(value, str):
            return value
        try:
            return tuple(float(part) for part in value.split(","))
        except ValueError:
            if self.or_word:
                return value
            option = max(param.opts, key=len)
            raise InputError(option, "must be numbers with commas between", value=value) from None


class _Pair(click.ParamType):
    """Two numbers, whole with ``x`` between them, else with a colon; or else the name of a file."""

    name = "pair"

    def __init__(self, *, whole: bool, or_file: bool) -> None:
        self.whole, self.or_file = whole, or_file

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        option = max(param.opts, key=len)
        try:
            return pair(option, value, *(("x", int) if self.whole else (":", float)))
        except InputError:
            if not self.or_file:
                raise
            if file_of(value).exists():
                return value
            raise InputError(
                option, "must be FIRST:LAST in nm, or a file that lists them", value=value
            ) from None


class _Words(click.ParamType):
    """Words separated by commas."""

    name = "words"

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        return value.split(",") if isinstance(value, str) else value


def _by_channel(_: Any, __: Any, given: tuple[str, ...]) -> dict[str, str] | None:
    """The filters by their channels; ``None`` without one."""
    found: dict[str, str] = {}
    for text in given:
        channel, equals, word = text.partition("=")
        if not equals or not channel or not word:
            raise InputError("--channel-filter", "must be CHANNEL=NAME or CHANNEL=FILE", value=text)
        if channel in found:
            raise InputError("--channel-filter", "must name each channel once", value=channel)
        found[channel] = word
    return found or None


table_option = click.option(
    "--table",
    metavar="FILE",
    help="Write the main table too: FILE.csv, .json, .md or .tex.",
)
copy_option = click.option(
    "--copy-as",
    type=click.Choice(["python", "toml"]),
    help="Compute nothing; print the command as a Python script or as a study file.",
)
matrix_option = click.option(
    "--matrix",
    default=DEFAULT_METHOD,
    show_default=True,
    metavar="NAME[=VALUE]|FILE",
    help=f"Color matrix: {known_matrices()}; or a file: CSV, JSON, CLF, DNG, DCP.",
)


def with_settings(function: str, only: Collection[str] = ()) -> Callable[[Command], Command]:
    """Add an option for each setting of a function, and the defaults to their help.

    An option that the command has written itself, because its form or its meaning differs, takes
    the place of that of the setting.

    Parameters
    ----------
    function
        A name of `FUNCTIONS`, e.g. ``analyze``.
    only
        Names of settings, if not all are options of the command.
    """

    def added(command: Command) -> Command:
        command = command if only else older_units(command)
        parameters: list[click.Parameter] = vars(command)["__click_params__"]
        own = {one.name: one for one in reversed(parameters)}
        listed: list[click.Parameter] = []
        for one in described_settings(function):
            if only and one.name not in only:
                continue
            if one.name in own:
                listed.append(_with_default(own.pop(one.name), one))
            elif one.of.interface is not None and not one.of.interface.part:
                listed.append(_with_default(_option_of(one), one))
        arguments = [one for one in own.values() if isinstance(one, click.Argument)]
        others = [one for one in own.values() if one not in arguments]
        parameters[:] = reversed([*arguments, *listed, *others])
        return command

    return added


def _with_default(option: click.Parameter, one: DescribedSetting) -> click.Parameter:
    shown = getattr(option, "help", None) or ""
    if isinstance(option, click.Option) and "[default:" not in shown and not option.show_default:
        text = f"{one.default:g}" if isinstance(one.default, float) else str(one.default)
        if isinstance(one.default, tuple):
            text = ",".join(f"{number:g}" for number in one.default)
        option.help = shown if one.default in (None, False) else f"{shown} [default: {text}]"
    return option


def _option_of(one: DescribedSetting) -> click.Option:
    """The option of a setting: its name, the form of its value, and its help."""
    interface, kind = one.of.interface, one.of.type
    assert interface is not None
    form: dict[str, Any] = {"help": one.of.field.description, "metavar": interface.metavar}
    names = [option_of(one.name), one.name]
    if interface.flags:
        (yes, first), (no, second) = interface.flags
        form |= {"default": None, "callback": pair_of(yes, no)}
        names[0] = f"{first}/{second}"
    elif kind is bool:  # None where it is not given, so that the default of the study holds
        form |= {"is_flag": True, "default": None}
        names[0] += f"/--no-{names[0].removeprefix('--')}" if one.default else ""
    elif interface.each:
        form |= {"multiple": True, "callback": lambda _, __, given: list(given) or None}
    elif get_origin(kind) is Mapping:
        form |= {"multiple": True, "callback": _by_channel}
    else:
        form["type"] = _type_of(one)
    if one.name == "wavelength_unit":
        form["callback"] = wavelength_unit
    if form.get("multiple"):
        form["help"] += " Repeatable."
    return click.Option(names, **form)


def _type_of(one: DescribedSetting) -> click.ParamType | type:
    kind, kinds = one.of.type, _kinds(one.of.type)
    if get_origin(kind) is Literal:
        return click.Choice(get_args(kind))
    if get_origin(kind) is Sequence and str in kinds:
        return _Words()
    if one.of.names and not one.of.others:
        return click.Choice(one.of.names)
    if any(get_origin(part) is Sequence for part in (kind, *get_args(kind))):
        return _Numbers(or_word=str in kinds)
    if any(get_origin(part) is tuple for part in (kind, *get_args(kind))):
        return _Pair(whole=int in kinds, or_file=str in kinds)
    if float in kinds and str in kinds:
        return _NumberOrFile()
    return WHOLE if kind is int else float if kind is float else str


def _kinds(kind: Any) -> set[Any]:
    """A type with all types inside it."""
    return {kind}.union(*(_kinds(part) for part in get_args(kind)))
