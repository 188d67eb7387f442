/** Waterfall of each sensor from its raw signal to the color coordinate, on one dB scale. */

import { fitting, linear, niceRange, panels, textWidth, wrapped, zeroLine } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { caption, legend, note, panelName, sameSensor } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, known, svg, tenth, words } from "draw/svg.js";

/** @import { Budget, BudgetSensor, BudgetStep, Options } from "answers" */
/** @import { Grid } from "draw/axes.js" */
/** @typedef {ReturnType<typeof layout>} Layout */

const KEY =
  "First and last bar: the SNR before and after. Gray: costs. Outlined: gains. All in dB, on one scale.";
const BAR = 14;
const LINE = 16;
const MOST_TALL = 4; // of more sensors the rows are closer

/**
 * @param {HTMLElement} element
 * @param {Budget} data
 * @param {Options<Budget>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = options.ghosts ?? [];
  const names = data.sensors.map((sensor) => sensor.name);
  const grid = panels(names.length, width, 420, 32);
  const scale = range(data, ghosts);
  const boxes = data.sensors.map((sensor) => layout(sensor, grid.each, scale, names.length > MOST_TALL ? 20 : 24));
  const tops = rowTops(boxes, grid);
  const nodes = data.sensors.flatMap((sensor, i) => {
    const at = { left: grid.places[i].left, top: tops.rows[grid.places[i].row] };
    return waterfall(
      sensor,
      boxes[i],
      { ...at, title: panelName(names, i, { left: 0, top: 0, room: grid.each }) },
      ghosts.map((ghost) => sameSensor(ghost, sensor, i)),
    );
  });
  const drawn = figure(width, tops.height, data.title, data.description, nodes);
  readable(element, data.table, () => places(data, boxes, grid, tops.rows), true);
  const any = data.sensors.some((sensor) => sensor.steps.length);
  const kept = ghosts.length ? [legend([], "mark", 0, [pinned()])] : [];
  refill(element, caption(data), ...kept, drawn, ...(any ? [note(KEY)] : []));
}

/**
 * @param {Budget} data
 * @param {Budget[]} ghosts
 */
function range(data, ghosts) {
  const steps = [data, ...ghosts].flatMap((answer) => answer.sensors.flatMap((s) => s.steps));
  return niceRange(steps.flatMap((step) => [step.from_db, step.to_db]), 5, [0]);
}

/**
 * Labels stand beside their bars where there is room, else above them.
 *
 * @param {BudgetSensor} sensor
 * @param {number} width
 * @param {number[]} limits
 * @param {number} pitch
 */
function layout(sensor, width, [low, high], pitch) {
  const steps = sensor.steps;
  const longest = Math.max(60, ...steps.map((step) => textWidth(step.label)));
  const beside = width - longest - 64 >= 64;
  const left = beside ? Math.min(longest + 12, 0.5 * width) : 4;
  const x = linear(low, high, left, width - 58);
  const lines = steps.map((step) => (beside ? [step.label] : wrapped(step.label, width - 8)));
  const tops = [];
  let y = 34;
  for (const told of lines) {
    tops.push(y);
    y += beside ? pitch : LINE * told.length + BAR + 10;
  }
  const why = steps.length ? [] : wrapped(sensor.why_not ?? "no budget", width - 8);
  const bottom = steps.length ? y : y + why.length * 18;
  return { x, beside, lines, tops, why, width, bottom, height: bottom + (steps.length ? 26 : 6) };
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
 * @param {BudgetSensor} sensor
 * @param {Layout} box
 * @param {{ left: number, top: number, title: SVGElement[] }} at
 * @param {(BudgetSensor | null)[]} ghosts
 */
function waterfall(sensor, box, at, ghosts) {
  const nodes = [...at.title];
  nodes.push(...box.why.map((text, k) => words(0, 44 + 18 * k, text, "d-quiet")));
  const steps = sensor.steps;
  if (steps.length) nodes.push(...scale(box));
  for (const ghost of ghosts) nodes.push(...ghostSteps(ghost, sensor, box));
  steps.forEach((step, k) => nodes.push(...bar(step, k, box, steps[k + 1])));
  return [svg("g", { transform: `translate(${at.left} ${at.top})` }, nodes)];
}

/** @param {Layout} box */
function scale({ x, bottom }) {
  const ticks = x.ticks(Math.max(2, Math.floor((x.to - x.from) / 56)));
  const d = ticks.map((tick) => `M${tenth(x.at(tick.value))} 26V${bottom}`).join("");
  const marks = ticks.map((tick, k) => {
    const label = k === ticks.length - 1 ? `${tick.label} dB` : tick.label;
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
 * @param {BudgetStep} step
 * @param {Layout} box
 */
function span(step, { x }) {
  const whole = step.kind === "start" || step.kind === "end";
  return { whole, from: whole ? x.at(Math.max(0, x.low)) : x.at(step.from_db), to: x.at(step.to_db) };
}

/**
 * Where each step of the table stands.
 *
 * @param {Budget} data
 * @param {Layout[]} boxes
 * @param {Grid} grid
 * @param {number[]} rows
 */
function places(data, boxes, grid, rows) {
  let row = 0;
  return data.sensors.flatMap(({ steps }, i) => {
    const [left, top] = [grid.places[i].left, rows[grid.places[i].row]];
    const first = row;
    row += Math.max(1, steps.length);
    return steps.map((step, k) => {
      const { from, to } = span(step, boxes[i]);
      const area = { width: Math.max(2, Math.abs(to - from)), height: BAR };
      const y = top + barTop(k, boxes[i]) + BAR / 2;
      return { x: left + (from + to) / 2, y, ...area, row: first + k, series: i };
    });
  });
}

/**
 * @param {BudgetStep} step
 * @param {number} k
 * @param {Layout} box
 * @param {BudgetStep | undefined} next
 */
function bar(step, k, box, next) {
  const { whole, from, to } = span(step, box);
  const y = barTop(k, box);
  const look = whole ? "d-full" : step.kind === "gain" ? "d-gain" : "d-cost";
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
 * @param {BudgetSensor | null} ghost
 * @param {BudgetSensor} sensor
 * @param {Layout} box
 */
function ghostSteps(ghost, sensor, box) {
  const steps = sensor.steps;
  return (ghost?.steps ?? []).flatMap((step) => {
    const k = steps.findIndex((now) => now.label === step.label);
    if (k < 0 || !known(step.to_db)) return [];
    return [ghostMark(box.x.at(step.to_db), barTop(k, box))];
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
