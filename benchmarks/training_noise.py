"""How fast training data is made noisy: against ``torch.poisson`` plus ``torch.randn``.

Both run on the same number of threads; processor time is compared. PyTorch adds Poisson electrons
and normal read noise; the sampler here also rounds, clips, and gives the variance of each value,
for a Bayer mosaic of 1500 x 2000 pixels. Rounds take turns; the ratio is the median over the
rounds. With a read noise of 1 e-, electrons are drawn by a table below 17 e-. Needs the extra
``torch``.
"""

import time
from itertools import product
from statistics import median

import numpy as np
import torch
from races import Times, raced, ratio

from chromanoise.apps.training.training_noise import sampler
from chromanoise.sensor import CameraNoise, bayer

SHAPE = (1500, 2000)
READ_NOISES_E = (3.0, 1.0)
ROUNDS = 5
HIGHEST_MEANS_E = (10_000.0, 1000.0, 100.0, 20.0)
SETTINGS = {
    "shot, read, rounding, clipping, variance": {},
    "and PRNU, DSNU, row noise": {"prnu": 0.01, "dsnu_e": 1.0, "row_noise_e": 0.5},
    "and Tukey lambda read noise": {"tail_lambda": (-0.1,)},
}


def camera(read_noise_e: float, **others: object) -> CameraNoise:
    """A camera with a Bayer mosaic."""
    return CameraNoise(
        names=("R", "G", "B"),
        mosaic=bayer(),
        gain_dn_per_e=np.array([1.0, 1.1, 0.9]),
        read_noise_e=np.full(3, read_noise_e),
        black_level_dn=np.full(3, 512.0),
        top_code_dn=16383.0,
        **others,
    )


def training_race(
    highest_e: float, read_noise_e: float, settings: dict[str, object], *, threads: int
) -> Times:
    """Times of PyTorch and of chromanoise for means from 0 to ``highest_e``."""
    torch.set_num_threads(threads)
    clean = np.random.default_rng(0).uniform(0, highest_e, SHAPE).astype(np.float32)
    tensor = torch.from_numpy(clean)
    add_noise = sampler(camera(read_noise_e, **settings), threads=threads)
    return raced(
        {
            "torch": lambda: torch.poisson(tensor) + read_noise_e * torch.randn(SHAPE),
            "here": lambda: add_noise(clean, unit="electron"),
        },
        rounds=ROUNDS,
        clock=time.process_time,
    )


def _line(name: str, highest_e: float, read_noise_e: float, threads: int) -> str:
    times = training_race(highest_e, read_noise_e, SETTINGS[name], threads=threads)
    faster, samples = ratio(times, "torch", "here"), float(np.prod(SHAPE))
    theirs, own = (median(times[who]) * 1e9 / samples for who in ("torch", "here"))
    return (
        f"{name}, 0 .. {highest_e:g} e-, read noise {read_noise_e:g} e-, {threads} thread(s): "
        f"{faster.middle:.1f} x "
        f"({faster.lowest:.1f} .. {faster.highest:.1f}); torch {theirs:.0f}, here {own:.1f} ns "
        "per sample"
    )


if __name__ == "__main__":
    for count in (1, 2):
        for setting in SETTINGS:
            for highest, read_e in product(HIGHEST_MEANS_E, READ_NOISES_E):
                print(_line(setting, highest, read_e, count), flush=True)
