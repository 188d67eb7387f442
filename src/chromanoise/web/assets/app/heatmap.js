/** A quantity over two parameters: a cell per pair of values, a color scale, and a value to read. */

import { axes, linear, logarithmic, wrapped } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { caption, note } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, line, svg, tenth, words } from "draw/svg.js";

/** @import { DrawnMap, MapAxis, Options, SweepMap } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {ReturnType<typeof layout>} Layout */

const ROOM = { left: 46, right: 14, top: 76, bottom: 44 };

/**
 * @param {HTMLElement} element
 * @param {SweepMap} data
 * @param {Options<SweepMap>} [options]
 */
export function draw(element, data, options = {}) {
  if (data.why_not !== null) {
    refill(element, note(data.why_not));
    return;
  }
  const plan = layout(data, figureWidth(element, options));
  const nodes = axes(plan.x, plan.y, { y: data.y.what, yTop: ROOM.top - 12, xRoom: 48, levelOnly: true });
  plan.title.forEach((text, i) => nodes.push(words((plan.left + plan.right) / 2, plan.bottom + 35 + 16 * i, text, "d-quiet", "middle")));
  const area = `M${plan.left} ${plan.top}H${tenth(plan.right)}V${plan.bottom}H${plan.left}Z`;
  nodes.push(...scaleOf(data, plan), svg("path", { d: area, class: "d-undefined" }), ...cells(data, plan));
  for (const points of data.equal) nodes.push(...equal(points, plan));
  const root = figure(plan.width, plan.height, data.title, data.description, nodes, { class: "d-figure d-map" });
  readable(element, data.table, () => places(data, plan));
  refill(element, caption(data), root, ...notes(data));
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

/**
 * The cells of the table, whose rows rise with y; keys go over them as they are seen.
 *
 * @param {DrawnMap} data
 * @param {Layout} plan
 */
function places({ x, y }, plan) {
  const rows = y.values.map((_, j) =>
    x.values.map((_, k) => {
      const { left, top, width, height } = place(plan, k, j);
      const row = j * x.values.length + k;
      return { x: left + width / 2, y: top + height / 2, width, height, row, series: y.values.length - j };
    }),
  );
  return rows.reverse().flat();
}
