"""Spectrum of the light and quantum efficiencies over wavelength."""

from typing import Any

from chromanoise.charts.charted_study import Look, Shown
from chromanoise.charts.numbers import decimal, listed, table
from chromanoise.spectra import INFRARED_FROM_NM


def drawn_sensitivities(shown: Shown, look: Look) -> dict[str, Any]:
    """Quantum efficiency of each channel, and the light's power relative to its peak."""
    lamp = shown.operating_points[0].illuminant
    power = lamp.irradiance
    sensors = [
        {
            "name": one.sensor.label,
            "channels": [
                {"name": name, "qe": one.sensor.qe[:, i].tolist()}
                for i, name in enumerate(one.sensor.names)
            ],
        }
        for one in shown.operating_points
    ]
    wavelength_nm, relative = lamp.grid.wavelength_nm.tolist(), (power / power.max()).tolist()
    return {
        # neither level nor exposure changes these curves, so the title names only the illuminant
        "title": f"Quantum efficiency of each channel, and illuminant {lamp.name}",
        "description": _description(sensors, wavelength_nm),
        "wavelength_nm": wavelength_nm,
        "infrared_from_nm": INFRARED_FROM_NM,
        "light": relative,
        "light_name": lamp.name,
        "sensors": sensors,
        "table": _table(sensors, wavelength_nm, relative),
    }


def _description(sensors: list[dict[str, Any]], wavelength_nm: list[float]) -> str:
    parts = [
        f"Quantum efficiency from {wavelength_nm[0]:g} to {wavelength_nm[-1]:g} nm, near infrared "
        f"from {INFRARED_FROM_NM:g} nm shaded, the light as a faint area. Highest values:"
    ]
    for sensor in sensors:
        peaks = [
            f"{one['name']} {decimal(max(one['qe']), 2)} at "
            f"{wavelength_nm[one['qe'].index(max(one['qe']))]:g} nm"
            for one in sensor["channels"]
        ]
        parts.append(f"{sensor['name']}: {listed(peaks)}.")
    return " ".join(parts)


def _table(
    sensors: list[dict[str, Any]], wavelength_nm: list[float], light: list[float]
) -> dict[str, Any]:
    head = ["wavelength [nm]", "light, relative"]
    columns = [[f"{nm:g}" for nm in wavelength_nm], [decimal(value, 3) for value in light]]
    for sensor in sensors:
        for one in sensor["channels"]:
            head.append(f"{sensor['name']} {one['name']} [e⁻/photon]")
            columns.append([decimal(value, 4) for value in one["qe"]])
    return table(head, list(zip(*columns, strict=True)))
