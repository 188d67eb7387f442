"""One reproducible run: the analysis of sensors, and the paper's own study.

In the order of reading: ``words`` and ``catalog`` name sensors and lights, ``priors`` and
``makers`` color matrices; ``analysis`` takes one sensor through every stage, with ``perceived``,
``chart``, ``grey_budget`` and ``pareto`` for its noise as seen, and ``merits`` for all its figures
of merit; ``comparing`` sets sensors against each other; ``paper`` is the paper's own study;
``export``, ``tables`` and ``files`` tell results to programs and people; ``runs`` is a study in a
TOML file, and ``drawings`` what is drawn of it.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
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
    from chromanoise.study.catalog import Entry, catalog_entries, catalog_entry, catalog_file_of
    from chromanoise.study.chart import ChartNoise, chart_as_json, chart_noise
    from chromanoise.study.comparing.bands import (
        CrossoverBand,
        band_sentence,
        bands_as_json,
        crossover_bands,
    )
    from chromanoise.study.comparing.crossing import (
        Crossover,
        Incomparable,
        crossover_sentence,
        crossovers,
        crossovers_or_reasons,
    )
    from chromanoise.study.comparing.curves import Curve, compared
    from chromanoise.study.comparing.quantities import QUANTITIES, Quantity
    from chromanoise.study.comparing.sweeps import SWEEPS, Sweep, swept_values
    from chromanoise.study.export import (
        analyses_as_json,
        budgets_as_json,
        comparison_as_json,
        reproduction_as_json,
    )
    from chromanoise.study.grey_budget import lab_budgets, missing_lab_budgets
    from chromanoise.study.makers import (
        METHODS,
        MatrixMaker,
        Method,
        known_matrices,
        matrix_makers,
        trained_names,
    )
    from chromanoise.study.merits.entries import Merit, Viewing
    from chromanoise.study.merits.listed import Merits, merits_as_json, merits_of
    from chromanoise.study.paper.findings import (
        luminance_budget,
        metric_remark,
        set_aside_reasons,
        table_5_finding,
        verdict,
    )
    from chromanoise.study.paper.layout import PaperTable, as_printed, paper_tables
    from chromanoise.study.paper.planes import PaperPlanes, paper_planes
    from chromanoise.study.paper.reproduction import (
        Cell,
        Reproduction,
        reproduced,
        witnessed_columns,
    )
    from chromanoise.study.paper.study import PaperStudy, paper_study
    from chromanoise.study.pareto import matrix_as_json, noise_weights, pareto_of, white_snr_db
    from chromanoise.study.perceived import GreyNoise, grey_noise, grey_noise_as_json
    from chromanoise.study.priors import DEFAULT_PRIOR, PRIORS, Prior

__all__ = [
    "DEFAULT_PRIOR",
    "METHODS",
    "PRIORS",
    "QUANTITIES",
    "SWEEPS",
    "Analysis",
    "Cell",
    "ChartNoise",
    "Crossover",
    "CrossoverBand",
    "Curve",
    "Entry",
    "GreyNoise",
    "Incomparable",
    "MatrixMaker",
    "Merit",
    "Merits",
    "Method",
    "PaperPlanes",
    "PaperStudy",
    "PaperTable",
    "Prior",
    "Quantity",
    "Reproduction",
    "Sweep",
    "Viewing",
    "analyses_as_json",
    "analyzed",
    "as_printed",
    "band_sentence",
    "bands_as_json",
    "budgets_as_json",
    "catalog_entries",
    "catalog_entry",
    "catalog_file_of",
    "chart_as_json",
    "chart_noise",
    "color_budgets",
    "color_price_db",
    "color_snr_db",
    "compared",
    "comparison_as_json",
    "contravariant_budgets",
    "contravariant_snr_db",
    "crossover_bands",
    "crossover_sentence",
    "crossovers",
    "crossovers_or_reasons",
    "diagnosis",
    "grey_noise",
    "grey_noise_as_json",
    "known_matrices",
    "lab_budgets",
    "luminance_budget",
    "matrix_as_json",
    "matrix_makers",
    "mean_color_error",
    "merits_as_json",
    "merits_of",
    "metric_remark",
    "missing_lab_budgets",
    "noise_weights",
    "paper_planes",
    "paper_study",
    "paper_tables",
    "pareto_of",
    "raw_snr_db",
    "reproduced",
    "reproduction_as_json",
    "set_aside_reasons",
    "swept_values",
    "table_5_finding",
    "trained_names",
    "verdict",
    "white_snr_db",
    "witnessed_columns",
]
__getattr__, __dir__ = lazy_names(__name__)
