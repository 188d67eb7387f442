"""ENVI files that are written for a measurement and deleted after it."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from subject import BANDS, textured

_WRITTEN_ROWS = 64


class NoRoomError(Exception):
    """Why there is no such file."""


@contextmanager
def envi_file(height: int, width: int, folder: str | None) -> Iterator[Path]:
    """A file of reflectances by pixel, float32, and its header beside it.

    Raises
    ------
    NoRoomError
        If the disk has not twice the room.
    """
    size = height * width * BANDS * 4
    with tempfile.TemporaryDirectory(prefix="chromanoise-", dir=folder) as place:
        free = shutil.disk_usage(place).free
        if free < 2 * size:
            raise NoRoomError(
                f"{free / 1e9:.0f} GB are free in {place}, {2 * size / 1e9:.0f} wanted"
            )
        path = Path(place) / "cube.img"
        rows = textured(_WRITTEN_ROWS, width)
        with path.open("wb") as file:
            for start in range(0, height, _WRITTEN_ROWS):
                rows[: min(_WRITTEN_ROWS, height - start)].tofile(file)
            file.flush()
            os.fsync(file.fileno())  # what is not yet on the disk cannot be dropped from the cache
        centers = ", ".join(f"{nm:g}" for nm in np.linspace(400.0, 1050.0, BANDS))
        path.with_suffix(".hdr").write_text(
            f"ENVI\nsamples = {width}\nlines = {height}\nbands = {BANDS}\nheader offset = 0\n"
            f"data type = 4\ninterleave = bip\nbyte order = 0\nreflectance scale factor = 1\n"
            f"wavelength units = Nanometers\nwavelength = {{{centers}}}\n"
        )
        yield path


def dropped_from_cache(path: Path) -> None:
    """Let the system forget what it holds of a file, so that the next reading is from the disk."""
    with path.open("rb") as file:
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
