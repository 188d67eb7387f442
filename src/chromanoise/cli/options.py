"""Options of the commands: settings of a study from its keys, and options that commands share.

Among them are the options that supply metadata that a file of spectra lacks. A command refuses an
option that is given twice, and its errors name the option that they refuse.
"""

import re
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args, get_origin

import click

from chromanoise.base import InputError, did_you_mean
from chromanoise.io.spectra import Answers, Negatives, Unit
from chromanoise.study import (
    DEFAULT_METHOD,
    DescribedSetting,
    described_settings,
    file_of,
    known_matrices,
    option_of,
)

Decorated = TypeVar("Decorated", bound=Callable[..., Any])


MOST_COMMON = 15
"""Largest number of options that the short help of a command lists."""
_HEADINGS = (
    *("Sweep", "Picture", "Light", "Exposure", "Sensor", "Pixel", "Files of curves", "Color"),
    *(
        "Reflectances",
        "Results",
        "Pipeline of the camera",
        "Tolerances",
        "Frames",
        "Camera",
        "Output",
    ),
)  # in the order of use; others follow


class Option(click.Option):
    """An option with its place in the help of a command.

    Parameters
    ----------
    declarations, attributes
        As `click.Option`.
    common
        Whether the short help lists it; the long help lists all.
    heading
        The heading that it stands under; empty: that of options without one.
    """

    def __init__(
        self, *declarations: Any, common: bool = True, heading: str = "", **attributes: Any
    ) -> None:
        super().__init__(*declarations, **attributes)
        self.common, self.heading = common, heading


own_option = partial(click.option, cls=Option)
"""A decorator that adds an `Option` that is no setting of a study."""


class RenamedOption(Option):
    """An option that also works by its old name, for one release, with a warning.

    Parameters
    ----------
    declarations, attributes
        As `Option`.
    old
        The old name, e.g. ``--method``.
    """

    def __init__(self, *declarations: Any, old: str, **attributes: Any) -> None:
        super().__init__(*declarations, **attributes)
        self.old = old


class Command(click.Command):
    """A command whose options are given once, except those that may be repeated.

    ``--help`` lists at most `MOST_COMMON` options, the common ones, and ``--help-all`` lists all.
    """

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """The parameters, with those that print the help."""
        return [*super().get_params(ctx), _HELP_ALL]

    def listed_options(self, ctx: click.Context) -> list[click.Parameter]:
        """The options that the help lists: the common ones, or all if they are few or asked for."""
        shown = [one for one in self.get_params(ctx) if _is_shown(one)]
        few = [one for one in shown if one is not _HELP_ALL]
        if len(few) <= MOST_COMMON:
            return few
        whole = bool(ctx.meta.get(_WHOLE_HELP))
        return shown if whole else [one for one in shown if getattr(one, "common", True)]

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options, many under their headings in the order of use."""
        listed = self.listed_options(ctx)
        groups: dict[str, list[tuple[str, str]]] = {one: [] for one in _HEADINGS}
        for one in listed:
            heading = getattr(one, "heading", "") or "Other options"
            record = one.get_help_record(ctx)
            if record is not None:
                groups.setdefault(heading if _HELP_ALL in listed else "Options", []).append(record)
        for heading, rows in groups.items():
            if rows:
                with formatter.section(heading):
                    formatter.write_dl(rows)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write how many options the short help omits."""
        listed = self.listed_options(ctx)
        if _HELP_ALL in listed and not ctx.meta.get(_WHOLE_HELP):
            more = sum(map(_is_shown, self.get_params(ctx))) - len(listed)
            formatter.write_paragraph()
            formatter.write_text(f"{more} more options: {ctx.command_path} --help-all")
        super().format_epilog(ctx, formatter)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments.

        Raises
        ------
        click.UsageError
            If an option is repeated that has one value: click keeps the last one.
        InputError
            If there is no such option, or a value is not a number or not one of the choices.
        """
        try:
            return self._parsed(ctx, self._by_new_names(args))
        except click.NoSuchOption as error:
            known = [name for one in self.params if _is_shown(one) for name in one.opts]
            help_ = f"see `{ctx.command_path} --help`"
            raise InputError(
                error.option_name,
                f"must be an option of `{ctx.command_path}`",
                remedy=did_you_mean(error.option_name, known, help_, most=2, cutoff=0.6),
            ) from None
        except click.BadParameter as error:
            raise _bad_value(error) or error from None

    def _by_new_names(self, args: list[str]) -> list[str]:
        """The arguments with the new names of options; one warning for each old name."""
        new = {one.old: one.opts[0] for one in self.params if isinstance(one, RenamedOption)}
        end = args.index("--") if "--" in args else len(args)
        words = [word.partition("=") for word in args[:end]]
        for old in dict.fromkeys(name for name, _, _ in words if name in new):
            click.echo(
                f"chromanoise: {old} is now {new[old]}; the old name works in this release only",
                err=True,
            )
        named = [new.get(name, name) + equals + value for name, equals, value in words]
        return [*named, *args[end:]]

    def _parsed(self, ctx: click.Context, args: list[str]) -> list[str]:
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        for parameter, count in Counter(order).items():
            once = isinstance(parameter, click.Option) and not parameter.multiple
            if once and not parameter.is_eager and count > 1:
                name = " or ".join((*parameter.opts, *parameter.secondary_opts))
                raise click.UsageError(f"{name} must be given once, but is given {count} times")
        return super().parse_args(ctx, args)


def _is_shown(parameter: click.Parameter) -> bool:
    return isinstance(parameter, click.Option) and not parameter.hidden


def _print_whole_help(ctx: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked and not ctx.resilient_parsing:
        ctx.meta[_WHOLE_HELP] = True
        click.echo(ctx.get_help(), color=ctx.color)
        ctx.exit()


_WHOLE_HELP = "chromanoise.whole_help"
_HELP_ALL = click.Option(
    ["--help-all"],
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_whole_help,
    help="Show this message with all options and exit.",
)


def _bad_value(error: click.BadParameter) -> InputError | None:
    """The error of a value that is no number or no choice; ``None`` for other errors."""
    kind: Any = error.param.type if error.param is not None else None
    quoted = re.match(r"(?s)'(.*)' is not ", error.message)
    if error.param is None or quoted is None:
        return None
    name = max(error.param.opts, key=len) if isinstance(error.param, click.Option) else ""
    name = name or error.param.human_readable_name
    if isinstance(kind, click.Choice):
        choices = [str(one) for one in kind.choices]
        remedy = did_you_mean(quoted[1], choices, "", most=1)
        return InputError(
            name, f"must be {' or '.join(choices)}", value=quoted[1], remedy=remedy or ()
        )
    demand = {click.FLOAT: "a number", click.INT: "a whole number"}.get(kind)
    return None if demand is None else InputError(name, f"must be {demand}", value=quoted[1])


def pair(option: str, text: str | None, separator: str, kind: Any) -> Any:
    """Two numbers with a separator between them; ``None`` for ``None``.

    Raises
    ------
    InputError
        If the text is anything else.
    """
    try:
        return None if text is None else _two(text, separator, kind)
    except ValueError:
        demand = f"must be two numbers with {separator!r} between them"
        raise InputError(option, demand, value=text) from None


def _two(text: str, separator: str, kind: Any) -> tuple[Any, Any]:
    first, second = map(kind, text.split(separator))
    return first, second


command = partial(click.command, cls=Command)


_OLDER_UNIT = "chromanoise.wavelength_unit"


def pair_of(yes: str, no: str) -> Callable[[click.Context, click.Parameter, bool | None], Any]:
    """The value of a pair of flags; ``None`` if none of them is given."""
    return lambda _, __, given: None if given is None else (yes if given else no)


def _keep_older_unit(ctx: click.Context, _: click.Parameter, given: bool | None) -> None:
    ctx.meta[_OLDER_UNIT] = None if given is None else ("um" if given else "nm")


def wavelength_unit(ctx: click.Context, _: click.Parameter, unit: str | None) -> str | None:
    """The unit from ``--wavelength-unit``, or from its older names ``--um`` and ``--nm``."""
    older: str | None = ctx.meta.get(_OLDER_UNIT)
    if unit and older and unit != older:
        raise InputError(
            "--wavelength-unit",
            f"must agree with --{older}",
            value=unit,
            remedy="give one of them",
        )
    return unit or older


older_units = click.option(
    "--um/--nm",
    "older_unit",
    default=None,
    hidden=True,
    is_eager=True,
    expose_value=False,
    callback=_keep_older_unit,
)
_ANSWERS = (
    click.option(
        "--percent/--fraction",
        "scale",
        default=None,
        callback=pair_of("percent", "fraction"),
        help="Whether the values are percent or fractions.",
    ),
    click.option(
        "--relative/--absolute",
        "level",
        default=None,
        callback=pair_of("relative", "absolute"),
        help="Whether the curves are relative or absolute.",
    ),
    click.option(
        "--photons/--energy",
        "per",
        default=None,
        callback=pair_of("photon", "energy"),
        help="Whether the curves are per photon or per energy.",
    ),
    older_units,
    click.option(
        "--wavelength-unit",
        type=click.Choice(get_args(Unit)),
        callback=wavelength_unit,
        help="Unit of the wavelengths, where the file does not declare it.",
    ),
    click.option(
        "--negatives",
        type=click.Choice(get_args(Negatives)),
        help="Small negative values, e.g. from digitizing: refuse them, or set them to 0. "
        f"[default: {Answers().negatives}]",
    ),
    click.option("--peak-qe", type=float, help="Highest QE of a sensor with relative curves."),
)


_OF_ONE_FILE = (
    click.option(
        "--quantity",
        type=click.Choice(["QE", "response", "reflectance", "transmittance", "power"]),
        help="Quantity of the curves in the file.",
    ),
    click.option("--column", "columns", multiple=True, help="Only this curve; may be repeated."),
    click.option(
        "--beyond",
        type=click.Choice(["refuse", "zero", "hold"]),
        help="Values of a curve at wavelengths that only other curves of the file cover. "
        "[default: refuse]",
    ),
)


def answering(command: Decorated) -> Decorated:
    """Add the options that supply what a file of spectra lacks."""
    return _with(command, _ANSWERS)


def of_one_file(command: Decorated) -> Decorated:
    """Add the options of a command that reads one file of spectra."""
    return _with(command, _OF_ONE_FILE)


def _with(command: Decorated, options: Sequence[Callable[[Decorated], Decorated]]) -> Decorated:
    for option in reversed(options):
        command = option(command)
    return command


def answers_of(settings: Mapping[str, Any]) -> Answers:
    """The `Answers` among the settings of a command; omitted options are left out.

    Parameters
    ----------
    settings
        By the fields of `Answers`.
    """
    names = {one.name for one in fields(Answers)}
    given = {k: v for k, v in settings.items() if k in names and v not in (None, ())}
    return Answers(**given)


class _Read(click.ParamType):
    """The type of an option whose text a function reads; what is no text stays as it is.

    Parameters
    ----------
    name
        Shown in the help where the option has no metavar.
    read
        Gives the value of a text, or raises a ValueError.
    demand
        What the text must be, for the error.
    otherwise
        Gives the value of a text that ``read`` refuses, or ``None`` to refuse it.
    """

    def __init__(
        self,
        name: str,
        read: Callable[[str], Any],
        demand: str = "",
        otherwise: Callable[[str], Any] = lambda _: None,
    ) -> None:
        self.name, self.read, self.demand, self.otherwise = name, read, demand, otherwise

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        if not isinstance(value, str):
            return value
        try:
            return self.read(value)
        except (ValueError, OverflowError):  # an infinite number is an OverflowError
            found = self.otherwise(value)
            if found is not None:
                return found
            option = max(param.opts, key=len)
            raise InputError(option, f"must be {self.demand}", value=value) from None


def _whole(text: str) -> int:
    """A whole number, also in the form 1e6."""
    with suppress(ValueError):
        return int(text)
    if int(float(text)) != float(text):
        raise ValueError
    return int(float(text))


def _existing(text: str) -> str | None:
    return text if file_of(text).exists() else None


WHOLE = _Read("integer", _whole, "a whole number")
_NUMBER_OR_FILE = _Read("number or file", float, otherwise=str)
_WORDS = _Read("words", lambda text: text.split(","))


def _numbers(*, or_word: bool) -> _Read:
    """Numbers separated by commas; with ``or_word``, or else a word."""

    def read(text: str) -> tuple[float, ...]:
        return tuple(float(one) for one in text.split(","))

    otherwise: Callable[[str], Any] = str if or_word else lambda _: None
    return _Read("numbers", read, "numbers with commas between", otherwise)


def _pair(*, whole: bool, or_file: bool) -> _Read:
    """Two numbers, whole with ``x`` between them, else with a colon; or else the name of a file."""
    separator, kind = ("x", int) if whole else (":", float)
    read = partial(_two, separator=separator, kind=kind)
    if or_file:
        return _Read("pair", read, "FIRST:LAST in nm, or a file that lists them", _existing)
    return _Read("pair", read, f"two numbers with {separator!r} between them")


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


PATH = click.Path(path_type=Path)
"""The type of a file or folder."""


def out_option(
    text: str, *, heading: str = "Output", **attributes: Any
) -> Callable[[Decorated], Decorated]:
    """The option of where a command writes, ``--out``.

    Parameters
    ----------
    text
        Its help.
    heading
        As of `Option`.
    attributes
        As of `Option`: ``default`` or ``required``.
    """
    attributes |= {"heading": heading, "show_default": True, "help": text}
    return own_option("-o", "--out", type=PATH, **attributes)


threads_option = own_option(
    "--threads",
    type=WHOLE,
    common=False,
    help="Number of threads. [default: one per core]",
)
table_option = own_option(
    "--table",
    metavar="FILE",
    common=False,
    heading="Output",
    help="Write the main table too: FILE.csv, .json, .md or .tex.",
)
copy_option = own_option(
    "--copy-as",
    type=click.Choice(["python", "toml"]),
    common=False,
    heading="Output",
    help="Compute nothing; print the command as a Python script or as a study file.",
)
notes_option = own_option(
    "--notes",
    "whole_notes",
    is_flag=True,
    heading="Output",
    help="Print all notes in full, not one line each.",
)
matrix_option = own_option(
    "--matrix",
    default=DEFAULT_METHOD,
    show_default=True,
    metavar="NAME[=VALUE]|FILE",
    heading="Color",
    help=f"Color matrix: {known_matrices()}; or a file: CSV, JSON, CLF, DNG, DCP.",
)


def with_settings(function: str, only: Collection[str] = ()) -> Callable[[Decorated], Decorated]:
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

    def added(command: Decorated) -> Decorated:
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
    if isinstance(option, Option) and not option.heading:
        option.heading = one.of.heading
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
    form: dict[str, Any] = {
        "help": one.of.field.description,
        "metavar": interface.metavar,
        "common": interface.common,
        "heading": one.of.heading,
    }
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
    return Option(names, **form)


def _type_of(one: DescribedSetting) -> click.ParamType | type:
    kind, kinds = one.of.type, _kinds(one.of.type)
    if get_origin(kind) is Literal:
        return click.Choice(get_args(kind))
    if get_origin(kind) is Sequence and str in kinds:
        return _WORDS
    if one.of.names and not one.of.others:
        return click.Choice(one.of.names)
    if any(get_origin(part) is Sequence for part in (kind, *get_args(kind))):
        return _numbers(or_word=str in kinds)
    if any(get_origin(part) is tuple for part in (kind, *get_args(kind))):
        return _pair(whole=int in kinds, or_file=str in kinds)
    if float in kinds and str in kinds:
        return _NUMBER_OR_FILE
    return WHOLE if kind is int else float if kind is float else str


def _kinds(kind: Any) -> set[Any]:
    """A type with all types inside it."""
    return {kind}.union(*(_kinds(part) for part in get_args(kind)))
