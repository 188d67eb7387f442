"""Charts of five and ten sensors: no words over others, none cut, on screen and on paper."""

from itertools import combinations

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from chromanoise.charts import chromanoise_style, draw_budget, drawing, shown, study_figures
from chromanoise.charts.figure_style import sensor_mark
from chromanoise.study import coordinate_budget, study_from_text
from chromanoise.web import study_report
from shells.test_page_looks import cut_off, overlapping

NAMES = (
    *("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut", "mt9v024-rgb"),
    *("mt9v024-rgbw", "model-rgbw", "model-rgb-ircut", "model-rgb", "model-rgbw-ircut"),
)
DARK = "[light]\nlevel_lux = 0.01\n[exposure]\ntime_ms = 1.0\n"


def charted(count, light=""):
    """A study whose labels have 40 letters."""
    sensors = "".join(
        f'[[sensors]]\nname = "{name}"\n'
        f'label = "{name + " of the second supplier, lot":.37} {i:02d}"\n'
        for i, name in enumerate(NAMES[:count], 1)
    )
    return shown(study_from_text(f"{light}{sensors}", source="a test"))


@pytest.fixture(scope="module")
def ten():
    return charted(10, DARK)


@pytest.fixture(scope="module", params=[pytest.param(5, marks=pytest.mark.evidence), 10], ids=str)
def figures(request, ten):
    return study_figures(ten if request.param == 10 else charted(5))


def boxes_of(figure):
    """Boxes of the letters of each text, without the room above and below a line."""
    with chromanoise_style():
        renderer = FigureCanvasAgg(figure).get_renderer()
        figure.draw(renderer)
    hidden = set()
    for ax in figure.axes:
        for axis, view in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                slack = 1e-9 * max(map(abs, view))
                if not min(view) - slack <= tick.get_loc() <= max(view) + slack:
                    hidden |= {tick.label1, tick.label2}
    texts = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
    for text in texts:
        if text in hidden:
            continue
        box = Text.get_window_extent(text, renderer)  # of an annotation without its arrow
        if box.width > 0:
            trim = 0.2 * box.height / (1 + text.get_text().count("\n"))
            yield text.get_text(), (box.x0 + 1, box.y0 + trim, box.x1 - 1, box.y1 - trim)


@pytest.mark.evidence
def test_no_words_of_a_figure_overlap_and_none_leaves_it(figures):
    for name, figure in figures.items():
        boxes = list(boxes_of(figure))
        width, height = figure.bbox.width, figure.bbox.height
        for text, (left, bottom, right, top) in boxes:
            assert left >= 0, (name, text)
            assert bottom >= 0, (name, text)
            assert right <= width, (name, text)
            assert top <= height, (name, text)
        for (one, a), (two, b) in combinations(boxes, 2):
            apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
            assert apart, (name, one, two)


def test_figures_of_many_sensors_fit_a_page(figures):
    for figure in figures.values():
        width_in, height_in = figure.get_size_inches()
        assert width_in <= 7.5
        assert height_in <= 10.3


@pytest.mark.evidence
def test_no_words_of_a_report_overlap_on_screen_telephone_and_paper(
    ten, browser, watch, tmp_path, monkeypatch
):
    # sliders whose answers are those of the study itself, which takes less time
    monkeypatch.setattr("chromanoise.web.report_of_study._there", lambda *given: given[-1])
    (tmp_path / "report.html").write_text(study_report(ten, ()), encoding="utf-8")
    page = browser({"viewport": {"width": 1280, "height": 900}}).new_page()
    page.on("console", lambda said: watch.hear(said.type, said.text))
    page.goto((tmp_path / "report.html").as_uri())
    for width in (1280, 390, 700):
        page.set_viewport_size({"width": width, "height": 900})
        page.evaluate("() => new Promise((done) => setTimeout(done, 100))")
        if width == 700:
            page.emulate_media(media="print")
            page.evaluate("dispatchEvent(new Event('beforeprint'))")
            tallest = page.evaluate(
                "Math.max(...[...document.querySelectorAll('.chart .d-figure')]"
                ".map((one) => one.getBoundingClientRect().height))"
            )
            assert tallest <= 940  # of Letter without margins
        assert overlapping(page) == [], width
        assert cut_off(page) == [], width
    page.close()


def test_the_bars_of_a_budget_below_0_db_are_within_its_axes():
    (analysis,) = charted(1, DARK).analyses
    budget = coordinate_budget(analysis, "Y")
    ax = draw_budget(budget, analysis.sensor, Figure().add_subplot())
    low, high = ax.get_xlim()
    assert low < budget.snr_db < 0 < high
    for bar in ax.patches:
        assert low <= min(bar.get_x(), bar.get_x() + bar.get_width())
        assert max(bar.get_x(), bar.get_x() + bar.get_width()) <= high


def test_the_panels_of_ellipses_contain_all_of_few_sensors_and_the_typical_ones_of_many():
    infrared = '[light]\nilluminant = "E+0.5xLED850"\n'
    few, many = (drawing("ellipses", charted(count, infrared)) for count in (2, 8))
    assert not any(panel.remark for panel in few.panels)
    larger = {NAMES[panel.sensor] for panel in many.panels if panel.remark}
    assert 1 <= len(larger) < 4


def test_twelve_sensors_have_twelve_marks():
    looks = [sensor_mark(i) for i in range(12)]
    assert len({(look["marker"], look["markerfacecolor"]) for look in looks}) == 12
