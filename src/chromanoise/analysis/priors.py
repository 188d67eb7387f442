"""Which reflectances a trained matrix expects: the spectral priors that have a name."""

from collections.abc import Callable, Mapping
from functools import lru_cache, partial

from chromanoise.color import Training, chart_training, nir_diverse, smooth_training
from chromanoise.spectra import Illuminant

Prior = Callable[[Illuminant], Training]
"""Reflectances to train on, under a lamp."""


def chart_with_nir(illuminant: Illuminant) -> Training:
    """The ColorChecker, each patch also with nine other near infrareds."""
    return nir_diverse(chart_training(illuminant))


def smooth_with_nir(illuminant: Illuminant) -> Training:
    """Smooth spectra (50 nm), each also with nine other near infrareds."""
    return nir_diverse(smooth_training(illuminant, width_nm=50.0))


PRIORS: Mapping[str, Prior] = {
    "chart-nir": chart_with_nir,
    "chart": chart_training,
    "smooth-50-nir": smooth_with_nir,
    "smooth-50": partial(smooth_training, width_nm=50.0),
    "smooth-100": partial(smooth_training, width_nm=100.0),
}
"""The first is what a matrix is trained on unless another is asked for.

Where the infrared follows the visible (chart, smooth), infrared electrons tell something about
color; with the other near infrareds (nir) they tell nothing.
"""
DEFAULT_PRIOR = "chart-nir"


@lru_cache(maxsize=16)
def training_named(prior: str, illuminant: Illuminant) -> Training:
    """The training set of a prior under a lamp: one per lamp, as a sweep asks for it every time.

    Parameters
    ----------
    prior
        Of `PRIORS`.
    """
    return PRIORS[prior](illuminant)
