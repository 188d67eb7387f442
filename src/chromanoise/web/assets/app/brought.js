/** A file that was brought: what it was taken for, its questions, and what can be done with it. */

import { button, choice, el, fillChoice, within } from "app/dom.js";
import { complain } from "app/faults.js";
import { lampless } from "app/light.js";
import { matricesOf } from "app/matrix.js";
import { most, setAt } from "app/paths.js";
import { setCube } from "app/scene.js";
import { exchange } from "app/sensors.js";
import { setSheet } from "app/sheet.js";
import { changeStudy, current, replaceStudy } from "app/state.js";
import { remember, shownName } from "app/uploads.js";

/** @import { FileQuestion, SensorPart, Study, Upload, UploadedFile, UploadedFront } from "answers" */
/** @typedef {Record<string, string | number>} Answers */
/** @typedef {ReturnType<typeof question>} Ask */

/** @type {Record<Upload["kind"], string>} */
const KINDS = {
  sensor: "a sensor",
  light: "a light",
  cube: "a cube",
  study: "a study",
  front: "a front of a design",
  crosstalk: "crosstalk of a sensor",
  matrix: "a color matrix",
  pixel: "the values of a pixel",
  pairs: "pairs of patches for a machine",
};

/**
 * What was understood, what is still to be answered, and what to do with it.
 *
 * @param {HTMLElement} report
 * @param {string} name
 * @param {Upload} answer
 */
export function show(report, name, answer) {
  if (answer.kind === "front") {
    showBroughtFront(report, name, answer);
    return;
  }
  if (answer.kind !== "study" && answer.others?.length) {
    report.replaceChildren(severalWays(report, name, answer));
    return;
  }
  if (answer.kind !== "study") remember(answer.kind, answer.id, name, (answer.asks ?? []).map(({ key }) => key));
  const at = answer.kind === "sensor" ? current().study.sensors.findIndex((one) => one.name === answer.id) : -1;
  if (at >= 0) {
    report.replaceChildren(el("p", { text: `${name} has the same content as sensor ${at + 1}; duplicate that one to change it.` }));
    return;
  }
  const lines = (answer.preview ?? []).map((text) => el("li", { text }));
  const title = el("p", { class: "strong", text: `${name}: ${KINDS[answer.kind]}` });
  const asks = (answer.asks ?? []).map(question);
  const answers = () => Object.fromEntries(asks.map((ask) => ask.answer()).filter(([, value]) => value !== ""));
  const unanswered = () => asks.find((ask) => ask.answer()[1] === "");
  const form = el(
    "form",
    { class: "asks", on: { submit: (event) => event.preventDefault() } },
    ...asks.map((ask) => ask.row),
    ...uses(answer, answers, () => report.replaceChildren(), unanswered),
  );
  report.replaceChildren(title, el("ul", { class: "notes" }, ...lines), form);
}

/**
 * A front is shown at once; its module is loaded with the first one.
 *
 * @param {HTMLElement} report
 * @param {string} name
 * @param {UploadedFront} answer
 */
async function showBroughtFront(report, name, { front, preview = [] }) {
  const { showFront } = await import("app/front.js");
  const lines = preview.slice(0, 1).map((text) => el("li", { text }));
  report.replaceChildren(el("p", { class: "strong", text: `${name}: ${KINDS.front}` }), el("ul", { class: "notes" }, ...lines));
  setSheet(false); // it would stand over the front
  showFront(front).scrollIntoView({ block: "start" });
}

/**
 * Asks what a file is that can be read in several ways.
 *
 * @param {HTMLElement} report
 * @param {string} name
 * @param {UploadedFile} answer
 */
function severalWays(report, name, { others = [], ...first }) {
  const all = [first, ...others];
  const ways = all.map(({ kind }) => [kind, KINDS[kind]]);
  const pick = choice({
    label: `${name} can be read in ${all.length} ways. It is:`,
    options: [["", "Choose..."], ...ways],
    on: (kind) => {
      const chosen = all.find((one) => one.kind === kind);
      if (chosen) show(report, name, chosen);
    },
  });
  const lines = all.map(({ preview = [] }) => el("li", { text: preview[0] }));
  return el("div", { class: "asks" }, el("ul", { class: "notes" }, ...lines), pick.row);
}

/**
 * A question that the file cannot answer: one of a few words, or a number.
 *
 * @param {FileQuestion} asked
 */
function question({ key, question: text, choices }) {
  if (choices?.length) {
    const pick = choice({ label: text, options: [], on: () => {} });
    fillChoice(pick.select, [["", "Choose..."], ...choices.map((one) => [String(one), String(one)])], "");
    return { row: pick.row, answer: () => [key, pick.select.value] };
  }
  const field = el("input", { type: "text", inputmode: "decimal", class: "field" });
  const row = el("div", { class: "row" }, el("label", { class: "label" }, `${text} `, field));
  return { row, answer: () => [key, typed(field.value.trim())] };
}

/**
 * Whether a question of the file is still open; then it says so and stands under the cursor.
 *
 * @param {Ask | undefined} ask
 */
function asksFor(ask) {
  if (!ask) return false;
  complain(ask.row, "The file does not declare this; please choose.");
  within(ask.row, "select, input").focus();
  return true;
}

/** @param {string} text */
const typed = (text) => (text === "" || Number.isNaN(Number(text)) ? text : Number(text));

/**
 * @param {Upload} answer
 * @param {() => Answers} answers
 * @param {() => void} done
 * @param {() => Ask | undefined} unanswered
 */
function uses(answer, answers, done, unanswered) {
  /**
   * @param {string} text
   * @param {(study: Study) => unknown} edit
   */
  const use = (text, edit) => button(text, () => (asksFor(unanswered()) ? null : (changeStudy(edit), done())), { class: "wide" });
  if (answer.kind === "light") {
    const light = () => ({ illuminant: answer.id, ...stripped(answers(), "light.") });
    return [use("Use as the light", (study) => (study.light = { ...lampless(study.light), ...light() }))];
  }
  if (answer.kind === "cube") return [use("Show in the picture", (study) => setCube(study, answer.id, answers()))];
  if (answer.kind === "study") {
    return [button("Open this study", () => (replaceStudy(answer.study), done()), { class: "wide primary" })];
  }
  if (answer.kind === "pairs") return [use("Use for a machine", (study) => setAt(study, "reflectances.pairs", answer.id))];
  if (answer.kind === "matrix") return matrixUses(answer.id, use);
  if (answer.kind === "crosstalk" || answer.kind === "pixel") {
    const { kind, id } = answer;
    const put = /** @param {SensorPart} sensor */ (sensor) =>
      kind === "pixel" ? (sensor.pixel = { file: id }) : (sensor.crosstalk = id);
    return current().study.sensors.map((sensor, i) =>
      use(`Use for sensor ${i + 1}, ${shownName(sensor.name)}`, (study) => put(study.sensors[i])),
    );
  }
  if (answer.kind !== "sensor") return [];
  const exchanges = current().study.sensors.map((_, i) =>
    use(`Replace sensor ${i + 1}`, (study) => exchange(study, i, withAnswers(answer.id, answers()))),
  );
  return [use("Add as a sensor", (study) => study.sensors.push(withAnswers(answer.id, answers()))), ...exchanges];
}

/**
 * @param {string} id
 * @param {(text: string, edit: (study: Study) => unknown) => HTMLElement} use
 */
function matrixUses(id, use) {
  const names = matricesOf(current().study);
  const others = names.filter((name) => name !== id);
  const first = use("Use as the color matrix", (study) => (study.matrices = [id, ...others.filter((name) => name !== names[0])]));
  if (others.length >= most.matrices) return [first];
  return [first, use("Add as a color matrix", (study) => (study.matrices = [...others, id]))];
}

/**
 * A sensor of a file: most answers are about its curves, a few about the sensor itself.
 *
 * @param {string} id
 * @param {Answers} told
 * @returns {SensorPart}
 */
function withAnswers(id, told) {
  const plain = stripped(stripped(told, "sensors."), "answers.");
  const { beyond, ...answers } = plain;
  return { name: id, ...(beyond ? { beyond: String(beyond) } : {}), ...(Object.keys(answers).length ? { answers } : {}) };
}

/**
 * @param {Answers} told
 * @param {string} start
 */
function stripped(told, start) {
  /** @param {string} key */
  const short = (key) => (key.startsWith(start) ? key.slice(start.length) : key);
  return Object.fromEntries(Object.entries(told).map(([key, value]) => [short(key), value]));
}
