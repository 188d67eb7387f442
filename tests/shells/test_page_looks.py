"""How the page looks: for every eye, at every size, in light and dark, on paper."""

import re
from importlib.resources import files

import pytest

from dear import dear
from shells.browser import answer_to, at_rest, open_drawers, picture_panel, typed, until

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]
SIZES = [(360, 740), (1280, 900), *dear(((768, 1024),), ((1920, 1080),), ((3840, 2160),))]
FULL = {
    "study": {
        "light": {"illuminant": "E+0.5xLED850", "level_lux": 20.0},
        "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut"}, {"name": "model-rgbir"}],
    },
    "look": {"open": ["stages", "budget", "vectors"], "story": 2},
}


@pytest.fixture(scope="module")
def axe():
    """The checker of accessibility, as text."""
    pytest.importorskip("axe_core_python", reason="axe-core-python is not installed")
    return (files("axe_core_python") / "axe.min.js").read_text(encoding="utf-8")


def faults_of_access(page, axe, rules=RULES, within="html"):
    """What axe-core finds in an element, as rule and element."""
    # a panel is dimmed while it waits for a newer answer
    bodies = f"[...document.querySelectorAll('{within} .body')]"
    idle = f"!document.querySelector('{within}[aria-busy], {within} .panel[aria-busy]')"
    until(page, f"() => {idle} && {bodies}.every((one) => getComputedStyle(one).opacity === '1')")
    page.evaluate(f"() => {{ if (!window.axe) {{ {axe} }} }}")
    found = page.evaluate(
        "([root, rules]) => axe.run(root, { runOnly: rules, resultTypes: ['violations'] })",
        [within, rules],
    )
    assert len(found["passes"]) > (10 if rules is RULES else 0)
    return [
        f"{fault['id']}: {node['target']} {node['failureSummary']}"
        for fault in found["violations"]
        for node in fault["nodes"]
    ]


@pytest.mark.parametrize("scheme", ["light", *dear("dark")])
def test_axe_finds_no_fault_in_the_page_nor_in_its_dialogs(window, watch, axe, scheme):
    watch.forgive("status of 400")
    rules = [*RULES] if scheme == "light" else ["color-contrast"]  # in the dark colors differ
    page = window(FULL, color_scheme=scheme)
    page.locator("[data-part=picture]").scroll_into_view_if_needed()
    page.locator("[data-part=picture] img").first.wait_for()
    page.locator("#keep").click()
    page.get_by_label("Name of this pin").wait_for()
    open_drawers(page)
    assert faults_of_access(page, axe, rules) == []
    page.evaluate("document.querySelectorAll('.drawer').forEach((node) => (node.open = false))")
    page.locator("button.equation").first.click()
    assert faults_of_access(page, axe, rules, within="dialog[open]") == []
    page.keyboard.press("Escape")
    page.evaluate("Object.defineProperty(navigator, 'clipboard', { value: null })")
    page.get_by_role("button", name="Copy as TOML").click()
    page.get_by_role("dialog").wait_for()
    assert faults_of_access(page, axe, rules, within="dialog[open]") == []
    page.keyboard.press("Escape")
    field = page.get_by_label("Light level in lx")
    field.fill("-1")
    field.press("Enter")
    page.locator(".row .fault").wait_for()
    file = {"name": "a.csv", "mimeType": "text/csv", "buffer": b"?"}
    page.locator("#file").set_input_files(file)
    page.locator(".brought .fault").wait_for()
    assert faults_of_access(page, axe, rules, within="#study") == []


@pytest.mark.evidence
@pytest.mark.parametrize("scheme", [*dear("light"), "dark"])
def test_axe_finds_no_fault_in_the_divider_between_noisy_and_denoised(window, axe, scheme):
    study = FULL["study"] | {"pictures": [{"denoise": "guided"}]}
    page = window({"study": study}, color_scheme=scheme, viewport={"width": 360, "height": 740})
    panel = picture_panel(page)
    panel.get_by_role("slider").focus()
    assert faults_of_access(page, axe, [*RULES], within="[data-part=picture]") == []
    assert wider_than_their_panel(page) == []


@pytest.mark.evidence
@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("state", [*dear(None), FULL], ids=["default", "full"])
def test_nothing_is_wider_than_the_window_and_no_words_of_a_drawing_overlap(window, size, state):
    width, height = size
    page = window(state, viewport={"width": width, "height": height})
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert wider_than_their_panel(page) == []
    assert overlapping(page) == []
    assert cut_off(page) == []


def wider_than_their_panel(page):
    """Panels whose content reaches over their edge, unless it scrolls by itself."""
    return page.evaluate(
        """[...document.querySelectorAll(".panel .body, .top, .group")]
            .filter((node) => node.scrollWidth > node.clientWidth + 1)
            .map((node) => `${node.dataset.part ?? node.className}: ${node.scrollWidth}`)"""
    )


def overlapping(page):
    """Pairs of words of one figure whose boxes share more than a hair."""
    return page.evaluate(
        """() => {
            const pairs = [];
            for (const figure of document.querySelectorAll("svg.d-figure")) {
                const words = [...figure.querySelectorAll("text")].filter((t) => t.textContent);
                const boxes = words.map((text) => {
                    // the box of a line holds room above and below the letters
                    const box = text.getBoundingClientRect();
                    const high = 0.2 * box.height;
                    return { text, left: box.left + 1, right: box.right - 1,
                        top: box.top + high, bottom: box.bottom - high };
                });
                boxes.forEach((a, i) => boxes.slice(i + 1).forEach((b) => {
                    const apart = a.right <= b.left || b.right <= a.left
                        || a.bottom <= b.top || b.bottom <= a.top;
                    if (!apart) pairs.push(`${figure.querySelector("title").textContent}: `
                        + `${a.text.textContent} | ${b.text.textContent}`);
                }));
            }
            return pairs;
        }"""
    )


def cut_off(page):
    """Words that reach over the edge of their figure."""
    return page.evaluate(
        """[...document.querySelectorAll("svg.d-figure text")].filter((text) => {
            const [word, all] = [text, text.closest("svg")].map((n) => n.getBoundingClientRect());
            return word.left < all.left - 1 || word.right > all.right + 1
                || word.top < all.top - 3 || word.bottom > all.bottom + 3;
        }).map((text) => text.textContent)"""
    )


@pytest.mark.evidence
@pytest.mark.parametrize("size", SIZES, ids=str)
def test_a_unit_of_the_ellipses_is_as_long_across_as_up(window, size):
    width, height = size
    page = window(FULL, viewport={"width": width, "height": height})
    page.locator("[data-part=ellipses]").first.scroll_into_view_if_needed()
    lab_or_luv = scales_of_the_ellipses(page)
    select = page.get_by_role("combobox", name="Plane")
    answer_to(page, lambda: select.select_option("xy"), changes="look")
    words = "[...document.querySelectorAll('[data-part=ellipses] svg text')]"
    until(page, f"() => {words}.some((one) => one.textContent === 'x')")  # the title of the axis
    chromaticity = scales_of_the_ellipses(page)
    assert chromaticity[0] > 10 * lab_or_luv[0]  # x and y reach over less than 1
    for across, up in (lab_or_luv, chromaticity):
        assert across == pytest.approx(up, rel=0.01)


def scales_of_the_ellipses(page):
    """Pixels per unit across and up."""
    # pixels per unit between the labels of the first and the last tick of each axis
    return page.evaluate(
        """() => {
            const ticks = [...document.querySelectorAll("[data-part=ellipses] svg text.d-tick")];
            const told = ticks.map((t) => {
                const box = t.getBoundingClientRect();
                const value = Number(t.textContent.replace("\\u2212", "-"));
                const middle = [box.left + box.width / 2, box.top + box.height / 2];
                return { value, middle, end: t.getAttribute("text-anchor") === "end" };
            });
            // of the first panel: until an axis begins again
            const run = (all) => {
                const last = all.findIndex((t, i) => i > 0 && t.value <= all[i - 1].value);
                return last < 0 ? all : all.slice(0, last);
            };
            const scale = (all, k) => Math.abs((all.at(-1).middle[k] - all[0].middle[k])
                / (all.at(-1).value - all[0].value));
            const [x, y] = [false, true].map((end) => run(told.filter((t) => t.end === end)));
            return [scale(x, 0), scale(y, 1)];
        }"""
    )


@pytest.mark.evidence
def test_dark_is_dark_and_light_is_light_as_the_system_wants_it(window):
    def brightness(page):
        return page.evaluate(
            "getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)[0]"
        )

    page = window(color_scheme="dark")
    assert brightness(page) < 40
    page.emulate_media(color_scheme="light")
    assert brightness(page) > 200
    chosen = {"study": FULL["study"], "look": {"theme": "light"}}
    assert brightness(window(chosen, color_scheme="dark")) > 200


def test_on_paper_there_are_no_controls_but_all_drawings_and_the_tables_that_are_open(window):
    page = window({"study": FULL["study"], "look": {"open": ["stages"]}}, color_scheme="dark")
    picture = "[data-part=picture] .body img"  # never seen, but asked for when all else is there
    until(page, f"() => document.querySelector('{picture}')?.naturalWidth > 0")
    page.emulate_media(media="print")
    until(page, "() => document.querySelector('[data-part=stages] .d-figure').clientWidth < 480")
    assert page.locator(picture).first.is_visible()
    assert page.locator(".table:visible").count() == 1
    for hidden in ("#controls", "#copy", "button.equation", ".picture-tools", "#theme"):
        assert page.locator(hidden).first.is_hidden(), hidden
    assert page.locator("#verdict").is_visible()
    assert page.locator("svg.d-figure").first.is_visible()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    paper = page.pdf(format="A4")
    assert len(paper) > 50_000
    assert 1 <= len(re.findall(rb"/Type\s*/Page\b", paper)) <= 8


@pytest.mark.evidence
def test_saturated_channels_say_so_in_words(window):
    page = window()
    typed(page, page.get_by_label("Exposure time in ms"), "1000")
    row = page.locator("#electrons tbody tr").first
    assert row.locator("td").last.inner_text() == "R, G, B, W"
    until(page, "() => document.querySelector('[data-part=budget]').textContent.includes('satur')")
    at_rest(page)
    for part in ("stages", "budget", "ellipses", "levels"):
        panel = page.locator(f"section[data-part={part}]")
        panel.scroll_into_view_if_needed()
        until(
            page,
            f"() => /satur/i.test(document.querySelector('section[data-part={part}]').textContent)",
        )
    assert overlapping(page) == []
    assert "NaN" not in page.locator("main").inner_text()


@pytest.mark.evidence
def test_whoever_wants_to_skip_the_controls_can(window):
    page = window()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    before = page.url
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "panels"
    assert page.url == before
    assert page.locator("#broken").is_hidden()
