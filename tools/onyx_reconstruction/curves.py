"""Parameters -> curves.

    W = sigmoid(spline)              absolute quantum efficiency of the bare pixel     [e-/photon]
    R, G, B = W * sigmoid(spline)    resin filters over the same pixel, never above W  [e-/photon]
    IR-cut = one logistic edge       transmittance                                     [1]

Logits keep every curve between 0 and 1 without a bound in the fit.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.interpolate import BSpline

from chromanoise.base.check import Array
from chromanoise.spectra import DEFAULT_GRID

GRID = DEFAULT_GRID
WAVELENGTH_NM = GRID.wavelength_nm
RGB = ("R", "G", "B")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curves:
    """The curves of one set of parameters.

    Attributes
    ----------
    filter_logit
        Logits of the transmittances of the R, G and B resin.
    white_logit
        Logit of the QE of the bare pixel.
    cut
        IR-cut: where it passes 50 %, and how far 90 % and 10 % lie apart. [nm]
    """

    filter_logit: Float[Array, "n 3"]
    white_logit: Float[Array, " n"]
    cut: Float[Array, "2"]


def rgbw_qe(curves: Curves) -> Float[Array, "n 4"]:
    """QE of R, G, B and W without IR-cut. [e-/photon]"""
    white = sigmoid(curves.white_logit)[:, None]
    return np.hstack([white * sigmoid(curves.filter_logit), white])


def ir_cut(curves: Curves) -> Float[Array, " n"]:
    """Transmittance of the IR-cut."""
    edge_nm, width_nm = curves.cut
    return sigmoid((edge_nm - WAVELENGTH_NM) * 2.0 * np.log(9.0) / width_nm)


def sigmoid(x: Float[Array, "*any"]) -> Float[Array, "*any"]:
    """The number between 0 and 1 whose logit is ``x``."""
    return 1.0 / (1.0 + np.exp(-x))


def logit(share: Float[Array, "*any"]) -> Float[Array, "*any"]:
    """log(p / (1 - p)) of a number between 0 and 1."""
    return np.log(share / (1.0 - share))


def _spline_basis(count: int, degree: int = 3) -> Float[Array, "n k"]:
    """``count`` uniform B-splines on the grid, clamped at its ends."""
    first, last = WAVELENGTH_NM[0], WAVELENGTH_NM[-1]
    inner = np.linspace(first, last, count - degree + 1)
    knots = np.concatenate([[first] * degree, inner, [last] * degree])
    return np.asarray(BSpline.design_matrix(WAVELENGTH_NM, knots, degree).toarray())


FILTER_BASIS = _spline_basis(22)
WHITE_BASIS = _spline_basis(11)  # silicon is smoother than resins
FILTER_COUNT = 3 * FILTER_BASIS.shape[1]
SPLINE_COUNT = FILTER_COUNT + WHITE_BASIS.shape[1]


def curves_of(parameters: Float[Array, " k"]) -> Curves:
    """The curves of: three filter splines, the spline of W, edge and width of the IR-cut."""
    filters, white, cut = np.split(parameters, [FILTER_COUNT, SPLINE_COUNT])
    return Curves(
        filter_logit=FILTER_BASIS @ filters.reshape(3, -1).T,
        white_logit=WHITE_BASIS @ white,
        cut=cut,
    )


def parameters_near(curves: Curves) -> Float[Array, " k"]:
    """The parameters whose curves come closest to ``curves`` (in logits, least squares)."""
    filters = np.linalg.lstsq(FILTER_BASIS, curves.filter_logit, rcond=None)[0].T
    white = np.linalg.lstsq(WHITE_BASIS, curves.white_logit, rcond=None)[0]
    return np.concatenate([filters.ravel(), white, curves.cut])
