/** What is saved as files: each chart, the pictures, and report and card of the study. */

import { reply, silence, understood } from "app/ask.js";
import { keepTelling, tell } from "app/copy.js";
import { attribute, button, byId, within } from "app/dom.js";
import { drawAgain } from "app/panels.js";
import { askedLook } from "app/snapshots.js";
import { current } from "app/state.js";
import { saveChart, savePictures } from "draw/save.js";

/** @import { Panel } from "app/panels.js" */

/**
 * Puts a menu into the heading of each chart and of the pictures, and buttons for report and card.
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
      csv: () => fileOf("csv", { part, look: askedLook(current().look) }).then((file) => file.text()),
    });
    within(section, ".head .tools").append(menu);
  }
  const picture = within(document, "section[data-part=picture]");
  const pictures = savePictures(within(picture, "h2").textContent ?? "", within(picture, ".body"));
  (picture.querySelector(".head .tools") ?? within(picture, ".head")).append(pictures);
  byId("copy").append(...WHOLE.map(wholeButton));
}

/** Files of the whole study, which the server writes. */
const WHOLE = [
  { name: "report", ending: "html", title: "All charts in one HTML file" },
  { name: "card", ending: "pdf", title: "One sheet that compares up to five sensors, as PDF" },
];

/** @param {typeof WHOLE[number]} whole */
function wholeButton({ name, ending, title }) {
  const said = byId("copied");
  const pressed = button(`Save ${name}`, () => save(), { id: name, title });
  const save = async () => {
    if (pressed.hasAttribute("aria-disabled")) return;
    attribute(pressed, "aria-disabled", "true");
    keepTelling(said, `Writing the ${name} \u2026`);
    try {
      const [file, { download }] = await Promise.all([fileOf(name, {}), import("draw/export.js")]);
      const content = await file.blob();
      // of its study: the page may show another one by now
      download(content, name, ending, file.headers.get("X-Chromanoise-Hash") ?? undefined);
      tell(said, `The ${name} was saved.`);
    } catch (error) {
      tell(said, error instanceof TypeError ? silence(", so nothing was saved.") : /** @type {Error} */ (error).message);
    }
    attribute(pressed, "aria-disabled", null);
  };
  return pressed;
}

/**
 * The reply with a file that the server makes of the study; throws what `understood` throws.
 *
 * @param {string} name
 * @param {object} question
 * @returns {Promise<Response>}
 */
async function fileOf(name, question) {
  const file = await reply(`/api/${name}`, { study: current().study, ...question });
  if (file.ok && !file.headers.get("Content-Type")?.startsWith("application/json")) return file;
  return understood(file);
}
