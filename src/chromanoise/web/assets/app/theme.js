/** Light, dark, or as the system has it. */

import { radios } from "app/dom.js";
import { changeLook } from "app/state.js";

/** @import { Look } from "answers" */

const NAMES = [["auto", "Auto"], ["light", "Light"], ["dark", "Dark"]];

/**
 * Puts the choice into its place; gives `show(look)`.
 *
 * @param {HTMLElement} place
 * @returns {(look: Look) => void}
 */
export function themeChoice(place) {
  const marks = radios({
    legend: "Colors",
    hidden: true,
    options: NAMES,
    value: "auto",
    on: (theme) => changeLook((look) => (look.theme = theme)),
  });
  place.replaceChildren(marks.set);
  return ({ theme }) => {
    marks.show(theme);
    if (theme === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme;
  };
}
