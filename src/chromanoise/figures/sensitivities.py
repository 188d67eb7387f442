"""Figure 7: the quantum efficiency of every channel."""

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from chromanoise.figures.style import channel_color, sensor_dashes, sensor_label, shade_nir
from chromanoise.sensor import Sensor

Array = np.ndarray


def draw_sensitivities(sensor: Sensor, ax: Axes, *, top: float | None = None) -> Axes:
    """Quantum efficiency over wavelength, each curve with its letter, the near infrared shaded.

    Parameters
    ----------
    sensor
        Its curves are drawn with the sensor's own dash pattern.
    top
        Upper end of the scale, where panels share one. [e-/photon]
    """
    wavelength_nm = sensor.grid.wavelength_nm
    dashes = sensor_dashes(sensor.name)
    for i, name in enumerate(sensor.names):
        ax.plot(wavelength_nm, sensor.qe[:, i], color=channel_color(name), linestyle=dashes)
    shade_nir(ax, wavelength_nm[-1])
    ax.set(
        xlim=(wavelength_nm[0], wavelength_nm[-1]),
        ylim=(0, top or 1.15 * sensor.qe.max()),
        xlabel="wavelength [nm]",
        ylabel="quantum efficiency [e$^-$/photon]",
        title=sensor_label(sensor.name, sensor.notes),
    )
    for i, name in enumerate(sensor.names):
        _letter(ax, wavelength_nm, sensor.qe, i, name)
    return ax


def _letter(
    ax: Axes, wavelength_nm: Float[Array, " n"], qe: Float[Array, "n p"], i: int, name: str
) -> None:
    """The channel's letter where its curve stands farthest from every other: no legend needed."""
    at = _clearest(qe, i)
    ax.annotate(
        name,
        (wavelength_nm[at], qe[at, i]),
        xytext=(0, 5),
        textcoords="offset points",
        ha="center",
        va="bottom",
        color=channel_color(name),
        fontweight="bold",
        fontsize=11,
    )


def _clearest(qe: Float[Array, "n p"], i: int) -> int:
    """Index at which channel ``i`` is high and has most room above it."""
    others = np.delete(qe, i, axis=1)
    room = np.where(others > qe[:, i : i + 1], others - qe[:, i : i + 1], np.inf)
    above = np.minimum(room.min(axis=1, initial=np.inf), 0.25 * qe.max())
    inner = slice(len(qe) // 40, -len(qe) // 40)
    score = qe[:, i] * above
    return int(np.argmax(score[inner])) + len(qe) // 40
