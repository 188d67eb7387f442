/** The drawing modules of the charts of a study. */

import * as budget from "draw/budget.js";
import * as chart from "draw/chart.js";
import * as plane from "draw/plane.js";
import * as stages from "draw/stages.js";
import * as vectors from "draw/vectors.js";

/** @import { DrawingModule, Part } from "answers" */

/** By part; the map is drawn by the page alone. */
/** @type {{ [P in Exclude<Part, "map">]: DrawingModule<any> }} */
export const CHARTS = {
  ...{ sensitivities: plane, levels: plane, pareto: plane, ellipses: plane },
  ...{ stages, budget, vectors, chart },
};
