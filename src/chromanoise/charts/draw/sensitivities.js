/** Quantum efficiency of every channel over the spectrum, a panel per sensor, all on one scale. */

import { axes, linear, niceRange, panels } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { areMany, caption, channelColor, legend, panelName, sameSensor, sensorDashes } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, known, line, svg, words } from "draw/svg.js";

/** @import { Curve, Maybe, Options, Sensitivities, SensitivitiesSensor } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {{ left: number, top: number, width: number, height: number }} Box */
/** @import { Place } from "draw/hover.js" */
/** @typedef {{ x: number, y: number }} At */

const TITLES = { x: "wavelength [nm]", y: "quantum efficiency [e⁻/photon]", levelOnly: true };
const MOST_WIDE = 4; // of more sensors three are side by side where there is room
const ROOM = { left: 40, right: 18, top: 54, bottom: 44 };

/**
 * @param {HTMLElement} element
 * @param {Sensitivities} data
 * @param {Options<Sensitivities>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = options.ghosts ?? [];
  const grid = panels(data.sensors.length, width, data.sensors.length > MOST_WIDE ? 304 : 360);
  const tall = Math.round(Math.min(340, Math.max(210, 0.5 * grid.each)));
  const names = data.sensors.map((sensor) => sensor.name);
  const dashes = areMany(names) ? names.map(() => "") : sensorDashes(names);
  const top = highest(data, ghosts);
  /** @type {(() => Place[])[]} */
  const reads = [];
  const nodes = grid.places.flatMap((place, i) => {
    const box = { left: place.left, top: place.row * (tall + 12), width: grid.each, height: tall };
    return panel(data, i, { box, dash: dashes[i], ghosts, top, reads });
  });
  const height = grid.rows * (tall + 12) - 12;
  const drawn = figure(width, height, data.title, data.description, nodes);
  readable(element, data.table, () => reads.flatMap((read) => read()));
  refill(element, caption(data), key(data, ghosts.length), drawn);
}

/**
 * @param {Sensitivities} data
 * @param {Sensitivities[]} ghosts
 */
function highest(data, ghosts) {
  const curves = [data, ...ghosts].flatMap((answer) => answer.sensors.flatMap((s) => s.channels));
  let top = 0.01;
  for (const curve of curves) for (const value of curve.qe) if (value !== null && value > top) top = value;
  return niceRange([0, top * 1.06], 4)[1];
}

/**
 * @param {Sensitivities} data
 * @param {number} i
 * @param {{ box: Box, dash: string, ghosts: Sensitivities[], top: number, reads: (() => Place[])[] }} plan
 */
function panel(data, i, { box, dash, ghosts, top, reads }) {
  const sensor = data.sensors[i];
  const nm = data.wavelength_nm;
  const last = nm[nm.length - 1];
  const right = box.left + box.width - ROOM.right;
  const x = linear(nm[0], last, box.left + ROOM.left, right);
  const y = linear(0, top, box.top + box.height - ROOM.bottom, box.top + ROOM.top);
  reads.push(() => places(data, i, x, y));
  const nodes = [light(data, x, y), infrared(data, x, y)];
  nodes.push(...axes(x, y, { ...TITLES, yAt: box.left }), ...heading(data, i, box, dash));
  for (const ghost of ghosts) nodes.push(...ghostCurves(ghost, sensor, i, x, y));
  const curves = sensor.channels.map((channel) => curve(nm, channel.qe, x, y));
  nodes.push(svg("path", { d: curves.join(""), class: "d-casing" }));
  sensor.channels.forEach((channel, c) => {
    const drawn = { d: curves[c], class: "d-curve", stroke: channelColor(channel.name) };
    nodes.push(svg("path", { ...drawn, "stroke-dasharray": dash || null }));
  });
  return [...nodes, ...letters(data, sensor.channels, x, y)];
}

/**
 * Where each value of the table stands.
 *
 * @param {Sensitivities} data
 * @param {number} i
 * @param {Scale} x
 * @param {Scale} y
 * @returns {Place[]}
 */
function places({ sensors, wavelength_nm: nm }, i, x, y) {
  const first = 2 + sensors.slice(0, i).reduce((sum, sensor) => sum + sensor.channels.length, 0);
  return sensors[i].channels.flatMap(({ qe }, c) =>
    qe.flatMap((value, k) =>
      known(value) ? [{ x: x.at(nm[k]), y: y.at(value), row: k, cells: [0, first + c], series: first + c }] : [],
    ),
  );
}

/**
 * The sensor's name after its mark, and at the right a piece of its dash.
 *
 * @param {Sensitivities} data
 * @param {number} i
 * @param {Box} box
 * @param {string} dash
 */
function heading(data, i, { left, top, width }, dash) {
  const names = data.sensors.map((sensor) => sensor.name);
  const title = panelName(names, i, { left, top, room: width - (dash ? 64 : 18) });
  if (!dash) return title;
  const piece = { d: `M${left + width - 52} ${top + 10}h34`, class: "d-curve d-ink-line" };
  return [...title, svg("path", { ...piece, "stroke-dasharray": dash })];
}

/**
 * @param {number[]} nm
 * @param {Maybe[]} values
 * @param {Scale} x
 * @param {Scale} y
 */
function curve(nm, values, x, y) {
  return line(values.map((value, k) => (known(value) ? [x.at(nm[k]), y.at(value)] : null)));
}

/**
 * @param {Sensitivities} ghost
 * @param {SensitivitiesSensor} sensor
 * @param {number} i
 * @param {Scale} x
 * @param {Scale} y
 */
function ghostCurves(ghost, sensor, i, x, y) {
  const channels = sameSensor(ghost, sensor, i)?.channels ?? [];
  return channels.map((channel) =>
    svg("path", { d: curve(ghost.wavelength_nm, channel.qe, x, y), class: "d-ghost" }),
  );
}

const LIGHT = 0.94;

/**
 * The light, relative to its highest value, as a faint area over the full height.
 *
 * @param {Sensitivities} data
 * @param {Scale} x
 * @param {Scale} y
 */
function light(data, x, y) {
  /** @param {number} value */
  const height = (value) => y.from + (y.to - y.from) * value * LIGHT;
  const outline = data.light.map((value, k) => [x.at(data.wavelength_nm[k]), height(value ?? 0)]);
  const d = `${line([[x.from, y.from], ...outline, [x.to, y.from]])}Z`;
  return svg("path", { d, class: "d-light" });
}

/**
 * @param {Sensitivities} data
 * @param {Scale} x
 * @param {Scale} y
 */
function infrared(data, x, y) {
  const from = x.at(data.infrared_from_nm);
  const width = Math.max(0, x.to - from);
  return svg("rect", { x: from, y: y.to, width, height: y.from - y.to, class: "d-nir" });
}

/**
 * Names of the areas, once for all panels.
 *
 * @param {Sensitivities} data
 * @param {number} ghosts
 */
function key(data, ghosts) {
  const entries = [
    { drawn: [svg("path", { d: "M1 14C12 14 8 3 18 3S24 14 35 14Z", class: "d-light" })], name: `light ${data.light_name ?? ""}` },
    { drawn: [svg("rect", { x: 1, y: 1, width: 34, height: 14, class: "d-nir" })], name: "near infrared" },
  ];
  return legend([], "line", ghosts, entries);
}

/**
 * One letter per curve, where it is high and far from all others, in the visible if it can.
 *
 * @param {Sensitivities} data
 * @param {Curve[]} channels
 * @param {Scale} x
 * @param {Scale} y
 */
function letters(data, channels, x, y) {
  const nm = data.wavelength_nm;
  /** @type {At[]} */
  const taken = [];
  const every = Math.max(1, Math.floor(nm.length / 40));
  return channels.map((channel, c) => {
    let best = { x: 0, y: 0, score: -Infinity };
    for (let k = every; k < nm.length - every; k += every) {
      const qe = channel.qe[k];
      if (!known(qe)) continue;
      const place = { x: x.at(nm[k]), y: Math.max(y.to + 9, y.at(qe)) };
      const hidden = nm[k] > data.infrared_from_nm ? 30 : 0;
      const score = freedom(place, channels, c, k, y, taken) - hidden;
      if (score > best.score) best = { ...place, score };
    }
    if (best.score === -Infinity) return words(x.from + 14 * (c + 1), y.to + 16, channel.name);
    const at = { x: best.x, y: best.y + 5 };
    taken.push(at);
    return words(at.x, at.y, channel.name, "d-letter", "middle");
  });
}

/**
 * @param {At} place
 * @param {Curve[]} channels
 * @param {number} own
 * @param {number} k
 * @param {Scale} y
 * @param {At[]} taken
 */
function freedom(place, channels, own, k, y, taken) {
  let apart = 24;
  channels.forEach((other, c) => {
    const qe = other.qe[k];
    if (c === own || !known(qe)) return;
    apart = Math.min(apart, Math.abs(y.at(qe) - place.y));
  });
  for (const at of taken) {
    const distance = Math.hypot(at.x - place.x, at.y - place.y);
    if (distance < 24) return -1000 + distance;
  }
  const all = channels[own].qe.map((qe) => qe ?? 0);
  return apart + (50 * all[k]) / Math.max(1e-9, ...all);
}
