"""Quantum efficiency from the photons of a photon transfer."""

import numpy as np

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.sensor.photon_transfer_levels import Levels

_IMPOSSIBLE_Z = 5.0  # standard errors above 1 beyond which the photons cannot be right


def quantum_efficiency(
    levels: Levels,
    photons: Array | None,
    gain: float,
    gain_se: float,
    source: str,
    notes: list[str],
) -> tuple[float | None, float | None]:
    """QE = responsivity / gain; the error of the responsivity is from the scatter of its fit."""
    if photons is None or not levels.black_known:
        return None, None
    if not photons.max() > 0:
        raise InputError(
            source,
            "must be > 0 in a lit row",
            value=0.0,
            found="is 0 in all of them",
            where="column 'photons'",
            remedy="omit the column",
        )
    response, error = _slope_through_origin(photons, levels.x)
    qe = response / gain
    qe_se = abs(qe) * float(np.hypot(error / response, gain_se / gain)) if response else error
    if not 0 <= qe <= 1 + _IMPOSSIBLE_Z * qe_se:
        raise InputError(
            source,
            "must give a quantum efficiency of 0 to 1 [e-/photon]",
            value=qe,
            found=f"gives {qe:.4g} +- {qe_se:.2g}",
            where="column 'photons'",
            remedy=("give the mean photons per pixel and exposure", "omit the column"),
        )
    if qe > 1:
        notes.append(f"{source}: the QE of {qe:.4g} +- {qe_se:.2g} lies above 1 within its error")
    return qe, qe_se


def _slope_through_origin(x: Array, y: Array) -> tuple[float, float]:
    """Slope of y = a x by unweighted least squares; its error from the scatter about the line."""
    slope = float(x @ y) / float(x @ x)
    scatter = (x * (y - slope * x)) ** 2
    return slope, float(np.sqrt(scatter.sum() * x.size / max(x.size - 1, 1))) / float(x @ x)
