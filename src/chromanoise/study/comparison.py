"""Sensors against each other over the light level: curves, crossovers and the verdict."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from jaxtyping import Float

from chromanoise import __version__, _check
from chromanoise._check import Array
from chromanoise.color import ColorMatrix, colored
from chromanoise.exposure import Exposure, expected_electrons
from chromanoise.merit import chart_color_error, snr_db
from chromanoise.noise import saturated, with_noise
from chromanoise.scene import flat_field
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant

MatrixMaker = Callable[[Sensor, Exposure, float], ColorMatrix]
"""A color matrix for a sensor, an exposure and a light level [lx]."""

_CROSSING_TOLERANCE = 1e-9  # of the logarithm of the level


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """One sensor with one matrix over the light level.

    Attributes
    ----------
    sensor, matrix
        Names.
    time_s
        Integration time. [s]
    level_lux
        Where it was computed. [lx]
    snr_y_db
        SNR of luminance of a perfect white; NaN where a channel is saturated or Y is no signal.
        [dB]
    color_error
        Mean over the ColorChecker, without noise; NaN where it is not defined. [Delta E*ab]
    """

    sensor: str
    matrix: str
    time_s: float
    level_lux: Float[Array, " k"]
    snr_y_db: Float[Array, " k"]
    color_error: Float[Array, " k"]

    def __post_init__(self) -> None:
        _check.freeze(self, "level_lux", "snr_y_db", "color_error")


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossover:
    """Where two sensors with the same matrix have the same SNR of luminance.

    Attributes
    ----------
    first, second, matrix
        Names.
    level_lux
        The levels at which the sign of their difference changes; empty if it never does. [lx]
    color_error
        Of first and second at each of these levels: SNR is never told alone; NaN where it is not
        defined. [Delta E*ab]
    better_in_the_dark
        Who leads at the lowest common level.
    from_lux, to_lux
        The range in which both have an SNR. [lx]
    """

    first: str
    second: str
    matrix: str
    level_lux: tuple[float, ...]
    color_error: tuple[tuple[float, float], ...]
    better_in_the_dark: str
    from_lux: float
    to_lux: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contestant:
    """A sensor as it is used: with its exposure."""

    sensor: Sensor
    exposure: Exposure


def compared(
    contestants: Sequence[Contestant],
    makers: Mapping[str, MatrixMaker],
    illuminant: Illuminant,
    level_lux: Float[Array, " k"],
) -> tuple[Curve, ...]:
    """Every sensor with every matrix over the light levels.

    Parameters
    ----------
    contestants
        Sensors with their exposures.
    makers
        Matrix methods by name; each may depend on the level.
    illuminant
        The light.
    level_lux
        Increasing. [lx]

    Raises
    ------
    InputError
        If the levels do not increase or are not positive.
    """
    levels = _check.increasing("level_lux", "lx", level_lux)
    _check.positive("lowest level_lux", "lx", float(levels[0]))
    return tuple(
        _curve(contestant, name, maker, illuminant, levels)
        for contestant in contestants
        for name, maker in makers.items()
    )


def crossovers(
    contestants: Sequence[Contestant],
    makers: Mapping[str, MatrixMaker],
    illuminant: Illuminant,
    curves: Sequence[Curve],
) -> tuple[Crossover, ...]:
    """For each pair of sensors and each matrix, the levels at which their order changes.

    Signs are read off the curves; each change is then refined by bisection on the closed form.
    """
    found = []
    for name, maker in makers.items():
        mine = [curve for curve in curves if curve.matrix == name]
        for i, first in enumerate(contestants):
            for k in range(i + 1, len(contestants)):
                second = contestants[k]
                lead = _lead(first, second, maker, illuminant)
                errors = _errors(first, second, maker, illuminant)
                found.append(_crossover(mine[i], mine[k], lead, errors))
    return tuple(found)


def luminance_snr_db(
    contestant: Contestant, maker: MatrixMaker, illuminant: Illuminant, level_lux: float
) -> float:
    """SNR of Y of a perfect white; NaN where a channel is saturated or Y is no signal. [dB]"""
    sensor, exposure = contestant.sensor, contestant.exposure
    scene = flat_field(illuminant, level_lux=level_lux)
    electrons = expected_electrons(scene, sensor, exposure)
    if saturated(electrons, sensor.pixel).any():
        return float("nan")
    matrix = maker(sensor, exposure, level_lux)
    color = colored(with_noise(electrons, sensor), matrix)
    return float(snr_db(color)["Y"]) if color.mean[1] > 0 else float("nan")


def color_error(
    contestant: Contestant, maker: MatrixMaker, illuminant: Illuminant, level_lux: float
) -> float:
    """Mean over the ColorChecker, without noise; NaN where the white is no color. [Delta E*ab]"""
    sensor, exposure = contestant.sensor, contestant.exposure
    error = chart_color_error(sensor, maker(sensor, exposure, level_lux), exposure, illuminant)
    return float("nan") if error is None else float(error.mean())


def _curve(
    contestant: Contestant,
    name: str,
    maker: MatrixMaker,
    illuminant: Illuminant,
    levels: Float[Array, " k"],
) -> Curve:
    snr, errors = [], []
    for level in levels.tolist():
        snr.append(luminance_snr_db(contestant, maker, illuminant, level))
        errors.append(color_error(contestant, maker, illuminant, level))
    return Curve(
        sensor=contestant.sensor.name,
        matrix=name,
        time_s=contestant.exposure.time_s,
        level_lux=levels,
        snr_y_db=np.array(snr),
        color_error=np.array(errors),
    )


def _lead(
    first: Contestant, second: Contestant, maker: MatrixMaker, illuminant: Illuminant
) -> Callable[[float], float]:
    """How far the first leads the second at a level whose logarithm is given. [dB]"""

    def lead(log_level: float) -> float:
        level = float(np.exp(log_level))
        ours, theirs = (luminance_snr_db(c, maker, illuminant, level) for c in (first, second))
        return ours - theirs

    return lead


def _errors(
    first: Contestant, second: Contestant, maker: MatrixMaker, illuminant: Illuminant
) -> Callable[[float], tuple[float, float]]:
    """The color errors of both at a level. [Delta E*ab]"""

    def errors(level: float) -> tuple[float, float]:
        return (
            color_error(first, maker, illuminant, level),
            color_error(second, maker, illuminant, level),
        )

    return errors


def _crossover(
    first: Curve,
    second: Curve,
    lead: Callable[[float], float],
    errors: Callable[[float], tuple[float, float]],
) -> Crossover:
    difference = first.snr_y_db - second.snr_y_db
    known = np.flatnonzero(np.isfinite(difference))
    if not known.size:
        raise _check.InputError(
            f"{first.sensor} and {second.sensor} have no light level of the sweep at which both "
            f"have an SNR of luminance with the {first.matrix} matrix: they are saturated (shorten "
            "the time, sweep darker levels) or the matrix cannot make Y of this light"
        )
    logs = np.log(first.level_lux)
    changes = [
        (logs[a], logs[b])
        for a, b in pairwise(known)
        if np.sign(difference[a]) * np.sign(difference[b]) < 0
    ]
    leader = first if difference[known[0]] > 0 else second
    levels = tuple(float(np.exp(_root(lead, low, high))) for low, high in changes)
    return Crossover(
        first=first.sensor,
        second=second.sensor,
        matrix=first.matrix,
        level_lux=levels,
        color_error=tuple(errors(level) for level in levels),
        better_in_the_dark=leader.sensor,
        from_lux=float(first.level_lux[known[0]]),
        to_lux=float(first.level_lux[known[-1]]),
    )


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Bisection: the sign differs at ``low`` and ``high``."""
    at_low = function(low)
    while high - low > _CROSSING_TOLERANCE:
        middle = 0.5 * (low + high)
        if np.sign(function(middle)) == np.sign(at_low):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def comparison_as_json(curves: Sequence[Curve], crossed: Sequence[Crossover]) -> dict[str, Any]:
    """Curves and crossovers as plain data; what is not defined is ``None``."""
    return {
        "version": __version__,
        "level_lux": curves[0].level_lux.tolist(),
        "curves": [
            {
                "sensor": curve.sensor,
                "matrix": curve.matrix,
                "time_ms": 1e3 * curve.time_s,
                "snr_y_db": _defined(curve.snr_y_db),
                "color_error": _defined(curve.color_error),
            }
            for curve in curves
        ],
        "crossovers": [_crossover_as_json(c) for c in crossed],
    }


def _crossover_as_json(crossover: Crossover) -> dict[str, Any]:
    errors = [_defined(np.array(pair)) for pair in crossover.color_error]
    return asdict(crossover) | {"color_error": errors, "sentence": crossover_sentence(crossover)}


def _defined(values: Float[Array, " k"]) -> list[float | None]:
    return [value if np.isfinite(value) else None for value in values.tolist()]


def crossover_sentence(crossover: Crossover) -> str:
    """Who wins where, in words."""
    first, second = crossover.first, crossover.second
    range_told = f"{crossover.from_lux:.3g} to {crossover.to_lux:.3g} lx"
    other = second if crossover.better_in_the_dark == first else first
    if not crossover.level_lux:
        return (
            f"With the {crossover.matrix} matrix {crossover.better_in_the_dark} has the better "
            f"luminance SNR than {other} at every level from {range_told}."
        )
    levels = " and ".join(f"{level:.3g}" for level in crossover.level_lux)
    colors = "; ".join(f"{a:.1f} and {b:.1f}" for a, b in crossover.color_error)
    changes = "and back" if len(crossover.level_lux) % 2 == 0 else f"{other} above"
    return (
        f"With the {crossover.matrix} matrix {crossover.better_in_the_dark} has the better "
        f"luminance SNR below {levels} lx, {changes} (within {range_told}), where the mean color "
        f"errors of {first} and {second} are {colors} Delta E*ab."
    )
