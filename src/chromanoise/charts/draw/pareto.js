/** What a matrix can trade: color error against SNR, along the weight of the noise. */

import { axes, fitting, linear, logarithmic, niceRange, textWidth } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { areMany, caption, legend, mark, markPath, note, pinnedLegend, sameSensor, sensorLines, sideNames } from "draw/look.js";
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
  const named = areMany(names) && width >= 560;
  const room = named ? Math.min(Math.max(...names.map((name) => textWidth(name))) + 40, 0.36 * width) : ROOM.right;
  const { x, y, height } = plane(data, ghosts, width, room);
  const nodes = axes(x, y, { x: "SNR of Y [dB]", y: "training error, mean ΔE*ab", xRoom: 80, zero: "x" });
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
  if (named) nodes.push(...beside(data, lines, x, y, room - 37));
  nodes.push(...labels(data, ghosts, lines, x, y));
  const told = figure(width, height, data.title, data.description, nodes);
  const made = data.matrix ? ` (${data.matrix})` : "";
  const key = `Numbers: the weight of the noise in the matrix. Large mark: the matrix now${made}.`;
  readable(element, data.table, () => places(data, x, y));
  const keys = named ? pinnedLegend(ghosts) : [legend(names, "both", ghosts.length)];
  refill(element, caption(data), ...keys, told, note(key));
}

/**
 * @param {Pareto} data
 * @param {Pareto[]} ghosts
 * @param {number} width
 * @param {number} room
 */
function plane(data, ghosts, width, room) {
  const all = [data, ...ghosts].flatMap((answer) =>
    answer.sensors.flatMap((sensor) => [...sensor.points, sensor.now].filter(whole)),
  );
  const tall = Math.round(Math.min(360, Math.max(200, 0.45 * width)));
  const [left, right] = niceRange(all.map((point) => point.snr_db), 5);
  const errors = all.map((point) => point.color_error);
  const x = linear(left, right, ROOM.left, width - room);
  const ends = /** @type {[number, number]} */ ([ROOM.top + tall, ROOM.top]);
  const least = Math.max(1e-3, Math.min(...errors));
  const wide = data.logarithmic ? [0.8 * least, 1.25 * Math.max(...errors)] : niceRange(errors, 5);
  const y = (data.logarithmic ? logarithmic : linear)(wide[0], wide[1], ...ends);
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
 * The names of many sensors at the right, with lines from the marks of the matrix now.
 *
 * @param {Pareto} data
 * @param {Line[]} lines
 * @param {Scale} x
 * @param {Scale} y
 * @param {number} room
 */
function beside(data, lines, x, y, room) {
  const entries = data.sensors.map(({ name, now }, i) => {
    const at = whole(now) ? [x.at(now.snr_db), y.at(now.color_error)] : null;
    return { name: fitting(name, room), at, color: lines[i].color, mark: i, dotted: true };
  });
  return sideNames(entries, { right: x.to, top: y.to, bottom: y.from });
}

/**
 * The matrix now, then as many weights as find room; what would touch is left out.
 *
 * @param {Pareto} data
 * @param {Pareto[]} ghosts
 * @param {Line[]} lines
 * @param {Scale} x
 * @param {Scale} y
 */
function labels(data, ghosts, lines, x, y) {
  const many = areMany(data.sensors.map((sensor) => sensor.name));
  const curves = [data, ...ghosts].flatMap((answer) => answer.sensors.map((sensor) => sensor.points.filter(whole)));
  const taken = curves.flatMap((points) => along(points, x, y));
  const words = { left: x.to - 70, right: x.to, top: y.from - 22, bottom: y.from };
  taken.push(words);
  /** @type {SVGElement[]} */
  const nodes = [];
  data.sensors.forEach((sensor, i) => {
    if (!whole(sensor.now)) return;
    const at = [x.at(sensor.now.snr_db), y.at(sensor.now.color_error)];
    taken.push({ left: at[0] - 10, right: at[0] + 10, top: at[1] - 10, bottom: at[1] + 10 });
    nodes.push(mark(i, at[0], at[1], lines[i].color, 7));
  });
  data.sensors.forEach((sensor) => {
    if (many || !whole(sensor.now)) return;
    nodes.push(...placed(sensor.now, "now", "d-strong d-rim", x, y, taken, 13));
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
  const beside = /** @param {number} dy */ (dy) => [[gap, dy], [left, dy]];
  const middle = [-gap - 3, low + 3].map((dy) => [-wide / 2, dy]);
  const corners = [...[4, -6, 16].flatMap(beside), ...middle, ...[-gap, low].flatMap(beside)];
  for (const [dx, dy] of corners) {
    const box = { left: px + dx, right: px + dx + wide, top: py + dy - 11, bottom: py + dy + 3 };
    if (box.left < x.from || box.right > x.to + 18 || box.bottom > y.from || box.top < 18) continue;
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
