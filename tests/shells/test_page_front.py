"""The front of a design on the page: a cloud of sensors, each loaded by a click or by Enter."""

import json

import pytest

from chart_values import stages_of
from fronts import EXPOSURE, LIGHT, MATRIX, REFERENCES, front_of_ir_cuts
from outcomes import refused
from served_page import served
from shells.browser import answer_to, study_of, until
from shells.test_page_looks import RULES, axe, faults_of_access

__all__ = ["axe"]


PAIR = {
    "light": {"illuminant": "E", "level_lux": 1.0},
    "exposure": {"time_ms": 12.0},
    "sensors": [{"name": name} for name in REFERENCES],
    "matrices": ["kernel"],
}
LOADED = "[role=option][aria-selected=true]"


@pytest.fixture(scope="module")
def front():
    return front_of_ir_cuts()


@pytest.fixture
def cloud(window, front):
    """Drop a front onto a page; the page, and the panel with its cloud."""

    def opened(text=None, **settings):
        page = window({"study": PAIR, "look": {}}, wait=False, **settings)
        content = (front.as_json() if text is None else text).encode()
        file = {"name": "front.json", "mimeType": "application/json", "buffer": content}
        page.locator("#file").set_input_files(file)
        panel = page.locator("section[data-part=front]")
        panel.locator(".d-cloud").wait_for()
        return page, panel

    return opened


def along(front, name="snr_y_db"):
    """Names of the members in the order of an objective."""
    return [one.name for one in sorted(front.members, key=lambda one: one.objectives[name])]


def place_of(panel, i):
    """The middle of the mark of a member."""
    box = panel.locator("[role=option] > path").nth(i).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def names_in(parts):
    return [one["name"] for one in parts["numbers"]["sensors"]]


@pytest.mark.evidence
def test_a_click_loads_a_sensor_with_its_scene_and_the_page_computes_the_same_snr(cloud, front):
    page, panel = cloud()
    name = along(front)[1]
    question, parts = answer_to(page, lambda: page.mouse.click(*place_of(panel, 1)))
    study = question["study"]
    assert (study["light"]["illuminant"], study["light"]["level_lux"]) == tuple(LIGHT.values())
    assert study["exposure"]["time_ms"] == EXPOSURE["time_ms"]
    assert study["matrices"] == [MATRIX]
    assert names_in(parts) == [*REFERENCES, name]
    assert panel.locator(LOADED).get_attribute("aria-label").startswith(f"{name}: ")
    reply = page.request.post(
        f"{page.url.partition('#')[0]}api/answer", data={"study": study, "want": ["stages"]}
    )
    [member] = [one for one in front.members if one.name == name]
    snr_y_db = stages_of(reply.json()["parts"]["stages"])[-1]["color SNR"]["Y"]
    assert snr_y_db == pytest.approx(member.objectives["snr_y_db"], rel=1e-9)


@pytest.mark.evidence
def test_arrow_keys_move_along_the_front_and_enter_loads(cloud, front):
    page, panel = cloud()
    names, read = along(front), panel.locator(".d-read")
    panel.locator(".d-cloud").focus()
    moves = (("Home", 0), ("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", -1))
    for key, i in moves:
        page.keyboard.press(key)
        assert read.inner_text().startswith(f"{names[i]}: SNR of Y")
    for i in (-1, -2):  # the second takes the place of the first
        _, parts = answer_to(page, lambda: page.keyboard.press("Enter"))
        assert names_in(parts) == [*REFERENCES, names[i]]
        page.keyboard.press("ArrowLeft")
    page.go_back()
    until(page, f"(told) => document.querySelector('{LOADED}').ariaLabel.includes(told)", names[-1])


@pytest.mark.evidence
def test_a_sensor_comes_beside_the_others_or_in_place_of_one_in_the_present_light(cloud, front):
    page, panel = cloud()
    names = along(front)
    panel.get_by_label("Light and time").select_option("keep")
    for target, i in (("beside", 0), ("beside", 1), ("0", 2)):
        panel.get_by_label("A click loads the sensor").select_option(target)
        place = place_of(panel, i)
        question, parts = answer_to(page, lambda at=place: page.mouse.click(*at))
    assert names_in(parts) == [names[2], REFERENCES[1], names[0], names[1]]
    assert question["study"]["light"] == PAIR["light"]
    assert question["study"]["matrices"] == PAIR["matrices"]


@pytest.mark.evidence
def test_the_cloud_shows_any_two_objectives_and_reads_every_point(cloud, front):
    data = json.loads(front.as_json())
    undefined = along(front)[0]
    [member] = [one for one in data["members"] if one["name"] == undefined]
    member["objectives"]["snr_y_db"] = None
    page, panel = cloud(json.dumps(data))
    read, options = panel.locator(".d-read"), panel.locator("[role=option]")
    assert options.count() == len(front.members) - 1
    assert "1 without a value" in panel.inner_text()
    page.mouse.move(*place_of(panel, 0))
    assert read.inner_text().startswith(f"{along(front)[1]}: ")
    box = panel.locator(".d-figure .d-reference").first.bounding_box()
    page.mouse.click(box["x"] + 4, box["y"] + 4)
    assert read.inner_text().startswith(f"{REFERENCES[0]}: ")
    assert study_of(page) == PAIR
    assert panel.locator(".fault:visible").count() == 0
    panel.get_by_label("Across").select_option("color_error")
    panel.get_by_label("Up", exact=True).select_option("bound_db")
    assert options.count() == len(front.members)
    panel.locator(".d-cloud").focus()
    page.keyboard.press("Home")
    assert read.inner_text().startswith(f"{along(front, 'color_error')[0]}: ")
    panel.get_by_role("button", name="Table").click()
    assert panel.locator("tbody tr").count() == len(front.members) + len(REFERENCES)
    panel.get_by_role("button", name="Close").click()
    panel.wait_for(state="detached")


DROP = """([text]) => {
    const file = (name, options, take) => take({ file: (use) => use(new File([text], name)) });
    const folder = { isDirectory: true, name: "design", getFile: file };
    const dropped = { types: ["Files"], files: [], items: [{ webkitGetAsEntry: () => folder }] };
    const event = new Event("drop", { bubbles: true, cancelable: true });
    document.body.dispatchEvent(Object.defineProperty(event, "dataTransfer", { value: dropped }));
}"""


@pytest.mark.evidence
def test_of_a_dropped_folder_the_front_is_shown_and_a_finger_loads_a_sensor(window, front):
    settings = {"viewport": {"width": 360, "height": 740}, "has_touch": True}
    page = window({"study": PAIR, "look": {}}, **settings)
    page.evaluate(DROP, [front.as_json()])
    panel = page.locator("section[data-part=front]")
    panel.locator(".d-cloud").scroll_into_view_if_needed()
    x, y = place_of(panel, 0)
    _, parts = answer_to(page, lambda: page.touchscreen.tap(x - 10, y + 10))  # near enough
    assert names_in(parts)[-1] == along(front)[0]


@pytest.mark.evidence
@pytest.mark.parametrize(("size", "scheme"), [((360, 740), "light"), ((1280, 900), "dark")])
def test_axe_finds_no_fault_and_the_cloud_fits(cloud, axe, size, scheme):
    viewport = {"width": size[0], "height": size[1]}
    page, panel = cloud(viewport=viewport, color_scheme=scheme)
    panel.locator(".d-cloud").focus()
    page.keyboard.press("ArrowRight")
    panel.get_by_role("button", name="Table").click()
    rules = RULES if scheme == "light" else ["color-contrast"]
    assert faults_of_access(page, axe, rules, within="[data-part=front]") == []
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]


@pytest.mark.evidence
def test_modules_of_the_front_are_loaded_with_one_alone(window):
    page = window({"study": PAIR, "look": {}})
    names = page.evaluate("performance.getEntriesByType('resource').map((one) => one.name)")
    assert not [name for name in names if name.endswith(("cloud.js", "front.js", "/api/front"))]


@pytest.mark.evidence
def test_a_served_front_is_shown_and_an_invalid_one_ends_the_command(window, run, front, tmp_path):
    path = tmp_path / "front.json"
    path.write_text(front.as_json())
    with served("--front", path) as (where, _):
        page = window(at=where, wait=False)
        page.locator("section[data-part=front] .d-cloud").wait_for()
        page.close()
    path.write_text("{}")
    refused(run("serve", "--front", path), "front.json", where="key 'schema'")
