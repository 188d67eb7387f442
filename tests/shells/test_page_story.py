"""The tour, the exposure time that is kept, and lights whose tables end early."""

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.apps.paper.reproduction import nir_share
from chromanoise.charts import shown
from chromanoise.study import study_from_data
from chromanoise.study.analysis import (
    color_snr_db,
    contravariant_snr_db,
    mean_color_error,
    raw_snr_db,
)
from chromanoise.web.controls import choices
from chromanoise.web.services import STUDY
from chromanoise.web.story import ALIKE_FROM_NM, story
from shells.browser import answer_to, pressed, state_of, study_of, until

STEPS = story(STUDY)["steps"]
SHARED = ("R", "G", "B")


def analyses_of(number):
    return shown(study_from_data(STEPS[number - 1]["study"], source="")).analyses


def text_of(number):
    return " ".join(STEPS[number - 1]["sentences"])


def test_each_step_has_a_few_sentences_a_task_and_charts_of_the_page():
    known = {section["part"] for section in choices()["sections"]}
    assert len(STEPS) == 5
    for step in STEPS:
        assert 2 <= len(step["sentences"]) <= 4
        assert step["task"]
        assert step["answer"]
        assert set(step["parts"]) <= known


def test_without_the_ir_cut_every_raw_channel_is_better_and_every_unmixed_one_worse():
    bare, cut = analyses_of(1)
    for name in SHARED:
        assert raw_snr_db(bare)[name] > raw_snr_db(cut)[name] + 3
        assert contravariant_snr_db(bare)[name] < contravariant_snr_db(cut)[name] - 3
    assert "38.1 dB, against 32.8 dB" in text_of(1)
    assert "worse SNR in R, G and B" in text_of(3)


def test_the_white_channel_is_nearly_a_mix_of_the_others():
    bare, cut = analyses_of(2)
    assert bare.vif[bare.sensor.names.index("W")] == bare.vif.max() > 4 * cut.vif.max()
    assert "0.70 R + 0.46 G + 0.52 B" in text_of(2)


def test_the_channels_without_ir_cut_are_nearly_equal_in_the_infrared_that_is_named():
    bare, _ = analyses_of(2)
    seen = bare.sensor.qe[bare.sensor.grid.wavelength_nm >= ALIKE_FROM_NM]
    assert (seen.max(axis=1) < 1.2 * seen.min(axis=1)).all()
    assert f"beyond {ALIKE_FROM_NM:.0f} nm" in text_of(2)


def test_the_tasks_are_right_about_an_ir_cut_in_front_of_the_rgbw_sensor():
    bare, cut650, cut700 = (
        cn.analyze("onyx-rgbw", lux=10, time_ms=11.94, **change).analyses[0]
        for change in ({}, {"ircut_nm": 650}, {"ircut_nm": 700})
    )
    rgb = np.triu_indices(3, 1)
    assert (cut650.between_deg[rgb] > bare.between_deg[rgb] + 10).all()
    assert cut650.mix.channel == "W"
    assert cut650.mix.angle_deg < bare.mix.angle_deg / 2
    for name in SHARED:
        assert raw_snr_db(cut700)[name] < raw_snr_db(bare)[name] - 2
    assert color_snr_db(cut700)["Y"] > color_snr_db(bare)["Y"] + 1


def test_more_than_half_of_the_electrons_are_infrared_and_none_behind_the_cut():
    bare, cut = analyses_of(4)
    assert nir_share(bare) == pytest.approx(0.55, abs=0.005)
    assert nir_share(cut) < 0.005
    assert "55 % of the electrons come from beyond 700 nm, in onyx-rgb-ircut 0 %" in text_of(4)


def test_the_color_picture_is_noisier_without_the_cut_except_for_lmmse_in_low_light():
    def y_db(lux, matrix):
        found = cn.analyze(
            "onyx-rgbw", "onyx-rgb-ircut", lux=lux, time_ms=11.94, matrix=matrix
        ).color_snr_db()
        return found["onyx-rgbw"]["Y"] - found["onyx-rgb-ircut"]["Y"]

    assert y_db(10.0, "kernel") == pytest.approx(26.0 - 32.4, abs=0.1)
    assert y_db(0.02, "kernel") < 0
    assert y_db(0.22, "lmmse") > 0 > y_db(0.3, "lmmse")
    assert "below 0.26 lx" in text_of(5)
    assert "30 and 28" in text_of(5)  # 29.6 and 27.8 in docs/findings.md


def test_the_answers_have_the_numbers_of_the_study_after_the_task():
    def found(lux=10, matrix="kernel", names=("onyx-rgbw", "onyx-rgb-ircut"), **change):
        return cn.analyze(*names, lux=lux, time_ms=11.94, matrix=matrix, **change).analyses

    answers = [step["answer"] for step in STEPS]
    dim = found(1)
    for name in SHARED:
        more, less = (f"{raw_snr_db(one)[name]:.1f} dB" for one in dim)
        assert f"{more} against {less} in {name}" in answers[0]
    deep, cut = (found(names=["onyx-rgbw"], ircut_nm=edge)[0] for edge in (650, 700))
    rgb = np.triu_indices(3, 1)
    assert f"to {deep.between_deg[rgb].min():.0f}° (G and B)" in answers[1]
    assert f"to {deep.mix.angle_deg:.0f}°" in answers[1]
    assert f"{np.hypot(1, 1):.1f} g" in answers[2]
    shorter, longer = answers[3].split("Longer")
    assert "infrared (" in shorter
    assert "filters (" in longer
    assert f"from 26.0 dB to {color_snr_db(cut)['Y']:.1f} dB" in answers[3]
    for one, faded in zip(found(0.1), found(0.1, "lmmse"), strict=True):
        before, after = (f"{mean_color_error(a):.0f}" for a in (one, faded))
        assert f"for {one.sensor.label} from {before} to {after} ΔE" in answers[4]
        assert f"{color_snr_db(one)['Y']:.1f} dB for {one.sensor.label}" in answers[4]


def comes_to(page, number):
    until(
        page,
        "(text) => document.querySelector('#h-story').textContent.startsWith(text)",
        f"Step {number} of 5",
    )


@pytest.mark.evidence
def test_the_tour_has_an_end_is_left_by_a_slider_and_can_be_resumed(window):
    page = window()
    own = study_of(page)
    page.get_by_role("button", name="Tour in 5 steps").focus()
    page.keyboard.press("Enter")
    comes_to(page, 1)
    assert page.evaluate("document.activeElement.id") == "h-story"
    for number in range(2, 6):
        page.get_by_role("button", name="Next").press("Enter")
        comes_to(page, number)
        state = state_of(page)
        assert state["look"]["story"] == number
        assert state["study"] == STEPS[number - 1]["study"]
        marked = page.locator(".story-here")
        parts = marked.evaluate_all("all => all.map((one) => one.dataset.part)")
        assert set(parts) == set(STEPS[number - 1]["parts"])
        assert f"Step {number} " in marked.first.inner_text()
        control = STEPS[number - 1]["control"]
        shown = page.locator(".story-control:visible [data-where]")
        keys = shown.evaluate_all("all => all.map((one) => one.dataset.where)")
        assert set(keys) == ({control} if control else set())
        answer = page.locator("#story details")
        assert STEPS[number - 1]["answer"] not in page.locator("#story").inner_text()
        answer.locator("summary").press("Enter")
        assert STEPS[number - 1]["answer"] in page.locator("#story").inner_text()
    page.get_by_role("button", name="End tour").press("Enter")
    page.locator("#story").wait_for(state="hidden")
    page.wait_for_url(lambda _: state_of(page)["look"]["story"] is None)
    assert study_of(page) == (own or STUDY)
    page.go_back()
    comes_to(page, 5)
    page.go_back()
    comes_to(page, 4)
    pressed(page, page.locator("[data-where='light.level_lux']"), "Shift+ArrowDown")
    assert page.locator("#story .story-left").inner_text()
    page.get_by_role("button", name="Restore step 4").click()
    until(page, "() => document.querySelector('#story .story-left').textContent === ''")
    page.wait_for_url(lambda _: study_of(page) == STEPS[3]["study"])
    page.get_by_role("button", name="Leave tour").click()
    page.locator("#story").wait_for(state="hidden")
    assert page.evaluate("document.activeElement.id") == "tour"
    assert page.locator(".story-here").count() == 0
    page.wait_for_url(lambda _: state_of(page)["look"]["story"] is None)
    assert study_of(page) == (own or STUDY)


@pytest.mark.evidence
def test_a_link_opens_the_tour_at_its_step(window):
    page = window({"study": STEPS[2]["study"], "look": {"story": 3}})
    comes_to(page, 3)
    assert page.locator("#story .story-left").inner_text() == ""
    page.locator("[data-part=stages].story-here").wait_for()
    until(
        page,
        "() => { const box = document.querySelector('.story-here').getBoundingClientRect();"
        " return box.top >= 0 && box.top < innerHeight / 2; }",
    )


@pytest.mark.evidence
def test_sliders_keep_the_exposure_time_unless_auto_exposure_is_on(window):
    page = window()
    switch = page.get_by_role("switch", name="Auto exposure")
    share = page.locator("[data-where='exposure.saturate']")
    level = page.locator("[data-where='light.level_lux']")
    assert not switch.is_checked()
    assert share.is_disabled()
    question, parts = pressed(page, level, "Shift+ArrowDown")
    first = question["study"]["exposure"]["time_ms"]
    assert first == 11.94
    assert all(one["time_ms"] == pytest.approx(first) for one in parts["numbers"]["sensors"])
    assert "11.94 ms, f/1.8" in page.locator("#verdict").inner_text()
    aperture = page.locator("[data-where='exposure.f_number']")
    question, parts = pressed(page, aperture, "Shift+ArrowDown")
    assert question["study"]["exposure"]["time_ms"] == first
    question, parts = answer_to(page, switch.click)
    assert "time_ms" not in question["study"]["exposure"]
    assert state_of(page)["look"]["auto_exposure"]
    assert not share.is_disabled()
    question, parts = pressed(page, level, "Shift+ArrowDown")
    solved = parts["numbers"]["sensors"][0]["time_ms"]
    assert "time_ms" not in question["study"]["exposure"]
    assert max(parts["numbers"]["sensors"][0]["mean_e"].values()) == pytest.approx(9900)
    question, _ = answer_to(page, switch.click)
    assert solved * 0.999 < question["study"]["exposure"]["time_ms"] <= solved
    answer_to(page, page.get_by_role("radio", name="saturation").click)
    assert switch.is_checked()
    assert switch.is_disabled()
    assert not share.is_disabled()


@pytest.mark.evidence
def test_a_light_that_ends_early_asks_how_it_continues_and_is_answered_at_once(window):
    page = window()
    before = study_of(page)
    page.locator("select[data-where='light.illuminant']").select_option("D65")
    asked = page.locator(".row:has(> [data-where='light.beyond'])")
    assert "780 nm" in asked.inner_text()
    assert study_of(page) == before
    hold = asked.get_by_role("radio", name="hold")
    assert not hold.is_checked()
    question, parts = answer_to(page, hold.click)
    assert question["study"]["light"] == {"illuminant": "D65", "level_lux": 10, "beyond": "hold"}
    assert any("D65: hold beyond" in one for one in parts["numbers"]["sensors"][0]["notes"])
    question, _ = answer_to(page, asked.get_by_role("radio", name="zero").click)
    assert question["study"]["light"]["beyond"] == "zero"
    light = page.locator("select[data-where='light.illuminant']")
    question, _ = answer_to(page, lambda: light.select_option("D50"))
    assert question["study"]["light"] == {"illuminant": "D50", "level_lux": 10, "beyond": "zero"}
    question, _ = answer_to(page, lambda: light.select_option("E"))
    assert question["study"]["light"] == {"illuminant": "E", "level_lux": 10}
    assert asked.is_hidden()


def test_every_light_of_the_page_covers_all_wavelengths_or_is_known_to_end_early():
    data = choices()
    ends = data["illuminant_ends_nm"]
    assert ends["D65"] == 780.0
    assert {"E", "A", "D65", "D50", "FL11"} <= set(data["illuminants"])
    assert set(ends) <= set(data["illuminants"])
    assert not {"E", "A", "G173", "halogen"} & set(ends)
