/** The tour: each step is a state of the page, with a few sentences about what it shows. */

import { understood } from "app/ask.js";
import { button, el, reveal, say } from "app/dom.js";
import { current, showState, subscribe } from "app/state.js";

/** @import { State, Story, StoryStep, Study } from "answers" */

/** Charts above a panel grow while they come, so its place is looked at again after these times. */
const SETTLING_MS = [600, 1400, 2600];
const END =
  "This is the last step. After the tour, replace a sensor with another one from the catalog or with your own file, and compare.";
const LOST = "The tour cannot be loaded; is chromanoise serve still running?";

/**
 * Shows the step that the state names, in `section`; `start` is the button that starts the tour.
 *
 * @param {HTMLElement} section
 * @param {HTMLElement} start
 */
export function guidedStory(section, start) {
  /** @type {StoryStep[]} */
  let steps = [];
  /** @type {Study | null} what was shown before the tour began */
  let before = null;
  /** @type {number | null} the step that is shown */
  let shown = null;
  const parts = storyParts(section, { go: (by) => go(number() + by), leave: () => leave() });

  const number = () => current().look.story ?? 0;
  /** @param {number} to */
  const go = async (to) => {
    if (!(await loaded())) return;
    if (!number()) before = current().study;
    const step = steps[to - 1];
    showState(step.study, { ...step.look, story: to });
  };
  const leave = () => {
    const untouched = steps[number() - 1] && same(steps[number() - 1].study, current().study);
    showState((untouched && before) || current().study, { story: null });
    start.focus();
  };
  const loaded = async () => {
    try {
      if (!steps.length) steps = /** @type {Story} */ (await understood(await fetch("/api/story"))).steps;
      return true;
    } catch {
      section.hidden = false;
      parts.lost(LOST);
      return false;
    }
  };
  /** @param {State} state */
  const show = async (state) => {
    if (state.look.story === null) return end();
    // what comes after a wait is the state of then
    if (!steps.length && !(await loaded())) return undefined;
    const { study, look } = current();
    const step = steps[(look.story ?? 0) - 1];
    if (!step) return end();
    parts.show(step, look.story ?? 0, steps.length, !same(step.study, study));
    section.hidden = false;
    start.hidden = true;
    if (shown === look.story) return undefined;
    shown = look.story;
    return point(step, shown ?? 0);
  };
  const end = () => {
    shown = null;
    section.hidden = true;
    start.hidden = false;
    before = null;
    unpoint();
  };
  start.addEventListener("click", async () => {
    await go(1);
    parts.heading.focus({ preventScroll: true });
  });
  section.addEventListener("keydown", ({ key }) => key === "Escape" && leave());
  new ResizeObserver(() => {
    document.documentElement.style.setProperty("--story-height", `${section.offsetHeight}px`);
  }).observe(section);
  start.hidden = false;
  subscribe(show);
}

/**
 * The heading, the sentences and the buttons.
 *
 * @param {HTMLElement} section
 * @param {{ go: (by: number) => unknown, leave: () => unknown }} on
 */
function storyParts(section, { go, leave }) {
  const heading = el("h2", { id: "h-story", tabindex: "-1" });
  const text = el("div", { class: "story-text", tabindex: "0", role: "group", "aria-labelledby": "h-story" });
  const announced = el("p", { class: "unseen", role: "status" });
  const left = el("p", { class: "story-left", role: "status" });
  const back = button("", () => go(0));
  const previous = button("Previous", () => go(-1));
  let isEnd = false;
  const title = "Returns to the study before the tour, or keeps the study that you changed";
  const next = button("Next", () => (isEnd ? leave() : go(1)), { class: "primary" });
  const away = button("Leave tour", leave, { title });
  const buttons = el("div", { class: "tools" }, back, previous, next, away);
  section.replaceChildren(el("div", { class: "story-head" }, heading, left, buttons), text, announced);
  /**
   * @param {StoryStep} step
   * @param {number} number
   * @param {number} count
   * @param {boolean} isLeft whether the study is no longer that of the step
   */
  const show = (step, number, count, isLeft) => {
    isEnd = number === count;
    const named = `Step ${number} of ${count}: ${step.heading}`;
    if (heading.textContent !== named) {
      say(heading, named);
      say(announced, named);
      const answer = el("details", { class: "story-answer" }, el("summary", { text: "Answer" }), el("p", { text: step.answer }));
      const task = el("div", { class: "story-task" }, el("p", { text: step.task }), answer);
      text.replaceChildren(...step.sentences.map((sentence) => el("p", { text: sentence })), task);
      if (isEnd) text.append(el("p", { text: END }));
      text.scrollTop = 0;
    }
    const focus = document.activeElement;
    say(left, isLeft ? "You changed something: the numbers in the text are those of the step." : "");
    back.hidden = !isLeft;
    say(back, `Restore step ${number}`);
    previous.hidden = number === 1;
    next.hidden = false;
    say(next, isEnd ? "End tour" : "Next");
    away.hidden = isEnd;
    if (focus instanceof HTMLElement && focus.hidden) next.focus();
  };
  /** @param {string} sentence */
  const lost = (sentence) => {
    say(left, sentence);
    for (const one of [back, previous, next]) one.hidden = true;
  };
  return { heading, show, lost };
}

/** @param {string} part */
const panelOf = (part) => document.querySelector(`#panels > [data-part="${part}"]`);

function unpoint() {
  for (const note of document.querySelectorAll(".story-note")) note.remove();
  for (const panel of document.querySelectorAll(".story-here")) panel.classList.remove("story-here");
  for (const control of document.querySelectorAll(".story-control")) control.classList.remove("story-control");
}

/**
 * Marks the panels of a step and the control of its task, and scrolls to the first panel.
 *
 * @param {StoryStep} step
 * @param {number} number
 */
function point(step, number) {
  unpoint();
  const found = step.parts.map(panelOf).filter((panel) => panel !== null);
  for (const panel of found) {
    panel.classList.add("story-here");
    panel.querySelector(".head")?.after(el("p", { class: "story-note", text: `\u25b6 Step ${number} is about this chart.` }));
  }
  if (step.control) {
    reveal(step.control);
    const control = document.querySelector(`#controls [data-where="${step.control}"]`)?.closest(".row");
    control?.classList.add("story-control");
    control?.scrollIntoView({ block: "center" });
  }
  if (found.length) scrollTo(found[0]);
}

/** @type {AbortController | undefined} */
let scrolling;

/**
 * Scrolls to a panel, and again while charts that come move it, until somebody scrolls.
 *
 * @param {Element} panel
 */
function scrollTo(panel) {
  scrolling?.abort();
  scrolling = new AbortController();
  const { signal } = scrolling;
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  const to = () => panel.scrollIntoView({ block: "start", behavior: calm ? "auto" : "smooth" });
  for (const event of ["wheel", "touchmove", "pointerdown", "keydown"]) {
    window.addEventListener(event, () => scrolling?.abort(), { signal, passive: true });
  }
  requestAnimationFrame(to);
  for (const wait of SETTLING_MS) setTimeout(() => signal.aborted || to(), wait);
}

/**
 * Whether two studies say the same, in whatever order.
 *
 * @param {unknown} one
 * @param {unknown} other
 */
function same(one, other) {
  return JSON.stringify(sorted(one)) === JSON.stringify(sorted(other));
}

/**
 * @param {any} value
 * @returns {any}
 */
function sorted(value) {
  if (Array.isArray(value)) return value.map(sorted);
  if (typeof value !== "object" || value === null) return value;
  return Object.fromEntries(Object.keys(value).sort().map((key) => [key, sorted(value[key])]));
}
