"""A camera's noise from its own raw frames."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.characterization.virtual_camera import PlaneTruth, VirtualCamera
    from chromanoise.characterization.virtual_frames import photon_transfer_frames

__all__ = ["PlaneTruth", "VirtualCamera", "photon_transfer_frames"]
__getattr__, __dir__ = lazy_names(__name__)
