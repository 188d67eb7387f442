/** Tables whose rows sort by a pressed head: one way, then the other, then as given. */

import { el } from "app/dom.js";

/** @typedef {{ key: string, up: boolean } | null} Sorting none: the rows stand as given */

/**
 * The head of a column, which sorts by it.
 *
 * @param {Sorting} sorting
 * @param {string} key
 * @param {string} text
 * @param {string | null} [what] it holds, in more words
 */
export function sortable(sorting, key, text, what = null) {
  const sorted = sorting?.key === key ? (sorting.up ? "ascending" : "descending") : "none";
  const button = el("button", { type: "button", class: "sort", "data-sort": key, title: what, text });
  return el("th", { scope: "col", "aria-sort": sorted }, button);
}

/**
 * Calls `pressed(key)` when a head of a column within a place is pressed.
 *
 * @param {HTMLElement} place
 * @param {(key: string) => void} pressed
 */
export function onHead(place, pressed) {
  place.addEventListener("click", ({ target }) => {
    const button = target instanceof Element ? target.closest("button.sort") : null;
    if (button instanceof HTMLElement && button.dataset.sort !== undefined) pressed(button.dataset.sort);
  });
}

/**
 * How a table is sorted after a head was pressed.
 *
 * @param {Sorting} sorting
 * @param {string} key
 * @param {boolean} upFirst
 * @returns {Sorting}
 */
export function turned(sorting, key, upFirst) {
  if (sorting?.key !== key) return { key, up: upFirst };
  return sorting.up === upFirst ? { key, up: !upFirst } : null;
}

/**
 * The places of values, from the low end up or down; what has no value comes last.
 *
 * @param {(number | string | null)[]} values
 * @param {boolean} up
 */
export function places(values, up) {
  const way = up ? 1 : -1;
  /**
   * @param {number | string | null} a
   * @param {number | string | null} b
   */
  const compared = (a, b) => {
    if (a === null || b === null) return Number(a === null) - Number(b === null);
    if (typeof a === "number" && typeof b === "number") return way * (a - b);
    return way * String(a).localeCompare(String(b));
  };
  return values.map((_, i) => i).sort((i, j) => compared(values[i], values[j]) || i - j);
}
