"""The controls that are made from the schema of a study: each key has one, with an effect."""

import re

import pytest

from chromanoise.study import study_as_json, study_from_data
from chromanoise.study.schema import PixelPart, SensorPart, Study
from chromanoise.web.controls import ELSEWHERE, SECTION_HINTS, described_fields, study_defaults
from chromanoise.web.requests import asset
from shells.browser import answer_to, at_rest, open_drawers, state_of, study_of, typed

FIELDS = {one["key"]: one for one in described_fields()}
SAMPLES = {  # values of texts, whose description gives no example
    "title": "two chips",
    "light.column": "lamp",
    "sensors.label": "New chip",
    "sensors.pixel.file": "pixel.toml",
    "sensors.mosaic": "rgbw-4x4",
    "sensors.filter": "ircut-650",  # a shifted table would not cover the grid
    "sensors.shift_ircut_nm": 5.0,
    "reflectances.chart": "chart.csv",
    "reflectances.patch": 0.18,
    "reflectances.pairs": "pairs.csv",
    "outputs.pipeline.iso": [100.0, 400.0],
    "outputs.pipeline.iso_read_noise_e": [5.0],
}
BESIDE = {  # what a value needs beside it
    "outputs.clip": {"outputs.budget": False},
    "sensors.pixel.binning_mode": {"sensors.pixel.binning": 4},
    "outputs.pipeline.base_iso": {"outputs.pipeline.iso": [1e4]},
}
OF_A_FILE = (
    "sensors.answers.",
    "sensors.pixel.file",
    "sensors.beyond",
    "sensors.negatives",
    "sensors.filter_",
)


def sample(field):
    """A value that differs from the default."""
    if field["key"] in SAMPLES:
        return SAMPLES[field["key"]]
    if field["kind"] == "number":
        inside = 0.25 * field["low"] + 0.75 * field["high"]
        return round(inside) if field["whole"] else inside
    if field["kind"] == "flag":
        return not field["default"]
    if field["kind"] == "channels":
        return {"R": field["suggestions"][0]}
    words = field.get("options") or field["suggestions"]
    return next(word for word in words if word != field["default"])


def test_every_field_of_a_sensor_and_its_pixel_has_a_control_or_a_reason_for_none():
    keys = {f"sensors.{name}" for name in SensorPart.model_fields} - {"sensors.pixel"}
    keys |= {f"sensors.pixel.{name}" for name in PixelPart.model_fields}
    parts = {key.rpartition(".")[0] for key in (*FIELDS, *ELSEWHERE)}
    assert keys - set(FIELDS) - set(ELSEWHERE) - parts == set()
    names = {field.alias or name for name, field in Study.model_fields.items()}
    assert names == {key.partition(".")[0] for key in (*FIELDS, *ELSEWHERE)}
    assert not set(FIELDS) & set(ELSEWHERE)


def test_a_description_has_unit_range_and_default_of_the_study():
    prnu = FIELDS["sensors.pixel.prnu"]
    assert (prnu["unit"], prnu["low"], prnu["scale"]) == ("1", 0.0, "linear")
    assert FIELDS["sensors.pixel.pitch_um"]["unit"] == "um"
    assert FIELDS["observer"]["default"] == "cie-1931-2"
    assert FIELDS["sensors.pixel.bits"]["whole"]
    assert set(SECTION_HINTS) <= {one["section"] for one in FIELDS.values()}


def test_a_field_without_a_line_of_its_own_is_described_by_its_schema(monkeypatch):
    monkeypatch.setattr("chromanoise.web.controls._refined", lambda key: {})
    plain = {one["key"]: one for one in described_fields()}
    assert plain.keys() == FIELDS.keys()
    prnu = plain["sensors.pixel.prnu"]
    assert (prnu["label"], prnu["kind"], prnu["group"]) == ("Prnu", "number", "Noise")
    assert (prnu["unit"], prnu["low"], prnu["high"], prnu["step"]) == ("1", 0, 0.2, 0.002)


@pytest.mark.parametrize("key", FIELDS)
def test_the_study_accepts_every_value_that_a_control_offers(key):
    field = FIELDS[key]
    offered = [sample(field), *field.get("options", ())]
    if field["kind"] == "number":
        offered += [field["low"], field["high"]]
    for value in offered:
        data = {"sensors": [{"name": "onyx-rgbw"}], "pictures": [{}]}
        if key.startswith("outputs.pipeline."):
            put(data, "outputs.pipeline.run", True)
        for other, one in {**BESIDE.get(key, {}), key: value}.items():
            put(data, other, one)
        at = study_from_data(data, keep_idle=True).model_dump(by_alias=True)
        for step in key.split("."):
            at = at[step][0] if step in ("sensors", "pictures") else at[step]
        assert at == (tuple(value) if isinstance(value, list) else value)


def put(data, key, value):
    *path, last = key.split(".")
    for step in path:
        data = data[step][0] if step in ("sensors", "pictures") else data.setdefault(step, {})
    data[last] = value


def written(page, control, field):
    """Give a control the sample of its field, as a hand would."""
    value = sample(field)
    if field["kind"] == "number":
        number = control.locator("xpath=..").locator("input.field")
        number.fill(str(value))
        return number.press("Enter")
    if field["kind"] in ("choice", "flag"):
        return control.select_option(str(value).lower() if field["kind"] == "flag" else value)
    control.fill(str(value))
    return control.press("Enter")


def test_the_script_of_the_page_has_the_defaults_of_the_library():
    """An empty study has the defaults; the script names the keys whose default it needs."""
    scripts = {name: asset(f"app/{name}.js").decode() for name in ("exposure", "light", "reader")}
    asked = re.findall(r'saidAt\(study, "(\w+)\.(\w+)"\)', " ".join(scripts.values()))
    values = study_as_json(study_from_data({"sensors": [{"name": "onyx-rgb"}]}, source=""))
    defaults = study_defaults()
    assert len(set(asked)) >= 6
    assert all(defaults[f"{part}.{key}"] == values[part][key] for part, key in asked)


@pytest.mark.evidence
def test_every_control_of_a_sensor_changes_the_study_without_a_fault(window):
    study = {"sensors": [{"name": "onyx-rgbw"}]}
    page = window({"study": study}, viewport={"width": 1280, "height": 400})  # few charts in sight
    open_drawers(page)
    known = page.locator("#hash").inner_text()
    tried = []
    for key, field in FIELDS.items():
        if field["section"] != "Sensors" or key.startswith(OF_A_FILE):
            continue
        path = key.replace("sensors.", "sensors.0.") + (".R" if field["kind"] == "channels" else "")
        one = field | ({"kind": "text"} if field["kind"] == "channels" else {})
        control = page.locator(f"[data-where='{path}']").first
        question, _ = answer_to(page, lambda c=control, f=one: written(page, c, f))
        assert page.locator("#controls .fault").count() == 0, path
        assert page.locator("#faults").is_hidden(), path
        at = question["study"]
        for step in path.split("."):
            at = at[int(step)] if step.isdigit() else at[step]
        assert at is not None, path
        assert page.locator("#hash").inner_text() != known, path
        known = page.locator("#hash").inner_text()
        tried.append(key)
    assert len(tried) >= 20
    away = page.get_by_role("button", name="none: Crosstalk to the neighbors").first
    question, _ = answer_to(page, away.click)
    assert not {"crosstalk", "crosstalk_stage"} & set(question["study"]["sensors"][0])


@pytest.mark.evidence
def test_a_value_of_the_pixel_goes_back_to_the_sensors_own(window):
    page = window({"study": {"sensors": [{"name": "onyx-rgbw"}]}})
    open_drawers(page)
    field = page.get_by_label("Pixel pitch in µm")
    assert field.get_attribute("placeholder") == "10"
    typed(page, field, "3.5")
    own = page.get_by_role("button", name="as built: Pixel pitch")
    assert own.inner_text() == "as built: 10"
    question, parts = answer_to(page, own.click)
    assert question["study"]["sensors"] == [{"name": "onyx-rgbw"}]
    assert parts["numbers"]["sensors"][0]["pitch_um"] == 10.0


@pytest.mark.evidence
def test_the_wheel_moves_the_slider_that_has_the_focus_and_no_other(window):
    page = window({"study": {"sensors": [{"name": "onyx-rgbw"}]}})
    track = page.get_by_label("f-number", exact=True)
    before = state_of(page)
    track.hover()
    page.mouse.wheel(0, -1)
    assert state_of(page) == before
    track.focus()
    question, _ = answer_to(page, lambda: page.mouse.wheel(0, -100))
    assert question["study"]["exposure"]["f_number"] > 1.8


@pytest.mark.evidence
def test_a_file_is_chosen_or_typed_beside_its_control_and_taken_away(window, tmp_path):
    page = window({"study": {"sensors": [{"name": "onyx-rgb-ircut"}]}})
    open_drawers(page)
    pixel, light = tmp_path / "own.toml", tmp_path / "kernel.csv"
    pixel.write_text('schema = "chromanoise pixel"\nschema_version = 1\nread_noise_e = 2.4\n')
    light.write_text("0, 0.05, 0\n0.05, 0.8, 0.05\n0, 0.05, 0\n")
    choose = page.get_by_role("button", name="Choose a file: File of the pixel of sensor 1")

    def chosen(path):
        with page.expect_file_chooser() as opened:
            choose.click()
        opened.value.set_files(path)

    chosen(light)
    wrong = page.locator(".row", has=choose).locator(".fault")
    wrong.wait_for()
    assert "not as pixel" in wrong.inner_text()
    question, parts = answer_to(page, lambda: chosen(pixel))
    assert re.fullmatch("upload:.*[.]toml", question["study"]["sensors"][0]["pixel"]["file"])
    assert parts["numbers"]["sensors"][0]["read_noise_e"] == 2.4
    assert wrong.count() == 0
    assert page.get_by_label("Read noise in e⁻").first.get_attribute("placeholder") == "2.4"
    page.get_by_role("button", name="Type a table").click()
    use = page.get_by_role("button", name="Use", exact=True)
    question, _ = answer_to(page, use.click)
    assert question["study"]["sensors"][0]["crosstalk"].startswith("upload:")
    away = page.get_by_role("button", name="Remove the file: Crosstalk to the neighbors")
    question, _ = answer_to(page, away.click)
    assert "crosstalk" not in question["study"]["sensors"][0]


@pytest.mark.evidence
def test_one_sensor_alone_has_a_verdict_and_every_drawing(window):
    page = window({"study": {"sensors": [{"name": "onyx-rgbw"}]}})
    assert "onyx-rgbw has" in page.locator("#verdict").inner_text()
    assert page.get_by_role("button", name="Remove sensor 1").is_disabled()
    at_rest(page)
    assert page.locator(".panel:not([data-part=picture]) .body:empty").count() == 0
    assert page.locator(".panel .fault:visible").count() == 0
    assert study_of(page) is None or len(study_of(page)["sensors"]) == 1
