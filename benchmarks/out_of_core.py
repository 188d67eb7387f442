"""A file of several GB to the codes of a mosaic, against reading it and doing nothing.

Each turn is a process of its own, that tells how long it took, without its start and compilation,
and how much memory it ever held. The cache of the system is in the same state before each turn:
either emptied of the file, or full of it.
"""

import subprocess
import sys
import time
from pathlib import Path

from files import dropped_from_cache
from memory import status_bytes
from races import Times
from subject import SEED, cube_of, operating_point, textured

from chromanoise.imaging import Work, acquired
from chromanoise.io.cubes import read_cube

_BUFFER_BYTES = 8 << 20


def file_race(path: Path, *, cold: bool, rounds: int, threads: int) -> tuple[Times, float]:
    """Times of plain reading and of ``acquired``, and the most memory of the latter. [s, bytes]"""
    times: dict[str, list[float]] = {"plain": [], "here": []}
    held = 0.0
    for number in range(rounds):
        for who in ("plain", "here")[:: 1 if number % 2 else -1]:
            if cold:
                dropped_from_cache(path)
            seconds, most = _turn(who, path, threads)
            times[who].append(seconds)
            held = max(held, most if who == "here" else 0.0)
    return times, held


def _turn(who: str, path: Path, threads: int) -> tuple[float, float]:
    command = [sys.executable, str(Path(__file__)), who, str(path), str(threads)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    return float(printed[0]), float(printed[1])


def _plainly(path: Path) -> float:
    """Seconds to read a file into one buffer, piece by piece."""
    piece = bytearray(_BUFFER_BYTES)
    start = time.perf_counter()
    with path.open("rb", buffering=0) as file:
        while file.readinto(piece):
            pass
    return time.perf_counter() - start


def _acquired(path: Path, threads: int) -> float:
    at, work = operating_point(), Work(threads=threads)
    acquired(cube_of(textured(16, 16)), at, seed=SEED, work=work)
    start = time.perf_counter()
    acquired(read_cube(path), at, seed=SEED, work=work)
    return time.perf_counter() - start


if __name__ == "__main__":
    turn, name, at_once = sys.argv[1:]
    took = _plainly(Path(name)) if turn == "plain" else _acquired(Path(name), int(at_once))
    print(took, status_bytes("VmHWM"))
