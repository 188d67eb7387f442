"""The raw SNR by which several sensors are compared."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from chromanoise.analysis.analysis import Analysis, raw_snr_db


def compared_raw_snr_db(analysis: Analysis, analyses: Sequence[Analysis]) -> float:
    """Mean raw SNR of the channels that all sensors have; without them the best linear SNR. [dB]

    Infinite for a signal without noise.

    Parameters
    ----------
    analysis
        That of one sensor, without saturated channels.
    analyses
        Those of all compared sensors.
    """
    shared, snr = _shared(tuple(analyses)), raw_snr_db(analysis)
    if shared:
        return float(np.mean([snr[name] for name in shared]))
    best = analysis.optimal_linear_snr_db
    return math.inf if best is None else best  # not saturated: it is signal without noise


def compared_raw_name(analyses: Sequence[Analysis]) -> str:
    """What `compared_raw_snr_db` is, in a few words.

    Parameters
    ----------
    analyses
        Those of all compared sensors.
    """
    shared = _shared(tuple(analyses))
    return f"mean of {', '.join(shared)}" if shared else "best linear readout of all channels"


@lru_cache(maxsize=16)  # verdict and ranking ask for each sensor
def _shared(analyses: tuple[Analysis, ...]) -> tuple[str, ...]:
    """Channels that all sensors have, with signal in all of them."""
    found = [raw_snr_db(analysis) for analysis in analyses]
    return tuple(
        name for name in analyses[0].sensor.names if all(one.get(name) is not None for one in found)
    )
