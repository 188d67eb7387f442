"""Laws of the denoising method `aggregate`: what it averages, strips, planes without noise."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.imaging import Work
from chromanoise.imaging.denoising import DENOISING, denoised_planes
from chromanoise.imaging.denoising.guided import USUAL, WIDE, guided_estimate
from chromanoise.imaging.denoising.patches import AGGREGATE, LEAST_SNR
from chromanoise.sensor import VarianceLaw
from noisy_planes import planes_of

BRIGHT, DIM = 400.0, 1.0


def blocks(height, width, light, *, seed=0):
    """Noisy blocks of random light in two planes. [e-]"""
    rng = stream(77, seed)
    shape = (-(-height // 8), -(-width // 8), 2)
    mean = light * rng.uniform(0.2, 2.0, shape).repeat(8, axis=0).repeat(8, axis=1)
    mean = mean[:height, :width]
    return planes_of(rng.poisson(mean) + 10.0 * rng.normal(size=mean.shape), light=light)


@pytest.mark.parametrize("light", [BRIGHT, DIM])
def test_the_light_chooses_what_is_averaged(light):
    planes = blocks(40, 48, light)
    is_bright = planes.components()[1][0] > LEAST_SNR
    assert is_bright == (light == BRIGHT)
    guided = DENOISING["guided"].denoise(planes)
    other = DENOISING["patches"].denoise(planes) if is_bright else guided_estimate(planes, WIDE)
    found = AGGREGATE.denoise(planes)
    assert not np.array_equal(found, guided)
    low, high = np.minimum(guided, other), np.maximum(guided, other)
    slack = 1e-5 * np.abs(found) + 1e-6
    assert ((found >= low - slack) & (found <= high + slack)).all()


@pytest.mark.parametrize("light", [BRIGHT, DIM])
def test_strips_have_the_bits_of_the_whole_picture(light):
    planes = blocks(AGGREGATE.reach_px + 2 * AGGREGATE.grid_px + 5, 9, light)
    strips = denoised_planes(planes, AGGREGATE, work=Work(threads=2, tile_rows=1))
    np.testing.assert_array_equal(strips, AGGREGATE.denoise(planes))


def test_planes_without_noise_return_unchanged():
    planes = blocks(24, 24, BRIGHT)
    some = replace(
        planes,
        law=VarianceLaw(floor_e2=np.array([0.0, 100.0]), slope_e=np.array([0.0, 1.0])),
    )
    found = AGGREGATE.denoise(some)
    np.testing.assert_array_equal(found[..., 0], some.values_e[..., 0])
    np.testing.assert_array_equal(found, guided_estimate(some, USUAL))
