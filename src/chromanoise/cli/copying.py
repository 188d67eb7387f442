"""A command's options as the study that says the same, for ``--copy-as``."""

from typing import Any

import click

from chromanoise.analysis import DEFAULT_PRIOR
from chromanoise.cli.answers import answers_of
from chromanoise.cli.options import refuse_idle_answers, refuse_two_times
from chromanoise.errors import InputError
from chromanoise.study import study_as_python, study_as_toml, study_from_data

Options = dict[str, Any]
Told = dict[str, Any]

_TEXTS = {"python": study_as_python, "toml": study_as_toml}
_UNSAID = {
    "json_target": "--json",
    "table": "--table",
    "export": "--export",
    "threads": "--threads",
    "tile": "--tile",
    "scheduler": "--scheduler",
    "out": "--out",
}


def print_copy(kind: str, told: Told) -> None:
    """Print what was asked as a study or a script; refuse what neither can say.

    Raises
    ------
    InputError
        If an option was given that says nothing of the numbers, or a value cannot be.
    """
    source = click.get_current_context().get_parameter_source
    for name, option in _UNSAID.items():
        if source(name) is click.core.ParameterSource.COMMANDLINE:
            raise InputError(
                f"{option}: a study says what is computed, not where results go or who works; "
                "leave it away with --copy-as"
            )
    click.echo(_TEXTS[kind](study_from_data(told, source="--copy-as")), nl=False)


def analyze_told(options: Options) -> Told:
    """The study of ``analyze``: each sensor has its own time."""
    names = ("clip", "chart", "budget", "merit")
    return _common(options, options["sensors"], [options["method"]], equal="saturation") | {
        "outputs": _given(space=options["space"], **{name: options[name] for name in names}),
    }


def compare_told(options: Options, first: float, last: float) -> Told:
    """The study of ``compare``: one sweep, and no more."""
    every = options["prior"] == "all"
    own = dict(options, prior=DEFAULT_PRIOR if every else options["prior"])
    sweep = {
        "vary": options["sweep"].partition("=")[0],
        "first": first,
        "last": last,
        "points": options["points"],
        "quantity": options["quantity"],
        "all_priors": every,
    }
    matrices = [name.strip() for name in options["matrices"].split(",")]
    return _common(own, options["sensors"], matrices, equal=options["equal"]) | {
        "sweeps": [sweep],
        "outputs": {"analyses": False},
    }


def matrix_told(options: Options, pareto: Told | None) -> Told:
    """The study of ``matrix``."""
    return _common(options, [options["sensor"]], [options["method"]], equal="saturation") | {
        "outputs": _given(analyses=False, matrix=True, pareto=pareto),
    }


def simulate_told(options: Options, **cube: Any) -> Told:
    """The study of ``simulate``: one picture part; ``cube`` says how its file is read."""
    same = ("demosaic", "raw_only", "bits", "black_level", "frames", "clip", "mosaic", "bad_pixels")
    flaws = ("dark_current_e_per_s", "dsnu_e", "prnu", "row_noise_e")
    formats = options["formats"]
    picture = _given(
        beyond=options["beyond"],
        formats=None if formats is None else formats.split(","),
        **cube,
        **{name: options[name] for name in (*same, *flaws)},
    )
    return _common(options, options["sensors"], [options["method"]], equal="saturation") | {
        "seed": options["seed"],
        "pictures": [picture],
        "outputs": {"analyses": False},
    }


def _common(options: Options, names: Any, matrices: list[str], *, equal: str) -> Told:
    """Light, exposure, sensors and matrices."""
    refuse_two_times(options)
    refuse_idle_answers(names, options)
    timed = options["time_ms"] is not None and equal == "saturation"
    answers = answers_of({k: v for k, v in options.items() if k != "quantity"})  # compare's own
    kept = ("scale", "level", "per", "wavelength_unit", "peak_qe")
    pixel = _given(file=options["pixel"], **{name: options[name] for name in _PIXEL})
    sensor = {
        "beyond": options["beyond"],
        "answers": _given(**{name: getattr(answers, name) for name in kept}),
        "negatives": options["negatives"],
        "pixel": pixel,
        **_given(
            filter=options["filter_word"], filter_wavelength_unit=options["filter_wavelength_unit"]
        ),
    }
    per = {None: None, True: "photon", False: "energy"}[options["illuminant_photons"]]
    return {
        "metric": options["metric"],
        "prior": options["prior"],
        "matrices": matrices,
        "light": _given(
            illuminant=options["illuminant"],
            level_lux=options["lux"],
            beyond=options["illuminant_beyond"],
            per=per,
            column=options["illuminant_column"] or None,
            wavelength_unit=options["illuminant_wavelength_unit"],
            negatives=options["negatives"],
        ),
        "exposure": _given(
            equal="exposure" if timed else equal,
            time_ms=options["time_ms"],
            saturate=options["saturate"],
            f_number=options["f_number"],
            magnification=options["magnification"],
        ),
        "sensors": [{"name": name, **sensor} for name in names],
    }


_PIXEL = ("pitch_um", "full_well_e", "read_noise_e")


def _given(**told: Any) -> Told:
    return {key: value for key, value in told.items() if value is not None}
