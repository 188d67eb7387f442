"""Noise of a camera for training data, and pictures turned back into raw data."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.apps.training.training_noise import NoiseSampler, NoisySample, sampler
    from chromanoise.apps.training.unprocessing import (
        AddCameraNoise,
        NoisyDataset,
        Rendering,
        draw_rendering,
        linear_from_srgb,
        mosaicked,
        process,
        unprocess,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
