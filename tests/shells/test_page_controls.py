"""The page under the hand: every control, by mouse and by keyboard, changes what is shown."""

import pytest

from dear import dear
from shells.browser import (
    EVERYTHING,
    answer_to,
    at_rest,
    framed,
    in_address,
    moved_by_key,
    open_drawers,
    painted,
    pressed,
    shown,
    state_of,
    typed,
    until,
)

TRACKS = "#controls input.track"


def sliders(page):
    """Labels of the sliders that can be moved, and their places."""
    return page.evaluate(
        f"[...document.querySelectorAll('{TRACKS}')].map((node, i) =>"
        " [i, node.dataset.where, node.disabled || !node.checkVisibility()])"
    )


def moved_by_mouse(page, track):
    """Click a slider at a quarter of its length or, where it stands there, at three."""
    track.scroll_into_view_if_needed()
    box = track.bounding_box()
    place = float(track.input_value()) / float(track.get_attribute("max"))
    share = 0.75 if place < 0.5 else 0.25
    page.mouse.click(box["x"] + share * box["width"], box["y"] + box["height"] / 2)


def is_drawn(where):
    """Whether a drawing shows it: not so the file of a sensor, the picture, a run and its seed.

    A full well shows where it is full, a bias where it shifts a color by a digit, and one half of
    telegraph noise with the other.
    """
    drawn = where.startswith(("light.", "exposure.", "sensors.", "matrices."))
    alone = ("peak_qe", "full_well_e", "black_error_e", "rtn_share", "rtn_amplitude_e")
    return drawn and not where.endswith(alone)


WAYS = {"mouse": [moved_by_mouse], "key": [moved_by_key], "either": [moved_by_mouse, moved_by_key]}


@pytest.mark.parametrize("ways", ["either", *dear("mouse", "key")])
def test_every_slider_moves_the_number_beside_it_the_question_the_drawings_and_the_address(
    window, ways
):
    moved = []
    page = window({"study": EVERYTHING | {"sensors": EVERYTHING["sensors"][:1]}, "look": {}})
    open_drawers(page)
    switch = page.get_by_role("switch", name="Auto exposure")
    switch.click()  # else there is no share to solve for
    for i, where, disabled in sliders(page):
        if disabled or not is_drawn(where):
            continue
        way = WAYS[ways][len(moved) % len(WAYS[ways])]
        track = page.locator(TRACKS).nth(i)
        number = track.locator("xpath=..").locator("input.field")
        before = (number.input_value(), shown(page), painted(page))
        question, _ = answer_to(page, lambda act=way, track=track: act(page, track))
        assert number.input_value() != before[0], where
        assert painted(page) > before[2], where
        assert shown(page) != before[1], where
        in_address(page, question["study"])
        moved.append(where)
        if where == "exposure.time_ms":  # a time that is given leaves no share to solve for
            answer_to(page, switch.click)
    assert moved[:6] == [
        "light.level_lux",
        "light.infrared",
        "exposure.time_ms",
        "exposure.saturate",
        "exposure.f_number",
        "sensors.pixel.read_noise_e",
    ]
    assert "sensors.0.shift_nm" in moved
    assert moved[-1] == "matrices.0"


@pytest.mark.evidence
def test_a_number_can_be_typed_stepped_and_given_back(page):
    field = page.get_by_label("Exposure time in ms")
    question, _ = typed(page, field, "3,5")
    assert question["study"]["exposure"]["time_ms"] == 3.5
    question, parts = answer_to(page, lambda: field.press("ArrowUp"))
    assert 3.5 < question["study"]["exposure"]["time_ms"] < 3.7
    assert parts["numbers"]["sensors"][0]["time_ms"] == question["study"]["exposure"]["time_ms"]
    question, _ = answer_to(page, page.get_by_role("switch", name="Auto exposure").click)
    assert "time_ms" not in question["study"]["exposure"]


@pytest.mark.evidence
def test_steps_before_the_next_frame_all_count(page):
    field = page.get_by_label("Light level in lx")
    field.focus()
    page.keyboard.press("ArrowUp")
    framed(page)
    one = float(field.input_value())
    place = float(page.get_by_label("Light level", exact=True).input_value())
    page.evaluate(
        """() => {
            const key = { key: "ArrowUp", bubbles: true, cancelable: true };
            const field = document.activeElement;
            for (let i = 0; i < 3; i += 1) field.dispatchEvent(new KeyboardEvent("keydown", key));
        }"""
    )
    assert float(page.get_by_label("Light level", exact=True).input_value()) == place + 3
    until(page, "(one) => Number(document.activeElement.value) > one", one)


@pytest.mark.evidence
def test_what_is_no_number_is_told_beside_the_field_and_asked_of_nobody(page):
    before = state_of(page)
    field = page.get_by_label("f-number, as a number")
    field.fill("wide")
    field.press("Enter")
    row = page.locator(".row", has=field)
    assert "has to be a number" in row.locator(".fault").inner_text()
    assert field.get_attribute("aria-invalid") == "true"
    assert state_of(page) == before
    typed(page, field, "2")
    assert row.locator(".fault").count() == 0


@pytest.mark.evidence
def test_a_number_out_of_reason_is_told_beside_its_control_until_it_is_mended(page, watch):
    watch.forgive("status of 400")
    field = page.get_by_label("Light level in lx")
    row = page.locator(".row", has=field)
    field.fill("-3")
    field.press("Enter")
    row.locator(".fault").wait_for()
    assert "your last valid settings" in page.locator("#faults").inner_text()
    typed(page, field, "3")
    assert row.locator(".fault").count() == 0
    assert page.locator("#faults").is_hidden()


CHOICES = [  # one after the other: label, value, key of the study and what it says then
    ("Infrared diode", "LED940", "light", {"illuminant": "E+0.5xLED940", "level_lux": 8.0}),
    ("Light", "3200K", "light", {"illuminant": "3200K+0.5xLED940", "level_lux": 8.0}),
    ("Color matrix", "kernel", "matrices", ["kernel"]),
    ("Color matrix", "lmmse", "matrices", ["lmmse"]),
    ("Prior of trained matrices", "chart", "prior", "chart"),
    ("Sensor 2", "model-rgbir", "sensors", None),
]


@pytest.mark.evidence
def test_every_choice_is_asked_for_and_drawn(page):
    for label, value, key, result in CHOICES:
        select = page.get_by_label(label, exact=True).and_(page.locator("select"))
        before = shown(page)
        question, _ = answer_to(page, lambda one=select, to=value: one.select_option(to))
        assert question["study"][key] == result or result is None, label
        assert shown(page) != before, label
        in_address(page, question["study"])


@pytest.mark.evidence
def test_a_choice_is_made_by_the_keyboard_alone(page):
    question, _ = pressed(page, page.get_by_label("Color matrix"), "Home")
    assert question["study"]["matrices"] == ["kernel"]
    assert page.get_by_label("Weight of the noise").count() == 0


@pytest.mark.evidence
def test_another_light_is_typed(page):
    page.locator("select[data-where='light.illuminant']").select_option("other…")
    question, _ = typed(page, page.get_by_label("Another light"), "3200K")
    assert question["study"]["light"]["illuminant"] == "3200K+0.5xLED850"


@pytest.mark.evidence
def test_the_terms_of_comparison_change_the_times(page):
    times = page.locator("#electrons td[data-key=time_ms]")
    assert len(set(times.all_inner_texts())) == 1
    saturation = page.get_by_role("radio", name="saturation")
    question, _ = answer_to(page, saturation.click)
    assert question["study"]["exposure"]["equal"] == "saturation"
    assert len(set(times.all_inner_texts())) == 3
    pressed(page, saturation, "ArrowLeft")
    assert len(set(times.all_inner_texts())) == 1
    question, _ = answer_to(page, lambda: page.keyboard.press("ArrowRight"))
    assert question["study"]["exposure"]["equal"] == "saturation"
    assert len(set(times.all_inner_texts())) == 3


@pytest.mark.evidence
@pytest.mark.parametrize("way", ["mouse", "keyboard"])
def test_sensors_are_added_moved_and_removed(page, way):
    def press(button):
        if way == "mouse":
            return button.click()
        button.focus()
        return page.keyboard.press("Enter")

    def named(role):
        return page.get_by_role("button", name=role)

    question, parts = answer_to(page, lambda: press(named("Add a sensor")))
    assert len(question["study"]["sensors"]) == len(parts["numbers"]["sensors"]) == 4
    assert page.locator("#electrons tbody tr").count() == 4
    question, _ = answer_to(page, lambda: press(named("Move sensor 2 up")))
    assert question["study"]["sensors"][0]["name"] == "onyx-rgb-ircut"
    assert page.locator("#electrons tbody th").first.inner_text() == "onyx-rgb-ircut"
    answer_to(page, lambda: press(named("Remove sensor 4")))
    assert page.evaluate("document.activeElement.tagName") == "SELECT"
    for number in (3, 2):
        answer_to(page, lambda i=number: press(named(f"Remove sensor {i}")))
    assert page.locator("#electrons tbody tr").count() == 1
    assert named("Remove sensor 1").is_disabled()
    assert named("Move sensor 1 up").is_disabled()


@pytest.mark.evidence
def test_matrices_are_added_changed_moved_and_removed_by_the_keyboard(page):
    def press(name):
        page.get_by_role("button", name=name).focus()
        page.keyboard.press("Enter")

    question, _ = answer_to(page, lambda: press("Add a matrix"))
    assert question["study"]["matrices"] == ["noise-regularized=1", "kernel"]
    second = page.get_by_label("Color matrix 2", exact=True)
    question, _ = answer_to(page, lambda: second.select_option("ridge"))
    assert question["study"]["matrices"] == ["noise-regularized=1", "ridge=0.01"]
    track = page.get_by_label("Strength of the ridge, matrix 2", exact=True)
    question, _ = answer_to(page, lambda: moved_by_key(page, track))
    assert question["study"]["matrices"][1] not in ("ridge=0.01", "ridge=0")
    question, _ = answer_to(page, lambda: press("Move matrix 2 up"))
    assert question["study"]["matrices"][0].startswith("ridge=")
    question, _ = answer_to(page, lambda: press("Remove matrix 1"))
    assert question["study"]["matrices"] == ["noise-regularized=1"]
    assert page.evaluate("document.activeElement.tagName") == "SELECT"
    assert page.get_by_role("button", name="Remove matrix 1").is_disabled()


@pytest.mark.evidence
def test_ten_sensors_are_the_most(window):
    page = window({"study": {"sensors": [{"name": "onyx-rgb"}] * 8}, "look": {}})
    answer_to(page, page.get_by_role("button", name="Add a sensor").click)
    answer_to(page, page.get_by_role("button", name="Duplicate sensor 8").click)
    assert page.locator("#electrons tbody tr").count() == 10
    assert page.get_by_role("button", name="Add a sensor").is_disabled()
    assert page.get_by_role("button", name="Duplicate sensor 1", exact=True).is_disabled()
    assert page.get_by_text("Limit: 10 sensors.").is_visible()


LOOKS = [
    ("Coordinate", "budget", "X"),
    ("Plane", "ellipses", "xy"),
    ("Magnification of the ellipsoid", "vectors", "2"),
]


@pytest.mark.evidence
def test_how_it_is_looked_at_changes_one_drawing_and_the_address_not_the_study(page):
    study = state_of(page)["study"]
    for label, part, value in LOOKS:
        panel = page.locator(f"[data-part={part}]").first
        panel.scroll_into_view_if_needed()
        before = panel.inner_text()
        select = page.get_by_role("combobox", name=label)
        answer_to(page, lambda one=select, to=value: one.select_option(to), changes="look")
        until(
            page,
            "([part, old]) => document.querySelector(`[data-part=${part}]`).innerText !== old",
            [part, before],
        )
        page.wait_for_url(lambda _, to=value: to in map(str, state_of(page)["look"].values()))
        assert state_of(page)["study"] == study


@pytest.mark.evidence
def test_light_and_dark_can_be_chosen(page):
    paper = "getComputedStyle(document.querySelector('.panel')).backgroundColor"
    dark = page.get_by_role("radio", name="Dark")
    bright = page.evaluate(paper)
    dark.click()
    assert page.evaluate(paper) != bright
    dark.focus()
    page.keyboard.press("ArrowRight")
    assert page.get_by_role("radio", name="Auto").is_checked()
    assert page.evaluate(paper) == bright
    page.keyboard.press("ArrowLeft")
    assert dark.is_checked()
    assert page.evaluate(paper) != bright
    page.wait_for_url(lambda _: state_of(page)["look"].get("theme") == "dark")


@pytest.mark.evidence
def test_back_and_forward_go_through_the_studies(page):
    first = shown(page)
    select = page.get_by_label("Color matrix")
    question, _ = answer_to(page, lambda: select.select_option("kernel"))
    in_address(page, question["study"])
    answer_to(page, page.go_back)
    at_rest(page)
    assert select.input_value() == "noise-regularized"
    until(page, "(told) => told.startsWith(document.querySelector('#verdict').textContent)", first)


def test_no_control_is_without_a_name_and_a_keyboard(page):
    without = page.evaluate(
        """[...document.querySelectorAll("button, input, select, textarea, summary, [tabindex]")]
            .filter((node) => node.checkVisibility() && !node.disabled)
            .filter((node) => node.tabIndex < 0 && node.id !== "panels")
            .map((node) => node.outerHTML)"""
    )
    assert without == []
