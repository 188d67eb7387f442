"""The paper's own study: Tables 2-5 and the figures (Clouet et al., CIC27, 2019)."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.paper.findings import luminance_budget as luminance_budget
    from chromanoise.paper.findings import metric_remark as metric_remark
    from chromanoise.paper.findings import set_aside_reasons as set_aside_reasons
    from chromanoise.paper.findings import table_5_finding as table_5_finding
    from chromanoise.paper.findings import verdict as verdict
    from chromanoise.paper.planes import PaperPlanes as PaperPlanes
    from chromanoise.paper.planes import paper_planes as paper_planes
    from chromanoise.paper.reproduction import Cell as Cell
    from chromanoise.paper.reproduction import Reproduction as Reproduction
    from chromanoise.paper.reproduction import reproduced as reproduced
    from chromanoise.paper.reproduction import witnessed_columns as witnessed_columns
    from chromanoise.paper.study import PaperStudy as PaperStudy
    from chromanoise.paper.study import paper_study as paper_study
    from chromanoise.paper.tables import PaperTable as PaperTable
    from chromanoise.paper.tables import as_printed as as_printed
    from chromanoise.paper.tables import paper_tables as paper_tables
    from chromanoise.paper.tables import reproduction_as_json as reproduction_as_json

__getattr__, __dir__ = lazy_names(__name__)
