/** Controls of the exposure: on which terms sensors are compared, how long, how wide. */

import { el, radios, say, within } from "app/dom.js";
import { described } from "app/light.js";
import { saidAt, setAt, valueAt } from "app/paths.js";
import { slider } from "app/slider.js";
import { changeStudy } from "app/state.js";

/** @import { Choices, Head, State, Study } from "answers" */
/** @import { Group } from "app/controls.js" */
/** @import { SliderOptions } from "app/slider.js" */

const TERMS = [
  ["exposure", "exposure"],
  ["saturation", "saturation"],
  ["light", "light"],
];

/** @type {Record<string, string>} */
const MEANT = {
  exposure: "One integration time for all sensors.",
  saturation: "Every sensor has its own time, to the same share of full well.",
  light: "Every channel set (one pixel per channel) gets the same photons.",
};

/**
 * The group of controls: `node` and `show(state, head)`.
 *
 * @param {Choices} choices
 * @returns {Group}
 */
export function exposureControls(choices) {
  /**
   * @param {string} key
   * @param {Partial<SliderOptions>} [more]
   */
  const bound = (key, more = {}) =>
    slider({
      ...described(choices, key),
      on: (value) => changeStudy((study) => setAt(study, key, value), "slide"),
      ...more,
    });
  const terms = radios({
    legend: "Compare at equal",
    options: TERMS,
    value: "exposure",
    on: (equal) => changeStudy((study) => setTerms(study, equal)),
  });
  const meant = el("p", { class: "hint" });
  const time = bound("exposure.time_ms", {
    own: "Auto",
    on: (value) => changeStudy((study) => setTime(study, value), value === null ? "step" : "slide"),
  });
  const share = bound("exposure.saturate");
  const aperture = bound("exposure.f_number");
  const noise = readNoise(choices);
  const rows = [time.row, share.row, aperture.row, noise.row];
  const kind = el("div", { class: "row" }, terms.set, meant);
  within(kind, "fieldset").dataset.where = "exposure.equal";
  /**
   * @param {State} state
   * @param {Head | null} head
   */
  const show = ({ study }, head) => {
    const equal = saidAt(study, "exposure.equal");
    const own = valueAt(study, "exposure.time_ms");
    terms.show(equal);
    say(meant, MEANT[equal] ?? "");
    time.show(own, ...together(head, "time_ms"));
    share.show(saidAt(study, "exposure.saturate"));
    // a time that is given leaves nothing to solve
    share.enable(own === null);
    aperture.show(saidAt(study, "exposure.f_number"));
    noise.show(sharedNoise(study), ...together(head, "read_noise_e"));
  };
  return { node: el("div", {}, kind, ...rows), show };
}

/**
 * What was computed of the sensors: the first one's value, and a word where they differ.
 *
 * @param {Head | null} head
 * @param {"time_ms" | "read_noise_e"} key
 * @returns {[number | null, string | null]}
 */
function together(head, key) {
  const values = (head?.sensors ?? []).map((sensor) => sensor[key]);
  return [values[0] ?? null, new Set(values).size > 1 ? "differ" : null];
}

/**
 * @param {Study} study
 * @param {string} equal
 */
function setTerms(study, equal) {
  study.exposure = { ...study.exposure, equal };
  // one time for all is what equal saturation and equal light take away
  if (equal !== "exposure") delete study.exposure.time_ms;
}

/**
 * @param {Study} study
 * @param {number | null} value
 */
function setTime(study, value) {
  setAt(study, "exposure.time_ms", value);
  if (value !== null && study.exposure) study.exposure.equal = "exposure";
}

/** @param {Choices} choices */
function readNoise(choices) {
  const told = described(choices, "sensors.pixel.read_noise_e");
  return slider({
    ...told,
    label: "Read noise of all sensors",
    own: "as built",
    on: (value) =>
      changeStudy((study) => {
        for (const sensor of study.sensors) setAt(sensor, "pixel.read_noise_e", value);
      }, value === null ? "step" : "slide"),
  });
}

/**
 * The read noise that every sensor is given, or null where they differ or none is given.
 *
 * @param {Study} study
 */
function sharedNoise(study) {
  const given = new Set(study.sensors.map((sensor) => valueAt(sensor, "pixel.read_noise_e")));
  return given.size === 1 ? [...given][0] : null;
}
