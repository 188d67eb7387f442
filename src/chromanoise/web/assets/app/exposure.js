/** Controls of the exposure: on which terms sensors are compared, how long, how wide. */

import { brief, el, radios, say, toggle, within } from "app/dom.js";
import { described } from "app/light.js";
import { saidAt, setAt, valueAt } from "app/paths.js";
import { slider } from "app/slider.js";
import { beforeSliding, changeState, changeStudy } from "app/state.js";

/** @import { Choices, Head, State, Study } from "answers" */
/** @import { Group } from "app/controls.js" */
/** @import { SliderOptions } from "app/slider.js" */

/** The terms of a comparison, with what each means. */
/** @type {Record<string, string>} */
const MEANT = {
  exposure: "One exposure time for all sensors.",
  saturation: "Each sensor has its own exposure time, which gives the same share of full well.",
  light: "All channels of a sensor together (one pixel each) get the same photons: fewer channels, longer time.",
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
    options: Object.keys(MEANT).map((term) => [term, term]),
    value: "exposure",
    on: (equal) => changeStudy((study) => setTerms(study, equal)),
  });
  const meant = el("p", { class: "hint" });
  /** @type {number | null} the one time of all sensors that was computed last */
  let solved = null;
  /** @type {Head | null} */
  let lastHead = null;
  let solvedFor = "";
  const auto = toggle({
    label: "Auto exposure",
    where: "exposure.auto",
    on: (on) =>
      changeState(({ study, look }) => {
        look.auto_exposure = on;
        setAt(study, "exposure.time_ms", on || solved === null ? null : shortTime(solved));
      }),
  });
  const time = bound("exposure.time_ms", {
    on: (value) => changeState((state) => setTime(state, value), "slide"),
  });
  beforeSliding((state) => {
    if (!timeStays(state) || solved === null || solvedFor !== sensorsAndLamp(state.study)) return;
    if (valueAt(state.study, "exposure.time_ms") === null) setAt(state.study, "exposure.time_ms", shortTime(solved));
  });
  const share = bound("exposure.saturate");
  const aperture = bound("exposure.f_number");
  const noise = readNoise(choices);
  const rows = [auto.row, time.row, share.row, aperture.row, noise.row];
  const kind = el("div", { class: "row" }, terms.set, meant);
  within(kind, "fieldset").dataset.where = "exposure.equal";
  /**
   * @param {State} state
   * @param {Head | null} head
   */
  const show = (state, head) => {
    const { study } = state;
    if (head !== lastHead) {
      const [value, differ] = together(head, "time_ms");
      solved = differ ? null : value;
      solvedFor = sensorsAndLamp(study);
      lastHead = head;
    }
    const equal = saidAt(study, "exposure.equal");
    const own = valueAt(study, "exposure.time_ms");
    terms.show(equal);
    say(meant, MEANT[equal] ?? "");
    time.show(own, ...together(head, "time_ms"));
    share.show(saidAt(study, "exposure.saturate"));
    const shared = equal === "exposure";
    const solves = !shared || (own === null && !timeStays(state));
    auto.show(solves, shared, autoHint(solves, shared, study));
    // a time that stays leaves nothing to solve
    share.enable(solves);
    aperture.show(saidAt(study, "exposure.f_number"));
    noise.show(sharedNoise(study), ...together(head, "read_noise_e"));
  };
  return { node: el("div", {}, kind, ...rows), show };
}

/**
 * Whether sliders shall not change the exposure time.
 *
 * @param {State} state
 */
function timeStays({ study, look }) {
  return saidAt(study, "exposure.equal") === "exposure" && !look.auto_exposure;
}

/**
 * A computed time with four digits; rounded down, so that no channel exceeds its share.
 *
 * @param {number} time_ms
 */
function shortTime(time_ms) {
  const digits = 10 ** (3 - Math.floor(Math.log10(time_ms)));
  return Number((Math.floor(time_ms * digits) / digits).toPrecision(4));
}

/**
 * What must be the same for an exposure time that was computed to be that of a study.
 *
 * @param {Study} study
 */
function sensorsAndLamp({ sensors, light }) {
  return JSON.stringify([sensors, light?.illuminant, light?.beyond]);
}

/**
 * @param {boolean} solves
 * @param {boolean} shared
 * @param {Study} study
 */
function autoHint(solves, shared, study) {
  if (!shared) return "Always on with this comparison: each sensor has its own exposure time.";
  if (valueAt(study, "exposure.time_ms") !== null) return "Fixed time.";
  const full = `${brief(100 * saidAt(study, "exposure.saturate"))} % of full well on a perfect white`;
  const reached = `: the most sensitive channel reaches ${full}.`;
  if (solves) return `The time follows every change${reached} At the same exposure the picture stays the same.`;
  return `The time of auto exposure${reached} It stays when a slider moves.`;
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
 * @param {State} state
 * @param {number | null} value
 */
function setTime({ study, look }, value) {
  study.exposure = { ...study.exposure, equal: "exposure", time_ms: value ?? undefined };
  look.auto_exposure = false;
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
