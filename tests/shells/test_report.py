"""The report that travels: one file, the library's digits, answers behind its sliders."""

import base64
import csv
import gzip
import json
import re
from decimal import ROUND_HALF_UP, Decimal
from functools import partial
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from chart_values import rows_of, stages_of
from chromanoise.charts import PARTS, as_data, drawing, shown, study_figures
from chromanoise.charts.explanations import EXPLANATIONS, mathml
from chromanoise.charts.figure_style import figure_bytes
from chromanoise.charts.registry import SECTIONS
from chromanoise.cli.entry import run as run_command
from chromanoise.io.result_tables import written
from chromanoise.study import (
    Study,
    color_snr_db,
    run as run_study,
    study_from_data,
    study_from_text,
    study_hash,
)
from chromanoise.web import sights_of, study_report
from chromanoise.web.report_bundle import shortened
from chromanoise.web.report_of_study import at_value, slides_of

TITLE = 'Is "1 < 2" & 3 > 2? </script><script>alert(1)</script><!--'
TWO = '[[sensors]]\nname = "onyx-rgb-ircut"\n[[sensors]]\nname = "onyx-rgbw"\n'
STUDY = f"title = '{TITLE}'\n{TWO}[[pictures]]\ncube = 'builtin:checker'\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A study with a hostile title, reported once with its figures."""
    there = tmp_path_factory.mktemp("report")
    (there / "study.toml").write_text(STUDY, encoding="utf-8")
    with pytest.raises(SystemExit) as stop:
        run_command(
            [
                *("report", str(there / "study.toml"), "-o", str(there / "report.html")),
                *("--figures", str(there / "figures")),
            ]
        )
    assert stop.value.code == 0
    return there


@pytest.fixture(scope="module")
def page(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def there():
    return shown(study_from_text(STUDY, source="a test"))


class Elements(HTMLParser):
    """Which elements stand in a page, and the text of each."""

    def __init__(self, page):
        super().__init__()
        self.found, self.open, self.texts = [], [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.found.append([tag, dict(attrs), slice(len(self.texts), None)])
        self.open.append(self.found[-1])

    def handle_endtag(self, tag):
        while self.open:
            one = self.open.pop()
            one[2] = slice(one[2].start, len(self.texts))
            if one[0] == tag:
                break

    def handle_data(self, data):
        self.texts.append(data)

    def of(self, tag):
        found = [(attrs, inside) for name, attrs, inside in self.found if name == tag]
        return [(attrs, "".join(self.texts[inside])) for attrs, inside in found]


def block(page):
    (data,) = [text for attrs, text in Elements(page).of("script") if attrs.get("id") == "data"]
    return json.loads(gzip.decompress(base64.b64decode(data)))


@pytest.mark.evidence
def test_the_file_asks_for_nothing_from_elsewhere(page):
    modules = re.findall(r"data:text/javascript;base64,([^\"]*)", page)
    assert len(modules) >= 9  # a drawing each, and what they share
    texts = [page, *(base64.b64decode(one).decode("utf-8") for one in modules)]
    addresses = {one for text in texts for one in re.findall(r"https?://[^\s\"'<;]*", text)}
    names = {"http://www.w3.org/2000/svg", "http://www.w3.org/1998/Math/MathML"}
    assert addresses <= names  # never asked for
    for attrs in (attrs for _, attrs, _ in Elements(page).found):
        for key in {"src", "href", "action", "srcset"} & attrs.keys():
            assert attrs[key].startswith(("data:", "#h-"))
    assert "@import" not in page
    assert "url(" not in page
    assert "default-src 'none'" in page


@pytest.mark.evidence
def test_the_file_is_under_a_megabyte_beside_its_pictures(page):
    pictures = sum(map(len, re.findall(r"data:image/[^\"]*", page)))
    assert pictures > 0
    assert len(page.encode("utf-8")) - pictures < 1_000_000


CHANNELS = (
    r"\text{<img/src=x/onerror=alert(1)>}",
    "</mtext><script>alert(1)</script>",
    r"\frac{$&",
)
LABEL = "<img src=x onerror=alert(1)> $x_ & \"q\" 'q'"


@pytest.mark.usefixtures("plain_report")
def test_names_of_channels_and_sensors_are_words_and_never_markup(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = [[400 + 50 * i, *(0.1 + 0.05 * ((i + k) % 5) for k in range(3))] for i in range(14)]
    with (tmp_path / "curves.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["wavelength [nm]", *CHANNELS], *rows])
    answers = {"level": "absolute", "per": "photon"}
    sensor = {"name": "curves.csv", "label": LABEL, "answers": answers}
    sweep = {"vary": "lux", "first": 1.0, "last": 10.0, "points": 2}
    study = study_from_data({"sensors": [sensor], "sweeps": [sweep]}, source="a test")
    found = Elements(study_report(shown(study)))
    assert [attrs for attrs, _ in found.of("img") if "onerror" in attrs] == []
    assert len(found.of("script")) == 3
    assert {text for _, text in found.of("mtext")} >= set(CHANNELS)
    assert LABEL in {text for _, text in found.of("h1")}


def test_a_title_is_words_and_never_markup(page):
    elements = Elements(page)
    ((_, heading),) = elements.of("h1")
    assert heading == TITLE
    kinds = sorted(attrs.get("type", "") for attrs, _ in elements.of("script"))
    assert kinds == ["application/gzip", "importmap", "module"]
    assert study_hash(study_from_text(STUDY, source="a test")) in page


def test_the_data_is_json_whose_numbers_are_those_of_the_library(page, there):
    result = block(page)["parts"]
    for part in ("stages", "budget", "levels", "chart", "pareto", "sensitivities", "vectors"):
        assert result[part]["table"] == as_data(drawing(part, there))["table"]
    for analysis, found in zip(there.analyses, stages_of(result["stages"]), strict=True):
        assert found["color SNR"] == pytest.approx(color_snr_db(analysis), rel=1e-4)


def test_verdict_tables_equations_and_study_stand_in_the_page_without_a_script(page, there):
    elements = Elements(page)
    ((verdict, said),) = [(a, t) for a, t in elements.of("p") if a.get("id") == "verdict"]
    assert verdict["class"] == "verdict"
    assert said == drawing("head", there)["verdict"][0]
    captions = [text for _, text in elements.of("caption")]
    assert len(captions) >= len(PARTS)
    cells = {text for _, text in elements.of("td")}
    for analysis in there.analyses:
        assert f"{color_snr_db(analysis)['Y']:.1f}" in cells
    words = " ".join(text for _, text in elements.of("div"))
    drawn = [section for section in SECTIONS if section.part in PARTS]
    for key in {key for section in drawn for key in section.explanations}:
        one = EXPLANATIONS[key]
        assert one.words in words
        assert one.source in words
        assert all(mathml(latex, block=True) in page for latex in one.latex)
    (_, toml) = elements.of("pre")[0]
    assert study_from_text(toml, source="the page") == there.study


def test_headings_are_in_the_order_of_the_sections_and_of_the_contents(page):
    elements = Elements(page)
    headings = [(attrs["id"].removeprefix("h-"), text) for attrs, text in elements.of("h2")]
    order = [one.part for one in SECTIONS if one.part not in ("map", "head")]
    assert [name for name, _ in headings][: len(order)] == order  # the picture first
    links = [(attrs["href"], text) for attrs, text in elements.of("a")]
    assert links == [(f"#h-{name}", text) for name, text in headings]


SENSOR = {"name": "onyx-rgb-ircut"}
SHOWN = {  # each field of a study: a study that has it, and what the report then says
    "title": ({"title": "A title of its own"}, ["A title of its own"]),
    "metric": ({"metric": "energy"}, ["metric", "energy"]),
    "observer": ({"observer": "cie-1964-10"}, ["cie-1964-10"]),
    "seed": ({"seed": 41}, ["41"]),
    "light": ({"light": {"illuminant": "A", "level_lux": 7.0}}, ["illuminant A", "7 lx"]),
    "exposure": ({"exposure": {"time_ms": 3.25, "f_number": 4.0}}, ["3.25 ms", "f/4"]),
    "sensors": ({"sensors": [SENSOR | {"label": "mine"}]}, ["mine", "sensors.0.label"]),
    "matrices": (
        {"matrices": ["lmmse", "ridge=0.02"]},
        ["With the lmmse matrix", "With the ridge=0.02 matrix", "ridge 0.02"],
    ),
    "prior": ({"prior": "smooth-50"}, ["smooth-50"]),
    "reflectances": ({"reflectances": {"patch": 0.4}}, ["reflectances.patch", "0.4"]),
    "sweeps": (
        {
            "sweeps": [
                {"vary": "read-noise-e", "first": 1.0, "last": 8.0, "points": 3},
                {"vary": "prnu", "first": 0.0, "last": 0.02, "points": 3, "quantity": "snr-x"},
                {
                    "vary": "lux",
                    "first": 1.0,
                    "last": 4.0,
                    "points": 3,
                    "second": {"vary": "f-number", "first": 2.0, "last": 8.0, "points": 2},
                },
            ]
        },
        ["SNR of Y of a white over read noise", "SNR of X of a white over PRNU", "and f-number"],
    ),
    "pictures": ({"pictures": [{}]}, ["builtin:checker"]),
    "outputs": (
        {
            "outputs": {
                "merit": True,
                "chart": True,
                "space": "luv",
                "reader": "machine",
                "matrix": True,
                "pareto": {"first": 0.1, "last": 10.0, "points": 3},
                "pipeline": {"run": True, "iso": [100.0, 400.0]},
            },
        },
        [
            "Budget of the color of",
            "Vora value",
            "ColorChecker seen by",
            "Noise of an 18 % gray in CIELUV",
            "Distance of patches for a machine",
            "Training error against noise",
            "at each ISO",
        ],
    ),
}


@pytest.mark.usefixtures("no_sliders")
def test_each_field_of_a_study_is_in_its_report():
    assert SHOWN.keys() == Study.model_fields.keys() - {"schema_number"}
    values = {key: value for values, _ in SHOWN.values() for key, value in values.items()}
    of = shown(study_from_data(values, source="a test"))
    elements = Elements(study_report(of, sights_of(of)))
    kinds = ("h1", "h2", "h3", "p", "li", "td", "th", "summary", "dd")
    texts = "\n".join(text for kind in kinds for _, text in elements.of(kind))
    assert [part for _, said in SHOWN.values() for part in said if part not in texts] == []
    images = [attrs["src"] for attrs, _ in elements.of("img")]
    assert len(images) == 3 + 1 + 1  # of the sweeps and of the picture, and the card


@pytest.mark.usefixtures("plain_report")
def test_every_number_of_a_sweep_of_every_matrix_is_in_the_report():
    sweeps = [{"vary": "lux", "first": 0.1, "last": 10.0, "points": 3}]
    values = {"sensors": [SENSOR], "matrices": ["kernel", "lmmse"], "sweeps": sweeps}
    study = study_from_data(values, source="a test")
    cells = {text for _, text in Elements(study_report(shown(study))).of("td")}
    results = run_study(study)
    tables = [*results.sweeps, *results.analyses.values()]
    for table in (one.to_table() for one in tables):
        for row in table.rows:
            for cell, column in zip(row[1:], table.columns[1:], strict=True):
                assert written(cell, column.digits).replace("-", "\N{MINUS SIGN}") in cells


def answered(data, slide, i):
    """What the page shows at a position, as its script puts it together."""
    changed = {part: each[i] for part, each in data["slides"][slide]["answers"].items()}
    return {
        part: changed.get(part, {}).get("whole") or {**own, **changed.get(part, {})}
        for part, own in data["parts"].items()
    }


def fresh(level_lux, time_ms, ircut_nm=None, light="E"):
    """CaptureSettings as a study of its own, the time given and not solved."""
    cut = "" if ircut_nm is None else f"ircut_nm = {ircut_nm!r}\n"
    sensors = TWO.replace('"\n', f'"\n{cut}')
    lit = f"[light]\nilluminant = '{light}'\nlevel_lux = {level_lux!r}\n"
    rest = f"{lit}[exposure]\ntime_ms = {time_ms!r}\n"
    return shown(study_from_text(sensors + rest, source="a test"))


@pytest.mark.parametrize(("slide", "i"), [(0, 3), (0, -1), (1, 2), (2, 3)])
def test_what_a_slider_shows_is_a_fresh_analysis_at_that_value(page, there, slide, i):
    data = block(page)
    value = data["slides"][slide]["values"][i]
    time_ms = 1e3 * there.operating_points[0].exposure.time_s
    asked = {
        0: lambda: fresh(value, time_ms),
        1: lambda: fresh(10.0, time_ms, value),
        2: lambda: fresh(10.0, time_ms, light=f"E+{value}xLED850"),
    }[slide]()
    answer = answered(data, slide, i)
    for part in ("stages", "budget", "levels", "chart", "pareto", "sensitivities", "vectors"):
        assert answer[part]["table"] == as_data(drawing(part, asked))["table"]
    (now,) = [one for one in answer["levels"]["panels"][0]["marks"] if one.get("role") == "now"]
    assert now["at"] == pytest.approx(asked.study.light.level_lux, rel=1e-4)
    head = drawing("head", asked)
    light, called = f"E + {value} x 850 nm LED, 20 nm wide", f"E+{value}xLED850"
    assert [one.replace(light, called) for one in answer["head"]["verdict"]] == head["verdict"]
    assert answer["head"]["table"] == head["table"]
    close = partial(pytest.approx, rel=1e-4, abs=1e-9)
    mine, his = (rows_of(one) for one in (answer["ellipses"], drawing("ellipses", asked)))
    for row, whole in zip(mine, his, strict=True):
        assert row == {k: close(v) if isinstance(v, float) else v for k, v in whole.items()}


def test_the_study_itself_is_a_position_of_every_slider_and_changes_nothing(page, there):
    data = block(page)
    assert [slide["key"] for slide in data["slides"]] == ["lux", "ircut-nm", "infrared"]
    assert [len(slide["values"]) for slide in data["slides"]] == [25, 13, 7]
    assert data["slides"][0]["values"][data["slides"][0]["own"]] == 10.0
    for i, slide in enumerate(slides_of(there)):
        changes = [one[slide.own] for one in data["slides"][i]["answers"].values()]
        assert not any(changes)
        assert len(slide.texts) == len(set(slide.texts))
    assert at_value(there, slides_of(there)[1], None) is there


def test_sensors_that_see_no_infrared_have_no_slider_for_it():
    study = study_from_text('[[sensors]]\nname = "onyx-rgb-ircut"', source="a test")
    assert [slide.key for slide in slides_of(shown(study))] == ["lux"]


@pytest.mark.evidence
def test_a_saturated_sensor_has_a_report_that_says_so():
    study = study_from_text(
        '[[sensors]]\nname = "onyx-rgb"\n[exposure]\ntime_ms = 500.0', source="t"
    )
    page = study_report(shown(study))
    data = block(page)
    assert "saturated" in data["parts"]["head"]["verdict"][0]
    assert data["parts"]["ellipses"]["panels"] == []
    answers = data["slides"][0]["answers"]["ellipses"]
    drawn = [len(one["columns"][0]["values"]) for one in answers if "columns" in one]
    assert max(drawn) == 24  # at a position of the slider that has colors and little noise


@given(st.floats(1e-9, 1e9), st.integers(1, 4))
def test_rounding_a_shortened_number_is_rounding_the_number(value, digits):
    def rounded(number):
        place = Decimal(number).adjusted() - digits + 1
        return Decimal(number).quantize(Decimal(1).scaleb(place), ROUND_HALF_UP)

    short = shortened(value)
    assert rounded(short) == rounded(value)
    assert short == pytest.approx(value, rel=5e-5)
    assert shortened(26.149999) == 26.149999  # 26.15 would be rounded up, to 26.2


FIGURES = ("sensitivities", "comparison", "budget", "ellipses", "pareto")


def test_a_rerun_gives_the_same_bytes_of_the_figures(folder, there):
    figures = study_figures(there)
    assert set(figures) == set(FIGURES)
    for name, ending in (("budget", "pdf"), ("ellipses", "svg")):
        written = (folder / "figures" / f"{name}.{ending}").read_bytes()
        assert figure_bytes(figures[name], ending) == written
    assert len(list((folder / "figures").glob("[!.]*"))) == 10


def test_the_figures_of_a_study_say_its_numbers(folder, there):
    texts = {
        name: re.findall(r">([^<>]+)</text>", (folder / "figures" / f"{name}.svg").read_text())
        for name in FIGURES
    }
    budget = drawing("budget", there)
    changes_db, snrs_db = (
        next(one.values for one in budget.columns if one.head == head)
        for head in ("change [dB]", "SNR of Y [dB]")
    )
    for panel in budget.panels:
        (bars,) = panel.marks
        values = {f"{snrs_db[row]:.1f}" for row in (bars.first, bars.last - 1)}
        values.add(f"\N{MINUS SIGN}{-changes_db[bars.first + 1]:.1f}")
        assert values <= set(texts["budget"])
    assert {"a*", "b*"} <= set(texts["ellipses"])
    for name in ("comparison", "budget", "ellipses", "pareto"):
        assert "illuminant E" in " ".join(texts[name])
    assert {"visual noise [CIELUV]", "onyx-rgbw"} <= set(texts["pareto"])
    assert "onyx-rgbw, kernel" in texts["comparison"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("nowhere.toml", "-o", "new/r.html"), "nowhere.toml: cannot be read"),
        (("bad.toml", "-o", "new/r.html"), "bad.toml:1"),
        (("file.toml", "-o", "new/r.html"), "there-is-none.csv"),
        (("study.toml", "-o", "."), "--out"),
        (("study.toml", "-o", "study.toml"), "study.toml"),
        (("study.toml", "-o", "study.toml/r.html"), "is an existing file"),
        (("study.toml", "-o", "new/r.html", "--figures", "study.toml"), "is an existing file"),
        (("study.toml", "-o", "new/r.html", "--set", "light.level_lux=-1"), "level_lux"),
    ],
)
def test_a_report_that_cannot_be_is_refused_in_one_sentence_and_nothing_is_written(
    run, tmp_path, monkeypatch, arguments, said
):
    monkeypatch.chdir(tmp_path)
    Path("study.toml").write_text(TWO, encoding="utf-8")
    Path("bad.toml").write_text("sensor = 1", encoding="utf-8")
    Path("file.toml").write_text('[[sensors]]\nname = "there-is-none.csv"', encoding="utf-8")
    code, out, err = run("report", *arguments)
    assert code == 2
    assert out == ""
    assert said in err
    assert all(line.startswith("chromanoise: ") for line in err.splitlines())
    names = {"study.toml", "bad.toml", "file.toml"}
    assert {one.name for one in tmp_path.iterdir()} == names
    assert Path("study.toml").read_text(encoding="utf-8") == TWO


@pytest.fixture
def seen(browser, folder):
    """The report opened from disk, with all that went wrong and all that it asked for."""
    tab = browser({"viewport": {"width": 1280, "height": 900}}).new_page()
    tab.wrong, tab.asked = [], []
    tab.on("console", lambda message: tab.wrong.append(message.text))
    tab.on("pageerror", lambda error: tab.wrong.append(str(error)))
    tab.on("request", lambda request: tab.asked.append(request.url.split(":")[0]))
    tab.goto((folder / "report.html").as_uri())
    tab.wait_for_selector("section[data-part=sensitivities] svg")
    yield tab
    assert tab.wrong == []
    assert set(tab.asked) <= {"file", "data"}
    tab.close()


def cells(tab, part):
    rows = f"section[data-part={part}] table tbody tr"
    return tab.eval_on_selector_all(
        rows, "all => all.map(r => [...r.cells].map(c => c.textContent))"
    )


@pytest.mark.evidence
def test_a_browser_draws_every_chart_from_disk(seen):
    for part in PARTS:
        if part != "head":
            assert seen.locator(f"section[data-part={part}] .chart svg").count() > 0
    assert seen.locator(".divided input[type=range]").count() == 1
    assert seen.title().startswith(TITLE)


@pytest.mark.evidence
def test_every_table_of_the_file_is_that_of_its_chart(seen, there):
    for part in PARTS:
        if part != "head":
            assert cells(seen, part) == as_data(drawing(part, there))["table"]["rows"]


def test_sliders_answer_by_key_with_the_digits_of_the_library(seen, there):
    before = seen.inner_text("#verdict")
    slider = seen.locator("#slide-0")
    slider.focus()
    for _ in range(8):
        seen.keyboard.press("ArrowLeft")
    darker = at_value(there, slides_of(there)[0], 1.0)
    told = "told => document.getElementById('verdict').textContent === told"
    seen.wait_for_function(told, arg=drawing("head", darker)["verdict"][0])
    assert slider.get_attribute("aria-valuetext") == "1 lx"
    seen.click("section[data-part=budget] summary:text-is('Table')")
    assert cells(seen, "budget") == drawing("budget", darker).table["rows"]
    seen.locator("#slide-1").focus()
    seen.keyboard.press("Home")
    assert slider.get_attribute("aria-valuetext") == "10 lx"  # one thing changes at a time
    seen.click("#back")
    seen.wait_for_function(told, arg=before)


@pytest.mark.evidence
def test_it_prints_a_card_then_six_pages_and_the_tables_that_stand_open_but_no_sliders(seen):
    seen.emulate_media(media="print")
    paper = seen.pdf(format="A4", prefer_css_page_size=True)
    sizes = re.findall(rb"/MediaBox *\[([\d. ]+)\]", paper)
    across = [float(wide) > float(high) for _, _, wide, high in map(bytes.split, sizes)]
    assert across == [True] + [False] * 6
    assert not seen.locator("#sliders").is_visible()
    seen.emulate_media(media="screen")
    seen.click("section[data-part=budget] summary:text-is('Table')")
    seen.emulate_media(media="print")
    tables = "section[data-part] .scroll"
    assert seen.locator(tables).count() > 1
    assert [one.is_visible() for one in seen.locator(tables).all()].count(True) == 1


def test_it_fits_a_telephone_and_a_wide_screen(seen):
    for width in (360, 1920):
        seen.set_viewport_size({"width": width, "height": 800})
        seen.wait_for_timeout(100)
        assert seen.evaluate("document.documentElement.scrollWidth") <= width
