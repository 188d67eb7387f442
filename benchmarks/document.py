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

* All contenders of a row took turns in one run, each round starting with another one; a ratio is
  taken within each round, and its median and range over the rounds are told. Machines are shared
  and clocks change: ratios hold, times do not.
* *Reading* is a compiled loop that only sums the cube, on the same number of threads; the cubes are
  2.2 GB, beyond any cache, float32, 131 bands from 400 to 1050 nm, four channels.
* The functions that fill a picture got outputs that had been touched before. A public call gives
  new arrays, and the first touch of fresh memory is part of its time: the rows *into fresh arrays*.
* Where a kernel comes above 100 % of reading, the loop that reads was itself disturbed or slower
  than the memory: the shares of reading are then too high.
* *Tiled numpy*: 32 rows at a time on the same number of threads, BLAS for the sums, a generator per
  tile, a table for sRGB (`benchmarks/plain_numpy.py`). *C kernel*: the same sums, random words,
  quantile functions and table, `gcc -O3 -march=native`, free to fuse multiply and add, so its bits
  differ from machine to machine (`benchmarks/kernel.c`).
* prysm and getframes know no mosaic and no cube: numpy made their electrons, which their time
  holds.
* The file is read by a process of its own at each turn; *cold* means that the system was told to
  forget it before each turn, *warm* that it could still hold it. Plain reading: 8 MB at a time
  into one buffer, on one thread. Memory is the most that the process ever held.
* dask: two processes of one thread each against two threads, starting the cluster not counted; the
  pictures were compared bit by bit.
"""


def document(rows: list[Row | Skipped], reading: str, load: tuple[float, float]) -> str:
    """The whole page."""
    short = [row for row in rows if isinstance(row, Row) and not row.reached]
    listed = "\n".join(f"* {row.path}" for row in short) or "* nothing"
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba"))
    return f"""# Performance of the imaging engine

Made by `make bench` on {datetime.datetime.now(datetime.UTC):%Y-%m-%d}: {_processor()}, \
{os.cpu_count()} cores, Python {platform.python_version()}, {versions}. {reading} Programs that \
wanted a core (load average) at the start {load[0]:.1f}, at the end {load[1]:.1f}: above \
{os.cpu_count()}, others had their share of the machine.

{markdown_table(rows)}

In bold: less than asked in this run:

{listed}
{_disturbed(max(load))}
{_HOW}"""


def _disturbed(load: float) -> str:
    """What a busy machine means for the verdicts."""
    if load <= 1.5 * (os.cpu_count() or 1):
        return ""
    return """
The machine was busy with other work in this run, and the ranges are wide: neither what falls short
nor what is reached is a verdict, and no cause can be told from it. Run it again on a quiet machine.
"""


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.machine()
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0]} ({platform.machine()})" if names else platform.machine()
