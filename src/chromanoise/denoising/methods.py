"""All denoising methods by name: add a method here."""

from collections.abc import Mapping

from chromanoise import _check
from chromanoise.denoising.aggregate import AGGREGATE
from chromanoise.denoising.baselines import BASELINES
from chromanoise.denoising.guided import GUIDED
from chromanoise.denoising.linear import LMMSE, WIENER
from chromanoise.denoising.method import DenoisingMethod
from chromanoise.denoising.patches import PATCHES

DENOISING: Mapping[str, DenoisingMethod] = {
    method.name: method for method in (GUIDED, PATCHES, AGGREGATE, LMMSE, WIENER, *BASELINES)
}
"""Denoising methods by their name on the command line and in studies."""


def denoising_named(name: str) -> DenoisingMethod:
    """The denoising method with a name.

    Parameters
    ----------
    name
        Name of a method, such as ``guided``.

    Raises
    ------
    InputError
        If no method has this name.
    """
    return DENOISING[_check.one_of("denoise", name, tuple(DENOISING))]
