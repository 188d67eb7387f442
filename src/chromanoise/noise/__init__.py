"""How sure the electrons are: sources, covariance (eq. 7), propagation, Monte Carlo."""

from chromanoise.noise.exact import Moments, Readout, measured, read_moments
from chromanoise.noise.expectation import Expectation, expectation
from chromanoise.noise.measurement import Measurement, through
from chromanoise.noise.montecarlo import Estimate, monte_carlo
from chromanoise.noise.quantiles import electrons_of_normal, read_values
from chromanoise.noise.raw import raw_covariance, saturated, with_noise
from chromanoise.noise.sampling import clipped_at_well, sample_electrons

__all__ = [
    "Estimate",
    "Expectation",
    "Measurement",
    "Moments",
    "Readout",
    "clipped_at_well",
    "electrons_of_normal",
    "expectation",
    "measured",
    "monte_carlo",
    "raw_covariance",
    "read_moments",
    "read_values",
    "sample_electrons",
    "saturated",
    "through",
    "with_noise",
]
