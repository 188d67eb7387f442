"""In whatever order its answers come, or are lost, the page ends at its newest state."""

from functools import cache

from hypothesis import HealthCheck, Phase, settings, strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    precondition,
    rule,
    run_state_machine_as_test,
)

from chromanoise.charts import drawing, shown
from chromanoise.study import study_from_data
from shells.browser import at_rest, held, open_drawers, packed, until

LEVELS = (2.0, 3.0, 4.0, 6.0, 8.0)
FILTER = "[data-where='sensors.0.filter']"
FEW = settings(
    max_examples=5,
    stateful_step_count=12,
    deadline=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
    database=None,
)


def study_at(level_lux):
    light, exposure = {"level_lux": level_lux}, {"time_ms": 5.0}
    return {"sensors": [{"name": "onyx-rgb-ircut"}], "light": light, "exposure": exposure}


@cache
def electrons_at(level_lux):
    """The electrons of channel G as the table of the sensors has them."""
    ranking = drawing("head", shown(study_from_data(study_at(level_lux), source="")))["ranking"]
    keys = [one["key"] for one in ranking["columns"]]
    return ranking["rows"][0]["text"][keys.index("mean_e.G")]


def test_the_page_shows_its_newest_state_in_whatever_order_its_answers_come(window, watch):
    page = window({"study": study_at(LEVELS[0]), "look": {}})
    open_drawers(page)
    level = page.get_by_label("Light level in lx")
    kind = page.locator(FILTER)
    fault = page.locator(".row", has=kind).locator(".fault")

    def type_in(field, text):
        field.fill(text)
        field.press("Enter")

    def shows(text):
        cell = "document.querySelector(\"#electrons td[data-key='mean_e.G']\")"
        until(page, f"(text) => {cell}?.textContent.startsWith(text)", text)

    class Page(RuleBasedStateMachine):
        """The model: the level that was typed last, and whether the filter has a wrong name."""

        def __init__(self):
            super().__init__()
            page.evaluate("(to) => (location.hash = to)", packed({"study": study_at(LEVELS[0])}))
            shows(electrons_at(LEVELS[0]))
            at_rest(page)
            self.level, self.is_wrong = LEVELS[0], False
            self.waiting = held(page, lambda request: request.url.endswith("/api/answer"))

        @rule(level_lux=st.sampled_from(LEVELS))
        def another_level(self, level_lux):
            type_in(level, f"{level_lux:g}")
            self.level = level_lux

        @rule(is_wrong=st.booleans())
        def another_filter(self, is_wrong):
            type_in(kind, "nosuchone" if is_wrong else "")
            self.is_wrong = is_wrong

        @precondition(lambda self: self.waiting)
        @rule(i=st.integers(0, 9), is_lost=st.booleans())
        def an_answer_comes_or_is_lost(self, i, is_lost):
            route, reply = self.waiting.pop(i % len(self.waiting))
            if is_lost:
                route.fulfill(status=503, json={})
            else:
                route.fulfill(response=reply)

        def teardown(self):
            page.unroute("**/api/**")
            for route, reply in self.waiting:
                route.fulfill(response=reply)
            if self.is_wrong:
                fault.filter(has_text="nosuchone").wait_for()
                return
            shows(electrons_at(self.level))
            at_rest(page)
            fault.wait_for(state="hidden")

    run_state_machine_as_test(Page, settings=FEW)
    watch.forgive("status of 503")
