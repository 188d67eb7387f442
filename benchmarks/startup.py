"""How fast a command starts; ``--write`` puts the figures into docs/performance.md.

Times of whole processes, each started in turn, after one start that fills the byte-code cache:
``chromanoise analyze onyx-rgbw`` against ``import numpy``, and ``import chromanoise`` against an
interpreter that does nothing. Processor time of the first picture of an installation, whose folder
of compiled kernels is empty.
"""

import argparse
import datetime
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from document import _processor

TARGET = Path(__file__).parents[1] / "docs" / "performance.md"
HEADING = "## Start of a command\n"
ROUNDS = 15
MOST_RATIO = 3.5
MOST_EXTRA_MS = 15.0
MOST_LEAGUE_S = 2.0
MOST_FIRST_S = 5.0
FIRST = {
    "of all channels": [],
    "of a mosaic": ["--mosaic", "sensor"],
    "denoised (`guided`)": ["--denoise", "guided"],
}
PROGRAMS = {
    "pass": "pass",
    "package": "import chromanoise",
    "numpy": "import numpy",
    "analyze": "from chromanoise.cli import main; main(['analyze', 'onyx-rgbw'])",
    "league": "from chromanoise.cli import main; main(['league'])",
}


def process_ms(program: str, environment: dict[str, str]) -> float:
    """Time of a new interpreter from its start to its end. [ms]"""
    began = time.perf_counter()
    subprocess.run(
        [sys.executable, "-c", program],
        stdout=subprocess.DEVNULL,
        env=environment,
        check=True,
    )
    return 1e3 * (time.perf_counter() - began)


def measured_ms(rounds: int) -> dict[str, list[float]]:
    """Times of each program, all of them once per round. [ms]"""
    with tempfile.TemporaryDirectory() as cache:
        environment = {
            **{k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"},
            "PYTHONPYCACHEPREFIX": cache,
        }
        for program in PROGRAMS.values():
            process_ms(program, environment)
        times: dict[str, list[float]] = {name: [] for name in PROGRAMS}
        for _ in range(rounds):
            for name, program in PROGRAMS.items():
                times[name].append(process_ms(program, environment))
    return times


def first_picture_s(options: list[str]) -> float:
    """Processor time of a process that makes its first picture, its children included. [s]"""
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [
                *(sys.executable, "-c", "from chromanoise.cli import main; main()", "simulate"),
                *("builtin:checker", "--sensor", "onyx-rgbw", "--out", f"{folder}/out", *options),
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env=os.environ | {"NUMBA_CACHE_DIR": f"{folder}/kernels"},
            check=True,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def first_rows() -> list[str]:
    """Rows of the table for the first picture."""
    return [
        f"| first picture, {name} | <= {MOST_FIRST_S:.0f} s | {first_picture_s(options):.1f} s | "
        "processor time |"
        for name, options in FIRST.items()
    ]


def table(times: dict[str, list[float]]) -> list[str]:
    """The rows of the section in docs/performance.md."""
    ratios = [a / n for a, n in zip(times["analyze"], times["numpy"], strict=True)]
    extra = [p - e for p, e in zip(times["package"], times["pass"], strict=True)]
    ms = {name: f"{statistics.median(values):.0f} ms" for name, values in times.items()}
    return [
        "| start | target | measured, median (range) | times |",
        "|---|---|---|---|",
        f"| `chromanoise analyze onyx-rgbw`, of `import numpy` | <= {MOST_RATIO:.1f} x | "
        f"{statistics.median(ratios):.1f} x ({min(ratios):.1f} x .. {max(ratios):.1f} x) | "
        f"{ms['analyze']}, {ms['numpy']} |",
        f"| `import chromanoise`, beyond an empty program | <= {MOST_EXTRA_MS:.0f} ms | "
        f"{statistics.median(extra):.0f} ms ({min(extra):.0f} .. {max(extra):.0f} ms) | "
        f"{ms['package']}, {ms['pass']} |",
        f"| `chromanoise league`, 52 cameras at 9 ISO speeds | <= {MOST_LEAGUE_S:.0f} s | "
        f"{statistics.median(times['league']) / 1e3:.1f} s | {ms['league']} |",
    ]


def written(text: str, section: str, title: str = HEADING) -> str:
    """The page with the section in place of its former one, or at its end."""
    before, heading, rest = text.partition(title)
    if not heading:
        return f"{text.rstrip()}\n\n{section}"
    _, following, after = rest.partition("\n## ")
    return before + section + (f"\n## {after}" if following else "")


def main() -> None:
    """Measure and print; with ``--write`` also into the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="into docs/performance.md")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    chosen = parser.parse_args()
    rows = [*table(measured_ms(chosen.rounds)), *first_rows()]
    print("\n".join(rows))
    if chosen.write:
        today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
        section = "\n".join(
            [
                HEADING,
                f"Made by `python benchmarks/startup.py --write` on {today}: {_processor()}, "
                f"{chosen.rounds} rounds of alternating new processes, byte code cached. Load "
                f"average {os.getloadavg()[0]:.1f} at end.",
                "",
                *rows,
                "",
            ]
        )
        TARGET.write_text(written(TARGET.read_text(encoding="utf-8"), section), encoding="utf-8")


if __name__ == "__main__":
    main()
