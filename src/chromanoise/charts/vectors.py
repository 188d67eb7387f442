"""Channels, light and its uncertainty as vectors in the three dimensions of color.

One orthonormal frame spans the color axes x, y, z. The component of a vector outside this space
does not affect any color coordinate, so the chart gives the share of the norm inside it. Channels
and light have different units: each kind is drawn relative to its longest vector.
"""

import math
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, eigh, qr
from chromanoise.charts.charted_study import Look, Shown, saturation_sentence
from chromanoise.charts.description import numbers_of
from chromanoise.charts.numbers import NONE, brief, decimal, listed, percent, table
from chromanoise.geometry import reconstructed_light
from chromanoise.noise import conditions
from chromanoise.spectra import color_axes, light
from chromanoise.study import Analysis, metric_of

_AXES = ("x", "y", "z")
_SIGMAS = 2.0
_VISIBLE = 0.3  # largest length of a drawn half axis, relative to the longest light
_ROUND = (1.0, 2.0, 5.0)


def color_frame(axes: Float[Array, "n 3"]) -> Float[Array, "n 3"]:
    """An orthonormal frame of the span of three color axes.

    The first column lies along the first axis, and each axis has a positive coordinate in the
    column of its own.

    Examples
    --------
    >>> color_frame(np.array([[2.0, 1.0, 0.0], [0.0, -3.0, 0.0], [0.0, 0.0, 5.0]])) + 0.0
    array([[ 1.,  0.,  0.],
           [ 0., -1.,  0.],
           [ 0.,  0.,  1.]])
    """
    frame, corner = qr("axes of color in light", axes)
    return frame * np.where(np.diag(corner) < 0, -1.0, 1.0)


def light_covariance(analysis: Analysis, frame: Float[Array, "n 3"]) -> Float[Array, "3 3"]:
    """Covariance of the reconstructed spectrum (eq. 4) in a frame. [(unit of light)^2]"""
    to_frame = frame.T @ analysis.matrix.frame.dual
    return np.asarray(to_frame @ analysis.raw.covariance @ to_frame.T)


def half_axes(covariance: Float[Array, "3 3"]) -> Float[Array, "3 3"]:
    """The half axes of the ellipsoid at one standard deviation, one per row, longest first.

    Parameters
    ----------
    covariance
        Symmetric matrix; the half axes have the square root of its unit.
    """
    variance, directions = eigh("covariance of the reconstructed light", covariance)
    return (directions * np.sqrt(np.maximum(variance, 0.0))).T[::-1]


def round_magnification(largest: float, wanted: float) -> float:
    """The largest of 1, 2, 5, 10, 20 ... that brings ``largest`` to ``wanted`` at most.

    Examples
    --------
    >>> round_magnification(0.01, 0.3), round_magnification(2.0, 0.3)
    (20.0, 0.1)
    """
    if not largest > 0:
        return 1.0
    power = math.floor(math.log10(wanted / largest))
    tens = 10.0**power
    return max(tens * digit for digit in _ROUND if tens * digit * largest <= wanted * (1 + 1e-12))


def drawn_vectors(shown: Shown, look: Look) -> dict[str, Any]:
    """Color axes, channels, reconstructed light and its ellipsoid in one frame."""
    first = shown.analyses[0]
    axes = color_axes(first.sensor.grid, first.matrix.metric, first.matrix.observer)
    frame = color_frame(axes)
    scene = light(first.scene, first.matrix.metric)
    rebuilt = [
        None if a.saturated.any() else reconstructed_light(a.matrix.frame, a.raw.mean)
        for a in shown.analyses
    ]
    known = [np.linalg.norm(one) for one in (scene, *rebuilt) if one is not None]
    unit_of_light = float(max(known))
    unit_of_channels = max(
        float(np.linalg.norm(a.matrix.frame.basis, axis=0).max()) for a in shown.analyses
    )
    spreads = [
        None if one is None else _SIGMAS * half_axes(light_covariance(a, frame)) / unit_of_light
        for a, one in zip(shown.analyses, rebuilt, strict=True)
    ]
    magnification = look.magnification or _magnification(spreads)
    unit_axes = axes / np.linalg.norm(axes, axis=0)
    sensors: list[dict[str, Any]] = [
        {
            "name": a.sensor.label,
            "channels": [
                {"name": name, **_vector(frame, a.matrix.frame.basis[:, i], unit_of_channels)}
                for i, name in enumerate(a.sensor.names)
            ],
            "light": None if seen is None else _vector(frame, seen, unit_of_light),
            "ellipsoid": None
            if seen is None or spread is None
            else {
                "center": (frame.T @ seen / unit_of_light).tolist(),
                "half_axes": (magnification * spread).tolist(),
                "norm_share": _noise_share(a, frame),
            },
            "magnification": magnification,
            "why_not": saturation_sentence(a),
        }
        for a, seen, spread in zip(shown.analyses, rebuilt, spreads, strict=True)
    ]
    record: dict[str, Any] = {
        "title": f"Channels and light as vectors at {conditions(shown.operating_points)}, "
        f"{metric_of(shown.analyses)}",
        "axes": [
            {"name": name, "at": (frame.T @ unit_axes[:, i]).tolist()}
            for i, name in enumerate(_AXES)
        ],
        "scene": _vector(frame, scene, unit_of_light),
        "sigmas": _SIGMAS,
        "magnification": magnification,
        "sensors": [one | _sentences(one) for one in sensors],
    }
    return record | numbers_of(_rows(record)) | {"table": _table(record)}


def _sentences(sensor: dict[str, Any]) -> dict[str, str]:
    """``note``: shares and magnification; ``description``: list of the arrows."""
    each = [f"{one['name']} {percent(one['norm_share'])}" for one in sensor["channels"]]
    arrows = [one["name"] for one in sensor["channels"]]
    if sensor["light"]:
        each.append(f"light {percent(sensor['light']['norm_share'])}")
        arrows.append("light")
    shares = f"Share of the squared norm that lies in this space: {', '.join(each)}."
    note = f"{shares} {sensor['why_not']}."
    if sensor["ellipsoid"]:
        note = (
            f"{shares} Ellipsoid: {_SIGMAS:g} σ, magnified ×{brief(sensor['magnification'])}, "
            f"holding {percent(sensor['ellipsoid']['norm_share'])} of the variance."
        )
    what = f"Arrows {listed(arrows)} from the origin beside the color axes {listed(_AXES)}."
    return {"note": note, "description": f"{what} {note}"}


def _rows(record: dict[str, Any], *, drawn: bool = False) -> list[list[Any]]:
    """A row per vector under a row of headings: half axes as long as they are, or magnified."""
    rows: list[list[Any]] = [
        ["sensor", "vector", "first", "second", "third", "share of squared norm"],
        *(["color axes", axis["name"], *axis["at"], None] for axis in record["axes"]),
        ["scene", "true light", *record["scene"]["at"], record["scene"]["norm_share"]],
    ]
    times = record["magnification"]
    for one in record["sensors"]:
        light = [{"name": "light", **one["light"]}] if one["light"] else []
        rows += [
            [one["name"], arrow["name"], *arrow["at"], arrow["norm_share"]]
            for arrow in (*one["channels"], *light)
        ]
        for k, axis in enumerate((one["ellipsoid"] or {}).get("half_axes", ()), 1):
            how = f", ×{brief(times)}" if drawn else f" of {_SIGMAS:g} sigma"
            lengths = axis if drawn else [value / times for value in axis]
            rows.append([one["name"], f"half axis {k}{how}", *lengths, None])
    return rows


def _table(record: dict[str, Any]) -> dict[str, Any]:
    head, *rows = _rows(record, drawn=True)
    shares = [NONE if row[-1] is None else percent(row[-1]) for row in rows]
    texts = [
        [sensor, vector, *(decimal(value, 4) for value in at), share]
        for (sensor, vector, *at, _), share in zip(rows, shares, strict=True)
    ]
    return table(head, texts)


def norm_share(frame: Float[Array, "n 3"], vector: Float[Array, " n"]) -> float:
    """Share of the squared length of a vector that lies in the frame. [1]"""
    whole = float(vector @ vector)
    return float(((vector @ frame) ** 2).sum()) / whole if whole > 0 else 0.0


def _vector(frame: Array, vector: Array, unit: float) -> dict[str, Any]:
    return {"at": (vector @ frame / unit).tolist(), "norm_share": norm_share(frame, vector)}


def _noise_share(analysis: Analysis, frame: Array) -> float:
    """Share of the variance of the reconstructed spectrum that lies in the frame."""
    g = analysis.matrix.frame.inverse_gram
    whole = float(np.einsum("ij,ji->", g, analysis.raw.covariance))
    inside = float(np.trace(light_covariance(analysis, frame)))
    return inside / whole if whole > 0 else 0.0


def _magnification(spreads: list[Any]) -> float:
    longest = [float(np.linalg.norm(one[0])) for one in spreads if one is not None]
    return round_magnification(max(longest, default=0.0), _VISIBLE)
