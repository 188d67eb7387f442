"""The functions of ``import chromanoise as cn``: each builds a study and returns its results."""

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Unpack

import numpy as np

from chromanoise.apps.design import DEFAULT_OBJECTIVES, Sensitivity, half_widths, sensitivity_of
from chromanoise.base import InputError, Setting, dataclass, no_place_for, renamed_keywords
from chromanoise.color import ColorMatrix
from chromanoise.imaging import Work
from chromanoise.io import matrix_of_array
from chromanoise.noise import OperatingPoint
from chromanoise.sensor import Sensor
from chromanoise.spectra import Cube, Illuminant, OwnObserver, PatchPairs, Spectra
from chromanoise.study import (
    CURVES,
    DEFAULT_ISO,
    DEFAULT_METHOD,
    RANKED,
    Analyses,
    AnalysisSettings,
    CardSettings,
    Comparison,
    ComparisonMap,
    ComparisonSettings,
    DenoiseSettings,
    Given,
    League,
    LeagueSettings,
    MapSettings,
    MatrixResult,
    MatrixSettings,
    Pictures,
    RenderSettings,
    Results,
    SensitivitySettings,
    Study,
    curves_of_object,
    described_settings,
    in_arguments,
    interface_of,
    is_of_colour_science,
    league_of_study,
    object_word,
    read_study,
    run as run_of,
    study_of,
)

if TYPE_CHECKING:
    from chromanoise.apps.design import Design, DesignStudy, Progress
    from chromanoise.charts import Card, Paper
    from chromanoise.io.frames import RawFrame
    from chromanoise.io.spectra import Found
    from chromanoise.study import DenoisedPicture, Electrons

Matrix = str | Path | np.ndarray | list[Any] | ColorMatrix | Callable[[OperatingPoint], Any]
"""A method, a file, 3 x p numbers [lx/e-], a matrix, or a function that returns one of the two."""
Function = TypeVar("Function", bound=Callable[..., Any])


def _with_listed_settings(function: Function) -> Function:
    """Add the settings of a function to its signature and its docstring."""
    settings = described_settings(function.__name__)
    own = inspect.signature(function)
    named = [one for one in own.parameters.values() if one.kind is not one.VAR_KEYWORD]
    listed = [
        inspect.Parameter(
            one.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=one.default,
            annotation=one.of.type if one.default is not None else one.of.type | None,
        )
        for one in settings
    ]
    text = inspect.cleandoc(function.__doc__ or "")
    head, returns, rest = text.partition("Returns\n-------")
    others = "\n".join(map(str, settings))
    function.__doc__ = f"{head}Other Parameters\n----------------\n{others}\n\n{returns}{rest}"
    vars(function)["__signature__"] = own.replace(parameters=[*named, *listed])
    return function


@_with_listed_settings
def analyze(
    *sensors: str | Path | Sensor | object,
    matrix: Matrix = DEFAULT_METHOD,
    **settings: Unpack[AnalysisSettings],
) -> Analyses:
    """Noise of each sensor in raw, contravariant and color coordinates, for a perfect white.

    Parameters
    ----------
    sensors
        Catalog names, files of quantum efficiency curves, `Sensor` objects, or objects with a
        method ``to_sensor()`` that returns one. Or curves of quantum efficiency: a spectral
        distribution of colour-science, a DataFrame, a DataArray, `Spectra`, a mapping with
        ``wavelength_nm``, or ``(wavelength_nm, values)``; wavelengths in nm, values as fractions.
        Or one `OperatingPoint` alone, which gives light and exposure as well.
    matrix
        Color matrix: ``kernel`` (eq. 6), ``lmmse``, ``ridge=0.01`` ..., a file, 3 x p numbers (raw
        electrons to X, Y, Z, [lx/e-]), a `ColorMatrix`, or a function that receives the
        `OperatingPoint` and returns one of the two.
    settings
        Light, exposure, pixel and outputs, as the options of ``chromanoise analyze``; see the list
        below. Without ``time_ms``, all sensors use the longest exposure time at which none
        saturates.

    Returns
    -------
    Analyses
        SNR in dB per channel and coordinate, with the operating point.

    Raises
    ------
    InputError
        If a name is unknown, a file cannot be read, or a setting cannot be used.

    Notes
    -----
    Clouet, Vaillant & Alleysson, CIC27 (2019), eq. 1-7.

    Examples
    --------
    >>> import chromanoise as cn
    >>> cn.analyze("onyx-rgbw", lux=10)
    <Analyses: SNR Y onyx-rgbw 26.0 dB at 10 lx (illuminant E, 11.94 ms, f/1.8)>
    """
    results = _results("analyze", [matrix], sensors, settings)
    (result,) = results.analyses.values()
    return result


@_with_listed_settings
def card(
    *sensors: str | Path | Sensor | object,
    matrix: Matrix = DEFAULT_METHOD,
    paper: "Paper" = "16:9",
    **settings: Unpack[CardSettings],
) -> "Card":
    """One sheet that compares up to five sensors: verdict, curves, budgets, pictures, settings.

    Parameters
    ----------
    sensors
        As `analyze`.
    matrix
        As `analyze`.
    paper
        ``16:9`` for a slide, or ``a4`` across.
    settings
        As the options of ``chromanoise card``; see the list below.

    Returns
    -------
    Card
        Its ``save`` writes PDF, SVG, PNG or HTML; its ``figure`` is one of matplotlib.

    Raises
    ------
    InputError
        As `analyze`, or if there are more than five sensors.

    Notes
    -----
    Clouet, Vaillant & Alleysson, CIC27 (2019), eq. 1-7.

    Examples
    --------
    >>> import chromanoise as cn
    >>> made = cn.card("onyx-rgbw", "onyx-rgb-ircut", lux=3)
    >>> made.verdict.winner
    'onyx-rgb-ircut'
    >>> made.save("card.pdf")                                               # doctest: +SKIP
    """
    from chromanoise.charts import card_of, shown  # loads matplotlib

    with _arguments_of("card") as named:
        names, rest = named.of(sensors, settings)
        study = study_of("card", names, rest, matrices=[named.matrix(matrix)])
        return card_of(shown(study, given=named.given), paper=paper)


@_with_listed_settings
def compare(
    *sensors: str | Path | Sensor | object,
    matrices: Sequence[Matrix] = (DEFAULT_METHOD,),
    **settings: Unpack[ComparisonSettings],
) -> Comparison:
    """A quantity of each sensor as a function of one parameter, with the crossovers.

    Parameters
    ----------
    sensors
        As `analyze`.
    settings
        As the options of ``chromanoise compare``; see the list below.

    Returns
    -------
    Comparison
        One curve per sensor and matrix, and the crossovers between the sensors.

    Raises
    ------
    InputError
        As `analyze`.

    Notes
    -----
    Clouet, Vaillant & Alleysson, CIC27 (2019), eq. 1-7, evaluated at each value.
    """
    (result,) = _results("compare", matrices, sensors, settings).sweeps
    return result


@_with_listed_settings
def compare_map(
    *sensors: str | Path | Sensor | object,
    matrices: Sequence[Matrix] = (DEFAULT_METHOD,),
    **settings: Unpack[MapSettings],
) -> ComparisonMap:
    """A quantity of each sensor as a function of two parameters, on a grid, with the crossovers.

    Parameters
    ----------
    sensors
        As `analyze`.
    settings
        As the options of ``chromanoise compare --and``; see the list below.

    Returns
    -------
    ComparisonMap
        One grid of values per sensor and matrix, and the best sensor at each pair of values.

    Raises
    ------
    InputError
        As `analyze`.

    Notes
    -----
    Clouet, Vaillant & Alleysson, CIC27 (2019), eq. 1-7, evaluated at each pair of values.

    Examples
    --------
    >>> import chromanoise as cn
    >>> made = cn.compare_map("onyx-rgbw", "onyx-rgb-ircut", points=4, second_points=3)
    >>> made.maps[0].value.shape
    (3, 4)
    """
    (result,) = _results("compare_map", matrices, sensors, settings).maps
    return result


@renamed_keywords(method="denoise")
@_with_listed_settings
def denoise(
    picture: str | Path | Sequence[str | Path] | np.ndarray,
    *,
    sensor: str | Path | Sensor | object | None = None,
    denoise: str = "guided",
    matrix: Matrix = DEFAULT_METHOD,
    unit: Literal["DN", "e-"] | None = None,
    shape: tuple[int, int] | None = None,
    stored: str | None = None,
    white_level: float | None = None,
    threads: int | None = None,
    **settings: Unpack[DenoiseSettings],
) -> "DenoisedPicture":
    """A raw picture of any camera after denoising with its known noise, and its color.

    Parameters
    ----------
    picture
        A raw file (DNG or camera raw, TIFF, FITS, NPY, PGM, raw dump), several files of one burst,
        or an array of rows and columns.
    sensor
        As `analyze`. Its pixel gives the noise, its channels the color; ``None`` for raw codes
        alone.
    denoise
        A name of `chromanoise.imaging.denoising.DENOISING`.
    matrix
        As `analyze`.
    unit
        Of an array: ``DN`` for codes, ``e-`` for electrons above black.
    shape
        Rows and columns of a raw dump. [px]
    stored
        Type of the codes of a raw dump: ``uint8``, ``uint16`` or ``uint16-be``.
    white_level
        Lowest saturated code; that of the file if ``None``. [DN]
    threads
        Number of threads; one per core if ``None``.
    settings
        As the options of ``chromanoise denoise``; see the list below.

    Returns
    -------
    DenoisedPicture
        Electrons and codes of each pixel, the color, the noise and a summary.

    Raises
    ------
    InputError
        As `analyze`, or if the picture cannot be read, or its mosaic, black level or noise is not
        known.

    Notes
    -----
    The noise is that of the pixel (Clouet, Vaillant & Alleysson, CIC27 (2019), eq. 7, with the
    further sources of EMVA 1288), or the NoiseProfile of a DNG.

    Examples
    --------
    >>> import chromanoise as cn
    >>> result = cn.denoise("night.dng", denoise="guided")                  # doctest: +SKIP
    >>> result.values_e, result.summary["residual"]                         # doctest: +SKIP
    """
    from chromanoise.study import denoised_picture, prepared_denoising  # loads readers of frames

    with _arguments_of("denoise") as named:
        frames = _raw_pictures(picture, unit, shape, stored)
        names, rest = named.of([] if sensor is None else [sensor], settings, none=True)
        plan = prepared_denoising(
            frames,
            names[0] if names else None,
            rest,
            denoise=denoise,
            matrix=named.matrix(matrix),
            white_level=white_level,
            given=named.given,
        )
        return denoised_picture(plan, work=Work(threads=threads))


def _raw_pictures(
    picture: Any, unit: str | None, shape: tuple[int, int] | None, stored: str | None
) -> "tuple[RawFrame, ...] | tuple[Electrons, ...]":
    """The picture or pictures that an argument names or holds."""
    from chromanoise.study import electrons_of_array, frame_of_array, frames_of_pictures

    if not isinstance(picture, np.ndarray):
        if unit is not None:
            raise InputError("unit", "must be given only for an array", value=unit)
        files = [picture] if isinstance(picture, str | Path) else list(picture)
        return frames_of_pictures(files, shape=shape, stored=stored)
    if unit not in ("DN", "e-"):
        raise InputError(
            "unit", "must be 'DN' or 'e-' for an array", value=unit, remedy=Setting("unit")
        )
    for name, value in (("shape", shape), ("stored", stored)):
        if value is not None:
            raise InputError(name, "must be given only for a raw dump", value=value)
    return (frame_of_array(picture),) if unit == "DN" else (electrons_of_array(picture),)


@_with_listed_settings
def league(
    *sensors: str | Path | Sensor | object,
    iso: str | float | Sequence[float] = DEFAULT_ISO,
    by: str = RANKED[0].name,
    **settings: Unpack[LeagueSettings],
) -> League:
    """Rank the cameras of the catalog, with sensors of one's own among them, by color and noise.

    Parameters
    ----------
    sensors
        Sensors of one's own, as in `analyze`, with 3 channels or more. Their curves count from 400
        to 780 nm. A camera of the catalog has the pixel of each ISO speed, any other sensor its
        own.
    iso
        ISO speeds: ``100:25600`` in whole stops, ``100,400``, or numbers.
    by
        The number by which the cameras are sorted, the best first: ``color_snr_loss_db``,
        ``color_error``, ``smi`` or ``colors_bits``.
    settings
        Pixels, filters and files of the sensors, as the options of ``chromanoise league``; see the
        list below.

    Returns
    -------
    League
        The cameras sorted by ``by``, the best first, and the sensors with their ranks among them.

    Raises
    ------
    InputError
        If a sensor cannot be read, is repeated or has fewer than 3 channels, or a speed is out of
        range.

    Notes
    -----
    Exposures per ISO speed are those of ISO 12232 (2019), SMI is that of ISO 17321-1 (2012), visual
    noise that of ISO 15739 (2017). The colors are those of
    `chromanoise.metrics.distinguishable_colors_bits`.

    Examples
    --------
    >>> import chromanoise as cn
    >>> best = cn.league(iso=800).cameras[0]
    >>> best.name, round(best.color_snr_loss_db, 2)
    ('canon-eos-1ds-mark-iii', 2.57)
    """
    with _arguments_of("league") as named:
        names, rest = named.of(sensors, settings, none=True)
        if not names and any(value is not None for value in rest.values()):
            need = "must name a sensor, because settings of sensors are given"
            raise InputError("sensors", need, value=0)
        study = study_of("league", names, rest) if names else None
        return league_of_study(study, iso=iso, by=by, given=named.given)


@_with_listed_settings
def matrix(
    sensor: str | Path | Sensor | object,
    matrix: Matrix = DEFAULT_METHOD,
    **settings: Unpack[MatrixSettings],
) -> MatrixResult:
    """The color matrix of a sensor, with its color error, noise and condition.

    Parameters
    ----------
    sensor
        As `analyze`.
    matrix
        As `analyze`.
    settings
        As the options of ``chromanoise matrix``; see the list below. With ``pareto_first`` and
        ``pareto_last``, the curve of color error against noise between these two weights is
        computed as well.

    Returns
    -------
    MatrixResult
        The matrix, electrons to XYZ [lx/e-], with the report on it.

    Raises
    ------
    InputError
        As `analyze`.

    Notes
    -----
    Clouet, Vaillant & Alleysson, CIC27 (2019), eq. 6.
    """
    (found,) = _results("matrix", [matrix], [sensor], settings).matrices.values()
    (result,) = found.results
    return result


def optimize(
    design: "str | Path | DesignStudy",
    *,
    folder: str | Path | None = None,
    budget: int | None = None,
    seed: int | None = None,
    resume: bool = False,
    scheduler: str | None = None,
    progress: "Callable[[Progress], None] | None" = None,
) -> "Design":
    """Search filters, IR-cut, silicon, exposure and matrix for the best trade-offs of objectives.

    Parameters
    ----------
    design
        A file as `chromanoise init --design` writes it, or the design that `read_design` returns.
    folder
        Folder for ``front.json``, the sensors and the checkpoint; ``None`` writes nothing.
    budget, seed
        Evaluated sensors and seed of the search; ``None`` for those of the design.
    resume
        Whether to continue the stopped search in ``folder``.
    scheduler
        Address of a dask cluster, or ``local``; ``None`` evaluates in this process.
    progress
        Called after each generation with the front so far.

    Returns
    -------
    Design
        The front: sensors of which none is better than another in all objectives.

    Raises
    ------
    InputError
        If the design cannot be read or made, its constraints contradict each other, or the folder
        holds another design.

    Notes
    -----
    The search is that of Deb et al., IEEE Trans. Evol. Comput. 6 (2002), 182-197; the SNR of Y
    that of Clouet, Vaillant & Alleysson, CIC27 (2019), eq. 1-7.

    Examples
    --------
    >>> import chromanoise as cn
    >>> front = cn.optimize("design.toml", budget=2000)        # doctest: +SKIP
    >>> front.members[0].objectives, front.sentences           # doctest: +SKIP
    """
    from chromanoise.apps.design import (
        DesignStudy,
        optimized,
        read_design,
        scheduler_at,
        with_effort,
    )

    if not isinstance(design, str | Path | DesignStudy):
        raise InputError(
            "design",
            "must be a file or the result of cn.apps.design.read_design",
            value=design,
            remedy="write a file with chromanoise init --design",
        )
    document = design if isinstance(design, DesignStudy) else read_design(design)
    place = None if folder is None else Path(folder)
    with nullcontext() if scheduler is None else scheduler_at(scheduler) as evaluate_on:
        return optimized(
            with_effort(document, budget=budget, seed=seed),
            place,
            resume=resume,
            evaluate_on=evaluate_on,
            progress=progress,
        )


@_with_listed_settings
def render(
    cube: str | Path | Cube | object,
    *sensors: str | Path | Sensor | object,
    matrix: Matrix = DEFAULT_METHOD,
    folder: str | Path | None = None,
    **settings: Unpack[RenderSettings],
) -> Pictures:
    """Noisy pictures of a hyperspectral cube, one per sensor and frame.

    Parameters
    ----------
    cube
        A name of ``chromanoise catalog scenes``, e.g. ``builtin:checker``, a file of a
        hyperspectral reflectance cube, or a `Cube`.
    sensors
        As `analyze`.
    matrix
        As `analyze`.
    folder
        Folder for the pictures; ``None`` keeps them in memory.
    settings
        As the options of ``chromanoise simulate``; see the list below.

    Returns
    -------
    Pictures
        The pictures in memory, or a summary of each picture that was written.

    Raises
    ------
    InputError
        As `analyze`, or if the cube cannot be used.

    Notes
    -----
    Shot noise and read noise are drawn for each pixel (eq. 7). The same seed gives identical
    pictures with any number of threads.
    """
    (result,) = _results("render", [matrix], sensors, settings, cube, folder).pictures
    return result


def run(study: Study | str | Path, folder: str | Path | None = None) -> Results:
    """Run a study and return all its results.

    Parameters
    ----------
    study
        A study file, or a study from `read_study`, `study_from_data` or `Study`.
    folder
        Folder for pictures; ``None`` keeps them in memory.

    Returns
    -------
    Results
        The result of each step, by the name of the step.

    Raises
    ------
    InputError
        As `analyze`, or if ``study`` is neither a study nor a file of one.

    Notes
    -----
    The numbers are those of ``chromanoise run``: Clouet, Vaillant & Alleysson, CIC27 (2019),
    eq. 1-7.
    """
    if isinstance(study, str | Path):
        study = read_study(study)
    if not isinstance(study, Study):
        raise InputError(
            "study", "must be a Study or the name of a study file", value=type(study).__name__
        )
    return run_of(study, folder=_folder(folder))


@_with_listed_settings
def sensitivity(
    sensor: str | Path | Sensor | object,
    matrix: Matrix = DEFAULT_METHOD,
    *,
    objectives: Sequence[str] = DEFAULT_OBJECTIVES,
    losses: Mapping[str, float] | None = None,
    tolerance_nm: float | None = None,
    tolerance_percent: float | None = None,
    draws: int = 0,
    seed: int = 0,
    keep_matrix: bool = False,
    **settings: Unpack[SensitivitySettings],
) -> Sensitivity:
    """What 1 nm or 1 % of each parameter of a sensor does to each objective; tolerance budget.

    Parameters
    ----------
    sensor
        As `analyze`.
    matrix
        As `analyze`.
    objectives
        Names of ``chromanoise.apps.design.OBJECTIVES``; the first one orders the table.
    losses
        Loss by objective, each in the unit of its objective: the change of each parameter that
        costs so much is computed.
    tolerance_nm
        Half width of the tolerance of all wavelengths: the spread of the objectives is computed.
        [nm]
    tolerance_percent
        Half width of the tolerance of all other values. [%]
    draws
        Sensors to draw within the tolerances, as a check of the first order.
    seed
        Seed of the draws.
    keep_matrix
        Whether a changed sensor keeps the color matrix of the unchanged one.
    settings
        As the options of ``chromanoise sensitivity``; see the list below. The exposure time stays
        that of the unchanged sensor.

    Returns
    -------
    Sensitivity
        The effect of each parameter on each objective.

    Raises
    ------
    InputError
        As `analyze`.

    Notes
    -----
    Guide to the expression of uncertainty in measurement, JCGM 100 (2008), 5.1.2: first order, by
    central differences.

    Examples
    --------
    >>> import chromanoise as cn
    >>> result = cn.sensitivity("onyx-rgb-ircut", objectives=["snr_y_db"])
    >>> {one.parameter.name: round(one.slope["snr_y_db"], 3) for one in result.effects[2:4]}
    {'crosstalk': -0.086, 'time_s': 0.044}
    """
    with _arguments_of("sensitivity") as named:
        names, rest = named.of([sensor], settings)
        return sensitivity_of(
            study_of("sensitivity", names, rest, matrices=[named.matrix(matrix)]),
            given=named.given,
            objectives=objectives,
            losses=losses,
            tolerances=half_widths(tolerance_nm, tolerance_percent),
            draws=draws,
            seed=seed,
            keep_matrix=keep_matrix,
        )


def _results(
    function: str,
    matrices: Any,
    sensors: Sequence[Any],
    settings: Mapping[str, Any],
    cube: Any = "",
    folder: str | Path | None = None,
) -> Results:
    """Results of the study of a function."""
    with _arguments_of(function) as named:
        names, rest = named.of(sensors, settings)
        words = named.matrices(matrices)
        study = study_of(function, names, rest, matrices=words, cube=named.cube(cube))
        return run_of(study, given=named.given, folder=_folder(folder))


@contextmanager
def _arguments_of(function: str) -> Iterator["_Named"]:
    """The words of a call; errors inside name its arguments, not the keys of its study."""
    try:
        yield _Named()
    except InputError as error:
        raise in_arguments(error, function) from error.__cause__


def _folder(folder: str | Path | None) -> Path | None:
    if folder is None:
        return None
    path = Path(folder)
    if not path.is_dir():
        raise InputError(str(folder), "must be an existing folder", remedy="create it first")
    return path


class _Named:
    """Words for the study, and the objects to which they refer."""

    def __init__(self) -> None:
        self._objects: dict[str, Any] = {}
        self.given = Given(objects=self._objects)

    def of(
        self, sensors: Sequence[Any], settings: Mapping[str, Any], *, none: bool = False
    ) -> tuple[list[str], dict[str, Any]]:
        """Words for the sensors, and the settings with words in place of objects."""
        points = [one for one in sensors if isinstance(one, OperatingPoint)]
        if points and len(sensors) > 1:
            raise InputError(
                "sensors", "must be one operating point, or sensors", value=len(sensors)
            )
        if points:
            own = _of_point(points[0])
            for name, value in settings.items():
                if value is not None and name in (*own, "equal", "saturate"):
                    demand = "must not be given with an operating point, which has its own"
                    raise no_place_for(name, demand, value)
            sensors = [points[0].sensor]
            settings = {**settings, **own}
        words = self._words_of_sensors(sensors, none=none)
        return words, {name: self._setting(name, value) for name, value in settings.items()}

    def matrix(self, matrix: Any) -> str:
        """The word of a color matrix."""
        if isinstance(matrix, str | Path):
            return str(matrix)
        if isinstance(matrix, ColorMatrix):
            return self._other("own matrix", lambda _: matrix)
        if callable(matrix):
            name = getattr(matrix, "__name__", type(matrix).__name__)
            return self._other("own matrix" if name == "<lambda>" else name, matrix)
        if isinstance(matrix, np.ndarray | list | tuple):
            return self._other("own matrix", matrix_of_array(matrix, "own matrix"))
        raise InputError(
            "matrix",
            "must be a method, a file, an array of 3 rows, a ColorMatrix or a function",
            value=type(matrix).__name__,
        )

    def matrices(self, matrices: Any) -> list[str]:
        """The words of color matrices."""
        several = isinstance(matrices, list | tuple)
        return [self.matrix(one) for one in (matrices if several else [matrices])]

    def cube(self, cube: Any) -> str:
        """The word of a cube."""
        if isinstance(cube, str | Path):
            return str(cube)
        if isinstance(cube, Cube):
            return self._other(cube.source or "own cube", cube)
        raise InputError(
            "cube",
            "must be a name, a file or a Cube",
            value=type(cube).__name__,
            remedy="build one: cn.Cube(wavelength_nm=..., stored=..., source=...)",
        )

    def _words_of_sensors(self, sensors: Sequence[Any], *, none: bool) -> list[str]:
        if not sensors and not none:
            raise InputError(
                "sensors", "must name at least one sensor", value=0, found="none is given"
            )
        found = [_sensor_or_curves(one, i) for i, one in enumerate(sensors)]
        names = [
            one.name if isinstance(one, Sensor) else one if isinstance(one, str) else one.source
            for one in found
        ]
        words = []
        for name, one in zip(names, found, strict=True):
            if not isinstance(one, str) and names.count(name) > 1:
                raise InputError(
                    "sensors",
                    "must have different names",
                    value=name,
                    found=f"{name!r} is repeated",
                    remedy="rename one with dataclasses.replace"
                    if isinstance(one, Sensor)
                    else "rename one",
                )
            words.append(one if isinstance(one, str) else self._other(name, one))
        return words

    def _setting(self, name: str, value: Any) -> Any:
        """The value of a setting as a study stores it."""
        if name == "channel_filters" and isinstance(value, Mapping):
            return {str(key): self._curves("filter", one) for key, one in value.items()}
        return self._curves(name, value) if interface_of(name).curves else _plain(value)

    def _curves(self, name: str, value: Any) -> Any:
        if value is None or isinstance(value, str | Path | bool | int | float | np.generic):
            return _plain(value)
        if isinstance(value, Illuminant) and name in ("illuminant", "white_balance"):
            return self._other(value.name, value)
        if isinstance(value, OwnObserver) and name == "observer":
            return self._other(str(value), value)
        if isinstance(value, PatchPairs) and name == "pairs":
            return self._other("own pairs", value)
        if isinstance(value, _OnGrid):
            return self._other(value.spectra.source, value.spectra)
        found = curves_of_object(value, f"own {name.removesuffix('_file').replace('_', ' ')}")
        if found is None and name == "white_balance":
            return _plain(value)
        if found is None:
            raise InputError(
                name,
                "must be a name, a file or curves",
                value=type(value).__name__,
                found=f"is a {type(value).__name__}",
                remedy=f"give {CURVES}",
            )
        if name in ("illuminant", "white_balance") and is_of_colour_science(value):
            found = replace(found, quantity="power", per="energy")
        return self._other(found.source, found)

    def _other(self, name: str, one: Any) -> str:
        """The word of an object, with a number if another object has its name."""
        word, count = object_word(name), 1
        while self._objects.get(word, one) is not one:
            count += 1
            word = object_word(f"{name} ({count})")
        self._objects[word] = one
        return word


@dataclass(frozen=True)
class _OnGrid:
    """Reflectances of an operating point, which are on the grid already."""

    spectra: Spectra


def _of_point(point: OperatingPoint) -> dict[str, Any]:
    """The settings of an operating point, without its sensor."""
    own = {
        "illuminant": point.illuminant,
        "lux": point.level_lux,
        "time_ms": 1e3 * point.exposure.time_s,
        "f_number": point.exposure.f_number,
        "magnification": point.exposure.magnification,
        "chart_file": None if point.chart is None else _OnGrid(point.chart),
        "patch": None if point.patch is None else _OnGrid(point.patch),
        "pairs": point.pairs,
    }
    return {"observer": point.observer} | {k: v for k, v in own.items() if v is not None}


def _sensor_or_curves(one: Any, index: int) -> "str | Sensor | Found":
    """A sensor as a word, a `Sensor` or curves."""
    if isinstance(one, str | Path):
        return str(one)
    if isinstance(one, Sensor):
        return one
    if callable(getattr(one, "to_sensor", None)):
        made = one.to_sensor()
        if not isinstance(made, Sensor):
            raise InputError(
                f"to_sensor of {type(one).__name__}",
                "must return a chromanoise.Sensor",
                value=type(made).__name__,
                found=f"returns a {type(made).__name__}",
            )
        return made
    found = curves_of_object(one, "own sensor" if index == 0 else f"own sensor {index + 1}")
    if found is not None:
        return found
    names = isinstance(one, list | tuple) and all(isinstance(word, str | Path) for word in one)
    raise InputError(
        "sensors",
        "must be names, files, Sensor objects or curves, each an argument of its own",
        value=one,
        found=f"is a {type(one).__name__}",
        remedy="write *names for a list of names" if names else f"give {CURVES}",
    )


def _plain(value: Any) -> Any:
    """A value as a study stores it: numpy scalars as Python numbers, paths as text."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {name: _plain(one) for name, one in value.items()}
    return str(value) if isinstance(value, Path) else value
