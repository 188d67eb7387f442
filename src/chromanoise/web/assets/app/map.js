/** Controls of the heat map: two parameters with their ranges, and the quantity; all in the study. */

import { attribute, brief, choice, el, fillChoice, uniqueId, say } from "app/dom.js";
import { complain } from "app/faults.js";
import { defaultOf } from "app/paths.js";
import { shownUnit } from "app/slider.js";
import { changeStudy } from "app/state.js";

/** @import { Choices, KnownSweep, State, Study, SweepPart } from "answers" */
/** @typedef {{ vary: string, first: number, last: number }} Span */

const USUAL = ["lux", "f-number"];

/**
 * The first sweep of two parameters.
 *
 * @param {Study} study
 */
export const mapOf = (study) => (study.sweeps ?? []).find((one) => one.second) ?? null;

/**
 * The group of controls: `node` and `show(state)`.
 *
 * @param {Choices} choices
 */
export function mapControls(choices) {
  const across = parameter(choices, "Across", (sweep) => sweep);
  const up = parameter(choices, "Up", (sweep) => /** @type {Span} */ (sweep.second));
  const quantity = choice({
    label: "Quantity",
    options: [],
    on: (name) => changeStudy((study) => (/** @type {SweepPart} */ (mapOf(study)).quantity = name)),
  });
  /** @param {State} state */
  const show = ({ study }) => {
    const map = mapOf(study);
    const place = `sweeps.${map ? study.sweeps?.indexOf(map) : 0}`;
    across.show(map, place);
    up.show(map?.second ?? null, `${place}.second`);
    attribute(quantity.select, "data-where", `${place}.quantity`);
    const names = choices.quantities.map(({ name, what }) => [name, what]);
    fillChoice(quantity.select, names, map?.quantity ?? defaultOf("sweeps.quantity"));
    for (const row of [up.node, quantity.row]) row.hidden = map === null;
  };
  return { node: el("div", { class: "map-tools" }, across.node, up.node, quantity.row), show };
}

/**
 * What varies along one axis, and between which values.
 *
 * @param {Choices} choices
 * @param {string} label
 * @param {(sweep: SweepPart) => Span} spanOf
 */
function parameter(choices, label, spanOf) {
  const pick = choice({
    label,
    options: [],
    on: (name) => changeStudy((study) => varied(study, choices, spanOf, name)),
  });
  const unit = el("span", { class: "unit" });
  const ends = /** @type {const} */ (["first", "last"]).map((key) => {
    const word = key === "first" ? "from" : "to";
    const id = uniqueId("end");
    /** @type {HTMLInputElement} */
    const field = el("input", {
      ...{ id, type: "text", inputmode: "decimal", autocomplete: "off", class: "field" },
      "aria-label": `${label}, ${word}`,
      on: { change: () => typed(field, (value) => changeStudy((study) => (spanNow(study, spanOf)[key] = value))) },
    });
    const row = el("div", { class: "row map-end" }, el("label", { for: id, class: "label", text: word }), field);
    return { key, field, row };
  });
  const range = el("div", { class: "map-range" }, ...ends.map(({ row }) => row), unit);
  const node = el("div", { class: "map-axis" }, pick.row, range);
  /**
   * @param {Span | null} span
   * @param {string} where
   */
  const show = (span, where) => {
    const none = label === "Across" ? [["", "none"]] : [];
    const names = choices.sweeps.map(({ name, what }) => [name, what]);
    fillChoice(pick.select, [...none, ...names], span?.vary ?? "");
    attribute(pick.select, "data-where", `${where}.vary`);
    range.hidden = span === null;
    if (!span) return;
    say(unit, shownUnit(known(choices, span.vary)));
    for (const { key, field } of ends) {
      attribute(field, "data-where", `${where}.${key}`);
      const told = brief(span[key], 6);
      if (document.activeElement !== field && field.value !== told) field.value = told;
    }
  };
  return { node, show };
}

/**
 * @param {Choices} choices
 * @param {string} name
 */
const known = (choices, name) => /** @type {KnownSweep} */ (choices.sweeps.find((one) => one.name === name));

/**
 * @param {Study} study
 * @param {(sweep: SweepPart) => Span} spanOf
 */
const spanNow = (study, spanOf) => spanOf(/** @type {SweepPart} */ (mapOf(study)));

/**
 * Another parameter in its usual range; the one that the other axis has is exchanged.
 *
 * @param {Study} study
 * @param {Choices} choices
 * @param {(sweep: SweepPart) => Span} spanOf
 * @param {string} name
 */
function varied(study, choices, spanOf, name) {
  const map = mapOf(study);
  if (name === "") {
    study.sweeps = study.sweeps?.filter((one) => one !== map);
    return;
  }
  if (!map) {
    const other = USUAL.find((one) => one !== name) ?? "";
    study.sweeps = [...(study.sweeps ?? []), { ...fresh(choices, name), second: fresh(choices, other) }];
    return;
  }
  const second = /** @type {Span} */ (map.second);
  const span = spanOf(map);
  const other = span === second ? map : second;
  if (other.vary === name) {
    const { vary, first, last } = span;
    Object.assign(span, { vary: other.vary, first: other.first, last: other.last });
    Object.assign(other, { vary, first, last });
  } else Object.assign(span, fresh(choices, name));
}

/**
 * @param {Choices} choices
 * @param {string} name
 * @returns {Span}
 */
function fresh(choices, name) {
  const { first, last } = known(choices, name);
  return { vary: name, first, last };
}

/**
 * @param {HTMLInputElement} field
 * @param {(value: number) => unknown} take
 */
function typed(field, take) {
  const text = field.value.trim().replace("\u2212", "-").replace(",", ".");
  const value = Number(text);
  const row = /** @type {HTMLElement} */ (field.parentElement);
  const wrong = text === "" || !Number.isFinite(value);
  complain(row, wrong ? "Type a number." : null);
  if (!wrong) take(value);
}
