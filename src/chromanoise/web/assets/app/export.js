/** What is saved as files: each chart, the pictures, and report and card of the study. */

import { IS_FILE, reply, silence, understood } from "app/ask.js";
import { keepTelling, tell } from "app/copy.js";
import { attribute, button, byId, within } from "app/dom.js";
import { drawAgain } from "app/panels.js";
import { askedLook } from "app/snapshots.js";
import { current, subscribe } from "app/state.js";
import { saveChart, savePictures } from "draw/save.js";

/** @import { Choices } from "answers" */
/** @import { Panel } from "app/panels.js" */

/**
 * Puts a menu into the heading of each chart and of the pictures, and buttons for report and card.
 *
 * @param {Iterable<Panel>} panels
 * @param {Choices} choices
 */
export function saving(panels, choices) {
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
  const made = IS_FILE ? WHOLE.slice(0, 1) : WHOLE; // the card needs Matplotlib
  byId("copy").append(...made.map((whole) => wholeButton(whole, choices)));
}

/** Files of the whole study, which the server writes. */
const WHOLE = [
  { name: "report", ending: "html", title: "All charts in one HTML file" },
  { name: "card", ending: "pdf", title: "One sheet that compares up to five sensors, as PDF" },
];

/**
 * @param {typeof WHOLE[number]} whole
 * @param {Choices} choices
 */
function wholeButton({ name, ending, title }, { denoising }) {
  const said = byId("copied");
  const pressed = button(`Save ${name}`, () => save(), { id: name, title });
  let [lacking, busy] = ["", false];
  const enable = () => attribute(pressed, "aria-disabled", lacking || busy ? "true" : null);
  subscribe(({ study }) => {
    const named = new Set(study.pictures?.map((picture) => picture.denoise));
    const method = denoising.find((one) => named.has(one.name) && one.needs.length);
    lacking = method ? `Denoising with ${method.name} needs ${method.needs.join(", ")}, so no ${name} can be saved.` : "";
    pressed.title = lacking || title;
    enable();
  });
  const save = async () => {
    if (lacking) return tell(said, lacking);
    if (busy) return undefined;
    busy = true;
    enable();
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
    busy = false;
    return enable();
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
