/** Draws any chart: which module draws it follows from its marks. */

import * as bars from "draw/bars.js";
import * as cells from "draw/cells.js";
import * as dots from "draw/dots.js";
import { notes } from "draw/look.js";
import * as plane from "draw/plane.js";
import { refill } from "draw/refill.js";
import * as swatches from "draw/swatches.js";
import * as vectors from "draw/vectors.js";

/** @import { Chart, DrawingModule, Options, Vectors } from "answers" */

/** By kind of mark; a plane has all others. */
/** @type {Record<string, DrawingModule<Chart>>} */
const DRAWN = { bars, cells, dots, swatches };

/**
 * Earlier charts, in the options, stand behind this one where they have the same axes.
 *
 * @param {HTMLElement} element
 * @param {Chart | Vectors} data
 * @param {Options<any>} [options]
 */
export function draw(element, data, options = {}) {
  if ("axes" in data) return vectors.draw(element, data, options);
  const [first] = data.panels;
  if (!first) return refill(element, ...notes(data));
  const [mark] = data.panels.flatMap(({ marks }) => marks);
  const alike = (/** @type {Chart} */ { panels: [other] }) => other?.x.label === first.x.label && other.y.label === first.y.label;
  const ghosts = (options.ghosts ?? []).filter(alike);
  return (DRAWN[mark?.kind] ?? plane).draw(element, data, { ...options, ghosts });
}
