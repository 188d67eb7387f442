"""Figure 7: the quantum efficiency of every channel."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.figures.style import channel_color, sensor_dashes, sensor_label, shade_nir
from chromanoise.sensor import Sensor
from chromanoise.spectra import INFRARED_FROM_NM

_HALF_WIDTH_NM = 12.0
_GAP, _HEIGHT = 0.02, 0.075  # of the scale: under the letter, and of the letter
_CENTERED: dict[str, Any] = {"ha": "center", "va": "center_baseline"}


def draw_sensitivities(
    sensor: Sensor, ax: Axes, *, top: float | None = None, dashes: Any = None
) -> Axes:
    """Draw quantum efficiency over wavelength, with curve letters and the near infrared shaded.

    Parameters
    ----------
    sensor
        The sensor; all its curves have one dash pattern.
    ax
        Axes of matplotlib to draw on.
    top
        Upper end of the scale, where panels share one. [e-/photon]
    dashes
        The dash pattern, from `sensor_dashes`, where several sensors share a figure.
    """
    wavelength_nm = sensor.grid.wavelength_nm
    dashes = dashes or sensor_dashes([sensor.label])[sensor.label]
    for i, name in enumerate(sensor.names):
        ax.plot(wavelength_nm, sensor.qe[:, i], color=channel_color(name), linestyle=dashes)
    shade_nir(ax, wavelength_nm[-1])
    ax.set(
        xlim=(wavelength_nm[0], wavelength_nm[-1]),
        ylim=(0, top or 1.15 * sensor.qe.max()),
        xlabel="wavelength [nm]",
        ylabel="quantum efficiency [e$^-$/photon]",
        title=sensor_label(sensor.label, sensor.origin),
    )
    for i, name in enumerate(sensor.names):
        at, height = _letter_place(wavelength_nm, sensor.qe, i, ax.get_ylim()[1])
        color = channel_color(name)
        ax.text(at, height, name, color=color, fontweight="bold", fontsize=11, **_CENTERED)
    return ax


def _letter_place(
    wavelength_nm: Float[Array, " n"], qe: Float[Array, "n p"], i: int, top: float
) -> tuple[float, float]:
    """Position of the letter of channel ``i``: at a high, flat part, clear of all curves."""
    inner = (wavelength_nm > wavelength_nm[0] + _HALF_WIDTH_NM) & (
        wavelength_nm < wavelength_nm[-1] - _HALF_WIDTH_NM
    )
    places = [
        _rated_place(wavelength_nm, qe, i, at, side, top)
        for at in wavelength_nm[inner]
        for side in (1, -1)
    ]
    _, at, height = max(places)
    return at, height


def _rated_place(
    wavelength_nm: Float[Array, " n"],
    qe: Float[Array, "n p"],
    i: int,
    at: float,
    side: int,
    top: float,
) -> tuple[float, float, float]:
    """Rating and position of a place above (side 1) or below (-1) the curve."""
    near = qe[np.abs(wavelength_nm - at) <= _HALF_WIDTH_NM]
    own, others = near[:, i], np.delete(near, i, axis=1)
    edge = own.max() if side > 0 else own.min()
    height = edge + side * (_GAP + _HEIGHT / 2) * top
    reach = (_HEIGHT / 2 + _GAP / 2) * top
    low, high = height - reach, height + reach
    hit = ((others.max(axis=0) > low) & (others.min(axis=0) < high)).any()
    outside = low < 0 or high > top
    rating = own.mean() - 3 * np.ptp(own)
    rating += 0.1 * top * (side > 0)  # prefer places above the curve
    rating -= 0.5 * top * (at > INFRARED_FROM_NM)  # prefer the visible range
    rating -= 10 * top * (hit or outside)
    return float(rating), float(at), float(height)
