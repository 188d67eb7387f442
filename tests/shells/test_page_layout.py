"""What stands where on the page: first screen, order of the panels, the sheet, the ranking."""

import pytest

from chromanoise.charts import drawing, shown
from chromanoise.charts.registry import SECTIONS
from chromanoise.study import study_from_data
from dear import dear
from shells.browser import at_rest, pressed, typed, until
from shells.test_page_looks import axe, faults_of_access

__all__ = ["axe"]


MANY = [
    *("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut", "model-rgbir"),
    *("model-rgb-ircut", "model-cmy", "mt9v024-rgb", "mt9v024-mono", "gsense4040bsi"),
]
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True}


def study_with(names):
    return {"sensors": [{"name": name} for name in names], "light": {"level_lux": 10.0}}


def box(page, selector):
    """Left, top, right and bottom of the first match in the window."""
    return page.locator(selector).first.evaluate(
        "(n) => { const b = n.getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; }"
    )


@pytest.mark.evidence
def test_the_first_screen_has_verdict_pictures_exposure_and_a_place_to_drop_a_file(window):
    page = window(viewport={"width": 1280, "height": 800})
    until(page, "() => document.querySelector('[data-part=picture] img')?.naturalWidth > 0")
    page.wait_for_timeout(100)
    for what in ("#verdict", "#reasons", ".d-stack", ".d-captions"):
        left, top, right, bottom = box(page, what)
        assert 0 <= left < right <= 1280, what
        assert 0 <= top < bottom <= 800, what
    for label in ("Light level", "Exposure time", "f-number"):
        place = page.get_by_label(label, exact=True).bounding_box()
        assert place["y"] + place["height"] <= 800, label
    _, top, _, bottom = box(page, "label.drop")
    assert 0 <= top < bottom <= 300
    verdict = page.locator("#verdict").evaluate(
        "(n) => n.getBoundingClientRect().height / parseFloat(getComputedStyle(n).lineHeight)"
    )
    assert verdict <= 2
    assert page.evaluate("scrollY") == 0


@pytest.mark.evidence
def test_the_panels_have_order_headings_and_captions_of_the_sections(window):
    page = window()
    told = page.locator("main > section.panel").evaluate_all(
        """(all) => all.map((one) => [one.dataset.part,
            one.querySelector("h2").textContent, one.querySelector(".shows").textContent,
            one.querySelector("button.equation").dataset.equation.split(" "),
            document.getElementById(one.getAttribute("aria-labelledby")) ===
                one.querySelector("h2")])"""
    )
    expected = [
        [one.part, one.heading, one.shows, list(one.explanations), True] for one in SECTIONS
    ]
    assert told == expected


@pytest.mark.evidence
def test_the_first_two_reasons_are_shown_and_a_button_shows_all(window):
    page = window()
    reasons = page.locator("#reasons li")
    hidden = reasons.count() - 2
    assert hidden > 1
    assert [one.is_visible() for one in reasons.all()] == [True, True, *[False] * hidden]
    more = page.locator("#more")
    more.press("Enter")
    assert all(one.is_visible() for one in reasons.all())
    assert more.get_attribute("aria-expanded") == "true"
    more.press("Enter")
    assert not reasons.last.is_visible()


@pytest.mark.evidence
def test_the_table_of_the_sensors_has_the_ranking_and_is_sorted_by_keyboard(window):
    page = window({"study": study_with(MANY), "look": {}})
    ranking = drawing("head", shown(study_from_data(study_with(MANY), source="")))["ranking"]
    names = page.locator("#electrons tbody th > span")
    assert names.all_inner_texts() == MANY
    assert page.locator("#electrons tbody td[data-key=rank]").all_inner_texts() == [
        row["text"][0] for row in ranking["rows"]
    ]
    head = page.locator("button.sort[data-sort=luminance_db]")
    heads = page.locator("#electrons thead th")

    def sorts():
        return [one for one in heads.evaluate_all("(a) => a.map((n) => n.ariaSort)") if one]

    assert set(sorts()) == {"none"}
    head.focus()
    page.keyboard.press("Enter")
    values = {row["name"]: row["values"][2] for row in ranking["rows"]}
    best_first = sorted(MANY, key=lambda name: -values[name])
    assert names.all_inner_texts() == best_first
    assert sorted(set(sorts())) == ["descending", "none"]
    assert page.evaluate("document.activeElement.dataset.sort") == "luminance_db"
    page.keyboard.press("Enter")
    assert names.all_inner_texts() == best_first[::-1]
    page.keyboard.press("Enter")
    assert names.all_inner_texts() == MANY


@pytest.mark.evidence
def test_what_is_assumed_of_a_pixel_stands_in_words_beside_the_name_of_its_sensor(window):
    page = window({"study": study_with(["mt9v024-rgb", "onyx-rgb"]), "look": {}})
    cells = page.locator("#electrons tbody th")
    sentence = "full well and read noise are assumed: 10,000 e\u207b, 10 e\u207b"
    assert cells.nth(0).locator("small").inner_text() == sentence
    assert cells.nth(1).locator("small").count() == 0
    assert "not given" not in page.locator("#electrons").inner_text()
    known = {"name": "mt9v024-rgb", "pixel": {"read_noise_e": 3.0}}
    page = window({"study": {"sensors": [known]}, "look": {}})
    assert page.locator("#electrons small").inner_text() == "full well is assumed: 10,000 e\u207b"


@pytest.mark.evidence
def test_a_pinned_number_is_beside_the_number_and_not_over_it(window):
    page = window()
    cell = page.locator("#electrons td[data-key=luminance_db]").first
    before = cell.inner_text()
    page.locator("#keep").click()
    page.get_by_label("Name of this pin").wait_for()
    assert cell.inner_text() == before
    typed(page, page.get_by_label("f-number, as a number"), "5.6")
    until(page, "() => document.querySelector('#electrons small')")
    assert cell.locator("small").inner_text().strip() == f"(was {before})"
    top, under = cell.evaluate(
        """(n) => [n.firstChild, n.querySelector("small")].map((one) => {
            const range = document.createRange();
            range.selectNode(one);
            const box = range.getBoundingClientRect();
            return [box.top, box.bottom];
        })"""
    )
    assert top[1] <= under[0] + 4
    assert (
        page.evaluate("[...document.querySelectorAll('#electrons s, #electrons del')].length") == 0
    )


@pytest.mark.evidence
def test_on_a_phone_a_sheet_holds_the_controls_and_leaves_verdict_and_picture_in_sight(window, axe):
    page = window(**PHONE)
    until(page, "() => document.querySelector('[data-part=picture] img')?.naturalWidth > 0")
    assert page.locator("#controls").is_hidden()
    assert box(page, "#verdict")[1] < box(page, ".d-stack")[1] < 844
    button = page.locator("#sheet")
    button.tap()
    sheet = box(page, "#study")
    assert sheet[3] - sheet[1] <= 0.45 * 844
    assert button.get_attribute("aria-expanded") == "true"
    for seen in ("#verdict", ".d-captions"):
        _, top, _, bottom = box(page, seen)
        assert 0 <= top < bottom <= sheet[1], seen
    verdict = page.locator("#verdict").inner_text()
    pressed(page, page.get_by_label("Light level", exact=True), "Shift+ArrowUp")
    assert page.locator("#verdict").inner_text() != verdict
    assert faults_of_access(page, axe) == []
    small = page.evaluate(
        """[...document.querySelectorAll("button, select, input:not([type=file]), summary")]
            .filter((n) => n.checkVisibility() && !n.closest(".d-stack"))
            .map((n) => [n.outerHTML.slice(0, 80), n.getBoundingClientRect()])
            .filter(([, box]) => Math.min(box.width, box.height) < 23.9)
            .map(([text]) => text)"""
    )
    assert small == []
    page.keyboard.press("Escape")
    assert page.locator("#study").is_hidden()
    assert page.evaluate("document.activeElement.id") == "sheet"
    page.locator("#menu").tap()
    assert page.get_by_role("button", name="Copy as Link").is_visible()
    assert faults_of_access(page, axe) == []
    for width in (320, 360, 390):
        page.set_viewport_size({"width": width, "height": 740})
        page.wait_for_function("width => document.documentElement.scrollWidth <= width", arg=width)


@pytest.mark.evidence
@pytest.mark.parametrize("scheme", ["light", *dear("dark")])
def test_axe_finds_no_fault_in_a_wide_window_with_ten_sensors(window, axe, scheme):
    size = {"width": 2560, "height": 1440}
    page = window({"study": study_with(MANY), "look": {}}, color_scheme=scheme, viewport=size)
    page.evaluate("document.querySelectorAll('details').forEach((node) => (node.open = true))")
    at_rest(page)
    assert faults_of_access(page, axe) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= 2560


@pytest.mark.evidence
@pytest.mark.parametrize("width", [360, *dear(390, 480)])
def test_a_tap_in_the_middle_of_each_button_of_a_phone_s_header_reaches_it(window, width):
    page = window(viewport={"width": width, "height": 844})
    for name in ("#tour", "#menu", "#more"):
        page.locator(name).click(trial=True)
    page.locator("#tour").click()
    page.locator("#sheet").click()
    page.locator("#study .track").first.click(trial=True)


@pytest.mark.evidence
def test_up_to_three_sensors_stand_side_by_side_in_every_chart_with_a_panel_for_each(window):
    names = MANY[:3]
    page = window({"study": study_with(names), "look": {}}, viewport={"width": 1280, "height": 800})
    for part in ("budget", "vectors", "ellipses", "sensitivities"):
        panel = page.locator(f"section[data-part={part}] .body")
        boxes = [panel.get_by_text(name, exact=True).last.bounding_box() for name in names]
        assert len({round(one["y"]) for one in boxes}) == 1, part
        assert boxes[0]["x"] < boxes[1]["x"] < boxes[2]["x"], part
    words = page.locator("section[data-part=budget] svg text").all_text_contents()
    assert not [text for text in words if text.endswith("\u2026")]


BEGINS = """(picture) => {
    const left = (node) => node.getBoundingClientRect().left;
    const [stack, divider] = [".d-stack", ".d-divider"].map((one) => picture.querySelector(one));
    const [first, second] = picture.querySelectorAll("img");
    const clip = parseFloat(getComputedStyle(second).clipPath.split(" ").at(-1)) || 0;
    const middle = left(divider) + divider.offsetWidth / 2;
    const beyond = second.getBoundingClientRect().right - stack.getBoundingClientRect().right;
    return { first: left(stack) - left(first), second: middle - left(second), clip, beyond,
             at: middle - left(stack), room: stack.offsetWidth, wide: first.offsetWidth };
}"""


@pytest.mark.evidence
@pytest.mark.parametrize("of", [*dear({"viewport": {"width": 1280, "height": 800}}), PHONE])
def test_the_same_patches_stand_left_and_right_of_the_divider_wherever_it_is(window, of):
    page = window(**of)
    panel = page.locator("[data-part=picture]")
    panel.locator("img").nth(1).wait_for()
    divider = panel.get_by_role("slider")
    for zoom, scrolled in (("0", 0), ("1", 20), ("4", 1000)):
        panel.get_by_label("Zoom").select_option(zoom)
        page.wait_for_timeout(200)
        panel.locator(".d-scroll").evaluate("(n, x) => (n.scrollLeft = x)", scrolled)
        page.wait_for_timeout(200)
        for key in ("End", "Shift+ArrowLeft", "Home", "Shift+ArrowRight"):
            divider.press(key)
            seen = panel.locator(".d-picture").evaluate(BEGINS)
            begin = pytest.approx(scrolled, abs=1)
            assert [seen["first"], seen["second"], seen["clip"]] == [begin] * 3
            assert 0 <= seen["at"] <= seen["wide"] + 1  # no gap beside the left one
            if not scrolled:
                assert seen["beyond"] >= -1  # nor beside the right one
    assert seen["room"] <= of["viewport"]["width"]


@pytest.mark.evidence
def test_one_sensor_stands_beside_itself_without_noise(window):
    page = window({"study": {"sensors": [{"name": "onyx-rgbw"}]}, "look": {}})
    panel = page.locator("[data-part=picture]")
    panel.locator("img").nth(1).wait_for()
    assert panel.get_by_label("Left", exact=True).input_value() == "0 noisy"
    assert panel.get_by_label("Right", exact=True).input_value() == "0 still"
