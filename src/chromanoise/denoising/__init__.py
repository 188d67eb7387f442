"""Denoising with the known noise of the exposure: planes, methods, noise of the result."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.denoising.method import DenoisingMethod
    from chromanoise.denoising.planes import NoisyPlanes, packed, unpacked
    from chromanoise.denoising.strips import denoised_planes

__all__ = [
    "DenoisingMethod",
    "NoisyPlanes",
    "denoised_planes",
    "packed",
    "unpacked",
]
__getattr__, __dir__ = lazy_names(__name__)
