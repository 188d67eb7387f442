/** What is shown: a study, and how it is looked at. The address of the page always holds both. */

import { decoded, encoded, isRecord } from "app/address.js";

const STUDY = {
  light: { illuminant: "E", level_lux: 10 },
  exposure: { equal: "exposure", f_number: 1.8 },
  sensors: [{ name: "onyx-rgbw" }, { name: "onyx-rgb-ircut" }],
  matrices: ["kernel"],
};

const LOOK = {
  theme: "auto",
  coordinate: "Y",
  plane: "ab",
  turn: [30, 20],
  magnification: null,
  open: [],
};

/** How long after a step of a slider the next step starts a new entry of the history. */
const GESTURE_MS = 1000;
const WRITE_MS = 250;

let first = { study: STUDY, look: LOOK };
let state = structuredClone(first);
let writing = null;
let lastSlide = -Infinity;
const listeners = new Set();

/** The state now; read it, never write into it. */
export const current = () => state;

/** `listener(state, what)` is called after every change; `what` is "study", "look" or "all". */
export function subscribe(listener) {
  listeners.add(listener);
}

/** Changes the study: `edit` works on a copy. `how` is "step", or "slide" while a slider moves. */
export function changeStudy(edit, how = "step") {
  const study = structuredClone(state.study);
  edit(study);
  enter({ ...state, study }, how, "study");
}

/** Changes how it is looked at; the history keeps no entry of that. */
export function changeLook(edit) {
  const look = structuredClone(state.look);
  edit(look);
  enter({ ...state, look }, "look", "look");
}

/** Shows another study in the same look, as an entry of the history. */
export function replaceStudy(study) {
  enter({ ...state, study: structuredClone(study) }, "step", "all");
}

/** Reads the address; gives the sentence about a link that cannot be read, or null. */
export function readAddress() {
  const text = location.hash.slice(1);
  let complaint = null;
  let read = first;
  try {
    if (text) read = decoded(text);
  } catch (error) {
    complaint = error.message;
  }
  state = { study: structuredClone(read.study), look: knownLook(read.look) };
  tell("all");
  return complaint;
}

/** The study to start from where the address has none. */
export function startFrom(study) {
  if (isRecord(study)) first = { study, look: LOOK };
}

/** The whole address of the state now. */
export function link() {
  return `${location.origin}${location.pathname}#${encoded(state)}`;
}

function enter(next, how, what) {
  const now = performance.now();
  const starts = how === "step" || (how === "slide" && now - lastSlide > GESTURE_MS);
  if (how === "slide") lastSlide = now;
  const left = state;
  state = next;
  // the question leaves before the history is written, which takes its time
  tell(what);
  if (starts) {
    write("replaceState", left);
    write("pushState", state);
  } else writing ??= setTimeout(() => write("replaceState", state), WRITE_MS);
}

function write(method, written) {
  clearTimeout(writing);
  writing = null;
  history[method](null, "", `#${encoded(written)}`);
}

function tell(what) {
  for (const listener of listeners) listener(state, what);
}

/** Keys of another kind than ours are left at their defaults, so that no link breaks a drawing. */
function knownLook(look) {
  const known = structuredClone(LOOK);
  for (const key of Object.keys(known)) {
    if (fits(key, look[key])) known[key] = look[key];
  }
  return known;
}

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
const isText = (value) => typeof value === "string";
const FITS = {
  theme: (value) => ["auto", "light", "dark"].includes(value),
  coordinate: isText,
  plane: (value) => ["ab", "xy"].includes(value),
  turn: (value) => Array.isArray(value) && value.length === 2 && value.every(isNumber),
  magnification: isNumber,
  open: (value) => Array.isArray(value) && value.every(isText),
};
const fits = (key, value) => value !== undefined && FITS[key](value);
