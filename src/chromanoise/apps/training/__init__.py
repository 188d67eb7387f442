"""Noise of a camera for training data, and pictures turned back into raw data."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.apps.training.training_noise import (
        NoiseSampler as NoiseSampler,
        NoisySample as NoisySample,
        sampler as sampler,
    )
    from chromanoise.apps.training.unprocessing import (
        AddCameraNoise as AddCameraNoise,
        NoisyDataset as NoisyDataset,
        Rendering as Rendering,
        draw_rendering as draw_rendering,
        linear_from_srgb as linear_from_srgb,
        mosaicked as mosaicked,
        process as process,
        unprocess as unprocess,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
