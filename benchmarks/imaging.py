"""How fast cubes become pictures, as ratios in one run; ``--write`` makes docs/performance.md.

Needs some 6 GB of memory, 17 GB of disk and a few minutes; ``--small`` is a rehearsal whose numbers
mean nothing. ``OPENBLAS_NUM_THREADS=1`` must be set, as `make bench` does: numpy's tiles are on
threads already.
"""

import argparse
import os
import subprocess
from pathlib import Path
from statistics import median

from cluster import cluster_race
from document import TARGET, document
from files import NoRoomError, envi_file
from noise import noise_race, ns_per_sample
from out_of_core import file_race
from races import Ratio, Times, raced, ratio
from small_mosaic import peak_of_cube, small_cube, small_paths
from startup import HEADING
from table import Row, Skipped, plain_table
from whole_pictures import gigabytes_per_second, picture_rows, pictures_race

from chromanoise.base.errors import InputError

THREADS = 2
_MOST_BYTES = 1e9
Rows = list[Row | Skipped]


def noise_rows() -> Rows:
    """Noise alone, on one thread."""
    rows: Rows = []
    for highest_e, asked in ((1e4, 5.0), (12.0, 3.5)):
        times = noise_race(highest_e)
        name = f"noise alone, 1 thread, means 0 .. {highest_e:g} e-: against numpy PCG64"
        rate = f"{ns_per_sample(times, 'here'):.1f} ns/sample"
        rows.append(Row(name, asked, ratio(times, "numpy", "here"), rate))
    return rows


def small_rows(rounds: int) -> Rows:
    """A small cube to a mosaic, and the memory that it takes."""
    paths, missing = small_paths(small_cube())
    times = raced(paths, rounds=rounds)
    name = "512 x 512 x 66 to a 12-bit RGBW mosaic: against"
    own = f"{median(times['here, all cores']) * 1e3:.1f} ms"
    rows: Rows = [
        Row(f"{name} 15 lines of numpy", 6.0, ratio(times, "numpy", "here, all cores"), own)
    ]
    for peer in ("numpy", "prysm", "getframes"):
        if peer in times:
            label = f"{name} {'the same numpy, both on 1 thread' if peer == 'numpy' else peer}"
            who = "here" if peer == "numpy" else "here, all cores"
            rate = f"{median(times[who]) * 1e3:.1f} ms"
            rows.append(Row(label, None, ratio(times, peer, who), rate))
    rows += [Skipped(name, reason) for reason in missing]
    try:
        peak = peak_of_cube()
    except (OSError, subprocess.CalledProcessError) as reason:
        return [*rows, Skipped("its peak memory", str(reason))]
    share = Ratio(peak, peak, peak)
    return [*rows, Row("its peak memory, of the cube", 1.3, share, "-", at_most=True)]


def _file_rows(path: Path, *, cold: bool, rounds: int) -> Rows:
    times, held = file_race(path, cold=cold, rounds=rounds, threads=THREADS)
    size = path.stat().st_size
    state = "cold" if cold else "warm"
    rate = f"{size / median(times['here']) / 1e9:.2f} GB/s"
    name = f"{size / 1e9:.1f} GB ENVI file to a mosaic, {state}"
    part = Ratio(held / _MOST_BYTES, held / _MOST_BYTES, held / _MOST_BYTES)
    return [
        Row(
            f"{name}: of plain reading",
            0.8 if cold else None,
            ratio(times, "plain", "here"),
            rate,
            "%",
        ),
        Row(f"{name}: memory, of 1 GB", 1.0, part, f"{held / 1e6:.0f} MB", "%", at_most=True),
    ]


def file_rows(height: int, width: int, *, rounds: int, folder: str | None) -> Rows:
    """A file that is larger than the memory it may take."""
    try:
        with envi_file(height, width, folder) as path:
            return [
                *_file_rows(path, cold=False, rounds=rounds),
                *_file_rows(path, cold=True, rounds=rounds),
            ]
    except NoRoomError as reason:
        return [Skipped("a file larger than memory", str(reason))]


def cluster_rows(height: int, width: int, *, rounds: int, folder: str | None) -> Rows:
    """Processes of dask against threads."""
    name = f"dask, {THREADS} local workers: time of {THREADS} own threads, identical bits"
    try:
        with envi_file(height, width, folder) as path:
            times = cluster_race(path, workers=THREADS, rounds=rounds)
            rate = f"{path.stat().st_size / median(times['dask']) / 1e9:.2f} GB/s"
    except (InputError, NoRoomError) as reason:
        return [Skipped(name, str(reason))]
    return [Row(name, 1.3, ratio(times, "dask", "threads"), rate, at_most=True)]


def _rate_text(times: Times, pixels: int) -> str:
    by_pixel, by_band = (gigabytes_per_second(times, order, pixels) for order in ("BIP", "BSQ"))
    return f"It read the cubes at {by_pixel:.1f} (BIP) and {by_band:.1f} GB/s (BSQ)."


def main() -> None:
    """Measure, print, and write if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="make docs/performance.md")
    parser.add_argument("--small", action="store_true", help="a rehearsal, some seconds")
    parser.add_argument("--folder", help="where files of 8 GB may lie for a minute")
    asked = parser.parse_args()
    height = 64 if asked.small else 2048
    rounds, width = 5, 2048
    at_start = os.getloadavg()[0]
    times, missing = pictures_race(height, width, rounds=rounds, threads=THREADS)
    reading = _rate_text(times, height * width)
    print(reading)
    tall = height * 15 // 4
    rows: Rows = []
    for part in (
        lambda: picture_rows(times, missing, height * width),
        noise_rows,
        lambda: small_rows(9),
        lambda: cluster_rows(height, width, rounds=rounds, folder=asked.folder),
        lambda: file_rows(tall, width, rounds=rounds, folder=asked.folder),
    ):
        new = part()
        print(plain_table(new), flush=True)
        rows += new
    if asked.write:
        _, heading, others = TARGET.read_text(encoding="utf-8").partition(HEADING)
        page = document(rows, reading, (at_start, os.getloadavg()[0]))
        whole = f"{page.rstrip()}\n\n{heading}{others}" if heading else page
        TARGET.write_text(whole, encoding="utf-8")
        print(f"written: {TARGET}")


if __name__ == "__main__":
    main()
