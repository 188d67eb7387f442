"""The drawings under the hand: ghosts, tables, equations, the turning vectors and the picture."""

import pytest

from shells.browser import (
    answer_to,
    comes,
    framed,
    held,
    moved_by_key,
    picture_panel,
    state_of,
    until,
)


@pytest.mark.evidence
def test_an_earlier_answer_stays_as_a_ghost_until_it_is_removed(page):
    ghosts = page.locator("[data-part=levels] .body .d-figure .d-ghost")
    assert ghosts.count() == 0
    page.locator("#keep").focus()
    page.keyboard.press("Enter")
    chip = page.get_by_label("Name of this pin")
    chip.wait_for()
    ghosts.first.wait_for(state="attached")
    drawn = ghosts.first.get_attribute("d")
    track = page.get_by_label("f-number", exact=True)
    answer_to(page, lambda: moved_by_key(page, track))
    assert ghosts.first.get_attribute("d") == drawn  # the ghost stays where it was
    chip.fill("before")
    page.get_by_role("button", name="Remove pin before").click()
    assert page.get_by_label("Name of this pin").count() == 0
    assert ghosts.count() == 0
    assert page.evaluate("document.activeElement.id") == "keep"
    for count in range(1, 4):
        page.locator("#keep").click()
        until(page, f"() => document.querySelectorAll('.chip').length === {count}")
    assert page.locator("#keep").is_disabled()


@pytest.mark.evidence
def test_every_table_opens_and_closes_by_keyboard_and_holds_what_is_drawn(page):
    toggles = page.get_by_role("button", name="Table:")
    assert toggles.count() == 9
    for i in range(9):
        toggle = toggles.nth(i)
        table = page.locator(f"#{toggle.get_attribute('aria-controls')}")
        toggle.focus()
        page.keyboard.press("Enter")
        table.locator("tbody tr").first.wait_for()
        assert toggle.get_attribute("aria-expanded") == "true"
        page.keyboard.press("Space")
        table.wait_for(state="hidden")
    page.get_by_role("button", name="Table: SNR from raw to color").click()
    table = page.get_by_role("region", name="Table: SNR from raw to color")
    assert "onyx-rgbw" in table.inner_text()
    page.wait_for_url(lambda _: state_of(page)["look"].get("open") == ["stages"])


@pytest.mark.evidence
def test_every_equation_opens_by_keyboard_and_closes_with_the_focus_where_it_was(page):
    askers = page.locator("button.equation")
    assert askers.count() >= 9
    titles = askers.evaluate_all("(all) => all.map((one) => one.ariaLabel)")
    assert len(titles) == len(set(titles))
    for i in range(askers.count()):
        askers.nth(i).focus()
        page.keyboard.press("Enter")
        dialog = page.get_by_role("dialog", name="Explanation")
        dialog.wait_for()
        dialog.locator(".formula math").first.wait_for()
        assert dialog.locator(".words").first.inner_text()
        assert dialog.locator(".symbols dt math").count()
        assert dialog.locator(".source").first.inner_text()
        page.keyboard.press("Escape" if i % 2 else "Enter")
        dialog.wait_for(state="hidden")
        assert page.evaluate("document.activeElement.ariaLabel") == titles[i]


@pytest.mark.parametrize("control", ["Light level", "f-number"])
def test_of_sixty_presses_the_last_is_shown_in_the_end_and_no_older_one_after_it(page, control):
    track = page.get_by_label(control, exact=True)
    track.focus()
    page.evaluate(
        """() => {
            window.told = [];
            const look = () => window.told.push(Number(document.documentElement.dataset.painted));
            new MutationObserver(look).observe(document.documentElement, { attributes: true });
        }"""
    )
    asked = []
    page.on("request", lambda one: asked.append(one) if one.url.endswith("answer") else None)
    for _ in range(60):
        page.keyboard.press("ArrowDown")
    framed(page)
    value = float(track.locator("xpath=..").locator("input.field").input_value())
    key, name = ("light", "level_lux") if control == "Light level" else ("exposure", "f_number")
    page.wait_for_url(lambda _: state_of(page)["study"][key][name] == value)

    def last():
        return asked[-1].post_data_json

    while last()["study"][key][name] != value:
        page.wait_for_event("request")
    until(page, "(n) => Number(document.documentElement.dataset.painted) >= n", last()["number"])
    until(page, "() => !document.querySelector('#verdict[aria-busy]')")
    result = page.evaluate("window.told")
    assert result == sorted(result)
    fields = page.locator("#verdict").inner_text(), page.locator("#electrons").inner_text()
    answered = page.evaluate(
        """async (study) => {
            const asked = { number: 1, study, want: ["head"] };
            const headers = { "Content-Type": "application/json" };
            const how = { method: "POST", headers, body: JSON.stringify(asked) };
            return (await (await fetch("/api/answer", how)).json()).parts.head;
        }""",
        last()["study"],
    )
    assert fields[0] == answered["verdict"][0]
    for row in answered["ranking"]["rows"]:
        assert all(text in fields[1] for text in row["text"])


@pytest.mark.evidence
def test_the_vectors_turn_by_arrows_and_by_hand_and_turn_back_with_home(page):
    solid = page.locator(".d-turning").first
    solid.scroll_into_view_if_needed()
    arrows = solid.locator("g path").first
    start = arrows.get_attribute("d")
    solid.focus()
    for key in ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"):
        before = arrows.get_attribute("d")
        page.keyboard.press(key)
        assert arrows.get_attribute("d") != before
    assert arrows.get_attribute("d") == start  # left and right, up and down
    page.keyboard.press("Shift+ArrowLeft")
    page.wait_for_url(lambda _: state_of(page)["look"].get("turn") == [15, 20])
    page.keyboard.press("Home")
    assert arrows.get_attribute("d") == start
    box = solid.bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(*middle)
    page.mouse.down()
    page.mouse.move(middle[0] + 40, middle[1])
    page.mouse.up()
    page.wait_for_url(lambda _: state_of(page)["look"].get("turn") == [10, 20])
    assert page.evaluate("document.activeElement.classList.contains('d-turning')")


@pytest.mark.evidence
def test_the_picture_is_drawn_again_and_its_divider_moves_by_keyboard(page):
    panel = page.locator("[data-part=picture]")
    panel.scroll_into_view_if_needed()
    picture = panel.locator("img").first
    picture.wait_for()
    before = picture.get_attribute("src")
    question, _ = answer_to(page, panel.get_by_role("button", name="New noise sample").click)
    assert question["study"]["seed"] == 1
    until(page, "(src) => document.querySelector('.d-stack img').src !== src", before)
    size = picture.evaluate("(one) => [one.naturalWidth, one.width]")
    panel.get_by_label("Zoom").select_option("2")
    until(page, "(w) => document.querySelector('.d-stack img').width === 2 * w", size[1])
    assert size[0] == size[1]  # at 1:1 a pixel of the cube is a pixel of the page
    before = picture.get_attribute("src")
    panel.get_by_label("Left").select_option("0 still")
    until(page, "(src) => document.querySelector('.d-stack img').src !== src", before)
    divider = panel.locator(".d-stack input")
    divider.focus()
    at = "getComputedStyle(document.querySelector('.d-divider')).left"
    before = page.evaluate(at)
    page.keyboard.press("ArrowLeft")
    assert page.evaluate(at) != before


@pytest.mark.evidence
def test_a_picture_of_a_state_that_was_left_never_stands_under_the_one_before(page):
    panel = picture_panel(page)
    until(page, "() => !document.querySelector('[data-part=picture]').hasAttribute('aria-busy')")

    def seen():
        sources = panel.locator("img").evaluate_all("(all) => all.map((one) => one.src)")
        return sources, panel.get_by_role("status").inner_text(), panel.get_attribute("aria-busy")

    def back():
        page.evaluate("history.back()")
        panel.get_by_text("seed 0").wait_for()

    before = seen()
    again = panel.get_by_role("button", name="New noise sample")
    waiting = held(page, lambda request: request.url.endswith("/api/picture"))
    again.click()
    assert panel.get_attribute("aria-busy") == "true"  # at once, not when it is asked for
    comes(page, waiting, 2)
    back()
    for route, reply in waiting:
        route.fulfill(response=reply)
    page.wait_for_timeout(1000)
    assert seen() == before
    fault = {"faults": [{"where": "", "sentence": "Too bright to be drawn."}]}
    page.route("**/api/picture", lambda route: route.fulfill(json=fault))
    again.click()
    panel.get_by_text("Too bright to be drawn.").wait_for()
    assert panel.get_attribute("aria-busy") is None  # nothing newer comes
    back()
    assert seen() == before
