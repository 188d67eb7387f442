/** What a matrix can trade: color error against SNR, along the weight of the noise. */

import { axes, linear, niceRange, textWidth } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { areMany, caption, legend, mark, markPath, note, sameSensor, sensorLines } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, known, line, svg, tenth, words } from "draw/svg.js";

/** @import { Options, Pareto, ParetoPoint, ParetoSensor, WeightedPoint } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @import { Line } from "draw/look.js" */
/** @typedef {ParetoPoint & { color_error: number, snr_db: number }} Whole */
/** @typedef {{ left: number, right: number, top: number, bottom: number }} Box */

const ROOM = { left: 44, right: 28, top: 34, bottom: 44 };

/**
 * @param {HTMLElement} element
 * @param {Pareto} data
 * @param {Options<Pareto>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = options.ghosts ?? [];
  const names = data.sensors.map((sensor) => sensor.name);
  const lines = sensorLines(names);
  if (!data.sensors.some((sensor) => [...sensor.points, sensor.now].some(whole))) {
    const why = data.sensors.map((sensor) => sensor.why_not ?? `${sensor.name}: SNR is undefined.`);
    refill(element, ...[...new Set(why)].map((sentence) => note(sentence)));
    return;
  }
  const { x, y, height } = plane(data, ghosts, width);
  const nodes = axes(x, y, { x: "SNR of Y [dB]", y: "training error, mean ΔE*ab", xRoom: 80 });
  nodes.push(words(x.to - 4, y.from - 8, "better ↘", "d-quiet d-rim", "end"));
  data.sensors.forEach((sensor, i) => {
    for (const ghost of ghosts) {
      const before = sameSensor(ghost, sensor, i)?.points ?? [];
      nodes.push(
        svg("path", { d: curve(before, x, y), class: "d-ghost", "stroke-dasharray": lines[i].dash || null }),
      );
    }
    nodes.push(...trade(sensor, lines[i], x, y));
  });
  nodes.push(...labels(data, lines, x, y));
  const told = figure(width, height, data.title, data.description, nodes);
  const made = data.matrix ? ` (${data.matrix})` : "";
  const key = `Numbers: the weight of the noise in the matrix. Large mark: the matrix now${made}.`;
  readable(element, data.table, () => places(data, x, y));
  refill(element, caption(data), legend(names, "both", ghosts.length), told, note(key));
}

/**
 * @param {Pareto} data
 * @param {Pareto[]} ghosts
 * @param {number} width
 */
function plane(data, ghosts, width) {
  const all = [data, ...ghosts].flatMap((answer) =>
    answer.sensors.flatMap((sensor) => [...sensor.points, sensor.now].filter(whole)),
  );
  const tall = Math.round(Math.min(360, Math.max(200, 0.45 * width)));
  const [left, right] = niceRange(
    all.map((point) => point.snr_db),
    5,
  );
  const [low, high] = niceRange(
    all.map((point) => point.color_error),
    5,
  );
  const x = linear(left, right, ROOM.left, width - ROOM.right);
  const y = linear(low, high, ROOM.top + tall, ROOM.top);
  return { x, y, height: ROOM.top + tall + ROOM.bottom };
}

/**
 * @template {ParetoPoint} T
 * @param {T | null} point
 * @returns {point is T & Whole}
 */
function whole(point) {
  return known(point?.snr_db) && known(point?.color_error);
}

/**
 * @param {ParetoPoint[]} points
 * @param {Scale} x
 * @param {Scale} y
 */
function curve(points, x, y) {
  return line(points.map((p) => (whole(p) ? [x.at(p.snr_db), y.at(p.color_error)] : null)));
}

/**
 * Where each point of the table stands: the weights, then the matrix now.
 *
 * @param {Pareto} data
 * @param {Scale} x
 * @param {Scale} y
 */
function places({ sensors }, x, y) {
  let row = -1;
  return sensors.flatMap(({ points, now }, series) =>
    [...points, now].flatMap((point) => {
      row += 1;
      return whole(point) ? [{ x: x.at(point.snr_db), y: y.at(point.color_error), row, series }] : [];
    }),
  );
}

/**
 * @param {ParetoSensor} sensor
 * @param {Line} look
 * @param {Scale} x
 * @param {Scale} y
 */
function trade(sensor, { dash, color }, x, y) {
  const dots = sensor.points
    .filter(whole)
    .map((p) => markPath(0, x.at(p.snr_db), y.at(p.color_error), 2.5))
    .join("");
  return [
    svg("path", {
      d: curve(sensor.points, x, y),
      class: "d-curve",
      stroke: color,
      "stroke-dasharray": dash || null,
    }),
    svg("path", { d: dots, fill: color }),
  ];
}

/**
 * The matrix now, then as many weights as find room; what would touch is left out. Of many sensors,
 * the mark of the matrix now carries the name of the sensor.
 *
 * @param {Pareto} data
 * @param {Line[]} lines
 * @param {Scale} x
 * @param {Scale} y
 */
function labels(data, lines, x, y) {
  const many = areMany(data.sensors.map((sensor) => sensor.name));
  const taken = data.sensors.flatMap((sensor) => along(sensor.points.filter(whole), x, y));
  const words = { left: x.to - 70, right: x.to, top: y.from - 22, bottom: y.from };
  taken.push(words);
  const marked = [words];
  /** @type {SVGElement[]} */
  const nodes = [];
  data.sensors.forEach((sensor, i) => {
    if (!whole(sensor.now)) return;
    const at = [x.at(sensor.now.snr_db), y.at(sensor.now.color_error)];
    const box = { left: at[0] - 10, right: at[0] + 10, top: at[1] - 10, bottom: at[1] + 10 };
    taken.push(box);
    marked.push(box);
    nodes.push(mark(i, at[0], at[1], lines[i].color, 7));
  });
  data.sensors.forEach((sensor) => {
    if (!whole(sensor.now)) return;
    const free = placed(sensor.now, many ? sensor.name : "now", "d-strong d-rim", x, y, taken, 13);
    if (free.length || !many) return nodes.push(...free);
    nodes.push(...placed(sensor.now, sensor.name, "d-strong d-rim", x, y, marked, 13));
    taken.push(...marked.slice(-1));
  });
  data.sensors.forEach((sensor) => {
    /** @type {number[][]} */
    const labelled = [];
    for (const point of outerFirst(rounded(sensor.points.filter(whole)))) {
      const at = [x.at(point.snr_db), y.at(point.color_error)];
      if (labelled.some((other) => Math.hypot(other[0] - at[0], other[1] - at[1]) < 24)) continue;
      labelled.push(at);
      nodes.push(...placed(point, point.text, "d-tick d-rim", x, y, taken));
    }
  });
  return nodes;
}

/**
 * Small boxes along a curve, so that no label stands on it.
 *
 * @param {Whole[]} points
 * @param {Scale} x
 * @param {Scale} y
 */
function along(points, x, y) {
  /** @type {Box[]} */
  const boxes = [];
  points.forEach((point, k) => {
    const next = points[k + 1] ?? point;
    const [ax, ay] = [x.at(point.snr_db), y.at(point.color_error)];
    const [bx, by] = [x.at(next.snr_db), y.at(next.color_error)];
    const parts = Math.max(1, Math.ceil(Math.hypot(bx - ax, by - ay) / 8));
    for (let j = 0; j < parts; j += 1) {
      const [px, py] = [ax + ((bx - ax) * j) / parts, ay + ((by - ay) * j) / parts];
      boxes.push({ left: px - 2, right: px + 2, top: py - 2, bottom: py + 2 });
    }
  });
  return boxes;
}

/**
 * Weights that are powers of ten, where there are such: they read at a glance.
 *
 * @template {WeightedPoint} T
 * @param {T[]} points
 */
function rounded(points) {
  const tens = points.filter((point) => Math.abs(Math.log10(point.weight) % 1) < 1e-6);
  return tens.length > 1 ? tens : points;
}

/**
 * The ends of the curve matter most, so they are placed before what lies between.
 *
 * @template T
 * @param {T[]} points
 */
function outerFirst(points) {
  if (points.length < 3) return points;
  return [points[0], points[points.length - 1], ...points.slice(1, -1)];
}

/**
 * @param {Whole} point
 * @param {string} text
 * @param {string} look
 * @param {Scale} x
 * @param {Scale} y
 * @param {Box[]} taken
 * @param {number} [gap]
 */
function placed(point, text, look, x, y, taken, gap = 9) {
  const [px, py] = [x.at(point.snr_db), y.at(point.color_error)];
  const wide = textWidth(text, 15) + 2;
  const [left, low] = [-gap - wide, gap + 10];
  const corners = [
    [gap, 4],
    [left, 4],
    [gap, -6],
    [left, -6],
    [gap, 16],
    [left, 16],
  ];
  corners.push(
    [-wide / 2, -gap - 3],
    [-wide / 2, low + 3],
    [gap, -gap],
    [left, -gap],
    [gap, low],
    [left, low],
  );
  for (const [dx, dy] of corners) {
    const box = { left: px + dx, right: px + dx + wide, top: py + dy - 11, bottom: py + dy + 3 };
    if (box.left < x.from || box.right > x.to + ROOM.right || box.bottom > y.from || box.top < 18) continue;
    if (taken.some((other) => overlap(box, other))) continue;
    taken.push(box);
    return [words(tenth(box.left), py + dy, text, look)];
  }
  return [];
}

/**
 * @param {Box} a
 * @param {Box} b
 */
function overlap(a, b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}
