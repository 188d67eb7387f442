"""Hyperspectral cubes from TIFF, ENVI, MATLAB, HDF5, NetCDF, Zarr, NumPy and PNG folders."""

from chromanoise.io.cubes.readers import (
    read_cube,
)
from chromanoise.io.cubes.xarray_io import (
    cube_from_xarray,
    picture_to_xarray,
)

__all__ = [
    "cube_from_xarray",
    "picture_to_xarray",
    "read_cube",
]
