"""Color error against noise at an operating point, and matrix reports as plain data."""

from typing import Any

import numpy as np

from chromanoise import __version__, _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import reflectance_notes
from chromanoise.analysis.priors import DEFAULT_PRIOR, refuse_unknown_prior, training_named
from chromanoise.analysis.undefined import defined, plain_fields
from chromanoise.color import ColorMatrix, ParetoCurve, pareto
from chromanoise.errors import InputError
from chromanoise.exposure import OperatingPoint
from chromanoise.metrics import MatrixReport
from chromanoise.spectra import Spectra, observer_notes

_LIGHTEST, _HEAVIEST = 1e-15, 1e15  # limits of double precision


def noise_weights(first: float, last: float, *, points: int = 13) -> Float[Array, " q"]:
    """Weights of the noise from first to last, equally spaced in their logarithm. [1]

    Parameters
    ----------
    first
        Lowest weight, > 0. [1]
    last
        Highest weight. [1]
    points
        Number of weights.

    Raises
    ------
    InputError
        If a weight is not above 0, they do not increase, or ``points`` is not 2 to 100,000.

    Examples
    --------
    >>> noise_weights(0.01, 100.0, points=3)
    array([1.e-02, 1.e+00, 1.e+02])
    """
    for value in (first, last):
        _check.within("weight of the noise", "1", value, _LIGHTEST, _HEAVIEST)
    if not last > first:
        raise InputError(
            "weights of the noise",
            "must rise",
            value=(first, last),
            found=f"go from {first:g} to {last:g}",
            remedy="swap them",
        )
    if not 2 <= points <= 100_000:
        raise InputError("points", "must be 2 to 100000 for a curve", value=points)
    return np.geomspace(first, last, points)


def pareto_of(
    operating_point: OperatingPoint,
    weights: Float[Array, " q"],
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
) -> ParetoCurve:
    """The Pareto curve of color error against noise at an operating point.

    Parameters
    ----------
    operating_point
        A sensor in its light, with its exposure.
    weights
        Weights of the noise: 0 is least squares, 1 LMMSE. [1]
    prior
        The training set: a name from `PRIORS`, or reflectances on the grid.

    Raises
    ------
    InputError
        If there is no prior of that name, or as `chromanoise.color.pareto`.

    Notes
    -----
    Vora & Herley (ICIP 1998), with shot noise.
    """
    refuse_unknown_prior(prior)
    training = training_named(prior, operating_point.illuminant, operating_point.observer)
    return pareto(
        operating_point.sensor,
        operating_point.exposure,
        training,
        weights,
        level_lux=operating_point.level_lux,
    )


def white_snr_db(curve: ParetoCurve, report: MatrixReport) -> tuple[float | None, ...]:
    """SNR of Y along the curve; ``None`` where a channel is saturated on the white. [dB]

    Parameters
    ----------
    curve
        Color error against noise of a matrix.
    report
        Report of the matrix at the same operating point.
    """
    if report.snr_db is None:
        return (None,) * curve.weight.size
    return tuple(defined(float(value)) for value in curve.snr_y_db)


def matrix_as_json(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    report: MatrixReport,
    curve: ParetoCurve | None = None,
) -> dict[str, Any]:
    """A matrix report and its Pareto curve as plain data; undefined values are ``None``.

    Parameters
    ----------
    operating_point
        A sensor in its light, with its exposure.
    matrix
        The color matrix. [lx/e-]
    report
        Color error, noise and conditioning of the matrix.
    curve
        Color error against noise; ``None`` if it was not asked.
    """
    sensor = operating_point.sensor
    return {
        "version": __version__,
        "sensor": sensor.name,
        "label": sensor.label,
        "illuminant": operating_point.illuminant.name,
        "level_lux": operating_point.level_lux,
        "observer": matrix.observer,
        "time_ms": 1e3 * operating_point.exposure.time_s,
        "matrix": plain_fields(matrix, "made_by", "metric", "channels", "coordinates")
        | {"lux_per_e": matrix.matrix.tolist()},
        "report": plain_fields(report),
        "pareto": None if curve is None else _points(curve, report),
        "notes": [
            *sensor.notes,
            *operating_point.illuminant.notes,
            *observer_notes(matrix.observer),
            *reflectance_notes(operating_point),
        ],
    }


def _points(curve: ParetoCurve, report: MatrixReport) -> list[dict[str, Any]]:
    snr = white_snr_db(curve, report)
    return [
        {
            "weight": float(weight),
            "color_error_rms_lux": float(curve.color_error_rms[i]),
            "delta_e": curve.delta_e[i],
            "noise_rms_lux": float(curve.noise_rms[i]),
            "snr_y_db": snr[i],
            "lux_per_e": curve.matrix[i].tolist(),
        }
        for i, weight in enumerate(curve.weight)
    ]
