"""Options that supply what a file of spectra lacks."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any, TypeVar, get_args

import click

from chromanoise.errors import InputError
from chromanoise.io.spectra import Answers
from chromanoise.io.spectra.parsed import Negatives, Unit

Command = TypeVar("Command", bound=Callable[..., Any])

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


def answering(command: Command) -> Command:
    """Add the options that supply what a file of spectra lacks."""
    return _with(command, _ANSWERS)


def of_one_file(command: Command) -> Command:
    """Add the options of a command that reads one file of spectra."""
    return _with(command, _OF_ONE_FILE)


def _with(command: Command, options: Sequence[Callable[[Command], Command]]) -> Command:
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
