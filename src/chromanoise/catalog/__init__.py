"""Sensors, filters and illuminants by name, from the catalog or from a file."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.catalog.entries import Entry, catalog_entries, catalog_entry, catalog_file_of
    from chromanoise.catalog.pixel_files import (
        converter_of,
        idle_answers,
        on_pixel,
        own_sensor_of,
        read_pixel_source,
        sensor_with_pixel,
    )
    from chromanoise.catalog.sensor_tables import is_assumed, sensor_from_table
    from chromanoise.catalog.sensors import KNOWN_SENSORS, SENSOR_NAMES, sensor_named

__all__ = [
    "KNOWN_SENSORS",
    "SENSOR_NAMES",
    "Entry",
    "catalog_entries",
    "catalog_entry",
    "catalog_file_of",
    "converter_of",
    "idle_answers",
    "is_assumed",
    "on_pixel",
    "own_sensor_of",
    "read_pixel_source",
    "sensor_from_table",
    "sensor_named",
    "sensor_with_pixel",
]
__getattr__, __dir__ = lazy_names(__name__)
