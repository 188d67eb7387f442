/** Looking at three dimensions: turning, the outline of an ellipsoid, its great circles. */

import { line } from "draw/svg.js";

/** @import { Ellipsoid } from "answers" */
/** @typedef {(point: number[]) => number[]} Projection */

const STEPS = 48;

/**
 * The way from a point in space to [right, up, toward the eye], for a turn in degrees. At [0, 0]
 * the first coordinate goes right and the third up.
 *
 * @param {number[]} turn
 * @returns {Projection}
 */
export function eye([about, above]) {
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
export function ball(points) {
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
export function tips({ center, half_axes: half }) {
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
export function silhouette(half, look, place, center) {
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
export function greatCircle(first, second, look, place, center) {
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
