"""Search over filters, IR-cut, pixel shares, exposure and matrix of a sensor.

``reading`` reads a design, ``space`` makes its candidates, ``evaluation`` computes their
objectives, and ``search`` finds the front. ``optimizing`` connects them, ``result`` and ``outputs``
give the front as data and files.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.design.document import DesignDocument, with_effort
    from chromanoise.design.objectives import OBJECTIVES
    from chromanoise.design.outputs import optimized
    from chromanoise.design.reading import read_design
    from chromanoise.design.result import Design
    from chromanoise.design.scheduler import scheduler_at
    from chromanoise.design.search import Progress
    from chromanoise.design.starter import DESIGN_STARTER

__all__ = [
    "DESIGN_STARTER",
    "OBJECTIVES",
    "Design",
    "DesignDocument",
    "Progress",
    "optimized",
    "read_design",
    "scheduler_at",
    "with_effort",
]
__getattr__, __dir__ = lazy_names(__name__)
