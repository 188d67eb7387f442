/** The study as something to take along: a link, TOML, Python or a command line. */

import { Refused, posted, silence } from "app/ask.js";
import { button, byId, el, uniqueId, within } from "app/dom.js";
import { current, link } from "app/state.js";

const KINDS = [
  ["link", "Link"],
  ["toml", "TOML"],
  ["python", "Python"],
  ["command", "Command"],
];

/** @type {HTMLDialogElement | null} */
let dialog = null;

/**
 * Puts the buttons into their place.
 *
 * @param {HTMLElement} place
 */
export function copyButtons(place) {
  // it is there from the start, so that readers of the screen listen to it
  const said = byId("copied");
  const buttons = KINDS.map(([kind, name]) =>
    button(name, () => copy(kind, name, said), { "aria-label": `Copy as ${name}`, "data-copy": kind }),
  );
  place.replaceChildren(el("span", { class: "label", text: "Copy as" }), ...buttons);
}

/**
 * @param {string} kind
 * @param {string} name
 * @param {HTMLElement} said
 */
async function copy(kind, name, said) {
  let text;
  try {
    text = kind === "link" ? link() : (await posted("/api/texts", { study: current().study }))[kind];
  } catch (error) {
    tell(said, error instanceof Refused ? error.message : silence(", so nothing was copied."));
    return;
  }
  try {
    await navigator.clipboard.writeText(text);
    tell(said, `${name} copied`);
  } catch {
    // no clipboard here, or not allowed: the text itself can still be taken
    offer(name, text);
  }
}

/** @type {number | undefined} */
let fading;

/**
 * A sentence beside the buttons, for some seconds.
 *
 * @param {HTMLElement} said
 * @param {string} sentence
 */
export function tell(said, sentence) {
  keepTelling(said, sentence);
  fading = setTimeout(() => (said.textContent = ""), 6000);
}

/**
 * A sentence that stays until the next one.
 *
 * @param {HTMLElement} said
 * @param {string} sentence
 */
export function keepTelling(said, sentence) {
  clearTimeout(fading);
  said.textContent = sentence;
}

/**
 * @param {string} name
 * @param {string} text
 */
function offer(name, text) {
  dialog ??= emptyDialog();
  within(dialog, "h2").textContent = `${name}: select and copy`;
  const area = /** @type {HTMLTextAreaElement} */ (within(dialog, "textarea"));
  area.value = text;
  dialog.showModal();
  area.focus();
  area.select();
}

function emptyDialog() {
  const id = uniqueId("copy");
  const close = button("Close", () => node.close(), { class: "primary" });
  const area = el("textarea", { readonly: true, rows: "12", "aria-labelledby": id, spellcheck: "false" });
  const node = el("dialog", { "aria-labelledby": id }, el("h2", { id, text: "Copy" }), area, close);
  document.body.append(node);
  return node;
}
