"""The SNR budgets of all coordinates of an analysis."""

from collections.abc import Sequence
from functools import lru_cache

from chromanoise.analysis.analysis import Analysis, color_snr_db, of_white
from chromanoise.analysis.color_space_noise import GRAY
from chromanoise.color import LAB
from chromanoise.metrics import Budget, color_budget, contravariant_budget, lab_budget
from chromanoise.scene import flat_field

_CONTRAVARIANT = "M^"


@lru_cache(maxsize=64)  # verdict and waterfall chart use the same budget
def coordinate_budget(
    analysis: Analysis, coordinate: str, *, reflectance: float = GRAY
) -> Budget | None:
    """The budget of X, Y, Z, of a contravariant coordinate as M^R, or of L*, a*, b* of a gray.

    ``None`` where a channel is saturated, or the coordinate has no SNR or no budget, and for a
    clipped analysis, as a budget follows eq. 7.

    Parameters
    ----------
    analysis
        The analysis of a perfect white.
    coordinate
        Its name; ``None`` is returned for a coordinate that the sensor does not have.
    reflectance
        Of the gray, for L*, a* and b*. [1]
    """
    if analysis.without_snr.any() or analysis.readout is not None:
        return None
    light, sensor, exposure = analysis.scene, analysis.sensor, analysis.exposure
    snr = color_snr_db(analysis)
    if coordinate in snr:
        if snr[coordinate] is None:
            return None
        return color_budget(light, sensor, exposure, analysis.matrix, coordinate)
    if coordinate in LAB.coordinates:
        if None in color_snr_db(of_white(analysis)).values():
            return None
        gray = flat_field(light.illuminant, level_lux=light.level_lux, reflectance=reflectance)
        return lab_budget(gray, sensor, exposure, analysis.matrix, coordinate)
    channel = coordinate.removeprefix(_CONTRAVARIANT)
    if channel not in sensor.names:
        return None
    return contravariant_budget(light, sensor, exposure, analysis.matrix.frame, channel)


def color_budgets(analysis: Analysis) -> tuple[Budget | None, ...]:
    """SNR budgets of X, Y and Z; ``None`` where a channel is saturated or there is no SNR.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return tuple(coordinate_budget(analysis, name) for name in analysis.color.names)


def contravariant_budgets(analysis: Analysis) -> tuple[Budget | None, ...]:
    """SNR budget of each contravariant coordinate; ``None`` where it has no SNR.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    names = analysis.sensor.names
    return tuple(coordinate_budget(analysis, f"{_CONTRAVARIANT}{name}") for name in names)


def lab_budgets(analysis: Analysis, *, reflectance: float = GRAY) -> tuple[Budget | None, ...]:
    """SNR budgets of one unit of L*, a* and b* of a gray, starting from all photons.

    ``None`` where a channel is saturated on the white, or a coordinate has no budget.

    Parameters
    ----------
    analysis
        The analysis of a perfect white; the gray is under the same light.
    reflectance
        Of the gray. [1]
    """
    return tuple(
        coordinate_budget(analysis, name, reflectance=reflectance) for name in LAB.coordinates
    )


def missing_lab_budgets(analysis: Analysis, budgets: Sequence[Budget | None]) -> str | None:
    """The reason why `lab_budgets` lacks a coordinate; ``None`` where none is missing.

    Parameters
    ----------
    analysis
        Results of one sensor.
    budgets
        Budgets of L*, a* and b*; ``None`` where a budget is undefined.
    """
    name = analysis.sensor.label
    if analysis.saturated.any():
        return f"{name}: a channel is saturated on the white, so L*, a* and b* have no budget"
    if analysis.one_code.any():
        return f"{name}: a channel gives one code on the white, so L*, a* and b* have no budget"
    found = zip(LAB.coordinates, budgets, strict=True)
    missing = [coordinate for coordinate, budget in found if budget is None]
    if not missing:
        return None
    return (
        f"{name}: no budget of {', '.join(missing)}, because sensor and matrix do not respond to a "
        "change of it; use another matrix, or more channels"
    )
