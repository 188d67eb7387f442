/** The verdict, and the table of the sensors. */

import { attribute, byId, el, say } from "app/dom.js";
import { scrolled } from "app/panels.js";
import { onHead, places, sortable, turned } from "app/sorting.js";
import { mark, sameSensor, sensorLines } from "draw/look.js";
import { refill } from "draw/refill.js";
import { svg } from "draw/svg.js";

/** @import { Head, Ranking } from "answers" */
/** @import { Sorting } from "app/sorting.js" */
/** @typedef {Ranking["rows"][number]} Row */

const REST_MS = 500;
const TITLE = "Sensors";
/** The column of the names, which is sorted by the alphabet. */
const NAME = "name";
/** Columns with one number for each state; an earlier one stands under it. */
const COMPARED = new Set(["raw_db", "luminance_db", "loss_db", "color_error", "visual_noise", "time_ms"]);

/** How the table is sorted; none: as in the study. */
/** @type {Sorting} */
let sorting = null;
/** @type {number | undefined} */
let telling;

/**
 * Shows the verdict large, and tells it to those who listen once it has come to rest.
 *
 * @param {Head} head
 */
export function showVerdict(head) {
  const [first = "", ...more] = head.verdict;
  say(byId("verdict"), first);
  lines(byId("reasons"), more);
  const button = byId("more");
  if (button.hidden !== (more.length === 0)) button.hidden = more.length === 0;
  clearTimeout(telling);
  telling = setTimeout(() => tell(head), REST_MS);
}

/** @param {Head} head */
function tell({ verdict, sensors, light }) {
  say(byId("told"), verdict.join(" "));
  document.title = `${sensors.map((sensor) => sensor.name).join(", ")} at ${light.text} – chromanoise`;
}

/**
 * The table of the sensors, with the numbers of pinned states under those of this one.
 *
 * @param {Head} head
 * @param {Head[]} ghosts
 */
export function showSensors(head, ghosts) {
  const { columns, rows, notes } = head.ranking;
  const colors = sensorLines(rows.map(({ name }) => name));
  const before = ghosts.map(({ ranking }) => ({ ...ranking, sensors: ranking.rows }));
  const lists = rows.map((row, i) => {
    const earlier = before.map((ghost) => ({ ghost, row: sameSensor(ghost, row, i) }));
    const cells = columns.map(({ key }, k) => {
      const was = COMPARED.has(key) ? earlier.flatMap(({ ghost, row: old }) => textOf(ghost, old, key) ?? []) : [];
      const differs = was.some((text) => text !== row.text[k]);
      return el("td", { "data-key": key, text: row.text[k] }, differs ? el("small", { text: ` (was ${was.join(", ")})` }) : null);
    });
    const full = row.saturated.length > 0;
    const last = el("td", { "data-key": "saturated", class: full ? "saturated" : null, text: row.saturated.join(", ") || "none" });
    const swatch = svg("svg", { width: 16, height: 16, class: "d-swatch", "aria-hidden": "true" }, [
      mark(i, 8, 8, colors[i].color),
    ]);
    const assumed = row.assumed ? el("small", { text: row.assumed }) : null;
    return el("tr", {}, el("th", { scope: "row" }, swatch, el("span", { text: row.name }), assumed), ...cells, last);
  });
  const heads = [
    sortable(sorting, NAME, "sensor", "name of the sensor"),
    ...columns.map(({ key, head: text, what }) => sortable(sorting, key, text, what)),
    el("th", { scope: "col", text: "saturated" }),
  ];
  const sorted = order(head.ranking).map((i) => lists[i]);
  showIn(byId("electrons"), scrolled(TITLE, { class: "ranking" }, el("tr", {}, ...heads), sorted), notes);
}

const MOST_OPEN = 3;

/**
 * The table, and its notes, which whoever opens or closes them finds as they were.
 *
 * @param {HTMLElement} place
 * @param {HTMLElement} table
 * @param {string[]} notes
 */
function showIn(place, table, notes) {
  if (!place.firstChild) {
    const remarks = el("details", { class: "remarks" }, el("summary"), el("ul", { class: "notes" }));
    place.append(el("div"), remarks);
  }
  const [holder, remarks] = /** @type {any} */ (place.children);
  const [summary, list] = remarks.children;
  refill(holder, table);
  if (list.children.length !== notes.length) remarks.open = notes.length <= MOST_OPEN;
  remarks.hidden = notes.length === 0;
  say(summary, notes.length === 1 ? "1 note on the sensors" : `${notes.length} notes on the sensors`);
  lines(list, notes);
}

/**
 * @param {Ranking} ghost
 * @param {Row | null} row
 * @param {string} key
 */
function textOf(ghost, row, key) {
  return row?.text[ghost.columns.findIndex((column) => column.key === key)] ?? null;
}

/**
 * The places of the rows: as in the study, or sorted; what has no value comes last.
 *
 * @param {Ranking} ranking
 */
function order({ columns, rows }) {
  const key = sorting?.key;
  const k = columns.findIndex((column) => column.key === key);
  if (!sorting || (k < 0 && key !== NAME)) return rows.map((_, i) => i);
  return places(rows.map((row) => (key === NAME ? row.name : row.values[k])), sorting.up);
}

/**
 * Sorts by the column of a pressed head: better values first, then the other way, then as in the
 * study. `shown()` is called when that changed.
 *
 * @param {() => Head | null} head
 * @param {() => void} shown
 */
export function sortOnClick(head, shown) {
  onHead(byId("electrons"), (key) => {
    const better = head()?.ranking.columns.find((column) => column.key === key)?.better;
    sorting = turned(sorting, key, better !== "higher");
    shown();
  });
}

/** The reasons after the first two are shown on demand. */
export function moreOnClick() {
  const [button, reasons] = [byId("more"), byId("reasons")];
  button.addEventListener("click", () => {
    const all = reasons.classList.toggle("all");
    attribute(button, "aria-expanded", all ? "true" : "false");
    say(button, all ? "Fewer reasons" : "All reasons");
  });
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
