"""Raw frames of a camera: files, and how the frames form levels of light with their darks."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.frames.frame import (
        FrameLevel as FrameLevel,
        FrameSet as FrameSet,
        RawFrame as RawFrame,
        StoredPlane,
        mosaic_of_all,
        refuse_few,
        refuse_mixed,
    )
    from chromanoise.io.frames.frame_folders import read_frame_set as read_frame_set
    from chromanoise.io.frames.frame_formats import (
        DUMP_ENDINGS,
        DUMP_TYPES,
        dumped_frame,
        frames_in as frames_in,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__, Frame="RawFrame")
