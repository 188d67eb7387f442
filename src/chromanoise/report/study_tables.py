"""The table behind every chart: what is drawn, in words and numbers, as the drawing modules say it.

A report shows them without a script; where its sliders move, the modules write them anew.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Decimal
from typing import Any

Data = dict[str, Any]
Rows = list[list[str]]

_NONE = "–"
_STAGES = (
    ("raw", "raw SNR [dB]"),
    ("contravariant", "contravariant SNR [dB]"),
    ("spectral", "spectral SNR [dB]"),
    ("color", "color SNR [dB]"),
    ("bound", "bound [dB]"),
    ("price", "price [dB]"),
    ("lab", "noise in CIELAB"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Words in rows.

    Attributes
    ----------
    head
        One per column.
    rows
        Each as long as the head.
    """

    head: list[str]
    rows: Rows


def decimal(value: float | None, digits: int, none: str = _NONE) -> str:
    """A number with fixed decimals, halves away from 0, and a true minus sign.

    Examples
    --------
    >>> decimal(12.25, 1), decimal(-0.01, 1), decimal(None, 1)
    ('12.3', '0.0', '–')
    """
    if value is None:
        return none
    told = Decimal(value).quantize(Decimal(1).scaleb(-digits), ROUND_HALF_UP)
    return str(abs(told) if told == 0 else told).replace("-", "−")


def brief(value: float | None) -> str:
    """A number as short as it can be with three significant digits.

    Examples
    --------
    >>> brief(0.05), brief(1234.0), brief(2e-4)
    ('0.05', '1230', '2.0e−4')
    """
    if value is None:
        return _NONE
    if value and not 1e-3 <= abs(value) < 1e6:
        told, _, power = f"{value:.1e}".partition("e")
        return f"{told}e{int(power):+d}".replace("-", "−")
    exponent = math.floor(math.log10(abs(value))) if value else 0
    rounded = Decimal(value).quantize(Decimal(1).scaleb(exponent - 2), ROUND_HALF_UP)
    told = f"{rounded:f}"
    return (told.rstrip("0").rstrip(".") if "." in told else told).replace("-", "−")


def table_of(part: str, data: Data) -> Table:
    """The table of one drawing.

    Parameters
    ----------
    part
        Of `chromanoise.charts.PARTS`.
    data
        As `chromanoise.charts.drawing` gives it.
    """
    return _TABLES[part](data)


def _head(data: Data) -> Table:
    channels = list(dict.fromkeys(name for one in data["sensors"] for name in one["channels"]))
    return Table(
        head=[
            *("sensor", "curves", "pixel [µm]", "full well [e⁻]", "read noise [e⁻]", "time [ms]"),
            *("f-number", *(f"{name} [e⁻]" for name in channels), "saturated"),
        ],
        rows=[
            [
                one["name"],
                one["origin"],
                brief(one["pitch_um"]),
                decimal(one["full_well_e"], 0),
                brief(one["read_noise_e"]),
                brief(one["time_ms"]),
                brief(one["f_number"]),
                *(decimal(one["mean_e"].get(name), 0) for name in channels),
                ", ".join(one["saturated"]) or "none",
            ]
            for one in data["sensors"]
        ],
    )


def _sensitivities(data: Data) -> Table:
    curves = [(one["name"], channel) for one in data["sensors"] for channel in one["channels"]]
    return Table(
        head=[
            *("wavelength [nm]", "light, relative"),
            *(f"{sensor} {channel['name']} [e⁻/photon]" for sensor, channel in curves),
        ],
        rows=[
            [
                f"{nm:g}",
                decimal(data["light"][k], 3),
                *(decimal(channel["qe"][k], 4) for _, channel in curves),
            ]
            for k, nm in enumerate(data["wavelength_nm"])
        ],
    )


def _stages(data: Data) -> Table:
    rows = []
    for key, title in _STAGES:
        of = [(_stage(sensor, key), sensor) for sensor in data["sensors"]]
        for name in dict.fromkeys(name for values, _ in of for name in values):
            cells = [_stage_cell(values, name, one) for values, one in of]
            rows.append([title, name, *cells])
    names = [sensor["name"] for sensor in data["sensors"]]
    return Table(head=["kind", "channel or coordinate", *names], rows=rows)


def _stage(sensor: Data, key: str) -> Mapping[str, float | None]:
    if key == "lab":
        return sensor["lab_sd"]
    if key == "spectral":
        return {"spectrum": sensor["spectral_db"]}
    if key in ("bound", "price"):
        return {"Y": sensor[f"{key}_db"]}
    return sensor[key]


def _stage_cell(values: Mapping[str, float | None], name: str, sensor: Data) -> str:
    if name not in values:
        return _NONE
    value = values[name]
    digits = 0 if value is not None and value >= 1000 else 1
    return decimal(value, digits, "saturated" if sensor["why_not"] else "no SNR")


def _budget(data: Data) -> Table:
    rows: Rows = []
    for sensor in data["sensors"]:
        if not sensor["steps"]:
            rows.append([sensor["name"], sensor["why_not"] or "no budget", *[_NONE] * 3])
        for step in sensor["steps"]:
            change = _NONE if step["kind"] in ("start", "end") else _signed(step["change_db"])
            to_db = decimal(step["to_db"], 2)
            rows.append([sensor["name"], step["label"], change, to_db, step["reading"]])
    head = ["sensor", "step", "change [dB]", f"SNR of {data['coordinate']} [dB]", "why"]
    return Table(head=head, rows=rows)


def _signed(value: float) -> str:
    told = decimal(value, 2)
    return f"+{told}" if value > 0 and float(told) != 0 else told


def _vectors(data: Data) -> Table:
    rows = [_vector("color axes", axis["name"], axis) for axis in data["axes"]]
    rows.append(_vector("scene", "true light", data["scene"]))
    for sensor in data["sensors"]:
        name = sensor["name"]
        rows += [_vector(name, channel["name"], channel) for channel in sensor["channels"]]
        if sensor["light"]:
            rows.append(_vector(name, "light", sensor["light"]))
        grown = f"×{brief(sensor['magnification'])}"
        for k, axis in enumerate((sensor["ellipsoid"] or {}).get("half_axes", ()), 1):
            rows.append(_vector(name, f"half axis {k}, {grown}", {"at": axis}))
    head = ["sensor", "vector", "first", "second", "third", "share of squared norm"]
    return Table(head=head, rows=rows)


def _vector(sensor: str, what: str, vector: Data) -> list[str]:
    share = vector.get("norm_share")
    told = _NONE if share is None else f"{decimal(100 * share, 0)} %"
    return [sensor, what, *(decimal(value, 4) for value in vector["at"]), told]


def _ellipses(data: Data) -> Table:
    across, up = data["names"]
    digits = 4 if data["plane"] == "xy" else 1
    head = ["sensor", "patch", f"true {across}", f"true {up}", f"measured {across}"]
    rows: Rows = []
    for sensor in data["sensors"]:
        if not sensor["patches"]:
            rows.append([sensor["name"], sensor["why_not"] or "saturated", *[_NONE] * 5])
        for patch in sensor["patches"]:
            told = (*patch["truth"], *patch["center"], patch["reach"])
            rows.append([sensor["name"], patch["name"], *(decimal(v, digits) for v in told)])
    return Table(head=[*head, f"measured {up}", f"reach of {data['sigmas']:g} sigma"], rows=rows)


def _levels(data: Data) -> Table:
    several = len({curve["matrix"] for curve in data["curves"]}) > 1
    names = [
        f"{curve['sensor']}, {curve['matrix']}" if several else curve["sensor"]
        for curve in data["curves"]
    ]
    return Table(
        head=["illuminance [lx]", *(f"{name} [{data['unit']}]" for name in names)],
        rows=[
            [brief(lux), *(decimal(curve["values"][k], 2, "no SNR") for curve in data["curves"])]
            for k, lux in enumerate(data["lux"])
        ],
    )


def _chart(data: Data) -> Table:
    head = ["patch"]
    for sensor in data["sensors"]:
        head += [f"{sensor['name']} ΔE*ab", f"{sensor['name']} noise ΔE*ab"]
    rows = []
    for k, patch in enumerate(data["patches"]):
        row = [patch["name"]]
        for sensor in data["sensors"]:
            own = sensor["patches"][k] if sensor["patches"] else {}
            row += [decimal(own.get(key), 1, "saturated") for key in ("delta_e", "noise")]
        rows.append(row)
    return Table(head=head, rows=rows)


def _pareto(data: Data) -> Table:
    rows = []
    for sensor in data["sensors"]:
        named = [(brief(point["weight"]), point) for point in sensor["points"]]
        for name, point in (*named, ("now", sensor["now"])):
            error, snr = decimal(point["color_error"], 2), decimal(point["snr_db"], 2)
            rows.append([sensor["name"], name, error, snr])
    head = ["sensor", "weight of the noise", "color error, mean ΔE*ab", "SNR of Y [dB]"]
    return Table(head=head, rows=rows)


_TABLES: Mapping[str, Callable[[Data], Table]] = {
    "head": _head,
    "sensitivities": _sensitivities,
    "stages": _stages,
    "budget": _budget,
    "vectors": _vectors,
    "ellipses": _ellipses,
    "levels": _levels,
    "chart": _chart,
    "pareto": _pareto,
}
