/** Controls of the light: which, how much, and how much infrared is in it. */

import { choice, el, fillChoice, radios, say } from "app/dom.js";
import { rangeOf, saidAt } from "app/paths.js";
import { shownUnit, slider } from "app/slider.js";
import { changeStudy, current } from "app/state.js";
import { uploaded } from "app/uploads.js";

/** @import { Choices, LightPart, Slider, State } from "answers" */
/** @import { Group } from "app/controls.js" */
/** @import { How } from "app/state.js" */
/** @typedef {{ base: string, ratio: number, diode: string | null }} LightParts */

const WITH_INFRARED = /^(.+)\+([0-9.]+(?:e[-+]?\d+)?)x(LED\d+)$/i;
const OTHER = "other…";

/** How a light continues whose table ends early, with what that means for the sensors. */
/** @type {Record<string, string>} */
const CONTINUED = {
  zero: "No light beyond. A sensor that sees infrared collects less than in the real light.",
  hold: "The last value continues. This is a guess: the real light may have more or less infrared.",
};

/**
 * A light's name in parts: `E+0.5xLED850` is E with a ratio of 0.5 of a diode of 850 nm.
 *
 * @param {string} name
 * @returns {LightParts}
 */
export function lightParts(name) {
  const match = WITH_INFRARED.exec(name);
  if (!match) return { base: name, ratio: 0, diode: null };
  return { base: match[1], ratio: Number(match[2]), diode: match[3] };
}

/**
 * The name again.
 *
 * @param {LightParts} parts
 */
export function lightName({ base, ratio, diode }) {
  return ratio > 0 ? `${base}+${ratio}x${diode}` : base;
}

/**
 * Of a light, what stays when the lamp is another: how its file was to be read belongs to that.
 *
 * @param {LightPart} [light]
 */
export function lampless(light = {}) {
  return light.level_lux === undefined ? {} : { level_lux: light.level_lux };
}

/**
 * The group of controls: `node` and `show(state)`.
 *
 * @param {Choices} choices
 * @returns {Group}
 */
export function lightControls(choices) {
  const diodes = choices.infrared_lights;
  let diode = diodes[0];
  /**
   * @param {Partial<LightParts>} part
   * @param {How} how
   * @param {{ beyond?: string }} [more]
   */
  const change = (part, how, more = {}) =>
    changeStudy((study) => {
      const now = lightParts(saidAt(study, "light.illuminant"));
      const next = { ...now, diode, ...part };
      const own = next.base === now.base ? study.light : lampless(study.light);
      study.light = { ...own, illuminant: lightName(next), ...more };
    }, how);
  /** @type {string | null} a light that waits until it is said how it continues */
  let waiting = null;
  let lastBase = "";
  /** @param {string} name */
  const choose = (name) => {
    const beyond = answered(current().study.light);
    waiting = name in choices.illuminant_ends_nm && !beyond ? name : null;
    if (waiting) showContinuation(name, null);
    else change({ base: name }, "step", name in choices.illuminant_ends_nm ? { beyond } : {});
  };
  const base = baseChoice(choices, choose);
  const { row: continuation, show: showContinuation } = continuationChoice(choices, (beyond) => {
    const name = waiting ?? lastBase;
    waiting = null;
    change({ base: name }, "step", { beyond });
  });
  const ratio = slider({
    ...described(choices, "light.infrared"),
    on: (value) => change({ ratio: value ?? 0 }, "slide"),
  });
  const lamp = choice({
    label: "Infrared diode",
    options: diodes,
    value: diode,
    on: (name) => {
      diode = name;
      change({ diode: name }, "step");
    },
  });
  const level = slider({
    ...described(choices, "light.level_lux"),
    on: (value) => changeStudy((study) => (study.light = { ...study.light, level_lux: value ?? undefined }), "slide"),
  });
  const node = el("div", {}, level.row, base.row, continuation, ratio.row, lamp.row);
  /** @param {State} state */
  const show = ({ study }) => {
    const now = lightParts(saidAt(study, "light.illuminant"));
    diode = now.diode ?? diode;
    if (now.base !== lastBase) waiting = null;
    lastBase = now.base;
    base.show(waiting ?? now.base);
    showContinuation(waiting ?? now.base, waiting ? null : answered(study.light));
    ratio.show(now.ratio);
    fillChoice(lamp.select, diodes, diode);
    level.show(saidAt(study, "light.level_lux"));
  };
  return { node, show };
}

/**
 * How a light is said to continue, if it is.
 *
 * @param {LightPart} [light]
 */
function answered(light) {
  const beyond = light?.beyond;
  return beyond && beyond in CONTINUED ? beyond : undefined;
}

/**
 * The question how a light continues whose table ends early; without effect on other lights.
 *
 * @param {Choices} choices
 * @param {(beyond: string) => void} on
 */
function continuationChoice(choices, on) {
  const options = Object.keys(CONTINUED).map((name) => [name, name]);
  const { set, show: check } = radios({ legend: "Beyond the end of its table", options, value: "", on });
  set.dataset.where = "light.beyond";
  const meant = el("p", { class: "hint", role: "status" });
  const row = el("div", { class: "row", hidden: true }, set, meant);
  /**
   * @param {string} name
   * @param {string | null | undefined} beyond
   */
  const show = (name, beyond) => {
    const end = choices.illuminant_ends_nm[name];
    row.hidden = end === undefined;
    if (row.hidden) return say(meant, "");
    check(beyond ?? null);
    const asked = `This light is not used yet: choose zero (no light) or hold (the last value).`;
    return say(meant, `${name} ends at ${end} nm. ${beyond ? CONTINUED[beyond] : asked}`);
  };
  return { row, show };
}

/**
 * What a slider needs of a key of the study.
 *
 * @param {Choices} choices
 * @param {string} key
 */
export function described(choices, key) {
  const range = /** @type {Omit<Slider, "key">} */ (rangeOf(choices, key));
  return { label: range.label, unit: shownUnit(range), range, where: key };
}

/**
 * The lights of the catalog, the files that were brought, and a field for any other word.
 *
 * @param {Choices} choices
 * @param {(name: string) => void} on
 */
function baseChoice(choices, on) {
  const pick = choice({
    label: "Light",
    options: [],
    on: (name) => (name === OTHER ? reveal() : on(name)),
    where: "light.illuminant",
  });
  /** @type {HTMLInputElement} */
  const typed = el("input", {
    type: "text",
    class: "other",
    "aria-label": "Another light, e.g. 3200K or LED660",
    placeholder: "3200K, LED660",
    spellcheck: "false",
    hidden: true,
    on: { change: () => typed.value.trim() && on(typed.value.trim()) },
  });
  pick.row.append(typed);
  const reveal = () => {
    typed.hidden = false;
    typed.focus();
  };
  /** @param {string} name */
  const optionOf = (name) => {
    const end = choices.illuminant_ends_nm[name];
    return end === undefined ? name : `${name} (ends at ${end} nm)`;
  };
  /** @param {string} name */
  const show = (name) => {
    const known = choices.illuminants.map((one) => [one, optionOf(one)]);
    const options = [...known, ...uploaded("light", name), [OTHER, OTHER]];
    fillChoice(pick.select, options, name);
    if (document.activeElement !== typed) typed.hidden = true;
  };
  return { row: pick.row, show };
}
