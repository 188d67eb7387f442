"""Planes of electrons with a noise, and with the prior of a camera."""

import numpy as np

from chromanoise.imaging.denoising import NoisyPlanes
from chromanoise.sensor import VarianceLaw


def planes_with(values_e, *, floor_e2=0.0, slope_e=0.0, prnu=0.0, prior_e2=None, prior_mean_e=None):
    """Planes with this noise; the prior is the identity and a mean of 1 unless given."""
    p = np.shape(values_e)[-1]
    return NoisyPlanes(
        values_e=np.asarray(values_e, np.float32),
        law=VarianceLaw(
            floor_e2=np.broadcast_to(np.float64(floor_e2), p), slope_e=slope_e, square=prnu**2
        ),
        prior_e2=np.eye(p) if prior_e2 is None else prior_e2,
        prior_mean_e=np.ones(p) if prior_mean_e is None else prior_mean_e,
        names=tuple("RGBW"[:p]) if p <= 4 else tuple(f"plane {i}" for i in range(p)),
    )


def planes_of(values_e, *, light=100.0, likeness=0.9):
    """Planes of different strength with likeness ``likeness``, over read noise of 10 e-."""
    p = values_e.shape[-1]
    strength = light * (1 + np.arange(p)) / p
    alike = likeness + (1 - likeness) * np.eye(p)
    prior_e2 = 0.2 * alike * np.outer(strength, strength)
    noise = {"floor_e2": 100.0, "slope_e": 1.0, "prnu": 0.01}
    return planes_with(values_e, **noise, prior_e2=prior_e2, prior_mean_e=strength)
