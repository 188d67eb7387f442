"""Sensors, filters and illuminants by name, from the catalog or from a file."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.catalog.entries import (
        Entry as Entry,
        catalog_entries as catalog_entries,
        catalog_entry as catalog_entry,
        catalog_file_of as catalog_file_of,
    )
    from chromanoise.catalog.pixel_files import (
        converter_of as converter_of,
        idle_answers as idle_answers,
        on_pixel as on_pixel,
        own_sensor_of as own_sensor_of,
        read_pixel_source as read_pixel_source,
        sensor_with_pixel as sensor_with_pixel,
    )
    from chromanoise.catalog.sensor_tables import (
        is_assumed as is_assumed,
        sensor_from_table as sensor_from_table,
    )
    from chromanoise.catalog.sensors import (
        KNOWN_SENSORS as KNOWN_SENSORS,
        SENSOR_NAMES as SENSOR_NAMES,
        sensor_named as sensor_named,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
