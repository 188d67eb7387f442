/** The charts as panels: a heading, its equations, a caption, its drawing, its table. */

import { attribute, button, byId, el, uniqueId, within } from "app/dom.js";
import { onHead, places, sortable, turned } from "app/sorting.js";
import { changeLook } from "app/state.js";
import { draw } from "draw/charts.js";
import { refill } from "draw/refill.js";

/** @import { Drawn, Look, Options, Part, Section, Table } from "answers" */
/** @typedef {Options<any> & { look: Look & { level_lux?: number, level?: string } }} DrawnOptions */
/**
 * @typedef {object} Panel
 * @property {Part} part
 * @property {string} title
 * @property {HTMLElement} section
 * @property {HTMLElement} body
 * @property {HTMLElement} table
 * @property {HTMLElement} toggle
 * @property {HTMLElement} fault
 * @property {boolean} visible
 * @property {number} version of the study that it shows
 * @property {number} width
 * @property {object | null} data
 * @property {DrawnOptions | null} options of the last drawing
 * @property {import("app/sorting.js").Sorting} sorting of its table
 * @property {(data: object | null, options: DrawnOptions) => void} show
 */

/** The drawn parts, in their order. */
/** @type {Part[]} */
export const PARTS = [];

/** Sections that are no drawn parts. */
const OTHERS = ["head", "picture"];

/**
 * A section of the page: heading, caption and the place of its drawing.
 *
 * @param {Section} section
 */
function sectionOf({ part, heading, shows, explanations, is_broad }) {
  const title = el("h2", { id: `h-${part}`, text: heading });
  const why = el("button", {
    type: "button",
    text: "?",
    class: "equation",
    "data-equation": explanations.join(" "),
    "aria-label": `Equation and source: ${heading}`,
  });
  return el(
    "section",
    {
      class: is_broad ? "panel broad" : "panel",
      "data-part": part,
      "aria-labelledby": title.id,
      "aria-busy": part === "head" ? null : "true",
    },
    el("div", { class: "head" }, title, el("div", { class: "tools" }, why)),
    el("p", { class: "shows", text: shows }),
    el("div", { class: "body", id: part === "head" ? "electrons" : null }),
  );
}

/**
 * Makes panels of the sections of the server, in their order.
 *
 * `seen()` is called when one becomes visible, `tools` gives the controls of a heading by part.
 * Gives a map from part to panel with `part`, `visible`, `version`, `show(data, options)`.
 *
 * @param {Section[]} sections
 * @param {{ seen: () => void, tools: Record<string, HTMLElement>, resized: (panel: Panel) => void }} options
 */
export function panels(sections, { seen, tools, resized }) {
  byId("panels").append(...sections.map(sectionOf));
  PARTS.push(...sections.map(({ part }) => part).filter((part) => !OTHERS.includes(part)));
  /** @type {Map<Part, Panel>} */
  const made = new Map();
  /** @param {Element} target */
  const panelFor = (target) => made.get(/** @type {Part} */ (/** @type {HTMLElement} */ (target).dataset.part));
  // without a margin: what nobody sees yet is asked for at rest
  const watcher = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) /** @type {Panel} */ (panelFor(target)).visible = isIntersecting;
    seen();
  });
  const sizes = new ResizeObserver((entries) => {
    for (const { target, contentRect } of entries) {
      const [panel, whole] = [/** @type {Panel} */ (panelFor(target)), Math.floor(contentRect.width)];
      if (whole === panel.width || whole === 0) continue;
      panel.width = whole;
      resized(panel);
    }
  });
  for (const part of PARTS) {
    const panel = panelOf(part, tools[part] ?? null);
    made.set(part, panel);
    // a width must be known before the first drawing, or that would be made twice
    panel.width = Math.floor(panel.body.clientWidth);
    watcher.observe(panel.section);
    sizes.observe(panel.body);
  }
  pack(/** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("main > .panel")));
  return made;
}

/** Rows of the style sheet's grid, and the space below a panel. */
const ROW_PX = 4;
const GAP_ROWS = 4;

/**
 * Lets each panel take as many rows as its height needs.
 *
 * @param {Iterable<HTMLElement>} sections
 */
export function pack(sections) {
  const heights = new ResizeObserver((entries) => {
    for (const { target, borderBoxSize } of entries) {
      const rows = Math.ceil(borderBoxSize[0].blockSize / ROW_PX) + GAP_ROWS;
      /** @type {HTMLElement} */ (target).style.setProperty("--span", String(rows));
    }
  });
  for (const section of sections) heights.observe(section);
}

/**
 * @param {Part} part
 * @param {HTMLElement | null} tool
 * @returns {Panel}
 */
function panelOf(part, tool) {
  const section = within(document, `section[data-part="${part}"]`);
  const body = within(section, ".body");
  body.dataset.part = part;
  const title = within(section, "h2").textContent ?? "";
  const { table, toggle } = tablePlace(title, () => changeLook((look) => (look.open = flipped(look.open, part))));
  const controls = within(section, ".head .tools");
  if (tool) controls.prepend(tool);
  controls.append(toggle);
  section.append(table);
  const fault = el("p", { class: "fault", role: "alert", hidden: true });
  section.insertBefore(fault, body);
  /** @type {Panel} */
  const panel = {
    ...{ part, title, section, body, table, toggle, fault },
    ...{ visible: false, version: -1, width: 0, data: null, options: null, sorting: null },
    show: (data, options) => show(panel, data, options),
  };
  onHead(table, (key) => {
    panel.sorting = turned(panel.sorting, key, true);
    showTable(panel, true);
  });
  return panel;
}

/**
 * The hidden place of a table, and the button that shows and hides it.
 *
 * @param {string} title
 * @param {() => unknown} click
 */
export function tablePlace(title, click) {
  const table = el("div", { class: "table", id: uniqueId("table"), hidden: true });
  const controls = { "aria-expanded": "false", "aria-controls": table.id, "aria-label": `Table: ${title}` };
  return { table, toggle: button("Table", click, { ...controls, class: "toggle" }) };
}

/**
 * @param {string[]} open
 * @param {string} part
 */
function flipped(open, part) {
  return open.includes(part) ? open.filter((other) => other !== part) : [...open, part];
}

/**
 * Draws an answer; what cannot be drawn is one sentence in its place.
 *
 * @param {Panel} panel
 * @param {object | null} data
 * @param {DrawnOptions} options
 */
function show(panel, data, options) {
  panel.data = data;
  panel.options = options;
  const complaint = faultOf(data) ?? drawn(panel, data, options);
  panel.fault.hidden = complaint === null;
  panel.fault.textContent = complaint ?? "";
  panel.body.hidden = complaint !== null;
  panel.section.removeAttribute("aria-busy");
  panel.toggle.hidden = data !== null && "table" in data && /** @type {Table} */ (data.table).rows.length === 0;
  showTable(panel, options.look.open.includes(panel.part));
}

/** @param {object | null | undefined} data */
function faultOf(data) {
  if (data === null || data === undefined) return "Nothing can be shown for these settings.";
  return "fault" in data && typeof data.fault === "string" ? data.fault : null;
}

/**
 * @param {Panel} panel
 * @param {object | null} data
 * @param {DrawnOptions} options
 */
function drawn(panel, data, options) {
  try {
    draw(panel.body, /** @type {Drawn} */ (data), { width: panel.width, ...options });
    return null;
  } catch (error) {
    return `This could not be drawn (${error instanceof Error ? error.message : error}); the table has the numbers.`;
  }
}

/**
 * What a panel shows, drawn into another element.
 *
 * @param {Panel} panel
 * @param {HTMLElement} element
 */
export function drawAgain({ section, data, options }, element) {
  if (section.hasAttribute("aria-busy")) throw new Error("The chart is still being computed; save it afterwards.");
  draw(element, /** @type {Drawn} */ (data), { ...options, width: element.clientWidth });
}

/**
 * Shows or hides the numbers behind a drawing.
 *
 * @param {Panel} panel
 * @param {boolean} open
 */
export function showTable(panel, open) {
  attribute(panel.toggle, "aria-expanded", open ? "true" : "false");
  panel.table.hidden = !open;
  if (!open || panel.data === null || !("table" in panel.data)) return panel.table.replaceChildren();
  return refill(panel.table, sortedTable(/** @type {Table} */ (panel.data.table), panel));
}

/**
 * The table of a chart, whose columns sort it.
 *
 * @param {Table} table
 * @param {Panel} panel
 */
function sortedTable({ head, rows }, { title, sorting }) {
  const heads = head.map((text) => sortable(sorting, text, text));
  const k = sorting ? head.indexOf(sorting.key) : -1;
  if (!sorting || k < 0) return tableOf({ head, rows }, title, heads);
  const texts = rows.map((row) => (row[k].trim() === NONE ? "" : row[k]));
  const numbers = texts.map(numberIn);
  const are_numbers = numbers.every((number, i) => number !== null || !texts[i].trim());
  const values = are_numbers ? numbers : texts.map((text) => text || null);
  return tableOf({ head, rows: places(values, sorting.up).map((i) => rows[i]) }, title, heads);
}

/** What a table has in place of a number. */
const NONE = "\u2013";

/**
 * The number of a cell, which may have signs of typography; null without one.
 *
 * @param {string} text
 */
function numberIn(text) {
  const number = Number.parseFloat(text.replaceAll("\u2212", "-"));
  return Number.isNaN(number) ? null : number;
}

const OPENS = "Add it to the sensors, or go to it there";

/** Sensors of the catalog, whose names are buttons in tables; none before the catalog has come. */
/** @type {Set<string>} */
let openable = new Set();

/**
 * Lets the names of sensors in all tables call `open(name)`.
 *
 * @param {string[]} names
 * @param {(name: string) => void} open
 */
export function openSensors(names, open) {
  openable = new Set(names);
  byId("panels").addEventListener("click", ({ target }) => {
    const button = target instanceof Element ? target.closest("button[data-sensor]") : null;
    if (button instanceof HTMLElement && button.dataset.sensor) open(button.dataset.sensor);
  });
}

/**
 * The table of a chart.
 *
 * @param {Table} table
 * @param {string} caption
 * @param {HTMLElement[]} [heads] of its columns
 */
export function tableOf({ head, rows }, caption, heads = head.map((text) => el("th", { scope: "col", text }))) {
  /** @param {string} text */
  const name = (text) =>
    openable.has(text) ? el("button", { type: "button", class: "sort", "data-sensor": text, title: OPENS, text }) : text;
  /**
   * @param {string} text
   * @param {number} i
   */
  const cell = (text, i) => (i === 0 ? el("th", { scope: "row" }, name(text)) : el("td", { text }));
  return scrolled(caption, {}, el("tr", {}, ...heads), rows.map((row) => el("tr", {}, ...row.map(cell))));
}

/**
 * A table of rows; a wide or long one scrolls by itself, by keyboard as well.
 *
 * @param {string} caption
 * @param {{ class?: string }} look
 * @param {HTMLElement} head
 * @param {HTMLElement[]} rows
 */
export function scrolled(caption, look, head, rows) {
  const named = el("caption", { class: "unseen", text: caption });
  const table = el("table", look, named, el("thead", {}, head), el("tbody", {}, ...rows));
  return el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": `Table: ${caption}` }, table);
}
