/** Scales, ticks, axes and the placing of labels; nothing here knows what it shows. */

import { line, svg, tenth, words } from "draw/svg.js";

/** @typedef {{ value: number, label: string }} Tick */
/**
 * @typedef {object} Scale
 * @property {number} low
 * @property {number} high
 * @property {number} from pixel of `low`
 * @property {number} to pixel of `high`
 * @property {(value: number) => number} at
 * @property {(room: number) => Tick[]} ticks
 */
/**
 * @typedef {object} Titles
 * @property {string} [x]
 * @property {string} [y]
 * @property {number} [xRoom]
 * @property {number} [yRoom]
 * @property {number} [yAt]
 * @property {number} [yTop]
 * @property {boolean} [levelOnly]
 * @property {"x" | "y"} [zero] the axis whose zero is marked
 */
/** @typedef {{ members: number[], start: number }} Cluster */
/** @typedef {ReturnType<typeof panels>} Grid */

/**
 * A linear scale from values `low .. high` to pixels `from .. to`.
 *
 * @param {number} low
 * @param {number} high
 * @param {number} from
 * @param {number} to
 * @returns {Scale}
 */
export function linear(low, high, from, to) {
  const slope = (to - from) / (high - low || 1);
  /** @param {number} value */
  const at = (value) => from + (value - low) * slope;
  return { low, high, from, to, at, ticks: (room) => linearTicks(low, high, room) };
}

/**
 * A logarithmic scale; both ends must be positive.
 *
 * @param {number} low
 * @param {number} high
 * @param {number} from
 * @param {number} to
 * @returns {Scale}
 */
export function logarithmic(low, high, from, to) {
  const first = Math.log10(low);
  const slope = (to - from) / (Math.log10(high) - first || 1);
  /** @param {number} value */
  const at = (value) => from + (Math.log10(value) - first) * slope;
  return { low, high, from, to, at, ticks: (room) => logTicks(low, high, room) };
}

/**
 * The smallest of 1, 2, 2.5, 5 times a power of ten that parts the span into at most `count`.
 *
 * @param {number} span
 * @param {number} count
 */
export function niceStep(span, count) {
  const raw = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(raw));
  const factor = [1, 2, 2.5, 5, 10].find((step) => step * power >= raw * (1 - 1e-9)) ?? 10;
  return factor * power;
}

/**
 * Ends that are whole steps and hold all values; [0, 1] where there is none.
 *
 * @param {(number | null | undefined)[]} values
 * @param {number} [count]
 * @param {number[]} [always]
 * @returns {number[]}
 */
export function niceRange(values, count = 5, always = []) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of [...values, ...always]) {
    if (value === null || value === undefined || !Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  if (low === high) return low === 0 ? [0, 1] : [low - 1, high + 1];
  const step = niceStep(high - low, count);
  return [Math.floor(low / step + 1e-9) * step, Math.ceil(high / step - 1e-9) * step];
}

/**
 * @param {number} low
 * @param {number} high
 * @param {number} room
 */
function linearTicks(low, high, room) {
  const step = niceStep(high - low, room);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9) + (isQuarter(step) ? 1 : 0));
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + step * 1e-9; i += 1) {
    const value = i * step;
    ticks.push({ value, label: linearLabel(value, digits, Math.max(Math.abs(low), Math.abs(high))) });
  }
  return ticks;
}

/**
 * In thousands or millions where the ends of the scale have many digits.
 *
 * @param {number} value
 * @param {number} digits
 * @param {number} largest
 */
function linearLabel(value, digits, largest) {
  const power = largest >= 1e15 ? null : largest >= 1e7 ? 6 : largest >= 1e4 ? 3 : 0;
  if (power === null) return value.toExponential(0).replace("-", "\u2212");
  const text = power ? String(Number((value / 10 ** power).toFixed(2))) : value.toFixed(digits);
  if (Number(text) === 0) return "0";
  return text.replace("-", "\u2212") + { 0: "", 3: "k", 6: "M" }[power];
}

/** @param {number} step */
function isQuarter(step) {
  return Math.abs(step / 10 ** Math.floor(Math.log10(step) + 1e-9) - 2.5) < 1e-6;
}

/**
 * @param {number} low
 * @param {number} high
 * @param {number} room
 */
function logTicks(low, high, room) {
  const decades = Math.log10(high / low);
  const between = decades * 3 <= room ? [1, 2, 5] : [1];
  const stride = Math.max(1, Math.ceil(decades / Math.max(1, room)));
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power += 1) {
    for (const factor of between) {
      const value = factor * 10 ** power;
      if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
      if (power % stride === 0) ticks.push({ value, label: logLabel(value, power) });
    }
  }
  return ticks;
}

/**
 * @param {number} value
 * @param {number} power
 */
function logLabel(value, power) {
  if (power >= 4) return `${Math.round(value / 1000)}k`;
  return power < 0 ? value.toFixed(-power) : String(Math.round(value));
}

/**
 * Grid, tick labels and titles with units; the y title stands above its axis, not turned. With
 * `levelOnly` the x axis has short ticks instead of a grid.
 *
 * @param {Scale} x
 * @param {Scale} y
 * @param {Titles} titles
 */
export function axes(x, y, titles) {
  const across = x.ticks(Math.max(2, Math.floor(Math.abs(x.to - x.from) / (titles.xRoom ?? 56))));
  const up = y.ticks(Math.max(2, Math.floor(Math.abs(y.to - y.from) / (titles.yRoom ?? 44))));
  const bottom = Math.max(y.from, y.to);
  const top = Math.min(y.from, y.to);
  const down = titles.levelOnly ? bottom + 5 : top;
  const grid =
    across.map((tick) => `M${tenth(x.at(tick.value))} ${tenth(bottom)}V${tenth(down)}`).join("") +
    up.map((tick) => `M${tenth(x.from)} ${tenth(y.at(tick.value))}H${tenth(x.to)}`).join("");
  const nodes = [svg("path", { d: grid, class: "d-grid" })];
  if (titles.zero === "x") nodes.push(...zeroLine(x, top, bottom));
  if (titles.zero === "y" && y.low < 0 && y.high >= 0)
    nodes.push(svg("path", { d: `M${tenth(x.from)} ${tenth(y.at(0))}H${tenth(x.to)}`, class: "d-zero" }));
  nodes.push(
    svg("path", { d: line([[x.from, bottom], [x.to, bottom]]), class: "d-axis" }),
  );
  nodes.push(...across.map((t) => words(x.at(t.value), bottom + 17, t.label, "d-tick", "middle")));
  nodes.push(...up.map((t) => words(x.from - 6, y.at(t.value) + 4, t.label, "d-tick", "end")));
  if (titles.y) nodes.push(words(titles.yAt ?? 0, titles.yTop ?? top - 10, titles.y, "d-quiet"));
  if (titles.x) nodes.push(words((x.from + x.to) / 2, bottom + 35, titles.x, "d-quiet", "middle"));
  return nodes;
}

/**
 * The upright line of 0 on a scale that has negative values.
 *
 * @param {Scale} x
 * @param {number} top
 * @param {number} bottom
 */
export function zeroLine(x, top, bottom) {
  if (!(x.low < 0 && x.high >= 0)) return [];
  return [svg("path", { d: `M${tenth(x.at(0))} ${tenth(top)}V${tenth(bottom)}`, class: "d-zero" })];
}

/**
 * Places near the wanted ones, at least `gap` apart and within the ends, in the order given.
 *
 * @param {number[]} wanted
 * @param {number} gap
 * @param {number} low
 * @param {number} high
 */
export function spread(wanted, gap, low, high) {
  const order = wanted.map((_, i) => i).sort((a, b) => wanted[a] - wanted[b]);
  const step = Math.min(gap, (high - low) / Math.max(1, wanted.length - 1));
  const places = new Array(wanted.length);
  const groups = [];
  for (const i of order) {
    groups.push({ members: [i], start: wanted[i] });
    while (groups.length > 1 && touching(groups, step)) merge(groups, step, wanted);
  }
  for (const group of groups) {
    group.members.forEach((i, k) => (places[i] = group.start + k * step));
  }
  return within(places, order, step, low, high);
}

/**
 * @param {Cluster[]} groups
 * @param {number} step
 */
function touching(groups, step) {
  const [before, after] = groups.slice(-2);
  return before.start + before.members.length * step > after.start;
}

/**
 * @param {Cluster[]} groups
 * @param {number} step
 * @param {number[]} wanted
 */
function merge(groups, step, wanted) {
  const after = /** @type {Cluster} */ (groups.pop());
  const before = groups[groups.length - 1];
  before.members.push(...after.members);
  const pulls = before.members.map((i, k) => wanted[i] - k * step);
  before.start = pulls.reduce((sum, pull) => sum + pull, 0) / pulls.length;
}

/**
 * @param {number[]} places
 * @param {number[]} order
 * @param {number} step
 * @param {number} low
 * @param {number} high
 */
function within(places, order, step, low, high) {
  let least = low;
  for (const i of order) {
    places[i] = Math.max(places[i], least);
    least = places[i] + step;
  }
  let most = high;
  for (const i of [...order].reverse()) {
    places[i] = Math.min(places[i], most);
    most = places[i] - step;
  }
  return places;
}

/** @type {Map<string, number>} */
const advances = new Map();
/** @type {CanvasRenderingContext2D | null} */
let pen = null;

/**
 * The width of a letter at a size of 1, measured once in the font of the document.
 *
 * @param {string} letter
 */
function advance(letter) {
  const known = advances.get(letter);
  if (known !== undefined) return known;
  if (!pen) {
    pen = /** @type {CanvasRenderingContext2D} */ (document.createElement("canvas").getContext("2d"));
    pen.font = `100px ${getComputedStyle(document.body).fontFamily}`;
  }
  const wide = pen.measureText(letter).width / 100;
  advances.set(letter, wide);
  return wide;
}

/**
 * How wide a text is, without a read of the layout; bold text is about a tenth wider.
 *
 * @param {string} text
 * @param {number} [size]
 */
export function textWidth(text, size = 13) {
  let wide = 0;
  for (const letter of text) wide += advance(letter);
  return wide * size;
}

/**
 * The text, cut with an ellipsis where it is wider than the room.
 *
 * @param {string} text
 * @param {number} room
 * @param {number} [size]
 */
export function fitting(text, room, size = 13) {
  if (textWidth(text, size) <= room) return text;
  let wide = textWidth("…", size);
  let kept = "";
  for (const letter of text) {
    wide += advance(letter) * size;
    if (wide > room && kept) break;
    kept += letter;
  }
  return `${kept}…`;
}

/**
 * The text in lines of at most this width, parted at spaces.
 *
 * @param {string} text
 * @param {number} room
 * @param {number} [size]
 */
export function wrapped(text, room, size = 13) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const longer = lines[lines.length - 1] ? `${lines[lines.length - 1]} ${word}` : word;
    if (textWidth(longer, size) <= room || !lines[lines.length - 1]) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

const MOST_BESIDE = 3;
const LEAST_BESIDE = 264; // px of a panel that can be read

/**
 * How panels of a sensor each share a width: up to three are side by side, of more as many as have
 * the least width.
 *
 * @param {number} count
 * @param {number} width
 * @param {number} least
 */
export function sensorPanels(count, width, least) {
  return panels(count, width, count > MOST_BESIDE ? least : LEAST_BESIDE);
}

/**
 * How small multiples share a width: columns, each panel's width, and where each begins.
 *
 * @param {number} count
 * @param {number} width
 * @param {number} least
 * @param {number} [gap]
 */
export function panels(count, width, least, gap = 24) {
  const columns = Math.max(1, Math.min(count, Math.floor((width + gap) / (least + gap))));
  const each = Math.floor((width - gap * (columns - 1)) / columns);
  const places = Array.from({ length: count }, (_, i) => ({
    left: (i % columns) * (each + gap),
    row: Math.floor(i / columns),
  }));
  return { columns, each, places, rows: Math.ceil(count / columns) };
}
