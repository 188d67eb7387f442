/** A figure per kind of value: a mark per sensor on a line per name, with the numbers beside them. */

import { fitting, linear, niceRange, panels, textWidth, zeroLine } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { areMany, caption, channelColor, ghostMark, legend, mark, note, rowsOf as rowsIn, sensorLines } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, html, known, svg, words } from "draw/svg.js";

/** @import { Axis, Chart, Options } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {(number | null)[]} Values of each sensor */
/** @typedef {{ row: number, name: string, values: Values, text: string[], ghosts: Values[] }} Row text is empty where a sensor has none such */
/** @typedef {{ title: string, of: string, explanation: string, description: string, x: Axis, lines: Row[] }} Kind */
/** @typedef {ReturnType<typeof layout>} Layout */

const HEAD = 20;
const ROW = 24;
const LANE = 12; // from a mark to one that would touch it
const LEAST_DOTS = 100;

/**
 * @param {HTMLElement} element
 * @param {Chart} data
 * @param {Options<Chart>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = options.ghosts ?? [];
  const kinds = kindsOf(data, ghosts);
  const plan = layout(data.sensors, kinds, width);
  const lines = sensorLines(data.sensors);
  const entries = data.sensors.map((name, i) => ({ drawn: [mark(i, 18, 8, lines[i].color)], name }));
  const key = legend(entries, ghosts.length, ghostMark(0, 18, 8));
  const figures = kinds.map((kind, k) => section(kind, plan, k));
  const boxes = kinds.map((kind, k) => html("div", { class: "d-view" }, [heading(kind), figures[k]]));
  for (const box of boxes) box.style.setProperty("width", `${plan.width}px`); // its heading may wrap
  const all = html("div", { class: "d-views d-kinds" }, boxes);
  readable(element, data.table, () => places(kinds, plan), true);
  const more = plan.numbers ? [] : [note(`The table has the numbers.${missing(data, kinds)}`)];
  refill(element, html("div", {}, [caption(data), key, all, ...more]));
}

/**
 * The sensors that have no mark anywhere.
 *
 * @param {Chart} data
 * @param {Kind[]} kinds
 */
function missing({ sensors }, kinds) {
  const empty = sensors.filter((_, i) => !kinds.some((kind) => kind.lines.some((row) => known(row.values[i]))));
  return empty.length ? ` Without values: ${empty.join(", ")}.` : "";
}

const NONE = "\u2013"; // in the table, where a sensor has none such

/**
 * Each panel with its lines, and the values of the same sensors in earlier answers.
 *
 * @param {Chart} data
 * @param {Chart[]} ghosts
 * @returns {Kind[]}
 */
function kindsOf(data, ghosts) {
  const before = ghosts.map((ghost) => ({ sensors: ghost.sensors, kinds: kindsOf(ghost, []) }));
  return data.panels.map(({ title, remark, explanation, description, x, marks: [dots] }) => {
    const lines = dots.kind !== "dots" ? [] : rowsIn(dots).map((row) => {
      const name = String(data.columns[dots.label].values[row]);
      const values = dots.values.map((index) => /** @type {number | null} */ (data.columns[index].values[row]));
      const text = data.table.rows[row].slice(-values.length);
      const old = before.map(({ sensors, kinds }) => {
        const line = kinds.find((kind) => kind.explanation === explanation)?.lines.find((one) => one.name === name);
        return data.sensors.map((sensor) => line?.values[sensors.indexOf(sensor)] ?? null);
      });
      return { row, name, values, text: text.map((one) => (one === NONE ? "" : one)), ghosts: old };
    });
    return { title, of: remark, explanation, description, x, lines };
  });
}

/**
 * Columns of numbers only as wide as their words, the rest for the marks; without numbers where
 * they would leave no room. Two kinds side by side if there is room for the marks of both.
 *
 * @param {string[]} names
 * @param {Kind[]} kinds
 * @param {number} whole
 */
function layout(names, kinds, whole) {
  const all = kinds.flatMap((kind) => kind.lines);
  const left = Math.min(90, Math.max(26, ...all.map((row) => textWidth(row.name, 14) + 6)));
  const columns = names.map((_, i) => Math.max(42, ...all.map((row) => columnWidth(row, i))));
  const room = columns.reduce((sum, column) => sum + column, 4);
  const width = panels(kinds.length, whole, Math.max(400, left + room + 200), 40).each;
  const numbers = width - left - room >= LEAST_DOTS;
  const dots = numbers ? Math.min(width - room, 900) : width - 8;
  const colors = areMany(names) ? sensorLines(names).map((line) => line.color) : null;
  return { width, left, columns, numbers, dots, colors };
}

/**
 * @param {Row} row
 * @param {number} i
 */
function columnWidth(row, i) {
  const text = row.text[i];
  return known(row.values[i]) ? textWidth(text, 14) + 8 : textWidth(text, 12) + 4;
}

/**
 * The title of a kind without its unit.
 *
 * @param {Kind} kind
 */
const plain = ({ title }) => title.replace(/ \[.*\]$/, "");

/** @param {Kind} kind */
function heading(kind) {
  const nodes = [html("span", {}, kind.title)];
  const named = { type: "button", class: "equation", "data-equation": kind.explanation };
  nodes.push(html("button", { ...named, "aria-label": `Equation of the ${plain(kind)}` }, "?"));
  nodes.push(html("small", {}, kind.of));
  return html("p", { class: "d-kind" }, nodes);
}

/**
 * @param {Kind} kind
 * @param {Layout} plan
 */
function dotScale({ x, lines }, plan) {
  const [low, high] = niceRange([x.low, x.high, ...lines.flatMap(({ ghosts }) => ghosts.flat())], 5, [0]);
  return linear(low, high, plan.left + 8, plan.dots - 12);
}

/**
 * The rows of a kind with their lanes.
 *
 * @param {Kind} kind
 * @param {Layout} plan
 */
function rowsOf(kind, plan) {
  const x = dotScale(kind, plan);
  const head = plan.numbers ? HEAD : 4;
  let bottom = head;
  const rows = kind.lines.map(({ values }) => {
    const lanes = lanesOf(values, x);
    const tall = Math.max(ROW, 10 + LANE * (1 + Math.max(0, ...lanes)));
    bottom += tall;
    return { top: bottom - tall, tall, lanes };
  });
  return { x, head, rows, bottom };
}

/**
 * How high a mark stands in its row.
 *
 * @param {{ top: number, tall: number, lanes: number[] }} place
 * @param {number} i
 */
function height({ top, tall, lanes }, i) {
  return Math.round(top + tall / 2) + LANE * (lanes[i] - Math.max(0, ...lanes) / 2);
}

/**
 * Where each value of the table stands: its mark, or its number where there is none.
 *
 * @param {Kind[]} kinds
 * @param {Layout} plan
 */
function places(kinds, plan) {
  return kinds.flatMap((kind, figure) => {
    const { x, rows } = rowsOf(kind, plan);
    return kind.lines.flatMap(({ row, values, text }, k) => {
      let end = plan.dots;
      return values.flatMap((value, i) => {
        end += plan.columns[i];
        if (!text[i] || !(known(value) || plan.numbers)) return [];
        const at = known(value) ? x.at(value) : end - 14;
        return [{ x: at, y: height(rows[k], i), row, cells: [0, 1, 2 + i], series: i, figure }];
      });
    });
  });
}

/**
 * @param {Kind} kind
 * @param {Layout} plan
 * @param {number} k
 */
function section(kind, plan, k) {
  const { x, head, rows, bottom } = rowsOf(kind, plan);
  const nodes = plan.numbers ? columnMarks(plan) : [];
  kind.lines.forEach((row, j) => nodes.push(...drawnRow(row, rows[j], x, plan)));
  const scales = kind.lines.some((row) => row.values.some(known)) ? scale(x, head, bottom, kind.x.label) : [];
  const title = `${plain(kind)}, ${kind.of}`;
  const tall = bottom + (scales.length ? 22 : 2);
  return figure(plan.width, tall, title, kind.description, [...scales, ...nodes], k ? { tabindex: null } : {}); // one stop
}

/**
 * A lane per value, so that no mark is over another: the first that is free there.
 *
 * @param {Values} values
 * @param {Scale} x
 */
function lanesOf(values, x) {
  /** @type {number[]} */
  const lanes = new Array(values.length).fill(0);
  /** @type {number[]} */
  const ends = []; // of each lane
  const order = values.map((_, i) => i).filter((i) => known(values[i]));
  order.sort((a, b) => /** @type {number} */ (values[a]) - /** @type {number} */ (values[b]));
  for (const i of order) {
    const at = x.at(/** @type {number} */ (values[i]));
    const free = ends.findIndex((end) => end + LANE <= at);
    lanes[i] = free < 0 ? ends.length : free;
    ends[lanes[i]] = at;
  }
  return lanes;
}

/**
 * Each column of numbers begins with its sensor's mark.
 *
 * @param {Layout} plan
 */
function columnMarks(plan) {
  let end = plan.dots;
  return plan.columns.map((column, i) => {
    end += column;
    return mark(i, end - 10, 11, plan.colors?.[i] ?? "var(--ink)", 4);
  });
}

/**
 * @param {Scale} x
 * @param {number} top
 * @param {number} bottom
 * @param {string} unit
 */
function scale(x, top, bottom, unit) {
  const ticks = x.ticks(Math.max(2, Math.floor((x.to - x.from) / 60)));
  const d = ticks.map((tick) => `M${Math.round(x.at(tick.value))} ${top}V${bottom}`).join("");
  const marks = ticks.map((tick, k) => {
    const last = k === ticks.length - 1 && x.to - x.from > 220 && unit;
    return words(
      x.at(tick.value),
      bottom + 16,
      last ? `${tick.label} ${unit}` : tick.label,
      "d-tick",
      "middle",
    );
  });
  return [svg("path", { d, class: "d-grid" }), ...zeroLine(x, top, bottom), ...marks];
}

/**
 * @param {Row} row
 * @param {{ top: number, tall: number, lanes: number[] }} place
 * @param {Scale} x
 * @param {Layout} plan
 */
function drawnRow(row, place, x, plan) {
  const y = Math.round(place.top + place.tall / 2);
  const color = channelColor(row.name);
  const r = plan.colors ? 4 : 5;
  const nodes = [words(1, y + 5, fitting(row.name, plan.left, 14), "d-strong")];
  nodes.push(svg("path", { d: `M${x.from} ${y}H${x.to}`, class: "d-grid" }));
  for (const ghost of row.ghosts) {
    ghost.forEach((v, i) => known(v) && nodes.push(ghostMark(i, x.at(v), height(place, i), r)));
  }
  row.values.forEach((v, i) => {
    if (known(v)) nodes.push(mark(i, x.at(v), height(place, i), plan.colors?.[i] ?? color, r));
  });
  let end = plan.dots;
  if (!plan.numbers) return nodes;
  row.values.forEach((v, i) => {
    end += plan.columns[i];
    nodes.push(words(end, y + 5, row.text[i], known(v) ? "" : "d-tick", "end"));
  });
  return nodes;
}
