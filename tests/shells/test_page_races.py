"""Answers, refusals and losses in every order: the page against a model of what it shows."""

from itertools import count, product

import pytest

from shells.browser import at_rest, comes, until

MOST_IN_FLIGHT = 2
SEEN_MS = 60
LEVEL = "Light level in lx"
SHOWN = """([hash, electrons, fault]) => document.documentElement.dataset.hash === hash
    && document.querySelector("#electrons").textContent.includes(electrons)
    && (document.querySelector("#controls .fault")?.textContent ?? null) === fault
    && document.querySelector("#faults").hidden === (fault === null)"""
NUMBERS = count(10)


class Races:
    """Acts of a person, of the server and of the network, and what the page must show then.

    The replies with numbers are kept back, the oldest question first, until they come or are lost.
    """

    def __init__(self, page):
        self.page = page
        self.holds, self.waiting = True, []
        self.newest_answer = self.newest_refusal = 0
        self.hash = page.evaluate("document.documentElement.dataset.hash")
        self.electrons = self.fault = ""
        page.route("**/api/answer", self._keep)

    def _keep(self, route):
        if self.holds and "numbers" in route.request.post_data_json["want"]:
            self.waiting.append((route, route.fetch()))
        else:
            route.fallback()

    def asks(self, sign=""):
        expected = min(len(self.waiting) + 1, MOST_IN_FLIGHT)
        self.level = f"1.{next(NUMBERS)}1"
        self.page.get_by_label(LEVEL).fill(f"{sign}{self.level}")
        self.page.get_by_label(LEVEL).press("Enter")
        comes(self.page, self.waiting, expected)

    def asks_what_is_refused(self):
        self.asks("-")

    def a_reply_comes(self, which):
        route, reply = self.waiting.pop(which)
        number, told = route.request.post_data_json["number"], reply.json()
        if "faults" in told and number > self.newest_refusal:
            self.newest_refusal, self.fault = number, told["faults"][0]["sentence"]
        elif "faults" not in told and number > self.newest_answer:
            self.newest_answer, self.hash = number, told["hash"]
            mean_e = told["parts"]["numbers"]["sensors"][0]["mean_e"]["G"]
            self.electrons = f"{mean_e:.4g}"
        route.fulfill(response=reply)
        self.page.wait_for_timeout(SEEN_MS)  # what must not be shown has had its time
        is_refused = self.newest_refusal > self.newest_answer
        until(self.page, SHOWN, [self.hash, self.electrons, self.fault if is_refused else None])

    def a_reply_is_lost(self, which):
        self.waiting.pop(which)[0].fulfill(status=503, json={})
        self.page.locator("#lost", has_text="busy").wait_for()

    def ends(self, *, refused):
        """What still waits, comes; what was asked last is shown, or its refusal, and no loss."""
        self.holds = False
        while self.waiting:  # what was lost is asked for once more
            route, reply = self.waiting.pop()
            route.fulfill(response=reply)
        self.page.locator("#lost").wait_for(state="hidden")
        self.page.locator("#faults").wait_for(state="visible" if refused else "hidden")
        at_rest(self.page)
        verdict = self.page.locator("#verdict").inner_text()
        assert refused or verdict.startswith(f"At {self.level} lx ")
        self.page.unroute("**/api/answer")


def pairs(rows):
    """Of all rows of five choices of two, eight in which each pair of choices occurs."""
    return [
        row
        for at, row in zip(product((0, 1), repeat=5), rows, strict=True)
        if at[3] == at[0] ^ at[1] and at[4] == at[0] ^ at[2]
    ]


@pytest.mark.parametrize("taken", [pairs, pytest.param(list, marks=pytest.mark.evidence)])
def test_whatever_the_order_of_replies_the_newest_is_shown_and_none_keeps_the_page_waiting(
    window, watch, taken
):
    watch.forgive("status of 400")
    page = window({"study": {"sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb"}]}})
    asking, coming = ("asks", "asks_what_is_refused"), ("a_reply_comes", "a_reply_is_lost")
    orders = ((0, 0), (-1, 0))
    rows = [*product(asking, asking, coming, coming, orders)]
    for one, two, third, fourth, order in taken(rows):
        races = Races(page)
        try:
            getattr(races, one)()
            getattr(races, two)()
            assert len(races.waiting) == MOST_IN_FLIGHT
            getattr(races, third)(order[0])
            getattr(races, fourth)(order[1])
            races.ends(refused=two == "asks_what_is_refused")
        except Exception as error:
            pytest.fail(f"{one}, {two}, {third}, {fourth} in order {order}: {error}")
