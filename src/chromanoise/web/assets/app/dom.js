/** Small makers of HTML. Data always goes in as text or attribute, never as markup. */

import { say, uniqueId } from "draw/svg.js";

export { say, uniqueId };

/** @typedef {string | number | boolean | null | undefined} Value */
/** @typedef {string | string[]} Option a name; or a value, its label, and "disabled" where it is not to be chosen */
/** @typedef {{ [event: string]: (event: any) => unknown }} Listeners */
/** @typedef {{ on?: Listeners, text?: string } & { [attribute: string]: Value | Listeners }} ElOptions */
/**
 * @typedef {object} ChoiceOptions
 * @property {string} label
 * @property {Option[]} options
 * @property {string} [value]
 * @property {(value: string) => unknown} on
 * @property {boolean} [hidden] whether only readers of the screen get the label
 * @property {string | null} [where] key of the study
 */
/**
 * @typedef {object} RadioOptions
 * @property {string} legend
 * @property {string[][]} options
 * @property {string} value
 * @property {(value: string) => unknown} on
 * @property {boolean} [hidden]
 */

/**
 * An element that the page has from the start.
 *
 * @param {string} id
 */
export function byId(id) {
  return /** @type {HTMLElement} */ (document.getElementById(id));
}

/**
 * The first match of a selector, where there is one for certain.
 *
 * @param {ParentNode} root
 * @param {string} selector
 */
export function within(root, selector) {
  return /** @type {HTMLElement} */ (root.querySelector(selector));
}

/**
 * An HTML element. `on` holds listeners, `text` the words inside, other keys are attributes;
 * `true` gives an empty attribute, and `null`, `undefined` and `false` none.
 *
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {ElOptions} [parts]
 * @param {(Node | string | null | undefined)[]} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function el(tag, { on = {}, text, ...attributes } = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) attribute(node, name, /** @type {Value} */ (value));
  for (const [event, listener] of Object.entries(on)) node.addEventListener(event, listener);
  if (text !== undefined) node.textContent = text;
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/**
 * Sets an attribute where it changes, for a browser lays out again after every writing, or takes it
 * away.
 *
 * @param {Element} node
 * @param {string} name
 * @param {Value} value
 */
export function attribute(node, name, value) {
  const text = value === true ? "" : String(value);
  if (value === null || value === undefined || value === false) node.removeAttribute(name);
  else if (node.getAttribute(name) !== text) node.setAttribute(name, text);
}

/**
 * A labelled native select; `options` are names or [value, label] pairs.
 *
 * @param {ChoiceOptions} options
 */
export function choice({ label, options, value, on, hidden = false, where = null }) {
  const id = uniqueId("choice");
  /** @type {HTMLSelectElement} */
  const select = el("select", { id, "data-where": where, on: { change: () => on(select.value) } });
  fillChoice(select, options, value);
  const named = el("label", { for: id, text: label, class: hidden ? "unseen" : "label" });
  const row = el("div", { class: "row row-choice" }, named, select);
  return { row, select };
}

/**
 * Gives a select its options; a value that is not among them is added, so that nothing is lost.
 *
 * @param {HTMLSelectElement} select
 * @param {Option[]} options
 * @param {string} [value]
 */
export function fillChoice(select, options, value) {
  const pairs = options.map((option) => (Array.isArray(option) ? option : [option, option]));
  if (value !== undefined && !pairs.some(([known]) => known === value)) pairs.unshift([value, value]);
  const filling = JSON.stringify(pairs);
  if (filled.get(select) !== filling) {
    filled.set(select, filling);
    select.replaceChildren(...pairs.map(([own, text, state]) => el("option", { value: own, text, disabled: state === "disabled" })));
  }
  if (value !== undefined && select.value !== value) select.value = value;
}

const filled = new WeakMap();

/**
 * Round marks for one of a few: a fieldset of native radio buttons.
 *
 * @param {RadioOptions} options
 */
export function radios({ legend, options, value, on, hidden = false }) {
  const name = uniqueId("radio");
  const inputs = new Map();
  const marks = options.map(([own, text]) => {
    const input = el("input", { type: "radio", name, value: own, on: { change: () => on(own) } });
    inputs.set(own, input);
    return el("label", { class: "radio" }, input, el("span", { text }));
  });
  const title = el("legend", { text: legend, class: hidden ? "unseen" : "label" });
  const set = el("fieldset", { class: "radios" }, title, el("div", { class: "segments" }, ...marks));
  /** @param {string | null} chosen */
  const show = (chosen) => {
    for (const [own, input] of inputs) if (input.checked !== (own === chosen)) input.checked = own === chosen;
  };
  show(value);
  return { set, show };
}

/** @typedef {{ nodes: Node[], show: (...told: any) => void }} Content */
/** @type {WeakMap<Element, { holds: (path: string) => boolean, fill: () => void }>} */
const drawers = new WeakMap();

/**
 * A drawer whose content is made when it is opened first, and shown only while it is open.
 *
 * @param {string} title
 * @param {(path: string) => boolean} holds whether a key of the study has its control inside
 * @param {() => Content} make
 */
export function drawer(title, holds, make) {
  const words = el("span", { text: title });
  const aside = el("span", { class: "aside" });
  const node = el("details", { class: "drawer" }, el("summary", {}, words, " ", aside));
  /** @type {Content | null} */
  let content = null;
  /** @type {unknown[] | null} */
  let told = null;
  const fill = () => {
    if (!node.open || !told) return;
    if (!content) node.append(...(content = make()).nodes);
    content.show(...told);
  };
  node.addEventListener("toggle", fill);
  drawers.set(node, { holds, fill });
  /** @param {unknown[]} now */
  const show = (...now) => {
    told = now;
    fill();
  };
  return { node, words, aside, show };
}

/**
 * Opens the drawers that hold the control of a key.
 *
 * @param {string} path
 */
export function reveal(path) {
  // this list is live: it gets the drawers that are made when another one is opened
  for (const node of document.getElementsByClassName("drawer")) {
    const one = drawers.get(node);
    if (!one?.holds(path)) continue;
    attribute(node, "open", true);
    one.fill();
  }
}

/**
 * A switch with its label and a hint that can change: `{row, show(on, enabled, hint)}`.
 *
 * @param {{ label: string, where: string, on: (on: boolean) => unknown }} options
 */
export function toggle({ label, where, on }) {
  const id = uniqueId("switch");
  const named = { id, type: "checkbox", role: "switch", "data-where": where, "aria-describedby": `${id}-hint` };
  /** @type {HTMLInputElement} */
  const input = el("input", { ...named, on: { change: () => on(input.checked) } });
  const meant = el("p", { class: "hint", id: `${id}-hint` });
  const row = el("div", { class: "row row-switch" }, el("label", { class: "switch" }, input, el("span", { text: label })), meant);
  /**
   * @param {boolean} isOn
   * @param {boolean} enabled
   * @param {string} hint
   */
  const show = (isOn, enabled, hint) => {
    if (input.checked !== isOn) input.checked = isOn;
    attribute(input, "disabled", !enabled);
    say(meant, hint);
  };
  return { row, show };
}

/**
 * A button with words on it.
 *
 * @param {string} text
 * @param {() => unknown} click
 * @param {ElOptions} [attributes]
 */
export function button(text, click, attributes = {}) {
  return el("button", { type: "button", text, ...attributes, on: { click } });
}

/**
 * A small button with a sign on it.
 *
 * @param {string} sign
 * @param {string} title
 * @param {string} name for readers of the screen
 * @param {() => unknown} click
 */
export function square(sign, title, name, click) {
  return button(sign, click, { "aria-label": name, title, class: "square" });
}

/**
 * A number as short as it is told to people: at most `digits` significant ones, a true minus.
 *
 * @param {number | null | undefined} value
 * @param {number} [digits]
 */
export function brief(value, digits = 4) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const huge = size !== 0 && (size < 1e-3 || size >= 1e6);
  const told = huge ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return told.replace("-", "\u2212");
}
