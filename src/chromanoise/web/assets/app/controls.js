/** The column of controls: every one writes the study, and shows what the study says. */

import { el } from "app/dom.js";
import { exposureControls } from "app/exposure.js";
import { fieldGroups } from "app/fields.js";
import { lightControls } from "app/light.js";
import { matrixControls } from "app/matrix.js";
import { readerControls } from "app/reader.js";
import { sceneControls } from "app/scene.js";
import { sensorControls } from "app/sensors.js";

/** @import { Choices, Head, State } from "answers" */
/** @typedef {{ node: HTMLElement, show: (state: State, head: Head | null) => void }} Group */

/** @type {[string, (choices: Choices) => Group][]} */
const GROUPS = [
  ["Light", lightControls],
  ["Exposure", exposureControls],
  ["Sensors", sensorControls],
  ["Color matrix", matrixControls],
  ["Reader", readerControls],
  ["Scene", sceneControls],
  ["Run", () => ({ node: el("div"), show: () => {} })],
];

/**
 * Fills the frame with controls; gives `show(state, head)`.
 *
 * @param {HTMLElement} frame
 * @param {Choices} choices
 * @returns {(state: State, head: Head | null) => void}
 */
export function controls(frame, choices) {
  const groups = GROUPS.map(([title, make]) => ({ title, ...make(choices), more: moreOf(choices, title) }));
  const sections = groups.map(({ title, node, more }) => {
    const hint = choices.hints?.[title];
    const said = hint ? el("p", { class: "hint", text: hint }) : null;
    return el("section", { class: "group" }, el("h3", { text: title }), node, ...more.nodes, said);
  });
  frame.replaceChildren(...sections);
  frame.removeAttribute("aria-busy");
  return (state, head) => {
    for (const group of groups) {
      group.show(state, head);
      group.more.show(state.study, head);
    }
  };
}

/**
 * Everything else that the server describes for a section; of a sensor it stands in its card.
 *
 * @param {Choices} choices
 * @param {string} title
 */
function moreOf(choices, title) {
  return title === "Sensors" ? { nodes: [], show: () => {} } : fieldGroups(choices, title);
}
