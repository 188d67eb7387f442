"""Spectrum of the light and quantum efficiencies over wavelength."""

from collections.abc import Sequence
from functools import partial

from chromanoise.charts.charted_study import Look, Shown
from chromanoise.charts.description import Area, Axis, Band, Chart, Line, Mark, Panel, column
from chromanoise.charts.numbers import decimal, listed
from chromanoise.sensor import Sensor
from chromanoise.spectra import INFRARED_FROM_NM, Illuminant

_ABOVE = 1.15  # of the highest value: the room for its letter


def drawn_sensitivities(shown: Shown, look: Look) -> Chart:
    """Quantum efficiency of each channel, and the light's power relative to its peak."""
    points = shown.operating_points
    return sensitivities_chart([one.sensor for one in points], points[0].illuminant)


def sensitivities_chart(sensors: Sequence[Sensor], lamp: Illuminant | None = None) -> Chart:
    """The chart ``sensitivities`` of some sensors on one grid.

    Parameters
    ----------
    lamp
        The light; ``None`` for none.
    """
    wavelength_nm = sensors[0].grid.wavelength_nm.tolist()
    rows, columns = len(wavelength_nm), [column("wavelength [nm]", wavelength_nm, "{:g}".format)]
    first: list[Mark] = [Band(low=INFRARED_FROM_NM, name="near infrared")]
    if lamp is not None:
        relative = (lamp.irradiance / lamp.irradiance.max()).tolist()
        head, text = f"light {lamp.name}, relative", partial(decimal, digits=3)
        columns.append(column(head, relative, text, shown="light, relative"))
        first.insert(0, Area(x=0, y=1, first=0, last=rows, name=f"light {lamp.name}"))
    x = Axis(label="wavelength [nm]", low=wavelength_nm[0], high=wavelength_nm[-1], exact=True)
    highest = _ABOVE * max(float(sensor.qe.max()) for sensor in sensors)
    label = "quantum efficiency [e⁻/photon]"
    y = Axis(label=label, low=0.0, high=max(0.01, highest), exact=True)
    panels = []
    for i, sensor in enumerate(sensors):
        marks = list(first)
        for c, name in enumerate(sensor.names):
            y_column = len(columns)
            marks.append(
                Line(x=0, y=y_column, first=0, last=rows, name=name, sensor=i, channel=name)
            )
            head = f"{sensor.label} {name} [e-/photon]"
            columns.append(column(head, sensor.qe[:, c].tolist(), partial(decimal, digits=4)))
        panels.append(Panel(x=x, y=y, marks=tuple(marks), sensor=i))
    # neither level nor exposure changes these curves, so the title names only the illuminant
    beside = "" if lamp is None else f", and illuminant {lamp.name}"
    return Chart(
        title=f"Quantum efficiency of each channel{beside}",
        description=_description(sensors, wavelength_nm),
        sensors=tuple(sensor.label for sensor in sensors),
        columns=tuple(columns),
        panels=tuple(panels),
    )


def _description(sensors: Sequence[Sensor], wavelength_nm: Sequence[float]) -> str:
    parts = [
        f"Quantum efficiency from {wavelength_nm[0]:g} to {wavelength_nm[-1]:g} nm, near infrared "
        f"from {INFRARED_FROM_NM:g} nm shaded, the light as a faint area. Highest values:"
    ]
    for sensor in sensors:
        peaks = [
            f"{name} {decimal(qe.max(), 2)} at {wavelength_nm[int(qe.argmax())]:g} nm"
            for name, qe in zip(sensor.names, sensor.qe.T, strict=True)
        ]
        parts.append(f"{sensor.label}: {listed(peaks)}.")
    return " ".join(parts)
