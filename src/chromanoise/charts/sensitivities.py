"""Light and channels over the wavelength."""

from typing import Any

from chromanoise.charts.shown import Look, Shown
from chromanoise.spectra import INFRARED_FROM_NM


def drawn_sensitivities(shown: Shown, look: Look) -> dict[str, Any]:
    """Quantum efficiency of each channel, and the light's power in parts of its peak."""
    lamp = shown.situations[0].illuminant
    power = lamp.irradiance
    return {
        "wavelength_nm": lamp.grid.wavelength_nm.tolist(),
        "infrared_from_nm": INFRARED_FROM_NM,
        "light": (power / power.max()).tolist(),
        "light_name": lamp.name,
        "sensors": [
            {
                "name": one.sensor.name,
                "channels": [
                    {"name": name, "qe": one.sensor.qe[:, i].tolist()}
                    for i, name in enumerate(one.sensor.names)
                ],
            }
            for one in shown.situations
        ],
    }
