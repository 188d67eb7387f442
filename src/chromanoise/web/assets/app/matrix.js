/** Controls of the color matrices: how each is made, with which parameter, from which prior. */

import { attribute, button, choice, el, fillChoice, say, square } from "app/dom.js";
import { defaultOf, most } from "app/paths.js";
import { slider } from "app/slider.js";
import { changeStudy } from "app/state.js";
import { uploaded } from "app/uploads.js";

/** @import { Choices, State, Study } from "answers" */
/** @import { Group } from "app/controls.js" */

/**
 * The parts of a matrix's name: `noise-regularized=1` is a method and its parameter.
 *
 * @param {string} name
 */
export function matrixParts(name) {
  const [method, value] = name.split("=");
  return { method, value: value === undefined ? null : Number(value) };
}

/**
 * Whether one of the study's matrices has to be trained on a prior.
 *
 * @param {Study} study
 */
export function isTrained({ matrices = [] }) {
  return matrices.some((name) => matrixParts(name).method !== defaultOf("matrices") && !isFile(name));
}

/** @param {string} name */
const isFile = (name) => /\.[a-z]\w*$/i.test(name);

/** @param {Study} study */
export const matricesOf = ({ matrices }) => (matrices?.length ? matrices : [defaultOf("matrices")]);

/**
 * The group of controls: `node` and `show(state)`.
 *
 * @param {Choices} choices
 * @returns {Group}
 */
export function matrixControls(choices) {
  const list = el("div");
  const add = button("Add a matrix", () => changeStudy((study) => added(study, choices)), { class: "wide" });
  const said = el("p", { class: "hint" });
  /** @type {ReturnType<typeof matrixCard>[]} */
  let cards = [];
  /** @param {State} state */
  const show = ({ study }) => {
    const names = matricesOf(study);
    if (cards.length !== names.length) {
      cards = names.map((_, i) => matrixCard(choices, i));
      list.replaceChildren(...cards.map((card) => card.node));
    }
    names.forEach((_, i) => cards[i].show(names));
    attribute(add, "disabled", names.length >= most.matrices);
    say(said, names.length > 1 ? "'Over the light level' shows all matrices; the other charts use the first." : "");
  };
  return { node: el("div", {}, list, add, said), show };
}

/**
 * @param {Choices} choices
 * @param {number} i
 */
function matrixCard(choices, i) {
  const label = i ? `Color matrix ${i + 1}` : "Color matrix";
  const pick = choice({
    label,
    options: [],
    where: i ? `matrices.${i}` : "matrices", // the first also stands for all of them
    on: (method) => changeStudy((study) => put(study, i, fresh(choices, method, matricesOf(study)))),
  });
  const up = square("\u2191", "Move up", `Move matrix ${i + 1} up`, () => changeStudy((study) => raised(study, i)));
  const away = square("\u00d7", "Remove", `Remove matrix ${i + 1}`, () => removed(node, i));
  pick.row.append(up, away);
  const place = el("div");
  const node = el("div", { class: "matrix" }, pick.row, place);
  /** @type {{ method: string, weight: ReturnType<typeof weightSlider> } | null} */
  let drawn = null;
  /** @param {string[]} names */
  const show = (names) => {
    const now = matrixParts(names[i]);
    fillChoice(pick.select, methodsFor(choices, names, i), now.method);
    attribute(up, "disabled", i === 0);
    attribute(away, "disabled", names.length < 2 && !isFile(names[i]));
    if (drawn?.method !== now.method) {
      drawn = { method: now.method, weight: weightSlider(choices, now.method, i) };
      place.replaceChildren(...(drawn.weight ? [drawn.weight.row] : []));
    }
    drawn.weight?.show(now.value ?? parameterOf(choices, now.method)?.start);
  };
  return { node, show };
}

/**
 * Methods and files that a matrix may have: one without a parameter stands there once.
 *
 * @param {Choices} choices
 * @param {string[]} names
 * @param {number} i
 */
function methodsFor(choices, names, i) {
  const taken = new Set(names.filter((_, k) => k !== i));
  const methods = choices.matrices.map((one) => [one.name, one.name]);
  return [...methods, ...uploaded("matrix", names[i])].filter(([name]) => !taken.has(name));
}

/**
 * A name of a method that no other matrix has: its parameter is doubled until it is free.
 *
 * @param {Choices} choices
 * @param {string} method
 * @param {string[]} names
 */
function fresh(choices, method, names) {
  const parameter = parameterOf(choices, method);
  if (!parameter) return method;
  let value = parameter.start;
  while (names.includes(`${method}=${value}`) && 2 * value <= parameter.high) value *= 2;
  return `${method}=${value}`;
}

/**
 * Puts a matrix in the place of one; never the same twice, for each stands for its own curve.
 *
 * @param {Study} study
 * @param {number} i
 * @param {string} name
 */
function put(study, i, name) {
  const names = [...matricesOf(study)];
  if (names.some((other, k) => k !== i && other === name)) return;
  names[i] = name;
  study.matrices = names;
}

/**
 * @param {Study} study
 * @param {Choices} choices
 */
function added(study, choices) {
  const names = matricesOf(study);
  const methods = choices.matrices.map((one) => fresh(choices, one.name, names));
  const free = methods.find((name) => !names.includes(name));
  if (free) study.matrices = [...names, free];
}

/**
 * @param {Study} study
 * @param {number} i
 */
function raised(study, i) {
  const names = [...matricesOf(study)];
  [names[i - 1], names[i]] = [names[i], names[i - 1]];
  study.matrices = names;
}

/**
 * Takes a matrix away; the focus goes on to what is left, not back to the top of the page.
 *
 * @param {HTMLElement} node
 * @param {number} i
 */
function removed(node, i) {
  const list = /** @type {HTMLElement} */ (node.parentElement);
  changeStudy((study) => {
    const rest = matricesOf(study).filter((_, k) => k !== i);
    study.matrices = rest.length ? rest : [defaultOf("matrices")]; // in place of an only one
  });
  list.children[Math.min(i, list.children.length - 1)]?.querySelector("select")?.focus();
}

/**
 * @param {Choices} choices
 * @param {string} method
 */
function parameterOf(choices, method) {
  return choices.matrices.find((one) => one.name === method)?.parameter ?? null;
}

/**
 * @param {Choices} choices
 * @param {string} method
 * @param {number} i
 */
function weightSlider(choices, method, i) {
  const parameter = parameterOf(choices, method);
  if (!parameter) return null;
  return slider({
    label: i ? `${parameter.label}, matrix ${i + 1}` : parameter.label,
    unit: "",
    range: parameter,
    where: `matrices.${i}`,
    on: (value) => changeStudy((study) => put(study, i, `${method}=${value}`), "slide"),
  });
}
