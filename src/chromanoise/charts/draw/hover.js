/**
 * Values at the pointer, at a touch and by keyboard: the row of a chart's table beside its mark.
 *
 * A drawing names the places of its marks; all of them are read here.
 */

import { html } from "draw/svg.js";

/** @import { Table } from "answers" */
/**
 * @typedef {object} Place a mark, in units of its figure
 * @property {number} x its middle
 * @property {number} y
 * @property {number} row of the table
 * @property {number[]} [cells] columns of that row; all where there are none
 * @property {number} [series] marks between which one key moves, in their order
 * @property {number} [figure] which SVG of the element
 * @property {number} [width] of an area around the middle, as of a bar
 * @property {number} [height]
 */
/** @typedef {{ table: Table, make: () => Place[], places: Place[] | null, down: boolean }} Source */

const REACH_PX = 32;
const GAP_PX = 12;
/** For so long a pointer may be on its way to the words. */
const LEAVE_MS = 250;
/** @type {WeakMap<Element, Source>} */
const sources = new WeakMap();
/** @type {{ element: HTMLElement, place: Place } | null} */
let open = null;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let leaving;
let toTip = Infinity; // px from the pointer
/** @type {{ tip: HTMLElement, ring: HTMLElement, said: HTMLElement } | null} */
let parts = null;

/**
 * Tells where the marks of a drawing are; to be called before the drawing is replaced. The places
 * are made when somebody reads one.
 *
 * @param {HTMLElement} element
 * @param {Table} table
 * @param {() => Place[]} make
 * @param {boolean} [down] whether a series goes down and not to the right
 */
export function readable(element, table, make, down = false) {
  if (!sources.has(element)) listen(element);
  sources.set(element, { table, make, places: null, down });
  if (open?.element === element) hide();
}

/** @param {HTMLElement} element */
function listen(element) {
  element.addEventListener("pointermove", (event) => pointed(element, event));
  element.addEventListener("pointerup", (event) => pointed(element, event));
  element.addEventListener("pointerleave", ({ pointerType }) => pointerType !== "touch" && leave());
  element.addEventListener("focusin", ({ target }) => focused(element, target));
  element.addEventListener("focusout", () => hide());
  element.addEventListener("keydown", (event) => pressed(element, event));
}

/** @param {HTMLElement} element */
function placesOf(element) {
  const source = /** @type {Source} */ (sources.get(element));
  source.places ??= source.make();
  return source.places;
}

/**
 * @param {HTMLElement} element
 * @returns {SVGSVGElement[]}
 */
function figuresOf(element) {
  return [...element.querySelectorAll("svg")].filter((one) => one.classList.contains("d-figure"));
}

/**
 * @param {HTMLElement} element
 * @param {EventTarget | null} target
 */
function figureAt(element, target) {
  const figure = target instanceof Element ? target.closest("svg.d-figure") : null;
  return figure ? figuresOf(element).indexOf(/** @type {SVGSVGElement} */ (figure)) : -1;
}

/**
 * @param {HTMLElement} element
 * @param {PointerEvent} event
 */
function pointed(element, event) {
  const isTouch = event.pointerType === "touch";
  if (event.type === "pointermove" && isTouch) return undefined; // it scrolls, or will be lifted
  if (event.buttons) return hide(); // something is dragged
  const before = toTip;
  toTip = awayFromTip(event);
  if (open && toTip < Math.min(before, 2 * GAP_PX)) return undefined; // on the way to the words
  const at = figureAt(element, event.target);
  if (at < 0) return leave();
  const figure = figuresOf(element)[at];
  const box = figure.getBoundingClientRect();
  const scale = figure.viewBox.baseVal.width / box.width;
  const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
  let nearest = null;
  let least = REACH_PX * scale;
  for (const place of placesOf(element)) {
    if ((place.figure ?? 0) !== at) continue;
    const across = Math.max(0, Math.abs(x - place.x) - (place.width ?? 0) / 2);
    const distance = Math.hypot(across, Math.max(0, Math.abs(y - place.y) - (place.height ?? 0) / 2));
    if (distance >= least) continue;
    nearest = place;
    least = distance;
  }
  if (nearest) show(element, nearest);
  else leave();
  return undefined;
}

/**
 * How far a pointer is from the words.
 *
 * @param {PointerEvent} event
 */
function awayFromTip({ clientX, clientY }) {
  const box = parts?.tip.getBoundingClientRect();
  if (!box) return Infinity;
  const across = Math.max(box.left - clientX, 0, clientX - box.right);
  return Math.hypot(across, Math.max(box.top - clientY, 0, clientY - box.bottom));
}

/**
 * @param {HTMLElement} element
 * @param {EventTarget | null} target
 */
function focused(element, target) {
  const at = figureAt(element, target);
  if (at < 0 || !(/** @type {Element} */ (target).matches(":focus-visible"))) return;
  const first = placesOf(element).find((place) => (place.figure ?? 0) === at);
  if (first) show(element, first, true);
}

/**
 * Arrows move along a series and to the next one, Enter to the next mark; where the arrows turn the
 * drawing, Enter alone.
 *
 * @param {HTMLElement} element
 * @param {KeyboardEvent} event
 */
function pressed(element, event) {
  const at = figureAt(element, event.target);
  if (at < 0 || event.ctrlKey || event.altKey || event.metaKey) return;
  const turns = figuresOf(element)[at].classList.contains("d-turning");
  const places = placesOf(element).filter((place) => !turns || (place.figure ?? 0) === at);
  const now = open?.element === element ? open.place : places[0];
  const next = places.length ? moved(places, now, event, turns, /** @type {Source} */ (sources.get(element)).down) : null;
  if (!next) return;
  event.preventDefault();
  figuresOf(element)[next.figure ?? 0]?.scrollIntoView({ block: "nearest" });
  show(element, open ? next : now, true);
}

/**
 * @param {Place[]} places
 * @param {Place} now
 * @param {KeyboardEvent} event
 * @param {boolean} turns
 * @param {boolean} down
 * @returns {Place | null}
 */
function moved(places, now, { key, shiftKey }, turns, down) {
  if (key === "Enter") return places.at((places.indexOf(now) + (shiftKey ? -1 : 1)) % places.length) ?? null;
  if (turns) return null;
  const own = places.filter((place) => place.series === now.series);
  if (key === "Home") return own[0];
  if (key === "End") return own[own.length - 1];
  const [back, on, before, after] = down
    ? ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"]
    : ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"];
  if (key === back) return own[Math.max(0, own.indexOf(now) - 1)];
  if (key === on) return own[Math.min(own.length - 1, own.indexOf(now) + 1)];
  if (key !== before && key !== after) return null;
  const all = [...new Set(places.map((place) => place.series))];
  const other = all[all.indexOf(now.series) + (key === after ? 1 : -1)];
  /** @param {Place} place */
  const away = (place) =>
    (place.figure === now.figure ? 0 : 1e6) + (down ? Math.abs(place.y - now.y) : Math.abs(place.x - now.x));
  const beside = places.filter((place) => place.series === other);
  return beside.length ? beside.reduce((a, b) => (away(b) < away(a) ? b : a)) : now;
}

/**
 * @param {HTMLElement} element
 * @param {Place} place
 * @param {boolean} [aloud] whether readers of the screen are told
 */
function show(element, place, aloud = false) {
  clearTimeout(leaving);
  if (open?.place === place && !aloud) return;
  const figure = figuresOf(element)[place.figure ?? 0];
  const { head, rows } = /** @type {Source} */ (sources.get(element)).table;
  const row = rows[place.row];
  if (!figure || !row) return;
  const { tip, ring, said } = (parts ??= made());
  const cells = place.cells ?? row.map((_, i) => i);
  tip.replaceChildren(
    ...cells.map((i) => html("div", {}, [html("span", {}, `${head[i]}: `), html("b", {}, row[i])])),
  );
  if (aloud) said.textContent = cells.map((i) => `${head[i]}: ${row[i]}`).join(", ");
  open = { element, place };
  tip.hidden = ring.hidden = false;
  laid(figure, place, tip, ring);
}

/**
 * The ring around the mark, and the words beside it where the window has room for them.
 *
 * @param {SVGSVGElement} figure
 * @param {Place} place
 * @param {HTMLElement} tip
 * @param {HTMLElement} ring
 */
function laid(figure, place, tip, ring) {
  const box = figure.getBoundingClientRect();
  const scale = box.width / figure.viewBox.baseVal.width;
  const [x, y] = [box.left + place.x * scale, box.top + place.y * scale];
  const [width, height] = [place.width, place.height].map((side) => (side ? side * scale + 4 : 16));
  ring.classList.toggle("d-area-ring", Boolean(place.width));
  put(ring, x - width / 2, y - height / 2);
  ring.style.setProperty("width", `${width}px`);
  ring.style.setProperty("height", `${height}px`);
  const { clientWidth, clientHeight } = document.documentElement;
  const { offsetWidth, offsetHeight } = tip;
  const right = x + GAP_PX + offsetWidth < clientWidth - 4;
  const left = right ? x + GAP_PX : x - GAP_PX - offsetWidth;
  const above = y - height / 2 - GAP_PX - offsetHeight;
  const top = above > 4 ? above : y + height / 2 + GAP_PX;
  put(
    tip,
    Math.max(4, Math.min(clientWidth - offsetWidth - 4, left)),
    Math.max(4, Math.min(clientHeight - offsetHeight - 4, top)),
  );
}

/**
 * @param {HTMLElement} node
 * @param {number} left in the window
 * @param {number} top
 */
function put(node, left, top) {
  node.style.setProperty("left", `${left + window.scrollX}px`);
  node.style.setProperty("top", `${top + window.scrollY}px`);
}

function made() {
  const tip = html("div", { class: "d-tip", role: "tooltip" });
  const ring = html("div", { class: "d-ring", "aria-hidden": "true" });
  const said = html("p", { class: "d-unseen", role: "status" });
  tip.addEventListener("pointerenter", () => clearTimeout(leaving));
  tip.addEventListener("pointerleave", leave);
  document.body.append(ring, tip, said);
  document.addEventListener("keydown", ({ key }) => key === "Escape" && hide());
  document.addEventListener("pointerdown", ({ target }) => {
    if (target instanceof Node && !open?.element.contains(target) && !tip.contains(target)) hide();
  });
  return { tip, ring, said };
}

function leave() {
  clearTimeout(leaving);
  leaving = setTimeout(hide, LEAVE_MS);
}

function hide() {
  clearTimeout(leaving);
  open = null;
  if (parts) parts.tip.hidden = parts.ring.hidden = true;
}
