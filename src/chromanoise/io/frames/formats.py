"""The formats of raw frames, by the ending of the file."""

from collections.abc import Callable
from pathlib import Path

from chromanoise._inputs import regular_file
from chromanoise.errors import InputError
from chromanoise.io.frames.frame import RawFrame
from chromanoise.io.frames.stored import refused_picture

CAMERA_RAW = (
    *(".dng", ".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".sr2", ".srf", ".raf", ".orf"),
    *(".rw2", ".rwl", ".pef", ".srw", ".3fr", ".fff", ".iiq", ".mos", ".mrw", ".kdc", ".dcr"),
    *(".erf", ".mef", ".x3f"),
)
"""Endings of the files that LibRaw reads."""
PICTURES = (".jpg", ".jpeg", ".jpe", ".heic", ".heif", ".webp", ".gif", ".bmp", ".avif", ".ppm")
"""Endings of pictures that are never raw frames."""


def frames_in(path: Path | str) -> tuple[RawFrame, ...]:
    """The raw frames of a file: one, or those of a stack.

    The header is read now, the pixels with `RawFrame.codes`. The file is never changed.

    Parameters
    ----------
    path
        Camera raw or DNG (needs rawpy), TIFF with one frame per page, FITS (needs astropy), NPY and
        NPZ with frames of 2 or stacks of 3 dimensions, PGM, or gray PNG; by the ending of its
        name.

    Raises
    ------
    InputError
        If the format is unknown, the file is damaged, or it is a processed picture.

    Examples
    --------
    >>> import tempfile, numpy as np
    >>> folder = tempfile.TemporaryDirectory()
    >>> np.save(folder.name + "/flats.npy", np.full((2, 4, 6), 64, np.uint16))
    >>> [(frame.name, frame.shape) for frame in frames_in(folder.name + "/flats.npy")]
    [('flats.npy[0]', (4, 6)), ('flats.npy[1]', (4, 6))]
    >>> folder.cleanup()
    """
    path = Path(path)
    regular_file(path)
    ending = path.suffix.lower()
    if ending in PICTURES:
        raise refused_picture(path, f"is a picture of the format {ending[1:].upper()}")
    reader = _reader(ending)
    if reader is None:
        raise InputError(
            str(path),
            "must be a raw frame (DNG or camera raw, TIFF, FITS, NPY, NPZ, PGM, PNG)",
            value=ending,
            found=f"ends in {ending}" if ending else "has no ending",
            remedy="save it as TIFF or NPY",
        )
    try:
        return reader(path)
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror or error})") from None


def is_frame_name(path: Path) -> bool:
    """Whether a file has the ending of a format of raw frames.

    Examples
    --------
    >>> is_frame_name(Path("a.NEF")), is_frame_name(Path("a.jpg"))
    (True, False)
    """
    return _reader(path.suffix.lower()) is not None


def _reader(ending: str) -> Callable[[Path], tuple[RawFrame, ...]] | None:
    """The reader of an ending; each is imported when it is needed."""
    if ending in CAMERA_RAW:
        from chromanoise.io.frames.camera_raw import raw_frames

        return raw_frames
    if ending in (".tif", ".tiff"):
        from chromanoise.io.frames.tiff import tiff_frames

        return tiff_frames
    if ending in (".fits", ".fit", ".fts"):
        from chromanoise.io.frames.fits import fits_frames

        return fits_frames
    if ending in (".npy", ".npz"):
        from chromanoise.io.frames.arrays import npy_frames, npz_frames

        return npy_frames if ending == ".npy" else npz_frames
    if ending in (".pgm", ".png"):
        from chromanoise.io.frames.gray import pgm_frames, png_frames

        return pgm_frames if ending == ".pgm" else png_frames
    return None
