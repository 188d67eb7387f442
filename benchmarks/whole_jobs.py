"""Whole jobs, from the question to the answer; ``--write`` puts the figures into the page.

Each job is a command in a new process, with the byte code cached: processor time and peak memory.
An installation is measured with ``--install``: it fetches packages where pip's cache lacks them.
"""

import argparse
import datetime
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from document import _processor
from startup import TARGET, written

HEADING = "## Whole jobs\n"
ROUNDS, SENSORS = 3, 1000
TEN = (
    *("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut", "mt9v024-rgb"),
    *("mt9v024-rgbw", "model-rgbw", "model-rgb-ircut", "model-rgb", "model-rgbw-ircut"),
)
COMMAND = "from chromanoise.cli import main; main()"


@dataclass(frozen=True, slots=True)
class Used:
    """What a process used: processor and wall time [s], peak memory [MB]."""

    processor_s: float
    wall_s: float
    memory_mb: float


def used_by(arguments: list[str], folder: Path) -> Used:
    """Resources of one process."""
    began = time.perf_counter()
    process = subprocess.Popen(
        arguments,
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"},
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{arguments} ended with {process.returncode}")
    processor_s = usage.ru_utime + usage.ru_stime
    return Used(processor_s, time.perf_counter() - began, usage.ru_maxrss * 1024 / 1e6)


def of_sensors(names: Sequence[str]) -> str:
    """A study of these sensors."""
    return "schema = 1\n" + "".join(f'[[sensors]]\nname = "{name}"\n' for name in names)


def many_sensors(folder: Path) -> None:
    """Files of the curves of many sensors; studies of all at 50 levels, with budgets or without."""
    rng = np.random.default_rng(3)
    at = np.arange(400, 1051, 10.0)
    names = []
    for i in range(SENSORS):
        center = np.array([610.0, 540.0, 450.0]) + rng.normal(0, 12, 3)
        width = 40 + rng.uniform(-10, 15, 3)
        qe = 0.6 * np.exp(-0.5 * ((at[:, None] - center) / width) ** 2)
        qe += 0.05 * rng.random(3) * (at[:, None] > 780)
        names.append(f"c{i}.csv")
        np.savetxt(
            folder / names[-1],
            np.column_stack([at, qe]),
            fmt=["%g", "%.5f", "%.5f", "%.5f"],
            delimiter=",",
            header="wavelength_nm,R,G,B",
            comments="",
        )
    sweep = '[[sweeps]]\nvary = "lux"\nfirst = 0.1\nlast = 100\npoints = 50\nquantity = "snr-y"\n'
    head, sensors = of_sensors(names).split("\n", 1)
    for name, more in (("many", "[outputs]\nbudget = false\n"), ("budgets", "")):
        text = f'{head}\nmatrices = ["kernel"]\n{more}{sensors}{sweep}'
        (folder / f"{name}.toml").write_text(text)


def jobs(folder: Path) -> dict[str, tuple[list[str], float, float | None]]:
    """Arguments of each command, and its limits: processor time [s] and peak memory [MB]."""
    (folder / "ten.toml").write_text(of_sensors(TEN))
    many_sensors(folder)
    out, job = str(folder / "out"), f"{SENSORS:,} sensors, 24 patches, 50 light levels"
    return {
        "report of ten sensors": (["report", "ten.toml", "-o", "ten.html"], 5.0, None),
        "card of two sensors": (["card", *TEN[:2], "-o", "two.pdf"], 2.0, None),
        f"{job}, no budgets, to JSON": (["run", "many.toml", "-o", out], 5.0, 500.0),
        f"{job}, with budgets, to JSON": (["run", "budgets.toml", "-o", out], 5.0, 500.0),
    }


def rows(rounds: int) -> list[str]:
    """The rows of the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found = []
        for what, (arguments, most_s, most_mb) in jobs(folder).items():
            used = []
            for _ in range(rounds + 1):  # the first fills the byte-code cache
                shutil.rmtree(folder / "out", ignore_errors=True)
                used.append(used_by([sys.executable, "-c", COMMAND, *arguments], folder))
            seconds = [one.processor_s for one in used[1:]]
            memory_mb = max(one.memory_mb for one in used)
            middle, asked = statistics.median(seconds), f"<= {most_s:g} s"
            missed = middle > most_s or (most_mb is not None and memory_mb > most_mb)
            asked += "" if most_mb is None else f", {most_mb:g} MB"
            shown = f"{middle:.1f} s ({min(seconds):.1f} .. {max(seconds):.1f} s)"
            shown = f"**{shown}, missed**" if missed else shown
            found.append(f"| {what} | {asked} | {shown} | {memory_mb:.0f} MB |")
        return found


def installed() -> str:
    """The row of an installation into a fresh environment."""
    with tempfile.TemporaryDirectory() as name:
        environment = Path(name) / "environment"
        subprocess.run([sys.executable, "-m", "venv", str(environment)], check=True)
        pip = [str(environment / "bin" / "python"), "-m", "pip", "install", "--quiet"]
        empty_mb = _size_mb(environment)
        source = str(TARGET.parents[1])
        wheel = [sys.executable, "-m", "pip", "wheel", "--no-deps", "-q", "-w", f"{name}/wheel"]
        subprocess.run([*wheel, source], check=True)
        (made,) = (Path(name) / "wheel").iterdir()
        used = used_by([*pip, str(made)], Path(name))
        size_mb = _size_mb(environment) - empty_mb
        listed = [environment / "bin" / "python", "-m", "pip", "list", "--format=freeze"]
        count = len(subprocess.run(listed, capture_output=True, check=True).stdout.splitlines())
    missed = used.wall_s > 40 or size_mb > 400
    shown = f"{used.wall_s:.0f} s, {size_mb:.0f} MB, {count} packages"
    shown = f"**{shown}, missed**" if missed else shown
    return f"| installation in a fresh environment | <= 40 s, 400 MB | {shown} | wall time |"


def _size_mb(folder: Path) -> float:
    return sum(one.lstat().st_size for one in folder.rglob("*") if not one.is_dir()) / 1e6


def main() -> None:
    """Measure and print; with ``--write`` also into the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    parser.add_argument("--install", action="store_true", help="measure an installation, too")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    chosen = parser.parse_args()
    table = [
        "| job | target | processor time, median (range) | peak memory |",
        "|---|---|---|---|",
        *rows(chosen.rounds),
        *([installed()] if chosen.install else []),
    ]
    print("\n".join(table))
    if chosen.write:
        today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
        head = (
            f"Made by `python {' '.join(sys.argv)}` on {today}: "
            f"{_processor()}, {chosen.rounds} new processes each, byte code cached. Load average "
            f"{os.getloadavg()[0]:.1f} at end."
        )
        section = "\n".join([HEADING, head, "", *table, ""])
        text = TARGET.read_text(encoding="utf-8")
        TARGET.write_text(written(text, section, HEADING), encoding="utf-8")


if __name__ == "__main__":
    main()
