/** Cells with two numbers, each split by sensor, under a strip of its true color. */

import { textWidth } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { caption, isFull, legend, mark, markPath, note, sensorLines } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, svg, tenth, words } from "draw/svg.js";

/** @import { Chart, Options, Swatches } from "answers" */
/** @typedef {ReturnType<typeof layout>} Layout */

const COLUMNS = 6;
const GAP = 4;

/**
 * @param {HTMLElement} element
 * @param {Chart} data
 * @param {Options<Chart>} [options]
 */
export function draw(element, data, options = {}) {
  const width = Math.min(1080, figureWidth(element, options));
  const [truth, ...sensors] = swatchesOf(data);
  const plan = layout(sensors.length, width);
  const nodes = truth.colors.map((color, k) => cell(color, sensors, k, plan));
  const across = Math.ceil(truth.colors.length / COLUMNS);
  const height = across * (plan.tall + GAP) - GAP;
  readable(element, data.table, () => truth.colors.map((_, k) => placeOf(k, plan)));
  const drawn = figure(width, height, data.title, data.description, nodes);
  const how = data.notes.map((sentence) => note(sentence, "d-note d-over"));
  refill(element, caption(data), key(data, sensors, plan, options.ghosts ?? []), ...how, drawn);
}

/** @param {Chart} data */
const swatchesOf = ({ panels: [{ marks }] }) => marks.filter((one) => one.kind === "swatches");

/**
 * The sensors of a patch in as many columns as four digits fit.
 *
 * @param {number} count
 * @param {number} width
 */
function layout(count, width) {
  const each = (width - GAP * (COLUMNS - 1)) / COLUMNS;
  const fit = Math.max(1, Math.min(count, Math.floor(each / (count > 2 ? 74 : 58))));
  const rows = Math.ceil(count / fit);
  const columns = Math.ceil(count / rows);
  const strip = each >= 90 ? 12 : 8;
  const high = rows > 1 || columns === 1 ? 42 : 48;
  return { each, columns, rows, strip, high, tall: strip + high * rows, count };
}

/**
 * @param {number} k
 * @param {Layout} plan
 */
function corner(k, { each, tall }) {
  return { left: (k % COLUMNS) * (each + GAP), top: Math.floor(k / COLUMNS) * (tall + GAP) };
}

/**
 * Where a patch of the table stands.
 *
 * @param {number} k
 * @param {Layout} plan
 */
function placeOf(k, plan) {
  const { left, top } = corner(k, plan);
  const area = { width: plan.each, height: plan.tall };
  return { x: left + plan.each / 2, y: top + plan.tall / 2, ...area, row: k, series: Math.floor(k / COLUMNS) };
}

/**
 * @param {string} color
 * @param {Swatches[]} sensors
 * @param {number} k
 * @param {Layout} plan
 */
function cell(color, sensors, k, plan) {
  const { left, top } = corner(k, plan);
  const nodes = [svg("rect", { width: plan.each, height: plan.strip, fill: color })];
  sensors.forEach((sensor, i) => nodes.push(...half(sensor, k, i, plan)));
  const edge = { width: plan.each, height: plan.tall, class: "d-cell" };
  nodes.push(svg("rect", edge));
  return svg("g", { transform: `translate(${left} ${top})` }, nodes);
}

/**
 * @param {Swatches} sensor
 * @param {number} k
 * @param {number} i
 * @param {Layout} plan
 */
function half(sensor, k, i, plan) {
  const { each, columns, strip, high, count } = plan;
  const width = each / columns;
  const box = { x: (i % columns) * width, y: strip + Math.floor(i / columns) * high, width, height: high };
  const color = sensor.colors[k];
  const fill = color ?? "var(--paper)";
  const ink = color ? legible(color) : "var(--ink)";
  const nodes = [svg("rect", { ...box, fill })];
  const beside = count > 2 && width >= 56 ? 12 : 0; // for the mark
  const middle = box.x + (width + beside) / 2;
  const base = box.y + (high === 48 ? 21 : 17);
  const [error, noise] = sensor.texts[k] ?? [full(width - beside), ""];
  if (beside) nodes.push(dot(i, box.x + 9, box.y + high / 2, ink, fill));
  nodes.push(
    number(middle, base, error, ink, "d-strong"),
    number(middle, base + 18, noise, ink, "d-cell-noise"),
  );
  return nodes;
}

/**
 * The sensor's mark in the ink of its patch.
 *
 * @param {number} i
 * @param {number} x
 * @param {number} y
 * @param {string} ink
 * @param {string} paper
 */
function dot(i, x, y, ink, paper) {
  const node = svg("path", { d: markPath(i, x, y, 3.5), "stroke-width": 1.5 });
  node.style.setProperty("stroke", ink);
  node.style.setProperty("fill", isFull(i) ? ink : paper);
  return node;
}

/** @param {number} width */
function full(width) {
  return textWidth("saturated") <= width - 4 ? "saturated" : "sat.";
}

/**
 * @param {number} x
 * @param {number} y
 * @param {string} text
 * @param {string} fill
 * @param {string} look
 */
function number(x, y, text, fill, look) {
  const node = words(x, y, text, `d-cell-text ${look}`, "middle");
  node.style.setProperty("fill", fill);
  return node;
}

/**
 * Black or white, whichever stands out more on the patch.
 *
 * @param {string} srgb
 */
function legible(srgb) {
  const [r, g, b] = [1, 3, 5].map((k) => {
    const part = parseInt(srgb.slice(k, k + 2), 16) / 255;
    return part <= 0.04 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.179 ? "#000000" : "#ffffff";
}

/**
 * @param {Chart} data
 * @param {Swatches[]} sensors
 * @param {Layout} plan
 * @param {Chart[]} ghosts
 */
function key(data, sensors, plan, ghosts) {
  const places = plan.columns === 2 ? ["left", "right"] : ["upper", "lower"];
  const color = sensorLines(data.sensors).map((one) => one.color);
  const more = sensors.map(({ name }, i) => {
    const place = plan.count === 2 ? `${places[i]}: ` : "";
    const before = ghosts.flatMap((ghost) => {
      const old = swatchesOf(ghost).find(({ sensor }) => sensor !== null && ghost.sensors[sensor] === data.sensors[i]);
      return old?.texts.length ? [old.name.slice(data.sensors[i].length).replace(/^, mean /, "")] : [];
    });
    const ghost = before.length ? ` (pinned ${before.join("; ")})` : "";
    const drawn = [swatch(i, plan), ...(plan.count > 2 ? [mark(i, 45, 8, color[i], 4)] : [])];
    return { drawn, name: `${place}${name}${ghost}`, width: plan.count > 2 ? 54 : 36 };
  });
  return legend(more);
}

/**
 * A small cell whose half is full where this sensor stands.
 *
 * @param {number} i
 * @param {Layout} plan
 */
function swatch(i, { columns, rows }) {
  const [wide, high] = [34 / columns, 14 / rows];
  const [left, top] = [1 + (i % columns) * wide, 1 + Math.floor(i / columns) * high];
  const group = [
    svg("rect", { x: 1, y: 1, width: 34, height: 14, class: "d-cell" }),
    svg("rect", { x: tenth(left), y: tenth(top), width: tenth(wide), height: tenth(high), class: "d-full" }),
  ];
  return svg("g", {}, group);
}
