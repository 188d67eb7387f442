"""Options that several commands share, and the nouns they stand for."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, get_args

import click

from chromanoise._check import not_negative, positive, within
from chromanoise.analysis import DEFAULT_PRIOR, PRIORS, known_matrices, trained_names
from chromanoise.catalog import idle_answers, sensor_with_pixel
from chromanoise.catalog.resolve import behind_filter_of_word, illuminant_of_word, is_file_word
from chromanoise.cli.answers import answering, answers_of, filter_answers_of, illuminant_answers_of
from chromanoise.errors import InputError
from chromanoise.exposure import Exposure, saturating_exposure
from chromanoise.io.spectra import Answers
from chromanoise.io.spectra.parsed import Unit
from chromanoise.scene import Scene, flat_field
from chromanoise.sensor import Sensor
from chromanoise.spectra import METRICS, Illuminant, infrared_parts
from chromanoise.study import MOST_SENSORS

Command = TypeVar("Command", bound=Callable[..., Any])


class _WholeNumber(click.ParamType):
    """A whole number, also in the form 1e6."""

    name = "integer"

    def convert(self, value: Any, param: Any, ctx: Any) -> int:
        for read in (int, float):
            with suppress(ValueError, OverflowError):  # not a number; infinite
                if int(read(value)) == read(value):
                    return int(read(value))
        raise click.BadParameter(f"{str(value)[:80]!r} is not a whole number.", ctx, param)


WHOLE = _WholeNumber()

_SHARED = (
    click.option(
        "--illuminant",
        default="E",
        show_default=True,
        help="E, A, G173 (daylight to 1050 nm), D65 and other CIE names, halogen, led-white, "
        "3200K, LED660, A+0.5xLED850 (an infrared diode beside it), a file of one curve "
        "(any format of `chromanoise inspect`), or another of `chromanoise catalog illuminants`.",
    ),
    click.option("--lux", type=float, default=10.0, show_default=True, help="Illuminance [lx]."),
    click.option("--time-ms", type=float, help="Integration time [ms], the same for all sensors."),
    click.option(
        "--saturate",
        type=float,
        help="Solve each sensor's time instead: share of full well that its most sensitive "
        "channel reaches on a perfect white. [default: 0.99]",
    ),
    click.option("--f-number", type=float, default=1.8, show_default=True, help="Aperture f/#."),
    click.option(
        "--metric",
        type=click.Choice(METRICS),
        default="quanta",
        show_default=True,
        help="In which unit a spectrum is a vector.",
    ),
    click.option(
        "--beyond",
        type=click.Choice(["refuse", "zero", "hold"]),
        default="refuse",
        show_default=True,
        help="What a curve is where its file ends short of 400-1050 nm.",
    ),
    click.option(
        "--illuminant-beyond",
        type=click.Choice(["refuse", "zero", "hold"]),
        default="refuse",
        show_default=True,
        help="The same for the illuminant: CIE tables end at 780 nm.",
    ),
    click.option(
        "--illuminant-photons/--illuminant-energy",
        default=None,
        help="How the illuminant's file counts light, where it does not say.",
    ),
    click.option("--illuminant-column", help="Which curve of its file is the illuminant."),
    click.option(
        "--illuminant-wavelength-unit",
        type=click.Choice(get_args(Unit)),
        help="Unit of the wavelengths in the illuminant's file, where it does not declare it.",
    ),
    click.option(
        "--magnification",
        type=float,
        help="Take the camera equation 1/(1 + 4 f#^2 (1 + |m|)^2) instead of the paper's distant "
        "scene, 1/(4 f#^2).",
    ),
    click.option(
        "--filter",
        "filter_word",
        metavar="NAME|FILE",
        help="In front of all sensors: ircut-650, ircut-650/20, ircut-schott, another of "
        "`chromanoise catalog filters`, or a file of one transmittance (any format of `chromanoise "
        "inspect`).",
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
        "values that the file lacks stay the sensor's own; options such as the three below "
        "override it.",
    ),
    click.option("--pitch-um", type=float, help="Pixel pitch [um] instead of the sensor's own."),
    click.option("--full-well-e", type=float, help="Full well [e-] instead of the sensor's own."),
    click.option("--read-noise-e", type=float, help="Read noise [e-] instead of the sensor's own."),
)


json_option = click.option(
    "--json", "json_target", metavar="FILE|-", help="Write JSON; - for standard output."
)
table_option = click.option(
    "--table",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Write the main table too: FILE.csv, .json, .md or .tex.",
)
copy_option = click.option(
    "--copy-as",
    type=click.Choice(["python", "toml"]),
    help="Compute nothing: print the same as a script on the library, or as a study.",
)
prior_option = click.option(
    "--prior",
    type=click.Choice(list(PRIORS)),
    default=DEFAULT_PRIOR,
    show_default=True,
    help="What a trained matrix is trained on.",
)
matrix_option = click.option(
    "--matrix",
    "method",
    default="kernel",
    show_default=True,
    metavar="NAME[=VALUE]",
    help=f"Color matrix: {known_matrices()}.",
)


def sensor_and_light(command: Command) -> Command:
    """Add the options that say which light, which exposure, which pixel."""
    command = answering(command)
    for option in reversed(_SHARED):
        command = option(command)
    return command


LENS = ("saturate", "f_number", "magnification")
EXPOSURE = ("time_ms", *LENS)
PIXEL = ("pixel", "pitch_um", "full_well_e", "read_noise_e")


def only(options: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any]:
    """The options of these names."""
    return {name: options[name] for name in names}


def the_sensor(
    name: str,
    *,
    answers: Answers,
    pixel: str | None,
    pitch_um: float | None,
    full_well_e: float | None,
    read_noise_e: float | None,
) -> Sensor:
    """A catalogue sensor or a file of curves, with the pixel that the options ask for."""
    given = {"pitch_um": pitch_um, "full_well_e": full_well_e, "read_noise_e": read_noise_e}
    for key, value in given.items():
        if value is not None:
            check = not_negative if key == "read_noise_e" else positive
            check(f"--{key.replace('_', '-')}", key.rpartition("_")[2].replace("e", "e-"), value)
    return sensor_with_pixel(name, answers=answers, file=pixel, **given)


def the_illuminant(name: str, *, answers: Answers) -> Illuminant:
    """An illuminant by name or from a file of one curve."""
    return illuminant_of_word(name, answers=answers)


def the_light(options: dict[str, Any]) -> tuple[Illuminant, Scene]:
    """The illuminant that the options ask for, and a perfect white in it."""
    _refuse_idle_illuminant(options)
    illuminant = the_illuminant(options["illuminant"], answers=illuminant_answers_of(options))
    return illuminant, the_white(illuminant, options["lux"])


def the_sensors(names: tuple[str, ...], options: dict[str, Any]) -> list[Sensor]:
    """Sensors by name or from files, with the pixel that the options ask for."""
    if len(names) > MOST_SENSORS:
        raise InputError(
            f"{len(names)} sensors are too many: a run takes at most {MOST_SENSORS}; split them"
        )
    refuse_idle_answers(names, options)
    answers, word = answers_of(options), options["filter_word"]
    bare = [the_sensor(name, answers=answers, **only(options, PIXEL)) for name in names]
    _refuse_idle_filter_unit(options)
    if word is None:
        return bare
    return [
        behind_filter_of_word(sensor, word, answers=filter_answers_of(options)) for sensor in bare
    ]


_WORDS = {"photon": "photons"}  # answers whose option has another name


def refuse_idle_answers(names: Sequence[str], options: dict[str, Any]) -> None:
    """An answer that none of the sensors asks for was meant to change something."""
    answers = answers_of({key: value for key, value in options.items() if key != "quantity"})
    idle = idle_answers(names, answers)
    if idle:
        whole = ("peak_qe", "wavelength_unit")
        words = [
            name.replace("_", "-") if name in whole else getattr(answers, name) for name in idle
        ]
        told = " and ".join(f"--{_WORDS.get(word, word)}" for word in words)
        raise InputError(
            f"{told}: nothing of {', '.join(names)} asks for that, so it would change nothing; "
            "leave it away"
        )


def _refuse_idle_illuminant(options: dict[str, Any]) -> None:
    """What only a file of a light can need."""
    word, photons = options["illuminant"], options["illuminant_photons"]
    parts = infrared_parts(word)
    if is_file_word(word if parts is None else parts[0], "light"):
        return
    given = {True: ["--illuminant-photons"], False: ["--illuminant-energy"]}.get(photons, [])
    given += ["--illuminant-column"] if options["illuminant_column"] else []
    given += ["--illuminant-wavelength-unit"] if options["illuminant_wavelength_unit"] else []
    if given:
        raise InputError(
            f"{' and '.join(given)}: only a file of a light needs that, but {word} is a name; "
            "leave it away"
        )


def _refuse_idle_filter_unit(options: dict[str, Any]) -> None:
    word = options["filter_word"]
    if options["filter_wavelength_unit"] and (word is None or not is_file_word(word, "filter")):
        raise InputError(
            "--filter-wavelength-unit: applies only to a filter from a file; name a file with "
            "--filter, or omit it"
        )


def the_white(illuminant: Illuminant, lux: float) -> Scene:
    """A perfect white in that light."""
    level_lux = within("--lux", "lx", positive("--lux", "lx", lux), 1e-15, 1e15)
    return flat_field(illuminant, level_lux=level_lux)


def the_exposure(
    scene: Scene,
    sensor: Sensor,
    *,
    time_ms: float | None,
    saturate: float | None,
    f_number: float,
    magnification: float | None,
) -> Exposure:
    """The time that is given, or the one that fills the well to the share that is asked for."""
    refuse_two_times({"time_ms": time_ms, "saturate": saturate})
    lens = the_lens(f_number=f_number, magnification=magnification, saturate=saturate)
    if time_ms is None:
        return saturating_exposure(scene, sensor, **lens)
    time_s = 1e-3 * within("--time-ms", "ms", positive("--time-ms", "ms", time_ms), 1e-12, 1e15)
    return Exposure(time_s=time_s, f_number=f_number, magnification=magnification)


def refuse_two_times(options: dict[str, Any]) -> None:
    """A time that is given is not solved as well."""
    if options["time_ms"] is not None and options["saturate"] is not None:
        raise InputError("--time-ms and --saturate exclude each other; give one of them")


def the_lens(
    *, f_number: float, magnification: float | None, saturate: float | None
) -> dict[str, Any]:
    """Aperture and share of full well, as the rules of `chromanoise.exposure` take them."""
    within("--f-number", "1", positive("--f-number", "1", f_number), 1e-2, 1e6)
    share = 0.99 if saturate is None else within("--saturate", "of full well", saturate, 1e-9, 1.0)
    return {"f_number": f_number, "share": share, "magnification": magnification}


def refuse_idle_prior(names: Sequence[str]) -> None:
    """A prior that is given for matrices that look at none would be silence."""
    source = click.get_current_context().get_parameter_source("prior")
    if source is click.core.ParameterSource.COMMANDLINE and not trained_names(names):
        raise InputError(
            f"--prior is of trained matrices, as lmmse, but --matrix asks for {', '.join(names)}"
        )
