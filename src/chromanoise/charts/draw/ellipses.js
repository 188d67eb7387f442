/** Noise of the chart's patches as ellipses; one unit is as long across as up, at every size. */

import { axes, linear, niceStep, panels, wrapped } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { caption, note, panelName, pinnedLegend, sameSensor } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, line, svg, tenth, words } from "draw/svg.js";

/** @import { EllipsePatch, Ellipses, EllipsesSensor, Options } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @import { Place } from "draw/hover.js" */
/** @typedef {ReturnType<typeof equalAspect>} Window */

const MOST_WIDE = 4; // of more sensors four are side by side where there is room
const ROOM = { left: 44, right: 16, top: 44, bottom: 46 };

/**
 * @param {HTMLElement} element
 * @param {Ellipses} data
 * @param {Options<Ellipses>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = (options.ghosts ?? []).filter((ghost) => ghost.plane === data.plane);
  if (!data.sensors.some((sensor) => sensor.patches.length)) {
    refill(element, ...data.sensors.map((sensor) => note(sensor.why_not ?? "")));
    return;
  }
  const grid = panels(data.sensors.length, width, data.sensors.length > MOST_WIDE ? 220 : 340);
  const view = window2d(data, ghosts, grid.each - ROOM.left - ROOM.right);
  const tall = view.height + ROOM.top + ROOM.bottom;
  /** @type {(() => Place[])[]} */
  const reads = [];
  const nodes = grid.places.flatMap((place, i) =>
    panel(data, i, { left: place.left, top: place.row * (tall + 8), each: grid.each, view, ghosts, reads }),
  );
  const height = grid.rows * (tall + 8) - 8;
  const drawn = figure(width, height, data.title, data.description, nodes);
  const ellipse = `Ellipse: ${data.sigmas} standard deviations of the noise.`;
  const key = `Cross: the true color. Line: from it to the color that is measured. ${ellipse}`;
  readable(element, data.table, () => reads.flatMap((read) => read()));
  refill(element, caption(data), ...pinnedLegend(ghosts), drawn, note(key));
}

/**
 * The part of the plane that is shown, the same for all sensors, and pixels per unit.
 *
 * @param {Ellipses} data
 * @param {Ellipses[]} ghosts
 * @param {number} room
 */
function window2d(data, ghosts, room) {
  const windows = [data, ...ghosts].map((answer) => answer.window);
  const low = [0, 1].map((k) => Math.min(...windows.map((window) => window[0][k])));
  const high = [0, 1].map((k) => Math.max(...windows.map((window) => window[1][k])));
  return equalAspect(low, high, room);
}

/**
 * Equal units on both axes: what is left over of the width or the height only shows more plane.
 *
 * @param {number[]} low
 * @param {number[]} high
 * @param {number} room
 */
function equalAspect(low, high, room) {
  const margin = 0.03 * Math.max(high[0] - low[0], high[1] - low[1], 1e-9);
  const span = [0, 1].map((k) => high[k] - low[k] + 2 * margin);
  const tallest = Math.max(240, Math.min(520, 1.1 * room));
  const scale = Math.min(room / span[0], tallest / span[1]);
  const height = Math.round(span[1] * scale);
  const [middleX, middleY] = [0, 1].map((k) => (low[k] + high[k]) / 2);
  const [halfX, halfY] = [room / scale / 2, height / scale / 2];
  return { x: [middleX - halfX, middleX + halfX], y: [middleY - halfY, middleY + halfY], height, scale };
}

/**
 * @param {Ellipses} data
 * @param {number} i
 * @param {{ left: number, top: number, each: number, view: Window, ghosts: Ellipses[], reads: (() => Place[])[] }} box
 */
function panel(data, i, { left, top, each, view, ghosts, reads }) {
  const sensor = data.sensors[i];
  const x = equalScale(view.x, left + ROOM.left, view.scale);
  const y = equalScale(view.y, top + ROOM.top + view.height, -view.scale);
  reads.push(() => places(data, i, x, y));
  const [xTitle, yTitle] = data.names;
  const nodes = axes(x, y, { x: xTitle, y: yTitle, yAt: left + 22 });
  const names = data.sensors.map(({ name }) => name);
  nodes.unshift(...panelName(names, i, { left, top, room: each }));
  const inside = [];
  for (const ghost of ghosts) {
    const before = sameSensor(ghost, sensor, i)?.patches ?? [];
    const d = before.map((patch) => closed(patch.outline, x, y)).join("");
    inside.push(svg("path", { d, class: "d-ghost" }));
  }
  inside.push(...patches(sensor.patches, x, y));
  nodes.push(cut(inside, x, y));
  if (sensor.larger) nodes.push(words(x.to - 6, y.to + 16, "larger than the panel", "d-rim", "end"));
  if (!sensor.patches.length) nodes.push(...absence(sensor, x, y));
  return nodes;
}

/**
 * @param {number} value
 * @param {Scale} scale
 */
function isInside(value, { low, high }) {
  return value >= low && value <= high;
}

/**
 * Where each patch of the table stands: the middle of its ellipse.
 *
 * @param {Ellipses} data
 * @param {number} i
 * @param {Scale} x
 * @param {Scale} y
 * @returns {Place[]}
 */
function places({ sensors }, i, x, y) {
  const first = sensors.slice(0, i).reduce((sum, { patches }) => sum + Math.max(1, patches.length), 0);
  return sensors[i].patches.flatMap(({ center }, k) =>
    isInside(center[0], x) && isInside(center[1], y)
      ? [{ x: x.at(center[0]), y: y.at(center[1]), row: first + k, series: i }]
      : [],
  );
}

/**
 * What lies within the panel.
 *
 * @param {SVGElement[]} nodes
 * @param {Scale} x
 * @param {Scale} y
 */
function cut(nodes, x, y) {
  const box = [x.from, y.to, x.to - x.from, y.from - y.to].map(tenth);
  const [left, top, width, height] = box;
  return svg("svg", { x: left, y: top, width, height, viewBox: box.join(" ") }, nodes);
}

/**
 * Why nothing is drawn, in place of it.
 *
 * @param {EllipsesSensor} sensor
 * @param {Scale} x
 * @param {Scale} y
 */
function absence(sensor, x, y) {
  const lines = wrapped(sensor.why_not ?? "", x.to - x.from - 12);
  return lines.map((text, k) => words(x.from + 8, y.to + 18 + 18 * k, text, "d-rim"));
}

/**
 * A scale by pixels per unit and not by its end, so that no rounding bends the aspect.
 *
 * @param {number[]} ends
 * @param {number} from
 * @param {number} perUnit
 * @returns {Scale}
 */
function equalScale([low, high], from, perUnit) {
  const scale = linear(low, high, from, from + (high - low) * perUnit);
  const step = niceStep(high - low, Math.max(2, Math.abs(scale.to - from) / 48));
  return { ...scale, ticks: () => linear(low, high, 0, 1).ticks((high - low) / step) };
}

/**
 * Few elements: a path per patch, the widest undermost, and one for all crosses and errors.
 *
 * @param {EllipsePatch[]} all
 * @param {Scale} x
 * @param {Scale} y
 */
function patches(all, x, y) {
  const errors = [];
  const crosses = [];
  const nodes = [];
  for (const patch of [...all].sort((a, b) => b.reach - a.reach)) {
    const truth = [x.at(patch.truth[0]), y.at(patch.truth[1])];
    crosses.push(`M${tenth(truth[0] - 4)} ${tenth(truth[1])}h8m-4 -4v8`);
    errors.push(line([truth, [x.at(patch.center[0]), y.at(patch.center[1])]]));
    nodes.push(svg("path", { d: closed(patch.outline, x, y), fill: patch.srgb, class: "d-ellipse" }));
  }
  nodes.push(svg("path", { d: errors.join(""), class: "d-error" }));
  nodes.push(svg("path", { d: crosses.join(""), class: "d-cross-rim" }));
  nodes.push(svg("path", { d: crosses.join(""), class: "d-cross" }));
  return nodes;
}

/**
 * @param {number[][]} outline
 * @param {Scale} x
 * @param {Scale} y
 */
function closed(outline, x, y) {
  return `${line(outline.map((point) => [x.at(point[0]), y.at(point[1])]))}Z`;
}
