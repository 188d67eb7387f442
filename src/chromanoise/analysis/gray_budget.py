"""Where the noise of L*, a* and b* of a gray comes from."""

from collections.abc import Sequence

from chromanoise.analysis.perceived import GREY
from chromanoise.analysis.stages import Analysis, color_snr_db
from chromanoise.color import LAB
from chromanoise.metrics import Budget, lab_budget
from chromanoise.scene import flat_field


def lab_budgets(analysis: Analysis, *, reflectance: float = GREY) -> tuple[Budget | None, ...]:
    """Where one unit of L*, a* and b* of a gray is lost in noise, from all photons on.

    ``None`` while a channel is saturated on the white, and where a coordinate has no budget.

    Parameters
    ----------
    analysis
        Of a perfect white; the gray stands in its light.
    reflectance
        Of the gray.
    """
    if analysis.saturated.any() or None in color_snr_db(analysis).values():
        return (None,) * len(LAB.coordinates)
    light = analysis.scene
    gray = flat_field(light.illuminant, level_lux=light.level_lux, reflectance=reflectance)
    return tuple(
        lab_budget(gray, analysis.sensor, analysis.exposure, analysis.matrix, coordinate)
        for coordinate in LAB.coordinates
    )


def missing_lab_budgets(analysis: Analysis, budgets: Sequence[Budget | None]) -> str | None:
    """Why a coordinate has none of its `lab_budgets`; ``None`` where none is missing."""
    name = analysis.sensor.name
    if analysis.saturated.any():
        return f"{name}: a channel is saturated on the white, so L*, a* and b* have no budget"
    told = zip(LAB.coordinates, budgets, strict=True)
    missing = [coordinate for coordinate, budget in told if budget is None]
    if not missing:
        return None
    return (
        f"{name}: no budget of {', '.join(missing)}, as the sensor and its matrix do not follow a "
        "change of it; take another matrix, or more channels"
    )
