"""Hyperspectral cubes from TIFF, ENVI, MATLAB, HDF5, NetCDF, Zarr, NumPy and PNG folders."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.cubes.cube_files import read_cube as read_cube
    from chromanoise.io.cubes.found_cube import reading
    from chromanoise.io.cubes.labeled import (
        cube_from_xarray as cube_from_xarray,
        picture_to_xarray as picture_to_xarray,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
