"""How fast planes are denoised: against the bilateral filter of OpenCV and scikit-image's NL-means.

    python benchmarks/denoising.py

denoises 1 megapixel of 4 planes on 2 threads and prints the least seconds per megapixel, for which
1 s is the target, the least processor seconds, and the median over the rounds of the ratio of
processor times. The bilateral filter has 11 x 11 pixels; NL-means patches of 5 x 5 in 11 x 11
places, in its fast mode. Both take plane after plane. Needs the extra ``denoise``.
"""

import time
from functools import partial

import cv2
import numpy as np
from races import raced, ratio
from skimage.restoration import denoise_nl_means

from chromanoise.base.rng import stream
from chromanoise.imaging.denoising import NoisyPlanes, denoised_planes
from chromanoise.imaging.denoising.guided import GUIDED
from chromanoise.imaging.shared_rows import Work
from chromanoise.sensor import VarianceLaw

SIDE, COUNT, THREADS, ROUNDS = 1024, 4, 2, 3
READ_NOISE_E = 10.0


def noisy_planes() -> NoisyPlanes:
    """Blocks of random materials, with shot and read noise."""
    rng = stream(0)
    blocks = rng.uniform(10.0, 2000.0, (SIDE // 16, SIDE // 16, COUNT))
    mean_e = blocks.repeat(16, axis=0).repeat(16, axis=1)
    noisy_e = rng.poisson(mean_e) + READ_NOISE_E * rng.normal(size=mean_e.shape)
    return NoisyPlanes(
        values_e=noisy_e.astype(np.float32),
        law=VarianceLaw(floor_e2=READ_NOISE_E**2, slope_e=1.0),
        prior_e2=np.cov(blocks.reshape(-1, COUNT).T),
        prior_mean_e=blocks.mean(axis=(0, 1)),
        names=("R", "G", "B", "W"),
    )


def main() -> None:
    """Print one row per method."""
    cv2.setNumThreads(THREADS)
    planes = noisy_planes()
    each = [np.ascontiguousarray(planes.values_e[..., i]) for i in range(COUNT)]
    unit = planes.noise_unit_e
    contenders = {
        "guided": lambda: denoised_planes(planes, GUIDED, work=Work(threads=THREADS)),
        "bilateral": lambda: [
            cv2.bilateralFilter(x, 11, 2 * s, 3.0) for x, s in zip(each, unit, strict=True)
        ],
        "nl-means": lambda: [
            denoise_nl_means(x, 5, 5, h=s, sigma=s, fast_mode=True)
            for x, s in zip(each, unit, strict=True)
        ],
    }
    race = partial(raced, contenders, rounds=ROUNDS)
    wall, processor = race(), race(clock=time.process_time)
    megapixels = SIDE**2 / 1e6
    print("| method | s / megapixel of 4 planes | processor s | guided's over its processor s |")
    print("|---|---|---|---|")
    for name in contenders:
        found = ratio(processor, "guided", name)
        range_ = f"{found.middle:.2f} ({found.lowest:.2f} to {found.highest:.2f})"
        least = " | ".join(f"{min(times[name]) / megapixels:.2f}" for times in (wall, processor))
        print(f"| {name} | {least} | {range_} |")


if __name__ == "__main__":
    main()
