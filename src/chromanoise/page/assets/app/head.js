/** The verdict, and what each sensor collects. */

import { brief, byId, el, say } from "app/dom.js";
import { tableOf } from "app/panels.js";
import { refill } from "draw/refill.js";

/** @import { Head, HeadSensor } from "answers" */

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
  document.title = `${sensors.map((sensor) => sensor.name).join(", ")} at ${brief(light.level_lux)} lx – chromanoise`;
}

/** @param {Head} head */
function showSensors(head) {
  const channels = [...new Set(head.sensors.flatMap((sensor) => sensor.channels))];
  const names = ["Sensor", "Time [ms]", "f-number", ...channels.map((name) => `${name} [e\u207b]`), "Saturated"];
  const rows = head.sensors.map((sensor) => [
    sensor.name,
    brief(sensor.time_ms),
    brief(sensor.f_number, 3),
    ...channels.map((name) => brief(sensor.mean_e[name] ?? null, 4)),
    fullness(sensor),
  ]);
  const table = tableOf({ head: names, rows }, "Electrons that each sensor collects");
  for (const sensor of table.querySelectorAll("td:last-child")) {
    if (sensor.textContent !== "no") sensor.classList.add("saturated");
  }
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

/** @param {HeadSensor} sensor */
function fullness(sensor) {
  return sensor.saturated.length ? sensor.saturated.join(", ") : "no";
}
