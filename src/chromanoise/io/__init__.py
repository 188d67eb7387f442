"""Readers (`spectra`, `cubes`, `pixels`, `frames`) and writers of files."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.curve_files import read_curves
    from chromanoise.io.envi import DATA_SUFFIXES, envi_pair, library_files
    from chromanoise.io.matrix_files import (
        MATRIX_ENDINGS,
        GivenMatrix,
        MadeMatrix,
        crosstalk_table,
        is_matrix_file,
        matrix_of_array,
        matrix_writer,
        read_crosstalk,
        read_matrix,
    )
    from chromanoise.io.result import Result, axes_of, figures, panels_of
    from chromanoise.io.result_tables import (
        Column,
        Entry,
        Table,
        head,
        number_text,
        table_of,
        table_writer,
        written,
        written_rows,
    )
    from chromanoise.io.sensor_files import (
        read_sensor as read_sensor,
        read_sensor_csv as read_sensor_csv,
        sensor_data,
        sensor_from_json,
        sensor_json,
        spectra_json,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
