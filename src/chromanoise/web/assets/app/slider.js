/** One number: a labelled native slider, a field to type it in, its unit, and a word beside. */

import { attribute, brief, el, uniqueId, say } from "app/dom.js";
import { complain } from "app/faults.js";

/** @import { Range } from "answers" */
/** @typedef {(value: number | null) => unknown} Take */
/**
 * @typedef {object} SliderOptions
 * @property {string} label
 * @property {string} unit
 * @property {Range} range
 * @property {string} where key of the study
 * @property {Take} on
 * @property {string | null} [own] words of the button that takes the value away
 * @property {string} [aside]
 */
/** @typedef {ReturnType<typeof elements>} Elements */
/** @typedef {Elements & { shown?: string, place?: string, told?: string }} Parts */

/** Places on a slider whose scale tells no step. */
const PLACES = 240;

/**
 * The unit as it stands beside a number: none for pure numbers, a true minus for electrons.
 *
 * @param {{ unit?: string }} slider
 */
export function shownUnit({ unit = "" }) {
  return UNITS[unit] ?? unit.replace("e-", "e\u207b");
}

/** @type {Record<string, string>} */
const UNITS = { 1: "", "f/#": "", um: "\u00b5m", C: "\u00b0C" };

/**
 * How a slider's places become values: `{places, valueAt(place), placeOf(value)}`.
 *
 * @param {Range} range
 */
export function scaleOf({ low, high, scale, step, whole }) {
  if (scale !== "log") {
    const places = Math.max(1, Math.round((high - low) / (step || (high - low) / PLACES)));
    const width = (high - low) / places;
    /** @param {number} place */
    const valueAt = (place) => Number((low + place * width).toPrecision(6));
    return { places, valueAt, placeOf: /** @param {number} value */ (value) => (value - low) / width };
  }
  const span = Math.log(high / low);
  // a step of a log scale is a share of a decade
  const places = step ? Math.max(1, Math.round(span / Math.LN10 / step)) : PLACES;
  /** @param {number} place */
  const exact = (place) => Number((low * Math.exp((span * place) / places)).toPrecision(3));
  /** @param {number} place */
  const valueAt = (place) => (whole ? Math.round(exact(place)) : exact(place));
  /** @param {number} value */
  const placeOf = (value) => (places * Math.log(value / low)) / span;
  return { places, valueAt, placeOf };
}

/**
 * A slider with its number field.
 *
 * `on(value)` gets a number, or `null` where `own` (the words of a button) gives it back to what
 * the study says without it. `show(value, meanwhile, words)` shows a value; where it is `null`
 * the slider stands at `meanwhile` and the field shows that, or `words`, as a hint.
 *
 * @param {SliderOptions} options
 */
export function slider({ label, unit, range, where, on, own = null, aside = "" }) {
  const parts = elements({ label, unit, range, where, own, aside });
  const { scale, track, field, back } = parts;
  const typed = () => readField(parts, on);
  track.addEventListener("input", () => on(scale.valueAt(Number(track.value))));
  track.addEventListener("keydown", (event) => strides(event, parts, on));
  for (const node of [track, field]) {
    node.addEventListener("wheel", (event) => wheels(event, parts, on), { passive: false });
  }
  field.addEventListener("change", typed);
  field.addEventListener("keydown", (event) => stepsInField(event, parts, on));
  back?.addEventListener("click", () => {
    on(null);
    track.focus();
  });
  return {
    row: parts.row,
    /**
     * @param {number | null | undefined} value
     * @param {number | null} [meanwhile]
     * @param {string | null} [words]
     * @param {number | null} [origin] what `own` gives, if that is known
     */
    show: (value, meanwhile = null, words = null, origin = null) =>
      show(parts, value, meanwhile, { unit, own, words, origin }),
    /** @param {boolean} enabled */
    enable: (enabled) => enable(parts, enabled),
  };
}

/** @param {Omit<SliderOptions, "on">} options */
function elements({ label, unit, range, where, own, aside }) {
  const scale = scaleOf(range);
  const id = uniqueId("slider");
  const ends = { type: "range", min: 0, max: scale.places, step: 1 };
  const track = el("input", { id, ...ends, "data-where": where, class: "track" });
  const fieldName = unit ? `${label} in ${unit}` : `${label}, as a number`;
  const field = el("input", {
    type: "text",
    inputmode: "decimal",
    autocomplete: "off",
    spellcheck: "false",
    "aria-label": fieldName,
    placeholder: own ? "own" : null,
    class: "field",
  });
  const back = own ? el("button", { type: "button", class: "own", text: own }) : null;
  if (back) back.setAttribute("aria-label", `${own}: ${label}`);
  const named = el("label", { for: id, class: "label", text: label });
  const quiet = el("span", { class: "aside", text: aside });
  const head = el("div", { class: "row-head" }, named, quiet, back);
  const value = el("div", { class: "value" }, field, el("span", { class: "unit", text: unit }));
  const row = el("div", { class: "row row-slider" }, head, track, value);
  return { scale, track, field, back, row, label };
}

/**
 * @param {Parts} parts
 * @param {number | null | undefined} value
 * @param {number | null} meanwhile
 * @param {{ unit: string, own: string | null, words: string | null, origin: number | null }} texts
 */
function show(parts, value, meanwhile, { unit, own, words, origin }) {
  const { scale, track, field, back } = parts;
  // the same again costs the browser a layout, and there are many sliders
  const key = `${value} ${meanwhile} ${words} ${origin}`;
  const untouched = parts.shown === key && !field.hasAttribute("aria-invalid");
  if (untouched && track.value === parts.place && field.value === parts.told) return;
  const known = value ?? meanwhile;
  const place = known === null || known === undefined ? 0 : scale.placeOf(known);
  const held = Number.isNaN(place) ? 0 : Math.min(Math.max(place, 0), scale.places);
  const told = value === null || value === undefined ? "" : String(value);
  const at = String(Math.round(held));
  Object.assign(parts, { shown: key, place: at, told });
  // a slider that is being moved already stands there; writing it again would make it jump
  if (track.value !== at) track.value = at;
  if (field.value !== told) field.value = told;
  const hint = words ?? (meanwhile === null ? "own" : brief(meanwhile));
  attribute(track, "aria-valuetext", `${told === "" ? hint : told} ${unit}`.trim());
  attribute(field, "aria-invalid", null);
  attribute(field, "placeholder", told === "" || own ? hint : null);
  if (!back) return;
  back.hidden = told === "";
  if (origin !== null) say(back, `${own}: ${brief(origin)}`);
}

/**
 * @param {Parts} parts
 * @param {boolean} enabled
 */
function enable({ track, field, back }, enabled) {
  for (const node of [track, field, back]) if (node) attribute(node, "disabled", !enabled);
}

/**
 * Shift with an arrow goes ten places; Page Up and Page Down are the browser's own tenths.
 *
 * @param {KeyboardEvent} event
 * @param {Parts} parts
 * @param {Take} on
 */
function strides(event, { scale, track }, on) {
  const way = WAYS[event.key];
  if (!way || !event.shiftKey) return;
  event.preventDefault();
  steps(10 * way, { scale, track }, on);
}

/**
 * So many places on; the next step begins there, though the controls are shown later.
 *
 * @param {number} places
 * @param {Pick<Parts, "scale" | "track">} parts
 * @param {Take} on
 */
function steps(places, { scale, track }, on) {
  const place = Number(track.value) + places;
  track.value = String(Math.min(Math.max(place, 0), scale.places));
  on(scale.valueAt(Number(track.value)));
}

/**
 * The wheel moves what has the focus; over all else it scrolls.
 *
 * @param {WheelEvent} event
 * @param {Parts} parts
 * @param {Take} on
 */
function wheels(event, { scale, track }, on) {
  if (document.activeElement !== event.currentTarget || !event.deltaY || track.disabled) return;
  event.preventDefault();
  steps(-Math.sign(event.deltaY) * (event.shiftKey ? 10 : 1), { scale, track }, on);
}

/** @type {Record<string, number>} */
const WAYS = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 };

/**
 * @param {KeyboardEvent} event
 * @param {Parts} parts
 * @param {Take} on
 */
function stepsInField(event, { scale, track }, on) {
  const way = event.key === "ArrowUp" ? 1 : event.key === "ArrowDown" ? -1 : 0;
  if (!way) return;
  event.preventDefault();
  steps(way * (event.shiftKey ? 10 : 1), { scale, track }, on);
}

/**
 * @param {Parts} parts
 * @param {Take} on
 */
function readField({ field, back, row, label }, on) {
  const text = field.value.trim().replace("\u2212", "-");
  if (text === "" && back) return on(null);
  const value = Number(text.replace(",", "."));
  const wrong = whyNoNumber(text, value);
  attribute(field, "aria-invalid", wrong ? "true" : null);
  complain(row, wrong && `${label} ${wrong}`);
  return wrong ? undefined : on(value);
}

/**
 * What is wrong with a typed number: "1,000" is one for some and a thousand for others.
 *
 * @param {string} text
 * @param {number} value
 */
function whyNoNumber(text, value) {
  if (/^-?[1-9]\d*,\d{3}$/.test(text)) {
    return `may be ${text.replace(",", "")} or ${text.replace(",", ".")}; write it without a comma.`;
  }
  return text === "" || !Number.isFinite(value) ? "has to be a number, such as 0.5 or 10." : null;
}
