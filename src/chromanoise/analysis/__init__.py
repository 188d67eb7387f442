"""All results for sensors at an operating point: SNR, budgets, sweeps and comparisons."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.analysis.analysis import Analysis as Analysis
    from chromanoise.analysis.analysis import analyzed as analyzed
    from chromanoise.analysis.analysis import color_snr_db as color_snr_db
    from chromanoise.analysis.analysis import contravariant_snr_db as contravariant_snr_db
    from chromanoise.analysis.analysis import diagnosis as diagnosis
    from chromanoise.analysis.analysis import mean_color_error as mean_color_error
    from chromanoise.analysis.analysis import metric_of as metric_of
    from chromanoise.analysis.analysis import raw_snr_db as raw_snr_db
    from chromanoise.analysis.budgets import color_budgets as color_budgets
    from chromanoise.analysis.budgets import contravariant_budgets as contravariant_budgets
    from chromanoise.analysis.budgets import coordinate_budget as coordinate_budget
    from chromanoise.analysis.budgets import lab_budgets as lab_budgets
    from chromanoise.analysis.budgets import missing_lab_budgets as missing_lab_budgets
    from chromanoise.analysis.camera_pipeline import pipeline_noise as pipeline_noise
    from chromanoise.analysis.chart_patches import ChartNoise as ChartNoise
    from chromanoise.analysis.chart_patches import chart_as_json as chart_as_json
    from chromanoise.analysis.chart_patches import chart_noise as chart_noise
    from chromanoise.analysis.color_matrices import DEFAULT_METHOD as DEFAULT_METHOD
    from chromanoise.analysis.color_matrices import METHODS as METHODS
    from chromanoise.analysis.color_matrices import MatrixFunction as MatrixFunction
    from chromanoise.analysis.color_matrices import MatrixMaker as MatrixMaker
    from chromanoise.analysis.color_matrices import MatrixMethod as MatrixMethod
    from chromanoise.analysis.color_matrices import known_matrices as known_matrices
    from chromanoise.analysis.color_matrices import matrix_makers as matrix_makers
    from chromanoise.analysis.color_matrices import trained_names as trained_names
    from chromanoise.analysis.color_space_noise import GrayNoise as GrayNoise
    from chromanoise.analysis.color_space_noise import gray_noise as gray_noise
    from chromanoise.analysis.color_space_noise import gray_noise_as_json as gray_noise_as_json
    from chromanoise.analysis.comparison.bands import CrossoverBand as CrossoverBand
    from chromanoise.analysis.comparison.bands import band_sentence as band_sentence
    from chromanoise.analysis.comparison.bands import bands_as_json as bands_as_json
    from chromanoise.analysis.comparison.bands import crossover_bands as crossover_bands
    from chromanoise.analysis.comparison.crossing import Crossover as Crossover
    from chromanoise.analysis.comparison.crossing import Incomparable as Incomparable
    from chromanoise.analysis.comparison.crossing import crossover_sentence as crossover_sentence
    from chromanoise.analysis.comparison.crossing import crossovers as crossovers
    from chromanoise.analysis.comparison.crossing import (
        crossovers_or_reasons as crossovers_or_reasons,
    )
    from chromanoise.analysis.comparison.curves import Curve as Curve
    from chromanoise.analysis.comparison.curves import compared as compared
    from chromanoise.analysis.comparison.quantities import QUANTITIES as QUANTITIES
    from chromanoise.analysis.comparison.quantities import Quantity as Quantity
    from chromanoise.analysis.comparison.sweeps import SWEEPS as SWEEPS
    from chromanoise.analysis.comparison.sweeps import Sweep as Sweep
    from chromanoise.analysis.comparison.sweeps import swept_values as swept_values
    from chromanoise.analysis.export import analyses_as_json as analyses_as_json
    from chromanoise.analysis.export import budgets_as_json as budgets_as_json
    from chromanoise.analysis.export import comparison_as_json as comparison_as_json
    from chromanoise.analysis.figures_of_merit.merits import Merit as Merit
    from chromanoise.analysis.figures_of_merit.merits import Merits as Merits
    from chromanoise.analysis.figures_of_merit.merits import Viewing as Viewing
    from chromanoise.analysis.figures_of_merit.merits import merits_as_json as merits_as_json
    from chromanoise.analysis.figures_of_merit.merits import merits_of as merits_of
    from chromanoise.analysis.information import About as About
    from chromanoise.analysis.information import InformationChain as InformationChain
    from chromanoise.analysis.information import InformationStep as InformationStep
    from chromanoise.analysis.information import information_chain as information_chain
    from chromanoise.analysis.operating_point import Stages as Stages
    from chromanoise.analysis.operating_point import electrons_at as electrons_at
    from chromanoise.analysis.operating_point import noisy_color_at as noisy_color_at
    from chromanoise.analysis.operating_point import stages_at as stages_at
    from chromanoise.analysis.pareto import matrix_as_json as matrix_as_json
    from chromanoise.analysis.pareto import noise_weights as noise_weights
    from chromanoise.analysis.pareto import pareto_of as pareto_of
    from chromanoise.analysis.pareto import white_snr_db as white_snr_db
    from chromanoise.analysis.pipeline_results import BASE_ISO as BASE_ISO
    from chromanoise.analysis.pipeline_results import GainStep as GainStep
    from chromanoise.analysis.pipeline_results import PipelineNoise as PipelineNoise
    from chromanoise.analysis.pipeline_results import PipelineSettings as PipelineSettings
    from chromanoise.analysis.pipeline_results import PipelineStep as PipelineStep
    from chromanoise.analysis.pipeline_results import WhiteBalanceNoise as WhiteBalanceNoise
    from chromanoise.analysis.pipeline_results import pipeline_as_json as pipeline_as_json
    from chromanoise.analysis.priors import DEFAULT_PRIOR as DEFAULT_PRIOR
    from chromanoise.analysis.priors import PRIORS as PRIORS
    from chromanoise.analysis.priors import Prior as Prior
    from chromanoise.analysis.total_error import TotalError as TotalError
    from chromanoise.analysis.total_error import better_matrix as better_matrix
    from chromanoise.analysis.total_error import mean_total_error as mean_total_error
    from chromanoise.analysis.total_error import total_error_of as total_error_of
    from chromanoise.analysis.total_error import total_errors as total_errors

__getattr__, __dir__ = lazy_names(__name__, Method="MatrixMethod")
