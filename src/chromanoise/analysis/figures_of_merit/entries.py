"""A figure of merit: a number with its source, or the reason why it is not defined."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.operating_point import electrons_at, stages_at
from chromanoise.errors import InputError
from chromanoise.metrics.snr import LEAST_COLOR
from chromanoise.noise import saturated


@dataclass(frozen=True, slots=True, kw_only=True)
class Viewing:
    """Display and distance from which a picture is viewed, one picture pixel per display pixel.

    Attributes
    ----------
    pixel_pitch_mm
        Of the display or print. [mm]
    distance_mm
        Of the eye. [mm]
    """

    pixel_pitch_mm: float = 0.25
    distance_mm: float = 600.0

    def __post_init__(self) -> None:
        _check.positive("pixel_pitch_mm", "mm", self.pixel_pitch_mm)
        _check.positive("distance_mm", "mm", self.distance_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Merit:
    """One figure of merit.

    Attributes
    ----------
    name
        In JSON.
    what
        In words, unit not included.
    unit
        Of the value.
    value
        ``None`` where it is not defined.
    source
        Standard with its edition, or paper.
    missing
        Reason why there is no value; empty where there is one.

    Raises
    ------
    InputError
        If the value is not finite, or a missing value has no reason.
    """

    name: str
    what: str
    unit: str
    value: float | None
    source: str
    missing: str = ""

    def __post_init__(self) -> None:
        if self.value is not None:
            _check.finite(self.name, self.unit, self.value)
        if (self.value is None) != bool(self.missing):
            raise InputError(
                f"merit {self.name}",
                "must have either a value or the reason why it has none",
                value=(self.value, self.missing),
                found=f"has {self.value} and {self.missing!r}",
            )


def merit_or_reason(
    name: str,
    what: str,
    unit: str,
    source: str,
    *,
    of: Callable[[], float | None],
    never: str = "not defined here",
) -> Merit:
    """A figure of merit; the text of an `InputError` is the reason why it has no value.

    Parameters
    ----------
    name, what, unit, source
        As `Merit`.
    of
        Returns the number; ``None`` or infinite where it is not defined.
    never
        The reason in that case.
    """
    try:
        value = of()
    except InputError as refusal:
        return Merit(
            name=name, what=what, unit=unit, value=None, source=source, missing=str(refusal)
        )
    if value is None or not math.isfinite(value):
        return Merit(name=name, what=what, unit=unit, value=None, source=source, missing=never)
    return Merit(name=name, what=what, unit=unit, value=float(value), source=source)


def white_electrons(analysis: Analysis) -> Float[Array, " p"]:
    """Expected electrons of a perfect white in the light of the analysis, unclipped. [e-]"""
    return electrons_at(analysis.point)


def white_color(analysis: Analysis) -> Float[Array, " 3"]:
    """X, Y and Z that the matrix makes of a perfect white's electrons (eq. 6). [lx]

    Raises
    ------
    InputError
        If X, Y or Z is no signal: negative, or below `LEAST_COLOR` times the true color.
    """
    at = stages_at(analysis.point, analysis.matrix)
    white = analysis.matrix.matrix @ at.expected_e
    for name, seen, wanted in zip(analysis.matrix.coordinates, white, at.truth_xyz, strict=True):
        if not seen > LEAST_COLOR * wanted:
            raise InputError(
                f"{name} of a perfect white",
                f"must be a signal, as colors are relative to it; the eye sees {wanted:.3g} lx",
                value=float(seen),
                found=f"is {seen:.3g} lx",
                remedy="take another lamp or matrix",
            )
    return np.asarray(white)


def refuse_full(analysis: Analysis) -> None:
    """Refuse an exposure at which a perfect white saturates a channel: eq. 7 does not hold there.

    Raises
    ------
    InputError
        If it does, with the names of the channels.
    """
    full = saturated(white_electrons(analysis), analysis.sensor, analysis.exposure)
    held = [name for name, is_full in zip(analysis.sensor.names, full, strict=True) if is_full]
    if held:
        raise InputError(
            f"sensor {analysis.sensor.name}",
            "must not be saturated by a perfect white",
            value=tuple(held),
            found=f"is in {', '.join(held)}",
            remedy="shorten the time or close the aperture",
        )
