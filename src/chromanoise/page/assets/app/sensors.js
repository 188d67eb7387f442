/** Controls of the sensors: two or more, each with its pixel and its filters. */

import { attribute, brief, button, choice, el, fillChoice, freshId, say } from "app/dom.js";
import { setAt, valueAt } from "app/paths.js";
import { shownUnit, slider } from "app/slider.js";
import { changeStudy } from "app/state.js";
import { asksFor, shownName, uploaded } from "app/uploads.js";

/** @import { Choices, Head, HeadSensor, KnownSensor, SensorPart, Slider, State, Study } from "answers" */
/** @import { Group } from "app/controls.js" */

const FEWEST = 2;
export const MOST = 6;

/** What a file of relative curves must be told. */
const PEAK = {
  key: "sensors.answers.peak_qe",
  label: "Highest QE, of relative curves",
  unit: "1",
  low: 0.05,
  high: 1,
  scale: "linear",
  step: 0.01,
};

/**
 * The group of controls: `node` and `show(state, head)`.
 *
 * @param {Choices} choices
 * @returns {Group}
 */
export function sensorControls(choices) {
  const list = el("div", { class: "cards" });
  const add = button("Add a sensor", () => addSensor(choices), { class: "wide" });
  const said = el("p", { class: "hint" });
  /** @type {ReturnType<typeof sensorCard>[]} */
  let cards = [];
  /**
   * @param {State} state
   * @param {Head | null} head
   */
  const show = ({ study }, head) => {
    const { sensors } = study;
    if (cards.length !== sensors.length) {
      cards = sensors.map((_, i) => sensorCard(choices, i));
      list.replaceChildren(...cards.map((card) => card.node));
    }
    sensors.forEach((sensor, i) => cards[i].show(sensor, head?.sensors?.[i], sensors.length));
    attribute(add, "disabled", sensors.length >= MOST);
    say(said, add.disabled ? `Limit: ${MOST} sensors.` : "");
  };
  return { node: el("div", {}, list, add, said), show };
}

/**
 * Appends a sensor: the next of the catalog that is not shown yet, or the one that is named.
 *
 * @param {Choices} choices
 * @param {string | null} [name]
 * @param {object} [more]
 */
export function addSensor(choices, name = null, more = {}) {
  changeStudy((study) => {
    const taken = new Set(study.sensors.map((sensor) => sensor.name));
    const free = choices.sensors.find((sensor) => !taken.has(sensor.name)) ?? choices.sensors[0];
    study.sensors.push({ name: name ?? free.name, ...more });
  });
}

/**
 * @param {Choices} choices
 * @param {number} i
 */
function sensorCard(choices, i) {
  const legend = el("legend", { text: `Sensor ${i + 1}` });
  const pick = choice({
    label: `Sensor ${i + 1}`,
    hidden: true,
    options: [],
    where: `sensors.${i}`,
    on: (name) => changeStudy((study) => exchange(study, i, name)),
  });
  const what = el("p", { class: "hint" });
  const up = button("\u2191", () => changeStudy((study) => swap(study, i)), {
    "aria-label": `Move sensor ${i + 1} up`,
    title: "Move up",
    class: "square",
  });
  const away = button("\u00d7", () => remove(i, node), {
    "aria-label": `Remove sensor ${i + 1}`,
    title: "Remove",
    class: "square",
  });
  pick.row.append(up, away);
  const front = filterChoice(choices, i);
  const inner = innerSliders(choices, i);
  const peak = sensorSlider(PEAK, i);
  const files = [fileRow("Pixel", "pixel.file", i), fileRow("Crosstalk", "crosstalk", i)];
  const drawer = el(
    "details",
    { class: "drawer" },
    el("summary", { text: "Pixel and filters" }),
    front.row,
    ...inner.map((one) => one.row),
  );
  const node = el("fieldset", { class: "card" }, legend, pick.row, what, ...files.map((one) => one.row), drawer);
  /**
   * @param {SensorPart} sensor
   * @param {HeadSensor | undefined} told
   * @param {number} count
   */
  const show = (sensor, told, count) => {
    const known = choices.sensors.find((one) => one.name === sensor.name);
    const names = choices.sensors.map((one) => one.name);
    fillChoice(pick.select, [...names, ...uploaded("sensor", sensor.name)], sensor.name);
    say(what, known ? described(known, told) : "");
    front.show(sensor);
    for (const one of files) one.show(sensor);
    for (const one of inner) one.show(sensor, told);
    peak.show(sensor, told);
    const asked = asksForPeak(sensor);
    if (asked !== peak.row.isConnected) asked ? drawer.append(peak.row) : peak.row.remove();
    attribute(up, "disabled", i === 0);
    attribute(away, "disabled", count <= FEWEST);
  };
  return { node, show };
}

/**
 * What a sensor is; its pixel as computed, if that is known already.
 *
 * @param {KnownSensor} known
 * @param {HeadSensor | undefined} told
 */
function described(known, told) {
  if (told?.name !== known.name || told.pitch_um === undefined) return known.what;
  return `${known.what}; ${brief(told.pitch_um)} µm, ${brief(told.full_well_e)} e\u207b full well`;
}

/**
 * Takes a sensor away; the focus goes on to what is left, not back to the top of the page.
 *
 * @param {number} i
 * @param {HTMLElement} node
 */
function remove(i, node) {
  const list = /** @type {HTMLElement} */ (node.parentElement);
  changeStudy((study) => study.sensors.splice(i, 1));
  list.children[Math.min(i, list.children.length - 1)]?.querySelector("select")?.focus();
}

/**
 * Puts another sensor in the place of one; `more` is what its own file must be told.
 *
 * @param {Study} study
 * @param {number} i
 * @param {string} name
 * @param {object} [more]
 */
export function exchange(study, i, name, more = {}) {
  // answers belong to one file, changes of the pixel to the question
  const { pixel, filter, ircut_nm, shift_nm } = study.sensors[i];
  const kept = Object.entries({ pixel, filter, ircut_nm, shift_nm });
  study.sensors[i] = { name, ...more, ...Object.fromEntries(kept.filter(([, value]) => value !== undefined)) };
}

/**
 * @param {Study} study
 * @param {number} i
 */
function swap(study, i) {
  const { sensors } = study;
  [sensors[i - 1], sensors[i]] = [sensors[i], sensors[i - 1]];
}

/**
 * Sliders of everything that the server says a sensor has.
 *
 * @param {Choices} choices
 * @param {number} i
 */
function innerSliders(choices, i) {
  const own = choices.sliders.filter((one) => one.key.startsWith("sensors."));
  return own.map((range) => sensorSlider(range, i));
}

/**
 * @param {Slider} range
 * @param {number} i
 */
function sensorSlider(range, i) {
  const path = range.key.slice("sensors.".length);
  const control = slider({
    label: range.label,
    unit: shownUnit(range),
    range,
    where: `sensors.${i}.${path}`,
    own: path === "shift_nm" ? "none" : "as built",
    on: (value) =>
      changeStudy((study) => setAt(study.sensors[i], path, value), value === null ? "step" : "slide"),
  });
  /**
   * @param {SensorPart} sensor
   * @param {HeadSensor | undefined} told
   */
  const show = (sensor, told) => {
    const value = valueAt(sensor, path);
    control.row.hidden = typeof value === "string"; // a file, with a row of its own
    if (control.row.hidden) return;
    if (path === "pixel.read_noise_e") control.show(value, told?.read_noise_e ?? null);
    else control.show(value, untouched(path, range), path === "shift_nm" ? null : "own");
  };
  return { row: control.row, show };
}

/**
 * A file in place of numbers, with a button that takes it away; hidden where there is none.
 *
 * @param {string} label
 * @param {string} path
 * @param {number} i
 */
function fileRow(label, path, i) {
  const name = el("span", { class: "file" });
  const away = button("\u00d7", () => changeStudy((study) => setAt(study.sensors[i], path, null)), {
    title: "Remove",
    class: "square",
    "aria-label": `Remove the file: ${label} of sensor ${i + 1}`,
  });
  const row = el("div", { class: "row row-file", hidden: true }, el("span", { class: "label", text: label }), name, away);
  /** @param {SensorPart} sensor */
  const show = (sensor) => {
    const word = valueAt(sensor, path);
    row.hidden = typeof word !== "string";
    attribute(away, "data-where", row.hidden ? null : `sensors.${i}.${path}`);
    say(name, row.hidden ? "" : shownName(word));
  };
  return { row, show };
}

/**
 * Curves that are relative in their file, or were said to be, need their highest QE.
 *
 * @param {SensorPart} sensor
 */
function asksForPeak({ name, answers }) {
  const said = answers?.peak_qe !== undefined || answers?.level === "relative";
  return said || asksFor("sensor", name, "answers.peak_qe");
}

/**
 * What stands in front of the sensor: a word, with those of the catalog offered.
 *
 * @param {Choices} choices
 * @param {number} i
 */
function filterChoice(choices, i) {
  const id = freshId("filter");
  const offered = el("datalist", { id: `${id}-known` }, ...(choices.filters ?? []).map((value) => el("option", { value })));
  /** @type {HTMLInputElement} */
  const typed = el("input", {
    id,
    type: "text",
    list: offered.id,
    "data-where": `sensors.${i}.filter`,
    placeholder: "none; e.g. ircut-650",
    autocomplete: "off",
    spellcheck: "false",
    class: "word",
    on: { change: () => changeStudy((study) => setAt(study.sensors[i], "filter", typed.value.trim() || null)) },
  });
  const named = el("label", { for: id, class: "label", text: "Filter before it" });
  const row = el("div", { class: "row" }, named, typed, offered);
  let shown = "";
  // an answer that comes while somebody types must not take the letters away
  /** @param {SensorPart} sensor */
  const show = ({ filter }) => {
    if (shown !== (filter ?? "")) typed.value = shown = filter ?? "";
  };
  return { row, show };
}

/**
 * Where a slider stands that changes nothing: no noise and no shift, and an edge at its upper end.
 *
 * @param {string} path
 * @param {{ low: number, high: number }} range
 */
function untouched(path, range) {
  if (path === "shift_nm") return 0;
  return path === "ircut_nm" ? range.high : range.low;
}
