/** What is saved as files: each chart, the pictures, and the report of the study. */

import { reply, understood } from "app/ask.js";
import { keepTelling, tell } from "app/copy.js";
import { attribute, button, byId, within } from "app/dom.js";
import { drawAgain } from "app/panels.js";
import { askedLook } from "app/snapshots.js";
import { current } from "app/state.js";
import { saveChart, savePictures } from "draw/save.js";

/** @import { Panel } from "app/panels.js" */

/**
 * Puts a menu into the heading of each chart and of the pictures, and a button for the report.
 *
 * @param {Iterable<Panel>} panels
 */
export function saving(panels) {
  for (const panel of panels) {
    const { part, title, section } = panel;
    const menu = saveChart({
      ...{ part, heading: title },
      draw: (element) => drawAgain(panel, element),
      data: () => /** @type {{ title: string }} */ (panel.data),
      csv: () => fileOf("/api/csv", { part, look: askedLook(current().look) }).then((file) => file.text()),
    });
    within(section, ".head .tools").append(menu);
  }
  const picture = within(document, "section[data-part=picture]");
  const pictures = savePictures(within(picture, "h2").textContent ?? "", within(picture, ".body"));
  (picture.querySelector(".head .tools") ?? within(picture, ".head")).append(pictures);
  const report = button("Save report", () => saveReport(report), { id: "report" });
  byId("copy").append(report);
}

/** Of a report, with the hash of its study. */
const HEAD_BYTES = 500;

/** @param {HTMLButtonElement} report */
async function saveReport(report) {
  if (report.hasAttribute("aria-disabled")) return;
  const said = byId("copied");
  attribute(report, "aria-disabled", "true");
  keepTelling(said, "Writing the report \u2026");
  try {
    const [file, { download }] = await Promise.all([fileOf("/api/report", {}), import("draw/export.js")]);
    // the page may show another study by now
    const hash = /data-hash="(\w+)"/.exec(await file.slice(0, HEAD_BYTES).text())?.[1];
    download(file, "report", "html", hash);
    tell(said, "Report saved");
  } catch (error) {
    tell(said, error instanceof TypeError ? "The server does not answer, so nothing was saved." : /** @type {Error} */ (error).message);
  }
  attribute(report, "aria-disabled", null);
}

/**
 * A file that the server makes of the study; throws what `understood` throws.
 *
 * @param {string} path
 * @param {object} question
 */
async function fileOf(path, question) {
  const file = await reply(path, { study: current().study, ...question });
  if (file.ok && !file.headers.get("Content-Type")?.startsWith("application/json")) return file.blob();
  return understood(file);
}
