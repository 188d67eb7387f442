/** What is shown: a study, and how it is looked at. The address of the page always holds both. */

import { decoded, encoded } from "app/address.js";

/** @import { Look, State, Study } from "answers" */
/** @typedef {"step" | "slide" | "look"} How */
/** @typedef {"study" | "look" | "all"} What */

/** @type {Look} */
const LOOK = {
  theme: "auto",
  coordinate: "Y",
  plane: "ab",
  turn: [30, 20],
  magnification: null,
  open: [],
  auto_exposure: false,
  story: null,
};

/** How long after a step of a slider the next step starts a new entry of the history. */
const GESTURE_MS = 1000;
const WRITE_MS = 250;

/** Without sensors until the server has told its study. */
/** @type {{ study: Study, look: Partial<Look> }} */
let first = { study: { sensors: [] }, look: LOOK };
/** @type {State} */
let state = { study: { sensors: [] }, look: structuredClone(LOOK) };
/** @type {number | undefined} */
let writing;
let lastSlide = -Infinity;
/** @type {(state: State) => unknown} */
let keep = () => {};
/** @type {Set<(state: State, what: What, how: How) => void>} */
const listeners = new Set();

/** The state now; read it, never write into it. */
export const current = () => state;

/**
 * `listener(state, what, how)` is called after every change; `what` is "study", "look" or "all".
 *
 * @param {(state: State, what: What, how: How) => void} listener
 */
export function subscribe(listener) {
  listeners.add(listener);
}

/**
 * What is to be written into a study before a slider changes it.
 *
 * @param {(state: State) => unknown} edit
 */
export function beforeSliding(edit) {
  keep = edit;
}

/**
 * Changes the study: `edit` works on a copy. `how` is "step", or "slide" while a slider moves.
 *
 * @param {(study: Study) => unknown} edit
 * @param {How} [how]
 */
export function changeStudy(edit, how = "step") {
  changeState(({ study }) => edit(study), how);
}

/**
 * Changes the study and how it is looked at; as `changeStudy`.
 *
 * @param {(state: State) => unknown} edit
 * @param {How} [how]
 */
export function changeState(edit, how = "step") {
  const next = structuredClone(state);
  if (how === "slide") keep(next);
  edit(next);
  enter(next, how, "study");
}

/**
 * Changes how it is looked at; the history keeps no entry of that.
 *
 * @param {(look: Look) => unknown} edit
 */
export function changeLook(edit) {
  const look = structuredClone(state.look);
  edit(look);
  enter({ ...state, look }, "look", "look");
}

/**
 * Shows another study in the same look, as an entry of the history.
 *
 * @param {Study} study
 */
export const replaceStudy = (study) => showState(study, {});

/**
 * Shows another study, with some of its look, as an entry of the history.
 *
 * @param {Study} study
 * @param {Partial<Look>} look
 */
export function showState(study, look) {
  enter(structuredClone({ study, look: { ...state.look, ...look } }), "step", "all");
}

/** Reads the address; gives the sentence about a link that cannot be read, or null. */
export function readAddress() {
  const text = location.hash.slice(1);
  let complaint = null;
  let read = first;
  try {
    if (text) read = decoded(text);
  } catch (error) {
    complaint = error instanceof Error ? error.message : String(error);
  }
  state = { study: structuredClone(read.study), look: knownLook(read.look) };
  tell("all", "step");
  return complaint;
}

/**
 * The study to start from where the address has none.
 *
 * @param {Study} study
 */
export function startFrom(study) {
  first = { study, look: LOOK };
}

/** The whole address of the state now. */
export function link() {
  return `${location.href.split("#")[0]}#${encoded(state)}`;
}

/**
 * @param {State} next
 * @param {How} how
 * @param {What} what
 */
function enter(next, how, what) {
  const now = performance.now();
  const starts = how === "step" || (how === "slide" && now - lastSlide > GESTURE_MS);
  if (how === "slide") lastSlide = now;
  const left = state;
  state = next;
  // the question leaves before the history is written, which takes its time
  tell(what, how);
  if (starts) {
    write("replaceState", left);
    write("pushState", state);
  } else writing ??= setTimeout(() => write("replaceState", state), WRITE_MS);
}

/**
 * @param {"replaceState" | "pushState"} method
 * @param {State} written
 */
function write(method, written) {
  clearTimeout(writing);
  writing = undefined;
  history[method](null, "", `#${encoded(written)}`);
}

/**
 * @param {What} what
 * @param {How} how
 */
function tell(what, how) {
  for (const listener of listeners) listener(state, what, how);
}

/**
 * Keys of another kind than ours are left at their defaults, so that no link breaks a drawing.
 *
 * @param {Partial<Look>} look
 * @returns {Look}
 */
function knownLook(look) {
  const told = /** @type {Record<string, unknown>} */ (look);
  const fitting = Object.keys(LOOK).filter((key) => told[key] !== undefined && FITS[key](told[key]));
  return { ...structuredClone(LOOK), ...Object.fromEntries(fitting.map((key) => [key, told[key]])) };
}

/** @param {unknown} value */
const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
/** @param {unknown} value */
const isText = (value) => typeof value === "string";
/** @type {Record<string, (value: unknown) => boolean>} */
const FITS = {
  theme: (value) => value === "auto" || value === "light" || value === "dark",
  coordinate: isText,
  plane: (value) => value === "ab" || value === "xy",
  turn: (value) => Array.isArray(value) && value.length === 2 && value.every(isNumber),
  magnification: isNumber,
  open: (value) => Array.isArray(value) && value.every(isText),
  auto_exposure: (value) => typeof value === "boolean",
  story: (value) => Number.isInteger(value) && Number(value) > 0,
};
