"""The file formats of a picture, known without an import of their writers."""

FORMATS = ("png", "xyz", "srgb16", "exr", "raw", "dng")
MOST_FRAMES = 1_000_000
"""Of a burst."""
