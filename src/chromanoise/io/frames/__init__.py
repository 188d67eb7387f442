"""Raw frames of a camera: files, and how the frames form levels of light with their darks."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.io.frames.formats import frames_in
    from chromanoise.io.frames.frame import FrameLevel, FrameSet, RawFrame
    from chromanoise.io.frames.grouping import read_frame_set

__all__ = ["FrameLevel", "FrameSet", "RawFrame", "frames_in", "read_frame_set"]
__getattr__, __dir__ = lazy_names(__name__, Frame="RawFrame")
