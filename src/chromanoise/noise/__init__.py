"""Noise of the electrons: covariance (eq. 7), exact moments, propagation, Monte Carlo.

`sampler` adds the noise of a camera to training data. It is in ``imaging``, whose compiled kernels
it uses, and is imported on first use.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names
from chromanoise.noise.distribution import (
    ReadingDistribution,
    channel_distribution,
    few_electrons,
    reading_distribution,
)
from chromanoise.noise.exact import (
    clipped_measurement,
    clipping_readout,
    counted_readout,
    raw_measurement,
    sensor_moments,
)
from chromanoise.noise.expectation import Expectation, expectation
from chromanoise.noise.measurement import Measurement, through
from chromanoise.noise.montecarlo import Estimate, monte_carlo
from chromanoise.noise.quantiles import code_count, poisson_gaussian_ppf, read_values
from chromanoise.noise.readout import Moments, Readout, read_moments
from chromanoise.noise.sampling import clipped_at_well, sample_electrons
from chromanoise.noise.sources import (
    NoiseSources,
    after_counting,
    counted_electrons,
    demand_independent_channels,
    mean_noise_covariance,
    noise_sources,
    one_code,
    raw_covariance,
    saturated,
    signal_limit_e,
    with_noise,
)
from chromanoise.sensor.noise_source import NoiseKind

if TYPE_CHECKING:
    from chromanoise.imaging.training_noise import NoiseSampler, NoisySample, sampler

__all__ = [
    "Estimate",
    "Expectation",
    "Measurement",
    "Moments",
    "NoiseKind",
    "NoiseSampler",
    "NoiseSources",
    "NoisySample",
    "ReadingDistribution",
    "Readout",
    "after_counting",
    "channel_distribution",
    "clipped_at_well",
    "clipped_measurement",
    "clipping_readout",
    "code_count",
    "counted_electrons",
    "counted_readout",
    "demand_independent_channels",
    "expectation",
    "few_electrons",
    "mean_noise_covariance",
    "monte_carlo",
    "noise_sources",
    "one_code",
    "poisson_gaussian_ppf",
    "raw_covariance",
    "raw_measurement",
    "read_moments",
    "read_values",
    "reading_distribution",
    "sample_electrons",
    "sampler",
    "saturated",
    "sensor_moments",
    "signal_limit_e",
    "through",
    "with_noise",
]
__getattr__, __dir__ = lazy_names(__name__)
