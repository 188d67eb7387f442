"""What comes into the page and goes out of it: files, links, texts; and a server that goes away."""

import base64
import io
import json
import os
import subprocess
import sys

import numpy as np
import pytest

from served_page import served, stopped
from shells.browser import answer_to, at_rest, framed, packed, shown, state_of, study_of, until
from spectrum_samples import CAMERA_CSV

STUDY = {
    "light": {"illuminant": "E+0.25xLED850", "level_lux": 3.3},
    "exposure": {"f_number": 2.2, "equal": "saturation"},
    "sensors": [{"name": "onyx-rgbw", "ircut_nm": 700.0}, {"name": "model-rgbir"}],
    "matrices": ["noise-regularized=2"],
}
LAMP = "wavelength_nm,power_W\n" + "\n".join(f"{nm},{1 + nm / 1000}" for nm in range(400, 1051, 10))
TOML = '[light]\nlevel_lux = 2.5\n[[sensors]]\nname = "onyx-rgb"\n[[sensors]]\nname = "onyx-rgbw"\n'


def bring(page, name, content):
    """Choose a file, and wait for what is said of it."""
    if isinstance(content, str):
        content = content.encode()
    file = {"name": name, "mimeType": "application/octet-stream", "buffer": content}
    page.locator("#file").set_input_files(file)
    until(
        page,
        "() => document.querySelector('.brought').textContent !== ''"
        " && !document.querySelector('.brought').textContent.startsWith('Reading')",
    )
    return page.locator(".brought")


def test_a_dropped_sensor_is_understood_and_takes_part_under_its_name(window):
    page = window()
    brought = bring(page, "my sensor.csv", CAMERA_CSV)
    assert "R, G, B" in brought.inner_text()
    for select in brought.locator("select").all():
        select.select_option(index=1)
    add = brought.get_by_role("button", name="Add as a sensor")
    question, _ = answer_to(page, add.click)
    assert question["study"]["sensors"][2]["name"].startswith("upload:")
    assert page.locator("#electrons tbody th > span").all_inner_texts()[2] == "my sensor"
    assert "read noise are assumed" in page.locator("#electrons tbody th").nth(2).inner_text()
    assert (
        page.get_by_label("Sensor 3").locator("option:checked").inner_text().startswith("my sensor")
    )


def test_a_dropped_lamp_becomes_the_light(window):
    page = window()
    brought = bring(page, "lamp.csv", LAMP)
    before = shown(page)
    _, parts = answer_to(page, brought.get_by_role("button", name="Use as the light").click)
    assert parts["numbers"]["light"]["name"].startswith("lamp")
    assert shown(page) != before


@pytest.mark.evidence
def test_a_dropped_study_is_told_first_and_shown_when_it_is_opened(window):
    page = window()
    before = page.url
    brought = bring(page, "mine.toml", TOML)
    assert "onyx-rgb, onyx-rgbw in E at 2.5 lx" in brought.inner_text()
    assert page.url == before
    brought.get_by_role("button", name="Open this study").focus()
    answer_to(page, lambda: page.keyboard.press("Enter"))
    assert page.locator("#electrons tbody th").all_inner_texts() == ["onyx-rgb", "onyx-rgbw"]
    assert "2.5 lx" in page.locator("#verdict").inner_text()


@pytest.mark.evidence
def test_every_fault_of_a_dropped_study_is_a_sentence_of_its_own(window):
    page = window()
    brought = bring(page, "a.toml", TOML.replace("2.5", "-2.5") + "shift_nm = 900\n")
    assert brought.get_by_role("alert").locator("p").count() == 2
    brought = bring(page, "b.toml", TOML.replace("onyx-rgb", "nobody"))
    wrong = [line for line in brought.locator("li").all_inner_texts() if "Looks wrong" in line]
    assert ["sensors.0.name" in wrong[0], "sensors.1.name" in wrong[1]] == [True, True]


DROP = """([name, content]) => {
    const bytes = Uint8Array.from(atob(content), (letter) => letter.charCodeAt(0));
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([bytes], name));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
}"""


@pytest.mark.evidence
def test_a_cube_dropped_on_the_page_says_what_it_leaves_open_and_becomes_the_picture(window):
    page = window()
    packed_cube = io.BytesIO()
    bands_nm = np.arange(400.0, 701.0, 50.0)
    np.savez(packed_cube, reflectance=np.full((5, 9, bands_nm.size), 0.4), wavelength_nm=bands_nm)
    page.evaluate(DROP, ["leaf.npz", base64.b64encode(packed_cube.getvalue()).decode()])
    brought = page.locator(".brought")
    show = brought.get_by_role("button", name="Show in the picture")
    show.wait_for()
    assert "5 x 9 pixels, 7 bands from 400 to 700 nm" in brought.inner_text()
    show.click()
    assert "please choose" in brought.locator(".fault").inner_text()
    brought.get_by_label("its bands end at 700 nm").select_option("zero")
    show.click()
    until(page, "() => document.querySelector('[data-part=picture] img')?.naturalWidth === 9")
    (picture,) = study_of(page)["pictures"]
    assert picture["beyond"] == "zero"
    ends = page.get_by_label("Outside the cube's wavelength range")
    assert ends.locator("option:checked").inner_text() == "black"


@pytest.mark.evidence
def test_a_dropped_file_is_called_by_its_name_in_another_window_and_missed_on_another_server(
    window,
):
    page = window()
    brought = bring(page, "lamp.csv", LAMP)
    answer_to(page, brought.get_by_role("button", name="Use as the light").click)
    other = window(page.url.partition("#")[2])
    light = other.get_by_label("Light", exact=True)
    assert light.locator("option:checked").inner_text() == "lamp.csv (your file)"
    other.locator("#keep").click()
    name = other.get_by_label("Name of this pin")
    name.wait_for()
    assert "lamp.csv" in name.input_value()
    with served() as (elsewhere, _):
        there = window(page.url.partition("#")[2], at=elsewhere, wait=False)
        result = there.locator(".row", has=there.get_by_label("Light", exact=True)).locator(
            ".fault"
        )
        result.wait_for()
        assert "drop the file again" in result.inner_text()
        assert "upload:" not in there.locator("body").inner_text()
        there.close()  # before its server ends, so that it misses nobody


def array_file():
    content = io.BytesIO()
    np.save(content, np.full((5, 6, 66), 0.5))
    return content.getvalue()


UNREADABLE = [
    (
        "bands.npy",
        array_file(),
        "the page has no control for wavelengths",
    ),
    ("junk.csv", b"\x00\xff\x13" * 700, ""),
    ("empty.csv", b"", "empty"),
    ("page.exe", b"MZ", ""),
    ("huge.csv", b"x" * 12_000_001, "The limit is 12 MB"),
    ("study.toml", b"[[sensors]]\nnam = 3\n", "study.toml:2"),
    ("<img src=x onerror=alert(1)>.csv", b"1;2", "<img"),
    ("..\\..\\evil%2F..%2Fpasswd.csv", b"a,b\n1,x\n", ""),
]


@pytest.mark.evidence
def test_a_file_that_cannot_be_read_is_told_beside_the_field_and_changes_nothing(window, watch):
    watch.forgive("status of 400")
    page = window()
    before = shown(page)
    for name, content, result in UNREADABLE:
        page.evaluate("document.querySelector('.brought').textContent = ''")
        brought = bring(page, name, content)
        sentence = brought.get_by_role("alert").inner_text()
        assert result in sentence
        assert 20 < len(sentence) < 600
        assert "Traceback" not in sentence
        assert "/tmp" not in sentence
        assert brought.locator("img").count() == 0
        assert shown(page) == before


@pytest.mark.evidence
def test_a_link_shows_the_same_study_and_the_same_numbers_in_another_window(window):
    one = window({"study": STUDY, "look": {"plane": "xy", "open": ["stages"]}})
    one.context.grant_permissions(["clipboard-read", "clipboard-write"])
    one.get_by_role("button", name="Copy as Link").click()
    one.get_by_text("Link copied").wait_for()
    link = one.evaluate("navigator.clipboard.readText()")
    other = window(link.partition("#")[2])
    at_rest(one)
    assert shown(other) == shown(one)
    assert state_of(other)["study"] == STUDY
    assert other.locator("#hash").inner_text() == one.locator("#hash").inner_text()
    table = "[data-part=stages] .table"
    assert other.locator(table).inner_text() == one.locator(table).inner_text()


def copied(page, kind):
    """The text that a button copies; without a clipboard the page offers it to be selected."""
    page.get_by_role("button", name=f"Copy as {kind}").click()
    area = page.get_by_role("dialog").locator("textarea")
    area.wait_for()
    text = area.input_value()
    page.keyboard.press("Escape")
    area.wait_for(state="hidden")
    return text


NO_CLIPBOARD = """Object.defineProperty(navigator, "clipboard", {
    value: { writeText: () => Promise.reject(new Error("not allowed")) } })"""


@pytest.mark.evidence
def test_the_copied_study_and_the_copied_command_give_the_digits_of_the_page(window, tmp_path):
    page = window({"study": STUDY, "look": {}})
    page.evaluate(NO_CLIPBOARD)
    (tmp_path / "study.toml").write_text(copied(page, "TOML"), encoding="utf-8")
    command = copied(page, "Command")
    (tmp_path / "study.py").write_text(copied(page, "Python"), encoding="utf-8")
    page.get_by_role("button", name="Table: SNR from raw to color").click()
    table = page.get_by_role("region", name="Table: SNR from raw to color").inner_text()
    drawn = {tuple(row.split("\t")) for row in table.splitlines()}
    digest = page.locator("#hash").inner_text().split()[-1]
    program = tmp_path / "chromanoise"
    script = "from chromanoise.cli import main; main()"
    program.write_text(f"#!/bin/sh\nexec {sys.executable} -c '{script}' \"$@\"\n")
    program.chmod(0o755)
    ways = ("chromanoise run study.toml --out told", command)
    answers = [run_in_shell(way, tmp_path) for way in ways]
    assert all(answer["hash"].startswith(digest) for answer in answers)
    script = [sys.executable, str(tmp_path / "study.py")]
    printed = subprocess.run(script, cwd=tmp_path, capture_output=True, text=True, check=True)
    results = [*(answer["result"] for answer in answers), json.loads(printed.stdout)[0]]
    for result in results:
        rgbw, rgbir = result["sensors"]
        for kind in ("color", "bound", "price", "spectral"):
            for row in rows_of(kind, rgbw, rgbir):
                assert row in drawn


def run_in_shell(command, folder):
    """What one command line writes as its analysis."""
    path = f"{folder}:{os.environ['PATH']}"
    subprocess.run(
        ["sh", "-c", command],
        cwd=folder,
        check=True,
        capture_output=True,
        env=os.environ | {"PATH": path},
    )
    (found,) = folder.rglob("analysis-*.json")
    answer = json.loads(found.read_text(encoding="utf-8"))
    found.unlink()
    return answer


def rows_of(kind, *sensors):
    """Rows of the page's table as the numbers of a run would make them."""
    if kind == "color":
        values = {name: [one["color"]["snr_db"][name] for one in sensors] for name in "XYZ"}
    elif kind == "spectral":
        values = {"spectrum": [one["spectral_snr_db"] for one in sensors]}
    else:
        values = {"Y": [one[f"{kind}_db"] for one in sensors]}
    title = {"bound": "bound", "price": "color SNR loss"}.get(kind, f"{kind} SNR") + " [dB]"
    return [(title, name, *(f"{value:.1f}" for value in pair)) for name, pair in values.items()]


BROKEN = ["%%%", "bm9wZQ", "e30", packed({"study": {"sensors": []}}), packed([1]), "a" * 9999]


@pytest.mark.evidence
def test_a_broken_link_is_told_in_a_sentence_over_the_default_study(window):
    page = window(BROKEN[0])
    result = page.locator("#broken")
    for i, broken in enumerate(BROKEN):
        if i > 0:  # followed in the same window, from a study that is whole
            page.evaluate("(hash) => (location.hash = hash)", packed({"study": STUDY}))
            result.wait_for(state="hidden")
            page.get_by_role("rowheader", name="model-rgbir").first.wait_for()
            page.evaluate("(hash) => (location.hash = hash)", broken)
            result.wait_for()
            page.get_by_role("rowheader", name="onyx-rgb-ircut").first.wait_for()
        sentence = result.inner_text()
        assert sentence.startswith("This link")
        assert sentence.endswith("the default study is shown.")
        assert page.locator("#electrons tbody tr").count() == 2
    select = page.get_by_label("Color matrix")
    answer_to(page, lambda: select.select_option("white-preserving"))


@pytest.mark.evidence
def test_two_windows_with_different_studies_do_not_mix(window):
    one = window({"study": STUDY | {"light": {"level_lux": 2.0}}, "look": {}})
    two = window({"study": STUDY | {"light": {"level_lux": 200.0}}, "look": {}})
    tracks = [page.get_by_label("f-number", exact=True) for page in (one, two)]
    for track in tracks:
        track.focus()
    for _ in range(5):
        one.keyboard.press("ArrowUp")
        two.keyboard.press("ArrowDown")
    seen = []
    for page, level in ((one, 2.0), (two, 200.0)):
        framed(page)
        number = page.get_by_label("f-number, as a number").input_value()
        fields = "[...document.querySelectorAll('#electrons td[data-key=f_number]')]"
        until(page, f"(f) => {fields}.every((one) => Number(one.textContent) === f)", float(number))
        page.wait_for_url(lambda _, n=float(number): study_of(page)["exposure"]["f_number"] == n)  # noqa: B023
        assert study_of(page)["light"]["level_lux"] == level
        assert f"At {level:g} lx " in page.locator("#verdict").inner_text()
        seen.append(float(number))
    assert seen[0] > 2.2 > seen[1]


@pytest.mark.evidence
def test_a_server_that_stops_is_told_in_one_sentence_until_it_is_back(window, watch):
    watch.forgive("ERR_CONNECTION_REFUSED|ERR_EMPTY_RESPONSE|ERR_CONNECTION_RESET")
    with served() as (where, process):
        page = window(at=where)
        stopped(process)
        page.get_by_label("f-number", exact=True).focus()
        page.keyboard.press("Shift+ArrowUp")
        lost = page.locator("#lost")
        lost.wait_for(state="visible")
        assert "does not answer" in lost.inner_text()
        assert page.get_by_role("alert").filter(visible=True).count() == 1
        page.keyboard.press("Shift+ArrowUp")
        framed(page)
        field = page.get_by_label("f-number, as a number").input_value()
        with served(port=where.rstrip("/").rpartition(":")[2]):
            lost.wait_for(state="hidden")
            until(
                page,
                "(f) => document.querySelector('[data-key=f_number]').textContent === f",
                field,
            )


@pytest.mark.evidence
def test_in_a_narrow_window_a_dropped_file_opens_the_sheet_with_its_report(window):
    page = window(viewport={"width": 700, "height": 800})
    assert page.locator(".brought").is_hidden()
    page.evaluate(DROP, ["lamp.csv", base64.b64encode(LAMP.encode()).decode()])
    page.locator(".brought").get_by_role("button", name="Use as the light").wait_for()
