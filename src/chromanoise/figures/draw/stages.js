/** SNR raw, contravariant and in color: dots on one dB scale, with the numbers beside them. */

import { fitting, linear, niceRange, panels, textWidth } from "draw/axes.js";
import { readable } from "draw/hover.js";
import { caption, channelColor, ghostMark, legend, mark, sameSensor } from "draw/look.js";
import { refill } from "draw/refill.js";
import { figure, figureWidth, html, known, svg, words } from "draw/svg.js";

/** @import { Options, StageKind, StageLine, Stages } from "answers" */
/** @import { Scale } from "draw/axes.js" */
/** @typedef {StageLine & { ghosts: (number | null | undefined)[][] }} Row */
/** @typedef {Omit<StageKind, "lines"> & { lines: Row[] }} Filled */
/** @typedef {ReturnType<typeof layout>} Layout */

const HEAD = 20;
const ROW = 24;

/**
 * @param {HTMLElement} element
 * @param {Stages} data
 * @param {Options<Stages>} [options]
 */
export function draw(element, data, options = {}) {
  const width = figureWidth(element, options);
  const ghosts = options.ghosts ?? [];
  const kinds = data.kinds.map((kind) => withGhosts(kind, data, ghosts));
  const shown = kinds.filter((kind) => kind.lines.length);
  const plan = layout(data, shown, panels(shown.length, width, 500, 40).each);
  const key = legend(
    data.sensors.map((s) => s.name),
    "mark",
    ghosts.length,
  );
  const figures = shown.map((kind, k) => section(kind, plan, k));
  const boxes = shown.map((kind, k) => html("div", { class: "d-view" }, [heading(kind), figures[k]]));
  const all = html("div", { class: "d-views d-kinds" }, boxes);
  readable(element, data.table, () => places(shown, plan), true);
  refill(element, html("div", {}, [caption(data), key, all]));
}

/**
 * Each line of a kind with the values of the same sensors in earlier answers.
 *
 * @param {StageKind} kind
 * @param {Stages} data
 * @param {Stages[]} ghosts
 * @returns {Filled}
 */
function withGhosts(kind, data, ghosts) {
  /**
   * @param {Stages} ghost
   * @param {string} name
   */
  const before = (ghost, name) => {
    const line = ghost.kinds.find((other) => other.key === kind.key)?.lines.find((one) => one.name === name);
    return data.sensors.map((sensor, i) => {
      const there = sameSensor(ghost, sensor, i);
      return there === null ? null : line?.values[ghost.sensors.indexOf(there)];
    });
  };
  const lines = kind.lines.map((line) => ({ ...line, ghosts: ghosts.map((ghost) => before(ghost, line.name)) }));
  return { ...kind, lines };
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
  const columns = data.sensors.map((_, i) =>
    Math.max(42, ...all.map((row) => columnWidth(row, i))),
  );
  const numbers = columns.reduce((sum, column) => sum + column, 0);
  const right = Math.max(left, width - numbers - 4);
  const decibels = kinds.filter((kind) => kind.unit === "dB" && kind.key !== "price");
  return { width, left, columns, dots: Math.min(right, 900), dB: range(decibels) };
}

/**
 * @param {Row} row
 * @param {number} i
 */
function columnWidth(row, i) {
  const text = row.text[i] ?? "";
  return known(row.values[i]) ? textWidth(text, 14) + 8 : textWidth(text, 12) + 4;
}

/** @param {Filled[]} kinds */
function range(kinds) {
  const values = kinds.flatMap((kind) => kind.lines.flatMap((row) => [...row.values, ...row.ghosts.flat()]));
  return niceRange(values, 5, [0]);
}

/** @param {Filled} kind */
function heading(kind) {
  const nodes = [html("span", {}, kind.heading)];
  const named = { type: "button", class: "equation", "data-equation": kind.key };
  nodes.push(html("button", { ...named, "aria-label": `Equation of the ${kind.title}` }, "?"));
  nodes.push(html("small", {}, kind.of));
  return html("p", { class: "d-kind" }, nodes);
}

/**
 * @param {Filled} kind
 * @param {Layout} plan
 */
function dotScale(kind, plan) {
  const own = kind.unit !== "dB" || kind.key === "price";
  const [low, high] = own ? range([kind]) : plan.dB;
  const x = linear(low, high, plan.left + 8, plan.dots - 12);
  return { x, roomy: x.to - x.from > 64 && kind.lines.some((row) => row.values.some(known)) };
}

/**
 * Where each value of the table stands: its mark, or its number where there is none.
 *
 * @param {Filled[]} kinds
 * @param {Layout} plan
 */
function places(kinds, plan) {
  let row = -1;
  return kinds.flatMap((kind, figure) => {
    const { x, roomy } = dotScale(kind, plan);
    return kind.lines.flatMap(({ values, text }, k) => {
      row += 1;
      let end = plan.dots;
      return values.flatMap((value, i) => {
        end += plan.columns[i];
        const at = roomy && known(value) ? x.at(value) : end - 14;
        const place = { x: at, y: HEAD + ROW * (k + 0.5), row, cells: [0, 1, 2 + i], series: i, figure };
        return (text[i] ?? null) === null ? [] : [place];
      });
    });
  });
}

/**
 * @param {Filled} kind
 * @param {Layout} plan
 * @param {number} k
 */
function section(kind, plan, k) {
  const { x, roomy } = dotScale(kind, plan);
  const bottom = HEAD + kind.lines.length * ROW;
  const nodes = roomy ? scale(x, bottom, kind.unit) : [];
  nodes.push(...columnMarks(plan));
  kind.lines.forEach((row, j) => nodes.push(...drawnRow(row, HEAD + ROW * (j + 0.5), x, plan, roomy)));
  const title = `${kind.title}, ${kind.of}`;
  const height = bottom + (roomy ? 22 : 2);
  return figure(plan.width, height, title, kind.description, nodes, k ? { tabindex: null } : {}); // one stop
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
 * @param {Row} row
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
    nodes.push(words(end, y + 5, row.text[i] ?? "", known(v) ? "" : "d-tick", "end"));
  });
  return nodes;
}
