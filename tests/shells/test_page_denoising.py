"""Denoising on the page: its methods, the pictures with and without one, and the divider."""

import json
import sys

import numpy as np
import pytest

from chromanoise.imaging.denoising import DENOISING, DenoisingMethod
from chromanoise.web.controls import choices
from chromanoise.web.services import STUDY, Services
from chromanoise.web.uploads import Kept
from shells.browser import comes, held, let_go, picture_panel, study_of, until

PANEL = "[data-part=picture]"
AT_REST = f"() => !document.querySelector('{PANEL}').hasAttribute('aria-busy')"


@pytest.fixture
def calls(monkeypatch):
    """The planes that two registered methods got: `means`, and the baseline `theirs`."""
    seen = []

    def means(planes):
        seen.append(planes)
        mean = planes.values_e.mean(axis=(0, 1))
        return np.broadcast_to(mean, planes.values_e.shape).astype(np.float32)

    for name, baseline in (("means", False), ("theirs", True)):
        method = DenoisingMethod(
            name=name, what=f"The {name}.", denoise=means, reach_px=None, baseline=baseline
        )
        monkeypatch.setitem(DENOISING, name, method)
    return seen


def question(**given):
    pictures = [{"denoise": given.pop("denoise")}] if "denoise" in given else []
    return json.dumps({"study": STUDY | {"pictures": pictures}} | given).encode()


@pytest.mark.usefixtures("calls")
def test_the_page_offers_every_method_but_the_baselines():
    offered = choices.__wrapped__()["denoising"]
    assert {"name": "means", "what": "The means.", "needs": []} in offered
    assert "theirs" not in [one["name"] for one in offered]


def test_the_page_names_the_package_that_a_method_needs(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    needs = {one["name"]: one["needs"] for one in choices.__wrapped__()["denoising"]}
    assert (needs["patches"], needs["guided"]) == (["numba"], [])


def test_a_denoised_picture_is_computed_once_and_the_others_do_not_depend_on_it(calls):
    services = Services(Kept())
    plain, _ = services.picture(question())
    assert not calls
    denoised, summary = services.picture(question(denoise="means"))
    assert (denoised, summary) == services.picture(question(denoise="means"))
    assert len(calls) == 1
    assert any("means" in note for note in json.loads(summary)["notes"])
    assert len({plain, denoised}) == 2
    still, _ = services.picture(question(noisy=False))
    assert services.picture(question(noisy=False, denoise="means"))[0] == still
    assert len(calls) == 1


def test_kernels_of_a_method_are_compiled_before_the_time_limit_begins(calls):
    services = Services(Kept())
    services.prepare("picture", question())
    services.prepare("picture", b"{")
    services.prepare("picture", question(denoise="unknown"))
    assert not calls
    for _ in range(2):
        services.prepare("picture", question(denoise="means"))
    assert len(calls) == 1


def sides(panel):
    return [panel.get_by_label(side, exact=True).input_value() for side in ("Left", "Right")]


def labels(panel):
    return panel.locator(".d-captions span").all_inner_texts()


@pytest.mark.evidence
def test_the_noisy_picture_stands_on_both_sides_until_the_denoised_one_has_come(window):
    page = window()
    panel = page.locator(PANEL)
    panel.scroll_into_view_if_needed()
    until(page, AT_REST)
    waiting = held(page, lambda one: one.url.endswith("picture") and "denoise" in one.post_data)
    asked = []
    page.on("request", lambda one: one.url.endswith("/api/picture") and asked.append(one))
    panel.get_by_label("Denoising").select_option("guided")
    page.locator(f"{PANEL}[data-denoising=right]").wait_for()
    assert sides(panel) == ["0 noisy", "0 denoised"]
    assert labels(panel) == ["onyx-rgbw, noisy", "onyx-rgbw, noisy"]
    assert (
        page.evaluate(
            f"new Set([...document.querySelectorAll('{PANEL} img')].map(({{ src }}) => src)).size"
        )
        == 1
    )
    comes(page, waiting)
    let_go(waiting)
    until(page, AT_REST)
    assert labels(panel) == ["onyx-rgbw, noisy", "onyx-rgbw, denoised (guided)"]
    assert panel.get_attribute("data-denoising") is None
    pictures = [one.post_data_json["study"].get("pictures") for one in asked]
    assert pictures == [STUDY["pictures"], [STUDY["pictures"][0] | {"denoise": "guided"}]]
    assert DENOISING["guided"].what in panel.inner_text()


@pytest.mark.evidence
def test_the_divider_goes_by_keys_from_the_denoised_to_the_noisy_picture(window):
    page = window({"study": STUDY | {"pictures": [{"denoise": "guided"}]}})
    panel = picture_panel(page)
    divider = panel.get_by_role("slider")
    divider.focus()
    at = {}
    for key in ("Home", "ArrowRight", "End", "ArrowLeft"):
        page.keyboard.press(key)
        at[key] = page.evaluate(
            "Number(document.querySelector('.d-stack').style.getPropertyValue('--at'))"
        )
    assert at == {"Home": 0.0, "ArrowRight": 0.01, "End": 1.0, "ArrowLeft": 0.99}


@pytest.mark.evidence
def test_the_method_is_in_the_address_and_none_gives_back_both_sensors(window):
    page = window()
    panel = page.locator(PANEL)
    panel.scroll_into_view_if_needed()
    panel.get_by_label("Denoising").select_option("guided")
    page.wait_for_url(lambda _: (study_of(page) or {}).get("pictures"))
    assert study_of(page)["pictures"] == [STUDY["pictures"][0] | {"denoise": "guided"}]
    page.reload()
    panel.get_by_label("Denoising").wait_for()
    until(page, "() => document.querySelector('.picture-tools select').value === 'guided'")
    assert sides(panel) == ["0 noisy", "0 denoised"]
    panel.get_by_label("Denoising").select_option("")
    page.wait_for_url(lambda _: study_of(page)["pictures"] == STUDY["pictures"])
    assert sides(panel) == ["0 noisy", "1 noisy"]
