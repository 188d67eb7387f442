"""Applications: users of the library, whose names may change in any release.

`camera` measures noise from frames, `design` searches sensors, `training` makes noisy training
data, `denoising_benchmark` compares denoisers, `paper` reproduces the paper.
"""

from typing import TYPE_CHECKING

from chromanoise.base import lazy_names

if TYPE_CHECKING:
    from chromanoise.apps import (
        camera as camera,
        denoising_benchmark as denoising_benchmark,
        design as design,
        paper as paper,
        training as training,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
