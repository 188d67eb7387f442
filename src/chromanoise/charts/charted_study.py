"""What is drawn of a study: its operating points, their matrices and every stage, computed once."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from chromanoise import _check
from chromanoise.analysis.analysis import Analysis, analyzed
from chromanoise.analysis.color_matrices import MatrixMaker, matrix_makers
from chromanoise.exposure import OperatingPoint, white_scene
from chromanoise.study.assembly import operating_points_of, with_distinct_names
from chromanoise.study.document import Study


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shown:
    """A study with what all of its drawings share.

    Attributes
    ----------
    study
        What was asked.
    operating_points
        Each sensor with its exposure, in its light.
    makers
        Color matrices by name; drawings of one matrix take the first.
    analyses
        Every stage of each sensor on a perfect white, with the first matrix.
    """

    study: Study
    operating_points: tuple[OperatingPoint, ...]
    makers: Mapping[str, MatrixMaker]
    analyses: tuple[Analysis, ...]

    def __post_init__(self) -> None:
        _check.same_length(
            "sensors", operating_points=len(self.operating_points), analyses=len(self.analyses)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """How a study is looked at.

    Attributes
    ----------
    coordinate
        Of the budget; X, Y and Z also of the curves over the light level.
    plane
        Of the ellipses: ``ab`` or ``xy``.
    magnification
        Of the ellipsoids; ``None`` for a round number that makes them visible.
    """

    coordinate: str = "Y"
    plane: str = "ab"
    magnification: float | None = None

    def __post_init__(self) -> None:
        _check.one_of("plane of ellipses", self.plane, ("ab", "xy"))
        if self.magnification is not None:
            _check.positive("magnification of ellipsoids", "1", self.magnification)


def shown(study: Study, *, operating_points: Sequence[OperatingPoint] | None = None) -> Shown:
    """The study with every stage of each sensor.

    Parameters
    ----------
    study
        To be drawn.
    operating_points
        Its sensors in use, where they are known already.

    Raises
    ------
    InputError
        If a name names nothing, a file cannot be read, or a matrix cannot be made.
    """
    operating_points = (
        operating_points_of(study)
        if operating_points is None
        else with_distinct_names(operating_points)
    )
    makers = matrix_makers(study.matrices, study.metric, prior=study.prior)  # type: ignore[arg-type]
    first = next(iter(makers.values()))
    analyses = [
        analyzed(white_scene(one), one.sensor, one.exposure, matrix=first(one))
        for one in operating_points
    ]
    return Shown(
        study=study,
        operating_points=tuple(operating_points),
        makers=makers,
        analyses=tuple(analyses),
    )


def saturation_sentence(analysis: Analysis) -> str | None:
    """Why the SNR of a sensor is undefined; ``None`` where no channel is saturated."""
    hit = saturated_names(analysis)
    if not hit:
        return None
    which = f"channel {hit[0]} is" if len(hit) == 1 else f"channels {', '.join(hit)} are"
    return (
        f"{analysis.sensor.name}: {which} saturated on the white, so its SNR is undefined; "
        "shorten the time, close the aperture or take less light"
    )


def saturated_names(analysis: Analysis) -> list[str]:
    """The channels that a perfect white fills beyond full well."""
    full = zip(analysis.sensor.names, analysis.saturated, strict=True)
    return [name for name, hit in full if hit]
