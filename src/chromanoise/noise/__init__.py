"""Noise of the electrons: covariance (eq. 7), exact moments, propagation, Monte Carlo."""

from chromanoise.noise.exact import (
    Moments,
    Readout,
    clipped_measurement,
    raw_measurement,
    read_moments,
)
from chromanoise.noise.expectation import Expectation, expectation
from chromanoise.noise.measurement import Measurement, through
from chromanoise.noise.montecarlo import Estimate, monte_carlo
from chromanoise.noise.quantiles import poisson_gaussian_ppf, read_values
from chromanoise.noise.raw import raw_covariance, saturated, with_noise
from chromanoise.noise.sampling import clipped_at_well, sample_electrons

__all__ = [
    "Estimate",
    "Expectation",
    "Measurement",
    "Moments",
    "Readout",
    "clipped_at_well",
    "clipped_measurement",
    "expectation",
    "monte_carlo",
    "poisson_gaussian_ppf",
    "raw_covariance",
    "raw_measurement",
    "read_moments",
    "read_values",
    "sample_electrons",
    "saturated",
    "through",
    "with_noise",
]
