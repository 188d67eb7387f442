/** Controls of the sensors: one or more, each with all that a study says of it. */

import { tell } from "app/copy.js";
import { attribute, brief, button, byId, choice, drawer, el, fillChoice, reveal, say, square } from "app/dom.js";
import { countSet, fieldGroups } from "app/fields.js";
import { most } from "app/paths.js";
import { setSheet } from "app/sheet.js";
import { changeStudy, current } from "app/state.js";
import { shownName, uploaded } from "app/uploads.js";
import { mark, sensorLines } from "draw/look.js";
import { svg } from "draw/svg.js";

/** @import { Choices, Head, HeadSensor, KnownSensor, SensorPart, State, Study } from "answers" */
/** @import { Group } from "app/controls.js" */

const FEWEST = 1;

/** Drawn, because few fonts have a sign for a copy. */
const TWO_SHEETS = "M2.5 2.5h8v8h-8z M5.5 10.5v3h8v-8h-3";

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
  const cards = [];
  /**
   * @param {State} state
   * @param {Head | null} head
   */
  const show = ({ study }, head) => {
    const { sensors } = study;
    while (cards.length > sensors.length) cards.pop()?.node.remove();
    while (cards.length < sensors.length) {
      cards.push(sensorCard(choices, cards.length));
      list.append(cards[cards.length - 1].node);
    }
    const lines = sensorLines(sensors.map(({ name }) => name));
    cards.forEach((card, i) => card.show(study, head, lines[i].color));
    attribute(add, "disabled", sensors.length >= most.sensors);
    say(said, add.disabled ? `Limit: ${most.sensors} sensors.` : "");
  };
  return { node: el("div", {}, list, add, said), show };
}

/**
 * Appends the next sensor of the catalog that is not shown yet.
 *
 * @param {Choices} choices
 */
function addSensor(choices) {
  changeStudy((study) => {
    const taken = new Set(study.sensors.map((sensor) => sensor.name));
    const free = choices.sensors.find((sensor) => !taken.has(sensor.name)) ?? choices.sensors[0];
    study.sensors.push({ name: free.name });
  });
}

/**
 * Opens the card of a sensor of the catalog, which joins the study if there is room for it.
 *
 * @param {string} name
 */
export function openSensor(name) {
  const at = () => current().study.sensors.findIndex((one) => one.name === name);
  if (at() < 0 && current().study.sensors.length >= most.sensors)
    return tell(byId("copied"), `Limit: ${most.sensors} sensors. Remove one to add ${name}.`);
  if (at() < 0) changeStudy(({ sensors }) => sensors.push({ name }));
  setSheet(true);
  reveal(`sensors.${at()}.pixel`);
  const card = document.querySelector(`[data-where="sensors.${at()}"]`);
  card?.scrollIntoView({ block: "center" });
  if (card instanceof HTMLElement) card.focus();
  return undefined;
}

/**
 * @param {Choices} choices
 * @param {number} i
 */
function sensorCard(choices, i) {
  const fields = choices.fields.filter(({ section }) => section === "Sensors");
  const swatch = svg("svg", { class: "mark", viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true" });
  const pick = choice({
    label: `Sensor ${i + 1}`,
    hidden: true,
    options: [],
    where: `sensors.${i}`,
    on: (name) => changeStudy((study) => exchange(study, i, { name })),
  });
  const up = square("\u2191", "Move up", `Move sensor ${i + 1} up`, () => changeStudy((study) => swap(study, i)));
  const again = square("", "Duplicate", `Duplicate sensor ${i + 1}`, () => changeStudy((study) => duplicate(study, i)));
  const away = square("\u00d7", "Remove", `Remove sensor ${i + 1}`, () => remove(i, node));
  again.append(svg("svg", { viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true" }, [svg("path", { d: TWO_SHEETS, class: "sheets" })]));
  pick.row.prepend(swatch);
  pick.row.append(up, again, away);
  const keys = new Set(fields.map(({ key }) => key.split(".")[1]));
  const inner = drawer("", (path) => path.startsWith(`sensors.${i}.`) && keys.has(path.split(".")[2]), () => {
    const what = el("p", { class: "hint" });
    const groups = fieldGroups(choices, "Sensors", i);
    /**
     * @param {Study} study
     * @param {Head | null} head
     */
    const show = (study, head) => {
      say(what, choices.sensors.find((one) => one.name === study.sensors[i].name)?.what ?? "");
      groups.show(study, head);
    };
    return { nodes: [what, ...groups.nodes], show };
  });
  const legend = el("legend", { class: "unseen", text: `Sensor ${i + 1}` });
  const node = el("fieldset", { class: "card" }, legend, pick.row, inner.node);
  let drawn = "";
  /**
   * @param {Study} study
   * @param {Head | null} head
   * @param {string} color
   */
  const show = (study, head, color) => {
    const { sensors } = study;
    const known = choices.sensors.find((one) => one.name === sensors[i].name);
    fillChoice(pick.select, namesFor(choices, sensors, i, head), sensors[i].name);
    if (drawn !== color) swatch.replaceChildren(mark(i, 8, 8, (drawn = color)));
    say(inner.words, described(sensors[i], known, head?.sensors?.[i]));
    const count = countSet(fields, study, i);
    say(inner.aside, count ? `${count} set` : "");
    inner.show(study, head);
    attribute(up, "disabled", i === 0);
    attribute(again, "disabled", sensors.length >= most.sensors);
    attribute(away, "disabled", sensors.length <= FEWEST);
  };
  return { node, show };
}

/**
 * The sensors of the catalog and of files; before the name of the one that is chosen stands its
 * label or, where several have that name, what the verdict calls it.
 *
 * @param {Choices} choices
 * @param {SensorPart[]} sensors
 * @param {number} i
 * @param {Head | null} head
 */
function namesFor(choices, sensors, i, head) {
  const { name, label } = sensors[i];
  const alike = sensors.filter((one) => shownName(one.name) === shownName(name)).length > 1;
  const called = label ?? (alike ? head?.sensors?.[i]?.name : undefined) ?? name;
  const known = choices.sensors.map((one) => [one.name, one.name]);
  const all = [...known, ...uploaded("sensor", name)];
  return all.map(([own, text]) => [own, own === name && called !== name ? `${called} (${text})` : text]);
}

/**
 * A sensor in a few words: its pixel as computed, or as built.
 *
 * @param {SensorPart} sensor
 * @param {KnownSensor | undefined} known
 * @param {HeadSensor | undefined} told
 */
function described({ pixel }, known, told) {
  const now = told ?? known;
  const values = now ? `${brief(now.pitch_um)} µm, ${brief(now.full_well_e)} e\u207b, ±${brief(now.read_noise_e)} e\u207b` : "Edit";
  return typeof pixel?.file === "string" ? `${values}, ${shownName(pixel.file)}` : values;
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
 * Puts a copy behind a sensor; the label stays with the first, because labels differ.
 *
 * @param {Study} study
 * @param {number} i
 */
function duplicate({ sensors }, i) {
  const copy = structuredClone(sensors[i]);
  delete copy.label;
  sensors.splice(i + 1, 0, copy);
}

/**
 * Replaces a sensor by another one, with the answers that the file of the new one needs.
 *
 * @param {Study} study
 * @param {number} i
 * @param {SensorPart} sensor
 */
export function exchange(study, i, sensor) {
  // answers belong to one file, changes of the pixel to the question
  const { pixel, filter, filter_wavelength_unit, shift_ircut_nm, ircut_nm, shift_nm } = study.sensors[i];
  const kept = Object.entries({ pixel, filter, filter_wavelength_unit, shift_ircut_nm, ircut_nm, shift_nm });
  study.sensors[i] = { ...sensor, ...Object.fromEntries(kept.filter(([, value]) => value !== undefined)) };
}

/**
 * @param {Study} study
 * @param {number} i
 */
function swap(study, i) {
  const { sensors } = study;
  [sensors[i - 1], sensors[i]] = [sensors[i], sensors[i - 1]];
}
