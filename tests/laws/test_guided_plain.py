"""The guided denoising in plain numpy is the compiled one, but for rounding."""

import numpy as np
import pytest

from chromanoise.imaging.denoising import guided, guided_plain
from noisy_planes import planes_with

FLOOR_E2 = np.array([4.0, 30.0, 0.0, 9.0])


def planes(shape, seed=3):
    """Edges, a gradient and noise in some planes, of odd and even sizes."""
    random = np.random.default_rng(seed)
    h, w, p = shape
    across = np.linspace(20.0, 400.0, w)[None, :, None] * np.linspace(0.4, 1.0, p)
    clean = np.where((np.arange(h) > h // 2)[:, None, None], across, 0.3 * across[:, ::-1])
    sd = np.sqrt(FLOOR_E2[:p] + clean)
    values = clean + sd * random.normal(size=shape)
    return planes_with(values, floor_e2=FLOOR_E2[:p], slope_e=1.0)


@pytest.mark.parametrize("shape", [(64, 96, 3), (45, 71, 4), (33, 40, 1), (16, 17, 2)])
def test_plain_and_compiled_denoising_differ_by_rounding_alone(monkeypatch, shape):
    given = planes(shape)
    compiled = guided.denoise(given)
    monkeypatch.setattr(guided, "_kernels", lambda: guided_plain)
    plain = guided.denoise(given)
    noise = np.sqrt(FLOOR_E2[: shape[2]] + np.maximum(given.values_e, 1))
    assert np.abs((plain - compiled) / noise).max() < 2e-3
    assert np.abs((given.values_e - compiled) / noise).mean() > 0.3  # it does something
