"""Time and memory of a characterization, against those of reading the same frames once.

    python benchmarks/characterize.py [--write]

100 frames of 12 megapixels: 25 levels of two flats and two darks, as NPY and as DNG. Each row is a
ratio within one run: the whole characterization over a loop that only reads the frames.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SHAPE = (3000, 4000)
LEVELS = 25
_READ = """
import sys
from chromanoise.io.frames import read_frame_set
for level in read_frame_set([sys.argv[1]]).levels:
    for frame in (*level.flats, *level.darks):
        frame.codes().copy()  # also where the file is mapped into memory
"""
_CHARACTERIZE = "import sys, chromanoise as cn; cn.characterize(sys.argv[1])"


def frames_in(folder: Path, ending: str) -> None:
    """Frames of a camera with K = 0.25 DN/e-, black 64 and a full well of 15000 e-."""
    rng = np.random.default_rng(1)
    unit = rng.standard_normal(SHAPE, np.float32)
    lines = ['mosaic = "RG/GB"', "bits = 12"]
    for i in range(LEVELS):
        electrons = 15_000.0 * (i + 1) / (LEVELS - 2)
        names: dict[str, list[str]] = {"flats": [], "darks": []}
        for kind, mean in (("flats", min(electrons, 15_000.0)), ("darks", 0.0)):
            for k in range(2):
                shot = 0.0 if mean == 15_000.0 else mean
                noise = np.roll(unit, 7919 * (4 * i + 2 * k + (kind == "darks")) + 1, axis=1)
                codes = 64 + 0.25 * (mean + np.sqrt(shot + 9.0) * noise)
                name = f"{kind}_{i}_{k}.{ending}"
                _write(folder / name, codes.round().clip(0, 4095).astype(np.uint16))
                names[kind].append(name)
        lines += ["[[levels]]", *(f"{key} = {value!r}" for key, value in names.items())]
        lines += [f"time_ms = {4.0 * (i + 1)}"]
    (folder / "capture.toml").write_text("\n".join(lines))


def _write(path: Path, codes: np.ndarray) -> None:
    if path.suffix == ".npy":
        np.save(path, codes)
    else:
        import tifffile

        tifffile.imwrite(path, codes, compression="zlib", photometric="minisblack")


def measured(code: str, folder: Path) -> tuple[float, float]:
    """Seconds and megabytes of a Python program on the folder."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", code, str(folder)], check=True)
    seconds = time.perf_counter() - start
    return seconds, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3


def main() -> None:
    """Print a table row per format."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    print("| frames | of reading them | seconds | peak memory |")
    print("|---|---|---|---|")
    for ending in ("npy", "tif"):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            frames_in(folder, ending)
            measured(_CHARACTERIZE, folder)  # kernels compiled, files in memory
            ratios, seconds = [], []
            for _ in range(3):
                reading, _ = measured(_READ, folder)
                whole, megabytes = measured(_CHARACTERIZE, folder)
                ratios.append(whole / reading)
                seconds.append(whole)
            print(
                f"| 100 of 12 Mpx, {ending} | {np.median(ratios):.2f} x ({min(ratios):.2f} .. "
                f"{max(ratios):.2f}) | {np.median(seconds):.1f} s | {megabytes:.0f} MB |"
            )


if __name__ == "__main__":
    main()
