"""The planes of an exposure: electrons with the noise of the sensor at this exposure."""

from collections.abc import Sequence

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float32
from chromanoise.denoising.planes import NoisyPlanes, names_of_places
from chromanoise.exposure import OperatingPoint
from chromanoise.imaging.demosaic_methods import chart_electrons, chart_prior
from chromanoise.noise import demand_independent_channels, noise_sources


def exposed_planes(
    values_e: Float32[Array, "h w k"],
    operating_point: OperatingPoint,
    *,
    channels: Sequence[int] | None = None,
) -> NoisyPlanes:
    """Planes of electrons with their noise, and the ColorChecker in this light as prior.

    Parameters
    ----------
    values_e
        Noisy electrons after readout, without dark electrons. [e-]
    operating_point
        Sensor, exposure and light.
    channels
        Index of the channel of each plane; all channels of the sensor in their order by default.

    Raises
    ------
    InputError
        If crosstalk after counting correlates the channels, or the grid of the sensor is not within
        400-1050 nm, the range of the chart data.
    """
    sensor = operating_point.sensor
    demand_independent_channels(sensor)
    noise = noise_sources(sensor, operating_point.exposure)
    of = list(range(len(sensor.names))) if channels is None else list(channels)
    return NoisyPlanes(
        values_e=values_e,
        floor_e2=np.full(len(of), noise.floor_e2()),
        slope_e=np.ones(len(of)),
        prnu=np.full(len(of), noise.prnu),
        prior_e2=chart_prior(operating_point).covariance_e2[np.ix_(of, of)],
        prior_mean_e=chart_electrons(operating_point).mean(axis=0)[of],
        names=names_of_places(sensor.names, of),
    )
