/** Draws a report, and draws it anew from its own answers when a slider moves. */

import { draw as drawChart } from "draw/charts.js";
import * as picture from "draw/picture.js";
import { saveChart, saveImage, savePictures } from "draw/save.js";
import { html } from "draw/svg.js";

/** @typedef {import("answers").Drawn} Drawn */
/** @typedef {import("answers").Failed} Failed */
/** @typedef {import("answers").Part} Part */
/** @typedef {import("answers").ReportChanges} ReportChanges */
/** @typedef {import("answers").ReportData} ReportData */
/** @typedef {import("answers").ReportHead} ReportHead */
/** @typedef {{ head: ReportHead, parts: Record<Part, Drawn | Failed> }} Reply */
/** @typedef {{ data: Drawn | Failed, stale: boolean }} Shown */

const PAPER_PX = 976; // of A4 and Letter, where the style of print makes 0.6 of it
/** @type {ReportData} */
const data = JSON.parse(await unpacked(byId("data").textContent ?? ""));
/** @type {Map<HTMLElement, Shown>} */
const shown = new Map(); // what stands in each section, drawn or not yet
/** @type {number | null} */
let width = null;
let asked = 0;
/** @type {number[] | undefined} */
let turn;

/**
 * An element that the template has.
 *
 * @param {string} id
 */
function byId(id) {
  return /** @type {HTMLElement} */ (document.getElementById(id));
}

/**
 * Text that the file holds compressed: base64 of gzip.
 *
 * @param {string} packed
 */
function unpacked(packed) {
  const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
}

/**
 * @param {string} selector
 * @returns {HTMLElement[]}
 */
function all(selector) {
  return [...document.querySelectorAll(selector)].map((node) => /** @type {HTMLElement} */ (node));
}

/**
 * The study's own answer with what differs at a position of a slider.
 *
 * @param {ReportChanges} changed
 * @returns {Reply}
 */
function answer(changed) {
  /** @type {Record<string, object>} */
  const reply = {};
  for (const [part, own] of Object.entries(data.parts)) {
    reply[part] = changed[part]?.whole ?? { ...own, ...changed[part] };
  }
  const { head, ...parts } = reply;
  return /** @type {Reply} */ ({ head, parts });
}

/** @param {Reply} reply */
function show(reply) {
  const [first, ...more] = reply.head.verdict;
  byId("verdict").textContent = first;
  byId("reasons").replaceChildren(...more.map((text) => html("li", {}, text)));
  fill(/** @type {HTMLTableElement} */ (byId("sensors")), reply.head.table.rows);
  for (const section of all("section[data-part]")) {
    const now = reply.parts[section.dataset.part ?? ""];
    const before = JSON.stringify(shown.get(section)?.data);
    if (before === JSON.stringify(now) && !shown.get(section)?.stale) continue;
    shown.set(section, { data: now, stale: true });
    draw(section);
    if (before) tell(section);
  }
}

/** @param {HTMLElement} section */
function draw(section) {
  const one = /** @type {Shown} */ (shown.get(section));
  const { data: reply } = one;
  const element = /** @type {HTMLElement} */ (section.querySelector(".chart"));
  if ("fault" in reply) element.replaceChildren(html("p", { class: "d-note" }, reply.fault));
  else drawChart(element, reply, width ? { width } : {});
  one.stale = false;
}

/**
 * The table says what the drawing shows.
 *
 * @param {HTMLElement} section
 */
function tell(section) {
  const { data: reply } = /** @type {Shown} */ (shown.get(section));
  const table = section.querySelector("table");
  if (!("fault" in reply) && table) fill(table, reply.table.rows);
}

/**
 * @param {HTMLTableElement} table
 * @param {string[][]} rows
 */
function fill(table, rows) {
  /**
   * @param {string} text
   * @param {number} i
   */
  const cell = (text, i) => html(i ? "td" : "th", i ? {} : { scope: "row" }, text);
  table.tBodies[0].replaceChildren(...rows.map((row) => html("tr", {}, row.map(cell))));
}

/**
 * One slider at a time: the others go back to the study's own value.
 *
 * @param {HTMLInputElement | null} moved
 */
function slid(moved) {
  /** @type {ReportChanges} */
  let changed = {};
  const said = [];
  for (const slider of sliders) {
    const slide = data.slides[Number(slider.dataset.slide)];
    if (slider !== moved) slider.value = String(slide.own);
    const at = Number(slider.value);
    slider.setAttribute("aria-valuetext", slide.texts[at]);
    const output = slider.parentElement?.querySelector("output");
    if (output) output.textContent = slide.texts[at];
    if (at === slide.own) continue;
    changed = Object.fromEntries(Object.entries(slide.answers).map(([part, all]) => [part, all[at]]));
    said.push(`${slide.label}: ${slide.texts[at]}; all else, the time too, as in the study.`);
  }
  byId("changed").textContent = said.join(" ") || "The study as it is.";
  /** @type {HTMLButtonElement} */ (byId("back")).disabled = !said.length;
  cancelAnimationFrame(asked);
  asked = requestAnimationFrame(() => show(answer(changed)));
}

/** @param {number | null} px */
function again(px) {
  width = px;
  shown.forEach((_, section) => draw(section));
}

/**
 * Pictures of two sensors as one with a divider; what is printed stays side by side.
 *
 * @param {HTMLElement} sight
 */
function divide(sight) {
  const images = [...sight.querySelectorAll("img")];
  const [left, ...others] = images;
  for (const right of others) {
    const place = html("div", { class: "divided" });
    sight.append(place);
    picture.draw(place, { left: left.src, right: right.src, labels: [left.alt, right.alt] });
    place.append(savePictures(`${left.alt} and ${right.alt}`, place));
  }
  if (others.length) sight.classList.add("can-divide");
}

/**
 * The menu of a chart; its CSV is of the study itself, to full precision.
 *
 * @param {HTMLElement} section
 */
function savable(section) {
  const { part } = section.dataset;
  const heading = section.querySelector("h2");
  const shownNow = () => /** @type {Shown} */ (shown.get(section)).data;
  if (!part || !heading || !(part in data.csv)) return;
  const menu = saveChart({
    ...{ part, heading: heading.textContent ?? "" },
    draw: (element) => drawChart(element, /** @type {Drawn} */ (shownNow()), { width: element.clientWidth, look: { turn } }),
    data: () => /** @type {{ title: string }} */ (/** @type {unknown} */ (shownNow())),
    csv: async () => {
      if (isChanged()) throw new Error("The CSV contains the values of the study itself: move the sliders back to the study first.");
      return data.csv[part];
    },
    note: () => (isChanged() ? (byId("changed").textContent ?? "") : ""),
  });
  heading.after(menu);
}

function isChanged() {
  return !(/** @type {HTMLButtonElement} */ (byId("back")).disabled);
}

/**
 * What a `?` of a drawing asks for stands below it.
 *
 * @param {HTMLElement} button
 */
function open(button) {
  const selector = `[data-equation="${button.dataset.equation}"].equation-of`;
  const entry = /** @type {HTMLElement | null | undefined} */ (button.closest("section")?.querySelector(selector));
  const details = entry?.closest("details");
  if (!entry || !details) return;
  details.open = true;
  entry.scrollIntoView({ block: "center" });
  entry.focus();
}

const sliders = /** @type {HTMLInputElement[]} */ (all("input[data-slide]"));
sliders.forEach((slider) => slider.addEventListener("input", () => slid(slider)));
byId("back").addEventListener("click", () => {
  slid(null);
  sliders[0].focus();
});
document.addEventListener("click", (event) => {
  const { target } = event;
  const button = target instanceof Element ? target.closest("button.equation") : null;
  if (button) open(/** @type {HTMLElement} */ (button));
});
document.addEventListener("turn", (event) => (turn = /** @type {CustomEvent} */ (event).detail.turn));
all(".sight").forEach(divide);
all("section[data-part]").forEach(savable);
for (const image of document.images) {
  if (image.closest(".sweep")) image.after(saveImage(image));
}
byId("sliders").hidden = false;
show(answer({}));
slid(null);

let last = document.documentElement.clientWidth;
addEventListener("resize", () => {
  if (document.documentElement.clientWidth === last) return;
  last = document.documentElement.clientWidth;
  again(width);
});
addEventListener("beforeprint", () => again(PAPER_PX));
addEventListener("afterprint", () => again(null));
