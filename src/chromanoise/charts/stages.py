"""SNR of raw, contravariant and color coordinates, and noise in CIELAB."""

from typing import Any

from chromanoise.charts.charted_study import Look, Shown, saturation_sentence
from chromanoise.charts.ellipses import quick_cubature
from chromanoise.charts.numbers import NONE, UNDEFINED, brief, decimal, table
from chromanoise.color import LAB, propagate
from chromanoise.noise import conditions
from chromanoise.study import (
    GRAY,
    Analysis,
    color_snr_db,
    contravariant_snr_db,
    metric_of,
    noisy_color_at,
    of_white,
    raw_snr_db,
    stages_at,
)

_KINDS = (  # key, title, unit, what it is of
    ("raw", "raw SNR", "dB", "per channel, as read"),
    ("contravariant", "contravariant SNR", "dB", "per channel, unmixed, {metric}"),
    ("spectral", "spectral SNR", "dB", "of the whole reconstructed spectrum, {metric}"),
    ("color", "color SNR", "dB", "per coordinate"),
    ("bound", "bound", "dB", "SNR of the best linear readout"),
    ("price", "color SNR loss", "dB", "best linear SNR minus SNR of Y"),
    ("lab", "noise in CIELAB", "", f"standard deviation of an {brief(100 * GRAY)} % gray"),
)


def drawn_stages(shown: Shown, look: Look) -> dict[str, Any]:
    """Each kind of SNR of a perfect white, and standard deviations of an 18 % gray's L*, a*, b*."""
    sensors = [
        {
            "name": analysis.sensor.label,
            "raw": raw_snr_db(analysis),
            "contravariant": contravariant_snr_db(analysis),
            "spectral_db": analysis.spectral_snr_db,
            "color": color_snr_db(analysis),
            "lab_sd": _gray_sd(analysis),
            "bound_db": analysis.optimal_linear_snr_db,
            "price_db": analysis.color_snr_loss_db,
            "why_not": saturation_sentence(analysis),
        }
        for analysis in shown.analyses
    ]
    metric = metric_of(shown.analyses)
    kinds = [
        _kind(sensors, key, title, unit, of.format(metric=metric))
        for key, title, unit, of in _KINDS
    ]
    return {
        "title": f"SNR from raw to color at {conditions(shown.operating_points)}",
        "gray": GRAY,
        "sensors": sensors,
        "kinds": kinds,
        "table": _table(sensors, kinds),
    }


def _kind(
    sensors: list[dict[str, Any]], key: str, title: str, unit: str, of: str
) -> dict[str, Any]:
    """One line per channel or coordinate: value and text per sensor, ``None`` where missing."""
    each = [_values(sensor, key) for sensor in sensors]
    lines = []
    for name in dict.fromkeys(name for values in each for name in values):
        text = [
            _text(values[name], sensor) if name in values else None
            for values, sensor in zip(each, sensors, strict=True)
        ]
        lines.append({"name": name, "values": [one.get(name) for one in each], "text": text})
    heading = f"{title} [{unit}]" if unit else title
    kind = {"key": key, "title": title, "heading": heading, "unit": unit, "of": of, "lines": lines}
    return kind | {"description": _description(sensors, lines, unit)}


def _values(sensor: dict[str, Any], key: str) -> dict[str, float | None]:
    if key == "spectral":
        return {"spectrum": sensor["spectral_db"]}
    if key in ("bound", "price"):
        return {"Y": sensor[f"{key}_db"]}
    values: dict[str, float | None] = sensor["lab_sd" if key == "lab" else key]
    return values


def _text(value: float | None, sensor: dict[str, Any]) -> str:
    digits = 0 if value is not None and value >= 1000 else 1
    return decimal(value, digits, "saturated" if sensor["why_not"] else UNDEFINED)


def _description(sensors: list[dict[str, Any]], lines: list[dict[str, Any]], unit: str) -> str:
    parts = []
    for i, sensor in enumerate(sensors):
        own = [
            f"{line['name']} {line['text'][i]} {unit if line['values'][i] is not None else ''}"
            for line in lines
            if line["text"][i] is not None
        ]
        parts.append(f"{sensor['name']}: {', '.join(one.strip() for one in own)}.")
    return " ".join(parts)


def _table(sensors: list[dict[str, Any]], kinds: list[dict[str, Any]]) -> dict[str, Any]:
    rows = [
        [kind["heading"], line["name"], *(text or NONE for text in line["text"])]
        for kind in kinds
        for line in kind["lines"]
    ]
    return table(["kind", "channel or coordinate", *(one["name"] for one in sensors)], rows)


def _gray_sd(analysis: Analysis) -> dict[str, float | None]:
    white_analysis = of_white(analysis)
    if None in color_snr_db(white_analysis).values():
        return dict.fromkeys(LAB.coordinates)
    point, matrix = analysis.point, analysis.matrix
    gray = stages_at(point, matrix, reflectance=GRAY, readout=analysis.readout)
    white = matrix.matrix @ white_analysis.expected_e
    lab = propagate(noisy_color_at(gray, white), LAB, quick_cubature)
    return dict(zip(lab.measurement.names, lab.sd.tolist(), strict=True))
