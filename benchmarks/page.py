"""How soon the page answers; ``--write`` makes docs/page_speed.md.

Needs a chromium, and playwright of the dev extra. From the press of a key on the slider of the
light level, as the browser stamps it, to the frame with the new numbers and drawings handed over
to be painted: the page marks both.
"""

import argparse
import datetime
import json
import os
import statistics
import sys
import tempfile
import time
import urllib.request
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from document import _disturbed, _processor

sys.path.append(str(Path(__file__).parents[1] / "tools"))
from whole_jobs import TEN, of_sensors

from served_page import chromium_path, served

TARGET = Path(__file__).parents[1] / "docs" / "page_speed.md"
PRESSES = 40
BURST = 60
BETWEEN_MS = (33, 20, 16)  # presses: what a held key does, and faster than any
REST_MS = 150
STARTS = 5
SEEN = {"width": 1280, "height": 900}
ALL = {"width": 1920, "height": 3000}
SENSORS = "onyx-rgbw, onyx-rgb-ircut"


@dataclass(frozen=True, slots=True)
class Line:
    """One measured thing; ``asked`` is ``None`` for what is reported and not judged."""

    what: str
    asked: float | None
    measured: float
    unit: str
    at_least: bool = False

    @property
    def reached(self) -> bool:
        """Whether it is as asked."""
        if self.asked is None:
            return True
        more = self.measured >= self.asked
        return more if self.at_least else self.measured <= self.asked


def start_s() -> float:
    """From the start of a server to its first response. [s]"""
    began = time.perf_counter()
    with served() as (address, _):
        urllib.request.urlopen(address, timeout=60).read()
        return time.perf_counter() - began


def opened(browser: Any, address: str, size: dict[str, int]) -> Any:
    """The page in a fresh context, once all its drawings are there."""
    page = browser.new_context(viewport=size).new_page()
    page.goto(address)
    drawn = "section.panel[data-part]:not([data-part=picture])[aria-busy]"
    until(page, "document.documentElement.dataset.painted")
    until(page, f"document.querySelectorAll('{drawn}').length === 0")
    page.wait_for_timeout(1000)
    page.get_by_label("Light level", exact=True).focus()
    return page


def until(page: Any, truth: str) -> None:
    """Wait until an expression is true; the page's policy forbids playwright's own waiting."""
    page.evaluate(
        f"() => new Promise((done) => {{ const look = () => ({truth}) ? done() "
        ": setTimeout(look, 5); look(); })"
    )


def latencies_ms(page: Any, presses: int) -> list[float]:
    """From each of some presses, one after the other, to its painted answer. [ms]"""
    found = []
    marks = "performance.getEntriesByName"
    for _ in range(presses):
        page.evaluate("performance.clearMarks()")
        page.keyboard.press("ArrowUp")
        until(page, f"{marks}('painted').length > 0 && {marks}('press').length > 0")
        found.append(
            page.evaluate(f"{marks}('painted')[0].startTime - {marks}('press')[0].startTime")
        )
        page.wait_for_timeout(REST_MS)
    return found


def bursts(page: Any) -> list[Line]:
    """What a burst of presses shows, at each of the paces."""
    lines = []
    for between_ms in BETWEEN_MS:
        page.keyboard.press("Home")
        page.wait_for_timeout(2000)
        distinct, ends = distinct_in_burst(page, between_ms)
        what = f"distinct results of {BURST} presses, {between_ms} ms between them"
        lines.append(Line(what, 45, distinct, "", at_least=True))
        lines.append(Line("the last painted is that of the last press", 1, ends, "", at_least=True))
    page.keyboard.press("Home")
    page.wait_for_timeout(2000)
    distinct, ends = distinct_in_burst(page, BETWEEN_MS[-1], from_timer=True)
    pace = f"{BETWEEN_MS[-1]} ms between them"
    what = f"distinct results of {BURST} steps from a timer in the page, {pace}"
    lines.append(Line(what, 40, distinct, "", at_least=True))
    lines.append(Line("the last painted is that of the last step", 1, ends, "", at_least=True))
    return lines


def distinct_in_burst(
    page: Any, between_ms: float, *, from_timer: bool = False
) -> tuple[int, bool]:
    """How many different results a burst paints, and whether the last is that of its end."""
    page.evaluate(
        """() => {
            window.seen = new Set();
            window.watching?.disconnect();
            const told = document.getElementById("electrons");
            const look = () => window.seen.add(told.textContent);
            window.watching = new MutationObserver(look);
            window.watching.observe(document.documentElement, { attributes: true });
        }"""
    )
    if from_timer:
        _step_from_timer(page, between_ms)
    else:
        due = time.perf_counter()
        for _ in range(BURST):
            page.keyboard.press("ArrowUp")
            due += between_ms / 1e3
            time.sleep(max(0.0, due - time.perf_counter()))
    page.wait_for_timeout(1500)
    ends = page.evaluate(
        """() => {
            const lux = Number(document.querySelector("#controls .field").value).toPrecision(4);
            const verdict = document.querySelector("#verdict").textContent;
            return verdict.startsWith(`At ${Number(lux)} lx `);
        }"""
    )
    return page.evaluate("window.seen.size"), ends


def _step_from_timer(page: Any, between_ms: float) -> None:
    """Step the slider from a timer in the page, so that no driver takes processor time."""
    page.evaluate(
        """([steps, between]) => new Promise((done) => {
            const track = document.querySelector("#controls .track");
            const began = performance.now();
            let made = 0;
            const step = () => {
                if (made === steps) return done();
                made += 1;
                track.value = String(Number(track.value) + 1);
                track.dispatchEvent(new Event("input", { bubbles: true }));
                setTimeout(step, Math.max(0, began + made * between - performance.now()));
            };
            step();
        })""",
        [BURST, between_ms],
    )


def first_sight(browser: Any, address: str) -> tuple[float, float, float]:
    """When a fresh window paints first [s], when its first numbers [s], what it loads [kB]."""
    context = browser.new_context(viewport=SEEN)
    page = context.new_page()
    page.goto(address)
    until(page, "performance.getEntriesByName('painted').length > 0")
    first, numbers, size = page.evaluate(
        """() => {
            const entries = ["navigation", "resource"]
                .flatMap((kind) => performance.getEntriesByType(kind))
                .filter((entry) => !entry.name.includes("/api/"));
            const at = (name) => performance.getEntriesByName(name)[0].startTime;
            const bytes = entries.reduce((sum, entry) => sum + entry.transferSize, 0);
            return [at("first-contentful-paint") / 1e3, at("painted") / 1e3, bytes / 1e3];
        }"""
    )
    context.close()
    return first, numbers, size


def cloud_ms(address: str) -> list[float]:
    """Of replies with the cloud of cameras: the first one, then one per shift of a filter. [ms]"""
    found = []
    for step in range(PRESSES):
        sensor = {"name": "onyx-rgb", "filter": f"ircut-{640 + step}"}
        question = {"study": {"sensors": [sensor]}, "want": ["league"]}
        body = json.dumps(question).encode()
        headers = {"Content-Type": "application/json"}
        request = urllib.request.Request(f"{address}api/answer", body, headers)
        began = time.perf_counter()
        urllib.request.urlopen(request, timeout=60).read()
        found.append(1e3 * (time.perf_counter() - began))
    return found


def measured(browser: Any) -> list[Line]:
    """All lines of the table."""
    starts = [start_s() for _ in range(STARTS)]
    with served() as (address, _):
        first_cloud, *clouds = cloud_ms(address)
    with served() as (address, _):
        page = opened(browser, address, SEEN)
        latencies_ms(page, 5)  # what is computed once is not what is asked
        few = latencies_ms(page, PRESSES)
        held = bursts(page)
        page.context.close()
        page = opened(browser, address, ALL)
        every = latencies_ms(page, PRESSES)
        page.context.close()
        sights = [first_sight(browser, address) for _ in range(STARTS)]
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "ten.toml"
        study.write_text(of_sensors(TEN))
        with served(study) as (address, _):
            page = opened(browser, address, SEEN)
            latencies_ms(page, 5)
            ten = latencies_ms(page, PRESSES)
            page.context.close()
    first, numbers, size = (statistics.median(column) for column in zip(*sights, strict=True))
    return [
        Line("key press to painted, median of 40", 33, statistics.median(few), "ms"),
        Line("key press to painted, 95th percentile", 50, percentile(few, 95), "ms"),
        Line("the same with all drawings in view, median", 50, statistics.median(every), "ms"),
        Line("the same, 95th percentile", 70, percentile(every, 95), "ms"),
        Line("key press to painted with ten sensors, median", 60, statistics.median(ten), "ms"),
        *held,
        Line("first reply with the cloud of cameras", None, first_cloud, "ms"),
        Line("reply with the cloud after a filter moved, median", 40, percentile(clouds, 50), "ms"),
        Line("first paint", 1, first, "s"),
        Line("first numbers painted", None, numbers, "s"),
        Line("start of the server to its first response", 1.5, statistics.median(starts), "s"),
        Line("what the page loads", 400, size, "kB"),
    ]


def percentile(values: list[float], share: int) -> float:
    """Of the values, interpolated between neighbors."""
    return statistics.quantiles(values, n=100, method="inclusive")[share - 1]


def table(lines: list[Line]) -> str:
    """In Markdown; what falls short stands in bold."""
    rows = ["| what | target | measured |", "|---|---|---|"]
    for line in lines:
        sign = ">=" if line.at_least else "<="
        asked = "-" if line.asked is None else f"{sign} {line.asked:g} {line.unit}".strip()
        text = f"{line.measured:.3g} {line.unit}".strip()
        rows.append(f"| {line.what} | {asked} | {text if line.reached else f'**{text}**'} |")
    return "\n".join(rows)


def document(lines: list[Line], browser: str, load: tuple[float, float]) -> str:
    """The whole page."""
    return f"""# How soon the page answers

Made by `make bench` on {datetime.datetime.now(datetime.UTC):%Y-%m-%d}: {_processor()}, \
{os.cpu_count()} cores, Chromium {browser} without a window, two sensors ({SENSORS}), window \
{SEEN["width"]} x {SEEN["height"]}. Load average {load[0]:.1f} at start, \
{load[1]:.1f} at end; above {os.cpu_count()} (the core count), other programs slowed the run.

{table(lines)}

{"No target was missed." if all(line.reached for line in lines) else "Bold: target missed."}
{_disturbed(max(load))}
* Key press to painted: from the browser's time stamp of the key to the frame with the new numbers
  and drawings. Each press waits for the reply to the last one.
* In a burst, keys are pressed without waiting for replies, and only the latest state counts: every
  33 ms (a held key), every 20 ms, and every 16 ms (about once per frame of the screen). The driver
  that presses them takes processor time from browser and server; a timer in the page needs none.
* The first paint and the bytes are medians of {STARTS} fresh windows with an empty cache; the
  server starts with warm files.
"""


def main() -> None:
    """Measure, print, and on demand write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"write {TARGET.name}")
    arguments = parser.parse_args()
    program = chromium_path()
    if program is None:
        print("skipped: there is no chromium; apt-get install chromium")
        return
    from playwright.sync_api import sync_playwright

    before = os.getloadavg()[0]
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=program, args=["--no-sandbox"])
        version = browser.version
        lines = measured(browser)
        browser.close()
    print(table(lines))
    if arguments.write:
        load = before, os.getloadavg()[0]
        TARGET.write_text(document(lines, version, load), encoding="utf-8")


if __name__ == "__main__":
    main()
