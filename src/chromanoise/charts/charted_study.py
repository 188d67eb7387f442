"""A study with the results that its charts share, computed once."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from chromanoise.base import check, dataclass
from chromanoise.noise import OperatingPoint
from chromanoise.study import (
    NOTHING_GIVEN,
    Analysis,
    Given,
    MatrixMaker,
    Study,
    analysis_of,
    makers_of,
    operating_points_of,
    with_distinct_names,
)

MOST_ON_CARD = 5
"""Sensors on a card, which needs matplotlib: this is asked before it is imported."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Shown:
    """A study with the results that all of its charts share.

    Attributes
    ----------
    operating_points
        Each sensor with its exposure and light.
    makers
        Color matrix methods by name; charts of one matrix use the first.
    analyses
        Analysis of each sensor for a perfect white, with the first matrix: that of a run.
    """

    study: Study
    operating_points: tuple[OperatingPoint, ...]
    makers: Mapping[str, MatrixMaker]
    analyses: tuple[Analysis, ...]

    def __post_init__(self) -> None:
        check.same_length(
            "sensors", operating_points=len(self.operating_points), analyses=len(self.analyses)
        )


@dataclass(frozen=True, kw_only=True)
class Look:
    """Options of the charts of a study.

    Attributes
    ----------
    coordinate
        Coordinate of the budget; X, Y and Z apply also to the curves over the light level.
    plane
        Plane of the ellipses: ``ab`` or ``xy``.
    magnification
        Magnification of the ellipsoids; ``None`` for a round number that makes them visible.
    """

    coordinate: str = "Y"
    plane: str = "ab"
    magnification: float | None = None

    def __post_init__(self) -> None:
        check.one_of("plane of ellipses", self.plane, ("ab", "xy"))
        if self.magnification is not None:
            check.positive("magnification of ellipsoids", "1", self.magnification)


def shown(
    study: Study,
    *,
    operating_points: Sequence[OperatingPoint] | None = None,
    given: Given = NOTHING_GIVEN,
) -> Shown:
    """The study with the analysis of each sensor.

    Parameters
    ----------
    operating_points
        Its operating points, if they are already computed.
    given
        Objects in place of names.

    Raises
    ------
    InputError
        If a name is unknown, a file cannot be read, or a matrix cannot be computed.
    """
    operating_points = (
        operating_points_of(study, given)
        if operating_points is None
        else with_distinct_names(operating_points)
    )
    makers = makers_of(study, given)
    return Shown(
        study=study,
        operating_points=tuple(operating_points),
        makers=makers,
        analyses=_analyses(study, makers, operating_points),
    )


def shown_at(of: Shown, operating_points: Sequence[OperatingPoint]) -> Shown:
    """The same study at other operating points, under one light.

    Raises
    ------
    InputError
        If a matrix cannot be computed.
    """
    level_lux = operating_points[0].level_lux
    light = of.study.light.model_copy(update={"level_lux": level_lux})
    study = of.study.model_copy(update={"light": light})
    return replace(
        of,
        study=study,
        operating_points=tuple(operating_points),
        analyses=_analyses(study, of.makers, operating_points),
    )


def _analyses(
    study: Study, makers: Mapping[str, MatrixMaker], operating_points: Sequence[OperatingPoint]
) -> tuple[Analysis, ...]:
    first = next(iter(makers.values()))
    return tuple(analysis_of(one, first, study.outputs) for one in operating_points)


def unclipped_remark(of: Shown) -> str:
    """The end of the title of a chart that is never clipped: empty unless the study clips."""
    return ", without clipping" if of.study.outputs.clip else ""


def saturation_sentence(analysis: Analysis) -> str | None:
    """Why the SNR of a sensor is undefined; ``None`` where no channel is saturated."""
    hit = saturated_names(analysis)
    if not hit:
        return None
    which = f"channel {hit[0]} is" if len(hit) == 1 else f"channels {', '.join(hit)} are"
    return (
        f"{analysis.sensor.label}: {which} saturated on the white, so its SNR is undefined; "
        "shorten the time, close the aperture or take less light"
    )


def saturated_names(analysis: Analysis) -> list[str]:
    """The channels that a perfect white saturates."""
    full = zip(analysis.sensor.names, analysis.saturated, strict=True)
    return [name for name, hit in full if hit]
