"""A browser that looks at the page: what the tests of the page share.

Whoever opens a page with it fails where the page complains on its console, or asks anything of
anybody but its own server.
"""

import base64
import json
import re

import pytest

from served_page import chromium_path, served

TIMEOUT_MS = 120_000  # for a machine that other programs keep busy
DRAWN = "section.panel[data-part]:not([data-part=picture])"


EVERYTHING = {  # a study in which every control has something to change
    "light": {"illuminant": "E+0.5xLED850", "level_lux": 8.0},
    "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut"}, {"name": "onyx-rgb"}],
    "matrices": ["noise-regularized=1"],
}


@pytest.fixture(scope="session")
def page_address():
    """Where a server listens, one for all tests of a process."""
    with served() as (where, _):
        yield where


@pytest.fixture(scope="module")  # playwright's event loop runs as long as it does
def chromium():
    """Chromium, one for all tests of a module."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = chromium_path()
    if program is None:
        pytest.skip("there is no chromium; apt-get install chromium")
    playwright.expect.set_options(timeout=TIMEOUT_MS)
    with playwright.sync_playwright() as started:
        one = started.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield one
        one.close()


@pytest.fixture(scope="module")
def browser(chromium):
    """From settings the context that has them.

    The windows of a context share what it has fetched and compiled, so they open in half the time.
    """
    contexts = {}

    def context(settings):
        key = json.dumps(settings, sort_keys=True)
        if key not in contexts:
            contexts[key] = chromium.new_context(**settings)
            contexts[key].set_default_timeout(TIMEOUT_MS)
        return contexts[key]

    return context


class Watch:
    """What went wrong in the windows of a test; `forgive` takes patterns of what has to."""

    def __init__(self):
        self.wrong = []
        self.outside = []
        self.forgiven = [re.compile("status of 503")]  # the page asks again where it is busy

    def forgive(self, pattern):
        self.forgiven.append(re.compile(pattern))

    def hear(self, kind, text):
        if kind in ("error", "warning"):
            self.wrong.append(f"{kind}: {text}")

    def refuse(self, route):
        self.outside.append(route.request.url)
        route.abort()

    def unforgiven(self):
        return [text for text in self.wrong if not any(p.search(text) for p in self.forgiven)]


@pytest.fixture
def watch():
    """What the windows of this test complain of; at its end it has to be nothing."""
    one = Watch()
    yield one
    assert one.unforgiven() == [], one.unforgiven()
    assert one.outside == []


@pytest.fixture(scope="module")
def address(page_address):
    """Where the page is; a module may have a server of its own."""
    return page_address


@pytest.fixture
def window(browser, address, watch):
    """Open the page in a new window and wait for its first numbers."""
    pages = []

    def opened(state=None, *, at=None, wait=True, **settings):
        page = browser({"viewport": {"width": 1280, "height": 900}} | settings).new_page()
        pages.append(page)
        where = at or address
        page.route(re.compile(f"^(?!{re.escape(where)}|blob:|data:)"), watch.refuse)
        page.on("console", lambda result: watch.hear(result.type, result.text))
        page.on("pageerror", lambda error: watch.hear("error", str(error)))
        page.goto(where + ("" if state is None else f"#{packed(state)}"))
        if wait:
            at_rest(page)
        for old in page.context.pages:
            if old not in pages:
                old.close()
        return page

    yield opened
    for page in pages:
        page.context.clear_permissions()
        if page is pages[-1] and page.url.startswith(address):
            page.unroute_all(behavior="ignoreErrors")
            page.goto("about:blank")  # its process stays for the next window, and what it compiled
        else:
            page.close()


@pytest.fixture
def page(window):
    """A window with `EVERYTHING`, all drawers open."""
    one = window({"study": EVERYTHING, "look": {}})
    open_drawers(one)
    return one


def open_drawers(page):
    """Open every drawer; the content of some is made when they are opened."""
    page.evaluate(
        """() => {
            for (;;) {
                const closed = document.querySelectorAll("details:not([open])");
                if (closed.length === 0) return;
                for (const one of closed) {
                    one.open = true;
                    one.dispatchEvent(new Event("toggle"));
                }
            }
        }"""
    )


def packed(state):
    """A state as the address holds it; text goes in as it is."""
    if isinstance(state, str):
        return state
    return base64.urlsafe_b64encode(json.dumps(state).encode()).decode().rstrip("=")


def state_of(page):
    """The state that the address holds now, or None."""
    _, _, text = page.url.partition("#")
    return json.loads(base64.urlsafe_b64decode(text + "=" * (-len(text) % 4))) if text else None


def study_of(page):
    """The study that the address holds now, or None where it holds none."""
    try:
        return state_of(page)["study"]
    except (KeyError, TypeError, ValueError):
        return None


def until(page, truth, argument=None):
    """Wait, frame by frame, until a JavaScript function of `argument` is true."""
    # not wait_for_function: the policy of the page allows no text that becomes code
    waiting = f"""(told) => new Promise((done, failed) => {{
        const until = performance.now() + {TIMEOUT_MS};
        const look = () => {{
            if (({truth})(told)) return done(true);
            if (performance.now() > until) return failed(new Error("never true: " + {truth!r}));
            setTimeout(look, 10);
        }};
        look();
    }})"""
    page.evaluate(waiting, argument)


def framed(page):
    """Wait for the next frame, in which the page draws its controls."""
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")


def at_rest(page):
    """Wait until every drawing has been made of the state that is shown."""
    until(page, "() => Number(document.documentElement.dataset.painted) > 0")
    busy = f"{DRAWN}[aria-busy], #verdict[aria-busy]"
    until(page, f"() => document.querySelectorAll('{busy}').length === 0")


def painted(page):
    """The number of the last answer that was painted."""
    return int(page.evaluate("document.documentElement.dataset.painted"))


def answer_to(page, act, *, changes="study"):
    """Act, and wait until what came of it is painted: the question, and the answer's parts."""
    before = asked_last(page)

    def is_it(reply):
        if not reply.url.endswith("/api/answer") or reply.status == 503:  # it asks again
            return False
        question = reply.request.post_data_json
        return question["number"] > 0 and question[changes] != before.get(changes)

    with page.expect_response(is_it) as caught:
        act()
    reply = caught.value
    question = reply.request.post_data_json
    assert reply.status == 200, reply.text()
    until(
        page,
        "(n) => Number(document.documentElement.dataset.painted) >= n",
        question["number"],
    )
    until(page, "() => !document.querySelector('#verdict[aria-busy]')")  # it is asked for later
    page.asked_last = question
    return question, reply.json()["parts"]


def pressed(page, control, key):
    """The answer, as of `answer_to`, to a key that is pressed on a control."""
    control.focus()
    return answer_to(page, lambda: page.keyboard.press(key))


def typed(page, field, text):
    """The answer, as of `answer_to`, to a text that is typed into a field."""
    field.fill(text)
    return answer_to(page, lambda: field.press("Enter"))


def picture_panel(page):
    """The panel of the picture, in sight and with the first picture in it."""
    panel = page.locator("[data-part=picture]")
    panel.scroll_into_view_if_needed()
    panel.locator("img").first.wait_for()
    return panel


def asked_last(page):
    """The last question that `answer_to` saw, else the one that the address stands for."""
    known = getattr(page, "asked_last", None)
    return known or {"study": study_of(page), "look": None}


def in_address(page, study):
    """Wait until the address holds this study."""
    page.wait_for_url(lambda _: study_of(page) == study)


def shown(page):
    """All words and numbers of the drawings; the picture comes when all else is at rest."""
    drawn = "#panels .panel:not([data-part=picture]) .body"
    return page.evaluate(
        f"[...document.querySelectorAll('#verdict, #reasons, {drawn}')]"
        ".map((node) => node.textContent).join('\\n')"
    )


def held(page, is_it):
    """Replies whose question fits are kept back: the list of those that wait to be let go."""
    waiting = []

    def keep(route):
        if is_it(route.request):
            waiting.append((route, route.fetch()))
        else:
            route.fallback()

    page.route("**/api/**", keep)
    return waiting


def let_go(waiting, count=1):
    for _ in range(count):
        route, reply = waiting.pop(0)
        route.fulfill(response=reply)


def comes(page, waiting, count=1):
    """Wait until so many replies are held back."""
    for _ in range(TIMEOUT_MS // 10):
        if len(waiting) >= count:
            return
        page.wait_for_timeout(10)
    raise AssertionError(f"{len(waiting)} replies came, not {count}")


def moved_by_key(page, track):
    """Ten places up or, from the end, down."""
    track.focus()
    ends = float(track.input_value()) >= float(track.get_attribute("max")) - 10
    page.keyboard.press("Shift+ArrowDown" if ends else "Shift+ArrowUp")
