"""Noise of the electrons: covariance (eq. 7), exact moments, propagation, Monte Carlo."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.noise.distribution import (
        ReadingDistribution as ReadingDistribution,
        channel_distribution as channel_distribution,
        clipped_measurement as clipped_measurement,
        clipping_readout as clipping_readout,
        code_count as code_count,
        counted_readout as counted_readout,
        few_electrons as few_electrons,
        poisson_gaussian_ppf as poisson_gaussian_ppf,
        raw_measurement as raw_measurement,
        read_values as read_values,
        reading_distribution as reading_distribution,
        sensor_moments as sensor_moments,
    )
    from chromanoise.noise.exposure import (
        DEFAULT_F_NUMBER,
        DEFAULT_RULE,
        DEFAULT_SHARE,
        EQUAL_TERMS as EQUAL_TERMS,
        FASTEST_F_NUMBER as FASTEST_F_NUMBER,
        Exposure as Exposure,
        OperatingPoint as OperatingPoint,
        band_weights as band_weights,
        conditions as conditions,
        equal_exposure as equal_exposure,
        equal_light as equal_light,
        equal_saturation as equal_saturation,
        expected_electrons as expected_electrons,
        exposure_factor as exposure_factor,
        level_in_words as level_in_words,
        light_and_exposure as light_and_exposure,
        measurement_vectors as measurement_vectors,
        patch_scene as patch_scene,
        refuse_f_number as refuse_f_number,
        refuse_other_grid,
        saturating_exposure as saturating_exposure,
        time_to_saturation as time_to_saturation,
        white_scene as white_scene,
    )
    from chromanoise.noise.measurement import Measurement as Measurement, through as through
    from chromanoise.noise.montecarlo import (
        Estimate as Estimate,
        clipped_at_well as clipped_at_well,
        monte_carlo as monte_carlo,
        sample_electrons as sample_electrons,
    )
    from chromanoise.noise.readout import (
        Expectation as Expectation,
        Moments as Moments,
        Readout as Readout,
        coded_moments,
        expectation as expectation,
        held_moments,
        over_counts,
        read_moments as read_moments,
    )
    from chromanoise.noise.variance import (
        NoiseSources as NoiseSources,
        after_counting as after_counting,
        coarsely_converted,
        counted_electrons as counted_electrons,
        crosstalk_pattern,
        demand_independent_channels as demand_independent_channels,
        mean_noise_covariance as mean_noise_covariance,
        noise_sources as noise_sources,
        one_code as one_code,
        raw_covariance as raw_covariance,
        saturated as saturated,
        signal_limit_e as signal_limit_e,
        with_noise as with_noise,
    )
    from chromanoise.sensor import NoiseKind as NoiseKind

__getattr__, __dir__, __all__ = lazy_names(__name__)
