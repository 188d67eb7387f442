/** Bring your own: a spectrum, a sensor, a study or a cube, dropped anywhere or chosen. */

import { Refused, understood } from "app/ask.js";
import { button, choice, el, fillChoice, within } from "app/dom.js";
import { lampless } from "app/light.js";
import { setCube } from "app/scene.js";
import { complain } from "app/faults.js";
import { matricesOf, MOST_MATRICES } from "app/matrix.js";
import { exchange } from "app/sensors.js";
import { changeStudy, current, replaceStudy } from "app/state.js";
import { remember, shownName } from "app/uploads.js";

/** @import { FileQuestion, SensorPart, Study, Upload, UploadedFile } from "answers" */
/** @typedef {Record<string, string | number>} Answers */
/** @typedef {ReturnType<typeof question>} Ask */

const LARGEST = 12e6;
/** @type {Record<Upload["kind"], string>} */
const KINDS = {
  sensor: "a sensor",
  light: "a light",
  cube: "a cube",
  study: "a study",
  crosstalk: "crosstalk of a sensor",
  matrix: "a color matrix",
  pixel: "the values of a pixel",
};
const UNHEARD = "The server does not answer, so the file was not read; try again.";

/**
 * Puts the field for files into its place and lets files be dropped anywhere.
 *
 * @param {HTMLElement} place
 */
export function uploads(place) {
  const report = el("div", { class: "brought", role: "status" });
  /** @type {HTMLInputElement} */
  const field = el("input", {
    type: "file",
    id: "file",
    class: "unseen",
    on: { change: () => field.files?.[0] && bring(field.files[0], report).then(() => (field.value = "")) },
  });
  const label = el("label", { for: "file", class: "drop" }, el("span", { text: "Drop a file or choose one" }));
  const hint = el("p", { class: "hint", text: "Spectrum, sensor, pixel, crosstalk, color matrix, study or cube; it stays on this computer." });
  place.replaceChildren(field, label, hint, report);
  dropAnywhere((file) => {
    place.closest("details")?.setAttribute("open", "");
    bring(file, report);
  });
}

/** @param {(file: File) => void} take */
function dropAnywhere(take) {
  const root = document.documentElement;
  /** @param {DragEvent} event */
  const holds = (event) => event.dataTransfer?.types.includes("Files");
  document.addEventListener("dragover", (event) => {
    if (!holds(event)) return;
    event.preventDefault();
    root.classList.add("dropping");
  });
  document.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) root.classList.remove("dropping");
  });
  document.addEventListener("drop", (event) => {
    root.classList.remove("dropping");
    if (!holds(event)) return;
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file) take(file);
  });
}

let latest = 0;

/**
 * @param {File} file
 * @param {HTMLElement} report
 */
async function bring(file, report) {
  const turn = (latest += 1);
  report.replaceChildren(el("p", { text: `Reading ${file.name} …` }));
  try {
    if (file.size > LARGEST) throw new Refused([{ sentence: tooLarge(file) }]);
    const reply = await fetch("/api/upload", {
      method: "POST",
      headers: { "Content-Type": "application/octet-stream", "X-Filename": encodeURIComponent(file.name) },
      body: file,
    });
    const answer = await understood(reply);
    // a slow file must not write over what was brought after it
    if (turn !== latest) return;
    show(report, file.name, answer);
  } catch (error) {
    if (turn !== latest) return;
    const sentences = error instanceof Refused ? error.faults.map((fault) => fault.sentence) : [UNHEARD];
    const lines = sentences.map((sentence) => el("p", { text: named(file.name, sentence) }));
    report.replaceChildren(el("div", { class: "fault", role: "alert" }, ...lines));
  }
  report.scrollIntoView({ block: "nearest" });
}

/**
 * Some sentences name the file already.
 *
 * @param {string} name
 * @param {string} sentence
 */
const named = (name, sentence) => (sentence.startsWith(name) ? sentence : `${name}: ${sentence}`);

/** @param {File} file */
const tooLarge = ({ size }) =>
  `The file has ${(size / 1e6).toFixed(1)} MB. The limit is 12 MB; upload a smaller part.`;

/**
 * What was understood, what is still to be answered, and what to do with it.
 *
 * @param {HTMLElement} report
 * @param {string} name
 * @param {Upload} answer
 */
function show(report, name, answer) {
  if (answer.kind !== "study" && answer.others?.length) {
    report.replaceChildren(severalWays(report, name, answer));
    return;
  }
  if (answer.kind !== "study") remember(answer.kind, answer.id, name, (answer.asks ?? []).map(({ key }) => key));
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
    return [use("Use as the light", (study) => useLight(study, answer.id, answers()))];
  }
  if (answer.kind === "cube") return [use("Show in the picture", (study) => setCube(study, answer.id, answers()))];
  if (answer.kind === "study") {
    return [button("Open this study", () => (replaceStudy(answer.study), done()), { class: "wide primary" })];
  }
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
    use(`Replace sensor ${i + 1}`, (study) => exchangeFor(study, i, withAnswers(answer.id, answers()))),
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
  if (others.length >= MOST_MATRICES) return [first];
  return [first, use("Add as a color matrix", (study) => (study.matrices = [...others, id]))];
}

/**
 * @param {Study} study
 * @param {string} id
 * @param {Answers} told
 */
function useLight(study, id, told) {
  study.light = { ...lampless(study.light), illuminant: id, ...stripped(told, "light.") };
}

/**
 * @param {Study} study
 * @param {number} i
 * @param {SensorPart} sensor
 */
function exchangeFor(study, i, { name, ...answers }) {
  exchange(study, i, name, answers);
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
