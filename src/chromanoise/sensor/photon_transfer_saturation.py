"""Where the variance of a photon transfer falls: saturation."""

import numpy as np

from chromanoise._check import Array
from chromanoise.sensor.photon_transfer_regression import variance_error2
from chromanoise.sensor.photon_transfer_table import PhotonTransfer

_FALLEN_Z = 5.0  # standard errors of the difference of two variances: a fall beyond is real
_FALLEN = 0.05  # of a variance: a fall beyond is real where samples are not known
_CLIPPED = 0.5  # of a variance: a fall beyond is real however few the samples are


def saturated_row(table: PhotonTransfer) -> int | None:
    """Which of the lit rows has the largest variance; ``None`` where brighter rows do not fall.

    Scanned from the brightest row down to the first maximum that two rows in succession stay
    below, as the reference code of EMVA 1288 does. A difference counts where it is larger than
    sampling explains, or the scatter of a table that ends early would be taken for saturation.
    """
    lit = ~table.dark
    light = (table.mean_dn if table.photons is None else table.photons)[lit]
    order = np.argsort(light, kind="stable")
    variance = table.variance_dn2[lit][order]
    samples = None if table.samples is None else table.samples[lit][order]
    best, low = variance.size - 1, _fallen(variance, samples, int(np.argmax(variance)))
    for i in range(variance.size - 1, -1, -1):
        if variance[i] >= variance[best]:
            best = i
        elif variance[max(i - 1, 0)] < variance[best] and not low[best]:
            break
    return int(order[best]) if _fallen(variance, samples, best)[best + 1 :].any() else None


def _fallen(variance: Array, samples: Array | None, top: int) -> Array:
    """Which variances lie below that of the row ``top`` by more than sampling explains."""
    if samples is None:
        return np.asarray(variance[top] - variance > _FALLEN * variance[top])
    error2 = variance_error2(variance, samples)
    scatter = _FALLEN_Z * np.sqrt(error2 + error2[top])
    return np.asarray(variance[top] - variance > np.minimum(scatter, _CLIPPED * variance[top]))
