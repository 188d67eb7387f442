/** The column of controls: every one writes the study, and shows what the study says. */

import { el } from "app/dom.js";
import { exposureControls } from "app/exposure.js";
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
];

/**
 * Fills the frame with controls; gives `show(state, head)`.
 *
 * @param {HTMLElement} frame
 * @param {Choices} choices
 * @returns {(state: State, head: Head | null) => void}
 */
export function controls(frame, choices) {
  const groups = GROUPS.map(([title, make]) => ({ title, ...make(choices) }));
  const sections = groups.map(({ title, node }) =>
    el("section", { class: "group" }, el("h3", { text: title }), node),
  );
  frame.replaceChildren(...sections);
  frame.removeAttribute("aria-busy");
  return (state, head) => {
    for (const group of groups) group.show(state, head);
  };
}
