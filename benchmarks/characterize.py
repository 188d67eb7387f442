"""Time and memory of a characterization, against those of reading the same frames once.

    python benchmarks/characterize.py

100 frames of 12 megapixels in NPY and 24 in compressed TIFF, all in the page cache: levels of two
flats and two darks. Reading is a loop over all frames, each of which is decoded into memory on one
thread. Both run in new processes, which take turns; a ratio is taken within each round. One row
compares whole processes; the other leaves out the start: Python, imports and compiled kernels.
"""

import argparse
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

SHAPE = (3000, 4000)
ROUNDS = 5
_TIMED = """
import sys, time
{imports}
def work():
    {work}
for _ in range({times}):
    start = time.perf_counter()
    work()
print(time.perf_counter() - start)
"""
_READ = (
    "from chromanoise.io.frames import read_frame_set",
    "for one in read_frame_set([sys.argv[1]]).levels: [frame.codes().shape for frame in "
    "(*one.flats, *one.darks)]",
)
_CHARACTERIZE = ("import chromanoise as cn", "cn.characterize(sys.argv[1])")


def frames_in(folder: Path, ending: str, levels: int) -> None:
    """Frames of a camera with K = 0.25 DN/e-, black 64 and a full well of 15000 e-."""
    unit = np.random.default_rng(1).standard_normal(SHAPE, np.float32)
    lines = ['mosaic = "RG/GB"', "bits = 12"]
    for i in range(levels):
        electrons = min(15_000.0 * (i + 1) / (levels - 1.5), 15_000.0)
        shot = 0.0 if electrons == 15_000.0 else electrons
        names = {
            kind: [f"{kind}_{i}_{k}.{ending}" for k in range(2)] for kind in ("flats", "darks")
        }
        for k in range(2):
            noise = np.roll(unit, 7919 * (2 * i + k) + 1, axis=1)
            _write(folder / names["flats"][k], electrons, shot, noise)
            dark = folder / names["darks"][k]
            if i == 0:
                _write(dark, 0.0, 0.0, np.roll(noise, 1234, axis=0))
            else:
                shutil.copyfile(folder / f"darks_0_{k}.{ending}", dark)
        lines += ["[[levels]]", *(f"{key} = {value!r}" for key, value in names.items())]
        lines += [f"time_ms = {4.0 * (i + 1)}"]
    (folder / "capture.toml").write_text("\n".join(lines))


def _write(path: Path, mean: float, shot: float, noise: np.ndarray) -> None:
    codes = noise * np.float32(0.25 * np.sqrt(shot + 9.0)) + np.float32(64 + 0.25 * mean)
    stored = np.clip(np.rint(codes, out=codes), 0, 4095, out=codes).astype(np.uint16)
    if path.suffix == ".npy":
        np.save(path, stored)
    else:
        import tifffile

        tifffile.imwrite(path, stored, compression="zlib", photometric="minisblack")


@dataclass(frozen=True, slots=True)
class Cost:
    """Of a program: seconds of the whole process, processor time, seconds of the work alone."""

    whole_s: float
    processor_s: float
    work_s: float


def measured(program: tuple[str, str], folder: Path, *, times: int = 1) -> Cost:
    """What a program on the folder takes; the work alone is that of the last of ``times``."""
    code = _TIMED.format(imports=program[0], work=program[1], times=times)
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    run = [sys.executable, "-c", code, str(folder)]
    printed = subprocess.run(run, check=True, capture_output=True, text=True).stdout
    whole, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Cost(whole, processor, float(printed))


def _line(name: str, above: list[float], below: list[float]) -> str:
    ratios = [one / other for one, other in zip(above, below, strict=True)]
    return (
        f"| {name} | {median(ratios):.2f} x ({min(ratios):.2f} .. {max(ratios):.2f}) | "
        f"{median(above):.2f} s | {median(below):.2f} s |"
    )


def main() -> None:
    """Print the rows of each format."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    print("| frames | of reading them | characterization | reading |")
    print("|---|---|---|---|")
    for ending, levels in (("npy", 25), ("tif", 6)):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            frames_in(folder, ending, levels)
            measured(_CHARACTERIZE, folder)  # kernels compiled, files in memory
            rounds = [
                [measured(program, folder, times=times) for program in (_CHARACTERIZE, _READ)]
                for _ in range(ROUNDS)
                for times in (1, 2)
            ]
            once, twice = rounds[::2], rounds[1::2]
            label = f"{4 * levels} of 12 Mpx, {ending}"
            rows = {
                "whole process": [[c.whole_s for c in one] for one in once],
                "whole process, processor time": [[c.processor_s for c in one] for one in once],
                "without the start": [[c.work_s for c in one] for one in twice],
            }
            for which, values in rows.items():
                above, below = (list(column) for column in zip(*values, strict=True))
                print(_line(f"{label}: {which}", above, below), flush=True)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3
    print(f"\nPeak memory of a process: {peak:.0f} MB")


if __name__ == "__main__":
    main()
