/** The sensors of a front as points over two of its objectives; a point is read and loaded. */

import { axes, linear, niceRange, textWidth, wrapped } from "draw/axes.js";
import { caption, legend, markPath, note } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, html, known, svg, tenth, words } from "draw/svg.js";

/** @import { FrontAxis, FrontChart, FrontPoint } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/**
 * @typedef {object} CloudOptions
 * @property {string} x name of the objective across
 * @property {string} y name of the objective up
 * @property {Set<string>} loaded names of the members that the page shows
 * @property {(name: string) => unknown} load
 * @property {number} [width]
 */
/** @typedef {{ point: FrontPoint, left: number, top: number }} Placed */
/**
 * @typedef {object} View
 * @property {Placed[]} members along the front, from left to right
 * @property {Placed[]} references
 * @property {string | null} at name of the point that is read
 * @property {CloudOptions} options
 * @property {number} width
 */

const ROOM = { left: 48, right: 24, top: 34, bottom: 44 };
const LINE_PX = 16;
const REACH_PX = 24;
const HELP = "Point at a sensor, or move along the front with the arrow keys. A click or Enter loads it.";
/** @type {Record<string, (i: number, count: number) => number>} */
const STEPS = {
  ArrowRight: (i) => i + 1,
  ArrowUp: (i) => i + 1,
  ArrowLeft: (i) => i - 1,
  ArrowDown: (i) => i - 1,
  Home: () => 0,
  End: (_, count) => count - 1,
};
/** Shape, color and size of each kind of point; shapes as in `markPath`. */
const MARKS = {
  member: { shape: 0, color: "var(--sensor-0)", size: 4.5, name: "sensor of the front" },
  extreme: { shape: 3, color: "var(--sensor-5)", size: 6, name: "best in one objective" },
  knee: { shape: 2, color: "var(--sensor-2)", size: 6, name: "knee" },
};

/** @type {WeakMap<Element, View>} */
const views = new WeakMap();
let made = 0;

/**
 * @param {HTMLElement} element
 * @param {FrontChart} data
 * @param {CloudOptions} options
 */
export function draw(element, data, options) {
  const width = figureWidth(element, options);
  const before = views.get(element);
  const drawn = (/** @type {FrontPoint} */ { values }) => known(values[options.x]) && known(values[options.y]);
  const points = [...data.members, ...data.references];
  const [across, up] = [options.x, options.y].map((name) => /** @type {FrontAxis} */ (data.axes.find((one) => one.name === name)));
  const [below, above] = [across, up].map(({ title }) => wrapped(title, width - ROOM.left));
  const top = ROOM.top + LINE_PX * (above.length - 1);
  const { x, y, bottom } = plane(points.filter(drawn), options, top, width);
  const place = (/** @type {FrontPoint} */ point) => ({
    point,
    left: x.at(/** @type {number} */ (point.values[options.x])),
    top: y.at(/** @type {number} */ (point.values[options.y])),
  });
  const members = data.members.filter(drawn).map(place);
  members.sort((a, b) => a.left - b.left || b.top - a.top);
  const references = data.references.filter(drawn).map(place);
  const at = members.some(({ point }) => point.name === before?.at) ? (before?.at ?? null) : null;
  const view = { members, references, at, options, width };
  views.set(element, view);
  const nodes = axes(x, y, { xRoom: 64 });
  above.forEach((text, i) => nodes.push(words(0, top - 14 - LINE_PX * (above.length - 1 - i), text, "d-quiet")));
  below.forEach((text, i) => nodes.push(words((x.from + x.to) / 2, bottom + 35 + LINE_PX * i, text, "d-quiet", "middle")));
  const height = bottom + ROOM.bottom + LINE_PX * (below.length - 1);
  nodes.push(better(across, up, x, y), ...labels(view, x, y));
  nodes.push(...members.map((one) => option(one, options)));
  nodes.push(...references.map(({ left, top }) => svg("path", { d: markPath(1, left, top), class: "d-reference" })));
  nodes.push(svg("circle", { class: "d-cursor", r: 11, visibility: "hidden" }));
  const keys = "ArrowLeft ArrowRight Home End Enter";
  const list = { class: "d-figure d-cloud", role: "listbox", tabindex: 0, "aria-keyshortcuts": keys };
  const root = figure(width, height, data.title, `${data.description} ${HELP}`, nodes, list);
  const read = html("p", { class: "d-note d-read", role: "status" }, HELP);
  refill(element, caption(data), key(data), root, read, ...missing(points.length - members.length - references.length));
  if (!before) listen(element);
  show(element);
}

/**
 * @param {FrontPoint[]} points
 * @param {CloudOptions} options
 * @param {number} top
 * @param {number} width
 */
function plane(points, options, top, width) {
  const tall = Math.round(Math.min(420, Math.max(220, 0.45 * width)));
  const [left, right] = niceRange(points.map(({ values }) => values[options.x]), 6);
  const [low, high] = niceRange(points.map(({ values }) => values[options.y]), 6);
  const x = linear(left, right, ROOM.left, width - ROOM.right);
  const y = linear(low, high, top + tall, top);
  return { x, y, bottom: top + tall };
}

/**
 * An arrow in the corner in which both objectives are best.
 *
 * @param {FrontAxis} across
 * @param {FrontAxis} up
 * @param {Scale} x
 * @param {Scale} y
 */
function better(across, up, x, y) {
  const [right, above] = [across.better === "higher", up.better === "higher"];
  const arrow = right ? (above ? "\u2197" : "\u2198") : above ? "\u2196" : "\u2199";
  const text = right ? `better ${arrow}` : `${arrow} better`;
  return words(right ? x.to - 4 : x.from + 4, above ? y.to + 14 : y.from - 8, text, "d-quiet d-rim", right ? "end" : "start");
}

/**
 * @param {Placed} placed
 * @param {CloudOptions} options
 */
function option({ point, left, top }, { loaded }) {
  const { shape, color, size } = MARKS[point.mark ?? "member"];
  const is = loaded.has(point.name);
  const told = { role: "option", id: `front-point-${(made += 1)}`, "aria-label": point.reading };
  const mark = svg("path", { d: markPath(shape, left, top, size), fill: color });
  const ring = is ? [svg("circle", { cx: tenth(left), cy: tenth(top), r: 9, class: "d-loaded" })] : [];
  return svg("g", { ...told, "aria-selected": is ? "true" : "false" }, [...ring, mark]);
}

/**
 * The names of the references, each where it touches neither a point nor another name.
 *
 * @param {View} view
 * @param {Scale} x
 * @param {Scale} y
 */
function labels({ members, references }, x, y) {
  const taken = [...members, ...references].map(({ left, top }) => ({ left: left - 5, right: left + 5, top: top - 5, bottom: top + 5 }));
  return references.flatMap(({ point, left, top }) => {
    const wide = textWidth(point.name, 13);
    const corners = [[9, 4], [-9 - wide, 4], [-wide / 2, -10], [-wide / 2, 20], [9, -8], [-9 - wide, -8], [9, 18], [-9 - wide, 18]];
    const boxes = corners.map(([dx, dy]) => ({ left: left + dx, right: left + dx + wide, top: top + dy - 11, bottom: top + dy + 3 }));
    const free = boxes.find(
      (box) =>
        box.left >= x.from && box.right <= x.to + ROOM.right && box.top >= y.to - 8 && box.bottom <= y.from &&
        !taken.some((other) => box.left < other.right && other.left < box.right && box.top < other.bottom && other.top < box.bottom),
    );
    if (!free) return [];
    taken.push(free);
    return [words(free.left, free.bottom - 3, point.name, "d-rim")];
  });
}

/** @param {FrontChart} data */
function key({ members, references }) {
  const kinds = /** @type {const} */ (["member", "extreme", "knee"]).filter((kind) => members.some(({ mark }) => mark === kind));
  const entries = kinds.map((kind) => {
    const { shape, color, size, name } = MARKS[kind];
    return { drawn: [svg("path", { d: markPath(shape, 18, 8, size), fill: color })], name };
  });
  if (references.length) entries.push({ drawn: [svg("path", { d: markPath(1, 18, 8), class: "d-reference" })], name: "reference" });
  entries.push({ drawn: [svg("circle", { cx: 18, cy: 8, r: 7, class: "d-loaded" })], name: "loaded" });
  return legend(entries);
}

/** @param {number} count */
function missing(count) {
  if (count === 0) return [];
  return [note(`${count} without a value in one of these objectives, not drawn.`)];
}

/** @param {HTMLElement} element */
function listen(element) {
  element.addEventListener("pointermove", (event) => pointed(element, event));
  element.addEventListener("click", (event) => clicked(element, event));
  element.addEventListener("keydown", (event) => pressed(element, event));
  element.addEventListener("focusin", () => {
    const view = views.get(element);
    if (view) read(element, view.at ?? view.members[0]?.point.name ?? null);
  });
  element.addEventListener("pointerleave", () => element.contains(document.activeElement) || read(element, null));
  element.addEventListener("focusout", () => read(element, null));
}

/**
 * The point under the pointer, or the nearest within reach of a finger.
 *
 * @param {HTMLElement} element
 * @param {MouseEvent} event
 * @returns {Placed | null}
 */
function nearest(element, { clientX, clientY }) {
  const view = views.get(element);
  const box = element.querySelector(".d-cloud")?.getBoundingClientRect();
  if (!view || !box) return null;
  const scale = view.width / box.width;
  const [left, top] = [(clientX - box.left) * scale, (clientY - box.top) * scale];
  const far = (/** @type {Placed} */ one) => Math.hypot(one.left - left, one.top - top);
  const [first] = [...view.members, ...view.references].sort((a, b) => far(a) - far(b));
  return first && far(first) <= REACH_PX ? first : null;
}

/**
 * @param {HTMLElement} element
 * @param {PointerEvent} event
 */
function pointed(element, event) {
  const found = nearest(element, event);
  if (found) read(element, found.point.name);
}

/**
 * @param {HTMLElement} element
 * @param {MouseEvent} event
 */
function clicked(element, event) {
  const view = views.get(element);
  const found = nearest(element, event);
  if (!view || !found) return;
  read(element, found.point.name);
  if (view.members.includes(found)) view.options.load(found.point.name);
}

/**
 * @param {HTMLElement} element
 * @param {KeyboardEvent} event
 */
function pressed(element, event) {
  const view = views.get(element);
  if (!view?.members.length || event.ctrlKey || event.altKey || event.metaKey) return;
  const i = view.members.findIndex(({ point }) => point.name === view.at);
  const step = STEPS[event.key];
  const loads = event.key === "Enter" || event.key === " ";
  if (!step && !loads) return;
  event.preventDefault();
  if (step) {
    const to = Math.max(0, Math.min(view.members.length - 1, step(i, view.members.length)));
    read(element, view.members[to].point.name);
  } else if (i >= 0) view.options.load(view.members[i].point.name);
}

/**
 * @param {HTMLElement} element
 * @param {string | null} name
 */
function read(element, name) {
  const view = views.get(element);
  if (!view) return;
  view.at = name;
  show(element);
}

/**
 * Marks the point that is read, and shows its values.
 *
 * @param {HTMLElement} element
 */
function show(element) {
  const view = views.get(element);
  const root = element.querySelector(".d-cloud");
  const cursor = element.querySelector(".d-cursor");
  const said = element.querySelector(".d-read");
  if (!view || !root || !cursor || !said) return;
  const i = view.members.findIndex(({ point }) => point.name === view.at);
  const found = view.members[i] ?? view.references.find(({ point }) => point.name === view.at);
  const active = i >= 0 ? root.querySelectorAll("[role=option]")[i] : null;
  if (active) root.setAttribute("aria-activedescendant", active.id);
  else root.removeAttribute("aria-activedescendant");
  cursor.setAttribute("visibility", found ? "visible" : "hidden");
  if (found) {
    cursor.setAttribute("cx", String(tenth(found.left)));
    cursor.setAttribute("cy", String(tenth(found.top)));
  }
  const told = found ? found.point.reading : HELP;
  if (said.textContent !== told) said.textContent = told;
}
