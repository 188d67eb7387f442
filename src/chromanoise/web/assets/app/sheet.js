/** In a narrow window: the controls in a sheet at the bottom, the tools behind a button. */

import { attribute, byId } from "app/dom.js";

/** Lets the buttons open and close what they control; Escape closes it, and the focus goes back. */
export function narrowButtons() {
  opens(byId("menu"));
  // above the sheet there is room for the verdict and the picture, not for more
  opens(byId("sheet"), () => {
    if (window.scrollY < byId("verdict").offsetTop) byId("verdict").scrollIntoView();
  });
}

/**
 * Opens or closes the sheet, where the window is so narrow that there is one.
 *
 * @param {boolean} open
 */
export function setSheet(open) {
  const sheet = byId("sheet");
  if (sheet.checkVisibility() && sheet.getAttribute("aria-expanded") !== String(open)) sheet.click();
}

/**
 * @param {HTMLElement} button
 * @param {() => void} [opened]
 */
function opens(button, opened = () => {}) {
  const place = byId(button.getAttribute("aria-controls") ?? "");
  const [shown, words] = ["open", [button.textContent ?? "", "Close"]];
  /** @param {boolean} open */
  const show = (open) => {
    place.classList.toggle(shown, open);
    attribute(button, "aria-expanded", open ? "true" : "false");
    button.textContent = words[open ? 1 : 0];
    if (open) opened();
  };
  button.addEventListener("click", () => show(!place.classList.contains(shown)));
  for (const node of [button, place]) {
    node.addEventListener("keydown", ({ key }) => {
      if (key !== "Escape" || !place.classList.contains(shown)) return;
      show(false);
      button.focus();
    });
  }
}
