"""Readers (`spectra`, `cubes`, `pixels`, `frames`) and writers of files."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.sensors import read_sensor, read_sensor_csv

__all__ = [
    "read_sensor",
    "read_sensor_csv",
]
__getattr__, __dir__ = lazy_names(__name__)
