"""The way of the light for a whole picture."""

from chromanoise.imaging.render import Picture, rendered
from chromanoise.imaging.writers import picture_summary, png_bytes, write_png, write_xyz_tiff

__all__ = [
    "Picture",
    "picture_summary",
    "png_bytes",
    "rendered",
    "write_png",
    "write_xyz_tiff",
]
