"""A chart costs two modules and its lines in five lists; page, report and figures then show it."""

import base64
import gzip
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import chromanoise
from served_page import served

NEW = {
    "charts/pitches.py": '''"""Pitch of the pixels."""

from typing import Any

from chromanoise.charts.charted_study import Look, Shown


def drawn_pitches(shown: Shown, look: Look) -> dict[str, Any]:
    """Pitch of the pixels of each sensor. [um]"""
    pitches = {one.sensor.label: one.sensor.pixel.pitch_um for one in shown.operating_points}
    rows = [[name, f"{pitch_um:g}"] for name, pitch_um in pitches.items()]
    return {
        "title": "Pitch of the pixels",
        "description": "Pitch of the pixels of each sensor.",
        "pitches": pitches,
        "table": {"head": ["sensor", "pitch [um]"], "rows": rows},
    }
''',
    "charts/draw/pitches.js": """/** Pitch of the pixels, as sentences. */

import { note } from "draw/look.js";
import { refill } from "draw/refill.js";

export function draw(element, data) {
  const rows = Object.entries(data.pitches);
  refill(element, ...rows.map(([name, um]) => note(`${name}: ${um} um wide`)));
}
""",
}
EDITS = {  # by file: what is inserted, each before a text
    "charts/by_name.py": [
        (
            "from chromanoise.charts.pareto_curves",
            "from chromanoise.charts.pitches import drawn_pitches\n",
        ),
        ('    "pareto": drawn_pareto,', '    "pitches": drawn_pitches,\n'),
        (
            '    Section(\n        part="sensitivities"',
            '    Section(part="pitches", heading="Pitches", shows="How large the pixels are.",\n'
            '            explanations=("electrons",)),\n',
        ),
    ],
    "charts/numbers.py": [
        (
            '    "chart": _chart,',
            '    "pitches": lambda of: [["sensor", "pitch [um]"], *of["table"]["rows"]],\n',
        )
    ],
    "charts/figures_of_study.py": [
        ('            "pareto": _pareto(of),', '            "pitches": _pitches(of),\n'),
        (
            "def _pareto(",
            "def _pitches(of: Shown) -> Figure:\n"
            '    data = drawing("pitches", of)\n'
            "    figure = Figure()\n"
            '    figure.add_subplot().bar(list(data["pitches"]), list(data["pitches"].values()))\n'
            "    return figure\n\n\n",
        ),
    ],
}
STUDY = '[[sensors]]\nname = "onyx-rgbw"\n[[sensors]]\nname = "onyx-rgb"\n'
COMMAND = "from chromanoise.cli import main; main()"


def lists_of_drawings(copy):
    """The scripts that name all drawings: of the page and the report, or one for both."""
    found = [one for one in copy.rglob("*.js") if "draw/stages.js" in one.read_text("utf-8")]
    assert 1 <= len(found) <= 2
    return found


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A folder with a copy of the package that has the new chart."""
    folder = tmp_path_factory.mktemp("copy")
    package = folder / "chromanoise"
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(Path(chromanoise.__file__).parent, package, ignore=ignored)
    for name, text in NEW.items():
        (package / name).write_text(text, encoding="utf-8")
    for name, edits in EDITS.items():
        text = (package / name).read_text(encoding="utf-8")
        for before, new in edits:
            assert text.count(before) == 1, (name, before)
            text = text.replace(before, new + before)
        (package / name).write_text(text, encoding="utf-8")
    for script in lists_of_drawings(package):
        text = script.read_text(encoding="utf-8")
        text, imports = re.subn(
            r'^import \* as stages from "draw/stages.js";\n',
            r'\g<0>import * as pitches from "draw/pitches.js";\n', text, flags=re.MULTILINE,
        )  # fmt: skip
        text, lists = re.subn(r"\bstages, budget,", "pitches, stages, budget,", text)
        assert (imports, lists) == (1, 1), script
        script.write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def report(copy):
    """The text of a report of the copy; its figures are in the folder ``figures`` beside it."""
    (copy / "study.toml").write_text(STUDY, encoding="utf-8")
    words = ["report", "study.toml", "-o", "report.html", "--figures", "figures"]
    ended = subprocess.run(
        [sys.executable, "-c", COMMAND, *words],
        env=os.environ | {"PYTHONPATH": str(copy)},
        cwd=copy, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    return (copy / "report.html").read_text(encoding="utf-8")


def test_a_report_has_its_section_its_drawing_and_its_data(report):
    assert '<section data-part="pitches"' in report
    modules = json.loads(re.search(r'<script type="importmap">(.*?)</script>', report, re.S)[1])
    assert "draw/pitches.js" in modules["imports"]
    packed = re.search(r'<script type="application/gzip"[^>]*>(.*?)</script>', report, re.S)[1]
    data = json.loads(gzip.decompress(base64.b64decode(packed)))
    assert data["parts"]["pitches"]["pitches"] == {"onyx-rgbw": 10, "onyx-rgb": 10}


def test_the_figures_of_a_report_have_it(copy, report):
    names = {one.name for one in (copy / "figures").iterdir()}
    assert {"pitches.svg", "pitches.pdf"} <= names


def test_the_page_draws_it_in_its_place(copy, window, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(copy))
    with served(copy / "study.toml") as (where, _):
        page = window(at=where)
        panel = page.locator("section.panel[data-part=pitches]")
        panel.scroll_into_view_if_needed()
        panel.get_by_text("onyx-rgbw: 10 um wide").wait_for()
        assert panel.locator("h2").inner_text().startswith("Pitches")
        page.close()  # before the server, whose end it would report


def test_the_report_draws_it_in_a_browser(copy, report, window):
    page = window(at=(copy / "report.html").as_uri(), wait=False)
    page.locator("section[data-part=pitches]").get_by_text("onyx-rgb: 10 um wide").wait_for()
