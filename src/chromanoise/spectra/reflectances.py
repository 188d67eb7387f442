"""Reflectances that are measured into the near infrared."""

from chromanoise.spectra.curves import Spectra, on_grid
from chromanoise.spectra.grid import Grid
from chromanoise.spectra.tables import packaged_table


def colorchecker(grid: Grid) -> Spectra:
    """The 24 patches of a ColorChecker, measured from 400 to 1050 nm, in reading order.

    Dark skin first, black last; ``SOURCES.toml`` tells who measured them.

    Examples
    --------
    >>> chart = colorchecker(Grid.uniform(400, 1050, 5))
    >>> chart.names[0], chart.names[18], chart.values.shape
    ('dark skin', 'white', (131, 24))
    """
    return on_grid(packaged_table("colorchecker"), grid)
