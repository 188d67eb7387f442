/** The drawing modules of the charts of a study. */

import * as budget from "draw/budget.js";
import * as chart from "draw/chart.js";
import * as ellipses from "draw/ellipses.js";
import * as levels from "draw/levels.js";
import * as pareto from "draw/pareto.js";
import * as sensitivities from "draw/sensitivities.js";
import * as stages from "draw/stages.js";
import * as vectors from "draw/vectors.js";

/** @import { DrawingModule, Part } from "answers" */

/** By part; the map is drawn by the page alone. */
/** @type {{ [P in Exclude<Part, "map">]: DrawingModule<any> }} */
export const CHARTS = { stages, budget, sensitivities, levels, pareto, vectors, ellipses, chart };
