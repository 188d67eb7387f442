/** Controls of the color matrix: how it is made, with which parameter, from which prior. */

import { choice, el, fillChoice } from "app/dom.js";
import { rangeOf } from "app/paths.js";
import { slider } from "app/slider.js";
import { changeStudy } from "app/state.js";

const PARAMETERS = {
  weight: { label: "Weight of the noise", low: 0.001, high: 1000, start: 1 },
  strength: { label: "Strength of the ridge", low: 1e-6, high: 10, start: 0.01 },
  limit: { label: "Largest noise gain \u03a8", low: 1, high: 20, start: 6.5 },
};

/** The parts of a matrix's name: `noise-regularized=1` is a method and its parameter. */
export function matrixParts(name) {
  const [method, value] = name.split("=");
  return { method, value: value === undefined ? null : Number(value) };
}

/** Whether one of the study's matrices has to be trained on a prior. */
export function isTrained({ matrices = [] }) {
  return matrices.some((name) => matrixParts(name).method !== "kernel");
}

/** The group of controls: `node` and `show(state)`. */
export function matrixControls(choices) {
  const place = el("div");
  let drawn = null;
  const set = (name, how) => changeStudy((study) => setMatrix(study, name), how);
  const method = choice({
    label: "Color matrix",
    options: choices.matrices.map((one) => one.name),
    where: "matrices",
    on: (name) => {
      const parameter = parameterOf(choices, name);
      set(parameter ? `${name}=${parameter.start}` : name, "step");
    },
  });
  const prior = choice({
    label: "Prior of trained matrices",
    options: choices.priors,
    where: "prior",
    on: (name) => changeStudy((study) => (study.prior = name)),
  });
  const show = ({ study }) => {
    const now = matrixParts(study.matrices?.[0] ?? "kernel");
    fillChoice(method.select, choices.matrices.map((one) => one.name), now.method);
    fillChoice(prior.select, choices.priors, study.prior ?? choices.prior ?? "chart-nir");
    if (drawn?.method !== now.method) {
      drawn = { method: now.method, weight: weightSlider(choices, now.method, set) };
      place.replaceChildren(...(drawn.weight ? [drawn.weight.row] : []));
    }
    drawn.weight?.show(now.value ?? parameterOf(choices, now.method).start);
  };
  return { node: el("div", {}, method.row, place, prior.row), show };
}

function setMatrix(study, name) {
  const others = (study.matrices ?? []).slice(1).filter((other) => other !== name);
  study.matrices = [name, ...others];
}

function parameterOf(choices, method) {
  const name = choices.matrices.find((one) => one.name === method)?.parameter ?? null;
  if (name === null) return null;
  const told = name === "weight" ? rangeOf(choices, "matrices.weight") : null;
  const known = PARAMETERS[name] ?? { label: name, low: 1e-3, high: 1e3, start: 1 };
  return { scale: "log", ...known, ...told, start: known.start };
}

function weightSlider(choices, method, set) {
  const parameter = parameterOf(choices, method);
  if (!parameter) return null;
  return slider({
    label: parameter.label,
    unit: "",
    range: parameter,
    where: "matrices.0",
    on: (value) => set(`${method}=${value}`, "slide"),
  });
}
