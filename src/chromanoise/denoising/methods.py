"""The denoising methods by name."""

from collections.abc import Mapping

from chromanoise.denoising.method import DenoisingMethod

DENOISING: Mapping[str, DenoisingMethod] = {}
"""What ``simulate --denoise`` takes."""
