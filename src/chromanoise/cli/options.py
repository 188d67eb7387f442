"""Options that several commands share; each is a setting of a study with its flat name."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args, get_origin

import click

from chromanoise.analysis import DEFAULT_METHOD, PRIORS, known_matrices
from chromanoise.cli.answers import about_sensors, pair_of
from chromanoise.errors import InputError
from chromanoise.exposure import EQUAL_TERMS
from chromanoise.io.spectra.parsed import Unit
from chromanoise.sensor import MOSAIC_NAMES, PIXEL, BinningMode
from chromanoise.spectra import METRICS
from chromanoise.study import (
    FUNCTIONS,
    OTHER_NAMES,
    DescribedSetting,
    default_of,
    described_settings,
    option_of,
)

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


_SHARED = (
    click.option(
        "--label",
        "labels",
        multiple=True,
        callback=lambda _, __, given: list(given) or None,
        help="Text in place of the name of a sensor in tables and charts; once per sensor, in "
        "their order.",
    ),
    click.option(
        "--illuminant",
        help="E, A, G173 (daylight to 1050 nm), D65 and other CIE names, halogen, led-white, "
        "3200K, LED660, A+0.5xLED850 (with an infrared diode), a file of one curve "
        "(any format of `chromanoise inspect`), or another of `chromanoise catalog illuminants`.",
    ),
    click.option("--lux", type=float, help="Illuminance [lx]."),
    click.option(
        "--equal",
        type=click.Choice(list(EQUAL_TERMS)),
        help="What is equal for all sensors. exposure: the time. saturation: the share of full "
        "well, each with its own time. light: time x pixel area x number of channels, so a "
        "4-channel sensor gets 3/4 of the time of a 3-channel one.",
    ),
    click.option("--time-ms", type=float, help="Exposure time [ms], the same for all sensors."),
    click.option(
        "--saturate",
        type=float,
        help="Share of full well that the most sensitive channel reaches on a perfect white, if "
        "the time is solved.",
    ),
    click.option("--f-number", type=float, help="Aperture f/#."),
    click.option(
        "--metric",
        type=click.Choice(METRICS),
        help="Whether spectra are expressed in photons (quanta) or in energy.",
    ),
    click.option(
        "--beyond",
        type=click.Choice(["refuse", "zero", "hold"]),
        help="Values of a curve where its file does not cover 400-1050 nm.",
    ),
    click.option(
        "--illuminant-beyond",
        type=click.Choice(["refuse", "zero", "hold"]),
        help="The same for the illuminant. CIE tables end at 780 nm or before (D60 at 830 nm); E "
        "and A have no limit.",
    ),
    click.option(
        "--illuminant-photons/--illuminant-energy",
        "illuminant_per",
        default=None,
        callback=pair_of("photon", "energy"),
        help="Whether the illuminant's file is in photons or energy, if it does not declare it.",
    ),
    click.option("--illuminant-column", help="Name of the illuminant's curve in its file."),
    click.option(
        "--illuminant-wavelength-unit",
        type=click.Choice(get_args(Unit)),
        help="Unit of the wavelengths in the illuminant's file, where it does not declare it.",
    ),
    click.option(
        "--magnification",
        type=float,
        help="Use the camera equation 1/(1 + 4 f#^2 (1 + |m|)^2) instead of the paper's distant "
        "scene, 1/(4 f#^2).",
    ),
    click.option(
        "--filter",
        "filter",
        metavar="NAME|FILE",
        help="Filter on all sensors: ircut-650, ircut-650/20, ircut-schott, another of "
        "`chromanoise catalog filters`, or a file of one transmittance (any format of `chromanoise "
        "inspect`).",
    ),
    click.option(
        "--channel-filter",
        "channel_filters",
        multiple=True,
        callback=_by_channel,
        metavar="CHANNEL=NAME|FILE",
        help="Filter on one channel of all sensors, as --filter, e.g. R=ircut-650; repeatable.",
    ),
    click.option(
        "--filter-wavelength-unit",
        type=click.Choice(get_args(Unit)),
        help="Unit of the wavelengths in the filter's file, where it does not declare it.",
    ),
    click.option(
        "--pixel",
        metavar="FILE",
        help="EMVA 1288 sheet, DNG noise profile or photon transfer: the pixel of all sensors; "
        "values that the file lacks stay the sensor's own; options such as --read-noise-e "
        "override it.",
    ),
    *(
        click.option(f"--{name.replace('_', '-')}", type=float, help=one.help)
        for name, one in PIXEL.items()
    ),
    click.option("--gain-dn-per-e", type=float, help="Gain K of the converter [DN/e-]."),
    click.option(
        "--binning",
        type=WHOLE,
        metavar="N",
        help="Pixels of one channel that are summed, e.g. 4 for 2 x 2; the other values stay those "
        "of one pixel.",
    ),
    click.option(
        "--binning-mode",
        type=click.Choice(get_args(BinningMode)),
        help="charge: the sum is read once. digital: each pixel is read, and the readings are "
        "summed. [default: charge]",
    ),
    click.option(
        "--crosstalk",
        type=_NumberOrFile(),
        metavar="SHARE|FILE",
        help="Share of the light of a pixel that ends in its four neighbors (needs a mosaic), or a "
        "file: a table with one row and column per channel, or a kernel of neighbors.",
    ),
    click.option(
        "--crosstalk-stage",
        type=click.Choice(["light", "charge"]),
        help="Crosstalk before counting (light), or after it (charge: interpixel capacitance).",
    ),
)
_OF_CLOSED_FORM = (
    click.option(
        "--bits", type=WHOLE, help="Bits of the converter, which adds quantization noise."
    ),
    click.option(
        "--mosaic",
        metavar="NAME|ROWS",
        help="Color filter array, for crosstalk, --merit and pictures of the sensor's mosaic: "
        f"{', '.join(MOSAIC_NAMES)}, or rows, e.g. "
        "RG/GB or 'Red Yellow; Yellow Blue'; default: that of the sensor.",
    ),
    click.option(
        "--chart-file",
        metavar="FILE",
        help="Reflectances for color error, --chart and total error instead of the ColorChecker "
        "(any format of `chromanoise inspect`); --beyond extends them to 400-1050 nm.",
    ),
    click.option(
        "--patch",
        type=_NumberOrFile(),
        metavar="NUMBER|NAME|FILE[:NAME]",
        help="The patch that is analyzed instead of a perfect white: 0.18, a patch of the "
        "ColorChecker (dark skin), lawn, or a curve of a file.",
    ),
)


_OF_PIPELINE = (
    click.option(
        "--pipeline",
        is_flag=True,
        help="Noise of each ColorChecker patch after each step of the camera's own pipeline: raw, "
        "white-balanced, XYZ, linear sRGB, exposure, saturation, tone, Y'CbCr, Lab; at each ISO "
        "also dynamic range and noise profile. The options below belong to it.",
    ),
    click.option(
        "--white-balance",
        type=_Numbers(or_word=True),
        metavar="gray|illuminant|NAME|R,G,B...",
        help="Gains from an 18 % gray as it is read, from the illuminant, from another illuminant "
        "(D65, 3200K, a file ...), or given, one per channel.",
    ),
    click.option(
        "--white-balance-pixels",
        type=WHOLE,
        help="Also the noise of gains that are estimated from so many gray pixels per channel.",
    ),
    click.option("--exposure-gain", type=float, help="Gain of linear RGB."),
    click.option(
        "--saturation",
        type=float,
        help="Saturation of linear RGB around Rec. 709 luma; 0 is gray.",
    ),
    click.option(
        "--tone",
        type=_NumberOrFile(),
        metavar="srgb|rec709|linear|GAMMA",
        help="Tone curve, or the gamma of a power law, e.g. 2.2.",
    ),
    click.option("--luma", type=click.Choice(["bt709", "bt601"]), help="Weights of Y'CbCr."),
    click.option(
        "--iso",
        type=_Numbers(),
        metavar="LIST",
        help="ISO settings, e.g. 100,400,1600. The analog gain rises with the ISO, and the "
        "exposure falls with it.",
    ),
    click.option("--base-iso", type=float, help="ISO of the sensor as it is given."),
    click.option(
        "--iso-read-noise-e",
        type=_Numbers(),
        metavar="LIST",
        help="Read noise at each ISO [e-]. [default: the same at all]",
    ),
)


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
prior_option = click.option(
    "--prior",
    metavar=f"[{'|'.join(PRIORS)}]|FILE",
    help="Training set of a trained matrix: a name, or a file of reflectances.",
)
matrix_option = click.option(
    "--matrix",
    default=DEFAULT_METHOD,
    show_default=True,
    metavar="NAME[=VALUE]|FILE",
    help=f"Color matrix: {known_matrices()}; or a file: CSV, JSON, CLF, DNG, DCP.",
)


def with_defaults(function: str) -> Callable[[Command], Command]:
    """Add the settings without an option of their own, and the defaults to the help of all.

    Parameters
    ----------
    function
        ``analyze``, ``compare``, ``matrix`` or ``render``.
    """

    def added(command: Command) -> Command:
        parameters: list[click.Parameter] = getattr(command, "__click_params__", [])
        _add_missing(parameters, function)
        for option in parameters:
            if option.name not in FUNCTIONS[function] or "[default:" in (option.help or ""):
                continue
            default = default_of(function, option.name)
            if default not in (None, False):
                text = f"{default:g}" if isinstance(default, float) else str(default)
                if isinstance(default, tuple):
                    text = ",".join(f"{one:g}" for one in default)
                option.help = f"{option.help} [default: {text}]"
        return command

    return added


def _add_missing(parameters: list[click.Parameter], function: str) -> None:
    """Add an option for each setting that has none, after that of the setting before it.

    An option is written by hand, here or in its command, where it has another form than the
    setting, or a longer help.
    """
    places = [one.name for one in parameters]  # the last option first
    at = 0
    for one in described_settings(function):
        if one.name in places:
            at = places.index(one.name)
        elif one.name not in OTHER_NAMES:
            places.insert(at, one.name)
            parameters.insert(at, _option_of(one))


def _option_of(one: DescribedSetting) -> click.Option:
    kind = {int: WHOLE}.get(one.annotation, one.annotation)
    kind = str if str in get_args(one.annotation) else kind  # no object fits in a word
    if get_origin(kind) is Literal:
        kind = click.Choice(get_args(kind))
    form: dict[str, Any] = {"is_flag": True} if kind is bool else {}
    if Path in get_args(one.annotation):
        form["metavar"] = "FILE"
    return click.Option([option_of(one.name)], type=kind, help=one.description, **form)


def shared_options(command: Command) -> Command:
    """Add the options of light, exposure, sensors and their files."""
    command = about_sensors(command)
    for option in reversed(_SHARED):
        command = option(command)
    return command


def pipeline_options(command: Command) -> Command:
    """Add the options of the camera's own pipeline."""
    for option in reversed(_OF_PIPELINE):
        command = option(command)
    return command


def closed_form_options(command: Command) -> Command:
    """Add the options of converter and mosaic to a command without pictures."""
    for option in reversed(_OF_CLOSED_FORM):
        command = option(command)
    return command
