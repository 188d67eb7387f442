"""The settings of commands and functions: one flat name per key of a study.

`analyze_study`, `compare_study`, `matrix_study` and `render_study` build the study from such
settings, for the command line and for Python alike.
"""

import re
from collections.abc import Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Annotated, Any, Literal, TypedDict, get_type_hints

from chromanoise.analysis import DEFAULT_METHOD
from chromanoise.catalog.objects import shown_word
from chromanoise.errors import InputError, did_you_mean, errors_in, refusal
from chromanoise.io.spectra.parsed import Negatives, Unit
from chromanoise.sensor import PIXEL, PixelSettings
from chromanoise.spectra import Illuminant
from chromanoise.study.document import Study
from chromanoise.study.reading import study_from_data

Settings = Mapping[str, Any]
Extrapolation = Literal["refuse", "zero", "hold"]
Per = Literal["photon", "energy"]


class _BeforePixel(TypedDict, total=False):
    illuminant: Annotated[str | Path | Illuminant | object, "light.illuminant"]
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
    observer: Annotated[str | object, "observer"]
    prior: Annotated[str | Path | object, "prior"]
    labels: Annotated[Sequence[str], "sensors.*.label"]
    beyond: Annotated[Extrapolation, "sensors.*.beyond"]
    negatives: Annotated[Negatives, "sensors.*.negatives", "light.negatives"]
    qe_scale: Annotated[Literal["percent", "fraction"], "sensors.*.answers.scale"]
    level: Annotated[Literal["relative", "absolute"], "sensors.*.answers.level"]
    per: Annotated[Per, "sensors.*.answers.per"]
    wavelength_unit: Annotated[Unit, "sensors.*.answers.wavelength_unit"]
    peak_qe: Annotated[float, "sensors.*.answers.peak_qe"]
    pixel: Annotated[str | Path, "sensors.*.pixel.file"]


class SharedSettings(_BeforePixel, PixelSettings, total=False):
    """Settings of light, exposure and sensors.

    Each is annotated with its keys in a study, or else with the property of the pixel that it is.
    """

    bits: Annotated[int, "sensors.*.pixel.bits"]
    gain_dn_per_e: Annotated[float, "sensors.*.pixel.gain_dn_per_e"]
    binning: Annotated[int, "sensors.*.pixel.binning"]
    binning_mode: Annotated[Literal["charge", "digital"], "sensors.*.pixel.binning_mode"]
    crosstalk: Annotated[float | str | Path, "sensors.*.crosstalk"]
    crosstalk_stage: Annotated[Literal["light", "charge"], "sensors.*.crosstalk_stage"]
    mosaic: Annotated[str, "sensors.*.mosaic"]
    filter: Annotated[str | Path | object, "sensors.*.filter"]
    channel_filters: Annotated[Mapping[str, str | Path | object], "sensors.*.channel_filters"]
    filter_wavelength_unit: Annotated[Unit, "sensors.*.filter_wavelength_unit"]
    shift_ircut_nm: Annotated[float, "sensors.*.shift_ircut_nm"]
    ircut_nm: Annotated[float, "sensors.*.ircut_nm"]
    shift_nm: Annotated[float, "sensors.*.shift_nm"]


class _ReflectanceSettings(SharedSettings, total=False):
    """Settings of own reflectances, which pictures do not use."""

    chart_file: Annotated[str | Path | object, "reflectances.chart"]
    patch: Annotated[float | str | Path | object, "reflectances.patch"]
    pairs: Annotated[str | Path | object, "reflectances.pairs"]
    reflectance_scale: Annotated[Literal["percent", "fraction"], "reflectances.scale"]
    reflectance_wavelength_unit: Annotated[Unit, "reflectances.wavelength_unit"]
    reflectance_beyond: Annotated[Extrapolation, "reflectances.beyond"]


class AnalysisSettings(_ReflectanceSettings, total=False):
    """Settings of an analysis."""

    clip: Annotated[bool, "outputs.clip"]
    chart: Annotated[bool, "outputs.chart"]
    budget: Annotated[bool, "outputs.budget"]
    merit: Annotated[bool, "outputs.merit"]
    space: Annotated[str, "outputs.space"]
    reader: Annotated[Literal["eye", "machine"], "outputs.reader"]
    pipeline: Annotated[bool, "outputs.pipeline.run"]
    white_balance: Annotated[str | Sequence[float], "outputs.pipeline.white_balance"]
    white_balance_pixels: Annotated[int, "outputs.pipeline.white_balance_pixels"]
    exposure_gain: Annotated[float, "outputs.pipeline.exposure_gain"]
    saturation: Annotated[float, "outputs.pipeline.saturation"]
    tone: Annotated[str | float, "outputs.pipeline.tone"]
    luma: Annotated[Literal["bt709", "bt601"], "outputs.pipeline.luma"]
    iso: Annotated[Sequence[float], "outputs.pipeline.iso"]
    base_iso: Annotated[float, "outputs.pipeline.base_iso"]
    iso_read_noise_e: Annotated[Sequence[float], "outputs.pipeline.iso_read_noise_e"]


class SweepSettings(_ReflectanceSettings, total=False):
    """Settings of a sweep."""

    vary: Annotated[str, "sweeps.0.vary"]
    first: Annotated[float, "sweeps.0.first"]
    last: Annotated[float, "sweeps.0.last"]
    points: Annotated[int, "sweeps.0.points"]
    quantity: Annotated[str, "sweeps.0.quantity"]


class ComparisonSettings(SweepSettings, total=False):
    """Settings of a comparison."""

    all_priors: Annotated[bool, "sweeps.0.all_priors"]


class MapSettings(SweepSettings, total=False):
    """Settings of a comparison over two parameters."""

    second_vary: Annotated[str, "sweeps.0.second.vary"]
    second_first: Annotated[float, "sweeps.0.second.first"]
    second_last: Annotated[float, "sweeps.0.second.last"]
    second_points: Annotated[int, "sweeps.0.second.points"]


class MatrixSettings(_ReflectanceSettings, total=False):
    """Settings of a color matrix, and of its curve of color error against noise."""

    pareto_first: Annotated[float, "outputs.pareto.first"]
    pareto_last: Annotated[float, "outputs.pareto.last"]
    pareto_points: Annotated[int, "outputs.pareto.points"]


class SensitivitySettings(_ReflectanceSettings, total=False):
    """Settings of a sensitivity."""


class DenoiseSettings(SharedSettings, total=False):
    """Settings of a picture of another camera. Its file may give mosaic, bits and black level."""

    mosaic: Annotated[str, "pictures.0.mosaic"]
    demosaic: Annotated[str, "pictures.0.demosaic"]
    bits: Annotated[int, "pictures.0.bits", "sensors.*.pixel.bits"]
    black_level: Annotated[int, "pictures.0.black_level"]


class RenderSettings(SharedSettings, total=False):
    """Settings of pictures; ``beyond`` applies to the cube too, ``scale`` only to the cube."""

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
    bits: Annotated[int, "pictures.0.bits", "sensors.*.pixel.bits"]
    black_level: Annotated[int, "pictures.0.black_level"]
    frames: Annotated[int, "pictures.0.frames"]
    denoise: Annotated[str, "pictures.0.denoise"]
    formats: Annotated[Sequence[str], "pictures.0.formats"]
    clip: Annotated[bool, "pictures.0.clip"]


def settings_keys(kind: type) -> Mapping[str, tuple[str, ...]]:
    """The names of settings, each with its keys in a study.

    Parameters
    ----------
    kind
        `SharedSettings` or a class derived from it.

    Examples
    --------
    >>> settings_keys(SharedSettings)["lux"]
    ('light.level_lux',)
    """
    hints = get_type_hints(kind, include_extras=True)
    return {
        name: (f"sensors.*.pixel.{name}",) if name in PIXEL else hint.__metadata__
        for name, hint in hints.items()
    }


SHARED = settings_keys(SharedSettings)
"""Keys of a study by the settings that all functions have."""
ANALYSIS = settings_keys(AnalysisSettings)
"""Keys of a study by the settings of ``analyze``."""
COMPARISON = settings_keys(ComparisonSettings)
"""Keys of a study by the settings of ``compare``."""
_DENOISE = settings_keys(DenoiseSettings)
MAPS = settings_keys(MapSettings)
"""Keys of a study by the settings of ``compare_map``."""
MATRIX = settings_keys(MatrixSettings)
"""Keys of a study by the settings of ``matrix``."""
RENDERING = settings_keys(RenderSettings)
"""Keys of a study by the settings of ``render``."""
SENSITIVITY = settings_keys(SensitivitySettings)
FUNCTIONS = {
    "analyze": ANALYSIS,
    "compare": COMPARISON,
    "compare_map": MAPS,
    "denoise": _DENOISE,
    "matrix": MATRIX,
    "render": RENDERING,
    "sensitivity": SENSITIVITY,
}
"""The settings of each function of ``import chromanoise as cn``."""
_ARGUMENTS = {
    "analyze": ("matrix",),
    "compare": ("matrices",),
    "compare_map": ("matrices",),
    "denoise": (
        "picture",
        "sensor",
        "denoise",
        "matrix",
        "unit",
        "shape",
        "stored",
        "white_level",
        "threads",
    ),
    "matrix": ("sensor", "matrix"),
    "render": ("cube", "matrix", "folder"),
    "sensitivity": (
        "sensor",
        "matrix",
        "objectives",
        "losses",
        "tolerance_nm",
        "tolerance_percent",
        "draws",
        "seed",
        "keep_matrix",
    ),
}
STARTS: Mapping[str, dict[str, Any]] = {
    "analyze": {"outputs": {"budget": False}},
    "compare": {
        "outputs": {"analyses": False},
        "sweeps": [{"vary": "lux", "first": 0.01, "last": 1000.0}],
    },
    "compare_map": {
        "outputs": {"analyses": False},
        "sweeps": [
            {
                "vary": "lux",
                "first": 0.01,
                "last": 1000.0,
                "second": {"vary": "f-number", "first": 1.4, "last": 8.0},
            }
        ],
    },
    "denoise": {"outputs": {"analyses": False}, "pictures": [{"mosaic": "sensor"}]},
    "matrix": {"outputs": {"analyses": False, "matrix": True}},
    "render": {"outputs": {"analyses": False}},
    "sensitivity": {"outputs": {"analyses": False}},
}
"""The study of each function before its settings are applied."""


def analyze_study(
    sensors: Sequence[str], settings: Settings, *, matrix: str = DEFAULT_METHOD
) -> Study:
    """The study of one analysis: every stage of each sensor with one color matrix.

    Parameters
    ----------
    sensors
        Names of the catalog, or files.
    settings
        By the names of `AnalysisSettings`; ``None`` for the default.
    matrix
        Method of the matrix.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    _refuse_unknown(settings, "analyze")
    return _study(sensors, settings, "analyze", {"matrices": [matrix]})


def compare_study(
    sensors: Sequence[str], settings: Settings, *, matrices: Sequence[str] = (DEFAULT_METHOD,)
) -> Study:
    """The study of one comparison: a quantity of all sensors as a function of one parameter.

    Parameters
    ----------
    sensors
        Names of the catalog, or files.
    settings
        By the names of `ComparisonSettings`. With ``prior`` equal to ``all``, the crossovers over
        all priors are computed too.
    matrices
        Their methods.

    Raises
    ------
    InputError
        If a value cannot be used, has no effect, or is the parameter that varies.
    """
    _refuse_unknown(settings, "compare")
    matrices = [name.strip() for name in matrices]
    if settings.get("prior") == "all":
        settings = {**settings, "prior": None, "all_priors": True}
    return _study(sensors, settings, "compare", {"matrices": matrices})


def map_study(
    sensors: Sequence[str], settings: Settings, *, matrices: Sequence[str] = (DEFAULT_METHOD,)
) -> Study:
    """The study of one comparison over two parameters: a quantity of all sensors on a grid.

    Parameters
    ----------
    sensors
        Names of the catalog, or files.
    settings
        By the names of `MapSettings`.
    matrices
        Their methods.

    Raises
    ------
    InputError
        If a value cannot be used, has no effect, or is a parameter that varies.
    """
    _refuse_unknown(settings, "compare_map")
    return _study(
        sensors, settings, "compare_map", {"matrices": [name.strip() for name in matrices]}
    )


def matrix_study(sensor: str, settings: Settings, *, matrix: str = DEFAULT_METHOD) -> Study:
    """The study of one color matrix.

    Parameters
    ----------
    sensor
        Name of the catalog, or file.
    settings
        By the names of `MatrixSettings`.
    matrix
        Method of the matrix.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    _refuse_unknown(settings, "matrix")
    return _study([sensor], settings, "matrix", {"matrices": [matrix]})


def sensitivity_study(sensor: str, settings: Settings, *, matrix: str = DEFAULT_METHOD) -> Study:
    """The study of one sensor at its operating point, of which parameters then change.

    Parameters
    ----------
    sensor
        Name of the catalog, or file.
    settings
        By the names of `SensitivitySettings`.
    matrix
        Method of the matrix.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    _refuse_unknown(settings, "sensitivity")
    return _study([sensor], settings, "sensitivity", {"matrices": [matrix]})


def denoise_study(sensor: str, settings: Settings, *, matrix: str = DEFAULT_METHOD) -> Study:
    """The study of a picture of another camera: its sensor, its light, its mosaic.

    Parameters
    ----------
    sensor
        Name of the catalog, or file; empty where only the pixel is known.
    settings
        By the names of `DenoiseSettings`.
    matrix
        Method of the matrix.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    _refuse_unknown(settings, "denoise")
    return _study([sensor], settings, "denoise", {"matrices": [matrix]})


def render_study(
    cube: str, sensors: Sequence[str], settings: Settings, *, matrix: str = DEFAULT_METHOD
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
        Method of the matrix.

    Raises
    ------
    InputError
        If a value cannot be used, or has no effect.
    """
    _refuse_unknown(settings, "render")
    data: dict[str, Any] = {"matrices": [matrix], "pictures": [{"cube": cube}]}
    study = _study(sensors, settings, "render", data)
    mosaic = settings.get("mosaic")
    if settings.get("crosstalk") is None or mosaic in (None, "sensor"):
        return study
    parts = [part.model_copy(update={"mosaic": mosaic}) for part in study.sensors]
    return study.model_copy(update={"sensors": tuple(parts)})


OF_CURVES = (
    "illuminant",
    "observer",
    "prior",
    "chart_file",
    "patch",
    "pairs",
    "filter",
    "channel_filters",
    "white_balance",
)
"""Settings that name curves: Python also takes the curves themselves."""

PER_SENSOR = ("labels",)
"""Settings with one value per sensor, in the order of the sensors."""

_GENERAL = {"sensors": "sensors.*", "pictures": "pictures.0"}


def argument_of(key: str, names: Mapping[str, tuple[str, ...]] = SHARED) -> str | None:
    """The flat name of a key of a study; ``None`` if it has none.

    Parameters
    ----------
    key
        A key as in `InputError.setting`, e.g. ``sensors.0.answers.per``.
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
    function: str,
    more: dict[str, Any],
) -> Study:
    names, data = FUNCTIONS[function], deepcopy(STARTS[function]) | more
    data["sensors"] = [{"name": name} for name in sensors]
    for name, value in settings.items():
        for key in names[name] if value is not None else ():
            places = _places(key, len(sensors))
            values = (
                _one_each(name, value, sensors) if name in PER_SENSOR else [value] * len(places)
            )
            for place, one in zip(places, values, strict=True):
                _put(data, place, one)
    try:
        return study_from_data(data)
    except InputError as error:
        raise refusal([_called_flat(one, names, {}) for one in errors_in(error)]) from None


def _one_each(name: str, values: Any, sensors: Sequence[str]) -> list[Any]:
    """The labels of the sensors, in their order; none where it is the sensor's own name."""
    listed = isinstance(values, list | tuple)
    if not listed or len(values) != len(sensors):
        count = len(values) if listed else 1
        raise InputError(
            name,
            f"must have one entry per sensor, {len(sensors)} in all, in their order",
            value=count,
            found=f"has {count}" if listed else f"is {values!r}",
            remedy="repeat the name of a sensor that keeps it",
            setting="sensors.*.label",
        )
    return [
        None if value == shown_word(own) else value
        for value, own in zip(values, sensors, strict=True)
    ]


def in_arguments(error: InputError, function: str) -> InputError:
    """Convert an error of a study to the arguments of the Python function that built the study.

    Parameters
    ----------
    error
        An error whose subject and settings are keys of the study.
    function
        A name of `FUNCTIONS`.

    Examples
    --------
    >>> from chromanoise.errors import Setting
    >>> ends = Setting("sensors.0.beyond", ("zero", "hold"))
    >>> str(in_arguments(InputError("cam.csv", "must reach 1050 nm", remedy=ends), "analyze"))
    "cam.csv must reach 1050 nm; set beyond='zero' or 'hold'"
    """
    positional = {
        "matrices": "matrices" if function in ("compare", "compare_map") else "matrix",
        "sensors": "sensor" if "sensor" in _ARGUMENTS[function] else "sensors",
        "pictures": "cube",
    }
    names = FUNCTIONS[function]

    def translated(one: InputError) -> InputError:
        inside = one.inside(one.setting, lambda key: argument_of(key, names) or key)
        return _called_flat(inside, names, positional)

    return refusal([translated(one) for one in errors_in(error)])


def _called_flat(
    error: InputError, names: Mapping[str, tuple[str, ...]], positional: Mapping[str, str]
) -> InputError:
    """The error with the flat name of the setting as subject, if the subject is the setting."""
    called = argument_of(error.setting, names)
    if re.fullmatch(r"matrices\.\d+|sensors\.\d+\.name|pictures\.\d+\.cube", error.setting):
        called = positional.get(error.setting.partition(".")[0])
    key = error.setting
    own = (key.partition(".")[0], key.rpartition(".")[2])
    return error if called is None or error.subject not in own else error.called(called)


def _refuse_unknown(settings: Settings, function: str) -> None:
    """Refuse names that are no settings of the function, and suggest similar ones."""
    known = [*FUNCTIONS[function], *_ARGUMENTS[function]]
    for name in settings:
        if name in FUNCTIONS[function]:
            continue
        if name == "method":  # as the option is called too
            (matrix,) = (one for one in _ARGUMENTS[function] if one.startswith("matri"))
            raise InputError(
                name, f"is not an argument of {function}", remedy=f"did you mean {matrix}?"
            )
        others = [other for other in FUNCTIONS if name in (*FUNCTIONS[other], *_ARGUMENTS[other])]
        otherwise = f"known: {', '.join(known)}"
        if others:
            otherwise = f"it is one of {' and '.join(others)}"
        remedy = did_you_mean(name, known, otherwise, most=2, cutoff=0.7 if others else 0.6)
        raise InputError(name, f"is not an argument of {function}", remedy=remedy)


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
