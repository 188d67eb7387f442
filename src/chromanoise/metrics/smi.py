"""Sensitivity metamerism index (ISO 17321): color error that remains with the best matrix."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._colour_science import colour_science
from chromanoise._linalg import lstsq
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.sensor import Sensor
from chromanoise.spectra import cie_1931
from chromanoise.spectra.metric import photons_per_unit

PENALTY = 5.5
"""Slope of the index: SMI = 100 - 5.5 mean Delta E*ab."""

_CUBE_ROOT_FROM = (6.0 / 29.0) ** 3  # below it CIELAB is linear
_FAINTEST = 1e-9  # Delta E*ab below which the gradient of the difference is set to 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        _check.same_length("rows", matrix=self.matrix.shape[0], XYZ=3)
        _check.freeze(self, "color_error", "matrix")


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
    entries: white is not preserved. Quasi-Newton steps start at least squares on XYZ.

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
    wanted = _lab(_white_balanced("eye", eye, illuminant, reflectance))
    seen = _white_balanced("eye", eye, illuminant, reflectance)
    start = lstsq("white-balanced patches", raw, seen, rcond=None)
    matrix = _descended(raw, wanted, np.asarray(start[0].T))
    error = np.linalg.norm(_lab(raw @ matrix.T) - wanted, axis=-1)
    return Metamerism(index=float(100.0 - PENALTY * error.mean()), color_error=error, matrix=matrix)


def sensor_metamerism(sensor: Sensor) -> Metamerism:
    """SMI of a sensor with the light and patches of the standard: D55, 18 colors of the chart.

    Outside 380-780 nm, where neither is defined, the sensor's response is set to 0.

    Parameters
    ----------
    sensor
        The sensor.

    Raises
    ------
    InputError
        If the sensor's grid does not overlap 380-780 nm, or a channel receives no light there.

    Notes
    -----
    ISO 17321-1:2012, annex D. Patches from colour-science under that name (identical to those of
    Ohta, 1997), D55 of CIE 015, observer CIE 1931; all with linear interpolation between samples.
    """
    colour = colour_science()

    lamp = colour.SDS_ILLUMINANTS["D55"]
    chart = list(colour.SDS_COLOURCHECKERS["ISO 17321-1"].values())[:18]
    at = sensor.grid.wavelength_nm
    inside = (at >= chart[0].wavelengths[0]) & (at <= chart[0].wavelengths[-1])
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
        np.interp(at[inside], lamp.wavelengths, lamp.values),
        np.array([np.interp(at[inside], sd.wavelengths, sd.values) for sd in chart]),
    )


def _white_balanced(name: str, axes: Array, illuminant: Array, reflectance: Array) -> Array:
    """Responses to the patches over the response to white, one row per patch."""
    curves = _check.finite(name, "1", axes)
    lamp = _check.non_negative("illuminant", "1", illuminant)
    rho = _check.non_negative("reflectance", "1", reflectance)
    _check.same_length(
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
    """The matrix of least mean Delta E*ab near ``start``."""
    from scipy.optimize import minimize

    def mean_error(entries: Array) -> tuple[float, Array]:
        xyz = raw @ entries.reshape(start.shape).T
        missed = _lab(xyz) - wanted
        length = np.linalg.norm(missed, axis=-1)
        far = length > _FAINTEST
        direction = missed / np.where(far, length, 1.0)[:, None] * far[:, None]
        uphill = np.einsum("ml,lx,mx,mp->xp", direction, _LAB_FROM_F, _slope(xyz), raw)
        return float(length.mean()), uphill.ravel() / len(raw)

    entries = start.ravel()
    for _ in range(4):  # restart with a new Hessian estimate: the mean of lengths has kinks
        entries = minimize(mean_error, entries, jac=True, method="BFGS", options={"gtol": 1e-9}).x
    return np.asarray(entries.reshape(start.shape))


_LAB_FROM_F = np.array([[0.0, 116.0, 0.0], [500.0, -500.0, 0.0], [0.0, 200.0, -200.0]])


def _lab(xyz: Array) -> Array:
    """CIELAB of XYZ relative to white (CIE 015:2018, eq. 8.3-8.8)."""
    straight = xyz / (3.0 * (6.0 / 29.0) ** 2) + 4.0 / 29.0
    f = np.where(xyz > _CUBE_ROOT_FROM, np.cbrt(xyz), straight)
    return f @ _LAB_FROM_F.T - np.array([16.0, 0.0, 0.0])


def _slope(xyz: Array) -> Array:
    """df/dX of the f in `_lab`."""
    bright = np.cbrt(np.maximum(xyz, _CUBE_ROOT_FROM))
    return 1.0 / (3.0 * bright**2)
