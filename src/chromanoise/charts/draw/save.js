/** A small menu in the heading of a chart: saves it as SVG, PNG or CSV. */

import { html, kindOf, uniqueId } from "draw/svg.js";

/**
 * @typedef {object} Saved what `draw/export.js` needs of a chart
 * @property {string} part
 * @property {string} heading
 * @property {(element: HTMLElement) => void} draw draws it anew
 * @property {() => { title: string, description?: string }} data
 * @property {() => Promise<string>} csv
 * @property {() => string} [note] what else the file must say
 */
/** @typedef {[string, () => Promise<unknown> | unknown][]} Items names and what they do */

/**
 * The menu of a chart.
 *
 * @param {Saved} saved
 */
export function saveChart(saved) {
  const load = () => import("draw/export.js");
  return saveMenu(saved.heading, () => [
    ["SVG", () => load().then((one) => one.saveSvg(saved))],
    ["PNG, 300 dpi", () => load().then((one) => one.savePng(saved))],
    ["CSV", () => load().then((one) => one.saveCsv(saved))],
  ]);
}

/**
 * The menu of two pictures with a divider.
 *
 * @param {string} heading
 * @param {HTMLElement} element that holds the drawing of `draw/picture.js`
 */
export function savePictures(heading, element) {
  const load = () => import("draw/export.js");
  return saveMenu(heading, () => [
    ...[...element.querySelectorAll(".d-stack img")].map((image) => {
      const one = /** @type {HTMLImageElement} */ (image);
      return /** @type {Items[number]} */ ([`PNG: ${one.alt}`, () => load().then((to) => to.savePicture(one))]);
    }),
    ["PNG: as divided", () => load().then((one) => one.saveDivided(element))],
  ]);
}

/**
 * The menu of a chart that is a picture.
 *
 * @param {HTMLImageElement} image
 */
export function saveImage(image) {
  const kind = kindOf(image).toUpperCase();
  return saveMenu(image.alt, () => [[kind, () => import("draw/export.js").then((to) => to.savePicture(image))]]);
}

/**
 * @param {string} heading
 * @param {() => Items} items of the moment
 */
function saveMenu(heading, items) {
  const id = uniqueId("save");
  const opener = html("button", {
    ...{ type: "button", class: "toggle", "aria-expanded": "false", "aria-controls": id },
    "aria-label": `Save: ${heading}`,
  }, "Save");
  const said = html("p", { class: "d-note", role: "status" });
  const list = html("div");
  const menu = html("div", { class: "d-menu", id, role: "group", "aria-label": `Save: ${heading}` }, [list, said]);
  menu.hidden = true;
  const box = html("div", { class: "d-save" }, [opener, menu]);
  /** @param {boolean} open */
  const turn = (open) => {
    menu.hidden = !open;
    opener.setAttribute("aria-expanded", String(open));
    said.textContent = "";
    if (open) list.replaceChildren(...items().map(([name, act]) => item(name, act)));
  };
  /**
   * @param {string} name
   * @param {() => Promise<unknown> | unknown} act
   */
  const item = (name, act) => {
    const button = html("button", { type: "button" }, name);
    button.addEventListener("click", async () => {
      said.textContent = "Saving \u2026";
      try {
        await act();
        turn(false);
        opener.focus();
      } catch (error) {
        said.textContent = error instanceof Error ? error.message : String(error);
      }
    });
    return button;
  };
  opener.addEventListener("click", () => turn(Boolean(menu.hidden)));
  box.addEventListener("keydown", ({ key }) => {
    if (key !== "Escape" || menu.hidden) return;
    turn(false);
    opener.focus();
  });
  document.addEventListener("pointerdown", ({ target }) => {
    if (!menu.hidden && target instanceof Node && !box.contains(target)) turn(false);
  });
  box.addEventListener("focusout", ({ relatedTarget }) => {
    if (relatedTarget instanceof Node && !box.contains(relatedTarget)) turn(false);
  });
  return box;
}
