/** A quantity over two parameters: a cell per pair of values, a color scale, and a value to read. */

import { axes, linear, logarithmic, wrapped } from "draw/axes.js";
import { caption, note } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, html, line, svg, tenth, words } from "draw/svg.js";

/** @import { DrawnMap, MapAxis, Options, SweepMap } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {ReturnType<typeof layout>} Layout */
/** @typedef {{ data: DrawnMap, plan: Layout, at: number[] }} View what is read: column and row */

const ROOM = { left: 46, right: 14, top: 76, bottom: 44 };
const HELP = "Point at a cell, or move with the arrow keys.";
/** @type {Record<string, number[]>} */
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };

/** @type {WeakMap<Element, View>} */
const views = new WeakMap();

/**
 * @param {HTMLElement} element
 * @param {SweepMap} data
 * @param {Options<SweepMap>} [options]
 */
export function draw(element, data, options = {}) {
  if (data.why_not !== null) {
    views.delete(element);
    refill(element, note(data.why_not));
    return;
  }
  const plan = layout(data, figureWidth(element, options));
  const nodes = axes(plan.x, plan.y, { y: data.y.what, yTop: ROOM.top - 12, xRoom: 48, levelOnly: true });
  plan.title.forEach((text, i) => nodes.push(words((plan.left + plan.right) / 2, plan.bottom + 35 + 16 * i, text, "d-quiet", "middle")));
  nodes.push(...scaleOf(data, plan), svg("path", { d: area(plan), class: "d-undefined" }), ...cells(data, plan));
  for (const points of data.equal) nodes.push(...equal(points, plan));
  nodes.push(svg("rect", { class: "d-cursor", visibility: "hidden" }));
  const help = { class: "d-figure d-map", tabindex: 0, "aria-keyshortcuts": "ArrowLeft ArrowRight ArrowUp ArrowDown" };
  const root = figure(plan.width, plan.height, data.title, `${data.description} ${HELP}`, nodes, help);
  const read = html("p", { class: "d-note d-read", role: "status" }, HELP);
  refill(element, caption(data), root, read, ...notes(data));
  const before = views.get(element);
  views.set(element, { data, plan, at: before?.at ?? [0, 0] });
  if (!before) listen(element);
  else if (element.contains(document.activeElement)) show(element);
}

/**
 * Values are equally far apart on their axis, so every cell has one size.
 *
 * @param {DrawnMap} data
 * @param {number} width
 */
function layout({ x, y }, width) {
  const left = ROOM.left;
  const right = width - ROOM.right;
  const tall = Math.round(Math.min(340, Math.max(200, 0.45 * width)));
  const [top, bottom] = [ROOM.top, ROOM.top + tall];
  const cell = { width: (right - left) / x.values.length, height: tall / y.values.length };
  const across = centered(x, left, right, cell.width / 2);
  const up = centered(y, bottom, top, -cell.height / 2);
  const title = wrapped(x.what, right - left);
  const height = bottom + ROOM.bottom + 16 * (title.length - 1);
  return { width, height, left, right, top, bottom, cell, title, x: across, y: up };
}

/**
 * @param {MapAxis} axis
 * @param {number} from
 * @param {number} to
 * @param {number} half
 * @returns {Scale}
 */
function centered({ values, logarithmic: log }, from, to, half) {
  const scale = log ? logarithmic : linear;
  return { ...scale(values[0], values[values.length - 1], from + half, to - half), from, to };
}

/** @param {Layout} plan */
function area({ left, right, top, bottom }) {
  return `M${left} ${top}H${tenth(right)}V${bottom}H${left}Z`;
}

/**
 * One path per color, each cell a little too large, so that no gap shows between neighbors.
 *
 * @param {DrawnMap} data
 * @param {Layout} plan
 */
function cells(data, plan) {
  /** @type {Map<string, string>} */
  const paths = new Map();
  data.colors.forEach((row, j) =>
    row.forEach((color, k) => {
      if (color === null) return;
      const { left, top, width, height } = place(plan, k, j);
      const d = `M${tenth(left)} ${tenth(top)}h${tenth(width + 0.4)}v${tenth(height + 0.4)}h${tenth(-width - 0.4)}z`;
      paths.set(color, (paths.get(color) ?? "") + d);
    }),
  );
  return [...paths].map(([fill, d]) => svg("path", { d, fill }));
}

/**
 * @param {Layout} plan
 * @param {number} k
 * @param {number} j
 */
function place({ left, bottom, cell }, k, j) {
  return { left: left + k * cell.width, top: bottom - (j + 1) * cell.height, ...cell };
}

/**
 * The scale of colors with its unit; of more than two sensors, the color of each.
 *
 * @param {DrawnMap} data
 * @param {Layout} plan
 */
function scaleOf({ what, unit, scale, key }, { left, right }) {
  if (!scale) return keyOf(what, key, right);
  const { low, high, colors } = scale;
  const nodes = [words(0, 12, `${what} [${unit}]`, "d-quiet")];
  const bar = linear(low, high, left, Math.min(right, left + 380));
  const step = (bar.to - bar.from) / colors.length;
  colors.forEach((fill, i) =>
    nodes.push(svg("rect", { x: tenth(left + i * step), y: 20, width: tenth(step + 0.5), height: 9, fill })),
  );
  for (const { value, label } of bar.ticks(Math.max(2, Math.floor((bar.to - bar.from) / 64)))) {
    const x = bar.at(value);
    nodes.push(svg("path", { d: `M${tenth(x)} 29v4`, class: "d-thin" }), words(x, 45, label, "d-tick", "middle"));
  }
  return nodes;
}

/**
 * @param {string} what
 * @param {{ name: string, color: string }[]} key
 * @param {number} right
 */
function keyOf(what, key, right) {
  const nodes = [words(0, 12, what, "d-quiet")];
  const each = (right + 14) / Math.max(1, Math.min(4, key.length));
  key.forEach(({ name, color }, i) => {
    const [x, y] = [(i % 4) * each, 22 + 18 * Math.floor(i / 4)];
    nodes.push(svg("rect", { x: tenth(x), y, width: 14, height: 12, fill: color }), words(x + 20, y + 11, name));
  });
  return nodes;
}

/**
 * @param {number[][]} points
 * @param {Layout} plan
 */
function equal(points, { x, y, cell }) {
  const ends = points.map(([a, b]) => [x.at(a), y.at(b)]);
  const drawn = ends.length > 1 ? ends : [[ends[0][0], ends[0][1] - cell.height / 2], [ends[0][0], ends[0][1] + cell.height / 2]];
  return [svg("path", { d: line(drawn), class: "d-casing" }), svg("path", { d: line(drawn), class: "d-curve d-ink-line" })];
}

/** @param {DrawnMap} data */
function notes({ equal: lines, colors, note: more }) {
  const told = [];
  if (lines.length) told.push("Line: both are equal.");
  if (colors.some((row) => row.includes(null))) told.push("Gray: a channel is saturated, or the value is undefined.");
  if (more) told.push(more);
  return told.length ? [note(told.join(" "))] : [];
}

/** @param {HTMLElement} element */
function listen(element) {
  element.addEventListener("pointermove", (event) => pointed(element, event));
  element.addEventListener("pointerdown", (event) => pointed(element, event));
  element.addEventListener("focusin", () => show(element));
  element.addEventListener("focusout", () => hide(element));
  element.addEventListener("pointerleave", () => element.contains(document.activeElement) || hide(element));
  element.addEventListener("keydown", (event) => moved(element, event));
}

/**
 * @param {HTMLElement} element
 * @param {PointerEvent} event
 */
function pointed(element, event) {
  const view = views.get(element);
  const root = element.querySelector(".d-map");
  if (!view || !root) return;
  const { left, right, top, bottom, cell, width } = view.plan;
  const box = root.getBoundingClientRect();
  const scale = width / box.width;
  const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
  if (x < left || x >= right || y <= top || y > bottom) return;
  view.at = [Math.floor((x - left) / cell.width), Math.floor((bottom - y) / cell.height)];
  show(element);
}

/**
 * @param {HTMLElement} element
 * @param {KeyboardEvent} event
 */
function moved(element, event) {
  const view = views.get(element);
  const step = STEPS[event.key];
  if (!view || !step || event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  view.at = view.at.map((value, i) => value + step[i]);
  show(element);
}

/**
 * Marks the cell that is read, and says its values.
 *
 * @param {HTMLElement} element
 */
function show(element) {
  const view = views.get(element);
  const cursor = element.querySelector(".d-cursor");
  const read = element.querySelector(".d-read");
  if (!view || !cursor || !read) return;
  const { data, plan } = view;
  const [k, j] = [data.x, data.y].map((axis, i) => Math.max(0, Math.min(axis.values.length - 1, view.at[i])));
  view.at = [k, j];
  const { left, top, width, height } = place(plan, k, j);
  const box = { x: left, y: top, width, height };
  for (const [name, value] of Object.entries(box)) cursor.setAttribute(name, String(tenth(value)));
  cursor.setAttribute("visibility", "visible");
  const told = `${data.x.text[k]}, ${data.y.text[j]}: ${data.cells[j][k]}`;
  if (read.textContent !== told) read.textContent = told;
}

/** @param {HTMLElement} element */
function hide(element) {
  element.querySelector(".d-cursor")?.setAttribute("visibility", "hidden");
  const read = element.querySelector(".d-read");
  if (read) read.textContent = HELP;
}
