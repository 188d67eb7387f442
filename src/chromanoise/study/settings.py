"""One flat name per setting of a study, as commands and functions take them.

`analyze_study` and its siblings are the only place where such settings become a study, so that the
command line and Python cannot differ.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from chromanoise._check import one_of
from chromanoise.analysis import trained_names
from chromanoise.analysis.comparison.sweeps import SWEEPS
from chromanoise.analysis.priors import DEFAULT_PRIOR
from chromanoise.errors import InputError, Setting
from chromanoise.study.document import Study
from chromanoise.study.reading import study_from_data

Settings = Mapping[str, Any]

_SENSOR = "sensors.*"
SHARED: Mapping[str, tuple[str, ...]] = {
    "illuminant": ("light.illuminant",),
    "lux": ("light.level_lux",),
    "illuminant_beyond": ("light.beyond",),
    "illuminant_per": ("light.per",),
    "illuminant_column": ("light.column",),
    "illuminant_wavelength_unit": ("light.wavelength_unit",),
    "equal": ("exposure.equal",),
    "time_ms": ("exposure.time_ms",),
    "saturate": ("exposure.saturate",),
    "f_number": ("exposure.f_number",),
    "magnification": ("exposure.magnification",),
    "metric": ("metric",),
    "prior": ("prior",),
    "beyond": (f"{_SENSOR}.beyond",),
    "negatives": (f"{_SENSOR}.negatives", "light.negatives"),
    "qe_scale": (f"{_SENSOR}.answers.scale",),
    "level": (f"{_SENSOR}.answers.level",),
    "per": (f"{_SENSOR}.answers.per",),
    "wavelength_unit": (f"{_SENSOR}.answers.wavelength_unit",),
    "peak_qe": (f"{_SENSOR}.answers.peak_qe",),
    "pixel": (f"{_SENSOR}.pixel.file",),
    "pitch_um": (f"{_SENSOR}.pixel.pitch_um",),
    "full_well_e": (f"{_SENSOR}.pixel.full_well_e",),
    "read_noise_e": (f"{_SENSOR}.pixel.read_noise_e",),
    "filter": (f"{_SENSOR}.filter",),
    "filter_wavelength_unit": (f"{_SENSOR}.filter_wavelength_unit",),
}
"""Settings of light, exposure and sensors, each with its keys in a study."""

ANALYSIS: Mapping[str, tuple[str, ...]] = {
    name: (f"outputs.{name}",) for name in ("clip", "chart", "budget", "merit", "space")
}
"""Settings of an analysis."""

SWEEP: Mapping[str, tuple[str, ...]] = {
    name: (f"sweeps.0.{name}",)
    for name in ("vary", "first", "last", "points", "quantity", "all_priors")
}
"""Settings of a comparison."""

PARETO: Mapping[str, tuple[str, ...]] = {
    f"pareto_{name}": (f"outputs.pareto.{name}",) for name in ("first", "last", "points")
}
"""Settings of the curve of color error against noise."""

PICTURE: Mapping[str, tuple[str, ...]] = {
    "seed": ("seed",),
    "beyond": ("pictures.0.beyond", f"{_SENSOR}.beyond"),
    **{
        name: (f"pictures.0.{name}",)
        for name in (
            *("key", "shape", "wavelengths", "scale", "bad_pixels", "mosaic", "demosaic"),
            *("raw_only", "bits", "black_level", "frames", "formats", "clip"),
            *("dark_current_e_per_s", "dsnu_e", "prnu", "row_noise_e"),
        )
    },
}
"""Settings of pictures; ``scale`` is that of the cube."""

RENDERING: Mapping[str, tuple[str, ...]] = {**SHARED, **PICTURE}


def analyze_study(sensors: Sequence[str], settings: Settings, *, matrix: str = "kernel") -> Study:
    """The study of one analysis: every stage of each sensor with one color matrix.

    Parameters
    ----------
    sensors
        Names of the catalog, or files.
    settings
        By the names of `SHARED` and `ANALYSIS`; ``None`` for the default.
    matrix
        Its method.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    _refuse_idle_prior(settings, [matrix])
    data = {"outputs": {"budget": False}, "matrices": [matrix]}
    return _study(sensors, settings, {**SHARED, **ANALYSIS}, data)


def compare_study(
    sensors: Sequence[str], settings: Settings, *, matrices: Sequence[str] = ("kernel",)
) -> Study:
    """The study of one comparison: a quantity of all sensors while one thing varies.

    Parameters
    ----------
    sensors
        Names of the catalog, or files.
    settings
        By the names of `SHARED` and `SWEEP`; a ``prior`` of ``all`` asks for the crossovers over
        all priors.
    matrices
        Their methods.

    Raises
    ------
    InputError
        If a value cannot be used, has no effect, or is what varies.
    """
    vary = one_of("vary", str(settings.get("vary") or "lux"), tuple(SWEEPS))
    for name in {"time-ms": ("time_ms",), "read-noise-e": ("read_noise_e",)}.get(vary, ()):
        if settings.get(name) is not None:
            raise InputError(
                name,
                "must not be given where it varies",
                value=settings[name],
                remedy=("omit it", Setting("vary")),
                setting=SHARED[name][0],
            )
    matrices = [name.strip() for name in matrices]
    _refuse_idle_prior(settings, matrices)
    if settings.get("prior") == "all":
        settings = {**settings, "prior": DEFAULT_PRIOR, "all_priors": True}
    data = {
        "outputs": {"analyses": False},
        "matrices": matrices,
        "sweeps": [{"vary": "lux", "first": 0.01, "last": 1000.0}],
    }
    return _study(sensors, settings, {**SHARED, **SWEEP}, data)


def matrix_study(sensor: str, settings: Settings, *, matrix: str = "kernel") -> Study:
    """The study of one color matrix.

    Parameters
    ----------
    sensor
        Name of the catalog, or file.
    settings
        By the names of `SHARED` and `PARETO`.
    matrix
        Its method.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    if settings.get("pareto_first") is None:  # the curve is trained, whatever the matrix
        _refuse_idle_prior(settings, [matrix])
    data = {"outputs": {"analyses": False, "matrix": True}, "matrices": [matrix]}
    return _study([sensor], settings, {**SHARED, **PARETO}, data)


def render_study(
    cube: str, sensors: Sequence[str], settings: Settings, *, matrix: str = "kernel"
) -> Study:
    """The study of the pictures of one cube.

    Parameters
    ----------
    cube
        A built-in cube, or a file.
    sensors
        Names of the catalog, or files.
    settings
        By the names of `RENDERING`.
    matrix
        Its method.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    data = {
        "outputs": {"analyses": False},
        "matrices": [matrix],
        "pictures": [{"cube": cube}],
    }
    return _study(sensors, settings, RENDERING, data)


def argument_of(key: str, names: Mapping[str, tuple[str, ...]] = SHARED) -> str | None:
    """The flat name of a key of a study; ``None`` if it has none.

    Parameters
    ----------
    key
        As an error gives it, ``sensors.0.answers.per``.
    names
        The settings to search.

    Examples
    --------
    >>> argument_of("sensors.0.answers.per"), argument_of("light.per"), argument_of("title")
    ('per', 'illuminant_per', None)
    """
    general = re.sub(r"^sensors\.\d+", _SENSOR, key)
    return next((name for name, keys in names.items() if general in keys), None)


def _study(
    sensors: Sequence[str],
    settings: Settings,
    names: Mapping[str, tuple[str, ...]],
    data: dict[str, Any],
) -> Study:
    data["sensors"] = [{"name": name} for name in sensors]
    for name, value in settings.items():
        keys = names.get(one_of("setting", name, tuple(names)), ())
        for key in keys if value is not None else ():
            for place in _places(key, len(sensors)):
                _put(data, place, value)
    _set_the_rule(data)
    return study_from_data(data, source="")


def _set_the_rule(data: dict[str, Any]) -> None:
    """A time and a rule that solves it exclude each other."""
    rule = data.get("exposure", {})
    if rule.get("time_ms") is not None and rule.get("saturate") is not None:
        raise InputError(
            "time_ms",
            "must not be given beside the share of full well that solves it",
            value=rule["time_ms"],
            remedy=("omit one of them", Setting("exposure.saturate")),
            setting="exposure.time_ms",
        )


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


def _refuse_idle_prior(settings: Settings, matrices: Sequence[str]) -> None:
    """A prior that no matrix uses was meant to change something."""
    prior = settings.get("prior")
    if prior is not None and not trained_names(matrices):
        raise InputError(
            "prior",
            "must be of a trained matrix, as lmmse",
            value=prior,
            found=f"the matrices are {', '.join(matrices)}",
            remedy="omit it",
            setting="prior",
        )
