"""What silicon and resins look like, and how far curves are from it.

The figures of Tables 2-5 are 27 numbers and the curves have 79 parameters: the shape between
the figures comes from here. The curves below were chosen by hand, after data sheets of similar
sensors; T_PRIOR in particular decides which of the families of curves that fit the figures
equally well is found.

A residual of 1 is the misfit that costs as much as one unit of misfit to a figure.
"""

import numpy as np
from jaxtyping import Float
from scipy.interpolate import PchipInterpolator

from chromanoise.base.check import Array
from onyx_reconstruction.curves import GRID, RGB, WAVELENGTH_NM, Curves, logit, rgbw_qe

# fmt: off
_W_POINTS = {
    400: .30, 450: .37, 500: .44, 550: .51, 600: .57, 650: .60, 700: .60, 750: .55, 800: .44,
    850: .29, 900: .17, 950: .09, 1000: .05, 1050: .03,
}
_T_POINTS = {
    "R": {
        400: .03, 430: .02, 555: .02, 575: .10, 596: .45, 616: .80, 645: .90, 700: .92, 850: .92,
        1050: .92,
    },
    "G": {
        400: .03, 470: .05, 487: .15, 507: .50, 527: .83, 547: .92, 570: .85, 596: .60, 620: .36,
        655: .19, 690: .17, 715: .25, 740: .55, 770: .80, 850: .90, 1050: .92,
    },
    "B": {
        400: .40, 420: .72, 450: .89, 488: .85, 515: .60, 545: .38, 578: .28, 618: .20, 655: .10,
        690: .04, 720: .10, 745: .45, 770: .80, 850: .90, 1050: .92,
    },
}
# Where the QE of a color channel shall rise (+1) or fall (-1), so that it has one lobe in the
# visible and one in the infrared: (from_nm, to_nm, sign). It is free elsewhere.
_QE_SLOPES = {
    "R": ((400, 480, -1), (500, 640, +1), (780, 1050, -1)),
    "G": ((400, 520, +1), (560, 660, -1), (685, 740, +1), (810, 1050, -1)),
    "B": ((400, 440, +1), (490, 680, -1), (700, 760, +1), (820, 1050, -1)),
}
# fmt: on
_RESIN_OPENS_NM = (500.0, 750.0, 750.0)  # beyond, the transmittance of R, G, B never falls
_WHITE_SLOPES = ((400, 580, +1), (690, 1050, -1))

# Logits and their second differences count once per this distance, whatever the grid's step.
_COUNT_PER_NM = 1.0 / 38.0
_DENSITY = np.sqrt(GRID.step_nm * _COUNT_PER_NM)

_SIGMA_W, _SIGMA_W_BEND = 0.20, 0.004  # W from its prior; second difference of that [logit]
_SIGMA_T, _SIGMA_T_BEND = 0.4, 0.05  # filters from theirs in the visible; second difference
_SIGMA_T_NIR = 0.5  # filters from their prior in the NIR
_SIGMA_T_SPREAD = 0.25  # resins from each other in the NIR, where all are clear
_NIR = WAVELENGTH_NM >= 850.0
_T_TOP, _SIGMA_TOP = 0.95, 0.1  # no resin passes more
_SIGMA_SLOPE = 0.0025  # a slope of the wrong sign [log unit per step]
_SIGMA_CUT_NM = np.array([2.0, 4.0])


def _logit_through(points: dict[int, float]) -> Float[Array, " n"]:
    """Logits on the grid, smooth and without overshoot through (wavelength, share)."""
    shares = np.array(list(points.values()))
    return np.asarray(PchipInterpolator(list(points), logit(shares))(WAVELENGTH_NM))


W_PRIOR = _logit_through(_W_POINTS)
T_PRIOR = np.stack([_logit_through(_T_POINTS[name]) for name in RGB], axis=1)
CUT_PRIOR = np.array([670.0, 18.0])
PRIOR = Curves(filter_logit=T_PRIOR, white_logit=W_PRIOR, cut=CUT_PRIOR)


def _signs(slopes: tuple[tuple[int, int, int], ...]) -> Float[Array, " n-1"]:
    """The wanted sign of each first difference; 0 where it is free."""
    middle = (WAVELENGTH_NM[1:] + WAVELENGTH_NM[:-1]) / 2.0
    return np.sum([sign * ((middle > a) & (middle < b)) for a, b, sign in slopes], axis=0)


_QE_SIGNS = np.stack([_signs(_QE_SLOPES[name]) for name in RGB], axis=1)
_RESIN_SIGNS = (WAVELENGTH_NM[1:, None] > np.array(_RESIN_OPENS_NM)).astype(np.float64)
_WHITE_SIGNS = _signs(_WHITE_SLOPES)


def prior_residuals(curves: Curves) -> list[Float[Array, " m"]]:
    """How far ``curves`` are from generic silicon, resins and IR-cut."""
    return [
        *_filter_residuals(curves.filter_logit),
        *_white_residuals(curves.white_logit),
        _wrong_slope(np.log(rgbw_qe(curves)[:, :3]), _QE_SIGNS),
        (curves.cut - CUT_PRIOR) / _SIGMA_CUT_NM,
    ]


def _filter_residuals(t: Float[Array, "n 3"]) -> list[Float[Array, " m"]]:
    sigma = np.where(_NIR, _SIGMA_T_NIR, _SIGMA_T)[:, None]
    spread = t[_NIR] - t[_NIR].mean(axis=1, keepdims=True)
    return [
        _DENSITY * ((t - T_PRIOR) / sigma).ravel(),
        _DENSITY * (spread / _SIGMA_T_SPREAD).ravel(),
        _DENSITY * (np.diff(t, 2, axis=0) / _SIGMA_T_BEND).ravel(),
        _DENSITY * (np.maximum(t - logit(np.array(_T_TOP)), 0.0) / _SIGMA_TOP).ravel(),
        _wrong_slope(t, _RESIN_SIGNS),
    ]


def _white_residuals(w: Float[Array, " n"]) -> list[Float[Array, " m"]]:
    deviation = w - W_PRIOR
    return [
        _DENSITY * deviation / _SIGMA_W,
        _DENSITY * np.diff(deviation, 2) / _SIGMA_W_BEND,
        _wrong_slope(w, _WHITE_SIGNS),
    ]


def _wrong_slope(curve: Float[Array, "n *k"], signs: Float[Array, "n-1 *k"]) -> Float[Array, " m"]:
    """How far first differences go against ``signs``: a hinge, free of cost on the right side."""
    return np.maximum(-signs * np.diff(curve, axis=0), 0.0).ravel() / _SIGMA_SLOPE
