"""Read spectral curves from common file formats, with questions for missing metadata."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.spectra.dispatch import read_curves as read_curves
    from chromanoise.io.spectra.envi import library_files as library_files
    from chromanoise.io.spectra.parsed import (
        ASK as ASK,
        Answers as Answers,
        ParsedSpectra as ParsedSpectra,
        Question as Question,
    )
    from chromanoise.io.spectra.questions import (
        power_of as power_of,
        power_of_photons as power_of_photons,
        qe_of as qe_of,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
