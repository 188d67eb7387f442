/** One look for all figures: colors of channels, a dash and a mark per sensor, legends. */

import { fitting, spread } from "draw/axes.js";
import { html, line, svg, tenth, words } from "draw/svg.js";

/** @typedef {{ drawn: Node[], name: string, width?: number }} Entry */
/** @typedef {{ dash: string, color: string }} Line */

/** @type {Record<string, string>} */
const OWN_DASH = {
  "onyx-rgbw": "",
  "onyx-rgb-ircut": "9 3",
  "onyx-rgb": "3 2",
  "onyx-rgbw-ircut": "9 3 2 3",
};
const DASHES = ["", "9 3", "3 2", "9 3 2 3", "16 3", "1.5 4", "16 3 3 3 3 3", "6 6"];

/**
 * The color of a channel by its name; ink for one that the palette does not know.
 *
 * @param {string} name
 * @returns {string}
 */
export function channelColor(name) {
  return `var(--channel-${CSS.escape(name)}, var(--ink))`;
}

/**
 * A dash pattern per sensor: its own where it has one, and never the same for two.
 *
 * @param {string[]} names
 */
export function sensorDashes(names) {
  const taken = new Set();
  const own = names.map((name) => {
    const dash = OWN_DASH[name];
    if (dash === undefined || taken.has(dash)) return null;
    taken.add(dash);
    return dash;
  });
  return own.map((dash) => {
    if (dash !== null) return dash;
    const free = DASHES.find((pattern) => !taken.has(pattern)) ?? DASHES[0];
    taken.add(free);
    return free;
  });
}

const MOST_DASHED = 3;
const COLORS = 10;

/**
 * The line of each sensor: a color each; from the eleventh on, a color again, dashed.
 *
 * @param {string[]} names
 * @returns {Line[]}
 */
export function sensorLines(names) {
  return names.map((_, i) => ({
    dash: DASHES[Math.floor(i / COLORS) % DASHES.length],
    color: `var(--sensor-${i % COLORS})`,
  }));
}

/**
 * Whether sensors are named at their curves and not in a legend.
 *
 * @param {string[]} names
 */
export function areMany(names) {
  return names.length > MOST_DASHED;
}

/**
 * The outline of a sensor's mark: disc, square, diamond, triangle up and down, cross, in turn.
 *
 * @param {number} i
 * @param {number} x
 * @param {number} y
 * @param {number} [r]
 */
export function markPath(i, x, y, r = 5) {
  const [cx, cy] = [tenth(x), tenth(y)];
  const s = r * 0.9;
  const t = r * 1.25;
  if (i % 6 === 0) return `M${cx - r} ${cy}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;
  if (i % 6 === 1) return `M${cx - s} ${cy - s}h${2 * s}v${2 * s}h${-2 * s}Z`;
  if (i % 6 === 2) return `M${cx} ${cy - t}l${t} ${t}l${-t} ${t}l${-t} ${-t}Z`;
  if (i % 6 === 3) return `M${cx} ${cy - t}l${t} ${2 * t - 1}h${-2 * t}Z`;
  if (i % 6 === 4) return `M${cx} ${cy + t}l${t} ${1 - 2 * t}h${-2 * t}Z`;
  const a = r * 0.4; // half an arm of the cross
  return `M${cx - a} ${cy - r}h${2 * a}v${r - a}h${r - a}v${2 * a}h${a - r}v${r - a}h${-2 * a}v${a - r}h${a - r}v${-2 * a}h${r - a}Z`;
}

/**
 * Whether a sensor's mark is full.
 *
 * @param {number} i
 */
export function isFull(i) {
  return i % 2 === Math.floor(i / 6) % 2;
}

/**
 * A sensor's mark in a color: full for the first, third ..., hollow for those between; 12 differ.
 *
 * @param {number} i
 * @param {number} x
 * @param {number} y
 * @param {string} [color]
 * @param {number} [r]
 */
export function mark(i, x, y, color = "var(--ink)", r = 5) {
  const fill = isFull(i) ? color : "var(--paper)";
  return svg("path", { d: markPath(i, x, y, r), fill, stroke: color, "stroke-width": 2 });
}

/**
 * The name of a sensor over its panel, after its mark where there are several.
 *
 * @param {string[]} names
 * @param {number} i
 * @param {{ left: number, top: number, room: number }} at
 */
export function panelName(names, i, { left, top, room }) {
  if (names.length < 2) return [words(left, top + 15, fitting(names[i], room, 15), "d-strong")];
  return [
    mark(i, left + 7, top + 10, sensorLines(names)[i].color),
    words(left + 20, top + 15, fitting(names[i], room - 20, 15), "d-strong"),
  ];
}

/**
 * The same in HTML.
 *
 * @param {string[]} names
 * @param {number} i
 */
export function panelHeading(names, i) {
  const text = html("span", {}, names[i]);
  if (names.length < 2) return html("p", { class: "d-name" }, [text]);
  const size = { class: "d-swatch", width: 16, height: 16, viewBox: "0 0 16 16" };
  const drawn = mark(i, 7, 8, sensorLines(names)[i].color);
  return html("p", { class: "d-name" }, [svg("svg", { ...size, "aria-hidden": "true" }, [drawn]), text]);
}

const NAME_GAP = 17;

/**
 * Names at the right of points, each after its mark, with a line from its point; they keep apart.
 *
 * @param {{ name: string, at: number[] | null, color: string | null, mark: number | null, dotted: boolean }[]} entries
 * @param {{ right: number, top: number, bottom: number }} box
 */
export function sideNames(entries, { right, top, bottom }) {
  const wanted = entries.map(({ at }) => (at ? at[1] : bottom));
  const places = spread(wanted, NAME_GAP, top, bottom);
  return entries.flatMap(({ name, at, color, mark: shape, dotted }, i) => {
    const nodes = [];
    if (at) {
      const d = line([at, [right + 6, places[i]], [right + 20, places[i]]]);
      const colored = { fill: "none", stroke: color, "stroke-dasharray": dotted ? "2 3" : null };
      nodes.push(svg("path", { d, ...(color ? colored : { class: dotted ? "d-now" : "d-thin" }) }));
    }
    if (shape !== null) nodes.push(mark(shape, right + 25, places[i], color ?? "var(--ink)", 4));
    nodes.push(words(right + (shape === null ? 24 : 35), places[i] + 4, name));
    return nodes;
  });
}

/**
 * The same mark of an earlier answer, behind.
 *
 * @param {number} i
 * @param {number} x
 * @param {number} y
 * @param {number} [r]
 */
export function ghostMark(i, x, y, r = 5) {
  return svg("path", { d: markPath(i, x, y, r), class: "d-ghost-mark" });
}

/**
 * Names with what stands for them, in HTML so that they wrap at any width.
 *
 * @param {Entry[]} entries
 * @param {number} [ghosts] number of pinned answers, which have an entry
 * @param {Node} [ghost] what stands for them; a line where there is none
 */
export function legend(entries, ghosts = 0, ghost = undefined) {
  /** @type {Entry} */
  const pinned = { drawn: [ghost ?? svg("path", { d: "M1 8H35", class: "d-curve d-ghost" })], name: "pinned" };
  const all = ghosts ? [...entries, pinned] : entries;
  return html("p", { class: "d-legend" }, all.map(({ drawn, name, width }) => item(drawn, name, width)));
}

/**
 * @param {Node[]} drawn
 * @param {string} name
 * @param {number} [width]
 */
function item(drawn, name, width = 36) {
  const hidden = { class: "d-swatch", width, height: 16, viewBox: `0 0 ${width} 16` };
  const swatch = svg("svg", { ...hidden, "aria-hidden": "true", focusable: "false" }, drawn);
  return html("span", { class: "d-item" }, [swatch, html("span", {}, name)]);
}

/**
 * The title of a chart, which names the operating point, over its figure.
 *
 * @param {{ title: string }} data
 */
export function caption({ title }) {
  return note(title, "d-note d-caption");
}

/**
 * A line of plain text under or over a figure.
 *
 * @param {string} text
 * @param {string} [look]
 */
export function note(text, look = "d-note") {
  return html("p", { class: look }, text);
}

/**
 * The sentences below a chart.
 *
 * @param {{ notes: string[] }} data
 */
export const notes = (data) => data.notes.map((sentence) => note(sentence));

/**
 * The rows of a mark.
 *
 * @param {{ first: number, last: number }} mark
 */
export const rowsOf = ({ first, last }) => Array.from({ length: last - first }, (_, k) => first + k);

/**
 * The same sensor in an earlier answer: by its name, else none.
 *
 * @template {{ name: string }} T
 * @param {{ sensors: T[] } | null | undefined} ghost
 * @param {{ name: string }} sensor
 * @param {number} i
 * @returns {T | null}
 */
export function sameSensor(ghost, sensor, i) {
  const there = ghost?.sensors ?? [];
  if (there[i]?.name === sensor.name) return there[i];
  return there.find((other) => other.name === sensor.name) ?? null;
}
