"""Read spectral curves from common file formats, with questions for missing metadata."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.spectra.dispatch import read_curves
    from chromanoise.io.spectra.envi import library_files
    from chromanoise.io.spectra.parsed import ASK, Answers, ParsedSpectra, Question
    from chromanoise.io.spectra.questions import power_of, power_of_photons, qe_of

__all__ = [
    "ASK",
    "Answers",
    "ParsedSpectra",
    "Question",
    "library_files",
    "power_of",
    "power_of_photons",
    "qe_of",
    "read_curves",
]
__getattr__, __dir__ = lazy_names(__name__)
