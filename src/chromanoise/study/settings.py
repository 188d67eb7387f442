"""One flat name per setting of a study, as commands and functions take them.

`analyze_study` and its siblings are the only place where such settings become a study, so that the
command line and Python cannot differ.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Annotated, Any, Literal, TypedDict, get_type_hints

from chromanoise._check import one_of
from chromanoise.analysis import trained_names
from chromanoise.analysis.comparison.sweeps import SWEEPS
from chromanoise.analysis.priors import DEFAULT_PRIOR
from chromanoise.errors import InputError, errors_in
from chromanoise.io.spectra.parsed import Negatives, Unit
from chromanoise.study.assembly import keyed, refusal
from chromanoise.study.document import Study
from chromanoise.study.reading import study_from_data

Settings = Mapping[str, Any]
Extrapolation = Literal["refuse", "zero", "hold"]
Per = Literal["photon", "energy"]


class SharedSettings(TypedDict, total=False):
    """Settings of light, exposure and sensors; each is annotated with its keys in a study."""

    illuminant: Annotated[str, "light.illuminant"]
    lux: Annotated[float, "light.level_lux"]
    illuminant_beyond: Annotated[Extrapolation, "light.beyond"]
    illuminant_per: Annotated[Per, "light.per"]
    illuminant_column: Annotated[str, "light.column"]
    illuminant_wavelength_unit: Annotated[Unit, "light.wavelength_unit"]
    equal: Annotated[Literal["exposure", "saturation", "light"], "exposure.equal"]
    time_ms: Annotated[float, "exposure.time_ms"]
    saturate: Annotated[float, "exposure.saturate"]
    f_number: Annotated[float, "exposure.f_number"]
    magnification: Annotated[float, "exposure.magnification"]
    metric: Annotated[str, "metric"]
    prior: Annotated[str, "prior"]
    beyond: Annotated[Extrapolation, "sensors.*.beyond"]
    negatives: Annotated[Negatives, "sensors.*.negatives", "light.negatives"]
    qe_scale: Annotated[Literal["percent", "fraction"], "sensors.*.answers.scale"]
    level: Annotated[Literal["relative", "absolute"], "sensors.*.answers.level"]
    per: Annotated[Per, "sensors.*.answers.per"]
    wavelength_unit: Annotated[Unit, "sensors.*.answers.wavelength_unit"]
    peak_qe: Annotated[float, "sensors.*.answers.peak_qe"]
    pixel: Annotated[str, "sensors.*.pixel.file"]
    pitch_um: Annotated[float, "sensors.*.pixel.pitch_um"]
    full_well_e: Annotated[float, "sensors.*.pixel.full_well_e"]
    read_noise_e: Annotated[float, "sensors.*.pixel.read_noise_e"]
    filter: Annotated[str, "sensors.*.filter"]
    filter_wavelength_unit: Annotated[Unit, "sensors.*.filter_wavelength_unit"]


class AnalysisSettings(SharedSettings, total=False):
    """Settings of an analysis."""

    clip: Annotated[bool, "outputs.clip"]
    chart: Annotated[bool, "outputs.chart"]
    budget: Annotated[bool, "outputs.budget"]
    merit: Annotated[bool, "outputs.merit"]
    space: Annotated[str, "outputs.space"]


class ComparisonSettings(SharedSettings, total=False):
    """Settings of a comparison."""

    vary: Annotated[str, "sweeps.0.vary"]
    first: Annotated[float, "sweeps.0.first"]
    last: Annotated[float, "sweeps.0.last"]
    points: Annotated[int, "sweeps.0.points"]
    quantity: Annotated[str, "sweeps.0.quantity"]
    all_priors: Annotated[bool, "sweeps.0.all_priors"]


class MatrixSettings(SharedSettings, total=False):
    """Settings of a color matrix, and of its curve of color error against noise."""

    pareto_first: Annotated[float, "outputs.pareto.first"]
    pareto_last: Annotated[float, "outputs.pareto.last"]
    pareto_points: Annotated[int, "outputs.pareto.points"]


class RenderSettings(SharedSettings, total=False):
    """Settings of pictures; ``beyond`` holds for the cube as well, ``scale`` is the cube's."""

    seed: Annotated[int, "seed"]
    beyond: Annotated[Extrapolation, "pictures.0.beyond", "sensors.*.beyond"]
    key: Annotated[str, "pictures.0.key"]
    shape: Annotated[tuple[int, int], "pictures.0.shape"]
    wavelengths: Annotated[tuple[float, float] | str, "pictures.0.wavelengths"]
    scale: Annotated[float, "pictures.0.scale"]
    bad_pixels: Annotated[Literal["refuse", "zero"], "pictures.0.bad_pixels"]
    mosaic: Annotated[str, "pictures.0.mosaic"]
    demosaic: Annotated[str, "pictures.0.demosaic"]
    raw_only: Annotated[bool, "pictures.0.raw_only"]
    bits: Annotated[int, "pictures.0.bits"]
    black_level: Annotated[int, "pictures.0.black_level"]
    frames: Annotated[int, "pictures.0.frames"]
    formats: Annotated[Sequence[str], "pictures.0.formats"]
    clip: Annotated[bool, "pictures.0.clip"]
    dark_current_e_per_s: Annotated[float, "pictures.0.dark_current_e_per_s"]
    dsnu_e: Annotated[float, "pictures.0.dsnu_e"]
    prnu: Annotated[float, "pictures.0.prnu"]
    row_noise_e: Annotated[float, "pictures.0.row_noise_e"]


def settings_keys(kind: type) -> Mapping[str, tuple[str, ...]]:
    """The settings of a kind, each with its keys in a study.

    Parameters
    ----------
    kind
        `SharedSettings` or one of its kind.

    Examples
    --------
    >>> settings_keys(SharedSettings)["lux"]
    ('light.level_lux',)
    """
    hints = get_type_hints(kind, include_extras=True)
    return {name: hint.__metadata__ for name, hint in hints.items()}


SHARED = settings_keys(SharedSettings)
ANALYSIS = settings_keys(AnalysisSettings)
COMPARISON = settings_keys(ComparisonSettings)
MATRIX = settings_keys(MatrixSettings)
RENDERING = settings_keys(RenderSettings)


def analyze_study(sensors: Sequence[str], settings: Settings, *, matrix: str = "kernel") -> Study:
    """The study of one analysis: every stage of each sensor with one color matrix.

    Parameters
    ----------
    sensors
        Names of the catalog, or files.
    settings
        By the names of `AnalysisSettings`; ``None`` for the default.
    matrix
        Its method.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    _refuse_idle_prior(settings, [matrix])
    data = {"outputs": {"budget": False}, "matrices": [matrix]}
    return _study(sensors, settings, ANALYSIS, data)


def compare_study(
    sensors: Sequence[str], settings: Settings, *, matrices: Sequence[str] = ("kernel",)
) -> Study:
    """The study of one comparison: a quantity of all sensors while one thing varies.

    Parameters
    ----------
    sensors
        Names of the catalog, or files.
    settings
        By the names of `ComparisonSettings`; a ``prior`` of ``all`` asks for the crossovers over
        all priors.
    matrices
        Their methods.

    Raises
    ------
    InputError
        If a value cannot be used, has no effect, or is what varies.
    """
    with keyed("sweeps.0.vary"):
        vary = one_of("vary", str(settings.get("vary") or "lux"), tuple(SWEEPS))
    for name in {"time-ms": ("time_ms",), "read-noise-e": ("read_noise_e",)}.get(vary, ()):
        if settings.get(name) is not None:
            raise InputError(
                name,
                "must not be given where it varies",
                value=settings[name],
                found=None,
                remedy="omit it, or vary another thing",
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
    return _study(sensors, settings, COMPARISON, data)


def matrix_study(sensor: str, settings: Settings, *, matrix: str = "kernel") -> Study:
    """The study of one color matrix.

    Parameters
    ----------
    sensor
        Name of the catalog, or file.
    settings
        By the names of `MatrixSettings`.
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
    return _study([sensor], settings, MATRIX, data)


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
        By the names of `RenderSettings`.
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


_GENERAL = {"sensors": "sensors.*", "pictures": "pictures.0"}


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
    general = re.sub(r"^(sensors|pictures)\.\d+", lambda m: _GENERAL[m[1]], key)
    general = re.sub(r"\.\d+$", "", general)  # an entry of a list
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
    _refuse_two_times(data)
    with flat_names(names):
        return study_from_data(data)


@contextmanager
def flat_names(names: Mapping[str, tuple[str, ...]]) -> Iterator[None]:
    """Errors inside call settings by their flat names, in the subject and in the remedy.

    Parameters
    ----------
    names
        The settings to search.
    """
    try:
        yield
    except InputError as error:
        raise refusal([_with_flat_name(one, names) for one in errors_in(error)]) from None


def _with_flat_name(error: InputError, names: Mapping[str, tuple[str, ...]]) -> InputError:
    error = error.inside(error.setting, lambda key: argument_of(key, names) or key)
    flat = argument_of(error.setting, names)
    if re.fullmatch(r"sensors\.\d+\.name", error.setting):
        flat = "sensors"
    elif error.setting.startswith("matrices."):
        flat = "matrices" if names is COMPARISON else "matrix"
    if flat is None or error.subject != error.setting_name:
        return error
    return error.called(flat)


def _refuse_two_times(data: dict[str, Any]) -> None:
    """A time and a rule that solves it exclude each other."""
    rule = data.get("exposure", {})
    if rule.get("time_ms") is not None and rule.get("saturate") is not None:
        raise InputError(
            "time_ms",
            "must not be given with a share of full well, from which the time is solved",
            value=rule["time_ms"],
            found=None,
            remedy="omit one of them",
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
            "must be given only with a trained matrix, as lmmse",
            value=prior,
            found=f"{'the matrix is' if len(matrices) == 1 else 'none is among'} "
            f"{', '.join(matrices)}",
            remedy="omit it",
            setting="prior",
        )
