"""The heat maps of a study: its sweeps of two parameters."""

from chromanoise.charts.charted_study import Shown
from chromanoise.study.results import ComparisonMap
from chromanoise.study.running import sweep_map


def sweep_maps(of: Shown) -> tuple[ComparisonMap, ...]:
    """Each sweep of two parameters of a study, as a run computes it.

    Parameters
    ----------
    of
        The study.

    Raises
    ------
    InputError
        If a value of a sweep cannot be used.
    """
    return tuple(
        sweep_map(of.study, of.operating_points, of.makers, i)
        for i, part in enumerate(of.study.sweeps)
        if part.second is not None
    )
