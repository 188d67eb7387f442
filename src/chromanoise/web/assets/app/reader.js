/** Control of the reader: an eye, which sees colors, or a machine, which reads raw values. */

import { el, radios, say, within } from "app/dom.js";
import { saidAt, setAt } from "app/paths.js";
import { changeStudy } from "app/state.js";

/** @import { State } from "answers" */
/** @import { Group } from "app/controls.js" */

/** @type {Record<string, string>} */
const MEANT = {
  eye: "The verdict is by visual noise at equal color error.",
  machine: "The verdict is by the distance of patches in raw values, in units of their noise.",
};

/**
 * The group of controls: `node` and `show(state)`.
 *
 * @returns {Group}
 */
export function readerControls() {
  const reader = radios({
    legend: "Who looks",
    options: [["eye", "an eye"], ["machine", "a machine"]],
    value: "eye",
    on: (chosen) => changeStudy((study) => setAt(study, "outputs.reader", chosen === "eye" ? null : chosen)),
  });
  const meant = el("p", { class: "hint" });
  const node = el("div", { class: "row" }, reader.set, meant);
  within(node, "fieldset").dataset.where = "outputs.reader";
  /** @param {State} state */
  const show = ({ study }) => {
    const chosen = saidAt(study, "outputs.reader");
    reader.show(chosen);
    say(meant, MEANT[chosen] ?? "");
  };
  return { node, show };
}
