/** What stands behind each `?`: the equation and where it comes from, in a dialog. */

import { button, el, freshId, within } from "app/dom.js";

/** @import { Equation } from "answers" */

/** @type {Record<string, Equation>} */
let known = {};
/** @type {HTMLDialogElement | null} */
let dialog = null;

/**
 * Takes the equations of the server, and listens for every `?` of the page.
 *
 * @param {Record<string, Equation>} equations
 */
export function useEquations(equations) {
  known = equations;
  document.addEventListener("click", (event) => {
    const { target } = event;
    const asked = target instanceof Element ? target.closest("button.equation") : null;
    if (asked instanceof HTMLElement) showEquations((asked.dataset.equation ?? "").split(" "), asked);
  });
}

/**
 * Opens the dialog with some of the equations.
 *
 * @param {string[]} names
 * @param {HTMLElement} opener
 */
function showEquations(names, opener) {
  dialog ??= emptyDialog();
  const entries = names.filter((name) => known[name]).map(entry);
  const none = el("p", { text: "No equation available." });
  within(dialog, ".entries").replaceChildren(...(entries.length ? entries : [none]));
  dialog.addEventListener("close", () => opener.isConnected && opener.focus(), { once: true });
  dialog.showModal();
}

/** @param {string} name */
function entry(name) {
  const { title, equation, source } = known[name];
  return el(
    "section",
    {},
    el("h3", { text: title }),
    el("p", { class: "formula", text: equation }),
    el("p", { class: "source", text: source }),
  );
}

function emptyDialog() {
  const id = freshId("equations");
  const heading = el("h2", { id, text: "Equation and source" });
  const close = button("Close", () => node.close(), { class: "primary" });
  const node = el(
    "dialog",
    { "aria-labelledby": id, class: "equations" },
    heading,
    el("div", { class: "entries" }),
    close,
  );
  // a click beside the dialog closes it, as people expect
  node.addEventListener("click", (event) => event.target === node && node.close());
  document.body.append(node);
  return node;
}
