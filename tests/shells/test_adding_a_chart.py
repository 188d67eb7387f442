"""A chart is one description: page, report and figures show it, without a drawing of its own."""

import base64
import gzip
import json
import re

import pytest

from edited_copies import edit_copy
from processes import printed
from served_page import served

NEW = '''"""Pitch of the pixels."""

from chromanoise.charts.charted_study import Look, Shown
from chromanoise.charts.description import Axis, Bars, Chart, Panel, column


def drawn_pitches(shown: Shown, look: Look) -> Chart:
    """Pitch of the pixels of each sensor. [um]"""
    sensors = [one.sensor for one in shown.operating_points]
    names, pitches_um = zip(*((one.label, one.pixel.pitch_um) for one in sensors), strict=True)
    bars = Bars(
        label=0,
        start=1,
        end=1,
        first=0,
        last=len(names),
        roles=("total",) * len(names),
        texts=tuple(f"{one:g} um wide" for one in pitches_um),
    )
    x = Axis(label="pitch [um]", low=0.0, high=max(pitches_um))
    return Chart(
        title="Pitch of the pixels",
        description="Pitch of the pixels of each sensor.",
        sensors=names,
        columns=(column("sensor", names), column("pitch [um]", pitches_um, "{:g}".format)),
        panels=(Panel(title="all sensors", x=x, marks=(bars,)),),
    )
'''
EDITS = {  # by file: what is inserted, each before a text
    "charts/registry.py": (
        "from chromanoise.charts.sensitivities",
        "from chromanoise.charts.pitches import drawn_pitches\n",
        '    "pareto": drawn_pareto,',
        '    "pitches": drawn_pitches,\n',
        '    Section(\n        part="sensitivities"',
        '    Section(part="pitches", heading="Pitches", shows="How large the pixels are.",\n'
        '            explanations=("electrons",)),\n',
    ),
    "charts/figures_of_study.py": (
        '            "pareto": _pareto(of),',
        '            "pitches": _panelled(of, "pitches", row_in=2.0),\n',
    ),
}
STUDY = '[[sensors]]\nname = "onyx-rgbw"\n[[sensors]]\nname = "onyx-rgb"\n'
COMMAND = (  # without card and sliders, which take most of the time
    "from chromanoise.web import report_of_study as report; "
    "report.MOST_ON_CARD, report.slides_of = 0, lambda of: (); "
    "from chromanoise.cli import main; main()"
)


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A folder with a copy of the package that has the new chart."""
    folder = tmp_path_factory.mktemp("copy")
    edit_copy(folder, EDITS, {"charts/pitches.py": NEW})
    return folder


@pytest.fixture(scope="module")
def report(copy):
    """The text of a report of the copy; its figures are in the folder ``figures`` beside it."""
    (copy / "study.toml").write_text(STUDY, encoding="utf-8")
    words = ["report", "study.toml", "-o", "report.html", "--figures", "figures"]
    printed(COMMAND, *words, cwd=copy, PYTHONPATH=str(copy))
    return (copy / "report.html").read_text(encoding="utf-8")


@pytest.mark.evidence
def test_a_report_has_its_section_its_drawing_and_its_data(report):
    assert '<section data-part="pitches"' in report
    packed = re.search(r'<script type="application/gzip"[^>]*>(.*?)</script>', report, re.S)[1]
    data = json.loads(gzip.decompress(base64.b64decode(packed)))
    assert data["parts"]["pitches"]["table"]["rows"] == [["onyx-rgbw", "10"], ["onyx-rgb", "10"]]


@pytest.mark.evidence
def test_the_figures_of_a_report_have_it(copy, report):
    names = {one.name for one in (copy / "figures").iterdir()}
    assert {"pitches.svg", "pitches.pdf"} <= names


@pytest.mark.evidence
def test_the_page_draws_it_in_its_place(copy, report, window, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(copy))
    with served(copy / "study.toml") as (where, _):
        page = window(at=where)
        panel = page.locator("section.panel[data-part=pitches]")
        panel.scroll_into_view_if_needed()
        panel.get_by_text("10 um wide").first.wait_for()
        assert panel.locator("h2").inner_text().startswith("Pitches")
        page.close()  # before the server, whose end it would report


@pytest.mark.evidence
def test_the_report_draws_it_in_a_browser(copy, report, window):
    page = window(at=(copy / "report.html").as_uri(), wait=False)
    page.locator("section[data-part=pitches]").get_by_text("10 um wide").last.wait_for()
