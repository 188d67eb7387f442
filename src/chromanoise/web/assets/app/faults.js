/** Sentences about what is wrong, each beside the thing that it is about. */

import { attribute, el, uniqueId, reveal, say } from "app/dom.js";

/** @import { Fault } from "answers" */

/** @type {Element[]} */
let shown = [];

/**
 * Puts one sentence under a row of the controls, or takes it away with `null`.
 *
 * @param {Element} row
 * @param {string | null} sentence
 */
export function complain(row, sentence) {
  const here = row.querySelector(":scope > .fault");
  const subject = row.querySelector("[data-where]") ?? row.querySelector("input, select");
  if (sentence === null) {
    here?.remove();
    if (subject) attribute(subject, "aria-describedby", null);
    return;
  }
  const shown = here ?? el("p", { class: "fault", id: uniqueId("fault"), role: "alert" });
  say(shown, sentence);
  if (!here) row.append(shown);
  if (subject) subject.setAttribute("aria-describedby", shown.id);
}

/**
 * Shows the server's faults beside their controls; those that belong to none come back.
 *
 * @param {Fault[]} faults
 */
export function showFaults(faults) {
  clearFaults();
  const homeless = [];
  for (const fault of faults) {
    const { where, sentence } = fault;
    const row = rowOf(String(where ?? ""));
    if (row) {
      complain(row, sentence);
      shown.push(row);
    } else homeless.push(sentence);
  }
  return homeless;
}

/** Takes all of the server's sentences away. */
export function clearFaults() {
  for (const row of shown) complain(row, null);
  shown = [];
}

/**
 * The row whose key is the longest beginning of `where`, or begins with it.
 *
 * @param {string} where
 */
function rowOf(where) {
  const path = where.replaceAll(/\[(\d+)\]/g, ".$1");
  if (path === "") return null;
  // a sentence in a closed drawer would not be seen
  reveal(path);
  const nodes = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("[data-where]")]);
  const begins = nodes.filter((node) => `${path}.`.startsWith(`${node.dataset.where}.`));
  begins.sort((a, b) => (b.dataset.where ?? "").length - (a.dataset.where ?? "").length);
  return begins[0]?.closest(".row") ?? null;
}
