"""Color error against noise at an operating point.

Total color error: bias and noise together, over a chart.

A matrix or a sensor that desaturates colors has less noise and a better SNR, but wrong colors. The
total error counts both, in CIELAB: E|x - x_true|^2 = |bias|^2 + trace of the covariance.
"""

from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from chromanoise.base import Array, Float, InputError, check, defined
from chromanoise.color import (
    LAB,
    ColorMatrix,
    Method as PropagationMethod,
    ParetoCurve,
    cubature,
    gaussian_cubature,
    pareto,
    propagate,
)
from chromanoise.metrics import MatrixReport, chart_lab
from chromanoise.noise import OperatingPoint, Readout, saturated
from chromanoise.spectra import Spectra, chart_on
from chromanoise.study.analysis import (
    Analysis,
    color_snr_db,
    electrons_at,
    noisy_color_at,
    of_white,
    stages_at,
)
from chromanoise.study.color_matrices import (
    DEFAULT_PRIOR,
    matrix_makers,
    refuse_unknown_prior,
    training_named,
)

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
        check.within("weight of the noise", "1", value, _LIGHTEST, _HEAVIEST)
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


NOISY_DELTA_E = 50.0
"""Noise above which a verdict names a better matrix. [Delta E*ab]"""

# error below 4e-3 of a standard deviation
_BY_CUBATURE = partial(cubature, rule=gaussian_cubature(radii=5, latitudes=3, longitudes=6))
_OTHERS = ("least-squares", "white-preserving", "lmmse")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TotalError:
    """Bias, noise and total error of each patch of the chart, as root mean squares.

    Attributes
    ----------
    bias
        Distance of the mean color from the true one: errors of the matrix, of the black level and
        of clipping, and the shift of the mean by noise. [Delta E*ab]
    noise
        Root of the trace of the covariance. [Delta E*ab]
    total
        Root of the sum of both squares. [Delta E*ab]
    """

    bias: Float[Array, " k"]
    noise: Float[Array, " k"]
    total: Float[Array, " k"]

    def __post_init__(self) -> None:
        check.freeze(self, "bias", "noise", "total")


def total_errors(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    *,
    readout: Readout | None = None,
    method: PropagationMethod = _BY_CUBATURE,
) -> TotalError | None:
    """Total color error of the chart at an operating point, by default the ColorChecker.

    ``None`` where a channel is saturated on the white, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    operating_point
        Sensor, exposure and light.
    matrix
        Its color matrix.
    readout
        Clipping and rounding of the values; ``None`` for none.
    method
        Of the noise in CIELAB, as `propagate`; by default from X, Y, Z as jointly normal, by
        cubature.

    Raises
    ------
    InputError
        If the grid extends beyond 400-1050 nm, the range of the chart's data.
    """
    sensor, exposure = operating_point.sensor, operating_point.exposure
    electrons = electrons_at(operating_point)
    white = matrix.matrix @ electrons
    if saturated(electrons, sensor, exposure).any() or not (white > 0).all():
        return None
    chart = operating_point.chart
    lab = chart_lab(sensor, matrix, exposure, operating_point.illuminant, chart)
    if lab is None:
        return None
    reflectance = chart_on(sensor.grid, chart).values.T
    at = stages_at(operating_point, matrix, reflectance=reflectance, readout=readout)
    noise = propagate(noisy_color_at(at, white), LAB, method).measurement
    bias = np.linalg.norm(noise.mean - lab[0], axis=-1)
    spread = noise.variance.sum(axis=-1)
    return TotalError(bias=bias, noise=np.sqrt(spread), total=np.sqrt(bias**2 + spread))


@lru_cache(maxsize=64)  # table, verdict and JSON use the same one
def total_error_of(analysis: Analysis) -> TotalError | None:
    """`total_errors` of an analysis, with its matrix and readout; ``None`` without a color.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    if None in color_snr_db(of_white(analysis)).values():
        return None
    return total_errors(analysis.point, analysis.matrix, readout=analysis.readout)


def mean_total_error(analysis: Analysis) -> float | None:
    """Mean of `TotalError.total` over the patches. [Delta E*ab]

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    error = total_error_of(analysis)
    return None if error is None else float(error.total.mean())


def better_matrix(analysis: Analysis) -> tuple[str, float] | None:
    """The method with the least total error where noise exceeds `NOISY_DELTA_E`, and that error.

    ``None`` where the noise is lower, or no other method is better.

    Parameters
    ----------
    analysis
        With the matrix that is to be replaced.
    """
    own = total_error_of(analysis)
    if own is None or not own.noise.mean() > NOISY_DELTA_E:
        return None
    found: dict[str, float] = {}
    for name, maker in matrix_makers(_OTHERS, analysis.matrix.metric).items():
        error = total_errors(analysis.point, maker(analysis.point), readout=analysis.readout)
        if error is not None:
            found[name] = float(error.total.mean())
    best = min(found, key=lambda name: found[name], default=None)
    if best is None or not found[best] < own.total.mean():
        return None
    return best, found[best]
