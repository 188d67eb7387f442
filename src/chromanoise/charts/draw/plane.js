/**
 * Charts of panels with two axes: curves, points, ellipses, areas and rules over columns of numbers.
 * Nothing here knows which chart it draws.
 */

import { axes, fitting, linear, logarithmic, niceRange, niceStep, sensorPanels, spread, textWidth, wrapped } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { areMany, caption, channelColor, legend, mark, markPath, notes, panelName, rowsOf, sensorDashes, sensorLines, sideNames } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, html, known, line, svg, tenth, words } from "draw/svg.js";

/** @import { Area, Axis, Band, Chart, Cloud, Ellipses, Line, Options, Panel, Point, Rule } from "answers" */
/** @import { Place } from "draw/hover.js" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {{ left: number, right: number, top: number, bottom: number }} Box */
/** @typedef {{ dash: string, look: string, color: string | null, shape: number | null }} Style */
/** @typedef {{ left: number, top: number, each: number, x: Scale, y: Scale, titleY: number }} View */
/** @typedef {{ chart: Chart, styleOf: (one: Line) => Style, at: (index: number, row: number) => number | null }} Source */

const LEFT = 44;
const BOTTOM = 44;
const NAME_GAP = 17;
const LEAST_BESIDE = 560; // px of a figure with names at the ends of its curves
const MOST_WIDE = 4; // of more sensors more are side by side where there is room
const AREA = 0.94; // of the panel's height
const CIRCLE = Array.from({ length: 48 }, (_, i) => (2 * Math.PI * i) / 47).map((turn) => [Math.cos(turn), Math.sin(turn)]);

/**
 * @param {HTMLElement} element
 * @param {Chart} data
 * @param {Options<Chart>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = (options.ghosts ?? []).map(source);
  const own = source(data);
  const beside = data.named === "ends" && width >= LEAST_BESIDE;
  const { views, height, room } = layout(own, ghosts, width, beside);
  const nodes = views.flatMap((view, i) => panel(own, i, view, { ghosts, options, beside, room }));
  readable(element, data.table, () => views.flatMap((view, i) => places(own, i, view)));
  const drawn = figure(width, height, data.title, data.description, nodes);
  refill(element, caption(data), ...key(own, ghosts.length, beside), drawn, ...numbered(data), ...notes(data));
}

/**
 * A chart with the look of its curves: a color per sensor and a dash per matrix.
 *
 * @param {Chart} chart
 * @returns {Source}
 */
function source(chart) {
  const { sensors, columns, panels: [first] } = chart;
  const [many, lines] = [areMany(sensors), sensorLines(sensors)];
  const matrices = Math.max(1, ...curvesOf(first).map((one) => one.matrix + 1));
  const dashes = sensorDashes(Array.from({ length: matrices }, () => ""));
  /** @type {Source["styleOf"]} */
  const styleOf = ({ sensor, matrix, channel }) => {
    const { dash, color } = lines[sensor];
    const shape = sensors.length > 1 ? sensor : null;
    if (channel) return { dash: many ? "" : dash, look: "d-curve", color: channelColor(channel), shape: null };
    return { dash: matrix ? dashes[matrix] : dash, look: "d-curve", color, shape };
  };
  const at = (/** @type {number} */ index, /** @type {number} */ row) => {
    const value = columns[index].values[row];
    return known(value) ? value : null;
  };
  return { chart, styleOf, at };
}

/**
 * @param {Panel} of
 * @returns {Line[]}
 */
const curvesOf = ({ marks }) => marks.filter((one) => one.kind === "line");

/**
 * @param {Panel} of
 * @returns {Rule[]}
 */
const rulesOf = ({ marks }) => marks.filter((one) => one.kind === "rule");

/**
 * The panels of a chart side by side, all with the same two scales, which hold earlier answers too.
 *
 * @param {Source} own
 * @param {Source[]} ghosts
 * @param {number} width
 * @param {boolean} beside
 */
function layout({ chart }, ghosts, width, beside) {
  const [first] = chart.panels;
  const [single, wide] = [first.sensor === null, chart.panels.length > MOST_WIDE];
  const grid = sensorPanels(chart.panels.length, width, first.equal ? (wide ? 220 : 340) : wide ? 304 : 360);
  const longest = Math.max(0, ...curvesOf(first).map(({ name }) => textWidth(name)));
  const room = beside ? Math.min(longest + 40, 0.36 * width) : 20;
  const rules = rulesOf(first);
  const above = (rules.some(({ role }) => role === "now") ? 16 : 0) + (rules.some(({ role }) => role === "crossing") ? 20 : 0);
  const titleY = single ? 14 : 40;
  const across = grid.each - LEFT - room;
  const ends = (/** @type {"x" | "y"} */ name) => rangeOf([chart, ...ghosts.map((one) => one.chart)].map((one) => one.panels[0][name]));
  let [x, y] = [ends("x"), ends("y")];
  let tall = Math.round(single ? clamp(0.43 * width, 200, 360) : clamp(0.34 * grid.each, 112, 242));
  if (beside) tall = Math.max(tall, NAME_GAP * (curvesOf(first).length - 1));
  if (first.equal) ({ x, y, tall } = equalAspect(x, y, across));
  const each = titleY + (single ? 16 : 14) + above + tall + BOTTOM;
  const views = grid.places.map(({ left, row }) => {
    const top = row * (each + 12);
    const bottom = top + each - BOTTOM;
    const scales = {
      x: scale(first.x, x, left + LEFT, left + LEFT + across, first.equal),
      y: scale(first.y, y, bottom, bottom - tall, first.equal),
    };
    return { left, top, each: grid.each, titleY: top + titleY, ...scales };
  });
  return { views, room, height: grid.rows * (each + 12) - 12 };
}

/**
 * @param {number} value
 * @param {number} low
 * @param {number} high
 */
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

/**
 * The range that holds those of all answers; where an axis is not exact, to round numbers.
 *
 * @param {Axis[]} all
 */
function rangeOf(all) {
  const ends = [Math.min(...all.map(({ low }) => low)), Math.max(...all.map(({ high }) => high))];
  return all[0].exact ? ends : niceRange(ends, 5);
}

/**
 * Equal units on both axes: what is left over of the width or the height only shows more plane.
 *
 * @param {number[]} x
 * @param {number[]} y
 * @param {number} room
 */
function equalAspect(x, y, room) {
  const margin = 0.03 * Math.max(x[1] - x[0], y[1] - y[0], 1e-9);
  const spans = [x, y].map(([low, high]) => high - low + 2 * margin);
  const tallest = clamp(1.1 * room, 240, 520);
  const perUnit = Math.min(room / spans[0], tallest / spans[1]);
  const tall = Math.round(spans[1] * perUnit);
  const around = (/** @type {number[]} */ [low, high], /** @type {number} */ px) =>
    [-1, 1].map((side) => (low + high) / 2 + (side * px) / perUnit / 2);
  return { x: around(x, room), y: around(y, tall), tall };
}

/**
 * @param {Axis} axis
 * @param {number[]} ends
 * @param {number} from
 * @param {number} to
 * @param {boolean} equal
 * @returns {Scale}
 */
function scale(axis, [low, high], from, to, equal) {
  const made = (axis.logarithmic ? logarithmic : linear)(low, high, from, to);
  if (!equal) return made;
  const step = niceStep(high - low, Math.max(2, Math.abs(to - from) / 48));
  return { ...made, ticks: () => linear(low, high, 0, 1).ticks((high - low) / step) };
}

/**
 * @param {Source} own
 * @param {number} i
 * @param {View} view
 * @param {{ ghosts: Source[], options: Options<Chart>, beside: boolean, room: number }} plan
 */
function panel(own, i, view, { ghosts, options, beside, room }) {
  const { chart } = own;
  const of = chart.panels[i];
  const { x, y } = view;
  const [curves, rules] = [curvesOf(of), rulesOf(of)];
  const areas = of.marks.flatMap((one) => (one.kind === "area" ? [area(own, one, view)] : one.kind === "band" ? [band(one, view)] : one.kind === "cloud" ? [cloud(own, one, view)] : []));
  const nodes = [...areas, ...heading(own, i, view), ...axes(x, y, titles(of, view, areas.length > 0))];
  if (of.better) nodes.push(words(x.to - 4, y.from - 8, `better ${of.better}`, "d-quiet d-rim", "end"));
  const behind = ghosts.flatMap((ghost) => ghostMarks(ghost, chart.sensors[of.sensor ?? 0], of.sensor === null, view));
  const inside = of.marks.flatMap((one) => (one.kind === "ellipses" ? ellipses(own, one, view) : []));
  if (of.equal) nodes.push(cut([...behind, ...inside], view));
  else nodes.push(...behind);
  nodes.push(...drawnCurves(own, curves, view), ...level(rules, options.look, view), ...crossings(rules, view));
  if (beside) nodes.push(...endNames(own, of, view, room));
  nodes.push(...curves.flatMap((one) => ending(own, one, view)), ...labels(own, of, ghosts, view), ...letters(own, of, view));
  if (of.remark) nodes.push(words(x.to - 6, y.to + 16, of.remark, "d-rim", "end"));
  const why = wrapped(of.absence, x.to - x.from - 12);
  return [...nodes, ...why.map((text, k) => words(x.from + 8, y.to + 18 + 18 * k, text, "d-rim"))];
}

/**
 * @param {Panel} of
 * @param {View} view
 * @param {boolean} levelOnly
 */
function titles({ x, y }, { left, titleY }, levelOnly) {
  const zero = x.zero ? /** @type {const} */ ("x") : y.zero ? /** @type {const} */ ("y") : undefined;
  return { x: x.label, y: y.label, yAt: left, yTop: titleY, xRoom: x.logarithmic ? 44 : 60, levelOnly, zero };
}

/**
 * The sensor's name after its mark and, of curves of channels, a piece of its dash.
 *
 * @param {Source} own
 * @param {number} i
 * @param {View} view
 */
function heading({ chart, styleOf }, i, { left, top, each }) {
  const of = chart.panels[i];
  if (of.sensor === null) return [];
  const [one] = curvesOf(of);
  const dash = one ? styleOf(one).dash : "";
  const title = panelName(chart.sensors, of.sensor, { left, top, room: each - (dash ? 64 : 18) });
  if (!dash) return title;
  const piece = { d: `M${left + each - 52} ${top + 10}h34`, class: "d-curve d-ink-line" };
  return [...title, svg("path", { ...piece, "stroke-dasharray": dash })];
}

/**
 * The points of a curve; `null` where one has no place.
 *
 * @param {Source} own
 * @param {Line | Area | Cloud} one
 * @param {View} view
 */
function points({ at }, one, { x, y }) {
  return Array.from({ length: one.last - one.first }, (_, k) => {
    const [across, up] = [at(one.x, one.first + k), at(one.y, one.first + k)];
    return across === null || up === null || !inside(across, x) ? null : [x.at(across), y.at(up)];
  });
}

/**
 * @param {number} value
 * @param {Scale} scale
 */
function inside(value, { low, high }) {
  return value >= low - 1e-9 * Math.abs(low) && value <= high + 1e-9 * Math.abs(high);
}

/**
 * @param {Source} own
 * @param {Line[]} curves
 * @param {View} view
 */
function drawnCurves(own, curves, view) {
  const drawn = curves.map((one) => {
    const { dash, look, color } = own.styleOf(one);
    return svg("path", { d: line(points(own, one, view)), class: look, "stroke-dasharray": dash || null, stroke: color });
  });
  const dots = curves.flatMap((one) => {
    if (!one.texts.length) return [];
    const d = points(own, one, view).map((at) => (at ? markPath(0, at[0], at[1], 2.5) : ""));
    return [svg("path", { d: d.join(""), fill: own.styleOf(one).color ?? "var(--ink)" })];
  });
  const colored = curves.filter(({ channel }) => channel).map((one) => line(points(own, one, view)));
  const casing = colored.length ? [svg("path", { d: colored.join(""), class: "d-casing" })] : [];
  return [...casing, ...drawn, ...dots];
}

/**
 * What an earlier answer showed, behind: of the same sensor where each has a panel.
 *
 * @param {Source} ghost
 * @param {string} name
 * @param {boolean} all
 * @param {View} view
 */
function ghostMarks(ghost, name, all, view) {
  const { panels: before, sensors } = ghost.chart;
  const same = before.find(({ sensor }) => all || (sensor !== null && sensors[sensor] === name));
  return (same?.marks ?? []).flatMap((one) => {
    if (one.kind === "ellipses") {
      const d = rowsOf(one).map((row) => outline(ghost, one, row, view)).join("");
      return [svg("path", { d, class: "d-ghost" })];
    }
    if (one.kind !== "line") return [];
    const dash = one.channel ? "" : ghost.styleOf(one).dash;
    return [svg("path", { d: line(points(ghost, one, view)), class: "d-ghost", "stroke-dasharray": dash || null })];
  });
}

/**
 * @param {Source} own
 * @param {Area} one
 * @param {View} view
 */
function area({ at }, one, { x, y }) {
  const height = (/** @type {number} */ value) => y.from + (y.to - y.from) * value * AREA;
  const top = Array.from({ length: one.last - one.first }, (_, k) => [x.at(at(one.x, one.first + k) ?? 0), height(at(one.y, one.first + k) ?? 0)]);
  return svg("path", { d: `${line([[x.from, y.from], ...top, [x.to, y.from]])}Z`, class: "d-light" });
}

/**
 * @param {Source} own
 * @param {Cloud} one
 * @param {View} view
 */
function cloud(own, one, view) {
  const d = points(own, one, view).map((at) => (at ? markPath(0, at[0], at[1], 3) : ""));
  return svg("path", { d: d.join(""), class: "d-cloud" });
}

/**
 * @param {Band} one
 * @param {View} view
 */
function band({ low }, { x, y }) {
  const from = x.at(low);
  return svg("rect", { x: from, y: y.to, width: Math.max(0, x.to - from), height: y.from - y.to, class: "d-nir" });
}

/**
 * Few elements: a path per row, the widest undermost, and one for all crosses and errors.
 *
 * @param {Source} own
 * @param {Ellipses} one
 * @param {View} view
 */
function ellipses(own, one, view) {
  const [errors, crosses] = [[""], [""]];
  const reach = (/** @type {number} */ row) => own.at(one.reach, row) ?? 0;
  const nodes = rowsOf(one).sort((a, b) => reach(b) - reach(a)).map((row) => {
    const [truth, center] = [one.truth, one.center].map((pair) => placeOf(own, pair, row, view));
    crosses.push(`M${tenth(truth[0] - 4)} ${tenth(truth[1])}h8m-4 -4v8`);
    errors.push(line([truth, center]));
    return svg("path", { d: outline(own, one, row, view), fill: one.colors[row - one.first], class: "d-ellipse" });
  });
  nodes.push(svg("path", { d: errors.join(""), class: "d-error" }));
  nodes.push(svg("path", { d: crosses.join(""), class: "d-cross-rim" }));
  nodes.push(svg("path", { d: crosses.join(""), class: "d-cross" }));
  return nodes;
}

/**
 * @param {Source} own
 * @param {[number, number]} pair columns across and up
 * @param {number} row
 * @param {View} view
 */
function placeOf({ at }, [across, up], row, { x, y }) {
  return [x.at(at(across, row) ?? 0), y.at(at(up, row) ?? 0)];
}

/**
 * @param {Source} own
 * @param {Ellipses} one
 * @param {number} row
 * @param {View} view
 */
function outline({ at }, one, row, { x, y }) {
  const [cx, cy, ax, ay, bx, by] = [...one.center, ...one.half_axes].map((index) => at(index, row) ?? 0);
  return `${line(CIRCLE.map(([c, s]) => [x.at(cx + c * ax + s * bx), y.at(cy + c * ay + s * by)]))}Z`;
}

/**
 * What lies within the panel.
 *
 * @param {SVGElement[]} nodes
 * @param {View} view
 */
function cut(nodes, { x, y }) {
  const box = [x.from, y.to, x.to - x.from, y.from - y.to].map(tenth);
  const [left, top, width, height] = box;
  return svg("svg", { x: left, y: top, width, height, viewBox: box.join(" ") }, nodes);
}

/**
 * Names at the right of the curves, or of the large points where there are such.
 *
 * @param {Source} own
 * @param {Panel} of
 * @param {View} view
 * @param {number} room
 */
function endNames(own, of, view, room) {
  const { x, y } = view;
  const curves = curvesOf(of).filter((one) => points(own, one, view).some(Boolean));
  const entries = curves.map((one) => {
    const { color, shape } = own.styleOf(one);
    const point = of.marks.find((other) => other.kind === "point" && other.sensor === one.sensor);
    const at = point?.kind === "point" ? pointAt(own, point, view) : lastPoint(own, one, view);
    const name = shortened(own, one, room - 37);
    return { name, at, color, mark: shape, dotted: !at || at[0] < x.to - 1 };
  });
  return sideNames(entries, { right: x.to, top: y.to, bottom: y.from });
}

/**
 * A name cut where the sensor's name is long, so that what follows it can still be read.
 *
 * @param {Source} own
 * @param {Line} one
 * @param {number} room
 */
function shortened({ chart }, { name, sensor }, room) {
  const first = chart.sensors[sensor];
  const rest = name.startsWith(first) ? name.slice(first.length) : "";
  return `${fitting(rest ? first : name, Math.max(40, room - textWidth(rest)))}${rest}`;
}

/**
 * @param {Source} own
 * @param {Line} one
 * @param {View} view
 */
function lastPoint(own, one, view) {
  return points(own, one, view).findLast((point) => point) ?? null;
}

/**
 * @param {Source} own
 * @param {Point} one
 * @param {View} view
 */
function pointAt({ at }, one, { x, y }) {
  const [across, up] = [at(one.x, one.row), at(one.y, one.row)];
  return across === null || up === null ? null : [x.at(across), y.at(up)];
}

/**
 * The sensor's mark where a curve without dots ends early or, of one sensor, a short line.
 *
 * @param {Source} own
 * @param {Line} one
 * @param {View} view
 */
function ending(own, one, view) {
  const at = one.channel || one.texts.length ? null : lastPoint(own, one, view);
  if (!at || at[0] >= view.x.to - 1) return [];
  const { shape, color } = own.styleOf(one);
  if (shape !== null) return [mark(shape, at[0], at[1], color ?? "var(--ink)", 4)];
  return [svg("path", { d: `M${tenth(at[0])} ${tenth(at[1] - 6)}v12`, class: "d-curve d-ink-line" })];
}

/**
 * Rules with a number, each in a badge above the panel.
 *
 * @param {Rule[]} rules
 * @param {View} view
 */
function crossings(rules, { x, y }) {
  const all = rules.filter(({ role }) => role === "crossing");
  const shown = all.filter(({ at }) => inside(at, x));
  const badges = spread(shown.map(({ at }) => x.at(at)), 20, x.from + 9, x.to - 9);
  return shown.flatMap((rule, i) => {
    const d = `M${tenth(badges[i])} ${y.to - 8}L${tenth(x.at(rule.at))} ${y.to}V${tenth(y.from)}`;
    return [
      svg("path", { d, class: "d-thin" }),
      svg("circle", { cx: tenth(badges[i]), cy: y.to - 16, r: 9, class: "d-badge" }),
      words(badges[i], y.to - 12, String(all.indexOf(rule) + 1), "d-tick d-ink", "middle"),
    ];
  });
}

/**
 * The study's own value; `look.level_lux`, `level` in words, moves it before the answer comes.
 *
 * @param {Rule[]} rules
 * @param {Options<Chart>["look"]} look
 * @param {View} view
 */
function level(rules, look, { x, y }) {
  const rule = rules.find(({ role }) => role === "now");
  const value = look?.level_lux ?? rule?.at ?? NaN;
  if (!rule || !inside(value, x)) return [];
  const text = look?.level ? `now ${look.level}` : rule.text;
  const half = textWidth(text) / 2;
  const height = y.to - (rules.length > 1 ? 30 : 10);
  return [
    svg("path", { d: `M${tenth(x.at(value))} ${height + 4}V${tenth(y.from)}`, class: "d-level" }),
    words(clamp(x.at(value), x.from + half, x.to - half), height, text, "d-strong d-rim", "middle"),
  ];
}

/**
 * The large points with their texts, then as many texts of the curves as find room; what would touch
 * is left out.
 *
 * @param {Source} own
 * @param {Panel} of
 * @param {Source[]} ghosts
 * @param {View} view
 */
function labels(own, of, ghosts, view) {
  const { x, y } = view;
  const { sensors } = own.chart;
  const colors = sensorLines(sensors).map(({ color }) => color);
  const dotted = (/** @type {Panel} */ panel) => curvesOf(panel).filter(({ texts }) => texts.length);
  const curves = dotted(of);
  const taken = [own, ...ghosts].flatMap((one) => dotted(one.chart.panels[0]).flatMap((curve) => along(points(one, curve, view))));
  if (of.better) taken.push({ left: x.to - 70, right: x.to, top: y.from - 22, bottom: y.from });
  const large = of.marks.flatMap((one) => {
    const at = one.kind === "point" ? pointAt(own, one, view) : null;
    return one.kind === "point" && at ? [{ one, at }] : [];
  });
  taken.push(...large.map(({ at }) => ({ left: at[0] - 10, right: at[0] + 10, top: at[1] - 10, bottom: at[1] + 10 })));
  const nodes = large.map(({ one, at }) => mark(one.sensor, at[0], at[1], colors[one.sensor], 7));
  if (!areMany(sensors)) nodes.push(...large.flatMap(({ one, at }) => placed(at, one.text, "d-strong d-rim", view, taken, 13)));
  for (const one of curves) {
    /** @type {number[][]} */
    const labeled = [];
    const all = points(own, one, view).flatMap((at, k) => (at && one.texts[k] ? [{ at, text: one.texts[k] }] : []));
    for (const { at, text } of outerFirst(all)) {
      if (labeled.some((other) => Math.hypot(other[0] - at[0], other[1] - at[1]) < 24)) continue;
      labeled.push(at);
      nodes.push(...placed(at, text, "d-tick d-rim", view, taken));
    }
  }
  return nodes;
}

/**
 * Small boxes along a curve, so that no label stands on it.
 *
 * @param {(number[] | null)[]} all
 */
function along(all) {
  const drawn = all.filter((at) => at !== null);
  /** @type {Box[]} */
  const boxes = [];
  drawn.forEach(([ax, ay], k) => {
    const [bx, by] = drawn[k + 1] ?? [ax, ay];
    const parts = Math.max(1, Math.ceil(Math.hypot(bx - ax, by - ay) / 8));
    for (let j = 0; j < parts; j += 1) {
      const [px, py] = [ax + ((bx - ax) * j) / parts, ay + ((by - ay) * j) / parts];
      boxes.push({ left: px - 2, right: px + 2, top: py - 2, bottom: py + 2 });
    }
  });
  return boxes;
}

/**
 * The ends of the curve matter most, so they are placed before what lies between.
 *
 * @template T
 * @param {T[]} all
 */
function outerFirst(all) {
  if (all.length < 3) return all;
  return [all[0], all[all.length - 1], ...all.slice(1, -1)];
}

/**
 * @param {number[]} at
 * @param {string} text
 * @param {string} look
 * @param {View} view
 * @param {Box[]} taken
 * @param {number} [gap]
 */
function placed([px, py], text, look, { x, y, titleY }, taken, gap = 9) {
  const wide = textWidth(text, 15) + 2;
  const [left, low] = [-gap - wide, gap + 10];
  const beside = /** @param {number} dy */ (dy) => [[gap, dy], [left, dy]];
  const middle = [-gap - 3, low + 3].map((dy) => [-wide / 2, dy]);
  const corners = [...[4, -6, 16].flatMap(beside), ...middle, ...[-gap, low].flatMap(beside)];
  for (const [dx, dy] of corners) {
    const box = { left: px + dx, right: px + dx + wide, top: py + dy - 11, bottom: py + dy + 3 };
    if (box.left < x.from || box.right > x.to + 18 || box.bottom > y.from || box.top < titleY + 4) continue;
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

/**
 * The letter of each channel, where its curve is high and far from all others, before a band if it
 * can.
 *
 * @param {Source} own
 * @param {Panel} of
 * @param {View} view
 */
function letters(own, of, view) {
  const { x, y } = view;
  const channels = curvesOf(of).filter(({ channel }) => channel);
  const shaded = of.marks.find((one) => one.kind === "band");
  const end = shaded?.kind === "band" ? x.at(shaded.low) : x.to;
  const all = channels.map((one) => points(own, one, view));
  /** @type {number[][]} */
  const taken = [];
  return channels.map(({ channel }, c) => {
    const rows = all[c].length;
    const every = Math.max(1, Math.floor(rows / 40));
    const highest = Math.min(...all[c].map((at) => at?.[1] ?? Infinity));
    let best = { at: [x.from + 14 * (c + 1), y.to + 11], score: -Infinity };
    for (let k = every; k < rows - every; k += every) {
      const at = all[c][k];
      if (!at) continue;
      const place = [at[0], Math.max(y.to + 9, at[1])];
      const others = all.filter((_, other) => other !== c).map((points) => points[k]);
      const high = (y.from - at[1]) / Math.max(1e-9, y.from - highest);
      const score = freedom(place, others, taken) + 50 * high - (at[0] > end ? 30 : 0);
      if (score > best.score) best = { at: place, score };
    }
    taken.push(best.at);
    return words(best.at[0], best.at[1] + 5, channel, "d-letter", "middle");
  });
}

/**
 * How far a place is from the other curves there; much less near a letter.
 *
 * @param {number[]} place
 * @param {(number[] | null)[]} others
 * @param {number[][]} taken
 */
function freedom(place, others, taken) {
  const letter = Math.min(...taken.map((at) => Math.hypot(at[0] - place[0], at[1] - place[1])));
  if (letter < 24) return -1000 + letter;
  return Math.min(24, ...others.map((at) => (at ? Math.abs(at[1] - place[1]) : Infinity)));
}

/**
 * Where each value of the table stands.
 *
 * @param {Source} own
 * @param {number} i
 * @param {View} view
 * @returns {Place[]}
 */
function places(own, i, view) {
  const { columns, whole_rows: whole, panels: all } = own.chart;
  const shown = columns.map((one, index) => ({ one, index })).filter(({ one }) => one.shown !== null);
  const cell = (/** @type {number} */ index) => shown.findIndex((one) => one.index === index);
  return all[i].marks.flatMap((one) => {
    if (one.kind === "point") {
      const at = pointAt(own, one, view);
      return at ? [{ x: at[0], y: at[1], row: one.row, series: one.sensor }] : [];
    }
    if (one.kind === "cloud")
      return points(own, one, view).flatMap((at, k) => (at ? [{ x: at[0], y: at[1], row: one.first + k, series: -1 }] : []));
    if (one.kind === "line")
      return points(own, one, view).flatMap((at, k) => {
        if (!at) return [];
        const read = whole ? { series: one.sensor } : { cells: [cell(one.x), cell(one.y)], series: one.y };
        return [{ x: at[0], y: at[1], row: one.first + k, ...read }];
      });
    if (one.kind !== "ellipses") return [];
    return rowsOf(one).flatMap((row) => {
      const [x, y] = placeOf(own, one.center, row, view);
      const seen = x >= view.x.from && x <= view.x.to && y <= view.y.from && y >= view.y.to;
      return seen ? [{ x, y, row, series: i }] : [];
    });
  });
}

/**
 * The names of areas and bands and, where they stand nowhere else, of curves.
 *
 * @param {Source} own
 * @param {number} ghosts
 * @param {boolean} beside
 */
function key({ chart, styleOf }, ghosts, beside) {
  const [first] = chart.panels;
  const entries = first.marks.flatMap((one) => {
    if (one.kind === "area") return [{ drawn: [svg("path", { d: "M1 14C12 14 8 3 18 3S24 14 35 14Z", class: "d-light" })], name: one.name }];
    if (one.kind === "band") return [{ drawn: [svg("rect", { x: 1, y: 1, width: 34, height: 14, class: "d-nir" })], name: one.name }];
    if (one.kind === "cloud") return [{ drawn: [svg("path", { d: markPath(0, 18, 8, 3), class: "d-cloud" })], name: one.name }];
    if (one.kind !== "line" || first.sensor !== null || beside) return [];
    const { look, dash, color, shape } = styleOf(one);
    const drawn = [svg("path", { d: "M1 8H35", class: look, "stroke-dasharray": dash || null, stroke: color })];
    if (shape !== null) drawn.push(mark(shape, 18, 8, color ?? "var(--ink)", 4));
    return [{ drawn, name: one.name }];
  });
  return entries.length || ghosts ? [legend(entries, ghosts)] : [];
}

/** @param {Chart} data */
function numbered({ numbered: sentences }) {
  const items = sentences.map((sentence) => html("li", {}, sentence));
  return items.length ? [html("ol", { class: "d-list" }, items)] : [];
}
