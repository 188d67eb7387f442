"""The page where answers come late, links are odd, and files belong to one lamp or sensor."""

import json

import pytest

from shells.browser import (
    EVERYTHING,
    answer_to,
    asked_last,
    comes,
    held,
    let_go,
    packed,
    picture_panel,
    pressed,
    study_of,
    typed,
    until,
)
from spectrum_samples import CAMERA_CSV

PAIR = [{"name": "onyx-rgbw"}, {"name": "onyx-rgb"}]
LAMP = "wavelength_nm,power\n" + "\n".join(f"{nm},{1 + nm / 1000}" for nm in range(400, 1051, 10))
QUICK = {"numbers", "sensitivities", "stages", "budget", "ellipses"}


def brought(page, name, content):
    """Choose a file; what is said of it stands in the node that comes back."""
    file = {"name": name, "mimeType": "text/csv", "buffer": content.encode()}
    page.locator("#file").set_input_files(file)
    return page.locator(".brought")


@pytest.mark.evidence
def test_two_files_of_one_name_are_told_apart_and_one_content_is_taken_once(window):
    page = window({"study": {"sensors": PAIR}, "look": {}})
    first, second = (CAMERA_CSV.replace("0.4", one) for one in ("0.4", "0.5"))
    for content in (first, second):
        add = brought(page, "x.csv", content).get_by_role("button", name="Add as a sensor")
        _, parts = answer_to(page, add.click)
    told = [one["name"] for one in parts["numbers"]["sensors"]]
    assert told == ["onyx-rgbw", "onyx-rgb", "x", "x (2)"]
    chosen = page.locator(".card select option:checked").all_text_contents()
    assert all(one.startswith(f"{name} ") for one, name in zip(chosen[2:], told[2:], strict=True))
    report = brought(page, "copy.csv", first)
    report.get_by_text("copy.csv has the same content as sensor 3").wait_for()
    assert report.get_by_role("button").count() == 0


def ghost_question(look):
    def is_it(request):
        if not request.url.endswith("/api/answer"):
            return False
        data = request.post_data_json
        return data["number"] == 0 and all(
            data["look"][key] == value for key, value in look.items()
        )

    return is_it


@pytest.mark.evidence
def test_a_ghost_of_another_coordinate_never_stands_behind_the_levels(page):
    page.locator("#keep").click()
    page.get_by_label("Name of this pin").wait_for()
    ghosts = page.locator("[data-part=levels] .body .d-figure .d-ghost")
    ghosts.first.wait_for(state="attached")
    at_y = ghosts.first.get_attribute("d")
    waiting = held(page, ghost_question({"coordinate": "X"}))
    select = page.get_by_role("combobox", name="Coordinate")
    answer_to(page, lambda: select.select_option("X"), changes="look")
    comes(page, waiting)
    title = "[data-part=levels] .body"
    until(page, f"() => document.querySelector('{title}').textContent.includes('SNR of X')")
    assert ghosts.count() == 0  # the ghost that is there is of Y
    answer_to(page, lambda: select.select_option("Y"), changes="look")
    ghosts.first.wait_for(state="attached")
    assert ghosts.first.get_attribute("d") == at_y
    let_go(waiting)  # of X, and too late
    page.wait_for_timeout(300)
    assert ghosts.first.get_attribute("d") == at_y


@pytest.mark.evidence
def test_a_ghost_that_is_kept_while_the_coordinate_changes_is_asked_again(page):
    waiting = held(page, ghost_question({"coordinate": "Y"}))
    page.locator("#keep").click()
    comes(page, waiting)
    select = page.get_by_role("combobox", name="Coordinate")
    answer_to(page, lambda: select.select_option("X"), changes="look")
    asked = ghost_question({"coordinate": "X"})
    with page.expect_request(asked):
        let_go(waiting)
    page.locator("[data-part=levels] .body .d-figure .d-ghost").first.wait_for(state="attached")


ODD = [
    {"matrices": [5]},
    {"matrices": "kernel"},
    {"pictures": {}},
    {"pictures": [3]},
    {"pictures": [{"cube": 3}]},
    {"light": 3},
    {"light": None},
    {"light": {"illuminant": []}},
    {"exposure": "long"},
    {"prior": {}},
    {"sensors": [None]},
    {"sensors": [{"name": "onyx-rgbw", "pixel": 5}, {"name": "onyx-rgb"}]},
    {"sensors": [{"name": "onyx-rgbw", "filter": 5}, {"name": "onyx-rgb"}]},
]


@pytest.mark.evidence
def test_a_link_with_values_of_another_kind_is_one_sentence_over_a_default_study_that_works(window):
    page = window({"study": {"sensors": PAIR}})
    result = page.locator("#broken")
    for odd in ODD:
        key = next(iter(odd))
        page.evaluate(
            "(hash) => (location.hash = hash)", packed({"study": {"sensors": PAIR} | odd})
        )
        sentence = f"This link holds {key} of another kind, so the default study is shown."
        until(page, "(s) => document.querySelector('#broken').textContent === s", sentence)
        page.evaluate("(hash) => (location.hash = hash)", packed({"study": {"sensors": PAIR}}))
        result.wait_for(state="hidden")
    page.evaluate("(hash) => (location.hash = hash)", packed({"study": {"sensors": PAIR} | odd}))
    result.wait_for()

    def is_of_the_default_study(request):  # one of the study before may still be on its way
        return request.url.endswith("/api/answer") and '"onyx-rgb-ircut"' in (
            request.post_data or ""
        )

    with page.expect_request(is_of_the_default_study) as sent:
        page.get_by_label("Color matrix").select_option("lmmse")
    assert sent.value.post_data_json["study"]["sensors"][1]["name"] == "onyx-rgb-ircut"


@pytest.mark.evidence
def test_a_picture_is_captioned_with_the_sensor_that_it_was_taken_of(page):
    panel = picture_panel(page)
    waiting = held(page, lambda request: request.url.endswith("/api/picture"))
    captions = panel.locator(".body")
    assert "onyx-rgbw, noisy" in captions.inner_text()
    panel.get_by_label("Left").select_option("2 still")
    panel.get_by_label("Zoom").select_option("2")  # draws the old pictures anew
    assert "onyx-rgbw, noisy" in captions.inner_text()
    assert "without noise" not in captions.inner_text()
    comes(page, waiting, 2)
    let_go(waiting, 2)
    until(
        page,
        "() => document.querySelector('[data-part=picture] .body').innerText"
        ".includes('onyx-rgb, without noise')",
    )


@pytest.mark.evidence
def test_the_notes_of_a_picture_are_told_and_faults_with_status_200_are_sentences(page):
    panel = picture_panel(page)
    said = page.locator(SAID)

    def noted(route):
        reply = route.fetch()
        summary = json.loads(reply.headers["x-chromanoise-summary"]) | {
            "notes": ["held beyond 700 nm"]
        }
        headers = reply.headers | {"x-chromanoise-summary": json.dumps(summary)}
        route.fulfill(response=reply, headers=headers)

    page.route("**/api/picture", noted)
    panel.get_by_label("Left").select_option("1 noisy")
    until(
        page, "(s) => document.querySelector(s).textContent.includes('Held beyond 700 nm.')", SAID
    )
    page.unroute("**/api/picture")
    fault = {"faults": [{"where": "cube", "sentence": "The cube was moved away."}]}
    page.route("**/api/picture", lambda route: route.fulfill(status=200, json=fault))
    panel.get_by_label("Left").select_option("0 still")
    until(page, "(s) => document.querySelector(s).textContent === 'The cube was moved away.'", SAID)
    assert said.inner_text() == "The cube was moved away."


SAID = "[data-part=picture] .hint[role=status]"


@pytest.mark.evidence
def test_an_answer_that_turns_nothing_is_not_told_aloud_again(page):
    page.evaluate(
        """() => {
            window.told = 0;
            const node = document.querySelector("[data-part=vectors] .d-views ~ [role=status]");
            const told = new MutationObserver(() => (window.told += 1));
            told.observe(node, { childList: true, subtree: true });
        }"""
    )
    solid = page.locator("[data-part=vectors] .d-turning g").first
    before = solid.inner_html()
    pressed(page, page.get_by_label("Infrared in the light", exact=True), "Shift+ArrowUp")
    until(page, "(b) => document.querySelector('.d-turning g').innerHTML !== b", before)
    assert page.evaluate("window.told") == 0
    page.locator(".d-turning").first.focus()
    page.keyboard.press("ArrowLeft")
    until(page, "() => window.told === 1")


@pytest.mark.evidence
def test_how_a_lamps_file_was_read_goes_with_the_lamp(window):
    light = {"illuminant": "A", "level_lux": 4.0, "beyond": "hold"}
    page = window({"study": {"light": light, "sensors": PAIR}, "look": {}})
    track = page.get_by_label("Infrared in the light", exact=True)
    question, _ = pressed(page, track, "Shift+ArrowUp")
    assert question["study"]["light"] == light | {"illuminant": "A+0.5xLED850"}
    select = page.locator("select[data-where='light.illuminant']")
    question, _ = answer_to(page, lambda: select.select_option("3200K"))
    assert question["study"]["light"] == {"illuminant": "3200K+0.5xLED850", "level_lux": 4.0}
    report = brought(page, "lamp.csv", LAMP)
    use = report.get_by_role("button", name="Use as the light")
    question, _ = answer_to(page, use.click)
    assert set(question["study"]["light"]) == {"illuminant", "level_lux"}


@pytest.mark.evidence
def test_another_sensor_in_its_place_keeps_the_pixel_the_filter_the_edge_and_the_shift(window):
    kept = {
        "pixel": {"read_noise_e": 3.0},
        "filter": "ircut-650",
        "shift_ircut_nm": -5.0,
        "ircut_nm": 700.0,
        "shift_nm": 5.0,
    }
    page = window({"study": {"sensors": [{"name": "onyx-rgbw"} | kept, PAIR[1]]}, "look": {}})
    select = page.get_by_label("Sensor 1", exact=True).and_(page.locator("select"))
    question, _ = answer_to(page, lambda: select.select_option("model-rgbir"))
    assert question["study"]["sensors"][0] == {"name": "model-rgbir"} | kept
    report = brought(page, "mine.csv", CAMERA_CSV)
    exchange = report.get_by_role("button", name="Replace sensor 1")
    exchange.wait_for()
    for choice in report.locator("select").all():
        choice.select_option(index=1)
    question, _ = answer_to(page, exchange.click)
    sensor = question["study"]["sensors"][0]
    assert sensor["name"].startswith("upload:")
    assert {key: sensor[key] for key in kept} == kept


@pytest.mark.evidence
def test_the_highest_qe_is_asked_only_of_a_file_of_relative_curves(page, watch):
    watch.forgive("status of 400")
    card = page.locator("fieldset.card").first
    label = card.get_by_label("Peak QE of relative curves", exact=True)
    assert label.is_hidden()
    report = brought(page, "mine.csv", CAMERA_CSV.replace("wavelength_nm", "nm"))
    exchange = report.get_by_role("button", name="Replace sensor 1")
    exchange.wait_for()
    for choice in report.locator("select").all():
        options = choice.locator("option").all_inner_texts()
        choice.select_option("relative" if "relative" in options else options[1])
    exchange.click()
    label.wait_for()
    result = card.locator(".fault")
    result.wait_for()
    assert "highest QE" in result.inner_text()
    assert "--" not in result.inner_text()
    question, _ = typed(page, card.get_by_label("Peak QE of relative curves in e"), "0.6")
    assert question["study"]["sensors"][0]["answers"]["peak_qe"] == 0.6
    until(
        page, "() => document.querySelector('#electrons tbody th').textContent.startsWith('mine')"
    )
    select = page.get_by_label("Sensor 1", exact=True).and_(page.locator("select"))
    answer_to(page, lambda: select.select_option("onyx-rgbw"))
    assert label.is_hidden()


@pytest.mark.evidence
def test_a_slow_file_does_not_write_over_what_was_brought_after_it(page):
    def slow(request):
        return request.url.endswith("upload") and request.headers["x-filename"] == "slow.csv"

    waiting = held(page, slow)
    brought(page, "slow.csv", LAMP)
    comes(page, waiting)
    report = brought(page, "quick.csv", LAMP)
    report.get_by_role("button", name="Use as the light").wait_for()
    assert "quick.csv" in report.inner_text()
    let_go(waiting)
    page.wait_for_timeout(300)
    assert "quick.csv" in report.inner_text()
    assert "slow.csv" not in report.inner_text()


@pytest.mark.evidence
def test_slow_drawings_of_a_trained_matrix_never_hold_back_the_numbers(page):
    def slow(request):
        return request.url.endswith("answer") and "levels" in request.post_data_json["want"]

    levels = page.locator("section[data-part=levels]")
    levels.scroll_into_view_if_needed()
    before = levels.locator(".body").inner_html()
    waiting = held(page, slow)
    track = page.get_by_label("Light level", exact=True)
    for step in (1, 2):
        question, parts = pressed(page, track, "Shift+ArrowUp")
        assert "numbers" in question["want"]
        assert set(question["want"]) <= QUICK
        comes(page, waiting)
        assert len(waiting) == 1, step  # one under way, the latest waits
        result = f"{parts['numbers']['sensors'][0]['mean_e']['G']:.4g}"
        assert result in page.locator("#electrons").inner_text()
        assert levels.get_attribute("aria-busy") == "true"
        assert levels.locator(".body").inner_html() == before
    dimmed = "Number(getComputedStyle(document.querySelector('[data-part=levels] .body')).opacity)"
    until(page, f"() => {dimmed} < 0.6")
    let_go(waiting)
    comes(page, waiting)
    assert waiting[0][0].request.post_data_json["study"] == asked_last(page)["study"]
    assert levels.get_attribute("aria-busy") == "true"  # what came is older than the numbers
    let_go(waiting)
    until(page, "() => !document.querySelector('[data-part=levels]').hasAttribute('aria-busy')")
    assert levels.locator(".body").inner_html() != before
    until(page, f"() => {dimmed} === 1")


@pytest.mark.evidence
def test_with_a_kernel_all_that_is_seen_comes_in_one_answer(window):
    study = EVERYTHING | {"matrices": ["kernel"]}
    page = window({"study": study, "look": {}}, viewport={"width": 1280, "height": 6000})
    question, _ = pressed(page, page.get_by_label("f-number", exact=True), "Shift+ArrowUp")
    assert {"numbers", "levels", "pareto", "chart", "vectors"} <= set(question["want"])


@pytest.mark.evidence
def test_a_trade_of_saturated_sensors_is_sentences_and_no_empty_frame(window):
    exposure = {"time_ms": 1000.0}
    light = {"level_lux": 10_000.0}
    page = window({"study": {"sensors": PAIR, "light": light, "exposure": exposure}, "look": {}})
    body = page.locator("[data-part=pareto] .body")
    body.scroll_into_view_if_needed()
    until(page, "() => document.querySelector('[data-part=pareto] .body').textContent !== ''")
    assert body.locator("svg").count() == 0
    assert "onyx-rgbw" in body.inner_text()


@pytest.mark.evidence
def test_a_filter_is_written_before_its_sensor_and_its_fault_stands_beside_it(page):
    field = page.get_by_label("Filter on the sensor").first
    before = page.locator("#electrons").inner_text()

    def put(word):
        if field.evaluate("(one) => one.tagName") == "SELECT":
            field.select_option(word)
        else:
            field.fill(word)
            field.press("Enter")

    question, _ = answer_to(page, lambda: put("ircut-650"))
    assert question["study"]["sensors"][0]["filter"] == "ircut-650"
    assert page.locator("#electrons").inner_text() != before
    sentence = "filter must be a name of the catalog or a file, but is 'x'; did you mean y?"
    fault = {"faults": [{"where": "sensors.0.filter", "sentence": sentence}]}
    page.route("**/api/answer", lambda route: route.fulfill(status=200, json=fault))
    put("")
    result = page.locator(".row", has=field).locator(".fault")
    result.wait_for()
    assert result.inner_text() == sentence
    assert "filter" not in study_of(page)["sensors"][0]


@pytest.mark.evidence
def test_the_page_shows_the_sentence_of_the_server_as_it_is(page):
    sentence = "two.npz must hold one array, but holds 2: a, b; the page has no control for key"
    fault = {"faults": [{"where": "file", "sentence": sentence}]}
    page.route("**/api/upload", lambda route: route.fulfill(status=200, json=fault))
    alert = brought(page, "two.npz", "anything").get_by_role("alert")
    alert.wait_for()
    assert alert.inner_text() == sentence


@pytest.mark.evidence
def test_a_sensor_that_stands_there_twice_has_two_pictures_of_two_names(window):
    twice = [PAIR[0], PAIR[0] | {"ircut_nm": 700.0}]
    page = window({"study": {"sensors": twice}, "look": {}})
    left = page.locator("[data-part=picture]").get_by_label("Left")
    names = left.locator("option").all_inner_texts()
    assert names[0] == "onyx-rgbw, noisy"
    assert names[2] == "onyx-rgbw (2), noisy"


@pytest.mark.evidence
def test_a_wait_for_the_first_picture_is_told_in_its_place_with_the_reason(window):
    page = window(wait=False)
    waiting = held(page, lambda request: request.url.endswith("/api/picture"))
    page.reload()  # by now replies are held back
    until(page, "(s) => document.querySelector(s)?.textContent.includes('numerical code')", SAID)
    said, body = page.locator(SAID), page.locator("[data-part=picture] .body")
    inner, outer = said.bounding_box(), body.bounding_box()
    assert outer["y"] <= inner["y"] < inner["y"] + inner["height"] <= outer["y"] + outer["height"]
    comes(page, waiting, 2)
    let_go(waiting, 2)
    until(page, "(s) => document.querySelector(s).textContent.includes('pixels.')", SAID)
    assert "being made" not in said.inner_text()
    page.locator("[data-part=picture]").get_by_label("Left").select_option("0 still")
    until(
        page, "(s) => document.querySelector(s).textContent === 'The picture is being made.'", SAID
    )
    comes(page, waiting, 2)
    let_go(waiting, 2)
    until(page, "() => !document.querySelector('[data-part=picture]').hasAttribute('aria-busy')")
    assert "being made" not in said.inner_text()


@pytest.mark.parametrize("how", [pytest.param("lost", marks=pytest.mark.evidence), "busy"])
def test_a_picture_that_was_lost_is_asked_for_once_more(window, watch, how):
    watch.forgive("net::ERR_")
    page = window()
    panel = page.locator("[data-part=picture]")
    panel.locator("img").nth(1).wait_for()
    times = []

    def lose(route):
        times.append(route)
        if how == "lost":
            route.abort()
        else:
            route.fulfill(status=503, json={"faults": [{"where": "", "sentence": "busy"}]})

    page.route("**/api/picture", lose, times=2)  # those of both sides
    panel.get_by_label("Left").select_option("0 still")
    until(
        page,
        "() => document.querySelector('[data-part=picture] .d-captions').textContent"
        ".includes('onyx-rgbw, without noise')",
    )
    assert len(times) == 2
    page.route("**/api/picture", lose)
    panel.get_by_label("Left").select_option("1 noisy")
    until(page, "(s) => document.querySelector(s).textContent.includes('failed')", SAID)
    assert panel.get_attribute("aria-busy") is None
    assert len(times) == 6  # twice for both sides, not more
