"""The heat map and dropped files of numbers, under the hand."""

import re

import pytest

from shells.browser import (
    answer_to,
    at_rest,
    in_address,
    moved_by_key,
    open_drawers,
    state_of,
    until,
)

PAIR = {
    "light": {"illuminant": "E", "level_lux": 0.1},
    "exposure": {"time_ms": 12.0},
    "sensors": [{"name": "onyx-rgb"}, {"name": "onyx-rgb-ircut"}],
    "matrices": ["kernel"],
}
SWEEP = {"vary": "infrared", "first": 0.0, "last": 2.0, "points": 9}
MAP = {**SWEEP, "second": {"vary": "lux", "first": 0.01, "last": 0.1, "points": 5}}
MIXING = "R,G,B\n0.9,0.05,0\n0.05,0.9,0.05\n0,0.05,0.9\n"
LARGE_BYTES = 100_000_000


def panel_of(page):
    panel = page.locator("section[data-part=map]")
    panel.scroll_into_view_if_needed()
    return panel


def mapped(page):
    """Wait for a drawn map, and give its panel."""
    panel = panel_of(page)
    panel.locator(".d-map").wait_for()
    at_rest(page)
    return panel


@pytest.mark.evidence
def test_two_parameters_and_a_quantity_are_chosen_and_taken_away(window):
    page = window({"study": PAIR, "look": {}})
    panel = panel_of(page)
    assert panel.locator(".d-map").count() == 0
    panel.get_by_label("Across", exact=True).select_option("kelvin")
    mapped(page)
    panel.get_by_label("Up", exact=True).select_option("kelvin")  # exchanged with the other axis
    panel.get_by_label("Quantity").select_option("snr-x")
    panel.get_by_label("Across, to").fill("100")
    panel.get_by_label("Across, to").press("Enter")
    kelvin = {"vary": "kelvin", "first": 2000, "last": 10_000}
    sweep = {"vary": "lux", "first": 0.01, "last": 100, "quantity": "snr-x", "second": kelvin}
    in_address(page, PAIR | {"sweeps": [sweep]})
    until(page, "() => document.querySelector('.d-map').textContent.includes('SNR of X')")
    panel.get_by_label("Across, from").fill("ten")
    panel.get_by_label("Across, from").press("Enter")
    assert panel.locator(".map-tools .fault").inner_text() == "Type a number."
    panel.get_by_label("Across", exact=True).select_option("")
    in_address(page, PAIR | {"sweeps": []})
    panel.locator(".d-map").wait_for(state="detached")


@pytest.mark.evidence
def test_a_range_that_does_not_rise_is_a_sentence_in_place_of_the_map(window):
    page = window({"study": PAIR | {"sweeps": [MAP]}, "look": {}})
    panel = mapped(page)
    panel.get_by_label("Across, to").fill("0")
    panel.get_by_label("Across, to").press("Enter")
    fault = panel.locator("> .fault")
    fault.wait_for()
    assert "rise" in fault.inner_text()


@pytest.mark.evidence
def test_a_cell_is_read_by_keyboard_and_by_pointing(window):
    page = window({"study": PAIR | {"sweeps": [MAP]}, "look": {"open": ["map"]}})
    panel = mapped(page)
    rows = panel.locator("tbody tr")
    assert rows.count() == MAP["points"] * MAP["second"]["points"]
    root, tip = panel.locator(".d-map"), page.locator(".d-tip")
    head = panel.locator("thead th").all_inner_texts()

    def row(cells):
        values = cells.locator("th, td").all_inner_texts()
        return [f"{name}: {value}" for name, value in zip(head, values, strict=True)]

    def read():
        return tip.inner_text().splitlines()

    root.focus()
    page.keyboard.press("Home")
    top = (MAP["second"]["points"] - 1) * MAP["points"]  # rows rise
    assert read() == row(rows.nth(top))
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowRight")
    assert read() == row(rows.nth(top - MAP["points"] + 1))
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowLeft")
    assert read() == row(rows.nth(top))
    page.keyboard.press("Escape")
    box = root.bounding_box()
    page.mouse.move(box["x"] + box["width"] - 20, box["y"] + 82)
    assert read() == row(rows.last)


@pytest.mark.evidence
def test_a_map_is_never_asked_for_with_the_numbers(window):
    page = window({"study": PAIR | {"sweeps": [MAP]}, "look": {}})
    mapped(page)
    wanted = []

    def asked(request):
        if request.url.endswith("answer"):
            wanted.append(request.post_data_json["want"])

    page.on("request", asked)
    answer_to(page, lambda: moved_by_key(page, page.get_by_label("f-number", exact=True)))
    at_rest(page)
    assert ["map"] in wanted
    assert all(want == ["map"] or "map" not in want for want in wanted)


@pytest.mark.evidence
def test_dropped_crosstalk_is_used_and_taken_away(window, tmp_path):
    page = window({"study": PAIR, "look": {}})
    path = tmp_path / "mix.csv"
    path.write_text(MIXING)
    page.locator("#file").set_input_files(path)
    use = page.get_by_role("button", name="Use for sensor 2")
    question, _ = answer_to(page, use.click)
    word = question["study"]["sensors"][1]["crosstalk"]
    assert re.fullmatch("upload:[0-9a-f]{16}[.]csv", word)
    open_drawers(page)
    away = page.get_by_role(
        "button", name="Remove the file: Crosstalk to the neighbors of sensor 2"
    )
    assert page.locator(".file:visible").all_inner_texts() == ["mix.csv"]
    answer_to(page, away.click)
    assert state_of(page)["study"]["sensors"][1] == {"name": "onyx-rgb-ircut"}
    assert page.locator(".file:visible").count() == 0


@pytest.mark.evidence
def test_a_file_that_two_readers_accept_is_asked_about_and_one_too_large_is_refused(
    window, tmp_path
):
    page = window({"study": PAIR, "look": {}})
    path, large = tmp_path / "kernel.csv", tmp_path / "large.csv"
    path.write_text("0,0.05,0\n0.05,0.8,0.05\n0,0.05,0\n")
    with large.open("wb") as file:
        file.truncate(LARGE_BYTES)
    page.locator("#file").set_input_files(path)
    brought = page.locator(".brought")
    brought.locator("select").select_option("matrix")
    question, _ = answer_to(page, brought.get_by_role("button", name="Add").click)
    assert question["study"]["matrices"][0] == "kernel"
    remove = page.get_by_role("button", name="Remove matrix 2")
    answer_to(page, remove.click)
    assert state_of(page)["study"]["matrices"] == ["kernel"]
    page.locator("#file").set_input_files(large)
    brought.locator(".fault").wait_for()
    assert "100.0 MB" in brought.inner_text()
