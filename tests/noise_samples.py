"""Noise of a pixel of which a test gives the numbers that matter."""

from chromanoise.noise import NoiseSources
from chromanoise.sensor import PIXEL, Pixel


def noise_of(*, readings=1, **numbers):
    """Sources with these numbers of a pixel, or fields of `NoiseSources`."""
    own = {name: numbers.pop(name) for name in tuple(numbers) if name in PIXEL}
    sums = {"summed_pixels": readings, "summed_readings": readings}
    pixel = Pixel(**{"pitch_um": 5.0, "full_well_e": 1e15, "read_noise_e": 0.0} | own | sums)
    return NoiseSources(pixel=pixel, readings=readings, **numbers)
