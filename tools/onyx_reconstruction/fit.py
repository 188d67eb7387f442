"""Least squares: curves that return the printed figures and look like silicon and resins."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

from chromanoise.apps.paper import printed_numbers as paper
from chromanoise.base.check import Array
from chromanoise.base.rng import stream
from chromanoise.base.units import from_decibel
from onyx_reconstruction.curves import (
    FILTER_COUNT,
    SPLINE_COUNT,
    Curves,
    curves_of,
    ir_cut,
    parameters_near,
    rgbw_qe,
)
from onyx_reconstruction.predictions import (
    PRINTED_ANGLES_DEG,
    PRINTED_SNRS,
    PRINTED_TIMES_MS,
    Prediction,
    predicted,
    signed_snr,
    snrs_db,
)
from onyx_reconstruction.priors import PRIOR, prior_residuals

# The misfit that counts as one unit. The angles are printed to 0.1 deg and the times to 1 ms,
# but two numbers among so many need little room to be met.
_SIGMA_DB = 0.09  # about the 0.087 dB of the paper's Monte Carlo with 5000 draws
_QUARTIC_DB = 0.13  # a second residual (x / 0.13)^2 pushes the largest misfits down first
_SIGMA_ANGLE_DEG = 0.01
_SIGMA_TIME_MS = np.array([0.02, 0.1])
_RED_MARGIN, _SIGMA_RED = 0.002, 0.0015  # red leads green and blue behind the IR-cut, relative
_MIX_R2, _SIGMA_MIX = 0.98, 0.002  # "RGBW with IR-cut is singular": W is nearly a mix there

STARTS, SEED = 6, 2019
_SPREAD_FILTER, _SPREAD_WHITE = 0.7, 0.07  # disturbance of a start [logit]
_SPREAD_CUT_NM = np.array([2.8, 1.4])
_LOWER = np.concatenate([np.full(SPLINE_COUNT, -12.0), [630.0, 5.0]])
_UPPER = np.concatenate([np.full(SPLINE_COUNT, 8.0), [710.0, 40.0]])
_MOST_EVALUATIONS = 150
_TOLERANCE, _POLISHED_TOLERANCE = 1e-7, 1e-11  # of the cost and of the step, relative


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fit:
    """Where one start ended.

    Attributes
    ----------
    parameters
        See `curves_of`.
    cost
        Half the sum of squared residuals.
    evaluations
        How many steps were tried.
    """

    parameters: Float[Array, " k"]
    cost: float
    evaluations: int


def start(number: int) -> Float[Array, " k"]:
    """Where to begin: at the priors for number 0, else at the priors disturbed.

    Some starts would stick where a contravariant coordinate has the wrong sign.
    """
    priors = parameters_near(PRIOR)
    if number == 0:
        return priors
    scale = np.full(priors.size, _SPREAD_FILTER)
    scale[FILTER_COUNT:SPLINE_COUNT] = _SPREAD_WHITE
    scale[SPLINE_COUNT:] = _SPREAD_CUT_NM
    return priors + scale * stream(SEED, number).standard_normal(priors.size)


def fitted(
    first: Float[Array, " k"],
    *,
    tolerance: float = _TOLERANCE,
    most_evaluations: int = _MOST_EVALUATIONS,
) -> Fit:
    """The optimum near ``first``."""
    result = least_squares(
        residuals,
        np.clip(first, _LOWER + 0.1, _UPPER - 0.1),
        bounds=(_LOWER, _UPPER),
        x_scale="jac",
        max_nfev=most_evaluations,
        ftol=tolerance,
        xtol=tolerance,
    )
    return Fit(parameters=result.x, cost=float(result.cost), evaluations=int(result.nfev))


def polished(fit: Fit) -> Fit:
    """The same optimum so sharply that another start or machine ends within 1e-5 of its curves."""
    return fitted(fit.parameters, tolerance=_POLISHED_TOLERANCE)


def residuals(parameters: Float[Array, " k"]) -> Float[Array, " m"]:
    """All misfits in units of their sigma, to figures first and to priors after."""
    curves = curves_of(parameters)
    return np.concatenate([*_figure_residuals(curves), *prior_residuals(curves)])


def misfits_db(prediction: Prediction) -> Float[Array, " k"]:
    """Ours minus printed, in the order of `PRINTED_SNRS`. [dB]"""
    return snrs_db(prediction) - np.array([p.db for p in PRINTED_SNRS])


def _figure_residuals(curves: Curves) -> list[Float[Array, " m"]]:
    prediction = predicted(curves)
    db = _smooth_misfits_db(prediction)
    angles = [prediction.angles_deg[c] - deg for c, deg in PRINTED_ANGLES_DEG.items()]
    times = [prediction.times_ms[s] - ms for s, ms in PRINTED_TIMES_MS.items()]
    return [
        db / _SIGMA_DB,
        np.minimum(np.abs(db), 1.0) * db / _QUARTIC_DB**2,
        np.array(angles) / _SIGMA_ANGLE_DEG,
        np.array(times) / _SIGMA_TIME_MS,
        _red_falls_short(prediction) / _SIGMA_RED,
        np.array([max(_MIX_R2 - _mix_r2(curves), 0.0) / _SIGMA_MIX]),
    ]


def _smooth_misfits_db(prediction: Prediction) -> Float[Array, " k"]:
    """As `misfits_db`, but smooth where a contravariant coordinate changes its sign.

    The logarithm of |mean / sd| puts a barrier there that no start would cross; 8.686 (ratio /
    printed ratio - 1) is the same to first order. Printed signs are taken as positive.
    """
    misfits = misfits_db(prediction)
    for i, printed in enumerate(PRINTED_SNRS):
        if printed.kind == "contravariant":
            wanted = from_decibel(np.array(printed.db))
            misfits[i] = 20.0 / np.log(10.0) * (signed_snr(prediction, printed) / wanted - 1.0)
    return misfits


def _red_falls_short(prediction: Prediction) -> Float[Array, "2"]:
    """How far green and blue miss staying below red behind the IR-cut: the paper's text."""
    red, *others = prediction.columns[paper.RGB_59]["raw"].mean
    return np.maximum(np.array(others) / red - 1.0 + _RED_MARGIN, 0.0)


def _mix_r2(curves: Curves) -> float:
    """R^2 of W behind the IR-cut as a mix of R, G and B behind it (no intercept)."""
    behind = rgbw_qe(curves) * ir_cut(curves)[:, None]
    colors, white = behind[:, :3], behind[:, 3]
    rest = white - colors @ np.linalg.lstsq(colors, white, rcond=None)[0]
    return float(1.0 - rest @ rest / np.sum((white - white.mean()) ** 2))
