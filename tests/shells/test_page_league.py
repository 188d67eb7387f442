"""The section of measured cameras on the page: its rows sort, and each opens its card."""

import pytest

import chromanoise as cn
from shells.browser import at_rest, framed, study_of, until

ROWS = "section[data-part=league] tbody tr"


@pytest.fixture
def league(window):
    """A window with the table of the league open."""
    page = window({"study": {"sensors": [{"name": "onyx-rgbw"}]}, "look": {"open": ["league"]}})
    page.locator("section[data-part=league]").scroll_into_view_if_needed()
    until(page, f"() => document.querySelectorAll('{ROWS}').length > 50")
    return page


def cells(page, column):
    rows = f"(i) => [...document.querySelectorAll('{ROWS}')].map((row) => row.cells[i].textContent)"
    return page.evaluate(rows, column)


def test_a_pressed_head_sorts_the_cameras_up_then_down_then_as_given(league):
    given = cells(league, 0)
    heads = league.locator("section[data-part=league] thead button")
    column = heads.all_inner_texts().index("color error [ΔE*ab]")
    best = min(one.color_error for one in cn.league(iso=100).cameras)
    heads.nth(column).click()
    values = [float(text) for text in cells(league, column)]
    assert values[0] == round(best, 2)
    assert values == sorted(values)
    heads.nth(column).click()
    assert [float(text) for text in cells(league, column)] == values[::-1]
    heads.nth(column).click()
    assert cells(league, 0) == given


def test_a_camera_of_the_table_opens_its_card_and_joins_the_study_once(league):
    name = "nikon-d850"
    for _ in range(2):
        league.locator(f"button[data-sensor={name}]").first.click()
        framed(league)
        assert [one["name"] for one in study_of(league)["sensors"]] == ["onyx-rgbw", name]
        card = league.locator("fieldset.card").nth(1)
        assert card.locator("select").first.evaluate("(node) => node === document.activeElement")
        assert card.locator("details.drawer").first.get_attribute("open") is not None
    at_rest(league)
    until(league, f"() => document.body.textContent.includes('{name}: color SNR loss')")
