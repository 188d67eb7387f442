/** The verdict, and what each sensor collects. */

import { byId, el, say } from "app/dom.js";
import { tableOf } from "app/panels.js";
import { refill } from "draw/refill.js";

/** @import { Head } from "answers" */

const REST_MS = 500;
/** @type {number | undefined} */
let telling;

/**
 * Shows the verdict large, and tells it to those who listen once it has come to rest.
 *
 * @param {Head} head
 */
export function showHead(head) {
  const [first = "", ...more] = head.verdict;
  say(byId("verdict"), first);
  lines(byId("reasons"), more);
  clearTimeout(telling);
  telling = setTimeout(() => tell(head), REST_MS);
  showSensors(head);
}

/** @param {Head} head */
function tell({ verdict, sensors, light }) {
  say(byId("told"), verdict.join(" "));
  document.title = `${sensors.map((sensor) => sensor.name).join(", ")} at ${light.text} – chromanoise`;
}

/** @param {Head} head */
function showSensors(head) {
  const table = tableOf(head.electrons, "Electrons that each sensor collects");
  const last = [...table.querySelectorAll("td:last-child")];
  head.sensors.forEach(({ saturated }, i) => last[i].classList.toggle("saturated", saturated.length > 0));
  const notes = head.sensors.flatMap(({ name, notes: own }) => (own ?? []).map((note) => `${name}: ${note}`));
  const list = el("ul", { class: "notes" });
  lines(list, notes);
  refill(byId("electrons"), table, list);
}

/**
 * A list of sentences; those that stay are not written again.
 *
 * @param {Element} list
 * @param {string[]} texts
 */
function lines(list, texts) {
  while (list.children.length > texts.length) list.lastElementChild?.remove();
  texts.forEach((text, i) => say(list.children[i] ?? list.appendChild(el("li")), text));
}
