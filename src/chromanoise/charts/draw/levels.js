/** SNR against the level of the light: curves, their crossovers, and where the study stands. */

import { axes, fitting, linear, logarithmic, niceRange, spread, textWidth } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { areMany, caption, legend, mark, note, pinnedLegend, sensorDashes, sensorLines, sideNames } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, html, known, line, svg, tenth, words } from "draw/svg.js";

/** @import { Crossover, LevelCurve, Levels, Maybe, Options } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {LevelCurve & { dash: string, look: string, color: string | null, shape: number | null }} Styled */
/** @typedef {ReturnType<typeof plane>} Plane */

const STROKES = ["d-curve d-ink-line", "d-curve d-quiet-line", "d-curve d-third-line"];
const GAP = 17;

/**
 * @param {HTMLElement} element
 * @param {Levels} data
 * @param {Options<Levels>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = options.ghosts ?? [];
  const curves = styled(data);
  const beside = width >= 560;
  const longest = Math.max(...curves.map((curve) => textWidth(curve.name)));
  const room = beside ? Math.min(longest + 38, 0.36 * width) : 20;
  const scales = plane(data, ghosts, width, room);
  const nodes = axes(scales.x, scales.y, {
    x: "illuminance [lx]",
    y: `${data.quantity} [${data.unit}]`,
    yTop: 14,
    xRoom: 44,
    zero: "y",
  });
  for (const ghost of ghosts) nodes.push(...ghostCurves(ghost, scales));
  for (const curve of curves) nodes.push(drawn(curve, data.lux, scales, curve.look));
  nodes.push(...level(data, options.look, scales), ...crossovers(data, scales));
  if (beside) nodes.push(...endNames(curves, data.lux, scales, room));
  else nodes.push(...curves.flatMap((curve) => ends(curve, data.lux, scales)));
  const told = figure(width, scales.height, data.title, data.description, nodes);
  const key = beside ? pinnedLegend(ghosts) : [narrowLegend(curves, ghosts)];
  readable(element, data.table, () => places(data, scales));
  refill(element, caption(data), ...key, told, ...sentences(data));
}

/**
 * Each curve with its line: a dash per sensor and a stroke per matrix; of many sensors, a color per
 * sensor and a dash per matrix.
 *
 * @param {Levels} data
 * @returns {Styled[]}
 */
function styled(data) {
  const keys = distinct(data.curves);
  const sensors = [...new Set(keys)];
  const matrices = [...new Set(data.curves.map((curve) => curve.matrix))];
  const many = areMany(sensors);
  const lines = sensorLines(sensors.map((key) => key.split("\n")[0]));
  const dashes = sensorDashes(matrices);
  return data.curves.map((curve, i) => {
    const line = lines[sensors.indexOf(keys[i])];
    const m = matrices.indexOf(curve.matrix);
    const shape = sensors.length > 1 ? sensors.indexOf(keys[i]) : null;
    if (!many) return { ...curve, dash: line.dash, look: STROKES[m % STROKES.length], color: null, shape };
    return { ...curve, dash: m ? dashes[m] : line.dash, look: "d-curve", color: line.color, shape };
  });
}

/**
 * A key per sensor, also where two sensors carry one name.
 *
 * @param {LevelCurve[]} curves
 */
function distinct(curves) {
  const seen = new Map();
  return curves.map((curve) => {
    const pair = `${curve.sensor}\n${curve.matrix}`;
    const count = seen.get(pair) ?? 0;
    seen.set(pair, count + 1);
    return count ? `${curve.sensor}\n${count}` : curve.sensor;
  });
}

/**
 * @param {Levels} data
 * @param {Levels[]} ghosts
 * @param {number} width
 * @param {number} room
 */
function plane(data, ghosts, width, room) {
  const top = found(data).length ? 66 : 46;
  const names = GAP * (data.curves.length - 1);
  const tall = Math.round(Math.max(names, Math.min(360, Math.max(200, 0.42 * width))));
  const all = [data, ...ghosts].flatMap((answer) => answer.curves.flatMap((curve) => curve.values));
  const [low, high] = niceRange(all, 5);
  const x = logarithmic(data.lux[0], data.lux[data.lux.length - 1], 44, width - room);
  return { x, y: linear(low, high, top + tall, top), height: top + tall + 44, top };
}

/**
 * @param {Maybe[]} values
 * @param {number[]} lux
 * @param {Plane} plane
 */
function points(values, lux, { x, y }) {
  return values.map((value, k) => (known(value) && inside(lux[k], x) ? [x.at(lux[k]), y.at(value)] : null));
}

/**
 * Where each value of the table stands.
 *
 * @param {Levels} data
 * @param {Plane} plane
 */
function places({ curves, lux }, plane) {
  return curves.flatMap((curve, i) =>
    points(curve.values, lux, plane).flatMap((at, k) =>
      at ? [{ x: at[0], y: at[1], row: k, cells: [0, i + 1], series: i }] : [],
    ),
  );
}

/**
 * @param {number} value
 * @param {Scale} scale
 */
function inside(value, scale) {
  return value >= scale.low * (1 - 1e-9) && value <= scale.high * (1 + 1e-9);
}

/**
 * @param {Styled} curve
 * @param {number[]} lux
 * @param {Plane} scales
 * @param {string} look
 */
function drawn(curve, lux, scales, look) {
  const d = line(points(curve.values, lux, scales));
  const stroke = look === curve.look ? curve.color : null;
  return svg("path", { d, class: look, "stroke-dasharray": curve.dash || null, stroke });
}

/**
 * @param {Levels} ghost
 * @param {Plane} scales
 */
function ghostCurves(ghost, scales) {
  return styled(ghost).map((curve) => drawn(curve, ghost.lux, scales, "d-ghost"));
}

/**
 * Names at the right of the curves' ends; a curve that ends early has saturated there.
 *
 * @param {Styled[]} all
 * @param {number[]} lux
 * @param {Plane} scales
 * @param {number} room
 */
function endNames(all, lux, scales, room) {
  const curves = all.filter((curve) => curve.values.some(known));
  const { x, y } = scales;
  const entries = curves.map((curve) => {
    const at = lastPoint(curve, lux, scales);
    const name = shortened(curve, room - 37);
    return { name, at, color: curve.color, mark: curve.shape, dotted: !at || at[0] < x.to - 1 };
  });
  const named = sideNames(entries, { right: x.to, top: y.to, bottom: y.from });
  return [...named, ...curves.flatMap((curve) => ends(curve, lux, scales))];
}

/**
 * @param {Styled} curve
 * @param {number[]} lux
 * @param {Plane} scales
 */
function lastPoint(curve, lux, scales) {
  return points(curve.values, lux, scales).findLast((point) => point) ?? null;
}

/**
 * The sensor's mark where its curve saturates or, of one sensor, a short line.
 *
 * @param {Styled} curve
 * @param {number[]} lux
 * @param {Plane} scales
 */
function ends(curve, lux, scales) {
  const at = lastPoint(curve, lux, scales);
  if (!at || at[0] >= scales.x.to - 1) return [];
  if (curve.shape !== null) return [mark(curve.shape, at[0], at[1], curve.color ?? "var(--ink)", 4)];
  return [svg("path", { d: `M${tenth(at[0])} ${tenth(at[1] - 6)}v12`, class: "d-curve d-ink-line" })];
}

/**
 * A name cut where the sensor's name is long, so that its matrix is still told.
 *
 * @param {Styled} curve
 * @param {number} room
 */
function shortened(curve, room) {
  const matrix = curve.name.slice(curve.sensor.length);
  return `${fitting(curve.sensor, Math.max(40, room - textWidth(matrix)))}${matrix}`;
}

/**
 * @param {Styled[]} curves
 * @param {Levels[]} ghosts
 */
function narrowLegend(curves, ghosts) {
  const more = curves.map(({ name, look, dash, color, shape }) => ({
    name,
    drawn: [
      svg("path", { d: "M1 8H35", class: look, "stroke-dasharray": dash || null, stroke: color }),
      ...(shape === null ? [] : [mark(shape, 18, 8, color ?? "var(--ink)", 4)]),
    ],
  }));
  return legend([], "line", ghosts.length, more);
}

/**
 * @param {Levels} data
 * @param {Plane} plane
 */
function crossovers(data, { x, y, top }) {
  const all = found(data);
  const shown = all.filter((cross) => inside(cross.lux, x));
  const places = spread(shown.map((cross) => x.at(cross.lux)), 20, x.from + 9, x.to - 9);
  return shown.flatMap((cross, i) => {
    const at = tenth(x.at(cross.lux));
    const d = `M${tenth(places[i])} ${top - 8}L${at} ${top}V${tenth(y.from)}`;
    const number = String(all.indexOf(cross) + 1);
    return [
      svg("path", { d, class: "d-thin" }),
      svg("circle", { cx: tenth(places[i]), cy: top - 16, r: 9, class: "d-badge" }),
      words(places[i], top - 12, number, "d-tick d-ink", "middle"),
    ];
  });
}

/**
 * The study's own level; `look.level_lux`, `level` in words, moves the line before the answer comes.
 *
 * @param {Levels} data
 * @param {Options<Levels>["look"]} look
 * @param {Plane} plane
 */
function level(data, look, { x, y, top }) {
  const lux = look?.level_lux ?? data.now_lux;
  if (!known(lux) || !inside(lux, x)) return [];
  const at = x.at(lux);
  const told = `now ${look?.level ?? data.now}`;
  const half = textWidth(told) / 2;
  const place = Math.min(x.to - half, Math.max(x.from + half, at));
  const height = top - (found(data).length ? 30 : 10);
  return [
    svg("path", { d: `M${tenth(at)} ${height + 4}V${tenth(y.from)}`, class: "d-level" }),
    words(place, height, told, "d-strong d-rim", "middle"),
  ];
}

/**
 * @param {Crossover} cross
 * @returns {cross is Crossover & { lux: number }}
 */
function isPlaced(cross) {
  return known(cross.lux);
}

/**
 * The crossovers that have a place on the axis, in its order.
 *
 * @param {Levels} data
 */
function found(data) {
  const placed = data.crossovers.filter(isPlaced);
  return placed.sort((a, b) => a.lux - b.lux);
}

/** @param {Levels} data */
function sentences(data) {
  const items = found(data).map((cross) => html("li", {}, cross.sentence));
  const more = data.crossovers.filter((cross) => !known(cross.lux)).map((cross) => note(cross.sentence));
  more.push(...data.notes.map((sentence) => note(sentence)));
  return items.length ? [html("ol", { class: "d-list" }, items), ...more] : more;
}
