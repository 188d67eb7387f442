"""Report on a color matrix: color error, noise, condition, noise gain Psi, near infrared."""

from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import RANK_TOLERANCE, svd
from chromanoise._shapes import Float
from chromanoise.color import ColorMatrix, colored
from chromanoise.color.noise_gain import noise_gain, white_normalized
from chromanoise.exposure import Exposure, expected_electrons, measurement_vectors
from chromanoise.metrics.accuracy import chart_color_error
from chromanoise.metrics.snr import signal_snr_db
from chromanoise.noise import saturated, with_noise
from chromanoise.scene import flat_field, light
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant, Spectra, chart_title, color_axes, is_infrared


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
    sensor
        The sensor.
    exposure
        Time and lens.

    Raises
    ------
    InputError
        If the channels of sensor and matrix differ.
    """
    _check.same_names("effective filters", sensor=sensor.names, matrix=matrix.channels)
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
    axes = color_axes(sensor.grid, matrix.metric, matrix.observer)
    white_xyz = light(white, matrix.metric) @ axes
    normalized = white_normalized(matrix.matrix, white_e, white_xyz)
    error = chart_color_error(sensor, matrix, exposure, illuminant, chart)
    patch_e, patch_xyz = white_e, white_xyz
    if patch is not None:
        scene = replace(white, reflectance=patch.values[:, 0])
        patch_e = expected_electrons(scene, sensor, exposure)
        patch_xyz = light(scene, matrix.metric) @ color_axes(sensor.grid, matrix.metric)
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
