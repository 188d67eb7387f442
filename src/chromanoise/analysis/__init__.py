"""All results for sensors at an operating point: SNR, budgets, sweeps and comparisons."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.analysis.analysis import (
        Analysis as Analysis,
        analyzed as analyzed,
        color_snr_db as color_snr_db,
        contravariant_snr_db as contravariant_snr_db,
        diagnosis as diagnosis,
        mean_color_error as mean_color_error,
        metric_of as metric_of,
        raw_snr_db as raw_snr_db,
    )
    from chromanoise.analysis.budgets import (
        color_budgets as color_budgets,
        contravariant_budgets as contravariant_budgets,
        coordinate_budget as coordinate_budget,
        lab_budgets as lab_budgets,
        missing_lab_budgets as missing_lab_budgets,
    )
    from chromanoise.analysis.camera_pipeline import pipeline_noise as pipeline_noise
    from chromanoise.analysis.chart_patches import (
        ChartNoise as ChartNoise,
        chart_as_json as chart_as_json,
        chart_noise as chart_noise,
    )
    from chromanoise.analysis.color_matrices import (
        DEFAULT_METHOD as DEFAULT_METHOD,
        METHODS as METHODS,
        MatrixFunction as MatrixFunction,
        MatrixMaker as MatrixMaker,
        MatrixMethod as MatrixMethod,
        known_matrices as known_matrices,
        matrix_makers as matrix_makers,
        trained_names as trained_names,
    )
    from chromanoise.analysis.color_space_noise import (
        GrayNoise as GrayNoise,
        gray_noise as gray_noise,
        gray_noise_as_json as gray_noise_as_json,
    )
    from chromanoise.analysis.comparison.bands import (
        CrossoverBand as CrossoverBand,
        band_sentence as band_sentence,
        bands_as_json as bands_as_json,
        crossover_bands as crossover_bands,
    )
    from chromanoise.analysis.comparison.crossing import (
        Crossover as Crossover,
        Incomparable as Incomparable,
        crossover_sentence as crossover_sentence,
        crossovers as crossovers,
        crossovers_or_reasons as crossovers_or_reasons,
    )
    from chromanoise.analysis.comparison.curves import Curve as Curve, compared as compared
    from chromanoise.analysis.comparison.quantities import (
        QUANTITIES as QUANTITIES,
        Quantity as Quantity,
    )
    from chromanoise.analysis.comparison.sweeps import (
        SWEEPS as SWEEPS,
        Sweep as Sweep,
        swept_values as swept_values,
    )
    from chromanoise.analysis.export import (
        analyses_as_json as analyses_as_json,
        budgets_as_json as budgets_as_json,
        comparison_as_json as comparison_as_json,
    )
    from chromanoise.analysis.figures_of_merit.merits import (
        Merit as Merit,
        Merits as Merits,
        Viewing as Viewing,
        merits_as_json as merits_as_json,
        merits_of as merits_of,
    )
    from chromanoise.analysis.information import (
        About as About,
        InformationChain as InformationChain,
        InformationStep as InformationStep,
        information_chain as information_chain,
    )
    from chromanoise.analysis.operating_point import (
        Stages as Stages,
        electrons_at as electrons_at,
        noisy_color_at as noisy_color_at,
        stages_at as stages_at,
    )
    from chromanoise.analysis.pareto import (
        matrix_as_json as matrix_as_json,
        noise_weights as noise_weights,
        pareto_of as pareto_of,
        white_snr_db as white_snr_db,
    )
    from chromanoise.analysis.pipeline_results import (
        BASE_ISO as BASE_ISO,
        GainStep as GainStep,
        PipelineNoise as PipelineNoise,
        PipelineSettings as PipelineSettings,
        PipelineStep as PipelineStep,
        WhiteBalanceNoise as WhiteBalanceNoise,
        pipeline_as_json as pipeline_as_json,
    )
    from chromanoise.analysis.priors import (
        DEFAULT_PRIOR as DEFAULT_PRIOR,
        PRIORS as PRIORS,
        Prior as Prior,
    )
    from chromanoise.analysis.total_error import (
        TotalError as TotalError,
        better_matrix as better_matrix,
        mean_total_error as mean_total_error,
        total_error_of as total_error_of,
        total_errors as total_errors,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__, Method="MatrixMethod")
