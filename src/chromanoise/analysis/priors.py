"""Spectral priors by name: the reflectances on which color matrices are trained."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache, partial

from chromanoise.color import Training, chart_training, nir_diverse, smooth_training
from chromanoise.spectra import DEFAULT_OBSERVER, Illuminant

Prior = Callable[[Illuminant], Training]
"""A function from a lamp to a training set of reflectances."""


def chart_with_nir(illuminant: Illuminant) -> Training:
    """The ColorChecker, each patch also with nine other near-infrared reflectances."""
    return nir_diverse(chart_training(illuminant))


def smooth_with_nir(illuminant: Illuminant) -> Training:
    """Smooth spectra (50 nm), each also with nine other near-infrared reflectances."""
    return nir_diverse(smooth_training(illuminant, width_nm=50.0))


PRIORS: Mapping[str, Prior] = {
    "chart-nir": chart_with_nir,
    "chart": chart_training,
    "smooth-50-nir": smooth_with_nir,
    "smooth-50": partial(smooth_training, width_nm=50.0),
    "smooth-100": partial(smooth_training, width_nm=100.0),
}
"""Priors by name; the first is the default.

In "chart" and "smooth" the near-infrared reflectance correlates with the visible one, so infrared
electrons carry information about color; in the "nir" priors they carry none.
"""
DEFAULT_PRIOR = "chart-nir"


@lru_cache(maxsize=16)
def training_named(
    prior: str, illuminant: Illuminant, observer: str = DEFAULT_OBSERVER
) -> Training:
    """The training set of a prior under a lamp, cached per lamp for sweeps.

    Parameters
    ----------
    prior
        A name from `PRIORS`.
    observer
        A name from `chromanoise.spectra.OBSERVERS`.
    """
    return replace(PRIORS[prior](illuminant), observer=observer)
