/** Waterfalls: a panel per sensor with a bar per row, one under the other, all on one scale. */

import { fitting, linear, niceRange, sensorPanels, textWidth, wrapped, zeroLine } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { caption, legend, notes, panelName, rowsOf } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, svg, tenth, words } from "draw/svg.js";

/** @import { Chart, Options } from "answers" */
/** @import { Grid } from "draw/axes.js" */
/** @typedef {ReturnType<typeof layout>} Layout */
/** @typedef {{ row: number, label: string, from: number, to: number, role: string, text: string }} Step */
/** @typedef {{ name: string, absence: string, steps: Step[] }} Waterfall */

const BAR = 14;
const LINE = 16;
const MOST_TALL = 4; // of more sensors the rows are closer

/**
 * @param {HTMLElement} element
 * @param {Chart} data
 * @param {Options<Chart>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const [own, ...ghosts] = [data, ...(options.ghosts ?? [])].map(waterfalls);
  const names = own.map(({ name }) => name);
  const grid = sensorPanels(names.length, width, 420);
  const ends = [data, ...(options.ghosts ?? [])].flatMap(({ panels: [{ x }] }) => [x.low, x.high]);
  const scale = niceRange(ends, 5, [0]);
  const { label } = data.panels[0].x;
  const unit = label.slice(label.indexOf("[") + 1, -1);
  const boxes = own.map((one) => layout(one, grid.each, scale, names.length > MOST_TALL ? 20 : 24, unit));
  const tops = rowTops(boxes, grid);
  const nodes = own.flatMap((one, i) => {
    const at = { left: grid.places[i].left, top: tops.rows[grid.places[i].row] };
    const title = panelName(names, i, { left: 0, top: 0, room: grid.each });
    const before = ghosts.flatMap((all) => all.filter(({ name }) => name === one.name));
    return waterfall(one, boxes[i], { ...at, title }, before);
  });
  const drawn = figure(width, tops.height, data.title, data.description, nodes);
  readable(element, data.table, () => places(own, boxes, grid, tops.rows), true);
  const kept = ghosts.length ? [legend([pinned()])] : [];
  refill(element, caption(data), ...kept, drawn, ...notes(data));
}

/**
 * @param {Chart} chart
 * @returns {Waterfall[]}
 */
function waterfalls({ columns, panels: all, sensors }) {
  return all.map(({ title, sensor, marks: [bars], absence }) => {
    const steps = bars?.kind !== "bars" ? [] : rowsOf(bars).map((row, k) => {
      const [label, from, to] = [bars.label, bars.start, bars.end].map((index) => columns[index].values[row]);
      return { row, label: String(label), from: Number(from), to: Number(to), role: bars.roles[k], text: bars.texts[k] };
    });
    return { name: sensor === null ? title : sensors[sensor], absence, steps };
  });
}

/**
 * Labels stand beside their bars where there is room, else above them.
 *
 * @param {Waterfall} of
 * @param {number} width
 * @param {number[]} limits
 * @param {number} pitch
 * @param {string} unit
 */
function layout({ steps, absence }, width, [low, high], pitch, unit) {
  const longest = Math.max(60, ...steps.map((step) => textWidth(step.label)));
  const beside = width - longest - 64 >= 64;
  const left = beside ? Math.min(longest + 12, 0.6 * width) : 4;
  const x = linear(low, high, left, width - 58);
  const lines = steps.map((step) => (beside ? [step.label] : wrapped(step.label, width - 8)));
  const tops = [];
  let y = 34;
  for (const told of lines) {
    tops.push(y);
    y += beside ? pitch : LINE * told.length + BAR + 10;
  }
  const why = steps.length ? [] : wrapped(absence, width - 8);
  const bottom = steps.length ? y : y + why.length * 18;
  return { x, unit, beside, lines, tops, why, width, bottom, height: bottom + (steps.length ? 26 : 6) };
}

/**
 * @param {Layout[]} boxes
 * @param {Grid} grid
 */
function rowTops(boxes, grid) {
  const rows = [];
  let height = 0;
  for (let row = 0; row < grid.rows; row += 1) {
    rows.push(height);
    const mine = boxes.filter((_, i) => grid.places[i].row === row);
    height += Math.max(...mine.map((box) => box.height)) + 8;
  }
  return { rows, height: height - 8 };
}

/**
 * @param {Waterfall} of
 * @param {Layout} box
 * @param {{ left: number, top: number, title: SVGElement[] }} at
 * @param {Waterfall[]} ghosts
 */
function waterfall({ steps }, box, at, ghosts) {
  const nodes = [...at.title];
  nodes.push(...box.why.map((text, k) => words(0, 44 + 18 * k, text, "d-quiet")));
  if (steps.length) nodes.push(...scale(box));
  for (const ghost of ghosts) nodes.push(...ghostSteps(ghost.steps, steps, box));
  steps.forEach((step, k) => nodes.push(...bar(step, k, box, steps[k + 1])));
  return [svg("g", { transform: `translate(${at.left} ${at.top})` }, nodes)];
}

/** @param {Layout} box */
function scale({ x, unit, bottom }) {
  const ticks = x.ticks(Math.max(2, Math.floor((x.to - x.from) / 56)));
  const d = ticks.map((tick) => `M${tenth(x.at(tick.value))} 26V${bottom}`).join("");
  const marks = ticks.map((tick, k) => {
    const label = k === ticks.length - 1 ? `${tick.label} ${unit}` : tick.label;
    const place = Math.max(x.at(tick.value), textWidth(label, 12) / 2);
    return words(place, bottom + 17, label, "d-tick", "middle");
  });
  return [svg("path", { d, class: "d-grid" }), ...zeroLine(x, 26, bottom), ...marks];
}

/**
 * @param {number} k
 * @param {Layout} box
 */
function barTop(k, box) {
  return box.tops[k] + (box.beside ? 0 : LINE * box.lines[k].length + 2);
}

/**
 * @param {Step} step
 * @param {Layout} box
 */
function span(step, { x }) {
  const whole = step.role === "total";
  return { whole, from: x.at(whole ? Math.max(0, x.low) : step.from), to: x.at(step.to) };
}

/**
 * Where each step of the table stands.
 *
 * @param {Waterfall[]} own
 * @param {Layout[]} boxes
 * @param {Grid} grid
 * @param {number[]} rows
 */
function places(own, boxes, grid, rows) {
  return own.flatMap(({ steps }, i) => {
    const [left, top] = [grid.places[i].left, rows[grid.places[i].row]];
    return steps.map((step, k) => {
      const { from, to } = span(step, boxes[i]);
      const area = { width: Math.max(2, Math.abs(to - from)), height: BAR };
      const y = top + barTop(k, boxes[i]) + BAR / 2;
      return { x: left + (from + to) / 2, y, ...area, row: step.row, series: i };
    });
  });
}

/**
 * @param {Step} step
 * @param {number} k
 * @param {Layout} box
 * @param {Step | undefined} next
 */
function bar(step, k, box, next) {
  const { whole, from, to } = span(step, box);
  const y = barTop(k, box);
  const look = whole ? "d-full" : step.role === "gain" ? "d-gain" : "d-cost";
  const wide = Math.max(1.5, Math.abs(to - from));
  const area = { x: tenth(Math.min(from, to)), y, width: tenth(wide), height: BAR, class: look };
  const nodes = [svg("rect", area)];
  if (next) nodes.push(svg("path", { d: `M${tenth(to)} ${y + BAR}V${barTop(k + 1, box)}`, class: "d-thin" }));
  const beyond = Math.max(from, to) + 7;
  nodes.push(words(beyond, y + BAR - 2, step.text, whole ? "d-strong d-rim" : "d-rim"));
  const label = box.beside ? [fitting(step.label, box.x.from - 8)] : box.lines[k];
  const base = box.beside ? y + BAR - 2 : box.tops[k] + 12;
  nodes.push(...label.map((text, j) => words(0, base + LINE * j, text, whole ? "d-strong d-rim" : "d-rim")));
  return nodes;
}

/**
 * Where the same steps of an earlier answer ended.
 *
 * @param {Step[]} before
 * @param {Step[]} steps
 * @param {Layout} box
 */
function ghostSteps(before, steps, box) {
  return before.flatMap(({ label, to }) => {
    const k = steps.findIndex((now) => now.label === label);
    return k < 0 ? [] : [ghostMark(box.x.at(to), barTop(k, box))];
  });
}

/**
 * A triangle on a bar, between the rows of numbers.
 *
 * @param {number} x
 * @param {number} y
 */
function ghostMark(x, y) {
  return svg("path", { d: `M${tenth(x)} ${y - 1}l-4 -5h8Z`, class: "d-ghost-mark" });
}

function pinned() {
  return { drawn: [ghostMark(18, 12)], name: "pinned: where the step ended" };
}
