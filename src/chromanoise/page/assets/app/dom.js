/** Small makers of HTML. Data always goes in as text or attribute, never as markup. */

let made = 0;

/**
 * An HTML element. `on` holds listeners, `text` the words inside, other keys are attributes;
 * `true` gives an empty attribute, and `null`, `undefined` and `false` none.
 */
export function el(tag, { on = {}, text, ...attributes } = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) attribute(node, name, value);
  for (const [event, listener] of Object.entries(on)) node.addEventListener(event, listener);
  if (text !== undefined) node.textContent = text;
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** Sets an attribute, or takes it away. */
export function attribute(node, name, value) {
  if (value === null || value === undefined || value === false) node.removeAttribute(name);
  else put(node, name, value === true ? "" : String(value));
}

/** Writes an attribute only where it changes: a browser lays out again after every writing. */
function put(node, name, value) {
  if (node.getAttribute(name) !== value) node.setAttribute(name, value);
}

/** Writes text only where it changes. */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** An id that nothing else on this page has. */
export function freshId(prefix) {
  made += 1;
  return `${prefix}-${made}`;
}

/** A labelled native select; `options` are names or [value, label] pairs. */
export function choice({ label, options, value, on, hidden = false, where = null }) {
  const id = freshId("choice");
  const select = el("select", { id, "data-where": where, on: { change: () => on(select.value) } });
  fillChoice(select, options, value);
  const named = el("label", { for: id, text: label, class: hidden ? "unseen" : "label" });
  const row = el("div", { class: "row row-choice" }, named, select);
  return { row, select };
}

/** Gives a select its options; a value that is not among them is added, so that nothing is lost. */
export function fillChoice(select, options, value) {
  const pairs = options.map((option) => (Array.isArray(option) ? option : [option, option]));
  if (value !== undefined && !pairs.some(([known]) => known === value)) pairs.unshift([value, value]);
  const filling = JSON.stringify(pairs);
  if (filled.get(select) !== filling) {
    filled.set(select, filling);
    select.replaceChildren(...pairs.map(([own, text]) => el("option", { value: own, text })));
  }
  if (value !== undefined && select.value !== value) select.value = value;
}

const filled = new WeakMap();

/** Round marks for one of a few: a fieldset of native radio buttons. */
export function radios({ legend, options, value, on, hidden = false }) {
  const name = freshId("radio");
  const inputs = new Map();
  const marks = options.map(([own, text]) => {
    const input = el("input", { type: "radio", name, value: own, on: { change: () => on(own) } });
    inputs.set(own, input);
    return el("label", { class: "radio" }, input, el("span", { text }));
  });
  const title = el("legend", { text: legend, class: hidden ? "unseen" : "label" });
  const set = el("fieldset", { class: "radios" }, title, el("div", { class: "segments" }, ...marks));
  const show = (chosen) => {
    const input = inputs.get(chosen);
    if (input && !input.checked) input.checked = true;
  };
  show(value);
  return { set, show };
}

/** A button with words on it. */
export function button(text, click, attributes = {}) {
  return el("button", { type: "button", text, ...attributes, on: { click } });
}

/** A number as short as it is told to people: at most `digits` significant ones, a true minus. */
export function brief(value, digits = 4) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const huge = size !== 0 && (size < 1e-3 || size >= 1e6);
  const told = huge ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return told.replace("-", "\u2212");
}
