/** SNR raw, contravariant and in color: dots on one dB scale, with the numbers beside them. */

import { fitting, linear, niceRange, panels, textWidth } from "draw/axes.js";
import { channelColor, ghostMark, legend, mark, sameSensor } from "draw/look.js";
import { refill } from "draw/refill.js";
import { brief, decimal, figure, figureWidth, html, known, svg, words } from "draw/svg.js";

/** @import { ByName, Options, Stages, StagesSensor, Table } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {typeof KINDS[number]} Kind */
/** @typedef {Kind & { lines: ReturnType<typeof lines> }} Filled */
/** @typedef {ReturnType<typeof layout>} Layout */

const HEAD = 20;
const ROW = 24;
const KINDS = [
  { key: "raw", title: "raw SNR", unit: "dB", of: "per channel, as read" },
  { key: "contravariant", title: "contravariant SNR", unit: "dB", of: "per channel, unmixed" },
  { key: "spectral", title: "spectral SNR", unit: "dB", of: "of the whole rebuilt spectrum" },
  { key: "color", title: "color SNR", unit: "dB", of: "per coordinate" },
  { key: "bound", title: "bound", unit: "dB", of: "SNR of the best linear readout of Y" },
  { key: "price", title: "price", unit: "dB", of: "how far Y stays below the bound" },
  { key: "lab", title: "noise in CIELAB", unit: "", of: "standard deviation" },
];

/**
 * @param {HTMLElement} element
 * @param {Stages} data
 * @param {Options<Stages>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = options.ghosts ?? [];
  const kinds = KINDS.map((kind) => ({ ...kind, of: patchOf(kind, data), lines: lines(data, ghosts, kind) }));
  const shown = kinds.filter((kind) => kind.lines.length);
  const plan = layout(data, shown, panels(shown.length, width, 500, 40).each);
  const key = legend(
    data.sensors.map((s) => s.name),
    "mark",
    ghosts.length,
  );
  const figures = shown.map((kind) => section(data, kind, plan));
  const boxes = shown.map((kind, k) => html("div", { class: "d-view" }, [heading(kind), figures[k]]));
  refill(element, html("div", {}, [key, html("div", { class: "d-views d-kinds" }, boxes)]));
}

/**
 * @param {Kind} kind
 * @param {Stages} data
 */
function patchOf(kind, data) {
  return kind.key === "lab" && data.gray
    ? `standard deviation of a ${brief(100 * data.gray)} % gray`
    : kind.of;
}

/**
 * A line per channel or coordinate: its name, a value per sensor, and the ghosts' values.
 *
 * @param {Stages} data
 * @param {Stages[]} ghosts
 * @param {Kind} kind
 */
function lines(data, ghosts, kind) {
  const names = [...new Set(data.sensors.flatMap((sensor) => Object.keys(part(sensor, kind.key))))];
  return names.map((name) => ({
    name,
    values: data.sensors.map((sensor) => value(sensor, kind.key, name)),
    ghosts: ghosts.map((ghost) =>
      data.sensors.map((sensor, i) => value(sameSensor(ghost, sensor, i), kind.key, name)),
    ),
  }));
}

/**
 * @param {StagesSensor | null} sensor
 * @param {string} key
 * @returns {ByName}
 */
function part(sensor, key) {
  if (key === "lab") return sensor?.lab_sd ?? {};
  if (key === "spectral") {
    return sensor?.spectral_db === undefined ? {} : { spectrum: sensor.spectral_db };
  }
  if (key === "bound" || key === "price") return { Y: sensor?.[`${key}_db`] ?? null };
  return sensor?.[/** @type {"raw" | "contravariant" | "color"} */ (key)] ?? {};
}

/**
 * `undefined` where the sensor has no such channel, `null` where it has no number.
 *
 * @param {StagesSensor | null} sensor
 * @param {string} key
 * @param {string} name
 * @returns {number | null | undefined}
 */
function value(sensor, key, name) {
  return part(sensor, key)[name];
}

/**
 * @param {number | null | undefined} value
 * @param {StagesSensor} sensor
 */
function told(value, sensor) {
  if (value === undefined) return "";
  // a server that tells why there is no number tells it of saturation only
  const digits = value !== null && value >= 1000 ? 0 : 1;
  return decimal(value, digits, sensor.why_not === null ? "no SNR" : "saturated");
}

/**
 * Columns of numbers only as wide as their words, the rest for the dots.
 *
 * @param {Stages} data
 * @param {Filled[]} kinds
 * @param {number} width
 */
function layout(data, kinds, width) {
  const all = kinds.flatMap((kind) => kind.lines);
  const left = Math.min(90, Math.max(26, ...all.map((row) => textWidth(row.name, 14) + 6)));
  const columns = data.sensors.map((sensor, i) =>
    Math.max(42, ...all.map((row) => columnWidth(row.values[i], sensor))),
  );
  const numbers = columns.reduce((sum, column) => sum + column, 0);
  const right = Math.max(left, width - numbers - 4);
  const decibels = kinds.filter((kind) => kind.unit === "dB" && kind.key !== "price");
  return { width, left, columns, sensors: data.sensors, dots: Math.min(right, 900), dB: range(decibels) };
}

/**
 * @param {number | null | undefined} value
 * @param {StagesSensor} sensor
 */
function columnWidth(value, sensor) {
  const text = told(value, sensor);
  return known(value) ? textWidth(text, 14) + 8 : textWidth(text, 12) + 4;
}

/** @param {Filled[]} kinds */
function range(kinds) {
  const values = kinds.flatMap((kind) => kind.lines.flatMap((row) => [...row.values, ...row.ghosts.flat()]));
  return niceRange(values, 5, [0]);
}

/** @param {Kind} kind */
function heading(kind) {
  const unit = kind.unit ? ` [${kind.unit}]` : "";
  const nodes = [html("span", {}, `${kind.title}${unit}`)];
  const named = { type: "button", class: "equation", "data-equation": kind.key };
  nodes.push(html("button", { ...named, "aria-label": `Equation of the ${kind.title}` }, "?"));
  nodes.push(html("small", {}, kind.of));
  return html("p", { class: "d-kind" }, nodes);
}

/**
 * @param {Stages} data
 * @param {Filled} kind
 * @param {Layout} plan
 */
function section(data, kind, plan) {
  const own = kind.unit !== "dB" || kind.key === "price";
  const [low, high] = own ? range([kind]) : plan.dB;
  const x = linear(low, high, plan.left + 8, plan.dots - 12);
  const bottom = HEAD + kind.lines.length * ROW;
  const roomy = x.to - x.from > 64 && kind.lines.some((row) => row.values.some(known));
  const nodes = roomy ? scale(x, bottom, kind.unit) : [];
  nodes.push(...columnMarks(plan));
  kind.lines.forEach((row, k) => nodes.push(...drawnRow(row, HEAD + ROW * (k + 0.5), x, plan, roomy)));
  const title = `${kind.title}, ${kind.of}`;
  return figure(plan.width, bottom + (roomy ? 22 : 2), title, description(data, kind), nodes);
}

/**
 * Each column of numbers begins with its sensor's mark.
 *
 * @param {Layout} plan
 */
function columnMarks(plan) {
  let end = plan.dots;
  return plan.columns.map((column, i) => {
    end += column;
    return mark(i, end - 10, 11, "var(--ink)", 4);
  });
}

/**
 * @param {Scale} x
 * @param {number} bottom
 * @param {string} unit
 */
function scale(x, bottom, unit) {
  const ticks = x.ticks(Math.max(2, Math.floor((x.to - x.from) / 60)));
  const d = ticks.map((tick) => `M${Math.round(x.at(tick.value))} ${HEAD}V${bottom}`).join("");
  const marks = ticks.map((tick, k) => {
    const last = k === ticks.length - 1 && x.to - x.from > 220 && unit;
    return words(
      x.at(tick.value),
      bottom + 16,
      last ? `${tick.label} ${unit}` : tick.label,
      "d-tick",
      "middle",
    );
  });
  return [svg("path", { d, class: "d-grid" }), ...marks];
}

/**
 * @param {Filled["lines"][number]} row
 * @param {number} y
 * @param {Scale} x
 * @param {Layout} plan
 * @param {boolean} roomy
 */
function drawnRow(row, y, x, plan, roomy) {
  const color = channelColor(row.name);
  const nodes = [words(0, y + 5, fitting(row.name, plan.left, 14), "d-strong")];
  if (roomy) {
    nodes.push(svg("path", { d: `M${x.from} ${y}H${x.to}`, class: "d-grid" }));
    for (const ghost of row.ghosts) {
      ghost.forEach((v, i) => known(v) && nodes.push(ghostMark(i, x.at(v), y)));
    }
    row.values.forEach((v, i) => known(v) && nodes.push(mark(i, x.at(v), y, color)));
  }
  let end = plan.dots;
  row.values.forEach((v, i) => {
    end += plan.columns[i];
    nodes.push(words(end, y + 5, told(v, plan.sensors[i]), known(v) ? "" : "d-tick", "end"));
  });
  return nodes;
}

/**
 * @param {Stages} data
 * @param {Filled} kind
 */
function description(data, kind) {
  const unit = kind.unit ? ` ${kind.unit}` : "";
  const each = data.sensors.map((sensor, i) => {
    const parts = kind.lines
      .filter((row) => row.values[i] !== undefined)
      .map((row) => `${row.name} ${told(row.values[i], sensor)}${known(row.values[i]) ? unit : ""}`);
    return `${sensor.name}: ${parts.join(", ")}.`;
  });
  return each.join(" ");
}

/**
 * @param {Stages} data
 * @returns {Table}
 */
export function rows(data) {
  const head = ["kind", "channel or coordinate", ...data.sensors.map((sensor) => sensor.name)];
  const table = KINDS.flatMap((kind) =>
    lines(data, [], kind).map((row) => [
      kind.unit ? `${kind.title} [${kind.unit}]` : kind.title,
      row.name,
      ...row.values.map((v, i) => (v === undefined ? "–" : told(v, data.sensors[i]))),
    ]),
  );
  return { head, rows: table };
}
