"""All results for sensors at an operating point: SNR, budgets, sweeps and comparisons."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.analysis.analysis import (
        Analysis,
        analyzed,
        color_snr_db,
        contravariant_snr_db,
        diagnosis,
        mean_color_error,
        metric_of,
        raw_snr_db,
    )
    from chromanoise.analysis.budgets import (
        color_budgets,
        contravariant_budgets,
        coordinate_budget,
        lab_budgets,
        missing_lab_budgets,
    )
    from chromanoise.analysis.camera_pipeline import pipeline_noise
    from chromanoise.analysis.chart_patches import ChartNoise, chart_as_json, chart_noise
    from chromanoise.analysis.color_matrices import (
        DEFAULT_METHOD,
        METHODS,
        MatrixFunction,
        MatrixMaker,
        MatrixMethod,
        known_matrices,
        matrix_makers,
        trained_names,
    )
    from chromanoise.analysis.color_space_noise import GrayNoise, gray_noise, gray_noise_as_json
    from chromanoise.analysis.comparison.bands import (
        CrossoverBand,
        band_sentence,
        bands_as_json,
        crossover_bands,
    )
    from chromanoise.analysis.comparison.crossing import (
        Crossover,
        Incomparable,
        crossover_sentence,
        crossovers,
        crossovers_or_reasons,
    )
    from chromanoise.analysis.comparison.curves import Curve, compared
    from chromanoise.analysis.comparison.quantities import QUANTITIES, Quantity
    from chromanoise.analysis.comparison.sweeps import SWEEPS, Sweep, swept_values
    from chromanoise.analysis.export import analyses_as_json, budgets_as_json, comparison_as_json
    from chromanoise.analysis.figures_of_merit.merits import (
        Merit,
        Merits,
        Viewing,
        merits_as_json,
        merits_of,
    )
    from chromanoise.analysis.information import (
        About,
        InformationChain,
        InformationStep,
        information_chain,
    )
    from chromanoise.analysis.operating_point import Stages, electrons_at, noisy_color_at, stages_at
    from chromanoise.analysis.pareto import matrix_as_json, noise_weights, pareto_of, white_snr_db
    from chromanoise.analysis.pipeline_results import (
        BASE_ISO,
        GainStep,
        PipelineNoise,
        PipelineSettings,
        PipelineStep,
        WhiteBalanceNoise,
        pipeline_as_json,
    )
    from chromanoise.analysis.priors import DEFAULT_PRIOR, PRIORS, Prior
    from chromanoise.analysis.total_error import (
        TotalError,
        better_matrix,
        mean_total_error,
        total_error_of,
        total_errors,
    )

__all__ = [
    "BASE_ISO",
    "DEFAULT_METHOD",
    "DEFAULT_PRIOR",
    "METHODS",
    "PRIORS",
    "QUANTITIES",
    "SWEEPS",
    "About",
    "Analysis",
    "ChartNoise",
    "Crossover",
    "CrossoverBand",
    "Curve",
    "GainStep",
    "GrayNoise",
    "Incomparable",
    "InformationChain",
    "InformationStep",
    "MatrixFunction",
    "MatrixMaker",
    "MatrixMethod",
    "Merit",
    "Merits",
    "PipelineNoise",
    "PipelineSettings",
    "PipelineStep",
    "Prior",
    "Quantity",
    "Stages",
    "Sweep",
    "TotalError",
    "Viewing",
    "WhiteBalanceNoise",
    "analyses_as_json",
    "analyzed",
    "band_sentence",
    "bands_as_json",
    "better_matrix",
    "budgets_as_json",
    "chart_as_json",
    "chart_noise",
    "color_budgets",
    "color_snr_db",
    "compared",
    "comparison_as_json",
    "contravariant_budgets",
    "contravariant_snr_db",
    "coordinate_budget",
    "crossover_bands",
    "crossover_sentence",
    "crossovers",
    "crossovers_or_reasons",
    "diagnosis",
    "electrons_at",
    "gray_noise",
    "gray_noise_as_json",
    "information_chain",
    "known_matrices",
    "lab_budgets",
    "matrix_as_json",
    "matrix_makers",
    "mean_color_error",
    "mean_total_error",
    "merits_as_json",
    "merits_of",
    "metric_of",
    "missing_lab_budgets",
    "noise_weights",
    "noisy_color_at",
    "pareto_of",
    "pipeline_as_json",
    "pipeline_noise",
    "raw_snr_db",
    "stages_at",
    "swept_values",
    "total_error_of",
    "total_errors",
    "trained_names",
    "white_snr_db",
]
__getattr__, __dir__ = lazy_names(__name__, Method="MatrixMethod")
