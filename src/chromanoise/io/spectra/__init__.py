"""Read spectral curves from common file formats, with questions for missing metadata."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io import library_files as library_files, read_curves as read_curves
    from chromanoise.io.spectra.declared import (
        BAND_NAMES,
        NAMED_WAVELENGTH,
        NM_PER,
        SPECTRAL_NAMES,
        Listed,
        declared_keys,
        fitting,
        is_list,
        is_wavelength_heading,
        known_unit,
        listed_wavelengths,
        nanometers,
        wavelength_unit_of,
    )
    from chromanoise.io.spectra.delimited import (
        DELIMITERS,
        cells_of_line,
        decimal_sign,
        is_cgats,
        read_cgats,
        read_delimited,
        read_workbook,
        split_line,
    )
    from chromanoise.io.spectra.instruments import (
        is_asd,
        read_asd,
        read_fits,
        read_isetcam,
        read_tm27,
    )
    from chromanoise.io.spectra.interpretation import meaning_of
    from chromanoise.io.spectra.jcamp import is_jcamp, read_jcamp
    from chromanoise.io.spectra.json_curves import read_json
    from chromanoise.io.spectra.parsed import (
        ASK as ASK,
        LARGEST,
        SCHEMA_VERSION,
        SPECTRA_SCHEMA,
        Answers as Answers,
        Column,
        Found,
        Level,
        Negatives,
        ParsedSpectra as ParsedSpectra,
        Per,
        Quantity,
        Question as Question,
        Row,
        Scale,
        Unit,
        array_of,
        as_json,
        gaps_nm,
        held_json,
        in_nm,
        known_columns,
        missing_notes,
        named,
        number_of,
        step_nm,
        unfit,
        word_of,
        words_of,
    )
    from chromanoise.io.spectra.questions import (
        defects_of,
        defects_of_a_light,
        power_of as power_of,
        power_of_photons as power_of_photons,
        qe_of as qe_of,
    )
    from chromanoise.io.spectra.tables import number_in
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
