"""The way of the light for a whole picture."""

from chromanoise.imaging.render import (
    Picture,
    RawPicture,
    acquired,
    electrons_of_cube,
    rendered,
)
from chromanoise.imaging.sampling import noisy_electrons
from chromanoise.imaging.work import Work
from chromanoise.imaging.writers import picture_summary, png_bytes, write_png, write_xyz_tiff

__all__ = [
    "Picture",
    "RawPicture",
    "Work",
    "acquired",
    "electrons_of_cube",
    "noisy_electrons",
    "picture_summary",
    "png_bytes",
    "rendered",
    "write_png",
    "write_xyz_tiff",
]
