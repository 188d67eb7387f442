"""Spectral priors by name: the reflectances on which color matrices are trained."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache, partial

from chromanoise import _check
from chromanoise.color import Training, chart_training, nir_diverse, smooth_training
from chromanoise.spectra import DEFAULT_OBSERVER, Illuminant, Spectra

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
"""Name of the training set that trained matrices use unless another is given."""


@lru_cache(maxsize=16)
def training_named(
    prior: str | Spectra, illuminant: Illuminant, observer: str = DEFAULT_OBSERVER
) -> Training:
    """The training set of a prior under a lamp, cached per lamp for sweeps.

    Parameters
    ----------
    prior
        A name from `PRIORS`, or reflectances on the grid of the lamp, which are used as they are.
    illuminant
        The lamp.
    observer
        A name from `chromanoise.spectra.OBSERVERS`.
    """
    if isinstance(prior, str):
        name = _check.one_of("prior", prior, tuple(PRIORS))
        return replace(PRIORS[name](illuminant), observer=observer)
    return Training(
        illuminant=illuminant,
        reflectance=prior.values.T,
        names=prior.names,
        source=prior.source,
        notes=prior.notes,
        observer=observer,
    )


def refuse_unknown_prior(prior: str | Spectra) -> None:
    """Refuse a name that is none of `PRIORS`.

    Raises
    ------
    InputError
        If there is no such name.
    """
    if isinstance(prior, str):
        _check.one_of("prior", prior, tuple(PRIORS))
