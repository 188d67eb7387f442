"""Color error of a sensor and its matrix: differences on a chart, metamerism index, and a report.

The sensitivity metamerism index (ISO 17321) is the color error that remains with the best matrix.
The report on a matrix has color error, noise, condition, noise gain Psi and near infrared.
"""

from dataclasses import replace

import numpy as np

from chromanoise.base import (
    RANK_TOLERANCE,
    Array,
    Float,
    InputError,
    check,
    dataclass,
    kept,
    lstsq,
    solve,
    svd,
)
from chromanoise.color import (
    LAB,
    ColorMatrix,
    balanced_cielab,
    cie1976_difference,
    ciede2000_difference,
    cielab,
    colored,
    noise_gain,
    scene_xyz,
    white_normalized,
)
from chromanoise.metrics.snr import signal_snr_db
from chromanoise.noise import (
    Exposure,
    OperatingPoint,
    expected_electrons,
    measurement_vectors,
    saturated,
    with_noise,
)
from chromanoise.sensor import Sensor
from chromanoise.spectra import (
    DEFAULT_OBSERVER,
    Illuminant,
    Scene,
    Spectra,
    chart_on,
    chart_title,
    cie_1931,
    flat_field,
    is_infrared,
    light,
    photons_per_unit,
)
from chromanoise.spectra.tables import packaged_table


def chart_color_error(
    sensor: Sensor,
    matrix: ColorMatrix,
    exposure: Exposure,
    illuminant: Illuminant,
    chart: Spectra | None = None,
) -> Float[Array, " k"] | None:
    """CIE 1976 color difference of each patch of a chart, without noise. [Delta E*ab]

    ``None`` where X, Y or Z of the sensor's own white is not above 0.

    Sensor and observer are each white-balanced on their own perfect white: X, Y and Z are divided
    by those of a reflectance of 1, as the white balance of a camera does.

    Parameters
    ----------
    sensor, matrix, exposure, illuminant
        The sensor with its matrix and exposure, and the lamp.
    chart
        Reflectances on the sensor's grid; ``None`` for the ColorChecker.

    Raises
    ------
    InputError
        If the sensor's grid extends beyond 400-1050 nm, the range of the chart's data.

    Notes
    -----
    CIE 015:2018, eq. 8.3-8.6 and 8.21.
    """
    lab = chart_lab(sensor, matrix, exposure, illuminant, chart)
    return None if lab is None else cie1976_difference(*lab)


def chart_ciede2000(
    sensor: Sensor,
    matrix: ColorMatrix,
    exposure: Exposure,
    illuminant: Illuminant,
    chart: Spectra | None = None,
) -> Float[Array, " k"] | None:
    """CIEDE2000 color difference of each patch of a chart, without noise. [1]

    Parameters, errors and ``None`` as `chart_color_error`.

    Parameters
    ----------
    matrix
        The color matrix. [lx/e-]
    chart
        Reflectances of the patches; those of the ColorChecker if ``None``.

    Notes
    -----
    CIE 142-2001 (ISO/CIE 11664-6:2014).
    """
    lab = chart_lab(sensor, matrix, exposure, illuminant, chart)
    return None if lab is None else ciede2000_difference(*lab)


def chart_lab(
    sensor: Sensor,
    matrix: ColorMatrix,
    exposure: Exposure,
    illuminant: Illuminant,
    chart: Spectra | None = None,
) -> tuple[Float[Array, "k 3"], Float[Array, "k 3"]] | None:
    """L*, a*, b* of each patch for the observer and for the sensor, without noise.

    Parameters, errors and ``None`` as `chart_color_error`.

    Parameters
    ----------
    matrix
        The color matrix. [lx/e-]
    chart
        Reflectances of the patches; those of the ColorChecker if ``None``.
    """
    lab = _chart_lab(sensor, matrix, exposure, illuminant, chart)
    return None if lab is None else (lab[0].copy(), lab[1].copy())


@kept  # for all levels of a sweep
def _chart_lab(
    sensor: Sensor,
    matrix: ColorMatrix,
    exposure: Exposure,
    illuminant: Illuminant,
    chart: Spectra | None,
) -> tuple[Float[Array, "k 3"], Float[Array, "k 3"]] | None:
    scene = _white_and_chart(illuminant, chart)
    seen = expected_electrons(scene, sensor, exposure) @ matrix.matrix.T
    if not (seen[0] > 0).all():
        return None
    truth = truth_lab(illuminant, matrix.observer, chart)
    return truth, balanced_cielab(seen[1:] / seen[0])


def mean_chart_errors(
    sensor: Sensor,
    matrices: Float[Array, "k 3 p"],
    exposure: Exposure,
    illuminant: Illuminant,
    observer: str = DEFAULT_OBSERVER,
    chart: Spectra | None = None,
) -> Float[Array, " k"]:
    """Mean of `chart_color_error` for many matrices at once; NaN where it is ``None``. [Delta E*ab]

    Parameters
    ----------
    matrices
        Color matrices for that sensor and exposure. [lx/e-]
    observer
        Their observer, from `chromanoise.spectra.OBSERVERS`.
    sensor, exposure, illuminant, chart
        As `chart_color_error`.

    Raises
    ------
    InputError
        As `chart_color_error`.
    """
    truth, balanced = balanced_charts(sensor, matrices, exposure, illuminant, observer, chart)
    errors = cie1976_difference(balanced_cielab(truth), balanced_cielab(balanced))
    return np.asarray(errors.mean(axis=-1))


def balanced_charts(
    sensor: Sensor,
    matrices: Float[Array, "k 3 p"],
    exposure: Exposure,
    illuminant: Illuminant,
    observer: str = DEFAULT_OBSERVER,
    chart: Spectra | None = None,
) -> tuple[Float[Array, "c 3"], Float[Array, "k c 3"]]:
    """X, Y, Z of each patch over those of the white, for the observer and for each matrix. [1]

    NaN for a matrix whose white has an X, Y or Z that is not above 0.

    Parameters
    ----------
    sensor, exposure, illuminant, chart
        As `chart_color_error`.
    matrices
        Color matrices for that sensor and exposure. [lx/e-]
    observer
        Their observer, from `chromanoise.spectra.OBSERVERS`.

    Raises
    ------
    InputError
        As `chart_color_error`.
    """
    scene = _white_and_chart(illuminant, chart)
    seen = expected_electrons(scene, sensor, exposure) @ np.swapaxes(matrices, -1, -2)
    known = (seen[:, 0] > 0).all(axis=-1)
    white = np.where(known[:, None], seen[:, 0], np.nan)
    return _balanced_truth(illuminant, observer, chart).copy(), seen[:, 1:] / white[:, None]


def balanced_truth(point: OperatingPoint) -> Float[Array, "c 3"]:
    """X, Y, Z of each patch of the chart over those of the white, for the observer. [1]

    Parameters
    ----------
    point
        Its light, chart and observer.
    """
    return _balanced_truth(point.illuminant, point.observer, point.chart).copy()


@kept
def truth_lab(illuminant: Illuminant, observer: str, chart: Spectra | None) -> Float[Array, "c 3"]:
    """L*, a*, b* of each patch of a chart for an observer; do not change them."""
    return check.frozen(balanced_cielab(_balanced_truth(illuminant, observer, chart)))


@kept
def _balanced_truth(
    illuminant: Illuminant, observer: str, chart: Spectra | None
) -> Float[Array, "c 3"]:
    truth = scene_xyz(_white_and_chart(illuminant, chart), "energy", observer)
    return np.asarray(truth[1:] / truth[0])


def _white_and_chart(illuminant: Illuminant, chart: Spectra | None) -> Scene:
    grid = illuminant.grid
    reflectance = np.vstack([np.ones(grid.n), chart_on(grid, chart).values.T])
    return Scene(illuminant=illuminant, level_lux=1.0, reflectance=reflectance)


PENALTY = 5.5
"""Slope of the index: SMI = 100 - 5.5 mean Delta E*ab."""

_WHITE = np.ones(3)  # of patches that are white-balanced
_SOFTENINGS = (1e-2, 1e-5, 1e-9)  # Delta E*ab
_MOST_STEPS = 50
_SHORTEST = 1e-10  # share of a step


@dataclass(frozen=True, kw_only=True, eq=False)
class Metamerism:
    """The index, the color errors and the best matrix.

    Attributes
    ----------
    index
        SMI, 100 for an exact colorimeter. [1]
    color_error
        Color error of each patch with the best matrix. [Delta E*ab]
    matrix
        From channels balanced on white to X, Y, Z with white = 1.
    """

    index: float
    color_error: Float[Array, " m"]
    matrix: Float[Array, "3 p"]

    def __post_init__(self) -> None:
        check.same_length("rows", matrix=self.matrix.shape[0], XYZ=3)
        check.freeze(self, "color_error", "matrix")


def metamerism(
    filters: Float[Array, "n p"],
    eye: Float[Array, "n 3"],
    illuminant: Float[Array, " n"],
    reflectance: Float[Array, "m n"],
) -> Metamerism:
    """SMI over any patches: the matrix that minimizes the mean Delta E*ab, and its color errors.

    Parameters
    ----------
    filters
        One column per channel, per unit of radiant power; each is balanced on white.
    eye
        Color-matching functions, per unit of radiant power.
    illuminant
        Radiant power; its level cancels.
    reflectance
        One row per patch.

    Raises
    ------
    InputError
        If the shapes do not match, an entry is not finite, or a channel receives no light.

    Notes
    -----
    ISO 17321-1:2012, annex D: SMI = 100 - 5.5 mean Delta E*ab (CIE 1976). The matrix has 3 p free
    entries: white is not preserved. Newton's steps start at least squares on XYZ.

    Examples
    --------
    A sensor whose channels are linear combinations of the observer's is a colorimeter.

    >>> eye = np.eye(3)
    >>> patches = np.array([[0.2, 0.3, 0.4], [0.5, 0.1, 0.2], [0.1, 0.6, 0.3]])
    >>> mixed = eye @ np.array([[1.0, 0.2, 0.0], [0.1, 1.0, 0.1], [0.0, 0.2, 1.0]])
    >>> round(metamerism(mixed, eye, np.ones(3), patches).index, 6)
    100.0
    """
    raw = _white_balanced("filters", filters, illuminant, reflectance)
    seen = _white_balanced("eye", eye, illuminant, reflectance)
    wanted = cielab(seen, _WHITE)
    start = lstsq("white-balanced patches", raw, seen, rcond=None)
    matrix = _descended(raw, wanted, np.asarray(start[0].T))
    error = np.linalg.norm(cielab(raw @ matrix.T, _WHITE) - wanted, axis=-1)
    return Metamerism(index=float(100.0 - PENALTY * error.mean()), color_error=error, matrix=matrix)


def sensor_metamerism(sensor: Sensor) -> Metamerism:
    """SMI of a sensor with the light and patches of the standard: D55, 18 colors of the chart.

    Outside 380-780 nm, where neither is defined, the sensor's response is set to 0.

    Raises
    ------
    InputError
        If the sensor's grid does not overlap 380-780 nm, or a channel receives no light there.

    Notes
    -----
    ISO 17321-1:2012, annex D. The patches are identical to those of Ohta (1997), D55 is that of CIE
    015, the observer is CIE 1931; all with linear interpolation between samples.
    """
    chart, daylight = packaged_table("iso_17321"), packaged_table("cie_daylight")
    d55 = daylight.values[:, daylight.names.index("D55")]
    at = sensor.grid.wavelength_nm
    inside = (at >= chart.wavelength_nm[0]) & (at <= chart.wavelength_nm[-1])
    if not inside.any():
        raise InputError(
            f"grid of {sensor.name}",
            "must overlap 380-780 nm, where the patches of ISO 17321-1 are defined",
            value=sensor.grid,
            found=f"is {sensor.grid}",
            remedy="give curves that reach into the visible",
        )
    per_watt = sensor.qe * photons_per_unit(sensor.grid, "energy")[:, None]
    return metamerism(
        per_watt[inside],
        cie_1931(sensor.grid).values[inside],
        np.interp(at[inside], daylight.wavelength_nm, d55),
        np.array([np.interp(at[inside], chart.wavelength_nm, one) for one in chart.values.T[:18]]),
    )


def _white_balanced(name: str, axes: Array, illuminant: Array, reflectance: Array) -> Array:
    """Responses to the patches over the response to white, one row per patch."""
    curves = check.finite(name, "1", axes)
    lamp = check.non_negative("illuminant", "1", illuminant)
    rho = check.non_negative("reflectance", "1", reflectance)
    check.same_length(
        "wavelengths", **{name: len(curves)}, illuminant=lamp.size, reflectance=rho.shape[1]
    )
    white = lamp @ curves
    if not (white > 0).all():
        raise InputError(
            name,
            "must respond > 0 to white",
            value=float(white.min()),
            found=f"column {int(white.argmin())} (from 0) responds {white.min():g}",
            remedy="omit that channel",
        )
    return (rho * lamp) @ curves / white


def _descended(raw: Array, wanted: Array, start: Array) -> Array:
    """The matrix of least mean Delta E*ab near ``start``.

    The mean of lengths has kinks where a patch is exact, so each length is rounded off by a
    softening that shrinks. Newton's steps leave out the curvature of CIELAB, which is small beside
    that of the lengths.
    """
    matrix = start
    for softening in _SOFTENINGS:
        lengths, missed = _soft_lengths(raw, wanted, matrix, softening)
        for _ in range(_MOST_STEPS):
            slopes = np.einsum("mlx,mp->mlxp", LAB.jacobian(raw @ matrix.T, _WHITE), raw)
            slopes = slopes.reshape(*missed.shape, -1)
            along = np.einsum("ml,mla->ma", missed / lengths[:, None], slopes)
            curved = np.einsum("mla,mlb,m->ab", slopes, slopes, 1 / lengths)
            hessian = curved - np.einsum("ma,mb,m->ab", along, along, 1 / lengths)
            damped = hessian + (1e-12 * np.trace(curved) + 1e-300) * np.eye(start.size)
            step = solve("matrix of least Delta E*ab", damped, along.sum(axis=0))
            share, before = 1.0, lengths.mean()
            while share > _SHORTEST:
                tried = matrix - share * step.reshape(start.shape)
                lengths, missed = _soft_lengths(raw, wanted, tried, softening)
                if lengths.mean() <= before:
                    matrix = tried
                    break
                share /= 2
            if before - lengths.mean() < 1e-14 * before:
                break
    return matrix


def _soft_lengths(
    raw: Array, wanted: Array, matrix: Array, softening: float
) -> tuple[Float[Array, " m"], Float[Array, "m 3"]]:
    """(d^2 + softening^2)^(1/2) of the color differences d, and their three coordinates."""
    missed = cielab(raw @ matrix.T, _WHITE) - wanted
    return np.sqrt(np.sum(missed**2, axis=-1) + softening**2), missed


@dataclass(frozen=True, kw_only=True, eq=False)
class MatrixReport:
    """Color error, noise and other properties of one matrix for one sensor.

    Attributes
    ----------
    made_by
        Method of the matrix.
    color_error_mean, color_error_max
        CIE 1976 color difference over the chart, without noise; ``None`` where X, Y or Z
        of the sensor's white is not above 0.
    snr_db
        SNR of each coordinate of the patch, by default a perfect white; ``None`` for a coordinate
        without signal, and ``None`` in place of the list where a channel is saturated. [dB]
    condition
        Largest over smallest singular value of the white-normalized matrix; inf where it is
        rank-deficient.
    psi
        Kodak's noise gain of the white-normalized matrix. [1]
    nir_color
        Per coordinate, the signed ratio of the white's signal from beyond 700 nm to its signal
        from the visible: the false color caused by near-infrared reflectance.
    nir_norm
        Per coordinate, the norm of the effective filter beyond 700 nm over its norm in the
        visible. Positive and negative parts that cancel in ``nir_color`` do not cancel here.

    chart, patch
        What the color error and the SNR are of.

    Both of the infrared are ``None`` where the visible part of a coordinate is zero.
    """

    made_by: str
    color_error_mean: float | None
    color_error_max: float | None
    snr_db: dict[str, float | None] | None
    condition: float
    psi: float
    nir_color: dict[str, float] | None
    nir_norm: dict[str, float] | None
    chart: str = "the ColorChecker"
    patch: str = "a perfect white"


def effective_filters(
    matrix: ColorMatrix, sensor: Sensor, exposure: Exposure
) -> Float[Array, "n c"]:
    """F C^T: spectral response of each color coordinate, filters and matrix combined.

    In lx per unit of light of the matrix's metric; for a matrix without color error it equals H.

    Parameters
    ----------
    matrix
        The color matrix. [lx/e-]

    Raises
    ------
    InputError
        If the channels of sensor and matrix differ.
    """
    check.same_names("effective filters", sensor=sensor.names, matrix=matrix.channels)
    return measurement_vectors(sensor, exposure, matrix.metric) @ matrix.matrix.T


def matrix_report(
    matrix: ColorMatrix,
    sensor: Sensor,
    exposure: Exposure,
    illuminant: Illuminant,
    *,
    level_lux: float,
    chart: Spectra | None = None,
    patch: Spectra | None = None,
) -> MatrixReport:
    """Color error, noise of a perfect white, condition, Psi and near-infrared response of a matrix.

    Parameters
    ----------
    matrix
        From raw electrons to XYZ.
    sensor, exposure
        The sensor and its exposure settings.
    illuminant
        The lamp that lights chart and white.
    level_lux
        Illuminance on the white. [lx]
    chart
        Reflectances for the color error; ``None`` for the ColorChecker.
    patch
        Reflectance whose SNR is reported; ``None`` for a perfect white.

    Raises
    ------
    InputError
        If the grid extends beyond 400-1050 nm (the range of the chart's data), channels or grids
        differ, or X, Y or Z of the lamp's white is 0.
    """
    white = flat_field(illuminant, level_lux=level_lux)
    white_e = expected_electrons(white, sensor, exposure)
    white_xyz = scene_xyz(white, matrix.metric, matrix.observer)
    normalized = white_normalized(matrix.matrix, white_e, white_xyz)
    error = chart_color_error(sensor, matrix, exposure, illuminant, chart)
    patch_e, patch_xyz = white_e, white_xyz
    if patch is not None:
        scene = replace(white, reflectance=patch.values[:, 0])
        patch_e = expected_electrons(scene, sensor, exposure)
        patch_xyz = scene_xyz(scene, matrix.metric, matrix.observer)
    decibels = signal_snr_db(colored(with_noise(patch_e, sensor, exposure), matrix), patch_xyz)
    filters = effective_filters(matrix, sensor, exposure)
    answers = filters * light(white, matrix.metric)[:, None]
    beyond = is_infrared(sensor.grid)
    full = bool(saturated(patch_e, sensor, exposure).any())
    named_db = dict(zip(matrix.coordinates, decibels.tolist(), strict=True))
    return MatrixReport(
        made_by=matrix.made_by,
        color_error_mean=None if error is None else float(error.mean()),
        color_error_max=None if error is None else float(error.max()),
        snr_db=None if full else {k: None if np.isnan(v) else v for k, v in named_db.items()},
        condition=_condition(normalized),
        psi=noise_gain(normalized),
        nir_color=_named(matrix, answers[beyond].sum(axis=0), answers[~beyond].sum(axis=0)),
        nir_norm=_named(
            matrix, *(np.linalg.norm(filters[part], axis=0) for part in (beyond, ~beyond))
        ),
        chart=chart_title(chart),
        patch="a perfect white" if patch is None else f"patch {patch.names[0]}",
    )


def _condition(matrix: Float[Array, "c p"]) -> float:
    singular = svd("color matrix", matrix, compute_uv=False)
    full = singular[-1] > RANK_TOLERANCE * singular[0]
    return float(singular[0] / singular[-1]) if full else float("inf")


def _named(
    matrix: ColorMatrix, beyond: Float[Array, " c"], visible: Float[Array, " c"]
) -> dict[str, float] | None:
    if not visible.all():
        return None
    ratios = (float(ratio) for ratio in beyond / visible)
    return dict(zip(matrix.coordinates, ratios, strict=True))
