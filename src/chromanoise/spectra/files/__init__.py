"""Files of spectra in the formats that people have, and what was understood of each."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.spectra.files.door import read_curves
    from chromanoise.spectra.files.envi_library import library_files
    from chromanoise.spectra.files.understood import ASK, Answers, Question, Understood
    from chromanoise.spectra.files.uses import power_of, power_of_photons, qe_of

__all__ = [
    "ASK",
    "Answers",
    "Question",
    "Understood",
    "library_files",
    "power_of",
    "power_of_photons",
    "qe_of",
    "read_curves",
]
__getattr__, __dir__ = lazy_names(__name__)
