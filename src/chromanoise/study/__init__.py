"""One reproducible run: the analysis of sensors, and the paper's own study."""

from chromanoise.study.analysis import (
    Analysis,
    analyzed,
    color_budgets,
    color_price_db,
    color_snr_db,
    contravariant_budgets,
    contravariant_snr_db,
    diagnosis,
    mean_color_error,
    raw_snr_db,
)
from chromanoise.study.comparison import (
    Contestant,
    Crossover,
    Curve,
    MatrixMaker,
    compared,
    comparison_as_json,
    crossover_sentence,
    crossovers,
    luminance_snr_db,
)
from chromanoise.study.export import analyses_as_json, budgets_as_json, reproduction_as_json
from chromanoise.study.findings import (
    luminance_budget,
    metric_remark,
    set_aside_reasons,
    table_5_finding,
    verdict,
)
from chromanoise.study.layout import PaperTable, as_printed, paper_tables
from chromanoise.study.paper import PaperStudy, paper_study
from chromanoise.study.perceived import grey_noise, grey_noise_as_json
from chromanoise.study.planes import PaperPlanes, paper_planes
from chromanoise.study.reproduction import Cell, Reproduction, reproduced

__all__ = [
    "Analysis",
    "Cell",
    "Contestant",
    "Crossover",
    "Curve",
    "MatrixMaker",
    "PaperPlanes",
    "PaperStudy",
    "PaperTable",
    "Reproduction",
    "analyses_as_json",
    "analyzed",
    "as_printed",
    "budgets_as_json",
    "color_budgets",
    "color_price_db",
    "color_snr_db",
    "compared",
    "comparison_as_json",
    "contravariant_budgets",
    "contravariant_snr_db",
    "crossover_sentence",
    "crossovers",
    "diagnosis",
    "grey_noise",
    "grey_noise_as_json",
    "luminance_budget",
    "luminance_snr_db",
    "mean_color_error",
    "metric_remark",
    "paper_planes",
    "paper_study",
    "paper_tables",
    "raw_snr_db",
    "reproduced",
    "reproduction_as_json",
    "set_aside_reasons",
    "table_5_finding",
    "verdict",
]
