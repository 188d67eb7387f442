"""Raw frames of a camera: files, and how the frames form levels of light with their darks."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.frames.formats import frames_in as frames_in
    from chromanoise.io.frames.frame import (
        FrameLevel as FrameLevel,
        FrameSet as FrameSet,
        RawFrame as RawFrame,
    )
    from chromanoise.io.frames.grouping import read_frame_set as read_frame_set

__getattr__, __dir__, __all__ = lazy_names(__name__, Frame="RawFrame")
