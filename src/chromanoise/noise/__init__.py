"""Noise of the electrons: covariance (eq. 7), exact moments, propagation, Monte Carlo.

`sampler` adds the noise of a camera to training data. It is in ``imaging``, whose compiled kernels
it uses, and is imported on first use.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names
from chromanoise.noise.distribution import (
    ReadingDistribution as ReadingDistribution,
    channel_distribution as channel_distribution,
    few_electrons as few_electrons,
    reading_distribution as reading_distribution,
)
from chromanoise.noise.exact import (
    clipped_measurement as clipped_measurement,
    clipping_readout as clipping_readout,
    counted_readout as counted_readout,
    raw_measurement as raw_measurement,
    sensor_moments as sensor_moments,
)
from chromanoise.noise.expectation import (
    Expectation as Expectation,
    expectation as expectation,
)
from chromanoise.noise.measurement import (
    Measurement as Measurement,
    through as through,
)
from chromanoise.noise.montecarlo import (
    Estimate as Estimate,
    monte_carlo as monte_carlo,
)
from chromanoise.noise.quantiles import (
    code_count as code_count,
    poisson_gaussian_ppf as poisson_gaussian_ppf,
    read_values as read_values,
)
from chromanoise.noise.readout import (
    Moments as Moments,
    Readout as Readout,
    read_moments as read_moments,
)
from chromanoise.noise.sampling import (
    clipped_at_well as clipped_at_well,
    sample_electrons as sample_electrons,
)
from chromanoise.noise.sources import (
    NoiseSources as NoiseSources,
    after_counting as after_counting,
    counted_electrons as counted_electrons,
    demand_independent_channels as demand_independent_channels,
    mean_noise_covariance as mean_noise_covariance,
    noise_sources as noise_sources,
    one_code as one_code,
    raw_covariance as raw_covariance,
    saturated as saturated,
    signal_limit_e as signal_limit_e,
    with_noise as with_noise,
)
from chromanoise.sensor.noise_source import NoiseKind as NoiseKind

if TYPE_CHECKING:
    from chromanoise.imaging.training_noise import (
        NoiseSampler as NoiseSampler,
        NoisySample as NoisySample,
        sampler as sampler,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
