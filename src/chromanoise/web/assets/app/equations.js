/** What is behind each `?`: words, formulas, their symbols and the source, in a dialog. */

import { silence, understood } from "app/ask.js";
import { button, el, uniqueId, within } from "app/dom.js";

/** @import { Explanation } from "answers" */

const PATIENCE_MS = 20_000;
/** @type {Record<string, Explanation> | null} */
let known = null;
/** @type {HTMLDialogElement | null} */
let dialog = null;
/** How often. */
let opened = 0;

/** Listens for every `?` of the page; the first one asks the server for all explanations. */
export function useEquations() {
  document.addEventListener("click", (event) => {
    const { target } = event;
    const asked = target instanceof Element ? target.closest("button.equation") : null;
    if (asked instanceof HTMLElement) showEquations((asked.dataset.equation ?? "").split(" "), asked);
  });
}

/**
 * Opens the dialog with some of the explanations.
 *
 * @param {string[]} names
 * @param {HTMLElement} opener
 */
async function showEquations(names, opener) {
  dialog ??= emptyDialog();
  const entries = within(dialog, ".entries");
  const mine = (opened += 1);
  if (!known) entries.replaceChildren(el("p", { text: "Loading …" }));
  dialog.addEventListener("close", () => opener.isConnected && opener.focus(), { once: true });
  dialog.showModal();
  const found = await explanations();
  if (mine !== opened) return; // another one was opened meanwhile
  const nodes = names.flatMap((name) => (found?.[name] ? [entry(found[name])] : []));
  const none = found ? "No explanation available." : silence("; close this and try again.");
  entries.replaceChildren(...(nodes.length ? nodes : [el("p", { text: none })]));
  dialog.scrollTop = 0; // the focus is on the button at the end
}

/** All explanations; null where the server does not answer. */
async function explanations() {
  const signal = AbortSignal.timeout(PATIENCE_MS);
  known ??= await fetch("/api/explanations", { signal })
    .then(understood)
    .catch(() => null);
  return known;
}

/** @param {Explanation} one */
function entry({ title, words, formulas, symbols, source }) {
  const meanings = symbols.flatMap(({ symbol, meaning, unit }) => [
    el("dt", {}, formula(symbol)),
    el("dd", { text: unit && unit !== "1" ? `${meaning} [${unit}]` : meaning }),
  ]);
  return el(
    "section",
    {},
    el("h3", { text: title }),
    el("p", { class: "words", text: words }),
    ...formulas.map((one) => el("div", { class: "formula" }, formula(one))),
    el("dl", { class: "symbols" }, ...meanings),
    el("p", { class: "source", text: source }),
  );
}

/**
 * MathML of the server as elements.
 *
 * @param {string} text
 */
function formula(text) {
  return document.importNode(new DOMParser().parseFromString(text, "application/xml").documentElement, true);
}

function emptyDialog() {
  const id = uniqueId("equations");
  const heading = el("h2", { id, text: "Explanation" });
  const close = button("Close", () => node.close(), { class: "primary", autofocus: true });
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
