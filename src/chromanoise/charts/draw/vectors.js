/** Channels, light and its uncertainty in the space of color: a solid that can be turned. */

import { sensorPanels, textWidth } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { caption, channelColor, legend, note, panelHeading, sameSensor } from "draw/look.js";
import { figure, figureWidth, html, line, say, svg, tenth, words } from "draw/svg.js";

/** @import { VectorAxis, Ellipsoid, Options, Vectors, VectorsSensor } from "answers" */
/** @typedef {(point: number[]) => number[]} Projection */
/** @typedef {{ width: number, height: number }} Size */
/** @typedef {{ look: Projection, place: Projection, size: Size, axes: VectorAxis[] }} Sight */
/** @typedef {{ text: string, look: string, at: number[] }} Label */
/** @typedef {ReturnType<typeof solid>} Solid */
/**
 * @typedef {object} View
 * @property {HTMLElement} element
 * @property {Size} size of one solid
 * @property {boolean} held whether a pointer turns it
 * @property {string} shape what must stay for the roots to stay
 * @property {number[]} turn
 * @property {number[]} home
 * @property {Vectors} data
 * @property {Vectors[]} ghosts
 * @property {ReturnType<typeof surroundings>} around
 * @property {Solid[]} solids
 * @property {HTMLElement} title
 * @property {HTMLElement} status
 * @property {HTMLElement} root
 */

const MOST_WIDE = 4; // of more sensors four are side by side where there is room
const HOME = [30, 20];
const STEPS = 48; // of an outline
/** @type {Record<string, number[]>} */
const KEYS = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] };
const HELP = "Drag or press the arrow keys to turn; Home turns back; Enter reads the vectors.";
/** @type {WeakMap<Element, View>} */
const views = new WeakMap();

/**
 * @param {HTMLElement} element
 * @param {Vectors} data
 * @param {Options<Vectors>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = options.ghosts ?? [];
  const shape = `${width} ${ghosts.length} ${data.sensors.map((sensor) => sensor.name).join("|")}`;
  let view = views.get(element);
  if (!view || view.shape !== shape || view.root.parentNode !== element) {
    view = built(element, data, width, ghosts.length);
    view.shape = shape;
    views.set(element, view);
    element.replaceChildren(view.root);
  }
  // while a hand turns it, the hand is right and not an older answer
  if (!view.held) view.turn = options.look?.turn ?? view.turn ?? HOME;
  view.home = options.home ?? HOME;
  Object.assign(view, { data, ghosts, around: surroundings(data, ghosts) });
  paint(view);
}

/**
 * The roots stay when new data comes, so that they keep the focus and the pointer.
 *
 * @param {HTMLElement} element
 * @param {Vectors} data
 * @param {number} width
 * @param {number} ghosts
 */
function built(element, data, width, ghosts) {
  const { each } = sensorPanels(data.sensors.length, width, data.sensors.length > MOST_WIDE ? 220 : 300);
  const size = { width: each, height: Math.round(Math.min(420, Math.max(240, 0.8 * each))) };
  const view = /** @type {View} */ ({ element, size, held: false }); // the rest comes with the data
  const names = data.sensors.map((sensor) => sensor.name);
  view.solids = names.map((_, i) => solid(names, i, size, view));
  view.status = html("p", { class: "d-note", role: "status" });
  view.title = caption(data);
  const boxes = view.solids.map(({ box }) => box);
  const kept = ghosts ? [legend([], ghosts)] : [];
  view.root = html("div", {}, [view.title, ...kept, html("div", { class: "d-views" }, boxes), view.status]);
  return view;
}

/**
 * @param {string[]} names
 * @param {number} i
 * @param {Size} size
 * @param {View} view
 */
function solid(names, i, { width, height }, view) {
  const root = figure(width, height, `Vectors of ${names[i]} in the space of color`, "", [], {
    class: "d-figure d-turning",
    tabindex: 0,
    "aria-keyshortcuts": "ArrowLeft ArrowRight ArrowUp ArrowDown Home",
  });
  const [, description] = root.children;
  const scene = svg("g");
  root.append(scene);
  const told = note("");
  const box = html("div", { class: "d-view" }, [panelHeading(names, i), root, told]);
  box.style.setProperty("width", `${width}px`);
  root.addEventListener("keydown", (event) => turnByKey(event, view));
  root.addEventListener("pointerdown", (event) => hold(event, root, view));
  return { box, scene, description, told };
}

/**
 * @param {KeyboardEvent} event
 * @param {View} view
 */
function turnByKey(event, view) {
  const step = KEYS[event.key];
  if (!step && event.key !== "Home") return;
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  const times = event.shiftKey ? 3 : 1;
  turnTo(view, step ? [view.turn[0] + times * step[0], view.turn[1] + times * step[1]] : view.home);
}

/**
 * @param {PointerEvent} event
 * @param {SVGElement} root
 * @param {View} view
 */
function hold(event, root, view) {
  if (event.button !== 0) return;
  const start = { x: event.clientX, y: event.clientY, turn: view.turn };
  view.held = true;
  root.setPointerCapture(event.pointerId);
  /** @param {PointerEvent} now */
  const move = (now) =>
    turnTo(view, [start.turn[0] - (now.clientX - start.x) / 2, start.turn[1] + (now.clientY - start.y) / 2]);
  const drop = () => {
    view.held = false;
    root.removeEventListener("pointermove", move);
  };
  root.addEventListener("pointermove", move);
  root.addEventListener("lostpointercapture", drop, { once: true });
}

/**
 * @param {View} view
 * @param {number[]} turn
 */
function turnTo(view, [about, above]) {
  const round = ((Math.round(about) % 360) + 360) % 360;
  view.turn = [round, Math.max(-90, Math.min(90, Math.round(above)))];
  paint(view);
  const detail = { turn: [...view.turn] };
  view.element.dispatchEvent(new CustomEvent("turn", { detail, bubbles: true }));
}

/**
 * One ball around everything, so that all sensors have one scale and turning moves nothing away;
 * the color axes only show directions, and all have one length.
 *
 * @param {Vectors} data
 * @param {Vectors[]} ghosts
 */
function surroundings(data, ghosts) {
  const points = [[0, 0, 0]];
  if (data.scene) points.push(data.scene.at);
  for (const answer of [data, ...ghosts]) {
    for (const sensor of answer.sensors) {
      points.push(...sensor.channels.map((channel) => channel.at));
      if (sensor.ellipsoid) points.push(...tips(sensor.ellipsoid));
    }
  }
  const longest = Math.max(1e-9, ...points.map((point) => Math.hypot(...point)));
  const axes = data.axes.map((axis) => {
    const stretch = (0.9 * longest) / (Math.hypot(...axis.at) || 1);
    return { name: axis.name, at: axis.at.map((v) => v * stretch) };
  });
  return { ...ball([...points, ...axes.map((axis) => axis.at)]), axes };
}

/** @param {View} view */
function paint(view) {
  const { data, ghosts, size, turn } = view;
  const look = eye(turn);
  const scale = (Math.min(size.width, size.height) / 2 - 20) / view.around.reach;
  const middle = look(view.around.middle);
  /** @param {number[]} point */
  const place = ([right, up]) => [
    size.width / 2 + (right - middle[0]) * scale,
    size.height / 2 - (up - middle[1]) * scale,
  ];
  const at = { look, place, size, axes: view.around.axes };
  readable(view.element, data.table, () => places(data, at));
  data.sensors.forEach((sensor, i) => {
    const { scene, description, told } = view.solids[i];
    const before = ghosts.map((ghost) => sameSensor(ghost, sensor, i)).filter((one) => one !== null);
    scene.replaceChildren(...content(data, sensor, before, at));
    say(told, sensor.note);
    say(description, `${sensor.description} ${HELP}`);
  });
  say(view.title, data.title);
  say(view.status, `Turned ${turn[0]}° about, ${turn[1]}° up. ${HELP}`.replace("-", "\u2212"));
}

/**
 * Where the tip of each vector of the table stands, in the solid of each sensor.
 *
 * @param {Vectors} data
 * @param {Sight} at
 */
function places(data, { look, place, axes }) {
  /**
   * @param {number[]} point
   * @param {number} row
   * @param {number} figure
   */
  const placed = (point, row, figure) => {
    const [x, y] = place(look(point));
    return { x, y, row, figure };
  };
  let row = axes.length + 1;
  return data.sensors.flatMap(({ channels, light, ellipsoid }, i) => {
    const tipsOf = ellipsoid ? ellipsoid.half_axes.map((half) => half.map((v, k) => v + ellipsoid.center[k])) : [];
    const own = [...channels.map((channel) => channel.at), ...(light ? [light.at] : []), ...tipsOf];
    const shared = axes.map((axis, k) => placed(axis.at, k, i));
    const scene = data.scene ? [placed(data.scene.at, axes.length, i)] : [];
    return [...own.map((point) => placed(point, row++, i)), ...scene, ...shared];
  });
}

/**
 * @param {Vectors} data
 * @param {VectorsSensor} sensor
 * @param {VectorsSensor[]} before
 * @param {Sight} at
 */
function content(data, sensor, before, at) {
  /** @type {Label[]} */
  const labels = [];
  const origin = at.place(at.look([0, 0, 0]));
  const nodes = at.axes.map((axis) => thin(axis, origin, at, labels));
  for (const ghost of before) nodes.push(...ghostly(ghost, origin, at));
  const arrows = [...sensor.channels].sort((a, b) => at.look(a.at)[2] - at.look(b.at)[2]);
  if (sensor.ellipsoid) nodes.push(...ellipsoid(sensor.ellipsoid, at));
  for (const channel of arrows) {
    nodes.push(...arrow(channel.at, channelColor(channel.name), channel.name, origin, at, labels));
  }
  if (sensor.light) nodes.push(...arrow(sensor.light.at, "var(--ink)", "light", origin, at, labels, "5 3"));
  if (data.scene) nodes.push(cross(at.place(at.look(data.scene.at))));
  return [...nodes, ...apart(labels, at.size)];
}

/**
 * @param {VectorAxis} axis
 * @param {number[]} origin
 * @param {Sight} at
 * @param {Label[]} labels
 */
function thin(axis, origin, at, labels) {
  const tip = at.place(at.look(axis.at));
  labels.push({ text: axis.name, look: "d-quiet d-rim", at: beyond(origin, tip, 10) });
  return svg("path", { d: line([origin, tip]), class: "d-thin" });
}

/**
 * A vector's shaft and head; the head is shorter where the vector points at the eye.
 *
 * @param {number[]} vector
 * @param {string} color
 * @param {string} name
 * @param {number[]} origin
 * @param {Sight} at
 * @param {Label[]} labels
 * @param {string | null} [dash]
 */
function arrow(vector, color, name, origin, at, labels, dash = null) {
  const tip = at.place(at.look(vector));
  const length = Math.hypot(tip[0] - origin[0], tip[1] - origin[1]);
  const head = Math.min(11, 0.6 * length);
  const neck = beyond(origin, tip, -head);
  const [dx, dy] = length > 0 ? [(tip[0] - neck[0]) * 0.42, (tip[1] - neck[1]) * 0.42] : [0, 0];
  const outline = [tip, [neck[0] - dy, neck[1] + dx], [neck[0] + dy, neck[1] - dx]];
  const look = name === "light" ? "d-strong d-rim" : "d-letter";
  labels.push({ text: name, look, at: beyond(origin, tip, 12) });
  return [
    svg("path", { d: line([origin, neck]), class: "d-casing" }),
    svg("path", { d: line([origin, neck]), class: "d-shaft", stroke: color, "stroke-dasharray": dash }),
    svg("path", { d: `${line(outline)}Z`, fill: color }),
  ];
}

/**
 * @param {number[]} origin
 * @param {number[]} tip
 * @param {number} more
 */
function beyond(origin, tip, more) {
  const length = Math.hypot(tip[0] - origin[0], tip[1] - origin[1]) || 1;
  return [0, 1].map((k) => tip[k] + ((tip[k] - origin[k]) / length) * more);
}

/**
 * @param {Ellipsoid} body
 * @param {Sight} sight
 */
function ellipsoid({ center, half_axes: half }, { look, place }) {
  const outline = silhouette(half, look, place, center);
  const circles = [
    [0, 1],
    [1, 2],
    [2, 0],
  ].map(([i, j]) => greatCircle(half[i], half[j], look, place, center));
  return [
    svg("path", { d: outline, class: "d-ball" }),
    svg("path", { d: circles.map((circle) => circle.back).join(""), class: "d-behind" }),
    svg("path", { d: circles.map((circle) => circle.front).join(""), class: "d-before" }),
  ];
}

/**
 * @param {VectorsSensor} ghost
 * @param {number[]} origin
 * @param {Sight} sight
 */
function ghostly(ghost, origin, { look, place }) {
  const shafts = ghost.channels.map((channel) => line([origin, place(look(channel.at))])).join("");
  const body = ghost.ellipsoid
    ? silhouette(ghost.ellipsoid.half_axes, look, place, ghost.ellipsoid.center)
    : "";
  return [svg("path", { d: shafts + body, class: "d-ghost" })];
}

/** @param {number[]} point */
function cross([x, y]) {
  return svg("path", { d: `M${tenth(x - 5)} ${tenth(y)}h10m-5 -5v10`, class: "d-cross" });
}

/**
 * Labels that would touch are pushed apart, up and down, and kept inside.
 *
 * @param {Label[]} labels
 * @param {Size} size
 */
function apart(labels, { width, height }) {
  const boxes = labels.map((label) => ({
    ...label,
    x: label.at[0],
    y: label.at[1],
    half: textWidth(label.text, 16) / 2 + 2,
  }));
  for (let round = 0; round < 16; round += 1) {
    for (const box of boxes) {
      box.x = Math.max(box.half, Math.min(width - box.half, box.x));
      box.y = Math.max(10, Math.min(height - 8, box.y));
    }
    if (!pushed(boxes)) break;
  }
  return boxes.map((box) => words(box.x, box.y + 5, box.text, box.look, "middle"));
}

/** @param {{ x: number, y: number, half: number }[]} boxes */
function pushed(boxes) {
  let moved = false;
  for (let i = 0; i < boxes.length; i += 1) {
    for (let j = i + 1; j < boxes.length; j += 1) {
      const gap = 16 - Math.abs(boxes[i].y - boxes[j].y);
      if (gap <= 0 || Math.abs(boxes[i].x - boxes[j].x) >= boxes[i].half + boxes[j].half) continue;
      const [upper, lower] = boxes[i].y <= boxes[j].y ? [boxes[i], boxes[j]] : [boxes[j], boxes[i]];
      upper.y -= gap / 2 + 0.5;
      lower.y += gap / 2 + 0.5;
      moved = true;
    }
  }
  return moved;
}

/**
 * The way from a point in space to [right, up, toward the eye], for a turn in degrees. At [0, 0]
 * the first coordinate goes right and the third up.
 *
 * @param {number[]} turn
 * @returns {Projection}
 */
function eye([about, above]) {
  const [a, e] = [about - 90, above].map((degrees) => (degrees * Math.PI) / 180);
  const [ca, sa, ce, se] = [Math.cos(a), Math.sin(a), Math.cos(e), Math.sin(e)];
  return ([x, y, z]) => [ca * y - sa * x, ce * z - se * (ca * x + sa * y), se * z + ce * (ca * x + sa * y)];
}

/**
 * Nearly the smallest ball that holds all points: its middle goes toward the farthest point, by
 * less at each step.
 *
 * @param {number[][]} points
 */
function ball(points) {
  let middle = points[0];
  for (let step = 2; step < 40; step += 1) {
    const { point } = farthest(points, middle);
    middle = middle.map((v, k) => v + (point[k] - v) / step);
  }
  return { middle, reach: Math.max(1e-9, farthest(points, middle).distance) };
}

/**
 * @param {number[][]} points
 * @param {number[]} from
 */
function farthest(points, from) {
  let found = { point: points[0], distance: -1 };
  for (const point of points) {
    const distance = Math.hypot(point[0] - from[0], point[1] - from[1], point[2] - from[2]);
    if (distance > found.distance) found = { point, distance };
  }
  return found;
}

/**
 * The ends of the half axes: what must stay in view.
 *
 * @param {Ellipsoid} ellipsoid
 */
function tips({ center, half_axes: half }) {
  return half.flatMap((axis) => [1, -1].map((side) => center.map((c, k) => c + side * axis[k])));
}

/**
 * The silhouette of an ellipsoid as a path: the shadow of a unit ball under the three projected
 * half axes is the same ellipse as that of a disc under the root of their sum of squares.
 *
 * @param {number[][]} half
 * @param {Projection} look
 * @param {Projection} place
 * @param {number[]} center
 */
function silhouette(half, look, place, center) {
  const seen = half.map(look);
  /**
   * @param {number} i
   * @param {number} j
   */
  const sum = (i, j) => seen.reduce((total, axis) => total + axis[i] * axis[j], 0);
  const a = Math.sqrt(sum(0, 0)) || 1e-12;
  const b = sum(0, 1) / a;
  const c = Math.sqrt(Math.max(0, sum(1, 1) - b * b));
  const middle = look(center);
  const points = circle((cos, sin) => place([middle[0] + a * cos, middle[1] + b * cos + c * sin]));
  return `${line(points)}Z`;
}

/**
 * The great circle of two half axes, parted into what faces the eye and what lies behind.
 *
 * @param {number[]} first
 * @param {number[]} second
 * @param {Projection} look
 * @param {Projection} place
 * @param {number[]} center
 */
function greatCircle(first, second, look, place, center) {
  const [u, v, middle] = [look(first), look(second), look(center)];
  const front = [];
  const back = [];
  for (let k = 0; k <= STEPS; k += 1) {
    const [cos, sin] = [Math.cos((2 * Math.PI * k) / STEPS), Math.sin((2 * Math.PI * k) / STEPS)];
    const at = place([0, 1].map((i) => middle[i] + u[i] * cos + v[i] * sin));
    const near = u[2] * cos + v[2] * sin >= 0;
    front.push(near ? at : null);
    back.push(near ? null : at);
  }
  return { front: line(front), back: line(back) };
}

/** @param {(cos: number, sin: number) => number[]} at */
function circle(at) {
  return Array.from({ length: STEPS }, (_, k) => {
    const angle = (2 * Math.PI * k) / STEPS;
    return at(Math.cos(angle), Math.sin(angle));
  });
}
