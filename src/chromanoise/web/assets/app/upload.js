/** Bring your own: a file of any kind, dropped anywhere or chosen. */

import { IS_FILE, Refused, sent, understood, UNHEARD } from "app/ask.js";
import { el } from "app/dom.js";
import { setSheet } from "app/sheet.js";

const LARGEST = 12e6;
const CUBE = IS_FILE ? "" : ", cube"; // its readers need other libraries
const KINDS = `Spectrum, sensor, pixel, crosstalk, color matrix, study${CUBE} or front of a design; it stays on this computer.`;

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
    "aria-describedby": "file-kinds",
    on: { change: () => field.files?.[0] && bring(field.files[0], report).then(() => (field.value = "")) },
  });
  const label = el("label", { for: "file", class: "drop", title: KINDS, text: "Drop a file here or choose one" });
  place.replaceChildren(field, label, el("p", { class: "unseen", id: "file-kinds", text: KINDS }), report);
  document.body.dataset.kinds = KINDS;
  dropAnywhere((file) => {
    setSheet(true); // the report is there
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
    const entry = event.dataTransfer?.items[0]?.webkitGetAsEntry();
    if (entry?.isDirectory) return frontIn(/** @type {FileSystemDirectoryEntry} */ (entry), take);
    const file = event.dataTransfer?.files[0];
    if (file) take(file);
  });
}

/**
 * Of the folder of a design the front is taken; another folder counts as a file without content.
 *
 * @param {FileSystemDirectoryEntry} folder
 * @param {(file: File) => void} take
 */
function frontIn(folder, take) {
  const none = () => take(new File([], folder.name));
  folder.getFile("front.json", {}, (entry) => /** @type {FileSystemFileEntry} */ (entry).file(take, none), none);
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
    const answer = await understood(await sent(file.name, file));
    // a slow file must not write over what was brought after it
    if (turn !== latest) return;
    const { show } = await import("app/brought.js");
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
