"""Files in and out: `spectra`, `cubes` and `pixels` read what people have, the rest writes."""

from chromanoise.io.sensors import (
    read_sensor,
    read_sensor_csv,
)

__all__ = [
    "read_sensor",
    "read_sensor_csv",
]
