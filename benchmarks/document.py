"""docs/performance.md: the table, on what it was measured, and what it means."""

import datetime
import os
import platform
from importlib.metadata import version
from pathlib import Path

from table import Row, Skipped, markdown_table

TARGET = Path(__file__).parents[1] / "docs" / "performance.md"

_HOW = """\
## How it was measured

* The programs of a row ran alternately, each round starting with another one. A ratio is taken
  within each round; the table has its median and range over the rounds. Machines are shared and
  clock rates change, so the ratios are reproducible, but the times are not.
* *Reading* is a compiled loop that only sums the cube, on the same number of threads. The cubes
  have 2.2 GB, more than any cache: float32, 131 bands from 400 to 1050 nm, four channels.
* The output arrays had been written once before. A public call allocates new arrays, whose first
  write takes additional time: the rows *into fresh arrays*.
* The file rows may exceed 100 %, because plain reading uses one thread.
* *Tiled numpy*: 32 rows at a time on the same number of threads, BLAS for the sums, one generator
  per tile, a table for sRGB (`benchmarks/plain_numpy.py`). *C kernel*: the same sums, random words,
  quantile functions and table, `gcc -O3 -march=native`; it may fuse multiply and add, so its last
  bits differ between machines (`benchmarks/kernel.c`).
* prysm and getframes support neither mosaics nor cubes; numpy computed their electrons, and that
  time is included.
* A new process reads the file each time. *Cold*: the page cache was dropped before. *Warm*: it was
  kept. Plain reading: 8 MB at a time into one buffer, on one thread; of a warm file it is a copy,
  at 5 to 27 GB/s on different machines. Memory: peak of the process.
* `simulate` and `run` keep a picture above 32 MB in a file without a name in the output folder, if
  the disk has space for four times its size. A sparse ENVI cube of 20 GB (6,180 x 6,180 x 131,
  float32, 2 threads) then took 0.36 (BIP) and 0.27 GB (BSQ) of private memory instead of 1.21 and
  1.11 GB. The encoder of PNG takes 4 bytes per pixel of this; EXR and denoising also grow.
* dask: two processes of one thread each against two threads, without the start of the cluster. The
  pictures were compared bit by bit.
"""


def document(rows: list[Row | Skipped], reading: str, load: tuple[float, float]) -> str:
    """The whole page."""
    short = [row for row in rows if isinstance(row, Row) and not row.reached]
    missed = "\n".join(["Targets missed (bold):", "", *(f"* {row.path}" for row in short)])
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba"))
    return f"""# Performance of the imaging engine

Made by `make bench` on {datetime.datetime.now(datetime.UTC):%Y-%m-%d}: {_processor()}, \
{os.cpu_count()} cores, Python {platform.python_version()}, {versions}. {reading} Load average \
{load[0]:.1f} at start, {load[1]:.1f} at end; above {os.cpu_count()} (the core count), other \
programs slowed the run.

{markdown_table(rows)}

{missed if short else "No target was missed."}
{_disturbed(max(load))}
{_HOW}"""


def _disturbed(load: float) -> str:
    """What a busy machine means for the verdicts."""
    if load <= 1.5 * (os.cpu_count() or 1):
        return ""
    return """
The machine was busy with other work, and the ranges are wide: do not conclude from this run whether
a target is reached. Run it again on an idle machine.
"""


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.machine()
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0]} ({platform.machine()})" if names else platform.machine()
