"""How fast planes are denoised, beside OpenCV's bilateral filter, scikit-image's NL-means and BM3D.

    python benchmarks/denoising.py

denoises 1 megapixel of 4 planes on 2 threads and prints the minimum time per megapixel, the minimum
processor time, the target of each method of chromanoise, and the median over the rounds of the
ratio of processor times. The bilateral filter has 11 x 11 pixels; NL-means patches of 5 x 5 in
11 x 11 places, in its fast mode. These and BM3D take plane after plane. BM3D (the package ``bm3d``,
its default profile) takes minutes per megapixel: its times are those of 256 x 256 pixels of one
plane, extrapolated. Needs the extras ``compiled`` and ``denoise``.
"""

import time
from functools import partial

import bm3d
import cv2
import numpy as np
from races import raced, ratio
from skimage.restoration import denoise_nl_means

from chromanoise.base.rng import stream
from chromanoise.imaging.denoising import NoisyPlanes, denoised_planes
from chromanoise.imaging.denoising.guided import GUIDED
from chromanoise.imaging.denoising.patches import AGGREGATE, PATCHES
from chromanoise.imaging.shared_rows import Work
from chromanoise.sensor import VarianceLaw

SIDE, COUNT, THREADS, ROUNDS = 1024, 4, 2, 3
READ_NOISE_E = 10.0
BM3D_SIDE = 256  # of one plane
TARGETS = {"guided": "1 s", "patches": "6 processor s", "aggregate": "6 processor s"}


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
    crop = each[0][:BM3D_SIDE, :BM3D_SIDE]
    work = Work(threads=THREADS)
    contenders = {
        method.name: partial(denoised_planes, planes, method, work=work)
        for method in (GUIDED, PATCHES, AGGREGATE)
    } | {
        "bilateral": lambda: [
            cv2.bilateralFilter(x, 11, 2 * s, 3.0) for x, s in zip(each, unit, strict=True)
        ],
        "nl-means": lambda: [
            denoise_nl_means(x, 5, 5, h=s, sigma=s, fast_mode=True)
            for x, s in zip(each, unit, strict=True)
        ],
        "bm3d": lambda: bm3d.bm3d(crop, unit[0]),
    }
    race = partial(raced, contenders, rounds=ROUNDS)
    wall, processor = (dict(race(clock=clock)) for clock in (time.perf_counter, time.process_time))
    for times in (wall, processor):
        times["bm3d"] = [
            COUNT * planes.values_e[..., 0].size / crop.size * t for t in times["bm3d"]
        ]
    megapixels = SIDE**2 / 1e6
    print("| method | s / megapixel of 4 planes | processor s | target | guided over processor s |")
    print("|---|---|---|---|---|")
    for name in contenders:
        found = ratio(processor, "guided", name)
        range_ = f"{found.middle:.3f} ({found.lowest:.3f} to {found.highest:.3f})"
        least = " | ".join(f"{min(times[name]) / megapixels:.2f}" for times in (wall, processor))
        print(f"| {name} | {least} | {TARGETS.get(name, '')} | {range_} |")


if __name__ == "__main__":
    main()
