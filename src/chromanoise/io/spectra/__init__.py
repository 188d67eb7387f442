"""Read spectral curves from common file formats, with questions for missing metadata."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io import library_files as library_files, read_curves as read_curves
    from chromanoise.io.spectra.declared import is_wavelength_heading, wavelength_unit_of
    from chromanoise.io.spectra.parsed import (
        ASK as ASK,
        LARGEST,
        SCHEMA_VERSION,
        Answers as Answers,
        Column,
        Found,
        Level,
        Negatives,
        ParsedSpectra as ParsedSpectra,
        Per,
        Quantity,
        Question as Question,
        Scale,
        Unit,
        gaps_nm,
        held_json,
        in_nm,
        known_columns,
        named,
        step_nm,
    )
    from chromanoise.io.spectra.questions import (
        defects_of,
        defects_of_a_light,
        power_of as power_of,
        power_of_photons as power_of_photons,
        qe_of as qe_of,
    )
    from chromanoise.io.spectra.writing import (
        QE_FACTS,
        mosaic_text,
        photons_as_energy,
        rawtoaces_header,
        rawtoaces_json,
        sensor_csv,
        sensor_rawtoaces_json,
        sensor_spectra,
        spectra_csv,
        spectra_spdx,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
