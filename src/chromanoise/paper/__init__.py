"""The paper's own study: Tables 2-5 and the figures (Clouet et al., CIC27, 2019)."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.paper.findings import (
        luminance_budget as luminance_budget,
        metric_remark as metric_remark,
        set_aside_reasons as set_aside_reasons,
        table_5_finding as table_5_finding,
        verdict as verdict,
    )
    from chromanoise.paper.planes import PaperPlanes as PaperPlanes, paper_planes as paper_planes
    from chromanoise.paper.reproduction import (
        Cell as Cell,
        Reproduction as Reproduction,
        reproduced as reproduced,
        witnessed_columns as witnessed_columns,
    )
    from chromanoise.paper.study import PaperStudy as PaperStudy, paper_study as paper_study
    from chromanoise.paper.tables import (
        PaperTable as PaperTable,
        as_printed as as_printed,
        paper_tables as paper_tables,
        reproduction_as_json as reproduction_as_json,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
