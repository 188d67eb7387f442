"""Saturation of a photon transfer: the level above which the variance falls."""

import numpy as np

from chromanoise._check import Array
from chromanoise.sensor.photon_transfer_regression import variance_error2
from chromanoise.sensor.photon_transfer_table import PhotonTransfer

_FALLEN_Z = 5.0  # a fall by more standard errors of the difference is significant
_FALLEN = 0.05  # a fall by a larger share is significant if samples are unknown
_CLIPPED = 0.5  # a fall by a larger share is significant for any number of samples


def saturated_row(table: PhotonTransfer) -> int | None:
    """Index of the lit row of largest variance; ``None`` if the variance does not fall above it.

    Rows are scanned from the brightest down to the first maximum that exceeds the next two rows,
    as in the reference code of EMVA 1288. A difference counts only if it is larger than sampling
    explains; otherwise the scatter of a table that ends early would be taken for saturation.
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
