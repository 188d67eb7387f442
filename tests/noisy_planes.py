"""Planes of electrons with the noise and the prior of a camera."""

import numpy as np

from chromanoise.imaging.denoising import NoisyPlanes
from chromanoise.sensor import VarianceLaw


def planes_of(values_e, *, light=100.0, likeness=0.9):
    """Planes of different strength with likeness ``likeness``, over read noise of 10 e-."""
    p = values_e.shape[-1]
    strength = light * (1 + np.arange(p)) / p
    alike = likeness + (1 - likeness) * np.eye(p)
    return NoisyPlanes(
        values_e=values_e.astype(np.float32),
        law=VarianceLaw(floor_e2=100.0, slope_e=1.0, square=0.01**2),
        prior_e2=0.2 * alike * np.outer(strength, strength),
        prior_mean_e=strength,
        names=tuple(f"plane {i}" for i in range(p)),
    )
