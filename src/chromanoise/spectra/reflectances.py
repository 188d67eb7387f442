"""Measured reflectances that include the near infrared, gray cards, and pairs of patches."""

import re
from functools import cache, lru_cache
from itertools import combinations
from pathlib import Path

import numpy as np

from chromanoise.base import Array, InputError, Int, check, dataclass
from chromanoise.spectra.curves import Beyond, Grid, Spectra, on_grid
from chromanoise.spectra.tables import catalog_curves, catalog_tables, packaged_table


@cache
def colorchecker(grid: Grid) -> Spectra:
    """The 24 patches of a ColorChecker, measured from 400 to 1050 nm, in reading order.

    Dark skin is first, black last; ``SOURCES.toml`` names the source of the measurement.

    Parameters
    ----------
    grid
        Wavelengths of the result.

    Examples
    --------
    >>> chart = colorchecker(Grid.uniform(400, 1050, 5))
    >>> chart.names[0], chart.names[18], chart.values.shape
    ('dark skin', 'white', (131, 24))
    """
    return on_grid(packaged_table("colorchecker"), grid)


def chart_on(grid: Grid, chart: Spectra | None = None) -> Spectra:
    """The reflectances of a chart; the ColorChecker if ``None``.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    chart
        Reflectances of the patches; those of the ColorChecker if ``None``.
    """
    return colorchecker(grid) if chart is None else chart


def chart_title(chart: Spectra | None) -> str:
    """The name of a chart: ``the ColorChecker``, or that of its file.

    Parameters
    ----------
    chart
        Reflectances of the patches; those of the ColorChecker if ``None``.
    """
    return "the ColorChecker" if chart is None else Path(chart.source).name


def reflectance_named(name: str, grid: Grid, *, beyond: Beyond = "refuse") -> Spectra:
    """The reflectances of the catalog entry ``name``.

    Parameters
    ----------
    name
        ``colorchecker``, ``lawn``, ``skin`` ..., or ``gray-<percent>``, which is constant over
        wavelength.
    beyond
        How to extrapolate a table that does not cover the grid; that of skin ends at 950 nm.

    Raises
    ------
    InputError
        If the name is unknown, or the table does not cover the grid and ``beyond`` is ``refuse``.

    Examples
    --------
    >>> lawn = reflectance_named("lawn", Grid.uniform(400, 1050, 50))
    >>> lawn.values[[3, 8], 0].round(2)         # at 550 and 800 nm
    array([0.07, 0.47])
    """
    if match := re.fullmatch(r"gray-([\d.]+)", name):
        return _gray(name, match[1], grid)
    measured = catalog_tables("reflectance")
    name = check.one_of("reflectance", name, (*measured, "gray-18"))
    return on_grid(catalog_curves(measured[name]), grid, beyond=beyond)


def _gray(name: str, percent: str, grid: Grid) -> Spectra:
    need, found = "must have a number of percent", f"{percent!r} is not a number"
    share = check.number(percent, f"reflectance {name!r}", need, found=found) / 100
    check.within(f"percent of {name}", "%", 100 * share, 0.0, 100.0)
    return Spectra(
        wavelength_nm=grid.wavelength_nm,
        values=np.full((grid.n, 1), share),
        names=(name,),
        quantity="reflectance",
        unit="1",
        source=name,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class PatchPairs:
    """Reflectances, and which two of them form each pair.

    Attributes
    ----------
    patches
        The reflectances, one column per patch. [1]
    indices
        Columns of the two patches of each pair.

    Raises
    ------
    InputError
        If there is no pair, or an index is not that of a patch.
    """

    patches: Spectra
    indices: Int[Array, "m 2"]

    def __post_init__(self) -> None:
        count = len(self.patches.names)
        indices = np.asarray(self.indices, dtype=np.int64)
        if indices.ndim != 2 or indices.shape[1] != 2 or len(indices) == 0:
            raise InputError(
                "pairs",
                "must hold at least one pair of patches",
                value=indices.shape,
                found=f"{self.patches.source} has {count} patch{'' if count == 1 else 'es'}",
            )
        outside = (indices < 0) | (indices >= count)
        if outside.any():
            raise InputError(
                "pairs", f"must be indices from 0 to {count - 1}", value=int(indices[outside][0])
            )
        check.keep(self, indices=indices)

    @property
    def names(self) -> tuple[tuple[str, str], ...]:
        """Names of the two patches of each pair."""
        patches = self.patches.names
        return tuple((patches[i], patches[j]) for i, j in self.indices)


@lru_cache(maxsize=16)  # all sensors of a study share them; the result holds its key
def all_pairs(patches: Spectra) -> PatchPairs:
    """Each patch with each other one: 276 pairs for the 24 patches of a ColorChecker.

    Parameters
    ----------
    patches
        At least two reflectances.

    Raises
    ------
    InputError
        If there are fewer than two.
    """
    pairs = list(combinations(range(len(patches.names)), 2))
    return PatchPairs(patches=patches, indices=np.array(pairs, dtype=np.int64).reshape(-1, 2))
