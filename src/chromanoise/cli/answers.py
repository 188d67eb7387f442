"""Options by which a user answers what a file of spectra cannot tell."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar, get_args

import click

from chromanoise.errors import InputError, Setting
from chromanoise.io.spectra import Answers
from chromanoise.io.spectra.parsed import Negatives, Question, Unit

Command = TypeVar("Command", bound=Callable[..., Any])

_ANSWERS = (
    click.option("--percent/--fraction", default=None, help="Whether 100 or 1 is the whole."),
    click.option("--relative/--absolute", default=None, help="Whether heights mean something."),
    click.option(
        "--photons/--energy", default=None, help="How the curves of the file count light."
    ),
    click.option(
        "--wavelength-unit",
        type=click.Choice(get_args(Unit)),
        help="Unit of the wavelengths, where the file does not declare it.",
    ),
    click.option("--um/--nm", "micrometers", default=None, hidden=True),
    click.option(
        "--negatives",
        type=click.Choice(get_args(Negatives)),
        default="refuse",
        show_default=True,
        help="Small negative values, as digitizing leaves them: refuse them, or set them to 0.",
    ),
    click.option("--peak-qe", type=float, help="Highest QE of a sensor with relative curves."),
)
_OF_ONE_FILE = (
    click.option(
        "--quantity",
        type=click.Choice(["QE", "response", "reflectance", "transmittance", "power"]),
        help="What the curves of the file are.",
    ),
    click.option("--column", "columns", multiple=True, help="Only this curve; may be repeated."),
    click.option(
        "--beyond",
        type=click.Choice(["refuse", "zero", "hold"]),
        default="refuse",
        show_default=True,
        help="What a curve is where others of the file go on.",
    ),
)


def answering(command: Command) -> Command:
    """Add the options that answer what a file of spectra cannot tell."""
    return _with(command, _ANSWERS)


def of_one_file(command: Command) -> Command:
    """Add the options of a command whose subject is one file, whatever it holds."""
    return _with(command, _OF_ONE_FILE)


def options_of(question: Question) -> str:
    """The options of the command line that answer a question of a file."""
    return " or ".join(map(_option, question.settings))


def _option(setting: Setting) -> str:
    values = [str(value) for value in setting.values]
    if setting.name in ("scale", "level", "per"):
        return " or ".join({"photon": "--photons"}.get(value, f"--{value}") for value in values)
    name = {"columns": "column"}.get(setting.name, setting.name)
    return f"--{name.replace('_', '-')} {' or '.join(values)}".rstrip()


def _with(command: Command, options: Sequence[Callable[[Command], Command]]) -> Command:
    for option in reversed(options):
        command = option(command)
    return command


def answers_of(options: Mapping[str, Any]) -> Answers:
    """The answers among the options of a command; an option that it lacks is no answer."""
    return Answers(
        quantity=options.get("quantity"),
        scale=_either(options.get("percent"), "percent", "fraction"),
        level=_either(options.get("relative"), "relative", "absolute"),
        per=_either(options.get("photons"), "photon", "energy"),
        wavelength_unit=_wavelength_unit(options),
        negatives=options.get("negatives", "refuse"),
        beyond=options.get("beyond", "refuse"),
        columns=tuple(options.get("columns", ())),
        peak_qe=options.get("peak_qe"),
    )


def illuminant_answers_of(options: Mapping[str, Any]) -> Answers:
    """The same for the file of the illuminant, which is one curve of power or of photons."""
    column = options.get("illuminant_column")
    return Answers(
        quantity="power",
        per=_either(options.get("illuminant_photons"), "photon", "energy"),
        wavelength_unit=options.get("illuminant_wavelength_unit"),
        negatives=options.get("negatives", "refuse"),
        beyond=options.get("illuminant_beyond", "refuse"),
        columns=(column,) if column else (),
    )


def filter_answers_of(options: Mapping[str, Any]) -> Answers:
    """The same for the file of the filter, which is one curve of transmittance."""
    return Answers(
        quantity="transmittance",
        wavelength_unit=options.get("filter_wavelength_unit"),
        negatives=options.get("negatives", "refuse"),
        beyond=options.get("beyond", "refuse"),
    )


def _wavelength_unit(options: Mapping[str, Any]) -> Any:
    """The unit from ``--wavelength-unit``, or from its older names ``--um`` and ``--nm``."""
    unit = options.get("wavelength_unit")
    older = _either(options.get("micrometers"), "um", "nm")
    if unit and older and unit != older:
        raise InputError(f"--wavelength-unit {unit} and --{older} exclude each other; give one")
    return unit or older


def _either(given: bool | None, yes: Any, no: Any) -> Any:
    return None if given is None else (yes if given else no)
