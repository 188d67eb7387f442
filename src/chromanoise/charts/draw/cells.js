/** A value over two axes: a colored cell per pair, a color scale, and a value to read. */

import { axes, linear, logarithmic, wrapped } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { caption, notes } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, known, line, svg, tenth, words } from "draw/svg.js";

/** @import { Axis, Cells, Chart, Options } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {ReturnType<typeof layout>} Layout */

const ROOM = { left: 46, right: 14, top: 76, bottom: 44 };

const COLORS = 10; // of sensors

/**
 * @param {HTMLElement} element
 * @param {Chart} data
 * @param {Options<Chart>} [options]
 */
export function draw(element, data, options = {}) {
  const [{ x, y, marks: [of] }] = data.panels;
  if (of.kind !== "cells") return;
  const count = { x: of.across, y: data.columns[of.value].values.length / of.across };
  const plan = layout(x, y, count, figureWidth(element, options));
  const nodes = axes(plan.x, plan.y, { y: y.label, yTop: ROOM.top - 12, xRoom: 48, levelOnly: true });
  plan.title.forEach((text, i) => nodes.push(words((plan.left + plan.right) / 2, plan.bottom + 35 + 16 * i, text, "d-quiet", "middle")));
  const area = `M${plan.left} ${plan.top}H${tenth(plan.right)}V${plan.bottom}H${plan.left}Z`;
  nodes.push(...scaleOf(of, plan), svg("path", { d: area, class: "d-undefined" }), ...cells(data, of, plan));
  for (const points of of.equal) nodes.push(...equal(points, plan));
  const root = figure(plan.width, plan.height, data.title, data.description, nodes, { class: "d-figure d-map" });
  readable(element, data.table, () => places(count, plan));
  refill(element, caption(data), root, ...notes(data));
}

/**
 * Values are equally far apart on their axis, so every cell has one size.
 *
 * @param {Axis} x
 * @param {Axis} y
 * @param {{ x: number, y: number }} count
 * @param {number} width
 */
function layout(x, y, count, width) {
  const left = ROOM.left;
  const right = width - ROOM.right;
  const tall = Math.round(Math.min(340, Math.max(200, 0.45 * width)));
  const [top, bottom] = [ROOM.top, ROOM.top + tall];
  const cell = { width: (right - left) / count.x, height: tall / count.y };
  const across = centered(x, left, right, cell.width / 2);
  const up = centered(y, bottom, top, -cell.height / 2);
  const title = wrapped(x.label, right - left);
  const height = bottom + ROOM.bottom + 16 * (title.length - 1);
  return { width, height, left, right, top, bottom, cell, title, x: across, y: up };
}

/**
 * @param {Axis} axis
 * @param {number} from
 * @param {number} to
 * @param {number} half
 * @returns {Scale}
 */
function centered({ low, high, logarithmic: log }, from, to, half) {
  const scale = log ? logarithmic : linear;
  return { ...scale(low, high, from + half, to - half), from, to };
}

/**
 * One path per color, each cell a little too large, so that no gap shows between neighbors.
 *
 * @param {Chart} data
 * @param {Cells} of
 * @param {Layout} plan
 */
function cells({ columns }, of, plan) {
  /** @type {Map<string, string>} */
  const paths = new Map();
  columns[of.value].values.forEach((value, row) => {
    if (!known(value)) return;
    const share = (value - of.low) / (of.high - of.low);
    const color = colorOf(of, Math.round(share * (of.colors.length - 1)));
    const { left, top, width, height } = place(plan, row % of.across, Math.floor(row / of.across));
    const d = `M${tenth(left)} ${tenth(top)}h${tenth(width + 0.4)}v${tenth(height + 0.4)}h${tenth(-width - 0.4)}z`;
    paths.set(color, (paths.get(color) ?? "") + d);
  });
  return [...paths].map(([fill, d]) => svg("path", { d, fill }));
}

/**
 * A color of the scale; that of a sensor fits the theme.
 *
 * @param {Cells} of
 * @param {number} i
 */
const colorOf = ({ names, colors }, i) => (names.length ? `var(--sensor-${i % COLORS})` : colors[i]);

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
 * @param {Cells} of
 * @param {Layout} plan
 */
function scaleOf(of, { left, right }) {
  if (of.names.length) return keyOf(of, right);
  const { low, high, colors, name } = of;
  const nodes = [words(0, 12, name, "d-quiet")];
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
 * @param {Cells} of
 * @param {number} right
 */
function keyOf(of, right) {
  const key = of.names.flatMap((name, i) => (name ? [{ name, color: colorOf(of, i) }] : []));
  const nodes = [words(0, 12, of.name, "d-quiet")];
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

/**
 * The cells of the table, whose rows rise with y; keys go over them as they are seen.
 *
 * @param {{ x: number, y: number }} count
 * @param {Layout} plan
 */
function places(count, plan) {
  const rows = Array.from({ length: count.y }, (_, j) =>
    Array.from({ length: count.x }, (_, k) => {
      const { left, top, width, height } = place(plan, k, j);
      const area = { x: left + width / 2, y: top + height / 2, width, height };
      return { ...area, row: j * count.x + k, series: count.y - j };
    }),
  );
  return rows.reverse().flat();
}
