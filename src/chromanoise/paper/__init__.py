"""The paper's own study: Tables 2-5 and the figures (Clouet et al., CIC27, 2019)."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.paper.findings import (
        luminance_budget,
        metric_remark,
        set_aside_reasons,
        table_5_finding,
        verdict,
    )
    from chromanoise.paper.planes import PaperPlanes, paper_planes
    from chromanoise.paper.reproduction import Cell, Reproduction, reproduced, witnessed_columns
    from chromanoise.paper.study import PaperStudy, paper_study
    from chromanoise.paper.tables import PaperTable, as_printed, paper_tables, reproduction_as_json

__all__ = [
    "Cell",
    "PaperPlanes",
    "PaperStudy",
    "PaperTable",
    "Reproduction",
    "as_printed",
    "luminance_budget",
    "metric_remark",
    "paper_planes",
    "paper_study",
    "paper_tables",
    "reproduced",
    "reproduction_as_json",
    "set_aside_reasons",
    "table_5_finding",
    "verdict",
    "witnessed_columns",
]
__getattr__, __dir__ = lazy_names(__name__)
