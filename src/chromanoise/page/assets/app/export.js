/** What is saved as files: each chart, the pictures, and the report of the study. */

import { understood } from "app/ask.js";
import { attribute, button, byId, say, within } from "app/dom.js";
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

/** @param {HTMLButtonElement} report */
async function saveReport(report) {
  const said = byId("copied");
  attribute(report, "aria-disabled", "true");
  say(said, "Writing the report \u2026");
  try {
    const [file, { download }] = await Promise.all([fileOf("/api/report", {}), import("draw/export.js")]);
    download(file, "report", "html");
    say(said, "Report saved");
  } catch (error) {
    say(said, error instanceof TypeError ? "The server does not answer, so nothing was saved." : /** @type {Error} */ (error).message);
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
  const reply = await fetch(path, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ study: current().study, ...question }),
  });
  if (reply.ok && !reply.headers.get("Content-Type")?.startsWith("application/json")) return reply.blob();
  return understood(reply);
}
