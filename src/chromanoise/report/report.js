/** Draws a report, and draws it anew from its own answers when a slider moves. */

import * as budget from "draw/budget.js";
import * as chart from "draw/chart.js";
import * as ellipses from "draw/ellipses.js";
import * as levels from "draw/levels.js";
import * as pareto from "draw/pareto.js";
import * as picture from "draw/picture.js";
import * as sensitivities from "draw/sensitivities.js";
import * as stages from "draw/stages.js";
import { html } from "draw/svg.js";
import * as vectors from "draw/vectors.js";

const MODULES = { budget, vectors, stages, levels, ellipses, chart, pareto, sensitivities };
const PAPER_PX = 476; // of one of two columns of A4, where the style of print makes 0.7 of it
const data = JSON.parse(document.getElementById("data").textContent);
const shown = new Map(); // what stands in each section, drawn or not yet
let width = null;
let asked = 0;

/** The study's own answer with what differs at a position of a slider. */
function answer(changed) {
  const told = {};
  for (const [part, own] of Object.entries(data.parts)) {
    told[part] = changed[part]?.whole ?? { ...own, ...changed[part] };
  }
  if (!told.ellipses.fault) told.ellipses = outlined(told.ellipses);
  return told;
}

/** Ellipses with their outlines: points of one circle, laid along the half axes of each. */
function outlined(packed) {
  const { circle, patches } = data.chart_of;
  const laid = ([center, right, up]) =>
    circle.map(([c, s]) => [0, 1].map((k) => center[k] + c * right[k] + s * up[k]));
  const patch = (one, i) => ({ ...patches[i], center: one[0], reach: one[3], outline: laid(one) });
  const whole = (each) => each.map(patch);
  return { ...packed, sensors: packed.sensors.map((s) => ({ ...s, patches: whole(s.patches) })) };
}

function show(told) {
  const [first, ...more] = told.head.verdict;
  document.getElementById("verdict").textContent = first;
  document.getElementById("reasons").replaceChildren(...more.map((text) => html("li", {}, text)));
  fill(document.getElementById("sensors"), told.head.rows);
  for (const section of document.querySelectorAll("section[data-part]")) {
    const { part } = section.dataset;
    const before = JSON.stringify(shown.get(section)?.data);
    if (before === JSON.stringify(told[part]) && !shown.get(section).stale) continue;
    shown.set(section, { data: told[part], stale: true, part });
    draw(section);
    if (before) tell(section);
  }
}

function draw(section) {
  const { data: told, part } = shown.get(section);
  const element = section.querySelector(".chart");
  if (told.fault) element.replaceChildren(html("p", { class: "d-note" }, told.fault));
  else MODULES[part].draw(element, told, width ? { width } : {});
  shown.get(section).stale = false;
}

/** The table says what the drawing shows. */
function tell(section) {
  const { data: told, part } = shown.get(section);
  const table = section.querySelector("table");
  if (!told.fault && table) fill(table, MODULES[part].rows(told).rows);
}

function fill(table, rows) {
  const cell = (text, i) => html(i ? "td" : "th", i ? {} : { scope: "row" }, text);
  table.tBodies[0].replaceChildren(...rows.map((row) => html("tr", {}, row.map(cell))));
}

/** One slider at a time: another goes back to the study's own value. */
function slid(moved) {
  let changed = {};
  const said = [];
  for (const slider of sliders) {
    const slide = data.slides[Number(slider.dataset.slide)];
    if (moved && slider !== moved) slider.value = slide.own;
    const at = Number(slider.value);
    slider.setAttribute("aria-valuetext", slide.told[at]);
    slider.parentElement.querySelector("output").textContent = slide.told[at];
    if (at === slide.own) continue;
    changed = slide.answers[at];
    said.push(`${slide.label}: ${slide.told[at]}; all else, the time too, as in the study.`);
  }
  document.getElementById("changed").textContent = said.join(" ") || "The study as it is.";
  document.getElementById("back").disabled = !said.length;
  cancelAnimationFrame(asked);
  asked = requestAnimationFrame(() => show(answer(changed)));
}

function again(px) {
  width = px;
  shown.forEach((_, section) => draw(section));
}

/** Pictures of two sensors as one with a divider; what is printed stays side by side. */
function divide(sight) {
  const images = [...sight.querySelectorAll("img")];
  const [left, ...others] = images;
  for (const right of others) {
    const place = html("div", { class: "divided" });
    sight.append(place);
    picture.draw(place, { left: left.src, right: right.src, labels: [left.alt, right.alt] });
  }
  if (others.length) sight.classList.add("can-divide");
}

/** What a `?` of a drawing asks for stands below it. */
function open(button) {
  const entry = button.closest("section").querySelector(`[data-equation="${button.dataset.equation}"].equation-of`);
  if (!entry) return;
  entry.closest("details").open = true;
  entry.scrollIntoView({ block: "center" });
  entry.focus();
}

const sliders = [...document.querySelectorAll("input[data-slide]")];
sliders.forEach((slider) => slider.addEventListener("input", () => slid(slider)));
document.getElementById("back").addEventListener("click", () => {
  sliders.forEach((slider) => (slider.value = data.slides[Number(slider.dataset.slide)].own));
  slid(null);
  sliders[0].focus();
});
document.addEventListener("click", (event) => {
  const button = event.target.closest?.("button.equation");
  if (button) open(button);
});
document.querySelectorAll(".sight").forEach(divide);
document.getElementById("sliders").hidden = false;
sliders.forEach((slider) => (slider.value = data.slides[Number(slider.dataset.slide)].own));
show(answer({}));
slid(null);

let last = document.documentElement.clientWidth;
addEventListener("resize", () => {
  if (document.documentElement.clientWidth === last) return;
  last = document.documentElement.clientWidth;
  again(width);
});
addEventListener("beforeprint", () => again(PAPER_PX));
addEventListener("afterprint", () => again(null));
