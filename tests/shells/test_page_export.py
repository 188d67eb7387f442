"""What is read at the pointer, and what is saved: charts, pictures, the report."""

import csv
import io
import re
import struct
import xml.etree.ElementTree as ElementTree

import httpx
import pytest

from chromanoise.charts import Look, as_data, card_of, chart_csv, drawing, shown
from chromanoise.charts.card import MOST_ON_CARD
from chromanoise.cli.entry import run as run_command
from chromanoise.study import study_from_data
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.page_studies import Studies
from chromanoise.web.saved_files import report_reply
from chromanoise.web.services import STUDY
from chromanoise.web.uploads import Kept, Upload, Uploads
from processes import Patient
from shells.browser import at_rest, until
from shells.test_page_looks import RULES, axe, faults_of_access
from shells.test_serve import FILE, sentence_of
from spectrum_samples import CAMERA_CSV

__all__ = ["axe"]

SVG = "{http://www.w3.org/2000/svg}"
SWEEP = {
    **{"vary": "lux", "first": 1.0, "last": 100.0, "points": 4},
    "second": {"vary": "f-number", "first": 1.4, "last": 8.0, "points": 3},
}
ALONE = STUDY | {"sensors": STUDY["sensors"][:1]}  # whose report has few sentences to compute
CHARTS = ("stages", "budget", "sensitivities", "levels", "pareto", "vectors", "ellipses", "chart")


@pytest.fixture(scope="module")
def client(address):
    with httpx.Client(base_url=address, timeout=600, transport=Patient()) as asking:
        yield asking


@pytest.fixture(scope="module")
def of():
    return shown(study_from_data(STUDY, source="a test"))


def card(client, **study):
    """The reply of the page with a card of the default study, changed."""
    return client.post("/api/card", json={"study": STUDY | study})


@pytest.fixture(scope="module")
def report(client):
    """The report of the first sensor of the default study, as the page gives it."""
    reply = client.post("/api/report", json={"study": ALONE})
    assert reply.headers["content-type"].startswith("text/html")
    assert reply.headers["content-disposition"] == "attachment"
    return reply.content


def reported(folder, text, monkeypatch):
    """The file that the command writes in a folder with this study."""
    monkeypatch.chdir(folder)
    (folder / "study.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SystemExit) as stop:
        run_command(["report", "study.toml", "-o", "report.html"])
    assert stop.value.code == 0
    return (folder / "report.html").read_bytes()


def test_a_csv_has_the_digits_of_the_library_in_the_view_of_the_page(client, of):
    look = {"coordinate": "Z", "plane": "xy", "theme": "dark"}
    for part in ("budget", "ellipses"):
        reply = client.post("/api/csv", json={"study": STUDY, "look": look, "part": part})
        assert reply.headers["content-type"].startswith("text/csv")
        record = drawing(part, of, Look(coordinate="Z", plane="xy"))
        assert reply.text == chart_csv(part, record)


@pytest.mark.parametrize(
    ("question", "status"),
    [({"part": "pie"}, 400), ({"part": 3}, 400), ({"part": "map"}, 200), ({"study": []}, 400)],
)
def test_a_csv_of_a_chart_without_numbers_is_refused_in_one_sentence(client, question, status):
    sentence_of(client.post("/api/csv", json={"study": STUDY, "part": "head"} | question), status)


@pytest.mark.evidence
def test_the_report_of_the_page_is_that_of_the_command_also_of_dropped_files(
    client, tmp_path, monkeypatch
):
    dropped = {"X-Filename": "my curves.csv"} | FILE
    upload = client.post("/api/upload", content=CAMERA_CSV, headers=dropped).json()["id"]
    study = {"sensors": [{"name": upload}], "pictures": [{"cube": "builtin:checker"}]}
    text = client.post("/api/texts", json={"study": study}).json()["toml"]
    (tmp_path / "my curves.csv").write_text(CAMERA_CSV)
    page = client.post("/api/report", json={"study": study}).content
    assert page == reported(tmp_path, text, monkeypatch)
    assert b"my curves.csv" in page
    assert upload.split(":")[1].encode() not in page


@pytest.mark.evidence
def test_the_card_of_the_page_is_that_of_the_library_for_the_study_that_is_shown(client):
    study = ALONE | {"light": {"illuminant": "A", "level_lux": 20.0}, "matrices": ["lmmse"]}
    reply = card(client, **study)
    assert reply.headers["content-type"] == "application/pdf"
    assert reply.headers["content-disposition"] == "attachment"
    answer = client.post("/api/answer", json={"study": STUDY | study, "want": []}).json()
    assert reply.headers["x-chromanoise-hash"] == answer["hash"]
    own = card_of(shown(study_from_data(STUDY | study, source="a test"))).content("pdf")
    assert reply.content == own


def test_a_card_of_more_sensors_than_it_holds_is_refused_with_the_limit(client):
    told = card(client, sensors=[{"name": "onyx-rgb"}] * (MOST_ON_CARD + 1)).json()["faults"]
    assert [one["where"] for one in told] == ["sensors"]
    assert f"at most {MOST_ON_CARD} on a card" in told[0]["sentence"]


def test_a_report_of_a_wrong_study_is_refused_with_the_key(client):
    reply = client.post("/api/report", json={"study": {"sensors": [{"name": "no-such-sensor"}]}})
    assert sentence_of(reply, 200)
    assert reply.json()["faults"][0]["where"] == "sensors.0.name"


def read_by_key(page, part, *keys):
    """The words beside the mark that keys reach, a pair of heading and value each."""
    figure = page.locator(f"section[data-part={part}] svg.d-figure").first
    figure.focus()
    for key in keys:
        page.keyboard.press(key)
    return told(page)


def told(page):
    page.locator(".d-tip").wait_for()
    return page.locator(".d-tip").inner_text().splitlines()


def as_told(table, row, columns=None):
    """A row of a table in the words of `told`."""
    columns = range(len(table["head"])) if columns is None else columns
    return [f"{table['head'][i]}: {table['rows'][row][i]}" for i in columns]


@pytest.mark.evidence
def test_values_are_read_by_key_pointer_and_touch_as_the_table_has_them(window, of):
    page = window({"study": STUDY, "look": {}})
    levels, stages, budget = (
        as_data(drawing(part, of))["table"] for part in ("levels", "stages", "budget")
    )
    keys = ("Home", "ArrowRight", "ArrowRight", "ArrowDown")
    assert read_by_key(page, "levels", *keys) == as_told(levels, 2, (0, 2))
    assert page.locator(".d-unseen").inner_text() == ", ".join(as_told(levels, 2, (0, 2)))
    page.keyboard.press("Escape")
    assert not page.locator(".d-tip").is_visible()
    found = read_by_key(page, "stages", "Home", "ArrowDown", "ArrowRight")
    assert found == as_told(stages, 1, (0, 1, 3))
    assert read_by_key(page, "budget", "Home", "ArrowDown") == as_told(budget, 1)
    assert read_by_key(page, "vectors", "Enter")[0] == "sensor: onyx-rgbw"
    assert page.evaluate("document.activeElement.matches('.d-turning')")
    ring = page.locator(".d-ring").bounding_box()
    page.mouse.move(ring["x"] + 8, ring["y"] + 8)
    tip = page.locator(".d-tip").bounding_box()
    page.mouse.move(tip["x"] + 5, tip["y"] + 5, steps=4)  # onto the words, which stay
    page.wait_for_timeout(400)
    assert page.locator(".d-tip").is_visible()
    page.mouse.move(2, 2)
    page.locator(".d-tip").wait_for(state="hidden")


@pytest.mark.evidence
def test_a_touch_reads_a_value_within_the_window(window, of):
    page = window(
        {"study": STUDY, "look": {}}, viewport={"width": 390, "height": 844}, has_touch=True
    )
    chart = page.locator("section[data-part=chart] svg.d-figure")
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    page.touchscreen.tap(box["x"] + box["width"] - 20, box["y"] + 20)  # the sixth patch
    assert told(page) == as_told(drawing("chart", of).table, 5)
    tip = page.locator(".d-tip").bounding_box()
    assert tip["x"] >= 0
    assert tip["x"] + tip["width"] <= 390
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.touchscreen.tap(5, 5)
    page.locator(".d-tip").wait_for(state="hidden")


def saved(page, within, item):
    """The name and the bytes of what an item of a menu saves."""
    page.locator(f"{within} .d-save > button").first.click()
    with page.expect_download() as caught:
        page.locator(f"{within} .d-menu button", has_text=item).first.click()
    page.locator(f"{within} .d-menu").first.wait_for(state="hidden")
    with open(caught.value.path(), "rb") as file:  # noqa: PTH123
        return caught.value.suggested_filename, file.read()


def size_of(png):
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    assert png[37:41] == b"pHYs"
    return struct.unpack(">II", png[16:24])


def stands_alone(text):
    """An SVG: its root, without classes, variables, styles and references."""
    root = ElementTree.fromstring(text)
    assert root.tag == f"{SVG}svg"
    assert not re.search(rb"var\(|url\(|href|class=|style=|<script|@import", text)
    assert len(root.findtext(f"{SVG}title")) > 10
    return root


@pytest.mark.evidence
def test_every_chart_is_saved_as_svg_png_and_csv(window, of):
    study = STUDY | {"sweeps": [SWEEP]}
    page = window({"study": study, "look": {}}, color_scheme="dark")
    page.locator("section[data-part=map]").scroll_into_view_if_needed()
    page.locator(".d-map").wait_for()
    at_rest(page)
    short = page.evaluate("document.documentElement.dataset.hash").encode()[:8].decode()
    for part in (*CHARTS, "map"):
        panel = f"section[data-part={part}]"
        name, text = saved(page, panel, "SVG")
        assert name == f"chromanoise-{part}-{short}.svg"
        root = stands_alone(text)
        words = {one.text: one for one in root.iter(f"{SVG}text")}
        own = page.locator(f"{panel} svg.d-figure text.d-strong").all_text_contents()
        assert set(own[:1]) <= words.keys()
        caption = page.locator(f"{panel} .d-caption").inner_text()
        assert caption in root.findtext(f"{SVG}title")
        assert short.encode() in text
        assert b'fill="#ffffff"' in text
        ink = re.findall("[0-9]+", words[caption].get("fill"))
        assert sum(map(int, ink)) < 3 * 128  # not that of the dark screen
        name, data = saved(page, panel, "CSV")
        assert name == f"chromanoise-{part}-{short}.csv"
        if part != "map":
            assert data.decode() == chart_csv(part, drawing(part, of))
        if part in ("stages", "map"):
            name, png = saved(page, panel, "PNG")
            assert size_of(png) == tuple(
                round(int(root.get(side)) * 300 / 96) for side in ("width", "height")
            )
    assert data.decode().count("\n") == 1 + 4 * 3


@pytest.mark.evidence
def test_a_channel_whose_name_has_a_control_character_is_saved(client, window):
    curves = CAMERA_CSV.replace(",R,", ",R\x01\x1b[1m,", 1)
    dropped = {"X-Filename": "odd.csv"} | FILE
    upload = client.post("/api/upload", content=curves, headers=dropped).json()["id"]
    page = window({"study": STUDY | {"sensors": [{"name": upload}]}, "look": {}})
    root = stands_alone(saved(page, "section[data-part=stages]", "SVG")[1])
    assert any("R\ufffd\ufffd[1m" in (one.text or "") for one in root.iter(f"{SVG}text"))


@pytest.mark.evidence
def test_pictures_and_their_divided_view_are_saved(window):
    page = window({"study": STUDY, "look": {}})
    page.locator("section[data-part=picture]").scroll_into_view_if_needed()
    image = page.locator("section[data-part=picture] img")
    image.nth(1).wait_for()
    until(page, "() => document.querySelector('.d-stack img').naturalWidth > 0")
    page.get_by_label("Zoom").select_option("2")
    width, height, shown = image.first.evaluate(
        "(one) => [one.naturalWidth, one.naturalHeight, one.closest('.d-stack').offsetWidth]"
    )
    for item, across in (("onyx-rgbw, noisy", width), ("as divided", shown // 2)):
        name, png = saved(page, "section[data-part=picture]", item)
        assert name.startswith("chromanoise-picture-")
        assert struct.unpack(">II", png[16:24]) == (across, height)


@pytest.mark.evidence
def test_the_report_is_saved_from_the_page_and_its_charts_from_the_report(
    window, browser, report, tmp_path
):
    page, of = window({"study": ALONE, "look": {}}), shown(study_from_data(ALONE, source="a test"))
    with page.expect_download() as caught:
        page.get_by_role("button", name="Save report").click()
    path = tmp_path / "report.html"
    caught.value.save_as(path)
    assert re.fullmatch("chromanoise-report-[0-9a-f]{8}[.]html", caught.value.suggested_filename)
    assert path.read_bytes() == report
    wrong = []

    def opened():
        tab = browser({"viewport": {"width": 1280, "height": 900}}).new_page()
        tab.on("console", lambda one: wrong.append(one.text))
        tab.goto(path.as_uri())
        tab.locator("section[data-part=levels] svg.d-figure").wait_for()
        return tab

    for some in (CHARTS[:4], CHARTS[4:]):  # Chromium holds back a page's eleventh download
        tab = opened()
        for part in some:
            stands_alone(saved(tab, f"section[data-part={part}]", "SVG")[1])
            _, data = saved(tab, f"section[data-part={part}]", "CSV")
            assert data.decode() == chart_csv(part, drawing(part, of))
        tab.close()
    tab = opened()
    size_of(saved(tab, "section[data-part=levels]", "PNG")[1])
    table = drawing("levels", of).table
    assert read_by_key(tab, "levels", "Home", "ArrowRight") == as_told(table, 1, (0, 1))
    tab.locator("#slide-0").focus()
    tab.keyboard.press("ArrowLeft")
    until(tab, "() => !document.getElementById('back').disabled")
    tab.locator("section[data-part=stages] .d-save > button").click()
    tab.locator("section[data-part=stages] .d-menu button", has_text="CSV").click()
    until(
        tab, "() => document.querySelector('[data-part=stages] .d-menu p').textContent.length > 20"
    )
    tab.close()
    assert wrong == []


@pytest.mark.evidence
def test_the_card_is_saved_from_the_page_under_the_hash_of_its_study(window):
    page = window({"study": ALONE, "look": {}})
    short = page.evaluate("document.documentElement.dataset.hash")[:8]
    with page.expect_download() as caught:
        page.get_by_role("button", name="Save card").click()
    assert caught.value.suggested_filename == f"chromanoise-card-{short}.pdf"
    with open(caught.value.path(), "rb") as file:  # noqa: PTH123
        assert file.read(5) == b"%PDF-"
    until(page, "() => document.getElementById('copied').textContent === 'The card was saved.'")


@pytest.mark.parametrize("name", ["report", "card"])
def test_a_file_that_cannot_be_made_is_refused_in_one_sentence(window, name):
    page = window({"study": STUDY, "look": {}})
    fault = {"faults": [{"where": "", "sentence": "Not today."}]}
    page.route(f"**/api/{name}", lambda route: route.fulfill(json=fault))
    page.get_by_role("button", name=f"Save {name}").click()
    until(page, "() => document.getElementById('copied').textContent === 'Not today.'")


@pytest.mark.evidence
def test_axe_finds_no_fault_in_an_open_menu_and_beside_a_mark(window, axe):
    page = window({"study": STUDY, "look": {}})
    panel = "section[data-part=levels]"
    read_by_key(page, "levels", "ArrowRight")
    assert faults_of_access(page, axe, RULES) == []
    opener = page.locator(f"{panel} .d-save > button")
    opener.focus()
    page.keyboard.press("Enter")
    assert page.locator(f"{panel} .d-menu").is_visible()
    assert faults_of_access(page, axe, [*RULES], within=panel) == []
    page.keyboard.press("Escape")
    assert opener.get_attribute("aria-expanded") == "false"
    assert opener.evaluate("(node) => node === document.activeElement")


@pytest.mark.evidence
def test_the_code_that_saves_is_loaded_when_it_is_used(window):
    page = window({"study": STUDY, "look": {}}, wait=False)
    loaded = []
    page.on("request", lambda one: loaded.append(one.url))
    page.reload()
    at_rest(page)
    assert not [url for url in loaded if url.endswith("draw/export.js")]
    rows = list(
        csv.reader(io.StringIO(saved(page, "section[data-part=levels]", "CSV")[1].decode()))
    )
    assert rows[0][0] == "illuminance [lx]"
    assert [url for url in loaded if url.endswith("draw/export.js")]


def folder_of(tmp_path, monkeypatch, files):
    """An empty folder for a report, and the study files of a served folder beside it."""
    served, empty = tmp_path / "served" / "here", tmp_path / "empty"
    served.mkdir(parents=True)
    empty.mkdir()
    for name, text in files.items():
        (served / name).write_text(text)
    monkeypatch.chdir(served)
    return empty


@pytest.mark.evidence
@pytest.mark.usefixtures("plain_report")
def test_no_file_of_a_study_is_written_by_its_report(tmp_path, monkeypatch):
    pixel = 'schema = "chromanoise pixel"\nschema_version = 1\nread_noise_e = 2.4\n'
    files = {"study.toml": pixel, "../a.csv": CAMERA_CSV}
    empty = folder_of(tmp_path, monkeypatch, files)
    sensors = [{"name": "onyx-rgbw", "pixel": {"file": "study.toml"}}, {"name": "../a.csv"}]
    studies = Studies(Kept(), files=frozenset(files))
    html, _ = report_reply(studies, {"study": {"sensors": sensors}}, empty)
    assert "../a.csv" in html
    assert (tmp_path / "served" / "here" / "study.toml").read_text() == pixel
    assert {one.name for one in tmp_path.iterdir()} == {"served", "empty"}


def test_two_files_of_one_name_are_refused(tmp_path, monkeypatch):
    empty = folder_of(tmp_path, monkeypatch, {"a.csv": CAMERA_CSV})
    other = tmp_path / "0123.csv"
    other.write_text(CAMERA_CSV.replace("0.4", "0.5"))
    kept, dropped = Kept(), f"upload:{'0' * 16}.csv"
    kept.hold((Upload(id=dropped, label="a.csv", path=other, kind="table", size_bytes=1),))
    studies = Studies(kept, files=frozenset({"a.csv"}))
    question = {"study": {"sensors": [{"name": "a.csv"}, {"name": dropped}]}}
    with pytest.raises(QuestionError, match=r"a\.csv must name one file"):
        report_reply(studies, question, empty)


def test_the_folder_of_a_job_goes_even_after_all_others():
    uploads = Uploads()
    with uploads.empty_folder() as folder:
        (folder / "d").mkdir()
        (folder / "d" / "a.csv").write_text("1")
    assert not folder.exists()
    with uploads.empty_folder() as folder:
        uploads.close()  # the server ends
    assert not folder.exists()


@pytest.mark.evidence
def test_a_label_is_words_at_the_pointer_in_saved_files_and_in_the_report(
    window, browser, tmp_path
):
    label = '=<img src=x onerror=alert(1)> & "q" $x_\''
    study = STUDY | {"sensors": [{"name": "onyx-rgb-ircut", "label": label}]}
    sweeps = [SWEEP | {"second": None}, SWEEP]
    page = window({"study": study | {"sweeps": sweeps}, "look": {"open": ["stages"]}})
    assert f"sensor: {label}" in read_by_key(page, "budget", "Home")
    page.keyboard.press("Escape")
    panel = "section[data-part=budget]"
    root = stands_alone(saved(page, panel, "SVG")[1])
    assert label in {one.text for one in root.iter(f"{SVG}text")}
    size_of(saved(page, panel, "PNG")[1])
    _, *rows = csv.reader(io.StringIO(saved(page, panel, "CSV")[1].decode()))
    assert rows[0][0] == f"'{label}"
    with page.expect_download() as caught:
        page.get_by_role("button", name="Save report").click()
    caught.value.save_as(tmp_path / "report.html")
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    short = re.search('data-hash="([0-9a-f]{8})', html).group(1)
    assert caught.value.suggested_filename == f"chromanoise-report-{short}.html"
    tab = browser({"viewport": {"width": 1280, "height": 900}}).new_page()
    wrong = []
    tab.on("console", lambda one: wrong.append(one.text))
    tab.on("dialog", lambda one: (wrong.append(one.message), one.dismiss()))
    tab.goto((tmp_path / "report.html").as_uri())
    tab.locator("section[data-part=levels] svg.d-figure").wait_for()
    for part, ending in (("sweeps", "SVG"), ("map", "PNG")):
        name, data = saved(tab, f"section:has(> #h-{part})", ending)
        assert name.endswith(ending.lower())
        assert data.startswith(b"\x89PNG" if ending == "PNG" else b"<?xml")
    assert page.locator("[onerror]").count() == tab.locator("[onerror]").count() == 0
    tab.close()
    assert wrong == []


@pytest.mark.usefixtures("plain_report")
def test_a_report_shows_a_repeated_sensor_as_the_page_does(tmp_path):
    study = {"sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgbw"}]}
    html, _ = report_reply(Studies(Kept()), {"study": study}, tmp_path)
    assert "onyx-rgbw (2)" in html
